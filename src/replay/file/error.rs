//! Errors of reading replays and dumps.

use alloc::boxed::Box;
use core::fmt;

use crate::codec::Malformed;
use crate::codes::codes;
use crate::replay::diff::Difference;
use crate::replay::snapshot::SnapshotError;

/// The reason why a file cannot be read as a replay or a desync dump.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReplayError {
    /// The file is of another kind.
    Foreign,
    /// The file has another format.
    Format {
        /// The format number of the file.
        found: u32,
        /// The format number that this build reads.
        known: u32,
    },
    /// The file was recorded under another physics version: the run would have other results here.
    PhysicsVersion {
        /// The physics version of the file.
        found: u32,
        /// The physics version of this build.
        own: u32,
    },
    /// The file ends before the recording did. [`Replay::recovered`](super::Replay::recovered) reads the part that is there.
    CutOff {
        /// The tick up to which it is complete.
        tick: u64,
    },
    /// The file was changed after it was recorded: the recorded value is on the left, the value in the file on the right.
    Tampered(Box<Difference>),
    /// A chunk of the file is malformed.
    Malformed {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// The error, with a position counted from the start of the chunk.
        malformed: Malformed,
    },
    /// A snapshot in the file cannot be read.
    Snapshot {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// The error.
        error: SnapshotError,
    },
}

impl ReplayError {
    /// A chunk that should be another one.
    pub(super) fn expected(chunk: u32, expected: &'static str) -> Self {
        Self::Malformed { chunk, malformed: Malformed { at: 0, expected } }
    }
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("not a replay or dump of umbra-physics"),
            Self::Format { found, known } => write!(f, "a file of format {found}; this build reads format {known}"),
            Self::PhysicsVersion { found, own } => {
                write!(f, "a file recorded under physics version {found}; this build has physics version {own}")
            }
            Self::CutOff { tick } => write!(f, "cut off: whole up to tick {tick}"),
            Self::Tampered(difference) => write!(f, "changed after it was recorded: {difference}"),
            Self::Malformed { chunk, malformed } => write!(f, "chunk {chunk}: {malformed}"),
            Self::Snapshot { chunk, error } => write!(f, "chunk {chunk}: {error}"),
        }
    }
}

codes!(ReplayError {
    Foreign = 401,
    Format = 402,
    PhysicsVersion = 403,
    CutOff = 404,
    Tampered = 405,
    Malformed = 406,
    Snapshot = 407,
});

impl core::error::Error for ReplayError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Malformed { malformed, .. } => Some(malformed),
            Self::Snapshot { error, .. } => Some(error),
            _ => None,
        }
    }
}
