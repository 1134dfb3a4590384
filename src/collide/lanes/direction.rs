//! Two boxes in one unit, and the direction in which they are farthest apart.

use super::vector::{Vector, dot, opposite};
use crate::kernel::simd::{GROUP, Lanes, Line};

/// The pair's unit: 2^k ulps.
pub(super) struct Unit<L: Lanes> {
    pub(super) k: L::Wide,
    /// Half of the unit.
    pub(super) half: L::Wide,
    /// −1 where the unit is more than an ulp.
    pub(super) rounding: L::Wide,
    /// The shift from ulps to products with normals.
    pub(super) up: L::Wide,
}

impl<L: Lanes> Unit<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, k: L::Wide) -> Self {
        let zero = lanes.all(0);
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), k));
        let rounding = lanes.select(lanes.greater(k, zero), lanes.all(-1), zero);
        Self { k, half, rounding, up: lanes.sub(lanes.all(30), k) }
    }

    /// A coordinate in ulps in this unit, to nearest, ties away from zero.
    #[inline(always)]
    pub(super) fn coordinate(&self, lanes: L, ulps: L::Wide) -> L::Wide {
        let down = lanes.select(lanes.greater(lanes.all(0), ulps), self.rounding, lanes.all(0));
        lanes.floored_by(lanes.add(lanes.add(ulps, self.half), down), self.k)
    }

    #[inline(always)]
    pub(super) fn vector(&self, lanes: L, ulps: Vector<L>) -> Vector<L> {
        [self.coordinate(lanes, ulps[0]), self.coordinate(lanes, ulps[1])]
    }

    /// A length in ulps as a product with a normal.
    #[inline(always)]
    pub(super) fn length(&self, lanes: L, ulps: L::Wide) -> L::Wide {
        lanes.raised_by(ulps, self.up)
    }
}

/// The offset from A to B in ulps, and the unit of a pair. The offset is zero where it is too large for lanes.
pub(super) struct Frame<L: Lanes> {
    pub(super) offset: Vector<L>,
    pub(super) unit: Unit<L>,
    /// True where the offset or the unit is too large.
    pub(super) undecided: L::Mask,
}

/// The offset of two outlines of which the corners reach as far as `extents` together, zero where it is too large for lanes; and a mask of
/// the lanes in which it is.
#[inline(always)]
pub(super) fn near_offset<L: Lanes>(lanes: L, offset: Vector<L>, extents: L::Wide) -> (Vector<L>, L::Mask) {
    let zero = lanes.all(0);
    let distance = lanes.add(lanes.largest(offset), extents);
    let is_distant = lanes.greater(distance, lanes.all((1 << 55) - 1));
    ([lanes.select(is_distant, zero, offset[0]), lanes.select(is_distant, zero, offset[1])], is_distant)
}

impl<L: Lanes> Frame<L> {
    /// The frame of two outlines of which the corners reach as far as `extents` together, and the smaller one as far as `smallest`.
    #[inline(always)]
    pub(super) fn new(lanes: L, offset: Vector<L>, extents: L::Wide, smallest: L::Wide) -> Self {
        let zero = lanes.all(0);
        let (offset, is_distant) = near_offset(lanes, offset, extents);
        let total = lanes.add(extents, lanes.largest(offset));
        let k = lanes.positive(lanes.sub(lanes.bit_length(total), lanes.all(30)));
        let is_coarse = lanes.greater(lanes.raised_by(lanes.all(1), k), lanes.floored::<25>(smallest));
        let is_coarse = lanes.both(lanes.greater(k, zero), is_coarse);
        Self { offset, unit: Unit::new(lanes, k), undecided: lanes.either(is_distant, is_coarse) }
    }

    /// True where the gap between boxes around both outlines, in ulps, or the separation along a normal, as a product with it, is beyond a
    /// limit in ulps.
    #[inline(always)]
    pub(super) fn is_beyond(&self, lanes: L, gap: L::Wide, separation: L::Wide, limit: L::Wide) -> L::Mask {
        // Nothing is above a limit of 2^33 units.
        let cap = lanes.sub(lanes.raised_by(lanes.all(1 << 33), self.unit.k), lanes.all(1));
        let limit_product = self.unit.length(lanes, lanes.smaller(limit, cap));
        lanes.either(lanes.greater(gap, limit), lanes.greater(separation, limit_product))
    }
}

/// The gap between the boxes around two outlines, for their offset and how far they reach together along x and y.
#[inline(always)]
pub(super) fn gap<L: Lanes>(lanes: L, offset: Vector<L>, reach: Vector<L>) -> L::Wide {
    let (x, y) = (lanes.magnitude(offset[0]), lanes.magnitude(offset[1]));
    lanes.larger(lanes.sub(x, reach[0]), lanes.sub(y, reach[1]))
}

/// A box: its first two corners in ulps and its first two normals, its position, and how far the corners reach along x, along y and in all.
pub(super) struct Rectangle<L: Lanes> {
    pub(super) corners: [Vector<L>; 2],
    pub(super) normals: [Vector<L>; 2],
    pub(super) position: Vector<L>,
    pub(super) reach: Vector<L>,
    pub(super) extent: L::Wide,
}

impl<L: Lanes> Rectangle<L> {
    #[inline(always)]
    pub(super) fn load(lanes: L, lines: &[Line], index: &[u32; GROUP], at: usize) -> Self {
        let [x1, y1, x2, y2, nx, ny, x, y] = lanes.words_of(lines, index, at);
        let reach = [lanes.largest([x1, x2]), lanes.largest([y1, y2])];
        Self {
            corners: [[x1, y1], [x2, y2]],
            normals: [[nx, ny], [lanes.sub(lanes.all(0), ny), nx]],
            position: [x, y],
            reach,
            extent: lanes.larger(reach[0], reach[1]),
        }
    }
}

/// Two boxes along a vector: the components of the first two corners of each, and of the offset from A to B.
pub(super) struct Along<L: Lanes> {
    pub(super) a: [L::Wide; 2],
    pub(super) b: [L::Wide; 2],
    pub(super) offset: L::Wide,
}

impl<L: Lanes> Along<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, n: Vector<L>, units: &Units<L>) -> Self {
        Self {
            a: [dot(lanes, n, units.a[0]), dot(lanes, n, units.a[1])],
            b: [dot(lanes, n, units.b[0]), dot(lanes, n, units.b[1])],
            offset: dot(lanes, n, units.offset),
        }
    }

    /// These components where `m` says yes, else others.
    #[inline(always)]
    pub(super) fn or(self, lanes: L, m: L::Mask, along: Self) -> Self {
        Self {
            a: [lanes.select(m, self.a[0], along.a[0]), lanes.select(m, self.a[1], along.a[1])],
            b: [lanes.select(m, self.b[0], along.b[0]), lanes.select(m, self.b[1], along.b[1])],
            offset: lanes.select(m, self.offset, along.offset),
        }
    }

    /// The components along the opposite vector where `m` says yes.
    #[inline(always)]
    pub(super) fn reversed(self, lanes: L, m: L::Mask) -> Self {
        Self {
            a: [lanes.negated(m, self.a[0]), lanes.negated(m, self.a[1])],
            b: [lanes.negated(m, self.b[0]), lanes.negated(m, self.b[1])],
            offset: lanes.negated(m, self.offset),
        }
    }
}

/// The first two corners of both boxes and the offset, in the pair's unit.
pub(super) struct Units<L: Lanes> {
    pub(super) a: [Vector<L>; 2],
    pub(super) b: [Vector<L>; 2],
    pub(super) offset: Vector<L>,
}

/// The direction of largest separation, with the boxes along it.
pub(super) struct Direction<L: Lanes> {
    pub(super) n: Vector<L>,
    pub(super) along: Along<L>,
    pub(super) separation: L::Wide,
    pub(super) undecided: L::Mask,
}

/// The larger one of the separations along a normal of a box and along its opposite, for the higher end of the normal's edge.
#[inline(always)]
pub(super) fn separation<L: Lanes>(lanes: L, offset: L::Wide, target: [L::Wide; 2], edge: [L::Wide; 2]) -> L::Wide {
    let distance = lanes.sub(lanes.magnitude(offset), lanes.largest(target));
    lanes.sub(distance, lanes.larger(edge[0], edge[1]))
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn find_direction<L: Lanes>(lanes: L, a: &Rectangle<L>, b: &Rectangle<L>, units: &Units<L>) -> Direction<L> {
    let zero = lanes.all(0);
    let normals = [a.normals[0], a.normals[1], b.normals[0], b.normals[1]];
    let first = Along::new(lanes, normals[0], units);
    let second = Along::new(lanes, normals[1], units);
    let third = Along::new(lanes, normals[2], units);
    let fourth = Along::new(lanes, normals[3], units);
    // The edge of the second normal goes on from the end of the first one's, to the corner opposite to the first.
    let separations = [
        separation(lanes, first.offset, first.b, first.a),
        separation(lanes, second.offset, second.b, [second.a[1], lanes.sub(zero, second.a[0])]),
        separation(lanes, third.offset, third.a, third.b),
        separation(lanes, fourth.offset, fourth.a, [fourth.b[1], lanes.sub(zero, fourth.b[0])]),
    ];
    let largest =
        lanes.larger(lanes.larger(separations[0], separations[1]), lanes.larger(separations[2], separations[3]));
    let is_first = lanes.equal(separations[0], largest);
    let is_second = lanes.equal(separations[1], largest);
    let is_third = lanes.equal(separations[2], largest);
    let mut along = third.or(lanes, is_third, fourth);
    along = second.or(lanes, is_second, along);
    along = first.or(lanes, is_first, along);
    let mut n = [zero; 2];
    for axis in 0..2 {
        let later = lanes.select(is_third, normals[2][axis], normals[3][axis]);
        let later = lanes.select(is_second, normals[1][axis], later);
        n[axis] = lanes.select(is_first, normals[0][axis], later);
    }
    let mut undecided = lanes.equal(along.offset, zero);
    for i in 1..4 {
        // Normals that tie are one direction if they are the same vector, or opposite.
        let same = lanes.both(lanes.equal(normals[i][0], n[0]), lanes.equal(normals[i][1], n[1]));
        let back = opposite(lanes, n);
        let reverse = lanes.both(lanes.equal(normals[i][0], back[0]), lanes.equal(normals[i][1], back[1]));
        let is_tied = lanes.equal(separations[i], largest);
        undecided = lanes.either(undecided, lanes.unless(is_tied, lanes.either(same, reverse)));
    }
    let is_back = lanes.greater(zero, along.offset);
    n = [lanes.negated(is_back, n[0]), lanes.negated(is_back, n[1])];
    Direction { n, along: along.reversed(lanes, is_back), separation: largest, undecided }
}
