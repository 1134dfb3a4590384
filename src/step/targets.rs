//! Kinematic bodies on their way to a goal: what comes before the stages of a step, and after them.

use super::Context;
use crate::body::{KinematicTarget, Velocities};
use crate::error::Cause;
use crate::scalar::Scalar;

impl<S: Scalar> Context<'_, S> {
    /// Gives bodies with a goal the velocity that leads there, and stops those that reached theirs in the step before.
    pub(super) fn begin_targets(&mut self) {
        // These velocities are not those that the blocks were looked at with.
        self.scratch.forget();
        self.scratch.stranded.clear();
        let still = Velocities::<S>::default();
        for (body, target) in self.targets.rows() {
            let Ok(i) = self.bodies.find(*body) else { continue };
            if !self.bodies.activity(i).takes_part() {
                continue;
            }
            let locks = self.bodies.mass(i).locks;
            let motion = &mut self.bodies.columns.motion;
            let velocities = match target {
                KinematicTarget { goal: Some(goal), .. } => {
                    let there = goal.approach(motion, i, locks, self.plan.rate);
                    if there.is_none() {
                        self.scratch.stranded.push((i, (motion.velocity.get(i), motion.angular_velocity[i])));
                    }
                    there.unwrap_or_default()
                }
                KinematicTarget { goal: None, .. } => still,
            };
            motion.velocity.set(i, velocities.0);
            motion.angular_velocity[i] = velocities.1;
        }
        self.scratch.stranded.sort_unstable_by_key(|(i, _)| *i);
    }

    /// Puts bodies where they were to arrive, to the bit. One whose goal was too far off for a step of this length, which was
    /// a longer one when it was sent, is where it was, and at fault.
    pub(super) fn finish_targets(&mut self) {
        // Where the stages took such a body is within an ulp of its goal: on the other side of a limit perhaps.
        let (bodies, targets) = (&*self.bodies, &*self.targets);
        let travels = |i| targets.of(bodies.id(i)).is_some_and(|target| target.goal.is_some());
        self.scratch.found.faults.retain(|(i, _)| !travels(*i));
        for (body, target) in self.targets.rows_mut() {
            let Ok(i) = self.bodies.find(*body) else { continue };
            if !self.bodies.activity(i).takes_part() {
                continue;
            }
            let Some(goal) = target.goal.take() else {
                target.arrived = false;
                continue;
            };
            let locks = self.bodies.mass(i).locks;
            let motion = &mut self.bodies.columns.motion;
            if let Ok(at) = self.scratch.stranded.binary_search_by_key(&i, |(i, _)| *i) {
                let (velocity, angular_velocity) = self.scratch.stranded[at].1;
                motion.velocity.set(i, velocity);
                motion.angular_velocity[i] = angular_velocity;
                // It stood still over the step, and was not at rest.
                motion.rest[i] = 0;
                self.scratch.found.faults.push((i, Cause::Velocity));
            } else {
                goal.take(motion, i, locks);
                motion.rest[i] = 0;
                target.arrived = true;
            }
        }
        self.targets.moved_at = self.tick;
        self.targets.tidy();
        self.scratch.forget();
    }
}
