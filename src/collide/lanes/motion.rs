//! The motions of bodies over a step, and the distances that they close.

use super::super::margin::MARGIN_MAX;
use super::vector::{Vector, cross, dot, minus, product};
use crate::kernel::simd::{GROUP, Lanes, Line};

/// The motion of a body over a step, and its way from the start to the moment of the manifold.
pub(super) struct Motion<L: Lanes> {
    /// The displacement in the step, and a bound of the way that the rotation adds, ulps.
    displacement: Vector<L>,
    turned: L::Wide,
    pub(super) way: Way<L>,
    /// True where products with the way take more than 64 bits.
    pub(super) is_long: L::Mask,
}

/// The way of a body from the start to the moment of the manifold, in ulps and 2^-32 rad.
pub(super) struct Way<L: Lanes> {
    displacement: Vector<L>,
    rotation: L::Wide,
}

impl<L: Lanes> Way<L> {
    /// The way of a point of the body along a normal, in 2^-62 m: n·(d + φ × r), with the lever rounded to 2^-28 m, oddly.
    #[inline(always)]
    fn along_row(&self, lanes: L, n: Vector<L>, arm: Vector<L>) -> L::Wide {
        let arm = [lanes.rounded_oddly::<4>(arm[0]), lanes.rounded_oddly::<4>(arm[1])];
        let lever = lanes.rounded_oddly::<30>(cross(lanes, arm, [n[0], n[1]]));
        let turned = lanes.raised_by(product(lanes, lever, self.rotation), lanes.all(2));
        lanes.add(dot(lanes, n, self.displacement), turned)
    }
}

impl<L: Lanes> Motion<L> {
    /// The motion of a body with corners up to this extent.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn load(lanes: L, motions: &[Line], index: &[u32; GROUP], extent: L::Wide, at: usize) -> Self {
        let [x, y, turned, way_x, way_y, rotation, ..] = lanes.words_of(motions, index, at);
        let angle = lanes.magnitude(rotation);
        let is_far = lanes.greater(lanes.largest([way_x, way_y]), lanes.all((1 << 30) - 1));
        let is_turned = lanes.both(lanes.greater(extent, lanes.all((1 << 34) - 1)), lanes.greater(angle, lanes.all(0)));
        let is_turned = lanes.either(is_turned, lanes.greater(angle, lanes.all((1 << 28) - 1)));
        Self {
            displacement: [x, y],
            turned,
            way: Way { displacement: [way_x, way_y], rotation },
            is_long: lanes.either(is_far, is_turned),
        }
    }

    /// Bounds of the largest separation that is within a margin and the distance that two bodies close, from below and from above: as
    /// [`Margin`](super::super::Margin) has them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn limits(&self, lanes: L, motion: &Self, margin: L::Wide) -> [L::Wide; 2] {
        let way = minus(lanes, motion.displacement, self.displacement);
        let (x, y) = (lanes.magnitude(way[0]), lanes.magnitude(way[1]));
        let lower = lanes.add(lanes.add(margin, lanes.larger(x, y)), lanes.add(self.turned, motion.turned));
        let upper = lanes.add(lower, lanes.floored::<1>(lanes.smaller(x, y)));
        let cap = lanes.all(MARGIN_MAX);
        [lanes.smaller(lower, cap), lanes.smaller(upper, cap)]
    }
}

/// Half of an open gap along the normal, each component to nearest, ties away from zero. *Domain* a gap below 2^31 ulps.
#[inline(always)]
pub(super) fn half_gap<L: Lanes>(lanes: L, n: Vector<L>, separation: L::Wide) -> Vector<L> {
    let gap = lanes.positive(separation);
    [lanes.rounded_oddly::<31>(product(lanes, n[0], gap)), lanes.rounded_oddly::<31>(product(lanes, n[1], gap))]
}

/// The distance that the surfaces at the ends of two arms close up to the moment of the manifold, rounded up to ulps, as a negative one.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn closed<L: Lanes>(lanes: L, n: Vector<L>, ways: [&Way<L>; 2], arms: [Vector<L>; 2]) -> L::Wide {
    let (a, b) = (ways[0].along_row(lanes, n, arms[0]), ways[1].along_row(lanes, n, arms[1]));
    lanes.floored::<30>(lanes.sub(a, b))
}
