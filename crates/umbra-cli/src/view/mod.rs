//! `umbra view`: a run as one page that plays it, and needs nothing else.
//!
//! The page sees a world once a tick. It stores the values of bodies by `track`, and contacts, on request, as singles for each frame. Force
//! fields and joints it places by the bodies that carry them. It
//! drops every other frame when it would exceed 20 MB, and forbids the browser to fetch anything.

mod contacts;
mod drawing;
mod encounters;
mod events;
mod joints;
mod page;
mod recording;
mod track;
mod words;

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use umbra_physics::{BodyId, ColliderId, FieldId, Fx, Replay, World};
use umbra_scene::{Scene, Trails};

use crate::cast::{Cast, Roster};
use crate::failure::Failure;
use crate::format::Format;
use crate::load::{self, Run};
use crate::open;
use crate::output::{Destination, Destinations};
use crate::picture::{ContactOptions, Subject};
use crate::progress::progress;
use crate::sheets::{SheetFiles, SheetOptions, Sheets};
use crate::text;
use page::Heading;
use recording::{Budget, Recording};
use words::{Names, Words};

const HELP: &str = "\
The page opens at a tick if its address says so: run.html#tick=300. A replay that goes another way than it was recorded is shown up
to there.";

#[derive(Args)]
#[command(group(ArgGroup::new("outputs").args(["out", "csv", "plot"]).required(true).multiple(true)))]
#[command(group(ArgGroup::new("shown").args(["out", "plot"]).multiple(true)))]
#[command(after_help = HELP)]
pub(crate) struct Options {
    /// A scene, a JSON file, or a replay; - is the standard input.
    run: PathBuf,
    /// The page.
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
    #[command(flatten)]
    sheets: SheetOptions,
    /// Number of steps [default: what the scene says; all of a replay].
    #[arg(long, value_name = "N")]
    ticks: Option<u64>,
    /// Records contacts as well, for the page to show: points, normals and impulses. Long runs of large piles are thinned more.
    #[arg(long, requires = "out")]
    contacts: bool,
    /// Opens the page, or the picture, in the program that the system has for it.
    #[arg(long, requires = "shown")]
    open: bool,
}

/// The page, the table and the picture of a run, as far as they are wanted.
struct Views<'a> {
    recording: Option<Recording>,
    sheets: Sheets<'a>,
}

impl<'a> Views<'a> {
    fn create(options: &Options, files: &'a SheetFiles, subject: Subject, ticks: u64) -> Result<Self, Failure> {
        let recording = || Recording::new(Budget::default()).with_contacts(options.contacts);
        let sheets = Sheets::create(files, subject, ticks, ContactOptions::default())?;
        Ok(Self { recording: options.out.as_ref().map(|_| recording()), sheets })
    }

    /// Takes in the world at its start, and then after each step.
    fn see(
        &mut self,
        world: &World<Fx>,
        recorded: Option<u64>,
        name: impl Fn(BodyId) -> String,
        cast: &impl Cast,
    ) -> Result<(), Failure> {
        if let Some(recording) = &mut self.recording {
            recording.see(world, recorded, name);
        }
        self.sheets.see(world, cast)
    }

    fn input(&mut self, tick: u64, words: impl FnOnce() -> Words) {
        if let Some(recording) = &mut self.recording {
            let Words { topic, text } = words();
            recording.input(tick, topic, text);
        }
    }

    /// Writes the table and the picture, and hands out what there is for the page.
    fn finish(self, world: &World<Fx>, cast: &impl Cast) -> Result<Option<Recording>, Failure> {
        self.sheets.finish(world, cast)?;
        Ok(self.recording.map(|mut recording| {
            recording.finish(world);
            recording
        }))
    }
}

pub(crate) fn view(options: &Options) -> Result<(), Failure> {
    let mut all = Destinations::beside([&options.run])?;
    let out = all.add_any(options.out.as_ref(), Format::Html)?;
    let files = SheetFiles::new(&options.sheets, &mut all)?;
    drop(all);
    let shown = [out.as_ref(), files.plot.as_ref()];
    let opened = if options.open { shown.into_iter().flatten().map(open::file).collect() } else { Ok(Vec::new()) }?;
    let name = text::name(&options.run);
    let (recording, heading) = match load::run(&options.run)? {
        Run::Scene(scene) => {
            let recording = of_scene(&scene, options, &files)?;
            let title = if scene.title.is_empty() { name } else { scene.title };
            let trails = scene.plot.trails != Trails::None;
            (recording, Heading { title, about: scene.about, view: scene.plot.view, trails })
        }
        Run::Replay(replay) => {
            let recording = of_replay(&replay, options, &files, &name)?;
            (recording, Heading { title: name, about: String::new(), view: None, trails: true })
        }
    };
    if let (Some(recording), Some(out)) = (recording, &out) {
        write(recording, &heading, out)?;
    }
    opened.into_iter().try_for_each(open::open)
}

/// The run of a scene.
fn of_scene(scene: &Scene, options: &Options, files: &SheetFiles) -> Result<Option<Recording>, Failure> {
    let at_fault = Failure::scene(&options.run);
    let mut run = scene.start::<Fx>().map_err(&at_fault)?;
    let ticks = options.ticks.unwrap_or(scene.ticks);
    let mut views = Views::create(options, files, Subject::of(scene), ticks)?;
    let progress = progress(ticks, "tick");
    views.see(run.world(), None, |body: BodyId| run.name(body).to_owned(), &run)?;
    for tick in 0..ticks {
        for input in scene.inputs.iter().filter(|input| input.is_due(tick)) {
            views.input(tick, || words::action(scene, &input.action));
        }
        run.advance().map_err(&at_fault)?;
        views.see(run.world(), None, |body: BodyId| run.name(body).to_owned(), &run)?;
        progress.set_position(tick + 1);
    }
    progress.finish_and_clear();
    views.finish(run.world(), &run)
}

/// The run of a replay, made once more: up to where it is no longer the recorded one.
fn of_replay(
    replay: &Replay,
    options: &Options,
    files: &SheetFiles,
    title: &str,
) -> Result<Option<Recording>, Failure> {
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
    let bodies = playback.world().body_count();
    let subject = Subject { title: title.to_owned(), view: None, exposures: 0, trails: Trails::All, bodies };
    let mut views = Views::create(options, files, subject, ticks)?;
    let mut roster = Roster::default();
    roster.see(playback.world(), labels);
    let progress = progress(ticks, "tick");
    views.see(playback.world(), None, name, &roster)?;
    for tick in 0..ticks {
        for command in playback.commands() {
            views.input(start + tick, || words::command(&command, &names));
        }
        let divergence = playback.step().err();
        roster.see(playback.world(), labels);
        let recorded = divergence.as_ref().map(|divergence| divergence.recorded);
        views.see(playback.world(), recorded, name, &roster)?;
        progress.set_position(tick + 1);
        if let Some(divergence) = divergence {
            warn(divergence.to_string());
            break;
        }
    }
    progress.finish_and_clear();
    views.finish(playback.world(), &roster)
}

fn write(recording: Recording, heading: &Heading, out: &Destination) -> Result<(), Failure> {
    if let Some(thinned) = recording.thinned() {
        text::warn(format_args!("{}: {thinned}", text::path(out.file())));
    }
    out.write(&page::page(recording, heading))
}
