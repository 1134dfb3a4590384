//! `umbra-lab compare`: a scene in every scalar with every integrator, against a converged reference.

mod outcome;
mod way;

use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use umbra_cli::failure::Failure;
use umbra_cli::format::Format;
use umbra_cli::load;
use umbra_cli::output::Destinations;
use umbra_cli::progress::progress;
use umbra_cli::text;
use umbra_physics::scalar::ToF64;
use umbra_physics::{Activity, Command, Fx, Integrator, Scalar, TimeStep, WorldDef, limits};
use umbra_scene::{Scene, SceneAction, SceneError};

use crate::cost::cpu_seconds;
use outcome::{Comparison, Numbers, Outcome, Reference};
use way::{Gap, Stride, Way};

#[derive(Args)]
pub(crate) struct Options {
    /// The scene, a JSON file.
    scene: PathBuf,
    /// Number of ticks [default: what the scene says].
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
    /// Steps of the reference to a tick [default: the power of two up to 64 that still is a step of 1/10,000 s or more].
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(2..))]
    finer: Option<u32>,
    /// Draws the errors over time.
    #[arg(long, value_name = "FILE.svg")]
    out: Option<PathBuf>,
    /// Prints the result as a JSON object.
    #[arg(long)]
    json: bool,
}

pub(crate) fn compare(options: &Options) -> Result<(), Failure> {
    let out = Destinations::beside([&options.scene])?.add_any(options.out.as_ref(), Format::Svg)?;
    let mut scene = load::scene(&options.scene)?;
    // Every run keeps the integrator it is there for.
    scene.inputs.retain(|input| !matches!(input.action, SceneAction::Command(Command::SetIntegrator(_))));
    let ticks = options.ticks.unwrap_or(scene.ticks);
    if ticks == 0 {
        return Err(Failure::Option {
            what: format!("{}: nothing moves in 0 ticks: give --ticks of at least 1", text::path(&options.scene)),
        });
    }
    let finer = finer(&scene, options)?;
    let stride = Stride::of(&scene, ticks);
    let rows = 3 * Integrator::ALL.len() as u64;
    let progress = progress(ticks.saturating_mul(rows + u64::from(finer + finer / 2)), "step");
    let task = Task { scene: &scene, ticks, stride, progress: &progress };
    let (reference, way) = task.reference(finer).map_err(Failure::scene(&options.scene))?;
    let mut outcomes = Vec::new();
    for integrator in Integrator::ALL {
        outcomes.push(task.outcome::<Fx>(integrator, &way));
        outcomes.push(task.outcome::<f64>(integrator, &way));
        outcomes.push(task.outcome::<f32>(integrator, &way));
    }
    progress.finish_and_clear();
    let comparison = Comparison { title: scene.title.clone(), ticks, seconds: way.seconds(), reference, outcomes };
    if let Some(out) = &out {
        out.write(&comparison.draw())?;
    }
    text::print_result(&comparison, options.json)
}

/// Steps of the reference to a tick.
fn finer(scene: &Scene, options: &Options) -> Result<u32, Failure> {
    const MOST: u32 = 64;
    let changed = scene.inputs.iter().filter_map(|input| match input.action {
        SceneAction::Command(Command::SetTimeStep(time_step)) => Some(time_step),
        _ => None,
    });
    let room = |time_step: TimeStep| {
        let (num, den) = time_step.seconds();
        u64::from(limits::RATE_MAX) * u64::from(num) / u64::from(den.max(1))
    };
    let room = changed.chain([scene.world.time_step]).map(room).min().unwrap_or(0);
    let room = u32::try_from(room).unwrap_or(u32::MAX);
    let wanted = options.finer.unwrap_or(MOST.min(1 << room.max(1).ilog2()));
    if wanted < 2 || wanted > room {
        let file = text::path(&options.scene);
        let rate = limits::RATE_MAX;
        return Err(Failure::Option {
            what: format!("{file}: a reference needs 2 or more steps to a tick, and {rate} a second allow {room}"),
        });
    }
    Ok(wanted)
}

/// The settings that all runs of a comparison share.
struct Task<'a> {
    scene: &'a Scene,
    ticks: u64,
    stride: Stride,
    progress: &'a ProgressBar,
}

impl Task<'_> {
    fn with(&self, integrator: Integrator) -> Scene {
        Scene { world: WorldDef { integrator, ..self.scene.world }, ..self.scene.clone() }
    }

    /// The scene in f64 with many steps to a tick, and how far it is from one with half as many. By Yoshida's rule, unless
    /// the scene has something without an inverse.
    fn reference(&self, finer: u32) -> Result<(Reference, Way), SceneError> {
        let reference = |integrator| {
            let scene = self.with(integrator);
            let (way, _) = self.way::<f64>(&scene, finer)?;
            let (rough, _) = self.way::<f64>(&scene, finer / 2)?;
            let gaps = way.gaps(&rough);
            Ok((Reference::new(integrator, finer, gaps), way))
        };
        reference(Integrator::Yoshida4).or_else(|_: SceneError| reference(Integrator::VelocityVerlet))
    }

    /// Runs a way; returns where the bodies are in the course of it, and how many were quarantined.
    fn way<S: Scalar<Accumulator: ToF64, Angle: ToF64>>(
        &self,
        scene: &Scene,
        finer: u32,
    ) -> Result<(Way, usize), SceneError> {
        let mut run = scene.start_finer::<S>(finer)?;
        let mut way = Way::default();
        way.record(&run);
        for tick in 1..=self.ticks {
            run.advance()?;
            if self.stride.is_due(tick) || tick == self.ticks {
                way.record(&run);
            }
            self.progress.inc(finer.into());
        }
        let quarantined = run.world().bodies().filter(|body| body.activity() == Activity::Quarantined).count();
        Ok((way, quarantined))
    }

    fn outcome<S>(&self, integrator: Integrator, truth: &Way) -> Outcome
    where
        S: Scalar<Accumulator: ToF64, Angle: ToF64>,
    {
        let scene = self.with(integrator);
        let result = self.way::<S>(&scene, 1).map(|(way, quarantined)| {
            let cost = self.cost::<S>(&scene) / truth.seconds();
            Numbers::new(truth.gaps(&way), quarantined, cost)
        });
        Outcome::new(S::NAME, integrator, result)
    }

    /// The CPU time of a run that was made before, s.
    fn cost<S: Scalar>(&self, scene: &Scene) -> f64 {
        const BATCHES: u32 = 3;
        let Ok(start) = scene.start::<S>() else { return f64::NAN };
        let mut batch = 1;
        let mut job = || {
            let mut run = start.clone();
            for _ in 0..self.ticks {
                // It went to its end before.
                let _ = run.advance();
            }
        };
        (0..BATCHES).map(|_| cpu_seconds(&mut batch, &mut job)).fold(f64::INFINITY, f64::min)
    }
}

/// The largest and the last of gaps.
fn largest_and_last(gaps: &[Gap]) -> (Gap, Gap) {
    let largest = gaps.iter().fold(Gap::default(), |largest, gap| Gap {
        position: largest.position.max(gap.position),
        angle: largest.angle.max(gap.angle),
        ..*gap
    });
    (largest, gaps.last().copied().unwrap_or_default())
}
