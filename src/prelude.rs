//! The names that most programs need: `use umbra_physics::prelude::*`.
//!
//! ```
//! use umbra_physics::prelude::*;
//!
//! let mut world: World = World::new(WorldDef { gravity: vec2(0, fx!(-9.81)), ..WorldDef::default() })?;
//! let shape = Some(Shape::rectangle(fx!(1), fx!(0.5))?);
//! let crate_ = world.add_body(BodyDef { shape, position: vec2(0, 5), ..BodyDef::dynamic() })?;
//! world.step();
//! assert!(world.body(crate_)?.position().y < fx!(5));
//! # Ok::<(), Error>(())
//! ```

pub use crate::{
    Attachment, BodyDef, BodyId, BodyKind, Command, End, Error, Event, FieldId, FieldKind, ForceField, Fx, FxFactor,
    History, Input, Inputs, Integrator, Locks, Mass, Rot, Shape, SpringConstants, TimeStep, Turn, Vec2, World,
    WorldDef, fx, vec2,
};
