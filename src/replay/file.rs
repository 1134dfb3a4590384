//! What is in the chunks of a replay. `docs/formats.md` has them byte by byte.

use alloc::vec::Vec;
use core::marker::PhantomData;

use super::chunk::Tag;
use super::error::ReplayError;
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, Write};
use crate::limits;
use crate::world::{Command, Input, Inputs};

/// A kind of file that is made of chunks.
pub(super) struct Kind {
    /// The first bytes.
    pub(super) magic: [u8; 8],
    /// The number of the format, in the four bytes after them. It moves when the layout does.
    pub(super) format: u32,
}

pub(super) const REPLAY: Kind = Kind { magic: *b"UMBRAREP", format: 1 };
pub(super) const DUMP: Kind = Kind { magic: *b"UMBRADMP", format: 1 };

impl Kind {
    /// A file with nothing in it yet.
    pub(super) fn begin(&self) -> Vec<u8> {
        let mut file = self.magic.to_vec();
        self.format.write(&mut file);
        file
    }

    /// Reads up to the first chunk.
    pub(super) fn enter(&self, reader: &mut Reader<'_>) -> Result<(), ReplayError> {
        if reader.take(self.magic.len()).ok() != Some(&self.magic) {
            return Err(ReplayError::Foreign);
        }
        match u32::read(reader) {
            Ok(found) if found == self.format => Ok(()),
            Ok(found) => Err(ReplayError::Format { found, known: self.format }),
            Err(_) => Err(ReplayError::CutOff { tick: 0 }),
        }
    }
}

/// What the whole file goes by: the first chunk.
pub(super) const HEAD: Tag = Tag(*b"HEAD");
/// A snapshot: the first, one every so often, and the last.
pub(super) const SNAPSHOT: Tag = Tag(*b"SNAP");
/// Some ticks, one after the other.
pub(super) const TICKS: Tag = Tag(*b"TICK");
/// The last chunk: without it the file was cut off.
pub(super) const DONE: Tag = Tag(*b"DONE");

/// How a replay was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Head {
    pub(super) physics_version: u32,
    /// The tick of the first snapshot.
    pub(super) tick: u64,
    /// A hash after every so many ticks.
    pub(super) hash_every: u32,
    /// A snapshot after every so many; 0 for none but the first and the last.
    pub(super) snapshot_every: u32,
}

impl Head {
    /// The tick of the world after so many.
    pub(super) fn tick_after(&self, ticks: u64) -> u64 {
        limits::tick_after(self.tick, ticks)
    }
}

impl Write for Head {
    fn write(&self, out: &mut impl Encoder) {
        let Self { physics_version, tick, hash_every, snapshot_every } = self;
        codec::field(out, "physics_version", physics_version);
        codec::field(out, "tick", tick);
        codec::field(out, "hash_every", hash_every);
        codec::field(out, "snapshot_every", snapshot_every);
    }
}

impl Read for Head {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self {
            physics_version: u32::read(reader)?,
            tick: u64::read(reader)?,
            hash_every: u32::read(reader)?,
            snapshot_every: u32::read(reader)?,
        })
    }
}

/// What was done in a tick that is being recorded.
pub(super) struct Doings<'a> {
    /// Calls outside of the players' inputs, carried out before them.
    pub(super) calls: &'a [Command],
    pub(super) inputs: &'a Inputs,
    /// The hash of the state after the step.
    pub(super) hash: Option<u64>,
}

impl Write for Doings<'_> {
    fn write(&self, out: &mut impl Encoder) {
        let Self { calls, inputs, hash } = self;
        out.enter(Part::Name("calls"));
        codec::list(out, calls.iter());
        out.leave();
        out.enter(Part::Name("inputs"));
        codec::list(out, inputs.iter());
        out.leave();
        codec::field(out, "hash", hash);
    }
}

/// A list as it stands in a file, looked through when it was read, and read again whenever it is used: a command takes a byte
/// there and up to 256 in memory, so that a list of them would be no small multiple of its file.
pub(super) struct List<'a, T> {
    pub(super) count: u32,
    bytes: &'a [u8],
    entries: PhantomData<T>,
}

impl<T> Clone for List<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for List<'_, T> {}

impl<'a, T: Read> List<'a, T> {
    /// Reads a list of entries of at least so many bytes, each of which may follow the one before.
    fn read(
        reader: &mut Reader<'a>,
        least: usize,
        expected: &'static str,
        may_follow: impl Fn(&T, &T) -> bool,
    ) -> Result<Self, Malformed> {
        let count = reader.count(least)? as u32;
        let (start, mut last) = (reader.at(), None);
        for _ in 0..count {
            let malformed = reader.malformed(expected);
            let entry = T::read(reader)?;
            if last.is_some_and(|last| !may_follow(&last, &entry)) {
                return Err(malformed);
            }
            last = Some(entry);
        }
        Ok(Self { count, bytes: reader.since(start), entries: PhantomData })
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let mut reader = Reader::new(self.bytes);
        (0..self.count).map_while(move |_| T::read(&mut reader).ok())
    }

    /// Whether the bytes are the same.
    pub(super) fn is(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

impl<T: Read + Write> Write for List<'_, T> {
    fn write(&self, out: &mut impl Encoder) {
        codec::count(out, self.count as usize);
        for (i, entry) in (0..).zip(self.iter()) {
            out.enter(Part::Entry(i));
            entry.write(out);
            out.leave();
        }
    }
}

/// What was done in a tick, and what came of it, as it stands in a file.
#[derive(Clone, Copy)]
pub(super) struct Tick<'a> {
    pub(super) calls: List<'a, Command>,
    pub(super) inputs: List<'a, Input>,
    pub(super) hash: Option<u64>,
}

impl<'a> Tick<'a> {
    /// Two lengths, and whether there is a hash.
    const LEAST_BYTES: usize = 9;

    pub(super) fn read(reader: &mut Reader<'a>) -> Result<Self, Malformed> {
        // A player, a sequence, and the shortest command.
        let least = 8 + Command::LEAST_BYTES;
        let in_order = |a: &Input, b: &Input| (a.player, a.sequence) < (b.player, b.sequence);
        Ok(Self {
            calls: List::read(reader, Command::LEAST_BYTES, "a command", |_, _| true)?,
            inputs: List::read(reader, least, "inputs by player and sequence", in_order)?,
            hash: Option::read(reader)?,
        })
    }
}

impl Write for Tick<'_> {
    fn write(&self, out: &mut impl Encoder) {
        let Self { calls, inputs, hash } = self;
        codec::field(out, "calls", calls);
        codec::field(out, "inputs", inputs);
        codec::field(out, "hash", hash);
    }
}

/// Some ticks, one after the other, as they stand in a file.
#[derive(Clone, Copy)]
pub(super) struct Segment<'a> {
    /// The tick the world was at before the first.
    pub(super) tick: u64,
    pub(super) count: u32,
    bytes: &'a [u8],
}

impl<'a> Segment<'a> {
    /// The contents of a chunk of ticks begin with these many bytes: its tick, and how many there are.
    pub(super) const HEAD: usize = 12;

    pub(super) fn read(reader: &mut Reader<'a>) -> Result<Self, Malformed> {
        Self::read_and(reader, |_, _| Ok(()))
    }

    /// The same, with each tick looked at: with how many bytes the chunk has up to it, or refused for what should be there.
    pub(super) fn read_and(
        reader: &mut Reader<'a>,
        mut look: impl FnMut(&Tick<'a>, usize) -> Result<(), &'static str>,
    ) -> Result<Self, Malformed> {
        let head = reader.at();
        let tick = u64::read(reader)?;
        let count = reader.count(Tick::LEAST_BYTES)? as u32;
        let start = reader.at();
        for _ in 0..count {
            let at = reader.at() as u64;
            let tick = Tick::read(reader)?;
            look(&tick, reader.at() - head).map_err(|expected| Malformed { at, expected })?;
        }
        Ok(Self { tick, count, bytes: reader.since(start) })
    }

    pub(super) fn ticks(&self) -> impl Iterator<Item = Tick<'a>> + use<'a> {
        let mut reader = Reader::new(self.bytes);
        (0..self.count).map_while(move |_| Tick::read(&mut reader).ok())
    }
}

impl Write for Segment<'_> {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "tick", &self.tick);
        out.enter(Part::Name("ticks"));
        codec::count(out, self.count as usize);
        for (i, tick) in (0..).zip(self.ticks()) {
            out.enter(Part::Entry(i));
            tick.write(out);
            out.leave();
        }
        out.leave();
    }
}

/// Where a replay ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Done {
    pub(super) tick: u64,
    pub(super) hash: u64,
}

impl Write for Done {
    fn write(&self, out: &mut impl Encoder) {
        let Self { tick, hash } = self;
        codec::field(out, "tick", tick);
        codec::field(out, "hash", hash);
    }
}

impl Read for Done {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { tick: u64::read(reader)?, hash: u64::read(reader)? })
    }
}
