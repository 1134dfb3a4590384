//! Everything a display needs of a world: the number of ticks for a frame of real time, poses between two ticks, and
//! outlines to draw. Nothing here is state, and the floats that leave here never come back.

#[cfg(feature = "float")]
mod draw;
#[cfg(feature = "float")]
mod interpolation;
#[cfg(feature = "float")]
mod outline;
#[cfg(feature = "float")]
mod pose;
mod step_clock;

#[cfg(feature = "float")]
pub use draw::{BodyClass, DebugDraw, DrawOptions, Role};
#[cfg(feature = "float")]
pub use interpolation::{Blend, Interpolation};
#[cfg(feature = "float")]
pub use pose::Pose;
pub use step_clock::{StepClock, StepsDue, TickFraction};
