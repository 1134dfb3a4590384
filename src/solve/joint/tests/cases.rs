//! Pendulums, rods, nets and boxes over many steps.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use super::world::{Body, World};

/// A rod of 1 m on a pin half a metre beyond its end, let go horizontally.
fn pendulum() -> World {
    let mut world = World::new(&[Body::fixed(), Body::rectangle([1.0, 0.0], [0.5, 0.05])], 10.0);
    world.pin(0, 1, [0.0, 0.0]);
    world
}

/// A box at the end of a rod of 1 m, let go horizontally.
fn bob() -> World {
    let mut world = World::new(&[Body::fixed(), Body::rectangle([1.0, 0.0], [0.1, 0.1])], 10.0);
    world.rod(0, 1, [[0.0, 0.0], [1.0, 0.0]]);
    world
}

/// The change of energy of a pendulum in some seconds, as a share of m·g·l, and the largest change on the way.
fn energy_change(mut world: World, seconds: u32) -> (f64, f64) {
    let scale = world.bodies[1].mass * 10.0;
    let initial = world.energy();
    let (mut change, mut largest) = (0.0, 0.0);
    for _ in 0..seconds * super::world::RATE {
        world.step();
        change = (world.energy() - initial) / scale;
        largest = f64::max(largest, change.abs());
        assert!(world.worst_gap() < 3e-4, "{}", world.worst_gap());
    }
    assert_eq!(world.cut, 0);
    (change, largest)
}

/// The period of a pendulum that is let go horizontally, by the arithmetic-geometric mean: 2π·√(I/(m·g·l)) / agm(1, cos 45°), for
/// l = 1 m and I about the pivot.
fn period(body: &Body) -> f64 {
    let (mut a, mut b) = (1.0, (PI / 4.0).cos());
    for _ in 0..5 {
        (a, b) = ((a + b) / 2.0, f64::sqrt(a * b));
    }
    2.0 * PI * ((body.inertia / body.mass + 1.0) / 10.0).sqrt() / a
}

/// The mean period of a pendulum over ten swings, by the times at which it hangs straight down.
fn measured_period(mut world: World) -> f64 {
    let mut times = vec![];
    let mut last_x = world.bodies[1].at[0];
    for tick in 1.. {
        world.step();
        let x = world.bodies[1].at[0];
        if last_x * x <= 0.0 {
            times.push((f64::from(tick) - x / (x - last_x)) / f64::from(super::world::RATE));
        }
        if times.len() == 21 {
            break;
        }
        last_x = x;
    }
    (times[20] - times[0]) / 10.0
}

#[test]
fn a_pendulum_has_the_period_of_its_closed_form() {
    for (world, name) in [(pendulum(), "pin"), (bob(), "rod")] {
        // A box at the end of a rod does not turn: it counts as a point.
        let mut body = world.bodies[1];
        if name == "rod" {
            body.inertia = 0.0;
        }
        let error = measured_period(world) / period(&body) - 1.0;
        assert!(error.abs() < 2e-5, "{name}: {error}");
    }
}

#[test]
fn a_pendulum_keeps_its_energy() {
    let (_, largest) = energy_change(pendulum(), 10);
    assert!(largest < 0.005, "{largest}");
    let (_, largest) = energy_change(bob(), 10);
    assert!(largest < 0.005, "{largest}");
}

#[test]
fn a_pendulum_keeps_its_energy_for_a_thousand_seconds() {
    for (world, max_end, max_change) in [(pendulum(), 0.007, 0.0125), (bob(), 0.0125, 0.02)] {
        let (change, largest) = energy_change(world, 1000);
        assert!(change.abs() < max_end && largest < max_change, "{change} {largest}");
    }
}

/// There is no gravity: arms that did not turn within a step would take 60 % of its energy in a second.
#[test]
fn a_rod_on_a_pin_keeps_spinning() {
    let mut world = pendulum();
    world.gravity = [0.0; 2];
    world.bodies[1].spin = 10.0;
    world.bodies[1].velocity = [0.0, 10.0];
    let initial = world.energy();
    world.run(100.0);
    let kept = world.energy() / initial;
    assert!((0.98..1.001).contains(&kept), "{kept}");
}

/// A box that hangs on a joint and lies on the floor: neither takes more than its part, and nothing moves.
#[test]
fn a_box_on_a_joint_rests_on_the_floor() {
    let ceiling = Body { at: [0.0, 3.0], ..Body::fixed() };
    let on_floor = Body { half: [0.5; 2], ..Body::rectangle([0.0, 0.5], [0.5; 2]) };
    for joint in 0..3 {
        let mut world = World::new(&[Body::fixed(), ceiling, on_floor], 10.0);
        match joint {
            0 => world.rod(1, 2, [[0.0, 3.0], [0.0, 1.0]]),
            1 => world.rod(1, 2, [[0.0, 3.0], [0.4, 1.0]]),
            _ => world.pin(1, 2, [0.3, 1.0]),
        }
        world.run(20.0);
        let [x, y] = world.bodies[2].at;
        let angle = world.bodies[2].angle;
        assert!(world.largest_speed() < 1e-4, "{joint}: {}", world.largest_speed());
        let moved = x.abs().max((y - 0.5).abs()).max(angle.abs());
        assert!(moved < 1e-3, "{joint}: {x} {y} {angle}");
        assert!(world.worst_gap() < 1e-3, "{joint}: {}", world.worst_gap());
        assert_eq!(world.cut, 0);
    }
}

/// A box that two joints hold above another box, which lies on the floor.
#[test]
fn joints_carry_a_box_on_another_one() {
    let on_floor = Body { half: [0.5; 2], ..Body::rectangle([0.0, 0.5], [0.5; 2]) };
    let above = Body::rectangle([0.0, 1.6], [0.5; 2]);
    let mut world = World::new(&[Body::fixed(), on_floor, above], 10.0);
    world.pin(1, 2, [-0.5, 1.05]);
    world.pin(1, 2, [0.5, 1.05]);
    world.run(20.0);
    assert!(world.largest_speed() < 1e-4, "{}", world.largest_speed());
    let sunk = 1.6 - world.bodies[2].at[1];
    assert!((0.0..5e-3).contains(&sunk) && world.worst_gap() < 1e-3, "{sunk} {}", world.worst_gap());
}

/// A chain of rods of 0.5 m, each 1.25 kg, that hangs straight down.
pub(super) fn chain(n: usize, tip: f64) -> World {
    let mut bodies = vec![Body::fixed()];
    for i in 0..n {
        let mut link = Body::rectangle([0.0, -0.25 - 0.5 * i as f64], [0.0625, 0.25]);
        let density = if i + 1 == n { 10.0 * tip } else { 10.0 };
        (link.mass, link.inertia) = (link.mass * density, link.inertia * density);
        bodies.push(link);
    }
    let mut world = World::new(&bodies, 10.0);
    (0..n).for_each(|i| world.pin(i, i + 1, [0.0, -0.5 * i as f64]));
    world
}

/// At rest a joint of a tree gives way by F·k·c·h²/r, for a force F, half the trace k of the inverse mass of both links at their ends, the
/// compliance c, the sub-step h and the part r of an error that is taken away in it.
fn gaps_at_rest(world: &World) -> Vec<f64> {
    let h = 1.0 / f64::from(super::world::RATE * world.options.substeps);
    let mass = |i: usize| world.bodies[i].mass;
    let mobility = |i: usize| 1.0 / mass(i) + 0.25 * 0.25 / world.bodies[i].inertia / 2.0;
    let gap = |i: usize| {
        let below: f64 = (i..world.bodies.len()).map(mass).sum();
        let above = if i > 1 { mobility(i - 1) } else { 0.0 };
        10.0 * below * (above + mobility(i)) * h * h / 2048.0 / 0.3
    };
    (1..world.bodies.len()).map(gap).collect()
}

#[test]
fn chains_stretch_as_their_compliance_says() {
    for (links, tip) in [(60, 1.0), (15, 100.0)] {
        let mut world = chain(links, tip);
        world.run(10.0);
        let (mut expected, mut fallen) = (0.0, 0.0);
        for (i, gap) in gaps_at_rest(&world).into_iter().enumerate() {
            let now = -0.25 - 0.5 * i as f64 - world.bodies[i + 1].at[1];
            expected += gap;
            assert!((now - fallen - gap).abs() < 0.01 * gap, "{links}, {tip}, {i}: {} {gap}", now - fallen);
            fallen = now;
        }
        assert!((fallen - expected).abs() < 0.001 * expected, "{links}, {tip}: {fallen} {expected}");
        assert!(world.largest_speed() < 1e-4, "{links}, {tip}: {}", world.largest_speed());
        // It hangs as straight as it did.
        assert!(world.bodies.iter().all(|body| body.at[0] == 0.0 && body.angle == 0.0));
        assert_eq!(world.cut, 0);
    }
}

/// A scene without joints has no passes over joints and no memory for them.
#[test]
fn a_scene_without_joints_pays_nothing() {
    let mut world =
        World::new(&[Body::fixed(), Body { half: [0.5; 2], ..Body::rectangle([0.0, 0.5], [0.5; 2]) }], 10.0);
    world.run(1.0);
    assert_eq!(world.memory_of_joints(), 0);
    world.pin(0, 1, [0.0, 0.5]);
    world.run(1.0);
    assert!(world.memory_of_joints() > 0);
    // Joints that are taken away leave nothing behind.
    world.links.clear();
    world.run(1.0);
}

/// A net of side × side discs, tied by rods, or by pins half way, and held at its top corners.
pub(super) fn net(side: usize, has_pins: bool) -> World {
    let half = (side as f64 - 1.0) / 2.0;
    let mass = PI * 0.04;
    let disc = Body { mass, inertia: mass * 0.02, radius: 0.2, ..Body::fixed() };
    let mut bodies = vec![];
    for i in 0..side * side {
        let (row, column) = (i / side, i % side);
        let at = [column as f64 - half, -(row as f64)];
        let is_corner = row == 0 && (column == 0 || column == side - 1);
        bodies.push(Body { at, ..if is_corner { Body::fixed() } else { disc } });
    }
    let mut world = World::new(&bodies, 10.0);
    for i in 0..side * side {
        let mut tie = |to: usize| {
            let [a, b] = [bodies[to].at, bodies[i].at];
            if has_pins {
                world.pin(to, i, [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]);
            } else {
                world.rod(to, i, [a, b]);
            }
        };
        if i % side > 0 {
            tie(i - 1);
        }
        if i >= side {
            tie(i - side);
        }
    }
    world
}

/// Joints share bodies here: with the stiffness of joints that do not, a net swings for ever.
#[test]
fn a_net_comes_to_rest() {
    let mut world = net(10, false);
    world.run(30.0);
    assert!(world.largest_speed() < 1e-4, "{}", world.largest_speed());
    let asymmetry = (0..100).map(|i: usize| {
        let (a, b) = (world.bodies[i].at, world.bodies[i / 10 * 10 + 9 - i % 10].at);
        (a[0] + b[0]).abs().max((a[1] - b[1]).abs())
    });
    let asymmetry = asymmetry.fold(0.0, f64::max);
    assert_eq!(asymmetry, 0.0);
    assert_eq!(world.cut, 0);
}
