//! Energy and momentum of many bodies: no impact adds any, and where nothing takes energy, it stays.

use umbra_physics::{BodyDef, Fx, Random, Vec2, World, WorldDef, fx, vec2};

use crate::impacts::flights::{random_angle, random_shape};
use crate::impacts::scenes::{
    allowance, between, bouncing, build, conclude, disc, dynamic, energy, falling, floating, kinetic_energy, momentum,
    number, of_any_size, of_material, point, random, room, seeds, steps,
};

/// Forty discs with e = 1 and no friction in a room of 12 m.
fn elastic_gas(seed: u64) -> World {
    let random = &mut random("gas", seed);
    let mut bodies = room(6);
    for i in 0..10 {
        for j in 0..4 {
            let velocity = point(between(random, -4.0, 4.0), between(random, -4.0, 4.0));
            let place = point(-5.0 + 1.1 * f64::from(i), -4.5 + 3.0 * f64::from(j));
            bodies.push(BodyDef { velocity, ..dynamic(disc(fx!(0.3)), place) });
        }
    }
    build(bouncing(floating()), bodies.into_iter().map(|body| of_material(body, fx!(0), fx!(1)))).0
}

/// How far the energy of a gas is off after so many seconds, as a share of it.
fn drift(seed: u64, seconds: u32) -> f64 {
    let mut world = elastic_gas(seed);
    let before = kinetic_energy(&world);
    steps(&mut world, 60 * seconds);
    kinetic_energy(&world) / before - 1.0
}

#[track_caller]
fn gases_keep_their_energy(count: u64, seconds: u32, bound: f64) {
    let off: Vec<f64> = seeds(count).map(|seed| drift(seed, seconds)).collect();
    let failures: Vec<String> = (0..)
        .zip(&off)
        .filter(|(_, off)| off.abs() > bound)
        .map(|(seed, off)| format!("seed {seed}: {off:+.5}"))
        .collect();
    conclude(off.len(), &failures);
}

#[test]
fn a_gas_of_elastic_discs_keeps_its_energy() {
    gases_keep_their_energy(2, 20, 0.01);
}

#[test]
#[ignore = "40 minutes of the world's time"]
fn a_gas_of_elastic_discs_keeps_its_energy_for_minutes() {
    gases_keep_their_energy(2, 120, 0.05);
}

/// Bodies in the cells of a grid, none of which overlaps another one.
fn mixture(random: &mut Random, count: i32, restitution: f64, friction: f64) -> Vec<BodyDef> {
    let fastest = of_any_size(random, 1.0, 30.0);
    let cells = (count + 5) / 6;
    (0..count)
        .map(|i| {
            let radius = of_any_size(random, 0.1, 0.45);
            let body = BodyDef {
                velocity: point(between(random, -fastest, fastest), between(random, -fastest, fastest)),
                angle: random_angle(random),
                angular_velocity: number(between(random, -20.0, 20.0)),
                bullet: random.below(8) == 0,
                ..dynamic(random_shape(random, radius), vec2(i % 6 - 3, i / 6 - cells / 2) + vec2(fx!(0.5), fx!(0.5)))
            };
            of_material(body, number(friction), number(restitution))
        })
        .collect()
}

/// Shapes of all kinds, with friction, gravity and any restitution, in a room: the energy never exceeds its start.
#[test]
fn random_worlds_gain_no_energy() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(15) {
        let random = &mut random("mixture", seed);
        let restitution = [0.0, 0.3, 0.6, 0.9, 1.0][random.below(5) as usize];
        let friction = [0.0, 0.3, 0.9][random.below(3) as usize];
        let count = random.integer(1..=36) as i32;
        let walls = room(4).into_iter().map(|wall| of_material(wall, number(friction), number(restitution)));
        let bodies: Vec<BodyDef> = walls.chain(mixture(random, count, restitution, friction)).collect();
        let mut def = if random.below(3) == 0 { floating() } else { falling() };
        if random.below(2) == 0 {
            def = WorldDef { sleep_after: Some(30), ..bouncing(def) };
        }
        let (mut world, _) = build(def, bodies);
        let before = energy(&world);
        let bound = before + allowance(&world) + 0.001 * kinetic_energy(&world);
        tried += 1;
        let mut gain = (0.0, 0);
        for tick in 0..240 {
            world.step();
            let over = energy(&world) - bound;
            if over > gain.0 {
                gain = (over, tick);
            }
        }
        if gain.0 > 0.0 {
            failures.push(format!(
                "seed {seed}: {:.3} J more than {before:.3}, tick {}, {count} bodies, e {restitution}, μ {friction}",
                gain.0, gain.1
            ));
        }
    }
    conclude(tried, &failures);
}

/// Without walls and gravity: momentum stays, and energy does not grow.
#[test]
fn random_worlds_keep_their_momentum() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(15) {
        let random = &mut random("momentum", seed);
        let restitution = [0.0, 0.5, 1.0][random.below(3) as usize];
        let friction = [0.0, 0.6][random.below(2) as usize];
        let count = random.integer(2..=30) as i32;
        let mut bodies = mixture(random, count, restitution, friction);
        // They fly to the middle.
        for body in &mut bodies {
            body.velocity -= body.position * fx!(3);
        }
        let (mut world, _) = build(bouncing(floating()), bodies);
        let (before, energy) = (momentum(&world), kinetic_energy(&world));
        let scale = momentum_scale(&world);
        tried += 1;
        for tick in 0..90 {
            world.step();
            let now = momentum(&world);
            let off = (now[0] - before[0]).hypot(now[1] - before[1]);
            let share = kinetic_energy(&world) / energy;
            if off > 1e-6 * scale || share > 1.001 {
                failures.push(format!(
                    "seed {seed}: tick {tick}, momentum off by {off:.6} of {scale:.1} kg·m/s, energy × {share:.4}, {count} bodies, e {restitution}"
                ));
                break;
            }
        }
    }
    conclude(tried, &failures);
}

/// Σ m·|v|, kg·m/s.
fn momentum_scale(world: &World) -> f64 {
    world
        .bodies()
        .map(|body| {
            let [x, y] = crate::impacts::scenes::floats(body.velocity());
            crate::impacts::scenes::float(body.mass().unwrap_or(Fx::ZERO)) * x.hypot(y)
        })
        .sum()
}

/// A break of fifteen balls in a triangle that touch: the energy stays, and the triangle stays symmetric to the bit.
#[test]
fn a_break_of_balls_that_touch_keeps_its_energy() {
    for (restitution, least) in [(fx!(1), 0.9999), (fx!(0.95), 0.85)] {
        let mut places: Vec<Vec2> = vec![point(-3.0, 0.0)];
        for column in 0..5 {
            for i in 0..=column {
                let height = f64::from(2 * i - column) * 0.25;
                places.push(point(f64::from(column) * 0.75f64.sqrt() * 0.5, height));
            }
        }
        let balls = places.iter().enumerate().map(|(i, &place)| {
            let velocity = if i == 0 { vec2(8, 0) } else { Vec2::ZERO };
            of_material(BodyDef { velocity, ..dynamic(disc(fx!(0.25)), place) }, fx!(0), restitution)
        });
        let (mut world, _) = build(bouncing(floating()), balls);
        let before = kinetic_energy(&world);
        for tick in 0..90 {
            world.step();
            let share = kinetic_energy(&world) / before;
            assert!(share >= least && share < 1.0001, "e {restitution}, tick {tick}: energy × {share}");
            assert!(momentum(&world)[1].abs() < 1e-9, "{:?}", momentum(&world));
        }
    }
}
