//! Contacts that are added within a step: the solver takes their islands again, from the start of the step.
//!
//! Reads: the flights, the contacts and the impulses that they start from. Writes: impulses and corrections of the islands with added
//! contacts.

use alloc::vec::Vec;

use super::flights::Flights;
use super::joints::JointList;
use super::list::ContactList;
use super::split::{Part, Solvers, bodies_of};
use super::{Correction, Scene};
use crate::solve::{Contact, ContactSolver, Graph, Joint};

/// An island of more bodies is large: no contacts are added to it within a step.
const LARGEST: u32 = 64;

/// The islands to which contacts were added within a step, and memory for solving them again.
#[derive(Debug, Default)]
pub(super) struct Again {
    /// The flights of the contacts that were added last.
    pub(super) added: Vec<u32>,
    /// By flight: true for a body of an island with such a contact; empty before the first ones are added.
    is_changed: Vec<bool>,
    graph: Graph,
    /// The number of bodies by island, of the contacts so far; empty where none can be large.
    body_counts: Vec<u32>,
    /// By island.
    is_taken: Vec<bool>,
    part: Part,
}

impl Again {
    /// Solves the islands of the added contacts from the start of the step: writes impulses to the joints and contacts, and the corrections of
    /// their bodies. Returns the joints and contacts that were solved.
    pub(super) fn solve<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        flights: &Flights,
        joints: &mut JointList,
        contacts: &mut ContactList,
        corrections: &mut [Correction],
    ) -> &Part {
        self.take_islands(flights, &joints.solver_joints, &contacts.solver_contacts);
        let Self { part, is_changed, .. } = self;
        for (joint, &number) in part.joints.iter_mut().zip(&part.joint_numbers) {
            joint.impulses = joints.starts[number as usize];
        }
        for (contact, &number) in part.contacts.iter_mut().zip(&part.contact_numbers) {
            contact.impulses = contacts.detected[number as usize].carried();
        }
        let options = scene.settings.into();
        let Part { flights, joints: part_joints, contacts: part_contacts, .. } = part;
        solvers.solve(scene.time_step, &options, flights, part_joints, part_contacts, &mut part.corrections);
        for (&number, change) in part.flight_numbers.iter().zip(&part.corrections) {
            match corrections.get_mut(number as usize) {
                Some(correction) if is_changed[number as usize] => *correction = *change,
                // A fixed body, which other islands may touch as well.
                Some(correction) => correction.is_pushed = false,
                None => {}
            }
        }
        for (joint, &number) in part.joints.iter().zip(&part.joint_numbers) {
            joints.solver_joints[number as usize].impulses = joint.impulses;
        }
        for (contact, &number) in part.contacts.iter().zip(&part.contact_numbers) {
            contacts.solver_contacts[number as usize].impulses = contact.impulses;
        }
        part
    }

    pub(super) fn clear(&mut self) {
        self.added.clear();
        self.is_changed.clear();
        self.body_counts.clear();
    }

    /// Counts the bodies of islands, for the joints and the contacts so far.
    pub(super) fn count_bodies(&mut self, flights: &Flights, joints: &[Joint], contacts: &[Contact]) {
        let Self { graph, body_counts, .. } = self;
        body_counts.clear();
        // An island of that many bodies has as many joints and contacts.
        if joints.len() + contacts.len() < LARGEST as usize {
            return;
        }
        build_islands(graph, flights, joints, contacts);
        body_counts.resize(graph.islands(), 0);
        for island in (0..flights.len() as u32).filter_map(|flight| graph.island_of(flight)) {
            body_counts[island as usize] += 1;
        }
    }

    /// Returns true for a body of a large island.
    pub(super) fn is_in_large_island(&self, flight: u32) -> bool {
        let is_large = |island: u32| self.body_counts[island as usize] > LARGEST;
        !self.body_counts.is_empty() && self.graph.island_of(flight).is_some_and(is_large)
    }

    /// The flights of the contacts that were solved again last, in no order: no other path is another one than before. `None` before
    /// contacts are added.
    pub(super) fn solved_flights(&self) -> Option<impl Iterator<Item = u32> + '_> {
        let is_changed = |flight: &u32| self.is_changed[*flight as usize];
        (!self.is_changed.is_empty()).then(|| self.part.flight_numbers.iter().copied().filter(is_changed))
    }

    /// Copies the joints and contacts of the islands of the added contacts; all of them where bodies follow others.
    fn take_islands(&mut self, flights: &Flights, joints: &[Joint], contacts: &[Contact]) {
        let Self { added, is_changed, graph, is_taken, part, .. } = self;
        build_islands(graph, flights, joints, contacts);
        let all = flights.all();
        is_taken.clear();
        is_taken.resize(graph.islands(), flights.any_followers());
        for island in added.drain(..).filter_map(|body| graph.island_of(body)) {
            is_taken[island as usize] = true;
        }
        is_changed.clear();
        let islands = (0..all.len() as u32).map(|body| graph.island_of(body));
        is_changed.extend(islands.map(|island| island.is_some_and(|island| is_taken[island as usize])));
        part.take(all, joints, contacts, |bodies| bodies.into_iter().any(|body| is_changed[body as usize]));
        for index in 0..part.flights.len() {
            part.flights[index].leader = part.flights[index].leader.and_then(|leader| part.flight(leader));
        }
    }
}

fn build_islands(graph: &mut Graph, flights: &Flights, joints: &[Joint], contacts: &[Contact]) {
    let all = flights.all();
    graph.build_islands(|body| all[body as usize].is_fixed(), all.len(), bodies_of(joints, contacts));
}
