//! Contacts: pairs, manifolds, impulses, and what they change of the free flight.
//!
//! Reads: colliders, the motion at the start and at the end of the free flight, masses, the impulses of the step before. Writes:
//! impulses; positions, angles, velocities and ticks at rest of bodies that impulses push; faults; the activities of sleeping
//! bodies that are touched.
//!
//! A body without impulses keeps the bits of its free flight. One with impulses is not at rest: the solver holds it to within half a unit
//! of its velocities, and not to the bit.

use alloc::vec::Vec;
use core::ops::Range;

use super::{Constants, Step, bounds, show};
use crate::body::{Bodies, Change};
use crate::collider::{ColliderSet, ContactSettings};
use crate::contact::{ContactEngine as _, ContactSet, Correction, Detected, Scene, Start};
use crate::error::Cause;
use crate::integrate::{BlockFactors, Schedule, StageKind, cap};
use crate::island;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Angle as _, Scalar};

/// The colliders and the contacts of a world.
pub(crate) struct Contacts<'a, S: Scalar> {
    pub(crate) colliders: &'a ColliderSet<S>,
    pub(crate) contacts: &'a mut ContactSet,
    pub(crate) settings: &'a ContactSettings<S>,
}

/// Memory that contacts use again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    engine: S::Contacts,
    /// The revision of the colliders at the last step; `None` if what is below belongs to other bodies.
    revision: Option<u64>,
    /// The slots of the moving bodies with colliders.
    slots: Vec<u32>,
    may_have_moved_statics: bool,
    starts: Vec<Start<S>>,
    corrections: Vec<Correction<S>>,
    detected: Detected,
}

impl<S: Scalar> Workspace<S> {
    /// Forgets which bodies there are. The tree of static colliders stays: it is compared before it is used.
    pub(super) fn drop_cached(&mut self) {
        self.revision = None;
    }

    pub(super) fn clone_cached_from(&mut self, source: &Self) {
        self.revision = source.revision;
        self.slots.clone_from(&source.slots);
        self.engine.clone_cached_from(&source.engine);
    }

    /// Lists the moving bodies with colliders, if calls or the last step may have changed which those are.
    pub(super) fn survey(&mut self, bodies: &Bodies<S>, colliders: &ColliderSet<S>) {
        // What only changes motion changes no static body.
        let is_motion = |&(slot, change): &(u32, Change)| {
            !change.is_any_of(Change::FORCES) && bodies.index_in(slot).is_some_and(|dense| dense < bodies.moving())
        };
        let are_motions = bodies.changes().bodies().is_some_and(|changed| changed.iter().all(is_motion));
        self.may_have_moved_statics = self.revision.is_none() || !are_motions;
        if self.revision == Some(colliders.revision()) && !self.may_have_moved_statics {
            return;
        }
        self.revision = Some(colliders.revision());
        self.slots.clear();
        if !colliders.is_empty() {
            let moving = bodies.columns.slot[..bodies.moving()].iter();
            self.slots.extend(moving.filter(|&&slot| colliders.of_slot(slot).next().is_some()));
        }
    }

    /// Keeps the motion of moving bodies with colliders before their free flight.
    pub(super) fn begin(&mut self, bodies: &Bodies<S>) {
        self.starts.clear();
        let indices = self.slots.iter().filter_map(|&slot| bodies.index_in(slot));
        self.starts.extend(indices.map(|dense| Start::of(bodies, dense)));
    }

    /// Returns true if nothing can touch anything.
    pub(super) fn is_idle(&self, bodies: &Bodies<S>, colliders: &ColliderSet<S>, contacts: &ContactSet) -> bool {
        // A static body may have been put into a sleeping one.
        let may_wake = || bodies.any_asleep() && !colliders.is_empty();
        self.starts.is_empty() && contacts.records.is_empty() && !may_wake()
    }
}

impl<S: Scalar> Step<'_, S> {
    /// Lists the moving bodies with colliders.
    pub(super) fn survey_contacts(&mut self) {
        let Self { bodies, contacts, workspace, .. } = self;
        if workspace.contacts.is_some() || !contacts.colliders.is_empty() {
            workspace.contacts.get_or_insert_default().survey(bodies, contacts.colliders);
        }
    }

    /// Returns true if nothing can touch anything.
    pub(super) fn are_contacts_idle(&self) -> bool {
        let Contacts { colliders, contacts, .. } = &self.contacts;
        self.workspace.contacts.as_ref().is_none_or(|own| own.is_idle(self.bodies, colliders, contacts))
    }

    /// Finds and solves the contacts of the step.
    pub(super) fn run_contacts(&mut self, constants: &Constants<'_, S>, schedule: Schedule) {
        let Some(mut own) = self.workspace.contacts.take() else { return };
        self.leave_out_faulty(&mut own);
        let stale = own.may_have_moved_statics;
        loop {
            own.detected.touched.clear();
            own.detected.crowded.clear();
            let Workspace { engine, detected, corrections, starts, .. } = &mut *own;
            let starts: &[Start<S>] = starts;
            let scene = Scene {
                bodies: self.bodies,
                colliders: self.contacts.colliders,
                starts,
                may_have_moved_statics: stale,
                settings: self.contacts.settings,
                time_step: self.settings.time_step,
            };
            engine.detect(&scene, self.contacts.contacts, detected);
            if detected.touched.is_empty() && detected.crowded.is_empty() {
                if self.probe.is_some() {
                    self.contacts.contacts.records.clear();
                    engine.list(&mut self.contacts.contacts.records);
                    show(&mut self.probe, StageKind::Detect, self.bodies, self.contacts.contacts);
                }
                engine.solve(&scene, corrections);
                self.contacts.contacts.records.clear();
                engine.list(&mut self.contacts.contacts.records);
                if !own.corrections.is_empty() {
                    self.contacts.contacts.pushed_at = self.settings.tick;
                }
                self.show(StageKind::Solve);
                self.correct(&own, constants);
                self.show(StageKind::Push);
                break;
            }
            // Those who wake may be crowded: then they are found once more.
            if detected.touched.is_empty() {
                self.refuse_crowded(&mut own);
            } else {
                self.wake_touched(&mut own, constants, schedule);
            }
        }
        self.workspace.contacts = Some(own);
    }

    /// Takes bodies with too many pairs back to the start, at fault.
    fn refuse_crowded(&mut self, own: &mut Workspace<S>) {
        own.detected.crowded.sort_unstable();
        own.detected.crowded.dedup();
        let is_crowded = |start: &Start<S>| own.detected.crowded.binary_search(&start.dense).is_ok();
        for start in own.starts.iter().filter(|start| is_crowded(start)) {
            start.restore(self.bodies);
            self.workspace.found.faults.push((start.dense, Cause::Pairs));
        }
        own.starts.retain(|start| !is_crowded(start));
    }

    /// Wakes sleeping bodies that are touched, and lets them fly freely over the step.
    fn wake_touched(&mut self, own: &mut Workspace<S>, constants: &Constants<'_, S>, schedule: Schedule) {
        own.detected.touched.sort_unstable();
        own.detected.touched.dedup();
        let first = self.bodies.moving();
        let touched = own.detected.touched.iter().copied();
        let woke = &mut self.workspace.report.woke;
        island::wake(self.bodies, self.forces.fields, touched, woke);
        woke.sort_unstable();
        let indices = first..self.bodies.moving();
        let colliders = self.contacts.colliders;
        let with_colliders = |dense: &usize| colliders.of_slot(self.bodies.columns.slot[*dense]).next().is_some();
        own.starts.extend(indices.clone().filter(with_colliders).map(|dense| Start::of(self.bodies, dense)));
        self.fly(indices, constants, schedule);
        self.leave_out_faulty(own);
    }

    /// Leaves out bodies that are at fault.
    fn leave_out_faulty(&self, own: &mut Workspace<S>) {
        let faults = &self.workspace.found.faults;
        if !faults.is_empty() {
            own.starts.retain(|start| faults.iter().all(|(i, _)| *i != start.dense));
        }
    }

    /// Takes bodies that woke in the step through the stages of the integrator.
    fn fly(&mut self, indices: Range<usize>, constants: &Constants<'_, S>, schedule: Schedule) {
        // Accelerations are cached for the bodies that were awake before.
        self.workspace.drop_cached_fields();
        let outside = core::mem::take(&mut self.workspace.report.drag_outside);
        // A force that is applied wakes a body at once: none acts on these.
        self.run_coupled(indices, &Constants { applied: &[], ..*constants }, schedule);
        self.workspace.report.drag_outside += outside;
        self.workspace.drop_cached_fields();
    }

    /// Adds what impulses change. A body that leaves the allowed range is taken back to the start.
    fn correct(&mut self, own: &Workspace<S>, constants: &Constants<'_, S>) {
        let bodies = &mut *self.bodies;
        for (start, by) in own.starts.iter().zip(&own.corrections) {
            if !by.is_pushed {
                continue;
            }
            let i = start.dense;
            let motion = &mut bodies.columns.motion;
            let sum = |a: Vec2<S::Accumulator>, b: Vec2<S::Accumulator>| Vec2::new(a.x.plus(b.x), a.y.plus(b.y));
            motion.position.set(i, sum(motion.position.get(i), by.displacement));
            motion.velocity.set(i, sum(motion.velocity.get(i), by.velocity));
            motion.angular_velocity[i] = motion.angular_velocity[i].plus(by.angular_velocity);
            motion.angle[i] = motion.angle[i].turned(by.rotation);
            motion.ticks_at_rest[i] = 0;
            let mut block = bodies.block(i..i + 1);
            if constants.any_capped {
                cap(&mut block, BlockFactors::Each(constants.rows));
            }
            let first = self.workspace.found.faults.len();
            bounds::find_out_of_bounds(&block, &mut self.workspace.found.faults);
            if self.workspace.found.faults.len() > first {
                start.restore(bodies);
            }
            if i < bodies.free_count() {
                self.workspace.free.drop_block(i);
            } else {
                bodies.note(i, Change::POSE.or(Change::VELOCITY));
            }
        }
    }
}
