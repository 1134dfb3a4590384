//! Pairs of outlines whose boxes overlap over a step.
//!
//! Reads: the flights of moving bodies, the trees of colliders at rest. Writes: pairs of outline numbers, sorted, the lower number of each
//! first.

use alloc::vec::Vec;

use super::flights::Flights;
use super::movers::MovingOutline;
use super::narrow::Narrow;
use super::resting::{Resting, Trees};
use super::{Scene, pair_limits, sorted};
use crate::body::Activity;
use crate::collide::broad::{BroadPhase, PairLimits, Proxy, RestingTrees};
use crate::collider::Filter;
use crate::shape::Aabb;
use crate::slots::BodyId;

/// The pairs of moving outlines, and the broad phase that finds them.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    broad: BroadPhase,
    /// The boxes of moving outlines over the step.
    movers: Vec<Proxy>,
}

/// Returns true for a body that is asleep.
fn sleeps(scene: &Scene<'_>, body: BodyId) -> bool {
    scene.bodies.index_of(body).is_some_and(|dense| scene.bodies.activity(dense) == Activity::Asleep)
}

impl Pairs {
    /// Finds the pairs of moving colliders, which are the pairs of the step. If there are too many pairs or overlaps, sleeping ones included,
    /// sleeping colliders are treated as moving ones: sleep must not decide which bodies have too many.
    pub(super) fn find(&mut self, scene: &Scene<'_>, flights: &Flights, resting: &Resting, narrow: &mut Narrow) {
        self.place_movers(scene, flights, narrow);
        let Some(trees) = &resting.trees else { return };
        let limits = pair_limits(scene.settings, scene.colliders);
        let overlaps = limits.overlaps.saturating_sub(trees.counts.overlaps);
        self.broad.update(&trees.for_search(), &self.movers, &PairLimits { overlaps, ..limits });
        let are_above = self.broad.pairs().len().saturating_add(trees.counts.pairs) > limits.pairs;
        if !trees.sleepers.is_empty() && (are_above || !self.broad.above_cap().is_empty()) {
            self.movers.extend(trees.sleepers.iter());
            // No real version has this number, so that the broad phase drops its cache of sleepers.
            let resting_trees = RestingTrees { version: u64::MAX, ..RestingTrees::of(&trees.statics) };
            self.broad.update(&resting_trees, &self.movers, &limits);
        }
    }

    /// Makes the outlines of moving colliders actors, and lists their boxes over the step.
    fn place_movers(&mut self, scene: &Scene<'_>, flights: &Flights, narrow: &mut Narrow) {
        self.movers.clear();
        narrow.actors.begin(scene, &flights.outlines);
        for (actor, outline) in flights.outlines.all().iter().enumerate() {
            let &MovingOutline { number, filter, body, .. } = outline;
            let bounds = narrow.place_mover(scene, flights, actor, outline);
            self.movers.push(Proxy { collider: number, body, bounds, filter, digest: 0 });
        }
    }

    /// Visits the moving outlines near a box over their free flights, with the slots of their bodies, until `visit` returns false.
    pub(super) fn search_movers(&self, bounds: Aabb, filter: Filter, visit: impl FnMut(u32, u32) -> bool) {
        self.broad.search_movers(bounds, filter, visit);
    }

    /// The outlines of colliders with too many pairs, by number, sorted.
    pub(super) fn crowded(&self) -> &[u32] {
        self.broad.above_cap()
    }

    /// The pairs, to be gone through while something else changes; [`put_back`](Self::put_back) gives the list back.
    pub(super) fn take(&mut self) -> Vec<[u32; 2]> {
        self.broad.take_pairs()
    }

    pub(super) fn put_back(&mut self, pairs: Vec<[u32; 2]>) {
        self.broad.return_pairs(pairs);
    }

    /// The pairs of moving and sleeping outlines, without pairs of excluded bodies; [`put_back`](Self::put_back) gives the list back.
    pub(super) fn take_with_sleepers(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        narrow: &mut Narrow,
    ) -> Vec<[u32; 2]> {
        self.place_movers(scene, flights, narrow);
        let mut pairs = self.broad.take_pairs();
        pairs.clear();
        let Some(Trees { sleepers, .. }) = &resting.trees else { return pairs };
        let body = |number: u32| scene.colliders.at(resting.numbers.outline(number).slot).map(|collider| collider.body);
        for mover in &self.movers {
            sleepers.meeting(mover, |sleeper| {
                // The tree still has the colliders of bodies that woke since it was made.
                let sleeping_body = body(sleeper.collider).filter(|&body| sleeps(scene, body));
                let bodies = body(mover.collider).zip(sleeping_body);
                let may_touch =
                    |pair: [u32; 2]| scene.contacts.find_excluded(pair).is_err() && !scene.joints.keeps_apart(pair);
                if bodies.is_some_and(|(a, b)| may_touch(sorted(a, b))) {
                    pairs.push([mover.collider.min(sleeper.collider), mover.collider.max(sleeper.collider)]);
                }
                true
            });
        }
        pairs.sort_unstable();
        pairs
    }

    /// Adds the sleeping bodies of a pair of outlines to a list.
    pub(super) fn add_sleepers(scene: &Scene<'_>, bodies: [BodyId; 2], list: &mut Vec<BodyId>) {
        list.extend(bodies.into_iter().filter(|&body| sleeps(scene, body)));
    }
}
