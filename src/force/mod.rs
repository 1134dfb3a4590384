//! Forces: the fields a world has, as data; the hook for a law of the user's own; and what was applied this tick.

mod applied;
mod field;
mod law;
mod load;
mod set;

pub(crate) use applied::Applied;
pub use applied::AppliedForce;
pub use field::{Attachment, Dependence, End, Field, Law, Region};
pub use law::{BodyState, ForceLaw, LawFault, Push};
pub(crate) use load::{Directions, Load, Loads, Scene, accumulate, outer_drag, resist, velocity_at};
pub(crate) use set::FieldSet;

use alloc::collections::BTreeMap;
use alloc::sync::Arc;

/// The laws of the user's own that are registered, by id.
pub(crate) type Laws<S> = BTreeMap<u64, Arc<dyn ForceLaw<S>>>;
