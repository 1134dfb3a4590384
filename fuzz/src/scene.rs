//! Any text as a scene: refused at a line and a field, or run.

use umbra_physics::scene::{Scene, SceneError};
use umbra_physics::{Fx, RecordOptions, Recorder, Replay, Scalar};

use super::files::measured;

/// The most memory that reading takes, as a multiple of the text and of what repetitions make of it: a comma in a list is
/// two bytes, and room for a value with its place.
const TIMES: u64 = 1_024;
/// Repetitions of an input make no more than this.
const MADE: u64 = 64;
/// Ticks of a run.
const TICKS: u64 = 3;

/// The target.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Some(made) = repeated(text).filter(|made| *made <= MADE) else { return };
    let scene = match measured(text.as_bytes(), TIMES * made, || Scene::parse(text)) {
        Ok(scene) => scene,
        Err(error) => return assert_says_where(&error, text),
    };
    assert_eq!(Scene::parse(text).as_ref(), Ok(&scene), "read twice");
    play::<Fx>(&scene, text, 1);
    play::<Fx>(&scene, text, 2);
    play::<f64>(&scene, text, 1);
    recorded(&scene);
}

/// How many times over the numbers beside `repeat` make of the text, as far as these are few.
fn repeated(text: &str) -> Option<u64> {
    text.match_indices("repeat").try_fold(1, |made: u64, (at, word)| {
        let rest = &text.as_bytes()[at + word.len()..];
        let counts = &rest[..rest.iter().position(|&byte| byte == b'}').unwrap_or(rest.len())];
        let mut numbers = counts.split(|byte| !byte.is_ascii_digit()).filter(|number| !number.is_empty());
        numbers.try_fold(made, |made, number| match number {
            [digit] => made.checked_mul(u64::from(digit - b'0') + 1),
            [ten, one] => made.checked_mul(u64::from(ten - b'0') * 10 + u64::from(one - b'0') + 1),
            _ => None,
        })
    })
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
        }
        Ok(run.world().state_hash())
    });
    let [one, other] = ways;
    if let Err(error) = &one {
        assert_says_where(error, text);
        assert!(!error.place.field.is_empty() || steps > 1, "{error}");
    }
    assert_eq!(one, other);
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
