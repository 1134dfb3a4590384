//! Narrow phase: where two outlines touch, how deep, and along which direction.
//!
//! A [`Manifold`] is a function of integers. Corners are turned into world axes, relative to the centre of their own body, and
//! rounded to ulps once, oddly; offsets of positions are exact. Every choice that follows is by comparison of exact integers, and none
//! depends on which outline comes first, on which corner of it comes first, on the axes up to quarter turns and mirror images,
//! or on the distance from the origin: the manifold of a mirrored, turned (by quarters), shifted, swapped or renumbered pair is
//! the image of the manifold, to the bit.
//!
//! How: the *separation* of two convex cores along a direction n from A to B is min n·b − max n·a over their corners. Among the
//! outward normals of A and the inward ones of B, the direction of largest separation is taken (`axes`). A tie goes to the longer edge,
//! and between edges of one length to the mean direction. Then both cores have the edge that faces the other, and the points are
//! the ends of the interval, across n, in which the two edges overlap (`frame`, `points`): neither of the two is the reference.
//! Cores that are apart with a corner next to a corner have the direction between the two corners.
//!
//! Segments of chains touch on one side, and along fewer directions (`link`).
//!
//! **No direction, no manifold.** Where all directions that tie cancel (two discs with one centre, a square in the middle of a
//! square, a disc on the middle line of a bar) any direction would favour a side, and there is no manifold. Segments and points on one line
//! that are apart have the direction between their ends: their normals say nothing.

mod axes;
mod boxes;
pub mod broad;
mod cores;
mod frame;
pub(crate) mod impact;
mod lanes;
mod link;
mod margin;
mod place;
mod placed;
mod points;
mod span;
mod surface;
pub(crate) mod sweep;

pub use crate::collider::Filter;

pub(crate) use lanes::{LANE_CORNERS, LaneKind, LaneManifold, LaneManifolds, LanePairs, LaneShape, SurfacePoint};
pub use margin::Margin;
pub use place::Pose;
pub use placed::Cores;
pub(crate) use placed::PlacedMotion;

use crate::fx::Fx;
use crate::limits::CORNERS;
use crate::math::Vec2;
use crate::shape::Outline;

use axes::Axes;
use boxes::collide_boxes;
use cores::{Core, Product};
use frame::{Frame, Pair};
use place::{Placed, View, places_of};
use points::{Ends, manifold};
use span::Facing;

/// The contact of two outlines: one point or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifold {
    /// The unit vector from A to B, in units of 2^-30. *Error* 1 unit in each component; between two corners 1.5 ulp over their
    /// distance more, as corners are rounded to ulps; of a mean over normals 1 unit for each, over the length of their sum.
    pub normal: [i32; 2],
    /// The number of points, 1 or 2.
    pub count: usize,
    /// The points, in the order of their components along the normal turned by a quarter counter-clockwise. That order is reversed in a
    /// mirror image and when A and B are swapped. A second point that is not there is all zeros.
    pub points: [ManifoldPoint; 2],
}

/// Smaller overlaps do not wake a sleeping body, 2^-20 m: the solver pushes from 2^-22 m/s on.
const OVERLAP: Fx = Fx::from_bits(1 << 12);

impl Manifold {
    /// The features of the points; the feature of a second point that is not there is 0.
    #[inline]
    pub(crate) fn features(&self) -> [u32; 2] {
        self.points.map(|point| point.feature)
    }

    /// Returns true if the outlines overlap enough to wake a sleeping body.
    pub(crate) fn is_pressed(&self) -> bool {
        self.points.iter().any(|point| point.separation < -OVERLAP)
    }

    /// The least separation of a point, m.
    pub(crate) fn least_separation(&self) -> Fx {
        let [first, second] = self.points.map(|point| point.separation);
        if self.count == 2 { first.min(second) } else { first }
    }

    /// The cosine of the angle between the normal and a unit vector in world axes, in units of 2^-30.
    pub(crate) fn cosine_with(&self, [u, v]: [i32; 2]) -> Fx {
        let [x, y] = self.normal;
        // In units of 2^-60, at most 2^61: a mirror image has the same.
        Fx::from_bits((i64::from(x) * i64::from(u) + i64::from(y) * i64::from(v)) >> 28)
    }
}

/// A point of a manifold, in the middle between the surfaces. The arms differ by the offset of the positions; where a corner of A is
/// at a corner of B, by an ulp more at most, as half an ulp can favour neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ManifoldPoint {
    /// From the centre of mass of A to the point, in world axes, m.
    pub arm_a: Vec2<Fx>,
    /// From the centre of mass of B to the point, in world axes, m.
    pub arm_b: Vec2<Fx>,
    /// The distance between the surfaces along the normal, m; negative where they overlap.
    pub separation: Fx,
    /// The corners that meet here, by number, to find the point again in the next step: [`feature`].
    pub feature: u32,
}

/// The name of a point by the parts that meet in it: `a` and `b` are each a corner, as a pair of equal numbers, or an edge, as the corners
/// at its ends in counter-clockwise order. At either end of two edges that overlap it is a pair of corners; elsewhere a corner of one core
/// and an edge of the other, or two corners.
#[must_use]
pub fn feature(a: [usize; 2], b: [usize; 2]) -> u32 {
    // A polygon has at most 64 corners: six bits each.
    (a[0] | a[1] << 6 | b[0] << 12 | b[1] << 18) as u32
}

/// The name of a point with the two cores swapped.
pub(crate) fn swapped_feature(feature: u32) -> u32 {
    feature >> 12 | (feature & 0xFFF) << 12
}

/// The manifold of two outlines at two poses, if they are at most `margin` m apart. [`Cores`] turns an outline once for all its pairs.
///
/// *Domain* positions within 2^31 m. A margin below zero counts as zero, one above 2^22 m as that.
///
/// *Error* of a separation: 3 ulp, and 2^-30 of the larger core's size (the largest distance of two of its corners) and of the distance of
/// the cores; in a single point between two corners, 2^-30 of both cores' sizes. An edge whose ends are within 4 ulp of one height counts
/// as level, which adds half of the difference; at the far end of another edge at an angle to the normal its slope times 2^-28 of the
/// pair's size is added. Directions whose separations differ by less than about 2^-26 of the pair's size may count as tied. A corner within
/// as much of the line through its neighbours counts as on it, which adds as much.
#[must_use]
pub fn collide(a: &Outline, pose_a: &Pose, b: &Outline, pose_b: &Pose, margin: Fx) -> Option<Manifold> {
    if a.neighbours().is_some() || b.neighbours().is_some() {
        let mut cores = Cores::default();
        let (a, b) = (cores.push(a, pose_a), cores.push(b, pose_b));
        return cores.collide(a, b, margin.into());
    }
    // Most shapes are boxes, and setting memory to zero costs.
    match a.corners().len().max(b.corners().len()) {
        0..=4 => collide_once::<4>(a, pose_a, b, pose_b, margin.into()),
        _ => collide_once::<CORNERS>(a, pose_a, b, pose_b, margin.into()),
    }
}

fn collide_once<const N: usize>(
    a: &Outline,
    pose_a: &Pose,
    b: &Outline,
    pose_b: &Pose,
    margin: Margin,
) -> Option<Manifold> {
    let mut places = [([[0; 2]; N], [[0; 2]; N]), ([[0; 2]; N], [[0; 2]; N])];
    let [(corners_a, normals_a), (corners_b, normals_b)] = &mut places;
    let (room_a, room_b) = (places_of(a.corners().len()), places_of(b.corners().len()));
    let (corners_a, normals_a) = (&mut corners_a[..room_a], &mut normals_a[..room_a]);
    let (corners_b, normals_b) = (&mut corners_b[..room_b], &mut normals_b[..room_b]);
    let placed_a = Placed::new(a, pose_a, corners_a, normals_a);
    let placed_b = Placed::new(b, pose_b, corners_b, normals_b);
    let a = View { placed: &placed_a, corners: corners_a, normals: normals_a };
    let b = View { placed: &placed_b, corners: corners_b, normals: normals_b };
    collide_placed(a, b, margin)
}

/// The manifold of two cores in world axes.
#[inline(always)]
fn collide_placed(a: View<'_>, b: View<'_>, margin: Margin) -> Option<Manifold> {
    let ends = Ends::new(a, b, margin)?;
    match ends.a.placed.count.max(ends.b.placed.count) {
        1 => ends.between_corners(0, 0),
        2..=4 => collide_within::<4>(&ends),
        5..=8 => collide_within::<8>(&ends),
        _ => collide_within::<CORNERS>(&ends),
    }
}

/// The manifold of cores of at most `N` corners.
fn collide_within<const N: usize>(ends: &Ends<'_>) -> Option<Manifold> {
    let (k, is_fine) = unit(ends);
    if is_fine { collide_in::<i64, N>(ends, k) } else { collide_in::<i128, N>(ends, 0) }
}

/// The manifold by products of a type.
#[inline(always)]
fn collide_in<P: Product, const N: usize>(ends: &Ends<'_>, k: u32) -> Option<Manifold> {
    if N == 4 && ends.a.placed.is_box && ends.b.placed.is_box {
        if let Ok(manifold) = collide_boxes::<P>(ends, k) {
            return manifold;
        }
    }
    collide_cores::<P, N>(ends, k)
}

/// log2 of the unit in ulps in which the cores have 30 bits, and whether it is fine enough for the smaller one.
#[inline(always)]
fn unit(ends: &Ends<'_>) -> (u32, bool) {
    let (a, b, offset) = (ends.a.placed, ends.b.placed, ends.offset);
    // Below 2^49 + 2^55, since the boxes around the cores are at most `limit` apart.
    let total = a.extent + b.extent + offset[0].abs().max(offset[1].abs());
    let k = (64 - total.leading_zeros()).saturating_sub(30);
    // A unit of at most 2^-25 of the smaller one's size.
    let smaller = (a.extent + a.radius).min(b.extent + b.radius);
    (k, k == 0 || 1 << k <= smaller >> 25)
}

fn collide_cores<P: Product, const N: usize>(ends: &Ends<'_>, k: u32) -> Option<Manifold> {
    let (a, b) = (Core::<P, N>::new(&ends.a, [0; 2], k), Core::<P, N>::new(&ends.b, ends.offset, k));
    let is_rounded = ends.a.placed.radius + ends.b.placed.radius > 0;
    let pair = Pair { a, b, k, is_rounded };
    let axes = Axes::new(&pair.a, &pair.b, k, &ends.limit)?;
    let Some(direction) = axes.direction(&pair.a, &pair.b) else {
        let [i, j] = pair.ends_on_one_line()?;
        return ends.between_corners(i, j);
    };
    let frame = pair.frame(direction);
    if frame.facing != Facing::Edges {
        return beside(&pair, &axes, ends, frame);
    }
    manifold(ends, &frame)
}

/// The manifold of cores that have no edges facing each other along the direction that seems best: it may be the normal of an edge that
/// is next to the right one and within rounding of it.
#[cold]
fn beside<P: Product, const N: usize>(
    pair: &Pair<P, N>,
    axes: &Axes<P, N>,
    ends: &Ends<'_>,
    frame: Frame<P>,
) -> Option<Manifold> {
    let is_facing = |direction| pair.frame(direction).facing == Facing::Edges;
    let direction = axes.nearly_as_good(&pair.a, &pair.b, is_facing);
    manifold(ends, &direction.map_or(frame, |direction| pair.frame(direction)))
}

/// The largest distance of a point of the outline from the centre of mass of its shape, m, rounded up: corners and radius.
#[must_use]
pub fn radius_bound(outline: &Outline) -> Fx {
    outline.reach()
}
