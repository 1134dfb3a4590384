//! Loops of joined bodies, solved by conjugate gradients: three iterations a pass.
//!
//! The impulses Δλ of all joints of a loop are wanted for which (K + γ)·Δλ = −r, with the matrix K of the velocities of rows by impulses,
//! the compliance γ and the residual r of the rows. K is never made: it is a product with the bodies in between. Each joint alone has the
//! inverse of its own matrix, P = K_j⁻¹/(1 + c): with it the iterations are preconditioned. Sums over a loop are exact, so that any order
//! of joints gives the same bits.
//!
//! With one iteration a net swings for ever, with two it rests four times as late as with three.
//!
//! # Ranges
//! Velocities of rows are in 2^-[`FRACTION`] units, within 2^36; velocities of bodies in 2^-[`MOVED`] units, by one joint within 2^40, so
//! that sums of 2^22 joints fit in 64 bits. Impulses are in 2^-[`FINER_STILL`] of the unit of the block: directions within 2^51, so that
//! their products with axes are below 2^82.5 and with masses, once lowered by [`LOWER`] bits, below 2^107; solutions within 2^58. Products
//! of residuals and directions are below 2^88, also in the unit of the coarsest joint, their sums over 2^20 joints below 2^108. Both
//! quotients of sums have 30 bits after the point and are below 2^10.

mod impact;
mod laws;

use alloc::vec::Vec;
use core::hint::black_box;
use core::ops::Range;

use self::laws::{descend, find_places};
use super::axis::AxisRow;
use super::forest::Forest;
use super::tree::{FRACTION, RESIDUAL};
use super::turn::Pose;
use super::{Block, FINER, LOWER};
use crate::slots::NONE;
use crate::solve::matrix::{Inverse, Matrix};
use crate::solve::motion::Rows;
use crate::solve::number::{bits_of, lowered, lowered_low, lowered_within, lowered_word, shifted, upper};
use crate::solve::unit::SoftRow;

/// Iterations of a pass.
const ITERATIONS: usize = 3;
/// Fraction bits of velocities of bodies.
const MOVED: i32 = 12;
/// Fraction bits of impulses, in units of the block.
const FINER_STILL: i32 = 8;
/// Bits by which residuals are raised, so that the wanted bits of their products with elements of the inverse stand in the upper word.
const RAISED_RESIDUAL: i32 = 26;
/// The largest direction and solution.
const DIRECTION: i128 = 1 << 51;
const SOLUTION: i128 = 1 << 58;
/// The largest velocity of a body by a joint, and by all of them.
const FAST: i128 = 1 << 40;
const FASTEST: i64 = 1 << 42;

/// A joint of a loop.
#[derive(Clone, Debug, Default)]
struct LoopJoint {
    /// The bodies of its sides, as numbers among the bodies of loops; [`NONE`] for a body that cannot be moved.
    bodies: [u32; 2],
    /// Elements 11, 12 and 22 of P, in 2^-shift of an impulse by 2^-[`FRACTION`] of velocity.
    inverse: [i64; 3],
    inverse_shift: i32,
    /// The share of masses that rows of the joint meet in a [descent](super::tree), as minus log2.
    share: i32,
    /// True if the inverse is of both rows along the axes; else each row has a mass of its own.
    is_pair: bool,
    /// γ of the rows, as factors of mass of the block.
    compliance: [i64; 3],
    /// The inverse masses of rows that have one of their own, with γ, likewise; zero while a row has an impulse that is given.
    mass: [i64; 3],
    /// The changes of impulses that are given.
    given: [i64; 3],
    /// log2 of the coarsest unit of impulses of the loop over the unit of the joint.
    coarser: i32,
    /// The residual of the rows that are held, at the beginning of the pass.
    start: [i64; 2],
    /// r, P r, the direction, and the sum of directions: the changes of impulses.
    residual: [i64; 3],
    preconditioned: [i64; 3],
    direction: [i64; 3],
    solution: [i64; 3],
    /// The velocity of the rows by the direction.
    velocity: [i64; 3],
}

/// All loops of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Loops {
    joints: Vec<LoopJoint>,
    /// The velocities of bodies by directions.
    moved: Vec<[i64; 3]>,
    loops: Vec<Loop>,
    /// The number of a body by its row, and the other way round.
    body_of: Vec<u32>,
    rows: Vec<u32>,
}

/// The joints and bodies of a loop.
#[derive(Clone, Debug)]
struct Loop {
    joints: Range<usize>,
    bodies: Range<usize>,
    /// True if a row of one of its joints has a law.
    has_laws: bool,
}

/// The largest number of times that a loop is solved in a pass: until no row leaves its place.
const ROUNDS: usize = 4;

/// a/b in 2^-30, within 2^10. *Domain* a ≥ 0, b > 0.
fn quotient(a: i128, b: i128) -> i64 {
    let bits = 128 - a.max(b).leading_zeros() as i32;
    let down = (bits - 90).max(0);
    (((a >> down) << 30) / (b >> down).max(1)).min(1 << 40) as i64
}

/// v · factor/2^30. *Domain* the result fits. Where all joints have the factor it comes out of a black box: compilers extend its sign ahead of
/// the loop, and multiply by two words then.
#[inline(always)]
fn multiple(v: i64, factor: i64) -> i64 {
    lowered_low(i128::from(v) * i128::from(factor), 30)
}

#[inline(always)]
fn within(value: i128, limit: i128) -> i64 {
    value.clamp(-limit, limit) as i64
}

#[inline(always)]
fn within_word(value: i64, limit: i128) -> i64 {
    value.clamp(-limit as i64, limit as i64)
}

impl Loops {
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.joints.capacity() + self.moved.capacity() + self.loops.capacity() + self.body_of.capacity()
    }

    /// Forgets the loops of the step before.
    pub(super) fn clear(&mut self) {
        self.joints.clear();
        self.moved.clear();
        self.rows.clear();
        self.loops.clear();
    }

    /// Prepares the loops of a step.
    pub(super) fn set(&mut self, forest: &Forest, blocks: &[Block], rows: &Rows) {
        self.clear();
        if forest.loops.is_empty() {
            return;
        }
        let Self { joints, moved, loops, body_of, rows: row_of } = self;
        body_of.clear();
        body_of.resize(rows.len() as usize, NONE);
        for range in &forest.loops {
            let (first_joint, first_body) = (joints.len(), moved.len());
            let coarsest = blocks[range.clone()].iter().map(|block| block.exponent).max().unwrap_or_default();
            for block in &blocks[range.clone()] {
                let mut joint = LoopJoint { coarser: coarsest - block.exponent, ..LoopJoint::default() };
                for (body, side) in joint.bodies.iter_mut().zip(&block.sides) {
                    let number = &mut body_of[side.row as usize];
                    if side.is_movable() && *number == NONE {
                        *number = moved.len() as u32;
                        moved.push([0; 3]);
                        row_of.push(side.row);
                    }
                    *body = if side.is_movable() { *number } else { NONE };
                }
                joints.push(joint);
            }
            let has_laws = set_shares(&mut joints[first_joint..], &blocks[range.clone()], moved);
            loops.push(Loop { joints: first_joint..joints.len(), bodies: first_body..moved.len(), has_laws });
        }
    }

    /// Finds the matrices of single joints where the bodies are.
    #[inline(always)]
    pub(super) fn factor(&mut self, blocks: &[Block], soft: &SoftRow) {
        // They come after the blocks of trees.
        let blocks_of_loops = &blocks[blocks.len() - self.joints.len()..];
        for (joint, block) in self.joints.iter_mut().zip(blocks_of_loops) {
            joint.invert(block, soft.compliance);
        }
    }

    /// Changes the impulses of the joints of loops by a pass. Returns the number of impulses that were cut off.
    #[inline(always)]
    pub(super) fn solve(
        &mut self,
        blocks: &mut [Block],
        poses: &[Pose],
        laws: &mut [AxisRow],
        rows: &mut Rows,
        soft: &SoftRow,
        is_biased: bool,
    ) -> u64 {
        let Self { joints, moved, loops, .. } = self;
        let first = blocks.len() - joints.len();
        let mut cut = 0;
        for Loop { joints: range, bodies, has_laws } in loops.iter() {
            let blocks = &mut blocks[first..][range.clone()];
            let joints = &mut joints[range.clone()];
            let bodies = bodies.clone();
            for (joint, block) in joints.iter_mut().zip(&*blocks) {
                joint.begin(block, poses, rows, soft, is_biased);
            }
            if *has_laws {
                for block in blocks.iter() {
                    block.begin_laws(rows, laws, if is_biased { Some(soft.rate.into()) } else { None });
                }
                if !find_places(joints, blocks, laws, soft, moved, bodies.clone()) {
                    for block in blocks.iter() {
                        block.begin_laws(rows, laws, if is_biased { Some(soft.rate.into()) } else { None });
                    }
                    descend(joints, blocks, laws, soft, moved, bodies);
                }
            } else {
                // Rows around have impulses by laws alone.
                iterate::<2>(joints, blocks, moved, bodies, ITERATIONS);
            }
            for (joint, block) in joints.iter().zip(blocks) {
                let [x, y, turn] = joint.solution;
                let changes =
                    [lowered_word(x, FINER_STILL), lowered_word(y, FINER_STILL), lowered_word(turn, FINER_STILL)];
                cut += block.change(changes, laws) + block.give_gains(rows);
            }
        }
        cut
    }
}

/// Counts the rows with laws at the bodies of a loop, and sets the shares of masses that they meet in a descent. Returns true if there is one.
/// `counts` is memory of bodies.
fn set_shares(joints: &mut [LoopJoint], blocks: &[Block], counts: &mut [[i64; 3]]) -> bool {
    let law_count = |block: &Block| block.laws.into_iter().filter(|&law| law != NONE).count() as i64;
    for (joint, block) in joints.iter().zip(blocks) {
        for body in joint.bodies {
            if let Some([count, ..]) = counts.get_mut(body as usize) {
                *count += law_count(block);
            }
        }
    }
    for joint in joints.iter_mut() {
        let counts_at = joint.bodies.map(|body| counts.get(body as usize).map_or(0, |&[count, ..]| count));
        joint.share = bits_of(counts_at[0].max(counts_at[1]) - 1);
    }
    blocks.iter().any(|block| law_count(block) > 0)
}

/// Finds the velocities of all rows by the directions.
#[inline(always)]
fn move_by(joints: &mut [LoopJoint], blocks: &[Block], moved: &mut [[i64; 3]], bodies: Range<usize>) {
    moved[bodies.clone()].fill([0; 3]);
    for (joint, block) in joints.iter().zip(blocks) {
        joint.move_bodies::<3>(block, moved);
    }
    bound(&mut moved[bodies]);
    for (joint, block) in joints.iter_mut().zip(blocks) {
        joint.set_velocity::<3>(block, moved);
    }
}

/// Bounds the velocities of bodies by all joints.
#[inline(always)]
fn bound(moved: &mut [[i64; 3]]) {
    for part in moved.as_flattened_mut() {
        *part = (*part).clamp(-FASTEST, FASTEST);
    }
}

/// The iterations over a loop with impulses of the first `ROWS` rows. Each goes over the joints three times: once each for the velocities of bodies
/// by the directions, for the velocities of rows, and for the next residuals.
#[inline(always)]
fn iterate<const ROWS: usize>(
    joints: &mut [LoopJoint],
    blocks: &[Block],
    moved: &mut [[i64; 3]],
    bodies: Range<usize>,
    iterations: usize,
) {
    let mut square = 0;
    moved[bodies.clone()].fill([0; 3]);
    for (joint, block) in joints.iter().zip(blocks) {
        square += joint.product::<ROWS>(joint.residual, joint.preconditioned);
        joint.move_bodies::<ROWS>(block, moved);
    }
    for iteration in 1..=iterations {
        if square <= 0 {
            return;
        }
        bound(&mut moved[bodies.clone()]);
        let mut along = 0;
        for (joint, block) in joints.iter_mut().zip(blocks) {
            joint.set_velocity::<ROWS>(block, moved);
            along += joint.product::<ROWS>(joint.velocity, joint.direction);
        }
        if along <= 0 {
            return;
        }
        let step = quotient(square, along);
        if iteration == iterations {
            for joint in joints.iter_mut() {
                joint.advance::<ROWS>(step);
            }
            return;
        }
        let mut next = 0;
        for (joint, block) in joints.iter_mut().zip(blocks) {
            joint.advance::<ROWS>(step);
            joint.lower_residual::<ROWS>(block, step);
            next += joint.product::<ROWS>(joint.residual, joint.preconditioned);
        }
        let kept = quotient(i128::max(next, 0), square);
        square = next;
        moved[bodies.clone()].fill([0; 3]);
        for (joint, block) in joints.iter_mut().zip(blocks) {
            joint.turn::<ROWS>(kept);
            joint.move_bodies::<ROWS>(block, moved);
        }
    }
}

impl Block {
    /// The velocity along row `i` by an impulse along row `j`, for one body.
    #[inline(always)]
    fn element(&self, side: usize, i: usize, j: usize) -> i128 {
        let [mx, my, angular] = self.sides[side].masses;
        let ([ix, iy], [jx, jy]) = (self.axes[i], self.axes[j]);
        // Products of axes are below 2^60, of crosses below 2^61.
        let turning = self.crosses[i][side] * self.crosses[j][side];
        let product = |mass: i64, factor: i64| i128::from(mass) * i128::from(factor);
        lowered(product(mx, ix * jx) + product(my, iy * jy) + product(angular, turning), 60)
    }
}

impl LoopJoint {
    /// Sets P and γ of the rows that are held.
    #[inline(always)]
    fn invert(&mut self, block: &Block, compliance: i32) {
        let element = |i: usize, j: usize| block.element(0, i, j) + block.element(1, i, j);
        self.is_pair = block.held == [true; 2];
        if !self.is_pair {
            for row in (0..2).filter(|&row| block.held[row]) {
                let mass = element(row, row);
                self.compliance[row] = shifted(2 * mass * i128::from(compliance), 31) as i64;
                self.mass[row] = mass as i64 + self.compliance[row];
            }
            return;
        }
        // The axes of a pair are the world's: an impulse along one moves no centre along the other, and masses along them are whole.
        let turning = |side: usize, i: usize, j: usize| {
            let crosses = block.crosses[i][side] * block.crosses[j][side];
            i128::from(lowered_low(i128::from(block.sides[side].masses[2]) * i128::from(crosses), 60))
        };
        let linear = |axis: usize| i128::from(block.sides[0].masses[axis]) + i128::from(block.sides[1].masses[axis]);
        let k11 = linear(0) + turning(0, 0, 0) + turning(1, 0, 0);
        let k12 = turning(0, 0, 1) + turning(1, 0, 1);
        let k22 = linear(1) + turning(0, 1, 1) + turning(1, 1, 1);
        let softness = shifted((k11 + k22) * i128::from(compliance), 31) as i64;
        (self.compliance[0], self.compliance[1]) = (softness, softness);
        // Bodies that move along one axis only make the matrix singular.
        let extra = (k11 + k22) >> 20;
        let (k11, k22) = (k11 + extra, k22 + extra);
        // Down to 58 bits.
        let down = (128 - k11.max(k22).leading_zeros() as i32 - 58).max(0);
        let [k11, k12, k22] = [k11, k12, k22].map(|k| shifted(k, down) as i64);
        // The inverse is rounded down: element 12 by its magnitude, as it changes its sign in a mirror.
        let inverse = Inverse::of(Matrix { k11, k12: k12.abs(), k22 });
        let rigid = (1_i64 << 60) / ((1 << 30) + i64::from(compliance));
        let [e11, e22, e12] = inverse.elements.map(|element| multiple(element, rigid));
        self.inverse = [e11, if k12 < 0 { -e12 } else { e12 }, e22];
        self.inverse_shift = inverse.exponent + down - block.mass_bits - FINER + FRACTION - FINER_STILL;
    }

    /// Begins a pass with the residual of the rows.
    #[inline(always)]
    fn begin(&mut self, block: &Block, poses: &[Pose], rows: &Rows, soft: &SoftRow, is_biased: bool) {
        let residual = block.residual(rows, poses, if is_biased { Some(soft.rate.into()) } else { None });
        self.residual = [0; 3];
        for (row, part) in residual.into_iter().enumerate() {
            if block.held[row] {
                // Below 2^62.
                let mut sum = lowered_word(part, 30 - FRACTION);
                let bits = block.mass_bits + FINER - FRACTION;
                if is_biased {
                    let soft = i128::from(self.compliance[row]) * i128::from(block.impulses[row]);
                    // More than the sum may be is as good as that.
                    sum += if bits > 1 {
                        lowered_within(soft, bits, 1 << 61)
                    } else {
                        within(shifted(soft, bits), 1 << 61)
                    };
                }
                self.residual[row] = -within_word(sum, RESIDUAL);
            }
        }
        let [first, second, _] = self.residual;
        self.start = [first, second];
        self.solution = [0; 3];
        self.precondition::<3>(block);
        self.direction = self.preconditioned;
    }

    /// True for rows whose velocities have a part in the solution.
    #[inline(always)]
    fn is_solved(&self, row: usize) -> bool {
        self.is_pair && row < 2 || self.mass[row] > 0
    }

    /// P r
    #[inline(always)]
    fn precondition<const ROWS: usize>(&mut self, block: &Block) {
        let alone = |row: usize| if row < ROWS { self.precondition_alone(block, row) } else { 0 };
        self.preconditioned = if self.is_pair {
            let [e11, e12, e22] = self.inverse;
            let [x, y, _] = self.residual;
            let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
            let room = 64 - RAISED_RESIDUAL - self.inverse_shift;
            let [x, y] = if matches!(room, 0..31) {
                // Elements have 31 bits, and residuals 36: they are raised to 61 and 62 bits.
                let ([e11, e12, e22], [x, y]) =
                    ([e11 << room, e12 << room, e22 << room], [x << RAISED_RESIDUAL, y << RAISED_RESIDUAL]);
                let sums = [product(e11, x) + product(e12, y), product(e12, x) + product(e22, y)];
                [within_word(upper(sums[0]), DIRECTION), within_word(upper(sums[1]), DIRECTION)]
            } else {
                let sums = [product(e11, x) + product(e12, y), product(e12, x) + product(e22, y)];
                sums.map(|sum| within(shifted(sum, self.inverse_shift), DIRECTION))
            };
            [x, y, alone(2)]
        } else {
            [alone(0), alone(1), alone(2)]
        };
    }

    /// The product of a velocity and an impulse, in the coarsest unit of the loop. Rounded down: it is even.
    #[inline(always)]
    fn product<const ROWS: usize>(&self, velocity: [i64; 3], impulse: [i64; 3]) -> i128 {
        let mut product = 0;
        for row in 0..ROWS {
            product += i128::from(velocity[row]) * i128::from(impulse[row]);
        }
        if self.coarser == 0 { product } else { product >> self.coarser.min(127) }
    }

    /// Adds the effect of the direction on the bodies.
    #[inline(always)]
    fn move_bodies<const ROWS: usize>(&self, block: &Block, moved: &mut [[i64; 3]]) {
        let product = |row: usize, factor: i64| i128::from(self.direction[row]) * i128::from(factor);
        let [x, y, turn_a, turn_b] = if self.is_pair {
            // The axes of a pair are the world's.
            let [first, second, third] = self.direction;
            let [[ka, kb], [la, lb], [ma, mb]] = block.crosses;
            let (mut turn_a, mut turn_b) = (product(0, ka) + product(1, la), product(0, kb) + product(1, lb));
            if ROWS > 2 {
                (turn_a, turn_b) =
                    (turn_a + i128::from(third) * i128::from(ma), turn_b + i128::from(third) * i128::from(mb));
            }
            let [x, y] = [first << (30 - LOWER), second << (30 - LOWER)];
            [x, y, lowered_low(turn_a, LOWER), lowered_low(turn_b, LOWER)]
        } else {
            let mut sums = [0; 4];
            for row in 0..ROWS {
                if block.is_active[row] {
                    let ([ux, uy], [ka, kb]) = (block.axes[row], block.crosses[row]);
                    sums[0] += product(row, ux);
                    sums[1] += product(row, uy);
                    sums[2] += product(row, ka);
                    sums[3] += product(row, kb);
                }
            }
            sums.map(|sum| lowered_low(sum, LOWER))
        };
        // From 15 to 64 bits: masses of rows have at most 50.
        let bits = block.mass_bits + FINER + FINER_STILL + 30 - LOWER - MOVED;
        let [first, second] = self.bodies;
        if let Some(moved) = moved.get_mut(first as usize) {
            let [dx, dy, turn] = velocities_by(&block.sides[0].masses, [x, y, turn_a], bits);
            *moved = [moved[0] - dx, moved[1] - dy, moved[2] - turn];
        }
        if let Some(moved) = moved.get_mut(second as usize) {
            let [dx, dy, turn] = velocities_by(&block.sides[1].masses, [x, y, turn_b], bits);
            *moved = [moved[0] + dx, moved[1] + dy, moved[2] + turn];
        }
    }

    /// The velocities of the rows by all directions.
    #[inline(always)]
    fn set_velocity<const ROWS: usize>(&mut self, block: &Block, moved: &[[i64; 3]]) {
        let velocity = |body: u32| moved.get(body as usize).copied().unwrap_or_default();
        let (a, b) = (velocity(self.bodies[0]), velocity(self.bodies[1]));
        let product = |factor: i64, velocity: i64| i128::from(factor) * i128::from(velocity);
        // Below 2^76.
        let velocity = |sum: i128, gives: i64| within_word(lowered_low(sum, 30 + MOVED - FRACTION) + gives, RESIDUAL);
        if self.is_pair {
            let [[ka, kb], [la, lb], [ma, mb]] = block.crosses;
            // The axes of a pair are the world's.
            let first = product(1 << 30, b[0] - a[0]) + product(kb, b[2]) - product(ka, a[2]);
            let second = product(1 << 30, b[1] - a[1]) + product(lb, b[2]) - product(la, a[2]);
            self.velocity[0] = velocity(first, self.gives_held(block, 0));
            self.velocity[1] = velocity(second, self.gives_held(block, 1));
            if ROWS > 2 && block.is_active[2] {
                self.velocity[2] = velocity(product(mb, b[2]) - product(ma, a[2]), self.gives(block, 2));
            }
            return;
        }
        for row in 0..ROWS {
            if block.is_active[row] {
                let ([ux, uy], [ka, kb]) = (block.axes[row], block.crosses[row]);
                let way = product(ux, b[0] - a[0]) + product(uy, b[1] - a[1]);
                let sum = way + product(kb, b[2]) - product(ka, a[2]);
                self.velocity[row] = velocity(sum, self.gives(block, row));
            }
        }
    }

    /// The velocity by which a row gives way to the direction.
    #[inline(always)]
    fn gives(&self, block: &Block, row: usize) -> i64 {
        let gives = i128::from(self.compliance[row]) * i128::from(self.direction[row]);
        // From 9 to 58 bits.
        lowered_within(gives, block.mass_bits + FINER + FINER_STILL - FRACTION, RESIDUAL as i64)
    }

    /// [`gives`](Self::gives) of a row that is held: its compliance is at most twice the largest mass of a row.
    #[inline(always)]
    fn gives_held(&self, block: &Block, row: usize) -> i64 {
        let room = 64 - (block.mass_bits + FINER + FINER_STILL - FRACTION);
        // Below 2^57 · 2^51.
        let gives = i128::from(self.compliance[row] << room) * i128::from(self.direction[row]);
        within_word(upper(gives), RESIDUAL)
    }

    /// Goes a step along the direction, by less than 2^62.
    #[inline(always)]
    fn advance<const ROWS: usize>(&mut self, step: i64) {
        let step = black_box(step);
        for row in 0..ROWS {
            self.solution[row] = within_word(self.solution[row] + multiple(self.direction[row], step), SOLUTION);
        }
    }

    /// Takes the part of a step off the residual: less than 2^47.
    #[inline(always)]
    fn lower_residual<const ROWS: usize>(&mut self, block: &Block, step: i64) {
        let step = black_box(step);
        for row in 0..ROWS {
            let residual = within_word(self.residual[row] - multiple(self.velocity[row], step), RESIDUAL);
            self.residual[row] = if self.is_solved(row) { residual } else { self.residual[row] };
        }
        self.precondition::<ROWS>(block);
    }

    /// Turns to the next direction, by less than 2^62.
    #[inline(always)]
    fn turn<const ROWS: usize>(&mut self, kept: i64) {
        let kept = black_box(kept);
        for row in 0..ROWS {
            let direction = self.preconditioned[row] + multiple(self.direction[row], kept);
            self.direction[row] = within_word(direction, DIRECTION);
        }
    }
}

/// The changes of velocity of a body by impulses in 2^62 along x and y and of rotation, each within [`FAST`].
#[inline(always)]
fn velocities_by(masses: &[i64; 3], impulses: [i64; 3], bits: i32) -> [i64; 3] {
    let mut velocities = [0; 3];
    if matches!(bits, 46..65) {
        // Raised by at most 18 bits masses are at most 2^62.
        for k in 0..3 {
            let product = i128::from(masses[k] << (64 - bits)) * i128::from(impulses[k]);
            velocities[k] = within_word(upper(product), FAST);
        }
    } else {
        for k in 0..3 {
            velocities[k] = within(lowered(i128::from(masses[k]) * i128::from(impulses[k]), bits), FAST);
        }
    }
    velocities
}
