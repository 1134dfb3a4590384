//! How many cases proptest tries, and which.

use proptest::test_runner::{Config, RngSeed};

#[path = "seeds.rs"]
mod seeds;

#[allow(unused_imports, reason = "a program may have no other random inputs")]
pub(crate) use seeds::{is_short, run_seed, times};

/// So many cases by day, the same in every run. `UMBRA_TIMES` has more of them tried, and `UMBRA_SEED` others.
pub(crate) fn cases(by_day: u32) -> Config {
    // A failing case is repeated by its seed: no file keeps it.
    Config {
        cases: times(by_day),
        rng_seed: RngSeed::Fixed(run_seed(1)),
        failure_persistence: None,
        ..Config::default()
    }
}
