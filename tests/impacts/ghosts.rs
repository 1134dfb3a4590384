//! Bodies whose paths never meet exchange nothing, to the bit.

use umbra_physics::{BodyDef, ColliderDef, Fx, Shape, Vec2, WorldDef, fx, vec2};

use crate::impacts::flights::{Flight, least_distance, length, random_angle, random_shape, random_speed};
use crate::impacts::scenes::{
    between, build, conclude, conclude_but, disc, dynamic, falling, first_exchange, fixed, float, floating, kinematic,
    motion, number, of_any_size, point, position, random, rectangle, seeds, steps, velocity,
};
use crate::seeds::times;

/// A corner to pass: at the origin, the body below and to the left of it.
fn corners() -> Vec<(&'static str, BodyDef)> {
    let block = rectangle(fx!(4), fx!(2));
    let chain = Shape::chain(&[vec2(0, -2), vec2(0, 0), vec2(-4, 0)], false).expect("a chain");
    let wedge = Shape::polygon(&[vec2(-4, -2), vec2(0, 0), vec2(-4, 0)]).expect("a wedge");
    let shift = wedge.shift();
    vec![
        ("a static box", fixed(block.clone(), vec2(-2, -1))),
        ("a dynamic box", dynamic(block.clone(), vec2(-2, -1))),
        ("a bullet", BodyDef { bullet: true, ..dynamic(block, vec2(-2, -1)) }),
        ("a chain", fixed(chain, vec2(0, 0))),
        ("a static wedge", fixed(wedge, shift)),
    ]
}

/// Shapes to shoot, and how far their outlines reach.
fn missiles() -> Vec<(Shape, Fx)> {
    vec![
        (disc(fx!(0.05)), fx!(0.05)),
        (disc(fx!(0.16)), fx!(0.16)),
        (rectangle(fx!(0.3), fx!(0.4)), fx!(0.25)),
        (Shape::segment(vec2(fx!(-0.2), 0), vec2(fx!(0.2), 0)).expect("a rod"), fx!(0.2)),
    ]
}

#[test]
fn a_shot_that_passes_a_corner_flies_on() {
    let mut failures = Vec::new();
    let mut tried = 0;
    for (obstacle, body) in corners() {
        for (shape, reach) in missiles() {
            for gap in [fx!(1), fx!(0.5), fx!(0.05), fx!(0.01)] {
                for (speed, height) in [(300, fx!(12.6)), (100, fx!(10.6)), (20, fx!(3)), (5, fx!(0.9))] {
                    for (bullet, spin) in [(false, 0), (true, 0), (false, 20), (true, -20)] {
                        let shot = BodyDef {
                            velocity: vec2(0, -speed),
                            angular_velocity: spin.into(),
                            bullet,
                            ..dynamic(shape.clone(), vec2(reach + gap, height))
                        };
                        tried += 1;
                        if let Some(exchange) = first_exchange(floating(), &[body.clone(), shot], 30) {
                            failures.push(format!(
                                "{obstacle}, reach {reach}, gap {gap}, {speed} m/s, {bullet}, {spin} rad/s: {exchange:?}"
                            ));
                        }
                    }
                }
            }
        }
    }
    conclude(tried, &failures);
}

#[test]
fn a_crate_that_falls_past_a_ledge_stays_upright() {
    let ledge = fixed(rectangle(fx!(4), fx!(2)), vec2(-2, -1));
    let bodies = [ledge, dynamic(rectangle(fx!(1), fx!(1)), vec2(fx!(0.55), fx!(4.5)))];
    assert_eq!(first_exchange(falling(), &bodies, 90), None);
    let (mut world, ids) = build(falling(), bodies);
    steps(&mut world, 90);
    let [x, y] = position(&world, ids[1]);
    assert!((x - 0.55).abs() < 1e-9 && (y + 6.75).abs() < 1e-7, "{x} {y}");
}

#[test]
fn a_box_falls_through_a_hatch() {
    let edge = rectangle(fx!(6), fx!(1));
    let bodies = [
        fixed(edge.clone(), vec2(fx!(-3.55), fx!(-0.5))),
        fixed(edge, vec2(fx!(3.55), fx!(-0.5))),
        dynamic(rectangle(fx!(1), fx!(1)), vec2(0, fx!(3.5))),
    ];
    assert_eq!(first_exchange(falling(), &bodies, 90), None);
    let (mut world, ids) = build(falling(), bodies);
    steps(&mut world, 90);
    assert!((velocity(&world, ids[2])[1] + 15.0).abs() < 1e-7);
}

/// From 1 mm on each side at 5 m/s to 10 cm at 200 m/s.
#[test]
fn a_box_flies_through_a_gate() {
    for gap in [fx!(0.002), fx!(0.01), fx!(0.05), fx!(0.1)] {
        for (speed, height) in [(5, fx!(0.25)), (40, fx!(1)), (200, fx!(0.5))] {
            let post = rectangle(fx!(0.2), fx!(4));
            let offset = fx!(2) + height / 2 + gap;
            let bodies = [
                fixed(post.clone(), vec2(0, offset)),
                fixed(post, vec2(0, -offset)),
                BodyDef { velocity: vec2(speed, 0), ..dynamic(rectangle(fx!(0.5), height), vec2(-3, 0)) },
            ];
            assert_eq!(first_exchange(floating(), &bodies, 60), None, "gap {gap}, {speed} m/s");
        }
    }
}

#[test]
fn a_box_that_flies_past_a_sleeper_leaves_it_asleep() {
    let square = rectangle(fx!(1), fx!(1));
    for (gap, speed) in [(fx!(0.1), 20), (fx!(0.01), 5), (fx!(0.5), 100), (fx!(0.03), 300)] {
        for bullet in [false, true] {
            let start = fx!(-2) - Fx::from_ratio(speed, 2);
            let flier = BodyDef {
                velocity: Vec2::new(number(speed as f64), fx!(0)),
                bullet,
                ..dynamic(square.clone(), vec2(start, fx!(1) + gap))
            };
            let def = WorldDef { sleep_after: Some(10), ..floating() };
            let (mut world, ids) = build(def, [dynamic(square.clone(), vec2(0, 0)), flier]);
            steps(&mut world, 20);
            let [before, after] = [0, 60].map(|ticks| {
                for _ in 0..ticks {
                    assert!(world.step().woke.is_empty(), "gap {gap}, {speed} m/s");
                }
                motion(&world, ids[0])
            });
            assert_eq!(before, after);
            assert_eq!(velocity(&world, ids[1]), [speed as f64, 0.0]);
        }
    }
}

/// A bar at rest that crosses the line of a chain beyond the chain's end, 0.36 m and more away from it.
#[test]
fn a_bar_beside_the_end_of_a_chain_stays_at_rest() {
    let shapes = [
        Shape::segment(vec2(-3, 0), vec2(3, 0)).expect("a rod"),
        rectangle(fx!(6), fx!(0.1)),
        Shape::capsule(fx!(6), fx!(0.05)).expect("a capsule"),
    ];
    let mut failures = Vec::new();
    for shape in shapes {
        for end in [-1, 1] {
            for lean in [fx!(-0.8), fx!(0.8), fx!(-1.5), fx!(2.2)] {
                for place in [fx!(1.5), fx!(2.5)] {
                    let chain = Shape::chain(&[vec2(1, 0), vec2(0, 0), vec2(-1, 0)], false).expect("a chain");
                    let bar = BodyDef { angle: lean, ..dynamic(shape.clone(), vec2(place * end, 0)) };
                    if let Some((tick, _)) = first_exchange(floating(), &[fixed(chain, vec2(0, 0)), bar], 10) {
                        let corners = shape.outlines()[0].corners().len();
                        failures
                            .push(format!("{corners} corners, {lean:.1} rad, at {:.1} m: tick {tick}", place * end));
                    }
                }
            }
        }
    }
    conclude(48, &failures);
}

/// Pairs of random shapes at random places, at any speed and spin, that come close and do not touch: each body moves as it does alone.
#[test]
fn random_bodies_that_pass_each_other_exchange_nothing() {
    let (mut failures, mut tried, mut close) = (Vec::new(), 0, 0);
    for seed in seeds(800) {
        let (def, bodies) = passing(seed);
        let [a, b] = [0, 1].map(|i| Flight::new(&bodies[i], def.gravity));
        let Some(gap) = least_distance([&a, &b], 0.75, 0.001) else { continue };
        tried += 1;
        close += usize::from(gap < 0.1);
        if let Some((tick, body)) = first_exchange(def, &bodies, 45) {
            let speed = length([float(bodies[1].velocity.x), float(bodies[1].velocity.y)]);
            let [first, second] = [0, 1].map(|i| (bodies[i].kind, bodies[i].bullet));
            failures.push(format!(
                "seed {seed}: gap {gap:.4} m, {speed:.2} m/s, tick {tick}, body {body}, {first:?} {second:?}"
            ));
        }
    }
    assert!(tried > times(100) && close > times(30), "{close} close of {tried}");
    // Lines that pass beside the ends of chains: the path of one ends early, as a line meets all of a chain on one side.
    conclude_but(&[1616, 4075, 6254, 7732], tried, &failures);
}

/// A body that flies past another one, or meets it.
fn passing(seed: u64) -> (WorldDef, [BodyDef; 2]) {
    let random = &mut random("passing", seed);
    let sizes = [(); 2].map(|()| of_any_size(random, 0.05, 2.0));
    let speed = of_any_size(random, 0.02, 300.0);
    // The obstacle is at rest, at times asleep, or moves as well.
    let shape = random_shape(random, sizes[0]);
    let obstacle = match random.below(8) {
        0 | 1 => fixed(shape, Vec2::ZERO),
        2 | 7 => fixed(random_chain(random, sizes[0]), Vec2::ZERO),
        3 => BodyDef { angular_velocity: number(random_speed(random, 0.1, 20.0)), ..kinematic(shape, Vec2::ZERO) },
        4 | 5 => dynamic(shape, Vec2::ZERO),
        _ => BodyDef {
            angular_velocity: number(random_speed(random, 0.1, 20.0)),
            bullet: random.below(2) == 0,
            ..dynamic(shape, Vec2::ZERO)
        },
    };
    let obstacle = BodyDef { angle: random_angle(random), ..obstacle };
    let missile = random_shape(random, sizes[1]);
    let way = between(random, 0.0, std::f64::consts::TAU);
    let (sin, cos) = way.sin_cos();
    let aside = between(random, -1.1, 1.1) * (sizes[0] + sizes[1]);
    // It passes the middle at a random moment.
    let moment = between(random, 0.2, 0.6);
    let along = -speed * moment;
    let missile = BodyDef {
        position: point(along * cos - aside * sin, along * sin + aside * cos),
        velocity: point(speed * cos, speed * sin),
        angle: random_angle(random),
        angular_velocity: number(random_speed(random, 0.01, 40.0)),
        bullet: random.below(3) == 0,
        ..dynamic(missile, Vec2::ZERO)
    };
    let def = match random.below(3) {
        0 => floating(),
        1 => falling(),
        _ => WorldDef { sleep_after: Some(5), ..floating() },
    };
    let missile = BodyDef { colliders: missile.colliders.into_iter().map(slippery).collect(), ..missile };
    (def, [obstacle, missile])
}

fn slippery(mut collider: ColliderDef) -> ColliderDef {
    collider.material.friction = Fx::ZERO;
    collider
}

/// A chain of 3 to 6 points from left to right.
fn random_chain(random: &mut umbra_physics::Random, size: f64) -> Shape {
    let count = random.integer(3..=6);
    let points: Vec<Vec2> = (0..count)
        .map(|i| {
            let x = size * (1.0 - 2.0 * i as f64 / (count - 1) as f64);
            point(x, between(random, -0.4, 0.4) * size)
        })
        .collect();
    Shape::chain(&points, false).expect("a chain")
}
