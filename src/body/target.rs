//! The targets of kinematic bodies: where they are to be after the next step.

use super::{Bodies, Locks, Motion, Row, Sparse};
use crate::codec::{self, StateHasher, Write as _, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Scalar, Wide};
use crate::slots::BodyId;

/// A position and an angle that a body is to have, to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Target<S: Scalar> {
    pub(crate) position: Vec2<S>,
    pub(crate) angle: S::Angle,
}

codec_struct!(Target { position, angle });

impl<S: Scalar> Target<S> {
    /// The velocities that take body `i` from its public position and angle to the target in a step of 1/`rate` seconds, the
    /// short way round in angle; zero along a locked axis. `None` where a velocity is beyond the limit. An angular velocity
    /// never is: π a step is below 2^15 rad/s at 10 kHz.
    pub(crate) fn approach(
        &self,
        motion: &Motion<S>,
        i: usize,
        locks: Locks,
        rate: S::Factor,
    ) -> Option<Velocities<S>> {
        let at = motion.position.get(i).map(Accumulator::value);
        let over = |way, locked| if locked { Some(S::Accumulator::default()) } else { S::kick(way, rate) };
        let velocity =
            Vec2::new(over(self.position.x.offset(at.x), locks.x)?, over(self.position.y.offset(at.y), locks.y)?);
        let speed = S::from_fx(limits::SPEED);
        let is_slow = velocity.x.is_within(speed) && velocity.y.is_within(speed);
        let angular_velocity = over(motion.angle[i].way_to(self.angle), locks.rotation)?;
        is_slow.then_some((velocity, angular_velocity))
    }

    /// Sets the position and the angle of body `i` to the target, to the bit. Along locked axes it is there already.
    pub(crate) fn take(&self, motion: &mut Motion<S>, i: usize, locks: Locks) {
        let here = self.position.map(S::Accumulator::from_scalar);
        if !locks.x {
            motion.position.x[i] = here.x;
        }
        if !locks.y {
            motion.position.y[i] = here.y;
        }
        if !locks.rotation {
            motion.angle[i] = self.angle;
        }
    }

    /// Refuses a target that a body with these locks cannot reach.
    pub(crate) fn check_locks(
        &self,
        position: Vec2<S::Accumulator>,
        angle: S::Angle,
        locks: Locks,
    ) -> Result<(), Error> {
        let (at, to) = (position.map(Accumulator::value), self.position);
        if (locks.x && at.x != to.x) || (locks.y && at.y != to.y) {
            return Err(Error::Locked { quantity: Quantity::Velocity });
        }
        if locks.rotation && !is_there::<S>(angle, self.angle) {
            return Err(Error::Locked { quantity: Quantity::AngularVelocity });
        }
        Ok(())
    }
}

/// Returns true if two angles are less than an ulp apart, so that an angle always equals its public value. The test uses the way
/// from one to the other, which is as long in a mirrored world; rounded angles are not mirrored.
fn is_there<S: Scalar>(angle: S::Angle, goal: S::Angle) -> bool {
    let way = angle.way_to(goal);
    let ulp = S::Wide::from_scalar(S::from_fx(Fx::DELTA));
    // Half a turn has a way of zero as well.
    if way == S::Wide::default() { angle == goal } else { way < ulp && way.negated() < ulp }
}

/// Linear and angular velocity.
pub(crate) type Velocities<S> = (Vec2<<S as Scalar>::Accumulator>, <S as Scalar>::Accumulator);

/// The target of a kinematic body for the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KinematicTarget<S: Scalar> {
    pub(crate) goal: Option<Target<S>>,
    /// True if the last step took the body to its target. It then has the velocity that led there, and without another target
    /// the next step stops it.
    pub(crate) arrived: bool,
}

codec_struct!(KinematicTarget { goal, arrived });

impl<S: Scalar> KinematicTarget<S> {
    /// Returns true if nothing is left to do for the body.
    pub(crate) fn is_over(&self) -> bool {
        self.goal.is_none() && !self.arrived
    }
}

impl<S: Scalar> Row for (BodyId, KinematicTarget<S>) {
    fn key(&self) -> usize {
        self.0.slot as usize
    }
}

/// The targets of the bodies that have one.
#[derive(Debug, Default)]
pub(crate) struct KinematicTargets<S: Scalar> {
    rows: Sparse<(BodyId, KinematicTarget<S>)>,
    /// The tick after the last step in which a body reached its target or was stopped there, or 0. That step cannot be undone.
    pub(crate) moved_at: u64,
}

clone_by_field!(KinematicTargets { rows, moved_at });

impl<S: Scalar> KinematicTargets<S> {
    /// The rows in no order.
    pub(crate) fn rows(&self) -> &[(BodyId, KinematicTarget<S>)] {
        self.rows.rows()
    }

    pub(crate) fn rows_mut(&mut self) -> &mut [(BodyId, KinematicTarget<S>)] {
        self.rows.rows_mut()
    }

    /// Returns true if any of these bodies takes part in the next step.
    pub(crate) fn are_due(&self, bodies: &Bodies<S>) -> bool {
        let takes_part = |body| bodies.find(body).is_ok_and(|i| bodies.activity(i).takes_part());
        self.rows().iter().any(|(body, _)| takes_part(*body))
    }

    /// The target of a body, if it has one.
    pub(crate) fn of(&self, body: BodyId) -> Option<&KinematicTarget<S>> {
        self.rows.get(body.slot as usize).map(|(_, target)| target)
    }

    /// Sets the target of a body.
    pub(crate) fn set(&mut self, body: BodyId, target: KinematicTarget<S>) {
        if target.is_over() {
            self.forget(body);
        } else {
            self.rows.get_or_insert(body.slot as usize, || (body, target)).1 = target;
        }
    }

    /// Gives a body a position and an angle to reach.
    pub(crate) fn send(&mut self, body: BodyId, goal: Target<S>) {
        let arrived = self.of(body).is_some_and(|target| target.arrived);
        self.set(body, KinematicTarget { goal: Some(goal), arrived });
    }

    /// Cancels the target of a body. A body that has just arrived still has to be stopped.
    pub(crate) fn recall(&mut self, body: BodyId) {
        if let Some(&KinematicTarget { arrived, .. }) = self.of(body) {
            self.set(body, KinematicTarget { goal: None, arrived });
        }
    }

    /// Removes the row of a body: from now on it moves at the velocity it has.
    pub(crate) fn forget(&mut self, body: BodyId) {
        self.rows.remove(body.slot as usize);
    }

    /// Removes the rows of the bodies for which nothing is left to do.
    pub(crate) fn tidy(&mut self) {
        self.rows.retain(|(_, target)| !target.is_over());
    }

    /// Adds the targets to a hash, in the order of the slots.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.rows().len());
        for (body, target) in self.rows.in_order() {
            body.slot.write(sink);
            target.write(sink);
        }
        self.moved_at.write(sink);
    }
}
