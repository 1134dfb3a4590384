//! `umbra-lab report --contacts`: measures of stacks, slopes, bounces, shots and impacts, beside their promises and the figures of other engines.

mod impacts;
mod page;
mod peers;
mod rows;
mod run;
mod scenes;
mod shots;

use serde::Serialize;
use umbra_cli::failure::Failure;
use umbra_cli::format::Format;
use umbra_cli::output::{Destination, Destinations};
use umbra_cli::picture::still;
use umbra_cli::progress::progress;
use umbra_cli::text;

use super::Options;
use crate::threads::at_once;
use peers::{BOX2D, PEERS, Peer, figure};
pub(crate) use rows::Row;
use rows::{Length, Measure, Promise, rows};

/// The scene of a name.
pub(super) fn row(name: &str) -> Result<&'static Row, String> {
    let names = || rows().map(|row| row.name).collect::<Vec<_>>().join(", ");
    rows().find(|row| row.name == name).ok_or_else(|| format!("expected one of {}", names()))
}

/// The data of a page. These are the fields of its JSON file, which `docs/report/README.md` describes.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    command: String,
    substeps: u32,
    peers: [Peer; PEERS.len()],
    scenes: Vec<Results>,
}

/// A scene and its measures.
#[derive(Serialize)]
struct Results {
    name: &'static str,
    #[serde(skip)]
    row: &'static Row,
    /// The duration of the run, or the number of shots.
    length: String,
    /// The end of the run, and charts, as HTML.
    #[serde(skip)]
    picture: String,
    measures: Vec<Judged>,
}

/// A measure with its promise and the figures of other engines.
#[derive(Serialize)]
struct Judged {
    name: &'static str,
    #[serde(skip)]
    about: &'static str,
    unit: &'static str,
    /// `None` if the event whose time is measured never happened.
    value: Option<f64>,
    promise: Option<String>,
    verdict: Verdict,
    peers: Vec<Figure>,
}

/// A figure of another engine.
#[derive(Serialize)]
struct Figure {
    engine: &'static str,
    value: Option<f64>,
    length: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Verdict {
    Passed,
    Failed,
    /// A goal that is not reached yet, or not always.
    Open,
    /// Nothing is promised.
    Measured,
}

impl Verdict {
    fn name(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Open => "open",
            Self::Measured => "measured",
        }
    }
}

impl Promise {
    /// The promise in words, with the figure of Box2D where it is about that.
    fn words(self, unit: &str, box2d: Option<f64>) -> String {
        let with = |value: f64| [number(value).as_str(), unit].join(" ").trim_end().to_owned();
        match self {
            Self::AtMost(max) => format!("at most {}", with(max)),
            Self::AtLeast(min) => format!("at least {}", with(min)),
            Self::Within(0.0, tolerance) => format!("at most ±{}", with(tolerance)),
            Self::Within(value, tolerance) => format!("{} ± {}", number(value), with(tolerance)),
            Self::Zero => "0, to the bit".to_owned(),
            Self::NoMoreThanBox2d => {
                format!("no more than Box2D{}", box2d.map_or(String::new(), |value| format!(", {}", with(value))))
            }
        }
    }

    /// Returns true if a value keeps the promise. No promise holds of NaN.
    fn holds(self, value: f64, box2d: Option<f64>) -> bool {
        match self {
            Self::AtMost(max) => value <= max,
            Self::AtLeast(min) => value >= min,
            Self::Within(middle, tolerance) => (value - middle).abs() <= tolerance,
            Self::Zero => value == 0.0,
            Self::NoMoreThanBox2d => box2d.is_some_and(|max| value <= max),
        }
    }
}

impl Judged {
    fn new(scene: &str, measure: &Measure) -> Self {
        let Measure { name, about, unit, value, promise, open } = *measure;
        let figures = PEERS.into_iter().filter_map(|peer| Some((peer, figure(peer, scene, name)?)));
        let box2d = figure(BOX2D, scene, name).map(|(value, _)| value);
        let verdict = match promise {
            _ if open => Verdict::Open,
            None => Verdict::Measured,
            Some(promise) if promise.holds(value, box2d) => Verdict::Passed,
            Some(_) => Verdict::Failed,
        };
        Self {
            name,
            about,
            unit,
            value: Some(value).filter(|value| value.is_finite()),
            promise: promise.map(|promise| promise.words(unit, box2d)),
            verdict,
            peers: figures
                .map(|(peer, (value, length))| Figure {
                    engine: peer.id,
                    value: Some(value).filter(|value| value.is_finite()),
                    length,
                })
                .collect(),
        }
    }

    /// The value with its unit.
    fn shown(&self) -> String {
        self.value
            .map_or("never".to_owned(), |value| [number(value).as_str(), self.unit].join(" ").trim_end().to_owned())
    }

    /// A line of text: scene, measure, value, promise.
    fn line(&self, scene: &str) -> String {
        let promise = self.promise.as_ref().map_or(String::new(), |promise| {
            let what = if self.verdict == Verdict::Open { "goal" } else { "promised" };
            format!("; {what}: {promise}")
        });
        format!("{scene} {}: {}{promise}", self.name, self.shown())
    }
}

/// Formats a number with three significant digits; a whole number below a million keeps all of its digits. Trailing zeros are left out.
fn number(value: f64) -> String {
    let trimmed = |text: String| {
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        text.replace('-', "\u{2212}")
    };
    if value.fract() == 0.0 && value.abs() < 1e6 {
        return trimmed(format!("{value:.0}"));
    }
    let text = format!("{value:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    match power {
        -3..=2 => trimmed(format!("{value:.*}", (2 - power) as usize)),
        _ => format!("{}·{}", trimmed(digits.to_owned()), crate::chart::power_of_ten(power)),
    }
}

/// The destinations of a page.
struct Outputs {
    page: Destination,
    data: Option<Destination>,
}

pub(super) fn report(options: &Options) -> Result<(), Failure> {
    let outputs = {
        let mut all = Destinations::beside([])?;
        Outputs { page: all.add(&options.out, Format::Html)?, data: all.add_any(options.json.as_ref(), Format::Json)? }
    };
    let chosen: Vec<&'static Row> = if options.scene.is_empty() { rows().collect() } else { options.scene.clone() };
    let length = Length { substeps: options.substeps, quick: options.quick };
    let progress = progress(chosen.len() as u64, "scene");
    let scenes = at_once(&chosen, |row| {
        let results = play(row, length);
        progress.inc(1);
        results
    });
    let scenes = scenes.into_iter().collect::<Result<Vec<_>, _>>()?;
    progress.finish_and_clear();
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        command: options.command(),
        substeps: options.substeps,
        peers: PEERS,
        scenes,
    };
    outputs.page.write(&page::page(&report))?;
    if let Some(data) = &outputs.data {
        data.write(&(serde_json::to_string(&report).unwrap_or_default() + "\n"))?;
    }
    let all = || report.scenes.iter().flat_map(|scene| scene.measures.iter().map(|measure| (scene.name, measure)));
    let lines: Vec<String> =
        all().map(|(scene, measure)| format!("{:8} {}", measure.verdict.name(), measure.line(scene))).collect();
    text::print(lines.join("\n"))?;
    let promised = all().filter(|(_, measure)| matches!(measure.verdict, Verdict::Passed | Verdict::Failed)).count();
    let broken: Vec<String> = all()
        .filter(|(_, measure)| measure.verdict == Verdict::Failed)
        .map(|(scene, measure)| measure.line(scene))
        .collect();
    if broken.is_empty() {
        return Ok(());
    }
    let what = format!("{} of {promised} promises are not kept:\n{}", broken.len(), broken.join("\n"));
    Err(Failure::Check { what })
}

fn play(row: &'static Row, length: Length) -> Result<Results, Failure> {
    let refused = |error| Failure::Option { what: format!("a built-in scene is refused: {error}") };
    let played = (row.play)(length).map_err(refused)?;
    let picture = still(&played.world, row.title, played.view.or(row.view));
    let measures = played.measures.iter().map(|measure| Judged::new(row.name, measure)).collect();
    let picture = picture.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1) + &played.charts;
    Ok(Results { name: row.name, row, length: played.length, picture, measures })
}

#[cfg(test)]
mod tests;
