//! Where kinematic bodies are to be after the next step.

use super::{Bodies, Locks, Motion, Row, Sparse};
use crate::codec::{self, StateHasher, Write as _, codec_struct};
use crate::error::{Error, Quantity};
use crate::handle::BodyId;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Scalar, Wide, fx::Fx};

/// A place and an angle to be at, to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Target<S: Scalar> {
    pub(crate) position: Vec2<S>,
    pub(crate) angle: S::Angle,
}

codec_struct!(Target { position, angle });

impl<S: Scalar> Target<S> {
    /// The velocities that lead here in a step of 1/`rate` seconds from where body `i` is read to be, the short way round in
    /// turns; none along a locked axis. `None` where a velocity is beyond the limit. An angular one never is: π a step is
    /// below 2^15 rad/s at 10 kHz.
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

    /// Puts body `i` here, to the bit, but along locked axes, where it is already.
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

    /// Refuses what a body that is locked like this cannot be moved to.
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

/// Whether a goal is where an angle is: less than an ulp from it, so that the angle as it is read always is there. By the way
/// there, which is as long in a mirror, as rounded angles are not.
fn is_there<S: Scalar>(angle: S::Angle, goal: S::Angle) -> bool {
    let (way, ulp) = (angle.way_to(goal), S::Wide::from_scalar(S::from_fx(Fx::DELTA)));
    // Half a turn has no way either.
    if way == S::Wide::default() { angle == goal } else { way < ulp && way.negated() < ulp }
}

/// Linear and angular velocity.
pub(crate) type Velocities<S> = (Vec2<<S as Scalar>::Accumulator>, <S as Scalar>::Accumulator);

/// Where the next step has a body go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KinematicTarget<S: Scalar> {
    pub(crate) goal: Option<Target<S>>,
    /// Whether the last step took it to a goal: it has the velocity that led there, and without another goal the next step
    /// stops it.
    pub(crate) arrived: bool,
}

codec_struct!(KinematicTarget { goal, arrived });

impl<S: Scalar> KinematicTarget<S> {
    /// Whether it is as if it had never been.
    pub(crate) fn is_over(&self) -> bool {
        self.goal.is_none() && !self.arrived
    }
}

impl<S: Scalar> Row for (BodyId, KinematicTarget<S>) {
    fn key(&self) -> usize {
        self.0.slot as usize
    }
}

/// The errands of the bodies that have one.
#[derive(Debug)]
pub(crate) struct KinematicTargets<S: Scalar> {
    rows: Sparse<(BodyId, KinematicTarget<S>)>,
    /// The tick after the last step in which a body reached a goal or was stopped there, or 0: that step is not undone.
    pub(crate) moved_at: u64,
}

clone_by_field!(KinematicTargets { rows, moved_at });

impl<S: Scalar> Default for KinematicTargets<S> {
    fn default() -> Self {
        Self { rows: Sparse::default(), moved_at: 0 }
    }
}

impl<S: Scalar> KinematicTargets<S> {
    /// In no order.
    pub(crate) fn rows(&self) -> &[(BodyId, KinematicTarget<S>)] {
        self.rows.rows()
    }

    pub(crate) fn rows_mut(&mut self) -> &mut [(BodyId, KinematicTarget<S>)] {
        self.rows.rows_mut()
    }

    /// Whether the next step sees to any of these bodies: those that take part in it.
    pub(crate) fn are_due(&self, bodies: &Bodies<S>) -> bool {
        let takes_part = |body| bodies.find(body).is_ok_and(|i| bodies.activity(i).takes_part());
        self.rows().iter().any(|(body, _)| takes_part(*body))
    }

    /// That of a body, if it has one.
    pub(crate) fn of(&self, body: BodyId) -> Option<&KinematicTarget<S>> {
        self.rows.get(body.slot as usize).map(|(_, target)| target)
    }

    /// Gives a body an errand, in place of what it had.
    pub(crate) fn set(&mut self, body: BodyId, target: KinematicTarget<S>) {
        if target.is_over() {
            self.forget(body);
        } else {
            self.rows.get_or_insert(body.slot as usize, || (body, target)).1 = target;
        }
    }

    /// Sends a body to a goal.
    pub(crate) fn send(&mut self, body: BodyId, goal: Target<S>) {
        let arrived = self.of(body).is_some_and(|target| target.arrived);
        self.set(body, KinematicTarget { goal: Some(goal), arrived });
    }

    /// Takes the goal of a body back. One that has just arrived is still to be stopped.
    pub(crate) fn recall(&mut self, body: BodyId) {
        if let Some(&KinematicTarget { arrived, .. }) = self.of(body) {
            self.set(body, KinematicTarget { goal: None, arrived });
        }
    }

    /// Forgets all about a body: the velocity it has is its own.
    pub(crate) fn forget(&mut self, body: BodyId) {
        self.rows.remove(body.slot as usize);
    }

    /// Removes the errands that are over.
    pub(crate) fn tidy(&mut self) {
        self.rows.retain(|(_, target)| !target.is_over());
    }

    /// Adds them to a hash, in the order of the slots.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.rows().len());
        for (body, target) in self.rows.in_order() {
            body.slot.write(sink);
            target.write(sink);
        }
        self.moved_at.write(sink);
    }
}
