//! The frame of files: chunks, each with a code that finds damage and tells what was there before.
//!
//! A chunk is a word that says what it is and how long, the same word with every bit turned over, its bytes, and a seal: the XXH3 of word and bytes,
//! and two sums over the bytes taken as 64-bit words wₖ: Σ wₖ and Σ (k + 1)·wₖ. If one word was changed by d, the sums are
//! off by d and by (k + 1)·d: their ratio says which word it is, their size what it was, and the hash that this is so.

use alloc::vec::Vec;

use crate::wire::{Malformed, Out as _, Read, Reader, Sink};

/// The word before a chunk, twice, and the seal behind it.
pub(super) const FRAME: usize = 16 + SEAL;
const SEAL: usize = 8 + 16 + 16;

/// What a chunk holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tag(pub(super) [u8; 4]);

/// A chunk of a file, whole again if it could be made so.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub(super) tag: Tag,
    /// Where its bytes begin in the file.
    pub(super) at: usize,
    pub(super) bytes: Vec<u8>,
    pub(super) damage: Option<Damage>,
}

/// How a chunk was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Damage {
    /// The word before it, or its double.
    Word { at: usize, recorded: u64, found: u64 },
    /// A word of its bytes, at this index of them; the bytes are as they were again.
    Bytes { at: usize, recorded: u64, found: u64 },
    /// The seal.
    Seal { at: usize, recorded: u128, found: u128, part: &'static str },
    /// More than that.
    Unknown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seal {
    hash: u64,
    sum: u128,
    weighted: u128,
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u64> {
    bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    })
}

impl Seal {
    fn of(word: u64, bytes: &[u8]) -> Self {
        let mut sink = Sink::new();
        sink.bytes(&word.to_le_bytes());
        sink.bytes(bytes);
        // Fewer than 2^29 words: no sum wraps.
        let (mut sum, mut weighted) = (0, 0);
        for (k, word) in words(bytes).enumerate() {
            sum += u128::from(word);
            weighted += (k as u128 + 1) * u128::from(word);
        }
        Self { hash: sink.finish(), sum, weighted }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { hash: u64::read(reader)?, sum: u128::read(reader)?, weighted: u128::read(reader)? })
    }
}

fn word_of(tag: Tag, length: u32) -> u64 {
    u64::from(u32::from_le_bytes(tag.0)) | u64::from(length) << 32
}

/// Puts a chunk at the end of a file. *Domain* fewer than 2^32 bytes.
pub(super) fn write(file: &mut Vec<u8>, tag: Tag, bytes: &[u8]) {
    let word = word_of(tag, bytes.len() as u32);
    let Seal { hash, sum, weighted } = Seal::of(word, bytes);
    file.extend_from_slice(&word.to_le_bytes());
    file.extend_from_slice(&(!word).to_le_bytes());
    file.extend_from_slice(bytes);
    file.extend_from_slice(&hash.to_le_bytes());
    file.extend_from_slice(&sum.to_le_bytes());
    file.extend_from_slice(&weighted.to_le_bytes());
}

/// Reads the next chunk.
pub(super) fn read(reader: &mut Reader<'_>) -> Result<Chunk, Malformed> {
    let at = reader.at();
    let (word, double) = (u64::read(reader)?, !u64::read(reader)?);
    if word == double {
        return body(reader, word);
    }
    // One of the two was changed: the one that a whole chunk follows is right.
    let changed = [
        (double, Damage::Word { at, recorded: double, found: word }),
        (word, Damage::Word { at: at + 8, recorded: !word, found: !double }),
    ];
    for (right, damage) in changed {
        let mut attempt = reader.clone();
        if let Ok(mut chunk) = body(&mut attempt, right) {
            if chunk.damage.is_none() {
                *reader = attempt;
                chunk.damage = Some(damage);
                return Ok(chunk);
            }
        }
    }
    Err(Malformed { at: at as u64, expected: "the beginning of a chunk" })
}

fn body(reader: &mut Reader<'_>, word: u64) -> Result<Chunk, Malformed> {
    let tag = Tag((word as u32).to_le_bytes());
    let at = reader.at();
    let mut bytes = reader.take((word >> 32) as usize)?.to_vec();
    let end = reader.at();
    let (recorded, found) = (Seal::read(reader)?, Seal::of(word, &bytes));
    let damage = (recorded != found).then(|| repair(word, &mut bytes, end, recorded, found));
    Ok(Chunk { tag, at, bytes, damage })
}

/// Finds out what was changed, and undoes it.
fn repair(word: u64, bytes: &mut [u8], end: usize, recorded: Seal, found: Seal) -> Damage {
    if recorded.hash == found.hash {
        let (at, recorded, found, part) = if recorded.sum == found.sum {
            (end + 24, recorded.weighted, found.weighted, "weighted_sum")
        } else {
            (end + 8, recorded.sum, found.sum, "sum")
        };
        // What is there was the change, what the bytes give was recorded.
        return Damage::Seal { at, recorded: found, found: recorded, part };
    }
    if recorded.sum == found.sum && recorded.weighted == found.weighted {
        return Damage::Seal { at: end, recorded: found.hash.into(), found: recorded.hash.into(), part: "hash" };
    }
    let change = found.sum.wrapping_sub(recorded.sum) as i128;
    let weighted = found.weighted.wrapping_sub(recorded.weighted) as i128;
    let Some(k) = weighted.checked_div(change).filter(|k| k.checked_mul(change) == Some(weighted)) else {
        return Damage::Unknown;
    };
    let Some(k) = usize::try_from(k - 1).ok().filter(|k| *k < bytes.len().div_ceil(8)) else { return Damage::Unknown };
    let at = 8 * k;
    let is = words(&bytes[at..]).next().unwrap_or_default();
    let Ok(was) = u64::try_from(i128::from(is) - change) else { return Damage::Unknown };
    let length = 8.min(bytes.len() - at);
    bytes[at..at + length].copy_from_slice(&was.to_le_bytes()[..length]);
    if Seal::of(word, bytes) == recorded {
        return Damage::Bytes { at, recorded: was, found: is };
    }
    bytes[at..at + length].copy_from_slice(&is.to_le_bytes()[..length]);
    Damage::Unknown
}
