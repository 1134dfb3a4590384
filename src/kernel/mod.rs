//! Numeric kernels on raw integers: no trait, no number type, no float, no allocation.
//!
//! Q notation: `Qm.n` is an integer read as a multiple of 2^-n; m counts the bits before the point, the sign's one
//! included where the type is signed. An angle as a *turn* is a `u64` in units of 2^-64 turn, so it wraps by itself.

pub(crate) mod div;
#[cfg(test)]
mod edges;
pub(crate) mod exp_log;
pub(crate) mod inverse_cube;
pub(crate) mod round;
pub(crate) mod simd;
pub(crate) mod sqrt;
mod tables;
pub(crate) mod trig;
pub(crate) mod wide;

/// The exact product.
#[inline(always)]
pub(crate) const fn product(a: i64, b: i64) -> i128 {
    a as i128 * b as i128
}

/// The upper half of a product: `floor(a·b / 2^64)`.
#[inline]
const fn mul_high(a: u64, b: u64) -> u64 {
    ((a as u128 * b as u128) >> 64) as u64
}

/// The upper half of a signed product: `floor(a·b / 2^64)`.
#[inline]
const fn mul_high_signed(a: i64, b: i64) -> i64 {
    ((a as i128 * b as i128) >> 64) as i64
}
