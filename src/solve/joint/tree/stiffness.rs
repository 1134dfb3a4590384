//! The stiffness of a row that has a law, between a node and its parent.

use super::node::Node;
use super::symmetric::Reciprocal;
use super::{FRACTION, IMPULSE, RESIDUAL, SOFT, UNIT};
use crate::scalar::FxFactor;
use crate::solve::joint::axis::{Aim, AxisRow, STIFFEST};
use crate::solve::number::{exponent, fixed, product, shifted, shifted_word, within, within_word};

/// The bits of κ.
pub(super) const STIFF: i32 = 47;

/// The κ of a row that holds a velocity and of its spring, and one over the former in 2^-[`SOFT`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stiffness {
    stiffest: i64,
    elastic: i64,
    compliance: i64,
}

/// The aim of a row in a pass: the impulse κ·(change − r) + η for a change of the velocity of the parent against the node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowAim {
    pub(super) kappa: i64,
    pub(super) residual: i64,
    pub(super) eta: i64,
}

impl Stiffness {
    /// The stiffness of a law in the unit of the joint of a node. A half of a joint is twice as stiff.
    pub(super) fn new(law: &AxisRow, node: &Node) -> Self {
        let is_half = i32::from(node.is_half);
        let stiffness = |factor: FxFactor, bits: i32| {
            let is_large = exponent(factor) + bits - node.joint_unit > STIFF;
            if is_large { 1 << STIFF } else { fixed(factor, bits - node.joint_unit) }
        };
        let stiffest = stiffness(law.mass, STIFFEST + is_half).max(1);
        let elastic = stiffness(law.damping, is_half).min(stiffest);
        let compliance = within(Reciprocal::new(stiffest).times(1 << 60, SOFT - 60), 1 << 62);
        Self { stiffest, elastic, compliance }
    }

    /// The κ that holds a velocity.
    pub(super) fn stiffest(&self) -> i64 {
        self.stiffest
    }

    /// The aim of the row between the node and its parent, for the aim of its law and the impulse that it has.
    #[inline(always)]
    pub(super) fn aim(&self, aim: Aim, impulse: i64, node: &Node) -> RowAim {
        let sign = if node.side == 0 { -1 } else { 1 };
        match aim {
            Aim::Velocity { velocity, gives_way } => {
                let mut sum = shifted_word(velocity, UNIT - FRACTION + i32::from(node.is_half));
                if gives_way {
                    // More than that is too much in any case.
                    sum += within(shifted(product(self.compliance, impulse), node.give_shift), 1 << 61);
                }
                RowAim { kappa: self.stiffest, residual: sign * within_word(sum, RESIDUAL), eta: 0 }
            }
            Aim::Impulse { change, is_elastic } => {
                // Most often there is none.
                let change = if change == 0 { 0 } else { within(shifted(change.into(), -node.push_shift), IMPULSE) };
                RowAim { kappa: if is_elastic { self.elastic } else { 0 }, residual: 0, eta: sign * change }
            }
        }
    }
}
