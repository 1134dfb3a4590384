//! The spring of an axis: factors by which one body moves as the exact solution says.
//!
//! With the length h of a sub-step, the natural frequency ω, the damping ratio ζ, E = e^(−ζhω) and the effective mass m of the row, one body
//! moves as the exact solution says, in period and decay, and under a steady force it rests where it should:
//!
//! ```text
//! Q = (1 − E)² + 4·E·sin²(hω·√(1 − ζ²)/2)      s = m·(hω)²      d = s/Q − m      e = m − E²·s/Q
//! ```
//!
//! Above ζ = 1, Q = (1 − E₁)·(1 − E₂) for both exponents. From hω = 1/2 on the implicit values d = m·hω·(2ζ + hω) and e = 0 stand in their
//! place, which are stable for all frequencies.

use super::{AxisSpring, STIFFEST};
use crate::fx::Fx;
use crate::kernel::trig::sin_cos_turn;
use crate::scalar::{FxFactor, exponential};
use crate::solve::unit::Clock;

/// d, e and s of a spring over the effective mass of its row.
pub(super) struct SpringFactors {
    pub(super) damping: FxFactor,
    pub(super) start: FxFactor,
    pub(super) is_start_negative: bool,
    pub(super) stiffness: FxFactor,
}

impl SpringFactors {
    pub(super) const NONE: Self =
        Self { damping: FxFactor::ZERO, start: FxFactor::ZERO, is_start_negative: false, stiffness: FxFactor::ZERO };

    pub(super) fn new(spring: &AxisSpring, clock: &Clock) -> Self {
        let ratio = FxFactor::from_scalar(spring.damping_ratio);
        let turns = FxFactor::from_scalar(spring.frequency).times(clock.substep);
        let two = FxFactor::from_ratio(2, 1);
        let angle = turns.times(FxFactor::PI).times(two);
        if angle.is_zero() {
            return Self::NONE;
        }
        let stiffness = angle.times(angle);
        let factors = if angle > FxFactor::from_ratio(1, 2) {
            Self { damping: angle.times(ratio.times(two).plus(angle)), stiffness, ..Self::NONE }
        } else {
            Self::exact(ratio, turns, angle)
        };
        // No stiffer than other rows.
        let limit = FxFactor::from_ratio(1 << STIFFEST, 1);
        if factors.damping <= limit {
            return factors;
        }
        let share = limit.over(factors.damping);
        Self { damping: limit, stiffness: factors.stiffness.times(share), start: factors.start.times(share), ..factors }
    }

    /// The factors of the exact solution. *Domain* hω above zero, at most 1/2.
    fn exact(ratio: FxFactor, turns: FxFactor, angle: FxFactor) -> Self {
        let decay = |exponent: FxFactor| exponential(exponent, false).unwrap_or(FxFactor::ZERO);
        let lost = |decayed: FxFactor| FxFactor::ONE.minus(decayed);
        let root = |value: FxFactor| {
            value.to_scalar().and_then(Fx::checked_sqrt).map_or(FxFactor::ZERO, FxFactor::from_scalar)
        };
        let square = ratio.times(ratio);
        let whole = decay(angle.times(ratio));
        let q = if ratio <= FxFactor::ONE {
            let half_turns = turns.times(root(FxFactor::ONE.minus(square))).times(FxFactor::from_ratio(1, 2));
            // At most 1/(8π) turns.
            let (sin, _) = sin_cos_turn(half_turns.to_fixed(64).unwrap_or(0) as u64);
            let sin = FxFactor::new(sin.unsigned_abs().into(), 62);
            let four = FxFactor::from_ratio(4, 1);
            lost(whole).times(lost(whole)).plus(four.times(whole).times(sin).times(sin))
        } else {
            let fast = ratio.plus(root(square.minus(FxFactor::ONE)));
            // The product of both is 1.
            lost(decay(angle.times(fast))).times(lost(decay(angle.over(fast))))
        };
        let stiffness = angle.times(angle);
        if q.is_zero() {
            return Self { stiffness, ..Self::NONE };
        }
        let whole_mass = stiffness.over(q);
        let kept = whole.times(whole).times(whole_mass);
        let is_start_negative = kept > FxFactor::ONE;
        let start = if is_start_negative { kept.minus(FxFactor::ONE) } else { lost(kept) };
        Self { damping: whole_mass.minus(FxFactor::ONE), start, is_start_negative, stiffness }
    }
}
