//! Any bytes as a replay, a dump or a command: each is refused, or played.
//!
//! The first byte of an input says what the others are: a file as it is; the chunks of a file, to be sealed; a run to be
//! recorded, or a tick to be dumped, and changes of the file before it is sealed again; a command.

use arbitrary::{Result, Unstructured};
use umbra_physics::{
    Command, Divergence, Dump, Input, Inputs, RecordOptions, Recorder, Replay, ReplayError, ReplayLimits, VerifyError,
    World, WorldDef,
};

use super::author::{self, Author};
use super::files::{
    Chunk, LATE, OPENING, PILED, chunks, disturb, late, measured, measured_within, seal_snapshot, sealed, use_up,
};
use super::pile::pile;
use super::{number, tally};

/// The target.
pub fn run(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    _ = match kind % 8 {
        0 => {
            look(rest);
            look_at_dump(rest);
            Ok(())
        }
        1 | 2 => from_chunks(rest),
        3 | 4 => recorded(rest, *kind),
        5 | 6 => dumped(rest, *kind),
        _ if *kind >= 128 => forged_command(rest),
        _ => {
            look_at_command(rest);
            Ok(())
        }
    };
}

/// Reads a file, and plays it or the part that can be recovered.
fn look(bytes: &[u8]) {
    let whole = measured(bytes, || Replay::from_bytes(bytes, &author::custom_forces()));
    let rest = Replay::recovered(bytes, &author::custom_forces());
    match (&whole, &rest) {
        (Ok(whole), Ok(rest)) => {
            assert!(rest.is_complete());
            assert!(whole.to_bytes() == bytes && rest.to_bytes() == bytes, "what is read is written alike");
        }
        (Err(ReplayError::CutOff { .. }), Ok(rest)) => {
            assert!(!rest.is_complete());
            assert!(bytes.starts_with(&rest.to_bytes()), "what is whole is written alike");
        }
        // The file is cut off before its first world.
        (Err(ReplayError::CutOff { .. }), Err(ReplayError::CutOff { .. })) => {}
        (Err(error), Err(same)) => assert_eq!(error, same),
        (whole, rest) => panic!("{whole:?}, {rest:?}"),
    }
    let Ok(replay) = rest else {
        _ = whole.map_err(|error| error.to_string());
        return;
    };
    let verified = replay.verify();
    _ = verified.as_ref().map_err(|divergence| divergence.to_string());
    // Within limits the result is the same, or a limit is exceeded.
    let few = ReplayLimits {
        ticks: u64::MAX,
        bodies: 3,
        fields: 2,
        colliders: u32::MAX,
        pairs: u32::MAX,
        commands: u64::MAX,
    };
    match (replay.verify_within(few), &verified) {
        (Ok(()), verified) => assert_eq!(verified, &Ok(())),
        (Err(VerifyError::Divergence(played)), Err(divergence)) => {
            let hashes = |divergence: &Divergence| (divergence.tick, divergence.recorded, divergence.computed);
            assert_eq!(hashes(&played), hashes(divergence));
        }
        (Err(VerifyError::Divergence(divergence)), Ok(())) => panic!("{divergence}"),
        (Err(_), _) => {}
    }
    assert_eq!(replay.first_difference(&replay), None);
    let (start, end) = (replay.start().tick(), replay.end());
    let mut playback = replay.play();
    for tick in [start, start + (end - start) / 2, end, u64::MAX, 0] {
        playback.seek(tick);
        assert_eq!(playback.world().tick(), tick.clamp(start, end));
        let recorded = playback.recorded_hash();
        if verified.is_ok() {
            assert!(recorded.is_none_or(|hash| hash == playback.world().state_hash()), "another way to tick {tick}");
        }
    }
    playback.seek(end);
    use_up(playback.world().clone(), bytes.len() as u64);
}

fn look_at_dump(bytes: &[u8]) {
    let Ok(dump) = measured(bytes, || Dump::from_bytes(bytes, &author::custom_forces())) else { return };
    assert_eq!(dump.to_bytes(), bytes, "what is read is written alike");
    assert_eq!(dump.first_difference(&dump), None);
    for (_, world) in dump.phases() {
        let mut world = world.clone();
        world.step();
    }
}

fn look_at_command(bytes: &[u8]) {
    // As `Inputs::from_bytes` promises.
    if let Ok(inputs) = measured_within(40, bytes, || Inputs::from_bytes(bytes)) {
        assert_eq!(inputs.to_bytes(), bytes, "what is read is written alike");
    }
    let Ok(command) = measured(bytes, || Command::from_bytes(bytes)) else { return };
    assert_eq!(command.to_bytes(), bytes, "what is read is written alike");
    let mut world = author::world(WorldDef::default()).expect("a fair definition");
    for _ in 0..2 {
        let (before, foreseen) = (world.state_hash(), world.check(&command));
        let done = world.execute(&command);
        assert_eq!(done.err(), foreseen.err());
        assert!(done.is_ok() || world.state_hash() == before);
        world.step();
    }
}

/// A command by the author, with changes.
fn forged_command(data: &[u8]) -> Result<()> {
    let mut author = Author::new(data);
    let mut bytes = author.command().to_bytes();
    look_at_command(&bytes);
    while !author.input.is_empty() {
        disturb(&mut bytes, &mut author.input)?;
        look_at_command(&bytes);
    }
    Ok(())
}

const REPLAY: [&[u8; 4]; 4] = [b"HEAD", b"SNAP", b"TICK", b"DONE"];
const DUMP: [&[u8; 4]; 4] = [b"PHYS", b"TICK", b"PHAS", b"DONE"];

/// The start of a dump or of a replay, as this build writes them.
fn opening(is_dump: bool) -> Vec<u8> {
    let world = World::new(WorldDef::default()).expect("a world");
    let mut file = if is_dump {
        let mut after = world.clone();
        after.step();
        Dump::of_tick(&world, &[], &Inputs::new(), &after).to_bytes()
    } else {
        Recorder::new(&world, RecordOptions::default()).finish(&world)
    };
    file.truncate(OPENING);
    file
}

/// Reads chunks: a byte for the letters, two for the length, and the contents.
fn from_chunks(data: &[u8]) -> Result<()> {
    let mut input = Unstructured::new(data);
    let is_dump: bool = input.arbitrary()?;
    let mut parts = Vec::new();
    while !input.is_empty() {
        let number: u8 = input.arbitrary()?;
        let length = usize::from(input.arbitrary::<u16>()?).min(input.len());
        let tag = *(if is_dump { DUMP } else { REPLAY })[usize::from(number % 4)];
        parts.push(Chunk { tag, bytes: input.bytes(length)?.to_vec() });
    }
    let file = sealed(&opening(is_dump), &parts);
    if is_dump {
        look_at_dump(&file);
    } else {
        look(&file);
    }
    Ok(())
}

/// The most ticks for which a pile falls together before it is recorded or dumped, and those of its run, of most inputs and of one
/// in 16.
const FALL: [u8; 2] = [4, 16];
const TICKS: [u8; 2] = [4, 16];

/// A world made by the author.
fn start(author: &mut Author<'_>, kind: u8) -> Result<World> {
    let world = author::world(author.world()).or_else(|| author::world(WorldDef::default()));
    let mut world = world.expect("the usual definition is fair");
    if kind & PILED != 0 {
        pile(author, &mut world)?;
        for _ in 0..number(author.any()?, FALL[0], FALL[1]) {
            world.step();
            tally::count(&world);
        }
    }
    for _ in 0..author.any::<u8>()? % 8 {
        let command = author.command();
        world.execute(&command).into_iter().for_each(|created| author.made(&world, created));
    }
    Ok(if kind >= LATE { late(&world, kind) } else { world })
}

/// Inputs of some players, in the order they arrive in.
fn inputs(author: &mut Author<'_>) -> Result<Inputs> {
    let mut inputs = Inputs::new();
    for sequence in 0..u32::from(author.any::<u8>()? % 4) {
        let player = u32::from(author.any::<u8>()? % 3);
        let command = author.command();
        inputs.insert(Input { player, sequence, command }).expect("each sequence comes once");
    }
    Ok(inputs)
}

fn recorded(data: &[u8], kind: u8) -> Result<()> {
    let mut author = Author::new(data);
    let mut world = start(&mut author, kind)?;
    let options = RecordOptions {
        hash_every: 1 + u32::from(author.any::<u8>()? % 3),
        snapshot_every: u32::from(author.any::<u8>()? % 4),
    };
    let mut recorder = Recorder::new(&world, options);
    let ticks = number(author.any()?, TICKS[0], TICKS[1]) - usize::from(kind & PILED == 0);
    let mut calls = Vec::new();
    for _ in 0..ticks {
        if author.any()? {
            let command = author.command();
            let created = recorder.execute(&mut world, &command);
            created.into_iter().for_each(|created| author.made(&world, created));
            calls.push(command);
        }
        let inputs = inputs(&mut author)?;
        recorder.step(&mut world, &inputs);
        tally::count(&world);
        let results = recorder.outcomes().iter().filter_map(|outcome| outcome.result.ok());
        results.for_each(|created| author.made(&world, created));
    }
    let file = recorder.clone().finish(&world);
    // Calls after the last step belong to no tick, and leave no trace.
    let mut later = world.clone();
    calls.iter().for_each(|call| _ = recorder.execute(&mut later, call));
    assert!(recorder.finish(&later) == file, "calls after the last step");
    let replay = Replay::from_bytes(&file, &author::custom_forces()).expect("it is whole");
    assert!(replay.verify() == Ok(()) && replay.to_bytes() == file);
    let mut playback = replay.play();
    playback.seek(u64::MAX);
    assert_eq!(playback.world().state_hash(), world.state_hash());
    if author.input.is_empty() {
        return Ok(());
    }
    // The file is changed as it is, then in its chunks, which are sealed again.
    let mut torn = file.clone();
    disturb(&mut torn, &mut author.input)?;
    look(&torn);
    look(&sealed(&file[..OPENING], &changed(chunks(&file), &mut author.input)?));
    Ok(())
}

/// The chunks, some of them changed, repeated or left out.
fn changed(mut parts: Vec<Chunk>, input: &mut Unstructured<'_>) -> Result<Vec<Chunk>> {
    while !input.is_empty() {
        let (kind, number) = (input.arbitrary::<u8>()?, usize::from(input.arbitrary::<u8>()?));
        if parts.is_empty() {
            break;
        }
        let number = number % parts.len();
        match kind {
            0..16 => drop(parts.remove(number)),
            16..32 => parts.insert(number, parts[number].clone()),
            32..48 => parts.swap(number, kind as usize % number.max(1)),
            _ => {
                disturb(&mut parts[number].bytes, input)?;
                if parts[number].tag == *b"SNAP" {
                    // Sealed between changes too: the values of a world may depend on each other.
                    seal_snapshot(&mut parts[number].bytes);
                }
            }
        }
    }
    Ok(parts)
}

fn dumped(data: &[u8], kind: u8) -> Result<()> {
    let mut author = Author::new(data);
    let before = start(&mut author, kind)?;
    let calls = if author.any()? { vec![author.command()] } else { Vec::new() };
    let inputs = inputs(&mut author)?;
    let mut after = before.clone();
    calls.iter().for_each(|call| _ = after.execute(call));
    after.carry_out(&inputs);
    after.step();
    tally::count(&after);
    let dump = Dump::of_tick(&before, &calls, &inputs, &after);
    let file = dump.to_bytes();
    let read = Dump::from_bytes(&file, &author::custom_forces()).expect("it is whole");
    assert_eq!((read.to_bytes(), read.first_difference(&dump)), (file.clone(), None));
    if !author.input.is_empty() {
        let mut torn = file.clone();
        disturb(&mut torn, &mut author.input)?;
        look_at_dump(&torn);
        look_at_dump(&sealed(&file[..OPENING], &changed(chunks(&file), &mut author.input)?));
    }
    Ok(())
}
