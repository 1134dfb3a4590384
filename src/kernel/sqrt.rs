//! Square roots of integers, exact.
//!
//! With x scaled by an even power of two to v in [¼, 1): y ≈ 1/√v from a table of chords (relative error 2^-14.4), one
//! or two Newton steps y += y·(1 - v·y²)/2, each of which takes a relative error e to ³⁄₂·e², then s = v·y and one
//! step s += (v - s²)·y/2 towards √v. That leaves less than one unit of the last place, and one comparison with the
//! exact square settles it. No division, no loop.

use super::round::shr_round_u;
use super::tables::RSQRT_Q30;
use super::wide::{div_256, mul_128};
use super::{mul_high, mul_high_signed};

/// 1/√v in Q3.61 with a relative error below 2^-28, for v = `m`·2^-64 in [¼, 1); 0 for 0.
#[inline]
pub(crate) const fn reciprocal_root(m: u64) -> i64 {
    let (left, fall) = RSQRT_Q30[(m >> 57) as usize];
    let along = (m >> 41) & 0xffff;
    // fall <= 2^25 + 2^18, so the product has less than 42 bits; left <= 2^31.
    let y_q30 = left as u64 - ((fall as u64 * along) >> 16);
    // y² <= 2^62. |1 - v·y²| < 2^-13 makes the difference less than 2^47, its upper part 2^31, and times y 2^62.
    let miss_q60 = (1 << 60) - mul_high(m, y_q30 * y_q30) as i64;
    ((y_q30 << 31) as i64) + ((y_q30 as i64 * (miss_q60 >> 16)) >> 14)
}

/// The square root, rounded down.
#[inline]
pub(crate) const fn isqrt(x: u128) -> u64 {
    // Zero has 128 leading zeros: it is shifted by none, and its root comes out as zero.
    let twice_shift = x.leading_zeros() & 126;
    floor_root(x << twice_shift) >> (twice_shift / 2)
}

/// The square root of `x` >= 2^126, rounded down; 0 for 0.
#[inline]
const fn floor_root(x: u128) -> u64 {
    floor_and_reciprocal(x).0
}

/// The square root of `x`, rounded down, and 1/√v in Q3.61 with a relative error below 2^-55, for v = `x`·2^-128 in [¼, 1).
#[inline]
const fn floor_and_reciprocal(x: u128) -> (u64, u64) {
    let m = (x >> 64) as u64;
    let y = reciprocal_root(m);
    // y <= 2^62 + 2^34, so y² (Q58) has 61 bits; |1 - v·y²| < 2^-27 leaves 31 bits of the difference,
    // and 31 bits of y beside them keep the product below 2^62. Relative error after it: 2^-55.
    let miss_q58 = (1 << 58) - mul_high(m, mul_high_signed(y, y) as u64) as i64;
    let y = y + (((y >> 32) * miss_q58) >> 27);
    // s < 2^61 up to the error of y: capped, so that it fits 64 bits as Q64.
    let s_q61 = mul_high(m, y as u64);
    let s = if s_q61 >> 61 == 0 { s_q61 << 3 } else { u64::MAX };
    // |x - s²| < 2·2^64·2^10 = 2^75, and y < 2^63, so the factors have 36 and 28 bits.
    let rest = x.wrapping_sub(s as u128 * s as u128) as i128;
    let step = ((rest >> 40) as i64 * (y >> 35)) >> 51;
    let s = s as i128 + step as i128;
    let s = if s >> 64 == 0 { s as u64 } else { u64::MAX };
    // Now s is at most one off. s² fits, and the rest is below 2^66 in magnitude.
    let rest = x.wrapping_sub(s as u128 * s as u128) as i128;
    // Without a branch: which of the three it is cannot be predicted.
    let (below, above) = ((rest < 0) as u64, (rest > 2 * s as i128) as u64);
    (s + above - below, y as u64)
}

/// The square root, rounded to nearest (no tie is possible); from 2^128 - 2^64 + 1 on it is 2^64.
#[inline]
pub(crate) const fn sqrt_round(x: u128) -> u128 {
    let floor = isqrt(x) as u128;
    // (floor + ½)² = floor² + floor + ¼. floor² <= x.
    floor + (x - floor * floor > floor) as u128
}

/// The square root of `x` >= 2^126 in units of 2^-32, that is √(x·2^64), within 0.501 of a unit.
#[inline]
pub(crate) const fn root_fine(x: u128) -> u128 {
    root_and_reciprocal(x).0
}

/// [`root_fine`] of `x`, and 1/√v in Q3.61 with a relative error below 2^-55, for v = `x`·2^-128 in [¼, 1).
#[inline]
pub(crate) const fn root_and_reciprocal(x: u128) -> (u128, u64) {
    let (floor, y) = floor_and_reciprocal(x);
    // √x = floor + f with f = rest/(2·floor + f); leaving out that f makes less than 2^-64 of error. rest <= 2·floor < 2^65.
    let rest = x - floor as u128 * floor as u128;
    // f in units of 2^-48 is rest·2^47/floor <= 2^48. 1/floor is y·2^-125 within 2^-54, and |2^48·2^-54| = 2^-6: rounded down
    // the estimate is at most one off. ⌊rest/2⌋ <= floor, so its product is below 2^127, and so is rest·2^47 < 2^112.
    let estimate = ((rest >> 1) * y as u128) >> 77;
    let miss = (rest << 47) as i128 - (estimate * floor as u128) as i128;
    let (below, above) = ((miss < 0) as u128, (miss >= floor as i128) as u128);
    (shr_round_u(((floor as u128) << 48) + estimate + above - below, 16), y)
}

/// c·whole / √`squares`, rounded to nearest (no tie is possible).
///
/// *Domain* c² <= squares <= 2^127, `squares` is c² plus a square and not zero, whole < 2^63. The result is at most `whole`.
///
/// A tie would be 2·c·whole / √squares = an odd integer. Then the root is an integer, the hypotenuse of a triangle with integer
/// sides, and c / √squares in lowest terms has an odd denominator b: with c / √squares = a / b the odd integer times b would be
/// 2·a·whole, which is even.
#[inline]
pub(crate) const fn over_root(c: u64, whole: u64, squares: u128) -> u64 {
    let even = squares.leading_zeros() & !1;
    // √squares in units of 2^-(32 + even/2), from 2^95 to 2^96, within 2^-95 relative.
    let root = root_fine(squares << even);
    let product = c as u128 * whole as u128;
    let up = 32 + even / 2;
    // c <= √squares, so that product · 2^up is at most whole · root and a little: its high half is below the root.
    let (quotient, _) = div_256(product >> (128 - up), product << up, root);
    // Within 2^63 · 2^-95 = 2^-32 of the exact quotient, and rounded down: the nearest integer is this one or the next. That is the
    // question whether (quotient + ½)·√squares < c·whole, exactly: 2·quotient + 1 < 2^64, so that each side is below 2^255.
    let twice = 2 * quotient + 1;
    let (high, low) = mul_128(twice * twice, squares);
    let (most_high, most_low) = mul_128(2 * product, 2 * product);
    let is_above = most_high > high || (most_high == high && most_low > low);
    quotient as u64 + is_above as u64
}

/// The unit vector along (x, y) in units of 2^-30, each component within 0.501 of a unit, and the length, rounded to nearest (no
/// tie is possible). Odd in x and in y.
///
/// *Domain* |x|, |y| <= 2^62, not both zero.
#[inline]
pub(crate) const fn direction(x: i64, y: i64) -> ([i32; 2], u64) {
    let (along, across) = (x.unsigned_abs() as u128, y.unsigned_abs() as u128);
    // At most 2^125: at least two zeros lead.
    let squares = along * along + across * across;
    let half_even = squares.leading_zeros() / 2;
    let (floor, reciprocal) = floor_and_reciprocal(squares << (2 * half_even));
    // √(squares·2^even) = 2^64·√v with 1/√v = reciprocal·2^-61, so c/√squares = c·reciprocal·2^(even/2 - 125). The product is below
    // 2^62·2^62.01, and the quotient has 30 bits after the point.
    let (right, half) = (95 - half_even, 1 << (94 - half_even));
    let part_x = ((along * reciprocal as u128 + half) >> right) as i32;
    let part_y = ((across * reciprocal as u128 + half) >> right) as i32;
    let length = (floor as u128 + (1 << (half_even - 1))) >> half_even;
    ([if x < 0 { -part_x } else { part_x }, if y < 0 { -part_y } else { part_y }], length as u64)
}

/// The square root of an I32F32 value, rounded to nearest: √(raw·2^32) (no tie is possible).
#[inline]
pub(crate) const fn sqrt_fx(raw: u64) -> u64 {
    // Zero, with 64 leading zeros, is shifted by none and goes through as zero. A branch for it would cost time: where the
    // compiler knows that there is a one, x86's bit scan keeps the old value of its register alive, and so ties this call
    // to the end of the last one.
    let twice_shift = raw.leading_zeros() & 62;
    let m = raw << twice_shift;
    let y = reciprocal_root(m);
    // s = v·y with 32 bits, |s - √v| < 2^-27. Should s reach 1, its square wraps to 0 and the rest is still right,
    // since |m - s²| < 2^38.
    let s_q32 = mul_high(m, y as u64) >> 29;
    let rest_q64 = m.wrapping_sub(s_q32.wrapping_mul(s_q32)) as i64;
    // y has 26 bits as Q3.24, so the product is below 2^64·2^-1. The step keeps 24 bits: 2^-51 of √v.
    let s_q61 = (s_q32 << 29).wrapping_add_signed((rest_q64 * (y >> 37)) >> 28);
    // √(raw·2^32) = √v·2^(48 - shift), at most 2^48, so s is less than ¼ away from it: rounded down it is the nearest, or one
    // too low, never too high.
    let root = s_q61 >> (13 + twice_shift / 2);
    // |raw·2^32 - root²| < 2^50, so 64 bits hold it though they do not hold the terms.
    let rest = (raw << 32).wrapping_sub(root.wrapping_mul(root)) as i64;
    root + (rest > root as i64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::times;
    use alloc::vec::Vec;
    use dashu_int::UBig;

    /// Every power of two and square with their neighbours, and others from a generator, all sizes alike.
    fn inputs() -> impl Iterator<Item = u128> {
        let powers = (0..128).flat_map(|k| (0..5).map(move |d| (1u128 << k).wrapping_add(d).wrapping_sub(2)));
        let mut state = 1u64;
        let random = (0..times(100_000)).flat_map(move |i| {
            let mut next = || {
                state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
                (state ^ state >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
            };
            let x = (u128::from(next()) << 64 | u128::from(next())) >> (i % 128);
            let root = u128::from(next()) >> (i % 64);
            [x, root * root, (root * root).wrapping_sub(1), root * root + root, root * root + root + 1]
        });
        powers.chain(random).chain((0..200).map(|d| u128::MAX - d))
    }

    #[test]
    fn the_floor_squared_is_the_largest_square_below() {
        for x in inputs() {
            assert_eq!(u128::from(isqrt(x)), x.isqrt(), "{x}");
        }
    }

    #[test]
    fn the_nearest_root_is_less_than_half_away() {
        for x in inputs() {
            let root = sqrt_round(x);
            // (root - ½)² < x < (root + ½)², less a quarter. root² - root <= (2^64)² - 2^64.
            assert!(root == 0 || root * (root - 1) < x, "{x}");
            assert!(root.checked_mul(root + 1).is_none_or(|next| x <= next), "{x}");
            let raw = x as u64;
            assert_eq!(u128::from(sqrt_fx(raw)), sqrt_round(u128::from(raw) << 32), "{raw}");
        }
    }

    #[test]
    fn the_fine_root_is_that_by_division() {
        // Where the division leaves nothing, and there is a tie: f·2^64 + 3/2.
        let ties = (0..1000u128).map(|k| (1 << 31) + k * 0x1f_1234).map(|f| (f << 32).pow(2) + 3 * f);
        for x in inputs().filter(|&x| x > 0).chain(ties) {
            let x = x << (x.leading_zeros() & !1);
            let floor = u128::from(isqrt(x));
            let by_division = (floor << 48) + ((x - floor * floor) << 48) / (2 * floor);
            assert_eq!(root_fine(x), shr_round_u(by_division, 16), "{x}");
        }
        assert_eq!(root_fine(u128::MAX), 1 << 96);
        assert_eq!(root_fine(1 << 126), 1 << 95);
    }

    #[test]
    fn the_fine_root_is_within_half_a_unit() {
        for x in inputs().filter(|&x| x > 0).step_by(10) {
            let x = x << (x.leading_zeros() & !1);
            // In thousandths: (root ± 0.501)² around x · 2^64.
            let (root, exact) = (UBig::from(root_fine(x)) * 1000u32, (UBig::from(x) << 64) * 1_000_000u32);
            assert!((&root - 501u32).pow(2) < exact && exact < (&root + 501u32).pow(2), "{x}");
        }
    }

    #[test]
    fn a_direction_is_the_nearest_unit_vector_and_its_length_the_nearest_integer() {
        let mut state = 3u64;
        let mut next = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state ^ state >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) as i64
        };
        let ends = [0, 1, -1, 2, 3, (1 << 62) - 1, 1 << 62, -1 << 62];
        let mut vectors: Vec<(i64, i64)> = ends.iter().flat_map(|&x| ends.map(|y| (x, y))).collect();
        for _ in 0..times(40_000) {
            let (cut_x, cut_y) = (2 + next() as u64 % 62, 2 + next() as u64 % 62);
            vectors.push((next() >> cut_x, next() >> cut_y));
        }
        for (x, y) in vectors.into_iter().filter(|&v| v != (0, 0)) {
            let (unit, length) = direction(x, y);
            assert_eq!(direction(-y, x), ([-unit[1], unit[0]], length), "{x}, {y}");
            let squares = u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2);
            assert_eq!(u128::from(length), sqrt_round(squares), "{x}, {y}");
            for (part, c) in unit.into_iter().zip([x, y]) {
                assert!(part == 0 || part.signum() == c.signum() as i32);
                // |q − c·2^30/√squares| < 0.501, in thousandths.
                let exact = (UBig::from(c.unsigned_abs()) * (1000u64 << 30)).pow(2);
                let bound = |thousandths: u64| UBig::from(thousandths).pow(2) * squares;
                let q = 1000 * u64::from(part.unsigned_abs());
                assert!(exact < bound(q + 501) && (q == 0 || exact > bound(q - 501)), "{x}, {y}");
            }
        }
    }

    #[test]
    fn a_share_of_a_root_is_the_nearest_integer() {
        let mut state = 7u64;
        let mut next = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state ^ state >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
        };
        let ends = [0, 1, 2, 3, (1 << 62) - 1, 1 << 62, (1 << 63) - 1, 1 << 63];
        let mut triples: Vec<(u64, u64, u64)> = Vec::new();
        for c in ends {
            for d in ends {
                ends[..7].iter().for_each(|&whole| triples.push((c, d, whole)));
            }
        }
        for _ in 0..times(40_000) {
            let (cut_x, cut_y, cut_z) = (1 + next() % 63, 1 + next() % 63, 1 + next() % 63);
            triples.push((next() >> cut_x, next() >> cut_y, next() >> cut_z));
            // The sides of a right triangle, times anything: the root is an integer.
            let (m, n, k) = (next() >> 50, next() >> 50, next() >> 30 >> (next() % 34));
            triples.push(((m.abs_diff(n) * (m + n) * k) >> 1, m * n * k, next() >> cut_z));
        }
        for (c, d, whole) in triples.into_iter().filter(|(c, d, _)| (*c, *d) != (0, 0)) {
            let squares = u128::from(c).pow(2) + u128::from(d).pow(2);
            let nearest = over_root(c, whole, squares);
            // |q − c·whole/√squares| < ½: (2q − 1)²·squares < (2·c·whole)² < (2q + 1)²·squares.
            let exact = (UBig::from(c) * whole * 2u8).pow(2);
            let bound = |twice: u128| UBig::from(twice).pow(2) * squares;
            let twice = 2 * u128::from(nearest);
            assert!(exact < bound(twice + 1) && (nearest == 0 || exact > bound(twice - 1)), "{c}, {d}, {whole}");
        }
    }
}
