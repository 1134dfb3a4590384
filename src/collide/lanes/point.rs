//! The points at the ends of the overlap of two edges.

use super::LaneManifolds;
use super::direction::Rectangle;
use super::facing::Facing;
use super::motion::{Way, closed, half_gap};
use super::vector::{Vector, height, minus, plus, product, select};
use crate::kernel::simd::{GROUP, Lanes};

/// floor(difference · before / length) where `m` says yes, and 0 elsewhere; the lesser one of 0 and the difference for a length of 0.
/// *Domain* there |difference| < 2^31, before ≤ length < 2^32.
#[inline(always)]
pub(super) fn part<L: Lanes>(lanes: L, m: L::Mask, difference: L::Wide, before: L::Wide, length: L::Wide) -> L::Wide {
    let is_asked = lanes.bits(m);
    let mut parts = [0; GROUP];
    if is_asked != 0 {
        let [mut differences, mut befores, mut lengths] = [[0; GROUP]; 3];
        lanes.store(&mut differences, 0, difference);
        lanes.store(&mut befores, 0, before);
        lanes.store(&mut lengths, 0, length);
        for lane in 0..L::WIDTH {
            if is_asked >> lane & 1 == 1 {
                parts[lane] = match lengths[lane] {
                    ..=0 => differences[lane].min(0),
                    length => (differences[lane] * befores[lane]).div_euclid(length),
                };
            }
        }
    }
    lanes.wide(&parts, 0)
}

/// The arms of both bodies to the point at a corner of each, in the middle between the surfaces: at A's corner where `is_a` says yes, at
/// both where they are at one place, else at B's.
#[inline(always)]
pub(super) fn arms<L: Lanes>(
    lanes: L,
    n: Vector<L>,
    [corner_a, corner_b]: [Vector<L>; 2],
    offset: Vector<L>,
    separation: L::Wide,
    [is_a, is_both]: [L::Mask; 2],
) -> [Vector<L>; 2] {
    let mut arms = [corner_a, corner_b];
    for axis in 0..2 {
        let half = lanes.rounded_oddly::<31>(product(lanes, n[axis], separation));
        let (from_a, from_b) = (lanes.add(corner_a[axis], half), lanes.sub(corner_b[axis], half));
        // From either body: the same point but for rounding.
        let (same_a, same_b) = (lanes.add(from_b, offset[axis]), lanes.sub(from_a, offset[axis]));
        let shift = lanes.rounded_oddly::<1>(lanes.sub(same_a, from_a));
        let arm_a = lanes.select(is_a, from_a, same_a);
        let arm_b = lanes.select(is_a, same_b, from_b);
        arms[0][axis] = lanes.select(is_both, lanes.add(from_a, shift), arm_a);
        arms[1][axis] = lanes.select(is_both, lanes.sub(from_b, shift), arm_b);
    }
    arms
}

/// The point at an end of the overlap of two edges.
pub(super) struct Point<L: Lanes> {
    pub(super) arms: [Vector<L>; 2],
    /// Half of an open gap along the normal.
    pub(super) half: Vector<L>,
    pub(super) separation: L::Wide,
    /// The separation at the start of the step.
    pub(super) start: L::Wide,
    pub(super) feature: L::Wide,
    /// True if the separation is beyond half a metre.
    pub(super) is_wide: L::Mask,
    /// True if the separations at the ends of the edge across from the corner differ by half a metre.
    pub(super) is_steep: L::Mask,
}

impl<L: Lanes> Point<L> {
    #[inline(always)]
    pub(super) fn new(
        lanes: L,
        [a, b]: [&Rectangle<L>; 2],
        ways: [&Way<L>; 2],
        offset: Vector<L>,
        facing: &Facing<L>,
        end: usize,
    ) -> Self {
        let Facing { n, places_a, places_b, .. } = facing;
        let corner_a = facing.a[end].vector(lanes, a.corners);
        let corner_b = facing.b[end].vector(lanes, b.corners);
        let far_a = facing.a[1 - end].vector(lanes, a.corners);
        let far_b = facing.b[1 - end].vector(lanes, b.corners);
        // The inner one of the two ends is across from the other box's edge.
        let is_both = lanes.equal(places_a[end], places_b[end]);
        let (inner, outer) = if end == 0 { (places_a, places_b) } else { (places_b, places_a) };
        let is_a = lanes.greater(inner[end], outer[end]);
        let corner_height = height(lanes, *n, minus(lanes, plus(lanes, corner_b, offset), corner_a));
        let [from, to] = [select(lanes, is_a, corner_a, far_a), select(lanes, is_a, far_b, corner_b)];
        let edge_height = height(lanes, *n, minus(lanes, plus(lanes, to, offset), from));
        let heights = if end == 0 { [corner_height, edge_height] } else { [edge_height, corner_height] };
        let difference = lanes.sub(heights[1], heights[0]);
        let size = lanes.magnitude(difference);
        // An edge square to n is flat but for rounding.
        let is_tilted = lanes.unless(lanes.greater(size, lanes.all(4)), is_both);
        let is_steep = lanes.both(is_tilted, lanes.greater(size, lanes.all((1 << 31) - 1)));
        let place = lanes.select(is_a, places_a[end], places_b[end]);
        let span = select(lanes, is_a, *places_b, *places_a);
        let before = lanes.floored::<30>(lanes.sub(place, span[0]));
        let after = lanes.floored::<30>(lanes.sub(span[1], place));
        let part = part(lanes, lanes.unless(is_tilted, is_steep), difference, before, lanes.add(before, after));
        let mean = lanes.floored::<1>(lanes.add(heights[0], heights[1]));
        let flat = lanes.select(is_both, corner_height, mean);
        let separation = lanes.select(is_tilted, lanes.add(heights[0], part), flat);
        let number_b = lanes.raised_by(facing.b[end].number(lanes), lanes.all(12));
        let numbers = lanes.add(facing.a[end].number(lanes), number_b);
        let arms = arms(lanes, *n, [corner_a, corner_b], offset, separation, [is_a, is_both]);
        // Arms to the surface of each body: an open gap closes within the step.
        let half = half_gap(lanes, *n, separation);
        let arms = [minus(lanes, arms[0], half), plus(lanes, arms[1], half)];
        let start = lanes.add(separation, closed(lanes, *n, ways, arms));
        Self {
            arms,
            half,
            separation,
            start,
            // Corners, as pairs of equal numbers.
            feature: lanes.add(numbers, lanes.raised_by(numbers, lanes.all(6))),
            is_wide: lanes.greater(lanes.magnitude(separation), lanes.all((1 << 31) - 1)),
            is_steep,
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, lanes: L, manifolds: &mut LaneManifolds, end: usize, at: usize) {
        for side in 0..2 {
            lanes.store(&mut manifolds.arms[end][side][0], at, self.arms[side][0]);
            lanes.store(&mut manifolds.arms[end][side][1], at, self.arms[side][1]);
        }
        lanes.store(&mut manifolds.halves[end][0], at, self.half[0]);
        lanes.store(&mut manifolds.halves[end][1], at, self.half[1]);
        lanes.store(&mut manifolds.separations[end], at, self.separation);
        lanes.store(&mut manifolds.starts[end], at, self.start);
        lanes.store(&mut manifolds.features[end], at, self.feature);
    }
}
