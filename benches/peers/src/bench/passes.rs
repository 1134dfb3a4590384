//! The time of the solver's passes alone, as each engine measures it.

use super::{Engines, Opt, build_all};
use crate::report::Report;
use crate::scene;

/// Steps before the measured ones: until then contacts still form.
const SETTLE: usize = 60;

/// The engine that the others are compared with.
const REFERENCE: &str = "box2d";

/// The least time of each stage, engines in turn, on the pyramid of 40 rows.
pub fn passes(rep: &mut Report, engines: Engines, opt: &Opt) {
    let s = scene::Scene { name: "passes".into(), ..scene::pyramid(40) };
    let mut worlds = build_all(rep, engines, &s);
    let mut least: Vec<Vec<(&'static str, f64)>> = vec![Vec::new(); worlds.len()];
    for step in 0..SETTLE + if opt.quick { 100 } else { 600 } {
        for ((_, w), least) in worlds.iter_mut().zip(&mut least) {
            w.step();
            let times = w.pass_times();
            if step < SETTLE {
                continue;
            }
            if least.is_empty() {
                *least = times;
            } else {
                for (l, t) in least.iter_mut().zip(times) {
                    assert_eq!(l.0, t.0, "an engine reports the same stages every step");
                    l.1 = l.1.min(t.1);
                }
            }
        }
    }
    let mut sums = Vec::new();
    for ((i, w), stages) in worlds.iter().zip(&least) {
        let id = engines[*i].id();
        if stages.is_empty() {
            rep.skip(id, &s.name, s.n, "measures no passes");
            continue;
        }
        let top = w.state(s.bodies.len() - 1);
        let stands = (top.y - s.bodies[s.bodies.len() - 1].y).abs() < 0.5 && top.x.abs() < 0.5;
        let note = if stands { "sum of the least times" } else { "INVALID: the pyramid did not stand" };
        for (name, us) in stages {
            rep.one(id, &s.name, s.n, name, "us", *us, "");
        }
        let sum: f64 = stages.iter().map(|t| t.1).sum();
        rep.one(id, &s.name, s.n, "sum", "us", sum, note);
        if let Some(points) = w.contact_points() {
            rep.one(id, &s.name, s.n, "contact_points", "count", points as f64, "");
        }
        sums.push((id, sum));
    }
    if let Some(reference) = sums.iter().find(|(id, _)| *id == REFERENCE).map(|s| s.1) {
        for (id, sum) in sums {
            rep.one(id, &s.name, s.n, "sum_over_box2d", "1", sum / reference, "");
        }
    }
}
