//! Where kinematic bodies are to be after the next step.

use alloc::vec::Vec;

use super::{Locks, Motion};
use crate::error::{Error, Quantity};
use crate::handle::BodyId;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Scalar, Wide, fx::Fx};
use crate::wire::{self, Sink, Write as _, wire_struct};

/// A place and an angle to be at, to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose<S: Scalar> {
    pub(crate) position: Vec2<S>,
    pub(crate) angle: S::Angle,
}

wire_struct!(Pose { position, angle });

impl<S: Scalar> Pose<S> {
    /// The velocities that lead here in a step of 1/`rate` seconds from where body `i` is read to be, the short way round in
    /// turns; none along a locked axis. `None` from 2^21 m/s on.
    pub(crate) fn approach(
        &self,
        motion: &Motion<S>,
        i: usize,
        locks: Locks,
        rate: S::Factor,
    ) -> Option<Velocities<S>> {
        let at = motion.position.get(i).map(Accumulator::value);
        let over = |way, locked| if locked { Some(S::Accumulator::default()) } else { S::kick(way, rate) };
        Some((
            Vec2::new(over(self.position.x.offset(at.x), locks.x)?, over(self.position.y.offset(at.y), locks.y)?),
            over(motion.angle[i].way_to(self.angle), locks.rotation)?,
        ))
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
pub(crate) struct Errand<S: Scalar> {
    pub(crate) goal: Option<Pose<S>>,
    /// Whether the last step took it to a goal: it has the velocity that led there, and without another goal the next step
    /// stops it.
    pub(crate) arrived: bool,
}

wire_struct!(Errand { goal, arrived });

impl<S: Scalar> Errand<S> {
    /// Whether it is as if it had never been.
    pub(crate) fn is_over(&self) -> bool {
        self.goal.is_none() && !self.arrived
    }
}

/// The errands of the bodies that have one, in the order of the slots.
#[derive(Debug)]
pub(crate) struct Errands<S: Scalar> {
    rows: Vec<(BodyId, Errand<S>)>,
    /// The tick after the last step in which a body reached a goal or was stopped there, or 0: that step is not undone.
    pub(crate) moved_at: u64,
}

clone_by_field!(Errands { rows, moved_at });

impl<S: Scalar> Default for Errands<S> {
    fn default() -> Self {
        Self { rows: Vec::new(), moved_at: 0 }
    }
}

impl<S: Scalar> Errands<S> {
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn rows(&self) -> &[(BodyId, Errand<S>)] {
        &self.rows
    }

    pub(crate) fn rows_mut(&mut self) -> impl Iterator<Item = &mut (BodyId, Errand<S>)> {
        self.rows.iter_mut()
    }

    fn place(&self, body: BodyId) -> Result<usize, usize> {
        self.rows.binary_search_by_key(&body.slot, |(body, _)| body.slot)
    }

    /// That of a body, if it has one.
    pub(crate) fn of(&self, body: BodyId) -> Option<&Errand<S>> {
        self.place(body).ok().map(|i| &self.rows[i].1)
    }

    /// Gives a body an errand, in place of what it had.
    pub(crate) fn set(&mut self, body: BodyId, errand: Errand<S>) {
        match self.place(body) {
            Ok(i) if errand.is_over() => _ = self.rows.remove(i),
            Ok(i) => self.rows[i].1 = errand,
            Err(_) if errand.is_over() => {}
            Err(i) => self.rows.insert(i, (body, errand)),
        }
    }

    /// Sends a body to a goal.
    pub(crate) fn send(&mut self, body: BodyId, goal: Pose<S>) {
        let arrived = self.of(body).is_some_and(|errand| errand.arrived);
        self.set(body, Errand { goal: Some(goal), arrived });
    }

    /// Takes the goal of a body back. One that has just arrived is still to be stopped.
    pub(crate) fn recall(&mut self, body: BodyId) {
        if let Some(&Errand { arrived, .. }) = self.of(body) {
            self.set(body, Errand { goal: None, arrived });
        }
    }

    /// Forgets all about a body: the velocity it has is its own.
    pub(crate) fn forget(&mut self, body: BodyId) {
        if let Ok(i) = self.place(body) {
            self.rows.remove(i);
        }
    }

    /// Removes the errands that are over.
    pub(crate) fn tidy(&mut self) {
        self.rows.retain(|(_, errand)| !errand.is_over());
    }

    /// Adds them to a hash, in the order of the slots.
    pub(crate) fn write(&self, sink: &mut Sink) {
        wire::count(sink, self.rows.len());
        for (body, errand) in &self.rows {
            body.slot.write(sink);
            errand.write(sink);
        }
        self.moved_at.write(sink);
    }
}
