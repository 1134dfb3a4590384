//! Stability under stress: the largest mass ratios, ten million steps. Beside what has to hold stands what must fail the same test: explicit Euler, singles or doubles.

#[path = "../support/random.rs"]
mod random;
#[path = "../support/real.rs"]
mod real;

mod long;
mod masses;
mod momentum;
mod scene;

/// Unoptimised builds run a part.
const QUICK: bool = cfg!(debug_assertions);
