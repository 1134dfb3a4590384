//! Reports of a rollback: the events of the ticks that were made, and the ticks that are confirmed.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::Row;
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::world::{Command, Event, World};

/// Says whether an event was reported before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EventStatus {
    /// It is reported for the first time.
    New,
    /// The tick was made before, and had the event then as well.
    SeenBefore,
    /// The tick was made before and had the event then; it does not have it any more.
    Undone,
}

/// An event of a tick that was made. If the tick is not confirmed, it may still change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickEvent {
    /// The tick before the step that had the event.
    pub tick: u64,
    /// The event.
    pub event: Event,
    /// Says whether it was reported before.
    pub status: EventStatus,
}

/// A tick that cannot change any more.
#[derive(Debug)]
pub struct ConfirmedTick<'a, I, S: Scalar = Fx> {
    /// The tick; the world is at the next one after it.
    pub tick: u64,
    /// The inputs by player.
    pub inputs: &'a [(u32, I)],
    /// The calls that the tick function made, in their order: what a [`Recorder`](crate::Recorder) records.
    pub commands: &'a [Command<S>],
    /// The world after the tick.
    pub after: &'a World<S>,
}

impl<I, S: Scalar> Clone for ConfirmedTick<'_, I, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<I, S: Scalar> Copy for ConfirmedTick<'_, I, S> {}

/// The report of [`Rollback::advance`](super::Rollback::advance). It borrows from the rollback and the world: copy values that
/// you need longer.
pub struct RollbackReport<'a, I, S: Scalar = Fx> {
    /// The number of ticks that were made again.
    pub redone: u64,
    /// A player whose input is missing, if the next tick was not made: the window is full.
    pub waits_for: Option<u32>,
    /// The events of the ticks that were made, in the order of the ticks; those of a tick in the order of
    /// [`StepReport::events`](crate::StepReport::events), then those that are undone.
    pub events: &'a [TickEvent],
    first: u64,
    rows: &'a VecDeque<Row<I, S>>,
    confirmed: usize,
    made: usize,
    world: &'a World<S>,
}

impl<'a, I, S: Scalar> RollbackReport<'a, I, S> {
    pub(super) fn new(
        redone: u64,
        waits_for: Option<u32>,
        first: u64,
        (rows, confirmed, made): (&'a VecDeque<Row<I, S>>, usize, usize),
        events: &'a [TickEvent],
        world: &'a World<S>,
    ) -> Self {
        Self { redone, waits_for, events, first, rows, confirmed, made, world }
    }

    /// The ticks that were confirmed since the last report, in order. Each is handed out once.
    pub fn confirmed(&self) -> impl ExactSizeIterator<Item = ConfirmedTick<'a, I, S>> + use<'a, I, S> {
        let Self { first, rows, confirmed, made, world, .. } = *self;
        (0..confirmed).map(move |index| {
            let Row { inputs, commands, .. } = &rows[index];
            let after = if index + 1 < made { &rows[index + 1].before } else { world };
            ConfirmedTick { tick: first + index as u64, inputs, commands, after }
        })
    }

    /// The world at the present tick, to draw.
    #[must_use]
    pub fn world(&self) -> &'a World<S> {
        self.world
    }
}

impl<I, S: Scalar> core::fmt::Debug for RollbackReport<'_, I, S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { redone, waits_for, events, confirmed, .. } = self;
        let mut report = f.debug_struct("RollbackReport");
        report.field("redone", redone).field("waits_for", waits_for).field("events", events);
        report.field("confirmed", confirmed).finish_non_exhaustive()
    }
}

/// The kind of an event and its body: a tick has at most one event of a kind for a body.
fn key(event: Event) -> (u8, BodyId) {
    match event {
        Event::Removed(body) => (0, body),
        Event::Added(body) => (1, body),
        Event::Placed(body) => (2, body),
        Event::Woke(body) => (3, body),
        Event::Quarantined(fault) => (4, fault.body),
        Event::FellAsleep(body) => (5, body),
    }
}

/// Replaces the events that were reported of a tick by those it has now, and lists these and the ones that are undone.
pub(super) fn compare(
    tick: u64,
    reported: &mut Vec<Event>,
    events: &mut dyn Iterator<Item = Event>,
    list: &mut Vec<TickEvent>,
) {
    let before = core::mem::take(reported);
    reported.extend(events);
    let differs = before != *reported;
    let is_in = |others: &[Event], event: Event| {
        // Sorted: a search for each event takes a logarithm.
        let found = others.binary_search_by_key(&key(event), |other| key(*other));
        found.is_ok_and(|index| others[index] == event)
    };
    let sorted = |events: &[Event]| {
        let mut sorted = events.to_vec();
        sorted.sort_unstable_by_key(|event| key(*event));
        sorted
    };
    let (old, new) = if differs { (sorted(&before), sorted(reported)) } else { (Vec::new(), Vec::new()) };
    for &event in &*reported {
        let is_seen = !differs || is_in(&old, event);
        let status = if is_seen { EventStatus::SeenBefore } else { EventStatus::New };
        list.push(TickEvent { tick, event, status });
    }
    let undone = before.into_iter().filter(|&event| differs && !is_in(&new, event));
    list.extend(undone.map(|event| TickEvent { tick, event, status: EventStatus::Undone }));
}
