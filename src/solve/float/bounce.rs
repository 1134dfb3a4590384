//! Restitution: points that met at speed move apart, once a step and all at the same time. The rules are the rules of the solver in
//! integers: an impact returns a share of the impulse that the passes found, joints answer it, and an island gains no energy by it.

use alloc::vec::Vec;

use super::body::Body;
use super::joints::Joints;
use super::rows::Rows;
use super::{Clock, Pair, Vector, within};
use crate::scalar::ToF64 as _;
use crate::solve::{Flight, Graph, PHASES};

/// The buffers of restitution.
#[derive(Debug, Default)]
pub(super) struct Bounces {
    /// Contacts with impacts: their phase and their place in it, and the impulses that both points return.
    impacts: Vec<(usize, usize, Pair)>,
    /// Sums of the returned impulses, by body.
    impulses: Vec<Option<Vector>>,
    /// Energies by island.
    energies: Vec<Energy>,
}

/// Twice the kinetic energy of the bodies of an island that bounce, as a polynomial of the factor of the impulses.
#[derive(Clone, Copy, Debug, Default)]
struct Energy {
    /// The energy of the free flight above the energy before the bounce.
    room: f64,
    linear: f64,
    square: f64,
}

impl Energy {
    /// Adds a component of a velocity.
    fn add(&mut self, mass: f64, free: f64, before: f64, change: f64) {
        self.room += mass * (free - before) * (free + before);
        self.linear += 2.0 * mass * before * change;
        self.square += mass * change * change;
    }

    /// Adds twice the work that a fixed body does by the impulses before and by the returned ones, at its velocity along the row.
    fn add_work(&mut self, velocity: f64, before: f64, returned: f64) {
        self.room += -2.0 * before * velocity;
        self.linear += 2.0 * returned * velocity;
    }

    /// The largest factor up to 1 that adds no energy.
    fn largest_factor(&self) -> f64 {
        let Self { room, linear, square } = *self;
        let room = room.max(0.0);
        if linear + square <= room {
            return 1.0;
        }
        // A convex function that is not positive at 0: the root above.
        let root = libm::sqrt(linear * linear + 4.0 * square * room);
        let factor = if linear > 0.0 { 2.0 * room / (linear + root) } else { (root - linear) / (2.0 * square) };
        if factor.is_finite() { factor.min(1.0) } else { 0.0 }
    }
}

/// An impact at a point. Separations are over the length of a sub-step.
struct Impact {
    /// The impulse that it has had.
    impulse: f64,
    /// The relative velocity at the start, negative: the points close.
    closing: f64,
    /// Its change by the free flight over the step.
    change: f64,
    /// The separation at the start and at the end.
    separations: Pair,
    /// True if only the last relax pass acted on it.
    is_late: bool,
}

impl Impact {
    /// The impulse that is returned, for a step of `substeps`.
    fn returned(&self, restitution: f64, substeps: u32) -> f64 {
        let gained = |separation: f64| 2.0 * self.change * separation.max(0.0) / f64::from(substeps);
        // A relax pass stops points that would overlap in the next sub-step, above the surface.
        let gap = if self.is_late { self.separations[1].max(0.0) } else { 0.0 };
        let arrived = (self.closing * self.closing - gained(self.separations[0])).max(0.0);
        // The velocity at the end of the free flight, or at the impact if the flight slows down after it.
        let free = -(self.closing + self.change);
        let slows_down = self.change > 0.0 && !self.is_late;
        let approach = if slows_down { free.max(libm::sqrt(arrived)) } else { free };
        let taken = approach - gap;
        let left = restitution * restitution * arrived + gained(gap);
        if taken <= 0.0 || taken < approach * 0.125 || (gap > 0.0 && left <= 0.0) {
            return -self.impulse;
        }
        let aim = libm::sqrt(left.max(0.0));
        // More than this is asked for only by fields that stop a body within the step.
        (self.impulse * (aim + gap) / taken).min(16.0 * self.impulse)
    }
}

impl Bounces {
    /// Returns a part of the impulses of impacts that closed faster than `threshold` m/s.
    pub(super) fn run(
        &mut self,
        clock: Clock,
        threshold: f64,
        graph: &Graph,
        flights: &[Flight],
        bodies: &[Body],
        joints: &mut Joints,
        phases: &mut [Vec<Rows>; PHASES],
    ) {
        self.impacts.clear();
        for (phase, rows) in phases.iter().enumerate() {
            for (index, row) in rows.iter().enumerate() {
                if let Some(returned) = returned(row, bodies, clock, threshold) {
                    self.impacts.push((phase, index, returned));
                }
            }
        }
        if self.impacts.is_empty() {
            return;
        }
        self.sum_impulses(flights.len(), phases);
        joints.answer(&mut self.impulses, bodies, clock);
        self.add_energies(graph, flights, bodies, phases);
        joints.add_answers(|ends| {
            let island = graph.island_of_link(ends);
            island.map_or(0.0, |island| self.energies[island as usize].largest_factor())
        });
        for &(phase, index, returned) in &self.impacts {
            let row = &mut phases[phase][index];
            let Some(island) = graph.island_of_link(row.bodies) else { continue };
            let factor = self.energies[island as usize].largest_factor();
            for (k, returned) in returned.into_iter().enumerate().filter(|(_, returned)| *returned != 0.0) {
                row.applied[k] += returned * factor;
                // The points part, so that the next step does not start from this impulse.
                row.impulses[k] = 0.0;
            }
            // Friction stays within its cone.
            let limit = row.friction * (row.impulses[0] + row.impulses[1]);
            row.impulses[2] = within(row.impulses[2], limit);
        }
    }

    /// Sums up the returned impulses by body.
    fn sum_impulses(&mut self, bodies: usize, phases: &[Vec<Rows>; PHASES]) {
        self.impulses.clear();
        self.impulses.resize(bodies, None);
        for &(phase, index, [p1, p2]) in &self.impacts {
            let row = &phases[phase][index];
            for (body, impulse) in row.bodies.into_iter().zip(row.on_bodies([p1, p2, 0.0])) {
                let sums = self.impulses[body as usize].get_or_insert([0.0; 3]);
                (0..3).for_each(|c| sums[c] += impulse[c]);
            }
        }
    }

    /// Sums up the energies of islands before and after.
    fn add_energies(&mut self, graph: &Graph, flights: &[Flight], bodies: &[Body], phases: &[Vec<Rows>; PHASES]) {
        self.energies.clear();
        self.energies.resize(graph.islands(), Energy::default());
        for &(phase, index, returned) in &self.impacts {
            let row = &phases[phase][index];
            let Some(island) = graph.island_of_link(row.bodies) else { continue };
            let carried = row.bodies.map(|body| match graph.island_of(body) {
                Some(_) => [0.0; 3],
                None => bodies[body as usize].start,
            });
            for (k, returned) in returned.into_iter().enumerate() {
                let velocity = row.along(k, carried);
                self.energies[island as usize].add_work(velocity, row.applied[k], returned);
            }
        }
        for (i, (body, impulses)) in bodies.iter().zip(&self.impulses).enumerate() {
            let (Some(impulses), Some(island)) = (impulses, graph.island_of(i as u32)) else { continue };
            let energy = &mut self.energies[island as usize];
            for (c, impulse) in impulses.iter().enumerate() {
                let inverse_inertia = body.inverse_mass[2];
                let mass = match c {
                    0 | 1 => flights[i].mass.to_f64(),
                    _ if inverse_inertia > 0.0 => inverse_inertia.recip(),
                    _ => 0.0,
                };
                let free = body.start[c] + body.change[c];
                let change = *impulse * body.inverse_mass[c];
                energy.add(mass, free, body.velocity[c], change);
            }
        }
    }
}

/// The impulses that the points of a contact return that have met at speed.
fn returned(row: &Rows, bodies: &[Body], clock: Clock, threshold: f64) -> Option<Pair> {
    if row.restitution <= 0.0 {
        return None;
    }
    let sides = row.bodies.map(|body| &bodies[body as usize]);
    let mut returned = [0.0; 2];
    for (k, returned) in returned.iter_mut().enumerate().take(if row.is_double { 2 } else { 1 }) {
        let closing = row.along(k, sides.map(|body| body.start));
        if closing < -threshold && row.applied[k] > 0.0 {
            let moved = row.along(k, sides.map(|body| body.displacement));
            let separation = row.separation[k];
            let impact = Impact {
                impulse: row.applied[k],
                closing,
                change: row.along(k, sides.map(|body| body.change)),
                separations: [separation, separation + moved].map(|s| s / clock.length),
                is_late: row.weighted[k] == 0.0,
            };
            *returned = impact.returned(row.restitution, clock.substeps);
        }
    }
    (returned != [0.0; 2]).then_some(returned)
}
