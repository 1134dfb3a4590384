//! One-way colliders: which bodies they hold, and which pass.
//!
//! Whether a one-way outline holds a body is an *answer*, kept from step to step. It follows from the answer of the step before and from
//! the nearest manifold of the outline with the colliders of the body. Where several are nearest, all of them must face the side that
//! holds: so the order of manifolds does not matter.

use alloc::vec::Vec;

use super::flights::{FlightKind, Flights, PairSide};
use super::narrow::Narrow;
use super::resting::Resting;
use super::{ChangedResting, ContactSet, MARGIN, Scene};
use crate::body::{Activity, BodyKind};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::collider::OutlineId;
use crate::fx::Fx;
use crate::slots::BodyId;

/// The answer of a one-way collider for a body near it. *Domain* the part is below 2^16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OneWayAnswer {
    /// The slot of the collider.
    pub(crate) collider: u32,
    /// The slot of the body.
    pub(crate) body: u32,
    part: u16,
    /// True if the body passes, false if it is held.
    pub(crate) passes: bool,
}

// The state is copied with every snapshot.
const _: () = assert!(size_of::<OneWayAnswer>() == 12 && crate::limits::CHAIN <= 1 << 16);

/// An outline of a one-way collider, and the slot of a body.
type Place = (OutlineId, u32);

impl OneWayAnswer {
    pub(crate) fn new(outline: OutlineId, body: u32, passes: bool) -> Self {
        Self { collider: outline.slot, body, part: outline.part as u16, passes }
    }

    /// The records of a world are sorted by this.
    pub(crate) fn place(&self) -> Place {
        (OutlineId { slot: self.collider, part: self.part.into() }, self.body)
    }
}

impl Write for OneWayAnswer {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "collider", &self.collider);
        codec::field(out, "part", &self.part);
        codec::field(out, "body", &self.body);
        codec::field(out, "passes", &self.passes);
    }
}

impl Read for OneWayAnswer {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let (collider, part, body) = (u32::read(reader)?, u16::read(reader)?, u32::read(reader)?);
        Ok(Self { collider, body, part, passes: bool::read(reader)? })
    }
}

/// A manifold of a one-way outline and a body.
#[derive(Debug)]
pub(super) struct NearbyManifold {
    place: Place,
    /// The least separation, m.
    separation: Fx,
    /// True if the normal is within the tolerance.
    is_facing: bool,
}

/// Returns true if a body passes. `separation` is the least one of its manifolds, and `is_facing` is true if its nearest manifold faces the
/// side that holds; `before` is the answer of the step before. With its own answer as `before` the answer is the same, so that a body at
/// rest does not alternate.
fn passes(before: Option<bool>, separation: Fx, is_facing: bool) -> bool {
    match before {
        Some(true) => separation <= Fx::ZERO || !is_facing,
        Some(false) => separation > MARGIN && !is_facing,
        None => separation < -MARGIN || !is_facing,
    }
}

/// The answers of one-way colliders in a step.
#[derive(Debug, Default)]
pub(super) struct OneWay {
    pub(super) answers: Vec<OneWayAnswer>,
    nearby_manifolds: Vec<NearbyManifold>,
}

impl OneWay {
    /// Leaves out the pairs of one-way colliders and of bodies that pass, and lists the answers of all one-way colliders.
    pub(super) fn leave_out_passing(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        narrow: &mut Narrow,
        changed_resting: &ChangedResting,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        self.answers.clear();
        if !scene.colliders.any_one_way() {
            return;
        }
        self.nearby_manifolds.clear();
        let is_one_way = |&number: &u32| {
            let collider = scene.colliders.at(resting.numbers.outline(number).slot);
            collider.is_some_and(|collider| collider.side.is_some())
        };
        for &numbers in pairs.iter().filter(|numbers| numbers.iter().any(is_one_way)) {
            let sides = numbers.map(|number| flights.side(scene, &resting.numbers, number));
            if let [Some(first), Some(second)] = &sides {
                self.add_nearby_manifolds(scene, flights, resting, narrow, [first, second]);
            }
        }
        self.nearby_manifolds.sort_unstable_by_key(|manifold| manifold.place);
        for group in self.nearby_manifolds.chunk_by(|a, b| a.place == b.place) {
            let separation = group.iter().fold(group[0].separation, |min, manifold| manifold.separation.min(min));
            let mut nearest = group.iter().filter(|manifold| manifold.separation == separation);
            let is_facing = nearest.all(|manifold| manifold.is_facing);
            let (outline, body) = group[0].place;
            let passes = passes(scene.contacts.passes_at(group[0].place), separation, is_facing);
            self.answers.push(OneWayAnswer::new(outline, body, passes));
        }
        let unchanged = scene.contacts.passes.iter().filter(|record| is_at_rest(scene, record, changed_resting));
        self.answers.extend(unchanged);
        self.answers.sort_unstable_by_key(OneWayAnswer::place);
        pairs.retain(|&numbers| {
            let [a, b] = numbers.map(|number| resting.numbers.outline(number));
            let body = |outline: OutlineId| scene.colliders.at(outline.slot).map(|collider| collider.body.slot);
            let passes = |outline, visitor| {
                let place = body(visitor).map(|body| (outline, body));
                place.and_then(|place| answer(&self.answers, place)) == Some(true)
            };
            !passes(a, b) && !passes(b, a)
        });
    }

    /// Returns true if an outline of a one-way collider holds the body in a slot in this step.
    pub(super) fn holds(&self, outline: OutlineId, body: u32) -> bool {
        answer(&self.answers, (outline, body)) == Some(false)
    }

    /// Adds the manifold of a pair, once for each of its colliders that is one-way.
    fn add_nearby_manifolds(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        narrow: &mut Narrow,
        pair: [&PairSide<'_>; 2],
    ) {
        let kinds = pair.map(|side| side.kind);
        let any_moves = kinds.iter().any(|kind| matches!(kind, FlightKind::Dynamic | FlightKind::Kinematic));
        let any_sleeps = kinds.contains(&FlightKind::Asleep);
        if !any_sleeps && !kinds.contains(&FlightKind::Dynamic) {
            return;
        }
        // Pairs that stand still keep their answers: see `is_at_rest`.
        let both_sleep = kinds == [FlightKind::Asleep; 2];
        if !any_moves && (both_sleep || !scene.may_have_moved_statics) {
            return;
        }
        let Some(manifold) = narrow.start_manifold(scene, flights, resting, pair) else { return };
        for side in 0..2 {
            if let Some(holds) = pair[side].collider.side {
                let flight = pair[side].flight;
                let pose = flights.start_pose(scene, flight).unwrap_or(flights.body(flight).pose);
                let cosine = manifold.cosine_with(pose.turned(holds.direction));
                self.nearby_manifolds.push(NearbyManifold {
                    place: (pair[side].id, pair[1 - side].collider.body.slot),
                    separation: manifold.least_separation(),
                    is_facing: if side == 0 { cosine >= holds.cosine } else { -cosine >= holds.cosine },
                });
            }
        }
    }
}

/// The answer in a sorted list.
fn answer(passes: &[OneWayAnswer], place: Place) -> Option<bool> {
    let index = passes.binary_search_by_key(&place, OneWayAnswer::place);
    index.ok().map(|index| passes[index].passes)
}

/// Returns true if a record stays as it is: both bodies sleep, or one does and the other is static, and nothing near them has changed. Changed
/// pairs are tested again ([`pair_changed`](super::resting::Resting::pair_changed)).
fn is_at_rest(scene: &Scene<'_>, record: &OneWayAnswer, changed_resting: &ChangedResting) -> bool {
    let state = |body: Option<u32>| {
        let dense = scene.bodies.index_in(body?)?;
        Some((scene.bodies.activity(dense), scene.bodies.contact_info(dense).kind))
    };
    let [Some(a), Some(b)] = [state(platform(scene, record)), state(Some(record.body))] else { return false };
    let sleeps = |(activity, _)| activity == Activity::Asleep;
    let is_static = |(activity, kind)| activity == Activity::Awake && kind == BodyKind::Static;
    let one_sleeps = sleeps(a) && is_static(b) || is_static(a) && sleeps(b);
    sleeps(a) && sleeps(b) || one_sleeps && !has_changed(scene, record, changed_resting)
}

/// The slot of the body of the one-way collider of a record.
fn platform(scene: &Scene<'_>, record: &OneWayAnswer) -> Option<u32> {
    scene.colliders.at(record.collider).map(|collider| collider.body.slot)
}

/// Returns true if one of the bodies of a record, or a collider of one, may have changed while both stood still.
pub(super) fn has_changed(scene: &Scene<'_>, record: &OneWayAnswer, changed_resting: &ChangedResting) -> bool {
    let mut bodies = platform(scene, record).into_iter().chain([record.body]);
    scene.may_have_moved_statics && bodies.any(|body| changed_resting.has(body))
}

impl ContactSet {
    /// The answer for an outline of a one-way collider and a body, if they were near each other in the last step.
    fn passes_at(&self, place: Place) -> Option<bool> {
        answer(&self.passes, place)
    }

    /// Drops the answers and the excluded pairs of a body that is removed.
    pub(crate) fn forget_body(&mut self, body: BodyId) {
        self.passes.retain(|record| record.body != body.slot);
        self.excluded.retain(|pair| !pair.bodies.contains(&body.slot));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx::fx;

    #[test]
    fn a_question_asked_again_has_the_same_answer() {
        for before in [None, Some(true), Some(false)] {
            for separation in
                [-1, 0, 1].into_iter().flat_map(|k| [fx!(0.5), MARGIN, fx!(0.001)].map(|distance| distance * k))
            {
                for is_facing in [false, true] {
                    let first = passes(before, separation, is_facing);
                    assert_eq!(
                        passes(Some(first), separation, is_facing),
                        first,
                        "{before:?} {separation} {is_facing}"
                    );
                }
            }
        }
    }
}
