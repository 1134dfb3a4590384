//! What is changed in a replay is named: every value of the format, one bit at a time, as it is and with its seal made new.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::chunk::{self, Chunk, Tag};
use super::difference::name_of;
use super::file::{DONE, Done, HEAD, Head, REPLAY, SNAPSHOT, Segment, TICKS};
use super::snapshot::{self, Saved};
use super::{
    Divergence, Dump, Owner, PHYSICS_VERSION, RecordOptions, Recorder, Replay, ReplayError, Snapshot, TickPhase,
};
use crate::body::BodyDef;
use crate::codec::{FieldIndex, Read as _, Reader};
use crate::force::{BodyState, CustomForce, CustomForceError, Dependence, FieldKind, ForceField, ForceTorque};
use crate::math::vec2;
use crate::scalar::fx::{Fx, fx};
use crate::slots::BodyId;
use crate::world::{Command, Inputs, World, WorldDef};

#[path = "../../tests/support/everything.rs"]
pub(super) mod everything;
pub(super) use everything::{commands, custom_forces, recording};

/// What has no example here does not compile.
fn is_among_them(command: &Command) -> bool {
    let like = match command {
        Command::AddBody(_) => "AddBody",
        Command::RemoveBody(_) => "RemoveBody",
        Command::Apply { .. } => "Apply",
        Command::SetPosition { .. } => "SetPosition",
        Command::SetAngle { .. } => "SetAngle",
        Command::SetVelocity { .. } => "SetVelocity",
        Command::SetAngularVelocity { .. } => "SetAngularVelocity",
        Command::SetMass { .. } => "SetMass",
        Command::SetShape { .. } => "SetShape",
        Command::SetKind { .. } => "SetKind",
        Command::SetGravityScale { .. } => "SetGravityScale",
        Command::SetBodyDamping { .. } => "SetBodyDamping",
        Command::SetGroups { .. } => "SetGroups",
        Command::SetKey { .. } => "SetKey",
        Command::SetUserData { .. } => "SetUserData",
        Command::Wake(_) => "Wake",
        Command::Release(_) => "Release",
        Command::AddField(_) => "AddField",
        Command::SetField { .. } => "SetField",
        Command::RemoveField(_) => "RemoveField",
        Command::SetTimeStep(_) => "SetTimeStep",
        Command::SetGravity(_) => "SetGravity",
        Command::SetIntegrator(_) => "SetIntegrator",
        Command::SetDamping { .. } => "SetDamping",
        Command::SetSleepAfter(_) => "SetSleepAfter",
        Command::SetRandom(_) => "SetRandom",
        Command::SetBlob(_) => "SetBlob",
        Command::ClearForces => "ClearForces",
        Command::SetLocks { .. } => "SetLocks",
        Command::SetMaxSpeeds { .. } => "SetMaxSpeeds",
        Command::Disable(_) => "Disable",
        Command::Enable(_) => "Enable",
        Command::MoveTo { .. } => "MoveTo",
    };
    commands().iter().any(|command| format!("{command:?}").starts_with(like))
}

/// The chunks of a file, and where the bytes of each begin.
pub(super) fn chunks(file: &[u8]) -> Vec<(Chunk, usize)> {
    let mut reader = Reader::new(file);
    REPLAY.enter(&mut reader).expect("a replay of this format");
    let mut chunks = Vec::new();
    loop {
        let at = reader.at() + 16;
        match chunk::read(&mut reader) {
            Some(chunk) => chunks.push((chunk, at)),
            None => break chunks,
        }
    }
}

/// A file of these chunks, with seals of their own.
pub(super) fn file(chunks: &[(Tag, Vec<u8>)]) -> Vec<u8> {
    let mut file = REPLAY.begin();
    chunks.iter().for_each(|(tag, bytes)| chunk::write(&mut file, *tag, bytes));
    file
}

/// All that is a value in a chunk: where it is, how long, its name, how it reads.
pub(super) fn values(chunk: &Chunk) -> Vec<(usize, usize, String, String)> {
    let mut reader = Reader::new(&chunk.bytes);
    let index = match chunk.tag {
        HEAD => FieldIndex::of(&Head::read(&mut reader).expect("a head")),
        DONE => FieldIndex::of(&Done::read(&mut reader).expect("an end")),
        TICKS => FieldIndex::of(&Segment::read(&mut reader).expect("ticks")),
        SNAPSHOT => FieldIndex::of(&Saved(&snapshot::read(&mut reader, &custom_forces()).expect("a snapshot"))),
        _ => panic!("no chunk of this format"),
    };
    assert_eq!(reader.rest(), 0);
    let leaves = index.leaves.into_iter();
    leaves.map(|leaf| (leaf.at, leaf.bytes.len(), name_of(&leaf.path), leaf.text)).collect()
}

#[test]
fn every_command_is_recorded_and_played_alike() {
    assert!(commands().iter().all(is_among_them));
    let file = recording();
    let replay = Replay::from_bytes(&file, &custom_forces()).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    let mut playback = replay.play();
    while playback.step().expect("it goes as recorded") {
        assert!(playback.outcomes().iter().all(|outcome| outcome.result.is_ok()), "{:?}", playback.outcomes());
    }
    // From every tick to every other.
    let hashes: Vec<u64> = (replay.start().tick()..=replay.end())
        .map(|tick| {
            playback.seek(tick);
            playback.world().state_hash()
        })
        .collect();
    for tick in (replay.start().tick()..=replay.end()).rev() {
        playback.seek(tick);
        let hash = hashes[(tick - replay.start().tick()) as usize];
        assert_eq!(playback.world().state_hash(), hash);
        assert_eq!(playback.recorded_hash(), (tick > replay.start().tick()).then_some(hash));
    }
}

#[test]
fn a_flipped_bit_in_any_value_is_named_with_both_values() {
    let whole = recording();
    let mut seen = 0;
    for (number, (chunk, start)) in chunks(&whole).into_iter().enumerate() {
        for (at, length, name, text) in values(&chunk) {
            for bit in [0, 8 * length - 1] {
                let mut changed = whole.clone();
                changed[start + at + bit / 8] ^= 1 << (bit % 8);
                let what = format!("chunk {number}, {name}, bit {bit}");
                match Replay::from_bytes(&changed, &custom_forces()) {
                    Err(ReplayError::Tampered(finding)) => {
                        assert!(name.ends_with(&finding.field), "{what}: {finding}");
                        assert_eq!(finding.recorded.as_deref(), Some(&text[..]), "{what}: {finding}");
                        assert!(finding.found.as_deref().is_some_and(|found| found != text), "{what}: {finding}");
                        if let Some(rest) = name.strip_prefix("bodies[") {
                            let slot = rest.split(']').next().and_then(|slot| slot.parse::<u32>().ok());
                            assert!(
                                matches!(finding.place, Owner::Body(body) if Some(body.parts().0) == slot),
                                "{what}: {finding}"
                            );
                        }
                        seen += 1;
                    }
                    other => panic!("{what}: {other:?}"),
                }
            }
        }
    }
    assert!(seen > 1_000, "{seen}");
}

#[test]
fn a_flipped_bit_anywhere_and_a_file_cut_off_anywhere_are_found() {
    let whole = recording();
    for at in 0..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1 << (at % 8);
        assert!(Replay::from_bytes(&changed, &custom_forces()).is_err(), "byte {at}");
        let cut = Replay::from_bytes(&whole[..at], &custom_forces());
        let foreign = at < REPLAY.magic.len();
        assert!(
            matches!(cut, Err(ReplayError::Foreign)) && foreign || matches!(cut, Err(ReplayError::CutOff { .. })),
            "cut off at {at}: {cut:?}"
        );
        // What is whole of it goes as recorded.
        if let Ok(replay) = Replay::recovered(&whole[..at], &custom_forces()) {
            assert!(!replay.is_complete());
            if at % 64 == 0 {
                assert_eq!(replay.verify(), Ok(()));
            }
        }
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert!(matches!(Replay::from_bytes(&longer, &custom_forces()), Err(ReplayError::Malformed { .. })));
}

/// What is found in a file in which one value was changed, and everything sealed anew.
fn forged(whole: &[u8], number: usize, at: usize, bit: usize) -> Result<(), Result<Box<Divergence>, ReplayError>> {
    let mut parts: Vec<(Tag, Vec<u8>)> = chunks(whole).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    parts[number].1[at + bit / 8] ^= 1 << (bit % 8);
    let (tag, bytes) = &mut parts[number];
    if *tag == SNAPSHOT {
        // A forger makes its own hashes right as well, as far as what it says is a world.
        reseal(bytes);
    }
    let replay = Replay::from_bytes(&file(&parts), &custom_forces()).map_err(Err)?;
    replay.verify().map_err(Ok)
}

/// Gives a snapshot the hash of the world it says, and the seal of its bytes.
pub(super) fn reseal(bytes: &mut [u8]) {
    for _ in 0..2 {
        match snapshot::read(&mut Reader::new(bytes), &custom_forces()) {
            Err(super::SnapshotError::Changed { computed, .. }) => {
                let end = bytes.len() - 16;
                bytes[end..end + 8].copy_from_slice(&computed.to_le_bytes());
                let seal = crate::codec::StateHasher::of_bytes(&bytes[..end + 8]);
                bytes[end + 8..].copy_from_slice(&seal.to_le_bytes());
            }
            _ => return,
        }
    }
}

#[test]
fn a_forged_value_is_refused_or_its_run_parts_from_the_recorded_one() {
    let whole = recording();
    let (mut named, mut by_hash, mut refused, mut unfelt) = (0, 0, 0, Vec::new());
    for (number, (chunk, _)) in chunks(&whole).into_iter().enumerate() {
        for (at, length, name, _) in values(&chunk) {
            if chunk.tag == SNAPSHOT && ["hash", "seal"].contains(&&name[..]) {
                // What a forger makes right again.
                continue;
            }
            // Not the last bit of a velocity: damping may round it away.
            match forged(&whole, number, at, 4 * length + 3) {
                Err(Ok(divergence)) if divergence.finding.field == "hash" => by_hash += 1,
                Err(Ok(divergence)) => {
                    let finding = &divergence.finding;
                    assert!(finding.recorded != finding.found, "{finding}");
                    named += 1;
                }
                Err(Err(_)) => refused += 1,
                Ok(()) => unfelt.push(format!("chunk {number}, {name}")),
            }
        }
    }
    assert!(named > 300 && by_hash > 5 && refused > 300, "{named}, {by_hash}, {refused}");
    // What changes nothing that comes after: who sent a command, how it was recorded, what only reports hand on, how long
    // a body was at rest that moves in the next tick, and of the one that the next tick moves to a goal what is below the ulp
    // of its place, how fast it was, and whether it was to stop.
    for what in unfelt {
        let labels = ["player", "sequence", "_every", "woken", "wake", "ticks_at_rest"];
        let is_label = labels.iter().any(|label| what.contains(label));
        let of_the_moved = ["position", "velocity", "angular_velocity", "errand.arrived"];
        let is_moved = of_the_moved.iter().any(|part| what.starts_with(&format!("chunk 1, bodies[9].{part}")));
        let is_overwritten = what.contains("inputs[") || what.contains("calls[") || is_moved;
        assert!(is_label || is_overwritten, "{what}");
    }
}

#[test]
fn the_first_difference_is_the_first_of_all() {
    let snapshots: Vec<Vec<u8>> = chunks(&recording())
        .into_iter()
        .filter(|(chunk, _)| chunk.tag == SNAPSHOT)
        .map(|(chunk, _)| chunk.bytes)
        .collect();
    let world = |bytes: &[u8]| Snapshot::from_bytes(bytes, &custom_forces()).map(Snapshot::into_world);
    let worlds: Vec<World> = snapshots.iter().map(|bytes| world(bytes).expect("a snapshot")).collect();
    let mut seen = 0;
    let mut compare = |a: &World, b: &World| {
        assert_eq!(a.first_difference(b), a.differences(b).into_iter().next());
        seen += usize::from(a.first_difference(b).is_some());
    };
    for (a, b) in worlds.iter().flat_map(|a| worlds.iter().map(move |b| (a, b))) {
        compare(a, b);
    }
    for at in 16..snapshots[0].len() {
        let mut changed = snapshots[0].clone();
        changed[at] ^= 1;
        reseal(&mut changed);
        if let Ok(other) = world(&changed) {
            compare(&worlds[0], &other);
            compare(&other, &worlds[0]);
        }
    }
    assert!(seen > 1_000, "{seen}");
}

#[test]
fn a_replay_of_another_law_is_refused_by_both_numbers() {
    let mut parts: Vec<(Tag, Vec<u8>)> =
        chunks(&recording()).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    parts[0].1[..4].copy_from_slice(&(PHYSICS_VERSION + 1).to_le_bytes());
    let error = Replay::from_bytes(&file(&parts), &custom_forces()).expect_err("another law");
    assert_eq!(error, ReplayError::PhysicsVersion { found: PHYSICS_VERSION + 1, own: PHYSICS_VERSION });
    let text = error.to_string();
    assert!(text.contains(&PHYSICS_VERSION.to_string()) && text.contains(&(PHYSICS_VERSION + 1).to_string()), "{text}");
}

#[test]
fn what_a_game_does_to_its_world_after_the_last_step_is_of_no_tick_recorded() {
    for snapshot_every in [0, 3] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 2, snapshot_every });
        for tick in 0..3u8 {
            recorder.step(&mut world, &Inputs::new());
            // Between steps it is seen by the next one.
            _ = world.random_mut().bits();
            world.set_blob(&[tick]).expect("few");
            recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic())).expect("there is room");
            recorder.execute(&mut world, &Command::SetGravity(vec2(0, -1))).expect("it is fair");
        }
        let file = recorder.finish(&world);
        let replay = Replay::from_bytes(&file, &[]).expect("it is whole");
        assert_eq!(replay.verify(), Ok(()), "{snapshot_every}");
        let mut playback = replay.play();
        playback.seek(3);
        assert_eq!((playback.world().blob(), playback.world().body_count()), (&[1][..], 2));
    }
}

#[test]
fn where_no_hash_is_recorded_that_of_a_snapshot_is_compared() {
    for (snapshot_every, expected) in [(8, 16), (0, 20)] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1 << 30, snapshot_every });
        for tick in 0..20 {
            if tick == 10 {
                // Past the recorder.
                world.set_velocity(body, vec2(1, 0)).expect("it moves");
            }
            recorder.step(&mut world, &Inputs::new());
        }
        let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
        let divergence = replay.verify().expect_err("it goes another way");
        assert_eq!((divergence.tick, &divergence.finding.field[..]), (expected, "position.x"));
    }
}

#[test]
fn whom_calls_woke_is_in_a_snapshot() {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    while world.step().fell_asleep.is_empty() {}
    world.wake(body).expect("it is there");
    let bytes = world.snapshot().to_bytes();
    let mut there = Snapshot::from_bytes(&bytes, &[]).expect("a snapshot").into_world();
    assert_eq!(there.step().woke, [body]);
    let file = Recorder::new(&world, RecordOptions::default()).finish(&world);
    let (chunk, start) = chunks(&file).remove(1);
    let (at, ..) = values(&chunk).into_iter().find(|(_, _, name, _)| name == "woken[0]").expect("it is there");
    let mut changed = file;
    changed[start + at] ^= 1;
    let Err(ReplayError::Tampered(finding)) = Replay::from_bytes(&changed, &[]) else { panic!("it was changed") };
    assert_eq!((&finding.field[..], finding.recorded.as_deref()), ("woken[0]", Some("body 0")));
}

#[test]
fn the_first_difference_of_two_replays_is_named() {
    let whole = recording();
    let ours = Replay::from_bytes(&whole, &custom_forces()).expect("it is whole");
    assert_eq!(ours.first_difference(&ours), None);
    let mut parts: Vec<(Tag, Vec<u8>)> =
        chunks(&whole).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    let (number, (chunk, _)) =
        chunks(&whole).into_iter().enumerate().find(|(_, (chunk, _))| chunk.tag == TICKS).expect("one");
    let (at, ..) = values(&chunk).into_iter().find(|(_, _, name, _)| name.ends_with("action.force.x")).expect("one");
    parts[number].1[at] ^= 1;
    let theirs = Replay::from_bytes(&file(&parts), &custom_forces()).expect("it is a replay");
    let finding = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(finding.place, Owner::Body(BodyId::from_parts(1, 0)));
    assert!(matches!(finding.phase, TickPhase::Calls | TickPhase::Inputs));
    assert!(finding.field.ends_with("action.force.x"), "{finding}");
    assert_eq!((finding.recorded.as_deref(), finding.found.is_some()), (Some("1"), true));
}

/// Two sides of a tick, each with what it did to its own world.
fn parted(act: impl FnOnce(&mut World), end: impl FnOnce(&mut World)) -> [Dump; 2] {
    let replay = Replay::from_bytes(&recording(), &custom_forces()).expect("it is whole");
    let before = replay.start().clone();
    let body = BodyId::from_parts(1, 0);
    let push = |world: &mut World| world.apply_force(body, vec2(1, 0)).expect("it is dynamic");
    let mut here = before.clone();
    push(&mut here);
    here.step();
    let ours = Dump::of_game(&before, push, &here);
    let mut there = before.clone();
    push(&mut there);
    act(&mut there);
    let acted = there.clone();
    there.step();
    end(&mut there);
    let theirs = Dump::of_game(&before, |world| world.clone_from(&acted), &there);
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

    // Other doings.
    let [ours, theirs] = parted(|world| world.apply_force(body, vec2(0, Fx::DELTA)).expect("it is dynamic"), |_| {});
    let found = ours.first_difference(&theirs).expect("they differ");
    assert_eq!((found.tick, found.phase, found.place), (9, TickPhase::Calls, Owner::Body(body)), "{found}");
    assert_eq!(found.field, "applied.force.y");

    // A machine that computes something else, or whose memory failed.
    let nudge = |world: &mut World| {
        let place = world.body(body).expect("it is there").position();
        world.set_position(body, place + vec2(Fx::DELTA, 0)).expect("near");
    };
    let [ours, theirs] = parted(|_| {}, nudge);
    let found = ours.first_difference(&theirs).expect("they differ");
    assert_eq!((found.phase, found.place), (TickPhase::End, Owner::Body(body)), "{found}");
    assert_eq!(found.field, "position.x");
    assert!(found.recorded.is_some() && found.found.is_some() && found.recorded != found.found);
}

/// Rises by an ulp of a newton where the version says so: a build that computes something else.
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
        let second = world.add_body(BodyDef { groups: 2, ..BodyDef::dynamic() }).expect("a body");
        world.add_field(ForceField { kind: FieldKind::Custom { id: 1 }, groups: 2 }).expect("a field");
        let before = world.clone();
        world.step();
        (Dump::of_tick(&before, &[], &Inputs::new(), &world), second)
    };
    let ((ours, body), (theirs, _)) = (dump(fx!(1)), dump(fx!(1.5)));
    let found = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(found.phase, TickPhase::Stage { index: 1, kind: crate::integrate::StageKind::Kick }, "{found}");
    assert_eq!((found.place, &found.field[..]), (Owner::Body(body), "velocity.y"), "{found}");
}

#[test]
fn a_flipped_bit_in_a_dump_is_named() {
    let [dump, _] = parted(|_| {}, |_| {});
    let whole = dump.to_bytes();
    let mut named = 0;
    for (i, at) in (0..whole.len()).step_by(7).enumerate() {
        let mut changed = whole.clone();
        changed[at] ^= 1 << (i % 8);
        match Dump::from_bytes(&changed, &custom_forces()) {
            Err(ReplayError::Tampered(finding)) => {
                assert!(finding.recorded != finding.found && finding.found.is_some(), "{at}: {finding}");
                named += 1;
            }
            Err(ReplayError::Foreign | ReplayError::Format { .. }) => assert!(at < 12, "{at}"),
            other => panic!("{at}: {other:?}"),
        }
        assert!(Dump::from_bytes(&whole[..at], &custom_forces()).is_err());
    }
    assert!(named > 500, "{named}");
}
