//! The contacts of a step: solving them, and the records that follow.

use alloc::vec::Vec;

use super::engine::Engine;
use super::flights::Flights;
use super::split::{Part, Solvers};
use super::{ContactSet, Correction, Scene};
use crate::collider::ColliderSet;
use crate::solve::{Contact, ContactSolver, Graph};

impl Engine {
    /// Lists the contacts with impulses: before [`solve`](Self::solve) with the impulses that they start from, and after it also the
    /// contacts that touched and have events. Lists also the answers of one-way colliders and the pairs of bodies that stay excluded.
    pub(crate) fn list(&self, contacts: &mut ContactSet) {
        contacts.records.clear();
        contacts.records.extend(self.contacts.records());
        contacts.passes.clone_from(&self.passes);
        contacts.excluded.clone_from(&self.excluded);
    }

    /// Exchanges the impulses of all contacts with the impulses that they start from.
    pub(crate) fn swap_starts(&mut self) {
        self.contacts.swap_starts();
    }

    /// Calls `visit` with the slots of the two bodies of each contact, and true if a surface of one of them moves.
    pub(crate) fn touching(&self, colliders: &ColliderSet, visit: impl FnMut([u32; 2], bool)) {
        self.contacts.each_body_pair(colliders, visit);
    }

    /// Solves the contacts, and writes the change of each body of `scene.starts` to `corrections`; none if there was no
    /// impulse.
    pub(crate) fn solve<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        corrections: &mut Vec<Correction>,
    ) {
        corrections.clear();
        self.contacts.totals.clear();
        self.contacts.touched.clear();
        if self.contacts.is_empty() {
            return;
        }
        let options = scene.settings.into();
        let changes = solvers.solve(scene.time_step, &options, self.flights.all(), &mut self.contacts.solver_contacts);
        // Moving bodies have the first flights.
        corrections.extend(changes.iter().take(scene.starts.len()).map(Correction::from));
        self.find_touches(solvers, scene, None);
        self.mark_pushing(corrections);
    }

    /// Solves the islands again that the added contacts belong to, from the start of the step.
    pub(crate) fn solve_again<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        corrections: &mut Vec<Correction>,
    ) {
        let mut again = core::mem::take(&mut self.again);
        again.take_islands(&self.flights, &self.contacts.solver_contacts);
        let part = &mut again.part;
        for (contact, &number) in part.contacts.iter_mut().zip(&part.contact_numbers) {
            contact.impulses = self.contacts.detected[number as usize].start;
        }
        let options = scene.settings.into();
        let changes = solvers.solve(scene.time_step, &options, &part.flights, &mut part.contacts);
        for (&number, change) in part.flight_numbers.iter().zip(changes) {
            match corrections.get_mut(number as usize) {
                Some(correction) if again.is_changed[number as usize] => *correction = Correction::from(change),
                // A fixed body, which other islands may touch as well.
                Some(correction) => correction.is_pushed = false,
                None => {}
            }
        }
        for (contact, &number) in part.contacts.iter().zip(&part.contact_numbers) {
            self.contacts.solver_contacts[number as usize].impulses = contact.impulses;
        }
        self.find_touches(solvers, scene, Some(part));
        self.mark_pushing(corrections);
        self.again = again;
    }

    /// Takes note of bodies that push others, which are not at rest even if nothing moves them. There are no corrections without impulses.
    fn mark_pushing(&self, corrections: &mut Vec<Correction>) {
        for contact in self.contacts.solver_contacts.iter().filter(|contact| contact.impulses.values != [0; 3]) {
            for body in contact.bodies {
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

/// The islands to which contacts were added within a step, and memory for solving them again.
#[derive(Debug, Default)]
pub(super) struct Again {
    /// The flights of the contacts that were added last.
    pub(super) added: Vec<u32>,
    /// By flight: true for a body of an island with such a contact; empty before the first ones are added.
    pub(super) is_changed: Vec<bool>,
    graph: Graph,
    /// By island.
    is_taken: Vec<bool>,
    part: Part,
}

impl Again {
    pub(super) fn clear(&mut self) {
        self.added.clear();
        self.is_changed.clear();
    }

    /// Returns true if the path of a body may be another one than before the last contacts were added.
    pub(super) fn may_have_changed(&self, flight: u32) -> bool {
        self.is_changed.get(flight as usize).is_none_or(|&is_changed| is_changed)
    }

    /// Copies the contacts of the islands of the added contacts; all of them where bodies follow others.
    fn take_islands(&mut self, flights: &Flights, contacts: &[Contact]) {
        let Self { added, is_changed, graph, is_taken, part } = self;
        let links = contacts.iter().map(|contact| contact.bodies);
        let all = flights.all();
        graph.build(|body| all[body as usize].is_fixed(), all.len(), links, |_, _| {});
        is_taken.clear();
        is_taken.resize(graph.islands(), flights.any_followers());
        for island in added.drain(..).filter_map(|body| graph.island_of(body)) {
            is_taken[island as usize] = true;
        }
        is_changed.clear();
        let islands = (0..all.len() as u32).map(|body| graph.island_of(body));
        is_changed.extend(islands.map(|island| island.is_some_and(|island| is_taken[island as usize])));
        part.take(all, contacts, |contact| contact.bodies.into_iter().any(|body| is_changed[body as usize]));
        for index in 0..part.flights.len() {
            part.flights[index].leader = part.flights[index].leader.and_then(|leader| part.flight(leader));
        }
    }
}
