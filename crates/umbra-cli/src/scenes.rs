//! `umbra scenes`: the scenes that come with the program.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;
use umbra_scene::Scene;

use crate::failure::Failure;
use crate::format::Format;
use crate::output::Destinations;
use crate::text;

/// The scenes, as `build.rs` puts them together: a separator, the name, an end of line, the text.
const SCENES: &str = include_str!(concat!(env!("OUT_DIR"), "/scenes"));
/// A character that no scene has.
const SEPARATOR: char = '\u{1e}';

/// The scenes with their names.
fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    SCENES.split(SEPARATOR).filter_map(|scene| scene.split_once('\n'))
}

/// Says whether there is a scene of this name.
pub(crate) fn has(name: &str) -> bool {
    all().any(|(known, _)| known == name)
}

#[derive(Args)]
pub(crate) struct Options {
    /// The scene to write [default: lists all of them].
    #[arg(value_name = "NAME", hide_possible_values = true, value_parser = PossibleValuesParser::new(all().map(|(name, _)| name)))]
    name: Option<String>,
    /// File to write it to [default: the standard output].
    #[arg(long, value_name = "FILE.json", requires = "name")]
    out: Option<PathBuf>,
    /// Lists them as JSON objects, one a line.
    #[arg(long, conflicts_with = "name")]
    json: bool,
}

#[derive(Serialize)]
struct Line<'a> {
    name: &'a str,
    title: &'a str,
    about: &'a str,
    ticks: u64,
    bodies: usize,
}

pub(crate) fn scenes(options: &Options) -> Result<(), Failure> {
    let Some(name) = &options.name else {
        return all().try_for_each(|(name, scene)| list(name, scene, options.json));
    };
    // Other names are refused with the arguments.
    let Some((_, scene)) = all().find(|(known, _)| known == name) else { return Ok(()) };
    match &options.out {
        Some(out) => Destinations::beside([])?.add(out, Format::Json)?.write(scene),
        None => text::print(scene),
    }
}

fn list(name: &str, scene: &str, json: bool) -> Result<(), Failure> {
    // They are of this version, and read by its tests.
    let scene = Scene::parse(scene).map_err(Failure::scene(name.as_ref()))?;
    if !json {
        return text::print(format_args!("{name:<16}  {}", scene.title));
    }
    let Scene { title, about, ticks, bodies, .. } = &scene;
    let line = Line { name, title, about, ticks: *ticks, bodies: bodies.len() };
    text::print(serde_json::to_string(&line).unwrap_or_default())
}
