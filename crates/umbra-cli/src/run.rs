//! `umbra run`: a scene from a file, to its end.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use umbra_physics::scalar::ToF64;
use umbra_physics::{Fx, Integrator, RecordOptions, Scalar, Stepper, WorldDef};
use umbra_scene::{Scene, SceneRun};

use crate::failure::Failure;
use crate::format::Format;
use crate::load;
use crate::open;
use crate::output::{Destination, Destinations};
use crate::picture::{ContactMark, ContactOptions, Subject};
use crate::profile::Profile;
use crate::progress::progress;
use crate::record::Recording;
use crate::sheets::{SheetFiles, SheetOptions, Sheets};
use crate::summary::{FaultLine, Summary, Totals};
use crate::text;

#[derive(Args)]
pub(crate) struct Options {
    /// The scene, a JSON file; - is the standard input.
    scene: PathBuf,
    /// Number of steps [default: what the scene says].
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
    /// The numbers to compute with.
    #[arg(long, value_enum, default_value_t = Numbers::Fx)]
    scalar: Numbers,
    /// The integrator [default: what the scene says].
    #[arg(long, value_name = "NAME", value_parser = integrator)]
    integrator: Option<Integrator>,
    #[command(flatten)]
    sheets: SheetOptions,
    /// Draws contacts at the end of the run as well; several kinds are parted by commas.
    #[arg(long, value_enum, value_name = "KINDS", value_delimiter = ',', requires = "plot")]
    contacts: Vec<ContactMark>,
    /// Length of an impulse in the picture, m for each N·s [default: a tenth of the picture for the largest].
    #[arg(long, value_name = "M", requires = "contacts", value_parser = positive)]
    impulse_scale: Option<f64>,
    /// Opens the picture in the program that the system has for it.
    #[arg(long, requires = "plot")]
    open: bool,
    /// Records the run as a replay, for `verify`, `diff` and `view`. The time it takes counts as that of the steps.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Records a hash each so many ticks: how exactly a divergence is dated.
    #[arg(long, value_name = "N", default_value_t = RecordOptions::default().hash_every, requires = "record", value_parser = clap::value_parser!(u32).range(1..))]
    hash_every: u32,
    /// Records a snapshot each so many ticks, 0 for one at the end alone: what a divergence is named by.
    #[arg(long, value_name = "N", default_value_t = RecordOptions::default().snapshot_every, requires = "record")]
    snapshot_every: u32,
    /// Prints also where the time of the steps went: µs a step by part, and counts a step.
    #[arg(long)]
    profile: bool,
    /// Prints the result as a JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Numbers {
    /// I32F32 fixed point: the same bits on every machine.
    Fx,
    /// Double precision, to compare with.
    F64,
    /// Single precision, to compare with.
    F32,
}

fn integrator(name: &str) -> Result<Integrator, String> {
    Integrator::from_name(name)
        .ok_or_else(|| format!("expected one of {}", Integrator::ALL.map(Integrator::name).join(", ")))
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

/// The destinations of the outputs of a run.
struct Outputs {
    sheets: SheetFiles,
    record: Option<Destination>,
}

impl Outputs {
    fn of(options: &Options) -> Result<Self, Failure> {
        let mut all = Destinations::beside([&options.scene])?;
        Ok(Self {
            sheets: SheetFiles::new(&options.sheets, &mut all)?,
            record: all.add_any(options.record.as_ref(), Format::Replay)?,
        })
    }

    /// Prints the result, on the standard error where another output has the standard output.
    fn tell(&self, summary: &Summary, json: bool) -> Result<(), Failure> {
        if !self.sheets.has_stdout() && !self.record.as_ref().is_some_and(Destination::is_stdout) {
            return text::print_result(summary, json);
        }
        text::warn(text::result(summary, json).trim_end());
        Ok(())
    }
}

pub(crate) fn run(options: &Options) -> Result<(), Failure> {
    let outputs = Outputs::of(options)?;
    let opened = outputs.sheets.plot.as_ref().filter(|_| options.open).map(open::file).transpose()?;
    let mut scene = load::scene(&options.scene)?;
    if let Some(integrator) = options.integrator {
        scene.world = WorldDef { integrator, ..scene.world };
        scene.build::<Fx>().map_err(|error| Failure::Option {
            what: format!(
                "--integrator {} does not go with {}: {}",
                integrator.name(),
                text::path(&options.scene),
                error.message
            ),
        })?;
    }
    let done = match (options.scalar, &outputs.record) {
        (Numbers::Fx, Some(to)) => record(&scene, options, &outputs, to),
        (_, Some(_)) => {
            Err(Failure::Option { what: "--record needs --scalar fx: a replay has fixed-point states".to_owned() })
        }
        (Numbers::Fx, None) => start::<Fx>(&scene, options, &outputs),
        (Numbers::F64, None) => start::<f64>(&scene, options, &outputs),
        (Numbers::F32, None) => start::<f32>(&scene, options, &outputs),
    };
    done.and_then(|()| opened.map_or(Ok(()), open::open))
}

fn start<S: Scalar + ToF64>(scene: &Scene, options: &Options, outputs: &Outputs) -> Result<(), Failure>
where
    S::Wide: ToF64,
{
    let mut run = scene.start::<S>().map_err(Failure::scene(&options.scene))?;
    outputs.tell(&simulate(scene, &mut run, &mut (), |()| Ok(()), options, outputs)?, options.json)
}

fn record(scene: &Scene, options: &Options, outputs: &Outputs, to: &Destination) -> Result<(), Failure> {
    let Options { hash_every, snapshot_every, .. } = *options;
    let mut run = scene.start::<Fx>().map_err(Failure::scene(&options.scene))?;
    let mut recording = Recording::create(to, run.world(), RecordOptions { hash_every, snapshot_every })?;
    match simulate(scene, &mut run, &mut recording, Recording::check, options, outputs) {
        Ok(summary) => {
            recording.finish(&run)?;
            outputs.tell(&summary, options.json)
        }
        Err(failure) => {
            recording.break_off();
            Err(failure)
        }
    }
}

/// Runs a scene to its end, with whatever was asked to be made on the way; `check` is asked after each step whether the
/// driver can go on.
fn simulate<S: Scalar + ToF64, D: Stepper<S>>(
    scene: &Scene,
    run: &mut SceneRun<'_, S>,
    driver: &mut D,
    check: impl Fn(&mut D) -> Result<(), Failure>,
    options: &Options,
    outputs: &Outputs,
) -> Result<Summary, Failure>
where
    S::Wide: ToF64,
{
    let at_fault = Failure::scene(&options.scene);
    let ticks = options.ticks.unwrap_or(scene.ticks);
    let contacts = ContactOptions { marks: options.contacts.clone(), impulse_scale: options.impulse_scale };
    let mut sheets = Sheets::create(&outputs.sheets, Subject::of(scene), ticks, contacts)?;
    let before = Totals::of(run.world());
    let (mut faults, mut body_steps, mut stepping) = (Vec::new(), 0u64, Duration::ZERO);
    let progress = progress(ticks, "tick");
    sheets.see(run.world(), run)?;
    for tick in 0..ticks {
        let started = Instant::now();
        let report = run.advance_by(driver).map_err(&at_fault)?;
        stepping += started.elapsed();
        check(driver)?;
        let tick_faults = report.faults.to_vec();
        for fault in tick_faults {
            let name = run.name(fault.body).to_owned();
            faults.push(FaultLine { tick: tick + 1, name, cause: fault.cause.to_string() });
        }
        body_steps += run.world().body_count() as u64;
        sheets.see(run.world(), run)?;
        progress.set_position(tick + 1);
    }
    progress.finish_and_clear();
    let mut summary = Summary::new(scene, run.world(), before, faults, stepping, body_steps);
    summary.profile = options.profile.then(|| Profile::of(run.world()));
    sheets.finish(run.world(), run)?;
    Ok(summary)
}
