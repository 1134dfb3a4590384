//! What is wrong with a chunk: named by the value in it, where one was changed.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::sync::Arc;

use super::chunk::{Chunk, Damage};
use super::difference::{Owner, name_of};
use super::dump::{Instant, LAWS, MOMENT};
use super::error::ReplayError;
use super::file::{DONE, Done, HEAD, Head, SNAPSHOT, Segment, TICKS, Tick};
use super::finding::{Finding, TickPhase};
use super::replay::place_in_tick;
use super::snapshot::{self, Saved};
use crate::codec::{FieldIndex, FieldValue, Malformed, Part, Read, Reader, Wanted};
use crate::force::CustomForce;
use crate::world::World;

/// What is wrong with a chunk as a whole.
pub(super) fn malformed(chunk: u32, expected: &'static str) -> ReplayError {
    ReplayError::Malformed { chunk, malformed: Malformed { at: 0, expected } }
}

/// The value that a chunk is.
pub(super) fn whole<'a, T>(
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

/// Refuses a chunk that was changed, and says in what. `tick` is the one the chunks before it lead up to.
pub(super) fn sound(
    chunk: &Chunk,
    number: u32,
    tick: u64,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<(), ReplayError> {
    let Some(damage) = chunk.damage else { return Ok(()) };
    let in_frame = |part: &str, recorded: String, found: String| Finding {
        tick,
        phase: if matches!(chunk.tag, TICKS | DONE) { TickPhase::End } else { TickPhase::Start },
        place: Owner::World,
        field: format!("chunk {number}.{part}"),
        recorded: Some(recorded),
        found: Some(found),
    };
    let finding = match damage {
        Damage::Word { recorded, found, double } => {
            let part = if double { "word again" } else { "word" };
            in_frame(part, format!("{recorded:016x}"), format!("{found:016x}"))
        }
        Damage::Seal { part, recorded, found } => {
            in_frame(&format!("seal.{part}"), recorded.to_string(), found.to_string())
        }
        Damage::Bytes { at, found } => match changed_leaf(chunk, at, found, tick, custom_forces) {
            Some(finding) => finding,
            None => {
                return Err(ReplayError::Malformed {
                    chunk: number,
                    malformed: Malformed { at: at as u64, expected: "a chunk of this format" },
                });
            }
        },
        Damage::Unknown => Finding { recorded: None, found: None, ..in_frame("bytes", String::new(), String::new()) },
    };
    Err(ReplayError::Tampered(Box::new(finding)))
}

/// Names the value in the word at `at` that was changed to what is found; the chunk's bytes are what was recorded.
fn changed_leaf(
    chunk: &Chunk,
    at: usize,
    found: u64,
    tick: u64,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Option<Finding> {
    let mut there = chunk.bytes.clone();
    let length = 8.min(there.len() - at);
    there[at..at + length].copy_from_slice(&found.to_le_bytes()[..length]);
    let first = (at..at + length).find(|&i| there[i] != chunk.bytes[i])?;
    let (leaf, subject) = tell(chunk, &chunk.bytes, custom_forces, Wanted::At(first))?;
    let leaf = leaf?;
    // One world at a time.
    let (tick, phase, place, field) = subject.place(tick, &leaf.path);
    drop(subject);
    let found_bytes = there.get(leaf.at..leaf.at + leaf.bytes.len())?;
    let hex = || found_bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    // What is there as a value, if it is one; else its bytes.
    let value = tell(chunk, &there, custom_forces, Wanted::On(leaf.path.clone())).and_then(|(leaf, _)| leaf);
    // A hash of what is there was made new; it is its bytes that were changed.
    let value = value.filter(|value| value.text != leaf.text).map_or_else(hex, |value| value.text);
    Some(Finding { tick, phase, place, field, recorded: Some(leaf.text), found: Some(value) })
}

/// What a chunk is about.
enum Subject<'a> {
    File(TickPhase),
    World(Box<World>, TickPhase),
    Ticks(Segment<'a>),
}

impl Subject<'_> {
    /// Where the value at a path belongs, and its name there. `tick` is the one the chunks before lead up to.
    fn place(&self, tick: u64, path: &[Part]) -> (u64, TickPhase, Owner, String) {
        match self {
            Self::File(phase) => (tick, *phase, Owner::World, name_of(path)),
            Self::World(world, phase) => {
                let (place, path) = world.place(path);
                (world.tick(), *phase, place, name_of(path))
            }
            Self::Ticks(segment) => match *path {
                [Part::Name("ticks"), Part::Entry(i), ..] => {
                    let at = |tick: Tick<'_>| place_in_tick(&tick, &path[2..]);
                    let (phase, place) = segment.ticks().nth(i as usize).map_or((TickPhase::End, Owner::World), at);
                    (segment.tick.saturating_add(i.into()), phase, place, name_of(&path[2..]))
                }
                _ => (segment.tick, TickPhase::Start, Owner::World, name_of(path)),
            },
        }
    }
}

/// A value that a chunk has, if there is such a one, and what the chunk is about.
fn tell<'a>(
    chunk: &Chunk,
    bytes: &'a [u8],
    custom_forces: &[Arc<dyn CustomForce>],
    wanted: Wanted,
) -> Option<(Option<FieldValue>, Subject<'a>)> {
    let mut reader = Reader::new(bytes);
    Some(match chunk.tag {
        HEAD => (FieldIndex::find(&Head::read(&mut reader).ok()?, wanted), Subject::File(TickPhase::Start)),
        DONE => (FieldIndex::find(&Done::read(&mut reader).ok()?, wanted), Subject::File(TickPhase::End)),
        SNAPSHOT => {
            let world = snapshot::read_unsealed(&mut reader, custom_forces).ok()?;
            (FieldIndex::find(&Saved(&world), wanted), Subject::World(Box::new(world), TickPhase::Start))
        }
        TICKS => {
            let segment = Segment::read(&mut reader).ok()?;
            (FieldIndex::find(&segment, wanted), Subject::Ticks(segment))
        }
        LAWS => (FieldIndex::find(&u32::read(&mut reader).ok()?, wanted), Subject::File(TickPhase::Start)),
        MOMENT => {
            let phase = TickPhase::read(&mut reader).ok()?;
            let world = if bool::read(&mut reader).ok()? {
                snapshot::read_unsealed(&mut reader, custom_forces).ok()
            } else {
                None
            };
            let leaf = FieldIndex::find(&Instant { phase, world: world.as_ref() }, wanted);
            (leaf, world.map_or(Subject::File(phase), |world| Subject::World(Box::new(world), phase)))
        }
        _ => return None,
    })
}
