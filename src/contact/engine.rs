//! Contacts of a world, whatever the scalar: pairs of colliders, their manifolds, and records.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::flights::{FlightOf, Flights};
use super::numbers::Numbers;
use super::numerics::{Numerics, Touching as _};
use super::seams::{Chains, Features, is_moved, take_over};
use super::stamped::Stamped;
use super::{ContactEngine, ContactRecord, ContactSet, Correction, Detected, Placed, Scene, TouchPoint};
use crate::body::{Activity, BodyKind};
use crate::collide::broad::{BroadPhase, PairLimits, Proxy, Statics};
use crate::collider::{BodyOutline, Collider, OutlineId};
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::slots::NONE;
use crate::solve::Impulses;

/// The contacts of a world.
#[derive(Debug)]
#[doc(hidden)]
pub struct Engine<S: Scalar, N: Numerics<S>> {
    numerics: N,
    flights: Flights<N::Flight, N::Pose>,
    /// The outlines as the broad phase knows them.
    numbers: Numbers,
    chains: Chains,
    /// Each outline in world axes, by its number.
    core_of: Stamped,
    broad: BroadPhase,
    statics: Option<Arc<Statics>>,
    /// The colliders in `statics` and the poses of their bodies.
    static_places: Vec<(u32, N::Pose)>,
    /// The revision of the colliders that `statics` was built from.
    statics_revision: u64,
    movers: Vec<Proxy>,
    /// By number of the contact: its outlines, features and the number of its points.
    found: Vec<([OutlineId; 2], [u32; 2], usize)>,
}

impl<S: Scalar, N: Numerics<S>> Default for Engine<S, N> {
    fn default() -> Self {
        Self {
            numerics: N::default(),
            flights: Flights::default(),
            numbers: Numbers::default(),
            chains: Chains::default(),
            core_of: Stamped::default(),
            broad: BroadPhase::default(),
            statics: None,
            static_places: Vec::new(),
            statics_revision: 0,
            movers: Vec::new(),
            found: Vec::new(),
        }
    }
}

impl<S: Scalar, N: Numerics<S>> Engine<S, N> {
    /// Builds the tree of the colliders that stand still, unless it is there.
    fn update_statics(&mut self, scene: &Scene<'_, S>) -> Arc<Statics> {
        let is_current = self.statics_revision == scene.colliders.revision();
        if let (true, false, Some(statics)) = (is_current, scene.may_have_moved_statics, &self.statics) {
            return Arc::clone(statics);
        }
        let bodies = scene.bodies;
        let motion = &bodies.columns.motion;
        let places = scene.colliders.list().iter().filter_map(|collider| {
            let dense = bodies.find(collider.body).ok()?;
            let is_static = bodies.info(dense).kind == BodyKind::Static;
            let takes_part = bodies.activity(dense) == Activity::Awake;
            let pose = || N::pose(motion.position.get(dense), motion.angle[dense]);
            (is_static && takes_part).then(|| (collider, pose()))
        });
        let is_same = |(collider, pose): &(&Collider<S>, N::Pose), (slot, there): &(u32, N::Pose)| {
            collider.slot == *slot && pose == there
        };
        if let (true, Some(statics)) = (is_current, &self.statics) {
            let mut own = self.static_places.iter();
            let mut places = places.clone();
            if places.all(|place| own.next().is_some_and(|own| is_same(&place, own))) && own.next().is_none() {
                return Arc::clone(statics);
            }
        }
        self.static_places = places.clone().map(|(collider, pose)| (collider.slot, pose)).collect();
        let numbers = &self.numbers;
        let proxies = places.flat_map(|(collider, pose)| {
            let first = numbers.first(collider.slot);
            (0..collider.outline_count()).map(move |part| Proxy {
                collider: first + part,
                body: collider.body.slot,
                bounds: N::resting(&collider.outline(part), &pose),
                filter: collider.def.filter,
            })
        });
        let statics = Arc::new(Statics::new(proxies.collect()));
        self.statics = Some(Arc::clone(&statics));
        self.statics_revision = scene.colliders.revision();
        statics
    }

    /// Lists the boxes of moving and of sleeping colliders over the step.
    fn place_movers(&mut self, scene: &Scene<'_, S>) {
        self.movers.clear();
        for flight in 0..self.flights.len() as u32 {
            let body = self.flights.body(flight);
            for collider in scene.colliders.of_slot(body.slot) {
                let first = self.numbers.first(collider.slot);
                for part in 0..collider.outline_count() {
                    let bounds = N::swept(&collider.outline(part), &body.pose, self.flights.flight(flight));
                    let filter = collider.def.filter;
                    self.movers.push(Proxy { collider: first + part, body: body.slot, bounds, filter });
                }
            }
        }
    }

    /// An outline in world axes, placed when it is first asked for.
    #[inline]
    fn core(&mut self, number: u32, outline: &BodyOutline<S>, flight: u32) -> usize {
        match self.core_of.get(number) {
            NONE => {
                let core = self.numerics.place(&outline.outline, &self.flights.body(flight).pose);
                self.core_of.set(number, core as u32);
                core
            }
            core => core as usize,
        }
    }

    /// Adds to the impulses that a contact with a segment of a chain starts from those that its points had with other segments. The chain
    /// is at this side of the pair.
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
        for i in self.chains.of(scene.colliders, contacts, own.slot, pair[other]) {
            let record = &contacts.records[self.chains.record(i)];
            let before = record.pair();
            if before[side] == own || !is_moved(features, record, other) {
                continue;
            }
            let mut near = numbers;
            near[side] = self.numbers.first(own.slot) + before[side].part;
            let found = self.manifold(scene, near, before).map(|manifold| manifold.features());
            take_over(start, features, record, found, other);
        }
    }

    /// The manifold of two outlines.
    fn manifold(&mut self, scene: &Scene<'_, S>, numbers: [u32; 2], pair: [OutlineId; 2]) -> Option<N::Manifold> {
        let [a, b] = pair.map(|outline| scene.colliders.at(outline.slot));
        let colliders = [a?, b?];
        let ends = colliders.map(|collider| self.flights.of::<S, N>(scene, collider.body.slot));
        let outlines = [0, 1].map(|side| colliders[side].outline(pair[side].part));
        let cores = [0, 1].map(|side| self.core(numbers[side], &outlines[side], ends[side]));
        let flights = ends.map(|flight| self.flights.flight(flight));
        self.numerics.collide(cores, flights, [outlines[0].radius, outlines[1].radius])
    }

    /// Finds the manifold of a pair, if it has one.
    fn collide(
        &mut self,
        scene: &Scene<'_, S>,
        numbers: [u32; 2],
        contacts: &ContactSet,
        next: &mut usize,
        out: &mut Detected,
    ) {
        let pair = numbers.map(|number| self.numbers.outline(number));
        let [Some(a), Some(b)] = pair.map(|outline| scene.colliders.at(outline.slot)) else { return };
        let ends = [a, b].map(|collider| self.flights.of::<S, N>(scene, collider.body.slot));
        let kinds = ends.map(|flight| self.flights.body(flight).kind);
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
        let outlines = [a.outline(pair[0].part), b.outline(pair[1].part)];
        let cores = [self.core(numbers[0], &outlines[0], ends[0]), self.core(numbers[1], &outlines[1], ends[1])];
        let flights = ends.map(|flight| self.flights.flight(flight));
        let radii = [outlines[0].radius, outlines[1].radius];
        let Some(manifold) = self.numerics.collide(cores, flights, radii) else { return };
        if kinds.contains(&FlightOf::Asleep) {
            // A body that overlaps a static one so far is pushed, and does not fall asleep: a call has placed one of the two.
            if !is_asleep || manifold.is_pressed() {
                let asleep = [a, b].into_iter().zip(kinds).filter(|(_, kind)| *kind == FlightOf::Asleep);
                out.touched.extend(asleep.map(|(collider, _)| collider.body));
            }
            return;
        }
        let (features, count) = manifold.features();
        let mut start = record.map_or_else(Default::default, |record| record.start(features, count));
        if let Some(side) = [a, b].iter().position(|collider| collider.def.shape.is_chain()) {
            self.start_over_seams(scene, (side, numbers, pair), contacts, (features, count), &mut start);
        }
        ends.into_iter().for_each(|flight| self.flights.complete::<S, N>(scene, flight));
        self.numerics.push(ends, &manifold, [&a.def.material, &b.def.material], start);
        self.found.push((pair, features, count));
    }
}

impl<S: Scalar, N: Numerics<S>> ContactEngine<S> for Engine<S, N> {
    fn detect(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, out: &mut Detected) {
        self.numerics.clear();
        self.found.clear();
        self.core_of.clear();
        self.numbers.update(scene.colliders);
        self.chains.clear();
        self.flights.begin::<S, N>(scene);
        let statics = self.update_statics(scene);
        self.place_movers(scene);
        let limits = PairLimits {
            pairs: scene.settings.max_pairs as usize,
            per_collider: scene.settings.max_pairs_per_collider as usize,
        };
        self.broad.update(&statics, &self.movers, &limits);
        let crowded = self.broad.above_cap().iter().map(|&number| self.numbers.outline(number));
        let crowded = crowded.filter_map(|outline| scene.colliders.at(outline.slot));
        for collider in crowded {
            match scene.bodies.find(collider.body) {
                Ok(dense) if dense < scene.bodies.moving() => out.crowded.push(dense),
                // One that sleeps is at fault as if it were awake.
                Ok(_) => out.touched.push(collider.body),
                Err(_) => {}
            }
        }
        if !out.crowded.is_empty() || !out.touched.is_empty() {
            return;
        }
        let pairs = self.broad.take_pairs();
        let mut next = 0;
        for &pair in &pairs {
            self.collide(scene, pair, contacts, &mut next, out);
        }
        self.broad.return_pairs(pairs);
    }

    fn list(&self, records: &mut Vec<ContactRecord>) {
        let found = self.numerics.contacts().zip(&self.found);
        let pressed = found.filter(|((_, impulses), _)| impulses.values != [0; 3]);
        records.extend(
            pressed
                .map(|((_, impulses), &(pair, features, count))| ContactRecord::new(pair, features, count, impulses)),
        );
    }

    fn solve(&mut self, scene: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>) {
        corrections.clear();
        if self.found.is_empty() {
            return;
        }
        self.numerics.solve(scene, self.flights.all(), corrections);
        // Moving bodies have the first flights.
        for (bodies, _) in self.numerics.contacts().filter(|(_, impulses)| impulses.values != [0; 3]) {
            for body in bodies {
                if let Some(correction) = corrections.get_mut(body as usize) {
                    correction.is_pushed = true;
                }
            }
        }
        if !corrections.iter().any(|correction| correction.is_pushed) {
            corrections.clear();
        }
    }

    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)> {
        N::touch(a, b)
    }

    fn clone_cached_from(&mut self, source: &Self) {
        self.statics.clone_from(&source.statics);
        self.static_places.clone_from(&source.static_places);
        self.statics_revision = source.statics_revision;
    }
}
