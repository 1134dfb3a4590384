//! Figures in the README, the guide and other texts: counts of scenes and ticks, and results of the report.

use std::path::Path;

use serde_json::Value;

use crate::shown::guide::{flowing, read, report, runs};

/// With commas between the thousands, as texts have it.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let force_groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    force_groups.join(",")
}

/// The chapter with the results of the report.
const ACCURACY: &str = "src/guide/accuracy.md";

fn assert_says(path: &str, claim: &str) {
    assert!(flowing(&read(path)).contains(claim), "{path}: {claim}");
}

#[test]
fn as_many_scenes_as_the_readme_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).expect("there are scenes").map(|entry| entry.expect("an entry").path());
    let scenes = files.filter(|path| path.extension().is_some_and(|extension| extension == "json")).count();
    assert_says("README.md", &format!("there are {scenes} in [`scenes/`](scenes)"));
}

#[test]
fn the_self_test_has_the_scenes_ticks_and_digest_that_are_said() {
    let golden = read("src/selftest/golden.txt");
    let lines: Vec<Vec<&str>> = golden.lines().map(|line| line.split_whitespace().collect()).collect();
    let is_scene = |line: &&Vec<&str>| line.len() == 3 && !["#", "all"].contains(&line[0]);
    let scenes = lines.iter().filter(is_scene).count();
    let line_of = |name: &str| lines.iter().find(|line| line[0] == name).expect("a line");
    let ticks = grouped(line_of("all")[1].parse().expect("a number"));
    let (digest, version) = (line_of("all")[2], line_of("physics_version")[1]);
    let claim = format!("`{digest}` of {scenes} scenes and {ticks} ticks under version {version}");
    assert_says("docs/determinism.md", &claim);
    assert_says("docs/stability.md", &format!("PHYSICS_VERSION == {version}"));
    assert_says("docs/determinism.md", &format!("The self-test has {scenes} scenes"));
    assert_says("CHANGELOG.md", &format!("(feature `selftest`): {scenes} scenes"));
}

/// Every problem of the report by name, with its runs in a scalar by an integrator.
fn all_runs(report: &Value, scalar: &str, integrator: &str) -> Vec<(String, Vec<Value>)> {
    let problems = report["problems"].as_array().expect("problems").iter();
    let named = |problem: &Value| problem["name"].as_str().expect("a name").to_owned();
    problems.map(|problem| (named(problem), runs(problem, scalar, integrator))).collect()
}

#[test]
fn the_report_has_the_problems_and_steps_that_the_guide_says() {
    let report = report();
    let rates: Vec<u64> = report["rates"].as_array().expect("rates").iter().filter_map(Value::as_u64).collect();
    let (first, last) = (grouped(rates[0]), grouped(rates[rates.len() - 1]));
    assert_eq!(report["problems"].as_array().expect("problems").len(), 9);
    let claim = format!("has nine problems, all steps from 1/{first} to 1/{last} s");
    assert_says(ACCURACY, &claim);
}

#[test]
fn fixed_point_errs_as_doubles_do_down_to_what_the_guide_says() {
    let report = report();
    let mut compared = 0;
    for integrator in umbra_physics::Integrator::ALL.map(umbra_physics::Integrator::name) {
        let pairs = all_runs(&report, "fx", integrator).into_iter().zip(all_runs(&report, "f64", integrator));
        for ((name, ours), (_, others)) in pairs {
            for (run, run_in_f64) in ours.iter().zip(&others) {
                let (Some(error), Some(in_f64)) = (run["error"].as_f64(), run_in_f64["error"].as_f64()) else {
                    assert_eq!(run["error"], run_in_f64["error"], "{name} by {integrator}: {run}");
                    continue;
                };
                if error.max(in_f64) > 1e-6 {
                    assert!((error - in_f64).abs() <= 0.01 * in_f64, "{name} by {integrator}: {run}, {run_in_f64}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 200, "{compared}");
    assert_says(ACCURACY, "**fx** errs as f64 does, to 1 %, for as long as the error is above 10⁻⁶ m");
}

#[test]
fn singles_have_a_best_step_as_the_guide_says() {
    let report = report();
    // The rate at which a problem's error is least, and that error.
    let best = |runs: &[Value]| -> (f64, u64) {
        let points = runs.iter().filter_map(|run| Some((run["error"].as_f64()?, run["rate"].as_u64()?)));
        points.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a run that came through")
    };
    for integrator in ["velocity_verlet", "yoshida4"] {
        for (name, runs) in all_runs(&report, "f32", integrator) {
            let (error, rate) = best(&runs);
            assert!((1e-6..1e-3).contains(&error), "{name} by {integrator}: {error} at {rate}");
        }
    }
    let yoshida = all_runs(&report, "f32", "yoshida4");
    let early = yoshida.iter().filter(|(_, runs)| best(runs).1 <= 120).count();
    let claim = format!("with Yoshida4 in {early} of the {} problems from 120 steps a second on", yoshida.len());
    assert_says(
        ACCURACY,
        &format!("**f32** errs by 10⁻⁶ to 10⁻³ m at its best step: a finer one makes it worse, {claim}"),
    );
}

#[test]
fn the_chaotic_scene_parts_when_the_guide_says() {
    let report = report();
    let pairs = report["parting"]["pairs"].as_array().expect("pairs");
    let beyond = |a: &str, b: &str, distance: &str| {
        let pair = pairs.iter().find(|pair| pair["a"] == a && pair["b"] == b).expect("a pair");
        pair[distance].as_f64().expect("they part")
    };
    let (millimetre, metre) = (beyond("fx", "f64", "beyond_millimetre"), beyond("fx", "f64", "beyond_metre"));
    let truth = beyond("fx", "truth", "beyond_metre");
    assert_eq!(truth, beyond("f64", "truth", "beyond_metre"));
    let claim = format!(
        "fx and f64 are a millimetre apart after {millimetre} s and a metre after {metre} s, but either is a metre from the \
         truth after {truth} s"
    );
    assert_says(ACCURACY, &claim);
}
