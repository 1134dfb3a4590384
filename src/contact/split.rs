//! Islands in which light bodies carry heavy ones: they are solved in finer sub-steps than the others.
//!
//! A soft contact is a spring: under the impulse P of a sub-step h it gives way by P·K·h/(hω)², where K is the sum of both inverse masses
//! and hω is the same for all contacts. A light body under a heavy one sinks in by that much: with 5 sub-steps of a step of 1/60 s four
//! boxes collapse under a fifth that is 1,000 times as heavy. The way is proportional to the square of the sub-step, so such an island
//! takes [`FINE`] sub-steps.
//!
//! Whether it does follows from masses and levels alone: a body lies on another one if it is farther, in contacts, from the bodies that
//! cannot be moved. (By the impulses of the step before, islands would change from one to the other and never rest: finer sub-steps push
//! out what makes the impulses large.) Records of contacts have the impulses over a sub-step of the settings, whatever their island takes.
//!
//! A body that dominates others must not depend on them: the sub-steps of its island do not follow theirs. An island under such a body
//! takes finer sub-steps if the body's island does. If only its own loads are heavy, it is solved after the body's island, and sees that
//! body go along the flight that this has found.

use alloc::vec::Vec;

use crate::fx::Fx;
use crate::limits::SPEED;
use crate::math::TimeStep;
use crate::scalar::FxAccumulator;
use crate::slots::NONE;
use crate::solve::{Contact, ContactImpact, ContactSolver, Correction, Flight, Graph, SolverOptions};

/// The sub-steps of islands under heavy loads: the most that a world may have.
const FINE: u32 = 16;

/// A load is heavy if a body on top has more than this times the mass of the one that carries it.
const HEAVY: i64 = 64;

/// Returns true for a mass in kg that is a heavy load on another one.
fn is_heavy(load: Fx, mass: Fx) -> bool {
    // Masses are at most 2^56 ulps: a product is at most 2^62.
    load.to_bits() > mass.to_bits() * HEAVY
}

/// Contacts of whole islands, and their flights.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub(super) flights: Vec<Flight>,
    /// The numbers of the flights among all.
    pub(super) flight_numbers: Vec<u32>,
    pub(super) contacts: Vec<Contact>,
    /// The numbers of the contacts among all.
    pub(super) contact_numbers: Vec<u32>,
    /// By flight among all its number here, or [`NONE`].
    place: Vec<u32>,
    corrections: Vec<Correction>,
}

impl Part {
    /// Copies contacts, and the flights that they join. Leaders are still those among all.
    pub(super) fn take(&mut self, flights: &[Flight], contacts: &[Contact], is_taken: impl Fn(&Contact) -> bool) {
        let Self { place, .. } = self;
        place.clear();
        place.resize(flights.len(), NONE);
        self.flights.clear();
        self.flight_numbers.clear();
        self.contacts.clear();
        self.contact_numbers.clear();
        for (number, contact) in (0..).zip(contacts).filter(|(_, contact)| is_taken(contact)) {
            let bodies = contact.bodies.map(|body| {
                let at = &mut place[body as usize];
                if *at == NONE {
                    *at = self.flights.len() as u32;
                    self.flights.push(flights[body as usize]);
                    self.flight_numbers.push(body);
                }
                *at
            });
            self.contacts.push(Contact { bodies, ..*contact });
            self.contact_numbers.push(number);
        }
    }

    /// The number here of a flight among all.
    pub(super) fn flight(&self, number: u32) -> Option<u32> {
        self.place.get(number as usize).copied().filter(|&at| at != NONE)
    }
}

/// The contacts of a step, split by the sub-steps that their islands take, and a solver for each part.
#[derive(Debug, Default)]
pub(crate) struct Solvers<C> {
    graph: Graph,
    /// The largest mass on top of each body, kg.
    loads: Vec<Fx>,
    /// By island.
    is_heavy: Vec<bool>,
    /// True if the last step had two parts.
    is_split: bool,
    parts: [Part; 2],
    solvers: [C; 2],
    corrections: Vec<Correction>,
}

impl<C: ContactSolver> Solvers<C> {
    /// Solves contacts, those of islands under heavy loads in finer sub-steps than the options say: writes impulses to the contacts.
    /// Returns the corrections of all flights.
    pub(super) fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        contacts: &mut [Contact],
    ) -> &[Correction] {
        let substeps = options.substeps;
        self.is_split = substeps < FINE && self.find(flights, contacts);
        if !self.is_split {
            self.solvers[0].solve(time_step, options, flights, contacts, &mut self.corrections);
            return &self.corrections;
        }
        self.corrections.clear();
        self.corrections.resize(flights.len(), Correction::default());
        for (index, part_substeps) in [substeps, FINE].into_iter().enumerate() {
            self.take(index, time_step, flights, contacts);
            let (part, to, from) = (&mut self.parts[index], u64::from(part_substeps), u64::from(substeps));
            for contact in &mut part.contacts {
                contact.impulses = contact.impulses.rescaled(from, to);
            }
            let options = SolverOptions { substeps: part_substeps, ..*options };
            let solver = &mut self.solvers[index];
            solver.solve(time_step, &options, &part.flights, &mut part.contacts, &mut part.corrections);
            // Fixed bodies, which may be in both parts, have none.
            for (&number, correction) in part.flight_numbers.iter().zip(&part.corrections) {
                self.corrections[number as usize] = *correction;
            }
            for (&number, contact) in part.contact_numbers.iter().zip(&part.contacts) {
                contacts[number as usize].impulses = contact.impulses.rescaled(to, from);
            }
        }
        &self.corrections
    }

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        (0..self.part_count()).flat_map(move |part| {
            let totals = self.solvers[part].totals();
            totals.map(move |(contact, sums, exponent)| (self.number(part, contact), sums, exponent))
        })
    }

    /// The impacts in the step of these contacts, which are those that were solved.
    pub(super) fn impacts<'a>(&'a self, contacts: &'a [Contact]) -> impl Iterator<Item = ContactImpact> + 'a {
        (0..self.part_count()).flat_map(move |part| {
            let contacts = if self.is_split { &self.parts[part].contacts } else { contacts };
            let impacts = self.solvers[part].impacts(contacts);
            impacts.map(move |impact| ContactImpact { contact: self.number(part, impact.contact), ..impact })
        })
    }

    /// The number of parts of the last step.
    fn part_count(&self) -> usize {
        if self.is_split { 2 } else { 1 }
    }

    /// The number among all of a contact of a part.
    fn number(&self, part: usize, contact: u32) -> u32 {
        if self.is_split { self.parts[part].contact_numbers[contact as usize] } else { contact }
    }

    /// Finds the islands under heavy loads. Returns true if there is one.
    fn find(&mut self, flights: &[Flight], contacts: &[Contact]) -> bool {
        may_be_heavy(flights, contacts) && {
            self.find_heavy(flights, contacts);
            self.follow_leaders(flights);
            self.is_heavy.contains(&true)
        }
    }

    fn find_heavy(&mut self, flights: &[Flight], contacts: &[Contact]) {
        let Self { graph, loads, is_heavy: heavy, .. } = self;
        let (links, is_fixed) =
            (contacts.iter().map(|contact| contact.bodies), |body: u32| flights[body as usize].is_fixed());
        // Islands that no fixed body holds carry nothing: they get no levels.
        graph.build(is_fixed, flights.len(), links, |_, _| {});
        graph.largest_above(|body| flights[body as usize].mass, loads);
        heavy.clear();
        heavy.resize(graph.islands(), false);
        for ((body, flight), &load) in (0..).zip(flights).zip(&*loads) {
            if let Some(island) = graph.island_of(body).filter(|_| is_heavy(load, flight.mass)) {
                heavy[island as usize] = true;
            }
        }
    }

    /// Gives islands below bodies that dominate them fine sub-steps where these have them.
    fn follow_leaders(&mut self, flights: &[Flight]) {
        let Self { graph, is_heavy, .. } = self;
        let followers = || (0..).zip(flights).filter_map(|(body, flight)| Some((body, flight.leader?)));
        let below = |follower| graph.touched_by(follower).filter_map(|body| graph.island_of(body));
        // Leaders may be below others in turn: at most one round for each number of dominance.
        let mut has_changed = followers().next().is_some();
        while has_changed {
            has_changed = false;
            for (follower, leader) in followers() {
                if !graph.island_of(leader).is_some_and(|island| is_heavy[island as usize]) {
                    continue;
                }
                for island in below(follower) {
                    has_changed |= !is_heavy[island as usize];
                    is_heavy[island as usize] = true;
                }
            }
        }
    }

    /// Copies the contacts of a part, and the flights that they join, with the corrections of the part before.
    fn take(&mut self, index: usize, time_step: TimeStep, flights: &[Flight], contacts: &[Contact]) {
        let Self { graph, is_heavy, parts, corrections, .. } = self;
        let part = &mut parts[index];
        part.take(flights, contacts, |contact| {
            let island = graph.mover(contact.bodies).and_then(|body| graph.island_of(body));
            island.is_some_and(|island| is_heavy[island as usize]) == (index == 1)
        });
        for at in 0..part.flights.len() {
            let Some(leader) = part.flights[at].leader else { continue };
            let place = part.flight(leader);
            if place.is_none() {
                // The leader was in the part before, or has no contacts at all.
                correct(&mut part.flights[at], &corrections[leader as usize], time_step);
            }
            part.flights[at].leader = place;
        }
    }
}

/// Makes a flight one at the mean velocity of the step, with the changes by impulses: sub-steps see a fixed flight by its velocities alone,
/// and an impact of its body has changed these at once.
fn correct(flight: &mut Flight, correction: &Correction, time_step: TimeStep) {
    if *correction == Correction::default() {
        return;
    }
    let (num, den) = time_step.seconds();
    // Ways are below 2^30 m: products are below 2^94. No flight is faster than the limit.
    let mean = |way: Fx, change: FxAccumulator| {
        let way = i128::from(way.to_bits()) + i128::from(change.value().to_bits());
        let limit = i128::from(SPEED.to_bits());
        Fx::from_bits((way * i128::from(den) / i128::from(num)).clamp(-limit, limit) as i64)
    };
    flight.start.linear.x = mean(flight.displacement.x, correction.displacement.x);
    flight.start.linear.y = mean(flight.displacement.y, correction.displacement.y);
    flight.start.angular = mean(flight.rotation, correction.rotation);
    flight.end = flight.start;
}

/// Returns true if masses differ by so much that one may be a heavy load. In most worlds they do not.
fn may_be_heavy(flights: &[Flight], contacts: &[Contact]) -> bool {
    let masses = contacts.iter().flat_map(|contact| contact.bodies).map(|body| flights[body as usize].mass);
    let mut range = None;
    for mass in masses.filter(|&mass| mass > Fx::ZERO) {
        let (least, most) = range.unwrap_or((mass, mass));
        range = Some((mass.min(least), mass.max(most)));
    }
    range.is_some_and(|(least, most)| is_heavy(most, least))
}
