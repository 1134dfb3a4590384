//! `umbra view`: a run as one page that plays it, and needs nothing else.

mod drawing;
mod page;
mod recording;
mod track;
mod words;

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use umbra_physics::scene::Scene;
use umbra_physics::{BodyId, Fx};

use crate::failure::Failure;
use crate::load;
use crate::progress::progress;
use page::Heading;
use recording::{Budget, Recording};

#[derive(Args)]
pub(crate) struct Options {
    /// The scene, a JSON file.
    scene: PathBuf,
    /// The page.
    #[arg(long, value_name = "FILE.html")]
    out: PathBuf,
    /// Number of steps [default: what the scene says].
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
}

pub(crate) fn view(options: &Options) -> Result<(), Failure> {
    let scene = load::scene(&options.scene)?;
    let recording = of_scene(&scene, options)?;
    let file = options.scene.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let title = if scene.title.is_empty() { file } else { scene.title.clone() };
    let heading = Heading { title, about: scene.about.clone(), view: scene.plot.view };
    write(recording, &heading, options)
}

/// The run of a scene.
fn of_scene(scene: &Scene, options: &Options) -> Result<Recording, Failure> {
    let at_fault = Failure::scene(&options.scene);
    let mut run = scene.start::<Fx>().map_err(&at_fault)?;
    let ticks = options.ticks.unwrap_or(scene.ticks);
    let mut recording = Recording::new(Budget::default());
    let progress = progress(ticks, "tick");
    recording.see(run.world(), None, |body: BodyId| run.name(body).to_owned());
    for tick in 0..ticks {
        for input in scene.inputs.iter().filter(|input| input.is_due(tick)) {
            recording.input(tick, words::deed(scene, &input.deed));
        }
        run.advance().map_err(&at_fault)?;
        recording.see(run.world(), None, |body: BodyId| run.name(body).to_owned());
        progress.set_position(tick + 1);
    }
    progress.finish_and_clear();
    recording.finish(run.world());
    Ok(recording)
}

fn write(recording: Recording, heading: &Heading, options: &Options) -> Result<(), Failure> {
    if let Some(thinned) = recording.thinned() {
        let _ = writeln!(std::io::stderr(), "{}: {thinned}", options.out.display());
    }
    fs::write(&options.out, page::page(recording, heading)).map_err(Failure::file(&options.out, "write"))
}
