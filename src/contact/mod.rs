//! Contacts of the bodies of a world: from the free flight of a step to impulses.
//!
//! - `records`: a contact of the state, with the impulses that the next step starts from; `set` has all of a world, `asleep` those of
//!   sleeping bodies.
//! - `view`: contacts as the interface shows them.
//! - `events`: contacts that begin and end, and hits; `sensors`: colliders that overlap sensors.
//! - `engine`: pairs, manifolds and records of any scalar; `numerics` names the computations that depend on the scalar.
//! - `numbers`: outlines as numbers, for the broad phase.
//! - `seams`: impulses of points that go from one segment of a chain to the next.
//! - `passes`: one-way colliders; `excluded`: pairs of bodies that do not touch.
//! - `tiles`: static polygons beside each other, as one surface.
//! - `flights`: the bodies of a step.
//! - `split`: islands under heavy loads, in finer sub-steps.
//! - `sweep`: the paths of fast bodies.
//! - `integer`: the computations in [`Fx`](crate::Fx).
//! - `float`: the same in floats.

#![allow(
    private_interfaces,
    unreachable_pub,
    reason = "the trait is public only because `Scalar` is; nothing outside can call it"
)]

mod asleep;
mod engine;
mod events;
mod excluded;
mod flights;
#[cfg(feature = "float")]
mod float;
mod integer;
mod numbers;
mod numerics;
mod passes;
mod records;
mod seams;
mod sensors;
mod set;
mod split;
mod stamped;
mod still;
mod sweep;
mod tiles;
mod view;

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::Debug;

use crate::body::{Activity, Bodies};
use crate::collide::broad::{PairLimits, Statics};
use crate::collider::{ColliderSet, ContactSettings, OutlineId};
use crate::limits::PARTS;
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::shape::Outline;
use crate::slots::BodyId;

pub use events::{ColliderPair, ContactHit};
pub(crate) use events::{EndedPair, compare, list_pairs};
pub use excluded::Exclusion;
pub(crate) use excluded::{ExcludedPair, sorted};
#[cfg(feature = "float")]
pub use float::FloatContacts;
pub use integer::FxContacts;
pub(crate) use passes::PassRecord;
pub(crate) use records::ContactRecord;
pub(crate) use sensors::{Overlap, Sensors};
pub(crate) use set::ContactSet;
pub(crate) use still::Disturbed;
pub use view::{Contact, ContactPoint};

/// Returns true if the body of the collider in a slot is asleep.
pub(crate) fn is_asleep<S: Scalar>(bodies: &Bodies<S>, colliders: &ColliderSet<S>, slot: u32) -> bool {
    let dense = colliders.at(slot).and_then(|collider| bodies.find(collider.body).ok());
    dense.is_some_and(|dense| bodies.activity(dense) == Activity::Asleep)
}

/// The limits on pairs. The parts of a compound may all overlap each other: so 128 overlaps for each outline of the world, half of the
/// [`PARTS`] that a compound may have, come on top of those that go with the number of pairs.
fn pair_limits<S: Scalar>(settings: &ContactSettings<S>, colliders: &ColliderSet<S>) -> PairLimits {
    let pairs = settings.max_pairs as usize;
    let outlines = colliders.len().saturating_add(colliders.more_outlines());
    PairLimits {
        pairs,
        per_collider: settings.max_pairs_per_collider as usize,
        overlaps: pairs.saturating_mul(16).saturating_add(outlines.saturating_mul(PARTS / 2)),
    }
}

/// The motion of a body at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start<S: Scalar> {
    /// The index of the body in the columns.
    pub(crate) dense: usize,
    pub(crate) position: Vec2<S::Accumulator>,
    pub(crate) velocity: Vec2<S::Accumulator>,
    pub(crate) angle: S::Angle,
    pub(crate) angular_velocity: S::Accumulator,
    pub(crate) ticks_at_rest: u32,
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
            ticks_at_rest: motion.ticks_at_rest[dense],
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

/// The pose in which the path of a body ends before the end of the tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop<S: Scalar> {
    /// The index of the body in the columns.
    pub(crate) dense: usize,
    pub(crate) position: Vec2<S::Accumulator>,
    pub(crate) angle: S::Angle,
    /// True if it stays where it was at the start.
    pub(crate) is_held: bool,
    /// True if what does not give way keeps it there.
    pub(crate) is_stuck: bool,
}

/// Changes of bodies and colliders; any may be there more than once.
#[derive(Debug, Default)]
pub(crate) struct Changed {
    /// The slots of the bodies that fell asleep or woke, or that calls changed in more than their motion.
    pub(crate) bodies: Vec<u32>,
    /// The slots of colliders.
    pub(crate) colliders: Vec<u32>,
    /// The slots of static bodies of which only colliders were added, replaced or removed.
    pub(crate) owners: Vec<u32>,
}

impl Clone for Changed {
    fn clone(&self) -> Self {
        Self { bodies: self.bodies.clone(), colliders: self.colliders.clone(), owners: self.owners.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.bodies.clone_from(&source.bodies);
        self.colliders.clone_from(&source.colliders);
        self.owners.clone_from(&source.owners);
    }
}

impl Changed {
    /// Nothing changed.
    pub(crate) const NONE: &Self = &Self { bodies: Vec::new(), colliders: Vec::new(), owners: Vec::new() };

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn len(&self) -> usize {
        self.bodies.len() + self.colliders.len() + self.owners.len()
    }

    pub(crate) fn clear(&mut self) {
        self.bodies.clear();
        self.colliders.clear();
        self.owners.clear();
    }

    /// The slots of the colliders of which the pose, the activity or the definition may have changed.
    fn all<S: Scalar>(&self, colliders: &ColliderSet<S>) -> impl Iterator<Item = u32> {
        let of_bodies = self.bodies.iter().flat_map(|&body| colliders.of_slot(body));
        of_bodies.map(|collider| collider.slot).chain(self.colliders.iter().copied())
    }
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
    /// The changes since the contacts were last found; `None` if anything may have changed.
    pub(crate) changed: Option<&'a Changed>,
    pub(crate) settings: &'a ContactSettings<S>,
    pub(crate) time_step: TimeStep,
}

/// The contacts of worlds of one scalar: the arithmetic of finding and solving them, and its memory. No result depends on
/// earlier steps through it.
#[doc(hidden)]
pub trait ContactEngine<S: Scalar>: Debug + Default + Send + Sync {
    /// Finds the contacts at the start poses, with the impulses that they start from. Adds to `touched` the sleeping bodies that a
    /// moving one touches or that have too many pairs, and to `crowded` the indices in the columns of moving bodies with too many pairs.
    /// If there are any, the contacts found are incomplete: the step wakes or quarantines the bodies and calls this again.
    fn detect(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, found: &mut Detected);

    /// Adds to `touched` the sleeping bodies that the bodies of `scene.starts` touch; none where bodies have too many pairs. The bodies of
    /// `scene.starts` woke since contacts were found, and the step knows of no other change.
    fn spread(&mut self, scene: &Scene<'_, S>, contacts: &ContactSet, found: &mut Detected);

    /// Lists the contacts with impulses: before [`solve`](Self::solve) with those that they start from, and after it with those that
    /// touched and have events. Lists also the answers of one-way colliders and the pairs of bodies that stay excluded.
    fn list(&self, colliders: &ColliderSet<S>, contacts: &mut ContactSet);

    /// Lists the hits of contacts that were solved.
    fn hits(&self, scene: &Scene<'_, S>, hits: &mut Vec<ContactHit<S>>);

    /// Calls `found` with the slots of the two bodies of each contact that was found, and true if a surface of one of them moves.
    fn touching(&self, colliders: &ColliderSet<S>, found: impl FnMut([u32; 2], bool));

    /// Solves the contacts that were found, and writes the change of each body of `scene.starts` to `corrections`; none if there was no
    /// impulse.
    fn solve(&mut self, scene: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>);

    /// Finds bodies whose paths end early, lest they cross something: `scene` holds the bodies as impulses left them, by these corrections.
    /// Bodies at fault are left out.
    fn sweep(
        &mut self,
        scene: &Scene<'_, S>,
        corrections: &[Correction<S>],
        is_faulty: &dyn Fn(usize) -> bool,
        stops: &mut Vec<Stop<S>>,
    );

    /// The manifold of two outlines that are near each other: the normal from the first to the second one, the points and their number.
    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)>;

    /// The static colliders as they were found last, if they belong to these colliders.
    fn statics(&self, _colliders: &ColliderSet<S>) -> Option<&Arc<Statics>> {
        None
    }

    /// The colliders of sleeping bodies as they were found last, likewise.
    fn sleepers(&self, _colliders: &ColliderSet<S>) -> Option<&Statics> {
        None
    }

    /// An outline by its number in [`statics`](Self::statics) and [`sleepers`](Self::sleepers).
    fn outline(&self, number: u32) -> OutlineId {
        OutlineId { slot: number, part: 0 }
    }

    /// The number of the first outline of the collider in a slot, likewise.
    fn number(&self, slot: u32) -> u32 {
        slot
    }

    /// Finds contacts ahead of time or not, for tests.
    #[cfg(feature = "selftest")]
    fn set_discrete(&mut self, _is_discrete: bool) {}

    /// Takes over the caches of the contacts of another world, of which this world is a copy.
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

    fn spread(&mut self, _: &Scene<'_, S>, _: &ContactSet, _: &mut Detected) {}

    fn list(&self, _: &ColliderSet<S>, _: &mut ContactSet) {}

    fn hits(&self, _: &Scene<'_, S>, _: &mut Vec<ContactHit<S>>) {}

    fn touching(&self, _: &ColliderSet<S>, _: impl FnMut([u32; 2], bool)) {}

    fn solve(&mut self, _: &Scene<'_, S>, corrections: &mut Vec<Correction<S>>) {
        corrections.clear();
    }

    fn sweep(&mut self, _: &Scene<'_, S>, _: &[Correction<S>], _: &dyn Fn(usize) -> bool, stops: &mut Vec<Stop<S>>) {
        stops.clear();
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
    /// The contacts at rest that the step looks at, however often contacts are found in it.
    pub(crate) disturbed: Disturbed,
}
