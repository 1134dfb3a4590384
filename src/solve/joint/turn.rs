//! Arms, axes and errors of joints where the bodies are.

use super::axis::AxisRow;
use super::{Block, ERROR, FAR, Frame, GAIN, along, perpendicular};
use crate::kernel::sqrt::direction;
use crate::kernel::trig::sin_cos_turn;
use crate::kernel::wide::mul_shift_64;
use crate::math::Vec2;
use crate::scalar::FxFactor;
use crate::slots::NONE;
use crate::solve::Flight;
use crate::solve::motion::{Rows, Vector};
use crate::solve::number::{clamped, clamped_word, fixed, lowered, lowered_word, shifted, shifted_word, upper};
use crate::solve::unit::{Clock, multiple};

/// 0.1 rad in 2^-30: the largest turn in a sub-step that the second-order term counts.
const LARGEST_ANGLE: i64 = 107_374_182;

/// A third, in 2^-32.
const THIRD: i64 = 1_431_655_765;

/// The terms of second and third order in the motion of the end of an arm that turns by an angle in 2^-30 rad, with the opposite sign:
/// φ²/2·(r + φ/3·(r turned left by a quarter)). Without the third order a rod that spins on a pin would gain energy.
///
/// # Ranges
/// Arms are within 2^60, angles within 0.1 rad: products are below 2^114.
#[inline(always)]
fn bend([x, y]: [i64; 2], angle: i64) -> [i64; 2] {
    let (x, y) = (i128::from(x), i128::from(y));
    let third = i128::from(lowered_word(angle * THIRD, 32));
    let square = i128::from(angle * angle);
    let turned = [x - lowered(third * y, 30), y + lowered(third * x, 30)];
    [lowered(square * turned[0], 31) as i64, lowered(square * turned[1], 31) as i64]
}

/// value · k/n to nearest, ties away from zero. *Domain* |value| at most 2^28.
fn part(value: i32, k: i32, n: i32) -> i32 {
    if value == 0 {
        return 0;
    }
    let twice = 2 * i64::from(value) * i64::from(k);
    ((twice + i64::from(value.signum() * n)) / i64::from(2 * n)) as i32
}

/// A vector within ±2^60 turned by an angle, of which sine and cosine are in 2^-62: with two bits more, it stands in the upper words.
#[inline(always)]
fn turned([x, y]: [i64; 2], sin: i64, cos: i64) -> [i64; 2] {
    let (x, y) = (i128::from(x << 2), i128::from(y << 2));
    let (sin, cos) = (i128::from(sin), i128::from(cos));
    [upper(cos * x - sin * y), upper(sin * x + cos * y)]
}

/// The angle that a body turns in a sub-step at an angular velocity, by the angle of a unit of it: in 2^-30 rad within ±0.1 rad.
#[inline(always)]
fn sweep(factor: (u64, i32), velocity: i32) -> i64 {
    let (mantissa, shift) = factor;
    if matches!(shift, 32..96) {
        // Raised, velocities are below 2^60.
        let angle = multiple(i64::from(velocity) << 32, mantissa, shift + 32);
        return angle.clamp(-LARGEST_ANGLE, LARGEST_ANGLE);
    }
    let limit = i128::from(LARGEST_ANGLE);
    // An angle that does not fit is as large as any.
    mul_shift_64(velocity.into(), mantissa, shift).unwrap_or(limit).clamp(-limit, limit) as i64
}

/// The turn of an angular displacement by the turn of a unit of it, in 2^-64: whole turns do not matter.
#[inline(always)]
fn turn_of(factor: (u64, i32), displacement: i32) -> u64 {
    let (mantissa, shift) = factor;
    if !matches!(shift, 1..64) {
        return mul_shift_64(displacement.into(), mantissa, shift).unwrap_or(0) as u64;
    }
    // To nearest, ties to even.
    let product = u128::from(displacement.unsigned_abs()) * u128::from(mantissa);
    let (floor, rest) = ((product >> shift) as u64, (product as u64) << (64 - shift));
    let turn = floor.wrapping_add(u64::from(rest > (1 << 63) - (floor & 1)));
    if displacement < 0 { turn.wrapping_neg() } else { turn }
}

/// A row of a body with joints, as all of these see it.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub(super) number: u32,
    pub(super) row: u32,
    /// The number of the body.
    pub(super) body: u32,
    /// log2 of the unit of velocity of the row, m/s.
    pub(super) unit: i32,
    /// The turn of a unit of angular displacement, in 2^-64: mantissa and shift.
    turn: (u64, i32),
    /// The angle of a unit of angular velocity in a sub-step, in 2^-30 rad: mantissa and shift.
    pub(super) angle: (u64, i32),
    /// The excess of the displacement of the row over the displacement of the body, at the end of the step.
    pub(super) shift: [i32; 3],
    /// The displacement of the body since the start.
    moved: [i32; 3],
    /// Sine and cosine of its angle since the start, in 2^-62.
    sin: i64,
    cos: i64,
    /// The angle that it turns in a sub-step at its velocity, in 2^-30 rad.
    sweep: i64,
}

impl Pose {
    /// A row of a body in a unit of velocity.
    pub(super) fn new(number: u32, row: u32, body: u32, flight: &Flight, unit: i32, clock: &Clock) -> Self {
        let scaled = |factor: FxFactor, bits: i32| {
            let (mantissa, shift) = factor.parts();
            (mantissa, shift - bits - unit + flight.length())
        };
        Self {
            number,
            row,
            body,
            unit,
            turn: scaled(clock.substep_turns, 64),
            angle: scaled(clock.substep, 30),
            shift: [0; 3],
            moved: [0; 3],
            sin: 0,
            cos: 1 << 62,
            sweep: 0,
        }
    }

    /// Takes the pose after `moves` of all sub-steps.
    #[inline(always)]
    pub(super) fn advance(&mut self, rows: &Rows, moves: i32, substeps: i32) {
        let [x, y, turn, _] = rows.displacement(self.row);
        self.moved = [x, y, turn];
        if self.shift != [0; 3] {
            for (moved, shift) in self.moved.iter_mut().zip(self.shift) {
                *moved -= part(shift, moves, substeps);
            }
        }
        let turn = turn_of(self.turn, self.moved[2]);
        (self.sin, self.cos) = if turn == 0 { (0, 1 << 62) } else { sin_cos_turn(turn) };
    }

    /// Sets the angle of a sub-step at the present velocity.
    #[inline(always)]
    pub(super) fn set_sweep(&mut self, rows: &Rows) {
        let [_, _, spin, _] = rows.velocity(self.row);
        self.sweep = sweep(self.angle, spin);
    }
}

/// The angles that both bodies turn in a sub-step, and the difference of the parts of their arms' motion that are of second order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bends {
    angles: [i64; 2],
    pub(super) bend: [i64; 2],
}

/// A body at a joint: first all that passes need, then all that moves need, as in the [block](Block).
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Side {
    pub(super) row: u32,
    /// The number of its pose.
    pub(super) pose: u32,
    /// Changes of velocity along x and y and of rotation, by an impulse: at most 2^44.
    pub(super) masses: [i64; 3],
    /// The arm now.
    pub(super) arm: [i64; 2],
    /// The arm now, in 2^-30 of the length of the body.
    pub(super) unit_arm: [i32; 2],
    /// Both arms at the start.
    pub(super) unit_start: [i32; 2],
    pub(super) start: [i64; 2],
    /// The angle of a unit of angular velocity in a sub-step, in 2^-30 rad: mantissa and shift.
    pub(super) angle: (u64, i32),
    /// The largest change of velocity by the joint in an impact.
    pub(super) gain_limit: i64,
    /// The excess of the displacement of the row over the displacement of the body, at the end of the step.
    pub(super) shift: [i32; 3],
}

impl Side {
    /// A body at a joint, with masses in 2^-`scale`.
    pub(super) fn new(
        flight: &Flight,
        pose: &Pose,
        share: i64,
        anchor: Vec2,
        scale: i32,
        unit: i32,
        clock: &Clock,
    ) -> Self {
        let length = flight.length();
        let (mx, my) = (fixed(flight.inverse_mass.x, scale), fixed(flight.inverse_mass.y, scale));
        let angular = fixed(flight.inverse_inertia, scale + 2 * length);
        // Within the length of the body: ranges rest on it.
        let limit = 1 << (32 + length).clamp(0, 62);
        let anchor = [anchor.x, anchor.y].map(|c| c.to_bits().clamp(-limit, limit));
        let start = anchor.map(|c| clock.length_of_bits(c.into(), unit).clamp(-FAR, FAR) as i64);
        let unit_start = anchor.map(|c| match 2 + length {
            down @ 1..64 => clamped_word(shifted_word(c, down), 1 << 30),
            down => clamped(shifted(c.into(), down), 1 << 30),
        });
        Self {
            row: pose.row,
            pose: pose.number,
            masses: [mx, my, angular],
            arm: start,
            unit_arm: unit_start,
            unit_start,
            start,
            angle: pose.angle,
            gain_limit: GAIN.min((1 << 61) / share),
            shift: [0; 3],
        }
    }

    #[inline(always)]
    pub(super) fn is_movable(&self) -> bool {
        self.masses != [0; 3]
    }

    /// A bound, from above, on the mass factor of any row at the arm.
    pub(super) fn largest_mass(&self) -> i64 {
        let [x, y] = self.unit_arm.map(i128::from);
        let [mx, my, angular] = self.masses;
        mx + my + shifted(i128::from(angular) * (x * x + y * y), 60) as i64
    }

    /// Turns the arm to the pose.
    #[inline(always)]
    fn turn_to(&mut self, pose: &Pose) {
        if pose.sin == 0 && pose.cos == 1 << 62 {
            (self.arm, self.unit_arm) = (self.start, self.unit_start);
            return;
        }
        self.arm = turned(self.start, pose.sin, pose.cos);
        self.unit_arm = turned(self.unit_start.map(i64::from), pose.sin, pose.cos).map(|part| part as i32);
    }

    /// Takes the arm to the other point, which is off by this much.
    pub(super) fn reach(&mut self, offset: [i64; 2]) {
        let (mantissa, shift) = self.angle;
        let limit = 1_i128 << 30;
        for (arm, offset) in self.unit_arm.iter_mut().zip(offset) {
            let part = mul_shift_64(offset.into(), mantissa, shift).unwrap_or(i128::from(offset.signum()) * limit);
            *arm = clamped(i128::from(*arm) + part, limit);
        }
    }

    /// The cross product of the arm with an axis.
    #[inline(always)]
    fn across(&self, [ux, uy]: [i64; 2]) -> i64 {
        let [x, y] = self.unit_arm;
        lowered(i128::from(x) * i128::from(uy) - i128::from(y) * i128::from(ux), 30) as i64
    }
}

impl Block {
    /// Updates arms, axes and errors to the poses of the bodies. Returns the number of errors that were cut off.
    #[inline(always)]
    pub(super) fn turn(&mut self, poses: &[Pose], laws: &mut [AxisRow]) -> u64 {
        let [first, second] = [&poses[self.sides[0].pose as usize], &poses[self.sides[1].pose as usize]];
        self.sides[0].turn_to(first);
        self.sides[1].turn_to(second);
        let [a, b] = &self.sides;
        let offset = [0, 1].map(|i| {
            let way = i64::from(second.moved[i]) - i64::from(first.moved[i]);
            self.base[i] + way + b.arm[i] - a.arm[i]
        });
        let wanted = match self.frame {
            Frame::World => offset,
            Frame::Line => {
                let (axis, distance) = if offset == [0; 2] { ([0; 2], 0) } else { direction(offset[0], offset[1]) };
                self.axes[0] = axis.map(i64::from);
                self.distance = distance as i64;
                [self.distance - self.lengths[0], 0]
            }
            Frame::Ropes { second_base, factors } => self.turn_ropes(second_base, factors, poses),
            Frame::Body(axis) => {
                let axis = turned(axis, first.sin, first.cos);
                let across = perpendicular(axis);
                (self.axes[0], self.axes[1]) = (axis, across);
                self.sides[0].reach(offset);
                [along(axis, offset) - self.lengths[0], along(across, offset) - self.lengths[1]]
            }
        };
        self.errors = wanted.map(|error| error.clamp(-ERROR, ERROR));
        if self.laws != [NONE; 3] {
            let ways = match self.frame {
                Frame::Ropes { factors, .. } => [along(factors, wanted), 0],
                _ => wanted,
            };
            self.set_ways(ways, [first.moved[2], second.moved[2]], laws);
        }
        match self.frame {
            // Arms have these axes.
            Frame::World if self.holds_point() => {
                let [[ax, ay], [bx, by]] = [0, 1].map(|side| self.sides[side].unit_arm.map(i64::from));
                (self.crosses[0], self.crosses[1]) = ([-ay, -by], [ax, bx]);
            }
            Frame::World => {}
            Frame::Line | Frame::Body(_) | Frame::Ropes { .. } => {
                for row in 0..2 {
                    if self.is_active[row] {
                        let [first, second] = self.side_axes(row);
                        self.crosses[row] = [self.sides[0].across(first), self.sides[1].across(second)];
                    }
                }
            }
        }
        let is_cut = |row: usize| self.held[row] && self.errors[row] != wanted[row];
        u64::from(is_cut(0) || is_cut(1))
    }

    /// Updates the axes of a pulley. Returns the ways by which both parts of its rope have grown.
    #[cold]
    fn turn_ropes(&mut self, second_base: [i64; 2], factors: [i64; 2], poses: &[Pose]) -> [i64; 2] {
        [0, 1].map(|side| {
            let (base, Side { pose, arm, .. }) = ([self.base, second_base][side], &self.sides[side]);
            let way = [0, 1].map(|i| base[i] + i64::from(poses[*pose as usize].moved[i]) + arm[i]);
            let (axis, length) = if way == [0; 2] { ([0; 2], 0) } else { direction(way[0], way[1]) };
            // The velocity of a row is the second body's less the first body's.
            let factor = if side == 0 { -factors[0] } else { factors[1] };
            self.axes[side] = axis.map(|part| lowered_word(i64::from(part) * factor, 30));
            length as i64 - self.lengths[side]
        })
    }

    /// Tells the laws of the rows their ways: along the axes, and around by the turns of the bodies.
    fn set_ways(&self, ways: [i64; 2], turns: [i32; 2], laws: &mut [AxisRow]) {
        for (law, way) in self.laws.into_iter().zip(ways) {
            if let Some(law) = laws.get_mut(law as usize) {
                law.set_way(way.clamp(-FAR as i64, FAR as i64));
            }
        }
        if let Some(law) = laws.get_mut(self.laws[2] as usize) {
            let [across_a, across_b] = self.crosses[2];
            // Each below 2^61.
            law.set_way(shifted_word(across_b * i64::from(turns[1]) - across_a * i64::from(turns[0]), 30));
        }
    }

    /// The angles that the bodies turn in a sub-step at the velocities of their poses, in 2^-30 rad within ±0.1 rad.
    #[inline(always)]
    pub(super) fn sweeps(&self, poses: &[Pose]) -> [i64; 2] {
        [poses[self.sides[0].pose as usize].sweep, poses[self.sides[1].pose as usize].sweep]
    }

    /// [`sweeps`](Self::sweeps) at other velocities.
    pub(super) fn sweeps_at(&self, velocities: [Vector; 2]) -> [i64; 2] {
        [sweep(self.sides[0].angle, velocities[0][2]), sweep(self.sides[1].angle, velocities[1][2])]
    }

    /// The turns of the bodies and the bend of the arms by them.
    #[inline(always)]
    pub(super) fn bends(&self, angles: [i64; 2]) -> Bends {
        let [first, second] = [bend(self.sides[0].arm, angles[0]), bend(self.sides[1].arm, angles[1])];
        Bends { angles, bend: [first[0] - second[0], first[1] - second[1]] }
    }

    /// The part of the motion of the anchors in a sub-step along a row that the velocities at its end leave out, in 2^-30:
    /// the [bends](bend) of both arms, the shifts of the bodies, and the turn of a rod.
    #[inline(always)]
    pub(super) fn second_order(&self, row: usize, velocities: [Vector; 2], bends: Bends) -> i64 {
        let mut sum = match self.frame {
            Frame::World if row < 2 => bends.bend[row],
            _ => along(self.axes[row], bends.bend),
        };
        if self.is_shifted {
            sum -= self.velocity(row, self.shifts()) / i64::from(self.substeps);
        }
        match self.frame {
            Frame::World => sum,
            // It has no row that is held.
            Frame::Ropes { .. } => 0,
            Frame::Line => sum + self.rod_turns(velocities),
            Frame::Body(_) => sum + self.axis_turns(row, velocities, bends.angles),
        }
    }

    /// The part of the second-order term that the turn of the axes has, for the angle φ of the first body, in 2^-30: along an axis φ·(velocity along
    /// the other one), across −φ·(velocity along it), each − φ²/2·(offset along the axis), where the row is not held at no offset.
    fn axis_turns(&self, row: usize, velocities: [Vector; 2], angles: [i64; 2]) -> i64 {
        let angle = i128::from(angles[0]);
        // Of the points: the first one is at its own end. Velocities are below 2^30.5.
        let points = [0, 1].map(|k| {
            let ([x, y], [vx, vy, ..]) = (self.sides[k].arm.map(i128::from), velocities[k]);
            let turn = i128::from(angles[k]);
            [(i128::from(vx) << 30) - turn * y, (i128::from(vy) << 30) + turn * x]
        });
        let [ux, uy] = self.axes[1 - row].map(i128::from);
        let velocity = shifted(ux * (points[1][0] - points[0][0]) + uy * (points[1][1] - points[0][1]), 30);
        let by_velocity = shifted(angle * velocity, 30) * if row == 1 { -1 } else { 1 };
        if self.held[row] {
            return by_velocity as i64;
        }
        // The error is counted from the offset at the start, which is within 2^60: with the square of an angle below 2^114.
        let offset = i128::from(self.lengths[row]) + i128::from(self.errors[row]);
        let by_offset = shifted(angle * angle * offset, 31).clamp(-(1 << 58), 1 << 58);
        (by_velocity - by_offset) as i64
    }

    /// The shifts of both bodies at the end of the step.
    #[inline(always)]
    pub(super) fn shifts(&self) -> [Vector; 2] {
        [0, 1].map(|k| {
            let [x, y, turn] = self.sides[k].shift;
            [x, y, turn, 0]
        })
    }

    /// [`second_order`](Self::second_order) of the row of a pulley: of each part of its rope the arm along the axis, and ψ²·l/2 for the angle ψ
    /// that the part of length l turns, at most 0.1 rad.
    #[cold]
    pub(super) fn rope_second_order(&self, velocities: [Vector; 2]) -> i64 {
        let Frame::Ropes { factors, .. } = self.frame else { return 0 };
        let (angles, mut sum) = (self.sweeps_at(velocities), 0);
        if self.is_shifted {
            sum -= self.velocity(0, self.shifts()) / i64::from(self.substeps);
        }
        for side in 0..2 {
            let (axis, Side { arm: [x, y], .. }) = (self.axes[side], &self.sides[side]);
            let [vx, vy, ..] = velocities[side].map(i128::from);
            let (angle, factor) = (i128::from(angles[side]), i128::from(factors[side]));
            let bend = bend([*x, *y], angles[side]);
            sum += if side == 0 { along(axis, bend) } else { -along(axis, bend) };
            let length = i128::from(self.lengths[side]) + i128::from(self.errors[side]);
            if length > 0 {
                // Velocities are below 2^30.5, and the factor is in the axis.
                let point = [(vx << 30) - angle * i128::from(*y), (vy << 30) + angle * i128::from(*x)];
                let across = shifted(i128::from(axis[0]) * point[1] - i128::from(axis[1]) * point[0], 30).abs();
                let turn = ((across << 30) / factor / length).min(LARGEST_ANGLE.into());
                sum += lowered(shifted(turn * turn * length, 31) * factor, 30) as i64;
            }
        }
        sum
    }

    /// φ²·l/2 for the angle φ that a rod of length l turns in the sub-step, in 2^-30; φ is at most 0.1 rad.
    fn rod_turns(&self, [a, b]: [Vector; 2]) -> i64 {
        if self.distance == 0 {
            return 0;
        }
        let [arm_a, arm_b] = [0, 1].map(|k| self.sides[k].unit_arm.map(i64::from));
        let [x, y] = [0, 1].map(|i| (i64::from(b[i]) - i64::from(a[i])) << 30);
        let [wa, wb] = [i64::from(a[2]), i64::from(b[2])];
        let (x, y) = (x - wb * arm_b[1] + wa * arm_a[1], y + wb * arm_b[0] - wa * arm_a[0]);
        let [ux, uy] = self.axes[0].map(i128::from);
        let across = shifted(ux * i128::from(y) - uy * i128::from(x), 30) as i64;
        let angle = i128::from((across.abs() / self.distance).min(LARGEST_ANGLE));
        shifted(angle * angle * i128::from(self.distance), 31) as i64
    }

    /// The part of the velocity of a rope that is along x and y, in 2^-30.
    #[cold]
    fn rope_way(&self, [a, b]: [Vector; 2]) -> i64 {
        let [[ax, ay], [bx, by], _] = self.axes;
        bx * i64::from(b[0]) + by * i64::from(b[1]) - ax * i64::from(a[0]) - ay * i64::from(a[1])
    }

    /// The [velocities](Self::velocity) of both rows of a joint that holds a point.
    #[inline(always)]
    pub(super) fn point_velocity(&self, [a, b]: [Vector; 2]) -> [i64; 2] {
        let ([ka, kb], [la, lb]) = (self.crosses[0], self.crosses[1]);
        let [turn_a, turn_b] = [i64::from(a[2]), i64::from(b[2])];
        let [x, y] = [0, 1].map(|i| (i64::from(b[i]) - i64::from(a[i])) << 30);
        [x + (kb * turn_b - ka * turn_a), y + (lb * turn_b - la * turn_a)]
    }

    /// The velocity of the row around, in 2^-30.
    #[inline(always)]
    pub(super) fn turning_velocity(&self, [a, b]: [Vector; 2]) -> i64 {
        let [across_a, across_b] = self.crosses[2];
        across_b * i64::from(b[2]) - across_a * i64::from(a[2])
    }

    /// The sum of a row's products with the velocities of both bodies, in 2^-30.
    #[inline(always)]
    pub(super) fn velocity(&self, row: usize, [a, b]: [Vector; 2]) -> i64 {
        let ([ux, uy], [ka, kb]) = (self.axes[row], self.crosses[row]);
        let turning = kb * i64::from(b[2]) - ka * i64::from(a[2]);
        if self.is_pulley() {
            return self.rope_way([a, b]) + turning;
        }
        let [x, y] = [0, 1].map(|i| i64::from(b[i]) - i64::from(a[i]));
        ux * x + uy * y + turning
    }
}
