//! The rules by which outlines whose boxes overlap do not touch: excluded and joined pairs of bodies, and one-way colliders.
//!
//! Reads: pairs, the answers and the excluded pairs of the step before. Writes: the pairs that may touch, the answers of this step.

use alloc::vec::Vec;

use super::excluded::Exclusions;
use super::flights::Flights;
use super::narrow::Narrow;
use super::one_way::OneWay;
use super::resting::{ChangedResting, Resting};
use super::{ContactSet, Scene};

/// The answers of the rules in a step.
#[derive(Debug, Default)]
pub(super) struct Rules {
    exclusions: Exclusions,
    pub(super) one_way: OneWay,
}

impl Rules {
    /// Leaves out the pairs that do not touch: of excluded bodies, of bodies that joints keep apart, and of bodies that pass. Finds which pairs of bodies
    /// stay excluded and which bodies pass one-way colliders.
    pub(super) fn filter(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        narrow: &mut Narrow,
        changed_resting: &ChangedResting,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        leave_out_joined(scene, resting, pairs);
        self.exclusions.leave_out_excluded(scene, flights, resting, narrow, pairs);
        self.one_way.leave_out_passing(scene, flights, resting, narrow, changed_resting, pairs);
    }

    /// Returns true if two outlines may touch: neither their filters, nor an excluded pair, nor a one-way collider lets them pass each
    /// other. A one-way collider without an answer in this step had no manifold with the body, and lets it pass.
    pub(super) fn may_touch(&self, scene: &Scene<'_>, resting: &Resting, pair: [u32; 2]) -> bool {
        let outlines = pair.map(|number| resting.numbers.outline(number));
        let [Some(a), Some(b)] = outlines.map(|outline| scene.colliders.at(outline.slot)) else { return false };
        a.body != b.body
            && a.def.filter.agrees(b.def.filter)
            && !self.exclusions.has(scene, [a.body, b.body])
            && (a.side.is_none() || self.one_way.holds(outlines[0], b.body.slot))
            && (b.side.is_none() || self.one_way.holds(outlines[1], a.body.slot))
    }

    /// Writes the answers to the state.
    pub(super) fn list(&self, contacts: &mut ContactSet) {
        contacts.passes.clone_from(&self.one_way.answers);
        contacts.excluded.clone_from(&self.exclusions.pairs);
    }
}

/// Leaves out the pairs of bodies that joints keep apart.
fn leave_out_joined(scene: &Scene<'_>, resting: &Resting, pairs: &mut Vec<[u32; 2]>) {
    if !scene.joints.keeps_any_apart() {
        return;
    }
    let body =
        |number: u32| scene.colliders.at(resting.numbers.outline(number).slot).map(|collider| collider.body.slot);
    pairs.retain(|pair| match pair.map(body) {
        [Some(a), Some(b)] => !scene.joints.keeps_apart([a, b]),
        _ => true,
    });
}
