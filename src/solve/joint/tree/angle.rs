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
use super::pin::{beyond, quotient, wide_beyond};
use super::stiffness::{RowAim, STIFF, Stiffness};
use super::symmetric::{Reciprocal, Symmetric, dot, rarely_shifted, to_impulse};
use super::{IMPULSE, PART, RATIO, SOFT, SPEED, UNIT};
use crate::solve::joint::Block;
use crate::solve::joint::axis::{Aim, AxisRow};
use crate::solve::number::{
    lowered_low, lowered_low_by, lowered_to, lowered_within, product, shifted_word, within_word,
};

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
    terms: Terms,
    /// μ, and the change of the velocity of the node against its parent.
    pub(super) push: i64,
    pub(super) change: i64,
}

/// w; κw of the length of the joint, and the terms of b and c of the parent, in the unit of the joint.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Terms {
    w: [i64; 2],
    moment: [i64; 2],
    pub(super) b: [i64; 2],
    pub(super) c: i64,
}

/// The values of a node that the [`Terms`] of its axis depend on.
pub(super) struct TermsNode {
    pub(super) t: [i64; 2],
    pub(super) spring: Symmetric,
    pub(super) compliance: i64,
    pub(super) parent_point: [i64; 2],
}

impl AngleRow {
    /// The row of the axis of a joint between a node and its parent, or the middle of the joint.
    pub(super) fn new(block: &Block, laws: &[AxisRow], node: &Node, opposite: &Node) -> Option<Self> {
        let axis = laws.get(block.laws[2] as usize)?;
        let above = |length: i32| (length - axis.length).max(0);
        let stiffness = Stiffness::new(axis, node);
        Some(Self {
            node_length: if node.is_body { above(node.length) } else { 0 },
            parent_length: if node.is_half || !opposite.is_body { 0 } else { above(opposite.length) },
            // Most often matrices need not be found anew then.
            kappa: if axis.may_hold(block.impulses[2]) { stiffness.stiffest() } else { 0 },
            stiffness,
            ..Self::default()
        })
    }

    /// The aim of the row in a pass, for the aim of its law.
    #[inline(always)]
    pub(super) fn aim(&self, aim: Aim, impulse: i64, node: &Node) -> RowAim {
        self.stiffness.aim(aim, impulse, node)
    }

    /// Sets κ and η for a pass. Returns true if κ has changed.
    #[inline(always)]
    pub(super) fn set_aim(&mut self, aim: &RowAim) -> bool {
        let before = self.kappa;
        (self.kappa, self.eta) = (aim.kappa, aim.eta - to_impulse(product(aim.kappa, aim.residual)));
        if self.is_free() {
            self.terms.moment = [0; 2];
        }
        before != self.kappa
    }

    /// Returns true if both ends turn freely, but for a torque that is given.
    #[inline(always)]
    pub(super) fn is_free(&self) -> bool {
        self.kappa == 0
    }

    /// [`pass_down`](Self::pass_down) of a row that is free.
    #[inline(always)]
    pub(super) fn torque_on_parent(&self) -> i64 {
        within_word(-self.eta, IMPULSE)
    }

    /// κ of the length of the node, in the unit of the node.
    #[inline(always)]
    pub(super) fn on_node(&self, up: i32) -> i64 {
        shifted_word(self.kappa, up + 2 * self.node_length)
    }

    /// The terms for the parent, once t and the spring of the point are known. `c` and `turn` are c' and 1/c''.
    ///
    /// The point is below 2^30, moments and so b are at most 2^52, γ 2^54: twice the moment of b is below 2^55, γκt below 2^57, and κ of the length
    /// of the parent below 2^48.
    pub(super) fn set_terms(&mut self, node: &TermsNode, c: i64, turn: Reciprocal) {
        let &TermsNode { t, compliance, parent_point, .. } = node;
        let kept = if turn.is_zero() { 1 << RATIO } else { turn.times_within(c, RATIO, 1 << RATIO) };
        let [x, y] = node.spring.given_way(compliance).times(t);
        // More than 2^61 is too much in any case: t is at most 2^60.
        let w = [t[0] - lowered_within(x, PART, 1 << 61), t[1] - lowered_within(y, PART, 1 << 61)];
        let w = w.map(|w| within_word(w, IMPULSE));
        let moment = w.map(|w| lowered_to(product(self.kappa, w), RATIO + self.node_length, MOMENT));
        let b = moment.map(|moment| shifted_word(moment, self.parent_length));
        let twice = lowered_low(2 * dot(parent_point, b), UNIT);
        // γκ t·w in 2^-RATIO, at most 1.
        let gives = t.map(|t| {
            let moment = lowered_to(product(self.kappa, t), RATIO + 2 * self.node_length, MOMENT);
            lowered_low(product(compliance, moment), SOFT - RATIO)
        });
        let kept = within_word(kept - lowered_within(dot(gives, w), RATIO, 1 << 61), 1 << RATIO);
        let turned = lowered_to(product(self.kappa, kept), RATIO + 2 * self.parent_length, 1 << 62);
        self.terms = Terms { w, moment, b, c: within_word(twice + turned, 1 << (STIFF + 2)) };
    }

    /// [`set_terms`](Self::set_terms) of a [pin](super::pin), for which t is below 2^49. Returns zero if all values are of the usual sizes.
    ///
    /// With w below 2^50, κw and κt are below 2^97 and, lowered, fit in a word, so that it tells whether they are below 2^52.
    #[inline(always)]
    pub(super) fn set_pin_terms(&mut self, node: &TermsNode, c: i64, turn: Reciprocal) -> i64 {
        let &TermsNode { t: [tx, ty], compliance, parent_point, .. } = node;
        let (node_length, parent_length) = (self.node_length & 7, self.parent_length & 7);
        let (kept, mut rest) = quotient(turn, c, RATIO, 0);
        rest |= c >> 63 | i64::from((self.node_length ^ node_length) | (self.parent_length ^ parent_length));
        let [x, y] = node.spring.given_way(compliance).times([tx, ty]);
        let (wx, wy) = (tx.wrapping_sub(lowered_low(x, PART)), ty.wrapping_sub(lowered_low(y, PART)));
        rest |= wide_beyond(x, 58 + PART) | wide_beyond(y, 58 + PART) | beyond(wx, 50) | beyond(wy, 50);
        let bits = RATIO + node_length;
        let (mx, my) = (lowered_low_by(product(self.kappa, wx), bits), lowered_low_by(product(self.kappa, wy), bits));
        let bits = bits + node_length;
        let (by_x, by_y) =
            (lowered_low_by(product(self.kappa, tx), bits), lowered_low_by(product(self.kappa, ty), bits));
        rest |= beyond(mx, 52) | beyond(my, 52) | beyond(by_x, 52) | beyond(by_y, 52);
        let b = [rarely_shifted(mx, parent_length), rarely_shifted(my, parent_length)];
        let twice = lowered_low(2 * dot(parent_point, b), UNIT);
        let gives = [
            lowered_low(product(compliance, by_x), SOFT - RATIO),
            lowered_low(product(compliance, by_y), SOFT - RATIO),
        ];
        let share = dot(gives, [wx, wy]);
        rest |= wide_beyond(share, 60 + RATIO);
        let kept = within_word(kept.wrapping_sub(lowered_low(share, RATIO)), 1 << RATIO);
        let turned = lowered_low_by(product(self.kappa, kept), RATIO + 2 * parent_length);
        let c = within_word(twice.wrapping_add(turned), 1 << (STIFF + 2));
        self.terms = Terms { w: [wx, wy], moment: [mx, my], b, c };
        rest
    }

    /// The terms for the parent.
    #[inline(always)]
    pub(super) fn terms(&self) -> &Terms {
        &self.terms
    }

    /// η as an impulse on the node.
    #[inline(always)]
    pub(super) fn impulse_on_node(&self, up: i32) -> i64 {
        shifted_word(self.eta, up + self.node_length)
    }

    /// The torque on the parent, of the length and unit of the joint: for the velocity τ'/c'' of the node, with η in it, and r − γg. η·c'/c'' is
    /// η less the part of it that turns the node.
    #[inline(always)]
    pub(super) fn pass_down(&self, spin: i64, residual: [i64; 2]) -> i64 {
        // Spins are at most 2^44: more than 2^61 is too much in any case.
        let velocity = within_word(spin + lowered_within(dot(self.terms.w, residual), RATIO, 1 << 61), SPEED);
        let velocity = shifted_word(velocity, self.node_length);
        // η is at most 2^61.
        within_word(to_impulse(product(self.kappa, velocity)) - self.eta, IMPULSE)
    }

    /// The torque on the parent in the unit of the parent and of its length.
    #[inline(always)]
    pub(super) fn on_parent(&self, torque: i64, down: i32) -> i64 {
        shifted_word(torque, down + self.parent_length)
    }

    /// The velocity of the parent at the length of the joint.
    #[inline(always)]
    pub(super) fn parent_spin(&self, spin: i64) -> i64 {
        shifted_word(spin, self.parent_length)
    }

    /// The impulse at the point of the joint by a velocity of the parent.
    #[inline(always)]
    pub(super) fn push_of_point(&self, parent_spin: i64) -> [i64; 2] {
        let [x, y] = self.terms.moment;
        [to_impulse(product(x, parent_spin)), to_impulse(product(y, parent_spin))]
    }

    /// The impulse of rotation on the node by a velocity of the parent.
    #[inline(always)]
    pub(super) fn torque_on_node(&self, parent_spin: i64, up: i32) -> i64 {
        shifted_word(to_impulse(product(self.kappa, parent_spin)), up + self.node_length)
    }

    /// Ends a pass: for the velocities of the parent and of the node, which are at most 2^44.
    #[inline(always)]
    pub(super) fn finish(&mut self, parent_spin: i64, spin: i64) {
        let spin = shifted_word(spin, self.node_length);
        self.change = spin - parent_spin;
        let push = to_impulse(product(self.kappa, within_word(-self.change, SPEED)));
        self.push = within_word(self.eta + push, IMPULSE);
    }
}
