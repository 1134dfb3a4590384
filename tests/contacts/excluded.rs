//! Excluded pairs, against worlds in which the other body is not there.

use super::scenes::{def, ground, square, world};
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Command, Error, Exclusion, Fx, Shape, Snapshot, SnapshotError, Symmetry,
    Vec2, World, WorldDef, fx, limits, vec2,
};

fn disc(at: Vec2, radius: Fx, key: u64) -> BodyDef {
    BodyDef { position: at, key, ..BodyDef::dynamic().with_collider(Shape::circle(radius).expect("a disc")) }
}

/// Without gravity, and with sleep.
fn space() -> WorldDef {
    WorldDef { gravity: vec2(0, 0), sleep_after: Some(5), ..def() }
}

fn flight(world: &World, body: BodyId) -> (umbra_physics::Vec2<umbra_physics::FxAccumulator>, Vec2) {
    let body = world.body(body).expect("it is there");
    (body.position_exact(), body.velocity())
}

#[test]
fn an_excluded_body_flies_as_if_the_other_was_not_there() {
    for (a, b) in [(1, 2), (2, 1)] {
        let bodies =
            [ground().expect("a ground"), square(vec2(0, 3), 1).expect("it"), square(vec2(0, 8), 2).expect("it")];
        let (mut here, ids) = world(def(), bodies).expect("a scene");
        let mut alone = here.clone();
        alone.remove_body(ids[1]).expect("a body");
        here.exclude_pair(ids[a], ids[b], Exclusion::Always).expect("a pair");
        for _ in 0..200 {
            here.step();
            alone.step();
            assert_eq!(flight(&here, ids[2]), flight(&alone, ids[2]));
        }
        assert!(here.excluded_pairs().eq([([ids[1], ids[2]], Exclusion::Always)]));
        // Allowed again, they push each other apart.
        here.allow_pair(ids[b], ids[a]).expect("a pair");
        here.step();
        alone.step();
        assert_ne!(flight(&here, ids[2]), flight(&alone, ids[2]));
    }
}

#[test]
fn an_excluded_bullet_flies_on() {
    for kind in [umbra_physics::BodyKind::Static, umbra_physics::BodyKind::Dynamic] {
        let wall = BodyDef { kind, ..BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.1), 4).expect("a wall")) };
        let bullet = BodyDef { bullet: true, velocity: vec2(600, 0), ..disc(vec2(-5, 0), fx!(0.1), 1) };
        let (mut world, ids) = world(space(), [wall, bullet]).expect("a scene");
        let mut free = world.clone();
        free.remove_body(ids[0]).expect("a body");
        world.exclude_pair(ids[0], ids[1], Exclusion::Always).expect("a pair");
        for _ in 0..3 {
            world.step();
            free.step();
            assert_eq!(flight(&world, ids[1]), flight(&free, ids[1]));
        }
    }
}

#[test]
fn a_pair_touches_again_once_it_was_apart() {
    // From the very same centre, where no direction is better than another; from a little off it; beside each other.
    for offset in [fx!(0), fx!(0.001), fx!(0.25), fx!(0.5)] {
        let bodies = [disc(vec2(0, 0), fx!(0.5), 1), disc(Vec2::new(offset, fx!(0)), fx!(0.25), 2)];
        let (mut world, ids) = world(space(), bodies).expect("a scene");
        world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
        world.set_velocity(ids[1], vec2(1, 0)).expect("a velocity");
        let mut last = 0;
        for step in 1..=60 {
            // The distance at the moment of manifolds, 2/5 of the step, less the two radii and the way of the step.
            let gap = world.body(ids[1]).expect("it").position().x - fx!(0.75) - fx!(0.6) * fx!(1 / 60);
            world.step();
            let is_excluded = world.excluded_pairs().count() == 1;
            assert_eq!(is_excluded, gap < fx!(0.02), "{offset} {step}");
            last = if is_excluded { step } else { last };
            assert_eq!(world.body(ids[1]).expect("it").velocity(), vec2(1, 0));
        }
        assert!(last > 5, "{last}");
        world.set_velocity(ids[1], vec2(-3, 0)).expect("a velocity");
        (0..60).for_each(|_| _ = world.step());
        assert!(world.body(ids[0]).expect("it").velocity().x < fx!(-0.1));
    }
}

/// Down through a platform on which a body stands, and up through it again by its own rule.
#[test]
fn a_body_drops_through_a_one_way_platform() {
    let plank = umbra_physics::ColliderDef {
        one_way: Some(umbra_physics::OneWay::default()),
        ..umbra_physics::ColliderDef::new(Shape::rectangle(8, fx!(0.25)).expect("a plank"))
    };
    let body = square(Vec2::new(fx!(0), fx!(0.625)), 1).expect("a square");
    let (mut world, ids) = world(def(), [BodyDef::fixed().with_collider(plank), body]).expect("a scene");
    (0..30).for_each(|_| _ = world.step());
    world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
    (0..60).for_each(|_| _ = world.step());
    assert!(world.body(ids[1]).expect("it").position().y < fx!(-3));
    assert_eq!(world.excluded_pairs().count(), 0);
    world.set_velocity(ids[1], vec2(0, 15)).expect("a velocity");
    (0..240).for_each(|_| _ = world.step());
    assert!((world.body(ids[1]).expect("it").position().y - fx!(0.625)).abs() < fx!(0.01));
}

#[test]
fn a_pair_stays_excluded_while_one_collider_is_near() {
    // The boxes of both colliders overlap that of the other body.
    let part = |x: Fx, y: Fx| umbra_physics::ColliderDef {
        position: Vec2::new(x, y),
        ..umbra_physics::ColliderDef::new(Shape::circle(fx!(0.4)).expect("a disc"))
    };
    let [left, right] = [part(fx!(0.1), fx!(0)), part(fx!(0.65), fx!(0.65))];
    for colliders in [vec![left.clone(), right.clone()], vec![right, left]] {
        let double = BodyDef { colliders, key: 2, ..BodyDef::dynamic() };
        let (mut world, ids) = world(space(), [disc(vec2(0, 0), fx!(0.4), 1), double]).expect("a scene");
        world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
        (0..3).for_each(|_| _ = world.step());
        assert_eq!(world.excluded_pairs().count(), 1);
    }
}

#[test]
fn a_step_that_ends_an_exclusion_cannot_be_undone() {
    let bodies = [disc(vec2(0, 0), fx!(0.5), 1), disc(vec2(5, 0), fx!(0.5), 2)];
    let (mut world, ids) = world(WorldDef { sleep_after: None, ..space() }, bodies).expect("a scene");
    world.step();
    assert!(world.clone().step_back(&[]).is_ok());
    world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
    world.step();
    assert_eq!(world.excluded_pairs().count(), 0);
    assert!(world.step_back(&[]).is_err());
}

#[test]
fn pairs_with_a_disabled_or_quarantined_body_stay_excluded() {
    let bodies = [disc(vec2(0, 0), fx!(0.5), 1), disc(vec2(5, 0), fx!(0.5), 2), disc(vec2(50, 0), fx!(0.5), 3)];
    let (mut world, ids) = world(space(), bodies).expect("a scene");
    world.disable(ids[1]).expect("a body");
    world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
    (0..3).for_each(|_| _ = world.step());
    assert_eq!(world.excluded_pairs().count(), 1);
    world.enable(ids[1]).expect("a body");
    world.step();
    assert_eq!(world.excluded_pairs().count(), 0);
}

/// With or without a bystander that has a collider, in a world without any other: the step ends the exclusion alike.
#[test]
fn bodies_without_colliders_are_apart() {
    for bystander in [false, true] {
        let (mut world, ids) = world(space(), [BodyDef::dynamic(), BodyDef::dynamic()]).expect("a scene");
        if bystander {
            world.add_body(disc(vec2(50, 0), fx!(0.5), 3)).expect("a body");
        }
        world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
        world.step();
        assert_eq!(world.excluded_pairs().count(), 0);
    }
}

#[test]
fn a_pair_goes_with_a_body_before_its_slot_is_used_again() {
    let (mut world, ids) = world(space(), [disc(vec2(0, 0), fx!(0.5), 1), disc(vec2(0, 0), fx!(0.5), 2)]).expect("it");
    world.exclude_pair(ids[0], ids[1], Exclusion::Always).expect("a pair");
    world.remove_body(ids[0]).expect("a body");
    assert_eq!(world.excluded_pairs().count(), 0);
    let again = world.add_body(disc(Vec2::new(fx!(0.5), fx!(0)), fx!(0.5), 3)).expect("a body");
    assert_eq!(again.parts().0, ids[0].parts().0);
    world.step();
    assert!(world.body(again).expect("it").velocity().x > fx!(0));
}

#[test]
fn a_call_wakes_both_bodies() {
    let bodies = [disc(vec2(0, 0), fx!(0.5), 1), disc(vec2(5, 0), fx!(0.5), 2)];
    let (mut world, ids) = world(space(), bodies).expect("a scene");
    let sleep = |world: &mut World| {
        (0..10).for_each(|_| _ = world.step());
        assert!(ids.iter().all(|&id| world.body(id).expect("it").activity() == Activity::Asleep));
    };
    let is_awake = |world: &World| ids.iter().all(|&id| world.body(id).expect("it").activity() == Activity::Awake);
    sleep(&mut world);
    world.exclude_pair(ids[0], ids[1], Exclusion::Always).expect("a pair");
    assert!(is_awake(&world));
    sleep(&mut world);
    world.allow_pair(ids[0], ids[1]).expect("a pair");
    assert!(is_awake(&world));
}

#[test]
fn invalid_exclusions_are_refused_and_change_nothing() {
    let (mut world, ids) = world(space(), [disc(vec2(0, 0), fx!(0.5), 1), BodyDef::fixed()]).expect("a scene");
    let none = BodyId::from_parts(9, 0);
    let before = world.state_hash();
    let exclusion = Exclusion::Always;
    for (a, b, error) in [
        (ids[0], ids[0], Error::SameBody { body: ids[0] }),
        (none, ids[0], Error::NoSuchBody { body: none }),
        (ids[0], none, Error::NoSuchBody { body: none }),
    ] {
        for command in [Command::ExcludePair { a, b, exclusion }, Command::AllowPair { a, b }] {
            assert_eq!(world.check(&command), Err(error));
            assert_eq!(world.execute(&command).err(), Some(error));
        }
    }
    assert_eq!(world.state_hash(), before);
    // The last place, and none after it.
    let many: Vec<BodyId> = (0..363).map(|_| world.add_body(BodyDef::fixed()).expect("a body")).collect();
    let pairs = many.iter().flat_map(|&a| many.iter().map(move |&b| (a, b))).filter(|(a, b)| a < b);
    for (a, b) in pairs.take(limits::EXCLUDED_PAIRS) {
        world.exclude_pair(a, b, exclusion).expect("a place");
    }
    assert_eq!(world.excluded_pairs().count(), limits::EXCLUDED_PAIRS);
    assert_eq!(world.exclude_pair(ids[0], ids[1], exclusion), Err(Error::Full));
    world.exclude_pair(many[1], many[0], Exclusion::UntilApart).expect("one that is there");
    assert_eq!(
        Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("bytes").world().state_hash(),
        world.state_hash()
    );
}

#[test]
fn excluded_pairs_are_in_snapshots_images_and_hashes() {
    let bodies = |flip: bool| {
        let mut bodies: Vec<BodyDef> = (0..6).map(|i| disc(vec2(i, i * i), fx!(0.75), 10 + i as u64)).collect();
        if flip {
            bodies.reverse();
        }
        bodies
    };
    let (mut here, ids) = world(space(), bodies(false)).expect("a scene");
    let (mut twin_world, others) = world(space(), bodies(true)).expect("a scene");
    let twin = |i: usize| others[5 - i];
    for (a, b, exclusion) in [(0, 1, Exclusion::Always), (1, 2, Exclusion::UntilApart), (3, 4, Exclusion::UntilApart)] {
        let before = (here.state_hash(), here.physics_hash());
        here.exclude_pair(ids[a], ids[b], exclusion).expect("a pair");
        twin_world.exclude_pair(twin(a), twin(b), exclusion).expect("a pair");
        assert!(here.state_hash() != before.0 && here.physics_hash() != before.1);
    }
    let mut image = Symmetry::MIRROR.world(&here).expect("an image");
    for (i, &id) in ids.iter().enumerate().take(6) {
        let velocity = vec2(1 - i as i32, 2 - i as i32);
        here.set_velocity(id, velocity).expect("a velocity");
        twin_world.set_velocity(twin(i), velocity).expect("a velocity");
        image.set_velocity(id, vec2(-velocity.x, velocity.y)).expect("a velocity");
    }
    for tick in 0..90 {
        for world in [&mut here, &mut twin_world, &mut image] {
            world.step();
        }
        assert_eq!(here.physics_hash(), twin_world.physics_hash(), "{tick}");
        assert_eq!(Symmetry::MIRROR.world(&here).expect("an image").first_difference(&image), None, "{tick}");
        let bytes = here.snapshot().to_bytes();
        here = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        assert_eq!(here.snapshot().to_bytes(), bytes);
    }
    assert!(here.excluded_pairs().eq([([ids[0], ids[1]], Exclusion::Always)]));
    let mut without = here.clone();
    without.allow_pair(ids[0], ids[1]).expect("a pair");
    let differences: Vec<String> = here.differences(&without).iter().map(ToString::to_string).collect();
    assert!(
        differences.iter().any(|line| line.contains("body 0") && line.contains("excluded_pairs[0]")),
        "{differences:?}"
    );
}

#[test]
fn forged_pairs_are_refused() {
    let plank = umbra_physics::ColliderDef {
        one_way: Some(umbra_physics::OneWay::default()),
        ..umbra_physics::ColliderDef::new(Shape::rectangle(8, fx!(0.25)).expect("a plank"))
    };
    let bodies = [BodyDef::fixed().with_collider(plank), disc(vec2(0, 0), fx!(0.5), 2)];
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    world.exclude_pair(ids[0], ids[1], Exclusion::Always).expect("a pair");
    world.step();
    world.allow_pair(ids[0], ids[1]).expect("a pair");
    world.step();
    world.exclude_pair(ids[0], ids[1], Exclusion::Always).expect("a pair");
    let bytes = world.snapshot().to_bytes();
    // At the end: one answer of 11 bytes after its count, one pair of 9 after its count, no overlap, no pair that ended, no joint and no free
    // slot of one, the tick of the last pull, no body that woke, the hash, the seal.
    let pair = bytes.len() - 16 - 8 - 5 * 4 - 9;
    let answer = pair - 4 - 11;
    assert_eq!((bytes[answer - 4], bytes[pair - 4]), (1, 1));
    for (at, value) in [
        (pair, 1),        // two times one body
        (pair + 4, 7),    // a body that is not there
        (pair + 8, 2),    // no exclusion
        (answer, 1),      // a collider that is not one-way
        (answer + 4, 1),  // an outline that is not there
        (answer + 6, 0),  // its own body
        (answer + 6, 9),  // a body that is not there
        (answer + 10, 2), // neither true nor false
    ] {
        let mut forged = bytes.clone();
        forged[at] = value;
        let error = Snapshot::from_bytes(&forged, &[]).expect_err("no world has this");
        assert!(matches!(error, SnapshotError::Malformed(_)), "{at}: {error}");
        assert!(!error.to_string().contains("the hash of the bytes"), "{at}: {error}");
    }
}

/// Bodies at rest are apart where no solid colliders of them are near each other, as moving ones are.
#[test]
fn a_sensor_does_not_prolong_the_exclusion_of_a_sleeper() {
    let disc = |radius: i32| ColliderDef::new(Shape::circle(radius).expect("a disc"));
    let wall = BodyDef::fixed().with_collider(disc(1)).with_collider(ColliderDef { sensor: true, ..disc(2) });
    let (mut world, ids) = world(space(), [wall, BodyDef::dynamic().with_collider(disc(1))]).expect("a scene");
    world.exclude_pair(ids[0], ids[1], Exclusion::UntilApart).expect("a pair");
    (0..10).for_each(|_| _ = world.step());
    assert_eq!((world.moving_count(), world.excluded_pairs().count()), (0, 1));
    let solid = world.colliders_of(ids[0]).expect("it").next().expect("a disc");
    world.remove_collider(solid).expect("a collider");
    world.step();
    assert_eq!((world.moving_count(), world.excluded_pairs().count()), (0, 0));
}
