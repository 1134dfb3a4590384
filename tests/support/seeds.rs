//! Where the random inputs of tests begin.

/// The seed of a generator: `usual`, the same in every run, or with `UMBRA_SEED` another one that depends on both.
pub(crate) fn run_seed(usual: u64) -> u64 {
    let Ok(run) = std::env::var("UMBRA_SEED") else { return usual };
    let run: u64 = run.parse().expect("UMBRA_SEED is a whole number");
    // An odd number of that size takes the seeds of two runs far apart.
    usual.wrapping_add(run.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}
