//! `umbra-lab report`: problems with contacts, against what theory says of their errors.

use serde_json::Value;
use umbra_physics::Integrator;

use crate::report::{committed, errors, line, list};

const VERLET: Integrator = Integrator::VelocityVerlet;
const RATES: [f64; 4] = [10.0, 60.0, 240.0, 1000.0];

/// Errors in f64, whose rounding is not seen at these rates.
fn doubles(name: &str) -> [f64; 4] {
    errors(name, VERLET, "f64").try_into().expect("four rates")
}

#[test]
fn a_bounce_is_late_by_a_step_at_most() {
    // Four bounces, each of which is late by up to a step, before the end: there the ball moves at v = 3/4⁴·√40 − 10·t.
    let (fall, first) = (0.4f64.sqrt(), 40f64.sqrt());
    let since = 3.0 - fall - 2.0 * fall * (0.75 + 0.5625 + 0.421875);
    let speed = first * 0.75f64.powi(4) - 10.0 * since;
    for scalar in ["fx", "f64"] {
        for (error, rate) in errors("bouncing-ball", VERLET, scalar).into_iter().zip(RATES) {
            let late = 4.0 / rate;
            let bound = speed * late + 5.0 * late * late;
            assert!(error < bound, "{error} of {bound} at {rate}");
        }
    }
}

#[test]
fn a_block_errs_by_the_part_of_friction_that_is_not_put_right() {
    // In a second the ground gives 8 m/s square to the slope and friction 7 m/s along it: Δv = (8, 7). Gravity takes (8, 6). Of the way
    // g·h/2 by which sub-steps of h = dt/5 are off, the share (g·Δv)/Δv² along Δv is put right: friction lacks the rest.
    let lacks = 7.0 * (1.0 - (8.0 * 8.0 + 7.0 * 6.0) / (8.0 * 8.0 + 7.0 * 7.0));
    for (error, rate) in doubles("sliding-block").into_iter().zip(RATES).skip(2) {
        let expected = lacks * 2.03125 / (5.0 * rate) / 2.0;
        // At the start and at the end of the slide other terms of the order of dt² remain.
        assert!((error / expected - 1.0).abs() < 0.02, "{error} for {expected} at {rate}");
    }
}

#[test]
fn a_disc_that_rolls_has_order_two_unless_the_flight_has_one() {
    let slope = |integrator| {
        let errors = errors("rolling-disc", integrator, "f64");
        (errors[1] / errors[3]).ln() / (RATES[3] / RATES[1]).ln()
    };
    assert!((slope(VERLET) - 2.0).abs() < 0.02, "{}", slope(VERLET));
    // Semi-implicit Euler on x″ = 4: 4·T·dt/2 too far.
    for (error, rate) in errors("rolling-disc", Integrator::SymplecticEuler, "f64").into_iter().zip(RATES).skip(1) {
        assert!((error * rate / 4.0 - 1.0).abs() < 2e-3, "{error} at {rate}");
    }
}

#[test]
fn a_landing_is_late_by_a_part_of_a_step() {
    // The disc rolls at 6 m/s in the end: a whole step late it would be 6 m/s · dt behind.
    for (error, rate) in doubles("landing-disc").into_iter().zip(RATES) {
        assert!(error < 6.0 / rate / 20.0, "{error} at {rate}");
    }
}

/// The slope of a line, and the highest rate at which it was seen.
fn order(data: &Value, name: &str, scalar: &str) -> (f64, u64) {
    let order = &line(data, name, VERLET, scalar)["order"];
    (order["slope"].as_f64().expect("a slope"), order["to_rate"].as_u64().expect("a rate"))
}

#[test]
fn orders_are_those_that_are_claimed() {
    let data = committed();
    for (name, claimed, band, at_least) in [
        ("bouncing-ball", 1.0, 0.15, 10_000),
        ("sliding-block", 1.0, 0.1, 240),
        ("rolling-disc", 2.0, 0.05, 1000),
        ("landing-disc", 1.0, 0.05, 120),
    ] {
        let (slope, to) = order(&data, name, "fx");
        assert!((slope - claimed).abs() < band, "{name}: {slope}");
        assert!(to >= at_least, "{name}: {to}");
        // In f64 the order goes on to the finest step.
        let runs = list(&line(&data, name, VERLET, "f64")["runs"]).iter();
        let errors: Vec<f64> = runs.map(|run| run["error"].as_f64().expect("an error")).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(errors.last(), Some(&least), "{name}: {errors:?}");
    }
}
