//! Numbers of the solver: integers in units that are powers of two.

use crate::fx::Fx;
pub(super) use crate::kernel::product;
use crate::kernel::round::odd_shift;
pub(super) use crate::kernel::round::{lowered_low, upper};
use crate::kernel::wide::{magnitude, with_sign};
use crate::scalar::FxFactor;

/// value · 2^-bits to nearest, ties away from zero; for negative `bits` value · 2^|bits|. *Domain* the result fits.
#[inline]
pub(super) const fn shifted(value: i128, bits: i32) -> i128 {
    match bits {
        1..127 => with_sign(((magnitude(value) >> (bits - 1)) as i128 + 1) >> 1, value),
        127.. => 0,
        _ => value << -bits,
    }
}

/// [`shifted`] of a word. *Domain* the result fits.
#[inline]
pub(super) const fn shifted_word(value: i64, bits: i32) -> i64 {
    match bits {
        1..64 => {
            let rounded = ((value.unsigned_abs() >> (bits - 1)) + 1) >> 1;
            if value < 0 { -(rounded as i64) } else { rounded as i64 }
        }
        64.. => 0,
        _ => value << -bits,
    }
}

/// [`shifted_word`], most often down by a part of a word. *Domain* the result fits, and |value| + 2^(bits − 1) < 2^63.
#[inline(always)]
pub(super) const fn lowered_word(value: i64, bits: i32) -> i64 {
    match bits {
        1..63 => (value + (1 << (bits - 1)) - (value < 0) as i64) >> bits,
        _ => shifted_word(value, bits),
    }
}

/// [`shifted`] down by a part of a double word. *Domain* |value| < 2^126, and 1 ≤ bits ≤ 126.
#[inline(always)]
pub(super) const fn lowered(value: i128, bits: i32) -> i128 {
    odd_shift(value, bits as u32)
}

/// [`lowered_low`] by bits that are no constant.
#[inline(always)]
pub(super) const fn lowered_low_by(value: i128, bits: i32) -> i64 {
    let half = (1_u64 << (bits - 1)).wrapping_add((value >> 127) as u64);
    let sum = value + half as i128;
    // Without the steps that a shift by 64 and more would take.
    ((sum as u64) >> bits | ((sum >> 64) as u64) << (64 - bits)) as i64
}

/// [`lowered`] within ±limit. *Domain* |value| < 2^126, 2 ≤ bits ≤ 63, and 0 ≤ limit ≤ 2^62.
#[inline(always)]
pub(super) const fn lowered_within(value: i128, bits: i32, limit: i64) -> i64 {
    let (high, low) = ((value >> 64) as i64, lowered_low(value, bits));
    // Without a branch: compilers know that a factor is a word only within a block. |value| is at most 2^(62 + bits), or more than that.
    let is_word = (high ^ (high >> 63)) >> (bits - 2) == 0;
    let end = (high >> 63) ^ i64::MAX;
    let low = if is_word { low } else { end };
    let low = if low < -limit { -limit } else { low };
    if low > limit { limit } else { low }
}

/// [`lowered`] within ±limit, most often by a part of a word. *Domain* |value| < 2^126, 2 ≤ bits ≤ 126, and 0 ≤ limit ≤ 2^62.
#[inline(always)]
pub(super) fn lowered_to(value: i128, bits: i32, limit: i128) -> i64 {
    if bits < 64 { lowered_within(value, bits, limit as i64) } else { within(lowered(value, bits), limit) }
}

/// The value within ±limit. *Domain* 0 ≤ limit < 2^63.
#[inline(always)]
pub(super) fn within(value: i128, limit: i128) -> i64 {
    value.clamp(-limit, limit) as i64
}

/// [`within`] of a word.
#[inline(always)]
pub(super) fn within_word(value: i64, limit: i128) -> i64 {
    value.clamp(-limit as i64, limit as i64)
}

/// value/divisor to nearest, halves away from zero. *Domain* |value| < 2^125, divisor > 0.
pub(super) fn divided(value: i128, divisor: i64) -> i128 {
    let divisor = i128::from(divisor);
    value.signum() * ((2 * value.abs() + divisor) / (2 * divisor))
}

/// The value within ±limit. *Domain* limit ≥ 0.
#[inline]
pub(super) fn clamped_word(value: i64, limit: i64) -> i32 {
    value.clamp(-limit, limit) as i32
}

/// The value within ±limit. *Domain* limit ≥ 0.
#[inline]
pub(super) fn clamped(value: i128, limit: i128) -> i32 {
    value.clamp(-limit, limit) as i32
}

/// The number of bits of the magnitude: 2^bits is above it.
#[inline]
pub(super) const fn bits_of(value: i64) -> i32 {
    64 - value.unsigned_abs().leading_zeros() as i32
}

/// [`bits_of`] a value that is not negative.
#[inline]
pub(super) const fn bits_in(value: i64) -> i32 {
    64 - value.leading_zeros() as i32
}

/// ⌈log2⌉ of a length in metres. *Domain* it is positive.
#[inline]
pub(super) fn log2_above(length: Fx) -> i32 {
    bits_of(length.to_bits() - 1) - 32
}

/// The exponent of a factor: it is below 2^exponent. The smallest number for zero.
#[inline]
pub(super) const fn exponent(factor: FxFactor) -> i32 {
    match factor.parts() {
        (0, _) => i32::MIN / 2,
        (_, shift) => 64 - shift,
    }
}

/// factor · 2^bits to nearest, ties upwards. *Domain* the result is below 2^63.
#[inline]
pub(super) const fn fixed(factor: FxFactor, bits: i32) -> i64 {
    let (mantissa, shift) = factor.parts();
    match shift - bits {
        down @ 2..65 => (((mantissa >> (down - 1)) + 1) >> 1) as i64,
        down => shifted(mantissa as i128, down) as i64,
    }
}
