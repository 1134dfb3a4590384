//! The parts of joints: limits, motors and springs, and all that acts along one row.

use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::kernel::sqrt::sqrt_round;
use crate::limits;
use crate::scalar::{Factor as _, FxFactor, Scalar};
use crate::solve;

/// The lowest and the highest position of a joint: an angle, rad, or a distance, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointLimits<S = Fx> {
    /// The lowest one, within ±2^17 rad or ±2^20 m.
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
    /// The speed of the second end against the first one: rad/s counter-clockwise, or m/s. A brake has 0.
    pub speed: S,
    /// The largest torque, N·m, or force, N, from 0.
    pub max_force: S,
}

/// A spring with a damper, which moves a joint to a position.
///
/// Period and decay are exact for the two bodies of the joint alone, up to a frequency of a twelfth of the rate of sub-steps; a faster spring
/// is damped more. It rests under a load where its stiffness says: m·(2πf)², or I·(2πf)² about the point of the joint. The mass m of two bodies
/// is the reduced one, 1/(1/m₁ + 1/m₂), where the spring does not turn them; [`JointDef::effective_mass`](crate::JointDef::effective_mass) has it, and
/// [`with_stiffness`](Self::with_stiffness) takes N/m and N·s/m.
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
    /// The position at rest: an angle, rad, within ±2^17, or a distance, m, within ±2^20.
    pub rest: S,
    /// The largest torque, N·m, or force, N, from 0; `None` for no bound.
    pub max_force: Option<S>,
}

impl<S: Scalar> JointSpring<S> {
    /// A spring that rests at 0, without a bound of its force.
    #[must_use]
    pub const fn new(hertz: S, damping_ratio: S) -> Self {
        Self { hertz, damping_ratio, rest: S::ZERO, max_force: None }
    }

    /// A spring with a stiffness k, N/m or N·m/rad, and a damper with the coefficient c, N·s/m or N·m·s/rad, between bodies of an effective mass
    /// m, kg or kg·m²: f = √(k/m)/2π and ζ = c/(2·√(k·m)). It rests at 0, without a bound of its force.
    ///
    /// [`JointDef::effective_mass`](crate::JointDef::effective_mass) has the mass of a joint. Steps keep f and ζ: where m changes with the pose, as about
    /// the pin between two bodies, k and c change with it. *Domain* k and c from 0, m above 0; c is 0 where k is, as a damper alone has no
    /// frequency. *Error* of both 0.51 ulp: of k 2^-32 Hz/f relative.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Stiffness`] or [`Quantity::Drag`] for a negative k or c; [`Quantity::SpringFrequency`] above 10^6 Hz or
    /// for no mass; [`Quantity::DampingRatio`] above 1024, or for a damper alone.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Distance, JointDef, JointKind, JointSpring, Mass, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() })?;
    /// let mass = Mass::Kilograms(fx!(8));
    /// let lamp = world.add_body(BodyDef { position: vec2(0, -1), mass, ..BodyDef::dynamic() })?;
    /// // A spring of 500 N/m with a damper of 40 N·s/m.
    /// let joint = JointDef::between(&world, None, vec2(0, 0), lamp, vec2(0, -1))?;
    /// let spring = JointSpring::with_stiffness(fx!(500), fx!(40), joint.effective_mass(&world)?)?;
    /// let spring = Some(JointSpring { rest: fx!(1), ..spring });
    /// let kind = JointKind::Distance(Distance { spring, ..Distance::default() });
    /// world.add_joint(JointDef { kind, ..joint })?;
    /// (0..600).for_each(|_| _ = world.step());
    /// // 80 N stretch it by 0.16 m.
    /// assert!((world.body(lamp)?.position() + vec2(0, fx!(1.16))).length() < fx!(0.0001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn with_stiffness(stiffness: S, damping: S, mass: S::Factor) -> Result<Self, Error> {
        let is_fair = |value: S| value >= S::ZERO && value.is_finite();
        check(is_fair(stiffness), Quantity::Stiffness)?;
        check(is_fair(damping), Quantity::Drag)?;
        check(!mass.is_zero(), Quantity::SpringFrequency)?;
        let [stiffness, damping] = [stiffness, damping].map(|value| S::Factor::from_scalar(value).to_fx_factor());
        let mass = mass.to_fx_factor();
        let turn = FxFactor::PI.times(2.into());
        let hertz = root(stiffness.over(mass).over(turn.times(turn)), Quantity::SpringFrequency)?;
        let damping_ratio = if damping.is_zero() {
            Fx::ZERO
        } else {
            check(!stiffness.is_zero(), Quantity::DampingRatio)?;
            let critical = stiffness.times(mass).times(4.into());
            root(damping.times(damping).over(critical), Quantity::DampingRatio)?
        };
        let spring = Self::new(S::from_fx(hertz), S::from_fx(damping_ratio));
        // A position of 0 is one in each unit.
        spring.check(Unit::Metres)?;
        Ok(spring)
    }
}

/// The square root, or the quantity that is out of range from 2^22 on. *Error* 0.501 ulp, and half of the relative error of the square.
fn root(square: FxFactor, quantity: Quantity) -> Result<Fx, Error> {
    // The root is in 2^-42.
    let square = square.to_fixed(84).ok_or(Error::OutOfRange { quantity })?;
    Ok(Fx::from_bits(((sqrt_round(square) + (1 << 9)) >> 10) as i64))
}

codec_struct!(JointLimits { lower, upper });
codec_struct!(JointMotor { speed, max_force });
codec_struct!(JointSpring { hertz, damping_ratio, rest, max_force });

/// The unit of the positions of a joint.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Radians,
    Metres,
}

/// The parts of a joint that act along one row.
#[derive(Clone, Copy)]
pub(super) struct Parts<S> {
    pub(super) limits: Option<JointLimits<S>>,
    pub(super) motor: Option<JointMotor<S>>,
    pub(super) spring: Option<JointSpring<S>>,
    pub(super) friction: S,
}

pub(super) fn check(ok: bool, quantity: Quantity) -> Result<(), Error> {
    if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

/// Refuses a force that is negative or no number.
fn check_force<S: Scalar>(force: S) -> Result<(), Error> {
    check(force >= S::ZERO && force.is_finite(), Quantity::JointForce)
}

fn check_position<S: Scalar>(position: S, unit: Unit) -> Result<(), Error> {
    let (limit, quantity) = match unit {
        Unit::Radians => (limits::JOINT_ANGLE, Quantity::JointAngle),
        Unit::Metres => (limits::JOINT_LENGTH, Quantity::JointLength),
    };
    let limit = S::from_fx(limit);
    check(-limit <= position && position <= limit, quantity)
}

impl<S: Scalar> JointLimits<S> {
    fn check(&self, unit: Unit) -> Result<(), Error> {
        check_position(self.lower, unit)?;
        check_position(self.upper, unit)?;
        check(self.lower <= self.upper, Quantity::JointLimits)
    }
}

impl<S: Scalar> JointMotor<S> {
    fn check(&self, unit: Unit) -> Result<(), Error> {
        let limit = S::from_fx(if unit == Unit::Radians { limits::ANGULAR_SPEED } else { limits::SPEED });
        check(-limit <= self.speed && self.speed <= limit, Quantity::MotorSpeed)?;
        check_force(self.max_force)
    }
}

impl<S: Scalar> JointSpring<S> {
    fn check(&self, unit: Unit) -> Result<(), Error> {
        let is_within = |value: S, limit: i32| S::ZERO <= value && value <= S::from_fx(Fx::from(limit));
        check(is_within(self.hertz, 1_000_000), Quantity::SpringFrequency)?;
        check(is_within(self.damping_ratio, 1024), Quantity::DampingRatio)?;
        check_position(self.rest, unit)?;
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

impl<S: Scalar> Parts<S> {
    pub(super) const NONE: Self = Self { limits: None, motor: None, spring: None, friction: S::ZERO };

    /// Limits that hold one position: 0.
    pub(super) const LOCKED: Self = Self { limits: Some(JointLimits { lower: S::ZERO, upper: S::ZERO }), ..Self::NONE };

    /// Refuses values out of range.
    pub(super) fn check(&self, unit: Unit) -> Result<(), Error> {
        let Self { limits, motor, spring, friction } = self;
        limits.as_ref().map_or(Ok(()), |limits| limits.check(unit))?;
        motor.as_ref().map_or(Ok(()), |motor| motor.check(unit))?;
        spring.as_ref().map_or(Ok(()), |spring| spring.check(unit))?;
        check_force(*friction)
    }

    /// The law of the row as the solver takes it, at position 0; `None` if nothing acts along the row.
    pub(super) fn law(&self) -> Option<solve::Axis> {
        let motor = self.motor.filter(|motor| motor.max_force > S::ZERO);
        let axis = solve::Axis {
            limits: self.limits.map(|limits| [limits.lower.to_fx(), limits.upper.to_fx()]),
            motor_speed: motor.map_or(Fx::ZERO, |motor| motor.speed.to_fx()),
            motor_force: motor.map_or(Fx::ZERO, |motor| motor.max_force.to_fx()),
            friction: self.friction.to_fx(),
            spring: self.spring.map(|spring| spring.for_solver()),
            ..solve::Axis::default()
        };
        (axis != solve::Axis::default()).then_some(axis)
    }
}
