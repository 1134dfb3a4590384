//! Islands: the bodies that springs join, over any number of springs. An island falls asleep and wakes as a whole.
//!
//! Static bodies and those that take no part join nothing. No step keeps islands: each query searches from the bodies that it
//! is asked for, breadth first, and looks at nothing else.

use alloc::vec::Vec;

use crate::body::{Activity, Bodies, Sparse};
use crate::force::{FieldKind, FieldSet, ForceField};
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// Memory that searches use again.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    /// The bodies that were visited, each with the candidate that it was visited from.
    visited: Sparse<(usize, usize)>,
    /// The bodies of the island that is searched; those from `next` on have neighbours to look at.
    members: Vec<usize>,
}

/// Returns true if a body tries to fall asleep after this many steps at rest. The last body of an island that comes to rest tries first;
/// one that others keep awake tries again every `ticks` steps.
#[inline]
pub(crate) fn is_candidate(ticks_at_rest: u32, ticks: u32) -> bool {
    ticks_at_rest >= ticks && ticks_at_rest % ticks == 0
}

/// Lists the bodies of the islands that have been at rest for `ticks` steps and of which a candidate is a part, in the order
/// of their handles. The candidates are indices of moving bodies.
pub(crate) fn find_sleepers<S: Scalar>(
    bodies: &Bodies<S>,
    fields: &FieldSet<S>,
    ticks: u32,
    candidates: &[usize],
    workspace: &mut Workspace,
    fell_asleep: &mut Vec<BodyId>,
) {
    let rest = &bodies.columns.motion.ticks_at_rest;
    // Something may have moved a candidate since it was found.
    for &candidate in candidates.iter().filter(|&&i| is_candidate(rest[i], ticks)) {
        if candidate < bodies.free_count() {
            fell_asleep.push(bodies.id(candidate));
        } else if workspace.visited.get(candidate).is_none() && rests(bodies, fields, ticks, candidate, workspace) {
            fell_asleep.extend(workspace.members.iter().map(|&i| bodies.id(i)));
        }
    }
    workspace.visited.clear();
    fell_asleep.sort_unstable();
}

/// Returns true if the island of a body is at rest; then the workspace has its members. The search ends where one is not at rest.
fn rests<S: Scalar>(
    bodies: &Bodies<S>,
    fields: &FieldSet<S>,
    ticks: u32,
    candidate: usize,
    workspace: &mut Workspace,
) -> bool {
    let Workspace { visited, members } = workspace;
    members.clear();
    members.push(candidate);
    visited.get_or_insert(candidate, || (candidate, candidate));
    let mut next = 0;
    while let Some(&member) = members.get(next) {
        next += 1;
        for joined in neighbours(fields, bodies.id(member)) {
            let Some(i) = bodies.find(joined).ok().filter(|&i| i < bodies.moving()) else { continue };
            match visited.get(i) {
                Some(&(_, from)) if from == candidate => {}
                // It was visited in a search that ended: in an island that is at rest all bodies were.
                Some(_) => return false,
                None if bodies.columns.motion.ticks_at_rest[i] < ticks => return false,
                None => {
                    visited.get_or_insert(i, || (i, candidate));
                    members.push(i);
                }
            }
        }
    }
    true
}

/// Wakes these bodies and the islands that they are in. Adds those that slept to `woken`, in the order in which they are found.
pub(crate) fn wake<S: Scalar>(
    bodies: &mut Bodies<S>,
    fields: &FieldSet<S>,
    reached: impl IntoIterator<Item = BodyId>,
    woken: &mut Vec<BodyId>,
) {
    let mut wake_one = |body: BodyId, woken: &mut Vec<BodyId>| {
        if let Ok(dense) = bodies.find(body) {
            if bodies.activity(dense) == Activity::Asleep {
                bodies.set_activity(dense, Activity::Awake);
                woken.push(body);
            }
        }
    };
    let mut next = woken.len();
    reached.into_iter().for_each(|body| wake_one(body, woken));
    // An island sleeps as a whole: around a body that was awake nobody sleeps.
    while let Some(&body) = woken.get(next) {
        neighbours(fields, body).for_each(|joined| wake_one(joined, woken));
        next += 1;
    }
}

/// The bodies at the ends of the springs of a body, itself among them.
fn neighbours<S: Scalar>(fields: &FieldSet<S>, body: BodyId) -> impl Iterator<Item = BodyId> + use<'_, S> {
    let is_spring = |field: &ForceField<S>| matches!(field.kind, FieldKind::Spring { .. });
    fields.attached_to(body).filter(move |(_, field)| is_spring(field)).flat_map(|(_, field)| field.bodies())
}
