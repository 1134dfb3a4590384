//! Files that nobody recorded: whatever is in them is refused, or a world that goes on like any other.

use alloc::string::ToString as _;
use alloc::vec;
use alloc::vec::Vec;

use super::chunk::{self, Chunk, Damage, Tag};
use super::file::{SNAPSHOT, TICKS};
use super::tests::{chunks, commands, custom_forces, file, recording, reseal, values};
use super::{
    Dump, Owner, RecordOptions, Recorder, Replay, ReplayError, ReplayLimits, Snapshot, SnapshotError, VerifyError,
};
use crate::body::{Activity, BodyDef, BodyKind};
use crate::codec::Reader;
use crate::error::Error;
use crate::force::{FieldKind, ForceField};
use crate::integrate::Integrator;
use crate::math::{Random, TimeStep, vec2};
use crate::scalar::fx::Fx;
use crate::slots::BodyId;
use crate::world::{Command, Input, Inputs, World, WorldDef};

/// What a chunk is and how long it is stands there twice.
#[test]
fn a_word_before_a_chunk_is_named_with_what_it_was_and_what_it_is() {
    let mut whole = Vec::new();
    chunk::write(&mut whole, TICKS, b"some bytes");
    let word = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"));
    for bit in 0..128 {
        let mut changed = whole.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        let chunk = chunk::read(&mut Reader::new(&changed)).expect("the other word is right");
        assert_eq!((chunk.tag, &chunk.bytes[..]), (TICKS, &b"some bytes"[..]));
        let (at, double) = (bit / 64 * 8, bit >= 64);
        let damage = Damage::Word { recorded: word(&whole, at), found: word(&changed, at), double };
        assert_eq!(chunk.damage, Some(damage), "bit {bit}");
    }
}

#[test]
fn a_changed_chunk_of_a_dump_is_named_by_its_number() {
    let before: World = World::new(WorldDef::default()).expect("a fair definition");
    let mut after = before.clone();
    after.step();
    let whole = Dump::of_tick(&before, &[], &Inputs::new(), &after).to_bytes();
    // Letters and format; then a word and its double before each chunk, a hash and two sums after it.
    let (mut at, mut number) = (12, 0);
    while at < whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        let error = Dump::from_bytes(&changed, &[]).expect_err("it was changed");
        let ReplayError::Tampered(finding) = error else { panic!("{error}") };
        assert_eq!(finding.field, alloc::format!("chunk {number}.word"));
        let length = u32::from_le_bytes(whole[at + 4..at + 8].try_into().expect("four bytes"));
        (at, number) = (at + 16 + length as usize + 40, number + 1);
    }
    assert!(number > 7, "{number} chunks");
}

#[test]
fn of_a_chunk_that_was_changed_twice_no_value_is_named() {
    let world: World = World::new(WorldDef::default()).expect("a fair definition");
    let mut bytes = Recorder::new(&world, RecordOptions::default()).finish(&world);
    let at = bytes.windows(8).position(|letters| letters == b"UMBRASNP").expect("it begins with a snapshot");
    // Two words, by as much: no one word is so far off.
    bytes[at] += 1;
    bytes[at + 8] += 1;
    let error = Replay::from_bytes(&bytes, &[]).expect_err("it was changed");
    let ReplayError::Tampered(finding) = error else { panic!("{error}") };
    assert_eq!((finding.recorded, finding.found), (None, None));
    assert_eq!(finding.field, "chunk 1.bytes");
}

/// A chunk whose seal says that its one word was changed by so much, and by so much times its place.
fn sealed_otherwise(word: u64, change: i128, weighted: i128) -> Vec<u8> {
    let mut whole = Vec::new();
    chunk::write(&mut whole, TICKS, &word.to_le_bytes());
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
    let most = [i128::MIN, i128::MIN + 1, -1, 1, 2, i128::MAX];
    for word in [0, 1, u64::MAX] {
        for (change, weighted) in most.iter().flat_map(|&a| most.map(|b| (a, b))) {
            let bytes = sealed_otherwise(word, change, weighted);
            let chunk = chunk::read(&mut Reader::new(&bytes)).expect("its word is whole");
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

/// A run of four ticks, of which the first is not as it was recorded; in the second calls, or a player, add what there is many of.
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
    let drag =
        ForceField { kind: FieldKind::Drag { linear: Fx::ZERO, quadratic: Fx::ZERO, wind: vec2(0, 0) }, groups: 1 };
    let most = ReplayLimits { ticks: 4, bodies: 10, fields: 10, commands: 100 };
    for (many, by_a_player) in [
        (vec![Command::AddBody(BodyDef::dynamic()); 10], false),
        (vec![Command::AddBody(BodyDef::dynamic()); 10], true),
        (vec![Command::AddField(drag); 11], false),
        (vec![Command::AddField(drag); 11], true),
    ] {
        let named = |limits| match forged_run(&many, by_a_player).verify_within(limits) {
            Err(VerifyError::Divergence(divergence)) => (divergence.tick, divergence.finding.field),
            other => panic!("{other:?}"),
        };
        // What differs is in the snapshot at the end, to which it is played if it may be.
        assert_eq!(named(ReplayLimits { bodies: 11, fields: 11, ..most }), (1, "position.x".to_string()));
        assert_eq!(named(most), (1, "hash".to_string()));
        assert_eq!(forged_run(&many, by_a_player).verify().expect_err("it parts").finding.field, "position.x");
    }
}

#[test]
fn what_is_more_than_it_may_be_is_refused_before_it_is_stepped() {
    let most = ReplayLimits { ticks: 3, bodies: 5, fields: 0, commands: 100 };
    let mut world = World::new(WorldDef::default()).expect("a world");
    (0..2).for_each(|_| _ = world.add_body(BodyDef::dynamic()).expect("a body"));
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    for _ in 0..3 {
        recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic())).expect("there is room");
        recorder.step(&mut world, &Inputs::new());
    }
    // One that is gone by the end of its tick was there.
    recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic())).expect("there is room");
    recorder.execute(&mut world, &Command::RemoveBody(BodyId::from_parts(5, 0))).expect("it is there");
    recorder.step(&mut world, &Inputs::new());
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("it is whole");
    assert_eq!(replay.verify_within(ReplayLimits { ticks: 4, bodies: 6, ..most }), Ok(()));
    let refused = |limits| replay.verify_within(limits).expect_err("it is more");
    assert_eq!(refused(most), VerifyError::Ticks { found: 4, most: 3 });
    let most = ReplayLimits { ticks: 4, ..most };
    assert_eq!(refused(most), VerifyError::Bodies { tick: 3, most: 5 });
    assert_eq!(refused(ReplayLimits { bodies: 4, ..most }), VerifyError::Bodies { tick: 2, most: 4 });
    assert_eq!(refused(ReplayLimits { bodies: 1, ..most }), VerifyError::Bodies { tick: 0, most: 1 });
    // Four bodies are added, and the last one is removed.
    let most = ReplayLimits { bodies: 6, ..most };
    assert_eq!(replay.verify_within(ReplayLimits { commands: 5, ..most }), Ok(()));
    assert_eq!(refused(ReplayLimits { commands: 4, ..most }), VerifyError::Commands { tick: 3, most: 4 });
    assert_eq!(refused(ReplayLimits { commands: 0, ..most }), VerifyError::Commands { tick: 0, most: 0 });
}

/// A snapshot with values changed, its hash and seal made right again.
fn forged_from(bytes: Vec<u8>, changes: &[(&str, &[u8])]) -> Vec<u8> {
    let chunk = Chunk { tag: SNAPSHOT, bytes, damage: None };
    let all = values(&chunk);
    let mut bytes = chunk.bytes;
    for (name, value) in changes {
        let (at, length, ..) = all.iter().find(|(_, _, there, _)| there == name).expect("a value");
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
fn what_sleeps_or_is_quarantined_could_have_come_to_it() {
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
    let place = Owner::Body(BodyId::from_parts(0, 0));
    let inconsistent = Err(SnapshotError::Invalid { place, error: Error::Inconsistent });
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
fn a_dump_has_the_moments_of_its_tick_and_no_others() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let before = world.clone();
    let to_yoshida = Command::SetIntegrator(Integrator::Yoshida4);
    world.execute(&to_yoshida).expect("it is fair");
    world.step();
    let dump = Dump::of_tick(&before, &[to_yoshida], &Inputs::new(), &world).to_bytes();
    assert_eq!(Dump::from_bytes(&dump, &[]).expect("it is whole").phases().len(), 3 + 19 + 1);
    let mut reader = Reader::new(&dump[12..]);
    let mut parts = Vec::new();
    while let Some(chunk) = chunk::read(&mut reader) {
        parts.push((chunk.tag, chunk.bytes));
    }
    // Laws and ticks come before the moments. One of them again, or one less; each that is told again costs a world.
    for at in 2..parts.len() - 1 {
        let (mut more, mut less) = (parts.clone(), parts.clone());
        more.insert(at + 1, (parts[at].0, again(&parts[at].1)));
        less.remove(at);
        for forged in [more, less] {
            let mut bytes = dump[..12].to_vec();
            forged.iter().for_each(|(tag, part)| chunk::write(&mut bytes, *tag, part));
            assert!(Dump::from_bytes(&bytes, &[]).is_err(), "chunk {at} of {}", forged.len());
        }
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

/// The moment in a chunk, with the world of the moment before.
fn again(chunk: &[u8]) -> Vec<u8> {
    // A stage is five bytes more.
    let phase = if chunk[0] == 3 { 6 } else { 1 };
    let mut bytes = chunk[..phase].to_vec();
    bytes.push(0);
    bytes
}

/// Everything that can be asked of a world and done to it.
fn use_up(mut world: World, random: &mut Random) {
    for body in world.bodies() {
        _ = (body.origin(), body.rotation(), body.applied_force(), body.applied_torque(), body.mass(), body.inertia());
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

/// How often a test tries: more if asked to.
fn tries(usual: u64) -> u64 {
    option_env!("UMBRA_TRIES").and_then(|tries| tries.parse().ok()).unwrap_or(usual)
}

#[test]
fn forged_snapshots_are_refused_or_go_on_like_any_other() {
    let seed = option_env!("UMBRA_SEED").and_then(|seed| seed.parse().ok()).unwrap_or(5);
    let mut random = Random::seeded(seed);
    let all: Vec<_> = chunks(&recording()).into_iter().filter(|(chunk, _)| chunk.tag == SNAPSHOT).collect();
    let all: Vec<_> = all.into_iter().map(|(chunk, _)| (values(&chunk), chunk.bytes)).collect();
    let (mut accepted, mut refused) = (0, 0);
    for _ in 0..tries(300) {
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
    assert!(accepted > tries(300) / 20 && refused > tries(300) / 20, "{accepted}, {refused}");
}

#[test]
fn forged_replays_are_refused_or_played() {
    let mut random = Random::seeded(6);
    let all: Vec<_> =
        chunks(&recording()).into_iter().map(|(chunk, _)| (chunk.tag, values(&chunk), chunk.bytes)).collect();
    let (mut played, mut refused) = (0, 0);
    for _ in 0..tries(200) {
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
    assert!(played > tries(200) / 20 && refused > tries(200) / 20, "{played}, {refused}");
}

#[test]
fn forged_commands_are_refused_or_carried_out() {
    let mut random = Random::seeded(7);
    let replay = Replay::from_bytes(&recording(), &custom_forces()).expect("it is whole");
    let all: Vec<Vec<u8>> = commands().iter().map(Command::to_bytes).collect();
    let mut world = replay.start().clone();
    let mut carried_out = 0;
    for i in 0..tries(4_000) {
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
    assert!(carried_out > tries(4_000) / 20, "{carried_out}");
}
