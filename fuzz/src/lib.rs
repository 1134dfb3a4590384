//! The fuzz targets as functions of bytes: any bytes in place of all untrusted input.
//!
//! Each target is a function of bytes that panics where a promise is broken. libFuzzer calls it from `fuzz_targets`, and
//! `tests/corpus.rs` of the library, which includes this file, calls it on stable with all committed inputs.

pub mod author;
pub mod commands;
mod contact_scene;
pub mod contact_solver;
mod files;
pub mod fx_f64;
pub mod kernels;
mod pile;
pub mod queries;
pub mod replay;
pub mod scene;
pub mod snapshot;
pub mod tally;
pub mod threads;
pub mod work;

/// The number of things that a byte of an input asks for: from 1 to `few`, and for one byte in 16 from there to `max`. A world of many
/// takes the time of dozens of small ones, and what breaks mostly breaks among few.
const fn number(byte: u8, few: u8, max: u8) -> usize {
    match byte {
        0..240 => 1 + (byte % few) as usize,
        _ => few as usize + (byte - 239) as usize * (max - few) as usize / 16,
    }
}

#[path = "../../tests/support/reference.rs"]
#[allow(dead_code, reason = "the tests of accuracy use all of it")]
mod reference;

/// The name of a target, and the function that runs an input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 10] = [
    ("commands", commands::run),
    ("contact_solver", contact_solver::run),
    ("fx_f64", fx_f64::run),
    ("kernels", kernels::run),
    ("queries", queries::run),
    ("replay", replay::run),
    ("scene", scene::run),
    ("snapshot", snapshot::run),
    ("threads", threads::run),
    ("work", work::run),
];
