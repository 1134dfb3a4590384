//! Vectors, rotations, the time step and random numbers: structure and operators, without any scalar but `Fx`.

mod geometry;
#[cfg(feature = "mint")]
mod mint;
mod random;
mod rot;
#[cfg(feature = "serde")]
mod serial;
mod time;
mod vec2;

pub use random::Random;
pub use rot::Rot;
pub(crate) use time::gcd;
pub use time::{Elapsed, TimeStep};
pub use vec2::{Vec2, vec2};
