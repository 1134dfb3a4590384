//! The layers of the crate, left to right: a module names modules to its left only, and none beside it.
//!
//! Comments and strings are taken out first: documentation may link anywhere. Inline test modules count like the rest of
//! their file: what a layer's tests need, the layer itself may as well use.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "layers/cycles.rs"]
mod cycles;

/// Modules on one level do not name each other.
const LEVELS: [&[&str]; 22] = [
    &["codes", "kernel", "slots", "timers"],
    &["fx"],
    &["error"],
    &["math"],
    &["scalar"],
    &["limits"],
    &["codec"],
    &["shape"],
    &["query"],
    &["collider"],
    &["body"],
    &["collide", "force", "integrate"],
    &["solve"],
    &["joint"],
    &["contact"],
    &["island"],
    &["step"],
    &["world"],
    &["character", "display", "replay", "symmetry"],
    &["compiled"],
    &["selftest"],
    &["guide"],
];

/// The one import to the right: `Scalar` has a supertrait with the functions that the library compiles for its own scalars, and
/// those name all of the engine. A generic method finds its compiled function by the scalar alone.
const DEFENDED: (&str, &str) = ("scalar/number.rs", "compiled");

/// The module of the unit tests with the seeds and the numbers of random cases; its file stands in `tests/support`.
const CASES: &str = "cases";

/// The packages beside the library, each with those among ours that it depends on. The compiler holds that they name public items
/// alone; the tests below hold that there is no way round that.
const PACKAGES: [(&str, &[&str]); 5] = [
    ("umbra-cli", &["umbra-physics", "umbra-scene", "umbra-selftest"]),
    ("umbra-lab", &["umbra-cli", "umbra-physics", "umbra-scene"]),
    ("umbra-oracles", &["umbra-physics"]),
    ("umbra-scene", &["umbra-physics"]),
    ("umbra-selftest", &["umbra-physics"]),
];

/// A file of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
        .unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The lines of a part of a manifest, `[name]`, that say something.
fn section<'a>(manifest: &'a str, name: &str) -> Vec<&'a str> {
    let (_, rest) = manifest.split_once(&format!("\n[{name}]\n")).unwrap_or_else(|| panic!("no [{name}]"));
    let lines = rest.lines().take_while(|line| !line.starts_with('['));
    lines.filter(|line| !line.is_empty() && !line.starts_with('#')).collect()
}

fn level(module: &str) -> Option<usize> {
    LEVELS.iter().position(|modules| modules.contains(&module))
}

/// The source with comments, strings and characters blanked, line by line as it was.
fn code_of(source: &str) -> String {
    let (mut code, bytes) = (String::with_capacity(source.len()), source.as_bytes());
    let mut i = 0;
    let blank = |code: &mut String, from: usize, to: usize| {
        code.extend(bytes[from..to].iter().map(|&b| if b == b'\n' { '\n' } else { ' ' }));
    };
    while i < bytes.len() {
        let start = i;
        let rest = &bytes[i..];
        if rest.starts_with(b"//") {
            i += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        } else if rest.starts_with(b"/*") {
            i += source[i..].find("*/").map_or(rest.len(), |at| at + 2);
        } else if rest[0] == b'"' {
            i += 1;
            while i < bytes.len() && bytes[i] != b'"' {
                i += if bytes[i] == b'\\' { 2 } else { 1 };
            }
            i = (i + 1).min(bytes.len());
        } else if rest[0] == b'\'' && rest.len() > 2 && (rest[1] == b'\\' || rest[2] == b'\'') {
            // A character, not a lifetime.
            i += 2 + rest[2..].iter().position(|&b| b == b'\'').map_or(0, |at| at + 1);
        } else {
            code.push(rest[0] as char);
            i += 1;
            continue;
        }
        blank(&mut code, start, i);
    }
    code
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Positions at which `word` stands as a word of its own.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    code.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        let before = at.checked_sub(1).map(|i| code.as_bytes()[i]);
        let after = code.as_bytes().get(at + word.len());
        !before.is_some_and(is_word) && !after.copied().is_some_and(is_word)
    })
}

fn first_word(code: &str) -> &str {
    let code = code.trim_start();
    &code[..code.bytes().position(|b| !is_word(b)).unwrap_or(code.len())]
}

/// The first names of a path's continuation: of `{a::b, c}` a and c.
fn heads(code: &str) -> Vec<String> {
    let code = code.trim_start();
    let Some(group) = code.strip_prefix('{') else { return vec![first_word(code).to_owned()] };
    let (mut depth, mut heads, mut fresh) = (0, Vec::new(), true);
    for (at, byte) in group.bytes().enumerate() {
        match byte {
            b'{' => depth += 1,
            b'}' if depth == 0 => break,
            b'}' => depth -= 1,
            b',' if depth == 0 => fresh = true,
            b if fresh && is_word(b) => {
                heads.push(first_word(&group[at..]).to_owned());
                fresh = false;
            }
            _ => {}
        }
    }
    heads
}

/// Wrong imports of a file, given its path below `src`.
fn wrong_imports(path: &str, source: &str) -> Vec<String> {
    let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').filter(|part| *part != "mod").collect();
    let module = parts[0];
    let Some(own_level) = level(module) else {
        return if module == "lib" { Vec::new() } else { vec![format!("{path}: {module} is on no level")] };
    };
    let code = code_of(source);
    let mut wrong = Vec::new();
    let mut check = |named: &str| match level(named) {
        Some(level) if named == module || level < own_level || (path, named) == DEFENDED => {}
        None if named == CASES => {}
        Some(_) => wrong.push(format!("{path}: {module} names {named}")),
        None => wrong.push(format!("{path}: `crate::{named}` is no module: name the one it is in")),
    };
    for at in words(&code, "crate") {
        // `$crate::…` in a macro is expanded in the user's crate.
        let is_macro = at > 0 && code.as_bytes()[at - 1] == b'$';
        if let Some(rest) = code[at + 5..].strip_prefix("::").filter(|_| !is_macro) {
            heads(rest).iter().for_each(|head| check(head));
        }
    }
    // `super` from a module at the top leads to the crate as well; inside `mod tests` it leads to the module itself.
    let outside_tests = code.split("mod tests {").next().unwrap_or_default();
    for at in words(outside_tests, "super") {
        let mut rest = &outside_tests[at + 5..];
        let mut up = 1;
        while let Some(next) = rest.strip_prefix("::super") {
            (rest, up) = (next, up + 1);
        }
        let counted_before = outside_tests[..at].ends_with("super::");
        // `pub(super)` names nothing.
        if let Some(rest) = rest.strip_prefix("::").filter(|_| up >= parts.len() && !counted_before) {
            heads(rest).iter().for_each(|head| check(head));
        }
    }
    wrong
}

/// The sources of the library, by their paths below `src`.
fn sources() -> Vec<(String, String)> {
    let files = sources_below("src");
    assert!(files.len() > 40, "only {} files found", files.len());
    files
}

/// The sources below a folder of the repository, by their paths in it.
fn sources_below(folder: &str) -> Vec<(String, String)> {
    fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder of the crate") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files = Vec::new();
    collect(&root, &mut files);
    let named = |path: &PathBuf| {
        let below = path.strip_prefix(&root).expect("below src");
        let name = below.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/");
        (name, fs::read_to_string(path).expect("readable text"))
    };
    files.iter().map(named).collect()
}

/// The start of the paths of vector instructions, `kernel/simd.rs` and the folder beside it.
const SIMD: &str = "kernel/simd";
/// The file with the timers of steps.
const TIMERS: &str = "timers.rs";
/// The file that keeps what the first query of several threads has made.
const CACHED: &str = "collide/broad/cached.rs";

/// The library's files, without the file of tests that compares with arbitrary precision.
fn library() -> Vec<(String, String)> {
    sources().into_iter().filter(|(path, _)| path != "scalar/checks.rs").collect()
}

#[test]
fn imports_run_to_the_left_only() {
    let wrong: Vec<_> = sources().iter().flat_map(|(path, source)| wrong_imports(path, source)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_checker_sees_an_import_to_the_right_in_every_form() {
    for (path, source) in [
        ("kernel/div.rs", "use crate::scalar::Scalar;"),
        ("kernel/div.rs", "fn f() -> crate::error::Error { loop {} }"),
        ("scalar/mod.rs", "use crate::{kernel::div, limits};"),
        ("math/vec2.rs", "use crate::{fx::Fx, scalar::Scalar};"),
        ("fx/ops.rs", "use crate::{\n    kernel::{div, wide},\n    world::World,\n};"),
        ("force/load.rs", "use crate::integrate::Plan;"),
        ("integrate/rules.rs", "use crate::force::Load;"),
        ("step/mod.rs", "use super::world::World;"),
        ("error.rs", "use super::limits;"),
        ("step/sleep.rs", "use super::super::world::World;"),
        ("body/mod.rs", "use crate::World;"),
        ("body/mod.rs", "mod tests { use crate::world::World; }"),
        ("sideways/mod.rs", ""),
    ] {
        assert_eq!(wrong_imports(path, source).len(), 1, "{path}: {source}");
    }
    for (path, source) in [
        ("body/mod.rs", "//! See [`World`](crate::world::World).\nuse crate::shape::Shape;"),
        ("step/kick.rs", "use super::Context;\npub(super) fn f() {}\nuse crate::{body::{A, B}, force};"),
        ("world/mod.rs", "const TEXT: &str = \"crate::replay\"; const Q: char = '\"'; use crate::step::Context;"),
        ("limits.rs", "mod tests { use super::*; }"),
        ("fx/ops.rs", "macro_rules! m { () => { $crate::Fx }; }"),
    ] {
        assert_eq!(wrong_imports(path, source), [""; 0], "{path}: {source}");
    }
}

#[test]
fn proptest_tries_the_same_cases_in_every_run() {
    let folders = ["src", "tests", "crates"].into_iter().flat_map(sources_below);
    let (mut blocks, mut wrong) = (0, Vec::new());
    for (path, source) in folders.filter(|(path, _)| path != "support/cases.rs") {
        let code = code_of(&source);
        let here = code.matches("proptest! {").count();
        let is_wrong = code.matches("#![proptest_config(cases(").count() != here
            || ["Config::default", "Config::with_cases", "TestRunner::default"].iter().any(|form| code.contains(form));
        blocks += here;
        wrong.extend(is_wrong.then_some(path));
    }
    assert!(blocks >= 10, "{blocks}");
    assert!(wrong.is_empty(), "take the configuration from `cases` of tests/support/cases.rs: {wrong:?}");
}

#[test]
fn every_level_names_modules_that_are_there() {
    let paths: Vec<String> = sources().into_iter().map(|(path, _)| path).collect();
    for module in LEVELS.into_iter().flatten() {
        let is_there = |path: &String| *path == format!("{module}.rs") || path.starts_with(&format!("{module}/"));
        assert!(paths.iter().any(is_there), "{module}");
    }
}

/// Files that may name floats: the builds in floats, their list of compiled functions, and output for a display, which nothing in a step
/// can name.
const FLOATS: [&str; 8] = [
    "compiled.rs",
    "scalar/float.rs",
    "scalar/float_angle.rs",
    "scalar/to_f64.rs",
    "display/draw.rs",
    "display/interpolation.rs",
    "display/outline.rs",
    "display/pose.rs",
];

/// Files of the library in which the word stands in code.
fn files_with(word: &str) -> Vec<String> {
    let has = |(_, source): &(String, String)| words(&code_of(source), word).next().is_some();
    library().into_iter().filter(has).map(|(path, _)| path).collect()
}

#[test]
fn one_file_names_the_crate_fixed() {
    let names = |(_, source): &(String, String)| {
        let code = code_of(source);
        words(&code, "fixed").any(|at| code[at + 5..].starts_with("::")) || code.contains("extern crate fixed")
    };
    let files: Vec<_> = library().into_iter().filter(names).map(|(path, _)| path).collect();
    assert_eq!(files, ["fx/mod.rs"]);
}

/// Files of the float feature, and tests of the solver and of areas in a box, which compare with doubles.
fn may_have_floats(path: &str) -> bool {
    FLOATS.contains(&path)
        || path == "force/submerged/tests.rs"
        || path.starts_with("solve/float/")
        || path.starts_with("solve/tests/")
        || path.starts_with("solve/joint/tests/")
}

#[test]
fn floats_stay_in_the_files_of_the_float_feature() {
    for word in ["f32", "f64", "libm"] {
        let files = files_with(word);
        assert!(files.iter().all(|file| may_have_floats(file)), "{word}: {files:?}");
    }
}

#[test]
fn a_float_literal_stands_in_the_files_of_the_float_feature_alone() {
    for (path, source) in library().iter().filter(|(path, _)| !may_have_floats(path)) {
        let code = code_of(source);
        let bytes = code.as_bytes();
        let literal = |at: usize| {
            // Digits, a point, a digit: not `x.0.1`, a field of a field, a literal the macro `fx!` takes, nor a version.
            let digits = bytes[..at].iter().rev().take_while(|b| is_word(**b)).count();
            let first = at - digits;
            let is_field = first > 0 && bytes[first - 1] == b'.';
            let in_macro = ["fx!(", "fx!(-", "since(", "before("].iter().any(|start| code[..first].ends_with(start));
            digits > 0 && bytes[first].is_ascii_digit() && !is_field && !in_macro
        };
        for (at, _) in code.match_indices('.') {
            let next = bytes.get(at + 1).is_some_and(u8::is_ascii_digit);
            assert!(!(next && literal(at)), "{path}: {}", &code[at.saturating_sub(20)..at + 10]);
        }
    }
}

#[test]
fn kernels_are_raw_integers() {
    for (path, source) in library().iter().filter(|(path, _)| path.starts_with("kernel/")) {
        let code = code_of(source);
        let code = code.split("mod tests {").next().unwrap_or_default();
        // A set of vector instructions is a type that implements a trait.
        let types: &[&str] =
            if path.starts_with(SIMD) { &["dyn"] } else { &["trait", "impl", "dyn", "struct", "enum", "Wide"] };
        for word in types.iter().chain(&["Fx", "Scalar", "Factor", "Accumulator", "Vec2"]) {
            assert_eq!(words(code, word).next(), None, "{path} names {word}");
        }
    }
}

#[test]
fn the_library_uses_neither_std_nor_the_outside() {
    // But for the files that ask the CPU what it has, the one that asks for the time, and the one that threads share.
    let is_apart = |path: &str| path == "lib.rs" || path.starts_with(SIMD) || path == TIMERS || path == CACHED;
    for (path, source) in library().iter().filter(|(path, _)| !is_apart(path)) {
        let code = code_of(source);
        let code = code.split("mod tests {").next().unwrap_or_default();
        // Threads, for the tests of the solver.
        let in_std = !path.starts_with("solve/tests/") && words(code, "std").next().is_some();
        assert!(!in_std, "{path} names std");
        for word in ["println", "eprintln", "dbg", "HashMap", "HashSet", "unsafe", "static mut"] {
            assert_eq!(words(code, word).next(), None, "{path} names {word}");
        }
    }
    let root = text("src/lib.rs");
    assert!(root.contains("#![no_std]"));
    assert!(root.contains("forbid(unsafe_code)"), "where there are no vectors");
    let code = code_of(&root);
    // The one use of std: linking it for the feature of its name.
    assert_eq!(words(&code, "std").count(), 1, "{:?}", words(&code, "std").map(|at| &code[at..]).collect::<Vec<_>>());
    let manifest = text("Cargo.toml");
    assert!(manifest.contains("unsafe_code = \"deny\""));
    let mut named = files_with("unsafe_code");
    named.sort();
    let sets = ["avx2", "avx512", "neon", "simd128"].map(|set| format!("kernel/simd/{set}.rs"));
    assert_eq!(named.split_last(), Some((&"lib.rs".into(), &sets[..])), "who allows it, and who denies it");
}

#[test]
fn packages_beside_the_library_depend_on_it_and_name_public_items_alone() {
    let is_hidden = |(_, source): &(String, String)| source.contains("#[doc(hidden)]");
    let hidden: Vec<String> = sources().into_iter().filter(is_hidden).map(|(path, _)| path).collect();
    for (package, expected) in PACKAGES {
        let manifest = text(&format!("crates/{package}/Cargo.toml"));
        let mut ours: Vec<&str> = section(&manifest, "dependencies")
            .into_iter()
            .filter_map(|line| line.split_once(" = ").map(|(name, _)| name))
            .filter(|name| name.starts_with("umbra-"))
            .collect();
        ours.sort_unstable();
        assert_eq!(ours, expected, "{package}");
        let files = sources_below(&format!("crates/{package}/src"));
        assert!(!files.is_empty(), "{package}");
        for (path, source) in files {
            let code = code_of(&source);
            // Neither a file of another package as a module of this one, nor an item that is public for a macro's sake. The
            // self-test alone switches SIMD off, to try the code path of other machines.
            for way_round in ["#[path", "include!", "from_literal", "internals", "::solve"] {
                let is_switch = package == "umbra-selftest" && way_round == "internals";
                assert!(is_switch || !code.contains(way_round), "{package}/src/{path}: {way_round}");
            }
            assert!(words(&code, "collide").next().is_none(), "{package}/src/{path}: the narrow phase");
        }
    }
    // The traits that `Scalar` is sealed by, `Fx::from_literal`, for `fx!`, and the narrow phase and the solver, in `lib.rs`.
    let is_known = |path: &String| {
        path.starts_with("scalar/") || ["compiled.rs", "fx/text.rs", "lib.rs", "selftest/mod.rs"].contains(&&**path)
    };
    assert!(hidden.iter().all(is_known), "{hidden:?}");
    let folders = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")).expect("the packages").count();
    assert_eq!(folders, PACKAGES.len());
}

#[test]
fn the_library_has_few_features_and_few_optional_dependencies() {
    let manifest = text("Cargo.toml");
    let features: Vec<&str> =
        section(&manifest, "features").into_iter().filter(|line| !line.starts_with("default = ")).collect();
    assert!(features.len() <= 8, "{features:?}");
    let optional = section(&manifest, "dependencies").into_iter().filter(|line| line.contains("optional = true"));
    assert!(optional.clone().count() <= 4, "{:?}", optional.collect::<Vec<_>>());
}

/// Enums that are open to more variants, with the files beside the library that have to know each: there the compiler asks for no
/// more than `_`.
const KNOWN: [(&str, &str, &[&str]); 5] = [
    ("src/world/commands.rs", "Command", &["umbra-scene/src/text.rs"]),
    ("src/force/field.rs", "FieldKind", &["umbra-scene/src/text.rs"]),
    ("src/shape/mod.rs", "Geometry", &["umbra-scene/src/shape.rs"]),
    ("src/joint/kind.rs", "JointKind", &["umbra-scene/src/text/joint.rs"]),
    ("src/display/draw.rs", "Role", &["../capi/src/draw.rs"]),
];

#[test]
fn each_variant_is_known_beside_the_library() {
    for (file, name, readers) in KNOWN {
        let source = code_of(&text(file));
        let mut starts = ["<", " {"].iter().filter_map(|end| source.split_once(&format!("pub enum {name}{end}")));
        let (_, rest) = starts.next().unwrap_or_else(|| panic!("no {name}"));
        let body = rest.split("\n}").next().expect("an end");
        // One step in from the margin; fields of a variant stand further in. Commands are rows of a table, `number => Variant`.
        let variants: Vec<&str> = if name == "Command" {
            let rows = source.lines().filter_map(|line| line.strip_prefix("    ")?.split_once(" => "));
            rows.filter(|(number, _)| number.parse::<u8>().is_ok()).map(|(_, row)| first_word(row)).collect()
        } else {
            let lines = body.lines().filter_map(|line| line.strip_prefix("    "));
            lines.filter(|line| line.starts_with(char::is_uppercase)).map(first_word).collect()
        };
        assert!(variants.len() >= 3, "{name}: {variants:?}");
        for reader in readers {
            let code = code_of(&text(&format!("crates/{reader}")));
            for variant in &variants {
                let path = format!("{name}::{variant}");
                let is_named = code
                    .match_indices(&path)
                    .any(|(at, _)| code[at + path.len()..].bytes().next().is_none_or(|byte| !is_word(byte)));
                assert!(is_named, "{reader} does not know {path}");
            }
        }
    }
}

#[test]
fn each_limit_is_tried() {
    // These hold between the stages of a step, where no call reaches.
    const WITHIN: [&str; 2] = ["KICK", "TRANSIENT_SPEED"];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let limits = fs::read_to_string(root.join("src/limits.rs")).expect("the limits");
    let limits: Vec<_> = limits.lines().filter_map(|line| line.strip_prefix("pub const ")?.split(':').next()).collect();
    assert!(limits.len() > WITHIN.len() && WITHIN.iter().all(|name| limits.contains(name)), "{limits:?}");
    let tests: Vec<_> = ["tests/envelope.rs", "tests/commands.rs", "src/replay/tests/bounds.rs"]
        .map(|file| fs::read_to_string(root.join(file)).expect("tests"))
        .iter()
        .map(|source| code_of(source))
        .collect();
    for name in limits.iter().filter(|name| !WITHIN.contains(name)) {
        // An import is no use of it.
        let is_used =
            |code: &String| code.split("\nfn ").skip(1).any(|function| words(function, name).next().is_some());
        assert!(tests.iter().any(is_used), "no test tries {name}");
    }
}
