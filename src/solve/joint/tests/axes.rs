//! Limits, motors, friction and springs against closed forms.

use core::f64::consts::PI;

use alloc::vec::Vec;

use super::world::{Body, RATE, World, crossings, fx, period};
use crate::fx::Fx;
use crate::solve::joint::{Axis, AxisSpring};

/// A wheel of 2 kg and 1 kg·m² on a fixed axle.
fn wheel() -> World {
    let wheel = Body { mass: 2.0, inertia: 1.0, radius: 1.0, ..Body::fixed() };
    let mut world = World::new(&[Body::fixed(), wheel], 0.0);
    world.pin(0, 1, [0.0, 0.0]);
    world
}

fn motor(speed: f64, force: f64) -> Axis {
    Axis { motor_speed: fx(speed), motor_force: fx(force), ..Axis::default() }
}

fn limits(lower: f64, upper: f64) -> Axis {
    Axis { limits: Some([fx(lower), fx(upper)]), ..Axis::default() }
}

fn spring(frequency: f64, damping_ratio: f64) -> Axis {
    let spring =
        AxisSpring { frequency: fx(frequency), damping_ratio: fx(damping_ratio), rest: Fx::ZERO, max_force: fx(1e9) };
    Axis { spring: Some(spring), ..Axis::default() }
}

/// A motor speeds up by its torque over the moment of inertia, and then keeps its speed.
#[test]
fn a_motor_has_its_torque_until_it_has_its_speed() {
    for (speed, force) in [(5.0, 2.0), (-5.0, 2.0), (100.0, 30.0), (0.5, 1e6), (3.0, 0.01)] {
        let mut world = wheel();
        world.set_axis(motor(speed, force));
        for step in 1..=600 {
            world.step();
            let time = f64::from(step) / f64::from(RATE);
            let wanted = f64::min(force * time, f64::abs(speed)) * f64::signum(speed);
            let spin = world.bodies[1].spin;
            assert!(
                (spin - wanted).abs() < 2e-6 * f64::abs(speed).max(1.0),
                "{speed}, {force}, {step}: {spin}, {wanted}"
            );
        }
        assert_eq!(world.cut, 0);
    }
}

/// Friction takes speed away evenly, and then holds against a motor that is weaker.
#[test]
fn friction_stops_a_wheel_and_holds_it() {
    let mut world = wheel();
    world.bodies[1].spin = 2.0;
    world.set_axis(Axis { friction: fx(0.5), ..motor(7.0, 0.25) });
    for step in 1..=900 {
        world.step();
        let time = f64::from(step) / f64::from(RATE);
        // Forwards the motor helps: 0.25 N·m are left of 0.5.
        let wanted = f64::max(2.0 - 0.25 * time, 0.0);
        assert!((world.bodies[1].spin - wanted).abs() < 1e-5, "{step}: {}", world.bodies[1].spin);
    }
    world.set_axis(Axis { friction: fx(0.5), ..motor(7.0, 0.75) });
    world.run(4.0);
    assert!((world.bodies[1].spin - 1.0).abs() < 1e-5, "{}", world.bodies[1].spin);
}

/// Times and places of the extremes of a row of values, by parabolas through three of them.
fn extremes(values: &[f64]) -> Vec<[f64; 2]> {
    let extreme = |(i, window): (usize, &[f64])| {
        let [before, middle, after] = [window[0], window[1], window[2]];
        let is_extreme = (middle - before) * (after - middle) <= 0.0 && middle != before;
        let bend = before - 2.0 * middle + after;
        let offset = (before - after) / (2.0 * bend);
        is_extreme.then(|| [i as f64 + 1.0 + offset, middle - (before - after).powi(2) / (8.0 * bend)])
    };
    values.windows(3).enumerate().filter_map(extreme).collect()
}

/// A wheel, a body that is pinned outside of its centre, and two bodies that turn against each other.
fn pinned() -> [World; 3] {
    let wheel_body = wheel().bodies[1];
    let mut beside = World::new(&[Body::fixed(), Body { at: [0.75, 0.0], ..wheel_body }], 0.0);
    beside.pin(0, 1, [0.0, 0.0]);
    let small = Body { at: [-0.5, 0.2], mass: 0.5, inertia: 0.05, ..wheel_body };
    let mut two = World::new(&[small, Body { at: [0.3, 0.0], ..wheel_body }], 0.0);
    two.pin(0, 1, [0.0, 0.0]);
    [wheel(), beside, two]
}

/// A spring has its frequency and its damping wherever the body is pinned. Sub-steps are half a sub-step ahead: that is no error of the period.
#[test]
fn a_spring_has_its_period_and_its_decay() {
    for (frequency, ratio) in [(1.0, 0.0), (0.1, 0.0), (4.0, 0.02), (2.0, 0.1), (20.0, 0.01)] {
        for (kind, mut world) in pinned().into_iter().enumerate() {
            let amplitude = 0.005;
            world.set_axis(spring(frequency, ratio));
            world.links[0].axis.as_mut().and_then(|axis| axis.spring.as_mut()).expect("a spring").rest = fx(amplitude);
            // A strongly damped one is soon too small to be seen.
            let periods = if ratio > 0.05 { 3.0 } else { 12.0 };
            let count = (periods * f64::from(RATE) / frequency) as u32;
            let error = |world: &mut World| {
                world.step();
                world.angle(0) - amplitude
            };
            let values: Vec<f64> = (0..count.max(60)).map(|_| error(&mut world)).collect();
            let period = period(&crossings(&values));
            let wanted = 1.0 / (frequency * f64::sqrt(1.0 - ratio * ratio));
            let peaks = extremes(&values);
            let [first, last] = [peaks[0], peaks[peaks.len().min(7) - 1]];
            let decay =
                (first[1] / last[1]).abs().ln() / (last[0] - first[0]) * f64::from(RATE) / (2.0 * PI * frequency);
            let errors = [period / wanted - 1.0, decay - ratio];
            assert!(errors.iter().all(|error| error.abs() < 1.5e-4), "{frequency} Hz, {ratio}, {kind}: {errors:?}");
        }
    }
}

/// Beyond critical damping only the slow decay is left.
#[test]
fn a_spring_creeps_back_as_its_damping_says() {
    for (frequency, ratio) in [(1.0, 1.5), (3.0, 2.0), (2.0, 8.0)] {
        for (kind, mut world) in pinned().into_iter().enumerate() {
            world.set_axis(spring(frequency, ratio));
            world.links[0].axis.as_mut().and_then(|axis| axis.spring.as_mut()).expect("a spring").rest = fx(0.005);
            let slow = 2.0 * PI * frequency * (ratio - f64::sqrt(ratio * ratio - 1.0));
            let span = 0.5 / slow;
            world.run(5.0 * span);
            let before = world.angle(0) - 0.005;
            world.run(span);
            let steps = (span * f64::from(RATE)).round();
            let decay = (before / (world.angle(0) - 0.005)).ln() / steps * f64::from(RATE);
            let error = decay / slow - 1.0;
            assert!(error.abs() < 5e-4, "{frequency} Hz, {ratio}, {kind}: {error}");
        }
    }
}

/// A pendulum swings against a limit, does not bounce, and comes to rest on it.
#[test]
fn a_limit_holds_a_pendulum() {
    for (lower, upper) in [(-1.0, 1.0), (-0.5, 4.0 * PI), (0.0, 0.0)] {
        let mut world = pendulum();
        world.set_axis(limits(lower, upper));
        let start = world.energy();
        let mut lowest = f64::INFINITY;
        for _ in 0..10 * RATE {
            world.step();
            lowest = lowest.min(world.angle(0) - lower);
            assert!(world.energy() < start + 1e-6, "{}", world.energy() - start);
        }
        assert!(lowest > -1e-5 && world.largest_speed() < 1e-4, "{lower}: {lowest}, {}", world.largest_speed());
        assert_eq!(world.cut, 0);
    }
}

/// A motor of 2 rad/s goes on to an upper limit of three turns, and presses against it with its torque.
#[test]
fn a_motor_stops_at_a_limit_of_three_turns() {
    for direction in [1.0, -1.0] {
        let mut world = wheel();
        let bounds = if direction > 0.0 { limits(-1.0, 6.0 * PI) } else { limits(-6.0 * PI, 1.0) };
        world.set_axis(Axis { limits: bounds.limits, ..motor(2.0 * direction, 1e4) });
        world.run(8.0);
        assert!((world.angle(0) - 14.0 * direction * 8.0 / 8.0).abs() < 3.0);
        world.run(4.0);
        assert!((world.angle(0) - 6.0 * PI * direction).abs() < 1e-4, "{}", world.angle(0));
        assert!(world.bodies[1].spin.abs() < 1e-5);
    }
}

/// A body that is thrown at a limit at 50 rad/s stays within it, and gains no energy.
#[test]
fn a_limit_stops_what_is_thrown_at_it() {
    for mass in [1e-4, 1.0, 1e4] {
        let mut world = wheel();
        (world.bodies[1].mass, world.bodies[1].inertia, world.bodies[1].spin) = (mass, mass / 2.0, 50.0);
        world.set_axis(limits(-1.0, 0.5));
        for step in 0..60 {
            world.step();
            assert!(world.angle(0) < 0.5001 && world.bodies[1].spin <= 50.0, "{mass}, {step}: {}", world.angle(0));
        }
        assert!(world.bodies[1].spin.abs() < 50.0 * 1e-4, "{mass}: {}", world.bodies[1].spin);
    }
}

/// A spring gives no more than its largest force: under a load that is heavier by 1 % a lever falls until it has become shorter, as a pendulum
/// that swings to where 1.98·θ = 2·sin θ.
#[test]
fn a_spring_keeps_to_its_largest_force() {
    // The stiffness of 10 Hz and 0.041 kg·m².
    let held = -2.0 / (0.041 * (20.0 * PI).powi(2));
    for (force, wanted) in [(2.02, held), (1.98, -0.2453)] {
        // A weight of 1 kg on a lever of 0.2 m, let go where it would rest.
        let angle = held;
        let weight = Body { mass: 1.0, inertia: 1e-3, radius: 0.5, at: [0.2, 0.0], ..Body::fixed() };
        let mut world = World::new(&[Body::fixed(), weight], 10.0);
        world.pin(0, 1, [0.0, 0.0]);
        world.bodies[1].angle = angle;
        world.bodies[1].at = [0.2 * angle.cos(), 0.2 * angle.sin()];
        let mut axis = spring(10.0, 1.0);
        axis.spring.as_mut().expect("a spring").max_force = fx(force);
        world.set_axis(axis);
        let mut lowest = 0.0;
        for _ in 0..10 * RATE {
            world.step();
            lowest = f64::min(lowest, world.angle(0));
        }
        assert!((lowest - wanted).abs() < 0.03 * wanted.abs(), "{force}: {lowest} of {wanted}");
    }
}

/// A motor between two free bodies turns both, and their angular momentum stays; so with friction, a spring and limits.
#[test]
fn axes_keep_angular_momentum() {
    let all = Axis { friction: fx(0.1), spring: spring(2.0, 0.1).spring, ..limits(-0.7, 0.9) };
    for axis in [motor(3.0, 5.0), all, Axis { motor_speed: fx(4.0), motor_force: fx(1.0), ..all }] {
        let [.., mut world] = pinned();
        world.set_axis(axis);
        (world.bodies[0].spin, world.bodies[1].spin) = (1.5, -0.5);
        let momentum = |world: &World| {
            let body_momentum = |body: &Body| {
                body.inertia * body.spin + body.mass * (body.at[0] * body.velocity[1] - body.at[1] * body.velocity[0])
            };
            world.bodies.iter().map(body_momentum).sum::<f64>()
        };
        world.step();
        let start = momentum(&world);
        world.run(5.0);
        assert!((momentum(&world) - start).abs() < 2e-4, "{}", momentum(&world) - start);
        assert!(world.worst_gap() < 1e-3 && world.angle(0).abs() < 20.0);
    }
}

/// A crank with a motor drives a linkage of four bars, which is a ring: it turns at its speed, and the ring holds.
#[test]
fn a_motor_drives_a_linkage() {
    let bar = |from: [f64; 2], to: [f64; 2]| {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        Body {
            at: [from[0] + way[0] / 2.0, from[1] + way[1] / 2.0],
            angle: way[1].atan2(way[0]),
            mass: length,
            inertia: length.powi(3) / 12.0,
            radius: length,
            ..Body::fixed()
        }
    };
    let corners = [[0.0, 0.0], [0.0, 0.5], [1.5, 1.2], [2.0, 0.0]];
    let base = Body { mass: 1e3, inertia: 1e3, radius: 2.0, at: [1.0, 0.0], ..Body::fixed() };
    let bars = [base, bar(corners[0], corners[1]), bar(corners[1], corners[2]), bar(corners[2], corners[3])];
    let mut world = World::new(&bars, 0.0);
    world.pin(0, 1, corners[0]);
    world.set_axis(motor(6.0, 20.0));
    world.pin(1, 2, corners[1]);
    world.pin(2, 3, corners[2]);
    world.pin(3, 0, corners[3]);
    world.run(1.0);
    for _ in 0..600 {
        world.step();
        let spin = world.bodies[1].spin - world.bodies[0].spin;
        assert!((spin - 6.0).abs() < 0.3 && world.worst_gap() < 0.02, "{spin}, {}", world.worst_gap());
    }
    assert_eq!(world.cut, 0);
}

/// A rod of 1 m on a pin half a metre beyond its end, let go horizontally.
fn pendulum() -> World {
    let mut world = World::new(&[Body::fixed(), Body::rectangle([1.0, 0.0], [0.5, 0.05])], 10.0);
    world.pin(0, 1, [0.0, 0.0]);
    world
}

/// Ten planks of 1 m in a row, welded to each other and to a wall.
fn cantilever(axis: Axis) -> World {
    let mut bodies = alloc::vec![Body::fixed()];
    bodies.extend((0..10).map(|i| Body::rectangle([0.5 + f64::from(i), 0.0], [0.5, 0.1])));
    let mut world = World::new(&bodies, 10.0);
    for i in 0..10 {
        world.pin(i, i + 1, [i as f64, 0.0]);
        world.set_axis(axis);
    }
    world
}

/// The step from which on a world rests, of this number of steps.
fn rest(world: &mut World, steps: usize) -> usize {
    let mut rest = 0;
    for step in 1..=steps {
        world.step();
        if world.largest_speed() >= 0.05 {
            rest = step;
        }
    }
    rest
}

#[test]
fn cantilevers_hold() {
    let mut welded = cantilever(limits(0.0, 0.0));
    let steps = rest(&mut welded, 300);
    let (tip, gap) = (welded.bodies[10].at[1], welded.worst_gap());
    assert!(tip > -0.018 && gap < 1e-4 && steps <= 7, "{tip}, {gap}, {steps}");
    let mut bent = cantilever(limits(-0.05, 0.05));
    let steps = rest(&mut bent, 900);
    // Each plank is 0.05 rad lower than the one before.
    let sin = |i: u32| f64::sin(0.05 * f64::from(i));
    let lowest = -(1..10).map(sin).sum::<f64>() - 0.5 * sin(10);
    let (tip, gap) = (bent.bodies[10].at[1], bent.worst_gap());
    assert!((tip - lowest).abs() < 0.018 && gap < 1e-3 && steps <= 83, "{tip} of {lowest}, {gap}, {steps}");
}
