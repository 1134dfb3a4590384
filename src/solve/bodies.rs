//! The bodies of a step: the units of their velocities, their rows, and their masses as contacts and joints see them.
//!
//! Reads: flights, joints, contacts, the graph. Writes: [`BodyRows`].
//!
//! An island has a unit of velocity, such that neither its flights nor the impulses that the step starts from are too fast for it. A body
//! that can be moved has one row, in the unit of its island; a fixed body that moves has one in each unit of its contacts and joints, its
//! *carriers*; all other bodies share the row [`STILL`].

use alloc::vec::Vec;

use super::follow::{Follower, add_leader_speeds};
use super::graph::Graph;
use super::motion::{FlightRow, Rows};
use super::number::{log2_above, shifted_word};
use super::rolling::resists;
use super::unit::unit_for;
use super::{Contact, Flight, Impulses, StepInput};
use crate::fx::Fx;
use crate::scalar::FxFactor;

/// The row of bodies that neither move nor can be moved.
pub(super) const STILL: u32 = 0;
/// Factors of masses have this many bits relative to the largest of a contact.
pub(super) const MASS_BITS: i32 = 31;

/// The velocity that the impulses at the start give to a body.
#[derive(Clone, Copy, Debug)]
struct Load {
    /// [`Flight::inverse_exponent`]
    exponent: i32,
    /// In 2^-32 m/s.
    speed: u128,
}

/// A row of a fixed body that moves, in a unit of its contacts and joints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carrier {
    pub(super) unit: i32,
    pub(super) row: u32,
    /// The next carrier of the same body.
    pub(super) next: Option<u32>,
}

/// The bodies of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyRows {
    pub(super) rows: Rows,
    /// Row by body.
    pub(super) row_of: Vec<u32>,
    /// log2 of the unit of velocity by body.
    pub(super) unit_of: Vec<i32>,
    /// Masses and lengths by body.
    pub(super) bodies: Vec<SolverBody>,
    /// The largest speed by island, in 2^-32 m/s.
    fastest: Vec<u128>,
    /// The load of the initial impulses, by body.
    loads: Vec<Load>,
    /// Rows of fixed bodies that move, and the first one by body.
    pub(super) carriers: Vec<Carrier>,
    pub(super) carrier_of: Vec<Option<u32>>,
    /// Carriers that go along the rows of other bodies.
    pub(super) followers: Vec<Follower>,
}

impl BodyRows {
    /// Chooses units and makes the rows of bodies that touch.
    pub(super) fn set(&mut self, input: &StepInput<'_>, graph: &Graph) {
        let StepInput { clock, softness, flights, .. } = *input;
        self.loads.clear();
        self.fastest.clear();
        self.fastest.resize(graph.islands(), 0);
        for (body, flight) in flights.iter().enumerate() {
            if let Some(island) = graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(flight.speed());
            }
            self.loads.push(Load { exponent: flight.inverse_exponent(), speed: 0 });
        }
        self.add_fixed_speeds(graph, flights);
        self.add_joint_speeds(input, graph);
        self.add_surface_speeds(graph, input.contacts);
        self.add_loads(input, graph);
        add_leader_speeds(&mut self.fastest, graph, flights);
        self.rows.clear();
        self.rows.push(FlightRow::default(), i32::MAX);
        self.row_of.clear();
        self.unit_of.clear();
        self.bodies.clear();
        for (body, flight) in flights.iter().enumerate() {
            let (row, unit) = match graph.island_of(body as u32) {
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
        self.carriers.clear();
        self.carrier_of.clear();
        self.carrier_of.resize(flights.len(), None);
    }

    /// Fixed bodies that move count in all islands that they touch.
    fn add_fixed_speeds(&mut self, graph: &Graph, flights: &[Flight]) {
        for (body, flight) in flights.iter().enumerate() {
            if !flight.is_fixed() {
                continue;
            }
            let speed = flight.speed();
            for neighbour in graph.touched_by(body as u32) {
                if let Some(island) = graph.island_of(neighbour) {
                    let fastest = &mut self.fastest[island as usize];
                    *fastest = (*fastest).max(speed);
                }
            }
        }
    }

    /// Joints count with the speed that takes their errors away.
    fn add_joint_speeds(&mut self, input: &StepInput<'_>, graph: &Graph) {
        for joint in input.joints {
            if let Some(island) = graph.mover(joint.bodies).and_then(|body| graph.island_of(body)) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(joint.repair_speed(input.clock, input.flights));
            }
        }
    }

    /// Impulses that the step starts from count as the velocities that each of them gives to a body, all of the body together: impulses on
    /// a light body under a heavy one are large and cancel, but one after the other.
    fn add_loads(&mut self, input: &StepInput<'_>, graph: &Graph) {
        // The largest speed that a unit is chosen for: speeds of flights are below 2^66 as well.
        const FASTEST: u128 = 1 << 66;
        let StepInput { clock, flights, contacts, .. } = *input;
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
            if let Some(island) = graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max((load.speed / u128::from(clock.substeps.max(4))).min(FASTEST));
            }
        }
    }

    /// Bodies may take up the speed of a surface.
    fn add_surface_speeds(&mut self, graph: &Graph, contacts: &[Contact]) {
        for contact in contacts.iter().filter(|contact| contact.surface_speed != Fx::ZERO) {
            if let Some(island) = graph.mover(contact.bodies).and_then(|body| graph.island_of(body)) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(contact.surface_speed.to_bits().unsigned_abs().into());
            }
        }
    }

    /// The row of a body, in the unit of the contact or joint.
    #[inline(always)]
    pub(super) fn row(&mut self, input: &StepInput<'_>, body: u32, unit: i32) -> u32 {
        let solver_body = &self.bodies[body as usize];
        if solver_body.is_carrier { self.carrier(input, body, unit) } else { solver_body.row }
    }

    /// The row of a fixed body that moves: it has one for each unit of its contacts and joints.
    fn carrier(&mut self, input: &StepInput<'_>, body: u32, unit: i32) -> u32 {
        let first = self.carrier_of[body as usize];
        let mut next = first;
        while let Some(index) = next {
            let carrier = &self.carriers[index as usize];
            if carrier.unit == unit {
                return carrier.row;
            }
            next = carrier.next;
        }
        let flight = &input.flights[body as usize];
        let row = self.rows.push(flight.row(unit), input.softness.impact_speed(unit));
        self.carrier_of[body as usize] = Some(self.carriers.len() as u32);
        self.carriers.push(Carrier { unit, row, next: first });
        row
    }
}

/// The masses and lengths of a [`Flight`], as contacts and joints are prepared from them.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolverBody {
    pub(super) row: u32,
    /// log2 of the length in metres by which arms are divided and angular velocities multiplied.
    pub(super) length: i32,
    /// [`Flight::inverse_exponent`]
    exponent: i32,
    /// True if its centre cannot be moved.
    pub(super) is_held: bool,
    /// True for a fixed body that moves.
    pub(super) is_carrier: bool,
    /// Its radius over the length, in 2^-30.
    pub(super) rim: i64,
    /// 1/m along x and y, 1/kg.
    pub(super) inverse_mass: [FxFactor; 2],
    /// 1/I, 1/(kg·m²).
    pub(super) inverse_inertia: FxFactor,
    /// [`masses`](Self::masses) by its own exponent.
    own_masses: [i64; 3],
}

impl SolverBody {
    pub(super) fn new(flight: &Flight, exponent: i32, row: u32) -> Self {
        let length = flight.length();
        let inverse_mass = [flight.inverse_mass.x, flight.inverse_mass.y];
        let inverse_inertia = flight.inverse_inertia;
        Self {
            row,
            length,
            exponent,
            is_held: inverse_mass.iter().all(|factor| factor.is_zero()),
            // A body at rest has a speed of 1: angular ones are rounded up.
            is_carrier: row == STILL && flight.is_fixed() && (flight.speed() > 1 || flight.leader.is_some()),
            rim: shifted_word(flight.radius.to_bits(), 2 + length),
            inverse_mass,
            inverse_inertia,
            own_masses: masses(inverse_mass, inverse_inertia, exponent, length),
        }
    }

    /// Inverse masses along x and y and the inverse inertia over the square of the length, with [`MASS_BITS`] below 2^exponent.
    #[inline(always)]
    pub(super) fn masses(&self, exponent: i32) -> [i64; 3] {
        if exponent == self.exponent {
            return self.own_masses;
        }
        masses(self.inverse_mass, self.inverse_inertia, exponent, self.length)
    }
}

/// The exponent above all inverse masses, and inverse inertias times the square of the length; `None` if all are zero.
pub(super) fn largest_exponent([a, b]: [&SolverBody; 2]) -> Option<i32> {
    Some(a.exponent.max(b.exponent)).filter(|&exponent| exponent > i32::MIN / 4)
}

/// factor · 2^bits to nearest, ties upwards. *Domain* the result is at most 2^31.
#[inline(always)]
fn mass(factor: FxFactor, bits: i32) -> i64 {
    let (mantissa, shift) = factor.parts();
    let down = shift - bits;
    if down > 64 { 0 } else { (((mantissa >> (down - 1).clamp(0, 63)) + 1) >> 1) as i64 }
}

/// [`SolverBody::masses`]
fn masses([x, y]: [FxFactor; 2], inertia: FxFactor, exponent: i32, length: i32) -> [i64; 3] {
    // Factors that are zero have no exponent.
    let unit = MASS_BITS - exponent.max(i32::MIN / 4);
    [mass(x, unit), mass(y, unit), mass(inertia, unit + 2 * length)]
}
