//! Pairs of polygons, sharp or rounded, with segments and discs among them: the manifolds of the general way, by the same integers. Cores
//! that overlap with no edges that face each other are left.

use super::corners::Corners;
use super::direction::{Frame, Unit};
use super::facing::{Ends, Facing};
use super::motion::Motion;
use super::point::{Point, Rounding, end_of_overlap};
use super::vector::{Vector, choose, cross, dot, minus, not, opposite, plus, select};
use super::{LaneManifolds, LanePairs, Polygons, Tables};
use crate::kernel::simd::{GROUP, Lanes};

/// A polygon, a segment or a disc, with room for `N` corners, a power of two: as [`Polygons`] has it.
struct Polygon<L: Lanes, const N: usize> {
    corners: [Vector<L>; N],
    normals: [Vector<L>; N],
    count: L::Wide,
    radius: L::Wide,
    position: Vector<L>,
    low: Vector<L>,
    high: Vector<L>,
    extent: L::Wide,
}

impl<L: Lanes, const N: usize> Polygon<L, N> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load(lanes: L, polygons: &Polygons, index: &[u32; GROUP], at: usize) -> Self {
        let [size, radius, x, y, low_x, low_y, high_x, high_y] = lanes.words_of(&polygons.heads, index, at);
        let zero = lanes.all(0);
        let (mut corners, mut normals) = ([[zero; 2]; N], [[zero; 2]; N]);
        for (half, lines) in polygons.corners.iter().enumerate().take(N / 4) {
            let words = lanes.words_of(lines, index, at);
            for i in 0..4 {
                corners[4 * half + i] = [words[2 * i], words[2 * i + 1]];
            }
        }
        let words = lanes.words_of(&polygons.normals, index, at);
        for i in 0..N {
            let x = lanes.floored::<32>(lanes.raised_by(words[i], lanes.all(32)));
            normals[i] = [x, lanes.floored::<32>(words[i])];
        }
        let (low, high) = ([low_x, low_y], [high_x, high_y]);
        Self {
            corners,
            normals,
            count: size,
            radius,
            position: [x, y],
            low,
            high,
            extent: lanes.larger(lanes.largest(low), lanes.largest(high)),
        }
    }

    /// True for a disc.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_disc(&self, lanes: L) -> L::Mask {
        lanes.equal(self.count, lanes.all(1))
    }

    /// The corners in a unit, shifted.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn units(&self, lanes: L, unit: &Unit<L>, shift: Vector<L>) -> [Vector<L>; N] {
        let mut units = [shift; N];
        for (place, corner) in units.iter_mut().zip(self.corners) {
            *place = plus(lanes, unit.vector(lanes, corner), shift);
        }
        units
    }
}

/// The direction of largest separation.
struct Best<L: Lanes> {
    n: Vector<L>,
    separation: L::Wide,
    /// The largest separation along other normals.
    second: L::Wide,
    /// True where two normals have the same separation.
    is_tied: L::Mask,
}

impl<L: Lanes> Best<L> {
    /// Goes through the separations of a core along the normals of a polygon: A, or B if `is_b` says so.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add_faces<const N: usize>(
        &mut self,
        lanes: L,
        polygon: &Polygon<L, N>,
        units: &[Vector<L>; N],
        core: &[Vector<L>; N],
        is_b: bool,
    ) {
        let zero = lanes.all(0);
        // A disc has no normal.
        let faces = lanes.select(polygon.is_disc(lanes), zero, polygon.count);
        for i in 0..N {
            let n = polygon.normals[i];
            let mut lowest = dot(lanes, n, core[0]);
            for corner in &core[1..] {
                lowest = lanes.smaller(lowest, dot(lanes, n, *corner));
            }
            let height = lanes.larger(dot(lanes, n, units[i]), dot(lanes, n, units[(i + 1) & (N - 1)]));
            let is_face = lanes.greater(faces, lanes.all(i as i64));
            let separation = lanes.select(is_face, lanes.sub(lowest, height), lanes.all(i64::MIN));
            let is_larger = lanes.greater(separation, self.separation);
            let is_equal = lanes.equal(separation, self.separation);
            self.second = lanes.larger(self.second, lanes.smaller(separation, self.separation));
            let n = if is_b { opposite(lanes, n) } else { n };
            let is_other = not(lanes, lanes.both(lanes.equal(n[0], self.n[0]), lanes.equal(n[1], self.n[1])));
            self.is_tied = lanes.either(lanes.unless(self.is_tied, is_larger), lanes.both(is_equal, is_other));
            self.n = select(lanes, is_larger, n, self.n);
            self.separation = lanes.select(is_larger, separation, self.separation);
        }
    }
}

/// The edge of a core that faces along a direction, in counter-clockwise order; of a disc its centre twice.
struct Side<L: Lanes> {
    corners: [Vector<L>; 2],
    numbers: [L::Wide; 2],
    /// Along the direction turned by a quarter, relative to the position of the body.
    places: [L::Wide; 2],
    /// True where one corner is farthest out, and where that is the end of the edge.
    is_corner: L::Mask,
    is_end: L::Mask,
    /// The height of the corner that is farthest out.
    height: L::Wide,
    undecided: L::Mask,
}

impl<L: Lanes> Side<L> {
    /// The first and the last of the corners that are farthest out, of the values at the ends of the edge.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn support(&self, lanes: L, [start, end]: [L::Wide; 2]) -> [L::Wide; 2] {
        let is_start = lanes.unless(self.is_corner, self.is_end);
        let is_end = lanes.both(self.is_corner, self.is_end);
        [lanes.select(is_end, end, start), lanes.select(is_start, start, end)]
    }

    /// The first of the corners that are farthest out where `is_first` says yes, else the last, of the values at the ends of the edge.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn nearest(&self, lanes: L, is_first: L::Mask, values: [L::Wide; 2]) -> L::Wide {
        let [first, last] = self.support(lanes, values);
        lanes.select(is_first, first, last)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn nearest_corner(&self, lanes: L, is_first: L::Mask) -> Vector<L> {
        let [[start_x, start_y], [end_x, end_y]] = self.corners;
        [self.nearest(lanes, is_first, [start_x, end_x]), self.nearest(lanes, is_first, [start_y, end_y])]
    }
}

/// The edge of a polygon that faces along `w`: the edge between two corners that are farthest out, or of the two edges beside one corner the
/// one whose normal is nearer.
#[cfg_attr(not(debug_assertions), inline(always))]
fn find_side<L: Lanes, const N: usize>(
    lanes: L,
    polygon: &Polygon<L, N>,
    units: &[Vector<L>; N],
    w: Vector<L>,
    unit: &Unit<L>,
) -> Side<L> {
    let (zero, single) = (lanes.all(0), lanes.all(1));
    let mut heights = [zero; N];
    let mut height = dot(lanes, w, units[0]);
    heights[0] = height;
    for i in 1..N {
        heights[i] = dot(lanes, w, units[i]);
        height = lanes.larger(height, heights[i]);
    }
    let slack = lanes.add(lanes.raised_by(lanes.all(3), unit.k), lanes.floored::<29>(polygon.extent));
    let least = lanes.sub(height, unit.length(lanes, slack));
    // The corners that are as far out within rounding.
    let (mut first, mut last, mut members) = (lanes.all(N as i64), zero, zero);
    for (i, &corner_height) in heights.iter().enumerate() {
        let number = lanes.all(i as i64);
        let is_in = lanes.unless(lanes.greater(polygon.count, number), lanes.greater(least, corner_height));
        first = lanes.select(is_in, lanes.smaller(first, number), first);
        last = lanes.select(is_in, number, last);
        members = lanes.add(members, lanes.select(is_in, single, zero));
    }
    let end = lanes.sub(polygon.count, single);
    let is_corner = lanes.equal(members, single);
    let is_wrapped = lanes.both(lanes.equal(first, zero), lanes.equal(last, end));
    let are_neighbours = lanes.either(lanes.equal(last, lanes.add(first, single)), is_wrapped);
    let are_two = lanes.both(lanes.equal(members, lanes.all(2)), are_neighbours);
    // Beside a corner alone, the edge whose normal is nearer.
    let (mut normal, mut normal_before) = (polygon.normals[0], polygon.normals[N - 1]);
    for i in 1..N {
        let is_here = lanes.equal(first, lanes.all(i as i64));
        normal = select(lanes, is_here, polygon.normals[i], normal);
        normal_before = select(lanes, is_here, polygon.normals[i - 1], normal_before);
    }
    let turn = lanes.add(cross(lanes, w, normal), cross(lanes, w, normal_before));
    let before = lanes.select(lanes.equal(first, zero), end, lanes.sub(first, single));
    let edge_of_corner = lanes.select(lanes.greater(turn, zero), before, first);
    let edge = lanes.select(is_corner, edge_of_corner, lanes.select(is_wrapped, last, first));
    // A segment has its ends in order of place.
    let across = [lanes.sub(zero, w[1]), w[0]];
    let is_segment = lanes.equal(polygon.count, lanes.all(2));
    let is_reversed = lanes.greater(dot(lanes, across, units[0]), dot(lanes, across, units[1]));
    let edge = lanes.select(is_segment, lanes.select(is_reversed, single, zero), edge);
    let mut corners = [polygon.corners[0], polygon.corners[1]];
    for i in 1..N {
        let is_here = lanes.equal(edge, lanes.all(i as i64));
        corners[0] = select(lanes, is_here, polygon.corners[i], corners[0]);
        corners[1] = select(lanes, is_here, polygon.corners[(i + 1) & (N - 1)], corners[1]);
    }
    let next = lanes.select(lanes.equal(edge, end), zero, lanes.add(edge, single));
    let numbers = [edge, next];
    let is_level = lanes.unless(lanes.both(is_corner, lanes.equal(turn, zero)), is_segment);
    let places =
        [dot(lanes, across, unit.vector(lanes, corners[0])), dot(lanes, across, unit.vector(lanes, corners[1]))];
    let is_loose = lanes.either(is_level, not(lanes, lanes.greater(places[1], places[0])));
    let are_neighbours = lanes.either(is_segment, are_two);
    let undecided = lanes.either(is_loose, not(lanes, lanes.either(is_corner, are_neighbours)));
    let undecided = lanes.unless(undecided, polygon.is_disc(lanes));
    Side { corners, numbers, places, is_corner, is_end: lanes.equal(first, next), height, undecided }
}

/// Collides the pairs of the lanes from `at` on, of outlines of at most `N` corners.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn collide<L: Lanes, const N: usize>(
    lanes: L,
    tables: &Tables<'_>,
    pairs: &LanePairs,
    manifolds: &mut LaneManifolds,
    at: usize,
) {
    let zero = lanes.all(0);
    let a = Polygon::<L, N>::load(lanes, tables.polygons, &pairs.outlines[0], at);
    let b = Polygon::<L, N>::load(lanes, tables.polygons, &pairs.outlines[1], at);
    let (reach_a, reach_b) = (lanes.add(a.extent, a.radius), lanes.add(b.extent, b.radius));
    let motion_a = Motion::load(lanes, tables.motions, &pairs.motions[0], reach_a, at);
    let motion_b = Motion::load(lanes, tables.motions, &pairs.motions[1], reach_b, at);
    let offset = minus(lanes, b.position, a.position);
    let frame = Frame::new(lanes, offset, lanes.add(a.extent, b.extent), lanes.smaller(reach_a, reach_b));
    let (offset, unit) = (frame.offset, &frame.unit);
    let units_a = a.units(lanes, unit, [zero; 2]);
    let units_b = b.units(lanes, unit, unit.vector(lanes, offset));
    let least = lanes.all(i64::MIN);
    let mut best = Best { n: [zero; 2], separation: least, second: least, is_tied: lanes.greater(zero, zero) };
    best.add_faces(lanes, &a, &units_a, &units_b, false);
    best.add_faces(lanes, &b, &units_b, &units_a, true);
    let n = best.n;
    let [lower, upper] = motion_a.limits(lanes, &motion_b, lanes.all(tables.margin));
    let radii = lanes.add(a.radius, b.radius);
    let gap = gap(lanes, &a, &b, offset);
    let is_apart = frame.is_beyond(lanes, gap, best.separation, lanes.add(upper, radii));
    let may_be_apart = frame.is_beyond(lanes, gap, best.separation, lanes.add(lower, radii));
    if lanes.bits(lanes.either(frame.undecided, not(lanes, is_apart))) == 0 {
        return;
    }
    let side_a = find_side(lanes, &a, &units_a, n, unit);
    let side_b = find_side(lanes, &b, &units_b, opposite(lanes, n), unit);
    let chosen = Chosen { n, a: &side_a, b: &side_b, discs: [a.is_disc(lanes), b.is_disc(lanes)] };
    let (facing, places) = chosen.facing(lanes, unit, offset);
    // Far corners next to each other have the direction between them.
    let far = unit.length(lanes, lanes.floored::<11>(lanes.smaller(a.extent, b.extent)));
    let far = lanes.select(lanes.greater(radii, zero), zero, far);
    let separation = lanes.sub(zero, lanes.add(side_a.height, side_b.height));
    let beside = chosen.beside(lanes, places);
    let is_at_corners = lanes.both(lanes.greater(separation, far), beside.is_open);
    let rounding = Rounding { radii: [a.radius, b.radius], are_discs: chosen.discs };
    let corners = Corners { corners: beside.corners, offset, radii: rounding.radii };
    let (between, is_between) = corners.between(lanes, lanes.unless(is_at_corners, is_apart));
    let between = Point { feature: beside.feature, ..between };
    // Where another direction is as good but for rounding, edges that face each other along it count before corners.
    let slack = lanes.floored::<28>(lanes.larger(a.extent, b.extent));
    let slack = unit.length(lanes, lanes.add(lanes.raised_by(lanes.all(8), unit.k), slack));
    let has_rival = not(lanes, lanes.greater(lanes.sub(best.separation, slack), best.second));
    let mut undecided = choose(lanes, is_at_corners, has_rival, facing.undecided);
    undecided = lanes.either(undecided, lanes.either(side_a.undecided, side_b.undecided));
    undecided = lanes.either(undecided, lanes.either(best.is_tied, may_be_apart));
    let ways = [&motion_a.way, &motion_b.way];
    let (first, is_steep) = end_of_overlap(lanes, offset, &facing, Some(&rounding), 0);
    undecided = lanes.either(undecided, lanes.unless(is_steep, is_at_corners));
    let first = between.or(lanes, is_at_corners, first);
    first.store(lanes, ways, None, manifolds, [0, at]);
    let (second, is_steep) = end_of_overlap(lanes, offset, &facing, Some(&rounding), 1);
    undecided = lanes.either(undecided, lanes.unless(is_steep, is_at_corners));
    second.store(lanes, ways, None, manifolds, [1, at]);
    let is_single = lanes.either(is_at_corners, lanes.either(chosen.discs[0], chosen.discs[1]));
    let mut is_there = [is_apart; 2];
    for (k, point) in [&first, &second].into_iter().enumerate() {
        let is_beyond = lanes.greater(point.separation, upper);
        let mut may_be_beyond = lanes.either(point.is_wide(lanes), lanes.greater(point.separation, lower));
        is_there[k] = lanes.unless(not(lanes, is_beyond), is_apart);
        if k == 1 {
            may_be_beyond = lanes.unless(may_be_beyond, is_single);
            is_there[k] = lanes.unless(is_there[k], is_single);
        }
        undecided = lanes.either(undecided, lanes.unless(may_be_beyond, is_beyond));
    }
    is_there[0] = lanes.unless(is_there[0], lanes.unless(is_at_corners, is_between));
    // The deepest corner is the point where no end of the overlap is near enough.
    let is_bare = lanes.unless(not(lanes, lanes.either(is_there[0], is_there[1])), is_at_corners);
    undecided = lanes.either(undecided, is_bare);
    undecided = lanes.either(undecided, lanes.either(motion_a.is_long, motion_b.is_long));
    undecided = lanes.either(frame.undecided, lanes.unless(undecided, is_apart));
    manifolds.finish(lanes, first.n, undecided, is_there, at);
}

/// The gap between the boxes around two outlines.
#[cfg_attr(not(debug_assertions), inline(always))]
fn gap<L: Lanes, const N: usize>(lanes: L, a: &Polygon<L, N>, b: &Polygon<L, N>, offset: Vector<L>) -> L::Wide {
    let after = minus(lanes, plus(lanes, b.low, offset), a.high);
    let before = minus(lanes, a.low, plus(lanes, b.high, offset));
    lanes.larger(lanes.larger(after[0], after[1]), lanes.larger(before[0], before[1]))
}

/// Two cores along a direction from A to B.
struct Chosen<'a, L: Lanes> {
    n: Vector<L>,
    a: &'a Side<L>,
    b: &'a Side<L>,
    discs: [L::Mask; 2],
}

/// The corners that are nearest across the direction of two cores.
struct Beside<L: Lanes> {
    corners: [Vector<L>; 2],
    feature: L::Wide,
    /// True where there is a gap between them.
    is_open: L::Mask,
}

impl<L: Lanes> Chosen<'_, L> {
    /// The edges that face each other, left where they do not overlap, and the places of the corners that are farthest out.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn facing(&self, lanes: L, unit: &Unit<L>, offset: Vector<L>) -> (Facing<L>, [[L::Wide; 2]; 2]) {
        let &Self { n, a, b, discs } = self;
        let across = [lanes.sub(lanes.all(0), n[1]), n[0]];
        let shift = dot(lanes, across, unit.vector(lanes, offset));
        // Along the boundary of A places grow, along the boundary of B they fall.
        let places_a = a.places;
        let places_b = [lanes.sub(shift, b.places[0]), lanes.sub(shift, b.places[1])];
        let [first, last] = b.support(lanes, places_b);
        let support = [a.support(lanes, places_a), [last, first]];
        let ends_a = Ends { corners: a.corners, places: places_a, numbers: a.numbers };
        let ends_b = Ends {
            corners: [b.corners[1], b.corners[0]],
            places: [places_b[1], places_b[0]],
            numbers: [b.numbers[1], b.numbers[0]],
        };
        let low = lanes.larger(ends_a.places[0], ends_b.places[0]);
        let high = lanes.smaller(ends_a.places[1], ends_b.places[1]);
        // A disc is in one place.
        let is_over = lanes.both(lanes.either(discs[0], discs[1]), lanes.equal(high, low));
        let is_facing = lanes.either(lanes.greater(high, low), is_over);
        (Facing { n, a: ends_a, b: ends_b, undecided: not(lanes, is_facing) }, support)
    }

    /// The corners at the gap of supports with these places.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn beside(&self, lanes: L, [places_a, places_b]: [[L::Wide; 2]; 2]) -> Beside<L> {
        let Self { a, b, .. } = self;
        let gap_before = lanes.sub(places_a[0], places_b[1]);
        let gap_after = lanes.sub(places_b[0], places_a[1]);
        let is_before = lanes.greater(gap_before, gap_after);
        let number_a = a.nearest(lanes, is_before, a.numbers);
        let number_b = b.nearest(lanes, is_before, b.numbers);
        let numbers = lanes.add(number_a, lanes.raised_by(number_b, lanes.all(12)));
        Beside {
            corners: [a.nearest_corner(lanes, is_before), b.nearest_corner(lanes, is_before)],
            feature: lanes.add(numbers, lanes.raised_by(numbers, lanes.all(6))),
            is_open: lanes.greater(lanes.larger(gap_before, gap_after), lanes.all(0)),
        }
    }
}
