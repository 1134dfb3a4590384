//! Decoding, with every value checked.

use core::fmt;

use crate::codes::codes;

/// A value that can be decoded. It is checked as far as possible by itself; the rest is checked when it becomes part of a
/// world.
pub(crate) trait Read: Sized {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed>;
}

/// Malformed bytes.
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
    /// The position, counted from the start of the input.
    pub at: u64,
    /// A description of what should be there.
    pub expected: &'static str,
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "byte {}: expected {}", self.at, self.expected)
    }
}

codes!(Malformed = 320);

impl core::error::Error for Malformed {}

/// Bytes that are being decoded.
#[derive(Clone)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The error that here something else is expected.
    pub(crate) fn malformed(&self, expected: &'static str) -> Malformed {
        Malformed { at: self.at as u64, expected }
    }

    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// The bytes from a position to here.
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

    pub(super) fn words<const N: usize>(&mut self) -> Result<[u64; N], Malformed> {
        let mut words = [0; N];
        for word in &mut words {
            *word = u64::from_le_bytes(self.array()?);
        }
        Ok(words)
    }

    /// Reads the length of a list whose entries have at least `least` bytes each. A length that the rest of the input cannot
    /// have is refused before memory is reserved for it.
    pub(crate) fn count(&mut self, least: usize) -> Result<usize, Malformed> {
        let at = self.at;
        let count = u32::read(self)? as usize;
        if count > self.rest() / least.max(1) {
            self.at = at;
            return Err(self.malformed("a length that the bytes after it can have"));
        }
        Ok(count)
    }

    /// Refuses bytes that are left over.
    pub(crate) fn end(&self) -> Result<(), Malformed> {
        if self.rest() == 0 { Ok(()) } else { Err(self.malformed("the end")) }
    }
}
