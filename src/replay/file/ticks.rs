//! The ticks of a replay: the calls and inputs of each, as they stand in the file.

use alloc::string::{String, ToString as _};
use alloc::vec::Vec;
use core::marker::PhantomData;

use crate::codec::{self, Encoder, FieldIndex, FieldValue, Malformed, Part, Read, Reader, Write};
use crate::replay::diff::{Difference, TickPhase, name_of};
use crate::replay::snapshot::Owner;
use crate::world::{Command, Input, Inputs};

/// The calls and inputs of a tick that is being recorded.
pub(in crate::replay) struct NewTick<'a> {
    /// The calls that are no input of a player; they come before the inputs.
    pub(in crate::replay) calls: &'a [Command],
    pub(in crate::replay) inputs: &'a Inputs,
    /// The hash of the state after the step.
    pub(in crate::replay) hash: Option<u64>,
}

impl Write for NewTick<'_> {
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

/// A list as it stands in a file. It is checked once, and decoded again whenever it is used: a command takes at least one byte
/// in the file and up to 256 in memory, so that a decoded list would be many times as large as its file.
pub(in crate::replay) struct List<'a, T> {
    pub(in crate::replay) count: u32,
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
    /// Reads a list of entries of at least `least` bytes. `may_follow` says whether an entry may follow another.
    fn read(
        reader: &mut Reader<'a>,
        least: usize,
        expected: &'static str,
        may_follow: impl Fn(&T, &T) -> bool,
    ) -> Result<Self, Malformed> {
        let count = reader.count(least)? as u32;
        let start = reader.at();
        let mut last = None;
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

    pub(in crate::replay) fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let mut reader = Reader::new(self.bytes);
        (0..self.count).map_while(move |_| T::read(&mut reader).ok())
    }

    /// Says whether two lists have the same bytes.
    fn is_same(&self, rhs: &Self) -> bool {
        self.bytes == rhs.bytes
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

/// The calls and inputs of a tick and the hash after it, as they stand in a file.
#[derive(Clone, Copy)]
pub(in crate::replay) struct Tick<'a> {
    pub(in crate::replay) calls: List<'a, Command>,
    pub(in crate::replay) inputs: List<'a, Input>,
    pub(in crate::replay) hash: Option<u64>,
}

impl<'a> Tick<'a> {
    /// The lengths of two lists, and whether there is a hash.
    const LEAST_BYTES: usize = 9;

    pub(in crate::replay) fn read(reader: &mut Reader<'a>) -> Result<Self, Malformed> {
        let in_order = |a: &Input, b: &Input| (a.player, a.sequence) < (b.player, b.sequence);
        Ok(Self {
            calls: List::read(reader, Command::LEAST_BYTES, "a command", |_, _| true)?,
            inputs: List::read(reader, Input::<crate::fx::Fx>::LEAST_BYTES, "inputs by player and sequence", in_order)?,
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

/// Some ticks in a row, as they stand in a file.
#[derive(Clone, Copy)]
pub(in crate::replay) struct Segment<'a> {
    /// The tick the world was at before the first.
    pub(in crate::replay) tick: u64,
    pub(in crate::replay) count: u32,
    bytes: &'a [u8],
}

impl<'a> Segment<'a> {
    /// The number of bytes before the first tick: the tick of the world, and the number of ticks.
    pub(in crate::replay) const HEAD: usize = 12;

    pub(in crate::replay) fn read(reader: &mut Reader<'a>) -> Result<Self, Malformed> {
        Self::read_and(reader, |_, _| Ok(()))
    }

    /// Reads the ticks and shows each to `look`, with the number of bytes up to its end. `look` may refuse a tick, and says
    /// what is expected instead.
    pub(in crate::replay) fn read_and(
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

    pub(in crate::replay) fn ticks(&self) -> impl Iterator<Item = Tick<'a>> + use<'a> {
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

/// The first value in which the calls and inputs of a tick differ.
pub(in crate::replay) fn tick_difference(tick: u64, ours: &Tick<'_>, theirs: &Tick<'_>) -> Option<Difference> {
    let calls = list_difference("calls", &ours.calls, &theirs.calls);
    let ListDifference { path, left, right } =
        calls.or_else(|| list_difference("inputs", &ours.inputs, &theirs.inputs))?;
    let (phase, owner) = owner_in_tick(ours, &path);
    Some(Difference { tick, phase, owner, name: None, key: 0, field: name_of(&path), left, right })
}

/// The path at which two lists differ, and the value in each.
struct ListDifference {
    path: Vec<Part>,
    left: Option<String>,
    right: Option<String>,
}

/// The first value in which two lists differ: their length, or a value of an entry. Only that entry is indexed.
fn list_difference<T: Read + Write + PartialEq>(
    name: &'static str,
    ours: &List<'_, T>,
    theirs: &List<'_, T>,
) -> Option<ListDifference> {
    if ours.count != theirs.count {
        let [left, right] = [ours, theirs].map(|list| Some(list.count.to_string()));
        return Some(ListDifference { path: alloc::vec![Part::Name(name), Part::Name("count")], left, right });
    }
    if ours.is_same(theirs) {
        return None;
    }
    let (index, (ours, theirs)) = (0..).zip(ours.iter().zip(theirs.iter())).find(|(_, (a, b))| a != b)?;
    let (left, right) = (FieldIndex::of(&ours).leaves, FieldIndex::of(&theirs).leaves);
    let same = left.iter().zip(&right).take_while(|(a, b)| a == b).count();
    let (a, b) = (left.get(same), right.get(same));
    let within = a.or(b).map(|leaf| &leaf.path[..]).unwrap_or_default();
    let text = |leaf: Option<&FieldValue>| leaf.filter(|leaf| leaf.path == within).map(|leaf| leaf.text.clone());
    let path = [&[Part::Name(name), Part::Entry(index)], within].concat();
    Some(ListDifference { path, left: text(a), right: text(b) })
}

/// The phase of the value at a path in a tick, and the body or field that its command names.
pub(in crate::replay) fn owner_in_tick(tick: &Tick<'_>, path: &[Part]) -> (TickPhase, Owner) {
    let owner = |command: Option<Command>| command.map_or(Owner::World, |command| Owner::of_command(&command));
    match *path {
        [Part::Name("calls"), Part::Entry(i), ..] => (TickPhase::Calls, owner(tick.calls.iter().nth(i as usize))),
        [Part::Name("calls"), ..] => (TickPhase::Calls, Owner::World),
        [Part::Name("inputs"), Part::Entry(i), ..] => {
            (TickPhase::Inputs, owner(tick.inputs.iter().nth(i as usize).map(|input| input.command)))
        }
        [Part::Name("inputs"), ..] => (TickPhase::Inputs, Owner::World),
        _ => (TickPhase::End, Owner::World),
    }
}
