//! Preparation of a step: units and rows of bodies, and the groups of contacts.

use alloc::vec::Vec;

use super::contact::{ContactInput, Group, SolverBody};
use super::graph::PHASES;
use super::joint::Joint;
use super::motion::FlightRow;
use super::number::log2_above;
use super::rolling::resists;
use super::unit::{Clock, FINEST, Scale, Softness, unit_for};
use super::{Contact, Flight, Impulses, Place, STILL, Solver};
use crate::fx::Fx;
use crate::kernel::simd::{GROUP, Job, Lanes};

/// The velocity that the impulses at the start give to a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    /// [`Flight::inverse_exponent`]
    exponent: i32,
    /// In 2^-32 m/s.
    speed: u128,
}

impl Solver {
    /// Chooses units and makes the rows of bodies that touch.
    pub(super) fn set_rows(
        &mut self,
        clock: &Clock,
        softness: &Softness,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
    ) {
        self.loads.clear();
        self.fastest.clear();
        self.fastest.resize(self.graph.islands(), 0);
        for (body, flight) in flights.iter().enumerate() {
            if let Some(island) = self.graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(flight.speed());
            }
            self.loads.push(Load { exponent: flight.inverse_exponent(), speed: 0 });
        }
        self.add_fixed_speeds(flights);
        self.add_joint_speeds(clock, flights, joints);
        self.add_surface_speeds(contacts);
        self.add_loads(clock, flights, contacts);
        self.add_leader_speeds(flights);
        self.rows.clear();
        self.rows.push(FlightRow::default(), i32::MAX);
        self.row_of.clear();
        self.unit_of.clear();
        self.bodies.clear();
        for (body, flight) in flights.iter().enumerate() {
            let (row, unit) = match self.graph.island_of(body as u32) {
                Some(island) => {
                    let unit = unit_for(self.fastest[island as usize], clock.substeps);
                    (self.rows.push(flight.row(unit), softness.impact_speed(unit)), unit)
                }
                None => (STILL, 0),
            };
            self.row_of.push(row);
            self.bodies.push(SolverBody::new(flight, self.loads[body].exponent, row));
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
            for neighbour in self.graph.touched_by(body as u32) {
                if let Some(island) = self.graph.island_of(neighbour) {
                    let fastest = &mut self.fastest[island as usize];
                    *fastest = (*fastest).max(speed);
                }
            }
        }
    }

    /// Impulses that the step starts from count as the velocities that each of them gives to a body, all of the body together: impulses on
    /// a light body under a heavy one are large and cancel, but one after the other.
    fn add_loads(&mut self, clock: &Clock, flights: &[Flight], contacts: &[Contact]) {
        // The largest speed that a unit is chosen for: speeds of flights are below 2^66 as well.
        const FASTEST: u128 = 1 << 66;
        for contact in contacts {
            let Impulses { values: [first, second, tangent], exponent: unit } = contact.impulses;
            // Each is at most 2^62.
            let sum = first.unsigned_abs() + second.unsigned_abs() + tangent.unsigned_abs();
            for body in contact.bodies {
                // An impulse at a lever beyond the body's length turns it as much more.
                let lever = if resists(contact) {
                    (log2_above(contact.rolling_radius) - flights[body as usize].length()).max(0)
                } else {
                    0
                };
                let load = &mut self.loads[body as usize];
                // From 2^unit N·s to 2^-32 m/s; far below zero for a body that cannot be moved.
                let up = load.exponent + unit + 32 + lever;
                let speed = if up > 0 { u128::from(sum) << up.min(63) } else { (sum >> (-up).min(63)).into() };
                // 2^70 from each of as many contacts as there may be: the sum fits.
                load.speed += speed.min(FASTEST << 4);
            }
        }
        for (body, load) in self.loads.iter().enumerate() {
            if let Some(island) = self.graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max((load.speed / u128::from(clock.substeps.max(4))).min(FASTEST));
            }
        }
    }

    /// Bodies may take up the speed of a surface.
    fn add_surface_speeds(&mut self, contacts: &[Contact]) {
        for contact in contacts.iter().filter(|contact| contact.surface_speed != Fx::ZERO) {
            if let Some(island) = self.graph.mover(contact.bodies).and_then(|body| self.graph.island_of(body)) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(contact.surface_speed.to_bits().unsigned_abs().into());
            }
        }
    }

    /// Sorts the contacts by phase, and counts them by body and phase.
    pub(super) fn sort_contacts(&mut self, contacts: &[Contact]) {
        let Self { graph, row_of, shares, touched, order, phases, phase_of, has_rolls, .. } = self;
        clear_shares(shares, touched, row_of.len());
        phase_of.clear();
        let mut counts = [0; PHASES];
        *has_rolls = false;
        for contact in contacts {
            let phase = graph.phase(contact.bodies);
            *has_rolls |= contact.rolling_resistance != Fx::ZERO;
            count_share(shares, touched, row_of, phase, contact.bodies);
            let can_move = graph.mover(contact.bodies).is_some();
            counts[phase] += usize::from(can_move);
            phase_of.push(if can_move { phase as u8 } else { PHASES as u8 });
        }
        let mut ends = [0, counts[0], counts[0] + counts[1]];
        order.clear();
        order.resize(counts.iter().sum(), 0);
        for (index, &phase) in phase_of.iter().enumerate() {
            if let Some(end) = ends.get_mut(usize::from(phase)) {
                order[*end] = index as u32;
                *end += 1;
            }
        }
        // Ranges of contacts, which `SetGroups` turns into ranges of groups.
        (0..PHASES).for_each(|phase| phases[phase] = ends[phase] - counts[phase]..ends[phase]);
    }

    /// The row of a body, in the unit of the contact or joint.
    #[inline(always)]
    pub(super) fn row(&mut self, body: u32, unit: i32, flights: &[Flight], softness: &Softness) -> u32 {
        let solver_body = &self.bodies[body as usize];
        if solver_body.is_carrier {
            self.carrier(body, unit, &flights[body as usize], softness)
        } else {
            solver_body.row
        }
    }

    /// Writes a group of contacts.
    #[inline(always)]
    fn set_group<L: Lanes>(
        &mut self,
        lanes: L,
        at: usize,
        indices: &[u32],
        phase: usize,
        step_input: &mut StepInput<'_>,
    ) {
        if self.groups.len() == at {
            self.groups.push(Group::empty(STILL));
        }
        let mut exponents = [0; GROUP];
        for (lane, &index) in indices.iter().enumerate() {
            let contact = &step_input.contacts[index as usize];
            let [a, b] = contact.bodies;
            let unit = self.graph.mover([a, b]).map_or(FINEST, |mover| self.unit_of[mover as usize]);
            let rows = [a, b].map(|body| self.row(body, unit, step_input.flights, step_input.softness));
            let bodies = [&self.bodies[a as usize], &self.bodies[b as usize]];
            let shares = [self.shares[a as usize][phase], self.shares[b as usize][phase]];
            let contact_input = ContactInput { contact, bodies, rows, shares };
            exponents[lane] = unit + self.batch.load(lane, &contact_input);
            let compliance = self.groups[at].load(lane, &contact_input, step_input.scale(unit));
            self.batch.compliance[lane] = compliance.into();
            self.groups[at].raise_impact_speed(lane, rows.map(|row| self.rows.flight(row).change));
        }
        let group = &mut self.groups[at];
        let batch = &mut self.batch;
        group.count = indices.len();
        (group.applied, group.weighted) = ([[0; GROUP]; 3], [[0; GROUP]; 3]);
        batch.clear(indices.len()..GROUP);
        batch.fill(lanes, group);
        self.matrices.set(lanes, batch, group);
        group.clear(indices.len()..GROUP);
        for (lane, &index) in indices.iter().enumerate().filter(|&(lane, _)| batch.moves(lane)) {
            // The unit of masses · 2^-exponent is 2^-(bits + 2).
            let exponent = exponents[lane] - batch.bits[lane] as i32 - 2;
            let contact = &step_input.contacts[index as usize];
            group.set_impulses(lane, contact, exponent);
            let [a, b] = contact.bodies;
            batch.limit_push(lane, group, [self.bodies[a as usize].rim, self.bodies[b as usize].rim]);
            self.places.push(Place { contact: index, group: at as u32, lane: lane as u32, exponent });
        }
    }
}

/// The values that groups are made from.
pub(super) struct StepInput<'a> {
    pub(super) softness: &'a Softness,
    pub(super) flights: &'a [Flight],
    pub(super) contacts: &'a [Contact],
    /// The scale of the contact before.
    pub(super) scale: Scale<'a>,
}

impl<'a> StepInput<'a> {
    #[inline(always)]
    fn scale(&mut self, unit: i32) -> &Scale<'a> {
        if self.scale.unit != unit {
            self.scale = Scale::new(self.scale.clock, self.softness, unit);
        }
        &self.scale
    }
}

/// Puts the contacts of all phases, which are sorted, into groups.
pub(super) struct SetGroups<'a> {
    pub(super) solver: &'a mut Solver,
    pub(super) step_input: StepInput<'a>,
}

impl Job for SetGroups<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { solver, mut step_input } = self;
        let order = core::mem::take(&mut solver.order);
        let mut at = 0;
        for phase in 0..PHASES {
            let begin = at;
            for indices in order[solver.phases[phase].clone()].chunks(GROUP) {
                solver.set_group(lanes, at, indices, phase, &mut step_input);
                at += 1;
            }
            solver.phases[phase] = begin..at;
        }
        solver.groups.truncate(at);
        solver.order = order;
    }
}

/// Clears the counts and the lists of [`count_share`].
pub(super) fn clear_shares(shares: &mut Vec<[u32; PHASES]>, touched: &mut [Vec<u32>; PHASES], bodies: usize) {
    shares.clear();
    shares.resize(bodies, [0; PHASES]);
    touched.iter_mut().for_each(Vec::clear);
}

/// Counts a joint or contact of a phase by body, and lists the rows that it can move.
#[inline(always)]
pub(super) fn count_share(
    shares: &mut [[u32; PHASES]],
    touched: &mut [Vec<u32>; PHASES],
    row_of: &[u32],
    phase: usize,
    bodies: [u32; 2],
) {
    for body in bodies {
        let count = &mut shares[body as usize][phase];
        let row = row_of[body as usize];
        *count += 1;
        if *count == 1 && row != STILL {
            touched[phase].push(row);
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
    let centre_offset = |body: u32| {
        let offset = offset(body);
        [0, 1].map(|i| (weights * offset[i] - sums[i]).unsigned_abs())
    };
    let heavy = || members.iter().copied().filter(|&body| mass(body) == heaviest);
    let Some(farthest) = heavy().flat_map(centre_offset).max() else { return };
    // Down to 62 bits, so that the squares fit.
    let down = (66 - farthest.leading_zeros() as i32).max(0);
    let distance = |body: u32| centre_offset(body).map(|d| (d >> down).pow(2)).into_iter().sum::<u128>();
    let Some(nearest) = heavy().map(distance).min() else { return };
    queue.extend(heavy().filter(|&body| distance(body) == nearest));
}
