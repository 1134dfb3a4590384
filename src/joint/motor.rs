//! Motor joints.

use super::parts::{JointMotor, JointSpring, Parts};
use crate::codec::codec_struct;
use crate::error::Error;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// A motor joint. [`Motor::default`] does nothing.
///
/// Forces with bounds move the second end in the frame of the first end, and turn it: a body that a mouse drags, a platform that follows
/// a path, the friction of a world that is seen from above. The place of the second end is
/// [`JointRef::offset`](crate::JointRef::offset), its turn [`JointRef::angle`](crate::JointRef::angle). The bound of a force holds for its length, in any direction.
///
/// ```
/// use umbra_physics::{BodyDef, End, Attachment, JointDef, JointKind, Mass, Motor, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
/// let crate_ = world.add_body(BodyDef { mass, ..BodyDef::dynamic() })?;
/// // A mouse grabs the body at a point; the first end is the origin of the world, so targets are points of the world.
/// let ends = [End::World(vec2(0, 0)), End::Body(Attachment { body: crate_, point: vec2(0, fx!(0.5)) })];
/// let grab = |mouse| JointKind::Motor(Motor::target(mouse, fx!(5), fx!(1), fx!(400)));
/// let mouse = world.add_joint(JointDef::new(ends, grab(vec2(0, fx!(0.5)))))?;
/// // In each tick the target goes to where the mouse is.
/// for tick in 1..=120 {
///     world.set_joint_kind(mouse, grab(vec2(fx!(0.025) * tick.min(80), 1)))?;
///     world.step();
/// }
/// let handle = world.joint(mouse)?.points()[1];
/// // The weight of the body stretches the spring by a centimetre.
/// assert!((handle - vec2(2, 1)).length() < fx!(0.03));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias("MotorJoint", "MouseJoint"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Motor<S = Fx> {
    /// A spring that pulls the second end to a point; `None` by default.
    pub spring: Option<PlanarSpring<S>>,
    /// A motor that moves the second end with a velocity; `None` by default.
    pub motor: Option<PlanarMotor<S>>,
    /// A spring that turns the joint to an angle; `None` by default.
    pub angular_spring: Option<JointSpring<S>>,
    /// A motor that turns the joint, with its speed in rad/s and its torque in N·m; `None` by default.
    pub angular_motor: Option<JointMotor<S>>,
}

/// A spring with a damper in the plane: it pulls the second end of a [motor joint](Motor) to a point in the frame of the first end.
///
/// Period and decay are exact for a body that is held at its centre of mass. A body that is held at the distance r from its centre of mass has
/// them across r: the stiffness is μ·(2πf)² in all directions, for 1/μ = 1/m₁ + 1/m₂ + r₁²/I₁ + r₂²/I₂ with both distances of the second end.
///
/// ```
/// use umbra_physics::{PlanarSpring, fx, vec2};
///
/// let spring = PlanarSpring { max_force: Some(fx!(100)), ..PlanarSpring::new(vec2(1, 2), fx!(3), fx!(0.7)) };
/// assert_eq!((spring.rest, spring.hertz, spring.damping_ratio), (vec2(1, 2), fx!(3), fx!(0.7)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PlanarSpring<S = Fx> {
    /// The frequency without damping, Hz, from 0 to 10^6.
    pub hertz: S,
    /// The damping over critical damping, from 0 to 1024.
    pub damping_ratio: S,
    /// The point at rest in the frame of the first end, m; coordinates within ±2^20.
    pub rest: Vec2<S>,
    /// The largest force, N, from 0; `None` for no bound.
    pub max_force: Option<S>,
}

/// A motor in the plane: it moves the second end of a [motor joint](Motor) in the frame of the first end, with no more than a force.
///
/// ```
/// use umbra_physics::{PlanarMotor, fx, vec2};
///
/// // Friction of a disc of 2 kg on ice that is seen from above: 0.1 of its weight.
/// let friction = PlanarMotor { velocity: vec2(0, 0), max_force: fx!(2) };
/// assert_eq!(friction.velocity, vec2(0, 0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PlanarMotor<S = Fx> {
    /// The velocity of the second end in the frame of the first end, m/s.
    pub velocity: Vec2<S>,
    /// The largest force, N, from 0.
    pub max_force: S,
}

codec_struct!(PlanarSpring { hertz, damping_ratio, rest, max_force });
codec_struct!(PlanarMotor { velocity, max_force });
codec_struct!(Motor { spring, motor, angular_spring, angular_motor });

impl<S: Scalar> PlanarSpring<S> {
    /// A spring that pulls to a point, without a bound of its force.
    #[must_use]
    pub const fn new(rest: Vec2<S>, hertz: S, damping_ratio: S) -> Self {
        Self { hertz, damping_ratio, rest, max_force: None }
    }

    /// A spring that pulls to a point, with a stiffness, N/m, and a damper, N·s/m, as [`JointSpring::with_stiffness`]: for the
    /// [effective mass](crate::JointDef::effective_mass) μ, kg.
    ///
    /// # Errors
    /// As [`JointSpring::with_stiffness`].
    ///
    /// ```
    /// use umbra_physics::{PlanarSpring, fx, vec2};
    ///
    /// let spring = PlanarSpring::with_stiffness(vec2(1, 2), fx!(400), fx!(40), 4.into())?;
    /// assert_eq!((spring.rest, spring.hertz, spring.damping_ratio), (vec2(1, 2), fx!(1.59154943092), fx!(0.5)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn with_stiffness(rest: Vec2<S>, stiffness: S, damping: S, mass: S::Factor) -> Result<Self, Error> {
        let JointSpring { hertz, damping_ratio, .. } = JointSpring::with_stiffness(stiffness, damping, mass)?;
        Ok(Self::new(rest, hertz, damping_ratio))
    }
}

impl<S: Scalar> Motor<S> {
    /// A spring that pulls the second end to a point in the frame of the first end, m, with no more than a force, N, and lets it turn: a mouse, a
    /// hook, a magnet.
    #[must_use]
    pub const fn target(point: Vec2<S>, hertz: S, damping_ratio: S, max_force: S) -> Self {
        let spring = PlanarSpring { max_force: Some(max_force), ..PlanarSpring::new(point, hertz, damping_ratio) };
        Self { spring: Some(spring), motor: None, angular_spring: None, angular_motor: None }
    }

    /// Friction against the first end, with the largest force, N, and torque, N·m: of a body that slides on a ground which is seen from above.
    /// It is solved with contacts and other joints, so that it holds against them, and leaves up to 10^-6 m/s until the body falls asleep.
    /// [`FieldKind::Friction`](crate::FieldKind::Friction) needs no joint and stops bodies to the bit.
    ///
    /// ```
    /// use umbra_physics::{Attachment, BodyDef, End, JointDef, JointKind, Mass, Motor, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
    /// let puck = world.add_body(BodyDef { velocity: vec2(3, 4), mass, ..BodyDef::dynamic() })?;
    /// let ends = [End::World(vec2(0, 0)), End::Body(Attachment::centre(puck))];
    /// world.add_joint(JointDef::new(ends, JointKind::Motor(Motor::friction(fx!(10), fx!(1)))))?;
    /// (0..120).for_each(|_| _ = world.step());
    /// // It stops after v²/2a = 2.5 m, in the direction that it had.
    /// assert!((world.body(puck)?.position() - vec2(fx!(1.5), 2)).length() < fx!(0.01));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub const fn friction(max_force: S, max_torque: S) -> Self {
        let velocity = Vec2 { x: S::ZERO, y: S::ZERO };
        Self {
            spring: None,
            motor: Some(PlanarMotor { velocity, max_force }),
            angular_spring: None,
            angular_motor: Some(JointMotor { speed: S::ZERO, max_force: max_torque }),
        }
    }

    /// The parts along the axes of the frame of the first end. Their forces are bounds of vectors.
    pub(super) fn planar(&self) -> [Parts<S>; 2] {
        let parts = |coordinate: fn(Vec2<S>) -> S| Parts {
            motor: self.motor.map(|motor| JointMotor { speed: coordinate(motor.velocity), max_force: motor.max_force }),
            spring: self.spring.map(|PlanarSpring { hertz, damping_ratio, rest, max_force }| JointSpring {
                hertz,
                damping_ratio,
                rest: coordinate(rest),
                max_force,
            }),
            ..Parts::NONE
        };
        [parts(|v| v.x), parts(|v| v.y)]
    }

    /// The parts that act on the angle.
    pub(super) fn around(&self) -> Parts<S> {
        Parts { motor: self.angular_motor, spring: self.angular_spring, ..Parts::NONE }
    }
}

impl<S: Scalar> Default for Motor<S> {
    /// A joint that does nothing.
    fn default() -> Self {
        Self { spring: None, motor: None, angular_spring: None, angular_motor: None }
    }
}
