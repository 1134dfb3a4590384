//! Files taken apart and put together again, with every seal made right: a forger can do that too.

use umbra_physics::{Snapshot, SnapshotError};
use xxhash_rust::xxh3::xxh3_64;

use crate::untrusted::everything::custom_forces;

/// The formats of replays and of dumps.
const REPLAY_FORMAT: u32 = 6;
pub(crate) const DUMP_FORMAT: u32 = 7;

/// Start of a file of a kind.
pub(crate) fn begin(magic: &[u8; 8]) -> Vec<u8> {
    let format = if magic == b"UMBRADMP" { DUMP_FORMAT } else { REPLAY_FORMAT };
    [&magic[..], &format.to_le_bytes()].concat()
}

/// Adds a chunk to a file.
pub(crate) fn chunk(file: &mut Vec<u8>, tag: &[u8; 4], contents: &[u8]) {
    let word = [&tag[..], &(contents.len() as u32).to_le_bytes()].concat();
    file.extend_from_slice(&word);
    file.extend(word.iter().map(|byte| !byte));
    file.extend_from_slice(contents);
    let (mut sum, mut weighted) = (0u128, 0u128);
    for (k, piece) in (1u128..).zip(contents.chunks(8)) {
        let mut filled = [0; 8];
        filled[..piece.len()].copy_from_slice(piece);
        sum += u128::from(u64::from_le_bytes(filled));
        weighted += k * u128::from(u64::from_le_bytes(filled));
    }
    file.extend_from_slice(&xxh3_64(&[&word, contents].concat()).to_le_bytes());
    file.extend_from_slice(&sum.to_le_bytes());
    file.extend_from_slice(&weighted.to_le_bytes());
}

/// The chunks of a file that is whole.
pub(crate) fn chunks(file: &[u8]) -> Vec<([u8; 4], Vec<u8>)> {
    let (mut rest, mut chunks) = (&file[12..], Vec::new());
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[4..8].try_into().expect("four")) as usize;
        chunks.push((rest[..4].try_into().expect("four"), rest[16..16 + length].to_vec()));
        rest = &rest[16 + length + 40..];
    }
    chunks
}

/// Gives a snapshot the hash of the world it says, as far as that is one, and the seal of its bytes.
pub(crate) fn reseal(bytes: &mut [u8]) {
    let Some(end) = bytes.len().checked_sub(16) else { return };
    if let Err(SnapshotError::Changed { computed, .. }) = Snapshot::from_bytes(bytes, &custom_forces()) {
        bytes[end..end + 8].copy_from_slice(&computed.to_le_bytes());
    }
    let seal = xxh3_64(&bytes[..end + 8]);
    bytes[end + 8..].copy_from_slice(&seal.to_le_bytes());
}
