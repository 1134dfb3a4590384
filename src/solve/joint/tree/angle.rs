//! The axis of a joint in a tree: a row between the rotations of a node and its parent.
//!
//! The torque μ of the row on the node follows from the change of the relative velocity, μ = η + κ(ω_parent − ω), where ω are changes too. A rigid
//! row, a spring and a torque that is given differ in κ and η alone. With w for the motion of the point of the joint by a torque at the parent:
//!
//! ```text
//! c'' = c' + κ      t = b'/c''      w = t − γSt
//! parent:  b += κw    c += 2κ q·w + κ(c'/c'' − γκ t·w)
//! down:    τ' += η    torque on the parent: κ(τ'/c'' + w·(r − γg)) − η·c'/c''
//! up:      Δλ += κ w ω_parent    Δω = (τ' + κ ω_parent)/c'' − t·Δp
//! ```
//!
//! beside the terms of the point. κ and μ are of the length of the joint, the shorter one of the bodies' lengths; all others of the length
//! of their body.
//!
//! # Ranges
//! κ is below 2^[`STIFF`]; κt and κw are below twice the moment b', whatever the lengths; velocities and impulses have the ranges of points.

use super::node::Node;
use super::stiffness::{RowAim, STIFF, Stiffness};
use super::symmetric::{Reciprocal, dot, to_impulse};
use super::{IMPULSE, PART, RATIO, SOFT, SPEED, UNIT};
use crate::solve::joint::Block;
use crate::solve::joint::axis::{Aim, AxisRow};
use crate::solve::number::{lowered, product, shifted_word, within};

/// The largest product of κ and t.
const MOMENT: i128 = 1 << 52;

/// The axis between a node and its parent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AngleRow {
    /// log2 of the lengths of the node and of the parent over the length of the joint; not negative.
    node_length: i32,
    parent_length: i32,
    stiffness: Stiffness,
    kappa: i64,
    eta: i64,
    /// c'/c'' in 2^-[`RATIO`], w, and κw of the length of the joint.
    kept: i64,
    w: [i64; 2],
    moment: [i64; 2],
    /// μ, and the change of the velocity of the node against its parent.
    pub(super) push: i64,
    pub(super) change: i64,
}

impl AngleRow {
    /// The row of the axis of a joint between a node and its parent, or the middle of the joint.
    pub(super) fn new(block: &Block, laws: &[AxisRow], node: &Node, opposite: &Node) -> Option<Self> {
        let axis = laws.get(block.laws[2] as usize)?;
        let above = |length: i32| (length - axis.length).max(0);
        Some(Self {
            node_length: if node.is_body { above(node.length) } else { 0 },
            parent_length: if node.is_half || !opposite.is_body { 0 } else { above(opposite.length) },
            stiffness: Stiffness::new(axis, node),
            ..Self::default()
        })
    }

    /// Sets κ and η for a pass. Returns true if κ has changed.
    pub(super) fn set_aim(&mut self, aim: Aim, impulse: i64, node: &Node) -> bool {
        let before = self.kappa;
        let RowAim { kappa, residual, eta } = self.stiffness.aim(aim, impulse, node);
        (self.kappa, self.eta) = (kappa, eta - to_impulse(product(kappa, residual)));
        if self.is_free() {
            self.moment = [0; 2];
        }
        before != kappa
    }

    /// Returns true if both ends turn freely, but for a torque that is given.
    pub(super) fn is_free(&self) -> bool {
        self.kappa == 0
    }

    /// [`pass_down`](Self::pass_down) of a row that is free.
    pub(super) fn torque_on_parent(&self) -> i64 {
        within(-i128::from(self.eta), IMPULSE)
    }

    /// κ of the length of the node, in the unit of the node.
    pub(super) fn on_node(&self, up: i32) -> i64 {
        shifted_word(self.kappa, up + 2 * self.node_length)
    }

    /// Sets the ratios for the parent, once t and the spring of the point are known. `c` and `turn` are c' and 1/c''.
    pub(super) fn factor(&mut self, c: i64, turn: Reciprocal, node: &Node) {
        self.kept = if turn.is_zero() { 1 << RATIO } else { within(turn.times(c, RATIO), 1 << RATIO) };
        let given_way = node.spring.given_way(node.compliance).times(node.t);
        self.w = [0, 1].map(|i| within(i128::from(node.t[i]) - lowered(given_way[i], PART), IMPULSE));
        self.moment = self.w.map(|w| within(lowered(product(self.kappa, w), RATIO + self.node_length), MOMENT));
    }

    /// The terms of b and c of the parent, in the unit of the joint.
    pub(super) fn terms(&self, node: &Node) -> ([i64; 2], i64) {
        let b = self.moment.map(|moment| shifted_word(moment, self.parent_length));
        let twice = lowered(2 * dot(node.parent_point, b), UNIT);
        // γκ t·w in 2^-RATIO, at most 1.
        let gives = node.t.map(|t| {
            let moment = within(lowered(product(self.kappa, t), RATIO + 2 * self.node_length), MOMENT);
            lowered(product(node.compliance, moment), SOFT - RATIO) as i64
        });
        let kept = within(i128::from(self.kept) - lowered(dot(gives, self.w), RATIO), 1 << RATIO);
        let turned = lowered(product(self.kappa, kept), RATIO + 2 * self.parent_length);
        (b, within(twice + turned, 1 << (STIFF + 2)))
    }

    /// η as an impulse on the node.
    pub(super) fn impulse_on_node(&self, up: i32) -> i64 {
        shifted_word(self.eta, up + self.node_length)
    }

    /// The torque on the parent, of the length and unit of the joint: for the velocity τ'/c'' of the node, with η in it, and r − γg. η·c'/c'' is
    /// η less the part of it that turns the node.
    pub(super) fn pass_down(&self, spin: i64, given: [i64; 2]) -> i64 {
        let velocity = i128::from(spin) + lowered(dot(self.w, given), RATIO);
        let velocity = shifted_word(within(velocity, SPEED), self.node_length);
        within(i128::from(to_impulse(product(self.kappa, velocity))) - i128::from(self.eta), IMPULSE)
    }

    /// The torque on the parent in the unit of the parent and of its length.
    pub(super) fn on_parent(&self, torque: i64, down: i32) -> i64 {
        shifted_word(torque, down + self.parent_length)
    }

    /// The velocity of the parent at the length of the joint.
    pub(super) fn parent_spin(&self, spin: i64) -> i64 {
        shifted_word(spin, self.parent_length)
    }

    /// The impulse at the point of the joint by a velocity of the parent.
    pub(super) fn push_of_point(&self, parent_spin: i64) -> [i64; 2] {
        self.moment.map(|moment| to_impulse(product(moment, parent_spin)))
    }

    /// The impulse of rotation on the node by a velocity of the parent.
    pub(super) fn torque_on_node(&self, parent_spin: i64, up: i32) -> i64 {
        shifted_word(to_impulse(product(self.kappa, parent_spin)), up + self.node_length)
    }

    /// Ends a pass: for the velocities of the parent and of the node.
    pub(super) fn finish(&mut self, parent_spin: i64, spin: i64) {
        let spin = shifted_word(spin, self.node_length);
        self.change = spin - parent_spin;
        let push = to_impulse(product(self.kappa, within(-i128::from(self.change), SPEED)));
        self.push = within(i128::from(self.eta) + i128::from(push), IMPULSE);
    }
}
