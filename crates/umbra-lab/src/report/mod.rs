//! `umbra-lab report`: time against error, for every integrator, scalar and time step; the quality of contacts.

mod analysis;
mod conclude;
mod contacts;
mod data;
mod measure;
mod page;
mod parting;
mod problem;
mod quality;

use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::ProgressBar;
use umbra_cli::failure::Failure;
use umbra_cli::format::Format;
use umbra_cli::output::{Destination, Destinations};
use umbra_cli::progress::progress;
use umbra_physics::{Fx, Integrator, Scalar};
use umbra_scene::{Scene, SceneError, SceneErrors};

use crate::threads::at_once;
use crate::truth::Exact;
use data::{Line, Machine, Measured, Report, Results};
use measure::Run;
use parting::Parting;
use problem::{PROBLEMS, Problem, Truth};
use quality::Row;

/// The number of sub-steps of a world that says nothing else.
const SUBSTEPS: u32 = 5;

#[derive(Args)]
pub(crate) struct Options {
    /// Writes the report as a page that needs nothing else.
    #[arg(long, value_name = "FILE.html", default_value = "report.html")]
    out: PathBuf,
    /// Writes the same as data.
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    /// Draws time against error of one problem by itself: the orbit, or the first there is.
    #[arg(long, value_name = "FILE.svg")]
    diagram: Option<PathBuf>,
    /// A few time steps, measured once: seconds instead of minutes. With `--contacts`: shorter runs and fewer shots.
    #[arg(long)]
    quick: bool,
    /// These problems alone, and not the chaotic scene.
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = problem)]
    problem: Vec<&'static Problem>,
    /// Measures the quality of contacts instead: stacks, slopes, bounces, shots and impacts, beside what is promised. A broken promise is
    /// status 1.
    #[arg(long, conflicts_with_all = ["problem", "diagram"])]
    contacts: bool,
    /// These scenes of `--contacts` alone.
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = quality::row, requires = "contacts")]
    scene: Vec<&'static Row>,
    /// The number of sub-steps in which `--contacts` solves contacts, 1 to 16. The promises are about 5.
    #[arg(long, value_name = "N", default_value_t = SUBSTEPS, value_parser = clap::value_parser!(u32).range(1..=16), requires = "contacts")]
    substeps: u32,
}

fn problem(name: &str) -> Result<&'static Problem, String> {
    let names = || PROBLEMS.iter().map(|problem| problem.name).collect::<Vec<_>>().join(", ");
    PROBLEMS.iter().find(|problem| problem.name == name).ok_or_else(|| format!("expected one of {}", names()))
}

/// The measurements to make, and how thorough they are.
struct Effort {
    /// Steps a second. All divide what ends a problem evenly.
    rates: &'static [u32],
    /// Batches that each run is timed in. The fastest counts: what slows one down is somebody else.
    batches: u32,
    /// The length of the chaotic scene, s.
    parting: u32,
}

const FULL: Effort =
    Effort { rates: &[10, 20, 30, 60, 120, 240, 500, 1000, 2000, 5000, 10_000], batches: 5, parting: 40 };
const QUICK: Effort = Effort { rates: &[10, 60, 240, 1000], batches: 1, parting: 2 };

impl Options {
    /// The command that makes the same report again.
    fn command(&self) -> String {
        let mut command = String::from("cargo run --release -p umbra-lab -- report");
        let mut file = |option: &str, path: &Path| command += &format!(" {option} {}", path.display());
        file("--out", &self.out);
        self.json.iter().for_each(|path| file("--json", path));
        self.diagram.iter().for_each(|path| file("--diagram", path));
        if self.quick {
            command += " --quick";
        }
        self.problem.iter().for_each(|problem| command += &format!(" --problem {}", problem.name));
        if self.contacts {
            command += " --contacts";
        }
        self.scene.iter().for_each(|row| command += &format!(" --scene {}", row.name));
        if self.contacts && self.substeps != SUBSTEPS {
            command += &format!(" --substeps {}", self.substeps);
        }
        command
    }
}

/// The destinations of a report.
struct Outputs {
    page: Destination,
    data: Option<Destination>,
    diagram: Option<Destination>,
}

impl Outputs {
    fn of(options: &Options) -> Result<Self, Failure> {
        let mut all = Destinations::beside([])?;
        let (page, data) = (all.add(&options.out, Format::Html)?, all.add_any(options.json.as_ref(), Format::Json)?);
        Ok(Self { page, data, diagram: all.add_any(options.diagram.as_ref(), Format::Svg)? })
    }
}

pub(crate) fn report(options: &Options) -> Result<(), Failure> {
    if options.contacts {
        return quality::report(options);
    }
    let outputs = Outputs::of(options)?;
    let effort = if options.quick { QUICK } else { FULL };
    let chosen: Vec<&Problem> =
        if options.problem.is_empty() { PROBLEMS.iter().collect() } else { options.problem.clone() };
    let built_in = |error: SceneErrors| Failure::Option { what: format!("a built-in scene is refused: {error}") };
    let runs = Integrator::ALL.len() * SCALARS.len() * effort.rates.len();
    let progress = progress((chosen.len() * runs) as u64 * u64::from(1 + effort.batches), "run");
    let experiments = at_once(&chosen, |problem| Experiment::new(problem, &effort, &progress));
    let mut experiments = experiments.into_iter().collect::<Result<Vec<_>, _>>().map_err(built_in)?;
    let parting = if options.problem.is_empty() { Parting::measure(effort.parting).map_err(built_in)? } else { None };
    // One after the other: each has a processor to itself. Batches of the same run lie apart in time: what disturbs one will have passed.
    for _ in 0..effort.batches {
        experiments.iter_mut().for_each(|experiment| experiment.time(&progress));
    }
    progress.finish_and_clear();
    let (contacts, problems) =
        experiments.into_iter().map(|experiment| experiment.results).partition(|results| results.has_contacts);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        command: options.command(),
        machine: Machine::this(),
        rates: effort.rates.to_vec(),
        problems,
        contacts,
        parting,
    };
    outputs.page.write(&page::page(&report))?;
    if let Some(data) = &outputs.data {
        data.write(&(serde_json::to_string(&report).unwrap_or_default() + "\n"))?;
    }
    outputs.diagram.map_or(Ok(()), |diagram| diagram.write(&page::diagram(&report)))
}

const SCALARS: [&str; 3] = [Fx::NAME, <f64 as Scalar>::NAME, <f32 as Scalar>::NAME];

/// A run in whichever scalar.
trait Costs {
    fn cost(&mut self) -> f64;
}

impl<S: Scalar> Costs for Run<S> {
    fn cost(&mut self) -> f64 {
        Self::cost(self)
    }
}

/// A problem's runs, in the order of its lines, and what is known of them so far.
struct Experiment {
    runs: Vec<Box<dyn Costs + Send>>,
    results: Results,
}

impl Experiment {
    fn new(problem: &Problem, effort: &Effort, progress: &ProgressBar) -> Result<Self, SceneErrors> {
        let scene = problem.scene()?;
        let start = scene.build()?;
        let truth = problem
            .truth(&start)
            .ok_or_else(|| SceneError::new(scene.place.clone(), "its motion is not known".to_owned()))?;
        let results = Results {
            name: problem.name,
            title: problem.title,
            about: problem.about,
            has_contacts: problem.has_contacts(),
            unit: problem.unit(),
            seconds: problem.seconds,
            reference_error: truth.error,
            lines: Vec::new(),
        };
        let mut experiment = Self { runs: Vec::new(), results };
        let set = Set { problem, scene: &scene, truth: &truth, effort, progress };
        for integrator in Integrator::ALL {
            experiment.add::<Fx>(&set, integrator)?;
            experiment.add::<f64>(&set, integrator)?;
            experiment.add::<f32>(&set, integrator)?;
        }
        experiment.find_orders();
        Ok(experiment)
    }

    /// Adds the line of an integrator in a scalar.
    fn add<S>(&mut self, set: &Set<'_>, integrator: Integrator) -> Result<(), SceneError>
    where
        S: Scalar<Accumulator: Exact, Angle: Exact>,
    {
        let mut runs = Vec::new();
        for &rate in set.effort.rates {
            let run = Run::<S>::new(set.problem, set.scene, integrator, rate)?;
            runs.push(Measured { rate, error: run.error(set.problem, set.truth), cost: f64::INFINITY });
            self.runs.push(Box::new(run));
            set.progress.inc(1);
        }
        self.results.lines.push(Line { integrator, scalar: S::NAME, order: None, runs });
        Ok(())
    }

    /// fx and f64 show each other's order, f32 shows its own beside f64.
    fn find_orders(&mut self) {
        for lines in self.results.lines.chunks_mut(SCALARS.len()) {
            let [fixed, double, single] = lines else { continue };
            let order = if self.results.has_contacts { analysis::trend } else { analysis::order };
            fixed.order = order(&fixed.runs, &double.runs);
            double.order = fixed.order;
            single.order = order(&single.runs, &double.runs);
        }
    }

    /// Times each run once more.
    fn time(&mut self, progress: &ProgressBar) {
        let measured = self.results.lines.iter_mut().flat_map(|line| &mut line.runs);
        for (run, measured) in self.runs.iter_mut().zip(measured) {
            measured.cost = measured.cost.min(run.cost() / f64::from(self.results.seconds));
            progress.inc(1);
        }
    }
}

/// The settings that the lines of a problem share.
struct Set<'a> {
    problem: &'a Problem,
    scene: &'a Scene,
    truth: &'a Truth,
    effort: &'a Effort,
    progress: &'a ProgressBar,
}
