//! Files in the programs that the system has for them.

use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::output::Destination;

/// The file of a destination, to be opened once it is written.
pub(crate) fn file(destination: &Destination) -> Result<PathBuf, Failure> {
    if destination.is_file() {
        return Ok(destination.file().to_owned());
    }
    Err(Failure::Usage { what: "--open needs a file: what goes to a pipe or a device cannot be opened".to_owned() })
}

/// Opens a file, and does not wait for the program.
pub(crate) fn open(file: PathBuf) -> Result<(), Failure> {
    // A path that begins with a dash would be an option of that program.
    let path = if file.is_relative() { Path::new(".").join(&file) } else { file.clone() };
    open::that_detached(path).map_err(Failure::file(&file, "open"))
}
