//! A factor over the cube of a length, to some 85 bits: what attraction multiplies an offset by.

use super::sqrt::reciprocal_root;
use super::{mul_high, mul_high_signed};

/// The result of [`over_cube`] is less than this away from the exact value.
pub(crate) const OVER_CUBE_ERROR: u64 = 1 << 8;

/// mantissa · 2^26 / v^(3/2), below 2^93.1, for v = `x`·2^-128 in [¼, 1): without a square root and without a division.
///
/// A short estimate y of 1/√v misses by m = 1 − v·y², which is exact, and 1/v^(3/2) = y³·(1 − m)^(-3/2)
/// = y³·(1 + ³⁄₂·m + ¹⁵⁄₈·m² + ³⁵⁄₁₆·m³ + …).
///
/// # Ranges
/// y <= 2 + 2^-27 in units of 2^-30 is 1/√v within 2^-27.6 relative: 2^-28 of [`reciprocal_root`], and one unit. So |m| < 2^-26.5,
/// 2^61.5 in units of 2^-88, and the term of m⁴ is below 2^-104. The sum is within 4 units: 1.5 by that of m, and one by each of
/// two cuts, the cuts of the terms of m² and m³ being below 2^-20 of one. With a power below 2^93.1 these are 147 of its units; what
/// is cut off before the product with the sum makes 2^30 · 2^-25.9 < 18, and two more are rounded down.
#[inline]
pub(crate) const fn over_cube(mantissa: u64, x: u128) -> u128 {
    let m = (x >> 64) as u64;
    let y_q30 = (reciprocal_root(m) >> 31) as u64;
    // At most 2^62 + 2^34.
    let square_q60 = y_q30 * y_q30;
    // Next to 2^124, and less than a unit too small.
    let product_q124 = m as u128 * square_q60 as u128 + mul_high(x as u64, square_q60) as u128;
    let miss_q88 = (((1 << 124) - product_q124 as i128) >> 36) as i64;
    // Below 2^59, and 15/8 + 35/16·m.
    let miss_square_q112 = mul_high_signed(miss_q88, miss_q88);
    let bracket_q62 = (15 << 59) + (miss_q88 >> 30) * 35;
    // Below 2^62.2.
    let gain_q88 = miss_q88 + (miss_q88 >> 1) + (mul_high_signed(miss_square_q112, bracket_q62) >> 22);
    // mantissa·y³: below 2^95.1 before the square.
    let first = mantissa as u128 * y_q30 as u128;
    let power = (first >> 64) * square_q60 as u128 + mul_high(first as u64, square_q60) as u128;
    // The upper 63 bits and a little, times 62.2 bits.
    let gain = ((power >> 30) as u64 as i128 * gain_q88 as i128) >> 58;
    power.wrapping_add_signed(gain)
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use dashu_int::UBig;

    use super::*;
    use crate::cases::times;

    /// |power − mantissa · 2^26 / v^(3/2)| < error: squared, (power ± error)² around mantissa² · 2^52 / v³ with v = x / 2^128.
    fn is_near(power: u128, mantissa: u64, x: u128, error: u64) -> bool {
        let exact = UBig::from(mantissa).pow(2) << (52 + 3 * 128);
        let cube = UBig::from(x).pow(3);
        UBig::from(power - u128::from(error)).pow(2) * &cube < exact
            && exact < UBig::from(power + u128::from(error)).pow(2) * &cube
    }

    #[test]
    fn a_power_is_within_its_error() {
        let mut state = 5u64;
        let mut next = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state ^ state >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
        };
        let mantissas = [1 << 63, 1 << 63 | 1, u64::MAX - 1, u64::MAX];
        // The ends of the range, and both ends of each entry of the table of roots.
        let borders = (32..128u128)
            .flat_map(|i| [i << 121, (i << 121) + 1, (i << 121) + ((1 << 121) - 1)])
            .filter(|x| x >> 126 != 0);
        let ends: Vec<u128> = borders.chain((0..100).map(|d| u128::MAX - d)).collect();
        let mut largest = 0;
        for x in ends {
            for mantissa in mantissas {
                let power = over_cube(mantissa, x);
                largest = largest.max(power);
                assert!(is_near(power, mantissa, x, OVER_CUBE_ERROR), "{mantissa}, {x}");
            }
        }
        // 2^93.17.
        assert!(largest < 9 << 90, "{largest}");
        for _ in 0..times(100_000) {
            let (mantissa, x) = (next() | 1 << 63, u128::from(next()) << 64 | u128::from(next()));
            let x = x << (x.leading_zeros() & !1);
            assert!(is_near(over_cube(mantissa, x), mantissa, x, OVER_CUBE_ERROR), "{mantissa}, {x}");
        }
    }
}
