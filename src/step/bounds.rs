//! The check at the end of a step: which bodies left the allowed range, and which are at rest.
//!
//! Reads: positions, velocities, the backup. Writes: ticks at rest, faults, candidates for sleep.

use alloc::vec::Vec;

use super::applied::part_in;
use super::{Constants, Findings};
use crate::body::{BOUNDED_STEPS, Block, Motion};
use crate::error::Cause;
use crate::fx::Fx;
use crate::island::is_candidate;
use crate::limits;
use crate::scalar::{Accumulator, Scalar};

/// The number of steps for which no body of a block can leave the allowed range, if its factors are bounded and nothing else
/// acts on it. Cached: dropped when a body of the block changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SafeSteps(u8);

impl SafeSteps {
    /// Returns true if the next step is safe.
    pub(super) fn pass<S: Scalar>(&mut self, block: &Block<'_, S>) -> bool {
        if self.0 == 0 && is_well_inside(block) {
            self.0 = BOUNDED_STEPS;
        }
        let passes = self.0 > 0;
        self.0 = self.0.saturating_sub(1);
        passes
    }
}

/// Returns true if all bodies are within half of each limit, so that [`BOUNDED_STEPS`] steps of bounded factors cannot take them out:
/// gravity adds less than half the limit of speeds, and the way of 32 · 4.43 s at that limit is less than 2^28 m.
fn is_well_inside<S: Scalar>(block: &Block<'_, S>) -> bool {
    are_inside(block, [limits::POSITION_LOG2 - 1, limits::SPEED_LOG2 - 1])
}

/// Returns true if positions are within two to the first, and velocities and angular velocities within two to the second. At a limit
/// itself the answer may be no.
fn are_inside<S: Scalar>(block: &Block<'_, S>, [position, speed]: [u32; 2]) -> bool {
    block.velocity.iter().all(|v| S::are_within(v, speed))
        && S::are_within(block.angular_velocity, speed)
        && block.position.iter().all(|x| S::are_within(x, position))
}

/// Adds a fault for each body outside the allowed range.
pub(crate) fn find_out_of_bounds<S: Scalar>(block: &Block<'_, S>, faults: &mut Vec<(usize, Cause)>) {
    // In most steps there are no faults, and a column is checked faster than a body.
    if are_inside(block, [limits::POSITION_LOG2, limits::SPEED_LOG2]) {
        return;
    }
    for i in 0..block.len() {
        let components = |plane: &[&mut [S::Accumulator]; 2]| [plane[0][i], plane[1][i]];
        let velocity = components(&block.velocity);
        let position = components(&block.position);
        let cause = beyond::<S>([velocity, position], block.angular_velocity[i]);
        faults.extend(cause.map(|cause| (block.first + i, cause)));
    }
}

/// Adds a fault for a single body outside the allowed range. Returns true if it is.
pub(super) fn is_out_of_bounds<S: Scalar>(motion: &Motion<S>, i: usize, faults: &mut Vec<(usize, Cause)>) -> bool {
    let [velocity, position] = [&motion.velocity, &motion.position].map(|plane| [plane.x[i], plane.y[i]]);
    let cause = beyond::<S>([velocity, position], motion.angular_velocity[i]);
    faults.extend(cause.map(|cause| (i, cause)));
    cause.is_some()
}

/// The limit that a body is beyond, if it is outside the allowed range.
#[inline(always)]
fn beyond<S: Scalar>(
    [velocity, position]: [[S::Accumulator; 2]; 2],
    angular_velocity: S::Accumulator,
) -> Option<Cause> {
    let are_within = |[x, y]: [S::Accumulator; 2], limit: Fx| {
        let limit = S::from_fx(limit);
        x.is_within(limit) && y.is_within(limit)
    };
    if !are_within(velocity, limits::SPEED) {
        Some(Cause::Velocity)
    } else if !are_within(position, limits::POSITION) {
        Some(Cause::Position)
    } else if !angular_velocity.is_within(S::from_fx(limits::ANGULAR_SPEED)) {
        Some(Cause::AngularVelocity)
    } else {
        None
    }
}

/// Finds the bodies of a block that left the allowed range, and counts for how many steps each has been at rest.
pub(super) fn check_bounds_and_rest<S: Scalar>(
    block: &mut Block<'_, S>,
    backup: &Motion<S>,
    constants: &Constants<'_, S>,
    findings: &mut Findings,
) {
    find_out_of_bounds(block, &mut findings.faults);
    let Some(ticks) = constants.sleep_after else { return };
    for i in 0..block.len() {
        // The next step would leave it as it is, to the bit: its public velocities are zero, and the step changed
        // nothing below them either.
        let at_rest = block.is_still(i) && backup.is_same(block, i);
        block.ticks_at_rest[i] = if at_rest { block.ticks_at_rest[i].saturating_add(1) } else { 0 };
    }
    for (i, _) in part_in(block, constants.applied) {
        block.ticks_at_rest[i - block.first] = 0;
    }
    // In most steps there are no candidates, and a test is faster than a collection.
    if block.ticks_at_rest.iter().any(|&rest| is_candidate(rest, ticks)) {
        let candidates = block.ticks_at_rest.iter().enumerate().filter(|(_, rest)| is_candidate(**rest, ticks));
        findings.candidates.extend(candidates.map(|(i, _)| block.first + i));
    }
}
