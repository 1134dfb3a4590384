//! `umbra`: runs scenes of `umbra-physics` from files, records and checks replays.
//!
//! Exit status 0: done; 1: a check failed; 2: bad usage or input.
#![forbid(unsafe_code)]

mod chart;
mod compare;
mod cost;
mod csv;
mod diff;
mod failure;
mod finding;
mod load;
mod picture;
mod progress;
mod record;
mod report;
mod run;
mod selftest;
mod summary;
mod truth;
mod verify;
mod view;

use std::io::Write;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Deterministic 2D physics in fixed point: scenes in, exact results and pictures out.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Runs a scene and prints what came out.
    Run(run::Options),
    /// Runs a scene in every scalar with every integrator, and measures how far each is from a converged reference.
    Compare(compare::Options),
    /// Measures time against error, for every integrator, scalar and time step.
    Report(report::Options),
    /// Writes a page that plays a run.
    View(view::Options),
    /// Runs replays again and compares every hash with the one recorded.
    Verify(verify::Options),
    /// Finds the first value in which two recordings part.
    Diff(diff::Options),
    /// Runs the built-in scenes and compares their digests with those that every machine gives.
    Selftest(selftest::Options),
}

fn main() -> ExitCode {
    let Arguments { task } = Arguments::parse();
    let done = match task {
        Task::Run(options) => run::run(&options),
        Task::Compare(options) => compare::compare(&options),
        Task::Report(options) => report::report(&options),
        Task::View(options) => view::view(&options),
        Task::Verify(options) => verify::verify(&options),
        Task::Diff(options) => diff::diff(&options),
        Task::Selftest(options) => selftest::selftest(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Without anybody to read it there is still the status.
            let _ = writeln!(std::io::stderr(), "{failure}");
            ExitCode::from(failure.status())
        }
    }
}
