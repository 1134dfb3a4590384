//! Crowds, run from their start, with what is wrong with their end state beside the time.

use super::contacts::{Quality, runs};
use super::geometry::{joint_gap, kinetic, overlap};
use super::{Engines, Opt, kick, now};
use crate::engine::{State, World};
use crate::report::Report;
use crate::scene::{self, Kind, Scene};

/// The longest time of a run, s.
const CAP: f64 = 30.0;

/// The end state of a scene whose dynamic bodies stay in a region.
fn quality(s: &Scene, w: &dyn World, is_inside: impl Fn(&State) -> bool) -> Quality {
    let states: Vec<State> = (0..s.bodies.len()).map(|i| w.state(i)).collect();
    let dynamic = || s.bodies.iter().zip(&states).filter(|(b, _)| b.kind == Kind::Dynamic);
    let count = dynamic().count();
    // NaN is outside.
    let escaped = dynamic().filter(|(_, q)| !is_inside(q)).count();
    let mut rows = vec![
        ("escaped", "bodies", escaped as f64),
        ("overlap_end", "m", overlap(s, &states)),
        ("kinetic_per_body", "J", kinetic(s, &states) / count as f64),
    ];
    if !s.joints.is_empty() {
        rows.push(("max_joint_gap", "m", joint_gap(s, &states)));
    }
    if let Some(awake) = w.awake().filter(|_| s.sleep) {
        rows.push(("awake_end", "bodies", awake as f64));
    }
    Quality { rows, bad: (escaped > count / 50).then_some("bodies left their place") }
}

/// A run of so many steps, and of so many where it is quick.
pub(super) fn crowd(
    rep: &mut Report,
    engines: Engines,
    opt: &Opt,
    s: &Scene,
    steps: [usize; 2],
    is_inside: impl Fn(&State) -> bool,
) {
    let (steps, repeats) = if opt.quick { (steps[1], 1) } else { (steps[0], 2) };
    runs(rep, engines, s, steps, repeats, CAP, &|s, w| quality(s, w, &is_inside));
}

pub fn many_pyramids(rep: &mut Report, engines: Engines, opt: &Opt) {
    let side = 10;
    let s = scene::many_pyramids(side);
    let tops: Vec<usize> = (1..=side * side).map(|k| k * 55 + k.div_ceil(side) - 1).collect();
    let (steps, repeats) = if opt.quick { (120, 1) } else { (300, 2) };
    runs(rep, engines, &s, steps, repeats, CAP, &|s, w| {
        let stands = |&&top: &&usize| {
            let (b, q) = (&s.bodies[top], w.state(top));
            (b.x - q.x).abs() < 0.5 && (b.y - q.y).abs() < 0.5
        };
        let fallen = tops.len() - tops.iter().filter(stands).count();
        let mut quality = quality(s, w, |q| q.y > -1.0);
        quality.rows.push(("fallen", "pyramids", fallen as f64));
        Quality { bad: (fallen > 0).then_some("pyramids did not stand"), ..quality }
    });
}

pub fn spinner(rep: &mut Report, engines: Engines, opt: &Opt) {
    crowd(rep, engines, opt, &scene::spinner(3_000), [600, 120], |q| q.x.hypot(q.y) < scene::RING + 0.5);
}

pub fn hourglass(rep: &mut Report, engines: Engines, opt: &Opt) {
    let steps = 900;
    let [hx, hy] = scene::HOURGLASS;
    // The end state in the axes of the hourglass, which is run to its end or cut.
    crowd(rep, engines, opt, &scene::hourglass(2_000, steps), [steps, 120], |q| q.x.hypot(q.y) < hx.hypot(hy));
}

pub fn hopper(rep: &mut Report, engines: Engines, opt: &Opt) {
    crowd(rep, engines, opt, &scene::hopper(2_000), [900, 120], |q| q.y > -0.5 && q.x.abs() < 21.0);
}

pub fn polygons(rep: &mut Report, engines: Engines, opt: &Opt) {
    let s = scene::polygons(1_000);
    let half_width = scene::container_half_width(s.n);
    crowd(rep, engines, opt, &s, [600, 120], |q| q.y > -0.5 && q.x.abs() < half_width + 0.5);
}

pub fn tiles(rep: &mut Report, engines: Engines, opt: &Opt) {
    let half_width = scene::COLUMNS as f64 / 2.0;
    crowd(rep, engines, opt, &scene::tiles(100_000), [600, 120], |q| q.y > -5.0 && q.x.abs() < half_width + 0.5);
}

pub fn settling(rep: &mut Report, engines: Engines, opt: &Opt) {
    let s = scene::settling(10_000);
    let half_width = scene::container_half_width(s.n);
    let (steps, cap) = if opt.quick { (60, CAP) } else { (900, CAP) };
    runs(rep, engines, &s, steps, 1, cap, &|s, w| quality(s, w, |q| q.y > -0.5 && q.x.abs() < half_width + 0.5));
}

/// 100 worlds of a room each, in turn, as a server steps them: each comes back to a cold cache.
pub fn rooms(rep: &mut Report, engines: Engines, opt: &Opt) {
    let steps = if opt.quick { 120 } else { 600 };
    let scenes: Vec<Scene> = (0..100).map(|number| scene::room(number, steps)).collect();
    for e in engines {
        if let Some(why) = e.refuse(&scenes[0]) {
            rep.skip(e.id(), &scenes[0].name, scenes.len(), &why);
            continue;
        }
        let mut samples = Vec::new();
        let (mut outside, mut awake) = (0, 0);
        for _ in 0..if opt.quick { 1 } else { 3 } {
            let mut worlds: Vec<_> = scenes.iter().map(|s| e.build(s)).collect();
            let mut time = 0.0;
            for step in 0..steps {
                for (s, w) in scenes.iter().zip(&mut worlds) {
                    kick(s, w.as_mut(), step);
                }
                let t = now();
                worlds.iter_mut().for_each(|w| w.step());
                time += now() - t;
            }
            samples.push(time * 1e6 / (steps * scenes.len()) as f64);
            let states = worlds.iter().flat_map(|w| (3..w.body_count()).map(|i| w.state(i)));
            outside = states.filter(|q| !(q.y > -0.5 && q.x.abs() < 10.5)).count();
            awake = worlds.iter().filter_map(|w| w.awake()).sum();
        }
        let note = if outside > 60 { "INVALID: crates left their rooms" } else { "" };
        rep.add(e.id(), &scenes[0].name, scenes.len(), "room_step", "us", &samples, note);
        rep.one(e.id(), &scenes[0].name, scenes.len(), "escaped", "bodies", outside as f64, note);
        rep.one(e.id(), &scenes[0].name, scenes.len(), "awake_end", "bodies", awake as f64, note);
    }
}
