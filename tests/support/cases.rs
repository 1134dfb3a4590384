//! How many cases proptest tries, and which.

use proptest::test_runner::{Config, RngSeed};

#[path = "seeds.rs"]
mod seeds;

#[allow(unused_imports, reason = "a program may have no other random inputs")]
pub(crate) use seeds::run_seed;

/// So many cases in an unoptimised and in an optimised build, the same in every run. `PROPTEST_CASES` is another number of them, and
/// `UMBRA_SEED` has others tried.
pub(crate) fn cases([unoptimised, optimised]: [u32; 2]) -> Config {
    let asked = std::env::var("PROPTEST_CASES").ok().map(|cases| cases.parse().expect("PROPTEST_CASES is a number"));
    let cases = asked.unwrap_or(if cfg!(debug_assertions) { unoptimised } else { optimised });
    // A failing case is repeated by its seed: no file keeps it.
    Config { cases, rng_seed: RngSeed::Fixed(run_seed(1)), failure_persistence: None, ..Config::default() }
}
