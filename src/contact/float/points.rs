//! The points of a manifold.

use core::cmp::Ordering;

use super::cores::Core;
use super::frame::{Both, Frame};
use super::link::reaches;
use super::number::{Float, Pair, dot, length, minus, plus, times};
use crate::collide::span::{At, Facing, Span, end_of_overlap};
use crate::collide::{feature, swapped_feature};

/// The contact of two outlines: one point or two.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Manifold<F> {
    /// The unit vector from A to B.
    pub(super) normal: Pair<F>,
    pub(super) count: usize,
    pub(super) points: [ManifoldPoint<F>; 2],
}

/// A point of a manifold, in the middle between the surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ManifoldPoint<F> {
    /// From the centres of mass of A and B to the point, in world axes, m.
    pub(super) arms: [Pair<F>; 2],
    /// The distance between the surfaces along the normal, m; negative where they overlap.
    pub(super) separation: F,
    /// The corners that meet here.
    pub(super) feature: u32,
}

/// The manifold of two outlines, if they are at most `margin` apart.
pub(super) fn collide<F: Float>(a: Core<'_, F>, b: Core<'_, F>, margin: F) -> Option<Manifold<F>> {
    match (a.surface, b.surface) {
        (None, Some(_)) => return collide(b, a, margin).map(swapped),
        // Neither of their bodies is dynamic.
        (Some(_), Some(_)) => return None,
        _ => {}
    }
    collide_in_order(a, b, margin)
}

/// The manifold of two outlines, of which the second one has no surface.
fn collide_in_order<F: Float>(a: Core<'_, F>, b: Core<'_, F>, margin: F) -> Option<Manifold<F>> {
    let mut both = Both::new(a, b, margin)?;
    // A body in the middle of polygons that cover each other's edges is pushed by the nearest edge.
    both.a.surface = a.surface.filter(|surface| !surface.links.is_empty());
    let surface = both.a.surface;
    if a.corners.len() == 1 && b.corners.len() == 1 {
        return both.between_corners(0, 0);
    }
    let frame = both.frame()?;
    match frame.facing {
        Facing::Edges => {
            let reaches = |link: &_, end| reaches(link, end, &both.b, both.offset);
            let is_there = surface.is_none_or(|surface| surface.has_edge(frame.a.corners, reaches));
            is_there.then(|| both.clipped(&frame)).flatten()
        }
        Facing::Corners(i, j) => {
            let found = both.between_corners(i, j)?;
            surface.is_none_or(|surface| surface.has_at(i, found.normal)).then_some(found)
        }
        Facing::Beside(i, _) if surface.is_some_and(|surface| !surface.is_own(i)) => None,
        Facing::Beside(i, j) => both.single(frame.n, frame.separation, i, j),
        Facing::Touching => None,
    }
}

/// The manifold with the two outlines swapped.
fn swapped<F: Float>(of: Manifold<F>) -> Manifold<F> {
    let mut points = of.points.map(|point| ManifoldPoint {
        arms: [point.arms[1], point.arms[0]],
        feature: swapped_feature(point.feature),
        ..point
    });
    if of.count == 2 {
        points.reverse();
    }
    Manifold { normal: of.normal.map(|part| -part), count: of.count, points }
}

impl<F: Float> Both<'_, F> {
    /// Two edges that overlap: a point at either end of the overlap.
    fn clipped(&self, frame: &Frame<F>) -> Option<Manifold<F>> {
        let (a, b) = (&frame.a, &frame.b);
        let overlap = a.places[1].or_less(b.places[1]) - a.places[0].or_more(b.places[0]);
        let mut manifold = Manifold { normal: frame.n, count: 0, points: Default::default() };
        for end in 0..if overlap <= self.slack { 1 } else { 2 } {
            let ahead = if end == 0 { a.places[0] - b.places[0] } else { b.places[1] - a.places[1] };
            let ahead = match ahead {
                ahead if ahead.size() <= self.slack => Ordering::Equal,
                ahead if ahead > F::of(0.0) => Ordering::Greater,
                _ => Ordering::Less,
            };
            let (at, name) = end_of_overlap(a, b, end, ahead);
            let separation = self.separation_at(frame, at);
            let is_seam = self.a.surface.is_some_and(|surface| surface.is_seam(at));
            if separation <= self.limit && !is_seam {
                manifold.points[manifold.count] = self.point(frame.n, at, separation, name);
                manifold.count += 1;
            }
        }
        if manifold.count > 0 {
            return Some(manifold);
        }
        // The deepest corner is beside the overlap of the edges: at the end where these overlap less.
        let counts = |i| self.a.surface.is_none_or(|surface| surface.is_own(i));
        let (_, [i, j]) = self.nearest(a, b).filter(|(_, [i, _])| counts(*i))?;
        self.single(frame.n, frame.separation, i, j)
    }

    /// The offset from a corner of A to a corner of B.
    fn between(&self, i: usize, j: usize) -> Pair<F> {
        minus(plus(self.b.corners[j], self.offset), self.a.corners[i])
    }

    /// The distance of the cores where a corner is.
    fn separation_at(&self, frame: &Frame<F>, at: At) -> F {
        let height = |i: usize, j: usize| dot(frame.n, self.between(i, j));
        let (span, place, [from, to]): (&Span<F>, F, _) = match at {
            At::Both(i, j) => return height(i, j),
            At::A(i) => {
                let end = usize::from(frame.a.corners[0] != i);
                (&frame.b, frame.a.places[end], frame.b.corners.map(|j| height(i, j)))
            }
            At::B(j) => {
                let end = usize::from(frame.b.corners[0] != j);
                (&frame.a, frame.b.places[end], frame.a.corners.map(|i| height(i, j)))
            }
        };
        let (before, after) = (place - span.places[0], span.places[1] - place);
        if before + after <= F::of(0.0) { from.or_less(to) } else { (from * after + to * before) / (before + after) }
    }

    /// The point at a corner, in the middle between the surfaces, for a separation of the cores.
    fn point(&self, n: Pair<F>, at: At, separation: F, feature: u32) -> ManifoldPoint<F> {
        let (of_a, of_b) = (self.a.radius, self.b.radius);
        let half = |a: Pair<F>, b: Pair<F>| times(plus(a, b), F::of(0.5));
        let from_a = |i: usize| plus(self.a.corners[i], times(n, (separation + of_a - of_b) * F::of(0.5)));
        let from_b = |j: usize| minus(self.b.corners[j], times(n, (separation + of_b - of_a) * F::of(0.5)));
        let (arm_a, arm_b) = match at {
            At::A(i) => (from_a(i), minus(from_a(i), self.offset)),
            At::B(j) => (plus(from_b(j), self.offset), from_b(j)),
            At::Both(i, j) => {
                (half(from_a(i), plus(from_b(j), self.offset)), half(minus(from_a(i), self.offset), from_b(j)))
            }
        };
        ManifoldPoint { arms: [arm_a, arm_b], separation: separation - of_a - of_b, feature }
    }

    /// The manifold of one point between two corners, along the direction from one to the other. `None` if they are farther
    /// apart than counts, or coincide.
    fn between_corners(&self, i: usize, j: usize) -> Option<Manifold<F>> {
        let way = self.between(i, j);
        let distance = length(way);
        if distance == F::of(0.0) {
            return None;
        }
        self.single(times(way, F::of(1.0) / distance), distance, i, j)
    }

    /// The manifold of one point between two corners.
    fn single(&self, normal: Pair<F>, separation: F, i: usize, j: usize) -> Option<Manifold<F>> {
        if separation > self.limit {
            return None;
        }
        let point = self.point(normal, At::Both(i, j), separation, feature([i; 2], [j; 2]));
        Some(Manifold { normal, count: 1, points: [point, ManifoldPoint::default()] })
    }
}
