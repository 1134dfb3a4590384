//! Friction with a ground that is seen from above.

use core::ops::Range;

use super::{FieldKind, FieldSet};
use crate::body::Bodies;
use crate::scalar::{Accumulator as _, Factor as _, Scalar, Wide as _};

/// Lets the frictions of fields act on bodies over a span of time, seconds. The decelerations of fields that act on one body are added: sums of
/// numbers up to 2^16 in units of 2^-32 are exact, so that their order makes no difference.
///
/// A body loses speed by the deceleration times the span, in its direction, and no more than it has: then it stands still to the bit.
///
/// *Error* 1 ulp of a speed, 2^-61 of a loss.
pub(crate) fn rub<S: Scalar>(fields: &FieldSet<S>, bodies: &mut Bodies<S>, indices: Range<usize>, seconds: S::Factor) {
    for i in indices {
        let [mut linear, mut angular] = [S::Factor::ZERO; 2];
        for (_, field) in fields.iter().filter(|(_, field)| bodies.info(i).feels(field.force_groups)) {
            if let FieldKind::Friction { deceleration, angular_deceleration } = field.kind {
                linear = linear.plus(S::Factor::from_scalar(deceleration));
                angular = angular.plus(S::Factor::from_scalar(angular_deceleration));
            }
        }
        let motion = &mut bodies.columns.motion;
        if !linear.is_zero() {
            let velocity = motion.velocity.get(i);
            let speed = S::length(velocity.map(|part| S::Wide::from_scalar(part.value())), S::ZERO);
            let left = share_left::<S>(speed, linear.times(seconds));
            motion.velocity.set(i, velocity.map(|part| slowed::<S>(part, left)));
        }
        if !angular.is_zero() {
            let velocity = motion.angular_velocity[i];
            let left = share_left::<S>(S::Factor::from_scalar(velocity.value()), angular.times(seconds));
            motion.angular_velocity[i] = slowed::<S>(velocity, left);
        }
    }
}

/// The share of a speed that is left when so much of it is lost; `None` if nothing is.
fn share_left<S: Scalar>(speed: S::Factor, loss: S::Factor) -> Option<S::Factor> {
    (speed > loss).then(|| speed.minus(loss).over(speed))
}

/// A part of a velocity of which a share is left. *Domain* a share is at most 1, and velocities within a step are below 2^26.
fn slowed<S: Scalar>(part: S::Accumulator, left: Option<S::Factor>) -> S::Accumulator {
    left.map_or(S::Accumulator::default(), |left| part.damped(left))
}
