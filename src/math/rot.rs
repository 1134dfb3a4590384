//! Rotations as sine and cosine.

use crate::fx::Fx;

/// A rotation as cosine and sine, each rounded once.
///
/// The engine itself turns vectors by the exact angle ([`Turn`](crate::Turn)), whose sine and cosine have 30 bits more.
///
/// ```
/// use umbra_physics::{Fx, Rot, Turn, vec2};
///
/// let quarter = Rot::from_angle(Turn::QUARTER);
/// assert_eq!(quarter.checked_rotate(vec2(3, 1)), Some(vec2(-1, 3)));
/// assert_eq!(quarter.inverse().checked_rotate(vec2(-1, 3)), Some(vec2(3, 1)));
/// assert_eq!(quarter * vec2(3, 1), vec2(-1, 3));
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
