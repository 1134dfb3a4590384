//! Random forgeries of snapshots, replays and commands: each is refused, or a world that goes on like any other.

use alloc::vec::Vec;

use super::{chunks, commands, custom_forces, file, recording, reseal, values};
use crate::body::BodyDef;
use crate::cases::{run_seed, times};
use crate::math::Random;
use crate::replay::file::{SNAPSHOT, Tag};
use crate::replay::{Replay, Snapshot};
use crate::slots::BodyId;
use crate::world::{Command, World};

/// Everything that can be asked of a world and done to it.
fn use_up(mut world: World, random: &mut Random) {
    for body in world.bodies() {
        _ = (body.rotation(), body.applied_force(), body.applied_torque(), body.mass(), body.inertia());
        _ = (body.position_exact().map(|x| x.value()), body.angle(), body.velocity(), body.angular_velocity());
    }
    _ = (world.energy(), world.momentum(), world.angular_momentum(), world.elapsed(), world.physics_hash());
    let ids: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    for &id in &ids {
        let mut ahead = world.preview(id).expect("it is there");
        ahead.step();
    }
    let bytes = world.snapshot().to_bytes();
    let again = Snapshot::from_bytes(&bytes, &custom_forces()).expect("its own bytes");
    assert_eq!(again.to_bytes(), bytes);
    let mut copy = again.into_world();
    for _ in 0..3 {
        let applied = world.step().applied.to_vec();
        let trace = copy.step_traced();
        assert_eq!(copy.state_hash(), world.state_hash());
        for (_, stage) in trace.stages() {
            Snapshot::from_bytes(&stage.snapshot().to_bytes(), &custom_forces()).expect("a world like any other");
            let mut stage = stage.clone();
            stage.step();
        }
        let mut back = world.clone();
        _ = back.step_back(&applied);
        back.step();
        for command in commands() {
            if random.below(4) == 0 {
                _ = world.execute(&command);
                _ = copy.execute(&command);
            }
        }
        for &id in &ids {
            if random.below(8) == 0 {
                assert_eq!(world.release(id), copy.release(id));
            }
        }
    }
    for id in ids {
        _ = world.remove_body(id);
        _ = world.add_body(BodyDef::dynamic());
        world.step();
    }
}

/// One of the values that break things, or any, over these bytes.
fn disturb(bytes: &mut [u8], random: &mut Random) {
    let odd = [0, 1, u64::MAX, i64::MAX as u64, i64::MIN as u64, 1 << 32, u64::from(u32::MAX), 1 << 62, 1 << 20 << 32];
    match random.below(4) {
        0 => {
            let at = random.below(bytes.len() as u64) as usize;
            bytes[at] ^= 1 << random.below(8);
        }
        1 => bytes.fill(random.bits() as u8),
        _ => {
            for word in bytes.chunks_mut(8) {
                let value = if random.below(3) == 0 { random.bits() } else { odd[random.below(9) as usize] };
                let value = value.wrapping_add(random.below(3)).wrapping_sub(1).to_le_bytes();
                word.copy_from_slice(&value[..word.len()]);
            }
        }
    }
}

#[test]
fn forged_snapshots_are_refused_or_go_on_like_any_other() {
    let mut random = Random::seeded(run_seed(5));
    let all: Vec<_> = chunks(&recording()).into_iter().filter(|(chunk, _)| chunk.tag == SNAPSHOT).collect();
    let all: Vec<_> = all.into_iter().map(|(chunk, _)| (values(&chunk), chunk.bytes)).collect();
    let (mut accepted, mut refused) = (0, 0);
    for _ in 0..times(30u64) {
        let (values, bytes) = &all[random.below(all.len() as u64) as usize];
        let mut bytes = bytes.clone();
        for _ in 0..=random.below(3) {
            let (at, length, ..) = &values[random.below(values.len() as u64 - 2) as usize];
            disturb(&mut bytes[*at..at + length], &mut random);
        }
        if random.below(8) == 0 {
            let at = random.below(bytes.len() as u64) as usize;
            bytes.drain(at..bytes.len().min(at + 1 + random.below(40) as usize));
        }
        if bytes.len() < 32 {
            continue;
        }
        reseal(&mut bytes);
        match Snapshot::from_bytes(&bytes, &custom_forces()) {
            Ok(snapshot) => {
                assert_eq!(snapshot.to_bytes(), bytes);
                use_up(snapshot.into_world(), &mut random);
                accepted += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(accepted > times(30u64) / 20 && refused > times(30u64) / 20, "{accepted}, {refused}");
}

#[test]
fn forged_replays_are_refused_or_played() {
    let mut random = Random::seeded(run_seed(6));
    let all: Vec<_> =
        chunks(&recording()).into_iter().map(|(chunk, _)| (chunk.tag, values(&chunk), chunk.bytes)).collect();
    let (mut played, mut refused) = (0, 0);
    for _ in 0..times(20u64) {
        let mut parts: Vec<(Tag, Vec<u8>)> = all.iter().map(|(tag, _, bytes)| (*tag, bytes.clone())).collect();
        for _ in 0..=random.below(3) {
            let number = random.below(all.len() as u64) as usize;
            let (tag, values, _) = &all[number];
            if *tag == SNAPSHOT && random.below(8) != 0 {
                continue;
            }
            let (at, length, ..) = &values[random.below(values.len() as u64) as usize];
            disturb(&mut parts[number].1[*at..at + length], &mut random);
            if *tag == SNAPSHOT {
                reseal(&mut parts[number].1);
            }
        }
        let bytes = file(&parts);
        match Replay::from_bytes(&bytes, &custom_forces()) {
            Ok(replay) => {
                assert_eq!(replay.to_bytes(), bytes);
                _ = replay.verify();
                let mut playback = replay.play();
                playback.seek(u64::MAX);
                use_up(playback.world().clone(), &mut random);
                played += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(played > times(20u64) / 20 && refused > times(20u64) / 20, "{played}, {refused}");
}

#[test]
fn forged_commands_are_refused_or_carried_out() {
    let mut random = Random::seeded(run_seed(7));
    let replay = Replay::from_bytes(&recording(), &custom_forces()).expect("it is whole");
    let all: Vec<Vec<u8>> = commands().iter().map(Command::to_bytes).collect();
    let mut world = replay.start().clone();
    let mut carried_out = 0;
    for i in 0..times(400u64) {
        let mut bytes = all[random.below(all.len() as u64) as usize].clone();
        let at = random.below(bytes.len() as u64) as usize;
        let end = bytes.len().min(at + 1 + random.below(17) as usize);
        disturb(&mut bytes[at..end], &mut random);
        let Ok(command) = Command::from_bytes(&bytes) else { continue };
        assert_eq!(command.to_bytes(), bytes, "{command:?}");
        let checked = world.check(&command);
        let hash = world.state_hash();
        let done = world.execute(&command);
        assert_eq!(checked.err(), done.err());
        if done.is_ok() {
            carried_out += 1;
        } else {
            assert_eq!(world.state_hash(), hash);
        }
        if i % 5 == 0 {
            world.step();
        }
        if i % 200 == 199 {
            use_up(world, &mut random);
            world = replay.start().clone();
        }
    }
    assert!(carried_out > times(400u64) / 20, "{carried_out}");
}
