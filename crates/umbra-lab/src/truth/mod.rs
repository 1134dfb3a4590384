//! Exact references: arbitrary precision, the engine's numbers in it without loss, and the motion that errors are measured against.

mod closed;
mod equations;
mod plane;

use std::sync::LazyLock;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::IBig;
use umbra_physics::{Fx, FxAccumulator, FxFactor, Turn};

pub(crate) use closed::{Closed, closed};
pub(crate) use equations::{Equations, solve};

/// A number with as many bits as it was made with.
pub(crate) type Real = FBig<HalfEven, 2>;

/// Bits of a solution: 3e-39 relative, far below what the engine keeps. Twice a machine word is also what is fast.
pub(crate) const BITS: usize = 128;
/// Bits of the second solution by a formula, which says how good the first is.
pub(crate) const MORE_BITS: usize = 192;

/// 2π.
pub(crate) static TAU: LazyLock<Real> = LazyLock::new(|| real(1).with_precision(MORE_BITS).value().asin() * real(4));

/// value · 2^-fraction.
fn units(value: impl Into<IBig>, fraction: isize) -> Real {
    Real::from(value.into()).with_precision(BITS).value() >> fraction
}

pub(crate) fn real(value: i64) -> Real {
    units(value, 0)
}

pub(crate) fn to_f64(value: &Real) -> f64 {
    value.to_f64().value()
}

/// A number of the engine's, without loss. Angles are in rad.
pub(crate) trait Exact {
    fn exact(self) -> Real;
}

impl Exact for Fx {
    fn exact(self) -> Real {
        units(self.to_bits(), 32)
    }
}

impl Exact for FxAccumulator {
    fn exact(self) -> Real {
        units(self.to_bits(), 96)
    }
}

impl Exact for FxFactor {
    fn exact(self) -> Real {
        let (mantissa, shift) = self.parts();
        units(mantissa, shift as isize)
    }
}

impl Exact for Turn {
    fn exact(self) -> Real {
        units(self.to_bits(), 64) * &*TAU
    }
}

macro_rules! exact_float {
    ($($float:ident),*) => {$(
        impl Exact for $float {
            /// *Domain* finite, as all that a world holds.
            fn exact(self) -> Real {
                Real::try_from(self).map_or_else(|_| real(0), |value| value.with_precision(BITS).value())
            }
        }
    )*};
}

exact_float!(f64, f32);

#[cfg(test)]
mod tests {
    use umbra_physics::fx;

    use super::*;

    #[test]
    fn numbers_of_the_engine_keep_their_value() {
        for (value, expected) in [
            (fx!(-2.75).exact(), -2.75),
            (FxAccumulator::from_bits(-3 << 95).exact(), -1.5),
            (FxFactor::from_ratio(3, 1 << 40).exact(), 3.0 / (1u64 << 40) as f64),
            (FxFactor::from_ratio(1 << 40, 1).exact(), (1u64 << 40) as f64),
            (Turn::QUARTER.exact(), core::f64::consts::FRAC_PI_2),
            (0.1f32.exact(), f64::from(0.1f32)),
            ((-1e-300f64).exact(), -1e-300),
        ] {
            assert_eq!(to_f64(&value), expected);
        }
    }
}
