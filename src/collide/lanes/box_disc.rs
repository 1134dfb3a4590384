//! Pairs of a box and a disc: the manifolds of the general way, by the same integers. A disc beside the face that it is nearest to is left.

use super::corners::Corners;
use super::direction::{Frame, Rectangle, Unit, gap};
use super::discs::Disc;
use super::motion::Motion;
use super::point::{Point, moved_back};

use super::vector::{Corner, Vector, dot, height, minus, not, plus};
use super::{LaneManifolds, LanePairs, Tables};
use crate::kernel::simd::Lanes;

/// The face of a box that is nearest to a disc: its outward normal, its ends counter-clockwise, and their heights along the normal.
struct Face<L: Lanes> {
    n: Vector<L>,
    ends: [Corner<L>; 2],
    heights: [L::Wide; 2],
    separation: L::Wide,
    undecided: L::Mask,
}

/// `corners` and `centre` are in the pair's unit, relative to the position of the box.
#[cfg_attr(not(debug_assertions), inline(always))]
fn find_face<L: Lanes>(lanes: L, a: &Rectangle<L>, corners: [Vector<L>; 2], centre: Vector<L>) -> Face<L> {
    let zero = lanes.all(0);
    let [first, second] = a.normals;
    let heights_first = [dot(lanes, first, corners[0]), dot(lanes, first, corners[1])];
    // The edge of the second normal goes on from the end of the first one's, to the corner opposite to the first.
    let heights_second = [dot(lanes, second, corners[1]), lanes.sub(zero, dot(lanes, second, corners[0]))];
    let (along_first, along_second) = (dot(lanes, first, centre), dot(lanes, second, centre));
    let separation_first = lanes.sub(lanes.magnitude(along_first), lanes.larger(heights_first[0], heights_first[1]));
    let separation_second =
        lanes.sub(lanes.magnitude(along_second), lanes.larger(heights_second[0], heights_second[1]));
    let is_first = lanes.greater(separation_first, separation_second);
    let along = lanes.select(is_first, along_first, along_second);
    let is_back = lanes.greater(zero, along);
    let n = [
        lanes.negated(is_back, lanes.select(is_first, first[0], second[0])),
        lanes.negated(is_back, lanes.select(is_first, first[1], second[1])),
    ];
    // From corner 0 or 1 on, or from the opposite one.
    let start = Corner { is_odd: not(lanes, is_first), is_opposite: is_back };
    Face {
        n,
        ends: [start, start.next(lanes)],
        heights: [
            lanes.select(is_first, heights_first[0], heights_second[0]),
            lanes.select(is_first, heights_first[1], heights_second[1]),
        ],
        separation: lanes.larger(separation_first, separation_second),
        undecided: lanes.either(lanes.equal(separation_first, separation_second), lanes.equal(along, zero)),
    }
}

/// The height of the farther end of a face, and a mask of the lanes in which the corners that are farthest out along its normal are not just
/// its two ends.
#[cfg_attr(not(debug_assertions), inline(always))]
fn highest_end<L: Lanes>(lanes: L, a: &Rectangle<L>, face: &Face<L>, unit: &Unit<L>) -> (L::Wide, L::Mask) {
    let slack = unit.length(lanes, lanes.add(lanes.raised_by(lanes.all(3), unit.k), lanes.floored::<29>(a.extent)));
    let [first, second] = face.heights;
    let (high, low) = (lanes.larger(first, second), lanes.smaller(first, second));
    let is_tilted = lanes.greater(high, lanes.add(low, slack));
    let is_thin = not(lanes, lanes.greater(lanes.add(high, low), slack));
    (high, lanes.either(is_tilted, is_thin))
}

/// Collides the pairs of the lanes from `at` on.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn collide<L: Lanes>(
    lanes: L,
    tables: &Tables<'_>,
    pairs: &LanePairs,
    manifolds: &mut LaneManifolds,
    at: usize,
) {
    let zero = lanes.all(0);
    let a = Rectangle::load(lanes, tables.outlines, &pairs.outlines[0], at);
    let b = Disc::load(lanes, tables.outlines, &pairs.outlines[1], at);
    let extent = lanes.add(b.extent, b.radius);
    let motion_a = Motion::load(lanes, tables.motions, &pairs.motions[0], a.extent, at);
    let motion_b = Motion::load(lanes, tables.motions, &pairs.motions[1], extent, at);
    let is_swapped = lanes.greater(zero, lanes.wide(&pairs.swapped, at));
    let offset = minus(lanes, b.position, a.position);
    let frame = Frame::new(lanes, offset, lanes.add(a.extent, b.extent), lanes.smaller(a.extent, extent));
    let (offset, unit) = (frame.offset, &frame.unit);
    let corners = [unit.vector(lanes, a.corners[0]), unit.vector(lanes, a.corners[1])];
    let centre = plus(lanes, unit.vector(lanes, b.centre), unit.vector(lanes, offset));
    let face = find_face(lanes, &a, corners, centre);
    let [lower, upper] = motion_a.limits(lanes, &motion_b, lanes.all(tables.margin));
    let centre_ulps = plus(lanes, b.centre, offset);
    let gap = gap(lanes, centre_ulps, a.reach);
    let is_apart = frame.is_beyond(lanes, gap, face.separation, lanes.add(upper, b.radius));
    let may_be_apart = frame.is_beyond(lanes, gap, face.separation, lanes.add(lower, b.radius));
    let (high, is_uneven) = highest_end(lanes, &a, &face, unit);
    let across = [lanes.sub(zero, face.n[1]), face.n[0]];
    let places = [dot(lanes, across, corners[0]), dot(lanes, across, corners[1])];
    let [from, to] = [face.ends[0].of(lanes, places), face.ends[1].of(lanes, places)];
    let place = dot(lanes, across, centre);
    let is_before = lanes.greater(from, place);
    let is_beside = lanes.either(is_before, lanes.greater(place, to));
    // Along the normal the cores are apart: the corner is next to the disc.
    let is_at_corner = lanes.both(is_beside, lanes.greater(lanes.magnitude(dot(lanes, face.n, centre)), high));
    // The heights of the centre over both ends.
    let ends = [face.ends[0].vector(lanes, a.corners), face.ends[1].vector(lanes, a.corners)];
    let heights = [
        height(lanes, face.n, minus(lanes, centre_ulps, ends[0])),
        height(lanes, face.n, minus(lanes, centre_ulps, ends[1])),
    ];
    let difference = lanes.magnitude(lanes.sub(heights[0], heights[1]));
    let depth = lanes.floored::<1>(lanes.add(heights[0], heights[1]));
    let on_face = on_face(lanes, &face, &b, offset, depth);
    let corner = face.ends[0].or(lanes, is_before, face.ends[1]);
    let corners = Corners { corners: [corner.vector(lanes, a.corners), b.centre], offset, radii: [zero, b.radius] };
    let is_asked = lanes.unless(is_at_corner, is_apart);
    let (at_corner, is_between) = corners.between(lanes, is_asked);
    let number = corner.number(lanes);
    let at_corner = Point { feature: lanes.add(number, lanes.raised_by(number, lanes.all(6))), ..at_corner };
    let point = at_corner.or(lanes, is_at_corner, on_face);
    // A corner has its point alone.
    let mut undecided = lanes.either(lanes.greater(difference, lanes.all(4)), is_beside);
    undecided = lanes.unless(undecided, is_at_corner);
    undecided = lanes.either(undecided, lanes.greater(point.separation, lower));
    undecided = lanes.either(undecided, point.is_wide(lanes));
    undecided = lanes.either(undecided, lanes.either(motion_a.is_long, motion_b.is_long));
    let is_beyond = lanes.unless(is_at_corner, is_between);
    let is_beyond = lanes.either(is_beyond, lanes.both(is_at_corner, lanes.greater(point.separation, upper)));
    undecided = lanes.unless(undecided, is_beyond);
    undecided = lanes.either(undecided, lanes.either(face.undecided, is_uneven));
    undecided = lanes.either(undecided, lanes.either(may_be_apart, not(lanes, lanes.greater(to, from))));
    undecided = lanes.either(frame.undecided, lanes.unless(undecided, is_apart));
    let is_there = not(lanes, lanes.either(is_apart, is_beyond));
    let normal = [lanes.negated(is_swapped, point.n[0]), lanes.negated(is_swapped, point.n[1])];
    manifolds.finish(lanes, normal, undecided, [is_there, lanes.unless(is_there, is_there)], at);
    point.store(lanes, [&motion_a.way, &motion_b.way], Some(is_swapped), manifolds, [0, at]);
}

/// The manifold of a disc on a face over which its centre is as high as this.
#[cfg_attr(not(debug_assertions), inline(always))]
fn on_face<L: Lanes>(lanes: L, face: &Face<L>, disc: &Disc<L>, offset: Vector<L>, depth: L::Wide) -> Point<L> {
    // The centre moved against the normal, half of the way to the face and half of the radius.
    let arm_b = moved_back(lanes, disc.centre, face.n, lanes.add(depth, disc.radius));
    Point {
        n: face.n,
        arms: [plus(lanes, arm_b, offset), arm_b],
        separation: lanes.sub(depth, disc.radius),
        feature: lanes.add(face.ends[0].number(lanes), lanes.raised_by(face.ends[1].number(lanes), lanes.all(6))),
    }
}
