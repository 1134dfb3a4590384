//! The hook for a law of the user's own.

use core::fmt;

use super::Dependence;
use crate::math::Vec2;
use crate::scalar::{Scalar, fx::Fx};

/// What a law sees of a body: public values, and what the caller gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct BodyState<S = Fx> {
    /// Its centre of mass, m.
    pub position: Vec2<S>,
    /// Its angle in [0, 2π), rad.
    pub angle: S,
    /// Its velocity, m/s.
    pub velocity: Vec2<S>,
    /// Its angular velocity, rad/s.
    pub angular_velocity: S,
    /// Its mass, kg.
    pub mass: S,
    /// The caller's name for it.
    pub key: u64,
    /// The caller's data.
    pub user_data: u64,
}

/// A force in N and a torque in N·m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ForceTorque<S = Fx> {
    /// Through the centre of mass, world axes.
    pub force: Vec2<S>,
    /// About it.
    pub torque: S,
}

/// A law's word that it has no answer for a body; the body is quarantined at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CustomForceError {
    /// A number of the law's own, handed on to the report.
    pub code: u32,
}

impl fmt::Display for CustomForceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the law of force gave fault {}", self.code)
    }
}

impl core::error::Error for CustomForceError {}

/// A law of force of the user's own. It acts through a field with [`FieldKind::Custom`](super::FieldKind::Custom).
///
/// It must be a function of what it is given alone: the same on every machine, without floats, clocks, random numbers or
/// memory of earlier calls; it is called as often as an integrator needs it. Checked arithmetic is its own duty:
/// what overflows is a [`CustomForceError`].
///
/// ```
/// use std::sync::Arc;
/// use umbra_physics::{
///     BodyDef, BodyState, Dependence, Error, ForceField, CustomForce, Fx, FieldKind, CustomForceError, ForceTorque, World, WorldDef, fx, vec2,
/// };
///
/// /// A magnet at the origin, which pulls bodies by the charge in their user data; within 1 m it has no answer.
/// struct Magnet;
///
/// impl CustomForce for Magnet {
///     fn id(&self) -> u64 {
///         7
///     }
///     fn version(&self) -> u32 {
///         1
///     }
///     fn depends_on(&self) -> Dependence {
///         Dependence::Position
///     }
///     fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
///         let distance = body.position.checked_length().ok_or(CustomForceError { code: 1 })?;
///         if distance < Fx::ONE {
///             return Err(CustomForceError { code: 2 });
///         }
///         let strength = Fx::from(body.user_data as u8) / distance / distance;
///         let force = body.position.checked_scale(-strength).ok_or(CustomForceError { code: 1 })?;
///         Ok(ForceTorque { force, ..ForceTorque::default() })
///     }
/// }
///
/// let mut world: World = World::new(WorldDef::default())?;
/// assert_eq!(world.add_field(FieldKind::Custom { id: 7 }), Err(Error::CustomForce { id: 7 }));
/// world.register_custom_force(Arc::new(Magnet))?;
/// world.add_field(ForceField { kind: FieldKind::Custom { id: 7 }, groups: 1 })?;
/// let body = world.add_body(BodyDef { position: vec2(2, 0), user_data: 8, ..BodyDef::dynamic() })?;
/// world.step();
/// assert_eq!(format!("{:.3}", world.body(body)?.velocity().x), "-0.067"); // a force of 4 N for 1/60 s
/// # Ok::<(), umbra_physics::Error>(())
/// ```
pub trait CustomForce<S: Scalar = Fx>: Send + Sync {
    /// Names the law in scenes, hashes, snapshots and replays.
    fn id(&self) -> u64;

    /// Moves when the law's results do.
    fn version(&self) -> u32;

    /// What of a body the force depends on. It must say no less than what `push` reads: a law that reads the velocity and
    /// does not say so loses its order, and its forces, kept from one step for the next, make a copy of a world go another way.
    fn depends_on(&self) -> Dependence;

    /// The force on a body.
    ///
    /// # Errors
    /// A [`CustomForceError`] where it has no answer.
    fn push(&self, body: &BodyState<S>) -> Result<ForceTorque<S>, CustomForceError>;
}
