//! The cores of a pair in one unit, relative to A's centre.
//!
//! Pairs of like size have their corners in units of 2^k ulps with 30 bits, so that products take 64 bits: k is such that all corners
//! and the offset are below 2^30 units. Where that unit would be too coarse for the smaller one (a box on a long floor), corners stay in
//! ulps and products take 128 bits. The unit decides which direction, corners and edges are taken; the points are computed from ulps.

use core::ops::{Add, Neg, Sub};

use super::place::Placed;

/// A type of products of coordinates with unit vectors, and its coordinates.
///
/// A product is in units of 2^-30 of the pair's unit.
pub(super) trait Product: Copy + Ord + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> {
    type Coordinate: Copy + Eq + Into<i64>;
    const ZERO: Self;
    const LEAST: Self;
    /// `ulps / 2^k` to nearest, ties away from zero.
    fn coordinate(ulps: i64, k: u32) -> Self::Coordinate;
    fn sum(a: Self::Coordinate, b: Self::Coordinate) -> Self::Coordinate;
    /// n·p.
    fn dot(n: [i32; 2], p: [Self::Coordinate; 2]) -> Self;
    /// The square of a length, halved.
    fn half_square(p: [i64; 2]) -> Self;
    /// a × b, for a vector and the difference of two points, or the sum of two unit vectors.
    fn cross(a: [i32; 2], b: [i64; 2]) -> Self;
    /// A length in ulps as a product with a unit vector, or the largest product.
    fn length(ulps: i64, k: u32) -> Self;
    /// In ulps, to nearest. It is of separations, which are the same in all images of a pair, so that any rounding will do.
    fn ulps(self, k: u32) -> i64;
    /// In the pair's unit, rounded down.
    fn whole(self) -> i64;
}

/// Coordinates are below 2^30 + 2, so that differences are below 2^31.1; unit vectors have components up to 2^30 + 1, and |n·p| <= |n|·|p| is
/// below 2^30.01·2^30.6, the difference of two such products below 2^61.7. Squares of distances are below 2·2^62.2 = 2^63.2, and half
/// of them fits. A cross product is of a difference within one core, |a|·|b| < 2^30.01·2^31.6.
impl Product for i64 {
    type Coordinate = i32;
    const ZERO: Self = 0;
    const LEAST: Self = Self::MIN;

    #[inline(always)]
    fn coordinate(ulps: i64, k: u32) -> i32 {
        // Without a shift there is nothing to round.
        let (half, odd) = ((1 << k) >> 1, if k == 0 { 0 } else { ulps >> 63 });
        ((ulps + half + odd) >> k) as i32
    }

    #[inline(always)]
    fn sum(a: i32, b: i32) -> i32 {
        a + b
    }

    #[inline(always)]
    fn dot(n: [i32; 2], p: [i32; 2]) -> Self {
        i64::from(n[0]) * i64::from(p[0]) + i64::from(n[1]) * i64::from(p[1])
    }

    fn half_square(p: [i64; 2]) -> Self {
        ((i128::from(p[0]).pow(2) + i128::from(p[1]).pow(2)) >> 1) as i64
    }

    #[inline(always)]
    fn cross(a: [i32; 2], b: [i64; 2]) -> Self {
        i64::from(a[0]) * b[1] - i64::from(a[1]) * b[0]
    }

    #[inline(always)]
    fn length(ulps: i64, k: u32) -> Self {
        // A limit may be 2^33 units and more, and then nothing is above it.
        if ulps >> k < 1 << 33 { ulps << (30 - k) } else { Self::MAX }
    }

    #[inline(always)]
    fn ulps(self, k: u32) -> i64 {
        // k <= 25, as the cores and the offset are below 2^55 ulps.
        let right = 30 - k;
        (self + (1 << (right - 1))) >> right
    }

    #[inline(always)]
    fn whole(self) -> i64 {
        self >> 30
    }
}

/// Coordinates are below 2^56: products with unit vectors are below 2^88, squares below 2^115.
impl Product for i128 {
    type Coordinate = i64;
    const ZERO: Self = 0;
    const LEAST: Self = Self::MIN;

    #[inline(always)]
    fn coordinate(ulps: i64, _: u32) -> i64 {
        ulps
    }

    #[inline(always)]
    fn sum(a: i64, b: i64) -> i64 {
        a + b
    }

    #[inline(always)]
    fn dot(n: [i32; 2], p: [i64; 2]) -> Self {
        i128::from(n[0]) * i128::from(p[0]) + i128::from(n[1]) * i128::from(p[1])
    }

    fn half_square(p: [i64; 2]) -> Self {
        (i128::from(p[0]).pow(2) + i128::from(p[1]).pow(2)) >> 1
    }

    #[inline(always)]
    fn cross(a: [i32; 2], b: [i64; 2]) -> Self {
        i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
    }

    fn length(ulps: i64, _: u32) -> Self {
        i128::from(ulps) << 30
    }

    fn ulps(self, _: u32) -> i64 {
        ((self + (1 << 29)) >> 30) as i64
    }

    fn whole(self) -> i64 {
        (self >> 30) as i64
    }
}

/// n turned by a quarter counter-clockwise.
#[inline(always)]
pub(super) fn across(n: [i32; 2]) -> [i32; 2] {
    [-n[1], n[0]]
}

/// A core, with room for `N` corners, a power of two. Places after the last corner repeat the first one.
pub(super) struct Core<'a, P: Product, const N: usize> {
    pub(super) corners: [[P::Coordinate; 2]; N],
    pub(super) placed: &'a Placed<N>,
    pub(super) extent: i64,
}

impl<'a, P: Product, const N: usize> Core<'a, P, N> {
    #[inline(always)]
    pub(super) fn new(placed: &'a Placed<N>, shift: [i64; 2], k: u32) -> Self {
        let shift = shift.map(|part| P::coordinate(part, k));
        let place = |corner: [i64; 2]| {
            [P::sum(P::coordinate(corner[0], k), shift[0]), P::sum(P::coordinate(corner[1], k), shift[1])]
        };
        let mut corners = [place(placed.corners[0]); N];
        for (own, &corner) in corners[..Self::room(placed.count)].iter_mut().zip(&placed.corners).skip(1) {
            *own = place(corner);
        }
        Self { corners, placed, extent: placed.extent() }
    }

    /// The number of places to go through for `count` corners: few are as soon gone through as counted.
    #[inline(always)]
    fn room(count: usize) -> usize {
        if N <= 8 { N } else { count.min(N) }
    }

    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.placed.count
    }

    /// The corners, perhaps with the first one again at the end.
    #[inline(always)]
    pub(super) fn corners(&self) -> &[[P::Coordinate; 2]] {
        &self.corners[..Self::room(self.placed.count)]
    }

    /// The vector between two corners.
    #[inline(always)]
    pub(super) fn between(&self, from: usize, to: usize) -> [i64; 2] {
        let part = |i: usize| self.corners[to & (N - 1)][i].into() - self.corners[from & (N - 1)][i].into();
        [part(0), part(1)]
    }

    /// Separations of another core along the normals: its least component less the larger one of the edge's two ends.
    #[inline(always)]
    pub(super) fn separations(&self, other: &Self) -> [P; N] {
        let mut separations = [P::LEAST; N];
        for (i, separation) in separations[..Self::room(self.placed.faces)].iter_mut().enumerate() {
            if N <= 8 && i >= self.placed.faces {
                break;
            }
            let n = self.placed.normals[i];
            // The place after the last corner repeats the first; after the last place the first comes as well.
            let own = P::dot(n, self.corners[i]).max(P::dot(n, self.corners[(i + 1) & (N - 1)]));
            let least = |least: P, &corner: &[P::Coordinate; 2]| least.min(P::dot(n, corner));
            let first = P::dot(n, other.corners[0]);
            *separation = other.corners()[1..].iter().fold(first, least) - own;
        }
        separations
    }
}
