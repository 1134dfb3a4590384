//! Deterministic 2D rigid-body physics in fixed point: the same bits on every machine, in every build.
//!
//! A [`World`] holds bodies, colliders and force fields and steps them tick by tick. Its state is I32F32 fixed point ([`Fx`]), with
//! finer fractions that carry the remainders of each step, so that lockstep, rollback and replays agree to the bit.
//!
//! Bodies touch each other with their [colliders](ColliderDef); [joints](JointDef) and springs hold them together.
//!
//! ```
//! use umbra_physics::{BodyDef, Shape, TimeStep, World, WorldDef, fx, vec2};
//!
//! let mut world = World::new(WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, -10), ..WorldDef::default() })?;
//! world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(50, 1)?))?;
//! let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?);
//! let ball = world.add_body(BodyDef { position: vec2(0, 10), ..ball })?;
//! for _ in 0..60 {
//!     world.step();
//! }
//! // After a second it has fallen ½·10·1² = 5 m, exactly.
//! assert_eq!(world.body(ball)?.position(), vec2(0, 5));
//! # Ok::<(), umbra_physics::Error>(())
//! ```
//!
//! Units are m, kg, s and rad. One ulp is 2^-32 of them, and error bounds are given in ulps.
//!
//! The [guide] begins with the first tasks of some kinds of [games](guide::games), and has chapters on [numbers](guide::numbers),
//! [accuracy](guide::accuracy), [bodies](guide::bodies), [collisions](guide::collisions), [joints](guide::joints), [queries](guide::queries),
//! [characters](guide::character), [determinism](guide::determinism) of your own code, [lockstep](guide::lockstep),
//! [rollback](guide::rollback), [replays](guide::replays), [frames](guide::frames) and drawing, [engines](guide::engines), [other
//! languages](guide::languages), and on [coming from Box2D or Rapier](guide::migration).
#![no_std]
#![cfg_attr(
    not(any(
        all(feature = "std", target_arch = "x86_64"),
        all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"),
        all(target_arch = "wasm32", target_feature = "simd128")
    )),
    forbid(unsafe_code)
)]
#![deny(unsafe_code)]
#![warn(missing_docs)]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;
// Test code shared with `tests` names the crate as `umbra_physics`.
#[cfg(test)]
extern crate self as umbra_physics;

/// Implements `Clone` field by field. Unlike a derive it also implements `clone_from`, which reuses memory.
///
/// A list in brackets has the generic parameters; without a list the type has a scalar. The form `(clone, clone_from)` names functions of
/// [`compiled`] that the impl calls, for types with much to clone.
macro_rules! clone_by_field {
    ($type:ident { $($field:ident),* $(,)? }) => {
        clone_by_field!([S: crate::scalar::Scalar] $type<S> { $($field),* });
    };
    ([$($parameters:tt)*] $type:ty { $($field:ident),* $(,)? }) => {
        impl<$($parameters)*> Clone for $type {
            fn clone(&self) -> Self {
                Self { $($field: self.$field.clone()),* }
            }

            fn clone_from(&mut self, source: &Self) {
                $(self.$field.clone_from(&source.$field);)*
            }
        }
    };
    (($clone:ident, $clone_from:ident) $type:ident { $($field:ident),* $(,)? }) => {
        impl<S: crate::scalar::Scalar> Clone for $type<S> {
            fn clone(&self) -> Self {
                S::$clone(self)
            }

            fn clone_from(&mut self, source: &Self) {
                S::$clone_from(self, source);
            }
        }

        impl<S: crate::scalar::Scalar> $type<S> {
            pub(crate) fn clone_inner(&self) -> Self {
                Self { $($field: self.$field.clone()),* }
            }

            pub(crate) fn clone_from_inner(&mut self, source: &Self) {
                $(self.$field.clone_from(&source.$field);)*
            }
        }
    };
}

mod body;
#[cfg(test)]
#[path = "../tests/support/cases.rs"]
mod cases;
mod character;
mod codec;
mod codes;
mod collider;
// The broad and the narrow phase. Public for the benchmarks alone, and no part of the interface.
#[doc(hidden)]
pub mod collide;
mod compiled;
mod contact;
mod display;
mod error;
mod force;
mod fx;
// Documentation only: ordinary builds do not contain this module.
#[cfg(any(doc, doctest))]
pub mod guide;
mod integrate;
mod island;
mod joint;
mod kernel;
pub mod limits;
mod math;
mod query;
mod replay;
pub mod scalar;
#[cfg(feature = "selftest")]
pub mod selftest;
mod shape;
mod slots;
// The contact solver, likewise.
#[doc(hidden)]
pub mod solve;
mod step;
mod symmetry;
mod timers;
mod world;

pub use body::{Activity, BodyDef, BodyKind, Damping, Locks, Mass};
pub use character::{Character, CharacterHit, Ground, Movement};
pub use codec::Malformed;
pub use collide::impact::{ShapeImpact, Sweep};
pub use collider::{ColliderDef, ContactSettings, Filter, Material, MaterialPair, MixRule, OneWay};
pub use contact::{ColliderPair, Contact, ContactHit, ContactPoint, Exclusion};
#[cfg(feature = "draw")]
pub use display::{Blend, BodyClass, DebugDraw, DrawOptions, Interpolation, Pose, Role};
pub use display::{StepClock, StepsDue, TickFraction};
pub use error::{Cause, Dimension, Error, Fault, Irreversible, Quantity};
pub use force::{
    AppliedForce, Attachment, BodyState, CustomForce, CustomForceError, Dependence, End, FieldKind, ForceField,
    ForceTorque, Region,
};
pub use fx::{Fx, IntoFx, MathError, ParseFxError};
pub use integrate::{Integrator, Stage, StageKind};
pub use joint::{
    Distance, Gear, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Motor, PlanarMotor, PlanarSpring,
    Prismatic, Pulley, Revolute, Weld, Wheel,
};
pub use math::{Elapsed, Random, Rot, TimeStep, Vec2, vec2};
pub use query::{ShapeDistance, ShapeHit};
pub use replay::{
    Difference, Divergence, Dump, HashTree, Labels, Owner, PHYSICS_VERSION, Playback, RecordOptions, Recorder, Replay,
    ReplayError, ReplayLimits, Snapshot, SnapshotError, TickPhase, VerifyError,
};
pub use scalar::{FxAccumulator, FxFactor, FxWide, Scalar, SpringConstants, Turn};
pub use shape::{Aabb, Geometry, Outline, Part, Shape};
pub use slots::{BodyId, ColliderId, FieldId, JointId};
pub use step::{JointBroke, JointLoad};
pub use symmetry::Symmetry;
#[cfg(feature = "timers")]
pub use timers::{StepCounts, StepTimes, Timers};
pub use world::{
    ApplyOptions, BodyIter, BodyRef, CastHit, ClosestPoint, Command, CommandMap, CommandSource, ConfirmedTick, Created,
    Event, EventStatus, Explosion, ForceOrImpulse, Frame, Input, InputResult, Inputs, InputsIter, JointRef, Preview,
    Queries, QueryFilter, Rollback, RollbackReport, StepReport, Stepper, TickEvent, Trace, World, WorldDef, step_all,
};

/// The names that most programs need: `use umbra_physics::prelude::*`.
///
/// ```
/// use umbra_physics::prelude::*;
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, fx!(-9.81)), ..WorldDef::default() })?;
/// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(50, 1)?))?;
/// let crate_ = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.5))?);
/// let crate_ = world.add_body(BodyDef { position: vec2(0, 5), ..crate_ })?;
/// (0..120).for_each(|_| _ = world.step());
/// assert_eq!(format!("{:.2}", world.body(crate_)?.position().y), "0.75");
/// # Ok::<(), Error>(())
/// ```
pub mod prelude {
    pub use crate::{
        Attachment, BodyDef, BodyId, BodyKind, Character, ColliderDef, ColliderId, Command, ContactSettings, Damping,
        End, Error, Event, Exclusion, Explosion, FieldId, FieldKind, Filter, ForceField, Fx, FxFactor, Input, Inputs,
        Integrator, Locks, Mass, Material, OneWay, QueryFilter, Rollback, Rot, Shape, SpringConstants, TimeStep, Turn,
        Vec2, World, WorldDef, fx, vec2,
    };
}

/// The README's examples, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
