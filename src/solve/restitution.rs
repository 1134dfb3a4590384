//! Restitution: what met at speed moves apart, once a step and all at the same time.
//!
//! A point has an impact if it closed faster than the threshold at the start of the step and has had an impulse since. The impact
//! returns a share of that impulse (Poisson's hypothesis): the passes have found how much of it each body takes where many touch, and
//! a pair of bodies gets the velocities of Newton's hypothesis. The share is e·v over the velocity that the passes took
//! away, where v is the speed at the moment of the impact: v² = v0² + 2·a·s0, with the relative acceleration a of the free flight,
//! positive where it closes the gap, and the separation s0 at the start. (With v0 alone each bounce would lose the speed gained in the
//! tick of the impact.)
//!
//! A point that the last relax pass stopped at a gap s above the surface bounces there: at e²·v² − 2·a·s, as it would pass by on the
//! way up. If it does not rise as high, or if less than an eighth of its velocity was taken away, the impulse is taken back
//! instead: the point arrives in the next step.
//!
//! Impulses at the same time may add energy. So those of an island are scaled by the largest factor up to 1 for which the kinetic
//! energy is at most that of the free flight, or that before the bounce if it is larger, and the work of kinematic bodies: a paddle
//! gives its own speed and the rebound.

use alloc::vec::Vec;

use super::apply::{on_bodies, shifted_within};
use super::contact::Group;
use super::motion::Vector;
use super::number::{bits_of, exponent, fixed, shifted};
use super::unit::Clock;
use super::{Contact, Flight, Solver, SolverOptions};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift_64;
use crate::scalar::FxFactor;

/// One, as a factor of impulses.
const ONE: i64 = 1 << 30;
/// The largest mass or inertia over R² in 2^-32 kg.
const HEAVIEST: i64 = 1 << 58;
/// The largest change of velocity that counts.
const LARGEST_CHANGE: i128 = 1 << 28;

/// The buffers of restitution.
#[derive(Clone, Debug, Default)]
pub(super) struct Bounces {
    /// Contacts with impacts: their place, and the impulses that both points return.
    impacts: Vec<(usize, [i64; 2])>,
    /// The bodies of these contacts.
    bodies: Vec<u32>,
    /// Sums of the returned impulses, by body, in 2^-64 N·s and N·m·s.
    impulses: Vec<Option<[i128; 3]>>,
    /// Energies by island.
    energies: Vec<Energy>,
}

/// Twice the kinetic energy of the bodies of an island that bounce, as a polynomial of the factor.
#[derive(Clone, Copy, Debug, Default)]
struct Energy {
    /// The number of bodies and impacts.
    terms: i64,
    /// The energy of the free flight.
    free: i128,
    before: i128,
    linear: i128,
    square: i128,
    /// The factor of impulses, once all bodies are added.
    factor: i64,
}

impl Energy {
    /// The bits that masses and works are shifted down by. Components are below 2^58 · 2^57 and works below 2^111, as are 2^10 bodies and
    /// impacts of that.
    fn down(&self) -> i32 {
        (bits_of(self.terms) - 10).max(0)
    }

    fn add(&mut self, mass: i64, free: i32, before: i32, change: i32) {
        let [free, before, change] = [free, before, change].map(i128::from);
        let mass = i128::from(mass);
        self.free += mass * free * free;
        self.before += mass * before * before;
        self.linear += 2 * mass * before * change;
        self.square += mass * change * change;
    }

    /// Adds twice the work of a fixed body by the impulses before, and by those that are returned.
    fn add_work(&mut self, [before, returned]: [i128; 2]) {
        self.free -= 2 * before;
        self.linear += 2 * returned;
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

/// An impact at a point, in units of the island.
struct Impact {
    /// The impulse that it has had.
    impulse: i64,
    /// The relative velocity at the start, negative: the points close.
    closing: i64,
    /// The change by the free flight over the step.
    change: i64,
    /// The separation at the start and at the end.
    separations: [i64; 2],
    /// True if only the last relax pass acted on it.
    is_late: bool,
}

impl Impact {
    /// The impulse that is returned, for a step of `substeps`.
    fn returned(&self, restitution: Fx, substeps: u32) -> i64 {
        let gained = |separation: i64| 2 * self.change * separation.max(0) / i64::from(substeps);
        // A relax pass stops what would overlap in the next sub-step, above the surface.
        let gap = if self.is_late { self.separations[1].max(0) } else { 0 };
        // Velocities are below 2^29.3, their changes below 2^30.3, separations below 2^31: products below 2^62.3.
        let arrived = (self.closing * self.closing - gained(self.separations[0])).max(0);
        // The velocity at the end of the free flight, or that of the impact if the flight slows down after it.
        let free = -(self.closing + self.change);
        let slows_down = self.change > 0 && !self.is_late;
        let most = if slows_down { free.max(arrived.unsigned_abs().isqrt() as i64) } else { free };
        let taken = most - gap;
        let share = |square: i64| ((i128::from(square) * i128::from(restitution.to_bits())) >> 32) as i64;
        let left = share(share(arrived)) + gained(gap);
        if taken <= 0 || taken < most / 8 || (gap > 0 && left <= 0) {
            return -self.impulse;
        }
        let aim = left.max(0).unsigned_abs().isqrt() as i64;
        // More than this is asked for only by fields that stop a body within the step. The impulse is below 2^48.
        let most = 16 * i128::from(self.impulse);
        (i128::from(self.impulse) * i128::from(aim + gap) / i128::from(taken)).min(most) as i64
    }
}

impl Solver {
    /// Returns a part of the impulses of impacts.
    pub(super) fn bounce(&mut self, clock: &Clock, options: &SolverOptions, flights: &[Flight], contacts: &[Contact]) {
        self.find_impacts(clock, options, contacts);
        if self.bounces.impacts.is_empty() {
            return;
        }
        self.add_returned(flights, contacts);
        self.limit_energy(flights, contacts);
        for &(place, returned) in &self.bounces.impacts {
            let place = &self.places[place];
            let Some(island) = self.island_of(&contacts[place.contact as usize]) else { continue };
            let factor = i128::from(self.bounces.energies[island].factor);
            let (group, lane) = (&mut self.groups[place.group as usize], place.lane as usize);
            for (k, returned) in returned.into_iter().enumerate().filter(|&(_, returned)| returned != 0) {
                group.applied[k][lane] += ((i128::from(returned) * factor) >> 30) as i64;
                // The points part, so that the next step does not start from this impulse.
                group.impulses[k][lane] = 0;
            }
            // Friction stays within its cone.
            let [_, mu] = group.friction[lane].map(i128::from);
            let limit = ((mu * i128::from(group.impulses[0][lane] + group.impulses[1][lane])) >> 26) as i64;
            group.impulses[2][lane] = group.impulses[2][lane].clamp(-limit, limit);
        }
    }

    fn island_of(&self, contact: &Contact) -> Option<usize> {
        let mover = self.graph.mover(contact.bodies)?;
        self.graph.island_of(mover).map(|island| island as usize)
    }

    /// Finds the points that have met at speed, and the impulses that they return.
    fn find_impacts(&mut self, clock: &Clock, options: &SolverOptions, contacts: &[Contact]) {
        self.bounces.impacts.clear();
        for (index, place) in self.places.iter().enumerate() {
            let contact = &contacts[place.contact as usize];
            if contact.restitution.to_bits() <= 0 {
                continue;
            }
            let Some(mover) = self.graph.mover(contact.bodies) else { continue };
            let unit = self.unit_of[mover as usize];
            let threshold = shifted(options.restitution_speed.to_bits().into(), 32 + unit) as i64;
            let (group, lane) = (&self.groups[place.group as usize], place.lane as usize);
            let [a, b] = [group.a[lane], group.b[lane]];
            let (of_a, of_b) = (self.rows.flight(a), self.rows.flight(b));
            let closing = along_normals(group, lane, of_a.start, of_b.start);
            let is_impact = |k: usize| closing[k] < -threshold && group.applied[k][lane] > 0;
            if !(0..contact.count).any(is_impact) {
                continue;
            }
            let change = along_normals(group, lane, of_a.change, of_b.change);
            let moved = along_normals(group, lane, self.rows.displacement(a), self.rows.displacement(b));
            let mut returned = [0; 2];
            for k in (0..contact.count).filter(|&k| is_impact(k)) {
                let separation = i64::from(group.separation[lane][k]);
                let impact = Impact {
                    impulse: group.applied[k][lane],
                    closing: closing[k],
                    change: change[k],
                    separations: [separation, separation + moved[k]],
                    is_late: group.weighted[k][lane] == 0,
                };
                returned[k] = impact.returned(contact.restitution, clock.substeps);
            }
            if returned != [0; 2] {
                self.bounces.impacts.push((index, returned));
            }
        }
    }

    /// Sums up the returned impulses by body.
    fn add_returned(&mut self, flights: &[Flight], contacts: &[Contact]) {
        let Bounces { impacts, bodies, impulses, .. } = &mut self.bounces;
        impulses.clear();
        impulses.resize(flights.len(), None);
        bodies.clear();
        for &(place, [p1, p2]) in impacts.iter() {
            let place = &self.places[place];
            let contact = &contacts[place.contact as usize];
            let group = &self.groups[place.group as usize];
            let lengths = contact.bodies.map(|body| flights[body as usize].length());
            let on = on_bodies(group, place.lane as usize, place.exponent, [p1, p2, 0], lengths);
            for (body, on) in contact.bodies.into_iter().zip(on) {
                if self.graph.island_of(body).is_none() {
                    continue;
                }
                let sums = impulses[body as usize].get_or_insert_with(|| {
                    bodies.push(body);
                    [0; 3]
                });
                sums.iter_mut().zip(on).for_each(|(sum, value)| *sum += value);
            }
        }
    }

    /// Sums up the energies of islands, before and after, and finds their factors.
    fn limit_energy(&mut self, flights: &[Flight], contacts: &[Contact]) {
        let Bounces { impacts, bodies, impulses, energies } = &mut self.bounces;
        energies.clear();
        energies.resize(self.graph.islands(), Energy::default());
        let island_of =
            |body: u32| self.graph.island_of(body).expect("bodies that can be moved are in islands") as usize;
        bodies.iter().for_each(|&body| energies[island_of(body)].terms += 1);
        let movers = impacts
            .iter()
            .filter_map(|&(place, _)| self.graph.mover(contacts[self.places[place].contact as usize].bodies));
        movers.for_each(|mover| energies[island_of(mover)].terms += 1);
        for &body in bodies.iter() {
            let (flight, row) = (&flights[body as usize], self.row_of[body as usize]);
            let (free, before) = (self.rows.flight(row), self.rows.velocity(row));
            let energy = &mut energies[island_of(body)];
            let down = energy.down();
            let (unit, length) = (self.unit_of[body as usize], flight.length());
            let inertia_bits = 32 - 2 * length;
            let is_large = exponent(flight.inertia) + inertia_bits > 58;
            let inertia = if is_large { HEAVIEST } else { fixed(flight.inertia, inertia_bits) };
            let mass = flight.mass.to_bits().min(HEAVIEST);
            let components = [
                (mass, flight.inverse_mass.x, unit),
                (mass, flight.inverse_mass.y, unit),
                (inertia, flight.inverse_inertia, unit - length),
            ];
            let impulses = impulses[body as usize].unwrap_or_default();
            for (k, (mass, inverse, unit)) in components.into_iter().enumerate() {
                let change = change_of(impulses[k], inverse, unit);
                energy.add(mass >> down, free.start[k] + free.change[k], before[k], change);
            }
        }
        for &(place, returned) in impacts.iter() {
            let place = &self.places[place];
            let contact = &contacts[place.contact as usize];
            let Some(mover) = self.graph.mover(contact.bodies) else { continue };
            let energy = &mut energies[island_of(mover)];
            let (group, lane) = (&self.groups[place.group as usize], place.lane as usize);
            let rows = [group.a[lane], group.b[lane]];
            let [a, b] = [0, 1].map(|side| {
                let is_fixed = self.graph.island_of(contact.bodies[side]).is_none();
                if is_fixed { self.rows.flight(rows[side]).start } else { Vector::default() }
            });
            let carried = along_normals(group, lane, a, b);
            // From 2^exponent N·s to 2^(unit − 32) kg·m/s.
            let bits = self.unit_of[mover as usize] - 32 - place.exponent;
            for k in (0..contact.count).filter(|&k| carried[k] != 0) {
                // Impulses are below 2^62, velocities below 2^30.
                let work =
                    |impulse: i64| shifted_within(i128::from(impulse) * i128::from(carried[k]), bits) >> energy.down();
                let works = [work(group.applied[k][lane]), work(returned[k])];
                energy.add_work(works);
            }
        }
        for energy in energies {
            energy.factor = energy.largest_factor();
        }
    }
}

/// The change of velocity by an impulse in 2^-64 N·s, in 2^unit.
fn change_of(impulse: i128, factor: FxFactor, unit: i32) -> i32 {
    let (mantissa, shift) = factor.parts();
    let most = impulse.signum() * LARGEST_CHANGE;
    let change = mul_shift_64(impulse, mantissa, shift + 64 + unit).unwrap_or(most);
    change.clamp(-LARGEST_CHANGE, LARGEST_CHANGE) as i32
}
