//! Steppers: values that carry out commands and steps.

use super::{Command, Created, World};
use crate::error::Error;
use crate::fx::Fx;
use crate::scalar::Scalar;

/// A value that carries out commands and steps. `()` does no more; a [`Recorder`](crate::Recorder) also records them. A scene's
/// run takes one (`SceneRun::advance_by`).
pub trait Stepper<S: Scalar = Fx> {
    /// Carries out a command.
    ///
    /// # Errors
    /// As [`World::execute`]; the world is as it was.
    fn execute(&mut self, world: &mut World<S>, command: &Command<S>) -> Result<Created, Error>;

    /// Steps the world.
    fn step(&mut self, world: &mut World<S>);
}

impl<S: Scalar> Stepper<S> for () {
    fn execute(&mut self, world: &mut World<S>, command: &Command<S>) -> Result<Created, Error> {
        world.execute(command)
    }

    fn step(&mut self, world: &mut World<S>) {
        world.step();
    }
}

impl<S: Scalar, D: Stepper<S> + ?Sized> Stepper<S> for &mut D {
    fn execute(&mut self, world: &mut World<S>, command: &Command<S>) -> Result<Created, Error> {
        (**self).execute(world, command)
    }

    fn step(&mut self, world: &mut World<S>) {
        (**self).step(world);
    }
}
