//! Scenes with contacts, run from their start, with the quality of the end state beside the time.

use super::{Engines, Opt, kick, now};
use crate::engine::World;
use crate::report::Report;
use crate::scene::{self, Kind, Scene, Shape};

/// Metrics of the end state, and what is wrong with it if it makes the times of the
/// run meaningless (bodies that flew apart have no contacts to solve).
pub(super) struct Quality {
    pub(super) rows: Vec<(&'static str, &'static str, f64)>,
    pub(super) bad: Option<&'static str>,
}

struct Run {
    mean: Vec<f64>,
    p99: Vec<f64>,
    first20: Vec<f64>,
    last100: Vec<f64>,
    steps: usize,
    quality: Quality,
    contacts: Option<usize>,
    hash: u64,
    same_hash: bool,
}

/// A scene run from the start, several times, engines in turn.
pub(super) fn runs(
    rep: &mut Report,
    engines: Engines,
    s: &Scene,
    steps: usize,
    repeats: usize,
    cap: f64,
    quality: &dyn Fn(&Scene, &dyn World) -> Quality,
) {
    let mut res: Vec<Option<Run>> = engines
        .iter()
        .map(|e| match e.refuse(s) {
            Some(why) => {
                rep.skip(e.id(), &s.name, s.n, &why);
                None
            }
            None => Some(Run {
                mean: vec![],
                p99: vec![],
                first20: vec![],
                last100: vec![],
                steps,
                quality: Quality { rows: vec![], bad: None },
                contacts: None,
                hash: 0,
                same_hash: true,
            }),
        })
        .collect();
    for rep_i in 0..repeats {
        for (e, r) in engines.iter().zip(&mut res) {
            let Some(r) = r else { continue };
            if rep_i > 0 && r.steps < steps {
                continue; // it hit the cap: once is enough
            }
            let mut w = e.build(s);
            let mut t_step = Vec::with_capacity(steps);
            let t0 = now();
            for step in 0..steps {
                kick(s, w.as_mut(), step);
                let t = now();
                w.step();
                t_step.push((now() - t) * 1e6);
                if now() - t0 > cap {
                    break;
                }
            }
            r.steps = t_step.len();
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            r.mean.push(mean(&t_step));
            r.first20.push(mean(&t_step[..t_step.len().min(20)]));
            r.last100.push(mean(&t_step[t_step.len().saturating_sub(100)..]));
            let mut sorted = t_step.clone();
            sorted.sort_by(f64::total_cmp);
            r.p99.push(sorted[(sorted.len() - 1) * 99 / 100]);
            let h = w.hash();
            if rep_i == 0 {
                r.hash = h;
                r.quality = quality(s, w.as_ref());
                r.contacts = w.contact_points();
            } else if h != r.hash {
                r.same_hash = false;
            }
        }
    }
    for (e, r) in engines.iter().zip(&res) {
        let Some(r) = r else { continue };
        let id = e.id();
        let mut cut = if r.steps < steps { format!("first {} of {steps} steps", r.steps) } else { String::new() };
        if let Some(bad) = r.quality.bad {
            cut = format!("{cut}{}INVALID: {bad}", if cut.is_empty() { "" } else { "; " });
        }
        rep.add(id, &s.name, s.n, "step_mean", "us", &r.mean, cut.clone());
        rep.add(id, &s.name, s.n, "step_first20", "us", &r.first20, cut.clone());
        rep.add(id, &s.name, s.n, "step_last100", "us", &r.last100, cut.clone());
        rep.add(id, &s.name, s.n, "step_p99", "us", &r.p99, cut.clone());
        if let Some(c) = r.contacts.filter(|&c| c > 0) {
            rep.one(id, &s.name, s.n, "contact_points", "count", c as f64, cut.clone());
            let per: Vec<f64> = r.last100.iter().map(|t| t * 1e3 / c as f64).collect();
            rep.add(id, &s.name, s.n, "per_contact_last100", "ns", &per, cut.clone());
        }
        if !s.joints.is_empty() {
            let per: Vec<f64> = r.mean.iter().map(|t| t * 1e3 / s.joints.len() as f64).collect();
            rep.add(id, &s.name, s.n, "per_joint", "ns", &per, cut.clone());
        }
        for (m, u, v) in &r.quality.rows {
            rep.one(id, &s.name, s.n, m, u, *v, cut.clone());
        }
        if r.mean.len() > 1 {
            rep.one(
                id,
                &s.name,
                s.n,
                "same_hash",
                "bool",
                r.same_hash as u8 as f64,
                format!("end state {:016x} in {} runs", r.hash, r.mean.len()),
            );
        }
    }
}

pub(super) fn max_speed(s: &Scene, w: &dyn World) -> f64 {
    (0..s.bodies.len())
        .map(|i| {
            let q = w.state(i);
            q.vx.hypot(q.vy)
        })
        .fold(0.0, f64::max)
}

pub fn pyramid(rep: &mut Report, engines: Engines, opt: &Opt) {
    for base in [10, 20, 40] {
        let s = scene::pyramid(base);
        let repeats = if opt.quick { 1 } else { 3 };
        runs(rep, engines, &s, 300, repeats, if opt.quick { 1.0 } else { 2.5 }, &|s, w| {
            let top = s.bodies.len() - 1;
            let (b, q) = (&s.bodies[top], w.state(top));
            let (sink, shift) = (b.y - q.y, (q.x - b.x).abs());
            Quality {
                rows: vec![("top_sink", "m", sink), ("top_shift", "m", shift), ("max_speed", "m/s", max_speed(s, w))],
                bad: (!(sink.abs() < 0.5 && shift < 0.5)).then_some("the pyramid did not stand"),
            }
        });
    }
}

/// Overlap of circles with each other and with the walls, by brute force.
fn circle_overlap(s: &Scene, w: &dyn World) -> f64 {
    let c: Vec<(f64, f64, f64)> = s
        .bodies
        .iter()
        .enumerate()
        .filter_map(|(i, b)| match (b.kind, b.shape) {
            (Kind::Dynamic, Shape::Circle { r }) => {
                let q = w.state(i);
                Some((q.x, q.y, r))
            }
            _ => None,
        })
        .collect();
    let hw = scene::rain_half_width(s.n);
    let mut worst: f64 = 0.0;
    for (i, a) in c.iter().enumerate() {
        worst = worst.max(a.2 - a.1).max(a.2 - (a.0 + hw)).max(a.2 - (hw - a.0));
        for b in &c[i + 1..] {
            let (dx, dy) = (a.0 - b.0, a.1 - b.1);
            let r = a.2 + b.2;
            if dx.abs() < r && dy.abs() < r {
                worst = worst.max(r - dx.hypot(dy));
            }
        }
    }
    worst
}

pub fn rain(rep: &mut Report, engines: Engines, opt: &Opt) {
    for n in [1_000, 4_000] {
        let s = scene::rain(n);
        let repeats = if opt.quick || n > 1_000 { 1 } else { 3 };
        let repeats = if !opt.quick && n > 1_000 { 2 } else { repeats };
        runs(rep, engines, &s, 600, repeats, if opt.quick { 2.0 } else { 10.0 }, &|s, w| {
            let hw = scene::rain_half_width(s.n);
            let out = (3..s.bodies.len()).filter(|&i| {
                let q = w.state(i);
                !(q.y > -0.5 && q.x.abs() < hw + 0.5)
            });
            let ke: f64 = (3..s.bodies.len())
                .map(|i| {
                    let (q, (m, _)) = (w.state(i), s.bodies[i].mass_inertia());
                    0.5 * m * (q.vx * q.vx + q.vy * q.vy)
                })
                .sum();
            let out = out.count();
            Quality {
                rows: vec![
                    ("escaped", "bodies", out as f64),
                    ("max_circle_overlap", "m", circle_overlap(s, w)),
                    ("kinetic_per_body", "J", ke / s.n as f64),
                ],
                bad: (out > s.n / 50).then_some("bodies left the container"),
            }
        });
    }
}
