//! Runs: recording them, seeking in them, comparing them.

use alloc::vec::Vec;

use super::chunks;
use crate::body::BodyDef;
use crate::codec::Reader;
use crate::fx::fx;
use crate::math::{Random, vec2};
use crate::replay::file::{Segment, TICKS};
use crate::replay::{Owner, RecordOptions, Recorder, Replay, TickPhase};
use crate::world::{Command, Input, Inputs, World, WorldDef};

/// Ticks come in chunks of 64, and of fewer where they have much in them.
#[test]
fn ticks_are_recorded_in_chunks_of_a_size() {
    let counts = |inputs: Inputs, ticks: u32| -> Vec<u32> {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        let mut recorder = Recorder::new(&world, RecordOptions { snapshot_every: 0, ..RecordOptions::default() });
        (0..ticks).for_each(|_| _ = recorder.step(&mut world, &inputs));
        let file = recorder.finish(&world);
        let segments = chunks(&file).into_iter().map(|(chunk, _)| chunk).filter(|chunk| chunk.tag == TICKS);
        segments.map(|chunk| Segment::read(&mut Reader::new(&chunk.bytes)).expect("ticks").count).collect()
    };
    assert_eq!(counts(Inputs::new(), 200), [64, 64, 64, 8]);
    // 600 kB a tick: after a MiB another chunk begins.
    let large = Input { player: 0, sequence: 0, command: Command::SetBlob(alloc::vec![1; 600_000]) };
    assert_eq!(counts(Inputs::try_from(alloc::vec![large]).expect("it has a place"), 5), [2, 2, 1]);
}

/// A generator and a blob that calls set are recorded as these calls alone; set without a command, or once more after a command,
/// as one call more each.
#[test]
fn each_value_that_a_call_sets_is_recorded_once() {
    let calls = |execute: bool, set: bool| {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        let commands = [Command::SetRandom(Random::seeded(5)), Command::SetBlob(alloc::vec![1, 2])];
        for command in commands.iter().filter(|_| execute) {
            recorder.execute(&mut world, command).expect("it is always allowed");
        }
        if set {
            world.random_mut().bits();
            world.set_blob(&[3]).expect("a small blob");
        }
        recorder.step(&mut world, &Inputs::new());
        let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
        replay.verify().expect("it is as recorded");
        replay.play().commands().count()
    };
    assert_eq!([(false, false), (true, false), (false, true), (true, true)].map(|(a, b)| calls(a, b)), [0, 2, 2, 4]);
}

/// A command that one side alone has is named by the tick, and as a call or an input.
#[test]
fn replays_with_unlike_numbers_of_calls_or_inputs_say_so() {
    let record = |calls: u32, inputs: u32| {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        for tick in 0..4 {
            let many = |count: u32| if tick == 2 { count } else { 1 };
            for _ in 0..many(calls) {
                recorder.execute(&mut world, &Command::ClearForces).expect("it is always allowed");
            }
            let input = |sequence| Input { player: 0, sequence, command: Command::ClearForces };
            let inputs: Vec<Input> = (0..many(inputs)).map(input).collect();
            recorder.step(&mut world, &Inputs::try_from(inputs).expect("each has a place"));
        }
        Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole")
    };
    let even = record(1, 1);
    for (replay, phase, field) in
        [(record(2, 1), TickPhase::Calls, "calls.count"), (record(1, 3), TickPhase::Inputs, "inputs.count")]
    {
        let difference = even.first_difference(&replay).expect("they differ");
        assert_eq!(
            (difference.tick, difference.phase, difference.owner, &difference.field[..]),
            (2, phase, Owner::World, field)
        );
    }
}

/// Two runs with the same commands and other results differ in values of the next snapshots.
#[test]
fn replays_that_part_name_the_value_in_the_snapshot_after() {
    let record = |parts_at: u64| {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        let body = world.add_body(BodyDef::dynamic()).expect("there is room");
        let options = RecordOptions { hash_every: 1, snapshot_every: 4 };
        let mut recorder = Recorder::new(&world, options);
        for tick in 0..11 {
            if tick == parts_at {
                // Past the recorder, as by a fault of the machine.
                world.set_angular_velocity(body, fx!(1)).expect("it turns");
            }
            recorder.step(&mut world, &Inputs::new());
        }
        Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole")
    };
    let sound = record(u64::MAX);
    for (parts_at, named_at) in [(0, 3), (3, 3), (4, 7), (7, 7), (8, 10), (10, 10)] {
        let difference = sound.first_difference(&record(parts_at)).expect("they part");
        assert_eq!(
            (difference.tick, difference.phase, &difference.field[..]),
            (named_at, TickPhase::End, "angle"),
            "from {parts_at}"
        );
    }
}

/// Each way forward goes over as few ticks as the snapshots allow: only another one of them puts the world back.
#[test]
fn seeking_goes_on_from_where_it_is_or_from_a_nearer_snapshot() {
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    let mut recorder = Recorder::new(&world, RecordOptions { snapshot_every: 10, ..RecordOptions::default() });
    (0..40).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
    let mut playback = replay.play();
    for (tick, jumps) in
        [(5, false), (9, false), (10, true), (19, false), (39, true), (38, true), (12, true), (12, false)]
    {
        let before = playback.world().rewinds();
        playback.seek(tick);
        assert_eq!((playback.world().tick(), playback.world().rewinds() != before), (tick, jumps), "to {tick}");
    }
}

#[test]
fn changes_after_the_last_step_belong_to_no_recorded_tick() {
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
        assert_eq!((divergence.tick, &divergence.difference.field[..]), (expected, "position.x"));
    }
}

#[test]
fn replays_that_part_where_no_tick_has_a_hash_are_compared_by_snapshots_and_the_end() {
    let record = |hash_every: u32, snapshot_every: u32, ticks: u64, parts_at: u64| {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        let mut recorder = Recorder::new(&world, RecordOptions { hash_every, snapshot_every });
        for tick in 0..ticks {
            if tick == parts_at {
                // Past the recorder.
                world.set_velocity(body, vec2(1, 0)).expect("it moves");
            }
            recorder.step(&mut world, &Inputs::new());
        }
        Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole")
    };
    let never = u64::MAX;
    // The last two pairs have no hash in common from tick 70 on: the end of one is compared with a hash of the other.
    for (ours, theirs, found_at, field) in [
        (record(60, 0, 90, never), record(60, 0, 90, 70), Some(89), "position.x"),
        (record(60, 8, 90, never), record(60, 8, 90, 70), Some(71), "position.x"),
        (record(60, 80, 100, never), record(60, 80, 90, 70), Some(79), "position.x"),
        (record(60, 0, 90, never), record(1, 0, 100, 70), Some(89), "hash"),
        (record(60, 0, 90, never), record(1, 7, 100, never), None, ""),
    ] {
        for (a, b) in [(&ours, &theirs), (&theirs, &ours)] {
            let difference = a.first_difference(b);
            let difference =
                difference.as_ref().map(|difference| (difference.tick, difference.phase, &difference.field[..]));
            assert_eq!(difference, found_at.map(|tick| (tick, TickPhase::End, field)));
        }
    }
}

#[test]
fn a_seek_leaves_no_results_of_inputs() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let mut recorder = Recorder::new(&world, RecordOptions { snapshot_every: 10, ..RecordOptions::default() });
    let input = Input { player: 0, sequence: 0, command: Command::ClearForces };
    let inputs = Inputs::try_from(alloc::vec![input]).expect("it has a place");
    (0..20).for_each(|_| _ = recorder.step(&mut world, &inputs));
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
    let mut playback = replay.play();
    // Back to the start, on to a snapshot, and on to a tick without one.
    for tick in [0, 10, 15] {
        assert_eq!(playback.step(), Ok(true));
        assert_eq!(playback.outcomes().len(), 1);
        playback.seek(tick);
        assert!(playback.outcomes().is_empty(), "at {tick}");
    }
}
