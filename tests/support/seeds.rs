//! Where the random inputs of tests begin, and how many there are.
#![allow(dead_code, reason = "each program of tests takes what it needs")]

use std::ops::Mul;

/// The seed of a generator: `usual`, the same in every run, or with `UMBRA_SEED` another one that depends on both.
pub(crate) fn run_seed(usual: u64) -> u64 {
    let Ok(run) = std::env::var("UMBRA_SEED") else { return usual };
    let run: u64 = run.parse().expect("UMBRA_SEED is a whole number");
    // An odd number of that size takes the seeds of two runs far apart.
    usual.wrapping_add(run.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// A number of cases or steps: by day as given, and with `UMBRA_TIMES` so many times that. `.ci/nightly` sets it to 10.
pub(crate) fn times<T: Mul<Output = T> + From<u16>>(by_day: T) -> T {
    let times = std::env::var("UMBRA_TIMES").map_or(1, |times| times.parse().expect("UMBRA_TIMES is below 65,536"));
    by_day * T::from(times)
}

/// Returns true by day, without `UMBRA_TIMES`: a scene runs a part of its time, or a test some of its scenes.
pub(crate) fn is_short() -> bool {
    times(1u16) == 1
}
