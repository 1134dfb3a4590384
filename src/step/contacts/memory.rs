//! The memory of contacts: caches from step to step, with the changes of bodies and colliders that they have not followed yet, and lists that
//! a step uses again.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::Contacts;
use crate::body::{Bodies, BodyKind, Change, ChangeCursor};
use crate::collide::broad::Statics;
use crate::collider::{Collider, ColliderSet, ContactSettings};
use crate::contact::{
    Changed, ContactSet, Correction, Detected, MovingBody, Overlap, Pipeline, Sensors, Solvers, Start, Stop,
};
use crate::island::Touching;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// How far a cache has followed the changes of bodies and colliders.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Followed {
    bodies: ChangeCursor,
    /// The revision of the colliders; `None` if the cache belongs to other bodies.
    colliders: Option<u64>,
}

impl Followed {
    /// The position after all changes so far.
    pub(super) fn all<S: Scalar>(bodies: &mut Bodies<S>, colliders: &ColliderSet<S>) -> Self {
        Self { bodies: bodies.changes_mut().read(), colliders: Some(colliders.revision()) }
    }
}

/// The memory of the contacts of a world, from step to step and within a step. No result depends on it.
#[derive(Debug, Default)]
pub(in super::super) struct ContactMemory<S: Scalar> {
    pub(super) pipeline: Pipeline,
    pub(in super::super) solvers: Solvers<S::Solver>,
    /// The last survey, which listed the moving bodies with colliders that meet others or with joints, and the revision of the joints in it.
    surveyed: Followed,
    surveyed_joints: u64,
    /// The last step in which contacts were detected.
    pub(super) detected_at: Followed,
    /// The moving bodies with colliders that meet others, or with joints.
    moving: Vec<MovingBody>,
    pub(super) may_have_moved_statics: bool,
    /// The changes since the last step in which contacts were detected.
    pub(super) changed: Changed,
    /// True if the pipeline holds the contacts of this step.
    pub(super) is_detected: bool,
    pub(super) starts: Vec<Start<S>>,
    /// The starts in fixed point; empty in a world of `Fx`.
    pub(super) fixed_starts: Vec<Start>,
    pub(super) corrections: Vec<Correction>,
    pub(super) detected: Detected,
    pub(super) stops: Vec<Stop>,
    /// The bodies at fault, sorted, by their indices in the columns.
    pub(super) at_fault: Vec<usize>,
    /// The slots of colliders that touch and have events, before and after the step.
    pub(in super::super) touching_before: Vec<[u32; 2]>,
    pub(in super::super) touching_after: Vec<[u32; 2]>,
    pub(super) sensors: Sensors,
    /// No path ends early.
    #[cfg(feature = "selftest")]
    pub(super) is_blind: bool,
}

/// Returns true if a change of a body is one of the motion of a moving body alone.
fn is_motion<S: Scalar>(bodies: &Bodies<S>, &(slot, change): &(u32, Change)) -> bool {
    !change.is_any_of(Change::FORCES) && bodies.index_in(slot).is_some_and(|dense| dense < bodies.moving())
}

/// Returns true if more than the colliders of a body changed.
fn is_of_body(&(_, change): &(u32, Change)) -> bool {
    change.is_any_of(Change::VELOCITY.or(Change::POSE).or(Change::FORCES))
}

impl<S: Scalar> ContactMemory<S> {
    /// The pipeline with the static colliders of the last step, if they stand where they did then.
    pub(in super::super) fn current_statics(
        &self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
    ) -> Option<(&Arc<Statics>, &Pipeline)> {
        let statics = self.pipeline.statics(colliders.fixed())?;
        // A body that is not static, and was not when the trees were last updated. A collider more or less makes another revision.
        let was_static = |collider: &Collider<S>| statics.find(self.pipeline.number(collider.slot)).is_some();
        let is_not_static = |slot: u32| {
            bodies.index_in(slot).is_none_or(|dense| bodies.info(dense).kind != BodyKind::Static)
                && !colliders.of_slot(slot).any(was_static)
        };
        let Followed { bodies: cursor, colliders: revision } = self.detected_at;
        let is_current = revision == Some(colliders.revision())
            && bodies
                .changes()
                .since(cursor)
                .is_some_and(|changes| changes.iter().all(|&(slot, _)| is_not_static(slot)));
        is_current.then_some((statics, &self.pipeline))
    }

    /// Drops the caches of bodies. The tree of static colliders stays: it is compared before it is used.
    pub(in super::super) fn drop_cached(&mut self) {
        self.surveyed = Followed::default();
        self.detected_at = Followed::default();
        self.sensors.forget();
    }

    pub(in super::super) fn clone_cached_from(&mut self, source: &Self) {
        self.surveyed = source.surveyed;
        self.surveyed_joints = source.surveyed_joints;
        self.detected_at = source.detected_at;
        self.moving.clone_from(&source.moving);
        self.pipeline.clone_cached_from(&source.pipeline);
    }

    /// Does without continuous collision, for tests: without the ends of paths, and without speculative contacts.
    #[cfg(feature = "selftest")]
    pub(in super::super) fn do_without(&mut self, ends: bool, speculation: bool) {
        self.is_blind = ends;
        self.pipeline.set_discrete(speculation);
    }

    /// How far the survey and the detection have followed the changes of bodies.
    pub(in super::super) fn cursors(&self) -> [ChangeCursor; 2] {
        [self.surveyed.bodies, self.detected_at.bodies]
    }

    /// Lists the moving bodies with colliders that meet others or with joints, if calls or the last step may have changed the list.
    pub(in super::super) fn survey(&mut self, bodies: &mut Bodies<S>, contacts: &Contacts<'_, S>) {
        let colliders = contacts.colliders;
        let joints = contacts.joined();
        let Followed { bodies: cursor, colliders: revision } = self.surveyed;
        // A change of motion alone changes no static body.
        let changes = bodies.changes().since(cursor);
        let are_motions = changes.is_some_and(|changes| changes.iter().all(|change| is_motion(bodies, change)));
        self.may_have_moved_statics = !are_motions;
        self.surveyed = Followed::all(bodies, colliders);
        let joints_revision = core::mem::replace(&mut self.surveyed_joints, contacts.joints.revision());
        if revision == Some(colliders.revision()) && joints_revision == self.surveyed_joints && are_motions {
            return;
        }
        self.moving.clear();
        if colliders.any_meeting() || !joints.is_empty() {
            let slots = &bodies.columns.slot[..bodies.moving()];
            let body = |&slot: &u32| MovingBody::new(bodies, colliders.fixed(), &joints, slot);
            self.moving.extend(slots.iter().filter_map(body));
        }
    }

    /// Lists the changes since the last step in which contacts were detected. Returns false if anything may have changed.
    pub(super) fn list_changed(&mut self, bodies: &Bodies<S>, colliders: &ColliderSet<S>) -> bool {
        self.changed.clear();
        let Followed { bodies: cursor, colliders: revision } = self.detected_at;
        let Some(changes) = bodies.changes().since(cursor) else { return false };
        let Some(slots) = revision.and_then(|revision| colliders.changed_since(revision)) else { return false };
        for change in changes.iter().filter(|change| !is_motion(bodies, change)) {
            let list = if is_of_body(change) { &mut self.changed.bodies } else { &mut self.changed.owners };
            list.push(change.0);
        }
        self.changed.colliders.extend(slots);
        true
    }

    /// Keeps the motion of the listed bodies before their free flight.
    pub(in super::super) fn begin(&mut self, bodies: &Bodies<S>) {
        self.is_detected = false;
        self.touching_before.clear();
        self.sensors.begin();
        self.starts.clear();
        // The survey of this step has listed no body that is gone.
        let index = |body: &MovingBody| bodies.index_in(body.slot).unwrap_or_default();
        self.starts.extend(self.moving.iter().map(|body| Start::of(bodies, index(body), body)));
    }

    /// Lists which bodies touched each other in the step.
    pub(in super::super) fn list_touching(
        &self,
        bodies: &Bodies<S>,
        contacts: &Contacts<'_, S>,
        touching: &mut Touching,
    ) {
        if !self.is_detected {
            return;
        }
        let is_dynamic =
            |slot: u32| bodies.index_in(slot).is_some_and(|dense| bodies.info(dense).kind == BodyKind::Dynamic);
        self.pipeline.touching(contacts.colliders.fixed(), |pair, is_driven| {
            for [body, other_body] in [pair, [pair[1], pair[0]]] {
                if is_dynamic(body) {
                    touching.push(body, other_body);
                    if is_driven {
                        touching.push_driven(body);
                    }
                }
            }
        });
        touching.sort();
    }

    /// Finds the overlaps of sensors at the end of the step. *Domain* the contacts of the step were detected.
    pub(in super::super) fn find_overlaps(
        &mut self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet,
        fell_asleep: &[BodyId],
        settings: &ContactSettings,
    ) {
        self.sensors.find(bodies, colliders, &self.pipeline, fell_asleep, settings);
    }

    /// The overlaps of sensors, sorted.
    pub(in super::super) fn overlaps(&self) -> &[Overlap] {
        &self.sensors.overlaps
    }

    /// The colliders that crossed sensors within the step and overlap them no more, sorted.
    pub(in super::super) fn crossed(&self) -> &[Overlap] {
        &self.sensors.crossed
    }

    /// Returns true if nothing can touch anything.
    pub(in super::super) fn is_idle(
        &self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        contacts: &ContactSet,
    ) -> bool {
        // A static body may have been put into a sleeping one.
        let may_wake = self.may_have_moved_statics && bodies.any_asleep() && colliders.any_meeting();
        let is_empty = contacts.records.is_empty() && contacts.passes.is_empty() && !contacts.any_until_apart();
        !colliders.any_sensors() && self.starts.is_empty() && is_empty && !may_wake
    }
}
