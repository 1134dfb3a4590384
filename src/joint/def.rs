//! Joints as data.

use crate::body::{Bodies, BodyKind, check_angle};
use crate::codec::{codec_enum, codec_struct};
use crate::error::{Error, Quantity};
use crate::force::End;
use crate::fx::Fx;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::solve;

/// A joint to be added to a world with [`World::add_joint`](crate::World::add_joint): two ends and what it keeps of them.
///
/// [`JointDef::at`] and [`JointDef::between`] make the definition from points of the world; change what differs.
///
/// ```
/// use umbra_physics::{BodyDef, Event, JointDef, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let lamp = world.add_body(BodyDef { position: vec2(0, -2), ..BodyDef::dynamic() })?;
/// // A lamp of 1 kg on a rod of 2 m, which carries no more than 15 N.
/// let rod = JointDef::between(&world, None, vec2(0, 0), lamp, vec2(0, -2))?;
/// let rod = world.add_joint(JointDef { break_force: Some(fx!(15)), events: true, ..rod })?;
/// (0..60).for_each(|_| _ = world.step());
/// assert!((world.joint(rod)?.force().length() - fx!(10)).abs() < fx!(0.1));
///
/// world.apply_impulse(lamp, vec2(0, -1))?;
/// let broke = world.step().into_iter().any(|event| matches!(event, Event::JointBroke(broke) if broke.joint == rod));
/// assert!(broke && world.joint(rod)?.is_broken());
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointDef<S = Fx> {
    /// The two ends: points of two bodies, or of a body and of the world. At least one of the bodies is dynamic when the joint is added.
    pub ends: [End<S>; 2],
    /// The angle of the joint's frame in the axes of each end, rad. [`JointRef::angle`](crate::JointRef::angle) is the angle from the first
    /// frame to the second one.
    pub angles: [S; 2],
    /// The kind, with its values.
    pub kind: JointKind<S>,
    /// True if the two bodies touch each other all the same. False by default: then they are excluded from contacts as long as the joint
    /// is there, enabled and not broken.
    pub collide_connected: bool,
    /// False for a joint that does nothing until [`World::enable_joint`](crate::World::enable_joint); true by default.
    pub enabled: bool,
    /// The mean force over a step, N, above which the joint breaks; from 0. `None` by default: it never does.
    pub break_force: Option<S>,
    /// True if steps report when the joint breaks; false by default.
    pub events: bool,
    /// A key of your own: joints are listed and reported by it.
    pub key: u64,
    /// Data of your own, which the engine only keeps.
    pub user_data: u64,
}

/// The kind of a joint, with its values: the relation of its ends that it keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum JointKind<S = Fx> {
    /// Both ends stay at one point, around which the bodies turn: a hinge, a pin, an axle.
    Revolute(Revolute<S>),
    /// Both ends stay at one point and at one angle: the bodies are glued together.
    Weld(Weld<S>),
    /// The ends stay at a distance: a rigid rod without mass, with a hinge at each end.
    Distance(Distance<S>),
}

/// A revolute joint. [`Revolute::default`] turns freely.
///
/// Limits, motor, friction and spring act on [`JointRef::angle`](crate::JointRef::angle), the angle from the frame of the first end to the frame of
/// the second one. Where they are against each other the limits hold: a motor stops at a limit and presses against it with its torque.
///
/// ```
/// use umbra_physics::{BodyDef, JointDef, JointKind, JointLimits, JointMotor, Mass, Revolute, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
/// let gate = world.add_body(BodyDef { position: vec2(1, 0), mass, ..BodyDef::dynamic() })?;
/// let hinge = JointDef::at(&world, None, gate, vec2(0, 0))?;
/// // A gate that a motor opens by a quarter turn.
/// let kind = JointKind::Revolute(Revolute {
///     limits: Some(JointLimits::degrees(0, 90)),
///     motor: Some(JointMotor { speed: fx!(1), max_force: fx!(50) }),
///     ..Revolute::default()
/// });
/// let hinge = world.add_joint(JointDef { kind, ..hinge })?;
/// (0..60).for_each(|_| _ = world.step());
/// assert!((world.joint(hinge)?.angle() - fx!(1)).abs() < fx!(0.05));
/// (0..120).for_each(|_| _ = world.step());
/// assert!((world.body(gate)?.position() - vec2(0, 1)).length() < fx!(0.001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Revolute<S = Fx> {
    /// The lowest and the highest angle, rad. `None` by default: it turns on and on.
    pub limits: Option<JointLimits<S>>,
    /// A motor, with its speed in rad/s and its torque in N·m; `None` by default.
    pub motor: Option<JointMotor<S>>,
    /// A spring that turns the joint to an angle; `None` by default.
    pub spring: Option<JointSpring<S>>,
    /// The largest torque of friction in the joint, N·m, from 0; 0 by default. With a little of it ragdolls come to rest.
    pub friction: S,
}

/// A weld. [`Weld::default`] is rigid.
///
/// A row of welded bodies is solved exactly, and bends by no more than the joints of a chain give way. For bodies that never come apart one
/// body with several colliders costs less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Weld<S = Fx> {
    /// A spring in place of the rigid angle: the joint bends. Its position at rest is an angle like [`JointRef::angle`](crate::JointRef::angle).
    pub spring: Option<JointSpring<S>>,
}

/// The lowest and the highest position of a joint: an angle, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointLimits<S = Fx> {
    /// The lowest one, within ±2^17 rad.
    pub lower: S,
    /// The highest one, likewise; not below the lowest one. Limits with one position in between hold it.
    pub upper: S,
}

impl JointLimits {
    /// Limits in degrees. *Error* ½ ulp. *Domain* within 2^17 rad; [`World::add_joint`](crate::World::add_joint) refuses larger ones.
    #[must_use]
    pub fn degrees(lower: impl Into<Fx>, upper: impl Into<Fx>) -> Self {
        let [lower, upper] = [lower.into(), upper.into()].map(Fx::to_radians);
        Self { lower, upper }
    }
}

/// A motor: it aims at a speed with no more than a force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointMotor<S = Fx> {
    /// The speed of the second end against the first one: rad/s counter-clockwise. A brake has 0.
    pub speed: S,
    /// The largest torque, N·m, from 0.
    pub max_force: S,
}

/// A spring with a damper, which moves a joint to a position.
///
/// Period and decay are exact for the two bodies of the joint alone, up to a frequency of a twelfth of the rate of sub-steps; a faster spring
/// is damped more. It rests under a load where its stiffness says: m·(2πf)², or I·(2πf)² about the point of the joint.
///
/// ```
/// use umbra_physics::{JointSpring, fx};
///
/// let spring = JointSpring { rest: fx!(0.5), ..JointSpring::new(fx!(3), fx!(0.7)) };
/// assert_eq!((spring.hertz, spring.damping_ratio, spring.max_force), (fx!(3), fx!(0.7), None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointSpring<S = Fx> {
    /// The frequency without damping, Hz, from 0 to 10^6.
    pub hertz: S,
    /// The damping over critical damping, from 0 to 1024.
    pub damping_ratio: S,
    /// The position at rest: an angle, rad, within ±2^17.
    pub rest: S,
    /// The largest torque, N·m, from 0; `None` for no bound.
    pub max_force: Option<S>,
}

impl<S: Scalar> JointSpring<S> {
    /// A spring that rests at 0, without a bound of its force.
    #[must_use]
    pub const fn new(hertz: S, damping_ratio: S) -> Self {
        Self { hertz, damping_ratio, rest: S::ZERO, max_force: None }
    }
}

/// A distance joint.
///
/// ```
/// use umbra_physics::{Distance, JointKind, fx};
///
/// let rod: JointKind = JointKind::Distance(Distance::rod(fx!(2)));
/// # _ = rod;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Distance<S = Fx> {
    /// The distance of the two ends, m, from 2^-7 to 2^20.
    pub length: S,
}

impl<S> Distance<S> {
    /// A rigid rod of this length, m.
    #[must_use]
    pub const fn rod(length: S) -> Self {
        Self { length }
    }
}

impl<S: Scalar> Default for Distance<S> {
    /// A rigid rod of 1 m.
    fn default() -> Self {
        Self::rod(S::from_fx(Fx::ONE))
    }
}

impl<S: Scalar> Default for Revolute<S> {
    /// A joint that turns freely.
    fn default() -> Self {
        Self { limits: None, motor: None, spring: None, friction: S::ZERO }
    }
}

impl<S: Scalar> Default for JointKind<S> {
    /// A revolute joint that turns freely.
    fn default() -> Self {
        Self::Revolute(Revolute::default())
    }
}

codec_struct!(JointDef { ends, angles, kind, collide_connected, enabled, break_force, events, key, user_data });
codec_struct!(Revolute { limits, motor, spring, friction });
codec_struct!(Weld { spring });
codec_struct!(Distance { length });
codec_struct!(JointLimits { lower, upper });
codec_struct!(JointMotor { speed, max_force });
codec_struct!(JointSpring { hertz, damping_ratio, rest, max_force });
codec_enum!(JointKind<S>, "the number of a kind of joint", {
    0 => Revolute(revolute),
    1 => Distance(distance),
    2 => Weld(weld),
});

fn check(ok: bool, quantity: Quantity) -> Result<(), Error> {
    if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

/// Refuses a force that is negative or no number.
fn check_force<S: Scalar>(force: S) -> Result<(), Error> {
    check(force >= S::ZERO && force.is_finite(), Quantity::JointForce)
}

fn check_position<S: Scalar>(position: S) -> Result<(), Error> {
    let limit = S::from_fx(limits::JOINT_ANGLE);
    check(-limit <= position && position <= limit, Quantity::JointAngle)
}

impl<S: Scalar> JointLimits<S> {
    fn check(&self) -> Result<(), Error> {
        check_position(self.lower)?;
        check_position(self.upper)?;
        check(self.lower <= self.upper, Quantity::JointLimits)
    }
}

impl<S: Scalar> JointMotor<S> {
    fn check(&self) -> Result<(), Error> {
        let limit = S::from_fx(limits::ANGULAR_SPEED);
        check(-limit <= self.speed && self.speed <= limit, Quantity::MotorSpeed)?;
        check_force(self.max_force)
    }
}

impl<S: Scalar> JointSpring<S> {
    fn check(&self) -> Result<(), Error> {
        let is_within = |value: S, limit: i32| S::ZERO <= value && value <= S::from_fx(Fx::from(limit));
        check(is_within(self.hertz, 1_000_000), Quantity::SpringFrequency)?;
        check(is_within(self.damping_ratio, 1024), Quantity::DampingRatio)?;
        check_position(self.rest)?;
        self.max_force.map_or(Ok(()), check_force)
    }

    fn for_solver(&self) -> solve::AxisSpring {
        solve::AxisSpring {
            frequency: self.hertz.to_fx(),
            damping_ratio: self.damping_ratio.to_fx(),
            rest: self.rest.to_fx(),
            max_force: self.max_force.map_or(Fx::MAX, S::to_fx),
        }
    }
}

impl<S: Scalar> JointKind<S> {
    /// Refuses what [`World::set_joint_kind`](crate::World::set_joint_kind) would.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the quantity of the value that is out of range, such as [`Quantity::JointLimits`].
    ///
    /// ```
    /// use umbra_physics::{Error, JointKind, JointLimits, Quantity, Revolute};
    ///
    /// let kind = |limits| JointKind::Revolute(Revolute { limits: Some(limits), ..Revolute::default() });
    /// assert_eq!(kind(JointLimits::degrees(-45, 90)).check(), Ok(()));
    /// let error = Error::OutOfRange { quantity: Quantity::JointLimits };
    /// assert_eq!(kind(JointLimits::degrees(90, -45)).check(), Err(error));
    /// ```
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::Revolute(Revolute { limits, motor, spring, friction }) => {
                limits.as_ref().map_or(Ok(()), JointLimits::check)?;
                motor.as_ref().map_or(Ok(()), JointMotor::check)?;
                spring.as_ref().map_or(Ok(()), JointSpring::check)?;
                check_force(*friction)
            }
            Self::Weld(Weld { spring }) => spring.as_ref().map_or(Ok(()), JointSpring::check),
            Self::Distance(Distance { length }) => {
                let [min, max] = [limits::SIZE_MIN, limits::JOINT_LENGTH].map(S::from_fx);
                check(min <= *length && *length <= max, Quantity::JointLength)
            }
        }
    }

    /// The kind as the solver takes it.
    pub(crate) fn for_solver(&self) -> solve::JointKind {
        match self {
            Self::Revolute(_) | Self::Weld(_) => solve::JointKind::Revolute,
            Self::Distance(Distance { length }) => solve::JointKind::Distance { length: length.to_fx() },
        }
    }

    /// The axis as the solver takes it, at position 0; `None` if nothing acts on it.
    pub(crate) fn axis(&self) -> Option<solve::Axis> {
        match self {
            Self::Revolute(Revolute { limits, motor, spring, friction }) => {
                let motor = motor.filter(|motor| motor.max_force > S::ZERO);
                let axis = solve::Axis {
                    limits: limits.map(|limits| [limits.lower.to_fx(), limits.upper.to_fx()]),
                    motor_speed: motor.map_or(Fx::ZERO, |motor| motor.speed.to_fx()),
                    motor_force: motor.map_or(Fx::ZERO, |motor| motor.max_force.to_fx()),
                    friction: friction.to_fx(),
                    spring: spring.map(|spring| spring.for_solver()),
                    ..solve::Axis::default()
                };
                (axis != solve::Axis::default()).then_some(axis)
            }
            Self::Weld(Weld { spring }) => {
                let spring = spring.map(|spring| spring.for_solver());
                let limits = if spring.is_some() { None } else { Some([Fx::ZERO; 2]) };
                Some(solve::Axis { limits, spring, ..solve::Axis::default() })
            }
            Self::Distance(_) => None,
        }
    }

    /// Returns true if the state of the joint counts whole turns.
    pub(crate) fn counts_turns(&self) -> bool {
        match self {
            Self::Revolute(Revolute { limits, spring, .. }) => limits.is_some() || spring.is_some(),
            Self::Weld(_) => true,
            Self::Distance(_) => false,
        }
    }

    /// Returns true if a joint of another kind has the same rows, so that its impulses go on.
    pub(crate) fn has_rows_of(&self, kind: &Self) -> bool {
        self.for_solver().has_rows_of(kind.for_solver())
    }
}

/// Refuses a force at which a joint cannot break.
pub(crate) fn check_break_force<S: Scalar>(force: Option<S>) -> Result<(), Error> {
    check(force.is_none_or(|force| force >= S::ZERO && force.is_finite()), Quantity::BreakForce)
}

impl<S: Scalar> JointDef<S> {
    /// A joint of this kind between two ends, with frames along the axes of both.
    ///
    /// ```
    /// use umbra_physics::{Attachment, BodyDef, End, JointDef, JointKind, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let wheel = world.add_body(BodyDef::dynamic())?;
    /// let ends = [End::World(vec2(0, 0)), End::Body(Attachment::centre(wheel))];
    /// let axle = world.add_joint(JointDef::new(ends, JointKind::default()))?;
    /// assert_eq!(world.joint(axle)?.def().ends, ends);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn new(ends: [End<S>; 2], kind: JointKind<S>) -> Self {
        Self {
            ends,
            angles: [S::ZERO; 2],
            kind,
            collide_connected: false,
            enabled: true,
            break_force: None,
            events: false,
            key: 0,
            user_data: 0,
        }
    }

    /// Refuses a joint that a world cannot add.
    pub(crate) fn check(&self, bodies: &Bodies<S>) -> Result<(), Error> {
        self.check_values(bodies)?;
        let is_dynamic = |body: BodyId| bodies.find(body).is_ok_and(|i| bodies.info(i).kind == BodyKind::Dynamic);
        let any_dynamic = self.bodies().into_iter().flatten().any(is_dynamic);
        if any_dynamic { Ok(()) } else { Err(Error::NothingToMove) }
    }

    /// Refuses values out of range and unknown bodies. A joint that was added passes for as long as its bodies exist, also if they have
    /// changed.
    pub(crate) fn check_values(&self, bodies: &Bodies<S>) -> Result<(), Error> {
        for end in &self.ends {
            match end {
                End::World(point) => check(point.is_within(S::from_fx(limits::POSITION)), Quantity::Position)?,
                End::Body(attachment) => {
                    bodies.find(attachment.body)?;
                    check(attachment.point.is_within(S::from_fx(limits::SIZE_MAX)), Quantity::JointPoint)?;
                }
            }
        }
        if let [Some(first), Some(second)] = self.bodies() {
            if first == second {
                return Err(Error::SameBody { body: first });
            }
        }
        self.angles.iter().try_for_each(|&angle| check_angle(angle))?;
        self.kind.check()?;
        check_break_force(self.break_force)
    }

    /// The bodies at the ends.
    pub(crate) fn bodies(&self) -> [Option<BodyId>; 2] {
        [self.ends[0].body(), self.ends[1].body()]
    }

    /// Returns the joint with other bodies in place of the bodies that it names, as in another world; `None` where `map` gives none.
    pub(crate) fn map_bodies(&self, map: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let [first, second] = self.ends;
        Some(Self { ends: [first.map_body(&map)?, second.map_body(&map)?], ..*self })
    }
}
