//! Evaluating force fields.

use alloc::vec::Vec;

use super::{
    Attachment, BodyState, CustomForces, Dependence, End, FieldKind, FieldSet, ForceField, ForceTorque, Region,
};
use crate::body::{Bodies, BodyKind, Sparse};
use crate::error::Cause;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Factor, Offset, Scalar, SpringConstants, Sum, Wide};
use crate::slots::FieldId;

/// Effect of the fields on a body: accelerations that do not depend on its mass, forces and a torque, each summed so that
/// the order of the fields never matters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load<S: Scalar> {
    pub(crate) acceleration: Vec2<S::Sum>,
    pub(crate) force: Vec2<S::Sum>,
    pub(crate) torque: S::Sum,
}

impl<S: Scalar> Load<S> {
    fn accelerate(&mut self, acceleration: Vec2<S::Wide>) {
        self.acceleration.x.add(acceleration.x);
        self.acceleration.y.add(acceleration.y);
    }

    /// Adds a force that acts at `arm` from the centre of mass. `None` if its torque does not fit.
    fn push(&mut self, arm: Offset<S>, force: Offset<S>) -> Option<()> {
        if arm != Offset::<S>::default() {
            self.torque.add(S::torque(arm.x, force.y)?);
            self.torque.add(S::torque(arm.y, force.x)?.negated());
        }
        self.force.x.add(force.x);
        self.force.y.add(force.y);
        Some(())
    }

    fn push_freely(&mut self, push: &ForceTorque<S>) {
        self.force.x.add(S::Wide::from_scalar(push.force.x));
        self.force.y.add(S::Wide::from_scalar(push.force.y));
        self.torque.add(S::Wide::from_scalar(push.torque));
    }
}

/// Effects of the fields on the bodies that they reach.
pub(crate) type Loads<S> = Sparse<(usize, Load<S>)>;

impl<S: Scalar> Loads<S> {
    /// Entry of body `i` in the columns.
    fn of(&mut self, i: usize) -> &mut Load<S> {
        &mut self.get_or_insert(i, || (i, Load::default())).1
    }
}

/// Sines and cosines that were computed already: at most once for a body as long as it does not turn.
pub(crate) type Directions<S> = Sparse<(usize, <<S as Scalar>::Angle as Angle<S>>::Direction)>;

/// Inputs of the fields.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a, S: Scalar> {
    pub(crate) bodies: &'a Bodies<S>,
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) custom_forces: &'a CustomForces<S>,
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
    /// The first `moving` bodies that a field with these groups acts on.
    fn targets(&self, moving: usize, groups: u32) -> impl Iterator<Item = usize> {
        (0..moving).filter(move |&i| self.bodies.info(i).feels(groups))
    }

    /// `None` if its body takes no part, so that whatever is attached to it is inert.
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

/// Adds what the fields of one dependence do to the bodies that move. `Position` takes in what depends on nothing, and the
/// elastic part of a spring, whose damper comes with `Velocity`. Drag is no part of either: it is [`resist`]ed.
pub(crate) fn accumulate<S: Scalar>(
    scene: Scene<'_, S>,
    pass: Dependence,
    directions: &mut Directions<S>,
    loads: &mut Loads<S>,
    faults: &mut Vec<(usize, Cause)>,
) {
    let moving = scene.bodies.moving();
    for (id, field) in scene.fields.iter() {
        let own_pass = match field.depends_on(scene.custom_forces) {
            Dependence::Velocity => Dependence::Velocity,
            Dependence::Nothing | Dependence::Position => Dependence::Position,
        };
        let mut fault = |i: usize, cause| faults.push((i, cause));
        let too_large = Cause::Field { field: id };
        match &field.kind {
            FieldKind::Spring { near, far, spring } if own_pass == pass || pass == Dependence::Position => {
                let law = match pass {
                    Dependence::Velocity => SpringConstants { stiffness: S::ZERO, ..*spring },
                    _ => SpringConstants { damping: S::ZERO, ..*spring },
                };
                let (near, far) = (scene.attached(near, directions), scene.end(far, directions));
                let (Some(near), Some(far)) = (near, far) else { continue };
                if pull(&near, &far, &law, loads).is_none() {
                    [near.dense, far.dense].into_iter().flatten().for_each(|i| fault(i, too_large));
                }
            }
            _ if own_pass != pass => {}
            FieldKind::Attractor { centre, mu, softening } => {
                let Some(centre) = scene.end(centre, directions) else { continue };
                let carrier = field.bodies().next().and_then(|body| scene.bodies.find(body).ok());
                for i in scene.targets(moving, field.groups).filter(|&i| carrier != Some(i)) {
                    let offset = Anchor::at(scene.position(i)).offset_to(&centre);
                    match offset.and_then(|offset| S::attraction(*mu, offset, *softening)) {
                        Some(acceleration) => loads.of(i).accelerate(acceleration),
                        None => fault(i, too_large),
                    }
                }
            }
            FieldKind::Thrust { at, force } => {
                let Some(at) = scene.attached(at, directions) else { continue };
                let Some(i) = at.dense else { continue };
                let turned = scene.turned(i, *force, directions);
                if turned.and_then(|force| loads.of(i).push(at.lever, force)).is_none() {
                    fault(i, too_large);
                }
            }
            FieldKind::Zone { region, acceleration } => {
                let acceleration = acceleration.map(S::Wide::from_scalar);
                for i in scene.targets(moving, field.groups).filter(|&i| scene.is_inside(i, region)) {
                    loads.of(i).accelerate(acceleration);
                }
            }
            FieldKind::Custom { id: law } => {
                let Some(law) = scene.custom_forces.get(law) else { continue };
                for i in scene.targets(moving, field.groups) {
                    match law.push(&scene.state(i)) {
                        Ok(push) => loads.of(i).push_freely(&push),
                        Err(answer) => fault(i, Cause::CustomForce { field: id, code: answer.code }),
                    }
                }
            }
            FieldKind::Drag { .. } | FieldKind::Spring { .. } => {}
        }
    }
}

/// A spring's force on both its ends, equal and opposite to the bit.
fn pull<S: Scalar>(near: &Anchor<S>, far: &Anchor<S>, spring: &SpringConstants<S>, loads: &mut Loads<S>) -> Option<()> {
    let offset = near.offset_to(far)?;
    let velocity = if spring.damping == S::ZERO {
        Offset::<S>::default()
    } else {
        let (v, w) = (far.point_velocity()?, near.point_velocity()?);
        Vec2::new(v.x.plus(w.x.negated())?, v.y.plus(w.y.negated())?)
    };
    let force = S::tension(offset, velocity, spring)?;
    if let Some(i) = near.dense {
        loads.of(i).push(near.lever, force)?;
    }
    if let Some(i) = far.dense {
        loads.of(i).push(far.lever, force.map(S::Wide::negated))?;
    }
    Some(())
}

/// Drag over a span: the exact solution for each field, one after the other, in reverse order if `closing`.
///
/// `only` says which bodies feel it: with `Yoshida4` some feel theirs around the whole step.
pub(crate) fn resist<S: Scalar>(
    fields: &FieldSet<S>,
    bodies: &mut Bodies<S>,
    span: (S::Factor, bool),
    mirrored: bool,
    only: impl Fn(usize) -> bool,
    faults: &mut Vec<(usize, Cause)>,
) {
    let mut one = |id: FieldId, field: &ForceField<S>| {
        let FieldKind::Drag { linear, quadratic, wind } = &field.kind else { return };
        for i in 0..bodies.moving() {
            let info = bodies.info(i);
            if !info.feels(field.groups) || !only(i) {
                continue;
            }
            let mass = bodies.mass(i);
            let (inverse_mass, axes) = (mass.inverse_mass, mass.axis_inverse_mass);
            let velocities = &mut bodies.columns.motion.velocity;
            let velocity = velocities.get(i);
            let speed = S::length(relative(velocity, *wind), S::ZERO);
            let (alpha, beta) = (
                S::Factor::from_scalar(*linear).times(inverse_mass),
                S::Factor::from_scalar(*quadratic).times(inverse_mass),
            );
            let left = S::drag(speed, alpha, beta, span.0, span.1);
            if left == Some(S::Factor::ONE) {
                continue;
            }
            let slowed = left.and_then(|left| {
                let component = |v: S::Accumulator, w: S, inverse_mass: S::Factor| {
                    if inverse_mass.is_zero() {
                        return Some(v);
                    }
                    let w = S::Accumulator::from_scalar(w);
                    Some(v.plus(w.negated()).scaled(left)?.plus(w))
                };
                Some(Vec2::new(component(velocity.x, wind.x, axes.x)?, component(velocity.y, wind.y, axes.y)?))
            });
            match slowed {
                Some(slowed) => velocities.set(i, slowed),
                None => faults.push((i, Cause::Field { field: id })),
            }
        }
    };
    if mirrored {
        fields.iter().rev().for_each(|(id, field)| one(id, field));
    } else {
        fields.iter().for_each(|(id, field)| one(id, field));
    }
}

/// The public velocity relative to a medium.
fn relative<S: Scalar>(velocity: Vec2<S::Accumulator>, wind: Vec2<S>) -> Offset<S> {
    Vec2::new(velocity.x.value().offset(wind.x), velocity.y.value().offset(wind.y))
}

/// Marks the bodies whose drag is too stiff to run backwards, those with (linear + quadratic·|u|)/m·dt > ½ for one of
/// the fields, and counts them. |u| is the speed at the start and what `gain` says that the step may add.
pub(crate) fn outer_drag<S: Scalar>(
    fields: &FieldSet<S>,
    bodies: &Bodies<S>,
    time_step: S::Factor,
    gain: impl Fn(usize) -> S::Factor,
    outside: &mut Vec<bool>,
) -> u32 {
    outside.clear();
    outside.resize(bodies.moving(), false);
    let half = S::Factor::from_ratio(1, 2);
    let velocities = &bodies.columns.motion.velocity;
    for (_, field) in fields.iter() {
        let FieldKind::Drag { linear, quadratic, wind } = &field.kind else { continue };
        for (i, outside) in outside.iter_mut().enumerate() {
            let info = bodies.info(i);
            if info.feels(field.groups) {
                let speed = S::length(relative(velocities.get(i), *wind), S::ZERO).plus(gain(i));
                let slope = S::Factor::from_scalar(*linear).plus(S::Factor::from_scalar(*quadratic).times(speed));
                *outside |= slope.times(bodies.mass(i).inverse_mass).times(time_step) > half;
            }
        }
    }
    outside.iter().map(|&is| u32::from(is)).sum()
}
