//! The forces and torques that were applied since the last step, as accelerations that are constant over the step.
//!
//! Reads: the applied sums, masses, locks. Writes: the applied accelerations.

use alloc::vec::Vec;

use super::AppliedAcceleration;
use crate::body::{Acceleration, Block, Bodies, MassProperties};
use crate::force::Applied;
use crate::math::Vec2;
use crate::scalar::{Factor, Scalar, Sum, Wide};

/// a = Σ accelerations + Σ F / m, α = Σ τ / I, none along a locked axis; `None` if a sum does not fit. *Domain* the body is
/// dynamic.
// Inlined, as are its parts, so that the sums are read where they lie and the result is written where it goes: a CPU waits for words that
// were just written and are copied by two at a time.
#[inline(always)]
pub(super) fn acceleration<S: Scalar>(
    acceleration: &Vec2<S::Sum>,
    force: &Vec2<S::Sum>,
    torque: &S::Sum,
    mass: &MassProperties<S>,
) -> Option<Acceleration<S>> {
    // A torque on a body of infinite inertia has to fit.
    let torque = if mass.locks.rotation { S::Wide::default() } else { torque.total()? };
    let turns = torque != S::Wide::default();
    Some(Acceleration {
        linear: Vec2::new(
            component::<S>(&acceleration.x, &force.x, mass.axis_inverse_mass.x)?,
            component::<S>(&acceleration.y, &force.y, mass.axis_inverse_mass.y)?,
        ),
        angular: if turns { torque.times(mass.inverse_inertia)? } else { torque },
    })
}

#[inline(always)]
fn component<S: Scalar>(acceleration: &S::Sum, force: &S::Sum, inverse_mass: S::Factor) -> Option<S::Wide> {
    // A sum along a locked axis has no effect and may be of any size.
    if inverse_mass.is_zero() {
        return Some(S::Wide::default());
    }
    let (acceleration, force) = (acceleration.total()?, force.total()?);
    if force == S::Wide::default() { Some(acceleration) } else { acceleration.plus(force.times(inverse_mass)?) }
}

/// Lists the accelerations in the order of the columns, whatever the order of the calls.
pub(super) fn convert<S: Scalar>(
    applied: &Applied<S>,
    bodies: &Bodies<S>,
    accelerations: &mut Vec<AppliedAcceleration<S>>,
) {
    accelerations.clear();
    let none = Vec2::default();
    for row in applied.rows() {
        let Ok(i) = bodies.find(row.body) else { continue };
        accelerations.push((i, acceleration(&none, &row.force, &row.torque, bodies.mass(i))));
    }
    accelerations.sort_unstable_by_key(|(i, _)| *i);
}

/// The accelerations that fit.
pub(super) fn accelerations<S: Scalar>(
    applied: &[AppliedAcceleration<S>],
) -> impl Iterator<Item = (&usize, &Acceleration<S>)> {
    applied.iter().filter_map(|(i, acceleration)| Some((i, acceleration.as_ref()?)))
}

/// The entries about bodies of a block, of a list in the order of their indices.
pub(super) fn part_in<'a, S: Scalar, T>(block: &Block<'_, S>, list: &'a [(usize, T)]) -> &'a [(usize, T)] {
    let before = |end: usize| list.partition_point(|(index, _)| *index < end);
    if list.is_empty() { list } else { &list[before(block.first)..before(block.first + block.len())] }
}
