//! The solver of contacts as the step takes it.

use alloc::vec::Vec;
use core::fmt::Debug;

use super::{Contact, Correction, Flight, Solver, SolverOptions};
use crate::math::TimeStep;

/// A solver of contacts: in integers, or in floats.
pub trait ContactSolver: Debug + Default + Send + Sync {
    /// Solves a step: writes impulses to contacts and the corrections of bodies to `corrections`, one for each flight.
    fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    );

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_;
}

impl ContactSolver for Solver {
    fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) {
        self.solve(time_step, options, flights, &mut [], contacts, corrections);
    }

    fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        self.totals()
    }
}
