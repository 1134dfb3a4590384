//! Events: the changes of bodies that a step reports.

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

impl<'a, S: Scalar> StepReport<'a, S> {
    /// The changes of bodies, one kind after the other in the order of [`Event`]: changes by calls before the step, each kind in
    /// the order of the calls, then changes by the step, each kind in the order of the handles.
    ///
    /// A body that calls both added and removed has no event, and a body that calls added has no `Placed` event: an observer who
    /// follows the events has each body of the world once.
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
