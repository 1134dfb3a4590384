//! Any bytes as a snapshot: each is refused, or a world that goes on like any other.
//!
//! The first byte of an input says what the others are: a snapshot as it is; the state in a snapshot, to be sealed; or
//! commands that make a world, and changes of its bytes before they are sealed again.

use arbitrary::{Result, Unstructured};
use umbra_physics::{Activity, Fx, Snapshot, World, WorldDef, limits};

use super::author::{self, Author};
use super::files::{LATE, PILED, disturb, head, late, measured, seal_snapshot, use_up};
use super::pile::pile;
use super::{number, tally};

/// The target.
pub fn run(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    match kind % 4 {
        0 => look_and_use(rest),
        1 | 2 => {
            let mut bytes = head();
            bytes.extend_from_slice(rest);
            bytes.extend_from_slice(&[0; 16]);
            seal_snapshot(&mut bytes);
            look_and_use(&bytes);
        }
        _ => _ = forged(rest, *kind),
    }
}

/// The most ticks of a pile before its world is written, and commands, of most inputs and of one in 16.
const TICKS: [u8; 2] = [6, 20];
const COMMANDS: [u8; 2] = [6, 24];

/// A world of a few bodies and fields, or of a pile.
fn made(author: &mut Author<'_>, kind: u8) -> Result<World> {
    let world = author::world(author.world()).or_else(|| author::world(WorldDef::default()));
    let mut world = world.expect("the usual definition is fair");
    if kind & PILED != 0 {
        pile(author, &mut world)?;
        for _ in 0..number(author.any()?, TICKS[0], TICKS[1]) {
            world.step();
            tally::count(&world);
        }
    }
    for _ in 1..number(author.any()?, COMMANDS[0], COMMANDS[1]) {
        let command = author.command();
        if let Ok(created) = world.execute(&command) {
            author.made(&world, created);
        }
        for _ in 0..(author.any::<u8>()? & 0xf).saturating_sub(13) {
            world.step();
        }
    }
    Ok(world)
}

fn forged(data: &[u8], kind: u8) -> Result<()> {
    let mut author = Author::new(data);
    let world = made(&mut author, kind)?;
    let mut bytes = if kind >= LATE { late(&world, kind) } else { world }.snapshot().to_bytes();
    let state = look(&bytes).expect("its own bytes");
    let input: &mut Unstructured<'_> = &mut author.input;
    let mut changed = None;
    if !input.is_empty() {
        while !input.is_empty() {
            disturb(&mut bytes, input)?;
        }
        seal_snapshot(&mut bytes);
        changed = look(&bytes);
    }
    use_up(changed.unwrap_or(state), bytes.len() as u64);
    Ok(())
}

fn look_and_use(bytes: &[u8]) {
    look(bytes).into_iter().for_each(|world| use_up(world, bytes.len() as u64));
}

/// Asserts that bodies are where every call and every step leaves them. A quarantined one may be beyond.
fn assert_in_range(world: &World) {
    for body in world.bodies().filter(|body| body.activity() != Activity::Quarantined) {
        let (position, velocity, turns) = (body.position(), body.velocity(), body.angular_velocity());
        let values = [position.x, position.y, velocity.x, velocity.y, turns];
        let bounds = [limits::POSITION, limits::POSITION, limits::SPEED, limits::SPEED, limits::ANGULAR_SPEED];
        let is_within = |(value, bound): (&Fx, Fx)| -bound <= *value && *value <= bound;
        assert!(values.iter().zip(bounds).all(is_within), "{:?} is out of range", body.id());
    }
}

/// Reads a snapshot, and returns its world a step later.
fn look(bytes: &[u8]) -> Option<World> {
    let snapshot = measured(bytes, || Snapshot::from_bytes(bytes, &author::custom_forces())).ok()?;
    assert_eq!(snapshot.to_bytes(), bytes, "what is read is written alike");
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    world.restore(&snapshot);
    assert_eq!(world.state_hash(), snapshot.world().state_hash());
    assert_in_range(&world);
    world.step();
    tally::count(&world);
    let mut twin = snapshot.into_world();
    twin.step();
    assert_eq!(world.state_hash(), twin.state_hash(), "two that were read alike");
    let stepped = world.snapshot().to_bytes();
    let again = Snapshot::from_bytes(&stepped, &author::custom_forces()).expect("a step leads to a world");
    assert_eq!((again.to_bytes(), again.world().state_hash()), (stepped, world.state_hash()));
    Some(world)
}
