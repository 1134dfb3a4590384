//! The laws of joints in loops: a row of the system where a law holds a velocity or a spring bends, and an impulse that is given where a force is
//! at its largest.

use core::ops::Range;

use super::{DIRECTION, FINER_STILL, ITERATIONS, LoopJoint, ROUNDS, iterate, move_by};
use crate::scalar::FxFactor;
use crate::solve::joint::axis::{Aim, AxisRow};
use crate::solve::joint::laws::RowChange;
use crate::solve::joint::tree::{FRACTION, RESIDUAL};
use crate::solve::joint::{Block, FINER};
use crate::solve::number::{divided, exponent, fixed, lowered, lowered_word, shifted, shifted_word, within};
use crate::solve::unit::SoftRow;

/// A loop with laws in a pass.
pub(super) struct LawLoop<'a> {
    pub(super) joints: &'a mut [LoopJoint],
    pub(super) blocks: &'a [Block],
    pub(super) soft: &'a SoftRow,
    pub(super) moved: &'a mut [[i64; 3]],
    pub(super) bodies: Range<usize>,
}

impl LawLoop<'_> {
    /// Solves the loop until no row leaves its place, or [`ROUNDS`] times.
    pub(super) fn solve(&mut self, laws: &mut [AxisRow]) {
        for _ in 0..ROUNDS {
            self.solve_aims(laws);
            let mut have_left = false;
            for (joint, block) in self.joints.iter().zip(self.blocks) {
                have_left |= block.revise_laws(laws, joint.row_changes(block));
            }
            if !have_left {
                return;
            }
        }
    }

    /// Solves the loop for the present aims of its laws, whose impulses that are given come first, and finds the velocities of rows by the solution.
    fn solve_aims(&mut self, laws: &[AxisRow]) {
        let Self { joints, blocks, soft, moved, bodies } = self;
        for (joint, block) in joints.iter_mut().zip(*blocks) {
            joint.set_aims(block, laws, soft);
        }
        move_by(joints, blocks, moved, bodies.clone());
        for (joint, block) in joints.iter_mut().zip(*blocks) {
            joint.begin_round(block);
        }
        let step = iterate::<3>(joints, blocks, moved, bodies.clone(), ITERATIONS);
        for joint in joints.iter_mut() {
            joint.advance::<3>(step);
            joint.direction = joint.solution.map(|solution| within(solution.into(), DIRECTION));
        }
        move_by(joints, blocks, moved, bodies.clone());
    }
}

impl LoopJoint {
    /// The changes of the rows in a round.
    fn row_changes(&self, block: &Block) -> [RowChange; 3] {
        [0, 1, 2].map(|row| RowChange {
            velocity: self.velocity[row] - self.gives(block, row),
            impulse: lowered_word(self.solution[row], FINER_STILL),
        })
    }

    /// Sets the aims of the laws in a round, and takes the impulses that are given as the direction.
    fn set_aims(&mut self, block: &Block, laws: &[AxisRow], soft: &SoftRow) {
        let [first, second] = self.start;
        self.residual = [first, second, 0];
        self.given = [0; 3];
        for row in 0..3 {
            if let Some(law) = laws.get(block.laws[row] as usize) {
                (self.mass[row], self.compliance[row], self.residual[row]) = (0, 0, 0);
                self.set_aim(block, law, row, soft);
            }
        }
        self.direction = self.given;
    }

    /// Sets the aim of a law in a round.
    fn set_aim(&mut self, block: &Block, law: &AxisRow, row: usize, soft: &SoftRow) {
        let mass = block.element(0, row, row) + block.element(1, row, row);
        let bits = block.mass_bits + FINER - FRACTION;
        match law.aim(block.impulses[row]) {
            Aim::Velocity { velocity, gives_way } => {
                self.compliance[row] = lowered(mass * i128::from(soft.compliance), 30) as i64;
                let mut sum = i128::from(shifted_word(velocity, 30 - FRACTION));
                if gives_way {
                    sum += shifted(i128::from(self.compliance[row]) * i128::from(block.impulses[row]), bits);
                }
                self.residual[row] = -within(sum, RESIDUAL);
                self.mass[row] = mass as i64 + self.compliance[row];
            }
            Aim::Impulse { change, is_elastic } => {
                // A spring that gives way by more than 2^8 times the inverse mass has no damping to speak of.
                let scale = block.mass_exponent + block.mass_bits + FINER;
                let softness = if law.damping.is_zero() { None } else { Some(FxFactor::ONE.over(law.damping)) };
                let softness = softness.filter(|&softness| is_elastic && exponent(softness) + scale < 54);
                match softness {
                    Some(softness) => {
                        self.compliance[row] = fixed(softness, scale);
                        let sum = shifted(i128::from(self.compliance[row]) * i128::from(change), bits);
                        self.residual[row] = within(sum, RESIDUAL);
                        self.mass[row] = mass as i64 + self.compliance[row];
                    }
                    None => self.given[row] = within(i128::from(change) << FINER_STILL, DIRECTION),
                }
            }
        }
    }

    /// Begins a round, once the velocities by given impulses are known.
    fn begin_round(&mut self, block: &Block) {
        for row in 0..3 {
            if self.is_solved(row) {
                let residual = i128::from(self.residual[row]) - i128::from(self.velocity[row]);
                self.residual[row] = within(residual, RESIDUAL);
            }
        }
        self.solution = self.given;
        self.precondition::<3>(block);
        self.direction = self.preconditioned;
    }

    /// The part of P r of a row that has a mass of its own.
    #[inline(always)]
    pub(super) fn precondition_alone(&self, block: &Block, row: usize) -> i64 {
        if self.mass[row] == 0 {
            return 0;
        }
        // Below 2^36 · 2^62.
        let up = block.mass_bits + FINER + FINER_STILL - FRACTION;
        within(divided(i128::from(self.residual[row]) << up, self.mass[row]), DIRECTION)
    }
}
