//! Contacts of the bodies of a world: from the free flight of a step to impulses.
//!
//! The path of the data in a step, each arrow a function that [`pipeline`] calls, in this order:
//!
//! | function | from | to |
//! |---|---|---|
//! | `Flights::begin` | columns, `Start` | a [`Flight`](crate::solve::Flight) for each moving body with colliders or joints |
//! | `Resting::update` | changes of bodies and colliders | trees of colliders at rest |
//! | `Pairs::find` | flights, trees | pairs of outline numbers, sorted |
//! | `Rules::filter` | pairs, answers of the step before | pairs that may touch (`excluded`, `one_way`) |
//! | `Actors` | pairs in chunks | boxes in lanes, and the manifolds of pairs of boxes |
//! | `Narrow::meet` | a pair | `Meeting`: a manifold, and the ways of both bodies to its [`moment`] |
//! | `ContactList::push` | a meeting, the record of the step before | a contact of the solver (`surfaces`, `approach`, `seams`) |
//! | `JointList::set` | flights, joints | the joints of the solver |
//! | `Solvers::solve` | flights, joints, contacts | impulses and a correction for each flight, islands apart (`split`) |
//! | `list_deflected`, `Again::solve` | corrections | contacts on the new ways, solved again with their islands |
//! | `ContactList::list_records` | impulses | [`ContactRecord`]s, the state that the next step starts from (`set`, `asleep`) |
//! | `Sweeps::end_fast_paths` | columns after the corrections | `Stop`s: the ends of fast paths |
//!
//! A body has four forms: columns, flight, a row of the solver, a correction. A contact has four as well: a pair, a meeting, a contact in a
//! group of the solver, a record. `events` and `sensors` report; `view` shows contacts to users; `bodies` is the border to bodies of any scalar;
//! `springs` has the energy of springs of joints; `numbers` gives outlines the numbers that the broad phase knows; `movers` keeps what no step
//! changes of moving outlines; `reach` says how far outlines come in a step; `tiles` and `body_tiles` are polygons beside each other as one surface.
//!
//! Contacts are found in fixed point, whatever the scalar of the world: `World<f64>` takes the manifolds of `World<Fx>`, with an
//! error of 2^-32 m, which is far below the accuracy that floats are compared for. Only the solver depends on the scalar.

mod actors;
mod again;
mod approach;
mod asleep;
mod bodies;
mod body_tiles;
mod coefficients;
mod deflected;
mod events;
mod excluded;
mod flights;
mod joints;
mod list;
mod moment;
mod movers;
mod narrow;
mod numbers;
mod one_way;
mod pairs;
mod pipeline;
mod reach;
mod records;
mod resting;
mod rules;
mod seams;
mod sensors;
mod set;
mod slot_table;
mod split;
mod springs;
mod sweep;
mod tiles;
mod view;

use alloc::vec::Vec;
use core::any::Any;

use crate::body::{Activity, Bodies};
use crate::collide::broad::PairLimits;
use crate::collider::{ColliderSet, ContactSettings};
use crate::fx::Fx;
use crate::joint::Joined;
use crate::limits::PARTS;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, Scalar, Turn};
use crate::slots::BodyId;
pub(crate) use crate::solve::Correction;
use crate::solve::SolverOptions;

pub(crate) use bodies::{ContactBodies, MovingBody};
pub(crate) use deflected::ROUNDS;
pub use events::{ColliderPair, ContactHit};
pub(crate) use events::{EndedPair, compare, list_pairs};
pub use excluded::Exclusion;
pub(crate) use excluded::{ExcludedPair, sorted};
pub(crate) use one_way::OneWayAnswer;
pub(crate) use pipeline::Pipeline;
pub(crate) use records::ContactRecord;
pub(crate) use resting::ChangedResting;
pub(crate) use sensors::{Overlap, Sensors};
pub(crate) use set::ContactSet;
pub(crate) use split::Solvers;
pub(crate) use springs::{spring_energies, spring_mass};
pub(crate) use sweep::{Paths, between};
pub use view::{Contact, ContactPoint};

/// Shapes have a manifold if they are nearer than this plus the distance by which they approach in the step, m.
pub(crate) const MARGIN: Fx = crate::fx!(0.02);

impl From<&ContactSettings> for SolverOptions {
    fn from(settings: &ContactSettings) -> Self {
        Self {
            substeps: settings.substeps,
            push_speed: settings.push_speed,
            restitution_speed: settings.restitution_speed,
            ..Self::default()
        }
    }
}

/// Returns true if the body of the collider in a slot is asleep.
pub(crate) fn is_asleep<S: Scalar>(bodies: &Bodies<S>, colliders: &ColliderSet<S>, slot: u32) -> bool {
    let dense = colliders.at(slot).and_then(|collider| bodies.find(collider.body).ok());
    dense.is_some_and(|dense| bodies.activity(dense) == Activity::Asleep)
}

/// The limits on pairs. The parts of a compound may all overlap each other: so 128 overlaps for each outline of the world, half of the
/// [`PARTS`] that a compound may have, come on top of the overlaps that go with the number of pairs.
fn pair_limits(settings: &ContactSettings, colliders: &ColliderSet) -> PairLimits {
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
pub(crate) struct Start<S: Scalar = Fx> {
    /// The index of the body in the columns.
    pub(crate) dense: usize,
    pub(crate) body: MovingBody,
    pub(crate) position: Vec2<S::Accumulator>,
    pub(crate) velocity: Vec2<S::Accumulator>,
    pub(crate) angle: S::Angle,
    pub(crate) angular_velocity: S::Accumulator,
    pub(crate) ticks_at_rest: u32,
}

impl<S: Scalar> Start<S> {
    #[inline(always)]
    pub(crate) fn of(bodies: &Bodies<S>, dense: usize, body: &MovingBody) -> Self {
        let motion = &bodies.columns.motion;
        Self {
            dense,
            body: *body,
            position: motion.position.get(dense),
            velocity: motion.velocity.get(dense),
            angle: motion.angle[dense],
            angular_velocity: motion.angular_velocity[dense],
            ticks_at_rest: motion.ticks_at_rest[dense],
        }
    }

    /// The starts in fixed point: the same list in a world of [`Fx`], else copies in `memory`.
    #[allow(clippy::ptr_arg, reason = "a vector can be asked for its type, a slice cannot")]
    pub(crate) fn all_fixed<'a>(starts: &'a Vec<Self>, memory: &'a mut Vec<Start>) -> &'a [Start] {
        if let Some(starts) = (starts as &dyn Any).downcast_ref::<Vec<Start>>() {
            return starts;
        }
        memory.clear();
        memory.extend(starts.iter().map(|start| Start {
            dense: start.dense,
            body: start.body,
            position: start.position.map(|part| part.to_fixed()),
            velocity: start.velocity.map(|part| part.to_fixed()),
            angle: start.angle.to_turn(),
            angular_velocity: start.angular_velocity.to_fixed(),
            ticks_at_rest: start.ticks_at_rest,
        }));
        memory
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

/// The pose in which the path of a body ends before the end of the tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// The index of the body in the columns.
    pub(crate) dense: usize,
    /// The index of its start.
    pub(crate) start: usize,
    pub(crate) position: Vec2<FxAccumulator>,
    pub(crate) angle: Turn,
    /// The moment at which it stops on its own path, in 2^-62 of the step; `None` if another body carries it along.
    pub(crate) at: Option<u64>,
    /// True if a body that does not give way keeps it at the start.
    pub(crate) is_stuck: bool,
}

/// Changes of bodies and colliders; the lists may have duplicates.
#[derive(Debug, Default)]
pub(crate) struct Changed {
    /// The slots of the bodies that fell asleep or woke, or that calls changed in more than their motion.
    pub(crate) bodies: Vec<u32>,
    /// The slots of colliders.
    pub(crate) colliders: Vec<u32>,
    /// The slots of static bodies of which only colliders were added, replaced or removed.
    pub(crate) owners: Vec<u32>,
}

clone_by_field!([] Changed { bodies, colliders, owners });

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
    fn all(&self, colliders: &ColliderSet) -> impl Iterator<Item = u32> {
        let of_bodies = self.bodies.iter().flat_map(|&body| colliders.of_slot(body));
        of_bodies.map(|collider| collider.slot).chain(self.colliders.iter().copied())
    }
}

/// The parts of a world that contacts depend on.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    /// The bodies at the end of their free flight.
    pub(crate) bodies: &'a dyn ContactBodies,
    pub(crate) colliders: &'a ColliderSet,
    /// The contacts of the step before.
    pub(crate) contacts: &'a ContactSet,
    /// The joints, with the impulses of the step before.
    pub(crate) joints: Joined<'a>,
    /// The moving bodies with colliders that meet others or with joints, without bodies at fault.
    pub(crate) starts: &'a [Start],
    /// True if a static body or its colliders may have changed since the last step.
    pub(crate) may_have_moved_statics: bool,
    /// The changes since the contacts were last found; `None` if anything may have changed.
    pub(crate) changed: Option<&'a Changed>,
    pub(crate) settings: &'a ContactSettings,
    pub(crate) time_step: TimeStep,
}

/// The results of detection that keep the contacts from being solved, and the changed colliders.
#[derive(Debug, Default)]
pub(crate) struct Detected {
    pub(crate) touched: Vec<BodyId>,
    pub(crate) crowded: Vec<usize>,
    /// The colliders at rest whose contacts the step tests, however often contacts are detected in it.
    pub(crate) changed_resting: ChangedResting,
}
