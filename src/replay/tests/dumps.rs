//! Desync dumps: where two machines differ, and what is in a dump.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::encodings::{Parts, expected, instead};
use super::{custom_forces, recording};
use crate::body::BodyDef;
use crate::cases::is_short;
use crate::codec::{Reader, Write as _};
use crate::force::{BodyState, CustomForce, CustomForceError, Dependence, FieldKind, ForceField, ForceTorque};
use crate::fx::{Fx, fx};
use crate::integrate::{Integrator, StageKind};
use crate::math::vec2;
use crate::replay::file::{DONE, read_chunk, write_chunk};
use crate::replay::{Dump, Owner, Replay, ReplayError, TickPhase};
use crate::slots::BodyId;
use crate::world::{Command, Inputs, World, WorldDef};

/// The dumps of one tick on two machines, the second of which acts and ends otherwise.
fn parted(act: impl FnOnce(&mut World), end: impl FnOnce(&mut World)) -> [Dump; 2] {
    let replay = Replay::from_bytes(&recording(), &custom_forces()).expect("it is whole");
    let before = replay.start().clone();
    let body = BodyId::from_parts(1, 0);
    let push = |world: &mut World| world.apply_force(body, vec2(1, 0)).expect("it is dynamic");
    let mut here = before.clone();
    push(&mut here);
    here.step();
    let ours = Dump::of_game(&before, push, &here);
    let mut replica = before.clone();
    push(&mut replica);
    act(&mut replica);
    let acted = replica.clone();
    replica.step();
    end(&mut replica);
    let theirs = Dump::of_game(&before, |world| world.clone_from(&acted), &replica);
    [ours, theirs].map(|dump| {
        let bytes = dump.to_bytes();
        let read = Dump::from_bytes(&bytes, &custom_forces()).expect("it is whole");
        assert_eq!(read.to_bytes(), bytes);
        assert_eq!(read.first_difference(&dump), None);
        read
    })
}

#[test]
fn dumps_of_a_desync_name_where_it_begins() {
    let body = BodyId::from_parts(1, 0);
    let [ours, theirs] = parted(|_| {}, |_| {});
    assert_eq!(ours.first_difference(&theirs), None);

    // Another call.
    let [ours, theirs] = parted(|world| world.apply_force(body, vec2(0, Fx::DELTA)).expect("it is dynamic"), |_| {});
    let difference = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(
        (difference.tick, difference.phase, difference.owner),
        (9, TickPhase::Calls, Owner::Body(body)),
        "{difference}"
    );
    assert_eq!(difference.field, "applied.force.y");

    // A machine with another result, or a memory fault.
    let nudge = |world: &mut World| {
        let place = world.body(body).expect("it is there").position();
        world.set_position(body, place + vec2(Fx::DELTA, 0)).expect("near");
    };
    let [ours, theirs] = parted(|_| {}, nudge);
    let difference = ours.first_difference(&theirs).expect("they differ");
    assert_eq!((difference.phase, difference.owner), (TickPhase::End, Owner::Body(body)), "{difference}");
    assert_eq!(difference.field, "position.x");
    assert!(difference.left.is_some() && difference.right.is_some() && difference.left != difference.right);
}

/// A force that differs between two builds.
struct Lift(Fx);

impl CustomForce for Lift {
    fn id(&self) -> u64 {
        1
    }
    fn version(&self) -> u32 {
        1
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }
    fn push(&self, _: &BodyState) -> Result<ForceTorque, CustomForceError> {
        Ok(ForceTorque { force: vec2(0, self.0), torque: Fx::ZERO })
    }
}

#[test]
fn a_machine_that_computes_another_force_is_found_at_the_stage_it_acts_in() {
    let dump = |force: Fx| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        world.register_custom_force(Arc::new(Lift(force))).expect("a law");
        world.add_body(BodyDef::dynamic()).expect("a body");
        let second = world.add_body(BodyDef { force_groups: 2, ..BodyDef::dynamic() }).expect("a body");
        world.add_field(ForceField { kind: FieldKind::Custom { id: 1 }, force_groups: 2 }).expect("a field");
        let before = world.clone();
        world.step();
        (Dump::of_tick(&before, &[], &Inputs::new(), &world), second)
    };
    let ((ours, body), (theirs, _)) = (dump(fx!(1)), dump(fx!(1.5)));
    let difference = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(difference.phase, TickPhase::Stage { index: 1, kind: StageKind::Kick }, "{difference}");
    assert_eq!((difference.owner, &difference.field[..]), (Owner::Body(body), "velocity.y"), "{difference}");
}

#[test]
fn a_flipped_bit_in_a_dump_is_named() {
    let [dump, _] = parted(|_| {}, |_| {});
    let whole = dump.to_bytes();
    let (mut named, step) = (0, if is_short() { 37 } else { 7 });
    for (i, at) in (0..whole.len()).step_by(step).enumerate() {
        let mut changed = whole.clone();
        changed[at] ^= 1 << (i % 8);
        match Dump::from_bytes(&changed, &custom_forces()) {
            Err(ReplayError::Tampered(difference)) => {
                assert!(difference.left != difference.right && difference.right.is_some(), "{at}: {difference}");
                named += 1;
            }
            Err(ReplayError::Foreign | ReplayError::Format { .. }) => assert!(at < 12, "{at}"),
            reply => panic!("{at}: {reply:?}"),
        }
        assert!(Dump::from_bytes(&whole[..at], &custom_forces()).is_err());
    }
    assert!(named * step > 3_500, "{named}");
}

#[test]
fn a_changed_chunk_of_a_dump_is_named_by_its_number() {
    let before = World::new(WorldDef::default()).expect("a fair definition");
    let mut after = before.clone();
    after.step();
    let whole = Dump::of_tick(&before, &[], &Inputs::new(), &after).to_bytes();
    // Letters and format; then a word and its double before each chunk, a hash and two sums after it.
    let (mut at, mut number) = (12, 0);
    while at < whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        let error = Dump::from_bytes(&changed, &[]).expect_err("it was changed");
        let ReplayError::Tampered(difference) = error else { panic!("{error}") };
        assert_eq!(difference.field, alloc::format!("chunk {number}.word"));
        let length = u32::from_le_bytes(whole[at + 4..at + 8].try_into().expect("four bytes"));
        (at, number) = (at + 16 + length as usize + 40, number + 1);
    }
    assert!(number > 7, "{number} chunks");
}

#[test]
fn an_error_in_a_dump_is_of_its_tick() {
    let [dump, _] = parted(|_| {}, |_| {});
    let whole = dump.to_bytes();
    let error = Dump::from_bytes(&whole[..whole.len() - 1], &custom_forces()).expect_err("it is cut off");
    assert_eq!((dump.tick(), error), (9, ReplayError::CutOff { tick: 9 }));
    // The place of each chunk: of the version and the ticks, of the phases, of the end.
    let mut reader = Reader::new(&whole[12..]);
    let mut starts = Vec::new();
    loop {
        let at = 12 + reader.at();
        match read_chunk(&mut reader) {
            Some(_) => starts.push(at),
            None => break,
        }
    }
    for &start in &starts[2..] {
        // The first word of the chunk, and a value in it: of the last world too, which is at the tick after.
        for at in [start, start + 40] {
            let mut changed = whole.clone();
            changed[at.min(whole.len() - 1)] ^= 1;
            match Dump::from_bytes(&changed, &custom_forces()) {
                Err(ReplayError::Tampered(difference)) => assert_eq!(difference.tick, 9, "{at}: {difference}"),
                reply => panic!("{at}: {reply:?}"),
            }
        }
    }
}

/// A dump of these chunks, with seals of their own.
fn dump_of(begin: &[u8], parts: &Parts) -> Vec<u8> {
    let mut bytes = begin.to_vec();
    parts.iter().for_each(|(tag, part)| write_chunk(&mut bytes, *tag, part));
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
    let all: Parts = core::iter::from_fn(|| read_chunk(&mut reader)).map(|chunk| (chunk.tag, chunk.bytes)).collect();
    assert_eq!(Dump::from_bytes(&dump_of(&whole[..12], &all), &[]).expect("it is whole").to_bytes(), whole);
    // A world follows after `is_new`, or nothing.
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
    let [bare, foreign] = [None, Some(world.state_hash() ^ 1)].map(|hash: Option<u64>| {
        let mut bytes = all[1].1[..20].to_vec();
        hash.write(&mut bytes);
        bytes
    });
    for ticks in [bare, foreign] {
        let mut parts = all.clone();
        parts[1].1 = ticks;
        let error = Dump::from_bytes(&dump_of(&whole[..12], &parts), &[]).expect_err("it is another end");
        let right = "the tick, and the hash of its end, which the ticks have too";
        assert_eq!(instead(&error), (all.len() as u32 - 1, right));
    }
    assert_eq!(all[all.len() - 1].0, DONE);
}

/// The chunk of a phase, with the world of the phase before.
fn again(chunk: &[u8]) -> Vec<u8> {
    // A stage is five bytes more.
    let phase = if chunk[0] == 3 { 6 } else { 1 };
    let mut bytes = chunk[..phase].to_vec();
    bytes.push(0);
    bytes
}

#[test]
fn a_dump_has_the_phases_of_its_tick_and_no_others() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let before = world.clone();
    let to_yoshida = Command::SetIntegrator(Integrator::Yoshida4);
    world.execute(&to_yoshida).expect("it is fair");
    world.step();
    let dump = Dump::of_tick(&before, &[to_yoshida], &Inputs::new(), &world).to_bytes();
    assert_eq!(Dump::from_bytes(&dump, &[]).expect("it is whole").phases().len(), 3 + 22 + 1);
    let mut reader = Reader::new(&dump[12..]);
    let mut parts = Vec::new();
    while let Some(chunk) = read_chunk(&mut reader) {
        parts.push((chunk.tag, chunk.bytes));
    }
    // Version and ticks come before the phases. One phase more or less is refused: each costs a world in memory.
    for at in 2..parts.len() - 1 {
        let (mut more, mut less) = (parts.clone(), parts.clone());
        more.insert(at + 1, (parts[at].0, again(&parts[at].1)));
        less.remove(at);
        for forged in [more, less] {
            let mut bytes = dump[..12].to_vec();
            forged.iter().for_each(|(tag, part)| write_chunk(&mut bytes, *tag, part));
            assert!(Dump::from_bytes(&bytes, &[]).is_err(), "chunk {at} of {}", forged.len());
        }
    }
}
