//! The contacts that were found: solving them, and the records and hits that follow.

use alloc::vec::Vec;

use super::engine::Engine;
use super::events::{ColliderPair, ContactHit, has_events};
use super::split::Solvers;
use super::view::newton_seconds;
use super::{ContactRecord, ContactSet, Correction, Scene};
use crate::collider::{ColliderSet, OutlineId};
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::solve::{Contact, ContactSolver, Impulses};

/// A contact that was found: its outlines, and the names and the number of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundContact {
    pub(super) pair: [OutlineId; 2],
    pub(super) features: [u32; 2],
    pub(super) count: usize,
}

impl FoundContact {
    fn record(&self, impulses: Impulses) -> ContactRecord {
        ContactRecord::new(self.pair, self.features, self.count, impulses)
    }
}

impl Engine {
    /// Lists the contacts with impulses: before [`solve`](Self::solve) with those that they start from, and after it with those that
    /// touched and have events. Lists also the answers of one-way colliders and the pairs of bodies that stay excluded.
    pub(crate) fn list(&self, colliders: &ColliderSet, contacts: &mut ContactSet) {
        contacts.records.clear();
        let all = self.found.iter().zip(&self.contacts);
        if self.totals.is_empty() || !colliders.any_contact_events() {
            let pressed = all.filter(|(_, contact)| contact.impulses.values != [0; 3]);
            contacts.records.extend(pressed.map(|(found, contact)| found.record(contact.impulses)));
        } else {
            let has_touched = |found: &FoundContact, contact: &Contact, total: &Impulses| {
                let pair = found.pair.map(|outline| colliders.at(outline.slot));
                let is_reported = matches!(pair, [Some(a), Some(b)] if has_events([a, b]));
                contact.impulses.values != [0; 3] || is_reported && total.values != [0; 3]
            };
            let touched = all.zip(&self.totals).filter(|((found, contact), total)| has_touched(found, contact, total));
            contacts.records.extend(touched.map(|((found, contact), _)| found.record(contact.impulses)));
        }
        contacts.passes.clone_from(&self.passes);
        contacts.excluded.clone_from(&self.excluded);
    }

    /// Lists the hits of contacts that were solved.
    pub(crate) fn hits<S: Scalar>(&self, scene: &Scene<'_>, hits: &mut Vec<ContactHit<S>>) {
        for (number, approach) in &self.approaches {
            let number = *number as usize;
            let (Some(found), Some(total)) = (self.found.get(number), self.totals.get(number)) else { continue };
            let outlines = found.pair;
            let slots = outlines.map(|outline| outline.slot);
            let Some(pair) = ColliderPair::of_contact(scene.bodies, scene.colliders, slots) else { continue };
            let is_swapped = pair.colliders[0].slot != slots[0];
            let Some((approach_speed, point)) = approach.fastest(total, usize::from(is_swapped)) else { continue };
            if approach_speed < scene.settings.hit_speed {
                continue;
            }
            let (mut parts, mut normal) = (outlines.map(|outline| outline.part), approach.normal);
            if is_swapped {
                parts.reverse();
                normal = normal.map(|part| -part);
            }
            let impulse = newton_seconds(total.values[0].saturating_add(total.values[1]), total.exponent);
            hits.push(ContactHit {
                pair,
                parts,
                approach_speed: S::from_fx(approach_speed),
                normal: normal.map(S::from_fx),
                point: point.map(S::from_fx),
                normal_impulse: S::from_fx(impulse),
            });
        }
        hits.sort_unstable_by_key(|hit| (hit.pair.rank(), hit.parts));
    }

    /// Calls `found` with the slots of the two bodies of each contact that was found, and true if a surface of one of them moves.
    pub(crate) fn touching(&self, colliders: &ColliderSet, mut found: impl FnMut([u32; 2], bool)) {
        for FoundContact { pair, .. } in &self.found {
            if let [Some(a), Some(b)] = pair.map(|outline| colliders.at(outline.slot)) {
                let is_driven = a.def.material.surface_speed_against(&b.def.material) != Fx::ZERO;
                found([a.body.slot, b.body.slot], is_driven);
            }
        }
    }

    /// Solves the contacts that were found, and writes the change of each body of `scene.starts` to `corrections`; none if there was no
    /// impulse.
    pub(crate) fn solve<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        corrections: &mut Vec<Correction>,
    ) {
        corrections.clear();
        if self.found.is_empty() {
            return;
        }
        let options = scene.settings.into();
        let changes = solvers.solve(scene.time_step, &options, self.flights.all(), &mut self.contacts);
        // Moving bodies have the first flights.
        corrections.extend(changes.iter().take(scene.starts.len()).map(Correction::from));
        if scene.colliders.any_contact_events() || !self.approaches.is_empty() {
            self.totals.resize(self.found.len(), Impulses::default());
            for (number, [first, second], exponent) in solvers.totals() {
                let second = if self.contacts[number as usize].count == 2 { second } else { 0 };
                self.totals[number as usize] = Impulses { values: [first, second, 0], exponent };
            }
        }
        for contact in self.contacts.iter().filter(|contact| contact.impulses.values != [0; 3]) {
            for body in contact.bodies {
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
}
