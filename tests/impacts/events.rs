//! One begin and one end for each touch; a hit has the same impulse and speed at any moment of the step.

use std::collections::BTreeSet;

use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ColliderId, ContactHit, Error, Event, Filter, Fx, Irreversible, Mass, Shape,
    Snapshot, Vec2, World, WorldDef, fx, vec2,
};

use crate::impacts::flights::length;
use crate::impacts::scenes::{
    between, bouncing, build, conclude, disc, dynamic, falling, fixed, float, floating, floor, number, of_any_size,
    of_material, point, position, random, rectangle, room, seeds, steps,
};

/// All colliders of the body report their contacts and hits.
fn eventful(mut body: BodyDef) -> BodyDef {
    for collider in &mut body.colliders {
        (collider.contact_events, collider.hit_events) = (true, true);
    }
    body
}

/// Follows the contacts that a world reports.
#[derive(Default)]
struct Touches {
    touching: BTreeSet<[ColliderId; 2]>,
    begins: usize,
    ends: usize,
}

impl Touches {
    /// Steps a world. Fails if a contact begins or ends twice.
    fn step(&mut self, world: &mut World) {
        for event in world.step() {
            match event {
                Event::ContactBegan(pair) => {
                    assert!(self.touching.insert(pair.colliders), "{event} twice");
                    self.begins += 1;
                }
                Event::ContactEnded(pair) => {
                    assert!(self.touching.remove(&pair.colliders), "{event} twice");
                    self.ends += 1;
                }
                _ => {}
            }
        }
    }
}

#[test]
fn an_overlap_is_a_touch_that_begins_at_once_and_ends_once() {
    for gravity in [vec2(0, 0), vec2(0, -10)] {
        let wall = eventful(fixed(rectangle(fx!(10), fx!(2)), vec2(0, -1)));
        let body = dynamic(rectangle(fx!(1), fx!(1)), vec2(0, fx!(0.05)));
        let (mut world, ids) = build(WorldDef { gravity, ..floating() }, [wall, body]);
        let mut touches = Touches::default();
        touches.step(&mut world);
        assert_eq!((touches.begins, touches.ends), (1, 0));
        for tick in 1..40 {
            touches.step(&mut world);
            let is_inside = position(&world, ids[1])[1] < 0.49;
            assert!(!is_inside || world.contacts().count() == 1, "tick {tick}");
            assert!(!is_inside || (touches.begins, touches.ends) == (1, 0), "tick {tick}");
        }
        world.set_position(ids[1], vec2(0, 5)).expect("a place");
        touches.step(&mut world);
        assert_eq!((touches.begins, touches.ends), (1, 1));
    }
}

/// Boxes with a gap of exactly zero touch as soon as something presses them together, and not before.
#[test]
fn a_gap_of_zero_is_a_touch_once_an_impulse_acts() {
    let square = |x: i32, y: Vec2| eventful(dynamic(rectangle(fx!(1), fx!(1)), vec2(x, 0) + y));
    let row = || (0..4).map(|x| square(x, vec2(0, fx!(0.5))));
    let (mut world, _) = build(floating(), row());
    let mut touches = Touches::default();
    (0..60).for_each(|_| touches.step(&mut world));
    assert_eq!((touches.begins, world.contacts().count()), (0, 0));
    // On a floor, with their sides at each other.
    let (mut world, _) = build(falling(), std::iter::once(floor()).chain(row()));
    let mut touches = Touches::default();
    touches.step(&mut world);
    assert_eq!((touches.begins, touches.ends), (4, 0));
    (0..60).for_each(|_| touches.step(&mut world));
    assert_eq!((touches.begins, touches.ends), (4, 0));
}

/// Overlaps without an impulse are state that a step back would not find.
#[test]
fn bodies_that_part_from_an_overlap_touch_in_it() {
    let velocity = vec2(1, 0);
    let body = |x: Fx, velocity| BodyDef { velocity, ..eventful(dynamic(disc(fx!(0.5)), vec2(x, 0))) };
    let (mut world, _) = build(floating(), [body(fx!(0), -velocity), body(fx!(0.99), velocity)]);
    let mut touches = Touches::default();
    touches.step(&mut world);
    assert_eq!((touches.begins, touches.ends), (1, 0));
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Contact }));
    touches.step(&mut world);
    assert_eq!((touches.begins, touches.ends), (1, 1));
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Contact }));
}

/// Two discs and boxes that overlap by any depth, without gravity: one begin at once, also in a world that was
/// restored.
#[test]
fn random_overlaps_begin_at_once() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(15) {
        let random = &mut random("overlap events", seed);
        let sizes = [(); 2].map(|()| between(random, 0.1, 1.0));
        let depth = between(random, 0.02, 1.0) * f64::min(sizes[0], sizes[1]);
        let shape = |random: &mut umbra_physics::Random, size: f64| {
            if random.below(2) == 0 { disc(number(size)) } else { rectangle(number(2.0 * size), number(2.0 * size)) }
        };
        let bodies = [
            eventful(dynamic(shape(random, sizes[0]), vec2(0, 0))),
            dynamic(shape(random, sizes[1]), point(sizes[0] + sizes[1] - depth, 0.0)),
        ];
        let (mut world, ids) = build(floating(), bodies);
        let mut touches = Touches::default();
        touches.step(&mut world);
        let first = (touches.begins, touches.ends);
        tried += 1;
        let mut wrong = first != (1, 0);
        for _ in 0..60 {
            let bytes = world.snapshot().to_bytes();
            let mut restored = Snapshot::from_bytes(&bytes, &[]).expect("a snapshot").into_world();
            touches.step(&mut world);
            wrong |= restored.step().events().ne(world.last_report().events());
            wrong |= restored.state_hash() != world.state_hash();
            let gap = position(&world, ids[1])[0] - position(&world, ids[0])[0] - sizes[0] - sizes[1];
            wrong |= gap < -0.006 && touches.touching.is_empty();
        }
        wrong |= touches.begins > 1;
        if wrong {
            failures.push(format!(
                "seed {seed}: {depth:.3} m deep: {first:?} in the first step, then {} begins and {} ends",
                touches.begins, touches.ends
            ));
        }
    }
    conclude(tried, &failures);
}

#[test]
fn bodies_in_each_other_touch_when_their_filters_begin_to_agree() {
    let first = eventful(dynamic(disc(fx!(0.5)), vec2(0, 0)));
    let mut second = dynamic(disc(fx!(0.5)), vec2(fx!(0.6), 0));
    second.colliders[0].filter = Filter { mask: 2, ..Filter::default() };
    let (mut world, ids) = build(floating(), [first, second.clone()]);
    let mut touches = Touches::default();
    (0..5).for_each(|_| touches.step(&mut world));
    assert_eq!(touches.begins, 0);
    let collider = world.colliders_of(ids[1]).expect("a body").next().expect("a collider");
    let agreeing = ColliderDef { filter: Filter::default(), ..second.colliders[0].clone() };
    world.set_collider(collider, agreeing).expect("a collider");
    touches.step(&mut world);
    assert_eq!((touches.begins, touches.ends), (1, 0));
    assert_eq!(world.contacts().count(), 1);
}

/// A ball bounces: each touch has a begin and an end, also where both are in one step.
#[test]
fn each_bounce_begins_and_ends_once() {
    for (speed, ticks) in [(2, 600), (7, 600), (50, 300)] {
        let mut bodies: Vec<BodyDef> = room(2);
        bodies
            .push(eventful(BodyDef { velocity: point(f64::from(speed), 0.0), ..dynamic(disc(fx!(0.25)), vec2(0, 0)) }));
        let bodies = bodies.into_iter().map(|body| of_material(body, fx!(0), fx!(1)));
        let (mut world, _) = build(bouncing(floating()), bodies);
        let mut touches = Touches::default();
        (0..ticks).for_each(|_| touches.step(&mut world));
        // 3.5 m from one wall to the other.
        let way = f64::from(speed) * f64::from(ticks) / 60.0;
        let bounces = ((way + 1.75) / 3.5).floor() as usize;
        assert!(touches.begins.abs_diff(bounces) <= 1, "{speed} m/s: {} begins in {bounces}", touches.begins);
        assert!(touches.begins - touches.ends <= 1, "{speed} m/s: {} ends of {}", touches.ends, touches.begins);
    }
}

/// The first hit of a world in so many ticks.
fn first_hit(world: &mut World, ticks: u32) -> Option<ContactHit> {
    (0..ticks).find_map(|_| world.step().hits.first().copied())
}

/// The impulse and the speed that a hit should have, N·s and m/s.
struct Expected {
    impulse: f64,
    speed: f64,
    /// The impulse of the body's weight in a sub-step.
    weight: f64,
}

impl Expected {
    fn new(mass: f64, speed: f64, restitution: f64) -> Self {
        Self { impulse: mass * speed * (1.0 + restitution), speed, weight: mass * 10.0 / 300.0 }
    }

    /// Compares with 2 %, and below 2 m/s with what the weight adds in a sub-step.
    fn compare(&self, [impulse, speed]: [f64; 2]) -> Result<(), String> {
        let [weight, gravity] = if self.speed < 2.0 { [self.weight, 10.0 / 300.0] } else { [0.0; 2] };
        let is_impulse = (impulse - self.impulse).abs() <= 0.02 * self.impulse + weight;
        let is_speed = (speed - self.speed).abs() <= 0.02 * self.speed + gravity;
        if is_impulse && is_speed {
            return Ok(());
        }
        Err(format!("{impulse:.4} N·s at {speed:.4} m/s, for {:.4} at {:.4}", self.impulse, self.speed))
    }

    fn compare_hit(&self, hit: Option<ContactHit>) -> Result<(), String> {
        let hit = hit.ok_or("no hit")?;
        self.compare([float(hit.normal_impulse), float(hit.approach_speed)])
    }
}

/// The measure can fail: by the mass, by the speed, by a share of the weight.
#[test]
fn an_impulse_or_a_speed_that_is_off_is_seen() {
    let expected = Expected::new(1.0, 5.0, 0.5);
    assert_eq!(expected.compare([7.5, 5.0]), Ok(()));
    assert!(expected.compare([7.7, 5.0]).is_err() && expected.compare([7.5, 4.89]).is_err());
    assert_eq!(Expected::new(1.0, 1.5, 0.0).compare([1.53, 1.48]), Ok(()));
    assert!(Expected::new(1.0, 1.5, 0.0).compare([1.6, 1.5]).is_err());
}

#[test]
fn a_box_that_lands_reports_its_momentum_at_any_moment_of_the_step() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for restitution in [0.0, 0.5] {
        for shape in [rectangle(fx!(1), fx!(1)), disc(fx!(0.5)), Shape::capsule(fx!(1), fx!(0.5)).expect("a capsule")] {
            for phase in 0..60 {
                // From 0.08 m to 2 m.
                let drop = 0.08 + 0.0325 * f64::from(phase);
                let body = BodyDef {
                    mass: Mass::Kilograms(fx!(1)),
                    ..of_material(dynamic(shape.clone(), point(0.0, 0.5 + drop)), fx!(0.6), number(restitution))
                };
                let (mut world, _) = build(falling(), [eventful(floor()), body]);
                let hit = first_hit(&mut world, 60);
                tried += 1;
                let name =
                    format!("{} corners, drop {drop:.3} m, e {restitution}", shape.outlines()[0].corners().len());
                if let Err(wrong) = Expected::new(1.0, (20.0 * drop).sqrt(), restitution).compare_hit(hit) {
                    failures.push(format!("{name}: {wrong}"));
                }
            }
        }
    }
    conclude(tried, &failures);
}

/// Below the speed of impacts hits are solved with what carries: their speed is that of the touch, and their impulse is
/// whole unless the body arrives in the first sub-step, where the step before has a part of it.
#[test]
fn slow_hits_have_their_speed_and_their_impulse() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    let mut def = falling();
    def.contacts.hit_speed = fx!(0);
    for phase in 0..80 {
        // From 0.2 to 0.97 m/s.
        let drop = 0.002 + 0.00056 * f64::from(phase);
        let body = BodyDef {
            mass: Mass::Kilograms(fx!(1)),
            ..of_material(dynamic(rectangle(fx!(1), fx!(1)), point(0.0, 0.5 + drop)), fx!(0.6), fx!(0))
        };
        let (mut world, _) = build(def, [eventful(floor()), body]);
        let hit = first_hit(&mut world, 60).expect("a hit");
        tried += 1;
        let expected = Expected::new(1.0, (20.0 * drop).sqrt(), 0.0);
        let arrives_at = (drop / 5.0).sqrt() * 300.0 % 5.0;
        let impulse = if (1.1..4.9).contains(&arrives_at) { float(hit.normal_impulse) } else { expected.impulse };
        if let Err(wrong) = expected.compare([impulse, float(hit.approach_speed)]) {
            failures.push(format!("drop {drop:.4} m, in sub-step {arrives_at:.2}: {wrong}"));
        }
    }
    conclude(tried, &failures);
}

/// A hit between two bodies has the impulse of both masses; one that stands on the floor and hits a wall has no share of its weight.
#[test]
fn random_hits_have_the_impulse_of_their_masses() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(40) {
        let random = &mut random("hits", seed);
        let restitution = [0.0, 0.3, 0.8, 1.0][random.below(4) as usize];
        let speed = of_any_size(random, 1.1, 60.0);
        let masses = [(); 2].map(|()| of_any_size(random, 0.1, 20.0));
        let is_on_floor = random.below(2) == 0;
        let has_wall = random.below(2) == 0;
        let start = -0.6 - speed * between(random, 0.02, 0.3);
        let shape = || rectangle(fx!(0.5), fx!(0.5));
        let body = |place: Vec2, mass: f64| BodyDef { mass: Mass::Kilograms(number(mass)), ..dynamic(shape(), place) };
        let moving = BodyDef { velocity: point(speed, 0.0), ..body(point(start, 0.25), masses[0]) };
        let target = if has_wall { fixed(shape(), point(0.0, 0.25)) } else { body(point(0.0, 0.25), masses[1]) };
        let mut bodies = vec![eventful(moving), target];
        if is_on_floor {
            bodies.push(floor());
        }
        let bodies = bodies.into_iter().map(|body| of_material(body, fx!(0), number(restitution)));
        let def = if is_on_floor { falling() } else { floating() };
        let (mut world, _) = build(def, bodies);
        let reduced = if has_wall { masses[0] } else { masses[0] * masses[1] / (masses[0] + masses[1]) };
        let hit = first_hit(&mut world, 60);
        tried += 1;
        if let Err(wrong) = Expected::new(reduced, speed, restitution).compare_hit(hit) {
            failures.push(format!("seed {seed}: wall {has_wall}, floor {is_on_floor}, e {restitution}: {wrong}"));
        }
    }
    conclude(tried, &failures);
}

/// A box that lands on another one that stands on the floor: its hit is its own momentum, shared with the box that it lands on.
#[test]
fn a_hit_on_a_stack_has_no_share_of_its_weight() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for phase in 0..60 {
        let drop = 0.5 + 0.02 * f64::from(phase);
        let square = || dynamic(rectangle(fx!(1), fx!(1)), vec2(0, fx!(0.5)));
        let (mut world, _) = build(falling(), [floor(), square()]);
        steps(&mut world, 30);
        let body = BodyDef { position: point(0.0, 1.5 + drop), ..square() };
        world.add_body(eventful(body)).expect("a body");
        let hit = first_hit(&mut world, 60);
        tried += 1;
        // The box below stands: all of the momentum goes to the floor. It has sunk by up to a few millimetres.
        if let Err(wrong) = Expected::new(1.0, (20.0 * drop).sqrt(), 0.0).compare_hit(hit) {
            failures.push(format!("drop {drop:.3} m: {wrong}"));
        }
    }
    conclude(tried, &failures);
}

/// Discs in a room, all with events: who overlaps is touching, and who is far apart is not.
#[test]
fn random_discs_touch_while_they_overlap() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(4) {
        let random = &mut random("touches", seed);
        let restitution = number(between(random, 0.0, 1.0));
        let mut bodies = room(3);
        let count = 20;
        let radii: Vec<f64> = (0..count).map(|_| between(random, 0.15, 0.45)).collect();
        for (i, &radius) in radii.iter().enumerate() {
            let place = vec2(i as i32 % 5 - 2, i as i32 / 5 - 2);
            let velocity = point(between(random, -8.0, 8.0), between(random, -8.0, 8.0));
            bodies.push(eventful(BodyDef { velocity, ..dynamic(disc(number(radius)), place) }));
        }
        let bodies = bodies.into_iter().map(|body| of_material(body, fx!(0.3), restitution));
        let (mut world, ids) = build(falling(), bodies);
        let discs: Vec<BodyId> = ids[4..].to_vec();
        let colliders: Vec<ColliderId> =
            discs.iter().map(|&id| world.colliders_of(id).expect("a body").next().expect("a collider")).collect();
        let mut touches = Touches::default();
        let mut gaps = vec![0.0; count * count];
        tried += 1;
        'run: for tick in 0..120 {
            let before = touches.touching.clone();
            touches.step(&mut world);
            for i in 0..count {
                for j in i + 1..count {
                    let [a, b] = [discs[i], discs[j]].map(|id| position(&world, id));
                    let gap = length([a[0] - b[0], a[1] - b[1]]) - radii[i] - radii[j];
                    let pair = [colliders[i], colliders[j]];
                    let is_touching =
                        touches.touching.contains(&pair) || touches.touching.contains(&[pair[1], pair[0]]);
                    let was_apart = std::mem::replace(&mut gaps[i * count + j], gap) > 0.1;
                    // What bounced in the step has begun in it, and ends in the next one.
                    let has_stayed = is_touching && before.contains(&pair) | before.contains(&[pair[1], pair[0]]);
                    if gap < -0.012 && !is_touching || gap > 0.1 && was_apart && has_stayed {
                        failures.push(format!("seed {seed}: tick {tick}, gap {gap:.4} m, touching {is_touching}"));
                        break 'run;
                    }
                }
            }
        }
    }
    conclude(tried, &failures);
}
