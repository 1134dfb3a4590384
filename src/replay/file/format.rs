//! The kinds of files and of their chunks. `docs/formats.md` describes them byte by byte.

use alloc::vec::Vec;

use super::chunk::Tag;
use super::error::ReplayError;
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::limits;
use crate::replay::diff::TickPhase;
use crate::replay::snapshot::Saved;
use crate::world::World;

/// A kind of file that is made of chunks.
pub(in crate::replay) struct Kind {
    /// The first bytes of the file.
    pub(in crate::replay) magic: [u8; 8],
    /// The number of the format, in the four bytes after the magic. It is increased whenever the layout changes.
    pub(in crate::replay) format: u32,
}

pub(in crate::replay) const REPLAY: Kind = Kind { magic: *b"UMBRAREP", format: 6 };
pub(in crate::replay) const DUMP: Kind = Kind { magic: *b"UMBRADMP", format: 7 };

impl Kind {
    /// Begins a file without chunks.
    pub(in crate::replay) fn begin(&self) -> Vec<u8> {
        let mut file = self.magic.to_vec();
        self.format.write(&mut file);
        file
    }

    /// Reads up to the first chunk.
    pub(in crate::replay) fn enter(&self, reader: &mut Reader<'_>) -> Result<(), ReplayError> {
        if reader.take(self.magic.len()).ok() != Some(&self.magic) {
            return Err(ReplayError::Foreign);
        }
        match u32::read(reader) {
            Ok(format) if format == self.format => Ok(()),
            Ok(format) => Err(ReplayError::Format { found: format, known: self.format }),
            Err(_) => Err(ReplayError::CutOff { tick: 0 }),
        }
    }
}

/// The settings of a recording: the first chunk of a replay.
pub(in crate::replay) const HEAD: Tag = Tag(*b"HEAD");
/// A snapshot: one at the start, one every so many ticks, and one at the end.
pub(in crate::replay) const SNAPSHOT: Tag = Tag(*b"SNAP");
/// Some ticks in a row.
pub(in crate::replay) const TICKS: Tag = Tag(*b"TICK");
/// The names of bodies, force fields and joints, if there are any: before the end.
pub(in crate::replay) const NAMES: Tag = Tag(*b"NAME");
/// The end: without this chunk the file was cut off.
pub(in crate::replay) const DONE: Tag = Tag(*b"DONE");
/// The physics version that a dump was made under: its first chunk.
pub(in crate::replay) const VERSION: Tag = Tag(*b"PHYS");
/// A phase of the tick of a dump, with the world if it differs from that of the phase before.
pub(in crate::replay) const PHASE: Tag = Tag(*b"PHAS");

/// The settings of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::replay) struct Head {
    pub(in crate::replay) physics_version: u32,
    /// The tick of the first snapshot.
    pub(in crate::replay) tick: u64,
    /// A hash after every so many ticks.
    pub(in crate::replay) hash_every: u32,
    /// A snapshot after every so many ticks; 0 for the first and the last alone.
    pub(in crate::replay) snapshot_every: u32,
}

impl Head {
    /// The tick of the world after so many ticks of the replay.
    pub(in crate::replay) fn tick_after(&self, ticks: u64) -> u64 {
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

/// The end of a replay or a dump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::replay) struct Done {
    pub(in crate::replay) tick: u64,
    pub(in crate::replay) hash: u64,
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

/// A phase in a dump: with the world, if it differs from that of the phase before.
pub(in crate::replay) struct PhaseState<'a> {
    pub(in crate::replay) phase: TickPhase,
    pub(in crate::replay) world: Option<&'a World>,
}

impl Write for PhaseState<'_> {
    fn write(&self, out: &mut impl Encoder) {
        let Self { phase, world } = self;
        write_phase(out, *phase, world.is_some());
        if let Some(world) = world {
            Saved(*world).write(out);
        }
    }
}

/// Writes a phase without its world.
pub(in crate::replay) fn write_phase(out: &mut impl Encoder, phase: TickPhase, is_new: bool) {
    codec::field(out, "phase", &phase);
    codec::field(out, "is_new", &is_new);
}
