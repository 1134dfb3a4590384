//! Drag: the exact solution over a span of time, and where it is too stiff to run backwards.

use alloc::vec::Vec;
use core::ops::Range;

use super::buoyancy::{Fluids, whole_area};
use super::{FieldKind, FieldSet, ForceField};
use crate::body::Bodies;
use crate::collider::ColliderSet;
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Offset, Scalar, Sum};
use crate::shape::Aabb;
use crate::slots::FieldId;

/// The drag of a field on a body: the equations du/dt = −(linear + quadratic·|u|)/m·u, with u the velocity relative to the medium, and
/// dω/dt = −angular/I·ω.
struct Resistance<S: Scalar> {
    linear: S::Factor,
    quadratic: S::Factor,
    angular: S::Factor,
    medium: Vec2<S>,
}

/// The drag of a field on body `i`: `None` if it has none, `Some(None)` if it is too large.
fn resistance<S: Scalar>(
    id: FieldId,
    kind: &FieldKind<S>,
    fluids: &mut Fluids<'_, S>,
    bodies: &Bodies<S>,
    i: usize,
) -> Option<Option<Resistance<S>>> {
    let factor = S::Factor::from_scalar;
    match kind {
        FieldKind::Drag { linear, quadratic, wind } => {
            let [linear, quadratic] = [*linear, *quadratic].map(factor);
            Some(Some(Resistance { linear, quadratic, angular: S::Factor::ZERO, medium: *wind }))
        }
        FieldKind::Buoyancy { min, max, linear_drag, angular_drag, flow, .. } if kind.has_drag() => {
            let bounds = Aabb { min: *min, max: *max };
            let part = fluids.parts.of(bodies, fluids.colliders, i, id, bounds)?;
            let of_area = |area: S::Wide| {
                let [linear, angular] =
                    [*linear_drag, *angular_drag].map(|drag| factor(drag).times(S::Factor::from_wide(area)));
                Resistance { linear, quadratic: S::Factor::ZERO, angular, medium: *flow }
            };
            Some(part.area.total().map(of_area))
        }
        _ => None,
    }
}

/// Drag over a span: the exact solution for each field, one after the other, in reverse order if
/// `mirrored`.
///
/// `only` says which of the coupled bodies feel it: with `Yoshida4` some feel theirs around the whole step.
pub(crate) fn resist<S: Scalar>(
    mut fluids: Fluids<'_, S>,
    bodies: &mut Bodies<S>,
    coupled: Range<usize>,
    span: (S::Factor, bool),
    mirrored: bool,
    only: impl Fn(usize) -> bool,
    faults: &mut Vec<(usize, Cause)>,
) {
    let fields = fluids.fields;
    let mut memo = S::DragMemo::default();
    let mut add_drag = |id: FieldId, field: &ForceField<S>| {
        if !field.kind.has_drag() {
            return;
        }
        for i in coupled.clone() {
            if !bodies.info(i).feels(field.force_groups) || !only(i) {
                continue;
            }
            let Some(resistance) = resistance(id, &field.kind, &mut fluids, bodies, i) else { continue };
            if resistance.and_then(|resistance| slow_down(bodies, i, &resistance, span, &mut memo)).is_none() {
                faults.push((i, Cause::Field { field: id }));
            }
        }
    };
    if mirrored {
        fields.iter().rev().for_each(|(id, field)| add_drag(id, field));
    } else {
        fields.iter().for_each(|(id, field)| add_drag(id, field));
    }
}

/// Lets drag act on a body over a span; `None` if a velocity does not fit.
fn slow_down<S: Scalar>(
    bodies: &mut Bodies<S>,
    i: usize,
    resistance: &Resistance<S>,
    span: (S::Factor, bool),
    memo: &mut S::DragMemo,
) -> Option<()> {
    let Resistance { linear, quadratic, angular, medium } = *resistance;
    let mass = bodies.mass(i);
    let (inverse_mass, axes, inverse_inertia) = (mass.inverse_mass, mass.axis_inverse_mass, mass.inverse_inertia);
    let motion = &mut bodies.columns.motion;
    let velocity = motion.velocity.get(i);
    // A square root for the quadratic part alone.
    let speed = if quadratic.is_zero() { S::Factor::ZERO } else { S::length(relative(velocity, medium), S::ZERO) };
    let left = S::drag(memo, speed, linear.times(inverse_mass), quadratic.times(inverse_mass), span.0, span.1)?;
    if left != S::Factor::ONE {
        let component = |v: S::Accumulator, w: S, inverse_mass: S::Factor| {
            if inverse_mass.is_zero() {
                return Some(v);
            }
            let w = S::Accumulator::from_scalar(w);
            Some(v.plus(w.negated()).scaled(left)?.plus(w))
        };
        let slowed = Vec2::new(component(velocity.x, medium.x, axes.x)?, component(velocity.y, medium.y, axes.y)?);
        motion.velocity.set(i, slowed);
    }
    if !angular.is_zero() {
        let left = S::drag(memo, S::Factor::ZERO, angular.times(inverse_inertia), S::Factor::ZERO, span.0, span.1)?;
        motion.angular_velocity[i] = motion.angular_velocity[i].scaled(left)?;
    }
    Some(())
}

/// The public velocity relative to a medium.
fn relative<S: Scalar>(velocity: Vec2<S::Accumulator>, wind: Vec2<S>) -> Offset<S> {
    Vec2::new(velocity.x.value().offset(wind.x), velocity.y.value().offset(wind.y))
}

/// Marks the bodies whose drag is too stiff to run backwards, those with (linear + quadratic·|u|)/m·dt > ½ for one of
/// the fields, and counts them. |u| is the speed at the start plus the `gain` that the step may add. The drag of a fluid is judged as
/// if all of the body were in it, as the step may take it there.
pub(crate) fn outer_drag<S: Scalar>(
    fields: &FieldSet<S>,
    colliders: &ColliderSet<S>,
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
        if !field.kind.has_drag() {
            continue;
        }
        for (i, outside) in coupled.clone().zip(outside.iter_mut()) {
            if !bodies.info(i).feels(field.force_groups) {
                continue;
            }
            let mass = bodies.mass(i);
            let factor = S::Factor::from_scalar;
            let is_stiff = |slope: S::Factor, inverse: S::Factor| slope.times(inverse).times(time_step) > half;
            *outside |= match &field.kind {
                FieldKind::Drag { linear, quadratic, wind } => {
                    let speed = S::length(relative(velocities.get(i), *wind), S::ZERO).plus(gain(i));
                    is_stiff(factor(*linear).plus(factor(*quadratic).times(speed)), mass.inverse_mass)
                }
                FieldKind::Buoyancy { linear_drag, angular_drag, .. } => {
                    let area = whole_area(bodies, colliders, i);
                    is_stiff(factor(*linear_drag).times(area), mass.inverse_mass)
                        || is_stiff(factor(*angular_drag).times(area), mass.inverse_inertia)
                }
                _ => false,
            };
        }
    }
    outside.iter().map(|&is| u32::from(is)).sum()
}
