//! Bodies: their definitions, handles, and the columns their state is kept in.

mod changes;
mod columns;
mod factors;
mod info;
mod motion;
mod record;
mod sets;
mod sparse;
mod target;

use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_enum, codec_struct};
use crate::error::{Error, Quantity};
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar, fx::Fx};
use crate::shape::Shape;

pub(crate) use changes::Change;
pub(crate) use columns::{Bodies, NONE, push};
pub(crate) use factors::{BOUNDED_STEPS, FactorTable, Key, SPANS, StepFactors, WorldFactors};
pub(crate) use info::BodyInfo;
pub(crate) use motion::{Acceleration, BLOCK, Block, Motion};
pub(crate) use record::{Record, ShapeSource};
pub(crate) use sparse::{Row, Sparse};
pub(crate) use target::{KinematicTarget, KinematicTargets, Target, Velocities};

/// What moves a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum BodyKind {
    /// Nothing.
    Static,
    /// The velocity it is given; no force and no damping.
    Kinematic,
    /// Everything.
    #[default]
    Dynamic,
}

/// Whether a body takes part in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Activity {
    /// It does.
    #[default]
    Awake,
    /// It is at rest and skipped, until something wakes it.
    Asleep,
    /// It left the envelope: back at its last good state and out of the simulation, until it is released.
    Quarantined,
    /// It was taken out of the simulation as it was, until it is enabled.
    Disabled,
}

impl Activity {
    /// Whether the body is part of the simulation. One that is not stands still with the velocity it has, and whatever is
    /// attached to it is inert.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef::dynamic())?;
    /// assert!(world.body(body)?.activity().takes_part());
    /// world.disable(body)?;
    /// assert!(!world.body(body)?.activity().takes_part());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub const fn takes_part(self) -> bool {
        match self {
            Self::Awake | Self::Asleep => true,
            Self::Quarantined | Self::Disabled => false,
        }
    }
}

/// Which components of a body's velocity are zero and stay zero, whatever acts on it: along such an axis not a bit of its
/// position changes. The other components move as if the locked ones were at rest by chance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Locks {
    /// The velocity along x.
    pub x: bool,
    /// The velocity along y.
    pub y: bool,
    /// The angular velocity.
    pub rotation: bool,
}

impl Locks {
    /// It moves freely.
    pub const NONE: Self = Self { x: false, y: false, rotation: false };
}

impl Write for Locks {
    fn write(&self, out: &mut impl Encoder) {
        let Self { x, y, rotation } = self;
        codec::field(out, "x", x);
        codec::field(out, "y", y);
        codec::field(out, "rotation", rotation);
    }
}

impl Read for Locks {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { x: bool::read(reader)?, y: bool::read(reader)?, rotation: bool::read(reader)? })
    }
}

/// Where a dynamic body's mass and moment of inertia come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Mass<S = Fx> {
    /// kg/m² times the area of the shape, kg/m for a segment; the inertia from the shape.
    Density(S),
    /// kg; the inertia from the shape, or infinite without one: such a body does not turn.
    Kilograms(S),
    /// kg and kg·m².
    Explicit {
        /// kg.
        mass: S,
        /// kg·m².
        inertia: S,
    },
}

/// What a body is made from. Start from [`BodyDef::dynamic`], [`kinematic`](Self::kinematic) or
/// [`fixed`](Self::fixed) and change what differs.
///
/// ```
/// use umbra_physics::{BodyDef, BodyKind, Error, Mass, Shape, fx, vec2};
///
/// let wheel = BodyDef {
///     shape: Some(Shape::circle(fx!(0.5))?),
///     mass: Mass::Density(fx!(2)),
///     position: vec2(0, 3),
///     ..BodyDef::dynamic()
/// };
/// let lift: BodyDef = BodyDef { velocity: vec2(0, 1), ..BodyDef::kinematic() };
/// let ground: BodyDef = BodyDef { shape: Some(Shape::segment(vec2(-10, 0), vec2(10, 0))?), ..BodyDef::fixed() };
/// let kinds = [wheel.kind, lift.kind, ground.kind];
/// assert_eq!(kinds, [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static]);
///
/// // What a world would refuse:
/// assert_eq!(wheel.check(), Ok(()));
/// assert_eq!(BodyDef { shape: None, ..wheel }.check(), Err(Error::NoShape));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct BodyDef<S: Scalar = Fx> {
    /// What moves it.
    pub kind: BodyKind,
    /// Where its centre of mass is, m.
    pub position: Vec2<S>,
    /// How far it is turned, rad.
    pub angle: S,
    /// Its velocity, m/s. Zero for a static body.
    pub velocity: Vec2<S>,
    /// Its angular velocity, rad/s. Zero for a static body.
    pub angular_velocity: S,
    /// Its shape, which gives it inertia and an outline to draw.
    pub shape: Option<Shape<S>>,
    /// Its mass, if it is dynamic.
    pub mass: Mass<S>,
    /// How much of the world's gravity it feels: 1 all, 0 none, −1 upwards.
    pub gravity_scale: S,
    /// What is left of its velocity after a second, 0 to 1, in place of the world's.
    pub linear_damping: Option<S>,
    /// What is left of its angular velocity after a second, 0 to 1, in place of the world's.
    pub angular_damping: Option<S>,
    /// The largest speed it has after a step, m/s, if it is dynamic: what is faster is slowed down to it, in its direction.
    pub max_speed: Option<S>,
    /// The largest angular speed it has after a step, rad/s, if it is dynamic.
    pub max_angular_speed: Option<S>,
    /// Which components of its velocity are zero and stay zero.
    pub locks: Locks,
    /// The groups it is in: a force field with one of these bits acts on it.
    pub groups: u32,
    /// A name of the caller's, by which worlds built in another order are compared.
    pub key: u64,
    /// Anything of the caller's.
    pub user_data: u64,
}

codec_enum!(BodyKind, "the number of a kind of body", { 0 => Static, 1 => Kinematic, 2 => Dynamic });
codec_enum!(Activity, "the number of an activity", { 0 => Awake, 1 => Asleep, 2 => Quarantined, 3 => Disabled });
codec_enum!(Mass<S>, "the number of a way to give a mass", {
    0 => Density(density),
    1 => Kilograms(mass),
    2 => Explicit { mass, inertia },
});
codec_struct!(BodyDef {
    kind,
    position,
    angle,
    velocity,
    angular_velocity,
    shape,
    mass,
    gravity_scale,
    linear_damping,
    angular_damping,
    max_speed,
    max_angular_speed,
    locks,
    groups,
    key,
    user_data,
});

impl<S: Scalar> BodyDef<S> {
    /// A body of 1 kg that everything moves, at rest at the origin.
    #[must_use]
    pub fn dynamic() -> Self {
        Self {
            kind: BodyKind::Dynamic,
            position: Vec2::ZERO,
            angle: S::ZERO,
            velocity: Vec2::ZERO,
            angular_velocity: S::ZERO,
            shape: None,
            mass: Mass::Kilograms(S::ONE),
            gravity_scale: S::ONE,
            linear_damping: None,
            angular_damping: None,
            max_speed: None,
            max_angular_speed: None,
            locks: Locks::NONE,
            groups: 1,
            key: 0,
            user_data: 0,
        }
    }

    /// A body that moves with the velocity it is given.
    #[must_use]
    pub fn kinematic() -> Self {
        Self { kind: BodyKind::Kinematic, ..Self::dynamic() }
    }

    /// A body that never moves.
    #[must_use]
    pub fn fixed() -> Self {
        Self { kind: BodyKind::Static, ..Self::dynamic() }
    }

    /// Refuses what a world would.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity; [`Error::NoShape`] for a density without a shape; [`Error::Locked`] for a
    /// velocity along a locked axis.
    pub fn check(&self) -> Result<(), Error> {
        self.checked().map(drop)
    }

    /// The properties that follow from it, if no world would refuse it.
    pub(crate) fn checked(&self) -> Result<MassProperties<S>, Error> {
        check_position(self.position)?;
        check_angle(self.angle)?;
        check_velocity(self.velocity)?;
        check_angular_velocity(self.angular_velocity)?;
        let still = self.velocity == Vec2::ZERO && self.angular_velocity == S::ZERO;
        if self.kind == BodyKind::Static && !still {
            return Err(Error::OutOfRange { quantity: Quantity::Velocity });
        }
        check_unlocked(self.locks, self.velocity)?;
        check_turning(self.locks, self.angular_velocity)?;
        check_gravity_scale(self.gravity_scale)?;
        self.linear_damping.map_or(Ok(()), check_damping)?;
        self.angular_damping.map_or(Ok(()), check_damping)?;
        self.max_speed.map_or(Ok(()), check_max_speed)?;
        self.max_angular_speed.map_or(Ok(()), check_max_angular_speed)?;
        mass_properties(self.kind, self.mass, self.shape.as_ref())
    }
}

/// 1/m and 1/I; zero for what no force moves or no torque turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassProperties<S: Scalar> {
    pub(crate) inverse_mass: S::Factor,
    pub(crate) inverse_inertia: S::Factor,
}

/// kg, of a dynamic body.
fn mass_of<S: Scalar>(mass: Mass<S>, shape: Option<&Shape<S>>) -> Result<S, Error> {
    let out_of = |quantity| Error::OutOfRange { quantity };
    match mass {
        Mass::Density(density) => {
            if !(density > S::ZERO && density.is_finite()) {
                return Err(out_of(Quantity::Density));
            }
            let area = shape.ok_or(Error::NoShape)?.measure();
            S::Factor::from_scalar(density).times(area).to_scalar().ok_or(out_of(Quantity::Mass))
        }
        Mass::Kilograms(mass) | Mass::Explicit { mass, inertia: _ } => Ok(mass),
    }
}

/// kg·m², of a body of this mass in kg; zero for infinite.
fn inertia_of<S: Scalar>(kilograms: S, mass: Mass<S>, shape: Option<&Shape<S>>) -> S::Factor {
    match (mass, shape) {
        (Mass::Explicit { mass: _, inertia }, _) => S::Factor::from_scalar(inertia),
        (_, Some(shape)) => S::Factor::from_scalar(kilograms).times(shape.gyration()),
        (_, None) => S::Factor::ZERO,
    }
}

/// The properties that follow from a definition.
pub(crate) fn mass_properties<S: Scalar>(
    kind: BodyKind,
    mass: Mass<S>,
    shape: Option<&Shape<S>>,
) -> Result<MassProperties<S>, Error> {
    let zero = S::Factor::ZERO;
    if kind != BodyKind::Dynamic {
        return Ok(MassProperties { inverse_mass: zero, inverse_inertia: zero });
    }
    if matches!(mass, Mass::Explicit { mass: _, inertia } if !(inertia > S::ZERO && inertia.is_finite())) {
        return Err(Error::OutOfRange { quantity: Quantity::Inertia });
    }
    let kilograms = mass_of(mass, shape)?;
    if !(kilograms >= S::from_fx(limits::MASS_MIN) && kilograms <= S::from_fx(limits::MASS_MAX)) {
        return Err(Error::OutOfRange { quantity: Quantity::Mass });
    }
    let inverse = |f: S::Factor| if f.is_zero() { f } else { S::Factor::ONE.over(f) };
    Ok(MassProperties {
        inverse_mass: inverse(S::Factor::from_scalar(kilograms)),
        inverse_inertia: inverse(inertia_of(kilograms, mass, shape)),
    })
}

fn check(ok: bool, quantity: Quantity) -> Result<(), Error> {
    if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

fn within<S: Scalar>(value: S, limit: Fx) -> bool {
    let limit = S::from_fx(limit);
    -limit <= value && value <= limit
}

/// What [`check_position`] and its like ask, of what a step left.
pub(crate) fn within_envelope<S: Scalar>(
    pair: Vec2<S::Accumulator>,
    limit: Fx,
    quantity: Quantity,
) -> Result<(), Error> {
    let limit = S::from_fx(limit);
    check(pair.x.is_within(limit) && pair.y.is_within(limit), quantity)
}

pub(crate) fn check_position<S: Scalar>(position: Vec2<S>) -> Result<(), Error> {
    check(within(position.x, limits::POSITION) && within(position.y, limits::POSITION), Quantity::Position)
}

pub(crate) fn check_angle<S: Scalar>(angle: S) -> Result<(), Error> {
    check(angle.is_finite(), Quantity::Angle)
}

pub(crate) fn check_velocity<S: Scalar>(velocity: Vec2<S>) -> Result<(), Error> {
    check(within(velocity.x, limits::SPEED) && within(velocity.y, limits::SPEED), Quantity::Velocity)
}

pub(crate) fn check_angular_velocity<S: Scalar>(velocity: S) -> Result<(), Error> {
    check(within(velocity, limits::ANGULAR_SPEED), Quantity::AngularVelocity)
}

/// Refuses a velocity along a locked axis.
pub(crate) fn check_unlocked<S: Scalar>(locks: Locks, velocity: Vec2<S>) -> Result<(), Error> {
    let moves = (locks.x && velocity.x != S::ZERO) || (locks.y && velocity.y != S::ZERO);
    if moves { Err(Error::Locked { quantity: Quantity::Velocity }) } else { Ok(()) }
}

/// The same of an angular velocity.
pub(crate) fn check_turning<S: Scalar>(locks: Locks, velocity: S) -> Result<(), Error> {
    let turns = locks.rotation && velocity != S::ZERO;
    if turns { Err(Error::Locked { quantity: Quantity::AngularVelocity }) } else { Ok(()) }
}

pub(crate) fn check_gravity_scale<S: Scalar>(scale: S) -> Result<(), Error> {
    check(within(scale, limits::GRAVITY_SCALE), Quantity::GravityScale)
}

pub(crate) fn check_max_speed<S: Scalar>(most: S) -> Result<(), Error> {
    check(most >= S::ZERO && within(most, limits::SPEED), Quantity::MaxSpeed)
}

pub(crate) fn check_max_angular_speed<S: Scalar>(most: S) -> Result<(), Error> {
    check(most >= S::ZERO && within(most, limits::ANGULAR_SPEED), Quantity::MaxAngularSpeed)
}

pub(crate) fn check_damping<S: Scalar>(kept: S) -> Result<(), Error> {
    check(kept >= S::ZERO && kept <= S::ONE, Quantity::Damping)
}
