//! `umbra diff`: where two recordings part.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use umbra_physics::{Difference, Finding, Moment, Replay, World};

use crate::failure::Failure;
use crate::finding::{DifferenceLine, FindingLine};
use crate::load;

const HELP: &str = "\
What they begin with, what is done tick by tick, and what was recorded of it are compared, as far as both go.

Exit status: 0 if they are the same, 1 if they differ, 2 for bad input or usage.";

#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Options {
    /// A replay.
    a: PathBuf,
    /// Another one.
    b: PathBuf,
    /// Prints the result as a JSON object.
    #[arg(long)]
    json: bool,
    /// Lists every value in which the worlds differ after that tick as well.
    #[arg(long)]
    all: bool,
}

/// What a file holds, by its first bytes.
enum Content {
    Replay(Box<Replay>),
}

impl Content {
    fn load(file: &Path) -> Result<Self, Failure> {
        let bytes = fs::read(file).map_err(Failure::file(file, "read"))?;
        match &bytes {
            _ if bytes.starts_with(load::REPLAY) => load::replay(&bytes, file).map(|it| Self::Replay(Box::new(it))),
            _ => Err(Failure::Foreign { file: file.into() }),
        }
    }
}

/// What came out.
#[derive(Serialize)]
struct Outcome {
    files: [String; 2],
    same: bool,
    /// The ticks after the last that each has; both are the same as far as both go.
    ends: [u64; 2],
    /// Whether each recording was brought to its end.
    complete: [bool; 2],
    finding: Option<FindingLine>,
    #[serde(skip_serializing_if = "Option::is_none")]
    differences: Option<Vec<DifferenceLine>>,
}

pub(crate) fn diff(options: &Options) -> Result<(), Failure> {
    let (a, b) = (Content::load(&options.a)?, Content::load(&options.b)?);
    match (a, b) {
        (Content::Replay(a), Content::Replay(b)) => replays(&a, &b, options),
    }
}

fn replays(a: &Replay, b: &Replay, options: &Options) -> Result<(), Failure> {
    let finding = a.first_difference(b);
    let differences = finding.as_ref().filter(|_| options.all).map(|finding| after(a, b, finding));
    if options.json {
        let outcome = Outcome {
            files: [&options.a, &options.b].map(|file| file.display().to_string()),
            same: finding.is_none(),
            ends: [a.end(), b.end()],
            complete: [a.is_complete(), b.is_complete()],
            finding: finding.as_ref().map(FindingLine::from),
            differences: differences.map(|all| all.iter().map(DifferenceLine::from).collect()),
        };
        // Texts and numbers always have a form in JSON.
        say(&serde_json::to_string(&outcome).unwrap_or_default());
    } else {
        match &finding {
            Some(finding) => say(&finding.to_string()),
            None => say(&same(a, b, options)),
        }
        if let Some(all) = differences {
            say(&format!("values that differ after that: {}", all.len()));
            all.iter().for_each(|difference| say(&format!("  {difference}")));
        }
    }
    let files = || [&options.a, &options.b].map(PathBuf::clone);
    finding.map_or(Ok(()), |_| Err(Failure::Differ { files: files() }))
}

/// The values in which the worlds differ once the tick of a finding is made: as snapshots have them where both do, else as
/// the ticks from the last snapshot on make them here.
fn after(a: &Replay, b: &Replay, finding: &Finding) -> Vec<Difference> {
    let tick = finding.tick.saturating_add(u64::from(finding.moment != Moment::Start));
    let world = |replay: &Replay| -> World {
        let mut playback = replay.play();
        playback.seek(tick);
        playback.world().clone()
    };
    world(a).differences(&world(b))
}

/// How far two are the same.
fn same(a: &Replay, b: &Replay, options: &Options) -> String {
    if a.end() == b.end() {
        return format!("the same, to tick {}", a.end());
    }
    let end = |file: &Path, replay: &Replay| {
        let cut = if replay.is_complete() { "" } else { ", cut off" };
        format!("{} ends at tick {}{cut}", file.display(), replay.end())
    };
    format!("the same as far as both go: {}, {}", end(&options.a, a), end(&options.b, b))
}

/// Without anybody to read it there is still the status.
fn say(line: &str) {
    _ = writeln!(io::stdout(), "{line}");
}
