//! The sum of a core with the mirror image of another one.

use alloc::vec::Vec;

use super::ray::{Feature, RayEnd, at, first_entry};
use super::{Core, Point, cross, dot, edge, from_to, odd_shift};
use crate::kernel::wide::div_256;
use crate::math::Vec2;

/// All differences b − a of the points of two cores: where the second one stands as seen from the first one. It has the origin in it where
/// they overlap.
#[derive(Debug, Default)]
pub(crate) struct Sum {
    /// The differences, and the sum of the radii.
    pub(crate) core: Core,
    /// The corners of A and of B that each corner is the difference of.
    pub(super) pairs: Vec<[usize; 2]>,
}

/// The corner from which the edges ascend by angle from 0 on: the lowest one, and of two the left one; of the mirror image with the
/// sign −1.
fn lowest(corners: &[Point], sign: i64) -> usize {
    (0..corners.len()).min_by_key(|&i| (corners[i][1] * sign, corners[i][0] * sign)).unwrap_or(0)
}

impl Sum {
    /// The sum for two cores that are seen from the same point. Edges are merged by angle, which takes exact products alone.
    pub(crate) fn new(a: &Core, b: &Core) -> Self {
        let mut sum = Self::default();
        sum.set(a, b);
        sum
    }

    /// Makes it the sum for two cores, as [`new`](Self::new), in the memory of another one.
    pub(crate) fn set(&mut self, a: &Core, b: &Core) {
        let (a_corners, b_corners) = (a.corners(), b.corners());
        let counts = [a_corners, b_corners].map(|corners| if corners.len() > 1 { corners.len() } else { 0 });
        let starts = [lowest(a_corners, -1), lowest(b_corners, 1)];
        self.pairs.clear();
        self.core.clear();
        self.core.radius = a.radius + b.radius;
        let mut done = [0; 2];
        loop {
            let [i, j] = [(starts[0] + done[0]) % a_corners.len(), (starts[1] + done[1]) % b_corners.len()];
            if done != [0; 2] && done == counts {
                return;
            }
            self.core.push(from_to(a_corners[i], b_corners[j]));
            self.pairs.push([i, j]);
            // The edges of A turn into their opposites. Both lists ascend, and heads are less than half a turn apart.
            let turn = match (done[0] < counts[0], done[1] < counts[1]) {
                (true, true) => -cross(edge(a_corners, i), edge(b_corners, j)),
                (true, false) => 1,
                (false, true) => -1,
                (false, false) => return,
            };
            done[0] += usize::from(turn >= 0);
            done[1] += usize::from(turn <= 0);
        }
    }

    /// Returns true if a corner of A touches an edge of B at a feature of the sum.
    pub(crate) fn is_corner_of_first(&self, feature: Feature) -> bool {
        let Feature::Edge(k) = feature else { return false };
        let next = if k + 1 < self.pairs.len() { k + 1 } else { 0 };
        self.pairs[k][0] == self.pairs[next][0]
    }

    /// The point where A, cast along a ray, first touches the surface of B, ulps: in the middle where two edges touch. *Error* 1 ulp in
    /// each component, and 2 ulps of the normal at the end of a radius. The normal is that of B.
    pub(crate) fn touch_point(&self, [a, b]: [&Core; 2], ray: Point, end: RayEnd, normal: Vec2) -> Point {
        // Below 2^32 + 1 times 2^46.
        let out = |radius: i64| {
            [normal.x, normal.y].map(|n| odd_shift(i128::from(n.to_bits()) * i128::from(radius), 32) as i64)
        };
        let beside = |p: Point, offset: Point| [p[0] + offset[0], p[1] + offset[1]];
        let (k, next) = match end.feature {
            Feature::Inside => return [0; 2],
            Feature::Corner(k) | Feature::Disc(k) => (k, k),
            Feature::Edge(k) => (k, if k + 1 < self.pairs.len() { k + 1 } else { 0 }),
        };
        let ([i, j], [last_i, last_j]) = (self.pairs[k], self.pairs[next]);
        if j == last_j {
            return beside(b.corners()[j], out(b.radius));
        }
        let way = at(ray, end.fraction);
        let moved = |i: usize| beside(a.corners()[i], way);
        if i == last_i {
            return beside(moved(i), out(-a.radius));
        }
        let (from, to) = (b.corners()[j], b.corners()[last_j]);
        beside(middle_of_overlap([from, to], [moved(last_i), moved(i)]), out(b.radius))
    }
}

/// The first point of the way of core A, cast along a ray, at which it touches core B and goes on into it, or overlaps it at the start. A segment
/// of a chain is touched by what moves towards its outer side, and has the middle of its corners on that side or on its line at the start.
pub(crate) fn cast_hit(a: &Core, b: &Core, is_link: bool, ray: Point) -> Option<RayEnd> {
    if let (true, &[from, to]) = (is_link, b.corners()) {
        let e = from_to(from, to);
        // At most 64 terms below 2^105.
        let behind: i128 = a.corners().iter().map(|&corner| cross(from_to(corner, from), e)).sum();
        if cross(ray, e) >= 0 || behind > 0 {
            return None;
        }
    }
    first_entry(&Sum::new(a, b).core, ray)
}

/// The point of an edge in the middle between the ends of the part of it that is beside another edge, in the same direction, ulps.
///
/// Measured from the middle of the edge and rounded to nearest, halves away from zero, so that an edge from the other end has the same
/// point.
pub(super) fn middle_of_overlap([from, to]: [Point; 2], [low, high]: [Point; 2]) -> Point {
    let e = from_to(from, to);
    // Twice as far as the middle of the edge, and its length; below 2^116 for points below 2^63.
    let along = |p: Point| 2 * dot(p, e) - dot(from, e) - dot(to, e);
    let whole = dot(e, e);
    let middle = along(low).max(-whole) + along(high).min(whole);
    // middle / 4·whole of the edge, at most ½: in units of 2^-62.
    let size = middle.unsigned_abs().min(2 * whole.unsigned_abs());
    let (quotient, rest) = div_256(size >> 68, size << 60, whole.unsigned_abs());
    let share = (quotient + u128::from(rest >= whole.unsigned_abs() - rest)) as i128 * middle.signum();
    // Below 2^64·2^61 and 2^50·2^61.
    [0, 1].map(|k| odd_shift(((i128::from(from[k]) + i128::from(to[k])) << 61) + i128::from(e[k]) * share, 62) as i64)
}
