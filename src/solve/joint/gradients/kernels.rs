//! The kernels of a joint of a loop: its own inverse matrix, and the steps of an iteration.
//!
//! Reads: blocks, velocities of bodies. Writes: the values of the joint, and velocities of bodies. [`gradients`](super) has the ranges.

use core::hint::black_box;

use super::{DIRECTION, FAST, FINER_STILL, LoopJoint, MOVED, PassStart, RAISED_RESIDUAL, SOLUTION};
use crate::solve::joint::tree::{FRACTION, RESIDUAL};
use crate::solve::joint::{Block, FINER, LOWER};
use crate::solve::matrix::{Inverse, Matrix};
use crate::solve::number::{
    lowered, lowered_low, lowered_within, lowered_word, product, shifted, upper, within, within_word,
};

/// v · factor/2^30. *Domain* the result fits. Where all joints have the factor it comes out of a black box: compilers extend its sign ahead of
/// the loop, and multiply by two words then.
#[inline(always)]
fn multiple(v: i64, factor: i64) -> i64 {
    lowered_low(i128::from(v) * i128::from(factor), 30)
}

/// P r of both rows of a pair, with elements 11, 12 and 22 of P in 2^-shift.
#[inline(always)]
fn times_inverse([e11, e12, e22]: [i64; 3], shift: i32, [x, y]: [i64; 2]) -> [i64; 2] {
    let room = 64 - RAISED_RESIDUAL - shift;
    if matches!(room, 0..31) {
        // Elements have 31 bits, and residuals 36: they are raised to 61 and 62 bits.
        let ([e11, e12, e22], [x, y]) =
            ([e11 << room, e12 << room, e22 << room], [x << RAISED_RESIDUAL, y << RAISED_RESIDUAL]);
        let sums = [product(e11, x) + product(e12, y), product(e12, x) + product(e22, y)];
        return [within_word(upper(sums[0]), DIRECTION), within_word(upper(sums[1]), DIRECTION)];
    }
    let sums = [product(e11, x) + product(e12, y), product(e12, x) + product(e22, y)];
    sums.map(|sum| within(shifted(sum, shift), DIRECTION))
}

/// A product of a velocity and an impulse in a unit of impulses that is coarser by so many bits. Rounded down: it is even.
#[inline(always)]
fn in_coarser_unit(product: i128, bits: i32) -> i128 {
    if bits == 0 { product } else { product >> bits.min(127) }
}

impl Block {
    /// The velocity along row `i` by an impulse along row `j`, for one body.
    #[inline(always)]
    pub(super) fn element(&self, side: usize, i: usize, j: usize) -> i128 {
        let [mx, my, angular] = self.sides[side].masses;
        let ([ix, iy], [jx, jy]) = (self.side_axes(i)[side], self.side_axes(j)[side]);
        // Products of axes are below 2^60, of crosses below 2^61.
        let turning = self.crosses[i][side] * self.crosses[j][side];
        lowered(product(mx, ix * jx) + product(my, iy * jy) + product(angular, turning), 60)
    }
}

/// P of a joint that holds a point: elements 11, 12 and 22, which have 31 bits, in 2^-shift of an impulse by 2^-[`FRACTION`] of velocity. With γ of both
/// rows, as a factor of mass of the block.
pub(super) struct PairInverse {
    pub(super) elements: [i64; 3],
    pub(super) shift: i32,
    pub(super) compliance: i64,
}

impl Block {
    /// P and γ of a joint that holds a point.
    #[inline(always)]
    pub(super) fn pair_inverse(&self, compliance: i32) -> PairInverse {
        // The axes of a pair are the world's: an impulse along one moves no centre along the other, and masses along them are whole.
        let [first, second] = &self.sides;
        let turning = |i: usize, j: usize| {
            let [[first_i, second_i], [first_j, second_j]] = [self.crosses[i], self.crosses[j]];
            // Products of crosses are below 2^61.
            lowered_low(product(first.masses[2], first_i * first_j), 60)
                + lowered_low(product(second.masses[2], second_i * second_j), 60)
        };
        // Masses are at most 2^44: these are below 2^48.
        let k11 = first.masses[0] + second.masses[0] + turning(0, 0);
        let k12 = turning(0, 1);
        let k22 = first.masses[1] + second.masses[1] + turning(1, 1);
        let softness = lowered_low(product(k11 + k22, compliance.into()), 31);
        // Bodies that move along one axis only make the matrix singular.
        let extra = (k11 + k22) >> 20;
        let (k11, k22) = (k11 + extra, k22 + extra);
        // The inverse is rounded down: element 12 by its magnitude, as it changes its sign in a mirror.
        let inverse = Inverse::of(Matrix { k11, k12: k12.abs(), k22 });
        let rigid = (1_i64 << 60) / ((1 << 30) + i64::from(compliance));
        let [e11, e22, e12] = inverse.elements.map(|element| multiple(element, rigid));
        PairInverse {
            elements: [e11, if k12 < 0 { -e12 } else { e12 }, e22],
            shift: inverse.exponent - self.mass_bits - FINER + FRACTION - FINER_STILL,
            compliance: softness,
        }
    }

    /// The residual of the rows that are held at the beginning of a pass, with the impulses and γ of these rows.
    #[inline(always)]
    pub(super) fn residual_of(&self, impulses: [i64; 2], compliance: [i64; 2], start: &PassStart<'_>) -> [i64; 2] {
        let PassStart { poses, rows, soft, is_biased } = *start;
        let velocities = self.residual(rows, poses, if is_biased { Some(soft.rate.into()) } else { None });
        let mut residual = [0; 2];
        for (row, velocity) in velocities.into_iter().enumerate() {
            if self.held[row] {
                // Below 2^62.
                let mut sum = lowered_word(velocity, 30 - FRACTION);
                let bits = self.mass_bits + FINER - FRACTION;
                if is_biased {
                    let soft = product(compliance[row], impulses[row]);
                    // More than the sum may be is as good as that.
                    sum += if bits > 1 {
                        lowered_within(soft, bits, 1 << 61)
                    } else {
                        within(shifted(soft, bits), 1 << 61)
                    };
                }
                residual[row] = -within_word(sum, RESIDUAL);
            }
        }
        residual
    }
}

impl LoopJoint {
    /// Sets P and γ of the rows that are held.
    #[inline(always)]
    pub(super) fn invert(&mut self, block: &Block, compliance: i32) {
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
        let PairInverse { elements, shift, compliance } = block.pair_inverse(compliance);
        (self.inverse, self.inverse_shift) = (elements, shift);
        (self.compliance[0], self.compliance[1]) = (compliance, compliance);
    }

    /// Begins a pass with the residual of the rows.
    #[inline(always)]
    pub(super) fn begin(&mut self, block: &Block, start: &PassStart<'_>) {
        let [first, second, _] = self.compliance;
        let [along, across, _] = block.impulses;
        let residual = block.residual_of([along, across], [first, second], start);
        self.start = residual;
        self.residual = [residual[0], residual[1], 0];
        self.solution = [0; 3];
        self.precondition::<3>(block);
        self.direction = self.preconditioned;
    }

    /// The changes of the impulses.
    #[inline(always)]
    pub(super) fn changes(&self) -> [i64; 3] {
        self.solution.map(|impulse| lowered_word(impulse, FINER_STILL))
    }

    /// True for rows whose velocities have a part in the solution.
    #[inline(always)]
    pub(super) fn is_solved(&self, row: usize) -> bool {
        self.is_pair && row < 2 || self.mass[row] > 0
    }

    /// P r
    #[inline(always)]
    pub(super) fn precondition<const ROWS: usize>(&mut self, block: &Block) {
        let alone = |row: usize| if row < ROWS { self.precondition_alone(block, row) } else { 0 };
        self.preconditioned = if self.is_pair {
            let [x, y, _] = self.residual;
            let [x, y] = times_inverse(self.inverse, self.inverse_shift, [x, y]);
            [x, y, alone(2)]
        } else {
            [alone(0), alone(1), alone(2)]
        };
    }

    /// The product of a velocity and an impulse, in the coarsest unit of the loop.
    #[inline(always)]
    fn product<const ROWS: usize>(&self, velocity: [i64; 3], impulse: [i64; 3]) -> i128 {
        let mut product = 0;
        for row in 0..ROWS {
            product += i128::from(velocity[row]) * i128::from(impulse[row]);
        }
        in_coarser_unit(product, self.coarser)
    }

    /// Adds the effect of the direction of a rope on the bodies.
    fn move_by_rope(&self, block: &Block, moved: &mut [[i64; 3]]) {
        for side in 0..2 {
            let Some(moved) = moved.get_mut(self.bodies[side] as usize) else { continue };
            let [x, y] = block.axes[side];
            let impulses =
                [x, y, block.crosses[0][side]].map(|factor| lowered_low(product(self.direction[0], factor), LOWER));
            let sign = if side == 0 { -1 } else { 1 };
            for (moved, change) in
                moved.iter_mut().zip(velocities_by(&block.sides[side].masses, impulses, moved_bits(block)))
            {
                *moved += sign * change;
            }
        }
    }

    /// The velocity by which a row gives way to the direction.
    #[inline(always)]
    pub(super) fn gives(&self, block: &Block, row: usize) -> i64 {
        let gives = i128::from(self.compliance[row]) * i128::from(self.direction[row]);
        // From 9 to 58 bits.
        lowered_within(gives, block.mass_bits + FINER + FINER_STILL - FRACTION, RESIDUAL as i64)
    }

    /// [`gives`](Self::gives) of a row that is held: its compliance is at most twice the largest mass of a row.
    #[inline(always)]
    pub(super) fn gives_held(&self, block: &Block, row: usize) -> i64 {
        // Below 2^57 · 2^51.
        let gives = product(self.compliance[row] << compliance_room(block), self.direction[row]);
        within_word(upper(gives), RESIDUAL)
    }
}

/// The steps of an iteration, with impulses of the first `ROWS` rows.
impl LoopJoint {
    /// The product of the residual and of P r, which is the first direction.
    #[inline(always)]
    pub(super) fn square<const ROWS: usize>(&self) -> i128 {
        self.product::<ROWS>(self.residual, self.preconditioned)
    }

    /// Adds the effect of the direction on the bodies.
    #[inline(always)]
    pub(super) fn move_bodies<const ROWS: usize>(&self, block: &Block, moved: &mut [[i64; 3]]) {
        let along = |row: usize, factor: i64| product(self.direction[row], factor);
        let [x, y, turn_a, turn_b] = if self.is_pair {
            // The axes of a pair are the world's.
            let [first, second, third] = self.direction;
            let [[ka, kb], [la, lb], [ma, mb]] = block.crosses;
            let (mut turn_a, mut turn_b) = (along(0, ka) + along(1, la), along(0, kb) + along(1, lb));
            if ROWS > 2 {
                (turn_a, turn_b) = (turn_a + product(third, ma), turn_b + product(third, mb));
            }
            let [x, y] = [first << (30 - LOWER), second << (30 - LOWER)];
            [x, y, lowered_low(turn_a, LOWER), lowered_low(turn_b, LOWER)]
        } else {
            if block.is_pulley() {
                self.move_by_rope(block, moved);
                return;
            }
            let mut sums = [0; 4];
            for row in 0..ROWS {
                if block.is_active[row] {
                    let ([ux, uy], [ka, kb]) = (block.axes[row], block.crosses[row]);
                    sums[0] += along(row, ux);
                    sums[1] += along(row, uy);
                    sums[2] += along(row, ka);
                    sums[3] += along(row, kb);
                }
            }
            sums.map(|sum| lowered_low(sum, LOWER))
        };
        let bits = moved_bits(block);
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

    /// Finds the velocities of the rows by all directions. Returns their product with the direction.
    #[inline(always)]
    pub(super) fn set_velocity<const ROWS: usize>(&mut self, block: &Block, moved: &[[i64; 3]]) -> i128 {
        let velocity = |body: u32| moved.get(body as usize).copied().unwrap_or_default();
        let (a, b) = (velocity(self.bodies[0]), velocity(self.bodies[1]));
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
        } else {
            for row in (0..ROWS).filter(|&row| block.is_active[row]) {
                let ([ux, uy], [ka, kb]) = (block.axes[row], block.crosses[row]);
                let way = if block.is_pulley() {
                    let [vx, vy] = block.axes[1];
                    product(vx, b[0]) - product(ux, a[0]) + product(vy, b[1]) - product(uy, a[1])
                } else {
                    product(ux, b[0] - a[0]) + product(uy, b[1] - a[1])
                };
                let sum = way + product(kb, b[2]) - product(ka, a[2]);
                self.velocity[row] = velocity(sum, self.gives(block, row));
            }
        }
        self.product::<ROWS>(self.velocity, self.direction)
    }

    /// Goes a step along the direction, by less than 2^62.
    #[inline(always)]
    pub(super) fn advance<const ROWS: usize>(&mut self, step: i64) {
        let step = black_box(step);
        for row in 0..ROWS {
            self.solution[row] = within_word(self.solution[row] + multiple(self.direction[row], step), SOLUTION);
        }
    }

    /// Takes the part of a step off the residual: less than 2^47. Returns its product with P r.
    #[inline(always)]
    pub(super) fn lower_residual<const ROWS: usize>(&mut self, block: &Block, step: i64) -> i128 {
        let step = black_box(step);
        for row in 0..ROWS {
            let residual = within_word(self.residual[row] - multiple(self.velocity[row], step), RESIDUAL);
            self.residual[row] = if self.is_solved(row) { residual } else { self.residual[row] };
        }
        self.precondition::<ROWS>(block);
        self.product::<ROWS>(self.residual, self.preconditioned)
    }

    /// Turns to the next direction, by less than 2^62.
    #[inline(always)]
    pub(super) fn turn<const ROWS: usize>(&mut self, kept: i64) {
        let kept = black_box(kept);
        for row in 0..ROWS {
            let direction = self.preconditioned[row] + multiple(self.direction[row], kept);
            self.direction[row] = within_word(direction, DIRECTION);
        }
    }
}

/// Bits by which the compliance of a row that is held is raised, so that the velocities by which it gives way stand in the upper words of products.
#[inline(always)]
pub(super) fn compliance_room(block: &Block) -> i32 {
    64 - (block.mass_bits + FINER + FINER_STILL - FRACTION)
}

/// The bits from products of masses and lowered impulses down to velocities of bodies: from 15 to 64, as masses of rows have at most 50.
#[inline(always)]
pub(super) fn moved_bits(block: &Block) -> i32 {
    block.mass_bits + FINER + FINER_STILL + 30 - LOWER - MOVED
}

/// Returns true if masses that give velocities with so many bits too many stand in words when raised by these bits, of 64: raised by at most 18 bits
/// they are at most 2^62.
pub(super) fn has_usual_masses(bits: i32) -> bool {
    matches!(bits, 46..65)
}

/// [`velocities_by`] of raised masses, which have the velocities in the upper words of their products.
#[inline(always)]
fn raised_velocities(masses: [i64; 3], impulses: [i64; 3]) -> [i64; 3] {
    [0, 1, 2].map(|k| within_word(upper(product(masses[k], impulses[k])), FAST))
}

/// The changes of velocity of a body by impulses in 2^62 along x and y and of rotation, each within [`FAST`].
#[inline(always)]
fn velocities_by(masses: &[i64; 3], impulses: [i64; 3], bits: i32) -> [i64; 3] {
    if has_usual_masses(bits) {
        return raised_velocities(masses.map(|mass| mass << (64 - bits)), impulses);
    }
    let mut velocities = [0; 3];
    for k in 0..3 {
        velocities[k] = within(lowered(i128::from(masses[k]) * i128::from(impulses[k]), bits), FAST);
    }
    velocities
}
