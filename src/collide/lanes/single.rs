//! Manifolds of one point.

use super::LaneManifolds;
use super::motion::{Way, closed, half_gap};
use super::vector::{Vector, minus, plus, product, select};
use crate::kernel::simd::{GROUP, Lanes};
use crate::kernel::sqrt::direction;

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

/// The manifold of one point: in the middle between the surfaces of A and B.
pub(super) struct Single<L: Lanes> {
    pub(super) n: Vector<L>,
    /// From the positions of A and B to the point.
    pub(super) arms: [Vector<L>; 2],
    pub(super) separation: L::Wide,
    pub(super) feature: L::Wide,
}

impl<L: Lanes> Single<L> {
    /// This manifold where `m` says yes, else another one.
    #[inline(always)]
    pub(super) fn or(self, lanes: L, m: L::Mask, single: Self) -> Self {
        Self {
            n: select(lanes, m, self.n, single.n),
            arms: [select(lanes, m, self.arms[0], single.arms[0]), select(lanes, m, self.arms[1], single.arms[1])],
            separation: lanes.select(m, self.separation, single.separation),
            feature: lanes.select(m, self.feature, single.feature),
        }
    }

    /// True where the separation is beyond half a metre: products with it are too wide.
    #[inline(always)]
    pub(super) fn is_wide(&self, lanes: L) -> L::Mask {
        lanes.greater(lanes.magnitude(self.separation), lanes.all((1 << 31) - 1))
    }

    /// Writes the point, with A and B swapped where `is_swapped` says yes.
    #[inline(always)]
    pub(super) fn store(
        &self,
        lanes: L,
        ways: [&Way<L>; 2],
        is_swapped: L::Mask,
        manifolds: &mut LaneManifolds,
        at: usize,
    ) {
        let half = half_gap(lanes, self.n, self.separation);
        let arms = [minus(lanes, self.arms[0], half), plus(lanes, self.arms[1], half)];
        let start = lanes.add(self.separation, closed(lanes, self.n, ways, arms));
        let (low, high) = (lanes.raised_by(self.feature, lanes.all(12)), lanes.floored::<12>(self.feature));
        let swapped = lanes.sub(lanes.add(low, high), lanes.raised_by(high, lanes.all(24)));
        lanes.store(&mut manifolds.features[0], at, lanes.select(is_swapped, swapped, self.feature));
        for axis in 0..2 {
            let (arm_a, arm_b) = (arms[0][axis], arms[1][axis]);
            lanes.store(&mut manifolds.arms[0][0][axis], at, lanes.select(is_swapped, arm_b, arm_a));
            lanes.store(&mut manifolds.arms[0][1][axis], at, lanes.select(is_swapped, arm_a, arm_b));
            lanes.store(&mut manifolds.halves[0][axis], at, lanes.negated(is_swapped, half[axis]));
        }
        lanes.store(&mut manifolds.separations[0], at, self.separation);
        lanes.store(&mut manifolds.starts[0], at, start);
    }
}

/// Two corners, each relative to the position of its body, the offset of the positions, and the radii.
pub(super) struct Corners<L: Lanes> {
    pub(super) corners: [Vector<L>; 2],
    pub(super) offset: Vector<L>,
    pub(super) radii: [L::Wide; 2],
}

impl<L: Lanes> Corners<L> {
    /// The manifold of one point between the corners, with no feature, where `m` says yes and the corners are not at one place.
    #[inline(always)]
    pub(super) fn between(&self, lanes: L, m: L::Mask) -> (Single<L>, L::Mask) {
        let Self { corners: [a, b], offset, radii: [radius_a, radius_b] } = *self;
        let zero = lanes.all(0);
        let way = minus(lanes, plus(lanes, b, offset), a);
        let is_one_place = lanes.both(lanes.equal(way[0], zero), lanes.equal(way[1], zero));
        let is_there = lanes.unless(m, is_one_place);
        let (n, distance) = directions(lanes, is_there, way);
        let twice_a = lanes.add(distance, lanes.sub(radius_a, radius_b));
        let twice_b = lanes.add(distance, lanes.sub(radius_b, radius_a));
        let (from_a, from_b) = (moved(lanes, a, n, twice_a), moved_back(lanes, b, n, twice_b));
        // The same point but for rounding: the mean, from either side.
        let rest = minus(lanes, plus(lanes, from_b, offset), from_a);
        let shift = [lanes.rounded_oddly::<1>(rest[0]), lanes.rounded_oddly::<1>(rest[1])];
        let separation = lanes.sub(lanes.sub(distance, radius_a), radius_b);
        let arms = [plus(lanes, from_a, shift), minus(lanes, from_b, shift)];
        (Single { n, arms, separation, feature: zero }, is_there)
    }
}

/// The unit vectors along vectors and their lengths, where `m` says yes, and zeros elsewhere. *Domain* there the vectors are not zero.
#[inline(always)]
fn directions<L: Lanes>(lanes: L, m: L::Mask, way: Vector<L>) -> (Vector<L>, L::Wide) {
    let is_asked = lanes.bits(m);
    let [mut normal_x, mut normal_y, mut lengths] = [[0; GROUP]; 3];
    if is_asked != 0 {
        let [mut x, mut y] = [[0; GROUP]; 2];
        lanes.store(&mut x, 0, way[0]);
        lanes.store(&mut y, 0, way[1]);
        for lane in 0..L::WIDTH {
            if is_asked >> lane & 1 == 1 {
                let (normal, length) = direction(x[lane], y[lane]);
                (normal_x[lane], normal_y[lane]) = (normal[0].into(), normal[1].into());
                lengths[lane] = length as i64;
            }
        }
    }
    ([lanes.wide(&normal_x, 0), lanes.wide(&normal_y, 0)], lanes.wide(&lengths, 0))
}
