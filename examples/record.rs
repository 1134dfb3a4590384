//! A match is recorded and verified. Then it is tampered with in three ways, and each time the change is found.
//!
//! ```sh
//! cargo run --release --example record              # writes the replay to a temporary folder
//! cargo run --release --example record -- FILE      # or into a file, for `umbra verify FILE` and `umbra view FILE`
//! ```

use std::error::Error;
use std::{env, fs};

use umbra_physics::{
    BodyDef, BodyId, Command, Fx, Input, Inputs, RecordOptions, Recorder, Replay, ReplayError, World, WorldDef, vec2,
};

const TICKS: u64 = 300;

fn main() -> Result<(), Box<dyn Error>> {
    let honest = play(|_, _| Ok(()))?;
    let file = env::args_os().nth(1).map_or_else(|| env::temp_dir().join("record.umbrarep"), Into::into);
    fs::write(&file, &honest)?;
    let replay = Replay::from_bytes(&honest, &[])?;
    replay.verify()?;
    println!("{}: {} bytes, {} ticks, as recorded", file.display(), honest.len(), replay.end());

    // A bit is changed in the file: each part of it has a checksum, which locates the value that was changed.
    let mut changed = honest.clone();
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    let Err(ReplayError::Tampered(difference)) = Replay::from_bytes(&changed, &[]) else {
        return Err("unnoticed".into());
    };
    println!("a bit changed in the file:   {difference}");

    // A player moves the ship by an ulp, bypassing the recorder. The file is intact, but its inputs do not
    // lead to its hashes.
    const CHEATED: u64 = 123;
    let cheat = play(|world, ship| {
        if world.tick() != CHEATED {
            return Ok(());
        }
        let at = world.body(ship)?.position();
        world.set_position(ship, vec2(at.x + Fx::DELTA, at.y))
    })?;
    let Err(divergence) = Replay::from_bytes(&cheat, &[])?.verify() else { return Err("unnoticed".into()) };
    println!("an ulp past the recorder:    {divergence}");
    assert_eq!(divergence.tick, CHEATED + 1); // the first hash with the ulp in it

    // The game crashes, or the file is cut off: the intact part can be played.
    let part = &honest[..middle];
    let Err(ReplayError::CutOff { tick }) = Replay::from_bytes(part, &[]) else { return Err("unnoticed".into()) };
    let recovered = Replay::recovered(part, &[])?;
    recovered.verify()?;
    println!("cut off in the middle:       whole up to tick {tick}, which can be verified");
    assert!(recovered.end() == tick && !recovered.is_complete());
    Ok(())
}

/// A match of one ship that is pushed about, with further changes before each tick; returns the file.
fn play(
    mut meddle: impl FnMut(&mut World, BodyId) -> Result<(), umbra_physics::Error>,
) -> Result<Vec<u8>, umbra_physics::Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    let ship = world.add_body(BodyDef::dynamic())?;
    // A snapshot a second: after a divergence the next one names the value that differs.
    let mut recorder = Recorder::new(&world, RecordOptions { snapshot_every: 60, ..RecordOptions::default() });
    for tick in 0..TICKS {
        meddle(&mut world, ship)?;
        let mut inputs = Inputs::new();
        if tick % 20 == 0 {
            let command = Command::SetVelocity { body: ship, velocity: vec2(tick as i32 / 20 - 7, 3) };
            inputs.insert(Input { player: 0, sequence: 0, command })?;
        }
        recorder.step(&mut world, &inputs);
    }
    Ok(recorder.finish(&world))
}
