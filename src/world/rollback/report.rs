//! Reports of a rollback: the events of the ticks that were made, and the ticks that are confirmed.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::Row;
use crate::contact::ColliderPair;
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId, JointId};
use crate::world::{Command, Event, World};

/// Says whether an event was reported before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EventStatus {
    /// The event is reported for the first time.
    New,
    /// The tick was made before, and had the event then as well; a hit perhaps at another speed.
    SeenBefore,
    /// The tick was made before and had the event then; it does not have it any more.
    Undone,
}

/// An event of a tick that was made. If the tick is not confirmed, it may still change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickEvent<S = Fx> {
    /// The tick before the step that had the event.
    pub tick: u64,
    /// The event.
    pub event: Event<S>,
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
    pub events: &'a [TickEvent<S>],
    first: u64,
    rows: &'a VecDeque<Row<I, S>>,
    confirmed: usize,
    simulated: usize,
    world: &'a World<S>,
}

impl<'a, I, S: Scalar> RollbackReport<'a, I, S> {
    pub(super) fn new(
        redone: u64,
        waits_for: Option<u32>,
        first: u64,
        rows: &'a VecDeque<Row<I, S>>,
        confirmed: usize,
        simulated: usize,
        events: &'a [TickEvent<S>],
        world: &'a World<S>,
    ) -> Self {
        Self { redone, waits_for, events, first, rows, confirmed, simulated, world }
    }

    /// The ticks that were confirmed since the last report, in order. Each is handed out once.
    pub fn confirmed(&self) -> impl ExactSizeIterator<Item = ConfirmedTick<'a, I, S>> + use<'a, I, S> {
        let Self { first, rows, confirmed, simulated, world, .. } = *self;
        (0..confirmed).map(move |index| {
            let Row { inputs, commands, .. } = &rows[index];
            let after = if index + 1 < simulated { &rows[index + 1].before } else { world };
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

/// The kind of an event and its body, colliders or joint, of a hit with the parts: a tick has at most one event with a key.
type Key = (u8, Option<BodyId>, Option<([ColliderId; 2], [u32; 2])>, Option<JointId>);

fn key<S>(event: &Event<S>) -> Key {
    let key_of = |kind, body| (kind, Some(body), None, None);
    let of_pair = |kind, pair: &ColliderPair, parts| (kind, None, Some((pair.colliders, parts)), None);
    let of_joint = |kind, joint| (kind, None, None, Some(joint));
    match event {
        Event::Removed(body) => key_of(0, *body),
        Event::Added(body) => key_of(1, *body),
        Event::Placed(body) => key_of(2, *body),
        Event::Woke(body) => key_of(3, *body),
        Event::Quarantined(fault) => key_of(4, fault.body),
        Event::FellAsleep(body) => key_of(5, *body),
        Event::ContactEnded(pair) => of_pair(6, pair, [0; 2]),
        Event::ContactBegan(pair) => of_pair(7, pair, [0; 2]),
        Event::ContactHit(hit) => of_pair(8, &hit.pair, hit.parts),
        Event::SensorLeft(pair) => of_pair(9, pair, [0; 2]),
        Event::SensorEntered(pair) => of_pair(10, pair, [0; 2]),
        Event::JointRemoved(joint) => of_joint(11, *joint),
        Event::JointBroke(broke) => of_joint(12, broke.joint),
    }
}

/// Returns true if an event was reported as this one. A hit is the same one at another speed: a game has shown it.
fn is_same<S: PartialEq>(a: &Event<S>, b: &Event<S>) -> bool {
    matches!([a, b], [Event::ContactHit(_), Event::ContactHit(_)]) || a == b
}

/// Replaces the events that were reported of a tick by those it has now, and lists these and the ones that are undone.
pub(super) fn compare<S: Scalar>(
    tick: u64,
    reported: &mut Vec<Event<S>>,
    events: &mut dyn Iterator<Item = Event<S>>,
    list: &mut Vec<TickEvent<S>>,
) {
    let before = core::mem::take(reported);
    reported.extend(events);
    let differs = before != *reported;
    let is_in = |others: &[Event<S>], event: &Event<S>| {
        // Sorted: a search for each event takes a logarithm.
        let place = others.binary_search_by_key(&key(event), key);
        place.is_ok_and(|index| is_same(&others[index], event))
    };
    let sorted = |events: &[Event<S>]| {
        let mut sorted = events.to_vec();
        sorted.sort_unstable_by_key(key);
        sorted
    };
    let (old, new) = if differs { (sorted(&before), sorted(reported)) } else { (Vec::new(), Vec::new()) };
    for &event in &*reported {
        let is_seen = !differs || is_in(&old, &event);
        let status = if is_seen { EventStatus::SeenBefore } else { EventStatus::New };
        list.push(TickEvent { tick, event, status });
    }
    let undone = before.into_iter().filter(|event| differs && !is_in(&new, event));
    list.extend(undone.map(|event| TickEvent { tick, event, status: EventStatus::Undone }));
}
