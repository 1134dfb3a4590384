//! Desync dumps: one tick with all that is known of it, to be laid beside that of another machine.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::PHYSICS_VERSION;
use super::chunk::{self, Chunk, Tag};
use super::damage::{malformed, sound, whole};
use super::error::{ReplayError, SnapshotError};
use super::file::{DONE, DUMP, Doings, Done, Segment, TICKS, Tick};
use super::finding::{Finding, TickPhase};
use super::replay::doings_differ;
use super::snapshot::{self, Saved};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::force::CustomForce;
use crate::integrate::StageKind;
use crate::world::{Command, Inputs, World};

/// The laws it was made under.
pub(super) const LAWS: Tag = Tag(*b"LAWS");
/// A moment, and the world then if it is another than at the moment before.
pub(super) const MOMENT: Tag = Tag(*b"MOMT");

/// A tick from the snapshot before it to the world after it: what was done, and the world after each stage.
///
/// When peers find at a tick that their hashes differ, each writes one of that tick, from a snapshot of the last they
/// agreed on; [`first_difference`](Self::first_difference) of the two, or `umbra diff`, names the first value that is not
/// the same on both.
///
/// ```
/// use umbra_physics::{BodyDef, Dump, Inputs, TickPhase, StageKind, World, WorldDef, fx, vec2};
///
/// let mut here: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ball = here.add_body(BodyDef::dynamic())?;
/// let mut there = here.clone();
/// there.set_gravity(vec2(0, -9))?; // a peer with another level
///
/// let [before_here, before_there] = [here.snapshot(), there.snapshot()];
/// here.step();
/// there.step();
/// assert_ne!(here.state_hash(), there.state_hash());
/// let ours = Dump::of_tick(before_here.world(), &[], &Inputs::new(), &here);
/// let theirs = Dump::of_tick(before_there.world(), &[], &Inputs::new(), &there);
/// let found = ours.first_difference(&theirs).unwrap();
/// assert_eq!((found.tick, found.phase), (0, TickPhase::Start));
/// assert_eq!(found.field, "settings.gravity.y");
/// assert_eq!(found.recorded.as_deref(), Some("-10"));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dump {
    /// What was done, as it stands in the file.
    done: Vec<u8>,
    /// Moments at which the world was the same share it.
    phases: Vec<(TickPhase, Arc<World>)>,
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
            codec::field(out, "verb", &kind);
        }
    }
}

impl Read for TickPhase {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("the number of a moment");
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

impl Dump {
    /// Makes a tick once more from the world before it, looked at stage by stage; `after` is what it led to in the match.
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
        Self::of_step(before, called, world, after, &Doings { calls, inputs, hash: Some(after.state_hash()) })
    }

    /// The same for a game that does more than inputs say: `act` is all it does to its world in the tick before it steps.
    #[must_use]
    pub fn of_game(before: &World, act: impl FnOnce(&mut World), after: &World) -> Self {
        let mut world = before.clone();
        act(&mut world);
        let done = Doings { calls: &[], inputs: &Inputs::new(), hash: Some(after.state_hash()) };
        Self::of_step(before, world.clone(), world, after, &done)
    }

    fn of_step(before: &World, called: World, mut world: World, after: &World, done: &Doings<'_>) -> Self {
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

    /// The world at each moment of the tick, from its start to its end.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Dump, Inputs, TickPhase, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef { gravity: vec2(0, -60), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let before = world.clone();
    /// world.step();
    /// for (phase, then) in Dump::of_tick(&before, &[], &Inputs::new(), &world).phases() {
    ///     println!("{moment}: {:.3}", then.body(ball)?.velocity()); // 0 at the start, −1 at the end
    /// }
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn phases(&self) -> impl ExactSizeIterator<Item = (TickPhase, &World)> {
        self.phases.iter().map(|(phase, world)| (*phase, &**world))
    }

    /// The tick the world was at before.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.phases.first().map_or(0, |(_, world)| world.tick())
    }

    /// The first value in which two machines were not the same in this tick: in the world before, in what was done, after
    /// a stage, or at the end alone, if either computes another thing now than it did then. `None` if they were the same.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<Finding> {
        let tick = self.tick();
        let mut theirs = other.phases.iter();
        for (phase, world) in &self.phases {
            if *phase == TickPhase::Calls {
                // They were made as ticks, or read as such.
                let [ours, theirs] = [self, other].map(|dump| Tick::read(&mut Reader::new(&dump.done)));
                let parting = ours.ok().zip(theirs.ok()).and_then(|(ours, theirs)| doings_differ(tick, &ours, &theirs));
                if parting.is_some() {
                    return parting;
                }
            }
            let Some((there, other)) = theirs.next() else { break };
            // Stages that are not the same come from settings that are not, and these were compared before.
            if phase != there {
                break;
            }
            if let Some(found) = world.first_difference(other) {
                return Some(Finding::at(tick, *phase, found));
            }
        }
        None
    }

    /// As bytes to mail, the same on every machine; `docs/formats.md` has them one by one.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut file = DUMP.begin();
        chunk::write(&mut file, LAWS, &PHYSICS_VERSION.to_le_bytes());
        let mut bytes = Vec::new();
        // A segment of one tick.
        self.tick().write(&mut bytes);
        1u32.write(&mut bytes);
        bytes.extend_from_slice(&self.done);
        chunk::write(&mut file, TICKS, &bytes);
        let mut last = None;
        for (phase, world) in &self.phases {
            let mut saved = Vec::new();
            Saved(&**world).write(&mut saved);
            bytes.clear();
            let is_new = last.as_ref() != Some(&saved);
            Instant { phase: *phase, world: is_new.then_some(&**world) }.write(&mut bytes);
            chunk::write(&mut file, MOMENT, &bytes);
            last = Some(saved);
        }
        bytes.clear();
        let end = self.phases.last().map_or(0, |(_, world)| world.state_hash());
        Done { tick: self.tick(), hash: end }.write(&mut bytes);
        chunk::write(&mut file, DONE, &bytes);
        file
    }

    /// The dump that is these bytes, of a world in which these laws of force may act. Reading takes at most 16 bytes of memory
    /// for each of theirs and 64 KiB.
    ///
    /// # Errors
    /// A [`ReplayError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        let mut reader = Reader::new(bytes);
        DUMP.enter(&mut reader)?;
        let mut number = 0;
        let mut next = |tag: Option<Tag>| -> Result<(Chunk, u32), ReplayError> {
            let chunk = chunk::read(&mut reader).ok_or(ReplayError::CutOff { tick: 0 })?;
            number += 1;
            sound(&chunk, number - 1, 0, custom_forces)?;
            match tag {
                Some(tag) if tag != chunk.tag => Err(malformed(number - 1, "another chunk")),
                _ => Ok((chunk, number - 1)),
            }
        };
        let (chunk, at) = next(Some(LAWS))?;
        match whole(&chunk, at, u32::read)? {
            PHYSICS_VERSION => {}
            found => return Err(ReplayError::PhysicsVersion { found, own: PHYSICS_VERSION }),
        }
        let (chunk, at) = next(Some(TICKS))?;
        let mut hash = None;
        let look = |tick: &Tick<'_>, _| {
            hash = tick.hash;
            Ok(())
        };
        let Segment { tick, count, .. } = whole(&chunk, at, |reader| Segment::read_and(reader, look))?;
        if count != 1 {
            return Err(malformed(at, "one tick"));
        }
        let mut done = chunk.bytes;
        done.drain(..Segment::HEAD);
        let mut phases: Vec<(TickPhase, Arc<World>)> = Vec::new();
        let mut saved = Vec::new();
        loop {
            let (chunk, at) = next(None)?;
            match chunk.tag {
                MOMENT => {
                    let phase = read_moment(chunk, at, &phases, &mut saved, custom_forces)?;
                    phases.push(phase);
                }
                DONE => {
                    let end = whole(&chunk, at, Done::read)?;
                    let is_it = |(_, world): &(TickPhase, Arc<World>)| world.state_hash() == end.hash;
                    let starts = phases.first().is_some_and(|(_, world)| world.tick() == tick);
                    if next_moment(&phases).is_some() {
                        return Err(malformed(at, "the next moment"));
                    }
                    if !(starts && end.tick == tick && hash == Some(end.hash) && phases.last().is_some_and(is_it)) {
                        return Err(malformed(at, "the tick, and the hash of its end, which the ticks have too"));
                    }
                    break;
                }
                _ => return Err(malformed(at, "a moment")),
            }
        }
        reader.end().map_err(|malformed| ReplayError::Malformed { chunk: number, malformed })?;
        Ok(Self { done, phases })
    }
}

/// A moment as it is written: with the world, if it is another than at the moment before.
pub(super) struct Instant<'a> {
    pub(super) phase: TickPhase,
    pub(super) world: Option<&'a World>,
}

impl Write for Instant<'_> {
    fn write(&self, out: &mut impl Encoder) {
        let Self { phase, world } = self;
        codec::field(out, "moment", phase);
        codec::field(out, "is_new", &world.is_some());
        if let Some(world) = world {
            Saved(*world).write(out);
        }
    }
}

/// The moment that comes after these. A tick has a few, each once.
fn next_moment(before: &[(TickPhase, Arc<World>)]) -> Option<TickPhase> {
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

/// A moment after these, and the world then; `saved` has the bytes of the world before.
fn read_moment(
    chunk: Chunk,
    number: u32,
    before: &[(TickPhase, Arc<World>)],
    saved: &mut Vec<u8>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<(TickPhase, Arc<World>), ReplayError> {
    let mut bytes = chunk.bytes;
    let mut reader = Reader::new(&bytes);
    let mut read = || -> Result<(TickPhase, Arc<World>, usize), SnapshotError> {
        let malformed = reader.malformed("the next moment");
        let phase = TickPhase::read(&mut reader)?;
        if next_moment(before) != Some(phase) {
            return Err(malformed.into());
        }
        let malformed = reader.malformed("whether the world is another than before, and if so that world");
        let (is_new, start) = (bool::read(&mut reader)?, reader.at());
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
