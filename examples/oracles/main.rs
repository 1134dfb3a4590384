//! Bots play a game until an oracle objects to a match; then the match is shrunk.
//!
//! ```sh
//! cargo run --release --example oracles              # finds the defect in the game
//! cargo run --release --example oracles -- --mended  # finds nothing in the fixed game
//! ```
//!
//! `--seed N` sets the seed, `--out FILE` the path of the replay. Exit status 0 if the defect was found, or with
//! `--mended` nothing; 1 otherwise; 2 if the arguments are wrong or the replay cannot be written.

mod game;

use std::path::PathBuf;
use std::process::ExitCode;
use std::{env, fs};

use game::{Action, Input, Tow, bots};
use umbra_oracles::{Campaign, Counterexample, Fuzz, fuzz};

fn main() -> ExitCode {
    run().unwrap_or_else(|error| {
        eprintln!("oracles: {error}");
        ExitCode::from(2)
    })
}

fn run() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let (mut is_mended, mut seed, mut out) = (false, 0, env::temp_dir().join("oracles.umbrarep"));
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match &argument[..] {
            "--mended" => is_mended = true,
            "--seed" => seed = value()?.parse()?,
            "--out" => out = PathBuf::from(value()?),
            option => return Err(format!("unknown option {option}; known are --mended --seed --out").into()),
        }
    }
    let campaign = fuzz(&Tow::new(is_mended), &Fuzz { seed, ..Fuzz::default() }, |random, _| bots(random));
    report(&campaign);
    if let Some(counterexample) = &campaign.found {
        show(counterexample);
        fs::write(&out, &counterexample.replay)?;
        println!("the replay is in {}: `umbra view` makes a page of it", out.display());
    }
    Ok(if campaign.found.is_some() != is_mended { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Summary of the campaign.
fn report(campaign: &Campaign<Input>) {
    println!("{} matches were played", campaign.runs);
    for (oracle, held) in &campaign.held {
        println!("  {oracle} had nothing against {held} of them");
    }
    if let Some(seed) = campaign.seed {
        println!("in the match of seed {seed} something is wrong");
    }
}

/// The smallest match that was found.
fn show(counterexample: &Counterexample<Input>) {
    println!("{}", counterexample.violation);
    println!(
        "it takes {} ticks and no more than this, as {} tries found out:",
        counterexample.course.ticks, counterexample.tries
    );
    for (tick, Input { player, action }) in &counterexample.course.inputs {
        match action {
            Action::Thrust(direction) => println!("  tick {tick}: player {player} thrusts along {direction}"),
            Action::Grab => println!("  tick {tick}: player {player} reaches for the ball"),
        }
    }
}
