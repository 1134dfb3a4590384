//! One encoding for each value: bytes that no writer makes are refused, and accepted ones are written again the same.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{chunks, file, reseal, values};
use crate::body::BodyDef;
use crate::codec::{Malformed, Write as _};
use crate::collider::ColliderDef;
use crate::force::{BodyState, CustomForce, CustomForceError, Dependence, ForceTorque};
use crate::fx::{Fx, fx};
use crate::math::{Vec2, vec2};
use crate::replay::file::{Chunk, SNAPSHOT, TICKS, Tag};
use crate::replay::{RecordOptions, Recorder, Replay, ReplayError, Snapshot, SnapshotError};
use crate::shape::{Part, Shape};
use crate::slots::BodyId;
use crate::world::{Command, Inputs, World, WorldDef};

/// The thing that is expected instead.
pub(super) fn expected<T>(read: Result<T, SnapshotError>) -> &'static str {
    match read.err() {
        Some(SnapshotError::Malformed(Malformed { expected, .. })) => expected,
        error => panic!("{error:?}"),
    }
}

/// Puts the corners in these bytes into another order.
fn reorder(bytes: &[u8], corners: &[Vec2], order: &[Vec2]) -> Vec<u8> {
    let as_bytes = |corners: &[Vec2]| {
        let mut bytes = Vec::new();
        corners.iter().for_each(|corner| corner.write(&mut bytes));
        bytes
    };
    let (old, new) = (as_bytes(corners), as_bytes(order));
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
        let def = ColliderDef::ghost(shape);
        let add_body = Command::AddBody(BodyDef::dynamic().with_collider(def.clone()));
        let commands = [Command::AddCollider { body, def }, add_body];
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

/// A custom force with this id.
struct NumberedForce(u64);

impl CustomForce for NumberedForce {
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
fn custom_forces_are_listed_by_their_ids() {
    let forces = [7, 3, 1 << 40].map(|id| Arc::new(NumberedForce(id)) as Arc<dyn CustomForce>);
    let mut world = World::new(WorldDef::default()).expect("a world");
    forces.iter().for_each(|force| world.register_custom_force(force.clone()).expect("its id is free"));
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &forces).expect("its own bytes").to_bytes(), whole);
    let entry = |id: u64| [&id.to_le_bytes()[..], &1u32.to_le_bytes()].concat();
    let first = entry(3);
    let at = whole.windows(12).rposition(|bytes| bytes == first).expect("it is there");
    for ids in [[7, 3, 1 << 40], [3, 1 << 40, 7], [3, 3, 7], [3, 7, 7], [1 << 40, 7, 3]] {
        let mut bytes = whole.clone();
        bytes[at..at + 36].copy_from_slice(&ids.map(entry).concat());
        reseal(&mut bytes);
        let error = Snapshot::from_bytes(&bytes, &forces);
        assert_eq!(expected(error), "a custom force with a larger id than the one before", "{ids:?}");
    }
}

/// A snapshot of these bytes as a chunk, to name its values.
fn chunk_of(bytes: Vec<u8>) -> Chunk {
    Chunk { tag: SNAPSHOT, bytes, damage: None }
}

/// A snapshot with the value of this name replaced by these bytes, its hash and seal made right again.
pub(super) fn replaced(snapshot: &[u8], name: &str, more: usize, bytes: &[u8]) -> Vec<u8> {
    let all = values(&chunk_of(snapshot.to_vec()));
    let (at, length, ..) =
        all.iter().find(|(_, _, value_name, _)| value_name == name).unwrap_or_else(|| panic!("{name}"));
    let mut forged = [&snapshot[..*at], bytes, &snapshot[at + length + more..]].concat();
    reseal(&mut forged);
    forged
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
    let again = replaced(&whole, "sleep_changes[1]", 0, &first);
    assert_eq!(expected(Snapshot::from_bytes(&again, &[])), "a body that is not in the list before");
    // Bodies that are awake come first.
    let mut half_asleep = world.clone();
    half_asleep.sleep(bodies[0]).expect("it is awake");
    half_asleep.set_velocity(bodies[1], vec2(1, 0)).expect("a body");
    half_asleep.step();
    half_asleep.wake(bodies[0]).expect("it sleeps");
    half_asleep.sleep(bodies[1]).expect("it is awake");
    let changed = half_asleep.snapshot().to_bytes();
    assert_eq!(half_asleep.change_log.sleep_changes(&half_asleep.bodies), bodies);
    let mut swapped = Vec::new();
    bodies.iter().rev().for_each(|body| body.write(&mut swapped));
    let swapped = replaced(&changed, "sleep_changes[0]", 8, &swapped);
    assert_eq!(expected(Snapshot::from_bytes(&swapped, &[])), "bodies that are awake, then bodies that sleep");
    // A body is not listed twice either, where a step is undone in which it fell asleep.
    world.step();
    world.set_sleep_after(None).expect("never is a fair answer");
    world.step_back(&[]).expect("it has an inverse");
    assert_eq!(world.change_log.sleep_changes(&world.bodies), bodies);
    let bytes = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").to_bytes(), bytes);
}

pub(super) type Parts = Vec<(Tag, Vec<u8>)>;

pub(super) fn parts(file: &[u8]) -> Parts {
    chunks(file).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect()
}

/// The number of the chunk that is refused, and what is expected instead.
pub(super) fn instead(error: &ReplayError) -> (u32, &'static str) {
    match error {
        ReplayError::Malformed { chunk, malformed } => (*chunk, malformed.expected),
        error => panic!("{error:?}"),
    }
}

#[test]
fn empty_targets_and_unreduced_times_are_refused() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let lift = world.add_body(BodyDef::kinematic()).expect("a body");
    world.move_to(lift, vec2(1, 0), fx!(0)).expect("it is near");
    world.step();
    let whole = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&whole, &[]).expect("its own bytes").to_bytes(), whole);
    let over = replaced(&whole, "bodies[0].kinematic_target.arrived", 0, &[0]);
    let right = "a target with a goal or one that has arrived, or none";
    assert_eq!(expected(Snapshot::from_bytes(&over, &[])), right);
    for den in [0u128, 2, 60] {
        let twice = replaced(&whole, "elapsed.den", 0, &den.to_le_bytes());
        assert_eq!(expected(Snapshot::from_bytes(&twice, &[])), "a time in lowest terms", "0/{den}");
    }
}

/// Numbers, enums and options too.
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
