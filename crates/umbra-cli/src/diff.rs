//! `umbra diff`: where two recordings part.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use umbra_physics::{Difference, Dump, Replay, TickPhase, World};

use crate::failure::Failure;
use crate::finding::{DifferenceLine, FindingLine};
use crate::load::{self, Kind};
use crate::output::Destinations;
use crate::text;

const HELP: &str = "\
Of replays what they begin with, what is done tick by tick, and what was recorded of it are compared, as far as both go; of
desync dumps the worlds before the tick, what was done in it, and the worlds after each of its stages. Numbers are shown with as
many digits as it takes to see the difference; one ulp is 2^-32. To compare two scenes, record both with `umbra run --record`.

Exit status: 0 if they are the same, 1 if they differ, 2 for bad input or usage.";

#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Options {
    /// A replay, or a desync dump; - is the standard input.
    a: PathBuf,
    /// Another one of its kind.
    b: PathBuf,
    /// Prints the result as a JSON object.
    #[arg(long)]
    json: bool,
    /// Lists every value in which the worlds differ after that tick as well.
    #[arg(long)]
    all: bool,
    /// Prints all digits of the values, which JSON always has.
    #[arg(long)]
    exact: bool,
}

/// The contents of a file, told by its first bytes.
enum Content {
    Replay(Box<Replay>),
    Dump(Box<Dump>),
}

impl Content {
    fn load(file: &Path) -> Result<Self, Failure> {
        let bytes = load::bytes(file)?;
        match Kind::of(&bytes) {
            Some(Kind::Replay) => load::replay(&bytes, file).map(|replay| Self::Replay(Box::new(replay))),
            Some(Kind::Dump) => load::dump(&bytes, file).map(|dump| Self::Dump(Box::new(dump))),
            kind => {
                let expected = "a replay or a desync dump of umbra-physics";
                Err(Failure::Foreign { file: file.into(), expected, kind })
            }
        }
    }
}

/// The result.
#[derive(Serialize)]
struct Outcome {
    files: [String; 2],
    same: bool,
    /// The ticks after the last that each has; both are the same as far as both go.
    ends: [u64; 2],
    /// True for each recording that was finished.
    complete: [bool; 2],
    finding: Option<FindingLine>,
    #[serde(skip_serializing_if = "Option::is_none")]
    differences: Option<Vec<DifferenceLine>>,
}

pub(crate) fn diff(options: &Options) -> Result<(), Failure> {
    // The standard output goes over none of them.
    Destinations::beside([&options.a, &options.b])?;
    let (a, b) = (Content::load(&options.a)?, Content::load(&options.b)?);
    match (a, b) {
        (Content::Replay(a), Content::Replay(b)) => {
            let finding = a.first_difference(&b);
            let all = finding.as_ref().filter(|_| options.all).map(|finding| after(&a, &b, finding));
            let ends = [(a.end(), a.is_complete()), (b.end(), b.is_complete())];
            report(finding, all, ends, options)
        }
        (Content::Dump(a), Content::Dump(b)) => {
            let finding = a.first_difference(&b);
            let all = finding.as_ref().filter(|_| options.all).map(|finding| at_moment(&a, &b, finding));
            report(finding, all, [&a, &b].map(|dump| (dump.tick() + 1, true)), options)
        }
        _ => Err(Failure::Option {
            what: "a replay and a desync dump cannot be compared: give two replays or two dumps".to_string(),
        }),
    }
}

/// Says what was found. `ends` are the ticks after the last, and whether a recording was brought to its end.
fn report(
    finding: Option<Difference>,
    differences: Option<Vec<Difference>>,
    ends: [(u64, bool); 2],
    options: &Options,
) -> Result<(), Failure> {
    if options.json {
        let outcome = Outcome {
            files: [&options.a, &options.b].map(|file| file.display().to_string()),
            same: finding.is_none(),
            ends: ends.map(|(end, _)| end),
            complete: ends.map(|(_, complete)| complete),
            finding: finding.as_ref().map(FindingLine::from),
            differences: differences.map(|all| all.iter().map(DifferenceLine::from).collect()),
        };
        // Texts and numbers always have a form in JSON.
        text::print(serde_json::to_string(&outcome).unwrap_or_default())?;
    } else {
        text::print(finding.as_ref().map_or_else(|| same(ends, options), |finding| said(finding, options.exact)))?;
        if let Some(all) = differences {
            text::print(format_args!("values that differ after that: {}", all.len()))?;
            for difference in &all {
                let line =
                    if options.exact { format!("  {:#}", difference.exact()) } else { format!("  {difference:#}") };
                text::print(line)?;
            }
        }
    }
    finding.map_or(Ok(()), |_| {
        let what = format!("{} and {} are not the same", text::path(&options.a), text::path(&options.b));
        Err(Failure::Check { what })
    })
}

fn said(difference: &Difference, exact: bool) -> String {
    if exact { difference.exact().to_string() } else { difference.to_string() }
}

/// The values in which the worlds of two dumps differ at the moment of a finding.
fn at_moment(a: &Dump, b: &Dump, finding: &Difference) -> Vec<Difference> {
    let world = |dump: &Dump| dump.phases().find(|(phase, _)| *phase == finding.phase).map(|(_, world)| world.clone());
    world(a).zip(world(b)).map(|(a, b)| a.differences(&b)).unwrap_or_default()
}

/// The values in which the worlds differ once the tick of a finding is made: as snapshots have them where both do, else as
/// the ticks from the last snapshot on make them here.
fn after(a: &Replay, b: &Replay, finding: &Difference) -> Vec<Difference> {
    let tick = finding.tick.saturating_add(u64::from(finding.phase != TickPhase::Start));
    let world = |replay: &Replay| -> World {
        let mut playback = replay.play();
        playback.seek(tick);
        playback.world().clone()
    };
    let mut all = world(a).differences(&world(b));
    for difference in &mut all {
        difference.name = [a, b].into_iter().find_map(|replay| replay.labels().owner(difference.owner));
    }
    all
}

/// Says how far two recordings are the same.
fn same(ends: [(u64, bool); 2], options: &Options) -> String {
    let [(a, _), (b, _)] = ends;
    if a == b {
        return format!("the same, to tick {a}");
    }
    let end = |file: &Path, (end, complete): (u64, bool)| {
        let cut = if complete { "" } else { ", cut off" };
        format!("{} ends at tick {end}{cut}", text::path(file))
    };
    format!("the same as far as both go: {}, {}", end(&options.a, ends[0]), end(&options.b, ends[1]))
}
