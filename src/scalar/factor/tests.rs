//! Factors against exact integers.

use dashu_int::UBig;
use dashu_int::ops::BitTest;
use proptest::prelude::*;

use super::*;
use crate::cases::cases;

/// num · 2^-shift / den to nearest, ties to even, from exact integers.
fn nearest(num: &UBig, den: &UBig, shift: i32) -> FxFactor {
    if *num == UBig::ZERO {
        return FxFactor::ZERO;
    }
    // A quotient of 130 bits or more: its last bit says whether anything is below, which is far from any tie.
    let up = 130 + den.bit_len();
    let (n, unit) = (num << up, UBig::ONE);
    let (quotient, rest) = (&n / den, &n % den);
    let quotient = if rest == UBig::ZERO { quotient } else { quotient | &unit };
    let cut = quotient.bit_len() - 64;
    let (floor, rest, half) = (&quotient >> cut, &quotient % (&unit << cut), &unit << (cut - 1));
    let is_odd = &floor % UBig::from(2u8) == unit;
    let rounded = if rest > half || (rest == half && is_odd) { floor + unit } else { floor };
    let shift = shift + up as i32 - cut as i32;
    match u64::try_from(&rounded) {
        Ok(mantissa) => FxFactor { mantissa, shift },
        Err(_) => FxFactor { mantissa: 1 << 63, shift: shift - 1 },
    }
}

/// Mantissas next to the ends of their range, with long runs of zeros, and any.
fn mantissa() -> impl Strategy<Value = u64> {
    let ends = (0u64..5, any::<bool>()).prop_map(|(off, low)| if low { (1 << 63) + off } else { u64::MAX - off });
    let short = (any::<u64>(), 0u32..63).prop_map(|(word, k)| word >> k << k);
    prop_oneof![any::<u64>(), ends, short].prop_map(|word| word | 1 << 63)
}

fn factor() -> impl Strategy<Value = FxFactor> {
    (mantissa(), -200i32..200).prop_map(|(mantissa, shift)| FxFactor { mantissa, shift })
}

proptest! {
    #![proptest_config(cases(5_000))]

    #[test]
    fn values_round_to_nearest_and_ties_to_even(mantissa in mantissa(), below: u64, tie in 0u8..4, cut in 0u32..128) {
        let below = [below, 1 << 63, (1 << 63) - 1, (1 << 63) + 1][usize::from(tie)];
        let value = (u128::from(mantissa) << 64 | u128::from(below)) >> cut;
        prop_assert_eq!(FxFactor::new(value, 7), nearest(&UBig::from(value), &UBig::ONE, 7));
    }

    /// Quotients at a tie, and beside it by one of the bits below.
    #[test]
    fn quotients_of_256_bits_round_to_nearest_and_ties_to_even(
        mantissa in mantissa(),
        divisor in prop_oneof![Just(1), Just(12), 1..u32::MAX],
        up in 0usize..=126,
        bit in 0usize..=126,
        beside in 0u8..3,
    ) {
        let tie = ((UBig::from(mantissa) * 2u8 + UBig::ONE) * divisor) << up;
        let bit = UBig::ONE << bit.min(up);
        let value = tie + &bit * beside - bit;
        let low = &value & &((UBig::ONE << 128) - UBig::ONE);
        let [high, low] = [&value >> 128, low].map(|half| u128::try_from(half).expect("128 bits"));
        let exact = nearest(&value, &UBig::from(divisor), 5);
        prop_assert_eq!(FxFactor::from_256(high, low, divisor, 5), exact);
    }

    #[test]
    fn products_and_quotients_round_to_nearest_and_ties_to_even(a in factor(), b in factor()) {
        let (m, n) = (UBig::from(a.mantissa), UBig::from(b.mantissa));
        prop_assert_eq!(a.times(b), nearest(&(&m * &n), &UBig::ONE, a.shift + b.shift));
        prop_assert_eq!(a.over(b), nearest(&m, &n, a.shift - b.shift));
        prop_assert_eq!(a.over(a), FxFactor::ONE);
    }
}

#[test]
fn zero_times_and_over_anything_is_zero() {
    let (zero, large) = (FxFactor::ZERO, FxFactor::new(u128::MAX, 3));
    assert_eq!([zero.times(large), large.times(zero), zero.times(zero), zero.over(large)], [zero; 4]);
}

#[test]
fn quotients_next_to_one_do_not_carry() {
    for (a, b) in [(u64::MAX - 1, u64::MAX), (u64::MAX, u64::MAX - 1), (1 << 63, (1 << 63) + 1), (u64::MAX, 1 << 63)] {
        let quotient = FxFactor { mantissa: a, shift: 0 }.over(FxFactor { mantissa: b, shift: 0 });
        assert_eq!(quotient, nearest(&UBig::from(a), &UBig::from(b), 0), "{a} / {b}");
    }
}
