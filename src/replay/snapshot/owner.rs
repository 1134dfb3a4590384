//! The part of a world that a value belongs to.

use core::fmt;

use crate::slots::{BodyId, ColliderId, FieldId, JointId};
use crate::world::Command;

/// The part of a world that a value belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Owner {
    /// The world as a whole.
    World,
    /// A body.
    Body(BodyId),
    /// A force field.
    ForceField(FieldId),
    /// A collider.
    Collider(ColliderId),
    /// A contact of two colliders.
    Contact(ColliderId, ColliderId),
    /// A joint.
    Joint(JointId),
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World => f.write_str("the world"),
            Self::Body(body) => body.fmt(f),
            Self::ForceField(field) => field.fmt(f),
            Self::Collider(collider) => collider.fmt(f),
            Self::Joint(joint) => joint.fmt(f),
            Self::Contact(first, second) => write!(f, "the contact of {first} and {second}"),
        }
    }
}

impl Owner {
    /// The body, field, collider or joint that a command names, or else the world.
    pub(in crate::replay) fn of_command(command: &Command) -> Self {
        let joint = command.joint().map_or(Self::World, Self::Joint);
        let collider = command.collider().map_or(joint, Self::Collider);
        let field = command.field().map_or(collider, Self::ForceField);
        command.body().map_or(field, Self::Body)
    }
}
