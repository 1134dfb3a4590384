//! The solver of contacts and joints as the step takes it.

use alloc::vec::Vec;
use core::fmt::Debug;

use super::{Contact, Correction, Flight, Joint, SolverOptions};
use crate::fx::Fx;
use crate::math::TimeStep;
#[cfg(feature = "timers")]
use crate::timers::Timers;

/// The impacts of a contact in a step, added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactImpact {
    /// The number of the contact.
    pub contact: u32,
    /// Their impulses along the normal, by point: multiples of 2^exponent N·s.
    pub impulses: [i64; 2],
    /// log2 of the unit of the impulses.
    pub exponent: i32,
    /// The speed of the fastest impact at its moment, by point, m/s; zero for a point that touched before.
    pub speeds: [Fx; 2],
}

/// A solver of contacts and joints: in integers, or in floats.
pub trait ContactSolver: Debug + Default + Send + Sync {
    /// Solves a step: writes impulses to joints and contacts and the corrections of bodies to `corrections`, one for each flight.
    fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    );

    /// The timers since they were taken last, without the time of preparations.
    #[cfg(feature = "timers")]
    fn take_timers(&mut self) -> Timers;

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_;

    /// The number of each joint that was solved, and its impulses over the step on the second body: along x and y, in 2^-32 N·s, and
    /// around, in 2^-32 N·m·s.
    fn joint_totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_;

    /// The impacts in the step of these contacts, which are the contacts that were solved.
    fn impacts<'a>(&'a self, contacts: &'a [Contact]) -> impl Iterator<Item = ContactImpact> + 'a;
}
