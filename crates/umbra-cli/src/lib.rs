//! The program `umbra`: runs scenes of `umbra-physics` from files, records and checks replays.
//!
//! [`picture::svg`] draws a world in one call. The other public items serve `umbra-lab` as well, the program of the repository that measures the
//! engine; they are no interface to build on.
//!
//! Exit status 0: done; 1: a check failed; 2: bad usage, bad input, or an output that cannot be written.
#![forbid(unsafe_code)]

mod cast;
mod csv;
mod diff;
pub mod failure;
mod finding;
pub mod format;
mod jumps;
pub mod load;
mod manual;
mod open;
pub mod output;
pub mod picture;
mod profile;
pub mod progress;
mod record;
mod run;
mod scenes;
mod selftest;
mod sheets;
mod summary;
mod surface;
pub mod text;
mod verify;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;

const HELP: &str = "\
An output file is written under a temporary name, umbra-XXXXXX.part, in the folder of its destination, and is renamed when
it is complete. Until then a file that was there before is unchanged. A program that is killed leaves the temporary file
behind; `verify`, `view` and `diff` read as much of a replay as is whole. Links are followed, and the permissions of an
existing file are kept. An output over an input is refused, and so are two outputs to one file. Pipes, devices and
/dev/stdout are written to directly.

The file - is the standard input or the standard output; a file of this name is ./-. Where an output goes to the standard
output, what the command prints by itself goes to the standard error.

Exit status: 0 for success; 1 if a check failed; 2 for bad usage, for bad input, and for an output that cannot be written.
A reader that stops early, as `head` does, is no error: the task goes on to its end, and the status is that of its result.";

/// Deterministic 2D physics in fixed point: scenes in, exact results and pictures out.
#[derive(Parser)]
#[command(name = "umbra", version, about, after_help = HELP)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Runs a scene and prints what came out.
    Run(run::Options),
    /// Writes a page that plays a run.
    View(view::Options),
    /// Runs replays again and compares every hash with the one recorded.
    Verify(verify::Options),
    /// Finds the first value in which two recordings part.
    Diff(diff::Options),
    /// Lists the scenes that come with the program, or writes one of them.
    Scenes(scenes::Options),
    /// Runs the built-in scenes and compares their digests with those that every machine gives.
    Selftest(selftest::Options),
    /// Prints the completions of the commands for a shell.
    Completions(manual::CompletionOptions),
    /// Prints the page of the manual.
    Man(manual::ManOptions),
}

impl Task {
    fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Run(options) => run::run(options),
            Self::View(options) => view::view(options),
            Self::Verify(options) => verify::verify(options),
            Self::Diff(options) => diff::diff(options),
            Self::Scenes(options) => scenes::scenes(options),
            Self::Selftest(options) => selftest::selftest(options),
            Self::Completions(options) => manual::completions(options, Arguments::command()),
            Self::Man(options) => manual::man(options, Arguments::command()),
        }
    }
}

/// Does what the arguments of the process say.
pub fn main() -> ExitCode {
    failure::exit_code(Arguments::try_parse().map_or_else(text::print_usage, |arguments| arguments.task.run()))
}
