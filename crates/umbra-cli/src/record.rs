//! A run on its way into a replay.

use umbra_physics::{Command, Created, Error, RecordOptions, Recorder, Stepper, World};
use umbra_scene::SceneRun;

use crate::failure::Failure;
use crate::output::{Destination, Output};

/// A recording in progress. It is written as the run goes on: a run that is broken off leaves a temporary file that is a
/// replay, whole up to there.
pub(crate) struct Recording {
    recorder: Recorder,
    output: Output,
    /// The reason why the file could not be written, which a step has no way to return.
    failure: Option<Failure>,
}

impl Recording {
    pub(crate) fn create(to: &Destination, world: &World, options: RecordOptions) -> Result<Self, Failure> {
        Ok(Self { recorder: Recorder::new(world, options), output: to.create()?, failure: None })
    }

    /// Ends it with the world as the last step left it, and the names of the scene. What cannot be written to its end is left in the
    /// temporary file.
    pub(crate) fn finish(self, run: &SceneRun<'_>) -> Result<(), Failure> {
        let Self { mut recorder, mut output, .. } = self;
        *recorder.labels_mut() = run.labels();
        let written = output.put(|out| out.write_all(&recorder.finish(run.world()))).and_then(|()| output.sync());
        match written {
            Ok(()) => output.finish(),
            Err(failure) => {
                output.leave();
                Err(failure)
            }
        }
    }

    /// Fails if a step could not be written.
    pub(crate) fn check(&mut self) -> Result<(), Failure> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Keeps the temporary file of a run that failed.
    pub(crate) fn break_off(self) {
        self.output.leave();
    }
}

impl Stepper for Recording {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        self.recorder.execute(world, command)
    }

    fn step(&mut self, world: &mut World) {
        Stepper::step(&mut self.recorder, world);
        let bytes = self.recorder.take_bytes();
        if self.failure.is_none() {
            self.failure = self.output.put(|out| out.write_all(&bytes)).err();
        }
    }
}
