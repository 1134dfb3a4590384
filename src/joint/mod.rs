//! Joints: two points of bodies that stay together, or at a distance.
//!
//! - `def`: the definition of a joint as data, and its checks.
//! - `link`: a joint as steps see it, in fixed point whatever the scalar of the world is.
//! - `set`: the joints of a world and their handles. No step changes a definition: copies of a world share the set.
//! - `state`: what steps change of a joint, which each world has for itself: impulses, and whether it is broken.

mod def;
mod link;
mod set;
mod state;

pub(crate) use def::check_break_force;
pub use def::{Distance, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Revolute, Weld};
pub(crate) use link::{Joined, Place};
pub(crate) use set::JointSet;
pub(crate) use state::{JointState, JointStates, exceeds, position, turns_after};
