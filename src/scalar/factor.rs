//! Normalised factors in fixed point: 64 significant bits at any size.

use core::cmp::Ordering;

use super::Factor;
use super::fx::Fx;
use super::wide::FxWide;
use crate::kernel::round::shr_round_u;
use crate::kernel::wide::shr_round_256;

/// mantissa · 2^-shift with the top bit of the mantissa set, or zero.
///
/// *Error* a result is the factor nearest to the exact one, ties to even: within 2^-64 relative. Below 2^-16320 it is zero,
/// from 2^16448 on the largest factor there is; nothing in the engine comes near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FxFactor {
    mantissa: u64,
    shift: i32,
}

impl FxFactor {
    /// The factor nearest to value · 2^-shift. *Domain* |shift| below 2^20, so that no sum of a few shifts wraps.
    #[must_use]
    pub(crate) const fn new(value: u128, shift: i32) -> Self {
        if value == 0 {
            return Self { mantissa: 0, shift: 0 };
        }
        let zeros = value.leading_zeros();
        if zeros >= 64 {
            return Self::bounded((value as u64) << (zeros - 64), shift + (zeros as i32 - 64));
        }
        let cut = 64 - zeros;
        let rounded = shr_round_u(value, cut);
        if rounded >> 64 != 0 {
            return Self::bounded(1 << 63, shift - cut as i32 - 1);
        }
        Self::bounded(rounded as u64, shift - cut as i32)
    }

    /// The factor with its exponent kept within ±2^14.
    const fn bounded(mantissa: u64, shift: i32) -> Self {
        const MOST: i32 = 1 << 14;
        if shift > MOST {
            Self { mantissa: 0, shift: 0 }
        } else if shift < -MOST {
            Self { mantissa: u64::MAX, shift: -MOST }
        } else {
            Self { mantissa, shift }
        }
    }

    /// The factor nearest to (high·2^128 + low) / divisor · 2^-shift.
    pub(crate) const fn from_256(high: u128, low: u128, divisor: u64, shift: i32) -> Self {
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
            // Only a sum that fits in 128 bits is this small, so nothing was lost above: exact to 2^-62 by two more bits.
            let wider = (quotient << 60) | ((rest << 60) / divisor as u128);
            return Self::new(wider | ((rest << 60) % divisor as u128 != 0) as u128, shift - exponent + 60);
        }
        Self::new(quotient | (rest != 0) as u128, shift - exponent)
    }

    /// (mantissa, shift).
    #[inline]
    #[must_use]
    pub const fn parts(self) -> (u64, i32) {
        (self.mantissa, self.shift)
    }

    /// As a multiple of 2^-fraction, rounded down; `None` from 2^128 on.
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

impl Factor<Fx> for FxFactor {
    const ZERO: Self = Self { mantissa: 0, shift: 0 };
    const ONE: Self = Self { mantissa: 1 << 63, shift: 63 };
    const PI: Self = Self { mantissa: 0xc90f_daa2_2168_c235, shift: 62 };

    fn from_scalar(value: Fx) -> Self {
        Self::new(u128::from(value.to_bits().unsigned_abs()), 32)
    }

    fn from_wide(value: FxWide) -> Self {
        Self::new(value.to_bits().unsigned_abs(), 64)
    }

    fn from_ratio(num: u64, den: u64) -> Self {
        Self::new(u128::from(num), 0).over(Self::new(u128::from(den), 0))
    }

    fn to_scalar(self) -> Option<Fx> {
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

    fn times(self, other: Self) -> Self {
        Self::new(u128::from(self.mantissa) * u128::from(other.mantissa), self.shift + other.shift)
    }

    fn over(self, other: Self) -> Self {
        // 64 or 65 bits of quotient, one more for the half, one that says whether anything is below.
        let (n, d) = (u128::from(self.mantissa) << 64, u128::from(other.mantissa));
        let (q, r) = (n / d, n % d);
        let half = u128::from(2 * r >= d);
        let below = u128::from(2 * r != half * d);
        Self::new((q << 2) | (half << 1) | below, self.shift - other.shift + 66)
    }

    fn plus(self, other: Self) -> Self {
        let (large, small) = if self >= other { (self, other) } else { (other, self) };
        if small.mantissa == 0 {
            return large;
        }
        let gap = (small.shift - large.shift).unsigned_abs();
        let (aligned, lost) = align(small.mantissa, gap);
        // Each is below 2^127.
        Self::new(((u128::from(large.mantissa) << 63) + aligned) | u128::from(lost), large.shift + 63)
    }

    fn minus(self, other: Self) -> Self {
        if self <= other {
            return Self::ZERO;
        }
        if other.mantissa == 0 {
            return self;
        }
        let gap = (other.shift - self.shift).unsigned_abs();
        let (aligned, lost) = align(other.mantissa, gap);
        let rest = (u128::from(self.mantissa) << 63) - aligned - u128::from(lost);
        Self::new(rest | u128::from(lost), self.shift + 63)
    }

    fn to_bits(self) -> i128 {
        (i128::from(self.shift) << 64) | i128::from(self.mantissa)
    }
}

/// mantissa · 2^63 / 2^gap, rounded down, and whether anything was lost.
fn align(mantissa: u64, gap: u32) -> (u128, bool) {
    let value = u128::from(mantissa) << 63;
    if gap >= 128 { (0, true) } else { (value >> gap, gap > 0 && value << (128 - gap) != 0) }
}
