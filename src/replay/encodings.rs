//! One encoding for each value: what no writer writes is refused, and what is accepted is written again to the same bytes.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

use super::chunk::{self, Chunk, Tag};
use super::file::{DONE, SNAPSHOT, Segment, TICKS, Tick};
use super::tests::{chunks, custom_forces, file, recording, reseal, values};
use super::{Dump, RecordOptions, Recorder, Replay, ReplayError, Snapshot, SnapshotError};
use crate::body::BodyDef;
use crate::codec::{Encoder as _, Malformed, Reader, Write as _};
use crate::force::{BodyState, CustomForce, CustomForceError, Dependence, ForceTorque};
use crate::math::{Vec2, vec2};
use crate::scalar::fx::{Fx, fx};
use crate::shape::{Part, Shape};
use crate::slots::BodyId;
use crate::world::{Command, Inputs, World, WorldDef};

/// What should be there instead.
fn expected<T>(read: Result<T, SnapshotError>) -> &'static str {
    match read.err() {
        Some(SnapshotError::Malformed(Malformed { expected, .. })) => expected,
        other => panic!("{other:?}"),
    }
}

/// Puts the corners in these bytes into another order.
fn reorder(bytes: &[u8], corners: &[Vec2], other: &[Vec2]) -> Vec<u8> {
    let as_bytes = |corners: &[Vec2]| {
        let mut bytes = Vec::new();
        corners.iter().for_each(|corner| corner.write(&mut bytes));
        bytes
    };
    let (old, new) = (as_bytes(corners), as_bytes(other));
    let at = bytes.windows(old.len()).position(|bytes| *bytes == old).expect("they are there");
    [&bytes[..at], &new, &bytes[at + old.len()..]].concat()
}

#[test]
fn corners_of_polygons_are_read_counter_clockwise_alone() {
    let corners = [vec2(0, 0), vec2(3, 0), vec2(2, 2), vec2(fx!(-0.5), 1)];
    let polygon = Shape::polygon(&corners).expect("a shape");
    let part = Part { shape: polygon.clone(), position: vec2(1, 0), angle: fx!(1), density: fx!(1) };
    let compound = Shape::compound(&[part]).expect("a shape");
    let mut orders: Vec<Vec<Vec2>> = Vec::new();
    for first in 0..4 {
        let mut order = corners.to_vec();
        order.rotate_left(first);
        orders.push(order.clone());
        order.reverse();
        orders.push(order);
    }
    let right = "the corners of a polygon, counter-clockwise";
    for shape in [polygon, compound] {
        let body = BodyId::from_parts(0, 0);
        let def = BodyDef { shape: Some(shape.clone()), ..BodyDef::dynamic() };
        let commands = [Command::SetShape { body, shape: Some(shape) }, Command::AddBody(def)];
        for (i, order) in orders.iter().enumerate() {
            let is_clockwise = i % 2 == 1;
            for command in &commands {
                let bytes = reorder(&command.to_bytes(), &corners, order);
                match Command::from_bytes(&bytes) {
                    Ok(read) => assert!(!is_clockwise && read.to_bytes() == bytes, "{order:?}"),
                    Err(error) => assert!(is_clockwise && error.expected == right, "{error}"),
                }
            }
            let mut world = World::new(WorldDef::default()).expect("a world");
            world.execute(&commands[1]).expect("a body");
            let mut bytes = reorder(&world.snapshot().to_bytes(), &corners, order);
            reseal(&mut bytes);
            match Snapshot::from_bytes(&bytes, &[]) {
                Ok(read) => assert!(!is_clockwise && read.to_bytes() == bytes, "{order:?}"),
                Err(error) => assert!(is_clockwise && expected::<()>(Err(error)) == right, "{error}"),
            }
            let mut recorder = Recorder::new(&world, RecordOptions::default());
            recorder.execute(&mut world, &commands[0]).expect("it is there");
            recorder.step(&mut world, &Inputs::new());
            let mut parts = parts(&recorder.finish(&world));
            let ticks = parts.iter_mut().find(|(tag, _)| *tag == TICKS).expect("a tick");
            ticks.1 = reorder(&ticks.1, &corners, order);
            let bytes = file(&parts);
            match Replay::from_bytes(&bytes, &[]) {
                Ok(read) => assert!(!is_clockwise && read.to_bytes() == bytes, "{order:?}"),
                Err(error) => assert!(is_clockwise && instead(&error) == (2, right), "{error}"),
            }
        }
    }
}

/// A law of force with this id.
struct FieldKind(u64);

impl CustomForce for FieldKind {
    fn id(&self) -> u64 {
        self.0
    }
    fn version(&self) -> u32 {
        1
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }
    fn push(&self, _: &BodyState) -> Result<ForceTorque, CustomForceError> {
        Ok(ForceTorque::default())
    }
}

#[test]
fn laws_of_force_are_listed_by_their_ids() {
    let given = [7, 3, 1 << 40].map(|id| Arc::new(FieldKind(id)) as Arc<dyn CustomForce>);
    let mut world = World::new(WorldDef::default()).expect("a world");
    given.iter().for_each(|law| world.register_custom_force(law.clone()).expect("its id is free"));
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &given).expect("its own bytes").to_bytes(), whole);
    let entry = |id: u64| [&id.to_le_bytes()[..], &1u32.to_le_bytes()].concat();
    let first = entry(3);
    let at = whole.windows(12).position(|bytes| bytes == first).expect("it is there");
    for ids in [[7, 3, 1 << 40], [3, 1 << 40, 7], [3, 3, 7], [3, 7, 7], [1 << 40, 7, 3]] {
        let mut bytes = whole.clone();
        bytes[at..at + 36].copy_from_slice(&ids.map(entry).concat());
        reseal(&mut bytes);
        let error = Snapshot::from_bytes(&bytes, &given);
        assert_eq!(expected(error), "a law of force with a larger id than the one before", "{ids:?}");
    }
}

/// A snapshot of these bytes as a chunk, to name its values.
fn chunk_of(bytes: Vec<u8>) -> Chunk {
    Chunk { tag: SNAPSHOT, bytes, damage: None }
}

/// A snapshot with the value of this name replaced by these bytes, its hash and seal made right again.
pub(super) fn replaced(snapshot: &[u8], name: &str, more: usize, bytes: &[u8]) -> Vec<u8> {
    let all = values(&chunk_of(snapshot.to_vec()));
    let (at, length, ..) = all.iter().find(|(_, _, there, _)| there == name).unwrap_or_else(|| panic!("{name}"));
    let mut forged = [&snapshot[..*at], bytes, &snapshot[at + length + more..]].concat();
    reseal(&mut forged);
    forged
}

#[test]
fn a_shape_is_given_once_and_then_by_the_first_body_that_has_it() {
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    let square = Shape::rectangle(fx!(1), fx!(1)).expect("a shape");
    let mut world = World::new(WorldDef::default()).expect("a world");
    for shape in [Some(&disc), Some(&disc), None, Some(&disc), Some(&square)] {
        world.add_body(BodyDef { shape: shape.cloned(), ..BodyDef::dynamic() }).expect("a body");
    }
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &[]).expect("its own bytes").to_bytes(), whole);
    let mut given = vec![1, 0];
    fx!(0.5).write(&mut given);
    let right = "the shape, or the slot of the first body that has this shape";
    for body in [1, 3] {
        let name = alloc::format!("bodies[{body}].shape.source");
        let again = replaced(&whole, &name, 4, &given);
        assert_eq!(expected(Snapshot::from_bytes(&again, &[])), right);
    }
    // A body that has it and is not the first, one without a shape, itself, one to come, and none.
    for slot in [1, 2, 3, 4, 5, u32::MAX] {
        let other = replaced(&whole, "bodies[3].shape.slot", 0, &slot.to_le_bytes());
        assert_eq!(expected(Snapshot::from_bytes(&other, &[])), right, "{slot}");
    }
    // The first one gone, the next one gives it.
    world.remove_body(BodyId::from_parts(0, 0)).expect("it is there");
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &[]).expect("its own bytes").to_bytes(), whole);
}

#[test]
fn a_body_is_woken_once_in_a_tick() {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let bodies = [(); 2].map(|()| world.add_body(BodyDef::dynamic()).expect("a body"));
    world.step();
    bodies.iter().for_each(|&body| world.wake(body).expect("it is there"));
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &[]).expect("its own bytes").to_bytes(), whole);
    let mut first = Vec::new();
    bodies[0].write(&mut first);
    let again = replaced(&whole, "woken[1]", 0, &first);
    assert_eq!(expected(Snapshot::from_bytes(&again, &[])), "a body that is not in the list before");
    // Nor twice where a step is undone that it fell asleep in.
    world.step();
    world.set_sleep_after(None).expect("never is a fair answer");
    world.step_back(&[]).expect("it has an inverse");
    assert_eq!(world.change_log.woken(), bodies);
    let bytes = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").to_bytes(), bytes);
}

type Parts = Vec<(Tag, Vec<u8>)>;

fn parts(file: &[u8]) -> Parts {
    chunks(file).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect()
}

/// The number of the chunk that is refused, and what should be there instead.
fn instead(error: &ReplayError) -> (u32, &'static str) {
    match error {
        ReplayError::Malformed { chunk, malformed } => (*chunk, malformed.expected),
        other => panic!("{other:?}"),
    }
}

/// A run of nothing, from this tick on.
fn run(start: u64, ticks: u64, options: RecordOptions) -> Vec<u8> {
    let mut world: World = World::new(WorldDef::default()).expect("a world");
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
    let other = |start: usize, end: usize| segment(start as u64, &ticks[start..end]);
    check("split", &|parts| drop(parts.splice(2..3, [other(0, 30), other(30, 64)])), (3, has_room));
    check("shifted", &|parts| drop(parts.splice(2..4, [other(0, 63), other(63, 100)])), (3, has_room));
    check("together", &|parts| drop(parts.splice(2..4, [other(0, 100)])), (2, ends));
    check("over a snapshot", &|parts| drop(parts.splice(3..6, [other(64, 128)])), (3, ends));
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

/// A dump of these chunks, with seals of their own.
fn dump_of(begin: &[u8], parts: &Parts) -> Vec<u8> {
    let mut bytes = begin.to_vec();
    parts.iter().for_each(|(tag, part)| chunk::write(&mut bytes, *tag, part));
    bytes
}

#[test]
fn a_dump_tells_a_world_once_and_its_end_in_each_place() {
    let mut world = World::new(WorldDef { gravity: vec2(0, -1), ..WorldDef::default() }).expect("a world");
    world.add_body(BodyDef::dynamic()).expect("a body");
    let before = world.clone();
    world.step();
    let whole = Dump::of_tick(&before, &[], &Inputs::new(), &world).to_bytes();
    let mut reader = Reader::new(&whole[12..]);
    let all: Parts = core::iter::from_fn(|| chunk::read(&mut reader)).map(|chunk| (chunk.tag, chunk.bytes)).collect();
    assert_eq!(Dump::from_bytes(&dump_of(&whole[..12], &all), &[]).expect("it is whole").to_bytes(), whole);
    // What follows after `is_new` is a world, or nothing.
    let (mut last, mut told) = (Vec::new(), 0);
    for (number, (_, bytes)) in all.iter().enumerate().skip(2).take(all.len() - 3) {
        let at = if bytes[0] == 3 { 7 } else { 2 };
        if bytes[at - 1] == 1 {
            last = bytes[at..].to_vec();
            continue;
        }
        let mut parts = all.clone();
        parts[number].1 = [&bytes[..at - 1], &[1], &last].concat();
        let error = Dump::from_bytes(&dump_of(&whole[..12], &parts), &[]).expect_err("it is the same world");
        let ReplayError::Snapshot { chunk, error } = error else { panic!("{error}") };
        let right = "whether the world is another than before, and if so that world";
        assert_eq!((chunk as usize, expected::<()>(Err(error))), (number, right));
        told += 1;
    }
    assert!(told > 3, "{told}");
    let [bare, other] = [None, Some(world.state_hash() ^ 1)].map(|hash: Option<u64>| {
        let mut bytes = all[1].1[..20].to_vec();
        hash.write(&mut bytes);
        bytes
    });
    for ticks in [bare, other] {
        let mut parts = all.clone();
        parts[1].1 = ticks;
        let error = Dump::from_bytes(&dump_of(&whole[..12], &parts), &[]).expect_err("it is another end");
        let right = "the tick, and the hash of its end, which the ticks have too";
        assert_eq!(instead(&error), (all.len() as u32 - 1, right));
    }
    assert_eq!(all[all.len() - 1].0, DONE);
}

#[test]
fn what_is_over_and_what_can_be_reduced_is_not_there() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let lift = world.add_body(BodyDef::kinematic()).expect("a body");
    world.move_to(lift, vec2(1, 0), fx!(0)).expect("it is near");
    world.step();
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &[]).expect("its own bytes").to_bytes(), whole);
    let over = replaced(&whole, "bodies[0].errand.arrived", 0, &[0]);
    let right = "an errand with a goal or one that has arrived, or none";
    assert_eq!(expected(Snapshot::from_bytes(&over, &[])), right);
    for den in [0u128, 2, 60] {
        let twice = replaced(&whole, "elapsed.den", 0, &den.to_le_bytes());
        assert_eq!(expected(Snapshot::from_bytes(&twice, &[])), "a time in lowest terms", "0/{den}");
    }
}

/// What the writers of numbers have no second way for either.
#[test]
fn numbers_have_one_encoding() {
    let accepts = |bytes: &[u8]| {
        let read = Command::<Fx>::from_bytes(bytes);
        read.inspect(|command| assert_eq!(command.to_bytes(), bytes, "{command:?}")).is_ok()
    };
    // A choice: a bool, a tag.
    let locks = |bits: u8| [&[28][..], &[0; 8], &[bits, 0, 0]].concat();
    assert_eq!([0, 1, 2, 255].map(|bits| accepts(&locks(bits))), [true, true, false, false]);
    let kind = |tag: u8| [&[9][..], &[0; 8], &[tag]].concat();
    assert_eq!([0, 2, 3, 255].map(|tag| accepts(&kind(tag))), [true, true, false, false]);
    // An option that is none has nothing after it.
    assert!(accepts(&[24, 0]) && !accepts(&[24, 0, 0, 0, 0, 0]) && !accepts(&[24, 2, 0, 0, 0, 0]));
    // A factor: the top bit of its mantissa set, or zero in one way.
    let attractor = |shift: i64, mantissa: u64| {
        let centre = [&[0][..], &[0; 16]].concat();
        [&[17][..], &[1, 0, 0, 0], &[0], &centre, &shift.to_le_bytes(), &mantissa.to_le_bytes(), &[0; 8]].concat()
    };
    assert!(accepts(&attractor(63, 1 << 63)) && accepts(&attractor(0, 0)));
    for (shift, mantissa) in [(62, 1 << 62), (1, 0), (-1, 0), (1 << 15, 1 << 63), (i64::MIN, 1 << 63), (1 << 32, 0)] {
        assert!(!accepts(&attractor(shift, mantissa)), "{shift}, {mantissa}");
    }
}
