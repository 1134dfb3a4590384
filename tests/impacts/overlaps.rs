//! Pushing out of an overlap is no impact: it has no restitution, and bodies get no more than the push-out's speed.

use umbra_physics::{BodyDef, BodyId, ColliderDef, Fx, Locks, Mass, Part, Shape, TimeStep, World, WorldDef, fx, vec2};

use crate::impacts::flights::{length, random_angle, random_shape};
use crate::impacts::scenes::{
    between, build, conclude, conclude_but, disc, dynamic, energy, falling, fixed, float, floating, floor, number,
    of_any_size, of_material, point, random, rectangle, seeds, spin, steps, velocity,
};

/// Pinned at its centre of mass: it can turn.
fn pinned(body: BodyDef) -> BodyDef {
    BodyDef { locks: Locks { x: true, y: true, ..Locks::NONE }, ..body }
}

/// The greatest speed of a point of the body, m/s, so far from its centre of mass.
fn rim_speed(world: &World, body: BodyId, reach: f64) -> f64 {
    length(velocity(world, body)) + reach * spin(world, body).abs()
}

/// The greatest rim speed over so many ticks, and the rim speed at their end.
fn fastest(world: &mut World, body: BodyId, reach: f64, ticks: u32) -> [f64; 2] {
    let mut fastest = 0.0f64;
    for _ in 0..ticks {
        world.step();
        fastest = fastest.max(rim_speed(world, body, reach));
    }
    [fastest, rim_speed(world, body, reach)]
}

/// A little more than the default of `push_speed`, for what rounding adds.
const PUSH_SPEED: f64 = 3.01;

#[test]
fn a_pinned_wheel_in_the_ground_gets_the_push_speed_at_its_rim_once() {
    for offset in [0.0001, 0.001, 0.01, 0.1] {
        for depth in [0.001, 0.01, 0.1] {
            let wheel = ColliderDef { position: point(offset, 0.0), ..ColliderDef::new(disc(fx!(0.5))) };
            let wheel = pinned(dynamic(wheel, point(0.0, 0.5 - depth)));
            let (mut world, ids) = build(falling(), [floor(), wheel]);
            let [fastest, _] = fastest(&mut world, ids[1], 0.5 + offset, 300);
            assert!(fastest <= PUSH_SPEED, "{offset} m off its pin, {depth} m deep: {fastest} m/s at the rim");
        }
    }
}

#[test]
fn a_pinned_disc_in_a_box_gets_no_more_than_the_push_speed() {
    let block = fixed(rectangle(fx!(1), fx!(1)), vec2(1, 1));
    let disc = ColliderDef { position: vec2(fx!(0.53125), fx!(-0.78125)), ..ColliderDef::new(disc(fx!(0.5))) };
    let (mut world, ids) = build(floating(), [block, pinned(dynamic(disc, vec2(1, 1)))]);
    let [fastest, _] = fastest(&mut world, ids[1], 1.45, 90);
    assert!(fastest <= PUSH_SPEED, "{fastest} m/s at the rim");
}

#[test]
fn a_pinned_box_at_rest_in_another_body_gets_no_more_than_the_push_speed() {
    let triangle = Shape::polygon(&[vec2(-1, 0), vec2(1, 0), vec2(0, 1)]).expect("a triangle");
    for turn in 0..16 {
        let angle = number(0.1 * f64::from(turn));
        for offset in [0.0, 0.003, 0.2] {
            let body = pinned(BodyDef { angle, ..dynamic(rectangle(fx!(1), fx!(0.6)), point(offset, 0.3)) });
            let (mut world, ids) = build(floating(), [fixed(triangle.clone(), vec2(0, 0)), body]);
            let [fastest, _] = fastest(&mut world, ids[1], 0.583, 90);
            assert!(fastest <= PUSH_SPEED, "{angle} rad, {offset} m: {fastest} m/s at the rim");
        }
    }
}

/// A bar that is pinned, its end a few millimetres from the ground; bodies fall on it. The energy is never more than at the start.
#[test]
fn a_pinned_bar_near_the_ground_gains_no_energy() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(12) {
        let random = &mut random("bar", seed);
        let length = between(random, 0.8, 2.0);
        let height = 0.0005 + between(random, 0.0, 0.006);
        let bar = pinned(dynamic(rectangle(fx!(0.1), number(length)), point(0.0, length / 2.0 + height)));
        let mut bodies = vec![floor(), bar];
        for i in 0..6 {
            let place = point(between(random, -1.0, 1.0), length + 1.0 + f64::from(i));
            let shape = if random.below(2) == 0 { disc(fx!(0.3)) } else { rectangle(fx!(0.5), fx!(0.5)) };
            bodies.push(dynamic(ColliderDef { density: fx!(1), ..ColliderDef::new(shape) }, place));
        }
        let (mut world, _) = build(falling(), bodies);
        let before = energy(&world);
        let bound = before + crate::impacts::scenes::allowance(&world);
        tried += 1;
        let mut gain = 0.0f64;
        for _ in 0..240 {
            world.step();
            gain = gain.max(energy(&world) - bound);
        }
        if gain > 0.0 {
            failures.push(format!("seed {seed}: {before:.2} J, and {gain:.3} more"));
        }
    }
    conclude(tried, &failures);
}

/// A body between two static ones, put there, with e = 1.
fn wedged(restitution: Fx) -> (World, BodyId) {
    let part = |shape, x, y, angle, density| Part {
        shape,
        position: point(x, y),
        angle: number(angle),
        density: number(density),
    };
    let capsule = |length, radius| Shape::capsule(number(length), number(radius)).expect("a capsule");
    let compound = Shape::compound(&[
        part(capsule(1.09375, 0.390625), 0.546478, -0.335637, -1.65625, 0.451110),
        part(disc(fx!(1)), -0.59375, 0.21875, -1.990883, 2.951075),
    ])
    .expect("a compound");
    let body =
        ColliderDef { position: point(-0.09375, 0.71875), angle: number(0.967226), ..ColliderDef::new(compound) };
    let bar = || rectangle(fx!(2), fx!(0.25));
    let mut upper = fixed(capsule(0.686138, 0.578125), vec2(1, 0));
    upper.colliders.push(ColliderDef { angle: number(-1.96875), ..ColliderDef::new(bar()) });
    let bodies = [
        fixed(bar(), vec2(0, -2)),
        BodyDef { angle: fx!(3.4), ..dynamic(body, vec2(1, 0)) },
        BodyDef { angle: fx!(-0.5), ..upper },
    ];
    let def = WorldDef { time_step: TimeStep::hz(240), ..floating() };
    let (world, ids) = build(def, bodies.map(|body| of_material(body, fx!(0.6), restitution)));
    (world, ids[1])
}

#[test]
fn a_wedged_body_is_pushed_out_at_the_push_speed() {
    for restitution in [fx!(0), fx!(0.5), fx!(1)] {
        let (mut world, body) = wedged(restitution);
        let [fastest, _] = fastest(&mut world, body, 0.0, 360);
        assert!(fastest <= PUSH_SPEED, "e {restitution}: {fastest} m/s");
    }
}

/// A disc between two surfaces at a small angle: both push, and their speeds do not add up.
#[test]
fn a_disc_between_surfaces_at_a_small_angle_is_pushed_out_at_the_push_speed() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for lean in [0.02, 0.05, 0.1, 0.3, 0.7] {
        for depth in [0.005, 0.02, 0.1] {
            for restitution in [fx!(0), fx!(1)] {
                let wall = |side: f64| {
                    let (sin, cos) = f64::sin_cos(lean * side);
                    // Its inner face is 0.5 m less the depth from the disc's centre.
                    let distance = 1.0 - depth;
                    BodyDef {
                        angle: number(lean * side),
                        ..fixed(rectangle(fx!(20), fx!(1)), point(sin * distance * -side, cos * distance * side))
                    }
                };
                let bodies = [wall(1.0), wall(-1.0), dynamic(disc(fx!(0.5)), vec2(0, 0))];
                let (mut world, ids) = build(floating(), bodies.map(|body| of_material(body, fx!(0), restitution)));
                tried += 1;
                let [fastest, _] = fastest(&mut world, ids[2], 0.0, 120);
                if fastest > PUSH_SPEED {
                    failures.push(format!("{lean} rad, {depth} m deep, e {restitution}: {fastest:.2} m/s"));
                }
            }
        }
    }
    conclude(tried, &failures);
}

/// A disc on the floor, under a larger one that a ceiling overlaps.
#[test]
fn a_disc_that_another_one_wedges_out_leaves_about_as_fast_as_it_is_pushed() {
    for across in [0.05f64, 0.1, 0.2, 0.3, 0.5] {
        for depth in [0.02, 0.05, 0.1] {
            for friction in [fx!(0), fx!(0.6)] {
                for ratio in [fx!(0.25), fx!(1), fx!(4)] {
                    let up = 0.5 + (1.5 * 1.5 - across * across).sqrt();
                    let ceiling = fixed(rectangle(fx!(20), fx!(2)), point(0.0, up + 2.0 - depth));
                    let small = dynamic(disc(fx!(0.5)), point(across, 0.5));
                    let large = dynamic(disc(fx!(1)), point(0.0, up));
                    let [small, large] = [(small, fx!(1)), (large, ratio)]
                        .map(|(body, mass)| BodyDef { mass: Mass::Kilograms(mass), ..body });
                    let bodies = [floor(), ceiling, small, large].map(|body| of_material(body, friction, fx!(0)));
                    let (mut world, ids) = build(floating(), bodies);
                    let [fastest, _] = fastest(&mut world, ids[2], 0.0, 90);
                    assert!(fastest > 0.0, "nothing pushed");
                    let limit = 4.0 / 3.0 * PUSH_SPEED;
                    assert!(fastest < limit, "{across} m, {depth} m, μ {friction}, masses 1:{ratio}: {fastest} m/s");
                }
            }
        }
    }
}

/// Random bodies, some with locks, put into each other at rest: nobody is thrown out faster than pushing allows.
#[test]
fn random_bodies_at_rest_in_each_other_are_pushed_apart_gently() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    // Beyond the first 400 are contacts of which one point has hardly a lever, and friction that pulls tighter than its contact can part.
    for seed in seeds(40).chain([2143, 2384, 3525, 5328]) {
        let random = &mut random("overlaps", seed);
        let restitution = [0.0, 0.5, 1.0][random.below(3) as usize];
        let count = random.integer(2..=4);
        let mut bodies = Vec::new();
        let mut reaches = Vec::new();
        for _ in 0..count {
            let size = of_any_size(random, 0.2, 1.0);
            let place = point(between(random, -0.6, 0.6), between(random, -0.6, 0.6));
            let shape = random_shape(random, size);
            let body = if random.below(3) == 0 { fixed(shape, place) } else { dynamic(shape, place) };
            let locks = if random.below(3) == 0 {
                Locks { x: random.below(2) == 0, y: random.below(2) == 0, rotation: random.below(4) == 0 }
            } else {
                Locks::NONE
            };
            bodies.push(of_material(
                BodyDef { angle: random_angle(random), locks, ..body },
                number(between(random, 0.0, 1.0)),
                number(restitution),
            ));
            reaches.push(size);
        }
        let (mut world, ids) = build(floating(), bodies);
        tried += 1;
        let mut fastest = 0.0f64;
        for _ in 0..120 {
            world.step();
            for (&id, &reach) in ids.iter().zip(&reaches) {
                fastest = fastest.max(rim_speed(&world, id, reach));
            }
        }
        // Each of two bodies may have the speed, and a rim that of its middle and that of its turning; between two bodies that do not give
        // way a body may have no way out, and turns to and fro.
        if fastest > 4.0 * PUSH_SPEED {
            failures.push(format!("seed {seed}: {fastest:.2} m/s, {count} bodies, e {restitution}"));
        }
    }
    // A small wheel on a pin, between a segment and a body that slides on a rail: up to 60 m/s.
    conclude_but(&[1312], tried, &failures);
}

/// What pushes a body out leaves no speed when it is out.
#[test]
fn a_body_that_was_pushed_out_of_the_floor_does_not_jump() {
    for restitution in [fx!(0), fx!(0.5), fx!(1)] {
        for depth in [0.002, 0.01, 0.05, 0.2] {
            for shape in [disc(fx!(0.5)), rectangle(fx!(1), fx!(1))] {
                let body = of_material(dynamic(shape, point(0.0, 0.5 - depth)), fx!(0.6), restitution);
                let (mut world, ids) = build(falling(), [floor(), body]);
                let mut highest = 0.0f64;
                for _ in 0..120 {
                    world.step();
                    highest = highest.max(float(world.body(ids[1]).expect("a body").position().y));
                }
                assert!(highest < 0.51, "e {restitution}, {depth} m deep: up to {highest} m");
                steps(&mut world, 60);
                assert!(rim_speed(&world, ids[1], 0.7) < 0.01, "e {restitution}, {depth} m deep");
            }
        }
    }
}
