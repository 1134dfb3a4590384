//! The log of changes to bodies: changes by calls since the previous step, and the tick of the last change of each body that no
//! step moves. The log is for observers: it is in no hash and in no file, and no step reads it.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::mem;

#[cfg(doc)]
use super::StepReport;
use super::{BodyRef, World};
use crate::body::{Activity, Bodies, Sparse};
use crate::error::Fault;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::{BodyId, JointId};

/// Changes by calls, in the order of the calls. The lists may name bodies that were removed since.
#[derive(Debug, Default)]
pub(crate) struct BodyChanges {
    pub(crate) removed: Vec<BodyId>,
    pub(crate) added: Vec<BodyId>,
    pub(crate) placed: Vec<BodyId>,
    pub(crate) woken: Vec<BodyId>,
    /// Bodies that calls put to sleep; in a report then the bodies that fell asleep in the step.
    pub(crate) fell_asleep: Vec<BodyId>,
    /// Joints that were removed with a body of `removed`.
    pub(crate) removed_joints: Vec<JointId>,
}

impl BodyChanges {
    /// Joints are removed with a body that is listed.
    fn is_empty(&self) -> bool {
        let Self { removed, added, placed, woken, fell_asleep, .. } = self;
        [removed, added, placed, woken, fell_asleep].into_iter().all(Vec::is_empty)
    }

    fn clear(&mut self) {
        let Self { removed, added, placed, woken, fell_asleep, removed_joints } = self;
        [removed, added, placed, woken, fell_asleep].into_iter().for_each(Vec::clear);
        removed_joints.clear();
    }

    /// Drops the entries of bodies that were removed.
    fn tidy<S: Scalar>(&mut self, bodies: &Bodies<S>) {
        for list in [&mut self.added, &mut self.placed, &mut self.woken, &mut self.fell_asleep] {
            list.retain(|&body| bodies.find(body).is_ok());
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.removed.clone_from(&source.removed);
        self.added.clone_from(&source.added);
        self.placed.clone_from(&source.placed);
        self.woken.clone_from(&source.woken);
        self.fell_asleep.clone_from(&source.fell_asleep);
        self.removed_joints.clone_from(&source.removed_joints);
    }
}

/// Marks of a body that is listed as added or as placed. A listed body without a mark was removed.
const ADDED: u8 = 1;
const PLACED: u8 = 2;
/// Marks of a body that calls woke or put to sleep, as it is now. A listed body without a mark was removed or disabled, or a later call took
/// the change back.
const WOKEN: u8 = 4;
const SLEPT: u8 = 8;
/// Marks of a body that is in the list of woken bodies, or in the list of bodies that fell asleep.
const IN_WOKEN: u8 = 16;
const IN_SLEPT: u8 = 32;

#[derive(Debug, Default)]
pub(crate) struct ChangeLog {
    /// Changes by calls since the last step.
    pending: BodyChanges,
    /// Changes by calls between the last step and the one before.
    pub(crate) reported: BodyChanges,
    /// True if either may have entries.
    has_entries: bool,
    /// The marks of bodies in `pending`, by slot; missing slots have none.
    marks: Vec<u8>,
    /// The slots of bodies without sleeping neighbours, known from a search since the last step.
    awake_around: Sparse<(usize, ())>,
    /// The tick of the last change, by slot, for bodies that no step moves; 0 for missing slots.
    stamps: Vec<u64>,
    /// The tick the world is at.
    tick: u64,
    /// The first tick of the present past: since each earlier tick all bodies count as changed.
    all_before: u64,
    rewinds: u64,
}

impl Clone for ChangeLog {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.take(self);
        (copy.all_before, copy.rewinds) = (self.all_before, self.rewinds);
        copy
    }

    /// Copies the log of a world that is restored: its past is another one.
    fn clone_from(&mut self, source: &Self) {
        self.rewind();
        self.all_before = self.all_before.max(source.all_before);
        self.take(source);
    }
}

impl ChangeLog {
    /// The log of a world that begins at this tick.
    pub(crate) fn starting_at(tick: u64) -> Self {
        Self { tick, all_before: tick.saturating_add(1), ..Self::default() }
    }

    /// Copies everything except the past.
    fn take(&mut self, source: &Self) {
        self.awake_around.clear();
        self.unmark();
        self.pending.clone_from(&source.pending);
        self.reported.clone_from(&source.reported);
        self.has_entries = source.has_entries;
        self.stamps.clone_from(&source.stamps);
        self.tick = source.tick;
        self.mark();
        // Listed bodies are marked, except bodies without a mark in the source.
        for body in source.pending.woken.iter().chain(&source.pending.fell_asleep) {
            let marks = at(&mut self.marks, body.slot);
            *marks &= source.marks.get(body.slot as usize).copied().unwrap_or_default();
        }
    }

    fn is_marked(&self, body: BodyId, mark: u8) -> bool {
        self.marks.get(body.slot as usize).is_some_and(|marks| marks & mark != 0)
    }

    /// Copies the past too: of a world that is stored, and that nobody observes.
    pub(crate) fn keep_past(&mut self, source: &Self) {
        (self.all_before, self.rewinds) = (source.all_before, source.rewinds);
    }

    /// Begins another past.
    fn rewind(&mut self) {
        self.all_before = self.all_before.max(self.tick.saturating_add(1));
        self.rewinds = self.rewinds.wrapping_add(1);
    }

    fn mark(&mut self) {
        let BodyChanges { added, placed, woken, fell_asleep, .. } = &self.pending;
        let (woken, fell_asleep) = ((woken, WOKEN | IN_WOKEN), (fell_asleep, SLEPT | IN_SLEPT));
        for (list, mark) in [(added, ADDED), (placed, PLACED), woken, fell_asleep] {
            for body in list {
                *at(&mut self.marks, body.slot) |= mark;
            }
        }
    }

    fn unmark(&mut self) {
        let BodyChanges { added, placed, woken, fell_asleep, .. } = &self.pending;
        for body in [added, placed, woken, fell_asleep].into_iter().flatten() {
            *at(&mut self.marks, body.slot) = 0;
        }
    }

    pub(super) fn added<S: Scalar>(&mut self, body: BodyId, bodies: &Bodies<S>) {
        let added = &mut self.pending.added;
        // Bodies that are added and removed repeatedly without a step must not accumulate.
        if added.len() == added.capacity() {
            added.retain(|&body| bodies.find(body).is_ok());
            // Reserve as many again, so that this happens rarely.
            added.reserve(added.len());
        }
        added.push(body);
        self.has_entries = true;
        *at(&mut self.marks, body.slot) = ADDED;
    }

    /// Logs a body that was removed with its joints.
    pub(super) fn removed(&mut self, body: BodyId, joints: &[JointId]) {
        let mark = mem::take(at(&mut self.marks, body.slot));
        if mark & ADDED == 0 {
            self.pending.removed.push(body);
            self.pending.removed_joints.extend_from_slice(joints);
            self.has_entries = true;
        }
    }

    pub(super) fn placed(&mut self, body: BodyId) {
        let mark = at(&mut self.marks, body.slot);
        if *mark & (ADDED | PLACED) == 0 {
            *mark |= PLACED;
            self.pending.placed.push(body);
            self.has_entries = true;
        }
    }

    /// Logs bodies that a call woke.
    pub(super) fn woke(&mut self, bodies: &[BodyId]) {
        for &body in bodies {
            let marks = at(&mut self.marks, body.slot);
            if *marks & SLEPT != 0 {
                *marks &= !SLEPT;
                continue;
            }
            if *marks & IN_WOKEN == 0 {
                self.pending.woken.push(body);
            }
            *marks |= WOKEN | IN_WOKEN;
        }
        self.has_entries |= !bodies.is_empty();
        self.reserve();
    }

    /// Logs bodies that a call put to sleep.
    pub(super) fn put_to_sleep<S: Scalar>(&mut self, sleepers: &[BodyId], bodies: &Bodies<S>) {
        // Bodies that are added, put to sleep and removed repeatedly without a step must not accumulate.
        let list = &mut self.pending.fell_asleep;
        if list.len() + sleepers.len() > list.capacity() {
            list.retain(|&body| bodies.find(body).is_ok());
            list.reserve(list.len() + sleepers.len());
        }
        for &body in sleepers {
            let marks = at(&mut self.marks, body.slot);
            if *marks & WOKEN != 0 {
                *marks &= !WOKEN;
                continue;
            }
            if *marks & IN_SLEPT == 0 {
                list.push(body);
            }
            *marks |= SLEPT | IN_SLEPT;
        }
        self.has_entries |= !sleepers.is_empty();
        // Somebody sleeps again.
        self.awake_around.clear();
        self.reserve();
    }

    /// Takes memory for the report: the step that reports the calls must not allocate.
    fn reserve(&mut self) {
        let Self { pending, reported, .. } = self;
        for (list, report) in [(&pending.woken, &mut reported.woken), (&pending.fell_asleep, &mut reported.fell_asleep)]
        {
            report.reserve(list.len().saturating_sub(report.len()));
        }
    }

    /// Logs a body that a call disabled: it does not count as woken or put to sleep.
    pub(super) fn taken_out(&mut self, body: BodyId) {
        *at(&mut self.marks, body.slot) &= !(WOKEN | SLEPT);
    }

    /// The bodies that calls woke since the last step, then the bodies that calls put to sleep, as they are now.
    pub(crate) fn sleep_changes<S: Scalar>(&self, bodies: &Bodies<S>) -> Vec<BodyId> {
        let BodyChanges { woken, fell_asleep, .. } = &self.pending;
        let woken = woken.iter().filter(|&&body| self.is_marked(body, WOKEN));
        let changed = woken.chain(fell_asleep.iter().filter(|&&body| self.is_marked(body, SLEPT))).copied();
        // A slot may have another body since.
        changed.filter(|&body| bodies.find(body).is_ok()).collect()
    }

    /// The number of bodies that calls woke since the last step, with those that were taken out of the simulation after it.
    pub(crate) fn woken_count(&self) -> usize {
        self.pending.woken.len()
    }

    /// The bodies that calls woke after the first `count` of this tick.
    pub(crate) fn woken_since(&self, count: usize) -> &[BodyId] {
        self.pending.woken.get(count..).unwrap_or_default()
    }

    /// Sets [`sleep_changes`](Self::sleep_changes) from a saved world. Returns false if a sleeping body is in front of one that is awake.
    #[must_use]
    pub(crate) fn set_sleep_changes<S: Scalar>(&mut self, changed: &[BodyId], bodies: &Bodies<S>) -> bool {
        let sleeps = |body: &BodyId| bodies.find(*body).is_ok_and(|i| bodies.activity(i) == Activity::Asleep);
        let (woken, sleepers) = changed.split_at(changed.iter().take_while(|body| !sleeps(body)).count());
        self.woke(woken);
        self.put_to_sleep(sleepers, bodies);
        sleepers.iter().all(sleeps)
    }

    /// True if a neighbour of the body may sleep. The caller wakes the neighbours: none sleeps until a step or a call puts it to sleep.
    pub(super) fn looks_around(&mut self, body: BodyId) -> bool {
        let slot = body.slot as usize;
        let looks = self.awake_around.get(slot).is_none();
        self.awake_around.get_or_insert(slot, || (slot, ()));
        looks
    }

    /// Logs a change by a call of the body in this slot, which no step moves.
    pub(super) fn changed(&mut self, slot: u32) {
        *at(&mut self.stamps, slot) = self.tick + 1;
    }

    /// Begins a step to this tick.
    #[inline]
    pub(super) fn begin<S: Scalar>(&mut self, tick: u64, bodies: &Bodies<S>) {
        self.tick = tick;
        self.awake_around.clear();
        if self.has_entries {
            self.report(bodies);
        }
    }

    #[cold]
    fn report<S: Scalar>(&mut self, bodies: &Bodies<S>) {
        self.drop_unmarked();
        self.unmark();
        // Both lists keep their memory, so that a restored world allocates nothing.
        self.reported.clone_from(&self.pending);
        self.pending.clear();
        self.reported.tidy(bodies);
        for body in &self.reported.fell_asleep {
            *at(&mut self.marks, body.slot) |= SLEPT;
        }
        self.has_entries = !self.reported.is_empty();
    }

    /// Drops the bodies that are not as calls left them, with all marks of their lists.
    fn drop_unmarked(&mut self) {
        let Self { pending: BodyChanges { woken, fell_asleep, .. }, marks, .. } = self;
        for (list, mark, listed) in [(woken, WOKEN, IN_WOKEN), (fell_asleep, SLEPT, IN_SLEPT)] {
            list.retain(|body| {
                let marks = &mut marks[body.slot as usize];
                let is_marked = *marks & mark != 0;
                if !is_marked {
                    *marks &= !listed;
                }
                is_marked
            });
        }
    }

    /// Logs bodies that stopped moving or woke in a step.
    #[inline]
    pub(super) fn end(&mut self, faults: &[Fault], fell_asleep: &[BodyId], woke: &[BodyId]) {
        if !self.reported.fell_asleep.is_empty() {
            self.wake_sleepers(woke);
        } else if !woke.is_empty() {
            self.reported.woken.extend_from_slice(woke);
            self.has_entries = true;
        }
        self.reported.fell_asleep.extend_from_slice(fell_asleep);
        self.has_entries |= !fell_asleep.is_empty();
        if !(faults.is_empty() && fell_asleep.is_empty()) {
            self.stop(faults, fell_asleep);
        }
    }

    /// Logs the bodies that woke in a step after calls had put bodies to sleep: no list has a body that calls put to sleep and the step woke.
    #[cold]
    fn wake_sleepers(&mut self, woke: &[BodyId]) {
        let Self { reported: BodyChanges { woken, fell_asleep, .. }, marks, .. } = self;
        for &body in woke {
            let marks = at(marks, body.slot);
            if *marks & SLEPT == 0 {
                woken.push(body);
            }
            *marks = 0;
        }
        fell_asleep.retain(|body| core::mem::take(at(marks, body.slot)) & SLEPT != 0);
    }

    #[cold]
    fn stop(&mut self, faults: &[Fault], fell_asleep: &[BodyId]) {
        for body in faults.iter().map(|fault| fault.body).chain(fell_asleep.iter().copied()) {
            *at(&mut self.stamps, body.slot) = self.tick;
        }
    }

    /// Undoes a step, back to this tick: the changes by calls before it are pending again.
    pub(super) fn undo<S: Scalar>(&mut self, tick: u64, bodies: &Bodies<S>) {
        self.rewind();
        self.tick = tick;
        self.awake_around.clear();
        self.drop_unmarked();
        // Each body is listed once. A slot with this mark has the body that it had in the step.
        self.reported.placed.retain(|body| *at(&mut self.marks, body.slot) & PLACED == 0);
        self.unmark();
        let (earlier, pending) = (&mut self.reported, &mut self.pending);
        // A body that is pending as added again cannot be pending as removed or placed.
        if !(earlier.added.is_empty() || pending.removed.is_empty() && pending.placed.is_empty()) {
            let mut added = earlier.added.clone();
            added.sort_unstable();
            for list in [&mut pending.removed, &mut pending.placed] {
                list.retain(|body| added.binary_search(body).is_err());
            }
        }
        earlier.removed.append(&mut pending.removed);
        earlier.removed_joints.append(&mut pending.removed_joints);
        earlier.added.append(&mut pending.added);
        earlier.placed.append(&mut pending.placed);
        earlier.woken.append(&mut pending.woken);
        // Nobody fell asleep in a step that can be undone, and calls have woken all that slept before it.
        earlier.fell_asleep.clear();
        pending.fell_asleep.clear();
        mem::swap(earlier, pending);
        pending.tidy(bodies);
        let takes_part = |body| bodies.find(body).is_ok_and(|i| bodies.activity(i).takes_part());
        // Each body is listed once: it may have fallen asleep in the step and been woken since.
        let mut once = BTreeSet::new();
        pending.woken.retain(|&body| takes_part(body) && once.insert(body));
        self.mark();
    }

    /// True if a body that no step moves changed after this tick.
    fn is_changed_since(&self, slot: u32, tick: u64) -> bool {
        self.stamps.get(slot as usize).is_some_and(|&stamp| stamp > tick)
    }
}

/// The entry of a slot; missing entries up to it are created.
fn at<T: Clone + Default>(column: &mut Vec<T>, slot: u32) -> &mut T {
    let slot = slot as usize;
    if column.len() <= slot {
        column.resize(slot + 1, T::default());
    }
    &mut column[slot]
}

impl<S: Scalar> World<S> {
    /// The bodies with a public state that changed after a tick, in the order of their slots: by steps since that tick, or by
    /// calls since the step that led to it. Use it to update sprites, a grid or packets of bodies that mostly rest.
    ///
    /// Awake bodies that are not static always count as changed. After [`restore`](Self::restore), `clone_from`,
    /// [`step_back`](Self::step_back) or a [`Rollback`](super::Rollback) to an earlier tick all bodies count as changed since every
    /// earlier tick, and so they do in a world that was read from bytes. Removed bodies are only in the
    /// [events](StepReport::events). The call looks at all slots; steps do no work for it.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [ball, wall, door] = [BodyDef::dynamic(), BodyDef::fixed(), BodyDef::fixed()].map(|def| world.add_body(def));
    /// let (ball, door) = (ball?, door?);
    /// world.step();
    /// let tick = world.tick();
    /// world.set_angle(door, umbra_physics::Fx::FRAC_PI_2)?;
    /// world.step();
    /// assert!(world.changed_since(tick).map(|body| body.id()).eq([ball, door]));
    /// assert!(world.changed_since(world.tick()).map(|body| body.id()).eq([ball]));
    /// # wall?;
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn changed_since(&self, tick: u64) -> impl Iterator<Item = BodyRef<'_, S>> {
        let change_log = &self.change_log;
        let moving = self.bodies.moving();
        // Steps at the largest tick cannot be told apart.
        let all = tick < change_log.all_before || self.tick == limits::TICK;
        self.bodies().filter(move |body| {
            all || body.dense < moving || change_log.is_changed_since(self.bodies.columns.slot[body.dense], tick)
        })
    }

    /// The number of times the world was set back: by [`restore`](Self::restore), `clone_from`, [`step_back`](Self::step_back) or
    /// a [`Rollback`](super::Rollback). A change of the number tells code that keeps data of past ticks that they are no longer
    /// the world's past. The number is not part of the state; a clone counts on from it.
    ///
    /// ```
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let (saved, before) = (world.snapshot(), world.rewinds());
    /// world.step();
    /// assert_eq!(world.rewinds(), before);
    /// world.restore(&saved);
    /// assert_ne!(world.rewinds(), before); // data about tick 1 is stale
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn rewinds(&self) -> u64 {
        self.change_log.rewinds
    }

    /// Copies a world that is stored for a rollback, including its past.
    pub(crate) fn keep(&mut self, source: &Self) {
        self.clone_from(source);
        self.change_log.keep_past(&source.change_log);
    }
}
