//! Islands: the bodies that springs, joints and contacts join, over any number of them. An island falls asleep and wakes as a whole.
//!
//! Static bodies and bodies that take no part join nothing; a kinematic body joins nothing by contacts and joints. No step keeps islands: each query
//! searches from the bodies that it is asked for, breadth first, and looks at nothing else. A step asks for bodies that have rested for long
//! enough, a call for bodies that it wakes or puts to sleep.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;

use crate::body::{Activity, Bodies, BodyKind, Sparse};
use crate::collider::ColliderSet;
use crate::contact::ContactSet;
use crate::force::{FieldKind, FieldSet, ForceField};
use crate::joint::Joined;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// Buffers of the searches, which each search uses again.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    /// The bodies that were visited, each with the candidate that it was visited from.
    visited: Sparse<(usize, usize)>,
    /// The bodies of the island that is searched, in the order of the search.
    members: Vec<usize>,
}

/// The contacts of a step, by the bodies of each.
#[derive(Debug, Default)]
pub(crate) struct Touching {
    /// The slots of a dynamic body and of a body that is not static and touches it, sorted; two dynamic bodies stand in both orders.
    pairs: Vec<[u32; 2]>,
    /// The slots of bodies that lie on a surface that moves around its body, sorted.
    driven: Vec<u32>,
}

impl Touching {
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.driven.clear();
    }

    /// Adds a contact of a dynamic body.
    pub(crate) fn push(&mut self, body: u32, other_body: u32) {
        self.pairs.push([body, other_body]);
    }

    /// Adds a body on a surface that moves.
    pub(crate) fn push_driven(&mut self, body: u32) {
        self.driven.push(body);
    }

    pub(crate) fn sort(&mut self) {
        self.pairs.sort_unstable();
        self.driven.sort_unstable();
    }

    /// The slots of the bodies that a dynamic body touches.
    fn touched_by(&self, body: u32) -> impl Iterator<Item = u32> {
        let start = self.pairs.partition_point(|pair| pair[0] < body);
        self.pairs[start..].iter().take_while(move |pair| pair[0] == body).map(|pair| pair[1])
    }

    fn is_driven(&self, body: u32) -> bool {
        self.driven.binary_search(&body).is_ok()
    }

    fn contains(&self, body: u32) -> bool {
        self.touched_by(body).next().is_some() || self.is_driven(body)
    }
}

/// Returns true if a body tries to fall asleep after this many steps at rest. The last body of an island that comes to rest tries first;
/// one that other bodies keep awake tries again every `ticks` steps.
#[inline]
pub(crate) fn is_candidate(ticks_at_rest: u32, ticks: u32) -> bool {
    ticks_at_rest >= ticks && ticks_at_rest % ticks == 0
}

/// The force fields, joints and contacts of a step, which join its bodies.
#[derive(Clone, Copy)]
pub(crate) struct SleepJoins<'a, S: Scalar> {
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) joints: Joined<'a>,
    pub(crate) touching: &'a Touching,
}

/// Lists the bodies of the islands that have been at rest for `ticks` steps and of which a candidate is a part, in the order
/// of their handles. The candidates are indices of moving bodies.
pub(crate) fn find_sleepers<S: Scalar>(
    bodies: &Bodies<S>,
    joins: SleepJoins<'_, S>,
    ticks: u32,
    candidates: &[usize],
    workspace: &mut Workspace,
    fell_asleep: &mut Vec<BodyId>,
) {
    let rest = &bodies.columns.motion.ticks_at_rest;
    // Something may have moved a candidate since it was found.
    for &candidate in candidates.iter().filter(|&&i| is_candidate(rest[i], ticks)) {
        let slot = bodies.id(candidate).slot;
        if candidate < bodies.free_count() && !joins.touching.contains(slot) && !joins.joints.has(slot) {
            fell_asleep.push(bodies.id(candidate));
        } else if workspace.visited.get(candidate).is_none() && rests(bodies, joins, ticks, candidate, workspace) {
            fell_asleep.extend(workspace.members.iter().map(|&i| bodies.id(i)));
        }
    }
    workspace.visited.clear();
    fell_asleep.sort_unstable();
    fell_asleep.dedup();
}

/// Returns true if the island of a body is at rest; then the workspace has its members. The search ends where one is not at rest.
fn rests<S: Scalar>(
    bodies: &Bodies<S>,
    SleepJoins { fields, joints, touching }: SleepJoins<'_, S>,
    ticks: u32,
    candidate: usize,
    workspace: &mut Workspace,
) -> bool {
    let Workspace { visited, members } = workspace;
    let rest = &bodies.columns.motion.ticks_at_rest;
    members.clear();
    members.push(candidate);
    visited.get_or_insert(candidate, || (candidate, candidate));
    // The members from `next` on have neighbours to look at.
    let mut next = 0;
    while let Some(&member) = members.get(next) {
        next += 1;
        let member_id = bodies.id(member);
        if touching.is_driven(member_id.slot) {
            return false;
        }
        let spring_neighbours = joined_by_springs(fields, member_id).filter_map(|joined| bodies.find(joined).ok());
        let touched_bodies = || touching.touched_by(member_id.slot).filter_map(|slot| bodies.index_in(slot));
        let is_kinematic = |i: &usize| bodies.info(*i).kind == BodyKind::Kinematic;
        // The joints of a kinematic body, which springs may have led to, join nothing.
        let joined_bodies = || {
            let partners = joints.partners(member_id.slot).filter(|_| !is_kinematic(&member));
            partners.filter_map(|slot| bodies.index_in(slot)).filter(|&i| i < bodies.moving())
        };
        let neighbours = || touched_bodies().chain(joined_bodies());
        // A kinematic body joins nothing, and keeps bodies on it awake while it moves.
        if neighbours().any(|i| is_kinematic(&i) && rest[i] == 0) {
            return false;
        }
        let other_neighbours = neighbours().filter(|i| !is_kinematic(i));
        for i in spring_neighbours.chain(other_neighbours).filter(|&i| i < bodies.moving()) {
            match visited.get(i) {
                Some(&(_, from)) if from == candidate => {}
                // It was visited in a search that ended: in an island that is at rest all bodies were.
                Some(_) => return false,
                None if rest[i] < ticks => return false,
                None => {
                    visited.get_or_insert(i, || (i, candidate));
                    members.push(i);
                }
            }
        }
    }
    true
}

/// The force fields, colliders, contacts and joints of a world, which join its bodies.
#[derive(Clone, Copy)]
pub(crate) struct Joins<'a, S: Scalar> {
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) colliders: &'a ColliderSet<S>,
    pub(crate) contacts: &'a ContactSet,
    pub(crate) joints: Joined<'a>,
}

impl<'a, S: Scalar> Joins<'a, S> {
    /// The bodies that have a contact with a body, where one of the two is asleep; each with true if no impulse is left.
    pub(crate) fn touching(self, body: BodyId) -> impl Iterator<Item = (BodyId, bool)> + use<'a, S> {
        let touching = self.colliders.of(body).flat_map(move |collider| self.contacts.asleep_with(collider.slot));
        touching.filter_map(move |(slot, is_slack)| Some((self.colliders.at(slot)?.body, is_slack)))
    }

    /// The bodies that contacts join to a body, where one of the two is asleep.
    fn by_contacts(self, body: BodyId) -> impl Iterator<Item = BodyId> + use<'a, S> {
        self.touching(body).filter(|(_, is_slack)| !is_slack).map(|(body, _)| body)
    }
}

/// The island of a moving body, by indices in the columns, as far as springs, joints and the contacts of the last step join it; with the kinematic
/// bodies that it touches or is joined to.
pub(crate) fn awake_island<S: Scalar>(bodies: &Bodies<S>, joins: Joins<'_, S>, body: usize) -> Vec<usize> {
    let Joins { fields, colliders, contacts, joints } = joins;
    let mut touching = Touching::default();
    // Records without an impulse are there for events alone.
    for record in contacts.records.iter().filter(|record| !record.is_slack()) {
        let slots = record.pair().map(|outline| colliders.at(outline.slot).map(|collider| collider.body.slot));
        if let [Some(first), Some(second)] = slots {
            touching.push(first, second);
            touching.push(second, first);
        }
    }
    touching.sort();
    let mut members = Vec::from([body]);
    let mut visited = BTreeSet::from([body]);
    let mut next = 0;
    while let Some(&member) = members.get(next) {
        next += 1;
        let member_id = bodies.id(member);
        let spring_partners = joined_by_springs(fields, member_id).filter_map(|joined| bodies.find(joined).ok());
        // A kinematic body joins nothing by contacts and joints.
        let is_kinematic = bodies.info(member).kind == BodyKind::Kinematic;
        let slots = touching.touched_by(member_id.slot).chain(joints.partners(member_id.slot));
        let neighbours = slots.filter(|_| !is_kinematic).filter_map(|slot| bodies.index_in(slot));
        for i in spring_partners.chain(neighbours).filter(|&i| i < bodies.moving()) {
            if visited.insert(i) {
                members.push(i);
            }
        }
    }
    members
}

/// Wakes these bodies and the islands that they are in. Adds the bodies that slept to `woken`, in the order in which they are found.
/// [`ContactSet::wake`] is due if there are any.
pub(crate) fn wake<S: Scalar>(
    bodies: &mut Bodies<S>,
    joins: Joins<'_, S>,
    reached: impl IntoIterator<Item = BodyId>,
    woken: &mut Vec<BodyId>,
) {
    let mut next = woken.len();
    reached.into_iter().for_each(|body| wake_one(bodies, body, woken));
    // An island sleeps as a whole: around a body that was awake nobody sleeps.
    while let Some(&body) = woken.get(next) {
        let joined = joined_by_springs(joins.fields, body).chain(joins.by_contacts(body));
        joined.for_each(|joined| wake_one(bodies, joined, woken));
        for slot in joins.joints.partners(body.slot) {
            let is_dynamic = |i: &usize| bodies.info(*i).kind == BodyKind::Dynamic;
            let Ok(member) = bodies.find(body) else { continue };
            // A kinematic body joins nothing by joints.
            if let Some(partner) = bodies.index_in(slot).filter(|i| is_dynamic(i) && is_dynamic(&member)) {
                wake_one(bodies, bodies.id(partner), woken);
            }
        }
        next += 1;
    }
}

fn wake_one<S: Scalar>(bodies: &mut Bodies<S>, body: BodyId, woken: &mut Vec<BodyId>) {
    if let Ok(dense) = bodies.find(body) {
        if bodies.activity(dense) == Activity::Asleep {
            bodies.set_activity(dense, Activity::Awake);
            woken.push(body);
        }
    }
}

/// The bodies at the ends of the springs of a body, itself among them.
fn joined_by_springs<S: Scalar>(fields: &FieldSet<S>, body: BodyId) -> impl Iterator<Item = BodyId> + use<'_, S> {
    let is_spring = |field: &ForceField<S>| matches!(field.kind, FieldKind::Spring { .. });
    fields.attached_to(body).filter(move |(_, field)| is_spring(field)).flat_map(|(_, field)| field.bodies())
}
