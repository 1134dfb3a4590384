//! The loops of [`Bulk`] in fixed point.
//!
//! These loops are most of the cost of a step of free bodies. They give the bits of the one-by-one operations
//! ([`Accumulator::damped`], [`Motion::drift`], [`Angle::drifted`]), which a test compares them with; where the CPU has wide
//! vectors, [`simd`](super::simd) takes over, with the same bits again.

use super::accumulator::FxAccumulator;
use super::bulk::{Bulk, DampedTurn, KickDriftKick, damped_turn_in_stages, kick_drift_kick_in_stages};
use super::factor::FxFactor;
use super::motion::Motion;
use super::number::{Accumulator, Angle};
use super::simd::{Damp, Drift, Kick, Spread, TurnAll, lanes_for};
use super::turn::Turn;
use crate::fx::Fx;
use crate::kernel::simd::{Job, Portable};

/// Half of the low word.
const TIE: u64 = 1 << 63;

/// A 128-bit number in two's complement, the low word first.
type Words = (u64, u64);

#[inline(always)]
const fn add_word(a: Words, b: u64) -> Words {
    let (low, carry) = a.0.overflowing_add(b);
    (low, a.1.wrapping_add(carry as u64))
}

/// a·b with a signed.
#[inline(always)]
const fn product(a: u64, b: u64) -> Words {
    let product = a as u128 * b as u128;
    let sign = (a as i64 >> 63) as u64;
    (product as u64, ((product >> 64) as u64).wrapping_sub(sign & b))
}

/// v·kept for a factor in [½, 1): its mantissa.
#[inline(always)]
pub(super) fn scaled(v: FxAccumulator, mantissa: u64) -> FxAccumulator {
    let low = u128::from(v.low) * u128::from(mantissa);
    let floor = add_word(product(v.high as u64, mantissa), (low >> 64) as u64);
    // Up if the rest is above half, or half and the floor odd.
    let (_, up) = (low as u64).overflowing_add(TIE - 1 + (floor.0 & 1));
    let rounded = add_word(floor, u64::from(up));
    // Within an ulp of zero its public value may be zero.
    if rounded.1.wrapping_add(1) <= 1 {
        return settled(rounded.0, rounded.1);
    }
    FxAccumulator { high: rounded.1 as i64, low: rounded.0 }
}

/// v·mantissa / 2^(64 + cut): the same for a factor in [½, 1) · 2^-cut. *Domain* 0 < cut < 64.
#[inline(always)]
fn scaled_down(v: FxAccumulator, mantissa: u64, cut: u32) -> FxAccumulator {
    let cut = cut & 63;
    let low = u128::from(v.low) * u128::from(mantissa);
    let (rest, floor) = (low as u64, add_word(product(v.high as u64, mantissa), (low >> 64) as u64));
    let kept = (i128::from(floor.1 as i64) << 64 | i128::from(floor.0)) >> cut;
    // The part that is cut off, as a word, with all lower bits gathered in its last bit: to compare with the half.
    let below = (u128::from(floor.0) << 64 | u128::from(rest)) >> cut;
    let below = below as u64 | u64::from(rest & ((1 << cut) - 1) != 0);
    let rounded = add_word((kept as u64, (kept >> 64) as u64), u64::from(below > TIE - (kept as u64 & 1)));
    if rounded.1.wrapping_add(1) <= 1 {
        return settled(rounded.0, rounded.1);
    }
    FxAccumulator { high: rounded.1 as i64, low: rounded.0 }
}

#[cold]
fn settled(low: u64, high: u64) -> FxAccumulator {
    let v = FxAccumulator { high: high as i64, low };
    if v.value() == Fx::ZERO { FxAccumulator::default() } else { v }
}

/// v·mantissa / 2^shift, to nearest, ties to even. *Domain* 1 <= shift <= 63.
#[inline(always)]
pub(super) fn passed(v: i64, mantissa: u64, shift: u32) -> i128 {
    let shift = shift & 63;
    let product = product(v as u64, mantissa);
    let odd = product.0 >> shift & 1;
    // Half is added, or one less where the floor is even: then a tie stays below.
    let (low, high) = add_word(product, (1 << shift >> 1) - 1 + odd);
    (i128::from(high as i64) << 64 | i128::from(low)) >> shift
}

/// See [`Accumulator::damped`].
#[inline(always)]
pub(super) fn damped(v: FxAccumulator, kept: FxFactor) -> FxAccumulator {
    match kept.parts() {
        (mantissa, 64) => scaled(v, mantissa),
        (mantissa, shift @ 65..128) => scaled_down(v, mantissa, (shift - 64).unsigned_abs()),
        // Values are below 2^122, so that less than 2^-64 of one is below half an ulp.
        (mantissa, shift) if mantissa == 0 || shift >= 128 => FxAccumulator::default(),
        _ => v.shrunk(kept),
    }
}

/// All bits set if negative, none if not: (x ^ mask) − mask is −x or x. Rounding is odd, so that a drift backwards is the drift
/// forwards negated.
fn mask(negative: bool) -> u64 {
    0u64.wrapping_sub(u64::from(negative))
}

/// The public velocity, or its opposite.
fn velocity(v: &FxAccumulator, backwards: u64) -> i64 {
    (v.value().to_bits() as u64 ^ backwards).wrapping_sub(backwards) as i64
}

/// The shift beside the mantissa's 64 bits with which a factor damps in the fused loops; `None` for 1 and for less than 2^-64.
fn cut(kept: FxFactor) -> Option<u32> {
    let cut = kept.parts().1.wrapping_sub(64);
    (0..64).contains(&cut).then_some(cut.unsigned_abs())
}

#[inline(always)]
fn damped_turn_fused(
    angles: &mut [Turn],
    velocities: &mut [FxAccumulator],
    span: &DampedTurn<Fx>,
    damped: impl Fn(FxAccumulator, u64) -> FxAccumulator,
) {
    let (kept, (mantissa, shift)) = (span.kept.parts().0, span.turn.parts());
    let shift = (shift - 32).unsigned_abs();
    for (angle, v) in angles.iter_mut().zip(velocities) {
        let midway = damped(*v, kept);
        angle.0 = angle.0.wrapping_add(passed(midway.value().to_bits(), mantissa, shift) as u64);
        *v = damped(midway, kept);
    }
}

/// Takes each body through all stages before the next, without leaving the registers.
#[inline(always)]
fn kick_drift_kick_fused<const KICKS: bool>(
    positions: &mut [FxAccumulator],
    velocities: &mut [FxAccumulator],
    span: &KickDriftKick<Fx>,
    damped: impl Fn(FxAccumulator) -> FxAccumulator,
) {
    let fall = span.gravity_delta_v;
    let (mantissa, shift) = span.seconds.parts();
    let shift = (shift - 64).unsigned_abs();
    let fallen = |v: FxAccumulator| if KICKS { v.plus(fall) } else { v };
    for (x, v) in positions.iter_mut().zip(velocities) {
        let midway = fallen(damped(*v));
        *x = x.plus(FxAccumulator::from_bits(passed(midway.value().to_bits(), mantissa, shift)));
        *v = damped(fallen(midway));
    }
}

impl Bulk<Fx> for Fx {
    fn damp_all(values: &mut [FxAccumulator], kept: FxFactor) {
        match kept.parts() {
            (mantissa, 64) => match lanes_for(values.len()) {
                Some(lanes) => lanes.run(Damp { values, mantissa }),
                None => values.iter_mut().for_each(|v| *v = scaled(*v, mantissa)),
            },
            (mantissa, shift @ 65..128) => {
                let cut = (shift - 64).unsigned_abs();
                values.iter_mut().for_each(|v| *v = scaled_down(*v, mantissa, cut));
            }
            _ => values.iter_mut().for_each(|v| *v = damped(*v, kept)),
        }
    }

    fn kick_all(values: &mut [FxAccumulator], gained: FxAccumulator) {
        match lanes_for(values.len()) {
            Some(lanes) => lanes.run(Kick { values, gained }),
            None => values.iter_mut().for_each(|v| *v = v.plus(gained)),
        }
    }

    fn drift_all(positions: &mut [FxAccumulator], velocities: &[FxAccumulator], seconds: FxFactor, negative: bool) {
        let ((mantissa, shift), backwards) = (seconds.parts(), mask(negative));
        // From units of 2^-32 and 2^-shift to units of 2^-96. A span of ½ s or more, or of none, is rare.
        let shift = shift.wrapping_sub(64) as u32;
        if !(1..64).contains(&shift) {
            for (x, v) in positions.iter_mut().zip(velocities) {
                *x = x.plus(Fx::from_bits(velocity(v, backwards)).drift(seconds));
            }
        } else if let Some(lanes) = lanes_for(positions.len()) {
            lanes.run(Drift { positions, velocities, mantissa, shift, backwards });
        } else {
            for (x, v) in positions.iter_mut().zip(velocities) {
                *x = x.plus(FxAccumulator::from_bits(passed(velocity(v, backwards), mantissa, shift)));
            }
        }
    }

    fn kick_drift_kick_all(
        positions: &mut [FxAccumulator],
        velocities: &mut [FxAccumulator],
        span: &KickDriftKick<Fx>,
    ) {
        let falls = span.gravity_delta_v != FxAccumulator::default();
        let shift = span.seconds.parts().1.wrapping_sub(64);
        // Wide vectors do better stage by stage: in a shorter loop more of its turns are on their way at once.
        if !(1..64).contains(&shift) || span.negative || lanes_for(velocities.len()).is_some() {
            return kick_drift_kick_in_stages(positions, velocities, span);
        }
        let kept = span.kept.parts().0;
        match (span.kept != FxFactor::ONE, cut(span.kept)) {
            (false, _) if !falls => Self::drift_all(positions, velocities, span.seconds, false),
            (false, _) => kick_drift_kick_fused::<true>(positions, velocities, span, |v| v),
            (true, Some(0)) if falls => kick_drift_kick_fused::<true>(positions, velocities, span, |v| scaled(v, kept)),
            (true, Some(0)) => kick_drift_kick_fused::<false>(positions, velocities, span, |v| scaled(v, kept)),
            (true, Some(cut)) => {
                kick_drift_kick_fused::<true>(positions, velocities, span, |v| scaled_down(v, kept, cut))
            }
            (true, None) => kick_drift_kick_in_stages(positions, velocities, span),
        }
    }

    fn damped_turn_all(angles: &mut [Turn], velocities: &mut [FxAccumulator], span: &DampedTurn<Fx>) {
        let shift = span.turn.parts().1.wrapping_sub(32);
        let usual = (1..64).contains(&shift) && !span.negative && lanes_for(velocities.len()).is_none();
        match cut(span.kept) {
            Some(0) if usual => damped_turn_fused(angles, velocities, span, scaled),
            Some(cut) if usual => damped_turn_fused(angles, velocities, span, |v, kept| scaled_down(v, kept, cut)),
            _ => damped_turn_in_stages(angles, velocities, span),
        }
    }

    fn turn_all(angles: &mut [Turn], velocities: &[FxAccumulator], factor: FxFactor, negative: bool) {
        let ((mantissa, shift), backwards) = (factor.parts(), mask(negative));
        // From units of 2^-32 and 2^-shift to units of 2^-64.
        let shift = shift.wrapping_sub(32) as u32;
        if !(1..64).contains(&shift) {
            for (angle, v) in angles.iter_mut().zip(velocities) {
                *angle = angle.drifted(Fx::from_bits(velocity(v, backwards)), factor, false);
            }
        } else if let Some(lanes) = lanes_for(angles.len()) {
            lanes.run(TurnAll { angles, velocities, mantissa, shift, backwards });
        } else {
            for (angle, v) in angles.iter_mut().zip(velocities) {
                angle.0 = angle.0.wrapping_add(passed(velocity(v, backwards), mantissa, shift) as u64);
            }
        }
    }

    fn are_within(values: &[FxAccumulator], log2: u32) -> bool {
        let limit = 1 << (32 + log2);
        // Below twice the limit, which is a power of two, if all are from −limit to limit.
        let spread = Spread { values, limit };
        let bits = match lanes_for(values.len()) {
            Some(lanes) => lanes.run(spread),
            None => spread.run(Portable),
        };
        bits < 2 * limit
    }
}

#[cfg(test)]
mod tests;
