//! Pairs of bodies that do not touch each other.

use alloc::vec::Vec;

use super::engine::Engine;
use super::resting::Trees;
use super::{ContactSet, Scene};
use crate::body::{Activity, BodyKind};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write, codec_enum};
use crate::collider::OutlineId;
use crate::fx::Fx;
use crate::math::Vec2;
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

impl Engine {
    /// Returns true if two bodies are an excluded pair in this step.
    pub(super) fn are_excluded(&self, [a, b]: [BodyId; 2]) -> bool {
        !self.excluded.is_empty() && self.excluded.binary_search_by_key(&sorted(a, b), |pair| pair.bodies).is_ok()
    }

    /// Leaves out the pairs of excluded bodies, and lists the pairs of bodies that stay excluded.
    pub(super) fn leave_out_excluded(&mut self, scene: &Scene<'_>, contacts: &ContactSet, pairs: &mut Vec<[u32; 2]>) {
        self.excluded.clear();
        if contacts.excluded.is_empty() {
            return;
        }
        self.is_excluded.clear();
        for slot in contacts.excluded.iter().flat_map(|pair| pair.bodies) {
            self.is_excluded.set(slot, 0);
        }
        let mut are_near = core::mem::take(&mut self.near_excluded);
        are_near.clear();
        are_near.resize(contacts.excluded.len(), false);
        pairs.retain(|&numbers| {
            let pair = numbers.map(|number| self.resting.numbers.outline(number));
            let [Some(a), Some(b)] = pair.map(|outline| scene.colliders.at(outline.slot)) else { return false };
            if [a, b].iter().any(|collider| self.is_excluded.get(collider.body.slot) == NONE) {
                return true;
            }
            let Ok(index) = contacts.find_excluded(sorted(a.body, b.body)) else { return true };
            let ends = contacts.excluded[index].exclusion == Exclusion::UntilApart;
            if ends && !are_near[index] {
                are_near[index] = self.is_near(scene, numbers, pair);
            }
            false
        });
        for (pair, &is_near) in contacts.excluded.iter().zip(&are_near) {
            let mut is_over = || {
                let is_apart = !is_near && pair.bodies.iter().all(|&slot| self.takes_part(scene, slot));
                is_apart && !self.are_near_at_rest(scene, pair.bodies)
            };
            if pair.exclusion == Exclusion::Always || !is_over() {
                self.excluded.push(*pair);
            }
        }
        self.near_excluded = are_near;
    }

    /// Returns true if the broad phase of this step covered a body, or the body has no colliders to cover.
    fn takes_part(&self, scene: &Scene<'_>, slot: u32) -> bool {
        let Some(dense) = scene.bodies.index_in(slot) else { return true };
        let is_still = match scene.bodies.activity(dense) {
            Activity::Asleep => true,
            Activity::Awake => scene.bodies.contact_info(dense).kind == BodyKind::Static,
            Activity::Disabled | Activity::Quarantined => return false,
        };
        // A body at fault has no flight.
        is_still || self.flights.has(slot) || scene.colliders.of_slot(slot).next().is_none()
    }

    /// Returns true if two bodies that stand still, one of them asleep, are near each other: no list of pairs has them.
    fn are_near_at_rest(&mut self, scene: &Scene<'_>, bodies: [u32; 2]) -> bool {
        let state = |slot: u32| scene.bodies.index_in(slot).map(|dense| (dense, scene.bodies.activity(dense)));
        let states = bodies.map(state);
        let sleeps = |(_, activity): (usize, Activity)| activity == Activity::Asleep;
        if states.iter().flatten().any(|&(dense, _)| dense < scene.bodies.moving())
            || !states.iter().flatten().any(|&state| sleeps(state))
        {
            return false;
        }
        let [sleeping_body, other_body] = if states[0].is_some_and(sleeps) { bodies } else { [bodies[1], bodies[0]] };
        let mut near_numbers = core::mem::take(&mut self.near_numbers);
        let are_near = scene.colliders.solid_of_slot(sleeping_body).any(|collider| {
            let first = self.resting.numbers.first(collider.slot);
            (first..first + collider.outline_count()).any(|number| {
                self.list_near(number, other_body, &mut near_numbers);
                near_numbers.iter().any(|&other_number| {
                    let numbers = [number.min(other_number), number.max(other_number)];
                    self.is_near(scene, numbers, numbers.map(|number| self.resting.numbers.outline(number)))
                })
            })
        });
        self.near_numbers = near_numbers;
        are_near
    }

    /// Lists the outlines of a body at rest that make a pair with a sleeping outline.
    fn list_near(&self, sleeper: u32, body: u32, near_numbers: &mut Vec<u32>) {
        near_numbers.clear();
        let Some(Trees { statics, sleepers, .. }) = &self.resting.trees else { return };
        let Some(sleeper) = sleepers.find(sleeper) else { return };
        for tree in [&**statics, sleepers] {
            tree.meeting(sleeper, |proxy| {
                if proxy.body == body {
                    near_numbers.push(proxy.collider);
                }
                true
            });
        }
    }

    /// Returns true if two outlines have a manifold, or would have one after a small shift. Outlines that overlap have none where all
    /// directions out tie, such as two discs with one centre: the shift tells these from outlines that are apart. The four shifts are their
    /// own mirror image.
    fn is_near(&mut self, scene: &Scene<'_>, numbers: [u32; 2], pair: [OutlineId; 2]) -> bool {
        /// 2^-10 m
        const SHIFT: Fx = Fx::from_bits(1 << 22);
        if self.mean_manifold(scene, numbers, pair).is_some() {
            return true;
        }
        let [Some(a), Some(b)] = pair.map(|outline| scene.colliders.at(outline.slot)) else { return false };
        let colliders = [a, b];
        let ends = colliders.map(|collider| self.flights.of(scene, collider.body.slot));
        let outlines = [0, 1].map(|side| colliders[side].outline(pair[side].part));
        let second_core = self.core(scene, numbers[1], &outlines[1], ends[1]);
        let pose = self.flights.body(ends[0]).pose;
        let zero = Fx::ZERO;
        let shifts = [(SHIFT, zero), (-SHIFT, zero), (zero, SHIFT), (zero, -SHIFT)];
        shifts.into_iter().any(|(x, y)| {
            let first_core = self.cores.push(&outlines[0].outline, &pose.shifted(Vec2::new(x, y)));
            let flights = ends.map(|flight| self.flights.flight(flight));
            let margin = self.margin(flights, [outlines[0].radius, outlines[1].radius]);
            self.cores.collide(first_core, second_core, margin).is_some()
        })
    }
}
