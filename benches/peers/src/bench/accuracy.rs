//! One body against closed forms.

use super::{Engines, Opt};
use crate::engine::{Engine, State};
use crate::report::Report;
use crate::scene::{self, Field, Scene};

/// Wrapped into (-pi, pi].
fn wrap(a: f64) -> f64 {
    let t = std::f64::consts::TAU;
    a - (a / t).round() * t
}

pub fn accuracy(rep: &mut Report, engines: Engines, opt: &Opt) {
    for e in engines {
        let id = e.id();
        let info = e.info();
        for (tag, sub) in [("default", None), ("1sub", Some(1))] {
            let used = sub.unwrap_or(info.default_substeps);
            let note = format!("{used} substeps");
            let m = |s: &str| format!("{s}@{tag}");

            // Ballistic: 10 s, g = 10, dt = 0.01.
            {
                let mut s = scene::single("acc_ballistic", [0.0, -10.0], 0.01, sub);
                s.bodies[0].x = 1.25;
                s.bodies[0].y = 2.5;
                s.bodies[0].vx = 3.3;
                s.bodies[0].vy = 7.7;
                let mut w = e.build(&s);
                for _ in 0..1000 {
                    w.step();
                }
                let q = w.state(0);
                rep.one(
                    id,
                    &s.name,
                    1,
                    &m("pos_err"),
                    "m",
                    (q.x - 34.25).hypot(q.y - (2.5 + 77.0 - 500.0)),
                    note.clone(),
                );
                rep.one(id, &s.name, 1, &m("vel_err"), "m/s", (q.vx - 3.3).hypot(q.vy - (7.7 - 100.0)), note.clone());
            }

            orbit(rep, *e, opt, (tag, sub, true));
            spring(rep, *e, opt, (tag, sub, true));

            // Spin: omega = 10 rad/s for 1000 s.
            {
                let mut s = scene::single("acc_spin", [0.0, 0.0], 0.01, sub);
                s.bodies[0].w = 10.0;
                let secs = if opt.quick { 100 } else { 1000 };
                let mut w = e.build(&s);
                let (mut drift, mut last) = (0.0, 0.0);
                for _ in 0..secs * 100 {
                    w.step();
                    let a = w.state(0).angle;
                    drift += wrap(a - last - 0.1);
                    last = a;
                }
                let q = w.state(0);
                let note = format!("{note}; {secs} s; omega at the end {}", q.w);
                rep.one(
                    id,
                    &s.name,
                    1,
                    &m("angle_err_mod_2pi"),
                    "rad",
                    wrap(q.angle - 10.0 * secs as f64),
                    note.clone(),
                );
                rep.one(id, &s.name, 1, &m("angle_drift"), "rad", drift, note);
            }

            // Exponential damping: c = 0.5, v0 = 10, 10 s at 1/60.
            {
                let mut s = scene::single("acc_damping", [0.0, 0.0], 1.0 / 60.0, sub);
                s.bodies[0].vx = 10.0;
                s.bodies[0].lin_damp = 0.5;
                s.bodies[0].ang_damp = 0.5;
                let mut w = e.build(&s);
                for _ in 0..600 {
                    w.step();
                }
                let v = w.state(0).vx;
                let law = (info.damped)(10.0, 0.5, 1.0 / 60.0, 600, used);
                rep.one(id, &s.name, 1, &m("rel_err_vs_law"), "1", (v - law) / law, info.damping_law);
                let ideal = 10.0 * (-5.0f64).exp();
                rep.one(id, &s.name, 1, &m("rel_err_vs_exp"), "1", (v - ideal) / ideal, info.damping_law);
            }
        }
        if e.has_fields() {
            orbit(rep, *e, opt, ("field", None, false));
            spring(rep, *e, opt, ("field", None, false));
        }
    }
}

/// Circular orbit: GM = 100, r = 10, 100 orbits; by a force of the user, or by the engine's own field.
fn orbit(rep: &mut Report, e: &dyn Engine, opt: &Opt, (tag, sub, pushed): (&str, Option<u32>, bool)) {
    let id = e.id();
    let note = format!("{} substeps", sub.unwrap_or(e.info().default_substeps));
    let m = |s: &str| format!("{s}@{tag}");
    let (gm, r0, dt) = (100.0, 10.0f64, 0.01);
    let field = Field::Attractor(gm);
    let mut s = Scene { field: Some(field), pushed, ..scene::single("acc_orbit", [0.0, 0.0], dt, sub) };
    s.bodies[0].x = r0;
    s.bodies[0].vy = (gm / r0).sqrt();
    let period = std::f64::consts::TAU * (r0 * r0 * r0 / gm).sqrt();
    let orbits = if opt.quick { 10.0 } else { 100.0 };
    let steps = (orbits * period / dt).round() as usize;
    let energy = |q: State| 0.5 * (q.vx * q.vx + q.vy * q.vy) - gm / q.x.hypot(q.y);
    let mut w = e.build(&s);
    let e0 = energy(w.state(0));
    let (mut worst_e, mut worst_r, mut last_r): (f64, f64, f64) = (0.0, 0.0, r0);
    let mut done = 0;
    for k in 0..steps {
        if pushed {
            let q = w.state(0);
            let (fx, fy) = field.force(q.x, q.y);
            w.push(0, fx, fy);
        }
        w.step();
        let q = w.state(0);
        last_r = q.x.hypot(q.y);
        worst_e = worst_e.max(((energy(q) - e0) / e0).abs());
        worst_r = worst_r.max((last_r - r0).abs());
        done = k + 1;
        if !(last_r < 1e4) {
            break;
        }
    }
    let note = format!("{note}; {:.1} orbits", done as f64 * dt / period);
    rep.one(id, &s.name, 1, &m("max_rel_energy_err"), "1", worst_e, note.clone());
    rep.one(id, &s.name, 1, &m("max_radius_dev"), "m", worst_r, note.clone());
    rep.one(id, &s.name, 1, &m("end_radius_drift"), "m", last_r - r0, note);
}

/// Harmonic spring: k = 100, m = 1, x0 = 1; by a force of the user, or by the engine's own field.
fn spring(rep: &mut Report, e: &dyn Engine, opt: &Opt, (tag, sub, pushed): (&str, Option<u32>, bool)) {
    let id = e.id();
    let note = format!("{} substeps", sub.unwrap_or(e.info().default_substeps));
    let dt = 0.01;
    let field = Field::Spring(100.0);
    let mut s = Scene { field: Some(field), pushed, ..scene::single("acc_spring", [0.0, 0.0], dt, sub) };
    s.bodies[0].x = 1.0;
    let period = std::f64::consts::TAU / 10.0;
    for periods in [10usize, 1000] {
        if opt.quick && periods > 10 {
            continue;
        }
        let steps = (periods as f64 * period / dt).round() as usize;
        let window = (period / dt).ceil() as usize;
        let mut w = e.build(&s);
        let mut amp: f64 = 0.0;
        let mut x = 1.0;
        for k in 0..steps {
            if pushed {
                w.push(0, field.force(x, 0.0).0, 0.0);
            }
            w.step();
            x = w.state(0).x;
            if k + window >= steps {
                amp = amp.max(x.abs());
            }
        }
        rep.one(id, &s.name, 1, &format!("amplitude_err_{periods}T@{tag}"), "1", amp - 1.0, note.clone());
    }
}
