//! Islands under heavy loads, solved in finer sub-steps ([`Split`]).

use alloc::vec::Vec;

use crate::contact::split::{Flying, HEAVY, Linking, Split};
use crate::fx::Fx;
use crate::limits::SPEED;
use crate::math::TimeStep;
use crate::scalar::{Accumulator as _, FxAccumulator};
use crate::solve::{Contact, Correction, Flight, Solver, SolverOptions};

impl Flying for Flight {
    type Mass = Fx;
    type Correction = Correction;

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

    fn correct(&mut self, by: &Correction) {
        // A change by impulses is at most 2^30 and a velocity below 2^26: the sum is below 2^31. No flight ends faster than the limit.
        let add = |own: &mut Fx, by: FxAccumulator| {
            *own = FxAccumulator::from_scalar(*own).plus(by).value().clamp(-SPEED, SPEED);
        };
        if *by == Correction::default() {
            return;
        }
        add(&mut self.end.linear.x, by.velocity.x);
        add(&mut self.end.linear.y, by.velocity.y);
        add(&mut self.end.angular, by.angular_velocity);
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

/// The solvers of a step: one for each part of the contacts.
#[derive(Debug, Default)]
pub(super) struct Solvers {
    split: Split<Flight, Contact>,
    solvers: [Solver; 2],
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
        let Self { split, solvers } = self;
        split.solve(options.substeps, (flights, contacts), corrections, |part, substeps, (flights, contacts), out| {
            let options = SolverOptions { substeps, ..*options };
            solvers[part].solve(time_step, &options, flights, &mut [], contacts, out);
        });
    }

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        (0..self.split.parts()).flat_map(move |part| {
            let totals = self.solvers[part].totals();
            totals.map(move |(contact, sums, exponent)| (self.split.number(part, contact), sums, exponent))
        })
    }
}
