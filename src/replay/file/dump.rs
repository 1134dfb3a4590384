//! Desync dumps: one tick in full detail, to be compared with that of another machine.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::chunk::{self, Chunk, Tag};
use super::damage::{check_unchanged, read_whole};
use super::error::ReplayError;
use super::format::{DONE, DUMP, Done, PHASE, TICKS, VERSION, write_phase};
use super::ticks::{NewTick, Segment, Tick, tick_difference};
use crate::codec::{Read, Reader, Write};
use crate::force::CustomForce;
use crate::replay::diff::{Difference, TickPhase};
use crate::replay::snapshot::{self, PHYSICS_VERSION, Saved, SnapshotError};
use crate::world::{Command, Inputs, World};

/// One tick in full detail: the world before it, its calls and inputs, and the world after each stage.
///
/// When peers find that their hashes of a tick differ, each writes a dump of that tick, from a snapshot of the last tick they
/// agreed on. [`first_difference`](Self::first_difference) of the two, or `umbra diff`, names the first value that differs.
///
/// ```
/// use umbra_physics::{BodyDef, Dump, Inputs, TickPhase, StageKind, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ball = world.add_body(BodyDef::dynamic())?;
/// let mut peer = world.clone();
/// peer.set_gravity(vec2(0, -9))?; // a peer with another level
///
/// let [before, peer_before] = [world.snapshot(), peer.snapshot()];
/// world.step();
/// peer.step();
/// assert_ne!(world.state_hash(), peer.state_hash());
/// let ours = Dump::of_tick(before.world(), &[], &Inputs::new(), &world);
/// let theirs = Dump::of_tick(peer_before.world(), &[], &Inputs::new(), &peer);
/// let difference = ours.first_difference(&theirs).unwrap();
/// assert_eq!((difference.tick, difference.phase), (0, TickPhase::Start));
/// assert_eq!(difference.field, "settings.gravity.y");
/// assert_eq!(difference.left.as_deref(), Some("-10"));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dump {
    /// The calls and inputs, as they stand in the file.
    done: Vec<u8>,
    phases: Phases,
}

impl Dump {
    /// Makes a dump by repeating a tick from the world before it, stage by stage. `after` is the world it led to in the match.
    ///
    /// Calls come before inputs, as in a [`Recorder`](super::Recorder).
    #[must_use]
    pub fn of_tick(before: &World, calls: &[Command], inputs: &Inputs, after: &World) -> Self {
        let mut world = before.clone();
        for call in calls {
            _ = world.execute(call);
        }
        let called = world.clone();
        _ = world.carry_out(inputs);
        Self::of_step(before, called, world, after, &NewTick { calls, inputs, hash: Some(after.state_hash()) })
    }

    /// Makes a dump for a game that changes its world other than by inputs: `act` makes all changes of the tick before the
    /// step.
    #[must_use]
    pub fn of_game(before: &World, act: impl FnOnce(&mut World), after: &World) -> Self {
        let mut world = before.clone();
        act(&mut world);
        let done = NewTick { calls: &[], inputs: &Inputs::new(), hash: Some(after.state_hash()) };
        Self::of_step(before, world.clone(), world, after, &done)
    }

    fn of_step(before: &World, called: World, mut world: World, after: &World, done: &NewTick<'_>) -> Self {
        let mut phases = alloc::vec![(TickPhase::Start, before.clone()), (TickPhase::Calls, called)];
        phases.push((TickPhase::Inputs, world.clone()));
        let trace = world.step_traced();
        let stages = trace.stages().zip(0..);
        phases.extend(
            stages.map(|((stage, world), index)| (TickPhase::Stage { index, kind: stage.kind }, world.clone())),
        );
        phases.push((TickPhase::End, after.clone()));
        let mut bytes = Vec::new();
        done.write(&mut bytes);
        Self { done: bytes, phases: phases.into_iter().map(|(phase, world)| (phase, Arc::new(world))).collect() }
    }

    /// The world after each phase of the tick, from its start to its end.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Dump, Inputs, TickPhase, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -60), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let before = world.clone();
    /// world.step();
    /// for (phase, then) in Dump::of_tick(&before, &[], &Inputs::new(), &world).phases() {
    ///     println!("{phase}: {:.3}", then.body(ball)?.velocity()); // 0 at the start, −1 at the end
    /// }
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn phases(&self) -> impl ExactSizeIterator<Item = (TickPhase, &World)> {
        self.phases.iter().map(|(phase, world)| (*phase, &**world))
    }

    /// The dump with a change of the world after one of the phases.
    #[cfg(test)]
    pub(in crate::replay) fn with_world(&self, phase: usize, change: impl FnOnce(&mut World)) -> Self {
        let mut changed = self.clone();
        let mut world = (*changed.phases[phase].1).clone();
        change(&mut world);
        changed.phases[phase].1 = Arc::new(world);
        changed
    }

    /// The tick of the world before.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.phases.first().map_or(0, |(_, world)| world.tick())
    }

    /// The first value in which two machines differed in this tick: in the world before, in calls and inputs, after a stage,
    /// or only at the end, if one of them computes another result now than in the match. `None` if they were the same.
    #[must_use]
    pub fn first_difference(&self, rhs: &Self) -> Option<Difference> {
        let tick = self.tick();
        let mut theirs = rhs.phases.iter();
        for (phase, world) in &self.phases {
            if *phase == TickPhase::Calls {
                // These bytes were written by a tick, or read as one.
                let [ours, theirs] = [self, rhs].map(|dump| Tick::read(&mut Reader::new(&dump.done)));
                let difference =
                    ours.ok().zip(theirs.ok()).and_then(|(ours, theirs)| tick_difference(tick, &ours, &theirs));
                if difference.is_some() {
                    return difference;
                }
            }
            let Some((their_phase, their_world)) = theirs.next() else { break };
            // The stages differ only if the settings do, and those were compared before.
            if phase != their_phase {
                break;
            }
            if let Some(difference) = world.first_difference(their_world) {
                return Some(difference.at(tick, *phase));
            }
        }
        None
    }

    /// The dump as bytes, the same on every machine; `docs/formats.md` describes them one by one.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut file = DUMP.begin();
        chunk::write(&mut file, VERSION, &PHYSICS_VERSION.to_le_bytes());
        let mut bytes = Vec::new();
        // The chunk has one tick.
        self.tick().write(&mut bytes);
        1u32.write(&mut bytes);
        bytes.extend_from_slice(&self.done);
        chunk::write(&mut file, TICKS, &bytes);
        let mut last = Vec::new();
        for (phase, world) in &self.phases {
            let mut saved = Vec::new();
            Saved(&**world).write(&mut saved);
            bytes.clear();
            let is_new = last != saved;
            write_phase(&mut bytes, *phase, is_new);
            if is_new {
                bytes.extend_from_slice(&saved);
            }
            chunk::write(&mut file, PHASE, &bytes);
            last = saved;
        }
        bytes.clear();
        let end = self.phases.last().map_or(0, |(_, world)| world.state_hash());
        Done { tick: self.tick(), hash: end }.write(&mut bytes);
        chunk::write(&mut file, DONE, &bytes);
        file
    }

    /// Reads a dump from bytes. The custom forces that the world uses must be among those given. Reading takes at most 16 bytes
    /// of memory for each input byte and 64 KiB.
    ///
    /// # Errors
    /// A [`ReplayError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        let mut chunks = Chunks { reader: Reader::new(bytes), number: 0, tick: 0, custom_forces };
        DUMP.enter(&mut chunks.reader)?;
        let (chunk, at) = chunks.next_of(VERSION)?;
        match read_whole(&chunk, at, u32::read)? {
            PHYSICS_VERSION => {}
            version => return Err(ReplayError::PhysicsVersion { found: version, own: PHYSICS_VERSION }),
        }
        let (chunk, at) = chunks.next_of(TICKS)?;
        let mut hash = None;
        let look = |tick: &Tick<'_>, _| {
            hash = tick.hash;
            Ok(())
        };
        let Segment { tick, count, .. } = read_whole(&chunk, at, |reader| Segment::read_and(reader, look))?;
        if count != 1 {
            return Err(ReplayError::expected(at, "one tick"));
        }
        let mut done = chunk.bytes;
        done.drain(..Segment::HEAD);
        chunks.tick = tick;
        let phases = chunks.read_phases(hash)?;
        let number = chunks.number;
        chunks.reader.end().map_err(|malformed| ReplayError::Malformed { chunk: number, malformed })?;
        Ok(Self { done, phases })
    }
}

/// The phases of a tick, each with its world. Phases with the same world share it.
type Phases = Vec<(TickPhase, Arc<World>)>;

/// The chunks of a dump that are still to be read.
struct Chunks<'a> {
    reader: Reader<'a>,
    /// The number of chunks that were read.
    number: u32,
    /// The tick of the dump; 0 as long as it is unknown.
    tick: u64,
    custom_forces: &'a [Arc<dyn CustomForce>],
}

impl Chunks<'_> {
    /// Reads a chunk, and gives its number.
    fn next(&mut self) -> Result<(Chunk, u32), ReplayError> {
        let chunk = chunk::read(&mut self.reader).ok_or(ReplayError::CutOff { tick: self.tick })?;
        let number = self.number;
        self.number += 1;
        check_unchanged(&chunk, number, self.tick, self.custom_forces)?;
        Ok((chunk, number))
    }

    /// Reads a chunk with this tag.
    fn next_of(&mut self, tag: Tag) -> Result<(Chunk, u32), ReplayError> {
        let (chunk, number) = self.next()?;
        if chunk.tag == tag { Ok((chunk, number)) } else { Err(ReplayError::expected(number, "another chunk")) }
    }

    /// Reads the phases of the tick, after which the world has this hash.
    fn read_phases(&mut self, hash: Option<u64>) -> Result<Phases, ReplayError> {
        let tick = self.tick;
        let mut phases = Phases::new();
        let mut saved = Vec::new();
        loop {
            let (chunk, at) = self.next()?;
            match chunk.tag {
                PHASE => {
                    let phase = read_phase(chunk, at, &phases, &mut saved, self.custom_forces)?;
                    phases.push(phase);
                }
                DONE => {
                    let end = read_whole(&chunk, at, Done::read)?;
                    let is_end = |(_, world): &(TickPhase, Arc<World>)| world.state_hash() == end.hash;
                    let starts = phases.first().is_some_and(|(_, world)| world.tick() == tick);
                    if next_phase(&phases).is_some() {
                        return Err(ReplayError::expected(at, "the next phase"));
                    }
                    if !(starts && end.tick == tick && hash == Some(end.hash) && phases.last().is_some_and(is_end)) {
                        let expected = "the tick, and the hash of its end, which the ticks have too";
                        return Err(ReplayError::expected(at, expected));
                    }
                    return Ok(phases);
                }
                _ => return Err(ReplayError::expected(at, "a phase")),
            }
        }
    }
}

/// The phase after these. A tick has each phase once.
fn next_phase(before: &[(TickPhase, Arc<World>)]) -> Option<TickPhase> {
    Some(match before {
        [] => TickPhase::Start,
        [_] => TickPhase::Calls,
        [_, _] => TickPhase::Inputs,
        [_, _, (_, stepped), stages @ ..] => match stepped.def.integrator.stages().get(stages.len()) {
            Some(stage) => TickPhase::Stage { index: stages.len() as u32, kind: stage.kind },
            None if matches!(stages.last(), Some((TickPhase::End, _))) => return None,
            None => TickPhase::End,
        },
    })
}

/// Reads the phase after these, and its world; `saved` has the bytes of the world before.
fn read_phase(
    chunk: Chunk,
    number: u32,
    before: &[(TickPhase, Arc<World>)],
    saved: &mut Vec<u8>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<(TickPhase, Arc<World>), ReplayError> {
    let mut bytes = chunk.bytes;
    let mut reader = Reader::new(&bytes);
    let mut read = || -> Result<(TickPhase, Arc<World>, usize), SnapshotError> {
        let malformed = reader.malformed("the next phase");
        let phase = TickPhase::read(&mut reader)?;
        if next_phase(before) != Some(phase) {
            return Err(malformed.into());
        }
        let malformed = reader.malformed("whether the world is another than before, and if so that world");
        let is_new = bool::read(&mut reader)?;
        let start = reader.at();
        let world = match (is_new, before.last()) {
            (true, _) => Arc::new(snapshot::read(&mut reader, custom_forces)?),
            (false, Some((_, world))) => world.clone(),
            (false, None) => return Err(malformed.into()),
        };
        reader.end()?;
        if is_new && reader.since(start) == &saved[..] { Err(malformed.into()) } else { Ok((phase, world, start)) }
    };
    let read = read();
    let (phase, world, start) = read.map_err(|error| ReplayError::Snapshot { chunk: number, error })?;
    if start < bytes.len() {
        bytes.drain(..start);
        *saved = bytes;
    }
    Ok((phase, world))
}
