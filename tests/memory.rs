//! Memory: what a body takes, what a copy takes, and that a step takes none.

use allocation_counter::{AllocationInfo, measure};
use umbra_physics::{
    Attachment, BodyDef, BodyId, ColliderDef, Damping, End, FieldKind, ForceField, Fx, FxFactor, Integrator, Mass,
    Owner, RecordOptions, Recorder, Replay, ReplayError, Rollback, Shape, SpringConstants, Vec2, World, WorldDef, fx,
    vec2,
};

#[path = "memory/collisions.rs"]
mod collisions;
#[path = "memory/solver.rs"]
mod solver;

fn world(integrator: Integrator) -> World {
    let def = WorldDef {
        gravity: vec2(0, -10),
        linear_damping: Damping::kept_per_second(fx!(0.75)),
        angular_damping: Damping::kept_per_second(fx!(0.75)),
        integrator,
        ..WorldDef::default()
    };
    World::new(def).expect("a fair definition")
}

/// Bodies with discs, none like another.
fn discs(world: &mut World, count: i32) -> Vec<BodyId> {
    let disc = |i: i32| {
        let radius = fx!(0.5) + Fx::from_bits(i64::from(i) << 12);
        BodyDef {
            position: vec2(i % 1_000, i / 1_000),
            velocity: vec2(1, i % 3),
            angular_velocity: fx!(1),
            ..BodyDef::dynamic().with_collider(ColliderDef::ghost(Shape::circle(radius).expect("a fair radius")))
        }
    };
    (0..count).map(|i| world.add_body(disc(i)).expect("a fair body")).collect()
}

/// Bytes that a body takes of the heap in a world of `count` bodies, after two steps.
fn heap_a_body(count: i32, integrator: Integrator, def: impl Fn(i32) -> BodyDef) -> i64 {
    let mut kept = None;
    let taken = measure(|| {
        let mut world = world(integrator);
        (0..count).for_each(|i| _ = world.add_body(def(i)).expect("a fair body"));
        (0..2).for_each(|_| _ = world.step());
        kept = Some(world);
    });
    (taken.bytes_current + i64::from(count) - 1) / i64::from(count)
}

#[test]
fn a_free_body_takes_as_much_of_the_heap_as_documented() {
    let varied = |value: Fx, i: i32| value + Fx::from_bits(i.into());
    let own_disc = |i: i32| BodyDef {
        mass: Mass::Explicit { mass: varied(fx!(1), i), inertia: fx!(1) },
        ..BodyDef::dynamic()
            .with_collider(ColliderDef::ghost(Shape::circle(varied(fx!(0.5), i)).expect("a fair radius")))
    };
    // What bodies otherwise share, with a value for each.
    let nothing_shared = |i: i32| BodyDef {
        gravity_scale: varied(fx!(0.5), i),
        linear_damping: Some(Damping::kept_per_second(varied(fx!(0.5), i))),
        angular_damping: Some(Damping::kept_per_second(varied(fx!(0.5), i))),
        max_speed: Some(varied(fx!(5), i)),
        max_angular_speed: Some(varied(fx!(5), i)),
        ..own_disc(i)
    };
    let same_disc = |_| own_disc(0);
    let point = |_| BodyDef::dynamic();
    let kinds: [(i64, &dyn Fn(i32) -> BodyDef); 4] =
        [(256, &point), (896, &same_disc), (1_024, &own_disc), (1_536, &nothing_shared)];
    // Just above a size the columns grew to, where most room is to spare. The larger one by night.
    let sizes = if crate::seeds::is_short() { 1 } else { 2 };
    for (integrator, count) in
        Integrator::ALL.into_iter().flat_map(|i| [(i, 10_000), (i, 100_000)].into_iter().take(sizes))
    {
        for (max, def) in kinds {
            let max = if integrator == Integrator::PublishedVerlet { max + 256 } else { max };
            let taken = heap_a_body(count, integrator, def);
            assert!(taken <= max, "{integrator:?}, {count}: {taken} bytes each, not {max}");
        }
    }
}

#[test]
fn copies_of_a_polygon_share_their_corners() {
    let corners: Vec<Vec2> = (0..64)
        .map(|i| {
            let angle = Fx::from_int(i).checked_div(fx!(10.25)).expect("not zero");
            let (sin, cos) = angle.sin_cos();
            Vec2::new(cos, sin)
        })
        .collect();
    let shape = Shape::polygon(&corners).expect("convex");
    let bodies = |are_copies: bool| {
        let mut kept = None;
        let taken = measure(|| {
            let mut world = world(Integrator::VelocityVerlet);
            for _ in 0..1_000 {
                let shape = if are_copies { shape.clone() } else { Shape::polygon(&corners).expect("convex") };
                world.add_body(BodyDef::dynamic().with_collider(shape)).expect("a fair body");
            }
            kept = Some(world);
        });
        taken.bytes_current
    };
    let (copies, others) = (bodies(true), bodies(false));
    assert!(others - copies >= 64 * 16 * 999, "{others} bytes for polygons made apart, {copies} for copies");
}

#[test]
fn a_copy_takes_121_bytes_a_body_and_none_where_there_is_one() {
    for (integrator, each) in [(Integrator::PublishedVerlet, 169), (Integrator::VelocityVerlet, 121)] {
        let mut world = world(integrator);
        discs(&mut world, 10_000);
        world.step();
        let taken = measure(|| std::mem::forget(world.clone())).bytes_current;
        assert!((each * 10_000..each * 10_000 + 4_096).contains(&taken), "{integrator:?}: {taken}");
    }
    let mut world = world(Integrator::VelocityVerlet);
    discs(&mut world, 10_000);
    world.step();
    let mut copy = world.clone();
    world.step();
    let there_and_back = measure(|| {
        copy.clone_from(&world);
        world.step();
        world.clone_from(&copy);
    });
    assert_eq!(there_and_back.count_total, 0);
    // Shared until it is changed.
    let body = world.bodies().next().expect("there are some").id();
    let change = measure(|| world.set_user_data(body, 1).expect("it is there"));
    assert!(change.bytes_total >= 70 * 10_000, "{}", change.bytes_total);
    let again = measure(|| world.set_user_data(body, 2).expect("it is there"));
    assert!(again.bytes_total <= 1_024, "{}", again.bytes_total);
}

/// A world with everything in it, and forces applied in each tick.
fn busy(integrator: Integrator) -> impl FnMut() -> AllocationInfo {
    let mut world = world(integrator);
    let ids = discs(&mut world, 500);
    for pair in ids[..100].windows(2) {
        let near = Attachment { body: pair[0], point: vec2(fx!(0.25), 0) };
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(5), damping: fx!(0.5) };
        let far = End::Body(Attachment::centre(pair[1]));
        world.add_field(FieldKind::Spring { near, far, spring }).expect("a fair field");
    }
    let centre = End::Body(Attachment::centre(ids[200]));
    let mu = FxFactor::from_scalar(fx!(100));
    let drag = FieldKind::Drag { linear: fx!(1), quadratic: fx!(0.5), wind: vec2(3, 0) };
    let at = Attachment { body: ids[300], point: vec2(0, 1) };
    for kind in
        [FieldKind::Attractor { centre, mu, softening: fx!(1) }, drag, FieldKind::Thrust { at, force: vec2(1, 0) }]
    {
        world.add_field(ForceField { kind, force_groups: 1 }).expect("a fair field");
    }
    move || {
        measure(|| {
            for id in &ids[400..] {
                world.apply_force(*id, vec2(1, 2)).expect("a fair force");
            }
            assert!(world.step().faults.is_empty());
        })
    }
}

#[test]
fn a_step_takes_nothing_from_the_heap_after_the_first() {
    for integrator in Integrator::ALL {
        let mut free = world(integrator);
        discs(&mut free, 1_000);
        let mut tick = busy(integrator);
        // Two lists take turns: what was applied in this tick, and in the one before.
        for _ in 0..2 {
            free.step();
            tick();
        }
        for _ in 0..50 {
            let taken = measure(|| assert!(free.step().faults.is_empty()));
            assert_eq!(taken.count_total, 0, "{integrator:?}, free");
            assert_eq!(tick().count_total, 0, "{integrator:?}, with everything");
        }
    }
}

/// Each call names the hub of a wheel, or a body on its rim. The step looks at each of them once.
#[test]
fn a_step_takes_little_from_the_heap_however_often_a_body_with_many_fields_is_named() {
    let mut world = world(Integrator::VelocityVerlet);
    let ids = discs(&mut world, 401);
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(0) };
    for &rim in &ids[1..] {
        let (near, far) = (Attachment::centre(ids[0]), End::Body(Attachment::centre(rim)));
        world.add_field(FieldKind::Spring { near, far, spring }).expect("a fair field");
    }
    (0..2).for_each(|_| _ = world.step());
    for i in 0..30 {
        world.set_user_data(ids[0], i).expect("it is there");
        world.set_user_data(ids[1 + i as usize], i).expect("it is there");
    }
    let taken = measure(|| _ = world.step()).bytes_total;
    assert!(taken <= 64 * 401, "{taken} bytes");
}

#[test]
fn a_hash_takes_nothing_from_the_heap() {
    let mut world = world(Integrator::PublishedVerlet);
    let ids = discs(&mut world, 500);
    let taken = |world: &World| measure(|| _ = world.state_hash()).count_total;
    assert_eq!(taken(&world), 0);
    // The last ones stand in the gaps, few and many.
    for some in [&ids[..3], &ids[100..300]] {
        for &body in some.iter().step_by(2) {
            world.remove_body(body).expect("it is there");
        }
        assert_eq!(taken(&world), 0);
    }
}

#[test]
fn a_step_back_takes_nothing_from_the_heap_after_the_first() {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet, Integrator::Yoshida4] {
        let mut world = world(integrator);
        world.set_damping(Damping::NONE, Damping::NONE).expect("a fair damping");
        world.set_sleep_after(None).expect("a fair number");
        let ids = discs(&mut world, 500);
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(5), damping: fx!(0) };
        let (near, far) = (Attachment { body: ids[0], point: vec2(fx!(0.25), 0) }, Attachment::centre(ids[1]));
        world.add_field(FieldKind::Spring { near, far: End::Body(far), spring }).expect("a fair field");
        let mut applied = Vec::new();
        for round in 0..3 {
            for id in &ids[..400] {
                world.apply_force(*id, vec2(1, 2)).expect("a fair force");
            }
            applied.clear();
            applied.extend_from_slice(world.step().applied);
            let taken = measure(|| {
                world.step_back(&applied).expect("it has a way back");
                world.clear_forces();
            });
            assert!(round == 0 || taken.count_total == 0, "{integrator:?}");
            // Nor where it is refused.
            world.step();
            world.set_position(ids[499], vec2(fx!(1_073_741_824), 0)).expect("a fair position");
            world.set_velocity(ids[499], vec2(-90, 0)).expect("a fair velocity");
            let taken = measure(|| assert!(world.step_back(&applied).is_err()));
            assert!(round == 0 || taken.count_total == 0, "{integrator:?}");
            world.set_position(ids[499], vec2(0, 0)).expect("a fair position");
        }
    }
}

#[test]
fn a_step_takes_nothing_from_the_heap_when_a_body_first_comes_near_the_envelope() {
    let mut world = world(Integrator::VelocityVerlet);
    let ids = discs(&mut world, 200);
    world.set_damping(Damping::NONE, Damping::NONE).expect("a fair damping");
    // Half way to the edge in its 40th step or so, and out of the calm before that.
    world.set_position(ids[150], vec2(fx!(536_870_900), fx!(0))).expect("a fair position");
    world.set_velocity(ids[150], vec2(20, 0)).expect("a fair velocity");
    world.step();
    let taken = measure(|| (0..100).for_each(|_| assert!(world.step().faults.is_empty())));
    assert_eq!(taken.count_total, 0);
    assert!(world.body(ids[150]).expect("it is there").position().x > fx!(536_870_912));
}

#[test]
fn falling_asleep_takes_nothing_from_the_heap_a_second_time() {
    let mut world = world(Integrator::VelocityVerlet);
    world.set_gravity(vec2(0, 0)).expect("a fair gravity");
    let ids: Vec<BodyId> = (0..100).map(|_| world.add_body(BodyDef::dynamic()).expect("a fair body")).collect();
    let fell_asleep = |world: &mut World| {
        let mut count = 0;
        let taken = measure(|| {
            for _ in 0..40 {
                count += world.step().fell_asleep.len();
            }
        });
        assert_eq!(count, 100);
        taken.count_total
    };
    fell_asleep(&mut world);
    for id in ids {
        world.wake(id).expect("it is there");
    }
    assert_eq!(fell_asleep(&mut world), 0);
}

#[test]
fn events_take_nothing_from_the_heap_a_second_time() {
    let mut world = world(Integrator::VelocityVerlet);
    let ids = discs(&mut world, 200);
    world.set_sleep_after(None).expect("a fair number");
    world.add_body(BodyDef::fixed()).expect("a fair body");
    world.step();
    let mut told = 0;
    for round in 0..20 {
        // Adding and removing bodies takes memory itself: what no step changes is copied for it, if it is shared.
        let new = world.add_body(BodyDef::dynamic()).expect("a fair body");
        let taken = measure(|| {
            for body in &ids[..50] {
                world.set_position(*body, vec2(round, 1)).expect("it is there");
                world.set_angle(*body, fx!(1)).expect("it is there");
            }
            world.remove_body(new).expect("it is there");
            told += world.step().events().count();
            told += world.changed_since(world.tick() - 1).count();
        });
        assert!(round < 2 || taken.count_total == 0, "{taken:?}");
    }
    assert_eq!(told, 20 * (50 + 200));
}

#[cfg(feature = "float")]
#[test]
fn a_look_takes_nothing_from_the_heap_while_no_slots_are_added() {
    use umbra_physics::{Blend, Interpolation, TickFraction};

    let mut world = world(Integrator::VelocityVerlet);
    discs(&mut world, 200);
    let mut interpolation = Interpolation::new();
    let mut look = |world: &World| {
        let mut shown = 0;
        let taken = measure(|| {
            interpolation.look(world);
            shown = interpolation.poses(Blend::Interpolated(TickFraction::ONE)).count();
        });
        (taken.count_total, shown)
    };
    assert!(look(&world).0 > 0);
    // Slots that are empty for a while, in between and at the end, and taken again.
    for round in 0..20 {
        assert_eq!(look(&world), (0, 200), "round {round}");
        let first = if round % 2 == 0 { 50 } else { 190 };
        let gone: Vec<BodyId> = world.bodies().skip(first).take(10).map(|body| body.id()).collect();
        for body in gone {
            world.remove_body(body).expect("it is there");
        }
        world.step();
        assert_eq!(look(&world), (0, 190), "round {round}");
        discs(&mut world, 10);
        world.step();
    }
    assert!(world.bodies().all(|body| body.id().parts().0 < 200));
}

#[test]
fn bodies_that_come_and_go_without_a_step_take_nothing_for_good() {
    let mut world = world(Integrator::VelocityVerlet);
    let ids = discs(&mut world, 20);
    world.step();
    let mut come_and_go = |times: u32| {
        for _ in 0..times {
            let body = world.add_body(BodyDef::dynamic()).expect("a fair body");
            world.remove_body(body).expect("it is there");
            // Bodies that slept, that woke again, and that slept when they were disabled.
            let [sleeper, riser, napper] = [(); 3].map(|()| world.add_body(BodyDef::dynamic()).expect("a fair body"));
            for body in [sleeper, riser, napper, ids[3]] {
                world.sleep(body).expect("it is there");
            }
            world.wake(riser).expect("it is there");
            world.wake(ids[3]).expect("it is there");
            world.disable(napper).expect("it is there");
            for body in [riser, napper, sleeper] {
                world.remove_body(body).expect("it is there");
            }
        }
    };
    // The log of changed bodies grows up to 4,096 entries, and then begins anew.
    come_and_go(1_000);
    let taken = measure(|| come_and_go(10_000));
    assert_eq!(taken.bytes_current, 0);
}

/// Applies a force and an impulse to every seventh body, at other bodies for other buttons.
fn pushes(world: &mut World, ids: &[BodyId], buttons: u8) {
    for &body in ids.iter().skip(usize::from(buttons)).step_by(7) {
        world.apply_force_at_point(body, vec2(1, 2), vec2(3, 4)).expect("a fair force");
        world.apply_impulse(body, vec2(fx!(0.125), 0)).expect("a fair impulse");
    }
}

#[test]
fn a_rollback_takes_nothing_from_the_heap_once_its_window_is_full() {
    let mut world = world(Integrator::VelocityVerlet);
    let ids = discs(&mut world, 300);
    for pair in ids[..40].windows(2) {
        let (near, far) = (Attachment::centre(pair[0]), End::Body(Attachment::centre(pair[1])));
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(5), damping: fx!(0.5) };
        world.add_field(FieldKind::Spring { near, far, spring }).expect("a fair field");
    }
    let mut rollback = Rollback::new(&world, [0, 1], 12);
    let (mut taken, mut redone, mut confirmed) = (0, 0, 0);
    for now in 0..400 {
        let report = measure(|| {
            rollback.add_input(now, 0, now as u8 % 7).expect("a player");
            // Two to twelve ticks late, and mostly not as predicted.
            for late in now.saturating_sub(12)..now {
                if late + 2 + late * 10 % 12 == now {
                    rollback.add_input(late, 1, late as u8 / 2 % 7).expect("a player");
                }
            }
            let tick = |world: &mut World, inputs: &[(u32, u8)]| {
                inputs.iter().for_each(|(_, buttons)| pushes(world, &ids, *buttons));
            };
            let report = rollback.advance(&mut world, tick).expect("nothing else changes the world");
            assert_eq!(report.waits_for, None);
            redone += report.redone;
            confirmed += report.confirmed().filter(|tick| !tick.commands.is_empty()).count();
        });
        taken += report.count_total;
        // By then every list has been as long as any gets.
        if now == 200 {
            (taken, redone, confirmed) = (0, 0, 0);
        }
    }
    assert!(redone > 500 && confirmed > 180, "{redone}, {confirmed}");
    assert_eq!(taken, 0);
}

#[test]
fn naming_a_changed_bit_takes_a_few_times_the_file() {
    let mut world = world(Integrator::VelocityVerlet);
    discs(&mut world, 2_000);
    let mut file = Recorder::new(&world, RecordOptions::default()).finish(&world);
    // Amid the bodies, which come after the colliders.
    let middle = file.len() / 4 * 3;
    file[middle] ^= 1;
    let took = measure(|| {
        let error = Replay::from_bytes(&file, &[]).expect_err("it was changed");
        assert!(matches!(error, ReplayError::Tampered(found) if matches!(found.owner, Owner::Body(_))));
    });
    let times = took.bytes_max / file.len() as u64;
    assert!(times <= 12, "{times} times {} bytes", file.len());
}
