//! What happened to bodies, for those who look on: what calls did to them since the step before, and when one that no step
//! moves was last changed. All of it is derived: it is in no hash and in no file, and no step reads it.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::mem;

use super::{BodyRef, StepReport, World};
use crate::body::{Bodies, Sparse};
use crate::error::Fault;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// Something that happened to a body over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Event {
    /// A call removed it.
    Removed(BodyId),
    /// A call added it.
    Added(BodyId),
    /// A call put it somewhere else, turned it, or changed its kind: it did not get there by moving.
    Placed(BodyId),
    /// A call woke it.
    Woke(BodyId),
    /// The step quarantined it.
    Quarantined(Fault),
    /// It fell asleep in the step.
    FellAsleep(BodyId),
}

impl<'a, S: Scalar> StepReport<'a, S> {
    /// All that it reports of bodies, one kind after the other, in the order in which [`Event`] has them: what calls did
    /// before the step, each kind in the order of the calls, then what the step did, each kind in the order of the handles.
    ///
    /// A body that calls both added and removed is in it neither way, and one that they added is not placed as well: whoever
    /// follows the events has the bodies of the world, each once.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Event, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let [a, b] = [world.add_body(BodyDef::dynamic())?, world.add_body(BodyDef::dynamic())?];
    /// assert!(world.step().events().eq([Event::Added(a), Event::Added(b)]));
    /// world.set_position(b, vec2(3, 4))?;
    /// world.remove_body(a)?;
    /// assert!(world.step().events().eq([Event::Removed(a), Event::Placed(b)]));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn events(self) -> impl Iterator<Item = Event> + use<'a, S> {
        let Self { removed, added, placed, woke, faults, fell_asleep, .. } = self;
        let by_calls = removed.iter().copied().map(Event::Removed).chain(added.iter().copied().map(Event::Added));
        let by_calls = by_calls.chain(placed.iter().copied().map(Event::Placed));
        let by_calls = by_calls.chain(woke.iter().copied().map(Event::Woke));
        let by_step = faults.iter().copied().map(Event::Quarantined);
        by_calls.chain(by_step).chain(fell_asleep.iter().copied().map(Event::FellAsleep))
    }
}

/// What calls did, in their order. Handles of bodies that are gone since may be among those added and placed.
#[derive(Debug, Default)]
pub(crate) struct BodyChanges {
    pub(crate) removed: Vec<BodyId>,
    pub(crate) added: Vec<BodyId>,
    pub(crate) placed: Vec<BodyId>,
    pub(crate) woken: Vec<BodyId>,
}

impl BodyChanges {
    fn is_empty(&self) -> bool {
        self.removed.is_empty() && self.added.is_empty() && self.placed.is_empty() && self.woken.is_empty()
    }

    fn clear(&mut self) {
        let Self { removed, added, placed, woken } = self;
        [removed, added, placed, woken].into_iter().for_each(Vec::clear);
    }

    /// Forgets what was done to bodies that are gone.
    fn tidy<S: Scalar>(&mut self, bodies: &Bodies<S>) {
        for list in [&mut self.added, &mut self.placed] {
            list.retain(|&body| bodies.find(body).is_ok());
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.removed.clone_from(&source.removed);
        self.added.clone_from(&source.added);
        self.placed.clone_from(&source.placed);
        self.woken.clone_from(&source.woken);
    }
}

/// That a body is listed as added, as placed, or as woken. One that is listed and not marked was removed, or disabled.
const ADDED: u8 = 1;
const PLACED: u8 = 2;
const WOKEN: u8 = 4;

#[derive(Debug, Default)]
pub(crate) struct ChangeLog {
    /// What calls did since the last step, and before it.
    pending: BodyChanges,
    pub(crate) reported: BodyChanges,
    /// Whether there may be any of either.
    has_deeds: bool,
    /// How the body of a slot is listed in what is pending; the slots that are missing are not.
    marks: Vec<u8>,
    /// The slots of bodies that have nobody asleep around them, as one was looked for since the last step.
    awake_around: Sparse<(usize, ())>,
    /// By slot, for bodies that no step moves: the tick since which one is as it is. The slots that are missing have 0.
    stamps: Vec<u64>,
    /// The tick the world is at.
    tick: u64,
    /// All bodies count as changed since the ticks before this one: these may have been looked at in another past.
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

    /// What the world is put back to has another past than the one it had.
    fn clone_from(&mut self, source: &Self) {
        self.rewind();
        self.all_before = self.all_before.max(source.all_before);
        self.take(source);
    }
}

impl ChangeLog {
    /// That of a world made at this tick.
    pub(crate) fn starting_at(tick: u64) -> Self {
        Self { tick, all_before: tick.saturating_add(1), ..Self::default() }
    }

    /// Takes over all but what belongs to a past.
    fn take(&mut self, source: &Self) {
        self.awake_around.clear();
        self.unmark();
        self.pending.clone_from(&source.pending);
        self.reported.clone_from(&source.reported);
        self.has_deeds = source.has_deeds;
        self.stamps.clone_from(&source.stamps);
        self.tick = source.tick;
        self.mark();
        // Marked is what is listed, but for those woken bodies that are not marked there.
        for body in &source.pending.woken {
            if !source.is_marked(*body, WOKEN) {
                *at(&mut self.marks, body.slot) &= !WOKEN;
            }
        }
    }

    fn is_marked(&self, body: BodyId, mark: u8) -> bool {
        self.marks.get(body.slot as usize).is_some_and(|marks| marks & mark != 0)
    }

    /// Takes over the past as well, that of the world which this is to keep and nobody looks at.
    pub(crate) fn keep_past(&mut self, source: &Self) {
        (self.all_before, self.rewinds) = (source.all_before, source.rewinds);
    }

    /// What comes is another past.
    fn rewind(&mut self) {
        self.all_before = self.all_before.max(self.tick.saturating_add(1));
        self.rewinds = self.rewinds.wrapping_add(1);
    }

    fn mark(&mut self) {
        let BodyChanges { added, placed, woken, .. } = &self.pending;
        for (list, mark) in [(added, ADDED), (placed, PLACED), (woken, WOKEN)] {
            for body in list {
                *at(&mut self.marks, body.slot) |= mark;
            }
        }
    }

    fn unmark(&mut self) {
        let BodyChanges { added, placed, woken, .. } = &self.pending;
        for body in [added, placed, woken].into_iter().flatten() {
            *at(&mut self.marks, body.slot) = 0;
        }
    }

    pub(super) fn added<S: Scalar>(&mut self, body: BodyId, bodies: &Bodies<S>) {
        let added = &mut self.pending.added;
        // Bodies that came and went, over and over without a step, must not add up.
        if added.len() == added.capacity() {
            added.retain(|&body| bodies.find(body).is_ok());
            // Room for as many again, so that this is rare.
            added.reserve(added.len());
        }
        added.push(body);
        self.has_deeds = true;
        *at(&mut self.marks, body.slot) = ADDED;
    }

    pub(super) fn removed(&mut self, body: BodyId) {
        let mark = mem::take(at(&mut self.marks, body.slot));
        if mark & ADDED == 0 {
            self.pending.removed.push(body);
            self.has_deeds = true;
        }
    }

    pub(super) fn placed(&mut self, body: BodyId) {
        let mark = at(&mut self.marks, body.slot);
        if *mark & (ADDED | PLACED) == 0 {
            *mark |= PLACED;
            self.pending.placed.push(body);
            self.has_deeds = true;
        }
    }

    /// Calls woke these bodies.
    pub(super) fn woke(&mut self, bodies: &[BodyId]) {
        for body in bodies {
            *at(&mut self.marks, body.slot) |= WOKEN;
        }
        self.pending.woken.extend_from_slice(bodies);
        // So that the step which reports them takes nothing from the heap.
        let room = self.pending.woken.len().saturating_sub(self.reported.woken.len());
        self.reported.woken.reserve(room);
        self.has_deeds |= !bodies.is_empty();
    }

    /// A call took a body out of the simulation: it does not count as woken.
    pub(super) fn taken_out(&mut self, body: BodyId) {
        *at(&mut self.marks, body.slot) &= !WOKEN;
    }

    /// The bodies that calls woke since the last step and that take part since.
    pub(crate) fn woken(&self) -> Vec<BodyId> {
        self.pending.woken.iter().copied().filter(|&body| self.is_marked(body, WOKEN)).collect()
    }

    /// Takes over [`woken`](Self::woken) of a world that was saved.
    pub(crate) fn set_woken(&mut self, woken: Vec<BodyId>) {
        self.woke(&woken);
    }

    /// Whether somebody may be asleep around a body. Who asks wakes them: nobody falls asleep until the next step.
    pub(super) fn looks_around(&mut self, body: BodyId) -> bool {
        let slot = body.slot as usize;
        let looks = self.awake_around.get(slot).is_none();
        self.awake_around.get_or_insert(slot, || (slot, ()));
        looks
    }

    /// A call changes the body in this slot, which no step moves.
    pub(super) fn changed(&mut self, slot: u32) {
        *at(&mut self.stamps, slot) = self.tick + 1;
    }

    /// A step begins, to this tick.
    #[inline]
    pub(super) fn begin<S: Scalar>(&mut self, tick: u64, bodies: &Bodies<S>) {
        self.tick = tick;
        self.awake_around.clear();
        if self.has_deeds {
            self.report(bodies);
        }
    }

    #[cold]
    fn report<S: Scalar>(&mut self, bodies: &Bodies<S>) {
        self.drop_unmarked_woken();
        self.unmark();
        // Each keeps its memory: a world that is put back has as much in either as before.
        self.reported.clone_from(&self.pending);
        self.pending.clear();
        self.reported.tidy(bodies);
        self.has_deeds = !self.reported.is_empty();
    }

    fn drop_unmarked_woken(&mut self) {
        let Self { pending, marks, .. } = self;
        pending.woken.retain(|body| marks[body.slot as usize] & WOKEN != 0);
    }

    /// What a step ends with no step moves on.
    #[inline]
    pub(super) fn end(&mut self, faults: &[Fault], fell_asleep: &[BodyId]) {
        if !(faults.is_empty() && fell_asleep.is_empty()) {
            self.stop(faults, fell_asleep);
        }
    }

    #[cold]
    fn stop(&mut self, faults: &[Fault], fell_asleep: &[BodyId]) {
        for body in faults.iter().map(|fault| fault.body).chain(fell_asleep.iter().copied()) {
            *at(&mut self.stamps, body.slot) = self.tick;
        }
    }

    /// The step to this tick was the last one: what calls did before it is pending once more.
    pub(super) fn undo<S: Scalar>(&mut self, tick: u64, bodies: &Bodies<S>) {
        self.rewind();
        self.tick = tick;
        self.awake_around.clear();
        self.drop_unmarked_woken();
        // Once, however often. A slot that is marked so has the body that it had in the step.
        self.reported.placed.retain(|body| *at(&mut self.marks, body.slot) & PLACED == 0);
        self.unmark();
        let (earlier, pending) = (&mut self.reported, &mut self.pending);
        // One that is added once more was never there to be removed or placed.
        if !(earlier.added.is_empty() || pending.removed.is_empty() && pending.placed.is_empty()) {
            let mut added = earlier.added.clone();
            added.sort_unstable();
            for list in [&mut pending.removed, &mut pending.placed] {
                list.retain(|body| added.binary_search(body).is_err());
            }
        }
        earlier.removed.append(&mut pending.removed);
        earlier.added.append(&mut pending.added);
        earlier.placed.append(&mut pending.placed);
        earlier.woken.append(&mut pending.woken);
        mem::swap(earlier, pending);
        pending.tidy(bodies);
        let takes_part = |body| bodies.find(body).is_ok_and(|i| bodies.activity(i).takes_part());
        // Once: it may have fallen asleep in the step, and been woken again since.
        let mut once = BTreeSet::new();
        pending.woken.retain(|&body| takes_part(body) && once.insert(body));
        self.mark();
    }

    /// Whether a body that no step moves was changed after this tick.
    fn is_changed_since(&self, slot: u32, tick: u64) -> bool {
        self.stamps.get(slot as usize).is_some_and(|&stamp| stamp > tick)
    }
}

/// The entry of a slot; those up to it are made.
fn at<T: Clone + Default>(column: &mut Vec<T>, slot: u32) -> &mut T {
    let slot = slot as usize;
    if column.len() <= slot {
        column.resize(slot + 1, T::default());
    }
    &mut column[slot]
}

impl<S: Scalar> World<S> {
    /// The bodies whose public state changed after a tick, in the order of their slots: by steps since that tick, or by calls
    /// since the step that led to it. For what is kept beside the world of bodies that mostly rest: sprites, a grid, packets.
    ///
    /// All that a step moves count as changed, whether they get anywhere or not: awake bodies that are not static. After
    /// [`restore`](Self::restore), `clone_from`, [`step_back`](Self::step_back) or a [`History`](super::History)'s rollback
    /// all bodies count as changed since the ticks there had been, and in a world that was read from bytes since those before.
    /// Bodies that are gone are in the [events](StepReport::events) alone. It looks at all slots; steps do nothing for it.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let [ball, wall, door] = [BodyDef::dynamic(), BodyDef::fixed(), BodyDef::fixed()].map(|def| world.add_body(def));
    /// let (ball, door) = (ball?, door?);
    /// world.step();
    /// let seen = world.tick();
    /// world.set_angle(door, umbra_physics::Fx::FRAC_PI_2)?;
    /// world.step();
    /// assert!(world.changed_since(seen).map(|body| body.id()).eq([ball, door]));
    /// assert!(world.changed_since(world.tick()).map(|body| body.id()).eq([ball]));
    /// # wall?;
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn changed_since(&self, tick: u64) -> impl Iterator<Item = BodyRef<'_, S>> {
        let (change_log, moving) = (&self.change_log, self.bodies.moving());
        // Of the steps at the last tick, the tick does not say which came first.
        let all = tick < change_log.all_before || self.tick == limits::TICK;
        self.bodies().filter(move |body| {
            all || body.dense < moving || change_log.is_changed_since(self.bodies.columns.slot[body.dense], tick)
        })
    }

    /// How often the world was put back: by [`restore`](Self::restore), `clone_from`, [`step_back`](Self::step_back) or a
    /// [`History`](super::History). Whoever keeps something of the last ticks beside the world sees by it that these are no
    /// longer its past. It is no state; a clone counts on from it.
    ///
    /// ```
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let (saved, before) = (world.snapshot(), world.rewinds());
    /// world.step();
    /// assert_eq!(world.rewinds(), before);
    /// world.restore(&saved);
    /// assert_ne!(world.rewinds(), before); // what was seen of tick 1 is of no use for the next tick 1
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn rewinds(&self) -> u64 {
        self.change_log.rewinds
    }

    /// As `clone_from`, for a world that is kept to be gone back to: its past is that of the other one.
    pub(crate) fn keep(&mut self, source: &Self) {
        self.clone_from(source);
        self.change_log.keep_past(&source.change_log);
    }
}
