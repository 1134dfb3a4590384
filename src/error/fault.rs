//! Faults of bodies in a step, and their causes.

use core::fmt;

use crate::codes::codes;
use crate::slots::{BodyId, FieldId};

/// A body that was quarantined in a step, and the reason.
///
/// ```
/// use umbra_physics::{BodyDef, Cause, Fault, World, WorldDef, limits, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(100, 0), ..WorldDef::default() })?;
/// let body = world.add_body(BodyDef { velocity: vec2(limits::SPEED, 0), ..BodyDef::dynamic() })?;
/// let fault: Fault = world.step().faults[0];
/// assert_eq!(fault, Fault { body, cause: Cause::Velocity });
/// assert_eq!((fault.code(), fault.to_string()), (202, "body 0 was quarantined: velocity beyond 2^20 m/s".into()));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Fault {
    /// The body.
    pub body: BodyId,
    /// The first reason that was found.
    pub cause: Cause,
}

impl Fault {
    /// The error number of the cause.
    #[must_use]
    pub const fn code(&self) -> u16 {
        self.cause.code()
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { body, cause } = self;
        write!(f, "{body} was quarantined: {cause}")
    }
}

impl core::error::Error for Fault {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        Some(&self.cause)
    }
}

/// Reason why a body was quarantined in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Cause {
    /// The position left the allowed range.
    Position,
    /// The velocity became too large.
    Velocity,
    /// The angular velocity became too large.
    AngularVelocity,
    /// The sum of the forces on the body does not fit.
    Force,
    /// The force of a field on the body does not fit.
    Field {
        /// The field.
        field: FieldId,
    },
    /// A custom force returned an error.
    CustomForce {
        /// The field.
        field: FieldId,
        /// The code that the custom force returned.
        code: u32,
    },
    /// A collider of the body has too many pairs, and the world has more than its settings allow.
    Pairs,
}

codes!(Cause {
    Position = 201,
    Velocity = 202,
    AngularVelocity = 203,
    Force = 204,
    Field = 205,
    CustomForce = 206,
    Pairs = 207,
});

impl core::error::Error for Cause {}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position => f.write_str("position beyond 2^30 m"),
            Self::Velocity => f.write_str("velocity beyond 2^20 m/s"),
            Self::AngularVelocity => f.write_str("angular velocity beyond 2^20 rad/s"),
            Self::Force => f.write_str("sum of forces too large"),
            Self::Field { field } => write!(f, "the force of {field} is too large"),
            Self::Pairs => f.write_str("its colliders are in too many pairs"),
            Self::CustomForce { field, code } => write!(f, "the custom force of {field} returned error {code}"),
        }
    }
}
