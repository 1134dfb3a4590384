//! Restitution: what met at speed moves apart, once a step and all at the same time. The rules are those of the solver in integers: an
//! impact returns a share of the impulse that the passes found, and an island gains no energy by it.

use alloc::vec::Vec;

use super::body::{Body, Flight};
use super::number::{Float, Pair, Vector};
use super::rows::{Contact, Rows};
use super::solver::Clock;
use crate::solve::{Graph, PHASES};

/// The buffers of restitution.
#[derive(Debug, Default)]
pub(super) struct Bounces<F> {
    /// Contacts with impacts: their phase and their place in it, and the impulses that both points return.
    impacts: Vec<(usize, usize, Pair<F>)>,
    /// Sums of the returned impulses, by body.
    impulses: Vec<Option<Vector<F>>>,
    /// Energies by island.
    energies: Vec<Energy<F>>,
}

/// Twice the kinetic energy of the bodies of an island that bounce, as a polynomial of the factor of the impulses.
#[derive(Clone, Copy, Debug, Default)]
struct Energy<F> {
    /// The energy of the free flight above that before the bounce.
    room: F,
    linear: F,
    square: F,
}

impl<F: Float> Energy<F> {
    /// Adds a component of a velocity.
    fn add(&mut self, mass: F, free: F, before: F, change: F) {
        self.room += mass * (free - before) * (free + before);
        self.linear += F::of(2.0) * mass * before * change;
        self.square += mass * change * change;
    }

    /// Adds twice the work that a fixed body does by the impulses before and by those that are returned, at its velocity along the row.
    fn add_work(&mut self, velocity: F, before: F, returned: F) {
        self.room += F::of(-2.0) * before * velocity;
        self.linear += F::of(2.0) * returned * velocity;
    }

    /// The largest factor up to 1 that adds no energy.
    fn largest_factor(&self) -> F {
        let Self { room, linear, square } = *self;
        let room = room.or_more(F::of(0.0));
        if linear + square <= room {
            return F::of(1.0);
        }
        // A convex function that is not positive at 0: the root above.
        let root = (linear * linear + F::of(4.0) * square * room).root();
        let factor = if linear > F::of(0.0) {
            F::of(2.0) * room / (linear + root)
        } else {
            (root - linear) / (F::of(2.0) * square)
        };
        if factor.is_finite() { factor.or_less(F::of(1.0)) } else { F::of(0.0) }
    }
}

/// An impact at a point. Separations are over the length of a sub-step.
struct Impact<F> {
    /// The impulse that it has had.
    impulse: F,
    /// The relative velocity at the start, negative: the points close.
    closing: F,
    /// Its change by the free flight over the step.
    change: F,
    /// The separation at the start and at the end.
    separations: Pair<F>,
    /// True if only the last relax pass acted on it.
    is_late: bool,
}

impl<F: Float> Impact<F> {
    /// The impulse that is returned, for a step of `substeps`.
    fn returned(&self, restitution: F, substeps: u32) -> F {
        let zero = F::of(0.0);
        let gained = |separation: F| F::of(2.0) * self.change * separation.or_more(zero) / F::of(substeps.into());
        // A relax pass stops what would overlap in the next sub-step, above the surface.
        let gap = if self.is_late { self.separations[1].or_more(zero) } else { zero };
        let arrived = (self.closing * self.closing - gained(self.separations[0])).or_more(zero);
        // The velocity at the end of the free flight, or that of the impact if the flight slows down after it.
        let free = -(self.closing + self.change);
        let slows_down = self.change > zero && !self.is_late;
        let most = if slows_down { free.or_more(arrived.root()) } else { free };
        let taken = most - gap;
        let left = restitution * restitution * arrived + gained(gap);
        if taken <= zero || taken < most * F::of(0.125) || (gap > zero && left <= zero) {
            return -self.impulse;
        }
        let aim = left.or_more(zero).root();
        // More than this is asked for only by fields that stop a body within the step.
        (self.impulse * (aim + gap) / taken).or_less(F::of(16.0) * self.impulse)
    }
}

/// Bodies and contacts after the passes.
#[derive(Clone, Copy)]
pub(super) struct Passed<'a, F> {
    pub(super) flights: &'a [Flight<F>],
    pub(super) bodies: &'a [Body<F>],
    pub(super) contacts: &'a [Contact<F>],
}

impl<F: Float> Bounces<F> {
    /// Returns a part of the impulses of impacts.
    pub(super) fn run(
        &mut self,
        (clock, threshold): (Clock<F>, F),
        graph: &Graph,
        Passed { flights, bodies, contacts }: Passed<'_, F>,
        phases: &mut [Vec<Rows<F>>; PHASES],
    ) {
        self.impacts.clear();
        for (phase, rows) in phases.iter().enumerate() {
            for (at, row) in rows.iter().enumerate() {
                let contact = &contacts[row.contact as usize];
                if let Some(returned) = returned(row, contact, bodies, clock, threshold) {
                    self.impacts.push((phase, at, returned));
                }
            }
        }
        if self.impacts.is_empty() {
            return;
        }
        self.add_energies(graph, flights, bodies, phases);
        for &(phase, at, returned) in &self.impacts {
            let row = &mut phases[phase][at];
            let Some(island) = graph.mover(row.bodies).and_then(|body| graph.island_of(body)) else { continue };
            let factor = self.energies[island as usize].largest_factor();
            for (k, returned) in returned.into_iter().enumerate().filter(|(_, returned)| *returned != F::of(0.0)) {
                row.applied[k] += returned * factor;
                // The points part, so that the next step does not start from this impulse.
                row.impulses[k] = F::of(0.0);
            }
            // Friction stays within its cone.
            let limit = row.friction * (row.impulses[0] + row.impulses[1]);
            row.impulses[2] = row.impulses[2].within(limit);
        }
    }

    /// Sums up the returned impulses by body, and the energies of islands before and after.
    fn add_energies(
        &mut self,
        graph: &Graph,
        flights: &[Flight<F>],
        bodies: &[Body<F>],
        phases: &[Vec<Rows<F>>; PHASES],
    ) {
        self.impulses.clear();
        self.impulses.resize(flights.len(), None);
        for &(phase, at, [p1, p2]) in &self.impacts {
            let row = &phases[phase][at];
            for (body, on) in row.bodies.into_iter().zip(row.on_bodies([p1, p2, F::of(0.0)])) {
                let sums = self.impulses[body as usize].get_or_insert([F::of(0.0); 3]);
                (0..3).for_each(|c| sums[c] += on[c]);
            }
        }
        self.energies.clear();
        self.energies.resize(graph.islands(), Energy::default());
        for &(phase, at, returned) in &self.impacts {
            let row = &phases[phase][at];
            let Some(island) = graph.mover(row.bodies).and_then(|body| graph.island_of(body)) else { continue };
            let carried = row.bodies.map(|body| match graph.island_of(body) {
                Some(_) => [F::of(0.0); 3],
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
                let (free, change) = (body.start[c] + body.change[c], *impulse * body.inverse[c]);
                energy.add(flights[i].mass[c], free, body.velocity[c], change);
            }
        }
    }
}

/// The impulses that the points of a contact return which have met at speed.
fn returned<F: Float>(
    row: &Rows<F>,
    contact: &Contact<F>,
    bodies: &[Body<F>],
    clock: Clock<F>,
    threshold: F,
) -> Option<Pair<F>> {
    let zero = F::of(0.0);
    if contact.restitution <= zero {
        return None;
    }
    let sides = row.bodies.map(|body| &bodies[body as usize]);
    let mut returned = [zero; 2];
    for (k, returned) in returned.iter_mut().enumerate().take(contact.manifold.count) {
        let closing = row.along(k, sides.map(|body| body.start));
        if closing < -threshold && row.applied[k] > zero {
            let moved = row.along(k, sides.map(|body| body.displacement));
            let separation = row.separation[k];
            let impact = Impact {
                impulse: row.applied[k],
                closing,
                change: row.along(k, sides.map(|body| body.change)),
                separations: [separation, separation + moved].map(|s| s / clock.substep),
                is_late: row.weighted[k] == zero,
            };
            *returned = impact.returned(contact.restitution, clock.substeps);
        }
    }
    (returned != [zero; 2]).then_some(returned)
}
