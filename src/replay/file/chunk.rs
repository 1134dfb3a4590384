//! Chunks, of which files are made. Each has a hash that detects a change, and sums that recover the value before it.
//!
//! A chunk is a word with its tag and length, the same word with all bits inverted, its bytes, and a seal: the XXH3 of word
//! and bytes, and two sums over the bytes taken as words wₖ of 64 bits: Σ wₖ and Σ (k + 1)·wₖ. If one word was changed by d,
//! the sums are off by d and by (k + 1)·d. Their ratio gives the index of the word, d its value before, and the hash
//! confirms both. So a change of one word can be named with the recorded and the found value; any other change is refused.

use alloc::vec::Vec;

use crate::codec::{Encoder as _, Malformed, Read, Reader, StateHasher};

/// The kind of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::replay) struct Tag(pub(in crate::replay) [u8; 4]);

/// A chunk of a file. If one word of its bytes was changed, they are the recorded ones again.
#[derive(Clone, Debug)]
pub(in crate::replay) struct Chunk {
    pub(in crate::replay) tag: Tag,
    pub(in crate::replay) bytes: Vec<u8>,
    pub(in crate::replay) damage: Option<Damage>,
}

/// A change of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::replay) enum Damage {
    /// The word with tag and length was changed, or its inverted double.
    Word { recorded: u64, computed: u64, double: bool },
    /// A word of the bytes was changed; `at` is the index of its first byte.
    Bytes { at: usize, word: u64 },
    /// A part of the seal was changed.
    Seal { part: &'static str, recorded: u128, computed: u128 },
    /// More than one word was changed.
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
        let mut sink = StateHasher::new();
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

/// Appends a chunk to a file. *Domain* fewer than 2^32 bytes, which [`Recorder`](super::Recorder) asks of its caller.
pub(in crate::replay) fn write(file: &mut Vec<u8>, tag: Tag, bytes: &[u8]) {
    let word = word_of(tag, bytes.len() as u32);
    let Seal { hash, sum, weighted } = Seal::of(word, bytes);
    file.extend_from_slice(&word.to_le_bytes());
    file.extend_from_slice(&(!word).to_le_bytes());
    file.extend_from_slice(bytes);
    file.extend_from_slice(&hash.to_le_bytes());
    file.extend_from_slice(&sum.to_le_bytes());
    file.extend_from_slice(&weighted.to_le_bytes());
}

/// Reads the next chunk; `None` if the bytes end before it does.
pub(in crate::replay) fn read(reader: &mut Reader<'_>) -> Option<Chunk> {
    let mut attempt = reader.clone();
    let (word, double) = (u64::read(&mut attempt).ok()?, !u64::read(&mut attempt).ok()?);
    // If one of the two was changed, the right one is followed by an undamaged chunk.
    let chunk = if word == double {
        body(&mut attempt, word).ok()?
    } else {
        let changed = [
            (double, Damage::Word { recorded: double, computed: word, double: false }),
            (word, Damage::Word { recorded: !word, computed: !double, double: true }),
        ];
        changed.into_iter().find_map(|(right, damage)| {
            let mut after = attempt.clone();
            let chunk = body(&mut after, right).ok().filter(|chunk| chunk.damage.is_none())?;
            attempt = after;
            Some(Chunk { damage: Some(damage), ..chunk })
        })?
    };
    *reader = attempt;
    Some(chunk)
}

fn body(reader: &mut Reader<'_>, word: u64) -> Result<Chunk, Malformed> {
    let tag = Tag((word as u32).to_le_bytes());
    let mut bytes = reader.take((word >> 32) as usize)?.to_vec();
    let (recorded, computed) = (Seal::read(reader)?, Seal::of(word, &bytes));
    let damage = (recorded != computed).then(|| repair(word, &mut bytes, recorded, computed));
    Ok(Chunk { tag, bytes, damage })
}

/// Finds the word that was changed, and recovers the recorded one.
fn repair(word: u64, bytes: &mut [u8], recorded: Seal, computed: Seal) -> Damage {
    if recorded.hash == computed.hash {
        let (part, computed, recorded) = if recorded.sum == computed.sum {
            ("weighted_sum", recorded.weighted, computed.weighted)
        } else {
            ("sum", recorded.sum, computed.sum)
        };
        // The bytes are right: the sum they give is the recorded one.
        return Damage::Seal { part, recorded, computed };
    }
    if recorded.sum == computed.sum && recorded.weighted == computed.weighted {
        return Damage::Seal { part: "hash", recorded: computed.hash.into(), computed: recorded.hash.into() };
    }
    let change = computed.sum.wrapping_sub(recorded.sum) as i128;
    let weighted = computed.weighted.wrapping_sub(recorded.weighted) as i128;
    let Some(k) = weighted.checked_div(change).filter(|k| k.checked_mul(change) == Some(weighted)) else {
        return Damage::Unknown;
    };
    let k = k.checked_sub(1).and_then(|k| usize::try_from(k).ok());
    let Some(k) = k.filter(|k| *k < bytes.len().div_ceil(8)) else { return Damage::Unknown };
    let at = 8 * k;
    let is = words(&bytes[at..]).next().unwrap_or_default();
    let was = i128::from(is).checked_sub(change).and_then(|was| u64::try_from(was).ok());
    let Some(was) = was else { return Damage::Unknown };
    let length = 8.min(bytes.len() - at);
    bytes[at..at + length].copy_from_slice(&was.to_le_bytes()[..length]);
    if Seal::of(word, bytes) == recorded {
        return Damage::Bytes { at, word: is };
    }
    bytes[at..at + length].copy_from_slice(&is.to_le_bytes()[..length]);
    Damage::Unknown
}
