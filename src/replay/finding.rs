//! Where and in what two runs, or a run and its recording, part.

use alloc::format;
use alloc::string::{String, ToString as _};
use core::fmt;

use super::{Difference, Owner};
use crate::integrate::StageKind;

/// A moment of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum TickPhase {
    /// Before anything is done in the tick: a snapshot, or what stands over the ticks of a file.
    Start,
    /// Calls outside of the players' inputs.
    Calls,
    /// The players' inputs.
    Inputs,
    /// A stage of the step, by its place in [`Integrator::stages`](crate::Integrator::stages).
    Stage {
        /// Its place, from 0.
        index: u32,
        /// What it does.
        kind: StageKind,
    },
    /// The end of the tick, with quarantine and sleep.
    End,
}

impl fmt::Display for TickPhase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => f.write_str("start"),
            Self::Calls => f.write_str("calls"),
            Self::Inputs => f.write_str("inputs"),
            Self::Stage { index, kind } => write!(f, "stage {} ({})", index + 1, kind.name()),
            Self::End => f.write_str("end"),
        }
    }
}

/// The first value in which two runs, or a run and its recording, are not the same.
///
/// ```
/// use umbra_physics::{Dump, Finding, Inputs, World, WorldDef, vec2};
///
/// let mut here: World = World::new(WorldDef::default())?;
/// let mut there = World::new(WorldDef { gravity: vec2(0, 1), ..WorldDef::default() })?;
/// let starts = [here.clone(), there.clone()];
/// _ = (here.step(), there.step());
/// let ours = Dump::of_tick(&starts[0], &[], &Inputs::new(), &here);
/// let found: Option<Finding> = ours.first_difference(&Dump::of_tick(&starts[1], &[], &Inputs::new(), &there));
/// assert_eq!(found.unwrap().to_string(), "tick 0, start, the world, settings.gravity.y: 0 and 1");
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Finding {
    /// The tick that was being made: 0 makes the world of tick 1.
    pub tick: u64,
    /// When in the tick.
    pub phase: TickPhase,
    /// What the value belongs to.
    pub place: Owner,
    /// Its name there, as `position.x`; empty where more was changed than can be told apart.
    pub field: String,
    /// What was recorded, or is in the first of the two, exactly; `None` where that is unknown or no value.
    pub recorded: Option<String>,
    /// What is there instead, or in the second.
    pub found: Option<String>,
}

impl Finding {
    pub(super) fn at(tick: u64, phase: TickPhase, found: Difference) -> Self {
        let Difference { place, field, left, right } = found;
        Self { tick, phase, place, field, recorded: left, found: right }
    }

    pub(super) fn of_hashes(tick: u64, recorded: u64, found: u64) -> Self {
        let hash = |hash: u64| Some(format!("{hash:016x}"));
        let (recorded, found) = (hash(recorded), hash(found));
        Self { tick, phase: TickPhase::End, place: Owner::World, field: "hash".to_string(), recorded, found }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, phase, place, field, .. } = self;
        write!(f, "tick {tick}, {phase}, {place}")?;
        if !field.is_empty() {
            write!(f, ", {field}")?;
        }
        let value = |value: &'_ Option<String>| value.clone().unwrap_or_else(|| "unknown".into());
        write!(f, ": {} and {}", value(&self.recorded), value(&self.found))
    }
}
