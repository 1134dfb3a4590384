//! The loops of [`fx_bulk`](super::fx_bulk) for CPUs with wide vectors, chosen when the program runs.
//!
//! The loops are safe code on 32-bit halves, without branches, which the compiler turns into vector instructions when
//! it may assume the CPU has them. Only AVX-512 makes that pay: it has 64-bit comparisons, and eight lanes make up for
//! the four multiplications that one of 64 by 64 bits takes. (With AVX2 the same loops take as long as the plain ones.)
//!
//! A CPU multiplies words beside its vectors, with units that would have nothing to do: the loop that damps takes a group of values at a
//! time, a vector and a few beside it.

use super::accumulator::FxAccumulator;
use super::fx_bulk;
use super::turn::Turn;
use crate::kernel::simd::{Avx512, Job, Lanes, VectorSet};

/// The instructions for a loop over so many values; `None` where the CPU has none or where they do not pay.
pub(super) fn lanes_for(count: usize) -> Option<Avx512> {
    if count >= 16 && VectorSet::Avx512.is_allowed() { Avx512::new() } else { None }
}

/// Half of a word.
const TIE: u64 = 1 << 63;

/// Two's complement in two words, the low one first.
type Words = (u64, u64);

#[inline(always)]
fn sum(a: Words, b: Words) -> Words {
    let low = a.0.wrapping_add(b.0);
    (low, a.1.wrapping_add(b.1).wrapping_add(u64::from(low < b.0)))
}

/// a·b by halves. Each partial product is at most (2^32 − 1)², which leaves room for two more words of 32 bits.
#[inline(always)]
fn product(a: u64, b: u64) -> Words {
    const HALF: u64 = u32::MAX as u64;
    let (a1, a0, b1, b0) = (a >> 32, a & HALF, b >> 32, b & HALF);
    let low = a0 * b0;
    let mid = a1 * b0 + (low >> 32);
    let mid2 = a0 * b1 + (mid & HALF);
    ((mid2 << 32) | (low & HALF), a1 * b1 + (mid >> 32) + (mid2 >> 32))
}

/// a·b with a signed.
#[inline(always)]
fn signed_product(a: u64, b: u64) -> Words {
    let (low, high) = product(a, b);
    (low, high.wrapping_sub((a as i64 >> 63) as u64 & b))
}

/// The public value of an accumulator.
#[inline(always)]
fn value(v: &FxAccumulator) -> u64 {
    let high = v.high as u64;
    high.wrapping_add(u64::from(v.low > TIE - (high & 1)))
}

/// v·mantissa / 2^shift. *Domain* 1 <= shift <= 63.
#[inline(always)]
fn passed(v: u64, mantissa: u64, shift: u32) -> Words {
    let product = signed_product(v, mantissa);
    let odd = product.0 >> shift & 1;
    // Half is added, or one less where the floor is even: then a tie stays below.
    let (low, high) = sum(product, ((1 << (shift - 1)) - 1 + odd, 0));
    (low >> shift | high << (64 - shift), (high as i64 >> shift) as u64)
}

/// v·mantissa / 2^64, and zero where its public value is zero.
#[inline(always)]
fn scaled(v: FxAccumulator, mantissa: u64) -> FxAccumulator {
    let (rest, carried) = product(v.low, mantissa);
    let (low, high) = signed_product(v.high as u64, mantissa);
    // Up if the rest is above half, or half and the floor odd. The upper word of a product has room for one more.
    let odd = (low ^ carried) & 1;
    let (low, high) = sum((low, high), (carried + u64::from(rest > TIE - odd), 0));
    let rounded = FxAccumulator { high: high as i64, low };
    if value(&rounded) == 0 { FxAccumulator::default() } else { rounded }
}

/// The values of a vector.
const VECTOR: usize = 8;

/// The values beside a vector in each group of [`Damp`]: so many take the least time, 0.91 ns a value and not 1.13. A drift would gain 0.08.
const BESIDE: usize = 6;

/// See [`scaled`].
pub(super) struct Damp<'a> {
    pub(super) values: &'a mut [FxAccumulator],
    pub(super) mantissa: u64,
}

impl Job for Damp<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { values, mantissa } = self;
        let mut groups = values.chunks_exact_mut(VECTOR + BESIDE);
        // Plain loops: a closure does not have the instructions of the function around it.
        for group in &mut groups {
            let Some((vector, beside)) = group.split_first_chunk_mut::<VECTOR>() else { continue };
            for v in vector {
                *v = scaled(*v, mantissa);
            }
            for v in beside {
                *v = fx_bulk::scaled(*v, mantissa);
            }
        }
        for v in groups.into_remainder() {
            *v = fx_bulk::scaled(*v, mantissa);
        }
    }
}

/// v + gained.
pub(super) struct Kick<'a> {
    pub(super) values: &'a mut [FxAccumulator],
    pub(super) gained: FxAccumulator,
}

impl Job for Kick<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let gained = (self.gained.low, self.gained.high as u64);
        for v in self.values {
            let (low, high) = sum((v.low, v.high as u64), gained);
            *v = FxAccumulator { high: high as i64, low };
        }
    }
}

/// x + v·mantissa / 2^shift with the public velocity, taken negative if `backwards` has all bits set.
pub(super) struct Drift<'a> {
    pub(super) positions: &'a mut [FxAccumulator],
    pub(super) velocities: &'a [FxAccumulator],
    pub(super) mantissa: u64,
    pub(super) shift: u32,
    pub(super) backwards: u64,
}

impl Job for Drift<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { positions, velocities, mantissa, shift, backwards } = self;
        for (x, v) in positions.iter_mut().zip(velocities) {
            let v = (value(v) ^ backwards).wrapping_sub(backwards);
            let (low, high) = sum((x.low, x.high as u64), passed(v, mantissa, shift & 63));
            *x = FxAccumulator { high: high as i64, low };
        }
    }
}

/// angle + v·mantissa / 2^shift with the public velocity, taken negative if `backwards` has all bits set.
pub(super) struct TurnAll<'a> {
    pub(super) angles: &'a mut [Turn],
    pub(super) velocities: &'a [FxAccumulator],
    pub(super) mantissa: u64,
    pub(super) shift: u32,
    pub(super) backwards: u64,
}

impl Job for TurnAll<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { angles, velocities, mantissa, shift, backwards } = self;
        for (angle, v) in angles.iter_mut().zip(velocities) {
            let v = (value(v) ^ backwards).wrapping_sub(backwards);
            angle.0 = angle.0.wrapping_add(passed(v, mantissa, shift & 63).0);
        }
    }
}

/// The bits of all values plus `limit`.
pub(super) struct Spread<'a> {
    pub(super) values: &'a [FxAccumulator],
    pub(super) limit: u64,
}

impl Job for Spread<'_> {
    type Result = u64;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> u64 {
        self.values.iter().fold(0, |bits, v| bits | (v.high as u64).wrapping_add(self.limit))
    }
}
