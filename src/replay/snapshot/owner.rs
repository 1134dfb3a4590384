//! The part of a world that a value belongs to.

use core::fmt;

use crate::slots::{BodyId, FieldId};
use crate::world::Command;

/// The part of a world that a value belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Owner {
    /// The world as a whole.
    World,
    /// A body.
    Body(BodyId),
    /// A force field.
    ForceField(FieldId),
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World => f.write_str("the world"),
            Self::Body(body) => body.fmt(f),
            Self::ForceField(field) => field.fmt(f),
        }
    }
}

impl Owner {
    /// The body or field that a command names, or else the world.
    pub(in crate::replay) fn of_command(command: &Command) -> Self {
        match *command {
            Command::RemoveBody(body)
            | Command::Apply { body, .. }
            | Command::SetPosition { body, .. }
            | Command::SetAngle { body, .. }
            | Command::SetVelocity { body, .. }
            | Command::SetAngularVelocity { body, .. }
            | Command::SetMass { body, .. }
            | Command::SetShape { body, .. }
            | Command::SetKind { body, .. }
            | Command::SetGravityScale { body, .. }
            | Command::SetBodyDamping { body, .. }
            | Command::SetGroups { body, .. }
            | Command::SetKey { body, .. }
            | Command::SetUserData { body, .. }
            | Command::SetLocks { body, .. }
            | Command::SetMaxSpeeds { body, .. }
            | Command::MoveTo { body, .. }
            | Command::Wake(body)
            | Command::Release(body)
            | Command::Disable(body)
            | Command::Enable(body) => Self::Body(body),
            Command::SetField { id, .. } | Command::RemoveField(id) => Self::ForceField(id),
            Command::AddBody(_)
            | Command::AddField(_)
            | Command::SetTimeStep(_)
            | Command::SetGravity(_)
            | Command::SetIntegrator(_)
            | Command::SetDamping { .. }
            | Command::SetSleepAfter(_)
            | Command::SetRandom(_)
            | Command::SetBlob(_)
            | Command::ClearForces => Self::World,
        }
    }
}
