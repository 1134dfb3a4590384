//! The files that the program writes: refused before the work where they would go over an input or another output, and nothing that a
//! terminal would obey.

use std::fs;

use crate::{refused, scratch, taken, umbra_lab};

const SCENE: &str = r#"{"bodies": [{"name": "a", "velocity": [1, 0]}], "ticks": 9}"#;

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let [scene, page, data] = ["scene.json", "page", "data"].map(|name| scratch(&format!("outputs-{name}")));
    fs::write(&scene, SCENE).expect("it can be written");
    for (arguments, said) in [
        (&["compare", &scene, "--out", &scene][..], "this is an input"),
        (&["report", "--out", &page, "--json", &page], "this is where another output goes"),
        (&["report", "--out", &page, "--json", &data, "--diagram", &data], "this is where another output goes"),
        (&["report", "--contacts", "--out", &page, "--json", &page], "this is where another output goes"),
        (&["report", "--out", "src"], ""),
        (&["report", "--contacts", "--out", "no/such/folder/x"], ""),
    ] {
        let error = refused(arguments);
        assert!(error.contains(&format!(": cannot write: {said}")), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
    }
    assert_eq!(taken(&scene), SCENE);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let error = refused(&["compare", "scenes/free-fall.json", "--ticks", "9", "--out", "/dev/full"]);
    assert!(error.starts_with("/dev/full: cannot write: "), "{error}");
}

#[test]
fn nothing_from_outside_reaches_a_terminal_raw() {
    let scene = scratch("outputs-hostile.json");
    fs::write(&scene, SCENE.replacen('{', "{\"title\": \"T\u{202e}itle\", ", 1)).expect("it can be written");
    for arguments in [
        &["compare", &scene][..],
        &["compare", &scene, "--json"],
        &["compare", "\u{1b}[31m", "--ticks", "0"],
        &["report", "--problem", "\u{9b}2J"],
        &["report", "--quick=\u{1b}"],
    ] {
        let output = umbra_lab(arguments);
        for text in [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8")) {
            assert!(!text.contains(['\u{1b}', '\u{9b}', '\u{202e}']), "{arguments:?}: {text:?}");
        }
    }
    fs::remove_file(scene).expect("it can go");
}
