//! Nodes at the start of a step: masses, units, and what follows from the masses at both ends of a joint.
//!
//! Reads: places, flights, blocks, laws. Writes: nodes, frames.

use alloc::vec::Vec;

use super::angle::AngleRow;
use super::frame::FrameRows;
use super::node::Node;
use super::symmetric::Reciprocal;
use super::{COARSER, FRACTION, INERTIA, LOCKED, MASS, SOFT, UNIT};
use crate::math::Vec2;
use crate::scalar::FxFactor;
use crate::slots::NONE;
use crate::solve::Flight;
use crate::solve::bodies::{BodyRows, STILL};
use crate::solve::joint::axis::AxisRow;
use crate::solve::joint::forest::Place;
use crate::solve::joint::{Block, Frame};
use crate::solve::number::{bits_of, exponent, fixed, shifted, within};

impl Node {
    /// Makes a node of a default one, in the unit of its own mass. Other nodes than bodies have no mass.
    pub(super) fn set(&mut self, place: &Place, flights: &[Flight], bodies: &BodyRows) {
        (self.parent, self.block, self.side, self.frame) = (place.parent, place.block, place.side, NONE);
        self.is_body = place.body != NONE;
        self.row = STILL;
        if !self.is_body {
            return;
        }
        let Flight { inverse_mass: Vec2 { x, y }, inverse_inertia, mass, .. } = flights[place.body as usize];
        self.row = bodies.row_of[place.body as usize];
        self.length = bodies.bodies[place.body as usize].length;
        // An axis that is locked has the mass of the other one.
        let free = if x.is_zero() { y } else { x };
        let mass_x = if free.is_zero() { FxFactor::from_scalar(mass) } else { FxFactor::ONE.over(free) };
        let mass_y = if y == x || y.is_zero() { mass_x } else { FxFactor::ONE.over(y) };
        self.unit = exponent(mass_x).max(exponent(mass_y)) - MASS + bits_of(place.children.into());
        let masses = [mass_x, mass_y].map(|mass| fixed(mass, -self.unit).max(1));
        self.linear = Reciprocal::new(masses[0].min(masses[1])).times(1 << 60, SOFT - 60);
        self.mass = [(0, x), (1, y)].map(|(axis, inverse)| masses[axis] << if inverse.is_zero() { LOCKED } else { 0 });
        if !inverse_inertia.is_zero() {
            let inertia = FxFactor::ONE.over(inverse_inertia);
            let up = -self.unit - 2 * self.length;
            let [smallest, largest] = INERTIA;
            let is_large = exponent(inertia) + up > bits_of(largest);
            self.inertia = if is_large { largest } else { fixed(inertia, up).clamp(smallest, largest) };
        }
        self.turn = Reciprocal::new(self.inertia);
    }

    /// Half the sum of the inverse mass of the node at a point along x and along y, in 2^-[`SOFT`]: 1/m + q²/2c; below 2^91.
    fn mobility(&self, arm: [i32; 2]) -> i128 {
        if self.inertia == 0 {
            return self.linear;
        }
        let [x, y] = arm.map(i64::from);
        // Below 2^61.
        let square = x * x + y * y;
        self.linear + self.turn.times(square, SOFT - 2 * UNIT - 1)
    }

    /// Sets the values that follow from the masses at the joint to the parent: the compliance, 2^-`bits` of the inverse mass of the node and of the
    /// body at the other end, and units.
    pub(super) fn set_joint(
        &mut self,
        opposite: &Self,
        block: &Block,
        laws: &[AxisRow],
        bits: i32,
        frames: &mut Vec<FrameRows>,
    ) {
        self.joint_unit = if self.is_body { self.unit.min(opposite.unit) } else { opposite.unit };
        let mut inverse =
            shifted(opposite.mobility(block.sides[1 - self.side].unit_arm), opposite.unit - self.joint_unit);
        if self.is_body {
            inverse += shifted(self.mobility(block.sides[self.side].unit_arm), self.unit - self.joint_unit);
        }
        let bits = if self.is_half { bits + 1 } else { bits };
        self.compliance = within(shifted(inverse, bits), 1 << (SOFT - MASS)).max(1);
        self.is_rod = block.is_rod();
        self.give_shift = SOFT + self.joint_unit - block.mass_exponent - FRACTION;
        self.push_shift = block.mass_exponent - self.joint_unit - COARSER;
        let room = 64 - self.give_shift;
        let is_small = (0..62).contains(&room) && self.compliance >> (62 - room) == 0;
        self.raised_compliance = if is_small { self.compliance << room } else { 0 };
        if !block.is_rod() && !matches!(block.frame, Frame::World) {
            self.frame = frames.len() as u32;
            frames.push(FrameRows::new(block, laws, self, opposite));
        } else {
            self.angle = AngleRow::new(block, laws, self, opposite);
            self.stiffness = self.angle.as_ref().map_or(0, |angle| angle.on_node(self.unit - self.joint_unit));
        }
        let is_point = block.held == [true; 2] && self.frame == NONE;
        self.holds_point = is_point && self.is_body && self.inertia != 0;
    }
}
