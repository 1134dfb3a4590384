//! What rolls and turns keeps its energy: it never rises above its start, and loses no more than friction explains.

use umbra_physics::{BodyDef, ColliderDef, Fx, Material, Shape, TimeStep, Vec2, WorldDef, fx, vec2};

use crate::impacts::scenes::{
    allowance, angle, build, conclude, disc, dynamic, energy, falling, fixed, floor, point, position, rectangle,
};

/// A light disc with a heavy one low in it, let go at an angle on a floor. The height of its centre of mass above the middle of the
/// large disc is −0.245455.
fn toy(tilt: f64) -> BodyDef {
    let part =
        |radius, height, density| ColliderDef { position: vec2(0, height), density, ..ColliderDef::new(disc(radius)) };
    let (sin, cos) = tilt.sin_cos();
    BodyDef {
        position: point(0.245455 * sin, 0.5 - 0.245455 * cos),
        angle: crate::impacts::scenes::number(tilt),
        colliders: vec![part(fx!(0.5), fx!(0.245455), fx!(0.2)), part(fx!(0.15), fx!(-0.054545), fx!(10))],
        ..BodyDef::dynamic()
    }
}

/// The greatest angle of the toy in each ten seconds of a minute.
fn swings(tilt: f64, rate: u32, friction: Fx) -> Vec<f64> {
    let def = WorldDef { time_step: TimeStep::hz(rate), ..falling() };
    let mut toy = toy(tilt);
    for collider in &mut toy.colliders {
        collider.material = Material { friction, ..Material::default() };
    }
    let (mut world, ids) = build(def, [floor(), toy]);
    (0..6)
        .map(|_| {
            let mut widest = 0.0f64;
            for _ in 0..10 * rate {
                world.step();
                widest = widest.max(angle(&world, ids[1]).abs());
            }
            widest
        })
        .collect()
}

#[test]
fn a_toy_that_rights_itself_rocks_within_its_start_and_goes_on() {
    let mut failures = Vec::new();
    // The rows of a contact stand still in a step: what that takes is proportional to its length and to the square of the speed.
    for (tilt, rate, friction, least) in [
        (0.3, 60, fx!(0.6), 0.9),
        (0.3, 120, fx!(0.6), 0.95),
        (0.3, 30, fx!(0.6), 0.75),
        (0.3, 60, fx!(0), 0.5),
        (1.0, 60, fx!(0.6), 0.5),
    ] {
        let swings = swings(tilt, rate, friction);
        let widest = swings.iter().copied().fold(0.0, f64::max);
        let last = swings[5];
        if widest > tilt * 1.002 || last < tilt * least {
            failures.push(format!("{tilt} rad, {rate} Hz, μ {friction}: {swings:.4?}"));
        }
    }
    conclude(5, &failures);
}

/// Half a circle of 3 m of so many segments, its lowest point at the origin.
fn half_pipe(segments: u32) -> BodyDef {
    let points: Vec<Vec2> = (0..=segments)
        .map(|i| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(i) / f64::from(segments)).sin_cos();
            point(3.0 * cos, 3.0 - 3.0 * sin)
        })
        .collect();
    fixed(Shape::chain(&points, false).expect("a chain"), vec2(0, 0))
}

#[test]
fn a_ball_in_a_half_pipe_never_rises_above_its_start() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for segments in [30, 60, 120, 240] {
        for rate in [30, 60, 240] {
            for friction in [fx!(0.6), fx!(0)] {
                // On a circle of 2.75 m around (0, 3): at rest beside the pipe.
                let (sin, cos) = 0.62f64.sin_cos();
                let ball = ColliderDef {
                    material: Material { friction, ..Material::default() },
                    ..ColliderDef::new(disc(fx!(0.25)))
                };
                let ball = dynamic(ball, point(2.744 * sin, 3.0 - 2.744 * cos));
                let def = WorldDef { time_step: TimeStep::hz(rate), ..falling() };
                let (mut world, ids) = build(def, [half_pipe(segments), ball]);
                let start = position(&world, ids[1])[1];
                let bound = energy(&world) + allowance(&world);
                let mut highest = [0.0f64; 6];
                let mut gain = 0.0f64;
                for part in &mut highest {
                    for _ in 0..10 * rate {
                        world.step();
                        *part = part.max(position(&world, ids[1])[1]);
                        gain = gain.max(energy(&world) - bound);
                    }
                }
                tried += 1;
                let name = format!("{segments} segments, {rate} Hz, μ {friction}, from {start:.4} m");
                // At 30 Hz, 0.13 m in a step, the row of a contact stands for several segments: a pipe of 240 lifts the ball by 1 %.
                let [slack, surplus] = if rate == 30 { [0.01 * start, 0.005] } else { [0.002, 0.0] };
                if highest.iter().any(|&height| height > start + slack) || gain > surplus {
                    failures.push(format!("{name}: {highest:.4?}, {gain:.4} J more"));
                }
                // The corners of a pipe of 240 segments, 13 mrad each, take next to nothing.
                if segments == 240 && friction == Fx::ZERO && highest[0] < 0.9 * start {
                    failures.push(format!("{name}: lost, {highest:.4?}"));
                }
            }
        }
    }
    conclude(tried, &failures);
}

/// A wheel whose weight is off its centre by 8.6 cm, at 2 m/s: slow enough to stay on the ground. Its energy stays.
#[test]
fn a_wheel_with_its_weight_off_the_centre_keeps_its_energy() {
    let mut failures = Vec::new();
    for (rate, friction) in [(30, fx!(0.9)), (60, fx!(0.9)), (60, fx!(0)), (240, fx!(0.9))] {
        let part = |radius, height, density| ColliderDef {
            position: vec2(0, height),
            density,
            material: Material { friction, ..Material::default() },
            ..ColliderDef::new(disc(radius))
        };
        let wheel = BodyDef {
            position: point(0.0, 0.5 - 0.085714),
            velocity: point(2.0 * (1.0 - 0.085714 / 0.5), 0.0),
            angular_velocity: fx!(-4),
            colliders: vec![part(fx!(0.5), fx!(0.085714), fx!(1)), part(fx!(0.1), fx!(-0.214286), fx!(10))],
            ..BodyDef::dynamic()
        };
        let def = WorldDef { time_step: TimeStep::hz(rate), ..falling() };
        let ground = fixed(rectangle(fx!(2000), fx!(2)), vec2(0, -1));
        let (mut world, _) = build(def, [ground, wheel]);
        let (before, bound) = (energy(&world), energy(&world) + allowance(&world));
        let [mut lowest, mut highest] = [before; 2];
        for _ in 0..30 * rate {
            world.step();
            lowest = lowest.min(energy(&world));
            highest = highest.max(energy(&world));
        }
        if highest > bound || lowest < 0.98 * before {
            failures.push(format!("{rate} Hz, μ {friction}: from {before:.4} J {lowest:.4} to {highest:.4}"));
        }
    }
    conclude(4, &failures);
}
