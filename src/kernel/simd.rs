//! Vectors of lanes for the loops that solve contacts and loops of pins, and the choice among them when the program runs.
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
mod long;
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

/// The number of contacts, or of pins, in a group: the lanes of the widest vector.
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

/// Eight words of 64 bits that lanes read by [`words_of`](Lanes::words_of): a line of the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(64))]
pub(crate) struct Line(pub(crate) [i64; 8]);

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

/// Velocities of a body along x and y and around; the fourth word is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(32))]
pub(crate) struct Speeds(pub(crate) [i64; 4]);

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
    /// A yes or no for each lane.
    type Mask: Copy;
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
    /// The product of numbers without signs. *Domain* it is below 2^63.
    fn times_unsigned(self, a: Self::Narrow, b: Self::Narrow) -> Self::Wide;

    fn add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn sub(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// The lower half.
    fn low(self, a: Self::Wide) -> Self::Narrow;
    /// The lower half of floor(a / 2^BITS). *Domain* BITS ≤ 32.
    fn narrowed<const BITS: i32>(self, a: Self::Wide) -> Self::Narrow;
    /// a mod 2^BITS. *Domain* BITS < 63.
    fn rest<const BITS: i32>(self, a: Self::Wide) -> Self::Wide;
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
    /// ⌊(2^60 − 1) / d⌋. *Domain* 2^30 ≤ d < 2^31.
    ///
    /// # Ranges
    /// With q = (2^60 − 1) / d the line is within q/17. A step squares the relative error and rounds twice: after two steps it is below
    /// 2^-16.2, E = (2^60 − 1) − d·x is within 2^44, and the third step, which rounds down, leads to between q − 1.2 and q: to the floor or
    /// to one below it. Products are within 2^61.
    #[inline(always)]
    fn reciprocal(self, d: Self::Narrow) -> Self::Narrow {
        let numerator = self.all((1 << 60) - 1);
        // 48/17 − 32/17·d for d from 1/2 to 1, in 2^-29.
        let line = self.low(self.floored::<31>(self.times(self.splat(1_010_580_540), d)));
        let mut x = self.minus(self.splat(1_515_870_810), line);
        for _ in 0..2 {
            let error = self.rounded(self.sub(numerator, self.times(d, x)));
            x = self.plus(x, self.rounded(self.times(x, error)));
        }
        let error = self.low(self.floored::<14>(self.sub(numerator, self.times(d, x))));
        x = self.plus(x, self.low(self.floored::<46>(self.times(x, error))));
        let next = self.plus(x, self.splat(1));
        // One less where that is beyond the quotient.
        self.plus(next, self.low(self.floored::<63>(self.sub(numerator, self.times(d, next)))))
    }
    /// a / 2^30 to nearest, ties upwards.
    fn rounded(self, a: Self::Wide) -> Self::Narrow;
    /// a / 2^BITS to nearest, ties away from zero.
    fn rounded_oddly<const BITS: i32>(self, a: Self::Wide) -> Self::Wide;
    /// a · 2^bits with the shift of each lane. *Domain* the result fits.
    fn raised_by(self, a: Self::Wide, bits: Self::Wide) -> Self::Wide;
    /// factor·load / 2^26 to nearest, ties upwards. *Domain* 0 ≤ load < 2^58, factor ≥ 0.
    fn share(self, factor: Self::Narrow, load: Self::Wide) -> Self::Wide;
    /// The number in all lanes.
    fn all(self, value: i64) -> Self::Wide;
    /// The number of bits of a number: 0 for 0, 1 for 1, 2 for 2 and 3. *Domain* a ≥ 0.
    fn bit_length(self, a: Self::Wide) -> Self::Wide;

    /// a > b.
    fn greater(self, a: Self::Wide, b: Self::Wide) -> Self::Mask;
    /// a = b.
    fn equal(self, a: Self::Wide, b: Self::Wide) -> Self::Mask;
    fn both(self, m: Self::Mask, n: Self::Mask) -> Self::Mask;
    fn either(self, m: Self::Mask, n: Self::Mask) -> Self::Mask;
    /// m, and not n.
    fn unless(self, m: Self::Mask, n: Self::Mask) -> Self::Mask;
    /// Either m or n, and not both.
    fn unlike(self, m: Self::Mask, n: Self::Mask) -> Self::Mask;
    /// `a` where `m` says yes, else `b`.
    fn select(self, m: Self::Mask, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// A bit for each lane, the first one lowest: 1 for yes.
    fn bits(self, m: Self::Mask) -> u32;

    #[inline(always)]
    fn larger(self, a: Self::Wide, b: Self::Wide) -> Self::Wide {
        self.select(self.greater(a, b), a, b)
    }

    #[inline(always)]
    fn smaller(self, a: Self::Wide, b: Self::Wide) -> Self::Wide {
        self.select(self.greater(a, b), b, a)
    }

    /// −a where `m` says yes, else a.
    #[inline(always)]
    fn negated(self, m: Self::Mask, a: Self::Wide) -> Self::Wide {
        self.select(m, self.sub(self.all(0), a), a)
    }

    #[inline(always)]
    fn magnitude(self, a: Self::Wide) -> Self::Wide {
        self.if_negative(a, self.sub(self.all(0), a), a)
    }

    /// The largest magnitude.
    #[inline(always)]
    fn largest<const N: usize>(self, values: [Self::Wide; N]) -> Self::Wide {
        let mut maximum = self.magnitude(values[0]);
        for value in &values[1..] {
            maximum = self.larger(maximum, self.magnitude(*value));
        }
        maximum
    }

    /// Returns true if all lanes are zero.
    fn is_zero(self, a: Self::Wide) -> bool;
    /// Returns true if a lane is at or beyond ±2^30.
    fn is_beyond(self, a: Self::Wide) -> bool;
    /// Returns true if a lane of `any` is outside of −2^30 to 2^30 − 1, or one of `low` is below −2^31.
    fn are_beyond(self, any: [Self::Wide; 2], low: [Self::Wide; 2]) -> bool;
    /// Returns true if no lane of `impulses` is negative and all of `changes` are from −2^30 to 2^30 − 1.
    fn are_pushes(self, impulses: [Self::Wide; 2], changes: [Self::Wide; 2]) -> bool;

    /// value · factor / 2^30 of two values to nearest, ties away from zero. *Domain* |value| < 2^61, 0 ≤ factor ≤ 2^40, and results are below
    /// 2^62.
    #[inline(always)]
    fn multiples(self, values: [Self::Wide; 2], factor: i64) -> [Self::Wide; 2] {
        long::multiples(self, values, factor)
    }

    /// a·b / 2^64 to nearest, ties away from zero. *Domain* 0 ≤ a ≤ 2^57, |b| ≤ 2^62.
    #[inline(always)]
    fn upper_word(self, a: Self::Wide, b: Self::Wide) -> Self::Wide {
        long::upper_word(self, a, b)
    }

    /// a·b / 2^38 to nearest, ties away from zero. *Domain* 0 ≤ a ≤ 2^57, |b| ≤ 2^43.
    #[inline(always)]
    fn lowered_product(self, a: Self::Wide, b: Self::Wide) -> Self::Wide {
        long::lowered_product(self, a, b)
    }

    /// The sum of products in limbs: in 2^30, and from 0 to 2^30 − 1. *Domain* factors within 2^30, values within 2^51.
    #[inline(always)]
    fn dot(self, factors: [Self::Narrow; 2], values: [Self::Wide; 2]) -> [Self::Wide; 2] {
        long::dot(self, factors, values)
    }

    /// A number in limbs of 2^30 and 1 over 2^20 to nearest, ties away from zero. *Domain* the limb of 2^30 is within 2^52.
    #[inline(always)]
    fn lowered_limbs(self, limbs: [Self::Wide; 2]) -> Self::Wide {
        long::lowered_limbs(self, limbs)
    }

    /// The sum of products over 2^20 to nearest, ties away from zero. *Domain* factors within 2^30, values within 2^51.
    #[inline(always)]
    fn lowered_dot(self, factors: [Self::Narrow; 2], values: [Self::Wide; 2]) -> Self::Wide {
        long::lowered_dot(self, factors, values)
    }

    /// (base · 2^30 + the sum of products) / 2^34 to nearest, ties away from zero. *Domain* factors within 2^30, values within 2^51, and the base
    /// within 2^60.
    #[inline(always)]
    fn lowered_way(self, base: Self::Wide, factors: [Self::Narrow; 2], values: [Self::Wide; 2]) -> Self::Wide {
        long::lowered_way(self, base, factors, values)
    }

    /// The sum of products over 2^bits to nearest, ties away from zero, within ±2^limit. *Domain* factors below 2^31, values within 2^36, bits from
    /// 0 to 30, and the limit from 29 to 51.
    #[inline(always)]
    fn dot_within(
        self,
        factors: [Self::Narrow; 2],
        values: [Self::Wide; 2],
        bits: Self::Wide,
        limit: i64,
    ) -> Self::Wide {
        long::dot_within(self, factors, values, bits, limit)
    }

    /// Adds floor((v·x + w·y) / 2^down) to the limbs of sums, whose [`total`](Self::total) begins with zeros. *Domain* |v|, |w| ≤ 2^36,
    /// |x|, |y| ≤ 2^51, down ≥ 0, and 2^30 additions.
    #[inline(always)]
    fn add_products(
        self,
        sums: &mut [Self::Wide; 3],
        values: [Self::Wide; 2],
        others: [Self::Wide; 2],
        down: Self::Wide,
    ) {
        long::add_products(self, sums, values, others, down);
    }

    /// The sum over all lanes.
    #[inline(always)]
    fn total(self, sums: [Self::Wide; 3]) -> i128 {
        long::total(self, sums)
    }

    /// The velocities of bodies that an index names.
    #[inline(always)]
    fn speeds_of(self, speeds: &[Speeds], index: &[u32; GROUP], at: usize) -> [Self::Wide; 3] {
        let mut rows = [[0; 4]; GROUP];
        for lane in at..at + Self::WIDTH {
            rows[lane] = speeds[index[lane] as usize].0;
        }
        let [x, y, turn, _] = self.columns(&rows, at);
        [x, y, turn]
    }

    /// Adds changes to the velocities of bodies, one lane after the other.
    #[inline(always)]
    fn add_speeds(self, speeds: &mut [Speeds], index: &[u32; GROUP], at: usize, change: [Self::Wide; 3]) {
        let mut words = [[0; GROUP]; 3];
        for (words, value) in words.iter_mut().zip(change) {
            self.store(words, at, value);
        }
        for lane in at..at + Self::WIDTH {
            let Speeds(sums) = &mut speeds[index[lane] as usize];
            (0..3).for_each(|k| sums[k] += words[k][lane]);
        }
    }

    /// The words of the lines that an index names, each word in a vector.
    fn words_of(self, lines: &[Line], index: &[u32; GROUP], at: usize) -> [Self::Wide; 8];
    /// The columns of rows, of which each lane has one.
    fn columns(self, rows: &[[i64; 4]; GROUP], at: usize) -> [Self::Wide; 4];
    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<Self::Narrow>;
    /// Adds a change of velocity to the sums of bodies, one lane after the other.
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, change: [Self::Wide; 3]);
    /// Subtracts impulses from the sums of the first bodies, and adds them to the sums of the second ones, one lane after the other. Both
    /// linear quads are the same for both bodies, the third one is each body's.
    #[inline(always)]
    fn add_sums(
        self,
        sums: &mut [Sums],
        [first, second]: [&[u32; GROUP]; 2],
        at: usize,
        linear: [[Self::Wide; 4]; 2],
        turns: [[Self::Wide; 4]; 2],
    ) {
        let mut words = [[[0; GROUP]; 4]; 4];
        for (words, values) in words.iter_mut().zip([linear[0], linear[1], turns[0], turns[1]]) {
            for (words, value) in words.iter_mut().zip(values) {
                self.store(words, at, value);
            }
        }
        let [low, high, turn_a, turn_b] = &words;
        for lane in at..at + Self::WIDTH {
            let (a, b) = (first[lane] as usize, second[lane] as usize);
            for k in 0..4 {
                let quads = [low[k][lane], high[k][lane], turn_a[k][lane]];
                (0..3).for_each(|i| sums[a].0[i][k] -= quads[i]);
                let quads = [low[k][lane], high[k][lane], turn_b[k][lane]];
                (0..3).for_each(|i| sums[b].0[i][k] += quads[i]);
            }
        }
    }
}

/// Sums of impulses of a body in two limbs: the lower ones of x, y, x weighted and y weighted; the upper ones; both lower and both
/// upper ones of rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(32))]
pub(crate) struct Sums(pub(crate) [[i64; 4]; 3]);

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
///
/// A job is compiled as one function, with all that is inlined into it. Without optimisation each inlined part has a place on the stack of its
/// own: with debug assertions the larger parts are functions, so that a step needs 0.5 MB of it and not 2.6.
pub(crate) trait Job {
    type Result;
    fn run<L: Lanes>(self, lanes: L) -> Self::Result;
}

#[cfg(test)]
mod tests;
