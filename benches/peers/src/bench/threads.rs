//! Threads against time, by the wall clock: one large pile, many islands, a small scene, and many worlds at once.

use super::{Engines, Opt, WALL, build_all, now};
use crate::report::Report;
use crate::scene::{self, Scene};
use std::ops::Range;
use std::sync::atomic::Ordering;

pub fn threads(rep: &mut Report, engines: Engines, opt: &Opt) {
    let is_wall = WALL.swap(true, Ordering::Relaxed);
    let awake = |name: &str, s: Scene| Scene { name: format!("threads_{name}"), sleep: false, ..s };
    let count = if opt.quick { 50 } else { 200 };
    step_in_turn(rep, engines, &awake("pile", scene::rain(4_000)), 600..600 + count);
    step_in_turn(rep, engines, &awake("islands", scene::many_pyramids(8)), 20..20 + count);
    step_in_turn(rep, engines, &awake("room", scene::room(0, 0)), 60..60 + 10 * count);
    #[cfg(feature = "threads")]
    worlds(rep, count);
    WALL.store(is_wall, Ordering::Relaxed);
}

/// Steps the worlds of all engines in turn, and reports the time of these steps.
fn step_in_turn(rep: &mut Report, engines: Engines, s: &Scene, steps: Range<usize>) {
    let mut worlds = build_all(rep, engines, s);
    let mut times = vec![Vec::with_capacity(steps.len()); worlds.len()];
    for step in 0..steps.end {
        for ((_, world), times) in worlds.iter_mut().zip(&mut times) {
            let start = now();
            world.step();
            if steps.contains(&step) {
                times.push((now() - start) * 1e6);
            }
        }
    }
    for ((engine, world), times) in worlds.iter().zip(&times) {
        let note = format!("end state {:016x}", world.hash());
        rep.add(engines[*engine].id(), &s.name, s.n, "step", "us", times, note);
    }
}

/// 64 rooms of 30 crates, stepped by one call.
#[cfg(feature = "threads")]
fn worlds(rep: &mut Report, count: usize) {
    use crate::engines::umbra;
    use umbra_physics::{Fx, step_all};

    const WORLDS: usize = 64;
    for threads in [1, 2, 3, 8] {
        let Some(pool) = umbra::pool(threads) else { continue };
        let build = umbra::Build::<Fx>::new();
        let mut worlds: Vec<_> =
            (0..WORLDS).map(|number| build.place(&Scene { sleep: false, ..scene::room(number, 0) }).world).collect();
        let mut times = Vec::with_capacity(count);
        for step in 0..60 + count {
            let start = now();
            pool.install(|| step_all(&mut worlds));
            if step >= 60 {
                times.push((now() - start) * 1e6);
            }
        }
        let note = format!("end state of the first one {:016x}", worlds[0].state_hash());
        rep.add(&format!("umbra-fx@threads={threads}"), "threads_worlds", WORLDS, "step_all", "us", &times, note);
    }
}
