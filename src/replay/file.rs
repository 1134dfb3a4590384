//! What is in the chunks of a replay. `docs/formats.md` has them byte by byte.

use alloc::vec::Vec;

use super::chunk::Tag;
use super::error::ReplayError;
use crate::wire::{self, Malformed, Out, Part, Read, Reader, Write};
use crate::world::{Command, Inputs};

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
    pub(super) law: u32,
    /// The tick of the first snapshot.
    pub(super) tick: u64,
    /// A hash after every so many ticks.
    pub(super) hash_every: u32,
    /// A snapshot after every so many; 0 for none but the first and the last.
    pub(super) snapshot_every: u32,
}

impl Write for Head {
    fn write(&self, out: &mut impl Out) {
        let Self { law, tick, hash_every, snapshot_every } = self;
        wire::field(out, "law", law);
        wire::field(out, "tick", tick);
        wire::field(out, "hash_every", hash_every);
        wire::field(out, "snapshot_every", snapshot_every);
    }
}

impl Read for Head {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self {
            law: u32::read(reader)?,
            tick: u64::read(reader)?,
            hash_every: u32::read(reader)?,
            snapshot_every: u32::read(reader)?,
        })
    }
}

/// What was done in a tick, and what came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tick {
    /// Calls outside of the players' inputs, carried out before them.
    pub(super) calls: Vec<Command>,
    pub(super) inputs: Inputs,
    /// The hash of the state after the step.
    pub(super) hash: Option<u64>,
}

impl Write for Tick {
    fn write(&self, out: &mut impl Out) {
        let Self { calls, inputs, hash } = self;
        Doings { calls, inputs, hash: *hash }.write(out);
    }
}

/// A [`Tick`] that is not kept.
pub(super) struct Doings<'a> {
    pub(super) calls: &'a [Command],
    pub(super) inputs: &'a Inputs,
    pub(super) hash: Option<u64>,
}

impl Write for Doings<'_> {
    fn write(&self, out: &mut impl Out) {
        let Self { calls, inputs, hash } = self;
        out.enter(Part::Name("calls"));
        wire::list(out, calls.iter());
        out.leave();
        wire::field(out, "inputs", *inputs);
        wire::field(out, "hash", hash);
    }
}

impl Read for Tick {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self {
            calls: (0..reader.count(Command::LEAST_BYTES)?).map(|_| Command::read(reader)).collect::<Result<_, _>>()?,
            inputs: Inputs::read(reader)?,
            hash: Option::read(reader)?,
        })
    }
}

/// Some ticks, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Segment {
    /// The tick the world was at before the first.
    pub(super) tick: u64,
    pub(super) ticks: Vec<Tick>,
}

impl Write for Segment {
    fn write(&self, out: &mut impl Out) {
        wire::field(out, "tick", &self.tick);
        out.enter(Part::Name("ticks"));
        wire::list(out, self.ticks.iter());
        out.leave();
    }
}

impl Read for Segment {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        // Two lengths and whether there is a hash.
        let tick = u64::read(reader)?;
        Ok(Self { tick, ticks: (0..reader.count(9)?).map(|_| Tick::read(reader)).collect::<Result<_, _>>()? })
    }
}

/// Where a replay ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Done {
    pub(super) tick: u64,
    pub(super) hash: u64,
}

impl Write for Done {
    fn write(&self, out: &mut impl Out) {
        let Self { tick, hash } = self;
        wire::field(out, "tick", tick);
        wire::field(out, "hash", hash);
    }
}

impl Read for Done {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { tick: u64::read(reader)?, hash: u64::read(reader)? })
    }
}
