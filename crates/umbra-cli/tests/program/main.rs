//! The tests of the program `umbra`, a file a task, as one program.

mod cli;
mod manual;
mod outputs;
mod replays;
#[path = "../../../../tests/support/seeds.rs"]
mod seeds;
mod sheets;
mod view;

use std::path::Path;
use std::process::{Command, Output};

/// The repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the package is two folders down")
}

/// The program, run in the repository.
fn umbra(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbra"));
    command.current_dir(root()).args(arguments).output().expect("the program starts")
}
