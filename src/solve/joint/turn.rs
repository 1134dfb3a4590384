//! Arms, axes, errors and matrices of joints where the bodies are.

use super::{Block, ERROR};
use crate::kernel::sqrt::direction;
use crate::kernel::trig::sin_cos_turn;
use crate::kernel::wide::mul_shift_64;
use crate::solve::matrix::{Inverse, Matrix};
use crate::solve::motion::{Rows, Vector};
use crate::solve::number::shifted;

/// 0.1 rad in 2^-30: the largest turn in a sub-step that the second-order term counts.
const LARGEST_ANGLE: i64 = 107_374_182;

/// The share of an impulse that is rigid, in 2^-30: k/(k + c·w) for a compliance c, in 2^-30 of the mass factor, where k is the mass
/// factor of the shares of the bodies and w of the whole bodies. (With k in place of w shares would make a joint softer.)
fn rigid_share(compliance: i32, split: i128, whole: i128) -> i64 {
    // Below 2^59, times 2^60.
    let sum = (split << 30) + i128::from(compliance) * whole;
    if sum == 0 { 0 } else { ((split << 60) / sum) as i64 }
}

/// value · k/n to nearest, ties away from zero. *Domain* |value| at most 2^28.
fn part(value: i32, k: i32, n: i32) -> i32 {
    let twice = 2 * i64::from(value) * i64::from(k);
    ((twice + i64::from(value.signum() * n)) / i64::from(2 * n)) as i32
}

/// A body at a joint.
#[derive(Clone, Debug)]
pub(super) struct Side {
    pub(super) row: u32,
    /// Changes of velocity along x and y and of rotation, by an impulse: below 2^44.
    pub(super) masses: [i64; 3],
    /// The number of joints of the phase at the body.
    pub(super) share: i64,
    /// The arm at the start, and now.
    pub(super) start: [i64; 2],
    pub(super) arm: [i64; 2],
    /// The arm at the start and now, in 2^-30 of the length of the body.
    pub(super) unit_start: [i64; 2],
    pub(super) unit_arm: [i64; 2],
    /// The turn of a unit of angular displacement, in 2^-64: mantissa and shift.
    pub(super) turn: (u64, i32),
    /// The angle of a unit of angular velocity in a sub-step, in 2^-30 rad: mantissa and shift.
    pub(super) angle: (u64, i32),
    /// The excess of the displacement of the row over the displacement of the body, at the end of the step.
    pub(super) shift: [i32; 3],
    /// The changes of velocity by the joint in the sub-step, in 2^-30.
    pub(super) applied_gain: [i64; 3],
}

impl Side {
    pub(super) fn is_movable(&self) -> bool {
        self.masses != [0; 3]
    }

    /// Returns true if the body can be moved and moves by shares.
    pub(super) fn is_split(&self) -> bool {
        self.share > 1 && self.is_movable()
    }

    /// A bound, from above, on the mass factor of any row at the arm.
    pub(super) fn largest_mass(&self) -> i64 {
        let [x, y] = self.unit_start.map(i128::from);
        let [mx, my, angular] = self.masses;
        mx + my + shifted(i128::from(angular) * (x * x + y * y), 60) as i64
    }

    /// Turns the arm by an angular displacement since the start.
    fn turn_by(&mut self, displacement: i32) {
        let (mantissa, shift) = self.turn;
        // Whole turns do not matter.
        let turn = mul_shift_64(displacement.into(), mantissa, shift).unwrap_or(0) as u64;
        let (sin, cos) = sin_cos_turn(turn);
        let (sin, cos) = (i128::from(sin), i128::from(cos));
        let turned = |[x, y]: [i64; 2]| {
            let (x, y) = (i128::from(x), i128::from(y));
            [shifted(cos * x - sin * y, 62) as i64, shifted(sin * x + cos * y, 62) as i64]
        };
        self.arm = turned(self.start);
        self.unit_arm = turned(self.unit_start);
    }

    /// The cross product of the arm with an axis.
    fn across(&self, [ux, uy]: [i64; 2]) -> i64 {
        let [x, y] = self.unit_arm;
        shifted(i128::from(x) * i128::from(uy) - i128::from(y) * i128::from(ux), 30) as i64
    }
}

impl Block {
    /// Updates arms, axes, errors and the matrix to the poses of the bodies. Returns the number of errors that were cut off.
    pub(super) fn turn(&mut self, rows: &Rows) -> u64 {
        let moved = [0, 1].map(|k| {
            let Side { row, shift, .. } = &self.sides[k];
            let [x, y, turn, _] = rows.displacement(*row);
            let shift = shift.map(|s| part(s, self.moves, self.substeps));
            [x - shift[0], y - shift[1], turn - shift[2]]
        });
        for (side, moved) in self.sides.iter_mut().zip(moved) {
            side.turn_by(moved[2]);
        }
        let [a, b] = &self.sides;
        let offset = [0, 1].map(|i| {
            let way = i64::from(moved[1][i]) - i64::from(moved[0][i]);
            self.base[i] + way + b.arm[i] - a.arm[i]
        });
        let wanted = match self.length {
            None => offset,
            Some(length) => {
                let (axis, distance) = if offset == [0; 2] { ([0; 2], 0) } else { direction(offset[0], offset[1]) };
                self.axes[0] = axis.map(i64::from);
                self.distance = distance as i64;
                [self.distance - length, 0]
            }
        };
        self.errors = wanted.map(|error| error.clamp(-ERROR, ERROR));
        for row in 0..self.count {
            self.crosses[row] = [0, 1].map(|k| self.sides[k].across(self.axes[row]));
        }
        self.invert();
        u64::from(self.errors != wanted)
    }

    /// The velocity along row `i` by an impulse along row `j`, for one body.
    fn element(&self, side: usize, i: usize, j: usize) -> i128 {
        let [mx, my, angular] = self.sides[side].masses.map(i128::from);
        let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
        let ([ix, iy], [jx, jy]) = (self.axes[i], self.axes[j]);
        let turning = product(self.crosses[i][side], self.crosses[j][side]);
        shifted(mx * product(ix, jx) + my * product(iy, jy) + angular * turning, 60)
    }

    /// Sets the inverse of the matrix of the rows, with shares of the bodies, and its softness.
    fn invert(&mut self) {
        let element = |i: usize, j: usize, shares: [i64; 2]| {
            i128::from(shares[0]) * self.element(0, i, j) + i128::from(shares[1]) * self.element(1, i, j)
        };
        let shares = [self.sides[0].share, self.sides[1].share];
        let has_two_rows = self.count == 2;
        let (k11, k12, k22) = if has_two_rows {
            let (k11, k22) = (element(0, 0, shares), element(1, 1, shares));
            // Bodies that move along one axis only make the matrix singular.
            let extra = (k11 + k22) >> 20;
            (k11 + extra, element(0, 1, shares), k22 + extra)
        } else {
            let k11 = element(0, 0, shares);
            (k11, 0, k11)
        };
        // Down to 58 bits.
        let down = (128 - k11.max(k22).leading_zeros() as i32 - 58).max(0);
        let [k11, k12, k22] = [k11, k12, k22].map(|k| shifted(k, down) as i64);
        let trace =
            |shares| shifted(element(0, 0, shares) + if has_two_rows { element(1, 1, shares) } else { 0 }, down);
        let (split, whole) = if self.is_split { (trace(shares), trace([1, 1])) } else { (1, 1) };
        self.rigid = rigid_share(self.soft.compliance, split, whole);
        // The inverse is rounded down: element 12 by its magnitude, as it changes its sign in a mirror.
        let inverse = Inverse::of(Matrix { k11, k12: k12.abs(), k22 });
        let [e11, e22, e12] = inverse.elements;
        self.inverse = [e11, if k12 < 0 { -e12 } else { e12 }, e22];
        self.inverse_shift = inverse.exponent + down + 30 - self.mass_bits - super::FINER;
    }

    /// The angle that a body turns in a sub-step at an angular velocity, in 2^-30 rad within ±0.1 rad.
    pub(super) fn angle_of(&self, side: usize, velocity: i32) -> i64 {
        let (mantissa, shift) = self.sides[side].angle;
        let limit = i128::from(LARGEST_ANGLE);
        // An angle that does not fit is as large as any.
        mul_shift_64(velocity.into(), mantissa, shift).unwrap_or(limit).clamp(-limit, limit) as i64
    }

    /// The part of the motion of the anchors in a sub-step along a row that the velocities at its end leave out, in 2^-30:
    /// −(φ_B²·r_B − φ_A²·r_A)/2, the shifts of the bodies, and the turn of a rod.
    pub(super) fn second_order(&self, row: usize, velocities: [Vector; 2]) -> i64 {
        let bend = [0, 1].map(|k| {
            let angle = i128::from(self.angle_of(k, velocities[k][2]));
            self.sides[k].arm.map(|c| shifted(angle * angle * i128::from(c), 31))
        });
        let [x, y] = [0, 1].map(|i| bend[0][i] - bend[1][i]);
        let [ux, uy] = self.axes[row].map(i128::from);
        let shifts = [0, 1].map(|k| {
            let [x, y, turn] = self.sides[k].shift;
            [x, y, turn, 0]
        });
        let along = shifted(ux * x + uy * y, 30) as i64 - self.velocity(row, shifts) / i64::from(self.substeps);
        if self.length.is_none() { along } else { along + self.rod_turns(velocities) }
    }

    /// φ²·l/2 for the angle φ that a rod of length l turns in the sub-step, in 2^-30; φ is at most 0.1 rad.
    fn rod_turns(&self, [a, b]: [Vector; 2]) -> i64 {
        if self.distance == 0 {
            return 0;
        }
        let [arm_a, arm_b] = [0, 1].map(|k| self.sides[k].unit_arm);
        let [x, y] = [0, 1].map(|i| (i64::from(b[i]) - i64::from(a[i])) << 30);
        let [wa, wb] = [i64::from(a[2]), i64::from(b[2])];
        let (x, y) = (x - wb * arm_b[1] + wa * arm_a[1], y + wb * arm_b[0] - wa * arm_a[0]);
        let [ux, uy] = self.axes[0].map(i128::from);
        let across = shifted(ux * i128::from(y) - uy * i128::from(x), 30) as i64;
        let angle = i128::from((across.abs() / self.distance).min(LARGEST_ANGLE));
        shifted(angle * angle * i128::from(self.distance), 31) as i64
    }

    /// The sum of a row's products with the velocities of both bodies, in 2^-30.
    pub(super) fn velocity(&self, row: usize, [a, b]: [Vector; 2]) -> i64 {
        let ([ux, uy], [ka, kb]) = (self.axes[row], self.crosses[row]);
        let [x, y] = [0, 1].map(|i| i64::from(b[i]) - i64::from(a[i]));
        ux * x + uy * y + kb * i64::from(b[2]) - ka * i64::from(a[2])
    }
}
