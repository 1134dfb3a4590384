//! Kinds of joints.

use super::length_of;
use crate::fx::Fx;
use crate::kernel::trig::sin_cos_turn;
use crate::scalar::Turn;
use crate::solve::number::lowered;

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
            Self::Revolute | Self::Distance { .. } | Self::Line | Self::Gear { .. } => None,
        }
    }

    /// The velocities of both bodies in the velocity of the angle, in 2^-30: the larger one, of two gears, is 1.
    pub(super) fn angle_factors(self) -> [i64; 2] {
        let Self::Gear { teeth } = self else { return [-(1 << 30), 1 << 30] };
        let [first, second] = teeth.map(i64::from);
        let most = first.abs().max(second.abs()).max(1);
        // To nearest, halves away from zero.
        [first, second].map(|count| count.signum() * (((count.abs() << 31) + most) / (2 * most)))
    }

    /// Returns true if the impulses of both are of the same rows.
    pub(crate) fn has_rows_of(self, kind: Self) -> bool {
        let is_along = |kind| matches!(kind, Self::Distance { .. } | Self::Line);
        core::mem::discriminant(&self) == core::mem::discriminant(&kind) || is_along(self) && is_along(kind)
    }
}

impl JointKind {
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
