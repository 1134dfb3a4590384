//! Rotations for use outside the engine.

use super::Vec2;
use crate::scalar::{Angle, Scalar, Wide, fx::Fx};

/// A rotation as cosine and sine, each rounded once.
///
/// The engine itself turns vectors by the [`Angle`], whose sine and cosine have 30 bits more.
///
/// ```
/// use umbra_physics::{Fx, Rot, Turn, vec2};
///
/// let quarter: Rot = Rot::from_angle(Turn::QUARTER);
/// assert_eq!(quarter.checked_rotate(vec2(3, 1)), Some(vec2(-1, 3)));
/// assert_eq!(quarter.inverse().checked_rotate(vec2(-1, 3)), Some(vec2(3, 1)));
/// assert_eq!(Rot::from_radians(Fx::ZERO), Rot::IDENTITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Rot<S = Fx> {
    /// Cosine of the angle.
    pub cos: S,
    /// Sine of the angle.
    pub sin: S,
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

    /// The rotation by an angle.
    #[must_use]
    pub fn from_angle(angle: S::Angle) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin }
    }

    /// The other way round.
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
