//! A step looked at stage by stage.

use alloc::vec::Vec;

use super::World;
use crate::body::{Activity, Bodies};
use crate::integrate::{Stage, StageKind};
use crate::scalar::{Scalar, fx::Fx};
use crate::step::find_out_of_bounds;

/// The world after each stage of a step: where two runs part, the first stage after which they differ says what parted
/// them.
///
/// All are at the tick before the step; what was applied over it is forgotten after the last of them, clear. What comes before
/// the stages, the velocities of bodies that are sent to a goal, shows after the first of them. What follows the stages, caps
/// of speeds, arrival at goals, quarantine and sleep, shows in the world that was traced.
///
/// ```
/// use umbra_physics::{BodyDef, Trace, World, WorldDef, vec2};
///
/// let mut world: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// world.add_body(BodyDef::dynamic())?;
/// let trace: Trace = world.step_traced();
/// for (stage, after) in trace.stages() {
///     println!("{:>6}: state hash {:016x}", stage.kind.name(), after.state_hash());
/// }
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trace<S: Scalar = Fx> {
    stages: Vec<(Stage, World<S>)>,
}

impl<S: Scalar> Trace<S> {
    /// The stages in order, each with the world after it.
    ///
    /// It differs from the one before in what the stage's [verb](Verb) writes alone. Between stages a body may be beyond the
    /// envelope, and come back or not: there it is quarantined, where it is; what was applied to it and where it was sent are forgotten.
    pub fn stages(&self) -> impl DoubleEndedIterator<Item = (&Stage, &World<S>)> + ExactSizeIterator {
        self.stages.iter().map(|(stage, world)| (stage, world))
    }
}

impl<S: Scalar> World<S> {
    /// Moves the world on by a tick as [`step`](Self::step) does, with the same bits and the same
    /// [report](Self::last_report), and keeps the world as it was after each stage. Slow: it is for finding where two runs
    /// part.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, StageKind, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef { gravity: vec2(0, -60), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let trace = world.step_traced();
    /// let kicks = trace.stages().filter(|(stage, _)| stage.kind == StageKind::Kick);
    /// let speeds: Vec<_> = kicks.filter_map(|(_, world)| Some(world.body(ball).ok()?.velocity())).collect();
    /// // The opening half, and the closing one.
    /// assert_eq!(speeds, [vec2(0, umbra_physics::fx!(-0.5)), vec2(0, -1)]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn step_traced(&mut self) -> Trace<S> {
        let before = self.clone();
        let mut stages = Vec::with_capacity(self.def.integrator.stages().len());
        let mut probe = |stage: &Stage, bodies: &Bodies<S>| {
            let mut world = before.clone();
            world.bodies.clone_from(bodies);
            if stage.kind == StageKind::Clear {
                world.applied.finish();
            }
            world.quarantine_out_of_bounds();
            stages.push((*stage, world));
        };
        self.advance(Some(&mut probe));
        self.change_log.end(&self.workspace.report.faults, &self.workspace.report.fell_asleep);
        Trace { stages }
    }

    /// Makes of a world in the midst of a step one like any other, which may be moved on as well.
    fn quarantine_out_of_bounds(&mut self) {
        let mut faults = Vec::new();
        find_out_of_bounds(&self.bodies.all_moving(), &mut faults);
        // From the last one on: those before it stay where they are when it is taken out.
        for (i, _) in faults.into_iter().rev() {
            // One that is taken out has nothing applied to it, and is sent nowhere.
            let body = self.bodies.id(i);
            self.applied.forget(body);
            self.targets.recall(body);
            self.bodies.set_activity(i, Activity::Quarantined);
            self.mark_if_still(body);
        }
    }
}
