//! The contacts that were found: solving them, and the records that follow.

use alloc::vec::Vec;

use super::engine::Engine;
use super::split::Solvers;
use super::{ContactRecord, ContactSet, Correction, Scene};
use crate::collider::{ColliderSet, OutlineId};
use crate::fx::Fx;
use crate::solve::{ContactSolver, Impulses};

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
    pub(crate) fn list(&self, contacts: &mut ContactSet) {
        contacts.records.clear();
        for (number, (found, contact)) in self.found.iter().zip(&self.contacts).enumerate() {
            if contact.impulses.values != [0; 3] || self.touched.get(number) == Some(&true) {
                contacts.records.push(found.record(contact.impulses));
            }
        }
        contacts.passes.clone_from(&self.passes);
        contacts.excluded.clone_from(&self.excluded);
    }

    /// Calls `visit` with the slots of the two bodies of each contact that was found, and true if a surface of one of them moves.
    pub(crate) fn touching(&self, colliders: &ColliderSet, mut visit: impl FnMut([u32; 2], bool)) {
        for FoundContact { pair, .. } in &self.found {
            if let [Some(a), Some(b)] = pair.map(|outline| colliders.at(outline.slot)) {
                let is_driven = a.def.material.surface_speed_against(&b.def.material) != Fx::ZERO;
                visit([a.body.slot, b.body.slot], is_driven);
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
        self.totals.clear();
        self.touched.clear();
        if self.found.is_empty() {
            return;
        }
        let options = scene.settings.into();
        let changes = solvers.solve(scene.time_step, &options, self.flights.all(), &mut self.contacts);
        // Moving bodies have the first flights.
        corrections.extend(changes.iter().take(scene.starts.len()).map(Correction::from));
        self.find_touches(solvers, scene);
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
