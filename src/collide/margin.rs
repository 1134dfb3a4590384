//! The distance up to which outlines have a manifold.

use super::cores::Product;
use crate::fx::Fx;

/// The largest margin that is told from a larger one: 2^22 m.
pub(super) const MARGIN_MAX: i64 = 1 << (22 + 32);

/// A margin: a length and the length of a vector. The root is taken where bounds do not decide: most pairs touch, or are far apart.
///
/// *Domain* components below 2^62 ulps. A margin below zero counts as zero, one above 2^22 m as that.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    length: Fx,
    way: [i64; 2],
}

impl Margin {
    /// The sum of a length in m and the length of a vector in ulps, rounded down.
    #[must_use]
    pub fn new(length: Fx, way: [i64; 2]) -> Self {
        Self { length, way }
    }

    /// The largest separation of cores with these radii, in ulps below 2^53, that is within the margin.
    #[inline(always)]
    pub(super) fn limit(self, radii: i64) -> Limit {
        // The longer side is a lower bound for the length of the vector.
        let [x, y] = self.way.map(i64::abs);
        Limit { lower_bound: self.ulps(x.max(y)) + radii, radii, margin: self }
    }

    #[inline(always)]
    fn ulps(self, way: i64) -> i64 {
        self.length.to_bits().saturating_add(way).clamp(0, MARGIN_MAX)
    }
}

impl From<Fx> for Margin {
    fn from(length: Fx) -> Self {
        Self { length, way: [0; 2] }
    }
}

/// The largest separation of two cores that counts.
#[derive(Clone, Copy)]
pub(super) struct Limit {
    /// A lower bound of it, ulps: below 2^55.
    lower_bound: i64,
    radii: i64,
    margin: Margin,
}

impl Limit {
    /// An upper bound: for the sides a ≥ b of a vector (a + b/2)² ≥ a² + b².
    #[inline(always)]
    fn upper_bound(&self) -> i64 {
        let [x, y] = self.margin.way.map(i64::abs);
        self.margin.ulps(x.max(y) + x.min(y) / 2) + self.radii
    }

    #[cold]
    fn exact(&self) -> i64 {
        let square = |v: i64| u128::from(v.unsigned_abs()).pow(2);
        let [x, y] = self.margin.way;
        self.margin.ulps((square(x) + square(y)).isqrt() as i64) + self.radii
    }

    /// The sum of the radii in units of products: cores that are farther apart do not touch.
    pub(super) fn radii_product<P: Product>(&self, k: u32) -> P {
        P::length(self.radii, k)
    }

    /// Returns true if a separation in ulps is above the limit.
    #[inline(always)]
    pub(super) fn is_below(&self, separation: i64) -> bool {
        separation > self.lower_bound && (separation > self.upper_bound() || separation > self.exact())
    }

    /// Returns true if a separation in units of products is above the limit.
    #[inline(always)]
    pub(super) fn is_below_product<P: Product>(&self, separation: P, k: u32) -> bool {
        separation > P::length(self.lower_bound, k) && separation > P::length(self.exact(), k)
    }
}
