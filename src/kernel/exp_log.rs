//! Binary logarithm, power of two, and general power.
//!
//! `pow` needs log2 to 2^-104 and exp2 to 2^-72: an exponent of 2^31 magnifies the first, the 63 bits of the result ask
//! for the second. Both take 7 bits of the argument from a table and the rest from a series in 128 bits.

use super::mul_high;
use super::round::{shr_round, shr_round_u};
use super::tables::{EXP2_Q127, EXP2_SERIES_Q127, LOG2_E_LESS_ONE_Q127, LOG2_Q120};

/// `floor(a·b / 2^128)`.
#[inline]
const fn mul_high_wide(a: u128, b: u128) -> u128 {
    const LOW: u128 = u64::MAX as u128;
    let (a1, a0, b1, b0) = (a >> 64, a & LOW, b >> 64, b & LOW);
    // (2^64 - 1)² + 2·(2^64 - 1) = 2^128 - 1: each sum fits.
    let mid = a1 * b0 + ((a0 * b0) >> 64);
    let mid_low = a0 * b1 + (mid & LOW);
    a1 * b1 + (mid >> 64) + (mid_low >> 64)
}

/// `x·y` in Q127 for |x| < 1 and 0 <= y < 2, its magnitude rounded down.
#[inline]
const fn mul_q127(x: i128, y: u128) -> i128 {
    let magnitude = mul_high_wide(x.unsigned_abs() << 1, y) as i128;
    if x < 0 { -magnitude } else { magnitude }
}

/// r with r/256 near 128/(j + ½), for 128 <= j < 256: makes m·r/256 near 1 for m in [j/128, (j + 1)/128).
///
/// It is exactly 1 for j = 128, so that log2 of 1 is exactly 0.
#[inline]
const fn log2_reciprocal(j: u64) -> u64 {
    if j == 128 { 256 } else { ((1 << 16) + j) / (2 * j + 1) }
}

/// log2(raw·2^-32) in Q7.120 for `raw` > 0, within 2^-118; exact for powers of two.
pub(crate) const fn log2_fine(raw: u64) -> i128 {
    /// Terms of the series; the next is below 2^-112/17.
    const TERMS: u128 = 16;

    let shift = raw.leading_zeros();
    let m_q63 = raw << shift;
    let j = m_q63 >> 56;
    // m·r/256 = 1 + e with -2^-7 < e < 2^-7, exactly.
    let e_q71 = (m_q63 as u128 * log2_reciprocal(j) as u128) as i128 - (1 << 71);
    let e = e_q71 << 56;
    // ln(1 + e) = e·(1 - e·(1/2 - e·(1/3 - …))). Each bracket is within 2^-6 of its first term, so positive and below 2.
    let mut bracket = (1 << 127) / TERMS;
    let mut n = TERMS - 1;
    while n > 0 {
        bracket = ((1 << 127) / n).wrapping_sub(mul_q127(e, bracket) as u128);
        n -= 1;
    }
    let ln = mul_q127(e, bracket);
    let log2 = ln + mul_q127(ln, LOG2_E_LESS_ONE_Q127);
    // |exponent| <= 32 and the rest is below 1: less than 2^126.
    let exponent = 31 - shift as i128;
    (exponent << 120) + LOG2_Q120[j as usize - 128] + shr_round(log2, 7)
}

/// 2^frac in Q1.127, in [2^127, 2^128), for `frac` in Q0.128: relative error below 2^-106; exact for 0.
pub(crate) const fn exp2_fine(frac: u128) -> u128 {
    let table = EXP2_Q127[(frac >> 121) as usize];
    let rest = frac & ((1 << 121) - 1);
    // 2^rest - 1 = rest·(c1 + rest·(c2 + …)) below 2^-7; the first term left out is below 2^-108.
    let mut bracket = 0;
    let mut n = EXP2_SERIES_Q127.len();
    while n > 0 {
        n -= 1;
        bracket = EXP2_SERIES_Q127[n] + mul_high_wide(rest, bracket);
    }
    let growth_q127 = mul_high_wide(rest, bracket);
    // Largest at frac = 1 - 2^-128, where the true value is 2^128 - 0.69. The table's entry is at most ½ too large, the
    // growth 2^-8, and every product is rounded down: the sum stays below 2^128 - 0.1.
    table + mul_high_wide(table, growth_q127 << 1)
}

/// A value whose upper 64 bits, rounded, are those of [`exp2_fine`]: mostly that of [`exp2_quick`].
pub(crate) const fn exp2_for_64_bits(frac: u128) -> u128 {
    let quick = exp2_quick(frac);
    // Once in a thousand cases the other side of a tie is within its error.
    if (quick as u64).abs_diff(1 << 63) > EXP2_QUICK_ERROR { quick } else { exp2_fine(frac) }
}

/// [`exp2_quick`] is less than 2^-74 away from [`exp2_fine`].
const EXP2_QUICK_ERROR: u64 = 1 << 53;

/// 2^frac in Q1.127, in [2^127, 2^128), for `frac` in Q0.128: the series from its second term on in 64 bits.
const fn exp2_quick(frac: u128) -> u128 {
    /// The factors of rest² to rest⁸, that of restⁿ in units of 2^-(80 − 7n), rounded down. The next term is below 2^-86.
    const TAIL: [u64; 7] = {
        let mut tail = [0; 7];
        let mut n = 2;
        while n <= 8 {
            tail[n - 2] = (EXP2_SERIES_Q127[n - 1] >> (47 + 7 * n)) as u64;
            n += 1;
        }
        tail
    };

    let table = EXP2_Q127[(frac >> 121) as usize];
    let rest = frac & ((1 << 121) - 1);
    // A bracket in units of one power, times rest < 2^-7, is one in units of the power below. The 7 entries and 6 products are
    // each less than a unit too small, together 13·2^-66 < 2^-62.2. The sum is below ¼, so it fits.
    let rest_q71 = (rest >> 57) as u64;
    let mut bracket_q66 = 0;
    let mut n = TAIL.len();
    while n > 0 {
        n -= 1;
        bracket_q66 = TAIL[n] + mul_high(bracket_q66, rest_q71);
    }
    // Too small by 2^-78 and 2·2^-7·2^-71. A quarter of that and 2^-14 of the bracket's error make 2^-75.9 together, and
    // beside a table entry below 2 it is 2^-74.9.
    let square_q78 = mul_high(rest_q71, rest_q71);
    let tail_q127 = (bracket_q66 as u128 * square_q78 as u128) >> 17;
    let growth_q127 = mul_high_wide(rest, EXP2_SERIES_Q127[0]) + tail_q127;
    // Below 2^128: what frac lacks to 1 and what rest_q71 lacks to 2^-7 are 2^-71 together or more, which keeps the value below
    // 2 by 2^-79. See `exp2_fine` for the little that the table adds.
    table + mul_high_wide(table, growth_q127 << 1)
}

/// log2 in I32F32 of an I32F32 value `raw` > 0, within 0.5001 ulp.
pub(crate) const fn log2(raw: u64) -> i64 {
    shr_round(log2_fine(raw), 88) as i64
}

/// 2^raw in I32F32, within 0.5001 ulp, ties to even; `None` if it does not fit.
pub(crate) const fn exp2(raw: i64) -> Option<u64> {
    // A tie is possible for 2^-33 alone, and there the fraction is 0 and the power exact.
    fx_from_power(raw >> 32, (raw as u32 as u128) << 96, false)
}

/// e^raw in I32F32, within 0.5001 ulp; `None` if it does not fit.
///
/// It is 0 from −33·ln 2 down. There are no ties, as e^raw is irrational but for raw = 0.
pub(crate) const fn exp(raw: i64) -> Option<u64> {
    /// From 32 on the exponent of two is above 46.
    const FAR: u64 = 32 << 32;

    let (magnitude, negative) = (raw.unsigned_abs(), raw < 0);
    if magnitude >= FAR {
        return if negative { Some(0) } else { None };
    }
    // |raw|·log2 e in Q121: below 2^(37 + 89), and 1.45 times that. The constant and the product leave out 2^-121 of it at most.
    let magnitude_q121 = (magnitude as u128) << 89;
    let power_q121 = magnitude_q121 + mul_high_wide(magnitude_q121, LOG2_E_LESS_ONE_Q127 << 1);
    let (whole, frac) = ((power_q121 >> 121) as i64, power_q121 << 7);
    match (negative, frac) {
        (false, _) => fx_from_power(whole, frac, false),
        (true, 0) => fx_from_power(-whole, 0, false),
        // 2^-(n + f) = 2^-(n + 1) · 2^(1 − f).
        (true, _) => fx_from_power(-whole - 1, frac.wrapping_neg(), false),
    }
}

/// raw·log2 e in units of 2^-94, less by at most two of them, `raw` in I32F32 and below 2^63: below 2^126.
pub(crate) const fn times_log2_e(raw: u64) -> u128 {
    let q94 = (raw as u128) << 62;
    // 2^125 and 1.45 times that. The product is rounded down, and the constant lacks at most 2^-127, which makes a quarter of a unit.
    q94 + mul_high_wide(q94, LOG2_E_LESS_ONE_Q127 << 1)
}

/// base^exponent in I32F32 for `base` > 0, within 0.5001 ulp, ties to even; `None` if it does not fit.
pub(crate) const fn pow(base: u64, exponent: i64) -> Option<u64> {
    let log_q120 = log2_fine(base);
    // log·exponent is Q152; without its lowest 64 bits it is Q88. |log| <= 32, so the upper part of the log has 62 bits,
    // and the whole is at most 2^(125 + 63 - 64) = 2^124. Error: 2^31·2^-118 from the log, 2^-88 from the bits left out.
    let upper = (log_q120 >> 64) * exponent as i128;
    let lower = (log_q120 as u64 as i128 * exponent as i128) >> 64;
    let power_q88 = upper + lower;
    fx_from_power((power_q88 >> 88) as i64, (power_q88 as u128) << 40, true)
}

/// 2^(whole + frac) in I32F32, `frac` in Q0.128, rounded to nearest, ties to even; `None` if it does not fit.
///
/// With `settle`, a value within 2^-21 ulp of a tie is taken for one: for a `frac` in error by up to 2^-86, whose exact
/// power may well be a tie, such as (3/2^11)³.
#[inline]
const fn fx_from_power(whole: i64, frac: u128, settle: bool) -> Option<u64> {
    /// Bits kept below the ulp for the rounding. A result has 63 bits, so an error of 2^-86 is 2^-23 ulp at most.
    const GUARD: u32 = 20;

    if whole > 30 {
        return None;
    }
    if whole < -33 {
        return Some(0);
    }
    // 2^(whole + 32)·m·2^-127: from 45 to 108 bits go.
    let m = exp2_fine(frac);
    let drop = (95 - whole) as u32 - GUARD;
    let guarded = if settle { shr_round_u(m, drop) } else { (m >> drop) | (m & ((1 << drop) - 1) != 0) as u128 };
    let value = shr_round_u(guarded, GUARD) as u64;
    if value >> 63 == 0 { Some(value) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::wide::mul_128;
    use alloc::vec::Vec;

    #[test]
    fn the_table_rotation_leaves_less_than_2_to_the_minus_7() {
        for j in 128..256u64 {
            for m in [j << 56, ((j + 1) << 56).wrapping_sub(1)] {
                let e = (u128::from(m) * u128::from(log2_reciprocal(j))).abs_diff(1 << 71);
                assert!(e < 1 << 64, "{j}");
            }
        }
    }

    #[test]
    fn the_upper_half_of_a_product_is_exact() {
        let words = [0, 1, 3, 1 << 63, u64::MAX - 1, u64::MAX];
        let wide: Vec<_> =
            words.iter().flat_map(|&high| words.map(|low| u128::from(high) << 64 | u128::from(low))).collect();
        for &a in &wide {
            for &b in &wide {
                assert_eq!(mul_high_wide(a, b), mul_128(a, b).0, "{a:#x} · {b:#x}");
            }
        }
    }

    #[test]
    fn powers_of_two_are_exact_both_ways() {
        for k in 0..63 {
            let exponent = i128::from(k) - 32;
            assert_eq!(log2_fine(1 << k), exponent << 120);
            assert_eq!(exp2((exponent << 32) as i64), Some(1 << k));
        }
        assert_eq!(exp2(31 << 32), None);
        assert_eq!(exp2(-33 << 32), Some(0)); // a tie
        assert_eq!(exp2((-33 << 32) + 1), Some(1));
        assert_eq!(exp2(i64::MIN), Some(0));
        assert_eq!(exp2(i64::MAX), None);
        assert_eq!(exp2_fine(0), 1 << 127);
    }

    #[test]
    fn powers_of_e_end_where_they_no_longer_fit() {
        assert_eq!((exp(0), exp(1), exp(-1)), (Some(1 << 32), Some((1 << 32) + 1), Some((1 << 32) - 1)));
        assert_eq!((exp(1 << 32), exp(-1 << 32)), (Some(11_674_931_555), Some(1_580_030_169)));
        // ln(2^31 − 2^-33) and 33·ln 2 in I32F32, rounded down.
        assert_eq!((exp(92_288_378_626).is_some(), exp(92_288_378_627)), (true, None));
        assert_eq!((exp(-98_242_467_570), exp(-98_242_467_571)), (Some(1), Some(0)));
        assert_eq!((exp(i64::MAX), exp(i64::MIN)), (None, Some(0)));
    }

    #[test]
    fn the_power_undoes_the_logarithm() {
        for k in 1..20_000u64 {
            let raw = k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (k % 63) | 1;
            let log_q120 = log2_fine(raw);
            let back = exp2_fine((log_q120 as u128) << 8) >> 64;
            let mantissa = u128::from(raw << raw.leading_zeros());
            assert!(back.abs_diff(mantissa) <= 1, "{raw}");
        }
        assert!(exp2_fine(u128::MAX) >= 1 << 127);
    }

    #[test]
    fn the_quick_power_rounds_to_the_bits_of_the_fine_one() {
        let borders = (0..=128u128).flat_map(|k| (0..9).map(move |off| (k << 121).wrapping_add(off).wrapping_sub(4)));
        let cut = (57..128).flat_map(|k| [1u128 << k, (1 << k) - 1, u128::MAX << k]);
        let spread = (0..200_000u128).map(|k| k.wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835));
        let mut open = 0;
        for frac in borders.chain(cut).chain(spread) {
            let (quick, fine) = (exp2_quick(frac), exp2_fine(frac));
            assert!(quick >= 1 << 127 && quick.abs_diff(fine) < u128::from(EXP2_QUICK_ERROR), "{frac:#x}");
            assert_eq!(shr_round_u(exp2_for_64_bits(frac), 64), shr_round_u(fine, 64), "{frac:#x}");
            open += u32::from(shr_round_u(quick, 64) != shr_round_u(fine, 64));
        }
        assert!(open > 0, "no case needed the fine one");
    }

    #[test]
    fn exact_powers_come_out_exact_and_their_ties_go_to_even() {
        const ONE: u64 = 1 << 32;
        assert_eq!(pow(3 * ONE, 4 << 32), Some(81 * ONE));
        assert_eq!(pow(9 * ONE, 1 << 31), Some(3 * ONE));
        assert_eq!(pow(ONE, i64::MIN), Some(ONE));
        assert_eq!(pow(u64::from(u32::MAX), 0), Some(ONE));
        // (k/2^11)³ = k³·2^-33, for odd k a tie.
        for k in (1..100u64).step_by(2) {
            let (floor, expected) = (k * k * k / 2, (k * k * k / 2).next_multiple_of(2));
            assert!(expected == floor || expected == floor + 1);
            assert_eq!(pow(k << 21, 3 << 32), Some(expected));
        }
        assert_eq!(pow(2 * ONE, 31 << 32), None);
        assert_eq!(pow(1, i64::MIN), None);
        assert_eq!(pow(1, i64::MAX), Some(0));
        assert_eq!(pow(i64::MAX as u64, 1 << 32), Some(i64::MAX as u64));
        assert_eq!(pow(i64::MAX as u64, -1 << 32), Some(2));
    }
}
