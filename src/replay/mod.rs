//! The state as bits: hashes, snapshots, replays.

mod chunk;
mod difference;
mod hash;
mod snapshot;

pub use difference::{Difference, HashTree, Place};
pub use snapshot::{Snapshot, SnapshotError};

/// The number of the laws of physics: it moves when the results of a step or of a hash do.
pub const LAW: u32 = 3;
