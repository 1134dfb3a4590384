//! Scenes from files.

use std::fs;
use std::io;
use std::path::Path;

use umbra_physics::scene::Scene;

use crate::failure::Failure;

/// The scene in a file.
pub(crate) fn scene(file: &Path) -> Result<Scene, Failure> {
    let bytes = fs::read(file).map_err(Failure::file(file, "read"))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let error = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
        Failure::file(file, "read")(error)
    })?;
    Scene::parse(&text).map_err(Failure::scene(file))
}
