//! Vectors and rotations of scalars.

use super::number::{Angle, Scalar, Wide};
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
    pub fn wide_dot(self, other: Self) -> Option<S::Wide> {
        self.x.product(other.x).plus(self.y.product(other.y))
    }

    /// The cross product x·y' − y·x', exactly; `None` if it does not fit.
    #[must_use]
    pub fn wide_cross(self, other: Self) -> Option<S::Wide> {
        self.x.product(other.y).plus(self.y.product(other.x).negated())
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
