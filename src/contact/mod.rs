//! Contacts of the bodies of a world: from the free flight of a step to impulses.
//!
//! - `records`: the state, impulses that the next step starts from.
//! - `view`: contacts as the interface shows them.
//! - `engine`: pairs, manifolds and records of any scalar; `numerics` names the computations that depend on the scalar.
//! - `numbers`: outlines as numbers, for the broad phase.
//! - `seams`: impulses of points that go from one segment of a chain to the next.
//! - `flights`: the bodies of a step.
//! - `integer`: the computations in [`Fx`](crate::Fx).
//! - `float`: the same in floats.

#![allow(
    private_interfaces,
    unreachable_pub,
    reason = "the trait is public only because `Scalar` is; nothing outside can call it"
)]

mod engine;
mod flights;
#[cfg(feature = "float")]
mod float;
mod integer;
mod numbers;
mod numerics;
mod records;
mod seams;
mod stamped;
mod view;

use alloc::vec::Vec;
use core::fmt::Debug;

use crate::body::Bodies;
use crate::collider::{ColliderSet, ContactSettings};
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::shape::Outline;
use crate::slots::BodyId;

#[cfg(feature = "float")]
pub use float::FloatContacts;
pub use integer::FxContacts;
pub(crate) use records::{ContactRecord, ContactSet};
pub use view::{Contact, ContactPoint};

/// The motion of a body at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start<S: Scalar> {
    /// The index of the body in the columns.
    pub(crate) dense: usize,
    pub(crate) position: Vec2<S::Accumulator>,
    pub(crate) velocity: Vec2<S::Accumulator>,
    pub(crate) angle: S::Angle,
    pub(crate) angular_velocity: S::Accumulator,
}

impl<S: Scalar> Start<S> {
    pub(crate) fn of(bodies: &Bodies<S>, dense: usize) -> Self {
        let motion = &bodies.columns.motion;
        Self {
            dense,
            position: motion.position.get(dense),
            velocity: motion.velocity.get(dense),
            angle: motion.angle[dense],
            angular_velocity: motion.angular_velocity[dense],
        }
    }

    /// Takes the body back to the start, at rest for no tick.
    pub(crate) fn restore(&self, bodies: &mut Bodies<S>) {
        let motion = &mut bodies.columns.motion;
        motion.position.set(self.dense, self.position);
        motion.velocity.set(self.dense, self.velocity);
        motion.angle[self.dense] = self.angle;
        motion.angular_velocity[self.dense] = self.angular_velocity;
        motion.ticks_at_rest[self.dense] = 0;
    }
}

/// The change of a body by all impulses of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Correction<S: Scalar> {
    /// True if there was an impulse, also where the changes add up to nothing.
    pub(crate) is_pushed: bool,
    /// m/s
    pub(crate) velocity: Vec2<S::Accumulator>,
    /// rad/s
    pub(crate) angular_velocity: S::Accumulator,
    /// m
    pub(crate) displacement: Vec2<S::Accumulator>,
    /// rad
    pub(crate) rotation: S::Accumulator,
}

/// The parts of a world that contacts depend on.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a, S: Scalar> {
    /// The bodies at the end of their free flight.
    pub(crate) bodies: &'a Bodies<S>,
    pub(crate) colliders: &'a ColliderSet<S>,
    /// The moving bodies with colliders, without those at fault.
    pub(crate) starts: &'a [Start<S>],
    /// True if a static body or its colliders may have changed since the last step.
    pub(crate) may_have_moved_statics: bool,
    pub(crate) settings: &'a ContactSettings<S>,
    pub(crate) time_step: TimeStep,
}

/// The contacts of worlds of one scalar: the arithmetic of finding and solving them, and its memory. No result depends on what it
/// did before.
#[doc(hidden)]
pub trait ContactEngine<S: Scalar>: Debug + Default + Send + Sync {
    /// Finds the contacts at the start poses, with the impulses that they start from. Adds to `touched` the sleeping bodies that a
    /// moving one touches or that have too many pairs, and to `crowded` the indices in the columns of moving bodies with too many pairs; with
    /// either, the contacts are of no use.
    fn detect(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, found: &mut Detected);

    /// Lists the contacts with impulses: before [`solve`](Self::solve) with those that they start from.
    fn list(&self, records: &mut Vec<ContactRecord>);

    /// Solves the contacts that were found, and writes the change of each body of `scene.starts` to `corrections`; none if there was no
    /// impulse.
    fn solve(&mut self, scene: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>);

    /// The manifold of two outlines that are near each other: the normal from the first to the second one, the points and their number.
    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)>;

    /// Takes over what is cached of another one, whose world this one's is a copy of.
    fn clone_cached_from(&mut self, source: &Self);
}

/// An outline of a body, with the position and the angle of the body.
pub(crate) type Placed<'a, S> = (&'a Outline<S>, (Vec2<<S as Scalar>::Accumulator>, <S as Scalar>::Angle));

/// A point of a manifold.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TouchPoint<S: Scalar> {
    /// The position, m.
    pub(crate) position: Vec2<S>,
    pub(crate) separation: S,
    pub(crate) feature: u32,
}

/// No contacts, for the scalars of tests.
#[cfg(feature = "selftest")]
#[doc(hidden)]
#[derive(Debug, Default)]
pub struct NoContacts;

#[cfg(feature = "selftest")]
impl<S: Scalar> ContactEngine<S> for NoContacts {
    fn detect(&mut self, _: &Scene<'_, S>, _: &ContactSet, _: &mut Detected) {}

    fn list(&self, _: &mut Vec<ContactRecord>) {}

    fn solve(&mut self, _: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>) {
        corrections.clear();
    }

    fn touch(_: Placed<'_, S>, _: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)> {
        None
    }

    fn clone_cached_from(&mut self, _: &Self) {}
}

/// Bodies that stand in the way of solving.
#[derive(Debug, Default)]
pub(crate) struct Detected {
    pub(crate) touched: Vec<BodyId>,
    pub(crate) crowded: Vec<usize>,
}
