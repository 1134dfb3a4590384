//! Boxes over a step, the distance that two bodies close in it, and mixed materials.

use crate::collide::{ManifoldPoint, Margin, Pose};
use crate::collider::{BodyOutline, MixRule};
use crate::contact::numerics::MARGIN;
use crate::fx::Fx;
use crate::kernel::wide::mul_shift;
use crate::limits;
use crate::math::Vec2;
use crate::shape::Aabb;
use crate::solve::Flight;

/// The distance that a point of an outline moves by the rotation of its body, in ulps, rounded up: at most twice its radius.
fn turned(flight: &Flight, radius: Fx) -> i64 {
    let radius = u128::from(radius.to_bits().unsigned_abs());
    let product = u128::from(flight.rotation.to_bits().unsigned_abs()) * radius;
    // Radii are below 2^15 m.
    ((product >> 32) + u128::from(product != 0)).min(2 * radius) as i64
}

/// The largest distance of two outlines that may touch in the step: the margin and what they close. Displacements are below 2^29 m.
#[inline]
pub(super) fn closing([a, b]: [&Flight; 2], radii: [Fx; 2]) -> Margin {
    let way = |a: Fx, b: Fx| b.to_bits() - a.to_bits();
    let (x, y) = (way(a.displacement.x, b.displacement.x), way(a.displacement.y, b.displacement.y));
    // The ways are rounded up: that of the displacements by the ulp.
    Margin::new(Fx::from_bits(MARGIN.to_bits() + 1 + turned(a, radii[0]) + turned(b, radii[1])), [x, y])
}

/// A bound of what two outlines approach in the step, in ulps.
pub(super) fn approach([a, b]: [&Flight; 2], radii: [Fx; 2]) -> i64 {
    let way = |a: Fx, b: Fx| (b.to_bits() - a.to_bits()).abs();
    let (x, y) = (way(a.displacement.x, b.displacement.x), way(a.displacement.y, b.displacement.y));
    x.max(y) + x.min(y) / 2 + turned(a, radii[0]) + turned(b, radii[1])
}

/// By how much a point of a manifold closes up to a moment, in units of 2^-62 of the step, by rows that do not turn; in ulps, rounded to nearest.
pub(super) fn closed(normal: [i32; 2], point: &ManifoldPoint, [a, b]: [&Flight; 2], at: u64) -> i64 {
    let part = |value: Fx| mul_shift(value.to_bits().into(), u128::from(at), 62).unwrap_or(0);
    let [nx, ny] = normal.map(i128::from);
    let turn = |flight: &Flight, arm: Vec2| {
        // n · (φ × r), in 2^-62.
        let across = nx * -i128::from(arm.y.to_bits()) + ny * i128::from(arm.x.to_bits());
        across / (1 << 16) * part(flight.rotation)
    };
    let way = |flight: &Flight| nx * part(flight.displacement.x) + ny * part(flight.displacement.y);
    let linear = way(a) - way(b);
    let turned = turn(a, point.arm_a) - turn(b, point.arm_b);
    // From 2^-62 to 2^-32, and from 2^(-62 - 32 + 16).
    ((linear + (turned >> 16)) >> 30) as i64
}

/// The largest distance that a point of an outline moves in the step, in ulps: for two together at least what they
/// [close](closing).
pub(super) fn way(flight: &Flight, radius: Fx) -> i64 {
    let [x, y] = [flight.displacement.x, flight.displacement.y].map(|way| way.to_bits().abs());
    // a + b/2 is at least the length of (a, b) for a ≥ b, and at most an eighth more.
    x.max(y) + x.min(y) / 2 + 1 + turned(flight, radius)
}

/// The box around an outline at a pose, grown on all sides by a distance in ulps and by half the margin: the boxes of two outlines overlap
/// that are within the margin and their distances of each other.
pub(super) fn grown(of: &BodyOutline<Fx>, pose: &Pose, by: i64) -> Aabb {
    let Aabb { min, max } = pose.bounds(&of.corners, of.outline.radius());
    let by = by + MARGIN.to_bits() / 2 + 1;
    let moved = |v: Vec2, by: i64| v.map(|c| Fx::from_bits(c.to_bits().saturating_add(by)));
    Aabb { min: moved(min, -by), max: moved(max, by) }
}

/// Two coefficients as one. *Domain* from 0 to 32.
pub(super) fn mixed(rule: MixRule, a: Fx, b: Fx) -> Fx {
    let bits = [a, b].map(|coefficient| u128::from(coefficient.to_bits().unsigned_abs()));
    match rule {
        MixRule::Minimum => a.min(b),
        MixRule::Maximum => a.max(b),
        MixRule::Mean => Fx::from_bits(((bits[0] + bits[1] + 1) >> 1) as i64),
        // Below 2^74.
        MixRule::Product => Fx::from_bits(((bits[0] * bits[1] + (1 << 31)) >> 32) as i64).min(limits::FRICTION),
        MixRule::GeometricMean | MixRule::Standard => geometric_mean(a, b),
    }
}

/// The geometric mean of two coefficients, rounded to nearest.
fn geometric_mean(a: Fx, b: Fx) -> Fx {
    if a == b {
        return a;
    }
    let product = u128::from(a.to_bits().unsigned_abs()) * u128::from(b.to_bits().unsigned_abs());
    let root = product.isqrt();
    // The middle between root and root + 1 has the square root² + root + 1/4.
    Fx::from_bits((root + u128::from(product - root * root > root)) as i64)
}
