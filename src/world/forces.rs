//! Applying forces and impulses.

use super::{Command, World};
use crate::body::{Activity, BodyKind, Change};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_enum};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Offset, Scalar, Wide};
use crate::slots::BodyId;

/// The frame of reference of vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Frame {
    /// The axes and the origin of the world.
    #[default]
    World,
    /// The axes of the body, which turn with it, from its centre of mass.
    Body,
}

/// Options of a force or impulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ApplyOptions {
    /// The frame of the vectors and the point.
    pub frame: Frame,
    /// True if the body is woken. Without it, the call has no effect on a sleeping body.
    pub wake: bool,
}

impl ApplyOptions {
    /// Vectors in the body's frame; the body is woken.
    pub const BODY: Self = Self { frame: Frame::Body, wake: true };
}

impl Default for ApplyOptions {
    /// Vectors in the world's frame; the body is woken.
    fn default() -> Self {
        Self { frame: Frame::World, wake: true }
    }
}

/// A force, torque or impulse on a body. Forces and torques add up and act over the next step; impulses act at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum ForceOrImpulse<S = Fx> {
    /// A force in N, at a point or through the centre of mass.
    Force {
        /// The force.
        force: Vec2<S>,
        /// The point where it acts, m.
        point: Option<Vec2<S>>,
    },
    /// A torque in N·m.
    Torque(S),
    /// An impulse in N·s, at a point or through the centre of mass.
    Impulse {
        /// The impulse.
        impulse: Vec2<S>,
        /// The point where it acts, m.
        point: Option<Vec2<S>>,
    },
    /// An angular impulse in N·m·s.
    AngularImpulse(S),
}

/// The effect of a force or impulse on the body it was computed for.
pub(super) enum Effect<S: Scalar> {
    /// An addition to the forces of the next step, in the world's frame.
    ForceTorque { force: Vec2<S::Wide>, torque: S::Wide },
    /// New velocities.
    Strike { velocity: Vec2<S::Accumulator>, angular_velocity: S::Accumulator },
}

codec_enum!(Frame, "0 or 1 for a frame", { 0 => World, 1 => Body });
codec_enum!(ForceOrImpulse<S>, "the number of an action", {
    0 => Force { force, point },
    1 => Torque(torque),
    2 => Impulse { impulse, point },
    3 => AngularImpulse(impulse),
});

impl Write for ApplyOptions {
    fn write(&self, out: &mut impl Encoder) {
        let Self { frame, wake } = self;
        codec::field(out, "frame", frame);
        codec::field(out, "wake", wake);
    }
}

impl Read for ApplyOptions {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { frame: Frame::read(reader)?, wake: bool::read(reader)? })
    }
}

const fn out_of(quantity: Quantity) -> Error {
    Error::OutOfRange { quantity }
}

impl<S: Scalar> World<S> {
    /// Applies a force through the centre of mass, N, over the next step.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    #[doc(alias = "add_force")]
    pub fn apply_force(&mut self, body: BodyId, force: Vec2<S>) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::Force { force, point: None }, ApplyOptions::default())
    }

    /// Applies a force at a point of the world over the next step, with the torque τ = r × F, r from the present centre of mass.
    /// Without inertia the torque does nothing, as in [`apply_torque`](Self::apply_torque).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn apply_force_at_point(&mut self, body: BodyId, force: Vec2<S>, point: Vec2<S>) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::Force { force, point: Some(point) }, ApplyOptions::default())
    }

    /// Applies a torque, N·m, over the next step.
    ///
    /// The torque does nothing if the body's moment of inertia is infinite, as without colliders (unless it has
    /// [`Mass::Explicit`](crate::Mass::Explicit)), or if its rotation is locked: [`BodyRef::inertia`](crate::BodyRef::inertia) is `None`,
    /// [`BodyRef::locks`](crate::BodyRef::locks) has `rotation`.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    #[doc(alias = "add_torque")]
    pub fn apply_torque(&mut self, body: BodyId, torque: S) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::Torque(torque), ApplyOptions::default())
    }

    /// Changes the velocity by J/m at once.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    #[doc(alias = "apply_linear_impulse")]
    pub fn apply_impulse(&mut self, body: BodyId, impulse: Vec2<S>) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::Impulse { impulse, point: None }, ApplyOptions::default())
    }

    /// Changes the velocity by J/m and the angular velocity by (r × J)/I at once, r from the centre of mass to a point of
    /// the world. Without inertia the body does not turn, as in [`apply_torque`](Self::apply_torque).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn apply_impulse_at_point(&mut self, body: BodyId, impulse: Vec2<S>, point: Vec2<S>) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::Impulse { impulse, point: Some(point) }, ApplyOptions::default())
    }

    /// Changes the angular velocity by L/I at once. Without inertia it does nothing, as [`apply_torque`](Self::apply_torque).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn apply_angular_impulse(&mut self, body: BodyId, impulse: S) -> Result<(), Error> {
        self.apply(body, ForceOrImpulse::AngularImpulse(impulse), ApplyOptions::default())
    }

    /// Applies a force, torque or impulse to a body.
    ///
    /// Only a dynamic body takes one. It is accepted and has no effect along a locked axis, on the rotation of a body without
    /// inertia, and on a sleeping body that the options do not wake.
    ///
    /// *Error* in the world's frame forces, torques and torques of forces at a point are exact. In the body's frame a force F is
    /// within 2^-60·|F| and 2^-64 N, and its torque at a point r within 2^-58·|r|·|F| and 2^-64 of |r| + |F| + 1, in N·m. An
    /// impulse changes the velocity to within 2^-64 relative and 2^-96 m/s, an angular impulse the angular velocity to within
    /// 2^-58 relative and 2^-96 rad/s.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotDynamic`]; [`Error::Quarantined`]; [`Error::Disabled`]; [`Error::OutOfRange`] naming the
    /// quantity, also when a velocity would leave the envelope.
    ///
    /// ```
    /// use umbra_physics::{ForceOrImpulse, BodyDef, Frame, Fx, ApplyOptions, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let hull = Shape::rectangle(fx!(2), fx!(1.5))?; // 3 kg
    /// let ship = world.add_body(BodyDef { angle: Fx::FRAC_PI_2, ..BodyDef::dynamic().with_collider(hull) })?;
    /// // Forwards in the ship's frame; a sleeping ship sleeps on.
    /// let ahead = ForceOrImpulse::Impulse { impulse: vec2(3, 0), point: None };
    /// world.apply(ship, ahead, ApplyOptions { frame: Frame::Body, wake: false })?;
    /// assert_eq!(format!("{:.6}", world.body(ship)?.velocity()), "(0.000000, 1.000000)");
    ///
    /// world.apply_angular_impulse(ship, fx!(1))?; // acts at once
    /// world.apply_force_at_point(ship, vec2(0, 5), vec2(1, 0))?; // acts over the next step: 5 N, and 5 N·m
    /// assert_eq!(world.body(ship)?.applied_torque().map(|torque| torque.to_string()), Some("5".into()));
    /// world.clear_forces(); // drops it again
    /// assert_eq!(world.body(ship)?.applied_torque().map(|torque| torque.to_string()), Some("0".into()));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn apply(&mut self, body: BodyId, action: ForceOrImpulse<S>, options: ApplyOptions) -> Result<(), Error> {
        S::apply(self, body, action, options)
    }

    pub(crate) fn apply_inner(
        &mut self,
        body: BodyId,
        action: ForceOrImpulse<S>,
        options: ApplyOptions,
    ) -> Result<(), Error> {
        let (dense, effect) = self.effect(body, action, options.frame)?;
        self.journal.note(|| Command::Apply { body, action, options });
        let asleep = self.bodies.activity(dense) == Activity::Asleep;
        if asleep && !options.wake {
            return Ok(());
        }
        match effect {
            Effect::ForceTorque { force, torque } => {
                // Unlike a change of the body's state, a force does not change what the fields do.
                if asleep {
                    self.touch(body, Change::VELOCITY)?;
                }
                self.applied.add(body, force, torque);
            }
            Effect::Strike { velocity, angular_velocity } => {
                let dense = self.touch(body, Change::VELOCITY)?;
                let motion = &mut self.bodies.columns.motion;
                motion.velocity.set(dense, velocity);
                motion.angular_velocity[dense] = angular_velocity;
            }
        }
        Ok(())
    }

    /// Drops the forces and torques applied since the last step. Impulses have acted already.
    pub fn clear_forces(&mut self) {
        self.applied.clear();
        self.journal.note(|| Command::ClearForces);
    }

    /// The index of a body, and the effect that a force or impulse would have on it.
    pub(super) fn effect(
        &self,
        body: BodyId,
        action: ForceOrImpulse<S>,
        frame: Frame,
    ) -> Result<(usize, Effect<S>), Error> {
        let dense = self.check_taking_part(body)?;
        if self.bodies.info(dense).kind != BodyKind::Dynamic {
            return Err(Error::NotDynamic { body });
        }
        let none = Vec2::default();
        let effect = match action {
            ForceOrImpulse::Force { force, point } => {
                let (force, torque) = self.lever(dense, force, point, frame, Quantity::Force)?;
                Effect::ForceTorque { force, torque }
            }
            ForceOrImpulse::Torque(torque) => {
                check_finite(torque, Quantity::Torque)?;
                Effect::ForceTorque { force: none, torque: S::Wide::from_scalar(torque) }
            }
            ForceOrImpulse::Impulse { impulse, point } => {
                let (impulse, angular) = self.lever(dense, impulse, point, frame, Quantity::Impulse)?;
                self.strike(dense, impulse, angular)?
            }
            ForceOrImpulse::AngularImpulse(impulse) => {
                check_finite(impulse, Quantity::Impulse)?;
                self.strike(dense, none, S::Wide::from_scalar(impulse))?
            }
        };
        Ok((dense, effect))
    }

    /// A force or impulse in the world's frame, and its moment about the centre of mass.
    pub(super) fn lever(
        &self,
        dense: usize,
        vector: Vec2<S>,
        point: Option<Vec2<S>>,
        frame: Frame,
        quantity: Quantity,
    ) -> Result<(Vec2<S::Wide>, S::Wide), Error> {
        if !vector.is_finite() {
            return Err(out_of(quantity));
        }
        let motion = &self.bodies.columns.motion;
        let wide = |v: Vec2<S>| Some(v.map(S::Wide::from_scalar));
        let turn = |v: Vec2<S>| match frame {
            Frame::World => wide(v),
            Frame::Body => motion.angle[dense].rotate(v),
        };
        let world: Offset<S> = turn(vector).ok_or(out_of(quantity))?;
        let Some(point) = point else { return Ok((world, S::Wide::default())) };
        if !point.is_finite() {
            return Err(out_of(Quantity::Position));
        }
        let arm: Offset<S> = match frame {
            Frame::Body => turn(point).ok_or(out_of(Quantity::Position))?,
            Frame::World => {
                let centre = motion.position.get(dense).map(Accumulator::value);
                Vec2::new(point.x.offset(centre.x), point.y.offset(centre.y))
            }
        };
        let moment = || S::torque(arm.x, world.y)?.plus(S::torque(arm.y, world.x)?.negated());
        // Where nothing turns the body, it has no effect, however large it is.
        let none = self.bodies.mass(dense).locks.rotation.then(S::Wide::default);
        Ok((world, moment().or(none).ok_or(out_of(Quantity::Torque))?))
    }

    /// The velocities of a body after an impulse, if they stay within the envelope.
    pub(super) fn strike(&self, dense: usize, impulse: Vec2<S::Wide>, angular: S::Wide) -> Result<Effect<S>, Error> {
        let columns = &self.bodies.columns;
        let mass = self.bodies.mass(dense);
        let (along_x, along_y) = (mass.axis_inverse_mass.x, mass.axis_inverse_mass.y);
        // A factor of zero, along a locked axis, gives no velocity, however large the impulse is.
        let gained = |impulse, inverse_mass| S::kick(impulse, inverse_mass).ok_or(out_of(Quantity::Velocity));
        let gained_velocity = Vec2::new(gained(impulse.x, along_x)?, gained(impulse.y, along_y)?);
        let spun = S::kick(angular, mass.inverse_inertia).ok_or(out_of(Quantity::AngularVelocity))?;
        let old = columns.motion.velocity.get(dense);
        let velocity = Vec2::new(old.x.plus(gained_velocity.x), old.y.plus(gained_velocity.y));
        let angular_velocity = columns.motion.angular_velocity[dense].plus(spun);
        let speed = S::from_fx(limits::SPEED);
        if !(velocity.x.is_within(speed) && velocity.y.is_within(speed)) {
            return Err(out_of(Quantity::Velocity));
        }
        if !angular_velocity.is_within(S::from_fx(limits::ANGULAR_SPEED)) {
            return Err(out_of(Quantity::AngularVelocity));
        }
        Ok(Effect::Strike { velocity, angular_velocity })
    }
}

fn check_finite<S: Scalar>(value: S, quantity: Quantity) -> Result<(), Error> {
    if value.is_finite() { Ok(()) } else { Err(out_of(quantity)) }
}
