//! Events of contacts and of sensors: what a step reports of pairs of colliders.
//!
//! Two colliders *touch* in a step if an impulse along the normal acted between them in it. The records of contacts with events are those
//! that touched in the last step, also where no impulse is left at its end: the contacts that begin and end are the differences of
//! these records before and after a step, and need no state of their own. Calls that drop such a record keep the pair until
//! the next step reports its end.

use alloc::vec::Vec;

use super::{ContactRecord, ContactSet};
use crate::body::Bodies;
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::collider::{Collider, ColliderSet};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId};

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
    pub(crate) fn new<S: Scalar>(
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        [first, second]: [u32; 2],
    ) -> Option<Self> {
        let own = [colliders.at(first)?, colliders.at(second)?];
        let key = |body: BodyId| bodies.find(body).map_or(0, |dense| bodies.info(dense).key);
        Some(Self {
            colliders: [first, second].map(|slot| colliders.id(slot)),
            bodies: own.map(|collider| collider.body),
            collider_keys: own.map(|collider| collider.def.key),
            body_keys: own.map(|collider| key(collider.body)),
        })
    }

    /// The pair of a contact, in an order that does not depend on slots where keys differ.
    pub(crate) fn of_contact<S: Scalar>(
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        slots: [u32; 2],
    ) -> Option<Self> {
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

/// A hit: a contact that closed fast when an impulse stopped it.
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
/// assert_eq!((hit.approach_speed, hit.normal, hit.point), (fx!(6), vec2(0, 1), vec2(3, 1)));
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
    /// The speed at which the surfaces approached each other along the normal at the start of the step, m/s; where two points hit, the
    /// larger of their speeds. *Error* 1 ulp, and 2^-30 of the velocities.
    pub approach_speed: S,
    /// The unit vector from the first collider to the second one. *Error* 2^-29 in each component.
    pub normal: Vec2<S>,
    /// The position at which the surfaces met, m: in the middle between two points that hit at the same speed. *Error* half of the way by
    /// which the surfaces slide past each other in the step.
    pub point: Vec2<S>,
    /// The impulse along the normal over the step, N·s, restitution included. A body without restitution that arrives in the last sub-step
    /// is stopped in part: the next step gives the rest of the impulse, and reports no second hit.
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

/// Returns true if the contacts of two colliders have events.
pub(crate) fn has_events<S: Scalar>([a, b]: [&Collider<S>; 2]) -> bool {
    a.def.contact_events || b.def.contact_events
}

/// The pairs of slots of colliders that touch and have events, in the order of records.
fn pairs<'a, S: Scalar>(
    records: &'a [ContactRecord],
    colliders: &'a ColliderSet<S>,
) -> impl Iterator<Item = [u32; 2]> + 'a {
    let slots = records.iter().map(|record| record.pair().map(|outline| outline.slot));
    slots.filter(|&[a, b]| match [colliders.at(a), colliders.at(b)] {
        [Some(a), Some(b)] => has_events([a, b]),
        _ => false,
    })
}

/// Lists pairs of slots of colliders that touch and have events, sorted, each once.
pub(crate) fn list_pairs<S: Scalar>(records: &[ContactRecord], colliders: &ColliderSet<S>, list: &mut Vec<[u32; 2]>) {
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
    pub(super) fn keep_ends<S: Scalar>(&mut self, bodies: &Bodies<S>, colliders: &ColliderSet<S>, slots: &[u32]) {
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

    /// Keeps what the next step reports as the end of the contacts with events of some pairs of slots of colliders: of those of awake
    /// bodies, or of all.
    pub(crate) fn keep_ends_of<S: Scalar>(
        &mut self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        with_asleep: bool,
        is_one: impl Fn([u32; 2]) -> bool,
    ) {
        let asleep = if with_asleep { self.asleep.records() } else { &[] };
        let own = pairs(&self.records, colliders).chain(pairs(asleep, colliders));
        let mut own: Vec<[u32; 2]> = own.filter(|slots| is_one(*slots)).collect();
        own.sort_unstable();
        own.dedup();
        let own = own.into_iter().filter_map(|slots| ColliderPair::of_contact(bodies, colliders, slots));
        self.ended.extend(own.map(|pair| EndedPair { pair, is_sensor: false }));
    }
}
