//! Scenes and replays made to take long: each takes bounded time and memory, by the limits that the caller gives.
//!
//! The bounds of time are generous, as a machine may have much else to do: what they rule out is time that grows with the square of a
//! number.

use std::time::{Duration, Instant};

use allocation_counter::measure;
use umbra_physics::{
    Aabb, BodyDef, BodyKind, Cause, ColliderDef, ContactSettings, Exclusion, Explosion, Filter, Fx, Inputs,
    QueryFilter, RecordOptions, Recorder, Replay, ReplayLimits, Shape, Vec2, VerifyError, World, WorldDef, fx, vec2,
};
use umbra_scene::Scene;

use crate::seeds::{is_short, times};

/// A number of bodies, or of what else there are many of.
fn many() -> usize {
    times(10_000)
}

/// Calls `act`, and asserts that it takes at most this many seconds and bytes.
fn within<T>(what: &str, seconds: u64, bytes: u64, act: impl FnOnce() -> T) -> T {
    let (mut result, start) = (None, Instant::now());
    let taken = measure(|| result = Some(act())).bytes_max;
    let time = start.elapsed();
    if std::env::var_os("UMBRA_SAY").is_some() {
        println!("{what:<32} {time:>12.3?} of {seconds:>3} s, {taken:>11} of {bytes:>11} bytes");
    }
    assert!(taken <= bytes, "{what}: {taken} of {bytes} bytes");
    // Without optimisation all takes tens of times as long.
    assert!(cfg!(debug_assertions) || time < Duration::from_secs(seconds), "{what}: {time:?} of {seconds} s");
    result.expect("it was done")
}

/// The memory that a step may take, in bytes: a share for each collider and for each pair that may be.
fn bound(colliders: usize, max_pairs: u32) -> u64 {
    1_600 * colliders as u64 + 1_600 * u64::from(max_pairs) + (1 << 20)
}

fn world(contacts: ContactSettings) -> World {
    World::new(WorldDef { contacts, gravity: vec2(0, -10), ..WorldDef::default() }).expect("a fair definition")
}

fn disc() -> ColliderDef {
    ColliderDef::new(Shape::circle(fx!(0.5)).expect("a fair radius"))
}

fn few(max_pairs: u32, max_pairs_per_collider: u32) -> ContactSettings {
    ContactSettings { max_pairs, max_pairs_per_collider, ..ContactSettings::default() }
}

fn one_point(contacts: ContactSettings, filter: impl Fn(u32) -> Filter) -> World {
    let mut world = world(contacts);
    for key in 0..many() as u32 {
        let disc = ColliderDef { filter: filter(key), ..disc() };
        world.add_body(BodyDef { key: key.into(), ..BodyDef::dynamic().with_collider(disc) }).expect("a fair body");
    }
    world
}

/// Makes queries of all kinds over a world with this number of outlines, and an explosion among them.
fn use_up(what: &str, world: &mut World, count: usize) {
    within(what, 20, 4_000 * count as u64 + (1 << 22), || {
        let (queries, all) = (world.queries(), QueryFilter::default());
        let everywhere = Aabb { min: vec2(-1000, -1000), max: vec2(1000, 1000) };
        let count = queries.overlap_box(everywhere, &all).expect("a fair box").len();
        assert!(count > 0, "nothing to be found");
        _ = queries.overlap_point(Vec2::ZERO, &all).expect("a fair point");
        _ = queries
            .overlap_shape(&Shape::circle(100).expect("a radius"), (Vec2::ZERO, fx!(0)), &all)
            .expect("a fair place");
        _ = queries.cast_ray_all(vec2(-90, 0), vec2(180, 0), &all).expect("a fair ray");
        _ = queries.cast_ray(vec2(-90, 0), vec2(180, 0), &all).expect("a fair ray");
        let disc = Shape::circle(1).expect("a radius");
        _ = queries.cast_shape_all(&disc, (vec2(-90, 0), fx!(0)), vec2(180, 0), &all).expect("a fair way");
        _ = queries.closest_points(Vec2::ZERO, fx!(100), &all).expect("a fair distance");
    });
    within(what, 20, bound(count, 0), || {
        let blast = Explosion { position: Vec2::ZERO, radius: fx!(50), falloff: fx!(50), impulse: fx!(9), mask: !0 };
        _ = world.explode(&blast);
    });
}

#[test]
fn bodies_in_one_point() {
    for contacts in [ContactSettings::default(), few(1_000, 4)] {
        let mut world = one_point(contacts, |_| Filter::default());
        use_up("bodies in one point", &mut world, many());
        let faults = within("bodies in one point", 60, bound(many(), contacts.max_pairs.min(1 << 18)), || {
            world.step().faults.len()
        });
        // Each has as many pairs as all others.
        assert_eq!(faults, many());
        assert!(world.last_report().faults.iter().all(|fault| fault.cause == Cause::Pairs));
    }
}

#[test]
fn bodies_in_one_point_that_filters_keep_apart() {
    let one_way = |i: u32| Filter { category: 1 << (i % 3), mask: 2 << (i % 3), group: 0 };
    // Of any two, about an eighth agree one way alone, and few agree.
    let mixed = |i: u32| {
        let (category, mask) = (1 << (i % 31), (1 << (i / 31 % 31)) | (1 << (i / 961 % 31)));
        Filter { category, mask, group: -(i as i32 % 5) }
    };
    let kinds: [(&str, &dyn Fn(u32) -> Filter); 4] = [
        ("a group", &|_| Filter { group: -1, ..Filter::default() }),
        ("groups of two bodies, and one of all others", &|i| Filter {
            category: 1,
            mask: if i < 1_000 { 1 } else { 2 },
            group: -1 - i.min(1_000) as i32 / 2,
        }),
        ("one way", &one_way),
        ("mixed", &mixed),
    ];
    // By day there are too few bodies for the limits of the default settings.
    let default = (!is_short()).then(ContactSettings::default);
    for (what, filter) in kinds {
        for contacts in default.into_iter().chain([few(1_000, 4)]) {
            let mut world = one_point(contacts, filter);
            let faults = within(what, 60, bound(many(), contacts.max_pairs.min(1 << 18)), || world.step().faults.len());
            assert!(faults > many() / 2, "{what}: {faults}");
            assert!(world.last_report().faults.iter().all(|fault| fault.cause == Cause::Pairs));
        }
    }
    // Categories of which neither is in the mask of the other are skipped, and are no fault.
    for contacts in [ContactSettings::default(), few(1_000, 4)] {
        let mut world = one_point(contacts, |i| Filter { category: 1 << (i % 2), mask: 4 << (i % 2), group: 0 });
        for _ in 0..3 {
            within("two categories", 10, bound(many(), 0), || assert!(world.step().faults.is_empty()));
        }
    }
}

/// Rods across rods: each pair of two of them touches.
fn lattice(side: i32, contacts: ContactSettings) -> World {
    let mut world = world(contacts);
    let length = Fx::from(side) * 2;
    for (across, category) in [(false, 1), (true, 2)] {
        let [width, height] = if across { [fx!(0.5), length] } else { [length, fx!(0.5)] };
        let filter = Filter { category, mask: 3 - category, ..Filter::default() };
        let rod = ColliderDef { filter, ..ColliderDef::new(Shape::rectangle(width, height).expect("a fair size")) };
        for i in 0..side {
            let place = Fx::from(i - side / 2);
            let position = if across { Vec2::new(place, fx!(0)) } else { Vec2::new(fx!(0), place) };
            world.add_body(BodyDef { position, ..BodyDef::dynamic().with_collider(rod.clone()) }).expect("a fair body");
        }
    }
    world
}

#[test]
fn a_million_pairs() {
    let side = 1_000;
    let (rods, pairs) = (2 * side as usize, (side * side) as u32);
    let mut all = lattice(side, ContactSettings::default());
    use_up("a million pairs", &mut all, rods);
    within("a million pairs", 120, bound(rods, pairs.next_power_of_two()), || assert!(all.step().faults.is_empty()));
    // Those with an impulse: a rod rests on some of those below it.
    let count = all.contacts().count();
    assert!(count > pairs as usize / 10, "{count} of {pairs}");
    // Each rod is in more pairs than it may be in: none of them may stay.
    let mut short = lattice(side, few(pairs / 10, 100));
    within("a million pairs, limited", 20, bound(rods, pairs / 10), || assert_eq!(short.step().faults.len(), rods));
}

#[test]
fn long_chains_that_cross() {
    const CHAINS: i32 = 8;
    let count = if is_short() { 1 << 13 } else { 1 << 16 };
    // To and fro, each segment along all of the others.
    let comb = |k: i32| vec2(if k % 2 == 0 { -100 } else { 100 }, Fx::from_ratio(k.into(), 256));
    let points: Vec<Vec2> = (0..count).map(comb).collect();
    let shape = within("a long chain", 60, 1_000 * count as u64, || {
        Shape::chain(&points, false).expect("it does not cross itself")
    });
    // All segments cross all others, or would.
    let star = |k: i32| vec2(if k % 2 == 0 { -100 } else { 100 }, Fx::from_ratio((k * 7919 % count).into(), 256));
    let crossed: Vec<Vec2> = (0..count).map(star).collect();
    within("a chain that crosses itself", 60, 1_000 * count as u64, || assert!(Shape::chain(&crossed, false).is_err()));
    let mut world = world(few(10_000, 64));
    for i in 0..CHAINS {
        let def = ColliderDef { angle: Fx::from_ratio(i.into(), 8), ..ColliderDef::new(shape.clone()) };
        world.add_body(BodyDef::fixed().with_collider(def)).expect("a fair body");
    }
    // Bodies over many segments of all of them, and one over all.
    for (i, radius) in (0..100).map(|i| (i, if i == 0 { 300 } else { 2 })) {
        let position = vec2(i % 10 * 5, i / 10 * 5);
        let body = BodyDef { position, bullet: i % 2 == 0, velocity: vec2(200, 0), ..BodyDef::dynamic() };
        world.add_body(body.with_collider(Shape::circle(radius).expect("a radius"))).expect("a fair body");
    }
    let outlines = (CHAINS * count) as usize;
    use_up("long chains", &mut world, outlines);
    let faults = within("long chains", 60, bound(outlines, 10_000), || world.step().faults.len());
    assert!(faults > 0, "all fit");
    within("long chains, again", 10, bound(outlines, 10_000), || world.step().faults.len());
}

/// Sensors of a category and bodies at one place.
fn watched((sensors, category): (usize, u32), bodies: usize, contacts: ContactSettings) -> World {
    let mut world = world(contacts);
    // Bodies do not meet each other.
    let filter = Filter { category: 2, mask: 1, ..Filter::default() };
    for key in 0..sensors as u64 {
        let filter = Filter { category, mask: 2, ..Filter::default() };
        let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][key as usize % 3];
        let def = BodyDef { kind, key, ..BodyDef::dynamic() };
        world.add_body(def.with_collider(ColliderDef { sensor: true, filter, ..disc() })).expect("a fair body");
    }
    for key in 0..bodies as u64 {
        let def = BodyDef { key, gravity_scale: fx!(0), ..BodyDef::dynamic() };
        world.add_body(def.with_collider(ColliderDef { filter, ..disc() })).expect("a fair body");
    }
    world
}

#[test]
fn sensors_over_bodies() {
    for contacts in [ContactSettings::default(), few(1_000, 4)] {
        let mut world = watched((many(), 1), 10_000, contacts);
        use_up("sensors", &mut world, many() + 10_000);
        // The second step is one of bodies that lie still, and sleep later on.
        for _ in 0..2 {
            within("sensors over bodies", 60, bound(many() + 10_000, contacts.max_pairs.min(1 << 18)), || {
                assert!(world.step().faults.is_empty());
            });
        }
        // Each of them is in more pairs than the limit, and so finds nothing.
        assert_eq!(world.sensor_overlaps().count(), 0);
    }
}

/// Sensors that look for bodies which do not look for them: they make no pairs. What is too much of that counts as pairs do.
#[test]
fn sensors_over_bodies_that_filters_keep_apart() {
    for contacts in [ContactSettings::default(), few(1_000, 4)] {
        let mut world = watched((many(), 4), 10_000, contacts);
        // One that all of these sensors would see, and another one with a sensor of its own.
        let visible = Filter { category: 2, mask: 4, ..Filter::default() };
        for position in [vec2(0, 0), vec2(90, 0)] {
            let body = BodyDef { position, gravity_scale: fx!(0), ..BodyDef::dynamic() };
            world.add_body(body.with_collider(ColliderDef { filter: visible, ..disc() })).expect("a fair body");
        }
        let filter = Filter { category: 4, mask: 2, ..Filter::default() };
        let door = BodyDef { position: vec2(90, 0), ..BodyDef::fixed() };
        world.add_body(door.with_collider(ColliderDef { sensor: true, filter, ..disc() })).expect("a fair body");
        for _ in 0..2 {
            within("sensors, apart", 20, bound(many() + 10_000, contacts.max_pairs.min(1 << 18)), || {
                assert!(world.step().faults.is_empty());
            });
        }
        assert_eq!(world.sensor_overlaps().count(), 1);
    }
}

/// Discs 1 cm apart, which exchange no impulses: each is an island of its own, and one wakes the next in the same step.
#[test]
fn a_row_in_which_each_wakes_the_next() {
    const ROW: usize = 2_000;
    let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(2), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    let place = |i: usize| Vec2::new(fx!(1.01) * i as i32, fx!(0));
    let ids: Vec<_> = (0..ROW)
        .map(|i| {
            let body = BodyDef { position: place(i), key: i as u64, ..BodyDef::dynamic().with_collider(disc()) };
            world.add_body(body).expect("a fair body")
        })
        .collect();
    (0..10).for_each(|_| _ = world.step());
    assert_eq!(world.moving_count(), 0, "all are asleep");
    world.set_velocity(ids[0], vec2(1, 0)).expect("a fair velocity");
    // Of contacts there are as many as discs.
    let woke = within("a row that wakes", 5, bound(ROW, 4 * ROW as u32), || world.step().woke.len());
    assert_eq!(woke, ROW);
    within("a row that is awake", 1, bound(ROW, 4 * ROW as u32), || world.step().woke.len());
}

/// Bodies that all leave the allowed range in one step, far from each other.
#[test]
fn bodies_that_leave_the_range_together() {
    let count = 3 * many();
    let mut world = world(ContactSettings::default());
    for i in 0..count as i32 {
        let position = vec2(2 * (i % 1_000), 2 * (i / 1_000));
        // At the limit of speeds: gravity takes it beyond.
        let body = BodyDef { position, velocity: vec2(0, -(1 << 20)), key: i as u64, ..BodyDef::dynamic() };
        world.add_body(body.with_collider(disc())).expect("a fair body");
    }
    let faults = within("bodies that leave the range", 5, bound(count, 0), || world.step().faults.len());
    assert_eq!(faults, count);
    assert!(world.last_report().faults.iter().all(|fault| fault.cause == Cause::Velocity));
}

/// A sleeper of many colliders over a chain of many segments, excluded until they are apart: only the last collider is near the last
/// segment. A step in which nobody moves takes no time and memory in proportion to colliders times segments.
#[test]
fn a_sleeper_that_is_excluded_until_apart() {
    const SEGMENTS: i32 = 1_024;
    const COLLIDERS: i32 = 256;
    // From right to left, so that it is solid from above; the last segment ends at x = 0.
    let points: Vec<Vec2> = (0..=SEGMENTS).map(|k| vec2(Fx::from_ratio((SEGMENTS - k).into(), 4), 0)).collect();
    let chain = Shape::chain(&points, false).expect("a chain");
    let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(2), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    let floor = world.add_body(BodyDef::fixed().with_collider(chain)).expect("a fair body");
    // The first one is near, all others are far above.
    let part = |k: i32| ColliderDef {
        position: if k == 0 { vec2(fx!(0.125), fx!(0.26)) } else { vec2(0, 10 + k) },
        ..ColliderDef::new(Shape::circle(fx!(0.25)).expect("a disc"))
    };
    let body = (0..COLLIDERS).map(part).fold(BodyDef::dynamic(), BodyDef::with_collider);
    let body = world.add_body(body).expect("a fair body");
    world.exclude_pair(floor, body, Exclusion::UntilApart).expect("a pair");
    // A step that the fall to sleep disturbs looks at what changed, and finds the pair by that.
    while world.moving_count() > 0 {
        world.step();
    }
    world.step();
    let outlines = (SEGMENTS + COLLIDERS) as usize;
    within("an excluded sleeper", 1, bound(outlines, 0), || _ = world.step());
    assert_eq!((world.moving_count(), world.excluded_pairs().count()), (0, 1), "asleep, and still near");
}

#[test]
fn scenes_and_replays() {
    let many = many();
    let text = format!(
        r#"{{"contacts": {{"max_pairs": 1000, "max_pairs_per_collider": 4}}, "bodies": [
            {{"name": "{{i}}", "repeat": {{"i": {many}}}, "colliders": [{{"shape": {{"circle": {{"radius": 0.5}}}}}}]}}]}}"#
    );
    let refused = within("a scene, limited", 1, 1 << 20, || Scene::parse_within(&text, 1_000).map(drop));
    assert_eq!(refused.map_err(|error| error.code()), Err(510));
    let scene =
        within("a scene", 30, 5_000 * many as u64, || Scene::parse_within(&text, many as u32)).expect("a scene");
    let mut world = within("a scene", 30, 5_000 * many as u64, || scene.build::<Fx>()).expect("a world");
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    for _ in 0..3 {
        within("a run", 30, bound(many, 1 << 16), || recorder.step(&mut world, &Inputs::new()).faults.len());
    }
    let file = recorder.finish(&world);
    let replay = Replay::from_bytes(&file, &[]).expect("a replay");
    let limits =
        ReplayLimits { ticks: 10, bodies: many as u32, fields: 0, colliders: many as u32, pairs: 1_000, commands: 0 };
    within("a replay", 60, bound(2 * many, 1 << 16), || assert_eq!(replay.verify_within(limits), Ok(())));
    within("a replay, limited", 10, bound(2 * many, 0), || {
        let outcome = replay.verify_within(ReplayLimits { pairs: 999, ..limits });
        assert!(matches!(outcome, Err(VerifyError::Pairs { .. })), "{outcome:?}");
        let outcome = replay.verify_within(ReplayLimits { bodies: 999, ..limits });
        assert!(matches!(outcome, Err(VerifyError::Bodies { .. })), "{outcome:?}");
    });
}
