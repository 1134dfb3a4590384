//! Integers of any size: directions of angles, dot products, quotients by roots.

use std::f64::consts::PI;
use std::sync::LazyLock;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::IBig;
use dashu_int::ops::{SquareRoot as _, UnsignedAbs as _};
use umbra_physics::{Turn, Vec2};

/// A vector in units of 2^-32 ulp.
pub(crate) type Vector = [IBig; 2];

/// Bits after an ulp.
pub(crate) const FRACTION: usize = 32;
/// Bits of sines and cosines.
const SINE: usize = 160;

/// (sin, cos) of byte·2^(8·place − 64) turns, in units of 2^-160.
static DIRECTIONS: LazyLock<Vec<Vec<[IBig; 2]>>> = LazyLock::new(|| {
    type Real = FBig<HalfEven, 2>;
    let real = |mantissa: i32, exponent: isize| Real::from_parts(mantissa.into(), exponent).with_precision(220).value();
    let turn = real(4, 0) * real(1, 0).asin();
    assert!((turn.to_f64().value() - 2.0 * PI).abs() < 1e-15);
    let direction = |byte, place| {
        let (sin, cos) = (real(byte, 8 * place - 64) * &turn).sin_cos();
        [sin, cos].map(|part| (part << SINE as isize).round().to_int().value())
    };
    (0..8isize).map(|place| (0..256).map(|byte| direction(byte, place)).collect()).collect()
});

/// `a / 2^by` to nearest, ties up.
fn shifted(a: IBig, shift: usize) -> IBig {
    (a + (IBig::ONE << (shift - 1))) >> shift
}

/// Sine and cosine of an angle in units of 2^-160, within some units; exact for quarter turns.
pub(crate) fn direction(angle: Turn) -> [IBig; 2] {
    let [mut sin, mut cos] = [IBig::ZERO, IBig::ONE << SINE];
    for (table, byte) in DIRECTIONS.iter().zip(angle.to_bits().to_le_bytes()) {
        if byte != 0 {
            let [s, c] = &table[usize::from(byte)];
            [sin, cos] = [&sin * c + &cos * s, &cos * c - &sin * s].map(|part| shifted(part, SINE));
        }
    }
    [sin, cos]
}

/// A vector turned.
pub(crate) fn turned(v: Vec2, [sin, cos]: &[IBig; 2]) -> Vector {
    let (x, y) = (IBig::from(v.x.to_bits()), IBig::from(v.y.to_bits()));
    [&x * cos - &y * sin, &x * sin + &y * cos].map(|part| shifted(part, SINE - FRACTION))
}

pub(crate) fn sub(a: &Vector, b: &Vector) -> Vector {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

pub(crate) fn sum(a: &Vector, b: &Vector) -> Vector {
    [&a[0] + &b[0], &a[1] + &b[1]]
}

pub(crate) fn negated(a: &Vector) -> Vector {
    [-&a[0], -&a[1]]
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1]
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[1] - &a[1] * &b[0]
}

/// Turned by a quarter counter-clockwise.
pub(crate) fn across(a: &Vector) -> Vector {
    [-&a[1], a[0].clone()]
}

/// A double with 52 correct bits and the exact sign.
pub(crate) fn float(a: &IBig) -> f64 {
    a.to_f64().value()
}

/// A length in units of 2^-32 ulp, in ulps.
pub(crate) fn ulps(a: &IBig) -> f64 {
    float(a) / 2f64.powi(FRACTION as i32)
}

/// a / √square, rounded towards zero.
pub(crate) fn over_root(a: &IBig, square: &IBig) -> IBig {
    let root = IBig::from((a * a / square).unsigned_abs().sqrt());
    if *a < IBig::ZERO { -root } else { root }
}

/// The sign of a / √p + b / √q as a double of that sign.
pub(crate) fn sum_over_roots([a, p]: [&IBig; 2], [b, q]: [&IBig; 2]) -> f64 {
    let sum = float(a) / float(p).sqrt() + float(b) / float(q).sqrt();
    let is_negative = |x: &IBig| *x < IBig::ZERO;
    if is_negative(a) == is_negative(b) || *a == IBig::ZERO || *b == IBig::ZERO {
        return sum;
    }
    // Opposite signs: the larger square decides.
    match (a * a * q).cmp(&(b * b * p)) {
        std::cmp::Ordering::Equal => 0.0,
        order => sum.abs().max(f64::MIN_POSITIVE) * if is_negative(a) == order.is_gt() { -1.0 } else { 1.0 },
    }
}
