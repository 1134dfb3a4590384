//! Contacts and joints: pairs, manifolds, impulses, and their changes of the free flight.
//!
//! Reads: colliders, joints, the motion at the start and at the end of the free flight, masses, the impulses of the step before. Writes:
//! impulses; positions, angles, velocities and ticks at rest of bodies that impulses push; faults; the activities of sleeping
//! bodies that are touched; which joints are broken.
//!
//! A body without impulses keeps the bits of its free flight. One with impulses is not at rest: the solver holds it to within half a unit
//! of its velocities, and not to the bit.

mod breaking;
mod memory;
mod stops;
mod turns;

use alloc::vec::Vec;
use core::ops::Range;

pub use breaking::{JointBroke, JointLoad};
pub(super) use memory::ContactMemory;
use memory::Followed;

use super::sleep::{has_stayed, is_slow};
use super::{Constants, Findings, Step, bounds, show};
use crate::body::{Bodies, Change};
use crate::collider::{ColliderSet, ContactSettings};
use crate::contact::{Changed, ContactSet, MovingBody, ROUNDS, Scene, Start, is_asleep, list_pairs};
use crate::error::Cause;
use crate::fx::Fx;
use crate::integrate::{BlockFactors, Schedule, StageKind, cap};
use crate::island::{self, Joins, is_candidate};
use crate::joint::{Joined, JointSet, JointStates};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator, Angle as _, FxAccumulator, Scalar};
use crate::timers::{counted, timed};

/// The colliders, the contacts and the joints of a world.
pub(crate) struct Contacts<'a, S: Scalar> {
    pub(crate) colliders: &'a ColliderSet<S>,
    pub(crate) contacts: &'a mut ContactSet,
    pub(crate) joints: &'a JointSet<S>,
    pub(crate) joint_states: &'a mut JointStates,
    pub(crate) settings: &'a ContactSettings<S>,
}

impl<S: Scalar> Contacts<'_, S> {
    /// The joints as they are now.
    pub(super) fn joined(&self) -> Joined<'_> {
        self.joints.joined(self.joint_states)
    }
}

/// Lists the bodies of faults.
fn list_faulty(faults: &[(usize, Cause)], bodies: &mut Vec<usize>) {
    bodies.clear();
    bodies.extend(faults.iter().map(|(dense, _)| *dense));
    bodies.sort_unstable();
}

/// Finds whether a body left the allowed range; then it is at fault.
fn leaves_range<S: Scalar>(bodies: &Bodies<S>, dense: usize, findings: &mut Findings) -> bool {
    bounds::is_out_of_bounds(&bodies.columns.motion, dense, &mut findings.faults)
}

/// The scene of bodies after contacts were detected: nothing has changed.
fn scene<'a, S: Scalar>(
    bodies: &'a Bodies<S>,
    colliders: &'a ColliderSet<S>,
    contacts: &'a ContactSet,
    joints: Joined<'a>,
    starts: &'a [Start],
    settings: &'a ContactSettings,
    time_step: TimeStep,
) -> Scene<'a> {
    let colliders = colliders.fixed();
    Scene {
        bodies,
        colliders,
        contacts,
        joints,
        starts,
        may_have_moved_statics: false,
        changed: Some(Changed::NONE),
        settings,
        time_step,
    }
}

/// Why detected contacts are not the contacts of the step.
#[derive(Clone, Copy)]
enum Blocked {
    /// Sleeping bodies are touched: they wake and move with the others.
    Sleepers,
    /// Bodies have too many pairs: they are taken back to the start, at fault.
    Crowded,
}

impl<S: Scalar> Step<'_, S> {
    /// Lists the moving bodies with colliders that meet others, or with joints.
    pub(super) fn survey_contacts(&mut self) {
        let Self { bodies, contacts, workspace, .. } = self;
        let Contacts { colliders, joints, .. } = contacts;
        let may_touch = colliders.any_meeting() || contacts.contacts.any_until_apart() || joints.len() > 0;
        if workspace.contacts.is_some() || may_touch {
            workspace.contacts.get_or_insert_default().survey(bodies, contacts);
        }
    }

    /// Returns true if nothing can touch anything, and no joint moves anything.
    pub(super) fn are_contacts_idle(&self) -> bool {
        let Contacts { colliders, contacts, .. } = &self.contacts;
        self.workspace.contacts.as_ref().is_none_or(|memory| memory.is_idle(self.bodies, colliders, contacts))
    }

    /// Finds and solves the contacts of the step, and changes the free flight by their impulses.
    pub(super) fn run_contacts(&mut self, constants: &Constants<'_, S>, schedule: Schedule) {
        let Some(mut memory) = self.workspace.contacts.take() else { return };
        self.leave_out_faulty(&mut memory, 0, 0);
        memory.is_detected = true;
        let settings = self.contacts.settings.to_fx();
        while let Some(blocked) = self.solve_contacts(&mut memory, &settings) {
            match blocked {
                Blocked::Sleepers => self.wake_touched(&mut memory, &settings, constants, schedule),
                Blocked::Crowded => self.refuse_crowded(&mut memory),
            }
        }
        timed!(self.workspace, events, self.list_contacts(&mut memory, &settings));
        self.show(StageKind::Solve);
        timed!(self.workspace, apply, self.correct(&memory, constants));
        timed!(self.workspace, sweeps, self.end_paths(&mut memory, &settings, constants));
        timed!(self.workspace, sweeps, self.follow_paths(&mut memory, &settings));
        self.count_turns(&memory);
        self.keep_driven_awake(&memory);
        self.break_joints(&memory);
        counted!(self.workspace, stops, memory.stops.len());
        self.show(StageKind::Push);
        #[cfg(feature = "timers")]
        {
            self.workspace.timers += core::mem::take(&mut memory.pipeline.timers);
        }
        memory.detected_at = Followed::all(self.bodies, self.contacts.colliders);
        memory.detected.changed_resting.clear();
        self.workspace.contacts = Some(memory);
    }

    /// Detects the contacts of the bodies that take part, and solves them. Impulses send bodies where they meet others: such contacts are
    /// added and all are solved again, up to [`ROUNDS`] times. Returns the reason why the contacts are not the contacts of the step, if
    /// there is one.
    fn solve_contacts(&mut self, memory: &mut ContactMemory<S>, settings: &ContactSettings) -> Option<Blocked> {
        let are_all_listed = timed!(self.workspace, pairs, memory.list_changed(self.bodies, self.contacts.colliders));
        let ContactMemory { pipeline, solvers, starts, fixed_starts, corrections, detected, changed, .. } = memory;
        detected.touched.clear();
        detected.crowded.clear();
        let starts = Start::all_fixed(starts, fixed_starts);
        let scene = Scene {
            may_have_moved_statics: memory.may_have_moved_statics,
            changed: are_all_listed.then_some(changed),
            ..self.unchanged(starts, settings)
        };
        pipeline.detect(&scene, detected);
        if !detected.touched.is_empty() {
            return Some(Blocked::Sleepers);
        }
        if !detected.crowded.is_empty() {
            return Some(Blocked::Crowded);
        }
        pipeline.solve(solvers, &scene, corrections);
        let mut rounds = 0;
        while rounds < ROUNDS
            && timed!(pipeline, deflected, pipeline.add_deflected(&scene, corrections, &mut detected.touched))
        {
            pipeline.solve_again(solvers, &scene, corrections);
            rounds += 1;
        }
        if rounds == ROUNDS {
            timed!(pipeline, deflected, pipeline.find_deflected(&scene, corrections));
        }
        (!detected.touched.is_empty()).then_some(Blocked::Sleepers)
    }

    /// Writes the contacts of the step, with their impulses, to the state, and hits to the report.
    fn list_contacts(&mut self, memory: &mut ContactMemory<S>, settings: &ContactSettings) {
        let ContactMemory { pipeline, starts, fixed_starts, corrections, touching_before, .. } = memory;
        let Contacts { colliders, contacts, joints, joint_states, .. } = &mut self.contacts;
        if colliders.any_contact_events() {
            list_pairs(&contacts.records, colliders.fixed(), touching_before);
        }
        let had_passes = !contacts.passes.is_empty();
        let excluded = contacts.excluded.len();
        if self.probe.is_some() {
            pipeline.swap_starts();
            pipeline.list(contacts);
            show(&mut self.probe, StageKind::Detect, self.bodies, contacts, joint_states);
            pipeline.swap_starts();
        }
        pipeline.list(contacts);
        if colliders.any_hit_events() {
            let starts = Start::all_fixed(starts, fixed_starts);
            let joined = joints.joined(joint_states);
            let scene = scene(self.bodies, colliders, contacts, joined, starts, settings, self.settings.time_step);
            pipeline.list_hits(&scene, &mut self.workspace.report.hits);
        }
        let has_passes = had_passes || !contacts.passes.is_empty() || contacts.excluded.len() < excluded;
        let are_any_pushed = !corrections.is_empty();
        // Contacts that touched without an impulse are state that the step before does not have.
        if has_passes || are_any_pushed && !pipeline.has_no_contacts() || !contacts.records.is_empty() {
            contacts.pushed_at = self.settings.tick;
        }
        pipeline.joints().store(joint_states, are_any_pushed.then_some(self.settings.tick));
    }

    /// The scene of the bodies after contacts were detected.
    fn unchanged<'a>(&'a self, starts: &'a [Start], settings: &'a ContactSettings) -> Scene<'a> {
        let Contacts { colliders, contacts, .. } = &self.contacts;
        scene(self.bodies, colliders, contacts, self.contacts.joined(), starts, settings, self.settings.time_step)
    }

    /// Takes bodies with too many pairs back to the start, at fault.
    fn refuse_crowded(&mut self, memory: &mut ContactMemory<S>) {
        memory.detected.crowded.sort_unstable();
        memory.detected.crowded.dedup();
        let is_crowded = |start: &Start<S>| memory.detected.crowded.binary_search(&start.dense).is_ok();
        for start in memory.starts.iter().filter(|start| is_crowded(start)) {
            start.restore(self.bodies);
            self.workspace.findings.faults.push((start.dense, Cause::Pairs));
        }
        memory.starts.retain(|start| !is_crowded(start));
    }

    /// Wakes touched sleeping bodies, then the bodies that they touch, and so on, and lets them fly freely over the step.
    fn wake_touched(
        &mut self,
        memory: &mut ContactMemory<S>,
        settings: &ContactSettings,
        constants: &Constants<'_, S>,
        schedule: Schedule,
    ) {
        while !memory.detected.touched.is_empty() {
            let first_start = memory.starts.len();
            let first_fault = self.workspace.findings.faults.len();
            let indices = timed!(self.workspace, waking, self.wake(memory));
            self.fly(indices, constants, schedule);
            timed!(self.workspace, waking, {
                self.leave_out_faulty(memory, first_start, first_fault);
                let starts = &Start::all_fixed(&memory.starts, &mut memory.fixed_starts)[first_start..];
                memory.detected.touched.clear();
                memory.pipeline.spread(&self.unchanged(starts, settings), &mut memory.detected);
            });
        }
        self.workspace.report.woke.sort_unstable();
        let Contacts { colliders, contacts, .. } = &mut self.contacts;
        timed!(self.workspace, waking, contacts.wake(|slot| is_asleep(self.bodies, colliders, slot)));
    }

    /// Wakes touched sleeping bodies and their islands, and returns their indices in the columns.
    fn wake(&mut self, memory: &mut ContactMemory<S>) -> Range<usize> {
        memory.detected.touched.sort_unstable();
        memory.detected.touched.dedup();
        let first_woken = self.bodies.moving();
        let touched = memory.detected.touched.iter().copied();
        let woke = &mut self.workspace.report.woke;
        let Contacts { colliders, contacts, .. } = &self.contacts;
        let joints = self.contacts.joined();
        let joins = Joins { fields: self.forces.fields, colliders, contacts, joints };
        island::wake(self.bodies, joins, touched, woke);
        let indices = first_woken..self.bodies.moving();
        memory.starts.extend(indices.clone().filter_map(|dense| {
            let slot = self.bodies.columns.slot[dense];
            let body = MovingBody::new(self.bodies, colliders.fixed(), &joints, slot)?;
            Some(Start::of(self.bodies, dense, &body))
        }));
        indices
    }

    /// Removes the starts from `first_start` on of bodies at fault, by the faults from `first_fault` on.
    fn leave_out_faulty(&self, memory: &mut ContactMemory<S>, first_start: usize, first_fault: usize) {
        let faults = &self.workspace.findings.faults[first_fault..];
        if faults.is_empty() {
            return;
        }
        let ContactMemory { starts, at_fault, .. } = memory;
        list_faulty(faults, at_fault);
        let mut end = first_start;
        for i in first_start..starts.len() {
            if at_fault.binary_search(&starts[i].dense).is_err() {
                starts.swap(end, i);
                end += 1;
            }
        }
        starts.truncate(end);
    }

    /// Takes bodies that woke in the step through the stages of the integrator.
    fn fly(&mut self, indices: Range<usize>, constants: &Constants<'_, S>, schedule: Schedule) {
        // Accelerations are cached for the bodies that were awake before.
        self.workspace.drop_cached_fields();
        let outside = core::mem::take(&mut self.workspace.report.drag_outside);
        // An applied force wakes a body at once: no applied force acts on these bodies.
        self.run_coupled(indices, &Constants { applied: &[], ..*constants }, schedule);
        self.workspace.report.drag_outside += outside;
        self.workspace.drop_cached_fields();
    }

    /// Puts the contacts of bodies that fell asleep aside.
    pub(super) fn put_contacts_to_sleep(&mut self) {
        let Contacts { colliders, contacts, .. } = &mut self.contacts;
        if !(self.workspace.report.fell_asleep.is_empty() || contacts.records.is_empty()) {
            contacts.fall_asleep(|slot| is_asleep(self.bodies, colliders, slot));
        }
    }

    /// Adds the corrections by impulses to the bodies. A body that leaves the allowed range is taken back to the start.
    fn correct(&mut self, memory: &ContactMemory<S>, constants: &Constants<'_, S>) {
        let from_fixed = <S::Accumulator as Accumulator<S>>::from_fixed;
        for (start, correction) in memory.starts.iter().zip(&memory.corrections) {
            if !correction.is_pushed {
                continue;
            }
            let i = start.dense;
            let bodies = &mut *self.bodies;
            let motion = &mut bodies.columns.motion;
            let sum = |from: Vec2<S::Accumulator>, change: Vec2<FxAccumulator>| {
                Vec2::new(from.x.plus(from_fixed(change.x)), from.y.plus(from_fixed(change.y)))
            };
            motion.position.set(i, sum(motion.position.get(i), correction.displacement));
            motion.velocity.set(i, sum(motion.velocity.get(i), correction.velocity));
            motion.angular_velocity[i] = motion.angular_velocity[i].plus(from_fixed(correction.angular_velocity));
            motion.angle[i] = motion.angle[i].turned(from_fixed(correction.rotation));
            if constants.any_capped {
                cap(&mut bodies.block(i..i + 1), BlockFactors::Each(constants.rows));
            }
            if leaves_range(bodies, i, &mut self.workspace.findings) {
                start.restore(bodies);
            } else if start.body.is_dynamic {
                let is_slow = is_slow(self.bodies, self.radius(start), constants.sleep_speed, i);
                self.count_rest(start, is_slow, constants);
            }
            self.note_pushed(i);
        }
    }

    /// The largest distance of a point of a body's colliders, or of one of its joints, from its centre of mass.
    #[inline]
    fn radius(&self, start: &Start<S>) -> S {
        let MovingBody { slot, radius, .. } = start.body;
        if self.contacts.joints.len() == 0 {
            return S::from_fx(radius);
        }
        let joined = self.contacts.joined();
        let radius = joined.reach(slot).max(radius);
        // A joint shows that a body turns, also where no collider and no arm does.
        let is_hidden = radius == Fx::ZERO && joined.has(slot);
        S::from_fx(if is_hidden { Fx::ONE } else { radius })
    }

    /// Counts a step of a body that contacts moved or stopped: it is at rest while it is slow and stays where it is, and nothing else is
    /// applied to it.
    fn count_rest(&mut self, start: &Start<S>, is_slow: bool, constants: &Constants<'_, S>) {
        let i = start.dense;
        let speed = constants.sleep_speed;
        let is_left_alone = constants.applied.binary_search_by_key(&i, |(i, _)| *i).is_err();
        let rests = constants.sleep_after.is_some()
            && is_slow
            && is_left_alone
            && has_stayed(self.bodies, self.radius(start), speed, constants.plan.rate, start);
        let ticks_at_rest = &mut self.bodies.columns.motion.ticks_at_rest[i];
        *ticks_at_rest = if rests { start.ticks_at_rest.saturating_add(1) } else { 0 };
        if constants.sleep_after.is_some_and(|ticks| is_candidate(*ticks_at_rest, ticks)) {
            self.workspace.findings.candidates.push(i);
        }
    }

    /// Takes note that contacts changed the free flight of a body.
    fn note_pushed(&mut self, dense: usize) {
        if dense < self.bodies.free_count() {
            self.workspace.free.drop_block(dense);
        } else {
            self.bodies.note(dense, Change::POSE.or(Change::VELOCITY));
        }
    }
}
