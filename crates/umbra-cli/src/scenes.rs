//! `umbra scenes`: the scenes that come with the program.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use umbra_scene::Scene;

use crate::failure::Failure;
use crate::output::Destinations;
use crate::text;

/// The scenes by their names, as `build.rs` lists them.
const SCENES: &[(&str, &str)] = &include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

#[derive(Args)]
pub(crate) struct Options {
    /// The scene to write [default: lists all of them].
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Where to write it [default: the standard output].
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
        return SCENES.iter().try_for_each(|(name, scene)| list(name, scene, options.json));
    };
    let found = SCENES.iter().find(|(known, _)| known == name);
    let (_, scene) = found
        .ok_or_else(|| Failure::Usage { what: format!("there is no scene {name:?}: `umbra scenes` lists them") })?;
    match &options.out {
        Some(out) => Destinations::beside([])?.add(out)?.write(scene),
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
