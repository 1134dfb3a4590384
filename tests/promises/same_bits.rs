//! P1: the same bits, however a run is done: again, as a file, as a scene.

use umbra_physics::oracle::Script;
use umbra_physics::scene::Scene;
use umbra_physics::{Fx, Replay};

use crate::check::{Verdict, check};
use crate::plan::{FAIR, Taste};

/// The hash of the state after each tick.
fn hashes(script: &Script) -> Result<Vec<u64>, String> {
    let mut world = script.start().map_err(|error| error.to_string())?;
    let tick = |_| {
        script.advance(&mut world, &mut ());
        world.state_hash()
    };
    Ok((0..script.ticks).map(tick).collect())
}

fn verifies_as_a_file(script: &Script) -> Verdict {
    let file = script.record().map_err(|error| error.to_string())?;
    let replay = Replay::from_bytes(&file, &[]).map_err(|error| error.to_string())?;
    let verdict = replay.verify();
    if (replay.end(), &verdict) == (script.ticks, &Ok(())) {
        return Ok(());
    }
    Err(format!("{} ticks of {}: {verdict:?}", replay.end(), script.ticks))
}

fn is_the_same_as_a_scene(script: &Script) -> Verdict {
    let scene = Scene::from_commands(script.world, &script.commands, script.ticks);
    let text = scene.map_err(|why| why.to_string())?.to_json();
    let scene = Scene::parse(&text).map_err(|error| format!("{error}\n{text}"))?;
    let mut run = scene.start::<Fx>().map_err(|error| error.to_string())?;
    for (tick, wanted) in hashes(script)?.into_iter().enumerate() {
        run.advance().map_err(|error| error.to_string())?;
        if run.world().state_hash() != wanted {
            return Err(format!("the scene parts at tick {tick}"));
        }
    }
    Ok(())
}

#[test]
fn a_run_that_was_recorded_is_verified() {
    check("replay", 400, Taste { near: 3, unfair: 2, ..FAIR }.plan(), verifies_as_a_file);
}

#[test]
fn a_run_is_the_same_as_a_scene() {
    check("scene", 1_000, Taste { near: 3, unfair: 3, ..FAIR }.plan(), is_the_same_as_a_scene);
}
