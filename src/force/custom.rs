//! The hook for forces that the user defines.

use core::fmt;

use super::Dependence;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// The state of a body as a [`CustomForce`] sees it: public values, and the data given to the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct BodyState<S = Fx> {
    /// The position of the centre of mass, m.
    pub position: Vec2<S>,
    /// The angle in [0, 2π), rad.
    pub angle: S,
    /// The velocity, m/s.
    pub velocity: Vec2<S>,
    /// The angular velocity, rad/s.
    pub angular_velocity: S,
    /// The mass, kg.
    pub mass: S,
    /// The key given to the body.
    pub key: u64,
    /// The user data given to the body.
    pub user_data: u64,
}

/// A force in N and a torque in N·m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ForceTorque<S = Fx> {
    /// The force through the centre of mass in world axes, N.
    pub force: Vec2<S>,
    /// The torque about the centre of mass, N·m.
    pub torque: S,
}

/// The error of a [`CustomForce`] that has no value for a body. The body is quarantined at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CustomForceError {
    /// A number that the custom force chooses. The report of the step has it.
    pub code: u32,
}

impl fmt::Display for CustomForceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the custom force failed with code {}", self.code)
    }
}

impl core::error::Error for CustomForceError {}

/// A force that the user defines. It acts through a field of the kind [`FieldKind::Custom`](super::FieldKind::Custom).
///
/// The force must be a function of its argument alone: the same on every machine, without floats, clocks, random numbers or
/// memory of earlier calls. An integrator calls it as often as it needs to. The function uses checked arithmetic and returns a
/// [`CustomForceError`] on overflow.
///
/// ```
/// use std::sync::Arc;
/// use umbra_physics::{
///     BodyDef, BodyState, CustomForce, CustomForceError, Dependence, Error, FieldKind, ForceField, ForceTorque, Fx, World,
///     WorldDef, fx, vec2,
/// };
///
/// /// A magnet at the origin that pulls bodies by the charge in their user data. It has no value within 1 m.
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
/// let mut world = World::new(WorldDef::default())?;
/// assert_eq!(world.add_field(FieldKind::Custom { id: 7 }), Err(Error::CustomForce { id: 7 }));
/// world.register_custom_force(Arc::new(Magnet))?;
/// world.add_field(ForceField { kind: FieldKind::Custom { id: 7 }, force_groups: 1 })?;
/// let body = world.add_body(BodyDef { position: vec2(2, 0), user_data: 8, ..BodyDef::dynamic() })?;
/// world.step();
/// assert_eq!(format!("{:.3}", world.body(body)?.velocity().x), "-0.067"); // a force of 4 N for 1/60 s
/// # Ok::<(), umbra_physics::Error>(())
/// ```
pub trait CustomForce<S: Scalar = Fx>: Send + Sync {
    /// The id of the force in scenes, hashes, snapshots and replays.
    fn id(&self) -> u64;

    /// The version. Increase it whenever the results of the force change.
    fn version(&self) -> u32;

    /// The part of a body's state that the force depends on. It must name at least what `push` reads. A force that reads the
    /// velocity without naming it loses its order of accuracy; and as its values are kept from one step for the next, a copy
    /// of a world, which does not have them, diverges.
    fn depends_on(&self) -> Dependence;

    /// The force on a body, and the torque.
    ///
    /// # Errors
    /// A [`CustomForceError`] where the force has no value.
    fn push(&self, body: &BodyState<S>) -> Result<ForceTorque<S>, CustomForceError>;
}
