//! Sleep: islands that the next step would leave as they are, and that were so for a number of steps.
//!
//! Reads: ticks at rest, springs, attractors that moving bodies carry. Writes: the report, ticks at rest.
//!
//! Skipping such a body changes nothing: its public velocities are zero, the step changed nothing below them either, no force
//! was applied, and no body that might still move acts on it.

use super::Workspace;
use super::coupled::{FieldKinds, may_move};
use crate::body::Bodies;
use crate::force::{End, FieldKind, FieldSet};
use crate::island;
use crate::scalar::Scalar;

/// Reports the bodies that fall asleep, in the order of the handles.
pub(super) fn find<S: Scalar>(
    bodies: &mut Bodies<S>,
    fields: &FieldSet<S>,
    ticks: u32,
    kinds: FieldKinds,
    workspace: &mut Workspace<S>,
) {
    if kinds.moving_attractors {
        keep_awake_around_moving_attractors(bodies, fields);
    }
    let Workspace { found, islands, report, .. } = workspace;
    if !found.candidates.is_empty() {
        island::find_sleepers(bodies, fields, ticks, &found.candidates, islands, &mut report.fell_asleep);
    }
}

/// A body does not sleep while an attractor acts on it that another, movable body carries: its force may change.
fn keep_awake_around_moving_attractors<S: Scalar>(bodies: &mut Bodies<S>, fields: &FieldSet<S>) {
    for (_, field) in fields.iter() {
        let FieldKind::Attractor { centre: End::Body(carrier), .. } = &field.kind else { continue };
        let Ok(own) = bodies.find(carrier.body) else { continue };
        if !may_move(bodies, own) {
            continue;
        }
        // Free bodies feel no field.
        for i in bodies.free_count()..bodies.moving() {
            if i != own && bodies.info(i).feels(field.force_groups) {
                bodies.columns.motion.ticks_at_rest[i] = 0;
            }
        }
    }
}
