//! The laws of a block in a pass.

use super::Block;
use super::axis::{Aim, AxisRow, ENDLESS};
use crate::slots::NONE;
use crate::solve::motion::{Rows, Vector};
use crate::solve::number::shifted;

/// The changes of a row in a round: of its velocity, in 2^-[`FRACTION`], and of its impulse.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowChange {
    pub(super) velocity: i64,
    pub(super) impulse: i64,
}

impl Block {
    /// The impulses by row: around in N·m·s in place of N·s at its length, as near as the unit can have it.
    pub(super) fn values(&self) -> [i64; 3] {
        let [first, second, third] = self.impulses;
        // Within 2^50 units; lengths are within 2^13.
        let third = shifted(third.into(), -self.axis_length.clamp(-100, 40)).clamp(-(1 << 62), 1 << 62);
        [first, second, third as i64]
    }

    /// The velocity of a row that has a law, in 2^-30; in the solve pass with the second-order term of a distance.
    #[inline(always)]
    fn law_velocity(&self, row: usize, velocities: [Vector; 2], is_biased: bool) -> i64 {
        if row == 2 {
            return self.turning_velocity(velocities);
        }
        let velocity = self.velocity(row, velocities);
        if !is_biased {
            velocity
        } else if self.is_pulley() {
            velocity + self.rope_second_order(velocities)
        } else {
            velocity + self.second_order(row, velocities, self.bends(self.sweeps_at(velocities)))
        }
    }

    /// Takes note of the velocities at the beginning of a sub-step, which springs ask for.
    pub(super) fn set_start(&self, rows: &Rows, laws: &mut [AxisRow], is_first: bool) {
        for row in 0..3 {
            let Some(law) = laws.get_mut(self.laws[row] as usize).filter(|law| law.has_spring()) else { continue };
            let velocities = match is_first {
                true => [0, 1].map(|side| rows.flight(self.sides[side].row).start),
                false => self.velocities(rows),
            };
            law.set_start(self.law_velocity(row, velocities, true));
        }
    }

    /// Begins a pass of the laws; with a rate, in 2^-30, the solve pass.
    #[inline(always)]
    pub(super) fn begin_laws(&self, rows: &Rows, laws: &mut [AxisRow], rate: Option<i64>) {
        let velocities = self.velocities(rows);
        if let [NONE, NONE, around] = self.laws {
            if let Some(law) = laws.get_mut(around as usize) {
                law.begin(self.turning_velocity(velocities), self.impulses[2], rate);
            }
            return;
        }
        for row in 0..3 {
            if let Some(law) = laws.get_mut(self.laws[row] as usize) {
                let velocity = self.law_velocity(row, velocities, rate.is_some());
                law.begin(velocity, self.impulses[row], rate);
            }
        }
    }

    /// The aim of a pass for a row; `None` for a row without a law.
    #[inline(always)]
    pub(super) fn aim(&self, row: usize, laws: &[AxisRow]) -> Option<Aim> {
        laws.get(self.laws[row] as usize).map(|law| law.aim(self.impulses[row]))
    }

    /// Moves rows on that have left their places by changes. Returns true if there is one.
    pub(super) fn revise_laws(&self, laws: &mut [AxisRow], changes: [RowChange; 3]) -> bool {
        let impulses = self.pushed_pair(&changes);
        let mut have_left = self.pair(laws).is_some_and(|pair| AxisRow::revise_pair(pair, impulses));
        for (row, change) in changes.iter().enumerate() {
            if let Some(law) = laws.get_mut(self.laws[row] as usize).filter(|law| !law.is_paired()) {
                have_left |= self.revise_law(law, row, change);
            }
        }
        have_left
    }

    /// Moves a row on that has left its place by a change. Returns true if it has.
    #[inline(always)]
    pub(super) fn revise_law(&self, law: &mut AxisRow, row: usize, change: &RowChange) -> bool {
        law.revise(change.velocity, self.pushed(row, change.impulse))
    }

    /// The laws of both rows along the axes.
    fn pair<'a>(&self, laws: &'a mut [AxisRow]) -> Option<&'a mut [AxisRow; 2]> {
        laws.get_mut(self.laws[0] as usize..).and_then(|laws| laws.first_chunk_mut())
    }

    /// The impulses of both rows along the axes, with changes.
    fn pushed_pair(&self, changes: &[RowChange; 3]) -> [i64; 2] {
        [0, 1].map(|row| self.pushed(row, changes[row].impulse))
    }

    /// Begins a descent of the laws, after [`begin_laws`](Self::begin_laws).
    pub(super) fn begin_descent(&self, laws: &mut [AxisRow]) {
        for row in 0..3 {
            if let Some(law) = laws.get_mut(self.laws[row] as usize) {
                law.begin_descent(self.impulses[row]);
            }
        }
    }

    /// An iteration of a descent of the laws, in which rows meet 2^-`share` of their own effective masses.
    pub(super) fn descend(&self, laws: &mut [AxisRow], changes: [RowChange; 3], share: i32) {
        for (row, change) in changes.into_iter().enumerate() {
            if let Some(law) = laws.get_mut(self.laws[row] as usize) {
                law.descend(change.velocity, share);
            }
        }
        if let Some(pair) = self.pair(laws) {
            AxisRow::shorten_pair(pair);
        }
    }

    /// The impulse of a row with a change.
    fn pushed(&self, row: usize, push: i64) -> i64 {
        // Below 2^50 and 2^61.
        (self.impulses[row] + push).clamp(-ENDLESS, ENDLESS)
    }
}
