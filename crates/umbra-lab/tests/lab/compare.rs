//! `umbra-lab compare`: errors against a converged reference.

use std::fs;

use serde_json::Value;

use crate::{refused, scratch, taken, umbra_lab};

fn compared(scene: &str, more: &[&str]) -> Value {
    let output = umbra_lab(&[&["compare", scene, "--json"], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "no progress but on a terminal");
    serde_json::from_slice(&output.stdout).expect("one JSON value")
}

fn run<'a>(result: &'a Value, integrator: &str, scalar: &str) -> &'a Value {
    let mut runs = result["runs"].as_array().expect("a list").iter();
    let run = runs.find(|run| run["integrator"] == integrator && run["scalar"] == scalar);
    run.unwrap_or_else(|| panic!("no {integrator} in {scalar}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_higher_order_is_nearer_to_the_reference() {
    let result = compared("scenes/kepler.json", &["--ticks", "600"]);
    assert_eq!((&result["ticks"], &result["seconds"]), (&Value::from(600), &Value::from(10.0)));
    let reference = &result["reference"];
    assert_eq!((&reference["integrator"], &reference["steps_to_a_tick"]), (&"yoshida4".into(), &Value::from(64)));
    let error = |integrator, scalar| number(&run(&result, integrator, scalar)["position_at_end"]);
    for scalar in ["fx", "f64", "f32"] {
        assert!(error("velocity_verlet", scalar) < 0.1 * error("symplectic_euler", scalar), "{scalar}");
        // Of the same order, but it gains no energy.
        assert!(error("symplectic_euler", scalar) < error("explicit_euler", scalar), "{scalar}");
        assert!(error("yoshida4", scalar) < 0.1 * error("velocity_verlet", scalar), "{scalar}");
    }
    // Of the fourth order: 32 steps to a tick err by 32^-4 of what one does, 1e-6, and the best run is that one.
    assert!(number(&reference["position_at_most"]) < 1e-5 * error("yoshida4", "f64"));
    for run in result["runs"].as_array().expect("a list") {
        assert!(number(&run["position_at_end"]) <= number(&run["position_at_most"]), "{run}");
        assert!(number(&run["cost"]) > 0.0 && run["refused"].is_null() && run["quarantined"] == 0, "{run}");
    }
}

#[test]
fn inputs_act_alike_in_finer_steps() {
    // Gravity and forces by tick, constant over it: velocity Verlet is exact but for rounding. In f64 the reference rounds
    // 3·64·1060 sums of up to 120 m to half of 1.4e-14 m, and as many of velocities below 16 m/s to half of 1.8e-15 m/s,
    // which act for 9 s on average: 2e-9 m if they all went one way. The drift in fx reads velocities to 2^-33 m/s, 2e-9 m
    // in 18 s.
    let result = compared("scenes/lander.json", &[]);
    for scalar in ["fx", "f64"] {
        let run = run(&result, "velocity_verlet", scalar);
        assert!(number(&run["position_at_most"]) < 5e-9, "{run}");
    }
    assert!(number(&run(&result, "symplectic_euler", "fx")["position_at_most"]) > 0.01);
}

#[test]
fn refusals_of_a_scene_are_reported() {
    let output = umbra_lab(&["compare", "scenes/damping.json", "--ticks", "20"]);
    assert_eq!(output.status.code(), Some(0));
    let table = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(table.contains("the reference is velocity_verlet in f64"), "{table}");
    assert_eq!(
        table
            .matches("Yoshida4 needs damping that keeps more than 2^-33 of a velocity a second: a rate below 22.87")
            .count(),
        3,
        "{table}"
    );
    let result = compared("scenes/too-stiff.json", &[]);
    assert_eq!(run(&result, "velocity_verlet", "fx")["quarantined"], 1);
}

#[test]
fn an_integrator_that_a_scene_changes_to_is_left_out() {
    let file = scratch("compare-changing.json");
    let scene = r#"{"time_step": "1/50", "gravity": [0, -10], "bodies": [{"name": "a"}], "ticks": 50,
        "inputs": [{"at": 10, "set": {"integrator": "explicit_euler"}}]}"#;
    fs::write(&file, scene).expect("it can be written");
    let result = compared(&file, &[]);
    fs::remove_file(&file).expect("it can go");
    // Explicit Euler would lag by ½·g·dt·t: 8 cm.
    assert!(number(&run(&result, "velocity_verlet", "fx")["position_at_end"]) < 1e-9);
    assert!((number(&run(&result, "explicit_euler", "fx")["position_at_end"]) - 0.1).abs() < 1e-6);
}

#[test]
fn errors_over_time_are_drawn() {
    let file = scratch("compare-kepler.svg");
    compared("scenes/kepler.json", &["--ticks", "100", "--out", &file]);
    let svg = taken(&file);
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    assert_eq!(svg.matches("http").count(), 1, "the name of SVG alone");
    assert!(svg.contains("Kepler ellipse, e = 0.6") && svg.contains("error in m"));
    assert_eq!(svg.matches("<title>").count(), 16, "a line for each run and one for the reference");
}

#[test]
fn bad_usage_is_status_two() {
    let fine = scratch("compare-fine.json");
    fs::write(&fine, r#"{"time_step": "1/6000", "bodies": [{"name": "a"}]}"#).expect("it can be written");
    for arguments in [
        &["compare"][..],
        &["compare", "scenes/no-such-scene.json"],
        &["compare", "scenes/kepler.json", "--ticks", "0"],
        &["compare", "scenes/kepler.json", "--finer", "1"],
        &["compare", "scenes/kepler.json", "--finer", "167"],
        &["compare", "scenes/kepler.json", "--ticks", "2", "--out", "no/such/folder/x.svg"],
        &["compare", &fine],
    ] {
        refused(arguments);
    }
    fs::remove_file(fine).expect("it can go");
}
