//! Nodes of trees: matrices and pushes on the way to the centre and back.

use super::angle::{AngleRow, TermsNode};
use super::frame::FrameRows;
use super::symmetric::{Reciprocal, Symmetric, dot, moved, rarely_shifted, scaled, to_impulse, turned, unit_dot};
use super::{FRACTION, IMPULSE, PART, RATIO, RESIDUAL, SOFT, SPEED, TO_IMPULSE, UNIT};
use crate::slots::NONE;
use crate::solve::joint::Block;
use crate::solve::joint::axis::AxisRow;
use crate::solve::joint::turn::Pose;
use crate::solve::motion::Rows;
use crate::solve::number::{
    lowered, lowered_low, lowered_within, lowered_word, product, shifted, upper, within, within_word,
};

/// A node with the joint to its parent.
#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    /// The row of the body; [`STILL`](crate::solve::bodies::STILL) for other nodes.
    pub(super) row: u32,
    /// [`NONE`] for the centre.
    pub(super) parent: u32,
    pub(super) block: u32,
    /// The side of the joint on which it is.
    pub(super) side: usize,
    pub(super) is_body: bool,
    pub(super) is_rod: bool,
    /// The number of the frame of the joint, if rows of it along the axes have laws or are free; else [`NONE`].
    pub(super) frame: u32,
    /// True for a body that can turn at a joint that holds a point; and if all its values are of the sizes that they most often have.
    pub(super) holds_point: bool,
    pub(super) is_pin: bool,
    /// True if the matrices change by the aims of laws.
    pub(super) has_changed: bool,
    /// True if the parent is the middle of the joint.
    pub(super) is_half: bool,
    /// The number of rows with laws at the node, and the share of the masses of both ends that rows of its joint meet in a descent, as minus log2.
    pub(super) law_count: i64,
    pub(super) share: i32,
    /// log2 of the length of the body, m.
    pub(super) length: i32,
    /// The axis of the joint, if something acts on it; and its κ and η on the node, zero without one.
    pub(super) angle: Option<AngleRow>,
    pub(super) stiffness: i64,
    pub(super) axis_torque: i64,
    /// log2 of the units of mass of the node and of the joint, kg.
    pub(super) unit: i32,
    pub(super) joint_unit: i32,
    /// Along x and y, and one over the lighter one of them as if no axis were locked, in 2^-[`SOFT`].
    pub(super) mass: [i64; 2],
    pub(super) linear: i128,
    /// Zero for a body that cannot turn, too.
    pub(super) inertia: i64,
    /// γ
    pub(super) compliance: i64,
    /// γ, raised so that the velocity by which an impulse of the block makes the joint give way stands in the upper word of their product; zero if
    /// it does not fit.
    pub(super) raised_compliance: i64,
    /// From a product of the compliance and an impulse of the block to a velocity, as log2; and from an impulse to one of the block.
    pub(super) give_shift: i32,
    pub(super) push_shift: i32,
    /// A, b, c.
    pub(super) a: Symmetric,
    pub(super) b: [i64; 2],
    pub(super) c: i64,
    /// The point of the joint, turned, from the node and from its parent.
    pub(super) point: [i64; 2],
    pub(super) parent_point: [i64; 2],
    /// The axis of a rod.
    pub(super) axis: [i64; 2],
    /// t and 1/c'; at first one over the inertia.
    pub(super) t: [i64; 2],
    pub(super) turn: Reciprocal,
    /// S; of a rod with its elements as multiples of one number, which stands beside it.
    pub(super) spring: Symmetric,
    pub(super) rod_spring: i64,
    /// For a rod: E along and across over E across, and one over E across.
    pub(super) slant: i64,
    pub(super) across: Reciprocal,
    /// E at the centre.
    pub(super) e: Symmetric,
    /// f and τ.
    pub(super) f: [i128; 2],
    pub(super) torque: i128,
    /// τ', g and r; of a rod g along it, and across it beside g.
    pub(super) tau: i64,
    pub(super) g: [i64; 2],
    pub(super) residual: [i64; 2],
    /// r − γg, of a joint that is no rod.
    pub(super) soft_residual: [i64; 2],
    /// Δλ
    pub(super) push: [i64; 2],
    /// Δv and Δω.
    pub(super) velocity: [i64; 2],
    pub(super) spin: i64,
}

impl Node {
    /// Begins with the masses of the node alone, and the arms and axes of the joint where the bodies are.
    #[inline(always)]
    pub(super) fn begin(&mut self, blocks: &[Block]) {
        self.a = Symmetric { xx: self.mass[0], xy: 0, yy: self.mass[1] };
        (self.b, self.c) = ([0; 2], self.inertia);
        if self.parent != NONE {
            let block = &blocks[self.block as usize];
            self.point = turned(block.sides[self.side].unit_arm.map(i64::from));
            self.parent_point =
                if self.is_half { [0; 2] } else { turned(block.sides[1 - self.side].unit_arm.map(i64::from)) };
            self.axis = block.axes[0];
        }
    }

    /// Eliminates the rotation, and finds the spring that the parent sees.
    #[inline(always)]
    pub(super) fn factor(&mut self, frames: &mut [FrameRows]) {
        self.is_pin = false;
        if self.holds_point {
            self.factor_pin();
        }
        self.factor_others(frames);
    }

    /// [`factor`](Self::factor) of a node that is no pin.
    #[inline(always)]
    pub(super) fn factor_others(&mut self, frames: &mut [FrameRows]) {
        if self.is_pin {
            return;
        }
        if let Some(frame) = frames.get_mut(self.frame as usize) {
            frame.factor(self);
            return;
        }
        if !self.is_body && self.parent != NONE {
            let spring = Reciprocal::new(self.compliance).times(1 << 60, SOFT - 60) as i64;
            (self.spring, self.rod_spring) = (Symmetric::isotropic(spring), spring);
            self.factor_angle(0);
            return;
        }
        let mut e = self.a;
        let mut c_alone = 0;
        (self.t, self.turn) = ([0; 2], Reciprocal::new(0));
        // The middle of a joint turns if something acts on its axis.
        if self.inertia != 0 || !self.is_body && self.c > 0 {
            let [x, y] = self.a.times_unit(self.point);
            let b = [self.b[0] - x, self.b[1] - y];
            c_alone = self.c - unit_dot(self.point, [self.b[0] + b[0], self.b[1] + b[1]]);
            self.turn = Reciprocal::new(c_alone + self.stiffness);
            let t = [self.turn.times_within(b[0], RATIO, IMPULSE), self.turn.times_within(b[1], RATIO, IMPULSE)];
            self.t = t;
            e.xx -= lowered_low(product(b[0], t[0]), RATIO);
            e.xy -= lowered_low(product(b[0], t[1]) + product(b[1], t[0]), RATIO + 1);
            e.yy -= lowered_low(product(b[1], t[1]), RATIO);
        }
        if self.parent == NONE {
            self.e = e;
            return;
        }
        let e = e.shifted(self.joint_unit - self.unit);
        if self.is_rod {
            self.factor_rod(&e);
        } else {
            self.spring = e.softened(self.compliance);
            self.factor_angle(c_alone);
        }
    }

    /// Finds the terms of the axis for the parent, unless both turn freely.
    #[inline(always)]
    pub(super) fn factor_angle(&mut self, c: i64) {
        let Self { angle: Some(angle), is_pin, t, turn, spring, compliance, parent_point, .. } = self else { return };
        if angle.is_free() {
            return;
        }
        let node = TermsNode { t: *t, spring: *spring, compliance: *compliance, parent_point: *parent_point };
        if !*is_pin || angle.set_pin_terms(&node, c, *turn) != 0 {
            angle.set_terms(&node, c, *turn);
        }
    }

    /// Eliminates the motion across a rod.
    fn factor_rod(&mut self, e: &Symmetric) {
        let (along, across) = (self.axis, turned(self.axis));
        let (e_along, e_across) = (e.lowered_times(along, UNIT), e.lowered_times(across, UNIT));
        let mixed = lowered_low(dot(along, e_across) + dot(across, e_along), UNIT + 1);
        self.across = Reciprocal::new(lowered_low(dot(across, e_across), UNIT));
        self.slant = self.across.times_within(mixed, RATIO, IMPULSE);
        let left = (lowered(dot(along, e_along), UNIT) - lowered(product(mixed, self.slant), RATIO)).max(0) as i64;
        let sum = (1 << PART) + lowered(product(left, self.compliance), SOFT - PART);
        self.rod_spring = Reciprocal::of_double(sum).times(left, PART) as i64;
    }

    /// Adds the spring to the parent.
    #[inline(always)]
    pub(super) fn join(&self, frames: &[FrameRows], parent: &mut Self) {
        if let Some(frame) = frames.get(self.frame as usize) {
            frame.join(self, parent);
            return;
        }
        let spring = match (self.is_rod, self.is_half) {
            (false, _) => self.spring,
            // Pushes are along the rod: across it any spring will do.
            (true, true) => Symmetric::isotropic(self.rod_spring),
            (true, false) => {
                let [x, y] = scaled(self.axis, self.rod_spring);
                let [nx, ny] = self.axis;
                Symmetric {
                    xx: lowered_low(product(x, nx), UNIT),
                    xy: lowered_low(product(x, ny) + product(y, nx), UNIT + 1),
                    yy: lowered_low(product(y, ny), UNIT),
                }
            }
        };
        let spring = spring.shifted(parent.unit - self.joint_unit);
        let moment = spring.times_unit(self.parent_point);
        parent.a = parent.a.plus(spring);
        parent.b = [parent.b[0] + moment[0], parent.b[1] + moment[1]];
        parent.c += unit_dot(self.parent_point, moment);
        if let Some(angle) = self.angle.as_ref().filter(|angle| !angle.is_free()) {
            let terms = angle.terms();
            let down = parent.unit - self.joint_unit;
            let [x, y] = [rarely_shifted(terms.b[0], down), rarely_shifted(terms.b[1], down)];
            parent.b = [parent.b[0] + x, parent.b[1] + y];
            parent.c += rarely_shifted(terms.c, down);
        }
    }

    /// Begins a pass: the residual of the node against its parent. With a rate, in 2^-30, it is the solve pass.
    #[inline(always)]
    pub(super) fn begin_pass(&mut self, blocks: &[Block], poses: &[Pose], rows: &Rows, rate: Option<i64>) {
        if self.parent == NONE {
            return;
        }
        let block = &blocks[self.block as usize];
        let residual = block.residual(rows, poses, rate);
        let bits = UNIT - FRACTION + i32::from(self.is_half);
        for (row, part) in residual.into_iter().enumerate() {
            if block.held[row] {
                // Below 2^62.
                let mut sum = lowered_word(part, bits);
                if rate.is_some() {
                    sum += if self.raised_compliance != 0 {
                        // Below 2^62 · 2^50.
                        upper(product(self.raised_compliance, block.impulses[row]))
                    } else {
                        // More than the sum may be is as good as that.
                        within(shifted(product(self.compliance, block.impulses[row]), self.give_shift), 1 << 61)
                    };
                }
                let sum = within_word(sum, RESIDUAL);
                self.residual[row] = if self.side == 0 { -sum } else { sum };
            }
        }
    }

    /// Sets the aims of the laws of the joint to the parent in a pass. Returns true if the matrices change by it.
    #[inline(always)]
    pub(super) fn set_aims(&mut self, frames: &mut [FrameRows], block: &Block, laws: &[AxisRow]) -> bool {
        if let Some(frame) = frames.get_mut(self.frame as usize) {
            return frame.set_aims(block, laws, self);
        }
        let (Some(angle), Some(aim)) = (&self.angle, block.aim(2, laws)) else { return false };
        let aim = angle.aim(aim, block.impulses[2], self);
        let up = self.unit - self.joint_unit;
        let Some(angle) = &mut self.angle else { return false };
        let has_changed = angle.set_aim(&aim);
        self.axis_torque = angle.impulse_on_node(up);
        if has_changed {
            self.stiffness = angle.on_node(up);
        }
        has_changed
    }

    /// The velocity by which the joint gives way to an impulse.
    #[inline(always)]
    pub(super) fn give(&self, impulse: i64) -> i64 {
        lowered(product(self.compliance, impulse), SOFT - TO_IMPULSE) as i64
    }

    /// On the way to the centre: the impulses that are left at the joint, which go to the parent, and the torque of its axis.
    #[inline(always)]
    pub(super) fn pass_down(&mut self, frames: &mut [FrameRows]) -> ([i64; 2], i64) {
        if self.is_pin {
            if let Some(impulse) = self.pass_down_pin() {
                return (impulse, self.torque_on_parent());
            }
        }
        if let Some(frame) = frames.get_mut(self.frame as usize) {
            return frame.pass_down(self);
        }
        let mut g = [0; 2];
        if self.is_body || self.parent == NONE {
            let f = [within(self.f[0], IMPULSE), within(self.f[1], IMPULSE)];
            let torque = self.torque + i128::from(self.axis_torque) - i128::from(unit_dot(self.point, f));
            self.tau = within(torque, IMPULSE);
            // At most 2^12 times as large.
            let up = if self.parent == NONE { 0 } else { self.unit - self.joint_unit };
            // Each is below 2^62.
            let turning = |t: i64| lowered_within(product(t, self.tau), RATIO, 1 << 61);
            let left = |f: i64, t: i64| within_word(f - turning(t), IMPULSE >> up) << up;
            g = [left(f[0], self.t[0]), left(f[1], self.t[1])];
        }
        (self.f, self.torque) = ([0; 2], 0);
        if !self.is_rod || self.parent == NONE {
            self.g = g;
            self.soft_residual = [self.residual[0] - self.give(g[0]), self.residual[1] - self.give(g[1])];
            let push = self.spring.push(self.soft_residual);
            return ([g[0] + push[0], g[1] + push[1]], self.torque_on_parent());
        }
        let across = unit_dot(turned(self.axis), g);
        // Both are below 2^62.
        let along = unit_dot(self.axis, g) - lowered_within(product(self.slant, across), RATIO, 1 << 62);
        let along = within_word(along, IMPULSE);
        self.g = [along, across];
        let push = to_impulse(product(self.rod_spring, self.residual[0] - self.give(along)));
        (scaled(self.axis, within_word(along + push, IMPULSE)), 0)
    }

    /// The torque of the axis on the parent.
    #[inline(always)]
    fn torque_on_parent(&self) -> i64 {
        match &self.angle {
            None => 0,
            Some(angle) if angle.is_free() => angle.torque_on_parent(),
            Some(angle) => angle.pass_down(self.turn.times_within(self.tau, TO_IMPULSE, SPEED), self.soft_residual),
        }
    }

    /// Adds the impulses of a child at its joint.
    #[inline(always)]
    pub(super) fn take(&mut self, impulse: [i64; 2], joint_unit: i32, point: [i64; 2]) {
        let down = self.unit - joint_unit;
        let [x, y] = [rarely_shifted(impulse[0], down), rarely_shifted(impulse[1], down)];
        (self.f[0], self.f[1]) = (self.f[0] + i128::from(x), self.f[1] + i128::from(y));
        // At most 2^61 each.
        self.torque += i128::from(lowered_low(dot(point, [x, y]), UNIT));
    }

    /// Adds the torque of the axis of a child.
    #[inline(always)]
    pub(super) fn take_torque(&mut self, child: &Self, frames: &[FrameRows], torque: i64) {
        let down = self.unit - child.joint_unit;
        if let Some(frame) = frames.get(child.frame as usize) {
            self.torque += i128::from(frame.on_parent(torque, down));
        } else if let Some(angle) = &child.angle {
            self.torque += i128::from(angle.on_parent(torque, down));
        }
    }

    /// On the way back: the change of the impulse of the joint, and of the velocity of the node, by the velocity of the parent.
    #[inline(always)]
    pub(super) fn pass_up(&mut self, frames: &mut [FrameRows], parent_velocity: [i64; 2], parent_spin: i64) {
        let at = moved(parent_velocity, parent_spin, self.parent_point);
        if self.is_pin {
            let (by_angle, angle_spin) = self.pushes_of_angle(parent_spin);
            if self.pass_up_pin(at, by_angle) {
                if let Some(angle) = &mut self.angle {
                    angle.finish(angle_spin, self.spin);
                }
                return;
            }
        }
        if let Some(frame) = frames.get_mut(self.frame as usize) {
            frame.pass_up(self, at, parent_spin);
            return;
        }
        if self.is_rod {
            let (along, across) = (self.axis, turned(self.axis));
            let [g, g_across] = self.g;
            let difference = unit_dot(along, at) - self.residual[0];
            self.push = [to_impulse(product(self.rod_spring, difference + self.give(g))) - g, 0];
            if self.is_body {
                let v = within_word(difference - self.give(self.push[0]), SPEED);
                let w = self.across.less_ratio(g_across, product(self.slant, v));
                let ([x, y], [wx, wy]) = (scaled(along, v), scaled(across, w));
                self.finish([x + wx, y + wy]);
            }
        } else {
            let difference = [at[0] - self.residual[0], at[1] - self.residual[1]];
            let push = self.spring.push([at[0] - self.soft_residual[0], at[1] - self.soft_residual[1]]);
            self.push = [push[0] - self.g[0], push[1] - self.g[1]];
            let ([x, y, torque], angle_spin) = self.pushes_of_angle(parent_spin);
            self.push = [self.push[0] + x, self.push[1] + y];
            // Both are at most 2^60.
            self.tau = within_word(self.tau + torque, IMPULSE);
            if self.is_body {
                self.finish([difference[0] - self.give(self.push[0]), difference[1] - self.give(self.push[1])]);
            }
            if let Some(angle) = &mut self.angle {
                angle.finish(angle_spin, if self.is_body { self.spin } else { 0 });
            }
        }
    }

    /// The impulses at the point of the joint and of rotation on the node that its axis makes of the velocity of the parent, and that velocity at
    /// the length of the joint.
    #[inline(always)]
    fn pushes_of_angle(&self, parent_spin: i64) -> ([i64; 3], i64) {
        let Some(angle) = &self.angle else { return ([0; 3], 0) };
        let spin = angle.parent_spin(parent_spin);
        if angle.is_free() {
            return ([0; 3], spin);
        }
        let [x, y] = angle.push_of_point(spin);
        ([x, y, angle.torque_on_node(spin, self.unit - self.joint_unit)], spin)
    }

    /// The changes of the impulses of the rows of the joint.
    #[inline(always)]
    pub(super) fn impulses(&self, frames: &[FrameRows]) -> [i64; 3] {
        match frames.get(self.frame as usize) {
            Some(frame) => frame.push,
            None => [self.push[0], self.push[1], self.angle.as_ref().map_or(0, |angle| angle.push)],
        }
    }

    /// The changes of the velocity and of the impulse of a row that may have a law.
    #[inline(always)]
    pub(super) fn row_change(&self, frames: &[FrameRows], row: usize) -> Option<(i64, i64)> {
        match frames.get(self.frame as usize) {
            Some(frame) => Some((frame.change[row], frame.push[row])),
            None => self.angle.as_ref().filter(|_| row == 2).map(|angle| (angle.change, angle.push)),
        }
    }

    /// The velocities of the centre.
    #[inline(always)]
    pub(super) fn turn_back(&mut self) {
        let velocity = self.e.velocity_by(self.g);
        self.finish(velocity);
    }

    /// The velocities of a node by the velocity of its point.
    #[inline(always)]
    fn finish(&mut self, velocity: [i64; 2]) {
        let velocity = [within_word(velocity[0], SPEED), within_word(velocity[1], SPEED)];
        self.spin = self.turn.less_ratio(self.tau, dot(self.t, velocity));
        let [x, y] = moved(velocity, -self.spin, self.point);
        self.velocity = [within_word(x, SPEED), within_word(y, SPEED)];
    }
}
