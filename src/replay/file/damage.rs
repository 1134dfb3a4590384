//! Refusing a changed chunk, and naming the value in it that was changed.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::sync::Arc;

use super::chunk::{Chunk, Damage};
use super::error::ReplayError;
use super::format::{DONE, Done, HEAD, Head, NAMES, PHASE, PhaseState, SNAPSHOT, TICKS, VERSION};
use super::labels::Labels;
use super::ticks::{Segment, Tick, owner_in_tick};
use crate::codec::{FieldIndex, FieldValue, Malformed, Part, Read, Reader, Wanted};
use crate::force::CustomForce;
use crate::replay::diff::{Difference, TickPhase, name_of};
use crate::replay::snapshot::{Owner, Saved, read_unsealed};
use crate::world::World;

/// Reads the value that a chunk consists of.
pub(super) fn read_whole<'a, T>(
    chunk: &'a Chunk,
    number: u32,
    read: impl FnOnce(&mut Reader<'a>) -> Result<T, Malformed>,
) -> Result<T, ReplayError> {
    let mut reader = Reader::new(&chunk.bytes);
    let value = read(&mut reader);
    value
        .and_then(|value| reader.end().map(|()| value))
        .map_err(|malformed| ReplayError::Malformed { chunk: number, malformed })
}

/// Refuses a chunk that was changed, and names the change. `tick` is the tick of the world after the chunks before.
pub(super) fn check_unchanged(
    chunk: &Chunk,
    number: u32,
    tick: u64,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<(), ReplayError> {
    let Some(damage) = chunk.damage else { return Ok(()) };
    let in_frame = |part: &str, left: Option<String>, right: Option<String>| Difference {
        tick,
        phase: if matches!(chunk.tag, TICKS | NAMES | DONE) { TickPhase::End } else { TickPhase::Start },
        owner: Owner::World,
        name: None,
        key: 0,
        field: format!("chunk {number}.{part}"),
        left,
        right,
    };
    let difference = match damage {
        Damage::Word { recorded, computed, double } => {
            let [left, right] = [recorded, computed].map(|word| Some(format!("{word:016x}")));
            in_frame(if double { "word again" } else { "word" }, left, right)
        }
        Damage::Seal { part, recorded, computed } => {
            in_frame(&format!("seal.{part}"), Some(recorded.to_string()), Some(computed.to_string()))
        }
        Damage::Bytes { at, word } => {
            let malformed = Malformed { at: at as u64, expected: "a chunk of this format" };
            let error = ReplayError::Malformed { chunk: number, malformed };
            changed_value(chunk, at, word, tick, custom_forces).ok_or(error)?
        }
        Damage::Unknown => in_frame("bytes", None, None),
    };
    Err(ReplayError::Tampered(Box::new(difference)))
}

/// Names the value that was changed in the word at `at`, where the file has `word`. The bytes of the chunk are the recorded
/// ones.
fn changed_value(
    chunk: &Chunk,
    at: usize,
    word: u64,
    tick: u64,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Option<Difference> {
    let mut changed = chunk.bytes.clone();
    let length = 8.min(changed.len() - at);
    changed[at..at + length].copy_from_slice(&word.to_le_bytes()[..length]);
    let first = (at..at + length).find(|&i| changed[i] != chunk.bytes[i])?;
    let (value, content) = find_value(chunk, &chunk.bytes, custom_forces, Wanted::At(first))?;
    let value = value?;
    let (tick, phase, owner, field) = content.locate(tick, &value.path);
    // At most one world at a time is in memory.
    drop(content);
    let bytes = changed.get(value.at..value.at + value.bytes.len())?;
    let hex = || bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    // The changed bytes as a value, if they are one; otherwise in hexadecimal. So too if the text is the same: reading
    // computes hashes anew, and it is their bytes that were changed.
    let right = find_value(chunk, &changed, custom_forces, Wanted::On(value.path.clone())).and_then(|(value, _)| value);
    let right = right.filter(|right| right.text != value.text).map_or_else(hex, |right| right.text);
    let (left, right) = (Some(value.text), Some(right));
    Some(Difference { tick, phase, owner, name: None, key: 0, field, left, right })
}

/// The content of a chunk.
enum Content<'a> {
    /// Values of the file as a whole.
    File(TickPhase),
    World(Box<World>, TickPhase),
    Ticks(Segment<'a>),
}

impl Content<'_> {
    /// The tick, phase and owner of the value at a path, and its name. `tick` is the tick of the world after the chunks
    /// before.
    fn locate(&self, tick: u64, path: &[Part]) -> (u64, TickPhase, Owner, String) {
        match self {
            Self::File(phase) => (tick, *phase, Owner::World, name_of(path)),
            Self::World(world, phase) => {
                let (owner, path) = world.owner_of(path);
                (tick, *phase, owner, name_of(path))
            }
            Self::Ticks(segment) => match *path {
                [Part::Name("ticks"), Part::Entry(i), ..] => {
                    let locate = |tick: Tick<'_>| owner_in_tick(&tick, &path[2..]);
                    let tick = segment.ticks().nth(i as usize);
                    let (phase, owner) = tick.map_or((TickPhase::End, Owner::World), locate);
                    (segment.tick.saturating_add(i.into()), phase, owner, name_of(&path[2..]))
                }
                _ => (segment.tick, TickPhase::Start, Owner::World, name_of(path)),
            },
        }
    }
}

/// The content of a chunk if it had these bytes, and the wanted value of it, if there is one.
fn find_value<'a>(
    chunk: &Chunk,
    bytes: &'a [u8],
    custom_forces: &[Arc<dyn CustomForce>],
    wanted: Wanted,
) -> Option<(Option<FieldValue>, Content<'a>)> {
    let mut reader = Reader::new(bytes);
    Some(match chunk.tag {
        HEAD => (FieldIndex::find(&Head::read(&mut reader).ok()?, wanted), Content::File(TickPhase::Start)),
        DONE => (FieldIndex::find(&Done::read(&mut reader).ok()?, wanted), Content::File(TickPhase::End)),
        NAMES => (FieldIndex::find(&Labels::read(&mut reader).ok()?, wanted), Content::File(TickPhase::End)),
        SNAPSHOT => {
            let world = read_unsealed(&mut reader, custom_forces).ok()?;
            (FieldIndex::find(&Saved(&world), wanted), Content::World(Box::new(world), TickPhase::Start))
        }
        TICKS => {
            let segment = Segment::read(&mut reader).ok()?;
            (FieldIndex::find(&segment, wanted), Content::Ticks(segment))
        }
        VERSION => (FieldIndex::find(&u32::read(&mut reader).ok()?, wanted), Content::File(TickPhase::Start)),
        PHASE => {
            let phase = TickPhase::read(&mut reader).ok()?;
            let is_new = bool::read(&mut reader).ok()?;
            let world = if is_new { read_unsealed(&mut reader, custom_forces).ok() } else { None };
            let value = FieldIndex::find(&PhaseState { phase, world: world.as_ref() }, wanted);
            (value, world.map_or(Content::File(phase), |world| Content::World(Box::new(world), phase)))
        }
        _ => return None,
    })
}
