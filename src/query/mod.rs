//! Geometry of queries: where a point, a ray or a moving shape meets a shape.
//!
//! All of it runs in integers, whatever the scalar of the world: a shape is a convex core with corners in ulps (2^-32 m) and a radius
//! around it, at the place of its body. Corners are turned and rounded to ulps once, oddly; all that follows is a function of
//! integers, and that of a mirror image is the mirror image, to the bit.
//!
//! Shapes are closed sets: for rays and overlaps a graze counts. A shape that is cast meets only what its way leads into: it may touch others, and
//! slide along them. Every query is one of three on a core, seen from the origin:
//!
//! - `near`: does it contain the origin, and which of its points is nearest to it;
//! - `ray`: the first point of a ray from the origin that is in it, or from which on the ray leads into it.
//!
//! Two shapes overlap if the sum of one core with the mirror image of the other (`sum`), with the sum of the radii, contains the origin;
//! a shape that is cast hits another one where the ray of its translation enters that sum. Where a sharp corner is met, `seam` asks for the
//! surface of the polygons that touch there.
//!
//! **Ranges.** Corners are less than 2^15 m from the centre of mass of their body, edges are shorter than 2^50 ulps, also those of a
//! sum. A query looks at most [`limits::QUERY`](crate::limits::QUERY) = 2^20 m along each axis; a core of which nothing is in reach is
//! not looked at. So a ray is below 2^52 ulps in each component, and a corner, relative to the origin, below 2^54.

mod core;
mod near;
mod pair;
mod ray;
mod seam;
mod shape;
mod sum;
#[cfg(test)]
mod tests;

pub(crate) use crate::kernel::round::odd_shift;

pub(crate) use self::core::{Core, Placement, in_fx, place_digest};
pub(crate) use near::{Near, contains, distance, nearest, point};
pub(crate) use pair::CoreDistance;
pub use pair::ShapeDistance;
pub(crate) use ray::{FULL, Feature, Line, RayEnd, at, beyond_seam, first_hit, normal, normal_at_seam, ray_hit};
pub(crate) use seam::{Seam, SeamPlace};
pub use shape::ShapeHit;
pub(crate) use shape::{beside, checked_point, checked_translation, in_metres, in_parts, in_scalar};
pub(crate) use sum::{Sum, cast_hit};

/// A vector in ulps.
pub(crate) type Point = [i64; 2];

/// a × b. *Domain* the products of the components are below 2^125.
#[inline(always)]
pub(crate) const fn cross(a: Point, b: Point) -> i128 {
    a[0] as i128 * b[1] as i128 - a[1] as i128 * b[0] as i128
}

/// a · b. *Domain* as [`cross`].
#[inline(always)]
pub(crate) const fn dot(a: Point, b: Point) -> i128 {
    a[0] as i128 * b[0] as i128 + a[1] as i128 * b[1] as i128
}

/// b − a. *Domain* it fits.
#[inline(always)]
pub(crate) const fn from_to(a: Point, b: Point) -> Point {
    [b[0] - a[0], b[1] - a[1]]
}

/// The edge from a corner to the next one. *Domain* there are two corners or more.
#[inline(always)]
pub(crate) fn edge(corners: &[Point], i: usize) -> Point {
    from_to(corners[i], corners[if i + 1 < corners.len() { i + 1 } else { 0 }])
}

/// The outward normal of a counter-clockwise edge, as long as the edge.
#[inline(always)]
pub(crate) const fn outward([x, y]: Point) -> Point {
    [y, -x]
}
