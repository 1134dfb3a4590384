//! The changes of velocity of bodies by the impulses of a joint: in the passes, whose changes are repeated in the next sub-step, and in impacts.
//!
//! The changes of a body by its joints cancel: where an arm of 1 kg stops a weight of 100 kg, both of its pins change its velocity by a hundred
//! times as much as the weight's, in opposite directions. So each has as many bits as it needs, and their sum alone has the range of velocities.
//!
//! Reads: impulses, axes, masses. Writes: gains of bodies, sums of impulses.

use alloc::vec::Vec;

use super::turn::Side;
use super::{Block, FINER, LOWER};
use crate::kernel::simd::{GAIN_BITS, Lanes};
use crate::solve::motion::Rows;
use crate::solve::number::{lowered, lowered_low, product, upper, within, within_word};

/// Bits by which masses are raised, so that the bits of changes of velocity stand in the upper word of a product.
const RAISED: i32 = 18;

/// The largest sum of changes of a body in a pass, in 2^-30 of a unit: beyond all velocities.
const LARGEST_GAIN: i128 = 1 << 61;

/// The changes of the velocities of bodies by joints in a sub-step, by row.
///
/// # Ranges
/// Changes by a joint are below 2^100: sums over 2^24 joints are below 2^124.
#[derive(Clone, Debug, Default)]
pub(super) struct Gains {
    rows: Vec<Gain>,
    /// The ropes of pulleys.
    ropes: Vec<RopeSums>,
}

/// The changes of the velocity of a body, in 2^-30 of a unit: joints give all of the sub-step in each pass, and the body takes up the difference.
#[derive(Clone, Copy, Debug, Default)]
struct Gain {
    sums: [i128; 3],
    /// The sums of the pass before.
    applied: [i128; 3],
    /// True if the joints of the body take part in the pass: all of them do, or none.
    is_new: bool,
}

impl Gains {
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.rows.capacity() + self.ropes.capacity()
    }

    /// The changes of all rows in the pass.
    #[cfg(test)]
    pub(super) fn sums(&self) -> Vec<[i128; 3]> {
        self.rows.iter().map(|gain| gain.sums).collect()
    }

    /// Forgets the step before.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.ropes.clear();
    }

    /// Begins a step with so many rows, none of which has changed.
    pub(super) fn set_rows(&mut self, row_count: u32) {
        self.rows.resize(row_count as usize, Gain::default());
    }

    /// Adds the rope of a pulley. Returns its number.
    pub(super) fn add_rope(&mut self) -> u32 {
        self.ropes.push(RopeSums::default());
        self.ropes.len() as u32 - 1
    }

    /// Begins a sub-step of all ropes.
    pub(super) fn begin_ropes(&mut self) {
        self.ropes.iter_mut().for_each(RopeSums::begin);
    }

    /// Adds up the changes of all ropes that moved the bodies.
    pub(super) fn weigh_ropes(&mut self) {
        self.ropes.iter_mut().for_each(RopeSums::weigh);
    }

    /// The sums along x and y of the second body of a pulley: of the changes of all sub-steps, and of the changes up to the moves.
    pub(super) fn rope_totals(&self, block: &Block) -> Option<[[i128; 2]; 2]> {
        let &RopeSums { change, applied, weighted, .. } = self.ropes.get(block.rope as usize)?;
        Some([[applied[0] + change[0], applied[1] + change[1]], weighted])
    }

    /// Adds changes of the velocity of a body.
    #[inline(always)]
    pub(super) fn add(&mut self, row: u32, changes: [i128; 3], sign: i128) {
        if let Some(gain) = self.rows.get_mut(row as usize) {
            gain.add(changes, sign);
        }
    }

    /// Gives the changes to the bodies, which have none then. Returns the number of values that were cut off.
    #[inline(always)]
    pub(super) fn apply<L: Lanes>(&mut self, rows: &mut Rows, touched: &[u32], lanes: L) -> u64 {
        for &row in touched {
            let (gain, Gain { sums, applied, is_new }) =
                (&mut rows.rows[row as usize].gain, &mut self.rows[row as usize]);
            if *is_new {
                for axis in 0..3 {
                    let change = sums[axis] - applied[axis];
                    // Most often a word.
                    let word = change as i64;
                    let is_word = i128::from(word) == change;
                    gain[axis] += if is_word { within_word(word, LARGEST_GAIN) } else { within(change, LARGEST_GAIN) };
                }
                (*sums, *applied, *is_new) = ([0; 3], *sums, false);
            }
        }
        rows.apply_gains(lanes, touched)
    }
}

impl Gain {
    /// Adds the changes by a joint.
    #[inline(always)]
    fn add(&mut self, changes: [i128; 3], sign: i128) {
        for (sum, change) in self.sums.iter_mut().zip(changes) {
            *sum += sign * change;
        }
        self.is_new = true;
    }
}

/// The magnitude of a value; of a negative one less by one.
#[inline(always)]
fn magnitude(value: i64) -> i64 {
    value ^ (value >> 63)
}

impl Block {
    /// Begins a sub-step with the impulses of the one before, at the present arms.
    #[inline(always)]
    pub(super) fn warm_start(&mut self, gains: &mut Gains) {
        self.around += self.impulses[2];
        self.change = self.sums(self.impulses);
        self.give_gains(gains);
    }

    /// Takes note of changed impulses in the change of the sub-step.
    ///
    /// Axes stay from the warm start to the move: up to there the change is the sum of the impulses themselves. After the move it is part of
    /// `applied`, too.
    #[inline(always)]
    pub(super) fn push(&mut self, before: [i64; 3], is_biased: bool) {
        let [first, second, third] = self.impulses;
        self.around += third - before[2];
        if is_biased {
            self.change = self.sums(self.impulses);
            return;
        }
        let sums = self.sums([first - before[0], second - before[1], third - before[2]]);
        self.change.add(&sums);
        self.applied.add(&sums);
    }

    /// Adds up the change that moved the bodies.
    #[inline(always)]
    pub(super) fn weigh(&mut self) {
        self.applied.add(&self.change);
        self.weighted.add(&self.applied);
    }

    /// The sums of impulses of the rows; of a pulley along x and y of the first body.
    #[inline(always)]
    pub(super) fn sums(&self, impulses: [i64; 3]) -> Sums {
        if self.holds_point() {
            // The axes are the world's.
            let ([first, second, third], [[ka, kb], [la, lb], [ma, mb]]) = (impulses, self.crosses);
            let mut turns = [product(first, ka) + product(second, la), product(first, kb) + product(second, lb)];
            if self.is_active[2] {
                turns = [turns[0] + product(third, ma), turns[1] + product(third, mb)];
            }
            return Sums { linear: [i128::from(first) << 30, i128::from(second) << 30], turns };
        }
        let (mut linear, mut turns) = ([0; 2], [0; 2]);
        for (row, impulse) in impulses.into_iter().enumerate() {
            if self.is_active[row] {
                let ([ux, uy], [ka, kb]) = (self.axes[row], self.crosses[row]);
                linear = [linear[0] + product(impulse, ux), linear[1] + product(impulse, uy)];
                turns = [turns[0] + product(impulse, ka), turns[1] + product(impulse, kb)];
            }
        }
        Sums { linear, turns }
    }

    /// The sums along x and y of the second body by impulses of the rows, of which these are along x and y of the first one.
    pub(super) fn linear_of_second(&self, linear: [i128; 2], impulses: [i64; 3]) -> [i128; 2] {
        if self.is_pulley() { self.axes[1].map(|part| product(impulses[0], part)) } else { linear }
    }

    /// Adds the impulses of an impact.
    pub(super) fn strike(&mut self, impulses: [i64; 3], gains: &mut Gains) {
        let sums = self.sums(impulses);
        self.around += impulses[2];
        self.is_struck = true;
        self.applied.add(&sums);
        let linear = self.linear_of_second(sums.linear, impulses);
        if let Some(rope) = gains.ropes.get_mut(self.rope as usize) {
            (0..2).for_each(|axis| rope.applied[axis] += linear[axis]);
        }
    }

    /// Takes the way by the impulses of an impact back that the bodies would have gone before it.
    pub(super) fn take_back(&mut self, impulses: [i64; 3], gains: &mut Gains) {
        let impulses = impulses.map(|impulse| -impulse);
        let sums = self.sums(impulses);
        self.weighted.add(&sums);
        let linear = self.linear_of_second(sums.linear, impulses);
        if let Some(rope) = gains.ropes.get_mut(self.rope as usize) {
            (0..2).for_each(|axis| rope.weighted[axis] += linear[axis]);
        }
    }

    /// The bits from products of masses and lowered impulses down to gains. Masses of rows have at most 50 bits: there are at least 8 bits left.
    #[inline(always)]
    fn gain_bits(&self) -> i32 {
        self.mass_bits + FINER + 30 - LOWER - GAIN_BITS
    }

    /// The changes of velocity of a body by impulses along x and y and around, as of the second body, in units 2^coarse times as large as the units of
    /// gains. Products with masses are below 2^107.
    pub(super) fn gains(&self, side: usize, [x, y, turn]: [i128; 3], coarse: i32) -> [i128; 3] {
        let masses = self.sides[side].masses.map(i128::from);
        let bits = self.gain_bits() + coarse;
        let gain = |axis: usize, impulse: i128| lowered(masses[axis] * lowered(impulse, LOWER), bits);
        [gain(0, x), gain(1, y), gain(2, turn)]
    }

    /// Adds the changes of velocity by the impulses of the sub-step to the gains of the bodies.
    #[inline(always)]
    pub(super) fn give_gains(&self, gains: &mut Gains) {
        // The bits that are lowered away are below 2^-18 of a unit of velocity, and exact in the end.
        let Sums { linear: [x, y], turns: [turn_a, turn_b] } = self.change;
        let [x, y] = if self.holds_point() {
            [self.impulses[0] << (30 - LOWER), self.impulses[1] << (30 - LOWER)]
        } else {
            [lowered_low(x, LOWER), lowered_low(y, LOWER)]
        };
        let [turn_a, turn_b] = [lowered_low(turn_a, LOWER), lowered_low(turn_b, LOWER)];
        let bound = magnitude(x) | magnitude(y) | magnitude(turn_a) | magnitude(turn_b);
        let [first, second] = [self.sides[0].row as usize, self.sides[1].row as usize];
        let up = 64 - RAISED - self.gain_bits();
        let count = gains.rows.len();
        // Rows are checked ahead of the products as well: compilers know that a factor is a word within a block only.
        if bound >> (63 - up) != 0 || self.is_pulley() || first >= count || second >= count {
            return self.give_large_gains(gains);
        }
        let [x, y, turn_a, turn_b] = [x << up, y << up, turn_a << up, turn_b << up];
        let (first_gain, second_gain) = (self.sides[0].gain([x, y, turn_a]), self.sides[1].gain([x, y, turn_b]));
        gains.rows[first].add(first_gain.map(i128::from), -1);
        gains.rows[second].add(second_gain.map(i128::from), 1);
    }

    /// [`give_gains`](Self::give_gains) by impulses of any size, and of pulleys.
    #[cold]
    pub(super) fn give_large_gains(&self, gains: &mut Gains) {
        let mut linear = [self.change.linear; 2];
        if let Some(rope) = gains.ropes.get_mut(self.rope as usize) {
            rope.pull(self.impulses[0], self.axes[1]);
            linear[1] = rope.change;
        }
        for (side, sign) in [(0, -1), (1, 1)] {
            if !self.sides[side].is_movable() {
                continue;
            }
            let [x, y] = linear[side];
            let gain = self.gains(side, [x, y, self.change.turns[side]], 0);
            gains.rows[self.sides[side].row as usize].add(gain, sign);
        }
    }
}

/// Sums of impulses, in 2^-30: along x and y, and around both bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solve) struct Sums {
    pub(super) linear: [i128; 2],
    pub(super) turns: [i128; 2],
}

/// The sums along x and y of the second body of a pulley, whose rope pulls its bodies in directions of their own.
#[derive(Clone, Copy, Debug, Default)]
struct RopeSums {
    /// The impulse of the rope in the change.
    impulse: i64,
    change: [i128; 2],
    applied: [i128; 2],
    weighted: [i128; 2],
}

impl RopeSums {
    /// Begins a sub-step.
    fn begin(&mut self) {
        (0..2).for_each(|axis| self.applied[axis] += self.change[axis]);
        (self.change, self.impulse) = ([0; 2], 0);
    }

    /// Adds the changes that moved the bodies.
    fn weigh(&mut self) {
        (0..2).for_each(|axis| self.weighted[axis] += self.applied[axis] + self.change[axis]);
    }

    /// Adds the impulse of the rope along its axis, less the part that was added before.
    fn pull(&mut self, impulse: i64, axis: [i64; 2]) {
        for (change, part) in self.change.iter_mut().zip(axis) {
            *change += product(impulse - self.impulse, part);
        }
        self.impulse = impulse;
    }
}

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, sums: &Self) {
        for i in 0..2 {
            self.linear[i] += sums.linear[i];
            self.turns[i] += sums.turns[i];
        }
    }
}

impl Side {
    /// The change of velocity by raised impulses of the sub-step. Masses are at most 2^44, so that the products of raised masses and of impulses
    /// along x and y and of rotation, which are below 2^63, are below 2^126.
    #[inline(always)]
    fn gain(&self, [x, y, turn]: [i64; 3]) -> [i64; 3] {
        let [mx, my, angular] = self.masses;
        [upper(product(mx << RAISED, x)), upper(product(my << RAISED, y)), upper(product(angular << RAISED, turn))]
    }
}
