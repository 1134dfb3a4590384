//! Motion over a span of time: spans, damping, kicks and drifts.

use core::fmt::Debug;

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::number::Scalar;
use super::wide::FxWide;
use crate::fx::Fx;
use crate::kernel::exp_log::{exp2_for_64_bits, log2_fine};
use crate::kernel::round::shr_round;
use crate::kernel::wide::{div_256, mul_128, mul_ratio, mul_shift_64, shr_round_256};

/// Binary logarithm of the bound on the velocity that one kick may add, in m/s or rad/s.
pub(crate) const KICK_LOG2: i32 = 21;
/// Binary logarithm of the bound on velocities between the stages of a step, but for a few kicks, in m/s or rad/s.
pub(crate) const TRANSIENT_SPEED_LOG2: i32 = 24;

/// A multiple of the time step that an integrator moves over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[doc(hidden)]
pub enum Weight {
    /// The whole step.
    Whole,
    /// 1 / (2 − ∛2) = 1.3512…, the first and third sub-step of the fourth-order composition (Yoshida 1990).
    YoshidaOuter,
    /// −∛2 / (2 − ∛2) = −1.7024…, the second sub-step of that composition.
    YoshidaInner,
}

/// A duration: a multiple of the time step, or half of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[doc(hidden)]
pub struct Span {
    /// The time step as a ratio in seconds, num / den.
    pub ratio: (u32, u32),
    /// The multiple of the time step.
    pub weight: Weight,
    /// True for half of that multiple, as in the outer stages of a symmetric step.
    pub half: bool,
}

impl Span {
    /// Returns true if time runs backwards in this span. Factors made from a span are made from its magnitude.
    #[must_use]
    #[doc(hidden)]
    pub const fn is_negative(self) -> bool {
        matches!(self.weight, Weight::YoshidaInner)
    }
}

/// Durations, and the rates and lengths that go with them.
#[doc(hidden)]
pub trait Motion<S: Scalar>: Sized {
    /// The rate at which a velocity decays: see [`decay_rate`](Self::decay_rate).
    type DecayRate: Copy + Debug + Send + Sync;
    /// True if a kick or a drift is taken back to the bit by the same one with the opposite sign: sums do not round, and
    /// the other roundings are odd.
    const IS_REVERSIBLE: bool = false;

    /// The magnitude of a span, in seconds.
    fn seconds(span: Span) -> S::Factor;
    /// ½·dt² of a whole step of num/den s, in s².
    fn half_square_seconds(num: u32, den: u32) -> S::Factor;
    /// The rate of a velocity of which the share `kept` is left after a second. [`decay_over`](Self::decay_over) takes it, so that the
    /// logarithm is computed once for all spans. *Domain* 0 ≤ kept ≤ 1.
    fn decay_rate(kept: S) -> Self::DecayRate;
    /// The share of a velocity that is left after a span at a rate, kept^span: the exact solution of dv/dt = v·ln kept. *Domain* kept > 0
    /// where the span is negative.
    fn decay_over(rate: Self::DecayRate, span: Span) -> S::Factor;
    /// The distance covered at this velocity in `seconds`, m. *Domain* |v| < 2^26 m/s, seconds < 2.
    fn drift(self, seconds: S::Factor) -> S::Accumulator;
    /// The velocity gained at this acceleration in `seconds`, m/s; `None` from 2^21 on.
    fn kick(acceleration: S::Wide, seconds: S::Factor) -> Option<S::Accumulator>;
}

/// The rate of a velocity that stops at once.
const NOTHING_LEFT: u128 = u128::MAX;

impl Weight {
    /// The magnitude in units of 2^-126.
    const fn magnitude(self) -> u128 {
        match self {
            Self::Whole => 1 << 126,
            Self::YoshidaOuter => 0x567a_2dba_e58c_e184_a563_4b09_526b_4a60,
            Self::YoshidaInner => 0x6cf4_5b75_cb19_c309_4ac6_9612_a4d6_94c1,
        }
    }
}

/// constant · 2^-shift times the time step of the span, num / den, and half of that if the span is halved.
pub(super) const fn span_factor(constant: u128, shift: i32, span: Span) -> FxFactor {
    let (num, den) = span.ratio;
    let (high, low) = mul_128(constant, num as u128);
    // A time step is at most 1 s, so num <= den; constant < 2^127, so the high half is below num / 2 < den.
    let (quotient, rest) = div_256(high, low, den as u128);
    // The quotient has over 110 bits, so that gathering what is left in its last bit leaves one rounding.
    FxFactor::new(quotient | (rest != 0) as u128, shift + span.half as i32)
}

/// 2^±exponent, the exponent in units of 2^-120.
pub(super) fn power_of_two(exponent: u128, negative: bool) -> FxFactor {
    let (whole, fraction) = ((exponent >> 120) as i32, exponent << 8);
    match (negative, fraction) {
        (true, 0) => FxFactor::new(1, whole),
        // 2^-(n + f) = 2^-(n + 1) · 2^(1 − f).
        (true, _) => FxFactor::new(exp2_for_64_bits(fraction.wrapping_neg()), 127 + whole + 1),
        (false, _) => FxFactor::new(exp2_for_64_bits(fraction), 127 - whole),
    }
}

impl Motion<Fx> for Fx {
    /// −log2 of what is left after a second, in units of 2^-120, or `u128::MAX` if nothing is left.
    type DecayRate = u128;
    const IS_REVERSIBLE: bool = true;

    fn seconds(span: Span) -> FxFactor {
        span_factor(span.weight.magnitude(), 126, span)
    }

    fn half_square_seconds(num: u32, den: u32) -> FxFactor {
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
        let exponent = mul_ratio(whole, span.ratio.0, span.ratio.1);
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

    #[inline(always)]
    fn kick(acceleration: FxWide, seconds: FxFactor) -> Option<FxAccumulator> {
        const MOST: u128 = 1 << (96 + KICK_LOG2);
        let (mantissa, shift) = seconds.parts();
        let gained = mul_shift_64(acceleration.to_bits(), mantissa, shift - 32)?;
        // The upper word tells, but where it is the least one that may be within.
        let is_within = ((gained >> 64) as i64).unsigned_abs() < (MOST >> 64) as u64 || gained.unsigned_abs() < MOST;
        is_within.then_some(FxAccumulator::from_bits(gained))
    }
}
