//! A guide, chapter by chapter: each can be read by itself, and its examples run as tests.
//!
//! | chapter | for |
//! |---|---|
//! | [`numbers`] | fixed point in five minutes: what a number is, what does not fit, angles |
//! | [`accuracy`] | which integrator, how many ticks a second, damping, how stiff a spring may be |
//! | [`determinism`] | what makes two machines part in *your* code, and how to find it |
//! | [`bodies`] | moving platforms, rails, caps, out of play, points of a body, keys, sprites that follow, totals |
//! | [`lockstep`] | peers that send inputs alone: hashes, and what to do when they differ |
//! | [`rollback`] | inputs that arrive late: going back, and to the present again |
//! | [`replays`] | recording, and verifying on a server what strangers send |
//! | [`frames`] | a clock's nanoseconds to ticks, poses between ticks, drawing, events |
//! | [`engines`] | entities that follow bodies, as with `bevy_ecs` |
//! | [`languages`] | from C, C# and other languages, and in the browser |
//! | [`migration`] | coming from Box2D or Rapier: their calls and ours, units, conventions |
//!
//! The [README](https://docs.rs/crate/umbra-physics) has what there is, `examples` whole programs, `docs/design.md` explains how
//! it is built.

#[doc = include_str!("accuracy.md")]
pub mod accuracy {}
#[doc = include_str!("bodies.md")]
pub mod bodies {}
#[doc = include_str!("determinism.md")]
pub mod determinism {}
#[doc = include_str!("engines.md")]
pub mod engines {}
#[doc = include_str!("frames.md")]
pub mod frames {}
#[doc = include_str!("languages.md")]
pub mod languages {}
#[doc = include_str!("lockstep.md")]
pub mod lockstep {}
#[doc = include_str!("migration.md")]
pub mod migration {}
#[doc = include_str!("numbers.md")]
pub mod numbers {}
#[doc = include_str!("replays.md")]
pub mod replays {}
#[doc = include_str!("rollback.md")]
pub mod rollback {}
