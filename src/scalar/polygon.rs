//! Moments of polygons in fixed point: sums of exact integers, rounded once.

use alloc::vec::Vec;
use core::cmp::Ordering;

use super::factor::FxFactor;
use super::number::Scalar;
use crate::fx::Fx;
use crate::kernel::div::div_round;
use crate::kernel::trig::atan2_turn;
use crate::kernel::wide::{div_256, mul_128};
use crate::math::Vec2;

/// Area, centroid and second moment of area of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct AreaMoments<S: Scalar> {
    /// Area in m².
    pub area: S::Factor,
    /// Centroid in m.
    pub centroid: Vec2<S>,
    /// Second moment about the centroid, in m⁴. *Error* it loses bits if the centroid is far from the origin of the coordinates.
    pub second: S::Factor,
}

/// Geometry of polygons: moments, orientation, weighted means.
#[doc(hidden)]
pub trait Polygons<S: Scalar>: Sized {
    /// Area, centroid and second moment of a polygon, from sums that do not depend on its first corner or winding.
    /// `None` if it has no area.
    fn polygon_moments(corners: &[Vec2<S>]) -> Option<AreaMoments<S>>;
    /// The sign of the triangle's signed area: `Greater` if its corners run counter-clockwise, `Equal` if they are on one line,
    /// `Less` if they run clockwise.
    fn orientation(a: Vec2<S>, b: Vec2<S>, c: Vec2<S>) -> Ordering;
    /// The mean of `values`, each with its weight; `None` if all weights are zero.
    fn weighted_mean(weights: &[S::Factor], values: &[S]) -> Option<S>;
    /// The angle between the ways from `a` to `b` and from there to `c`, as a part of a full turn: at most a half. It is the same for all
    /// mirror images, and for `c`, `b`, `a`. *Error* 2^-62 turns.
    fn turning(a: Vec2<S>, b: Vec2<S>, c: Vec2<S>) -> S::Factor;
}

impl Polygons<Fx> for Fx {
    fn polygon_moments(corners: &[Vec2]) -> Option<AreaMoments<Self>> {
        of_polygon(corners)
    }

    fn orientation(a: Vec2, b: Vec2, c: Vec2) -> Ordering {
        let minus = |p: Self, q: Self| i128::from(p.to_bits()) - i128::from(q.to_bits());
        // Shapes are within 2^13 m, so each product is below 2^92.
        (minus(b.x, a.x) * minus(c.y, a.y)).cmp(&(minus(b.y, a.y) * minus(c.x, a.x)))
    }

    fn weighted_mean(weights: &[FxFactor], values: &[Self]) -> Option<Self> {
        let largest = weights.iter().filter(|w| !w.is_zero()).map(|w| w.parts().1).min()?;
        let (mut sum, mut total) = (0i128, 0i128);
        for (weight, value) in weights.iter().zip(values).filter(|(weight, _)| !weight.is_zero()) {
            let (mantissa, shift) = weight.parts();
            // Weights to 2^-60 of the largest; values are within 2^13 m = 2^45 ulps, so 2^20 parts stay below 2^126.
            let weight = i128::from(mantissa >> 4) >> (shift - largest).min(63);
            sum += weight * i128::from(value.to_bits());
            total += weight;
        }
        Some(Self::from_bits(div_round(sum, total) as i64))
    }

    fn turning(a: Vec2, b: Vec2, c: Vec2) -> FxFactor {
        let minus = |p: Self, q: Self| i128::from(p.to_bits()) - i128::from(q.to_bits());
        let (x1, y1, x2, y2) = (minus(b.x, a.x), minus(b.y, a.y), minus(c.x, b.x), minus(c.y, b.y));
        // Shapes are within 2^13 m, so each product is below 2^92, and the sums below 2^93. 62 bits of the larger one are kept.
        let (sine, cosine) = ((x1 * y2 - y1 * x2).abs(), x1 * x2 + y1 * y2);
        let down = (66 - sine.max(cosine.abs()).leading_zeros() as i32).max(0);
        let turn = atan2_turn((sine >> down) as i64, (cosine.signum() * (cosine.abs() >> down)) as i64);
        FxFactor::from_ratio(turn >> 1, 1 << 63)
    }
}

/// A signed integer of 256 bits, as far as a sum of products needs one.
#[derive(Clone, Copy, Default)]
struct Sum256 {
    high: i128,
    low: u128,
}

impl Sum256 {
    /// Adds a·b. *Domain* the sum stays below 2^255.
    fn add_product(&mut self, a: i128, b: i128) {
        let (high, low) = mul_128(a.unsigned_abs(), b.unsigned_abs());
        let product = Self { high: high as i128, low };
        let product = if (a < 0) != (b < 0) { product.negated() } else { product };
        let (low, carry) = self.low.overflowing_add(product.low);
        *self = Self { high: self.high.wrapping_add(product.high).wrapping_add(i128::from(carry)), low };
    }

    fn negated(self) -> Self {
        let (low, carry) = (!self.low).overflowing_add(1);
        Self { high: (!self.high).wrapping_add(i128::from(carry)), low }
    }

    /// (negative, high, low) of its magnitude.
    fn magnitude(self) -> (bool, u128, u128) {
        let m = if self.high < 0 { self.negated() } else { self };
        (self.high < 0, m.high as u128, m.low)
    }
}

/// Green's theorem: twice the area is Σ c, six times the first moment of it Σ (p + q)·c, twelve times the second Σ
/// (p² + p·q + q²)·c, over the edges from p to q with c = p × q.
///
/// *Domain* coordinates within 2^13 m = 2^45 ulps, at most 2^16 corners: a cross product is below 2^91, a sum of them
/// below 2^107, a term of the second moment below 2^184, a sum of those below 2^200.
fn of_polygon(corners: &[Vec2]) -> Option<AreaMoments<Fx>> {
    let points: Vec<(i128, i128)> =
        corners.iter().map(|Vec2 { x, y }| (i128::from(x.to_bits()), i128::from(y.to_bits()))).collect();
    let (mut area, mut first, mut second) = (0i128, [Sum256::default(); 2], Sum256::default());
    for (i, &p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        let cross = p.0 * q.1 - q.0 * p.1;
        area += cross;
        first[0].add_product(p.0 + q.0, cross);
        first[1].add_product(p.1 + q.1, cross);
        let squares = p.0 * p.0 + p.0 * q.0 + q.0 * q.0 + p.1 * p.1 + p.1 * q.1 + q.1 * q.1;
        second.add_product(squares, cross);
    }
    if area == 0 {
        return None;
    }
    let divisor = 3 * area.unsigned_abs();
    let centroid = first.map(|sum| {
        let (negative, high, low) = sum.magnitude();
        // The centroid is among the corners, so the quotient is below 2^45 and the high half below the divisor.
        let (quotient, rest) = div_256(high, low, divisor);
        let up = rest > divisor - rest || (rest == divisor - rest && quotient & 1 == 1);
        let bits = (quotient + u128::from(up)) as i64;
        Fx::from_bits(if negative == (area < 0) { bits } else { -bits })
    });
    let (_, high, low) = second.magnitude();
    let about_origin = FxFactor::from_256(high, low, 12, 128);
    let area = FxFactor::new(area.unsigned_abs(), 65);
    // From the origin to the centroid by the parallel-axis theorem: half an ulp counts in the smallest shapes.
    let out = first.map(|sum| {
        let (_, high, low) = sum.magnitude();
        let out = FxFactor::from_256(high, low, 1, 32).over(FxFactor::new(divisor, 0));
        out.times(out)
    });
    let second = about_origin.minus(area.times(out[0].plus(out[1])));
    Some(AreaMoments { area, centroid: centroid.into(), second })
}
