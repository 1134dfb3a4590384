//! The memory that steps use again, and the report of the last one. None of it is state.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{AppliedAcceleration, JointBroke, JointLoad, contacts, coupled, damp, fields, free, kick, targets};
use crate::body::{Bodies, ChangeCursor};
use crate::collide::broad::Statics;
use crate::collider::ColliderSet;
use crate::contact::{ColliderPair, ContactHit, Pipeline};
use crate::error::{Cause, Fault};
use crate::force::FieldSet;
use crate::island;
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::timers::counted;

/// The memory of each stage.
#[derive(Debug, Default)]
pub(crate) struct Workspace<S: Scalar> {
    pub(super) targets: targets::Workspace<S>,
    pub(super) applied: Vec<AppliedAcceleration<S>>,
    /// How far the caches of the free flight have followed the changes of bodies.
    flown: ChangeCursor,
    pub(super) free: free::Workspace<S>,
    pub(super) coupled: coupled::Workspace<S>,
    pub(super) fields: fields::Workspace<S>,
    pub(super) damp: damp::Workspace<S>,
    pub(super) kick: kick::Workspace<S>,
    /// Made in the first step with a collider.
    pub(super) contacts: Option<Box<contacts::ContactMemory<S>>>,
    pub(super) islands: island::Workspace,
    pub(super) touching: island::Touching,
    pub(super) findings: Findings,
    pub(crate) report: Report<S>,
    #[cfg(feature = "timers")]
    pub(crate) timers: crate::timers::Timers,
}

/// The faults and the candidates for sleep that the passes found, by the indices of the bodies in the columns.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// In the order in which they happened to a body.
    pub(super) faults: Vec<(usize, Cause)>,
    /// Bodies that have been at rest for long enough to try to sleep.
    pub(super) candidates: Vec<usize>,
    /// Workspace: the faults, each with its place in the list.
    placed: Vec<(usize, usize, Cause)>,
}

impl Findings {
    /// Sorts the faults by body; the first fault of a body stays its first. A stable sort would take its memory from the heap.
    pub(super) fn sort_faults(&mut self) {
        let Self { faults, placed, .. } = self;
        placed.clear();
        placed.extend(faults.iter().enumerate().map(|(place, &(dense, cause))| (dense, place, cause)));
        placed.sort_unstable_by_key(|&(dense, place, _)| (dense, place));
        faults.clear();
        faults.extend(placed.iter().map(|&(dense, _, cause)| (dense, cause)));
    }

    /// Takes over the findings about other bodies.
    #[cfg(feature = "parallel")]
    pub(super) fn append(&mut self, findings: &mut Self) {
        self.faults.append(&mut findings.faults);
        self.candidates.append(&mut findings.candidates);
    }
}

/// The report of the last step.
#[derive(Debug, Default)]
pub(crate) struct Report<S> {
    pub(crate) faults: Vec<Fault>,
    pub(crate) fell_asleep: Vec<BodyId>,
    /// Sleeping bodies that moving ones touched.
    pub(crate) woke: Vec<BodyId>,
    /// Events of contacts and of sensors, each kind sorted.
    pub(crate) contacts_ended: Vec<ColliderPair>,
    pub(crate) contacts_began: Vec<ColliderPair>,
    pub(crate) hits: Vec<ContactHit<S>>,
    pub(crate) sensors_left: Vec<ColliderPair>,
    pub(crate) sensors_entered: Vec<ColliderPair>,
    pub(crate) sensors_crossed: Vec<ColliderPair>,
    pub(crate) joints_broke: Vec<JointBroke<S>>,
    pub(crate) joint_loads: Vec<JointLoad<S>>,
    pub(crate) drag_outside: u32,
}

clone_by_field!([S: Clone] Report<S> {
    faults,
    fell_asleep,
    woke,
    contacts_ended,
    contacts_began,
    hits,
    sensors_left,
    sensors_entered,
    sensors_crossed,
    joints_broke,
    joint_loads,
    drag_outside,
});

impl<S> Report<S> {
    pub(crate) fn clear(&mut self) {
        self.faults.clear();
        self.fell_asleep.clear();
        self.woke.clear();
        self.contacts_ended.clear();
        self.contacts_began.clear();
        self.hits.clear();
        self.sensors_left.clear();
        self.sensors_entered.clear();
        self.sensors_crossed.clear();
        self.joints_broke.clear();
        self.joint_loads.clear();
        self.drag_outside = 0;
    }
}

impl<S: Scalar> Workspace<S> {
    #[cfg(feature = "selftest")]
    pub(crate) fn do_without(&mut self, ends: bool, speculation: bool) {
        self.contacts.get_or_insert_default().do_without(ends, speculation);
    }

    #[cfg(all(feature = "parallel", feature = "selftest"))]
    pub(crate) fn share(&mut self, least: usize) {
        self.free.share(least);
        self.contacts.get_or_insert_default().solvers.share(least);
    }

    /// Makes it ready for a step: drops the caches of bodies that changed since the last one, and forgets the changes that all caches have
    /// followed.
    pub(super) fn begin(&mut self, bodies: &mut Bodies<S>, fields: &FieldSet<S>) {
        self.findings.faults.clear();
        self.findings.candidates.clear();
        if !bodies.changes().is_nothing_since(self.flown) {
            let have_fields_changed = bodies.changes().have_group_fields_changed(self.flown);
            let changed = bodies.changes().since(self.flown).filter(|_| !have_fields_changed);
            self.free.drop_changed(bodies, changed);
            self.fields.drop_changed(bodies, fields, changed);
            self.flown = bodies.changes_mut().read();
        }
        let [surveyed, detected] = self.contacts.as_ref().map_or([self.flown; 2], |memory| memory.cursors());
        bodies.forget_changes(&[self.flown, surveyed, detected]);
        counted!(self, steps, 1);
    }

    /// The static colliders of the last step and the pipeline that numbers them, if they stand where they did then.
    pub(crate) fn statics(&self, bodies: &Bodies<S>, colliders: &ColliderSet<S>) -> Option<(&Arc<Statics>, &Pipeline)> {
        self.contacts.as_ref()?.current_statics(bodies, colliders)
    }

    /// Drops all caches: they belong to other bodies. A step without caches has the same bits.
    pub(crate) fn drop_cached(&mut self) {
        self.flown = ChangeCursor::default();
        self.free.drop_cached();
        self.fields.drop_cached();
        if let Some(contacts) = &mut self.contacts {
            contacts.drop_cached();
        }
    }

    /// Drops the accelerations and directions that are cached of coupled bodies.
    pub(super) fn drop_cached_fields(&mut self) {
        self.fields.drop_cached();
    }

    /// Does the same as `clone_from`, and copies the caches: for a copy of the world that `source` belongs to.
    pub(crate) fn clone_cached_from(&mut self, source: &Self) {
        self.clone_from(source);
        self.flown = source.flown;
        self.free.clone_cached_from(&source.free);
        self.fields.clone_cached_from(&source.fields);
        if let Some(contacts) = &source.contacts {
            self.contacts.get_or_insert_default().clone_cached_from(contacts);
        }
    }
}

/// The report alone: a step makes the rest anew.
impl<S: Scalar> Clone for Workspace<S> {
    fn clone(&self) -> Self {
        Self { report: self.report.clone(), ..Self::default() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.drop_cached();
        self.report.clone_from(&source.report);
    }
}
