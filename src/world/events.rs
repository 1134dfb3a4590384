//! Events: the changes of bodies and of contacts that a step reports.

use alloc::vec::{self, Vec};
use core::fmt;

use super::StepReport;
use crate::contact::{ColliderPair, ContactHit};
use crate::error::Fault;
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// A change of a body over a tick, or an event of two colliders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Event<S = Fx> {
    /// A call removed the body.
    Removed(BodyId),
    /// A call added the body.
    Added(BodyId),
    /// A call placed the body elsewhere, turned it, or changed its kind: it did not get there by moving.
    Placed(BodyId),
    /// A call woke the body, or a moving body touched it in the step.
    Woke(BodyId),
    /// The step quarantined the body.
    Quarantined(Fault),
    /// The body fell asleep in the step.
    FellAsleep(BodyId),
    /// Two colliders no longer touch, or one of them was removed, replaced or disabled. One of them has
    /// [`contact_events`](crate::ColliderDef::contact_events).
    ContactEnded(ColliderPair),
    /// Two colliders touch that did not touch in the step before: an impulse along the normal acted between them, or
    /// they overlap. One of them has [`contact_events`](crate::ColliderDef::contact_events).
    ContactBegan(ColliderPair),
    /// Two colliders hit each other. One of them has [`hit_events`](crate::ColliderDef::hit_events).
    ContactHit(ContactHit<S>),
    /// A collider no longer overlaps a sensor, or crossed it within the step; or one of the two was removed, replaced or disabled.
    SensorLeft(ColliderPair),
    /// A collider overlaps a sensor that it did not overlap after the step before, or crossed it within the step.
    SensorEntered(ColliderPair),
}

impl<S: fmt::Display> fmt::Display for Event<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Removed(body) => write!(f, "{body} was removed"),
            Self::Added(body) => write!(f, "{body} was added"),
            Self::Placed(body) => write!(f, "{body} was placed"),
            Self::Woke(body) => write!(f, "{body} woke"),
            Self::Quarantined(fault) => fault.fmt(f),
            Self::FellAsleep(body) => write!(f, "{body} fell asleep"),
            Self::ContactEnded(ColliderPair { colliders: [a, b], .. }) => write!(f, "{a} no longer touches {b}"),
            Self::ContactBegan(ColliderPair { colliders: [a, b], .. }) => write!(f, "{a} touches {b}"),
            Self::ContactHit(ContactHit { pair: ColliderPair { colliders: [a, b], .. }, approach_speed, .. }) => {
                write!(f, "{a} hit {b} at {approach_speed} m/s")
            }
            Self::SensorLeft(ColliderPair { colliders: [a, b], .. }) => write!(f, "{b} left sensor {a}"),
            Self::SensorEntered(ColliderPair { colliders: [a, b], .. }) => write!(f, "{b} entered sensor {a}"),
        }
    }
}

impl<'a, S: Scalar> StepReport<'a, S> {
    /// The events, one kind after the other in the order of [`Event`]: changes of bodies by calls before the step, each kind in the order
    /// of the calls (`Woke` then has the bodies that were touched in the step); changes of bodies by the step, each kind in the order of
    /// the handles; then contacts and sensors, each kind sorted by the keys of the bodies and the colliders. What crossed a sensor within the
    /// step leaves it after all entries.
    ///
    /// A body that was both added and removed since the step before has no event, and a body that was added has no `Placed` event: an
    /// observer who follows the events has each body of the world once.
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
    /// // A body that leaves the allowed range is quarantined; this game removes it.
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
    pub fn events(self) -> impl Iterator<Item = Event<S>> + use<'a, S> {
        let Self { removed, added, placed, woke, faults, fell_asleep, .. } = self;
        let Self { contacts_ended, contacts_began, hits, sensors_left, sensors_entered, sensors_crossed, .. } = self;
        let by_calls = removed.iter().copied().map(Event::Removed).chain(added.iter().copied().map(Event::Added));
        let by_calls = by_calls.chain(placed.iter().copied().map(Event::Placed));
        let by_calls = by_calls.chain(woke.iter().copied().map(Event::Woke));
        let by_step = faults.iter().copied().map(Event::Quarantined);
        let by_step = by_step.chain(fell_asleep.iter().copied().map(Event::FellAsleep));
        let of_contacts = contacts_ended.iter().copied().map(Event::ContactEnded);
        let of_contacts = of_contacts.chain(contacts_began.iter().copied().map(Event::ContactBegan));
        let of_contacts = of_contacts.chain(hits.iter().copied().map(Event::ContactHit));
        let was_there =
            move |pair: &ColliderPair| sensors_crossed.binary_search_by_key(&pair.rank(), ColliderPair::rank).is_err();
        let of_sensors = sensors_left.iter().copied().filter(was_there).map(Event::SensorLeft);
        let of_sensors = of_sensors.chain(sensors_entered.iter().copied().map(Event::SensorEntered));
        let of_sensors = of_sensors.chain(sensors_crossed.iter().copied().map(Event::SensorLeft));
        by_calls.chain(by_step).chain(of_contacts).chain(of_sensors)
    }
}

impl<S: Scalar> IntoIterator for StepReport<'_, S> {
    type Item = Event<S>;
    type IntoIter = vec::IntoIter<Event<S>>;

    /// The [events](Self::events) in a list of their own: the world can change while you go through it. It takes memory only if
    /// there are events.
    fn into_iter(self) -> vec::IntoIter<Event<S>> {
        self.events().collect::<Vec<_>>().into_iter()
    }
}
