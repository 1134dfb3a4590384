//! Contacts as the interface shows them.

use crate::collide::Manifold;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{FxFactor, Scalar};
use crate::slots::{BodyId, ColliderId};

use super::ContactRecord;
use super::seams::rolling_radius;

/// A contact: two colliders, or a part of each, that pushed each other at the end of the last step, or touched in it
/// and have [events](crate::ColliderDef::contact_events), seen at the present poses of their bodies.
/// [`World::contacts`](crate::World::contacts) lists them.
///
/// The first collider is the one with the lower slot, whichever body is the player or the ground: look for yours in `bodies`, and turn
/// the normal round if it is the first. (Pairs of [events](crate::ColliderPair) are in the order of keys instead.)
///
/// ```
/// use umbra_physics::{BodyDef, Contact, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ground = world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(fx!(20), fx!(2))?))?;
/// let crate_ = BodyDef { position: vec2(0, fx!(1.5)), ..BodyDef::dynamic().with_collider(Shape::rectangle(fx!(1), fx!(1))?) };
/// let crate_ = world.add_body(crate_)?;
/// (0..60).for_each(|_| _ = world.step());
/// let contact: Contact = world.contacts().next().unwrap();
/// assert_eq!((contact.bodies, contact.normal), ([ground, crate_], vec2(0, 1)));
/// assert_eq!(contact.points().len(), 2); // two corners of the crate
/// // The impulses hold a kilogram against gravity for a sub-step of 1/300 s.
/// let total = contact.points().iter().fold(fx!(0), |sum, point| sum + point.normal_impulse);
/// assert!((total - fx!(0.0333)).abs() < fx!(0.0001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contact<S: Scalar = Fx> {
    /// The colliders.
    pub colliders: [ColliderId; 2],
    /// The bodies of the colliders.
    pub bodies: [BodyId; 2],
    /// The outlines that touch, by their number in each shape: the part of a compound, the segment of a chain, 0 for all other shapes.
    pub parts: [u32; 2],
    /// The unit vector from the first collider to the second one. *Error* 2^-29 in each component.
    pub normal: Vec2<S>,
    /// The impulse of friction on the second body along the tangent (n.y, −n.x) over the last sub-step, N·s.
    pub tangent_impulse: S,
    /// The angular impulse of rolling resistance over the last sub-step, N·m·s, on the second body; 0 with two points.
    pub rolling_impulse: S,
    points: [ContactPoint<S>; 2],
    count: usize,
}

/// A point of a [`Contact`].
///
/// ```
/// use umbra_physics::{Contact, ContactPoint, Fx};
///
/// /// The impulse along the normal at all points of a contact, N·s.
/// fn normal_impulse(contact: &Contact) -> Fx {
///     contact.points().iter().fold(Fx::ZERO, |sum, point: &ContactPoint| sum + point.normal_impulse)
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ContactPoint<S: Scalar = Fx> {
    /// The position, m, in the middle between the two surfaces.
    pub position: Vec2<S>,
    /// The distance between the surfaces along the normal, m; negative where they overlap.
    pub separation: S,
    /// The impulse on the second body along the normal over the last sub-step, N·s, from 0. The deepest point that is new since the step has
    /// the impulses of the points that are gone.
    pub normal_impulse: S,
}

impl<S: Scalar> Contact<S> {
    /// The points: one or two.
    #[must_use]
    pub fn points(&self) -> &[ContactPoint<S>] {
        &self.points[..self.count]
    }

    /// The contact of a record, with a manifold of two outlines of these radii; the first one is of a body at this position.
    pub(crate) fn new(
        record: &ContactRecord,
        handles: ([ColliderId; 2], [BodyId; 2]),
        parts: [u32; 2],
        radii: [Fx; 2],
        position: Vec2,
        manifold: &Manifold,
    ) -> Self {
        let (colliders, bodies) = handles;
        let is_rolling = record.count() == 1;
        let rolling = if is_rolling { at_lever(record, rolling_radius(record.features()[0], radii)) } else { Fx::ZERO };
        // From 2^-30 to 2^-32.
        let [x, y] = manifold.normal.map(|part| S::from_fx(Fx::from_bits(i64::from(part) << 2)));
        let mut contact = Self {
            colliders,
            bodies,
            parts,
            normal: Vec2::new(x, y),
            tangent_impulse: S::from_fx(newton_seconds(record.impulses[2], record.exponent())),
            rolling_impulse: S::from_fx(rolling),
            points: Default::default(),
            count: manifold.count,
        };
        let impulses = record.start_at(manifold);
        let points = manifold.points.iter().zip(impulses.values);
        for (place, (point, impulse)) in contact.points.iter_mut().zip(points).take(manifold.count) {
            // Positions are within 2^31 m, arms within 2^15 m.
            let x = position.x.saturating_add(point.arm_a.x);
            let y = position.y.saturating_add(point.arm_a.y);
            *place = ContactPoint {
                position: Vec2::new(S::from_fx(x), S::from_fx(y)),
                separation: S::from_fx(point.separation),
                normal_impulse: S::from_fx(newton_seconds(impulse, impulses.exponent)),
            };
        }
        contact
    }
}

/// The angular impulse of rolling resistance at a radius, N·m·s; the largest number if it does not fit.
fn at_lever(record: &ContactRecord, radius: Fx) -> Fx {
    let impulse = record.impulses[1];
    let size = FxFactor::from_scalar(newton_seconds(impulse.abs(), record.exponent()));
    let turn = size.times(FxFactor::from_scalar(radius)).to_scalar().unwrap_or(Fx::MAX);
    if impulse < 0 { -turn } else { turn }
}

/// An impulse in units of 2^exponent N·s, rounded to nearest, halves away from zero; the largest number if it does not fit.
pub(super) fn newton_seconds(impulse: i64, exponent: i32) -> Fx {
    let size = u128::from(impulse.unsigned_abs());
    // To units of 2^-32: below 2^63 · 2^64 where it fits at all.
    let bits = match exponent + 32 {
        up @ 0.. if size.leading_zeros() > up as u32 => size << up,
        0.. if size > 0 => u128::MAX,
        0.. => 0,
        down @ -127.. => (size + (1 << (-down - 1))) >> -down,
        _ => 0,
    };
    let bits = i64::try_from(bits).unwrap_or(i64::MAX);
    Fx::from_bits(if impulse < 0 { -bits } else { bits })
}
