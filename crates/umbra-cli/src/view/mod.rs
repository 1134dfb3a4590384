//! `umbra view`: a run as one page that plays it, and needs nothing else.
//!
//! The page sees a world once a tick. It stores the values of bodies by `track`, and contacts, on request, as singles for each frame. Force
//! fields and joints it places by the bodies that carry them. It
//! drops every other frame when it would exceed 20 MB, and forbids the browser to fetch anything.

mod contacts;
mod drawing;
mod events;
mod joints;
mod page;
mod recording;
mod track;
mod words;

use std::path::PathBuf;

use clap::Args;
use umbra_physics::{BodyId, ColliderId, FieldId, Fx, Replay};
use umbra_scene::{Scene, Trails};

use crate::failure::Failure;
use crate::load::{self, Run};
use crate::output::{Destination, Destinations};
use crate::progress::progress;
use crate::text;
use page::Heading;
use recording::{Budget, Recording};
use words::Names;

#[derive(Args)]
pub(crate) struct Options {
    /// A scene, a JSON file, or a replay; - is the standard input.
    run: PathBuf,
    /// The page.
    #[arg(long, value_name = "FILE.html")]
    out: PathBuf,
    /// Number of steps [default: what the scene says; all of a replay].
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
    /// Records contacts as well, for the page to show: points, normals and impulses. Long runs of large piles are thinned more.
    #[arg(long)]
    contacts: bool,
}

pub(crate) fn view(options: &Options) -> Result<(), Failure> {
    let out = Destinations::beside([&options.run])?.add(&options.out)?;
    let file = text::name(&options.run);
    match load::run(&options.run)? {
        Run::Scene(scene) => {
            let recording = of_scene(&scene, options)?;
            let title = if scene.title.is_empty() { file } else { scene.title };
            let trails = scene.plot.trails != Trails::None;
            write(recording, &Heading { title, about: scene.about, view: scene.plot.view, trails }, &out)
        }
        Run::Replay(replay) => {
            let recording = of_replay(&replay, options);
            write(recording, &Heading { title: file, about: String::new(), view: None, trails: true }, &out)
        }
    }
}

/// The run of a scene.
fn of_scene(scene: &Scene, options: &Options) -> Result<Recording, Failure> {
    let at_fault = Failure::scene(&options.run);
    let mut run = scene.start::<Fx>().map_err(&at_fault)?;
    let ticks = options.ticks.unwrap_or(scene.ticks);
    let mut recording = Recording::new(Budget::default()).with_contacts(options.contacts);
    let progress = progress(ticks, "tick");
    recording.see(run.world(), None, |body: BodyId| run.name(body).to_owned());
    for tick in 0..ticks {
        for input in scene.inputs.iter().filter(|input| input.is_due(tick)) {
            recording.input(tick, words::action(scene, &input.action));
        }
        run.advance().map_err(&at_fault)?;
        recording.see(run.world(), None, |body: BodyId| run.name(body).to_owned());
        progress.set_position(tick + 1);
    }
    progress.finish_and_clear();
    recording.finish(run.world());
    Ok(recording)
}

/// The run of a replay, made once more: up to where it is no longer the recorded one.
fn of_replay(replay: &Replay, options: &Options) -> Recording {
    let warn = |what: String| text::warn(format_args!("{}: {what}", text::path(&options.run)));
    if !replay.is_complete() {
        warn(format!("cut off: whole up to tick {}", replay.end()));
    }
    let mut playback = replay.play();
    let start = playback.world().tick();
    let ticks = options.ticks.unwrap_or(u64::MAX).min(replay.ticks());
    let labels = replay.labels();
    let names = Names {
        body: |body: BodyId| labels.body(body).map_or_else(|| body.to_string(), str::to_owned),
        field: |field: FieldId| labels.field(field).map_or_else(|| field.to_string(), str::to_owned),
        collider: |collider: ColliderId| labels.collider(collider).map_or_else(|| collider.to_string(), str::to_owned),
    };
    // The page calls bodies without a name by their handles.
    let name = |body: BodyId| labels.body(body).unwrap_or_default().to_owned();
    let mut recording = Recording::new(Budget::default()).with_contacts(options.contacts);
    let progress = progress(ticks, "tick");
    recording.see(playback.world(), None, name);
    for tick in 0..ticks {
        for command in playback.commands() {
            recording.input(start + tick, words::command(&command, &names));
        }
        let divergence = playback.step().err();
        recording.see(playback.world(), divergence.as_ref().map(|divergence| divergence.recorded), name);
        progress.set_position(tick + 1);
        if let Some(divergence) = divergence {
            warn(divergence.to_string());
            break;
        }
    }
    progress.finish_and_clear();
    recording.finish(playback.world());
    recording
}

fn write(recording: Recording, heading: &Heading, out: &Destination) -> Result<(), Failure> {
    if let Some(thinned) = recording.thinned() {
        text::warn(format_args!("{}: {thinned}", text::path(out.file())));
    }
    out.write(&page::page(recording, heading))
}
