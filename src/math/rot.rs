//! Rotations for use outside the engine.

use super::Vec2;
use crate::scalar::{Angle, Scalar, Wide, fx::Fx};

/// A rotation as cosine and sine, each rounded once.
///
/// The engine itself turns vectors by the [`Angle`], whose sine and cosine have 30 bits more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }

    /// The vector turned; `None` if a component does not fit. *Error* ½ ulp, and half an ulp of sine and cosine times
    /// the length.
    #[must_use]
    pub fn checked_rotate(self, v: Vec2<S>) -> Option<Vec2<S>> {
        let component = |a: S, b: S, c: S, d: S| a.product(b).plus(c.product(d))?.to_scalar();
        Some(Vec2::new(component(self.cos, v.x, -self.sin, v.y)?, component(self.sin, v.x, self.cos, v.y)?))
    }
}
