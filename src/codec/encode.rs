//! Encoding: one walk over the fields of a value.

use alloc::vec::Vec;
use core::fmt::Display;

/// A consumer of the bytes of a value: a buffer, a hash, an index.
pub(crate) trait Encoder {
    fn bytes(&mut self, bytes: &[u8]);

    /// Begins a part of the value, which ends with [`leave`](Self::leave). Only a [`FieldIndex`](super::index::FieldIndex) needs
    /// to know.
    #[inline]
    fn enter(&mut self, _part: Part) {}

    #[inline]
    fn leave(&mut self) {}

    /// Takes the bytes of a value without parts, and its text.
    #[inline]
    fn leaf(&mut self, bytes: &[u8], _value: &dyn Display) {
        self.bytes(bytes);
    }
}

/// A part of a value: a field by its name, or an entry of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    Name(&'static str),
    Entry(u32),
}

/// A value that can be encoded.
pub(crate) trait Write {
    fn write(&self, out: &mut impl Encoder);
}

impl Encoder for Vec<u8> {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.extend_from_slice(bytes);
    }
}

/// Encodes a field of a value.
#[inline]
pub(crate) fn field(out: &mut impl Encoder, name: &'static str, value: &impl Write) {
    out.enter(Part::Name(name));
    value.write(out);
    out.leave();
}

/// Encodes the length of a list; no list has 2^32 entries.
pub(crate) fn count(out: &mut impl Encoder, count: usize) {
    field(out, "count", &(count as u32));
}

/// Encodes a list, after its length.
pub(crate) fn list<'a, T: Write + 'a>(out: &mut impl Encoder, entries: impl ExactSizeIterator<Item = &'a T>) {
    count(out, entries.len());
    for (i, entry) in entries.enumerate() {
        out.enter(Part::Entry(i as u32));
        entry.write(out);
        out.leave();
    }
}
