//! Changes of the parameters of the step. The next step derives values from them, once.

use alloc::sync::Arc;

use super::{Command, World, WorldDef};
use crate::body::Damping;
use crate::error::Error;
use crate::force::CustomForce;
use crate::integrate::Integrator;
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;

impl<S: Scalar> World<S> {
    /// Sets the length of a step; wakes all bodies. Damping has the same effect over a second as before.
    ///
    /// # Errors
    /// [`Error::TimeStep`]; [`Error::ElapsedTime`] if the elapsed time could not stay exact.
    ///
    /// ```
    /// use umbra_physics::{Damping, Elapsed, Integrator, TimeStep, World, WorldDef, fx};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// (0..60).for_each(|_| _ = world.step());
    /// world.set_time_step(TimeStep::hz(240))?; // a stiff spring is about to come
    /// world.set_integrator(Integrator::Yoshida4)?;
    /// world.set_damping(Damping::rate(fx!(0.5)), Damping::NONE)?;
    /// world.set_sleep_after(Some(120))?; // ticks: as long as before
    /// (0..60).for_each(|_| _ = world.step());
    /// assert_eq!(world.elapsed(), Elapsed { num: 5, den: 4 });
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_time_step(&mut self, time_step: TimeStep) -> Result<(), Error> {
        let (def, now) = self.check_time_step(time_step)?;
        self.journal.note(|| Command::SetTimeStep(time_step));
        self.counted = (now, self.tick);
        self.redefine(def);
        Ok(())
    }

    /// Sets gravity, m/s²; wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Gravity`](crate::Quantity::Gravity).
    pub fn set_gravity(&mut self, gravity: Vec2<S>) -> Result<(), Error> {
        let def = self.check_gravity(gravity)?;
        self.journal.note(|| Command::SetGravity(gravity));
        self.redefine(def);
        Ok(())
    }

    /// Sets the integrator; wakes all bodies. `PublishedVerlet` starts from a last acceleration of zero.
    ///
    /// # Errors
    /// [`Error::DampingHasNoInverse`] for `Yoshida4` where the damping of the world or of a body leaves nothing of a velocity.
    pub fn set_integrator(&mut self, integrator: Integrator) -> Result<(), Error> {
        let def = self.check_integrator(integrator)?;
        self.journal.note(|| Command::SetIntegrator(integrator));
        self.bodies.keep_last_acceleration(integrator == Integrator::PublishedVerlet);
        self.redefine(def);
        Ok(())
    }

    /// Sets the damping of the bodies without their own, of the velocity and of the angular velocity; wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Damping`](crate::Quantity::Damping); [`Error::DampingHasNoInverse`].
    pub fn set_damping(&mut self, linear: Damping<S>, angular: Damping<S>) -> Result<(), Error> {
        let def = self.check_damping(linear, angular)?;
        self.journal.note(|| Command::SetDamping { linear, angular });
        self.redefine(def);
        Ok(())
    }

    /// Sets the number of ticks at rest after which a body falls asleep, `None` for never; wakes all bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::SleepAfter`](crate::Quantity::SleepAfter) for zero.
    pub fn set_sleep_after(&mut self, ticks: Option<u32>) -> Result<(), Error> {
        S::set_sleep_after(self, ticks)
    }

    pub(crate) fn set_sleep_after_inner(&mut self, ticks: Option<u32>) -> Result<(), Error> {
        self.def = self.check_sleep_after(ticks)?;
        self.journal.note(|| Command::SetSleepAfter(ticks));
        self.wake_all();
        self.bodies.clear_rest();
        Ok(())
    }

    /// Registers a custom force, for fields to name. Worlds that have to agree need the same custom forces.
    ///
    /// # Errors
    /// [`Error::CustomForce`] if a custom force with this id is registered.
    pub fn register_custom_force(&mut self, force: Arc<dyn CustomForce<S>>) -> Result<(), Error> {
        let id = force.id();
        if self.custom_forces.contains_key(&id) {
            return Err(Error::CustomForce { id });
        }
        Arc::make_mut(&mut self.custom_forces).insert(id, force);
        self.bodies.changes_mut().note_group_fields();
        Ok(())
    }

    /// The registered custom forces, sorted by their ids: reading a snapshot or a replay of this world needs them.
    ///
    /// ```
    /// use umbra_physics::{Snapshot, World, WorldDef};
    ///
    /// let world = World::new(WorldDef::default())?;
    /// let forces: Vec<_> = world.custom_forces().cloned().collect();
    /// let copy = Snapshot::from_bytes(&world.snapshot().to_bytes(), &forces)?.into_world();
    /// assert_eq!((copy.state_hash(), forces.len()), (world.state_hash(), 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn custom_forces(&self) -> impl Iterator<Item = &Arc<dyn CustomForce<S>>> {
        self.custom_forces.values()
    }

    /// Changes the definition and marks the values derived from it as stale, unless nothing changes. Wakes all bodies, as a
    /// force too small to move a body may be large enough now, also over a longer step.
    pub(super) fn redefine(&mut self, def: WorldDef<S>) {
        S::redefine(self, def);
    }

    pub(crate) fn redefine_inner(&mut self, def: WorldDef<S>) {
        if def != self.def {
            self.rescale_impulses(&def);
            self.def = def;
            Arc::make_mut(&mut self.factor_table).change_all();
        }
        self.wake_all();
    }

    /// Scales the impulses of contacts and joints, which are those of a sub-step, to the length that sub-steps get: forces stay the same.
    fn rescale_impulses(&mut self, def: &WorldDef<S>) {
        let ((num, den), (old_num, old_den)) = (def.time_step.seconds(), self.def.time_step.seconds());
        if (num, den) != (old_num, old_den) {
            let (num, den) = (u64::from(num) * u64::from(old_den), u64::from(den) * u64::from(old_num));
            self.contacts.rescale(num, den);
            self.joint_states.rescale(num, den);
        }
        let (substeps, old_substeps) = (def.contacts.substeps, self.def.contacts.substeps);
        if substeps != old_substeps {
            self.contacts.rescale(old_substeps.into(), substeps.into());
            self.joint_states.rescale(old_substeps.into(), substeps.into());
        }
    }
}
