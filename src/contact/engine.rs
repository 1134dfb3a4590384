//! Contacts of a world, whatever the scalar: pairs of colliders, their manifolds, and records.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::events::{ColliderPair, ContactHit, has_events};
use super::excluded::ExcludedPair;
use super::flights::{FlightOf, Flights};
use super::numbers::Numbers;
use super::numerics::{Approach, Numerics, Surface, Touching as _};
use super::passes::{Near, PassRecord};
use super::seams::{self, Chains, Features, is_moved, rolling_radius, take_over};
use super::stamped::Stamped;
use super::still::{self, Still};
use super::sweep;
use super::tiles::Tiles;
use super::view::newton_seconds;
use super::{
    ContactEngine, ContactRecord, ContactSet, Correction, Detected, Placed, Scene, Stop, TouchPoint, pair_limits,
};
use crate::collide::broad::{BroadPhase, Proxy, Statics};
use crate::collide::sweep::Sweep;
use crate::collider::{BodyOutline, Collider, ColliderSet, OutlineId};
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::slots::NONE;
use crate::solve::Impulses;

/// The contacts of a world.
#[derive(Debug)]
#[doc(hidden)]
pub struct Engine<S: Scalar, N: Numerics<S>> {
    pub(super) numerics: N,
    pub(super) flights: Flights<N::Flight, N::Pose>,
    /// The outlines as the broad phase knows them.
    pub(super) numbers: Numbers,
    chains: Chains,
    pub(super) tiles: Tiles,
    /// Each outline in world axes, by its number.
    pub(super) core_of: Stamped,
    pub(super) broad: BroadPhase,
    pub(super) still: Option<Still>,
    /// The revision of the colliders that `still` was built from.
    pub(super) statics_revision: u64,
    pub(super) following: still::Workspace,
    pub(super) movers: Vec<Proxy>,
    /// By number of the contact: its outlines, features and the number of its points.
    found: Vec<([OutlineId; 2], [u32; 2], usize)>,
    /// The impulses along the normals over the step, by the number of the contact; empty where no collider has events.
    totals: Vec<Impulses>,
    /// The contacts that may be hits, with their numbers.
    approaches: Vec<(u32, Approach<S>)>,
    /// The answers of one-way colliders in this step.
    pub(super) passes: Vec<PassRecord>,
    pub(super) near: Vec<Near<S>>,
    /// The pairs of bodies that stay excluded after this step, and the bodies of all pairs.
    pub(super) excluded: Vec<ExcludedPair>,
    pub(super) is_excluded: Stamped,
    /// Workspace: by excluded pair, true if its bodies are near each other.
    pub(super) near_excluded: Vec<bool>,
    /// Workspace: the numbers of outlines near one.
    pub(super) near_numbers: Vec<u32>,
    pub(super) sweep: sweep::Workspace,
}

/// An outline of a pair.
struct Side<'a, S: Scalar> {
    number: u32,
    outline: OutlineId,
    collider: &'a Collider<S>,
    flight: u32,
    kind: FlightOf,
}

impl<S: Scalar, N: Numerics<S>> Default for Engine<S, N> {
    fn default() -> Self {
        Self {
            numerics: N::default(),
            flights: Flights::default(),
            numbers: Numbers::default(),
            chains: Chains::default(),
            tiles: Tiles::default(),
            core_of: Stamped::default(),
            broad: BroadPhase::default(),
            still: None,
            statics_revision: 0,
            following: still::Workspace::default(),
            movers: Vec::new(),
            found: Vec::new(),
            totals: Vec::new(),
            approaches: Vec::new(),
            passes: Vec::new(),
            near: Vec::new(),
            excluded: Vec::new(),
            is_excluded: Stamped::default(),
            near_excluded: Vec::new(),
            near_numbers: Vec::new(),
            sweep: sweep::Workspace::default(),
        }
    }
}

impl<S: Scalar, N: Numerics<S>> Engine<S, N> {
    /// Lists the boxes of moving colliders over the step.
    pub(super) fn place_movers(&mut self, scene: &Scene<'_, S>) {
        self.movers.clear();
        for flight in 0..self.flights.len() as u32 {
            let body = self.flights.body(flight);
            for collider in scene.colliders.solid_of_slot(body.slot) {
                let first = self.numbers.first(collider.slot);
                for part in 0..collider.outline_count() {
                    let bounds = N::swept(&collider.outline(part), &body.pose, self.flights.flight(flight));
                    let filter = collider.def.filter;
                    self.movers.push(Proxy { collider: first + part, body: body.slot, bounds, filter, digest: 0 });
                }
            }
        }
    }

    /// The colliders that stand still, if they are of these.
    fn still_of(&self, colliders: &ColliderSet<S>) -> Option<&Still> {
        let is_current = self.statics_revision == colliders.revision() && self.numbers.is_of(colliders);
        self.still.as_ref().filter(|_| is_current)
    }

    /// An outline in world axes, placed when it is first asked for.
    #[inline(always)]
    pub(super) fn core(
        &mut self,
        scene: &Scene<'_, S>,
        (number, collider): (u32, &Collider<S>),
        outline: &BodyOutline<S>,
        flight: u32,
    ) -> usize {
        match self.core_of.get(number) {
            NONE => self.place(scene, (number, collider), outline, flight),
            core => core as usize,
        }
    }

    fn place(
        &mut self,
        scene: &Scene<'_, S>,
        (number, collider): (u32, &Collider<S>),
        outline: &BodyOutline<S>,
        flight: u32,
    ) -> usize {
        let body = self.flights.body(flight);
        let core = self.numerics.place(&outline.outline, &body.pose);
        self.core_of.set(number, core as u32);
        if let (FlightOf::Static, Some(Still { statics, .. })) = (body.kind, &self.still) {
            let (own, place) = ((number, collider), (outline, &body.pose));
            if let Some(faces) = self.tiles.find::<S, N>(scene, statics, &self.numbers, own, place) {
                self.numerics.set_faces(faces);
            }
        }
        core
    }

    /// Adds to the impulses that a contact with a segment of a chain, or with a static polygon among others, starts from those that its
    /// points had with other segments or polygons. The surface is at this side of the pair.
    #[cold]
    fn start_over_seams(
        &mut self,
        scene: &Scene<'_, S>,
        (side, numbers, pair): (usize, [u32; 2], [OutlineId; 2]),
        contacts: &ContactSet,
        features: Features,
        start: &mut Impulses,
    ) {
        let (own, other) = (pair[side], 1 - side);
        let is_tile = self.tiles.surface(numbers[side]).is_some();
        let mut terms = core::mem::take(&mut self.chains.terms);
        terms.clear();
        for i in self.chains.of(scene, contacts, if is_tile { NONE } else { own.slot }, pair[other]) {
            let record = contacts.records[self.chains.record(i)];
            // A body may be the first one of its pair with one tile, and the second one of that with the next.
            let record = if record.pair()[other] == pair[other] { record } else { record.swapped() };
            let before = record.pair();
            if before[side] == own || record.is_slack() || !is_moved(features, &record, other) {
                continue;
            }
            let mut near = numbers;
            near[side] = self.numbers.first(before[side].slot) + before[side].part;
            let found = self.manifold_of(scene, near, before);
            if is_tile && !self.tiles.are_joined([numbers[side], near[side]], side, features, &record) {
                continue;
            }
            take_over(&mut terms, features, &record, found.map(|manifold| manifold.features()), other);
        }
        seams::add(start, &terms);
        self.chains.terms = terms;
    }

    /// The manifold of two outlines.
    pub(super) fn manifold_of(
        &mut self,
        scene: &Scene<'_, S>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
    ) -> Option<N::Manifold> {
        let [a, b] = pair.map(|outline| scene.colliders.at(outline.slot));
        let colliders = [a?, b?];
        let ends = colliders.map(|collider| self.flights.of::<S, N>(scene, collider.body.slot));
        self.manifold(scene, numbers, pair.map(|outline| outline.part), colliders, ends)
    }

    /// The manifold of two outlines of these colliders, with these flights.
    #[inline(always)]
    fn manifold(
        &mut self,
        scene: &Scene<'_, S>,
        numbers: [u32; 2],
        parts: [u32; 2],
        colliders: [&Collider<S>; 2],
        ends: [u32; 2],
    ) -> Option<N::Manifold> {
        let (a, b) = (colliders[0].outline(parts[0]), colliders[1].outline(parts[1]));
        let cores = [
            self.core(scene, (numbers[0], colliders[0]), &a, ends[0]),
            self.core(scene, (numbers[1], colliders[1]), &b, ends[1]),
        ];
        let flights = ends.map(|flight| self.flights.flight(flight));
        self.numerics.collide(cores, flights, [a.radius, b.radius])
    }

    /// An outline by its number.
    #[inline(always)]
    fn side<'a>(&mut self, scene: &Scene<'a, S>, number: u32) -> Option<Side<'a, S>> {
        let outline = self.numbers.outline(number);
        let collider = scene.colliders.at(outline.slot)?;
        let flight = self.flights.of::<S, N>(scene, collider.body.slot);
        Some(Side { number, outline, collider, flight, kind: self.flights.body(flight).kind })
    }

    /// The manifold of a pair that is apart at the start, at the moment at which its free flights meet; `None` if they do not.
    fn confirmed(
        &mut self,
        scene: &Scene<'_, S>,
        numbers: [u32; 2],
        parts: [u32; 2],
        (colliders, ends, kinds): ([&Collider<S>; 2], [u32; 2], [FlightOf; 2]),
        manifold: N::Manifold,
        has_impulses: bool,
    ) -> Option<N::Manifold> {
        let outlines = [0, 1].map(|side| colliders[side].outline(parts[side]));
        let radii = [outlines[0].radius, outlines[1].radius];
        let flights = ends.map(|flight| self.flights.flight(flight));
        let is_asleep = kinds.contains(&FlightOf::Asleep);
        if N::least_separation(&manifold) <= S::ZERO || has_impulses || !(is_asleep || N::are_fast(flights, radii)) {
            return Some(manifold);
        }
        let paths = sweep::Paths { scene, corrections: &[] };
        let path = |side: usize| {
            let place = self.flights.body(ends[side]);
            paths.path::<N>(place, self.flights.flight(ends[side]), ends[side])
        };
        let both = [path(0), path(1)];
        let forms = [0, 1].map(|side| sweep::form::<S, N>(colliders[side], parts[side]));
        let swept = Sweep { forms: [&forms[0], &forms[1]], paths: [&both[0], &both[1]], is_mutual: true };
        let at = swept.first_touch()?;
        let cores = [0, 1].map(|side| {
            let (number, collider) = (numbers[side], colliders[side]);
            if !both[side].moves() {
                return self.core(scene, (number, collider), &outlines[side], ends[side]);
            }
            let (centre, angle) = both[side].leg(at).0.pose(at);
            let [x, y] = centre.map(N::from_ulps);
            self.numerics.place(&outlines[side].outline, &N::pose(Vec2::new(x, y), N::from_turn(angle)))
        });
        let flights = ends.map(|flight| self.flights.flight(flight));
        let manifold = self.numerics.collide(cores, flights, radii)?;
        Some(N::at_start(manifold, flights, at))
    }

    /// Finds the manifold of a pair, if it has one.
    fn collide(
        &mut self,
        scene: &Scene<'_, S>,
        [first, second]: [&Side<'_, S>; 2],
        contacts: &ContactSet,
        next: &mut usize,
        out: &mut Detected,
    ) {
        let (numbers, pair) = ([first.number, second.number], [first.outline, second.outline]);
        let [a, b] = [first.collider, second.collider];
        let (ends, kinds) = ([first.flight, second.flight], [first.kind, second.kind]);
        if !kinds.contains(&FlightOf::Dynamic) && !kinds.contains(&FlightOf::Asleep) {
            return;
        }
        // The records are sorted by pair, as the pairs are.
        let is_simple = self.numbers.is_simple();
        let is_before =
            |record: &ContactRecord| if is_simple { record.slots() < numbers } else { record.pair() < pair };
        while contacts.records.get(*next).is_some_and(is_before) {
            *next += 1;
        }
        let is_own =
            |record: &&ContactRecord| if is_simple { record.slots() == numbers } else { record.pair() == pair };
        let record = contacts.records.get(*next).filter(is_own);
        let moves = |kind: FlightOf| matches!(kind, FlightOf::Dynamic | FlightOf::Kinematic);
        let is_asleep = !kinds.into_iter().any(moves);
        if is_asleep && (kinds == [FlightOf::Asleep; 2] || !scene.may_have_moved_statics) {
            return;
        }
        let parts = pair.map(|outline| outline.part);
        let Some(manifold) = self.manifold(scene, numbers, parts, [a, b], ends) else { return };
        let has_impulses = record.is_some_and(|record| !record.is_slack());
        let confirmed = self.confirmed(scene, numbers, parts, ([a, b], ends, kinds), manifold, has_impulses);
        let Some(manifold) = confirmed else { return };
        if kinds.contains(&FlightOf::Asleep) {
            // A dynamic body that overlaps a static one this much is pushed, and wakes: a call has placed one of the two. A body that fell
            // asleep in this contact sleeps on.
            // One that nothing moves would fall asleep again, for ever.
            let is_pushed = |collider: &Collider<S>| {
                scene.settings.push_speed > S::ZERO
                    && scene.bodies.find(collider.body).is_ok_and(|dense| scene.bodies.mass(dense).can_move())
            };
            if !is_asleep || manifold.is_pressed() && !contacts.are_asleep_on_each_other(pair) {
                let asleep = [a, b].into_iter().zip(kinds).filter(|(_, kind)| *kind == FlightOf::Asleep);
                let woken = asleep.map(|(collider, _)| collider).filter(|collider| !is_asleep || is_pushed(collider));
                out.touched.extend(woken.map(|collider| collider.body));
            }
            return;
        }
        let (features, count) = manifold.features();
        let mut start = record.map_or_else(Default::default, |record| record.start(features, count));
        let is_seamed = |side: usize| [a, b][side].def.shape.is_chain() || self.tiles.surface(numbers[side]).is_some();
        if let Some(side) = (0..2).find(|&side| is_seamed(side)) {
            self.start_over_seams(scene, (side, numbers, pair), contacts, (features, count), &mut start);
        }
        ends.into_iter().for_each(|flight| self.flights.complete::<S, N>(scene, flight));
        let ends = self.flights.by_dominance::<S, N>(ends);
        let materials = [&a.def.material, &b.def.material];
        let own = || scene.colliders.material_pair(materials.map(|material| material.id)).copied();
        let given = if scene.colliders.material_pairs().is_empty() { None } else { own() };
        let coefficients = given.unwrap_or_else(|| N::mixed(materials));
        let radius = if count == 1 && coefficients.rolling_resistance > S::ZERO {
            rolling_radius(features[0], [0, 1].map(|side| [a, b][side].outline(parts[side]).outline.radius()))
        } else {
            S::ZERO
        };
        let speed = materials[0].surface_speed_against(materials[1]);
        self.numerics.push(ends, &manifold, &Surface { coefficients, radius, speed }, start);
        if a.def.hit_events || b.def.hit_events {
            let flights = ends.map(|flight| self.flights.flight(flight));
            let mut approach = N::approach(&manifold, flights, scene.time_step);
            approach.leave_out_pressed(&start);
            self.approaches.push((self.found.len() as u32, approach));
        }
        self.found.push((pair, features, count));
    }
}

impl<S: Scalar, N: Numerics<S>> ContactEngine<S> for Engine<S, N> {
    fn detect(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, out: &mut Detected) {
        self.numerics.clear();
        self.found.clear();
        self.totals.clear();
        self.approaches.clear();
        self.core_of.clear();
        let are_renumbered = self.numbers.update(scene.colliders);
        self.chains.clear();
        self.flights.begin::<S, N>(scene);
        self.update_still(scene, are_renumbered, &mut out.disturbed);
        self.place_movers(scene);
        let limits = pair_limits(scene.settings, scene.colliders);
        self.pair_moving(&limits);
        let crowded = self.broad.above_cap().iter().map(|&number| self.numbers.outline(number));
        let crowded = crowded.filter_map(|outline| scene.colliders.at(outline.slot));
        for collider in crowded {
            match scene.bodies.find(collider.body) {
                Ok(dense) if dense < scene.bodies.moving() => out.crowded.push(dense),
                // A sleeping body is at fault as if it were awake: sleep must not decide who is quarantined.
                Ok(_) => out.touched.push(collider.body),
                Err(_) => {}
            }
        }
        if !out.crowded.is_empty() || !out.touched.is_empty() {
            return;
        }
        let mut pairs = self.broad.take_pairs();
        self.pair_still(scene, (contacts, &out.disturbed), &mut pairs);
        self.leave_out_excluded(scene, contacts, &mut pairs);
        self.leave_out_passing(scene, (contacts, &out.disturbed), &mut pairs);
        let (mut next, mut first): (_, Option<Side<'_, S>>) = (0, None);
        for &[a, b] in &pairs {
            // Pairs are sorted: most have the first outline of the one before.
            if first.as_ref().is_none_or(|side| side.number != a) {
                first = self.side(scene, a);
            }
            if let (Some(of_a), Some(of_b)) = (&first, &self.side(scene, b)) {
                self.collide(scene, [of_a, of_b], contacts, &mut next, out);
            }
        }
        self.broad.return_pairs(pairs);
    }

    fn spread(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, out: &mut Detected) {
        self.touch_sleepers(scene, contacts, out);
    }

    fn list(&self, colliders: &ColliderSet<S>, contacts: &mut ContactSet) {
        contacts.records.clear();
        let found = self.numerics.contacts().zip(&self.found);
        let record = |((_, impulses), (pair, features, count)): ((_, Impulses), &(_, _, _))| {
            ContactRecord::new(*pair, *features, *count, impulses)
        };
        if self.totals.is_empty() || !colliders.any_contact_events() {
            contacts.records.extend(found.filter(|((_, impulses), _)| impulses.values != [0; 3]).map(record));
        } else {
            let touched =
                |&(((_, impulses), (pair, ..)), total): &(((_, Impulses), &([OutlineId; 2], _, _)), &Impulses)| {
                    let own = pair.map(|outline| colliders.at(outline.slot));
                    let is_reported = matches!(own, [Some(a), Some(b)] if has_events([a, b]));
                    impulses.values != [0; 3] || is_reported && total.values != [0; 3]
                };
            contacts.records.extend(found.zip(&self.totals).filter(touched).map(|(found, _)| record(found)));
        }
        contacts.passes.clone_from(&self.passes);
        contacts.excluded.clone_from(&self.excluded);
    }

    fn hits(&self, scene: &Scene<'_, S>, hits: &mut Vec<ContactHit<S>>) {
        for (number, approach) in &self.approaches {
            let number = *number as usize;
            let (Some((outlines, ..)), Some(total)) = (self.found.get(number), self.totals.get(number)) else {
                continue;
            };
            let slots = outlines.map(|outline| outline.slot);
            let Some(pair) = ColliderPair::of_contact(scene.bodies, scene.colliders, slots) else { continue };
            let is_swapped = pair.colliders[0].slot != slots[0];
            let Some((approach_speed, point)) = approach.fastest::<N>(total, usize::from(is_swapped)) else { continue };
            if approach_speed < scene.settings.hit_speed {
                continue;
            }
            let (mut parts, mut normal) = (outlines.map(|outline| outline.part), approach.normal);
            if is_swapped {
                parts.reverse();
                normal = normal.map(|part| -part);
            }
            hits.push(ContactHit {
                pair,
                parts,
                approach_speed,
                normal,
                point,
                normal_impulse: newton_seconds(total.values[0].saturating_add(total.values[1]), total.exponent),
            });
        }
        hits.sort_unstable_by_key(|hit| (hit.pair.rank(), hit.parts));
    }

    fn touching(&self, colliders: &ColliderSet<S>, mut found: impl FnMut([u32; 2], bool)) {
        for (pair, ..) in &self.found {
            if let [Some(a), Some(b)] = pair.map(|outline| colliders.at(outline.slot)) {
                let is_driven = a.def.material.surface_speed_against(&b.def.material) != S::ZERO;
                found([a.body.slot, b.body.slot], is_driven);
            }
        }
    }

    fn solve(&mut self, scene: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>) {
        corrections.clear();
        if self.found.is_empty() {
            return;
        }
        self.numerics.solve(scene, self.flights.all(), corrections);
        if scene.colliders.any_contact_events() || !self.approaches.is_empty() {
            self.totals.resize(self.found.len(), Impulses::default());
            for (number, total) in self.numerics.totals() {
                self.totals[number] = total;
            }
        }
        // Moving bodies have the first flights.
        for (bodies, _) in self.numerics.contacts().filter(|(_, impulses)| impulses.values != [0; 3]) {
            for body in bodies {
                // A body that pushes others is not at rest, even if they do not move it.
                if let Some(correction) = corrections.get_mut(self.flights.leader(body) as usize) {
                    correction.is_pushed = true;
                }
            }
        }
        if !corrections.iter().any(|correction| correction.is_pushed) {
            corrections.clear();
        }
    }

    fn sweep(
        &mut self,
        scene: &Scene<'_, S>,
        corrections: &[Correction<S>],
        is_faulty: &dyn Fn(usize) -> bool,
        stops: &mut Vec<Stop<S>>,
    ) {
        self.sweep_paths(scene, corrections, is_faulty, stops);
    }

    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)> {
        N::touch(a, b)
    }

    fn statics(&self, colliders: &ColliderSet<S>) -> Option<&Arc<Statics>> {
        self.still_of(colliders).map(|still| &still.statics)
    }

    fn sleepers(&self, colliders: &ColliderSet<S>) -> Option<&Statics> {
        self.still_of(colliders).map(|still| &still.sleepers)
    }

    fn outline(&self, number: u32) -> OutlineId {
        self.numbers.outline(number)
    }

    fn number(&self, slot: u32) -> u32 {
        self.numbers.first(slot)
    }

    #[cfg(feature = "selftest")]
    fn set_discrete(&mut self, is_discrete: bool) {
        self.numerics.set_discrete(is_discrete);
    }

    fn clone_cached_from(&mut self, source: &Self) {
        let is_same =
            |own: &Still| source.still.as_ref().is_some_and(|other| Arc::ptr_eq(&own.statics, &other.statics));
        if !self.still.as_ref().is_some_and(is_same) {
            self.tiles.clear();
        }
        match (&mut self.still, &source.still) {
            (own, None) => *own = None,
            (own, Some(source)) => own.get_or_insert_default().copy_from(source),
        }
        self.statics_revision = source.statics_revision;
        // The trees know colliders by these.
        self.numbers.copy_from(&source.numbers);
    }
}
