//! Preparation of a step: units and rows of bodies, and the groups of contacts.

use alloc::vec::Vec;

use super::contact::{BodyOf, ContactOf, Group};
use super::joint::Joint;
use super::motion::FlightRow;
use super::unit::{Clock, Softness, unit_for};
use super::{Contact, Flight, Place, STILL, Solver};
use crate::kernel::simd::GROUP;

impl Solver {
    /// Chooses units and makes the rows of bodies that touch.
    pub(super) fn set_rows(&mut self, clock: &Clock, flights: &[Flight], joints: &[Joint]) {
        self.fastest.clear();
        self.fastest.resize(self.graph.islands(), 0);
        for (body, flight) in flights.iter().enumerate() {
            if let Some(island) = self.graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(flight.speed());
            }
        }
        self.add_fixed_speeds(flights);
        self.add_joint_speeds(clock, flights, joints);
        self.rows.clear();
        self.rows.push(FlightRow::default());
        self.row_of.clear();
        self.unit_of.clear();
        for (body, flight) in flights.iter().enumerate() {
            let (row, unit) = match self.graph.island_of(body as u32) {
                Some(island) => {
                    let unit = unit_for(self.fastest[island as usize], clock.substeps);
                    (self.rows.push(flight.row(unit)), unit)
                }
                None => (STILL, 0),
            };
            self.row_of.push(row);
            self.unit_of.push(unit);
        }
    }

    /// Fixed bodies that move count in all islands that they touch.
    fn add_fixed_speeds(&mut self, flights: &[Flight]) {
        for (body, flight) in flights.iter().enumerate() {
            if !flight.is_fixed() {
                continue;
            }
            let speed = flight.speed();
            for other in self.graph.touched_by(body as u32) {
                if let Some(island) = self.graph.island_of(other) {
                    let fastest = &mut self.fastest[island as usize];
                    *fastest = (*fastest).max(speed);
                }
            }
        }
    }

    /// Puts the contacts of a phase into groups.
    pub(super) fn set_phase(
        &mut self,
        phase: usize,
        clock: &Clock,
        softness: &Softness,
        flights: &[Flight],
        contacts: &[Contact],
    ) {
        let of_phase = |contact: &&Contact| self.graph.phase(contact.bodies) == phase;
        let links = contacts.iter().filter(of_phase).map(|contact| contact.bodies);
        count_shares(&mut self.shares, &self.row_of, &mut self.touched[phase], links);
        let begin = self.groups.len();
        for (index, contact) in contacts.iter().enumerate() {
            if self.graph.phase(contact.bodies) == phase {
                self.push(begin, index, contact, (clock, softness), flights);
            }
        }
        self.phases[phase] = begin..self.groups.len();
    }

    /// Adds a contact to the groups from `begin` on, with the shares of bodies as they are set.
    fn push(
        &mut self,
        begin: usize,
        index: usize,
        contact: &Contact,
        (clock, softness): (&Clock, &Softness),
        flights: &[Flight],
    ) {
        let Some(mover) = self.graph.mover(contact.bodies) else { return };
        let unit = self.unit_of[mover as usize];
        let of = ContactOf { contact, bodies: contact.bodies.map(|body| self.body(body, unit, flights)), unit };
        if self.groups.len() == begin || self.groups.last().is_some_and(|group| group.count == GROUP) {
            self.groups.push(Group::empty(STILL));
        }
        let group = self.groups.len() - 1;
        let lane = self.groups[group].count;
        if let Some(exponent) = self.groups[group].push(&of, clock, softness) {
            self.places.push(Place { contact: index as u32, group: group as u32, lane: lane as u32, exponent });
        }
    }

    pub(super) fn body(&mut self, body: u32, unit: i32, flights: &[Flight]) -> BodyOf {
        let flight = &flights[body as usize];
        let mut row = self.row_of[body as usize];
        // A body at rest has a speed of 1: angular ones are rounded up.
        if flight.is_fixed() && flight.speed() > 1 {
            row = self.carrier(body, unit, flight);
        }
        BodyOf {
            row,
            inverse_mass: [flight.inverse_mass.x, flight.inverse_mass.y],
            inverse_inertia: flight.inverse_inertia,
            length: flight.length(),
            share: self.shares[body as usize].into(),
        }
    }
}

/// Counts the joints or contacts of a phase by body, and lists the rows that they can move.
pub(super) fn count_shares(
    shares: &mut Vec<u32>,
    row_of: &[u32],
    touched: &mut Vec<u32>,
    links: impl Iterator<Item = [u32; 2]>,
) {
    shares.clear();
    shares.resize(row_of.len(), 0);
    touched.clear();
    for body in links.flatten() {
        let (count, row) = (&mut shares[body as usize], row_of[body as usize]);
        *count += 1;
        if *count == 1 && row != STILL {
            touched.push(row);
        }
    }
}

/// The bodies at which the levels of an island begin that touches no fixed body: the heaviest ones; among these the nearest to
/// the island's centre of mass.
pub(super) fn graph_start(flights: &[Flight], members: &[u32], queue: &mut Vec<u32>) {
    let mass = |body: u32| flights[body as usize].mass.to_bits();
    let total: i128 = members.iter().map(|&body| i128::from(mass(body))).sum();
    let Some(heaviest) = members.iter().map(|&body| mass(body)).max() else { return };
    // All masses together have 60 bits.
    let down = (68 - total.leading_zeros() as i32).max(0);
    let weight = |body: u32| i128::from(mass(body) >> down);
    let weights: i128 = members.iter().map(|&body| weight(body)).sum();
    // Offsets from any member: positions differ by less than 2^31.4 m, 2^63.4 units.
    let origin = flights[members[0] as usize].position;
    let offset = |body: u32| {
        let position = flights[body as usize].position;
        [(position.x, origin.x), (position.y, origin.y)].map(|(x, o)| i128::from(x.to_bits()) - i128::from(o.to_bits()))
    };
    let mut sums = [0; 2];
    for &body in members {
        let offset = offset(body);
        (0..2).for_each(|i| sums[i] += weight(body) * offset[i]);
    }
    // From the centre of mass, times the sum of masses: exact, so that ties are ties. Below 2^124.4.
    let from_centre = |body: u32| {
        let offset = offset(body);
        [0, 1].map(|i| (weights * offset[i] - sums[i]).unsigned_abs())
    };
    let heavy = || members.iter().copied().filter(|&body| mass(body) == heaviest);
    let Some(farthest) = heavy().flat_map(from_centre).max() else { return };
    // Down to 62 bits, so that the squares fit.
    let down = (66 - farthest.leading_zeros() as i32).max(0);
    let distance = |body: u32| from_centre(body).map(|d| (d >> down).pow(2)).into_iter().sum::<u128>();
    let Some(nearest) = heavy().map(distance).min() else { return };
    queue.extend(heavy().filter(|&body| distance(body) == nearest));
}
