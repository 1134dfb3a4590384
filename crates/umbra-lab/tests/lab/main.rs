//! The tests of the program `umbra-lab`, a file a task, as one program.

mod compare;
mod contacts;
mod outputs;
mod quality;
mod report;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// The repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the package is two folders down")
}

/// The program, run in the repository.
fn umbra_lab(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbra-lab"));
    command.current_dir(root()).args(arguments).output().expect("the program starts")
}

/// Runs the program with arguments that it must refuse, with status 2 and before it prints a result. Returns its message.
fn refused(arguments: &[&str]) -> String {
    let output = umbra_lab(arguments);
    let error = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!((output.status.code(), &output.stdout[..]), (Some(2), &b""[..]), "{arguments:?}: {error}");
    assert!(!error.is_empty(), "{arguments:?}");
    error
}

/// The path of a file of a test's own.
fn scratch(name: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{name}", std::process::id()));
    path.into_os_string().into_string().expect("UTF-8")
}

/// Takes a file away, and returns its text.
fn taken(file: &str) -> String {
    let text = fs::read_to_string(file).expect("the file is there");
    fs::remove_file(file).expect("it can go");
    text
}
