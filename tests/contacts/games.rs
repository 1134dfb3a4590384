//! Cases that games meet: platforms, locks, caps, teleports, kinds, one body with several colliders.

use super::scenes::{def, ground, material, square, world};
use umbra_physics::{
    BodyDef, BodyKind, ColliderDef, Command, Fx, Locks, RecordOptions, Recorder, Replay, Rollback, Shape, Vec2, World,
    WorldDef, fx, vec2,
};

fn at(world: &World, body: umbra_physics::BodyId) -> Vec2 {
    world.body(body).expect("a body").position()
}

#[test]
fn a_platform_carries_riders_and_arrives_to_the_bit() {
    let platform = BodyDef { position: vec2(0, fx!(-0.5)), ..BodyDef::kinematic() }.with_collider(ColliderDef {
        material: material(fx!(1), fx!(0)),
        ..ColliderDef::new(Shape::rectangle(10, 1).expect("it"))
    });
    let (mut world, ids) = world(def(), [platform, square(vec2(0, fx!(0.5)), 1).expect("a square")]).expect("a scene");
    (0..30).for_each(|_| _ = world.step());
    for tick in 0..240i32 {
        // Sideways, and up and down.
        let to = vec2(
            Fx::from_ratio(tick.into(), 120),
            fx!(-0.5) + Fx::from_ratio((tick % 60).min(60 - tick % 60).into(), 240),
        );
        world.move_to(ids[0], to, fx!(0)).expect("it is near");
        world.step();
        assert_eq!(at(&world, ids[0]), to);
    }
    let rider = at(&world, ids[1]) - at(&world, ids[0]);
    assert!((rider.x).abs() < fx!(0.1) && (rider.y - fx!(1)).abs() < fx!(0.02), "{rider}");
}

#[test]
fn rounded_boxes_stand_on_each_other() {
    let core = |half: Fx| [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(x, y)| vec2(half * x, half * y));
    let rounded = |half, radius| Shape::rounded_polygon(&core(half), radius).expect("a box");
    // A metre wide in all, of it 0.4 m flat on each side of the middle.
    let placed =
        |x: Fx, y: Fx, shape: Shape| BodyDef { position: vec2(x, y), ..BodyDef::dynamic().with_collider(shape) };
    let stack = (0..5).map(|row| placed(fx!(0), fx!(0.5) + row.into(), rounded(fx!(0.4), fx!(0.1))));
    let (mut stacked, ids) = world(def(), [ground().expect("it")].into_iter().chain(stack)).expect("a scene");
    (0..600).for_each(|_| _ = stacked.step());
    for (row, id) in (0i32..).zip(&ids[1..]) {
        let off = at(&stacked, *id) - vec2(fx!(0), fx!(0.5) + row.into());
        assert!(off.x == fx!(0) && off.y.abs() < fx!(0.02), "{row}: {off}");
    }
}

#[test]
fn a_plate_pushes_a_row_and_a_turning_bar_throws() {
    let plate = BodyDef { position: vec2(-5, fx!(0.75)), velocity: vec2(2, 0), ..BodyDef::kinematic() }
        .with_collider(Shape::rectangle(fx!(0.5), fx!(1.5)).expect("it"));
    let row = (0..5).map(|i| square(vec2(i, fx!(0.5)), i as u64).expect("a square"));
    let bodies = [ground().expect("it"), plate].into_iter().chain(row);
    let (mut scene, ids) = world(def(), bodies).expect("a scene");
    (0..300).for_each(|_| _ = scene.step());
    assert_eq!(at(&scene, ids[1]), vec2(5, fx!(0.75)));
    for (i, id) in ids[2..].iter().enumerate() {
        let behind = at(&scene, *id).x - fx!(5.75) - (i as i32).into();
        assert!(behind > fx!(-0.05) && behind < fx!(0.3), "{i}: {behind}");
    }
    let bar = BodyDef { angular_velocity: fx!(5), ..BodyDef::kinematic() }
        .with_collider(Shape::rectangle(4, fx!(0.2)).expect("it"));
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut thrown, ids) = world(still, [bar, square(vec2(fx!(1.4), fx!(1)), 1).expect("it")]).expect("a scene");
    (0..30).for_each(|_| _ = thrown.step());
    assert!(thrown.body(ids[1]).expect("it").velocity().length() > fx!(4));
    assert_eq!(thrown.body(ids[0]).expect("it").angular_velocity(), fx!(5));
}

#[test]
fn locks_and_caps_hold_in_contacts() {
    let locked = BodyDef {
        locks: Locks { x: true, rotation: true, ..Locks::NONE },
        ..square(vec2(0, fx!(2.2)), 1).expect("it")
    };
    let capped = BodyDef { max_speed: Some(fx!(1)), ..square(vec2(fx!(0.3), fx!(4)), 2).expect("it") };
    let pusher = BodyDef { velocity: vec2(20, 0), ..square(vec2(-4, fx!(4.2)), 3).expect("it") };
    let slope = BodyDef { position: vec2(0, 0), angle: fx!(0.3), ..ground().expect("it") };
    let (mut world, ids) = world(def(), [slope, locked, capped, pusher]).expect("a scene");
    for _ in 0..200 {
        world.step();
        assert_eq!((at(&world, ids[1]).x, world.body(ids[1]).expect("it").angle()), (fx!(0), fx!(0)));
        let speed = world.body(ids[2]).expect("it").velocity().length();
        assert!(speed <= fx!(1) + Fx::DELTA, "{speed}");
    }
    assert!(world.contacts_of(ids[1]).expect("it").count() > 0);
}

#[test]
fn a_body_of_infinite_inertia_does_not_turn_and_several_colliders_are_one_body() {
    let leg = |x: i32| ColliderDef {
        position: vec2(x, fx!(-0.5)),
        ..ColliderDef::new(Shape::rectangle(fx!(0.2), fx!(0.8)).expect("it"))
    };
    let top = ColliderDef::new(Shape::rectangle(fx!(2.4), fx!(0.2)).expect("it"));
    let table = BodyDef { position: vec2(0, 1), colliders: vec![top, leg(-1), leg(1)], ..BodyDef::dynamic() };
    let (mut world, ids) =
        world(def(), [ground().expect("it"), table, square(vec2(0, 3), 1).expect("it")]).expect("a scene");
    (0..180).for_each(|_| _ = world.step());
    assert!((at(&world, ids[1]).y - fx!(0.9)).abs() < fx!(0.01), "{}", at(&world, ids[1]));
    assert!((at(&world, ids[2]).y - fx!(1.5)).abs() < fx!(0.02), "{}", at(&world, ids[2]));
    assert_eq!(world.contacts_of(ids[1]).expect("it").count(), 3);
    // Kept from turning, it stands on one leg.
    let legs: Vec<_> = world.colliders_of(ids[1]).expect("it").collect();
    world.set_locks(ids[1], Locks { rotation: true, ..Locks::NONE }).expect("it");
    world.remove_collider(legs[1]).expect("it");
    (0..120).for_each(|_| _ = world.step());
    assert!((at(&world, ids[1]).y - fx!(0.9)).abs() < fx!(0.02));
}

#[test]
fn teleports_and_changes_of_kind_keep_worlds_whole() {
    let stack = (0..6).map(|row| square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("it"));
    let (mut world, ids) = world(def(), [ground().expect("it")].into_iter().chain(stack)).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    // A correction by a millimetre, as games make it, does not shake the stack.
    let place = at(&world, ids[3]);
    world.set_position(ids[3], place + vec2(fx!(0.001), 0)).expect("it");
    world.step();
    assert!(world.bodies().all(|body| body.velocity().length() < fx!(0.1)));
    // Two change places.
    let [low, high] = [at(&world, ids[2]), at(&world, ids[5])];
    world.set_position(ids[2], high).expect("it");
    world.set_position(ids[5], low).expect("it");
    (0..120).for_each(|_| _ = world.step());
    assert!((at(&world, ids[2]).y - high.y).abs() < fx!(0.02));
    // A static one in the middle holds those above; those below stay where they are when it is dynamic again.
    world.set_kind(ids[3], BodyKind::Static).expect("it");
    world.remove_body(ids[1]).expect("it");
    (0..120).for_each(|_| _ = world.step());
    assert!(at(&world, ids[4]).y > fx!(3.4) && at(&world, ids[5]).y < fx!(0.6));
    world.set_kind(ids[3], BodyKind::Dynamic).expect("it");
    (0..120).for_each(|_| _ = world.step());
    assert!(at(&world, ids[3]).y < fx!(2) && world.bodies().all(|body| body.velocity().length() < fx!(0.1)));
    // Into another one: out again, at a bounded speed.
    let inside = at(&world, ids[4]) + vec2(fx!(0.1), fx!(0.2));
    world.set_position(ids[6], inside).expect("it");
    for _ in 0..120 {
        world.step();
        assert!(world.bodies().all(|body| body.velocity().length() < fx!(6)));
    }
}

/// A disc at 5 m/s along the floor and 5 m/s towards it, with μ = 0.1: it slides through the impact, whose whole impulse friction sees:
/// μ·(1 + e) of the speed. (At 1/3 of its slip it would roll.)
#[test]
fn friction_at_a_bounce_is_that_of_the_whole_impulse() {
    for restitution in [fx!(0), fx!(0.5), fx!(1)] {
        let surface = material(fx!(0.1), restitution);
        let floor = ColliderDef { material: surface, ..ColliderDef::new(Shape::rectangle(100, 2).expect("it")) };
        let disc = ColliderDef { material: surface, ..ColliderDef::new(Shape::circle(fx!(0.5)).expect("it")) };
        let floor = BodyDef { position: vec2(0, -1), ..BodyDef::fixed().with_collider(floor) };
        let disc =
            BodyDef { position: vec2(0, fx!(2.5)), velocity: vec2(5, -5), ..BodyDef::dynamic().with_collider(disc) };
        let still = WorldDef { gravity: vec2(0, 0), ..def() };
        let (mut world, ids) = world(still, [floor, disc]).expect("a scene");
        (0..60).for_each(|_| _ = world.step());
        let expected = vec2(fx!(5) - fx!(0.5) * (fx!(1) + restitution), fx!(5) * restitution);
        let off = world.body(ids[1]).expect("a disc").velocity() - expected;
        assert!(off.length() < fx!(0.0001), "{restitution}: {off}");
    }
}

/// Two bodies with one centre are the same scene when turned by half a turn: no direction parts them. A micrometre does.
#[test]
fn bodies_with_one_centre_stay_until_a_micrometre_parts_them() {
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let rod = || Shape::capsule(1, fx!(0.1)).expect("a rod");
    for (shape, angle) in [
        (Shape::circle(fx!(0.5)).expect("a disc"), fx!(0)),
        (Shape::rectangle(1, 1).expect("a square"), fx!(0)),
        (Shape::rectangle(1, 1).expect("a square"), fx!(0.3)),
        (rod(), fx!(0.7)),
    ] {
        for off in [fx!(0), fx!(0.000001)] {
            let placed = |x, angle| {
                let body = BodyDef::dynamic().with_collider(shape.clone());
                BodyDef { position: vec2(x, 0), angle, ..body }
            };
            let (mut world, ids) = world(still, [placed(fx!(0), fx!(0)), placed(off, angle)]).expect("a scene");
            (0..600).for_each(|_| _ = world.step());
            let apart = (at(&world, ids[0]) - at(&world, ids[1])).length();
            if off == Fx::ZERO {
                assert_eq!(apart, Fx::ZERO, "{shape:?}");
            } else {
                assert!(apart > fx!(0.19), "{shape:?} at {angle}: {apart}");
            }
        }
    }
}

/// A game with a pile, over a rollback and a recording.
#[test]
fn a_pile_rolls_back_and_plays_from_a_file() {
    let stack = (0..8).map(|row| square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("it"));
    let (start, ids) = world(def(), [ground().expect("it")].into_iter().chain(stack)).expect("a scene");
    let push = |tick: u64| {
        let mut inputs = umbra_physics::Inputs::new();
        if tick % 20 == 7 {
            inputs.replace(0, [Command::SetVelocity { body: ids[4], velocity: vec2(3, 1) }]);
        }
        inputs
    };
    let mut plain = start.clone();
    let mut recorder = Recorder::new(&plain, RecordOptions::default());
    for tick in 0..120 {
        recorder.step(&mut plain, &push(tick));
    }
    let bytes = recorder.finish(&plain);
    let replay = Replay::from_bytes(&bytes, &[]).expect("its own bytes");
    assert_eq!(replay.verify(), Ok(()));

    // Inputs come eight ticks late.
    let mut world = start.clone();
    let mut rollback = Rollback::new(&world, [0], 8);
    let make = |world: &mut World, inputs: &[(u32, umbra_physics::Inputs)]| _ = world.carry_out(&inputs[0].1);
    let mut again = 0;
    for tick in 0..120u64 {
        if let Some(late) = tick.checked_sub(7) {
            rollback.add_input(late, 0, push(late)).expect("in time");
        }
        let report = rollback.advance(&mut world, make).expect("a tick");
        again += report.redone;
    }
    for late in 113..120 {
        rollback.add_input(late, 0, push(late)).expect("in time");
    }
    rollback.advance(&mut world, make).expect("a tick");
    plain.step();
    assert_eq!(world.state_hash(), plain.state_hash());
    assert!(again > 3, "{again}");
}
