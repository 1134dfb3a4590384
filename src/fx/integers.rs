//! `Fx` and integers, remainders, sums, degrees.

use core::iter::Sum;
use core::ops::{Div, DivAssign, Mul, MulAssign, Rem, RemAssign};

use super::ops::{fitting, nonzero};
use super::{Fx, MathError};
use crate::kernel::div::div_round;
use crate::kernel::wide::mul_shift;

/// π/180 in units of 2^-127, rounded to nearest.
const DEGREE: u128 = 0x023b_e8d4_4a53_a722_b83b_17d9_ba52_1713;
/// 180/π in units of 2^-122, rounded to nearest.
const RADIAN: u128 = 0xe52e_e0d3_1e0f_bdc3_0a97_537f_40d2_57d7;

impl Fx {
    /// The product with an integer, exactly; `None` if it does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!((fx!(0.5) * 3, 3 * fx!(0.5), fx!(1.5) / 3), (fx!(1.5), fx!(1.5), fx!(0.5)));
    /// assert_eq!((fx!(0.5).checked_mul_int(3), Fx::MAX.checked_mul_int(2)), (Some(fx!(1.5)), None));
    /// assert_eq!((fx!(1.5).checked_div_int(3), fx!(1).checked_div_int(0)), (Some(fx!(0.5)), None));
    /// ```
    #[must_use]
    #[inline]
    pub const fn checked_mul_int(self, factor: i32) -> Option<Self> {
        // At most 2^94.
        Self::narrow(self.to_bits() as i128 * factor as i128)
    }

    /// The quotient by an integer, rounded to nearest, ties to even; `None` if it does not fit or `divisor` is zero. *Error* ½ ulp.
    #[must_use]
    #[inline]
    pub const fn checked_div_int(self, divisor: i32) -> Option<Self> {
        if divisor == 0 {
            return None;
        }
        Self::narrow(div_round(self.to_bits() as i128, divisor as i128))
    }

    /// The remainder of the division rounded towards zero, exactly, with the sign of `self`; `None` if `divisor` is zero.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!((fx!(-7.5) % fx!(2), fx!(-7.5).rem_euclid(fx!(2))), (fx!(-1.5), fx!(0.5)));
    /// assert_eq!((fx!(7.5).checked_rem(fx!(2)), fx!(7.5).checked_rem(fx!(0))), (Some(fx!(1.5)), None));
    /// ```
    #[must_use]
    #[inline]
    pub const fn checked_rem(self, divisor: Self) -> Option<Self> {
        match divisor.to_bits() {
            0 => None,
            // Of `Fx::MIN` and −1 ulp the quotient does not fit, but the remainder is zero.
            bits => Some(Self::from_bits(self.to_bits().wrapping_rem(bits))),
        }
    }

    /// The remainder from 0 to below the magnitude of `divisor`, exactly.
    ///
    /// # Panics
    /// When `divisor` is zero.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn rem_euclid(self, divisor: Self) -> Self {
        Self::from_bits(self.to_bits().wrapping_rem_euclid(nonzero(divisor).to_bits()))
    }

    /// The greatest integer that is not above this number; it always fits.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// let x = fx!(-2.5);
    /// assert_eq!((x.floor_to_int(), x.ceil_to_int(), x.round_to_int()), (-3, -2, -2)); // ties to even
    /// assert_eq!((Fx::MAX.floor_to_int(), Fx::MAX.ceil_to_int(), Fx::MIN.round_to_int()), (i32::MAX, 1 << 31, i32::MIN.into()));
    /// assert_eq!((Fx::try_from(7u64), Fx::try_from(i64::MAX).is_err()), (Ok(fx!(7)), true));
    /// ```
    #[doc(alias("to_int", "as_i32"))]
    #[must_use]
    #[inline]
    pub const fn floor_to_int(self) -> i32 {
        (self.to_bits() >> 32) as i32
    }

    /// The least integer that is not below this number; it is at most 2^31.
    #[must_use]
    #[inline]
    pub const fn ceil_to_int(self) -> i64 {
        // The integer below, and one more unless the number is that integer.
        (self.to_bits() >> 32) + (self.to_bits() as u32 != 0) as i64
    }

    /// The nearest integer, ties to even; it is at most 2^31.
    #[must_use]
    #[inline]
    pub const fn round_to_int(self) -> i64 {
        crate::kernel::round::shr_round(self.to_bits() as i128, 32) as i64
    }

    /// An angle in degrees as radians.
    ///
    /// *Domain* all. *Error* 0.5001 ulp. [`Turn::from_degrees`](crate::Turn::from_degrees) is finer and wraps.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!((fx!(180).to_radians(), fx!(-90).to_radians()), (Fx::PI, -Fx::FRAC_PI_2));
    /// assert_eq!(format!("{:.6}", Fx::PI.to_degrees()), "180.000000");
    /// assert_eq!(Fx::MAX.checked_to_degrees(), None);
    /// ```
    #[must_use]
    #[inline]
    pub const fn to_radians(self) -> Self {
        match mul_shift(self.to_bits() as i128, DEGREE, 127) {
            // Less than it was.
            Some(bits) => Self::from_bits(bits as i64),
            None => Self::ZERO,
        }
    }

    /// An angle in radians as degrees. *Error* 0.5001 ulp.
    ///
    /// # Panics
    /// When it does not fit, from 37,480,660.3 rad on; [`checked_to_degrees`](Self::checked_to_degrees) gives `None`.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn to_degrees(self) -> Self {
        fitting(self.checked_to_degrees(), "Fx: the angle in degrees does not fit")
    }

    /// An angle in radians as degrees; `None` if it does not fit. *Error* 0.5001 ulp.
    #[must_use]
    #[inline]
    pub const fn checked_to_degrees(self) -> Option<Self> {
        match mul_shift(self.to_bits() as i128, RADIAN, 122) {
            Some(bits) => Self::narrow(bits),
            None => None,
        }
    }
}

/// An operator with an integer, and its assigning form, from the checked one.
macro_rules! with_an_integer {
    ($operator:ident, $method:ident, $assign:ident, $assign_method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl $operator<i32> for Fx {
            type Output = Self;

            #[inline]
            #[track_caller]
            fn $method(self, other: i32) -> Self {
                let ($a, $b) = (self, other);
                $result
            }
        }

        impl $assign<i32> for Fx {
            #[inline]
            #[track_caller]
            fn $assign_method(&mut self, other: i32) {
                *self = self.$method(other);
            }
        }
    };
}

with_an_integer!(Mul, mul, MulAssign, mul_assign, |a, b| fitting(a.checked_mul_int(b), "Fx: the product does not fit"));
with_an_integer!(Div, div, DivAssign, div_assign, |a, b| {
    assert!(b != 0, "Fx: division by zero");
    fitting(a.checked_div_int(b), "Fx: the quotient does not fit")
});

impl Mul<Fx> for i32 {
    type Output = Fx;

    #[inline]
    #[track_caller]
    fn mul(self, rhs: Fx) -> Fx {
        rhs * self
    }
}

impl Rem for Fx {
    type Output = Self;

    #[inline]
    #[track_caller]
    fn rem(self, divisor: Self) -> Self {
        fitting(self.checked_rem(nonzero(divisor)), "Fx: division by zero")
    }
}

impl RemAssign for Fx {
    #[inline]
    #[track_caller]
    fn rem_assign(&mut self, divisor: Self) {
        *self = *self % divisor;
    }
}

impl Sum for Fx {
    /// The sum, exactly, whatever the order of the terms.
    ///
    /// # Panics
    /// When the total does not fit.
    #[track_caller]
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        // 2^64 terms of at most 2^63 would leave i128.
        let total = numbers.fold(0, |sum, number| sum + i128::from(number.to_bits()));
        fitting(Self::narrow(total), "Fx: the sum does not fit")
    }
}

impl<'a> Sum<&'a Fx> for Fx {
    #[track_caller]
    fn sum<I: Iterator<Item = &'a Self>>(numbers: I) -> Self {
        numbers.copied().sum()
    }
}

/// Exact conversions from the integers that may not fit.
macro_rules! try_from_integer {
    ($($integer:ty),*) => {$(
        impl TryFrom<$integer> for Fx {
            type Error = MathError;

            /// Converts exactly.
            ///
            /// # Errors
            /// [`MathError::Overflow`] outside −2^31 to 2^31 − 1.
            #[inline]
            fn try_from(value: $integer) -> Result<Self, MathError> {
                i32::try_from(value).map(Self::from_int).map_err(|_| MathError::Overflow)
            }
        }
    )*};
}

try_from_integer!(u32, i64, u64, i128, u128, isize, usize);
