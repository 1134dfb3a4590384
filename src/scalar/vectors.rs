//! Vectors and rotations of scalars.

use core::ops::Mul;

use super::number::{Angle, Scalar, Wide};
use crate::fx::{Fx, fitting};
use crate::math::{Rot, Vec2};

impl<S: Scalar> Vec2<S> {
    /// (0, 0).
    pub const ZERO: Self = Self { x: S::ZERO, y: S::ZERO };
    /// (1, 0).
    pub const X: Self = Self { x: S::ONE, y: S::ZERO };
    /// (0, 1).
    pub const Y: Self = Self { x: S::ZERO, y: S::ONE };

    /// The dot product x·x' + y·y', exactly; `None` if it does not fit.
    #[must_use]
    pub fn wide_dot(self, rhs: Self) -> Option<S::Wide> {
        self.x.product(rhs.x).plus(self.y.product(rhs.y))
    }

    /// The cross product x·y' − y·x', exactly; `None` if it does not fit.
    #[must_use]
    pub fn wide_cross(self, rhs: Self) -> Option<S::Wide> {
        self.x.product(rhs.y).plus(self.y.product(rhs.x).negated())
    }

    /// The length, which always fits. *Error* 2^-64 relative.
    #[must_use]
    pub fn wide_length(self) -> S::Factor {
        S::length(self.map(S::Wide::from_scalar), S::ZERO)
    }

    /// Each component times `factor`, rounded to nearest, ties to even; `None` if either does not fit.
    #[must_use]
    pub fn checked_scale(self, factor: S) -> Option<Self> {
        self.try_map(|c| c.times(factor))
    }

    /// Returns true if both components are finite; those of floats may not be.
    ///
    /// ```
    /// # use umbra_physics::{fx, vec2};
    /// let v = vec2(1, fx!(0.5));
    /// assert!(v.is_finite()); // always, with components in `Fx`
    /// ```
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }

    /// Returns true if both components are within ±`limit`.
    #[must_use]
    pub(crate) fn is_within(self, limit: S) -> bool {
        let within = |c: S| -limit <= c && c <= limit;
        within(self.x) && within(self.y)
    }
}

impl Vec2 {
    /// The dot product x·x' + y·y'.
    ///
    /// *Error* ½ ulp: the exact sum, rounded once, ties to even. [`wide_dot`](Self::wide_dot) is exact.
    ///
    /// # Panics
    /// When it does not fit; [`checked_dot`](Self::checked_dot) gives `None`.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx, vec2};
    /// let (a, b) = (vec2(3, 4), vec2(1, fx!(0.5)));
    /// assert_eq!((a.dot(b), a.cross(b)), (fx!(5), fx!(-2.5)));
    /// assert_eq!((a.checked_dot(vec2(Fx::MAX, 0)), a.checked_cross(vec2(0, Fx::MAX))), (None, None));
    /// assert_eq!(a.wide_dot(b).and_then(|product| product.to_scalar()), Some(fx!(5)));
    /// assert_eq!(a.wide_cross(b).and_then(|product| product.to_scalar()), Some(fx!(-2.5)));
    /// ```
    #[must_use]
    #[track_caller]
    pub fn dot(self, rhs: Self) -> Fx {
        fitting(self.checked_dot(rhs), "Vec2: the dot product does not fit")
    }

    /// The dot product; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn checked_dot(self, rhs: Self) -> Option<Fx> {
        self.wide_dot(rhs)?.to_scalar()
    }

    /// The cross product x·y' − y·x': positive if `rhs` is counter-clockwise of this vector.
    ///
    /// *Error* ½ ulp: the exact difference, rounded once, ties to even. [`wide_cross`](Self::wide_cross) is exact.
    ///
    /// # Panics
    /// When it does not fit; [`checked_cross`](Self::checked_cross) gives `None`.
    #[must_use]
    #[track_caller]
    pub fn cross(self, rhs: Self) -> Fx {
        fitting(self.checked_cross(rhs), "Vec2: the cross product does not fit")
    }

    /// The cross product; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn checked_cross(self, rhs: Self) -> Option<Fx> {
        self.wide_cross(rhs)?.to_scalar()
    }
}

impl<S: Scalar> Rot<S> {
    /// No rotation.
    pub const IDENTITY: Self = Self { cos: S::ONE, sin: S::ZERO };

    /// The rotation by an angle in radians, of any size. *Error* 0.5001 ulp in each part.
    #[must_use]
    pub fn from_radians(angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin }
    }

    /// The rotation by an angle. *Error* 0.5001 ulp in each part.
    #[must_use]
    pub fn from_angle(angle: S::Angle) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin }
    }

    /// The rotation by the opposite angle.
    ///
    /// # Panics
    /// If the sine is `Fx::MIN`, which no rotation's is.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }

    /// The vector turned; `None` if a component does not fit. *Error* ½ ulp, and 0.5001 · 2^-32 of |x| + |y|, from sine and
    /// cosine.
    #[must_use]
    pub fn checked_rotate(self, v: Vec2<S>) -> Option<Vec2<S>> {
        let (cos_x, sin_x) = (self.cos.product(v.x), self.sin.product(v.x));
        let (cos_y, sin_y) = (self.cos.product(v.y), self.sin.product(v.y));
        Some(Vec2::new(cos_x.plus(sin_y.negated())?.to_scalar()?, sin_x.plus(cos_y)?.to_scalar()?))
    }
}

impl Mul<Vec2> for Rot {
    type Output = Vec2;

    /// The vector turned. *Error* as of [`Rot::checked_rotate`].
    ///
    /// # Panics
    /// When a component does not fit; [`Rot::checked_rotate`] gives `None`.
    #[track_caller]
    fn mul(self, v: Vec2) -> Vec2 {
        fitting(self.checked_rotate(v), "Rot: the turned vector does not fit")
    }
}
