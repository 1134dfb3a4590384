//! The points of a manifold, in ulps.

use core::cmp::Ordering;

use super::cores::{Product, across};
use super::frame::{Frame, nearest};
use super::margin::{Limit, Margin};
use super::place::{View, odd_shift};
use super::span::{At, Facing, Span, end_of_overlap};
use super::{Manifold, ManifoldPoint, feature};
use crate::fx::Fx;
use crate::kernel::sqrt::direction;
use crate::math::Vec2;

/// Two outlines in ulps, each relative to the centre of its own body.
pub(super) struct Ends<'a> {
    pub(super) a: View<'a>,
    pub(super) b: View<'a>,
    /// The offset from A's centre to B's.
    pub(super) offset: [i64; 2],
    /// The largest separation of cores that counts.
    pub(super) limit: Limit,
}

/// Between `from` at one end of a span and `to` at its other, at the distances `before` and `after` from these.
///
/// Separations are below 2^57 ulps and lengths likewise: products are below 2^114.
#[inline(always)]
fn between([from, to]: [i64; 2], before: i64, after: i64) -> i64 {
    let length = before + after;
    if length <= 0 {
        return from.min(to);
    }
    let sum = i128::from(from) * i128::from(after) + i128::from(to) * i128::from(before);
    match i64::try_from(sum) {
        Ok(sum) => sum.div_euclid(length),
        Err(_) => sum.div_euclid(i128::from(length)) as i64,
    }
}

/// A corner moved along n by half of a distance below 2^58; n is in units of 2^-30.
#[inline(always)]
fn moved([x, y]: [i64; 2], n: [i32; 2], twice: i64) -> [i64; 2] {
    let twice = i128::from(twice);
    [x + odd_shift(i128::from(n[0]) * twice, 31) as i64, y + odd_shift(i128::from(n[1]) * twice, 31) as i64]
}

/// The manifold of a frame.
#[inline(always)]
pub(super) fn manifold<P: Product>(ends: &Ends<'_>, frame: &Frame<P>) -> Option<Manifold> {
    match frame.facing {
        Facing::Edges => ends.clipped(frame),
        Facing::Corners(i, j) => ends.between_corners(i, j),
        Facing::Beside(i, j) => ends.single(frame.n, ends.separation(frame.n), i, j),
        Facing::Touching => None,
    }
}

impl<'a> Ends<'a> {
    /// Two outlines, if the boxes around them are near enough.
    #[inline(always)]
    pub(super) fn new(a: View<'a>, b: View<'a>, margin: Margin) -> Option<Self> {
        let offset = a.offset_to(&b)?;
        // Radii are at most 2^12 m.
        let limit = margin.limit(a.placed.radius + b.placed.radius);
        (!limit.is_below(a.gap(&b, offset))).then_some(Self { a, b, offset, limit })
    }

    /// The points at the ends of the overlap of two edges along a direction, whichever edges face along it. Corners are in order of place,
    /// as in the points of a manifold. `None` if the edges do not overlap or a corner is not there.
    pub(super) fn between_edges(&self, n: [i32; 2], corners: [[usize; 2]; 2]) -> Option<Manifold> {
        let span = |view: &View<'_>, corners: [usize; 2], [x, y]: [i64; 2]| {
            let place = |i: usize| {
                let [corner_x, corner_y] = *view.corners[..view.placed.count].get(i)?;
                Some(<i128 as Product>::dot(across(n), [corner_x + x, corner_y + y]))
            };
            Some(Span { corners, places: [place(corners[0])?, place(corners[1])?] })
        };
        let (a, b) = (span(&self.a, corners[0], [0; 2])?, span(&self.b, corners[1], self.offset)?);
        if a.places[0].max(b.places[0]) >= a.places[1].min(b.places[1]) {
            return None;
        }
        self.overlap(&Frame { n, a, b, facing: Facing::Edges }, |_| false)
    }

    /// Two edges that overlap: a point at either end of the overlap.
    #[inline(always)]
    pub(super) fn clipped<P: Product>(&self, frame: &Frame<P>) -> Option<Manifold> {
        self.overlap(frame, |_| false).or_else(|| self.deepest(frame, |_, _| true))
    }

    /// The points of two edges that overlap, where the cores are near enough and that are not left out.
    #[inline(always)]
    pub(super) fn overlap<P: Product>(&self, frame: &Frame<P>, is_left_out: impl Fn(At) -> bool) -> Option<Manifold> {
        let (a, b) = (&frame.a, &frame.b);
        let is_point = a.places[0].max(b.places[0]) == a.places[1].min(b.places[1]);
        let first = self.end_of_overlap(frame, 0, a.places[0].cmp(&b.places[0]), &is_left_out);
        let second =
            if is_point { None } else { self.end_of_overlap(frame, 1, b.places[1].cmp(&a.places[1]), &is_left_out) };
        let (count, points) = match (first, second) {
            (Some(first), Some(second)) => (2, [first, second]),
            (Some(point), None) | (None, Some(point)) => (1, [point, ManifoldPoint::default()]),
            (None, None) => return None,
        };
        Some(Manifold { normal: frame.n, count, points })
    }

    /// The point at an end of the overlap of two edges, if the cores are near enough there and it is not left out.
    #[inline(always)]
    fn end_of_overlap<P: Product>(
        &self,
        frame: &Frame<P>,
        end: usize,
        ahead: Ordering,
        is_left_out: &impl Fn(At) -> bool,
    ) -> Option<ManifoldPoint> {
        let (at, name) = end_of_overlap(&frame.a, &frame.b, end, ahead);
        let separation = self.separation_at(frame, end, at);
        let is_there = !self.limit.is_below(separation) && !is_left_out(at);
        is_there.then(|| self.point(frame.n, at, separation, name))
    }

    /// The point of cores whose deepest corner is beside the overlap of the edges: at the end where these overlap less, if the corners that
    /// are there count.
    #[cold]
    pub(super) fn deepest<P: Product>(
        &self,
        frame: &Frame<P>,
        counts: impl Fn(usize, usize) -> bool,
    ) -> Option<Manifold> {
        let (_, [i, j]) = nearest(&frame.a, &frame.b).filter(|(_, [i, j])| counts(*i, *j))?;
        self.single(frame.n, self.separation(frame.n), i, j)
    }

    /// The offset from a corner of A to a corner of B. Corners are below 2^48, offsets below 2^56.
    #[inline(always)]
    fn corner_offset(&self, i: usize, j: usize) -> [i64; 2] {
        let ([x, y], [ax, ay], [bx, by]) = (self.offset, self.a.corners[i], self.b.corners[j]);
        [bx + x - ax, by + y - ay]
    }

    /// The distance of two corners along n.
    #[inline(always)]
    fn height(&self, n: [i32; 2], i: usize, j: usize) -> i64 {
        <i128 as Product>::dot(n, self.corner_offset(i, j)).ulps(0)
    }

    /// The separation of the cores along n: the frame has it in units of choices, this is in ulps.
    #[cold]
    pub(super) fn separation(&self, n: [i32; 2]) -> i64 {
        let height = |&corner: &[i64; 2]| <i128 as Product>::dot(n, corner);
        let highest = self.a.corners.iter().map(height).fold(i128::LEAST, Ord::max);
        let lowest = self.b.corners.iter().map(height).fold(i128::MAX, Ord::min);
        (lowest + <i128 as Product>::dot(n, self.offset) - highest).ulps(0)
    }

    /// The distance of the cores where a corner is, at an end of an edge.
    #[inline(always)]
    fn separation_at<P: Product>(&self, frame: &Frame<P>, end: usize, at: At) -> i64 {
        let (n, a, b) = (frame.n, &frame.a, &frame.b);
        let (span, place, separations): (&Span<P>, P, _) = match at {
            At::Both(i, j) => return self.height(n, i, j),
            At::A(i) => (b, a.places[end], [self.height(n, i, b.corners[0]), self.height(n, i, b.corners[1])]),
            At::B(j) => (a, b.places[end], [self.height(n, a.corners[0], j), self.height(n, a.corners[1], j)]),
        };
        // An edge square to n is flat but for rounding.
        let [from, to] = separations;
        if (from - to).abs() <= 4 {
            return (from + to) >> 1;
        }
        between(separations, (place - span.places[0]).whole(), (span.places[1] - place).whole())
    }

    /// The point at a corner, in the middle between the surfaces, for a separation of the cores.
    #[inline(always)]
    fn point(&self, n: [i32; 2], at: At, separation: i64, feature: u32) -> ManifoldPoint {
        let (radius_a, radius_b) = (self.a.placed.radius, self.b.placed.radius);
        let (twice_a, twice_b) = (separation + radius_a - radius_b, separation + radius_b - radius_a);
        // Relative to the centre of the corner's own body, and by the exact offset to the other's.
        let (a, b, [x, y]) = (self.a.corners, self.b.corners, self.offset);
        let back = [-n[0], -n[1]];
        let (arm_a, arm_b) = match at {
            At::A(i) => {
                let arm = moved(a[i], n, twice_a);
                (arm, [arm[0] - x, arm[1] - y])
            }
            At::B(j) => {
                let arm = moved(b[j], back, twice_b);
                ([arm[0] + x, arm[1] + y], arm)
            }
            At::Both(i, j) => {
                // The same point but for rounding: the mean, from either side.
                let (point_a, point_b) = (moved(a[i], n, twice_a), moved(b[j], back, twice_b));
                let half = |difference: i64| odd_shift(difference.into(), 1) as i64;
                let (dx, dy) = (half(point_b[0] + x - point_a[0]), half(point_b[1] + y - point_a[1]));
                ([point_a[0] + dx, point_a[1] + dy], [point_b[0] - dx, point_b[1] - dy])
            }
        };
        let vector = |[x, y]: [i64; 2]| Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
        let separation = Fx::from_bits(separation - radius_a - radius_b);
        ManifoldPoint { arm_a: vector(arm_a), arm_b: vector(arm_b), separation, feature }
    }

    /// The manifold of one point between two corners, along the direction from one to the other. `None` if they are farther
    /// apart than the limit, or coincide.
    pub(super) fn between_corners(&self, i: usize, j: usize) -> Option<Manifold> {
        let [x, y] = self.corner_offset(i, j);
        if (x, y) == (0, 0) {
            return None;
        }
        // Below 2^57.
        let (normal, distance) = direction(x, y);
        self.single(normal, distance as i64, i, j)
    }

    /// The manifold of one point between two corners.
    pub(super) fn single(&self, normal: [i32; 2], separation: i64, i: usize, j: usize) -> Option<Manifold> {
        if self.limit.is_below(separation) {
            return None;
        }
        let point = self.point(normal, At::Both(i, j), separation, feature([i; 2], [j; 2]));
        Some(Manifold { normal, count: 1, points: [point, ManifoldPoint::default()] })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cores, Pose};
    use super::*;
    use crate::cases::run_seed;
    use crate::fx;
    use crate::math::Random;
    use crate::scalar::Turn;
    use crate::shape::Shape;

    /// A triangle or a box of about a metre at any angle.
    fn push(cores: &mut Cores, random: &mut Random, place: Vec2) -> usize {
        let corners = [
            Vec2::new(fx!(-0.5), fx!(-0.4)),
            Vec2::new(fx!(0.5), fx!(-0.4)),
            Vec2::new(fx!(0.5), fx!(0.3)),
            Vec2::new(fx!(-0.4), fx!(0.5)),
        ];
        let shape = Shape::polygon(&corners[random.below(2) as usize..]).expect("a polygon");
        cores.push(&shape.outlines()[0], &Pose::new(place, Turn::from_bits(random.bits())))
    }

    #[test]
    fn edges_that_face_each_other_have_the_points_of_the_manifold_and_others_do_not_overlap() {
        let mut random = Random::seeded(run_seed(12));
        let mut count = 0;
        for _ in 0..4_000 {
            let mut cores = Cores::default();
            let mut place = || Fx::from_bits(random.below(1 << 32) as i64 - (1 << 31));
            let place = Vec2::new(place(), place());
            let pair = [push(&mut cores, &mut random, Vec2::ZERO), push(&mut cores, &mut random, place)];
            let Some(manifold) = cores.collide(pair[0], pair[1], fx!(0.01).into()) else { continue };
            if manifold.count != 2 {
                continue;
            }
            let corner = |point: usize, side: usize| (manifold.points[point].feature >> (12 * side) & 63) as usize;
            let edges = [0, 1].map(|side| [corner(0, side), corner(1, side)]);
            let at = |edges| cores.between_edges(pair, manifold.normal, edges, fx!(0.01).into());
            let manifold_of_edges = at(edges).expect("the edges overlap");
            assert_eq!((manifold_of_edges.count, manifold_of_edges.features()), (2, manifold.features()));
            for (point, expected) in manifold_of_edges.points.iter().zip(&manifold.points) {
                let distance = |a: Fx, b: Fx| (a.to_bits() - b.to_bits()).abs();
                // Places are in ulps here, and in units of some ulps there.
                assert!(distance(point.separation, expected.separation) < 256, "{manifold_of_edges:?}, {manifold:?}");
                assert!(distance(point.arm_a.x, expected.arm_a.x) < 256, "{manifold_of_edges:?}, {manifold:?}");
            }
            // An edge the other way round faces away.
            let [[start, end], edge_b] = edges;
            assert_eq!(at([[end, start], edge_b]), None);
            // No such corner.
            assert_eq!(at([[start, 9], edge_b]), None);
            count += 1;
        }
        assert!(count > 1_000, "{count}");
    }
}
