//! Values as bytes: little-endian whatever the machine, without padding, each list after its length.
//!
//! One walk over the fields of a value, [`Write`], serves all who need it: a hash, a file, and the index that says which
//! field a byte of a file belongs to and what it holds. [`Read`] is the way back, for what is kept in files.

mod index;
mod sink;
mod values;

use alloc::vec::Vec;
use core::fmt::{self, Display};

use crate::error::codes;

pub(crate) use index::{FieldIndex, FieldValue, Wanted, first_difference};
pub(crate) use sink::StateHasher;

/// Where bytes go.
pub(crate) trait Encoder {
    fn bytes(&mut self, bytes: &[u8]);

    /// What follows, up to [`leave`](Self::leave), is this part of the value. Only an [`FieldIndex`] listens.
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
    fn write(&self, out: &mut impl Encoder);
}

/// A value that can be had back from its bytes. It is checked as far as it can be by itself; what makes it part of a world
/// checks the rest.
pub(crate) trait Read: Sized {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed>;
}

/// Bytes that are not what they should be.
///
/// ```
/// use umbra_physics::{Command, Malformed};
///
/// let Err(error @ Malformed { at, expected, .. }) = Command::from_bytes(&[255]) else { unreachable!() };
/// assert_eq!((at, expected, error.code()), (0, "the number of a command", 320));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
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

codes!(Malformed = 320);

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

impl Encoder for Vec<u8> {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.extend_from_slice(bytes);
    }
}

/// A field of a value.
#[inline]
pub(crate) fn field(out: &mut impl Encoder, name: &'static str, value: &impl Write) {
    out.enter(Part::Name(name));
    value.write(out);
    out.leave();
}

/// The length of a list; no list has 2^32 entries.
pub(crate) fn count(out: &mut impl Encoder, count: usize) {
    field(out, "count", &(count as u32));
}

/// A list, after its length.
pub(crate) fn list<'a, T: Write + 'a>(out: &mut impl Encoder, entries: impl ExactSizeIterator<Item = &'a T>) {
    count(out, entries.len());
    for (i, entry) in entries.enumerate() {
        out.enter(Part::Entry(i as u32));
        entry.write(out);
        out.leave();
    }
}

/// `Write` and `Read` field by field. A field that is not in the list does not compile.
macro_rules! codec_struct {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl<S: $crate::scalar::Scalar> $crate::codec::Write for $type<S> {
            fn write(&self, out: &mut impl $crate::codec::Encoder) {
                let Self { $($field),* } = self;
                $($crate::codec::field(out, stringify!($field), $field);)*
            }
        }

        impl $crate::codec::Read for $type<$crate::scalar::fx::Fx> {
            fn read(reader: &mut $crate::codec::Reader<'_>) -> Result<Self, $crate::codec::Malformed> {
                Ok(Self { $($field: $crate::codec::Read::read(reader)?),* })
            }
        }
    };
}

/// The same for the variants of an enum, each after a byte that tells which. A variant that is not in the list does not
/// compile; a number, once given, stays.
macro_rules! codec_enum {
    ($type:ident $(<$s:ident>)?, $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $(<$s: $crate::scalar::Scalar>)? $crate::codec::Write for $type $(<$s>)? {
            fn write(&self, out: &mut impl $crate::codec::Encoder) {
                match self {
                    $(Self::$variant $({ $($field),* })? $(( $($entry),* ))? => {
                        out.leaf(&[$tag], &stringify!($variant));
                        $($($crate::codec::field(out, stringify!($field), $field);)*)?
                        $($($crate::codec::field(out, stringify!($entry), $entry);)*)?
                    })*
                }
            }
        }

        codec_enum!(@read $type $(<$s>)?, $expected, {
            $($tag => $variant $({ $($field),* })? $(( $($entry),* ))?),*
        });
    };
    (@read $type:ident <$s:ident>, $expected:literal, $variants:tt) => {
        codec_enum!(@from [$type<$crate::scalar::fx::Fx>], $expected, $variants);
    };
    (@read $type:ident, $expected:literal, $variants:tt) => {
        codec_enum!(@from [$type], $expected, $variants);
    };
    (@from [$type:ty], $expected:literal, {
        $($tag:literal => $variant:ident $({ $($field:ident),* })? $(( $($entry:ident),* ))?),* $(,)?
    }) => {
        impl $crate::codec::Read for $type {
            fn read(reader: &mut $crate::codec::Reader<'_>) -> Result<Self, $crate::codec::Malformed> {
                let malformed = reader.malformed($expected);
                match <u8 as $crate::codec::Read>::read(reader)? {
                    $($tag => {
                        $($(let $field = $crate::codec::Read::read(reader)?;)*)?
                        $($(let $entry = $crate::codec::Read::read(reader)?;)*)?
                        Ok(Self::$variant $({ $($field),* })? $(( $($entry),* ))?)
                    })*
                    _ => Err(malformed),
                }
            }
        }
    };
}

pub(crate) use {codec_enum, codec_struct};
