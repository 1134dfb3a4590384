//! The residuals of the rows that a joint holds.
//!
//! Reads: velocities and poses of bodies, axes and errors. Writes: nothing.

use super::Block;
use super::turn::Pose;
use crate::solve::motion::{Rows, Vector};

impl Block {
    /// The velocities of the rows that are held, in 2^-30. With a rate, in 2^-30, the velocity that takes errors away is added, and the
    /// second-order term.
    #[inline(always)]
    pub(super) fn residual(&self, rows: &Rows, poses: &[Pose], rate: Option<i64>) -> [i64; 2] {
        let velocities = self.velocities(rows);
        if self.holds_point() {
            return self.residual_of_point(velocities, poses, rate);
        }
        let mut residual = [0; 2];
        if let Some(rate) = rate {
            let bends = self.bends(self.sweeps(poses));
            for (row, sum) in residual.iter_mut().enumerate() {
                if self.held[row] {
                    let repair = rate * self.errors[row];
                    *sum = self.velocity(row, velocities) + repair + self.second_order(row, velocities, bends);
                }
            }
        } else {
            for (row, sum) in residual.iter_mut().enumerate() {
                if self.held[row] {
                    *sum = self.velocity(row, velocities);
                }
            }
        }
        residual
    }

    /// [`residual`](Self::residual) of a joint that holds a point.
    #[inline(always)]
    fn residual_of_point(&self, velocities: [Vector; 2], poses: &[Pose], rate: Option<i64>) -> [i64; 2] {
        let [x, y] = self.point_velocity(velocities);
        let Some(rate) = rate else { return [x, y] };
        let [bend_x, bend_y] = self.bends(self.sweeps(poses)).bend;
        let [error_x, error_y] = self.errors;
        let mut residual = [x + rate * error_x + bend_x, y + rate * error_y + bend_y];
        if self.is_shifted {
            let [shift_x, shift_y] = self.point_velocity(self.shifts());
            let substeps = i64::from(self.substeps);
            residual = [residual[0] - shift_x / substeps, residual[1] - shift_y / substeps];
        }
        residual
    }
}
