//! The report of a step and its events: the changes of bodies, of contacts and of joints.

use alloc::vec::{self, Vec};
use core::fmt;

#[cfg(doc)]
use super::World;
use crate::contact::{ColliderPair, ContactHit};
use crate::error::Fault;
use crate::force::AppliedForce;
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::{BodyId, JointId};
use crate::step::{JointBroke, JointLoad};

/// The report of a step. It borrows from the world: copy values that you need longer. `for event in world.step()` has the
/// [events](Self::events) in a list of their own, so that the world can change meanwhile.
///
/// ```
/// use umbra_physics::{BodyDef, StepReport, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let brick = world.add_body(BodyDef::dynamic())?;
/// let mut slept = Vec::new();
/// for _ in 0..31 {
///     let StepReport { tick, faults, fell_asleep, .. } = world.step();
///     assert!(faults.is_empty());
///     slept.extend(fell_asleep.iter().map(|&body| (tick, body)));
/// }
/// assert_eq!(slept, [(30, brick)]); // half a second at rest
/// world.set_velocity(brick, vec2(1, 0))?;
/// world.step();
/// assert_eq!(world.last_report().woke, [brick]);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(bound(serialize = "S: serde::Serialize, S::Sum: serde::Serialize"))
)]
pub struct StepReport<'a, S: Scalar = Fx> {
    /// The tick the world is at now.
    pub tick: u64,
    /// Bodies that were quarantined, in the order of their handles.
    pub faults: &'a [Fault],
    /// Bodies that calls put to sleep since the previous step, in the order of the calls, without bodies that the step woke; then the bodies that fell
    /// asleep in the step, in the order of their handles.
    pub fell_asleep: &'a [BodyId],
    /// Bodies woken by calls since the previous step, in the order of the calls; then the bodies that were woken in the step, because a
    /// moving body touched them or one of their island, in the order of their handles. A body that calls both woke and put to sleep is in neither list.
    pub woke: &'a [BodyId],
    /// Bodies removed by calls since the previous step, in the order of the calls, without those that were also added since.
    pub removed: &'a [BodyId],
    /// Bodies added by calls since the previous step, in the order of the calls, without those that were removed again.
    pub added: &'a [BodyId],
    /// Bodies of the previous step that calls since then placed elsewhere, turned, or gave another kind, in the order of the
    /// first such call to each.
    pub placed: &'a [BodyId],
    /// Contacts that ended in the step or by a call before it, of colliders with [`contact_events`](crate::ColliderDef::contact_events),
    /// sorted by the keys of bodies and colliders.
    pub contacts_ended: &'a [ColliderPair],
    /// Contacts that began in the step, of colliders with [`contact_events`](crate::ColliderDef::contact_events), sorted likewise.
    pub contacts_began: &'a [ColliderPair],
    /// Hits of colliders with [`hit_events`](crate::ColliderDef::hit_events), sorted likewise, then by parts.
    pub hits: &'a [ContactHit<S>],
    /// Sensors and the colliders that left them in the step or by a call before it, sorted likewise.
    pub sensors_left: &'a [ColliderPair],
    /// Sensors and the colliders that entered them in the step, sorted likewise.
    pub sensors_entered: &'a [ColliderPair],
    /// Sensors and the colliders that entered and left them within the step, sorted likewise: both lists before have them, too.
    pub sensors_crossed: &'a [ColliderPair],
    /// Joints with [`events`](crate::JointDef::events) that broke in the step, sorted by their keys, then by their handles.
    pub joints_broke: &'a [JointBroke<S>],
    /// Mean loads over the step of the joints with [`events`](crate::JointDef::events) that have a
    /// [`break_force`](crate::JointDef::break_force) or [`break_torque`](crate::JointDef::break_torque), sorted likewise; without joints whose bodies sleep, and
    /// of no [`Event`].
    pub joint_loads: &'a [JointLoad<S>],
    /// Joints that calls since the previous step removed together with a body in [`removed`](Self::removed), in the order of the calls.
    pub joints_removed: &'a [JointId],
    /// Forces and torques applied to bodies over the tick, in the order of their handles: [`World::step_back`] needs them.
    pub applied: &'a [AppliedForce<S>],
    /// The number of bodies under `Yoshida4` whose drag is too stiff for its backward sub-step, so that the drag acted around the whole
    /// step instead.
    pub drag_outside: u32,
}

/// A change of a body over a tick, or an event of two colliders or of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Event<S = Fx> {
    /// A call removed the body.
    Removed(BodyId),
    /// A call removed the joint together with one of its bodies.
    JointRemoved(JointId),
    /// A call added the body.
    Added(BodyId),
    /// A call placed the body elsewhere, turned it, or changed its kind: it did not get there by moving.
    Placed(BodyId),
    /// A call woke the body, or a moving body touched it in the step.
    Woke(BodyId),
    /// The step quarantined the body.
    Quarantined(Fault),
    /// The body fell asleep in the step, or a call put it to sleep.
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
    /// A joint with [`events`](crate::JointDef::events) broke in the step.
    JointBroke(JointBroke<S>),
}

impl<S: fmt::Display> fmt::Display for Event<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Removed(body) => write!(f, "{body} was removed"),
            Self::JointRemoved(joint) => write!(f, "{joint} was removed"),
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
            Self::JointBroke(JointBroke { joint, .. }) => write!(f, "{joint} broke"),
        }
    }
}

impl<'a, S: Scalar> StepReport<'a, S> {
    /// The events, one kind after the other in the order of [`Event`]: changes of bodies by calls before the step, each kind in the order
    /// of the calls (`Woke` then has the bodies that were touched in the step); changes of bodies by the step, each kind in the order of
    /// the handles (`FellAsleep` has the bodies first that calls put to sleep); then contacts and sensors, each kind sorted by the keys of the bodies and the colliders, and joints, sorted by their keys. What crossed a sensor within the
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
        let Self { removed, joints_removed, added, placed, woke, faults, fell_asleep, joints_broke, .. } = self;
        let Self { contacts_ended, contacts_began, hits, sensors_left, sensors_entered, sensors_crossed, .. } = self;
        let by_calls = removed.iter().copied().map(Event::Removed);
        let by_calls = by_calls.chain(joints_removed.iter().copied().map(Event::JointRemoved));
        let by_calls = by_calls.chain(added.iter().copied().map(Event::Added));
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
        let of_joints = joints_broke.iter().copied().map(Event::JointBroke);
        by_calls.chain(by_step).chain(of_contacts).chain(of_sensors).chain(of_joints)
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
