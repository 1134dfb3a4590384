//! Eight lanes of 64 bits with AVX-512: a group at once.
//!
//! Narrow lanes are as in [`Avx2`](super::Avx2), which also handles single bodies: a CPU with AVX-512 has AVX2.
#![allow(unsafe_code, reason = "vector instructions, on a CPU that has them")]

mod rows;

/// The part that compilers from 1.89 on know.
#[rustversion::since(1.89)]
#[allow(clippy::incompatible_msrv, reason = "older compilers do not see this module")]
mod lanes {
    use core::arch::x86_64::*;

    use super::super::{Avx2, GROUP, Gathered, Job, Lanes, Line, Pairs, Row, Speeds, Sums};

    /// The proof that the CPU has AVX-512.
    #[derive(Clone, Copy)]
    pub(crate) struct Avx512(Avx2);

    impl Avx512 {
        /// Returns a value if the CPU has AVX-512.
        pub(crate) fn new() -> Option<Self> {
            extern crate std;
            let has = std::is_x86_feature_detected!("avx512f")
                && std::is_x86_feature_detected!("avx512dq")
                && std::is_x86_feature_detected!("avx512cd")
                && std::is_x86_feature_detected!("avx512vl");
            Avx2::new().filter(|_| has).map(Self)
        }

        /// Runs a job compiled for these instructions.
        pub(crate) fn run<J: Job>(self, job: J) -> J::Result {
            #[target_feature(enable = "avx512f,avx512dq,avx512cd,avx512vl,bmi1,bmi2,lzcnt")]
            unsafe fn compiled<J: Job>(job: J, lanes: Avx512) -> J::Result {
                job.run(lanes)
            }

            // SAFETY: a value of this type exists on a CPU with these instructions only.
            unsafe { compiled(job, self) }
        }

        #[inline(always)]
        fn words(self, value: i64) -> __m512i {
            unsafe { _mm512_set1_epi64(value) }
        }
    }

    impl Lanes for Avx512 {
        const WIDTH: usize = GROUP;
        type Narrow = __m512i;
        type Wide = __m512i;
        type Mask = __mmask8;
        type Quads = Avx2;

        #[inline(always)]
        fn quads(self) -> Avx2 {
            self.0
        }

        #[inline(always)]
        fn pair(self, pairs: &Pairs, _: usize) -> (__m512i, __m512i) {
            unsafe {
                let both = _mm512_loadu_si512(pairs.as_ptr().cast());
                (both, _mm512_srli_epi64::<32>(both))
            }
        }

        #[inline(always)]
        fn put_pair(self, pairs: &mut Pairs, _: usize, (a, b): (__m512i, __m512i)) {
            unsafe {
                let both = _mm512_mask_blend_epi32(0xaaaa, a, _mm512_slli_epi64::<32>(b));
                _mm512_storeu_si512(pairs.as_mut_ptr().cast(), both);
            }
        }

        #[inline(always)]
        fn wide(self, words: &[i64; GROUP], _: usize) -> __m512i {
            unsafe { _mm512_loadu_si512(words.as_ptr().cast()) }
        }

        #[inline(always)]
        fn store(self, words: &mut [i64; GROUP], _: usize, value: __m512i) {
            unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), value) }
        }

        #[inline(always)]
        fn splat(self, value: i32) -> __m512i {
            self.words(i64::from(value))
        }

        #[inline(always)]
        fn plus(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_add_epi32(a, b) }
        }

        #[inline(always)]
        fn minus(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_sub_epi32(a, b) }
        }

        #[inline(always)]
        fn at_least(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_max_epi32(a, b) }
        }

        #[inline(always)]
        fn at_most(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_min_epi32(a, b) }
        }

        #[inline(always)]
        fn if_positive(self, c: __m512i, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_mask_blend_epi32(_mm512_cmpgt_epi32_mask(c, _mm512_setzero_si512()), b, a) }
        }

        #[inline(always)]
        fn none_positive(self, a: __m512i, b: __m512i) -> bool {
            unsafe { _mm512_cmpgt_epi32_mask(_mm512_max_epi32(a, b), _mm512_setzero_si512()) & 0x5555 == 0 }
        }

        #[inline(always)]
        fn times(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_mul_epi32(a, b) }
        }

        #[inline(always)]
        fn times_unsigned(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_mul_epu32(a, b) }
        }

        #[inline(always)]
        fn add(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_add_epi64(a, b) }
        }

        #[inline(always)]
        fn sub(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_sub_epi64(a, b) }
        }

        #[inline(always)]
        fn low(self, a: __m512i) -> __m512i {
            a
        }

        #[inline(always)]
        fn narrowed<const BITS: i32>(self, a: __m512i) -> __m512i {
            self.floored::<BITS>(a)
        }

        #[inline(always)]
        fn rest<const BITS: i32>(self, a: __m512i) -> __m512i {
            unsafe { _mm512_and_si512(a, self.words((1 << BITS) - 1)) }
        }

        #[inline(always)]
        fn if_negative(self, c: __m512i, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_mask_blend_epi64(_mm512_movepi64_mask(c), b, a) }
        }

        #[inline(always)]
        fn positive(self, a: __m512i) -> __m512i {
            unsafe { _mm512_max_epi64(a, _mm512_setzero_si512()) }
        }

        #[inline(always)]
        fn larger(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_max_epi64(a, b) }
        }

        #[inline(always)]
        fn smaller(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_min_epi64(a, b) }
        }

        #[inline(always)]
        fn magnitude(self, a: __m512i) -> __m512i {
            unsafe { _mm512_abs_epi64(a) }
        }

        #[inline(always)]
        fn clamped(self, a: __m512i, limit: __m512i) -> __m512i {
            unsafe {
                let least = _mm512_sub_epi64(_mm512_setzero_si512(), limit);
                _mm512_max_epi64(_mm512_min_epi64(a, limit), least)
            }
        }

        #[inline(always)]
        fn capped(self, a: __m512i) -> __m512i {
            unsafe { _mm512_min_epi64(a, self.words(i64::from(i32::MAX))) }
        }

        #[inline(always)]
        fn floored<const BITS: i32>(self, a: __m512i) -> __m512i {
            // The same number in all lanes becomes an immediate operand.
            self.floored_by(a, self.words(i64::from(BITS)))
        }

        #[inline(always)]
        fn floored_by(self, a: __m512i, bits: __m512i) -> __m512i {
            unsafe { _mm512_srav_epi64(a, bits) }
        }

        #[inline(always)]
        fn rounded(self, a: __m512i) -> __m512i {
            unsafe { _mm512_srli_epi64::<30>(_mm512_add_epi64(a, self.words(1 << 29))) }
        }

        #[inline(always)]
        fn rounded_oddly<const BITS: i32>(self, a: __m512i) -> __m512i {
            unsafe {
                let half = _mm512_sub_epi64(self.words(1 << BITS >> 1), _mm512_srli_epi64::<63>(a));
                self.floored::<BITS>(_mm512_add_epi64(a, half))
            }
        }

        #[inline(always)]
        fn raised_by(self, a: __m512i, bits: __m512i) -> __m512i {
            unsafe { _mm512_sllv_epi64(a, bits) }
        }

        #[inline(always)]
        fn share(self, factor: __m512i, load: __m512i) -> __m512i {
            unsafe {
                let low = _mm512_and_si512(load, self.words(0x7fff_ffff));
                let low = _mm512_add_epi64(_mm512_mul_epi32(factor, low), self.words(1 << 25));
                let low = _mm512_srli_epi64::<26>(low);
                let high = _mm512_slli_epi64::<5>(_mm512_mul_epi32(factor, _mm512_srli_epi64::<31>(load)));
                _mm512_add_epi64(low, high)
            }
        }

        #[inline(always)]
        fn all(self, value: i64) -> __m512i {
            self.words(value)
        }

        #[inline(always)]
        fn bit_length(self, a: __m512i) -> __m512i {
            unsafe { _mm512_sub_epi64(self.words(64), _mm512_lzcnt_epi64(a)) }
        }

        #[inline(always)]
        fn greater(self, a: __m512i, b: __m512i) -> __mmask8 {
            unsafe { _mm512_cmpgt_epi64_mask(a, b) }
        }

        #[inline(always)]
        fn equal(self, a: __m512i, b: __m512i) -> __mmask8 {
            unsafe { _mm512_cmpeq_epi64_mask(a, b) }
        }

        #[inline(always)]
        fn both(self, m: __mmask8, n: __mmask8) -> __mmask8 {
            m & n
        }

        #[inline(always)]
        fn either(self, m: __mmask8, n: __mmask8) -> __mmask8 {
            m | n
        }

        #[inline(always)]
        fn unless(self, m: __mmask8, n: __mmask8) -> __mmask8 {
            m & !n
        }

        #[inline(always)]
        fn unlike(self, m: __mmask8, n: __mmask8) -> __mmask8 {
            m ^ n
        }

        #[inline(always)]
        fn select(self, m: __mmask8, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_mask_blend_epi64(m, b, a) }
        }

        #[inline(always)]
        fn bits(self, m: __mmask8) -> u32 {
            u32::from(m)
        }

        #[inline(always)]
        fn is_zero(self, a: __m512i) -> bool {
            unsafe { _mm512_test_epi64_mask(a, a) == 0 }
        }

        #[inline(always)]
        fn is_beyond(self, a: __m512i) -> bool {
            unsafe {
                let bound = self.words(1 << 30);
                // Within the bounds both fit in 31 bits.
                let both = _mm512_or_si512(_mm512_add_epi64(bound, a), _mm512_sub_epi64(bound, a));
                _mm512_test_epi64_mask(both, self.words(!0x7fff_ffff)) != 0
            }
        }

        #[inline(always)]
        fn are_beyond(self, any: [__m512i; 2], low: [__m512i; 2]) -> bool {
            unsafe {
                let bound = self.words(1 << 30);
                // Within the bounds these fit in 31 bits.
                let any = _mm512_or_si512(_mm512_add_epi64(any[0], bound), _mm512_add_epi64(any[1], bound));
                let low = _mm512_min_epi64(low[0], low[1]);
                let too_low = _mm512_cmpgt_epi64_mask(self.words(i64::from(i32::MIN)), low);
                _mm512_test_epi64_mask(any, self.words(!0x7fff_ffff)) | too_low != 0
            }
        }

        #[inline(always)]
        fn are_pushes(self, impulses: [__m512i; 2], changes: [__m512i; 2]) -> bool {
            unsafe {
                let bound = self.words(1 << 30);
                // Within the bounds these fit in 31 bits.
                let changes = _mm512_or_si512(_mm512_add_epi64(changes[0], bound), _mm512_add_epi64(changes[1], bound));
                let signs = _mm512_movepi64_mask(_mm512_or_si512(impulses[0], impulses[1]));
                _mm512_test_epi64_mask(changes, self.words(!0x7fff_ffff)) | signs == 0
            }
        }

        #[inline(always)]
        fn words_of(self, lines: &[Line], index: &[u32; GROUP], _: usize) -> [__m512i; 8] {
            let [i, j, k, l, m, n, o, p] = *index;
            let (e0, o0) = self.interleaved(&lines[i as usize], &lines[j as usize]);
            let (e1, o1) = self.interleaved(&lines[k as usize], &lines[l as usize]);
            let (e2, o2) = self.interleaved(&lines[m as usize], &lines[n as usize]);
            let (e3, o3) = self.interleaved(&lines[o as usize], &lines[p as usize]);
            let (even, odd) = (self.quarters(e0, e1, e2, e3), self.quarters(o0, o1, o2, o3));
            [even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3]]
        }

        #[inline(always)]
        fn columns(self, rows: &[[i64; 4]; GROUP], _: usize) -> [__m512i; 4] {
            let [i, j, k, l, m, n, o, p] = rows;
            self.columns_of([i, j, k, l, m, n, o, p])
        }

        #[inline(always)]
        fn speeds_of(self, speeds: &[Speeds], index: &[u32; GROUP], _: usize) -> [__m512i; 3] {
            let [i, j, k, l, m, n, o, p] = *index;
            let (i, j, k, l) =
                (&speeds[i as usize].0, &speeds[j as usize].0, &speeds[k as usize].0, &speeds[l as usize].0);
            let (m, n, o, p) =
                (&speeds[m as usize].0, &speeds[n as usize].0, &speeds[o as usize].0, &speeds[p as usize].0);
            let [x, y, turn, _] = self.columns_of([i, j, k, l, m, n, o, p]);
            [x, y, turn]
        }

        #[inline(always)]
        fn add_speeds(self, speeds: &mut [Speeds], index: &[u32; GROUP], _: usize, change: [__m512i; 3]) {
            for (&i, row) in index.iter().zip(self.transposed(change)) {
                self.0.add_quad(&mut speeds[i as usize].0, row);
            }
        }

        #[inline(always)]
        fn gather(self, rows: &[Row], index: &[u32; GROUP], _: usize) -> Gathered<__m512i> {
            let [i, j, k, l, m, n, o, p] = *index;
            let a = self.both(&rows[i as usize], &rows[m as usize]);
            let b = self.both(&rows[j as usize], &rows[n as usize]);
            let c = self.both(&rows[k as usize], &rows[o as usize]);
            let d = self.both(&rows[l as usize], &rows[p as usize]);
            unsafe {
                // Words of a row: x and y; angular and angle; displacement x and y; nothing.
                let (even, other_even) = (_mm512_unpacklo_epi64(a, b), _mm512_unpacklo_epi64(c, d));
                let (odd, other_odd) = (_mm512_unpackhi_epi64(a, b), _mm512_unpackhi_epi64(c, d));
                let (first, third) =
                    (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
                let linear = _mm512_permutex2var_epi64(even, first, other_even);
                let angular = _mm512_permutex2var_epi64(odd, first, other_odd);
                let moved = _mm512_permutex2var_epi64(even, third, other_even);
                let (y, dy) = (_mm512_srli_epi64::<32>(linear), _mm512_srli_epi64::<32>(moved));
                let angle = _mm512_srli_epi64::<32>(angular);
                Gathered { velocity: [linear, y, angular], displacement: [moved, dy, angle] }
            }
        }

        #[inline(always)]
        fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], _: usize, change: [__m512i; 3]) {
            for (&i, row) in index.iter().zip(self.transposed(change)) {
                self.0.add_quad(&mut rows[i as usize].gain, row);
            }
        }

        #[inline(always)]
        fn add_sums(
            self,
            sums: &mut [Sums],
            [first, second]: [&[u32; GROUP]; 2],
            _: usize,
            linear: [[__m512i; 4]; 2],
            turns: [[__m512i; 4]; 2],
        ) {
            let (low, high) = (self.square(linear[0]), self.square(linear[1]));
            let (turn_a, turn_b) = (self.square(turns[0]), self.square(turns[1]));
            for lane in 0..GROUP {
                self.0.take_quads(&mut sums[first[lane] as usize], [low[lane], high[lane], turn_a[lane]]);
                self.0.add_quads(&mut sums[second[lane] as usize], [low[lane], high[lane], turn_b[lane]]);
            }
        }
    }
}

#[rustversion::before(1.89)]
pub(crate) use super::absent::Absent as Avx512;
#[rustversion::since(1.89)]
pub(crate) use lanes::Avx512;
