//! Traces: the world after each stage of a step.

use alloc::vec::Vec;

use super::World;
use crate::body::{Activity, Bodies};
use crate::contact::ContactSet;
use crate::fx::Fx;
use crate::integrate::{Stage, StageKind};
use crate::joint::JointStates;
use crate::scalar::Scalar;
use crate::step::find_out_of_bounds;

/// The world after each stage of a step. Where two runs diverge, the first stage after which they differ is the cause.
///
/// All these worlds are at the tick before the step. Forces applied over it are dropped after the last stage, `clear`. The
/// velocities of bodies that are moved to a target are set before the stages, and show after the first. Caps of speeds and arrival
/// at targets follow the free flight, and show after `detect`; quarantine and sleep show in the world that was traced.
///
/// ```
/// use umbra_physics::{BodyDef, Trace, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
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
    /// Each world differs from the one before in the values that the stage's [kind](StageKind) writes, and in nothing else.
    /// Between stages a body may be outside the limits for a while: in these worlds it is quarantined at its place, without
    /// applied forces and without a target.
    pub fn stages(&self) -> impl DoubleEndedIterator<Item = (&Stage, &World<S>)> + ExactSizeIterator {
        self.stages.iter().map(|(stage, world)| (stage, world))
    }
}

impl<S: Scalar> World<S> {
    /// Simulates one tick as [`step`](Self::step) does, with the same bits and the same [report](Self::last_report), and returns
    /// the world after each stage. It is slow: use it to find where two runs diverge.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, StageKind, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -60), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let trace = world.step_traced();
    /// let kicks = trace.stages().filter(|(stage, _)| stage.kind == StageKind::Kick);
    /// let speeds: Vec<_> = kicks.filter_map(|(_, world)| Some(world.body(ball).ok()?.velocity())).collect();
    /// // The opening half, and the closing one.
    /// assert_eq!(speeds, [vec2(0, umbra_physics::fx!(-0.5)), vec2(0, -1)]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn step_traced(&mut self) -> Trace<S> {
        S::step_traced(self)
    }

    pub(crate) fn step_traced_inner(&mut self) -> Trace<S> {
        // The worlds of the stages share these factors, and are stepped on like any other.
        self.update();
        let before = self.clone();
        let mut stages = Vec::with_capacity(self.def.integrator.stages().len());
        let mut probe = |stage: &Stage, bodies: &Bodies<S>, contacts: Option<(&ContactSet, &JointStates)>| {
            let mut world = before.clone();
            world.bodies.clone_from(bodies);
            if let Some((contacts, joint_states)) = contacts {
                world.contacts.clone_from(contacts);
                world.joint_states.clone_from(joint_states);
                // The worlds of the stages are at the tick before.
                world.contacts.pushed_at = world.contacts.pushed_at.min(world.tick);
                world.joint_states.pulled_at = world.joint_states.pulled_at.min(world.tick);
            }
            if stage.kind == StageKind::Clear {
                world.applied.finish();
            }
            world.quarantine_out_of_bounds();
            stages.push((*stage, world));
        };
        self.advance(Some(&mut probe));
        self.end_step();
        Trace { stages }
    }

    /// Turns a world in the middle of a step into a valid world, which can be stepped.
    fn quarantine_out_of_bounds(&mut self) {
        let mut faults = Vec::new();
        find_out_of_bounds(&self.bodies.all_moving(), &mut faults);
        // A quarantined body changes places with the last moving one: in descending order, the indices of the others stay.
        for (i, _) in faults.into_iter().rev() {
            // A quarantined body has no applied forces and no target.
            let body = self.bodies.id(i);
            self.applied.forget(body);
            self.targets.recall(body);
            self.bodies.set_activity(i, Activity::Quarantined);
            self.mark_if_still(body);
        }
    }
}
