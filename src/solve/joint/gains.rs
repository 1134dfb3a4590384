//! The changes of velocity of bodies by the impulses of a joint: in the passes, whose changes are repeated in the next sub-step, and in impacts.
//!
//! Reads: impulses, axes, masses. Writes: gains of bodies, sums of impulses.

use super::turn::Side;
use super::{Block, FINER, LOWER};
use crate::kernel::simd::GAIN_BITS;
use crate::solve::motion::Rows;
use crate::solve::number::{lowered, product, shifted, upper, within};

/// Bits by which masses are raised, so that the bits of changes of velocity stand in the upper word of a product.
const RAISED: i32 = 18;

/// The magnitude of a value; of a negative one less by one.
#[inline(always)]
fn magnitude(value: i64) -> i64 {
    value ^ (value >> 63)
}

impl Block {
    /// Begins a sub-step with the impulses of the one before, at the present arms. Returns the number of values that were cut off.
    #[inline(always)]
    pub(super) fn warm_start(&mut self, rows: &mut Rows) -> u64 {
        for i in 0..4 {
            self.applied[i] += self.change[i];
        }
        self.change = [0; 4];
        self.push(self.impulses);
        self.give_gains(rows)
    }

    /// The sums of the changes of all sub-steps.
    pub(super) fn applied(&self) -> [i128; 4] {
        [0, 1, 2, 3].map(|i| self.applied[i] + self.change[i])
    }

    /// Adds impulses of the rows to the change of the sub-step.
    #[inline(always)]
    pub(super) fn push(&mut self, impulses: [i64; 3]) {
        let sums = self.sums(impulses);
        for (change, sum) in self.change.iter_mut().zip(sums) {
            *change += sum;
        }
    }

    /// Impulses of the rows along x and y and around both bodies, in 2^-30.
    #[inline(always)]
    pub(super) fn sums(&self, impulses: [i64; 3]) -> [i128; 4] {
        let mut sums = [0; 4];
        for (row, impulse) in impulses.into_iter().enumerate() {
            if self.is_active[row] {
                let ([ux, uy], [ka, kb]) = (self.axes[row], self.crosses[row]);
                sums[0] += product(impulse, ux);
                sums[1] += product(impulse, uy);
                sums[2] += product(impulse, ka);
                sums[3] += product(impulse, kb);
            }
        }
        sums
    }

    /// The bits from products of masses and lowered impulses down to gains. Masses of rows have at most 50 bits: there are at least 8 bits left.
    #[inline(always)]
    fn gain_bits(&self) -> i32 {
        self.mass_bits + FINER + 30 - LOWER - GAIN_BITS
    }

    /// The changes of velocity of a body by sums of impulses, as of the second body, in units 2^coarse times as large as the units of gains. Products
    /// with masses are below 2^107.
    pub(super) fn gains(&self, side: usize, sums: [i128; 4], coarse: i32) -> [i128; 3] {
        let [x, y, turn_a, turn_b] = sums;
        let masses = self.sides[side].masses.map(i128::from);
        let gain =
            |axis: usize, impulse: i128| shifted(masses[axis] * lowered(impulse, LOWER), self.gain_bits() + coarse);
        [gain(0, x), gain(1, y), gain(2, if side == 0 { turn_a } else { turn_b })]
    }

    /// Adds to the gains of the bodies the changes of velocity by the impulses of the sub-step, less the part that was added before.
    /// Returns the number of changes that were cut off.
    #[inline(always)]
    pub(super) fn give_gains(&mut self, rows: &mut Rows) -> u64 {
        // The bits that are lowered away are below 2^-18 of a unit of velocity, and exact in the end.
        let [x, y, turn_a, turn_b] = self.change;
        let [x, y] = [lowered(x, LOWER) as i64, lowered(y, LOWER) as i64];
        let [turn_a, turn_b] = [lowered(turn_a, LOWER) as i64, lowered(turn_b, LOWER) as i64];
        let up = 64 - RAISED - self.gain_bits();
        let bound = magnitude(x) | magnitude(y) | magnitude(turn_a) | magnitude(turn_b);
        if bound >> (63 - up) != 0 {
            return self.give_large_gains(rows);
        }
        let [x, y, turn_a, turn_b] = [x << up, y << up, turn_a << up, turn_b << up];
        let [a, b] = &mut self.sides;
        a.give_gains(rows, [x, y, turn_a], -1) + b.give_gains(rows, [x, y, turn_b], 1)
    }

    /// [`give_gains`](Self::give_gains) by impulses of any size.
    #[cold]
    fn give_large_gains(&mut self, rows: &mut Rows) -> u64 {
        let mut cut = 0;
        for (side, sign) in [(0, -1), (1, 1)] {
            if !self.sides[side].is_movable() {
                continue;
            }
            let wanted_gains = self.gains(side, self.change, 0);
            let side = &mut self.sides[side];
            for (axis, wanted_gain) in wanted_gains.into_iter().enumerate() {
                let gain = within(wanted_gain, side.gain_limit.into());
                cut += u64::from(i128::from(gain) != wanted_gain);
                rows.rows[side.row as usize].gain[axis] += sign * (gain - side.applied_gain[axis]);
                side.applied_gain[axis] = gain;
            }
        }
        cut
    }
}

impl Side {
    /// Adds to the gains of the body the changes of velocity by the impulses of the sub-step, less the part that was added before. Masses are
    /// at most 2^44, so that the products of raised masses and of impulses along x and y and of rotation, which are below 2^63, are below 2^126.
    /// Returns the number of changes that were cut off.
    #[inline(always)]
    fn give_gains(&mut self, rows: &mut Rows, impulses: [i64; 3], sign: i64) -> u64 {
        if !self.is_movable() {
            return 0;
        }
        let gains = &mut rows.rows[self.row as usize].gain;
        let gain = |k: usize| upper(i128::from(self.masses[k] << RAISED) * i128::from(impulses[k]));
        let mut applied_gain = [gain(0), gain(1), gain(2)];
        let mut cut = 0;
        if magnitude(applied_gain[0]) | magnitude(applied_gain[1]) | magnitude(applied_gain[2]) >= self.gain_limit {
            for part in &mut applied_gain {
                let wanted = *part;
                *part = wanted.clamp(-self.gain_limit, self.gain_limit);
                cut += u64::from(*part != wanted);
            }
        }
        for k in 0..3 {
            gains[k] += sign * (applied_gain[k] - self.applied_gain[k]);
        }
        self.applied_gain = applied_gain;
        cut
    }
}
