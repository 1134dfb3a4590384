//! Undo of steps.
//!
//! Each kick and each drift is a shear: it adds to one quantity an amount that depends only on the other one, which it leaves unchanged.
//! Accumulators add without rounding and every other rounding is odd, so that the same shear with the opposite sign restores the exact
//! bits. [`Integrator::inverse`](crate::Integrator::inverse) lists the stages in reverse; a step back runs that list with negated spans.
//!
//! Damping, drag, forces that depend on velocity, speed limits, reached targets, sleep counters, quarantine, contacts and joints lose information and
//! have no inverse: the call checks for them first. A step with impulses has none, nor has the step after it, as contacts and joints start from the
//! impulses of the step before. Only at the end is it known whether a body would leave the allowed range on the way back; the step
//! back is then itself undone and refused.

use super::{World, WorldDef};
use crate::body::{Activity, BodyKind};
use crate::error::{Error, Irreversible};
use crate::force::{AppliedForce, Dependence};
use crate::integrate::Schedule;
use crate::limits;
use crate::scalar::Scalar;

impl<S: Scalar> World<S> {
    /// Undoes the last step: the world is what it was before, to the bit. The forces applied over that tick are applied again,
    /// the state has the [hash](Self::state_hash) it had, and a step leads here again.
    ///
    /// `applied` is a copy of [`StepReport::applied`](crate::StepReport::applied) of the step; a world keeps it for the last
    /// step alone. These are sums of forces and torques: a force at a point acted on the body where it was.
    ///
    /// A step can be undone with an integrator that has an [inverse](crate::Integrator::inverse), with forces that are constant
    /// or depend on the position alone, without damping, caps of speeds, and sleep, and if no body was moved to a target in the
    /// step or stopped there. It is refused also if in that step or the one before colliders pushed each other, a body was near a
    /// one-way collider, a path ended early, an exclusion ended, a collider entered or left a sensor, a joint pulled or broke, or something was
    /// reported as ended by a call. The cost is that of a step. The report of the step is lost.
    ///
    /// Undo calls between two steps yourself, the last one first, before you undo the step before them: forces with
    /// [`clear_forces`](Self::clear_forces), an impulse with its opposite, gravity, mass, field or integrator with the value
    /// before. The world cannot check that, nor that `applied` is right: otherwise it goes to another earlier state, from which
    /// a step leads here.
    ///
    /// # Errors
    /// [`Error::NotReversible`] with the [reason](Irreversible); [`Error::NoSuchBody`], [`Error::NotDynamic`] or
    /// [`Error::Disabled`] for a body in `applied`. The state is unchanged, to the bit.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// world.apply_force(ball, vec2(3, 0))?;
    /// let before = world.state_hash();
    /// let applied = world.step().applied.to_vec();
    /// world.step_back(&applied)?;
    /// assert_eq!(world.state_hash(), before);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias = "undo")]
    pub fn step_back(&mut self, applied: &[AppliedForce<S>]) -> Result<(), Error> {
        S::step_back(self, applied)
    }

    pub(crate) fn step_back_inner(&mut self, applied: &[AppliedForce<S>]) -> Result<(), Error> {
        self.update();
        let schedule = self.way_back().map_err(|why| Error::NotReversible { why })?;
        self.apply_again(applied)
            .and_then(|()| {
                let undone = self.next_step(None).step_back(schedule);
                undone.map_err(|fault| Error::NotReversible { why: Irreversible::Fault(fault) })
            })
            .inspect_err(|_| self.applied.clear())?;
        self.tick -= 1;
        self.applied.forget_done();
        self.workspace.report.clear();
        self.change_log.undo(self.tick, &self.bodies);
        Ok(())
    }

    /// The stages that undo the last step, if it has an inverse.
    fn way_back(&self) -> Result<Schedule, Irreversible> {
        if !S::IS_REVERSIBLE {
            return Err(Irreversible::Scalar);
        }
        let schedule = self.def.integrator.inverse_schedule().ok_or(Irreversible::Integrator)?;
        if self.tick == 0 {
            return Err(Irreversible::Start);
        }
        if self.tick == limits::TICK {
            return Err(Irreversible::End);
        }
        if self.tick == self.counted.1 {
            return Err(Irreversible::TimeStep);
        }
        if self.def.sleep_after.is_some() {
            return Err(Irreversible::Sleep);
        }
        let WorldDef { linear_damping, angular_damping, .. } = self.def;
        if self.factor_table.used().any(|key| key.is_damped(linear_damping, angular_damping)) {
            return Err(Irreversible::Damping);
        }
        if self.factor_table.any_capped() {
            return Err(Irreversible::Capped);
        }
        let resists = |depends_on| depends_on == Dependence::Velocity;
        if let Some((field, _)) = self.fields.iter().find(|(_, field)| resists(field.depends_on(&self.custom_forces))) {
            return Err(Irreversible::Velocity { field });
        }
        // Bodies that do not move are behind the moving ones.
        let still = self.bodies.moving()..self.bodies.len();
        if let Some(i) = still.rev().find(|&i| self.bodies.activity(i) == Activity::Quarantined) {
            return Err(Irreversible::Quarantined { body: self.bodies.id(i) });
        }
        if self.targets.moved_at == self.tick || self.targets.are_due(&self.bodies) {
            return Err(Irreversible::Moved);
        }
        // The contacts that the step started from are those of the step before.
        let contacts = &self.contacts;
        if contacts.pushed_at != 0 && contacts.pushed_at + 1 >= self.tick || !contacts.is_empty() {
            return Err(Irreversible::Contact);
        }
        if self.joint_states.pulled_at != 0 && self.joint_states.pulled_at + 1 >= self.tick {
            return Err(Irreversible::Joint);
        }
        if !self.applied.rows().is_empty() {
            return Err(Irreversible::Pending);
        }
        Ok(schedule)
    }

    /// Applies the forces of the step again. On an error a part of them is applied.
    fn apply_again(&mut self, applied: &[AppliedForce<S>]) -> Result<(), Error> {
        for row in applied {
            let body = row.body;
            if self.bodies.info(self.check_taking_part(body)?).kind != BodyKind::Dynamic {
                return Err(Error::NotDynamic { body });
            }
            if self.applied.row(body).is_some() {
                return Err(Error::NotReversible { why: Irreversible::Twice { body } });
            }
            self.applied.adopt(body, row.force, row.torque);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::BodyDef;
    use crate::force::{FieldKind, Region};
    use crate::fx::fx;
    use crate::math::vec2;

    /// Refuses a step back of a coupled body whose ticks at rest only a file can have: no call leaves them without sleep.
    #[test]
    fn a_refused_step_back_keeps_the_ticks_at_rest() {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
        let position = vec2(-(1 << 30), 0) + vec2(1, 0);
        let region = Region::Disc { centre: vec2(0, 0), radius: fx!(1) };
        let field = FieldKind::Zone { region, acceleration: vec2(1, 0) };
        world.add_field(field).expect("a field");
        let def = BodyDef { position, velocity: vec2(60, 0), ..BodyDef::dynamic() };
        let body = world.add_body(def).expect("a body");
        world.step();
        world.set_velocity(body, vec2(6_000, 0)).expect("a velocity");
        world.bodies.columns.motion.ticks_at_rest[0] = 5;
        let before = world.state_hash();
        let refused = world.step_back(&[]).expect_err("the way back leads out");
        assert!(matches!(refused, Error::NotReversible { why: Irreversible::Fault(_) }), "{refused}");
        assert_eq!(world.state_hash(), before);
        assert_eq!(world.bodies.columns.motion.ticks_at_rest, [5]);
    }
}
