//! Replays: read and compared.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::LAW;
use super::chunk::{self, Chunk};
use super::damage::{malformed, sound, whole};
use super::difference::{Place, name_of};
use super::error::ReplayError;
use super::file::{DONE, Done, HEAD, Head, REPLAY, SNAPSHOT, Segment, TICKS, Tick};
use super::finding::{Finding, Moment};
use super::playback::{Divergence, Playback};
use super::snapshot;
use crate::force::ForceLaw;
use crate::wire::{Index, Leaf, Part, Reader};
use crate::world::{Command, World};

/// A recorded run: the world it began with, what was done tick by tick, and the hashes that came of it.
#[derive(Clone, Debug)]
pub struct Replay {
    pub(super) head: Head,
    pub(super) start: World,
    pub(super) ticks: Vec<Tick>,
    /// The later ones, by their ticks.
    pub(super) snapshots: Vec<World>,
    pub(super) done: Option<Done>,
}

impl Replay {
    /// Reads a file, of a world in which these laws of force may act.
    ///
    /// Every bit of it is checked: one that was changed is found, and named with what it was and what it is.
    ///
    /// # Errors
    /// A [`ReplayError`].
    pub fn from_bytes(bytes: &[u8], laws: &[Arc<dyn ForceLaw>]) -> Result<Self, ReplayError> {
        let (replay, error) = Self::read(bytes, laws)?;
        error.map_or(Ok(replay), Err)
    }

    /// Reads a file that may be cut off: what is whole of it, at least up to the first snapshot.
    ///
    /// # Errors
    /// A [`ReplayError`] for what is not just cut off.
    pub fn recovered(bytes: &[u8], laws: &[Arc<dyn ForceLaw>]) -> Result<Self, ReplayError> {
        match Self::read(bytes, laws)? {
            (replay, None | Some(ReplayError::CutOff { .. })) => Ok(replay),
            (_, Some(error)) => Err(error),
        }
    }

    /// What could be read after the first snapshot, and why no more.
    fn read(bytes: &[u8], laws: &[Arc<dyn ForceLaw>]) -> Result<(Self, Option<ReplayError>), ReplayError> {
        let mut reader = Reader::new(bytes);
        REPLAY.enter(&mut reader)?;
        let Some(first) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: 0 }) };
        let head = Self::read_head(&first, laws)?;
        let Some(second) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: head.tick }) };
        let start = Self::read_start(&second, &head, laws)?;
        let mut replay = Self { head, start, ticks: Vec::new(), snapshots: Vec::new(), done: None };
        let mut number = 2;
        while replay.done.is_none() {
            let Some(chunk) = chunk::read(&mut reader) else {
                let error = ReplayError::CutOff { tick: replay.end() };
                return Ok((replay, Some(error)));
            };
            if let Err(error) = replay.read_chunk(chunk, number, laws) {
                return Ok((replay, Some(error)));
            }
            number += 1;
        }
        let left_over = reader.end().err().map(|malformed| ReplayError::Malformed { chunk: number, malformed });
        Ok((replay, left_over))
    }

    fn read_head(chunk: &Chunk, laws: &[Arc<dyn ForceLaw>]) -> Result<Head, ReplayError> {
        sound(chunk, 0, 0, laws)?;
        if chunk.tag != HEAD {
            return Err(malformed(0, "the head"));
        }
        let head: Head = whole(chunk, 0)?;
        if head.law != LAW {
            return Err(ReplayError::Law { found: head.law, own: LAW });
        }
        if head.hash_every == 0 {
            return Err(malformed(0, "a number of ticks from 1"));
        }
        Ok(head)
    }

    fn read_start(chunk: &Chunk, head: &Head, laws: &[Arc<dyn ForceLaw>]) -> Result<World, ReplayError> {
        sound(chunk, 1, head.tick, laws)?;
        if chunk.tag != SNAPSHOT {
            return Err(malformed(1, "a snapshot"));
        }
        let start = read_snapshot(chunk, 1, laws)?;
        if start.tick() == head.tick { Ok(start) } else { Err(malformed(1, "the snapshot of the first tick")) }
    }

    fn read_chunk(&mut self, chunk: Chunk, number: u32, laws: &[Arc<dyn ForceLaw>]) -> Result<(), ReplayError> {
        let malformed = |expected| malformed(number, expected);
        sound(&chunk, number, self.end(), laws)?;
        match chunk.tag {
            TICKS => {
                let segment: Segment = whole(&chunk, number)?;
                let room = u64::MAX - self.end();
                if segment.tick != self.end() || segment.ticks.is_empty() || segment.ticks.len() as u64 > room {
                    return Err(malformed("the ticks that follow"));
                }
                self.ticks.extend(segment.ticks);
            }
            SNAPSHOT => {
                let world = read_snapshot(&chunk, number, laws)?;
                let is_next = self.snapshots.last().is_none_or(|last| last.tick() < world.tick());
                if world.tick() != self.end() || !is_next {
                    return Err(malformed("the snapshot of this tick"));
                }
                self.snapshots.push(world);
            }
            DONE => {
                let done: Done = whole(&chunk, number)?;
                if done.tick != self.end() {
                    return Err(malformed("the tick it ends at"));
                }
                self.done = Some(done);
            }
            _ => return Err(malformed("a chunk of this format")),
        }
        Ok(())
    }

    /// The world it begins with.
    #[must_use]
    pub fn start(&self) -> &World {
        &self.start
    }

    /// The tick its world is at after the last of its ticks.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.head.tick + self.ticks.len() as u64
    }

    /// Whether the recording was brought to its end.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.done.is_some()
    }

    /// The later snapshot of a tick: their ticks rise.
    pub(super) fn snapshot_at(&self, tick: u64) -> Option<&World> {
        let index = self.snapshots.binary_search_by_key(&tick, World::tick).ok()?;
        self.snapshots.get(index)
    }

    /// Plays it from its start.
    #[must_use]
    pub fn play(&self) -> Playback<'_> {
        Playback::new(self)
    }

    /// Runs all of it again, and compares every hash.
    ///
    /// # Errors
    /// A [`Divergence`] at the first hash that is another.
    pub fn verify(&self) -> Result<(), Box<Divergence>> {
        let mut playback = self.play();
        while playback.step()? {}
        Ok(())
    }

    /// The first value in which the runs of two replays are not the same: what they begin with, what is done, or what
    /// was recorded of it. `None` if they are the same as far as both go.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<Finding> {
        let tick = self.head.tick;
        if let Some(found) = self.start.differences(&other.start).into_iter().next() {
            return Some(Finding::at(tick, Moment::Start, found));
        }
        for (i, (ours, theirs)) in self.ticks.iter().zip(&other.ticks).enumerate() {
            let tick = tick + i as u64;
            if let Some(finding) = doings_differ(tick, ours, theirs) {
                return Some(finding);
            }
            if let (Some(a), Some(b)) = (ours.hash, theirs.hash) {
                if a != b {
                    return Some(self.named_at_a_snapshot(other, tick, a, b));
                }
            }
        }
        None
    }

    /// The first value in which the snapshots of two replays differ from this tick on.
    fn named_at_a_snapshot(&self, other: &Self, tick: u64, ours: u64, theirs: u64) -> Finding {
        let later = self.snapshots.iter().filter(|world| world.tick() > tick);
        let differs = later.into_iter().find_map(|world| {
            let there = other.snapshot_at(world.tick())?;
            let found = world.differences(there).into_iter().next()?;
            Some(Finding::at(world.tick() - 1, Moment::End, found))
        });
        differs.unwrap_or_else(|| Finding::of_hashes(tick, ours, theirs))
    }
}

/// In what that which is done in a tick differs.
pub(super) fn doings_differ(tick: u64, ours: &Tick, theirs: &Tick) -> Option<Finding> {
    if ours.calls == theirs.calls && ours.inputs == theirs.inputs {
        return None;
    }
    let silent = |tick: &Tick| Index::of(&Tick { hash: None, ..tick.clone() }).leaves;
    let (left, right) = (silent(ours), silent(theirs));
    let same = left.iter().zip(&right).take_while(|(a, b)| a == b).count();
    let (a, b) = (left.get(same), right.get(same));
    let path = a.or(b).map(|leaf| &leaf.path[..]).unwrap_or_default();
    let (moment, place) = place_in_tick(ours, path);
    let text = |leaf: Option<&Leaf>| leaf.filter(|leaf| leaf.path == path).map(|leaf| leaf.text.clone());
    Some(Finding { tick, moment, place, field: name_of(path), recorded: text(a), found: text(b) })
}

/// When in a tick the value at a path of it is, and the body or field that its command is about.
pub(super) fn place_in_tick(tick: &Tick, path: &[Part]) -> (Moment, Place) {
    let place = |command: Option<&Command>| command.map_or(Place::World, Place::of_command);
    match *path {
        [Part::Name("calls"), Part::Entry(i), ..] => (Moment::Calls, place(tick.calls.get(i as usize))),
        [Part::Name("calls"), ..] => (Moment::Calls, Place::World),
        [Part::Name("inputs"), Part::Entry(i), ..] => {
            (Moment::Inputs, place(tick.inputs.iter().nth(i as usize).map(|input| &input.command)))
        }
        [Part::Name("inputs"), ..] => (Moment::Inputs, Place::World),
        _ => (Moment::End, Place::World),
    }
}

impl Place {
    /// What a command is about.
    fn of_command(command: &Command) -> Self {
        match *command {
            Command::RemoveBody(body)
            | Command::Apply { body, .. }
            | Command::SetPosition { body, .. }
            | Command::SetAngle { body, .. }
            | Command::SetVelocity { body, .. }
            | Command::SetAngularVelocity { body, .. }
            | Command::SetMass { body, .. }
            | Command::SetShape { body, .. }
            | Command::SetKind { body, .. }
            | Command::SetGravityScale { body, .. }
            | Command::SetBodyDamping { body, .. }
            | Command::SetGroups { body, .. }
            | Command::SetKey { body, .. }
            | Command::SetUserData { body, .. }
            | Command::Wake(body)
            | Command::Release(body) => Self::Body(body),
            Command::SetField { id, .. } | Command::RemoveField(id) => Self::Field(id),
            Command::AddBody(_)
            | Command::AddField(_)
            | Command::SetTimeStep(_)
            | Command::SetGravity(_)
            | Command::SetIntegrator(_)
            | Command::SetDamping { .. }
            | Command::SetSleepAfter(_)
            | Command::SetRandom(_)
            | Command::SetBlob(_)
            | Command::ClearForces => Self::World,
        }
    }
}

fn read_snapshot(chunk: &Chunk, number: u32, laws: &[Arc<dyn ForceLaw>]) -> Result<World, ReplayError> {
    let mut reader = Reader::new(&chunk.bytes);
    let world = snapshot::read(&mut reader, laws).and_then(|world| {
        reader.end()?;
        Ok(world)
    });
    world.map_err(|error| ReplayError::Snapshot { chunk: number, error })
}
