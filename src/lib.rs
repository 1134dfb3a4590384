//! Deterministic 2D rigid-body physics in fixed point: the same bits on every machine, in every build.
//!
//! A [`World`] holds bodies and force fields and moves them tick by tick. Its state is I32F32 fixed point ([`Fx`]) with
//! finer fractions where remainders are carried, so that lockstep, rollback and replays agree to the bit.
//!
//! ```
//! use umbra_physics::{BodyDef, Mass, Shape, TimeStep, Vec2, World, WorldDef, fx, vec2};
//!
//! let mut world = World::new(WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, -10), ..WorldDef::default() })?;
//! let ball = world.add_body(BodyDef {
//!     shape: Some(Shape::circle(fx!(0.5))?),
//!     mass: Mass::Density(fx!(1)),
//!     position: vec2(0, 10),
//!     ..BodyDef::dynamic()
//! })?;
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
//! The [guide] has a chapter each on [numbers](guide::numbers), [accuracy](guide::accuracy), [bodies](guide::bodies),
//! [determinism](guide::determinism) of your own code, [lockstep](guide::lockstep), [rollback](guide::rollback),
//! [replays](guide::replays), [frames](guide::frames) and drawing, [engines](guide::engines), [other languages](guide::languages),
//! and on [coming from Box2D or Rapier](guide::migration).
#![no_std]
#![cfg_attr(not(all(feature = "std", target_arch = "x86_64")), forbid(unsafe_code))]
#![deny(unsafe_code)]
#![warn(missing_docs)]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;
// What tests in `tests` share with those beside the code names the crate as they do.
#[cfg(test)]
extern crate self as umbra_physics;

/// `Clone` field by field, also for `clone_from`, which a derive does not hand on: it reuses the memory that is there.
macro_rules! clone_by_field {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl<S: crate::scalar::Scalar> Clone for $type<S> {
            fn clone(&self) -> Self {
                Self { $($field: self.$field.clone()),* }
            }

            fn clone_from(&mut self, source: &Self) {
                $(self.$field.clone_from(&source.$field);)*
            }
        }
    };
}

mod body;
mod display;
mod error;
mod force;
// Documentation alone: there is no such module in what is built.
mod codec;
#[cfg(any(doc, doctest))]
pub mod guide;
mod handle;
mod integrate;
mod island;
mod kernel;
pub mod limits;
mod math;
#[cfg(feature = "oracles")]
pub mod oracle;
mod replay;
pub mod scalar;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "selftest")]
pub mod selftest;
mod shape;
mod step;
mod world;

pub use body::{Activity, BodyDef, BodyKind, Locks, Mass};
pub use codec::Malformed;
#[cfg(feature = "float")]
pub use display::{Blend, BodyClass, DebugDraw, DrawOptions, Interpolation, Pose, Role};
pub use display::{StepClock, StepsDue, TickFraction};
pub use error::{Cause, Error, Fault, Irreversible, Quantity};
pub use force::{
    AppliedForce, Attachment, BodyState, CustomForce, CustomForceError, Dependence, End, FieldKind, ForceField,
    ForceTorque, Region,
};
pub use handle::{BodyId, FieldId};
pub use integrate::{Integrator, Stage, StageKind};
pub use math::{Elapsed, Random, Rot, TimeStep, Vec2, vec2};
pub use replay::{
    Difference, Divergence, Dump, Finding, HashTree, Owner, PHYSICS_VERSION, Playback, RecordOptions, Recorder, Replay,
    ReplayError, ReplayLimits, Snapshot, SnapshotError, TickPhase, VerifyError,
};
pub use scalar::fx::{Fx, MathError, ParseFxError};
pub use scalar::{FxAccumulator, FxFactor, FxWide, Scalar, SpringConstants, Turn};
pub use shape::{Geometry, Part, Shape};
#[cfg(feature = "timers")]
pub use step::Timers;
pub use world::{
    ApplyOptions, BodyRef, Command, Created, Event, ForceOrImpulse, Frame, History, Input, InputResult, Inputs,
    InputsIter, Preview, StepReport, Stepper, TickReport, Trace, World, WorldDef, step_all,
};

/// The README's examples, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
