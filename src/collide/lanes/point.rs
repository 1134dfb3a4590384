//! Points of manifolds, and points at the ends of the overlap of two edges.

use super::LaneManifolds;
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

/// A corner moved along n by half of a distance.
#[inline(always)]
pub(super) fn moved<L: Lanes>(lanes: L, corner: Vector<L>, n: Vector<L>, twice: L::Wide) -> Vector<L> {
    plus(lanes, corner, [half_along(lanes, n[0], twice), half_along(lanes, n[1], twice)])
}

/// A corner moved against n by half of a distance.
#[inline(always)]
pub(super) fn moved_back<L: Lanes>(lanes: L, corner: Vector<L>, n: Vector<L>, twice: L::Wide) -> Vector<L> {
    minus(lanes, corner, [half_along(lanes, n[0], twice), half_along(lanes, n[1], twice)])
}

/// A point of a manifold, in the middle between the surfaces of A and B.
pub(super) struct Point<L: Lanes> {
    pub(super) n: Vector<L>,
    /// From the positions of A and B to the point.
    pub(super) arms: [Vector<L>; 2],
    pub(super) separation: L::Wide,
    pub(super) feature: L::Wide,
}

impl<L: Lanes> Point<L> {
    /// This point where `m` says yes, else another one.
    #[inline(always)]
    pub(super) fn or(self, lanes: L, m: L::Mask, point: Self) -> Self {
        Self {
            n: select(lanes, m, self.n, point.n),
            arms: [select(lanes, m, self.arms[0], point.arms[0]), select(lanes, m, self.arms[1], point.arms[1])],
            separation: lanes.select(m, self.separation, point.separation),
            feature: lanes.select(m, self.feature, point.feature),
        }
    }

    /// True where the separation is beyond half a metre: products with it are too wide.
    #[inline(always)]
    pub(super) fn is_wide(&self, lanes: L) -> L::Mask {
        lanes.greater(lanes.magnitude(self.separation), lanes.all((1 << 31) - 1))
    }

    /// Writes the point, as it is seen with A and B swapped where `is_swapped` says yes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn store(
        &self,
        lanes: L,
        ways: [&Way<L>; 2],
        is_swapped: Option<L::Mask>,
        manifolds: &mut LaneManifolds,
        [end, at]: [usize; 2],
    ) {
        // Arms to the surface of each body: an open gap closes within the step.
        let mut half = half_gap(lanes, self.n, self.separation);
        let mut arms = [minus(lanes, self.arms[0], half), plus(lanes, self.arms[1], half)];
        let start = lanes.add(self.separation, closed(lanes, self.n, ways, arms));
        let mut feature = self.feature;
        if let Some(is_swapped) = is_swapped {
            let bits = lanes.all(12);
            let second = lanes.floored::<12>(feature);
            let first = lanes.sub(feature, lanes.raised_by(second, bits));
            feature = lanes.select(is_swapped, lanes.add(second, lanes.raised_by(first, bits)), feature);
            arms = [select(lanes, is_swapped, arms[1], arms[0]), select(lanes, is_swapped, arms[0], arms[1])];
            half = [lanes.negated(is_swapped, half[0]), lanes.negated(is_swapped, half[1])];
        }
        for axis in 0..2 {
            lanes.store(&mut manifolds.arms[end][0][axis], at, arms[0][axis]);
            lanes.store(&mut manifolds.arms[end][1][axis], at, arms[1][axis]);
            lanes.store(&mut manifolds.halves[end][axis], at, half[axis]);
        }
        lanes.store(&mut manifolds.separations[end], at, self.separation);
        lanes.store(&mut manifolds.starts[end], at, start);
        lanes.store(&mut manifolds.features[end], at, feature);
    }
}

/// The radii of two cores, and masks of the lanes in which the first and the second one are discs.
pub(super) struct Rounding<L: Lanes> {
    pub(super) radii: [L::Wide; 2],
    pub(super) are_discs: [L::Mask; 2],
}

/// The corners of A and B moved to the middle between the surfaces, for a separation of the cores.
#[cfg_attr(not(debug_assertions), inline(always))]
fn middles<L: Lanes>(
    lanes: L,
    n: Vector<L>,
    [a, b]: [Vector<L>; 2],
    separation: L::Wide,
    rounding: Option<&Rounding<L>>,
) -> [Vector<L>; 2] {
    let Some(Rounding { radii: [radius_a, radius_b], .. }) = rounding else {
        let half = [
            lanes.rounded_oddly::<31>(product(lanes, n[0], separation)),
            lanes.rounded_oddly::<31>(product(lanes, n[1], separation)),
        ];
        return [plus(lanes, a, half), minus(lanes, b, half)];
    };
    let difference = lanes.sub(*radius_a, *radius_b);
    let (twice_a, twice_b) = (lanes.add(separation, difference), lanes.sub(separation, difference));
    [moved(lanes, a, n, twice_a), moved_back(lanes, b, n, twice_b)]
}

/// The point at an end of the overlap of two edges, and a mask of the lanes in which the separations at the ends of the edge across from the
/// corner differ by half a metre.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn end_of_overlap<L: Lanes>(
    lanes: L,
    offset: Vector<L>,
    facing: &Facing<L>,
    rounding: Option<&Rounding<L>>,
    end: usize,
) -> (Point<L>, L::Mask) {
    let Facing { n, a, b, .. } = facing;
    let (corner_a, corner_b) = (a.corners[end], b.corners[end]);
    let (far_a, far_b) = (a.corners[1 - end], b.corners[1 - end]);
    // The inner one of the two ends is across from the other edge.
    let mut is_both = lanes.equal(a.places[end], b.places[end]);
    let (inner, outer) = if end == 0 { (a, b) } else { (b, a) };
    let mut is_a = lanes.greater(inner.places[end], outer.places[end]);
    let [number_a, number_b] = [a.numbers[end], b.numbers[end]];
    let mut parts = [[number_a; 2], [number_b; 2]];
    if let Some(Rounding { are_discs: [is_disc_a, is_disc_b], .. }) = rounding {
        // A disc is over the edge at both ends of it.
        is_both = lanes.unless(is_both, lanes.either(*is_disc_a, *is_disc_b));
        is_a = lanes.unless(lanes.either(is_a, *is_disc_a), *is_disc_b);
        parts[0] = select(lanes, *is_disc_b, a.numbers, parts[0]);
        parts[1] = select(lanes, *is_disc_a, [b.numbers[1], b.numbers[0]], parts[1]);
    }
    let corner_height = height(lanes, *n, minus(lanes, plus(lanes, corner_b, offset), corner_a));
    let [from, to] = [select(lanes, is_a, corner_a, far_a), select(lanes, is_a, far_b, corner_b)];
    let edge_height = height(lanes, *n, minus(lanes, plus(lanes, to, offset), from));
    let heights = if end == 0 { [corner_height, edge_height] } else { [edge_height, corner_height] };
    let difference = lanes.sub(heights[1], heights[0]);
    let size = lanes.magnitude(difference);
    // An edge square to n is flat but for rounding.
    let is_tilted = lanes.unless(lanes.greater(size, lanes.all(4)), is_both);
    let is_steep = lanes.both(is_tilted, lanes.greater(size, lanes.all((1 << 31) - 1)));
    let place = lanes.select(is_a, a.places[end], b.places[end]);
    let span = select(lanes, is_a, b.places, a.places);
    let before = lanes.floored::<30>(lanes.sub(place, span[0]));
    let after = lanes.floored::<30>(lanes.sub(span[1], place));
    let part = part(lanes, lanes.unless(is_tilted, is_steep), difference, before, lanes.add(before, after));
    let mean = lanes.floored::<1>(lanes.add(heights[0], heights[1]));
    let flat = lanes.select(is_both, corner_height, mean);
    let distance = lanes.select(is_tilted, lanes.add(heights[0], part), flat);
    let [from_a, from_b] = middles(lanes, *n, [corner_a, corner_b], distance, rounding);
    let mut arms = [from_a, from_b];
    for axis in 0..2 {
        // From either body: the same point but for rounding.
        let (same_a, same_b) = (lanes.add(from_b[axis], offset[axis]), lanes.sub(from_a[axis], offset[axis]));
        let shift = lanes.rounded_oddly::<1>(lanes.sub(same_a, from_a[axis]));
        let arm_a = lanes.select(is_a, from_a[axis], same_a);
        let arm_b = lanes.select(is_a, same_b, from_b[axis]);
        arms[0][axis] = lanes.select(is_both, lanes.add(from_a[axis], shift), arm_a);
        arms[1][axis] = lanes.select(is_both, lanes.sub(from_b[axis], shift), arm_b);
    }
    let separation = match rounding {
        Some(Rounding { radii: [radius_a, radius_b], .. }) => lanes.sub(lanes.sub(distance, *radius_a), *radius_b),
        None => distance,
    };
    let six = lanes.all(6);
    let [first, second] = [
        lanes.add(parts[0][0], lanes.raised_by(parts[0][1], six)),
        lanes.add(parts[1][0], lanes.raised_by(parts[1][1], six)),
    ];
    let feature = lanes.add(first, lanes.raised_by(second, lanes.all(12)));
    (Point { n: *n, arms, separation, feature }, is_steep)
}
