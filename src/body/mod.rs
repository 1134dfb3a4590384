//! Bodies: their definitions, and the columns that hold their state.

mod asleep;
mod changes;
mod columns;
mod damping;
mod factors;
mod info;
mod mass;
mod motion;
mod order;
mod record;
mod rows;
mod sets;
mod sparse;
mod target;

use core::fmt;

use alloc::vec::Vec;

use crate::codec::{codec_enum, codec_plain, codec_struct};
use crate::collider::{ColliderDef, ColliderMass};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Scalar};

pub(crate) use changes::{Change, ChangeCursor};
pub(crate) use columns::Bodies;
pub use damping::Damping;
pub(crate) use factors::{BOUNDED_STEPS, FactorTable, Key, SPANS, StepFactors, WorldFactors};
pub(crate) use info::BodyInfo;
pub use mass::Mass;
pub(crate) use mass::MassProperties;
pub(crate) use motion::{Acceleration, BLOCK, Block, Motion};
pub(crate) use order::InOrder;
pub(crate) use record::Record;
pub(crate) use sparse::{Row, Sparse};
pub(crate) use target::{KinematicTarget, KinematicTargets, Target, Velocities};

/// Kind of motion of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum BodyKind {
    /// The body never moves.
    Static,
    /// The body moves at the velocity you set. Forces, damping and contacts have no effect on it; it pushes dynamic bodies.
    Kinematic,
    /// The body responds to forces, gravity, damping and contacts.
    #[default]
    Dynamic,
}

/// The part a body takes in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Activity {
    /// The body takes part.
    #[default]
    Awake,
    /// The body rests, and steps skip it until something wakes it.
    Asleep,
    /// The body left the allowed range, or a step failed for it. It is back in its state before that step and excluded from
    /// the simulation until it is released.
    Quarantined,
    /// A call excluded the body from the simulation. It stays as it was until it is enabled.
    Disabled,
}

impl fmt::Display for BodyKind {
    /// Writes the kind in one word, as scenes do.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Static => "static",
            Self::Kinematic => "kinematic",
            Self::Dynamic => "dynamic",
        })
    }
}

impl fmt::Display for Activity {
    /// Writes the activity in one word.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Awake => "awake",
            Self::Asleep => "asleep",
            Self::Quarantined => "quarantined",
            Self::Disabled => "disabled",
        })
    }
}

impl Activity {
    /// True if the body is part of the simulation. Otherwise it stays in place and keeps its velocity, and fields that
    /// are attached to it do nothing.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
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

/// The locked axes of a body. The velocity along a locked axis is zero and stays zero, whatever acts on the body, and the position along it
/// does not change by a bit. Along the other axes the body moves as without locks. Lock the rotation of a character that is to stay
/// upright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Locks {
    /// Locks the velocity along x.
    pub x: bool,
    /// Locks the velocity along y.
    pub y: bool,
    /// Locks the angular velocity.
    pub rotation: bool,
}

impl Locks {
    /// No locks.
    pub const NONE: Self = Self { x: false, y: false, rotation: false };

    /// The names of what is locked: `x`, `y`, `rotation`, as scenes write them.
    ///
    /// ```
    /// use umbra_physics::Locks;
    ///
    /// let locks = Locks { x: true, rotation: true, ..Locks::NONE };
    /// assert!(locks.names().eq(["x", "rotation"]));
    /// ```
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let named = [("x", self.x), ("y", self.y), ("rotation", self.rotation)];
        named.into_iter().filter_map(|(name, is_locked)| is_locked.then_some(name))
    }
}

codec_plain!(Locks { x, y, rotation });

/// The definition of a body. Start from [`BodyDef::dynamic`], [`kinematic`](Self::kinematic) or [`fixed`](Self::fixed) and
/// change what differs.
///
/// ```
/// use umbra_physics::{BodyDef, BodyKind, Error, Locks, Mass, Quantity, Shape, World, WorldDef, fx, vec2};
///
/// let ground = BodyDef::fixed().with_collider(Shape::rectangle(20, 1)?);
/// let lift = BodyDef { velocity: vec2(0, 1), ..BodyDef::kinematic().with_collider(Shape::rectangle(2, fx!(0.25))?) };
/// let hero = BodyDef {
///     position: vec2(0, 3),
///     mass: Mass::Kilograms(fx!(70)), // in place of area · density
///     locks: Locks { rotation: true, ..Locks::NONE },
///     ..BodyDef::dynamic().with_collider(Shape::capsule(1, fx!(0.25))?)
/// };
/// let kinds = [ground.kind, lift.kind, hero.kind];
/// assert_eq!(kinds, [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic]);
///
/// // A definition can be checked without a world:
/// assert_eq!(hero.check(), Ok(()));
/// let fast = BodyDef { velocity: vec2(2_000_000, 0), ..hero.clone() };
/// assert_eq!(fast.check(), Err(Error::OutOfRange { quantity: Quantity::Velocity }));
///
/// let mut world = World::new(WorldDef::default())?;
/// let hero = world.add_body(hero)?;
/// assert_eq!(world.body(hero)?.mass(), Some(fx!(70)));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias = "RigidBodyBuilder")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct BodyDef<S: Scalar = Fx> {
    /// How the body moves.
    pub kind: BodyKind,
    /// The position of the centre of mass, m, each component within ±2^30. (Not the origin of the shapes, as in Box2D and Rapier.)
    pub position: Vec2<S>,
    /// The angle, rad, counter-clockwise; of any size.
    pub angle: S,
    /// The velocity, m/s, each component within ±2^20. Zero for a static body.
    pub velocity: Vec2<S>,
    /// The angular velocity, rad/s, within ±2^20. Zero for a static body.
    pub angular_velocity: S,
    /// The colliders: the shapes that give the body its mass and its outline, and with which it touches others.
    /// [`with_collider`](Self::with_collider) adds one. A body that touches nothing has [ghosts](ColliderDef::ghost), or none.
    /// [`World::colliders_of`](crate::World::colliders_of) gives the handles of a new body's colliders in this order.
    pub colliders: Vec<ColliderDef<S>>,
    /// The mass, used while the body is dynamic.
    pub mass: Mass<S>,
    /// The factor on the world's gravity, within ±16: 1 for all of it, 0 for none, −1 for the opposite direction.
    pub gravity_scale: S,
    /// The damping of the velocity; `None` for the world's.
    pub linear_damping: Option<Damping<S>>,
    /// The damping of the angular velocity; `None` for the world's.
    pub angular_damping: Option<Damping<S>>,
    /// The largest speed after a step, m/s, 0 to 2^20, if the body is dynamic; `None` for no limit. A faster body is slowed down to it and
    /// keeps its direction.
    pub max_speed: Option<S>,
    /// The largest angular speed after a step, rad/s, 0 to 2^20, if the body is dynamic; `None` for no limit.
    pub max_angular_speed: Option<S>,
    /// The axes along which the body cannot move.
    pub locks: Locks,
    /// The dominance, any whole number; 0 by default. Where two dynamic bodies of unequal dominance touch, the one with the higher number
    /// pushes the other as a kinematic body would, and gets no impulse from it. Static and kinematic bodies are above all dynamic ones.
    pub dominance: i32,
    /// True for a *bullet*: a body whose colliders do not cross those of dynamic bodies, at any speed. Without it they do not cross those
    /// of static and kinematic bodies, which needs no flag. A bullet costs more time in ticks in which it, or a body near it, moves more
    /// than a quarter of its width.
    pub bullet: bool,
    /// The groups of the body, one bit each; 1 by default. A force field that has one of these bits acts on it.
    pub force_groups: u32,
    /// A name of your choice for the body; 0 for none. [`World::body_with_key`](crate::World::body_with_key) finds it, and worlds that were
    /// built in different orders are compared by it.
    pub key: u64,
    /// Data of your choice. The engine does not read it.
    pub user_data: u64,
}

codec_enum!(BodyKind, "the number of a kind of body", { 0 => Static, 1 => Kinematic, 2 => Dynamic });
codec_enum!(Activity, "the number of an activity", { 0 => Awake, 1 => Asleep, 2 => Quarantined, 3 => Disabled });
codec_struct!(BodyDef {
    kind,
    position,
    angle,
    velocity,
    angular_velocity,
    colliders,
    mass,
    gravity_scale,
    linear_damping,
    angular_damping,
    max_speed,
    max_angular_speed,
    locks,
    dominance,
    bullet,
    force_groups,
    key,
    user_data,
});

impl<S: Scalar> Default for BodyDef<S> {
    /// A dynamic body, as [`dynamic`](Self::dynamic) gives it.
    fn default() -> Self {
        Self::dynamic()
    }
}

impl<S: Scalar> BodyDef<S> {
    /// A dynamic body at rest at the origin, with the mass of its colliders; 1 kg without any.
    #[must_use]
    pub fn dynamic() -> Self {
        Self {
            kind: BodyKind::Dynamic,
            position: Vec2::ZERO,
            angle: S::ZERO,
            velocity: Vec2::ZERO,
            angular_velocity: S::ZERO,
            colliders: Vec::new(),
            mass: Mass::FromColliders,
            gravity_scale: S::ONE,
            linear_damping: None,
            angular_damping: None,
            max_speed: None,
            max_angular_speed: None,
            locks: Locks::NONE,
            dominance: 0,
            bullet: false,
            force_groups: 1,
            key: 0,
            user_data: 0,
        }
    }

    /// A kinematic body at the origin. Set its velocity, or move it to targets.
    #[must_use]
    pub fn kinematic() -> Self {
        Self { kind: BodyKind::Kinematic, ..Self::dynamic() }
    }

    /// A static body at the origin.
    #[doc(alias("static", "static_"))]
    #[must_use]
    pub fn fixed() -> Self {
        Self { kind: BodyKind::Static, ..Self::dynamic() }
    }

    /// The definition with another collider.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(fx!(20), fx!(2))?))?;
    /// let ball = BodyDef { position: vec2(0, 5), ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?) };
    /// let ball = world.add_body(ball)?;
    /// (0..120).for_each(|_| _ = world.step());
    /// let height = world.body(ball)?.position().y;
    /// assert!(height > fx!(1.49) && height < fx!(1.51)); // on the ground
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn with_collider(mut self, collider: impl Into<ColliderDef<S>>) -> Self {
        self.colliders.push(collider.into());
        self
    }

    /// Checks the definition as a world does that the body is added to.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity; [`Error::Locked`] for a velocity along a locked axis; [`Error::DynamicChain`] for a
    /// chain on a dynamic body.
    pub fn check(&self) -> Result<(), Error> {
        self.checked().map(drop)
    }

    /// The mass of the body's colliders and its mass properties, if the definition is valid.
    pub(crate) fn checked(&self) -> Result<(ColliderMass<S>, MassProperties<S>), Error> {
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
        for collider in &self.colliders {
            collider.check()?;
            collider.check_on(self.kind == BodyKind::Dynamic)?;
        }
        let colliders = ColliderMass::of(self.colliders.iter());
        let properties = self.check_properties(&colliders)?;
        Ok((colliders, properties))
    }

    /// The mass properties of a body with this definition and colliders of this mass, if its properties other than its motion are valid.
    fn check_properties(&self, colliders: &ColliderMass<S>) -> Result<MassProperties<S>, Error> {
        check_gravity_scale(self.gravity_scale)?;
        self.linear_damping.map_or(Ok(()), Damping::check)?;
        self.angular_damping.map_or(Ok(()), Damping::check)?;
        self.max_speed.map_or(Ok(()), check_max_speed)?;
        self.max_angular_speed.map_or(Ok(()), check_max_angular_speed)?;
        self.mass.properties(colliders, self.kind, self.locks)
    }
}

fn check(ok: bool, quantity: Quantity) -> Result<(), Error> {
    if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

fn within<S: Scalar>(value: S, limit: Fx) -> bool {
    let limit = S::from_fx(limit);
    -limit <= value && value <= limit
}

/// Refuses a position, a velocity or an angular velocity with a component beyond these limits, to the last bit of an
/// accumulator: for the results of steps.
pub(crate) fn within_envelope<S: Scalar>(
    position: Vec2<S::Accumulator>,
    velocity: Vec2<S::Accumulator>,
    angular_velocity: S::Accumulator,
    limits: [Fx; 3],
) -> Result<(), Error> {
    let [at, speed, angular_speed] = limits.map(S::from_fx);
    let both = |v: Vec2<S::Accumulator>, limit| v.x.is_within(limit) && v.y.is_within(limit);
    check(both(position, at), Quantity::Position)?;
    check(both(velocity, speed), Quantity::Velocity)?;
    check(angular_velocity.is_within(angular_speed), Quantity::AngularVelocity)
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

/// Refuses an angular velocity where the rotation is locked.
pub(crate) fn check_turning<S: Scalar>(locks: Locks, velocity: S) -> Result<(), Error> {
    let turns = locks.rotation && velocity != S::ZERO;
    if turns { Err(Error::Locked { quantity: Quantity::AngularVelocity }) } else { Ok(()) }
}

pub(crate) fn check_gravity_scale<S: Scalar>(scale: S) -> Result<(), Error> {
    check(within(scale, limits::GRAVITY_SCALE), Quantity::GravityScale)
}

pub(crate) fn check_max_speed<S: Scalar>(max_speed: S) -> Result<(), Error> {
    check(max_speed >= S::ZERO && within(max_speed, limits::SPEED), Quantity::MaxSpeed)
}

pub(crate) fn check_max_angular_speed<S: Scalar>(max_speed: S) -> Result<(), Error> {
    check(max_speed >= S::ZERO && within(max_speed, limits::ANGULAR_SPEED), Quantity::MaxAngularSpeed)
}
