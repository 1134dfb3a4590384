//! Tests of snapshots, differences and files that need to look inside, and what they share.

use alloc::string::String;
use alloc::vec::Vec;

use super::diff::name_of;
use super::file::{
    Chunk, DONE, Done, HEAD, Head, Labels, NAMES, REPLAY, SNAPSHOT, Segment, TICKS, Tag, read_chunk, write_chunk,
};
use super::snapshot::{Saved, SnapshotError, read};
use crate::codec::{FieldIndex, Read as _, Reader, StateHasher};

mod before_calls;
mod bounds;
mod contacts;
mod dumps;
mod encodings;
mod forgeries;
mod labels;
mod named;
mod order;
mod runs;
mod untrusted;

#[path = "../../../tests/support/everything.rs"]
pub(super) mod everything;
pub(super) use everything::{commands, custom_forces, places, recording};

/// The chunks of a file, each with the position of its first byte.
pub(super) fn chunks(file: &[u8]) -> Vec<(Chunk, usize)> {
    let mut reader = Reader::new(file);
    REPLAY.enter(&mut reader).expect("a replay of this format");
    let mut chunks = Vec::new();
    loop {
        let at = reader.at() + 16;
        match read_chunk(&mut reader) {
            Some(chunk) => chunks.push((chunk, at)),
            None => break chunks,
        }
    }
}

/// A file of these chunks, with valid seals.
pub(super) fn file(chunks: &[(Tag, Vec<u8>)]) -> Vec<u8> {
    let mut file = REPLAY.begin();
    chunks.iter().for_each(|(tag, bytes)| write_chunk(&mut file, *tag, bytes));
    file
}

/// The values of a chunk: the position, length, name and text of each.
pub(super) fn values(chunk: &Chunk) -> Vec<(usize, usize, String, String)> {
    let mut reader = Reader::new(&chunk.bytes);
    let index = match chunk.tag {
        HEAD => FieldIndex::of(&Head::read(&mut reader).expect("a head")),
        DONE => FieldIndex::of(&Done::read(&mut reader).expect("an end")),
        NAMES => FieldIndex::of(&Labels::read(&mut reader).expect("names")),
        TICKS => FieldIndex::of(&Segment::read(&mut reader).expect("ticks")),
        SNAPSHOT => FieldIndex::of(&Saved(&read(&mut reader, &custom_forces()).expect("a snapshot"))),
        _ => panic!("no chunk of this format"),
    };
    assert_eq!(reader.rest(), 0);
    let leaves = index.leaves.into_iter();
    leaves.map(|leaf| (leaf.at, leaf.bytes.len(), name_of(&leaf.path), leaf.text)).collect()
}

/// Gives a forged snapshot the hash of its world, and the seal of its bytes.
pub(super) fn reseal(bytes: &mut [u8]) {
    for _ in 0..2 {
        match read(&mut Reader::new(bytes), &custom_forces()) {
            Err(SnapshotError::Changed { computed, .. }) => {
                let end = bytes.len() - 16;
                bytes[end..end + 8].copy_from_slice(&computed.to_le_bytes());
                let seal = StateHasher::of_bytes(&bytes[..end + 8]);
                bytes[end + 8..].copy_from_slice(&seal.to_le_bytes());
            }
            _ => return,
        }
    }
}
