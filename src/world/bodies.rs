//! Adding, removing and changing bodies. Each call checks first and changes nothing if it refuses.

use alloc::sync::Arc;

use super::{Command, World};
use crate::body::{BodyDef, BodyInfo, BodyKind, Change, Damping, Key, Locks, Mass};
use crate::error::Error;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Scalar};
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// Adds a body.
    ///
    /// # Errors
    /// As [`BodyDef::check`]; [`Error::DampingHasNoInverse`] for a damping that leaves nothing under `Yoshida4`; [`Error::Full`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, BodyKind, Damping, Fx, Mass, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef { position: vec2(1, 2), ..BodyDef::dynamic() })?;
    /// // Everything in a definition can be changed later.
    /// world.add_collider(body, Shape::circle(fx!(0.5))?)?;
    /// world.set_mass(body, Mass::Kilograms(fx!(2)))?;
    /// world.set_angle(body, Fx::FRAC_PI_2)?;
    /// world.set_angular_velocity(body, fx!(3))?;
    /// world.set_gravity_scale(body, fx!(-1))?; // it rises
    /// world.set_body_damping(body, Some(Damping::rate(fx!(0.5))), None)?;
    /// world.set_force_groups(body, 0b110)?;
    /// world.set_key(body, 42)?;
    /// world.set_kind(body, BodyKind::Kinematic)?;
    /// world.remove_body(body)?;
    /// assert!(world.body(body).is_err()); // its handle names nothing any more, ever
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("create_body", "insert_body", "spawn"))]
    pub fn add_body(&mut self, def: BodyDef<S>) -> Result<BodyId, Error> {
        S::add_body(self, def)
    }

    pub(crate) fn add_body_inner(&mut self, mut def: BodyDef<S>) -> Result<BodyId, Error> {
        let (collider_mass, properties) = self.check_new_body(&def)?;
        self.journal.note(|| Command::AddBody(def.clone()));
        let colliders = core::mem::take(&mut def.colliders);
        let factor_table = Arc::make_mut(&mut self.factor_table);
        let body = self.bodies.insert(&def, collider_mass, properties, factor_table);
        if !colliders.is_empty() {
            Arc::make_mut(&mut self.colliders).insert_all(body, colliders);
        }
        self.change_log.added(body, &self.bodies);
        self.mark_if_still(body);
        Ok(body)
    }

    /// Removes a body, its colliders, and the force fields and joints attached to it, and wakes the bodies at their other ends. The next step
    /// reports the joints ([`joints_removed`](crate::StepReport::joints_removed)).
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    #[doc(alias("destroy_body", "despawn"))]
    pub fn remove_body(&mut self, body: BodyId) -> Result<(), Error> {
        S::remove_body(self, body)
    }

    pub(crate) fn remove_body_inner(&mut self, body: BodyId) -> Result<(), Error> {
        self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::RemoveBody(body));
        // The order is state: the slot that is freed last is taken first.
        for field in self.fields.attached_by_age(body) {
            self.take_field(field)?;
        }
        self.take_colliders(body)?;
        let joints = self.joints.of_body(body.slot);
        for &joint in &joints {
            self.take_joint(joint)?;
        }
        self.contacts.forget_body(body);
        let dense = self.bodies.find(body)?;
        self.applied.forget(body);
        self.targets.forget(body);
        Arc::make_mut(&mut self.factor_table).release(self.bodies.columns.factors[dense]);
        self.change_log.removed(body, &joints);
        self.bodies.remove(body)
    }

    /// Sets the position of a body's centre of mass, m; wakes the body. The carried fraction below the ulp is dropped.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::Position`](crate::Quantity::Position).
    #[doc(alias("set_translation", "set_transform", "teleport"))]
    pub fn set_position(&mut self, body: BodyId, position: Vec2<S>) -> Result<(), Error> {
        self.check_body_position(body, position)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetPosition { body, position });
        self.targets.recall(body);
        self.bodies.columns.motion.position.set(dense, position.map(Accumulator::from_scalar));
        self.change_log.placed(body);
        Ok(())
    }

    /// Sets the angle of a body in radians, of any size; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] for a float that is no number.
    #[doc(alias = "set_rotation")]
    pub fn set_angle(&mut self, body: BodyId, angle: S) -> Result<(), Error> {
        self.check_body_angle(body, angle)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetAngle { body, angle });
        self.targets.recall(body);
        let before = self.bodies.columns.motion.angle[dense];
        self.bodies.columns.motion.angle[dense] = S::Angle::from_radians(angle);
        self.keep_turns(body, before);
        self.change_log.placed(body);
        Ok(())
    }

    /// Sets the velocity of a body, m/s; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotMovable`]; [`Error::OutOfRange`] or [`Error::Locked`] with
    /// [`Quantity::Velocity`](crate::Quantity::Velocity).
    #[doc(alias("set_linvel", "set_linear_velocity"))]
    pub fn set_velocity(&mut self, body: BodyId, velocity: Vec2<S>) -> Result<(), Error> {
        self.check_body_velocity(body, velocity)?;
        let dense = self.touch(body, Change::VELOCITY)?;
        self.journal.note(|| Command::SetVelocity { body, velocity });
        self.targets.forget(body);
        self.bodies.columns.motion.velocity.set(dense, velocity.map(Accumulator::from_scalar));
        Ok(())
    }

    /// Sets the angular velocity of a body, rad/s; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotMovable`]; [`Error::OutOfRange`] or [`Error::Locked`] with
    /// [`Quantity::AngularVelocity`](crate::Quantity::AngularVelocity).
    #[doc(alias = "set_angvel")]
    pub fn set_angular_velocity(&mut self, body: BodyId, velocity: S) -> Result<(), Error> {
        self.check_body_angular_velocity(body, velocity)?;
        let dense = self.touch(body, Change::VELOCITY)?;
        self.journal.note(|| Command::SetAngularVelocity { body, velocity });
        self.targets.forget(body);
        self.bodies.columns.motion.angular_velocity[dense] = S::Accumulator::from_scalar(velocity);
        Ok(())
    }

    /// Moves a kinematic body to a position and an angle over the next step, the short way round; wakes the body. The body
    /// arrives to the bit, as by [`set_position`](Self::set_position) and [`set_angle`](Self::set_angle). During the step, and
    /// as read after it, the body has the velocity (position − x)/dt, which the dampers of attached springs see. From the
    /// following step on the body stands still, unless it is moved again: one call a tick makes a path of any shape.
    ///
    /// The time step may be changed before the step: the body arrives in one step of any length. If that would take more than
    /// the speed limit, the body stays where it is and is quarantined. A rotation of exactly half a turn has no short way: the
    /// body makes it at once at the end of the step, without an angular velocity.
    ///
    /// The target is dropped when the body is placed, turned or locked by another call, gets a velocity or another kind, or is
    /// disabled. A body that has already arrived is stopped all the same, unless it is given a velocity or another kind: then
    /// its velocity is kept.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::Quarantined`]; [`Error::Disabled`]; [`Error::NotKinematic`]; [`Error::Locked`] for a way
    /// along a locked axis; [`Error::OutOfRange`] with [`Quantity::Position`](crate::Quantity::Position),
    /// [`Quantity::Angle`](crate::Quantity::Angle), or [`Quantity::Velocity`](crate::Quantity::Velocity) if a step is too short
    /// for the way.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let lift = world.add_body(BodyDef::kinematic())?;
    /// world.move_to(lift, vec2(0, fx!(0.1)), fx!(0.2))?;
    /// world.step();
    /// let arrived = world.body(lift)?;
    /// assert_eq!((arrived.position(), arrived.angle()), (vec2(0, fx!(0.1)), fx!(0.2)));
    /// assert!(arrived.velocity().y > fx!(5.9));
    /// world.step();
    /// assert_eq!(world.body(lift)?.velocity(), vec2(0, 0));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("set_target_transform", "set_next_kinematic_position", "set_next_kinematic_translation"))]
    pub fn move_to(&mut self, body: BodyId, position: Vec2<S>, angle: S) -> Result<(), Error> {
        S::move_to(self, body, position, angle)
    }

    pub(crate) fn move_to_inner(&mut self, body: BodyId, position: Vec2<S>, angle: S) -> Result<(), Error> {
        let goal = self.check_move(body, position, angle)?;
        self.touch(body, Change::VELOCITY)?;
        self.journal.note(|| Command::MoveTo { body, position, angle });
        self.targets.send(body, goal);
        Ok(())
    }

    /// Sets the mass of a body, and with it the moment of inertia. A body that is not dynamic uses it once it is dynamic.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`].
    pub fn set_mass(&mut self, body: BodyId, mass: Mass<S>) -> Result<(), Error> {
        S::set_mass(self, body, mass)
    }

    pub(crate) fn set_mass_inner(&mut self, body: BodyId, mass: Mass<S>) -> Result<(), Error> {
        let properties = self.check_body_mass(body, mass)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetMass { body, mass });
        let kind = self.bodies.info(dense).kind;
        self.bodies.set_mass(dense, kind, mass, properties);
        Ok(())
    }

    /// Sets the kind of a body. A body that becomes static stops. Forces applied to it since the last step are dropped. Its joints stay; a
    /// joint without a dynamic body does nothing.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::Quarantined`]; [`Error::Disabled`]; if it becomes dynamic,
    /// [`Error::OutOfRange`] without a mass it can have, [`Error::DynamicChain`] with a chain among its colliders.
    pub fn set_kind(&mut self, body: BodyId, kind: BodyKind) -> Result<(), Error> {
        S::set_kind(self, body, kind)
    }

    pub(crate) fn set_kind_inner(&mut self, body: BodyId, kind: BodyKind) -> Result<(), Error> {
        let properties = self.check_body_kind(body, kind)?;
        self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetKind { body, kind });
        self.wake_joined(body);
        let dense = self.bodies.find(body)?;
        self.applied.forget(body);
        self.targets.forget(body);
        let mass = self.bodies.info(dense).mass;
        self.bodies.set_mass(dense, kind, mass, properties);
        let dense = self.bodies.set_moving(dense, kind != BodyKind::Static);
        let motion = &mut self.bodies.columns.motion;
        if kind == BodyKind::Static {
            motion.velocity.set(dense, Vec2::default());
            motion.angular_velocity[dense] = S::Accumulator::default();
        }
        if let Some(last) = motion.last_acceleration.get_mut(dense) {
            *last = Default::default();
        }
        self.set_factors(dense, |key| key.dynamic = kind == BodyKind::Dynamic);
        if kind != BodyKind::Dynamic {
            self.relax_joints(body);
        }
        self.change_log.placed(body);
        self.mark_if_still(body);
        Ok(())
    }

    /// Sets the factor by which gravity acts on a body; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::GravityScale`](crate::Quantity::GravityScale).
    pub fn set_gravity_scale(&mut self, body: BodyId, scale: S) -> Result<(), Error> {
        self.check_body_gravity_scale(body, scale)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetGravityScale { body, scale });
        self.set_factors(dense, |key| key.gravity_scale = scale);
        Ok(())
    }

    /// Sets the damping of a body, of its velocity and of its angular velocity, or returns to the world's (`None`); wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::Damping`](crate::Quantity::Damping);
    /// [`Error::DampingHasNoInverse`].
    pub fn set_body_damping(
        &mut self,
        body: BodyId,
        linear: Option<Damping<S>>,
        angular: Option<Damping<S>>,
    ) -> Result<(), Error> {
        self.check_body_damping(body, linear, angular)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetBodyDamping { body, linear, angular });
        self.set_factors(dense, |key| (key.linear, key.angular) = (linear, angular));
        Ok(())
    }

    /// Sets or removes the largest speed of a body, m/s, and the largest angular speed, rad/s; wakes the body. A dynamic body
    /// that is faster at the end of a step is slowed down without a change of direction. Within a step it may be faster, for
    /// example after an impulse.
    ///
    /// *Error* the public speed after a step is at most the cap and √½ ulp, the angular speed at most the cap.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::MaxSpeed`](crate::Quantity::MaxSpeed) or
    /// [`Quantity::MaxAngularSpeed`](crate::Quantity::MaxAngularSpeed).
    pub fn set_max_speeds(&mut self, body: BodyId, linear: Option<S>, angular: Option<S>) -> Result<(), Error> {
        self.check_body_max_speeds(body, linear, angular)?;
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetMaxSpeeds { body, linear, angular });
        self.set_factors(dense, |key| key.most = [linear, angular]);
        Ok(())
    }

    /// Locks a body along these axes, where it stops, and unlocks it along the others; wakes the body. Forces along a locked
    /// axis have no effect, and do not change the motion along the others.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Locks, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let locks = Locks { y: true, rotation: true, ..Locks::NONE };
    /// let cart = world.add_body(BodyDef { position: vec2(0, fx!(0.1)), locks, ..BodyDef::dynamic() })?;
    /// world.apply_impulse_at_point(cart, vec2(3, 4), vec2(1, 1))?;
    /// (0..60).for_each(|_| _ = world.step());
    /// assert_eq!(world.body(cart)?.position(), vec2(3, fx!(0.1)));
    /// assert_eq!(world.body(cart)?.angular_velocity(), fx!(0));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_locks(&mut self, body: BodyId, locks: Locks) -> Result<(), Error> {
        S::set_locks(self, body, locks)
    }

    pub(crate) fn set_locks_inner(&mut self, body: BodyId, locks: Locks) -> Result<(), Error> {
        let dense = self.touch(body, Change::ALL)?;
        self.journal.note(|| Command::SetLocks { body, locks });
        self.targets.recall(body);
        self.bodies.set_locks(dense, Arc::make_mut(&mut self.factor_table), locks);
        Ok(())
    }

    /// Sets the [dominance](crate::BodyDef::dominance) of a body; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let boss = world.add_body(BodyDef { dominance: 5, ..BodyDef::dynamic() })?;
    /// world.set_dominance(boss, -1)?;
    /// assert_eq!(world.body(boss)?.dominance(), -1);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_dominance(&mut self, body: BodyId, dominance: i32) -> Result<(), Error> {
        self.edit(body, |info| info.dominance = dominance)?;
        self.journal.note(|| Command::SetDominance { body, dominance });
        Ok(())
    }

    /// Makes a body a [bullet](BodyDef::bullet), or no bullet any more; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let plate = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.01), 2)?);
    /// let plate = world.add_body(plate)?;
    /// let shot = BodyDef { position: vec2(-3, 0), velocity: vec2(1000, 0), ..BodyDef::dynamic() };
    /// let shot = world.add_body(shot.with_collider(Shape::circle(fx!(0.02))?))?;
    /// world.set_bullet(shot, true)?;
    /// world.step();
    /// assert!(world.body(shot)?.position().x < world.body(plate)?.position().x);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_bullet(&mut self, body: BodyId, bullet: bool) -> Result<(), Error> {
        self.edit(body, |info| info.is_bullet = bullet)?;
        self.journal.note(|| Command::SetBullet { body, bullet });
        Ok(())
    }

    /// Sets the groups of a body; wakes the body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn set_force_groups(&mut self, body: BodyId, force_groups: u32) -> Result<(), Error> {
        self.edit(body, |info| info.force_groups = force_groups)?;
        self.journal.note(|| Command::SetForceGroups { body, force_groups });
        Ok(())
    }

    /// Sets the caller's key of a body; wakes the body, as a custom force may read the key.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn set_key(&mut self, body: BodyId, key: u64) -> Result<(), Error> {
        self.edit(body, |info| info.key = key)?;
        self.journal.note(|| Command::SetKey { body, key });
        Ok(())
    }

    /// Sets the caller's data of a body; wakes the body, as a custom force may read the data.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn set_user_data(&mut self, body: BodyId, user_data: u64) -> Result<(), Error> {
        self.edit(body, |info| info.user_data = user_data)?;
        self.journal.note(|| Command::SetUserData { body, user_data });
        Ok(())
    }

    /// Wakes a body and changes properties that no step changes.
    fn edit(&mut self, body: BodyId, edit: impl FnOnce(&mut BodyInfo<S>)) -> Result<(), Error> {
        let dense = self.touch(body, Change::ALL)?;
        self.bodies.edit(dense, edit);
        Ok(())
    }

    /// Changes the parameters that a body's step factors are derived from.
    fn set_factors(&mut self, dense: usize, edit: impl FnOnce(&mut Key<S>)) {
        let mut key = self.factor_table.rows()[self.bodies.columns.factors[dense] as usize].key;
        edit(&mut key);
        S::set_factors(&mut self.bodies, dense, &mut self.factor_table, key);
    }
}
