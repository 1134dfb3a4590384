//! Two lanes of 64 bits with NEON, which every 64-bit ARM CPU has.
//!
//! A narrow vector fills half a register: `smull` makes a wide one of two of them. Single bodies are left to the compiler.
#![allow(unsafe_code, reason = "vector instructions, in a build for CPUs that have them")]

use core::arch::aarch64::*;

use super::{GROUP, Gathered, Job, Lanes, Line, Pairs, Portable, Row, part, part_mut};

/// The two lanes. This module is part of builds for CPUs with NEON only.
#[derive(Clone, Copy)]
pub(crate) struct Neon(());

// SAFETY of each `unsafe` below: the build may use these instructions anywhere, and a pointer comes from a reference to as many
// words as are read or written.
impl Neon {
    pub(crate) fn new() -> Option<Self> {
        Some(Self(()))
    }

    pub(crate) fn run<J: Job>(self, job: J) -> J::Result {
        job.run(self)
    }

    #[inline(always)]
    fn words(self, value: i64) -> int64x2_t {
        unsafe { vdupq_n_s64(value) }
    }

    /// a / 2^BITS without a sign.
    #[inline(always)]
    fn upper<const BITS: i32>(self, a: int64x2_t) -> int64x2_t {
        unsafe { vreinterpretq_s64_u64(vshrq_n_u64::<BITS>(vreinterpretq_u64_s64(a))) }
    }

    /// The bits of pairs of lanes together that are set in one that is outside of −2^30 to 2^30 − 1, and none otherwise.
    #[inline(always)]
    fn beyond(self, a: [int64x2_t; 2]) -> int64x2_t {
        let bound = self.words(1 << 30);
        // Within the bounds these fit in 31 bits.
        self.upper::<31>(unsafe { vorrq_s64(vaddq_s64(a[0], bound), vaddq_s64(a[1], bound)) })
    }
}

impl Lanes for Neon {
    const WIDTH: usize = 2;
    type Narrow = int32x2_t;
    type Wide = int64x2_t;
    type Mask = uint64x2_t;
    type Quads = Portable;

    #[inline(always)]
    fn quads(self) -> Portable {
        Portable
    }

    #[inline(always)]
    fn pair(self, pairs: &Pairs, at: usize) -> (int32x2_t, int32x2_t) {
        let two: &[_; 2] = part(pairs, at);
        let int32x2x2_t(a, b) = unsafe { vld2_s32(two.as_ptr().cast()) };
        (a, b)
    }

    #[inline(always)]
    fn put_pair(self, pairs: &mut Pairs, at: usize, (a, b): (int32x2_t, int32x2_t)) {
        let two: &mut [_; 2] = part_mut(pairs, at);
        unsafe { vst2_s32(two.as_mut_ptr().cast(), int32x2x2_t(a, b)) }
    }

    #[inline(always)]
    fn wide(self, words: &[i64; GROUP], at: usize) -> int64x2_t {
        let two: &[_; 2] = part(words, at);
        unsafe { vld1q_s64(two.as_ptr()) }
    }

    #[inline(always)]
    fn store(self, words: &mut [i64; GROUP], at: usize, value: int64x2_t) {
        let two: &mut [_; 2] = part_mut(words, at);
        unsafe { vst1q_s64(two.as_mut_ptr(), value) }
    }

    #[inline(always)]
    fn splat(self, value: i32) -> int32x2_t {
        unsafe { vdup_n_s32(value) }
    }

    #[inline(always)]
    fn plus(self, a: int32x2_t, b: int32x2_t) -> int32x2_t {
        unsafe { vadd_s32(a, b) }
    }

    #[inline(always)]
    fn minus(self, a: int32x2_t, b: int32x2_t) -> int32x2_t {
        unsafe { vsub_s32(a, b) }
    }

    #[inline(always)]
    fn at_least(self, a: int32x2_t, b: int32x2_t) -> int32x2_t {
        unsafe { vmax_s32(a, b) }
    }

    #[inline(always)]
    fn at_most(self, a: int32x2_t, b: int32x2_t) -> int32x2_t {
        unsafe { vmin_s32(a, b) }
    }

    #[inline(always)]
    fn if_positive(self, c: int32x2_t, a: int32x2_t, b: int32x2_t) -> int32x2_t {
        unsafe { vbsl_s32(vcgtz_s32(c), a, b) }
    }

    #[inline(always)]
    fn none_positive(self, a: int32x2_t, b: int32x2_t) -> bool {
        unsafe { vmaxv_s32(vmax_s32(a, b)) <= 0 }
    }

    #[inline(always)]
    fn times(self, a: int32x2_t, b: int32x2_t) -> int64x2_t {
        unsafe { vmull_s32(a, b) }
    }

    #[inline(always)]
    fn times_unsigned(self, a: int32x2_t, b: int32x2_t) -> int64x2_t {
        unsafe { vreinterpretq_s64_u64(vmull_u32(vreinterpret_u32_s32(a), vreinterpret_u32_s32(b))) }
    }

    #[inline(always)]
    fn add(self, a: int64x2_t, b: int64x2_t) -> int64x2_t {
        unsafe { vaddq_s64(a, b) }
    }

    #[inline(always)]
    fn sub(self, a: int64x2_t, b: int64x2_t) -> int64x2_t {
        unsafe { vsubq_s64(a, b) }
    }

    #[inline(always)]
    fn low(self, a: int64x2_t) -> int32x2_t {
        unsafe { vmovn_s64(a) }
    }

    #[inline(always)]
    fn narrowed<const BITS: i32>(self, a: int64x2_t) -> int32x2_t {
        unsafe { vshrn_n_s64::<BITS>(a) }
    }

    #[inline(always)]
    fn rest<const BITS: i32>(self, a: int64x2_t) -> int64x2_t {
        unsafe { vandq_s64(a, self.words((1 << BITS) - 1)) }
    }

    #[inline(always)]
    fn if_negative(self, c: int64x2_t, a: int64x2_t, b: int64x2_t) -> int64x2_t {
        unsafe { vbslq_s64(vcltzq_s64(c), a, b) }
    }

    #[inline(always)]
    fn positive(self, a: int64x2_t) -> int64x2_t {
        unsafe { vbicq_s64(a, vshrq_n_s64::<63>(a)) }
    }

    #[inline(always)]
    fn clamped(self, a: int64x2_t, limit: int64x2_t) -> int64x2_t {
        unsafe {
            let least = vnegq_s64(limit);
            let below = vbslq_s64(vcgtq_s64(a, limit), limit, a);
            vbslq_s64(vcgtq_s64(least, below), least, below)
        }
    }

    #[inline(always)]
    fn capped(self, a: int64x2_t) -> int32x2_t {
        unsafe { vqmovn_s64(a) }
    }

    #[inline(always)]
    fn floored<const BITS: i32>(self, a: int64x2_t) -> int64x2_t {
        unsafe { vshrq_n_s64::<BITS>(a) }
    }

    #[inline(always)]
    fn floored_by(self, a: int64x2_t, bits: int64x2_t) -> int64x2_t {
        unsafe { vshlq_s64(a, vnegq_s64(bits)) }
    }

    #[inline(always)]
    fn rounded(self, a: int64x2_t) -> int32x2_t {
        unsafe { vrshrn_n_s64::<30>(a) }
    }

    #[inline(always)]
    fn rounded_oddly<const BITS: i32>(self, a: int64x2_t) -> int64x2_t {
        // Ties of negative numbers are below the half by one.
        unsafe { vrshrq_n_s64::<BITS>(vaddq_s64(a, vshrq_n_s64::<63>(a))) }
    }

    #[inline(always)]
    fn raised_by(self, a: int64x2_t, bits: int64x2_t) -> int64x2_t {
        unsafe { vshlq_s64(a, bits) }
    }

    #[inline(always)]
    fn share(self, factor: int32x2_t, load: int64x2_t) -> int64x2_t {
        unsafe {
            let low = vand_s32(vmovn_s64(load), vdup_n_s32(i32::MAX));
            let high = vshlq_n_s64::<5>(vmull_s32(factor, vshrn_n_s64::<31>(load)));
            vaddq_s64(vrshrq_n_s64::<26>(vmull_s32(factor, low)), high)
        }
    }

    #[inline(always)]
    fn all(self, value: i64) -> int64x2_t {
        self.words(value)
    }

    #[inline(always)]
    fn bit_length(self, a: int64x2_t) -> int64x2_t {
        let length = |word: i64| i64::from(64 - word.leading_zeros());
        unsafe {
            let (first, second) = (length(vgetq_lane_s64::<0>(a)), length(vgetq_lane_s64::<1>(a)));
            vcombine_s64(vcreate_s64(first as u64), vcreate_s64(second as u64))
        }
    }

    #[inline(always)]
    fn greater(self, a: int64x2_t, b: int64x2_t) -> uint64x2_t {
        unsafe { vcgtq_s64(a, b) }
    }

    #[inline(always)]
    fn equal(self, a: int64x2_t, b: int64x2_t) -> uint64x2_t {
        unsafe { vceqq_s64(a, b) }
    }

    #[inline(always)]
    fn both(self, m: uint64x2_t, n: uint64x2_t) -> uint64x2_t {
        unsafe { vandq_u64(m, n) }
    }

    #[inline(always)]
    fn either(self, m: uint64x2_t, n: uint64x2_t) -> uint64x2_t {
        unsafe { vorrq_u64(m, n) }
    }

    #[inline(always)]
    fn unless(self, m: uint64x2_t, n: uint64x2_t) -> uint64x2_t {
        unsafe { vbicq_u64(m, n) }
    }

    #[inline(always)]
    fn unlike(self, m: uint64x2_t, n: uint64x2_t) -> uint64x2_t {
        unsafe { veorq_u64(m, n) }
    }

    #[inline(always)]
    fn select(self, m: uint64x2_t, a: int64x2_t, b: int64x2_t) -> int64x2_t {
        unsafe { vbslq_s64(m, a, b) }
    }

    #[inline(always)]
    fn bits(self, m: uint64x2_t) -> u32 {
        unsafe { (vgetq_lane_u64::<0>(m) & 1 | vgetq_lane_u64::<1>(m) & 2) as u32 }
    }

    #[inline(always)]
    fn is_zero(self, a: int64x2_t) -> bool {
        unsafe { vmaxvq_u32(vreinterpretq_u32_s64(a)) == 0 }
    }

    #[inline(always)]
    fn is_beyond(self, a: int64x2_t) -> bool {
        !self.is_zero(self.upper::<30>(unsafe { vabsq_s64(a) }))
    }

    #[inline(always)]
    fn are_beyond(self, any: [int64x2_t; 2], low: [int64x2_t; 2]) -> bool {
        unsafe {
            let bound = self.words(i64::from(i32::MIN));
            let too_low = vorrq_u64(vcltq_s64(low[0], bound), vcltq_s64(low[1], bound));
            !self.is_zero(vorrq_s64(self.beyond(any), vreinterpretq_s64_u64(too_low)))
        }
    }

    #[inline(always)]
    fn are_pushes(self, impulses: [int64x2_t; 2], changes: [int64x2_t; 2]) -> bool {
        unsafe {
            let signs = self.upper::<63>(vorrq_s64(impulses[0], impulses[1]));
            self.is_zero(vorrq_s64(self.beyond(changes), signs))
        }
    }

    #[inline(always)]
    fn words_of(self, lines: &[Line], index: &[u32; GROUP], at: usize) -> [int64x2_t; 8] {
        let [a, b] = part(index, at).map(|i| &lines[i as usize].0);
        let mut words = [self.words(0); 8];
        for word in (0..8).step_by(2) {
            unsafe {
                let (first, second) = (vld1q_s64(a[word..].as_ptr()), vld1q_s64(b[word..].as_ptr()));
                words[word] = vzip1q_s64(first, second);
                words[word + 1] = vzip2q_s64(first, second);
            }
        }
        words
    }

    #[inline(always)]
    fn columns(self, rows: &[[i64; 4]; GROUP], at: usize) -> [int64x2_t; 4] {
        let [a, b]: &[[i64; 4]; 2] = part(rows, at);
        unsafe {
            let (a, other_a) = (vld1q_s64(a.as_ptr()), vld1q_s64(a.as_ptr().add(2)));
            let (b, other_b) = (vld1q_s64(b.as_ptr()), vld1q_s64(b.as_ptr().add(2)));
            [vzip1q_s64(a, b), vzip2q_s64(a, b), vzip1q_s64(other_a, other_b), vzip2q_s64(other_a, other_b)]
        }
    }

    #[inline(always)]
    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<int32x2_t> {
        let [a, b] = part(index, at).map(|i| &rows[i as usize]);
        unsafe {
            let (v, w) = (vld1q_s32(a.velocity.as_ptr()), vld1q_s32(b.velocity.as_ptr()));
            let (linear, angular) = (vzip1q_s32(v, w), vzip2q_s32(v, w));
            let moved = vzip1q_s32(vld1q_s32(a.displacement.as_ptr()), vld1q_s32(b.displacement.as_ptr()));
            let (y, dy, angle) = (vget_high_s32(linear), vget_high_s32(moved), vget_high_s32(angular));
            let velocity = [vget_low_s32(linear), y, vget_low_s32(angular)];
            Gathered { velocity, displacement: [vget_low_s32(moved), dy, angle] }
        }
    }

    #[inline(always)]
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, [x, y, z]: [int64x2_t; 3]) {
        let none = self.words(0);
        // The lanes of x, y and z as rows (x, y, z, 0).
        let [a, b] = unsafe { [[vzip1q_s64(x, y), vzip1q_s64(z, none)], [vzip2q_s64(x, y), vzip2q_s64(z, none)]] };
        for (&i, [xy, z]) in part::<_, 2>(index, at).iter().zip([a, b]) {
            let gain = rows[i as usize].gain.as_mut_ptr();
            unsafe {
                vst1q_s64(gain, vaddq_s64(vld1q_s64(gain), xy));
                vst1q_s64(gain.add(2), vaddq_s64(vld1q_s64(gain.add(2)), z));
            }
        }
    }
}
