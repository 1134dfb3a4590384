//! `umbra-selftest`: runs the corpus of scenes, prints a digest of each, and of all of them on the last line.
//!
//! It needs the library and `std` alone, so that it runs wherever they do. What it prints is the same everywhere: two
//! machines agree if their last lines do. Exit status 0: all is as it should be; 1: it is not; 2: bad usage, or the
//! standard output cannot be written. A reader that stops early changes nothing of this.
#![forbid(unsafe_code)]

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use umbra_physics::PHYSICS_VERSION;
use umbra_selftest::{Checked, Stream, Way, check};

fn main() -> ExitCode {
    if std::env::args_os().len() > 1 {
        warn("usage: umbra-selftest\nIt takes no arguments; `umbra selftest` does.");
        return ExitCode::from(2);
    }
    match run(&mut Stream(io::stdout().lock())) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            warn(format_args!("standard output: cannot write: {error}"));
            ExitCode::from(2)
        }
    }
}

/// Prints a line to the standard error. If that cannot be written, there is still the status.
fn warn(what: impl Display) {
    let _ = writeln!(io::stderr(), "{what}");
}

fn run(out: &mut impl Write) -> io::Result<bool> {
    let ways = Way::all();
    writeln!(out, "physics_version {PHYSICS_VERSION}")?;
    for way in &ways {
        warn(format_args!("with {way}"));
    }
    let mut written = Ok(());
    let verdict = check(&ways, |checked| {
        if written.is_ok() {
            written = show(checked, out);
        }
    });
    written?;
    if let Some(all) = verdict.all {
        writeln!(out, "{:<24} {:>6} {:016x}", "all", all.ticks, all.digest)?;
    }
    out.flush()?;
    Ok(verdict.agrees)
}

fn show(checked: &Checked, out: &mut impl Write) -> io::Result<()> {
    if let Some(outcome) = checked.outcome {
        writeln!(out, "{:<24} {:>6} {:016x}", checked.scene.name(), outcome.ticks, outcome.digest)?;
    }
    checked.troubles.iter().for_each(|trouble| warn(format_args!("{}: {trouble}", checked.scene.name())));
    Ok(())
}
