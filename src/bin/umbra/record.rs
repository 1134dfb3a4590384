//! A run on its way into a replay.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use umbra_physics::{Command, Driver, Error, Made, RecordOptions, Recorder, World};

use crate::failure::Failure;

/// Writes what is finished as it goes: a run that is broken off leaves a replay that is whole up to there.
pub(crate) struct Recording {
    recorder: Recorder,
    file: BufWriter<File>,
    path: PathBuf,
    /// What went wrong with the file, which a step has no way to say.
    written: io::Result<()>,
}

impl Recording {
    pub(crate) fn create(path: &Path, world: &World, options: RecordOptions) -> Result<Self, Failure> {
        let file = File::create(path).map_err(Failure::file(path, "write"))?;
        let recorder = Recorder::new(world, options);
        Ok(Self { recorder, file: BufWriter::new(file), path: path.into(), written: Ok(()) })
    }

    /// Ends it with the world as the last step left it.
    pub(crate) fn finish(self, world: &World) -> Result<(), Failure> {
        let Self { recorder, mut file, path, written } = self;
        let rest = recorder.finish(world);
        written.and_then(|()| file.write_all(&rest)).and_then(|()| file.flush()).map_err(Failure::file(&path, "write"))
    }
}

impl Driver for Recording {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Made, Error> {
        self.recorder.execute(world, command)
    }

    fn step(&mut self, world: &mut World) {
        Driver::step(&mut self.recorder, world);
        let bytes = self.recorder.take_bytes();
        if self.written.is_ok() {
            self.written = self.file.write_all(&bytes);
        }
    }
}
