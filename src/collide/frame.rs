//! Two cores seen along a direction: which of their corners and edges face each other.
//!
//! Heights are components along the direction n from A to B, places components along n turned by a quarter.

use core::cmp::Ordering;

use super::cores::{Core, Product, across};
use super::span::{Facing, Span};
use super::surface::Surfaces;

/// Two cores, A and B.
pub(super) struct Pair<P: Product, const N: usize> {
    pub(super) a: Core<P, N>,
    pub(super) b: Core<P, N>,
    /// A unit is 2^k ulps.
    pub(super) k: u32,
    /// True if one of the two cores has a radius.
    pub(super) is_rounded: bool,
}

/// A direction from A to B.
#[derive(Clone, Copy)]
pub(super) struct Direction {
    /// The unit vector, in units of 2^-30.
    pub(super) n: [i32; 2],
    /// The mean of normals that tie.
    pub(super) is_mean: bool,
}

/// Two cores along a direction.
pub(super) struct Frame<P> {
    pub(super) n: [i32; 2],
    pub(super) a: Span<P>,
    pub(super) b: Span<P>,
    pub(super) facing: Facing,
}

/// The corners of a core that are farthest out along a direction, within rounding: from the first to the last in counter-clockwise
/// order. A corner alone is both ends.
struct Support<P> {
    ends: [usize; 2],
    height: P,
}

/// The farthest corners of a core along `w`. Ends of an edge that is square to `w` are as far but for rounding: below 2.9 units from the
/// corners, 2^-29 of the extent from the normal. Corners between them, on the same line within rounding, belong to it.
#[inline(always)]
fn support<P: Product, const N: usize>(core: &Core<P, N>, w: [i32; 2], k: u32) -> Support<P> {
    if core.count == 1 {
        return Support { ends: [0, 0], height: P::dot(w, core.corners[0]) };
    }
    let height = core.heights(w).fold(P::LEAST, |highest, height| highest.max(height));
    let min_height = height - P::length((3 << k) + (core.extent >> 29), k);
    let corner_set = core.heights(w).enumerate().fold(0, |set, (i, height)| set | u64::from(height >= min_height) << i);
    // A place that repeats the first corner is none.
    let corner_set = corner_set & (u64::MAX >> (64 - core.count));
    let (first, last) = (corner_set.trailing_zeros() as usize, 63 - corner_set.leading_zeros() as usize);
    let are_two = corner_set == 1 << first | 1 << last;
    // Two neighbours, in their order.
    let ends = if first == last {
        [first, first]
    } else if are_two && first + 1 == last {
        order(core, w, [first, last])
    } else if are_two && first == 0 && last + 1 == core.count {
        order(core, w, [last, first])
    } else {
        outermost(core, w, corner_set)
    };
    Support { ends, height }
}

/// Two neighbours in counter-clockwise order are the ends of a support if their places are in that order; in a thin core they may not be.
#[inline(always)]
fn order<P: Product, const N: usize>(core: &Core<P, N>, w: [i32; 2], [start, end]: [usize; 2]) -> [usize; 2] {
    let place = |i: usize| P::dot(across(w), core.corners[i & (N - 1)]);
    if core.count > 2 && place(start) < place(end) {
        return [start, end];
    }
    outermost(core, w, 1 << start | 1 << end)
}

/// The first and the last of a set of corners by place; at one place the farther one, and of corners that rounding has made one the first
/// and the last in their order.
#[cold]
fn outermost<P: Product, const N: usize>(core: &Core<P, N>, w: [i32; 2], corner_set: u64) -> [usize; 2] {
    let key = |i: usize| (P::dot(across(w), core.corners[i]), P::dot(w, core.corners[i]));
    let is_in_set = |i: &usize| corner_set >> i & 1 == 1;
    let corners = || (0..core.count).filter(is_in_set);
    let first = corners().min_by_key(|&i| (key(i).0, -key(i).1)).unwrap_or(0);
    let last = corners().max_by_key(|&i| key(i)).unwrap_or(0);
    let count = core.count;
    let is_same = |i: usize, j: usize| core.corners[i] == core.corners[j];
    let (mut start, mut end) = (first, last);
    for _ in 1..count {
        let before = (start + count - 1) % count;
        start = if is_same(before, start) { before } else { start };
        let after = (end + 1) % count;
        end = if is_same(after, end) { after } else { end };
    }
    [start, end]
}

/// The edge that faces along `w`: the edge of the support, or of the two edges beside a corner the one whose normal is nearer to `w`;
/// the corner itself if both are as near.
#[inline(always)]
fn facing_edge<P: Product, const N: usize>(core: &Core<P, N>, support: &Support<P>, w: [i32; 2]) -> [usize; 2] {
    let [corner, last] = support.ends;
    let count = core.count;
    if corner != last || count == 1 {
        return support.ends;
    }
    let before = if corner == 0 { count - 1 } else { corner - 1 };
    let after = if corner + 1 == count { 0 } else { corner + 1 };
    // The middle between the two normals; at the end of a segment, where they are opposite, outwards along it.
    let middle = if count == 2 {
        core.between(after, corner)
    } else {
        let ([x, y], [u, v]) = (core.normals[corner & (N - 1)], core.normals[before & (N - 1)]);
        [i64::from(x) + i64::from(u), i64::from(y) + i64::from(v)]
    };
    // Where the middle is counter-clockwise of `w`, the edge before the corner is.
    let edge = match P::cross(w, middle).cmp(&P::ZERO) {
        Ordering::Equal => return [corner, corner],
        Ordering::Greater => [before, corner],
        Ordering::Less => [corner, after],
    };
    // An edge along `w` has no length across it.
    let [dx, dy] = core.between(edge[0], edge[1]);
    if P::cross(w, [dx, dy]) > P::ZERO { edge } else { [corner, corner] }
}

/// The corners at the gap of two spans beside each other, and how wide it is; of spans that overlap, the corners at the end where
/// they overlap less. `None` if it is as much at both ends.
#[inline(always)]
pub(super) fn nearest<P: Product>(a: &Span<P>, b: &Span<P>) -> Option<(P, [usize; 2])> {
    let gap_before = a.places[0] - b.places[1];
    let gap_after = b.places[0] - a.places[1];
    match gap_before.cmp(&gap_after) {
        Ordering::Greater => Some((gap_before, [a.corners[0], b.corners[1]])),
        Ordering::Less => Some((gap_after, [a.corners[1], b.corners[0]])),
        Ordering::Equal => None,
    }
}

impl<P: Product, const N: usize> Pair<P, N> {
    /// The spans between corners that are in counter-clockwise order: along A's boundary places grow, along B's they fall.
    #[inline(always)]
    fn spans(&self, n: [i32; 2], a: [usize; 2], b: [usize; 2]) -> (Span<P>, Span<P>) {
        let span = |core: &Core<P, N>, corners: [usize; 2]| {
            let place = |i: usize| P::dot(across(n), core.corners[i & (N - 1)]);
            Span { corners, places: [place(corners[0]), place(corners[1])] }
        };
        (span(&self.a, a), span(&self.b, [b[1], b[0]]))
    }

    /// The separation of the cores along a direction.
    pub(super) fn separation(&self, n: [i32; 2]) -> P {
        let back = n.map(|part| -part);
        let farthest = |core: &Core<P, N>, w| core.heights(w).fold(P::LEAST, |highest, height| highest.max(height));
        -farthest(&self.b, back) - farthest(&self.a, n)
    }

    /// The cores along a direction.
    #[inline(always)]
    pub(super) fn frame(&self, Direction { n, is_mean }: Direction) -> Frame<P> {
        let back = n.map(|part| -part);
        let (support_a, support_b) = (support(&self.a, n, self.k), support(&self.b, back, self.k));
        let separation = -support_b.height - support_a.height;
        // No edge faces along a mean of directions more than another.
        let (a, b) = if is_mean {
            self.spans(n, support_a.ends, support_b.ends)
        } else {
            self.spans(n, facing_edge(&self.a, &support_a, n), facing_edge(&self.b, &support_b, back))
        };
        let threshold = self.corner_threshold();
        if separation > threshold {
            let (span_a, span_b) = self.spans(n, support_a.ends, support_b.ends);
            if let Some((_, [i, j])) = nearest(&span_a, &span_b).filter(|(gap, _)| *gap > P::ZERO) {
                return Frame { n, a, b, facing: Facing::Corners(i, j) };
            }
        }
        let (low, high) = (a.places[0].max(b.places[0]), a.places[1].min(b.places[1]));
        let is_facing = low < high || (low == high && self.is_point(separation, threshold, &a, &b));
        let facing = if is_facing { Facing::Edges } else { self.apart(separation, threshold, &a, &b) };
        Frame { n, a, b, facing }
    }

    /// The cores along a direction in which surfaces push. The part of a core that is over the edge of a surface counts before a corner
    /// beside it that is nearer, since that one is over a neighbour, unless the surface has none there.
    pub(super) fn frame_of_surfaces(&self, direction: Direction, surfaces: &Surfaces<'_>) -> Frame<P> {
        let frame = self.frame(direction);
        let (a, b) = (&frame.a, &frame.b);
        if matches!(frame.facing, Facing::Corners(i, j) if !surfaces.are_own(i, j))
            && a.places[0].max(b.places[0]) < a.places[1].min(b.places[1])
        {
            return Frame { facing: Facing::Edges, ..frame };
        }
        frame
    }

    /// Sharp cores nearer than 2^-11 of their size have no direction between corners that is worth the name.
    #[inline(always)]
    fn corner_threshold(&self) -> P {
        let smaller = self.a.extent.min(self.b.extent);
        if self.is_rounded { P::ZERO } else { P::length(smaller >> 11, self.k) }
    }

    /// The corners next to each other of segments and points that are apart on one line, where the normals of either side tie.
    #[cold]
    pub(super) fn ends_on_one_line(&self) -> Option<[usize; 2]> {
        if self.a.count.max(self.b.count) > 2 {
            return None;
        }
        let n = if self.a.count == 2 { self.a.normals[0] } else { self.b.normals[0] };
        let (a, b) = self.spans(n, [0, self.a.count - 1], [0, self.b.count - 1]);
        nearest(&a.in_order(), &b.in_order())
            .filter(|(gap, _)| *gap > self.corner_threshold())
            .map(|(_, corners)| corners)
    }

    /// Returns true if spans that overlap in one place have a point there. Sharp corners at one place touch as corners beside each other
    /// do.
    fn is_point(&self, separation: P, threshold: P, a: &Span<P>, b: &Span<P>) -> bool {
        match (a.is_corner(), b.is_corner()) {
            (true, true) => self.is_rounded || separation < P::ZERO || separation > threshold,
            (is_corner_a, is_corner_b) => is_corner_a || is_corner_b,
        }
    }

    /// The parts of cores that face each other if no edges overlap.
    #[cold]
    fn apart(&self, separation: P, threshold: P, a: &Span<P>, b: &Span<P>) -> Facing {
        let Some((gap, [i, j])) = nearest(a, b) else {
            return Facing::Touching;
        };
        // Segments and points beside each other are apart, on one line even if no normal says so.
        if self.a.count.max(self.b.count) <= 2 && gap > threshold {
            return Facing::Corners(i, j);
        }
        let is_contact = self.is_rounded || separation < P::ZERO || separation > threshold;
        if is_contact { Facing::Beside(i, j) } else { Facing::Touching }
    }
}
