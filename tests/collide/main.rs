//! The narrow phase: against manifolds in exact numbers, distances in floats, and its own mirror images, quarter turns, swaps and
//! renumberings.

#[path = "../support/random.rs"]
mod random;

mod accuracy;
mod exact;
mod extremes;
mod fairness;
mod features;
mod pairs;

/// Random pairs in a test.
const CASES: usize = if cfg!(debug_assertions) { 5_000 } else { 100_000 };

/// Pairs that are compared with exact numbers: as many as `UMBRA_INPUTS` says, a million at leisure.
fn exact_cases() -> usize {
    let asked = std::env::var("UMBRA_INPUTS").ok().map(|count| count.parse().expect("a number"));
    asked.unwrap_or(if cfg!(debug_assertions) { 2_000 } else { 20_000 })
}
