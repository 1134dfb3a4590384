//! Division rounded to nearest, ties to even, and division of up to 256 bits by multiplication with a reciprocal.
//!
//! Few processors can divide 128 bits by 64. With the reciprocal of the divisor a digit of 64 bits takes three multiplications,
//! and one reciprocal serves for all that is divided by it.
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

/// ⌊(2^192 − 1) / d⌋ − 2^64, with which [`div_by`] divides by `d`. *Domain* `d` has its top bit set.
///
/// *Source* algorithm 6.
#[inline]
pub(crate) const fn reciprocal(d: u128) -> u64 {
    let (d1, d0) = ((d >> 64) as u64, d as u64);
    // The reciprocal v of the upper word, lowered as long as (2^64 + v)·d exceeds 2^192 − 1: `above` is the upper word of that
    // product, modulo 2^64, and a carry out of it says so. There are carries as often as not: no branch.
    let v = word_reciprocal(d1);
    let (above, carry) = d1.wrapping_mul(v).overflowing_add(d0);
    let excess = carry as u64 + (carry & (above >= d1)) as u64;
    let (v, above) = (v.wrapping_sub(excess), above.wrapping_sub(excess.wrapping_mul(d1)));
    let cross = v as u128 * d0 as u128;
    let (above, carry) = above.overflowing_add((cross >> 64) as u64);
    let is_twice = ((above as u128) << 64 | cross as u64 as u128) >= d;
    let excess = carry as u64 + (carry & is_twice) as u64;
    v.wrapping_sub(excess)
}

/// One digit: (high·2^64 + next) / d, rounded down, and the remainder. *Domain* high < d, and d has its [`reciprocal`].
///
/// *Source* algorithm 5.
#[inline]
const fn digit(high: u128, next: u64, d: u128, reciprocal: u64) -> (u64, u128) {
    let (d1, d0) = ((d >> 64) as u64, d as u64);
    // With l the lower word of `high`, at most 2^128·(high − l)/d + l <= 2^128·high/d < 2^128.
    let estimate = reciprocal as u128 * (high >> 64) + high;
    let q = (estimate >> 64) as u64;
    // The remainder of the digit q + 1.
    let upper = (high as u64).wrapping_sub(q.wrapping_mul(d1));
    let r = ((upper as u128) << 64 | next as u128).wrapping_sub(q as u128 * d0 as u128).wrapping_sub(d);
    // One too many about as often as not, so without a branch; hardly ever one too few.
    let over = (r >> 64) as u64 >= estimate as u64;
    let (q, r) = (q.wrapping_add(!over as u64), r.wrapping_add(d & (over as u128).wrapping_neg()));
    if r >= d { one_more(q, r, d) } else { (q, r) }
}

#[cold]
const fn one_more(q: u64, r: u128, d: u128) -> (u64, u128) {
    (q + 1, r - d)
}

/// (high·2^128 + low) / d, rounded down, and the remainder, given the [`reciprocal`] of `d`. *Domain* high < d, so that the
/// quotient has 128 bits.
#[inline]
pub(crate) const fn div_by(high: u128, low: u128, d: u128, reciprocal: u64) -> (u128, u128) {
    let (q1, r) = digit(high, (low >> 64) as u64, d, reciprocal);
    let (q0, r) = digit(r, low as u64, d, reciprocal);
    ((q1 as u128) << 64 | q0 as u128, r)
}

/// (high·2^128 + low) / d to nearest, ties to even, given the [`reciprocal`] of `d`; `None` if it leaves u128.
#[inline]
pub(crate) const fn div_round_by(high: u128, low: u128, d: u128, reciprocal: u64) -> Option<u128> {
    if high >= d {
        return None;
    }
    let (q, r) = div_by(high, low, d, reciprocal);
    // Up if r > d − r, or if they are equal and q is odd. r < d.
    q.checked_add((r > d - r - (q & 1)) as u128)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::cases;
    use dashu_int::UBig;
    use proptest::prelude::*;

    /// Any word, and as often one next to a power of two, or one that ends in zeros.
    fn word() -> impl Strategy<Value = u64> {
        let beside_power = (0u32..64, 0u64..8, any::<bool>()).prop_map(|(k, off, below)| {
            let power = 1u64 << k;
            if below { power.wrapping_sub(off) } else { power.wrapping_add(off) }
        });
        prop_oneof![any::<u64>(), beside_power, (any::<u64>(), 0u32..64).prop_map(|(word, k)| word >> k << k)]
    }

    /// A divisor with its top bit set.
    fn divisor() -> impl Strategy<Value = u128> {
        (word(), word()).prop_map(|(high, low)| u128::from(high) << 64 | u128::from(low) | 1 << 127)
    }

    /// The two halves of 128 bits of a number below 2^256.
    fn halves(n: &UBig) -> (u128, u128) {
        let low = n & UBig::from(u128::MAX);
        (u128::try_from(n >> 128).expect("below 2^256"), u128::try_from(low).expect("128 bits"))
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
        #![proptest_config(cases(10_000))]

        #[test]
        fn the_reciprocal_of_a_word_is_exact(d in word()) {
            let d = d | 1 << 63;
            prop_assert_eq!(u128::from(word_reciprocal(d)), u128::MAX / u128::from(d) - (1 << 64));
        }

        #[test]
        fn the_reciprocal_of_a_divisor_is_exact(d in divisor()) {
            let exact = (UBig::from(1u8) << 192) - UBig::from(1u8);
            prop_assert_eq!(UBig::from(reciprocal(d)), exact / UBig::from(d) - (UBig::from(1u8) << 64));
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

        #[test]
        fn a_divisor_gives_back_the_quotient_and_the_remainder(d in divisor(), q in divisor(), s in 0u32..128, r in divisor()) {
            let q = q >> s;
            for r in [r % d, 0, 1, d - 1] {
                let (high, low) = halves(&(UBig::from(q) * UBig::from(d) + UBig::from(r)));
                prop_assert_eq!(div_by(high, low, d, reciprocal(d)), (q, r));
            }
        }

        #[test]
        fn quotients_round_to_nearest_and_ties_to_even(d in divisor(), q in divisor(), s in 0u32..128, off in 0u128..3) {
            // Around the tie above q, and any way from it.
            let q = q >> s;
            for r in [(d >> 1).saturating_sub(off), (d >> 1) + off, d - 1 - off] {
                let (high, low) = halves(&(UBig::from(q) * UBig::from(d) + UBig::from(r)));
                let twice = UBig::from(r) * UBig::from(2u8);
                let up = twice > UBig::from(d) || (twice == UBig::from(d) && q & 1 == 1);
                prop_assert_eq!(div_round_by(high, low, d, reciprocal(d)), q.checked_add(up.into()));
            }
        }
    }

    #[test]
    fn a_quotient_beyond_128_bits_is_none() {
        const D: u128 = 1 << 127;
        let divide = |high, low| div_round_by(high, low, D, reciprocal(D));
        assert_eq!(divide(D, 0), None);
        assert_eq!(divide(D - 1, u128::MAX), None, "it rounds up to 2^128");
        assert_eq!(divide(D - 1, 0), Some(u128::MAX - 1));
        assert_eq!(divide(D - 1, 1 << 126), Some(u128::MAX - 1), "a tie");
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
