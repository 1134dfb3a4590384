//! Sine, cosine and the angle of a vector, on turns and on I32F32 radians.
//!
//! A turn is folded to [0, ⅛], where a table rotation (the first rotations of CORDIC, merged: 129 entries) leaves a
//! residual of at most 2^-11 turn, and one rotation by a short polynomial does the rest. `atan2` folds alike, divides once
//! and adds the series of the residual to a table. Quarter turns and mirror images are exact because the folding is.
//!
//! Source of the scheme: Volder, "The CORDIC Trigonometric Computing Technique", 1959; the merging of its first
//! rotations into a table and of its last ones into a product is the usual one of hybrid CORDIC (Timmermann et al., 1989).

use super::tables::{ATAN_TURN, INV_TAU_Q66, SIN_COS_Q62, TAU_Q60, TURN_PER_RADIAN_Q128};
use super::{mul_high, mul_high_signed};

/// A quarter, an eighth of a turn.
const QUARTER: u64 = 1 << 62;
const EIGHTH: u64 = 1 << 61;

/// The turn nearest to an angle of `raw`·2^-32 radians, modulo a turn, within 0.501 of a unit. Odd.
#[inline]
pub(crate) const fn turn_from_radians(raw: i64) -> u64 {
    let magnitude = raw.unsigned_abs();
    let (upper, lower) = ((TURN_PER_RADIAN_Q128 >> 64) as u64, TURN_PER_RADIAN_Q128 as u64);
    // raw·2^-32 radians are raw·K·2^-96 units, where K = 2^128/2π. |raw| <= 2^63 and upper < 2^62: the sum is below 2^126.
    // Its error is |raw|·½·2^-64 from K and 1 from the lower product, in units of 2^-32.
    let turn_q32 = magnitude as u128 * upper as u128 + mul_high(magnitude, lower) as u128;
    let turn = ((turn_q32 + (1 << 31)) >> 32) as u64;
    if raw < 0 { turn.wrapping_neg() } else { turn }
}

/// The angle in [0, 2π) as I32F32 radians, rounded to nearest, ties to even.
///
/// A turn has 29 bits below an I32F32 radian, so this undoes `turn_from_radians` on [0, 2π).
#[inline]
pub(crate) const fn radians_from_turn(turn: u64) -> i64 {
    // Below 2^64·2^62.7. 2π·2^32 = 26986075409.04…, so even the largest turn rounds to a value below 2π.
    let radians_q124 = turn as u128 * TAU_Q60 as u128;
    super::round::shr_round_u(radians_q124, 92) as i64
}

/// (sin, cos) of a turn in Q2.62, within 2^-61.
///
/// Exactly, for every t: (sin, cos)(-t) = (-sin t, cos t) and (sin, cos)(t + ¼) = (cos t, -sin t).
#[inline]
pub(crate) const fn sin_cos_turn(turn: u64) -> (i64, i64) {
    // The nearest axis, and the angle from it in [-⅛, ⅛). Its magnitude alone enters the computation: hence the mirror.
    let quadrant = turn.wrapping_add(EIGHTH) >> 62;
    let from_axis = turn.wrapping_sub(quadrant << 62) as i64;
    let (sin, cos) = sin_cos_octant(from_axis.unsigned_abs());
    let sin = if from_axis < 0 { -sin } else { sin };
    // By quarter turns: (s, c), (c, -s), (-s, -c), (-c, s).
    let (sin, cos) = if quadrant & 1 == 1 { (cos, -sin) } else { (sin, cos) };
    if quadrant & 2 == 2 { (-sin, -cos) } else { (sin, cos) }
}

/// (sin, cos) in Q2.62 of a turn in [0, ⅛]. At ⅛ they are equal, being one table entry with nothing to add.
#[inline]
const fn sin_cos_octant(turn: u64) -> (i64, i64) {
    const SIXTH_Q64: i64 = (1i128 << 64).div_euclid(6) as i64;
    const TWENTY_FOURTH_Q64: i64 = (1i128 << 64).div_euclid(24) as i64;
    const HUNDRED_TWENTIETH_Q52: i64 = (1i64 << 52) / 120;
    const SEVEN_HUNDRED_TWENTIETH_Q52: i64 = (1i64 << 52) / 720;

    let index = (turn + (1 << 53)) >> 54;
    let residual = turn.wrapping_sub(index << 54) as i64;
    // The residual is in [-2^53, 2^53), so 10 bits more fit; in radians it is r, |r| < 2^-8.3.
    let r_q70 = mul_high_signed(residual << 10, TAU_Q60);
    let r2_q76 = mul_high_signed(r_q70, r_q70);
    let r4_q88 = mul_high_signed(r2_q76, r2_q76);
    // sin r = r - r³·(1/6 - r²/120), 1 - cos r = r²/2 - r⁴·(1/24 - r²/720); what is left out is below 2^-70.
    let r3_q82 = mul_high_signed(r_q70, r2_q76);
    let sixth_q64 = SIXTH_Q64 - mul_high_signed(r2_q76, HUNDRED_TWENTIETH_Q52);
    let sin_q70 = r_q70 - (mul_high_signed(r3_q82, sixth_q64) >> 12);
    let twenty_fourth_q64 = TWENTY_FOURTH_Q64 - mul_high_signed(r2_q76, SEVEN_HUNDRED_TWENTIETH_Q52);
    let versine_q70 = ((r2_q76 >> 1) - (mul_high_signed(r4_q88, twenty_fourth_q64) >> 12)) >> 6;
    // The rotation of (c, s) by r as a difference from it. |sin r| < 2^-8.3 and c, s <= 1: the sums are below 2^125.
    let (s, c) = SIN_COS_Q62[index as usize];
    let rise_q132 = c as i128 * sin_q70 as i128 - s as i128 * versine_q70 as i128;
    let fall_q132 = s as i128 * sin_q70 as i128 + c as i128 * versine_q70 as i128;
    const HALF: i128 = 1 << 69;
    (s + ((rise_q132 + HALF) >> 70) as i64, c - ((fall_q132 + HALF) >> 70) as i64)
}

/// (sin, cos) in I32F32 of I32F32 radians, within 0.5001 ulp over the whole range of `i64`.
#[inline]
pub(crate) const fn sin_cos(raw: i64) -> (i64, i64) {
    let (sin, cos) = sin_cos_turn(turn_from_radians(raw));
    (q32_from_q62(sin), q32_from_q62(cos))
}

/// Rounds to nearest, ties to even. |value| <= 2^62 + 1, so adding half a unit cannot wrap.
#[inline]
const fn q32_from_q62(value: i64) -> i64 {
    (value + ((1 << 29) - 1) + ((value >> 30) & 1)) >> 30
}

/// The angle of the vector (x, y) as a turn, within 2^-63 turn; 0 for the zero vector.
///
/// Exactly: mirroring the vector on an axis or a diagonal mirrors the turn, and turning it by a quarter adds ¼.
#[inline]
pub(crate) const fn atan2_turn(y: i64, x: i64) -> u64 {
    let (along, across) = (x.unsigned_abs(), y.unsigned_abs());
    let steep = across > along;
    let (n, d) = if steep { (along, across) } else { (across, along) };
    // The zero vector stands for (1, 0): the turn 0, and no branch.
    let turn = mirrored(atan_turn(n, d | (d == 0) as u64), QUARTER, steep);
    mirrored(mirrored(turn, 2 * QUARTER, x < 0), 0, y < 0)
}

/// `about - turn` if `mirror`, else `turn`. Without a branch: the octants of a stream of vectors cannot be predicted.
#[inline]
const fn mirrored(turn: u64, about: u64, mirror: bool) -> u64 {
    let mask = (mirror as u64).wrapping_neg();
    (turn ^ mask).wrapping_sub(mask).wrapping_add(about & mask)
}

/// The turn of atan(n/d), for n <= d, d > 0: in [0, ⅛], and exact for 0 and 1.
#[inline]
const fn atan_turn(n: u64, d: u64) -> u64 {
    const THIRD_Q64: u64 = ((1u128 << 64) / 3) as u64;
    const FIFTH_Q64: u64 = ((1u128 << 64) / 5) as u64;
    const SEVENTH_Q50: u64 = (1u64 << 50) / 7;

    let shift = d.leading_zeros();
    let (n, d) = (n << shift, d << shift);
    // i/128 nearest to n/d, give or take 2^-31 at the border. n >> 32 < 2^32, d >> 32 >= 2^31.
    let index = ((n >> 32) * 128 + (d >> 33)) / (d >> 32);
    // atan(n/d) = atan(i/128) + atan z, z = (128·n - i·d)/(128·d + i·n), exact up to the division. |z| < 2^-7.99.
    let across = 128 * n as i128 - (index as i128) * d as i128;
    let along = 128 * d as u128 + index as u128 * n as u128;
    // 2^70 <= along < 2^72, so it keeps 62 bits; |across| < 2^64, so 63 more fit. The quotient is below 2^63.1.
    let z_q71 = ((across.unsigned_abs() << 63) / (along >> 8)) as u64;
    let z2_q78 = mul_high(z_q71, z_q71);
    // atan z = z - z³·(1/3 - z²·(1/5 - z²/7)); z⁹/9 is below 2^-75.
    let fifth_q64 = FIFTH_Q64 - mul_high(z2_q78, SEVENTH_Q50);
    let third_q64 = THIRD_Q64 - (mul_high(z2_q78, fifth_q64) >> 14);
    let z3_q85 = mul_high(z_q71, z2_q78);
    let atan_q71 = z_q71 - (mul_high(z3_q85, third_q64) >> 14);
    let turn = (mul_high(atan_q71, INV_TAU_Q66) + (1 << 8)) >> 9;
    let base = ATAN_TURN[index as usize];
    base.wrapping_add(mirrored(turn, 0, across < 0))
}

/// The angle of the vector (x, y) in I32F32 radians, in [-π, π] as rounded, within 0.5001 ulp; 0 for the zero vector.
///
/// The sign is that of `y`: for `y` < 0 the result may round to -π, for `y` = 0 and `x` < 0 it is π.
#[inline]
pub(crate) const fn atan2(y: i64, x: i64) -> i64 {
    // From the mirror image above the axis, whose turn is at most ½: the mirror of a result is its negative.
    let turn = atan2_turn(y, x);
    if y < 0 { -radians_from_turn(turn.wrapping_neg()) } else { radians_from_turn(turn) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::round::shr_round;

    /// Turns near every multiple of 1/1024 and spread over all of them.
    fn turns() -> impl Iterator<Item = u64> {
        let borders = (0..1024u64).flat_map(|k| (0..9u64).map(move |d| (k << 54).wrapping_add(d).wrapping_sub(4)));
        let spread = (0..200_000u64).map(|k| k.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        borders.chain(spread)
    }

    #[test]
    fn quarter_turns_and_mirror_images_are_exact() {
        for turn in turns() {
            let (sin, cos) = sin_cos_turn(turn);
            assert_eq!(sin_cos_turn(turn.wrapping_neg()), (-sin, cos), "{turn:#x}");
            assert_eq!(sin_cos_turn(turn.wrapping_add(QUARTER)), (cos, -sin), "{turn:#x}");
            assert_eq!(sin_cos_turn(QUARTER.wrapping_sub(turn)), (cos, sin), "{turn:#x}");
        }
        assert_eq!(sin_cos_turn(0), (0, 1 << 62));
    }

    #[test]
    fn sine_and_cosine_stay_on_the_unit_circle() {
        for turn in turns() {
            let (sin, cos) = sin_cos_turn(turn);
            let square = (i128::from(sin).pow(2) + i128::from(cos).pow(2)) as u128;
            // 2·2^-61 in Q124.
            assert!(square.abs_diff(1 << 124) < 1 << 64, "{turn:#x}");
        }
    }

    #[test]
    fn the_angle_of_sine_and_cosine_is_the_angle() {
        for turn in turns() {
            let (sin, cos) = sin_cos_turn(turn);
            let back = atan2_turn(sin, cos).wrapping_sub(turn) as i64;
            assert!(back.unsigned_abs() <= 3, "{turn:#x}: {back}");
        }
    }

    #[test]
    fn the_angle_turns_and_mirrors_with_the_vector() {
        for (x, y) in turns().map(|turn| {
            let shift = turn % 61;
            let (sin, cos) = sin_cos_turn(turn);
            (cos >> shift, sin >> (shift / 2))
        }) {
            let turn = atan2_turn(y, x);
            if (x, y) != (0, 0) {
                assert_eq!(atan2_turn(x, -y), turn.wrapping_add(QUARTER), "({x}, {y})");
                assert_eq!(atan2_turn(y, -x), (2 * QUARTER).wrapping_sub(turn), "({x}, {y})");
                assert_eq!(atan2_turn(x, y), QUARTER.wrapping_sub(turn), "({x}, {y})");
            }
            assert_eq!(atan2_turn(-y, x), turn.wrapping_neg(), "({x}, {y})");
        }
    }

    #[test]
    fn axes_and_diagonals_are_exact_out_to_the_corners() {
        for far in [1, 3, i64::MAX] {
            assert_eq!(
                [(0, far), (far, 0), (0, -far), (-far, 0)].map(|(y, x)| atan2_turn(y, x)),
                [0, 1, 2, 3].map(|k| k * QUARTER)
            );
            let diagonals = [(far, far), (far, -far), (-far, -far), (-far, far)];
            assert_eq!(diagonals.map(|(y, x)| atan2_turn(y, x)), [1, 3, 5, 7].map(|k| k * EIGHTH));
        }
        assert_eq!(atan2_turn(i64::MIN, i64::MIN), 5 * EIGHTH);
        assert_eq!(atan2_turn(0, i64::MIN), 2 * QUARTER);
        assert_eq!(atan2_turn(-1, i64::MIN), 2 * QUARTER);
        assert_eq!(atan2(0, i64::MIN), 13_493_037_705);
        assert_eq!(atan2(-1, i64::MIN), -13_493_037_705);
        assert_eq!(atan2(0, 0), 0);
    }

    #[test]
    fn sines_round_to_even_at_every_tie() {
        for floor in [-1 << 32, -3, -2, -1, 0, 1, 2, 3, (1 << 32) - 1] {
            for rest in [0, 1, (1 << 29) - 1, 1 << 29, (1 << 29) + 1, (1 << 30) - 1] {
                let value: i64 = (floor << 30) + rest;
                assert_eq!(i128::from(q32_from_q62(value)), shr_round(value.into(), 30), "{floor} and {rest}");
            }
        }
        assert_eq!([(1 << 62) + 1, -(1 << 62) - 1].map(q32_from_q62), [1 << 32, -1 << 32]);
    }

    #[test]
    fn radians_are_read_as_they_were_set() {
        let tau = radians_from_turn(u64::MAX);
        let spread = (0..100_000).map(|k| (k as i64).wrapping_mul(0x9e37_79b9_7f4a_7c15u64 as i64).rem_euclid(tau + 1));
        for raw in (0..1000).chain(tau - 1000..=tau).chain(spread) {
            assert_eq!(radians_from_turn(turn_from_radians(raw)), raw);
            assert_eq!(turn_from_radians(-raw), turn_from_radians(raw).wrapping_neg());
        }
        assert_eq!(tau, 26_986_075_409);
    }
}
