//! Functions of `Fx`.

use core::fmt;

use super::Fx;
use crate::codes::codes;
use crate::kernel::{exp_log, sqrt, trig};

/// The reason that a function has no value for its argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum MathError {
    /// The argument is zero or negative, where the function has none or no real value.
    NotPositive,
    /// The value is 2^31 or more.
    Overflow,
}

impl fmt::Display for MathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotPositive => "the argument is not positive",
            Self::Overflow => "the value does not fit in I32F32",
        })
    }
}

codes!(MathError { NotPositive = 701, Overflow = 702 });

impl core::error::Error for MathError {}

/// A power that fits, which is never negative.
#[inline]
fn power(bits: Option<u64>) -> Result<Fx, MathError> {
    bits.map(|bits| Fx::from_bits(bits as i64)).ok_or(MathError::Overflow)
}

impl Fx {
    /// Sine and cosine, at the cost of one of them.
    ///
    /// *Units* radians. *Domain* all, reduced with 128 bits of 1/2π. *Error* 0.5001 ulp.
    /// *Source* CORDIC (Volder 1959) with the first rotations merged into a table, the last ones into a product.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!(Fx::ZERO.sin_cos(), (Fx::ZERO, Fx::ONE));
    /// assert_eq!(Fx::MAX.sin_cos(), (fx!(-0.9713101760), fx!(0.2378161943)));
    /// ```
    #[must_use]
    #[inline]
    pub fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = trig::sin_cos(self.to_bits());
        (Self::from_bits(sin), Self::from_bits(cos))
    }

    /// The sine. *Units* radians. *Domain* all. *Error* 0.5001 ulp. See [`Fx::sin_cos`].
    #[must_use]
    #[inline]
    pub fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// The cosine. *Units* radians. *Domain* all. *Error* 0.5001 ulp. See [`Fx::sin_cos`].
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!((Fx::FRAC_PI_2.sin(), fx!(0).cos()), (fx!(1), fx!(1)));
    /// ```
    #[must_use]
    #[inline]
    pub fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// The angle of the vector (`x`, `self`) from the x axis, counter-clockwise positive; 0 for the zero vector.
    ///
    /// *Units* radians, from −π to π as rounded ([`Fx::PI`]). The sign is that of `self`; π for `self` = 0 and `x` < 0.
    /// *Domain* all. *Error* 0.5001 ulp. *Source* table rotation, one division, series of the residual.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!(fx!(2).atan2(Fx::ZERO), Fx::FRAC_PI_2);
    /// assert_eq!(Fx::ZERO.atan2(fx!(-2)), Fx::PI);
    /// ```
    #[must_use]
    #[inline]
    pub fn atan2(self, x: Self) -> Self {
        Self::from_bits(trig::atan2(self.to_bits(), x.to_bits()))
    }

    /// The square root.
    ///
    /// *Domain* 0 and above. *Error* ½ ulp: the nearest value, and there are no ties.
    /// *Source* Newton's iteration of the reciprocal root in integers, settled against the exact square.
    ///
    /// # Panics
    /// When negative; [`Fx::checked_sqrt`] gives `None`.
    ///
    /// ```
    /// # use umbra_physics::fx;
    /// assert_eq!(fx!(2).sqrt(), fx!(1.4142135624));
    /// ```
    #[must_use]
    #[inline]
    #[track_caller]
    pub fn sqrt(self) -> Self {
        match self.checked_sqrt() {
            Some(root) => root,
            None => panic!("Fx: the square root of a negative number"),
        }
    }

    /// The square root, or `None` when negative. *Error* ½ ulp. See [`Fx::sqrt`].
    #[must_use]
    #[inline]
    pub fn checked_sqrt(self) -> Option<Self> {
        let bits = u64::try_from(self.to_bits()).ok()?;
        // At most √(2^63·2^32) < 2^48.
        Some(Self::from_bits(sqrt::sqrt_fx(bits) as i64))
    }

    /// The length √(self² + other²) of the vector (self, other); `None` if it does not fit, past [`Fx::MAX`].
    ///
    /// *Domain* all; the squares do not overflow. *Error* ½ ulp: the nearest value, and there are no ties.
    /// *Source* the exact integer root of the exact 128-bit sum.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!(fx!(300000).checked_hypot(fx!(-400000)), Some(fx!(500000)));
    /// assert_eq!(Fx::MAX.checked_hypot(Fx::MAX), None);
    /// ```
    #[must_use]
    #[inline]
    pub fn checked_hypot(self, rhs: Self) -> Option<Self> {
        // Squares of at most 2^126 each, so the sum fits; and the root of (2^32·x)² is in units of 2^-32 already.
        let square = |x: Self| u128::from(x.to_bits().unsigned_abs()).pow(2);
        i64::try_from(sqrt::sqrt_round(square(self) + square(rhs))).ok().map(Self::from_bits)
    }

    /// The binary logarithm.
    ///
    /// *Domain* above 0. *Error* 0.5001 ulp. *Source* table by 7 bits, then the series of ln(1 + e), in 128 bits.
    ///
    /// # Errors
    /// [`MathError::NotPositive`] for 0 and below.
    ///
    /// ```
    /// # use umbra_physics::{Fx, MathError, fx};
    /// assert_eq!(fx!(0.125).log2(), Ok(fx!(-3)));
    /// assert_eq!(Fx::ZERO.log2(), Err(MathError::NotPositive));
    /// ```
    #[inline]
    pub fn log2(self) -> Result<Self, MathError> {
        Ok(Self::from_bits(exp_log::log2(self.positive()?)))
    }

    /// The power of two 2^self.
    ///
    /// *Domain* below 31. *Error* 0.5001 ulp, so it is 0 at −33 and below. *Source* table by 7 bits, then the series of
    /// 2^x, in 128 bits.
    ///
    /// # Errors
    /// [`MathError::Overflow`] from 31 on.
    ///
    /// ```
    /// # use umbra_physics::{Fx, MathError, fx};
    /// assert_eq!(fx!(-3).exp2(), Ok(fx!(0.125)));
    /// assert_eq!(fx!(31).exp2(), Err(MathError::Overflow));
    /// ```
    #[inline]
    pub fn exp2(self) -> Result<Self, MathError> {
        power(exp_log::exp2(self.to_bits()))
    }

    /// The power self^exponent.
    ///
    /// *Domain* a base above 0, any exponent. *Error* 0.5001 ulp; a result that is exactly a tie goes to even.
    /// *Source* 2^(exponent·log2 self), with log2 to 2^-118.
    ///
    /// # Errors
    /// [`MathError::NotPositive`] for a base of 0 and below, [`MathError::Overflow`] when the power does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, MathError, fx};
    /// assert_eq!(fx!(9).pow(fx!(-0.5)), Ok(Fx::from_ratio(1, 3)));
    /// assert_eq!(fx!(9).pow(fx!(10)), Err(MathError::Overflow));
    /// ```
    #[inline]
    pub fn pow(self, exponent: Self) -> Result<Self, MathError> {
        power(exp_log::pow(self.positive()?, exponent.to_bits()))
    }

    /// The bits of a value above zero.
    #[inline]
    fn positive(self) -> Result<u64, MathError> {
        match u64::try_from(self.to_bits()) {
            Ok(bits) if bits > 0 => Ok(bits),
            _ => Err(MathError::NotPositive),
        }
    }
}
