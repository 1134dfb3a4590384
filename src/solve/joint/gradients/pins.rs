//! Loops of pins, the usual ones: all joints hold a point, and none has a law.
//!
//! The iterations go over the joints nine times a pass, and blocks are as large as caches: so all that iterations need of joints stands in groups of
//! lanes.
//!
//! Reads: blocks, poses, velocities of bodies. Writes: groups, and velocities of bodies by directions. [`gradients`](super) has the ranges.

mod impulses;

use core::ops::Range;

use self::impulses::LimbSums;
pub(super) use self::impulses::{PinImpulses, store};
use super::kernels::{PairInverse, compliance_room, has_usual_masses, moved_bits};
use super::{
    DIRECTION_BITS, FAST, FASTEST, FINER_STILL, LOWER, LoopJoint, PassStart, RESIDUAL, SOLUTION, STILL, quotient,
};
use crate::kernel::simd::{GROUP, Lanes, Pairs, Speeds};
use crate::slots::NONE;
use crate::solve::joint::Block;

/// The largest mass, raised so that velocities stand in the upper words of its products.
const LARGEST_MASS: i64 = 1 << 57;

/// Joints of a loop of pins side by side. Pairs are of two quantities of the same joint.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct PinGroup {
    /// The bodies of both sides among the bodies of loops; [`STILL`] for bodies that cannot be moved, whose masses are zero.
    bodies: [[u32; GROUP]; 2],
    /// The cross products of both bodies by row: within 2^30.
    crosses: [Pairs; 2],
    /// The masses of both bodies, raised so that velocities stand in the upper words of their products: within [`LARGEST_MASS`].
    masses: [[[i64; GROUP]; 3]; 2],
    /// γ, raised likewise.
    compliance: [i64; GROUP],
    /// log2 of the coarsest unit of impulses of the loop over the unit of the joint.
    coarser: [i64; GROUP],
    /// Elements 11 and 22 of P, and element 12 and nothing: 31 bits, in 2^-shift.
    inverse: [Pairs; 2],
    inverse_shift: [i64; GROUP],
    /// Values by row: the residual, the direction, the sum of directions, and the velocity by the direction, which is P r from the next
    /// residual up to the next direction.
    residual: [[i64; GROUP]; 2],
    direction: [[i64; GROUP]; 2],
    solution: [[i64; GROUP]; 2],
    velocity: [[i64; GROUP]; 2],
    /// Impulses of the sub-step, by row.
    impulses: [[i64; GROUP]; 2],
    /// The impulses around both bodies that are applied in the sub-step, by limb: in 2^30 and 1, in 2^-30.
    turns: [[[i64; GROUP]; 2]; 2],
    /// Sums of the impulses of all sub-steps, of the present one from its move on.
    applied: LimbSums,
    /// Sums over sub-steps of the impulses applied up to the move.
    weighted: LimbSums,
}

impl Block {
    /// Returns true if the joint is a pin whose masses are of the usual sizes.
    pub(super) fn is_usual_pin(&self) -> bool {
        let bits = moved_bits(self);
        let is_small = |mass: &i64| mass << (64 - bits) <= LARGEST_MASS;
        self.holds_point()
            && self.laws == [NONE; 3]
            && has_usual_masses(bits)
            && self.sides.iter().all(|side| side.masses.iter().all(is_small))
    }
}

impl PinGroup {
    /// A group without joints.
    pub(super) fn empty() -> Self {
        let (words, pairs) = ([0; GROUP], [[0; 2]; GROUP]);
        Self {
            bodies: [[STILL; GROUP]; 2],
            crosses: [pairs; 2],
            masses: [[words; 3]; 2],
            compliance: words,
            coarser: words,
            inverse: [pairs; 2],
            inverse_shift: words,
            residual: [words; 2],
            direction: [words; 2],
            solution: [words; 2],
            velocity: [words; 2],
            impulses: [words; 2],
            turns: [[words; 2]; 2],
            applied: LimbSums::default(),
            weighted: LimbSums::default(),
        }
    }

    /// Begins a step with so many joints, or with all lanes full of them.
    pub(super) fn begin(&mut self, count: usize) {
        if count < GROUP {
            // Lanes without a joint.
            *self = Self::empty();
        } else {
            (self.applied, self.weighted) = (LimbSums::default(), LimbSums::default());
        }
    }

    /// Takes a joint into a lane.
    pub(super) fn set(&mut self, lane: usize, joint: &LoopJoint, block: &Block) {
        let up = 64 - moved_bits(block);
        for (k, side) in block.sides.iter().enumerate() {
            self.bodies[k][lane] = if joint.bodies[k] == NONE { STILL } else { joint.bodies[k] };
            (0..3).for_each(|axis| self.masses[k][axis][lane] = side.masses[axis] << up);
        }
        (self.impulses[0][lane], self.impulses[1][lane]) = (block.impulses[0], block.impulses[1]);
        self.coarser[lane] = joint.coarser.into();
    }

    /// Takes the arms of a joint, and finds P and γ.
    #[inline(always)]
    pub(super) fn turn_to(&mut self, lane: usize, block: &Block, compliance: i32) {
        let PairInverse { elements, shift, compliance } = block.pair_inverse(compliance);
        for (pairs, crosses) in self.crosses.iter_mut().zip(&block.crosses) {
            pairs[lane] = crosses.map(|cross| cross as i32);
        }
        let [e11, e12, e22] = elements.map(|element| element as i32);
        (self.inverse[0][lane], self.inverse[1][lane]) = ([e11, e22], [e12, 0]);
        debug_assert!((0..31).contains(&shift), "{shift}");
        self.inverse_shift[lane] = shift.into();
        self.compliance[lane] = compliance << compliance_room(block);
    }

    /// Begins a pass with the residual of the rows of a joint.
    #[inline(always)]
    pub(super) fn begin_pass(&mut self, lane: usize, block: &Block, start: &PassStart<'_>) {
        let compliance = self.compliance[lane] >> compliance_room(block);
        let impulses = [self.impulses[0][lane], self.impulses[1][lane]];
        let residual = block.residual_of(impulses, [compliance; 2], start);
        for (row, residual) in residual.into_iter().enumerate() {
            (self.residual[row][lane], self.solution[row][lane]) = (residual, 0);
        }
    }

    /// Values of both rows.
    #[inline(always)]
    fn rows<L: Lanes>(lanes: L, [x, y]: &[[i64; GROUP]; 2], at: usize) -> [L::Wide; 2] {
        [lanes.wide(x, at), lanes.wide(y, at)]
    }

    #[inline(always)]
    fn set_rows<L: Lanes>(lanes: L, [x, y]: &mut [[i64; GROUP]; 2], at: usize, values: [L::Wide; 2]) {
        lanes.store(x, at, values[0]);
        lanes.store(y, at, values[1]);
    }

    /// P r
    #[inline(always)]
    fn preconditioned<L: Lanes>(&self, lanes: L, at: usize, residual: [L::Wide; 2]) -> [L::Wide; 2] {
        let ((e11, e22), (e12, _)) = (lanes.pair(&self.inverse[0], at), lanes.pair(&self.inverse[1], at));
        let shift = lanes.wide(&self.inverse_shift, at);
        [
            lanes.dot_within([e11, e12], residual, shift, DIRECTION_BITS),
            lanes.dot_within([e12, e22], residual, shift, DIRECTION_BITS),
        ]
    }

    /// Sets the first directions, P r, adds their effect on the bodies, and adds up their products with the residuals.
    #[inline(always)]
    fn start<L: Lanes>(&mut self, lanes: L, at: usize, square: &mut [L::Wide; 3], speeds: &mut [Speeds]) {
        let residual = Self::rows(lanes, &self.residual, at);
        let direction = self.preconditioned(lanes, at, residual);
        lanes.add_products(square, residual, direction, lanes.wide(&self.coarser, at));
        Self::set_rows(lanes, &mut self.direction, at, direction);
        self.move_bodies(lanes, at, direction, speeds);
    }

    /// Adds the effect of directions on the bodies.
    #[inline(always)]
    fn move_bodies<L: Lanes>(&self, lanes: L, at: usize, direction: [L::Wide; 2], speeds: &mut [Speeds]) {
        let ((ka, kb), (la, lb)) = (lanes.pair(&self.crosses[0], at), lanes.pair(&self.crosses[1], at));
        let up = lanes.all(i64::from(30 - LOWER));
        let [x, y] = [lanes.raised_by(direction[0], up), lanes.raised_by(direction[1], up)];
        let first = self.velocities(lanes, at, 0, [x, y, lanes.lowered_dot([ka, la], direction)]);
        let second = self.velocities(lanes, at, 1, [x, y, lanes.lowered_dot([kb, lb], direction)]);
        let zero = lanes.all(0);
        let first = [lanes.sub(zero, first[0]), lanes.sub(zero, first[1]), lanes.sub(zero, first[2])];
        lanes.add_speeds(speeds, &self.bodies[0], at, first);
        lanes.add_speeds(speeds, &self.bodies[1], at, second);
    }

    /// The changes of velocity of a body by impulses.
    #[inline(always)]
    fn velocities<L: Lanes>(&self, lanes: L, at: usize, side: usize, [x, y, turn]: [L::Wide; 3]) -> [L::Wide; 3] {
        let ([mass_x, mass_y, angular], fast) = (&self.masses[side], lanes.all(FAST as i64));
        [
            lanes.clamped(lanes.upper_word(lanes.wide(mass_x, at), x), fast),
            lanes.clamped(lanes.upper_word(lanes.wide(mass_y, at), y), fast),
            lanes.clamped(lanes.upper_word(lanes.wide(angular, at), turn), fast),
        ]
    }

    /// Finds the velocities of the rows by all directions, and adds up their products with the directions.
    #[inline(always)]
    fn set_velocity<L: Lanes>(&mut self, lanes: L, at: usize, along: &mut [L::Wide; 3], speeds: &[Speeds]) {
        let ((ka, kb), (la, lb)) = (lanes.pair(&self.crosses[0], at), lanes.pair(&self.crosses[1], at));
        let (a, b) = (lanes.speeds_of(speeds, &self.bodies[0], at), lanes.speeds_of(speeds, &self.bodies[1], at));
        let turns = [b[2], lanes.sub(lanes.all(0), a[2])];
        let ways = [
            lanes.lowered_way(lanes.sub(b[0], a[0]), [kb, ka], turns),
            lanes.lowered_way(lanes.sub(b[1], a[1]), [lb, la], turns),
        ];
        let compliance = lanes.wide(&self.compliance, at);
        let (direction, limit) = (Self::rows(lanes, &self.direction, at), lanes.all(RESIDUAL as i64));
        let mut velocity = direction;
        for row in 0..2 {
            let gives = lanes.clamped(lanes.upper_word(compliance, direction[row]), limit);
            velocity[row] = lanes.clamped(lanes.add(ways[row], gives), limit);
        }
        Self::set_rows(lanes, &mut self.velocity, at, velocity);
        lanes.add_products(along, velocity, direction, lanes.wide(&self.coarser, at));
    }

    /// Goes a step along the directions, by less than 2^62.
    #[inline(always)]
    fn advance<L: Lanes>(&mut self, lanes: L, at: usize, step: i64) {
        let direction = Self::rows(lanes, &self.direction, at);
        let (mut solution, limit) = (Self::rows(lanes, &self.solution, at), lanes.all(SOLUTION as i64));
        let steps = lanes.multiples(direction, step);
        for row in 0..2 {
            solution[row] = lanes.clamped(lanes.add(solution[row], steps[row]), limit);
        }
        Self::set_rows(lanes, &mut self.solution, at, solution);
    }

    /// Takes the part of a step off the residuals, less than 2^47, and adds up the products of residuals and P r.
    #[inline(always)]
    fn lower_residual<L: Lanes>(&mut self, lanes: L, at: usize, step: i64, square: &mut [L::Wide; 3]) {
        let velocity = Self::rows(lanes, &self.velocity, at);
        let (mut residual, limit) = (Self::rows(lanes, &self.residual, at), lanes.all(RESIDUAL as i64));
        let parts = lanes.multiples(velocity, step);
        for row in 0..2 {
            residual[row] = lanes.clamped(lanes.sub(residual[row], parts[row]), limit);
        }
        Self::set_rows(lanes, &mut self.residual, at, residual);
        let preconditioned = self.preconditioned(lanes, at, residual);
        Self::set_rows(lanes, &mut self.velocity, at, preconditioned);
        lanes.add_products(square, residual, preconditioned, lanes.wide(&self.coarser, at));
    }

    /// Turns to the next directions, by less than 2^62, and adds their effect on the bodies.
    #[inline(always)]
    fn turn<L: Lanes>(&mut self, lanes: L, at: usize, kept: i64, speeds: &mut [Speeds]) {
        let preconditioned = Self::rows(lanes, &self.velocity, at);
        let (mut direction, limit) = (Self::rows(lanes, &self.direction, at), lanes.all(1 << DIRECTION_BITS));
        let before = lanes.multiples(direction, kept);
        for row in 0..2 {
            direction[row] = lanes.clamped(lanes.add(preconditioned[row], before[row]), limit);
        }
        Self::set_rows(lanes, &mut self.direction, at, direction);
        self.move_bodies(lanes, at, direction, speeds);
    }
}

/// Bounds the velocities of bodies by all joints.
#[inline(always)]
fn bound(speeds: &mut [Speeds]) {
    for Speeds(speeds) in speeds {
        for speed in speeds {
            *speed = (*speed).clamp(-FASTEST, FASTEST);
        }
    }
}

/// The iterations over a loop of pins, as [`iterate`](super::iterate) has them.
#[inline(always)]
pub(super) fn iterate_pins<L: Lanes>(
    lanes: L,
    groups: &mut [PinGroup],
    speeds: &mut [Speeds],
    bodies: Range<usize>,
    iterations: usize,
) {
    let zero = [lanes.all(0); 3];
    speeds[bodies.clone()].fill(Speeds::default());
    let mut sums = zero;
    for group in groups.iter_mut() {
        for at in (0..GROUP).step_by(L::WIDTH) {
            group.start(lanes, at, &mut sums, speeds);
        }
    }
    let mut square = lanes.total(sums);
    for iteration in 1..=iterations {
        if square <= 0 {
            return;
        }
        bound(&mut speeds[bodies.clone()]);
        let mut sums = zero;
        for group in groups.iter_mut() {
            for at in (0..GROUP).step_by(L::WIDTH) {
                group.set_velocity(lanes, at, &mut sums, speeds);
            }
        }
        let along = lanes.total(sums);
        if along <= 0 {
            return;
        }
        let (step, is_last) = (quotient(square, along), iteration == iterations);
        let mut sums = zero;
        for group in groups.iter_mut() {
            for at in (0..GROUP).step_by(L::WIDTH) {
                group.advance(lanes, at, step);
                if !is_last {
                    group.lower_residual(lanes, at, step, &mut sums);
                }
            }
        }
        if is_last {
            return;
        }
        let next = lanes.total(sums);
        let kept = quotient(i128::max(next, 0), square);
        square = next;
        speeds[bodies.clone()].fill(Speeds::default());
        for group in groups.iter_mut() {
            for at in (0..GROUP).step_by(L::WIDTH) {
                group.turn(lanes, at, kept, speeds);
            }
        }
    }
}
