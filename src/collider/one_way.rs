//! One-way colliders: the side from which a collider holds others.

use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::fx;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Angle as _, Scalar};
use crate::shape::turned_unit;

/// The side from which a one-way collider holds others: a platform that bodies jump through from below and land on.
///
/// A body that comes near the collider is *held* if the contact normal, from the collider to the body, is within `tolerance` of
/// `direction`. Otherwise it *passes*, and goes on passing until it no longer overlaps the collider; then its side decides anew. A body
/// that is held stays held while it is within 2 cm of the collider, so that it may tilt and slide over an edge. A body that is put into
/// the collider passes if it overlaps by more than 2 cm. To let a body drop through, see
/// [`Exclusion::UntilApart`](crate::Exclusion::UntilApart).
///
/// A body is held or passes as a whole, with all of its colliders. Each part of a compound is a platform of its own: a body may be held by
/// one and pass another. Where both colliders are one-way, they touch only if both hold.
///
/// ```
/// use umbra_physics::{BodyDef, ColliderDef, OneWay, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let one_way = Some(OneWay { direction: vec2(0, 1), ..OneWay::default() });
/// let plank = ColliderDef { one_way, ..ColliderDef::new(Shape::rectangle(fx!(4), fx!(0.25))?) };
/// world.add_body(BodyDef::fixed().with_collider(plank))?;
/// let ball = BodyDef { position: vec2(0, -2), velocity: vec2(0, 8), ..BodyDef::dynamic() };
/// let ball = world.add_body(ball.with_collider(Shape::circle(fx!(0.5))?))?;
/// (0..180).for_each(|_| _ = world.step());
/// assert_eq!(format!("{:.2}", world.body(ball)?.position()), "(0.00, 0.62)"); // through it, and on it
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct OneWay<S = Fx> {
    /// The direction out of the surface that holds, in the axes of the collider. Its length does not matter: each component is within
    /// ±2^10, and one of them is at least 2^-10 in size.
    pub direction: Vec2<S>,
    /// The largest angle between the direction and the normal of a contact that holds, 0 to π/2 rad. *Error* of its cosine 2^-20.
    pub tolerance: S,
}

codec_struct!(OneWay { direction, tolerance });

impl<S: Scalar> Default for OneWay<S> {
    /// Upwards in the axes of the collider, with a tolerance of π/4 (45°).
    fn default() -> Self {
        Self { direction: Vec2::new(S::ZERO, S::ONE), tolerance: S::from_fx(fx!(0.785398163)) }
    }
}

impl<S: Scalar> OneWay<S> {
    /// Checks the side as a world does that gets a collider with it.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::OneWayDirection`] or [`Quantity::OneWayTolerance`].
    ///
    /// ```
    /// use umbra_physics::{Error, OneWay, Quantity, fx, vec2};
    ///
    /// let up: OneWay = OneWay::default();
    /// assert_eq!((up.direction, up.check()), (vec2(0, 1), Ok(())));
    /// let none = OneWay { direction: vec2(0, 0), ..up };
    /// assert_eq!(none.check(), Err(Error::OutOfRange { quantity: Quantity::OneWayDirection }));
    /// let round = OneWay { tolerance: fx!(2), ..up };
    /// assert_eq!(round.check(), Err(Error::OutOfRange { quantity: Quantity::OneWayTolerance }));
    /// ```
    pub fn check(&self) -> Result<(), Error> {
        let check = |ok: bool, quantity| if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) };
        let (min, max) = (S::from_fx(Fx::from_bits(1 << 22)), S::from_fx(Fx::from_bits(1 << 42)));
        let Vec2 { x, y } = self.direction;
        let is_within = |v: S| v >= -max && v <= max;
        let is_long = |v: S| v >= min || v <= -min;
        check(is_within(x) && is_within(y) && (is_long(x) || is_long(y)), Quantity::OneWayDirection)?;
        let is_angle = self.tolerance >= S::ZERO && self.tolerance <= S::from_fx(Fx::FRAC_PI_2);
        check(is_angle, Quantity::OneWayTolerance)
    }

    /// The side in the axes of the body, for a collider that is turned by an angle.
    pub(super) fn side(&self, angle: S) -> Side<S> {
        let (_, cosine) = S::Angle::from_radians(self.tolerance).sin_cos();
        // Normals and directions are rounded.
        Side { direction: turned_unit(self.direction, angle), cosine: cosine - S::from_fx(Fx::from_bits(1 << 12)) }
    }
}

/// The side from which a collider holds, in the axes of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side<S = Fx> {
    /// A unit vector.
    pub(crate) direction: Vec2<S>,
    /// The least cosine of the angle between the direction and a normal that holds.
    pub(crate) cosine: S,
}
