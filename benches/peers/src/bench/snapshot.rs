//! Saving a world, going back to it, and the steps of a rollback.

use super::{Engines, Opt, heap_bytes, now};
use crate::engine::World;
use crate::report::Report;
use crate::scene::{self, Scene};

pub fn snapshot(rep: &mut Report, engines: Engines, opt: &Opt) {
    for (name, scene) in [("snapshot_free", scene::free(1_000)), ("snapshot", scene::rain(1_000))] {
        snapshot_of(rep, engines, opt, Scene { name: name.into(), ..scene });
    }
}

fn snapshot_of(rep: &mut Report, engines: Engines, opt: &Opt, s: Scene) {
    const WORLDS: usize = 4;
    struct Job {
        e: usize,
        kind: usize,
        name: &'static str,
        snap: Vec<f64>,
        restore: Vec<f64>,
        plain: Vec<f64>,
        roll: Vec<f64>,
        bytes: f64,
        exact: bool,
    }
    // WORLDS worlds of each engine, all at the same step.
    type Pile = (usize, Vec<Box<dyn World>>, usize);
    let mut piles: Vec<Pile> = Vec::new();
    for (i, e) in engines.iter().enumerate() {
        if let Some(why) = e.refuse(&s) {
            rep.skip(e.id(), &s.name, s.n, &why);
            continue;
        }
        let mut ws: Vec<Box<dyn World>> = (0..WORLDS).map(|_| e.build(&s)).collect();
        let t = now();
        let mut done = 0;
        while done < 300 && (now() - t < 5.0 || done < 1) {
            for w in &mut ws {
                w.step();
            }
            done += 1;
        }
        piles.push((i, ws, done));
    }
    let mut jobs = Vec::new();
    for (e, ws, _) in &piles {
        for (kind, name) in ws[0].snapshot_kinds().iter().enumerate() {
            jobs.push(Job {
                e: *e,
                kind,
                name,
                snap: vec![],
                restore: vec![],
                plain: vec![],
                roll: vec![],
                bytes: 0.0,
                exact: true,
            });
        }
    }
    let rounds = if opt.quick { 2 } else { 7 };
    for round in 0..rounds {
        for j in &mut jobs {
            let (_, ws, _) = piles.iter_mut().find(|p| p.0 == j.e).unwrap();
            // Snapshot every world, then restore every world: each is cold again.
            let mut snaps = Vec::new();
            let heap = heap_bytes();
            for w in ws.iter_mut() {
                let t = now();
                let sn = w.snapshot(j.kind);
                j.snap.push((now() - t) * 1e6);
                snaps.push(sn);
            }
            let grown = heap_bytes().saturating_sub(heap) / WORLDS;
            // The first round is the one that allocates where memory is used again.
            j.bytes = j.bytes.max(snaps[0].bytes.unwrap_or(grown) as f64);
            for (w, sn) in ws.iter_mut().zip(&snaps) {
                let t = now();
                w.restore(j.kind, sn);
                j.restore.push((now() - t) * 1e6);
            }
            if round >= 3 && j.roll.iter().sum::<f64>() > 4e6 {
                continue;
            }
            // Rollback: 8 steps ahead, back, 8 steps again, and compare the bits.
            let w = &mut ws[0];
            let sn = w.snapshot(j.kind);
            let t = now();
            for _ in 0..8 {
                w.step();
            }
            j.plain.push((now() - t) * 1e6);
            let ahead = w.hash();
            let t = now();
            w.restore(j.kind, &sn);
            for _ in 0..8 {
                w.step();
            }
            j.roll.push((now() - t) * 1e6);
            j.exact &= w.hash() == ahead;
            w.restore(j.kind, &sn);
        }
    }
    for j in &jobs {
        let id = engines[j.e].id();
        let done = piles.iter().find(|p| p.0 == j.e).unwrap().2;
        let cut = if done < 300 { format!("first {done} of 300 steps; ") } else { String::new() };
        let note = |extra: &str| format!("{cut}{}{extra}", j.name);
        let name = if j.kind == 0 { s.name.clone() } else { format!("{}_alt", s.name) };
        rep.one(id, &name, s.n, "bytes", "B", j.bytes, note(""));
        rep.add(id, &name, s.n, "snapshot", "us", &j.snap, note(""));
        rep.add(id, &name, s.n, "restore", "us", &j.restore, note(""));
        rep.add(id, &name, s.n, "steps8", "us", &j.plain, note("; 8 steps without a restore"));
        rep.add(id, &name, s.n, "rollback8", "us", &j.roll, note("; restore + 8 steps"));
        rep.one(id, &name, s.n, "rollback_bit_exact", "bool", j.exact as u8 as f64, note(""));
    }
}
