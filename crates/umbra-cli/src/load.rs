//! Scenes and replays from files, and from the standard input.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use umbra_physics::{Dump, Replay, Snapshot, World};
use umbra_scene::Scene;

use crate::failure::Failure;
use crate::scenes;

/// The name of the standard input, and of the standard output. A file of this name is `./-`.
const DASH: &str = "-";

/// A kind of file, told by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A scene, or other JSON.
    Scene,
    /// A replay.
    Replay,
    /// A desync dump.
    Dump,
    /// A snapshot of a world.
    Snapshot,
    /// A file without bytes.
    Empty,
}

impl Kind {
    /// The kind of file that these bytes are; None if they are of no kind of ours.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.is_empty() {
            return Some(Self::Empty);
        }
        // No JSON begins with the marks of the others.
        let marks = [(&b"UMBRAREP"[..], Self::Replay), (b"UMBRADMP", Self::Dump), (b"UMBRASNP", Self::Snapshot)];
        let marked = marks.into_iter().find(|(mark, _)| bytes.starts_with(mark)).map(|(_, kind)| kind);
        marked.or_else(|| bytes.trim_ascii_start().starts_with(b"{").then_some(Self::Scene))
    }

    /// The kind in words, and the commands for it.
    pub(crate) fn advice(self, file: &str) -> String {
        match self {
            Self::Scene => format!("a scene: `umbra run {file} --record REPLAY` makes a replay of it"),
            Self::Replay => format!(
                "a replay: `umbra verify {file}` runs it again, `umbra view {file} --out PAGE.html` plays it, and \
                 `umbra diff {file} OTHER` compares it with another one"
            ),
            Self::Dump => format!("a desync dump: `umbra diff {file} OTHER` compares it with the one of another peer"),
            Self::Snapshot => format!(
                "a snapshot of a world: `umbra verify --start {file} REPLAY` checks that a replay begins with it, and \
                 `Snapshot::from_bytes` of the library reads it"
            ),
            Self::Empty => "an empty file".to_owned(),
        }
    }
}

/// A run in a file.
pub(crate) enum Run {
    Scene(Box<Scene>),
    /// The part of a replay that is whole.
    Replay(Box<Replay>),
}

/// Says whether a path is the standard input, or the standard output.
pub(crate) fn is_dash(file: &Path) -> bool {
    file == Path::new(DASH)
}

/// The bytes of a file.
pub(crate) fn bytes(file: &Path) -> Result<Vec<u8>, Failure> {
    let read = if is_dash(file) {
        let mut bytes = Vec::new();
        io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        fs::read(file)
    };
    read.map_err(Failure::file(file, "read"))
}

/// The scene or replay in a file.
pub(crate) fn run(file: &Path) -> Result<Run, Failure> {
    let bytes = scene_bytes(file)?;
    match Kind::of(&bytes) {
        Some(Kind::Replay) => replay(&bytes, file).map(|replay| Run::Replay(Box::new(replay))),
        _ => parse(bytes, file, "a scene or a replay").map(|scene| Run::Scene(Box::new(scene))),
    }
}

/// The world that a scene or a replay begins with, or that a snapshot is of.
pub(crate) fn start(file: &Path) -> Result<World, Failure> {
    let bytes = scene_bytes(file)?;
    match Kind::of(&bytes) {
        Some(Kind::Replay) => Ok(replay(&bytes, file)?.start().clone()),
        Some(Kind::Snapshot) => {
            let snapshot = Snapshot::from_bytes(&bytes, &[]);
            Ok(snapshot.map_err(|error| Failure::Snapshot { file: file.into(), error })?.into_world())
        }
        _ => {
            let scene = parse(bytes, file, "a scene, a replay or a snapshot")?;
            Ok(scene.start().map_err(Failure::scene(file))?.into_world())
        }
    }
}

/// The bytes of a file that may be a scene. One that is not there may have the name of a scene that comes with the program.
fn scene_bytes(file: &Path) -> Result<Vec<u8>, Failure> {
    let name = file.file_stem().and_then(|stem| stem.to_str()).filter(|name| scenes::has(name));
    bytes(file).map_err(|failure| match (failure, name) {
        (Failure::File { file, doing, error }, Some(name)) if error.kind() == io::ErrorKind::NotFound => {
            let message = format!(
                "{error}; `umbra scenes {name} --out {name}.json` writes the scene of this name that comes with the program"
            );
            Failure::File { file, doing, error: io::Error::new(io::ErrorKind::NotFound, message) }
        }
        (failure, _) => failure,
    })
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
    parse(scene_bytes(file)?, file, "a scene")
}

fn parse(bytes: Vec<u8>, file: &Path, expected: &'static str) -> Result<Scene, Failure> {
    if let Some(kind) = Kind::of(&bytes).filter(|&kind| kind != Kind::Scene) {
        return Err(Failure::Foreign { file: file.into(), expected, kind: Some(kind) });
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let error = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
        Failure::file(file, "read")(error)
    })?;
    Scene::parse(&text).map_err(Failure::scene(file))
}
