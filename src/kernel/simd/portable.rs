//! One lane at a time, in plain integers: the reference.

use core::hint::black_box;

use super::{GAIN_BITS, GROUP, Gathered, Lanes, Line, Pairs, Quads, Row, Speeds};
use crate::kernel::product;
use crate::kernel::round::{lowered_low, odd_shift, upper};

/// One lane, on every machine.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Lanes for Portable {
    const WIDTH: usize = 1;
    type Narrow = i32;
    type Wide = i64;
    type Mask = bool;
    type Quads = Self;

    #[inline(always)]
    fn quads(self) -> Self {
        self
    }

    #[inline(always)]
    fn pair(self, pairs: &Pairs, at: usize) -> (i32, i32) {
        (pairs[at][0], pairs[at][1])
    }

    #[inline(always)]
    fn put_pair(self, pairs: &mut Pairs, at: usize, (a, b): (i32, i32)) {
        pairs[at] = [a, b];
    }

    #[inline(always)]
    fn wide(self, words: &[i64; GROUP], at: usize) -> i64 {
        words[at]
    }

    #[inline(always)]
    fn store(self, words: &mut [i64; GROUP], at: usize, value: i64) {
        words[at] = value;
    }

    #[inline(always)]
    fn splat(self, value: i32) -> i32 {
        value
    }

    #[inline(always)]
    fn plus(self, a: i32, b: i32) -> i32 {
        a + b
    }

    #[inline(always)]
    fn minus(self, a: i32, b: i32) -> i32 {
        a - b
    }

    #[inline(always)]
    fn at_least(self, a: i32, b: i32) -> i32 {
        a.max(b)
    }

    #[inline(always)]
    fn at_most(self, a: i32, b: i32) -> i32 {
        a.min(b)
    }

    #[inline(always)]
    fn if_positive(self, c: i32, a: i32, b: i32) -> i32 {
        if c > 0 { a } else { b }
    }

    #[inline(always)]
    fn none_positive(self, a: i32, b: i32) -> bool {
        a <= 0 && b <= 0
    }

    #[inline(always)]
    fn times(self, a: i32, b: i32) -> i64 {
        i64::from(a) * i64::from(b)
    }

    #[inline(always)]
    fn times_unsigned(self, a: i32, b: i32) -> i64 {
        i64::from(a as u32) * i64::from(b as u32)
    }

    #[inline(always)]
    fn add(self, a: i64, b: i64) -> i64 {
        a + b
    }

    #[inline(always)]
    fn sub(self, a: i64, b: i64) -> i64 {
        a - b
    }

    #[inline(always)]
    fn low(self, a: i64) -> i32 {
        a as i32
    }

    #[inline(always)]
    fn narrowed<const BITS: i32>(self, a: i64) -> i32 {
        (a >> BITS) as i32
    }

    #[inline(always)]
    fn rest<const BITS: i32>(self, a: i64) -> i64 {
        a & ((1 << BITS) - 1)
    }

    #[inline(always)]
    fn if_negative(self, c: i64, a: i64, b: i64) -> i64 {
        if c < 0 { a } else { b }
    }

    #[inline(always)]
    fn positive(self, a: i64) -> i64 {
        a.max(0)
    }

    #[inline(always)]
    fn clamped(self, a: i64, limit: i64) -> i64 {
        a.min(limit).max(-limit)
    }

    #[inline(always)]
    fn capped(self, a: i64) -> i32 {
        a.min(i64::from(i32::MAX)) as i32
    }

    #[inline(always)]
    fn floored<const BITS: i32>(self, a: i64) -> i64 {
        a >> BITS
    }

    #[inline(always)]
    fn floored_by(self, a: i64, bits: i64) -> i64 {
        a >> (bits & 63)
    }

    #[inline(always)]
    fn reciprocal(self, d: i32) -> i32 {
        (((1_u64 << 60) - 1) / d as u64) as i32
    }

    #[inline(always)]
    fn rounded(self, a: i64) -> i32 {
        ((a + (1 << 29)) >> 30) as i32
    }

    #[inline(always)]
    fn rounded_oddly<const BITS: i32>(self, a: i64) -> i64 {
        (a + (1 << BITS >> 1) - i64::from(a < 0)) >> BITS
    }

    #[inline(always)]
    fn raised_by(self, a: i64, bits: i64) -> i64 {
        a << (bits & 63)
    }

    #[inline(always)]
    fn share(self, factor: i32, load: i64) -> i64 {
        let (low, high) = (load & 0x7fff_ffff, load >> 31);
        ((i64::from(factor) * low + (1 << 25)) >> 26) + ((i64::from(factor) * high) << 5)
    }

    #[inline(always)]
    fn all(self, value: i64) -> i64 {
        value
    }

    #[inline(always)]
    fn bit_length(self, a: i64) -> i64 {
        i64::from(64 - a.leading_zeros())
    }

    #[inline(always)]
    fn greater(self, a: i64, b: i64) -> bool {
        a > b
    }

    #[inline(always)]
    fn equal(self, a: i64, b: i64) -> bool {
        a == b
    }

    #[inline(always)]
    fn both(self, m: bool, n: bool) -> bool {
        m & n
    }

    #[inline(always)]
    fn either(self, m: bool, n: bool) -> bool {
        m | n
    }

    #[inline(always)]
    fn unless(self, m: bool, n: bool) -> bool {
        m & !n
    }

    #[inline(always)]
    fn unlike(self, m: bool, n: bool) -> bool {
        m ^ n
    }

    #[inline(always)]
    fn select(self, m: bool, a: i64, b: i64) -> i64 {
        if m { a } else { b }
    }

    #[inline(always)]
    fn bits(self, m: bool) -> u32 {
        u32::from(m)
    }

    #[inline(always)]
    fn is_zero(self, a: i64) -> bool {
        a == 0
    }

    #[inline(always)]
    fn is_beyond(self, a: i64) -> bool {
        a.unsigned_abs() >= 1 << 30
    }

    #[inline(always)]
    fn are_beyond(self, any: [i64; 2], low: [i64; 2]) -> bool {
        const BOUND: i64 = 1 << 30;
        // Sums from 0 to 2^31 − 1 have no bits above these.
        let sums = any.map(|a| a.wrapping_add(BOUND));
        (sums[0] | sums[1]) >> 31 != 0 || low[0].min(low[1]) < -2 * BOUND
    }

    #[inline(always)]
    fn are_pushes(self, impulses: [i64; 2], changes: [i64; 2]) -> bool {
        (impulses[0] | impulses[1]) >= 0 && !self.are_beyond(changes, [0; 2])
    }

    #[inline(always)]
    fn multiples(self, [v, w]: [i64; 2], factor: i64) -> [i64; 2] {
        // Where all lanes have the factor compilers extend its sign ahead of the loop, and multiply by two words then.
        let factor = black_box(factor);
        [lowered_low(product(v, factor), 30), lowered_low(product(w, factor), 30)]
    }

    #[inline(always)]
    fn upper_word(self, a: i64, b: i64) -> i64 {
        upper(product(a, b))
    }

    #[inline(always)]
    fn lowered_product(self, a: i64, b: i64) -> i64 {
        lowered_low(product(a, b), 38)
    }

    #[inline(always)]
    fn dot(self, [k, l]: [i32; 2], [v, w]: [i64; 2]) -> [i64; 2] {
        let sum = product(k.into(), v) + product(l.into(), w);
        [(sum >> 30) as i64, sum as i64 & 0x3fff_ffff]
    }

    #[inline(always)]
    fn lowered_dot(self, [k, l]: [i32; 2], [v, w]: [i64; 2]) -> i64 {
        lowered_low(product(k.into(), v) + product(l.into(), w), 20)
    }

    #[inline(always)]
    fn lowered_way(self, base: i64, [k, l]: [i32; 2], [v, w]: [i64; 2]) -> i64 {
        const SMALL: i64 = 1 << 31;
        let (k, l) = (i64::from(k), i64::from(l));
        if ((base + SMALL) | (v + SMALL) | (w + SMALL)) as u64 >> 32 == 0 {
            // Below 2^63 − 2^61.
            let sum = (base << 30) + k * v + l * w;
            return (sum + (1 << 33) - i64::from(sum < 0)) >> 34;
        }
        lowered_low(product(base, 1 << 30) + product(k, v) + product(l, w), 34)
    }

    #[inline(always)]
    fn dot_within(self, [k, l]: [i32; 2], [v, w]: [i64; 2], bits: i64, limit: i64) -> i64 {
        let (k, l, limit) = (i64::from(k), i64::from(l), 1 << limit);
        if bits < 8 {
            let dot = (product(k, v) + product(l, w)) << (30 - bits);
            return odd_shift(dot, 30).clamp(-limit, limit) as i64;
        }
        // Raised, the number stands in the upper word.
        let (up, limit) = (38 - bits, limit as i64);
        let dot = product(k << up, v << 26) + product(l << up, w << 26);
        upper(dot).min(limit).max(-limit)
    }

    #[inline(always)]
    fn add_products(self, sums: &mut [i64; 3], [v, w]: [i64; 2], [x, y]: [i64; 2], down: i64) {
        let product = product(v, x) + product(w, y);
        let product = if down == 0 { product } else { product >> down.min(127) };
        // Two words.
        let sum = self.total(*sums) + product;
        *sums = [(sum >> 64) as i64, sum as i64, 0];
    }

    #[inline(always)]
    fn total(self, [high, low, _]: [i64; 3]) -> i128 {
        i128::from(high) << 64 | i128::from(low as u64)
    }

    #[inline(always)]
    fn speeds_of(self, speeds: &[Speeds], index: &[u32; GROUP], at: usize) -> [i64; 3] {
        let [x, y, turn, _] = speeds[index[at] as usize].0;
        [x, y, turn]
    }

    #[inline(always)]
    fn add_speeds(self, speeds: &mut [Speeds], index: &[u32; GROUP], at: usize, change: [i64; 3]) {
        let Speeds(sums) = &mut speeds[index[at] as usize];
        (0..3).for_each(|k| sums[k] += change[k]);
    }

    #[inline(always)]
    fn words_of(self, lines: &[Line], index: &[u32; GROUP], at: usize) -> [i64; 8] {
        lines[index[at] as usize].0
    }

    #[inline(always)]
    fn columns(self, rows: &[[i64; 4]; GROUP], at: usize) -> [i64; 4] {
        rows[at]
    }

    #[inline(always)]
    fn gather(self, rows: &[Row], index: &[u32; GROUP], at: usize) -> Gathered<i32> {
        let row = &rows[index[at] as usize];
        let ([vx, vy, spin, angle], [x, y, ..]) = (row.velocity, row.displacement);
        Gathered { velocity: [vx, vy, spin], displacement: [x, y, angle] }
    }

    #[inline(always)]
    fn add_gains(self, rows: &mut [Row], index: &[u32; GROUP], at: usize, change: [i64; 3]) {
        let gain = &mut rows[index[at] as usize].gain;
        (0..3).for_each(|i| gain[i] += change[i]);
    }
}

impl Quads for Portable {
    type Quad = [i32; 4];

    #[inline(always)]
    fn quad(self, words: &[i32; 4]) -> [i32; 4] {
        *words
    }

    #[inline(always)]
    fn put(self, words: &mut [i32; 4], value: [i32; 4]) {
        *words = value;
    }

    #[inline(always)]
    fn quad_plus(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }

    #[inline(always)]
    fn quad_minus(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
    }

    #[inline(always)]
    fn quad_clamped(self, a: [i32; 4], limit: i32) -> [i32; 4] {
        a.map(|a| a.clamp(-limit, limit))
    }

    #[inline(always)]
    fn quad_share(self, a: [i32; 4], share: i32) -> [i32; 4] {
        a.map(|a| self.rounded_oddly::<30>(self.times(a, share)) as i32)
    }

    #[inline(always)]
    fn quad_joined(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        [a[0], a[1], a[2], b[3]]
    }

    #[inline(always)]
    fn take_gain(self, row: &mut Row, limit: i32) -> bool {
        let [vx, vy, spin, angle] = row.velocity;
        let gained: [i64; 3] = core::array::from_fn(|i| self.rounded_oddly::<GAIN_BITS>(row.gain[i]));
        let sums = [i64::from(vx) + gained[0], i64::from(vy) + gained[1], i64::from(spin) + gained[2]];
        let limit = i64::from(limit);
        let is_within = sums.iter().all(|sum| (-limit..limit).contains(sum));
        if is_within {
            row.velocity = [sums[0] as i32, sums[1] as i32, sums[2] as i32, angle];
            (0..3).for_each(|i| row.gain[i] -= gained[i] << GAIN_BITS);
        }
        is_within
    }
}
