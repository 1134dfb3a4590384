//! Joints that break.
//!
//! Whether a joint breaks is decided once a step, for all joints at once, on the mean force and the mean torque over the step: the exact sums of the
//! impulses of all sub-steps, rounded once to 2^-32 N·s and N·m·s, over the length of the step. Sub-steps, rounding and order do not decide.

use super::super::Step;
use super::ContactMemory;
use crate::fx::Fx;
use crate::joint::exceeds;
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::slots::{BodyId, JointId};

/// A joint that broke in a step.
///
/// It stays in the world as one that does nothing, and its bodies may touch each other, until
/// [`World::enable_joint`](crate::World::enable_joint) repairs it or it is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct JointBroke<S = Fx> {
    /// The joint.
    pub joint: JointId,
    /// The key of the joint.
    pub key: u64,
    /// The bodies at its ends; `None` for an end on the world.
    pub bodies: [Option<BodyId>; 2],
    /// The mean force on the second end over the step, N, as [`JointLoad::force`] has it.
    pub force: Vec2<S>,
    /// The mean torque over the step on the second body, N·m, as [`JointLoad::torque`] has it.
    pub torque: S,
}

/// The mean load of a joint over a step, of a joint with [`events`](crate::JointDef::events) that may break.
///
/// A joint that must never break has 2^31 N, the largest number, as its [`break_force`](crate::JointDef::break_force) for that.
///
/// ```
/// use umbra_physics::{BodyDef, Fx, JointDef, JointLoad, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() })?;
/// let weight = world.add_body(BodyDef { position: vec2(0, -2), velocity: vec2(0, -1), ..BodyDef::dynamic() })?;
/// let rope = JointDef::between(&world, None, vec2(0, 0), weight, vec2(0, -2))?;
/// let rope = world.add_joint(JointDef { break_force: Some(Fx::MAX), events: true, ..rope })?;
/// // It stops a kilogram from 1 m/s within 1/60 s, and holds it.
/// let jerk: &[JointLoad] = world.step().joint_loads;
/// assert!(jerk[0].joint == rope && (jerk[0].force - vec2(0, 70)).length() < fx!(0.1));
/// (0..60).for_each(|_| _ = world.step());
/// assert!((world.last_report().joint_loads[0].force - vec2(0, 10)).length() < fx!(0.001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct JointLoad<S = Fx> {
    /// The joint.
    pub joint: JointId,
    /// The key of the joint.
    pub key: u64,
    /// The mean force of the joint on the second end, N. *Error* 2^-32 N·s over the length of the step, and ½ ulp; the largest number for a
    /// component that does not fit.
    pub force: Vec2<S>,
    /// The mean torque on the second body, N·m, as [`JointRef::torque`](crate::JointRef::torque) has it. *Error* likewise.
    pub torque: S,
}

/// The mean force of an impulse over a step, N, or the mean torque. The impulse is in 2^-32 N·s. Odd: the largest and the smallest force are
/// opposite.
fn mean_force(impulse: i128, time_step: TimeStep) -> Fx {
    let (num, den) = time_step.seconds();
    // Of an impulse within 2^94 units: below 2^126.
    let force = impulse.clamp(-(1 << 94), 1 << 94) * i128::from(den) / i128::from(num);
    let largest = i128::from(i64::MAX);
    Fx::from_bits(force.clamp(-largest, largest) as i64)
}

impl<S: Scalar> Step<'_, S> {
    /// Breaks the joints whose mean force or torque in the step was too large, and keeps their bodies awake. Reports the loads.
    pub(super) fn break_joints(&mut self, memory: &ContactMemory<S>) {
        let time_step = self.settings.time_step;
        let report = &mut self.workspace.report;
        for (index, [x, y, around]) in memory.pipeline.joints().totals() {
            let index = index as usize;
            let joints = self.contacts.joints;
            let link = joints.link(index);
            if !link.is_breakable() {
                continue;
            }
            let def = joints.def(index);
            let angular_impulse = link.kind.impulse_on_second(around);
            let load = def.events.then(|| {
                let [x, y, torque] = [x, y, angular_impulse].map(|impulse| S::from_fx(mean_force(impulse, time_step)));
                JointLoad { joint: joints.id(index), key: def.key, force: Vec2::new(x, y), torque }
            });
            report.joint_loads.extend(load);
            let is_torn = link.break_force.is_some_and(|force| exceeds([x, y], force, time_step));
            let is_wrung = link.break_torque.is_some_and(|torque| exceeds([angular_impulse, 0], torque, time_step));
            if !is_torn && !is_wrung {
                continue;
            }
            self.contacts.joint_states.break_joint(index, self.settings.tick);
            for body in def.bodies().into_iter().flatten() {
                if let Some(i) = self.bodies.find(body).ok().filter(|&i| i < self.bodies.moving()) {
                    self.bodies.columns.motion.ticks_at_rest[i] = 0;
                }
            }
            if let Some(JointLoad { joint, key, force, torque }) = load {
                report.joints_broke.push(JointBroke { joint, key, bodies: def.bodies(), force, torque });
            }
        }
        report.joint_loads.sort_unstable_by_key(|load| (load.key, load.joint));
        report.joints_broke.sort_unstable_by_key(|broke| (broke.key, broke.joint));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mirrored worlds report opposite forces, also where one does not fit.
    #[test]
    fn mean_forces_are_odd() {
        for time_step in [TimeStep::hz(60), TimeStep::ratio(1001, 60_000), TimeStep::hz(1)] {
            for impulse in [1, 12345, 1 << 62, 1 << 63, 1 << 94, 1 << 120, i128::MAX] {
                let [force, opposite] = [impulse, -impulse].map(|impulse| mean_force(impulse, time_step).to_bits());
                assert_eq!(force, -opposite, "{impulse}");
            }
        }
        assert_eq!(mean_force(10 << 32, TimeStep::hz(60)), crate::fx!(600));
    }
}
