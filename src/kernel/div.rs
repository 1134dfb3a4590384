//! Division, rounded to nearest, ties to even.

/// `n / d`, rounded to nearest, ties to even, for `d != 0`.
///
/// The one quotient that does not fit, `i128::MIN / -1`, wraps to `i128::MIN`.
///
/// # Panics
/// When `d` is zero.
#[inline]
pub(crate) const fn div_round(n: i128, d: i128) -> i128 {
    let magnitude = div_round_u(n.unsigned_abs(), d.unsigned_abs());
    let quotient = magnitude as i128;
    if (n < 0) != (d < 0) { quotient.wrapping_neg() } else { quotient }
}

/// `n / d`, rounded to nearest, ties to even, for `d != 0`.
///
/// # Panics
/// When `d` is zero.
#[inline]
pub(crate) const fn div_round_u(n: u128, d: u128) -> u128 {
    let floor = n / d;
    let rest = n - floor * d;
    // rest < d, so d - rest does not wrap where 2·rest could. A rest leaves d >= 2, so floor + 1 < 2^128.
    let up = rest > d - rest || (rest == d - rest && floor & 1 == 1);
    floor + up as u128
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_even_whatever_the_signs() {
        for (n, expected) in [(1, 0), (3, 2), (5, 2), (7, 4)] {
            assert_eq!(div_round(n, 2), expected);
            assert_eq!(div_round(-n, 2), -expected);
            assert_eq!(div_round(n, -2), -expected);
            assert_eq!(div_round(-n, -2), expected);
        }
    }

    #[test]
    fn the_largest_operands_do_not_wrap() {
        assert_eq!(div_round(i128::MAX, i128::MAX), 1);
        assert_eq!(div_round(i128::MIN, i128::MIN), 1);
        assert_eq!(div_round(i128::MIN, i128::MAX), -1);
        assert_eq!(div_round(i128::MIN, 1), i128::MIN);
        assert_eq!(div_round_u(u128::MAX, 2), 1 << 127); // 2^127 - ½ is a tie between an odd and an even number
        assert_eq!(div_round_u(u128::MAX - 1, u128::MAX), 1);
    }
}
