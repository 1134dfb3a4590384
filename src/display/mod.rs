//! What a display asks of a world: how many ticks a frame of real time takes.

mod pacer;

pub use pacer::{Due, Pacer, TickFraction};
