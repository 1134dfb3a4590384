//! Files of chunks: replays, which record a run, and desync dumps, which record one tick.

mod chunk;
mod damage;
mod dump;
mod error;
mod format;
mod labels;
mod layout;
mod playback;
mod recorder;
mod replay;
mod ticks;
mod verify;

pub use dump::Dump;
pub use error::ReplayError;
pub use labels::Labels;
pub use playback::Playback;
pub use recorder::{RecordOptions, Recorder};
pub use replay::Replay;
pub use verify::{Divergence, ReplayLimits, VerifyError};

#[cfg(test)]
pub(super) use chunk::{Chunk, Damage, Tag, read as read_chunk, write as write_chunk};
#[cfg(test)]
pub(super) use format::{DONE, Done, HEAD, Head, NAMES, REPLAY, SNAPSHOT, TICKS};
#[cfg(test)]
pub(super) use ticks::{Segment, Tick};
