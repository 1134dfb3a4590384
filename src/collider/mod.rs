//! Colliders: the shapes of bodies, which touch other colliders. Their definitions, the mass that bodies have from them, and the set of
//! a world's colliders.

mod chunks;
mod filter;
mod mass;
mod material;
mod one_way;
mod outline;
mod pairs;
mod set;
mod settings;
mod to_fx;

use alloc::vec::Vec;
use core::fmt;

use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_plain, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::Shape;

pub use filter::Filter;
pub(crate) use mass::ColliderMass;
pub use material::{Material, MaterialPair, MixRule};
pub use one_way::OneWay;
pub(crate) use one_way::Side;
pub(crate) use outline::{BodyOutline, OutlineRef};
pub(crate) use pairs::PairEntry;
pub(crate) use set::{Collider, ColliderSet, OutlineId, more_outlines};
pub use settings::ContactSettings;

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
#[doc(alias("ColliderBuilder", "ShapeDef"))]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ColliderDef<S: Scalar = Fx> {
    /// The shape. Each part of a compound and each segment of a chain touches others with its own outline; all of them have the material
    /// and the filter of the collider. A chain is for static and kinematic bodies only.
    pub shape: Shape<S>,
    /// The position of the shape's centre of mass (of a chain, of the origin of its points) relative to the centre of mass of the body, in
    /// the body's axes, m, each component within ±2^12 ([`limits::SIZE_MAX`]).
    pub position: Vec2<S>,
    /// The angle by which the shape is turned against the body, rad.
    pub angle: S,
    /// The density, kg/m² (kg/m for a segment), from 0; with 0 the collider adds no mass, and a chain never does. With
    /// [`Mass::FromColliders`](crate::Mass::FromColliders) it gives the body its mass; with [`Mass::Kilograms`](crate::Mass::Kilograms)
    /// the colliders share the given mass in proportion to their areas and densities.
    pub density: S,
    /// The surface: friction, restitution, rolling resistance, conveyor speed. Where two colliders touch, friction is the geometric mean
    /// of both coefficients and restitution the larger one, unless a [rule](MixRule) of one of them differs.
    pub material: Material<S>,
    /// The filter: which colliders this one touches. With [`Filter::NONE`] it touches nothing.
    pub filter: Filter,
    /// The only side from which the collider holds others, for a platform to jump through; `None` to hold from all sides.
    pub one_way: Option<OneWay<S>>,
    /// True for a sensor: it touches nothing, and the step reports which colliders [enter](crate::Event::SensorEntered) and
    /// [leave](crate::Event::SensorLeft) it. It adds its mass to the body, unless its density is 0.
    pub sensor: bool,
    /// True to report where contacts of the collider [begin](crate::Event::ContactBegan) and [end](crate::Event::ContactEnded). One
    /// of the two colliders is enough. A sensor needs no flag.
    pub contact_events: bool,
    /// True to report [hits](crate::Event::ContactHit): contacts that close at [`ContactSettings::hit_speed`] or faster. One of the
    /// two colliders is enough.
    pub hit_events: bool,
    /// A name of your choice for the collider. Results that tie are sorted by it, so that worlds that were built in different orders
    /// report the same: give colliders distinct keys in that case.
    pub key: u64,
    /// Data of your choice. The engine does not read it.
    pub user_data: u64,
}

codec_struct!(ColliderDef {
    shape,
    position,
    angle,
    density,
    material,
    filter,
    one_way,
    sensor,
    contact_events,
    hit_events,
    key,
    user_data
});
codec_plain!(Filter { category, mask, group });

impl<S: Scalar> ColliderDef<S> {
    /// A collider of this shape around the body's centre of mass, with a density of 1 kg/m² and the default material, that touches
    /// all others and reports no events.
    #[must_use]
    pub fn new(shape: Shape<S>) -> Self {
        Self {
            shape,
            position: Vec2::ZERO,
            angle: S::ZERO,
            density: S::ONE,
            material: Material::default(),
            filter: Filter::default(),
            one_way: None,
            sensor: false,
            contact_events: false,
            hit_events: false,
            key: 0,
            user_data: 0,
        }
    }

    /// A collider that touches nothing: as [`new`](Self::new), with [`Filter::NONE`]. It gives its body mass and an outline to draw.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, ColliderDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// world.add_body(BodyDef { position: vec2(3, 0), ..BodyDef::fixed().with_collider(Shape::rectangle(1, 9)?) })?;
    /// let hull = ColliderDef { density: fx!(5), ..ColliderDef::ghost(Shape::rectangle(2, 1)?) };
    /// let ship = world.add_body(BodyDef { velocity: vec2(6, 0), ..BodyDef::dynamic().with_collider(hull) })?;
    /// (0..60).for_each(|_| _ = world.step());
    /// assert_eq!(world.body(ship)?.position(), vec2(6, 0)); // through the wall
    /// assert_eq!(world.body(ship)?.mass(), Some(fx!(10)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn ghost(shape: Shape<S>) -> Self {
        Self { filter: Filter::NONE, ..Self::new(shape) }
    }

    /// Checks the values of the definition. Whether a body can have it (a chain, the mass)
    /// [`World::add_collider`](crate::World::add_collider) checks.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity: position, angle, density, friction, restitution, rolling resistance, surface speed, the
    /// direction or the tolerance of a one-way collider.
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
        check(self.position.is_within(S::from_fx(limits::SIZE_MAX)), Quantity::ColliderPosition)?;
        check(self.angle.is_finite(), Quantity::Angle)?;
        check(
            self.density >= S::ZERO && self.density.is_finite(),
            Quantity::ColliderDensity { value: self.density.to_fx() },
        )?;
        self.material.check()?;
        self.one_way.map_or(Ok(()), |one_way| one_way.check())
    }
}

impl<S: Scalar> ColliderDef<S> {
    /// Returns true if the collider meets others: as a solid collider, or as a sensor.
    pub(crate) fn meets_others(&self) -> bool {
        !self.filter.meets_nothing()
    }

    /// Returns true if the collider touches others: it meets them, and is no sensor.
    pub(crate) fn is_solid(&self) -> bool {
        self.meets_others() && !self.sensor
    }

    /// Returns true for a sensor that meets others.
    pub(crate) fn is_sensing(&self) -> bool {
        self.meets_others() && self.sensor
    }

    /// Refuses a chain on a dynamic body.
    pub(crate) fn check_on(&self, is_dynamic: bool) -> Result<(), Error> {
        if is_dynamic && self.shape.is_chain() { Err(Error::DynamicChain) } else { Ok(()) }
    }
}

impl<S: Scalar> Write for Vec<ColliderDef<S>> {
    fn write(&self, out: &mut impl Encoder) {
        codec::list(out, self.iter());
    }
}

/// The fewest bytes of a definition: that of a disc.
const LEAST_BYTES: usize = 111;

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
