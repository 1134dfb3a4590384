//! Seams between polygons that stand still: which edges, and which directions at corners, belong to the surface of their union.
//!
//! An edge that a neighbour covers is inside the union and pushes nothing; an edge covered in part pushes only outlines that reach over the
//! rest of it. At a corner of an edge that is on the surface, the directions in
//! which the polygon pushes go from the edge's normal to the normal of the edge by which the surface goes on there, of the polygon itself
//! or of a neighbour; where the surface goes on straight or turns inwards, there are none beside the normal. Segments of chains have the
//! same rules (`collide/surface.rs`).
//!
//! **Slop.** Neighbours need not fit to the ulp: gaps of up to 3·2^-14 m (0.18 mm) are closed, and differences of height of up to
//! 2^-13 m (0.12 mm) are none.
//!
//! All of it is by integers, for any scalar, and odd: a mirror image has the mirror image of the surface, to the bit. No order of
//! polygons or of corners matters.

use alloc::vec::Vec;

use super::Neighbour;
use crate::kernel::round::odd_shift;
use crate::kernel::sqrt::direction;

/// 2^-14 m, ulps.
const SLOP: i64 = 1 << 18;
/// Polygons whose boxes are farther apart than this do not touch, ulps.
pub(crate) const REACH: i64 = 3 * SLOP;
/// Edges whose directions differ by a sine below this are parallel, in units of 2^-60: 2^-20.
pub(crate) const PARALLEL: i128 = 1 << 40;

/// An edge of a polygon that is on the surface of the union.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Face {
    /// The number of its first corner, and the number of all corners.
    pub(crate) edge: usize,
    pub(crate) corners: usize,
    /// The unit normal of the edge in units of 2^-30.
    pub(crate) normal: [i32; 2],
    /// The edges by which the surface goes on at its first and at its second corner, by their normals.
    pub(crate) ends: [Neighbour<[i32; 2]>; 2],
    /// The ends of the part that is on the surface, if that is not all of it, in ulps.
    pub(crate) part: Option<[[i64; 2]; 2]>,
}

/// A convex polygon and the polygons that may touch it, corners counter-clockwise in ulps: below 2^50, relative to a point near them.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    corners: Vec<[i64; 2]>,
    /// The index behind the last corner of each polygon.
    ends: Vec<usize>,
    /// The number of the corners of polygons that were left out.
    left_out: usize,
    /// Workspace: the parts of an edge that neighbours cover.
    covered: Vec<[i64; 2]>,
}

impl Polygons {
    pub(crate) fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
        self.left_out = 0;
    }

    /// Adds a polygon. After the first one it is left out if it is too far from that to touch it.
    pub(crate) fn push(&mut self, corners: impl IntoIterator<Item = [i64; 2]>) {
        let from = self.corners.len();
        self.corners.extend(corners);
        if self.ends.first().is_some_and(|&first| !are_near(&self.corners[..first], &self.corners[from..])) {
            self.left_out += self.corners.len() - from;
            self.corners.truncate(from);
        } else {
            self.ends.push(self.corners.len());
        }
    }

    /// The number of the corners of all polygons, also of polygons that were left out.
    pub(crate) fn corner_count(&self) -> usize {
        self.corners.len() + self.left_out
    }

    /// The corners of each polygon after the first one.
    fn neighbours(&self) -> impl Iterator<Item = &[[i64; 2]]> + Clone {
        self.ends.windows(2).map(|ends| &self.corners[ends[0]..ends[1]])
    }

    /// Lists the edges of the first polygon that are on the surface of the union of all. Returns false if no other polygon
    /// touches it, so that it pushes as one that stands alone. *Domain* there is a polygon.
    pub(crate) fn faces(&mut self, faces: &mut Vec<Face>) -> bool {
        if self.ends.len() == 1 {
            return false;
        }
        let mut covered = core::mem::take(&mut self.covered);
        let polygon = &self.corners[..self.ends[0]];
        let from = faces.len();
        let count = polygon.len();
        let mut is_changed = false;
        for i in 0..count {
            let edge = Edge::new(polygon[i], polygon[(i + 1) % count]);
            covered.clear();
            covered.extend(self.neighbours().filter_map(|neighbour| edge.covered(neighbour)));
            let Some([low, high]) = edge.exposed(&mut covered) else {
                is_changed = true;
                continue;
            };
            let reaches = [low <= -edge.length + 2 * REACH, high >= edge.length - 2 * REACH];
            let beside = [polygon[(i + count - 1) % count], polygon[(i + 2) % count]];
            let ends = [0, 1].map(|end| match reaches[end] {
                true => edge.beyond(end, beside[end], self.neighbours()),
                false => Neighbour::Covered,
            });
            let is_own = |neighbour: &Neighbour<_>| matches!(neighbour, Neighbour::Own(_));
            is_changed |= !ends.iter().all(is_own);
            let part = (reaches != [true; 2]).then(|| [low, high].map(|place| edge.at(place)));
            faces.push(Face { edge: i, corners: count, normal: edge.normal(), ends, part });
        }
        if !is_changed {
            faces.truncate(from);
        }
        self.covered = covered;
        is_changed
    }
}

/// Returns true if the boxes around two polygons are at most [`REACH`] apart.
fn are_near(a: &[[i64; 2]], b: &[[i64; 2]]) -> bool {
    let range = |corners: &[[i64; 2]], axis: usize| {
        let parts = corners.iter().map(|corner| corner[axis]);
        parts.fold([i64::MAX, i64::MIN], |[low, high], part| [low.min(part), high.max(part)])
    };
    (0..2).all(|axis| {
        let ([low_a, high_a], [low_b, high_b]) = (range(a, axis), range(b, axis));
        low_a - high_b <= REACH && low_b - high_a <= REACH
    })
}

fn minus(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// n·p in units of 2^-30 ulp: below 2^83 for points below 2^52.
fn dot(n: [i32; 2], p: [i64; 2]) -> i128 {
    i128::from(n[0]) * i128::from(p[0]) + i128::from(n[1]) * i128::from(p[1])
}

/// a × b of vectors below 2^52.
fn cross(a: [i64; 2], b: [i64; 2]) -> i128 {
    i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
}

/// An edge from one corner of a polygon to the next.
///
/// Places along it are twice the distances from its middle in ulps: the same in its mirror image, but for the sign.
struct Edge {
    from: [i64; 2],
    to: [i64; 2],
    /// The unit vector along the edge.
    along: [i32; 2],
    length: i64,
}

impl Edge {
    /// *Domain* the two corners differ. Rounding makes one of two corners only where they are an ulp apart: such an edge goes anywhere.
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        let [x, y] = minus(to, from);
        let (along, length) = if (x, y) == (0, 0) { ([0; 2], 0) } else { direction(x, y) };
        Self { from, to, along, length: length as i64 }
    }

    /// The outward normal: the direction turned by a quarter clockwise.
    fn normal(&self) -> [i32; 2] {
        let [x, y] = self.along;
        [y, -x]
    }

    /// The point at a place.
    fn at(&self, place: i64) -> [i64; 2] {
        [0, 1].map(|axis| {
            // Below 2^52·2^31.
            let twice = i128::from(self.from[axis] + self.to[axis]) << 30;
            odd_shift(twice + i128::from(place) * i128::from(self.along[axis]), 31) as i64
        })
    }

    /// The part of the edge that is left of the parts that other polygons cover, from its first to its last place; `None` if they cover it
    /// all. Sorts the parts.
    fn exposed(&self, covered: &mut [[i64; 2]]) -> Option<[i64; 2]> {
        covered.sort_unstable();
        let (mut low, mut high) = (-self.length, self.length);
        for [from, to] in &*covered {
            if *from <= low + REACH {
                low = low.max(*to);
            }
        }
        covered.sort_unstable_by_key(|&[_, to]| core::cmp::Reverse(to));
        for [from, to] in covered {
            if *to >= high - REACH {
                high = high.min(*from);
            }
        }
        (high - low > 2 * REACH).then_some([low, high])
    }

    /// The part of the edge on whose outer side another polygon is, within the slop.
    fn covered(&self, polygon: &[[i64; 2]]) -> Option<[i64; 2]> {
        let outward = self.normal();
        // Twice the middle, moved outwards by twice the slop.
        let middle =
            [0, 1].map(|axis| self.from[axis] + self.to[axis] + i64::from(outward[axis]) * (4 * SLOP) / (1 << 30));
        let (mut low, mut high) = (-self.length, self.length);
        for (i, &corner) in polygon.iter().enumerate() {
            let side = Edge::new(corner, polygon[(i + 1) % polygon.len()]);
            let normal = side.normal();
            // Twice the slop less twice the height over the side, in units of 2^-30 ulp.
            let room = (i128::from(2 * SLOP) << 30) - dot(normal, minus(middle, corner.map(|part| 2 * part)));
            let slope =
                i128::from(normal[0]) * i128::from(self.along[0]) + i128::from(normal[1]) * i128::from(self.along[1]);
            if slope.abs() < PARALLEL {
                if room < 0 {
                    return None;
                }
                continue;
            }
            // place·slope/2^30 is at most `room`: below 2^84·2^30, and division rounds towards zero, so that it is odd.
            let end = ((room << 30) / slope).clamp(-(1 << 60), 1 << 60) as i64;
            if slope > 0 { high = high.min(end) } else { low = low.max(end) }
        }
        (low < high).then_some([low, high])
    }

    /// The edge by which the surface goes on at an end of this one; `next_corner` is the next corner of the same polygon beyond that end.
    fn beyond<'a>(
        &self,
        end: usize,
        next_corner: [i64; 2],
        neighbours: impl Iterator<Item = &'a [[i64; 2]]>,
    ) -> Neighbour<[i32; 2]> {
        let (corner, back) =
            if end == 1 { (self.to, minus(self.from, self.to)) } else { (self.from, minus(self.to, self.from)) };
        // From the edge on, outside of the polygon: counter-clockwise at its second corner, clockwise at its first one.
        let sign: i128 = if end == 1 { 1 } else { -1 };
        let cross = |a: [i64; 2], b: [i64; 2]| sign * cross(a, b);
        let is_inner = |v: [i64; 2]| {
            let dot = i128::from(back[0]) * i128::from(v[0]) + i128::from(back[1]) * i128::from(v[1]);
            cross(back, v) > 0 || cross(back, v) == 0 && dot > 0
        };
        let comes_before = |a: [i64; 2], b: [i64; 2]| match (is_inner(a), is_inner(b)) {
            (true, false) => true,
            (false, true) => false,
            _ => cross(a, b) > 0,
        };
        let (mut next, mut normal): ([i64; 2], Option<[i32; 2]>) = (minus(next_corner, corner), None);
        for polygon in neighbours {
            for (i, &from) in polygon.iter().enumerate() {
                let side = Edge::new(from, polygon[(i + 1) % polygon.len()]);
                let (start, stop) = if end == 1 { (side.from, side.to) } else { (side.to, side.from) };
                if !side.starts_at(corner, start, end) {
                    continue;
                }
                let way = minus(stop, start);
                // Of two sides that go the same way the longer one: its direction is the finer.
                let size = |v: [i64; 2]| i128::from(v[0]).pow(2) + i128::from(v[1]).pow(2);
                let is_finer = normal.is_some() && !comes_before(next, way) && size(way) > size(next);
                if comes_before(way, next) || is_finer {
                    (next, normal) = (way, Some(side.normal()));
                }
            }
        }
        match normal {
            None => Neighbour::Own(Edge::new(corner, next_corner).normal().map(|part| sign as i32 * part)),
            // A straight angle is inner.
            Some(normal) if is_inner(next) || cross(back, next) == 0 => Neighbour::Inner(normal),
            Some(normal) => Neighbour::Outer(normal),
        }
    }

    /// Returns true if a point is on the edge, and not near the other end than `start`.
    fn starts_at(&self, point: [i64; 2], start: [i64; 2], end: usize) -> bool {
        let offset = minus(point, start);
        let height = dot(self.normal(), offset).abs();
        let place = if end == 1 { dot(self.along, offset) } else { -dot(self.along, offset) };
        let reach = i128::from(REACH) << 30;
        height <= i128::from(2 * SLOP) << 30 && place >= -reach && place < (i128::from(self.length) << 30) - reach
    }
}
