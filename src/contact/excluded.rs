//! Pairs of bodies that do not touch each other.

use alloc::vec::Vec;

use super::flights::Flights;
use super::narrow::Narrow;
use super::resting::{Resting, Trees};
use super::slot_table::SlotTable;
use super::{ContactSet, Scene};
use crate::body::{Activity, BodyKind};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_enum};
use crate::slots::{BodyId, NONE};

/// The time for which [`World::exclude_pair`](crate::World::exclude_pair) keeps two bodies from touching each other.
///
/// ```
/// use umbra_physics::{BodyDef, Exclusion, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let disc = |radius| Ok::<_, umbra_physics::Error>(BodyDef::dynamic().with_collider(Shape::circle(radius)?));
/// let thrower = world.add_body(disc(fx!(0.5))?)?;
/// let grenade = world.add_body(BodyDef { velocity: vec2(6, 0), ..disc(fx!(0.1))? })?;
/// world.exclude_pair(thrower, grenade, Exclusion::UntilApart)?;
/// (0..30).for_each(|_| _ = world.step());
/// assert_eq!(world.body(grenade)?.position(), vec2(3, 0)); // out of the thrower without a push
/// assert_eq!(world.excluded_pairs().count(), 0); // from now on they touch
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Exclusion {
    /// Until [`World::allow_pair`](crate::World::allow_pair) is called.
    Always,
    /// Until the first step in which the bodies are too far apart to touch.
    UntilApart,
}

codec_enum!(Exclusion, "the number of an exclusion", {
    0 => Always,
    1 => UntilApart,
});

/// Two bodies that do not touch each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ExcludedPair {
    /// The slots of the bodies, the lower one first.
    pub(crate) bodies: [u32; 2],
    pub(crate) exclusion: Exclusion,
}

// The state is copied with every snapshot.
const _: () = assert!(size_of::<ExcludedPair>() == 12);

impl Write for ExcludedPair {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "first_body", &self.bodies[0]);
        codec::field(out, "second_body", &self.bodies[1]);
        codec::field(out, "exclusion", &self.exclusion);
    }
}

impl Read for ExcludedPair {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let bodies = [u32::read(reader)?, u32::read(reader)?];
        Ok(Self { bodies, exclusion: Exclusion::read(reader)? })
    }
}

/// The slots of two bodies, the lower one first.
pub(crate) fn sorted(a: BodyId, b: BodyId) -> [u32; 2] {
    [a.slot.min(b.slot), a.slot.max(b.slot)]
}

impl ContactSet {
    /// The index of a pair of bodies in the sorted list, or the index at which to insert it.
    pub(crate) fn find_excluded(&self, bodies: [u32; 2]) -> Result<usize, usize> {
        self.excluded.binary_search_by_key(&bodies, |pair| pair.bodies)
    }

    /// Returns true if there is a pair that a step may allow again.
    pub(crate) fn any_until_apart(&self) -> bool {
        self.excluded.iter().any(|pair| pair.exclusion == Exclusion::UntilApart)
    }
}

/// The pairs of bodies that stay excluded after a step.
#[derive(Debug, Default)]
pub(super) struct Exclusions {
    /// Sorted by bodies.
    pub(super) pairs: Vec<ExcludedPair>,
    /// Has a number for each body of an excluded pair, by its slot.
    excluded_bodies: SlotTable,
    /// By excluded pair of the step before: true if its bodies are near each other.
    are_near: Vec<bool>,
    /// The numbers of the outlines near an outline.
    nearby: Vec<u32>,
}

impl Exclusions {
    /// Returns true if two bodies are an excluded pair in this step, or a joint keeps them apart.
    pub(super) fn has(&self, scene: &Scene<'_>, bodies: [BodyId; 2]) -> bool {
        let pair = sorted(bodies[0], bodies[1]);
        scene.joints.keeps_apart(pair)
            || !self.pairs.is_empty() && self.pairs.binary_search_by_key(&pair, |pair| pair.bodies).is_ok()
    }

    /// Leaves out the pairs of excluded bodies, and lists the pairs of bodies that stay excluded.
    pub(super) fn leave_out_excluded(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        narrow: &mut Narrow,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        self.pairs.clear();
        let contacts = scene.contacts;
        if contacts.excluded.is_empty() {
            return;
        }
        self.excluded_bodies.clear();
        for slot in contacts.excluded.iter().flat_map(|pair| pair.bodies) {
            self.excluded_bodies.set(slot, 0);
        }
        self.are_near.clear();
        self.are_near.resize(contacts.excluded.len(), false);
        pairs.retain(|&numbers| {
            let sides = numbers.map(|number| flights.side(scene, &resting.numbers, number));
            let [Some(first), Some(second)] = &sides else { return false };
            let bodies = [first.collider.body, second.collider.body];
            if bodies.iter().any(|body| self.excluded_bodies.get(body.slot) == NONE) {
                return true;
            }
            let Ok(index) = contacts.find_excluded(sorted(bodies[0], bodies[1])) else { return true };
            let ends = contacts.excluded[index].exclusion == Exclusion::UntilApart;
            if ends && !self.are_near[index] {
                self.are_near[index] = narrow.are_near(scene, flights, resting, [first, second]);
            }
            false
        });
        for (index, pair) in contacts.excluded.iter().enumerate() {
            let is_over = pair.exclusion == Exclusion::UntilApart
                && !self.are_near[index]
                && pair.bodies.iter().all(|&slot| takes_part(scene, flights, slot))
                && !self.are_near_at_rest(scene, flights, resting, narrow, pair.bodies);
            if !is_over {
                self.pairs.push(*pair);
            }
        }
    }

    /// Returns true if two bodies that stand still, one of them asleep, are near each other: no list of pairs has them.
    fn are_near_at_rest(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        narrow: &mut Narrow,
        bodies: [u32; 2],
    ) -> bool {
        let state = |slot: u32| scene.bodies.index_in(slot).map(|dense| (dense, scene.bodies.activity(dense)));
        let states = bodies.map(state);
        let sleeps = |(_, activity): (usize, Activity)| activity == Activity::Asleep;
        if states.iter().flatten().any(|&(dense, _)| dense < scene.bodies.moving())
            || !states.iter().flatten().any(|&state| sleeps(state))
        {
            return false;
        }
        let [sleeping_body, other_body] = if states[0].is_some_and(sleeps) { bodies } else { [bodies[1], bodies[0]] };
        let sleeping_colliders = scene.colliders.solid_of_slot(sleeping_body);
        for number in sleeping_colliders.flat_map(|collider| resting.numbers.of(collider.slot)) {
            list_near(resting, number, other_body, &mut self.nearby);
            for &nearby in &self.nearby {
                let numbers = [number.min(nearby), number.max(nearby)];
                let sides = numbers.map(|number| flights.side(scene, &resting.numbers, number));
                if let [Some(first), Some(second)] = &sides {
                    if narrow.are_near(scene, flights, resting, [first, second]) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Returns true if the broad phase of this step covered a body, or the body has no colliders that meet others.
fn takes_part(scene: &Scene<'_>, flights: &Flights, slot: u32) -> bool {
    let Some(dense) = scene.bodies.index_in(slot) else { return true };
    let is_still = match scene.bodies.activity(dense) {
        Activity::Asleep => true,
        Activity::Awake => scene.bodies.contact_info(dense).kind == BodyKind::Static,
        Activity::Disabled | Activity::Quarantined => return false,
    };
    // A body at fault has no flight.
    is_still || flights.has(slot) || !scene.colliders.any_meeting_of_slot(slot)
}

/// Lists the outlines of a body at rest that make a pair with a sleeping outline.
fn list_near(resting: &Resting, sleeper: u32, body: u32, nearby: &mut Vec<u32>) {
    nearby.clear();
    let Some(Trees { statics, sleepers, .. }) = &resting.trees else { return };
    let Some(sleeper) = sleepers.find(sleeper) else { return };
    for tree in [&**statics, sleepers] {
        tree.meeting(sleeper, |proxy| {
            if proxy.body == body {
                nearby.push(proxy.collider);
            }
            true
        });
    }
}
