//! Comparing worlds: the values in which two states differ, and trees of hashes to find them from afar.

mod difference;
mod hash_tree;
mod text;
mod worlds;

pub(super) use difference::name_of;
pub use difference::{Difference, TickPhase};
pub use hash_tree::HashTree;
