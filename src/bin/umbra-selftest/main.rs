//! `umbra-selftest`: runs the corpus of scenes, prints a digest of each, and of all of them on the last line.
//!
//! It needs the library and `std` alone, so that it runs wherever they do. What it prints is the same everywhere: two
//! machines agree if their last lines do. Exit status 0: all is as it should be; 1: it is not; 2: bad usage.
#![forbid(unsafe_code)]

mod ways;

use std::io::{self, Write};
use std::process::ExitCode;

use umbra_physics::LAW;
use ways::{Checked, Way, check};

fn main() -> ExitCode {
    if std::env::args_os().len() > 1 {
        let _ = writeln!(io::stderr(), "usage: umbra-selftest\nIt takes no arguments; `umbra selftest` does.");
        return ExitCode::from(2);
    }
    match run(&mut io::stdout().lock(), &mut io::stderr()) {
        Ok(true) => ExitCode::SUCCESS,
        // Without anybody to read it there is still the status.
        Ok(false) | Err(_) => ExitCode::from(1),
    }
}

fn run(out: &mut impl Write, err: &mut impl Write) -> io::Result<bool> {
    let ways = Way::all();
    writeln!(out, "law {LAW}")?;
    for way in &ways {
        writeln!(err, "with {way}")?;
    }
    let mut written = Ok(());
    let verdict = check(&ways, |checked| written = written.as_mut().map_or(Ok(()), |()| show(checked, out, err)));
    written?;
    if let Some(all) = verdict.all {
        writeln!(out, "{:<24} {:>6} {:016x}", "all", all.ticks, all.digest)?;
    }
    Ok(verdict.agrees)
}

fn show(checked: &Checked, out: &mut impl Write, err: &mut impl Write) -> io::Result<()> {
    if let Some(outcome) = checked.outcome {
        writeln!(out, "{:<24} {:>6} {:016x}", checked.scene.name(), outcome.ticks, outcome.digest)?;
    }
    checked.troubles.iter().try_for_each(|trouble| writeln!(err, "{}: {trouble}", checked.scene.name()))
}
