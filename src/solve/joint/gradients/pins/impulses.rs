//! The impulses of pins: their changes by a pass, the changes of velocity that they give, and their sums.
//!
//! Reads: the solutions of passes. Writes: impulses, gains of bodies; in the end the sums of blocks.
//!
//! # Ranges
//! Impulses are within 2^50, their products with crosses below 2^81: the sums over 16 sub-steps of the sums over these are below 2^89. In limbs, the
//! upper ones are below 2^59 and the lower ones below 2^38. Changes of velocity are lowered by 38 bits: of masses up to 2^57 they fit in words where
//! lowered impulses are within [`LARGE`].

use core::ops::Range;

use super::{FINER_STILL, PinGroup};
use crate::kernel::simd::{GROUP, Lanes, Speeds};
use crate::solve::joint::gains::{Gains, Sums};
use crate::solve::joint::{Block, IMPULSE, LOWER};
use crate::solve::number::{lowered, product};

/// The largest lowered impulse of lanes.
const LARGE: i64 = 1 << 43;
/// Bits from products of raised masses and lowered impulses down to changes of velocity.
const GAIN_SHIFT: i32 = 38;

/// Sums of impulses of joints side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct LimbSums {
    /// Along x and y.
    linear: [[i64; GROUP]; 2],
    /// Around both bodies, by limb: in 2^30 and 1, in 2^-30.
    turns: [[[i64; GROUP]; 2]; 2],
}

impl LimbSums {
    /// Adds impulses along x and y and around both bodies.
    #[inline(always)]
    fn add<L: Lanes>(&mut self, lanes: L, at: usize, linear: &[[i64; GROUP]; 2], turns: &[[[i64; GROUP]; 2]; 2]) {
        add_rows(lanes, &mut self.linear, at, PinGroup::rows(lanes, linear, at));
        add_rows(lanes, &mut self.turns[0], at, PinGroup::rows(lanes, &turns[0], at));
        add_rows(lanes, &mut self.turns[1], at, PinGroup::rows(lanes, &turns[1], at));
    }

    /// The sums of a joint.
    fn of_lane(&self, lane: usize) -> Sums {
        let [x, y] = &self.linear;
        let turn = |[high, low]: &[[i64; GROUP]; 2]| (i128::from(high[lane]) << 30) + i128::from(low[lane]);
        Sums {
            linear: [i128::from(x[lane]) << 30, i128::from(y[lane]) << 30],
            turns: [turn(&self.turns[0]), turn(&self.turns[1])],
        }
    }
}

impl PinGroup {
    /// Begins a sub-step with the impulses of the one before, at the present arms.
    #[inline(always)]
    fn warm_start<L: Lanes>(&mut self, lanes: L, at: usize) {
        let impulses = Self::rows(lanes, &self.impulses, at);
        self.set_turns(lanes, at, impulses);
    }

    /// The impulses around both bodies, in limbs, by impulses of the rows.
    #[inline(always)]
    fn turns_by<L: Lanes>(&self, lanes: L, at: usize, impulses: [L::Wide; 2]) -> [[L::Wide; 2]; 2] {
        let ((ka, kb), (la, lb)) = (lanes.pair(&self.crosses[0], at), lanes.pair(&self.crosses[1], at));
        [lanes.dot([ka, la], impulses), lanes.dot([kb, lb], impulses)]
    }

    #[inline(always)]
    fn set_turns<L: Lanes>(&mut self, lanes: L, at: usize, impulses: [L::Wide; 2]) {
        let turns = self.turns_by(lanes, at, impulses);
        Self::set_rows(lanes, &mut self.turns[0], at, turns[0]);
        Self::set_rows(lanes, &mut self.turns[1], at, turns[1]);
    }

    /// Adds up the impulses that moved the bodies.
    #[inline(always)]
    pub(in super::super) fn weigh<L: Lanes>(&mut self, lanes: L) {
        for at in (0..GROUP).step_by(L::WIDTH) {
            self.applied.add(lanes, at, &self.impulses, &self.turns);
            self.weighted.add(lanes, at, &self.applied.linear, &self.applied.turns);
        }
    }

    /// Changes the impulses by the solution, in the solve pass if `is_biased`. Returns the number of impulses that were cut off.
    #[inline(always)]
    fn change<L: Lanes>(&mut self, lanes: L, at: usize, is_biased: bool) -> u64 {
        let (before, solution) = (Self::rows(lanes, &self.impulses, at), Self::rows(lanes, &self.solution, at));
        let (mut after, mut changes, mut cut) = (before, before, 0);
        for row in 0..2 {
            let wanted = lanes.add(before[row], lanes.rounded_oddly::<FINER_STILL>(solution[row]));
            after[row] = lanes.clamped(wanted, lanes.all(IMPULSE));
            changes[row] = lanes.sub(after[row], before[row]);
            cut += L::WIDTH as u32 - lanes.bits(lanes.equal(after[row], wanted)).count_ones();
        }
        Self::set_rows(lanes, &mut self.impulses, at, after);
        if is_biased {
            self.set_turns(lanes, at, after);
            return cut.into();
        }
        let turns = self.turns_by(lanes, at, changes);
        add_rows(lanes, &mut self.applied.linear, at, changes);
        for (side, turns) in turns.into_iter().enumerate() {
            add_rows(lanes, &mut self.turns[side], at, turns);
            add_rows(lanes, &mut self.applied.turns[side], at, turns);
        }
        cut.into()
    }

    /// Adds the changes of velocity by the impulses of the sub-step to the sums of bodies. Returns false, and adds nothing, if one is beyond a limit.
    #[inline(always)]
    fn give_gains<L: Lanes>(&self, lanes: L, at: usize, limit: i64, sums: &mut [Speeds]) -> bool {
        let (impulses, up) = (Self::rows(lanes, &self.impulses, at), lanes.all(i64::from(30 - LOWER)));
        let [x, y] = [lanes.raised_by(impulses[0], up), lanes.raised_by(impulses[1], up)];
        let turn_a = lanes.lowered_limbs(Self::rows(lanes, &self.turns[0], at));
        let turn_b = lanes.lowered_limbs(Self::rows(lanes, &self.turns[1], at));
        let first = self.gains(lanes, at, 0, [x, y, turn_a]);
        let second = self.gains(lanes, at, 1, [x, y, turn_b]);
        let large = lanes.greater(lanes.largest([x, y, turn_a, turn_b]), lanes.all(LARGE));
        let gains = [first[0], first[1], first[2], second[0], second[1], second[2]];
        let beyond = lanes.greater(lanes.largest(gains), lanes.all(limit));
        if lanes.bits(lanes.either(large, beyond)) != 0 {
            return false;
        }
        let zero = lanes.all(0);
        let first = [lanes.sub(zero, first[0]), lanes.sub(zero, first[1]), lanes.sub(zero, first[2])];
        lanes.add_speeds(sums, &self.bodies[0], at, first);
        lanes.add_speeds(sums, &self.bodies[1], at, second);
        true
    }

    /// The changes of velocity of a body by lowered impulses.
    #[inline(always)]
    fn gains<L: Lanes>(&self, lanes: L, at: usize, side: usize, [x, y, turn]: [L::Wide; 3]) -> [L::Wide; 3] {
        let [mass_x, mass_y, angular] = &self.masses[side];
        [
            lanes.lowered_product(lanes.wide(mass_x, at), x),
            lanes.lowered_product(lanes.wide(mass_y, at), y),
            lanes.lowered_product(lanes.wide(angular, at), turn),
        ]
    }

    /// [`give_gains`](Self::give_gains) of one joint by impulses of any size.
    #[cold]
    fn give_large_gains(&self, lane: usize, rows: &[u32], gains: &mut Gains) {
        let linear = [self.impulses[0][lane] << (30 - LOWER), self.impulses[1][lane] << (30 - LOWER)];
        for (side, sign) in [(0, -1), (1, 1)] {
            let [high, low] = &self.turns[side];
            let turn = lowered((i128::from(high[lane]) << 30) + i128::from(low[lane]), LOWER) as i64;
            let mut changes = [0; 3];
            for (axis, impulse) in [linear[0], linear[1], turn].into_iter().enumerate() {
                changes[axis] = lowered(product(self.masses[side][axis][lane], impulse), GAIN_SHIFT);
            }
            if let Some(&row) = rows.get(self.bodies[side][lane] as usize) {
                gains.add(row, changes, sign);
            }
        }
    }

    /// Hands the impulses of a joint to its block, and adds its sums.
    fn store(&self, lane: usize, block: &mut Block) {
        (block.impulses[0], block.impulses[1]) = (self.impulses[0][lane], self.impulses[1][lane]);
        block.applied.add(&self.applied.of_lane(lane));
        block.weighted.add(&self.weighted.of_lane(lane));
    }
}

#[inline(always)]
fn add_rows<L: Lanes>(lanes: L, [x, y]: &mut [[i64; GROUP]; 2], at: usize, changes: [L::Wide; 2]) {
    lanes.store(x, at, lanes.add(lanes.wide(x, at), changes[0]));
    lanes.store(y, at, lanes.add(lanes.wide(y, at), changes[1]));
}

/// The impulses of a loop of pins, and the sums of the changes of velocity of its bodies.
pub(in super::super) struct PinImpulses<'a> {
    pub(in super::super) groups: &'a mut [PinGroup],
    /// By body: zero between passes.
    pub(in super::super) sums: &'a mut [Speeds],
    pub(in super::super) bodies: Range<usize>,
    /// The rows of bodies.
    pub(in super::super) rows: &'a [u32],
    /// The largest change of velocity by a joint of which a body may have as many in a word as it has joints.
    pub(in super::super) limit: i64,
}

impl PinImpulses<'_> {
    /// Begins a sub-step with the impulses of the one before.
    #[inline(always)]
    pub(in super::super) fn warm_start<L: Lanes>(self, lanes: L, gains: &mut Gains) {
        for group in self.groups.iter_mut() {
            for at in (0..GROUP).step_by(L::WIDTH) {
                group.warm_start(lanes, at);
                give(lanes, group, at, self.limit, self.sums, self.rows, gains);
            }
        }
        self.finish(gains);
    }

    /// Ends a pass. Returns the number of impulses that were cut off.
    #[inline(always)]
    pub(in super::super) fn change<L: Lanes>(self, lanes: L, is_biased: bool, gains: &mut Gains) -> u64 {
        let mut cut = 0;
        for group in self.groups.iter_mut() {
            for at in (0..GROUP).step_by(L::WIDTH) {
                cut += group.change(lanes, at, is_biased);
                give(lanes, group, at, self.limit, self.sums, self.rows, gains);
            }
        }
        self.finish(gains);
        cut
    }

    /// Hands the sums to the bodies.
    #[inline(always)]
    fn finish(self, gains: &mut Gains) {
        for (Speeds([x, y, turn, _]), &row) in self.sums[self.bodies.clone()].iter_mut().zip(&self.rows[self.bodies]) {
            gains.add(row, [i128::from(*x), i128::from(*y), i128::from(*turn)], 1);
            (*x, *y, *turn) = (0, 0, 0);
        }
    }
}

/// Adds the changes of velocity by some joints of a group.
#[inline(always)]
fn give<L: Lanes>(
    lanes: L,
    group: &PinGroup,
    at: usize,
    limit: i64,
    sums: &mut [Speeds],
    rows: &[u32],
    gains: &mut Gains,
) {
    if !group.give_gains(lanes, at, limit, sums) {
        (at..at + L::WIDTH).for_each(|lane| group.give_large_gains(lane, rows, gains));
    }
}

/// Hands the impulses of joints to their blocks at the end of a step.
pub(in super::super) fn store(groups: &[PinGroup], blocks: &mut [Block]) {
    for (group, blocks) in groups.iter().zip(blocks.chunks_mut(GROUP)) {
        blocks.iter_mut().enumerate().for_each(|(lane, block)| group.store(lane, block));
    }
}
