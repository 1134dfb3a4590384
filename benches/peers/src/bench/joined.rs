//! Scenes with joints, run from their start: the time of a step beside the quality of the end state, and time against error over sub-steps.

use super::contacts::{Quality, max_speed, runs};
use super::crowds::crowd;
use super::geometry::{joint_gap, kinetic, largest};
use super::{Engines, Opt, now};
use crate::engine::{Engine, State, World};
use crate::report::Report;
use crate::scene::{self, Scene};

/// The longest time of a run, s.
const CAP: f64 = 30.0;
/// Steps of a crowd, and of a quick run.
const STEPS: [usize; 2] = [600, 240];

fn states(s: &Scene, w: &dyn World) -> Vec<State> {
    (0..s.bodies.len()).map(|i| w.state(i)).collect()
}

/// How well joints hold at the end.
fn held(s: &Scene, w: &dyn World) -> Quality {
    let gap = joint_gap(s, &states(s, w));
    Quality {
        rows: vec![("max_joint_gap", "m", gap), ("max_speed", "m/s", max_speed(s, w))],
        bad: (!(gap < 1.0)).then_some("the joints came apart"),
    }
}

pub fn joints(rep: &mut Report, engines: Engines, opt: &Opt) {
    for s in [scene::chain(400), scene::grid(15)] {
        let repeats = if opt.quick { 1 } else { 3 };
        runs(rep, engines, &s, 300, repeats, if opt.quick { 1.0 } else { 2.5 }, &held);
    }
}

pub fn joint_grid(rep: &mut Report, engines: Engines, opt: &Opt) {
    let (steps, repeats) = if opt.quick { (60, 1) } else { (300, 2) };
    runs(rep, engines, &scene::joint_grid(100), steps, repeats, CAP, &held);
}

pub fn ragdolls(rep: &mut Report, engines: Engines, opt: &Opt) {
    let is_inside = |q: &State| q.y > -0.5 && q.x.abs() < scene::RAGDOLLS_HALF_WIDTH + 0.5;
    crowd(rep, engines, opt, &scene::ragdolls(100), STEPS, is_inside);
}

pub fn tumbler(rep: &mut Report, engines: Engines, opt: &Opt) {
    crowd(rep, engines, opt, &scene::tumbler(45), STEPS, |q| q.x.hypot(q.y) < 1.5 * scene::TUMBLER);
}

pub fn motor_spinner(rep: &mut Report, engines: Engines, opt: &Opt) {
    crowd(rep, engines, opt, &scene::motor_spinner(3_000), STEPS, |q| q.x.hypot(q.y) < scene::RING + 0.5);
}

/// The error of a run, from the states of all bodies by step.
type Error = fn(&Scene, &[Vec<State>]) -> f64;

/// The widest gap of a joint in the run, m.
fn widest_gap(s: &Scene, path: &[Vec<State>]) -> f64 {
    path.iter().map(|states| joint_gap(s, states)).fold(0.0, largest)
}

/// The largest change of energy in the run, over m·g·(the depth of the lowest point of the centre of mass).
fn energy_drift(s: &Scene, path: &[Vec<State>]) -> f64 {
    let gravity = -s.gravity[1];
    let potential = |states: &[State]| {
        let heights = s.bodies.iter().zip(states).filter(|(b, _)| b.kind == scene::Kind::Dynamic);
        heights.map(|(b, q)| b.mass_inertia().0 * gravity * q.y).sum::<f64>()
    };
    let energy = |states: &Vec<State>| kinetic(s, states) + potential(states);
    let start = energy(&path[0]);
    let depth = path.iter().map(|states| potential(&path[0]) - potential(states)).fold(0.0, largest);
    path.iter().map(|states| (energy(states) - start).abs() / depth).fold(0.0, largest)
}

/// Time against error: chains at each number of sub-steps that engines take.
pub fn joint_errors(rep: &mut Report, engines: Engines, opt: &Opt) {
    let scenes: [(Scene, f64, &str, &'static str, Error); 3] = [
        (scene::hanging(100, 1.0), 10.0, "gap", "m", widest_gap),
        (scene::chain(100), 10.0, "gap", "m", widest_gap),
        (scene::pendulum(), 100.0, "energy_drift", "1", energy_drift),
    ];
    for (s, seconds, metric, unit, error) in scenes {
        let steps = (if opt.quick { seconds / 5.0 } else { seconds } / s.dt).round() as usize;
        for substeps in [1, 2, 3, 4, 5, 6, 8, 12, 16] {
            let s = Scene { substeps: Some(substeps), ..s.clone() };
            for e in engines {
                match e.refuse(&s) {
                    Some(why) => rep.skip(e.id(), &s.name, s.n, &why),
                    None => add_error(rep, *e, &s, steps, &format!("{metric}/{substeps}"), unit, error),
                }
            }
        }
    }
}

fn add_error(
    rep: &mut Report,
    e: &dyn Engine,
    s: &Scene,
    steps: usize,
    metric: &str,
    unit: &'static str,
    error: Error,
) {
    let mut w = e.build(s);
    let mut path = vec![states(s, w.as_ref())];
    let mut times = Vec::with_capacity(steps);
    for _ in 0..steps {
        let before = now();
        w.step();
        times.push((now() - before) * 1e6);
        path.push(states(s, w.as_ref()));
    }
    times.sort_by(f64::total_cmp);
    let note = format!("{} sub-steps, {steps} steps", s.substeps.unwrap_or_default());
    rep.one(e.id(), &s.name, s.n, metric, unit, error(s, &path), note.clone());
    rep.one(e.id(), &s.name, s.n, &format!("step/{}", s.substeps.unwrap_or_default()), "us", times[steps / 2], note);
}
