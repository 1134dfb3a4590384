//! `umbra-lab report`: what it measures, what it writes, what it refuses.

use std::fs;
use std::sync::LazyLock;

use serde_json::Value;
use umbra_physics::Integrator;

use crate::{refused, root, scratch, taken, umbra_lab};

const PROBLEMS: [&str; 9] = [
    "fall-with-drag",
    "damped-fall",
    "oscillator",
    "kepler-circle",
    "kepler-0.6",
    "kepler-0.9",
    "spin",
    "figure-eight",
    "stiff-pendulum",
];
/// Problems in which bodies touch.
const CONTACTS: [&str; 4] = ["bouncing-ball", "sliding-block", "rolling-disc", "landing-disc"];
const SCALARS: [&str; 3] = ["fx", "f64", "f32"];
const RATES: [u64; 4] = [10, 60, 240, 1000];

pub(crate) struct Report {
    page: String,
    diagram: String,
    pub(crate) data: Value,
}

/// A quick run of everything.
pub(crate) static REPORT: LazyLock<Report> = LazyLock::new(|| {
    let (page, data, diagram) = (scratch("report.html"), scratch("report.json"), scratch("report.svg"));
    let output = umbra_lab(&["report", "--quick", "--out", &page, "--json", &data, "--diagram", &diagram]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "no progress but on a terminal");
    let data = serde_json::from_str(&taken(&data)).expect("JSON");
    Report { page: taken(&page), diagram: taken(&diagram), data }
});

pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn problem<'a>(data: &'a Value, name: &str) -> &'a Value {
    let mut problems = list(&data["problems"]).iter().chain(list(&data["contacts"]));
    problems.find(|problem| problem["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

pub(crate) fn line<'a>(data: &'a Value, name: &str, integrator: Integrator, scalar: &str) -> &'a Value {
    let mut lines = list(&problem(data, name)["lines"]).iter();
    let line = lines.find(|line| line["integrator"] == integrator.name() && line["scalar"] == scalar);
    line.unwrap_or_else(|| panic!("no {} in {scalar} for {name}", integrator.name()))
}

/// Errors by rate.
pub(crate) fn errors(name: &str, integrator: Integrator, scalar: &str) -> Vec<f64> {
    let line = line(&REPORT.data, name, integrator, scalar);
    list(&line["runs"]).iter().map(|run| run["error"].as_f64().expect("it stayed in the envelope")).collect()
}

fn has_everything(data: &Value) {
    let names = |key: &str| list(&data[key]).iter().map(|problem| &problem["name"]).collect::<Vec<_>>();
    assert_eq!(names("problems"), PROBLEMS);
    assert_eq!(names("contacts"), CONTACTS);
    for name in PROBLEMS.into_iter().chain(CONTACTS) {
        for (integrator, scalar) in Integrator::ALL.into_iter().flat_map(|i| SCALARS.map(|scalar| (i, scalar))) {
            let line = line(data, name, integrator, scalar);
            let rates: Vec<&Value> = list(&line["runs"]).iter().map(|run| &run["rate"]).collect();
            assert_eq!(rates, list(&data["rates"]).iter().collect::<Vec<_>>());
            let costs = list(&line["runs"]).iter().map(|run| run["cost"].as_f64());
            assert!(costs.into_iter().all(|cost| cost > Some(0.0)), "{name}");
        }
    }
}

/// The report in the repository.
pub(crate) fn committed() -> Value {
    let text = fs::read_to_string(root().join("docs/report/report.json")).expect("it is there");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn every_problem_is_run_with_every_integrator_in_every_scalar() {
    has_everything(&REPORT.data);
    assert_eq!(list(&REPORT.data["rates"]), RATES);
    // With ω·dt = 10 the stiff spring throws its weight out of the envelope; with 0.1 every symplectic rule holds it.
    let errors: Vec<bool> = list(&line(&REPORT.data, "stiff-pendulum", Integrator::VelocityVerlet, "fx")["runs"])
        .iter()
        .map(|run| run["error"].is_null())
        .collect();
    assert_eq!(errors, [true, false, false, false]);
}

#[test]
fn references_are_good_to_1e_15() {
    for name in PROBLEMS.into_iter().chain(CONTACTS) {
        let error = problem(&REPORT.data, name)["reference_error"].as_f64();
        assert!(error.is_some_and(|error| error < 1e-15), "{name}: {error:?}");
    }
}

#[test]
fn slopes_are_the_orders() {
    // The next term of the error is smaller than the first by c·dt or its square, c = ln 2 /s the only rate of this
    // problem: 0.3 % at 1/240 s, 0.5 % at 1/10 s with the symmetric Yoshida4, which meets its rounding beyond 1/60 s.
    for (integrator, pair) in [
        (Integrator::ExplicitEuler, 2),
        (Integrator::SymplecticEuler, 2),
        (Integrator::PublishedVerlet, 2),
        (Integrator::VelocityVerlet, 2),
        (Integrator::Yoshida4, 0),
    ] {
        let errors = errors("damped-fall", integrator, "fx");
        let finer = RATES[pair + 1] as f64 / RATES[pair] as f64;
        let slope = (errors[pair] / errors[pair + 1]).ln() / finer.ln();
        assert!((slope - f64::from(integrator.order())).abs() < 0.02, "{}: {slope}", integrator.name());
        let order = &line(&REPORT.data, "damped-fall", integrator, "fx")["order"];
        assert_eq!(order["from_rate"], RATES[pair], "{}", integrator.name());
        assert!((order["slope"].as_f64().expect("a number") - slope).abs() < 1e-12);
    }
    // (ω·dt)² = 7e-4 at 1/240 s.
    let errors = errors("oscillator", Integrator::VelocityVerlet, "fx");
    let slope = (errors[2] / errors[3]).ln() / (RATES[3] as f64 / RATES[2] as f64).ln();
    assert!((slope - 2.0).abs() < 0.01, "{slope}");
}

#[test]
fn errors_are_those_that_theory_gives() {
    // Symplectic Euler under a constant torque, gained 1/2 rad/s²: ½·gained·T·dt too far.
    for (error, rate) in errors("spin", Integrator::SymplecticEuler, "fx").into_iter().zip(RATES) {
        let expected = 0.5 * 0.5 * 10.0 / rate as f64;
        assert!((error - expected).abs() < 1e-9, "{error} for {expected} at {rate}");
    }
    // Velocity Verlet is exact under it: 10,000 steps round a fraction of a turn to 2^-64 each.
    for error in errors("spin", Integrator::VelocityVerlet, "fx") {
        assert!(error < 1e4 * core::f64::consts::TAU / 2f64.powi(64), "{error}");
    }
    // An oscillator by velocity Verlet goes round at ω·(1 + (ω·dt)²/24): after T the phase is ω·T·(ω·dt)²/24 ahead, of an
    // ellipse with half axes of at most 1.1 m.
    let rate = 1.0 / f64::from(1000);
    let phase = 40f64.powf(1.5) * rate * rate / 24.0 * 10.0;
    let error = errors("oscillator", Integrator::VelocityVerlet, "fx")[3];
    assert!(error < 1.1 * phase && error > 0.3 * phase, "{error} for a phase of {phase}");
}

#[test]
fn fixed_point_goes_on_where_f32_stops() {
    for name in PROBLEMS {
        let fixed = list(&line(&REPORT.data, name, Integrator::Yoshida4, "fx")["runs"])[3]["error"].as_f64();
        let single = list(&line(&REPORT.data, name, Integrator::Yoshida4, "f32")["runs"])[3]["error"].as_f64();
        assert!(fixed < single, "{name}: {fixed:?}, {single:?}");
    }
}

#[test]
fn scalars_part_in_the_order_of_their_bits() {
    let parting = &REPORT.data["parting"];
    assert!(parting["reference_error"].as_f64() < Some(1e-6), "{}", parting["reference_error"]);
    let pair = |a: &str, b: &str| {
        let row = list(&parting["pairs"]).iter().find(|pair| pair["a"] == a && pair["b"] == b);
        row.unwrap_or_else(|| panic!("no {a} and {b}"))
    };
    for row in list(&parting["pairs"]) {
        let distance = list(&row["distance"]);
        assert_eq!(distance.len(), list(&parting["times"]).len());
        assert_eq!(distance[0], 0.0, "all start alike");
        let first = |limit: f64| distance.iter().position(|d| d.as_f64() > Some(limit));
        let time = first(1e-3).map(|at| &list(&parting["times"])[at]);
        assert_eq!(time.unwrap_or(&Value::Null), &row["beyond_millimetre"]);
    }
    let last = |a, b| list(&pair(a, b)["distance"]).last().and_then(Value::as_f64).expect("a number");
    assert!(last("fx", "f64") < 1e-3 * last("fx", "f32"));
    assert!(last("fx, yoshida4", "truth") < last("fx", "truth"));
}

#[test]
fn the_page_needs_nothing_else() {
    // But for the names of its files.
    let page = REPORT.page.replace(REPORT.data["command"].as_str().expect("text"), "umbra-lab report");
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    for outside in ["http:", "https:", "//", "<script", "src=", "@import", "<link", "<img"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(page.matches("url(").count(), page.matches("url(#m").count(), "only its own marks");
    let all = PROBLEMS.len() + CONTACTS.len();
    for name in PROBLEMS.into_iter().chain(CONTACTS) {
        assert!(page.contains(&format!("<section id=\"{name}\">")), "{name}");
    }
    // Two charts for each problem, of 15 lines each, and one of 7; two tables each, one of that, one of contacts, and three to close.
    assert_eq!(page.matches("<svg class=\"chart\"").count(), 2 * all + 1);
    assert_eq!(page.matches("<title>").count(), 1 + 30 * all + 7);
    assert_eq!(page.matches("<table>").count(), 2 * all + 1 + 1 + 3);
    for text in [
        "id=\"parting\"",
        "id=\"contacts\"",
        "id=\"conclude\"",
        "umbra-lab report",
        "Velocity Verlet at 1000 steps a second",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(["NaN", ">inf", ",inf", " inf"].iter().all(|odd| !page.contains(odd)), "every number is one");
}

#[test]
fn the_diagram_is_a_picture_by_itself() {
    let diagram = &REPORT.diagram;
    assert!(diagram.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && diagram.ends_with("</svg>\n"));
    assert_eq!(diagram.matches("http").count(), 1, "the name of SVG alone");
    assert!(diagram.contains("Kepler, e = 0.6: time against error"));
    assert_eq!(diagram.matches("<title>").count(), 15);
}

#[test]
fn problems_can_be_chosen() {
    let (page, data) = (scratch("chosen.html"), scratch("chosen.json"));
    let output = umbra_lab(&[
        "report",
        "--quick",
        "--problem",
        "spin",
        "damped-fall",
        "rolling-disc",
        "--out",
        &page,
        "--json",
        &data,
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let data: Value = serde_json::from_str(&taken(&data)).expect("JSON");
    let names = |key: &str| list(&data[key]).iter().map(|problem| &problem["name"]).collect::<Vec<_>>();
    assert_eq!(names("problems"), ["spin", "damped-fall"]);
    assert_eq!(names("contacts"), ["rolling-disc"]);
    let command = data["command"].as_str().expect("text");
    assert!(command.ends_with("--quick --problem spin --problem damped-fall --problem rolling-disc"), "{command}");
    assert!(data["parting"].is_null());
    let page = taken(&page);
    assert!(["oscillator", "parting"].iter().all(|name| !page.contains(&format!("id=\"{name}\""))));
}

#[test]
fn bad_usage_is_status_two() {
    for arguments in [&["report", "--problem", "pinball"][..], &["report", "--dt", "5"], &["report", "page.html"]] {
        refused(arguments);
    }
}

#[test]
fn the_results_in_the_repository_are_whole() {
    let folder = root().join("docs/report");
    let page = fs::read_to_string(folder.join("report.html")).expect("it is there");
    let size = |name: &str| fs::metadata(folder.join(name)).expect("it is there").len();
    assert!(size("report.html") < 300_000 && size("report.json") < 300_000);
    has_everything(&committed());
    assert!(PROBLEMS.iter().chain(&CONTACTS).all(|name| page.contains(&format!("<section id=\"{name}\">"))));
}
