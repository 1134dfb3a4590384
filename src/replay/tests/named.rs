//! A change of a replay is named: every value of the format, one bit at a time, as it is and with a seal made anew.

use alloc::boxed::Box;
use alloc::collections::BTreeSet;
use alloc::format;
use alloc::string::ToString as _;
use alloc::vec::Vec;

use super::{chunks, commands, custom_forces, file, places, recording, reseal, values};
use crate::body::BodyDef;
use crate::cases::is_short;
use crate::replay::file::{REPLAY, SNAPSHOT, TICKS, Tag};
use crate::replay::{
    Divergence, Owner, PHYSICS_VERSION, RecordOptions, Recorder, Replay, ReplayError, Snapshot, TickPhase,
};
use crate::slots::BodyId;
use crate::world::{Command, World, WorldDef};

#[test]
fn every_command_is_recorded_and_played_alike() {
    let kinds: BTreeSet<u8> = commands().iter().map(Command::number).collect();
    assert_eq!(kinds.len(), Command::NUMBERS.len(), "each kind of command is among them");
    let file = recording();
    let replay = Replay::from_bytes(&file, &custom_forces()).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    let mut playback = replay.play();
    while playback.step().expect("it goes as recorded") {
        assert!(playback.outcomes().iter().all(|outcome| outcome.result.is_ok()), "{:?}", playback.outcomes());
    }
    // Seeks from every tick to every other.
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
    let (mut count, step) = (0, if is_short() { 5 } else { 1 });
    for (number, (chunk, start)) in chunks(&whole).into_iter().enumerate() {
        for (at, length, name, text) in values(&chunk).into_iter().step_by(step) {
            for bit in [0, 8 * length - 1] {
                let mut changed = whole.clone();
                changed[start + at + bit / 8] ^= 1 << (bit % 8);
                let what = format!("chunk {number}, {name}, bit {bit}");
                match Replay::from_bytes(&changed, &custom_forces()) {
                    Err(ReplayError::Tampered(difference)) => {
                        assert!(name.ends_with(&difference.field), "{what}: {difference}");
                        assert_eq!(difference.left.as_deref(), Some(&text[..]), "{what}: {difference}");
                        assert!(difference.right.as_deref().is_some_and(|right| right != text), "{what}: {difference}");
                        if let Some(rest) = name.strip_prefix("bodies[") {
                            let slot = rest.split(']').next().and_then(|slot| slot.parse::<u32>().ok());
                            assert!(
                                matches!(difference.owner, Owner::Body(body) if Some(body.parts().0) == slot),
                                "{what}: {difference}"
                            );
                        }
                        count += 1;
                    }
                    reply => panic!("{what}: {reply:?}"),
                }
            }
        }
    }
    assert!(count * step > 1_000, "{count}");
}

#[test]
fn a_flipped_bit_anywhere_and_a_file_cut_off_anywhere_are_found() {
    let whole = recording();
    for at in places(whole.len()) {
        let mut changed = whole.clone();
        changed[at] ^= 1 << (at % 8);
        assert!(Replay::from_bytes(&changed, &custom_forces()).is_err(), "byte {at}");
        let cut = Replay::from_bytes(&whole[..at], &custom_forces());
        let foreign = at < REPLAY.magic.len();
        assert!(
            matches!(cut, Err(ReplayError::Foreign)) && foreign || matches!(cut, Err(ReplayError::CutOff { .. })),
            "cut off at {at}: {cut:?}"
        );
        // The complete part of it runs as recorded.
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

/// The result of reading and verifying a file in which one value was changed, and all seals made anew.
fn forged(whole: &[u8], number: usize, at: usize, bit: usize) -> Result<(), Result<Box<Divergence>, ReplayError>> {
    let mut parts: Vec<(Tag, Vec<u8>)> = chunks(whole).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    parts[number].1[at + bit / 8] ^= 1 << (bit % 8);
    let (tag, bytes) = &mut parts[number];
    if *tag == SNAPSHOT {
        // A forger makes the hashes right as well, if the values are those of a world.
        reseal(bytes);
    }
    let replay = Replay::from_bytes(&file(&parts), &custom_forces()).map_err(Err)?;
    replay.verify().map_err(Ok)
}

#[test]
fn a_forged_value_is_refused_or_its_run_parts_from_the_recorded_one() {
    let whole = recording();
    let (mut named, mut by_hash, mut refused, mut unfelt) = (0, 0, 0, Vec::new());
    for (number, (chunk, _)) in chunks(&whole).into_iter().enumerate() {
        for (at, length, name, _) in values(&chunk) {
            if chunk.tag == SNAPSHOT && ["hash", "seal"].contains(&&name[..]) {
                // A forger makes these values right again.
                continue;
            }
            // Not the last bit of a velocity: damping may round it away.
            match forged(&whole, number, at, 4 * length + 3) {
                Err(Ok(divergence)) if divergence.difference.field == "hash" => by_hash += 1,
                Err(Ok(divergence)) => {
                    let difference = &divergence.difference;
                    assert!(difference.left != difference.right, "{difference}");
                    named += 1;
                }
                Err(Err(_)) => refused += 1,
                Ok(()) => unfelt.push(format!("chunk {number}, {name}")),
            }
        }
    }
    assert!(named > 300 && by_hash > 5 && refused > 300, "{named}, {by_hash}, {refused}");
    // Changes with no effect on later ticks: who sent a command, how it was recorded, what only reports hand on, how long
    // a body was at rest that moves in the next tick, and of the one that the next tick moves to a goal what is below the ulp
    // of its place, how fast it was, and whether it was to stop. And the name of a point that the next tick has by another one: the impulse
    // goes to that point.
    for what in unfelt {
        let labels = ["player", "sequence", "_every", "sleep_changes", "wake", "ticks_at_rest"];
        let is_label = labels.iter().any(|label| what.contains(label));
        let of_the_moved = ["position", "velocity", "angular_velocity", "kinematic_target.arrived"];
        let is_moved = of_the_moved.iter().any(|part| what.starts_with(&format!("chunk 1, bodies[9].{part}")));
        let is_renamed = what.contains("].points[") && what.ends_with("].feature");
        let is_overwritten = what.contains("inputs[") || what.contains("calls[") || is_moved || is_renamed;
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
    let mut differing = 0;
    let mut compare = |a: &World, b: &World| {
        assert_eq!(a.first_difference(b), a.differences(b).into_iter().next());
        differing += usize::from(a.first_difference(b).is_some());
    };
    for (a, b) in worlds.iter().flat_map(|a| worlds.iter().map(move |b| (a, b))) {
        compare(a, b);
    }
    // Most values have four bytes or more.
    for at in (16..snapshots[0].len()).step_by(3) {
        let mut changed = snapshots[0].clone();
        changed[at] ^= 1;
        reseal(&mut changed);
        if let Ok(changed_world) = world(&changed) {
            compare(&worlds[0], &changed_world);
            compare(&changed_world, &worlds[0]);
        }
    }
    assert!(differing > 1_000, "{differing}");
}

#[test]
fn a_replay_of_another_physics_version_is_refused_by_both_numbers() {
    let mut parts: Vec<(Tag, Vec<u8>)> =
        chunks(&recording()).into_iter().map(|(chunk, _)| (chunk.tag, chunk.bytes)).collect();
    parts[0].1[..4].copy_from_slice(&(PHYSICS_VERSION + 1).to_le_bytes());
    let error = Replay::from_bytes(&file(&parts), &custom_forces()).expect_err("another version");
    assert_eq!(error, ReplayError::PhysicsVersion { found: PHYSICS_VERSION + 1, own: PHYSICS_VERSION });
    let text = error.to_string();
    assert!(text.contains(&PHYSICS_VERSION.to_string()) && text.contains(&(PHYSICS_VERSION + 1).to_string()), "{text}");
}

#[test]
fn whom_calls_woke_is_in_a_snapshot() {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    while world.step().fell_asleep.is_empty() {}
    world.wake(body).expect("it is there");
    let bytes = world.snapshot().to_bytes();
    let mut reread = Snapshot::from_bytes(&bytes, &[]).expect("a snapshot").into_world();
    assert_eq!(reread.step().woke, [body]);
    let file = Recorder::new(&world, RecordOptions::default()).finish(&world);
    let (chunk, start) = chunks(&file).remove(1);
    let (at, ..) = values(&chunk).into_iter().find(|(_, _, name, _)| name == "sleep_changes[0]").expect("it is there");
    let mut changed = file;
    changed[start + at] ^= 1;
    let Err(ReplayError::Tampered(difference)) = Replay::from_bytes(&changed, &[]) else { panic!("it was changed") };
    assert_eq!((&difference.field[..], difference.left.as_deref()), ("sleep_changes[0]", Some("body 0")));
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
    let difference = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(difference.owner, Owner::Body(BodyId::from_parts(1, 0)));
    assert!(matches!(difference.phase, TickPhase::Calls | TickPhase::Inputs));
    assert!(difference.field.ends_with("action.force.x"), "{difference}");
    assert_eq!((difference.left.as_deref(), difference.right.is_some()), (Some("1"), true));
}
