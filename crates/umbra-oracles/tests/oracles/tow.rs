//! The example, as a program and as a game.

use std::fs;
use std::process::Command;

use umbra_oracles::{Fuzz, Oracle, Verdict, fuzz, shrink};
use umbra_physics::Replay;

use crate::example::example;

#[path = "../../../../examples/oracles/game.rs"]
mod game;

use game::{Action, Tow, bots};

#[test]
fn the_example_finds_what_was_left_in_its_game_and_nothing_in_the_mended_one() {
    let file = std::env::temp_dir().join(format!("umbra-oracles-{}.umbrarep", std::process::id()));
    let out = file.to_str().expect("a fair name");
    for (arguments, status) in
        [(&["--out", out][..], 0), (&["--mended", "--out", out], 0), (&["--nonsense"], 2), (&["--seed"], 2)]
    {
        let ended = Command::new(example("oracles")).args(arguments).output().expect("it runs");
        let said = String::from_utf8(ended.stdout).expect("text");
        assert_eq!(ended.status.code(), Some(status), "{arguments:?}: {said}");
        assert_eq!(said.contains("reaches for the ball"), arguments[0] == "--out", "{said}");
    }
    let replay = Replay::from_bytes(&fs::read(&file).expect("it was written"), &[]).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    fs::remove_file(&file).expect("it was written");
}

#[test]
fn a_failure_is_shrunk_named_by_its_seed_and_repeatable() {
    let options = Fuzz::default();
    let campaign = fuzz(&Tow::new(false), &options, |random, _| bots(random));
    let (Some(seed), Some(counterexample)) = (campaign.seed, campaign.found.clone()) else {
        panic!("nothing was found")
    };
    assert_eq!(counterexample.violation.oracle, Oracle::Order);
    assert_eq!(counterexample.violation.tick + 1, counterexample.course.ticks);
    let last: Vec<_> =
        counterexample.course.inputs.iter().filter(|(tick, _)| *tick == counterexample.violation.tick).collect();
    assert!(
        last.len() == 2 && last.iter().all(|(_, input)| input.action == Action::Grab),
        "{:?}",
        counterexample.course
    );
    // That seed alone.
    let again = fuzz(&Tow::new(false), &Fuzz { seed, runs: 1, ..options }, |random, _| bots(random));
    assert_eq!((again.seed, &again.found), (Some(seed), &Some(counterexample.clone())));
    // None of its inputs can be left out, and nothing is wrong with it in the mended game.
    let judged = |is_mended, course: &_| Oracle::Order.judge(&Tow::new(is_mended), course);
    assert_eq!(
        judged(false, &counterexample.course).err().map(|violation| *violation),
        Some(counterexample.violation.clone())
    );
    assert_eq!(judged(true, &counterexample.course), Ok(Verdict::Held));
    for i in 0..counterexample.course.inputs.len() {
        let mut fewer = counterexample.course.clone();
        fewer.inputs.remove(i);
        assert!(judged(false, &fewer).is_ok(), "without input {i}");
    }
    // It is as small as it gets, and bounded.
    let small = shrink(&Tow::new(false), &counterexample.course, Oracle::Order, 1_000).expect("it still is wrong");
    assert_eq!((&small.course, &small.replay), (&counterexample.course, &counterexample.replay));
    assert_eq!(shrink(&Tow::new(false), &counterexample.course, Oracle::Order, 0), None);
    let attempt = shrink(&Tow::new(false), &counterexample.course, Oracle::Order, 1).expect("it still is wrong");
    assert_eq!((attempt.tries, attempt.course), (1, counterexample.course));
    assert_eq!(shrink(&Tow::new(true), &small.course, Oracle::Order, 1_000), None);
}

#[test]
fn the_mended_game_has_all_that_oracles_ask_for() {
    let campaign = fuzz(&Tow::new(true), &Fuzz { runs: 20, ..Fuzz::default() }, |random, _| bots(random));
    assert_eq!((campaign.runs, campaign.seed, campaign.found), (20, None, None));
    for (oracle, held) in campaign.held {
        // Its ships are damped, so that no step can be undone.
        let applies = oracle != Oracle::Reverse && (oracle != Oracle::Threads || cfg!(feature = "parallel"));
        assert_eq!(held, if applies { 20 } else { 0 }, "{oracle}");
    }
}
