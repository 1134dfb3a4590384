//! Normalised factors in fixed point: 64 significant bits at any size.

use core::cmp::Ordering;

use super::number::{Factor, Number, inherent};
use super::wide::FxWide;
use crate::fx::Fx;
use crate::kernel::div::div_word;
use crate::kernel::wide::shr_round_256;

/// mantissa · 2^-shift with the top bit of the mantissa set, or zero.
///
/// *Error* a result is the factor nearest to the exact one, ties to even: within 2^-64 relative. Below 2^-16320 it is zero,
/// from 2^16448 on the largest factor there is; nothing in the engine comes near.
///
/// ```
/// use umbra_physics::{FxFactor, fx};
///
/// let third = FxFactor::from_ratio(1, 3);
/// assert_eq!(third.times(3.into()), FxFactor::ONE); // rounded
/// assert_eq!(third.to_scalar(), Some(fx!(0.3333333333)));
/// let four = FxFactor::from(fx!(2.5)).plus(fx!(1.5).into());
/// assert_eq!((four.over(8.into()), four.minus(4.into()).is_zero()), (fx!(0.5).into(), true));
/// assert_eq!(FxFactor::from_scalar(fx!(-4)), four); // the magnitude
/// assert!(FxFactor::PI > 3.into() && FxFactor::ZERO.is_zero());
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct FxFactor {
    mantissa: u64,
    shift: i32,
}

/// The largest exponent, either way.
const MOST_SHIFT: i32 = 1 << 14;

impl FxFactor {
    /// The factor of these words, as [`Number::to_words`] gives them; `None` if no factor has them.
    pub(crate) fn from_words([shift, mantissa]: [u64; 2]) -> Option<Self> {
        Self::from_parts(mantissa, i32::try_from(shift as i64).ok()?)
    }

    /// The factor nearest to value · 2^-shift. *Domain* |shift| below 2^20, so that no sum of a few shifts wraps.
    #[must_use]
    pub(crate) const fn new(value: u128, shift: i32) -> Self {
        if value == 0 {
            return Self { mantissa: 0, shift: 0 };
        }
        let zeros = value.leading_zeros();
        Self::nearest(value << zeros, shift + zeros as i32)
    }

    /// The factor nearest to value · 2^-shift. *Domain* the value has its top bit set.
    #[inline]
    const fn nearest(value: u128, shift: i32) -> Self {
        let (mantissa, rest) = ((value >> 64) as u64, value as u64);
        // Up if the rest is above half, or half and the mantissa odd.
        match mantissa.overflowing_add((rest > (1 << 63) - (mantissa & 1)) as u64) {
            (_, true) => Self::bounded(1 << 63, shift - 65),
            (rounded, false) => Self::bounded(rounded, shift - 64),
        }
    }

    /// The factor with its exponent kept within ±2^14.
    #[inline]
    const fn bounded(mantissa: u64, shift: i32) -> Self {
        if shift.unsigned_abs() > MOST_SHIFT.unsigned_abs() {
            return Self::beyond(shift);
        }
        Self { mantissa, shift }
    }

    #[cold]
    const fn beyond(shift: i32) -> Self {
        if shift > 0 { Self { mantissa: 0, shift: 0 } } else { Self { mantissa: u64::MAX, shift: -MOST_SHIFT } }
    }

    /// The factor nearest to (high·2^128 + low) / divisor · 2^-shift; within 2^-60 relative where the quotient is below 2^63.
    pub(crate) const fn from_256(high: u128, low: u128, divisor: u32, shift: i32) -> Self {
        // The top 128 bits, with all that is below gathered in the last one: two roundings would be one too many.
        let (top, exponent) = if high == 0 {
            (low, 0)
        } else {
            let cut = 128 - high.leading_zeros();
            let kept = if cut == 128 { high } else { (high << (128 - cut)) | (low >> cut) };
            let lost = if cut == 128 { low } else { low & ((1 << cut) - 1) };
            (kept | (lost != 0) as u128, cut as i32)
        };
        let (quotient, rest) = (top / divisor as u128, top % divisor as u128);
        if quotient >> 66 == 0 {
            // With a divisor below 2^32 only a sum that fits in 128 bits is this small: nothing was cut, and `exponent` is 0.
            let wider = (quotient << 60) | ((rest << 60) / divisor as u128);
            return Self::new(wider | ((rest << 60) % divisor as u128 != 0) as u128, shift + 60);
        }
        Self::new(quotient | (rest != 0) as u128, shift - exponent)
    }

    /// The factor of these parts, as they were sent or saved; `None` if no factor has them: the top bit of a mantissa is set and
    /// the shift within ±2^14, or both are 0.
    ///
    /// ```
    /// # use umbra_physics::FxFactor;
    /// let earth = FxFactor::parse("3.986004418e14")?;
    /// let (mantissa, shift) = earth.parts();
    /// assert_eq!(FxFactor::from_parts(mantissa, shift), Some(earth));
    /// assert_eq!(FxFactor::from_parts(mantissa >> 1, shift - 1), None);
    /// # Ok::<(), umbra_physics::ParseFxError>(())
    /// ```
    #[must_use]
    pub const fn from_parts(mantissa: u64, shift: i32) -> Option<Self> {
        let is_normal = mantissa >> 63 == 1 && shift.unsigned_abs() <= MOST_SHIFT.unsigned_abs();
        if is_normal || (mantissa == 0 && shift == 0) { Some(Self { mantissa, shift }) } else { None }
    }

    /// (mantissa, shift).
    #[inline]
    #[must_use]
    pub const fn parts(self) -> (u64, i32) {
        (self.mantissa, self.shift)
    }

    /// The value as a multiple of 2^-fraction, rounded down; `None` from 2^128 on.
    pub(crate) const fn to_fixed(self, fraction: i32) -> Option<u128> {
        let shift = self.shift - fraction;
        if shift >= 128 {
            Some(0)
        } else if shift >= 0 {
            Some(self.mantissa as u128 >> shift)
        } else if self.mantissa == 0 || -shift <= 64 {
            Some((self.mantissa as u128) << if self.mantissa == 0 { 0 } else { -shift })
        } else {
            None
        }
    }
}

impl FxFactor {
    /// 0.
    pub const ZERO: Self = Self { mantissa: 0, shift: 0 };
    /// 1.
    pub const ONE: Self = Self { mantissa: 1 << 63, shift: 63 };
    /// π. *Error* 2^-64 relative.
    pub const PI: Self = Self { mantissa: 0xc90f_daa2_2168_c235, shift: 62 };

    /// The magnitude of `value`, exactly.
    #[must_use]
    pub fn from_scalar(value: Fx) -> Self {
        let bits = value.to_bits().unsigned_abs();
        let zeros = bits.leading_zeros();
        if bits == 0 { Self::ZERO } else { Self { mantissa: bits << zeros, shift: 32 + zeros as i32 } }
    }

    /// num / den. *Error* 2^-63 relative.
    ///
    /// # Panics
    /// When `den` is zero.
    #[must_use]
    #[track_caller]
    pub fn from_ratio(num: u64, den: u64) -> Self {
        assert!(den != 0, "FxFactor::from_ratio: the denominator is zero");
        Self::new(u128::from(num), 0).over(Self::new(u128::from(den), 0))
    }

    /// The nearest [`Fx`], ties to even; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn to_scalar(self) -> Option<Fx> {
        let shift = self.shift - 32;
        let bits = if shift >= 0 {
            shr_round_256(0, u128::from(self.mantissa), shift.unsigned_abs())?
        } else if self.mantissa == 0 {
            0
        } else {
            return None;
        };
        i64::try_from(bits).ok().map(Fx::from_bits)
    }

    /// The product. *Error* 2^-64 relative.
    #[must_use]
    #[inline]
    pub fn times(self, rhs: Self) -> Self {
        let product = u128::from(self.mantissa) * u128::from(rhs.mantissa);
        if product == 0 {
            return Self::ZERO;
        }
        // The product of two mantissas with their top bits set lacks at most one bit. Without a branch, as none would be predicted.
        let lacks = (product >> 127) as u32 ^ 1;
        let doubled = u128::from(lacks).wrapping_neg() & product;
        Self::nearest(product + doubled, self.shift + rhs.shift + lacks as i32)
    }

    /// The quotient. *Error* 2^-64 relative.
    ///
    /// # Panics
    /// When `rhs` is zero.
    #[must_use]
    #[track_caller]
    pub fn over(self, rhs: Self) -> Self {
        assert!(rhs.mantissa != 0, "FxFactor: the divisor is zero");
        self.over_nonzero(rhs)
    }

    /// The quotient, without the check, which costs drag a hundredth of its instructions. *Domain* `rhs` is not zero.
    pub(super) fn over_nonzero(self, rhs: Self) -> Self {
        if self.mantissa == 0 {
            return Self::ZERO;
        }
        // A quotient of 64 bits with its top bit set, whichever mantissa is the larger.
        let halved = self.mantissa >= rhs.mantissa;
        let (q, r) = div_word(u128::from(self.mantissa) << (64 - u32::from(halved)), rhs.mantissa);
        let rest = rhs.mantissa - r;
        // Of different mantissas the quotient is below 2^64 − 1, that of 2^64 − 2 and 2^64 − 1: there is no carry.
        let rounded = q + u64::from(r > rest - (q & 1));
        Self::bounded(rounded, self.shift - rhs.shift + 64 - i32::from(halved))
    }

    /// The sum. *Error* 2^-64 relative.
    #[must_use]
    pub fn plus(self, rhs: Self) -> Self {
        if self.mantissa == 0 || rhs.mantissa == 0 {
            return if self.mantissa == 0 { rhs } else { self };
        }
        // At the same shift either is the larger one.
        let (large, small) = if rhs.shift < self.shift { (rhs, self) } else { (self, rhs) };
        let (aligned, lost) = align(small.mantissa, (small.shift - large.shift) as u32);
        // Each is below 2^127, and the larger one not below 2^126: the sum lacks at most one bit.
        let sum = ((u128::from(large.mantissa) << 63) + aligned) | u128::from(lost);
        let lacks = (sum >> 127) as u32 ^ 1;
        let doubled = u128::from(lacks).wrapping_neg() & sum;
        Self::nearest(sum + doubled, large.shift + 63 + lacks as i32)
    }

    /// The difference, or zero if `rhs` is the larger. *Error* 2^-64 relative.
    #[must_use]
    pub fn minus(self, rhs: Self) -> Self {
        if self <= rhs {
            return Self::ZERO;
        }
        if rhs.mantissa == 0 {
            return self;
        }
        let gap = (rhs.shift - self.shift).unsigned_abs();
        let (aligned, lost) = align(rhs.mantissa, gap);
        let rest = (u128::from(self.mantissa) << 63) - aligned - u128::from(lost);
        Self::new(rest | u128::from(lost), self.shift + 63)
    }

    /// Returns true for zero.
    #[must_use]
    pub const fn is_zero(self) -> bool {
        self.mantissa == 0
    }
}

impl PartialOrd for FxFactor {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for FxFactor {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self.mantissa, other.mantissa) {
            (0, _) | (_, 0) => self.mantissa.cmp(&other.mantissa),
            (a, b) => other.shift.cmp(&self.shift).then(a.cmp(&b)),
        }
    }
}

impl From<Fx> for FxFactor {
    /// Converts exactly.
    ///
    /// # Panics
    /// When negative: a factor has no sign. [`FxFactor::from_scalar`] takes the magnitude.
    #[track_caller]
    fn from(value: Fx) -> Self {
        assert!(value >= Fx::ZERO, "FxFactor: a factor is not negative");
        Self::from_scalar(value)
    }
}

impl From<i32> for FxFactor {
    /// Converts exactly.
    ///
    /// # Panics
    /// When negative: a factor has no sign.
    #[track_caller]
    fn from(value: i32) -> Self {
        assert!(value >= 0, "FxFactor: a factor is not negative");
        Self::new(value as u128, 0)
    }
}

impl Factor<Fx> for FxFactor {
    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;
    const PI: Self = Self::PI;

    inherent! {
        fn from_scalar(value: Fx) -> Self;
        fn from_ratio(num: u64, den: u64) -> Self;
        fn to_scalar(self: Self) -> Option<Fx>;
        fn times(self: Self, other: Self) -> Self;
        fn over(self: Self, other: Self) -> Self;
        fn plus(self: Self, other: Self) -> Self;
        fn minus(self: Self, other: Self) -> Self;
    }

    #[inline]
    fn to_fx_factor(self) -> Self {
        self
    }

    fn from_wide(value: FxWide) -> Self {
        Self::new(value.to_bits().unsigned_abs(), 64)
    }

    fn to_binary(self) -> (u64, i32) {
        self.parts()
    }

    fn from_binary(value: u128, shift: i32) -> Self {
        Self::new(value, shift)
    }
}

impl Number for FxFactor {
    const WORDS: usize = 2;

    fn to_words(self) -> [u64; 3] {
        [i64::from(self.shift) as u64, self.mantissa, 0]
    }
}

/// mantissa · 2^63 / 2^gap, rounded down, and whether anything was lost.
#[inline]
fn align(mantissa: u64, gap: u32) -> (u128, bool) {
    match gap {
        0..64 => (u128::from(mantissa) << (63 - gap), false),
        64..127 => (u128::from(mantissa >> (gap - 63)), mantissa << (127 - gap) != 0),
        _ => (0, true),
    }
}

#[cfg(test)]
mod tests;
