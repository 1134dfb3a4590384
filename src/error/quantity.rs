//! The kinds of values that calls check, with their ranges.

use core::fmt;

use crate::codes::codes;
use crate::fx::Fx;

/// Kind of a value that was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Quantity {
    /// A position or a point.
    Position,
    /// An angle.
    Angle,
    /// A velocity, or the velocity that a call would lead to.
    Velocity,
    /// An angular velocity, or the one that a call would lead to.
    AngularVelocity,
    /// A mass.
    Mass {
        /// The mass, kg: of colliders, and in a world of floats, the nearest `Fx`.
        value: Fx,
    },
    /// A moment of inertia.
    Inertia {
        /// The moment of inertia, kg·m²: in a world of floats the nearest `Fx`.
        value: Fx,
    },
    /// The density of a part of a compound.
    Density {
        /// The density, kg/m²: of a shape of floats the nearest `Fx`.
        value: Fx,
    },
    /// A size or a coordinate of a shape.
    Size {
        /// Which of the shape's sizes.
        dimension: Dimension,
        /// The size, m: of a shape of floats the nearest `Fx`.
        value: Fx,
    },
    /// The number of corners, points or parts of a shape.
    Count,
    /// A force.
    Force,
    /// A torque.
    Torque,
    /// An impulse.
    Impulse,
    /// A gravity.
    Gravity,
    /// A gravity scale.
    GravityScale,
    /// A [damping](crate::Damping): the share of a velocity that is left after a second, 0 to 1.
    Damping,
    /// A gravitational parameter.
    Mu,
    /// A softening length.
    Softening,
    /// The stiffness of a spring.
    Stiffness,
    /// A coefficient of drag or of a damper.
    Drag,
    /// The rest length of a spring.
    RestLength,
    /// A deceleration by [friction](crate::FieldKind::Friction).
    Deceleration,
    /// The number of ticks after which bodies fall asleep.
    SleepAfter,
    /// A total of energy or momentum.
    Total,
    /// The number of bytes of a game's own data.
    Blob,
    /// The largest speed of a body.
    MaxSpeed,
    /// The largest angular speed of a body.
    MaxAngularSpeed,
    /// The position of a collider on its body.
    ColliderPosition,
    /// The density of a collider or of a fluid.
    ColliderDensity {
        /// The density, kg/m²: in a world of floats the nearest `Fx`.
        value: Fx,
    },
    /// A coefficient of friction.
    Friction,
    /// A coefficient of restitution.
    Restitution,
    /// The number of sub-steps of a step.
    Substeps,
    /// A speed of [`ContactSettings`](crate::ContactSettings): push, restitution, sleep or hit speed.
    ContactSpeed,
    /// The number of pairs of colliders.
    Pairs,
    /// The speed of the surface of a collider.
    SurfaceSpeed,
    /// The direction of a one-way collider.
    OneWayDirection,
    /// The tolerance of a one-way collider.
    OneWayTolerance,
    /// A coefficient of rolling resistance.
    RollingResistance,
    /// The number of a material.
    MaterialId,
    /// The translation, the rotation or the distance of a query, or a side of a box.
    Query,
    /// The skin of a character.
    CharacterSkin,
    /// The direction that is up for a character.
    CharacterUp,
    /// The angle of a slope that a character climbs or stands on.
    CharacterSlope,
    /// The height or the width of steps, or the distance of snapping to the ground, of a character.
    CharacterStep,
    /// The translation of a character.
    CharacterTranslation,
    /// The radius or the falloff of an explosion.
    ExplosionRadius,
    /// The impulse of an explosion on a metre of width.
    ExplosionImpulse,
    /// The corners of the box of a fluid.
    FluidBox,
    /// The point of a body that a joint is at.
    JointPoint,
    /// The distance that a joint keeps.
    JointLength,
    /// The force at which a joint breaks.
    BreakForce,
    /// An angle of the limits or of the spring of a joint.
    JointAngle,
    /// The limits of a joint in the wrong order.
    JointLimits,
    /// The largest force of a motor or of a spring, or the friction, of a joint.
    JointForce,
    /// The speed of the motor of a joint.
    MotorSpeed,
    /// The frequency of the spring of a joint.
    SpringFrequency,
    /// The damping ratio of the spring of a joint.
    DampingRatio,
    /// The teeth of a gear or a ratchet.
    Teeth,
    /// The strands of the rope of a pulley.
    Strands,
}

/// A size of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Dimension {
    /// The radius of a disc.
    Radius,
    /// The radius around the core of a capsule or of a rounded polygon.
    Rounding,
    /// The width of a rectangle.
    Width,
    /// The height of a rectangle.
    Height,
    /// The distance between the ends of a segment, or between the centres of a capsule's ends.
    Length,
    /// The longer side of the box around a polygon.
    Extent,
    /// The distance from a point of a chain, by its number, to the next one.
    Edge(usize),
    /// A coordinate of a corner, a point, an end or a part, by its number.
    Coordinate(usize),
}

impl Dimension {
    /// Name and range of the size, with an article, for messages.
    const fn range(self) -> &'static str {
        match self {
            Self::Radius | Self::Rounding => "a radius from 2^-7 (0.0078125) to 2^12 m",
            Self::Width => "a width from 2^-7 (0.0078125) to 2^12 m",
            Self::Height => "a height from 2^-7 (0.0078125) to 2^12 m",
            Self::Length => "a length from 2^-7 (0.0078125) to 2^12 m",
            Self::Extent => "a width or a height of 2^-7 (0.0078125) m or more",
            Self::Edge(_) => "an edge of a chain from 2^-7 (0.0078125) m",
            Self::Coordinate(_) => "a coordinate within ±2^12 m",
        }
    }
}

impl Quantity {
    /// Name and range of the quantity, with an article, for messages.
    const fn range(self) -> &'static str {
        match self {
            Self::Position => "a position within ±2^30 m",
            Self::Angle => "an angle that is a number",
            Self::Velocity => "a velocity within ±2^20 m/s a component",
            Self::AngularVelocity => "an angular velocity within ±2^20 rad/s",
            Self::Mass { .. } => "a mass from 2^-16 to 2^24 kg",
            Self::Inertia { .. } => "a moment of inertia above zero",
            Self::Density { .. } => "a density above zero",
            Self::Size { dimension, .. } => dimension.range(),
            Self::Count => {
                "3 to 64 corners, also of a hull, up to 1,024 of a concave polygon, 2 to 65,536 points of a chain (at least 3 if it is closed), or 1 to 256 parts, none of them a compound or a chain"
            }
            Self::Force => "a force within ±2^31 N a component",
            Self::Torque => "a torque within ±2^63 N·m",
            Self::Impulse => "an impulse within ±2^31 N·s a component",
            Self::Gravity => "gravity within ±2^16 m/s² a component",
            Self::GravityScale => "a gravity scale within ±16",
            Self::Damping => "damping that keeps from 0 to 1 of a velocity a second, so a rate of at least 0",
            Self::Mu => "a gravitational parameter from 0 to 2^64 m³/s²",
            Self::Softening => "a softening length from 0 to 2^12 m",
            Self::Stiffness => "a stiffness of at least zero",
            Self::Drag => "a coefficient of at least zero",
            Self::RestLength => "a rest length from 0 to 2^30 m",
            Self::Deceleration => "a deceleration from 0 to 2^16 m/s² or rad/s²",
            Self::SleepAfter => "a number of ticks from 1",
            Self::Total => "a total that fits in 64 bits before and after the point",
            Self::Blob => "a blob of at most 2^24 bytes",
            Self::MaxSpeed => "a largest speed from 0 to 2^20 m/s",
            Self::MaxAngularSpeed => "a largest angular speed from 0 to 2^20 rad/s",
            Self::ColliderPosition => "a position of a collider within ±2^12 m of its body's centre of mass",
            Self::ColliderDensity { .. } => "a density of at least zero",
            Self::Friction => "a coefficient of friction from 0 to 32",
            Self::Restitution => "a coefficient of restitution from 0 to 1",
            Self::Substeps => "a number of sub-steps from 1 to 16",
            Self::ContactSpeed => "a push, restitution, sleep or hit speed from 0 to 2^10 m/s",
            Self::Pairs => "a number of pairs from 1 to 2^28 in all, and to 2^12 of one collider",
            Self::SurfaceSpeed => "a surface speed within ±2^10 m/s",
            Self::OneWayDirection => "a direction within ±2^10 a component, the longer one at least 2^-10",
            Self::OneWayTolerance => "a tolerance from 0 to π/2 rad",
            Self::RollingResistance => "a coefficient of rolling resistance from 0 to 1",
            Self::MaterialId => "a number of a material from 1: 0 is no material",
            Self::Query => {
                "a translation of a query within ±2^20 m a component, a rotation within ±2^17 rad, or a distance or a side of a box from 0 to 2^20 m (min not beyond max)"
            }
            Self::CharacterSkin => "a skin of a character from 2^-12 to 1 m",
            Self::CharacterUp => "an up direction within ±2^10 a component, the longer one at least 2^-10",
            Self::CharacterSlope => "an angle of a slope from 0 to π/2 rad",
            Self::CharacterStep => "a height, a width or a distance of a character's steps from 0 to 2^4 m",
            Self::CharacterTranslation => "a translation of a character within ±2^8 m a component",
            Self::ExplosionRadius => "a radius or a falloff of an explosion from 0 to 2^12 m",
            Self::ExplosionImpulse => "an impulse of an explosion within ±2^16 N·s/m",
            Self::FluidBox => "a box of a fluid within ±2^30 m whose least corner is not beyond the greatest one",
            Self::JointPoint => "a point of a joint within ±2^12 m of its body's centre of mass, a component",
            Self::JointLength => "a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m",
            Self::BreakForce => "a force or a torque of at least zero at which a joint breaks",
            Self::JointAngle => "an angle of a joint within ±2^17 rad",
            Self::Teeth => "whole numbers of teeth from 1 to 1,024 or negative",
            Self::Strands => "whole numbers of strands from 1 to 64",
            Self::JointLimits => "limits of a joint of which the upper one is not below the lower one",
            Self::JointForce => "a force or torque in a joint of at least zero",
            Self::MotorSpeed => "a speed of a joint's motor within ±2^20 rad/s or m/s",
            Self::SpringFrequency => "a frequency of a joint's spring from 0 to 10^6 Hz",
            Self::DampingRatio => "a damping ratio of a joint's spring from 0 to 1024",
        }
    }
}

codes!(Quantity {
    Position = 151,
    Angle = 152,
    Velocity = 153,
    AngularVelocity = 154,
    Mass = 155,
    Inertia = 156,
    Density = 157,
    Size = 158,
    Count = 159,
    Force = 160,
    Torque = 161,
    Impulse = 162,
    Gravity = 163,
    GravityScale = 164,
    Damping = 165,
    Mu = 166,
    Softening = 167,
    Stiffness = 168,
    Drag = 169,
    RestLength = 170,
    SleepAfter = 171,
    Total = 172,
    Blob = 173,
    MaxSpeed = 174,
    MaxAngularSpeed = 175,
    ColliderPosition = 176,
    ColliderDensity = 177,
    Friction = 178,
    Restitution = 179,
    Substeps = 181,
    ContactSpeed = 182,
    Pairs = 183,
    SurfaceSpeed = 184,
    OneWayDirection = 185,
    OneWayTolerance = 186,
    RollingResistance = 187,
    MaterialId = 188,
    Query = 189,
    CharacterSkin = 190,
    CharacterUp = 191,
    CharacterSlope = 192,
    CharacterStep = 193,
    CharacterTranslation = 194,
    ExplosionRadius = 195,
    ExplosionImpulse = 196,
    FluidBox = 197,
    JointPoint = 198,
    JointLength = 199,
    BreakForce = 200,
    JointAngle = 208,
    JointLimits = 209,
    JointForce = 210,
    MotorSpeed = 211,
    SpringFrequency = 212,
    DampingRatio = 213,
    Teeth = 215,
    Strands = 216,
    Deceleration = 217,
});

impl core::error::Error for Quantity {}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.range())?;
        match self {
            Self::Size { dimension: Dimension::Edge(number), value } => write!(f, ", not {value} (edge {number})"),
            Self::Size { dimension: Dimension::Coordinate(number), value } => {
                write!(f, ", not {value} (point {number})")
            }
            Self::Size { value, .. }
            | Self::Mass { value }
            | Self::Inertia { value }
            | Self::Density { value }
            | Self::ColliderDensity { value } => write!(f, ", not {value}"),
            _ => Ok(()),
        }
    }
}
