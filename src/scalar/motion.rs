//! Motion over a span of time: spans, damping, kicks and drifts.

use core::fmt::Debug;

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::number::Scalar;
use super::wide::FxWide;
use crate::fx::Fx;
use crate::kernel::exp_log::{exp, exp2_for_64_bits, log2_fine, times_log2_e};
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

/// The law by which a velocity decays, in one of two forms: a share that is small has few digits, a rate has them all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[doc(hidden)]
pub enum Decay<S> {
    /// The share of a velocity that is left after a second, 0 to 1.
    KeptPerSecond(S),
    /// The coefficient c of dv/dt = −c·v, 1/s, from 0.
    Rate(S),
}

impl<S> Decay<S> {
    /// The law in the same form by another number.
    pub(crate) fn try_map<T, E>(self, map: impl FnOnce(S) -> Result<T, E>) -> Result<Decay<T>, E> {
        match self {
            Self::KeptPerSecond(kept) => map(kept).map(Decay::KeptPerSecond),
            Self::Rate(rate) => map(rate).map(Decay::Rate),
        }
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
    /// The rate of a decay. [`decay_over`](Self::decay_over) takes it, so that the logarithm is computed once for all spans.
    /// *Domain* 0 ≤ share ≤ 1, 0 ≤ rate.
    fn decay_rate(decay: Decay<S>) -> Self::DecayRate;
    /// The share of a velocity that is left after a span at a rate: share^span or e^(−rate·span), the exact solution of
    /// dv/dt = v·ln share or dv/dt = −rate·v. *Domain* where the span is negative, share > 0 and a rate of which e^−rate is not 0 in `S`.
    fn decay_over(rate: Self::DecayRate, span: Span) -> S::Factor;
    /// The share of a velocity that is left after a second at a rate c, e^−c. For a negative rate that is too large for `S`, a share
    /// above 1.
    fn kept_at(rate: S) -> S;
    /// The distance covered at this velocity in `seconds`, m. *Domain* |v| < 2^26 m/s, seconds < 2.
    fn drift(self, seconds: S::Factor) -> S::Accumulator;
    /// The velocity gained at this acceleration in `seconds`, m/s; `None` from 2^21 on.
    fn kick(acceleration: S::Wide, seconds: S::Factor) -> Option<S::Accumulator>;
}

/// The rate at which a velocity decays: the opposite of the binary logarithm of what is left after a second.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub enum FxDecayRate {
    /// Nothing is left, over any span.
    Stops,
    /// In units of 2^-120: from 0 to 32, as a share has it.
    Share(u128),
    /// In units of 2^-94: below 2^32, as a rate has it.
    Rate(u128),
}

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
    power_of_two_parts((exponent >> 120) as i32, exponent << 8, negative)
}

/// 2^±(whole + fraction), the fraction in units of 2^-128. *Domain* 0 ≤ whole < 2^19.
fn power_of_two_parts(whole: i32, fraction: u128, negative: bool) -> FxFactor {
    match (negative, fraction) {
        (true, 0) => FxFactor::new(1, whole),
        // 2^-(n + f) = 2^-(n + 1) · 2^(1 − f).
        (true, _) => FxFactor::new(exp2_for_64_bits(fraction.wrapping_neg()), 127 + whole + 1),
        (false, _) => FxFactor::new(exp2_for_64_bits(fraction), 127 - whole),
    }
}

impl Motion<Fx> for Fx {
    type DecayRate = FxDecayRate;
    const IS_REVERSIBLE: bool = true;

    fn seconds(span: Span) -> FxFactor {
        span_factor(span.weight.magnitude(), 126, span)
    }

    fn half_square_seconds(num: u32, den: u32) -> FxFactor {
        let square = |n: u32| u64::from(n) * u64::from(n);
        FxFactor::from_ratio(square(num), square(den)).times(FxFactor::new(1, 1))
    }

    fn decay_rate(decay: Decay<Self>) -> FxDecayRate {
        match decay {
            Decay::KeptPerSecond(kept) => match kept.to_bits().unsigned_abs() {
                0 => FxDecayRate::Stops,
                bits => FxDecayRate::Share(log2_fine(bits).unsigned_abs()),
            },
            Decay::Rate(rate) => FxDecayRate::Rate(times_log2_e(rate.to_bits().unsigned_abs())),
        }
    }

    fn decay_over(rate: FxDecayRate, span: Span) -> FxFactor {
        /// No factor is as small, or as large.
        const FAR: u128 = 1 << 15;

        let (rate, units) = match rate {
            FxDecayRate::Stops => return FxFactor::ZERO,
            FxDecayRate::Share(rate) => (rate, 120),
            FxDecayRate::Rate(rate) => (rate, 94),
        };
        // −log2 of a share is in [0, 32], of a rate below 2^32: in its units either is below 2^126, times a weight below 2 it is
        // below 2^127.
        let (high, low) = mul_128(rate, span.weight.magnitude());
        let Some(whole) = shr_round_256(high, low, 126) else { return FxFactor::ZERO };
        // num <= den, so it is at most `whole`.
        let exponent = mul_ratio(whole, span.ratio.0, span.ratio.1);
        let exponent = if span.half { exponent >> 1 } else { exponent };
        power_of_two_parts((exponent >> units).min(FAR) as i32, exponent << (128 - units), !span.is_negative())
    }

    fn kept_at(rate: Self) -> Self {
        exp(rate.to_bits().saturating_neg()).map_or(Self::MAX, |kept| Self::from_bits(kept as i64))
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
