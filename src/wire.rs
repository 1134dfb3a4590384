//! Values as bytes: little-endian whatever the machine, without padding, each list after its length.
//!
//! One walk over the fields of a value, [`Write`], serves all who need it: a hash, a file, and the index that says which
//! field a byte of a file belongs to and what it holds. [`Read`] is the way back, for what is kept in files.

use alloc::string::{String, ToString};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::{self, Display};

use xxhash_rust::xxh3::Xxh3;

use crate::handle::{BodyId, FieldId};
use crate::math::{Elapsed, Random, TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor, FxSum, FxWide, Number, Turn, fx::Fx};

/// Where bytes go.
pub(crate) trait Out {
    fn bytes(&mut self, bytes: &[u8]);

    /// What follows, up to [`leave`](Self::leave), is this part of the value. Only an [`Index`] listens.
    #[inline]
    fn enter(&mut self, _part: Part) {}

    #[inline]
    fn leave(&mut self) {}

    /// Bytes that are one value, which reads like this.
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

/// A value that can be walked over.
pub(crate) trait Write {
    fn write(&self, out: &mut impl Out);
}

/// A value that can be had back from its bytes. It is checked as far as it can be by itself; what makes it part of a world
/// checks the rest.
pub(crate) trait Read: Sized {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed>;
}

/// Bytes that are not what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Malformed {
    /// Where, counted from the start of what was read.
    pub at: u64,
    /// What should be there.
    pub expected: &'static str,
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "byte {}: expected {}", self.at, self.expected)
    }
}

impl core::error::Error for Malformed {}

/// Bytes being read.
#[derive(Clone)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// What is wrong here.
    pub(crate) fn malformed(&self, expected: &'static str) -> Malformed {
        Malformed { at: self.at as u64, expected }
    }

    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// The bytes from there to here.
    pub(crate) fn since(&self, start: usize) -> &'a [u8] {
        &self.bytes[start..self.at]
    }

    pub(crate) fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], Malformed> {
        if count > self.rest() {
            return Err(self.malformed("more bytes"));
        }
        let taken = &self.bytes[self.at..][..count];
        self.at += count;
        Ok(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn words<const N: usize>(&mut self) -> Result<[u64; N], Malformed> {
        let mut words = [0; N];
        for word in &mut words {
            *word = u64::from_le_bytes(self.array()?);
        }
        Ok(words)
    }

    /// The length of a list whose entries have at least so many bytes: what cannot be there is refused before it is made
    /// room for.
    pub(crate) fn count(&mut self, least: usize) -> Result<usize, Malformed> {
        let at = self.at;
        let count = u32::read(self)? as usize;
        if count > self.rest() / least.max(1) {
            self.at = at;
            return Err(self.malformed("a length that the bytes after it can have"));
        }
        Ok(count)
    }

    /// Refuses what is left over.
    pub(crate) fn end(&self) -> Result<(), Malformed> {
        if self.rest() == 0 { Ok(()) } else { Err(self.malformed("the end")) }
    }
}

impl Out for Vec<u8> {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.extend_from_slice(bytes);
    }
}

/// So many values are handed to a hash at once.
const PIECE: usize = 128;

/// A hash: XXH3, 64 bits (Collet).
pub(crate) struct Sink(Xxh3);

impl Out for Sink {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }
}

impl Sink {
    pub(crate) fn new() -> Self {
        Self(Xxh3::new())
    }

    pub(crate) fn finish(&self) -> u64 {
        self.0.digest()
    }

    /// The hash of one value.
    pub(crate) fn of(value: &impl Write) -> u64 {
        let mut sink = Self::new();
        value.write(&mut sink);
        sink.finish()
    }

    /// The hash of bytes.
    pub(crate) fn of_bytes(bytes: &[u8]) -> u64 {
        xxhash_rust::xxh3::xxh3_64(bytes)
    }

    /// Many values at once, each as so many bytes. Hashing takes larger pieces than one value faster.
    pub(crate) fn all<T: Copy, const BYTES: usize>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; BYTES]) {
        let mut piece = [[0; BYTES]; PIECE];
        for values in values.chunks(PIECE) {
            for (to, value) in piece.iter_mut().zip(values) {
                *to = bytes(*value);
            }
            self.0.update(piece[..values.len()].as_flattened());
        }
    }

    /// The same of values that do not stand side by side.
    pub(crate) fn each<T, const BYTES: usize>(
        &mut self,
        mut values: impl Iterator<Item = T>,
        bytes: impl Fn(T) -> [u8; BYTES],
    ) {
        let mut piece = [[0; BYTES]; PIECE];
        loop {
            let mut count = 0;
            for (to, value) in piece.iter_mut().zip(&mut values) {
                *to = bytes(value);
                count += 1;
            }
            if count == 0 {
                return;
            }
            self.0.update(piece[..count].as_flattened());
        }
    }
}

/// The values of which a value is made: where each stands among its bytes, its name and how it reads.
#[derive(Debug, Default)]
pub(crate) struct Index {
    path: Vec<Part>,
    end: usize,
    wanted: Wanted,
    pub(crate) leaves: Vec<Leaf>,
}

/// Which values an index keeps: one takes some hundred bytes, however few it stands for.
#[derive(Debug, Default)]
pub(crate) enum Wanted {
    #[default]
    All,
    /// The one that this byte belongs to.
    At(usize),
    /// Those at this path.
    On(Vec<Part>),
}

/// A value that has no parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Leaf {
    pub(crate) path: Vec<Part>,
    pub(crate) at: usize,
    pub(crate) bytes: Vec<u8>,
    pub(crate) text: String,
}

impl Index {
    pub(crate) fn of(value: &impl Write) -> Self {
        let mut index = Self::default();
        value.write(&mut index);
        index
    }

    /// The first value that is wanted.
    pub(crate) fn find(value: &impl Write, wanted: Wanted) -> Option<Leaf> {
        let mut index = Self { wanted, ..Self::default() };
        value.write(&mut index);
        index.leaves.into_iter().next()
    }
}

impl Out for Index {
    fn bytes(&mut self, bytes: &[u8]) {
        struct Hex<'a>(&'a [u8]);
        impl Display for Hex<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
            }
        }
        self.leaf(bytes, &Hex(bytes));
    }

    fn enter(&mut self, part: Part) {
        self.path.push(part);
    }

    fn leave(&mut self) {
        self.path.pop();
    }

    fn leaf(&mut self, bytes: &[u8], value: &dyn Display) {
        let (at, end) = (self.end, self.end + bytes.len());
        let is_wanted = match &self.wanted {
            Wanted::All => true,
            Wanted::At(byte) => at <= *byte && *byte < end,
            Wanted::On(path) => *path == self.path,
        };
        if is_wanted {
            self.leaves.push(Leaf { path: self.path.clone(), at, bytes: bytes.to_vec(), text: value.to_string() });
        }
        self.end = end;
    }
}

/// A field of a value.
#[inline]
pub(crate) fn field(out: &mut impl Out, name: &'static str, value: &impl Write) {
    out.enter(Part::Name(name));
    value.write(out);
    out.leave();
}

/// The length of a list; no list has 2^32 entries.
pub(crate) fn count(out: &mut impl Out, count: usize) {
    field(out, "count", &(count as u32));
}

/// A list, after its length.
pub(crate) fn list<'a, T: Write + 'a>(out: &mut impl Out, entries: impl ExactSizeIterator<Item = &'a T>) {
    count(out, entries.len());
    for (i, entry) in entries.enumerate() {
        out.enter(Part::Entry(i as u32));
        entry.write(out);
        out.leave();
    }
}

/// `Write` and `Read` field by field. A field that is not in the list does not compile.
macro_rules! wire_struct {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl<S: $crate::scalar::Scalar> $crate::wire::Write for $type<S> {
            fn write(&self, out: &mut impl $crate::wire::Out) {
                let Self { $($field),* } = self;
                $($crate::wire::field(out, stringify!($field), $field);)*
            }
        }

        impl $crate::wire::Read for $type<$crate::scalar::fx::Fx> {
            fn read(reader: &mut $crate::wire::Reader<'_>) -> Result<Self, $crate::wire::Malformed> {
                Ok(Self { $($field: $crate::wire::Read::read(reader)?),* })
            }
        }
    };
}

/// The same for the variants of an enum, each after a byte that tells which. A variant that is not in the list does not
/// compile; a number, once given, stays.
macro_rules! wire_enum {
    ($type:ident $(<$s:ident>)?, $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $(<$s: $crate::scalar::Scalar>)? $crate::wire::Write for $type $(<$s>)? {
            fn write(&self, out: &mut impl $crate::wire::Out) {
                match self {
                    $(Self::$variant $({ $($field),* })? $(( $($entry),* ))? => {
                        out.leaf(&[$tag], &stringify!($variant));
                        $($($crate::wire::field(out, stringify!($field), $field);)*)?
                        $($($crate::wire::field(out, stringify!($entry), $entry);)*)?
                    })*
                }
            }
        }

        wire_enum!(@read $type $(<$s>)?, $expected, {
            $($tag => $variant $({ $($field),* })? $(( $($entry),* ))?),*
        });
    };
    (@read $type:ident <$s:ident>, $expected:literal, $variants:tt) => {
        wire_enum!(@from [$type<$crate::scalar::fx::Fx>], $expected, $variants);
    };
    (@read $type:ident, $expected:literal, $variants:tt) => {
        wire_enum!(@from [$type], $expected, $variants);
    };
    (@from [$type:ty], $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $crate::wire::Read for $type {
            fn read(reader: &mut $crate::wire::Reader<'_>) -> Result<Self, $crate::wire::Malformed> {
                let malformed = reader.malformed($expected);
                match <u8 as $crate::wire::Read>::read(reader)? {
                    $($tag => {
                        $($(let $field = $crate::wire::Read::read(reader)?;)*)?
                        $($(let $entry = $crate::wire::Read::read(reader)?;)*)?
                        Ok(Self::$variant $({ $($field),* })? $(( $($entry),* ))?)
                    })*
                    _ => Err(malformed),
                }
            }
        }
    };
}

pub(crate) use {wire_enum, wire_struct};

impl<N: Number> Write for N {
    #[inline]
    fn write(&self, out: &mut impl Out) {
        let words = self.to_words().map(u64::to_le_bytes);
        out.leaf(words[..N::WORDS].as_flattened(), self);
    }
}

macro_rules! wire_integers {
    ($($integer:ident)*) => { $(
        impl Write for $integer {
            #[inline]
            fn write(&self, out: &mut impl Out) {
                out.leaf(&self.to_le_bytes(), self);
            }
        }

        impl Read for $integer {
            fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
                reader.array().map(Self::from_le_bytes)
            }
        }
    )* };
}

wire_integers!(u8 u16 u32 u64 u128);

impl Read for Fx {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|[bits]| Self::from_bits(bits as i64))
    }
}

impl Read for Turn {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|[bits]| Self::from_bits(bits))
    }
}

fn wide_bits([high, low]: [u64; 2]) -> i128 {
    i128::from(high as i64) << 64 | i128::from(low)
}

impl Read for FxAccumulator {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|words| Self::from_bits(wide_bits(words)))
    }
}

impl Read for FxWide {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|words| Self::from_bits(wide_bits(words)))
    }
}

impl Read for FxSum {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(Self::from_words)
    }
}

impl Read for FxFactor {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a factor");
        Self::from_words(reader.words()?).ok_or(malformed)
    }
}

impl<T: Write> Write for Arc<T> {
    fn write(&self, out: &mut impl Out) {
        (**self).write(out);
    }
}

impl Write for bool {
    fn write(&self, out: &mut impl Out) {
        out.leaf(&[u8::from(*self)], self);
    }
}

impl Read for bool {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("0 or 1");
        match u8::read(reader)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(malformed),
        }
    }
}

impl<T: Write> Write for Option<T> {
    fn write(&self, out: &mut impl Out) {
        field(out, "given", &self.is_some());
        if let Some(value) = self {
            value.write(out);
        }
    }
}

impl<T: Read> Read for Option<T> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        if bool::read(reader)? { T::read(reader).map(Some) } else { Ok(None) }
    }
}

impl<T: Write> Write for Vec2<T> {
    fn write(&self, out: &mut impl Out) {
        field(out, "x", &self.x);
        field(out, "y", &self.y);
    }
}

impl<T: Read> Read for Vec2<T> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { x: T::read(reader)?, y: T::read(reader)? })
    }
}

macro_rules! wire_handles {
    ($($handle:ident)*) => { $(
        impl Write for $handle {
            fn write(&self, out: &mut impl Out) {
                let (slot, generation) = self.parts();
                let bytes = [slot.to_le_bytes(), generation.to_le_bytes()];
                out.leaf(bytes.as_flattened(), self);
            }
        }

        impl Read for $handle {
            fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
                Ok(Self::from_parts(u32::read(reader)?, u32::read(reader)?))
            }
        }
    )* };
}

wire_handles!(BodyId FieldId);

impl Write for TimeStep {
    fn write(&self, out: &mut impl Out) {
        let (num, den) = self.seconds();
        field(out, "num", &num);
        field(out, "den", &den);
    }
}

impl Read for TimeStep {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a time step in lowest terms");
        let written = (u32::read(reader)?, u32::read(reader)?);
        let step = Self::ratio(written.0, written.1);
        // Each has one form: equal worlds have equal bytes.
        if step.seconds() == written { Ok(step) } else { Err(malformed) }
    }
}

impl Write for Elapsed {
    fn write(&self, out: &mut impl Out) {
        field(out, "num", &self.num);
        field(out, "den", &self.den);
    }
}

impl Read for Elapsed {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { num: u128::read(reader)?, den: u128::read(reader)? })
    }
}

impl Write for Random {
    fn write(&self, out: &mut impl Out) {
        let bytes = self.state().map(u64::to_le_bytes);
        let [a, b, c, d] = self.state();
        out.leaf(bytes.as_flattened(), &format_args!("{a:016x} {b:016x} {c:016x} {d:016x}"));
    }
}

impl Read for Random {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a state of the generator");
        Self::from_state(reader.words()?).ok_or(malformed)
    }
}

/// Bytes of the caller's, after their number.
impl Write for Vec<u8> {
    fn write(&self, out: &mut impl Out) {
        count(out, self.len());
        // In pieces, so that an index can name them.
        for (i, piece) in self.chunks(64).enumerate() {
            out.enter(Part::Entry(i as u32));
            out.bytes(piece);
            out.leave();
        }
    }
}

impl Read for Vec<u8> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let count = reader.count(1)?;
        reader.take(count).map(<[u8]>::to_vec)
    }
}
