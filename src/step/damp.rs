//! The damp stage of coupled bodies: damping, then each drag in the order of the fields; in reverse where it closes a step.
//!
//! Reads: rows of factors, drags, masses, locks. Writes: velocities, faults.
//!
//! With `Yoshida4`, drag that is too stiff to run backwards acts around the whole step instead.

use alloc::vec::Vec;

use super::Workspace as StepWorkspace;
use super::applied::accelerations;
use super::coupled::Coupled;
use crate::force::{outer_drag, resist};
use crate::integrate::{BlockFactors, Stage, damp};
use crate::math::Vec2;
use crate::scalar::{Factor, Scalar};

/// Memory that the stage uses again. By indices in the coupled bodies.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    /// The largest speed that a step may add to each body.
    speed_gain: Vec<S::Factor>,
    /// True for each body whose drag acts around the whole step.
    outside: Vec<bool>,
}

pub(super) fn run<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    if stage.mirrored {
        resist_inside(pass, stage, workspace);
        damp_blocks(pass, stage, workspace);
    } else {
        damp_blocks(pass, stage, workspace);
        resist_inside(pass, stage, workspace);
    }
}

fn damp_blocks<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    let rows = pass.constants.rows;
    pass.each_block(|block| {
        let factors = BlockFactors::of(block, rows);
        let turns = block.any_turns();
        damp(block, factors, stage.span, turns, &mut workspace.findings.faults);
    });
}

fn resist_inside<S: Scalar>(pass: &mut Coupled<'_, S>, stage: &Stage, workspace: &mut StepWorkspace<S>) {
    if !pass.kinds.drag {
        return;
    }
    let timing = pass.constants.plan.timing[stage.span];
    let StepWorkspace { damp: Workspace { outside, .. }, fields, report, findings, .. } = workspace;
    let fluids = fields.fluids(pass.forces);
    let first = pass.indices.start;
    let acts_inside = |i: usize| report.drag_outside == 0 || !outside[i - first];
    let span = (timing.seconds, timing.negative);
    resist(fluids, pass.bodies, pass.indices.clone(), span, stage.mirrored, acts_inside, &mut findings.faults);
}

/// Finds the bodies whose drag acts around the whole step, and lets the first half of it act.
pub(super) fn open_outside<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    find_stiff_drag(pass, workspace);
    resist_outside(pass, false, workspace);
}

/// Lets the second half of the drag around the whole step act.
pub(super) fn close_outside<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    resist_outside(pass, true, workspace);
}

fn resist_outside<S: Scalar>(pass: &mut Coupled<'_, S>, mirrored: bool, workspace: &mut StepWorkspace<S>) {
    let StepWorkspace { damp: Workspace { outside, .. }, fields, findings, .. } = workspace;
    let fluids = fields.fluids(pass.forces);
    let first = pass.indices.start;
    let span = (pass.constants.plan.half, false);
    let acts_outside = |i: usize| outside[i - first];
    resist(fluids, pass.bodies, pass.indices.clone(), span, mirrored, acts_outside, &mut findings.faults);
}

/// Finds the bodies whose drag is to act around the whole step, judged by the speed that gravity, the applied forces and the
/// fields of position here may add to each in twice the time step.
fn find_stiff_drag<S: Scalar>(pass: &Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let StepWorkspace { fields, damp: Workspace { speed_gain, outside }, report, .. } = workspace;
    let size = |a: Vec2<S::Wide>| S::Factor::from_wide(a.x).plus(S::Factor::from_wide(a.y));
    let constants = &pass.constants;
    let first = pass.indices.start;
    speed_gain.clear();
    let rows = &pass.bodies.columns.factors[pass.indices.clone()];
    speed_gain.extend(rows.iter().map(|&row| size(constants.rows[row as usize].gravity)));
    let by_fields = if pass.kinds.position { &fields.position[..] } else { &[] };
    let by_fields = by_fields.iter().map(|(i, acceleration)| (i, acceleration));
    let applied = accelerations(constants.applied).filter(|(i, _)| pass.indices.contains(*i));
    for (i, acceleration) in by_fields.chain(applied) {
        let gain = &mut speed_gain[*i - first];
        *gain = gain.plus(size(acceleration.linear));
    }
    let whole = constants.plan.whole;
    let twice = whole.plus(whole);
    let gain = |i: usize| speed_gain[i - first].times(twice);
    let (forces, coupled) = (pass.forces, pass.indices.clone());
    report.drag_outside = outer_drag(forces.fields, forces.colliders, pass.bodies, coupled, whole, gain, outside);
}
