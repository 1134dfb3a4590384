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
fn cases() -> usize {
    crate::seeds::times(10_000)
}

/// Pairs that are compared with exact numbers.
fn exact_cases() -> usize {
    crate::seeds::times(2_000)
}
