//! The exact reference: arbitrary precision, and the engine's numbers in it without loss.

// Each test takes what it needs.
#![allow(dead_code, reason = "each test that takes this file in uses a part of it")]

use std::sync::LazyLock;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::IBig;
use umbra_physics::{Fx, FxFactor};

pub(crate) type Real = FBig<HalfEven, 2>;

/// Bits carried: about 1e-48 relative, so that a reference is exact beside anything the engine keeps.
pub(crate) const PRECISION: usize = 160;

/// 2π.
pub(crate) static TAU: LazyLock<Real> = LazyLock::new(|| real(1).asin() * real(4));

/// value · 2^-fraction.
pub(crate) fn units(value: impl Into<IBig>, fraction: isize) -> Real {
    Real::from(value.into()).with_precision(PRECISION).value() >> fraction
}

/// A scalar, exactly.
pub(crate) fn exact(value: Fx) -> Real {
    units(value.to_bits(), 32)
}

pub(crate) fn real(value: i64) -> Real {
    units(value, 0)
}

pub(crate) fn ratio(num: i64, den: i64) -> Real {
    real(num) / real(den)
}

/// mantissa · 2^-shift.
pub(crate) fn factor(value: FxFactor) -> Real {
    let (mantissa, shift) = value.parts();
    if shift >= 0 { units(mantissa, shift as isize) } else { units(mantissa, 0) << shift.unsigned_abs() as isize }
}

/// For what is measured, not for what is compared to the bit.
pub(crate) fn to_f64(value: &Real) -> f64 {
    value.to_f64().value()
}
