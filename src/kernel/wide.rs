//! Products of 192 and 256 bits, and the few things done to them: shift with rounding, divide.

/// a·b as (high, low) halves of 128 bits.
pub(crate) const fn mul_128(a: u128, b: u128) -> (u128, u128) {
    const LOW: u128 = u64::MAX as u128;
    let (a1, a0, b1, b0) = (a >> 64, a & LOW, b >> 64, b & LOW);
    // Each partial product is at most (2^64 − 1)² = 2^128 − 2^65 + 1, so adding two 64-bit halves to it cannot wrap.
    let low = a0 * b0;
    let mid = a1 * b0 + (low >> 64);
    let mid2 = a0 * b1 + (mid & LOW);
    (a1 * b1 + (mid >> 64) + (mid2 >> 64), (mid2 << 64) | (low & LOW))
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
    let left = shift.unsigned_abs();
    if high != 0 || left > 127 || (left > 0 && low >> (128 - left) != 0) {
        return if high == 0 && low == 0 { Some(0) } else { None };
    }
    Some(low << left)
}

/// a·b / 2^shift to nearest, ties to even; `None` if it leaves i128. Odd in `a`.
pub(crate) const fn mul_shift(a: i128, b: u128, shift: i32) -> Option<i128> {
    let (high, low) = mul_128(a.unsigned_abs(), b);
    match shift_round_256(high, low, shift) {
        Some(magnitude) if magnitude <= i128::MAX as u128 => {
            let magnitude = magnitude as i128;
            Some(if a < 0 { -magnitude } else { magnitude })
        }
        _ => None,
    }
}

/// (high·2^128 + low) / d, rounded down, and the remainder. *Domain* high < d, so that the quotient has 128 bits.
///
/// *Source* Knuth, The Art of Computer Programming 2, 4.3.1, algorithm D, with two digits of 64 bits.
pub(crate) const fn div_256(high: u128, low: u128, d: u128) -> (u128, u128) {
    if high == 0 {
        return (low / d, low % d);
    }
    let s = d.leading_zeros();
    let d = d << s;
    let (high, low) = if s == 0 { (high, low) } else { ((high << s) | (low >> (128 - s)), low << s) };
    let (q1, r) = div_digit(high, low >> 64, d);
    let (q0, r) = div_digit(r, low & (u64::MAX as u128), d);
    ((q1 << 64) | q0, r >> s)
}

/// One digit: (high·2^64 + next) / d with d's top bit set, high < d, next < 2^64.
const fn div_digit(high: u128, next: u128, d: u128) -> (u128, u128) {
    let (d1, d0) = (d >> 64, d & (u64::MAX as u128));
    let mut q = high / d1;
    let mut r = high % d1;
    // Knuth's step D3: the guess is too large by at most two; r < 2^64 keeps r << 64 within 128 bits.
    while q >> 64 != 0 || q * d0 > ((r << 64) | next) {
        q -= 1;
        r += d1;
        if r >> 64 != 0 {
            break;
        }
    }
    // The true remainder is below d < 2^128, so the wrapped difference is it.
    (q, (high << 64 | next).wrapping_sub(q.wrapping_mul(d)))
}

/// a·b / d to nearest, ties to even; `None` if it leaves u128. *Domain* d > 0.
pub(crate) const fn mul_div_round(a: u128, b: u128, d: u128) -> Option<u128> {
    let (high, low) = mul_128(a, b);
    if high >= d {
        return None;
    }
    let (q, r) = div_256(high, low, d);
    let rest = d - r;
    if r > rest || (r == rest && q & 1 == 1) { q.checked_add(1) } else { Some(q) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_quotient_and_the_remainder_make_the_dividend(d in 1u128.., q: u128, r: u128, s in 0u32..127) {
            let d = (d >> s).max(1);
            let r = r % d;
            let (high, low) = mul_128(q, d);
            let (low, carry) = low.overflowing_add(r);
            prop_assert_eq!(div_256(high + u128::from(carry), low, d), (q, r));
        }

        #[test]
        fn a_product_shifted_back_is_the_factor(a: i128, s in 0u32..128) {
            prop_assume!(a != i128::MIN);
            prop_assert_eq!(mul_shift(a, 1 << s, s as i32), Some(a));
        }
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
