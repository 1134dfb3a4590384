//! Views of bodies.

use super::{Stance, World};
use crate::body::{Activity, BodyInfo, BodyKind, Damping, Key, Locks, Mass};
use crate::error::Error;
use crate::force::velocity_at;
use crate::fx::Fx;
use crate::math::{Rot, Vec2};
use crate::scalar::{Accumulator, Angle, Factor, Scalar, Wide};
use crate::slots::BodyId;

/// A read-only view of a body. `{:?}` prints its state.
///
/// ```
/// use umbra_physics::{Activity, BodyDef, BodyKind, Mass, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let shape = Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)])?;
/// let body = world.add_body(BodyDef {
///     mass: Mass::Kilograms(fx!(4)),
///     velocity: vec2(6, 0),
///     ..BodyDef::dynamic().with_collider(shape)
/// })?;
/// world.step();
/// world.apply_force(body, vec2(5, 0))?;
///
/// let look = world.body(body)?;
/// assert_eq!(look.position(), vec2(fx!(0.1), 0)); // of the centre of mass
/// // With what is carried below an ulp: all digits of 0.1 as far as 64 bits of a factor go.
/// assert!(look.position_exact().x.to_string().starts_with("0.10000000000000000000"));
/// assert_eq!((look.velocity(), look.velocity_exact().x.to_string()), (vec2(6, 0), "6".into()));
/// assert_eq!(
///     (look.angle_exact().to_string(), look.angular_velocity_exact().to_string()),
///     ("0".into(), "0".into())
/// );
///
/// assert_eq!((look.kind(), look.activity(), look.key()), (BodyKind::Dynamic, Activity::Awake, 0));
/// assert_eq!(format!("a {} body, {}", look.kind(), look.activity()), "a dynamic body, awake");
/// assert!(format!("{look:?}").contains("inertia: Some(4)"));
/// assert_eq!((look.mass(), look.inverse_mass().to_scalar()), (Some(fx!(4)), Some(fx!(0.25))));
/// assert_eq!(look.inertia().and_then(|inertia| inertia.to_scalar()), Some(fx!(4)));
/// assert_eq!(look.inverse_inertia().to_scalar(), Some(fx!(0.25)));
/// assert_eq!((look.gravity_scale(), look.linear_damping(), look.angular_damping()), (fx!(1), None, None));
/// assert_eq!(look.applied_force().map(|force| force.x.to_string()), Some("5".into()));
/// assert_eq!(look.applied_torque().map(|torque| torque.to_string()), Some("0".into()));
/// assert_eq!((world.body_count(), world.moving_count()), (1, 1));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct BodyRef<'a, S: Scalar = Fx> {
    pub(super) world: &'a World<S>,
    pub(super) dense: usize,
}

impl<'a, S: Scalar> BodyRef<'a, S> {
    /// The world of the body, and its index in the columns.
    pub(crate) fn parts(&self) -> (&'a World<S>, usize) {
        (self.world, self.dense)
    }

    /// Where the next step takes it, if nothing but its target or its velocities acts on it.
    pub(crate) fn stance_after_step(&self) -> Stance<S> {
        self.world.stance_after_step(self.dense)
    }

    fn info(&self) -> &'a BodyInfo<S> {
        self.world.bodies.info(self.dense)
    }

    fn factor_key(&self) -> &'a Key<S> {
        &self.world.factor_table.rows()[self.world.bodies.columns.factors[self.dense] as usize].key
    }

    /// The handle.
    #[must_use]
    pub fn id(&self) -> BodyId {
        self.world.bodies.id(self.dense)
    }

    /// The position of the centre of mass, m: the exact position rounded to nearest, ties to even.
    #[doc(alias("translation", "center_of_mass"))]
    #[must_use]
    pub fn position(&self) -> Vec2<S> {
        self.position_exact().map(Accumulator::value)
    }

    /// The position of the centre of mass with the remainders that are carried from step to step.
    #[must_use]
    pub fn position_exact(&self) -> Vec2<S::Accumulator> {
        self.world.bodies.columns.motion.position.get(self.dense)
    }

    /// The angle, rad in [0, 2π).
    #[must_use]
    pub fn angle(&self) -> S {
        self.angle_exact().radians()
    }

    /// The angle in the form in which the world stores it.
    #[must_use]
    pub fn angle_exact(&self) -> S::Angle {
        self.world.bodies.columns.motion.angle[self.dense]
    }

    /// The rotation by the angle; computed by each call.
    #[must_use]
    pub fn rotation(&self) -> Rot<S> {
        Rot::from_angle(self.angle_exact())
    }

    /// The velocity of the centre of mass, m/s.
    #[doc(alias("linvel", "linear_velocity"))]
    #[must_use]
    pub fn velocity(&self) -> Vec2<S> {
        self.velocity_exact().map(Accumulator::value)
    }

    /// The velocity with the remainders that are carried from step to step.
    #[must_use]
    pub fn velocity_exact(&self) -> Vec2<S::Accumulator> {
        self.world.bodies.columns.motion.velocity.get(self.dense)
    }

    /// The angular velocity, rad/s.
    #[doc(alias = "angvel")]
    #[must_use]
    pub fn angular_velocity(&self) -> S {
        self.angular_velocity_exact().value()
    }

    /// The angular velocity with the remainder that is carried from step to step.
    #[must_use]
    pub fn angular_velocity_exact(&self) -> S::Accumulator {
        self.world.bodies.columns.motion.angular_velocity[self.dense]
    }

    /// The velocity of a point of the world that moves with it, m/s: v + ω × (point − x) of the public values, exact and
    /// rounded once, to nearest, ties to even; `None` if a component does not fit. *Error* ½ ulp.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let wheel = world.add_body(BodyDef { position: vec2(5, 1), angular_velocity: fx!(2), ..BodyDef::dynamic() })?;
    /// let wheel = world.body(wheel)?;
    /// // Its top, in its own axes and in the world's.
    /// assert_eq!(wheel.world_point(vec2(0, 3)), Some(vec2(5, 4)));
    /// assert_eq!(wheel.local_point(vec2(5, 4)), Some(vec2(0, 3)));
    /// assert_eq!((wheel.world_vector(vec2(1, 0)), wheel.local_vector(vec2(1, 0))), (Some(vec2(1, 0)), Some(vec2(1, 0))));
    /// assert_eq!(wheel.velocity_at(vec2(5, 4)), Some(vec2(-6, 0)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn velocity_at(&self, point: Vec2<S>) -> Option<Vec2<S>> {
        let centre = self.position();
        let arm = Vec2::new(point.x.offset(centre.x), point.y.offset(centre.y));
        velocity_at(self.velocity(), self.angular_velocity(), arm)?.try_map(S::Wide::to_scalar)
    }

    /// The position in the world of a point of the body, m; `local` is in the body's axes, from its centre of mass. `None` if a
    /// component, or one of the vector from the centre, does not fit. *Error* ½ ulp, and 2^-60 of the distance from the centre.
    #[must_use]
    pub fn world_point(&self, local: Vec2<S>) -> Option<Vec2<S>> {
        self.world.stance(self.dense).world_point(local)
    }

    /// The position of a point of the world in the body's axes, from its centre of mass, m. `None` if a component, or one of
    /// the vector from the centre, does not fit. *Error* ½ ulp, and 2^-60 of the distance from the centre.
    #[must_use]
    pub fn local_point(&self, world: Vec2<S>) -> Option<Vec2<S>> {
        self.world.stance(self.dense).local_point(world)
    }

    /// A vector of the body's axes in the world's axes; `None` if a component does not fit. *Error* ½ ulp, and 2^-60 of its
    /// length.
    #[must_use]
    pub fn world_vector(&self, local: Vec2<S>) -> Option<Vec2<S>> {
        self.angle_exact().rotate(local)?.try_map(S::Wide::to_scalar)
    }

    /// A vector of the world's axes in the body's axes; `None` if a component does not fit, or `y` has no opposite. *Error* ½ ulp,
    /// and 2^-60 of its length.
    #[must_use]
    pub fn local_vector(&self, world: Vec2<S>) -> Option<Vec2<S>> {
        self.world.stance(self.dense).local_vector(world)
    }

    /// The body's share of the world's [`kinetic_energy`](World::kinetic_energy), J: zero unless it is dynamic and simulated.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Mass, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mass = Mass::Explicit { mass: fx!(0.5), inertia: fx!(0.25) };
    /// let velocity = vec2(3, fx!(0.1));
    /// let body = world.add_body(BodyDef { mass, velocity, position: vec2(0, 2), ..BodyDef::dynamic() })?;
    /// let body = world.body(body)?;
    /// assert_eq!(body.mass_def(), mass);
    /// // Exact decimals of what is computed: 0.1 is the multiple of 2^-32 nearest to it.
    /// assert_eq!(body.momentum().x.to_string(), "1.5");
    /// assert_eq!(body.momentum().y.to_string(), "0.05000000004656612873077392578125");
    /// assert_eq!((body.angular_momentum()?.to_string(), body.kinetic_energy()?.to_string().get(..8)), ("-3".into(), Some("2.252500")));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`](crate::Quantity::Total) beyond 2^63 J.
    pub fn kinetic_energy(&self) -> Result<S::Wide, Error> {
        self.world.kinetic_energy_of(self.dense)
    }

    /// The body's share of the world's [`momentum`](World::momentum), kg·m/s, exact for the public velocity: zero unless it
    /// is dynamic and simulated.
    #[must_use]
    pub fn momentum(&self) -> Vec2<S::Wide> {
        self.world.momentum_of(self.dense)
    }

    /// The body's share of the world's [`angular_momentum`](World::angular_momentum) about the origin, kg·m²/s: zero unless it
    /// is dynamic and simulated.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`](crate::Quantity::Total) beyond 2^63.
    pub fn angular_momentum(&self) -> Result<S::Wide, Error> {
        self.world.angular_momentum_of(self.dense)
    }

    /// The kind: static, kinematic or dynamic.
    #[must_use]
    pub fn kind(&self) -> BodyKind {
        self.info().kind
    }

    /// The activity: awake, asleep, quarantined or disabled.
    #[doc(alias("is_awake", "is_sleeping", "IsAwake"))]
    #[must_use]
    pub fn activity(&self) -> Activity {
        self.world.bodies.activity(self.dense)
    }

    /// The mass, kg; `None` unless it is dynamic.
    #[must_use]
    pub fn mass(&self) -> Option<S> {
        (self.kind() == BodyKind::Dynamic).then_some(self.info().kilograms())
    }

    /// The mass as it was given, to the bit, also while the body is not dynamic.
    #[must_use]
    pub fn mass_def(&self) -> Mass<S> {
        self.info().mass
    }

    /// The moment of inertia, kg·m², regardless of locks; `None` if it is infinite, or the body is not dynamic. *Error* 2^-58
    /// relative.
    #[must_use]
    pub fn inertia(&self) -> Option<S::Factor> {
        let inertia = self.info().inertia();
        (!inertia.is_zero()).then_some(inertia)
    }

    /// The inverse mass 1/m, 1/kg, regardless of locks; zero for a body that no force moves. *Error* 2^-64 relative.
    #[must_use]
    pub fn inverse_mass(&self) -> S::Factor {
        self.world.bodies.mass(self.dense).inverse_mass
    }

    /// The inverse moment of inertia 1/I, 1/(kg·m²); zero for a body that no torque turns, or whose rotation is locked. *Error* 2^-58
    /// relative.
    #[must_use]
    pub fn inverse_inertia(&self) -> S::Factor {
        self.world.bodies.mass(self.dense).inverse_inertia
    }

    /// The factor by which the world's gravity acts on the body.
    #[must_use]
    pub fn gravity_scale(&self) -> S {
        self.factor_key().gravity_scale
    }

    /// The body's own linear damping; `None` if the world's applies.
    #[must_use]
    pub fn linear_damping(&self) -> Option<Damping<S>> {
        self.factor_key().linear
    }

    /// The body's own angular damping; `None` if the world's applies.
    #[must_use]
    pub fn angular_damping(&self) -> Option<Damping<S>> {
        self.factor_key().angular
    }

    /// The largest speed after a step, m/s; `None` if there is no cap.
    #[must_use]
    pub fn max_speed(&self) -> Option<S> {
        self.factor_key().most[0]
    }

    /// The largest angular speed after a step, rad/s; `None` if there is no cap.
    #[must_use]
    pub fn max_angular_speed(&self) -> Option<S> {
        self.factor_key().most[1]
    }

    /// The locked axes: the components of the velocity that are zero and stay zero.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Locks, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let lift = world.add_body(BodyDef { velocity: vec2(3, 4), ..BodyDef::dynamic() })?;
    /// world.set_locks(lift, Locks { x: true, ..Locks::NONE })?;
    /// world.set_max_speeds(lift, Some(fx!(2)), Some(fx!(1)))?;
    /// world.step();
    /// let lift = world.body(lift)?;
    /// assert_eq!((lift.locks().x, lift.max_speed(), lift.max_angular_speed()), (true, Some(fx!(2)), Some(fx!(1))));
    /// assert_eq!(lift.velocity(), vec2(0, 2));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn locks(&self) -> Locks {
        self.world.bodies.mass(self.dense).locks
    }

    /// The dominance: contacts of two dynamic bodies do not move the one with the higher number.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef { dominance: 2, ..BodyDef::dynamic() })?;
    /// let body = world.body(body)?;
    /// assert_eq!(body.dominance(), 2);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn dominance(&self) -> i32 {
        self.info().dominance
    }

    /// Returns true for a [bullet](crate::BodyDef::bullet).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef { bullet: true, ..BodyDef::dynamic() })?;
    /// let body = world.body(body)?;
    /// assert!(body.is_bullet());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn is_bullet(&self) -> bool {
        self.info().is_bullet
    }

    /// The groups of the body, one a bit.
    #[must_use]
    pub fn force_groups(&self) -> u32 {
        self.info().force_groups
    }

    /// The caller's key.
    #[must_use]
    pub fn key(&self) -> u64 {
        self.info().key
    }

    /// The caller's data.
    #[must_use]
    pub fn user_data(&self) -> u64 {
        self.info().user_data
    }

    /// The target that the next step [moves](World::move_to) the body to: position, m, and angle.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let door = world.add_body(BodyDef::kinematic())?;
    /// world.move_to(door, vec2(fx!(0.1), 0), fx!(0.5))?;
    /// assert_eq!(world.body(door)?.goal().map(|(position, _)| position), Some(vec2(fx!(0.1), 0)));
    /// world.step();
    /// assert_eq!((world.body(door)?.position(), world.body(door)?.angle()), (vec2(fx!(0.1), 0), fx!(0.5)));
    /// assert_eq!(world.body(door)?.goal(), None);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn goal(&self) -> Option<(Vec2<S>, S::Angle)> {
        self.world.targets.of(self.id()).and_then(|target| target.goal).map(|goal| (goal.position, goal.angle))
    }

    /// The sum of the forces applied since the last step, N; `None` if it does not fit.
    #[must_use]
    pub fn applied_force(&self) -> Option<Vec2<S::Wide>> {
        self.world.applied.row(self.id()).map_or(Some(Vec2::default()), |row| row.force())
    }

    /// The sum of the torques applied since the last step, N·m; `None` if it does not fit.
    #[must_use]
    pub fn applied_torque(&self) -> Option<S::Wide> {
        self.world.applied.row(self.id()).map_or(Some(S::Wide::default()), |row| row.torque())
    }
}
