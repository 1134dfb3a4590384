//! Loops of joined bodies, solved by conjugate gradients: three iterations a pass.
//!
//! The impulses Δλ of all joints of a loop are wanted for which (K + γ)·Δλ = −r, with the matrix K of the velocities of rows by impulses,
//! the compliance γ and the residual r of the rows. K is never made: it is a product with the bodies in between. Each joint alone has the
//! inverse of its own matrix, P = K_j⁻¹/(1 + c): with it the iterations are preconditioned. Sums over a loop are exact, so that any order
//! of joints gives the same bits.
//!
//! With one iteration a net swings for ever, with two it rests four times as late as with three.
//!
//! Loops of pins, the usual ones, stand in groups of lanes ([`pins`]); all others read their blocks ([`kernels`]). The steps of both give the same
//! bits.
//!
//! # Ranges
//! Velocities of rows are in 2^-[`FRACTION`] units, within 2^36; velocities of bodies in 2^-[`MOVED`] units, by one joint within 2^40, so
//! that sums of 2^22 joints fit in 64 bits. Impulses are in 2^-[`FINER_STILL`] of the unit of the block: directions within 2^51, so that
//! their products with axes are below 2^82.5 and with masses, once lowered by [`LOWER`](super::LOWER) bits, below 2^107; solutions within 2^58. Products
//! of residuals and directions are below 2^88, also in the unit of the coarsest joint, their sums over 2^20 joints below 2^108. Both
//! quotients of sums have 30 bits after the point and are below 2^10.
//!
//! Lanes have products of limbs ([`Lanes`]): crosses of pins are within 2^30 and elements of inverses below 2^31, both narrow, and raised masses at
//! most 2^57 ([`pins`]). Their inverses are in 2^-shift with shifts from 0 to 23: the trace of K has the bits of the mass of the block, and its
//! smaller eigenvalue is above 2^-20.1 of it.

mod impact;
mod kernels;
mod laws;
mod pins;

use alloc::vec::Vec;
use core::ops::Range;

use self::laws::LawLoop;
use self::pins::{PinGroup, PinImpulses, iterate_pins, store};
use super::axis::AxisRow;
use super::forest::Forest;
use super::gains::Gains;
use super::tree::{FRACTION, RESIDUAL};
use super::turn::Pose;
use super::{Block, LOWER};
use crate::kernel::simd::{GROUP, Lanes, Speeds};
use crate::slots::NONE;
use crate::solve::motion::Rows;
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
const DIRECTION_BITS: i64 = 51;
const DIRECTION: i128 = 1 << DIRECTION_BITS;
const SOLUTION: i128 = 1 << 58;
/// The largest velocity of a body by a joint, and by all of them.
const FAST: i128 = 1 << 40;
const FASTEST: i64 = 1 << 42;
/// The number of all bodies that cannot be moved among the bodies of loops.
const STILL: u32 = 0;

/// A joint of a loop.
#[derive(Clone, Debug, Default)]
struct LoopJoint {
    /// The bodies of its sides, as numbers among the bodies of loops; [`NONE`] for a body that cannot be moved.
    bodies: [u32; 2],
    /// Elements 11, 12 and 22 of P, in 2^-shift of an impulse by 2^-[`FRACTION`] of velocity.
    inverse: [i64; 3],
    inverse_shift: i32,
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

/// The state that a pass begins with.
pub(super) struct PassStart<'a> {
    pub(super) poses: &'a [Pose],
    pub(super) rows: &'a Rows,
    /// The softness of loops.
    pub(super) soft: &'a SoftRow,
    /// True for the solve pass.
    pub(super) is_biased: bool,
}

/// All loops of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Loops {
    joints: Vec<LoopJoint>,
    /// The joints of loops of pins, and the velocities of bodies by their directions: zero for [`STILL`].
    pins: Vec<PinGroup>,
    speeds: Vec<Speeds>,
    /// The sums of the changes of velocity of these bodies in a pass: zero between passes.
    sums: Vec<Speeds>,
    /// The velocities of bodies by directions: zero for [`STILL`].
    moved: Vec<[i64; 3]>,
    loops: Vec<Loop>,
    /// The number of a body by its row, and the other way round; [`NONE`] for [`STILL`].
    body_of: Vec<u32>,
    rows: Vec<u32>,
}

/// The joints and bodies of a loop.
#[derive(Clone, Debug)]
struct Loop {
    joints: Range<usize>,
    bodies: Range<usize>,
    /// The groups of its joints if all are [usual pins](Block::is_usual_pin), and none otherwise.
    pins: Range<usize>,
    /// The largest change of velocity by a joint of which a body may have as many in a word as it has joints.
    gain_limit: i64,
    /// True if a row of one of its joints has a law.
    has_laws: bool,
}

/// Traits of a loop, by all of its joints.
struct LoopTraits {
    are_pins: bool,
    has_laws: bool,
    /// log2 of the coarsest unit of impulses, N·s.
    coarsest: i32,
    gain_limit: i64,
}

impl LoopTraits {
    fn new(blocks: &[Block]) -> Self {
        let mut traits = Self { are_pins: true, has_laws: false, coarsest: i32::MIN, gain_limit: i64::MAX };
        for block in blocks {
            traits.are_pins &= block.is_usual_pin();
            traits.has_laws |= block.laws != [NONE; 3];
            traits.coarsest = traits.coarsest.max(block.exponent);
            for side in block.sides.iter().filter(|side| side.is_movable()) {
                traits.gain_limit = traits.gain_limit.min(side.gain_limit);
            }
        }
        traits
    }
}

/// The largest number of times that a loop is solved in a pass: until no row leaves its place. Rows that still do end in the place that they come to:
/// loops are soft enough not to need the [descent](super::tree) of trees (1,000 braced bridges with limits, friction and motors are alike with it).
const ROUNDS: usize = 4;

/// a/b in 2^-30, within 2^10. *Domain* a ≥ 0, b > 0.
fn quotient(a: i128, b: i128) -> i64 {
    let bits = 128 - a.max(b).leading_zeros() as i32;
    let down = (bits - 90).max(0);
    (((a >> down) << 30) / (b >> down).max(1)).min(1 << 40) as i64
}

impl Loops {
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.joints.capacity()
            + self.pins.capacity()
            + self.speeds.capacity()
            + self.sums.capacity()
            + self.moved.capacity()
            + self.loops.capacity()
            + self.body_of.capacity()
    }

    /// Returns true if a loop stands in groups of lanes.
    #[cfg(test)]
    pub(super) fn has_groups(&self) -> bool {
        !self.pins.is_empty()
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
            self.pins.clear();
            return;
        }
        let mut group_count = 0;
        let Self { joints, pins, speeds, sums, moved, loops, body_of, rows: row_of } = self;
        moved.push([0; 3]);
        row_of.push(NONE);
        body_of.clear();
        body_of.resize(rows.len() as usize, NONE);
        for range in &forest.loops {
            let (first_joint, first_group, first_body) = (joints.len(), group_count, moved.len());
            let blocks = &blocks[range.clone()];
            let LoopTraits { are_pins, has_laws, coarsest, gain_limit } = LoopTraits::new(blocks);
            for (number, block) in blocks.iter().enumerate() {
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
                if are_pins {
                    if number % GROUP == 0 {
                        // Groups of the step before stay, as they are large.
                        if pins.len() == group_count {
                            pins.push(PinGroup::empty());
                        }
                        pins[group_count].begin(blocks.len() - number);
                        group_count += 1;
                    }
                    pins[group_count - 1].set(number % GROUP, &joint, block);
                }
                joints.push(joint);
            }
            loops.push(Loop {
                joints: first_joint..joints.len(),
                pins: first_group..group_count,
                bodies: first_body..moved.len(),
                gain_limit,
                has_laws,
            });
        }
        pins.truncate(group_count);
        speeds.clear();
        sums.clear();
        if !pins.is_empty() {
            speeds.resize(moved.len(), Speeds::default());
            sums.resize(moved.len(), Speeds::default());
        }
    }

    /// Finds the matrices of single joints where the bodies are.
    #[inline(always)]
    pub(super) fn factor(&mut self, blocks: &[Block], soft: &SoftRow) {
        // They come after the blocks of trees.
        let blocks_of_loops = &blocks[blocks.len() - self.joints.len()..];
        for Loop { joints, pins, .. } in &self.loops {
            let blocks = &blocks_of_loops[joints.clone()];
            for (group, blocks) in self.pins[pins.clone()].iter_mut().zip(blocks.chunks(GROUP)) {
                for (lane, block) in blocks.iter().enumerate() {
                    group.turn_to(lane, block, soft.compliance);
                }
            }
            if pins.is_empty() {
                for (joint, block) in self.joints[joints.clone()].iter_mut().zip(blocks) {
                    joint.invert(block, soft.compliance);
                }
            }
        }
    }

    /// Begins a sub-step with the impulses of the one before.
    #[inline(always)]
    pub(super) fn warm_start<L: Lanes>(&mut self, lanes: L, blocks: &mut [Block], gains: &mut Gains) {
        let Self { pins, sums, loops, rows, .. } = self;
        for Loop { joints, pins: pin_range, bodies, gain_limit, .. } in loops.iter() {
            if pin_range.is_empty() {
                blocks[joints.clone()].iter_mut().for_each(|block| block.warm_start(gains));
                continue;
            }
            let (groups, bodies) = (&mut pins[pin_range.clone()], bodies.clone());
            PinImpulses { groups, sums, bodies, rows, limit: *gain_limit }.warm_start(lanes, gains);
        }
    }

    /// Hands the impulses of pins to their blocks at the end of a step.
    pub(super) fn store(&self, blocks: &mut [Block]) {
        for Loop { joints, pins, .. } in &self.loops {
            store(&self.pins[pins.clone()], &mut blocks[joints.clone()]);
        }
    }

    /// Changes the impulses of the joints of loops by a pass; the relax pass begins with the poses after the move. Returns the number of values that
    /// were cut off.
    #[inline(always)]
    pub(super) fn solve<L: Lanes>(
        &mut self,
        lanes: L,
        blocks: &mut [Block],
        laws: &mut [AxisRow],
        gains: &mut Gains,
        start: &PassStart<'_>,
    ) -> u64 {
        let PassStart { poses, rows, soft, is_biased } = *start;
        let Self { joints, pins, speeds, sums, moved, loops, rows: row_of, .. } = self;
        let first = blocks.len() - joints.len();
        let mut cut = 0;
        for Loop { joints: range, pins: pin_range, bodies, gain_limit, has_laws } in loops.iter() {
            let blocks = &mut blocks[first..][range.clone()];
            let bodies = bodies.clone();
            if !pin_range.is_empty() {
                let groups = &mut pins[pin_range.clone()];
                for (group, blocks) in groups.iter_mut().zip(blocks.chunks_mut(GROUP)) {
                    if !is_biased {
                        group.weigh(lanes);
                    }
                    for (lane, block) in blocks.iter_mut().enumerate() {
                        if !is_biased {
                            if block.is_struck {
                                // Impulses of impacts are in its own sums.
                                block.weigh();
                            }
                            cut += block.turn(poses, laws);
                            group.turn_to(lane, block, soft.compliance);
                        }
                        group.begin_pass(lane, block, start);
                    }
                }
                iterate_pins(lanes, groups, speeds, bodies.clone(), ITERATIONS);
                let impulses = PinImpulses { groups, sums, bodies, rows: row_of, limit: *gain_limit };
                cut += impulses.change(lanes, is_biased, gains);
                continue;
            }
            let joints = &mut joints[range.clone()];
            for (joint, block) in joints.iter_mut().zip(&mut *blocks) {
                if !is_biased {
                    cut += block.advance(poses, laws);
                    joint.invert(block, soft.compliance);
                }
                joint.begin(block, start);
            }
            if *has_laws {
                for block in blocks.iter() {
                    block.begin_laws(rows, laws, if is_biased { Some(soft.rate.into()) } else { None });
                }
                LawLoop { joints, blocks, soft, moved, bodies }.solve(laws);
            } else {
                // Rows around have impulses by laws alone.
                let step = iterate::<2>(joints, blocks, moved, bodies, ITERATIONS);
                joints.iter_mut().for_each(|joint| joint.advance::<2>(step));
            }
            for (joint, block) in joints.iter().zip(blocks) {
                cut += block.change(joint.changes(), laws, is_biased);
                block.give_gains(gains);
            }
        }
        cut
    }
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

/// The iterations over a loop but for the last step along the directions, which is returned. Each goes over the joints three times: once each for the
/// velocities of bodies by the directions, for the velocities of rows, and for the next residuals.
#[inline(always)]
fn iterate<const ROWS: usize>(
    joints: &mut [LoopJoint],
    blocks: &[Block],
    moved: &mut [[i64; 3]],
    bodies: Range<usize>,
    iterations: usize,
) -> i64 {
    let mut square = 0;
    moved[bodies.clone()].fill([0; 3]);
    for (joint, block) in joints.iter().zip(blocks) {
        square += joint.square::<ROWS>();
        joint.move_bodies::<ROWS>(block, moved);
    }
    for iteration in 1..=iterations {
        if square <= 0 {
            return 0;
        }
        bound(&mut moved[bodies.clone()]);
        let mut along = 0;
        for (joint, block) in joints.iter_mut().zip(blocks) {
            along += joint.set_velocity::<ROWS>(block, moved);
        }
        if along <= 0 {
            return 0;
        }
        let step = quotient(square, along);
        if iteration == iterations {
            return step;
        }
        let mut next = 0;
        for (joint, block) in joints.iter_mut().zip(blocks) {
            joint.advance::<ROWS>(step);
            next += joint.lower_residual::<ROWS>(block, step);
        }
        let kept = quotient(i128::max(next, 0), square);
        square = next;
        moved[bodies.clone()].fill([0; 3]);
        for (joint, block) in joints.iter_mut().zip(blocks) {
            joint.turn::<ROWS>(kept);
            joint.move_bodies::<ROWS>(block, moved);
        }
    }
    0
}
