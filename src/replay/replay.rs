//! Replays: read, played, checked.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;

use super::LAW;
use super::chunk::{self, Chunk, Damage};
use super::difference::{Place, name_of};
use super::dump::{Instant, LAWS, MOMENT};
use super::file::{DONE, Done, FORMAT, HEAD, Head, MAGIC, SNAPSHOT, Segment, TICKS, Tick};
use super::finding::{Finding, Moment};
use super::snapshot::{self, Saved, SnapshotError};
use crate::force::ForceLaw;
use crate::wire::{Index, Leaf, Malformed, Part, Read, Reader, Wanted};
use crate::world::{Command, Outcome, World};

/// A recorded run: the world it began with, what was done tick by tick, and the hashes that came of it.
#[derive(Clone, Debug)]
pub struct Replay {
    head: Head,
    start: World,
    ticks: Vec<Tick>,
    /// The later ones, by their ticks.
    snapshots: Vec<World>,
    done: Option<Done>,
}

/// Why a file is no replay that this build can play.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReplayError {
    /// It is something else.
    Foreign,
    /// Its layout is another.
    Format {
        /// Its number.
        found: u32,
        /// The one this build knows.
        known: u32,
    },
    /// It was recorded under other laws of physics: it would go another way here.
    Law {
        /// Those it was recorded under.
        found: u32,
        /// Those of this build.
        own: u32,
    },
    /// It ends before the recording did. [`Replay::recovered`] reads what there is.
    CutOff {
        /// The tick up to which it is whole.
        tick: u64,
    },
    /// It was changed after it was recorded.
    Tampered(Box<Finding>),
    /// A chunk of it is not what it should be.
    Malformed {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// What is wrong, counted from the start of the chunk.
        malformed: Malformed,
    },
    /// A snapshot in it is none.
    Snapshot {
        /// The number of the chunk, from 0.
        chunk: u32,
        /// What is wrong with it.
        error: SnapshotError,
    },
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("not a replay of umbra-physics"),
            Self::Format { found, known } => write!(f, "a replay of format {found}; this build reads format {known}"),
            Self::Law { found, own } => {
                write!(f, "a replay recorded under law {found} of physics; this build has law {own}")
            }
            Self::CutOff { tick } => write!(f, "cut off: whole up to tick {tick}"),
            Self::Tampered(finding) => write!(f, "changed after it was recorded: {finding}"),
            Self::Malformed { chunk, malformed } => write!(f, "chunk {chunk}: {malformed}"),
            Self::Snapshot { chunk, error } => write!(f, "chunk {chunk}: {error}"),
        }
    }
}

impl core::error::Error for ReplayError {}

/// A run that is not the one recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// The tick the world was at with the first hash that is another one.
    pub tick: u64,
    /// The hash recorded.
    pub recorded: u64,
    /// The hash the run has.
    pub computed: u64,
    /// The first value that differs, at the next tick with a snapshot; the hash itself if none does there.
    pub finding: Finding,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, recorded, computed, finding } = self;
        write!(f, "at tick {tick} the hash is {computed:016x}, recorded was {recorded:016x}; {finding}")
    }
}

impl core::error::Error for Divergence {}

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
        if reader.take(MAGIC.len()).ok() != Some(&MAGIC) {
            return Err(ReplayError::Foreign);
        }
        match u32::read(&mut reader) {
            Ok(FORMAT) => {}
            Ok(found) => return Err(ReplayError::Format { found, known: FORMAT }),
            Err(_) => return Err(ReplayError::CutOff { tick: 0 }),
        }
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
    fn snapshot_at(&self, tick: u64) -> Option<&World> {
        let index = self.snapshots.binary_search_by_key(&tick, World::tick).ok()?;
        self.snapshots.get(index)
    }

    /// Plays it from its start.
    #[must_use]
    pub fn play(&self) -> Playback<'_> {
        Playback { replay: self, world: self.start.clone(), outcomes: Vec::new() }
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
fn place_in_tick(tick: &Tick, path: &[Part]) -> (Moment, Place) {
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

impl Finding {
    pub(super) fn at(tick: u64, moment: Moment, found: super::Difference) -> Self {
        let super::Difference { place, field, left, right } = found;
        Self { tick, moment, place, field, recorded: left, found: right }
    }

    fn of_hashes(tick: u64, recorded: u64, found: u64) -> Self {
        let hash = |hash: u64| Some(format!("{hash:016x}"));
        let (recorded, found) = (hash(recorded), hash(found));
        Self { tick, moment: Moment::End, place: Place::World, field: "hash".to_string(), recorded, found }
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

/// What is wrong with a chunk as a whole.
pub(super) fn malformed(chunk: u32, expected: &'static str) -> ReplayError {
    ReplayError::Malformed { chunk, malformed: Malformed { at: 0, expected } }
}

/// The value that a chunk is.
pub(super) fn whole<T: Read>(chunk: &Chunk, number: u32) -> Result<T, ReplayError> {
    let mut reader = Reader::new(&chunk.bytes);
    let value = T::read(&mut reader);
    value
        .and_then(|value| reader.end().map(|()| value))
        .map_err(|malformed| ReplayError::Malformed { chunk: number, malformed })
}

fn read_snapshot(chunk: &Chunk, number: u32, laws: &[Arc<dyn ForceLaw>]) -> Result<World, ReplayError> {
    let mut reader = Reader::new(&chunk.bytes);
    let world = snapshot::read(&mut reader, laws).and_then(|world| {
        reader.end()?;
        Ok(world)
    });
    world.map_err(|error| ReplayError::Snapshot { chunk: number, error })
}

/// Refuses a chunk that was changed, and says in what. `tick` is the one the chunks before it lead up to.
pub(super) fn sound(chunk: &Chunk, number: u32, tick: u64, laws: &[Arc<dyn ForceLaw>]) -> Result<(), ReplayError> {
    let Some(damage) = chunk.damage else { return Ok(()) };
    let in_frame = |part: &str, recorded: String, found: String| Finding {
        tick,
        moment: if matches!(chunk.tag, TICKS | DONE) { Moment::End } else { Moment::Start },
        place: Place::World,
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
        Damage::Bytes { at, found } => match changed_leaf(chunk, at, found, tick, laws) {
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
fn changed_leaf(chunk: &Chunk, at: usize, found: u64, tick: u64, laws: &[Arc<dyn ForceLaw>]) -> Option<Finding> {
    let mut there = chunk.bytes.clone();
    let length = 8.min(there.len() - at);
    there[at..at + length].copy_from_slice(&found.to_le_bytes()[..length]);
    let first = (at..at + length).find(|&i| there[i] != chunk.bytes[i])?;
    let (leaf, subject) = tell(chunk, &chunk.bytes, laws, Wanted::At(first))?;
    let leaf = leaf?;
    let found_bytes = there.get(leaf.at..leaf.at + leaf.bytes.len())?;
    let hex = || found_bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    // What is there as a value, if it is one; else its bytes.
    let value = tell(chunk, &there, laws, Wanted::On(leaf.path.clone())).and_then(|(leaf, _)| leaf);
    // A hash of what is there was made new; it is its bytes that were changed.
    let value = value.filter(|value| value.text != leaf.text).map_or_else(hex, |value| value.text);
    let (tick, moment, place, field) = subject.place(tick, &leaf.path);
    Some(Finding { tick, moment, place, field, recorded: Some(leaf.text), found: Some(value) })
}

/// What a chunk is about.
enum Subject {
    File(Moment),
    World(Box<World>, Moment),
    Ticks(Segment),
}

impl Subject {
    /// Where the value at a path belongs, and its name there. `tick` is the one the chunks before lead up to.
    fn place(&self, tick: u64, path: &[Part]) -> (u64, Moment, Place, String) {
        match self {
            Self::File(moment) => (tick, *moment, Place::World, name_of(path)),
            Self::World(world, moment) => {
                let (place, path) = world.place(path);
                (world.tick(), *moment, place, name_of(path))
            }
            Self::Ticks(segment) => match *path {
                [Part::Name("ticks"), Part::Entry(i), ..] => {
                    let none = Tick::default();
                    let (moment, place) = place_in_tick(segment.ticks.get(i as usize).unwrap_or(&none), &path[2..]);
                    (segment.tick.saturating_add(i.into()), moment, place, name_of(&path[2..]))
                }
                _ => (segment.tick, Moment::Start, Place::World, name_of(path)),
            },
        }
    }
}

/// A value that a chunk has, if there is such a one, and what the chunk is about.
fn tell(chunk: &Chunk, bytes: &[u8], laws: &[Arc<dyn ForceLaw>], wanted: Wanted) -> Option<(Option<Leaf>, Subject)> {
    let mut reader = Reader::new(bytes);
    Some(match chunk.tag {
        HEAD => (Index::find(&Head::read(&mut reader).ok()?, wanted), Subject::File(Moment::Start)),
        DONE => (Index::find(&Done::read(&mut reader).ok()?, wanted), Subject::File(Moment::End)),
        SNAPSHOT => {
            let world = snapshot::read_unsealed(&mut reader, laws).ok()?;
            (Index::find(&Saved(&world), wanted), Subject::World(Box::new(world), Moment::Start))
        }
        TICKS => {
            let segment = Segment::read(&mut reader).ok()?;
            (Index::find(&segment, wanted), Subject::Ticks(segment))
        }
        LAWS => (Index::find(&u32::read(&mut reader).ok()?, wanted), Subject::File(Moment::Start)),
        MOMENT => {
            let moment = Moment::read(&mut reader).ok()?;
            let world =
                if bool::read(&mut reader).ok()? { snapshot::read_unsealed(&mut reader, laws).ok() } else { None };
            let leaf = Index::find(&Instant { moment, world: world.as_ref() }, wanted);
            (leaf, world.map_or(Subject::File(moment), |world| Subject::World(Box::new(world), moment)))
        }
        _ => return None,
    })
}

/// A replay on its way.
#[derive(Clone, Debug)]
pub struct Playback<'a> {
    replay: &'a Replay,
    world: World,
    outcomes: Vec<Outcome>,
}

impl Playback<'_> {
    /// The world as it is now.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What is recorded of the tick to come; `None` at the end.
    fn tick(&self) -> Option<&Tick> {
        self.replay.ticks.get((self.world.tick() - self.replay.head.tick) as usize)
    }

    /// The commands of the tick to come: calls outside of inputs first.
    pub fn commands(&self) -> impl Iterator<Item = &Command> {
        let tick = self.tick();
        let calls = tick.into_iter().flat_map(|tick| &tick.calls);
        calls.chain(tick.into_iter().flat_map(|tick| &tick.inputs).map(|input| &input.command))
    }

    /// What became of the inputs of the last tick.
    #[must_use]
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The hash that was recorded for the world as it is now, if one was.
    #[must_use]
    pub fn recorded_hash(&self) -> Option<u64> {
        let made = (self.world.tick() - self.replay.head.tick) as usize;
        self.replay.ticks.get(made.checked_sub(1)?)?.hash
    }

    /// Does what was done in the tick, steps, and compares with what was recorded. `false` at the end, where nothing is
    /// done.
    ///
    /// # Errors
    /// A [`Divergence`]; the world is at that tick, and can go on.
    pub fn step(&mut self) -> Result<bool, Box<Divergence>> {
        let at = self.world.tick();
        if !self.advance() {
            return Ok(false);
        }
        let snapshot = self.replay.snapshot_at(at + 1);
        let done = self.replay.done.filter(|done| done.tick == at + 1);
        let recorded = [self.recorded_hash(), snapshot.map(World::state_hash), done.map(|done| done.hash)];
        let mut recorded = recorded.into_iter().flatten().peekable();
        if recorded.peek().is_none() {
            return Ok(true);
        }
        let computed = self.world.state_hash();
        recorded.find(|&hash| hash != computed).map_or(Ok(true), |hash| Err(Box::new(self.divergence(hash))))
    }

    /// The same without comparing.
    fn advance(&mut self) -> bool {
        let made = (self.world.tick() - self.replay.head.tick) as usize;
        let Some(tick) = self.replay.ticks.get(made) else { return false };
        for call in &tick.calls {
            // One that is refused was not recorded; refused here, it is found by the hash.
            _ = self.world.execute(call);
        }
        self.outcomes = self.world.carry_out(&tick.inputs);
        self.world.step();
        true
    }

    /// Goes to a tick, or to the end if that is before it: from the snapshot nearest before it, without comparing.
    pub fn seek(&mut self, tick: u64) {
        let snapshots = [&self.replay.start].into_iter().chain(&self.replay.snapshots);
        let nearest = snapshots.take_while(|world| world.tick() <= tick).last().unwrap_or(&self.replay.start);
        if self.world.tick() > tick || self.world.tick() < nearest.tick() {
            self.world.clone_from(nearest);
        }
        while self.world.tick() < tick && self.advance() {}
    }

    /// Finds out in what the run differs from the one recorded: that has its values in snapshots alone.
    fn divergence(&self, recorded: u64) -> Divergence {
        let (tick, computed) = (self.world.tick(), self.world.state_hash());
        let mut ahead = self.clone();
        let later = self.replay.snapshots.iter().filter(|snapshot| snapshot.tick() >= tick);
        let found = later.into_iter().find_map(|snapshot| {
            ahead.seek_on(snapshot.tick());
            let found = snapshot.differences(&ahead.world).into_iter().next()?;
            Some(Finding::at(snapshot.tick() - 1, Moment::End, found))
        });
        let finding = found.unwrap_or_else(|| Finding::of_hashes(tick - 1, recorded, computed));
        Divergence { tick, recorded, computed, finding }
    }

    fn seek_on(&mut self, tick: u64) {
        while self.world.tick() < tick && self.advance() {}
    }
}
