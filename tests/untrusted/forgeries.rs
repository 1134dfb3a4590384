//! The bytes of a file changed in every way that breaks things, with its seals as they were and made new; and every length
//! and count in it a lie. What is refused is refused with an error; what is not goes on like any other.
//!
//! By day it is every 37th byte, by night each one.

use allocation_counter::measure;
use umbra_physics::{
    BodyDef, Command, Dump, Fx, Input, Inputs, PHYSICS_VERSION, RecordOptions, Recorder, Replay, ReplayError, Snapshot,
    World, WorldDef, vec2,
};
use umbra_scene::Scene;

use crate::seeds::is_short;
use crate::untrusted::everything::{commands, custom_forces, places, recording, world};
use crate::untrusted::memory::{ANY, bounded};
use crate::untrusted::seals::{DUMP_FORMAT, begin, chunk, chunks, reseal};

/// Hands on the bytes with one place changed, and puts them back: bits, bytes, and as a length or a count of 32 or 64 bits
/// none, one more, and far too many.
fn forge(bytes: &mut Vec<u8>, places: impl Iterator<Item = usize>, mut see: impl FnMut(usize, &mut Vec<u8>)) {
    let mut put = |bytes: &mut Vec<u8>, at: usize, new: &[u8]| {
        let Some(old) = bytes.get(at..at + new.len()).filter(|old| *old != new).map(<[u8]>::to_vec) else { return };
        let whole = bytes.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        see(at, bytes);
        bytes.clone_from(&whole);
        assert_eq!(bytes[at..at + old.len()], old);
    };
    for at in places {
        let byte = bytes[at];
        for new in [byte ^ 1, byte ^ 0x80, 0, 0xff] {
            put(bytes, at, &[new]);
        }
        if let Some(four) = bytes.get(at..at + 4) {
            let count = u32::from_le_bytes(four.try_into().expect("four"));
            for new in [0, count.wrapping_add(1), 1 << 31, u32::MAX] {
                put(bytes, at, &new.to_le_bytes());
            }
        }
        put(bytes, at, &(1u64 << 63).to_le_bytes());
    }
}

/// A world that was accepted: it is written to the bytes it was read from, and so is what it steps to, at the last tick too.
fn goes_on(snapshot: Snapshot, bytes: &[u8]) {
    assert_eq!(snapshot.to_bytes(), bytes);
    let mut world = snapshot.into_world();
    for _ in 0..2 {
        world.step();
        let bytes = world.snapshot().to_bytes();
        let again = Snapshot::from_bytes(&bytes, &custom_forces()).expect("a step leads to a world");
        assert_eq!((again.world().state_hash(), again.to_bytes()), (world.state_hash(), bytes));
    }
}

#[test]
fn snapshots() {
    let mut whole = world().snapshot().to_bytes();
    let (mut accepted, mut refused) = (0, 0);
    let places = places(whole.len());
    forge(&mut whole, places, |at, changed| {
        let read = |file: &[u8]| Snapshot::from_bytes(file, &custom_forces());
        assert!(bounded("a changed snapshot", changed, read).is_err(), "byte {at}");
        reseal(changed);
        match bounded("a forged snapshot", changed, read) {
            Ok(snapshot) => {
                goes_on(snapshot, changed);
                accepted += 1;
            }
            Err(error) => {
                assert!((301..=307).contains(&error.code()) && !error.to_string().contains('\n'), "{error}");
                refused += 1;
            }
        }
    });
    assert!(accepted > 150 && refused > 300, "{accepted}, {refused}");
}

#[test]
fn every_command() {
    let (mut accepted, mut refused, start) = (0, 0, world());
    for command in commands() {
        let mut whole = command.to_bytes();
        for end in 0..whole.len() {
            let cut = bounded("a cut command", &whole[..end], |file| Command::<Fx>::from_bytes(file).map(drop));
            assert!(cut.is_err_and(|error| error.at <= end as u64), "{command:?} cut at {end}");
        }
        let places = places(whole.len());
        forge(&mut whole, places, |_, changed| match bounded("a forged command", changed, Command::from_bytes) {
            Ok(command) => {
                assert_eq!(command.to_bytes(), *changed, "{command:?}");
                let checked = start.check(&command);
                if accepted % 8 == 0 {
                    let mut world = start.clone();
                    assert_eq!(checked.err(), world.execute(&command).err());
                    world.step();
                }
                accepted += 1;
            }
            Err(error) => {
                assert!(error.at <= changed.len() as u64, "{error}");
                refused += 1;
            }
        });
        whole.push(0);
        assert!(Command::<Fx>::from_bytes(&whole).is_err(), "{command:?} and more");
    }
    assert!(accepted > 150 && refused > 60, "{accepted}, {refused}");
}

#[test]
fn every_input_of_a_tick() {
    let mut inputs = Inputs::new();
    for (place, command) in commands().into_iter().enumerate() {
        let (player, sequence) = (place as u32 / 3, place as u32 % 3);
        inputs.insert(Input { player, sequence, command }).expect("each place once");
    }
    let mut whole = inputs.to_bytes();
    assert_eq!(Inputs::from_bytes(&whole).as_ref(), Ok(&inputs));
    for end in places(whole.len()) {
        assert!(Inputs::from_bytes(&whole[..end]).is_err(), "cut at {end}");
    }
    let (mut accepted, mut refused, places) = (0, 0, places(whole.len()));
    forge(&mut whole, places, |_, changed| match bounded("forged inputs", changed, Inputs::from_bytes) {
        Ok(inputs) => {
            assert_eq!(inputs.to_bytes(), *changed);
            assert!(inputs.iter().map(|input| (input.player, input.sequence)).is_sorted_by(|a, b| a < b));
            accepted += 1;
        }
        Err(error) => {
            assert!(error.at <= changed.len() as u64, "{error}");
            refused += 1;
        }
    });
    assert!(accepted > 150 && refused > 60, "{accepted}, {refused}");
    // The shortest inputs take most memory for their bytes.
    let shortest: Vec<u8> =
        (0..100_000u32).flat_map(|player| [&player.to_le_bytes()[..], &[0; 4], &[27]].concat()).collect();
    let whole = [&100_000u32.to_le_bytes()[..], &shortest].concat();
    let mut read = Inputs::new();
    let bytes_max = measure(|| read = Inputs::from_bytes(&whole).expect("commands that clear forces")).bytes_max;
    assert_eq!(read.len(), 100_000);
    assert!(bytes_max <= 40 * whole.len() as u64 + (64 << 10), "{bytes_max} bytes for {}", whole.len());
    // Given twice, or out of order.
    for player in [0, 1] {
        let mut bytes = [&2u32.to_le_bytes()[..], &shortest[..18]].concat();
        bytes[4] = 1;
        bytes[13] = player;
        assert_eq!(Inputs::from_bytes(&bytes).map(drop).map_err(|error| error.at), Err(13));
    }
}

type Chunks = Vec<([u8; 4], Vec<u8>)>;

fn file(magic: &[u8; 8], chunks: &Chunks) -> Vec<u8> {
    let mut file = begin(magic);
    chunks.iter().for_each(|(tag, contents)| chunk(&mut file, tag, contents));
    file
}

/// Files of these chunks, with one in `step_by` bytes of one forged, or one left out, twice there or in the place of the next.
fn forge_chunks(magic: &[u8; 8], whole: &Chunks, skip: [u8; 4], step_by: usize, mut see: impl FnMut(&[u8])) {
    // Of a replay by day a quarter of the ticks, wherever snapshots stand between them.
    let ticks_before = |number: usize| whole[..number].iter().filter(|(tag, _)| tag == b"TICK").count();
    let is_taken = |number: &usize| step_by < 37 || whole[*number].0 != *b"TICK" || ticks_before(*number) % 4 == 0;
    for number in (0..whole.len()).filter(is_taken) {
        let [mut less, mut more, mut swapped] = [(); 3].map(|()| whole.clone());
        let taken = less.remove(number);
        more.insert(number, taken);
        swapped.swap(number, (number + 1) % whole.len());
        [less, more, swapped].iter().for_each(|chunks| see(&file(magic, chunks)));
        // A snapshot by itself is looked at above; here only what stands before it.
        let (tag, contents) = &whole[number];
        let length = if *tag == skip { contents.len().min(24) } else { contents.len() };
        let mut chunks = whole.clone();
        forge(&mut contents.clone(), (0..length).step_by(step_by), |_, changed| {
            chunks[number].1.clone_from(changed);
            see(&file(magic, &chunks));
        });
        for letter in 0..4 {
            let mut chunks = whole.clone();
            chunks[number].0[letter] ^= 0x20;
            see(&file(magic, &chunks));
        }
    }
}

#[test]
fn replays() {
    let whole = chunks(&recording());
    let read = |file: &[u8]| Replay::from_bytes(file, &custom_forces());
    assert_eq!(read(&file(b"UMBRAREP", &whole)).expect("it is whole").verify(), Ok(()));
    let (mut as_recorded, mut diverged, mut refused) = (0, 0, 0);
    forge_chunks(b"UMBRAREP", &whole, *b"SNAP", if is_short() { 37 } else { 1 }, |file| {
        match bounded("a forged replay", file, read) {
            Ok(replay) => {
                assert_eq!(replay.to_bytes(), file);
                match replay.verify() {
                    Ok(()) => as_recorded += 1,
                    Err(divergence) => {
                        assert_ne!(divergence.recorded, divergence.computed);
                        diverged += 1;
                    }
                }
            }
            Err(error) => {
                assert!((401..=407).contains(&error.code()) && !error.to_string().contains('\n'), "{error}");
                assert!(!matches!(error, ReplayError::Tampered(_)), "the seals are right: {error}");
                refused += 1;
            }
        }
    });
    // Those that go as recorded say something else of who sent a command, or of what is overwritten in that tick.
    assert!(as_recorded > 20 && diverged > 700 && refused > 300, "{as_recorded}, {diverged}, {refused}");
}

#[test]
fn dumps() {
    let mut before = World::new(WorldDef::default()).expect("a world");
    let body = before.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }).expect("a body");
    let calls = [Command::SetVelocity { body, velocity: vec2(0, 1) }, Command::SetBlob(vec![1, 2, 3])];
    let mut after = before.clone();
    calls.iter().for_each(|call| assert!(after.execute(call).is_ok()));
    after.step();
    let dump = Dump::of_tick(&before, &calls, &Inputs::new(), &after);
    let mut whole = dump.to_bytes();
    let read = |file: &[u8]| Dump::from_bytes(file, &[]);
    for end in 0..whole.len() {
        assert!(bounded("a cut dump", &whole[..end], read).is_err(), "cut at {end}");
    }
    let places = places(whole.len());
    forge(&mut whole, places, |at, changed| {
        let error = bounded("a changed dump", changed, read).expect_err("it was changed");
        assert!(matches!(error.code(), 401 | 402 | 404 | 405 | 406), "byte {at}: {error}");
    });
    whole.push(0);
    assert_eq!(read(&whole).expect_err("there is more").code(), 406);
    whole.pop();

    let parts = chunks(&whole);
    let (mut accepted, mut refused) = (0, 0);
    forge_chunks(b"UMBRADMP", &parts, *b"PHAS", if is_short() { 5 } else { 1 }, |file| {
        match bounded("a forged dump", file, read) {
            Ok(forged) => {
                assert_eq!(forged.to_bytes(), file);
                // Nothing but what was done can be another without a world that is.
                let phase = forged.first_difference(&dump).map(|finding| finding.phase.to_string());
                assert!(matches!(phase.as_deref(), None | Some("calls" | "inputs")), "{phase:?}");
                accepted += 1;
            }
            Err(error) => {
                assert!((401..=407).contains(&error.code()), "{error}");
                refused += 1;
            }
        }
    });
    assert!(accepted > 4 && refused > 100, "{accepted}, {refused}");
    // Another tick than that of its worlds, and another end.
    for (tag, at) in [(*b"TICK", 0), (*b"DONE", 0), (*b"DONE", 8)] {
        let mut changed = parts.clone();
        let part = changed.iter_mut().find(|part| part.0 == tag).expect("it has one");
        part.1[at] ^= 1;
        assert_eq!(read(&file(b"UMBRADMP", &changed)).expect_err("it is of another tick").code(), 406);
    }
    // Of times to come.
    let mut format = whole.clone();
    format[8] = DUMP_FORMAT as u8 + 1;
    assert_eq!(read(&format).err(), Some(ReplayError::Format { found: DUMP_FORMAT + 1, known: DUMP_FORMAT }));
    let mut version = parts;
    version[0].1 = (PHYSICS_VERSION + 1).to_le_bytes().to_vec();
    assert_eq!(
        read(&file(b"UMBRADMP", &version)).err(),
        Some(ReplayError::PhysicsVersion { found: PHYSICS_VERSION + 1, own: PHYSICS_VERSION })
    );
}

#[test]
fn a_seal_that_is_right_for_what_was_never_recorded_takes_no_more() {
    // A whole file of one byte again and again, as the contents of each chunk.
    for byte in [0, 1, 0xff] {
        for tag in [b"HEAD", b"SNAP", b"TICK", b"DONE"] {
            let mut parts = chunks(&Recorder::new(&world(), RecordOptions::default()).finish(&world()));
            let at = parts.iter().position(|(chunk_tag, _)| chunk_tag == tag).unwrap_or(2);
            parts[at] = (*tag, vec![byte; 100_000]);
            let file = file(b"UMBRAREP", &parts);
            assert!(bounded("a chunk of one byte", &file, |file| Replay::from_bytes(file, &custom_forces())).is_err());
        }
    }
}

#[test]
fn scenes() {
    let text = include_str!("../../scenes/pendulum.json");
    assert!(text.is_ascii() && Scene::parse(text).is_ok());
    let parse = |text: &str| {
        const MOST: u32 = 100;
        let mut read = None;
        let taken = allocation_counter::measure(|| read = Some(Scene::parse_within(text, MOST))).bytes_max;
        let bound = 8 * (text.len() as u64 + 512 * u64::from(MOST)) + 4_096 * 3 * u64::from(MOST) + ANY;
        assert!(taken <= bound, "{taken} bytes for {text}");
        let read = read.expect("it was read");
        for error in read.as_ref().err().iter().flat_map(|errors| errors.errors()) {
            let line = error.place.line;
            assert!(line >= 1 && line <= text.split('\n').count(), "line {line}: {error}");
            assert!(!error.to_string().contains('\n') && error.code() > 100, "{error}");
        }
        read.is_ok()
    };
    let (mut accepted, mut refused) = (0, 0);
    for at in places(text.len()) {
        assert!(!parse(&text[..at]) || text[at..].trim().is_empty(), "cut at {at}");
        for put in ["", "0", "9", "-", "e", "\"", "{", "}", "[", "]", ",", "\\", "\n", "\u{1F600}"] {
            let forged = [&text[..at], put, &text[at + 1..]].concat();
            *(if parse(&forged) { &mut accepted } else { &mut refused }) += 1;
        }
    }
    assert!(accepted > 30 && refused > 150, "{accepted}, {refused}");
}
