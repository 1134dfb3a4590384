//! The measurements. Time is taken around `World::step` only; engines take turns.

mod accuracy;
mod contacts;
mod crowds;
mod geometry;
mod impacts;
mod joined;
mod memory;
mod passes;
mod quality;
mod rays;
mod snapshot;
mod stages;
mod steady;
mod threads;

pub use accuracy::accuracy;
pub use contacts::{pyramid, rain};
pub use crowds::{hopper, hourglass, many_pyramids, polygons, rooms, settling, spinner, tiles};
pub use impacts::impacts;
pub use joined::{joint_errors, joint_grid, joints, motor_spinner, ragdolls, tumbler};
pub use memory::{mem_child, memory};
pub use passes::passes;
pub use quality::{names as quality_names, quality};
pub use rays::rays;
pub use snapshot::snapshot;
pub use stages::stages;
pub use steady::{free, free_static, sleeping};
pub use threads::threads;

use crate::engine::{Engine, World};
use crate::report::Report;
use crate::scene::Scene;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

pub type Engines<'a> = &'a [&'a dyn Engine];

pub struct Opt {
    pub quick: bool,
    /// The parts of a scene that are wanted; empty: all.
    pub parts: Vec<String>,
}

/// Wall clock, for the caps.
fn secs(t: Instant) -> f64 {
    t.elapsed().as_secs_f64()
}

/// `--wall` measures with the wall clock; the default is the CPU time of this
/// thread, which does not count the time that other jobs had the core.
pub static WALL: AtomicBool = AtomicBool::new(false);

/// The clock of every reported time, in seconds.
fn now() -> f64 {
    let id = if WALL.load(Ordering::Relaxed) { libc::CLOCK_MONOTONIC } else { libc::CLOCK_THREAD_CPUTIME_ID };
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    unsafe { libc::clock_gettime(id, &mut t) };
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

fn heap_bytes() -> usize {
    let m = unsafe { libc::mallinfo2() };
    m.uordblks + m.hblkhd
}

/// Gives bodies the velocities that the scene has for this step.
fn kick(s: &Scene, w: &mut dyn World, step: usize) {
    for kick in s.kicks_at(step) {
        w.set_velocity(kick.body, [kick.vx, kick.vy, kick.w]);
    }
}

/// Builds the scene in every engine that accepts it.
fn build_all(rep: &mut Report, engines: Engines, s: &Scene) -> Vec<(usize, Box<dyn World>)> {
    let mut v = Vec::new();
    for (i, e) in engines.iter().enumerate() {
        match e.refuse(s) {
            Some(why) => rep.skip(e.id(), &s.name, s.n, &why),
            None => {
                let w = e.build(s);
                assert_eq!(w.body_count(), s.bodies.len());
                v.push((i, w));
            }
        }
    }
    v
}
