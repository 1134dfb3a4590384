//! `Fx`, the number the engine's promises are made in: I32F32 fixed point with one behaviour in every build profile.
//!
//! The wrapped type's own operators wrap or panic depending on two compiler switches, and round towards −∞ or towards
//! zero; ours never use them. The arithmetic is in `ops`, functions in `maths`, text in `text`.
//! This is the only file that names the crate `fixed`.

use fixed::types::I32F32;

use crate::kernel::div::div_round;

pub(crate) mod decimal;
mod integers;
mod maths;
mod ops;
#[cfg(feature = "serde")]
mod serde;
mod text;

pub use maths::MathError;
pub(crate) use ops::fitting;
pub(crate) use text::Decimal;
pub use text::ParseFxError;
#[cfg(any(test, feature = "selftest"))]
pub(crate) use text::fx;

/// A number in I32F32 fixed point: a multiple of 2^-32 from −2^31 to 2^31 − 2^-32.
///
/// One ulp is 2^-32 ([`Fx::DELTA`]), everywhere in the range. Products, quotients and functions round to nearest, ties
/// to even; sums and differences are exact. An operator panics when its result does not fit, in release builds too:
/// the `checked_`, `saturating_` and `wrapping_` forms say what else to do.
///
/// ```
/// use umbra_physics::{Fx, fx};
///
/// let third = Fx::ONE / fx!(3);
/// assert_eq!(third.to_bits(), 0x5555_5555);
/// assert_eq!(third + third, fx!(0.6666666665));
/// assert_eq!(Fx::MAX.checked_add(Fx::DELTA), None);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[repr(transparent)]
pub struct Fx(I32F32);

impl Fx {
    /// 0.
    pub const ZERO: Self = Self::from_bits(0);
    /// 1.
    pub const ONE: Self = Self::from_int(1);
    /// −1.
    pub const NEG_ONE: Self = Self::from_int(-1);
    /// ½.
    pub const HALF: Self = Self::from_bits(1 << 31);
    /// The least value, −2^31.
    pub const MIN: Self = Self::from_bits(i64::MIN);
    /// The greatest value, 2^31 − 2^-32.
    pub const MAX: Self = Self::from_bits(i64::MAX);
    /// The difference of neighbours, 2^-32: one ulp.
    pub const DELTA: Self = Self::from_bits(1);
    /// π, rounded to nearest (up, by 0.48 ulp).
    pub const PI: Self = Self::from_bits(13_493_037_705);
    /// 2π, rounded to nearest (down, by 0.04 ulp: it is less than a full turn, and not 2·[`Fx::PI`]).
    pub const TAU: Self = Self::from_bits(26_986_075_409);
    /// π/2, rounded to nearest (down, by 0.26 ulp).
    pub const FRAC_PI_2: Self = Self::from_bits(6_746_518_852);

    /// The value `bits`·2^-32.
    #[must_use]
    #[inline]
    pub const fn from_bits(bits: i64) -> Self {
        Self(I32F32::from_bits(bits))
    }

    /// The value in units of 2^-32.
    #[must_use]
    #[inline]
    pub const fn to_bits(self) -> i64 {
        self.0.to_bits()
    }

    /// The integer `value`, exactly.
    #[must_use]
    #[inline]
    pub const fn from_int(value: i32) -> Self {
        Self::from_bits((value as i64) << 32)
    }

    /// `num / den`, rounded to nearest, ties to even.
    ///
    /// # Panics
    /// When `den` is zero, or the ratio does not fit.
    ///
    /// ```
    /// # use umbra_physics::Fx;
    /// const FRAME: Fx = Fx::from_ratio(1, 60);
    /// assert_eq!(FRAME.to_bits(), 71_582_788);
    /// ```
    #[must_use]
    #[inline]
    #[track_caller]
    pub const fn from_ratio(num: i64, den: i64) -> Self {
        assert!(den != 0, "Fx::from_ratio: the denominator is zero");
        match Self::checked_from_ratio(num, den) {
            Some(ratio) => ratio,
            None => panic!("Fx::from_ratio: the ratio does not fit in I32F32"),
        }
    }

    /// `num / den`, rounded to nearest, ties to even; `None` if `den` is zero or the ratio does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// assert_eq!(Fx::checked_from_ratio(-3, 4), Some(fx!(-0.75)));
    /// assert_eq!(Fx::checked_from_ratio(1, 0), None);
    /// assert_eq!(Fx::checked_from_ratio(Fx::MIN.to_bits(), 1), None);
    /// assert_eq!(Fx::checked_from_ratio(-7, 7), Some(Fx::NEG_ONE));
    /// ```
    #[must_use]
    #[inline]
    pub const fn checked_from_ratio(num: i64, den: i64) -> Option<Self> {
        if den == 0 {
            return None;
        }
        // |num·2^32| <= 2^95.
        Self::narrow(div_round((num as i128) << 32, den as i128))
    }

    /// The value of `bits`·2^-32, if it fits.
    #[inline]
    pub(crate) const fn narrow(bits: i128) -> Option<Self> {
        if bits as i64 as i128 == bits { Some(Self::from_bits(bits as i64)) } else { None }
    }
}

impl From<I32F32> for Fx {
    #[inline]
    fn from(value: I32F32) -> Self {
        Self(value)
    }
}

impl From<Fx> for I32F32 {
    #[inline]
    fn from(value: Fx) -> Self {
        value.0
    }
}

/// A number that converts to an [`Fx`] exactly: an `Fx`, or an integer of a type that fits.
///
/// [`vec2`](crate::vec2) and the constructors of shapes take such numbers. Implement it for a type of your own that has
/// `Into<Fx>`, and they take that as well.
///
/// ```
/// use umbra_physics::{Fx, IntoFx, Shape, fx, vec2};
///
/// #[derive(Clone, Copy)]
/// struct Tiles(i32);
///
/// impl From<Tiles> for Fx {
///     fn from(tiles: Tiles) -> Fx {
///         fx!(0.75) * tiles.0
///     }
/// }
/// impl IntoFx for Tiles {}
///
/// assert_eq!(vec2(Tiles(4), 1), vec2(3, fx!(1)));
/// assert_eq!(Shape::rectangle(Tiles(4), 1), Shape::rectangle(fx!(3), fx!(1)));
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not convert to `Fx` exactly",
    label = "write a constant as `fx!(0.5)`",
    note = "`fx!` takes decimals and ratios: `fx!(-9.81)`, `fx!(1/60)`; integers that fit in an `i32` need no `fx!`",
    note = "values known at run time convert by `Fx::from_ratio(a, b)`, `Fx::try_from(integer)` or `Fx::parse(text)`"
)]
pub trait IntoFx: Into<Fx> {}

impl IntoFx for Fx {}

/// Exact conversions from the integers that fit.
macro_rules! from_integer {
    ($($integer:ty),*) => {$(
        impl From<$integer> for Fx {
            #[inline]
            fn from(value: $integer) -> Self {
                Self::from_int(i32::from(value))
            }
        }

        impl IntoFx for $integer {}
    )*};
}

from_integer!(i8, u8, i16, u16, i32);
