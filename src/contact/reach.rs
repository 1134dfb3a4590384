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

/// The largest distance, in ulps, of two outlines that touch without closing a distance: an ulp is for the rounding of ways.
pub(super) const CLOSE: i64 = MARGIN.to_bits() + 1;

/// The motion of an outline over a step, in ulps: the displacement of its body, and a bound of what the rotation adds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) displacement: [i64; 2],
    pub(super) turned: i64,
}

impl Reach {
    /// The motion of an outline of this radius.
    pub(super) fn new(flight: &Flight, radius: Fx) -> Self {
        let displacement = [flight.displacement.x.to_bits(), flight.displacement.y.to_bits()];
        Self { displacement, turned: turned(flight, radius) }
    }

    /// The way against each other by the displacements. Displacements are below 2^29 m.
    #[inline(always)]
    fn way_to(&self, reach: &Self) -> [i64; 2] {
        [reach.displacement[0] - self.displacement[0], reach.displacement[1] - self.displacement[1]]
    }

    /// The largest distance of two outlines that may touch in the step: the margin and the distance that they close.
    #[inline(always)]
    pub(super) fn closing(&self, reach: &Self) -> Margin {
        Margin::new(Fx::from_bits(CLOSE + self.turned + reach.turned), self.way_to(reach))
    }

    /// The box around an outline over the step, from the box around it at the moment of manifolds, grown by half the margin: two outlines that
    /// may come within the margin of each other have boxes that overlap.
    pub(super) fn swept(&self, bounds: Aabb) -> Aabb {
        let [x, y] = self.displacement.map(i64::abs);
        // The largest distance that a point moves: for two together at least the distance that they close. a + b/2 is at least the length of
        // (a, b) for a ≥ b, and at most an eighth more.
        grown(bounds, x.max(y) + x.min(y) / 2 + 1 + self.turned)
    }

    /// A bound of the distance by which two outlines approach in the step, in ulps.
    #[inline(always)]
    pub(super) fn approach_bound(&self, reach: &Self) -> i64 {
        let [x, y] = self.way_to(reach).map(i64::abs);
        x.max(y) + x.min(y) / 2 + self.turned + reach.turned
    }
}

/// The box around an outline of a body that does not move, grown by half the margin.
pub(super) fn resting(outline: &BodyOutline, pose: &Pose) -> Aabb {
    grown(pose.outline_bounds(outline), 0)
}

/// A box grown on all sides by a distance in ulps and by half the margin.
fn grown(Aabb { min, max }: Aabb, distance: i64) -> Aabb {
    let growth = distance + MARGIN.to_bits() / 2 + 1;
    let moved = |corner: Vec2, way: i64| corner.map(|part| Fx::from_bits(part.to_bits().saturating_add(way)));
    Aabb { min: moved(min, -growth), max: moved(max, growth) }
}
