//! Errors of reading snapshots.

use core::fmt;

use super::owner::Owner;
use crate::codec::Malformed;
use crate::codes::codes;
use crate::error::Error;

/// The reason why bytes cannot be read as a snapshot.
///
/// ```
/// use umbra_physics::{Snapshot, SnapshotError, World, WorldDef};
///
/// let world = World::new(WorldDef::default())?;
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
    /// The bytes are not a snapshot.
    Foreign,
    /// The snapshot has another format.
    Format {
        /// The format number of the snapshot.
        found: u32,
        /// The format number that this build reads.
        known: u32,
    },
    /// The snapshot was made under another physics version: its future would be another one here.
    PhysicsVersion {
        /// The physics version of the snapshot.
        found: u32,
        /// The physics version of this build.
        own: u32,
    },
    /// The bytes are cut off or damaged.
    Malformed(Malformed),
    /// The bytes describe a state that no world can have.
    Invalid {
        /// The part of the world that is wrong.
        owner: Owner,
        /// The error that a call would give which tried to bring it about.
        error: Error,
    },
    /// A custom force is missing among those given, or given in another version.
    CustomForce {
        /// The id of the custom force.
        id: u64,
        /// The version that is needed.
        version: u32,
    },
    /// The hash in the snapshot is not the hash of its world: the bytes were changed.
    Changed {
        /// The hash in the snapshot.
        recorded: u64,
        /// The hash of the world.
        computed: u64,
    },
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("not a snapshot of umbra-physics"),
            Self::Format { found, known } => write!(f, "a snapshot of format {found}; this build reads format {known}"),
            Self::PhysicsVersion { found, own } => {
                write!(f, "a snapshot made under physics version {found}; this build has physics version {own}")
            }
            Self::Malformed(malformed) => malformed.fmt(f),
            Self::Invalid { owner, error } => write!(f, "no world can have this state: {owner}: {error}"),
            Self::CustomForce { id, version } => {
                write!(f, "the custom force {id:#x} in version {version} is not among those given")
            }
            Self::Changed { recorded, computed } => {
                write!(f, "the recorded hash is {recorded:016x}, the hash of the world is {computed:016x}")
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

/// An error of the world as a whole.
impl From<Error> for SnapshotError {
    fn from(error: Error) -> Self {
        Self::Invalid { owner: Owner::World, error }
    }
}
