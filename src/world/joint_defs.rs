//! Definitions of joints from points of a world.

use super::World;
use crate::contact::spring_mass;
use crate::error::{Error, Quantity};
use crate::force::{Attachment, End};
use crate::fx::Fx;
use crate::joint::{Distance, Gear, JointDef, JointKind, Link, Prismatic, Pulley, Revolute};
use crate::kernel::trig::atan2_turn;
use crate::math::Vec2;
use crate::scalar::{Angle as _, Factor as _, Scalar, Turn, Wide as _};
use crate::slots::BodyId;

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

    /// A rope from points of two bodies over two points of the world, all given where they are in the world, m, with these strands on both sides:
    /// [`Pulley`]. It is as long as they are apart, and its bodies touch each other.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::OutOfRange`] with [`Quantity::JointPoint`] for a point too far from its body, [`Quantity::Strands`], or
    /// [`Quantity::JointLength`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, Pulley, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [hook, load] = [0, 4].map(|x| world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic() }));
    /// let (bodies, grounds) = ([hook?, load?], [vec2(0, 3), vec2(4, 5)]);
    /// let tackle = JointDef::pulley(&world, bodies, [vec2(0, 0), vec2(4, 1)], grounds, [1, 2])?;
    /// assert_eq!(tackle.kind, JointKind::Pulley(Pulley { grounds, strands: [1, 2], length: fx!(11) }));
    /// assert!(tackle.collide_connected);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn pulley(
        world: &World<S>,
        bodies: [BodyId; 2],
        points: [Vec2<S>; 2],
        grounds: [Vec2<S>; 2],
        strands: [u8; 2],
    ) -> Result<Self, Error> {
        let ends = [end_at(world, Some(bodies[0]), points[0])?, end_at(world, Some(bodies[1]), points[1])?];
        let pulley = Pulley { grounds, strands, length: S::ZERO };
        let kind = JointKind::Pulley(Pulley { length: S::from_fx(pulley.length_to(points)), ..pulley });
        kind.check()?;
        Ok(Self { collide_connected: true, ..Self::new(ends, kind) })
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

    /// The effective mass that a spring of the joint meets, as the bodies stand: m of its stiffness m·(2πf)². Of a revolute joint, a weld and a gear
    /// it is the moment of inertia about the joint, kg·m², else the mass along the axis or the line, kg; of a motor joint the mass of its
    /// [`PlanarSpring`](crate::PlanarSpring). The `angular_spring` of a motor joint has 1/(1/I₁ + 1/I₂).
    ///
    /// It is the mass that steps take: with arms, locks, and the kind of the joint, so set the kind first. *Error* 2^-28 relative.
    ///
    /// # Errors
    /// As [`World::add_joint`]; [`Error::NothingToMove`] also where no body can turn or be moved so; [`Error::OutOfRange`] with
    /// [`Quantity::JointLength`] also for a distance joint with both ends at one point, as its line has no direction.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, JointDef, JointKind, JointSpring, Mass, Weld, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) };
    /// let board = world.add_body(BodyDef { position: vec2(1, 0), mass, ..BodyDef::dynamic() })?;
    /// let weld = JointDef { kind: JointKind::Weld(Weld::default()), ..JointDef::at(&world, None, board, vec2(0, 0))? };
    /// let inertia = weld.effective_mass(&world)?;
    /// assert_eq!(inertia, fx!(2.5).into()); // 0.5 + 2·1²
    /// // A diving board of 1,000 N·m/rad with a damper of 50 N·m·s/rad.
    /// let spring = Some(JointSpring::with_stiffness(fx!(1000), fx!(50), inertia)?);
    /// let weld = world.add_joint(JointDef { kind: JointKind::Weld(Weld { spring }), ..weld })?;
    /// (0..300).for_each(|_| _ = world.step());
    /// assert!((world.joint(weld)?.angle() + fx!(0.02)).abs() < fx!(0.0001)); // 20 N·m
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn effective_mass(&self, world: &World<S>) -> Result<S::Factor, Error> {
        self.check(&world.bodies)?;
        let mass = spring_mass(&world.bodies, &Link::new(self)).ok_or(match self.kind {
            JointKind::Distance(_) => Error::OutOfRange { quantity: Quantity::JointLength },
            _ => Error::NothingToMove,
        })?;
        let (mantissa, shift) = mass.parts();
        Ok(S::Factor::from_binary(mantissa.into(), shift))
    }
}

/// The end of a joint at a point of the world, on a body or on the world.
fn end_at<S: Scalar>(world: &World<S>, body: Option<BodyId>, point: Vec2<S>) -> Result<End<S>, Error> {
    let Some(body) = body else { return Ok(End::World(point)) };
    let too_far = Error::OutOfRange { quantity: Quantity::JointPoint };
    let point = world.body(body)?.local_point(point).ok_or(too_far)?;
    Ok(End::Body(Attachment { body, point }))
}
