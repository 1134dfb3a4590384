//! Forces: force fields as data, the hook for custom forces, and the forces and torques applied in this tick.

mod applied;
mod buoyancy;
mod custom;
mod drag;
mod field;
mod friction;
mod load;
mod set;
mod submerged;

pub(crate) use applied::Applied;
pub use applied::AppliedForce;
pub(crate) use buoyancy::{Fluids, Parts, floats};
pub use custom::{BodyState, CustomForce, CustomForceError, ForceTorque};
pub(crate) use drag::{outer_drag, resist};
pub use field::{Attachment, Dependence, End, FieldKind, ForceField, Region};
pub(crate) use friction::{Friction, rub};
pub(crate) use load::{Directions, Loads, Scene, Targets, accumulate, velocity_at};
pub(crate) use set::FieldSet;

use alloc::collections::BTreeMap;
use alloc::sync::Arc;

/// The registered custom forces, by id.
pub(crate) type CustomForces<S> = BTreeMap<u64, Arc<dyn CustomForce<S>>>;
