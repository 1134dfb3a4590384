//! Floats for tools and drawing.

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::turn::Turn;
use super::wide::FxWide;
use crate::fx::Fx;

/// Conversion of the engine's numbers to doubles, for drawing, tables and studies; never back into the state.
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
    /// The number as a double: the nearest one, ties to even, unless the documentation of a type's implementation says otherwise.
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

/// Infinite from 2^1024 on.
impl ToF64 for FxFactor {
    fn to_f64(self) -> f64 {
        let (mantissa, shift) = self.parts();
        libm::scalbn(mantissa as f64, -shift)
    }
}

/// Radians in [0, [`TAU`](core::f64::consts::TAU)), rounded twice. An angle that would round to `TAU` is 0.
impl ToF64 for Turn {
    fn to_f64(self) -> f64 {
        // The angles within 2^-54 turns of a whole one round to it.
        let turns = self.to_bits() as f64 * (ULP * ULP);
        if turns < 1.0 { turns * core::f64::consts::TAU } else { 0.0 }
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
    /// The value nearest to a double, ties to even; `None` for a NaN or a number that does not fit. For tools alone: floats
    /// differ from machine to machine, and a simulation that takes one in desyncs.
    #[doc(alias("from_f32", "from_f64", "from_num"))]
    #[must_use]
    pub fn from_f64_for_tools(value: f64) -> Option<Self> {
        /// 2^63.
        const END: f64 = 9_223_372_036_854_775_808.0;
        // Scaling by a power of two is exact, and so is the cast within the range.
        let ulps = libm::rint(value / ULP);
        (-END..END).contains(&ulps).then(|| Self::from_bits(ulps as i64))
    }

    /// The single nearest to it, for drawing.
    #[doc(alias("f32", "as_f32"))]
    #[must_use]
    pub fn to_f32(self) -> f32 {
        self.to_bits() as f32 * ULP as f32
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::cases::run_seed;
    use crate::math::Random;
    use crate::scalar::{Accumulator, Angle, Factor};

    #[test]
    fn both_ends_of_the_range_come_back_from_doubles() {
        assert_eq!(Fx::from_f64_for_tools(Fx::MIN.to_f64()), Some(Fx::MIN));
        assert_eq!(Fx::from_f64_for_tools(Fx::MIN.to_f64() * (1.0 + f64::EPSILON)), None);
        // The greatest value rounds up to 2^31, which does not fit.
        assert_eq!(Fx::from_f64_for_tools(Fx::MAX.to_f64()), None);
        let below = Fx::from_f64_for_tools(Fx::MAX.to_f64() * (1.0 - f64::EPSILON / 2.0));
        assert_eq!(below, Some(Fx::from_bits(i64::MAX - 1023)));
    }

    #[test]
    fn angles_are_below_a_whole_turn() {
        for below in 1..5000 {
            let radians = Turn::from_bits(u64::MAX - below + 1).to_f64();
            assert!((0.0..TAU).contains(&radians), "{below}: {radians}");
        }
        assert_eq!(Turn::from_bits(u64::MAX - 2047).to_f64(), TAU * (1.0 - f64::EPSILON / 2.0));
    }

    /// Contacts take floats in fixed point: accumulators and factors to the bit, angles within the rounding of a product with 2π.
    #[test]
    fn floats_go_to_fixed_point_and_come_back() {
        let mut random = Random::seeded(run_seed(1));
        for _ in 0..10_000 {
            let size = libm::scalbn(1.0, random.below(60) as i32 - 30);
            let value = size * (random.below(1 << 32) as f64 / f64::from(1_u32 << 31) - 1.0);
            assert_eq!(<f64 as Accumulator<f64>>::from_fixed(Accumulator::<f64>::to_fixed(value)), value);
            assert_eq!(Factor::<f64>::to_fx_factor(value.abs()).to_f64(), value.abs());
            let angle: f64 = Angle::<f64>::from_radians(value);
            let back = <f64 as Angle<f64>>::from_turn(Angle::<f64>::to_turn(angle));
            assert!((back - angle).abs() < 4e-15, "{angle:e} {back:e}");
        }
        assert_eq!(Accumulator::<f32>::to_fixed(f32::NAN), FxAccumulator::default());
        assert_eq!(Factor::<f32>::to_fx_factor(0.0), FxFactor::ZERO);
    }
}
