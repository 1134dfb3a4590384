//! Kinematic bodies on their way to a target: the velocity that leads there before the stages, the arrival after them.
//!
//! Reads: targets, positions, locks. Writes: velocities, positions, angles, ticks at rest, targets, faults.

use alloc::vec::Vec;

use crate::body::{Bodies, Change, KinematicTarget, KinematicTargets, Velocities};
use crate::error::Cause;
use crate::integrate::Plan;
use crate::scalar::Scalar;

/// Memory that targets use again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    /// The velocities, before the step, of bodies whose targets are too far off, by their indices.
    out_of_reach: Vec<(usize, Velocities<S>)>,
}

/// Gives bodies with a target the velocity that leads there, and stops the bodies that reached their target in the step before.
pub(super) fn begin<S: Scalar>(
    bodies: &mut Bodies<S>,
    targets: &KinematicTargets<S>,
    plan: &Plan<S>,
    workspace: &mut Workspace<S>,
) {
    let out_of_reach = &mut workspace.out_of_reach;
    out_of_reach.clear();
    let still = Velocities::<S>::default();
    for (body, target) in targets.rows() {
        let Ok(i) = bodies.find(*body) else { continue };
        if !bodies.activity(i).takes_part() {
            continue;
        }
        let locks = bodies.mass(i).locks;
        let motion = &mut bodies.columns.motion;
        let velocities = match target {
            KinematicTarget { goal: Some(goal), .. } => {
                let velocities = goal.approach(motion, i, locks, plan.rate);
                if velocities.is_none() {
                    out_of_reach.push((i, (motion.velocity.get(i), motion.angular_velocity[i])));
                }
                velocities.unwrap_or_default()
            }
            KinematicTarget { goal: None, .. } => still,
        };
        motion.velocity.set(i, velocities.0);
        motion.angular_velocity[i] = velocities.1;
        bodies.note(i, Change::VELOCITY);
    }
    out_of_reach.sort_unstable_by_key(|(i, _)| *i);
}

/// Puts bodies where they were to arrive, to the bit. A body whose target was too far off for a step of this length (the step
/// was longer when it was sent) is where it was, and at fault.
pub(super) fn finish<S: Scalar>(
    bodies: &mut Bodies<S>,
    targets: &mut KinematicTargets<S>,
    tick: u64,
    workspace: &Workspace<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let out_of_reach = &workspace.out_of_reach;
    // The stages take such a body to within an ulp of its target: beyond a limit perhaps.
    faults.retain(|(i, _)| targets.of(bodies.id(*i)).is_none_or(|target| target.goal.is_none()));
    for (body, target) in targets.rows_mut() {
        let Ok(i) = bodies.find(*body) else { continue };
        if !bodies.activity(i).takes_part() {
            continue;
        }
        let Some(goal) = target.goal.take() else {
            target.arrived = false;
            continue;
        };
        let locks = bodies.mass(i).locks;
        let motion = &mut bodies.columns.motion;
        if let Ok(index) = out_of_reach.binary_search_by_key(&i, |(i, _)| *i) {
            let (velocity, angular_velocity) = out_of_reach[index].1;
            motion.velocity.set(i, velocity);
            motion.angular_velocity[i] = angular_velocity;
            // It stood still over the step, and was not at rest.
            motion.ticks_at_rest[i] = 0;
            faults.push((i, Cause::Velocity));
        } else {
            goal.take(motion, i, locks);
            motion.ticks_at_rest[i] = 0;
            target.arrived = true;
        }
        bodies.note(i, Change::POSE.or(Change::VELOCITY));
    }
    targets.moved_at = tick;
    targets.tidy();
}
