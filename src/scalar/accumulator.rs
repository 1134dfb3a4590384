//! Components of positions and velocities in fixed point.

use core::fmt;

use super::factor::FxFactor;
use super::fx_bulk;
use super::motion::TRANSIENT_SPEED_LOG2;
use super::number::{Accumulator, Number, inherent};
use crate::fx::{Fx, decimal};
use crate::kernel::round::shr_round;
use crate::kernel::wide::mul_shift_64;

/// A multiple of 2^-96: an [`Fx`] and 64 bits below its ulp, where the remainders of every step are carried.
///
/// It is kept as two words, so that loops over many of them can be compiled to vector instructions.
///
/// ```
/// use umbra_physics::{Fx, FxAccumulator, fx};
///
/// let third_of_an_ulp = FxAccumulator::from_bits((1 << 64) / 3);
/// let three = FxAccumulator::from_bits(3 * third_of_an_ulp.to_bits());
/// assert_eq!((third_of_an_ulp.value(), three.value(), three.negated().value()), (fx!(0), Fx::DELTA, -Fx::DELTA));
/// assert_eq!(FxAccumulator::from_scalar(fx!(1.5)).value(), fx!(1.5));
/// assert!(third_of_an_ulp.is_within(Fx::DELTA) && !third_of_an_ulp.is_within(fx!(0)));
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FxAccumulator {
    /// Multiples of 2^-32, rounded down. The first field, so that the derived order is that of the values.
    pub(super) high: i64,
    /// Multiples of 2^-96 above that.
    pub(super) low: u64,
}

impl FxAccumulator {
    /// The accumulator of this multiple of 2^-96.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: i128) -> Self {
        Self { high: (bits >> 64) as i64, low: bits as u64 }
    }

    /// The accumulator of this value, exactly.
    #[inline]
    #[must_use]
    pub fn from_scalar(value: Fx) -> Self {
        Self { high: value.to_bits(), low: 0 }
    }

    /// The nearest [`Fx`], ties to even: the public value. *Domain* it fits, as it does within [`limits`](crate::limits).
    #[inline]
    #[must_use]
    pub fn value(self) -> Fx {
        // A body that left the envelope is still below 2^31 here: `limits` has the proof.
        Fx::from_bits(shr_round(self.bits(), 64) as i64)
    }

    /// The multiple of 2^-96.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> i128 {
        self.bits()
    }

    /// The negative, exactly.
    #[inline]
    #[must_use]
    pub const fn negated(self) -> Self {
        Self::from_bits(self.bits().wrapping_neg())
    }

    /// Returns true if the magnitude is at most `limit`. *Domain* limit ≥ 0.
    #[inline]
    #[must_use]
    pub fn is_within(self, limit: Fx) -> bool {
        let limit = limit.to_bits();
        (-limit..limit).contains(&self.high) || (self.high == limit && self.low == 0)
    }

    #[inline]
    pub(super) const fn bits(self) -> i128 {
        (self.high as i128) << 64 | self.low as i128
    }

    /// Zero where the public value is zero (half an ulp rounds to zero, ties to even); else these bits.
    ///
    /// So a damped body comes to rest: a product that is only rounded stays at some multiples of 2^-96 for ever.
    #[inline]
    const fn settled(bits: i128) -> Self {
        Self::from_bits(if bits.unsigned_abs() <= 1 << 63 { 0 } else { bits })
    }

    /// The product with a factor of at most 1, or zero if its public value is zero.
    #[inline]
    pub(super) fn shrunk(self, factor: FxFactor) -> Self {
        let (mantissa, shift) = factor.parts();
        // At most as large as it was, so it fits.
        Self::settled(mul_shift_64(self.bits(), mantissa, shift).unwrap_or(0))
    }
}

/// The exact decimal, all digits of it; with a precision, that many, rounded to nearest, ties to even.
impl fmt::Display for FxAccumulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (bits, magnitude) = (self.bits(), self.bits().unsigned_abs());
        decimal::write(f, bits < 0, (magnitude >> 96) as u64, magnitude << 32)
    }
}

impl fmt::Debug for FxAccumulator {
    /// Writes the number as [`Display`](fmt::Display) does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Number for FxAccumulator {
    const WORDS: usize = 2;

    fn to_words(self) -> [u64; 3] {
        [self.high as u64, self.low, 0]
    }
}

impl Accumulator<Fx> for FxAccumulator {
    inherent! {
        fn from_scalar(value: Fx) -> Self;
        fn value(self: Self) -> Fx;
        fn negated(self: Self) -> Self;
        fn to_bits(self: Self) -> i128;
        fn is_within(self: Self, limit: Fx) -> bool;
    }

    #[inline]
    fn to_fixed(self) -> Self {
        self
    }

    #[inline]
    fn from_fixed(value: Self) -> Self {
        value
    }

    #[inline]
    fn is_still(self) -> bool {
        // From −½ to ½ ulp.
        match self.high {
            0 => self.low <= 1 << 63,
            -1 => self.low >= 1 << 63,
            _ => false,
        }
    }

    #[inline]
    fn plus(self, rhs: Self) -> Self {
        // Positions stay below 2^31 m = 2^127 / 2^96, velocities below 2^26 m/s: see `limits`.
        Self::from_bits(self.bits().wrapping_add(rhs.bits()))
    }

    #[inline]
    fn scaled(self, factor: FxFactor) -> Option<Self> {
        let (mantissa, shift) = factor.parts();
        let product = mul_shift_64(self.bits(), mantissa, shift)?;
        (product.unsigned_abs() < TRANSIENT).then_some(Self::settled(product))
    }

    #[inline(always)]
    fn damped(self, kept: FxFactor) -> Self {
        fx_bulk::damped(self, kept)
    }

    #[inline]
    fn to_bytes(self) -> [u8; 16] {
        // The bytes of the default method, made word by word: so the compiler copies the words as they lie in memory.
        let (high, low) = (self.high.to_le_bytes(), self.low.to_le_bytes());
        core::array::from_fn(|i| if i < 8 { high[i] } else { low[i - 8] })
    }
}

/// The speed between stages, in units of 2^-96.
const TRANSIENT: u128 = 1 << (96 + TRANSIENT_SPEED_LOG2);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_velocities_that_round_to_zero_count_as_still() {
        let half = 1i128 << 63;
        for (bits, is_still) in
            [(0, true), (1, true), (half - 1, true), (half, true), (half + 1, false), (3 * half, false)]
        {
            for bits in [bits, -bits] {
                let value = FxAccumulator::from_bits(bits);
                assert_eq!((value.is_still(), value.value() == Fx::ZERO), (is_still, is_still), "{bits}");
            }
        }
    }
}
