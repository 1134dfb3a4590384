//! Sleep: islands of bodies that have been at rest for a number of steps.
//!
//! Reads: ticks at rest, springs, contacts, attractors that moving bodies carry. Writes: the report, ticks at rest, velocities, contacts.
//!
//! A body without contacts is at rest if the next step would leave it as it is: its public velocities are zero, the step changed nothing
//! below them either, no force was applied, and no body that might still move acts on it. Skipping it changes nothing. One that contacts
//! push, or that floats, is at rest while it is slow; when it falls asleep, it stops.

use super::coupled::{FieldKinds, may_move};
use super::{Contacts, Workspace};
use crate::body::Bodies;
use crate::collider::{Collider, ColliderSet};
use crate::force::{End, FieldKind, FieldSet};
use crate::island;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Scalar, Wide as _};
use crate::slots::BodyId;

/// Reports the bodies that fall asleep, in the order of the handles.
pub(super) fn find<S: Scalar>(
    bodies: &mut Bodies<S>,
    fields: &FieldSet<S>,
    contacts: &Contacts<'_, S>,
    (ticks, kinds): (u32, FieldKinds),
    workspace: &mut Workspace<S>,
) {
    if kinds.moving_attractors {
        keep_awake_around_moving_attractors(bodies, fields);
    }
    let Workspace { found, islands, touching, contacts: own_contacts, report, .. } = workspace;
    if found.candidates.is_empty() {
        return;
    }
    touching.clear();
    if let Some(own) = own_contacts {
        own.list_touching(bodies, contacts, touching);
    }
    let candidates = (&found.candidates[..], &*touching);
    island::find_sleepers(bodies, fields, ticks, candidates, islands, &mut report.fell_asleep);
    for &body in &report.fell_asleep {
        stop(bodies, body);
    }
}

/// Stops a body that falls asleep while it is slow.
fn stop<S: Scalar>(bodies: &mut Bodies<S>, body: BodyId) {
    let Ok(i) = bodies.find(body) else { return };
    let motion = &mut bodies.columns.motion;
    let [x, y] = [motion.velocity.x[i], motion.velocity.y[i]];
    if ![x, y, motion.angular_velocity[i]].iter().all(|velocity| velocity.is_still()) {
        motion.velocity.set(i, Vec2::new(S::Accumulator::default(), S::Accumulator::default()));
        motion.angular_velocity[i] = S::Accumulator::default();
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

/// Returns true if no point of a body's colliders is faster than this. With a speed of 0 no body is slow: what has no velocity after a step
/// may still be pushed out of another one in it.
pub(super) fn is_slow<S: Scalar>(bodies: &Bodies<S>, colliders: &ColliderSet<S>, speed: S, i: usize) -> bool {
    if speed == S::ZERO {
        return false;
    }
    let size = |value: S| if value < S::ZERO { -value } else { value };
    let motion = &bodies.columns.motion;
    let [x, y] = [motion.velocity.x[i], motion.velocity.y[i]].map(|v| size(v.value()));
    let larger = |most: S, collider: &Collider<S>| if collider.radius > most { collider.radius } else { most };
    let radius = colliders.solid_of_slot(bodies.columns.slot[i]).fold(S::ZERO, larger);
    // The speed that the turning leaves to the body.
    let left = size(motion.angular_velocity[i].value()).times(radius).map(|rim| speed - rim);
    let square = |v: S| v.product(v);
    // Below 2^10 m/s, no sum is too large.
    left.is_some_and(|left| x <= left && y <= left && square(x).plus(square(y)).is_some_and(|sum| sum <= square(left)))
}
