//! Loops of pins, the usual ones: all joints hold a point, and none has a law.
//!
//! The iterations go over the joints nine times a pass, and blocks are as large as caches: so all that iterations need of a joint stands in a record.
//!
//! Reads: blocks, poses, velocities of bodies. Writes: records, and velocities of bodies by directions. [`gradients`](super) has the ranges.

use core::hint::black_box;

use super::kernels::{
    PairInverse, compliance_room, has_usual_masses, in_coarser_unit, moved_bits, multiple, raised_velocities,
    times_inverse,
};
use super::{DIRECTION, FINER_STILL, FRACTION, LoopJoint, MOVED, RESIDUAL, SOLUTION, STILL, Steps};
use crate::slots::NONE;
use crate::solve::joint::turn::Pose;
use crate::solve::joint::{Block, LOWER};
use crate::solve::motion::Rows;
use crate::solve::number::{lowered_low, lowered_word, product, upper, within_word};
use crate::solve::unit::SoftRow;

/// Bits from products of velocities of bodies and of axes down to velocities of rows.
const LOWERED: i32 = 30 + MOVED - FRACTION;

/// A joint of a loop of pins.
#[derive(Clone, Debug, Default)]
pub(super) struct Pin {
    /// The bodies of its sides among the bodies of loops; [`STILL`] for bodies that cannot be moved, whose masses are zero.
    bodies: [u32; 2],
    /// The cross products by row and body: within 2^30.5.
    crosses: [[i32; 2]; 2],
    /// The masses of both bodies, raised so that velocities stand in the upper words of their products.
    masses: [[i64; 3]; 2],
    /// Elements 11, 12 and 22 of P, which have 31 bits, in 2^-shift.
    inverse: [i32; 3],
    inverse_shift: i32,
    /// γ, raised so that velocities stand in the upper words of its products.
    compliance: i64,
    /// log2 of the coarsest unit of impulses of the loop over the unit of the joint.
    coarser: i32,
    rows: [PinRow; 2],
}

/// The values of a row. They stand by row: where both rows' values stand side by side compilers work on pairs of them, and move each in and out of a
/// vector.
#[derive(Clone, Debug, Default)]
struct PinRow {
    residual: i64,
    direction: i64,
    solution: i64,
    /// The velocity by the direction, and P r from the next residual up to the next direction.
    velocity: i64,
}

impl Block {
    /// Returns true if the joint is a pin whose masses are of the usual sizes.
    pub(super) fn is_usual_pin(&self) -> bool {
        self.holds_point() && self.laws == [NONE; 3] && has_usual_masses(moved_bits(self))
    }
}

impl Pin {
    /// The record of a joint in a step.
    pub(super) fn new(joint: &LoopJoint, block: &Block) -> Self {
        let up = 64 - moved_bits(block);
        let [first, second] = &block.sides;
        Self {
            bodies: joint.bodies.map(|body| if body == NONE { STILL } else { body }),
            masses: [first.masses.map(|mass| mass << up), second.masses.map(|mass| mass << up)],
            coarser: joint.coarser,
            ..Self::default()
        }
    }

    /// Takes the arms of the joint, and finds P and γ.
    #[inline(always)]
    pub(super) fn turn_to(&mut self, block: &Block, compliance: i32) {
        let PairInverse { elements, shift, compliance } = block.pair_inverse(compliance);
        let [first, second, _] = block.crosses;
        self.crosses = [first.map(|cross| cross as i32), second.map(|cross| cross as i32)];
        (self.inverse, self.inverse_shift) = (elements.map(|element| element as i32), shift);
        self.compliance = compliance << compliance_room(block);
    }

    /// Begins a pass with the residual of the rows.
    #[inline(always)]
    pub(super) fn begin(&mut self, block: &Block, poses: &[Pose], rows: &Rows, soft: &SoftRow, is_biased: bool) {
        let compliance = self.compliance >> compliance_room(block);
        let residual = block.residual_of([compliance; 2], poses, rows, soft, is_biased);
        for (row, residual) in self.rows.iter_mut().zip(residual) {
            *row = PinRow { residual, ..PinRow::default() };
        }
        let direction = self.preconditioned();
        for (row, direction) in self.rows.iter_mut().zip(direction) {
            row.direction = direction;
        }
    }

    /// The changes of the impulses.
    #[inline(always)]
    pub(super) fn changes(&self) -> [i64; 3] {
        let [x, y] = &self.rows;
        [lowered_word(x.solution, FINER_STILL), lowered_word(y.solution, FINER_STILL), 0]
    }

    /// Its bodies among the velocities of all. They are checked ahead of the products: compilers know that a factor is a word within a block only.
    #[inline(always)]
    fn bodies_in(&self, moved: &[[i64; 3]]) -> Option<[usize; 2]> {
        let bodies = self.bodies.map(|body| body as usize);
        (bodies[0] < moved.len() && bodies[1] < moved.len()).then_some(bodies)
    }

    /// P r
    #[inline(always)]
    fn preconditioned(&self) -> [i64; 2] {
        let [x, y] = &self.rows;
        times_inverse(self.inverse.map(i64::from), self.inverse_shift, [x.residual, y.residual])
    }
}

impl Steps<2> for Pin {
    #[inline(always)]
    fn square(&self) -> i128 {
        let [x, y] = &self.rows;
        in_coarser_unit(product(x.residual, x.direction) + product(y.residual, y.direction), self.coarser)
    }

    #[inline(always)]
    fn move_bodies(&self, _: &Block, moved: &mut [[i64; 3]]) {
        let Some([a, b]) = self.bodies_in(moved) else { return };
        let [first, second] = [self.rows[0].direction, self.rows[1].direction];
        let [[ka, kb], [la, lb]] = self.crosses.map(|row| row.map(i64::from));
        let turn = |k: i64, l: i64| lowered_low(product(first, k) + product(second, l), LOWER);
        let [x, y] = [first << (30 - LOWER), second << (30 - LOWER)];
        let changes = [
            raised_velocities(self.masses[0], [x, y, turn(ka, la)]),
            raised_velocities(self.masses[1], [x, y, turn(kb, lb)]),
        ];
        (0..3).for_each(|axis| moved[a][axis] -= changes[0][axis]);
        (0..3).for_each(|axis| moved[b][axis] += changes[1][axis]);
    }

    #[inline(always)]
    fn set_velocity(&mut self, _: &Block, moved: &[[i64; 3]], are_slow: bool) -> i128 {
        let Some([a, b]) = self.bodies_in(moved) else { return 0 };
        let (a, b) = (moved[a], moved[b]);
        let [[ka, kb], [la, lb]] = self.crosses.map(|row| row.map(i64::from));
        let along = if are_slow {
            // Below 2^62.3.
            let sum = |axis: usize, ka: i64, kb: i64| ((b[axis] - a[axis]) << 30) + (kb * b[2] - ka * a[2]);
            [sum(0, ka, kb), sum(1, la, lb)].map(|sum| lowered_word(sum, LOWERED))
        } else {
            // Below 2^76.
            let sum = |axis: usize, ka: i64, kb: i64| {
                product(1 << 30, b[axis] - a[axis]) + product(kb, b[2]) - product(ka, a[2])
            };
            [sum(0, ka, kb), sum(1, la, lb)].map(|sum| lowered_low(sum, LOWERED))
        };
        let mut sum = 0;
        for (row, along) in self.rows.iter_mut().zip(along) {
            let gives = within_word(upper(product(self.compliance, row.direction)), RESIDUAL);
            row.velocity = within_word(along + gives, RESIDUAL);
            sum += product(row.velocity, row.direction);
        }
        in_coarser_unit(sum, self.coarser)
    }

    #[inline(always)]
    fn advance(&mut self, step: i64) {
        let step = black_box(step);
        for row in &mut self.rows {
            row.solution = within_word(row.solution + multiple(row.direction, step), SOLUTION);
        }
    }

    #[inline(always)]
    fn lower_residual(&mut self, _: &Block, step: i64) -> i128 {
        let step = black_box(step);
        for row in &mut self.rows {
            row.residual = within_word(row.residual - multiple(row.velocity, step), RESIDUAL);
        }
        let mut sum = 0;
        let preconditioned = self.preconditioned();
        for (row, preconditioned) in self.rows.iter_mut().zip(preconditioned) {
            row.velocity = preconditioned;
            sum += product(row.residual, preconditioned);
        }
        in_coarser_unit(sum, self.coarser)
    }

    #[inline(always)]
    fn turn(&mut self, kept: i64) {
        let kept = black_box(kept);
        for row in &mut self.rows {
            row.direction = within_word(row.velocity + multiple(row.direction, kept), DIRECTION);
        }
    }
}
