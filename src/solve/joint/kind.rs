//! Kinds of joints.

use super::length_of;
use crate::fx::Fx;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::scalar::Turn;
use crate::solve::number::{divided, lowered};

/// The quantity that a joint keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointKind {
    /// Both anchors at the same point.
    Revolute,
    /// The anchors at a distance.
    Distance {
        /// m, up to 2^20; positive.
        length: Fx,
    },
    /// The distance of the anchors, which is free but for the law of its slide.
    Line,
    /// The second anchor on a line through the first one, along an axis that turns with the first body.
    Slider {
        /// The angle of the axis at the start of the step.
        angle: Turn,
    },
    /// A sum of the angles of both bodies, each times a number of teeth: the law of the angle holds it. The anchors do not matter.
    Gear {
        /// From −1,024 to 1,024, not zero.
        teeth: [i16; 2],
    },
    /// A rope from the first anchor over two points to the second one: the law of its slide holds the sum of both distances, each times its
    /// strands over the larger number of strands.
    Pulley {
        /// m
        grounds: [Vec2; 2],
        /// From 1.
        strands: [u8; 2],
    },
    /// The second anchor is free in a frame that turns with the first body, but for the laws of its slides. The forces of their motors and of their
    /// springs are bounds of the vector of both slides.
    Planar {
        /// The angle of the frame at the start of the step.
        angle: Turn,
    },
}

impl JointKind {
    /// The angle of a frame that turns with the first body.
    pub(crate) fn frame_angle(self) -> Option<Turn> {
        match self {
            Self::Slider { angle } | Self::Planar { angle } => Some(angle),
            Self::Revolute | Self::Distance { .. } | Self::Line | Self::Gear { .. } | Self::Pulley { .. } => None,
        }
    }

    /// The teeth of gears. The angle from one body to another one is their sum of angles with these two.
    fn teeth(self) -> [i64; 2] {
        if let Self::Gear { teeth } = self { teeth.map(i64::from) } else { [-1, 1] }
    }

    /// The larger number of teeth.
    fn largest_teeth(self) -> i64 {
        let [first, second] = self.teeth().map(i64::abs);
        first.max(second).max(1)
    }

    /// The velocities of both bodies in the velocity of the angle, in 2^-30: the velocity of the wheel with more teeth, of two gears, has 1.
    pub(in crate::solve) fn angle_factors(self) -> [i64; 2] {
        if !matches!(self, Self::Gear { .. }) {
            return [-(1 << 30), 1 << 30];
        }
        self.teeth().map(|count| divided(i128::from(count) << 30, self.largest_teeth()) as i64)
    }

    /// The sum of the angles of two frames, each times its teeth: from the first frame to the second one, if the joint is no gear. Whole turns are left
    /// out.
    pub(crate) fn angle(self, frames: [Turn; 2]) -> Turn {
        let teeth = self.teeth();
        let [first, second] = [0, 1].map(|side| frames[side].to_bits().wrapping_mul(teeth[side] as u64));
        Turn::from_bits(first.wrapping_add(second))
    }

    /// The position around for a sum of angles, rad: of two gears the angle of the wheel with more teeth. *Error* ½ ulp.
    pub(crate) fn position_around(self, sum: Fx) -> Fx {
        let Self::Gear { .. } = self else { return sum };
        Fx::from_bits(divided(sum.to_bits().into(), self.largest_teeth()) as i64)
    }

    /// The torque on the second body for the torque around. *Error* ½ ulp.
    pub(crate) fn torque_on_second(self, torque: Fx) -> Fx {
        // Not larger than the torque.
        Fx::from_bits(self.impulse_on_second(torque.to_bits().into()) as i64)
    }

    /// The angular impulse on the second body for the impulse around, within ±2^111 units. *Error* ½ unit.
    pub(crate) fn impulse_on_second(self, impulse: i128) -> i128 {
        let [_, second] = self.teeth();
        divided(impulse * i128::from(second), self.largest_teeth())
    }

    /// The velocities of both points, away from the points of the rope, in the velocity of the rope, in 2^-30.
    pub(crate) fn rope_factors(self) -> [i64; 2] {
        let Self::Pulley { strands: [first, second], .. } = self else { return [1 << 30; 2] };
        let largest = first.max(second).max(1);
        [first, second].map(|count| divided(i128::from(count) << 30, largest.into()) as i64)
    }

    /// The force on the second body along its part of a rope for the force of the rope. *Error* ½ ulp, and 2^-31 of it.
    pub(crate) fn rope_force_on_second(self, force: Fx) -> Fx {
        let [_, factor] = self.rope_factors();
        // Not larger than the force.
        Fx::from_bits(lowered(i128::from(force.to_bits()) * i128::from(factor), 30) as i64)
    }

    /// The length of a rope by its factors, m, for the ways from its points to the points of both bodies, in 2^-32 m: to nearest.
    pub(crate) fn rope_length(self, ways: [[i128; 2]; 2]) -> Fx {
        // Lengths are below 2^62.5.
        let lengths = ways.map(|way| {
            let [x, y] = way.map(|part| part.clamp(-(1 << 61), 1 << 61) as i64);
            i128::from(length_of(x, y))
        });
        let [first, second] = self.rope_factors().map(i128::from);
        Fx::from_bits(lowered(first * lengths[0] + second * lengths[1], 30).min(i64::MAX.into()) as i64)
    }

    /// Returns true if the joint alone makes a loop: its rows do not meet in a point, or along an axis.
    pub(super) fn is_loop(self) -> bool {
        matches!(self, Self::Gear { .. } | Self::Pulley { .. })
    }

    /// Returns true if the impulses of both are of the same rows.
    pub(crate) fn has_rows_of(self, kind: Self) -> bool {
        let is_along = |kind| matches!(kind, Self::Distance { .. } | Self::Line);
        core::mem::discriminant(&self) == core::mem::discriminant(&kind) || is_along(self) && is_along(kind)
    }

    /// The ways along and across the axis of a frame that turns with the first body, or the length of another joint and 0, for the offset of its
    /// points in 2^-32 m: to nearest.
    pub(crate) fn ways(self, offset: [i128; 2]) -> [Fx; 2] {
        // Within 2^31 m.
        let [x, y] = offset.map(|part| part.clamp(-(1 << 62), 1 << 62));
        let Some(angle) = self.frame_angle() else { return [Fx::from_bits(length_of(x as i64, y as i64)), Fx::ZERO] };
        let (sin, cos) = sin_cos_turn(angle.to_bits());
        let [sin, cos] = [i128::from(sin), i128::from(cos)];
        // Lengths are below 2^63.
        [x * cos + y * sin, y * cos - x * sin].map(|way| Fx::from_bits(lowered(way, 62) as i64))
    }
}
