//! Pairs of a box and a disc: the manifolds of the general way, by the same integers. A disc beside the face that it is nearest to is left.

use super::direction::{Frame, Rectangle, Unit, gap};
use super::motion::{Motion, Way, closed, half_gap};
use super::vector::{Corner, Vector, dot, height, minus, not, plus, product};
use super::{LaneManifolds, LanePairs};
use crate::kernel::simd::{GROUP, Lanes, Line};

/// A disc: its centre relative to the position of its body.
struct Disc<L: Lanes> {
    centre: Vector<L>,
    radius: L::Wide,
    position: Vector<L>,
}

impl<L: Lanes> Disc<L> {
    #[inline(always)]
    fn load(lanes: L, lines: &[Line], index: &[u32; GROUP], at: usize) -> Self {
        let [cx, cy, _, _, radius, _, x, y] = lanes.words_of(lines, index, at);
        Self { centre: [cx, cy], radius, position: [x, y] }
    }
}

/// The face of a box that is nearest to a disc: its outward normal, its ends counter-clockwise, and their heights along the normal.
struct Face<L: Lanes> {
    n: Vector<L>,
    ends: [Corner<L>; 2],
    heights: [L::Wide; 2],
    separation: L::Wide,
    undecided: L::Mask,
}

/// `corners` and `centre` are in the pair's unit, relative to the position of the box.
#[inline(always)]
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
#[inline(always)]
fn highest_end<L: Lanes>(lanes: L, a: &Rectangle<L>, face: &Face<L>, unit: &Unit<L>) -> (L::Wide, L::Mask) {
    let slack = unit.length(lanes, lanes.add(lanes.raised_by(lanes.all(3), unit.k), lanes.floored::<29>(a.extent)));
    let [first, second] = face.heights;
    let (high, low) = (lanes.larger(first, second), lanes.smaller(first, second));
    let is_tilted = lanes.greater(high, lanes.add(low, slack));
    let is_thin = not(lanes, lanes.greater(lanes.add(high, low), slack));
    (high, lanes.either(is_tilted, is_thin))
}

/// n · length / 2^31 to nearest, ties away from zero. *Domain* |length| < 2^61.
#[inline(always)]
fn half_along<L: Lanes>(lanes: L, n: L::Wide, length: L::Wide) -> L::Wide {
    let zero = lanes.all(0);
    let high = lanes.floored::<31>(length);
    let low = lanes.sub(length, lanes.raised_by(high, lanes.all(31)));
    // Ties of negative products are below the half by one.
    let sign = lanes.floored::<63>(lanes.negated(lanes.greater(zero, length), n));
    let rest = lanes.add(product(lanes, n, low), lanes.add(lanes.all(1 << 30), sign));
    lanes.add(product(lanes, n, high), lanes.floored::<31>(rest))
}

/// Collides the pairs of the lanes from `at` on.
#[inline(always)]
pub(super) fn collide<L: Lanes>(
    lanes: L,
    outlines: &[Line],
    motions: &[Line],
    margin: i64,
    pairs: &LanePairs,
    manifolds: &mut LaneManifolds,
    at: usize,
) {
    let zero = lanes.all(0);
    let a = Rectangle::load(lanes, outlines, &pairs.outlines[0], at);
    let b = Disc::load(lanes, outlines, &pairs.outlines[1], at);
    let centre_extent = lanes.largest(b.centre);
    let extent = lanes.add(centre_extent, b.radius);
    let motion_a = Motion::load(lanes, motions, &pairs.motions[0], a.extent, at);
    let motion_b = Motion::load(lanes, motions, &pairs.motions[1], extent, at);
    let is_swapped = lanes.greater(zero, lanes.wide(&pairs.swapped, at));
    let offset = minus(lanes, b.position, a.position);
    let frame = Frame::new(lanes, offset, lanes.add(a.extent, centre_extent), lanes.smaller(a.extent, extent));
    let (offset, unit) = (frame.offset, &frame.unit);
    let corners = [unit.vector(lanes, a.corners[0]), unit.vector(lanes, a.corners[1])];
    let centre = plus(lanes, unit.vector(lanes, b.centre), unit.vector(lanes, offset));
    let face = find_face(lanes, &a, corners, centre);
    let [lower, upper] = motion_a.limits(lanes, &motion_b, lanes.all(margin));
    let [lower, upper] = [lanes.add(lower, b.radius), lanes.add(upper, b.radius)];
    let centre_ulps = plus(lanes, b.centre, offset);
    let gap = gap(lanes, centre_ulps, a.reach);
    let is_apart = frame.is_beyond(lanes, gap, face.separation, upper);
    let may_be_apart = frame.is_beyond(lanes, gap, face.separation, lower);
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
    let separation = lanes.sub(depth, b.radius);
    let is_wide = lanes.greater(lanes.magnitude(separation), lanes.all((1 << 31) - 1));
    let mut undecided = lanes.either(lanes.greater(difference, lanes.all(4)), lanes.greater(depth, lower));
    undecided = lanes.either(undecided, lanes.either(is_wide, lanes.either(motion_a.is_long, motion_b.is_long)));
    // A corner has its point alone.
    undecided = lanes.unless(lanes.either(undecided, is_beside), is_at_corner);
    undecided = lanes.either(undecided, lanes.either(face.undecided, is_uneven));
    undecided = lanes.either(undecided, lanes.either(may_be_apart, not(lanes, lanes.greater(to, from))));
    undecided = lanes.either(frame.undecided, lanes.unless(undecided, is_apart));
    manifolds.at_corner |= lanes.bits(lanes.unless(is_at_corner, is_apart)) << at;
    let corner = face.ends[0].or(lanes, is_before, face.ends[1]);
    lanes.store(&mut manifolds.corners, at, corner.number(lanes));
    let is_there = not(lanes, is_apart);
    let normal = [lanes.negated(is_swapped, face.n[0]), lanes.negated(is_swapped, face.n[1])];
    manifolds.finish(lanes, normal, undecided, [is_there, lanes.unless(is_there, is_there)], at);
    let point = Point { offset, depth, is_swapped };
    point.store(lanes, &face, &b, [&motion_a.way, &motion_b.way], manifolds, at);
}

/// The point of a disc on a face: the centre of the disc is as high as this over the face, and at this offset from the box.
struct Point<L: Lanes> {
    offset: Vector<L>,
    depth: L::Wide,
    is_swapped: L::Mask,
}

impl<L: Lanes> Point<L> {
    #[inline(always)]
    fn store(
        &self,
        lanes: L,
        face: &Face<L>,
        disc: &Disc<L>,
        ways: [&Way<L>; 2],
        manifolds: &mut LaneManifolds,
        at: usize,
    ) {
        let &Self { offset, depth, is_swapped } = self;
        let separation = lanes.sub(depth, disc.radius);
        // The centre moved against the normal, half of the way to the face and half of the radius.
        let way = lanes.add(depth, disc.radius);
        let moved = [half_along(lanes, face.n[0], way), half_along(lanes, face.n[1], way)];
        let arm_b = minus(lanes, disc.centre, moved);
        let half = half_gap(lanes, face.n, separation);
        let arms = [minus(lanes, plus(lanes, arm_b, offset), half), plus(lanes, arm_b, half)];
        let start = lanes.add(separation, closed(lanes, face.n, ways, arms));
        let edge = lanes.add(face.ends[0].number(lanes), lanes.raised_by(face.ends[1].number(lanes), lanes.all(6)));
        let feature = lanes.select(is_swapped, lanes.raised_by(edge, lanes.all(12)), edge);
        for axis in 0..2 {
            let (arm_a, arm_b) = (arms[0][axis], arms[1][axis]);
            lanes.store(&mut manifolds.arms[0][0][axis], at, lanes.select(is_swapped, arm_b, arm_a));
            lanes.store(&mut manifolds.arms[0][1][axis], at, lanes.select(is_swapped, arm_a, arm_b));
            lanes.store(&mut manifolds.halves[0][axis], at, lanes.negated(is_swapped, half[axis]));
        }
        lanes.store(&mut manifolds.separations[0], at, separation);
        lanes.store(&mut manifolds.starts[0], at, start);
        lanes.store(&mut manifolds.features[0], at, feature);
    }
}
