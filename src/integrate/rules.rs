//! The update rules of the stages, over a block of moving bodies.

use alloc::vec::Vec;

use super::Timing;
use crate::body::{Acceleration, Block, StepFactors};
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, DampedTurn, Factor, KickDriftKick, Scalar, Wide};

/// The factors of the bodies of a block; in most blocks all bodies have the same.
#[derive(Clone, Copy)]
pub(crate) enum BlockFactors<'a, S: Scalar> {
    Alike(&'a StepFactors<S>),
    Each(&'a [StepFactors<S>]),
}

impl<'a, S: Scalar> BlockFactors<'a, S> {
    pub(crate) fn of(block: &Block<'_, S>, rows: &'a [StepFactors<S>]) -> Self {
        let first = block.factors.first().copied().unwrap_or_default();
        // Without a branch a body: the compiler compares many at once.
        let differ = block.factors.iter().fold(0, |differ, row| differ | (row ^ first));
        match rows.get(first as usize) {
            Some(row) if differ == 0 => Self::Alike(row),
            _ => Self::Each(rows),
        }
    }

    /// Returns true if no damping runs backwards.
    pub(crate) fn decay(&self, block: &Block<'_, S>) -> bool {
        match self {
            Self::Alike(row) => row.decays,
            Self::Each(rows) => block.factors.iter().all(|&row| rows[row as usize].decays),
        }
    }

    /// Returns true if no stage could take a body of the block out of the allowed range if it is well inside.
    pub(crate) fn are_bounded(&self, block: &Block<'_, S>) -> bool {
        match self {
            Self::Alike(row) => row.is_bounded,
            Self::Each(rows) => block.factors.iter().all(|&row| rows[row as usize].is_bounded),
        }
    }
}

/// v *= d^h, linear and angular.
pub(crate) fn damp<S: Scalar>(
    block: &mut Block<'_, S>,
    factors: BlockFactors<'_, S>,
    span: usize,
    turns: bool,
    faults: &mut Vec<(usize, Cause)>,
) {
    match factors {
        BlockFactors::Alike(row) if !row.is_damped => {}
        BlockFactors::Alike(row) if row.decays => {
            let unit = S::Factor::ONE;
            if row.linear[span] != unit {
                block.velocity.iter_mut().for_each(|v| S::damp_all(v, row.linear[span]));
            }
            if turns && row.angular[span] != unit {
                S::damp_all(block.angular_velocity, row.angular[span]);
            }
        }
        BlockFactors::Alike(row) => (0..block.len()).for_each(|i| damp_one(block, i, row, span, faults)),
        BlockFactors::Each(rows) => {
            (0..block.len()).for_each(|i| damp_one(block, i, &rows[block.factors[i] as usize], span, faults));
        }
    }
}

#[inline(always)]
fn damp_one<S: Scalar>(
    block: &mut Block<'_, S>,
    i: usize,
    row: &StepFactors<S>,
    span: usize,
    faults: &mut Vec<(usize, Cause)>,
) {
    let (linear, angular, unit) = (row.linear[span], row.angular[span], S::Factor::ONE);
    // Damping that runs backwards may go too far.
    let damped =
        |v: S::Accumulator, kept| if row.decays || kept <= unit { Some(v.damped(kept)) } else { v.scaled(kept) };
    if linear != unit {
        let [x, y] = &mut block.velocity;
        match (damped(x[i], linear), damped(y[i], linear)) {
            (Some(vx), Some(vy)) => (x[i], y[i]) = (vx, vy),
            _ => faults.push((block.first + i, Cause::Velocity)),
        }
    }
    if angular != unit {
        match damped(block.angular_velocity[i], angular) {
            Some(angular_velocity) => block.angular_velocity[i] = angular_velocity,
            None => faults.push((block.first + i, Cause::AngularVelocity)),
        }
    }
}

/// The change of velocity by gravity over a span.
fn gravity_over<S: Scalar>(row: &StepFactors<S>, span: usize, backwards: bool) -> Vec2<S::Accumulator> {
    let delta_v = row.gravity_delta_v[span];
    if backwards { delta_v.map(Accumulator::negated) } else { delta_v }
}

/// v += g·h, from the factors that bodies share: the same bits for every mass. v −= g·h if `backwards`.
pub(crate) fn gravity_delta_v<S: Scalar>(
    block: &mut Block<'_, S>,
    factors: BlockFactors<'_, S>,
    span: usize,
    backwards: bool,
) {
    let none = S::Accumulator::default();
    let [x, y] = &mut block.velocity;
    match factors {
        BlockFactors::Alike(row) => {
            let gained = gravity_over(row, span, backwards);
            for (v, gained) in [(x, gained.x), (y, gained.y)] {
                if gained != none {
                    S::kick_all(v, gained);
                }
            }
        }
        BlockFactors::Each(rows) => {
            for (i, &row) in block.factors.iter().enumerate() {
                let gained = gravity_over(&rows[row as usize], span, backwards);
                (x[i], y[i]) = (x[i].plus(gained.x), y[i].plus(gained.y));
            }
        }
    }
}

/// v += a·h and ω += α·h for the body at this index of the columns. A component beyond the limit of a kick is left out.
pub(crate) fn kick_by<S: Scalar>(
    block: &mut Block<'_, S>,
    index: usize,
    acceleration: &Acceleration<S>,
    seconds: S::Factor,
    negative: bool,
) -> Result<(), Cause> {
    let i = index - block.first;
    if acceleration.linear != Vec2::default() {
        let x = gained::<S>(acceleration.linear.x, seconds, negative).ok_or(Cause::Velocity)?;
        let y = gained::<S>(acceleration.linear.y, seconds, negative).ok_or(Cause::Velocity)?;
        let velocity = &mut block.velocity;
        (velocity[0][i], velocity[1][i]) = (velocity[0][i].plus(x), velocity[1][i].plus(y));
    }
    if acceleration.angular != S::Wide::default() {
        let gained = gained::<S>(acceleration.angular, seconds, negative).ok_or(Cause::AngularVelocity)?;
        block.angular_velocity[i] = block.angular_velocity[i].plus(gained);
    }
    Ok(())
}

/// The velocity gained, backwards if `negative`. As a call it would take a tenth longer to kick a body.
#[inline(always)]
fn gained<S: Scalar>(acceleration: S::Wide, seconds: S::Factor, negative: bool) -> Option<S::Accumulator> {
    let gained = S::kick(acceleration, seconds)?;
    Some(if negative { gained.negated() } else { gained })
}

/// x += v·h and θ += ω·h with the public velocities, so that what is below half an ulp a second moves nothing.
pub(crate) fn drift<S: Scalar>(block: &mut Block<'_, S>, timing: &Timing<S>, turns: bool) {
    for (x, v) in block.position.iter_mut().zip(&block.velocity) {
        S::drift_all(x, v, timing.seconds, timing.negative);
    }
    if turns {
        S::turn_all(block.angle, block.angular_velocity, timing.turn, timing.negative);
    }
}

/// The stages damp, kick, drift, kick, damp in one loop, for bodies that share their factors and whose damping decays. The
/// drift takes the span of `timing`, the others the span `half`.
pub(crate) fn fused_kick_drift_kick<S: Scalar>(
    block: &mut Block<'_, S>,
    row: &StepFactors<S>,
    half: usize,
    timing: &Timing<S>,
    turns: bool,
    backwards: bool,
) {
    let Vec2 { x, y } = gravity_over(row, half, backwards);
    for ((x, v), fall) in block.position.iter_mut().zip(&mut block.velocity).zip([x, y]) {
        let (kept, seconds, negative) = (row.linear[half], timing.seconds, timing.negative);
        S::kick_drift_kick_all(x, v, &KickDriftKick { kept, gravity_delta_v: fall, seconds, negative });
    }
    if turns {
        let span = DampedTurn { kept: row.angular[half], turn: timing.turn, negative: timing.negative };
        S::damped_turn_all(block.angle, block.angular_velocity, &span);
    }
}

/// Damps, kicks and drifts bodies with factors of their own: each looks its factors up before the drift and after it.
// Inlined into the free pass it takes registers from the loop over bodies that share their factors.
#[inline(never)]
pub(crate) fn fused_kick_drift_kick_each<S: Scalar>(
    block: &mut Block<'_, S>,
    rows: &[StepFactors<S>],
    half: usize,
    timing: &Timing<S>,
    turns: bool,
    backwards: bool,
) {
    damp_and_accelerate::<S, true>(block, rows, half, backwards);
    drift(block, timing, turns);
    damp_and_accelerate::<S, false>(block, rows, half, backwards);
}

/// Damping, then gravity, body by body; the other way round unless `OPENING`. *Domain* all dampings decay.
#[inline(always)]
fn damp_and_accelerate<S: Scalar, const OPENING: bool>(
    block: &mut Block<'_, S>,
    rows: &[StepFactors<S>],
    span: usize,
    backwards: bool,
) {
    let [x, y] = &mut block.velocity;
    let velocities = x.iter_mut().zip(y.iter_mut()).zip(block.angular_velocity.iter_mut());
    for (((x, y), angular_velocity), &row) in velocities.zip(block.factors) {
        let row = &rows[row as usize];
        let gained = gravity_over(row, span, backwards);
        if !OPENING {
            (*x, *y) = (x.plus(gained.x), y.plus(gained.y));
        }
        if row.is_damped {
            // Without damping not even what is below the public value is lost.
            let (linear, angular, unit) = (row.linear[span], row.angular[span], S::Factor::ONE);
            if linear != unit {
                (*x, *y) = (x.damped(linear), y.damped(linear));
            }
            if angular != unit {
                *angular_velocity = angular_velocity.damped(angular);
            }
        }
        if OPENING {
            (*x, *y) = (x.plus(gained.x), y.plus(gained.y));
        }
    }
}

/// Slows down to their caps the bodies of a block that are faster, in their direction.
///
/// *Error* the speed is scaled from the public velocity and within 2^-62 relative, so that the public speed is at most the cap
/// and √½ ulp, by which rounding its components may lengthen it. Each component, to its last bit, and the angular speed are
/// at most the cap, as the limit of speeds is one.
#[inline(never)]
pub(crate) fn cap<S: Scalar>(block: &mut Block<'_, S>, factors: BlockFactors<'_, S>) {
    if matches!(factors, BlockFactors::Alike(row) if !row.key.is_capped()) {
        return;
    }
    let [x, y] = &mut block.velocity;
    for (i, &row) in block.factors.iter().enumerate() {
        let row = match factors {
            BlockFactors::Alike(row) => row,
            BlockFactors::Each(rows) => &rows[row as usize],
        };
        let [speed, angular_velocity] = if row.key.is_capped() { row.key.most } else { continue };
        if let Some(max_speed) = speed {
            let v = Vec2::new(x[i].value(), y[i].value());
            let way = v.map(S::Wide::from_scalar);
            if !max_speed.reaches(way) {
                let kept = S::Factor::from_scalar(max_speed).over(S::length(way, S::ZERO));
                let slowed = v.map(|v| S::Accumulator::from_scalar(v).damped(kept));
                (x[i], y[i]) = (slowed.x, slowed.y);
            }
            // The factor is rounded, and below the ulp the velocity may be above what it is in public.
            (x[i], y[i]) = (clamp::<S>(x[i], max_speed), clamp::<S>(y[i], max_speed));
        }
        if let Some(max_speed) = angular_velocity {
            block.angular_velocity[i] = clamp::<S>(block.angular_velocity[i], max_speed);
        }
    }
}

/// The value within ±`limit` that is nearest to `value`.
fn clamp<S: Scalar>(value: S::Accumulator, limit: S) -> S::Accumulator {
    // A float that is no number stays one, to be found.
    if value.is_within(limit) || !value.value().is_finite() {
        return value;
    }
    let limit = S::Accumulator::from_scalar(limit);
    if value.value() < S::ZERO { limit.negated() } else { limit }
}

/// The sum of two accelerations; `None` if it does not fit.
pub(crate) fn sum<S: Scalar>(a: &Acceleration<S>, b: &Acceleration<S>) -> Option<Acceleration<S>> {
    Some(Acceleration {
        linear: Vec2::new(a.linear.x.plus(b.linear.x)?, a.linear.y.plus(b.linear.y)?),
        angular: a.angular.plus(b.angular)?,
    })
}
