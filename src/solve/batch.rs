//! Rows and factors of the contacts of a group, computed side by side in [`Lanes`] from the values that `load` writes. Lanes without a
//! contact hold zeros, and so do all results of them.
//!
//! # Ranges
//! Inverse masses are below 2^31, normals and arms within ±2^30. So the [`product`] of a mass and a normal or an arm is below 2^31. The
//! sum of both products of a change of velocity with a normal is within 2^61, as a unit vector gives at most the larger mass, and with a
//! product of a change of angular velocity and an arm within 2^62. Elements of the matrix of both bodies are below 2^33.1, and with shares,
//! each below 2^22, below 2^56.

use super::group::{GAIN, Group};
use super::load::LaneScales;
use super::vectors::{Shift, across, long, product};
use crate::kernel::simd::{GAIN_BITS, GROUP, Lanes, Pairs};

/// A value for each lane.
pub(super) type Words = [i64; GROUP];

/// A row of four words for each lane.
pub(super) type Table = [[i64; 4]; GROUP];

/// Factors in 2^-30 have at most this many bits: they are at most a quarter.
pub(super) const FACTOR_BITS: i64 = GAIN_BITS as i64 - 2;

/// One in 2^-30, the limit of arms.
pub(super) const ONE: i64 = 1 << 30;

/// Bodies whose velocity an impulse changes by less than this, in units of the matrix, do not move by it: it is the rounding.
const LEAST: i64 = 16;

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
    /// [`SolverBody::masses`](super::bodies::SolverBody::masses) of both bodies.
    pub(super) masses: [Table; 2],
    /// Arms of the first and the last point, (x, y) of the first and of the second body, in 2^-32 m.
    pub(super) points: [Table; 2],
    /// The impulses that the step starts from, and log2 of their unit.
    pub(super) impulses: Table,
    /// Of the first and the last point, in 2^-32 m.
    pub(super) separation: [Words; 2],
    pub(super) friction: Words,
    /// In 2^-32 m/s.
    pub(super) surface: Words,
    /// The number of contacts of the phase, by body: each moves its share.
    pub(super) share: [Words; 2],
    /// All bits set with two points, none with one.
    pub(super) two: Words,
    /// Softness, in 2^-30.
    pub(super) compliance: Words,
    /// The change of the velocity (x, y) between the bodies by their flights.
    pub(super) change: Pairs,
    pub(super) scales: LaneScales,
    /// Inverse masses along x and y, by body.
    pub(super) mass: [[Words; 2]; 2],
    /// Inverse inertias over the square of the length, by body.
    pub(super) inertia: [Words; 2],
    /// log2 of the unit of arms in 2^-32 m, by body.
    pub(super) down: [Words; 2],
    /// Radii over the lengths, by body, in 2^-30.
    pub(super) rim: [Words; 2],
    /// Changes of velocity (x, y) by an impulse along the normal and along the tangent, by body.
    pub(super) linear: [[[Words; 2]; 2]; 2],
    /// Changes of angular velocity by an impulse along the three rows, by body.
    pub(super) angular: [[Words; 2]; 3],
    /// The matrix of the normal rows, of whole bodies and of their shares.
    pub(super) whole: Elements,
    pub(super) split: Elements,
    /// Velocity along the tangent by an impulse along it, of whole bodies and of their shares.
    pub(super) tangent: [Words; 2],
    /// Velocities along both normal rows by an impulse along the tangent.
    coupling: [Words; 2],
    /// The largest changes of velocity and of angular velocity, by body, and for all contacts of a body.
    largest: [[Words; 2]; 2],
    widest: [Words; 2],
    /// The number of bits that the largest factor has before it becomes a quarter.
    pub(super) bits: Words,
    /// Zero for a body that no impulse of the contact moves.
    pub(super) moved: [Words; 2],
    /// log2 of the unit of impulses: of masses of 2^0 at first, then of the contact, in N·s.
    pub(super) exponent: Words,
}

impl Batch {
    /// Makes lanes empty.
    pub(super) fn clear(&mut self, lanes: core::ops::Range<usize>) {
        for lane in lanes {
            for table in self.masses.iter_mut().chain(&mut self.points).chain([&mut self.impulses]) {
                table[lane] = [0; 4];
            }
            let Self { separation, share, friction, surface, two, compliance, change, .. } = self;
            let words = separation.iter_mut().chain(share).chain([friction, surface, two, compliance]);
            words.for_each(|words| words[lane] = 0);
            change[lane] = [0; 2];
        }
    }

    /// Writes arms, factors and the limits of gains to a group. `is_short` if a length is below a quarter of a metre; `rate` is that of
    /// the sub-steps.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn fill<L: Lanes>(&mut self, lanes: L, group: &mut Group, is_short: bool, rate: i32) {
        loop {
            self.set_rows(lanes, group, is_short, rate);
            if !self.leave_out_held(group) {
                break;
            }
        }
        let mut is_up = false;
        for at in (0..GROUP).step_by(L::WIDTH) {
            let up = self.choose_bits(lanes, group, at);
            is_up |= up;
        }
        for at in (0..GROUP).step_by(L::WIDTH) {
            if is_up {
                self.factors::<L, true>(lanes, group, at);
            } else {
                self.factors::<L, false>(lanes, group, at);
            }
        }
        self.limits(group);
    }

    /// Makes the lanes of contacts empty that move no body. Returns true if there are any that were not empty.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave_out_held(&mut self, group: &mut Group) -> bool {
        let mut is_any_left_out = false;
        for lane in 0..group.count {
            if !self.moves(lane) && group.normal[lane] != [0; 2] {
                self.clear(lane..lane + 1);
                group.clear(lane..lane + 1);
                is_any_left_out = true;
            }
        }
        is_any_left_out
    }

    /// Writes the rows.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn set_rows<L: Lanes>(&mut self, lanes: L, group: &mut Group, is_short: bool, rate: i32) {
        for at in (0..GROUP).step_by(L::WIDTH) {
            self.load_masses(lanes, at);
            self.load_values(lanes, group, at, rate);
            if is_short {
                self.arms::<L, true>(lanes, group, at);
            } else {
                self.arms::<L, false>(lanes, group, at);
            }
            self.elements(lanes, group, at);
        }
    }

    /// Writes the arms along the rows. `UP` if a lane has a length below a quarter of a metre.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn arms<L: Lanes, const UP: bool>(&self, lanes: L, group: &mut Group, at: usize) {
        let (nx, ny) = lanes.pair(&group.normal, at);
        let tangent = (ny, lanes.minus(lanes.splat(0), nx));
        let [ax, ay, bx, by] = lanes.columns(&self.points[0], at);
        let [last_ax, last_ay, last_bx, last_by] = lanes.columns(&self.points[1], at);
        let shift = Shift::<L>::new::<UP>(lanes, lanes.wide(&self.down[0], at));
        let arms_a = arms_of::<L, UP>(lanes, &shift, [ax, ay], [last_ax, last_ay], (nx, ny), tangent);
        let shift = Shift::<L>::new::<UP>(lanes, lanes.wide(&self.down[1], at));
        let arms_b = arms_of::<L, UP>(lanes, &shift, [bx, by], [last_bx, last_by], (nx, ny), tangent);
        for row in 0..3 {
            lanes.put_pair(&mut group.arms[row], at, (arms_a[row], arms_b[row]));
        }
    }

    /// Finds the elements of the matrices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn elements<L: Lanes>(&mut self, lanes: L, group: &Group, at: usize) {
        let a = self.elements_of(lanes, group, at, 0);
        let b = self.elements_of(lanes, group, at, 1);
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
            lanes.store(&mut self.largest[0][i], at, a.largest[i]);
            lanes.store(&mut self.largest[1][i], at, b.largest[i]);
            let (widest_a, widest_b) =
                (lanes.times(share_a, lanes.low(a.largest[i])), lanes.times(share_b, lanes.low(b.largest[i])));
            lanes.store(&mut self.widest[i], at, lanes.larger(widest_a, widest_b));
        }
    }

    /// Finds the elements of one body, and writes its changes of velocity. Elements of the matrix do not change in a mirror, so that ties
    /// may go upwards; the coupling changes its sign.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn elements_of<L: Lanes>(&mut self, lanes: L, group: &Group, at: usize, side: usize) -> BodyElements<L::Wide> {
        let (nx, ny) = lanes.pair(&group.normal, at);
        let (mx, my) = (lanes.low(lanes.wide(&self.mass[side][0], at)), lanes.low(lanes.wide(&self.mass[side][1], at)));
        let inertia = lanes.low(lanes.wide(&self.inertia[side], at));
        let (px, py) = (product(lanes, mx, nx), product(lanes, my, ny));
        let (qx, qy) = (product(lanes, mx, ny), product(lanes, my, lanes.minus(lanes.splat(0), nx)));
        let k1 = arm(lanes, group, at, 0, side);
        let k2 = arm(lanes, group, at, 1, side);
        let kt = arm(lanes, group, at, 2, side);
        let (t1, t2, tt) = (product(lanes, inertia, k1), product(lanes, inertia, k2), product(lanes, inertia, kt));
        for (words, value) in self.linear.iter_mut().zip([[px, py], [qx, qy]]) {
            lanes.store(&mut words[side][0], at, value[0]);
            lanes.store(&mut words[side][1], at, value[1]);
        }
        for (words, value) in self.angular.iter_mut().zip([t1, t2, tt]) {
            lanes.store(&mut words[side], at, value);
        }
        let largest = [lanes.largest([px, py, qx, qy]), lanes.largest([t1, t2, tt])];
        let [px, py, qx, qy] = [lanes.low(px), lanes.low(py), lanes.low(qx), lanes.low(qy)];
        let [t1, t2, tt] = [lanes.low(t1), lanes.low(t2), lanes.low(tt)];
        let half = lanes.all(1 << 29);
        let along = lanes.add(lanes.add(lanes.times(px, nx), lanes.times(py, ny)), half);
        let cross = lanes.add(lanes.times(qx, nx), lanes.times(qy, ny));
        // Both ways, so that the points may come in either order.
        let mixed = lanes.floored::<1>(lanes.add(lanes.times(t1, k2), lanes.times(t2, k1)));
        let slip = lanes.add(lanes.sub(lanes.times(qx, ny), lanes.times(qy, nx)), half);
        BodyElements {
            elements: [
                lanes.floored::<30>(lanes.add(along, lanes.times(t1, k1))),
                lanes.floored::<30>(lanes.add(along, mixed)),
                lanes.floored::<30>(lanes.add(along, lanes.times(t2, k2))),
                lanes.floored::<30>(lanes.add(slip, lanes.times(tt, kt))),
                lanes.rounded_oddly::<30>(lanes.add(cross, lanes.times(tt, k1))),
                lanes.rounded_oddly::<30>(lanes.add(cross, lanes.times(tt, k2))),
            ],
            largest,
        }
    }

    /// Returns true if the contact of a lane can move a body along the normal at both points, by a change of velocity above the rounding of
    /// the matrix. Smaller changes are of a body that can only turn, at a lever below 10^-4 of its length.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn moves(&self, lane: usize) -> bool {
        self.whole[0][lane].min(self.whole[2][lane]) >= LEAST
    }

    /// Chooses the bits, and writes the shifts of angular factors. Returns true if a lane has fewer bits than a factor.
    ///
    /// All contacts of a phase together change the velocity of a body by no more than one of them alone may: factors of velocities are at
    /// most a quarter, factors of angular velocities at most 2^16. The coupling is at most a quarter too: friction that saw less of the
    /// change by the normal impulses would turn a body against a small lever, and give it energy.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn choose_bits<L: Lanes>(&mut self, lanes: L, group: &mut Group, at: usize) -> bool {
        let (k11, k22) = (lanes.wide(&self.whole[0], at), lanes.wide(&self.whole[2], at));
        let tangent = lanes.wide(&self.tangent[0], at);
        let (zero, normal) = (lanes.all(0), lanes.smaller(k11, k22));
        let smallest = lanes.if_negative(lanes.sub(zero, tangent), lanes.smaller(normal, tangent), normal);
        let (first, second) = (lanes.wide(&self.coupling[0], at), lanes.wide(&self.coupling[1], at));
        let linear = lanes.largest([lanes.wide(&self.widest[0], at), smallest, first, second]);
        let turning = lanes.bit_length(lanes.wide(&self.widest[1], at));
        let bits = lanes.larger(lanes.bit_length(linear), lanes.sub(turning, lanes.all(18)));
        let factor_bits = lanes.all(FACTOR_BITS);
        let is_filled = lanes.sub(zero, k11);
        let bits = lanes.if_negative(is_filled, bits, factor_bits);
        let angular_shift = lanes.positive(lanes.sub(turning, bits));
        lanes.store(&mut self.bits, at, bits);
        lanes.store(&mut group.angular_shift, at, angular_shift);
        // Changes below half of a factor's unit are none.
        let half = lanes.positive(lanes.sub(bits, lanes.all(FACTOR_BITS + 1)));
        let angular_half = lanes.positive(lanes.add(lanes.sub(bits, lanes.all(FACTOR_BITS + 1)), angular_shift));
        for side in 0..2 {
            let moved = lanes.floored_by(lanes.wide(&self.largest[side][0], at), half);
            let turned = lanes.floored_by(lanes.wide(&self.largest[side][1], at), angular_half);
            lanes.store(&mut self.moved[side], at, lanes.add(moved, turned));
        }
        !lanes.is_zero(lanes.positive(lanes.sub(factor_bits, bits)))
    }

    /// Writes the changes of velocity by impulses, and the coupling. `UP` if a lane has fewer bits than a factor.
    ///
    /// With the share of the body these are below 2^bits, angular ones below 2^(bits + shift): the factors are at most a quarter.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn factors<L: Lanes, const UP: bool>(&self, lanes: L, group: &mut Group, at: usize) {
        let bits = lanes.sub(lanes.wide(&self.bits, at), lanes.all(FACTOR_BITS));
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
    #[cfg_attr(not(debug_assertions), inline(always))]
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

/// The arms of one body along the rows, for arms (x, y) of the first and the last point.
#[cfg_attr(not(debug_assertions), inline(always))]
fn arms_of<L: Lanes, const UP: bool>(
    lanes: L,
    shift: &Shift<L>,
    [x1, y1]: [L::Wide; 2],
    [x2, y2]: [L::Wide; 2],
    normal: (L::Narrow, L::Narrow),
    tangent: (L::Narrow, L::Narrow),
) -> [L::Narrow; 3] {
    let (x1, y1) = (shift.arm::<UP>(lanes, x1), shift.arm::<UP>(lanes, y1));
    let (x2, y2) = (shift.arm::<UP>(lanes, x2), shift.arm::<UP>(lanes, y2));
    let middle_x = lanes.low(lanes.rounded_oddly::<1>(lanes.add(x1, x2)));
    let middle_y = lanes.low(lanes.rounded_oddly::<1>(lanes.add(y1, y2)));
    [
        across(lanes, (lanes.low(x1), lanes.low(y1)), normal),
        across(lanes, (lanes.low(x2), lanes.low(y2)), normal),
        // In the middle: friction acts along one line.
        across(lanes, (middle_x, middle_y), tangent),
    ]
}

/// The arm of a body along a row.
#[cfg_attr(not(debug_assertions), inline(always))]
fn arm<L: Lanes>(lanes: L, group: &Group, at: usize, row: usize, side: usize) -> L::Narrow {
    let (arm_a, arm_b) = lanes.pair(&group.arms[row], at);
    if side == 0 { arm_a } else { arm_b }
}
