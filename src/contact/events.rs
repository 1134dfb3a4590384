//! Events of contacts and of sensors: the reports of a step about pairs of colliders.
//!
//! Two colliders *touch* in a step if an impulse along the normal acted between them in it, or if they overlapped at
//! its start: one that is pushed out of another has no impulse in the sum. The contacts with events that have
//! records are all that touched in the last step, also where no impulse is left at its end: the contacts that begin and end are
//! the differences of these records before and after a step, and need no state of their own. Calls that drop such a
//! record keep the pair, with its keys, until the next step reports its end.
//!
//! A hit has the speed and the impulse of its impact, as the solver found them at its moment; below the speed of impacts, the impulse of
//! the step less the impulses that carry.

use alloc::vec::Vec;

use super::flights::Flights;
use super::list::ContactList;
use super::narrow::Narrow;
use super::resting::Resting;
use super::split::Part;
use super::{ContactBodies, ContactRecord, ContactSet, Scene, Solvers};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::collider::{Collider, ColliderSet};
use crate::fx;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId};
use crate::solve::{ContactSolver, Impulses};

/// Outlines that overlap by more than this touch, m: manifolds of the moment at which flights meet overlap by a
/// micrometre.
const OVERLAP: Fx = fx!(0.00001);

/// The two colliders of an event, with their handles and keys. If a call has removed one of them since the step before, these are the
/// handles that it had: they are no longer valid.
///
/// The sensor comes first in events of sensors. In events of contacts the two are sorted by the [key](crate::BodyDef::key) of the body,
/// then by the key of the collider, then by handle, the lowest first. So a body with a lower key than all others is always first.
///
/// ```
/// use umbra_physics::{BodyDef, ColliderDef, ColliderPair, Event, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ground = ColliderDef::new(Shape::rectangle(fx!(20), fx!(2))?);
/// world.add_body(BodyDef { key: 1, ..BodyDef::fixed().with_collider(ground) })?;
/// let coin = ColliderDef { contact_events: true, ..ColliderDef::new(Shape::circle(fx!(0.5))?) };
/// let coin = BodyDef { key: 2, position: vec2(0, 2), ..BodyDef::dynamic().with_collider(coin) };
/// let coin = world.add_body(coin)?;
/// let begins = |event| matches!(event, Event::ContactBegan(ColliderPair { body_keys: [1, 2], .. }));
/// assert!((0..60).any(|_| world.step().into_iter().any(begins)));
///
/// // The end of a contact is reported after its collider is gone.
/// world.remove_body(coin)?;
/// let report = world.step();
/// let pair: ColliderPair = report.contacts_ended[0];
/// assert_eq!((pair.body_keys, pair.bodies[1]), ([1, 2], coin));
/// assert!(world.collider(pair.colliders[1]).is_err());
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ColliderPair {
    /// The colliders.
    pub colliders: [ColliderId; 2],
    /// The bodies of the colliders.
    pub bodies: [BodyId; 2],
    /// The keys of the colliders.
    pub collider_keys: [u64; 2],
    /// The keys of the bodies.
    pub body_keys: [u64; 2],
}

/// The keys that pairs are sorted by.
type Rank = [(u64, u64, ColliderId); 2];

impl ColliderPair {
    /// The pair of the colliders in two slots, in this order; `None` if one is not there.
    pub(crate) fn new(bodies: &dyn ContactBodies, colliders: &ColliderSet, [first, second]: [u32; 2]) -> Option<Self> {
        let pair = [colliders.at(first)?, colliders.at(second)?];
        let key = |body: BodyId| bodies.index_of(body).map_or(0, |dense| bodies.contact_info(dense).key);
        Some(Self {
            colliders: [first, second].map(|slot| colliders.id(slot)),
            bodies: pair.map(|collider| collider.body),
            collider_keys: pair.map(|collider| collider.def.key),
            body_keys: pair.map(|collider| key(collider.body)),
        })
    }

    /// The pair of a contact, in an order that does not depend on slots where keys differ.
    pub(crate) fn of_contact(bodies: &dyn ContactBodies, colliders: &ColliderSet, slots: [u32; 2]) -> Option<Self> {
        let pair = Self::new(bodies, colliders, slots)?;
        let [first, second] = pair.rank();
        if first <= second { Some(pair) } else { Self::new(bodies, colliders, [slots[1], slots[0]]) }
    }

    /// The keys of body and collider, and the handle of the collider.
    pub(crate) fn rank(&self) -> Rank {
        [0, 1].map(|side| (self.body_keys[side], self.collider_keys[side], self.colliders[side]))
    }
}

impl Write for ColliderPair {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "first_collider", &self.colliders[0]);
        codec::field(out, "second_collider", &self.colliders[1]);
        codec::field(out, "first_body", &self.bodies[0]);
        codec::field(out, "second_body", &self.bodies[1]);
        codec::field(out, "first_collider_key", &self.collider_keys[0]);
        codec::field(out, "second_collider_key", &self.collider_keys[1]);
        codec::field(out, "first_body_key", &self.body_keys[0]);
        codec::field(out, "second_body_key", &self.body_keys[1]);
    }
}

impl Read for ColliderPair {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self {
            colliders: [ColliderId::read(reader)?, ColliderId::read(reader)?],
            bodies: [BodyId::read(reader)?, BodyId::read(reader)?],
            collider_keys: [u64::read(reader)?, u64::read(reader)?],
            body_keys: [u64::read(reader)?, u64::read(reader)?],
        })
    }
}

/// A hit: a contact that closed fast when an impulse stopped it. The same hit has the same speed and impulse at any
/// moment of the step.
///
/// ```
/// use umbra_physics::{BodyDef, ColliderDef, ContactHit, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(fx!(20), fx!(2))?))?;
/// let ball = ColliderDef { hit_events: true, ..ColliderDef::new(Shape::circle(fx!(0.5))?) };
/// let ball = BodyDef { position: vec2(3, 2), velocity: vec2(0, -6), ..BodyDef::dynamic().with_collider(ball) };
/// world.add_body(ball)?;
/// let hits = (0..60).flat_map(|_| world.step().hits.to_vec());
/// let hits: Vec<ContactHit> = hits.collect();
/// let [hit] = hits[..] else { panic!("one hit, and not {}", hits.len()) };
/// assert_eq!((hit.approach_speed, hit.normal, hit.point.x), (fx!(6), vec2(0, 1), fx!(3)));
/// assert!((hit.point.y - fx!(1)).abs() < fx!(0.000001));
/// // The ball has π/4 kg, all of which stop.
/// assert!((hit.normal_impulse - fx!(4.7124)).abs() < fx!(0.001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ContactHit<S = Fx> {
    /// The colliders.
    pub pair: ColliderPair,
    /// The outlines that touch, by their number in each shape, as in [`Contact::parts`](crate::Contact::parts): a compound reports a hit
    /// for each part.
    pub parts: [u32; 2],
    /// The speed along the normal at which the surfaces met, m/s; where two points hit, or one hits twice in the step,
    /// the largest of the speeds. *Error* 2^-22 m/s, and 2^-20 of the speeds of all bodies that touch each other; more
    /// where a body turns in the step, since its points go along straight lines.
    pub approach_speed: S,
    /// The unit vector from the first collider to the second one. *Error* 2^-29 in each component.
    pub normal: Vec2<S>,
    /// The position at which the surfaces met, m: in the middle between two points that hit at the same speed. *Error* half of the way by
    /// which the surfaces slide past each other in the step.
    pub point: Vec2<S>,
    /// The impulse of the hit along the normal, N·s, restitution included: without the impulses that carry the bodies
    /// before and after. Bodies that meet at less than [`restitution_speed`](crate::ContactSettings::restitution_speed)
    /// come to rest with the contacts that carry them: the impulse of their weight in a sub-step may count or not, and
    /// a body that arrives in the last sub-step is stopped in part. The next step gives the rest of the impulse then, and
    /// reports no second hit. In worlds of floats this is so at all speeds.
    pub normal_impulse: S,
}

/// A pair that a call ended: a step reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct EndedPair {
    pub(crate) pair: ColliderPair,
    /// True if the first collider was a sensor.
    pub(crate) is_sensor: bool,
}

impl Write for EndedPair {
    fn write(&self, out: &mut impl Encoder) {
        self.pair.write(out);
        codec::field(out, "is_sensor", &self.is_sensor);
    }
}

impl Read for EndedPair {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { pair: ColliderPair::read(reader)?, is_sensor: bool::read(reader)? })
    }
}

/// Reads the data of events from the solvers: the impulses and the impacts of the step. The solvers have solved all contacts, or the
/// contacts of this part.
pub(super) fn read_totals<C: ContactSolver>(list: &mut ContactList, solvers: &Solvers<C>, part: Option<&Part>) {
    let number = |contact: u32| part.map_or(contact, |part| part.contact_numbers[contact as usize]);
    list.totals.resize(list.len(), Impulses::default());
    for (contact, [first, second], exponent) in solvers.totals() {
        let number = number(contact) as usize;
        let second = if list.solver_contacts[number].count == 2 { second } else { 0 };
        list.totals[number] = Impulses { values: [first, second, 0], exponent };
    }
    for (approached, approach) in &mut list.approaches {
        if part.is_none_or(|part| part.contact_numbers.binary_search(approached).is_ok()) {
            approach.set_impact(None);
        }
    }
    for impact in solvers.impacts(part.map_or(&list.solver_contacts, |part| &part.contacts)) {
        let contact = number(impact.contact);
        if let Ok(index) = list.approaches.binary_search_by_key(&contact, |(number, _)| *number) {
            list.approaches[index].1.set_impact(Some(impact));
        }
    }
}

/// Finds which contacts with events touched in the step: an impulse acted, or their outlines overlapped at its start.
pub(super) fn find_touches(
    list: &mut ContactList,
    scene: &Scene<'_>,
    flights: &mut Flights,
    resting: &Resting,
    narrow: &mut Narrow,
) {
    list.touched.clear();
    if !scene.colliders.any_contact_events() {
        return;
    }
    for (number, detected) in list.detected.iter().enumerate() {
        let sides =
            detected.pair().map(|outline| flights.side(scene, &resting.numbers, resting.numbers.number(outline)));
        let touches = match &sides {
            [Some(first), Some(second)] if has_events([first.collider, second.collider]) => {
                // Points alone do not tell: they were taken back to the start along rows that do not turn.
                let points = &list.solver_contacts[number].points[..detected.count()];
                list.totals[number].values != [0; 3]
                    || points.iter().any(|point| point.separation < -OVERLAP)
                        && narrow
                            .start_manifold(scene, flights, resting, [first, second])
                            .is_some_and(|manifold| manifold.least_separation() < -OVERLAP)
            }
            _ => false,
        };
        list.touched.push(touches);
    }
}

/// Lists the hits of contacts that were solved.
pub(super) fn list_hits<S: Scalar>(list: &ContactList, scene: &Scene<'_>, hits: &mut Vec<ContactHit<S>>) {
    for (number, approach) in &list.approaches {
        let number = *number as usize;
        let Some(outlines) = list.detected.get(number).map(ContactRecord::pair) else { continue };
        let Some(total) = list.totals.get(number) else { continue };
        let slots = outlines.map(|outline| outline.slot);
        let Some(pair) = ColliderPair::of_contact(scene.bodies, scene.colliders, slots) else { continue };
        let is_swapped = pair.colliders[0].slot != slots[0];
        let Some((approach_speed, point)) = approach.fastest(total, usize::from(is_swapped)) else { continue };
        if approach_speed < scene.settings.hit_speed {
            continue;
        }
        let mut parts = outlines.map(|outline| outline.part);
        let mut normal = approach.normal;
        if is_swapped {
            parts.reverse();
            normal = normal.map(|component| -component);
        }
        let last = &list.solver_contacts[number].impulses;
        let impulse = approach.impulse(total, last, scene.settings.substeps);
        hits.push(ContactHit {
            pair,
            parts,
            approach_speed: S::from_fx(approach_speed),
            normal: normal.map(S::from_fx),
            point: point.map(S::from_fx),
            normal_impulse: S::from_fx(impulse),
        });
    }
    hits.sort_unstable_by_key(|hit| (hit.pair.rank(), hit.parts));
}

/// Returns true if the contacts of two colliders have events.
pub(crate) fn has_events([a, b]: [&Collider; 2]) -> bool {
    a.def.contact_events || b.def.contact_events
}

/// The pairs of slots of colliders that touch and have events, in the order of records.
fn pairs<'a>(records: &'a [ContactRecord], colliders: &'a ColliderSet) -> impl Iterator<Item = [u32; 2]> + 'a {
    let slots = records.iter().map(|record| record.pair().map(|outline| outline.slot));
    slots.filter(|&[a, b]| match [colliders.at(a), colliders.at(b)] {
        [Some(a), Some(b)] => has_events([a, b]),
        _ => false,
    })
}

/// Lists pairs of slots of colliders that touch and have events, sorted, each once.
pub(crate) fn list_pairs(records: &[ContactRecord], colliders: &ColliderSet, list: &mut Vec<[u32; 2]>) {
    list.clear();
    list.extend(pairs(records, colliders));
    list.sort_unstable();
    list.dedup();
}

/// Calls `only_first` and `only_second` with the items that are in only one of two sorted lists.
pub(crate) fn compare<T: Copy + Ord>(
    [first, second]: [&[T]; 2],
    mut only_first: impl FnMut(T),
    mut only_second: impl FnMut(T),
) {
    let (mut i, mut j) = (0, 0);
    loop {
        match (first.get(i), second.get(j)) {
            (None, None) => return,
            (Some(a), Some(b)) if a == b => (i, j) = (i + 1, j + 1),
            (Some(&a), b) if b.is_none_or(|&b| a < b) => {
                only_first(a);
                i += 1;
            }
            (_, Some(&b)) => {
                only_second(b);
                j += 1;
            }
            (Some(_), None) => return,
        }
    }
}

impl ContactSet {
    /// Keeps the pairs that the next step reports as the end of the contacts and of the overlaps of colliders of a body, whose slots are
    /// sorted.
    pub(super) fn keep_ends(&mut self, bodies: &dyn ContactBodies, colliders: &ColliderSet, slots: &[u32]) {
        let ending = |pair: [u32; 2]| pair.into_iter().find(|slot| slots.binary_search(slot).is_ok());
        let mut ends: Vec<(u32, bool, [u32; 2])> = Vec::new();
        if colliders.any_contact_events() {
            let asleep = if self.any_asleep_with(slots) { self.asleep.records() } else { &[] };
            let touching = pairs(&self.records, colliders).chain(pairs(asleep, colliders));
            ends.extend(touching.filter_map(|pair| Some((ending(pair)?, false, pair))));
        }
        let overlapping = self.overlaps.iter().map(|overlap| overlap.slots());
        ends.extend(overlapping.filter_map(|pair| Some((ending(pair)?, true, pair))));
        // As if one collider after the other went.
        ends.sort_unstable();
        ends.dedup();
        self.ended.extend(ends.into_iter().filter_map(|(_, is_sensor, slots)| {
            let pair = if is_sensor { ColliderPair::new } else { ColliderPair::of_contact };
            Some(EndedPair { pair: pair(bodies, colliders, slots)?, is_sensor })
        }));
    }

    /// Keeps the contacts with events of some pairs of slots of colliders of awake bodies: the next step reports their end.
    pub(crate) fn keep_ends_of(
        &mut self,
        bodies: &dyn ContactBodies,
        colliders: &ColliderSet,
        ends: impl Fn([u32; 2]) -> bool,
    ) {
        let mut ending: Vec<[u32; 2]> = pairs(&self.records, colliders).filter(|slots| ends(*slots)).collect();
        ending.sort_unstable();
        ending.dedup();
        let ended = ending.into_iter().filter_map(|slots| ColliderPair::of_contact(bodies, colliders, slots));
        self.ended.extend(ended.map(|pair| EndedPair { pair, is_sensor: false }));
    }
}
