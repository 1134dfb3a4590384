//! Division: to nearest, ties to even; and of 128 bits by 64, which few processors can do, by multiplication with a reciprocal.
//!
//! *Source* of the algorithms: Möller and Granlund, Improved division by invariant integers, IEEE Transactions on Computers 60
//! (2011), with a proof of each.

use super::mul_high;

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

/// ⌊(2^128 − 1) / d⌋ − 2^64 for `d` with its top bit set.
///
/// *Source* algorithm 3: 11 bits from a table, then 21, 34 and 65 by Newton's method, and a last correction. What wraps does
/// so modulo 2^64 on purpose.
#[inline]
const fn word_reciprocal(d: u64) -> u64 {
    /// ⌊(2^19 − 3·2^8) / i⌋ for the upper 9 bits of a divisor, 256 <= i < 512.
    const TABLE: [u16; 256] = {
        let mut table = [0; 256];
        let mut i = 0;
        while i < 256 {
            table[i] = (((1 << 19) - 3 * (1 << 8)) / (256 + i)) as u16;
            i += 1;
        }
        table
    };
    let (odd, upper_40, half) = (d & 1, (d >> 24) + 1, (d >> 1) + (d & 1));
    let v = TABLE[(d >> 55) as usize & 255] as u64;
    let v = (v << 11) - ((v * v * upper_40) >> 40) - 1;
    let v = (v << 13) + ((v * ((1 << 60) - v * upper_40)) >> 47);
    let miss = ((v >> 1) * odd).wrapping_sub(v.wrapping_mul(half));
    let v = (v << 31).wrapping_add(mul_high(v, miss) >> 1);
    let product = v as u128 * d as u128 + d as u128;
    v.wrapping_sub((product >> 64) as u64).wrapping_sub(d)
}

/// `n / d`, rounded down, and the remainder. *Domain* `d` has its top bit set and n < d·2^64, so that the quotient fits.
///
/// *Source* algorithm 4.
#[inline]
pub(crate) const fn div_word(n: u128, d: u64) -> (u64, u64) {
    let (high, low) = ((n >> 64) as u64, n as u64);
    // At most 2^128·high/d + low. With high <= d − 1 and 2^128/d > 2^64 > low that is below 2^128.
    let estimate = word_reciprocal(d) as u128 * high as u128 + n;
    let q = ((estimate >> 64) as u64).wrapping_add(1);
    let r = low.wrapping_sub(q.wrapping_mul(d));
    // One too many about as often as not, so without a branch; hardly ever one too few.
    let over = (r > estimate as u64) as u64;
    let (q, r) = (q.wrapping_sub(over), r.wrapping_add(over * d));
    if r >= d { (q + 1, r - d) } else { (q, r) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Any word, and as often one next to a power of two, or one that ends in zeros.
    fn word() -> impl Strategy<Value = u64> {
        let near = (0u32..64, 0u64..8, any::<bool>()).prop_map(|(k, off, below)| {
            let power = 1u64 << k;
            if below { power.wrapping_sub(off) } else { power.wrapping_add(off) }
        });
        prop_oneof![any::<u64>(), near, (any::<u64>(), 0u32..64).prop_map(|(word, k)| word >> k << k)]
    }

    #[test]
    fn the_reciprocal_of_a_word_is_exact_around_each_entry_of_the_table() {
        let is_exact = |d: u64| u128::from(word_reciprocal(d)) == u128::MAX / u128::from(d) - (1 << 64);
        for entry in 256..512u64 {
            for off in 0..64 {
                assert!(is_exact((entry << 55) + off), "{entry} + {off}");
                assert!(is_exact(((entry + 1) << 55).wrapping_sub(off + 1)), "{entry} + 1 - {off}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 2_000 } else { 100_000 }))]

        #[test]
        fn the_reciprocal_of_a_word_is_exact(d in word()) {
            let d = d | 1 << 63;
            prop_assert_eq!(u128::from(word_reciprocal(d)), u128::MAX / u128::from(d) - (1 << 64));
        }

        #[test]
        fn a_word_divides_as_std_does(d in word(), q in word(), r in word()) {
            let d = d | 1 << 63;
            // Remainders next to 0 and to the divisor among them.
            let r = if r & 1 == 0 { r % d } else { d - 1 - (r >> 1) % d };
            let n = u128::from(q) * u128::from(d) + u128::from(r);
            prop_assert_eq!(div_word(n, d), (q, r));
            prop_assert_eq!((n / u128::from(d), n % u128::from(d)), (q.into(), r.into()));
        }
    }

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
