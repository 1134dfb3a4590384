//! Everything a display needs of a world: the number of ticks for a frame of real time, poses between two ticks, and
//! outlines to draw. Nothing here is state, and the floats that leave here never come back.

#[cfg(feature = "draw")]
mod draw;
#[cfg(feature = "draw")]
mod interpolation;
#[cfg(feature = "draw")]
mod outline;
#[cfg(feature = "draw")]
mod pose;
mod step_clock;

#[cfg(feature = "draw")]
pub use draw::{BodyClass, DebugDraw, DrawOptions, Role};
#[cfg(feature = "draw")]
pub use interpolation::{Blend, Interpolation};
#[cfg(feature = "draw")]
pub use pose::Pose;
pub use step_clock::{StepClock, StepsDue, TickFraction};
