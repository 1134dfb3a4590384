//! The state as bits: hashes now; snapshots and replays have their place here.

mod hash;

/// The number of the laws of physics: it moves when the results of a step or of a hash do.
pub const LAW: u32 = 2;
