//! The arithmetic of `Fx`, on its bits.

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use super::Fx;
use crate::kernel::div::div_round;
use crate::kernel::round::shr_round;

/// The product in units of 2^-32. |a·b| <= 2^126, the result 2^94.
#[inline]
const fn product(a: Fx, b: Fx) -> i128 {
    shr_round(a.to_bits() as i128 * b.to_bits() as i128, 32)
}

/// The quotient in units of 2^-32, at most 2^95. *Domain* b ≠ 0.
#[inline]
const fn quotient(a: Fx, b: Fx) -> i128 {
    div_round((a.to_bits() as i128) << 32, b.to_bits() as i128)
}

/// Returns true if a product or quotient of these that does not fit is negative: then neither is zero.
#[inline]
const fn signs_differ(a: Fx, b: Fx) -> bool {
    (a.to_bits() < 0) != (b.to_bits() < 0)
}

/// The end of the range on the given side.
#[inline]
const fn end(negative: bool) -> Fx {
    if negative { Fx::MIN } else { Fx::MAX }
}

impl Fx {
    /// The sum; `None` if it does not fit.
    #[must_use]
    #[inline]
    pub const fn checked_add(self, rhs: Self) -> Option<Self> {
        match self.to_bits().checked_add(rhs.to_bits()) {
            Some(bits) => Some(Self::from_bits(bits)),
            None => None,
        }
    }

    /// The difference; `None` if it does not fit.
    #[must_use]
    #[inline]
    pub const fn checked_sub(self, rhs: Self) -> Option<Self> {
        match self.to_bits().checked_sub(rhs.to_bits()) {
            Some(bits) => Some(Self::from_bits(bits)),
            None => None,
        }
    }

    /// The product, rounded to nearest, ties to even; `None` if it does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// let (a, b) = (fx!(100_000), fx!(-3));
    /// assert_eq!((a.checked_mul(b), a.checked_mul(a)), (Some(fx!(-300_000)), None));
    /// assert_eq!((a.checked_div(b).map(Fx::round), a.checked_div(fx!(0))), (Some(fx!(-33_333)), None));
    /// assert_eq!((Fx::MIN.checked_neg(), Fx::MIN.checked_abs(), b.checked_abs()), (None, None, Some(fx!(3))));
    /// ```
    #[must_use]
    #[inline]
    pub const fn checked_mul(self, rhs: Self) -> Option<Self> {
        Self::narrow(product(self, rhs))
    }

    /// The quotient, rounded to nearest, ties to even; `None` if it does not fit or `rhs` is zero.
    #[must_use]
    #[inline]
    pub const fn checked_div(self, rhs: Self) -> Option<Self> {
        if rhs.to_bits() == 0 { None } else { Self::narrow(quotient(self, rhs)) }
    }

    /// The negative; `None` for [`Fx::MIN`].
    #[must_use]
    #[inline]
    pub const fn checked_neg(self) -> Option<Self> {
        match self.to_bits().checked_neg() {
            Some(bits) => Some(Self::from_bits(bits)),
            None => None,
        }
    }

    /// The magnitude; `None` for [`Fx::MIN`].
    #[must_use]
    #[inline]
    pub const fn checked_abs(self) -> Option<Self> {
        match self.to_bits().checked_abs() {
            Some(bits) => Some(Self::from_bits(bits)),
            None => None,
        }
    }

    /// The sum, or the end of the range it lies beyond.
    #[must_use]
    #[inline]
    pub const fn saturating_add(self, rhs: Self) -> Self {
        Self::from_bits(self.to_bits().saturating_add(rhs.to_bits()))
    }

    /// The difference, or the end of the range it lies beyond.
    #[must_use]
    #[inline]
    pub const fn saturating_sub(self, rhs: Self) -> Self {
        Self::from_bits(self.to_bits().saturating_sub(rhs.to_bits()))
    }

    /// The product, rounded to nearest, ties to even, or the end of the range it lies beyond.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// let a = fx!(-100_000);
    /// assert_eq!((a.saturating_mul(a), a.saturating_mul(-a)), (Fx::MAX, Fx::MIN));
    /// assert_eq!(a.saturating_div(Fx::DELTA), Fx::MIN);
    /// assert_eq!((Fx::MIN.saturating_neg(), Fx::MIN.saturating_abs()), (Fx::MAX, Fx::MAX));
    /// ```
    #[must_use]
    #[inline]
    pub const fn saturating_mul(self, rhs: Self) -> Self {
        match self.checked_mul(rhs) {
            Some(product) => product,
            None => end(signs_differ(self, rhs)),
        }
    }

    /// The quotient, rounded to nearest, ties to even, or the end of the range it lies beyond.
    ///
    /// # Panics
    /// When `rhs` is zero.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn saturating_div(self, rhs: Self) -> Self {
        match Self::narrow(quotient(self, nonzero(rhs))) {
            Some(quotient) => quotient,
            None => end(signs_differ(self, rhs)),
        }
    }

    /// The negative; [`Fx::MAX`] for [`Fx::MIN`].
    #[must_use]
    #[inline]
    pub const fn saturating_neg(self) -> Self {
        Self::from_bits(self.to_bits().saturating_neg())
    }

    /// The magnitude; [`Fx::MAX`] for [`Fx::MIN`].
    #[must_use]
    #[inline]
    pub const fn saturating_abs(self) -> Self {
        Self::from_bits(self.to_bits().saturating_abs())
    }

    /// The sum modulo 2^32.
    #[must_use]
    #[inline]
    pub const fn wrapping_add(self, rhs: Self) -> Self {
        Self::from_bits(self.to_bits().wrapping_add(rhs.to_bits()))
    }

    /// The difference modulo 2^32.
    #[must_use]
    #[inline]
    pub const fn wrapping_sub(self, rhs: Self) -> Self {
        Self::from_bits(self.to_bits().wrapping_sub(rhs.to_bits()))
    }

    /// The product, rounded to nearest, ties to even, modulo 2^32.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!(Fx::MAX.wrapping_mul(fx!(2)), fx!(-0.0000000004656612873077392578125));
    /// assert_eq!(Fx::MIN.wrapping_sub(Fx::DELTA), Fx::MAX);
    /// assert_eq!(Fx::MAX.wrapping_div(Fx::HALF), Fx::MAX.wrapping_mul(fx!(2)));
    /// assert_eq!((Fx::MIN.wrapping_neg(), Fx::MIN.wrapping_abs()), (Fx::MIN, Fx::MIN));
    /// ```
    #[must_use]
    #[inline]
    pub const fn wrapping_mul(self, rhs: Self) -> Self {
        Self::from_bits(product(self, rhs) as i64)
    }

    /// The quotient, rounded to nearest, ties to even, modulo 2^32.
    ///
    /// # Panics
    /// When `rhs` is zero.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn wrapping_div(self, rhs: Self) -> Self {
        Self::from_bits(quotient(self, nonzero(rhs)) as i64)
    }

    /// The negative; [`Fx::MIN`] for itself.
    #[must_use]
    #[inline]
    pub const fn wrapping_neg(self) -> Self {
        Self::from_bits(self.to_bits().wrapping_neg())
    }

    /// The magnitude; [`Fx::MIN`] for itself.
    #[must_use]
    #[inline]
    pub const fn wrapping_abs(self) -> Self {
        Self::from_bits(self.to_bits().wrapping_abs())
    }

    /// The magnitude.
    ///
    /// # Panics
    /// For [`Fx::MIN`], whose magnitude does not fit.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn abs(self) -> Self {
        fitting(self.checked_abs(), "Fx: the magnitude does not fit")
    }

    /// −1 for a negative number, 0 for zero, 1 for a positive one.
    #[must_use]
    #[inline]
    pub const fn signum(self) -> Self {
        Self::from_int(self.to_bits().signum() as i32)
    }

    /// The greatest integer that is not above this number.
    ///
    /// ```
    /// # use umbra_physics::fx;
    /// let x = fx!(-2.5);
    /// assert_eq!((x.floor(), x.ceil(), x.round()), (fx!(-3), fx!(-2), fx!(-2))); // ties to even
    /// assert_eq!((x.abs(), x.signum()), (fx!(2.5), fx!(-1)));
    /// ```
    #[must_use]
    #[inline]
    pub const fn floor(self) -> Self {
        Self::from_bits(self.to_bits() & !0xffff_ffff)
    }

    /// The least integer that is not below this number.
    ///
    /// # Panics
    /// Above 2^31 − 1.
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn ceil(self) -> Self {
        // The sum fits 65 bits.
        fitting(
            Self::narrow((self.to_bits() as i128 + 0xffff_ffff) & !0xffff_ffff),
            "Fx: the integer above does not fit",
        )
    }

    /// The nearest integer, ties to even.
    ///
    /// # Panics
    /// From 2^31 − ½ on.
    ///
    /// ```
    /// # use umbra_physics::fx;
    /// assert_eq!([fx!(0.5), fx!(1.5), fx!(-2.5)].map(|x| x.round()), [fx!(0), fx!(2), fx!(-2)]);
    /// ```
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn round(self) -> Self {
        fitting(Self::narrow(shr_round(self.to_bits() as i128, 32) << 32), "Fx: the nearest integer does not fit")
    }
}

/// The value, or a panic: so an operator behaves alike with and without overflow checks.
#[inline]
#[track_caller]
pub(crate) const fn fitting<T: Copy>(value: Option<T>, otherwise: &'static str) -> T {
    match value {
        Some(value) => value,
        None => panic!("{}", otherwise),
    }
}

/// The divisor, or a panic.
#[inline]
#[track_caller]
pub(super) const fn nonzero(divisor: Fx) -> Fx {
    assert!(divisor.to_bits() != 0, "Fx: division by zero");
    divisor
}

/// An operator and its assigning form, from the checked one.
macro_rules! operator {
    ($operator:ident, $method:ident, $assign:ident, $assign_method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl $operator for Fx {
            type Output = Self;

            #[inline]
            #[track_caller]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self, other);
                $result
            }
        }

        impl $assign for Fx {
            #[inline]
            #[track_caller]
            fn $assign_method(&mut self, other: Self) {
                *self = $operator::$method(*self, other);
            }
        }
    };
}

operator!(Add, add, AddAssign, add_assign, |a, b| fitting(a.checked_add(b), "Fx: the sum does not fit"));
operator!(Sub, sub, SubAssign, sub_assign, |a, b| fitting(a.checked_sub(b), "Fx: the difference does not fit"));
operator!(Mul, mul, MulAssign, mul_assign, |a, b| fitting(a.checked_mul(b), "Fx: the product does not fit"));
operator!(Div, div, DivAssign, div_assign, |a, b| {
    fitting(Fx::narrow(quotient(a, nonzero(b))), "Fx: the quotient does not fit")
});

impl Neg for Fx {
    type Output = Self;

    #[inline]
    #[track_caller]
    fn neg(self) -> Self {
        fitting(self.checked_neg(), "Fx: the negative does not fit")
    }
}
