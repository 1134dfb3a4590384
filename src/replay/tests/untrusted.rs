//! Untrusted files: damaged chunks, values that no world has, limits.

use alloc::string::ToString as _;
use alloc::vec;
use alloc::vec::Vec;
use core::sync::atomic::{AtomicU32, Ordering};

use super::{chunks, custom_forces, recording, reseal, values};
use crate::body::{Activity, BodyDef, BodyKind};
use crate::codec::Reader;
use crate::collider::ContactSettings;
use crate::error::Error;
use crate::force::{FieldKind, ForceField};
use crate::fx::{Fx, fx};
use crate::math::{TimeStep, vec2};
use crate::replay::file::{Chunk, Damage, SNAPSHOT, TICKS, read_chunk, write_chunk};
use crate::replay::{
    Owner, RecordOptions, Recorder, Replay, ReplayError, ReplayLimits, Snapshot, SnapshotError, VerifyError,
};
use crate::shape::Shape;
use crate::slots::BodyId;
use crate::world::{Command, Input, Inputs, World, WorldDef};

/// The word with the tag and the length of a chunk stands there twice.
#[test]
fn a_word_before_a_chunk_is_named_with_what_it_was_and_what_it_is() {
    let mut whole = Vec::new();
    write_chunk(&mut whole, TICKS, b"some bytes");
    let word = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"));
    for bit in 0..128 {
        let mut changed = whole.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        let chunk = read_chunk(&mut Reader::new(&changed)).expect("the other word is right");
        assert_eq!((chunk.tag, &chunk.bytes[..]), (TICKS, &b"some bytes"[..]));
        let (at, double) = (bit / 64 * 8, bit >= 64);
        let damage = Damage::Word { recorded: word(&whole, at), computed: word(&changed, at), double };
        assert_eq!(chunk.damage, Some(damage), "bit {bit}");
    }
}

#[test]
fn a_chunk_with_two_changes_is_refused_without_naming_a_value() {
    let world = World::new(WorldDef::default()).expect("a fair definition");
    let mut bytes = Recorder::new(&world, RecordOptions::default()).finish(&world);
    let at = bytes.windows(8).position(|letters| letters == b"UMBRASNP").expect("it begins with a snapshot");
    // Two words change by the same amount: no single word explains it.
    bytes[at] += 1;
    bytes[at + 8] += 1;
    let error = Replay::from_bytes(&bytes, &[]).expect_err("it was changed");
    let ReplayError::Tampered(difference) = error else { panic!("{error}") };
    assert_eq!((difference.left, difference.right), (None, None));
    assert_eq!(difference.field, "chunk 1.bytes");
}

/// A chunk whose sums say that its one word was changed by `change`, and by `weighted` times its place.
fn sealed_otherwise(word: u64, change: i128, weighted: i128) -> Vec<u8> {
    let mut whole = Vec::new();
    write_chunk(&mut whole, TICKS, &word.to_le_bytes());
    let seal = whole.len() - 40;
    whole[seal] ^= 1;
    for (at, off) in [(seal + 8, change), (seal + 24, weighted)] {
        let sum = u128::from(word).wrapping_sub(off as u128);
        whole[at..at + 16].copy_from_slice(&sum.to_le_bytes());
    }
    whole
}

#[test]
fn no_seal_is_too_odd_to_be_judged() {
    let extremes = [i128::MIN, i128::MIN + 1, -1, 1, 2, i128::MAX];
    for word in [0, 1, u64::MAX] {
        for (change, weighted) in extremes.iter().flat_map(|&a| extremes.map(|b| (a, b))) {
            let bytes = sealed_otherwise(word, change, weighted);
            let chunk = read_chunk(&mut Reader::new(&bytes)).expect("its word is whole");
            assert_eq!(chunk.damage, Some(Damage::Unknown), "{word} {change} {weighted}");
        }
    }
}

#[test]
fn ticks_of_the_shortest_commands_are_read() {
    for (players, calls) in [(0, 40), (40, 0), (40, 40)] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 2, snapshot_every: 0 });
        for _ in 0..calls {
            recorder.execute(&mut world, &Command::ClearForces).expect("it is always allowed");
        }
        let mut inputs = Inputs::new();
        for player in 0..players {
            inputs.insert(Input { player, sequence: 0, command: Command::ClearForces }).expect("the first");
        }
        recorder.step(&mut world, &inputs);
        let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
        assert_eq!(replay.verify(), Ok(()));
    }
}

/// A run of four ticks, the first of which differs from the recording; in the second, calls or a player give many commands.
fn forged_run(many: &[Command], by_a_player: bool) -> Replay {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 0 });
    // Past the recorder: the hash after the first tick is one that its run does not have.
    world.set_velocity(body, vec2(1, 0)).expect("it moves");
    for tick in 0..4 {
        let mut inputs = Inputs::new();
        if tick == 1 && by_a_player {
            inputs.replace(0, many.iter().cloned());
        } else if tick == 1 {
            many.iter().for_each(|command| _ = recorder.execute(&mut world, command).expect("there is room"));
        }
        recorder.step(&mut world, &inputs);
    }
    Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole")
}

#[test]
fn a_divergence_is_named_within_the_limits_and_no_further() {
    let drag = ForceField {
        kind: FieldKind::Drag { linear: Fx::ZERO, quadratic: Fx::ZERO, wind: vec2(0, 0) },
        force_groups: 1,
    };
    let replay_limits =
        ReplayLimits { ticks: 4, bodies: 10, fields: 10, colliders: u32::MAX, pairs: u32::MAX, commands: 100 };
    for (many, by_a_player) in [
        (vec![Command::AddBody(BodyDef::dynamic()); 10], false),
        (vec![Command::AddBody(BodyDef::dynamic()); 10], true),
        (vec![Command::AddField(drag); 11], false),
        (vec![Command::AddField(drag); 11], true),
    ] {
        let named = |limits| match forged_run(&many, by_a_player).verify_within(limits) {
            Err(VerifyError::Divergence(divergence)) => (divergence.tick, divergence.difference.field),
            result => panic!("{result:?}"),
        };
        // The snapshot at the end has the difference, if the limits allow to play that far.
        assert_eq!(named(ReplayLimits { bodies: 11, fields: 11, ..replay_limits }), (1, "position.x".to_string()));
        assert_eq!(named(replay_limits), (1, "hash".to_string()));
        assert_eq!(forged_run(&many, by_a_player).verify().expect_err("it parts").difference.field, "position.x");
    }
}

#[test]
fn a_playback_stops_between_commands_and_steps_and_on_the_way_to_a_finding() {
    for by_a_player in [false, true] {
        let replay = forged_run(&vec![Command::AddBody(BodyDef::dynamic()); 10], by_a_player);
        // It is asked before the first step, whose hash differs; then for ten commands and three steps up to the snapshot at the end.
        let finding_after = |most: u32| {
            let asked = AtomicU32::new(0);
            let is_over = || asked.fetch_add(1, Ordering::Relaxed) >= most;
            let mut playback = replay.play().stop_when(&is_over);
            let stepped = playback.step().map_err(|divergence| divergence.difference.field);
            (stepped, playback.exceeded().cloned(), asked.load(Ordering::Relaxed))
        };
        assert_eq!(finding_after(0), (Ok(false), Some(VerifyError::Stopped { tick: 0 }), 1));
        assert_eq!(finding_after(1), (Err("hash".to_string()), None, 2));
        assert_eq!(finding_after(13), (Err("hash".to_string()), None, 14));
        assert_eq!(finding_after(14), (Err("position.x".to_string()), None, 14));
        // After the divergence it goes on, and stops within the tick of the commands.
        let asked = AtomicU32::new(0);
        let is_over = || asked.fetch_add(1, Ordering::Relaxed) >= 20;
        let mut playback = replay.play().stop_when(&is_over);
        assert!(playback.step().is_err());
        assert_eq!((playback.step(), playback.world().body_count()), (Ok(false), 7));
        assert_eq!(playback.exceeded(), Some(&VerifyError::Stopped { tick: 1 }));
        assert_eq!(playback.step(), Ok(false));
        assert_eq!(asked.load(Ordering::Relaxed), 21, "it does not go on");
    }
}

#[test]
fn replays_beyond_the_limits_are_refused_before_they_are_stepped() {
    let replay_limits =
        ReplayLimits { ticks: 3, bodies: 5, fields: 0, colliders: u32::MAX, pairs: u32::MAX, commands: 100 };
    let mut world = World::new(WorldDef::default()).expect("a world");
    (0..2).for_each(|_| _ = world.add_body(BodyDef::dynamic()).expect("a body"));
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    for _ in 0..3 {
        recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic())).expect("there is room");
        recorder.step(&mut world, &Inputs::new());
    }
    // A body that is added and removed in the same tick.
    recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic())).expect("there is room");
    recorder.execute(&mut world, &Command::RemoveBody(BodyId::from_parts(5, 0))).expect("it is there");
    recorder.step(&mut world, &Inputs::new());
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
    assert_eq!(replay.verify_within(ReplayLimits { ticks: 4, bodies: 6, ..replay_limits }), Ok(()));
    let refused = |limits| replay.verify_within(limits).expect_err("it is more");
    assert_eq!(refused(replay_limits), VerifyError::Ticks { found: 4, most: 3 });
    let replay_limits = ReplayLimits { ticks: 4, ..replay_limits };
    assert_eq!(refused(replay_limits), VerifyError::Bodies { tick: 3, most: 5 });
    assert_eq!(refused(ReplayLimits { bodies: 4, ..replay_limits }), VerifyError::Bodies { tick: 2, most: 4 });
    assert_eq!(refused(ReplayLimits { bodies: 1, ..replay_limits }), VerifyError::Bodies { tick: 0, most: 1 });
    // Four bodies are added, and the last one is removed.
    let replay_limits = ReplayLimits { bodies: 6, ..replay_limits };
    assert_eq!(replay.verify_within(ReplayLimits { commands: 5, ..replay_limits }), Ok(()));
    assert_eq!(refused(ReplayLimits { commands: 4, ..replay_limits }), VerifyError::Commands { tick: 3, most: 4 });
    assert_eq!(refused(ReplayLimits { commands: 0, ..replay_limits }), VerifyError::Commands { tick: 0, most: 0 });
    // Colliders that bodies bring along, and settings for more pairs.
    assert_eq!(
        refused(ReplayLimits { pairs: (1 << 20) - 1, ..replay_limits }),
        VerifyError::Pairs { tick: 0, most: (1 << 20) - 1 }
    );
    let tick = world.tick();
    let disc = Shape::circle(fx!(1)).expect("a disc");
    let two = BodyDef::dynamic().with_collider(disc.clone()).with_collider(disc);
    let more = ContactSettings { max_pairs: 1 << 21, ..ContactSettings::default() };
    for (command, error) in [
        (Command::AddBody(two), VerifyError::Colliders { tick, most: 1 }),
        (Command::SetContactSettings(more), VerifyError::Pairs { tick, most: 1 << 20 }),
    ] {
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        let mut after = world.clone();
        let mut inputs = Inputs::new();
        inputs.replace(0, [command]);
        (0..2).for_each(|_| _ = recorder.step(&mut after, &inputs));
        let bytes = recorder.finish(&after);
        let replay = Replay::from_bytes(&bytes, &[]).expect("its own bytes");
        let limits = ReplayLimits { ticks: 9, bodies: 99, fields: 9, colliders: 1, pairs: 1 << 20, commands: 99 };
        assert_eq!(replay.verify_within(limits), Err(error));
    }
}

/// A snapshot with values changed, its hash and seal made right again.
fn forged_from(bytes: Vec<u8>, changes: &[(&str, &[u8])]) -> Vec<u8> {
    let chunk = Chunk { tag: SNAPSHOT, bytes, damage: None };
    let all = values(&chunk);
    let mut bytes = chunk.bytes;
    for (name, value) in changes {
        let (at, length, ..) = all.iter().find(|(_, _, value_name, _)| value_name == name).expect("a value");
        assert_eq!(*length, value.len());
        bytes[*at..at + length].copy_from_slice(value);
    }
    reseal(&mut bytes);
    bytes
}

/// The first snapshot of the recording, forged.
fn forged(changes: &[(&str, &[u8])]) -> Vec<u8> {
    let (chunk, _) = chunks(&recording()).into_iter().find(|(chunk, _)| chunk.tag == SNAPSHOT).expect("one");
    forged_from(chunk.bytes, changes)
}

#[test]
fn a_world_beyond_the_last_tick_is_refused() {
    let at = |tick: u64| {
        let tick = tick.to_le_bytes();
        Snapshot::from_bytes(&forged(&[("tick", &tick), ("elapsed_at_tick", &tick)]), &custom_forces())
    };
    assert!(at(u64::MAX).is_err());
    let world = at(1 << 40).expect("a tick like any other").into_world();
    assert_eq!(world.tick(), 1 << 40);
}

#[test]
fn a_quarantined_body_is_no_farther_off_than_a_step_can_take_one() {
    // 2^31 m less 2^-96, little-endian by words, the higher first.
    let far: Vec<u8> = [i64::MAX as u64, u64::MAX].iter().flat_map(|word| word.to_le_bytes()).collect();
    for name in ["position.x", "position.y", "velocity.x", "angular_velocity"] {
        let name = alloc::format!("bodies[3].{name}");
        let bytes = forged(&[("bodies[3].activity", &[2]), (&name, &far)]);
        assert!(Snapshot::from_bytes(&bytes, &custom_forces()).is_err(), "{name}");
    }
    let bytes = forged(&[("bodies[3].activity", &[2])]);
    let world = Snapshot::from_bytes(&bytes, &custom_forces()).expect("a quarantined body").into_world();
    assert_eq!(world.body(BodyId::from_parts(3, 0)).expect("it is there").activity(), Activity::Quarantined);
}

#[test]
fn impossible_sleeping_and_quarantined_bodies_are_refused() {
    let forge = |activity: u8, def: WorldDef, body: BodyDef| {
        let mut world = World::new(def).expect("a world");
        world.add_body(body).expect("a body");
        let bytes = forged_from(world.snapshot().to_bytes(), &[("bodies[0].activity", &[activity])]);
        Snapshot::from_bytes(&bytes, &[]).map(drop)
    };
    let asleep = |def, body| forge(1, def, body);
    let def = WorldDef::default();
    let still = || BodyDef { gravity_scale: Fx::ZERO, ..BodyDef::dynamic() };
    assert_eq!(asleep(def, still()), Ok(()));
    let owner = Owner::Body(BodyId::from_parts(0, 0));
    let inconsistent = Err(SnapshotError::Invalid { owner, error: Error::Inconsistent });
    assert_eq!(asleep(def, BodyDef { velocity: vec2(0, 1), ..still() }), inconsistent);
    assert_eq!(asleep(def, BodyDef { angular_velocity: Fx::ONE, ..still() }), inconsistent);
    assert_eq!(asleep(def, BodyDef { kind: BodyKind::Static, ..still() }), inconsistent);
    assert_eq!(asleep(WorldDef { sleep_after: None, ..def }, still()), inconsistent);
    for (kind, expected) in
        [(BodyKind::Static, inconsistent), (BodyKind::Kinematic, Ok(())), (BodyKind::Dynamic, Ok(()))]
    {
        assert_eq!(forge(2, def, BodyDef { kind, ..still() }), expected, "{kind:?}");
    }
}

#[test]
fn a_time_step_is_in_lowest_terms() {
    let bytes = |num: u32, den: u32| {
        let mut bytes = Command::SetTimeStep(TimeStep::hz(60)).to_bytes();
        bytes[1..5].copy_from_slice(&num.to_le_bytes());
        bytes[5..].copy_from_slice(&den.to_le_bytes());
        bytes
    };
    for (num, den) in [(2, 120), (0, 60), (7, 0), (60, 60)] {
        assert!(Command::from_bytes(&bytes(num, den)).is_err(), "{num}/{den}");
    }
    for (num, den) in [(1, 60), (1001, 60_000), (0, 1), (1, 0), (0, 0)] {
        let read = Command::from_bytes(&bytes(num, den)).map(|command| command.to_bytes());
        assert_eq!(read, Ok(bytes(num, den)));
    }
}
