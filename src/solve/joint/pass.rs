//! The passes over joints.

use super::{Block, FINER, GAIN, IMPULSE};
use crate::kernel::simd::GAIN_BITS;
use crate::solve::motion::Rows;
use crate::solve::number::shifted;

/// The velocities that a pass over joints aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum JointPass {
    /// The impulses of the sub-step before, at the present arms.
    WarmStart,
    /// Soft joints take errors away.
    Solve,
    /// Rigid joints; errors stay as they are.
    Relax,
}

impl Block {
    /// One pass. Returns the number of values that were cut off.
    pub(super) fn run(&mut self, pass: JointPass, rows: &mut Rows) -> u64 {
        let cut = match pass {
            JointPass::WarmStart => {
                self.change = [0; 4];
                self.push(self.impulses);
                0
            }
            JointPass::Solve => self.solve(rows, true),
            JointPass::Relax => self.solve(rows, false),
        };
        let cut = cut + self.give_gains(rows);
        if pass == JointPass::Relax {
            (0..4).for_each(|i| self.applied[i] += self.change[i]);
        }
        cut
    }

    /// After the move of a sub-step: adds up the changes that moved the bodies, then updates arms and matrices to their poses.
    pub(super) fn advance(&mut self, rows: &Rows) -> u64 {
        (0..4).for_each(|i| self.weighted[i] += self.applied[i] + self.change[i]);
        self.moves += 1;
        self.turn(rows)
    }

    fn solve(&mut self, rows: &Rows, is_biased: bool) -> u64 {
        let velocities = [0, 1].map(|k| rows.velocity(self.sides[k].row));
        let mut errors = [0; 2];
        for (row, error) in errors.iter_mut().enumerate().take(self.count) {
            *error = self.velocity(row, velocities);
            if is_biased {
                let push = i64::from(self.soft.rate) * self.errors[row];
                *error += push + self.second_order(row, velocities);
            }
        }
        let [e11, e12, e22] = self.inverse.map(i128::from);
        let [v1, v2] = errors.map(i128::from);
        let solution = [e11 * v1 + e12 * v2, e12 * v1 + e22 * v2];
        let mut cut = 0;
        let mut changes = [0; 2];
        for row in 0..self.count {
            let before = self.impulses[row];
            // Within 2^95, and 2^125 with the rigid share: the shift is as large as the inverse needs it.
            let wanted = if is_biased {
                let gives_way = i128::from((1 << 30) - self.rigid) * i128::from(before);
                let push = shifted(i128::from(self.rigid) * solution[row], self.inverse_shift + 30);
                i128::from(before) - push - shifted(gives_way, 30)
            } else {
                i128::from(before) - shifted(solution[row], self.inverse_shift)
            };
            let after = wanted.clamp(-i128::from(IMPULSE), i128::from(IMPULSE)) as i64;
            cut += u64::from(i128::from(after) != wanted);
            (self.impulses[row], changes[row]) = (after, after - before);
        }
        self.push(changes);
        cut
    }

    /// Adds impulses of the rows to the change of the sub-step.
    fn push(&mut self, impulses: [i64; 2]) {
        for (row, impulse) in impulses.into_iter().enumerate().take(self.count) {
            let ([ux, uy], [ka, kb]) = (self.axes[row], self.crosses[row]);
            for (sum, factor) in self.change.iter_mut().zip([ux, uy, ka, kb]) {
                *sum += i128::from(impulse) * i128::from(factor);
            }
        }
    }

    /// Adds to the gains of the bodies the changes of velocity by the impulses of the sub-step, less the part that was added before.
    /// Returns the number of changes that were cut off.
    fn give_gains(&mut self, rows: &mut Rows) -> u64 {
        let bits = self.mass_bits + FINER + 30 - GAIN_BITS;
        let [x, y, turn_a, turn_b] = self.change;
        let mut cut = 0;
        for (side, turn, sign) in [(0, turn_a, -1), (1, turn_b, 1)] {
            let side = &mut self.sides[side];
            if !side.is_movable() {
                continue;
            }
            let limit = GAIN.min((1 << 61) / side.share);
            let gains = &mut rows.rows[side.row as usize].gain;
            for (k, impulse) in [x, y, turn].into_iter().enumerate() {
                let wanted = shifted(i128::from(side.masses[k]) * impulse, bits);
                let applied_gain = wanted.clamp(-i128::from(limit), i128::from(limit)) as i64;
                cut += u64::from(i128::from(applied_gain) != wanted);
                gains[k] += sign * (applied_gain - side.applied_gain[k]);
                side.applied_gain[k] = applied_gain;
            }
        }
        cut
    }
}
