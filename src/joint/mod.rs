//! Joints: two points of bodies that stay together, at a distance, or on an axis.
//!
//! - `def`: the definition of a joint as data, and its checks; `kind` the kinds of joints, of which `motor` has
//!   the motor joint, `gear` gears and `pulley` pulleys, `parts` limits, motors and springs.
//! - `link`: a joint as steps see it, in fixed point whatever the scalar of the world is.
//! - `set`: the joints of a world and their handles. No step changes a definition: copies of a world share the set.
//! - `state`: what steps change of a joint, which each world has for itself: impulses, and whether it is broken.

mod def;
mod gear;
mod kind;
mod link;
mod motor;
mod parts;
mod pulley;
mod set;
mod state;

pub use def::JointDef;
pub(crate) use def::check_break;
pub use gear::Gear;
pub use kind::{Distance, JointKind, Prismatic, Revolute, Weld, Wheel};
pub(crate) use link::{Joined, Link, Place};
pub use motor::{Motor, PlanarMotor, PlanarSpring};
pub use parts::{JointLimits, JointMotor, JointSpring};
pub use pulley::Pulley;
pub(crate) use set::JointSet;
pub(crate) use state::{JointState, JointStates, exceeds, position, stop, tooth_at, turns_after};
