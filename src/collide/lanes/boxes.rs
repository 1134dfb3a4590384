//! Pairs of boxes: the manifolds that [`boxes`](super::super::boxes) finds, by the same integers.

use super::direction::{Frame, Rectangle, Units, find_direction, gap};
use super::facing::find_facing;
use super::motion::Motion;
use super::point::end_of_overlap;
use super::vector::{minus, not, plus};
use super::{LaneManifolds, LanePairs, Tables};
use crate::kernel::simd::Lanes;

/// Collides the pairs of the lanes from `at` on.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn collide<L: Lanes>(
    lanes: L,
    tables: &Tables<'_>,
    pairs: &LanePairs,
    manifolds: &mut LaneManifolds,
    at: usize,
) {
    let a = Rectangle::load(lanes, tables.outlines, &pairs.outlines[0], at);
    let b = Rectangle::load(lanes, tables.outlines, &pairs.outlines[1], at);
    let motion_a = Motion::load(lanes, tables.motions, &pairs.motions[0], a.extent, at);
    let motion_b = Motion::load(lanes, tables.motions, &pairs.motions[1], b.extent, at);
    let offset = minus(lanes, b.position, a.position);
    let frame = Frame::new(lanes, offset, lanes.add(a.extent, b.extent), lanes.smaller(a.extent, b.extent));
    let (offset, unit) = (frame.offset, &frame.unit);
    let units = Units {
        a: [unit.vector(lanes, a.corners[0]), unit.vector(lanes, a.corners[1])],
        b: [unit.vector(lanes, b.corners[0]), unit.vector(lanes, b.corners[1])],
        offset: unit.vector(lanes, offset),
    };
    let direction = find_direction(lanes, &a, &b, &units);
    let [lower, upper] = motion_a.limits(lanes, &motion_b, lanes.all(tables.margin));
    let gap = gap(lanes, offset, plus(lanes, a.reach, b.reach));
    let is_apart = frame.is_beyond(lanes, gap, direction.separation, upper);
    let may_be_apart = frame.is_beyond(lanes, gap, direction.separation, lower);
    let facing = find_facing(lanes, &a, &b, &units, unit, direction);
    let mut undecided = lanes.either(facing.undecided, may_be_apart);
    let mut is_there = [is_apart; 2];
    for (end, is_there) in is_there.iter_mut().enumerate() {
        let (point, is_steep) = end_of_overlap(lanes, offset, &facing, None, end);
        point.store(lanes, [&motion_a.way, &motion_b.way], None, manifolds, [end, at]);
        let is_beyond = lanes.greater(point.separation, upper);
        let may_be_beyond = lanes.either(point.is_wide(lanes), lanes.greater(point.separation, lower));
        undecided = lanes.either(undecided, lanes.unless(may_be_beyond, is_beyond));
        undecided = lanes.either(undecided, is_steep);
        *is_there = lanes.unless(not(lanes, is_beyond), is_apart);
    }
    // The deepest corner is the point where no end of the overlap is near enough.
    undecided = lanes.either(undecided, not(lanes, lanes.either(is_there[0], is_there[1])));
    undecided = lanes.either(undecided, lanes.either(motion_a.is_long, motion_b.is_long));
    undecided = lanes.either(frame.undecided, lanes.unless(undecided, is_apart));
    manifolds.finish(lanes, facing.n, undecided, is_there, at);
}
