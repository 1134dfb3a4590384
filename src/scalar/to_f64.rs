//! Floats for tools and drawing.

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::turn::Turn;
use super::wide::FxWide;
use crate::fx::Fx;

/// The double nearest to a number of the engine, for drawing, tables and studies; never back into the state.
///
/// ```
/// use umbra_physics::scalar::ToF64;
/// use umbra_physics::{Fx, Turn, fx};
///
/// fn draw(x: impl ToF64, y: impl ToF64) -> (f64, f64) {
///     (x.to_f64(), y.to_f64())
/// }
/// assert_eq!(draw(fx!(-2.5), fx!(0.25)), (-2.5, 0.25));
/// assert_eq!(fx!(0.1).to_f32(), 0.1); // for drawing
/// assert_eq!(Turn::QUARTER.to_f64(), std::f64::consts::FRAC_PI_2);
/// // The way in is for tools alone: a level editor that writes decimals, say.
/// assert_eq!(Fx::from_f64_for_tools(0.1), Some(fx!(0.1)));
/// assert_eq!(Fx::from_f64_for_tools(f64::NAN), None);
/// ```
pub trait ToF64 {
    /// The double nearest to it; where more than 53 bits are cut, by one rounding of what `as` does.
    fn to_f64(self) -> f64;
}

/// 2^-32, 2^-64 and 2^-96, exactly.
const ULP: f64 = 1.0 / 4_294_967_296.0;

impl ToF64 for Fx {
    fn to_f64(self) -> f64 {
        self.to_bits() as f64 * ULP
    }
}

impl ToF64 for FxAccumulator {
    fn to_f64(self) -> f64 {
        self.to_bits() as f64 * (ULP * ULP * ULP)
    }
}

impl ToF64 for FxWide {
    fn to_f64(self) -> f64 {
        self.to_bits() as f64 * (ULP * ULP)
    }
}

impl ToF64 for FxFactor {
    fn to_f64(self) -> f64 {
        let (mantissa, shift) = self.parts();
        libm::scalbn(mantissa as f64, -shift)
    }
}

/// Radians in [0, 2π).
impl ToF64 for Turn {
    fn to_f64(self) -> f64 {
        self.to_bits() as f64 * (ULP * ULP) * core::f64::consts::TAU
    }
}

impl ToF64 for f32 {
    fn to_f64(self) -> f64 {
        self.into()
    }
}

impl ToF64 for f64 {
    fn to_f64(self) -> f64 {
        self
    }
}

impl Fx {
    /// The value nearest to a double, ties to even; `None` for what is no number or does not fit. For tools: a float that
    /// gets into a simulation is a desync waiting for its machine.
    #[must_use]
    pub fn from_f64_for_tools(value: f64) -> Option<Self> {
        // Scaling by a power of two is exact; below 2^63 so is the cast.
        let ulps = libm::rint(value / ULP);
        (libm::fabs(ulps) < 9_223_372_036_854_775_808.0).then(|| Self::from_bits(ulps as i64))
    }

    /// The single nearest to it, for drawing.
    #[must_use]
    pub fn to_f32(self) -> f32 {
        self.to_bits() as f32 * ULP as f32
    }
}
