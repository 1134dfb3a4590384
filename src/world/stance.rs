//! Position and angle of bodies: now, and as the next step is going to leave them.

use super::World;
use crate::body::BodyKind;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Angle as _, Factor as _, Scalar, Wide as _};

/// The moment at which queries see kinematic bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moment {
    Now,
    AfterStep,
}

/// The position and the angle of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stance<S: Scalar> {
    pub(crate) position: Vec2<S>,
    pub(crate) angle: S::Angle,
}

impl<S: Scalar> Stance<S> {
    /// A point of the body in the world: [`BodyRef::world_point`](super::BodyRef::world_point).
    pub(crate) fn world_point(&self, local: Vec2<S>) -> Option<Vec2<S>> {
        let arm = self.angle.rotate(local)?;
        let component = |centre: S, arm: S::Wide| S::Wide::from_scalar(centre).plus(arm)?.to_scalar();
        Some(Vec2::new(component(self.position.x, arm.x)?, component(self.position.y, arm.y)?))
    }

    /// A point of the world in the axes of the body: [`BodyRef::local_point`](super::BodyRef::local_point).
    pub(crate) fn local_point(&self, world: Vec2<S>) -> Option<Vec2<S>> {
        let centre = self.position;
        self.local_vector(Vec2::new(world.x.offset(centre.x).to_scalar()?, world.y.offset(centre.y).to_scalar()?))
    }

    /// A vector of the world in the axes of the body.
    pub(crate) fn local_vector(&self, world: Vec2<S>) -> Option<Vec2<S>> {
        // The inverse rotation with the same sine and cosine: mirrored, rotated, mirrored.
        let mirrored = S::ZERO.offset(world.y).to_scalar()?;
        let turned = self.angle.rotate(Vec2::new(world.x, mirrored))?;
        Some(Vec2::new(turned.x.to_scalar()?, turned.y.negated().to_scalar()?))
    }
}

impl<S: Scalar> World<S> {
    /// The stance of a body by its index.
    pub(crate) fn stance(&self, dense: usize) -> Stance<S> {
        let motion = &self.bodies.columns.motion;
        Stance { position: motion.position.get(dense).map(|part| part.value()), angle: motion.angle[dense] }
    }

    /// The stance of a body at a moment, as queries see it: kinematic bodies alone go where nothing can hold them.
    pub(crate) fn stance_at(&self, dense: usize, moment: Moment) -> Stance<S> {
        let is_ahead = moment == Moment::AfterStep && self.bodies.info(dense).kind == BodyKind::Kinematic;
        if is_ahead { self.stance_after_step(dense) } else { self.stance(dense) }
    }

    /// The stance to which its target or its velocities take a body in the next step, if nothing else acts on it.
    pub(crate) fn stance_after_step(&self, dense: usize) -> Stance<S> {
        let now = self.stance(dense);
        if !self.bodies.activity(dense).takes_part() {
            return now;
        }
        let motion = &self.bodies.columns.motion;
        let (num, den) = self.def.time_step.seconds();
        if let Some(target) = self.targets.of(self.bodies.id(dense)) {
            // Without another target the step stops a body that has arrived, and leaves one whose target is too far off where it is.
            let rate = S::Factor::from_ratio(u64::from(den), u64::from(num));
            let goal =
                target.goal.filter(|goal| goal.approach(motion, dense, self.bodies.mass(dense).locks, rate).is_some());
            return goal.map_or(now, |goal| Stance { position: goal.position, angle: goal.angle });
        }
        // Speeds are within 2^20 m/s and steps within 1 s: the ways of a step are below 2^20 m, and a position below 2^30 m stays below 2^31.
        let seconds = S::Factor::from_ratio(u64::from(num), u64::from(den));
        let way = |speed: S::Accumulator| speed.value().drift(seconds);
        let velocity = motion.velocity.get(dense);
        let position = motion.position.get(dense);
        let position = Vec2::new(position.x.plus(way(velocity.x)), position.y.plus(way(velocity.y)));
        Stance {
            position: position.map(|part| part.value()),
            angle: now.angle.turned(way(motion.angular_velocity[dense])),
        }
    }
}
