//! Sliders, wheels and lines against closed forms.

use alloc::vec::Vec;
use core::f64::consts::PI;

use super::world::{Body, RATE, World, crossings, fx, period};
use crate::solve::joint::{Axis, AxisSpring};

fn motor(speed: f64, force: f64) -> Axis {
    Axis { motor_speed: fx(speed), motor_force: fx(force), ..Axis::default() }
}

fn limits(lower: f64, upper: f64) -> Axis {
    Axis { limits: Some([fx(lower), fx(upper)]), ..Axis::default() }
}

fn spring(frequency: f64, damping_ratio: f64, rest: f64) -> Axis {
    let spring =
        AxisSpring { frequency: fx(frequency), damping_ratio: fx(damping_ratio), rest: fx(rest), max_force: fx(1e9) };
    Axis { spring: Some(spring), ..Axis::default() }
}

/// s
const SUBSTEP: f64 = 1.0 / 300.0;

/// A body of 2 kg and 1 kg·m².
fn block(at: [f64; 2]) -> Body {
    Body { at, mass: 2.0, inertia: 1.0, radius: 1.0, ..Body::fixed() }
}

/// A body on a fixed axis at an angle, which does not turn against it.
fn prismatic(angle: f64, gravity: f64) -> World {
    let mut world = World::new(&[Body::fixed(), block([0.3, -0.2])], gravity);
    world.slider(0, 1, [0.0, 0.0], angle);
    world.set_axis(limits(0.0, 0.0));
    world
}

/// A body on a slope falls with g·sin of the angle, and stays on its axis and at its angle.
#[test]
fn a_slider_falls_along_its_axis() {
    for angle in [-0.5, 0.0, 1.0, PI / 2.0, 2.5] {
        let mut world = prismatic(angle, 10.0);
        for step in 1..=180 {
            world.step();
            let time = f64::from(step) / f64::from(RATE);
            let [along, across] = world.offset(&world.links[0]);
            // The way of a sub-step is of the velocity at its end, where the axis presses.
            let way = if f64::cos(angle).abs() < 1e-9 { time } else { time + SUBSTEP };
            let wanted = -5.0 * f64::sin(angle) * time * way;
            assert!((along - wanted).abs() < 1e-4 * (1.0 + wanted.abs()), "{angle}, {step}: {along} of {wanted}");
            assert!(
                across.abs() < 1e-5 && world.angle(0).abs() < 1e-5,
                "{angle}, {step}: {across}, {}",
                world.angle(0)
            );
        }
        assert_eq!(world.cut, 0);
    }
}

/// A motor speeds a slider up by its force over the mass, and keeps its speed; friction takes it away again.
#[test]
fn a_motor_drives_a_slider() {
    for speed in [3.0, -3.0] {
        let mut world = prismatic(0.7, 0.0);
        world.set_slide(motor(speed, 4.0));
        for step in 1..=180 {
            world.step();
            let time = f64::from(step) / f64::from(RATE);
            let [vx, vy] = world.bodies[1].velocity;
            let along = vx * f64::cos(0.7) + vy * f64::sin(0.7);
            let wanted = f64::min(2.0 * time, 3.0) * f64::signum(speed);
            assert!((along - wanted).abs() < 1e-5, "{step}: {along} of {wanted}");
        }
        world.set_slide(Axis { friction: fx(1.0), ..Axis::default() });
        world.run(3.0);
        let [vx, vy] = world.bodies[1].velocity;
        assert!((vx.hypot(vy) - 1.5).abs() < 1e-4);
        world.run(4.0);
        assert!(world.largest_speed() < 1e-5, "{}", world.largest_speed());
    }
}

/// A load that falls against a limit rests on it, and its joint bears it; so below and above, and at a speed of 50 m/s.
#[test]
fn limits_hold_a_slider() {
    for (angle, speed) in [(PI / 2.0, 0.0), (-PI / 2.0, 0.0), (-PI / 2.0, 50.0)] {
        let mut world = prismatic(angle, 10.0);
        world.bodies[1].velocity = [0.0, -speed];
        world.set_slide(limits(-0.5, 0.5));
        for step in 0..300 {
            world.step();
            let [along, across] = world.offset(&world.links[0]);
            assert!(along.abs() < 0.5 + 1e-4 && across.abs() < 1e-4, "{angle}, {speed}, {step}: {along}, {across}");
        }
        assert!((world.offset(&world.links[0])[0].abs() - 0.5).abs() < 1e-5 && world.largest_speed() < 1e-5);
    }
}

/// The period over the wanted one and the damping ratio of an oscillation, from its values at the ends of steps.
fn oscillation(values: &[f64], frequency: f64, ratio: f64) -> [f64; 2] {
    let crossings = crossings(values);
    let peak = |from: usize| {
        let range = crossings[from] as usize..=crossings[from + 1] as usize + 1;
        values[range].iter().map(|value| value.abs()).fold(0.0, f64::max)
    };
    let whole = crossings.len() / 2 * 2 - 4;
    let decay = (peak(0) / peak(whole)).ln() / (PI * whole as f64);
    [period(&crossings) * frequency * f64::sqrt(1.0 - ratio * ratio), decay / f64::sqrt(1.0 + decay * decay)]
}

/// Springs have their frequency and damping: a slider on a fixed axis, of two free bodies whose centres are off their axis, and a line.
#[test]
fn springs_of_distances_have_their_periods() {
    for (frequency, ratio) in [(1.0, 0.0), (0.25, 0.0), (4.0, 0.02), (2.0, 0.05)] {
        let mut two = World::new(&[Body { mass: 0.5, inertia: 0.05, ..block([-0.5, 0.4]) }, block([0.3, -0.2])], 0.0);
        two.slider(0, 1, [0.0, 0.0], 0.3);
        two.set_axis(limits(0.0, 0.0));
        let mut line = World::new(&[block([-0.5, 0.4]), Body { mass: 0.5, ..block([0.3, -0.2]) }], 0.0);
        line.rod(0, 1, [[-0.5, 0.4], [0.3, -0.2]]);
        let worlds = [("fixed", prismatic(0.3, 0.0), 0.01), ("two", two, 0.01), ("line", line, 1.01)];
        for (name, mut world, rest) in worlds {
            world.set_slide(spring(frequency, ratio, rest));
            let count = (12.0 * f64::from(RATE) / frequency) as u32;
            let value = |world: &mut World| {
                world.step();
                world.offset(&world.links[0])[0] - rest
            };
            let values: Vec<f64> = (0..count).map(|_| value(&mut world)).collect();
            let [period, damping] = oscillation(&values, frequency, ratio);
            assert!((period - 1.0).abs() < 2e-4, "{name}, {frequency} Hz, {ratio}: period {period}");
            assert!((damping - ratio).abs() < 5e-4, "{name}, {frequency} Hz, {ratio}: damping {damping}");
        }
    }
}

/// A weight on a rope of 4 m falls freely until the rope is taut, and is held: 100 kg by no more than a millimetre.
#[test]
fn a_rope_holds_what_hangs_on_it() {
    let weight = Body { mass: 100.0, inertia: 10.0, ..block([0.0, -1.0]) };
    let mut world = World::new(&[Body::fixed(), weight], 10.0);
    world.rod(0, 1, [[0.0, 0.0], [0.0, -1.0]]);
    world.set_slide(limits(0.0, 4.0));
    for step in 1..=40 {
        world.step();
        let time = f64::from(step) / f64::from(RATE);
        let fallen = -1.0 - world.bodies[1].at[1];
        assert!((fallen - 5.0 * time * time).abs() < 0.03, "{step}: {fallen}");
    }
    let mut longest: f64 = 0.0;
    for _ in 0..600 {
        world.step();
        longest = longest.max(-world.bodies[1].at[1]);
    }
    assert!(longest < 4.001 && (world.bodies[1].at[1] + 4.0).abs() < 1e-4, "{longest}, {}", world.bodies[1].at[1]);
    // Swung round, it stays within its length.
    world.bodies[1].velocity = [5.0, 0.0];
    for step in 0..600 {
        world.step();
        let [x, y] = world.bodies[1].at;
        assert!(x.hypot(y) < 4.001, "{step}: {}", x.hypot(y));
    }
}

/// A slider between two free bodies keeps their momentum, linear and angular; without springs and motors it gains no energy, also far out.
#[test]
fn sliders_keep_momentum() {
    for out in [1.0, 20.0] {
        let mut world = World::new(&[block([0.0, 0.0]), Body { mass: 0.5, inertia: 0.1, ..block([out, 0.3]) }], 0.0);
        world.slider(0, 1, [0.2, 0.1], 0.1);
        world.set_axis(limits(0.0, 0.0));
        (world.bodies[0].spin, world.bodies[1].velocity) = (1.0, [0.3, -0.2]);
        let momentum = |world: &World| {
            let part = |body: &Body| {
                let ([x, y], [vx, vy]) = (body.at, body.velocity);
                [body.mass * vx, body.mass * vy, body.inertia * body.spin + body.mass * (x * vy - y * vx)]
            };
            let [a, b] = [part(&world.bodies[0]), part(&world.bodies[1])];
            [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
        };
        let start = momentum(&world);
        world.step();
        let energy = world.energy();
        for step in 0..600 {
            world.step();
            let now = momentum(&world);
            let error = (0..3).map(|i| (now[i] - start[i]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-3 * out, "{out}, {step}: {start:?}, {now:?}");
            assert!(world.energy() < energy * 1.001, "{out}, {step}: {} of {energy}", world.energy());
            assert!(world.worst_gap() < 2e-3 * out, "{out}, {step}: {}", world.worst_gap());
        }
    }
}

/// A wheel on a vertical axis of a car: the car hangs on the spring of its wheels as deep as their stiffness says, and is driven by them.
#[test]
fn a_wheel_bears_on_its_spring() {
    // The axle is fixed, and a load of 2 kg hangs on it below.
    let mut world = World::new(&[Body::fixed(), block([0.0, -1.0])], 10.0);
    world.slider(0, 1, [0.0, -1.0], -PI / 2.0);
    world.set_slide(spring(2.0, 0.7, 0.0));
    world.set_axis(motor(5.0, 3.0));
    world.run(10.0);
    let sag = world.offset(&world.links[0])[0];
    let wanted = 10.0 / (4.0 * PI).powi(2);
    assert!((sag / wanted - 1.0).abs() < 1e-4, "{sag} of {wanted}");
    assert!((world.bodies[1].spin - 5.0).abs() < 1e-4 && world.worst_gap() < 1e-5);
}

/// A crank drives a piston, in a ring of four joints: it goes to and fro by twice the crank.
#[test]
fn a_crank_drives_a_piston() {
    let base = Body { mass: 1e3, inertia: 1e3, radius: 2.0, ..Body::fixed() };
    let crank = Body { mass: 0.5, inertia: 0.01, at: [0.25, 0.0], radius: 0.5, ..Body::fixed() };
    let rod = Body { mass: 1.0, inertia: 0.2, at: [1.25, 0.0], radius: 1.0, ..Body::fixed() };
    let piston = Body { mass: 0.5, inertia: 0.05, at: [2.0, 0.0], radius: 0.3, ..Body::fixed() };
    let mut world = World::new(&[base, crank, rod, piston], 0.0);
    world.pin(0, 1, [0.0, 0.0]);
    world.set_axis(motor(3.0, 20.0));
    world.pin(1, 2, [0.5, 0.0]);
    world.pin(2, 3, [2.0, 0.0]);
    world.slider(0, 3, [2.0, 0.0], 0.0);
    world.set_axis(limits(0.0, 0.0));
    world.run(0.5);
    let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
    for step in 0..600 {
        world.step();
        let [along, across] = world.offset(&world.links[3]);
        assert!(across.abs() < 0.01 && world.worst_gap() < 0.02, "{step}: {across}, {}", world.worst_gap());
        (least, most) = (least.min(along), most.max(along));
    }
    assert!((most - least - 1.0).abs() < 0.02, "{least}, {most}");
}
