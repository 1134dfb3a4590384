//! Islands under heavy loads, solved in finer sub-steps ([`Split`]).

use alloc::vec::Vec;

use crate::contact::split::{Flying, HEAVY, Linking, Split};
use crate::fx::Fx;
use crate::math::TimeStep;
use crate::solve::{Contact, Correction, Flight, Solver, SolverOptions};

impl Flying for Flight {
    type Mass = Fx;

    fn is_fixed(&self) -> bool {
        Self::is_fixed(self)
    }

    fn mass(&self) -> Fx {
        self.mass
    }

    fn is_heavy(load: Fx, mass: Fx) -> bool {
        // Masses are at most 2^56 ulps: a product is at most 2^62.
        load.to_bits() > mass.to_bits() * i64::from(HEAVY)
    }

    fn leader(&self) -> Option<u32> {
        self.leader
    }

    fn set_leader(&mut self, leader: Option<u32>) {
        self.leader = leader;
    }
}

impl Linking for Contact {
    fn bodies(&self) -> [u32; 2] {
        self.bodies
    }

    fn set_bodies(&mut self, bodies: [u32; 2]) {
        self.bodies = bodies;
    }

    fn rescale(&mut self, num: u32, den: u32) {
        self.impulses = self.impulses.rescaled(num.into(), den.into());
    }
}

/// The solvers of a step: one for all contacts, or one for each part of them.
#[derive(Debug, Default)]
pub(super) struct Solvers {
    split: Split<Flight, Contact>,
    /// True if the last step was solved in parts.
    is_split: bool,
    solvers: [Solver; 2],
    corrections: Vec<Correction>,
}

impl Solvers {
    /// Solves contacts: writes impulses to them, and the corrections of bodies.
    pub(super) fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        (flights, contacts): (&[Flight], &mut [Contact]),
        corrections: &mut Vec<Correction>,
    ) {
        let Self { split, is_split, solvers, corrections: own } = self;
        *is_split = split.find(options.substeps, flights, contacts);
        if !*is_split {
            solvers[0].solve(time_step, options, flights, &mut [], contacts, corrections);
            return;
        }
        corrections.clear();
        corrections.resize(flights.len(), Correction::default());
        split.solve(options.substeps, (flights, contacts), |index, substeps, part| {
            let options = SolverOptions { substeps, ..*options };
            solvers[index].solve(time_step, &options, &part.flights, &mut [], &mut part.contacts, own);
            // Fixed bodies, which may be in both parts, have none.
            for (&number, correction) in part.flight_numbers.iter().zip(&*own) {
                corrections[number as usize] = *correction;
            }
        });
    }

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        let parts = self.split.parts().iter().zip(&self.solvers).take(if self.is_split { 2 } else { 1 });
        parts.flat_map(|(part, solver)| {
            let number = |contact| if self.is_split { part.contact_numbers[contact as usize] } else { contact };
            solver.totals().map(move |(contact, sums, exponent)| (number(contact), sums, exponent))
        })
    }
}
