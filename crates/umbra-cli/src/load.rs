//! Scenes and replays from files.

use std::fs;
use std::io;
use std::path::Path;

use umbra_physics::{Dump, Replay};
use umbra_scene::Scene;

use crate::failure::Failure;

/// The first bytes of a replay, which no JSON begins with.
pub(crate) const REPLAY: &[u8] = b"UMBRAREP";
/// And of a desync dump.
pub(crate) const DUMP: &[u8] = b"UMBRADMP";

/// A run in a file.
pub(crate) enum Run {
    Scene(Box<Scene>),
    /// The part of a replay that is whole.
    Replay(Box<Replay>),
}

/// The scene or replay in a file.
pub(crate) fn run(file: &Path) -> Result<Run, Failure> {
    let bytes = fs::read(file).map_err(Failure::file(file, "read"))?;
    if !bytes.starts_with(REPLAY) {
        return parse(bytes, file).map(|scene| Run::Scene(Box::new(scene)));
    }
    replay(&bytes, file).map(|replay| Run::Replay(Box::new(replay)))
}

/// Reads the part that is whole of the replay in these bytes of a file.
pub(crate) fn replay(bytes: &[u8], file: &Path) -> Result<Replay, Failure> {
    Replay::recovered(bytes, &[]).map_err(|error| Failure::Replay { file: file.into(), error })
}

/// The desync dump that these bytes are.
pub(crate) fn dump(bytes: &[u8], file: &Path) -> Result<Dump, Failure> {
    Dump::from_bytes(bytes, &[]).map_err(|error| Failure::Replay { file: file.into(), error })
}

/// The scene in a file.
pub fn scene(file: &Path) -> Result<Scene, Failure> {
    parse(fs::read(file).map_err(Failure::file(file, "read"))?, file)
}

fn parse(bytes: Vec<u8>, file: &Path) -> Result<Scene, Failure> {
    let text = String::from_utf8(bytes).map_err(|error| {
        let error = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
        Failure::file(file, "read")(error)
    })?;
    Scene::parse(&text).map_err(Failure::scene(file))
}
