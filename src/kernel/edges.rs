//! Every kernel where its range proof is tightest: at the ends of domains, on both sides of each power of two and of each
//! border between entries of a table, all with all. Built with overflow checks, a sum that wraps ends the test; what comes out
//! is compared with integers of any size, or with the neighbour on the other side of the border.

use alloc::vec::Vec;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::UBig;

use super::div::*;
use super::exp_log::*;
use super::round::*;
use super::sqrt::*;
use super::trig::*;
use super::wide::*;

type Real = FBig<HalfEven, 2>;

/// 0, the powers of two at the ends of words and halves, their neighbours, and the largest.
fn ends() -> Vec<u128> {
    let powers = [0, 1, 31, 32, 33, 62, 63, 64, 65, 95, 96, 97, 126, 127].map(|k| 1u128 << k);
    let mut ends: Vec<_> = powers.iter().flat_map(|&power| [power - 1, power, power + 1]).collect();
    ends.extend([u128::MAX - 1, u128::MAX]);
    ends.sort_unstable();
    ends.dedup();
    ends
}

fn words() -> Vec<u64> {
    let mut words: Vec<_> = ends().into_iter().map(|end| end as u64).collect();
    words.sort_unstable();
    words.dedup();
    words
}

fn of_either_sign() -> Vec<i128> {
    ends().into_iter().flat_map(|end| [end as i128, (end as i128).wrapping_neg()]).collect()
}

fn whole(high: u128, low: u128) -> UBig {
    (UBig::from(high) << 128) + UBig::from(low)
}

/// Rounds num / den to nearest, ties to even.
fn nearest(num: &UBig, den: &UBig) -> UBig {
    let (floor, twice) = (num / den, (num % den) * 2u8);
    let up = twice > *den || (twice == *den && &floor % 2u8 == 1);
    floor + u8::from(up)
}

/// num / 2^shift to nearest, ties to even; to the left for shifts below zero.
fn shifted(num: &UBig, shift: i32) -> UBig {
    if shift <= 0 { num << shift.unsigned_abs() as usize } else { nearest(num, &(UBig::ONE << shift as usize)) }
}

/// mantissa·2^exponent, computed with in 200 bits.
fn real(mantissa: i128, exponent: isize) -> Real {
    Real::from_parts(mantissa.into(), exponent).with_precision(200).value()
}

/// Returns true if the magnitude of a value is at most num/den.
fn is_within(value: &Real, num: i128, den: i128) -> bool {
    let bound = real(num, 0) / real(den, 0);
    *value <= bound && *value >= -bound
}

const SHIFTS: [i32; 17] = [-200, -128, -127, -64, -1, 0, 1, 2, 63, 64, 126, 127, 128, 129, 255, 256, 257];

#[test]
fn products_at_the_ends() {
    for a in ends() {
        for b in ends() {
            let product = UBig::from(a) * UBig::from(b);
            let (high, low) = mul_128(a, b);
            assert_eq!(whole(high, low), product, "{a:#x} · {b:#x}");
            for shift in SHIFTS {
                let fits = u128::try_from(&shifted(&product, shift)).ok();
                assert_eq!(shift_round_256(high, low, shift), fits, "{a:#x} · {b:#x} >> {shift}");
                let signed = fits.and_then(|fits| i128::try_from(fits).ok());
                // −2^127 has no counterpart above zero, and is refused as that would be.
                let signs = [(a as i128, 1), ((a as i128).wrapping_neg(), -1)];
                for (a, sign) in signs.into_iter().filter(|_| a >> 127 == 0) {
                    assert_eq!(mul_shift(a, b, shift), signed.map(|value| sign * value), "{a:#x} · {b:#x} >> {shift}");
                    let short = b as u64;
                    assert_eq!(
                        mul_shift_64(a, short, shift),
                        mul_shift(a, short.into(), shift),
                        "{a:#x} · {short:#x} >> {shift}"
                    );
                }
            }
            let (high, low) = mul_192(a, b as u64);
            assert_eq!((UBig::from(high) << 64) + low, UBig::from(a) * (b as u64));
        }
    }
}

#[test]
fn shifts_at_the_ends() {
    for a in ends() {
        for s in 0..128 {
            let wanted = shifted(&a.into(), s as i32);
            assert_eq!(UBig::from(shr_round_u(a, s)), wanted, "{a:#x} >> {s}");
            let half = shifted(&(a >> 1).into(), s as i32);
            let signed = i128::try_from(&half).expect("below 2^127");
            assert_eq!([(a >> 1) as i128, -((a >> 1) as i128)].map(|a| shr_round(a, s)), [signed, -signed]);
        }
    }
}

#[test]
fn quotients_at_the_ends() {
    for d in ends().into_iter().filter(|&d| d > 0) {
        for high in ends() {
            for low in ends() {
                let exact = whole(high, low);
                if high < d {
                    let (q, r) = div_256(high, low, d);
                    assert_eq!(
                        (UBig::from(q), UBig::from(r)),
                        (&exact / d, UBig::from(&exact % d)),
                        "{high:#x} {low:#x} / {d:#x}"
                    );
                }
                if d >> 127 == 1 {
                    let fits = u128::try_from(&nearest(&exact, &d.into())).ok();
                    assert_eq!(div_round_by(high, low, d, reciprocal(d)), fits, "{high:#x} {low:#x} / {d:#x}");
                }
            }
            assert_eq!(UBig::from(div_round_u(high, d)), nearest(&high.into(), &d.into()));
        }
    }
    for d in words().into_iter().filter(|&d| d >> 63 == 1) {
        for n in ends().into_iter().filter(|&n| n >> 64 < u128::from(d)) {
            let (q, r) = div_word(n, d);
            assert_eq!((u128::from(q), u128::from(r)), (n / u128::from(d), n % u128::from(d)), "{n:#x} / {d:#x}");
        }
    }
    for n in of_either_sign() {
        for d in of_either_sign().into_iter().filter(|&d| d != 0) {
            let magnitude = div_round_u(n.unsigned_abs(), d.unsigned_abs()) as i128;
            let wanted = if (n < 0) == (d < 0) { magnitude } else { magnitude.wrapping_neg() };
            assert_eq!(div_round(n, d), wanted, "{n:#x} / {d:#x}");
        }
    }
}

#[test]
fn roots_at_the_borders_of_the_table() {
    let ends = [0, 1, u64::MAX >> 1, u64::MAX - 1, u64::MAX];
    // An entry holds for 2^57 of the upper word, and is told apart along 2^41 of it.
    let borders = (32..128u64).flat_map(|entry| [0, 1, 1 << 41, (1 << 57) - 1].map(|along| (entry << 57) + along));
    for upper in borders.chain(words()) {
        for lower in ends {
            let x = u128::from(upper) << 64 | u128::from(lower);
            let floor = u128::from(isqrt(x));
            assert_eq!(floor, x.isqrt(), "{x:#x}");
            assert_eq!(sqrt_round(x), floor + u128::from(x - floor * floor > floor), "{x:#x}");
            if x >> 126 != 0 {
                // In thousandths: (root ± 0.501)² around x · 2^64.
                let (fine, reciprocal) = root_and_reciprocal(x);
                let (root, exact) = (UBig::from(fine) * 1000u32, (UBig::from(x) << 64) * 1_000_000u32);
                assert!((&root - 501u32).pow(2) < exact && exact < (&root + 501u32).pow(2), "{x:#x}");
                // y·√v is 1 within 2^-55, and so is its square within 2^-54.
                let product = UBig::from(reciprocal).pow(2) * UBig::from(x);
                let (exact, apart) = (UBig::ONE << 250, UBig::ONE << 196);
                assert!(&exact - &apart < product && product < exact + apart, "{x:#x}");
            }
        }
        assert_eq!(u128::from(sqrt_fx(upper >> 1)), sqrt_round(u128::from(upper >> 1) << 32), "{upper:#x}");
    }
}

#[test]
fn rotations_at_the_borders_of_the_table() {
    // An entry holds for half of 2^54 either way.
    for border in (0..1 << 10).map(|entry: u64| (entry << 54).wrapping_add(1 << 53)) {
        let pairs = [-2i64, -1, 0, 1].map(|off| sin_cos_turn(border.wrapping_add_signed(off)));
        for pair in pairs.windows(2) {
            // A unit of turn moves either by 2π·2^-64, 1.6 of the last place; each errs by two.
            assert!((pair[0].0 - pair[1].0).abs() <= 5 && (pair[0].1 - pair[1].1).abs() <= 5, "{border:#x}");
        }
        for (sin, cos) in pairs {
            let square = (i128::from(sin).pow(2) + i128::from(cos).pow(2)) as u128;
            assert!(square.abs_diff(1 << 124) < 1 << 64, "{border:#x}");
        }
    }
    for raw in words().into_iter().flat_map(|word| [word as i64, (word as i64).wrapping_neg()]) {
        let (sin, cos) = sin_cos_turn(turn_from_radians(raw));
        let rounded = [sin, cos].map(|value| shr_round(value.into(), 30) as i64);
        assert_eq!(<[i64; 2]>::from(sin_cos(raw)), rounded, "{raw:#x}");
        let apart = turn_from_radians(raw).wrapping_sub(turn_from_radians(raw.saturating_sub(1)));
        // 2^-32 radians are 2^32/2π units of turn.
        assert!(raw == i64::MIN || apart.abs_diff(683_565_276) <= 1, "{raw:#x}");
    }
}

#[test]
fn radians_are_the_nearest_turn() {
    // A raw of 1 is 2^32/2π units of a turn. 160 bits are kept below the unit.
    let unit = UBig::ONE << 160;
    let per_raw = (Real::ONE << 191) / Real::pi(400);
    let per_raw = UBig::try_from(per_raw.to_int().value()).expect("above 0");
    let (turn, half) = (&unit << 64, &unit << 63);
    let spread = (0..10_000u64).map(|k| k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (k % 64));
    for magnitude in words().into_iter().chain(spread).filter(|&word| word <= 1 << 63) {
        let raw = (magnitude as i64).wrapping_neg();
        let nearest = turn_from_radians(raw).wrapping_neg();
        let away = (&per_raw * magnitude + &turn + &half - &unit * nearest) % &turn;
        let bound = &unit * 501u32 / 1000u32;
        assert!(&half - &bound < away && away < &half + &bound, "{magnitude:#x}");
    }
}

#[test]
fn rotations_and_angles_are_within_half_a_unit_of_the_tables_own() {
    // What is added to the entry is half a unit off at most too, and what its terms leave out is a fiftieth of one.
    let bound = (102, 100);
    let tau = Real::pi(200) * real(2, 0);
    let spread = (0..3_000u64).map(|k| k.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    for turn in (0..129u64).map(|entry| (entry << 54) + (1 << 53)).chain(spread) {
        let (exact_sin, exact_cos) = (&tau * real(turn.into(), -64)).sin_cos();
        let (sin, cos) = sin_cos_turn(turn);
        for (value, exact) in [(sin, exact_sin), (cos, exact_cos)] {
            let units = (exact << 62) - real(value.into(), 0);
            assert!(is_within(&units, bound.0, bound.1), "{turn:#x}: {units}");
        }
        // A vector of any length and steepness, and how far it is on from its angle.
        let (y, x) = (sin >> (turn % 61), cos >> (turn % 59));
        let angle = atan2_turn(y, x);
        let (near_sin, near_cos) = (&tau * real(angle.into(), -64)).sin_cos();
        let (y, x) = (real(y.into(), 0), real(x.into(), 0));
        let (across, along) = (&y * &near_cos - &x * &near_sin, x * near_cos + y * near_sin);
        let units = ((across / along) << 64) / &tau;
        assert!(is_within(&units, bound.0, bound.1), "{turn:#x}: {units}");
    }
}

#[test]
fn angles_at_the_borders_of_the_table() {
    // Where i/128 is as near as (i + 1)/128: (2·i + 1)/256 of the longer side, at every length of it.
    for length in (8..63).map(|k| (1i64 << k) - 1).chain([i64::MAX]) {
        for i in 0..128 {
            let across = (i128::from(length) * (2 * i + 1) / 256) as i64;
            let turns = [-1, 0, 1].map(|off| atan2_turn(across + off, length));
            for pair in turns.windows(2) {
                // At most 1/2π of 1/length of a turn on; each is within two units.
                let step = i128::from(pair[1].wrapping_sub(pair[0]) as i64);
                let max_step = (1i128 << 64) / 6 / i128::from(length) + 4;
                assert!((-4..=max_step).contains(&step), "{across} / {length}: {step}");
            }
        }
    }
    for x in words().into_iter().map(|word| word as i64) {
        for y in words().into_iter().map(|word| word as i64) {
            let turn = atan2_turn(y, x);
            let (sin, cos) = sin_cos_turn(turn);
            // The vector lies along its angle: their cross product is no more than 2^-60 of its length.
            let cross = (i128::from(y) >> 1) * (i128::from(cos) >> 1) - (i128::from(x) >> 1) * (i128::from(sin) >> 1);
            let length = u128::from(x.unsigned_abs().max(y.unsigned_abs())) + 1;
            assert!(cross.unsigned_abs() <= 4 * length + (1 << 62), "{x} {y}");
            assert!(atan2(y, x).unsigned_abs() <= 13_493_037_705, "{x} {y}");
        }
    }
}

#[test]
fn logarithms_and_powers_at_the_borders_of_the_tables() {
    let borders = (128..256u64).flat_map(|j| (0..64).map(move |drop| (j << 56) >> drop));
    for raw in borders.chain(words()).filter(|&raw| 1 < raw && raw < u64::MAX) {
        let logarithms = [raw - 1, raw, raw + 1].map(log2_fine);
        // Apart by log2(1 + 1/raw) >= 2^-64, and within 2^-118 each.
        assert!(logarithms[0] < logarithms[1] && logarithms[1] < logarithms[2], "{raw:#x}");
    }
    let ln2 = real(2, 0).ln();
    // The series is longest at both ends of what an entry of the table is for.
    for raw in (128..256u64).flat_map(|j| [j << 56, (j << 56) | ((1 << 56) - 1)]) {
        let exact = real(raw.into(), -32).ln() / &ln2;
        let away = (&exact - real(log2_fine(raw), -120)) << 118;
        assert!(is_within(&away, 1, 1), "{raw:#x}: {away} · 2^-118");
        let ulps = (exact << 32) - real(log2(raw).into(), 0);
        assert!(is_within(&ulps, 5001, 10_000), "{raw:#x}: {ulps}");
    }
    // The last of the bits kept tells these from a tie, whatever is below it.
    for raw in [1_222_593, 4_354_659, 4_815_040, 6_548_089] {
        let exact = (real(raw.into(), -32) * &ln2).exp() << 32;
        let ulps = exact - real(exp2(raw).expect("next to 1").into(), 0);
        assert!(is_within(&ulps, 1, 2), "{raw}: {ulps}");
    }
    for frac in (0..128u128).flat_map(|entry| [0, 1, 1 << 57, (1 << 121) - 1].map(|off| (entry << 121) + off)) {
        let fine = exp2_fine(frac);
        assert!(fine >> 127 == 1, "{frac:#x}");
        assert_eq!(exp2_for_64_bits(frac).wrapping_add(1 << 63) >> 64, fine.wrapping_add(1 << 63) >> 64, "{frac:#x}");
        let next = exp2_fine(frac.saturating_add(1 << 70));
        assert!(fine <= next, "{frac:#x}");
    }
    for base in words().into_iter().filter(|&base| base > 0 && base >> 63 == 0) {
        assert_eq!(pow(base, 1 << 32), Some(base));
        assert_eq!(pow(base, 0), Some(1 << 32));
        let square = shr_round_u(u128::from(base) * u128::from(base), 32);
        assert_eq!(pow(base, 2 << 32).map(u128::from), Some(square).filter(|square| square >> 63 == 0), "{base:#x}");
        let inverse = div_round_u(1 << 64, base.into());
        assert_eq!(
            pow(base, -1 << 32).map(u128::from),
            Some(inverse).filter(|inverse| inverse >> 63 == 0),
            "{base:#x}"
        );
        for exponent in words().into_iter().map(|word| word as i64) {
            // No pattern in what comes out, but none of it wraps.
            let power = pow(base, exponent);
            let grows = (base > 1 << 32) == (exponent > 0);
            assert!(power.is_some() || grows, "{base:#x} ^ {exponent:#x}");
        }
    }
    for raw in words().into_iter().map(|word| word as i64) {
        assert_eq!(exp2(raw).is_none(), raw >= 31 << 32, "{raw:#x}");
        assert_eq!(exp(raw).is_none(), raw > 92_288_378_626, "{raw:#x}");
    }
}
