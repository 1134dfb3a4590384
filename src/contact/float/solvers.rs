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
    type Correction = Correction<F>;

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

    fn correct(&mut self, by: &Correction<F>) {
        let changed = [by.velocity.x, by.velocity.y, by.angular_velocity];
        (0..3).for_each(|i| self.end[i] += changed[i]);
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

/// The solvers of a step: one for each part of the contacts.
#[derive(Debug, Default)]
pub(super) struct Solvers<F: Float> {
    split: Split<Flight<F>, Contact<F>>,
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
        let (Self { split, solvers }, settings) = (self, scene.settings);
        split.solve(settings.substeps, (flights, contacts), corrections, |part, substeps, (flights, contacts), out| {
            let (clock, solver) = (Clock::new(scene.time_step, substeps), &mut solvers[part]);
            solver.solve(clock, settings, flights, contacts);
            out.clear();
            out.extend(solver.corrections(clock, flights));
        });
        // Bodies that stand still come after those that move.
        corrections.truncate(scene.starts.len());
    }

    /// The number of each contact, and its impulses along the normal over the step, by point.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, Pair<F>)> + '_ {
        (0..self.split.parts()).flat_map(move |part| {
            self.solvers[part].totals().map(move |(contact, sums)| (self.split.number(part, contact), sums))
        })
    }
}
