//! The drift stage of coupled bodies: velocities to positions and angles.
//!
//! Reads: velocities, last accelerations. Writes: positions, angles, faults; drops the caches of the positions.

use super::Workspace as StepWorkspace;
use super::coupled::Coupled;
use crate::error::Cause;
use crate::integrate::{Integrator, Stage, drift};
use crate::scalar::{Accumulator, Angle, Scalar};

pub(super) fn run<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    let timing = pass.constants.plan.timing[stage.span];
    pass.each_block(|block| drift(block, &timing, block.any_turns()));
    if pass.integrator == Integrator::PublishedVerlet {
        drift_by_acceleration(pass, workspace);
    }
    workspace.fields.drop_cached();
}

/// PublishedVerlet's x += ½·a·dt² beside x += v·dt.
fn drift_by_acceleration<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let half_square = pass.constants.plan.half_square;
    let block = pass.all();
    let [x, y] = block.position;
    for (i, acceleration) in block.last_acceleration.iter().enumerate() {
        let way = |a: S::Wide| S::kick(a, half_square);
        match (acceleration.linear.try_map(way), way(acceleration.angular)) {
            (Some(linear), Some(angular)) => {
                (x[i], y[i]) = (x[i].plus(linear.x), y[i].plus(linear.y));
                block.angle[i] = block.angle[i].turned(angular);
            }
            _ => workspace.findings.faults.push((block.first + i, Cause::Velocity)),
        }
    }
}
