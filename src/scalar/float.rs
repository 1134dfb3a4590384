//! `f32` and `f64` as scalars, to compare the engine with.
//!
//! None of the promises hold here: these builds show what the fixed-point one costs and gains. Every type beside the
//! scalar is the float itself, and every formula the textbook's.

use core::cmp::Ordering;

use super::Offset;
use super::accumulator::FxAccumulator;
use super::bulk::Bulk;
use super::factor::FxFactor;
use super::float_angle::FloatAngle as _;
use super::forces::{Forces, SpringConstants};
use super::motion::{Decay, KICK_LOG2, Motion, Span, TRANSIENT_SPEED_LOG2, Weight};
use super::number::{Accumulator, Angle, Arithmetic, Factor, Number, Scalar, Sum, Wide};
use super::polygon::{AreaMoments, Polygons};
use super::to_f64::ToF64;
use super::turn::Turn;
use crate::fx::Fx;
use crate::math::Vec2;

macro_rules! float_scalar {
    ($float:ident, $name:literal, $pow:ident, $exp:ident, $expm1:ident, $sqrt:ident, $fabs:ident, $atan2:ident) => {
        impl Number for $float {
            const WORDS: usize = 1;

            fn to_words(self) -> [u64; 3] {
                [<$float>::to_bits(self).into(), 0, 0]
            }
        }

        impl Accumulator<$float> for $float {
            fn from_scalar(value: $float) -> Self {
                value
            }
            fn value(self) -> $float {
                self
            }
            fn plus(self, other: Self) -> Self {
                self + other
            }
            fn negated(self) -> Self {
                -self
            }
            fn scaled(self, factor: $float) -> Option<Self> {
                let product = self * factor;
                (libm::$fabs(product) < (1u32 << TRANSIENT_SPEED_LOG2) as $float).then_some(product)
            }
            fn is_within(self, limit: $float) -> bool {
                libm::$fabs(self) <= limit
            }
            fn to_bits(self) -> i128 {
                <$float>::to_bits(self).into()
            }
            fn to_fixed(self) -> FxAccumulator {
                // A cast saturates.
                FxAccumulator::from_bits(libm::rint(libm::scalbn(self.into(), 96)) as i128)
            }
            fn from_fixed(value: FxAccumulator) -> Self {
                value.to_f64() as $float
            }
        }

        impl Factor<$float> for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const PI: Self = core::$float::consts::PI;
            fn from_scalar(value: $float) -> Self {
                libm::$fabs(value)
            }
            fn to_fx_factor(self) -> FxFactor {
                // Both floats have at most 53 bits.
                let (mantissa, exponent) = libm::frexp(self.into());
                FxFactor::new(libm::scalbn(mantissa, 53) as u128, 53 - exponent)
            }
            fn from_wide(value: $float) -> Self {
                libm::$fabs(value)
            }
            fn from_ratio(num: u64, den: u64) -> Self {
                num as $float / den as $float
            }
            fn to_scalar(self) -> Option<$float> {
                self.is_finite().then_some(self)
            }
            fn times(self, other: Self) -> Self {
                self * other
            }
            fn over(self, other: Self) -> Self {
                self / other
            }
            fn plus(self, other: Self) -> Self {
                self + other
            }
            fn minus(self, other: Self) -> Self {
                if self > other { self - other } else { 0.0 }
            }
            fn to_binary(self) -> (u64, i32) {
                let (fraction, exponent) = libm::frexp(self.into());
                // 53 bits of a fraction below 1.
                (libm::ldexp(fraction, 53) as u64, 53 - exponent)
            }
            fn from_binary(value: u128, shift: i32) -> Self {
                libm::ldexp(value as f64, -shift) as $float
            }
        }

        impl Wide<$float> for $float {
            fn from_scalar(value: $float) -> Self {
                value
            }
            fn from_factor(magnitude: $float, negative: bool) -> Option<Self> {
                magnitude.is_finite().then_some(if negative { -magnitude } else { magnitude })
            }
            fn to_scalar(self) -> Option<$float> {
                self.is_finite().then_some(self)
            }
            fn plus(self, other: Self) -> Option<Self> {
                let sum = self + other;
                sum.is_finite().then_some(sum)
            }
            fn negated(self) -> Self {
                -self
            }
            fn times(self, factor: $float) -> Option<Self> {
                let product = self * factor;
                product.is_finite().then_some(product)
            }
            fn is_negative(self) -> bool {
                self < 0.0
            }
        }

        impl Sum<$float> for $float {
            fn add(&mut self, term: $float) {
                *self += term;
            }
            fn total(self) -> Option<$float> {
                self.is_finite().then_some(self)
            }
        }

        impl Angle<$float> for $float {
            fn from_radians(radians: $float) -> Self {
                radians.wrapped()
            }
            fn radians(self) -> $float {
                self
            }
            fn sin_cos(self) -> ($float, $float) {
                self.sine_cosine()
            }
            fn drift_factor(span: Span) -> $float {
                <$float as Motion<$float>>::seconds(span)
            }
            fn drifted(self, velocity: $float, drift_factor: $float, negative: bool) -> Self {
                let passed = velocity * drift_factor;
                Self::from_radians(if negative { self - passed } else { self + passed })
            }
            fn turned(self, radians: $float) -> Self {
                self.turned_by(radians)
            }
            fn way_to(self, goal: Self) -> $float {
                self.shortest_way_to(goal)
            }
            type Direction = ($float, $float);

            fn direction(self) -> ($float, $float) {
                self.sine_cosine()
            }
            fn turn(direction: ($float, $float), v: Vec2<$float>) -> Option<Vec2<$float>> {
                let (sin, cos) = direction;
                let (x, y) = (v.x * cos - v.y * sin, v.x * sin + v.y * cos);
                (x.is_finite() && y.is_finite()).then_some(Vec2::new(x, y))
            }
            fn to_bits(self) -> u64 {
                <$float>::to_bits(self).into()
            }
            fn to_turn(self) -> Turn {
                let turns = f64::from(self) / core::f64::consts::TAU;
                // A cast saturates: an angle that rounds to a whole turn is the largest one below it.
                Turn::from_bits(libm::scalbn(turns - libm::floor(turns), 64) as u64)
            }
            fn from_turn(turn: Turn) -> Self {
                turn.to_f64() as $float
            }
        }

        impl Scalar for $float {
            type Accumulator = Self;
            type Factor = Self;
            type Angle = Self;
            type Wide = Self;
            type Sum = Self;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const NAME: &'static str = $name;

            fn from_fx(value: Fx) -> Self {
                value.to_f64() as $float
            }
            fn to_fx(self) -> Fx {
                // A cast saturates.
                Fx::from_bits(libm::rint(f64::from(self) * 4_294_967_296.0) as i64)
            }
            fn to_bits(self) -> i64 {
                <$float>::to_bits(self) as i64
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
        }

        impl Arithmetic<$float> for $float {
            fn sin_cos(self) -> (Self, Self) {
                self.sine_cosine()
            }
            fn product(self, other: Self) -> Self {
                self * other
            }
            fn offset(self, other: Self) -> Self {
                self - other
            }
            fn torque(arm: Self, force: Self) -> Option<Self> {
                let torque = arm * force;
                torque.is_finite().then_some(torque)
            }
            fn times(self, other: Self) -> Option<Self> {
                let product = self * other;
                product.is_finite().then_some(product)
            }
        }

        impl Motion<$float> for $float {
            type DecayRate = Decay<Self>;

            fn seconds(span: Span) -> Self {
                let weight = match span.weight {
                    Weight::Whole => 1.0,
                    Weight::YoshidaOuter => 1.351_207_191_959_657_6_f64 as $float,
                    Weight::YoshidaInner => 1.702_414_383_919_315_3_f64 as $float,
                };
                let (num, den) = span.ratio;
                weight * (num as $float) / (den as $float) * if span.half { 0.5 } else { 1.0 }
            }
            fn half_square_seconds(num: u32, den: u32) -> Self {
                let seconds = num as $float / den as $float;
                0.5 * seconds * seconds
            }
            fn decay_rate(decay: Decay<Self>) -> Decay<Self> {
                decay
            }
            fn decay_over(decay: Decay<Self>, span: Span) -> Self {
                let seconds = <Self as Motion<Self>>::seconds(span);
                let seconds = if span.is_negative() { -seconds } else { seconds };
                match decay {
                    Decay::KeptPerSecond(kept) => libm::$pow(kept, seconds),
                    Decay::Rate(rate) => libm::$exp(-rate * seconds),
                }
            }
            fn kept_at(rate: Self) -> Self {
                libm::$exp(-rate)
            }
            fn drift(self, seconds: Self) -> Self {
                self * seconds
            }
            fn kick(acceleration: Self, seconds: Self) -> Option<Self> {
                let gained = acceleration * seconds;
                (libm::$fabs(gained) < (1u32 << KICK_LOG2) as $float).then_some(gained)
            }
        }

        impl Bulk<$float> for $float {
            fn damp_all(values: &mut [Self], kept: Self) {
                values.iter_mut().for_each(|v| *v *= kept);
            }
            fn turn_all(angles: &mut [Self], velocities: &[Self], seconds: Self, negative: bool) {
                let seconds = if negative { -seconds } else { seconds };
                for (angle, v) in angles.iter_mut().zip(velocities) {
                    let turned = *angle + v * seconds;
                    let whole = (0.0..core::$float::consts::TAU).contains(&turned);
                    *angle = if whole { turned } else { Self::from_radians(turned) };
                }
            }
        }

        impl Forces<$float> for $float {
            // A float's exponential is cheap.
            type DragMemo = ();

            fn attraction(mu: Self, Vec2 { x, y }: Offset<Self>, softening: Self) -> Option<Offset<Self>> {
                let square = x * x + y * y + softening * softening;
                if square == 0.0 {
                    return Some(Vec2::new(0.0, 0.0));
                }
                let share = mu / (square * libm::$sqrt(square));
                let (x, y) = (x * share, y * share);
                (x.is_finite() && y.is_finite()).then_some(Vec2::new(x, y))
            }
            fn tension(
                Vec2 { x, y }: Offset<Self>,
                v: Offset<Self>,
                spring: &SpringConstants<Self>,
            ) -> Option<Offset<Self>> {
                let length = libm::$sqrt(x * x + y * y);
                if length == 0.0 {
                    return Some(Vec2::new(0.0, 0.0));
                }
                let (x, y) = (x / length, y / length);
                let force = spring.stiffness * (length - spring.rest) + spring.damping * (x * v.x + y * v.y);
                force.is_finite().then_some(Vec2::new(force * x, force * y))
            }
            fn length(Vec2 { x, y }: Offset<Self>, third: Self) -> Self {
                libm::$sqrt(x * x + y * y + third * third)
            }
            fn reaches(self, Vec2 { x, y }: Offset<Self>) -> bool {
                self >= 0.0 && x * x + y * y <= self * self
            }
            fn drag((): &mut (), speed: Self, alpha: Self, beta: Self, seconds: Self, negative: bool) -> Option<Self> {
                let h = if negative { -seconds } else { seconds };
                let z = alpha * h;
                let mean = if z == 0.0 { 1.0 } else { -libm::$expm1(-z) / z };
                let slowed = 1.0 + beta * speed * h * mean;
                let left = libm::$exp(-z) / if negative { slowed.max(0.25) } else { slowed };
                left.is_finite().then_some(left)
            }
        }

        impl Polygons<$float> for $float {
            fn polygon_moments(corners: &[Vec2<Self>]) -> Option<AreaMoments<Self>> {
                let (mut twice, mut first, mut second) = (0.0, (0.0, 0.0), 0.0);
                for (i, p) in corners.iter().enumerate() {
                    let q = corners[(i + 1) % corners.len()];
                    let cross = p.x * q.y - q.x * p.y;
                    twice += cross;
                    first = (first.0 + (p.x + q.x) * cross, first.1 + (p.y + q.y) * cross);
                    let squares = |p: Self, q: Self| p * p + p * q + q * q;
                    second += (squares(p.x, q.x) + squares(p.y, q.y)) * cross;
                }
                (twice != 0.0).then(|| {
                    let area = libm::$fabs(twice) / 2.0;
                    let centroid = Vec2::new(first.0 / (3.0 * twice), first.1 / (3.0 * twice));
                    let out = centroid.x * centroid.x + centroid.y * centroid.y;
                    AreaMoments { area, centroid, second: libm::$fabs(second) / 12.0 - area * out }
                })
            }
            fn orientation(a: Vec2<Self>, b: Vec2<Self>, c: Vec2<Self>) -> Ordering {
                let (left, right) = ((b.x - a.x) * (c.y - a.y), (b.y - a.y) * (c.x - a.x));
                left.partial_cmp(&right).unwrap_or(Ordering::Equal)
            }
            fn weighted_mean(weights: &[Self], values: &[Self]) -> Option<Self> {
                let total: Self = weights.iter().sum();
                let sum: Self = weights.iter().zip(values).map(|(w, v)| w * v).sum();
                (total > 0.0).then(|| sum / total)
            }
            fn turning(a: Vec2<Self>, b: Vec2<Self>, c: Vec2<Self>) -> Self {
                let (first, second) = (b - a, c - b);
                let (sine, cosine) = (first.x * second.y - first.y * second.x, first.x * second.x + first.y * second.y);
                libm::$atan2(libm::$fabs(sine), cosine) / core::$float::consts::TAU
            }
        }
    };
}

float_scalar!(f64, "f64", pow, exp, expm1, sqrt, fabs, atan2);
float_scalar!(f32, "f32", powf, expf, expm1f, sqrtf, fabsf, atan2f);
