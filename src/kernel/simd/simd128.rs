//! Two lanes of 64 bits with the vectors of WebAssembly, in builds with the target feature `simd128`: a module cannot ask the
//! machine that runs it.
//!
//! A narrow vector fills the first two words of four; the others are arbitrary. Single bodies are left to the compiler.
#![allow(unsafe_code, reason = "loads and stores of vectors")]

use core::arch::wasm32::*;

use super::{GROUP, Gathered, Job, Lanes, Line, Pairs, Portable, Row, part, part_mut};

/// The two lanes. This module is part of builds with these instructions only.
#[derive(Clone, Copy)]
pub(crate) struct Simd128(());

impl Simd128 {
    pub(crate) fn new() -> Option<Self> {
        Some(Self(()))
    }

    pub(crate) fn run<J: Job>(self, job: J) -> J::Result {
        job.run(self)
    }

    /// The shifts of both lanes: those of the instructions are the same for all.
    #[inline(always)]
    fn lane_by_lane(self, a: v128, bits: v128, shift: impl Fn(i64, i64) -> i64) -> v128 {
        let first = shift(i64x2_extract_lane::<0>(a), i64x2_extract_lane::<0>(bits));
        i64x2(first, shift(i64x2_extract_lane::<1>(a), i64x2_extract_lane::<1>(bits)))
    }

    /// The bits of both vectors together: where a lane is outside of −2^30 to 2^30 − 1, there are some above the lowest 31.
    #[inline(always)]
    fn beyond(self, a: [v128; 2]) -> v128 {
        let bound = i64x2_splat(1 << 30);
        v128_or(i64x2_add(a[0], bound), i64x2_add(a[1], bound))
    }

    /// Returns true if all lanes fit in 31 bits.
    #[inline(always)]
    fn are_short(self, a: v128) -> bool {
        !v128_any_true(v128_and(a, i64x2_splat(!0x7fff_ffff)))
    }
}

impl Lanes for Simd128 {
    const WIDTH: usize = 2;
    type Narrow = v128;
    type Wide = v128;
    type Mask = v128;
    type Quads = Portable;

    #[inline(always)]
    fn quads(self) -> Portable {
        Portable
    }

    #[inline(always)]
    fn pair(self, pairs: &Pairs, at: usize) -> (v128, v128) {
        let two: &[_; 2] = part(pairs, at);
        // SAFETY: they fill a vector.
        let both = unsafe { v128_load(two.as_ptr().cast()) };
        (self.low(both), i32x4_shuffle::<1, 3, 1, 3>(both, both))
    }

    #[inline(always)]
    fn put_pair(self, pairs: &mut Pairs, at: usize, (a, b): (v128, v128)) {
        let two: &mut [_; 2] = part_mut(pairs, at);
        // SAFETY: they fill a vector.
        unsafe { v128_store(two.as_mut_ptr().cast(), i32x4_shuffle::<0, 4, 1, 5>(a, b)) }
    }

    #[inline(always)]
    fn wide(self, words: &[i64; GROUP], at: usize) -> v128 {
        let two: &[_; 2] = part(words, at);
        // SAFETY: they fill a vector.
        unsafe { v128_load(two.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(self, words: &mut [i64; GROUP], at: usize, value: v128) {
        let two: &mut [_; 2] = part_mut(words, at);
        // SAFETY: they fill a vector.
        unsafe { v128_store(two.as_mut_ptr().cast(), value) }
    }

    #[inline(always)]
    fn splat(self, value: i32) -> v128 {
        i32x4_splat(value)
    }

    #[inline(always)]
    fn plus(self, a: v128, b: v128) -> v128 {
        i32x4_add(a, b)
    }

    #[inline(always)]
    fn minus(self, a: v128, b: v128) -> v128 {
        i32x4_sub(a, b)
    }

    #[inline(always)]
    fn at_least(self, a: v128, b: v128) -> v128 {
        i32x4_max(a, b)
    }

    #[inline(always)]
    fn at_most(self, a: v128, b: v128) -> v128 {
        i32x4_min(a, b)
    }

    #[inline(always)]
    fn if_positive(self, c: v128, a: v128, b: v128) -> v128 {
        v128_bitselect(a, b, i32x4_gt(c, i32x4_splat(0)))
    }

    #[inline(always)]
    fn none_positive(self, a: v128, b: v128) -> bool {
        i64x2_extract_lane::<0>(i32x4_gt(i32x4_max(a, b), i32x4_splat(0))) == 0
    }

    #[inline(always)]
    fn times(self, a: v128, b: v128) -> v128 {
        i64x2_extmul_low_i32x4(a, b)
    }

    #[inline(always)]
    fn times_unsigned(self, a: v128, b: v128) -> v128 {
        u64x2_extmul_low_u32x4(a, b)
    }

    #[inline(always)]
    fn add(self, a: v128, b: v128) -> v128 {
        i64x2_add(a, b)
    }

    #[inline(always)]
    fn sub(self, a: v128, b: v128) -> v128 {
        i64x2_sub(a, b)
    }

    #[inline(always)]
    fn low(self, a: v128) -> v128 {
        i32x4_shuffle::<0, 2, 0, 2>(a, a)
    }

    #[inline(always)]
    fn narrowed<const BITS: i32>(self, a: v128) -> v128 {
        self.low(u64x2_shr(a, BITS as u32))
    }

    #[inline(always)]
    fn rest<const BITS: i32>(self, a: v128) -> v128 {
        v128_and(a, i64x2_splat((1 << BITS) - 1))
    }

    #[inline(always)]
    fn if_negative(self, c: v128, a: v128, b: v128) -> v128 {
        v128_bitselect(a, b, i64x2_lt(c, i64x2_splat(0)))
    }

    #[inline(always)]
    fn positive(self, a: v128) -> v128 {
        v128_andnot(a, i64x2_lt(a, i64x2_splat(0)))
    }

    #[inline(always)]
    fn clamped(self, a: v128, limit: v128) -> v128 {
        let least = i64x2_neg(limit);
        let below = v128_bitselect(limit, a, i64x2_gt(a, limit));
        v128_bitselect(least, below, i64x2_gt(least, below))
    }

    #[inline(always)]
    fn capped(self, a: v128) -> v128 {
        let max = i64x2_splat(i64::from(i32::MAX));
        self.low(v128_bitselect(max, a, i64x2_gt(a, max)))
    }

    #[inline(always)]
    fn floored<const BITS: i32>(self, a: v128) -> v128 {
        i64x2_shr(a, BITS as u32)
    }

    #[inline(always)]
    fn floored_by(self, a: v128, bits: v128) -> v128 {
        self.lane_by_lane(a, bits, |a, bits| a >> (bits & 63))
    }

    #[inline(always)]
    fn rounded(self, a: v128) -> v128 {
        self.low(u64x2_shr(i64x2_add(a, i64x2_splat(1 << 29)), 30))
    }

    #[inline(always)]
    fn rounded_oddly<const BITS: i32>(self, a: v128) -> v128 {
        let half = i64x2_sub(i64x2_splat(1 << BITS >> 1), u64x2_shr(a, 63));
        self.floored::<BITS>(i64x2_add(a, half))
    }

    #[inline(always)]
    fn raised_by(self, a: v128, bits: v128) -> v128 {
        self.lane_by_lane(a, bits, |a, bits| a << (bits & 63))
    }

    #[inline(always)]
    fn share(self, factor: v128, load: v128) -> v128 {
        let low = self.low(v128_and(load, i64x2_splat(0x7fff_ffff)));
        let low = u64x2_shr(i64x2_add(self.times(factor, low), i64x2_splat(1 << 25)), 26);
        let high = self.low(u64x2_shr(load, 31));
        i64x2_add(low, i64x2_shl(self.times(factor, high), 5))
    }

    #[inline(always)]
    fn all(self, value: i64) -> v128 {
        i64x2_splat(value)
    }

    #[inline(always)]
    fn bit_length(self, a: v128) -> v128 {
        let length = |word: i64| i64::from(64 - word.leading_zeros());
        i64x2(length(i64x2_extract_lane::<0>(a)), length(i64x2_extract_lane::<1>(a)))
    }

    #[inline(always)]
    fn greater(self, a: v128, b: v128) -> v128 {
        i64x2_gt(a, b)
    }

    #[inline(always)]
    fn equal(self, a: v128, b: v128) -> v128 {
        i64x2_eq(a, b)
    }

    #[inline(always)]
    fn both(self, m: v128, n: v128) -> v128 {
        v128_and(m, n)
    }

    #[inline(always)]
    fn either(self, m: v128, n: v128) -> v128 {
        v128_or(m, n)
    }

    #[inline(always)]
    fn unless(self, m: v128, n: v128) -> v128 {
        v128_andnot(m, n)
    }

    #[inline(always)]
    fn unlike(self, m: v128, n: v128) -> v128 {
        v128_xor(m, n)
    }

    #[inline(always)]
    fn select(self, m: v128, a: v128, b: v128) -> v128 {
        v128_bitselect(a, b, m)
    }

    #[inline(always)]
    fn bits(self, m: v128) -> u32 {
        u32::from(i64x2_bitmask(m))
    }

    #[inline(always)]
    fn is_zero(self, a: v128) -> bool {
        !v128_any_true(a)
    }

    #[inline(always)]
    fn is_beyond(self, a: v128) -> bool {
        let bound = i64x2_splat(1 << 30);
        // Within the bounds both fit in 31 bits.
        !self.are_short(v128_or(i64x2_add(bound, a), i64x2_sub(bound, a)))
    }

    #[inline(always)]
    fn are_beyond(self, any: [v128; 2], low: [v128; 2]) -> bool {
        let bound = i64x2_splat(i64::from(i32::MIN));
        let too_low = v128_or(i64x2_lt(low[0], bound), i64x2_lt(low[1], bound));
        !self.are_short(v128_or(self.beyond(any), too_low))
    }

    #[inline(always)]
    fn are_pushes(self, impulses: [v128; 2], changes: [v128; 2]) -> bool {
        let signs = v128_and(v128_or(impulses[0], impulses[1]), i64x2_splat(i64::MIN));
        self.are_short(v128_or(self.beyond(changes), signs))
    }

    #[inline(always)]
    fn words_of(self, lines: &[Line], index: &[u32; GROUP], at: usize) -> [v128; 8] {
        let [a, b] = part(index, at).map(|i| &lines[i as usize].0);
        let mut words = [i64x2_splat(0); 8];
        for word in 0..8 {
            words[word] = i64x2(a[word], b[word]);
        }
        words
    }

    #[inline(always)]
    fn columns(self, rows: &[[i64; 4]; GROUP], at: usize) -> [v128; 4] {
        let [a, b]: &[[i64; 4]; 2] = part(rows, at);
        let [a, b]: [*const v128; 2] = [a.as_ptr().cast(), b.as_ptr().cast()];
        // SAFETY: a row fills two vectors.
        let (a, other_a, b, other_b) =
            unsafe { (v128_load(a), v128_load(a.add(1)), v128_load(b), v128_load(b.add(1))) };
        [
            i64x2_shuffle::<0, 2>(a, b),
            i64x2_shuffle::<1, 3>(a, b),
            i64x2_shuffle::<0, 2>(other_a, other_b),
            i64x2_shuffle::<1, 3>(other_a, other_b),
        ]
    }

    #[inline(always)]
    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<v128> {
        let [a, b] = part(index, at).map(|i| &rows[i as usize]);
        // SAFETY: four components fill a vector.
        let load = |words: &[i32; 4]| unsafe { v128_load(words.as_ptr().cast()) };
        let (v, w, d, e) = (load(&a.velocity), load(&b.velocity), load(&a.displacement), load(&b.displacement));
        let (linear, angular) = (i32x4_shuffle::<0, 4, 1, 5>(v, w), i32x4_shuffle::<2, 6, 3, 7>(v, w));
        let moved = i32x4_shuffle::<0, 4, 1, 5>(d, e);
        let [y, angle, dy] = [linear, angular, moved].map(|both| i64x2_shuffle::<1, 1>(both, both));
        Gathered { velocity: [linear, y, angular], displacement: [moved, dy, angle] }
    }

    #[inline(always)]
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, [x, y, z]: [v128; 3]) {
        let none = i64x2_splat(0);
        // The lanes of x, y and z as rows (x, y, z, 0).
        let a = [i64x2_shuffle::<0, 2>(x, y), i64x2_shuffle::<0, 2>(z, none)];
        let b = [i64x2_shuffle::<1, 3>(x, y), i64x2_shuffle::<1, 3>(z, none)];
        for (&i, change) in part::<_, 2>(index, at).iter().zip([a, b]) {
            let gain: *mut v128 = rows[i as usize].gain.as_mut_ptr().cast();
            // SAFETY: the words of a gain fill two vectors.
            unsafe {
                v128_store(gain, i64x2_add(v128_load(gain), change[0]));
                v128_store(gain.add(1), i64x2_add(v128_load(gain.add(1)), change[1]));
            }
        }
    }
}
