//! Replays: reading them, and comparing two of them.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::chunk::{self, Chunk};
use super::damage::{check_unchanged, read_whole};
use super::error::ReplayError;
use super::format::{DONE, Done, HEAD, Head, NAMES, REPLAY, SNAPSHOT, TICKS};
use super::labels::Labels;
use super::layout::{Next, Ticks, Writer};
use super::ticks::{Segment, Tick, tick_difference};
use crate::codec::{Read, Reader};
use crate::force::CustomForce;
use crate::replay::diff::{Difference, TickPhase};
use crate::replay::snapshot::{self, PHYSICS_VERSION};
use crate::world::World;

/// A recorded run: the world at its start, the calls and inputs of each tick, and the hashes of the results.
///
/// ```
/// use umbra_physics::{BodyDef, Command, Inputs, RecordOptions, Recorder, Replay, World, WorldDef, vec2};
///
/// let record = |turn: i32| {
///     let mut world = World::new(WorldDef::default())?;
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
/// let difference = ours?.first_difference(&theirs?).unwrap();
/// assert_eq!((difference.tick, difference.left.as_deref(), difference.right.as_deref()), (4, Some("1"), Some("2")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Replay {
    pub(super) head: Head,
    pub(super) start: World,
    /// The chunks of ticks, in their order and as they stand in the file.
    segments: Vec<TickChunk>,
    /// The number of ticks.
    pub(super) ticks: u64,
    /// The later snapshots, each with the number of ticks before it, in ascending order.
    snapshots: Vec<(u64, Box<World>)>,
    pub(super) labels: Labels,
    pub(super) done: Option<Done>,
}

/// A chunk of ticks.
#[derive(Clone, Debug)]
struct TickChunk {
    /// The number of ticks before it.
    start: u64,
    count: u32,
    bytes: Vec<u8>,
}

/// A position between two ticks of a replay.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cursor {
    chunk: usize,
    /// The number of ticks of the chunk that were read, and the position of the next one in its bytes.
    behind: u32,
    at: usize,
}

impl Replay {
    /// Reads a file. The custom forces that the world uses must be among those given.
    ///
    /// Every bit of the file is checked: a change is found, and named with the recorded value and the value in the file. The
    /// file need not be trusted: reading takes at most 16 bytes of memory for each byte of the file and 64 KiB, the replay
    /// included, so that a limit on its size is a limit on both. [`verify`](Self::verify) needs no more, but for what the
    /// calls and inputs add to the world.
    ///
    /// # Errors
    /// A [`ReplayError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        let (replay, error) = Self::read(bytes, custom_forces)?;
        error.map_or(Ok(replay), Err)
    }

    /// Reads the complete part of a file that may be cut off, which must include the first snapshot.
    ///
    /// # Errors
    /// A [`ReplayError`] if the file has another fault than being cut off.
    pub fn recovered(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, ReplayError> {
        match Self::read(bytes, custom_forces)? {
            (replay, None | Some(ReplayError::CutOff { .. })) => Ok(replay),
            (_, Some(error)) => Err(error),
        }
    }

    /// Reads as far as possible, and says why no further. An error before the end of the first snapshot is returned as such.
    fn read(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<(Self, Option<ReplayError>), ReplayError> {
        let mut reader = Reader::new(bytes);
        REPLAY.enter(&mut reader)?;
        let Some(first) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: 0 }) };
        let head = Self::read_head(&first, custom_forces)?;
        let Some(second) = chunk::read(&mut reader) else { return Err(ReplayError::CutOff { tick: head.tick }) };
        let start = Self::read_start(&second, &head, custom_forces)?;
        let (segments, snapshots) = (Vec::new(), Vec::new());
        let mut replay = Self { head, start, segments, ticks: 0, snapshots, labels: Labels::new(), done: None };
        let mut number = 2;
        let mut next = Next::Ticks;
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
        check_unchanged(chunk, 0, 0, custom_forces)?;
        if chunk.tag != HEAD {
            return Err(ReplayError::expected(0, "the head"));
        }
        let head = read_whole(chunk, 0, Head::read)?;
        if head.physics_version != PHYSICS_VERSION {
            return Err(ReplayError::PhysicsVersion { found: head.physics_version, own: PHYSICS_VERSION });
        }
        if head.hash_every == 0 {
            return Err(ReplayError::expected(0, "a number of ticks from 1"));
        }
        Ok(head)
    }

    fn read_start(chunk: &Chunk, head: &Head, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, ReplayError> {
        check_unchanged(chunk, 1, head.tick, custom_forces)?;
        if chunk.tag != SNAPSHOT {
            return Err(ReplayError::expected(1, "a snapshot"));
        }
        let start = read_snapshot(chunk, 1, custom_forces)?;
        if start.tick() == head.tick {
            Ok(start)
        } else {
            Err(ReplayError::expected(1, "the snapshot of the first tick"))
        }
    }

    /// Adds a chunk, if `next` allows it, and says what may follow.
    fn read_chunk(
        &mut self,
        chunk: Chunk,
        number: u32,
        next: Next,
        custom_forces: &[Arc<dyn CustomForce>],
    ) -> Result<Next, ReplayError> {
        let malformed = |expected| ReplayError::expected(number, expected);
        check_unchanged(&chunk, number, self.end(), custom_forces)?;
        match chunk.tag {
            TICKS => {
                next.may_be_ticks().map_err(malformed)?;
                let mut ticks = Ticks::new(&self.head, self.ticks);
                let look = |tick: &Tick<'_>, bytes| ticks.add(tick, bytes);
                let Segment { tick, .. } = read_whole(&chunk, number, |reader| Segment::read_and(reader, look))?;
                if tick != self.end() {
                    return Err(malformed("the ticks that follow"));
                }
                let next = Next::after_ticks(&ticks).map_err(malformed)?;
                let (count, end) = (ticks.count, ticks.end());
                self.segments.push(TickChunk { start: self.ticks, count, bytes: chunk.bytes });
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
            NAMES => {
                let next = next.after_names(&self.head, self.end()).map_err(malformed)?;
                self.labels = read_whole(&chunk, number, Labels::read)?;
                Ok(next)
            }
            DONE => {
                let done = read_whole(&chunk, number, Done::read)?;
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

    /// The replay as bytes, the same on every machine: those it was read from, or the complete part of them for a
    /// [recovered](Self::recovered) one.
    ///
    /// ```
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
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
                // There is none if the file was cut off before it.
                snapshots.next().into_iter().for_each(|(_, world)| writer.snapshot(world));
            }
        }
        writer.finish_segment();
        snapshots.for_each(|(_, world)| writer.snapshot(world));
        writer.labels(&self.labels);
        self.done.into_iter().for_each(|done| writer.done(done));
        writer.file
    }

    /// The world at the start.
    #[must_use]
    pub fn start(&self) -> &World {
        &self.start
    }

    /// The names of bodies, force fields and joints that the recorder was given.
    #[must_use]
    pub const fn labels(&self) -> &Labels {
        &self.labels
    }

    /// The tick of the world at the end.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.head.tick_after(self.ticks)
    }

    /// The number of ticks.
    ///
    /// ```
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
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

    /// Says whether the recording was finished, or else the file is cut off.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.done.is_some()
    }

    /// The later snapshots after `ticks` ticks or more, each with the number of ticks before it.
    pub(super) fn snapshots_from(&self, ticks: u64) -> impl Iterator<Item = (u64, &World)> {
        let first = self.snapshots.partition_point(|(after, _)| *after < ticks);
        self.snapshots[first..].iter().map(|(after, world)| (*after, &**world))
    }

    /// The later snapshot after exactly `ticks` ticks.
    pub(super) fn snapshot_after(&self, ticks: u64) -> Option<&World> {
        self.snapshots_from(ticks).next().filter(|(after, _)| *after == ticks).map(|(_, world)| world)
    }

    /// The recorded hashes of the world after `ticks` ticks: `last`, which the last of these ticks has, that of a snapshot, and
    /// that of the end.
    pub(super) fn hashes_after(&self, ticks: u64, last: Option<u64>) -> [Option<u64>; 3] {
        let done = self.done.filter(|_| self.ticks == ticks);
        [last, self.snapshot_after(ticks).map(World::state_hash), done.map(|done| done.hash)]
    }

    /// The last snapshot after `ticks` ticks or fewer, with the number of ticks before it.
    pub(super) fn snapshot_before(&self, ticks: u64) -> (u64, &World) {
        let later = self.snapshots.partition_point(|(after, _)| *after <= ticks);
        let last = later.checked_sub(1).map(|last| &self.snapshots[last]);
        last.map_or((0, &self.start), |(after, world)| (*after, world))
    }

    /// The position after `ticks` ticks, and the recorded hash of the last of them.
    pub(super) fn cursor(&self, ticks: u64) -> (Cursor, Option<u64>) {
        // From the start of the chunk that has the tick before.
        let after = self.segments.partition_point(|chunk| chunk.start < ticks);
        let chunk = after.saturating_sub(1);
        let mut cursor = Cursor { chunk, ..Cursor::default() };
        let mut hash = None;
        for _ in self.segments.get(chunk).map_or(ticks, |chunk| chunk.start)..ticks {
            hash = self.next(&mut cursor).and_then(|tick| tick.hash);
        }
        (cursor, hash)
    }

    /// Reads the tick at a position, and moves the position past it.
    pub(super) fn next(&self, cursor: &mut Cursor) -> Option<Tick<'_>> {
        if self.segments.get(cursor.chunk)?.count == cursor.behind {
            *cursor = Cursor { chunk: cursor.chunk + 1, ..Cursor::default() };
        }
        let bytes = self.segments.get(cursor.chunk)?.bytes.get(Segment::HEAD + cursor.at..)?;
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

    /// The first value in which the runs of two replays differ: in the world at the start, in calls and inputs, or in the
    /// recorded results. `None` if they are the same as far as both go. Names are not compared; the difference has the name that its body
    /// or force field has in either, this replay first.
    #[must_use]
    pub fn first_difference(&self, rhs: &Self) -> Option<Difference> {
        let difference = self.first_unnamed_difference(rhs)?;
        Some(rhs.labels.name(self.labels.name(difference, &self.start), &rhs.start))
    }

    fn first_unnamed_difference(&self, rhs: &Self) -> Option<Difference> {
        if let Some(difference) = self.start.first_difference(&rhs.start) {
            return Some(difference.at(self.head.tick, TickPhase::Start));
        }
        for (before, (ours, theirs)) in (0..).zip(self.each().zip(rhs.each())) {
            let tick = self.head.tick_after(before);
            if let Some(difference) = tick_difference(tick, &ours, &theirs) {
                return Some(difference);
            }
            let (ours, theirs) = (self.hashes_after(before + 1, ours.hash), rhs.hashes_after(before + 1, theirs.hash));
            // The two may have recorded the hash of this tick in different places.
            let first = |hashes: [Option<u64>; 3]| hashes.into_iter().flatten().next();
            let pairs = ours.into_iter().zip(theirs).chain([(first(ours), first(theirs))]);
            if let Some((a, b)) = pairs.filter_map(|(a, b)| a.zip(b)).find(|(a, b)| a != b) {
                let difference = self.first_snapshot_difference(rhs, before + 1);
                return Some(difference.unwrap_or_else(|| Difference::of_hashes(tick, a, b)));
            }
        }
        None
    }

    /// The first value in which the snapshots of two replays differ after `ticks` ticks or more.
    fn first_snapshot_difference(&self, rhs: &Self, ticks: u64) -> Option<Difference> {
        self.snapshots_from(ticks).find_map(|(after, world)| {
            let difference = world.first_difference(rhs.snapshot_after(after)?)?;
            Some(difference.at(self.head.tick_after(after - 1), TickPhase::End))
        })
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
