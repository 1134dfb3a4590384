//! Loops over many bodies at once: damping, kicks, drifts, and several of them in one pass.
//!
//! The loops of `Fx` are in [`fx_bulk`](super::fx_bulk).

use super::number::{Accumulator, Angle, Factor, Scalar};
use crate::fx::Fx;

/// Rules of a step for many bodies at once.
#[doc(hidden)]
pub trait Bulk<S: Scalar>: Sized {
    /// Multiplies each value by `kept`; a value whose nearest scalar is then zero becomes zero. *Domain* kept <= 1, values below 2^26.
    fn damp_all(values: &mut [S::Accumulator], kept: S::Factor) {
        values.iter_mut().for_each(|v| *v = v.damped(kept));
    }
    /// Adds `gained` to each value. *Domain* the sums fit, as for [`Accumulator::plus`].
    fn kick_all(values: &mut [S::Accumulator], gained: S::Accumulator) {
        values.iter_mut().for_each(|v| *v = v.plus(gained));
    }
    /// Adds to each position the distance covered at the rounded velocity in `seconds`, backwards if `negative`. *Domain* as for
    /// [`Motion::drift`](super::motion::Motion::drift).
    fn drift_all(positions: &mut [S::Accumulator], velocities: &[S::Accumulator], seconds: S::Factor, negative: bool) {
        for (x, v) in positions.iter_mut().zip(velocities) {
            let way = v.value().drift(seconds);
            *x = x.plus(if negative { way.negated() } else { way });
        }
    }
    /// Damps, kicks, drifts, kicks and damps each body.
    fn kick_drift_kick_all(
        positions: &mut [S::Accumulator],
        velocities: &mut [S::Accumulator],
        span: &KickDriftKick<S>,
    ) {
        kick_drift_kick_in_stages(positions, velocities, span);
    }
    /// Damps, turns and damps each body.
    fn damped_turn_all(angles: &mut [S::Angle], velocities: &mut [S::Accumulator], span: &DampedTurn<S>) {
        damped_turn_in_stages(angles, velocities, span);
    }
    /// Turns each angle at the rounded angular velocity for the span of `drift_factor`, as [`Angle::drifted`] does.
    fn turn_all(angles: &mut [S::Angle], velocities: &[S::Accumulator], drift_factor: S::Factor, negative: bool) {
        for (angle, v) in angles.iter_mut().zip(velocities) {
            *angle = angle.drifted(v.value(), drift_factor, negative);
        }
    }
    /// Returns true if all values are finite and their magnitudes at most 2^log2; it may return false for a value at the limit
    /// itself. *Domain* log2 < 31.
    fn are_within(values: &[S::Accumulator], log2: u32) -> bool {
        let limit = S::from_fx(Fx::from_bits(1 << (32 + log2)));
        values.iter().fold(true, |all, v| all & v.is_within(limit))
    }
}

/// The factors of one step of damp, kick, drift, kick, damp, in which nothing acts but damping and a constant acceleration.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct KickDriftKick<S: Scalar> {
    /// Share of the velocity that damping leaves over half of the span, at most 1.
    pub kept: S::Factor,
    /// Velocity gained from gravity over half of the span, m/s.
    pub gravity_delta_v: S::Accumulator,
    /// Length of the span, s.
    pub seconds: S::Factor,
    /// True if time runs backwards in the span.
    pub negative: bool,
}

/// The factors of one step of damp, turn, damp.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct DampedTurn<S: Scalar> {
    /// Share of the angular velocity that damping leaves over half of the span, at most 1.
    pub kept: S::Factor,
    /// [`Angle::drift_factor`] of the span.
    pub turn: S::Factor,
    /// True if time runs backwards in the span.
    pub negative: bool,
}

/// [`Bulk::damped_turn_all`], one stage after the other.
pub(super) fn damped_turn_in_stages<S: Scalar>(
    angles: &mut [S::Angle],
    velocities: &mut [S::Accumulator],
    span: &DampedTurn<S>,
) {
    let damped = span.kept != S::Factor::ONE;
    if damped {
        S::damp_all(velocities, span.kept);
    }
    S::turn_all(angles, velocities, span.turn, span.negative);
    if damped {
        S::damp_all(velocities, span.kept);
    }
}

/// [`Bulk::kick_drift_kick_all`], one stage after the other.
pub(super) fn kick_drift_kick_in_stages<S: Scalar>(
    positions: &mut [S::Accumulator],
    velocities: &mut [S::Accumulator],
    span: &KickDriftKick<S>,
) {
    let damped = span.kept != S::Factor::ONE;
    let falls = span.gravity_delta_v != S::Accumulator::default();
    if damped {
        S::damp_all(velocities, span.kept);
    }
    if falls {
        S::kick_all(velocities, span.gravity_delta_v);
    }
    S::drift_all(positions, velocities, span.seconds, span.negative);
    if falls {
        S::kick_all(velocities, span.gravity_delta_v);
    }
    if damped {
        S::damp_all(velocities, span.kept);
    }
}
