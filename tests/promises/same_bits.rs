//! P1: the same bits, however a run is done: again, from a copy, as a file, as a scene, on more threads. Other machines and
//! builds have the corpus (`selftest`).

use umbra_oracles::{Oracle, Script};
use umbra_physics::{Command, Fx};
use umbra_scene::Scene;

use crate::promises::check::{Verdict, check, judge};
use crate::promises::plan::{FAIR, Taste};

/// The hash of the state after each tick.
fn hashes(script: &Script) -> Result<Vec<u64>, String> {
    let mut world = script.start().map_err(|error| error.to_string())?;
    let tick = |_| {
        script.advance(&mut world, &mut ());
        world.state_hash()
    };
    Ok((0..script.ticks).map(tick).collect())
}

fn is_the_same_as_a_scene(script: &Script) -> Verdict {
    let mut script = script.clone();
    // No scene has joints so far.
    script.commands.retain(|(_, command)| !matches!(command, Command::AddJoint(_)));
    let script = &script;
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

const TASTE: Taste = Taste { near: 3, unfair: 2, ..FAIR };

#[test]
fn a_run_is_the_same_again_and_from_any_tick_on() {
    judge("same-bits", 40, TASTE.plan(), Oracle::Repeat);
    judge("same-bits", 40, TASTE.plan(), Oracle::Restore);
}

#[test]
fn a_run_that_was_recorded_is_played_to_the_same_states() {
    judge("same-bits", 40, TASTE.plan(), Oracle::Record);
}

#[cfg(feature = "parallel")]
#[test]
fn a_run_is_the_same_on_one_thread_and_on_two() {
    // Each with thousands of bystanders.
    judge("same-bits", 5, TASTE.plan(), Oracle::Threads);
}

#[test]
fn a_run_is_the_same_as_a_scene() {
    check("same-bits-scene", 100, TASTE.plan(), is_the_same_as_a_scene);
}
