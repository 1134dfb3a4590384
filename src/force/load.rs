//! Evaluating force fields.

use alloc::vec::Vec;

use super::buoyancy::{Parts, lift};
use super::{
    Attachment, BodyState, CustomForces, Dependence, End, FieldKind, FieldSet, ForceField, ForceTorque, Region,
};
use crate::body::{Bodies, BodyKind, Sparse};
use crate::collider::ColliderSet;
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Offset, Scalar, SpringConstants, Sum, Wide};
use crate::shape::Aabb;
use crate::slots::{BodyId, FieldId};

/// The sums of what the fields do to a body: accelerations that do not depend on its mass, forces and a torque, each summed so that
/// the order of the fields never matters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load<S: Scalar> {
    pub(crate) acceleration: Vec2<S::Sum>,
    pub(crate) force: Vec2<S::Sum>,
    pub(crate) torque: S::Sum,
}

impl<S: Scalar> Load<S> {
    #[inline]
    fn accelerate(&mut self, acceleration: Vec2<S::Wide>) {
        self.acceleration.x.add(acceleration.x);
        self.acceleration.y.add(acceleration.y);
    }

    /// Adds a force that acts at `arm` from the centre of mass. `None` if its torque does not fit.
    #[inline]
    fn push(&mut self, arm: Offset<S>, force: Offset<S>) -> Option<()> {
        if arm != Offset::<S>::default() {
            self.torque.add(S::torque(arm.x, force.y)?);
            self.torque.add(S::torque(arm.y, force.x)?.negated());
        }
        self.force.x.add(force.x);
        self.force.y.add(force.y);
        Some(())
    }

    /// Adds a force through the centre of mass, and a torque.
    fn push_with(&mut self, force: Offset<S>, torque: S::Wide) {
        self.force.x.add(force.x);
        self.force.y.add(force.y);
        self.torque.add(torque);
    }

    #[inline]
    fn push_freely(&mut self, push: &ForceTorque<S>) {
        self.force.x.add(S::Wide::from_scalar(push.force.x));
        self.force.y.add(S::Wide::from_scalar(push.force.y));
        self.torque.add(S::Wide::from_scalar(push.torque));
    }
}

/// The loads of the bodies that a field acts on.
pub(crate) type Loads<S> = Sparse<(usize, Load<S>)>;

impl<S: Scalar> Loads<S> {
    /// The load of body `i` in the columns.
    #[inline]
    fn of(&mut self, i: usize) -> &mut Load<S> {
        &mut self.get_or_insert(i, || (i, Load::default())).1
    }
}

/// Sines and cosines that were computed already: at most once for a body as long as it does not turn.
pub(crate) type Directions<S> = Sparse<(usize, <<S as Scalar>::Angle as Angle<S>>::Direction)>;

/// The view that fields have of the world.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a, S: Scalar> {
    pub(crate) bodies: &'a Bodies<S>,
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) custom_forces: &'a CustomForces<S>,
    pub(crate) colliders: &'a ColliderSet<S>,
    /// The gravity of the world.
    pub(crate) gravity: Vec2<S>,
}

/// A point of the world or of a body, and how it moves.
struct Anchor<S: Scalar> {
    /// Index of the body in the columns, if a force on it moves something.
    dense: Option<usize>,
    position: Vec2<S>,
    /// From there to the point.
    arm: Offset<S>,
    /// The arm of a force on it about the body's centre: none where no torque has an effect, however large it were.
    lever: Offset<S>,
    velocity: Vec2<S>,
    angular_velocity: S,
}

impl<S: Scalar> Anchor<S> {
    /// A point of the world.
    fn at(position: Vec2<S>) -> Self {
        let none = Offset::<S>::default();
        Self { dense: None, position, arm: none, lever: none, velocity: Vec2::ZERO, angular_velocity: S::ZERO }
    }

    /// The way from here to `far`.
    fn offset_to(&self, far: &Self) -> Option<Offset<S>> {
        let component =
            |to: S, from: S, to_arm: S::Wide, from_arm: S::Wide| to.offset(from).plus(to_arm)?.plus(from_arm.negated());
        Some(Vec2::new(
            component(far.position.x, self.position.x, far.arm.x, self.arm.x)?,
            component(far.position.y, self.position.y, far.arm.y, self.arm.y)?,
        ))
    }

    /// The way from a point of the world to here.
    #[inline]
    fn offset_from(&self, point: Vec2<S>) -> Option<Offset<S>> {
        let way = Vec2::new(self.position.x.offset(point.x), self.position.y.offset(point.y));
        if self.arm == Offset::<S>::default() {
            return Some(way);
        }
        Some(Vec2::new(way.x.plus(self.arm.x)?, way.y.plus(self.arm.y)?))
    }

    fn point_velocity(&self) -> Option<Offset<S>> {
        velocity_at(self.velocity, self.angular_velocity, self.arm)
    }
}

/// The velocity of the point at `arm` from the centre of mass, v + ω × arm; `None` if it does not fit. Nothing rounds before
/// the sum where the arm is a multiple of an ulp: then its products are multiples of 2^-64.
pub(crate) fn velocity_at<S: Scalar>(velocity: Vec2<S>, angular_velocity: S, arm: Offset<S>) -> Option<Offset<S>> {
    let angular_velocity = S::Wide::from_scalar(angular_velocity);
    Some(Vec2::new(
        S::Wide::from_scalar(velocity.x).plus(S::torque(arm.y, angular_velocity)?.negated())?,
        S::Wide::from_scalar(velocity.y).plus(S::torque(arm.x, angular_velocity)?)?,
    ))
}

impl<S: Scalar> Scene<'_, S> {
    /// The anchor of an attachment; `None` if its body takes no part: the fields attached to it are inert then.
    fn attached(&self, attachment: &Attachment<S>, directions: &mut Directions<S>) -> Option<Anchor<S>> {
        let dense = self.bodies.find(attachment.body).ok()?;
        if !self.bodies.activity(dense).takes_part() {
            return None;
        }
        let motion = &self.bodies.columns.motion;
        let arm = if attachment.point == Vec2::ZERO {
            Offset::<S>::default()
        } else {
            // Attachments are within 2^12 m a component, far inside what turns without overflow.
            self.turned(dense, attachment.point, directions)?
        };
        let info = self.bodies.info(dense);
        let gives = info.kind == BodyKind::Dynamic && dense < self.bodies.moving();
        Some(Anchor {
            dense: gives.then_some(dense),
            position: motion.position.get(dense).map(Accumulator::value),
            arm,
            lever: if self.bodies.mass(dense).locks.rotation { Offset::<S>::default() } else { arm },
            velocity: motion.velocity.get(dense).map(Accumulator::value),
            angular_velocity: motion.angular_velocity[dense].value(),
        })
    }

    /// A vector of a body's frame in the world's.
    fn turned(&self, i: usize, vector: Vec2<S>, directions: &mut Directions<S>) -> Option<Offset<S>> {
        let (_, direction) = directions.get_or_insert(i, || (i, self.bodies.columns.motion.angle[i].direction()));
        S::Angle::turn(*direction, vector)
    }

    fn end(&self, end: &End<S>, directions: &mut Directions<S>) -> Option<Anchor<S>> {
        match end {
            End::Body(attachment) => self.attached(attachment, directions),
            End::World(point) => Some(Anchor::at(*point)),
        }
    }

    /// From one end to another; `None` if either is on a body that takes no part.
    pub(crate) fn offset_between(
        &self,
        from: &End<S>,
        to: &End<S>,
        directions: &mut Directions<S>,
    ) -> Option<Offset<S>> {
        self.end(from, directions)?.offset_to(&self.end(to, directions)?)
    }

    fn position(&self, i: usize) -> Vec2<S> {
        self.bodies.columns.motion.position.get(i).map(Accumulator::value)
    }

    fn is_inside(&self, i: usize, region: &Region<S>) -> bool {
        let at = self.position(i);
        match *region {
            Region::Box { min, max } => min.x <= at.x && at.x <= max.x && min.y <= at.y && at.y <= max.y,
            Region::Disc { centre, radius } => radius.reaches(Vec2::new(at.x.offset(centre.x), at.y.offset(centre.y))),
        }
    }

    fn state(&self, i: usize) -> BodyState<S> {
        let columns = &self.bodies.columns;
        let info = self.bodies.info(i);
        BodyState {
            position: self.position(i),
            angle: columns.motion.angle[i].radians(),
            velocity: columns.motion.velocity.get(i).map(Accumulator::value),
            angular_velocity: columns.motion.angular_velocity[i].value(),
            mass: info.kilograms(),
            key: info.key,
            user_data: info.user_data,
        }
    }
}

/// The bodies that fields are evaluated for, by their indices.
#[derive(Clone, Copy)]
pub(crate) enum Targets<'a> {
    /// All coupled bodies: the first, and the one after the last.
    Coupled(usize, usize),
    /// These coupled bodies, in ascending order.
    Only(&'a [usize]),
}

/// Adds the loads of the fields of one dependence on the targets. `Position` includes fields that depend on nothing, and the
/// elastic part of springs, whose dampers come with `Velocity`, and the lift of fluids. Drag belongs to neither: [`resist`](super::resist)
/// has it.
pub(crate) fn accumulate<S: Scalar>(
    scene: Scene<'_, S>,
    pass: Dependence,
    targets: Targets<'_>,
    directions: &mut Directions<S>,
    parts: &mut Parts<S>,
    loads: &mut Loads<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let mut evaluation = Evaluation { scene, targets, directions, parts, loads, faults };
    for (id, field) in scene.fields.iter() {
        let own_pass = match field.depends_on(scene.custom_forces) {
            Dependence::Velocity => Dependence::Velocity,
            Dependence::Nothing | Dependence::Position => Dependence::Position,
        };
        let is_split = matches!(field.kind, FieldKind::Spring { .. } | FieldKind::Buoyancy { .. });
        if own_pass == pass || (is_split && pass == Dependence::Position) {
            evaluation.field(id, field, pass);
        }
    }
}

/// An evaluation of fields, and the lists that it adds to.
struct Evaluation<'a, S: Scalar> {
    scene: Scene<'a, S>,
    targets: Targets<'a>,
    directions: &'a mut Directions<S>,
    parts: &'a mut Parts<S>,
    loads: &'a mut Loads<S>,
    faults: &'a mut Vec<(usize, Cause)>,
}

impl<S: Scalar> Evaluation<'_, S> {
    fn field(&mut self, id: FieldId, field: &ForceField<S>, pass: Dependence) {
        let scene = self.scene;
        match &field.kind {
            FieldKind::Spring { near, far, spring } => self.spring(id, near, far, spring, pass),
            FieldKind::Attractor { centre, mu, softening } => {
                let Some(centre) = scene.end(centre, self.directions) else { return };
                let carrier = field.bodies().next().and_then(|body| scene.bodies.find(body).ok());
                let (mu, softening) = (*mu, *softening);
                self.each_in(field.force_groups, |evaluation, i| {
                    if carrier == Some(i) {
                        return;
                    }
                    let offset = centre.offset_from(scene.position(i));
                    match offset.and_then(|offset| S::attraction(mu, offset, softening)) {
                        Some(acceleration) => evaluation.loads.of(i).accelerate(acceleration),
                        None => evaluation.faults.push((i, Cause::Field { field: id })),
                    }
                });
            }
            FieldKind::Thrust { at, force } => self.thrust(id, at, force),
            FieldKind::Zone { region, acceleration } => {
                let acceleration = acceleration.map(S::Wide::from_scalar);
                self.each_in(field.force_groups, |evaluation, i| {
                    if scene.is_inside(i, region) {
                        evaluation.loads.of(i).accelerate(acceleration);
                    }
                });
            }
            FieldKind::Custom { id: law } => {
                let Some(law) = scene.custom_forces.get(law) else { return };
                self.each_in(field.force_groups, |evaluation, i| match law.push(&scene.state(i)) {
                    Ok(push) => evaluation.loads.of(i).push_freely(&push),
                    Err(answer) => evaluation.faults.push((i, Cause::CustomForce { field: id, code: answer.code })),
                });
            }
            FieldKind::Buoyancy { min, max, density, .. } if pass == Dependence::Position => {
                let bounds = Aabb { min: *min, max: *max };
                self.each_in(field.force_groups, |evaluation, i| {
                    let part = evaluation.parts.of(scene.bodies, scene.colliders, i, id, bounds);
                    let Some(part) = part else { return };
                    match lift(&part, *density, scene.gravity) {
                        Some((force, torque)) => {
                            let turns = !scene.bodies.mass(i).locks.rotation;
                            evaluation.loads.of(i).push_with(force, if turns { torque } else { S::Wide::default() });
                        }
                        None => evaluation.faults.push((i, Cause::Field { field: id })),
                    }
                });
            }
            FieldKind::Buoyancy { .. } | FieldKind::Drag { .. } | FieldKind::Friction { .. } => {}
        }
    }

    /// Returns true if a body is a target.
    fn is_target(&self, i: usize) -> bool {
        match self.targets {
            Targets::Coupled(first, end) => (first..end).contains(&i),
            Targets::Only(only) => only.binary_search(&i).is_ok(),
        }
    }

    /// Returns true if a field attached to this body, and perhaps to another, acts on a target.
    fn is_any_target(&self, bodies: [Option<BodyId>; 2]) -> bool {
        matches!(self.targets, Targets::Coupled(..))
            || bodies.into_iter().flatten().any(|body| self.scene.bodies.find(body).is_ok_and(|i| self.is_target(i)))
    }

    /// The targets that a field with these groups acts on.
    #[inline(always)]
    fn each_in(&mut self, force_groups: u32, mut act: impl FnMut(&mut Self, usize)) {
        let bodies = self.scene.bodies;
        match self.targets {
            Targets::Only(only) => {
                only.iter().filter(|&&i| bodies.info(i).feels(force_groups)).for_each(|&i| act(self, i))
            }
            Targets::Coupled(first, end) => {
                (first..end).filter(|&i| bodies.info(i).feels(force_groups)).for_each(|i| act(self, i));
            }
        }
    }

    fn spring(
        &mut self,
        id: FieldId,
        near: &Attachment<S>,
        far: &End<S>,
        spring: &SpringConstants<S>,
        pass: Dependence,
    ) {
        if !self.is_any_target([Some(near.body), far.body()]) {
            return;
        }
        let law = match pass {
            Dependence::Velocity => SpringConstants { stiffness: S::ZERO, ..*spring },
            _ => SpringConstants { damping: S::ZERO, ..*spring },
        };
        let (start, end) = (self.scene.attached(near, self.directions), self.scene.end(far, self.directions));
        let (Some(start), Some(end)) = (start, end) else { return };
        if self.pull(&start, &end, &law).is_none() {
            for i in [start.dense, end.dense].into_iter().flatten() {
                if self.is_target(i) {
                    self.faults.push((i, Cause::Field { field: id }));
                }
            }
        }
    }

    /// A spring's force on both its ends, equal and opposite to the bit.
    fn pull(&mut self, a: &Anchor<S>, b: &Anchor<S>, spring: &SpringConstants<S>) -> Option<()> {
        let offset = a.offset_to(b)?;
        let velocity = if spring.damping == S::ZERO {
            Offset::<S>::default()
        } else {
            let (v, w) = (b.point_velocity()?, a.point_velocity()?);
            Vec2::new(v.x.plus(w.x.negated())?, v.y.plus(w.y.negated())?)
        };
        let force = S::tension(offset, velocity, spring)?;
        if let Some(i) = a.dense.filter(|&i| self.is_target(i)) {
            self.loads.of(i).push(a.lever, force)?;
        }
        if let Some(i) = b.dense.filter(|&i| self.is_target(i)) {
            self.loads.of(i).push(b.lever, force.map(S::Wide::negated))?;
        }
        Some(())
    }

    fn thrust(&mut self, id: FieldId, at: &Attachment<S>, force: &Vec2<S>) {
        let scene = self.scene;
        if !self.is_any_target([Some(at.body), None]) {
            return;
        }
        let Some(at) = scene.attached(at, self.directions) else { return };
        let Some(i) = at.dense else { return };
        let turned = scene.turned(i, *force, self.directions);
        if turned.and_then(|force| self.loads.of(i).push(at.lever, force)).is_none() {
            self.faults.push((i, Cause::Field { field: id }));
        }
    }
}
