//! The narrow phase: against distances in floats, and against its own mirror images, quarter turns, swaps and renumberings.

#[path = "../support/random.rs"]
mod random;

mod accuracy;
mod extremes;
mod fairness;
mod features;
mod pairs;

/// Random pairs in a test.
const CASES: usize = if cfg!(debug_assertions) { 5_000 } else { 100_000 };
