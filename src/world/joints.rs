//! Adding, removing and changing joints.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Command, JointRef, World};
use crate::body::{BodyKind, Change};
use crate::contact::sorted;
use crate::error::{Error, Quantity};
use crate::force::{Attachment, End};
use crate::fx::Fx;
use crate::joint::{Distance, Gear, JointDef, JointKind, JointMotor, Prismatic, Revolute, check_break_force};
use crate::kernel::trig::atan2_turn;
use crate::math::Vec2;
use crate::scalar::{Angle as _, Scalar, Turn, Wide as _};
use crate::slots::{BodyId, JointId};
use crate::solve::{ContactSolver, Impulses};

impl<S: Scalar> JointDef<S> {
    /// A revolute joint of two bodies at a point of the world, m; `None` is the world. The angle of the joint is 0 as they stand.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::JointPoint`] for a point too far from a body.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let arm = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.2), 2)?);
    /// let [upper, lower] = [-1, -3].map(|y| world.add_body(BodyDef { position: vec2(0, y), ..arm.clone() }));
    /// let (upper, lower) = (upper?, lower?);
    /// let shoulder = JointDef::at(&world, None, upper, vec2(0, 0))?;
    /// let elbow = JointDef::at(&world, upper, lower, vec2(0, -2))?;
    /// world.add_joint(shoulder)?;
    /// let elbow = world.add_joint(elbow)?;
    /// world.set_velocity(lower, vec2(3, 0))?;
    /// (0..60).for_each(|_| _ = world.step());
    /// let elbow = world.joint(elbow)?;
    /// assert!(elbow.length() < fx!(0.01) && elbow.angle() != fx!(0));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn at(
        world: &World<S>,
        first: impl Into<Option<BodyId>>,
        second: impl Into<Option<BodyId>>,
        point: Vec2<S>,
    ) -> Result<Self, Error> {
        let bodies = [first.into(), second.into()];
        let ends = [end_at(world, bodies[0], point)?, end_at(world, bodies[1], point)?];
        // The frame of the first end is along its axes, and the frame of the second end stands alike.
        let [first, second] = [world.joint_angle(bodies[0], S::ZERO), world.joint_angle(bodies[1], S::ZERO)];
        let angle = second.way_to(first).to_scalar().unwrap_or(S::ZERO);
        Ok(Self { angles: [S::ZERO, angle], ..Self::new(ends, JointKind::Revolute(Revolute::default())) })
    }

    /// A prismatic joint of two bodies at a point of the world, m, along a direction in the world; `None` is the world. The axis turns with the
    /// first body. The translation and the angle of the joint are 0 as they stand.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::JointPoint`] for a point too far from a body.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Prismatic, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let sled = world.add_body(BodyDef::dynamic())?;
    /// // A rail that falls by one to one.
    /// let rail = JointDef::along(&world, None, sled, vec2(0, 0), vec2(1, -1))?;
    /// let rail = world.add_joint(JointDef { kind: JointKind::Prismatic(Prismatic::default()), ..rail })?;
    /// (0..60).for_each(|_| _ = world.step());
    /// let velocity = world.body(sled)?.velocity();
    /// assert!((velocity - vec2(5, -5)).length() < fx!(0.0001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn along(
        world: &World<S>,
        first: impl Into<Option<BodyId>>,
        second: impl Into<Option<BodyId>>,
        point: Vec2<S>,
        direction: Vec2<S>,
    ) -> Result<Self, Error> {
        let first = first.into();
        let def = Self::at(world, first, second, point)?;
        let Vec2 { x, y } = direction.map(|part| part.to_fx().to_bits());
        let axis = S::Angle::from_turn(Turn::from_bits(atan2_turn(y, x)));
        let angle = world.joint_angle(first, S::ZERO).way_to(axis).to_scalar().unwrap_or(S::ZERO);
        let angles = [angle, def.angles[1] + angle];
        Ok(Self { angles, kind: JointKind::Prismatic(Prismatic::default()), ..def })
    }

    /// Two gears with these numbers of teeth, whose teeth fit as the bodies stand: [`Gear`].
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::Teeth`] for teeth out of range.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Gear, JointDef, JointKind, World, WorldDef, fx};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [wheel, ring] = [fx!(1), fx!(2)].map(|angle| world.add_body(BodyDef { angle, ..BodyDef::dynamic() }));
    /// let inside = JointDef::gear(&world, wheel?, ring?, [20, -60])?;
    /// assert_eq!(inside.kind, JointKind::Gear(Gear { teeth: [20, -60] }));
    /// let inside = world.add_joint(inside)?;
    /// assert!(world.joint(inside)?.angle().abs() < fx!(0.000001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn gear(world: &World<S>, first: BodyId, second: BodyId, teeth: [i16; 2]) -> Result<Self, Error> {
        let kind = JointKind::Gear(Gear { teeth });
        kind.check()?;
        world.bodies.find(first)?;
        world.bodies.find(second)?;
        let angles = [first, second].map(|body| world.joint_angle(Some(body), S::ZERO).to_turn());
        let step = kind.for_solver(angles[0]).angle(angles).to_bits() as i64;
        // The second frame takes the teeth that are out of step: below half a tooth.
        let turn = Turn::from_bits((step / -i64::from(teeth[1])) as u64);
        let angle = S::Angle::default().way_to(S::Angle::from_turn(turn)).to_scalar().unwrap_or(S::ZERO);
        let ends = [first, second].map(|body| End::Body(Attachment { body, point: Vec2::ZERO }));
        Ok(Self { angles: [S::ZERO, angle], ..Self::new(ends, kind) })
    }

    /// A rigid rod between points of two bodies, given where they are in the world, m; `None` is the world. It is as long as they are apart.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::JointPoint`] for a point too far from its body.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Distance, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [a, b] = [0, 5].map(|x| world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic() }));
    /// let (a, b) = (a?, b?);
    /// let rod = JointDef::between(&world, a, vec2(1, 0), b, vec2(5, 3))?;
    /// assert_eq!(rod.kind, JointKind::Distance(Distance::rod(fx!(5))));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn between(
        world: &World<S>,
        first: impl Into<Option<BodyId>>,
        from: Vec2<S>,
        second: impl Into<Option<BodyId>>,
        to: Vec2<S>,
    ) -> Result<Self, Error> {
        let ends = [end_at(world, first.into(), from)?, end_at(world, second.into(), to)?];
        let length = from.map(S::to_fx).checked_distance(to.map(S::to_fx)).unwrap_or(Fx::MAX);
        Ok(Self::new(ends, JointKind::Distance(Distance::rod(S::from_fx(length)))))
    }
}

/// The command that sets the motor of a joint, for its kind with the motor. Images of motors that turn are others than images of motors that push,
/// which are told by their kind.
fn motor_command<S: Scalar>(joint: JointId, motor: Option<JointMotor<S>>, kind: JointKind<S>) -> Command<S> {
    if kind.motor_turns() { Command::SetJointMotor { joint, motor } } else { Command::SetJointKind { joint, kind } }
}

/// The end of a joint at a point of the world, on a body or on the world.
fn end_at<S: Scalar>(world: &World<S>, body: Option<BodyId>, point: Vec2<S>) -> Result<End<S>, Error> {
    let Some(body) = body else { return Ok(End::World(point)) };
    let too_far = Error::OutOfRange { quantity: Quantity::JointPoint };
    let point = world.body(body)?.local_point(point).ok_or(too_far)?;
    Ok(End::Body(Attachment { body, point }))
}

impl<S: Scalar> World<S> {
    /// Adds a joint, and wakes its bodies. Contacts between them end, unless the joint has
    /// [`collide_connected`](JointDef::collide_connected).
    ///
    /// Joined bodies fall asleep and wake together. A joint to a disabled or quarantined body does nothing until the body takes part again, and
    /// then starts without an impulse. [Dominance](crate::BodyDef::dominance) is for contacts alone: a joint pulls both bodies.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::SameBody`]; [`Error::NothingToMove`] if neither end is on a dynamic body; [`Error::OutOfRange`] with
    /// [`Quantity::Position`] for a point of the world, [`Quantity::JointPoint`] for a point of a body, [`Quantity::Angle`] for a float that is
    /// no number, [`Quantity::JointLength`] or [`Quantity::BreakForce`]; [`Error::Full`]; [`Error::FloatJoint`] in a world of floats.
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
    pub fn add_joint(&mut self, def: JointDef<S>) -> Result<JointId, Error> {
        S::add_joint(self, def)
    }

    pub(crate) fn add_joint_inner(&mut self, def: JointDef<S>) -> Result<JointId, Error> {
        self.check_new_joint(&def)?;
        self.touch_joined(&def)?;
        self.journal.note(|| Command::AddJoint(def));
        let id = Arc::make_mut(&mut self.joints).insert(def, &mut self.joint_states);
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
    /// [`Error::NoSuchJoint`]; [`Error::OutOfRange`] with the quantity of the value that is out of range, such as [`Quantity::JointLimits`].
    pub fn set_joint_kind(&mut self, joint: JointId, kind: JointKind<S>) -> Result<(), Error> {
        let index = self.check_joint_kind(joint, &kind)?;
        let old = self.joints.def(index).kind;
        self.redefine_joint(index, |def| def.kind = kind)?;
        self.journal.note(|| Command::SetJointKind { joint, kind });
        if !kind.has_rows_of(&old) {
            self.joint_states.list[index].clear_impulses();
        }
        self.fit_joint_state(index);
        Ok(())
    }

    /// Sets the motor of a joint, `None` for no motor; wakes its bodies. The impulse that the joint starts from stays.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`]; [`Error::NoMotor`] for a weld; [`Error::OutOfRange`] with [`Quantity::MotorSpeed`] or
    /// [`Quantity::JointForce`].
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
    /// [`Error::NoSuchJoint`]; [`Error::OutOfRange`] with [`Quantity::BreakForce`].
    pub fn set_joint_break(&mut self, joint: JointId, force: Option<S>) -> Result<(), Error> {
        let index = self.check_joint_break(joint, force)?;
        self.redefine_joint(index, |def| def.break_force = force)?;
        self.journal.note(|| Command::SetJointBreak { joint, force });
        Ok(())
    }

    /// Enables or disables a joint, and wakes its bodies. A disabled one does nothing; its bodies may touch each other. An enabled one starts
    /// without an impulse if it was disabled; a broken one is repaired by either call.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`].
    pub fn enable_joint(&mut self, joint: JointId, enabled: bool) -> Result<(), Error> {
        let index = self.joints.find(joint)?;
        self.redefine_joint(index, |def| def.enabled = enabled)?;
        self.journal.note(|| Command::EnableJoint { joint, enabled });
        let state = &mut self.joint_states.list[index];
        state.is_broken = false;
        if enabled {
            let def = *self.joints.def(index);
            self.end_contacts_of(&def);
        } else {
            state.clear_impulses();
        }
        Ok(())
    }

    /// A view of a joint.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`].
    pub fn joint(&self, joint: JointId) -> Result<JointRef<'_, S>, Error> {
        Ok(JointRef { world: self, index: self.joints.find(joint)? })
    }

    /// All joints, sorted by their keys, then by their handles.
    pub fn joints(&self) -> impl Iterator<Item = JointRef<'_, S>> {
        self.sorted_joints(self.joints.indices().collect())
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
        indices.into_iter().map(|index| JointRef { world: self, index })
    }

    pub(super) fn check_new_joint(&self, def: &JointDef<S>) -> Result<(), Error> {
        def.check(&self.bodies)?;
        if !<S::Solver as ContactSolver>::SOLVES_JOINTS {
            return Err(Error::FloatJoint);
        }
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

    pub(super) fn check_joint_break(&self, joint: JointId, force: Option<S>) -> Result<usize, Error> {
        let index = self.joints.find(joint)?;
        check_break_force(force).map(|()| index)
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
