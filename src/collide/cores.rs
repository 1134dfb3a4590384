//! The cores of a pair in one unit, relative to A's centre.
//!
//! Pairs of like size have their corners in units of 2^k ulps with 30 bits, so that products take 64 bits: k is such that all corners
//! and the offset are below 2^30 units. Where that unit would be too coarse for the smaller one (a box on a long floor), corners stay in
//! ulps and products take 128 bits. The unit decides which direction, corners and edges are taken; the points are computed from ulps.

use core::marker::PhantomData;
use core::ops::{Add, Neg, Sub};

use super::place::{Placed, View};

/// A type of products of coordinates with unit vectors.
///
/// A product is in units of 2^-30 of the pair's unit.
pub(super) trait Product: Copy + Ord + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> {
    const ZERO: Self;
    const LEAST: Self;
    /// `ulps / 2^k` to nearest, ties away from zero.
    fn coordinate(ulps: i64, k: u32) -> i64;
    /// n·p.
    fn dot(n: [i32; 2], p: [i64; 2]) -> Self;
    /// The square of a length, halved.
    fn half_square(p: [i64; 2]) -> Self;
    /// a × b, for a vector and the difference of two points, or the sum of two unit vectors.
    fn cross(a: [i32; 2], b: [i64; 2]) -> Self;
    /// A length in ulps as a product with a unit vector, or the largest product.
    fn length(ulps: i64, k: u32) -> Self;
    /// The length in ulps, to nearest. It is of separations, which are the same in all images of a pair, so that any rounding will do.
    fn ulps(self, k: u32) -> i64;
    /// The length in the pair's unit, rounded down.
    fn whole(self) -> i64;
}

/// Coordinates are below 2^30 + 2, so that differences are below 2^31.1; unit vectors have components up to 2^30 + 1, and
/// |n·p| <= |n|·|p| is below 2^30.01·2^30.6, the difference of two such products below 2^61.7. Squares of distances are below
/// 2·2^62.2 = 2^63.2, and half of them fits. A cross product is of a difference within one core, |a|·|b| < 2^30.01·2^31.6.
impl Product for i64 {
    const ZERO: Self = 0;
    const LEAST: Self = Self::MIN;

    #[inline(always)]
    fn coordinate(ulps: i64, k: u32) -> i64 {
        // Without a shift there is nothing to round, and half of the unit is 0.
        let half = (1 << k) >> 1;
        (ulps + half + (ulps >> 63 & -i64::from(k > 0))) >> k
    }

    #[inline(always)]
    fn dot(n: [i32; 2], p: [i64; 2]) -> Self {
        i64::from(n[0]) * p[0] + i64::from(n[1]) * p[1]
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
    const ZERO: Self = 0;
    const LEAST: Self = Self::MIN;

    #[inline(always)]
    fn coordinate(ulps: i64, _: u32) -> i64 {
        ulps
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
pub(super) struct Core<P: Product, const N: usize> {
    pub(super) corners: [[i64; 2]; N],
    pub(super) normals: [[i32; 2]; N],
    /// The body's centre.
    pub(super) origin: [i64; 2],
    pub(super) count: usize,
    faces: usize,
    /// The largest coordinate of a corner relative to the body's centre, ulps.
    pub(super) extent: i64,
    is_box: bool,
    products: PhantomData<P>,
}

impl<P: Product, const N: usize> Core<P, N> {
    #[inline(always)]
    pub(super) fn new(view: &View<'_>, shift: [i64; 2], k: u32) -> Self {
        let shift = shift.map(|part| P::coordinate(part, k));
        let place = |corner: [i64; 2]| [P::coordinate(corner[0], k) + shift[0], P::coordinate(corner[1], k) + shift[1]];
        let faces = view.faces();
        let &Placed { count, extent, is_box, .. } = view.placed;
        if let (Some(view_corners), Some(normals)) = (view.corners.first_chunk::<N>(), view.normals.first_chunk::<N>())
        {
            let mut corners = [[0; 2]; N];
            for i in 0..N {
                corners[i] = place(view_corners[i]);
            }
            return Self {
                corners,
                normals: *normals,
                origin: shift,
                count,
                faces,
                extent,
                is_box,
                products: PhantomData,
            };
        }
        let (mut corners, mut normals) = ([place(view.corners[0]); N], [[0; 2]; N]);
        for (i, (&corner, &normal)) in view.corners.iter().zip(view.normals).enumerate().take(N) {
            (corners[i], normals[i]) = (place(corner), normal);
        }
        Self { corners, normals, origin: shift, count, faces, extent, is_box, products: PhantomData }
    }

    /// The number of places to go through for `count` corners: few are as soon gone through as counted.
    #[inline(always)]
    fn places(count: usize) -> usize {
        if N <= 8 { N } else { count.min(N) }
    }

    /// Components of the corners along a vector, perhaps with the component of the first corner again at the end.
    #[inline(always)]
    pub(super) fn heights(&self, n: [i32; 2]) -> impl Iterator<Item = P> {
        self.corners[..Self::places(self.count)].iter().map(move |&corner| P::dot(n, corner))
    }

    /// The vector between two corners. The place after the last corner repeats the first; after the last place the first comes as well.
    #[inline(always)]
    pub(super) fn between(&self, from: usize, to: usize) -> [i64; 2] {
        let part = |i: usize| self.corners[to & (N - 1)][i] - self.corners[from & (N - 1)][i];
        [part(0), part(1)]
    }

    /// The larger component of an edge's two ends along its normal: the core's own largest one, but for rounding.
    #[inline(always)]
    fn face_height(&self, i: usize) -> P {
        let n = self.normals[i];
        P::dot(n, self.corners[i]).max(P::dot(n, self.corners[(i + 1) & (N - 1)]))
    }

    pub(super) fn faces(&self) -> usize {
        self.faces.min(N)
    }

    /// The separation of another core along a normal.
    #[inline(always)]
    pub(super) fn separation(&self, i: usize, other_core: &Self) -> P {
        let n = self.normals[i];
        let first = P::dot(n, other_core.corners[0]);
        if other_core.count == 1 {
            return first - self.face_height(i);
        }
        other_core.heights(n).fold(first, |lowest, height| lowest.min(height)) - self.face_height(i)
    }

    /// Separations of another core along the normals: the least component of the other core less the largest one of this core. For
    /// cores with many corners, separations more than `slack` below the largest may be left out, as the least product.
    #[inline(always)]
    pub(super) fn separations(&self, other_core: &Self, slack: P) -> [P; N] {
        if N > 8 {
            return self.largest_separations(other_core, slack);
        }
        if self.is_box {
            return self.separations_of_box(other_core);
        }
        let mut separations = [P::LEAST; N];
        for (i, separation) in separations.iter_mut().enumerate() {
            if i < self.faces {
                *separation = self.separation(i, other_core);
            }
        }
        separations
    }

    /// The same separations along four normals that are opposite in pairs, of two normals at once.
    #[inline(always)]
    fn separations_of_box(&self, other_core: &Self) -> [P; N] {
        let mut separations = [P::LEAST; N];
        for i in 0..2 {
            let n = self.normals[i];
            let heights: [P; 4] = core::array::from_fn(|j| P::dot(n, self.corners[j]));
            let first = P::dot(n, other_core.corners[0]);
            let (mut lowest, mut highest) = (first, first);
            if other_core.count > 1 {
                for height in other_core.heights(n).skip(1) {
                    (lowest, highest) = (lowest.min(height), highest.max(height));
                }
            }
            separations[i] = lowest - heights[i].max(heights[i + 1]);
            separations[i + 2] = heights[i + 2].min(heights[(i + 3) & 3]) - highest;
        }
        separations
    }

    /// The separations that are within `slack` of the largest, and perhaps others.
    ///
    /// The component of any one corner bounds a separation from above, so that most normals need no second look. The order of corners
    /// decides which normals get one, but not which are within `slack`.
    fn largest_separations(&self, other_core: &Self, slack: P) -> [P; N] {
        let mut separations = [P::LEAST; N];
        let count = self.faces.min(N);
        for (i, bound) in separations.iter_mut().enumerate().take(count) {
            *bound = P::dot(self.normals[i], other_core.corners[0]) - self.face_height(i);
        }
        let (mut largest, mut nearest) = (P::LEAST, 0);
        let first = (0..count).max_by_key(|&i| separations[i]).unwrap_or(0);
        for i in core::iter::once(first).filter(|&i| i < count).chain(0..count) {
            let n = self.normals[i];
            let face_height = self.face_height(i);
            let bound = separations[i].min(P::dot(n, other_core.corners[nearest]) - face_height);
            if largest > P::LEAST && bound < largest - slack {
                separations[i] = P::LEAST;
                continue;
            }
            let lowest_corner = other_core.heights(n).enumerate().map(|(j, height)| (height, j)).min();
            let (lowest, corner) = lowest_corner.unwrap_or((P::ZERO, 0));
            separations[i] = lowest - face_height;
            if separations[i] > largest {
                (largest, nearest) = (separations[i], corner);
            }
        }
        separations
    }
}
