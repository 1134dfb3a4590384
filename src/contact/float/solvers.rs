//! Islands under heavy loads, solved in finer sub-steps ([`Split`]).

use alloc::vec::Vec;

use super::body::Flight;
use super::number::{Float, Pair};
use super::rows::Contact;
use super::solver::{Clock, Solver};
use crate::contact::split::{Flying, HEAVY, Linking, Split};
use crate::contact::{Correction, Scene};

impl<F: Float> Flying for Flight<F> {
    type Mass = F;

    fn is_fixed(&self) -> bool {
        Self::is_fixed(self)
    }

    fn mass(&self) -> F {
        self.mass[0]
    }

    fn is_heavy(load: F, mass: F) -> bool {
        load > mass * F::of(HEAVY.into())
    }

    fn leader(&self) -> Option<u32> {
        self.leader
    }

    fn set_leader(&mut self, leader: Option<u32>) {
        self.leader = leader;
    }
}

impl<F: Float> Linking for Contact<F> {
    fn bodies(&self) -> [u32; 2] {
        self.bodies
    }

    fn set_bodies(&mut self, bodies: [u32; 2]) {
        self.bodies = bodies;
    }

    fn rescale(&mut self, num: u32, den: u32) {
        let ratio = F::of(f64::from(num) / f64::from(den));
        self.impulses = self.impulses.map(|impulse| impulse * ratio);
    }
}

/// The solvers of a step: one for all contacts, or one for each part of them.
#[derive(Debug, Default)]
pub(super) struct Solvers<F: Float> {
    split: Split<Flight<F>, Contact<F>>,
    /// True if the last step was solved in parts.
    is_split: bool,
    solvers: [Solver<F>; 2],
}

impl<F: Float> Solvers<F> {
    /// Solves contacts: writes impulses to them, and the corrections of the bodies that move.
    pub(super) fn solve(
        &mut self,
        scene: &Scene<'_, F>,
        (flights, contacts): (&[Flight<F>], &mut [Contact<F>]),
        corrections: &mut Vec<Correction<F>>,
    ) {
        let (settings, movers) = (scene.settings, scene.starts.len());
        let Self { split, is_split, solvers } = self;
        *is_split = split.find(settings.substeps, flights, contacts);
        let first = corrections.len();
        if !*is_split {
            let clock = Clock::new(scene.time_step, settings.substeps);
            solvers[0].solve(clock, settings, flights, contacts);
            corrections.extend(solvers[0].corrections(clock, flights).take(movers));
            return;
        }
        corrections.resize(first + movers, Correction::default());
        split.solve(settings.substeps, (flights, contacts), |index, substeps, part| {
            let (clock, solver) = (Clock::new(scene.time_step, substeps), &mut solvers[index]);
            solver.solve(clock, settings, &part.flights, &mut part.contacts);
            for (&number, correction) in part.flight_numbers.iter().zip(solver.corrections(clock, &part.flights)) {
                // Bodies that stand still come after those that move.
                if let Some(all) = corrections.get_mut(first + number as usize) {
                    *all = correction;
                }
            }
        });
    }

    /// The number of each contact, and its impulses along the normal over the step, by point.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, Pair<F>)> + '_ {
        let parts = self.split.parts().iter().zip(&self.solvers).take(if self.is_split { 2 } else { 1 });
        parts.flat_map(|(part, solver)| {
            let number = |contact| if self.is_split { part.contact_numbers[contact as usize] } else { contact };
            solver.totals().map(move |(contact, sums)| (number(contact), sums))
        })
    }
}
