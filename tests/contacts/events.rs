//! Events of contacts: begins, ends and hits.

use std::collections::BTreeSet;

use super::scenes::{def, ground, material, square, through_bytes, world};
use crate::seeds::run_seed;
use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, ColliderPair, ContactSettings, Error, Event, EventStatus,
    Exclusion, Filter, Fx, Mass, Part, Random, Rollback, Shape, Snapshot, Symmetry, TimeStep, Vec2, World, WorldDef,
    fx, limits, vec2,
};

/// Two colliders by their handles.
pub(super) type Pair = [ColliderId; 2];

/// Follows the events of a world. No pair may begin twice or end without having begun.
#[derive(Default)]
pub(super) struct Observer {
    pub(super) touching: BTreeSet<Pair>,
    pub(super) inside: BTreeSet<Pair>,
    /// The numbers of contacts that ended and began, of hits, and of what left and entered sensors.
    pub(super) counts: [usize; 5],
}

impl Observer {
    pub(super) fn step(&mut self, world: &mut World) {
        for event in world.step() {
            self.note(&event);
        }
    }

    pub(super) fn note(&mut self, event: &Event) {
        let kind = match event {
            Event::ContactEnded(pair) => {
                assert!(self.touching.remove(&pair.colliders), "{event} without having touched it");
                0
            }
            Event::ContactBegan(pair) => {
                assert!(self.touching.insert(pair.colliders), "{event} twice");
                1
            }
            Event::ContactHit(_) => 2,
            Event::SensorLeft(pair) => {
                assert!(self.inside.remove(&pair.colliders), "{event} without having entered it");
                3
            }
            Event::SensorEntered(pair) => {
                assert!(self.inside.insert(pair.colliders), "{event} twice");
                4
            }
            _ => return,
        };
        self.counts[kind] += 1;
    }
}

/// Bodies at rest fall asleep soon.
pub(super) fn quiet() -> WorldDef {
    WorldDef { sleep_after: Some(20), ..def() }
}

fn def_without_gravity() -> WorldDef {
    WorldDef { gravity: Vec2::ZERO, ..def() }
}

fn eventful(def: BodyDef) -> BodyDef {
    let flagged = |collider: ColliderDef| ColliderDef { contact_events: true, hit_events: true, ..collider };
    BodyDef { colliders: def.colliders.into_iter().map(flagged).collect(), ..def }
}

fn disc(at: Vec2, key: u64) -> BodyDef {
    let shape = Shape::circle(fx!(0.5)).expect("a disc");
    BodyDef { position: at, key, ..BodyDef::dynamic().with_collider(ColliderDef { key, ..shape.into() }) }
}

/// A ground, and bodies of which every other one has events, some at speed.
pub(super) fn crowd(count: u64, seed: u64) -> Vec<BodyDef> {
    let mut random = Random::seeded(run_seed(seed));
    let mut bodies = vec![BodyDef { key: 1_000, ..ground().expect("a ground") }];
    for key in 0..count {
        let mut number = |max: i32| random.number(Fx::from(-max)..=Fx::from(max));
        let at = vec2(number(4), number(3) + fx!(4));
        let velocity = vec2(number(4), number(4));
        let def = if key % 3 == 0 { disc(at, key) } else { square(at, key).expect("a square") };
        let mut def = BodyDef { velocity, key, ..def };
        for collider in &mut def.colliders {
            collider.material = material(fx!(0.5), if key % 4 == 0 { fx!(0.5) } else { fx!(0) });
            (collider.contact_events, collider.hit_events) = (key % 2 == 0, key % 5 == 0);
            collider.key = key;
        }
        bodies.push(def);
    }
    bodies
}

/// The pairs of colliders that touch in a world and of which one has contact events, each in the order that events have.
fn pairs(world: &World) -> BTreeSet<Pair> {
    let flagged = |id: ColliderId| world.collider(id).expect("it is there").contact_events;
    let rank = |id: ColliderId| {
        let body = world.collider_body(id).expect("it is there");
        (world.body(body).expect("it is there").key(), world.collider(id).expect("it is there").key, id)
    };
    let touching_pairs = world.contacts().map(|contact| contact.colliders);
    let touching_pairs = touching_pairs.filter(|pair| pair.iter().any(|id| flagged(*id)));
    touching_pairs.map(|[a, b]| if rank(a) < rank(b) { [a, b] } else { [b, a] }).collect()
}

/// Makes a random call: bodies and colliders come, go, and change.
pub(super) fn shake(world: &mut World, random: &mut Random) {
    let bodies: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    let body = bodies[1 + random.below(bodies.len() as u64 - 1) as usize];
    let partner = bodies[random.below(bodies.len() as u64) as usize];
    let collider = world.colliders_of(body).expect("a body").next();
    let at = vec2(random.number(fx!(-4)..=fx!(4)), random.number(fx!(0)..=fx!(6)));
    // A refused call changes nothing.
    match random.below(12) {
        0 => _ = world.remove_body(body),
        1 => _ = world.add_body(crowd(1, random.below(1 << 32)).pop().expect("a body")),
        2 => _ = world.disable(body),
        3 | 4 => bodies.iter().for_each(|body| _ = world.enable(*body)),
        5 => _ = world.set_position(body, at),
        6 => {
            let place = world.body(partner).expect("a body").position();
            _ = world.set_position(body, place + vec2(fx!(0.2), fx!(0.1)));
        }
        7 | 8 => {
            let Some(collider) = collider else { return };
            let def = world.collider(collider).expect("a collider").clone();
            let next = match random.below(4) {
                0 => ColliderDef { contact_events: !def.contact_events, ..def },
                1 => ColliderDef { filter: Filter { mask: def.filter.mask ^ 2, ..def.filter }, ..def },
                2 => ColliderDef { sensor: !def.sensor, ..def },
                _ => def,
            };
            _ = world.set_collider(collider, next);
        }
        9 => {
            if let Some(collider) = collider {
                _ = world.remove_collider(collider);
            }
            _ = world.add_collider(body, Shape::circle(fx!(0.4)).expect("a disc"));
        }
        10 => drop(world.exclude_pair(body, partner, Exclusion::UntilApart)),
        _ => {
            let kind = if random.below(2) == 0 { BodyKind::Kinematic } else { BodyKind::Dynamic };
            _ = world.set_kind(body, kind);
        }
    }
}

#[test]
fn events_are_the_differences_of_contacts_whatever_calls_do() {
    let mut counts = [0; 2];
    for seed in 0..12 {
        let (mut world, _) = world(quiet(), crowd(14, seed)).expect("a scene");
        let (mut observer, mut random) = (Observer::default(), Random::seeded(run_seed(seed)));
        for _ in 0..300 {
            if random.below(4) == 0 {
                shake(&mut world, &mut random);
            }
            observer.step(&mut world);
            let touching = pairs(&world);
            // Bodies that bounced may be apart at the end of the step.
            assert!(touching.is_subset(&observer.touching), "{touching:?} {:?}", observer.touching);
            let is_apart = |[a, b]: &Pair| {
                let body = |id: ColliderId| world.collider_body(id).expect("it touches");
                world.contacts_of(body(*a)).expect("a body").all(|contact| !contact.bodies.contains(&body(*b)))
            };
            assert!(observer.touching.difference(&touching).all(is_apart));
        }
        counts[0] += observer.counts[0];
        counts[1] += observer.counts[1];
    }
    assert!(counts[0] > 500 && counts[1] >= counts[0], "{counts:?}");
}

#[test]
fn a_restored_world_has_the_events_of_one_that_was_not() {
    let mut met = [0; 5];
    for seed in 3..6 {
        let (mut world, _) = world(quiet(), crowd(14, seed)).expect("a scene");
        let mut random = Random::seeded(run_seed(seed + 2));
        for _ in 0..400 {
            if random.below(3) == 0 {
                shake(&mut world, &mut random);
            }
            // Between a call and the step, from bytes.
            let bytes = world.snapshot().to_bytes();
            let mut fresh = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
            let mut copy = world.clone();
            assert_eq!(fresh.state_hash(), world.state_hash());
            let [a, b, c] = [&mut world, &mut fresh, &mut copy].map(|world| {
                let report = world.step();
                let StepLists { lists, hits } = StepLists::of(&report);
                (lists, hits)
            });
            assert_eq!(a, b);
            assert_eq!(a, c);
            let counts = [a.0[0].len(), a.0[1].len(), a.1.len(), a.0[2].len(), a.0[3].len()];
            (0..5).for_each(|i| met[i] += counts[i]);
        }
    }
    assert!(met.iter().all(|count| *count > 5), "{met:?}");
}

/// The events of a step.
struct StepLists {
    lists: [Vec<ColliderPair>; 4],
    hits: Vec<umbra_physics::ContactHit>,
}

/// The keys of the bodies, the approach speed, the normal, the point, the impulse.
type HitByKey = ([u64; 2], Fx, Vec2, Vec2, Fx);

impl StepLists {
    fn of(report: &umbra_physics::StepReport<'_>) -> Self {
        let lists = [report.contacts_ended, report.contacts_began, report.sensors_left, report.sensors_entered];
        Self { lists: lists.map(<[_]>::to_vec), hits: report.hits.to_vec() }
    }

    /// Keys alone, and hits without handles.
    fn by_key(&self) -> ([Vec<[u64; 2]>; 4], Vec<HitByKey>) {
        let keys = |pairs: &Vec<ColliderPair>| pairs.iter().map(|pair| pair.body_keys).collect();
        let hit = |hit: &umbra_physics::ContactHit| {
            (hit.pair.body_keys, hit.approach_speed, hit.normal, hit.point, hit.normal_impulse)
        };
        ([0, 1, 2, 3].map(|i| keys(&self.lists[i])), self.hits.iter().map(hit).collect())
    }
}

#[test]
fn the_order_of_insertion_changes_no_event() {
    let bodies = crowd(20, 8);
    let mut shuffled = bodies.clone();
    let mut random = Random::seeded(run_seed(7));
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, random.below(i as u64 + 1) as usize);
    }
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let (mut twin, _) = world(def(), shuffled).expect("a scene");
    let mut count = 0;
    for tick in 0..400 {
        let [a, b] = [&mut here, &mut twin].map(|world| StepLists::of(&world.step()).by_key());
        count += a.0[0].len() + a.1.len();
        assert_eq!(a, b, "{tick}");
    }
    assert!(count > 100, "{count}");
}

#[test]
fn a_mirror_image_has_the_image_of_each_event() {
    for symmetry in [Symmetry::MIRROR, Symmetry::TURN] {
        let (mut here, _) = world(quiet(), crowd(20, 9)).expect("a scene");
        let mut twin = symmetry.world(&here).expect("an image");
        let (mut count, mut random) = (0, Random::seeded(run_seed(2)));
        for tick in 0..400 {
            let (a, b) = (StepLists::of(&here.step()), StepLists::of(&twin.step()));
            assert_eq!(a.lists, b.lists, "{tick}");
            let image = |v: Vec2| if symmetry == Symmetry::MIRROR { vec2(-v.x, v.y) } else { vec2(-v.y, v.x) };
            assert_eq!(a.hits.len(), b.hits.len());
            for (a, b) in a.hits.iter().zip(&b.hits) {
                assert_eq!((a.pair, a.approach_speed, a.normal_impulse), (b.pair, b.approach_speed, b.normal_impulse));
                assert_eq!((image(a.normal), image(a.point)), (b.normal, b.point), "{tick}");
            }
            count += a.lists[0].len() + a.hits.len();
            if tick % 20 == 19 {
                // A call, and an image of what is there then.
                shake(&mut here, &mut random);
                twin = symmetry.world(&here).expect("an image");
            }
        }
        assert!(count > 100, "{count}");
    }
}

#[test]
fn events_change_no_motion() {
    let silent = |mut def: BodyDef| {
        for collider in &mut def.colliders {
            (collider.contact_events, collider.hit_events) = (false, false);
        }
        def
    };
    for seed in 0..6 {
        let loud = crowd(16, seed);
        let (mut here, ids) = world(quiet(), loud.clone()).expect("a scene");
        let (mut twin, _) = world(quiet(), loud.into_iter().map(silent)).expect("a scene");
        for tick in 0..600 {
            here.step();
            twin.step();
            for &id in &ids {
                let [a, b] = [&here, &twin].map(|world| {
                    let body = world.body(id).expect("a body");
                    (body.position_exact(), body.angle_exact(), body.activity())
                });
                assert_eq!(a, b, "{tick}");
            }
            if tick == 400 {
                for world in [&mut here, &mut twin] {
                    world.set_velocity(ids[3], vec2(2, 4)).expect("a body");
                }
            }
        }
    }
}

/// A disc with events on the ground, once it touches.
fn resting() -> (World, [BodyId; 2], Observer) {
    let (mut world, ids) =
        world(quiet(), [ground().expect("a ground"), eventful(disc(vec2(0, 1), 7))]).expect("a scene");
    let mut observer = Observer::default();
    (0..60).for_each(|_| observer.step(&mut world));
    assert_eq!((observer.counts[..3].to_vec(), observer.touching.len()), (vec![0, 1, 1], 1));
    (world, [ids[0], ids[1]], observer)
}

/// The events of contacts in the next step: how many ended and began.
fn next(world: &mut World, observer: &mut Observer) -> [usize; 2] {
    let before = observer.counts;
    observer.step(world);
    [0, 1].map(|kind| observer.counts[kind] - before[kind])
}

#[test]
fn contacts_ended_by_calls_are_reported_by_the_next_step() {
    type Call = fn(&mut World, [BodyId; 2]);
    let calls: [(&str, Call, [usize; 2]); 10] = [
        ("body", |world, [_, disc]| world.remove_body(disc).expect("a body"), [1, 0]),
        ("ground", |world, [ground, _]| world.remove_body(ground).expect("a body"), [1, 0]),
        (
            "collider",
            |world, [_, disc]| {
                let collider = world.colliders_of(disc).expect("a body").next().expect("a collider");
                world.remove_collider(collider).expect("a collider");
            },
            [1, 0],
        ),
        (
            "slot used again",
            |world, [_, disc]| {
                let collider = world.colliders_of(disc).expect("a body").next().expect("a collider");
                let def = world.collider(collider).expect("a collider").clone();
                world.remove_collider(collider).expect("a collider");
                let again = world.add_collider(disc, def).expect("a collider");
                assert_eq!(again.parts().0, collider.parts().0);
            },
            [1, 1],
        ),
        (
            "replaced",
            |world, [_, disc]| {
                let collider = world.colliders_of(disc).expect("a body").next().expect("a collider");
                let def = world.collider(collider).expect("a collider").clone();
                world.set_collider(collider, def).expect("a collider");
            },
            [1, 1],
        ),
        (
            "flag",
            |world, [_, disc]| {
                let collider = world.colliders_of(disc).expect("a body").next().expect("a collider");
                let def =
                    ColliderDef { contact_events: false, ..world.collider(collider).expect("a collider").clone() };
                world.set_collider(collider, def).expect("a collider");
            },
            [1, 0],
        ),
        ("disabled", |world, [_, disc]| world.disable(disc).expect("a body"), [1, 0]),
        ("far", |world, [_, disc]| world.set_position(disc, vec2(0, 50)).expect("a body"), [1, 0]),
        ("near", |world, [_, disc]| world.set_position(disc, vec2(1, fx!(0.5))).expect("a body"), [0, 0]),
        (
            "excluded",
            |world, [ground, disc]| world.exclude_pair(ground, disc, Exclusion::Always).expect("a pair"),
            [1, 0],
        ),
    ];
    for is_asleep in [false, true] {
        for (name, call, expected) in calls {
            let (mut world, ids, mut observer) = resting();
            if is_asleep {
                (0..60).for_each(|_| assert_eq!(next(&mut world, &mut observer), [0, 0], "asleep"));
                assert_eq!(world.moving_count(), 0);
            }
            let pair = *observer.touching.first().expect("it touches");
            call(&mut world, ids);
            // Also if the world goes through a file in between.
            let mut fresh = through_bytes(&world);
            assert_eq!(next(&mut world, &mut observer), expected, "{name} {is_asleep}");
            let report = fresh.step();
            assert_eq!([report.contacts_ended.len(), report.contacts_began.len()], expected, "{name} restored");
            if let [ended] = report.contacts_ended {
                assert_eq!((ended.colliders, ended.body_keys), (pair, [7, 1 << 40]));
                assert_eq!(ended.bodies, [ids[1], ids[0]]);
            }
            // Once.
            if name != "near" && name != "far" {
                assert_eq!(next(&mut world, &mut observer), [0, 0], "{name} again");
            }
        }
    }
}

#[test]
fn sleep_and_waking_end_and_begin_nothing() {
    let (mut world, [_, disc], mut observer) = resting();
    for _ in 0..3 {
        while world.moving_count() > 0 {
            assert_eq!(next(&mut world, &mut observer), [0, 0]);
        }
        (0..10).for_each(|_| assert_eq!(next(&mut world, &mut observer), [0, 0]));
        world.wake(disc).expect("a body");
        (0..5).for_each(|_| assert_eq!(next(&mut world, &mut observer), [0, 0]));
    }
    // Touched by another one, it wakes in the step.
    while world.moving_count() > 0 {
        observer.step(&mut world);
    }
    let hit = eventful(BodyDef { velocity: vec2(-3, 0), ..self::disc(vec2(2, fx!(0.6)), 9) });
    world.add_body(hit).expect("a body");
    let on_ground = *observer.touching.first().expect("it touches");
    assert_eq!(observer.touching.len(), 1);
    let tick = (0..60).find(|_| {
        let before = observer.counts[0];
        observer.step(&mut world);
        let woke = world.last_report().woke == [disc];
        assert!(!woke || observer.counts[0] == before && observer.touching.contains(&on_ground));
        woke
    });
    assert!(tick.is_some() && observer.touching.len() > 1);
}

#[test]
fn a_change_of_the_time_step_ends_nothing() {
    let (mut world, _, mut observer) = resting();
    for rate in [10_000, 60, 7_000] {
        world.set_time_step(TimeStep::hz(rate)).expect("a rate");
        (0..3).for_each(|_| assert_eq!(next(&mut world, &mut observer), [0, 0]));
    }
}

#[test]
fn contacts_of_a_quarantined_body_end_in_the_step_of_its_fault() {
    // Too many pairs.
    let contacts = ContactSettings { max_pairs: 60, max_pairs_per_collider: 8, ..ContactSettings::default() };
    let bodies = [ground().expect("a ground"), eventful(disc(vec2(0, 1), 7))];
    let (mut world, ids) = world(WorldDef { contacts, ..def() }, bodies).expect("a scene");
    let mut observer = Observer::default();
    (0..60).for_each(|_| observer.step(&mut world));
    for i in 0..30 {
        let square = square(vec2(0, fx!(0.5)), i).expect("a square");
        world.add_body(square).expect("a body");
    }
    let report = world.step();
    assert!(report.faults.iter().any(|fault| fault.body == ids[1]));
    assert_eq!((report.contacts_ended.len(), report.contacts_began.len()), (1, 0));
    // Released, it touches anew.
    let others: Vec<BodyId> = world.bodies().map(|body| body.id()).filter(|id| !ids.contains(id)).collect();
    others.into_iter().for_each(|id| world.remove_body(id).expect("a body"));
    world.release(ids[1]).expect("a body");
    let report = world.step();
    assert_eq!((report.contacts_ended.len(), report.contacts_began.len()), (0, 1));
}

#[test]
fn a_body_that_an_impulse_takes_out_of_range_ends_what_it_touched_at_once() {
    // The heavy one ends the step in range, and the light one in front of it would not.
    let edge = limits::POSITION;
    let at = |x: Fx, key| eventful(disc(vec2(x, 0), key));
    let fast = BodyDef { velocity: vec2(90, 0), mass: Mass::Kilograms(fx!(1000)), ..at(edge - fx!(2), 1) };
    let target = BodyDef { mass: Mass::Kilograms(fx!(1)), ..at(edge - fx!(0.75), 2) };
    let (mut world, ids) = world(def_without_gravity(), [fast, target]).expect("a scene");
    let mut observer = Observer::default();
    observer.step(&mut world);
    let faults: Vec<BodyId> = world.last_report().faults.iter().map(|fault| fault.body).collect();
    assert_eq!((faults, observer.counts), (vec![ids[1]], [0; 5]));
    assert_eq!(world.contacts().count(), 0);
}

#[test]
fn a_bounce_begins_and_ends_and_is_a_hit_of_the_right_size() {
    let mut ball = eventful(BodyDef { position: vec2(3, 5), velocity: vec2(1, -8), ..disc(vec2(3, 5), 4) });
    ball.colliders[0].material = material(fx!(0), fx!(0.5));
    let (mut world, _) =
        world(WorldDef { gravity: Vec2::ZERO, ..def() }, [ground().expect("a ground"), ball]).expect("a scene");
    let mut observer = Observer::default();
    let mut hits = Vec::new();
    for _ in 0..120 {
        observer.step(&mut world);
        hits.extend(world.last_report().hits.iter().copied());
    }
    assert_eq!((observer.counts, observer.touching.len()), ([1, 1, 1, 0, 0], 0));
    let hit = hits[0];
    // The disc has the lower key: the normal is from it to the ground.
    assert_eq!((hit.approach_speed, hit.normal), (fx!(8), vec2(0, -1)));
    // π/4 kg that turn 8 m/s into −4 m/s.
    assert!((hit.normal_impulse - fx!(9.42478)).abs() < fx!(0.001), "{}", hit.normal_impulse);
    // It is at the ground after 4.5 m at 8 m/s, and meanwhile goes to the right: 1/60 m a step, of which half is the error.
    assert!(
        (hit.point.x - fx!(3.5625)).abs() < Fx::from_ratio(1, 120) && hit.point.y.abs() < fx!(0.001),
        "{}",
        hit.point
    );
}

#[test]
fn each_flag_has_its_own_events() {
    for (contact_events, hit_events) in [(true, false), (false, true)] {
        let mut ball = BodyDef { velocity: vec2(0, -8), ..disc(vec2(0, 3), 4) };
        let collider = ball.colliders[0].clone();
        ball.colliders[0] =
            ColliderDef { material: material(fx!(0), fx!(0.5)), contact_events, hit_events, ..collider };
        let (mut world, _) =
            world(WorldDef { gravity: Vec2::ZERO, ..def() }, [ground().expect("a ground"), ball]).expect("a scene");
        let mut observer = Observer::default();
        (0..60).for_each(|_| observer.step(&mut world));
        let [touches, hits] = [contact_events, hit_events].map(usize::from);
        assert_eq!(observer.counts, [touches, touches, hits, 0, 0]);
    }
}

#[test]
fn contacts_without_events_are_there_while_an_impulse_is_left() {
    // Two balls bounce in the same step, and are still within 2 cm of the ground at its end: the one with events has a contact in it, the
    // other one none any more.
    let ball = |x: i32, key, contact_events| {
        let mut def = BodyDef { velocity: vec2(0, fx!(-1.15)), ..disc(vec2(x, 1), key) };
        def.colliders[0].material = material(fx!(0), fx!(1));
        def.colliders[0].contact_events = contact_events;
        def
    };
    let bodies = [ground().expect("a ground"), ball(0, 1, true), ball(4, 2, false)];
    let (mut world, ids) = world(WorldDef { gravity: Vec2::ZERO, ..def() }, bodies).expect("a scene");
    let touched = (0..60).find(|_| !world.step().contacts_began.is_empty());
    let count = |body| world.contacts_of(body).expect("a body").count();
    assert_eq!((touched.is_some(), count(ids[1]), count(ids[2])), (true, 1, 0));
}

#[test]
fn a_contact_of_several_parts_begins_and_ends_once_and_has_a_hit_for_each() {
    let foot = |x: Fx| Part {
        shape: Shape::circle(fx!(0.25)).expect("a disc"),
        position: vec2(x, 0),
        angle: fx!(0),
        density: fx!(1),
    };
    let feet = Shape::compound(&[foot(fx!(-1)), foot(fx!(1)), foot(fx!(0))]).expect("feet");
    for (key, is_first) in [(1, true), (1 << 50, false)] {
        let def = BodyDef { key, velocity: vec2(0, -6), position: vec2(0, 2), ..BodyDef::dynamic() };
        let bodies = [ground().expect("a ground"), eventful(def.with_collider(feet.clone()))];
        let (mut world, ids) = world(self::def(), bodies).expect("a scene");
        let (mut observer, mut hits) = (Observer::default(), Vec::new());
        for _ in 0..60 {
            observer.step(&mut world);
            hits.extend(world.last_report().hits.iter().map(|hit| hit.parts));
        }
        let expected = [0, 1, 2].map(|part| if is_first { [part, 0] } else { [0, part] });
        assert_eq!((observer.counts, hits), ([0, 1, 3, 0, 0], expected.to_vec()));
        world.remove_body(ids[1]).expect("a body");
        assert_eq!(next(&mut world, &mut observer), [1, 0]);
    }
}

#[test]
fn without_a_least_speed_a_contact_is_a_hit_once_and_not_before_it_pushes() {
    // Within 2 cm of the ground for two steps before it arrives; then it rests.
    let contacts = ContactSettings { hit_speed: fx!(0), ..ContactSettings::default() };
    for gravity_scale in [fx!(0), fx!(1)] {
        let ball = eventful(BodyDef { velocity: vec2(0, fx!(-0.45)), ..disc(vec2(0, fx!(0.518)), 4) });
        let bodies = [ground().expect("a ground"), BodyDef { gravity_scale, ..ball }];
        let (mut world, _) = world(WorldDef { contacts, ..def() }, bodies).expect("a scene");
        let mut hits = Vec::new();
        for _ in 0..30 {
            let report = world.step();
            assert_eq!(report.hits.len(), report.contacts_began.len());
            hits.extend(report.hits.iter().map(|hit| hit.approach_speed));
        }
        assert!(hits.len() == 1 && (hits[0] == fx!(0.45)) == (gravity_scale == fx!(0)), "{hits:?}");
    }
}

#[test]
fn a_contact_that_fell_asleep_without_an_impulse_ends_with_its_collider() {
    // It drifts into the wall, stops within the step, and sleeps at its end.
    let wall = BodyDef { key: 9, ..BodyDef::fixed().with_collider(Shape::rectangle(fx!(1), fx!(4)).expect("a wall")) };
    let ball = eventful(BodyDef { velocity: vec2(fx!(0.03), 0), ..disc(vec2(fx!(-1.0001), 0), 7) });
    let def = WorldDef { sleep_after: Some(1), ..def_without_gravity() };
    let (mut world, ids) = world(def, [wall.clone(), ball]).expect("a scene");
    let mut observer = Observer::default();
    observer.step(&mut world);
    assert_eq!((observer.counts[..3].to_vec(), world.moving_count()), (vec![0, 1, 0], 0));
    world.remove_body(ids[0]).expect("a body");
    // It touched the wall, and wakes. Another wall in the same place is another one.
    let again = world.add_body(wall).expect("a body");
    assert_eq!((again.parts().0, world.contacts().count(), world.moving_count()), (ids[0].parts().0, 0, 1));
    world.remove_body(again).expect("a body");
    assert_eq!(next(&mut world, &mut observer), [1, 0]);
    assert_eq!(next(&mut world, &mut observer), [0, 0]);
}

#[test]
fn only_what_closes_fast_enough_is_a_hit() {
    for (speed, expected) in [(fx!(1.9), 0), (fx!(2), 1), (fx!(30), 1), (fx!(3_000), 1)] {
        let contacts = ContactSettings { hit_speed: fx!(2), ..ContactSettings::default() };
        let boxes = |x: Fx, vx: Fx, key| {
            let def = square(vec2(x, 0), key).expect("a square");
            BodyDef { velocity: vec2(vx, 0), ..eventful(def) }
        };
        let bodies = [boxes(fx!(-3), speed, 5), boxes(fx!(3), fx!(0), 2)];
        let def = WorldDef { gravity: Vec2::ZERO, contacts, ..def() };
        let (mut world, _) = world(def, bodies).expect("a scene");
        let mut hits = Vec::new();
        (0..240).for_each(|_| hits.extend(world.step().hits.iter().copied()));
        assert_eq!(hits.len(), expected, "{speed}");
        for hit in hits {
            // The body with the lower key is first: it is on the right.
            assert_eq!((hit.pair.body_keys, hit.normal), ([2, 5], vec2(-1, 0)));
            // Two corners at one speed: the middle of the side.
            assert_eq!((hit.approach_speed, hit.point.y), (speed, fx!(0)));
            assert!((hit.point.x - fx!(2.5)).abs() < fx!(0.01), "{}", hit.point);
        }
    }
}

#[test]
fn an_impact_is_one_hit_at_any_part_of_a_step() {
    for i in 0..60 {
        for (speed, restitution) in [(12_i32, fx!(0)), (100, fx!(0)), (100, fx!(0.5)), (12, fx!(1))] {
            let away = fx!(1.3) + Fx::from_ratio((i * speed).into(), 60 * 60);
            let mut bodies = [disc(Vec2::ZERO, 1), eventful(disc(vec2(away, 0), 2))];
            bodies[0].kind = BodyKind::Static;
            bodies[1].velocity = vec2(-Fx::from(speed), 0);
            bodies[1].colliders[0].material = material(fx!(0), restitution);
            let (mut world, _) = world(WorldDef { gravity: Vec2::ZERO, ..def() }, bodies).expect("a scene");
            let mut hits = Vec::new();
            (0..10).for_each(|_| hits.extend(world.step().hits.iter().copied()));
            let speeds: Vec<Fx> = hits.iter().map(|hit| hit.approach_speed).collect();
            assert_eq!(speeds, [Fx::from(speed)], "{i} {restitution}");
            assert!((hits[0].point - vec2(fx!(0.5), 0)).length() < fx!(0.02), "{}", hits[0].point);
        }
    }
}

#[test]
fn a_game_tells_new_events_from_those_it_has_shown() {
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Push(bool);
    let bodies = [ground().expect("a ground"), eventful(disc(vec2(0, 3), 1)), eventful(disc(vec2(6, 3), 2))];
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    let truth = world.clone();
    let discs = [ids[1], ids[2]];
    let tick = |world: &mut World, inputs: &[(u32, Push)]| {
        for &(player, Push(is_on)) in inputs {
            if is_on {
                world.apply_impulse(discs[player as usize], vec2(0, fx!(0.4))).expect("a body");
            }
        }
    };
    // Player 1 pushes for a while, which the other side learns ten ticks late.
    let push = |tick: u64| Push(tick % 37 < 8);
    let mut rollback = Rollback::new(&world, [0, 1], 16);
    let mut shown: Vec<(u64, Event)> = Vec::new();
    let (mut undone, mut count) = (0, 0);
    for now in 0..300 {
        rollback.add_input(now, 0, Push(false)).expect("a tick");
        if now >= 10 {
            rollback.add_input(now - 10, 1, push(now - 10)).expect("a tick");
        }
        let report = rollback.advance(&mut world, tick).expect("a tick");
        for event in report.events {
            match event.status {
                EventStatus::New => shown.push((event.tick, event.event)),
                EventStatus::SeenBefore => count += 1,
                EventStatus::Undone => {
                    let at = shown.iter().position(|entry| *entry == (event.tick, event.event));
                    shown.remove(at.expect("it was shown"));
                    undone += 1;
                }
            }
        }
    }
    // As if all inputs had been there in time.
    let mut twin = truth;
    let mut told = Vec::new();
    for now in 0..290 {
        tick(&mut twin, &[(0, Push(false)), (1, push(now))]);
        told.extend(twin.step().events().map(|event| (now, event)));
    }
    shown.retain(|(tick, _)| *tick < 290);
    shown.sort_by_key(|(tick, _)| *tick);
    let names = |list: &[(u64, Event)]| {
        let is_hit = |event: &Event| matches!(event, Event::ContactHit(_));
        let mut names: Vec<String> = list
            .iter()
            .map(|(tick, event)| if is_hit(event) { format!("{tick} hit") } else { format!("{tick} {event:?}") })
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(&shown), names(&told));
    assert!(told.len() > 10 && undone > 3 && count > 3, "{} {undone} {count}", told.len());
}

type Change = fn(&mut World, BodyId) -> Result<(), Error>;

/// A contact that fell asleep without an impulse ends where the other body goes without being removed.
#[test]
fn a_contact_that_fell_asleep_without_an_impulse_ends_where_the_other_body_goes() {
    let changes: [Change; 4] = [
        |world, wall| world.disable(wall),
        |world, wall| world.set_position(wall, vec2(50, 0)),
        |world, wall| world.set_angle(wall, Fx::FRAC_PI_2).and_then(|()| world.set_position(wall, vec2(0, 50))),
        |world, wall| {
            world.set_kind(wall, BodyKind::Kinematic)?;
            world.set_velocity(wall, vec2(30, 0))
        },
    ];
    for (which, change) in changes.into_iter().enumerate() {
        let wall =
            BodyDef { key: 9, ..BodyDef::fixed().with_collider(Shape::rectangle(fx!(1), fx!(4)).expect("a wall")) };
        let ball = eventful(BodyDef { velocity: vec2(fx!(0.03), 0), ..disc(vec2(fx!(-1.0001), 0), 7) });
        let def = WorldDef { sleep_after: Some(1), ..def_without_gravity() };
        let (mut world, ids) = world(def, [wall, ball]).expect("a scene");
        let mut observer = Observer::default();
        observer.step(&mut world);
        assert_eq!((observer.counts[..3].to_vec(), world.moving_count()), (vec![0, 1, 0], 0));
        change(&mut world, ids[0]).expect("a change");
        // In the next step, or at the latest in the one after it for the wall that flies off.
        let mut ended = 0;
        for _ in 0..3 {
            ended += next(&mut world, &mut observer)[0];
        }
        assert_eq!((ended, world.contacts().count()), (1, 0), "{which}");
    }
}
