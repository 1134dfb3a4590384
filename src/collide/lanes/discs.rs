//! Pairs of discs: the manifolds between their centres.

use super::corners::Corners;
use super::direction::near_offset;
use super::motion::Motion;

use super::vector::{Vector, minus, not};
use super::{LaneManifolds, LanePairs, Tables};
use crate::kernel::simd::{GROUP, Lanes, Line};

/// A disc: its centre relative to the position of its body.
pub(super) struct Disc<L: Lanes> {
    pub(super) centre: Vector<L>,
    pub(super) radius: L::Wide,
    pub(super) position: Vector<L>,
    /// The largest coordinate of the centre.
    pub(super) extent: L::Wide,
}

impl<L: Lanes> Disc<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn load(lanes: L, lines: &[Line], index: &[u32; GROUP], at: usize) -> Self {
        let [cx, cy, _, _, radius, _, x, y] = lanes.words_of(lines, index, at);
        Self { centre: [cx, cy], radius, position: [x, y], extent: lanes.largest([cx, cy]) }
    }
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
    let a = Disc::load(lanes, tables.outlines, &pairs.outlines[0], at);
    let b = Disc::load(lanes, tables.outlines, &pairs.outlines[1], at);
    let motion_a = Motion::load(lanes, tables.motions, &pairs.motions[0], lanes.add(a.extent, a.radius), at);
    let motion_b = Motion::load(lanes, tables.motions, &pairs.motions[1], lanes.add(b.extent, b.radius), at);
    let offset = minus(lanes, b.position, a.position);
    let (offset, is_distant) = near_offset(lanes, offset, lanes.add(a.extent, b.extent));
    let corners = Corners { corners: [a.centre, b.centre], offset, radii: [a.radius, b.radius] };
    let (point, is_asked) = corners.between(lanes, not(lanes, is_distant));
    let [lower, upper] = motion_a.limits(lanes, &motion_b, lanes.all(tables.margin));
    let is_there = lanes.unless(is_asked, lanes.greater(point.separation, upper));
    let may_be_there = lanes.greater(point.separation, lower);
    let mut undecided = lanes.either(may_be_there, point.is_wide(lanes));
    undecided = lanes.either(undecided, lanes.either(motion_a.is_long, motion_b.is_long));
    undecided = lanes.either(is_distant, lanes.both(undecided, is_there));
    manifolds.finish(lanes, point.n, undecided, [is_there, lanes.unless(is_there, is_there)], at);
    point.store(lanes, [&motion_a.way, &motion_b.way], None, manifolds, [0, at]);
}
