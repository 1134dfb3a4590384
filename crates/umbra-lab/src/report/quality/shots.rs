//! Rows of many runs: shots at thin walls, a ball over seams.

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Error, Filter, Fx, Mass, Random, Shape, TimeStep, Turn, Vec2, World,
    WorldDef, fx, vec2,
};

use super::rows::{Length, Played, Promise, measure};

/// Half of the inner side of the room, m.
const HALF: Fx = fx!(5);
const SPEED: Fx = fx!(1000);
const AT_ONCE: usize = 100;

/// A closed room of four walls, 1 cm thick: fixed, or one heavy body.
fn room(is_fixed: bool) -> Result<BodyDef, Error> {
    let beside = HALF + fx!(0.005);
    let [upright, flat] = [Shape::rectangle(fx!(0.01), fx!(12))?, Shape::rectangle(fx!(12), fx!(0.01))?];
    let places = [(vec2(beside, 0), &upright), (vec2(-beside, 0), &upright), (vec2(0, beside), &flat)];
    let places = places.into_iter().chain([(vec2(0, -beside), &flat)]);
    let walls = places.map(|(position, shape)| ColliderDef { position, ..ColliderDef::new(shape.clone()) });
    let mass = Mass::Explicit { mass: fx!(100_000), inertia: fx!(1_000_000) };
    let body = if is_fixed { BodyDef::fixed() } else { BodyDef { mass, ..BodyDef::dynamic() } };
    Ok(BodyDef { colliders: walls.collect(), key: 1 << 40, ..body })
}

/// A box of 1 cm or the smallest disc there is, which flies at 1 km/s in any direction. Shots do not touch each other.
fn shot(random: &mut Random, key: u64) -> Result<BodyDef, Error> {
    let shape = if key % 2 == 0 { Shape::circle(fx!(0.0078125))? } else { Shape::rectangle(fx!(0.01), fx!(0.01))? };
    let filter = Filter { group: -1, ..Filter::default() };
    let (sin, cos) = random.angle().sin_cos();
    let mut place = || random.number(fx!(-3)..=fx!(3));
    let position = Vec2::new(place(), place());
    Ok(BodyDef {
        position,
        angle: random.angle().radians(),
        velocity: Vec2::new(cos * SPEED, sin * SPEED),
        bullet: true,
        key,
        ..BodyDef::dynamic().with_collider(ColliderDef { filter, key, ..ColliderDef::new(shape) })
    })
}

/// A room full of shots after four steps, and how many of them are outside.
fn shoot(seed: u64, is_fixed: bool, continuous: bool, substeps: u32) -> Result<(World, usize), Error> {
    let mut def = WorldDef { time_step: TimeStep::hz(60), sleep_after: None, ..WorldDef::default() };
    def.contacts.substeps = substeps;
    let mut world = World::new(def)?;
    let room = world.add_body(room(is_fixed)?)?;
    let mut random = Random::seeded(seed);
    let mut shots: Vec<BodyId> = Vec::new();
    for key in 0..AT_ONCE {
        shots.push(world.add_body(shot(&mut random, key as u64)?)?);
    }
    if !continuous {
        world.do_without_continuous_collision(true, true);
    }
    (0..4).for_each(|_| _ = world.step());
    let out = shots.iter().filter(|shot| is_out(&world, room, **shot)).count();
    Ok((world, out))
}

/// Returns true if a body is beyond the outer side of a wall of the room.
fn is_out(world: &World, room: BodyId, shot: BodyId) -> bool {
    let (Ok(room), Ok(shot)) = (world.body(room), world.body(shot)) else { return true };
    let from = shot.position() - room.position();
    if shot.activity() != Activity::Awake || from.x.abs() > fx!(20) || from.y.abs() > fx!(20) {
        return true;
    }
    let (sin, cos) = Turn::from_radians(-room.angle()).sin_cos();
    [from.x * cos - from.y * sin, from.x * sin + from.y * cos].iter().any(|c| c.abs() > HALF + fx!(0.012))
}

pub(super) fn walls(length: Length) -> Result<Played, Error> {
    let rooms = if length.quick { 10 } else { 100 };
    // Shots that cross fixed walls and walls that move, with continuous collision and, in the second row, without.
    let mut crossed = [[0; 2]; 2];
    let mut last = None;
    for seed in 0..rooms {
        for (i, continuous) in [true, false].into_iter().enumerate() {
            for (j, is_fixed) in [true, false].into_iter().enumerate() {
                let (world, out) = shoot(seed, is_fixed, continuous, length.substeps)?;
                crossed[i][j] += out;
                if continuous && is_fixed {
                    last = Some(world);
                }
            }
        }
    }
    let shots = rooms as usize * AT_ONCE;
    let least = shots as f64 * 0.9;
    let count = |name, about, count: usize, promise| measure(name, about, "shots", count as f64).promised(promise);
    let measures = vec![
        count("crossed_fixed", "across fixed walls", crossed[0][0], Promise::Zero),
        count("crossed_moving", "across walls that move", crossed[0][1], Promise::Zero),
        count("twin_fixed", "fixed walls, without continuous collision", crossed[1][0], Promise::AtLeast(least)),
        count("twin_moving", "walls that move, without it", crossed[1][1], Promise::AtLeast(least)),
    ];
    let world = last.map_or_else(|| World::new(WorldDef::default()), Ok)?;
    Ok(Played { world, measures, length: format!("{shots} shots at each"), view: None, charts: String::new() })
}

/// A flat ground from x = 2,000 m to −2,000 m, made of this number of segments of different lengths.
fn ground(segments: i64) -> Result<Shape, Error> {
    let mut random = Random::seeded(3);
    let mut points = vec![vec2(2_000, 0)];
    for i in 1..segments {
        let x = Fx::from_ratio(2_000 * (segments - 2 * i), segments);
        points.push(Vec2::new(x + random.number(fx!(-0.05)..=fx!(0.05)), Fx::ZERO));
    }
    points.push(vec2(-2_000, 0));
    Shape::chain(&points, false)
}

const BUMP: &str = "largest difference from the twin: position, velocity, spin";

pub(super) fn seams(length: Length) -> Result<Played, Error> {
    let (steps, least) = if length.quick { (720, 1_000) } else { (7_200, 10_000) };
    let start = || -> Result<BodyDef, Error> {
        Ok(BodyDef {
            position: vec2(-1_990, fx!(0.5)),
            velocity: vec2(30, 0),
            angular_velocity: fx!(-60),
            ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?)
        })
    };
    let world = |ground: Shape| -> Result<(World, BodyId), Error> {
        let mut def =
            WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
        def.contacts.substeps = length.substeps;
        let mut world = World::new(def)?;
        world.add_body(BodyDef::fixed().with_collider(ground))?;
        let ball = world.add_body(start()?)?;
        Ok((world, ball))
    };
    let (mut ground_world, ball) = world(ground(12_000)?)?;
    let (mut twin_world, twin_ball) = world(ground(1)?)?;
    let (mut max_difference, mut seams, mut last) = (0, 0, None);
    for _ in 0..steps {
        ground_world.step();
        twin_world.step();
        let (state, twin_state) = (ground_world.body(ball)?, twin_world.body(twin_ball)?);
        let apart = |a: Fx, b: Fx| a.to_bits().abs_diff(b.to_bits());
        let (own_at, other_at) = (state.position(), twin_state.position());
        let differences = [
            apart(own_at.x, other_at.x),
            apart(own_at.y, other_at.y),
            apart(state.velocity().y, twin_state.velocity().y),
            apart(state.velocity().x, twin_state.velocity().x),
            apart(state.angular_velocity(), twin_state.angular_velocity()),
        ];
        max_difference = differences.into_iter().fold(max_difference, u64::max);
        if let Some(contact) = ground_world.contacts().next() {
            let part = contact.parts[0];
            seams += last.map_or(0, |last: u32| part.abs_diff(last));
            last = Some(part);
        }
    }
    let measures = vec![
        measure("bump", BUMP, "m, m/s, rad/s", max_difference as f64 / 4_294_967_296.0).promised(Promise::Zero),
        measure("seams", "seams that it rolled over", "seams", f64::from(seams))
            .promised(Promise::AtLeast(f64::from(least))),
    ];
    let x = ground_world.body(ball).map_or(0.0, |ball| ball.position().x.to_f64());
    let view = Some([(x - 4.0, -0.5), (x + 4.0, 2.0)]);
    Ok(Played { world: ground_world, measures, length: format!("{} s", steps / 60), view, charts: String::new() })
}
