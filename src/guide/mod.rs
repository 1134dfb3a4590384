//! Guide to the engine. Each chapter can be read by itself, and its examples run as tests.
//!
//! | chapter | contents |
//! |---|---|
//! | [`games`] | first tasks in a platformer, a puzzle, a shooter and an RTS; symptoms, causes and remedies |
//! | [`numbers`] | fixed point in five minutes: exactness, overflow, angles |
//! | [`accuracy`] | choosing an integrator, a tick rate, damping and spring stiffness |
//! | [`determinism`] | causes of desyncs in *your* code, and how to find them |
//! | [`bodies`] | moving platforms, locks, speed limits, disabling, local points, hits, keys, sprites, energy and momentum |
//! | [`lockstep`] | peers that exchange only inputs; comparing hashes, and finding the difference |
//! | [`rollback`] | handling late inputs: going back and recomputing the present |
//! | [`collisions`] | colliders, materials, filters, sensors, events, stacks, fast bodies, explosions, fluids, and a table of cases |
//! | [`joints`] | hinges, sliders, wheels, rods, ropes and welds; limits, motors, springs; breaking; a table of cases |
//! | [`queries`] | rays, shape casts, overlaps, closest points, and in which order they are found |
//! | [`character`] | characters that walk, climb, ride and push |
//! | [`replays`] | recording, and verifying replays from untrusted players on a server |
//! | [`frames`] | frame times to ticks, poses between ticks, drawing, events |
//! | [`engines`] | keeping entities in step with bodies, with `bevy_ecs` as an example |
//! | [`languages`] | using the library from C, C# and other languages, and in the browser |
//! | [`migration`] | moving from Box2D, Rapier or pymunk: first lines, calls, units, conventions |
//!
//! The [README](https://docs.rs/crate/umbra-physics) is the overview, `examples` has whole programs, and `docs/design.md` explains the
//! design.

#[doc = include_str!("accuracy.md")]
pub mod accuracy {}
#[doc = include_str!("bodies.md")]
pub mod bodies {}
#[doc = include_str!("character.md")]
pub mod character {}
#[doc = include_str!("collisions.md")]
pub mod collisions {}
#[doc = include_str!("determinism.md")]
pub mod determinism {}
#[doc = include_str!("engines.md")]
pub mod engines {}
#[doc = include_str!("frames.md")]
pub mod frames {}
#[doc = include_str!("games.md")]
pub mod games {}
#[doc = include_str!("joints.md")]
pub mod joints {}
#[doc = include_str!("languages.md")]
pub mod languages {}
#[doc = include_str!("lockstep.md")]
pub mod lockstep {}
#[doc = include_str!("migration.md")]
pub mod migration {}
#[doc = include_str!("numbers.md")]
pub mod numbers {}
#[doc = include_str!("queries.md")]
pub mod queries {}
#[doc = include_str!("replays.md")]
pub mod replays {}
#[doc = include_str!("rollback.md")]
pub mod rollback {}
