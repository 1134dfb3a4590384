//! Impacts against mechanics: bodies that touch nothing, bounces, gases, rows, an overhang, half a pipe and a corridor. Engines in turn; each row
//! is an error or a count of failures, so that 0 is right.

use super::{Engines, Opt, build_all, now};
use crate::engine::World;
use crate::report::Report;
use crate::scene::{self, Kind, Scene};

/// An error of a scene after it has run in an engine: metric, unit, value.
type Errors = Vec<(&'static str, &'static str, f64)>;

/// Runs a scene in all engines that take it, with the time of its steps.
fn run(rep: &mut Report, engines: Engines, s: &Scene, errors: fn(&Scene, &mut dyn World, &mut f64) -> Errors) {
    for (i, mut world) in build_all(rep, engines, s) {
        let mut time = 0.0;
        for (metric, unit, value) in errors(s, world.as_mut(), &mut time) {
            rep.one(engines[i].id(), &s.name, s.n, metric, unit, value, "");
        }
        rep.one(engines[i].id(), &s.name, s.n, "time", "us", time * 1e6, "of all steps");
    }
}

/// Steps a world, and adds the time that it takes.
fn steps(world: &mut dyn World, count: usize, time: &mut f64) {
    let start = now();
    (0..count).for_each(|_| world.step());
    *time += now() - start;
}

fn kinetic(s: &Scene, world: &dyn World) -> f64 {
    let moving = s.bodies.iter().enumerate().filter(|(_, body)| body.kind == Kind::Dynamic);
    let energy = moving.map(|(i, body)| {
        let (q, (mass, inertia)) = (world.state(i), body.mass_inertia());
        0.5 * (mass * (q.vx * q.vx + q.vy * q.vy) + inertia * q.w * q.w)
    });
    energy.sum()
}

fn ghosts(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    steps(world, 10, time);
    let changes = (0..scene::TRIALS).map(|trial| {
        let (body, q) = (&s.bodies[scene::TRIALS + trial], world.state(scene::TRIALS + trial));
        (q.vx - body.vx).hypot(q.vy - body.vy) / body.vx.hypot(body.vy)
    });
    let changes: Vec<f64> = changes.collect();
    let deflected = changes.iter().filter(|&&change| change > 1e-3).count();
    vec![("deflected", "discs", deflected as f64), ("worst_change", "1", changes.into_iter().fold(0.0, f64::max))]
}

fn bounces(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    steps(world, 40, time);
    let errors = (0..scene::TRIALS).map(|trial| {
        let at = 2 * scene::TRIALS + trial;
        (world.state(at).vx / s.bodies[at].vx / scene::RESTITUTION + 1.0).abs()
    });
    let errors: Vec<f64> = errors.collect();
    let lost = errors.iter().filter(|&&error| error > 0.1).count();
    vec![("lost", "bounces", lost as f64), ("worst_error", "1", errors.into_iter().fold(0.0, f64::max))]
}

fn gas(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    let (start, mut worst) = (kinetic(s, world), 0.0_f64);
    for _ in 0..20 * 60 {
        steps(world, 1, time);
        worst = worst.max((kinetic(s, world) / start - 1.0).abs());
    }
    vec![("energy_error_20s", "1", worst)]
}

fn rows(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    // The slowest one has passed all gaps after 1.1 s.
    steps(world, 90, time);
    let (mut last, mut others) = (0.0_f64, 0.0_f64);
    for first in (0..s.bodies.len()).step_by(scene::ROW) {
        let speed = s.bodies[first].vx;
        last = last.max((world.state(first + scene::ROW - 1).vx / speed - 1.0).abs());
        for k in 0..scene::ROW - 1 {
            let q = world.state(first + k);
            others = others.max(q.vx.hypot(q.vy) / speed);
        }
    }
    vec![("last_error", "1", last), ("others_speed", "1", others)]
}

fn overhang(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    let (mut spin, mut tilt) = (0.0_f64, 0.0_f64);
    for _ in 0..180 {
        steps(world, 1, time);
        for at in 1..s.bodies.len() {
            let q = world.state(at);
            (spin, tilt) = (spin.max(q.w.abs()), tilt.max(q.angle.abs()));
        }
    }
    let fallen = (0..scene::DROPS.len()).filter(|stack| !((world.state(4 * stack + 4).y - 3.5).abs() < 0.05));
    vec![("worst_spin", "rad/s", spin), ("worst_tilt", "rad", tilt), ("fallen", "stacks", fallen.count() as f64)]
}

fn half_pipe(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    let at = s.bodies.len() - 1;
    let (mass, _) = s.bodies[at].mass_inertia();
    let height = |world: &dyn World| world.state(at).y + kinetic(s, world) / (10.0 * mass) - 0.25;
    let (start, mut highest) = (height(world), 0.0_f64);
    for _ in 0..20 * 60 {
        steps(world, 1, time);
        highest = highest.max(height(world) / start - 1.0);
    }
    vec![("energy_gain", "1", highest), ("energy_lost_20s", "1", 1.0 - height(world) / start)]
}

fn corridor(s: &Scene, world: &mut dyn World, time: &mut f64) -> Errors {
    steps(world, 120, time);
    let mut fastest = 0.0_f64;
    for _ in 0..60 {
        steps(world, 1, time);
        for at in s.bodies.len() - 4..s.bodies.len() {
            let q = world.state(at);
            fastest = fastest.max(q.vx.hypot(q.vy));
        }
    }
    vec![("speed_after_2s", "m/s", fastest)]
}

pub fn impacts(rep: &mut Report, engines: Engines, opt: &Opt) {
    run(rep, engines, &scene::ghosts(), ghosts);
    run(rep, engines, &scene::bounces(), bounces);
    for seed in 0..if opt.quick { 1 } else { 5 } {
        let mut s = scene::gas(seed);
        s.name = format!("{}_{seed}", s.name);
        run(rep, engines, &s, gas);
    }
    run(rep, engines, &scene::rows(), rows);
    run(rep, engines, &scene::overhang(), overhang);
    run(rep, engines, &scene::half_pipe(), half_pipe);
    run(rep, engines, &scene::corridor(), corridor);
}
