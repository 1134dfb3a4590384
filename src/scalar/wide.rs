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

/// The exact decimal, all digits of it; with a precision, that many, rounded to nearest, ties to even.
impl fmt::Display for FxWide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // 2^63 has 19 digits, and a multiple of 2^-64 at most 64 behind the point.
        let mut text = [b'0'; 19 + 1 + 64];
        let magnitude = self.0.unsigned_abs();
        let (mut whole, mut fraction) = ((magnitude >> 64) as u64, magnitude as u64);
        let wanted = f.precision().unwrap_or(64).min(64);
        let mut count = 0;
        while count < wanted && (fraction != 0 || f.precision().is_some()) {
            // Ten times a fraction below 2^64: the digit is what is above.
            let ten = u128::from(fraction) * 10;
            text[20 + count] = b'0' + (ten >> 64) as u8;
            fraction = ten as u64;
            count += 1;
        }
        let last = if count == 0 { whole as u8 } else { text[19 + count] };
        if fraction > 1 << 63 || (fraction == 1 << 63 && last % 2 == 1) {
            let nines = text[20..20 + count].iter().rev().take_while(|&&digit| digit == b'9').count();
            text[20 + count - nines..20 + count].fill(b'0');
            if nines == count { whole += 1 } else { text[19 + count - nines] += 1 }
        }
        text[19] = b'.';
        let mut start = 19;
        while whole != 0 || start == 19 {
            start -= 1;
            text[start] = b'0' + (whole % 10) as u8;
            whole /= 10;
        }
        let end = if count == 0 { 19 } else { 20 + count };
        // What rounds to zero has no sign.
        let is_zero = text[start..end].iter().all(|&byte| byte == b'0' || byte == b'.');
        f.pad_integral(self.0 >= 0 || is_zero, "", core::str::from_utf8(&text[start..end]).unwrap_or_default())
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
    carries: i64,
}

#[cfg(feature = "serde")]
impl FxSum {
    pub(super) const fn from_bits(low: i128, carries: i64) -> Self {
        Self { low, carries }
    }
}

impl Sum<Fx> for FxSum {
    #[inline]
    fn add(&mut self, term: FxWide) {
        let (low, wrapped) = self.low.overflowing_add(term.0);
        self.low = low;
        // A wrap goes the way of the term's sign, and 2^63 of them are never reached. The pair is one integer of 192
        // bits, so the order of the terms does not matter.
        self.carries = self.carries.wrapping_add(if wrapped { if term.0 < 0 { -1 } else { 1 } } else { 0 });
    }

    #[inline]
    fn total(self) -> Option<FxWide> {
        (self.carries == 0).then_some(FxWide(self.low))
    }

    fn to_bits(self) -> (i128, i64) {
        (self.low, self.carries)
    }
}

#[cfg(test)]
mod tests {
    use alloc::format;

    use super::FxWide;

    #[test]
    fn decimals_are_exact_and_shorter_ones_rounded_once() {
        let wide = |ulps: i128| FxWide::from_bits(ulps << 32);
        assert_eq!(format!("{}", wide(-5 << 30)), "-1.25");
        assert_eq!(format!("{:.1}", wide(-5 << 30)), "-1.2");
        assert_eq!(format!("{:.1}", wide(7 << 30)), "1.8");
        assert_eq!(format!("{:.0}|{:.0}|{:.0}", wide(1 << 31), wide(3 << 31), wide(5 << 31)), "0|2|2");
        assert_eq!(format!("{:.3}", wide((10 << 32) - 1)), "10.000");
        assert_eq!(format!("{:.0}", FxWide::from_bits(-1)), "0");
        assert_eq!(format!("{:8.2}|{:<6}|", wide(1 << 32), wide(0)), "    1.00|0     |");
        assert_eq!(format!("{}", FxWide::from_bits(i128::MIN)), "-9223372036854775808");
        assert_eq!(format!("{}", FxWide::from_bits(1)).len(), 66);
        assert_eq!(format!("{:.2}", FxWide::from_bits(i128::MAX)), "9223372036854775808.00");
    }
}
