//! `umbra selftest`: the built-in corpus, in every way this machine has, against the golden digests.

use clap::Args;
use serde::Serialize;
use umbra_physics::PHYSICS_VERSION;
use umbra_physics::selftest::Outcome;

use crate::failure::Failure;
use crate::text;

use umbra_selftest::{Checked, Verdict, Way, check};

#[derive(Args)]
pub(crate) struct Options {
    /// Prints a JSON object a line: one for each scene, then one for all.
    #[arg(long)]
    json: bool,
}

/// A scene in JSON. Digests are text: not every reader keeps 64 bits of a number.
#[derive(Serialize)]
struct SceneLine<'a> {
    scene: &'a str,
    about: &'a str,
    ticks: Option<u64>,
    digest: Option<String>,
    agrees: bool,
    troubles: Vec<String>,
    wall_seconds: f64,
}

/// All scenes in JSON.
#[derive(Serialize)]
struct LastLine {
    physics_version: u32,
    ways: Vec<String>,
    ticks: Option<u64>,
    digest: Option<String>,
    agrees: bool,
}

fn digest(outcome: Outcome) -> String {
    format!("{:016x}", outcome.digest)
}

pub(crate) fn selftest(options: &Options) -> Result<(), Failure> {
    let ways = Way::all();
    let names: Vec<String> = ways.iter().map(ToString::to_string).collect();
    let mut printed = Ok(());
    let mut print = |line: String| {
        if printed.is_ok() {
            printed = text::print(line);
        }
    };
    let verdict = if options.json {
        let verdict = check(&ways, |checked| print(json(&scene_line(checked))));
        let Verdict { all, agrees } = verdict;
        print(json(&LastLine {
            physics_version: PHYSICS_VERSION,
            ways: names,
            ticks: all.map(|all| all.ticks),
            digest: all.map(digest),
            agrees,
        }));
        verdict
    } else {
        print(format!("{:<24} {:>6}  {:<16}  {:>9}  ", "scene", "ticks", "digest", "time"));
        let verdict = check(&ways, |checked| print(row(checked)));
        let all = verdict.all.map_or_else(|| "one failed".to_owned(), digest);
        print(format!("\n{:<24} {:>6}  {all}", "all", verdict.all.map_or(0, |all| all.ticks)));
        print(format!("{:<24} {PHYSICS_VERSION}", "physics version"));
        names.iter().for_each(|name| print(format!("{:<24} {name}", "alike with")));
        let word = if verdict.agrees { "agrees: this machine computes what all others do" } else { "DOES NOT AGREE" };
        print(word.to_owned());
        verdict
    };
    printed?;
    if verdict.agrees {
        return Ok(());
    }
    let what = "the self-test does not give the golden digests, which every machine must give".to_owned();
    Err(Failure::Check { what })
}

fn row(checked: &Checked) -> String {
    let name = checked.scene.name();
    let mut row = match checked.outcome {
        Some(outcome) => format!("{name:<24} {:>6}  {}", outcome.ticks, digest(outcome)),
        None => format!("{name:<24} {:>6}  {:<16}", "", "failed"),
    };
    row += &format!(
        "  {:>6.1} ms  {}",
        checked.time.as_secs_f64() * 1e3,
        if checked.troubles.is_empty() { "ok" } else { "" }
    );
    for trouble in &checked.troubles {
        row += &format!("\n  {trouble}");
    }
    row
}

fn scene_line(checked: &Checked) -> SceneLine<'static> {
    SceneLine {
        scene: checked.scene.name(),
        about: checked.scene.about(),
        ticks: checked.outcome.map(|outcome| outcome.ticks),
        digest: checked.outcome.map(digest),
        agrees: checked.troubles.is_empty(),
        troubles: checked.troubles.iter().map(ToString::to_string).collect(),
        wall_seconds: checked.time.as_secs_f64(),
    }
}

/// Texts, numbers and lists of them always have a form in JSON.
fn json(line: &impl Serialize) -> String {
    serde_json::to_string(line).unwrap_or_default()
}
