//! The order of the chunks of a replay: one for each run.

use alloc::vec;
use alloc::vec::Vec;

use super::encodings::{Parts, instead, parts};
use super::{chunks, custom_forces, file, recording};
use crate::codec::{Encoder as _, Reader, Write as _};
use crate::replay::file::{Segment, TICKS, Tag, Tick};
use crate::replay::{RecordOptions, Recorder, Replay};
use crate::world::{Inputs, World, WorldDef};

/// A run of nothing, from this tick on.
fn run(start: u64, ticks: u64, options: RecordOptions) -> Vec<u8> {
    let mut world = World::new(WorldDef::default()).expect("a world");
    (0..start).for_each(|_| _ = world.step());
    let mut recorder = Recorder::new(&world, options);
    (0..ticks).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    recorder.finish(&world)
}

#[test]
fn a_replay_is_written_to_the_bytes_it_was_read_from() {
    let mut files = vec![recording()];
    for (hash_every, snapshot_every) in [(1, 0), (1, 1), (3, 4), (7, 10), (2, 64), (5, 4096)] {
        for ticks in [0, 1, 4, 63, 64, 65, 128, 130] {
            files.extend([0, 3, 8].map(|start| run(start, ticks, RecordOptions { hash_every, snapshot_every })));
        }
    }
    for whole in files {
        let read = Replay::from_bytes(&whole, &custom_forces()).expect("it is whole");
        assert!(read.to_bytes() == whole && read.verify().is_ok());
        // Cut off, up to the last chunk that is whole.
        let ends: Vec<usize> = chunks(&whole).iter().map(|(chunk, at)| at + chunk.bytes.len() + 40).collect();
        for (end, next) in ends.iter().zip(&ends[1..]).skip(1) {
            let cut = Replay::recovered(&whole[..next - 1], &custom_forces()).expect("the rest of it");
            assert!(cut.to_bytes() == whole[..*end] && !cut.is_complete() && cut.verify().is_ok());
        }
    }
}

/// A chunk of these ticks, of the run of nothing from this tick on.
fn segment(start: u64, ticks: &[&[u8]]) -> (Tag, Vec<u8>) {
    let mut bytes = Vec::new();
    start.write(&mut bytes);
    (ticks.len() as u32).write(&mut bytes);
    ticks.iter().for_each(|tick| bytes.bytes(tick));
    (TICKS, bytes)
}

#[test]
fn the_chunks_of_a_replay_are_those_of_a_recorder() {
    let options = RecordOptions { hash_every: 2, snapshot_every: 100 };
    let whole = parts(&run(0, 180, options));
    let tags: Vec<[u8; 4]> = whole.iter().map(|(tag, _)| tag.0).collect();
    // 64, 36 and a snapshot, 64, 16 and a snapshot.
    let order = ["HEAD", "SNAP", "TICK", "TICK", "SNAP", "TICK", "TICK", "SNAP", "DONE"];
    assert!(tags.iter().eq(order.map(str::as_bytes)), "{tags:?}");
    assert!(Replay::from_bytes(&file(&whole), &[]).is_ok());
    let ticks: Vec<Vec<u8>> = (whole.iter().filter(|(tag, _)| *tag == TICKS))
        .flat_map(|(_, bytes)| {
            let segment = Segment::read(&mut Reader::new(bytes)).expect("ticks");
            segment.ticks().map(|tick| as_bytes(&tick)).collect::<Vec<_>>()
        })
        .collect();
    let ticks: Vec<&[u8]> = ticks.iter().map(|tick| &tick[..]).collect();
    let check = |what: &str, change: &dyn Fn(&mut Parts), (chunk, right): (u32, &str)| {
        let mut parts = whole.clone();
        change(&mut parts);
        let error = Replay::from_bytes(&file(&parts), &[]).expect_err(what);
        assert_eq!(instead(&error), (chunk, right), "{what}");
    };
    let ends = "another chunk: of ticks, or the snapshot of this tick";
    let has_room = "the last snapshot: the chunk of ticks before has room for more";
    let resized = |start: usize, end: usize| segment(start as u64, &ticks[start..end]);
    check("split", &|parts| drop(parts.splice(2..3, [resized(0, 30), resized(30, 64)])), (3, has_room));
    check("shifted", &|parts| drop(parts.splice(2..4, [resized(0, 63), resized(63, 100)])), (3, has_room));
    check("together", &|parts| drop(parts.splice(2..4, [resized(0, 100)])), (2, ends));
    check("over a snapshot", &|parts| drop(parts.splice(3..6, [resized(64, 128)])), (3, ends));
    check("none", &|parts| parts.insert(5, segment(100, &[])), (5, "one tick at least"));
    check("no snapshot on the way", &|parts| drop(parts.remove(4)), (4, "the snapshot of this tick"));
    check("a snapshot twice", &|parts| parts.insert(5, parts[4].clone()), (5, "no other snapshot of this tick"));
    check("a snapshot too soon", &|parts| parts.insert(3, parts[4].clone()), (3, "the snapshot of this tick"));
    check("no last snapshot", &|parts| drop(parts.remove(7)), (7, "the snapshot of the last tick"));
    check("two last snapshots", &|parts| parts.insert(8, parts[7].clone()), (8, "no other snapshot of this tick"));
    check("more after the last one", &|parts| parts.insert(8, segment(180, &[ticks[1]])), (8, "the end"));

    let hashes = "a tick with a hash where the head says so, and nowhere else";
    let (bare, hashed) = (ticks[0], ticks[1]);
    assert_eq!((bare.len(), hashed.len()), (9, 17));
    let with = |at: usize, tick: &[u8]| {
        let mut some = ticks[..64].to_vec();
        some[at] = tick;
        segment(0, &some)
    };
    check("a hash more", &|parts| parts[2] = with(6, hashed), (2, hashes));
    check("a hash less", &|parts| parts[2] = with(63, bare), (2, hashes));
    // Another head says so.
    let head = |parts: &mut Parts, at: usize, every: u32| parts[0].1[at..at + 4].copy_from_slice(&every.to_le_bytes());
    check("hashes elsewhere", &|parts| head(parts, 12, 1), (2, hashes));
    check("snapshots elsewhere", &|parts| head(parts, 16, 50), (2, ends));
    check("no snapshots", &|parts| head(parts, 16, 0), (5, "the end"));
}

fn as_bytes(tick: &Tick<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    tick.write(&mut bytes);
    bytes
}

#[test]
fn where_the_last_tick_has_a_snapshot_there_is_no_other() {
    let mut parts = parts(&run(0, 4, RecordOptions { hash_every: 1, snapshot_every: 4 }));
    assert_eq!(parts.len(), 5);
    let last = parts[3].clone();
    parts.insert(4, last);
    let error = Replay::from_bytes(&file(&parts), &[]).expect_err("one is enough");
    assert_eq!(instead(&error), (4, "no other snapshot of this tick"));
    parts.drain(3..5);
    let error = Replay::from_bytes(&file(&parts), &[]).expect_err("none is too few");
    assert_eq!(instead(&error), (3, "the snapshot of the last tick"));
}
