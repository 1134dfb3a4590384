//! Steps of bodies that touch nothing, and of bodies asleep.

use super::{Engines, Opt, build_all, now, secs};
use crate::report::Report;
use crate::scene::{self, Scene};
use std::time::Instant;

/// A scene whose steps all cost about the same: batches of steps, engines in turn.
/// `per` divides the time of a step (the number of bodies), giving `unit`.
fn steady(
    rep: &mut Report,
    engines: Engines,
    s: &Scene,
    opt: &Opt,
    per: f64,
    metric: &str,
    unit: &'static str,
    scale: f64,
) {
    let mut worlds = build_all(rep, engines, s);
    let rounds = if opt.quick { 3 } else { 9 };
    let mut batch = Vec::new();
    for (_, w) in &mut worlds {
        // The first steps allocate: the estimate comes from a later one.
        let mut est = 0.0;
        let t0 = Instant::now();
        for _ in 0..4 {
            let t = now();
            w.step();
            est = now() - t;
            if secs(t0) > 1.0 {
                break;
            }
        }
        let k = (0.03 / est).clamp(1.0, 200.0) as usize;
        let r = ((1.5 / (est * k as f64)) as usize).clamp(2, rounds);
        batch.push((k, r, Vec::new()));
    }
    for round in 0..rounds {
        for ((_, w), (k, r, samples)) in worlds.iter_mut().zip(&mut batch) {
            if round >= *r {
                continue;
            }
            let t = now();
            for _ in 0..*k {
                w.step();
            }
            samples.push((now() - t) / *k as f64 * scale / per);
        }
    }
    for ((i, w), (k, _, samples)) in worlds.iter().zip(&batch) {
        let moved = w.state(s.bodies.len() - 1);
        let note = format!(
            "{k} steps per sample; awake {:?}; last body at ({} {})",
            w.awake(),
            moved.x as f32,
            moved.y as f32
        );
        rep.add(engines[*i].id(), &s.name, s.n, metric, unit, samples, note);
    }
}

pub fn free(rep: &mut Report, engines: Engines, opt: &Opt) {
    for n in [1_000, 10_000, 100_000] {
        let s = scene::free(n);
        steady(rep, engines, &s, opt, n as f64, "per_body_step", "ns", 1e9);
    }
    for n in [1_000, 10_000] {
        let s = scene::free_far(n);
        steady(rep, engines, &s, opt, n as f64, "per_body_step", "ns", 1e9);
    }
}

pub fn free_static(rep: &mut Report, engines: Engines, opt: &Opt) {
    // 0 fixed bodies is the reference: what the 100 dynamic ones cost alone.
    for n in [0, 100_000] {
        for colliders in [false, true] {
            let s = scene::free_static(n, colliders);
            steady(rep, engines, &s, opt, 1.0, "step", "us", 1e6);
        }
    }
}

pub fn sleeping(rep: &mut Report, engines: Engines, opt: &Opt) {
    for s in [1_000, 10_000].into_iter().flat_map(|n| [scene::sleeping_free(n), scene::sleeping(n)]) {
        let n = s.n;
        let mut worlds = build_all(rep, engines, &s);
        let cap = if opt.quick || n > 1000 { 4.0 } else { 12.0 };
        let mut asleep = Vec::new();
        for (i, mut w) in worlds.drain(..) {
            let id = engines[i].id();
            let t = Instant::now();
            let c = now();
            let mut settle = 0;
            while w.awake() != Some(0) && settle < 600 && secs(t) < cap {
                w.step();
                settle += 1;
            }
            if w.awake() == Some(0) {
                rep.one(id, &s.name, n, "settle_steps", "steps", settle as f64, "steps until all asleep");
                rep.one(id, &s.name, n, "settle_mean_step", "us", (now() - c) / settle as f64 * 1e6, "");
                // One more: an engine may do its bookkeeping the step after.
                w.step();
                asleep.push((i, w));
            } else {
                rep.skip(
                    id,
                    &s.name,
                    n,
                    &format!("still {:?} awake after {settle} steps and {:.1} s", w.awake(), secs(t)),
                );
            }
        }
        let rounds = if opt.quick { 3 } else { 9 };
        let mut samples = vec![Vec::new(); asleep.len()];
        for _ in 0..rounds {
            for (k, (_, w)) in asleep.iter_mut().enumerate() {
                let t = now();
                for _ in 0..50 {
                    w.step();
                }
                samples[k].push((now() - t) / 50.0 * 1e6);
            }
        }
        for (k, (i, w)) in asleep.iter().enumerate() {
            rep.add(engines[*i].id(), &s.name, n, "step_asleep", "us", &samples[k], format!("awake {:?}", w.awake()));
        }
    }
}
