//! Vectors of lanes for the loops that solve contacts, and the choice among them when the program runs.
//!
//! A loop is written once, generic over [`Lanes`], as a [`Job`]; [`run`] compiles it for each set of instructions of the target and calls
//! the widest one that the CPU has. Every implementation computes the same bits: they differ in the number of lanes alone, which is 1 in
//! portable code, 2 with NEON and with SIMD128 of WebAssembly, 4 with AVX2 and 8 with AVX-512.
//!
//! There are two kinds of vectors. A *narrow* vector holds 32-bit integers, a *wide* one 64-bit integers. Where both take 64 bits
//! a lane, the upper half of a narrow lane is arbitrary: each operation on narrow vectors reads the lower halves only, as the widening
//! product of the CPU does.
//!
//! The unit tests of this module and of `solve` compare the sets that a target has with [`Portable`]; on x86-64
//! `cargo test` runs them. For NEON, where rustup has added the target, and qemu and the C compiler of the target are installed:
//!
//! ```sh
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64-static -L /usr/aarch64-linux-gnu"
//! cargo test --release --lib --target aarch64-unknown-linux-gnu -- kernel::simd solve
//! ```
//!
//! For WebAssembly the target is `wasm32-wasip1`, the runner `node --no-warnings tests/wasi.mjs`, and `RUSTFLAGS` are
//! `-Ctarget-feature=+simd128`. `tests/cross.sh` runs scenes of contacts on both.
//!
//! This file and those beneath it are the only ones in the crate that may say `unsafe`: the instructions may be called on a
//! CPU that has them, which [`run`] makes sure of. A value of a type that implements [`Lanes`] is the proof of that.

mod absent;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod avx512;
mod choice;
#[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
mod neon;
mod portable;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;

#[cfg(not(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little")))]
pub(crate) use absent::Absent as Neon;
#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
pub(crate) use absent::Absent as Simd128;
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
pub(crate) use absent::{Absent as Avx2, Absent as Avx512};
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub(crate) use avx2::Avx2;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub(crate) use avx512::Avx512;
pub use choice::VectorSet;
pub(crate) use choice::run;
#[cfg(test)]
pub(crate) use choice::run_with;
#[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
pub(crate) use neon::Neon;
pub(crate) use portable::Portable;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) use simd128::Simd128;

/// The number of contacts in a group: the lanes of the widest vector.
pub(crate) const GROUP: usize = 8;

/// Fraction bits of a [`Gain`].
pub(crate) const GAIN_BITS: i32 = 30;

/// Two values for each lane of a group: together they fill 64 bits.
pub(crate) type Pairs = [[i32; 2]; GROUP];

/// The motion of a body within a step: velocity (x, y, angular) and the angle turned; the displacement (x, y, and once more the
/// angle); the sum of changes of the velocity in a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(64))]
pub(crate) struct Row {
    pub(crate) velocity: [i32; 4],
    pub(crate) displacement: [i32; 4],
    pub(crate) gain: Gain,
}

/// Velocities and displacements of one body in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Gathered<N> {
    pub(crate) velocity: [N; 3],
    /// Displacement (x, y) and angle.
    pub(crate) displacement: [N; 3],
}

/// The sum of the velocity changes of a body in a phase (x, y, angular), and the rest of those before, in 2^-[`GAIN_BITS`];
/// the fourth word is zero.
pub(crate) type Gain = [i64; 4];

/// A set of vector instructions.
///
/// *Domain* of each operation: sums and differences of narrow values fit in 32 bits, of wide ones in 64, and `at` is a multiple of
/// [`WIDTH`](Lanes::WIDTH) below [`GROUP`].
pub(crate) trait Lanes: Copy {
    /// The number of lanes: a divisor of [`GROUP`].
    const WIDTH: usize;
    /// A vector of 32-bit integers.
    type Narrow: Copy;
    /// A vector of 64-bit integers.
    type Wide: Copy;
    /// The set that handles single bodies.
    type Quads: Quads;

    fn quads(self) -> Self::Quads;

    fn pair(self, pairs: &Pairs, at: usize) -> (Self::Narrow, Self::Narrow);
    fn put_pair(self, pairs: &mut Pairs, at: usize, values: (Self::Narrow, Self::Narrow));
    fn wide(self, words: &[i64; GROUP], at: usize) -> Self::Wide;
    fn store(self, words: &mut [i64; GROUP], at: usize, value: Self::Wide);
    fn splat(self, value: i32) -> Self::Narrow;

    fn plus(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn minus(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn at_least(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn at_most(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    /// `a` where `c` is positive, else `b`.
    fn if_positive(self, c: Self::Narrow, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    /// Returns true if no lane of either is positive.
    fn none_positive(self, a: Self::Narrow, b: Self::Narrow) -> bool;
    /// The product, exact.
    fn times(self, a: Self::Narrow, b: Self::Narrow) -> Self::Wide;

    fn add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn sub(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// The lower half.
    fn low(self, a: Self::Wide) -> Self::Narrow;
    /// `a` where `c` is negative, else `b`.
    fn if_negative(self, c: Self::Wide, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// a, or 0 where a is negative.
    fn positive(self, a: Self::Wide) -> Self::Wide;
    /// a within ±limit. *Domain* limit ≥ 0.
    fn clamped(self, a: Self::Wide, limit: Self::Wide) -> Self::Wide;
    /// a, or 2^31 − 1 where a is larger. *Domain* a ≥ 0.
    fn capped(self, a: Self::Wide) -> Self::Narrow;
    /// floor(a / 2^BITS).
    fn floored<const BITS: i32>(self, a: Self::Wide) -> Self::Wide;
    /// floor(a / 2^bits) with the shift of each lane. *Domain* 0 ≤ bits < 64.
    fn floored_by(self, a: Self::Wide, bits: Self::Wide) -> Self::Wide;
    /// a / 2^30 to nearest, ties upwards.
    fn rounded(self, a: Self::Wide) -> Self::Narrow;
    /// a / 2^BITS to nearest, ties away from zero.
    fn rounded_oddly<const BITS: i32>(self, a: Self::Wide) -> Self::Wide;
    /// a · 2^bits with the shift of each lane. *Domain* the result fits.
    fn raised_by(self, a: Self::Wide, bits: Self::Wide) -> Self::Wide;
    /// factor·load / 2^26 to nearest, ties upwards. *Domain* 0 ≤ load < 2^58, factor ≥ 0.
    fn share(self, factor: Self::Narrow, load: Self::Wide) -> Self::Wide;
    /// Returns true if all lanes are zero.
    fn is_zero(self, a: Self::Wide) -> bool;
    /// Returns true if a lane is at or beyond ±2^30.
    fn is_beyond(self, a: Self::Wide) -> bool;
    /// Returns true if a lane of `any` is outside of −2^30 to 2^30 − 1, or one of `low` is below −2^31.
    fn are_beyond(self, any: [Self::Wide; 2], low: [Self::Wide; 2]) -> bool;
    /// Returns true if no lane of `impulses` is negative and all of `changes` are from −2^30 to 2^30 − 1.
    fn are_pushes(self, impulses: [Self::Wide; 2], changes: [Self::Wide; 2]) -> bool;

    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<Self::Narrow>;
    /// Adds a change of velocity to the sums of bodies, one lane after the other.
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, change: [Self::Wide; 3]);
}

/// Operations on one body, with the domain that those of [`Lanes`] have.
pub(crate) trait Quads: Copy {
    /// The components of a body, 32-bit integers.
    type Quad: Copy;

    fn quad(self, words: &[i32; 4]) -> Self::Quad;
    fn put(self, words: &mut [i32; 4], value: Self::Quad);
    fn quad_plus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn quad_minus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    /// a within ±limit.
    fn quad_clamped(self, a: Self::Quad, limit: i32) -> Self::Quad;
    /// a·share / 2^30, each component to nearest, ties away from zero. *Domain* 0 ≤ share ≤ 2^30.
    fn quad_share(self, a: Self::Quad, share: i32) -> Self::Quad;
    /// The first three components of `a`, and the last one of `b`.
    fn quad_joined(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;

    /// Adds the sums of velocity changes to the velocity of a body, each rounded to nearest, ties away from zero, and keeps
    /// the rest. Returns false, and changes nothing, if a component leaves the range of −limit to limit − 1. *Domain* the
    /// limit is a power of two, at most 2^30.
    fn take_gain(self, row: &mut Row, limit: i32) -> bool;
}

/// The part of a group that a vector holds.
#[inline(always)]
#[allow(dead_code, reason = "portable code has parts of one lane")]
fn part<T, const N: usize>(words: &[T; GROUP], at: usize) -> &[T; N] {
    words[at..at + N].try_into().expect("a part of a group")
}

/// The part of a group that a vector is stored in.
#[inline(always)]
#[allow(dead_code, reason = "portable code has parts of one lane")]
fn part_mut<T, const N: usize>(words: &mut [T; GROUP], at: usize) -> &mut [T; N] {
    (&mut words[at..at + N]).try_into().expect("a part of a group")
}

/// A loop over lanes.
pub(crate) trait Job {
    type Result;
    fn run<L: Lanes>(self, lanes: L) -> Self::Result;
}

#[cfg(test)]
mod tests;
