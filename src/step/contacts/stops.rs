//! The ends of the paths of fast bodies, and the time that is lost by them.
//!
//! A body that stops keeps all impulses of the step, so that momentum is kept. Forces did not act in the lost time where they made the body
//! faster: a body that falls has the speed of the height at which it stopped, and a body that impulses support has theirs. So no energy is
//! added. No velocity becomes one that the body had before: the next step has another beginning. A body that a wall keeps at its start without
//! any impulse, which the solver does not see, loses its velocity. A body that is pushed in each step and kept at its start counts as at
//! rest, whatever its velocity, unless the sleep speed is 0.

use super::super::{Constants, Step};
use super::{ContactMemory, leaves_range, list_faulty};
use crate::collider::ContactSettings;
use crate::contact::{Paths, Start, between};
use crate::integrate::{BlockFactors, cap};
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle as _, FxAccumulator, Scalar};

/// A component of the change of velocity by forces after a moment of the step, from the velocities at the start and at the end and from the
/// change by impulses.
fn change_after<S: Scalar>(
    at: u64,
    start: S::Accumulator,
    end: S::Accumulator,
    impulse: FxAccumulator,
) -> FxAccumulator {
    let by_forces = end.to_fixed().plus(start.to_fixed().negated()).plus(impulse.negated());
    between(by_forces, FxAccumulator::default(), at)
}

/// Returns true if a change has made a velocity larger: if the velocity without it is the smaller one.
///
/// # Ranges
/// Velocities are below 2^21 m/s, or rad/s: products are below 2^110.
fn has_grown<const N: usize>(velocity: [FxAccumulator; N], change: [FxAccumulator; N]) -> bool {
    let growth = (0..N).map(|i| {
        let [velocity, change] = [velocity[i], change[i]].map(|part| i128::from(part.value().to_bits()));
        change * (2 * velocity - change)
    });
    growth.sum::<i128>() > 0
}

impl<S: Scalar> Step<'_, S> {
    /// Ends the paths of fast bodies where they would cross something. A body that stops keeps the velocity from impulses, and forces did not
    /// make it faster in the lost time. The next step solves the contact.
    pub(super) fn end_paths(
        &mut self,
        memory: &mut ContactMemory<S>,
        settings: &ContactSettings,
        constants: &Constants<'_, S>,
    ) {
        #[cfg(feature = "selftest")]
        if memory.is_blind {
            return;
        }
        let ContactMemory { pipeline, corrections, starts, fixed_starts, stops, at_fault, .. } = memory;
        list_faulty(&self.workspace.findings.faults, at_fault);
        let scene = self.unchanged(Start::all_fixed(starts, fixed_starts), settings);
        let paths = Paths { scene: &scene, corrections, is_corrected: true };
        pipeline.end_fast_paths(&paths, &|dense| at_fault.binary_search(&dense).is_ok(), stops);
        if !stops.is_empty() {
            self.contacts.contacts.pushed_at = self.settings.tick;
        }
        for stop in stops {
            let motion = &mut self.bodies.columns.motion;
            motion.position.set(stop.dense, stop.position.map(S::Accumulator::from_fixed));
            motion.angle[stop.dense] = S::Angle::from_turn(stop.angle);
            let start = &starts[stop.start];
            let correction = corrections.get(stop.start).copied().unwrap_or_default();
            if stop.is_stuck && !correction.is_pushed {
                // The next step would begin as this one did, for ever.
                motion.velocity.set(stop.dense, Vec2::new(S::Accumulator::default(), S::Accumulator::default()));
                motion.angular_velocity[stop.dense] = S::Accumulator::default();
            } else if let Some(at) = stop.at {
                let Vec2 { x, y } = motion.velocity.get(stop.dense);
                let lost_x = change_after::<S>(at, start.velocity.x, x, correction.velocity.x);
                let lost_y = change_after::<S>(at, start.velocity.y, y, correction.velocity.y);
                let without =
                    |sum: S::Accumulator, change: FxAccumulator| sum.plus(S::Accumulator::from_fixed(change.negated()));
                if has_grown([x.to_fixed(), y.to_fixed()], [lost_x, lost_y]) {
                    motion.velocity.set(stop.dense, Vec2::new(without(x, lost_x), without(y, lost_y)));
                }
                let spin = motion.angular_velocity[stop.dense];
                let lost = change_after::<S>(at, start.angular_velocity, spin, correction.angular_velocity);
                if has_grown([spin.to_fixed()], [lost]) {
                    motion.angular_velocity[stop.dense] = without(spin, lost);
                }
                if constants.any_capped {
                    cap(&mut self.bodies.block(stop.dense..stop.dense + 1), BlockFactors::Each(constants.rows));
                }
            }
            // A body that a fast kinematic one carries along may leave the allowed range.
            if leaves_range(self.bodies, stop.dense, &mut self.workspace.findings) {
                start.restore(self.bodies);
            } else {
                // A body that is pushed in each step and kept at its start has a velocity and goes nowhere. Without impulses nothing would
                // wake it when its way is free, and at a sleep speed of 0 only a body that moves no more to the bit is at rest.
                let is_kept = correction.is_pushed && constants.sleep_speed > S::ZERO;
                self.count_rest(start, is_kept, constants);
            }
            self.note_pushed(stop.dense);
        }
    }

    /// Keeps the paths of fast bodies for sensors.
    pub(super) fn follow_paths(&self, memory: &mut ContactMemory<S>, settings: &ContactSettings) {
        if self.contacts.colliders.any_sensors() {
            let ContactMemory { pipeline, corrections, starts, fixed_starts, sensors, .. } = memory;
            let scene = &self.unchanged(Start::all_fixed(starts, fixed_starts), settings);
            sensors.follow(&Paths { scene, corrections, is_corrected: true }, pipeline);
        }
    }
}
