//! The fields stage: the accelerations by force fields at the positions now.
//!
//! Reads: fields, positions, angles, velocities, masses, groups. Writes: the accelerations by fields, faults.
//!
//! The accelerations by fields of position hold until something moves: the accelerations at the end of a step serve the first kick of
//! the next one. They are a function of the state, not state.

use alloc::vec::Vec;

use super::applied::acceleration;
use super::coupled::Coupled;
use super::{Accelerations, Forces, Workspace as StepWorkspace};
use crate::body::{Bodies, Change};
use crate::error::Cause;
use crate::force::{Dependence, Directions, FieldKind, FieldSet, Fluids, Friction, Loads, Parts, Targets, accumulate};
use crate::math::Vec2;
use crate::scalar::Scalar;

/// Memory that the stage uses again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    loads: Loads<S>,
    /// Sines and cosines of the angles now.
    directions: Directions<S>,
    /// Of the positions and angles now, within a step.
    parts: Parts<S>,
    /// The accelerations by fields of position; at the positions now if `is_current`, but for the bodies in `outdated`.
    pub(super) position: Accelerations<S>,
    is_current: bool,
    /// The gravity that the lift among them is evaluated with; zero without a fluid.
    gravity: Vec2<S>,
    /// In ascending order. They have no entry in `position`.
    outdated: Vec<usize>,
    /// The accelerations by fields of velocity, as evaluated for the kick before.
    pub(super) velocity: Accelerations<S>,
    /// The frictions of the step.
    pub(super) frictions: Vec<Friction<S>>,
}

impl<S: Scalar> Workspace<S> {
    /// Drops the caches of the positions and angles of coupled bodies.
    pub(super) fn drop_cached(&mut self) {
        self.is_current = false;
        self.outdated.clear();
        self.directions.clear();
        self.parts.clear();
    }

    /// Begins a step. Bodies, colliders and fields may have changed since the one before.
    pub(super) fn begin(&mut self, fields: &FieldSet<S>, has_friction: bool) {
        self.parts.clear();
        self.frictions.clear();
        if has_friction {
            Friction::list(fields, &mut self.frictions);
        }
    }

    /// The fluids, and the cached parts of the bodies in them.
    pub(super) fn fluids<'a>(&'a mut self, forces: Forces<'a, S>) -> Fluids<'a, S> {
        let Forces { fields, colliders, .. } = forces;
        Fluids { fields, colliders, parts: &mut self.parts }
    }

    /// Drops the caches of bodies that changed, and of the bodies at the other ends of fields attached to them.
    ///
    /// `changed` has the changes since the last step; `None` if any body may have changed, or fields that act by groups.
    pub(super) fn drop_changed(&mut self, bodies: &Bodies<S>, fields: &FieldSet<S>, changed: Option<&[(u32, Change)]>) {
        let Some(changed) = changed else { return self.drop_cached() };
        // Some were not needed in the last step, and may be elsewhere now.
        self.is_current &= self.outdated.is_empty();
        self.outdated.clear();
        for &(slot, _) in changed.iter().filter(|(_, change)| change.is_any_of(Change::POSE.or(Change::FORCES))) {
            let Some(i) = bodies.index_in(slot) else { continue };
            // Also where the pose did not change: a body that was free in between turned, and no one noted it.
            self.directions.remove(i);
            self.outdated.push(i);
        }
        if self.is_current {
            self.outdated.sort_unstable();
            self.outdated.dedup();
            self.outdate_neighbours(bodies, fields);
        }
        if self.is_current {
            self.drop_outdated(bodies);
        } else {
            self.outdated.clear();
        }
    }

    /// Marks the other ends of the fields that are attached to the bodies that changed. It gives up where these are many: a kilobyte of
    /// calls may name a body with any number of fields.
    fn outdate_neighbours(&mut self, bodies: &Bodies<S>, fields: &FieldSet<S>) {
        let limit = bodies.moving() - bodies.free_count();
        for index in 0..self.outdated.len() {
            for (_, field) in fields.attached_to(bodies.id(self.outdated[index])) {
                if matches!(field.kind, FieldKind::Attractor { .. }) || self.outdated.len() > limit {
                    self.is_current = false;
                    return;
                }
                self.outdated.extend(field.bodies().filter_map(|body| bodies.find(body).ok()));
            }
        }
    }

    fn drop_outdated(&mut self, bodies: &Bodies<S>) {
        let coupled = bodies.free_count()..bodies.moving();
        self.outdated.sort_unstable();
        self.outdated.dedup();
        self.outdated.retain(|i| coupled.contains(i));
        if self.outdated.len() > coupled.len() / 4 {
            self.is_current = false;
            return;
        }
        let outdated = &self.outdated;
        self.position.retain(|(i, _)| coupled.contains(i) && outdated.binary_search(i).is_err());
    }

    /// Takes over the caches of the workspace that this one is a copy of.
    pub(super) fn clone_cached_from(&mut self, source: &Self) {
        self.is_current = source.is_current && source.outdated.is_empty();
        self.gravity = source.gravity;
        self.outdated.clear();
        if self.is_current {
            self.position.clone_from(&source.position);
        }
    }
}

/// Evaluates the fields of position and of velocity.
pub(super) fn run<S: Scalar>(pass: &Coupled<'_, S>, workspace: &mut StepWorkspace<S>) {
    let StepWorkspace { fields, findings, .. } = workspace;
    if pass.kinds.position {
        fields.is_current = false;
        complete(pass, fields, &mut findings.faults);
    }
    if pass.kinds.velocity {
        evaluate_velocity(pass, fields, &mut findings.faults);
    }
}

/// Evaluates the fields of position where their accelerations are not current.
pub(super) fn complete<S: Scalar>(
    pass: &Coupled<'_, S>,
    workspace: &mut Workspace<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let gravity = if pass.kinds.fluid { pass.forces.gravity } else { Vec2::ZERO };
    let Workspace { position, is_current, outdated, .. } = workspace;
    *is_current &= workspace.gravity == gravity;
    let mut accelerations = core::mem::take(position);
    let outdated = core::mem::take(outdated);
    if !*is_current {
        accelerations.clear();
        evaluate(pass, Dependence::Position, pass.targets(), workspace, &mut accelerations, faults);
    } else if !outdated.is_empty() {
        evaluate(pass, Dependence::Position, Targets::Only(&outdated), workspace, &mut accelerations, faults);
    }
    workspace.position = accelerations;
    workspace.is_current = true;
    workspace.gravity = gravity;
    workspace.outdated = outdated;
    workspace.outdated.clear();
}

/// Evaluates the fields of velocity.
pub(super) fn evaluate_velocity<S: Scalar>(
    pass: &Coupled<'_, S>,
    workspace: &mut Workspace<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let mut accelerations = core::mem::take(&mut workspace.velocity);
    accelerations.clear();
    evaluate(pass, Dependence::Velocity, pass.targets(), workspace, &mut accelerations, faults);
    workspace.velocity = accelerations;
}

/// Adds the accelerations by the fields of one dependence, of all coupled bodies or of some.
pub(super) fn evaluate<S: Scalar>(
    pass: &Coupled<'_, S>,
    dependence: Dependence,
    targets: Targets<'_>,
    workspace: &mut Workspace<S>,
    accelerations: &mut Accelerations<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let Workspace { directions, parts, loads, .. } = workspace;
    loads.clear();
    accumulate(pass.scene(), dependence, targets, directions, parts, loads, faults);
    // A spring may push a body that goes through the step by itself: its load there is not of this pass.
    for (i, load) in loads.rows().iter().filter(|(i, _)| pass.indices.contains(i)) {
        match acceleration(&load.acceleration, &load.force, &load.torque, pass.bodies.mass(*i)) {
            Some(acceleration) => accelerations.push((*i, acceleration)),
            None => faults.push((*i, Cause::Force)),
        }
    }
}
