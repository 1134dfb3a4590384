//! Velocities of bodies at the beginning of a sub-step.
//!
//! Reads: rows of bodies. Writes: the velocities that the impacts of a sub-step ask for, each once.

use alloc::vec::Vec;

use super::super::bodies::STILL;
use super::super::group::Group;
use super::super::motion::Rows;
use super::jacobian::Jacobian;
use super::{FINE, FRACTION, SubStep};

/// The velocities of rows at the beginning of a sub-step, before its contacts, or as impacts left them; in 2^-[`FINE`].
#[derive(Clone, Debug, Default)]
pub(super) struct Velocities {
    velocities: Vec<[i64; 3]>,
    is_known: Vec<bool>,
}

impl Velocities {
    /// Begins a sub-step.
    pub(super) fn begin(&mut self, rows: u32) {
        self.velocities.resize(rows as usize, [0; 3]);
        self.is_known.clear();
        self.is_known.resize(rows as usize, false);
    }

    /// Forgets the velocity of a body that an impact has changed.
    pub(super) fn forget(&mut self, row: u32) {
        self.is_known[row as usize] = false;
    }

    /// The velocity of a row.
    #[inline(always)]
    pub(super) fn at(&mut self, rows: &Rows, row: u32, substep: SubStep<'_>) -> [i64; 3] {
        if !self.is_known[row as usize] {
            self.velocities[row as usize] = velocity_before(rows, row, substep);
            self.is_known[row as usize] = true;
        }
        self.velocities[row as usize]
    }

    /// The velocities along the rows of a contact, in 2^-[`FRACTION`].
    pub(super) fn along(&mut self, rows: &Rows, group: &Group, lane: usize, substep: SubStep<'_>) -> [i64; 3] {
        let [a, b] = [group.a[lane], group.b[lane]].map(|row| self.at(rows, row, substep));
        Jacobian::of(group, lane).along(a, b, FINE - FRACTION)
    }
}

/// The velocity of a body at the beginning of a sub-step, before its contacts, or as impacts left it; in 2^-[`FINE`].
#[inline(never)]
fn velocity_before(rows: &Rows, row: u32, substep: SubStep<'_>) -> [i64; 3] {
    if row == STILL {
        return [0; 3];
    }
    let flight = rows.flight(row);
    let (before, rest) = rows.before(row);
    [0, 1, 2].map(|i| {
        // Changes are below 2^28 and there are at most 16 sub-steps. To nearest, halves away from zero.
        let whole = (i64::from(flight.change[i]) * i64::from(substep.k - 1)) << FINE;
        let flown = (whole + i64::from(substep.n / 2) * whole.signum()) / i64::from(substep.n);
        ((i64::from(flight.start[i]) + i64::from(before[i])) << FINE) + flown + rest[i]
    })
}
