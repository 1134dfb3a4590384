//! Four lanes of 64 bits with AVX2.
//!
//! A narrow lane is the lower half of 64 bits, as `vpmuldq` reads it; the upper half is arbitrary. There is no arithmetic shift
//! of 64 bits: [`Avx2::floored`] shifts a number that is 2^63 larger and takes the difference off again.
#![allow(unsafe_code, reason = "vector instructions, on a CPU that has them")]

mod quads;

use core::arch::x86_64::*;

use super::{GROUP, Gathered, Job, Lanes, Line, Pairs, Row, Speeds, Sums, part, part_mut};

/// The proof that the CPU has AVX2, and the shifts and counts of bits that came with it.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// Returns a value if the CPU has AVX2, and BMI1, BMI2 and LZCNT beside it.
    pub(crate) fn new() -> Option<Self> {
        extern crate std;
        let has = std::is_x86_feature_detected!("avx2")
            && std::is_x86_feature_detected!("bmi1")
            && std::is_x86_feature_detected!("bmi2")
            && std::is_x86_feature_detected!("lzcnt");
        has.then_some(Self(()))
    }

    /// Runs a job compiled for these instructions.
    pub(crate) fn run<J: Job>(self, job: J) -> J::Result {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt")]
        unsafe fn compiled<J: Job>(job: J, lanes: Avx2) -> J::Result {
            job.run(lanes)
        }

        // SAFETY: a value of this type exists on a CPU with these instructions only.
        unsafe { compiled(job, self) }
    }

    #[inline(always)]
    fn words(self, value: i64) -> __m256i {
        unsafe { _mm256_set1_epi64x(value) }
    }

    /// Four words and four more.
    #[inline(always)]
    fn both(self, low: &[i32; 4], high: &[i32; 4]) -> __m256i {
        unsafe {
            let low = _mm256_castsi128_si256(_mm_loadu_si128(low.as_ptr().cast()));
            _mm256_inserti128_si256::<1>(low, _mm_loadu_si128(high.as_ptr().cast()))
        }
    }

    /// The lower halves.
    #[inline(always)]
    fn packed(self, a: __m256i) -> __m128i {
        unsafe {
            let lower = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
            _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(a, lower))
        }
    }

    /// Four words of four lines from a word on, each word in a vector.
    #[inline(always)]
    fn columns_from(self, [a, b, c, d]: [&Line; 4], from: usize) -> [__m256i; 4] {
        // SAFETY: a line has eight words and is aligned like two vectors; `from` is 0 or 4.
        unsafe {
            self.transposed([
                _mm256_load_si256(a.0[from..].as_ptr().cast()),
                _mm256_load_si256(b.0[from..].as_ptr().cast()),
                _mm256_load_si256(c.0[from..].as_ptr().cast()),
                _mm256_load_si256(d.0[from..].as_ptr().cast()),
            ])
        }
    }

    /// Adds quads to the sums of a body.
    #[inline(always)]
    pub(super) fn add_quads(self, sums: &mut Sums, quads: [__m256i; 3]) {
        for (sum, quad) in sums.0.iter_mut().zip(quads) {
            self.add_quad(sum, quad);
        }
    }

    /// Adds four words.
    #[inline(always)]
    pub(super) fn add_quad(self, sum: &mut [i64; 4], quad: __m256i) {
        let sum = sum.as_mut_ptr().cast();
        unsafe { _mm256_storeu_si256(sum, _mm256_add_epi64(_mm256_loadu_si256(sum), quad)) }
    }

    /// Subtracts quads from the sums of a body.
    #[inline(always)]
    pub(super) fn take_quads(self, sums: &mut Sums, quads: [__m256i; 3]) {
        for (sum, quad) in sums.0.iter_mut().zip(quads) {
            let sum = sum.as_mut_ptr().cast();
            unsafe { _mm256_storeu_si256(sum, _mm256_sub_epi64(_mm256_loadu_si256(sum), quad)) }
        }
    }

    /// The lanes of four vectors as rows, and rows as lanes.
    #[inline(always)]
    fn transposed(self, [x, y, z, w]: [__m256i; 4]) -> [__m256i; 4] {
        unsafe {
            let (a, b) = (_mm256_unpacklo_epi64(x, y), _mm256_unpackhi_epi64(x, y));
            let (c, d) = (_mm256_unpacklo_epi64(z, w), _mm256_unpackhi_epi64(z, w));
            [
                _mm256_permute2x128_si256::<0x20>(a, c),
                _mm256_permute2x128_si256::<0x20>(b, d),
                _mm256_permute2x128_si256::<0x31>(a, c),
                _mm256_permute2x128_si256::<0x31>(b, d),
            ]
        }
    }
}

impl Lanes for Avx2 {
    const WIDTH: usize = 4;
    type Narrow = __m256i;
    type Wide = __m256i;
    type Mask = __m256i;
    type Quads = Self;

    #[inline(always)]
    fn quads(self) -> Self {
        self
    }

    #[inline(always)]
    fn pair(self, pairs: &Pairs, at: usize) -> (__m256i, __m256i) {
        let half: &[[i32; 2]; 4] = part(pairs, at);
        unsafe {
            let both = _mm256_loadu_si256(half.as_ptr().cast());
            (both, _mm256_srli_epi64::<32>(both))
        }
    }

    #[inline(always)]
    fn put_pair(self, pairs: &mut Pairs, at: usize, (a, b): (__m256i, __m256i)) {
        let half: &mut [[i32; 2]; 4] = part_mut(pairs, at);
        unsafe {
            let both = _mm256_blend_epi32::<0b1010_1010>(a, _mm256_slli_epi64::<32>(b));
            _mm256_storeu_si256(half.as_mut_ptr().cast(), both);
        }
    }

    #[inline(always)]
    fn wide(self, words: &[i64; GROUP], at: usize) -> __m256i {
        let half: &[i64; 4] = part(words, at);
        unsafe { _mm256_loadu_si256(half.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(self, words: &mut [i64; GROUP], at: usize, value: __m256i) {
        let half: &mut [i64; 4] = part_mut(words, at);
        unsafe { _mm256_storeu_si256(half.as_mut_ptr().cast(), value) }
    }

    #[inline(always)]
    fn splat(self, value: i32) -> __m256i {
        unsafe { _mm256_set1_epi64x(i64::from(value)) }
    }

    #[inline(always)]
    fn plus(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_add_epi32(a, b) }
    }

    #[inline(always)]
    fn minus(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_sub_epi32(a, b) }
    }

    #[inline(always)]
    fn at_least(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_max_epi32(a, b) }
    }

    #[inline(always)]
    fn at_most(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_min_epi32(a, b) }
    }

    #[inline(always)]
    fn if_positive(self, c: __m256i, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_blendv_epi8(b, a, _mm256_cmpgt_epi32(c, _mm256_setzero_si256())) }
    }

    #[inline(always)]
    fn none_positive(self, a: __m256i, b: __m256i) -> bool {
        unsafe {
            let largest = _mm256_max_epi32(a, b);
            let positive = _mm256_cmpgt_epi32(largest, _mm256_setzero_si256());
            _mm256_testz_si256(positive, _mm256_set1_epi64x(0xffff_ffff)) == 1
        }
    }

    #[inline(always)]
    fn times(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_mul_epi32(a, b) }
    }

    #[inline(always)]
    fn times_unsigned(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_mul_epu32(a, b) }
    }

    #[inline(always)]
    fn add(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_add_epi64(a, b) }
    }

    #[inline(always)]
    fn sub(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_sub_epi64(a, b) }
    }

    #[inline(always)]
    fn low(self, a: __m256i) -> __m256i {
        a
    }

    #[inline(always)]
    fn narrowed<const BITS: i32>(self, a: __m256i) -> __m256i {
        unsafe { _mm256_srli_epi64::<BITS>(a) }
    }

    #[inline(always)]
    fn rest<const BITS: i32>(self, a: __m256i) -> __m256i {
        unsafe { _mm256_and_si256(a, self.words((1 << BITS) - 1)) }
    }

    #[inline(always)]
    fn if_negative(self, c: __m256i, a: __m256i, b: __m256i) -> __m256i {
        unsafe {
            let (a, b, c) = (_mm256_castsi256_pd(a), _mm256_castsi256_pd(b), _mm256_castsi256_pd(c));
            _mm256_castpd_si256(_mm256_blendv_pd(b, a, c))
        }
    }

    #[inline(always)]
    fn positive(self, a: __m256i) -> __m256i {
        self.if_negative(a, unsafe { _mm256_setzero_si256() }, a)
    }

    #[inline(always)]
    fn clamped(self, a: __m256i, limit: __m256i) -> __m256i {
        unsafe {
            let least = _mm256_sub_epi64(_mm256_setzero_si256(), limit);
            let below = _mm256_blendv_epi8(a, limit, _mm256_cmpgt_epi64(a, limit));
            _mm256_blendv_epi8(below, least, _mm256_cmpgt_epi64(least, a))
        }
    }

    #[inline(always)]
    fn capped(self, a: __m256i) -> __m256i {
        let max = self.words(i64::from(i32::MAX));
        unsafe { _mm256_blendv_epi8(a, max, _mm256_cmpgt_epi64(a, max)) }
    }

    #[inline(always)]
    fn floored<const BITS: i32>(self, a: __m256i) -> __m256i {
        unsafe {
            let shifted = _mm256_srli_epi64::<BITS>(_mm256_xor_si256(a, self.words(i64::MIN)));
            _mm256_sub_epi64(shifted, self.words(1 << (63 - BITS)))
        }
    }

    #[inline(always)]
    fn floored_by(self, a: __m256i, bits: __m256i) -> __m256i {
        unsafe {
            let sign = self.words(i64::MIN);
            _mm256_sub_epi64(_mm256_srlv_epi64(_mm256_xor_si256(a, sign), bits), _mm256_srlv_epi64(sign, bits))
        }
    }

    #[inline(always)]
    fn rounded(self, a: __m256i) -> __m256i {
        unsafe { _mm256_srli_epi64::<30>(_mm256_add_epi64(a, self.words(1 << 29))) }
    }

    #[inline(always)]
    fn rounded_oddly<const BITS: i32>(self, a: __m256i) -> __m256i {
        unsafe {
            let half = _mm256_sub_epi64(self.words((1 << BITS >> 1) ^ i64::MIN), _mm256_srli_epi64::<63>(a));
            let shifted = _mm256_srli_epi64::<BITS>(_mm256_add_epi64(a, half));
            _mm256_sub_epi64(shifted, self.words(1 << (63 - BITS)))
        }
    }

    #[inline(always)]
    fn raised_by(self, a: __m256i, bits: __m256i) -> __m256i {
        unsafe { _mm256_sllv_epi64(a, bits) }
    }

    #[inline(always)]
    fn share(self, factor: __m256i, load: __m256i) -> __m256i {
        unsafe {
            let low = _mm256_and_si256(load, self.words(0x7fff_ffff));
            let low = _mm256_add_epi64(_mm256_mul_epi32(factor, low), self.words(1 << 25));
            let low = _mm256_srli_epi64::<26>(low);
            let high = _mm256_slli_epi64::<5>(_mm256_mul_epi32(factor, _mm256_srli_epi64::<31>(load)));
            _mm256_add_epi64(low, high)
        }
    }

    #[inline(always)]
    fn all(self, value: i64) -> __m256i {
        self.words(value)
    }

    #[inline(always)]
    fn bit_length(self, a: __m256i) -> __m256i {
        // In registers: a vector that is loaded from words just stored would wait for them.
        unsafe {
            let (i, j) = (_mm256_extract_epi64::<0>(a), _mm256_extract_epi64::<1>(a));
            let (k, l) = (_mm256_extract_epi64::<2>(a), _mm256_extract_epi64::<3>(a));
            let zeros = |word: i64| i64::from(word.leading_zeros());
            _mm256_sub_epi64(self.words(64), _mm256_setr_epi64x(zeros(i), zeros(j), zeros(k), zeros(l)))
        }
    }

    #[inline(always)]
    fn greater(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_cmpgt_epi64(a, b) }
    }

    #[inline(always)]
    fn equal(self, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_cmpeq_epi64(a, b) }
    }

    #[inline(always)]
    fn both(self, m: __m256i, n: __m256i) -> __m256i {
        unsafe { _mm256_and_si256(m, n) }
    }

    #[inline(always)]
    fn either(self, m: __m256i, n: __m256i) -> __m256i {
        unsafe { _mm256_or_si256(m, n) }
    }

    #[inline(always)]
    fn unless(self, m: __m256i, n: __m256i) -> __m256i {
        unsafe { _mm256_andnot_si256(n, m) }
    }

    #[inline(always)]
    fn unlike(self, m: __m256i, n: __m256i) -> __m256i {
        unsafe { _mm256_xor_si256(m, n) }
    }

    #[inline(always)]
    fn select(self, m: __m256i, a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_blendv_epi8(b, a, m) }
    }

    #[inline(always)]
    fn bits(self, m: __m256i) -> u32 {
        unsafe { _mm256_movemask_pd(_mm256_castsi256_pd(m)) as u32 }
    }

    #[inline(always)]
    fn is_zero(self, a: __m256i) -> bool {
        unsafe { _mm256_testz_si256(a, a) == 1 }
    }

    #[inline(always)]
    fn is_beyond(self, a: __m256i) -> bool {
        unsafe {
            let bound = self.words(1 << 30);
            // Within the bounds both fit in 31 bits.
            let both = _mm256_or_si256(_mm256_add_epi64(bound, a), _mm256_sub_epi64(bound, a));
            _mm256_testz_si256(both, self.words(!0x7fff_ffff)) == 0
        }
    }

    #[inline(always)]
    fn are_beyond(self, any: [__m256i; 2], low: [__m256i; 2]) -> bool {
        unsafe {
            let bound = self.words(1 << 30);
            // Within the bounds these fit in 31 bits.
            let any = _mm256_or_si256(_mm256_add_epi64(any[0], bound), _mm256_add_epi64(any[1], bound));
            let bound = self.words(1 << 31);
            // Within them these are not negative.
            let low = _mm256_or_si256(_mm256_add_epi64(low[0], bound), _mm256_add_epi64(low[1], bound));
            let low = _mm256_and_si256(low, self.words(i64::MIN));
            _mm256_testz_si256(_mm256_or_si256(any, low), self.words(!0x7fff_ffff)) == 0
        }
    }

    #[inline(always)]
    fn are_pushes(self, impulses: [__m256i; 2], changes: [__m256i; 2]) -> bool {
        unsafe {
            let bound = self.words(1 << 30);
            // Within the bounds these fit in 31 bits.
            let changes = _mm256_or_si256(_mm256_add_epi64(changes[0], bound), _mm256_add_epi64(changes[1], bound));
            let signs = _mm256_and_si256(_mm256_or_si256(impulses[0], impulses[1]), self.words(i64::MIN));
            _mm256_testz_si256(_mm256_or_si256(changes, signs), self.words(!0x7fff_ffff)) == 1
        }
    }

    #[inline(always)]
    fn speeds_of(self, speeds: &[Speeds], index: &[u32; GROUP], at: usize) -> [__m256i; 3] {
        let [i, j, k, l] = *part(index, at);
        let [x, y, turn, _] = unsafe {
            self.transposed([
                _mm256_load_si256(speeds[i as usize].0.as_ptr().cast()),
                _mm256_load_si256(speeds[j as usize].0.as_ptr().cast()),
                _mm256_load_si256(speeds[k as usize].0.as_ptr().cast()),
                _mm256_load_si256(speeds[l as usize].0.as_ptr().cast()),
            ])
        };
        [x, y, turn]
    }

    #[inline(always)]
    fn add_speeds(self, speeds: &mut [Speeds], index: &[u32; GROUP], at: usize, [x, y, turn]: [__m256i; 3]) {
        let zero = unsafe { _mm256_setzero_si256() };
        for (&i, row) in part::<_, 4>(index, at).iter().zip(self.transposed([x, y, turn, zero])) {
            self.add_quad(&mut speeds[i as usize].0, row);
        }
    }

    #[inline(always)]
    fn words_of(self, lines: &[Line], index: &[u32; GROUP], at: usize) -> [__m256i; 8] {
        let [i, j, k, l] = *part(index, at);
        let lines = [&lines[i as usize], &lines[j as usize], &lines[k as usize], &lines[l as usize]];
        let ([a, b, c, d], [e, f, g, h]) = (self.columns_from(lines, 0), self.columns_from(lines, 4));
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn columns(self, rows: &[[i64; 4]; GROUP], at: usize) -> [__m256i; 4] {
        let [a, b, c, d]: &[[i64; 4]; 4] = part(rows, at);
        unsafe {
            self.transposed([
                _mm256_loadu_si256(a.as_ptr().cast()),
                _mm256_loadu_si256(b.as_ptr().cast()),
                _mm256_loadu_si256(c.as_ptr().cast()),
                _mm256_loadu_si256(d.as_ptr().cast()),
            ])
        }
    }

    #[inline(always)]
    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<__m256i> {
        let [i, j, k, l] = *part(index, at);
        let row = [&rows[i as usize], &rows[j as usize], &rows[k as usize], &rows[l as usize]];
        unsafe {
            let a = self.both(&row[0].velocity, &row[2].velocity);
            let b = self.both(&row[1].velocity, &row[3].velocity);
            let (linear, angular) = (_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b));
            let c = self.both(&row[0].displacement, &row[2].displacement);
            let d = self.both(&row[1].displacement, &row[3].displacement);
            let moved = _mm256_unpacklo_epi64(c, d);
            let (y, dy) = (_mm256_srli_epi64::<32>(linear), _mm256_srli_epi64::<32>(moved));
            let angle = _mm256_srli_epi64::<32>(angular);
            Gathered { velocity: [linear, y, angular], displacement: [moved, dy, angle] }
        }
    }

    #[inline(always)]
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, [x, y, z]: [__m256i; 3]) {
        let zero = unsafe { _mm256_setzero_si256() };
        for (&i, row) in part::<_, 4>(index, at).iter().zip(self.transposed([x, y, z, zero])) {
            self.add_quad(&mut rows[i as usize].gain, row);
        }
    }

    #[inline(always)]
    fn add_sums(
        self,
        sums: &mut [Sums],
        [first, second]: [&[u32; GROUP]; 2],
        at: usize,
        linear: [[__m256i; 4]; 2],
        turns: [[__m256i; 4]; 2],
    ) {
        let (low, high) = (self.transposed(linear[0]), self.transposed(linear[1]));
        let (turn_a, turn_b) = (self.transposed(turns[0]), self.transposed(turns[1]));
        let (first, second): (&[u32; 4], &[u32; 4]) = (part(first, at), part(second, at));
        for lane in 0..4 {
            self.take_quads(&mut sums[first[lane] as usize], [low[lane], high[lane], turn_a[lane]]);
            self.add_quads(&mut sums[second[lane] as usize], [low[lane], high[lane], turn_b[lane]]);
        }
    }
}
