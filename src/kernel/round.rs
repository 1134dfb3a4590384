//! Division by a power of two, rounded to nearest: ties to even, as every product and public value, or away from zero.

/// `a / 2^s`, rounded to nearest, ties to even. For every `a` and `0 <= s <= 127`.
#[inline]
pub(crate) const fn shr_round(a: i128, s: u32) -> i128 {
    if s == 0 {
        return a;
    }
    let floor = a >> s;
    let rest = a as u128 & ((1 << s) - 1);
    // Up if rest > half, or rest == half and floor is odd. In one comparison, since half >= 1; unlike adding
    // half to `a` first it has nothing that could wrap: |floor| <= 2^126.
    let half = 1 << (s - 1);
    floor + (rest > half - (floor as u128 & 1)) as i128
}

/// `a / 2^s`, rounded to nearest, ties to even. For every `a` and `0 <= s <= 127`.
#[inline]
pub(crate) const fn shr_round_u(a: u128, s: u32) -> u128 {
    if s == 0 {
        return a;
    }
    let floor = a >> s;
    let rest = a & ((1 << s) - 1);
    // As above; floor < 2^127.
    let half = 1 << (s - 1);
    floor + (rest > half - (floor & 1)) as u128
}

/// [`shr_round_u`] for `0 <= s <= 63`, in fewer instructions: the rest is a word.
#[inline]
pub(crate) const fn shr_round_short(a: u128, s: u32) -> u128 {
    let s = s & 63;
    let floor = a >> s;
    let rest = a as u64 & ((1 << s) - 1);
    // 2·rest < 2^64 and even: the last bit of the floor goes beside it. Where s = 0 there is no rest, and 1 > 1 is false.
    floor + (2 * rest + (floor as u64 & 1) > 1 << s) as u128
}

/// `a / 2^s` to nearest, ties away from zero: odd. *Domain* |a| <= 2^126, 0 < s < 127.
#[inline(always)]
pub(crate) const fn odd_shift(a: i128, s: u32) -> i128 {
    (a + ((1 << (s - 1)) + (a >> 127))) >> s
}

/// [`odd_shift`] by 64 bits: the upper word, without a shift. *Domain* |value| < 2^126.
#[inline(always)]
pub(crate) const fn upper(value: i128) -> i64 {
    // A double word throughout: compilers choose between two halves by a branch, and signs cannot be predicted.
    odd_shift(value, 64) as i64
}

/// The lower word of [`odd_shift`]: all of it, if the result fits. *Domain* |value| < 2^126, and 1 ≤ bits ≤ 63.
#[inline(always)]
pub(crate) const fn lowered_low(value: i128, bits: i32) -> i64 {
    // A half, less by one for a negative value.
    let half = (1_u64 << (bits - 1)).wrapping_add((value >> 127) as u64);
    ((value + half as i128) >> bits) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_even_on_both_sides_of_zero() {
        let halves = [-5, -3, -1, 1, 3, 5].map(|odd: i128| shr_round(odd << 31, 32));
        assert_eq!(halves, [-2, -2, 0, 0, 2, 2]);
        let eighths = [-13, -12, -11, -5, -4, -3, 3, 4, 5, 11, 12, 13].map(|n: i128| shr_round(n, 3));
        assert_eq!(eighths, [-2, -2, -1, -1, 0, 0, 0, 0, 1, 1, 2, 2]);
    }

    #[test]
    fn short_shifts_round_alike() {
        for s in 0..64 {
            for floor in [0, 1, 2, 3, u64::MAX >> 1, u64::MAX] {
                for rest in [0, 1, 1 << s >> 1, (1 << s >> 1) + 1, (1u128 << s) - 1] {
                    // Where s is 0 the rest is a part of the floor.
                    let a = (u128::from(floor) << s) + rest;
                    for a in [a, a.wrapping_sub(1), a | 1 << 127] {
                        assert_eq!(shr_round_short(a, s), shr_round_u(a, s), "{a} >> {s}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_ends_of_the_range_round_without_wrapping() {
        for s in 0..=127 {
            let nearest = |a: i128| {
                let (floor, rest) = (a >> s, a & ((1i128 << s).wrapping_sub(1)));
                let up = match (rest as u128 * 2).cmp(&(1 << s)) {
                    core::cmp::Ordering::Less => false,
                    core::cmp::Ordering::Equal => floor & 1 == 1,
                    core::cmp::Ordering::Greater => true,
                };
                floor + i128::from(up)
            };
            for a in [i128::MIN, i128::MIN + 1, -1, 0, 1, i128::MAX - 1, i128::MAX] {
                assert_eq!(shr_round(a, s), nearest(a), "{a} >> {s}");
            }
            assert_eq!(shr_round_u(u128::MAX, s), if s == 0 { u128::MAX } else { 1 << (128 - s) });
        }
    }
}
