//! The update rules of the stages, over the columns of the bodies that move.

use alloc::vec::Vec;

use super::Timing;
use crate::body::{Acceleration, Motion, Tuning};
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Factor, Scalar, Wide};

/// v *= d^h, linear and angular.
pub(crate) fn damp<S: Scalar>(
    motion: &mut Motion<S>,
    tuning: &[u32],
    rows: &[Tuning<S>],
    span: usize,
    faults: &mut Vec<(usize, Cause)>,
) {
    for (i, &row) in tuning.iter().enumerate() {
        let row = &rows[row as usize];
        if !row.is_damped {
            continue;
        }
        let one = S::Factor::ONE;
        if row.linear[span] != one {
            match motion.velocity[i].try_map(|v| v.scaled(row.linear[span])) {
                Some(velocity) => motion.velocity[i] = velocity,
                None => faults.push((i, Cause::Velocity)),
            }
        }
        if row.angular[span] != one {
            match motion.spin[i].scaled(row.angular[span]) {
                Some(spin) => motion.spin[i] = spin,
                None => faults.push((i, Cause::AngularVelocity)),
            }
        }
    }
}

/// v += g·h, from the factors that bodies share: the same bits for every mass.
pub(crate) fn kick_gravity<S: Scalar>(motion: &mut Motion<S>, tuning: &[u32], rows: &[Tuning<S>], span: usize) {
    for (velocity, &row) in motion.velocity.iter_mut().zip(tuning) {
        let fall = rows[row as usize].fall[span];
        *velocity = Vec2::new(velocity.x.plus(fall.x), velocity.y.plus(fall.y));
    }
}

/// v += a·h and ω += α·h for one body. What is beyond the limit of a kick is left out.
pub(crate) fn kick_by<S: Scalar>(
    motion: &mut Motion<S>,
    i: usize,
    acceleration: &Acceleration<S>,
    seconds: S::Factor,
    negative: bool,
) -> Result<(), Cause> {
    let gained = |a: S::Wide| S::kick(a, seconds).map(|v| if negative { v.negated() } else { v });
    if acceleration.linear != Vec2::default() {
        let gained = acceleration.linear.try_map(gained).ok_or(Cause::Velocity)?;
        let velocity = &mut motion.velocity[i];
        *velocity = Vec2::new(velocity.x.plus(gained.x), velocity.y.plus(gained.y));
    }
    if acceleration.angular != S::Wide::default() {
        let gained = gained(acceleration.angular).ok_or(Cause::AngularVelocity)?;
        motion.spin[i] = motion.spin[i].plus(gained);
    }
    Ok(())
}

/// x += v·h and θ += ω·h with the public velocities, so that what is below half an ulp a second moves nothing.
pub(crate) fn drift<S: Scalar>(motion: &mut Motion<S>, moving: usize, timing: &Timing<S>) {
    let way = |v: S::Accumulator| {
        let way = v.value().drift(timing.seconds);
        if timing.negative { way.negated() } else { way }
    };
    for i in 0..moving {
        let velocity = motion.velocity[i];
        let position = &mut motion.position[i];
        *position = Vec2::new(position.x.plus(way(velocity.x)), position.y.plus(way(velocity.y)));
        motion.angle[i] = motion.angle[i].drifted(motion.spin[i].value(), timing.turn, timing.negative);
    }
}

/// The sum of two accelerations; `None` if it does not fit.
pub(crate) fn sum<S: Scalar>(a: &Acceleration<S>, b: &Acceleration<S>) -> Option<Acceleration<S>> {
    Some(Acceleration {
        linear: Vec2::new(a.linear.x.plus(b.linear.x)?, a.linear.y.plus(b.linear.y)?),
        angular: a.angular.plus(b.angular)?,
    })
}
