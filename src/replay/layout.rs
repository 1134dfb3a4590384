//! In which order the chunks of a replay follow each other, and where each ends: one way for each run. What writes a replay
//! and what reads one go by the same rules, so that a file that is accepted is written again to the same bytes.

use alloc::vec::Vec;

use super::chunk;
use super::file::{DONE, Done, HEAD, Head, REPLAY, SNAPSHOT, TICKS, Tick};
use super::snapshot::Saved;
use crate::codec::Write;
use crate::world::World;

/// A chunk of ticks has at most so many: what is lost when a recording is cut off.
const SEGMENT: u32 = 64;
/// Or it ends with the first tick after which it has more bytes: a tick with a blob may have 2^24 more, and no chunk has 2^32.
const SEGMENT_BYTES: usize = 1 << 20;

impl Head {
    /// Whether the hash of the world at this tick is recorded.
    pub(super) fn has_hash(&self, tick: u64) -> bool {
        tick % u64::from(self.hash_every) == 0
    }

    /// Whether there is a snapshot of the world at this tick, apart from those the replay begins and ends with.
    pub(super) fn has_snapshot(&self, tick: u64) -> bool {
        self.snapshot_every > 0 && tick % u64::from(self.snapshot_every) == 0
    }

    /// Whether a chunk of so many ticks and bytes ends, with the world at this tick.
    fn ends_chunk(&self, tick: u64, ticks: u32, bytes: usize) -> bool {
        ticks == SEGMENT || bytes > SEGMENT_BYTES || self.has_snapshot(tick)
    }
}

/// A replay being written.
#[derive(Clone, Debug)]
pub(super) struct Writer {
    pub(super) head: Head,
    /// What is finished of the file and was not taken yet.
    pub(super) file: Vec<u8>,
    /// The ticks of the chunk to come, as bytes.
    segment: Vec<u8>,
    ticks: u32,
}

impl Writer {
    /// Begins with the world at the tick of the head.
    pub(super) fn new(head: Head, start: &World) -> Self {
        let mut bytes = Vec::new();
        head.write(&mut bytes);
        let mut file = REPLAY.begin();
        chunk::write(&mut file, HEAD, &bytes);
        let mut writer = Self { head, file, segment: Vec::new(), ticks: 0 };
        writer.snapshot(start);
        writer
    }

    /// Adds a tick: what was done, and the tick of the world before it and after it.
    pub(super) fn tick(&mut self, before: u64, done: &impl Write, after: u64) {
        if self.segment.is_empty() {
            before.write(&mut self.segment);
            // The number of ticks, when it is known.
            0u32.write(&mut self.segment);
        }
        done.write(&mut self.segment);
        self.ticks += 1;
        if self.head.ends_chunk(after, self.ticks, self.segment.len()) {
            self.finish_segment();
        }
    }

    /// Adds a snapshot.
    pub(super) fn snapshot(&mut self, world: &World) {
        let mut bytes = Vec::new();
        Saved(world).write(&mut bytes);
        chunk::write(&mut self.file, SNAPSHOT, &bytes);
    }

    /// Ends the chunk of ticks, if there is one.
    pub(super) fn finish_segment(&mut self) {
        if self.ticks == 0 {
            return;
        }
        self.segment[8..12].copy_from_slice(&self.ticks.to_le_bytes());
        chunk::write(&mut self.file, TICKS, &self.segment);
        self.segment.clear();
        self.ticks = 0;
    }

    /// Adds the end.
    pub(super) fn done(&mut self, done: Done) {
        let mut bytes = Vec::new();
        done.write(&mut bytes);
        chunk::write(&mut self.file, DONE, &bytes);
    }
}

/// What may follow the chunks that were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// More ticks, or the end.
    Ticks,
    /// The snapshot that a tick has.
    Snapshot,
    /// The end, as the chunk of ticks before had room for more.
    End,
    /// The end, as the last snapshot was read.
    Done,
}

impl Next {
    /// Whether ticks may be here.
    pub(super) fn may_be_ticks(self) -> Result<(), &'static str> {
        match self {
            Self::Ticks => Ok(()),
            Self::Snapshot => Err("the snapshot of this tick"),
            Self::End => Err("the last snapshot: the chunk of ticks before has room for more"),
            Self::Done => Err("the end"),
        }
    }

    /// After these ticks.
    pub(super) fn after_ticks(ticks: &Ticks<'_>) -> Result<Self, &'static str> {
        match ticks.has_ended {
            _ if ticks.count == 0 => Err("one tick at least"),
            true if ticks.head.has_snapshot(ticks.tick()) => Ok(Self::Snapshot),
            true => Ok(Self::Ticks),
            false => Ok(Self::End),
        }
    }

    /// After a snapshot, with the world at this tick.
    pub(super) fn after_snapshot(self, head: &Head, tick: u64) -> Result<Self, &'static str> {
        match self {
            Self::Snapshot => Ok(Self::Ticks),
            // The last one is left out where there is one already.
            Self::Ticks | Self::End if !head.has_snapshot(tick) => Ok(Self::Done),
            _ => Err("no other snapshot of this tick"),
        }
    }

    /// Whether `DONE` may be here, with the world at this tick.
    pub(super) fn may_be_done(self, head: &Head, tick: u64) -> Result<(), &'static str> {
        match self {
            Self::Done => Ok(()),
            Self::Ticks if head.has_snapshot(tick) => Ok(()),
            _ => Err("the snapshot of the last tick"),
        }
    }
}

/// The ticks of a chunk, looked at one after the other.
pub(super) struct Ticks<'a> {
    head: &'a Head,
    /// How many were before.
    start: u64,
    pub(super) count: u32,
    has_ended: bool,
}

impl<'a> Ticks<'a> {
    pub(super) fn new(head: &'a Head, start: u64) -> Self {
        Self { head, start, count: 0, has_ended: false }
    }

    /// How many there are up to here, those before the chunk included.
    pub(super) fn end(&self) -> u64 {
        self.start + u64::from(self.count)
    }

    /// The tick the world is at then.
    pub(super) fn tick(&self) -> u64 {
        self.head.tick_after(self.end())
    }

    /// Goes on by a tick, with which the chunk has so many bytes. Refuses what would not be written like this.
    pub(super) fn see(&mut self, tick: &Tick<'_>, bytes: usize) -> Result<(), &'static str> {
        if self.has_ended {
            return Err("another chunk: of ticks, or the snapshot of this tick");
        }
        self.count += 1;
        let after = self.tick();
        if tick.hash.is_some() != self.head.has_hash(after) {
            return Err("a tick with a hash where the head says so, and nowhere else");
        }
        self.has_ended = self.head.ends_chunk(after, self.count, bytes);
        Ok(())
    }
}
