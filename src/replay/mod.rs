//! The state as bits: hashes, snapshots, replays.

mod chunk;
mod damage;
mod difference;
mod dump;
mod error;
mod file;
mod finding;
mod hash;
mod layout;
mod playback;
mod recorder;
#[allow(clippy::module_inception, reason = "what the layer is named after")]
mod replay;
mod snapshot;
mod verify;

pub use difference::{Difference, HashTree, Owner};
pub use dump::Dump;
pub use error::{ReplayError, SnapshotError};
pub use finding::{Finding, TickPhase};
pub use playback::{Divergence, Playback};
pub use recorder::{RecordOptions, Recorder};
pub use replay::Replay;
pub use snapshot::Snapshot;
pub use verify::{ReplayLimits, VerifyError};

/// The number of the laws of physics: it moves when the results of a step or of a hash do.
pub const PHYSICS_VERSION: u32 = 6;

#[cfg(test)]
mod bounds;
#[cfg(test)]
mod encodings;
#[cfg(test)]
mod runs;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod untrusted;
