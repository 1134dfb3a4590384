//! Sensors: their overlaps, compared with those that queries find.

use std::collections::BTreeSet;

use super::events::{Observer, Pair, crowd, quiet, shake};
use super::scenes::{def, ground, square, through_bytes, world};
use crate::seeds::run_seed;
use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, ContactSettings, Error, Filter, Fx, Mass,
    QueryFilter, Random, Shape, Snapshot, SnapshotError, Symmetry, Vec2, World, WorldDef, fx, vec2,
};

fn sensor(shape: Shape, key: u64) -> ColliderDef {
    ColliderDef { sensor: true, density: fx!(0), key, ..ColliderDef::new(shape) }
}

/// The crowd, with sensors on the ground's body, on a kinematic body that goes through it, and around some of the bodies. None of
/// them is turned but discs, of which the queries of the test know the angle.
fn watched(seed: u64) -> Vec<BodyDef> {
    let mut bodies = crowd(14, seed);
    let tall = Shape::rectangle(fx!(1.5), fx!(4)).expect("a rectangle");
    let wide = Shape::capsule(fx!(3), fx!(0.4)).expect("a capsule");
    let at = ColliderDef { position: vec2(2, 3), ..sensor(tall, 500) };
    bodies[0].colliders.push(at);
    let wide = sensor(wide, 501);
    let lift = BodyDef { position: vec2(-4, 2), velocity: vec2(1, 0), key: 2_000, ..BodyDef::kinematic() };
    bodies.push(lift.with_collider(wide));
    for (key, body) in bodies.iter_mut().enumerate().filter(|(key, _)| *key % 5 == 1) {
        body.colliders.push(sensor(Shape::circle(fx!(0.8)).expect("a disc"), 600 + key as u64));
    }
    bodies
}

/// The overlaps of each sensor, by the queries: of sensors that are discs or on bodies that are not turned.
fn overlaps(world: &World) -> BTreeSet<Pair> {
    let queries = world.queries();
    let mut pairs = BTreeSet::new();
    for (id, def) in world.colliders().filter(|(_, def)| def.sensor) {
        let own_body = world.collider_body(id).expect("a body");
        let body = world.body(own_body).expect("a body");
        if !matches!(body.activity(), Activity::Awake | Activity::Asleep) {
            continue;
        }
        assert!(def.position == Vec2::ZERO || body.angle() == fx!(0));
        let pose = (body.position() + def.position, body.angle());
        let filter = QueryFilter { without_bodies: &[own_body], ..QueryFilter::default() };
        for collider in queries.overlap_shape(&def.shape, pose, &filter).expect("a shape") {
            let met_body = world.collider_body(collider).expect("a body");
            let met_body = world.body(met_body).expect("a body").kind();
            let moves = [body.kind(), met_body].iter().any(|kind| *kind != BodyKind::Static);
            if moves && world.collider(collider).expect("a collider").filter.agrees(def.filter) {
                pairs.insert([id, collider]);
            }
        }
    }
    pairs
}

#[test]
fn sensors_report_what_queries_find() {
    let mut counts = [0; 2];
    for seed in 0..10 {
        let (mut world, _) = world(quiet(), watched(seed)).expect("a scene");
        let (mut observer, mut random) = (Observer::default(), Random::seeded(run_seed(seed)));
        for _ in 0..250 {
            if random.below(4) == 0 {
                shake(&mut world, &mut random);
            }
            observer.step(&mut world);
            let is_plain = |id: ColliderId| {
                let def = world.collider(id).expect("a collider");
                let body = world.body(world.collider_body(id).expect("a body")).expect("a body");
                // A turned square: the angle of a query is rounded.
                def.key >= 500 || body.angle() == fx!(0)
            };
            let plain =
                |pairs: BTreeSet<Pair>| pairs.into_iter().filter(|[id, _]| is_plain(*id)).collect::<BTreeSet<_>>();
            assert_eq!(plain(observer.inside.clone()), plain(overlaps(&world)));
            assert!(world.sensor_overlaps().map(|pair| pair.colliders).collect::<BTreeSet<_>>() == observer.inside);
        }
        counts[0] += observer.counts[3];
        counts[1] += observer.counts[4];
    }
    assert!(counts[0] > 200 && counts[1] >= counts[0], "{counts:?}");
}

#[test]
fn sensors_change_no_motion() {
    for seed in 0..5 {
        let loud = watched(seed);
        let silent = loud.iter().cloned().map(|mut def: BodyDef| {
            def.colliders.retain(|collider| !collider.sensor);
            def
        });
        let silent: Vec<BodyDef> = silent.collect();
        let (mut here, ids) = world(quiet(), loud).expect("a scene");
        let (mut twin, _) = world(quiet(), silent).expect("a scene");
        let mut slept = 0;
        for tick in 0..500 {
            slept += here.step().fell_asleep.len();
            twin.step();
            for &id in &ids {
                let [a, b] = [&here, &twin].map(|world| {
                    let body = world.body(id).expect("a body");
                    (body.position_exact(), body.angle_exact(), body.velocity_exact(), body.activity())
                });
                assert_eq!(a, b, "{tick}");
            }
        }
        assert!(slept > 0);
    }
}

#[test]
fn a_restored_world_a_mirror_image_and_a_shuffled_one_have_the_same_overlaps() {
    let bodies = watched(4);
    let mut shuffled = bodies.clone();
    Random::seeded(3).shuffle(&mut shuffled);
    let (mut here, _) = world(quiet(), bodies).expect("a scene");
    let (mut twin, _) = world(quiet(), shuffled).expect("a scene");
    let mut image = Symmetry::MIRROR.world(&here).expect("an image");
    let mut restored = here.clone();
    let mut count = 0;
    for tick in 0..800 {
        let bytes = restored.snapshot().to_bytes();
        restored = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        let lists = |world: &mut World| {
            let report = world.step();
            [report.sensors_left.to_vec(), report.sensors_entered.to_vec()]
        };
        let actual = lists(&mut here);
        count += actual[0].len();
        assert_eq!(actual, lists(&mut restored), "{tick}");
        assert_eq!(actual, lists(&mut image), "{tick}");
        let keys = |lists: [Vec<umbra_physics::ColliderPair>; 2]| {
            lists.map(|list| list.iter().map(|pair| (pair.body_keys, pair.collider_keys)).collect::<Vec<_>>())
        };
        assert_eq!(keys(actual), keys(lists(&mut twin)), "{tick}");
        assert_eq!(here.physics_hash(), twin.physics_hash(), "{tick}");
        assert_eq!(here.state_hash(), restored.state_hash(), "{tick}");
        assert_eq!(Symmetry::MIRROR.world(&here).expect("an image").first_difference(&image), None, "{tick}");
    }
    assert!(count > 5, "{count}");
}

/// A static sensor around the origin and a disc in it, of no gravity.
fn goal() -> (World, [BodyId; 2], Observer) {
    let goal = BodyDef { key: 3, ..BodyDef::fixed() };
    let goal = goal.with_collider(sensor(Shape::rectangle(fx!(4), fx!(4)).expect("a box"), 0));
    let disc = BodyDef { key: 5, ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc")) };
    let (mut world, ids) = world(WorldDef { gravity: Vec2::ZERO, ..quiet() }, [goal, disc]).expect("a scene");
    let mut observer = Observer::default();
    observer.step(&mut world);
    assert_eq!((observer.counts, observer.inside.len()), ([0, 0, 0, 0, 1], 1));
    (world, [ids[0], ids[1]], observer)
}

#[test]
fn overlaps_ended_by_calls_are_reported_by_the_next_step() {
    fn own(world: &World, body: BodyId) -> ColliderId {
        world.colliders_of(body).expect("a body").next().expect("a collider")
    }
    type Call = fn(&mut World, [BodyId; 2]);
    let calls: [(&str, Call, [usize; 2]); 9] = [
        ("body", |world, [_, disc]| world.remove_body(disc).expect("a body"), [1, 0]),
        ("sensor's body", |world, [goal, _]| world.remove_body(goal).expect("a body"), [1, 0]),
        ("sensor", |world, [goal, _]| world.remove_collider(own(world, goal)).expect("a collider"), [1, 0]),
        ("disabled", |world, [_, disc]| world.disable(disc).expect("a body"), [1, 0]),
        ("sensor disabled", |world, [goal, _]| world.disable(goal).expect("a body"), [1, 0]),
        ("far", |world, [_, disc]| world.set_position(disc, vec2(9, 0)).expect("a body"), [1, 0]),
        ("sensor far", |world, [goal, _]| world.set_position(goal, vec2(9, 0)).expect("a body"), [1, 0]),
        (
            "flag",
            |world, [goal, _]| {
                let id = own(world, goal);
                let def = ColliderDef { sensor: false, ..world.collider(id).expect("a collider").clone() };
                world.set_collider(id, def).expect("a collider");
            },
            [1, 0],
        ),
        (
            "slot used again",
            |world, [_, disc]| {
                let id = own(world, disc);
                let def = world.collider(id).expect("a collider").clone();
                world.remove_collider(id).expect("a collider");
                world.add_collider(disc, def).expect("a collider");
            },
            [1, 1],
        ),
    ];
    for is_asleep in [false, true] {
        for (name, call, expected) in calls {
            let (mut world, ids, mut observer) = goal();
            if is_asleep {
                (0..60).for_each(|_| observer.step(&mut world));
                assert_eq!((world.moving_count(), observer.counts), (0, [0, 0, 0, 0, 1]));
            }
            call(&mut world, ids);
            let mut fresh = through_bytes(&world);
            observer.step(&mut world);
            assert_eq!(observer.counts[3..], [expected[0], 1 + expected[1]], "{name}");
            let report = fresh.step();
            assert_eq!([report.sensors_left.len(), report.sensors_entered.len()], expected, "{name} restored");
            assert_eq!((report.sensors_left[0].bodies, report.sensors_left[0].body_keys), (ids, [3, 5]));
            observer.step(&mut world);
            assert_eq!(observer.counts[3..], [expected[0], 1 + expected[1]], "{name} again");
        }
    }
}

#[test]
fn a_body_that_is_quarantined_leaves_its_sensor_in_that_step() {
    let edge = Fx::from_bits(1 << 62) - fx!(2);
    let goal = BodyDef { position: vec2(edge, 0), ..BodyDef::fixed() };
    let goal = goal.with_collider(sensor(Shape::rectangle(fx!(4), fx!(4)).expect("a box"), 0));
    let disc = BodyDef { position: vec2(edge, 0), velocity: vec2(100, 0), ..BodyDef::dynamic() };
    let disc = disc.with_collider(Shape::circle(fx!(0.5)).expect("a disc"));
    let (mut world, _) = world(WorldDef { gravity: Vec2::ZERO, ..def() }, [goal, disc]).expect("a scene");
    let mut observer = Observer::default();
    observer.step(&mut world);
    assert_eq!(observer.inside.len(), 1);
    observer.step(&mut world);
    assert_eq!((world.last_report().faults.len(), observer.inside.len()), (1, 0));
}

#[test]
fn sensors_see_by_kind_and_filter_and_not_each_other() {
    let shape = || Shape::circle(fx!(1)).expect("a disc");
    let solid =
        |kind, filter| BodyDef { kind, ..BodyDef::default() }.with_collider(ColliderDef { filter, ..shape().into() });
    let watch = |kind, filter| {
        BodyDef { kind, ..BodyDef::default() }.with_collider(ColliderDef {
            filter,
            density: fx!(1),
            ..sensor(shape(), 0)
        })
    };
    let (any, apart) = (Filter::default(), Filter { mask: 2, ..Filter::default() });
    let (fixed, driven, free) = (BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic);
    for (a, b, expected) in [
        (watch(fixed, any), solid(free, any), 1),
        (watch(fixed, any), solid(driven, any), 1),
        (watch(fixed, any), solid(fixed, any), 0),
        (watch(driven, any), solid(fixed, any), 1),
        (watch(driven, any), solid(driven, any), 1),
        (watch(free, any), solid(fixed, any), 1),
        (watch(free, any), solid(free, any), 1),
        (watch(free, apart), solid(free, any), 0),
        (watch(free, any), watch(free, any), 0),
        (watch(fixed, any), watch(free, any), 0),
    ] {
        let (mut world, _) = world(WorldDef { gravity: Vec2::ZERO, ..def() }, [a.clone(), b.clone()]).expect("a scene");
        assert_eq!(world.step().sensors_entered.len(), expected, "{a:?} {b:?}");
        assert_eq!(world.step().sensors_entered.len(), 0);
        assert_eq!(world.contacts().count(), 0);
    }
}

#[test]
fn a_step_in_which_nothing_enters_or_leaves_can_be_undone() {
    let goal = BodyDef::fixed().with_collider(sensor(Shape::rectangle(fx!(4), fx!(4)).expect("a box"), 0));
    let disc = BodyDef { position: vec2(-6, 0), velocity: vec2(6, 0), ..BodyDef::dynamic() };
    let disc = disc.with_collider(Shape::circle(fx!(0.5)).expect("a disc"));
    let (mut world, _) = world(WorldDef { gravity: Vec2::ZERO, ..def() }, [goal, disc]).expect("a scene");
    let [mut undone, mut refused] = [0; 2];
    for _ in 0..120 {
        let before = world.state_hash();
        world.step();
        let mut back = world.clone();
        if back.step_back(&[]).is_ok() {
            assert_eq!(back.state_hash(), before);
            undone += 1;
        } else {
            refused += 1;
        }
    }
    // On the way in and out, and in the tick after.
    assert_eq!((undone, refused), (116, 4));
}

#[test]
fn a_sensor_over_sleeping_bodies_wakes_nobody_and_queries_do_not_see_it() {
    let (mut world, ids) =
        world(quiet(), [ground().expect("a ground"), square(vec2(0, fx!(0.5)), 1).expect("a square")])
            .expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    assert_eq!(world.moving_count(), 0);
    let drone = BodyDef { position: vec2(-3, fx!(0.5)), velocity: vec2(2, 0), ..BodyDef::kinematic() };
    let drone = drone.with_collider(sensor(Shape::circle(fx!(1)).expect("a disc"), 0));
    let drone = world.add_body(drone).expect("a body");
    let mut observer = Observer::default();
    for _ in 0..300 {
        observer.step(&mut world);
        assert_eq!(world.body(ids[1]).expect("a body").activity(), Activity::Asleep);
    }
    // The ground from the first step on, then the square, in and out.
    assert_eq!((observer.counts, observer.inside.len()), ([0, 0, 0, 1, 2], 1));
    let at = world.body(drone).expect("a body").position() + vec2(0, fx!(0.9));
    assert!(world.queries().overlap_point(at, &QueryFilter::default()).expect("a point").is_empty());
}

#[test]
fn forged_overlaps_are_refused() {
    let (world, ..) = goal();
    let bytes = world.snapshot().to_bytes();
    // At the end: one overlap of 8 bytes after its count, no pair that ended, no joint and no free slot of one, the tick of the last pull,
    // no body that woke, the hash, the seal.
    let overlap = bytes.len() - 16 - 8 - 4 * 4 - 8;
    assert_eq!(bytes[overlap - 4..overlap + 8], [1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    for (at, value) in [
        (overlap, 1),     // no sensor
        (overlap, 9),     // a collider that is not there
        (overlap + 4, 0), // the sensor itself
        (overlap + 4, 9),
    ] {
        let mut forged = bytes.clone();
        forged[at] = value;
        let error = Snapshot::from_bytes(&forged, &[]).expect_err("no world has this");
        assert!(matches!(error, SnapshotError::Malformed(_)), "{at}: {error}");
    }
}

/// Sensors of several sizes over bodies that lie in a row, none of them turned, and what each finds: by keys.
fn row(contacts: ContactSettings, order: &[u64], steps: usize) -> World {
    let mut world = World::new(WorldDef { contacts, sleep_after: Some(4), ..WorldDef::default() }).expect("a world");
    let square = Shape::rectangle(fx!(0.5), fx!(0.5)).expect("a square");
    for &key in order {
        let place = vec2(key as i32, 0);
        let def = match key {
            // A sensor with as many bodies as its number, and more far to its right.
            0..12 => {
                let shape = Shape::rectangle(Fx::from(key as i32) + fx!(0.49), fx!(1)).expect("a rectangle");
                let reach = Fx::from(key as i32) / 2 - fx!(0.5);
                let at = ColliderDef { position: Vec2::new(reach, fx!(0)), ..sensor(shape, key) };
                let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][key as usize % 3];
                let mass = Mass::Kilograms(fx!(1));
                let def = BodyDef { kind, key, mass, position: vec2(100, 0), ..BodyDef::dynamic() };
                BodyDef { gravity_scale: fx!(0), ..def }.with_collider(at)
            }
            // The others move a little, or fall asleep, or are static.
            _ => {
                let kind = if key % 4 == 0 { BodyKind::Static } else { BodyKind::Dynamic };
                let velocity = if key % 4 == 1 { Vec2::new(fx!(0), fx!(0.0625)) } else { vec2(0, 0) };
                let position = place + vec2(88, 0);
                let def = BodyDef { kind, key, position, velocity, gravity_scale: fx!(0), ..BodyDef::dynamic() };
                def.with_collider(ColliderDef { key, ..ColliderDef::new(square.clone()) })
            }
        };
        world.add_body(def).expect("a fair body");
    }
    for _ in 0..steps {
        assert!(world.step().faults.is_empty());
    }
    world
}

fn found_by_keys(world: &World) -> BTreeSet<[u64; 2]> {
    let key = |collider: ColliderId| world.collider(collider).expect("it is there").key;
    world.sensor_overlaps().map(|pair| pair.colliders.map(key)).collect()
}

#[test]
fn with_too_many_pairs_the_sensors_with_the_most_find_nothing() {
    let up: Vec<u64> = (0..30).collect();
    let down: Vec<u64> = up.iter().rev().copied().collect();
    let mixed: Vec<u64> = up.iter().map(|i| i * 7 % 30).collect();
    let all = found_by_keys(&row(ContactSettings::default(), &up, 1));
    let count = |pairs: &BTreeSet<[u64; 2]>, sensor: u64| pairs.iter().filter(|[number, _]| *number == sensor).count();
    for sensor in 0..12u64 {
        // A static one sees no static body.
        let statics = (12..12 + sensor).filter(|key| key % 4 == 0 && sensor % 3 == 0).count();
        assert_eq!(count(&all, sensor), sensor as usize - statics);
    }
    let mut cuts = BTreeSet::new();
    for (max_pairs, per_sensor) in [(0x1000, 1), (60, 256), (40, 256), (40, 4), (10, 256), (10, 3), (1, 256), (1, 1)] {
        let contacts = ContactSettings { max_pairs, max_pairs_per_collider: per_sensor, ..ContactSettings::default() };
        let max = max_pairs as usize;
        // The largest number at which the sensors that have as many at most fit.
        let fits = |cap: usize| {
            (0..12).map(|number| count(&all, number)).filter(|&number| number <= cap).sum::<usize>() <= max
        };
        let cap =
            if all.len() <= max { 12 } else { (0..=per_sensor as usize).rev().find(|&cap| fits(cap)).expect("none") };
        let expected: BTreeSet<[u64; 2]> = all.iter().copied().filter(|pair| count(&all, pair[0]) <= cap).collect();
        cuts.insert(expected.len());
        for (order, steps) in [(&up, 1), (&down, 1), (&mixed, 1), (&up, 2), (&mixed, 6), (&down, 6)] {
            let world = row(contacts, order, steps);
            assert_eq!(world.bodies().any(|body| body.activity() == Activity::Asleep), steps > 2);
            assert_eq!(found_by_keys(&world), expected, "{max_pairs}, {per_sensor}");
        }
        let world = row(contacts, &up, 3);
        let image = Symmetry::TURN.world(&world).expect("an image");
        let (mut world, mut image) = (world, image);
        world.step();
        image.step();
        assert_eq!(found_by_keys(&image), found_by_keys(&world));
    }
    assert!(cuts.len() >= 4, "{cuts:?}");
    // All of them fit, as many as a sensor has; one less, and no sensor with more than one has any.
    for (max_pairs, expected) in [(all.len(), all.len()), (all.len() - 1, 1)] {
        let contacts =
            ContactSettings { max_pairs: max_pairs as u32, max_pairs_per_collider: 1, ..ContactSettings::default() };
        for order in [&up, &down, &mixed] {
            assert_eq!(found_by_keys(&row(contacts, order, 1)).len(), expected);
        }
    }
}

#[test]
fn a_body_in_more_sensors_than_the_limit_of_pairs_is_in_none() {
    for (max_pairs, expected) in [(3, 3), (2, 0)] {
        let contacts = ContactSettings { max_pairs, ..ContactSettings::default() };
        let square = || Shape::rectangle(fx!(1), fx!(1)).expect("a square");
        let mut bodies = vec![BodyDef::dynamic().with_collider(square())];
        bodies.extend((0..3).map(|key| BodyDef { key, ..BodyDef::fixed().with_collider(sensor(square(), key)) }));
        let def = WorldDef { gravity: Vec2::ZERO, contacts, ..def() };
        let (mut world, _) = world(def, bodies).expect("a scene");
        assert_eq!(world.step().sensors_entered.len(), expected);
    }
}

type Change = fn(&mut World, [BodyId; 2]) -> Result<(), Error>;

/// Undoes a step that reports what a call ended to the bit, or refuses to: until that step the end is part of the state.
#[test]
fn a_step_that_reports_what_a_call_ended_is_undone_to_the_bit_or_not_at_all() {
    let changes: [Change; 3] = [
        |world, [_, visitor]| world.remove_body(visitor),
        |world, [goal, _]| world.remove_body(goal),
        |world, [_, visitor]| {
            let collider = world.colliders_of(visitor)?.next().expect("a disc");
            world.remove_collider(collider)
        },
    ];
    for (which, change) in changes.into_iter().enumerate() {
        let goal = ColliderDef { sensor: true, ..ColliderDef::new(Shape::rectangle(4, 4).expect("a box")) };
        let disc = BodyDef::dynamic().with_collider(Shape::circle(1).expect("a disc"));
        let def = WorldDef { gravity: vec2(0, 0), ..def() };
        let bodies = [BodyDef { key: 1, ..BodyDef::fixed().with_collider(goal) }, BodyDef { key: 2, ..disc }];
        let (mut world, ids) = world(def, bodies).expect("a scene");
        // It entered in the first step; nothing has happened since.
        (0..5).for_each(|_| _ = world.step());
        change(&mut world, [ids[0], ids[1]]).expect("a change");
        let before = world.clone();
        assert_eq!(world.step().sensors_left.len(), 1, "{which}");
        if world.step_back(&[]).is_ok() {
            assert_eq!(world.first_difference(&before), None, "{which}");
            assert_eq!(world.state_hash(), before.state_hash(), "{which}");
            // Made again, it reports the same.
            assert_eq!(world.step().sensors_left.len(), 1, "{which}");
        }
    }
}
