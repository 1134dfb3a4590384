//! The tests of the engine, a subject a file or a folder, as one program: each program links the engine once more.
//! One subject alone: `cargo test --release --all-features --test engine -- closure::`.
#![allow(clippy::duplicate_mod, reason = "each file takes in what it needs of `support` by itself")]
#![allow(clippy::module_inception, reason = "and may be named after it")]

#[path = "support/seeds.rs"]
mod seeds;

mod accuracy;
mod attraction;
mod bodies;
mod cached;
mod caps;
mod closure;
mod commands;
mod disabled;
#[cfg(feature = "float")]
mod display;
#[cfg(feature = "float")]
mod energy;
mod envelope;
mod errors;
mod exact_time;
mod friction;
mod fx;
#[cfg(feature = "serde")]
mod fx_serde;
mod goals;
#[cfg(feature = "selftest")]
mod golden;
mod locks;
mod looking;
mod mass;
mod netcode;
mod order;
mod outlines;
mod pacing;
mod paths;
#[cfg(feature = "selftest")]
mod promises;
mod random;
mod readers;
mod reverse;
mod rollback;
#[cfg(feature = "serde")]
mod serde;
mod snapshot;
#[cfg(feature = "float")]
mod stability;
mod tables;
#[cfg(feature = "timers")]
mod timers;
mod trace;
mod vectors;
