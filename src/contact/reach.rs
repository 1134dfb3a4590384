//! The distance that two bodies close in a step, and the boxes of outlines over a step.

use super::MARGIN;
use crate::collide::{Margin, Pose};
use crate::collider::BodyOutline;
use crate::fx::Fx;
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

/// The largest distance of two outlines that may touch in the step: the margin and the distance that they close. Displacements are below 2^29 m.
#[inline]
pub(super) fn closing([a, b]: [&Flight; 2], radii: [Fx; 2]) -> Margin {
    let way = |a: Fx, b: Fx| b.to_bits() - a.to_bits();
    let x = way(a.displacement.x, b.displacement.x);
    let y = way(a.displacement.y, b.displacement.y);
    // The ways are rounded up, the way of the displacements by the ulp.
    Margin::new(Fx::from_bits(MARGIN.to_bits() + 1 + turned(a, radii[0]) + turned(b, radii[1])), [x, y])
}

/// A bound of the distance by which two outlines of these radii approach in the step, in ulps.
#[inline]
pub(super) fn approach_bound([a, b]: [&Flight; 2], radii: [Fx; 2]) -> i64 {
    let way = |a: Fx, b: Fx| (b.to_bits() - a.to_bits()).abs();
    let x = way(a.displacement.x, b.displacement.x);
    let y = way(a.displacement.y, b.displacement.y);
    x.max(y) + x.min(y) / 2 + turned(a, radii[0]) + turned(b, radii[1])
}

/// The largest distance that a point of an outline moves in the step, in ulps: for two together at least the
/// distance that they [close](closing).
fn way(flight: &Flight, radius: Fx) -> i64 {
    let [x, y] = [flight.displacement.x, flight.displacement.y].map(|way| way.to_bits().abs());
    // a + b/2 is at least the length of (a, b) for a ≥ b, and at most an eighth more.
    x.max(y) + x.min(y) / 2 + 1 + turned(flight, radius)
}

/// A box around an outline over the step, grown by half the margin: two outlines that may come within the margin of each other have boxes
/// that overlap.
pub(super) fn swept(outline: &BodyOutline, pose: &Pose, flight: &Flight) -> Aabb {
    grown(outline, pose, way(flight, outline.radius))
}

/// The box around an outline of a body that does not move, grown by half the margin.
pub(super) fn resting(outline: &BodyOutline, pose: &Pose) -> Aabb {
    grown(outline, pose, 0)
}

/// The box around an outline at a pose, grown on all sides by a distance in ulps and by half the margin.
fn grown(outline: &BodyOutline, pose: &Pose, distance: i64) -> Aabb {
    let Aabb { min, max } = pose.bounds(&outline.corners, outline.outline.radius());
    let growth = distance + MARGIN.to_bits() / 2 + 1;
    let moved = |corner: Vec2, way: i64| corner.map(|part| Fx::from_bits(part.to_bits().saturating_add(way)));
    Aabb { min: moved(min, -growth), max: moved(max, growth) }
}
