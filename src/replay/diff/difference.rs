//! A value in which two states, runs or files differ.

use alloc::format;
use alloc::string::{String, ToString as _};
use core::fmt;

use super::text;
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, Write};
use crate::integrate::StageKind;
use crate::replay::snapshot::Owner;

/// A phase of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum TickPhase {
    /// The start, before anything is done in the tick. Snapshots, and the values of a file that belong to no tick, count to it.
    Start,
    /// The calls that are no input of a player.
    Calls,
    /// The players' inputs.
    Inputs,
    /// A stage of the step, by its index in [`Integrator::stages`](crate::Integrator::stages).
    Stage {
        /// The index of the stage, from 0.
        index: u32,
        /// The kind of the stage.
        kind: StageKind,
    },
    /// The end of the tick, after quarantine and sleep.
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

impl Write for TickPhase {
    fn write(&self, out: &mut impl Encoder) {
        let (tag, index, kind) = match *self {
            Self::Start => (0, 0, StageKind::Clear),
            Self::Calls => (1, 0, StageKind::Clear),
            Self::Inputs => (2, 0, StageKind::Clear),
            Self::Stage { index, kind } => (3, index, kind),
            Self::End => (4, 0, StageKind::Clear),
        };
        out.leaf(&[tag], self);
        if let Self::Stage { .. } = self {
            codec::field(out, "index", &index);
            codec::field(out, "kind", &kind);
        }
    }
}

impl Read for TickPhase {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("the number of a phase");
        Ok(match u8::read(reader)? {
            0 => Self::Start,
            1 => Self::Calls,
            2 => Self::Inputs,
            3 => Self::Stage { index: u32::read(reader)?, kind: StageKind::read(reader)? },
            4 => Self::End,
            _ => return Err(malformed),
        })
    }
}

/// A value in which two worlds, runs or files differ, or in which a file was changed.
///
/// The text is `tick 2, inputs, body 1 "ball", input 1, velocity.x: 3 and 4 m/s (differ by 1 m/s)`; with `{:#}` the tick and the phase are
/// left out. Numbers have as many digits as show the difference, [`exact`](Self::exact) has all. One ulp is 2^-32; a difference of less
/// than a million is given in ulps too.
///
/// ```
/// use umbra_physics::{BodyDef, Difference, Owner, TickPhase, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef { key: 7, ..BodyDef::dynamic() })?;
/// let mut changed = world.clone();
/// changed.set_gravity(vec2(0, -10))?;
/// changed.set_velocity(body, vec2(1, 0))?;
/// let differences: Vec<Difference> = world.differences(&changed);
/// assert_eq!((differences[0].owner, &differences[0].field[..]), (Owner::World, "settings.gravity.y"));
/// assert_eq!((differences[1].owner, differences[1].right.as_deref()), (Owner::Body(body), Some("1")));
/// assert_eq!((differences[1].tick, differences[1].phase), (0, TickPhase::Start));
/// assert_eq!(differences[1].to_string(), "tick 0, start, body 0 (key 7), velocity.x: 0 and 1 m/s (differ by 1 m/s)");
/// assert_eq!(format!("{:#}", differences[1]), "body 0 (key 7), velocity.x: 0 and 1 m/s (differ by 1 m/s)");
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Difference {
    /// The tick the values are in: tick 0 takes the world from tick 0 to tick 1.
    pub tick: u64,
    /// The phase of the tick.
    pub phase: TickPhase,
    /// The part of the world that the values belong to.
    pub owner: Owner,
    /// The name that the owner has in the [`Labels`](crate::Labels) of a replay.
    pub name: Option<String>,
    /// The key of the body or collider, where it is known; else 0.
    pub key: u64,
    /// The name of the value there, as `position.x`; empty if more was changed than can be told apart.
    pub field: String,
    /// The exact value in the first of the two: the recorded value of a file or a run. `None` if there is none, or it is
    /// unknown.
    pub left: Option<String>,
    /// The exact value in the second of the two: the value that was found instead of the recorded one.
    pub right: Option<String>,
}

impl Difference {
    /// Moves the values to another tick and phase.
    pub(in crate::replay) fn at(self, tick: u64, phase: TickPhase) -> Self {
        Self { tick, phase, ..self }
    }

    /// The text with all digits of its numbers.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Fx, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef::dynamic())?;
    /// let mut changed = world.clone();
    /// changed.set_velocity(body, vec2(Fx::DELTA, Fx::ZERO))?;
    /// let difference = world.first_difference(&changed).unwrap();
    /// let exact = "body 0, velocity.x: 0 and 0.00000000023283064365386962890625 m/s (differ by 1 ulp, 2.3e-10 m/s)";
    /// assert_eq!(format!("{:#}", difference.exact()), exact);
    /// assert_eq!(format!("{difference:#}"), "body 0, velocity.x: 0 and 0.00000000023 m/s (differ by 1 ulp, 2.3e-10 m/s)");
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn exact(&self) -> impl fmt::Display {
        Exact(self)
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, exact: bool) -> fmt::Result {
        let Self { tick, phase, owner, name, key, field, left, right } = self;
        if !f.alternate() {
            write!(f, "tick {tick}, {phase}, ")?;
        }
        write!(f, "{owner}")?;
        if let Some(name) = name {
            write!(f, " {name:?}")?;
        }
        if *key != 0 {
            write!(f, " (key {key})")?;
        }
        if !field.is_empty() {
            write!(f, ", {}", spoken(field))?;
        }
        f.write_str(": ")?;
        let none = if left.is_none() && right.is_none() { "unknown" } else { "nothing" };
        text::write(f, field, left.as_deref().unwrap_or(none), right.as_deref().unwrap_or(none), exact)
    }

    /// Two hashes of a world at the end of a tick.
    pub(in crate::replay) fn of_hashes(tick: u64, left: u64, right: u64) -> Self {
        let [left, right] = [left, right].map(|hash| Some(format!("{hash:016x}")));
        let (name, key, field) = (None, 0, "hash".to_string());
        Self { tick, phase: TickPhase::End, owner: Owner::World, name, key, field, left, right }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, false)
    }
}

/// A difference, to be written with all digits.
struct Exact<'a>(&'a Difference);

impl fmt::Display for Exact<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.write(f, true)
    }
}

/// The name of a field for a sentence: the calls and inputs of a tick are counted from 1.
fn spoken(field: &str) -> String {
    for (list, singular) in [("calls", "call"), ("inputs", "input")] {
        let Some(rest) = field.strip_prefix(list) else { continue };
        if rest == ".count" {
            return format!("number of {list}");
        }
        let entry = rest.strip_prefix('[').and_then(|rest| rest.split_once(']'));
        if let Some((Ok(index), within)) = entry.map(|(index, within)| (index.parse::<u32>(), within)) {
            let within = within.strip_prefix('.').unwrap_or(within);
            let comma = if within.is_empty() { "" } else { ", " };
            return format!("{singular} {}{comma}{within}", u64::from(index) + 1);
        }
    }
    field.to_string()
}

/// Writes a path as a name: `bodies[3].position.x`.
pub(in crate::replay) fn name_of(path: &[Part]) -> String {
    let mut name = String::new();
    for part in path {
        match part {
            Part::Name(part) if name.is_empty() => name.push_str(part),
            Part::Name(part) => name.push_str(&format!(".{part}")),
            Part::Entry(index) => name.push_str(&format!("[{index}]")),
        }
    }
    name
}
