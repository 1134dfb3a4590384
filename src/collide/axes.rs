//! The direction of largest separation among the normals of two cores.

use super::cores::{Core, Product, across};
use super::frame::Direction;
use super::margin::Limit;
use super::surface::{LEAN, Link, SLACK, Surface, Surfaces, is_reached};
use crate::kernel::sqrt::direction;
use crate::shape::union::REACH;

/// The separations of a pair along its normals.
pub(super) struct Axes<P, const N: usize> {
    along_a: [P; N],
    along_b: [P; N],
    largest: P,
    /// The difference from the largest one that may come from rounding.
    slack: P,
}

/// Returns true if a core reaches over the part of an edge of another one that is on the surface, or beyond an end of it.
pub(super) fn reaches<P: Product, const N: usize>(
    [owner, core]: [&Core<P, N>; 2],
    link: &Link,
    end: Option<usize>,
    k: u32,
) -> bool {
    let Some(part) = link.part else { return true };
    let place = |p: [i64; 2]| P::dot(across(link.normal), p);
    let [low, high] = part.map(|end| place([0, 1].map(|i| owner.origin[i] + P::coordinate(end[i], k))));
    let places = || core.corners.iter().map(|&corner| place(corner));
    let slop = P::length(REACH + (4 << k), k);
    let (first, last) =
        places().fold((place(core.corners[0]), P::LEAST), |(first, last), p| (first.min(p), last.max(p)));
    is_reached([first, last + slop], [low, high + slop], end)
}

/// The difference of two separations that may come from rounding: corners err by a unit, and normals by 2^-30 of a length.
#[inline(always)]
fn slack<P: Product, const N: usize>(a: &Core<P, N>, b: &Core<P, N>, k: u32) -> P {
    P::length((8 << k) + (a.extent.max(b.extent) >> 28), k)
}

/// The separations along the normals of a core's edges that are on its surface and in which the surface that faces it pushes, where there
/// are surfaces; `None` if the cores do not touch.
fn along<P: Product, const N: usize>(
    core: &Core<P, N>,
    other_core: &Core<P, N>,
    k: u32,
    limit: &Limit,
    surface: Option<&Surface<'_>>,
    facing: Option<&Surface<'_>>,
    slack: i64,
) -> Option<[P; N]> {
    // A core beyond an edge that is covered is at the neighbour's.
    if let Some(surface) = surface.filter(|surface| !surface.is_one_sided) {
        let reach = P::length(REACH + (4 << k), k);
        let is_covered = |i: &usize| surface.links.iter().all(|link| link.corners[0] != *i);
        if (0..core.faces()).filter(is_covered).any(|i| core.separation(i, other_core) > reach) {
            return None;
        }
    }
    let is_on = |surface: &Surface<'_>, i: usize| {
        surface.links.iter().any(|link| link.corners[0] == i && reaches([core, other_core], link, None, k))
    };
    let mut along = [P::LEAST; N];
    for (i, along) in along.iter_mut().enumerate().take(core.faces()) {
        if surface.is_some_and(|surface| !is_on(surface, i)) {
            continue;
        }
        let back = core.normals[i].map(|part| -part);
        match facing {
            Some(facing) if !facing.has(back, slack, |link, end| reaches([other_core, core], link, end, k)) => {
                if facing.is_across && core.separation(i, other_core) > limit.radii_product(k) {
                    return None;
                }
            }
            _ => *along = core.separation(i, other_core),
        }
    }
    Some(along)
}

/// The largest of the separations along normals of A and of B.
fn largest<P: Product, const N: usize>(along_a: &[P; N], along_b: &[P; N]) -> P {
    along_a.iter().chain(along_b).fold(P::LEAST, |largest, &separation| largest.max(separation))
}

/// Leaves out the separations along edges from which fewer straight ones go on than from others: a surface that goes on to both sides is the
/// longer one, on which the other surface leans.
fn keep_straightest<P: Product, const N: usize>(separations: [&mut [P; N]; 2], surfaces: [&Surface<'_>; 2]) {
    let mut straightest = 0;
    for (along, surface) in separations.iter().zip(surfaces) {
        let edges = (0..N).filter(|&i| along[i] > P::LEAST);
        straightest = edges.map(|i| surface.straight_ends(i)).fold(straightest, usize::max);
    }
    for (along, surface) in separations.into_iter().zip(surfaces) {
        for (i, separation) in along.iter_mut().enumerate() {
            if surface.straight_ends(i) != straightest {
                *separation = P::LEAST;
            }
        }
    }
}

/// Numbers of edges of A and of B, one bit each: at most 64.
pub(super) type Edges = [u64; 2];

impl<P: Product, const N: usize> Axes<P, N> {
    /// Returns `None` if a separation is above `limit`.
    #[inline(always)]
    pub(super) fn new(a: &Core<P, N>, b: &Core<P, N>, k: u32, limit: &Limit) -> Option<Self> {
        let slack = slack(a, b, k);
        let along_a = a.separations(b, slack);
        let largest = along_a.iter().fold(P::LEAST, |largest, &s| largest.max(s));
        if limit.is_below_product(largest, k) {
            return None;
        }
        let along_b = b.separations(a, slack);
        let largest = along_b.iter().fold(largest, |largest, &s| largest.max(s));
        if limit.is_below_product(largest, k) { None } else { Some(Self { along_a, along_b, largest, slack }) }
    }

    /// The separations of cores on surfaces: along the normals of the edges of each that are on its surface, and in which the surface of the
    /// other one pushes. Returns `None` also if neighbours have the contact.
    pub(super) fn of_surfaces(
        a: &Core<P, N>,
        b: &Core<P, N>,
        k: u32,
        limit: &Limit,
        surfaces: &Surfaces<'_>,
    ) -> Option<Self> {
        let slack = slack(a, b, k);
        let separations_a = |slack| along(a, b, k, limit, surfaces.a.as_ref(), surfaces.b.as_ref(), slack);
        let separations_b = |slack| along(b, a, k, limit, surfaces.b.as_ref(), surfaces.a.as_ref(), slack);
        let (mut along_a, mut along_b) = (separations_a(SLACK)?, separations_b(SLACK)?);
        if let (Some(on_a), Some(on_b)) = (&surfaces.a, &surfaces.b) {
            let (mut leaning_a, mut leaning_b) = (separations_a(LEAN)?, separations_b(LEAN)?);
            keep_straightest([&mut leaning_a, &mut leaning_b], [on_a, on_b]);
            // Any direction but the one in which the surfaces lean on each other leads through one of the two.
            if largest(&leaning_a, &leaning_b) > largest(&along_a, &along_b) {
                (along_a, along_b) = (leaning_a, leaning_b);
            }
        }
        let largest = largest(&along_a, &along_b);
        if largest == P::LEAST || limit.is_below_product(largest, k) {
            return None;
        }
        Some(Self { along_a, along_b, largest, slack })
    }

    /// Returns true if all separations are less than `separation`, by more than rounding.
    pub(super) fn is_less(&self, separation: P) -> bool {
        self.largest + self.slack < separation
    }

    /// The edges with a separation of at least `threshold`.
    #[inline(always)]
    fn edges(&self, threshold: P) -> Edges {
        let edges = |along: &[P; N]| (0..N).fold(0, |set, i| set | u64::from(along[i] >= threshold) << i);
        [edges(&self.along_a), edges(&self.along_b)]
    }

    /// The direction of largest separation; the mean of the directions that tie, `None` if they cancel.
    #[inline(always)]
    pub(super) fn direction(&self, a: &Core<P, N>, b: &Core<P, N>) -> Option<Direction> {
        let edges = self.edges(self.largest);
        let [edges_a, edges_b] = edges;
        let first = |set: u64| set.trailing_zeros() as usize & (N - 1);
        let is_single = |set: u64| set & set.wrapping_sub(1) == 0;
        let n = match (edges_a, edges_b) {
            (_, 0) if is_single(edges_a) => a.normals[first(edges_a)],
            (0, _) if is_single(edges_b) => b.normals[first(edges_b)].map(|part| -part),
            _ => return tied(a, b, edges),
        };
        Some(Direction { n, is_mean: false })
    }

    /// Another direction whose separation is within rounding of the largest, that passes a test: the one of largest separation, if no other
    /// has the same.
    #[cold]
    pub(super) fn nearly_as_good(
        &self,
        a: &Core<P, N>,
        b: &Core<P, N>,
        passes: impl Fn(Direction) -> bool,
    ) -> Option<Direction> {
        let mut best: Option<(P, Direction)> = None;
        let mut is_tie = false;
        let [edges_a, edges_b] = self.edges(self.largest - self.slack);
        let candidates_a = bits(edges_a).map(|i| (self.along_a[i], a.normals[i]));
        let candidates_b = bits(edges_b).map(|i| (self.along_b[i], b.normals[i].map(|part| -part)));
        for (separation, n) in candidates_a.chain(candidates_b) {
            let direction = Direction { n, is_mean: false };
            if best.is_some_and(|(largest, _)| separation < largest) || !passes(direction) {
                continue;
            }
            is_tie = best.is_some_and(|(largest, tied)| separation == largest && (is_tie || tied.n != n));
            best = Some((separation, direction));
        }
        best.filter(|_| !is_tie).map(|(_, direction)| direction)
    }
}

/// Numbers of the edges in a set.
fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let i = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (i < 64).then_some(i)
    })
}

/// The direction of the longest of edges that tie, or the mean over all that are as long: a sum, whatever their order.
#[cold]
pub(super) fn tied<P: Product, const N: usize>(
    a: &Core<P, N>,
    b: &Core<P, N>,
    [edges_a, edges_b]: Edges,
) -> Option<Direction> {
    let square = |core: &Core<P, N>, i: usize| P::half_square(core.between(i, i + 1));
    let candidates_a = bits(edges_a).map(|i| (square(a, i), a.normals[i]));
    let candidates_b = bits(edges_b).map(|i| (square(b, i), b.normals[i].map(|part| -part)));
    let (mut longest, mut first, mut sum, mut differ) = (P::LEAST, [0; 2], [0; 2], false);
    for (square, n) in candidates_a.chain(candidates_b) {
        if square > longest {
            (longest, first, sum, differ) = (square, n, n.map(i64::from), false);
        } else if square == longest {
            // At most 128 normals.
            sum = [sum[0] + i64::from(n[0]), sum[1] + i64::from(n[1])];
            differ |= n != first;
        }
    }
    match sum {
        _ if !differ => Some(Direction { n: first, is_mean: false }),
        [0, 0] => None,
        [x, y] => Some(Direction { n: direction(x, y).0, is_mean: true }),
    }
}
