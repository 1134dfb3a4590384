//! `umbra-lab report --contacts`: its measures, its files, and its exit status for a broken promise.

use std::process::Output;
use std::sync::LazyLock;

use serde_json::Value;

use crate::report::list;
use crate::{refused, scratch, taken, umbra_lab};

/// Scenes of the page, with the number of measures of each.
const SCENES: [(&str, usize); 25] = [
    ("flat_drop", 3),
    ("pyramid40", 5),
    ("tower20", 3),
    ("tower_100x", 4),
    ("tower_1000x", 5),
    ("cards", 4),
    ("arch", 4),
    ("thin_arch", 4),
    ("belt", 1),
    ("mixed", 1),
    ("break", 3),
    ("slope_below", 1),
    ("slope_above", 1),
    ("bounce", 3),
    ("cradle", 1),
    ("shots", 4),
    ("seams", 2),
    ("ghosts", 3),
    ("bounces", 2),
    ("gas", 2),
    ("row", 4),
    ("overhang", 3),
    ("half_pipe", 2),
    ("corridor", 2),
    ("time_error", 2),
];
/// Unoptimised builds leave out the scenes that take minutes there.
const SLOW: [&str; 9] = ["pyramid40", "tower20", "cards", "arch", "thin_arch", "belt", "mixed", "gas", "time_error"];

struct Page {
    html: String,
    data: Value,
    output: Output,
}

/// Runs the report with these further options, and returns its output and its files, which are deleted.
fn page(name: &str, options: &[&str]) -> Page {
    let [html, json] = ["html", "json"].map(|end| scratch(&format!("quality-{name}.{end}")));
    let output = umbra_lab(&[&["report", "--contacts", "--quick", "--out", &html, "--json", &json], options].concat());
    Page { html: taken(&html), data: serde_json::from_str(&taken(&json)).expect("JSON"), output }
}

fn scenes() -> impl Iterator<Item = (&'static str, usize)> {
    SCENES.into_iter().filter(|(name, _)| !cfg!(debug_assertions) || !SLOW.contains(name))
}

static PAGE: LazyLock<Page> = LazyLock::new(|| {
    let names: Vec<&str> = scenes().map(|(name, _)| name).collect();
    let options = [&["--scene"], &names[..]].concat();
    page("all", if names.len() == SCENES.len() { &[] } else { &options })
});

fn measure<'a>(data: &'a Value, scene: &str, name: &str) -> &'a Value {
    let scene =
        list(&data["scenes"]).iter().find(|entry| entry["name"] == scene).unwrap_or_else(|| panic!("no {scene}"));
    list(&scene["measures"]).iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn every_scene_is_measured_and_every_promise_is_kept() {
    let Page { data, output, .. } = &*PAGE;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let counts: Vec<(&str, usize)> = list(&data["scenes"])
        .iter()
        .map(|scene| (scene["name"].as_str().expect("text"), list(&scene["measures"]).len()))
        .collect();
    assert_eq!(counts, scenes().collect::<Vec<_>>());
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.lines().count(), scenes().map(|(_, count)| count).sum::<usize>());
    for line in text.lines() {
        assert!(["passed ", "open ", "measured "].iter().any(|verdict| line.starts_with(verdict)), "{line}");
    }
    let open: Vec<&str> = text.lines().filter(|line| line.starts_with("open")).collect();
    assert!(open.iter().all(|line| line.contains("creep_after_60s")), "{open:?}");
}

#[test]
fn every_figure_of_other_engines_stands_beside_a_measure() {
    let figures =
        include_str!("../../src/report/quality/peers.csv").lines().filter(|line| !line.starts_with('#')).skip(1);
    for line in figures {
        let fields: Vec<&str> = line.split(',').collect();
        if scenes().any(|(name, _)| name == fields[1]) {
            measure(&PAGE.data, fields[1], fields[2]);
        }
    }
}

#[test]
fn known_figures_hold() {
    let value = |scene, name| measure(&PAGE.data, scene, name)["value"].as_f64().expect("a number");
    let is = |scene, name, about: f64, tolerance: f64| {
        let actual = value(scene, name);
        assert!((actual - about).abs() <= tolerance, "{scene} {name}: {actual}");
    };
    is("tower_100x", "top_sink", 0.0253, 0.001);
    is("tower_1000x", "overlap_worst", 0.0418, 0.001);
    is("tower_1000x", "top_sink", 0.102, 0.001);
    is("break", "energy_left", 0.9138, 0.001);
    is("break", "overlap_worst", 0.0000365, 0.0001);
    is("flat_drop", "bounce_height", 0.5, 1e-4);
    is("slope_above", "acceleration_err", -6.42e-7, 1e-8);
    is("bounce", "height_err_10", -5.8e-7, 1e-7);
    is("shots", "twin_fixed", 1000.0, 10.0);
    for (scene, name) in
        [("break", "asymmetry"), ("cradle", "asymmetry"), ("seams", "bump"), ("shots", "crossed_moving")]
    {
        is(scene, name, 0.0, 0.0);
    }
    if !cfg!(debug_assertions) {
        is("pyramid40", "top_sink", 0.0917, 0.001);
        is("pyramid40", "largest_shift", 0.0274, 0.001);
        is("cards", "largest_shift", 0.1019, 0.001);
        is("arch", "largest_shift", 0.0159, 0.001);
        is("thin_arch", "largest_shift", 0.0768, 0.001);
    }
    let heavy = measure(&PAGE.data, "tower_1000x", "top_sink");
    assert_eq!((&heavy["verdict"], &heavy["unit"]), (&"passed".into(), &"m".into()));
    let peers: Vec<&str> = list(&heavy["peers"]).iter().filter_map(|peer| peer["engine"].as_str()).collect();
    assert_eq!(peers, ["box2d", "rapier"]);
}

#[test]
fn the_page_needs_nothing_else_and_is_the_same_each_time() {
    let options = ["--scene", "flat_drop", "break", "bounce"];
    let [first, second] = [page("same", &options), page("same", &options)];
    assert_eq!((&first.html, &first.data, &first.output.stdout), (&second.html, &second.data, &second.output.stdout));
    let html = &PAGE.html;
    assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"));
    // But for the names of its files.
    let inside = html.replace(PAGE.data["command"].as_str().expect("text"), "umbra-lab report");
    for outside in ["http:", "https:", "//", "<script", "src=", "@import", "<link", "<img", "NaN"] {
        assert!(!inside.contains(outside), "{outside}");
    }
    for (name, _) in scenes() {
        assert!(html.contains(&format!("<section id=\"{name}\">")), "{name}");
    }
    assert_eq!(html.matches("<svg width=").count(), scenes().count(), "a picture each");
    // The energies of the gases, and the errors of two problems.
    let charts = if cfg!(debug_assertions) { 0 } else { 3 };
    assert_eq!(html.matches("<svg class=\"chart\"").count(), charts);
    assert!(html.find("id=\"seams\"") < html.find("<section id=\"impacts\">"));
    for text in ["Box2D 3.2.0", "Rapier 0.36.1", "--scene quality", "class=\"open\""] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn a_broken_promise_is_status_one() {
    let options = ["--scene", "slope_below", "flat_drop", "--substeps", "1"];
    let Page { html, data, output } = page("broken", &options);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.starts_with("1 of 4 promises are not kept:\nslope_below moved: "), "{error}");
    assert!(error.trim_end().ends_with("promised: at most 1·10⁻⁶ m"), "{error}");
    // What was found is written all the same.
    assert_eq!(measure(&data, "slope_below", "moved")["verdict"], "failed");
    assert!(html.contains("1 failed"));
    let command = data["command"].as_str().expect("text");
    assert!(command.ends_with("--quick --contacts --scene slope_below --scene flat_drop --substeps 1"), "{command}");
}

#[test]
fn bad_usage_is_status_two() {
    for arguments in [
        &["report", "--scene", "arch"][..],
        &["report", "--substeps", "4"],
        &["report", "--contacts", "--scene", "skyscraper"],
        &["report", "--contacts", "--substeps", "0"],
        &["report", "--contacts", "--substeps", "17"],
        &["report", "--contacts", "--problem", "spin"],
        &["report", "--contacts", "--diagram", "x.svg"],
    ] {
        refused(arguments);
    }
}
