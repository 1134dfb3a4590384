//! Changes between steps of bodies that touch: the cases of the guide's last table that are not in `games` or `state`.

use super::scenes::{def, ground, square, world};
use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, ColliderDef, End, FieldKind, Filter, Fx, FxAccumulator, Mass, Material,
    Shape, Snapshot, SpringConstants, Vec2, World, WorldDef, fx, vec2,
};

/// A square of a metre at rest on the ground, after a second.
fn resting() -> (World, Vec<BodyId>) {
    let bodies = [ground().expect("a ground"), square(vec2(0, fx!(0.5)), 1).expect("a square")];
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    (world, ids)
}

fn disc(position: Vec2, radius: Fx) -> BodyDef {
    BodyDef { position, ..BodyDef::dynamic().with_collider(Shape::circle(radius).expect("a disc")) }
}

/// The exact position and velocity.
fn motion(world: &World, body: BodyId) -> [i128; 5] {
    let body = world.body(body).expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits)
}

/// A step of this body alone, with the world's gravity: the bits of its free flight.
fn alone(world: &World, body: BodyId) -> [i128; 5] {
    let mut free = world.preview(body).expect("it is there");
    free.step();
    let body = free.body().expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits)
}

/// The sum of the normal impulses on a body in the last sub-step, N·s.
fn pressed(world: &World, body: BodyId) -> Fx {
    let contacts = world.contacts_of(body).expect("it is there");
    contacts.flat_map(|contact| contact.points().to_vec()).fold(Fx::ZERO, |sum, point| sum + point.normal_impulse)
}

/// The normal impulse of a sub-step that carries so many kg.
fn weight(kilograms: i64) -> Fx {
    Fx::from_ratio(10 * kilograms, 5 * 60)
}

#[test]
fn a_small_move_keeps_impulses_and_a_large_one_leaves_them() {
    let (mut world, ids) = resting();
    let before = pressed(&world, ids[1]);
    assert!((before - weight(1)).abs() < fx!(0.0001), "{before}");
    let place = world.body(ids[1]).expect("it is there").position();
    world.set_position(ids[1], place + vec2(fx!(0.001), 0)).expect("it is there");
    assert_eq!(pressed(&world, ids[1]), before);
    world.step();
    assert!(world.body(ids[1]).expect("it is there").velocity().length() < fx!(0.001));
    // Far from the ground it flies at once, and takes no impulse along.
    world.set_position(ids[1], vec2(30, 9)).expect("it is there");
    assert_eq!(world.contacts().count(), 0);
    let expected = alone(&world, ids[1]);
    world.step();
    assert_eq!(motion(&world, ids[1]), expected);
    // Back on the ground, it starts from nothing.
    world.set_position(ids[1], place).expect("it is there");
    assert_eq!(pressed(&world, ids[1]), Fx::ZERO);
}

#[test]
fn a_body_put_inside_of_a_static_one_comes_out_no_faster_than_the_push_speed() {
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    for push_speed in [fx!(0.5), fx!(3), fx!(8)] {
        let mut def = still;
        def.contacts.push_speed = push_speed;
        let (mut world, ids) =
            world(def, [ground().expect("a ground"), disc(vec2(0, fx!(-0.3)), fx!(0.5))]).expect("a scene");
        let (mut fastest, mut last) = (Fx::ZERO, fx!(-0.3));
        for _ in 0..240 {
            world.step();
            let height = world.body(ids[1]).expect("it is there").position().y;
            fastest = fastest.max((height - last) * 60);
            last = height;
        }
        assert!(fastest <= push_speed * fx!(1.001) && fastest > push_speed / 2, "{push_speed}: {fastest}");
        assert!(last > fx!(0.49), "{push_speed}: {last}");
    }
}

#[test]
fn a_filter_that_is_changed_lets_a_body_fall_at_once() {
    let (mut world, ids) = resting();
    let collider_id = world.colliders_of(ids[1]).expect("it is there").next().expect("a collider");
    let collider = world.collider(collider_id).expect("it is there").clone();
    let filter = Filter { category: 2, mask: 2, ..Filter::default() };
    world.set_collider(collider_id, ColliderDef { filter, ..collider.clone() }).expect("a collider");
    for _ in 0..3 {
        let expected = alone(&world, ids[1]);
        world.step();
        assert_eq!(motion(&world, ids[1]), expected);
    }
    world.set_collider(collider_id, collider).expect("a collider");
    world.step();
    assert!(pressed(&world, ids[1]) > Fx::ZERO);
}

/// A load that becomes heavier or lighter is carried from the next steps on, and does not jump.
#[test]
fn a_mass_that_is_changed_is_carried() {
    let (mut world, ids) = resting();
    for kilograms in [4, 1, 100, 1] {
        world.set_mass(ids[1], Mass::Kilograms(Fx::from_ratio(kilograms, 1))).expect("a mass");
        let height = world.body(ids[1]).expect("it is there").position().y;
        for _ in 0..60 {
            world.step();
            let off = world.body(ids[1]).expect("it is there").position().y - height;
            assert!(off.abs() < fx!(0.02), "{kilograms}: {off}");
        }
        let carried = pressed(&world, ids[1]) / weight(kilograms);
        assert!((carried - fx!(1)).abs() < fx!(0.001), "{kilograms}: {carried}");
    }
}

/// On ice a box keeps its speed; on rubber, from the step of the change on, it loses μ·g.
#[test]
fn a_material_that_is_changed_acts_from_the_next_step_on() {
    let (mut world, ids) = resting();
    let collider_id = world.colliders_of(ids[1]).expect("it is there").next().expect("a collider");
    let surface = |friction| {
        let material = Material { friction, ..Material::default() };
        ColliderDef { material, ..world.collider(collider_id).expect("it is there").clone() }
    };
    // With 0.6 of the ground: √(0.6 · 0.6) = 0.6.
    let (ice, wood) = (surface(fx!(0)), surface(fx!(0.6)));
    world.set_collider(collider_id, ice).expect("a collider");
    world.set_velocity(ids[1], vec2(10, 0)).expect("a velocity");
    (0..30).for_each(|_| _ = world.step());
    assert_eq!(world.body(ids[1]).expect("it is there").velocity().x, fx!(10));
    world.set_collider(collider_id, wood).expect("a collider");
    for tick in 1..=30 {
        world.step();
        let expected = fx!(10) - Fx::from_ratio(6 * tick, 60);
        let speed = world.body(ids[1]).expect("it is there").velocity().x;
        // The contact starts without impulses: a step or two are for it to build up.
        assert!((speed - expected).abs() < fx!(0.06), "{tick}: {speed} for {expected}");
    }
}

/// A box on a plate that is tilted by less than atan(μ) turns with it and does not slide; beyond, it slides.
#[test]
fn a_plate_that_turns_under_a_box_carries_it_up_to_the_angle_of_friction() {
    for (tilt, slides) in [(fx!(0.45), false), (fx!(0.65), true)] {
        let plate = BodyDef::kinematic().with_collider(Shape::rectangle(20, 1).expect("a plate"));
        let bodies = [plate, square(vec2(0, 1), 1).expect("a square")];
        let (mut world, ids) = world(def(), bodies).expect("a scene");
        let along = |world: &World| {
            let [plate, rider] = [0, 1].map(|i| world.body(ids[i]).expect("it is there"));
            rider.position().dot(vec2(plate.angle().cos(), plate.angle().sin()))
        };
        let mut held = fx!(0);
        for tick in 0..300 {
            // Up to the tilt in two seconds, μ = 0.6: atan(0.6) = 0.54.
            let angle = tilt * Fx::from_ratio(tick.min(120), 120);
            world.move_to(ids[0], vec2(0, 0), angle).expect("it is near");
            world.step();
            let plate = world.body(ids[0]).expect("it is there");
            assert_eq!((plate.position(), plate.angle()), (vec2(0, 0), angle));
            if tick == 150 {
                held = along(&world);
            }
        }
        let slid = along(&world) - held;
        let turned = world.body(ids[1]).expect("it is there").angle() - tilt;
        if slides {
            assert!(slid < fx!(-0.5), "{slid}");
        } else {
            assert!(
                held.abs() < fx!(0.05) && slid.abs() < fx!(0.001) && turned.abs() < fx!(0.001),
                "{held} {slid} {turned}"
            );
        }
    }
}

#[test]
fn kinematic_and_static_bodies_exchange_no_impulse() {
    let bodies = || {
        let lift = |x: i32, vx: i32| BodyDef {
            position: vec2(x, fx!(0.2)),
            velocity: vec2(vx, 0),
            ..BodyDef::kinematic().with_collider(Shape::rectangle(1, 1).expect("a lift"))
        };
        [lift(-2, 2), lift(2, -2)]
    };
    let (mut crossing, ids) = world(def(), bodies().into_iter().chain([ground().expect("a ground")])).expect("a scene");
    let (mut apart, others) = world(def(), bodies()).expect("a scene");
    for _ in 0..120 {
        crossing.step();
        apart.step();
        assert_eq!(crossing.contacts().count(), 0);
        for (id, twin) in ids.iter().zip(&others) {
            assert_eq!(motion(&crossing, *id), motion(&apart, *twin));
        }
    }
}

/// A body that takes the slots of another one in the same tick starts without its impulses, and moves as in a world where the other one
/// never was.
#[test]
fn a_body_in_the_slots_of_one_that_was_removed_has_none_of_its_impulses() {
    let bodies = [ground().expect("a ground"), square(vec2(0, fx!(0.5)), 1).expect("a square")];
    let heavy = BodyDef { mass: Mass::Kilograms(fx!(1000)), ..bodies[1].clone() };
    let (mut used, ids) = world(def(), [bodies[0].clone(), heavy]).expect("a scene");
    (0..60).for_each(|_| _ = used.step());
    let old = used.colliders_of(ids[1]).expect("it is there").next().expect("a collider");
    used.remove_body(ids[1]).expect("it is there");
    let new = used.add_body(bodies[1].clone()).expect("a body");
    let collider = used.colliders_of(new).expect("it is there").next().expect("a collider");
    assert_eq!((new.parts().0, collider.parts().0), (ids[1].parts().0, old.parts().0));
    assert_eq!(used.contacts().count(), 0);
    let (mut fresh, others) = world(def(), bodies).expect("a scene");
    for step in 0..60 {
        used.step();
        fresh.step();
        assert_eq!(motion(&used, new), motion(&fresh, others[1]), "{step}");
        if step == 0 {
            let report = used.last_report();
            assert_eq!((report.removed, report.added), (&[ids[1]][..], &[new][..]));
        }
    }
}

/// Two discs that a spring pulls onto each other without gravity: the contact bears the tension k·(d − rest). The free flight, in which the
/// spring acts, brings them nearer by 7 mm, so that the mean tension in a step is 0.7 % less.
#[test]
fn a_contact_bears_the_tension_of_a_spring() {
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let bodies = [disc(vec2(0, 0), fx!(0.5)), disc(vec2(1, 0), fx!(0.5))];
    let (mut world, ids) = world(still, bodies).expect("a scene");
    let spring = SpringConstants { rest: fx!(0.5), stiffness: fx!(40), damping: fx!(0) };
    let near = Attachment::centre(ids[0]);
    world.add_field(FieldKind::Spring { near, far: End::Body(Attachment::centre(ids[1])), spring }).expect("a spring");
    (0..300).for_each(|_| _ = world.step());
    let [a, b] = [ids[0], ids[1]].map(|id| world.body(id).expect("it is there").position());
    let distance = (b - a).length();
    assert!((distance - fx!(1)).abs() < fx!(0.006), "{distance}");
    let tension = fx!(40) * (distance - fx!(0.5));
    let force = pressed(&world, ids[0]) * 300;
    assert!((force / tension - fx!(1)).abs() < fx!(0.01), "{force} for {tension}");
}

#[test]
fn a_chain_that_is_edited_takes_its_bodies_along_or_drops_them() {
    let plain =
        |height: Fx| Shape::chain(&[vec2(9, height), vec2(0, height), vec2(-9, height)], false).expect("a chain");
    let bodies =
        [BodyDef::fixed().with_collider(plain(fx!(0))), square(vec2(fx!(0.2), fx!(0.5)), 1).expect("a square")];
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    let chain = world.colliders_of(ids[0]).expect("it is there").next().expect("a collider");
    let height = |world: &World| world.body(ids[1]).expect("it is there").position().y;
    // Lower: the impulses are gone at once, the box falls and lands.
    world.set_collider(chain, plain(fx!(-1))).expect("a chain");
    assert_eq!(world.contacts().count(), 0);
    let expected = alone(&world, ids[1]);
    world.step();
    assert_eq!(motion(&world, ids[1]), expected);
    (0..120).for_each(|_| _ = world.step());
    assert!((height(&world) + fx!(0.5)).abs() < fx!(0.01), "{}", height(&world));
    // Higher, into the box but below its middle: it is pushed up.
    world.set_collider(chain, plain(fx!(-0.6))).expect("a chain");
    (0..120).for_each(|_| _ = world.step());
    assert!((height(&world) + fx!(0.1)).abs() < fx!(0.01), "{}", height(&world));
    // Above its middle: the box is behind it, and falls as if there was nothing.
    world.set_collider(chain, plain(fx!(0.2))).expect("a chain");
    for _ in 0..30 {
        let expected = alone(&world, ids[1]);
        world.step();
        assert_eq!(motion(&world, ids[1]), expected);
    }
}

/// A rule of a game that reads contacts between steps has those of the last step, in a world that was restored too.
#[test]
fn a_rule_that_reads_contacts_goes_on_after_a_restore() {
    // A magnet in the ground: it holds what touches it.
    let rule = |world: &mut World, body: BodyId| {
        let force = if pressed(world, body) > Fx::ZERO { fx!(-30) } else { fx!(0) };
        world.apply_force(body, vec2(0, force)).expect("it is there");
    };
    let ball = disc(vec2(0, 2), fx!(0.5));
    let (mut plain, ids) = world(def(), [ground().expect("a ground"), ball]).expect("a scene");
    let mut restored = plain.clone();
    let mut touched = 0;
    for step in 0..90 {
        for world in [&mut plain, &mut restored] {
            rule(world, ids[1]);
            world.step();
        }
        touched += plain.contacts().count();
        let bytes = restored.snapshot().to_bytes();
        restored = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        assert_eq!(restored.state_hash(), plain.state_hash(), "{step}");
    }
    assert!(touched > 30, "{touched}");
}

/// A body whose kind is set keeps its contacts: a static one carries what is on it at once, and one that is dynamic again is carried.
#[test]
fn a_kind_that_is_set_keeps_impulses() {
    let stack = (0..2).map(|row| square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("a square"));
    let (mut world, ids) = world(def(), [ground().expect("a ground")].into_iter().chain(stack)).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    let start = pressed(&world, ids[2]);
    for kind in [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic] {
        let before = pressed(&world, ids[2]);
        world.set_kind(ids[1], kind).expect("it is there");
        assert_eq!(pressed(&world, ids[2]), before, "{kind:?}");
        for _ in 0..30 {
            world.step();
            assert!((pressed(&world, ids[2]) - start).abs() < fx!(0.002), "{kind:?}");
            assert!(world.body(ids[2]).expect("it is there").velocity().length() < fx!(0.01), "{kind:?}");
        }
    }
}
