//! How much a replay may be, and why one is not believed.

use alloc::boxed::Box;
use core::fmt;

use super::playback::Divergence;
use super::replay::Replay;
use crate::error::codes;
use crate::world::World;

/// Limits on what a replay may ask for. Together with the size of the file they bound the time that verifying takes: a step
/// takes time in proportion to the bodies, times the force fields that act on them, and a command in proportion to its bytes.
///
/// [`Replay::verify_within`] has an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ReplayLimits {
    /// The most ticks it may have.
    pub ticks: u64,
    /// The most bodies there may be at any time.
    pub bodies: u32,
    /// The most force fields there may be at any time.
    pub fields: u32,
    /// The most commands it may have over all of its ticks, calls and inputs.
    pub commands: u64,
}

impl ReplayLimits {
    /// More than there can be.
    pub(super) const NONE: Self = Self { ticks: u64::MAX, bodies: u32::MAX, fields: u32::MAX, commands: u64::MAX };

    pub(super) fn check_ticks(&self, replay: &Replay) -> Result<(), VerifyError> {
        let found = replay.ticks;
        if found > self.ticks { Err(VerifyError::Ticks { found, most: self.ticks }) } else { Ok(()) }
    }

    pub(super) fn check(&self, world: &World) -> Result<(), VerifyError> {
        let tick = world.tick();
        if world.bodies.len() > self.bodies as usize {
            return Err(VerifyError::Bodies { tick, most: self.bodies });
        }
        if world.fields.len() > self.fields as usize {
            return Err(VerifyError::Fields { tick, most: self.fields });
        }
        Ok(())
    }
}

/// Why a replay is not believed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VerifyError {
    /// It goes another way than the run recorded.
    Divergence(Box<Divergence>),
    /// It has more ticks than it may.
    Ticks {
        /// How many it has.
        found: u64,
        /// How many it may have.
        most: u64,
    },
    /// It makes more bodies than it may.
    Bodies {
        /// In which tick.
        tick: u64,
        /// How many it may make.
        most: u32,
    },
    /// It makes more force fields than it may.
    Fields {
        /// In which tick.
        tick: u64,
        /// How many it may make.
        most: u32,
    },
    /// It has more commands than it may.
    Commands {
        /// In which tick there are too many.
        tick: u64,
        /// How many it may have.
        most: u64,
    },
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Divergence(divergence) => divergence.fmt(f),
            Self::Ticks { found, most } => write!(f, "it has {found} ticks, more than {most}"),
            Self::Bodies { tick, most } => write!(f, "more than {most} bodies at tick {tick}"),
            Self::Fields { tick, most } => write!(f, "more than {most} force fields at tick {tick}"),
            Self::Commands { tick, most } => write!(f, "more than {most} commands up to tick {tick}"),
        }
    }
}

codes!(VerifyError {
    Divergence = 421,
    Ticks = 422,
    Bodies = 423,
    Fields = 424,
    Commands = 425,
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
