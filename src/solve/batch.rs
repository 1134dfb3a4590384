//! Rows and factors of the contacts of a group, computed side by side.
//!
//! Values of contacts and bodies are loaded one lane after the other; rows and factors are computed from them in [`Lanes`]. Lanes without
//! a contact hold zeros, and so do all results of them.
//!
//! # Ranges
//! Inverse masses are at most 2^31, normals and arms within ±2^30. So the [`product`] of a mass and a normal or an arm is within ±2^31, as
//! is its product with a second one, and a sum of two exact products is below 2^62.1. Elements of the matrix of both bodies are below
//! 2^34, and with shares, each below 2^22, below 2^57.

use super::group::{GAIN, Group};
use super::matrix::friction;
use super::number::bits_in;
use super::vectors::{Shift, across, exact, larger, largest, long, product, word};
use crate::kernel::simd::{GAIN_BITS, GROUP, Lanes};

/// A value for each lane.
pub(super) type Words = [i64; GROUP];

/// Factors in 2^-30 have at most this many bits: they are at most a quarter.
pub(super) const FACTOR_BITS: i64 = GAIN_BITS as i64 - 2;

/// One in 2^-30, the limit of arms.
pub(super) const ONE: i64 = 1 << 30;

/// Elements 11, 12 and 22 of the matrix of the normal rows.
pub(super) type Elements = [Words; 3];

/// The part of one body in the elements of the matrices: normal 11, 12 and 22, tangent, coupling with both normal rows. The largest
/// changes of its velocity and angular velocity by impulses.
struct BodyElements<W> {
    elements: [W; 6],
    largest: [W; 2],
}

/// The values of a group of contacts that is prepared.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    /// Inverse masses along x and y, by body.
    pub(super) mass: [[Words; 2]; 2],
    /// Inverse inertias over the square of the length, by body.
    pub(super) inertia: [Words; 2],
    /// The number of contacts of the phase, by body.
    pub(super) share: [Words; 2],
    /// log2 of the unit of arms in 2^-32 m, by body.
    pub(super) down: [Words; 2],
    /// Arms (x, y) of the first and the last point, by body, in 2^-32 m.
    pub(super) ends: [[[Words; 2]; 2]; 2],
    /// All bits set with two points, none with one.
    pub(super) two: Words,
    /// Softness, in 2^-30.
    pub(super) compliance: Words,
    /// Changes of velocity (x, y) by an impulse along the normal and along the tangent, by body.
    linear: [[[Words; 2]; 2]; 2],
    /// Changes of angular velocity by an impulse along the three rows, by body.
    angular: [[Words; 2]; 3],
    /// The matrix of the normal rows, of whole bodies and of their shares.
    pub(super) whole: Elements,
    pub(super) split: Elements,
    /// Velocity along the tangent by an impulse along it, of whole bodies and of their shares.
    tangent: [Words; 2],
    /// Velocities along both normal rows by an impulse along the tangent.
    coupling: [Words; 2],
    /// The largest factor of velocity and of angular velocity for all contacts of a body.
    widest: [Words; 2],
    /// The number of bits that the largest factor has before it becomes a quarter.
    pub(super) bits: Words,
}

impl Batch {
    /// Makes lanes empty.
    pub(super) fn clear(&mut self, lanes: core::ops::Range<usize>) {
        if lanes.is_empty() {
            return;
        }
        let Self { mass, inertia, share, down, ends, two, compliance, .. } = self;
        let words = mass.as_flattened_mut().iter_mut().chain(inertia).chain(share).chain(down);
        let words = words.chain(ends.as_flattened_mut().as_flattened_mut()).chain([two, compliance]);
        words.for_each(|word| word[lanes.clone()].fill(0));
        self.bits[lanes].fill(FACTOR_BITS);
    }

    /// Writes arms, factors, the inverse of friction and the limits of gains to a group.
    #[inline(always)]
    pub(super) fn fill<L: Lanes>(&mut self, lanes: L, group: &mut Group) {
        let is_wide = self.is_wide();
        let is_up = self.down.iter().flatten().fold(0, |all, down| all | down) < 0;
        for at in (0..GROUP).step_by(L::WIDTH) {
            if is_up {
                self.arms::<L, true>(lanes, group, at);
            } else {
                self.arms::<L, false>(lanes, group, at);
            }
            if is_wide {
                self.elements::<L, true>(lanes, group, at);
            } else {
                self.elements::<L, false>(lanes, group, at);
            }
        }
        let mut is_up = false;
        for lane in 0..GROUP {
            if self.moves(lane) {
                self.choose_bits(lane, group);
                is_up |= self.bits[lane] < FACTOR_BITS;
            } else if lane < group.count {
                self.take_back(lane);
                group.clear(lane..lane + 1);
            }
        }
        for at in (0..GROUP).step_by(L::WIDTH) {
            if is_up {
                self.factors::<L, true>(lanes, group, at);
            } else {
                self.factors::<L, false>(lanes, group, at);
            }
        }
        for lane in 0..group.count {
            group.friction[lane][0] = friction(self.tangent[1][lane], self.bits[lane]);
        }
        self.limits(group);
    }

    /// Takes back the contact of a lane, after [`elements`](Self::elements): its bodies do not move.
    #[cold]
    fn take_back(&mut self, lane: usize) {
        let Self { linear, angular, whole, split, tangent, coupling, widest, .. } = self;
        let words = linear.as_flattened_mut().as_flattened_mut().iter_mut().chain(angular.as_flattened_mut());
        let words = words.chain(whole).chain(split).chain(tangent).chain(coupling).chain(widest);
        words.for_each(|word| word[lane] = 0);
        self.bits[lane] = FACTOR_BITS;
    }

    /// Writes the arms along the rows. `UP` if a lane has a length below a quarter of a metre.
    #[inline(always)]
    fn arms<L: Lanes, const UP: bool>(&self, lanes: L, group: &mut Group, at: usize) {
        let (nx, ny) = lanes.pair(&group.normal, at);
        let tangent = (ny, lanes.minus(lanes.splat(0), nx));
        let arms_a = self.arms_of::<L, UP>(lanes, at, 0, (nx, ny), tangent);
        let arms_b = self.arms_of::<L, UP>(lanes, at, 1, (nx, ny), tangent);
        for row in 0..3 {
            lanes.put_pair(&mut group.arms[row], at, (arms_a[row], arms_b[row]));
        }
    }

    /// The arms of one body along the rows.
    #[inline(always)]
    fn arms_of<L: Lanes, const UP: bool>(
        &self,
        lanes: L,
        at: usize,
        side: usize,
        normal: (L::Narrow, L::Narrow),
        tangent: (L::Narrow, L::Narrow),
    ) -> [L::Narrow; 3] {
        let shift = Shift::<L>::new::<UP>(lanes, lanes.wide(&self.down[side], at));
        let [[x1, y1], [x2, y2]] = &self.ends[side];
        let (x1, y1) = (shift.arm::<UP>(lanes, x1, at), shift.arm::<UP>(lanes, y1, at));
        let (x2, y2) = (shift.arm::<UP>(lanes, x2, at), shift.arm::<UP>(lanes, y2, at));
        let middle_x = lanes.low(lanes.rounded_oddly::<1>(lanes.add(x1, x2)));
        let middle_y = lanes.low(lanes.rounded_oddly::<1>(lanes.add(y1, y2)));
        [
            across(lanes, (lanes.low(x1), lanes.low(y1)), normal),
            across(lanes, (lanes.low(x2), lanes.low(y2)), normal),
            // In the middle: friction acts along one line.
            across(lanes, (middle_x, middle_y), tangent),
        ]
    }

    /// Finds the elements of the matrices. `WIDE` if an inverse mass is 2^31.
    #[inline(always)]
    fn elements<L: Lanes, const WIDE: bool>(&mut self, lanes: L, group: &Group, at: usize) {
        let a = self.elements_of::<L, WIDE>(lanes, group, at, 0);
        let b = self.elements_of::<L, WIDE>(lanes, group, at, 1);
        let (share_a, share_b) = (lanes.low(lanes.wide(&self.share[0], at)), lanes.low(lanes.wide(&self.share[1], at)));
        for i in 0..6 {
            let whole = lanes.add(a.elements[i], b.elements[i]);
            let words = match i {
                0..3 => &mut self.whole[i],
                3 => &mut self.tangent[0],
                _ => &mut self.coupling[i - 4],
            };
            lanes.store(words, at, whole);
        }
        for i in 0..4 {
            let split = lanes.add(long(lanes, share_a, a.elements[i]), long(lanes, share_b, b.elements[i]));
            lanes.store(if i == 3 { &mut self.tangent[1] } else { &mut self.split[i] }, at, split);
        }
        for i in 0..2 {
            let widest = larger(lanes, long(lanes, share_a, a.largest[i]), long(lanes, share_b, b.largest[i]));
            lanes.store(&mut self.widest[i], at, widest);
        }
    }

    /// Finds the elements of one body, and writes its changes of velocity.
    #[inline(always)]
    fn elements_of<L: Lanes, const WIDE: bool>(
        &mut self,
        lanes: L,
        group: &Group,
        at: usize,
        side: usize,
    ) -> BodyElements<L::Wide> {
        let (nx, ny) = lanes.pair(&group.normal, at);
        let (mx, my) = (lanes.wide(&self.mass[side][0], at), lanes.wide(&self.mass[side][1], at));
        let inertia = lanes.wide(&self.inertia[side], at);
        let (px, py) = (product::<L, WIDE>(lanes, mx, nx), product::<L, WIDE>(lanes, my, ny));
        let qx = product::<L, WIDE>(lanes, mx, ny);
        let qy = product::<L, WIDE>(lanes, my, lanes.minus(lanes.splat(0), nx));
        let (k1, k2) = (self.arm(lanes, group, at, 0, side), self.arm(lanes, group, at, 1, side));
        let kt = self.arm(lanes, group, at, 2, side);
        let (t1, t2) = (product::<L, WIDE>(lanes, inertia, k1), product::<L, WIDE>(lanes, inertia, k2));
        let tt = product::<L, WIDE>(lanes, inertia, kt);
        let along = lanes.add(product::<L, WIDE>(lanes, px, nx), product::<L, WIDE>(lanes, py, ny));
        let cross = lanes.add(product::<L, WIDE>(lanes, qx, nx), product::<L, WIDE>(lanes, qy, ny));
        // Both ways, so that the points may come in either order.
        let mixed = lanes.add(exact::<L, WIDE>(lanes, t1, k2), exact::<L, WIDE>(lanes, t2, k1));
        let slip = lanes.sub(product::<L, WIDE>(lanes, qx, ny), product::<L, WIDE>(lanes, qy, nx));
        for (words, value) in self.linear.iter_mut().zip([[px, py], [qx, qy]]) {
            lanes.store(&mut words[side][0], at, value[0]);
            lanes.store(&mut words[side][1], at, value[1]);
        }
        for (words, value) in self.angular.iter_mut().zip([t1, t2, tt]) {
            lanes.store(&mut words[side], at, value);
        }
        let linear = largest(lanes, [px, py, qx, qy]);
        BodyElements {
            elements: [
                lanes.add(along, product::<L, WIDE>(lanes, t1, k1)),
                lanes.add(along, lanes.rounded_oddly::<31>(mixed)),
                lanes.add(along, product::<L, WIDE>(lanes, t2, k2)),
                lanes.add(slip, product::<L, WIDE>(lanes, tt, kt)),
                lanes.add(cross, product::<L, WIDE>(lanes, tt, k1)),
                lanes.add(cross, product::<L, WIDE>(lanes, tt, k2)),
            ],
            largest: [linear, largest(lanes, [t1, t2, tt])],
        }
    }

    /// The arm of a body along a row.
    #[inline(always)]
    fn arm<L: Lanes>(&self, lanes: L, group: &Group, at: usize, row: usize, side: usize) -> L::Narrow {
        let (arm_a, arm_b) = lanes.pair(&group.arms[row], at);
        if side == 0 { arm_a } else { arm_b }
    }

    /// Returns true if the contact of a lane can move a body along the normal at both points, by a change of velocity above the rounding of
    /// the matrix. Smaller changes are of a body that can only turn, at a lever below 10^-4 of its length.
    pub(super) fn moves(&self, lane: usize) -> bool {
        self.whole[0][lane].min(self.whole[2][lane]) >= 16
    }

    /// Limits the velocity at which an overlap is pushed out so that neither a body nor its rim becomes faster than the push: a body with locks
    /// that is pushed across the way that they leave it, or at a small lever, would be thrown.
    ///
    /// # Ranges
    /// Changes of angular velocities are within 2^31 and rims at most 2^30 · 2^-10: products are below 2^51. Depths are below 2^31.
    #[inline(always)]
    pub(super) fn limit_push(&self, lane: usize, group: &mut Group, rims: [i64; 2]) {
        let limit = group.push_out[lane][1];
        let change = |row: usize, side: usize| {
            // Towards zero: alike in a mirror image.
            let rim = self.angular[row][side][lane] * (rims[side] >> 10) / (1 << 20);
            let [x, y] = [0, 1].map(|axis: usize| self.linear[0][side][axis][lane]);
            [rim, x, y]
        };
        let fastest = |changes: [i64; 3]| changes.into_iter().map(i64::abs).max().unwrap_or(0);
        for (row, element) in [(0, 0), (1, 2)] {
            let speed = fastest(change(row, 0)).max(fastest(change(row, 1)));
            let along = self.whole[element][lane];
            if speed > along {
                let deepest = i128::from(limit) * i128::from(along) / i128::from(speed);
                group.push_out[lane][1] = group.push_out[lane][1].max(deepest as i32);
            }
        }
        let [first, second] = group.separation[lane];
        if first.max(second) < limit >> 4 {
            self.limit_push_of_both(lane, group, limit, [0, 1].map(|side| [change(0, side), change(1, side)]));
        }
    }

    /// [`limit_push`](Self::limit_push) for both points together, with the changes of velocity (rim, x, y) of each body by an impulse at
    /// each point: points on both sides of a body that locks hold can only move it fast, or not at all.
    ///
    /// # Ranges
    /// All factors are within 2^33: products are below 2^66, their sums with a third factor below 2^101, times a depth below 2^132: depths
    /// are taken with 2^-8.
    #[cold]
    fn limit_push_of_both(&self, lane: usize, group: &mut Group, limit: i32, changes: [[[i64; 3]; 2]; 2]) {
        let [k11, k12, k22] = [0, 1, 2].map(|element: usize| i128::from(self.whole[element][lane]));
        // The impulses that move both points alike, times the determinant; one that pulls is none, and then one point decides.
        let impulses = [k22 - k12, k11 - k12];
        if impulses[0] <= 0 || impulses[1] <= 0 {
            return;
        }
        let determinant = (k11 * k22 - k12 * k12).max(0);
        let speed = |[first, second]: [[i64; 3]; 2]| {
            let sums = (0..3).map(|k| i128::from(first[k]) * impulses[0] + i128::from(second[k]) * impulses[1]);
            sums.map(i128::abs).max().unwrap_or(0)
        };
        let fastest = speed(changes[0]).max(speed(changes[1]));
        if fastest > determinant {
            let deepest = i128::from(limit >> 8) * determinant / fastest;
            group.push_out[lane][1] = group.push_out[lane][1].max((deepest << 8) as i32);
        }
    }

    /// Chooses the bits of a lane, and writes the shift of its angular factors.
    #[inline(always)]
    fn choose_bits(&mut self, lane: usize, group: &mut Group) {
        let [k11, k22, tangent] = [self.whole[0][lane], self.whole[2][lane], self.tangent[0][lane]];
        let normal = k11.min(k22);
        let smallest = if tangent > 0 { normal.min(tangent) } else { normal };
        let bits = |value: i64| i64::from(bits_in(value));
        // All contacts of a phase together change the velocity of a body by no more than one of them alone may: factors of
        // velocities are at most a quarter, factors of angular velocities at most 2^16. The coupling is at most a quarter too: friction
        // that saw less of the change by the normal impulses would turn a body against a small lever, and give it energy.
        let (widest, turning) = (bits(self.widest[0][lane]), bits(self.widest[1][lane]));
        let coupling = bits(self.coupling[0][lane].abs().max(self.coupling[1][lane].abs()));
        let bits = widest.max(bits(smallest)).max(turning - 18).max(coupling);
        self.bits[lane] = bits;
        group.angular_shift[lane] = (turning - bits).max(0);
    }

    /// Writes the changes of velocity by impulses, and the coupling. `UP` if a lane has fewer bits than a factor.
    ///
    /// With the share of the body these are below 2^bits, angular ones below 2^(bits + shift): the factors are at most a quarter.
    #[inline(always)]
    fn factors<L: Lanes, const UP: bool>(&self, lanes: L, group: &mut Group, at: usize) {
        let bits = lanes.sub(lanes.wide(&self.bits, at), word(lanes, FACTOR_BITS));
        let shift = Shift::<L>::new::<UP>(lanes, bits);
        for direction in 0..2 {
            let [[ax, ay], [bx, by]] = &self.linear[direction];
            let (ax, ay) = (shift.words::<UP>(lanes, ax, at), shift.words::<UP>(lanes, ay, at));
            let (bx, by) = (shift.words::<UP>(lanes, bx, at), shift.words::<UP>(lanes, by, at));
            let zero = lanes.splat(0);
            lanes.put_pair(&mut group.linear_a[direction], at, (lanes.minus(zero, ax), lanes.minus(zero, ay)));
            lanes.put_pair(&mut group.linear_b[direction], at, (bx, by));
        }
        let turning = Shift::<L>::new::<UP>(lanes, lanes.add(bits, lanes.wide(&group.angular_shift, at)));
        for row in 0..3 {
            let [a, b] = &self.angular[row];
            let (a, b) = (turning.words::<UP>(lanes, a, at), turning.words::<UP>(lanes, b, at));
            lanes.put_pair(&mut group.angular[row], at, (lanes.minus(lanes.splat(0), a), b));
        }
        let (first, second) = (lanes.wide(&self.coupling[0], at), lanes.wide(&self.coupling[1], at));
        let coupling = (shift.quarter::<UP>(lanes, first), shift.quarter::<UP>(lanes, second));
        lanes.put_pair(&mut group.coupling, at, coupling);
    }

    /// Writes the largest gains of bodies by one contact.
    #[inline(always)]
    fn limits(&self, group: &mut Group) {
        /// The limits by share, as divisions are slow.
        const FEW: [i64; 16] = {
            let mut limits = [0; 16];
            let mut share = 1;
            while share < 16 {
                limits[share] = GAIN / share as i64;
                share += 1;
            }
            limits
        };
        for side in 0..2 {
            for lane in 0..GROUP {
                let share = self.share[side][lane];
                group.gain_limit[side][lane] = if share < 16 { FEW[(share & 15) as usize] } else { GAIN / share };
            }
        }
    }
}
