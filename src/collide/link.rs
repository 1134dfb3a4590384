//! Manifolds of segments of chains, and of polygons beside others: they touch only along directions that are not their neighbours', and a
//! segment only on one side.
//!
//! The *outer* side of a segment is on its right. At an outward corner of the chain the directions between the normals of the two
//! segments that join there belong to both; at one that is straight or turns inwards there are none beside the normals; at an end of the
//! chain the directions up to the way along the segment. Only these count for the largest separation: a box that slides over a
//! seam is never pushed back by the end of the next segment. A body that crosses the line of the segment may be beyond an end of it, as a bar
//! that leans under it: at an end of the chain the directions of that body count all around, and at a neighbour a body that any direction
//! separates does not touch. Where the normal of a neighbour separates more than any of a segment's own directions, the neighbour has the
//! contact, and the segment has none. So a ball has one contact with a smooth chain, with the segment that it is above, or two exactly
//! over a seam. Where the chain goes on straight, an edge that lies over the seam has no point there: it has points at its own ends, as
//! on one long segment.
//!
//! The edges of static polygons, and of polygons of one body, that are on the [surface](crate::shape::union) of their union follow the same rules,
//! each as a segment whose neighbours are the edges by which the surface goes on. At a corner whose two edges are both on the surface a
//! polygon pushes as one that stands alone.
//!
//! Where both cores are on surfaces (a raft of boxes on a floor of tiles) the rules of both hold. Inner tiles have hardly a direction in common
//! then, as their bodies lean on each other by some ulps: if there is none, normals that lean by up to 3.6° count, the ones of the surface
//! that goes on straight to more sides. Over seams there are no points, so that the raft has the points of one long box.
//!
//! All of it is by comparison of integers that a mirror image, with the points in the opposite order, has too.

use super::axes::{Axes, reaches};
use super::cores::{Core, Product};
use super::frame::{Direction, Frame, Pair};
use super::place::View;
use super::points::Ends;
use super::span::Facing;
use super::surface::{Surface, Surfaces};
use super::{Manifold, ManifoldPoint, Margin, collide_placed, swapped_feature, unit};
use crate::limits::CORNERS;

/// A body whose middle is farther behind a segment than this is not pushed by it, in ulps: 2 cm, which is more than a thin body sinks in at
/// rest.
const BEHIND: i64 = (1 << 32) / 50;

/// Twice the sum over the corners of a core of their heights over the line through an edge, in units of 2^-30 ulp: over the middle of
/// its ends, as a mirror image has them in the opposite order.
fn height(normal: [i32; 2], ends: [[i64; 2]; 2], core: &View<'_>, offset: [i64; 2]) -> i128 {
    let count = core.placed.count;
    // At most 64 corners within 2^48. Offsets are below 2^56, and of cores whose boxes are near each other below 2^55: below 2^63.
    let sum = |part: usize| {
        let total: i64 = core.corners.iter().take(count).map(|corner| corner[part]).sum();
        2 * total + (2 * offset[part] - ends[0][part] - ends[1][part]) * count as i64
    };
    <i128 as Product>::dot(normal, [sum(0), sum(1)])
}

/// Twice the least height of a corner of a core over the line through an edge, in units of 2^-30 ulp.
fn lowest(normal: [i32; 2], ends: [[i64; 2]; 2], core: &View<'_>, offset: [i64; 2]) -> i128 {
    let height_over_edge = |corner: &[i64; 2]| {
        let twice = |part: usize| 2 * (corner[part] + offset[part]) - ends[0][part] - ends[1][part];
        <i128 as Product>::dot(normal, [twice(0), twice(1)])
    };
    core.corners.iter().take(core.placed.count).map(height_over_edge).min().unwrap_or(0)
}

/// Returns true if a corner of a core is beyond an end of an edge, along the edge.
fn is_past(ends: [[i64; 2]; 2], core: &View<'_>, offset: [i64; 2]) -> bool {
    let along = |end: usize, corner: &[i64; 2]| {
        let part = |k: usize| i128::from(corner[k] + offset[k] - ends[end][k]) * i128::from(ends[1][k] - ends[0][k]);
        part(0) + part(1)
    };
    core.corners.iter().take(core.placed.count).any(|corner| along(0, corner) < 0 || along(1, corner) > 0)
}

/// The manifold of two cores of which one, or each, is a segment of a chain or a polygon among others.
#[cold]
pub(super) fn collide_surfaces(
    a: View<'_>,
    b: View<'_>,
    mut surfaces: Surfaces<'_>,
    margin: Margin,
) -> Option<Manifold> {
    let offset = a.offset_to(&b)?;
    let limit = margin.limit(a.placed.radius + b.placed.radius);
    if limit.is_below(a.gap(&b, offset)) {
        return None;
    }
    let facing_a = surfaces.a.as_mut().map_or(Some(true), |surface| faces(surface, &a, &b, offset));
    let facing_b = surfaces.b.as_mut().map_or(Some(true), |surface| faces(surface, &b, &a, offset.map(|part| -part)));
    if !(facing_a? && facing_b?) {
        return collide_placed(a, b, margin);
    }
    let ends = Ends { a, b, offset, limit };
    match a.placed.count.max(b.placed.count) {
        0..=4 => collide_surfaces_within::<4>(&ends, &surfaces),
        5..=8 => collide_surfaces_within::<8>(&ends, &surfaces),
        _ => collide_surfaces_within::<CORNERS>(&ends, &surfaces),
    }
}

/// Looks at another core from a surface. Returns `None` if it does not touch the other core, and false for a polygon with neighbours all
/// around, which has no surface.
fn faces(surface: &mut Surface<'_>, core: &View<'_>, other_core: &View<'_>, offset: [i64; 2]) -> Option<bool> {
    let ends = |i: usize| [core.corners[i], core.corners[(i + 1) % core.placed.count]];
    let mut heights = (0..core.placed.count).map(|i| height(core.normals[i], ends(i), other_core, offset));
    if surface.is_one_sided {
        let behind = 2 * i128::from(BEHIND * other_core.placed.count as i64);
        let is_behind = |height: i128| height < -(i128::from(2 * BEHIND) << 30);
        surface.is_across =
            is_past(ends(0), other_core, offset) && is_behind(lowest(core.normals[0], ends(0), other_core, offset));
        return (heights.next() >= Some(-(behind << 30))).then_some(true);
    }
    if surface.links.is_empty() {
        // Only a body that is in the middle of the neighbours is pushed, by the nearest edge.
        return heights.all(|height| height < 0).then_some(false);
    }
    Some(true)
}

fn collide_surfaces_within<const N: usize>(ends: &Ends<'_>, surfaces: &Surfaces<'_>) -> Option<Manifold> {
    match unit(ends) {
        (k, true) => collide_surfaces_in::<i64, N>(ends, surfaces, k),
        (_, false) => collide_surfaces_in::<i128, N>(ends, surfaces, 0),
    }
}

fn collide_surfaces_in<P: Product, const N: usize>(
    ends: &Ends<'_>,
    surfaces: &Surfaces<'_>,
    k: u32,
) -> Option<Manifold> {
    let (a, b) = (Core::<P, N>::new(&ends.a, [0; 2], k), Core::<P, N>::new(&ends.b, ends.offset, k));
    let is_rounded = ends.a.placed.radius + ends.b.placed.radius > 0;
    let pair = Pair { a, b, k, is_rounded };
    let axes = Axes::of_surfaces(&pair.a, &pair.b, k, &ends.limit, surfaces)?;
    let outer_a = surfaces.a.iter().flat_map(Surface::outer);
    let outer_b = surfaces.b.iter().flat_map(Surface::outer).map(|n| n.map(|part| -part));
    if outer_a.chain(outer_b).any(|n| axes.is_less(pair.separation(n))) {
        return None;
    }
    let frame = pair.frame_of_surfaces(axes.direction(&pair.a, &pair.b)?, surfaces);
    // An edge that lies over a corner at which the surface goes on straight has no point there.
    let overlap = |frame: &Frame<P>| {
        let manifold = ends.overlap(frame, |at| surfaces.is_seam(at));
        manifold.or_else(|| ends.deepest(frame, |i, j| surfaces.are_own(i, j)))
    };
    match frame.facing {
        Facing::Edges => {
            let [last, first] = frame.b.corners;
            let is_on_a = |surface: &Surface<'_>| {
                surface.has_edge(frame.a.corners, |link, end| reaches([&pair.a, &pair.b], link, end, k))
            };
            let is_on_b = |surface: &Surface<'_>| {
                surface.has_edge([first, last], |link, end| reaches([&pair.b, &pair.a], link, end, k))
            };
            let are_on = surfaces.a.as_ref().is_none_or(is_on_a) && surfaces.b.as_ref().is_none_or(is_on_b);
            are_on.then(|| overlap(&frame)).flatten()
        }
        Facing::Corners(i, j) => ends.between_corners(i, j).filter(|manifold| surfaces.have_at(i, j, manifold.normal)),
        // The edges do not overlap: the corner that is beside this edge is over a neighbour.
        Facing::Beside(..) | Facing::Touching => {
            let is_facing = |direction: Direction| pair.frame(direction).facing == Facing::Edges;
            match (axes.nearly_as_good(&pair.a, &pair.b, is_facing), frame.facing) {
                (Some(direction), _) => overlap(&pair.frame(direction)),
                (None, Facing::Beside(i, j)) if surfaces.are_own(i, j) => {
                    ends.single(frame.n, ends.separation(frame.n), i, j)
                }
                _ => None,
            }
        }
    }
}

/// The manifold with the two outlines swapped.
pub(super) fn swapped(manifold: Manifold) -> Manifold {
    let mut points = manifold.points.map(|point| ManifoldPoint {
        arm_a: point.arm_b,
        arm_b: point.arm_a,
        separation: point.separation,
        feature: swapped_feature(point.feature),
    });
    if manifold.count == 2 {
        points.reverse();
    }
    Manifold { normal: manifold.normal.map(|part| -part), count: manifold.count, points }
}
