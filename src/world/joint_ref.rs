//! Views of joints.

use core::fmt;

use super::World;
use crate::force::End;
use crate::fx::Fx;
use crate::joint::{JointDef, JointKind, Pulley, stop};
use crate::math::Vec2;
use crate::scalar::{Angle as _, FxWide, Scalar, Turn, Wide as _};
use crate::slots::{BodyId, JointId};
use crate::solve;

/// A read-only view of a joint. `{:?}` prints its definition.
///
/// Its values are functions of the state: a restored world reads the same.
///
/// ```
/// use umbra_physics::{BodyDef, JointDef, JointRef, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let sign = world.add_body(BodyDef { position: vec2(1, 4), ..BodyDef::dynamic() })?;
/// let chain = JointDef::between(&world, None, vec2(1, 6), sign, vec2(1, 5))?;
/// let chain = JointDef { key: 7, user_data: 8, ..chain };
/// let chain = world.add_joint(chain)?;
/// (0..120).for_each(|_| _ = world.step());
///
/// let look: JointRef = world.joint(chain)?;
/// assert_eq!((look.id(), look.key(), look.user_data(), look.bodies()), (chain, 7, 8, [None, Some(sign)]));
/// assert!(look.is_active() && !look.is_broken() && look.def().enabled && look.angle() == fx!(0));
/// let [above, below] = look.points();
/// assert_eq!(above, vec2(1, 6));
/// assert!((below.y - fx!(5)).abs() < fx!(0.001) && (look.length() - fx!(1)).abs() < fx!(0.001));
/// // It holds a kilogram.
/// assert!((look.force() - vec2(0, 10)).length() < fx!(0.01));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct JointRef<'a, S: Scalar = Fx> {
    pub(super) world: &'a World<S>,
    /// The index in the set of joints.
    pub(super) index: usize,
}

impl<'a, S: Scalar> JointRef<'a, S> {
    /// The handle.
    #[must_use]
    pub fn id(&self) -> JointId {
        self.world.joints.id(self.index)
    }

    /// The definition, with later changes. A joint that broke is still enabled there: see [`is_broken`](Self::is_broken).
    #[must_use]
    pub fn def(&self) -> &'a JointDef<S> {
        self.world.joints.def(self.index)
    }

    /// The key of the caller.
    #[must_use]
    pub fn key(&self) -> u64 {
        self.def().key
    }

    /// The data of the caller.
    #[must_use]
    pub fn user_data(&self) -> u64 {
        self.def().user_data
    }

    /// The bodies at its ends; `None` for an end on the world.
    #[must_use]
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        self.def().bodies()
    }

    /// Returns true if the joint broke, and was not repaired since with [`World::enable_joint`].
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.world.joint_states.list[self.index].is_broken
    }

    /// Returns true if steps keep what the joint keeps: it is enabled and not broken. (A body at its end may be disabled.)
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.def().enabled && !self.is_broken()
    }

    /// The two ends where they are in the world, m. *Error* as [`BodyRef::world_point`](super::BodyRef::world_point).
    #[must_use]
    pub fn points(&self) -> [Vec2<S>; 2] {
        self.def().ends.map(|end| match end {
            End::World(point) => point,
            End::Body(attachment) => {
                let body = self.world.body(attachment.body).ok();
                // Within 2^30 m and 2^12.5 m: it fits.
                body.and_then(|body| body.world_point(attachment.point)).unwrap_or_default()
            }
        })
    }

    /// The distance of the two ends, m: of a revolute joint the gap (of a prismatic joint and a wheel [`offset`](Self::offset) has it across the axis); of
    /// a pulley the length of its rope in use. *Error* 2 ulp, of a pulley each strand.
    #[must_use]
    pub fn length(&self) -> S {
        if let JointKind::Pulley(pulley) = self.def().kind {
            return S::from_fx(pulley.length_to(self.points()));
        }
        let [from, to] = self.points().map(|point| point.map(S::to_fx));
        S::from_fx(from.checked_distance(to).unwrap_or(Fx::MAX))
    }

    /// The angle from the frame of the first end to the frame of the second one, rad. *Error* 1 ulp.
    ///
    /// Of a gear it is the angle by which the wheel with more teeth is out of step, 0 where the teeth fit.
    /// A weld, and a revolute joint with limits, a spring or a ratchet, counts whole turns while it is active, up to ±2^15; the angle of all others
    /// is from −π to π, and 0 for a whole half turn.
    #[must_use]
    pub fn angle(&self) -> S {
        let def = self.def();
        if def.kind.counts_turns() || matches!(def.kind, JointKind::Gear(_)) {
            return S::from_fx(self.world.joint_position(self.index));
        }
        let [first, second] = self.bodies();
        let frames = [self.world.joint_angle(first, def.angles[0]), self.world.joint_angle(second, def.angles[1])];
        frames[0].way_to(frames[1]).to_scalar().unwrap_or(S::ZERO)
    }

    /// The angle of the tooth of a ratchet that is engaged, rad: the joint does not turn back beyond it. `None` without a ratchet. *Error* 1 ulp.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Mass, Revolute, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    /// let winch = world.add_body(BodyDef { mass, angular_velocity: fx!(2), ..BodyDef::dynamic() })?;
    /// let kind = JointKind::Revolute(Revolute { ratchet: Some(12), ..Revolute::default() });
    /// let axle = world.add_joint(JointDef { kind, ..JointDef::at(&world, None, winch, vec2(0, 0))? })?;
    /// (0..30).for_each(|_| _ = world.step());
    /// // One tooth of a twelfth of a turn is passed. It falls back to it, and no farther.
    /// world.set_angular_velocity(winch, fx!(-2))?;
    /// (0..60).for_each(|_| _ = world.step());
    /// let tooth = world.joint(axle)?.stop().expect("a ratchet");
    /// assert!((tooth - fx!(0.523598)).abs() < fx!(0.00001));
    /// assert!((world.joint(axle)?.angle() - tooth).abs() < fx!(0.0001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn stop(&self) -> Option<S> {
        let tooth = self.world.joint_states.list[self.index].tooth;
        self.def().kind.ratchet().map(|teeth| S::from_fx(stop(teeth, tooth)))
    }

    /// The angle of the frame of the first end in the world.
    fn axis_angle(&self) -> Turn {
        let def = self.def();
        self.world.joint_angle(def.bodies()[0], def.angles[0]).to_turn()
    }

    /// The place of the second end in the frame of the first end, m: of a prismatic or a wheel joint along and across the axis, of a motor joint
    /// what its spring pulls to its point at rest. *Error* 2 ulp, and 2^-31 of the distance.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef { position: vec2(3, 1), ..BodyDef::dynamic() })?;
    /// let hinge = JointDef { enabled: false, ..JointDef::between(&world, None, vec2(1, 1), body, vec2(3, 2))? };
    /// let hinge = world.add_joint(JointDef { kind: Default::default(), ..hinge })?;
    /// assert_eq!(world.joint(hinge)?.offset(), vec2(2, 1));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn offset(&self) -> Vec2<S> {
        let frame = solve::JointKind::Planar { angle: self.axis_angle() };
        let [x, y] = frame.ways(self.way()).map(S::from_fx);
        Vec2::new(x, y)
    }

    /// The way from the first end to the second one, in 2^-32 m.
    fn way(&self) -> [i128; 2] {
        let [from, to] = self.points().map(|point| point.map(|part| i128::from(part.to_fx().to_bits())));
        [to.x - from.x, to.y - from.y]
    }

    /// The way of the second end along the axis of a prismatic, a wheel or a motor joint, m; of the other kinds the [`length`](Self::length).
    /// *Error* 2 ulp.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Prismatic, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let slide = world.add_body(BodyDef { velocity: vec2(0, 3), ..BodyDef::dynamic() })?;
    /// let rail = JointDef::along(&world, None, slide, vec2(0, 0), vec2(0, -1))?;
    /// let rail = world.add_joint(JointDef { kind: JointKind::Prismatic(Prismatic::default()), ..rail })?;
    /// (0..60).for_each(|_| _ = world.step());
    /// assert!((world.joint(rail)?.translation() + fx!(3)).abs() < fx!(0.00001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn translation(&self) -> S {
        if matches!(self.def().kind, JointKind::Pulley(_)) {
            return self.length();
        }
        let kind = self.def().kind.for_solver(self.axis_angle());
        let [translation, _] = kind.ways(self.way());
        S::from_fx(translation)
    }

    /// The speed of [`angle`](Self::angle), rad/s. *Error* 1 ulp.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointRef, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let wheel = world.add_body(BodyDef { angular_velocity: fx!(3), ..BodyDef::dynamic() })?;
    /// let axle = world.add_joint(JointDef::at(&world, wheel, None, vec2(0, 0))?)?;
    /// let axle: JointRef = world.joint(axle)?;
    /// assert_eq!(axle.speed(), fx!(-3));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn speed(&self) -> S {
        let [first, second] = self.bodies().map(|body| {
            let body = body.and_then(|body| self.world.body(body).ok());
            body.map_or(Fx::ZERO, |body| body.angular_velocity().to_fx())
        });
        // Within ±2^20 rad/s: it fits.
        S::from_fx(second.saturating_sub(first))
    }

    /// The torque of limits, motor, friction and spring, or of a weld, on the second body at the end of the last step, N·m; the opposite torque
    /// acts on the first one. It is the mean over the last sub-step, without the moment of [`force`](Self::force);
    /// [`joint_loads`](crate::StepReport::joint_loads) have the mean over the step. *Error* 1 ulp.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Mass, Weld, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// // A shelf of 1 kg on a wall, half a metre from its middle.
    /// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    /// let shelf = world.add_body(BodyDef { position: vec2(fx!(0.5), 0), mass, ..BodyDef::dynamic() })?;
    /// let weld = JointDef { kind: JointKind::Weld(Weld::default()), ..JointDef::at(&world, None, shelf, vec2(0, 0))? };
    /// let weld = world.add_joint(weld)?;
    /// (0..30).for_each(|_| _ = world.step());
    /// assert!((world.joint(weld)?.torque() - fx!(5)).abs() < fx!(0.01));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn torque(&self) -> S {
        let def = &self.world.def;
        let [.., torque] = self.world.joint_states.list[self.index].forces(def.time_step, def.contacts.substeps);
        S::from_fx(self.world.joints.link(self.index).kind.torque_on_second(torque))
    }

    /// The force of the joint on the second end at the end of the last step, N, in the world's axes; the opposite force acts on the first end.
    /// It is the mean over the last sub-step; [`joint_loads`](crate::StepReport::joint_loads) have the mean over the step. *Error* 1 ulp, and for a distance
    /// joint or a pulley 2^-30 of it. Of a pulley the first end has another force: along its own part of the rope, by its own strands.
    #[must_use]
    pub fn force(&self) -> Vec2<S> {
        let def = &self.world.def;
        let state = &self.world.joint_states.list[self.index];
        let [first, second, _] = state.forces(def.time_step, def.contacts.substeps);
        let force = match self.def().kind {
            JointKind::Revolute(_) | JointKind::Weld(_) | JointKind::Gear(_) => Vec2::new(first, second),
            JointKind::Distance(_) => force_along(self.points(), first),
            JointKind::Pulley(Pulley { grounds: [_, ground], .. }) => {
                let [_, point] = self.points();
                force_along([ground, point], self.world.joints.link(self.index).kind.rope_force_on_second(first))
            }
            JointKind::Prismatic(_) | JointKind::Wheel(_) | JointKind::Motor(_) => {
                let force = self.axis_angle().rotate(Vec2::new(first, second));
                let part = |component: FxWide| component.to_scalar().unwrap_or(Fx::MAX);
                force.map_or(Vec2::ZERO, |force| force.map(part))
            }
        };
        force.map(S::from_fx)
    }
}

/// A force along the line between two points.
fn force_along<S: Scalar>(points: [Vec2<S>; 2], force: Fx) -> Vec2 {
    let [from, to] = points.map(|point| point.map(S::to_fx));
    let direction = to.checked_sub(from).and_then(|offset| offset.normalize()).unwrap_or_default();
    let part = |component: Fx| component.saturating_mul(force);
    direction.map(part)
}

impl<S: Scalar> fmt::Debug for JointRef<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JointRef")
            .field("id", &self.id())
            .field("def", self.def())
            .field("is_broken", &self.is_broken())
            .finish()
    }
}
