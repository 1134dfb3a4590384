//! The time of each part of a step, as each engine's own clock measures it.

use std::time::Instant;

use super::{Engines, Opt, build_all};
use crate::engine::PARTS;
use crate::report::Report;
use crate::scene::{self, Scene};

/// The parts, and the rest of the step.
const TIMES: usize = PARTS.len() + 1;

/// The mean of each part over some steps of a run. Of each step and part the least time of several runs counts, as all of them come to the
/// same states, and engines take turns within a step: what else the machine does is left out, or meets all of them.
pub fn stages(rep: &mut Report, engines: Engines, opt: &Opt) {
    let scenes = [
        (scene::pyramid(40), 0..300),
        (scene::rain(1_000), 0..600),
        (scene::spinner(3_000), 0..200),
        // At rest; nobody sleeps in these scenes.
        (scene::mixed(1_000), 600..700),
    ];
    for (s, steps) in scenes {
        let s = Scene { name: format!("stages_{}", s.name), ..s };
        let mut worlds = build_all(rep, engines, &s);
        worlds.retain(|(i, w)| {
            let is_measured = w.part_times().is_some();
            if !is_measured {
                rep.skip(engines[*i].id(), &s.name, s.n, "measures no parts, or is built without the feature `timers`");
            }
            is_measured
        });
        let mut least = vec![vec![[f64::INFINITY; TIMES]; steps.end]; worlds.len()];
        for _ in 0..if opt.quick { 2 } else { 4 } {
            for (i, w) in &mut worlds {
                *w = engines[*i].build(&s);
            }
            for step in 0..steps.end {
                for ((_, w), least) in worlds.iter_mut().zip(&mut least) {
                    let start = Instant::now();
                    w.step();
                    let whole = start.elapsed().as_secs_f64() * 1e6;
                    let parts = w.part_times().expect("the engine measured them before");
                    let rest = whole - parts.iter().sum::<f64>();
                    for (least, time) in least[step].iter_mut().zip(parts.into_iter().chain([rest])) {
                        *least = least.min(time);
                    }
                }
            }
        }
        for ((i, _), least) in worlds.iter().zip(&least) {
            let least = &least[steps.clone()];
            let mean = |time: usize| least.iter().map(|times| times[time]).sum::<f64>() / least.len() as f64;
            let mut row = |part: &str, value: f64| rep.one(engines[*i].id(), &s.name, s.n, part, "us", value, "");
            PARTS.iter().chain(&["rest"]).enumerate().for_each(|(time, part)| row(part, mean(time)));
            row("step", (0..TIMES).map(mean).sum());
        }
    }
}
