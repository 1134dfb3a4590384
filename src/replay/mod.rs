//! The state as bits: snapshots and hashes, differences between worlds, replays and desync dumps.
//!
//! The folders are levels, each of which uses those before it: `snapshot`, `diff`, `file`.

mod diff;
mod file;
mod snapshot;

pub use diff::{Difference, HashTree, TickPhase};
pub use file::{
    Divergence, Dump, Labels, Playback, RecordOptions, Recorder, Replay, ReplayError, ReplayLimits, VerifyError,
};
pub use snapshot::{Owner, PHYSICS_VERSION, Snapshot, SnapshotError};

#[cfg(test)]
mod tests;
