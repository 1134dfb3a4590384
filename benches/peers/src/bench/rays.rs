//! Rays for the first collider on them, one after another on one core.

use super::{Engines, Opt, build_all, now};
use crate::report::Report;
use crate::scene;

/// The engine that the others are compared with.
const REFERENCE: &str = "box2d";

const COLLIDERS: usize = 100_000;

/// Rays of a sample.
const RAYS: usize = 100_000;

/// Rays of several lengths, engines in turn: millions a second of each, and over those of Box2D in the same run.
pub fn rays(rep: &mut Report, engines: Engines, opt: &Opt) {
    let s = scene::rays(COLLIDERS);
    let mut worlds = build_all(rep, engines, &s);
    // Engines follow new colliders when they step.
    worlds.iter_mut().for_each(|(_, w)| (0..2).for_each(|_| w.step()));
    for length in [10.0, 50.0, 200.0] {
        let list = scene::ray_list(&s, RAYS, length);
        let mut runs: Vec<(Vec<f64>, Vec<f64>)> = vec![(vec![0.0; RAYS], Vec::new()); worlds.len()];
        for _ in 0..if opt.quick { 3 } else { 9 } {
            for ((_, w), (fractions, samples)) in worlds.iter_mut().zip(&mut runs) {
                let start = now();
                if w.cast_rays(&list, fractions) {
                    samples.push(RAYS as f64 / (now() - start) * 1e-6);
                }
            }
        }
        let has_hit = |fraction: &f64| *fraction <= 1.0;
        let id = |at: usize| engines[worlds[at].0].id();
        let answers = (0..runs.len()).find(|&at| id(at) == REFERENCE).map(|at| (runs[at].0.clone(), best(&runs[at].1)));
        for (at, (fractions, samples)) in runs.iter().enumerate() {
            if samples.is_empty() {
                rep.skip(id(at), &s.name, s.n, "casts no rays");
                continue;
            }
            let hits = fractions.iter().filter(|fraction| has_hit(fraction)).count();
            let way: f64 = fractions.iter().map(|fraction| fraction.min(1.0) * length).sum();
            let mut note = format!("{hits} of {RAYS} hit; {:.1} m each", way / RAYS as f64);
            if let Some((expected, _)) = &answers {
                // Rays that graze a corner may go either way in floats of 32 bits.
                let differ = fractions.iter().zip(expected).filter(|(a, b)| (*a - *b).abs() * length > 0.01).count();
                note += &format!("; {differ} differ from {REFERENCE}");
                if differ > RAYS / 1000 {
                    note += ": INVALID";
                }
            }
            rep.add(id(at), &s.name, s.n, &format!("rays_{length}m"), "M/s", samples, note);
            if let Some((_, reference)) = answers {
                let metric = format!("rays_{length}m_over_{REFERENCE}");
                rep.one(id(at), &s.name, s.n, &metric, "1", best(samples) / reference, "");
            }
        }
    }
}

/// The largest sample: what else runs on the machine only lowers them.
fn best(samples: &[f64]) -> f64 {
    samples.iter().copied().fold(0.0, f64::max)
}
