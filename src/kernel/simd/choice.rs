//! The choice of vector instructions when the program runs.

use core::sync::atomic::{AtomicU8, Ordering};

use super::{Avx2, Avx512, Job, Neon, Portable, Simd128};

/// A set of vector instructions, from narrow to wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VectorSet {
    /// No vector instructions.
    Portable,
    /// Two lanes of 64 bits, on little-endian `aarch64`.
    Neon,
    /// Two lanes of 64 bits, in builds for `wasm32` with the target feature `simd128`.
    Simd128,
    /// Four lanes of 64 bits, on x86-64.
    Avx2,
    /// Eight lanes of 64 bits, on x86-64. Only compilers from 1.89 on know them.
    Avx512,
}

/// The widest set that may be used.
static ALLOWED: AtomicU8 = AtomicU8::new(VectorSet::Avx512 as u8);

impl VectorSet {
    /// Returns true if the CPU has these instructions and this build can use them.
    ///
    /// A build for x86-64 with the feature `std` asks the CPU; without it, there is `Portable` alone. On other targets the build
    /// decides.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Neon => Neon::new().is_some(),
            Self::Simd128 => Simd128::new().is_some(),
            Self::Avx2 => Avx2::new().is_some(),
            Self::Avx512 => Avx512::new().is_some(),
        }
    }

    /// Returns the sets that are available, from narrow to wide.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Portable, Self::Neon, Self::Simd128, Self::Avx2, Self::Avx512]
            .into_iter()
            .filter(|set| set.is_available())
    }

    /// Allows no wider sets than this one in this process. They change no bit: tests show that with this switch, and benchmarks
    /// compare times.
    pub fn allow(widest: Self) {
        ALLOWED.store(widest as u8, Ordering::Relaxed);
    }

    /// Returns true if the switch allows these instructions.
    pub(crate) fn is_allowed(self) -> bool {
        self as u8 <= ALLOWED.load(Ordering::Relaxed)
    }

    /// Returns the set that is used: the widest one that is both allowed and available.
    ///
    /// ```
    /// use umbra_physics::scalar::internals::VectorSet;
    /// println!("vector instructions: {:?}", VectorSet::used()); // for a report of measurements
    /// assert!(VectorSet::available().all(|set| set.is_available()));
    /// VectorSet::allow(VectorSet::Portable);
    /// assert_eq!(VectorSet::used(), VectorSet::Portable);
    /// # VectorSet::allow(VectorSet::Avx512);
    /// ```
    #[must_use]
    pub fn used() -> Self {
        Self::available().filter(|set| set.is_allowed()).last().unwrap_or(Self::Portable)
    }
}

/// Runs a job with the widest vectors that the CPU has.
pub(crate) fn run<J: Job>(job: J) -> J::Result {
    run_with(VectorSet::used(), job)
}

/// Runs a job with a set of instructions, or without any if the set is not available.
pub(crate) fn run_with<J: Job>(set: VectorSet, job: J) -> J::Result {
    match (set, Neon::new(), Simd128::new(), Avx2::new(), Avx512::new()) {
        (VectorSet::Neon, Some(lanes), ..) => lanes.run(job),
        (VectorSet::Simd128, _, Some(lanes), ..) => lanes.run(job),
        (VectorSet::Avx2, .., Some(lanes), _) => lanes.run(job),
        (VectorSet::Avx512, .., Some(lanes)) => lanes.run(job),
        _ => job.run(Portable),
    }
}
