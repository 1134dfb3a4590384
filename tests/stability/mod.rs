//! Stability under stress: the stiffest springs, the largest mass ratios, the slowest and the fastest steps and speeds,
//! ten million steps, chaos. Beside what has to hold stands what must fail the same test: explicit Euler, singles or
//! doubles.

#[path = "../support/random.rs"]
mod random;
#[path = "../support/real.rs"]
mod real;

mod chaos;
mod limit;
mod long;
mod masses;
mod momentum;
mod rates;
mod scene;
mod speeds;
