//! Drag: the exact solution over a span of time, and where it is too stiff to run backwards.

use alloc::vec::Vec;
use core::ops::Range;

use super::{FieldKind, FieldSet, ForceField};
use crate::body::Bodies;
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Offset, Scalar};
use crate::slots::FieldId;

/// Drag over a span: the exact solution for each field, one after the other, in reverse order if
/// `mirrored`.
///
/// `only` says which of the coupled bodies feel it: with `Yoshida4` some feel theirs around the whole step.
pub(crate) fn resist<S: Scalar>(
    fields: &FieldSet<S>,
    bodies: &mut Bodies<S>,
    coupled: Range<usize>,
    span: (S::Factor, bool),
    mirrored: bool,
    only: impl Fn(usize) -> bool,
    faults: &mut Vec<(usize, Cause)>,
) {
    let mut one = |id: FieldId, field: &ForceField<S>| {
        let FieldKind::Drag { linear, quadratic, wind } = &field.kind else { return };
        for i in coupled.clone() {
            let info = bodies.info(i);
            if !info.feels(field.force_groups) || !only(i) {
                continue;
            }
            let mass = bodies.mass(i);
            let (inverse_mass, axes) = (mass.inverse_mass, mass.axis_inverse_mass);
            let velocities = &mut bodies.columns.motion.velocity;
            let velocity = velocities.get(i);
            // A square root for the quadratic part alone.
            let speed =
                if *quadratic == S::ZERO { S::Factor::ZERO } else { S::length(relative(velocity, *wind), S::ZERO) };
            let (alpha, beta) = (
                S::Factor::from_scalar(*linear).times(inverse_mass),
                S::Factor::from_scalar(*quadratic).times(inverse_mass),
            );
            let left = S::drag(speed, alpha, beta, span.0, span.1);
            if left == Some(S::Factor::ONE) {
                continue;
            }
            let slowed = left.and_then(|left| {
                let component = |v: S::Accumulator, w: S, inverse_mass: S::Factor| {
                    if inverse_mass.is_zero() {
                        return Some(v);
                    }
                    let w = S::Accumulator::from_scalar(w);
                    Some(v.plus(w.negated()).scaled(left)?.plus(w))
                };
                Some(Vec2::new(component(velocity.x, wind.x, axes.x)?, component(velocity.y, wind.y, axes.y)?))
            });
            match slowed {
                Some(slowed) => velocities.set(i, slowed),
                None => faults.push((i, Cause::Field { field: id })),
            }
        }
    };
    if mirrored {
        fields.iter().rev().for_each(|(id, field)| one(id, field));
    } else {
        fields.iter().for_each(|(id, field)| one(id, field));
    }
}

/// The public velocity relative to a medium.
fn relative<S: Scalar>(velocity: Vec2<S::Accumulator>, wind: Vec2<S>) -> Offset<S> {
    Vec2::new(velocity.x.value().offset(wind.x), velocity.y.value().offset(wind.y))
}

/// Marks the bodies whose drag is too stiff to run backwards, those with (linear + quadratic·|u|)/m·dt > ½ for one of
/// the fields, and counts them. |u| is the speed at the start and what `gain` says that the step may add.
pub(crate) fn outer_drag<S: Scalar>(
    fields: &FieldSet<S>,
    bodies: &Bodies<S>,
    coupled: Range<usize>,
    time_step: S::Factor,
    gain: impl Fn(usize) -> S::Factor,
    outside: &mut Vec<bool>,
) -> u32 {
    outside.clear();
    outside.resize(coupled.len(), false);
    let half = S::Factor::from_ratio(1, 2);
    let velocities = &bodies.columns.motion.velocity;
    for (_, field) in fields.iter() {
        let FieldKind::Drag { linear, quadratic, wind } = &field.kind else { continue };
        for (i, outside) in coupled.clone().zip(outside.iter_mut()) {
            let info = bodies.info(i);
            if info.feels(field.force_groups) {
                let speed = S::length(relative(velocities.get(i), *wind), S::ZERO).plus(gain(i));
                let slope = S::Factor::from_scalar(*linear).plus(S::Factor::from_scalar(*quadratic).times(speed));
                *outside |= slope.times(bodies.mass(i).inverse_mass).times(time_step) > half;
            }
        }
    }
    outside.iter().map(|&is| u32::from(is)).sum()
}
