//! A joint in a frame of its own: three rows between a node and its parent, along two axes and around, each held, free, or with a law.
//!
//! The impulse of row i on the node follows from the changes of the velocities, λ = κ(v − u − r) + η, with u for the node and v for the parent at
//! the point of the joint, along the axes of the frame; r is the residual. A held row, a spring, a force that is given and a free row differ
//! in κ, r and η alone. The velocities of the node are eliminated one by one: the rotation, along the first axis, along the second one. With
//! u = (ω, x, y), the mass matrix (c' b'; b' A) in the frame and v* = v − r:
//!
//! ```text
//! d₀ = c' + κ₀    s₀ = κ₀/d₀    t = b'/d₀    E = A − b' tᵀ    β = s₀ b'
//! d₁ = Exx + κ₁   s₁ = κ₁/d₁    m = Exy/d₁   F = Eyy − m Exy  ε = s₁ Exy    β'y = βy − m βx
//! d₂ = F + κ₂     s₂ = κ₂/d₂
//!
//! V, which the parent sees:  Vxx = s₁Exx − ε²/d₂    Vxy = s₂ ε    Vyy = s₂ F
//!                            Vωx = s₁βx − ε β'y/d₂  Vωy = s₂ β'y  Vωω = s₀c' − βx²/d₁ − β'y²/d₂
//! down:  y₀ = τ' + η₀    y₁ = gx + η₁ − tx y₀    y₂ = gy + η₂ − ty y₀ − m y₁
//!        parent:  −η + (s₀y₀ − βx y₁/d₁ − β'y y₂/d₂,  s₁y₁ − ε y₂/d₂,  s₂y₂) + V r
//! up:    y = (y₂ − ε v*x − β'y v*ω + κ₂ v*y)/d₂    x = (y₁ − Exy y − βx v*ω + κ₁ v*x)/d₁    ω = (y₀ − b'x x − b'y y + κ₀ v*ω)/d₀
//!        λ₀ = s₀(c' v*ω + b'x x + b'y y − y₀) + η₀      λ₁ = s₁(Exx v*x + Exy y + βx v*ω − y₁) + η₁
//!        λ₂ = s₂(F v*y + ε v*x + β'y v*ω − y₂) + η₂
//! ```
//!
//! No stiff κ is ever subtracted from another one, and of a free row all terms are zero.
//!
//! # Ranges
//! All in the unit of the joint, rotations of the length of the node: c', A and b' are below 2^61, κ below 2^[`STIFF`]. Shares s have
//! [`SHARE`] bits: their products are below 2^121. A node that does not turn counts as 2^60. Velocities and impulses have the ranges of points.

use super::node::Node;
use super::stiffness::{RowAim, STIFF, Stiffness};
use super::symmetric::{Reciprocal, Symmetric, dot, moved, to_impulse, turned};
use super::{IMPULSE, RATIO, SOFT, SPEED, TO_IMPULSE, UNIT};
use crate::solve::joint::Block;
use crate::solve::joint::axis::AxisRow;
use crate::solve::number::{lowered, product, shifted, shifted_word, within};

/// Fraction bits of s.
const SHARE: i32 = 60;
/// The moment of inertia of a node that does not turn.
const STILL: i64 = 1 << 60;
/// The mass of the middle of a joint along axes that are free: nothing depends on it.
const ANY: i64 = 1 << 40;
/// The largest moment of V.
const MOMENT: i128 = 1 << 52;

/// A joint between a node and its parent. Rows have the order of their numbers in a block: along both axes, and around.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameRows {
    /// log2 of the lengths of the node and of the parent over the length of the joint; not negative.
    node_length: i32,
    parent_length: i32,
    stiffness: [Stiffness; 3],
    kappa: [i64; 3],
    residual: [i64; 3],
    eta: [i64; 3],
    /// The first axis.
    axis: [i64; 2],
    /// c', b', Exx, Exy, F.
    c: i64,
    b: [i64; 2],
    e: [i64; 2],
    f: i64,
    /// 1/d and s, by row.
    pivot: [Reciprocal; 3],
    share: [i64; 3],
    t: [i64; 2],
    slant: i64,
    /// βx and β'y, and ε.
    beta: [i64; 2],
    epsilon: i64,
    /// V along the axes, its moments, and around.
    spring: Symmetric,
    moment: [i64; 2],
    turning: i64,
    /// y, by row.
    y: [i64; 3],
    /// λ, and the change of the velocity of the node against its parent; around both of the length of the joint.
    pub(super) push: [i64; 3],
    pub(super) change: [i64; 3],
}

/// The product with a share.
#[inline(always)]
fn part(share: i64, value: i64) -> i64 {
    lowered(product(share, value), SHARE) as i64
}

/// A vector in the axes of a frame, whose first axis is this.
#[inline(always)]
fn into_frame(axis: [i64; 2], vector: [i64; 2]) -> [i64; 2] {
    [lowered(dot(axis, vector), UNIT) as i64, lowered(dot(turned(axis), vector), UNIT) as i64]
}

/// A vector of a frame in the world's axes.
#[inline(always)]
fn out_of_frame([ux, uy]: [i64; 2], [x, y]: [i64; 2]) -> [i64; 2] {
    [lowered(product(ux, x) - product(uy, y), UNIT) as i64, lowered(product(uy, x) + product(ux, y), UNIT) as i64]
}

impl FrameRows {
    /// The rows of a joint between a node and its parent, or the middle of the joint.
    pub(super) fn new(block: &Block, laws: &[AxisRow], node: &Node, opposite: &Node) -> Self {
        let above = |length: i32| (length - block.axis_length).max(0);
        // The compliance of the node is of a half as well.
        let held = within(Reciprocal::new(node.compliance).times(1 << 60, SOFT - 60), 1 << STIFF).max(1);
        let stiffness = |row: usize| {
            laws.get(block.laws[row] as usize).map_or(Stiffness::default(), |law| Stiffness::new(law, node))
        };
        Self {
            node_length: if node.is_body { above(node.length) } else { 0 },
            parent_length: if node.is_half || !opposite.is_body { 0 } else { above(opposite.length) },
            stiffness: [0, 1, 2].map(stiffness),
            kappa: [0, 1, 2].map(|row| if row < 2 && block.held[row] { held } else { 0 }),
            axis: block.axes[0],
            ..Self::default()
        }
    }

    /// Sets κ, r and η for a pass. Returns true if κ has changed.
    pub(super) fn set_aims(&mut self, block: &Block, laws: &[AxisRow], node: &Node) -> bool {
        let before = self.kappa;
        for row in 0..3 {
            let Some(aim) = block.aim(row, laws) else { continue };
            let RowAim { kappa, residual, eta } = self.stiffness[row].aim(aim, block.impulses[row], node);
            (self.kappa[row], self.residual[row], self.eta[row]) = (kappa, residual, eta);
        }
        before != self.kappa
    }

    /// κ around, of the length of the node.
    fn turning_kappa(&self) -> i64 {
        shifted_word(self.kappa[2], 2 * self.node_length)
    }

    /// Eliminates the node, and finds the matrix V for its parent.
    pub(super) fn factor(&mut self, node: &Node) {
        let [along, across, _] = self.kappa;
        let around = self.turning_kappa();
        self.axis = node.axis;
        if !node.is_body {
            self.spring = Symmetric { xx: along, xy: 0, yy: across };
            (self.moment, self.turning) = ([0; 2], around);
            return;
        }
        // In the unit of the joint.
        let up = node.joint_unit - node.unit;
        let a = node.a.shifted(up);
        let moment = node.a.lowered_times(node.point, UNIT);
        let b = [node.b[0] - moment[0], node.b[1] - moment[1]];
        let c = node.c - lowered(dot(node.point, [node.b[0] + b[0], node.b[1] + b[1]]), UNIT) as i64;
        (self.b, self.c) = if node.inertia == 0 {
            ([0; 2], STILL)
        } else {
            (into_frame(self.axis, b.map(|part| shifted_word(part, up))), shifted_word(c, up).max(1))
        };
        let side = turned(self.axis);
        let (a_along, a_across) = (a.lowered_times(self.axis, UNIT), a.lowered_times(side, UNIT));
        let xx = lowered(dot(self.axis, a_along), UNIT) as i64;
        let xy = lowered(dot(self.axis, a_across) + dot(side, a_along), UNIT + 1) as i64;
        let yy = lowered(dot(side, a_across), UNIT) as i64;

        let [bx, by] = self.b;
        self.pivot[2] = Reciprocal::new(self.c + around);
        self.share[2] = self.pivot[2].times(around, SHARE) as i64;
        self.t = self.b.map(|b| within(self.pivot[2].times(b, RATIO), IMPULSE));
        let beta = self.b.map(|b| part(self.share[2], b));
        let xx = xx - lowered(product(bx, self.t[0]), RATIO) as i64;
        let xy = xy - lowered(product(bx, self.t[1]) + product(by, self.t[0]), RATIO + 1) as i64;
        let yy = yy - lowered(product(by, self.t[1]), RATIO) as i64;

        self.e = [xx.max(1), xy];
        self.pivot[0] = Reciprocal::new(self.e[0] + along);
        self.share[0] = self.pivot[0].times(along, SHARE) as i64;
        self.slant = within(self.pivot[0].times(xy, RATIO), IMPULSE);
        self.epsilon = part(self.share[0], xy);
        self.f = (yy - lowered(product(self.slant, xy), RATIO) as i64).max(1);
        self.beta = [beta[0], beta[1] - lowered(product(self.slant, beta[0]), RATIO) as i64];

        self.pivot[1] = Reciprocal::new(self.f + across);
        self.share[1] = self.pivot[1].times(across, SHARE) as i64;
        let by_epsilon = self.pivot[1].times(self.epsilon, RATIO);
        let by_moment = [self.pivot[0].times(self.beta[0], RATIO), self.pivot[1].times(self.beta[1], RATIO)];
        let [ratio, ratio_x, ratio_y] = [by_epsilon, by_moment[0], by_moment[1]].map(|ratio| within(ratio, IMPULSE));
        let less = |ratio: i64, value: i64| lowered(product(ratio, value), RATIO) as i64;
        self.spring = Symmetric {
            xx: (part(self.share[0], self.e[0]) - less(ratio, self.epsilon)).max(0),
            xy: part(self.share[1], self.epsilon),
            yy: part(self.share[1], self.f),
        };
        self.moment =
            [part(self.share[0], self.beta[0]) - less(ratio, self.beta[1]), part(self.share[1], self.beta[1])];
        let turning = part(self.share[2], self.c) - less(ratio_x, self.beta[0]) - less(ratio_y, self.beta[1]);
        self.turning = turning.max(0);
    }

    /// Adds V to the parent.
    pub(super) fn join(&self, node: &Node, parent: &mut Node) {
        let Symmetric { mut xx, xy, mut yy } = self.spring;
        if node.is_half {
            (xx, yy) = (if self.kappa[0] == 0 { ANY } else { xx }, if self.kappa[1] == 0 { ANY } else { yy });
        }
        let [ux, uy] = self.axis;
        let rotated = |x: i64, y: i64| out_of_frame(self.axis, [x, y]);
        // Both columns in the frame, with rows in the world's axes.
        let (first, second) = (rotated(xx, xy), rotated(xy, yy));
        let element = |sum: i128, bits: i32| lowered(sum, bits) as i64;
        let spring = Symmetric {
            xx: element(product(first[0], ux) - product(second[0], uy), UNIT),
            xy: element(
                product(first[0], uy) + product(second[0], ux) + product(first[1], ux) - product(second[1], uy),
                UNIT + 1,
            ),
            yy: element(product(first[1], uy) + product(second[1], ux), UNIT),
        };
        let down = parent.unit - node.joint_unit;
        let spring = spring.shifted(down);
        // From the length of the node to the length of the parent.
        let shorter = self.parent_length - self.node_length;
        let moment =
            rotated(self.moment[0], self.moment[1]).map(|part| within(shifted(part.into(), down + shorter), MOMENT));
        let turning = within(shifted(self.turning.into(), down + 2 * shorter), MOMENT);
        let arm_moment = spring.lowered_times(node.parent_point, UNIT);
        parent.a = parent.a.plus(spring);
        parent.b = [0, 1].map(|i| parent.b[i] + arm_moment[i] + moment[i]);
        let twice = lowered(2 * dot(node.parent_point, moment) + dot(node.parent_point, arm_moment), UNIT) as i64;
        parent.c += twice + turning;
    }

    /// The residuals of the rows in a pass, around of the length of the node.
    fn residuals(&self, node: &Node) -> [i64; 3] {
        let [along, across, around] = self.residual;
        let held = node.residual;
        let row = |index: usize, residual: i64| residual + held[index];
        [row(0, along), row(1, across), shifted_word(around, -self.node_length)]
    }

    /// η around, of the length of the node.
    fn turning_eta(&self) -> i64 {
        shifted_word(self.eta[2], self.node_length)
    }

    /// On the way to the centre: the impulses that are left at the joint, which go to the parent, and the torque around it, of the length of the
    /// node.
    pub(super) fn pass_down(&mut self, node: &mut Node) -> ([i64; 2], i64) {
        let eta = [self.eta[0], self.eta[1], self.turning_eta()];
        let mut left = [0; 3];
        if node.is_body {
            let up = node.unit - node.joint_unit;
            let raised = |value: i128| within(within(value, IMPULSE).into(), IMPULSE >> up) << up;
            let f = [within(node.f[0], IMPULSE), within(node.f[1], IMPULSE)];
            let around = raised(node.torque - lowered(dot(node.point, f), UNIT));
            (node.f, node.torque) = ([0; 2], 0);
            let [along, across] = into_frame(self.axis, f.map(|part| raised(part.into())));
            let sum = |value: i128| within(value, IMPULSE);
            let ratio = |ratio: i64, value: i64| lowered(product(ratio, value), RATIO);
            let y0 = sum(i128::from(around) + i128::from(eta[2]));
            let y1 = sum(i128::from(along) + i128::from(eta[0]) - ratio(self.t[0], y0));
            let y2 = sum(i128::from(across) + i128::from(eta[1]) - ratio(self.t[1], y0) - ratio(self.slant, y1));
            self.y = [y1, y2, y0];
            let x = within(self.pivot[0].times(y1, TO_IMPULSE), SPEED);
            let y = within(self.pivot[1].times(y2, TO_IMPULSE), SPEED);
            let impulse = |mass: i64, velocity: i64| i128::from(to_impulse(product(mass, velocity)));
            left = [
                sum(i128::from(part(self.share[0], y1)) - impulse(self.epsilon, y)),
                part(self.share[1], y2),
                sum(i128::from(part(self.share[2], y0)) - impulse(self.beta[0], x) - impulse(self.beta[1], y)),
            ];
        }
        let residual = self.residuals(node);
        let [along, across] = self.spring.times([residual[0], residual[1]]);
        let [mx, my] = self.moment;
        let by_spring = [
            along + product(mx, residual[2]),
            across + product(my, residual[2]),
            product(mx, residual[0]) + product(my, residual[1]) + product(self.turning, residual[2]),
        ];
        let [along, across, around] = [0, 1, 2].map(|row| {
            within(i128::from(left[row]) - i128::from(eta[row]) + i128::from(to_impulse(by_spring[row])), IMPULSE)
        });
        (out_of_frame(self.axis, [along, across]), around)
    }

    /// The torque on the parent in the unit of the parent and of its length.
    pub(super) fn on_parent(&self, torque: i64, down: i32) -> i64 {
        within(shifted(torque.into(), down + self.parent_length - self.node_length), IMPULSE)
    }

    /// On the way back: the changes of the impulses of the rows, and of the velocity of the node, for the velocity of the parent at the point of the
    /// joint and its rotation.
    pub(super) fn pass_up(&mut self, node: &mut Node, at: [i64; 2], parent_spin: i64) {
        let [vx, vy] = into_frame(self.axis, at);
        // Within 2^44 · 2^20.
        let limit = 1_i128 << 62;
        let spin = within(shifted(parent_spin.into(), self.parent_length - self.node_length), limit);
        let residual = self.residuals(node);
        let [sx, sy, sw] =
            [(vx, 0), (vy, 1), (spin, 2)].map(|(v, row)| within(i128::from(v) - i128::from(residual[row]), limit));
        let eta = self.eta.map(i128::from);
        let around = self.turning_kappa();
        let mut u = [0; 3];
        if node.is_body {
            let [ey, ex] = [self.f, self.e[0]];
            let [bx, by] = self.b;
            let y_of = |row: usize| i128::from(self.y[row]) << TO_IMPULSE;
            let sum = y_of(1) - product(self.epsilon, sx) - product(self.beta[1], sw) + product(self.kappa[1], sy);
            let y = self.pivot[1].times_double(sum, 0, SPEED);
            let sum = y_of(0) - product(self.e[1], y) - product(self.beta[0], sw) + product(self.kappa[0], sx);
            let x = self.pivot[0].times_double(sum, 0, SPEED);
            let sum = y_of(2) - product(bx, x) - product(by, y) + product(around, sw);
            let w = self.pivot[2].times_double(sum, 0, SPEED);
            u = [x, y, w];
            let along = product(ex, sx) + product(self.e[1], y) + product(self.beta[0], sw);
            let across = product(ey, sy) + product(self.epsilon, sx) + product(self.beta[1], sw);
            let turning = product(self.c, sw) + product(bx, x) + product(by, y);
            let left = [along, across, turning];
            self.push = [0, 1, 2].map(|row| {
                let left = within(lowered(left[row], TO_IMPULSE) - i128::from(self.y[row]), IMPULSE);
                let longer = if row == 2 { self.node_length } else { 0 };
                let push = shifted(product(self.share[row], left), SHARE - longer);
                within(push + eta[row], IMPULSE)
            });
            let velocity = out_of_frame(self.axis, [x, y]);
            node.spin = w;
            node.velocity = moved(velocity, -w, node.point).map(|part| within(part.into(), SPEED));
        } else {
            let by_kappa = [product(self.kappa[0], sx), product(self.kappa[1], sy), product(self.kappa[2], sw)];
            self.push = [0, 1, 2].map(|row| within(i128::from(to_impulse(by_kappa[row])) + eta[row], IMPULSE));
            (node.velocity, node.spin) = ([0; 2], 0);
        }
        self.change = [u[0] - vx, u[1] - vy, shifted_word(u[2] - spin, self.node_length)];
    }
}
