//! Chains, bridges, ropes and nets: how far joints give way, and when they rest.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use super::cases::{chain, net};
use super::world::{Body, World};

/// All bodies rest below this speed, m/s.
const REST: f64 = 0.05;

/// The outcome of a run.
#[derive(Debug)]
struct Seen {
    /// The largest gap on the way, m.
    gap: f64,
    /// The step from which on all bodies rest.
    rest: usize,
    /// The largest speed at the end, m/s.
    speed: f64,
}

fn run(world: &mut World, seconds: f64) -> Seen {
    let steps = (seconds * f64::from(super::world::RATE)).round() as usize;
    let mut outcome = Seen { gap: 0.0, rest: 0, speed: 0.0 };
    for step in 1..=steps {
        world.step();
        outcome.gap = outcome.gap.max(world.worst_gap());
        outcome.speed = world.largest_speed();
        if outcome.speed >= REST {
            outcome.rest = step + 1;
        }
    }
    outcome
}

/// The distance by which the last link of a chain is below its place.
fn stretch(world: &World) -> f64 {
    let links = world.bodies.len() - 1;
    -0.25 - 0.5 * (links as f64 - 1.0) - world.bodies[links].at[1]
}

fn check(world: &mut World, seconds: f64, gap: f64, rest: usize) -> Seen {
    let outcome = run(world, seconds);
    assert!(outcome.gap < gap && outcome.rest <= rest, "{outcome:?}, at most {gap}, {rest}");
    assert_eq!(world.cut, 0);
    outcome
}

#[test]
fn chains_hang_still_at_once() {
    for (links, tip, seconds, drop, gap, rest) in
        [(100, 1.0, 5.0, 0.0053, 0.14e-3, 8), (100, 100.0, 5.0, 0.019, 0.3e-3, 38), (400, 1.0, 5.0, 0.085, 0.7e-3, 216)]
    {
        let mut world = chain(links, tip);
        check(&mut world, seconds, gap, rest);
        assert!(stretch(&world) < drop, "{links}, {tip}: {}", stretch(&world));
    }
}

#[test]
fn nets_come_to_rest_with_small_gaps() {
    check(&mut net(20, false), 20.0, 0.089, 935);
    check(&mut net(20, true), 5.0, 0.107, 151);
}

/// Eight rows of eight discs on pins, the lowest 100 times as heavy.
#[test]
fn a_net_bears_a_heavy_row() {
    let mut world = net(8, true);
    for body in &mut world.bodies[56..] {
        (body.mass, body.inertia) = (100.0 * body.mass, 100.0 * body.inertia);
    }
    check(&mut world, 10.0, 0.248, 310);
}

/// A ring of planks, one of which hangs on a pin.
#[test]
fn a_ring_hangs_on_a_pin() {
    let count = 20;
    let radius = 1.0 / (2.0 * (PI / count as f64).sin());
    let mut bodies = vec![Body { at: [0.0, radius], ..Body::fixed() }];
    let corner = |i: usize| {
        let angle = 2.0 * PI * (i as f64 - 0.5) / count as f64;
        [radius * angle.sin(), radius * angle.cos()]
    };
    for i in 0..count {
        let (a, b) = (corner(i), corner(i + 1));
        let mut plank = Body::rectangle([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0], [0.48, 0.125]);
        plank.angle = -2.0 * PI * i as f64 / count as f64;
        (plank.mass, plank.inertia) = (20.0 * plank.mass, 20.0 * plank.inertia);
        bodies.push(plank);
    }
    let mut world = World::new(&bodies, 10.0);
    let top = world.bodies[1].at;
    world.bodies[0].at = top;
    world.pin(0, 1, top);
    (0..count).for_each(|i| world.pin(1 + i, 1 + (i + 1) % count, corner(i + 1)));
    check(&mut world, 10.0, 0.0144, usize::MAX);
}

/// Planks between two supports, and five discs that fall on them.
fn bridge(planks: usize, density: f64) -> World {
    let half = planks as f64 / 2.0;
    let mut bodies = vec![Body { at: [-half - 1.0, 20.0], ..Body::fixed() }];
    for i in 0..planks {
        let mut plank = Body::rectangle([i as f64 + 0.5 - half, 20.0], [0.48, 0.125]);
        (plank.mass, plank.inertia) = (20.0 * plank.mass, 20.0 * plank.inertia);
        plank.half = [0.48, 0.125];
        bodies.push(plank);
    }
    bodies.push(Body { at: [half + 1.0, 20.0], ..Body::fixed() });
    bodies.extend((0..5).map(|k| Body::disc([f64::from(k) * 1.5 - 3.0, 23.0], 0.5, density)));
    let mut world = World::new(&bodies, 10.0);
    (0..=planks).for_each(|i| world.pin(i, i + 1, [i as f64 - half, 20.0]));
    world
}

/// Discs roll to and fro on the bridge, and when all of them rest is a matter of chance: the mean of five bridges, with the discs some millimetres apart,
/// is 840 steps.
#[test]
fn a_bridge_bears_discs() {
    let rests = [0, 1, 2, 3, 4].map(|shift| {
        let mut world = bridge(30, 20.0);
        let first = world.bodies.len() - 5;
        world.bodies[first..].iter_mut().for_each(|disc| disc.at[0] -= f64::from(shift) / 256.0);
        check(&mut world, 30.0, 0.024, 1_000).rest
    });
    assert!(rests.iter().sum::<usize>() / 5 < 900, "{rests:?}");
}

#[test]
fn a_bridge_bears_discs_160_times_as_heavy_as_its_planks() {
    let mut world = bridge(30, 1000.0);
    world.options.substeps = 16;
    let outcome = check(&mut world, 30.0, 0.05, 1801);
    assert!(outcome.speed < 0.5, "{outcome:?}");
}

/// Ropes of ten boxes that fall on the floor, side by side, at 6 m/s: impacts stop single boxes.
#[test]
fn ropes_rest_on_a_floor() {
    let mut bodies = vec![Body::fixed()];
    for rope in 0..3 {
        for k in 0..10 {
            let mut link = Body::rectangle([3.0 * rope as f64 + 0.02 * k as f64, 2.0 + 0.22 * k as f64], [0.06, 0.12]);
            (link.half, link.angle) = ([0.06, 0.12], 0.02);
            bodies.push(link);
        }
    }
    let mut world = World::new(&bodies, 10.0);
    for i in (1..bodies.len() - 1).filter(|i| i % 10 != 0) {
        let [x, y] = bodies[i + 1].at;
        world.pin(i, i + 1, [x, y - 0.11]);
    }
    check(&mut world, 10.0, 0.05, 204);
    let lowest = |body: &Body| {
        let corners: Vec<f64> = [[1.0, 1.0], [-1.0, 1.0]]
            .iter()
            .map(|[x, y]| super::world::rotated(body.angle, [x * body.half[0], y * body.half[1]])[1].abs())
            .collect();
        body.at[1] - corners[0].max(corners[1])
    };
    let overlap = world.bodies[1..].iter().map(|body| -lowest(body)).fold(0.0, f64::max);
    assert!(overlap < 0.0056, "{overlap}");
}
