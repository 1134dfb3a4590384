//! Segments of chains: they touch on one side, and along the directions that are theirs alone.
//!
//! The *outer* side of a segment is on its right. At an outward corner of the chain the directions between the normals of the two
//! segments that join there belong to both; at one that is straight or turns inwards there are none beside the normals; at an end of the
//! chain those up to the way along the segment. Only these count for the largest separation: a box that slides over a
//! seam is never pushed back by the end of the next segment. Where the normal of a neighbour separates more than any of a segment's own
//! directions, the neighbour has the contact, and the segment has none. So a ball has one contact with a smooth chain, of the segment it
//! is above, but for the place where both are as near. Where the chain goes on straight, an edge that lies over the seam has no point
//! there: it has points at its own ends, as on one long segment.
//!
//! All of it is by comparison of integers that a mirror image, with the points in the opposite order, has too.

use super::axes::Axes;
use super::cores::{Core, Product, across};
use super::frame::{Direction, Pair};
use super::place::View;
use super::points::Ends;
use super::span::{At, Facing};
use super::{Manifold, ManifoldPoint, unit};
use crate::limits::CORNERS;
use crate::shape::Neighbour;

/// What has its middle farther behind a segment is not pushed, in ulps: 2 cm, more than what a thin body sinks in.
const BEHIND: i64 = (1 << 32) / 50;

/// The sine of the angle by which a direction may be off, in units of 2^-60: 2^-20. Normals err by 2^-30, directions between corners
/// by 1.5 ulp over their distance, which is 2^-7 m at least where it counts.
const SLACK: i64 = 1 << 40;

/// The directions from one to another, counter-clockwise, less than half a turn.
#[derive(Clone, Copy, Debug)]
struct Cone {
    from: [i32; 2],
    to: [i32; 2],
}

impl Cone {
    /// Unit vectors: products are below 2^61.1, their sums below 2^62.1.
    fn has(&self, n: [i32; 2]) -> bool {
        let cross = |a: [i32; 2], b: [i32; 2]| i64::from(a[0]) * i64::from(b[1]) - i64::from(a[1]) * i64::from(b[0]);
        let dot = |a: [i32; 2], b: [i32; 2]| i64::from(a[0]) * i64::from(b[0]) + i64::from(a[1]) * i64::from(b[1]);
        cross(self.from, n) >= -SLACK
            && cross(n, self.to) >= -SLACK
            && i128::from(dot(n, self.from)) + i128::from(dot(n, self.to)) > 0
    }
}

/// The directions in which a segment of a chain pushes, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    normal: [i32; 2],
    /// At its first and at its second corner.
    cones: [Cone; 2],
    /// The normals of neighbours at outward corners.
    outer: [Option<[i32; 2]>; 2],
    /// The chain goes on straight at this corner.
    is_straight: [bool; 2],
}

impl Link {
    pub(super) fn new(normal: [i32; 2], [before, after]: [Neighbour<[i32; 2]>; 2]) -> Self {
        let along = across(normal);
        let is_straight = [before, after].map(|neighbour| match neighbour {
            Neighbour::Inner(other) | Neighbour::Outer(other) => Cone { from: normal, to: normal }.has(other),
            Neighbour::None => false,
        });
        let outer = [0, 1].map(|end| match [before, after][end] {
            Neighbour::Outer(other) if !is_straight[end] => Some(other),
            _ => None,
        });
        let reach = |end: usize, neighbour, far| match neighbour {
            Neighbour::None => far,
            _ => outer[end].unwrap_or(normal),
        };
        let cones = [
            Cone { from: reach(0, before, along.map(|part| -part)), to: normal },
            Cone { from: normal, to: reach(1, after, along) },
        ];
        Self { normal, cones, outer, is_straight }
    }

    fn has(&self, n: [i32; 2]) -> bool {
        self.cones.iter().any(|cone| cone.has(n))
    }

    /// Returns true if the mean of a core's corners is behind the segment.
    fn is_before(&self, own: &View<'_>, other: &View<'_>, offset: [i64; 2]) -> bool {
        let count = other.placed.count;
        let corners = || other.corners.iter().take(count);
        // At most 64 corners within 2^48, offsets below 2^56: below 2^63.
        let sum = |part: usize| {
            let all: i64 = corners().map(|corner| corner[part]).sum();
            all + (offset[part] - own.corners[0][part]) * count as i64
        };
        let height = <i128 as Product>::dot(self.normal, [sum(0), sum(1)]);
        height < -(i128::from(BEHIND * count as i64) << 30)
    }
}

/// The manifold of a segment of a chain, A, with another core, if that is in front of it.
#[cold]
pub(super) fn collide_link(a: View<'_>, link: &Link, b: View<'_>, margin: i64) -> Option<Manifold> {
    let offset = a.offset_to(&b)?;
    let limit = margin + a.placed.radius + b.placed.radius;
    if a.is_clear_of(&b, offset, limit) || link.is_before(&a, &b, offset) {
        return None;
    }
    let ends = Ends { a, b, offset, limit };
    match b.placed.count {
        0..=4 => within::<4>(&ends, link),
        5..=8 => within::<8>(&ends, link),
        _ => within::<CORNERS>(&ends, link),
    }
}

fn within<const N: usize>(ends: &Ends<'_>, link: &Link) -> Option<Manifold> {
    match unit(ends) {
        (k, true) => of_cores::<i64, N>(ends, link, k),
        (_, false) => of_cores::<i128, N>(ends, link, 0),
    }
}

fn of_cores<P: Product, const N: usize>(ends: &Ends<'_>, link: &Link, k: u32) -> Option<Manifold> {
    let (a, b) = (Core::<P, N>::new(&ends.a, [0; 2], k), Core::<P, N>::new(&ends.b, ends.offset, k));
    let is_rounded = ends.a.placed.radius + ends.b.placed.radius > 0;
    let pair = Pair { a, b, k, is_rounded };
    let axes = Axes::of_link(&pair.a, &pair.b, k, P::length(ends.limit, k), |n| link.has(n))?;
    if link.outer.iter().flatten().any(|&n| axes.is_less(pair.separation(n))) {
        return None;
    }
    let frame = pair.frame_of_link(axes.direction(&pair.a, &pair.b)?);
    // An edge that lies over a corner at which the chain goes on straight has no point there.
    let is_seam = |at| matches!(at, At::A(corner) if link.is_straight[corner & 1]);
    let overlap = |frame| ends.overlap::<P, false>(frame, is_seam);
    match frame.facing {
        Facing::Edges => overlap(&frame),
        Facing::Corners(i, j) => ends.between_corners(i, j).filter(|found| link.has(found.normal)),
        // The edges do not overlap: the corner that is beside this segment is over a neighbour.
        Facing::Beside(..) | Facing::Touching => {
            let is_facing = |direction: Direction| pair.frame(direction).facing == Facing::Edges;
            let other = axes.nearly_as_good(&pair.a, &pair.b, is_facing)?;
            overlap(&pair.frame(other))
        }
    }
}

/// The manifold with the two outlines swapped.
pub(super) fn swapped(of: Manifold) -> Manifold {
    let mut points = of.points.map(|point| ManifoldPoint {
        arm_a: point.arm_b,
        arm_b: point.arm_a,
        separation: point.separation,
        feature: point.feature >> 12 | (point.feature & 0xFFF) << 12,
    });
    if of.count == 2 {
        points.reverse();
    }
    Manifold { normal: of.normal.map(|part| -part), count: of.count, points }
}
