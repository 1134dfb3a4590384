//! The solver in floats: TGS soft on top of the free flight, as in integers.

use alloc::vec::Vec;

use super::body::{Body, Flight, seconds};
use super::bounce::{Bounces, Passed};
use super::number::{Float, Pair, dot, minus, plus, times};
use super::rolling::Roll;
use super::rows::{Contact, Pass, Rows, Softness};
use crate::collider::ContactSettings;
use crate::contact::Correction;
use crate::math::TimeStep;
use crate::solve::{Graph, PHASES};

/// The buffers of the solver. Results do not depend on what it solved before.
#[derive(Debug, Default)]
pub(super) struct Solver<F> {
    pub(super) graph: Graph,
    bodies: Vec<Body<F>>,
    phases: [Vec<Rows<F>>; PHASES],
    rolls: [Vec<Roll<F>>; PHASES],
    /// The bodies with contacts, and the number of these, by phase.
    touched: [Vec<u32>; PHASES],
    shares: Vec<u32>,
    pub(super) bounces: Bounces<F>,
    /// Bodies with their leaders.
    followers: Vec<[u32; 2]>,
}

/// A step and its sub-steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock<F> {
    /// The length of a sub-step, s.
    pub(super) substep: F,
    pub(super) substeps: u32,
}

impl<F: Float> Clock<F> {
    pub(super) fn new(time_step: TimeStep, substeps: u32) -> Self {
        Self { substep: seconds::<F>(time_step) / F::of(substeps.into()), substeps }
    }
}

impl<F: Float> Solver<F> {
    /// Solves a step: writes the impulses to the contacts, and keeps the sums of bodies.
    pub(super) fn solve(
        &mut self,
        clock: Clock<F>,
        settings: &ContactSettings<F>,
        flights: &[Flight<F>],
        contacts: &mut [Contact<F>],
    ) {
        self.prepare(settings, flights, contacts);
        let n = clock.substeps;
        for k in 1..=n {
            self.bodies.iter_mut().for_each(|body| body.begin(k, n));
            self.follow();
            if k == 1 {
                self.pass(clock.substep, Pass::WarmStart);
            }
            self.pass(clock.substep, Pass::Solve);
            self.bodies.iter_mut().for_each(|body| body.advance(clock.substep));
            self.follow();
            self.pass(clock.substep, Pass::Relax);
        }
        let passed = Passed { flights, bodies: &self.bodies, contacts };
        self.bounces.run((clock, settings.restitution_speed), &self.graph, passed, &mut self.phases);
        self.apply(contacts);
    }

    /// The changes of bodies after [`solve`](Self::solve).
    pub(super) fn corrections(&self, clock: Clock<F>, flights: &[Flight<F>]) -> impl Iterator<Item = Correction<F>> {
        let bodies = self.bodies.iter().zip(flights);
        bodies.map(move |(body, flight)| body.correction(flight, clock.substep, clock.substeps))
    }

    /// The number of each contact, and its impulses along the normal over the step, by point.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, Pair<F>)> + '_ {
        self.phases.iter().flatten().map(|row| (row.contact, row.totals()))
    }

    /// Finds phases, and makes the rows of contacts.
    fn prepare(&mut self, settings: &ContactSettings<F>, flights: &[Flight<F>], contacts: &[Contact<F>]) {
        let links = contacts.iter().map(|contact| contact.bodies);
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        self.graph.build(is_fixed, flights.len(), links, |members, queue| graph_start(flights, members, queue));
        self.bodies.clear();
        self.bodies.extend(flights.iter().map(Body::new));
        self.followers.clear();
        self.followers.extend((0..).zip(flights).filter_map(|(body, flight)| Some([body, flight.leader?])));
        let softness = [false, true].map(|is_fixed| Softness::new(is_fixed, settings.push_speed));
        for phase in 0..PHASES {
            let own = || contacts.iter().enumerate().filter(|(_, contact)| self.graph.phase(contact.bodies) == phase);
            let (touched, rows) = (&mut self.touched[phase], &mut self.phases[phase]);
            touched.clear();
            rows.clear();
            self.shares.clear();
            self.shares.resize(flights.len(), 0);
            for body in own().flat_map(|(_, contact)| contact.bodies) {
                self.shares[body as usize] += 1;
                if self.shares[body as usize] == 1 {
                    touched.push(body);
                }
            }
            rows.extend(own().filter_map(|(number, contact)| {
                let bodies = contact.bodies.map(|body| &self.bodies[body as usize]);
                let shares = contact.bodies.map(|body| F::of(self.shares[body as usize].into()));
                Rows::new((number as u32, contact), bodies, shares, &softness)
            }));
            Roll::list(&mut self.rolls[phase], rows, contacts, &self.bodies);
        }
    }

    /// A pass over the contacts of all phases. Those of a phase do not see each other.
    fn pass(&mut self, substep: F, pass: Pass) {
        for ((rows, touched), rolls) in self.phases.iter_mut().zip(&self.touched).zip(&mut self.rolls) {
            rows.iter_mut().for_each(|row| row.run(&mut self.bodies, substep, pass));
            touched.iter().for_each(|&body| self.bodies[body as usize].take_gain());
            Roll::run(rolls, rows, &mut self.bodies, pass);
            follow(&self.followers, &mut self.bodies);
        }
    }

    /// Sets followers to the motion of their leaders.
    fn follow(&mut self) {
        follow(&self.followers, &mut self.bodies);
    }

    /// Writes the impulses of contacts and adds the sums of bodies.
    fn apply(&mut self, contacts: &mut [Contact<F>]) {
        contacts.iter_mut().for_each(|contact| contact.impulses = [F::of(0.0); 3]);
        self.add_rows(contacts);
        for (rolls, rows) in self.rolls.iter().zip(&self.phases) {
            Roll::apply(rolls, rows, contacts, &mut self.bodies);
        }
    }

    fn add_rows(&mut self, contacts: &mut [Contact<F>]) {
        for row in self.phases.iter().flatten() {
            contacts[row.contact as usize].impulses = row.impulses;
            let on = [row.on_bodies(row.applied), row.on_bodies(row.weighted)];
            for (side, body) in row.bodies.into_iter().enumerate() {
                let body = &mut self.bodies[body as usize];
                (0..3).for_each(|c| body.applied[c] += on[0][side][c]);
                (0..3).for_each(|c| body.weighted[c] += on[1][side][c]);
            }
        }
    }
}

fn follow<F: Float>(followers: &[[u32; 2]], bodies: &mut [Body<F>]) {
    for &[body, leader] in followers {
        let Body { velocity, displacement, .. } = bodies[leader as usize];
        let body = &mut bodies[body as usize];
        (body.velocity, body.displacement) = (velocity, displacement);
    }
}

/// The bodies at which the levels of an island begin that touches no fixed body: the heaviest ones; among these the nearest to
/// the island's centre of mass. Distances that differ by rounding are equal.
fn graph_start<F: Float>(flights: &[Flight<F>], members: &[u32], queue: &mut Vec<u32>) {
    let mass = |body: u32| flights[body as usize].mass[0];
    // From any member, so that large positions cost no bits.
    let origin = flights[members[0] as usize].position;
    let offset = |body: u32| minus(flights[body as usize].position, origin);
    let start = (F::of(0.0), F::of(0.0), [F::of(0.0); 2]);
    let (heaviest, total, sum) = members.iter().fold(start, |(heaviest, total, sum), &body| {
        (heaviest.or_more(mass(body)), total + mass(body), plus(sum, times(offset(body), mass(body))))
    });
    let centre: Pair<F> = times(sum, F::of(1.0) / total);
    let square = |body: u32| {
        let way = minus(offset(body), centre);
        dot(way, way)
    };
    let heavy = || members.iter().copied().filter(|&body| mass(body) == heaviest);
    let Some(nearest) = heavy().map(square).reduce(F::or_less) else { return };
    let size = dot(centre, centre) + nearest;
    queue.extend(heavy().filter(|&body| square(body) <= nearest + F::of(64.0) * F::EPSILON * size));
    if queue.is_empty() {
        // Without numbers that compare any body will do.
        queue.push(members[0]);
    }
}
