//! Pairs of boxes: the manifolds that [`boxes`](super::super::boxes) finds, by the same integers.

use super::direction::{Rectangle, Unit, Units, find_direction};
use super::facing::find_facing;
use super::motion::Motion;
use super::point::Point;
use super::vector::{largest_of, minus, not, plus};
use super::{LaneManifolds, LanePairs};
use crate::kernel::simd::{GROUP, Job, Lanes, Line};

/// Finds the manifolds of pairs, group by group.
pub(in crate::collide) struct CollideBoxes<'a> {
    /// By box: the first two corners relative to the position, in ulps; the first normal; the position.
    pub(in crate::collide) boxes: &'a [Line],
    /// By body: the displacement in the step, a bound of the way that the rotation adds, in ulps; the way to the moment of the manifold, in
    /// ulps and 2^-32 rad.
    pub(in crate::collide) motions: &'a [Line],
    /// Boxes have a manifold if they are nearer than this and the distance that they close, ulps.
    pub(in crate::collide) margin: i64,
    pub(in crate::collide) pairs: &'a [LanePairs],
    pub(in crate::collide) manifolds: &'a mut [LaneManifolds],
}

impl Job for CollideBoxes<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { boxes, motions, margin, pairs, manifolds } = self;
        let margin = lanes.all(margin);
        for (pairs, manifolds) in pairs.iter().zip(manifolds) {
            manifolds.clear();
            for at in (0..GROUP).step_by(L::WIDTH) {
                let a = Rectangle::load(lanes, boxes, &pairs.outlines[0], at);
                let b = Rectangle::load(lanes, boxes, &pairs.outlines[1], at);
                let motion_a = Motion::load(lanes, motions, &pairs.motions[0], a.extent, at);
                let motion_b = Motion::load(lanes, motions, &pairs.motions[1], b.extent, at);
                collide(lanes, [&a, &b], [&motion_a, &motion_b], margin, manifolds, at);
            }
        }
    }
}

/// Collides the pairs of the lanes from `at` on.
#[inline(always)]
fn collide<L: Lanes>(
    lanes: L,
    [a, b]: [&Rectangle<L>; 2],
    motions: [&Motion<L>; 2],
    margin: L::Wide,
    manifolds: &mut LaneManifolds,
    at: usize,
) {
    let zero = lanes.all(0);
    let offset = minus(lanes, b.position, a.position);
    let distance = largest_of(lanes, offset);
    let is_distant = lanes.greater(lanes.add(lanes.add(distance, a.extent), b.extent), lanes.all((1 << 55) - 1));
    let offset = [lanes.select(is_distant, zero, offset[0]), lanes.select(is_distant, zero, offset[1])];
    let total = lanes.add(lanes.add(a.extent, b.extent), largest_of(lanes, offset));
    let k = lanes.positive(lanes.sub(lanes.bit_length(total), lanes.all(30)));
    let finest = lanes.floored::<25>(lanes.smaller(a.extent, b.extent));
    let is_coarse = lanes.both(lanes.greater(k, zero), lanes.greater(lanes.raised_by(lanes.all(1), k), finest));
    let [lower, upper] = motions[0].limits(lanes, motions[1], margin);
    // The boxes around the boxes: farther apart than the limit they have no manifold.
    let reach = plus(lanes, a.reach, b.reach);
    let gap =
        lanes.larger(lanes.sub(lanes.magnitude(offset[0]), reach[0]), lanes.sub(lanes.magnitude(offset[1]), reach[1]));
    let unit = Unit::new(lanes, k);
    let units = Units {
        a: [unit.vector(lanes, a.corners[0]), unit.vector(lanes, a.corners[1])],
        b: [unit.vector(lanes, b.corners[0]), unit.vector(lanes, b.corners[1])],
        offset: unit.vector(lanes, offset),
    };
    let direction = find_direction(lanes, a, b, &units);
    // Nothing is above a limit of 2^33 units.
    let cap = lanes.sub(lanes.raised_by(lanes.all(1 << 33), k), lanes.all(1));
    let lower_product = unit.length(lanes, lanes.smaller(lower, cap));
    let upper_product = unit.length(lanes, lanes.smaller(upper, cap));
    let is_apart = lanes.either(lanes.greater(gap, upper), lanes.greater(direction.separation, upper_product));
    let may_be_apart = lanes.either(lanes.greater(gap, lower), lanes.greater(direction.separation, lower_product));
    let facing = find_facing(lanes, a, b, &units, &unit, direction);
    let mut undecided = lanes.either(facing.undecided, may_be_apart);
    let mut is_there = [is_apart; 2];
    for (end, is_there) in is_there.iter_mut().enumerate() {
        let point = Point::new(lanes, [a, b], [&motions[0].way, &motions[1].way], offset, &facing, end);
        point.store(lanes, manifolds, end, at);
        let is_beyond = lanes.greater(point.separation, upper);
        let may_be_beyond = lanes.either(point.is_wide, lanes.greater(point.separation, lower));
        undecided = lanes.either(undecided, lanes.unless(may_be_beyond, is_beyond));
        undecided = lanes.either(undecided, point.is_steep);
        *is_there = lanes.unless(not(lanes, is_beyond), is_apart);
    }
    // The deepest corner is the point where no end of the overlap is near enough.
    undecided = lanes.either(undecided, not(lanes, lanes.either(is_there[0], is_there[1])));
    undecided = lanes.either(undecided, lanes.either(motions[0].is_long, motions[1].is_long));
    undecided = lanes.either(lanes.either(is_distant, is_coarse), lanes.unless(undecided, is_apart));
    manifolds.finish(lanes, facing.n, undecided, is_there, at);
}
