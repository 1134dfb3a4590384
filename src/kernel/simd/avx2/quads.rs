//! The four components of a body in one vector.

use core::arch::x86_64::*;

use super::super::{GAIN_BITS, Lanes, Quads, Row};
use super::Avx2;

impl Quads for Avx2 {
    type Quad = __m128i;

    #[inline(always)]
    fn quad(self, words: &[i32; 4]) -> __m128i {
        unsafe { _mm_loadu_si128(words.as_ptr().cast()) }
    }

    #[inline(always)]
    fn put(self, words: &mut [i32; 4], value: __m128i) {
        unsafe { _mm_storeu_si128(words.as_mut_ptr().cast(), value) }
    }

    #[inline(always)]
    fn quad_plus(self, a: __m128i, b: __m128i) -> __m128i {
        unsafe { _mm_add_epi32(a, b) }
    }

    #[inline(always)]
    fn quad_minus(self, a: __m128i, b: __m128i) -> __m128i {
        unsafe { _mm_sub_epi32(a, b) }
    }

    #[inline(always)]
    fn quad_clamped(self, a: __m128i, limit: i32) -> __m128i {
        unsafe { _mm_max_epi32(_mm_min_epi32(a, _mm_set1_epi32(limit)), _mm_set1_epi32(-limit)) }
    }

    #[inline(always)]
    fn quad_share(self, a: __m128i, share: i32) -> __m128i {
        unsafe {
            let product = _mm256_mul_epi32(_mm256_cvtepi32_epi64(a), self.splat(share));
            let half = _mm256_sub_epi64(self.words(1 << 29), _mm256_srli_epi64::<63>(product));
            self.packed(_mm256_srli_epi64::<30>(_mm256_add_epi64(product, half)))
        }
    }

    #[inline(always)]
    fn quad_joined(self, a: __m128i, b: __m128i) -> __m128i {
        unsafe { _mm_blend_epi32::<8>(a, b) }
    }

    #[inline(always)]
    fn take_gain(self, row: &mut Row, limit: i32) -> bool {
        let limit = i64::from(limit);
        unsafe {
            let velocity = _mm256_cvtepi32_epi64(_mm_load_si128(row.velocity.as_ptr().cast()));
            let gain = _mm256_loadu_si256(row.gain.as_ptr().cast());
            let half = _mm256_sub_epi64(self.words(1 << GAIN_BITS >> 1), _mm256_srli_epi64::<63>(gain));
            let raised = _mm256_add_epi64(gain, half);
            // Rounded oddly, and 2^(63 − GAIN_BITS) larger: its lower half is that of the sum.
            let gained = _mm256_srli_epi64::<GAIN_BITS>(_mm256_xor_si256(raised, self.words(i64::MIN)));
            let rest = _mm256_sub_epi64(_mm256_and_si256(raised, self.words((1 << GAIN_BITS) - 1)), half);
            let sum = _mm256_add_epi64(velocity, gained);
            // Within the range these are below twice the limit. The fourth component is the angle, which has no gain.
            let shifted = _mm256_add_epi64(sum, self.words(limit - (1 << (63 - GAIN_BITS))));
            let above = _mm256_set_epi64x(0, -2 * limit, -2 * limit, -2 * limit);
            let is_within = _mm256_testz_si256(shifted, above) == 1;
            if is_within {
                _mm_store_si128(row.velocity.as_mut_ptr().cast(), self.packed(sum));
                _mm256_storeu_si256(row.gain.as_mut_ptr().cast(), rest);
            }
            is_within
        }
    }
}
