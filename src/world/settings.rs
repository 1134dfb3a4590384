//! Changing the parameters of the step. What is derived from them is made anew.

use alloc::sync::Arc;

use super::{World, WorldDef, check_gravity, check_sleep_after};
use crate::error::Error;
use crate::force::ForceLaw;
use crate::integrate::{Integrator, Plan};
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;

impl<S: Scalar> World<S> {
    /// Changes the length of a step; wakes all bodies. Damping keeps acting alike over time.
    ///
    /// # Errors
    /// [`Error::TimeStep`]; [`Error::ElapsedTime`] if the elapsed time could not stay exact.
    pub fn set_time_step(&mut self, time_step: TimeStep) -> Result<(), Error> {
        let time_step = time_step.checked()?;
        let now = self.counted.0.plus(self.tick - self.counted.1, self.def.time_step).ok_or(Error::ElapsedTime)?;
        now.plus(u64::MAX, time_step).ok_or(Error::ElapsedTime)?;
        self.counted = (now, self.tick);
        self.def.time_step = time_step;
        self.refresh();
        Ok(())
    }

    /// Changes gravity; wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Gravity`](crate::Quantity::Gravity).
    pub fn set_gravity(&mut self, gravity: Vec2<S>) -> Result<(), Error> {
        check_gravity(gravity)?;
        self.def.gravity = gravity;
        self.refresh();
        Ok(())
    }

    /// Changes the integrator; wakes all bodies. `PublishedVerlet` starts from a last acceleration of zero.
    ///
    /// # Errors
    /// [`Error::DampingHasNoInverse`] for `Yoshida4` where the world or a body has a damping of 0.
    pub fn set_integrator(&mut self, integrator: Integrator) -> Result<(), Error> {
        let stops = |kept: Option<S>| kept == Some(S::ZERO);
        let body_stops = self.tunings.used().any(|row| stops(row.key.linear) || stops(row.key.angular));
        if integrator == Integrator::Yoshida4 && body_stops {
            return Err(Error::DampingHasNoInverse);
        }
        let def = WorldDef { integrator, ..self.def };
        def.check()?;
        self.def = def;
        self.bodies.keep_last_acceleration(integrator == Integrator::PublishedVerlet);
        self.refresh();
        Ok(())
    }

    /// Changes the damping of the bodies that have none of their own: what is left of their linear and angular velocity
    /// after a second. Wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Damping`](crate::Quantity::Damping); [`Error::DampingHasNoInverse`].
    pub fn set_damping(&mut self, linear: S, angular: S) -> Result<(), Error> {
        let def = WorldDef { linear_damping: linear, angular_damping: angular, ..self.def };
        def.check()?;
        self.def = def;
        self.refresh();
        Ok(())
    }

    /// Changes after how many ticks at rest a body falls asleep, `None` for never; wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::SleepAfter`](crate::Quantity::SleepAfter) for zero.
    pub fn set_sleep_after(&mut self, ticks: Option<u32>) -> Result<(), Error> {
        check_sleep_after(ticks)?;
        self.def.sleep_after = ticks;
        self.wake_all();
        self.bodies.columns.motion.rest.fill(0);
        Ok(())
    }

    /// Registers a law of force of the caller's own, for fields to name. Worlds that are to agree have the same laws.
    ///
    /// # Errors
    /// [`Error::ForceLaw`] if one with its id is registered.
    pub fn register_law(&mut self, law: Arc<dyn ForceLaw<S>>) -> Result<(), Error> {
        let id = law.id();
        if self.laws.contains_key(&id) {
            return Err(Error::ForceLaw { id });
        }
        Arc::make_mut(&mut self.laws).insert(id, law);
        Ok(())
    }

    /// Makes all that is derived from the definition anew, and wakes all bodies: what was too little to move one may be
    /// enough now, also over a longer step.
    fn refresh(&mut self) {
        self.plan = Plan::new(self.def.integrator, self.def.time_step);
        Arc::make_mut(&mut self.tunings).refresh(&Self::climate(&self.def, &self.plan));
        self.wake_all();
    }
}
