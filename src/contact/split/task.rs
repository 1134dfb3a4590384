//! Some of the islands of a step, solved by themselves.

use super::{
    FINE_SUBSTEPS, IS_DEEP, IS_HEAVY, IS_JOINED, IS_LOADED, JOINT_ROUNDS, KINDS, LOAD_RELAX_PASSES, LOAD_ROUNDS, Part,
    RELAX_PASSES, Shares,
};
use crate::fx::Fx;
use crate::limits::SPEED;
use crate::math::TimeStep;
use crate::scalar::FxAccumulator;
use crate::solve::{Contact, ContactSolver, Correction, Flight, Graph, Joint, SolverOptions};

/// The options for islands of a kind.
pub(super) fn kind_options(kind: usize, options: &SolverOptions) -> SolverOptions {
    let substeps = if kind & IS_HEAVY == 0 { options.substeps } else { FINE_SUBSTEPS };
    let (least_passes, joint_rounds) = match kind & (IS_JOINED | IS_LOADED) {
        0 => (0, options.joint_rounds),
        IS_JOINED => (0, JOINT_ROUNDS),
        _ => (LOAD_RELAX_PASSES, LOAD_ROUNDS),
    };
    let relax_passes = if kind & IS_DEEP == 0 { options.relax_passes.max(least_passes) } else { RELAX_PASSES };
    SolverOptions { substeps, relax_passes, joint_rounds, ..*options }
}

/// A step whose islands are solved apart.
pub(super) struct SplitStep<'a> {
    pub(super) time_step: TimeStep,
    pub(super) options: &'a SolverOptions,
    pub(super) flights: &'a [Flight],
    pub(super) graph: &'a Graph,
    /// By island.
    pub(super) kinds: &'a [usize],
    pub(super) shares: &'a Shares,
}

impl SplitStep<'_> {
    /// The number of the task that has the joints and contacts of these bodies.
    #[inline(always)]
    fn task_of(&self, bodies: [u32; 2]) -> usize {
        let island = self.graph.island_of_link(bodies);
        island.map_or(0, |island| self.shares.of(island as usize) * KINDS + self.kinds[island as usize])
    }
}

/// Some of the islands of a step, and their solver. All of them are of one kind: the number of the task, less the [`KINDS`] of the shares before.
#[derive(Debug, Default)]
pub(super) struct Task<C> {
    pub(super) part: Part,
    pub(super) solver: C,
    /// True if the step has islands for it.
    pub(super) is_used: bool,
}

impl<C: ContactSolver> Task<C> {
    /// Copies the joints and contacts of its islands, and the flights that they join, with the corrections of the tasks before.
    pub(super) fn take(
        &mut self,
        step: &SplitStep<'_>,
        number: usize,
        joints: &[Joint],
        contacts: &[Contact],
        corrections: &[Correction],
    ) {
        let part = &mut self.part;
        if !self.is_used {
            return part.clear();
        }
        part.take(step.flights, joints, contacts, |bodies| step.task_of(bodies) == number);
        for index in 0..part.flights.len() {
            let Some(leader) = part.flights[index].leader else { continue };
            let place = part.flight(leader);
            if place.is_none() {
                // The leader was in a task before, or has no contacts at all.
                correct(&mut part.flights[index], &corrections[leader as usize], step.time_step);
            }
            part.flights[index].leader = place;
        }
    }

    /// Solves its islands, with the options of their kind and the impulses over its sub-steps.
    pub(super) fn solve(&mut self, step: &SplitStep<'_>, number: usize) {
        let Self { part, solver, .. } = self;
        if part.is_empty() {
            return;
        }
        let options = kind_options(number % KINDS, step.options);
        let [world_substeps, substeps] = [step.options.substeps, options.substeps].map(u64::from);
        for joint in &mut part.joints {
            joint.impulses = joint.impulses.rescaled(world_substeps, substeps);
        }
        for contact in &mut part.contacts {
            contact.impulses = contact.impulses.rescaled(world_substeps, substeps);
        }
        let Part { flights, joints, contacts, corrections, .. } = part;
        solver.solve(step.time_step, &options, flights, joints, contacts, corrections);
    }

    /// Writes impulses, over sub-steps of the world, and corrections to their places among all.
    pub(super) fn write(
        &self,
        step: &SplitStep<'_>,
        number: usize,
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut [Correction],
    ) {
        let part = &self.part;
        if part.is_empty() {
            return;
        }
        let substeps = kind_options(number % KINDS, step.options).substeps.into();
        let world_substeps = step.options.substeps.into();
        // Fixed bodies, which may be in several tasks, have none.
        for (&number, correction) in part.flight_numbers.iter().zip(&part.corrections) {
            corrections[number as usize] = *correction;
        }
        for (&number, joint) in part.joint_numbers.iter().zip(&part.joints) {
            joints[number as usize].impulses = joint.impulses.rescaled(substeps, world_substeps);
        }
        for (&number, contact) in part.contact_numbers.iter().zip(&part.contacts) {
            contacts[number as usize].impulses = contact.impulses.rescaled(substeps, world_substeps);
        }
    }
}

/// Gives a flight the mean velocity of the step, with the changes by impulses: sub-steps see a fixed flight by its velocities alone,
/// and an impact of its body has changed these at once.
fn correct(flight: &mut Flight, correction: &Correction, time_step: TimeStep) {
    if !correction.is_pushed {
        return;
    }
    let (num, den) = time_step.seconds();
    // Ways are below 2^30 m: products are below 2^94. No flight is faster than the limit.
    let mean = |way: Fx, change: FxAccumulator| {
        let way = i128::from(way.to_bits()) + i128::from(change.value().to_bits());
        let limit = i128::from(SPEED.to_bits());
        Fx::from_bits((way * i128::from(den) / i128::from(num)).clamp(-limit, limit) as i64)
    };
    flight.start.linear.x = mean(flight.displacement.x, correction.displacement.x);
    flight.start.linear.y = mean(flight.displacement.y, correction.displacement.y);
    flight.start.angular = mean(flight.rotation, correction.rotation);
    flight.end = flight.start;
}
