//! The kick stage: gravity, then the applied forces, then the fields, to velocities; then friction.
//!
//! Reads: rows of factors, applied accelerations, accelerations by fields. Writes: velocities, last accelerations, faults.

use alloc::vec::Vec;

use super::applied::{accelerations, part_in};
use super::coupled::Coupled;
use super::{Accelerations, Constants, Workspace as StepWorkspace, fields};
use crate::body::{Acceleration, Block};
use crate::error::Cause;
use crate::force::{Dependence, rub};
use crate::integrate::{BlockFactors, Integrator, Stage, gravity_delta_v, kick_by, sum};
use crate::scalar::Scalar;

/// Memory that the stage uses again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    /// The second evaluation of the fields of velocity.
    second: Accelerations<S>,
    /// For `PublishedVerlet`, by the index in the coupled bodies: the acceleration of a body, if the sum fits.
    total: Vec<Option<Acceleration<S>>>,
}

/// The kick of a block by gravity and the applied forces.
pub(super) fn kick_block<S: Scalar>(
    block: &mut Block<'_, S>,
    factors: BlockFactors<'_, S>,
    stage: &Stage,
    constants: &Constants<'_, S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let timing = &constants.plan.timing[stage.span];
    gravity_delta_v(block, factors, stage.span, constants.plan.backwards);
    for (i, acceleration) in accelerations(part_in(block, constants.applied)) {
        if let Err(cause) = kick_by(block, *i, acceleration, timing.seconds, timing.negative) {
            faults.push((*i, cause));
        }
    }
}

pub(super) fn run<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    kick(pass, stage, workspace);
    // Before a drift, so that a body at rest that is pushed by less than its friction does not move. Yoshida's kicks go backwards too.
    if pass.kinds.friction && pass.integrator != Integrator::Yoshida4 {
        let seconds = pass.constants.plan.timing[stage.span].seconds;
        rub(&workspace.fields.frictions, pass.bodies, pass.indices.clone(), seconds);
    }
}

fn kick<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    if pass.integrator == Integrator::PublishedVerlet {
        return kick_by_mean(pass, workspace);
    }
    let constants = pass.constants;
    let kinds = pass.kinds;
    let StepWorkspace { fields, kick: Workspace { second, .. }, findings, .. } = workspace;
    let faults = &mut findings.faults;
    if kinds.velocity && !stage.mirrored && !pass.integrator.opens_with_fields() {
        fields::evaluate_velocity(pass, fields, faults);
    }
    pass.each_block(|block| kick_block(block, BlockFactors::of(block, constants.rows), stage, &constants, faults));
    let negative = constants.plan.timing[stage.span].negative;
    if kinds.position {
        kick_all(pass, stage, &fields.position, negative, faults);
    }
    if kinds.velocity {
        kick_all(pass, stage, &fields.velocity, negative, faults);
        if stage.mirrored {
            // The closing half kick is the implicit one, v' = v + ½h·a(x', v'), to within O(h³). The opening, explicit half
            // took its value at the old velocity, so that the two together are the trapezoidal rule, of order 2.
            second.clear();
            fields::evaluate(pass, Dependence::Velocity, pass.targets(), fields, second, faults);
            // The first kick is taken back to the bit; one that was left out for its size stays out.
            kick_all(pass, stage, &fields.velocity, !negative, faults);
            kick_all(pass, stage, second, negative, faults);
        }
    }
}

fn kick_all<S: Scalar>(
    pass: &mut Coupled<'_, S>,
    stage: &Stage,
    accelerations: &Accelerations<S>,
    negative: bool,
    faults: &mut Vec<(usize, Cause)>,
) {
    let seconds = pass.constants.plan.timing[stage.span].seconds;
    let mut coupled = pass.all();
    for (i, acceleration) in accelerations {
        if let Err(cause) = kick_by(&mut coupled, *i, acceleration, seconds, negative) {
            faults.push((*i, cause));
        }
    }
}

/// PublishedVerlet's v += (a + a')/2·dt; the new acceleration is kept for the next step.
fn kick_by_mean<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let constants = pass.constants;
    let kinds = pass.kinds;
    let StepWorkspace { fields, kick: Workspace { total, .. }, findings, .. } = workspace;
    let mut block = pass.all();
    let first = block.first;
    total.clear();
    let gravity = |row: u32| Acceleration { linear: constants.rows[row as usize].gravity, angular: S::Wide::default() };
    total.extend(block.factors.iter().map(|&row| Some(gravity(row))));
    let position = if kinds.position { &fields.position[..] } else { &[] };
    let velocity = if kinds.velocity { &fields.velocity[..] } else { &[] };
    let by_fields = position.iter().chain(velocity).map(|(i, part)| (i, part));
    for (i, part) in by_fields.chain(accelerations(part_in(&block, constants.applied))) {
        let total = &mut total[*i - first];
        *total = total.and_then(|total| sum(&total, part));
    }
    for (i, total) in total.iter().enumerate() {
        let last = block.last_acceleration[i];
        let kicked = total.and_then(|total| {
            block.last_acceleration[i] = total;
            sum(&last, &total)
        });
        let outcome = match kicked {
            Some(twice) => kick_by(&mut block, first + i, &twice, constants.plan.half, false),
            None => Err(Cause::Force),
        };
        if let Err(cause) = outcome {
            findings.faults.push((first + i, cause));
        }
    }
}
