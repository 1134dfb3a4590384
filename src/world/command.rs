//! Changes to a world as plain data.

use alloc::vec::Vec;

use super::{ApplyOptions, ForceOrImpulse, World};
use crate::body::{BodyDef, BodyKind, Locks, Mass};
use crate::codec::{Malformed, Read as _, Reader, Write as _, codec_enum};
use crate::error::Error;
use crate::force::ForceField;
use crate::integrate::Integrator;
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::{Scalar, fx::Fx};
use crate::shape::Shape;
use crate::slots::{BodyId, FieldId};

/// A call that changes a world, as data to send, record and replay. The methods of [`World`] of the same names say what
/// each does and when it is refused; [`World`](World#cost) says what each costs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "each stands for the method of its name, with that method's arguments")]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        rename_all = "snake_case",
        deny_unknown_fields,
        bound(
            serialize = "S: serde::Serialize, S::Factor: serde::Serialize",
            deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>"
        )
    )
)]
pub enum Command<S: Scalar = Fx> {
    AddBody(BodyDef<S>),
    RemoveBody(BodyId),
    Apply { body: BodyId, action: ForceOrImpulse<S>, manner: ApplyOptions },
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
    AddField(ForceField<S>),
    SetField { id: FieldId, field: ForceField<S> },
    RemoveField(FieldId),
    SetTimeStep(TimeStep),
    SetGravity(Vec2<S>),
    SetIntegrator(Integrator),
    SetDamping { linear: S, angular: S },
    SetSleepAfter(Option<u32>),
    SetRandom(Random),
    SetBlob(Vec<u8>),
    SetLocks { body: BodyId, locks: Locks },
    SetMaxSpeeds { body: BodyId, linear: Option<S>, angular: Option<S> },
    Disable(BodyId),
    Enable(BodyId),
    MoveTo { body: BodyId, position: Vec2<S>, angle: S },
}

/// What a command made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Created {
    /// Nothing new.
    Nothing,
    /// A body.
    Body(BodyId),
    /// A force field.
    ForceField(FieldId),
}

codec_enum!(Command<S>, "the number of a command", {
    0 => AddBody(def),
    1 => RemoveBody(body),
    2 => Apply { body, action, manner },
    3 => SetPosition { body, position },
    4 => SetAngle { body, angle },
    5 => SetVelocity { body, velocity },
    6 => SetAngularVelocity { body, velocity },
    7 => SetMass { body, mass },
    8 => SetShape { body, shape },
    9 => SetKind { body, kind },
    10 => SetGravityScale { body, scale },
    11 => SetBodyDamping { body, linear, angular },
    12 => SetGroups { body, groups },
    13 => SetKey { body, key },
    14 => SetUserData { body, user_data },
    15 => Wake(body),
    16 => Release(body),
    17 => AddField(field),
    18 => SetField { id, field },
    19 => RemoveField(id),
    20 => SetTimeStep(time_step),
    21 => SetGravity(gravity),
    22 => SetIntegrator(integrator),
    23 => SetDamping { linear, angular },
    24 => SetSleepAfter(ticks),
    25 => SetRandom(random),
    26 => SetBlob(bytes),
    27 => ClearForces,
    28 => SetLocks { body, locks },
    29 => SetMaxSpeeds { body, linear, angular },
    30 => Disable(body),
    31 => Enable(body),
    32 => MoveTo { body, position, angle },
});

impl Command {
    /// The most bytes of a command without a shape or a blob. A circle takes 9 more, a polygon 5 and 16 a corner, a blob 4
    /// and its length.
    pub const BYTES: usize = 135;

    /// The fewest: [`ClearForces`](Self::ClearForces) is its number alone.
    pub(crate) const LEAST_BYTES: usize = 1;

    /// As bytes to send, the same on every machine; `docs/formats.md` has them one by one.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes);
        bytes
    }

    /// The command that is these bytes. Whether a world refuses it, [`World::check`] says. Reading takes at most 16 bytes of
    /// memory for each of theirs and 64 KiB.
    ///
    /// # Errors
    /// [`Malformed`] says where they are no command.
    ///
    /// ```
    /// use umbra_physics::{BodyId, Command, vec2};
    ///
    /// let command: Command = Command::SetVelocity { body: BodyId::from_parts(3, 0), velocity: vec2(1, 0) };
    /// let bytes = command.to_bytes();
    /// assert_eq!(bytes.len(), 25);
    /// assert_eq!(Command::from_bytes(&bytes), Ok(command));
    /// assert!(Command::from_bytes(&bytes[..24]).is_err());
    /// ```
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        let command = Self::read(&mut reader)?;
        reader.end()?;
        Ok(command)
    }
}

impl<S: Scalar> World<S> {
    /// Whether a command would be carried out now: refuses exactly what [`execute`](Self::execute) would, with the same
    /// error. Nothing changes, and nothing is copied.
    ///
    /// # Errors
    /// Those of the method it stands for.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, BodyId, Command, Error, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let body = BodyId::from_parts(0, 0);
    /// let push = Command::SetVelocity { body, velocity: vec2(1, 0) };
    /// assert_eq!(world.check(&push), Err(Error::NoSuchBody { body }));
    /// world.execute(&Command::AddBody(BodyDef::dynamic()))?;
    /// assert_eq!(world.check(&push), Ok(()));
    /// assert!(push.to_bytes().len() <= Command::BYTES);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn check(&self, command: &Command<S>) -> Result<(), Error> {
        match *command {
            Command::AddBody(ref def) => self.check_new_body(def).map(drop),
            Command::AddField(ref field) => self.check_new_field(field),
            Command::Apply { body, action, manner } => self.effect(body, action, manner.frame).map(drop),
            Command::SetPosition { body, position } => self.check_body_position(body, position),
            Command::SetAngle { body, angle } => self.check_body_angle(body, angle),
            Command::SetVelocity { body, velocity } => self.check_body_velocity(body, velocity),
            Command::SetAngularVelocity { body, velocity } => self.check_body_angular_velocity(body, velocity),
            Command::SetMass { body, mass } => self.check_body_mass(body, mass).map(drop),
            Command::SetShape { body, ref shape } => self.check_body_shape(body, shape.as_ref()).map(drop),
            Command::SetKind { body, kind } => self.check_body_kind(body, kind).map(drop),
            Command::SetGravityScale { body, scale } => self.check_body_gravity_scale(body, scale),
            Command::SetBodyDamping { body, linear, angular } => self.check_body_damping(body, linear, angular),
            Command::SetMaxSpeeds { body, linear, angular } => self.check_body_max_speeds(body, linear, angular),
            Command::RemoveBody(body)
            | Command::SetGroups { body, .. }
            | Command::SetKey { body, .. }
            | Command::SetUserData { body, .. }
            | Command::SetLocks { body, .. } => self.bodies.find(body).map(drop),
            Command::Wake(body) | Command::Disable(body) => self.check_taking_part(body).map(drop),
            Command::Enable(body) => self.check_enable(body).map(drop),
            Command::MoveTo { body, position, angle } => self.check_move(body, position, angle).map(drop),
            Command::Release(body) => self.check_release(body).map(drop),
            Command::SetField { id, ref field } => self.check_next_field(id, field).map(drop),
            Command::RemoveField(field) => self.check_field(field).map(drop),
            Command::SetTimeStep(time_step) => self.check_time_step(time_step).map(drop),
            Command::SetGravity(gravity) => self.check_gravity(gravity).map(drop),
            Command::SetIntegrator(integrator) => self.check_integrator(integrator).map(drop),
            Command::SetDamping { linear, angular } => self.check_damping(linear, angular).map(drop),
            Command::SetSleepAfter(ticks) => self.check_sleep_after(ticks).map(drop),
            Command::ClearForces | Command::SetRandom(_) => Ok(()),
            Command::SetBlob(ref bytes) => Self::check_blob(bytes),
        }
    }

    /// Carries out a command.
    ///
    /// # Errors
    /// Those of the method it stands for; the world is as it was.
    pub fn execute(&mut self, command: &Command<S>) -> Result<Created, Error> {
        match command.clone() {
            Command::AddBody(def) => return self.add_body(def).map(Created::Body),
            Command::AddField(field) => return self.add_field(field).map(Created::ForceField),
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
            Command::SetRandom(random) => {
                self.set_random(random);
                Ok(())
            }
            Command::SetBlob(bytes) => self.set_blob(&bytes),
            Command::SetLocks { body, locks } => self.set_locks(body, locks),
            Command::SetMaxSpeeds { body, linear, angular } => self.set_max_speeds(body, linear, angular),
            Command::Disable(body) => self.disable(body),
            Command::Enable(body) => self.enable(body),
            Command::MoveTo { body, position, angle } => self.move_to(body, position, angle),
        }
        .map(|()| Created::Nothing)
    }
}
