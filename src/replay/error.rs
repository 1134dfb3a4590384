//! Why files are refused.

use alloc::boxed::Box;
use core::fmt;

use super::difference::Owner;
use super::finding::Finding;
use crate::codec::Malformed;
use crate::error::{Error, codes};

/// Why bytes are no snapshot that this build can go on from.
///
/// ```
/// use umbra_physics::{Snapshot, SnapshotError, World, WorldDef};
///
/// let world: World = World::new(WorldDef::default())?;
/// let mut bytes = world.snapshot().to_bytes();
/// assert!(Snapshot::from_bytes(&bytes, &[]).is_ok());
/// assert_eq!(Snapshot::from_bytes(b"something else", &[]).err(), Some(SnapshotError::Foreign));
/// bytes.truncate(40);
/// let Err(error @ SnapshotError::Malformed(_)) = Snapshot::from_bytes(&bytes, &[]) else { unreachable!() };
/// assert_eq!(error.code(), 304);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SnapshotError {
    /// They are something else.
    Foreign,
    /// Their layout is another.
    Format {
        /// Its number.
        found: u32,
        /// The one this build knows.
        known: u32,
    },
    /// They were made under other laws of physics: what follows from them would be something else here.
    PhysicsVersion {
        /// Those they were made under.
        found: u32,
        /// Those of this build.
        own: u32,
    },
    /// They are cut off, or damaged.
    Malformed(Malformed),
    /// They say of a world what cannot be.
    Invalid {
        /// Of which part of it.
        place: Owner,
        /// What would be refused if it were called for.
        error: Error,
    },
    /// A law of force of the user's own is not given, or in another version.
    CustomForce {
        /// Its id.
        id: u64,
        /// The version that is needed.
        version: u32,
    },
    /// The world they make does not have the hash they give: they were changed.
    Changed {
        /// The hash they give.
        recorded: u64,
        /// That of the world.
        computed: u64,
    },
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("not a snapshot of umbra-physics"),
            Self::Format { found, known } => write!(f, "a snapshot of format {found}; this build reads format {known}"),
            Self::PhysicsVersion { found, own } => {
                write!(f, "a snapshot made under law {found} of physics; this build has law {own}")
            }
            Self::Malformed(malformed) => malformed.fmt(f),
            Self::Invalid { place, error } => write!(f, "no world can be so: {place}: {error}"),
            Self::CustomForce { id, version } => write!(f, "force law {id:#x} in version {version} is not given"),
            Self::Changed { recorded, computed } => {
                write!(f, "the hash recorded is {recorded:016x}, that of what is there {computed:016x}")
            }
        }
    }
}

codes!(SnapshotError {
    Foreign = 301,
    Format = 302,
    PhysicsVersion = 303,
    Malformed = 304,
    Invalid = 305,
    CustomForce = 306,
    Changed = 307,
});

impl core::error::Error for SnapshotError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Malformed(malformed) => Some(malformed),
            Self::Invalid { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl From<Malformed> for SnapshotError {
    fn from(malformed: Malformed) -> Self {
        Self::Malformed(malformed)
    }
}

/// Of the world as a whole.
impl From<Error> for SnapshotError {
    fn from(error: Error) -> Self {
        Self::Invalid { place: Owner::World, error }
    }
}

/// Why a file is no replay that this build can play.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReplayError {
    /// It is something else.
    Foreign,
    /// Its layout is another.
    Format {
        /// Its number.
        found: u32,
        /// The one this build knows.
        known: u32,
    },
    /// It was recorded under other laws of physics: it would go another way here.
    PhysicsVersion {
        /// Those it was recorded under.
        found: u32,
        /// Those of this build.
        own: u32,
    },
    /// It ends before the recording did. [`Replay::recovered`](super::Replay::recovered) reads what there is.
    CutOff {
        /// The tick up to which it is whole.
        tick: u64,
    },
    /// It was changed after it was recorded.
    Tampered(Box<Finding>),
    /// A chunk of it is not what it should be.
    Malformed {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// What is wrong, counted from the start of the chunk.
        malformed: Malformed,
    },
    /// A snapshot in it is none.
    Snapshot {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// What is wrong with it.
        error: SnapshotError,
    },
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("not a replay of umbra-physics"),
            Self::Format { found, known } => write!(f, "a replay of format {found}; this build reads format {known}"),
            Self::PhysicsVersion { found, own } => {
                write!(f, "a replay recorded under law {found} of physics; this build has law {own}")
            }
            Self::CutOff { tick } => write!(f, "cut off: whole up to tick {tick}"),
            Self::Tampered(finding) => write!(f, "changed after it was recorded: {finding}"),
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
