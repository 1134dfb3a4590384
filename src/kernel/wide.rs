//! Products of 192 and 256 bits, and the few things done to them: shift with rounding, divide.

use super::div::{div_by, reciprocal};

/// a·b as (high, low) halves of 128 bits.
#[inline]
pub(crate) const fn mul_128(a: u128, b: u128) -> (u128, u128) {
    const LOW: u128 = u64::MAX as u128;
    let (a1, a0, b1, b0) = (a >> 64, a & LOW, b >> 64, b & LOW);
    // Each partial product is at most (2^64 − 1)² = 2^128 − 2^65 + 1, so adding two 64-bit halves to it cannot wrap.
    let low = a0 * b0;
    let mid = a1 * b0 + (low >> 64);
    let mid2 = a0 * b1 + (mid & LOW);
    (a1 * b1 + (mid >> 64) + (mid2 >> 64), (mid2 << 64) | (low & LOW))
}

/// a·b as (high, low), the low part of 64 bits.
#[inline]
pub(crate) const fn mul_192(a: u128, b: u64) -> (u128, u64) {
    let low = (a as u64) as u128 * b as u128;
    // At most (2^64 − 1)² + 2^64 − 1: it does not wrap.
    ((a >> 64) * b as u128 + (low >> 64), low as u64)
}

/// (high·2^128 + low) / 2^shift to nearest, ties to even; `None` if the result exceeds 128 bits.
pub(crate) const fn shr_round_256(high: u128, low: u128, shift: u32) -> Option<u128> {
    let (quotient, half, sticky) = match shift {
        0 => return if high == 0 { Some(low) } else { None },
        1..=127 => {
            if high >> shift != 0 {
                return None;
            }
            let quotient = (high << (128 - shift)) | (low >> shift);
            (quotient, (low >> (shift - 1)) & 1 == 1, low & ((1 << (shift - 1)) - 1) != 0)
        }
        128 => (high, low >> 127 == 1, low << 1 != 0),
        129..=255 => {
            let s = shift - 128;
            (high >> s, (high >> (s - 1)) & 1 == 1, high & ((1 << (s - 1)) - 1) != 0 || low != 0)
        }
        256 => (0, high >> 127 == 1, high << 1 != 0 || low != 0),
        _ => return Some(0),
    };
    if half && (sticky || quotient & 1 == 1) { quotient.checked_add(1) } else { Some(quotient) }
}

/// (high·2^128 + low) · 2^left / 2^right with left, right in one signed shift (positive: right).
pub(crate) const fn shift_round_256(high: u128, low: u128, shift: i32) -> Option<u128> {
    if shift >= 0 {
        return shr_round_256(high, low, shift.unsigned_abs());
    }
    // 1 or more.
    let left = shift.unsigned_abs();
    if high != 0 || left > 127 || low >> (128 - left) != 0 {
        return if high == 0 && low == 0 { Some(0) } else { None };
    }
    Some(low << left)
}

/// a·b / 2^shift to nearest, ties to even; `None` if it leaves i128. Odd in `a`.
#[inline]
pub(crate) const fn mul_shift(a: i128, b: u128, shift: i32) -> Option<i128> {
    let (high, low) = mul_128(magnitude(a), b);
    shifted(a, high, low, shift)
}

/// [`mul_shift`] by 64 bits: half of the products, and shifts by less than 64.
///
/// Always inlined: as a call it costs forces a few percent.
#[inline(always)]
pub(crate) const fn mul_shift_64(a: i128, b: u64, shift: i32) -> Option<i128> {
    let s = shift as u32;
    let (floor, rest) = match shift {
        // Moved up so that the point is between two words of the product. What leaves the upper word repeats its sign.
        1..=64 if ((a >> 64) as i64 >> (s - 1)).wrapping_add(1) as u64 <= 1 => {
            mul_192_signed(a << (s.wrapping_neg() & 63), b)
        }
        65..128 => {
            let (high, low) = mul_192_signed(a, b);
            let s = s & 63;
            // What is cut off is gathered in the last bit of the rest, which a half does not have.
            let cut_off = low & ((1 << s) - 1) != 0;
            (high >> s, (((high as u64 as u128) << 64 | low as u128) >> s) as u64 | cut_off as u64)
        }
        _ => return mul_shift_apart(a, b, shift),
    };
    // Up if the rest is above half, or half and the floor odd: ties to even need no magnitude. In units of 2^-64 half is 2^63. The floor
    // is below 2^127 − 1, as the product is at most 2^127 − 2^63 units.
    let (_, up) = rest.overflowing_add((1 << 63) - 1 + (floor as u64 & 1));
    Some(floor + up as i128)
}

/// a·b as high·2^64 + low, rounded down: |high| <= 2^127 − 2^63.
#[inline(always)]
const fn mul_192_signed(a: i128, b: u64) -> (i128, u64) {
    let (low, upper) = (a as u64 as u128 * b as u128, (a >> 64) as u64);
    // A negative upper word was taken for 2^64 more. What wraps does so on the way to the sum, which fits.
    let more = ((a >> 127) as u64 & b) as u128;
    let high = (upper as u128 * b as u128).wrapping_sub(more << 64).wrapping_add(low >> 64);
    (high as i128, low as u64)
}

/// [`mul_shift_64`] for a large product, or a shift out of the usual.
#[cold]
#[inline(never)]
const fn mul_shift_apart(a: i128, b: u64, shift: i32) -> Option<i128> {
    mul_shift(a, b as u128, shift)
}

/// (high·2^128 + low) / 2^shift to nearest, ties to even, with the sign of `sign`; `None` if it leaves i128.
#[inline(always)]
const fn shifted(sign: i128, high: u128, low: u128, shift: i32) -> Option<i128> {
    let rounded = if 0 < shift && shift < 128 {
        // Nearly every product comes this way: it is worth its own few shifts.
        let s = shift as u32;
        if high >> (s - 1) != 0 {
            return None;
        }
        // floor < 2^127; the rest is in units of 2^-128, half is 2^127.
        let floor = (high << (128 - s)) | (low >> s);
        let rest = low << (128 - s);
        floor + (rest > (1 << 127) - (floor & 1)) as u128
    } else {
        match shift_round_256(high, low, shift) {
            Some(rounded) => rounded,
            None => return None,
        }
    };
    if rounded > i128::MAX as u128 { None } else { Some(with_sign(rounded as i128, sign)) }
}

/// |a|, without a branch.
#[inline]
pub(crate) const fn magnitude(a: i128) -> u128 {
    with_sign(a, a) as u128
}

/// `magnitude` with the sign of `sign`. Without a branch: the signs of offsets cannot be predicted.
#[inline]
pub(crate) const fn with_sign(magnitude: i128, sign: i128) -> i128 {
    let mask = sign >> 127;
    (magnitude ^ mask).wrapping_sub(mask)
}

/// (high·2^128 + low) / d, rounded down, and the remainder. *Domain* high < d, so that the quotient has 128 bits.
pub(crate) const fn div_256(high: u128, low: u128, d: u128) -> (u128, u128) {
    let s = d.leading_zeros();
    let (d, high, low) = (d << s, (high << s) | (low >> 1 >> (127 - s)), low << s);
    let (q, r) = div_by(high, low, d, reciprocal(d));
    (q, r >> s)
}

/// `a·num / den`, rounded down. *Domain* num <= den, so that it fits.
pub(crate) const fn mul_ratio(a: u128, num: u32, den: u32) -> u128 {
    let d = den as u64;
    let (mut quotient, mut rest, mut place) = (0, 0, 128);
    // By 32 bits at a time, for which there is an instruction: rest < d < 2^32.
    while place > 0 {
        place -= 32;
        let part = rest << 32 | (a >> place) as u32 as u64;
        quotient = quotient << 32 | (part / d) as u128;
        rest = part % d;
    }
    // a = quotient·d + rest, and the product of the rest is below 2^64.
    quotient * num as u128 + (rest * num as u64 / d) as u128
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::cases;
    use core::cmp::Ordering;
    use dashu_int::UBig;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_ratio_of_a_number_is_rounded_down(a: u128, cut in 0u32..128, num: u32, den in 1u32.., few in 0u32..32) {
            let (a, num, den) = (a >> cut, (num >> few).min(den), den);
            let exact = UBig::from(a) * UBig::from(num) / UBig::from(den);
            prop_assert_eq!(UBig::from(mul_ratio(a, num, den)), exact);
        }

        #[test]
        fn the_quotient_and_the_remainder_make_the_dividend(d in 1u128.., q: u128, r: u128, s in 0u32..127) {
            let d = (d >> s).max(1);
            let r = r % d;
            let (high, low) = mul_128(q, d);
            let (low, carry) = low.overflowing_add(r);
            prop_assert_eq!(div_256(high + u128::from(carry), low, d), (q, r));
        }

        #[test]
        fn shifted_products_are_the_nearest(a: i128, b: u128, cut in (0u32..128, 0u32..128), shift in -130i32..260, tie: bool) {
            let (a, b) = (a >> cut.0, b >> cut.1);
            // Odd multiples of half a unit among them.
            let b = if tie && (1..128).contains(&shift) { (b >> (shift - 1) | 1) << (shift - 1) } else { b };
            let product = UBig::from(a.unsigned_abs()) * UBig::from(b);
            let exact = if shift <= 0 {
                product << shift.unsigned_abs() as usize
            } else {
                let unit = UBig::ONE << shift as usize;
                let (floor, rest) = (&product / &unit, &product % &unit);
                let up = match (rest * 2u8).cmp(&unit) {
                    Ordering::Less => false,
                    Ordering::Equal => &floor % 2u8 == 1,
                    Ordering::Greater => true,
                };
                floor + u8::from(up)
            };
            let fits = i128::try_from(&exact).ok().map(|exact| if a < 0 { -exact } else { exact });
            prop_assert_eq!(mul_shift(a, b, shift), fits);
            prop_assert_eq!(mul_shift_64(a, b as u64, shift), mul_shift(a, (b as u64).into(), shift));
        }

        #[test]
        fn narrow_products_are_the_wide_ones(a: u128, b: u64) {
            let (high, low) = mul_192(a, b);
            prop_assert_eq!((high >> 64, high << 64 | u128::from(low)), mul_128(a, b.into()));
        }

        #[test]
        fn a_product_shifted_back_is_the_factor(a: i128, s in 0u32..128) {
            prop_assume!(a != i128::MIN);
            prop_assert_eq!(mul_shift(a, 1 << s, s as i32), Some(a));
        }
    }

    #[test]
    fn products_at_the_ends_of_the_range_fit_or_do_not() {
        assert_eq!(mul_shift(i128::MAX, 1, 0), Some(i128::MAX));
        assert_eq!(mul_shift(i128::MIN, 1, 0), None);
        assert_eq!(mul_shift(i128::MIN, 1, 1), Some(-1 << 126));
        assert_eq!(mul_shift(i128::MAX, 3, 1), None);
        assert_eq!(mul_shift(i128::MAX, u128::MAX, 128), Some(i128::MAX));
        assert_eq!(mul_shift((1 << 126) + 1, (1 << 127) - 2, 127), Some(1 << 126));
        assert_eq!(mul_shift(i128::MAX, (1 << 64) - 1, 63), None);
        assert_eq!(
            [magnitude(i128::MIN), magnitude(-1), magnitude(0), magnitude(i128::MAX)],
            [1 << 127, 1, 0, i128::MAX as u128]
        );
    }

    #[test]
    fn ties_go_to_even_at_every_shift() {
        for s in 1..=127 {
            assert_eq!(shr_round_256(0, 1 << (s - 1), s), Some(0), "½ at {s}");
            assert_eq!(shr_round_256(0, (1 << (s - 1)) + 1, s), Some(1), "above ½ at {s}");
        }
        assert_eq!(shr_round_256(1, 1 << 127, 128), Some(2), "1½ goes up to 2");
        assert_eq!(shr_round_256(2, 1 << 127, 128), Some(2), "2½ goes down to 2");
        assert_eq!(shr_round_256(1 << 127, 0, 256), Some(0));
        assert_eq!(shr_round_256(1 << 127, 1, 256), Some(1));
        assert_eq!(shr_round_256(u128::MAX, 0, 257), Some(0));
    }
}
