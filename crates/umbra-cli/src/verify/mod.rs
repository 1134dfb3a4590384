//! `umbra verify`: replays run again, many at once.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::ProgressBar;
use serde::Serialize;
use umbra_physics::{Difference, Divergence, Replay, ReplayError, World};

use crate::failure::{Failure, UNREADABLE, tag};
use crate::finding::FindingLine;
use crate::output::Destinations;
use crate::progress::progress;
use crate::text;

const HELP: &str = "\
A line for each file, in the order given: what it is, its name, and why.
  ok               every hash is the one recorded
  tampered         the file was changed after it was recorded
  diverged         the run differs from the recorded one
  cut_off          the file ends before the recording did; as far as it goes it is ok
  physics_version  it was recorded under another physics version
  malformed        no replay that this program can play
  unreadable       no file that can be read

What is not ok has the number of its error at the end, as [E405]: docs/errors.md has them all.

Exit status: 0 if all are ok; 1 for tampered, diverged, cut_off; 2 for physics_version, malformed,
unreadable, and for bad usage. Of several files the highest counts.";

#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Options {
    /// The replays.
    #[arg(required = true, value_name = "REPLAY")]
    replays: Vec<PathBuf>,
    /// Prints a JSON object a line, one for each file.
    #[arg(long)]
    json: bool,
    /// Prints all digits of the values, which JSON always has.
    #[arg(long)]
    exact: bool,
    /// Number of files to verify at once [default: the number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Status {
    Ok,
    Tampered,
    Diverged,
    CutOff,
    #[serde(rename = "physics_version")]
    PhysicsVersion,
    Malformed,
    Unreadable,
}

impl Status {
    const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Tampered => "tampered",
            Self::Diverged => "diverged",
            Self::CutOff => "cut_off",
            Self::PhysicsVersion => "physics_version",
            Self::Malformed => "malformed",
            Self::Unreadable => "unreadable",
        }
    }

    const fn exit(self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::Tampered | Self::Diverged | Self::CutOff => 1,
            Self::PhysicsVersion | Self::Malformed | Self::Unreadable => 2,
        }
    }

    const fn of(error: &ReplayError) -> Self {
        match error {
            ReplayError::Tampered(_) => Self::Tampered,
            ReplayError::CutOff { .. } => Self::CutOff,
            ReplayError::PhysicsVersion { .. } => Self::PhysicsVersion,
            _ => Self::Malformed,
        }
    }
}

/// The part of a replay that was run again, and the number of hashes that are as recorded.
#[derive(Clone, Copy, Debug, Default)]
struct Played {
    ticks: u64,
    hashes: u64,
    /// The time that passed in its world, s.
    seconds: f64,
    wall: Duration,
}

/// The result for a file.
#[derive(Debug)]
struct Verdict {
    status: Status,
    code: Option<u16>,
    reason: Option<String>,
    finding: Option<Difference>,
    played: Played,
}

impl Verdict {
    fn unreadable(error: &io::Error) -> Self {
        let reason = Some(format!("cannot read: {error}"));
        let (status, code) = (Status::Unreadable, Some(UNREADABLE));
        Self { status, code, reason, finding: None, played: Played::default() }
    }

    fn flawed(error: ReplayError, played: Played) -> Self {
        let (status, code, reason) = (Status::of(&error), Some(error.code()), Some(error.to_string()));
        let finding = if let ReplayError::Tampered(finding) = error { Some(*finding) } else { None };
        Self { status, code, reason, finding, played }
    }

    fn diverged(divergence: Divergence, played: Played) -> Self {
        let (code, reason) = (Some(divergence.code()), Some(divergence.to_string()));
        Self { status: Status::Diverged, code, reason, finding: Some(divergence.difference), played }
    }

    fn line(&self, file: &Path, exact: bool) -> String {
        let Self { status, code, reason, finding, played } = self;
        let mut what = reason.clone().unwrap_or_else(|| played.describe());
        if let Some(finding) = finding.as_ref().filter(|_| exact) {
            what = what.replace(&finding.to_string(), &finding.exact().to_string());
        }
        let code = code.map_or_else(String::new, |code| format!(" [{}]", tag(code)));
        format!("{}  {}  {what}{code}", status.name(), text::path(file))
    }

    fn json(&self, file: &Path) -> String {
        let Self { status, code, reason, finding, played } = self;
        let line = Line {
            file: file.display().to_string(),
            status: *status,
            ticks: played.ticks,
            hashes: played.hashes,
            wall_seconds: played.wall.as_secs_f64(),
            code: code.map(tag),
            reason: reason.as_deref(),
            finding: finding.as_ref().map(FindingLine::from),
        };
        // Texts and numbers always have a form in JSON.
        serde_json::to_string(&line).unwrap_or_default()
    }
}

#[derive(Serialize)]
struct Line<'a> {
    file: String,
    status: Status,
    /// Run again; those with a hash, which is as recorded.
    ticks: u64,
    hashes: u64,
    wall_seconds: f64,
    code: Option<String>,
    reason: Option<&'a str>,
    finding: Option<FindingLine>,
}

impl Played {
    /// Writes it as `3,600 ticks, 3,600 hashes, 58× real time`.
    fn describe(&self) -> String {
        let mut text = format!("{} ticks, {} hashes", grouped(self.ticks), grouped(self.hashes));
        let factor = self.seconds / self.wall.as_secs_f64();
        if factor.is_finite() && self.ticks > 0 {
            let factor = if factor < 10.0 { format!("{factor:.1}") } else { grouped(factor as u64) };
            text += &format!(", {factor}× real time");
        }
        text
    }
}

/// A number with its digits in threes.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

pub(crate) fn verify(options: &Options) -> Result<(), Failure> {
    let files = &options.replays;
    // The standard output goes over none of them.
    Destinations::beside(files)?;
    let jobs = options.jobs.map(usize::from).or_else(|| thread::available_parallelism().ok().map(usize::from));
    let bar = progress(0, "tick");
    let (mut bad, mut status) = (0, 0);
    in_order(
        files,
        jobs.unwrap_or(1),
        |file| check(file, &bar),
        |file, verdict| {
            let line = if options.json { verdict.json(file) } else { verdict.line(file, options.exact) };
            bad += usize::from(verdict.status != Status::Ok);
            status = status.max(verdict.status.exit());
            bar.suspend(|| text::print(line))
        },
    )?;
    bar.finish_and_clear();
    if status == 0 { Ok(()) } else { Err(Failure::Verify { bad, files: files.len(), status }) }
}

/// Does a job for each file, so many at once, and hands on what comes of it in the order of the files, as long as it is
/// taken.
fn in_order<T: Send>(
    files: &[PathBuf],
    jobs: usize,
    job: impl Fn(&Path) -> T + Sync,
    mut done: impl FnMut(&Path, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..jobs.min(files.len()) {
            let (sender, next, job) = (sender.clone(), &next, &job);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    if sender.send((index, job(file))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let (mut early, mut due) = (BTreeMap::new(), files.iter().enumerate());
        let mut awaited = due.next();
        for (index, result) in receiver {
            early.insert(index, result);
            while let Some((result, file)) = awaited.and_then(|(index, file)| Some((early.remove(&index)?, file))) {
                done(file, result)?;
                awaited = due.next();
            }
        }
        Ok(())
    })
}

/// Runs the replay in a file again; what is whole of it, if it is cut off.
fn check(file: &Path, bar: &ProgressBar) -> Verdict {
    let bytes = match fs::read(file) {
        Ok(bytes) => bytes,
        Err(error) => return Verdict::unreadable(&error),
    };
    let (replay, flaw) = match Replay::from_bytes(&bytes, &[]) {
        Ok(replay) => (replay, None),
        Err(flaw @ ReplayError::CutOff { .. }) => match Replay::recovered(&bytes, &[]) {
            Ok(replay) => (replay, Some(flaw)),
            Err(_) => return Verdict::flawed(flaw, Played::default()),
        },
        Err(flaw) => return Verdict::flawed(flaw, Played::default()),
    };
    drop(bytes);
    match (play(&replay, bar), flaw) {
        (Err((divergence, played)), _) => Verdict::diverged(*divergence, played),
        (Ok(played), Some(flaw)) => Verdict::flawed(flaw, played),
        (Ok(played), None) => Verdict { status: Status::Ok, code: None, reason: None, finding: None, played },
    }
}

fn play(replay: &Replay, bar: &ProgressBar) -> Result<Played, (Box<Divergence>, Played)> {
    let start = replay.start();
    bar.inc_length(replay.ticks());
    let mut playback = replay.play();
    let (started, mut ticks, mut hashes) = (Instant::now(), 0, 0);
    let end = loop {
        let stepped = playback.step();
        ticks += u64::from(!matches!(stepped, Ok(false)));
        match stepped {
            Ok(true) => hashes += u64::from(playback.recorded_hash().is_some()),
            Ok(false) => break Ok(()),
            Err(divergence) => break Err(divergence),
        }
        bar.inc(1);
    };
    let wall = started.elapsed();
    let world = playback.world();
    let seconds = |world: &World| world.elapsed().num as f64 / world.elapsed().den as f64;
    let played = Played { ticks, hashes, seconds: seconds(world) - seconds(start), wall };
    end.map_or_else(|divergence| Err((divergence, played)), |()| Ok(played))
}
