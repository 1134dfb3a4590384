//! Names in replays: kept, changed in no way unnoticed, and of no effect on the run.

use alloc::format;
use alloc::string::ToString as _;
use alloc::vec::Vec;

use super::{chunks, file, values};
use crate::body::BodyDef;
use crate::codec::Malformed;
use crate::collider::{ColliderDef, Material};
use crate::fx::{Fx, fx};
use crate::math::vec2;
use crate::replay::file::{Chunk, DONE, NAMES, Tag};
use crate::replay::{Labels, Owner, RecordOptions, Recorder, Replay, ReplayError};
use crate::shape::Shape;
use crate::slots::{BodyId, ColliderId, FieldId};
use crate::world::{Command, Inputs, World, WorldDef};

/// A recording of two bodies that move at these velocities after the tenth tick, each with a name if there are two.
fn recorded(velocity: i32, names: &[&str]) -> Vec<u8> {
    let mut world: World = World::new(WorldDef::default()).expect("a world");
    let bodies = [0, 7].map(|key| world.add_body(BodyDef { key, ..BodyDef::dynamic() }).expect("a body"));
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    for tick in 0..20 {
        if tick == 10 {
            let command = Command::SetVelocity { body: bodies[1], velocity: vec2(velocity, 0) };
            recorder.execute(&mut world, &command).expect("it is there");
        }
        recorder.step(&mut world, &Inputs::new());
    }
    for (body, name) in bodies.into_iter().zip(names) {
        recorder.labels_mut().set_body(body, name);
    }
    recorder.finish(&world)
}

/// The expectation of a file with these bytes as its names.
fn expected(bytes: &[u8]) -> &'static str {
    let chunks = chunks(&recorded(1, &[]));
    let mut parts: Vec<(Tag, Vec<u8>)> = chunks.into_iter().map(|(Chunk { tag, bytes, .. }, _)| (tag, bytes)).collect();
    parts.insert(parts.len() - 1, (NAMES, bytes.to_vec()));
    match Replay::from_bytes(&file(&parts), &[]) {
        Err(ReplayError::Malformed { malformed: Malformed { expected, .. }, .. }) => expected,
        result => panic!("{:?}", result.map(drop)),
    }
}

#[test]
fn names_are_kept_and_change_nothing_else() {
    let (plain, named) = (recorded(1, &[]), recorded(1, &["left", "right"]));
    let (without, with) = (chunks(&plain), chunks(&named));
    let others = with.iter().filter(|(chunk, _)| chunk.tag != NAMES);
    let same = others.zip(&without).all(|((a, _), (b, _))| (a.tag, &a.bytes) == (b.tag, &b.bytes));
    assert!(same && with.len() == without.len() + 1, "all other chunks are the same");
    let replay = Replay::from_bytes(&named, &[]).expect("it is whole");
    assert_eq!((replay.verify(), replay.to_bytes() == named), (Ok(()), true));
    let [first, second, third] = [0, 1, 2].map(|slot| BodyId::from_parts(slot, 0));
    let labels = replay.labels();
    assert_eq!([first, second, third].map(|body| labels.body(body)), [Some("left"), Some("right"), None]);
    assert!(Replay::from_bytes(&plain, &[]).is_ok_and(|replay| replay.labels().is_empty()));
    // Cut off behind the names, and before.
    let (_, end) = with.last().expect("the end");
    let recovered = Replay::recovered(&named[..end - 16], &[]).expect("it is whole up to there");
    assert_eq!((recovered.labels(), recovered.to_bytes().len()), (labels, end - 16));
    let recovered = Replay::recovered(&named[..end - 17], &[]).expect("it is whole up to there");
    assert!(recovered.labels().is_empty());
}

#[test]
fn a_difference_has_the_name_of_its_body_in_either_replay() {
    let read = |velocity, names: &[&str]| Replay::from_bytes(&recorded(velocity, names), &[]).expect("it is whole");
    let (named, plain) = (read(1, &["left", "right"]), read(2, &[]));
    let text = "tick 10, calls, body 1 \"right\" (key 7), call 1, velocity.x: 1 and 2 m/s (differ by 1 m/s)";
    assert_eq!(named.first_difference(&plain).map(|difference| difference.to_string()).as_deref(), Some(text));
    let other_way = plain.first_difference(&named).expect("they differ");
    assert_eq!((other_way.name.as_deref(), other_way.key), (Some("right"), 7));
    // Names themselves are not compared.
    assert_eq!(named.first_difference(&read(1, &["a", "b"])), None);
}

#[test]
fn a_difference_has_the_names_of_its_colliders() {
    // A disc that falls on a floor of this friction; the collider of each has a name where it is not empty.
    let recorded = |friction: Fx, names: [&str; 2]| {
        let mut world = World::new(WorldDef { gravity: vec2(1, -10), ..WorldDef::default() }).expect("a world");
        let disc = ColliderDef::from(Shape::circle(1).expect("a shape"));
        let floor = ColliderDef { key: 5, ..Shape::rectangle(9, 2).expect("a shape").into() };
        world.add_body(BodyDef { position: vec2(0, 2), ..BodyDef::dynamic() }.with_collider(disc)).expect("a body");
        world.add_body(BodyDef::fixed().with_collider(floor.clone())).expect("a body");
        let colliders = [0, 1].map(|slot| ColliderId::from_parts(slot, 0));
        let def = ColliderDef { material: Material { friction, ..floor.material }, ..floor };
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        recorder.execute(&mut world, &Command::SetCollider { collider: colliders[1], def }).expect("it is there");
        for _ in 0..20 {
            recorder.step(&mut world, &Inputs::new());
        }
        for (collider, name) in colliders.into_iter().zip(names) {
            recorder.labels_mut().set_collider(collider, name);
        }
        (Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole"), world)
    };
    let ((named, world), (plain, other_world)) = (recorded(fx!(0.5), ["", "ice"]), recorded(fx!(0), ["", ""]));
    let difference = plain.first_difference(&named).expect("they differ");
    let text = "collider 1 \"ice\" (key 5), call 1, def.material.friction: 0 and 0.5";
    assert_eq!(format!("{difference:#}"), text);
    let mut contacts =
        world.differences(&other_world).into_iter().filter(|difference| matches!(difference.owner, Owner::Contact(..)));
    let contact = contacts.next().expect("one touches").owner;
    assert_eq!(named.labels().owner(contact).as_deref(), Some("collider 0 and ice"));
    assert_eq!(plain.labels().owner(contact), None);
}

#[test]
fn a_changed_name_is_named_with_both() {
    let whole = recorded(1, &["left", "right"]);
    let (chunk, start) = chunks(&whole).into_iter().find(|(chunk, _)| chunk.tag == NAMES).expect("names");
    let mut count = 0;
    for (at, length, name, text) in values(&chunk) {
        for bit in 0..8 * length {
            let mut changed = whole.clone();
            changed[start + at + bit / 8] ^= 1 << (bit % 8);
            let Err(ReplayError::Tampered(difference)) = Replay::from_bytes(&changed, &[]) else { panic!("{name}") };
            assert_eq!((&difference.field, difference.left.as_deref()), (&name, Some(&text[..])));
            assert!(difference.right.is_some_and(|right| right != text), "{name}");
            count += 1;
        }
    }
    // Four lists with their numbers, and two entries of a handle, a length and a name.
    assert_eq!(count, 8 * (4 * 4 + 2 * (8 + 4) + "leftright".len()));
}

#[test]
fn names_have_one_encoding() {
    let entry =
        |slot: u32, name: &[u8]| [&slot.to_le_bytes()[..], &[0; 4], &(name.len() as u32).to_le_bytes(), name].concat();
    let names = |bodies: &[Vec<u8>]| [&(bodies.len() as u32).to_le_bytes()[..], &bodies.concat(), &[0; 12]].concat();
    assert_eq!(expected(&names(&[])), "one name at least");
    for order in [[1, 0], [1, 1]] {
        let bodies = order.map(|slot| entry(slot, b"a"));
        assert_eq!(expected(&names(&bodies)), "names by their handles, in ascending order");
    }
    for name in [&b"a\nb"[..], b"\xff\xfe", &[b'x'; Labels::BYTES + 1]] {
        let what = "a name of 1 to 256 bytes of UTF-8 without control characters";
        assert_eq!(expected(&names(&[entry(0, name)])), what, "{name:?}");
    }
    // An empty one leaves room for more entries than the bytes can have, or is none.
    assert_eq!(expected(&names(&[entry(0, b"")])), "a name of 1 to 256 bytes of UTF-8 without control characters");
    assert_eq!(expected(&[&names(&[entry(0, b"a")])[..], &[0]].concat()), "the end");
    assert_eq!(expected(&[255, 255, 255, 255]), "a length that the bytes after it can have");
}

#[test]
fn names_stand_once_and_before_the_end() {
    let whole = chunks(&recorded(1, &["left", "right"]));
    let parts: Vec<(Tag, Vec<u8>)> = whole.into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    let at = parts.len() - 2;
    assert!(parts[at].0 == NAMES && parts[at + 1].0 == DONE);
    let read = |order: &[usize]| {
        let parts: Vec<_> = order.iter().map(|&i| parts[i].clone()).collect();
        Replay::from_bytes(&file(&parts), &[])
    };
    let all: Vec<usize> = (0..parts.len()).collect();
    assert!(read(&all).is_ok());
    for place in 0..=parts.len() {
        let mut twice = all.clone();
        twice.insert(place, at);
        assert!(read(&twice).is_err(), "again at {place}");
        let mut moved = all.clone();
        moved.remove(at);
        if place < at {
            moved.insert(place, at);
            assert!(read(&moved).is_err(), "at {place}");
        }
    }
}

#[test]
fn names_are_made_fit() {
    let mut labels = Labels::new();
    let (body, field) = (BodyId::from_parts(3, 1), FieldId::from_parts(0, 0));
    let long = "é".repeat(Labels::BYTES);
    labels.set_body(body, &long);
    assert_eq!(labels.body(body), Some(&long[..Labels::BYTES]));
    labels.set_body(body, "a\u{7}\u{9b}b");
    assert_eq!((labels.body(body), labels.field(field)), (Some("ab"), None));
    labels.set_body(body, "\n");
    assert!(labels.is_empty());
}
