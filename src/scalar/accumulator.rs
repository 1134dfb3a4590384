//! Components of positions and velocities in fixed point.

use super::factor::FxFactor;
use super::fx::Fx;
use super::{Accumulator, TRANSIENT_SPEED_LOG2};
use crate::kernel::round::shr_round;
use crate::kernel::wide::mul_shift;

/// A multiple of 2^-96: an [`Fx`] and 64 bits below its ulp, where the remainders of every step are carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct FxAccumulator(i128);

impl FxAccumulator {
    /// The accumulator of this multiple of 2^-96.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: i128) -> Self {
        Self(bits)
    }
}

impl Accumulator<Fx> for FxAccumulator {
    #[inline]
    fn from_scalar(value: Fx) -> Self {
        Self((value.to_bits() as i128) << 64)
    }

    #[inline]
    fn value(self) -> Fx {
        // A body that left the envelope is still below 2^31 here: `limits` has the proof.
        Fx::from_bits(shr_round(self.0, 64) as i64)
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        // Positions stay below 2^31 m = 2^127 / 2^96, velocities below 2^26 m/s: see `limits`.
        Self(self.0.wrapping_add(other.0))
    }

    #[inline]
    fn negated(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    #[inline]
    fn scaled(self, factor: FxFactor) -> Option<Self> {
        let (mantissa, shift) = factor.parts();
        let product = if shift == 64 && self.0.unsigned_abs() < TRANSIENT {
            // A factor in [½, 1), as damping has it. |high| < 2^56, so high·mantissa < 2^120.
            let (high, low) = ((self.0 >> 64) as i64, self.0 as u64);
            let low = u128::from(low) * u128::from(mantissa);
            let floor = i128::from(high) * i128::from(mantissa) + (low >> 64) as i128;
            let rest = low as u64;
            const TIE: u64 = 1 << 63;
            floor + i128::from(rest > TIE || (rest == TIE && floor & 1 == 1))
        } else {
            mul_shift(self.0, u128::from(mantissa), shift)?
        };
        if product.unsigned_abs() >= TRANSIENT {
            return None;
        }
        // Half an ulp rounds to zero, ties to even.
        Some(Self(if product.unsigned_abs() <= 1 << 63 { 0 } else { product }))
    }

    #[inline]
    fn is_within(self, limit: Fx) -> bool {
        self.0.unsigned_abs() <= (limit.to_bits() as u128) << 64
    }

    #[inline]
    fn to_bits(self) -> i128 {
        self.0
    }
}

/// The speed between stages, in units of 2^-96.
const TRANSIENT: u128 = 1 << (96 + TRANSIENT_SPEED_LOG2);
