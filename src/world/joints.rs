//! Adding, removing and changing joints.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Command, JointRef, World};
use crate::body::{BodyKind, Change};
use crate::contact::sorted;
use crate::error::Error;
use crate::fx::Fx;
use crate::joint::{JointDef, JointKind, JointMotor, check_break};
use crate::scalar::{Angle as _, Scalar, Turn};
use crate::slots::{BodyId, JointId};
use crate::solve::Impulses;

/// The command that sets the motor of a joint, for its kind with the motor. Images of motors that turn are others than images of motors that push,
/// which are told by their kind.
fn motor_command<S: Scalar>(joint: JointId, motor: Option<JointMotor<S>>, kind: JointKind<S>) -> Command<S> {
    if kind.motor_turns() { Command::SetJointMotor { joint, motor } } else { Command::SetJointKind { joint, kind } }
}

impl<S: Scalar> World<S> {
    /// Adds a joint, and wakes its bodies. Contacts between them end, unless the joint has
    /// [`collide_connected`](JointDef::collide_connected).
    ///
    /// Joined bodies fall asleep and wake together. A joint to a disabled or quarantined body does nothing until the body takes part again, and
    /// then starts without an impulse. [Dominance](crate::BodyDef::dominance) is for contacts alone: a joint pulls both bodies.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::SameBody`]; [`Error::NothingToMove`] if neither end is on a dynamic body; [`Error::OutOfRange`] with the
    /// quantity: `Position` for a point of the world, `JointPoint` for a point of a body, `Angle` for a float that is no number, `BreakForce`, or
    /// as [`JointKind::check`] has it; [`Error::Full`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Distance, JointDef, JointKind, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let bob = world.add_body(BodyDef { position: vec2(3, 0), ..BodyDef::dynamic() })?;
    /// let rod = world.add_joint(JointDef::between(&world, None, vec2(0, 0), bob, vec2(3, 0))?)?;
    /// (0..600).for_each(|_| _ = world.step());
    /// assert!((world.body(bob)?.position().length() - fx!(3)).abs() < fx!(0.001));
    ///
    /// // Everything but the ends can be changed later.
    /// world.set_joint_kind(rod, JointKind::Distance(Distance::rod(fx!(2))))?;
    /// world.set_joint_break(rod, Some(fx!(100)))?;
    /// world.enable_joint(rod, false)?;
    /// assert_eq!(world.joints_of(bob)?.map(|joint| joint.id()).collect::<Vec<_>>(), [rod]);
    /// world.remove_joint(rod)?;
    /// assert!(world.joint(rod).is_err() && world.joints().next().is_none());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("create_joint", "insert_joint"))]
    pub fn add_joint(&mut self, def: JointDef<S>) -> Result<JointId, Error> {
        S::add_joint(self, def)
    }

    pub(crate) fn add_joint_inner(&mut self, def: JointDef<S>) -> Result<JointId, Error> {
        self.check_new_joint(&def)?;
        self.touch_joined(&def)?;
        self.journal.note(|| Command::AddJoint(def));
        let id = Arc::make_mut(&mut self.joints).insert(def, &mut self.joint_states);
        self.engage_ratchet(self.joints.find(id)?);
        self.end_contacts_of(&def);
        Ok(id)
    }

    /// Removes a joint, and wakes its bodies. They may touch each other from the next step on.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`].
    pub fn remove_joint(&mut self, joint: JointId) -> Result<(), Error> {
        S::remove_joint(self, joint)
    }

    pub(crate) fn remove_joint_inner(&mut self, joint: JointId) -> Result<(), Error> {
        self.take_joint(joint)?;
        self.journal.note(|| Command::RemoveJoint(joint));
        Ok(())
    }

    /// Removes a joint as part of another change.
    pub(super) fn take_joint(&mut self, joint: JointId) -> Result<(), Error> {
        let def = *self.joints.def(self.joints.find(joint)?);
        self.touch_joined(&def)?;
        Arc::make_mut(&mut self.joints).remove(joint, &mut self.joint_states).map(drop)
    }

    /// Sets what a joint keeps; wakes its bodies. A joint with the same rows as before keeps its impulses: a weld those of a revolute joint.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`]; [`Error::OutOfRange`] with the quantity of the value that is out of range, such as [`Quantity::JointLimits`](crate::Quantity::JointLimits).
    pub fn set_joint_kind(&mut self, joint: JointId, kind: JointKind<S>) -> Result<(), Error> {
        let index = self.check_joint_kind(joint, &kind)?;
        let old = self.joints.def(index).kind;
        self.redefine_joint(index, |def| def.kind = kind)?;
        self.journal.note(|| Command::SetJointKind { joint, kind });
        if !kind.has_rows_of(&old) {
            self.joint_states.list[index].clear_impulses();
        }
        self.fit_joint_state(index);
        if kind.ratchet() != old.ratchet() {
            self.engage_ratchet(index);
        }
        Ok(())
    }

    /// Sets the motor of a joint, `None` for no motor; wakes its bodies. The impulse that the joint starts from stays.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`]; [`Error::NoMotor`] for a weld; [`Error::OutOfRange`] with [`Quantity::MotorSpeed`](crate::Quantity::MotorSpeed) or
    /// [`Quantity::JointForce`](crate::Quantity::JointForce).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointMotor, Mass, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    /// let wheel = world.add_body(BodyDef { mass, ..BodyDef::dynamic() })?;
    /// let axle = world.add_joint(JointDef::at(&world, None, wheel, vec2(0, 0))?)?;
    /// world.set_joint_motor(axle, Some(JointMotor { speed: fx!(-3), max_force: fx!(100) }))?;
    /// (0..10).for_each(|_| _ = world.step());
    /// assert!((world.body(wheel)?.angular_velocity() + fx!(3)).abs() < fx!(0.00001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_joint_motor(&mut self, joint: JointId, motor: Option<JointMotor<S>>) -> Result<(), Error> {
        let (index, kind) = self.check_joint_motor(joint, motor)?;
        let command = motor_command(joint, motor, kind);
        self.redefine_joint(index, |def| def.kind = kind)?;
        self.journal.note(|| command);
        self.fit_joint_state(index);
        Ok(())
    }

    /// The command that does what [`set_joint_motor`](Self::set_joint_motor) would do now, for inputs that go to other players.
    ///
    /// # Errors
    /// As [`set_joint_motor`](Self::set_joint_motor).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Command, JointDef, JointKind, JointMotor, Prismatic, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let cabin = world.add_body(BodyDef::dynamic())?;
    /// let lift = world.add_joint(JointDef::along(&world, None, cabin, vec2(0, 0), vec2(0, 1))?)?;
    /// let motor = Some(JointMotor { speed: fx!(1), max_force: fx!(100) });
    /// let up = world.joint_motor_command(lift, motor)?;
    /// assert!(matches!(up, Command::SetJointKind { kind: JointKind::Prismatic(Prismatic { motor: Some(_), .. }), .. }));
    /// world.execute(&up)?;
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn joint_motor_command(&self, joint: JointId, motor: Option<JointMotor<S>>) -> Result<Command<S>, Error> {
        let (_, kind) = self.check_joint_motor(joint, motor)?;
        Ok(motor_command(joint, motor, kind))
    }

    /// Sets the mean force over a step, N, above which a joint breaks, `None` for never; wakes its bodies. A joint that is broken stays so.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`]; [`Error::OutOfRange`] with [`Quantity::BreakForce`](crate::Quantity::BreakForce).
    pub fn set_joint_break(&mut self, joint: JointId, force: Option<S>) -> Result<(), Error> {
        let index = self.check_joint_break(joint, force)?;
        self.redefine_joint(index, |def| def.break_force = force)?;
        self.journal.note(|| Command::SetJointBreak { joint, force });
        Ok(())
    }

    /// Sets the mean torque over a step, N·m, above which a joint breaks, `None` for never; wakes its bodies. A joint that is broken stays so.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`]; [`Error::OutOfRange`] with [`Quantity::BreakForce`](crate::Quantity::BreakForce).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Mass, Weld, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    /// let shelf = world.add_body(BodyDef { position: vec2(1, 0), mass, ..BodyDef::dynamic() })?;
    /// let weld = JointDef { kind: JointKind::Weld(Weld::default()), ..JointDef::at(&world, None, shelf, vec2(0, 0))? };
    /// let weld = world.add_joint(weld)?;
    /// // The shelf pulls with 10 N, and bends the weld with 10 N·m.
    /// world.set_joint_break_torque(weld, Some(fx!(11)))?;
    /// (0..60).for_each(|_| _ = world.step());
    /// assert!(!world.joint(weld)?.is_broken());
    /// world.apply_force(shelf, vec2(0, -5))?;
    /// world.step();
    /// assert!(world.joint(weld)?.is_broken());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_joint_break_torque(&mut self, joint: JointId, torque: Option<S>) -> Result<(), Error> {
        let index = self.check_joint_break(joint, torque)?;
        self.redefine_joint(index, |def| def.break_torque = torque)?;
        self.journal.note(|| Command::SetJointBreakTorque { joint, torque });
        Ok(())
    }

    /// Enables or disables a joint, and wakes its bodies. A disabled one does nothing; its bodies may touch each other. An enabled one starts
    /// without an impulse if it was disabled; a broken one is repaired by either call.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`].
    pub fn enable_joint(&mut self, joint: JointId, enabled: bool) -> Result<(), Error> {
        let index = self.joints.find(joint)?;
        let was_active = self.joint_at(index).is_active();
        self.redefine_joint(index, |def| def.enabled = enabled)?;
        self.journal.note(|| Command::EnableJoint { joint, enabled });
        let state = &mut self.joint_states.list[index];
        state.is_broken = false;
        if !enabled {
            state.clear_impulses();
            return Ok(());
        }
        if !was_active {
            self.engage_ratchet(index);
        }
        let def = *self.joints.def(index);
        self.end_contacts_of(&def);
        Ok(())
    }

    /// A view of a joint.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`].
    pub fn joint(&self, joint: JointId) -> Result<JointRef<'_, S>, Error> {
        Ok(self.joint_at(self.joints.find(joint)?))
    }

    fn joint_at(&self, index: usize) -> JointRef<'_, S> {
        JointRef { world: self, index }
    }

    /// All joints, sorted by their keys, then by their handles.
    pub fn joints(&self) -> impl Iterator<Item = JointRef<'_, S>> {
        self.sorted_joints(self.joints.indices().collect())
    }

    /// The first joint by handle with this [key](JointRef::key). The call looks through all joints: keep the handle if you need it often.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let door = world.add_body(BodyDef::dynamic())?;
    /// let [upper, lower] = [1, -1].map(|y| JointDef::at(&world, None, door, vec2(0, y)));
    /// let upper = world.add_joint(JointDef { key: 7, ..upper? })?;
    /// let lower = world.add_joint(JointDef { key: 7, ..lower? })?;
    /// assert_eq!(world.joint_with_key(7).map(|joint| joint.id()), Some(upper));
    /// assert!(world.joints_with_key(7).map(|joint| joint.id()).eq([upper, lower]));
    /// assert!(world.joint_with_key(8).is_none());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn joint_with_key(&self, key: u64) -> Option<JointRef<'_, S>> {
        self.joints_with_key(key).next()
    }

    /// The joints with this [key](JointRef::key), sorted by their handles. The call looks through all joints.
    pub fn joints_with_key(&self, key: u64) -> impl Iterator<Item = JointRef<'_, S>> {
        self.joints().filter(move |joint| joint.key() == key)
    }

    /// The joints of a body, sorted by their keys, then by their handles.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn joints_of(&self, body: BodyId) -> Result<impl Iterator<Item = JointRef<'_, S>> + use<'_, S>, Error> {
        self.bodies.find(body)?;
        Ok(self.sorted_joints(self.joints.of(body.slot).collect()))
    }

    /// The number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    fn sorted_joints(&self, mut indices: Vec<usize>) -> impl Iterator<Item = JointRef<'_, S>> + use<'_, S> {
        indices.sort_unstable_by_key(|&index| (self.joints.def(index).key, self.joints.id(index)));
        indices.into_iter().map(|index| self.joint_at(index))
    }

    pub(super) fn check_new_joint(&self, def: &JointDef<S>) -> Result<(), Error> {
        def.check(&self.bodies)?;
        self.joints.check_room()
    }

    pub(super) fn check_joint_kind(&self, joint: JointId, kind: &JointKind<S>) -> Result<usize, Error> {
        let index = self.joints.find(joint)?;
        kind.check().map(|()| index)
    }

    /// The kind of a joint with another motor.
    pub(super) fn check_joint_motor(
        &self,
        joint: JointId,
        motor: Option<JointMotor<S>>,
    ) -> Result<(usize, JointKind<S>), Error> {
        let index = self.joints.find(joint)?;
        let kind = self.joints.def(index).kind.with_motor(motor).ok_or(Error::NoMotor { joint })?;
        kind.check().map(|()| (index, kind))
    }

    pub(super) fn check_turning_motor(&self, joint: JointId, motor: Option<JointMotor<S>>) -> Result<(), Error> {
        let (_, kind) = self.check_joint_motor(joint, motor)?;
        if kind.motor_turns() { Ok(()) } else { Err(Error::NoMotor { joint }) }
    }

    pub(super) fn set_turning_motor(&mut self, joint: JointId, motor: Option<JointMotor<S>>) -> Result<(), Error> {
        self.check_turning_motor(joint, motor)?;
        self.set_joint_motor(joint, motor)
    }

    pub(super) fn check_joint_break(&self, joint: JointId, break_force: Option<S>) -> Result<usize, Error> {
        let index = self.joints.find(joint)?;
        check_break(break_force).map(|()| index)
    }

    /// The angle of the frame of an end of a joint in the world, for its angle on the body or on the world.
    pub(super) fn joint_angle(&self, body: Option<BodyId>, angle: S) -> S::Angle {
        let dense = body.and_then(|body| self.bodies.find(body).ok());
        let stands = dense.map_or_else(S::Angle::default, |i| self.bodies.columns.motion.angle[i]);
        stands.turned(crate::scalar::Accumulator::from_scalar(angle))
    }

    /// The angles of the bodies of a joint.
    fn joint_angles(&self, index: usize) -> [Turn; 2] {
        self.joints.def(index).bodies().map(|body| self.joint_angle(body, S::ZERO).to_turn())
    }

    /// The angle of a joint without its whole turns.
    pub(crate) fn joint_turn(&self, index: usize) -> Turn {
        self.joints.link(index).angle(self.joint_angles(index))
    }

    /// The position of a joint around, with its whole turns, rad.
    pub(super) fn joint_position(&self, index: usize) -> Fx {
        self.joints.link(index).position(self.joint_angles(index), self.joint_states.list[index].turns)
    }

    /// Counts whole turns of the joints of a body that was turned the shorter way from this angle.
    pub(super) fn keep_turns(&mut self, body: BodyId, before: S::Angle) {
        let Ok(dense) = self.bodies.find(body) else { return };
        let turned =
            self.bodies.columns.motion.angle[dense].to_turn().to_bits().wrapping_sub(before.to_turn().to_bits());
        for index in self.joints.of(body.slot) {
            let link = self.joints.link(index);
            if link.counts_turns {
                let to = self.joint_turn(index);
                let is_first = link.ends[0].slot() == Some(body.slot);
                let change = if is_first { turned.wrapping_neg() } else { turned };
                self.joint_states.turn(index, Turn::from_bits(to.to_bits().wrapping_sub(change)), to);
                self.joint_states.engage(index, link.ratchet, to);
            }
        }
    }

    /// Wakes the dynamic bodies of a joint that comes, goes or changes, and lets them rest anew. What a static or kinematic body carries beside
    /// it does not feel that.
    fn touch_joined(&mut self, def: &JointDef<S>) -> Result<(), Error> {
        for body in def.bodies().into_iter().flatten() {
            if self.bodies.info(self.bodies.find(body)?).kind == BodyKind::Dynamic {
                self.touch(body, Change::VELOCITY)?;
            }
        }
        Ok(())
    }

    /// Drops the parts of the state of a joint that its kind no longer has.
    fn fit_joint_state(&mut self, index: usize) {
        let kind = self.joints.def(index).kind;
        let state = &mut self.joint_states.list[index];
        let active = kind.active_rows();
        let values = [0, 1, 2].map(|row| if active[row] { state.impulses[row] } else { 0 });
        state.set_impulses(Impulses { values, ..state.impulses() });
        if !kind.counts_turns() {
            state.turns = 0;
        }
    }

    /// Engages the tooth of a ratchet at the present angle.
    fn engage_ratchet(&mut self, index: usize) {
        let (ratchet, angle) = (self.joints.link(index).ratchet, self.joint_turn(index));
        self.joint_states.engage(index, ratchet, angle);
    }

    /// Changes the definition of a joint, but not its ends.
    fn redefine_joint(&mut self, index: usize, change: impl FnOnce(&mut JointDef<S>)) -> Result<(), Error> {
        let mut def = *self.joints.def(index);
        self.touch_joined(&def)?;
        change(&mut def);
        Arc::make_mut(&mut self.joints).replace(index, def);
        Ok(())
    }

    /// Ends the contacts of bodies that a joint keeps from touching each other.
    fn end_contacts_of(&mut self, def: &JointDef<S>) {
        if let ([Some(a), Some(b)], true, false) = (def.bodies(), def.enabled, def.collide_connected) {
            self.end_contacts_between(sorted(a, b));
        }
    }

    /// Drops the impulses of the joints of a body that can pull nothing: no body at their ends is dynamic, or one takes no part.
    pub(super) fn relax_joints(&mut self, body: BodyId) {
        let Self { bodies, joints, joint_states, .. } = self;
        let can_pull = |index: &usize| {
            let dense = || joints.def(*index).bodies().into_iter().flatten().filter_map(|body| bodies.find(body).ok());
            dense().any(|i| bodies.info(i).kind == BodyKind::Dynamic)
                && dense().all(|i| bodies.activity(i).takes_part())
        };
        joint_states.relax(joints.of(body.slot).filter(|index| !can_pull(index)));
    }
}
