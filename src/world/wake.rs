//! Waking bodies and putting them to sleep: a change to a body wakes it and whatever it may move.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Command, World};
use crate::body::{Acceleration, Activity, BodyKind, Change};
use crate::contact::is_asleep;
use crate::error::Error;
use crate::force::FieldKind;
use crate::island::{self, Joins};
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// Wakes a body, and those that springs, joints and contacts join it to.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::Quarantined`]; [`Error::Disabled`].
    ///
    /// ```
    /// use umbra_physics::{Activity, BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() })?;
    /// let body = world.add_body(BodyDef::dynamic())?;
    /// world.step();
    /// assert_eq!(world.body(body)?.activity(), Activity::Asleep);
    /// world.wake(body)?;
    /// assert_eq!(world.body(body)?.activity(), Activity::Awake);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn wake(&mut self, body: BodyId) -> Result<(), Error> {
        self.check_taking_part(body)?;
        self.journal.note(|| Command::Wake(body));
        self.touch(body, Change::VELOCITY).map(drop)
    }

    /// Puts a body to sleep, with the bodies that springs, joints and the contacts of the last step join it to, and with kinematic bodies at rest that
    /// these touch: they stop where they are, and steps skip them until something wakes them, as if they had come to rest. A body that is still in the
    /// air stays there. Forces that were applied to them in this tick are dropped, and so is the target of a kinematic body. A level can begin with all
    /// its bodies asleep.
    ///
    /// They wake as other sleeping bodies do: by a call that changes one of them, by a body that touches them, and with the bodies that springs, joints
    /// and contacts join them to. Bodies that were put to sleep before their first step have no contacts yet: where the lowest one of a pile is
    /// removed, the others stay until they are woken or struck. The contacts of a body that a call has placed elsewhere since the last step
    /// are the contacts that it had there. An attractor on a body that moves wakes nobody.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotMovable`] for a static body; [`Error::Quarantined`]; [`Error::Disabled`]; [`Error::SleepIsOff`] in a world whose
    /// [`sleep_after`](super::WorldDef::sleep_after) is `None`; [`Error::KeptAwake`] if another body, which is kinematic and moves, touches one of these or is
    /// joined to it.
    ///
    /// ```
    /// use umbra_physics::{Activity, BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let crate_ = world.add_body(BodyDef::dynamic())?;
    /// world.sleep(crate_)?;
    /// for _ in 0..60 {
    ///     world.step();
    /// }
    /// assert_eq!(world.body(crate_)?.position(), vec2(0, 0));
    /// world.wake(crate_)?;
    /// world.step();
    /// assert_ne!(world.body(crate_)?.position(), vec2(0, 0));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("put_to_sleep", "SetAwake", "set_sleeping"))]
    pub fn sleep(&mut self, body: BodyId) -> Result<(), Error> {
        S::sleep(self, body)
    }

    pub(crate) fn sleep_inner(&mut self, body: BodyId) -> Result<(), Error> {
        let mut members = self.check_sleep(body)?;
        self.journal.note(|| Command::Sleep(body));
        if members.is_empty() {
            return Ok(());
        }
        members.sort_unstable();
        for &member in &members {
            let dense = self.bodies.find(member)?;
            // It may not have moved yet with the factors that it wakes with.
            if !self.factor_table.is_made(self.bodies.columns.factors[dense]) {
                Arc::make_mut(&mut self.factor_table).set_stale();
            }
            let motion = &mut self.bodies.columns.motion;
            motion.stop(dense);
            if let Some(last) = motion.last_acceleration.get_mut(dense) {
                *last = Acceleration::default();
            }
            self.bodies.set_activity(dense, Activity::Asleep);
            self.mark_if_still(member);
            self.applied.forget(member);
            self.targets.forget(member);
        }
        let Self { bodies, colliders, contacts, change_log, .. } = self;
        contacts.fall_asleep(|slot| is_asleep(bodies, colliders, slot));
        change_log.put_to_sleep(&members, bodies);
        Ok(())
    }

    /// Refuses to put a body to sleep, or gives the bodies that are to fall asleep with it; none if it sleeps already.
    pub(crate) fn check_sleep(&self, body: BodyId) -> Result<Vec<BodyId>, Error> {
        self.check_taking_part(body)?;
        let dense = self.check_movable(body)?;
        if self.def.sleep_after.is_none() {
            return Err(Error::SleepIsOff);
        }
        if self.bodies.activity(dense) == Activity::Asleep {
            return Ok(Vec::new());
        }
        let Self { bodies, fields, colliders, contacts, targets, .. } = self;
        let joins = Joins { fields, colliders, contacts, joints: self.joints.joined(&self.joint_states) };
        let members = island::awake_island(bodies, joins, dense);
        let is_kinematic = |i: usize| bodies.info(i).kind == BodyKind::Kinematic;
        let moves = |i: usize| !bodies.columns.motion.is_still(i) || targets.of(bodies.id(i)).is_some();
        let moving = members.iter().filter(|&&i| i != dense && is_kinematic(i) && moves(i));
        match moving.map(|&i| bodies.id(i)).min() {
            Some(kinematic) => Err(Error::KeptAwake { kinematic }),
            None => Ok(members.into_iter().map(|i| bodies.id(i)).collect()),
        }
    }

    /// Takes a quarantined body back into the simulation, with its last good state and the values that were set since.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotQuarantined`]; [`Error::OutOfRange`] in a world of a [`Trace`](super::Trace), for a
    /// body that is still beyond the envelope.
    pub fn release(&mut self, body: BodyId) -> Result<(), Error> {
        let dense = self.check_release(body)?;
        self.journal.note(|| Command::Release(body));
        self.bodies.set_activity(dense, Activity::Awake);
        self.wake_joined(body);
        Ok(())
    }

    /// Takes a body out of the simulation as it is: no step moves it, it touches nothing, fields and joints attached to it are inert, and
    /// forces applied to it in this tick are dropped. Wakes the bodies that contacts, springs, joints and its attractors joined it to. It keeps its
    /// velocity until it is [enabled](Self::enable), and can be changed meanwhile.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::Disabled`] if it is so already; [`Error::Quarantined`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let ball = world.add_body(BodyDef { velocity: vec2(60, 0), ..BodyDef::dynamic() })?;
    /// world.disable(ball)?;
    /// world.step();
    /// world.enable(ball)?;
    /// world.step();
    /// assert_eq!(world.body(ball)?.position(), vec2(1, 0));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn disable(&mut self, body: BodyId) -> Result<(), Error> {
        self.check_taking_part(body)?;
        self.journal.note(|| Command::Disable(body));
        self.wake_joined(body);
        let dense = self.bodies.find(body)?;
        self.bodies.set_activity(dense, Activity::Disabled);
        self.mark_if_still(body);
        self.applied.forget(body);
        self.targets.recall(body);
        self.relax_joints(body);
        self.change_log.taken_out(body);
        Ok(())
    }

    /// Takes a disabled body back into the simulation, with the state it has; wakes it and the bodies that it is joined to.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::NotDisabled`].
    pub fn enable(&mut self, body: BodyId) -> Result<(), Error> {
        let dense = self.check_enable(body)?;
        self.journal.note(|| Command::Enable(body));
        self.bodies.set_activity(dense, Activity::Awake);
        self.wake_joined(body);
        // A static one: no step moves it.
        self.mark_if_still(body);
        Ok(())
    }

    /// Notes what is about to change of a body, wakes it if it sleeps, and gives its index.
    pub(super) fn touch(&mut self, body: BodyId, change: Change) -> Result<usize, Error> {
        S::touch(self, body, change)
    }

    pub(crate) fn touch_inner(&mut self, body: BodyId, change: Change) -> Result<usize, Error> {
        let dense = self.bodies.find(body)?;
        // Neighbours of an awake dynamic body are awake: an island sleeps as a whole. Neighbours of a static or kinematic body may sleep. A
        // disabled or quarantined dynamic body wakes its neighbours when it takes part again.
        if self.bodies.activity(dense) == Activity::Asleep || self.bodies.info(dense).kind != BodyKind::Dynamic {
            self.wake_joined(body);
        }
        let dense = self.bodies.find(body)?;
        self.bodies.note(dense, change);
        self.bodies.columns.motion.ticks_at_rest[dense] = 0;
        self.mark_if_still(body);
        Ok(dense)
    }

    /// Notes that a call changes a body, if no step moves it: of the others it goes without saying.
    pub(super) fn mark_if_still(&mut self, body: BodyId) {
        if self.bodies.find(body).is_ok_and(|dense| dense >= self.bodies.moving()) {
            self.change_log.changed(body.slot);
        }
    }

    /// Wakes a body and all that a field or joint reaches from it, over any number of springs and joints.
    pub(super) fn wake_joined(&mut self, body: BodyId) {
        S::wake_joined(self, body);
    }

    pub(crate) fn wake_joined_inner(&mut self, body: BodyId) {
        // Until somebody falls asleep, by a step or by a call, once is enough.
        if !self.bodies.any_asleep() || !self.change_log.looks_around(body) {
            return;
        }
        let mut reached = Vec::from([body]);
        let Self { fields, colliders, contacts, .. } = self;
        let joints = self.joints.joined(&self.joint_states);
        // Also where no impulse is left: the contact may end by this call, and a step looks only at those of awake bodies.
        reached.extend(Joins { fields, colliders, contacts, joints }.touching(body).map(|(body, _)| body));
        let partners = joints.partners(body.slot).filter_map(|slot| self.bodies.index_in(slot));
        reached.extend(partners.map(|dense| self.bodies.id(dense)));
        let mut force_groups = 0;
        for (_, field) in fields.attached_to(body) {
            if matches!(field.kind, FieldKind::Attractor { .. }) {
                force_groups |= field.force_groups;
            }
            reached.extend(field.bodies());
        }
        self.wake_reached(&reached, force_groups);
    }

    /// Wakes bodies, those that a field with these groups acts on, and the islands of either. Others sleep on: what a field does
    /// not act on must not feel that it came.
    ///
    /// It looks at the bodies that it wakes and the fields attached to them, and at all that sleep if one of them feels the
    /// groups: then none of these is left that does, until somebody falls asleep.
    pub(super) fn wake_reached(&mut self, bodies: &[BodyId], force_groups: u32) {
        let mut woken = Vec::new();
        self.wake_islands(bodies.iter().copied(), &mut woken);
        if self.bodies.any_asleep_in(force_groups) {
            let feel = self.bodies.asleep().filter(|&i| self.bodies.info(i).feels(force_groups));
            let feel: Vec<BodyId> = feel.map(|i| self.bodies.id(i)).collect();
            self.wake_islands(feel, &mut woken);
        }
        self.report_woken(woken);
    }

    /// Wakes all that sleeps.
    pub(super) fn wake_all(&mut self) {
        if self.bodies.any_asleep() {
            let asleep: Vec<BodyId> = self.bodies.asleep().map(|i| self.bodies.id(i)).collect();
            let mut woken = Vec::with_capacity(asleep.len());
            self.wake_islands(asleep, &mut woken);
            self.report_woken(woken);
        }
    }

    /// Wakes bodies and the islands that they are in. Adds those that slept to `woken`.
    fn wake_islands(&mut self, reached: impl IntoIterator<Item = BodyId>, woken: &mut Vec<BodyId>) {
        let Self { bodies, fields, colliders, contacts, .. } = self;
        let joints = self.joints.joined(&self.joint_states);
        let before = woken.len();
        island::wake(bodies, Joins { fields, colliders, contacts, joints }, reached, woken);
        if woken.len() > before {
            contacts.wake(|slot| is_asleep(bodies, colliders, slot));
        }
    }

    fn report_woken(&mut self, mut woken: Vec<BodyId>) {
        woken.sort_unstable();
        self.change_log.woke(&woken);
    }
}
