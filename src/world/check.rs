//! The checks of calls. Each call that changes a world checks its arguments here first and uses the result; [`World::check`]
//! does no more than check.

use super::{World, WorldDef, check_gravity, check_sleep_after};
use crate::body::{
    Activity, BodyDef, BodyKind, Damping, Mass, MassProperties, Target, check_angle, check_angular_velocity,
    check_gravity_scale, check_max_angular_speed, check_max_speed, check_position, check_turning, check_unlocked,
    check_velocity, within_envelope,
};
use crate::collider::{ColliderDef, ColliderMass, more_outlines};
use crate::error::{Error, Quantity};
use crate::force::ForceField;
use crate::integrate::{Integrator, rate};
use crate::limits;
use crate::math::{Elapsed, TimeStep, Vec2};
use crate::scalar::{Angle, Scalar};
use crate::slots::{BodyId, ColliderId, FieldId};

// The calls on bodies; forces and impulses are in `forces.rs`.
impl<S: Scalar> World<S> {
    pub(super) fn check_new_body(&self, def: &BodyDef<S>) -> Result<(ColliderMass<S>, MassProperties<S>), Error> {
        let masses = def.checked()?;
        self.check_own_damping(def.linear_damping, def.angular_damping)?;
        self.bodies.check_room()?;
        self.colliders.check_room(def.colliders.len(), def.colliders.iter().map(more_outlines).sum())?;
        Ok(masses)
    }

    /// The mass of the body's colliders with another one, and the properties that follow.
    pub(super) fn check_new_collider(
        &self,
        body: BodyId,
        def: &ColliderDef<S>,
    ) -> Result<(ColliderMass<S>, MassProperties<S>), Error> {
        let dense = self.bodies.find(body)?;
        def.check()?;
        def.check_on(self.bodies.info(dense).kind == BodyKind::Dynamic)?;
        self.colliders.check_room(1, more_outlines(def))?;
        self.with_collider_mass(dense, self.bodies.info(dense).collider_mass().with(def))
    }

    /// The body of a collider, the mass of its colliders with this one defined anew or left out, and the properties that follow.
    pub(super) fn check_next_collider(
        &self,
        id: ColliderId,
        def: Option<&ColliderDef<S>>,
    ) -> Result<(BodyId, ColliderMass<S>, MassProperties<S>), Error> {
        let collider = self.colliders.get(id)?;
        let body = collider.body;
        let dense = self.bodies.find(body)?;
        if let Some(def) = def {
            def.check()?;
            def.check_on(self.bodies.info(dense).kind == BodyKind::Dynamic)?;
            self.colliders.check_room(0, more_outlines(def))?;
        }
        let mass = self.bodies.info(dense).collider_mass();
        let next = match def {
            Some(def) => mass.replaced(&collider.def, def),
            None => mass.without(&collider.def),
        };
        let (mass, properties) = self.with_collider_mass(dense, next)?;
        Ok((body, mass, properties))
    }

    fn with_collider_mass(
        &self,
        dense: usize,
        colliders: ColliderMass<S>,
    ) -> Result<(ColliderMass<S>, MassProperties<S>), Error> {
        let info = self.bodies.info(dense);
        let locks = self.bodies.mass(dense).locks;
        info.mass.properties(&colliders, info.kind, locks).map(|properties| (colliders, properties))
    }

    pub(super) fn check_body_position(&self, body: BodyId, position: Vec2<S>) -> Result<(), Error> {
        self.bodies.find(body)?;
        check_position(position)
    }

    pub(super) fn check_body_angle(&self, body: BodyId, angle: S) -> Result<(), Error> {
        self.bodies.find(body)?;
        check_angle(angle)
    }

    pub(super) fn check_body_velocity(&self, body: BodyId, velocity: Vec2<S>) -> Result<(), Error> {
        let dense = self.check_movable(body)?;
        check_velocity(velocity)?;
        check_unlocked(self.bodies.mass(dense).locks, velocity)
    }

    pub(super) fn check_body_angular_velocity(&self, body: BodyId, velocity: S) -> Result<(), Error> {
        let dense = self.check_movable(body)?;
        check_angular_velocity(velocity)?;
        check_turning(self.bodies.mass(dense).locks, velocity)
    }

    /// The target of a kinematic body.
    pub(super) fn check_move(&self, body: BodyId, position: Vec2<S>, angle: S) -> Result<Target<S>, Error> {
        let dense = self.check_taking_part(body)?;
        if self.bodies.info(dense).kind != BodyKind::Kinematic {
            return Err(Error::NotKinematic { body });
        }
        let locks = self.bodies.mass(dense).locks;
        check_position(position)?;
        check_angle(angle)?;
        let goal = Target { position, angle: S::Angle::from_radians(angle) };
        let motion = &self.bodies.columns.motion;
        goal.check_locks(motion.position.get(dense), motion.angle[dense], locks)?;
        let too_fast = Error::OutOfRange { quantity: Quantity::Velocity };
        goal.approach(motion, dense, locks, rate::<S>(self.def.time_step)).ok_or(too_fast)?;
        Ok(goal)
    }

    pub(super) fn check_body_mass(&self, body: BodyId, mass: Mass<S>) -> Result<MassProperties<S>, Error> {
        let dense = self.bodies.find(body)?;
        let info = self.bodies.info(dense);
        mass.properties(&info.collider_mass(), info.kind, self.bodies.mass(dense).locks)
    }

    pub(super) fn check_body_kind(&self, body: BodyId, kind: BodyKind) -> Result<MassProperties<S>, Error> {
        let dense = self.check_taking_part(body)?;
        let info = self.bodies.info(dense);
        if kind == BodyKind::Dynamic && info.collider_mass().any_chain() {
            return Err(Error::DynamicChain);
        }
        info.mass.properties(&info.collider_mass(), kind, self.bodies.mass(dense).locks)
    }

    pub(super) fn check_body_gravity_scale(&self, body: BodyId, scale: S) -> Result<(), Error> {
        self.bodies.find(body)?;
        check_gravity_scale(scale)
    }

    pub(super) fn check_body_damping(
        &self,
        body: BodyId,
        linear: Option<Damping<S>>,
        angular: Option<Damping<S>>,
    ) -> Result<(), Error> {
        self.bodies.find(body)?;
        linear.map_or(Ok(()), Damping::check)?;
        angular.map_or(Ok(()), Damping::check)?;
        self.check_own_damping(linear, angular)
    }

    pub(super) fn check_body_max_speeds(
        &self,
        body: BodyId,
        linear: Option<S>,
        angular: Option<S>,
    ) -> Result<(), Error> {
        self.bodies.find(body)?;
        linear.map_or(Ok(()), check_max_speed)?;
        angular.map_or(Ok(()), check_max_angular_speed)
    }

    /// Refuses a body that is quarantined or disabled.
    pub(super) fn check_taking_part(&self, body: BodyId) -> Result<usize, Error> {
        let dense = self.bodies.find(body)?;
        match self.bodies.activity(dense) {
            Activity::Quarantined => Err(Error::Quarantined { body }),
            Activity::Disabled => Err(Error::Disabled { body }),
            Activity::Awake | Activity::Asleep => Ok(dense),
        }
    }

    pub(super) fn check_enable(&self, body: BodyId) -> Result<usize, Error> {
        let dense = self.bodies.find(body)?;
        match self.bodies.activity(dense) {
            Activity::Disabled => Ok(dense),
            _ => Err(Error::NotDisabled { body }),
        }
    }

    /// Refuses a body that is not quarantined, or is outside the limits.
    pub(super) fn check_release(&self, body: BodyId) -> Result<usize, Error> {
        let dense = self.bodies.find(body)?;
        if self.bodies.activity(dense) != Activity::Quarantined {
            return Err(Error::NotQuarantined { body });
        }
        let motion = &self.bodies.columns.motion;
        // To the last bit, as the end of a step checks it.
        let (velocity, angular_velocity) = (motion.velocity.get(dense), motion.angular_velocity[dense]);
        let bounds = [limits::POSITION, limits::SPEED, limits::ANGULAR_SPEED];
        within_envelope::<S>(motion.position.get(dense), velocity, angular_velocity, bounds).map(|()| dense)
    }

    fn check_own_damping(&self, linear: Option<Damping<S>>, angular: Option<Damping<S>>) -> Result<(), Error> {
        let stops = [linear, angular].into_iter().flatten().any(Damping::stops);
        if self.def.integrator == Integrator::Yoshida4 && stops {
            return Err(Error::DampingHasNoInverse);
        }
        Ok(())
    }

    pub(super) fn check_movable(&self, body: BodyId) -> Result<usize, Error> {
        let dense = self.bodies.find(body)?;
        match self.bodies.info(dense).kind {
            BodyKind::Static => Err(Error::NotMovable { body }),
            _ => Ok(dense),
        }
    }
}

// The calls on force fields.
impl<S: Scalar> World<S> {
    pub(super) fn check_new_field(&self, field: &ForceField<S>) -> Result<(), Error> {
        field.check(&self.bodies, &self.custom_forces)?;
        self.fields.check_room()
    }

    /// The field that would be replaced.
    pub(super) fn check_next_field(&self, id: FieldId, field: &ForceField<S>) -> Result<ForceField<S>, Error> {
        let old = self.check_field(id)?;
        field.check(&self.bodies, &self.custom_forces)?;
        Ok(old)
    }

    pub(super) fn check_field(&self, id: FieldId) -> Result<ForceField<S>, Error> {
        self.fields.get(id).copied()
    }
}

// The calls on the parameters of the step. Each gives the definition as it would be.
impl<S: Scalar> World<S> {
    /// The definition with another time step, and the time elapsed until now.
    pub(super) fn check_time_step(&self, time_step: TimeStep) -> Result<(WorldDef<S>, Elapsed), Error> {
        let time_step = time_step.checked()?;
        let now = self.counted.0.plus(self.tick - self.counted.1, self.def.time_step).ok_or(Error::ElapsedTime)?;
        now.plus(u64::MAX, time_step).ok_or(Error::ElapsedTime)?;
        Ok((WorldDef { time_step, ..self.def }, now))
    }

    pub(super) fn check_gravity(&self, gravity: Vec2<S>) -> Result<WorldDef<S>, Error> {
        check_gravity(gravity)?;
        Ok(WorldDef { gravity, ..self.def })
    }

    pub(super) fn check_integrator(&self, integrator: Integrator) -> Result<WorldDef<S>, Error> {
        if integrator == Integrator::Yoshida4 && self.factor_table.any_stopping() {
            return Err(Error::DampingHasNoInverse);
        }
        let def = WorldDef { integrator, ..self.def };
        def.check()?;
        Ok(def)
    }

    pub(super) fn check_damping(&self, linear: Damping<S>, angular: Damping<S>) -> Result<WorldDef<S>, Error> {
        let def = WorldDef { linear_damping: linear, angular_damping: angular, ..self.def };
        def.check()?;
        Ok(def)
    }

    pub(super) fn check_sleep_after(&self, ticks: Option<u32>) -> Result<WorldDef<S>, Error> {
        check_sleep_after(ticks)?;
        Ok(WorldDef { sleep_after: ticks, ..self.def })
    }
}
