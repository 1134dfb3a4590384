//! Colliders: shapes on bodies that touch other colliders. Their definitions, the mass that bodies have from them, and the set of
//! a world's colliders.

mod filter;
mod mass;
mod set;
mod settings;

use alloc::vec::Vec;
use core::fmt;

use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_plain, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::{Geometry, Shape};

pub use filter::Filter;
pub(crate) use mass::ColliderMass;
pub(crate) use set::{Collider, ColliderSet};
pub use settings::ContactSettings;

/// The surface of a collider. Where two colliders touch, the friction is the geometric mean of theirs, and the restitution the
/// larger one.
///
/// ```
/// use umbra_physics::{Material, fx};
///
/// let ice = Material { friction: fx!(0.02), ..Material::default() };
/// let rubber: Material = Material { friction: fx!(1), restitution: fx!(0.8) };
/// assert!(ice.friction < Material::default().friction && rubber.restitution > fx!(0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Material<S = Fx> {
    /// The coefficient of friction μ, 0 to [`limits::FRICTION`]: a contact that is pressed with the force N holds against a force of
    /// up to μ·N along the surface.
    pub friction: S,
    /// The coefficient of restitution, 0 to 1: the share of the approach speed at which bodies part after an impact. 0 for no bounce.
    pub restitution: S,
}

codec_struct!(Material { friction, restitution });

impl<S: Scalar> Default for Material<S> {
    /// Friction 0.6, like wood on wood, and no restitution.
    fn default() -> Self {
        Self { friction: S::from_fx(crate::fx!(0.6)), restitution: S::ZERO }
    }
}

impl<S: Scalar> Material<S> {
    /// Refuses a coefficient out of range.
    fn check(&self) -> Result<(), Error> {
        let within = |value: S, most: Fx| value >= S::ZERO && value <= S::from_fx(most);
        if !within(self.friction, limits::FRICTION) {
            return Err(Error::OutOfRange { quantity: Quantity::Friction });
        }
        if !within(self.restitution, Fx::ONE) {
            return Err(Error::OutOfRange { quantity: Quantity::Restitution });
        }
        Ok(())
    }
}

/// The definition of a collider: a shape at a place of its body. Start from [`ColliderDef::new`] and change what differs.
///
/// Colliders of one body do not touch each other, and neither do those of two bodies that are not dynamic.
///
/// ```
/// use umbra_physics::{BodyDef, ColliderDef, Filter, Material, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let wheel = ColliderDef::new(Shape::circle(fx!(0.25))?);
/// let [left, right] = [-1, 1].map(|x| ColliderDef { position: vec2(x, fx!(-0.5)), ..wheel.clone() });
/// let hull = ColliderDef {
///     material: Material { friction: fx!(0.3), ..Material::default() },
///     filter: Filter { category: 2, ..Filter::default() },
///     density: fx!(5),
///     ..ColliderDef::new(Shape::rectangle(fx!(3), fx!(1))?)
/// };
/// let cart = world.add_body(BodyDef { colliders: vec![hull, left, right], ..BodyDef::dynamic() })?;
/// assert_eq!(world.colliders_of(cart)?.count(), 3);
/// // The mass is that of the colliders: 3 m² of 5 kg/m², and two discs of π/16 m² each.
/// assert_eq!(format!("{:.3}", world.body(cart)?.mass().unwrap()), "15.393");
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ColliderDef<S: Scalar = Fx> {
    /// The shape, which is convex: no compound. Give a body several colliders instead.
    pub shape: Shape<S>,
    /// The position of the shape's centre of mass relative to that of the body, in the body's axes, m.
    pub position: Vec2<S>,
    /// The angle by which the shape is turned against the body, rad.
    pub angle: S,
    /// The density, kg/m² (kg/m for a segment): used by bodies whose mass is [`Mass::FromColliders`](crate::Mass::FromColliders), and
    /// relative to the densities of the body's other colliders by [`Mass::Kilograms`](crate::Mass::Kilograms). 0 for a collider that
    /// adds no mass.
    pub density: S,
    /// The surface.
    pub material: Material<S>,
    /// The filter: which colliders this one touches.
    pub filter: Filter,
    /// A name of your choice for the collider. Worlds that were built in different orders are compared by it.
    pub key: u64,
    /// Data of your choice. The engine does not read it.
    pub user_data: u64,
}

codec_struct!(ColliderDef { shape, position, angle, density, material, filter, key, user_data });
codec_plain!(Filter { category, mask, group });

impl<S: Scalar> ColliderDef<S> {
    /// A collider of this shape around the body's centre of mass, with a density of 1 kg/m² and the default material, that touches
    /// all others.
    #[must_use]
    pub fn new(shape: Shape<S>) -> Self {
        Self {
            shape,
            position: Vec2::ZERO,
            angle: S::ZERO,
            density: S::ONE,
            material: Material::default(),
            filter: Filter::default(),
            key: 0,
            user_data: 0,
        }
    }

    /// Checks the definition as a world does that it is added to.
    ///
    /// # Errors
    /// [`Error::CompoundCollider`]; [`Error::OutOfRange`] naming the quantity: position, angle, density, friction, restitution, or a
    /// filter that has no category or no mask and no group.
    ///
    /// ```
    /// use umbra_physics::{ColliderDef, Error, Material, Quantity, Shape, fx};
    ///
    /// let ball = ColliderDef::new(Shape::circle(fx!(0.5))?);
    /// assert_eq!(ball.check(), Ok(()));
    /// let sticky = ColliderDef { material: Material { friction: fx!(-1), ..ball.material }, ..ball };
    /// assert_eq!(sticky.check(), Err(Error::OutOfRange { quantity: Quantity::Friction }));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn check(&self) -> Result<(), Error> {
        let check = |ok: bool, quantity| if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) };
        if matches!(self.shape.geometry(), Geometry::Compound { .. }) {
            return Err(Error::CompoundCollider);
        }
        check(self.position.is_within(S::from_fx(limits::SIZE_MAX)), Quantity::ColliderPosition)?;
        check(self.angle.is_finite(), Quantity::Angle)?;
        check(self.density >= S::ZERO && self.density.is_finite(), Quantity::ColliderDensity)?;
        self.material.check()?;
        check(!self.filter.meets_nothing(), Quantity::Filter)
    }
}

impl<S: Scalar> Write for Vec<ColliderDef<S>> {
    fn write(&self, out: &mut impl Encoder) {
        codec::list(out, self.iter());
    }
}

/// The fewest bytes of a definition: that of a disc.
const LEAST_BYTES: usize = 85;

impl Read for Vec<ColliderDef> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        (0..reader.count(LEAST_BYTES)?).map(|_| ColliderDef::read(reader)).collect()
    }
}

impl<S: Scalar> From<Shape<S>> for ColliderDef<S> {
    fn from(shape: Shape<S>) -> Self {
        Self::new(shape)
    }
}

impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "category {:#x}, mask {:#x}, group {}", self.category, self.mask, self.group)
    }
}
