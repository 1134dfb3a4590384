//! Pairs of scalars.

use core::fmt;
use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use crate::scalar::{Factor, Scalar, Wide, fx::Fx};

/// A vector of two components, or a pair of whatever `T` is.
///
/// ```
/// use umbra_physics::scalar::{Factor as _, Wide as _};
/// use umbra_physics::{Fx, Vec2, fx, vec2};
///
/// let (a, b): (Vec2, Vec2) = (vec2(3, 4), vec2(1, fx!(0.5)));
/// assert_eq!((a + b, a - b, -a), (vec2(4, fx!(4.5)), vec2(2, fx!(3.5)), vec2(-3, -4)));
/// assert_eq!(a.perp(), vec2(-4, 3)); // a quarter turn to the left
/// assert_eq!(a.dot(b).and_then(|product| product.to_scalar()), Some(fx!(5)));
/// assert_eq!(a.cross(b).and_then(|product| product.to_scalar()), Some(fx!(-2.5)));
/// assert_eq!((a.length().to_scalar(), a.checked_length()), (Some(fx!(5)), Some(fx!(5))));
/// assert_eq!(a.checked_scale(Fx::HALF), Some(vec2(fx!(1.5), 2)));
/// assert_eq!(a.try_map(|c| c.checked_mul(Fx::MAX)), None); // does not fit
/// assert_eq!(a.map(Fx::to_bits).x, 3 << 32);
/// assert!(a.is_finite()); // of an `Fx` always
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Vec2<T = Fx> {
    /// To the right.
    pub x: T,
    /// Upwards.
    pub y: T,
}

/// The vector (x, y), from anything that is exactly a scalar.
///
/// ```
/// use umbra_physics::{Vec2, fx, vec2};
/// let gravity: Vec2 = vec2(0, fx!(-9.81));
/// assert_eq!(gravity.y, fx!(-9.81));
/// ```
#[inline]
pub fn vec2<S>(x: impl Into<S>, y: impl Into<S>) -> Vec2<S> {
    Vec2 { x: x.into(), y: y.into() }
}

impl<T> Vec2<T> {
    /// The vector (x, y).
    #[inline]
    #[must_use]
    pub const fn new(x: T, y: T) -> Self {
        Self { x, y }
    }

    /// Each component put through `f`.
    #[inline]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Vec2<U> {
        Vec2 { x: f(self.x), y: f(self.y) }
    }

    /// Each component put through `f`; `None` if either is.
    #[inline]
    pub fn try_map<U>(self, mut f: impl FnMut(T) -> Option<U>) -> Option<Vec2<U>> {
        Some(Vec2 { x: f(self.x)?, y: f(self.y)? })
    }
}

impl<T> From<(T, T)> for Vec2<T> {
    #[inline]
    fn from((x, y): (T, T)) -> Self {
        Self { x, y }
    }
}

impl<T> From<Vec2<T>> for (T, T) {
    #[inline]
    fn from(v: Vec2<T>) -> Self {
        (v.x, v.y)
    }
}

impl<S: Scalar> Vec2<S> {
    /// (0, 0).
    pub const ZERO: Self = Self { x: S::ZERO, y: S::ZERO };
    /// (1, 0).
    pub const X: Self = Self { x: S::ONE, y: S::ZERO };
    /// (0, 1).
    pub const Y: Self = Self { x: S::ZERO, y: S::ONE };

    /// The dot product, exactly; `None` if it does not fit.
    #[must_use]
    pub fn dot(self, other: Self) -> Option<S::Wide> {
        self.x.product(other.x).plus(self.y.product(other.y))
    }

    /// The cross product x·y' − y·x', exactly; `None` if it does not fit.
    #[must_use]
    pub fn cross(self, other: Self) -> Option<S::Wide> {
        self.x.product(other.y).plus(self.y.product(other.x).negated())
    }

    /// The length; `None` if it does not fit. *Error* ½ ulp and 2^-32 of one.
    #[doc(alias = "magnitude")]
    #[must_use]
    pub fn checked_length(self) -> Option<S> {
        self.length().to_scalar()
    }

    /// The length, which always fits. *Error* 2^-64 relative.
    #[must_use]
    pub fn length(self) -> S::Factor {
        S::length((S::Wide::from_scalar(self.x), S::Wide::from_scalar(self.y)), S::ZERO)
    }

    /// A quarter turn to the left: (−y, x), exactly.
    #[inline]
    #[must_use]
    pub fn perp(self) -> Self {
        Self { x: -self.y, y: self.x }
    }

    /// Each component times `factor`, rounded to nearest, ties to even; `None` if either does not fit.
    #[must_use]
    pub fn checked_scale(self, factor: S) -> Option<Self> {
        self.try_map(|c| c.times(factor))
    }

    /// Whether both components are numbers; floats may not be.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }

    /// Whether both components are within ±`limit`.
    #[must_use]
    pub(crate) fn is_within(self, limit: S) -> bool {
        let within = |c: S| -limit <= c && c <= limit;
        within(self.x) && within(self.y)
    }
}

impl<S: Scalar> Add for Vec2<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl<S: Scalar> Sub for Vec2<S> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }
}

impl<S: Scalar> AddAssign for Vec2<S> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Vec2<S> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar> Neg for Vec2<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

impl<T: fmt::Display> fmt::Display for Vec2<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        self.x.fmt(f)?;
        f.write_str(", ")?;
        self.y.fmt(f)?;
        f.write_str(")")
    }
}
