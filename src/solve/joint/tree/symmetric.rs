//! Symmetric matrices of two rows, and reciprocals. [`tree`](super) has their ranges.

use super::{IMPULSE, PART, RATIO, SOFT, SPEED, TO_IMPULSE, UNIT};
use crate::solve::number::{
    lowered, lowered_low, lowered_low_by, lowered_within, product, shifted, shifted_word, upper, within, within_word,
};

/// Bits by which vectors in 2^-[`UNIT`] are raised, to at most 2^62, and their factors, to below 2^63: the wanted bits of the products stand in
/// the upper words.
const RAISED_UNIT: i32 = 32;
const RAISED: i32 = 64 - UNIT - RAISED_UNIT;

/// A symmetric matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Symmetric {
    pub(super) xx: i64,
    pub(super) xy: i64,
    pub(super) yy: i64,
}

/// The exact scalar product.
#[inline(always)]
pub(super) fn dot(a: [i64; 2], b: [i64; 2]) -> i128 {
    product(a[0], b[0]) + product(a[1], b[1])
}

/// [`dot`] over 2^[`UNIT`]. *Domain* components of the first one are within 2^[`UNIT`], of the second one below 2^61.
#[inline(always)]
pub(super) fn unit_dot(unit: [i64; 2], v: [i64; 2]) -> i64 {
    upper(dot([unit[0] << RAISED_UNIT, unit[1] << RAISED_UNIT], [v[0] << RAISED, v[1] << RAISED]))
}

/// Both products of a vector and a number, over 2^[`UNIT`]. *Domain* components are within 2^[`UNIT`], the factor is below 2^61.
#[inline(always)]
pub(super) fn scaled(v: [i64; 2], factor: i64) -> [i64; 2] {
    let factor = factor << RAISED;
    [upper(product(v[0] << RAISED_UNIT, factor)), upper(product(v[1] << RAISED_UNIT, factor))]
}

/// A product of masses and velocities as an impulse.
#[inline(always)]
pub(super) fn to_impulse(product: i128) -> i64 {
    lowered_within(product, TO_IMPULSE, IMPULSE as i64)
}

/// [`shifted_word`], most often by no bits.
#[inline(always)]
pub(super) fn rarely_shifted(value: i64, bits: i32) -> i64 {
    if bits == 0 { value } else { shifted_word(value, bits) }
}

/// A vector turned left by a quarter.
#[inline(always)]
pub(super) fn turned([x, y]: [i64; 2]) -> [i64; 2] {
    [-y, x]
}

/// The sum of a vector and a multiple of another one, in 2^-[`UNIT`].
#[inline(always)]
pub(super) fn moved(v: [i64; 2], factor: i64, along: [i64; 2]) -> [i64; 2] {
    let [x, y] = scaled(along, factor);
    [v[0] + x, v[1] + y]
}

/// A quotient's denominator as a factor: 1/value = mantissa · 2^-shift, with 61 or 62 bits. *Error* 2^-60. Zero for a value that is not
/// positive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reciprocal {
    pub(super) mantissa: i64,
    pub(super) shift: i32,
}

impl Default for Reciprocal {
    /// The one of zero.
    fn default() -> Self {
        Self::new(0)
    }
}

impl Reciprocal {
    #[inline(always)]
    pub(super) fn new(value: i64) -> Self {
        if value <= 0 {
            return Self { mantissa: 0, shift: 62 };
        }
        Self::of_positive(value)
    }

    /// [`new`](Self::new) of a positive value.
    #[inline(always)]
    pub(super) fn of_positive(value: i64) -> Self {
        // The top 63 bits.
        let zeros = value.leading_zeros() as i32 - 1;
        Self::of_top((value as u64) << zeros, 124 - zeros)
    }

    /// 2^124/top as the mantissa, with this shift. *Domain* 2^62 ≤ top < 2^63.
    #[inline(always)]
    fn of_top(top: u64, shift: i32) -> Self {
        // 2^94/top with 31 bits, and a step of Newton's method: r(2 − top·r).
        let first = (1_u64 << 63) / (top >> 31);
        let square = (u128::from(top) * u128::from(first)) >> 32;
        let less = (1_u64 << 63).wrapping_sub(square as u64);
        Self { mantissa: ((u128::from(first) * u128::from(less)) >> 32) as i64, shift }
    }

    #[inline(always)]
    pub(super) fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    /// The reciprocal of the top bits of a double word.
    #[inline(always)]
    pub(super) fn of_double(value: i128) -> Self {
        let high = (value >> 64) as i64;
        if high > 0 {
            return Self::of_high(value, high);
        }
        let down = (bits_of_double(value) - 62).max(0);
        let Self { mantissa, shift } = Self::new((value >> down) as i64);
        Self { mantissa, shift: shift + down }
    }

    /// The reciprocal of the top bits of a double word with an upper word that is positive.
    #[inline(always)]
    pub(super) fn of_high(value: i128, high: i64) -> Self {
        // The top 62 bits of 128, at the place of the top 63.
        let zeros = high.leading_zeros() as i32;
        let top = (high as u64) << zeros | (value as u64) >> 1 >> (63 - zeros);
        Self::of_top(top >> 2 << 1, 189 - zeros)
    }

    /// value/denominator · 2^up. *Domain* |value| < 2^63, and 1 ≤ shift − up ≤ 126.
    #[inline(always)]
    pub(super) fn times(self, value: i64, up: i32) -> i128 {
        lowered(product(value, self.mantissa), self.shift - up)
    }

    /// [`times`](Self::times), if it is below 2^61.
    #[inline(always)]
    pub(super) fn times_small(self, value: i64, up: i32) -> Option<i64> {
        let bits = self.shift - up;
        if bits > 64 {
            // The half is in the upper word.
            let product = product(value, self.mantissa);
            let high = ((product + (product >> 127)) >> 64) as i64;
            return Some((high + (1 << (bits - 65))) >> (bits - 64));
        }
        // Raised, it is below 2^63, and the product with the mantissa below 2^125.
        let room = 64 - bits;
        let raised = value << room;
        (raised >> room == value).then(|| upper(product(raised, self.mantissa)))
    }

    /// [`times`](Self::times) within ±limit.
    #[inline(always)]
    pub(super) fn times_within(self, value: i64, up: i32, limit: i128) -> i64 {
        match self.times_small(value, up) {
            Some(quotient) => within_word(quotient, limit),
            None => within(self.times(value, up), limit),
        }
    }

    /// [`times`](Self::times) of an impulse as a velocity, less a product in 2^-[`RATIO`], within ±[`SPEED`].
    #[inline(always)]
    pub(super) fn less_ratio(self, impulse: i64, ratio: i128) -> i64 {
        match self.times_small(impulse, TO_IMPULSE) {
            // More than that is too much in any case: both are below 2^62.
            Some(velocity) => within_word(velocity - lowered_within(ratio, RATIO, 1 << 62), SPEED),
            None => within(self.times(impulse, TO_IMPULSE) - lowered(ratio, RATIO), SPEED),
        }
    }

    /// The lower word of [`times`](Self::times).
    #[inline(always)]
    fn times_low(self, value: i64, up: i32) -> i64 {
        self.times_small(value, up).unwrap_or_else(|| self.times(value, up) as i64)
    }

    /// [`times`](Self::times) of a double word, within ±limit.
    #[inline(always)]
    pub(super) fn times_double(self, value: i128, up: i32, limit: i128) -> i64 {
        let down = (bits_of_double(value) - 62).max(0);
        let bits = self.shift - up - down;
        let top = shifted(value, down) as i64;
        match bits {
            1..=126 => lowered(product(top, self.mantissa), bits).clamp(-limit, limit) as i64,
            127.. => 0,
            // A product of at least 2^61, if it is not zero.
            _ => (top.signum() as i128 * limit) as i64,
        }
    }
}

/// The number of bits of the magnitude.
#[inline(always)]
pub(super) fn bits_of_double(value: i128) -> i32 {
    128 - value.unsigned_abs().leading_zeros() as i32
}

impl Symmetric {
    #[inline(always)]
    pub(super) fn isotropic(value: i64) -> Self {
        Self { xx: value, xy: 0, yy: value }
    }

    #[inline(always)]
    pub(super) fn plus(self, matrix: Self) -> Self {
        Self { xx: self.xx + matrix.xx, xy: self.xy + matrix.xy, yy: self.yy + matrix.yy }
    }

    /// The exact product with a vector.
    #[inline(always)]
    pub(super) fn times(&self, v: [i64; 2]) -> [i128; 2] {
        [product(self.xx, v[0]) + product(self.xy, v[1]), product(self.xy, v[0]) + product(self.yy, v[1])]
    }

    /// The product with a vector in 2^-bits.
    #[inline(always)]
    pub(super) fn lowered_times(&self, v: [i64; 2], bits: i32) -> [i64; 2] {
        let [x, y] = self.times(v);
        [lowered(x, bits) as i64, lowered(y, bits) as i64]
    }

    /// The product with a vector in 2^-[`UNIT`] within 2^[`UNIT`]. *Domain* elements are below 2^61.
    #[inline(always)]
    pub(super) fn times_unit(&self, unit: [i64; 2]) -> [i64; 2] {
        let raised = Self { xx: self.xx << RAISED, xy: self.xy << RAISED, yy: self.yy << RAISED };
        let [x, y] = raised.times([unit[0] << RAISED_UNIT, unit[1] << RAISED_UNIT]);
        [upper(x), upper(y)]
    }

    /// The impulse of a spring by a velocity.
    #[inline(always)]
    pub(super) fn push(&self, v: [i64; 2]) -> [i64; 2] {
        let [x, y] = self.times(v);
        [to_impulse(x), to_impulse(y)]
    }

    /// The element-wise shift by bits, down.
    #[inline(always)]
    pub(super) fn shifted(self, bits: i32) -> Self {
        if bits == 0 {
            return self;
        }
        Self { xx: shifted_word(self.xx, bits), xy: shifted_word(self.xy, bits), yy: shifted_word(self.yy, bits) }
    }

    /// The determinant.
    #[inline(always)]
    pub(super) fn determinant(&self) -> i128 {
        product(self.xx, self.yy) - product(self.xy, self.xy)
    }

    /// The velocity of a mass by an impulse. Zero for a matrix that has no inverse.
    pub(super) fn velocity_by(&self, [x, y]: [i64; 2]) -> [i64; 2] {
        let reciprocal = Reciprocal::of_double(self.determinant());
        let by_x = product(self.yy, x) - product(self.xy, y);
        let by_y = product(self.xx, y) - product(self.xy, x);
        [reciprocal.times_double(by_x, TO_IMPULSE, SPEED), reciprocal.times_double(by_y, TO_IMPULSE, SPEED)]
    }

    /// The product with a compliance, in 2^-[`PART`].
    #[inline(always)]
    pub(super) fn given_way(&self, compliance: i64) -> Self {
        // Below 2^61.
        let part = |value: i64| lowered_low(product(value, compliance), SOFT - PART);
        Self { xx: part(self.xx), xy: part(self.xy), yy: part(self.yy) }
    }

    /// S = (E⁻¹ + γ)⁻¹
    #[inline(always)]
    pub(super) fn softened(&self, compliance: i64) -> Self {
        let g = self.given_way(compliance);
        // In 2^-2·PART.
        let sum = (1 << (2 * PART)) + ((i128::from(g.xx) + i128::from(g.yy)) << PART) + g.determinant();
        // γ det(E) in 2^-PART, from the determinant: rounded alike after a quarter turn.
        let more = ((product(g.xx, self.yy) + product(g.yy, self.xx)) >> 1) - product(g.xy, self.xy);
        let numerators =
            [(i128::from(self.xx) << PART) + more, i128::from(self.xy) << PART, (i128::from(self.yy) << PART) + more];
        let reciprocal = Reciprocal::of_double(sum);
        let largest = numerators[0].max(numerators[2]);
        let high = (largest >> 64) as i64;
        if high > 0 && high.leading_zeros() > 3 {
            // Most often. Below 2^124: from 3 to 62 bits.
            let down = 66 - high.leading_zeros() as i32;
            let element = |numerator: i128| reciprocal.times_low(lowered_low_by(numerator, down), PART + down);
            return Self { xx: element(numerators[0]), xy: element(numerators[1]), yy: element(numerators[2]) };
        }
        let down = (bits_of_double(largest) - 62).max(0);
        let element = |numerator: i128| {
            let top = if down == 0 { numerator } else { lowered(numerator, down) };
            reciprocal.times(top as i64, PART + down) as i64
        };
        Self { xx: element(numerators[0]), xy: element(numerators[1]), yy: element(numerators[2]) }
    }
}
