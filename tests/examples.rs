//! The examples that are a program by themselves, run as a reader would: each asserts what it says, and says what is looked
//! for here. Those of two processes are run by `netcode.rs`, those about oracles by `oracles`.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

#[path = "support/example.rs"]
mod example;

fn start(name: &str, arguments: &[&str]) -> Output {
    Command::new(example::example(name)).args(arguments).output().expect("a program of this machine")
}

/// Output of an example that ends well.
fn run(name: &str, arguments: &[&str]) -> String {
    let output = start(name, arguments);
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn last_line(said: &str) -> &str {
    said.trim_end().lines().last().expect("a line")
}

#[test]
fn hello_falls_as_the_formula_says() {
    let said = run("hello", &[]);
    // 1000 − ½·g·10², of g = 42133629174·2^-32: what no float has.
    assert!(said.contains("\n10  509.499999997206032276153564453125  "), "{said}");
    assert!(last_line(&said).starts_with("840 ticks, state hash "), "{said}");
}

#[test]
fn orbit_draws_both_lines_and_keeps_to_one() {
    let said = run("orbit", &[]);
    let map: String = said.lines().take(28).collect();
    for (sign, least) in [('.', 40), ('o', 40), ('\'', 40), ('*', 1), ('>', 1)] {
        let drawn = map.matches(sign).count();
        assert!(drawn >= least, "{drawn} of {sign}\n{said}");
    }
    assert!(last_line(&said).ends_with(": on its line to the bit"), "{said}");
}

#[test]
fn springs_print_their_energy_and_come_back() {
    let said = run("springs", &[]);
    let energies: Vec<_> = said.lines().skip(1).take(11).map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    // In joules, to the last of 64 bits after the point.
    assert!(energies.iter().all(|energy| energy.starts_with("-53.366") && energy.len() > 40), "{said}");
    assert!(energies.windows(2).all(|pair| pair[0] != pair[1]), "{said}");
    assert!(last_line(&said).starts_with("and 4800 steps back: the first state, "), "{said}");
}

/// The whole number in a text between these words.
fn number(said: &str, before: &str, after: &str) -> u32 {
    let (_, rest) = said.split_once(before).expect("the words before it");
    rest.split_once(after).expect("the words after it").0.parse().expect("a number")
}

#[test]
fn platformer_is_the_same_for_both_peers() {
    let said = run("platformer", &[]);
    assert_eq!(said.matches("all 1200 hashes are the same").count(), 2, "{said}");
    // They run and jump, and are often predicted wrongly.
    let grounded = said.lines().find(|line| line.contains("on the ground")).expect("a line");
    assert!(number(grounded, "", " ticks of") > 800, "{said}");
    assert!(number(grounded, "ground, ", " in the air") > 200, "{said}");
    assert!(number(&said, "peer 0: ", " ticks made again") > 300, "{said}");
}

#[test]
fn cars_race_over_the_hills_on_both_peers() {
    let said = run("car", &[]);
    assert!(number(&said, "peer 0: ", " ticks made again") > 100, "{said}");
    assert!(number(&said, "peer 1: ", " ticks made again") > 100, "{said}");
    // Beyond the hills.
    let ways: Vec<f64> = last_line(&said).split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(ways.len() == 2 && ways.iter().all(|way| (80.0..200.0).contains(way)), "{said}");
}

#[test]
fn ragdolls_lie_still_on_both_peers() {
    let said = run("ragdoll", &[]);
    // A button is predicted wrongly where it is pressed and where it is let go.
    assert!(number(&said, "peer 0: ", " ticks made again") > 4, "{said}");
    assert!(number(&said, "peer 1: ", " ticks made again") > 4, "{said}");
    assert!(last_line(&said).starts_with("20 limbs asleep, "), "{said}");
}

#[test]
fn thrusters_land() {
    let said = run("thrusters", &[]);
    let bars = said.lines().filter(|line| line.contains('#')).count();
    assert!(bars > 15, "{said}");
    assert!(last_line(&said).starts_with("down after "), "{said}");
}

#[test]
fn record_names_what_was_done_to_its_file() {
    let file = std::env::temp_dir().join(format!("record-{}.umbrarep", std::process::id()));
    let said = run("record", &[file.to_str().expect("a path in UTF-8")]);
    let bytes = fs::read(&file).expect("it was written");
    fs::remove_file(&file).expect("it is there");
    let [written, bit, ulp, cut] = said.lines().collect::<Vec<_>>()[..] else { panic!("{said}") };
    assert!(written.contains(&format!("{} bytes, 300 ticks", bytes.len())), "{said}");
    assert!(bit.contains("tick "), "{said}");
    assert!(ulp.contains(" at tick 124 ") && ulp.contains("body 0, position.x: "), "{said}");
    assert!(cut.contains("whole up to tick "), "{said}");
}

#[test]
fn terminal_draws_in_real_time() {
    const FRAMES: u32 = 30;
    let begun = Instant::now();
    let said = run("terminal", &["--frames", "30"]);
    // Each frame but the first waits for its tick.
    assert!(begun.elapsed() >= Duration::from_secs(1) * (FRAMES - 1) / 60, "{:?}", begun.elapsed());
    let frames: Vec<_> = said.split("\x1b[H").skip(1).collect();
    assert_eq!(frames.len(), FRAMES as usize);
    for frame in &frames {
        assert!(frame.matches('@').count() >= 4 && frame.matches('.').count() >= 8, "{frame}");
    }
    assert_ne!(frames[1], frames[29], "it moves");
    let words: Vec<_> = last_line(&said).split([' ', ',']).collect();
    let [frames, "frames", "", ticks, "ticks", "", lost, "lost", ..] = words[..] else { panic!("{words:?}") };
    let number = |text: &str| text.parse::<u32>().expect("a number");
    assert_eq!(number(frames), FRAMES);
    // None is drawn before its tick is due; on a machine with other things to do ticks are more than frames.
    assert!(number(ticks) + number(lost) >= FRAMES - 1 && number(ticks) <= 6 * FRAMES, "{words:?}");

    assert_eq!(start("terminal", &["--frames", "many"]).status.code(), Some(2));
    assert_eq!(start("terminal", &["--seconds", "1"]).status.code(), Some(2));
}

#[test]
fn terminal_needs_no_floats() {
    for source in [include_str!("../examples/terminal.rs"), include_str!("../examples/shared/grid.rs")] {
        for float in ["f32", "f64", "as_secs_f", "from_secs_f"] {
            assert!(!source.contains(float), "{float}");
        }
    }
}

/// The names of the examples.
fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).expect("the examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "rs") || path.join("main.rs").is_file() {
            names.push(path.file_stem().expect("a name").to_str().expect("in UTF-8").to_owned());
        }
    }
    names
}

#[test]
fn each_example_is_run_and_in_the_readme() {
    let tests = ["tests/examples.rs", "tests/netcode.rs", "crates/umbra-oracles/tests/oracles/tow.rs"].map(|file| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        fs::read_to_string(file).expect("a test")
    });
    let readme = include_str!("../README.md");
    let names = names();
    assert!(names.len() >= 10, "{names:?}");
    // It prints what is committed, which `tables.rs` compares.
    for name in names.iter().filter(|name| *name != "generate_tables") {
        let is_run =
            |source: &String| ["run", "example"].iter().any(|call| source.contains(&format!("{call}(\"{name}\"")));
        assert!(tests.iter().any(is_run), "no test runs {name}");
        assert!(readme.contains(&format!("--example {name}")), "the README has no {name}");
    }
}
