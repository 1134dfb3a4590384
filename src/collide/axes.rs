//! The direction of largest separation among the normals of two cores.

use super::cores::{Core, Product, across};
use super::frame::Direction;
use super::margin::Limit;
use super::seam;
use super::surface::{Link, Surface, is_reached};
use crate::kernel::sqrt::direction;

/// The separations of a pair along its normals.
pub(super) struct Axes<P, const N: usize> {
    along_a: [P; N],
    along_b: [P; N],
    largest: P,
    /// The difference from the largest one that may come from rounding.
    slack: P,
}

/// Returns true if a core reaches over the part of an edge that is on the surface, or beyond an end of it.
pub(super) fn reaches<P: Product, const N: usize>(link: &Link, end: Option<usize>, core: &Core<P, N>, k: u32) -> bool {
    let Some(part) = link.part else { return true };
    let place = |p: [i64; 2]| P::dot(across(link.normal), p);
    let [low, high] = part.map(|end| place(end.map(|part| P::coordinate(part, k))));
    let places = || core.corners.iter().map(|&corner| place(corner));
    let slop = P::length(seam::REACH + (4 << k), k);
    let (least, most) = places().fold((place(core.corners[0]), P::LEAST), |(a, b), p| (a.min(p), b.max(p)));
    is_reached([least, most + slop], [low, high + slop], end)
}

/// The difference of two separations that may come from rounding: corners err by a unit, and normals by 2^-30 of a length.
#[inline(always)]
fn slack<P: Product, const N: usize>(a: &Core<P, N>, b: &Core<P, N>, k: u32) -> P {
    P::length((8 << k) + (a.extent.max(b.extent) >> 28), k)
}

/// Numbers of edges of A and of B, one bit each: at most 64.
pub(super) type Edges = [u64; 2];

impl<P: Product, const N: usize> Axes<P, N> {
    /// Returns `None` if a separation is above `limit`.
    #[inline(always)]
    pub(super) fn new(a: &Core<P, N>, b: &Core<P, N>, k: u32, limit: &Limit) -> Option<Self> {
        let slack = slack(a, b, k);
        let along_a = a.separations(b, slack);
        let largest = along_a.iter().fold(P::LEAST, |most, &s| most.max(s));
        if limit.is_below_product(largest, k) {
            return None;
        }
        let along_b = b.separations(a, slack);
        let largest = along_b.iter().fold(largest, |most, &s| most.max(s));
        if limit.is_below_product(largest, k) { None } else { Some(Self { along_a, along_b, largest, slack }) }
    }

    /// The separations of a surface, A: along the normals of its edges, and along those of B that A pushes in as directions from A to B.
    pub(super) fn of_surface(
        a: &Core<P, N>,
        b: &Core<P, N>,
        k: u32,
        limit: &Limit,
        surface: Surface<'_>,
    ) -> Option<Self> {
        let slack = slack(a, b, k);
        let (mut along_a, mut along_b) = ([P::LEAST; N], [P::LEAST; N]);
        // A core beyond an edge that is covered is at the neighbour's.
        let reach = P::length(seam::REACH + (4 << k), k);
        let is_covered = |i: &usize| surface.links.iter().all(|link| link.corners[0] != *i);
        let mut covered = (0..a.faces()).filter(is_covered);
        if !surface.is_one_sided && covered.any(|i| a.separation(i, b) > reach) {
            return None;
        }
        for link in surface.links.iter().filter(|link| reaches(link, None, b, k)) {
            let edge = link.corners[0] & (N - 1);
            along_a[edge] = a.separation(edge, b);
        }
        for (i, along) in along_b.iter_mut().enumerate().take(b.faces()) {
            let n = b.normals[i].map(|part| -part);
            if surface.has(n, |link, end| reaches(link, end, b, k)) {
                *along = b.separation(i, a);
            } else if surface.is_across && b.separation(i, a) > limit.radii_product(k) {
                return None;
            }
        }
        let largest = along_a.iter().chain(&along_b).fold(P::LEAST, |most, &s| most.max(s));
        if largest == P::LEAST || limit.is_below_product(largest, k) {
            None
        } else {
            Some(Self { along_a, along_b, largest, slack })
        }
    }

    /// Returns true if all separations are less than this one, by more than rounding.
    pub(super) fn is_less(&self, than: P) -> bool {
        self.largest + self.slack < than
    }

    /// The edges with a separation of at least `least`.
    #[inline(always)]
    fn edges(&self, least: P) -> Edges {
        let edges = |along: &[P; N]| (0..N).fold(0, |set, i| set | u64::from(along[i] >= least) << i);
        [edges(&self.along_a), edges(&self.along_b)]
    }

    /// The direction of largest separation; the mean of those that tie, `None` if they cancel.
    #[inline(always)]
    pub(super) fn direction(&self, a: &Core<P, N>, b: &Core<P, N>) -> Option<Direction> {
        let edges = self.edges(self.largest);
        let [of_a, of_b] = edges;
        let first = |set: u64| set.trailing_zeros() as usize & (N - 1);
        let is_one = |set: u64| set & set.wrapping_sub(1) == 0;
        let n = match (of_a, of_b) {
            (_, 0) if is_one(of_a) => a.normals[first(of_a)],
            (0, _) if is_one(of_b) => b.normals[first(of_b)].map(|part| -part),
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
        let mut found: Option<(P, Direction)> = None;
        let mut is_tie = false;
        let [of_a, of_b] = self.edges(self.largest - self.slack);
        let of_a = bits(of_a).map(|i| (self.along_a[i], a.normals[i]));
        let of_b = bits(of_b).map(|i| (self.along_b[i], b.normals[i].map(|part| -part)));
        for (separation, n) in of_a.chain(of_b) {
            let direction = Direction { n, is_mean: false };
            if found.is_some_and(|(most, _)| separation < most) || !passes(direction) {
                continue;
            }
            is_tie = found.is_some_and(|(most, other)| separation == most && (is_tie || other.n != n));
            found = Some((separation, direction));
        }
        found.filter(|_| !is_tie).map(|(_, direction)| direction)
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
    [of_a, of_b]: Edges,
) -> Option<Direction> {
    let square = |core: &Core<P, N>, i: usize| P::half_square(core.between(i, i + 1));
    let of_a = bits(of_a).map(|i| (square(a, i), a.normals[i]));
    let of_b = bits(of_b).map(|i| (square(b, i), b.normals[i].map(|part| -part)));
    let (mut longest, mut first, mut sum, mut differ) = (P::LEAST, [0; 2], [0; 2], false);
    for (square, n) in of_a.chain(of_b) {
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
