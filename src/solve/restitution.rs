//! Restitution: bodies that met at speed move apart, once a step and all at the same time.
//!
//! A point bounces if it closed faster than the threshold at the start of the step and has had an impulse since. It aims at −e·v, where v
//! is the speed at the moment of the impact: v² = v0² + 2·a·s0, with the relative acceleration a of the free flight and the separation s0 at the start.
//! (With v0 alone each bounce would lose the speed gained in the tick of the impact.)
//!
//! Impulses at the same time may add energy. So those of an island are scaled by the largest factor up to 1 for which the kinetic
//! energy is at most that of the free flight, or that before the bounce if it is larger.

use alloc::vec::Vec;

use super::contact::Group;
use super::motion::Vector;
use super::number::{bits_of, exponent, fixed, shifted};
use super::pass::{Pass, PassOver, SPECULATIVE};
use super::unit::{Clock, Softness};
use super::{Contact, Flight, PHASES, Solver, SolverOptions};
use crate::kernel::simd;

/// One, as a factor of impulses.
const ONE: i64 = 1 << 30;
/// The largest mass or inertia over R² in 2^-32 kg.
const HEAVIEST: i64 = 1 << 58;

/// The buffers of restitution.
#[derive(Clone, Debug, Default)]
pub(super) struct Bounces {
    /// Contacts that bounce: their place, and the velocities that both points aim at.
    hits: Vec<(usize, [i32; 2])>,
    /// Rows of bodies that bounce, with their body and the velocity before.
    bodies: Vec<(u32, u32, Vector)>,
    rows: Vec<u32>,
    /// Energies by island.
    energies: Vec<Energy>,
}

/// Twice the kinetic energy of the bodies of an island that bounce, as a polynomial of the factor.
#[derive(Clone, Copy, Debug, Default)]
struct Energy {
    /// The energy of the free flight.
    free: i128,
    before: i128,
    linear: i128,
    square: i128,
    /// The factor of impulses, once all bodies are added.
    factor: i64,
}

impl Energy {
    fn add(&mut self, mass: i64, free: i32, before: i32, after: i32) {
        let [free, before, change] = [free, before, after - before].map(i128::from);
        let mass = i128::from(mass);
        self.free += mass * free * free;
        self.before += mass * before * before;
        self.linear += 2 * mass * before * change;
        self.square += mass * change * change;
    }

    /// The largest factor up to 1, in 2^-30, that adds no energy.
    fn largest_factor(&self) -> i64 {
        let room = (self.free - self.before).max(0);
        // Down to 62 bits: a product with the factor twice fits.
        let largest = [room, self.linear, self.square].map(i128::unsigned_abs).into_iter().max().unwrap_or_default();
        let down = (66 - largest.leading_zeros() as i32).max(0);
        let [room, linear, square] = [room, self.linear, self.square].map(|term| term >> down);
        let adds = |factor: i64| {
            let factor = i128::from(factor);
            linear * factor + ((square * factor) >> 30) * factor > room << 30
        };
        if !adds(ONE) {
            return ONE;
        }
        // A convex function that is not positive at 0: it leaves the room once.
        let (mut least, mut most) = (0, ONE);
        while most - least > 1 {
            let middle = (least + most) / 2;
            if adds(middle) { most = middle } else { least = middle }
        }
        least
    }
}

/// The row velocity of a lane along its normal rows, from the velocities of both bodies; rounded half up.
fn along_normals(group: &Group, lane: usize, a: Vector, b: Vector) -> [i64; 2] {
    let [nx, ny] = group.normal[lane].map(i64::from);
    let linear = nx * i64::from(b[0] - a[0]) + ny * i64::from(b[1] - a[1]);
    [0, 1].map(|row| {
        let [ka, kb] = group.arms[row][lane].map(i64::from);
        (linear + kb * i64::from(b[2]) - ka * i64::from(a[2]) + (1 << 29)) >> 30
    })
}

impl Solver {
    /// Bounces what met at speed. Returns the number of values that were cut off.
    pub(super) fn bounce(
        &mut self,
        clock: &Clock,
        options: &SolverOptions,
        flights: &[Flight],
        contacts: &[Contact],
    ) -> u64 {
        self.find_hits(clock, options, contacts);
        if self.bounces.hits.is_empty() {
            return 0;
        }
        let (solved, placed) = (self.groups.len(), self.places.len());
        self.set_bounces(clock, options, flights, contacts);
        let (groups, rows) = (&mut self.groups[solved..], &mut self.rows);
        let cut = simd::run(PassOver { pass: Pass::Bounce, groups, rows, touched: &self.bounces.rows });
        self.limit_energy(flights);
        for (hit, bounced) in (placed..self.places.len()).enumerate() {
            let (bounced, place) = (self.places[bounced], self.places[self.bounces.hits[hit].0]);
            let mover = self.graph.mover(contacts[place.contact as usize].bodies);
            let Some(island) = mover.and_then(|body| self.graph.island_of(body)) else { continue };
            let factor = self.bounces.energies[island as usize].factor;
            for k in 0..2 {
                let after = self.groups[bounced.group as usize].impulses[k][bounced.lane as usize];
                let group = &mut self.groups[place.group as usize];
                let change = after - group.impulses[k][place.lane as usize];
                group.applied[k][place.lane as usize] += change.signum() * ((change.abs() * factor) >> 30);
            }
        }
        self.groups.truncate(solved);
        self.places.truncate(placed);
        cut
    }

    /// Finds the contacts that bounce.
    fn find_hits(&mut self, clock: &Clock, options: &SolverOptions, contacts: &[Contact]) {
        self.bounces.hits.clear();
        for (index, place) in self.places.iter().enumerate() {
            let contact = &contacts[place.contact as usize];
            if contact.restitution.to_bits() <= 0 {
                continue;
            }
            let (group, lane) = (&self.groups[place.group as usize], place.lane as usize);
            let [a, b] = [group.a[lane], group.b[lane]];
            let (of_a, of_b) = (self.rows.flight(a), self.rows.flight(b));
            let closing = along_normals(group, lane, of_a.start, of_b.start);
            let change = along_normals(group, lane, of_a.change, of_b.change);
            let moved = along_normals(group, lane, self.rows.displacement(a), self.rows.displacement(b));
            let Some(mover) = self.graph.mover(contact.bodies) else { continue };
            let unit = self.unit_of[mover as usize];
            let threshold = shifted(options.restitution_speed.to_bits().into(), 32 + unit) as i64;
            let mut hits = false;
            let aims = [0, 1].map(|k| {
                let separation = i64::from(group.separation[lane][k]);
                let had_impulse = group.applied[k][lane] > 0 || group.weighted[k][lane] > 0;
                if k >= contact.count || closing[k] >= -threshold || !had_impulse {
                    return (separation + moved[k]).clamp(0, SPECULATIVE.into()) as i32;
                }
                hits = true;
                // Below 2^61: velocities are below 2^29.3, the separation below 2^29.5.
                let gained = 2 * change[k] * separation.max(0) / i64::from(clock.substeps);
                let speed = (closing[k] * closing[k] - gained).max(0).unsigned_abs().isqrt();
                let aim = (u128::from(speed) * contact.restitution.to_bits() as u128 + (1 << 31)) >> 32;
                -(aim.min(SPECULATIVE as u128) as i32)
            });
            if hits {
                self.bounces.hits.push((index, aims));
            }
        }
    }

    /// Makes groups of the contacts that bounce, beyond those of the phases: each moves its share of both bodies.
    fn set_bounces(&mut self, clock: &Clock, options: &SolverOptions, flights: &[Flight], contacts: &[Contact]) {
        let softness = Softness::new(options);
        self.shares.clear();
        self.shares.resize(flights.len(), 0);
        self.bounces.bodies.clear();
        self.bounces.rows.clear();
        for &(place, _) in &self.bounces.hits {
            for body in contacts[self.places[place].contact as usize].bodies {
                let (count, row) = (&mut self.shares[body as usize], self.row_of[body as usize]);
                *count += 1;
                if *count == 1 && self.graph.island_of(body).is_some() {
                    self.bounces.bodies.push((row, body, self.rows.velocity(row)));
                    self.bounces.rows.push(row);
                }
            }
        }
        let begin = self.groups.len();
        for hit in 0..self.bounces.hits.len() {
            let (place, aims) = self.bounces.hits[hit];
            let place = self.places[place];
            let contact = place.contact as usize;
            self.push(begin, contact, &contacts[contact], (clock, &softness), flights);
            let before = [0, 1, 2].map(|k| self.groups[place.group as usize].impulses[k][place.lane as usize]);
            let group = self.groups.last_mut().expect("one was just pushed to");
            let lane = group.count - 1;
            group.separation[lane] = aims;
            (0..3).for_each(|k| group.impulses[k][lane] = before[k]);
        }
        debug_assert!(self.phases[PHASES - 1].end == begin, "bounces come after the phases");
    }

    /// Sums up the energies of islands, before and after.
    fn limit_energy(&mut self, flights: &[Flight]) {
        let Bounces { bodies, energies, .. } = &mut self.bounces;
        energies.clear();
        energies.resize(self.graph.islands, Energy::default());
        // Below 2^58 · 2^54 a component, and 2^13 bodies of that.
        let down = (bits_of(bodies.len() as i64) - 13).max(0);
        for &(row, body, before) in bodies.iter() {
            let (flight, free, after) = (&flights[body as usize], self.rows.flight(row), self.rows.velocity(row));
            let Some(island) = self.graph.island_of(body) else { continue };
            let inertia_bits = 32 - 2 * flight.length();
            let is_large = exponent(flight.inertia) + inertia_bits > 58;
            let inertia = if is_large { HEAVIEST } else { fixed(flight.inertia, inertia_bits) };
            let [mass, inertia] = [flight.mass.to_bits().min(HEAVIEST), inertia].map(|m| m >> down);
            for (k, mass) in [mass, mass, inertia].into_iter().enumerate() {
                energies[island as usize].add(mass, free.start[k] + free.change[k], before[k], after[k]);
            }
        }
        for energy in energies {
            energy.factor = energy.largest_factor();
        }
    }
}
