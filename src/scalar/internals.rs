//! Internals for this crate's own tests, benches and fuzz targets. No part of the public interface: they change without notice.

pub use super::bulk::{Bulk, DampedTurn, KickDriftKick};
pub use super::forces::Forces;
pub use super::motion::{Decay, FxDecayRate, Motion, Span, Weight};
// Without it nothing outside implements a scalar.
#[cfg(feature = "selftest")]
pub use super::number::Number;
pub use super::number::{Arithmetic, Compiled, Sum};
pub use super::polygon::{AreaMoments, Polygons};
pub use crate::kernel::simd::VectorSet;
