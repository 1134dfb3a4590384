//! Events: the changes of bodies that a step reports.

use alloc::vec::{self, Vec};
use core::fmt;

use super::StepReport;
use crate::error::Fault;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// A change of a body over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Event {
    /// A call removed the body.
    Removed(BodyId),
    /// A call added the body.
    Added(BodyId),
    /// A call placed the body elsewhere, turned it, or changed its kind: it did not get there by moving.
    Placed(BodyId),
    /// A call woke the body.
    Woke(BodyId),
    /// The step quarantined the body.
    Quarantined(Fault),
    /// The body fell asleep in the step.
    FellAsleep(BodyId),
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Removed(body) => write!(f, "{body} was removed"),
            Self::Added(body) => write!(f, "{body} was added"),
            Self::Placed(body) => write!(f, "{body} was placed"),
            Self::Woke(body) => write!(f, "{body} woke"),
            Self::Quarantined(fault) => fault.fmt(f),
            Self::FellAsleep(body) => write!(f, "{body} fell asleep"),
        }
    }
}

impl<'a, S: Scalar> StepReport<'a, S> {
    /// The changes of bodies, one kind after the other in the order of [`Event`]: changes by calls before the step, each kind in
    /// the order of the calls, then changes by the step, each kind in the order of the handles.
    ///
    /// A body that calls both added and removed has no event, and a body that calls added has no `Placed` event: an observer who
    /// follows the events has each body of the world once.
    ///
    /// The iterator borrows from the world and takes no memory. To change the world while you go through the events, write
    /// `for event in world.step()`: that list is your own.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Event, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [a, b] = [world.add_body(BodyDef::dynamic())?, world.add_body(BodyDef::dynamic())?];
    /// assert!(world.step().events().eq([Event::Added(a), Event::Added(b)]));
    /// world.set_position(b, vec2(3, 4))?;
    /// world.remove_body(a)?;
    /// assert!(world.step().events().eq([Event::Removed(a), Event::Placed(b)]));
    ///
    /// // A body that leaves the allowed range is removed.
    /// world.set_position(b, vec2(fx!(1_073_741_824), 0))?;
    /// world.set_velocity(b, vec2(900, 0))?;
    /// for event in world.step() {
    ///     if let Event::Quarantined(fault) = event {
    ///         assert_eq!(event.to_string(), "body 1 was quarantined: position beyond 2^30 m");
    ///         world.remove_body(fault.body)?;
    ///     }
    /// }
    /// assert_eq!(world.body_count(), 0);
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

impl<S: Scalar> IntoIterator for StepReport<'_, S> {
    type Item = Event;
    type IntoIter = vec::IntoIter<Event>;

    /// The [events](Self::events) in a list of their own: the world can change while you go through it. It takes memory only if
    /// there are events.
    fn into_iter(self) -> vec::IntoIter<Event> {
        self.events().collect::<Vec<_>>().into_iter()
    }
}
