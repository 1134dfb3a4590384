//! Sleep: islands of bodies that have been at rest for a number of steps.
//!
//! Reads: ticks at rest, springs, contacts, joints, attractors that moving bodies carry. Writes: the report, ticks at rest, velocities, contacts.
//!
//! A body without contacts and joints is at rest if the next step would leave it as it is: its public velocities are zero, the step changed nothing
//! below them either, no force was applied, and no body that might still move acts on it. Skipping it changes nothing. One that contacts
//! or joints push, or that floats, is at rest while it is slow, by its velocity and by the way that it moves; when it falls asleep, it stops.
//!
//! Manifolds without an impulse join islands too, so that two piles that nearly touch do not wake each other in turns.

use super::coupled::{FieldKinds, may_move};
use super::{Contacts, Workspace};
use crate::body::Bodies;
use crate::collider::ColliderSet;
use crate::contact::Start;
use crate::force::{End, FieldKind, FieldSet};
use crate::island::{self, SleepJoins};
use crate::scalar::{Accumulator as _, Angle as _, Scalar, Wide};

/// Reports the bodies that fall asleep, in the order of the handles.
pub(super) fn find<S: Scalar>(
    bodies: &mut Bodies<S>,
    fields: &FieldSet<S>,
    contacts: &Contacts<'_, S>,
    ticks: u32,
    kinds: FieldKinds,
    workspace: &mut Workspace<S>,
) {
    if kinds.moving_attractors {
        keep_awake_around_moving_attractors(bodies, fields);
    }
    let Workspace { findings, islands, touching, contacts: memory, report, .. } = workspace;
    if findings.candidates.is_empty() {
        return;
    }
    touching.clear();
    if let Some(memory) = memory {
        memory.list_touching(bodies, contacts, touching);
    }
    let fell_asleep = &mut report.fell_asleep;
    let joins = SleepJoins { fields, joints: contacts.joined(), touching };
    island::find_sleepers(bodies, joins, ticks, &findings.candidates, islands, fell_asleep);
    for &body in &*fell_asleep {
        if let Ok(i) = bodies.find(body) {
            bodies.columns.motion.stop(i);
        }
    }
}

/// A body does not sleep while an attractor acts on it that another, movable body carries: its force may change.
fn keep_awake_around_moving_attractors<S: Scalar>(bodies: &mut Bodies<S>, fields: &FieldSet<S>) {
    for (_, field) in fields.iter() {
        let FieldKind::Attractor { centre: End::Body(carrier), .. } = &field.kind else { continue };
        let Ok(carrier) = bodies.find(carrier.body) else { continue };
        if !may_move(bodies, carrier) {
            continue;
        }
        // Free bodies feel no field.
        for i in bodies.free_count()..bodies.moving() {
            if i != carrier && bodies.info(i).feels(field.force_groups) {
                bodies.columns.motion.ticks_at_rest[i] = 0;
            }
        }
    }
}

/// Returns true if no point of a body within this radius is faster than this.
pub(super) fn is_slow<S: Scalar>(bodies: &Bodies<S>, radius: S, speed: S, i: usize) -> bool {
    is_within(velocity(bodies, i), radius, speed)
}

/// Returns true if no point of a body within this radius was faster than this on its way from the start of the step, at this number of steps
/// a second: a body that is pushed out of another one moves without a velocity.
pub(super) fn has_stayed<S: Scalar>(
    bodies: &Bodies<S>,
    radius: S,
    speed: S,
    rate: S::Factor,
    start: &Start<S>,
) -> bool {
    let i = start.dense;
    let motion = &bodies.columns.motion;
    let from = start.position;
    let to = motion.position.get(i);
    let way = [(from.x, to.x), (from.y, to.y)].map(|(from, to)| to.plus(from.negated()).scaled(rate));
    let turned = start.angle.way_to(motion.angle[i]).times(rate).and_then(S::Wide::to_scalar);
    let [Some(x), Some(y)] = way else { return false };
    let Some(turned) = turned else { return false };
    is_within([x.value(), y.value(), turned], radius, speed)
}

/// The velocity of a body along x and y and around its centre of mass.
fn velocity<S: Scalar>(bodies: &Bodies<S>, i: usize) -> [S; 3] {
    let motion = &bodies.columns.motion;
    [motion.velocity.x[i], motion.velocity.y[i], motion.angular_velocity[i]].map(|component| component.value())
}

/// The largest distance of a point of a body's colliders from its centre of mass, and at least the distance of a joint's point.
pub(super) fn radius<S: Scalar>(bodies: &Bodies<S>, colliders: &ColliderSet<S>, reach: S, i: usize) -> S {
    let radii = colliders.solid_of_slot(bodies.columns.slot[i]).map(|collider| collider.radius);
    radii.fold(reach, |max, radius| if radius > max { radius } else { max })
}

/// Returns true if no point within a radius is faster than `speed`, for a velocity along x and y and around the centre. With a speed of 0
/// no body is slow.
fn is_within<S: Scalar>([x, y, angular]: [S; 3], radius: S, speed: S) -> bool {
    let size = |value: S| if value < S::ZERO { -value } else { value };
    let x = size(x);
    let y = size(y);
    // The rest of the speed, after the speed that the rotation gives the rim.
    let linear_limit = size(angular).times(radius).map(|rim| speed - rim);
    let square = |v: S| v.product(v);
    // Below 2^10 m/s, no sum is too large.
    speed > S::ZERO
        && linear_limit.is_some_and(|limit| {
            x <= limit && y <= limit && square(x).plus(square(y)).is_some_and(|sum| sum <= square(limit))
        })
}
