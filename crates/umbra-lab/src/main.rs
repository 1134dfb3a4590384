//! `umbra-lab`: measures errors, costs and the quality of contacts of `umbra-physics`.
//!
//! Exit status 0: done; 1: a promise is broken; 2: bad usage, bad input, or an output that cannot be written.
#![forbid(unsafe_code)]

mod chart;
mod compare;
mod cost;
mod report;
mod threads;
mod truth;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use umbra_cli::failure::{Failure, exit_code};
use umbra_cli::text;

/// Measures errors, costs and the quality of contacts of umbra-physics.
#[derive(Parser)]
#[command(version, about, bin_name = "umbra-lab")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Runs a scene in every scalar with every integrator, and measures how far each is from a converged reference.
    Compare(compare::Options),
    /// Measures time against error, for every integrator, scalar and time step; or the quality of contacts.
    Report(report::Options),
}

impl Task {
    fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Compare(options) => compare::compare(options),
            Self::Report(options) => report::report(options),
        }
    }
}

fn main() -> ExitCode {
    exit_code(Arguments::try_parse().map_or_else(text::print_usage, |arguments| arguments.task.run()))
}
