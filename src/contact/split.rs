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
use core::fmt::Debug;

use crate::slots::NONE;
use crate::solve::Graph;

/// The sub-steps of islands under heavy loads: the most that a world may have.
pub(super) const FINE: u32 = 16;

/// A load is heavy if a body on top has more than this times the mass of the one that carries it.
pub(super) const HEAVY: i32 = 64;

/// A flight of the solver of one scalar.
pub(super) trait Flying: Copy {
    /// kg
    type Mass: Copy + Debug + Default + PartialOrd;
    /// The change of a flight by the impulses of a step.
    type Correction: Copy + Debug + Default;

    /// Returns true for one that no impulse changes.
    fn is_fixed(&self) -> bool;
    /// The mass; 0 for a fixed one.
    fn mass(&self) -> Self::Mass;
    /// Returns true for a mass that is a heavy load on another one.
    fn is_heavy(load: Self::Mass, mass: Self::Mass) -> bool;
    /// The flight that this one follows.
    fn leader(&self) -> Option<u32>;
    fn set_leader(&mut self, leader: Option<u32>);
    /// Adds the impulses of the step to its velocity at the end: sub-steps see a fixed flight by its velocities alone.
    fn correct(&mut self, by: &Self::Correction);
}

/// A contact of the solver of one scalar.
pub(super) trait Linking: Copy {
    /// The numbers of its flights.
    fn bodies(&self) -> [u32; 2];
    fn set_bodies(&mut self, bodies: [u32; 2]);
    /// Makes its impulses those of the same forces over a sub-step of num/den of the length.
    fn rescale(&mut self, num: u32, den: u32);
}

/// Contacts that take the same sub-steps, and their flights.
#[derive(Debug)]
struct Part<F, C> {
    flights: Vec<F>,
    /// The numbers of the flights among all.
    flight_numbers: Vec<u32>,
    contacts: Vec<C>,
    /// The numbers of the contacts among all.
    contact_numbers: Vec<u32>,
}

impl<F, C> Default for Part<F, C> {
    fn default() -> Self {
        Self { flights: Vec::new(), flight_numbers: Vec::new(), contacts: Vec::new(), contact_numbers: Vec::new() }
    }
}

/// The contacts of a step, split by the sub-steps that their islands take.
#[derive(Debug)]
pub(super) struct Split<F: Flying, C> {
    graph: Graph,
    /// The largest mass on top of each body.
    loads: Vec<F::Mass>,
    /// By island.
    is_heavy: Vec<bool>,
    /// By flight its number among those of a part, or [`NONE`].
    place: Vec<u32>,
    /// True if the last step had two parts.
    is_split: bool,
    parts: [Part<F, C>; 2],
    /// The corrections of a part.
    corrections: Vec<F::Correction>,
}

impl<F: Flying, C> Default for Split<F, C> {
    fn default() -> Self {
        Self {
            graph: Graph::default(),
            loads: Vec::new(),
            is_heavy: Vec::new(),
            place: Vec::new(),
            is_split: false,
            parts: Default::default(),
            corrections: Vec::new(),
        }
    }
}

impl<F: Flying, C: Linking> Split<F, C> {
    /// Solves contacts, those of islands under heavy loads in finer sub-steps than `substeps`, and lists the corrections of all flights.
    /// `solve` does it for a part, which has a number: in so many sub-steps, for its flights and contacts.
    pub(super) fn solve(
        &mut self,
        substeps: u32,
        (flights, contacts): (&[F], &mut [C]),
        corrections: &mut Vec<F::Correction>,
        mut solve: impl FnMut(usize, u32, (&[F], &mut [C]), &mut Vec<F::Correction>),
    ) {
        self.is_split = substeps < FINE && self.find(flights, contacts);
        if !self.is_split {
            return solve(0, substeps, (flights, contacts), corrections);
        }
        corrections.clear();
        corrections.resize(flights.len(), F::Correction::default());
        for (index, own) in [substeps, FINE].into_iter().enumerate() {
            self.take(index, (flights, contacts), corrections);
            let part = &mut self.parts[index];
            part.contacts.iter_mut().for_each(|contact| contact.rescale(substeps, own));
            solve(index, own, (&part.flights, &mut part.contacts), &mut self.corrections);
            // Fixed bodies, which may be in both parts, have none.
            for (&number, correction) in part.flight_numbers.iter().zip(&self.corrections) {
                corrections[number as usize] = *correction;
            }
            for (&number, contact) in part.contact_numbers.iter().zip(&part.contacts) {
                let all = &mut contacts[number as usize];
                let bodies = all.bodies();
                *all = *contact;
                all.set_bodies(bodies);
                all.rescale(own, substeps);
            }
        }
    }

    /// The number of parts of the last step.
    pub(super) fn parts(&self) -> usize {
        if self.is_split { 2 } else { 1 }
    }

    /// The number among all of a contact of a part.
    pub(super) fn number(&self, part: usize, contact: u32) -> u32 {
        if self.is_split { self.parts[part].contact_numbers[contact as usize] } else { contact }
    }

    /// Finds the islands under heavy loads. Returns true if there is one.
    fn find(&mut self, flights: &[F], contacts: &[C]) -> bool {
        may_be_heavy(flights, contacts) && {
            self.find_heavy(flights, contacts);
            self.follow_leaders(flights);
            self.is_heavy.contains(&true)
        }
    }

    fn find_heavy(&mut self, flights: &[F], contacts: &[C]) {
        let Self { graph, loads, is_heavy, .. } = self;
        let (links, is_fixed) = (contacts.iter().map(C::bodies), |body: u32| flights[body as usize].is_fixed());
        // Islands that no fixed body holds carry nothing: they get no levels.
        graph.build(is_fixed, flights.len(), links, |_, _| {});
        graph.largest_above(|body| flights[body as usize].mass(), loads);
        is_heavy.clear();
        is_heavy.resize(graph.islands(), false);
        for ((body, flight), &load) in (0..).zip(flights).zip(&*loads) {
            if let Some(island) = graph.island_of(body).filter(|_| F::is_heavy(load, flight.mass())) {
                is_heavy[island as usize] = true;
            }
        }
    }

    /// Gives islands below bodies that dominate them fine sub-steps where these have them.
    fn follow_leaders(&mut self, flights: &[F]) {
        let Self { graph, is_heavy, .. } = self;
        let followers = || (0..).zip(flights).filter_map(|(body, flight)| Some((body, flight.leader()?)));
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
    fn take(&mut self, index: usize, (flights, contacts): (&[F], &[C]), corrections: &[F::Correction]) {
        let Self { graph, is_heavy, place, parts, .. } = self;
        let part = &mut parts[index];
        place.clear();
        place.resize(flights.len(), NONE);
        part.flights.clear();
        part.flight_numbers.clear();
        part.contacts.clear();
        part.contact_numbers.clear();
        for (number, contact) in (0..).zip(contacts) {
            let island = graph.mover(contact.bodies()).and_then(|body| graph.island_of(body));
            if island.is_some_and(|island| is_heavy[island as usize]) != (index == 1) {
                continue;
            }
            let own = contact.bodies().map(|body| {
                let own = &mut place[body as usize];
                if *own == NONE {
                    *own = part.flights.len() as u32;
                    part.flights.push(flights[body as usize]);
                    part.flight_numbers.push(body);
                }
                *own
            });
            let mut contact = *contact;
            contact.set_bodies(own);
            part.contacts.push(contact);
            part.contact_numbers.push(number);
        }
        for flight in &mut part.flights {
            let Some(leader) = flight.leader() else { continue };
            let own = place[leader as usize];
            if own == NONE {
                // The leader was in the part before, or has no contacts at all.
                flight.correct(&corrections[leader as usize]);
            }
            flight.set_leader(Some(own).filter(|&own| own != NONE));
        }
    }
}

/// Returns true if masses differ by so much that one may be a heavy load. In most worlds they do not.
fn may_be_heavy<F: Flying>(flights: &[F], contacts: &[impl Linking]) -> bool {
    let masses = contacts.iter().flat_map(Linking::bodies).map(|body| flights[body as usize].mass());
    let none = F::Mass::default();
    let mut range = None;
    for mass in masses.filter(|&mass| mass > none) {
        let (least, most) = range.unwrap_or((mass, mass));
        range = Some((if mass < least { mass } else { least }, if mass > most { mass } else { most }));
    }
    range.is_some_and(|(least, most)| F::is_heavy(most, least))
}
