//! The order of the chunks of a replay, and where each chunk of ticks ends. There is one valid order for each run: writer and
//! reader follow the same rules, so that an accepted file is written again to the same bytes.

use alloc::vec::Vec;

use super::chunk;
use super::format::{DONE, Done, HEAD, Head, NAMES, REPLAY, SNAPSHOT, TICKS};
use super::labels::Labels;
use super::ticks::Tick;
use crate::codec::Write;
use crate::replay::snapshot::Saved;
use crate::world::World;

/// The most ticks of a chunk: at most so many are lost when a recording is cut off.
const SEGMENT: u32 = 64;
/// A chunk ends with the first tick after which it has more bytes than this. That tick may take many more: each blob in it has
/// up to 2^24 bytes.
const SEGMENT_BYTES: usize = 1 << 20;

impl Head {
    /// Says whether the hash of the world at this tick is recorded.
    pub(super) fn has_hash(&self, tick: u64) -> bool {
        tick % u64::from(self.hash_every) == 0
    }

    /// Says whether there is a snapshot of the world at this tick, apart from those at the start and the end of the replay.
    pub(super) fn has_snapshot(&self, tick: u64) -> bool {
        self.snapshot_every > 0 && tick % u64::from(self.snapshot_every) == 0
    }

    /// Says whether a chunk ends that has so many ticks and bytes, with the world at this tick.
    fn ends_chunk(&self, tick: u64, ticks: u32, bytes: usize) -> bool {
        ticks == SEGMENT || bytes > SEGMENT_BYTES || self.has_snapshot(tick)
    }
}

/// A replay that is being written.
#[derive(Clone, Debug)]
pub(super) struct Writer {
    pub(super) head: Head,
    /// The finished bytes of the file that were not taken yet.
    pub(super) file: Vec<u8>,
    /// The bytes of the next chunk of ticks.
    segment: Vec<u8>,
    ticks: u32,
}

impl Writer {
    /// Begins a file with the world at the tick of the head.
    pub(super) fn new(head: Head, start: &World) -> Self {
        let mut bytes = Vec::new();
        head.write(&mut bytes);
        let mut file = REPLAY.begin();
        chunk::write(&mut file, HEAD, &bytes);
        let mut writer = Self { head, file, segment: Vec::new(), ticks: 0 };
        writer.snapshot(start);
        writer
    }

    /// Adds a tick, which took the world from tick `before` to tick `after`.
    pub(super) fn tick(&mut self, before: u64, tick: &impl Write, after: u64) {
        if self.segment.is_empty() {
            before.write(&mut self.segment);
            // The place for the number of ticks.
            0u32.write(&mut self.segment);
        }
        tick.write(&mut self.segment);
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

    /// Adds the names, if there are any.
    pub(super) fn labels(&mut self, labels: &Labels) {
        if !labels.is_empty() {
            let mut bytes = Vec::new();
            labels.write(&mut bytes);
            chunk::write(&mut self.file, NAMES, &bytes);
        }
    }

    /// Adds the end.
    pub(super) fn done(&mut self, done: Done) {
        let mut bytes = Vec::new();
        done.write(&mut bytes);
        chunk::write(&mut self.file, DONE, &bytes);
    }
}

/// The chunks that may follow those that were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// More ticks, or the end.
    Ticks,
    /// The snapshot that a tick has.
    Snapshot,
    /// The end, because the chunk of ticks before had room for more.
    End,
    /// Names or the end, because the last snapshot was read.
    Done,
    /// The end, because the names were read.
    Named,
}

impl Next {
    /// Refuses ticks where none may follow.
    pub(super) fn may_be_ticks(self) -> Result<(), &'static str> {
        match self {
            Self::Ticks => Ok(()),
            Self::Snapshot => Err("the snapshot of this tick"),
            Self::End => Err("the last snapshot: the chunk of ticks before has room for more"),
            Self::Done | Self::Named => Err("the end"),
        }
    }

    /// The chunks that may follow these ticks.
    pub(super) fn after_ticks(ticks: &Ticks<'_>) -> Result<Self, &'static str> {
        match ticks.has_ended {
            _ if ticks.count == 0 => Err("one tick at least"),
            true if ticks.head.has_snapshot(ticks.tick()) => Ok(Self::Snapshot),
            true => Ok(Self::Ticks),
            false => Ok(Self::End),
        }
    }

    /// The chunks that may follow a snapshot of the world at this tick.
    pub(super) fn after_snapshot(self, head: &Head, tick: u64) -> Result<Self, &'static str> {
        match self {
            Self::Snapshot => Ok(Self::Ticks),
            // The last snapshot is left out if there is one of its tick already.
            Self::Ticks | Self::End if !head.has_snapshot(tick) => Ok(Self::Done),
            _ => Err("no other snapshot of this tick"),
        }
    }

    /// The chunks that may follow the names, with the world at this tick.
    pub(super) fn after_names(self, head: &Head, tick: u64) -> Result<Self, &'static str> {
        if self == Self::Named {
            return Err("the end");
        }
        self.may_be_done(head, tick).map(|()| Self::Named)
    }

    /// Refuses the end where it may not follow, with the world at this tick.
    pub(super) fn may_be_done(self, head: &Head, tick: u64) -> Result<(), &'static str> {
        match self {
            Self::Done | Self::Named => Ok(()),
            Self::Ticks if head.has_snapshot(tick) => Ok(()),
            _ => Err("the snapshot of the last tick"),
        }
    }
}

/// The ticks of a chunk that is being read.
pub(super) struct Ticks<'a> {
    head: &'a Head,
    /// The number of ticks before the chunk.
    start: u64,
    pub(super) count: u32,
    has_ended: bool,
}

impl<'a> Ticks<'a> {
    pub(super) fn new(head: &'a Head, start: u64) -> Self {
        Self { head, start, count: 0, has_ended: false }
    }

    /// The number of ticks up to here, those before the chunk included.
    pub(super) fn end(&self) -> u64 {
        self.start + u64::from(self.count)
    }

    /// The tick of the world after them.
    pub(super) fn tick(&self) -> u64 {
        self.head.tick_after(self.end())
    }

    /// Adds a tick, with which the chunk has so many bytes. Refuses one that a recorder would not have put here.
    pub(super) fn add(&mut self, tick: &Tick<'_>, bytes: usize) -> Result<(), &'static str> {
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
