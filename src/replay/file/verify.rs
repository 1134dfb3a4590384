//! Limits for the verification of a replay, and the reasons why it fails.

use alloc::boxed::Box;
use core::fmt;

use crate::codes::codes;
use crate::replay::diff::Difference;
use crate::world::World;

/// A run that differs from the recorded one.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Divergence {
    /// The tick of the first hash that differs.
    pub tick: u64,
    /// The recorded hash.
    pub recorded: u64,
    /// The hash of the run.
    pub computed: u64,
    /// The first value that differs at the next tick with a snapshot, the recorded value on the left; the hash itself if no
    /// value does.
    pub difference: Difference,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, recorded, computed, difference } = self;
        write!(f, "at tick {tick} the hash is {computed:016x}, recorded was {recorded:016x}; {difference}")
    }
}

codes!(Divergence = 420);

impl core::error::Error for Divergence {}

/// Limits on the work that a replay may cause. Together with the size of the file they bound the time of a verification: a
/// step takes time in proportion to the bodies, times the force fields that act on them, and a command in proportion to its
/// bytes.
///
/// [`Replay::verify_within`](crate::Replay::verify_within) has an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ReplayLimits {
    /// The most ticks.
    pub ticks: u64,
    /// The most bodies at any time.
    pub bodies: u32,
    /// The most force fields at any time.
    pub fields: u32,
    /// The most colliders at any time.
    pub colliders: u32,
    /// The most pairs of colliders in a step that the run's [`ContactSettings::max_pairs`](crate::ContactSettings::max_pairs) may allow
    /// at any time. The default of worlds is 2^20.
    pub pairs: u32,
    /// The most commands in all ticks together, calls and inputs.
    pub commands: u64,
}

impl ReplayLimits {
    /// No limits: more than any replay can have.
    pub(super) const NONE: Self = Self {
        ticks: u64::MAX,
        bodies: u32::MAX,
        fields: u32::MAX,
        colliders: u32::MAX,
        pairs: u32::MAX,
        commands: u64::MAX,
    };

    pub(super) fn check_ticks(&self, ticks: u64) -> Result<(), VerifyError> {
        if ticks > self.ticks { Err(VerifyError::Ticks { found: ticks, most: self.ticks }) } else { Ok(()) }
    }

    pub(super) fn check(&self, world: &World) -> Result<(), VerifyError> {
        let tick = world.tick();
        if world.bodies.len() > self.bodies as usize {
            return Err(VerifyError::Bodies { tick, most: self.bodies });
        }
        if world.fields.len() > self.fields as usize {
            return Err(VerifyError::Fields { tick, most: self.fields });
        }
        if world.colliders.len() > self.colliders as usize {
            return Err(VerifyError::Colliders { tick, most: self.colliders });
        }
        if world.def.contacts.max_pairs > self.pairs {
            return Err(VerifyError::Pairs { tick, most: self.pairs });
        }
        Ok(())
    }
}

/// The reason why a replay is not accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VerifyError {
    /// The run differs from the recorded one.
    Divergence(Box<Divergence>),
    /// The replay has more ticks than the limit.
    Ticks {
        /// The number of ticks.
        found: u64,
        /// The limit.
        most: u64,
    },
    /// The run has more bodies than the limit.
    Bodies {
        /// The tick in which the limit is exceeded.
        tick: u64,
        /// The limit.
        most: u32,
    },
    /// The run has more force fields than the limit.
    Fields {
        /// The tick in which the limit is exceeded.
        tick: u64,
        /// The limit.
        most: u32,
    },
    /// The replay has more commands than the limit.
    Commands {
        /// The tick in which the limit is exceeded.
        tick: u64,
        /// The limit.
        most: u64,
    },
    /// The run has more colliders than the limit.
    Colliders {
        /// The tick in which the limit is exceeded.
        tick: u64,
        /// The limit.
        most: u32,
    },
    /// The run's settings allow more pairs of colliders than the limit.
    Pairs {
        /// The tick in which the limit is exceeded.
        tick: u64,
        /// The limit.
        most: u32,
    },
    /// The caller stopped the playback: [`Playback::stop_when`](crate::Playback::stop_when).
    Stopped {
        /// The tick in which it stopped.
        tick: u64,
    },
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Divergence(divergence) => divergence.fmt(f),
            Self::Ticks { found, most } => write!(f, "the replay has {found} ticks, more than the limit of {most}"),
            Self::Bodies { tick, most } => write!(f, "more than {most} bodies at tick {tick}"),
            Self::Fields { tick, most } => write!(f, "more than {most} force fields at tick {tick}"),
            Self::Colliders { tick, most } => write!(f, "more than {most} colliders at tick {tick}"),
            Self::Pairs { tick, most } => {
                write!(f, "settings that allow more than {most} pairs of colliders at tick {tick}")
            }
            Self::Commands { tick, most } => write!(f, "more than {most} commands up to tick {tick}"),
            Self::Stopped { tick } => write!(f, "stopped at tick {tick}"),
        }
    }
}

codes!(VerifyError {
    Divergence = 421,
    Ticks = 422,
    Bodies = 423,
    Fields = 424,
    Commands = 425,
    Colliders = 426,
    Pairs = 427,
    Stopped = 428,
});

impl core::error::Error for VerifyError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Divergence(divergence) => Some(&**divergence),
            _ => None,
        }
    }
}

impl From<Box<Divergence>> for VerifyError {
    fn from(divergence: Box<Divergence>) -> Self {
        Self::Divergence(divergence)
    }
}
