//! Forces, torques, accelerations and energies in fixed point.

use core::fmt;

use super::factor::FxFactor;
use super::fx::Fx;
use super::{Sum, Wide};
use crate::kernel::round::shr_round;
use crate::kernel::wide::{mul_shift, shift_round_256};

/// A multiple of 2^-64 up to ±2^63: the exact product of two [`Fx`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct FxWide(i128);

impl FxWide {
    /// The multiple of 2^-64.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: i128) -> Self {
        Self(bits)
    }

    /// Multiples of 2^-64.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> i128 {
        self.0
    }

    /// In ulps of `Fx`, to nearest, ties to even.
    #[inline]
    pub(crate) const fn ulps(self) -> i128 {
        shr_round(self.0, 32)
    }
}

/// The exact decimal, all digits of it.
impl fmt::Display for FxWide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.unsigned_abs();
        let mut digits = [b'0'; 64];
        let mut fraction = magnitude as u64;
        let mut count = 0;
        while fraction != 0 {
            // Ten times a fraction below 2^64: the digit is what is above.
            let ten = u128::from(fraction) * 10;
            digits[count] = b'0' + (ten >> 64) as u8;
            fraction = ten as u64;
            count += 1;
        }
        if let Some(wanted) = f.precision() {
            // Tools that ask for fewer digits want a column, not a bound: cut, and pad up to what there is.
            count = wanted.min(64);
        }
        let digits = core::str::from_utf8(&digits[..count]).unwrap_or_default();
        let (sign, point) = (if self.0 < 0 { "-" } else { "" }, if count == 0 { "" } else { "." });
        write!(f, "{sign}{}{point}{digits}", magnitude >> 64)
    }
}

impl Wide<Fx> for FxWide {
    #[inline]
    fn from_scalar(value: Fx) -> Self {
        Self(i128::from(value.to_bits()) << 32)
    }

    fn from_factor(magnitude: FxFactor, negative: bool) -> Option<Self> {
        let (mantissa, shift) = magnitude.parts();
        let bits = i128::try_from(shift_round_256(0, u128::from(mantissa), shift - 64)?).ok()?;
        Some(Self(if negative { -bits } else { bits }))
    }

    #[inline]
    fn to_scalar(self) -> Option<Fx> {
        i64::try_from(self.ulps()).ok().map(Fx::from_bits)
    }

    #[inline]
    fn plus(self, other: Self) -> Option<Self> {
        self.0.checked_add(other.0).map(Self)
    }

    #[inline]
    fn negated(self) -> Self {
        // i128::MIN is −2^63 exactly; nothing the engine makes reaches it, and staying there is no worse than wrapping.
        Self(self.0.saturating_neg())
    }

    #[inline]
    fn times(self, factor: FxFactor) -> Option<Self> {
        let (mantissa, shift) = factor.parts();
        mul_shift(self.0, u128::from(mantissa), shift).map(Self)
    }

    #[inline]
    fn is_negative(self) -> bool {
        self.0 < 0
    }

    #[inline]
    fn to_bits(self) -> i128 {
        self.0
    }
}

/// A sum of wide values modulo 2^64, and how often it went round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FxSum {
    low: i128,
    carries: i32,
}

impl Sum<Fx> for FxSum {
    #[inline]
    fn add(&mut self, term: FxWide) {
        let (low, wrapped) = self.low.overflowing_add(term.0);
        self.low = low;
        // A wrap goes the way of the term's sign; 2^31 terms cannot wrap this count. That pair is one integer of 160
        // bits, so the order of the terms does not matter.
        self.carries = self.carries.wrapping_add(if wrapped { if term.0 < 0 { -1 } else { 1 } } else { 0 });
    }

    #[inline]
    fn total(self) -> Option<FxWide> {
        (self.carries == 0).then_some(FxWide(self.low))
    }

    fn to_bits(self) -> (i128, i32) {
        (self.low, self.carries)
    }
}
