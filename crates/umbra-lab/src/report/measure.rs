//! A run: its error at the end, and what it costs.

use umbra_physics::{Activity, BodyId, Integrator, Scalar, TimeStep, World, WorldDef};
use umbra_scene::{Scene, SceneError};

use super::problem::{Problem, Truth};
use crate::cost::cpu_seconds;
use crate::truth::Exact;

/// A scene that is ready to run, with one scalar, integrator and time step.
pub(crate) struct Run<S: Scalar> {
    start: World<S>,
    torque: Option<(BodyId, S)>,
    steps: u32,
    /// Runs to a batch.
    batch: u32,
}

impl<S: Scalar> Run<S> {
    pub(crate) fn new(problem: &Problem, scene: &Scene, integrator: Integrator, rate: u32) -> Result<Self, SceneError> {
        let world = WorldDef { integrator, time_step: TimeStep::hz(rate), ..scene.world };
        let start = Scene { world, ..scene.clone() }.build::<S>()?;
        let body = start.bodies().next().map(|body| body.id());
        let torque = body.zip(problem.torque().map(S::from_fx));
        Ok(Self { start, torque, steps: problem.seconds * rate, batch: 1 })
    }

    fn go(&self, world: &mut World<S>) {
        for _ in 0..self.steps {
            if let Some((body, torque)) = self.torque {
                // It cannot be refused but for a body that left the envelope, which has no end to read.
                let _ = world.apply_torque(body, torque);
            }
            world.step();
        }
    }

    /// The error at the end; `None` if a body left the envelope.
    pub(crate) fn error(&self, problem: &Problem, truth: &Truth) -> Option<f64>
    where
        S::Accumulator: Exact,
        S::Angle: Exact,
    {
        let mut world = self.start.clone();
        self.go(&mut world);
        let is_whole = world.bodies().all(|body| body.activity() != Activity::Quarantined);
        is_whole.then(|| problem.error(&world, truth))
    }

    /// The CPU time of a run, s, from one batch. Going back to the start is counted in: a few steps,
    /// a twentieth of the shortest runs at most.
    pub(crate) fn cost(&mut self) -> f64 {
        let mut batch = self.batch;
        let mut world = self.start.clone();
        let seconds = cpu_seconds(&mut batch, || {
            world.clone_from(&self.start);
            self.go(&mut world);
        });
        self.batch = batch;
        seconds
    }
}
