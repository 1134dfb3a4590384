//! Friction with a ground that is seen from above.

use alloc::vec::Vec;
use core::ops::Range;

use super::{FieldKind, FieldSet};
use crate::body::Bodies;
use crate::scalar::{Accumulator as _, Factor as _, Scalar, Wide as _};

/// The friction of a field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Friction<S: Scalar> {
    force_groups: u32,
    deceleration: S::Factor,
    angular_deceleration: S::Factor,
}

impl<S: Scalar> Friction<S> {
    /// Adds the frictions among the fields, of which there may be thousands, to a list.
    pub(crate) fn list(fields: &FieldSet<S>, frictions: &mut Vec<Self>) {
        for (_, field) in fields.iter() {
            if let FieldKind::Friction { deceleration, angular_deceleration } = field.kind {
                let [deceleration, angular_deceleration] =
                    [deceleration, angular_deceleration].map(S::Factor::from_scalar);
                frictions.push(Self { force_groups: field.force_groups, deceleration, angular_deceleration });
            }
        }
    }
}

/// Lets frictions act on bodies over a span of time, seconds. The decelerations of fields that act on one body are added: sums of
/// numbers up to 2^16 in units of 2^-32 are exact, so that their order makes no difference.
///
/// A body loses speed by the deceleration times the span, in its direction, and no more than it has: then it stands still to the bit.
///
/// *Error* 1 ulp of a speed, 2^-61 of a loss.
pub(crate) fn rub<S: Scalar>(
    frictions: &[Friction<S>],
    bodies: &mut Bodies<S>,
    indices: Range<usize>,
    seconds: S::Factor,
) {
    for i in indices {
        let [mut linear, mut angular] = [S::Factor::ZERO; 2];
        for friction in frictions.iter().filter(|friction| bodies.info(i).feels(friction.force_groups)) {
            linear = linear.plus(friction.deceleration);
            angular = angular.plus(friction.angular_deceleration);
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
