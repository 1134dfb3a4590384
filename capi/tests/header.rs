//! The header is what the sources say: made from them once more, and compared. `UMBRA_BLESS=1` writes it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn header() -> PathBuf {
    folder().join("include/umbra_physics.h")
}

fn sources() -> String {
    let files = fs::read_dir(folder().join("src")).expect("the sources").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> = files.collect();
    files.sort();
    files.iter().map(|file| fs::read_to_string(file).expect("a source")).collect()
}

#[test]
fn the_header_is_that_of_the_sources() {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).expect("the configuration");
    let bindings = cbindgen::generate_with_config(folder(), config).expect("a header");
    let mut generated = Vec::new();
    bindings.write(&mut generated);
    let generated = String::from_utf8(generated).expect("UTF-8");
    if std::env::var("UMBRA_BLESS").is_ok_and(|value| value == "1") {
        fs::write(header(), &generated).expect("it can be written");
    }
    let committed = fs::read_to_string(header()).unwrap_or_default();
    assert!(committed == generated, "another header: UMBRA_BLESS=1 cargo test --test header");
}

fn declared(header: &str) -> BTreeSet<&str> {
    let code = header.lines().filter(|line| !line.starts_with([' ', '/', '#', '}']) && !line.starts_with("typedef"));
    code.filter_map(|line| line.split_once('(')?.0.rsplit([' ', '*']).next()).collect()
}

/// Items that the generator does not see are left out of the header silently.
#[test]
fn every_function_is_in_the_header_and_has_words() {
    let (sources, header) = (sources(), fs::read_to_string(header()).expect("the header"));
    let exported: BTreeSet<&str> = sources
        .split("#[unsafe(no_mangle)]")
        .skip(1)
        .map(|rest| rest.split_once(" fn ").and_then(|(_, rest)| rest.split_once('(')).expect("a function").0)
        .collect();
    assert!(exported.len() > 100, "{}", exported.len());
    assert_eq!(exported, declared(&header));
    for (before, after) in header.lines().zip(header.lines().skip(1)) {
        let is_declaration = after.contains('(') && !after.starts_with([' ', '/', '#']);
        assert!(!is_declaration || before.starts_with("// "), "nothing is said of {after}");
    }
}

/// By the tests of the interface, or by the program in C: to refuse null is not enough.
#[test]
fn every_function_is_called_by_somebody() {
    let words = |file: &str| {
        let text = fs::read_to_string(folder().join(file)).expect("a text");
        let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        words.filter(|word| word.starts_with("umbra_")).map(str::to_owned).collect::<BTreeSet<_>>()
    };
    let mut called = words("tests/interface.rs");
    called.append(&mut words("../examples/c/main.c"));
    let header = fs::read_to_string(header()).expect("the header");
    let never: Vec<&str> = declared(&header).into_iter().filter(|name| !called.contains(*name)).collect();
    assert_eq!(never, [""; 0]);
}

#[test]
fn no_float_comes_in_and_nothing_goes_by_value_but_integers() {
    let header = fs::read_to_string(header()).expect("the header");
    let (_, code) = header.split_once("#include <stdint.h>").expect("includes");
    let code: Vec<&str> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    // The points of drawings go out.
    let drawn: Vec<&str> = code.split(';').filter(|declaration| declaration.contains("float")).collect();
    assert!(matches!(drawn[..], [points] if points.contains("umbra_drawing_points(const struct UmbraDrawing *")));
    assert_eq!(code.matches("float").count(), 1);
    let code = code.replace("float *coordinates", "");
    for word in ["float", "double", "bool", "long", "enum", "union", "_Bool"] {
        assert!(!code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|token| token == word), "{word}");
    }
    // A struct is named by itself where it is declared and in others; in arguments with a `*` behind it.
    let structs: Vec<&str> =
        code.lines().filter_map(|line| line.strip_prefix("typedef struct ")?.split(' ').next()).collect();
    assert!(structs.len() > 15 && structs.contains(&"UmbraWorld") && structs.contains(&"UmbraVec2"));
    let arguments = code.split('(').skip(1).filter_map(|rest| Some(rest.split_once(");")?.0));
    let mut count = 0;
    for argument in arguments
        .flat_map(|list| list.split(','))
        .filter(|argument| structs.iter().any(|name| argument.split([' ', '*']).any(|word| word == *name)))
    {
        assert!(argument.contains('*'), "{argument}");
        count += 1;
    }
    assert!(count > 100, "{count}");
}
