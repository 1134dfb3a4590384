//! The pairs of a chunk: which of them may have a contact, and their contacts.

use alloc::vec::Vec;
use core::cmp::Ordering;

use super::super::actors::{Actor, Actors, LanePlace};
use super::super::coefficients::Coefficients;
use super::super::flights::{FlightKind, Flights, PairSide};
use super::super::list::{ContactList, ContactPoints};
use super::super::narrow::Meeting;
use super::super::seams::rolling_radius;
use super::super::{ContactRecord, Scene};
use super::Pipeline;
use crate::collide::{LaneManifold, SurfacePoint};
use crate::collider::Collider;
use crate::fx::Fx;
use crate::slots::BodyId;
use crate::solve::Impulses;

/// A pair that may have a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPair {
    /// The indices of its actors.
    actors: [usize; 2],
    /// The index of its record of the step before.
    record: Option<usize>,
    /// True if the outlines pressed each other then.
    pressed: bool,
    /// True if neither body moves.
    are_asleep: bool,
    /// Its place in the lanes, if these take it.
    place: Option<LanePlace>,
}

impl Pipeline {
    /// Lists the pairs of a chunk that may have a contact. `next_record` is the first record of the step before that no earlier pair has
    /// passed.
    pub(super) fn find_near(&mut self, scene: &Scene<'_>, chunk: &[[u32; 2]], next_record: &mut usize) {
        let Self { flights, resting, narrow, near_pairs, .. } = self;
        near_pairs.clear();
        narrow.actors.begin_chunk();
        let is_simple = resting.numbers.is_simple();
        for &[first, second] in chunk {
            let Some(first) = narrow.actor(scene, flights, resting, first) else { continue };
            let Some(second) = narrow.actor(scene, flights, resting, second) else { continue };
            let pair = [narrow.actors.get(first), narrow.actors.get(second)];
            let kinds = pair.map(|actor| actor.kind);
            if !kinds.contains(&FlightKind::Dynamic) && !kinds.contains(&FlightKind::Asleep) {
                continue;
            }
            let record = find_record(scene, is_simple, pair, next_record);
            let are_asleep = !kinds.iter().any(|kind| matches!(kind, FlightKind::Dynamic | FlightKind::Kinematic));
            if are_asleep && (kinds == [FlightKind::Asleep; 2] || !scene.may_have_moved_statics) {
                continue;
            }
            let pressed = record.is_some_and(|record| !scene.contacts.records[record].is_slack());
            if !pressed && narrow.stay_apart(flights, [first, second]) {
                continue;
            }
            let place = narrow.push_pair([first, second], pressed);
            near_pairs.push(NearPair { actors: [first, second], record, pressed, are_asleep, place });
        }
    }

    /// Adds the contacts of the pairs of a chunk, and the sleeping bodies that they wake.
    pub(super) fn push_contacts(&mut self, scene: &Scene<'_>, touched: &mut Vec<BodyId>) {
        let near_pairs = core::mem::take(&mut self.near_pairs);
        let mut first: Option<(usize, PairSide<'_>)> = None;
        for near_pair in &near_pairs {
            if near_pair.place.is_some_and(|place| self.push_lane(scene, near_pair, place)) {
                continue;
            }
            // Pairs are sorted: most have the same first outline as the pair before.
            let [first_actor, second_actor] = near_pair.actors;
            if first.as_ref().is_none_or(|(actor, _)| *actor != first_actor) {
                first = self.narrow.actors.get(first_actor).side(scene).map(|side| (first_actor, side));
            }
            let second = self.narrow.actors.get(second_actor).side(scene);
            if let (Some((_, first)), Some(second)) = (&first, &second) {
                self.push_contact(scene, near_pair, [first, second], touched);
            }
        }
        self.near_pairs = near_pairs;
    }

    /// Adds the contact of a pair, if it has one, or the sleeping bodies that the pair wakes.
    #[inline(always)]
    fn push_contact(
        &mut self,
        scene: &Scene<'_>,
        near_pair: &NearPair,
        pair: [&PairSide<'_>; 2],
        touched: &mut Vec<BodyId>,
    ) {
        let Self { flights, resting, narrow, contacts, .. } = self;
        let &NearPair { actors, record, pressed, are_asleep, .. } = near_pair;
        let Some(meeting) = narrow.meet(scene, flights, resting, pair, actors, pressed) else { return };
        let manifold = &meeting.manifold;
        let kinds = pair.map(|side| side.kind);
        if kinds.contains(&FlightKind::Asleep) {
            // A dynamic body that overlaps a static one this much is pushed, and wakes: a call has placed one of the two. A body that fell
            // asleep in this contact sleeps on. A body that nothing moves would fall asleep again after each wake, and sleeps on too.
            if !are_asleep
                || manifold.is_pressed() && !scene.contacts.are_asleep_on_each_other(pair.map(|side| side.id))
            {
                let asleep = pair.into_iter().filter(|side| side.kind == FlightKind::Asleep);
                let woken =
                    asleep.map(|side| side.collider).filter(|collider| !are_asleep || is_pushed(scene, collider));
                touched.extend(woken.map(|collider| collider.body));
            }
            return;
        }
        let are_on_union = pair.map(|side| narrow.is_on_union(scene, side));
        let record = record.map(|record| &scene.contacts.records[record]);
        let (features, count) = (manifold.features(), manifold.count);
        if let (Some(record), [false, false]) =
            (record.filter(|record| !record.has_points(features, count)), are_on_union)
        {
            return self.push_changed(scene, actors, record, meeting);
        }
        let mut start = record.map_or_else(Impulses::default, |record| record.start(features, count));
        for side in (0..2).filter(|&side| are_on_union[side]) {
            narrow.start_over_seams(scene, flights, resting, pair, side, manifold, &mut start);
        }
        push_meeting(contacts, scene, flights, &narrow.actors, actors, &meeting, start);
    }

    /// Adds the contact of a pair that had other points in the step before.
    #[cold]
    fn push_changed(&mut self, scene: &Scene<'_>, actors: [usize; 2], record: &ContactRecord, mut meeting: Meeting) {
        let Self { flights, narrow, contacts, .. } = self;
        if let Some(manifold) = narrow.manifold_before(record, actors, &meeting.manifold) {
            meeting.manifold = manifold;
        }
        let start = record.start_at(&meeting.manifold);
        push_meeting(contacts, scene, flights, &narrow.actors, actors, &meeting, start);
    }

    /// Adds the contact of a pair in the lanes, if it has one. Returns false if the lane is undecided.
    #[inline(always)]
    fn push_lane(&mut self, scene: &Scene<'_>, near_pair: &NearPair, place: LanePlace) -> bool {
        let Self { flights, narrow, contacts, .. } = self;
        let &NearPair { actors, record, .. } = near_pair;
        let ends = actors.map(|actor| narrow.actors.get(actor).flight);
        let (manifolds, lane) = narrow.actors.manifolds(place);
        // Each arm ends in a call: values that take two ways to one place go through memory.
        match manifolds.get(lane) {
            LaneManifold::Undecided => return false,
            LaneManifold::None => {}
            LaneManifold::Points(count, first) => {
                let second = if count == 2 { manifolds.point(lane, 1) } else { SurfacePoint::default() };
                let points = [manifolds.point(lane, first), second];
                let features = points.map(|point| point.feature);
                let record = record.map(|record| &scene.contacts.records[record]);
                if let Some(record) = record.filter(|record| !record.has_points(features, count)) {
                    let meeting =
                        Meeting { manifold: manifolds.manifold(lane, count, first), ways: flights.ways(ends) };
                    self.push_changed(scene, actors, record, meeting);
                    return true;
                }
                let start = record.map_or_else(Impulses::default, ContactRecord::carried);
                let points = ContactPoints { normal: manifolds.normal(lane), count, points };
                push_points(contacts, scene, flights, &narrow.actors, actors, &points, start);
                if narrow.actors.have_hits(actors) {
                    let meeting =
                        Meeting { manifold: manifolds.manifold(lane, count, first), ways: flights.ways(ends) };
                    contacts.add_approach(scene, flights, &meeting);
                }
            }
        }
        true
    }
}

/// Adds the contact of two actors with these points, which starts from these impulses.
#[inline(always)]
fn push_points(
    contacts: &mut ContactList,
    scene: &Scene<'_>,
    flights: &mut Flights,
    actors: &Actors,
    pair: [usize; 2],
    points: &ContactPoints,
    start: Impulses,
) {
    let [a, b] = pair.map(|actor| actors.get(actor));
    let mixed;
    let coefficients = match actors.coefficients(pair) {
        Some(coefficients) => coefficients,
        None => {
            mixed = mixed_coefficients(scene, [a, b]);
            &mixed
        }
    };
    let mut radius = Fx::ZERO;
    if points.count == 1 && coefficients.materials.rolling_resistance > Fx::ZERO {
        radius = rolling_radius(points.points[0].feature, [a.radius(scene), b.radius(scene)]);
    }
    let ends = [a.flight, b.flight];
    ends.into_iter().for_each(|flight| flights.complete(scene, flight));
    contacts.push([a.id, b.id], flights.by_dominance(ends), points, coefficients, radius, start);
}

/// [`push_points`] for the points of a manifold.
pub(super) fn push_meeting(
    contacts: &mut ContactList,
    scene: &Scene<'_>,
    flights: &mut Flights,
    actors: &Actors,
    pair: [usize; 2],
    meeting: &Meeting,
    start: Impulses,
) {
    push_points(contacts, scene, flights, actors, pair, &ContactPoints::new(meeting), start);
    if actors.have_hits(pair) {
        contacts.add_approach(scene, flights, meeting);
    }
}

/// The coefficients of a step with more materials than it keeps.
#[cold]
fn mixed_coefficients(scene: &Scene<'_>, pair: [&Actor; 2]) -> Coefficients {
    match pair.map(|actor| scene.colliders.at(actor.id.slot)) {
        [Some(a), Some(b)] => Coefficients::new(scene, [&a.def.material, &b.def.material]),
        _ => Coefficients::default(),
    }
}

/// The index of the record of a pair from the step before. Records are sorted by pair, as the pairs are: `next_record` goes through them
/// once. `is_simple` says that slots are the numbers of outlines.
#[inline(always)]
fn find_record(scene: &Scene<'_>, is_simple: bool, pair: [&Actor; 2], next_record: &mut usize) -> Option<usize> {
    let records = &scene.contacts.records;
    // In one word.
    let number = |[first, second]: [u32; 2]| u64::from(first) << 32 | u64::from(second);
    let pair_number = number(pair.map(|actor| actor.number));
    while let Some(record) = records.get(*next_record) {
        let order = if is_simple {
            number(record.slots()).cmp(&pair_number)
        } else {
            record.pair().cmp(&pair.map(|actor| actor.id))
        };
        match order {
            Ordering::Less => *next_record += 1,
            Ordering::Equal => return Some(*next_record),
            Ordering::Greater => return None,
        }
    }
    None
}

/// Returns true if impulses push the body of a collider out of an overlap, and it can move.
fn is_pushed(scene: &Scene<'_>, collider: &Collider) -> bool {
    scene.settings.push_speed > Fx::ZERO
        && scene.bodies.index_of(collider.body).is_some_and(|dense| scene.bodies.can_move(dense))
}
