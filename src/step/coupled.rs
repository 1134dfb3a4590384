//! The pass of coupled bodies: all of them stage by stage, as a field looks at many bodies at once.
//!
//! Reads: fields, rows of factors, applied accelerations. Writes: positions, angles, velocities, ticks at rest, faults.

use alloc::vec::Vec;
use core::ops::Range;

use super::applied::part_in;
use super::bounds::check_bounds_and_rest;
use super::sleep::{is_slow, radius};
use super::{Constants, Forces, Probe, Workspace as StepWorkspace, damp, drift, fields, kick};
use crate::body::{BLOCK, Block, Bodies, BodyKind, Motion};
use crate::force::{Dependence, End, FieldKind, Scene, Targets, floats, rub};
use crate::integrate::{BlockFactors, Integrator, Stage, StageKind, cap};
use crate::island::is_candidate;
use crate::scalar::Scalar;
use crate::timers::timed;

/// Memory that the pass uses again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    /// The coupled bodies as they were before the step.
    backup: Motion<S>,
    /// The slow bodies that float, in ascending order, and for how many ticks they have been at rest.
    floating: Vec<(usize, u32)>,
}

impl<S: Scalar> Workspace<S> {
    /// Takes all coupled bodies back to their state before the step.
    pub(super) fn restore_all(&self, coupled: &mut Block<'_, S>) {
        (0..coupled.len()).for_each(|i| self.backup.restore(coupled, i));
    }
}

/// The kinds of fields in the world; a stage is skipped if its kind is missing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FieldKinds {
    pub(super) position: bool,
    pub(super) velocity: bool,
    pub(super) drag: bool,
    pub(super) friction: bool,
    pub(super) fluid: bool,
    /// Attractors that a movable body carries.
    pub(super) moving_attractors: bool,
}

impl FieldKinds {
    pub(super) fn of<S: Scalar>(forces: Forces<'_, S>, bodies: &Bodies<S>) -> Self {
        let mut kinds = Self::default();
        for (_, field) in forces.fields.iter() {
            let depends_on = field.depends_on(forces.custom_forces);
            match &field.kind {
                FieldKind::Drag { .. } => kinds.drag = true,
                FieldKind::Friction { .. } => kinds.friction = true,
                FieldKind::Buoyancy { .. } => {
                    (kinds.position, kinds.fluid) = (true, true);
                    kinds.drag |= field.kind.has_drag();
                }
                FieldKind::Spring { .. } => {
                    kinds.position = true;
                    kinds.velocity |= depends_on == Dependence::Velocity;
                }
                _ if depends_on == Dependence::Velocity => kinds.velocity = true,
                _ => kinds.position = true,
            }
            if let FieldKind::Attractor { centre: End::Body(carrier), .. } = &field.kind {
                kinds.moving_attractors |= bodies.find(carrier.body).is_ok_and(|i| may_move(bodies, i));
            }
        }
        kinds
    }
}

/// Returns true if a step may move a body.
pub(super) fn may_move<S: Scalar>(bodies: &Bodies<S>, i: usize) -> bool {
    bodies.info(i).kind != BodyKind::Static && bodies.activity(i).takes_part()
}

/// The coupled bodies, and the forces on them.
pub(super) struct Coupled<'a, S: Scalar> {
    pub(super) bodies: &'a mut Bodies<S>,
    /// The indices of the coupled bodies.
    pub(super) indices: Range<usize>,
    pub(super) forces: Forces<'a, S>,
    pub(super) constants: Constants<'a, S>,
    pub(super) integrator: Integrator,
    pub(super) kinds: FieldKinds,
}

impl<S: Scalar> Coupled<'_, S> {
    /// All coupled bodies.
    pub(super) fn all(&mut self) -> Block<'_, S> {
        self.bodies.block(self.indices.clone())
    }

    /// The coupled bodies, a block after the other.
    pub(super) fn each_block(&mut self, mut run: impl FnMut(&mut Block<'_, S>)) {
        let mut blocks = self.all();
        while blocks.len() > 0 {
            let count = BLOCK.min(blocks.len());
            let (mut block, rest) = blocks.split(count);
            blocks = rest;
            run(&mut block);
        }
    }

    /// The view that fields have of the world.
    pub(super) fn scene(&self) -> Scene<'_, S> {
        let Forces { fields, custom_forces, colliders, gravity } = self.forces;
        Scene { bodies: self.bodies, fields, custom_forces, colliders, gravity }
    }

    /// The bodies that fields act on.
    pub(super) fn targets(&self) -> Targets<'static> {
        Targets::Coupled(self.indices.start, self.indices.end)
    }
}

/// Takes the coupled bodies through the whole step.
pub(super) fn run<S: Scalar>(
    mut pass: Coupled<'_, S>,
    mut stages: &[Stage],
    workspace: &mut StepWorkspace<S>,
    mut probe: Option<&mut Probe<'_, S>>,
) {
    let Constants { rows, any_capped, .. } = pass.constants;
    timed!(workspace, finish, begin(&mut pass, workspace));
    if pass.kinds.position && !pass.integrator.opens_with_fields() {
        timed!(workspace, fields, fields::complete(&pass, &mut workspace.fields, &mut workspace.findings.faults));
    }
    if pass.kinds.drag && pass.integrator == Integrator::Yoshida4 {
        timed!(workspace, damp, damp::open_outside(&mut pass, workspace));
    }
    while let [stage, rest @ ..] = stages {
        match stage.kind {
            StageKind::Fields => timed!(workspace, fields, fields::run(&pass, workspace)),
            StageKind::Damp => timed!(workspace, damp, damp::run(&mut pass, stage, workspace)),
            StageKind::Kick => timed!(workspace, kick, kick::run(&mut pass, stage, workspace)),
            StageKind::Drift => timed!(workspace, drift, drift::run(&mut pass, stage, workspace)),
            StageKind::Clear | StageKind::Detect | StageKind::Solve | StageKind::Push => {}
        }
        // Drag around the whole step ends with the last damp.
        if workspace.report.drag_outside > 0 && rest.is_empty() {
            timed!(workspace, damp, damp::close_outside(&mut pass, workspace));
        }
        // So does friction, which has no inverse for the middle of this step.
        if pass.kinds.friction && pass.integrator == Integrator::Yoshida4 && rest.is_empty() {
            timed!(
                workspace,
                damp,
                rub(&workspace.fields.frictions, pass.bodies, pass.indices.clone(), pass.constants.plan.whole)
            );
        }
        if let Some(probe) = &mut probe {
            probe(stage, pass.bodies, None);
        }
        stages = rest;
    }
    if any_capped {
        pass.each_block(|block| cap(block, BlockFactors::of(block, rows)));
    }
    timed!(workspace, finish, finish(&mut pass, workspace));
}

/// Keeps a backup, and finds the bodies whose applied forces do not fit.
fn begin<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let constants = pass.constants;
    workspace.fields.begin(pass.forces.fields, pass.kinds.friction);
    let coupled = pass.all();
    workspace.coupled.backup.keep(&coupled);
    constants.report_overloaded(&coupled, &mut workspace.findings.faults);
}

/// Checks the bodies, and restores the state before the step of bodies with a fault.
fn finish<S: Scalar>(pass: &mut Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let StepWorkspace { coupled: Workspace { backup, floating }, fields, findings, .. } = workspace;
    let constants = pass.constants;
    floating.clear();
    if pass.kinds.fluid && constants.sleep_after.is_some() {
        let bodies = &*pass.bodies;
        let mut fluids = fields.fluids(pass.forces);
        let is_slow = |i: &usize| {
            let radius = radius(bodies, pass.forces.colliders, S::ZERO, *i);
            is_slow(bodies, radius, constants.sleep_speed, *i)
        };
        let slow = pass.indices.clone().filter(is_slow).filter(|&i| floats(&mut fluids, bodies, i));
        floating.extend(slow.map(|i| (i, bodies.columns.motion.ticks_at_rest[i])));
    }
    let mut coupled = pass.all();
    check_bounds_and_rest(&mut coupled, backup, &constants, findings);
    findings.sort_faults();
    if constants.restores {
        let first = coupled.first;
        for (i, _) in part_in(&coupled, &findings.faults) {
            backup.restore(&mut coupled, *i - first);
            coupled.ticks_at_rest[*i - first] = 0;
        }
    }
    // A fluid may move it a little in each step: it counts as at rest while it is slow and nothing else is applied to it.
    for &(i, ticks_at_rest) in &*floating {
        let is_left_alone = constants.applied.binary_search_by_key(&i, |(i, _)| *i).is_err()
            && findings.faults.binary_search_by_key(&i, |(i, _)| *i).is_err();
        if is_left_alone {
            let rest = ticks_at_rest.saturating_add(1);
            coupled.ticks_at_rest[i - coupled.first] = rest;
            if constants.sleep_after.is_some_and(|ticks| is_candidate(rest, ticks)) {
                findings.candidates.push(i);
            }
        }
    }
}
