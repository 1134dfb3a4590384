//! Forces, torques, accelerations and energies in fixed point.

use core::fmt;

use super::factor::FxFactor;
use super::number::{Number, Sum, Wide, inherent};
use crate::fx::{Fx, decimal};
use crate::kernel::round::shr_round;
use crate::kernel::wide::{mul_shift_64, shift_round_256};

/// A multiple of 2^-64 up to ±2^63: the exact product of two [`Fx`].
///
/// ```
/// use umbra_physics::{FxFactor, FxWide, fx};
///
/// let product = fx!(1.5).wide_mul(fx!(-0.1)); // exactly, of 0.1 as it is here
/// assert_eq!(product.to_string(), "-0.15000000013969838619232177734375");
/// assert_eq!((product.to_scalar(), product.is_negative()), (fx!(1.5).checked_mul(fx!(-0.1)), true));
/// let force = FxWide::from(fx!(2)).times(FxFactor::from_ratio(1, 4)).and_then(|half| half.plus(fx!(1).into()));
/// assert_eq!((force.map(FxWide::negated), FxWide::from_factor(3.into(), true)), (Some(fx!(-1.5).into()), Some(FxWide::from_scalar(fx!(-3)))));
/// assert_eq!(FxWide::from_bits(product.to_bits()), product);
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

    /// The value in ulps of `Fx`, rounded to nearest, ties to even.
    #[inline]
    pub(crate) const fn ulps(self) -> i128 {
        shr_round(self.0, 32)
    }

    /// [`ulps`](Self::ulps) as a word; `None` next to 2^63 and beyond.
    #[inline(always)]
    pub(super) const fn ulps_of_a_word(self) -> Option<i64> {
        let (upper, lower) = ((self.0 >> 64) as i64, self.0 as u64);
        // One less either way than the upper half of a word may be: so the floor has another number above it, and no sign turns.
        if upper < i32::MIN as i64 + 1 || upper > i32::MAX as i64 - 1 {
            return None;
        }
        let floor = upper << 32 | (lower >> 32) as i64;
        // The rest is above half, or half and the floor odd.
        Some(floor + ((lower as u32 as u64 + (floor as u64 & 1)) > 1 << 31) as i64)
    }
}

/// The exact decimal, all digits of it; with a precision, that many, rounded to nearest, ties to even.
impl fmt::Display for FxWide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.unsigned_abs();
        decimal::write(f, self.0 < 0, (magnitude >> 64) as u64, magnitude << 64)
    }
}

impl fmt::Debug for FxWide {
    /// Writes the number as [`Display`](fmt::Display) does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Number for FxWide {
    const WORDS: usize = 2;

    fn to_words(self) -> [u64; 3] {
        [(self.0 >> 64) as u64, self.0 as u64, 0]
    }
}

impl FxWide {
    /// Converts a scalar, exactly.
    #[must_use]
    #[inline]
    pub fn from_scalar(value: Fx) -> Self {
        Self(i128::from(value.to_bits()) << 32)
    }

    /// The value nearest to plus or minus `magnitude`; `None` if it does not fit. *Error* ½ of 2^-64.
    #[must_use]
    pub fn from_factor(magnitude: FxFactor, negative: bool) -> Option<Self> {
        let (mantissa, shift) = magnitude.parts();
        let bits = i128::try_from(shift_round_256(0, u128::from(mantissa), shift - 64)?).ok()?;
        Some(Self(if negative { -bits } else { bits }))
    }

    /// The nearest [`Fx`], ties to even; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    #[inline]
    pub fn to_scalar(self) -> Option<Fx> {
        i64::try_from(self.ulps()).ok().map(Fx::from_bits)
    }

    /// The sum, exactly; `None` if it does not fit.
    #[must_use]
    #[inline]
    pub fn plus(self, rhs: Self) -> Option<Self> {
        self.0.checked_add(rhs.0).map(Self)
    }

    /// The negative, exactly; for the least value, whose negative does not fit, the greatest.
    #[must_use]
    #[inline]
    pub fn negated(self) -> Self {
        // Nothing that the engine makes reaches the least value.
        Self(self.0.saturating_neg())
    }

    /// The product, rounded to nearest, ties to even; `None` if it does not fit. *Error* ½ of 2^-64.
    #[must_use]
    #[inline]
    pub fn times(self, factor: FxFactor) -> Option<Self> {
        let (mantissa, shift) = factor.parts();
        mul_shift_64(self.0, mantissa, shift).map(Self)
    }

    /// Returns true below zero.
    #[must_use]
    #[inline]
    pub const fn is_negative(self) -> bool {
        self.0 < 0
    }
}

impl From<Fx> for FxWide {
    /// Converts exactly.
    #[inline]
    fn from(value: Fx) -> Self {
        Self::from_scalar(value)
    }
}

impl Wide<Fx> for FxWide {
    inherent! {
        fn from_scalar(value: Fx) -> Self;
        fn from_factor(magnitude: FxFactor, negative: bool) -> Option<Self>;
        fn to_scalar(self: Self) -> Option<Fx>;
        fn plus(self: Self, other: Self) -> Option<Self>;
        fn negated(self: Self) -> Self;
        fn times(self: Self, factor: FxFactor) -> Option<Self>;
        fn is_negative(self: Self) -> bool;
    }
}

/// A sum of wide values modulo 2^64, and how often it wrapped.
///
/// ```
/// use umbra_physics::FxWide;
/// use umbra_physics::scalar::FxSum;
///
/// // A partial sum may be more than fits: only the total has to fit.
/// let mut sum = FxSum::default();
/// for bits in [i128::MAX, i128::MAX, 5, i128::MIN, i128::MIN + 2] {
///     sum.add(FxWide::from_bits(bits));
/// }
/// assert_eq!(sum.total(), Some(FxWide::from_bits(5)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FxSum {
    low: i128,
    carries: i64,
}

impl FxSum {
    /// Adds a term, exactly.
    #[inline]
    pub fn add(&mut self, term: FxWide) {
        let (low, wrapped) = self.low.overflowing_add(term.0);
        self.low = low;
        // A wrap goes the way of the term's sign, and 2^63 of them are never reached. The pair is one integer of 192
        // bits, so the order of the terms does not matter.
        self.carries = self.carries.wrapping_add(if wrapped { if term.0 < 0 { -1 } else { 1 } } else { 0 });
    }

    /// The total, exactly; `None` if it does not fit in an [`FxWide`].
    #[inline]
    #[must_use]
    pub fn total(self) -> Option<FxWide> {
        (self.carries == 0).then_some(FxWide(self.low))
    }
}

impl Sum<Fx> for FxSum {
    inherent! {
        fn add(self: &mut Self, term: FxWide);
        fn total(self: Self) -> Option<FxWide>;
    }
}

impl FxSum {
    /// The sum of these words, as [`Number::to_words`] gives them.
    pub(crate) const fn from_words([carries, high, low]: [u64; 3]) -> Self {
        Self { low: (high as i128) << 64 | low as i128, carries: carries as i64 }
    }
}

impl Number for FxSum {
    const WORDS: usize = 3;

    fn to_words(self) -> [u64; 3] {
        [self.carries as u64, (self.low >> 64) as u64, self.low as u64]
    }
}

/// The total as an exact decimal, or a note that it does not fit.
impl fmt::Display for FxSum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.total() {
            Some(total) => total.fmt(f),
            None => write!(f, "{} times 2^64 and {}", self.carries, FxWide(self.low)),
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::format;

    use super::FxWide;

    #[test]
    fn ulps_of_a_word_are_those_of_all() {
        let halves = [0i128, 1, (1 << 31) - 1, 1 << 31, (1 << 31) + 1, (1 << 32) - 1];
        for power in 0..=63 {
            for near in [-2, -1, 0, 1, 2] {
                for rest in halves {
                    let wide = FxWide::from_bits((((1i128 << power) + near) << 32) + rest);
                    for wide in [wide, FxWide::from_bits(-wide.to_bits())] {
                        let short = wide.ulps_of_a_word().map(i128::from);
                        let fits = wide.ulps().unsigned_abs() < (1 << 63) - (1 << 32);
                        assert_eq!(short, fits.then_some(wide.ulps()), "{wide:?}");
                    }
                }
            }
        }
        assert_eq!([i128::MAX, i128::MIN].map(|bits| FxWide::from_bits(bits).ulps_of_a_word()), [None; 2]);
    }

    #[test]
    fn decimals_are_exact_and_shorter_ones_rounded_once() {
        let wide = |ulps: i128| FxWide::from_bits(ulps << 32);
        assert_eq!(format!("{}", wide(-5 << 30)), "-1.25");
        assert_eq!(format!("{:.1}", wide(-5 << 30)), "-1.2");
        assert_eq!(format!("{:.1}", wide(7 << 30)), "1.8");
        assert_eq!(format!("{:.0}|{:.0}|{:.0}", wide(1 << 31), wide(3 << 31), wide(5 << 31)), "0|2|2");
        assert_eq!(format!("{:.3}", wide((10 << 32) - 1)), "10.000");
        assert_eq!(format!("{:.0}", FxWide::from_bits(-1)), "-0");
        assert_eq!(format!("{:8.2}|{:<6}|", wide(1 << 32), wide(0)), "    1.00|0     |");
        assert_eq!(format!("{}", FxWide::from_bits(i128::MIN)), "-9223372036854775808");
        assert_eq!(format!("{}", FxWide::from_bits(1)).len(), 66);
        assert_eq!(format!("{:.2}", FxWide::from_bits(i128::MAX)), "9223372036854775808.00");
    }
}
