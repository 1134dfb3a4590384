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
use super::number::{exponent, log2_above, shifted_word};
use super::rolling::resists;
use super::unit::{COARSE, unit_for};
use super::{Contact, Flight, Impulses, StepInput};
use crate::fx::Fx;
use crate::kernel::simd::{self, Job, Lanes};
use crate::scalar::FxFactor;

/// The row of bodies that neither move nor can be moved.
pub(super) const STILL: u32 = 0;
/// Factors of masses have this many bits relative to the largest of a contact.
pub(super) const MASS_BITS: i32 = 31;

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
    /// Masses and lengths by body.
    pub(super) bodies: Vec<SolverBody>,
    /// The largest speed by island, in 2^-[`COARSE`] m/s.
    fastest: Vec<u64>,
    /// The velocity that the impulses at the start give to a body, in 2^-[`COARSE`] m/s.
    loads: Vec<u64>,
    /// Rows of fixed bodies that move, and the first one by body.
    pub(super) carriers: Vec<Carrier>,
    pub(super) carrier_of: Vec<Option<u32>>,
    /// Carriers that go along the rows of other bodies.
    pub(super) followers: Vec<Follower>,
}

impl BodyRows {
    /// Chooses units and makes the rows of bodies that touch. No lanes: but instructions for shifts that the CPU has beside them.
    pub(super) fn set(&mut self, input: &StepInput<'_>, graph: &Graph) {
        simd::run(SetBodies { bodies: self, input, graph });
    }

    #[inline(always)]
    fn set_all(&mut self, input: &StepInput<'_>, graph: &Graph) {
        let flights = input.flights;
        self.fastest.clear();
        self.fastest.resize(graph.islands(), 0);
        self.bodies.clear();
        for (body, flight) in flights.iter().enumerate() {
            // Most bodies are like the body before.
            let solver_body = match self.bodies.last() {
                Some(before) if flights[body - 1].is_alike(flight) => *before,
                _ => SolverBody::new(flight),
            };
            if let Some(island) = graph.island_of(body as u32) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(flight.speed(solver_body.length));
            }
            self.bodies.push(solver_body);
        }
        self.add_fixed_speeds(graph, flights);
        self.loads.clear();
        self.loads.resize(flights.len(), 0);
        self.add_joint_speeds(input, graph);
        self.add_contact_speeds(input, graph);
        self.add_load_speeds(input, graph);
        add_leader_speeds(&mut self.fastest, graph, flights);
        self.set_rows(input, graph);
        self.carriers.clear();
        self.carrier_of.clear();
        self.carrier_of.resize(flights.len(), None);
    }

    /// Makes the rows of bodies that are in islands.
    #[inline(always)]
    fn set_rows(&mut self, input: &StepInput<'_>, graph: &Graph) {
        let Self { rows, row_of, bodies, fastest, .. } = self;
        let StepInput { clock, softness, flights, .. } = *input;
        rows.clear();
        rows.push(FlightRow::default(), i32::MAX);
        row_of.clear();
        for (body, (flight, solver_body)) in (0..).zip(flights.iter().zip(bodies)) {
            if let Some(island) = graph.island_of(body) {
                let unit = unit_for(fastest[island as usize], clock.substeps);
                let row = rows.push(flight.row(unit, solver_body.length), softness.impact_speed(unit));
                (solver_body.row, solver_body.unit) = (row, unit);
            } else {
                solver_body.is_carrier = flight.is_fixed() && (flight.is_moving() || flight.leader.is_some());
            }
            row_of.push(solver_body.row);
        }
    }

    /// Fixed bodies that move count in all islands that they touch.
    fn add_fixed_speeds(&mut self, graph: &Graph, flights: &[Flight]) {
        for (body, flight) in flights.iter().enumerate() {
            if !flight.is_fixed() {
                continue;
            }
            let speed = flight.speed(flight.length());
            for neighbour in graph.touched_by(body as u32) {
                if let Some(island) = graph.island_of(neighbour) {
                    let fastest = &mut self.fastest[island as usize];
                    *fastest = (*fastest).max(speed);
                }
            }
        }
    }

    /// Joints count with the speed that takes their errors away, and with the impulses that the step starts from: after a stop these turn a body back
    /// as fast as it came.
    fn add_joint_speeds(&mut self, input: &StepInput<'_>, graph: &Graph) {
        for joint in input.joints {
            if let Some(island) = graph.island_of_link(joint.bodies) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(coarse(joint.repair_speed(input.clock, input.flights)));
            }
            let Impulses { values: [first, second, around], exponent: unit } = joint.impulses;
            for body in joint.bodies {
                let solver_body = &self.bodies[body as usize];
                let up = solver_body.exponent + unit + COARSE;
                let load = &mut self.loads[body as usize];
                add_load(load, first.unsigned_abs() + second.unsigned_abs(), up);
                add_load(load, around.unsigned_abs(), up - solver_body.length);
            }
        }
    }

    /// Contacts count with the impulses that the step starts from. Bodies may take up the speed of a surface.
    #[inline(always)]
    fn add_contact_speeds(&mut self, input: &StepInput<'_>, graph: &Graph) {
        let Self { bodies, fastest, loads, .. } = self;
        for contact in input.contacts {
            let Impulses { values: [first, second, tangent], exponent: unit } = contact.impulses;
            // Each is at most 2^62.
            let sum = first.unsigned_abs() + second.unsigned_abs() + tangent.unsigned_abs();
            if sum != 0 {
                for body in contact.bodies {
                    let solver_body = &bodies[body as usize];
                    // From 2^unit N·s to 2^-COARSE m/s; far below zero for a body that cannot be moved.
                    let up = solver_body.exponent + unit + COARSE + lever(contact, solver_body.length);
                    add_load(&mut loads[body as usize], sum, up);
                }
            }
            if contact.surface_speed != Fx::ZERO {
                if let Some(island) = graph.island_of_link(contact.bodies) {
                    let fastest = &mut fastest[island as usize];
                    *fastest = (*fastest).max(coarse(contact.surface_speed.to_bits().unsigned_abs().into()));
                }
            }
        }
    }

    /// Impulses that the step starts from count as the velocities that each of them gives to a body, all of the body together: impulses on
    /// a light body under a heavy one are large and cancel, but one after the other.
    #[inline(always)]
    fn add_load_speeds(&mut self, input: &StepInput<'_>, graph: &Graph) {
        /// The largest speed that a unit is chosen for, 2^34 m/s: as the speeds of flights.
        const FASTEST: u64 = 1 << (34 + COARSE);
        for (body, &load) in (0..).zip(&self.loads) {
            if let Some(island) = graph.island_of(body).filter(|_| load != 0) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max((load / u64::from(input.clock.substeps.max(4))).min(FASTEST));
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
        let row = self.rows.push(flight.row(unit, flight.length()), input.softness.impact_speed(unit));
        self.carrier_of[body as usize] = Some(self.carriers.len() as u32);
        self.carriers.push(Carrier { unit, row, next: first });
        row
    }
}

/// [`BodyRows::set`]
struct SetBodies<'a> {
    bodies: &'a mut BodyRows,
    input: &'a StepInput<'a>,
    graph: &'a Graph,
}

impl Job for SetBodies<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        self.bodies.set_all(self.input, self.graph);
    }
}

/// The masses and lengths of a [`Flight`], as contacts and joints are prepared from them.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct SolverBody {
    /// Inverse masses along x and y and the inverse inertia over the square of the length, with [`MASS_BITS`] below 2^exponent; then
    /// its measures: see [`packed`].
    pub(super) masses: [i64; 4],
    pub(super) row: u32,
    /// log2 of the unit of velocity.
    pub(super) unit: i32,
    /// log2 of the length in metres by which arms are divided and angular velocities multiplied.
    pub(super) length: i32,
    /// The exponent above its inverse masses, and its inverse inertia times the square of the length.
    pub(super) exponent: i32,
    /// True if its centre cannot be moved.
    pub(super) is_held: bool,
    /// True for a fixed body that moves.
    pub(super) is_carrier: bool,
}

impl SolverBody {
    /// The body of a flight, which is in no island yet.
    #[inline(always)]
    fn new(flight: &Flight) -> Self {
        let length = flight.length();
        let factors = [flight.inverse_mass.x, flight.inverse_mass.y, flight.inverse_inertia];
        let [x, y, inertia] = factors.map(exponent);
        let exponent = x.max(y).max(inertia + 2 * length);
        // Factors that are zero have no exponent.
        let unit = MASS_BITS - exponent.max(NO_MASS);
        let [x, y, inertia] = factors;
        let rim = shifted_word(flight.radius.to_bits(), 2 + length);
        let measures = packed(exponent.max(NO_MASS), length, rim);
        Self {
            masses: [mass(x, unit), mass(y, unit), mass(inertia, unit + 2 * length), measures],
            row: STILL,
            unit: 0,
            length,
            exponent,
            is_held: x.is_zero() && y.is_zero(),
            is_carrier: false,
        }
    }
}

/// The exponent of a body that cannot be moved: below all others.
const NO_MASS: i32 = -(1 << 20);

/// The fields of the measures of a body, from the lowest on: its radius over the length, in 2^-30; log2 of the unit of arms in 2^-32 m, which
/// is less than a quarter of this; the exponent of its masses.
pub(super) const DOWN_BITS: i32 = 7;
/// An offset of the logarithm in its field, so that the field is not negative.
pub(super) const DOWN_ZERO: i64 = 64;

/// The measures of a body in a word.
#[inline(always)]
fn packed(exponent: i32, length: i32, rim: i64) -> i64 {
    let down = i64::from(2 + length) + DOWN_ZERO;
    ((i64::from(exponent) << DOWN_BITS) + down) << 32 | rim
}

/// The exponent above all inverse masses, and inverse inertias times the square of the length; `None` if all are zero.
pub(super) fn largest_exponent([a, b]: [&SolverBody; 2]) -> Option<i32> {
    Some(a.exponent.max(b.exponent)).filter(|&exponent| exponent > NO_MASS)
}

/// factor · 2^bits to nearest, ties upwards; at most 2^31 − 1. *Domain* the factor is below 2^(31 − bits).
#[inline(always)]
fn mass(factor: FxFactor, bits: i32) -> i64 {
    let (mantissa, shift) = factor.parts();
    let down = shift - bits;
    if down > 64 { 0 } else { (((mantissa >> (down - 1).clamp(0, 63)) + 1) >> 1).min((1 << MASS_BITS) - 1) as i64 }
}

/// Adds impulse · 2^up to a load.
#[inline(always)]
fn add_load(load: &mut u64, impulse: u64, up: i32) {
    if impulse == 0 {
        return;
    }
    let is_far = up > 0 && up >= impulse.leading_zeros() as i32;
    let shifted = if up > 0 { impulse << (up & 63) } else { impulse >> (-up).min(63) };
    *load = load.saturating_add(if is_far { u64::MAX } else { shifted });
}

/// How many times the length of a body, as log2, the lever of rolling resistance is; zero if it is not longer.
#[inline(always)]
fn lever(contact: &Contact, length: i32) -> i32 {
    if resists(contact) { (log2_above(contact.rolling_radius) - length).max(0) } else { 0 }
}

/// A speed in 2^-32 m/s, rounded up to 2^-[`COARSE`] m/s.
fn coarse(speed: u128) -> u64 {
    u64::try_from((speed >> (32 - COARSE)) + 1).unwrap_or(u64::MAX)
}
