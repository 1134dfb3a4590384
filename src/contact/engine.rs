//! The search for contacts: pairs of colliders, their manifolds, and records.

use alloc::sync::Arc;
use alloc::vec::Vec;

#[cfg(feature = "selftest")]
use super::MARGIN;
use super::approach::approach;
use super::body_tiles::BodyTiles;
use super::excluded::ExcludedPair;
use super::flights::{FlightOf, Flights};
use super::list::{ContactList, DetectedContact};
use super::moment::{Way, take_back};
use super::passes::{NearbyManifold, PassRecord};
use super::reach::{closing, swept};
use super::resting::{Resting, Trees};
use super::seams::{self, Features, Union, Unions, corners, rolling_radius, take_over};
use super::solved::Again;
use super::stamped::Stamped;
use super::surfaces::Surfaces;
use super::sweep;
use super::tiles::{SLANTED, Tiles, are_joined, is_polygon};
use super::{ContactRecord, ContactSet, Detected, Scene, pair_limits, sorted};
use crate::body::Activity;
use crate::collide::broad::{BroadPhase, PairLimits, Proxy, Standing, Statics};
use crate::collide::seam::Face;
use crate::collide::{Cores, Manifold, Margin, Pose};
use crate::collider::{BodyOutline, Collider, ColliderSet, OutlineId};
use crate::fx::Fx;
use crate::slots::{BodyId, NONE};
use crate::solve::{Flight, Impulses};

/// The search for the contacts of a world, and its memory. No result depends on earlier steps through it.
#[derive(Debug, Default)]
pub(crate) struct Engine {
    pub(super) flights: Flights,
    pub(super) resting: Resting,
    pub(super) unions: Unions,
    pub(super) tiles: Tiles,
    body_tiles: BodyTiles,
    /// Outlines in world axes, and the index of each by its number.
    pub(super) cores: Cores,
    pub(super) core_of: Stamped,
    /// The index of each outline at its start pose, by its number.
    start_core_of: Stamped,
    pub(super) broad: BroadPhase,
    pub(super) movers: Vec<Proxy>,
    pub(super) contacts: ContactList,
    /// The answers of one-way colliders in this step.
    pub(super) passes: Vec<PassRecord>,
    pub(super) nearby_manifolds: Vec<NearbyManifold>,
    /// The pairs of bodies that stay excluded after this step, and the bodies of all pairs.
    pub(super) excluded: Vec<ExcludedPair>,
    pub(super) is_excluded: Stamped,
    /// Workspace: by excluded pair, true if its bodies are near each other.
    pub(super) near_excluded: Vec<bool>,
    /// Workspace: the numbers of the outlines near an outline.
    pub(super) near_numbers: Vec<u32>,
    pub(super) sweep: sweep::Workspace,
    pub(super) again: Again,
    /// No contact is found ahead of time.
    #[cfg(feature = "selftest")]
    pub(super) is_discrete: bool,
}

/// An outline of a pair.
struct Side<'a> {
    number: u32,
    outline: OutlineId,
    collider: &'a Collider,
    flight: u32,
    kind: FlightOf,
}

impl Engine {
    /// Lists the boxes of moving colliders over the step.
    pub(super) fn place_movers(&mut self, scene: &Scene<'_>) {
        self.movers.clear();
        for flight in 0..self.flights.len() as u32 {
            let body = self.flights.body(flight);
            for collider in scene.colliders.solid_of_slot(body.slot) {
                let first = self.resting.numbers.first(collider.slot);
                for part in 0..collider.outline_count() {
                    let bounds = swept(&collider.outline(part), &body.pose, self.flights.flight(flight));
                    let filter = collider.def.filter;
                    self.movers.push(Proxy { collider: first + part, body: body.slot, bounds, filter, digest: 0 });
                }
            }
        }
    }

    /// An outline in world axes, placed when it is first asked for.
    #[inline(always)]
    pub(super) fn core(&mut self, scene: &Scene<'_>, number: u32, outline: &BodyOutline, flight: u32) -> usize {
        match self.core_of.get(number) {
            NONE => self.place(scene, number, outline, flight),
            core => core as usize,
        }
    }

    fn place(&mut self, scene: &Scene<'_>, number: u32, outline: &BodyOutline, flight: u32) -> usize {
        let pose = self.flights.body(flight).pose;
        let core = self.push_core(scene, number, outline, flight, &pose);
        self.core_of.set(number, core as u32);
        core
    }

    /// Places an outline at a pose of its body.
    pub(super) fn push_core(
        &mut self,
        scene: &Scene<'_>,
        number: u32,
        outline: &BodyOutline,
        flight: u32,
        pose: &Pose,
    ) -> usize {
        let core = self.cores.push(&outline.outline, pose);
        if !is_polygon(outline) {
            return core;
        }
        let body = self.flights.body(flight);
        match (&self.resting.trees, body.kind) {
            (Some(Trees { statics, .. }), FlightOf::Static) => {
                if let Some(faces) = self.tiles.find(scene, statics, &self.resting.numbers, number, outline, pose) {
                    self.cores.set_faces(faces.iter().copied());
                }
            }
            (_, FlightOf::Static) => {}
            _ => {
                let id = self.resting.numbers.outline(number);
                if !scene.colliders.at(id.slot).is_some_and(Collider::has_others) {
                    return core;
                }
                if let Some(faces) = self.body_tiles.find(scene.colliders, body.slot, id) {
                    self.cores.set_faces(faces.iter().map(|face| face.turned(pose)));
                }
            }
        }
        core
    }

    /// The surface of an outline that was placed; none if the outline stands alone.
    pub(super) fn faces(&self, scene: &Scene<'_>, number: u32) -> &[Face] {
        let id = self.resting.numbers.outline(number);
        let Some(collider) = scene.colliders.at(id.slot) else { return &[] };
        let slot = collider.body.slot;
        let surface = match self.flights.at(slot).map(|flight| self.flights.body(flight).kind) {
            Some(FlightOf::Static) => self.tiles.surface(number),
            _ if collider.has_others() => self.body_tiles.surface(scene.colliders, slot, id),
            _ => None,
        };
        surface.unwrap_or_default()
    }

    /// An outline of a body at the start of the step.
    pub(super) fn start_core(&mut self, scene: &Scene<'_>, number: u32, outline: &BodyOutline, flight: u32) -> usize {
        let Some(pose) = self.flights.start_pose(scene, flight) else {
            return self.core(scene, number, outline, flight);
        };
        if self.start_core_of.get(number) == NONE {
            let core = self.push_core(scene, number, outline, flight, &pose);
            self.start_core_of.set(number, core as u32);
        }
        self.start_core_of.get(number) as usize
    }

    /// For a contact with a segment of a chain, or with a polygon among others: adds the impulses that its points had with other segments or
    /// polygons to the impulses that it starts from. The surface is at this side of the pair.
    #[cold]
    fn start_over_seams(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
        side: usize,
        contacts: &ContactSet,
        features: Features,
        start: &mut Impulses,
    ) {
        let body_side = 1 - side;
        let Some(collider) = scene.colliders.at(pair[side].slot) else { return };
        let Some(union) = Union::of(scene, collider) else { return };
        let mut terms = core::mem::take(&mut self.unions.terms);
        terms.clear();
        let mut first_corner = None;
        for corner in corners(features, body_side) {
            for i in self.unions.find(scene, contacts, union, pair[body_side], corner..=corner) {
                let record = contacts.records[self.unions.record(i)];
                // A body may be the first of its pair with one tile, and the second of its pair with the next tile.
                let record = if record.pair()[body_side] == pair[body_side] { record } else { record.swapped() };
                let before = record.pair();
                let mut record_corners = corners((record.features(), record.count()), body_side);
                let is_repeated = first_corner.is_some_and(|first| record_corners.any(|corner| corner == first));
                if before[side] == pair[side] || is_repeated {
                    continue;
                }
                let mut numbers_before = numbers;
                numbers_before[side] = self.resting.numbers.first(before[side].slot) + before[side].part;
                let manifold = self.mean_manifold(scene, numbers_before, before);
                let is_joined = matches!(union, Union::Chain(_)) || {
                    let faces = [numbers[side], numbers_before[side]].map(|number| self.faces(scene, number));
                    are_joined(faces, side, features, &record, SLANTED)
                };
                if is_joined {
                    let record_features = manifold.map(|manifold| (manifold.features(), manifold.count));
                    take_over(&mut terms, features, &record, record_features, body_side);
                }
            }
            first_corner = Some(corner);
        }
        seams::add(start, &terms);
        self.unions.terms = terms;
    }

    /// The manifold of two outlines at the start of the step.
    pub(super) fn start_manifold(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
    ) -> Option<Manifold> {
        let [a, b] = pair.map(|outline| scene.colliders.at(outline.slot));
        let colliders = [a?, b?];
        let ends = colliders.map(|collider| self.flights.of(scene, collider.body.slot));
        let outlines = [colliders[0].outline(pair[0].part), colliders[1].outline(pair[1].part)];
        let cores = [
            self.start_core(scene, numbers[0], &outlines[0], ends[0]),
            self.start_core(scene, numbers[1], &outlines[1], ends[1]),
        ];
        let flights = ends.map(|flight| self.flights.flight(flight));
        self.cores.collide(cores[0], cores[1], self.margin(flights, [outlines[0].radius, outlines[1].radius]))
    }

    /// The manifold of two outlines at the moment of manifolds of bodies that press each other.
    pub(super) fn mean_manifold(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
    ) -> Option<Manifold> {
        let [a, b] = pair.map(|outline| scene.colliders.at(outline.slot));
        let colliders = [a?, b?];
        let ends = colliders.map(|collider| self.flights.of(scene, collider.body.slot));
        self.manifold(scene, numbers, pair.map(|outline| outline.part), colliders, ends)
    }

    /// The manifold of two outlines of these colliders, with these flights, at the moment of manifolds of bodies that press each other.
    #[inline(always)]
    pub(super) fn manifold(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        parts: [u32; 2],
        colliders: [&Collider; 2],
        ends: [u32; 2],
    ) -> Option<Manifold> {
        let a = colliders[0].outline(parts[0]);
        let b = colliders[1].outline(parts[1]);
        let cores = [self.core(scene, numbers[0], &a, ends[0]), self.core(scene, numbers[1], &b, ends[1])];
        let flights = ends.map(|flight| self.flights.flight(flight));
        self.cores.collide(cores[0], cores[1], self.margin(flights, [a.radius, b.radius]))
    }

    /// The largest distance of two outlines of these radii at which they have a manifold.
    #[inline(always)]
    pub(super) fn margin(&self, flights: [&Flight; 2], radii: [Fx; 2]) -> Margin {
        #[cfg(feature = "selftest")]
        if self.is_discrete {
            return MARGIN.into();
        }
        closing(flights, radii)
    }

    /// An outline by its number.
    #[inline(always)]
    fn side<'a>(&mut self, scene: &Scene<'a>, number: u32) -> Option<Side<'a>> {
        let outline = self.resting.numbers.outline(number);
        let collider = scene.colliders.at(outline.slot)?;
        let flight = self.flights.of(scene, collider.body.slot);
        Some(Side { number, outline, collider, flight, kind: self.flights.body(flight).kind })
    }

    /// Finds the manifold of a pair, if it has one.
    fn collide(
        &mut self,
        scene: &Scene<'_>,
        [first, second]: [&Side<'_>; 2],
        contacts: &ContactSet,
        next: &mut usize,
        out: &mut Detected,
    ) {
        let numbers = [first.number, second.number];
        let pair = [first.outline, second.outline];
        let [a, b] = [first.collider, second.collider];
        let ends = [first.flight, second.flight];
        let kinds = [first.kind, second.kind];
        if !kinds.contains(&FlightOf::Dynamic) && !kinds.contains(&FlightOf::Asleep) {
            return;
        }
        // The records are sorted by pair, as the pairs are.
        let is_simple = self.resting.numbers.is_simple();
        let order =
            |record: &ContactRecord| if is_simple { record.slots().cmp(&numbers) } else { record.pair().cmp(&pair) };
        while contacts.records.get(*next).is_some_and(|record| order(record).is_lt()) {
            *next += 1;
        }
        let record = contacts.records.get(*next).filter(|record| order(record).is_eq());
        let is_asleep = !kinds.iter().any(|kind| matches!(kind, FlightOf::Dynamic | FlightOf::Kinematic));
        if is_asleep && (kinds == [FlightOf::Asleep; 2] || !scene.may_have_moved_statics) {
            return;
        }
        let pressed = record.is_some_and(|record| !record.is_slack());
        let Some((manifold, ways)) = self.meet(scene, numbers, pair, [a, b], ends, contacts, pressed) else { return };
        if kinds.contains(&FlightOf::Asleep) {
            // A dynamic body that overlaps a static one this much is pushed, and wakes: a call has placed one of the two. A body that fell
            // asleep in this contact sleeps on. A body that nothing moves would fall asleep again after each wake, and sleeps on too.
            let is_pushed = |collider: &Collider| {
                scene.settings.push_speed > Fx::ZERO
                    && scene.bodies.index_of(collider.body).is_some_and(|dense| scene.bodies.can_move(dense))
            };
            if !is_asleep || manifold.is_pressed() && !contacts.are_asleep_on_each_other(pair) {
                let asleep = [a, b].into_iter().zip(kinds).filter(|(_, kind)| *kind == FlightOf::Asleep);
                let woken = asleep.map(|(collider, _)| collider).filter(|collider| !is_asleep || is_pushed(collider));
                out.touched.extend(woken.map(|collider| collider.body));
            }
            return;
        }
        let features = manifold.features();
        let count = manifold.count;
        let mut start = record.map_or_else(Default::default, |record| record.start(features, count));
        for (side, collider) in [a, b].into_iter().enumerate() {
            let may_have_neighbours = kinds[side] == FlightOf::Static || collider.has_others();
            if collider.def.shape.is_chain() || may_have_neighbours && !self.faces(scene, numbers[side]).is_empty() {
                self.start_over_seams(scene, numbers, pair, side, contacts, (features, count), &mut start);
            }
        }
        self.add_contact(scene, pair, [a, b], ends, &manifold, &ways, start);
    }

    /// Adds the contact of a pair, with a manifold of the moment at the end of these ways, for the solver.
    pub(super) fn add_contact(
        &mut self,
        scene: &Scene<'_>,
        pair: [OutlineId; 2],
        [a, b]: [&Collider; 2],
        ends: [u32; 2],
        manifold: &Manifold,
        ways: &[Way; 2],
        start: Impulses,
    ) {
        ends.into_iter().for_each(|flight| self.flights.complete(scene, flight));
        let ends = self.flights.by_dominance(ends);
        let features = manifold.features();
        let count = manifold.count;
        let materials = [&a.def.material, &b.def.material];
        let defined = if scene.colliders.material_pairs().is_empty() {
            None
        } else {
            scene.colliders.material_pair(materials.map(|material| material.id)).copied()
        };
        let coefficients = defined.unwrap_or_else(|| materials[0].mixed(materials[1]));
        let rolling_radius = if count == 1 && coefficients.rolling_resistance > Fx::ZERO {
            rolling_radius(features[0], [0, 1].map(|side| [a, b][side].outline(pair[side].part).outline.radius()))
        } else {
            Fx::ZERO
        };
        let speed = materials[0].surface_speed_against(materials[1]);
        let mut contact = Surfaces { coefficients, rolling_radius, speed }.contact(ends, manifold, start);
        contact.points.iter_mut().for_each(|point| take_back(point, manifold.normal, ways));
        let approach = (a.def.hit_events || b.def.hit_events)
            .then(|| approach(scene, manifold, ways, &contact, ends.map(|flight| self.flights.flight(flight))));
        self.contacts.push(DetectedContact { pair, features, count, start }, contact, approach);
    }

    /// Finds the contacts at the start poses, with the impulses that they start from. Adds to `touched` the sleeping bodies that a
    /// moving one touches or that have too many pairs, and to `crowded` the indices in the columns of moving bodies with too many pairs.
    /// If there are any, the contacts are incomplete: the step wakes or quarantines the bodies and calls this again.
    pub(crate) fn detect(&mut self, scene: &Scene<'_>, contacts: &ContactSet, out: &mut Detected) {
        self.cores.clear();
        self.contacts.clear();
        self.core_of.clear();
        self.sweep.deflected.clear();
        self.again.clear();
        self.start_core_of.clear();
        self.unions.clear();
        self.flights.begin(scene);
        if self.resting.update(scene, &mut out.disturbed) {
            self.tiles.clear();
        }
        self.place_movers(scene);
        let limits = pair_limits(scene.settings, scene.colliders);
        self.pair_moving(&limits);
        let crowded = self.broad.above_cap().iter().map(|&number| self.resting.numbers.outline(number));
        let crowded = crowded.filter_map(|outline| scene.colliders.at(outline.slot));
        for collider in crowded {
            match scene.bodies.index_of(collider.body) {
                Some(dense) if dense < scene.bodies.moving() => out.crowded.push(dense),
                // A sleeping body is at fault as if it were awake: sleep must not decide who is quarantined.
                Some(_) => out.touched.push(collider.body),
                None => {}
            }
        }
        if !out.crowded.is_empty() || !out.touched.is_empty() {
            return;
        }
        let mut pairs = self.broad.take_pairs();
        self.resting.pair_disturbed(scene, contacts, &out.disturbed, &mut pairs);
        self.leave_out_excluded(scene, contacts, &mut pairs);
        self.leave_out_passing(scene, contacts, &out.disturbed, &mut pairs);
        let mut next = 0;
        let mut first: Option<Side<'_>> = None;
        for &[a, b] in &pairs {
            // Pairs are sorted: most have the same first outline as the pair before.
            if first.as_ref().is_none_or(|side| side.number != a) {
                first = self.side(scene, a);
            }
            if let (Some(first), Some(second)) = (&first, &self.side(scene, b)) {
                self.collide(scene, [first, second], contacts, &mut next, out);
            }
        }
        self.broad.return_pairs(pairs);
    }

    /// Adds to `touched` the sleeping bodies that the bodies of `scene.starts` touch; none where bodies have too many pairs. The bodies of
    /// `scene.starts` woke since contacts were detected, and nothing else has changed.
    pub(crate) fn spread(&mut self, scene: &Scene<'_>, contacts: &ContactSet, out: &mut Detected) {
        // Bodies with too many pairs are at fault before they touch anything.
        if !self.broad.above_cap().is_empty() {
            return;
        }
        self.cores.clear();
        self.core_of.clear();
        self.flights.begin(scene);
        self.place_movers(scene);
        let Some(Trees { sleepers, .. }) = &self.resting.trees else { return };
        let numbers = &self.resting.numbers;
        let body = |number: u32| scene.colliders.at(numbers.outline(number).slot).map(|collider| collider.body);
        let sleeps = |body: &BodyId| {
            scene.bodies.index_of(*body).is_some_and(|dense| scene.bodies.activity(dense) == Activity::Asleep)
        };
        let mut pairs = self.broad.take_pairs();
        pairs.clear();
        for mover in &self.movers {
            sleepers.meeting(mover, |sleeper| {
                // The tree still has the colliders of bodies that woke since it was made.
                let bodies = body(mover.collider).zip(body(sleeper.collider).filter(sleeps));
                if bodies.is_some_and(|(a, b)| contacts.find_excluded(sorted(a, b)).is_err()) {
                    pairs.push([mover.collider.min(sleeper.collider), mover.collider.max(sleeper.collider)]);
                }
                true
            });
        }
        pairs.sort_unstable();
        self.leave_out_passing(scene, contacts, &out.disturbed, &mut pairs);
        for &numbers in &pairs {
            let pair = numbers.map(|number| self.resting.numbers.outline(number));
            if self.start_manifold(scene, numbers, pair).is_some() {
                let bodies = pair.into_iter().filter_map(|outline| scene.colliders.at(outline.slot));
                out.touched.extend(bodies.map(|collider| collider.body).filter(sleeps));
            }
        }
        self.broad.return_pairs(pairs);
    }

    /// Finds the pairs of moving colliders, which are the pairs of the step. If there are too many pairs or overlaps, sleeping ones included,
    /// sleeping colliders are treated as moving ones: sleep must not decide which bodies have too many.
    pub(super) fn pair_moving(&mut self, limits: &PairLimits) {
        let Some(trees) = &self.resting.trees else { return };
        let overlaps = limits.overlaps.saturating_sub(trees.counts.overlaps);
        self.broad.update(&trees.standing(), &self.movers, &PairLimits { overlaps, ..*limits });
        let are_above = self.broad.pairs().len().saturating_add(trees.counts.pairs) > limits.pairs;
        if !trees.sleepers.is_empty() && (are_above || !self.broad.above_cap().is_empty()) {
            self.movers.extend(trees.sleepers.iter());
            // No real version has this number, so that the broad phase drops its cache of sleepers.
            let standing = Standing { version: u64::MAX, ..Standing::of(&trees.statics) };
            self.broad.update(&standing, &self.movers, limits);
        }
    }

    /// The tree of static colliders of the last search, if it belongs to these colliders.
    pub(crate) fn statics(&self, colliders: &ColliderSet) -> Option<&Arc<Statics>> {
        self.resting.current(colliders).map(|trees| &trees.statics)
    }

    /// The tree of the colliders of sleeping bodies of the last search, likewise.
    pub(crate) fn sleepers(&self, colliders: &ColliderSet) -> Option<&Statics> {
        self.resting.current(colliders).map(|trees| &trees.sleepers)
    }

    /// An outline by its number in [`statics`](Self::statics) and [`sleepers`](Self::sleepers).
    pub(crate) fn outline(&self, number: u32) -> OutlineId {
        self.resting.numbers.outline(number)
    }

    /// The number of the first outline of the collider in a slot, likewise.
    pub(crate) fn number(&self, slot: u32) -> u32 {
        self.resting.numbers.first(slot)
    }

    /// Finds contacts ahead of time or not, for tests.
    #[cfg(feature = "selftest")]
    pub(crate) fn set_discrete(&mut self, is_discrete: bool) {
        self.is_discrete = is_discrete;
    }

    /// Takes over the caches of the contacts of another world, of which this world is a copy.
    pub(crate) fn clone_cached_from(&mut self, source: &Self) {
        if self.resting.copy_from(&source.resting) {
            self.tiles.clear();
        }
    }
}
