//! Changes to a world as plain data.

use super::{Action, Manner, World};
use crate::body::{BodyDef, BodyKind, Mass};
use crate::error::Error;
use crate::force::Field;
use crate::handle::{BodyId, FieldId};
use crate::integrate::Integrator;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Scalar, fx::Fx};
use crate::shape::Shape;

/// A call that changes a world, as data to send, record and replay. The methods of [`World`] of the same names say what
/// each does and when it is refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "each stands for the method of its name, with that method's arguments")]
pub enum Command<S: Scalar = Fx> {
    AddBody(BodyDef<S>),
    RemoveBody(BodyId),
    Apply { body: BodyId, action: Action<S>, manner: Manner },
    ClearForces,
    SetPosition { body: BodyId, position: Vec2<S> },
    SetAngle { body: BodyId, angle: S },
    SetVelocity { body: BodyId, velocity: Vec2<S> },
    SetAngularVelocity { body: BodyId, velocity: S },
    SetMass { body: BodyId, mass: Mass<S> },
    SetShape { body: BodyId, shape: Option<Shape<S>> },
    SetKind { body: BodyId, kind: BodyKind },
    SetGravityScale { body: BodyId, scale: S },
    SetBodyDamping { body: BodyId, linear: Option<S>, angular: Option<S> },
    SetGroups { body: BodyId, groups: u32 },
    SetKey { body: BodyId, key: u64 },
    SetUserData { body: BodyId, user_data: u64 },
    Wake(BodyId),
    Release(BodyId),
    AddField(Field<S>),
    SetField { id: FieldId, field: Field<S> },
    RemoveField(FieldId),
    SetTimeStep(TimeStep),
    SetGravity(Vec2<S>),
    SetIntegrator(Integrator),
    SetDamping { linear: S, angular: S },
    SetSleepAfter(Option<u32>),
}

/// What a command made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// Nothing new.
    Nothing,
    /// A body.
    Body(BodyId),
    /// A force field.
    Field(FieldId),
}

impl<S: Scalar> World<S> {
    /// Carries out a command.
    ///
    /// # Errors
    /// Those of the method it stands for; the world is as it was.
    pub fn execute(&mut self, command: &Command<S>) -> Result<Made, Error> {
        match command.clone() {
            Command::AddBody(def) => return self.add_body(def).map(Made::Body),
            Command::AddField(field) => return self.add_field(field).map(Made::Field),
            Command::RemoveBody(body) => self.remove_body(body),
            Command::Apply { body, action, manner } => self.apply(body, action, manner),
            Command::ClearForces => {
                self.clear_forces();
                Ok(())
            }
            Command::SetPosition { body, position } => self.set_position(body, position),
            Command::SetAngle { body, angle } => self.set_angle(body, angle),
            Command::SetVelocity { body, velocity } => self.set_velocity(body, velocity),
            Command::SetAngularVelocity { body, velocity } => self.set_angular_velocity(body, velocity),
            Command::SetMass { body, mass } => self.set_mass(body, mass),
            Command::SetShape { body, shape } => self.set_shape(body, shape),
            Command::SetKind { body, kind } => self.set_kind(body, kind),
            Command::SetGravityScale { body, scale } => self.set_gravity_scale(body, scale),
            Command::SetBodyDamping { body, linear, angular } => self.set_body_damping(body, linear, angular),
            Command::SetGroups { body, groups } => self.set_groups(body, groups),
            Command::SetKey { body, key } => self.set_key(body, key),
            Command::SetUserData { body, user_data } => self.set_user_data(body, user_data),
            Command::Wake(body) => self.wake(body),
            Command::Release(body) => self.release(body),
            Command::SetField { id, field } => self.set_field(id, field),
            Command::RemoveField(field) => self.remove_field(field),
            Command::SetTimeStep(time_step) => self.set_time_step(time_step),
            Command::SetGravity(gravity) => self.set_gravity(gravity),
            Command::SetIntegrator(integrator) => self.set_integrator(integrator),
            Command::SetDamping { linear, angular } => self.set_damping(linear, angular),
            Command::SetSleepAfter(ticks) => self.set_sleep_after(ticks),
        }
        .map(|()| Made::Nothing)
    }
}
