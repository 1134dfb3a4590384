//! The programs of `examples`, which tests run.

use std::env::consts::EXE_SUFFIX;
use std::fs;
use std::path::{Path, PathBuf};

/// An example, beside this test.
pub(crate) fn example(name: &str) -> PathBuf {
    // It has to be made from the sources as they are: with `--test` alone cargo makes none.
    let test = std::env::current_exe().expect("a test has a file");
    let folder = test.ancestors().nth(2).expect("it is target/PROFILE/deps/TEST").join("examples");
    let program = folder.join(format!("{name}{EXE_SUFFIX}"));
    let how = format!("run `cargo test` without `--test`, or first `cargo build --example {name}` in the same profile");
    let changed = |file: &Path| fs::metadata(file).and_then(|file| file.modified());
    let Ok(modified) = changed(&program) else { panic!("{} is missing: {how}", program.display()) };
    // Cargo's list of what it is made from: `PROGRAM: SOURCE SOURCE…`, with spaces in names as `\ `.
    let list = fs::read_to_string(folder.join(format!("{name}.d"))).expect("cargo lists the sources");
    let (_, sources) = list.trim_end().split_once(": ").expect("a program and its sources");
    for source in sources.replace("\\ ", "\0").split(' ').map(|source| source.replace('\0', " ")) {
        assert!(changed(source.as_ref()).is_ok_and(|at| at <= modified), "{name} is older than {source}: {how}");
    }
    program
}
