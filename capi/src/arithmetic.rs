//! The arithmetic of numbers, as in Rust: rounded to nearest, ties to even, and refused where the result does not fit. A number that a
//! match depends on has the same bits on every machine.

use std::mem::MaybeUninit;

use umbra_physics::Fx;

use crate::memory::given;
use crate::number::UmbraFx;
use crate::status::{Refusal, Result, UMBRA_ERROR_MATH_NOT_POSITIVE, UMBRA_ERROR_MATH_OVERFLOW, UmbraStatus, guard};

/// Hands on a result.
fn write(place: Option<&mut MaybeUninit<UmbraFx>>, result: impl FnOnce() -> Result<Fx>) -> UmbraStatus {
    guard(|| {
        given(place)?.write(result()?.to_bits());
        Ok(())
    })
}

/// A result of a checked function, which has none if it does not fit.
fn fitting(result: Option<Fx>) -> Result<Fx> {
    result.ok_or_else(|| Refusal::own(UMBRA_ERROR_MATH_OVERFLOW, "the value does not fit in I32F32"))
}

fn divisor(bits: UmbraFx) -> Result<Fx> {
    let divisor = Fx::from_bits(bits);
    if divisor == Fx::ZERO {
        return Err(Refusal::own(UMBRA_ERROR_MATH_NOT_POSITIVE, "division by zero"));
    }
    Ok(divisor)
}

/// The ratio of two integers, rounded to nearest, ties to even: 1 and 3 for a third. `UMBRA_ERROR_MATH_NOT_POSITIVE` if `den` is 0,
/// `UMBRA_ERROR_MATH_OVERFLOW` if the ratio does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_from_ratio(num: i64, den: i64, ratio: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(ratio, || {
        divisor(den)?;
        fitting(Fx::checked_from_ratio(num, den))
    })
}

/// The sum a + b. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_add(a: UmbraFx, b: UmbraFx, sum: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(sum, || fitting(Fx::from_bits(a).checked_add(Fx::from_bits(b))))
}

/// The difference a - b. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_sub(a: UmbraFx, b: UmbraFx, difference: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(difference, || fitting(Fx::from_bits(a).checked_sub(Fx::from_bits(b))))
}

/// The product a·b, rounded to nearest, ties to even. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_mul(a: UmbraFx, b: UmbraFx, product: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(product, || fitting(Fx::from_bits(a).checked_mul(Fx::from_bits(b))))
}

/// The quotient a/b, rounded to nearest, ties to even. `UMBRA_ERROR_MATH_NOT_POSITIVE` if b is 0, `UMBRA_ERROR_MATH_OVERFLOW` if the
/// quotient does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_div(a: UmbraFx, b: UmbraFx, quotient: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(quotient, || fitting(Fx::from_bits(a).checked_div(divisor(b)?)))
}

/// The remainder of a/b, exactly, from 0 to below the magnitude of b. `UMBRA_ERROR_MATH_NOT_POSITIVE` if b is 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_rem_euclid(
    a: UmbraFx,
    b: UmbraFx,
    remainder: Option<&mut MaybeUninit<UmbraFx>>,
) -> UmbraStatus {
    write(remainder, || Ok(Fx::from_bits(a).rem_euclid(divisor(b)?)))
}

/// The square root, the nearest value. `UMBRA_ERROR_MATH_NOT_POSITIVE` below 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_sqrt(number: UmbraFx, root: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(root, || {
        let root = Fx::from_bits(number).checked_sqrt();
        root.ok_or_else(|| Refusal::own(UMBRA_ERROR_MATH_NOT_POSITIVE, "the square root of a negative number"))
    })
}

/// The length of the vector (x, y), the nearest value. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_hypot(x: UmbraFx, y: UmbraFx, length: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(length, || fitting(Fx::from_bits(x).checked_hypot(Fx::from_bits(y))))
}

/// The sine of an angle in radians, within 0.5001 ulp.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_sin(angle: UmbraFx, sine: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(sine, || Ok(Fx::from_bits(angle).sin()))
}

/// The cosine of an angle in radians, within 0.5001 ulp.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_cos(angle: UmbraFx, cosine: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(cosine, || Ok(Fx::from_bits(angle).cos()))
}

/// The angle of the vector (x, y) from the x axis in radians, counter-clockwise, from -π to π, within 0.5001 ulp; 0 for the zero vector.
/// y comes first, as in C.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_atan2(y: UmbraFx, x: UmbraFx, angle: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(angle, || Ok(Fx::from_bits(y).atan2(Fx::from_bits(x))))
}

/// The binary logarithm, within 0.5001 ulp. `UMBRA_ERROR_MATH_NOT_POSITIVE` for 0 and below.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_log2(number: UmbraFx, logarithm: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(logarithm, || Ok(Fx::from_bits(number).log2()?))
}

/// The power of two, within 0.5001 ulp. `UMBRA_ERROR_MATH_OVERFLOW` from 31 on.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_exp2(exponent: UmbraFx, power: Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus {
    write(power, || Ok(Fx::from_bits(exponent).exp2()?))
}

/// The power of a base above 0, within 0.5001 ulp. `UMBRA_ERROR_MATH_NOT_POSITIVE` for a base of 0 and below,
/// `UMBRA_ERROR_MATH_OVERFLOW` if the power does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_fx_pow(
    base: UmbraFx,
    exponent: UmbraFx,
    power: Option<&mut MaybeUninit<UmbraFx>>,
) -> UmbraStatus {
    write(power, || Ok(Fx::from_bits(base).pow(Fx::from_bits(exponent))?))
}
