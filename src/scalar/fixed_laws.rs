//! The engine's arithmetic in fixed point: spans, kicks and drifts, and the laws of force.

use core::cmp::Ordering;

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::fx::Fx;
use super::moments;
use super::sweep;
use super::turn::Turn;
use super::wide::{FxSum, FxWide};
use super::{AreaMoments, Factor, Glide, KICK_LOG2, Number, Offset, Scalar, Span, Spin, SpringConstants, Weight};
use crate::kernel::div::{div_round, div_round_by, reciprocal};
use crate::kernel::exp_log::{exp2_for_64_bits, log2_fine};
use crate::kernel::round::{shr_round, shr_round_short};
use crate::kernel::sqrt::{root_and_reciprocal, root_fine};
use crate::kernel::wide::{
    div_256, magnitude, mul_128, mul_192, mul_ratio, mul_shift, mul_shift_near, shr_round_256, with_sign,
};

/// The rate of what stops at once.
const NOTHING_LEFT: u128 = u128::MAX;

/// log2 e, within 2^-64 relative.
const LOG2_E: (u128, i32) = (0xb8aa_3b29_5c17_f0bc, 63);

impl Weight {
    /// Its magnitude in units of 2^-126.
    const fn magnitude(self) -> u128 {
        match self {
            Self::Whole => 1 << 126,
            Self::YoshidaOuter => 0x567a_2dba_e58c_e184_a563_4b09_526b_4a60,
            Self::YoshidaInner => 0x6cf4_5b75_cb19_c309_4ac6_9612_a4d6_94c1,
        }
    }
}

/// constant · 2^-shift · num / den of the span, halved or not.
pub(super) const fn span_factor(constant: u128, shift: i32, span: Span) -> FxFactor {
    let (num, den) = span.ratio;
    let (high, low) = mul_128(constant, num as u128);
    // A time step is at most 1 s, so num <= den; constant < 2^127, so the high half is below num / 2 < den.
    let (quotient, rest) = div_256(high, low, den as u128);
    // The quotient has over 110 bits, so that gathering what is left in its last bit leaves one rounding.
    FxFactor::new(quotient | (rest != 0) as u128, shift + span.half as i32)
}

/// 2^±exponent, the exponent in units of 2^-120.
fn power_of_two(exponent: u128, negative: bool) -> FxFactor {
    let (whole, fraction) = ((exponent >> 120) as i32, exponent << 8);
    match (negative, fraction) {
        (true, 0) => FxFactor::new(1, whole),
        // 2^-(n + f) = 2^-(n + 1) · 2^(1 − f).
        (true, _) => FxFactor::new(exp2_for_64_bits(fraction.wrapping_neg()), 127 + whole + 1),
        (false, _) => FxFactor::new(exp2_for_64_bits(fraction), 127 - whole),
    }
}

/// e^-z, or e^z if `growth`; `None` beyond 2^255.
pub(super) fn exponential(z: FxFactor, growth: bool) -> Option<FxFactor> {
    let exponent = z.times(FxFactor::new(LOG2_E.0, LOG2_E.1));
    match exponent.to_fixed(120) {
        Some(exponent) => Some(power_of_two(exponent, !growth)),
        None => (!growth).then_some(FxFactor::ZERO),
    }
}

/// (1 − e^-z) / z, or (e^z − 1) / z if `growth`, given that exponential.
pub(super) fn mean_exponential(z: FxFactor, exponential: FxFactor, growth: bool) -> FxFactor {
    // Below 2^-16 the difference would lose more than the series does: 1 ∓ z/2 + z²/6 ∓ z³/24, next term z⁴/120 < 2^-70.
    if z < FxFactor::new(1, 16) {
        let series = |terms: FxFactor, divisor: u64| z.times(terms).over(FxFactor::from_ratio(divisor, 1));
        let third = FxFactor::ONE;
        let join = |next: FxFactor| if growth { FxFactor::ONE.plus(next) } else { FxFactor::ONE.minus(next) };
        return join(series(join(series(join(series(third, 4)), 3)), 2));
    }
    let change = if growth { exponential.minus(FxFactor::ONE) } else { FxFactor::ONE.minus(exponential) };
    change.over(z)
}

/// An offset in ulps, the sum of the squares of its components, and of a third.
///
/// *Domain* components below 2^31.38 m; `None` beyond. Positions inside a step stay below 2^30.35 m, and attachments within
/// 2^12 m of them, so that no two points of one are farther apart.
fn squares(offset: Offset<Fx>, third: Fx) -> Option<(i128, i128, u128)> {
    const MOST: u128 = 12_000_000_000_000_000_000; // 2^63.38: 2·MOST² + 2^124 < 2^128
    let (x, y) = (offset.0.ulps(), offset.1.ulps());
    let third = third.to_bits().unsigned_abs();
    let (along, across) = (magnitude(x), magnitude(y));
    if along > MOST || across > MOST || third > 1 << 62 {
        return None;
    }
    let square = |c: u64| u128::from(c) * u128::from(c);
    Some((x, y, square(along as u64) + square(across as u64) + square(third)))
}

/// √sum · 2^(32 − shift), with all its bits for small sums as well.
fn root(sum: u128, shift: i32) -> FxFactor {
    if sum == 0 {
        return FxFactor::ZERO;
    }
    let even = sum.leading_zeros() & !1;
    FxFactor::new(root_fine(sum << even), shift + (even / 2) as i32)
}

/// ⌊mantissa · 2^160 / cube⌋, what mu / d³ is made of, with 95 bits or more. *Domain* cube >= 2^125.
#[cold]
pub(super) fn share(mantissa: u64, cube: u128) -> u128 {
    // mantissa · 2^160 < 2^224: its high half is below 2^96, which is below the cube.
    div_256(u128::from(mantissa) << 32, 0, cube).0
}

/// The [`share`], or one more or less, without a division.
///
/// *Domain* cube = v^(3/2) · 2^128 within 2^-94 relative, and inverse = 2^61 / √v within 2^-55, for a v in [¼, 1).
#[inline]
pub(super) fn near_share(mantissa: u64, cube: u128, inverse: u64) -> u128 {
    let high = |a: u64, b: u64| ((u128::from(a) * u128::from(b)) >> 64) as u64;
    // 1/v^(3/2) <= 2^3 within 3 · 2^-55 + 2^-58 + 2^-60 < 2^-53.3.
    let power_q60 = ((u128::from(high(inverse, inverse)) * u128::from(inverse)) >> 59) as u64;
    // In units of 2^36, with 59 to 63 bits: rounded down within 2^-53.2.
    let first = high(mantissa, power_q60);
    // What that leaves of mantissa · 2^160, in units of 2^100 and less than one too much: below 2^(124 − 53.2) = 2^70.8.
    let rest = (i128::from(mantissa) << 60) - mul_192(cube, first).0 as i128;
    // rest · 2^100 / cube, below 2^45.8. The power is 2^-7.5 of it off, the bits cut off make 2^-16, and rounding down one.
    let second = ((rest >> 8) * i128::from(power_q60)) >> 80;
    ((u128::from(first) << 36) as i128 + second) as u128
}

/// The direction of an offset: takes the parts of a vector along it, and of a magnitude along the axes.
struct Direction {
    /// The length with its top bit set.
    length: u128,
    /// Its reciprocal, to divide by.
    reciprocal: u64,
    /// A component in ulps, shifted by this, is 2^-64 of what it is in the units of that length.
    scale: u32,
}

impl Direction {
    /// *Domain* `fine` = √(sum · 2^(2·up)) in units of 2^-32, in [2^95, 2^96], for the sum of the squares of two components.
    #[inline]
    fn new(fine: u128, up: u32) -> Self {
        // 32, or 31 where the length rounds up to 2^96. The sum of two squares is below 0.9 · 2^128, so that it has been scaled
        // there, and `up` is at least 1.
        let spare = fine.leading_zeros();
        let length = fine << spare;
        Self { length, reciprocal: reciprocal(length), scale: up + spare - 32 }
    }

    /// `whole` times a component over the length, with `more` bits behind the last; `None` if it does not fit.
    // Inlined for `more`, which is a constant.
    #[inline(always)]
    fn part(&self, whole: i128, component: i128, more: u32) -> Option<i128> {
        // |component| · 2^up is at most √(sum · 2^(2·up)) < 2^64.
        let (high, low) = mul_192(magnitude(whole), (magnitude(component) as u64) << self.scale);
        if high.leading_zeros() < more {
            return None;
        }
        let low = u128::from(low) << 64;
        let (high, low) = ((high << more) | (low >> 1 >> (127 - more)), low << more);
        let part = div_round_by(high, low, self.length, self.reciprocal)?;
        Some(with_sign(i128::try_from(part).ok()?, component ^ whole))
    }
}

impl Number for Fx {
    const WORDS: usize = 1;

    fn to_words(self) -> [u64; 3] {
        [self.to_bits() as u64, 0, 0]
    }
}

impl Scalar for Fx {
    type Accumulator = FxAccumulator;
    type Factor = FxFactor;
    type Angle = Turn;
    type Wide = FxWide;
    type Sum = FxSum;
    /// −log2 of what is left after a second, in units of 2^-120, or `u128::MAX` if nothing is left.
    type DecayRate = u128;

    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;
    const NAME: &'static str = "fx";
    const IS_REVERSIBLE: bool = true;

    #[inline]
    fn from_fx(value: Fx) -> Self {
        value
    }

    #[inline]
    fn to_bits(self) -> i64 {
        Self::to_bits(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        true
    }

    fn sin_cos(self) -> (Self, Self) {
        Self::sin_cos(self)
    }

    #[inline]
    fn product(self, other: Self) -> FxWide {
        // At most 2^63 · 2^63.
        FxWide::from_bits(i128::from(self.to_bits()) * i128::from(other.to_bits()))
    }

    #[inline]
    fn offset(self, other: Self) -> FxWide {
        // Below 2^64 ulps.
        FxWide::from_bits((i128::from(self.to_bits()) - i128::from(other.to_bits())) << 32)
    }

    #[inline]
    fn torque(arm: FxWide, force: FxWide) -> Option<FxWide> {
        let torque = mul_shift(arm.to_bits(), magnitude(force.to_bits()), 64)?;
        Some(FxWide::from_bits(with_sign(torque, force.to_bits())))
    }

    #[inline]
    fn times(self, other: Self) -> Option<Self> {
        self.checked_mul(other)
    }

    fn seconds(span: Span) -> FxFactor {
        span_factor(span.weight.magnitude(), 126, span)
    }

    fn half_square_seconds((num, den): (u32, u32)) -> FxFactor {
        let square = |n: u32| u64::from(n) * u64::from(n);
        FxFactor::from_ratio(square(num), square(den)).times(FxFactor::new(1, 1))
    }

    fn decay_rate(kept: Self) -> u128 {
        match kept.to_bits().unsigned_abs() {
            0 => NOTHING_LEFT,
            bits => log2_fine(bits).unsigned_abs(),
        }
    }

    fn decay_over(rate: u128, span: Span) -> FxFactor {
        if rate == NOTHING_LEFT {
            return FxFactor::ZERO;
        }
        // −log2 kept is in [0, 32]; in units of 2^-120 it is below 2^126, times a weight below 2 it is below 2^127.
        let (high, low) = mul_128(rate, span.weight.magnitude());
        let Some(whole) = shr_round_256(high, low, 126) else { return FxFactor::ZERO };
        // num <= den, so it is at most `whole`.
        let exponent = mul_ratio(whole, span.ratio);
        power_of_two(if span.half { exponent >> 1 } else { exponent }, !span.is_negative())
    }

    #[inline]
    fn drift(self, seconds: FxFactor) -> FxAccumulator {
        let (mantissa, shift) = seconds.parts();
        // |v| < 2^26 m/s = 2^58 ulps, so the product is below 2^122; below 2 s the shift is at least −1.
        let way = i128::from(self.to_bits()) * i128::from(mantissa);
        let shift = shift - 64;
        FxAccumulator::from_bits(if shift >= 0 {
            shr_round(way, shift.unsigned_abs())
        } else {
            way << shift.unsigned_abs()
        })
    }

    #[inline]
    fn kick(acceleration: FxWide, seconds: FxFactor) -> Option<FxAccumulator> {
        const MOST: u128 = 1 << (96 + KICK_LOG2);
        let (mantissa, shift) = seconds.parts();
        let gained = mul_shift(acceleration.to_bits(), u128::from(mantissa), shift - 32)?;
        (gained.unsigned_abs() < MOST).then_some(FxAccumulator::from_bits(gained))
    }

    fn damp_all(values: &mut [FxAccumulator], kept: FxFactor) {
        sweep::damp(values, kept);
    }

    fn kick_all(values: &mut [FxAccumulator], gained: FxAccumulator) {
        sweep::kick(values, gained);
    }

    fn drift_all(positions: &mut [FxAccumulator], velocities: &[FxAccumulator], seconds: FxFactor, negative: bool) {
        sweep::drift(positions, velocities, seconds, negative);
    }

    fn glide_all(positions: &mut [FxAccumulator], velocities: &mut [FxAccumulator], glide: &Glide<Self>) {
        sweep::glide(positions, velocities, glide);
    }

    fn spin_all(angles: &mut [Turn], velocities: &mut [FxAccumulator], angular_velocity: &Spin<Self>) {
        sweep::angular_velocity(angles, velocities, angular_velocity);
    }

    fn turn_all(angles: &mut [Turn], velocities: &[FxAccumulator], drift_factor: FxFactor, negative: bool) {
        sweep::turn(angles, velocities, drift_factor, negative);
    }

    fn are_within(values: &[FxAccumulator], log2: u32) -> bool {
        sweep::are_within(values, log2)
    }

    /// *Error* within 2^-64 + 2^-90 relative of the exact value for these inputs, then rounded to 2^-64 m/s².
    fn attraction(mu: FxFactor, to_centre: Offset<Self>, softening: Self) -> Option<Offset<Self>> {
        let (x, y, sum) = squares(to_centre, softening)?;
        let (mantissa, mu_shift) = mu.parts();
        if (x == 0 && y == 0) || mantissa == 0 {
            return Some(Offset::<Self>::default());
        }
        // s = sum · 2^even in [2^126, 2^128), and its root in [2^95, 2^96).
        let even = sum.leading_zeros() & !1;
        let s = sum << even;
        // d³ / 2^(64 − 3·even/2) in [2^125, 2^128), cut below 2^-125 relative. The root of the largest s rounds up to 2^96,
        // which is one too many: 2^-96 relative.
        let (root, inverse) = root_and_reciprocal(s);
        let (cube, _) = mul_128(s, root.min((1 << 96) - 1) << 32);
        let near = near_share(mantissa, cube, inverse);
        let shift = 96 + mu_shift - 3 * (even as i32) / 2;
        let component = |c: i128| {
            let size = magnitude(c) as u64;
            let part = match mul_shift_near(near, size, shift) {
                Some(part) => part,
                None => mul_shift(share(mantissa, cube) as i128, size.into(), shift)?,
            };
            Some(FxWide::from_bits(with_sign(part, c)))
        };
        Some((component(x)?, component(y)?))
    }

    /// *Error* the tension is that of a spring 0.501 · 2^-64 m longer or shorter (from 2^23 m on 0.751), rounded to 2^-64 N;
    /// each component is then rounded once more.
    fn tension(offset: Offset<Self>, velocity: Offset<Self>, spring: &SpringConstants<Self>) -> Option<Offset<Self>> {
        let (x, y, sum) = squares(offset, Self::ZERO)?;
        if sum == 0 {
            return Some(Offset::<Self>::default());
        }
        // The direction of a short spring needs all bits of its length: that in units of 2^-64 m / 2^up, in [2^95, 2^96].
        let up = sum.leading_zeros() / 2;
        let fine = root_fine(sum << (2 * up));
        // In units of 2^-64 m, below 2^97. Rounded twice: 0.501 / 2^up of a unit, then a half.
        let length = shr_round_short(fine, up);
        let stretch = length as i128 - (i128::from(spring.rest.to_bits()) << 32);
        let direction = Direction::new(fine, up);
        let mut tension = mul_shift(stretch, u128::from(spring.stiffness.to_bits().unsigned_abs()), 32)?;
        if spring.damping != Self::ZERO {
            // Velocities of points are below 2^34 m/s, so each part is below 2^34 · 2^(64 + 16) and a little.
            let part = |v: FxWide, c: i128| direction.part(v.to_bits(), c, 16);
            let rate = shr_round(part(velocity.0, x)?.checked_add(part(velocity.1, y)?)?, 16);
            let damping = mul_shift(rate, u128::from(spring.damping.to_bits().unsigned_abs()), 32)?;
            tension = tension.checked_add(damping)?;
        }
        let part = |c: i128| Some(FxWide::from_bits(direction.part(tension, c, 0)?));
        Some((part(x)?, part(y)?))
    }

    fn length(offset: Offset<Self>, third: Self) -> FxFactor {
        match squares(offset, third) {
            Some((_, _, sum)) => root(sum, 64),
            // Twice as far as any two points of the envelope: by halves, one bit coarser.
            None => {
                let half = |c: FxWide| FxWide::from_bits(c.to_bits() / 4);
                let third = Self::from_bits(third.to_bits() / 4);
                match squares((half(offset.0), half(offset.1)), third) {
                    Some((_, _, sum)) => root(sum, 62),
                    None => FxFactor::new(1, -32),
                }
            }
        }
    }

    fn reaches(self, offset: Offset<Self>) -> bool {
        // A sum of squares that does not fit is beyond every radius.
        let square = u128::from(self.to_bits().unsigned_abs()).pow(2);
        self >= Self::ZERO && squares(offset, Self::ZERO).is_some_and(|(_, _, sum)| sum <= square)
    }

    fn drag(speed: FxFactor, alpha: FxFactor, beta: FxFactor, seconds: FxFactor, negative: bool) -> Option<FxFactor> {
        // 1/u obeys dw/dt = α·w + β, so u(h) = u·e^-αh / (1 + β·u·(1 − e^-αh)/α); backwards both signs turn.
        let (left, mean) = if alpha.is_zero() {
            (FxFactor::ONE, FxFactor::ONE)
        } else {
            let z = alpha.times(seconds);
            let left = exponential(z, negative)?;
            (left, mean_exponential(z, left, negative))
        };
        let slowed = beta.times(speed).times(seconds).times(mean);
        if negative {
            // The flow backwards has a pole at 1; short of it a body's speed grows fourfold at most.
            return Some(left.over(FxFactor::ONE.minus(slowed.min(FxFactor::new(3, 2)))));
        }
        Some(left.over(FxFactor::ONE.plus(slowed)))
    }

    fn polygon_moments(corners: &[(Self, Self)]) -> Option<AreaMoments<Self>> {
        moments::of_polygon(corners)
    }

    fn orientation(a: (Self, Self), b: (Self, Self), c: (Self, Self)) -> Ordering {
        let minus = |p: Self, q: Self| i128::from(p.to_bits()) - i128::from(q.to_bits());
        // Shapes are within 2^13 m, so each product is below 2^92.
        (minus(b.0, a.0) * minus(c.1, a.1)).cmp(&(minus(b.1, a.1) * minus(c.0, a.0)))
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
}
