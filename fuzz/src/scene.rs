//! Any text as a scene: refused at a line and a field, or run.

use umbra_physics::{Fx, RecordOptions, Recorder, Replay, Scalar};
use umbra_scene::{Scene, SceneError, SceneErrors};

use super::files::{ANY, taken};
use super::tally;

/// Largest number of things of a kind; a repetition makes that many in a few bytes.
const MOST: u32 = 64;
/// Ticks of a run.
const TICKS: u64 = 3;

/// The target.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let (scene, took) = taken(|| Scene::parse_within(text, MOST));
    assert!(took <= promised(text, scene.as_ref().ok()), "{took} bytes taken to read {}", text.len());
    let scene = match scene {
        Ok(scene) => scene,
        Err(errors) => {
            assert!((1..=SceneErrors::LISTED).contains(&errors.errors().len()));
            return errors.errors().iter().for_each(|error| assert_says_where(error, text));
        }
    };
    assert_eq!(Scene::parse_within(text, MOST).as_ref(), Ok(&scene), "read twice");
    play::<Fx>(&scene, text, 1);
    play::<Fx>(&scene, text, 2);
    play::<f64>(&scene, text, 1);
    recorded(&scene);
}

/// The memory that `Scene::parse_within` promises: for the text and for what repetitions would be, and for each thing, of which
/// there can have been all that may be where it was refused.
fn promised(text: &str, scene: Option<&Scene>) -> u64 {
    let max = u64::from(MOST);
    // A word may be written with escapes.
    let written = if text.contains("repeat") || text.contains('\\') { 512 * max } else { 0 };
    let things = scene.map_or(3 * max, |scene| (scene.bodies.len() + scene.fields.len() + scene.inputs.len()) as u64);
    8 * (text.len() as u64 + written) + 4_096 * things + ANY
}

fn assert_says_where(error: &SceneError, text: &str) {
    let said = error.to_string();
    assert!(!said.chars().any(char::is_control), "more than a line: {said:?}");
    let lines = 1 + text.bytes().filter(|byte| *byte == b'\n').count();
    assert!((1..=lines).contains(&error.place.line), "{said}: of {lines} lines");
    assert!(!error.message.is_empty());
    // Of the text as a whole it is said that it is no JSON, no object, or lacks or has a field.
    let field = &error.place.field;
    assert!(field.len() <= 400, "{said}");
}

/// Runs it, and what it refuses by then it refuses alike once more.
fn play<S: Scalar>(scene: &Scene, text: &str, steps: u32) {
    let ways = [0, 1].map(|_| {
        let mut run = scene.start_finer::<S>(steps)?;
        for _ in 0..TICKS.min(scene.ticks) {
            run.advance()?;
            tally::count(run.world());
        }
        Ok(run.world().state_hash())
    });
    let [first, second] = ways;
    if let Err(error) = &first {
        assert_says_where(error, text);
        assert!(!error.place.field.is_empty() || steps > 1, "{error}");
    }
    assert_eq!(first, second);
}

/// The run in a replay is the run.
fn recorded(scene: &Scene) {
    let Ok(mut run) = scene.start::<Fx>() else { return };
    let mut recorder = Recorder::new(run.world(), RecordOptions::default());
    for _ in 0..TICKS {
        if run.advance_by(&mut recorder).is_err() {
            return;
        }
    }
    let replay = Replay::from_bytes(&recorder.finish(run.world()), &[]).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
}
