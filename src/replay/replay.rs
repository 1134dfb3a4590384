//! Replays: read and compared.

use alloc::boxed::Box;
use alloc::string::{String, ToString as _};
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::PHYSICS_VERSION;
use super::chunk::{self, Chunk};
use super::damage::{malformed, sound, whole};
use super::difference::{Owner, name_of};
use super::error::ReplayError;
use super::file::{DONE, Done, HEAD, Head, List, REPLAY, SNAPSHOT, Segment, TICKS, Tick};
use super::finding::{Finding, TickPhase};
use super::layout::{Next, Ticks, Writer};
use super::playback::{Divergence, Playback};
use super::snapshot;
use super::verify::{ReplayLimits, VerifyError};
use crate::codec::{FieldIndex, FieldValue, Part, Read, Reader, Write};
use crate::force::CustomForce;
use crate::world::{Command, World};

/// A recorded run: the world it began with, what was done tick by tick, and the hashes that came of it.
///
/// ```
/// use umbra_physics::{BodyDef, Command, Inputs, RecordOptions, Recorder, Replay, World, WorldDef, vec2};
///
/// let record = |turn: i32| {
///     let mut world: World = World::new(WorldDef::default())?;
///     let body = world.add_body(BodyDef::dynamic())?;
///     let mut recorder = Recorder::new(&world, RecordOptions::default());
///     for tick in 0..9 {
///         let mut inputs = Inputs::new();
///         inputs.replace(0, [Command::SetVelocity { body, velocity: vec2(if tick == 4 { turn } else { 1 }, 0) }]);
///         recorder.step(&mut world, &inputs);
///     }
///     Ok::<_, umbra_physics::Error>(recorder.finish(&world))
/// };
/// let [ours, theirs] = [record(1)?, record(2)?].map(|file| Replay::from_bytes(&file, &[]));
/// let found = ours?.first_difference(&theirs?).unwrap();
/// assert_eq!((found.tick, found.recorded.as_deref(), found.found.as_deref()), (4, Some("1"), Some("2")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Replay {
    pub(super) head: Head,
    pub(super) start: World,
    /// The contents of the chunks of ticks, in their order: what was done stays as it stands in the file.
    segments: Vec<Stretch>,
    /// How many ticks there are.
    pub(super) ticks: u64,
    /// The later ones, each after so many ticks: their numbers rise.
    snapshots: Vec<(u64, Box<World>)>,
    pub(super) done: Option<Done>,
}

/// Some ticks that follow each other.
#[derive(Clone, Debug)]
struct Stretch {
    /// How many are before.
    start: u64,
    count: u32,
    bytes: Vec<u8>,
}

/// A place between two ticks of a replay.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cursor {
    stretch: usize,
    /// How many ticks of it are behind, and where in its bytes the next one is.
    behind: u32,
    at: usize,
}

impl Replay {
    /// Reads a file, of a world in which these laws of force may act.
    ///
    /// Every bit of it is checked: one that was changed is found, and named with what it was and what it is. Reading takes at
    /// most 16 bytes of memory for each of the file's and 64 KiB, the replay included, whoever made the file: a limit on its
    /// size is one on both. So does [`verify`](Self::verify), as far as what is done makes nothing new.
    ///
    /// # Errors
    /// A [`ReplayError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        let (replay, error) = Self::read(bytes, custom_forces)?;
        error.map_or(Ok(replay), Err)
    }

    /// Reads a file that may be cut off: what is whole of it, at least up to the first snapshot.
    ///
    /// # Errors
    /// A [`ReplayError`] for what is not just cut off.
    pub fn recovered(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        match Self::read(bytes, custom_forces)? {
            (replay, None | Some(ReplayError::CutOff { .. })) => Ok(replay),
            (_, Some(error)) => Err(error),
        }
    }

    /// What could be read after the first snapshot, and why no more.
    fn read(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<(Self, Option<ReplayError>), ReplayError> {
        let mut reader = Reader::new(bytes);
        REPLAY.enter(&mut reader)?;
        let Some(first) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: 0 }) };
        let head = Self::read_head(&first, custom_forces)?;
        let Some(second) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: head.tick }) };
        let start = Self::read_start(&second, &head, custom_forces)?;
        let (segments, snapshots) = (Vec::new(), Vec::new());
        let mut replay = Self { head, start, segments, ticks: 0, snapshots, done: None };
        let (mut number, mut next) = (2, Next::Ticks);
        while replay.done.is_none() {
            let Some(chunk) = chunk::read(&mut reader) else {
                let error = ReplayError::CutOff { tick: replay.end() };
                return Ok((replay, Some(error)));
            };
            match replay.read_chunk(chunk, number, next, custom_forces) {
                Ok(following) => next = following,
                Err(error) => return Ok((replay, Some(error))),
            }
            number += 1;
        }
        let left_over = reader.end().err().map(|malformed| ReplayError::Malformed { chunk: number, malformed });
        Ok((replay, left_over))
    }

    fn read_head(chunk: &Chunk, custom_forces: &[Arc<dyn CustomForce>]) -> Result<Head, ReplayError> {
        sound(chunk, 0, 0, custom_forces)?;
        if chunk.tag != HEAD {
            return Err(malformed(0, "the head"));
        }
        let head = whole(chunk, 0, Head::read)?;
        if head.physics_version != PHYSICS_VERSION {
            return Err(ReplayError::PhysicsVersion { found: head.physics_version, own: PHYSICS_VERSION });
        }
        if head.hash_every == 0 {
            return Err(malformed(0, "a number of ticks from 1"));
        }
        Ok(head)
    }

    fn read_start(chunk: &Chunk, head: &Head, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, ReplayError> {
        sound(chunk, 1, head.tick, custom_forces)?;
        if chunk.tag != SNAPSHOT {
            return Err(malformed(1, "a snapshot"));
        }
        let start = read_snapshot(chunk, 1, custom_forces)?;
        if start.tick() == head.tick { Ok(start) } else { Err(malformed(1, "the snapshot of the first tick")) }
    }

    /// Adds a chunk where `next` may be, and says what may follow it.
    fn read_chunk(
        &mut self,
        chunk: Chunk,
        number: u32,
        next: Next,
        custom_forces: &[Arc<dyn CustomForce>],
    ) -> Result<Next, ReplayError> {
        let malformed = |expected| malformed(number, expected);
        sound(&chunk, number, self.end(), custom_forces)?;
        match chunk.tag {
            TICKS => {
                next.may_be_ticks().map_err(malformed)?;
                let mut ticks = Ticks::new(&self.head, self.ticks);
                let look = |tick: &Tick<'_>, bytes| ticks.see(tick, bytes);
                let Segment { tick, .. } = whole(&chunk, number, |reader| Segment::read_and(reader, look))?;
                if tick != self.end() {
                    return Err(malformed("the ticks that follow"));
                }
                let next = Next::after_ticks(&ticks).map_err(malformed)?;
                let (count, end) = (ticks.count, ticks.end());
                self.segments.push(Stretch { start: self.ticks, count, bytes: chunk.bytes });
                self.ticks = end;
                Ok(next)
            }
            SNAPSHOT => {
                let next = next.after_snapshot(&self.head, self.end()).map_err(malformed)?;
                let world = read_snapshot(&chunk, number, custom_forces)?;
                if world.tick() != self.end() {
                    return Err(malformed("the snapshot of this tick"));
                }
                self.snapshots.push((self.ticks, Box::new(world)));
                Ok(next)
            }
            DONE => {
                let done = whole(&chunk, number, Done::read)?;
                if done.tick != self.end() {
                    return Err(malformed("the tick it ends at"));
                }
                next.may_be_done(&self.head, self.end()).map_err(malformed)?;
                self.done = Some(done);
                Ok(Next::Done)
            }
            _ => Err(malformed("a chunk of this format")),
        }
    }

    /// As bytes, the same on every machine: those it was read from. Of a [recovered](Self::recovered) one, what was whole.
    ///
    /// ```
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// (0..100).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    /// let file = recorder.finish(&world);
    /// assert_eq!(Replay::from_bytes(&file, &[])?.to_bytes(), file);
    /// let cut = Replay::recovered(&file[..file.len() - 1], &[])?.to_bytes();
    /// assert!(file.starts_with(&cut));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::new(self.head, &self.start);
        let mut snapshots = self.snapshots.iter();
        for (before, tick) in (0..).zip(self.each()) {
            let after = self.head.tick_after(before + 1);
            writer.tick(self.head.tick_after(before), &tick, after);
            if self.head.has_snapshot(after) {
                // Cut off before it, there is none.
                snapshots.next().into_iter().for_each(|(_, world)| writer.snapshot(world));
            }
        }
        writer.finish_segment();
        snapshots.for_each(|(_, world)| writer.snapshot(world));
        self.done.into_iter().for_each(|done| writer.done(done));
        writer.file
    }

    /// The world it begins with.
    #[must_use]
    pub fn start(&self) -> &World {
        &self.start
    }

    /// The tick its world is at after the last of its ticks.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.head.tick_after(self.ticks)
    }

    /// How many ticks it has.
    ///
    /// ```
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// (0..7).for_each(|_| _ = world.step());
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// (0..30).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// assert_eq!((replay.start().tick(), replay.end(), replay.ticks()), (7, 37, 30));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Whether the recording was brought to its end.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.done.is_some()
    }

    /// The later snapshots after so many ticks and more, and after how many each is.
    pub(super) fn snapshots_from(&self, ticks: u64) -> impl Iterator<Item = (u64, &World)> {
        let first = self.snapshots.partition_point(|(after, _)| *after < ticks);
        self.snapshots[first..].iter().map(|(after, world)| (*after, &**world))
    }

    /// The later snapshot after so many ticks.
    pub(super) fn snapshot_after(&self, ticks: u64) -> Option<&World> {
        self.snapshots_from(ticks).next().filter(|(after, _)| *after == ticks).map(|(_, world)| world)
    }

    /// The last snapshot after so many ticks or fewer, and after how many it is.
    pub(super) fn snapshot_before(&self, ticks: u64) -> (u64, &World) {
        let later = self.snapshots.partition_point(|(after, _)| *after <= ticks);
        let last = later.checked_sub(1).map(|last| &self.snapshots[last]);
        last.map_or((0, &self.start), |(after, world)| (*after, world))
    }

    /// The place after so many ticks, and the hash that was recorded of the last of them.
    pub(super) fn cursor(&self, ticks: u64) -> (Cursor, Option<u64>) {
        // From the stretch that the tick before is in.
        let after = self.segments.partition_point(|stretch| stretch.start < ticks);
        let stretch = after.saturating_sub(1);
        let (mut cursor, mut hash) = (Cursor { stretch, ..Cursor::default() }, None);
        for _ in self.segments.get(stretch).map_or(ticks, |stretch| stretch.start)..ticks {
            hash = self.next(&mut cursor).and_then(|tick| tick.hash);
        }
        (cursor, hash)
    }

    /// The tick at a place, which is behind it then.
    pub(super) fn next(&self, cursor: &mut Cursor) -> Option<Tick<'_>> {
        if self.segments.get(cursor.stretch)?.count == cursor.behind {
            *cursor = Cursor { stretch: cursor.stretch + 1, ..Cursor::default() };
        }
        let bytes = self.segments.get(cursor.stretch)?.bytes.get(Segment::HEAD + cursor.at..)?;
        let mut reader = Reader::new(bytes);
        let tick = Tick::read(&mut reader).ok()?;
        (cursor.behind, cursor.at) = (cursor.behind + 1, cursor.at + reader.at());
        Some(tick)
    }

    /// All ticks in their order.
    fn each(&self) -> impl Iterator<Item = Tick<'_>> {
        let mut cursor = Cursor::default();
        core::iter::from_fn(move || self.next(&mut cursor))
    }

    /// Plays it from its start.
    #[must_use]
    pub fn play(&self) -> Playback<'_> {
        Playback::new(self, ReplayLimits::NONE)
    }

    /// Runs all of it again, and compares every hash. For one that anybody can have made there is
    /// [`verify_within`](Self::verify_within).
    ///
    /// # Errors
    /// A [`Divergence`] at the first hash that is another.
    pub fn verify(&self) -> Result<(), Box<Divergence>> {
        let mut playback = self.play();
        while playback.step()? {}
        Ok(())
    }

    /// The same with limits of the caller's on the ticks, and on the bodies and the force fields that there are at any time: a
    /// short file can add many, and have them stepped for long. They hold for what it takes to name a divergence too.
    ///
    /// Time: at most that of so many steps of so many bodies in so many fields, and of a look at the whole of such a world, its
    /// blob included, for each hash; and what is done in the file, each call on so many bodies and fields. A limit on the file's
    /// size is one on its blobs and calls. Laws of force of the caller's own take what they take.
    ///
    /// # Errors
    /// A [`VerifyError`]: it goes another way, or is more than it may be.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Command, Inputs, RecordOptions, Recorder, Replay, ReplayLimits, VerifyError};
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// for _ in 0..100 {
    ///     recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic()))?;
    ///     recorder.step(&mut world, &Inputs::new());
    /// }
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// let most = ReplayLimits { ticks: 60 * 60 * 30, bodies: 1_000, fields: 200, commands: 100_000 };
    /// assert_eq!(replay.verify_within(most), Ok(()));
    /// let error = replay.verify_within(ReplayLimits { bodies: 60, ..most }).unwrap_err();
    /// assert_eq!(error, VerifyError::Bodies { tick: 60, most: 60 });
    /// assert_eq!(error.to_string(), "more than 60 bodies at tick 60");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verify_within(&self, most: ReplayLimits) -> Result<(), VerifyError> {
        Playback::new(self, most).verify()
    }

    /// The first value in which the runs of two replays are not the same: what they begin with, what is done, or what
    /// was recorded of it. `None` if they are the same as far as both go.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<Finding> {
        if let Some(found) = self.start.first_difference(&other.start) {
            return Some(Finding::at(self.head.tick, TickPhase::Start, found));
        }
        for (before, (ours, theirs)) in (0..).zip(self.each().zip(other.each())) {
            let tick = self.head.tick_after(before);
            if let Some(finding) = doings_differ(tick, &ours, &theirs) {
                return Some(finding);
            }
            if let (Some(a), Some(b)) = (ours.hash, theirs.hash) {
                if a != b {
                    let named = self.named_at_a_snapshot(other, before + 1);
                    return Some(named.unwrap_or_else(|| Finding::of_hashes(tick, a, b)));
                }
            }
        }
        None
    }

    /// The first value in which the snapshots of two replays differ after so many ticks or more.
    fn named_at_a_snapshot(&self, other: &Self, ticks: u64) -> Option<Finding> {
        self.snapshots_from(ticks).find_map(|(after, world)| {
            let found = world.first_difference(other.snapshot_after(after)?)?;
            Some(Finding::at(self.head.tick_after(after - 1), TickPhase::End, found))
        })
    }
}

/// In what that which is done in a tick differs.
pub(super) fn doings_differ(tick: u64, ours: &Tick<'_>, theirs: &Tick<'_>) -> Option<Finding> {
    let calls = lists_differ("calls", &ours.calls, &theirs.calls);
    let Parting { path, left, right } = calls.or_else(|| lists_differ("inputs", &ours.inputs, &theirs.inputs))?;
    let (phase, place) = place_in_tick(ours, &path);
    Some(Finding { tick, phase, place, field: name_of(&path), recorded: left, found: right })
}

/// Where two lists part, and what is there in each.
struct Parting {
    path: Vec<Part>,
    left: Option<String>,
    right: Option<String>,
}

/// The first value in which two lists are not the same: their length, or one of an entry, which alone is laid out for that.
fn lists_differ<T: Read + Write + PartialEq>(
    name: &'static str,
    ours: &List<'_, T>,
    theirs: &List<'_, T>,
) -> Option<Parting> {
    if ours.count != theirs.count {
        let [left, right] = [ours, theirs].map(|list| Some(list.count.to_string()));
        return Some(Parting { path: alloc::vec![Part::Name(name), Part::Name("count")], left, right });
    }
    if ours.is(theirs) {
        return None;
    }
    let (index, (ours, theirs)) = (0..).zip(ours.iter().zip(theirs.iter())).find(|(_, (a, b))| a != b)?;
    let (left, right) = (FieldIndex::of(&ours).leaves, FieldIndex::of(&theirs).leaves);
    let same = left.iter().zip(&right).take_while(|(a, b)| a == b).count();
    let (a, b) = (left.get(same), right.get(same));
    let within = a.or(b).map(|leaf| &leaf.path[..]).unwrap_or_default();
    let text = |leaf: Option<&FieldValue>| leaf.filter(|leaf| leaf.path == within).map(|leaf| leaf.text.clone());
    let path = [&[Part::Name(name), Part::Entry(index)], within].concat();
    Some(Parting { path, left: text(a), right: text(b) })
}

/// When in a tick the value at a path of it is, and the body or field that its command is about.
pub(super) fn place_in_tick(tick: &Tick<'_>, path: &[Part]) -> (TickPhase, Owner) {
    let place = |command: Option<Command>| command.map_or(Owner::World, |command| Owner::of_command(&command));
    match *path {
        [Part::Name("calls"), Part::Entry(i), ..] => (TickPhase::Calls, place(tick.calls.iter().nth(i as usize))),
        [Part::Name("calls"), ..] => (TickPhase::Calls, Owner::World),
        [Part::Name("inputs"), Part::Entry(i), ..] => {
            (TickPhase::Inputs, place(tick.inputs.iter().nth(i as usize).map(|input| input.command)))
        }
        [Part::Name("inputs"), ..] => (TickPhase::Inputs, Owner::World),
        _ => (TickPhase::End, Owner::World),
    }
}

impl Owner {
    /// The body or force field that a command is about, or else the world.
    fn of_command(command: &Command) -> Self {
        let field = command.field().map_or(Self::World, Self::ForceField);
        command.body().map_or(field, Self::Body)
    }
}

fn read_snapshot(chunk: &Chunk, number: u32, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, ReplayError> {
    let mut reader = Reader::new(&chunk.bytes);
    let world = snapshot::read(&mut reader, custom_forces).and_then(|world| {
        reader.end()?;
        Ok(world)
    });
    world.map_err(|error| ReplayError::Snapshot { chunk: number, error })
}
