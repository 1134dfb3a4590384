//! Energy and momentum of a world. *Error* of each term 2^-61 relative, of springs of joints what [`World::potential_energy`] says, then
//! rounded to 2^-64 of its unit; the sums are exact.

use super::World;
use crate::body::BodyKind;
use crate::contact::spring_energies;
use crate::error::{Error, Quantity};
use crate::force::{Attachment, Directions, End, FieldKind, Scene};
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar, SpringConstants, Sum, Wide};

fn total<S: Scalar>(sum: Option<S::Sum>) -> Result<S::Wide, Error> {
    sum.and_then(Sum::total).ok_or(Error::OutOfRange { quantity: Quantity::Total })
}

impl<S: Scalar> World<S> {
    /// The kinetic energy of the dynamic bodies, ½mv² + ½Iω², J.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    pub fn kinetic_energy(&self) -> Result<S::Wide, Error> {
        S::kinetic_energy(self)
    }

    pub(crate) fn kinetic_energy_inner(&self) -> Result<S::Wide, Error> {
        let mut sum = S::Sum::default();
        total::<S>(self.add_kinetic(&mut sum).map(|()| sum))
    }

    /// The potential energy of the dynamic bodies in gravity (zero at y = 0 and x = 0), attractors (zero far away),
    /// springs, and springs of joints, J. Zones, thrusts and custom forces have none. An attractor on a dynamic body counts half: two
    /// bodies that attract each other by G·m have two attractors.
    ///
    /// The spring of a joint holds ½·k·x², for its stretch x and the stiffness k = m·(2πf)² of its frequency f. x is the distance of
    /// [`JointRef::angle`](crate::JointRef::angle), [`length`](crate::JointRef::length), [`translation`](crate::JointRef::translation) or
    /// [`offset`](crate::JointRef::offset) from its rest, and m the effective mass of both bodies along the joint or around it, kg or kg·m², where
    /// they are now. With a [`max_force`](crate::JointSpring::max_force) F (else 2^31 N or N·m) it holds ½·F²/k + F·(x − F/k) beyond x = F/k: the work that it
    /// takes to stretch it. Nothing is held by a joint that is disabled or broken or of which a body is disabled or quarantined, by a rod that
    /// limits keep rigid, and by a distance joint whose ends are at one point: its spring has no direction.
    ///
    /// *Error* of x 2 ulp, where the ends are within 2^30 m along x and y, and of m 2^-28 relative: the solver has directions in 2^-30.
    ///
    /// Where no damper, limit, motor or friction is at work and m stays as it is (about a pin at a centre of mass, on a rail on which bodies
    /// do not turn, between centres of mass), steps keep the mean of the energy, and each value within ½·ω·h of it, for ω = 2πf and the
    /// sub-step h. Elsewhere m changes with the pose, and a spring that has one frequency at all poses gives and takes energy.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Distance, JointDef, JointKind, World, WorldDef, fx, vec2};
    ///
    /// let mut world: World = World::new(WorldDef { sleep_after: None, ..WorldDef::default() })?;
    /// let weight = world.add_body(BodyDef { position: vec2(3, 0), ..BodyDef::dynamic() })?;
    /// let spring = JointDef::between(&world, None, vec2(0, 0), weight, vec2(3, 0))?;
    /// // Half a metre longer than at rest: ½·1 kg·(2π·2 Hz)²·(½ m)².
    /// let kind = JointKind::Distance(Distance::spring(fx!(2.5), fx!(2), fx!(0)));
    /// world.add_joint(JointDef { kind, ..spring })?;
    /// let energy = world.potential_energy()?;
    /// assert_eq!(energy.to_scalar(), Some(fx!(19.7392088022)));
    /// (0..600).for_each(|_| _ = world.step());
    /// let change = world.energy()?.plus(energy.negated()).and_then(|change| change.to_scalar());
    /// assert!(change.is_some_and(|change| change.abs() < fx!(0.001)), "{change:?}");
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn potential_energy(&self) -> Result<S::Wide, Error> {
        S::potential_energy(self)
    }

    pub(crate) fn potential_energy_inner(&self) -> Result<S::Wide, Error> {
        let mut sum = S::Sum::default();
        total::<S>(self.add_potential(&mut sum).map(|()| sum))
    }

    /// Kinetic and potential energy together, J.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Mass, World, WorldDef, fx, vec2};
    ///
    /// let mut world: World =
    ///     World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() })?;
    /// let ball =
    ///     BodyDef { mass: Mass::Kilograms(fx!(2)), position: vec2(1, 20), velocity: vec2(3, 0), ..BodyDef::dynamic() };
    /// world.add_body(ball)?;
    /// assert_eq!(
    ///     (world.kinetic_energy()?.to_string(), world.potential_energy()?.to_string()),
    ///     ("9".into(), "400".into())
    /// );
    /// assert_eq!(
    ///     (world.momentum()?.to_string(), world.angular_momentum()?.to_string()),
    ///     ("(6, 0)".into(), "-120".into())
    /// );
    /// (0..60).for_each(|_| _ = world.step());
    /// assert_eq!(world.energy()?.to_string(), "409"); // it fell 5 m: 309 and 100 J
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn energy(&self) -> Result<S::Wide, Error> {
        let mut sum = S::Sum::default();
        total::<S>(self.add_kinetic(&mut sum).and_then(|()| self.add_potential(&mut sum)).map(|()| sum))
    }

    /// The momentum of the dynamic bodies, Σ m·v, kg·m/s; exact for the public velocities.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63.
    pub fn momentum(&self) -> Result<Vec2<S::Wide>, Error> {
        let (mut x, mut y) = (S::Sum::default(), S::Sum::default());
        for i in self.counted_bodies() {
            let term = self.momentum_term(i);
            x.add(term.x);
            y.add(term.y);
        }
        Ok(Vec2::new(total::<S>(Some(x))?, total::<S>(Some(y))?))
    }

    /// The angular momentum of the dynamic bodies about the origin of the world, Σ m·(x × v) + I·ω, kg·m²/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63.
    pub fn angular_momentum(&self) -> Result<S::Wide, Error> {
        let mut sum = S::Sum::default();
        let all = self.counted_bodies().try_for_each(|i| self.add_angular_momentum(i, &mut sum));
        total::<S>(all.map(|()| sum))
    }

    /// The terms of one body in the totals; zero for a body that is not counted there.
    pub(super) fn kinetic_energy_of(&self, i: usize) -> Result<S::Wide, Error> {
        let energy = if self.counts(i) { self.kinetic_term(i) } else { Some(S::Wide::default()) };
        energy.ok_or(Error::OutOfRange { quantity: Quantity::Total })
    }

    pub(super) fn momentum_of(&self, i: usize) -> Vec2<S::Wide> {
        if self.counts(i) { self.momentum_term(i) } else { Vec2::default() }
    }

    pub(super) fn angular_momentum_of(&self, i: usize) -> Result<S::Wide, Error> {
        let mut sum = S::Sum::default();
        let added = if self.counts(i) { self.add_angular_momentum(i, &mut sum) } else { Some(()) };
        total::<S>(added.map(|()| sum))
    }

    /// m·v, exactly.
    fn momentum_term(&self, i: usize) -> Vec2<S::Wide> {
        let (mass, velocity) = (self.bodies.info(i).kilograms(), self.bodies.columns.motion.velocity.get(i));
        velocity.map(|v| mass.product(v.value()))
    }

    fn add_angular_momentum(&self, i: usize, sum: &mut S::Sum) -> Option<()> {
        let motion = &self.bodies.columns.motion;
        let info = self.bodies.info(i);
        let (x, v) = (motion.position.get(i).map(Accumulator::value), motion.velocity.get(i).map(Accumulator::value));
        let angular_velocity = motion.angular_velocity[i].value();
        sum.add(x.wide_cross(v)?.times(S::Factor::from_scalar(info.kilograms()))?);
        sum.add(S::Wide::from_factor(
            info.inertia().times(S::Factor::from_scalar(angular_velocity)),
            angular_velocity < S::ZERO,
        )?);
        Some(())
    }

    fn kinetic_term(&self, i: usize) -> Option<S::Wide> {
        let square = |v: S::Accumulator| {
            let v = S::Factor::from_scalar(v.value());
            v.times(v)
        };
        let motion = &self.bodies.columns.motion;
        let info = self.bodies.info(i);
        let moving = square(motion.velocity.x[i]).plus(square(motion.velocity.y[i]));
        let turning = square(motion.angular_velocity[i]).times(info.inertia());
        let twice = moving.times(S::Factor::from_scalar(info.kilograms())).plus(turning);
        S::Wide::from_factor(twice.times(S::Factor::from_ratio(1, 2)), false)
    }

    fn add_kinetic(&self, sum: &mut S::Sum) -> Option<()> {
        for i in self.counted_bodies() {
            sum.add(self.kinetic_term(i)?);
        }
        Some(())
    }

    fn add_potential(&self, sum: &mut S::Sum) -> Option<()> {
        let columns = &self.bodies.columns;
        for i in self.counted_bodies() {
            let mass = S::Factor::from_scalar(self.bodies.info(i).kilograms());
            // Gravity along a locked axis counts, although it does not move the body.
            let scale = self.factor_table.rows()[columns.factors[i] as usize].key.gravity_scale;
            let gravity = self.def.gravity.map(|g| g.product(scale));
            let at = columns.motion.position.get(i);
            for (g, x) in [(gravity.x, at.x.value()), (gravity.y, at.y.value())] {
                let energy = S::Factor::from_wide(g).times(S::Factor::from_scalar(x)).times(mass);
                // The energy grows against the direction of gravity.
                sum.add(S::Wide::from_factor(energy, g.is_negative() == (x < S::ZERO))?);
            }
        }
        let scene = Scene {
            bodies: &self.bodies,
            fields: &self.fields,
            custom_forces: &self.custom_forces,
            colliders: &self.colliders,
            gravity: self.def.gravity,
        };
        let mut directions = Directions::<S>::default();
        for (_, field) in self.fields.iter() {
            match &field.kind {
                FieldKind::Spring { near, far, spring } => {
                    sum.add(spring_energy(scene, near, far, spring, &mut directions)?)
                }
                FieldKind::Attractor { centre, mu, softening } => {
                    let groups = field.force_groups;
                    self.add_attraction(sum, centre, *mu, *softening, groups, scene, &mut directions)?;
                }
                FieldKind::Drag { .. }
                | FieldKind::Friction { .. }
                | FieldKind::Thrust { .. }
                | FieldKind::Zone { .. }
                | FieldKind::Buoyancy { .. }
                | FieldKind::Custom { .. } => {}
            }
        }
        self.add_joint_springs(sum)
    }

    fn add_joint_springs(&self, sum: &mut S::Sum) -> Option<()> {
        let joints = self.joints.joined(&self.joint_states);
        for index in self.joints.indices() {
            for energy in spring_energies(&self.bodies, joints, index as u32) {
                let (mantissa, shift) = energy.parts();
                sum.add(S::Wide::from_factor(S::Factor::from_binary(mantissa.into(), shift), false)?);
            }
        }
        Some(())
    }

    fn add_attraction(
        &self,
        sum: &mut S::Sum,
        centre: &End<S>,
        mu: S::Factor,
        softening: S,
        force_groups: u32,
        scene: Scene<'_, S>,
        directions: &mut Directions<S>,
    ) -> Option<()> {
        let carrier = match centre {
            End::Body(at) => self.bodies.find(at.body).ok(),
            End::World(_) => None,
        };
        let mutual = carrier.is_some_and(|i| self.bodies.info(i).kind == BodyKind::Dynamic);
        let mu = if mutual { mu.times(S::Factor::from_ratio(1, 2)) } else { mu };
        for i in self.counted_bodies() {
            let info = self.bodies.info(i);
            let end = End::Body(Attachment { body: self.bodies.id(i), point: Vec2::ZERO });
            if carrier == Some(i) || info.force_groups & force_groups == 0 {
                continue;
            }
            // An attractor on a quarantined or disabled body attracts nothing.
            let Some(offset) = scene.offset_between(&end, centre, directions) else { continue };
            let distance = S::length(offset, softening);
            if distance.is_zero() {
                return None;
            }
            let energy = mu.times(S::Factor::from_scalar(info.kilograms())).over(distance);
            sum.add(S::Wide::from_factor(energy, true)?);
        }
        Some(())
    }

    /// The dynamic bodies that are simulated, in the order of their slots.
    fn counted_bodies(&self) -> impl Iterator<Item = usize> {
        self.bodies.in_order().filter(|&i| self.counts(i))
    }

    fn counts(&self, i: usize) -> bool {
        self.bodies.info(i).kind == BodyKind::Dynamic && self.bodies.activity(i).takes_part()
    }
}

/// The energy ½·k·(length − rest)² of a spring; zero for a spring on a quarantined or disabled body.
fn spring_energy<S: Scalar>(
    scene: Scene<'_, S>,
    start: &Attachment<S>,
    end: &End<S>,
    spring: &SpringConstants<S>,
    directions: &mut Directions<S>,
) -> Option<S::Wide> {
    let Some(offset) = scene.offset_between(&End::Body(*start), end, directions) else {
        return Some(S::Wide::default());
    };
    let stretch = S::length(offset, S::ZERO).abs_diff(S::Factor::from_scalar(spring.rest));
    let energy = stretch.times(stretch).times(S::Factor::from_scalar(spring.stiffness));
    S::Wide::from_factor(energy.times(S::Factor::from_ratio(1, 2)), false)
}
