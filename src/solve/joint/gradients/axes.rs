//! The axes of joints in loops: a third row of the system where an axis holds a velocity or a spring bends, and an impulse that is given where
//! a force is at its largest.

use core::ops::Range;

use super::{DIRECTION, FINER_STILL, LoopJoint, move_by, within};
use crate::scalar::FxFactor;
use crate::solve::joint::axis::Aim;
use crate::solve::joint::tree::{FRACTION, RESIDUAL};
use crate::solve::joint::{Block, FINER};
use crate::solve::motion::Rows;
use crate::solve::number::{exponent, fixed, lowered, shifted, shifted_word};
use crate::solve::unit::SoftRow;

/// value/divisor to nearest, halves away from zero. *Domain* |value| < 2^125, divisor > 0.
fn divided(value: i128, divisor: i64) -> i128 {
    let divisor = i128::from(divisor);
    value.signum() * ((2 * value.abs() + divisor) / (2 * divisor))
}

/// Begins the iterations: sets the aims of axes, and gives the impulses of axes that do not follow from velocities.
pub(super) fn give(
    joints: &mut [LoopJoint],
    blocks: &[Block],
    rows: &Rows,
    soft: &SoftRow,
    moved: &mut [[i64; 3]],
    bodies: Range<usize>,
) {
    for (joint, block) in joints.iter_mut().zip(blocks) {
        joint.set_aim(block, rows, soft);
    }
    move_by(joints, blocks, moved, bodies);
    for (joint, block) in joints.iter_mut().zip(blocks) {
        joint.begin_round(block);
    }
}

/// Moves axes on that have left their places. Returns true if there is one.
pub(super) fn revise_axes(
    joints: &mut [LoopJoint],
    blocks: &mut [Block],
    rows: &Rows,
    moved: &mut [[i64; 3]],
    bodies: Range<usize>,
) -> bool {
    for joint in joints.iter_mut() {
        joint.direction = joint.solution.map(|solution| within(solution.into(), DIRECTION));
    }
    move_by(joints, blocks, moved, bodies);
    let mut have_left = false;
    for (joint, block) in joints.iter().zip(blocks).filter(|(_, block)| block.axis.is_some()) {
        let gives = joint.gives(block, 2);
        let push = lowered(joint.solution[2].into(), FINER_STILL);
        have_left |= block.revise_axis(rows, joint.velocity[2] - gives, push);
    }
    have_left
}

/// Settles all axes at the impulses of the last round.
pub(super) fn settle_axes(joints: &[LoopJoint], blocks: &mut [Block]) {
    for (joint, block) in joints.iter().zip(blocks) {
        block.settle_axis(lowered(joint.solution[2].into(), FINER_STILL));
    }
}

impl LoopJoint {
    /// Sets the aim of the axis in a round, and takes the impulse that is given as the direction.
    fn set_aim(&mut self, block: &Block, rows: &Rows, soft: &SoftRow) {
        (self.axis_mass, self.axis_compliance, self.given) = (0, 0, 0);
        let [first, second] = self.start;
        self.residual = [first, second, 0];
        if let (Some(aim), Some(axis)) = (block.aim(rows), &block.axis) {
            let mass = block.element(0, 2, 2) + block.element(1, 2, 2);
            let bits = block.mass_bits + FINER - FRACTION;
            match aim {
                Aim::Velocity { velocity, gives_way } => {
                    self.axis_compliance = lowered(mass * i128::from(soft.compliance), 30) as i64;
                    let mut sum = i128::from(shifted_word(velocity, 30 - FRACTION));
                    if gives_way {
                        sum += shifted(i128::from(self.axis_compliance) * i128::from(block.impulses[2]), bits);
                    }
                    self.residual[2] = -within(sum, RESIDUAL);
                    self.axis_mass = mass as i64 + self.axis_compliance;
                }
                Aim::Impulse { change, is_elastic } => {
                    // A spring that gives way by more than 2^8 times the inverse mass has no damping to speak of.
                    let scale = block.mass_exponent + block.mass_bits + FINER;
                    let softness = if axis.damping.is_zero() { None } else { Some(FxFactor::ONE.over(axis.damping)) };
                    let softness = softness.filter(|&softness| is_elastic && exponent(softness) + scale < 54);
                    match softness {
                        Some(softness) => {
                            self.axis_compliance = fixed(softness, scale);
                            let sum = shifted(i128::from(self.axis_compliance) * i128::from(change), bits);
                            self.residual[2] = within(sum, RESIDUAL);
                            self.axis_mass = mass as i64 + self.axis_compliance;
                        }
                        None => self.given = within(i128::from(change) << FINER_STILL, DIRECTION),
                    }
                }
            }
        }
        self.direction = [0, 0, self.given];
    }

    /// Begins a round, once the velocities by given impulses are known.
    fn begin_round(&mut self, block: &Block) {
        for row in 0..3 {
            if row < 2 || self.axis_mass > 0 {
                let residual = i128::from(self.residual[row]) - i128::from(self.velocity[row]);
                self.residual[row] = within(residual, RESIDUAL);
            }
        }
        self.solution = [0, 0, self.given];
        self.precondition(block);
        self.direction = self.preconditioned;
    }

    /// The part of P r of the axis, for its residual.
    pub(super) fn precondition_axis(&self, block: &Block, residual: i128) -> i64 {
        if self.axis_mass == 0 {
            return 0;
        }
        // Below 2^36 · 2^62.
        let up = block.mass_bits + FINER + FINER_STILL - FRACTION;
        within(divided(residual << up, self.axis_mass), DIRECTION)
    }
}
