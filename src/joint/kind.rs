//! The kinds of joints.

use super::gear::{Gear, check_teeth};
use super::motor::Motor;
use super::parts::{JointLimits, JointMotor, JointSpring, Parts, Unit, check};
use super::pulley::Pulley;
use crate::codec::{codec_enum, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::scalar::{Scalar, Turn};
use crate::solve;

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
    /// The ends stay at a distance, or within limits of it: a rod, a rope, or a spring, with a hinge at each end.
    Distance(Distance<S>),
    /// The second end slides along an axis of the first one, and the bodies do not turn against each other: a lift, a piston, a drawer.
    Prismatic(Prismatic<S>),
    /// The second end slides along an axis of the first one on a spring, and turns freely: a wheel with its suspension.
    Wheel(Wheel<S>),
    /// The second end is moved in the frame of the first one by forces with bounds: a body that a mouse drags, friction of a ground seen from above.
    Motor(Motor<S>),
    /// The bodies turn at a ratio: two gears, a chain, a belt.
    Gear(Gear),
    /// A rope over two points of the world: what one end gives, the other one takes.
    Pulley(Pulley<S>),
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
#[doc(alias("hinge", "RevoluteJoint"))]
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
    /// The teeth of a ratchet, from 1 to [`limits::TEETH`] = 1,024: the angle grows freely, and falls back to the last tooth at most, as of a
    /// winch or a socket wrench. With a negative number it is the other way round. Teeth are at whole parts of a turn from angle 0; a step in which one is passed
    /// engages it ([`JointRef::stop`](crate::JointRef::stop)). `None` by default.
    pub ratchet: Option<i16>,
}

/// A weld. [`Weld::default`] is rigid.
///
/// A row of welded bodies is solved exactly, and bends by no more than the joints of a chain give way. For bodies that never come apart one
/// body with several colliders costs less.
#[doc(alias("FixedJoint", "WeldJoint"))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Weld<S = Fx> {
    /// A spring in place of the rigid angle: the joint bends. Its position at rest is an angle like [`JointRef::angle`](crate::JointRef::angle).
    pub spring: Option<JointSpring<S>>,
}

/// A distance joint. [`Distance::default`] does nothing.
///
/// All act on [`JointRef::length`](crate::JointRef::length), the distance of the two ends. Limits that are the same make a rigid rod, limits from
/// 0 a rope, and a spring alone is a spring with both ends on hinges.
///
/// ```
/// use umbra_physics::{BodyDef, Distance, JointDef, JointKind, JointLimits, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let bucket = world.add_body(BodyDef { position: vec2(0, -1), ..BodyDef::dynamic() })?;
/// let rope = JointDef::between(&world, None, vec2(0, 0), bucket, vec2(0, -1))?;
/// let rope = JointDef { kind: JointKind::Distance(Distance::rope(fx!(4))), ..rope };
/// let rope = world.add_joint(rope)?;
/// (0..300).for_each(|_| _ = world.step());
/// let rope = world.joint(rope)?;
/// assert!((rope.length() - fx!(4)).abs() < fx!(0.001));
/// assert!((rope.force() - vec2(0, 10)).length() < fx!(0.01));
///
/// let rod: Distance = Distance::rod(fx!(2));
/// assert_eq!(rod.limits, Some(JointLimits { lower: fx!(2), upper: fx!(2) }));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias("DistanceJoint", "RopeJoint", "SpringJoint"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Distance<S = Fx> {
    /// The shortest and the longest distance, m, from 0; the longest one from 2^-7. `None` by default.
    pub limits: Option<JointLimits<S>>,
    /// A motor that pushes the ends apart at a speed in m/s, or pulls them together, with its force in N; `None` by default.
    pub motor: Option<JointMotor<S>>,
    /// A spring, with its length at rest from 0; `None` by default.
    pub spring: Option<JointSpring<S>>,
    /// The largest force of friction along the line, N, from 0; 0 by default.
    pub friction: S,
}

impl<S: Scalar> Distance<S> {
    /// A rigid rod of this length, m, from 2^-7 to 2^20.
    #[must_use]
    pub const fn rod(length: S) -> Self {
        Self::within(length, length)
    }

    /// A rope of this length, m, from 2^-7 to 2^20: the ends are no farther apart.
    #[must_use]
    pub const fn rope(length: S) -> Self {
        Self::within(S::ZERO, length)
    }

    /// A spring that rests at this length, m, with a frequency in Hz and its damping over critical damping.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Distance, JointDef, JointKind, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let lamp = world.add_body(BodyDef { position: vec2(0, -1), ..BodyDef::dynamic() })?;
    /// let spring = JointDef::between(&world, None, vec2(0, 0), lamp, vec2(0, -1))?;
    /// let kind = JointKind::Distance(Distance::spring(fx!(1), fx!(2), fx!(0.7)));
    /// world.add_joint(JointDef { kind, ..spring })?;
    /// (0..600).for_each(|_| _ = world.step());
    /// // It hangs lower by g/(2πf)².
    /// assert!((world.body(lamp)?.position() + vec2(0, fx!(1.06333))).length() < fx!(0.0001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub const fn spring(rest: S, hertz: S, damping_ratio: S) -> Self {
        let spring = JointSpring { hertz, damping_ratio, rest, max_force: None };
        Self { limits: None, motor: None, spring: Some(spring), friction: S::ZERO }
    }

    const fn within(lower: S, upper: S) -> Self {
        Self { limits: Some(JointLimits { lower, upper }), motor: None, spring: None, friction: S::ZERO }
    }

    /// The length of a rigid rod; `None` if the distance may change.
    fn rigid(&self) -> Option<S> {
        self.limits.filter(|limits| limits.lower == limits.upper).map(|limits| limits.lower)
    }
}

/// A prismatic joint. [`Prismatic::default`] slides freely.
///
/// The axis is the x axis of the frame of the first end, [`JointDef::along`](crate::JointDef::along) sets it. Limits, motor, friction and spring act on
/// [`JointRef::translation`](crate::JointRef::translation), the way of the second end along it; the angle of the joint stays 0.
///
/// ```
/// use umbra_physics::{BodyDef, JointDef, JointKind, JointLimits, JointMotor, Mass, Prismatic, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let mass = Mass::Explicit { mass: fx!(200), inertia: fx!(50) };
/// let cabin = world.add_body(BodyDef { mass, ..BodyDef::dynamic() })?;
/// // A lift: its motor bears the cabin, and takes it up to the upper limit.
/// let shaft = JointDef::along(&world, None, cabin, vec2(0, 0), vec2(0, 1))?;
/// let kind = JointKind::Prismatic(Prismatic {
///     limits: Some(JointLimits { lower: fx!(0), upper: fx!(3) }),
///     motor: Some(JointMotor { speed: fx!(1), max_force: fx!(3_000) }),
///     ..Prismatic::default()
/// });
/// let lift = world.add_joint(JointDef { kind, ..shaft })?;
/// (0..120).for_each(|_| _ = world.step());
/// // The fifth of a second in which it speeds up costs a tenth of a metre.
/// assert!((world.joint(lift)?.translation() - fx!(1.9)).abs() < fx!(0.02));
/// (0..120).for_each(|_| _ = world.step());
/// assert!((world.body(cabin)?.position() - vec2(0, 3)).length() < fx!(0.001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias("slider", "PrismaticJoint"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Prismatic<S = Fx> {
    /// The lowest and the highest way, m. `None` by default.
    pub limits: Option<JointLimits<S>>,
    /// A motor, with its speed in m/s and its force in N; `None` by default.
    pub motor: Option<JointMotor<S>>,
    /// A spring that moves the joint to a position; `None` by default.
    pub spring: Option<JointSpring<S>>,
    /// The largest force of friction along the axis, N, from 0; 0 by default.
    pub friction: S,
}

/// A wheel joint. [`Wheel::default`] slides and turns freely.
///
/// The axis of the suspension is the x axis of the frame of the first end, on the car; [`JointDef::along`](crate::JointDef::along) sets it. Limits and spring act on
/// [`JointRef::translation`](crate::JointRef::translation), the way of the second end along it, motor and friction on its turn.
///
/// ```
/// use umbra_physics::{
///     BodyDef, JointDef, JointKind, JointMotor, JointSpring, Shape, Wheel, World, WorldDef, fx, vec2,
/// };
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let road = BodyDef::fixed().with_collider(Shape::rectangle(100, 1)?);
/// world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..road })?;
/// let body = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(2.5), fx!(0.5))?);
/// let car = world.add_body(BodyDef { position: vec2(0, 1), ..body })?;
/// let disc = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.4))?);
/// for x in [-1, 1] {
///     let hub = vec2(x, fx!(0.4));
///     let wheel = world.add_body(BodyDef { position: hub, ..disc.clone() })?;
///     let axle = JointDef::along(&world, car, wheel, hub, vec2(0, 1))?;
///     let kind = JointKind::Wheel(Wheel {
///         spring: Some(JointSpring::new(fx!(4), fx!(0.7))),
///         motor: Some(JointMotor { speed: fx!(-10), max_force: fx!(5) }),
///         ..Wheel::default()
///     });
///     world.add_joint(JointDef { kind, ..axle })?;
/// }
/// (0..300).for_each(|_| _ = world.step());
/// // 10 rad/s of a wheel of 0.4 m.
/// assert!((world.body(car)?.velocity() - vec2(4, 0)).length() < fx!(0.05));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias("WheelJoint", "suspension"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Wheel<S = Fx> {
    /// The lowest and the highest way along the axis, m. `None` by default.
    pub limits: Option<JointLimits<S>>,
    /// The spring of the suspension; `None` by default.
    pub spring: Option<JointSpring<S>>,
    /// A motor that turns the second end, with its speed in rad/s and its torque in N·m; `None` by default.
    pub motor: Option<JointMotor<S>>,
    /// The largest torque of friction in the axle, N·m, from 0; 0 by default.
    pub friction: S,
}

impl<S: Scalar> Default for Distance<S> {
    /// A joint that does nothing.
    fn default() -> Self {
        Self { limits: None, motor: None, spring: None, friction: S::ZERO }
    }
}

impl<S: Scalar> Default for Prismatic<S> {
    /// A joint that slides freely.
    fn default() -> Self {
        Self { limits: None, motor: None, spring: None, friction: S::ZERO }
    }
}

impl<S: Scalar> Default for Wheel<S> {
    /// A joint that slides and turns freely.
    fn default() -> Self {
        Self { limits: None, spring: None, motor: None, friction: S::ZERO }
    }
}

impl<S: Scalar> Default for Revolute<S> {
    /// A joint that turns freely.
    fn default() -> Self {
        Self { limits: None, motor: None, spring: None, friction: S::ZERO, ratchet: None }
    }
}

impl<S: Scalar> Default for JointKind<S> {
    /// A revolute joint that turns freely.
    fn default() -> Self {
        Self::Revolute(Revolute::default())
    }
}

codec_struct!(Revolute { limits, motor, spring, friction, ratchet });
codec_struct!(Weld { spring });
codec_struct!(Distance { limits, motor, spring, friction });
codec_struct!(Prismatic { limits, motor, spring, friction });
codec_struct!(Wheel { limits, spring, motor, friction });
codec_enum!(JointKind<S>, "the number of a kind of joint", {
    0 => Revolute(revolute),
    1 => Distance(distance),
    2 => Weld(weld),
    3 => Prismatic(prismatic),
    4 => Wheel(wheel),
    5 => Motor(motor),
    6 => Gear(gear),
    7 => Pulley(pulley),
});

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
        self.along().check(Unit::Metres)?;
        self.across().check(Unit::Metres)?;
        self.around().check(Unit::Radians)?;
        if let Some(teeth) = self.ratchet() {
            check_teeth(teeth)?;
        }
        match self {
            Self::Gear(gear) => return gear.check(),
            Self::Pulley(pulley) => return pulley.check(),
            _ => {}
        }
        let Self::Distance(Distance { limits, spring, .. }) = self else { return Ok(()) };
        let is_length = |length: S| length >= S::ZERO;
        let shortest = S::from_fx(limits::SIZE_MIN);
        check(limits.is_none_or(|limits| is_length(limits.lower) && limits.upper >= shortest), Quantity::JointLength)?;
        check(spring.is_none_or(|spring| is_length(spring.rest)), Quantity::JointLength)
    }

    /// The parts along the axis or the line of the joint.
    fn along(&self) -> Parts<S> {
        match *self {
            Self::Distance(Distance { limits, motor, spring, friction })
            | Self::Prismatic(Prismatic { limits, motor, spring, friction }) => {
                Parts { limits, motor, spring, friction }
            }
            Self::Wheel(Wheel { limits, spring, .. }) => Parts { limits, spring, ..Parts::NONE },
            Self::Motor(motor) => motor.planar()[0],
            Self::Revolute(_) | Self::Weld(_) | Self::Gear(_) | Self::Pulley(_) => Parts::NONE,
        }
    }

    /// The parts across the axis of the joint.
    fn across(&self) -> Parts<S> {
        if let Self::Motor(motor) = self { motor.planar()[1] } else { Parts::NONE }
    }

    /// The parts that act on the angle of the joint.
    fn around(&self) -> Parts<S> {
        match *self {
            Self::Revolute(Revolute { limits, motor, spring, friction, .. }) => {
                Parts { limits, motor, spring, friction }
            }
            Self::Weld(Weld { spring: Some(spring) }) => Parts { spring: Some(spring), ..Parts::NONE },
            Self::Weld(Weld { spring: None }) | Self::Prismatic(_) | Self::Gear(_) => Parts::LOCKED,
            Self::Wheel(Wheel { motor, friction, .. }) => Parts { motor, friction, ..Parts::NONE },
            Self::Motor(motor) => motor.around(),
            Self::Distance(_) | Self::Pulley(_) => Parts::NONE,
        }
    }

    /// The kind with another motor; `None` for a kind that has none.
    pub(crate) fn with_motor(self, motor: Option<JointMotor<S>>) -> Option<Self> {
        Some(match self {
            Self::Revolute(revolute) => Self::Revolute(Revolute { motor, ..revolute }),
            Self::Distance(distance) => Self::Distance(Distance { motor, ..distance }),
            Self::Prismatic(prismatic) => Self::Prismatic(Prismatic { motor, ..prismatic }),
            Self::Wheel(wheel) => Self::Wheel(Wheel { motor, ..wheel }),
            Self::Motor(joint) => Self::Motor(Motor { angular_motor: motor, ..joint }),
            Self::Weld(_) | Self::Gear(_) | Self::Pulley(_) => return None,
        })
    }

    /// Returns true for a kind whose motor turns the ends.
    pub(crate) fn motor_turns(&self) -> bool {
        matches!(self, Self::Revolute(_) | Self::Wheel(_) | Self::Motor(_))
    }

    /// Returns true for a kind whose second end moves along axes of the frame of the first end.
    pub(crate) fn has_frame(&self) -> bool {
        matches!(self, Self::Prismatic(_) | Self::Wheel(_) | Self::Motor(_))
    }

    /// The kind as the solver takes it, for the angle of the frame of the first end.
    pub(crate) fn for_solver(&self, angle: Turn) -> solve::JointKind {
        match self {
            Self::Revolute(_) | Self::Weld(_) => solve::JointKind::Revolute,
            Self::Distance(distance) => match distance.rigid() {
                Some(length) => solve::JointKind::Distance { length: length.to_fx() },
                None => solve::JointKind::Line,
            },
            Self::Prismatic(_) | Self::Wheel(_) => solve::JointKind::Slider { angle },
            Self::Motor(_) => solve::JointKind::Planar { angle },
            Self::Gear(Gear { teeth }) => solve::JointKind::Gear { teeth: *teeth },
            Self::Pulley(pulley) => pulley.for_solver(),
        }
    }

    /// The teeth of a ratchet.
    pub(crate) fn ratchet(&self) -> Option<i16> {
        if let Self::Revolute(Revolute { ratchet, .. }) = self { *ratchet } else { None }
    }

    /// The law of the angle as the solver takes it, at position 0; `None` if nothing acts on it. The limits of a ratchet are without its tooth.
    pub(crate) fn axis(&self) -> Option<solve::Axis> {
        let law = self.around().law();
        if self.ratchet().is_none() {
            return law;
        }
        let law = law.unwrap_or_default();
        Some(solve::Axis { limits: law.limits.or(Some([-limits::JOINT_ANGLE, limits::JOINT_ANGLE])), ..law })
    }

    /// The laws of the ways along the axis or the line and across the axis, likewise. A rigid rod has none.
    pub(crate) fn slides(&self) -> [Option<solve::Axis>; 2] {
        match self {
            Self::Distance(distance) if distance.rigid().is_some() => [None; 2],
            Self::Pulley(pulley) => [Some(pulley.law()), None],
            _ => [self.along().law(), self.across().law()],
        }
    }

    /// True for the rows along the axes and around that may have impulses.
    pub(crate) fn active_rows(&self) -> [bool; 3] {
        let [along, across] = self.slides().map(|law| law.is_some());
        let around = self.axis().is_some();
        match self {
            Self::Revolute(_) | Self::Weld(_) => [true, true, around],
            Self::Distance(_) | Self::Pulley(_) => [true, false, false],
            Self::Prismatic(_) | Self::Wheel(_) => [along, true, around],
            Self::Motor(_) => [along, across, around],
            Self::Gear(_) => [false, false, true],
        }
    }

    /// Returns true if the state of the joint counts whole turns.
    pub(crate) fn counts_turns(&self) -> bool {
        match self {
            Self::Revolute(Revolute { limits, spring, ratchet, .. }) => {
                limits.is_some() || spring.is_some() || ratchet.is_some()
            }
            Self::Weld(_) | Self::Prismatic(_) => true,
            Self::Motor(motor) => motor.angular_spring.is_some(),
            Self::Distance(_) | Self::Wheel(_) | Self::Gear(_) | Self::Pulley(_) => false,
        }
    }

    /// Returns true if a joint of another kind has the same rows, so that its impulses go on.
    pub(crate) fn has_rows_of(&self, kind: &Self) -> bool {
        let [first, second] = [self, kind].map(|kind| kind.for_solver(Turn::default()));
        first.has_rows_of(second)
    }
}
