//! Vectors, rotations and the time step.

mod random;
mod rot;
mod time;
mod vec2;

pub use random::Random;
pub use rot::Rot;
pub use time::{Elapsed, TimeStep};
pub use vec2::{Vec2, vec2};
