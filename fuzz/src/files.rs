//! Forged files with valid seals, so that the values behind the seals are reached.

use arbitrary::{Result, Unstructured};
use umbra_physics::{PHYSICS_VERSION, Random, Snapshot, SnapshotError, World, WorldDef, limits};
use xxhash_rust::xxh3::xxh3_64;

use super::author;
use super::tally;

/// The number of bytes of a snapshot before its state: magic, format, physics version.
pub const HEAD: usize = 16;

/// The first bytes of a snapshot of this build.
pub fn head() -> Vec<u8> {
    let world = World::new(WorldDef::default()).expect("a fair definition");
    world.snapshot().to_bytes()[..HEAD].to_vec()
}

/// Gives a snapshot the hash of its world, if it has one, and the seal of its bytes.
pub fn seal_snapshot(bytes: &mut [u8]) {
    let Some(end) = bytes.len().checked_sub(16).filter(|end| *end >= HEAD) else { return };
    if let Err(SnapshotError::Changed { computed, .. }) = Snapshot::from_bytes(bytes, &author::custom_forces()) {
        bytes[end..end + 8].copy_from_slice(&computed.to_le_bytes());
    }
    let seal = xxh3_64(&bytes[..end + 8]);
    bytes[end + 8..].copy_from_slice(&seal.to_le_bytes());
}

/// Sets the tick of a snapshot.
pub fn put_tick(bytes: &mut [u8], tick: u64) {
    // It comes after the settings, which end with an option and the settings of contacts.
    let sleep_after = HEAD + 41;
    let at = sleep_after + if bytes[sleep_after] == 1 { 5 } else { 1 } + 44;
    bytes[at..at + 8].copy_from_slice(&tick.to_le_bytes());
}

/// The smallest first byte of an input for a world at one of the last ticks.
pub const LATE: u8 = 224;

/// The bit of the first byte of an input for a world with a pile.
pub const PILED: u8 = 32;

/// A copy of a world at one of the last ticks.
pub fn late(world: &World, before: u8) -> World {
    let mut bytes = world.snapshot().to_bytes();
    put_tick(&mut bytes, limits::TICK - u64::from(before % 16));
    seal_snapshot(&mut bytes);
    Snapshot::from_bytes(&bytes, &author::custom_forces()).expect("a world like any other").into_world()
}

/// A chunk of a replay or a dump: its letters and its contents.
#[derive(Clone, Debug)]
pub struct Chunk {
    pub tag: [u8; 4],
    pub bytes: Vec<u8>,
}

/// The number of bytes before the chunks: the kind of the file, and the number of its format.
pub const OPENING: usize = 12;
/// The numbers of bytes around the contents of a chunk: its word twice before; a hash and two sums after.
const BEFORE: usize = 16;
const AFTER: usize = 40;

/// The chunks of a file that is whole.
pub fn chunks(file: &[u8]) -> Vec<Chunk> {
    let (mut chunks, mut rest) = (Vec::new(), &file[OPENING..]);
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[4..8].try_into().expect("four bytes")) as usize;
        let tag = rest[..4].try_into().expect("four bytes");
        chunks.push(Chunk { tag, bytes: rest[BEFORE..BEFORE + length].to_vec() });
        rest = &rest[BEFORE + length + AFTER..];
    }
    chunks
}

/// A file of these chunks with valid seals, of the chunks and of the snapshots in them, and the physics version of this
/// build.
pub fn sealed(opening: &[u8], chunks: &[Chunk]) -> Vec<u8> {
    let mut file = opening.to_vec();
    for Chunk { tag, bytes } in chunks {
        let mut bytes = bytes.clone();
        match tag {
            b"HEAD" | b"PHYS" if bytes.len() >= 4 => bytes[..4].copy_from_slice(&PHYSICS_VERSION.to_le_bytes()),
            b"SNAP" => seal_snapshot(&mut bytes),
            b"PHAS" => {
                // A stage is five bytes more. Then whether there is a world, and the world.
                let before = if bytes.first() == Some(&3) { 7 } else { 2 };
                if let Some(world) = bytes.get_mut(before..) {
                    seal_snapshot(world);
                }
            }
            _ => {}
        }
        let word = [*tag, (bytes.len() as u32).to_le_bytes()].concat();
        let (mut sum, mut weighted) = (0u128, 0u128);
        for (k, part) in (1u128..).zip(bytes.chunks(8)) {
            let mut value = [0; 8];
            value[..part.len()].copy_from_slice(part);
            let value = u128::from(u64::from_le_bytes(value));
            sum += value;
            weighted += k * value;
        }
        file.extend_from_slice(&word);
        file.extend(word.iter().map(|byte| !byte));
        file.extend_from_slice(&bytes);
        file.extend_from_slice(&xxh3_64(&[&word[..], &bytes].concat()).to_le_bytes());
        file.extend_from_slice(&sum.to_le_bytes());
        file.extend_from_slice(&weighted.to_le_bytes());
    }
    file
}

/// Numbers at the ends of ranges.
const ODD: [u64; 9] = [0, 1, u64::MAX, i64::MAX as u64, 1 << 63, 1 << 32, u32::MAX as u64, 1 << 62, 1 << 52];

/// Changes a bit, a byte or a word; or removes, inserts or swaps some bytes.
pub fn disturb(bytes: &mut Vec<u8>, input: &mut Unstructured<'_>) -> Result<()> {
    let (kind, at) = (input.arbitrary::<u8>()?, usize::from(input.arbitrary::<u16>()?));
    if bytes.is_empty() {
        return Ok(());
    }
    let at = at % bytes.len();
    let end = bytes.len().min(at + 8);
    match kind % 8 {
        // Entries of lists: ids, handles, corners.
        1 if kind >> 6 == 0 => {
            let length = [4, 8, 12, 16][usize::from(kind >> 4)];
            if let Some(pair) = bytes.get_mut(at..at + 2 * length) {
                let (first, second) = pair.split_at_mut(length);
                first.swap_with_slice(second);
            }
        }
        0 | 1 => bytes[at] ^= 1 << (kind >> 5),
        2 => bytes[at] = input.arbitrary()?,
        3 | 4 => {
            let value = ODD[usize::from(kind >> 3) % ODD.len()].wrapping_add(input.arbitrary::<u8>()? as i8 as u64);
            bytes[at..end].copy_from_slice(&value.to_le_bytes()[..end - at]);
        }
        5 => {
            let value: u64 = input.arbitrary()?;
            bytes[at..end].copy_from_slice(&value.to_le_bytes()[..end - at]);
        }
        6 => drop(bytes.drain(at..bytes.len().min(at + 1 + usize::from(kind >> 3)))),
        _ => {
            let more = bytes[at..bytes.len().min(at + 1 + usize::from(kind >> 3))].to_vec();
            bytes.splice(at..at, more);
        }
    }
    Ok(())
}

/// The memory that reading may take for each byte of a file, and for any file, as `docs/formats.md` promises.
const TIMES: u64 = 16;
pub const ANY: u64 = 1 << 16;

/// Reads a file or a command, and asserts that it takes no more memory than is promised.
pub fn measured<T>(bytes: &[u8], read: impl FnOnce() -> T) -> T {
    measured_within(TIMES, bytes, read)
}

/// Reads something, and asserts that it takes no more than so many bytes of memory a byte.
pub fn measured_within<T>(times: u64, bytes: &[u8], read: impl FnOnce() -> T) -> T {
    let (value, took) = taken(read);
    let max = times * bytes.len() as u64 + ANY;
    assert!(took <= max, "{took} of {max} bytes taken to read {}", bytes.len());
    value
}

/// Does something, and measures the most memory it takes, its result included.
pub fn taken<T>(act: impl FnOnce() -> T) -> (T, u64) {
    let mut value = None;
    let took = allocation_counter::measure(|| value = Some(act()));
    (value.expect("it was done"), took.bytes_max)
}

/// Asks a world for everything and does everything to it, for a few ticks.
pub fn use_up(mut world: World, seed: u64) {
    let mut random = Random::seeded(seed);
    let ids: Vec<_> = world.bodies().map(|body| body.id()).collect();
    for body in world.bodies() {
        _ = (body.rotation(), body.applied_force(), body.applied_torque(), body.mass(), body.inertia());
        _ = (body.position(), body.angle(), body.velocity(), body.angular_velocity());
        _ = format!("{} {} {}", body.position_exact().x, body.angle_exact(), body.angular_velocity_exact());
    }
    _ = (world.energy(), world.momentum(), world.angular_momentum(), world.elapsed(), world.physics_hash());
    if let Some(body) = ids.get(random.below(1 + ids.len() as u64) as usize) {
        world.preview(*body).expect("it is there").step();
    }
    let mut copy = world.clone();
    for tick in 0..2 {
        let applied = world.step().applied.to_vec();
        tally::count(&world);
        copy.step_traced();
        assert_eq!(copy.state_hash(), world.state_hash(), "a step looked into");
        let mut back = world.clone();
        if back.step_back(&applied).is_ok() {
            back.step();
        }
        assert_eq!(back.state_hash(), world.state_hash(), "there, back and there again");
        if tick == 0 {
            for &body in &ids {
                _ = match random.below(8) {
                    0 => world.release(body),
                    1 => world.remove_body(body),
                    _ => Ok(()),
                };
            }
            copy = world.clone();
        }
    }
    _ = format!("{:?}", world.last_report());
}
