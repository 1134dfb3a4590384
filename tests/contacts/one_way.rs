//! One-way colliders: against free flight where a body passes, and against a solid collider where it is held.

use super::scenes::{def, through_bytes, world};
use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, ColliderDef, Error, Filter, Fx, Geometry, Irreversible, OneWay, Part, Shape,
    Snapshot, Symmetry, Vec2, World, WorldDef, fx, vec2,
};

fn up() -> Option<OneWay> {
    Some(OneWay::default())
}

/// A static plank of 8 m by 0.25 m in the origin.
fn plank(one_way: Option<OneWay>) -> BodyDef {
    let shape = Shape::rectangle(8, fx!(0.25)).expect("a plank");
    BodyDef { key: 1, ..BodyDef::fixed().with_collider(ColliderDef { one_way, key: 1, ..ColliderDef::new(shape) }) }
}

fn disc(at: Vec2, velocity: Vec2) -> BodyDef {
    let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc"));
    BodyDef { position: at, velocity, key: 2, ..ball }
}

fn square(at: Vec2) -> BodyDef {
    let shape = Shape::rectangle(1, 1).expect("a square");
    BodyDef { position: at, key: 2, ..BodyDef::dynamic().with_collider(shape) }
}

/// The world with a plank and another body, and the handle of that.
fn over(platform: BodyDef, body: BodyDef) -> (World, BodyId) {
    let (world, ids) = world(def(), [platform, body]).expect("a scene");
    (world, ids[1])
}

/// The first tick, of so many, after which two bodies are not in the same state to the bit.
fn parting(here: &mut (World, BodyId), twin: &mut (World, BodyId), ticks: usize) -> Option<usize> {
    (0..ticks).find(|_| {
        here.0.step();
        twin.0.step();
        let [a, b] = [&*here, &*twin].map(|(world, body)| world.body(*body).expect("it is there"));
        a.first_difference(&b).is_some()
    })
}

#[test]
fn a_body_from_below_flies_freely_at_any_speed_and_lands() {
    for speed in [4, 7, 10, 60, 500] {
        for x in [fx!(0), fx!(1.75), fx!(3.9)] {
            let ball = disc(Vec2::new(x, fx!(-0.75)), vec2(0, speed));
            let mut here = over(plank(up()), ball.clone());
            let mut free = over(plank(None), ball.clone());
            let platform = free.0.bodies().next().expect("the plank").id();
            free.0.remove_body(platform).expect("the plank");
            let parted = parting(&mut here, &mut free, 150 * speed as usize);
            let look = free.0.body(free.1).expect("it").position();
            if speed == 4 {
                // It rises by 0.8 m: not above the plank.
                assert_eq!(parted, None);
                continue;
            }
            // The free one is on its way down, and about to touch the plank from above.
            assert!(parted.is_some(), "{speed} m/s at {x}");
            assert!(free.0.body(free.1).expect("it").velocity().y < fx!(0), "{speed} m/s");
            assert!(look.y < fx!(0.65) && look.y > fx!(0.6) - Fx::from(speed) / 50, "{speed} m/s: {look}");
            (0..300).for_each(|_| _ = here.0.step());
            let rests = here.0.body(here.1).expect("it").position();
            assert!(x > fx!(3) || (rests.y - fx!(0.625)).abs() < fx!(0.01), "{speed} m/s: {rests}");
        }
    }
}

#[test]
fn nothing_falls_through_that_a_solid_collider_holds() {
    for speed in [0, 1, 20, 200, 800] {
        let ball = disc(vec2(0, 30), vec2(0, -speed));
        let mut solid = over(plank(None), ball.clone());
        assert_eq!(parting(&mut over(plank(up()), ball), &mut solid, 600), None, "{speed} m/s");
        assert!(solid.0.body(solid.1).expect("it").position().y > fx!(0), "{speed} m/s");
    }
}

/// A box at the edge of a platform tilts and slides off: one that is held stays held, whatever its normal.
#[test]
fn a_box_slides_over_the_edge_as_from_a_solid_collider() {
    for (x, kick) in [(fx!(4.02), fx!(0)), (fx!(3.9), fx!(1)), (fx!(4.2), fx!(0.25)), (fx!(3), fx!(3))] {
        let body = BodyDef { velocity: Vec2::new(kick, fx!(0)), ..square(Vec2::new(x, fx!(0.625))) };
        let mut here = over(plank(up()), body.clone());
        assert_eq!(parting(&mut here, &mut over(plank(None), body), 240), None, "{x}");
        let fallen = here.0.body(here.1).expect("it");
        assert!(x == fx!(3) || fallen.position().y < fx!(-2), "{}", fallen.position());
    }
}

/// Kicks of all sizes from the rest: those that lift a body by less than a millimetre, and those that make it jump.
#[test]
fn a_body_that_is_lifted_comes_down_again() {
    let (mut here, mut solid) = (over(plank(up()), square(vec2(0, 1))), over(plank(None), square(vec2(0, 1))));
    assert_eq!(parting(&mut here, &mut solid, 60), None);
    let mut speed = fx!(0.0005);
    while speed < fx!(8) {
        for (world, body) in [&mut here, &mut solid] {
            world.set_velocity(*body, Vec2::new(fx!(0), speed)).expect("a velocity");
            world.set_angular_velocity(*body, speed / 16).expect("a velocity");
        }
        assert_eq!(parting(&mut here, &mut solid, 130), None, "{speed} m/s");
        speed += speed / 3;
    }
}

/// 5 cm deep in the platform without any impulse: a heavy load made a body sink, and a kick lifts it.
#[test]
fn a_body_that_is_held_stays_so_without_impulses() {
    let (mut world, body) = over(plank(up()), square(vec2(0, fx!(0.63))));
    (0..30).for_each(|_| _ = world.step());
    // A call moves it: it keeps the answer, as it keeps impulses.
    world.set_position(body, vec2(0, fx!(0.575))).expect("a position");
    for _ in 0..10 {
        world.set_velocity(body, vec2(0, fx!(0.5))).expect("a velocity");
        world.step();
    }
    (0..120).for_each(|_| _ = world.step());
    assert!((world.body(body).expect("it").position().y - fx!(0.625)).abs() < fx!(0.01));
}

#[test]
fn a_platform_that_moves_carries_and_lets_through() {
    let platform =
        |y: Fx| BodyDef { kind: umbra_physics::BodyKind::Kinematic, position: Vec2::new(fx!(0), y), ..plank(up()) };
    // Up under a body, and down upon one.
    for (from, speed, carries) in [(fx!(-2), fx!(3), true), (fx!(3), fx!(-3), false)] {
        let still = BodyDef { gravity_scale: fx!(0), ..disc(vec2(0, 0), vec2(0, 0)) };
        let moving = BodyDef { velocity: Vec2::new(fx!(0), speed), ..platform(from) };
        let (mut world, body) = over(moving, still);
        (0..180).for_each(|_| _ = world.step());
        let height = world.body(body).expect("it").position().y;
        assert!(if carries { height > fx!(7) } else { height == fx!(0) }, "{height}");
    }
}

#[test]
fn two_one_way_colliders_touch_if_both_hold() {
    let facing = |x, y| Some(OneWay { direction: vec2(x, y), ..OneWay::default() });
    for (below, above, holds) in [
        (facing(0, 1), facing(0, -1), true),
        (facing(0, 1), facing(0, 1), false),
        (facing(0, -1), facing(0, -1), false),
        (facing(3, 1), facing(0, -1), false),
        (facing(0, 2), None, true),
    ] {
        let mut body = square(vec2(0, 2));
        body.colliders[0].one_way = above;
        let (mut world, body) = over(plank(below), body);
        (0..120).for_each(|_| _ = world.step());
        assert_eq!(world.body(body).expect("it").position().y > fx!(0.6), holds, "{below:?} {above:?}");
    }
}

/// A body of several colliders passes as one: the upper does not land while the lower one is still below.
#[test]
fn a_body_of_several_colliders_passes_as_one() {
    let wheel = |y| ColliderDef {
        position: Vec2::new(fx!(0), y),
        ..ColliderDef::new(Shape::circle(fx!(0.25)).expect("a disc"))
    };
    let part = |y| Part {
        shape: Shape::circle(fx!(0.25)).expect("a disc"),
        position: Vec2::new(fx!(0), y),
        angle: fx!(0),
        density: fx!(1),
    };
    let by_parts = Shape::compound(&[part(fx!(-0.25)), part(fx!(0.25))]).expect("a compound");
    let both = [vec![wheel(fx!(-0.25)), wheel(fx!(0.25))], vec![ColliderDef::new(by_parts)]];
    for colliders in both {
        // A jump of 1.5 m: the lower disc gets through, and both land; one of 0.95 m: the upper one alone.
        for (speed, lands) in [(fx!(5.5), true), (fx!(4.36), false)] {
            let body =
                BodyDef { position: vec2(0, fx!(-0.65)), velocity: Vec2::new(fx!(0), speed), ..BodyDef::dynamic() };
            let (mut world, body) = over(plank(up()), BodyDef { colliders: colliders.clone(), ..body });
            (0..110).for_each(|_| _ = world.step());
            assert_eq!(world.body(body).expect("it").position().y > fx!(0.5), lands, "{speed} m/s");
        }
    }
}

/// Each part of a compound is a platform of its own: a body on the lower floor jumps through the upper one.
#[test]
fn each_part_of_a_compound_is_a_platform() {
    let floor = |y: i32| Part {
        shape: Shape::rectangle(6, fx!(0.25)).expect("a floor"),
        position: vec2(0, y),
        angle: fx!(0),
        density: fx!(1),
    };
    let house =
        ColliderDef { one_way: up(), ..ColliderDef::new(Shape::compound(&[floor(-1), floor(1)]).expect("floors")) };
    let (mut world, body) = over(BodyDef::fixed().with_collider(house), disc(vec2(0, 0), vec2(0, 0)));
    (0..60).for_each(|_| _ = world.step());
    let rests = |world: &World, y: Fx| (world.body(body).expect("it").position().y - y).abs() < fx!(0.01);
    assert!(rests(&world, fx!(-0.375)));
    world.set_velocity(body, vec2(0, 8)).expect("a velocity");
    (0..150).for_each(|_| _ = world.step());
    assert!(rests(&world, fx!(1.625)));
}

/// Bodies of all shapes that are thrown through tilted platforms, of every kind.
fn rain() -> Vec<BodyDef> {
    let mut bodies = Vec::new();
    for i in 0..4 {
        let def = plank(Some(OneWay { direction: vec2(i - 1, 3), tolerance: fx!(1) }));
        let position = vec2(2 * i, 3 * i);
        let mut def = BodyDef { position, angle: Fx::from_ratio(i.into(), 7), key: 100 + i as u64, ..def };
        def.colliders[0].angle = Fx::from_ratio(i.into(), 9);
        def.colliders[0].key = def.key;
        if i == 3 {
            def = BodyDef { kind: umbra_physics::BodyKind::Kinematic, angular_velocity: fx!(0.5), ..def };
        }
        bodies.push(def);
    }
    let shapes = [Shape::circle(fx!(0.25)), Shape::rectangle(fx!(0.5), fx!(0.75)), Shape::capsule(fx!(0.5), fx!(0.25))];
    for i in 0..24 {
        let shape = shapes[i as usize % 3].clone().expect("a shape");
        let mut collider = ColliderDef { key: i, ..ColliderDef::new(shape) };
        // Some are one-way themselves.
        collider.one_way = (i % 5 == 0).then(|| OneWay { direction: vec2(0, -1), tolerance: fx!(1.2) });
        let (x, y) = (i as i32 % 6, i as i32 / 6);
        let body = BodyDef { position: vec2(x, 2 * y - 4), velocity: vec2(x - 3, 12 - y), ..BodyDef::dynamic() };
        bodies.push(BodyDef { angular_velocity: fx!(1), key: i, ..body.with_collider(collider) });
    }
    bodies
}

#[test]
fn the_images_and_other_orders_have_the_same_bits() {
    let (mut here, _) = world(def(), rain()).expect("a scene");
    let symmetries = [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN];
    let mut images = symmetries.map(|symmetry| symmetry.world(&here).expect("an image"));
    let mut other_way = rain();
    other_way.reverse();
    let (mut reversed, _) = world(def(), other_way).expect("a scene");
    let (mut passing, mut held) = (0, 0);
    for tick in 0..240 {
        here.step();
        reversed.step();
        assert_eq!(here.physics_hash(), reversed.physics_hash(), "{tick}");
        for (symmetry, image) in symmetries.iter().zip(&mut images) {
            image.step();
            let expected = symmetry.world(&here).expect("an image");
            assert_eq!(expected.first_difference(image), None, "{tick} {}", symmetry.name());
        }
        // From bytes in each step.
        let bytes = here.snapshot().to_bytes();
        here = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        assert_eq!(here.snapshot().to_bytes(), bytes);
        let text = format!("{:?}", here.differences(&World::new(def()).expect("a world")));
        passing += text.matches("].passes\", left: Some(\"true\")").count();
        held += text.matches("].passes\", left: Some(\"false\")").count();
    }
    assert!(passing > 300 && held > 300, "{passing} {held}");
}

#[test]
fn a_body_put_into_a_platform_passes_and_one_put_on_it_is_held() {
    for (y, holds) in [(fx!(0.625), true), (fx!(0.61), true), (fx!(0.55), false), (fx!(0.1), false), (fx!(-0.5), false)]
    {
        let at = Vec2::new(fx!(0), y);
        let (mut added, body) = over(plank(up()), disc(at, vec2(0, 0)));
        let (mut moved, moved_body) = over(plank(up()), disc(vec2(0, 50), vec2(0, 0)));
        moved.step();
        moved.set_position(moved_body, at).expect("a position");
        for (world, body) in [(&mut added, body), (&mut moved, moved_body)] {
            (0..60).for_each(|_| _ = world.step());
            assert_eq!(world.body(body).expect("it").position().y > fx!(0.5), holds, "{y}");
        }
    }
}

/// The answer belongs to the collider and to the body: it goes with either, before its slot is used again.
#[test]
fn changes_of_a_platform_decide_anew() {
    let (mut world, body) = over(plank(up()), disc(vec2(0, fx!(-0.5)), vec2(0, 6)));
    (0..4).for_each(|_| _ = world.step());
    let platform = world.bodies().next().expect("the plank").id();
    let collider = world.colliders_of(platform).expect("it").next().expect("one");
    assert!(world.body(body).expect("it").position().y.abs() < fx!(0.25)); // in the middle of it
    // Solid from now on: it is pushed out.
    let mut solid = world.clone();
    solid.set_collider(collider, plank(None).colliders.remove(0)).expect("a collider");
    solid.step();
    assert!(solid.body(body).expect("it").velocity().y < fx!(5)); // from 5.3 m/s
    // Another one in the same slot, that holds from below: it passes, as it overlaps.
    let mut replaced = world.clone();
    replaced.remove_collider(collider).expect("a collider");
    let down = OneWay { direction: vec2(0, -1), ..OneWay::default() };
    let again = replaced.add_collider(platform, plank(Some(down)).colliders.remove(0)).expect("a collider");
    assert_eq!(again.parts().0, collider.parts().0);
    assert!(!format!("{:?}", replaced.differences(&World::new(def()).expect("a world"))).contains("passes"));
    replaced.step();
    assert_eq!(replaced.contacts_of(body).expect("it").count(), 0);
    // Another body in the same slot, and nothing is left of the one before.
    world.remove_body(body).expect("a body");
    let on_it = world.add_body(disc(vec2(0, fx!(0.615)), vec2(0, 0))).expect("a body");
    assert_eq!(on_it.parts().0, body.parts().0);
    (0..60).for_each(|_| _ = world.step());
    assert!(world.body(on_it).expect("it").position().y > fx!(0.6));
}

/// A body that crouches on a platform gets another shape, and stays on it.
#[test]
fn a_body_that_gets_another_shape_keeps_its_answer() {
    let (mut world, body) = over(plank(up()), square(vec2(0, fx!(0.625))));
    (0..30).for_each(|_| _ = world.step());
    let collider = world.colliders_of(body).expect("it").next().expect("one");
    let low = Shape::rectangle(1, fx!(0.5)).expect("a box");
    world
        .set_collider(collider, ColliderDef { position: vec2(0, fx!(-0.3)), ..ColliderDef::new(low) })
        .expect("a collider");
    (0..60).for_each(|_| _ = world.step());
    assert!((world.body(body).expect("it").position().y - fx!(0.675)).abs() < fx!(0.01));
}

#[test]
fn sleepers_in_a_platform_sleep_on_and_pass_when_they_wake() {
    let def = WorldDef { sleep_after: Some(5), gravity: vec2(0, 0), ..def() };
    let (mut world, ids) = world(def, [plank(up()), disc(vec2(0, fx!(0.2)), vec2(0, 0))]).expect("a scene");
    let mut awake = world.clone();
    awake.set_sleep_after(None).expect("no sleep");
    for tick in 0..40 {
        world.step();
        awake.step();
        if tick == 20 {
            assert_eq!(world.body(ids[1]).expect("it").activity(), Activity::Asleep);
            // A change of another static body has all looked at again.
            for world in [&mut world, &mut awake] {
                world.add_body(BodyDef { position: vec2(50, 0), ..plank(None) }).expect("a body");
            }
        }
    }
    for world in [&mut world, &mut awake] {
        world.set_velocity(ids[1], vec2(0, -1)).expect("a velocity");
        (0..60).for_each(|_| _ = world.step());
        assert_eq!(world.body(ids[1]).expect("it").position(), vec2(0, fx!(0.2)) - vec2(0, 1));
    }
}

/// The answers for bodies that stand still follow each change of a collider, as in a world that is restored and does not know what has
/// changed.
#[test]
fn a_change_near_a_sleeping_platform_has_the_result_of_a_restored_world() {
    let still = |body: BodyDef| BodyDef { kind: BodyKind::Static, ..body };
    let disc = || disc(vec2(0, fx!(0.2)), vec2(0, 0));
    let flying = || BodyDef { kind: BodyKind::Dynamic, ..plank(up()) };
    let second = ColliderDef {
        position: vec2(fx!(0.5), fx!(-0.375)),
        ..ColliderDef::new(Shape::circle(fx!(0.25)).expect("a disc"))
    };
    let two = || disc().with_collider(second.clone());
    for (platform, body) in
        [(flying(), still(disc())), (plank(up()), disc()), (flying(), still(two())), (plank(up()), two())]
    {
        let round = |radius: Fx| ColliderDef::new(Shape::circle(radius).expect("a disc"));
        let changes = [
            None,
            Some(ColliderDef { filter: Filter { mask: 2, ..Filter::default() }, ..round(fx!(0.5)) }),
            Some(ColliderDef { sensor: true, ..round(fx!(0.5)) }),
            Some(round(fx!(0.01))),
            Some(round(fx!(0.4))),
        ];
        for change in changes {
            let def = WorldDef { sleep_after: Some(5), gravity: vec2(0, 0), ..def() };
            let (mut world, ids) = world(def, [platform.clone(), body.clone()]).expect("a scene");
            (0..20).for_each(|_| _ = world.step());
            assert_eq!(world.moving_count(), 0);
            let collider = world.colliders_of(ids[1]).expect("it").next().expect("a disc");
            match change.clone() {
                Some(def) => world.set_collider(collider, def),
                None => world.remove_collider(collider),
            }
            .expect("a change");
            for tick in 0..3 {
                let mut restored = through_bytes(&world);
                world.step();
                restored.step();
                assert_eq!(restored.first_difference(&world), None, "{change:?} {tick}");
            }
        }
    }
}

#[test]
fn a_body_that_does_not_leave_a_platform_falls_back_through_it() {
    let foot =
        |y: Fx| ColliderDef { position: vec2(0, y), ..ColliderDef::new(Shape::circle(fx!(0.25)).expect("a disc")) };
    let pair = |low, high| BodyDef {
        position: vec2(0, -4),
        velocity: vec2(0, fx!(8.5)),
        ..BodyDef::dynamic().with_collider(foot(low)).with_collider(foot(high))
    };
    // At the top the disc is 1 cm deep in it; of two colliders one is above it, and the other one below.
    for body in [disc(vec2(0, -3), vec2(0, fx!(8.5))), pair(fx!(-0.6), fx!(0.6)), pair(fx!(0.6), fx!(-0.6))] {
        let (mut here, mut free) = (over(plank(up()), body.clone()), over(plank(None), body));
        let platform = free.0.bodies().next().expect("the plank").id();
        free.0.remove_body(platform).expect("the plank");
        assert_eq!(parting(&mut here, &mut free, 150), None);
    }
}

#[test]
fn a_step_near_a_platform_cannot_be_undone() {
    let def = WorldDef { sleep_after: None, ..def() };
    let (mut world, _) = world(def, [plank(up()), disc(vec2(0, -3), vec2(0, 9))]).expect("a scene");
    let (mut undone, mut refused) = (0, 0);
    for _ in 0..60 {
        let before = world.snapshot().to_bytes();
        world.step();
        let mut back = world.clone();
        match back.step_back(&[]) {
            Ok(()) => {
                assert_eq!(back.snapshot().to_bytes(), before);
                undone += 1;
            }
            Err(error) => {
                assert_eq!(error, Error::NotReversible { why: Irreversible::Contact });
                refused += 1;
            }
        }
    }
    assert!(undone > 20 && refused > 8, "{undone} {refused}");
}

#[cfg(feature = "float")]
#[test]
fn floats_pass_and_land_as_well() {
    fn run<S: umbra_physics::Scalar>(bodies: impl IntoIterator<Item = BodyDef<S>>, gravity: Vec2<S>) -> S {
        let def = WorldDef { gravity, ..WorldDef::default() };
        let mut world = World::with_scalar(def).expect("a world");
        let ids: Vec<BodyId> = bodies.into_iter().map(|body| world.add_body(body).expect("a body")).collect();
        (0..240).for_each(|_| _ = world.step());
        world.body(ids[1]).expect("it").position().y
    }
    fn scene<S: umbra_physics::Scalar>() -> [BodyDef<S>; 2] {
        let number = |value: Fx| S::from_fx(value);
        let shape =
            Shape::new(Geometry::Rectangle { width: number(fx!(8)), height: number(fx!(0.25)) }).expect("a plank");
        let plank = ColliderDef { one_way: Some(OneWay::default()), ..ColliderDef::new(shape) };
        let ball = BodyDef {
            position: Vec2::new(S::ZERO, number(fx!(-2))),
            velocity: Vec2::new(S::ZERO, number(fx!(9))),
            ..BodyDef::dynamic()
        };
        let disc = Shape::new(Geometry::Circle { radius: number(fx!(0.5)) }).expect("a disc");
        [BodyDef::fixed().with_collider(plank), ball.with_collider(disc)]
    }
    assert!((run(scene::<f64>(), Vec2::new(0.0, -10.0)) - 0.625).abs() < 0.01);
    assert!((run(scene::<f32>(), Vec2::new(0.0, -10.0)) - 0.625).abs() < 0.01);
}
