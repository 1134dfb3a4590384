//! The complete state of one body, as snapshots have it, and bodies made from such a state.

use super::columns::Bodies;
use super::factors::FactorTable;
use super::motion::Acceleration;
use super::{Activity, BodyDef, BodyKind, Damping, Locks, Mass, MassProperties, within_envelope};
use crate::codec::codec_struct;
use crate::collider::ColliderMass;
use crate::error::{Error, Quantity};
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Scalar};
use crate::slots::BodyId;

codec_struct!(Acceleration { linear, angular });

/// The state of a body without its colliders and its handle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<S: Scalar> {
    pub(crate) kind: BodyKind,
    pub(crate) activity: Activity,
    pub(crate) position: Vec2<S::Accumulator>,
    pub(crate) velocity: Vec2<S::Accumulator>,
    pub(crate) angle: S::Angle,
    pub(crate) angular_velocity: S::Accumulator,
    pub(crate) ticks_at_rest: u32,
    pub(crate) last_acceleration: Option<Acceleration<S>>,
    pub(crate) mass: Mass<S>,
    pub(crate) gravity_scale: S,
    pub(crate) linear_damping: Option<Damping<S>>,
    pub(crate) angular_damping: Option<Damping<S>>,
    pub(crate) max_speed: Option<S>,
    pub(crate) max_angular_speed: Option<S>,
    pub(crate) locks: Locks,
    pub(crate) dominance: i32,
    pub(crate) bullet: bool,
    pub(crate) force_groups: u32,
    pub(crate) key: u64,
    pub(crate) user_data: u64,
}

codec_struct!(Record {
    kind,
    activity,
    position,
    velocity,
    angle,
    angular_velocity,
    ticks_at_rest,
    last_acceleration,
    mass,
    gravity_scale,
    linear_damping,
    angular_damping,
    max_speed,
    max_angular_speed,
    locks,
    dominance,
    bullet,
    force_groups,
    key,
    user_data,
});

impl<S: Scalar> Record<S> {
    /// Refuses a state that no call and no step leaves a body in.
    fn check(&self, colliders: &ColliderMass<S>) -> Result<MassProperties<S>, Error> {
        // A quarantined body may be in a state within a step. It is checked again before it is released.
        let limits = match self.activity {
            Activity::Quarantined => [limits::TRANSIENT_POSITION, limits::TRANSIENT_SUM, limits::TRANSIENT_SUM],
            Activity::Awake | Activity::Asleep | Activity::Disabled => {
                [limits::POSITION, limits::SPEED, limits::ANGULAR_SPEED]
            }
        };
        within_envelope::<S>(self.position, self.velocity, self.angular_velocity, limits)?;
        let none = S::Accumulator::default();
        let moves = self.velocity != Vec2::new(none, none) || self.angular_velocity != none;
        if self.kind == BodyKind::Static && moves {
            return Err(Error::OutOfRange { quantity: Quantity::Velocity });
        }
        self.check_locks()?;
        let is_still = |v: S::Accumulator| v.is_still();
        let rests = is_still(self.velocity.x) && is_still(self.velocity.y) && is_still(self.angular_velocity);
        // No step puts a static body to sleep or quarantines it.
        let stopped = matches!(self.activity, Activity::Asleep | Activity::Quarantined);
        if (stopped && self.kind == BodyKind::Static) || (self.activity == Activity::Asleep && !rests) {
            return Err(Error::Inconsistent);
        }
        self.def().check_properties(colliders)
    }

    /// Refuses a velocity along a locked axis, and a last acceleration that would cause one.
    fn check_locks(&self) -> Result<(), Error> {
        let (none, zero) = (S::Accumulator::default(), S::Wide::default());
        let last = self.last_acceleration.unwrap_or_default();
        let locked = [
            (self.locks.x, self.velocity.x, last.linear.x, Quantity::Velocity),
            (self.locks.y, self.velocity.y, last.linear.y, Quantity::Velocity),
            (self.locks.rotation, self.angular_velocity, last.angular, Quantity::AngularVelocity),
        ];
        // Forces move dynamic bodies only.
        if self.kind != BodyKind::Dynamic && [last.linear.x, last.linear.y, last.angular] != [zero; 3] {
            return Err(Error::Inconsistent);
        }
        let moves = locked.into_iter().find(|&(locked, v, last, _)| locked && (v != none || last != zero));
        moves.map_or(Ok(()), |(.., quantity)| Err(Error::Locked { quantity }))
    }

    /// The definition, without the colliders and the motion.
    fn def(&self) -> BodyDef<S> {
        BodyDef {
            kind: self.kind,
            mass: self.mass,
            gravity_scale: self.gravity_scale,
            linear_damping: self.linear_damping,
            angular_damping: self.angular_damping,
            max_speed: self.max_speed,
            max_angular_speed: self.max_angular_speed,
            locks: self.locks,
            dominance: self.dominance,
            bullet: self.bullet,
            force_groups: self.force_groups,
            key: self.key,
            user_data: self.user_data,
            ..BodyDef::dynamic()
        }
    }
}

/// The occupant of a slot: a body and the mass of its colliders, or none.
type Occupant<S> = Option<(Record<S>, ColliderMass<S>)>;

impl<S: Scalar> Bodies<S> {
    /// The state of the body at this index in the columns.
    pub(crate) fn record(&self, dense: usize, factor_table: &FactorTable<S>) -> Record<S> {
        let info = self.info(dense);
        let motion = &self.columns.motion;
        let key = &factor_table.rows()[self.columns.factors[dense] as usize].key;
        Record {
            kind: info.kind,
            activity: self.activity(dense),
            position: motion.position.get(dense),
            velocity: motion.velocity.get(dense),
            angle: motion.angle[dense],
            angular_velocity: motion.angular_velocity[dense],
            ticks_at_rest: motion.ticks_at_rest[dense],
            last_acceleration: self
                .keeps_last()
                .then(|| motion.last_acceleration.get(dense).copied().unwrap_or_default()),
            mass: info.mass,
            gravity_scale: key.gravity_scale,
            linear_damping: key.linear,
            angular_damping: key.angular,
            max_speed: key.most[0],
            max_angular_speed: key.most[1],
            locks: self.mass(dense).locks,
            dominance: info.dominance,
            bullet: info.is_bullet,
            force_groups: info.force_groups,
            key: info.key,
            user_data: info.user_data,
        }
    }

    /// An empty set of bodies, to [`rebuild`](Self::rebuild) the bodies of a snapshot in.
    pub(crate) fn empty(keep_last: bool) -> Self {
        let mut bodies = Self::default();
        bodies.keep_last_acceleration(keep_last);
        bodies
    }

    /// Adds a slot as a snapshot has it, with a body or without; gives the index of the body. The world
    /// refuses combinations that its own parameters forbid.
    pub(crate) fn rebuild(
        &mut self,
        generation: u32,
        occupant: Occupant<S>,
        factor_table: &mut FactorTable<S>,
    ) -> Result<Option<usize>, Error> {
        if self.slots().len() >= limits::BODIES {
            return Err(Error::Full);
        }
        let Some((record, colliders)) = occupant else {
            self.new_slot(generation);
            return Ok(None);
        };
        let properties = record.check(&colliders)?;
        if record.last_acceleration.is_some() != self.keeps_last() {
            return Err(Error::Inconsistent);
        }
        let slot = self.new_slot(generation);
        self.insert_at(slot, &record.def(), colliders, properties, factor_table);
        let dense = self.slots.all()[slot as usize].index_or_none() as usize;
        let dense = self.set_activity(dense, record.activity);
        let motion = &mut self.columns.motion;
        motion.position.set(dense, record.position);
        motion.velocity.set(dense, record.velocity);
        motion.angle[dense] = record.angle;
        motion.angular_velocity[dense] = record.angular_velocity;
        motion.ticks_at_rest[dense] = record.ticks_at_rest;
        if let (Some(place), Some(last)) = (motion.last_acceleration.get_mut(dense), record.last_acceleration) {
            *place = last;
        }
        Ok(Some(dense))
    }

    /// Adds a copy of a body of another world with the same parameters. Everything is copied but its handle.
    pub(crate) fn adopt(
        &mut self,
        source: &Self,
        body: BodyId,
        other_factors: &FactorTable<S>,
        factor_table: &mut FactorTable<S>,
    ) -> Result<BodyId, Error> {
        let from = source.find(body)?;
        let def = source.record(from, other_factors).def();
        let adopted = self.insert(&def, source.info(from).collider_mass(), *source.mass(from), factor_table);
        let dense = self.find(adopted)?;
        let dense = self.set_activity(dense, source.activity(from));
        self.make_last_accelerations();
        self.is_rest_zero = false;
        self.columns.motion.copy(dense, &source.columns.motion, from);
        Ok(adopted)
    }
}
