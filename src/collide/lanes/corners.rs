//! The point between two corners.

use super::point::{Point, moved, moved_back};
use super::vector::{Vector, minus, plus};
use crate::kernel::simd::{GROUP, Lanes};
use crate::kernel::sqrt::direction;

/// Two corners, each relative to the position of its body, the offset of the positions, and the radii.
pub(super) struct Corners<L: Lanes> {
    pub(super) corners: [Vector<L>; 2],
    pub(super) offset: Vector<L>,
    pub(super) radii: [L::Wide; 2],
}

impl<L: Lanes> Corners<L> {
    /// The point between the corners, with feature 0, where `m` says yes and the corners are not at one place.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn between(&self, lanes: L, m: L::Mask) -> (Point<L>, L::Mask) {
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
        (Point { n, arms, separation, feature: zero }, is_there)
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
