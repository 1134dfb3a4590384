//! Rows of bodies as lanes, and lanes as rows.

/// The part that compilers from 1.89 on know.
#[rustversion::since(1.89)]
#[allow(clippy::incompatible_msrv, reason = "older compilers do not see this module")]
mod shuffles {
    use core::arch::x86_64::*;

    use super::super::super::{GROUP, Line, Row};
    use super::super::Avx512;

    impl Avx512 {
        /// Two rows side by side.
        #[inline(always)]
        pub(in super::super) fn both(self, low: &Row, high: &Row) -> __m512i {
            let (low, high): (*const Row, *const Row) = (low, high);
            // SAFETY: a row fills a vector of 256 bits and is aligned like one.
            unsafe {
                let low = _mm512_castsi256_si512(_mm256_load_si256(low.cast()));
                _mm512_inserti64x4::<1>(low, _mm256_load_si256(high.cast()))
            }
        }

        /// The even words of two lines, word by word beside each other, and the odd ones.
        #[inline(always)]
        pub(in super::super) fn interleaved(self, first: &Line, second: &Line) -> (__m512i, __m512i) {
            let (first, second): (*const Line, *const Line) = (first, second);
            // SAFETY: a line fills a vector and is aligned like one.
            unsafe {
                let (first, second) = (_mm512_load_si512(first.cast()), _mm512_load_si512(second.cast()));
                (_mm512_unpacklo_epi64(first, second), _mm512_unpackhi_epi64(first, second))
            }
        }

        /// The four parts of 128 bits of each vector, part by part beside each other.
        #[inline(always)]
        pub(in super::super) fn quarters(self, a: __m512i, b: __m512i, c: __m512i, d: __m512i) -> [__m512i; 4] {
            const EVEN: i32 = 0b10_00_10_00;
            const ODD: i32 = 0b11_01_11_01;
            unsafe {
                let (ab, cd) = (_mm512_shuffle_i64x2::<EVEN>(a, b), _mm512_shuffle_i64x2::<EVEN>(c, d));
                let (ab_odd, cd_odd) = (_mm512_shuffle_i64x2::<ODD>(a, b), _mm512_shuffle_i64x2::<ODD>(c, d));
                [
                    _mm512_shuffle_i64x2::<EVEN>(ab, cd),
                    _mm512_shuffle_i64x2::<EVEN>(ab_odd, cd_odd),
                    _mm512_shuffle_i64x2::<ODD>(ab, cd),
                    _mm512_shuffle_i64x2::<ODD>(ab_odd, cd_odd),
                ]
            }
        }

        /// Four words and four more.
        #[inline(always)]
        pub(in super::super) fn quads_of(self, low: &[i64; 4], high: &[i64; 4]) -> __m512i {
            unsafe {
                let low = _mm512_castsi256_si512(_mm256_loadu_si256(low.as_ptr().cast()));
                _mm512_inserti64x4::<1>(low, _mm256_loadu_si256(high.as_ptr().cast()))
            }
        }

        /// The columns of rows.
        #[inline(always)]
        pub(in super::super) fn columns_of(self, [i, j, k, l, m, n, o, p]: [&[i64; 4]; GROUP]) -> [__m512i; 4] {
            let (a, b) = (self.quads_of(i, m), self.quads_of(j, n));
            let (c, d) = (self.quads_of(k, o), self.quads_of(l, p));
            unsafe {
                // In each half four rows and four columns.
                let (even, other_even) = (_mm512_unpacklo_epi64(a, b), _mm512_unpacklo_epi64(c, d));
                let (odd, other_odd) = (_mm512_unpackhi_epi64(a, b), _mm512_unpackhi_epi64(c, d));
                let (first, third) =
                    (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
                [
                    _mm512_permutex2var_epi64(even, first, other_even),
                    _mm512_permutex2var_epi64(odd, first, other_odd),
                    _mm512_permutex2var_epi64(even, third, other_even),
                    _mm512_permutex2var_epi64(odd, third, other_odd),
                ]
            }
        }

        /// Two rows (x, y, z, 0) from the words of `xy` and `z` that an index names.
        #[inline(always)]
        pub(in super::super) fn rows(self, xy: __m512i, index: __m512i, z: __m512i) -> [__m256i; 2] {
            unsafe {
                let rows = _mm512_maskz_permutex2var_epi64(0b0111_0111, xy, index, z);
                [_mm512_castsi512_si256(rows), _mm512_extracti64x4_epi64::<1>(rows)]
            }
        }

        /// The lanes of four vectors as rows.
        #[inline(always)]
        pub(in super::super) fn square(self, [x, y, z, w]: [__m512i; 4]) -> [__m256i; GROUP] {
            unsafe {
                let (even, odd) = (_mm512_unpacklo_epi64(x, y), _mm512_unpackhi_epi64(x, y));
                let (other_even, other_odd) = (_mm512_unpacklo_epi64(z, w), _mm512_unpackhi_epi64(z, w));
                let low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
                let high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
                let [r0, r2] = self.halves(_mm512_permutex2var_epi64(even, low, other_even));
                let [r1, r3] = self.halves(_mm512_permutex2var_epi64(odd, low, other_odd));
                let [r4, r6] = self.halves(_mm512_permutex2var_epi64(even, high, other_even));
                let [r5, r7] = self.halves(_mm512_permutex2var_epi64(odd, high, other_odd));
                [r0, r1, r2, r3, r4, r5, r6, r7]
            }
        }

        #[inline(always)]
        pub(in super::super) fn halves(self, both: __m512i) -> [__m256i; 2] {
            unsafe { [_mm512_castsi512_si256(both), _mm512_extracti64x4_epi64::<1>(both)] }
        }

        /// The lanes of x, y and z as rows (x, y, z, 0).
        #[inline(always)]
        pub(in super::super) fn transposed(self, [x, y, z]: [__m512i; 3]) -> [__m256i; GROUP] {
            unsafe {
                let (even, odd) = (_mm512_unpacklo_epi64(x, y), _mm512_unpackhi_epi64(x, y));
                let [r0, r2] = self.rows(even, _mm512_setr_epi64(0, 1, 8, 0, 2, 3, 10, 0), z);
                let [r1, r3] = self.rows(odd, _mm512_setr_epi64(0, 1, 9, 0, 2, 3, 11, 0), z);
                let [r4, r6] = self.rows(even, _mm512_setr_epi64(4, 5, 12, 0, 6, 7, 14, 0), z);
                let [r5, r7] = self.rows(odd, _mm512_setr_epi64(4, 5, 13, 0, 6, 7, 15, 0), z);
                [r0, r1, r2, r3, r4, r5, r6, r7]
            }
        }
    }
}
