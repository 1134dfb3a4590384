//! `Fx` behaves alike in debug and release, with and without overflow checks: run in both.

#[path = "support/cases.rs"]
mod cases;

use std::panic::catch_unwind;

use cases::cases;
use fixed::types::I32F32;
use proptest::prelude::*;
use umbra_physics::{Fx, FxAccumulator, FxWide, MathError, ParseFxError, Turn, fx};

fn panics(operation: impl FnOnce() -> Fx + std::panic::UnwindSafe) -> bool {
    catch_unwind(operation).is_err()
}

/// The arguments through a black box: a constant overflow must not be seen by the compiler.
fn hidden(value: Fx) -> Fx {
    std::hint::black_box(value)
}

#[test]
fn operators_panic_when_the_result_does_not_fit() {
    assert!(panics(|| hidden(Fx::MAX) + Fx::DELTA));
    assert!(panics(|| hidden(Fx::MIN) - Fx::DELTA));
    assert!(panics(|| hidden(Fx::MIN) * Fx::NEG_ONE));
    assert!(panics(|| hidden(fx!(46341)) * fx!(46341)));
    assert!(panics(|| hidden(Fx::MIN) / Fx::NEG_ONE));
    assert!(panics(|| hidden(Fx::ONE) / Fx::from_ratio(1, 1 << 32)));
    assert!(panics(|| hidden(Fx::ONE) / Fx::ZERO));
    assert!(panics(|| -hidden(Fx::MIN)));
    assert!(panics(|| hidden(Fx::MIN).abs()));
    assert!(panics(|| hidden(Fx::NEG_ONE).sqrt()));
    assert!(panics(|| hidden(Fx::MAX).ceil()));
    assert!(panics(|| hidden(Fx::MAX).round()));
    assert!(panics(|| Fx::from_ratio(1, std::hint::black_box(0))));
    assert!(panics(|| Fx::from_ratio(1 << 32, std::hint::black_box(1))));
    assert!(panics(|| {
        let mut sum = hidden(Fx::MAX);
        sum += Fx::DELTA;
        sum
    }));
    assert!(panics(|| hidden(Fx::ONE).saturating_div(Fx::ZERO)));
    assert!(panics(|| hidden(Fx::ONE).wrapping_div(Fx::ZERO)));
    // Just inside, none does.
    assert_eq!(hidden(Fx::MAX) - Fx::DELTA + Fx::DELTA, Fx::MAX);
    assert_eq!(hidden(Fx::MIN) * Fx::ONE / Fx::ONE, Fx::MIN);
}

#[test]
fn checked_saturating_and_wrapping_forms_agree_on_what_does_not_fit() {
    let (min, max, delta) = (Fx::MIN, Fx::MAX, Fx::DELTA);
    assert_eq!((max.checked_add(delta), max.saturating_add(delta), max.wrapping_add(delta)), (None, max, min));
    assert_eq!((min.checked_sub(delta), min.saturating_sub(delta), min.wrapping_sub(delta)), (None, min, max));
    let unit = Fx::NEG_ONE;
    assert_eq!((min.checked_mul(unit), min.saturating_mul(unit), min.wrapping_mul(unit)), (None, max, min));
    assert_eq!((min.checked_div(unit), min.saturating_div(unit), min.wrapping_div(unit)), (None, max, min));
    assert_eq!((min.checked_neg(), min.saturating_neg(), min.wrapping_neg()), (None, max, min));
    assert_eq!((min.checked_abs(), min.saturating_abs(), min.wrapping_abs()), (None, max, min));
    assert_eq!(fx!(-65536).saturating_mul(fx!(65536)), min);
    assert_eq!(fx!(-65536).wrapping_mul(fx!(65536)), Fx::ZERO);
    assert_eq!(fx!(-1).saturating_div(delta), min);
    assert_eq!(fx!(-1).wrapping_div(delta), Fx::ZERO);
    assert_eq!((Fx::ONE.checked_div(Fx::ZERO), Fx::checked_from_ratio(1, 0)), (None, None));
}

#[test]
fn products_and_quotients_round_ties_to_even_on_both_sides_of_zero() {
    let bits = Fx::from_bits;
    for (odd, even) in [(1, 0), (3, 2), (5, 2), (7, 4), (-1, 0), (-3, -2), (-5, -2), (-7, -4)] {
        assert_eq!(bits(odd) * Fx::HALF, bits(even));
        assert_eq!(bits(odd) / fx!(2), bits(even));
        assert_eq!(bits(odd) / fx!(-2), bits(-even));
        assert_eq!(Fx::from_ratio(odd, 1 << 33), bits(even));
    }
    // The wrapped type's own product would be rounded down, and its quotient towards zero.
    assert_eq!(bits(-1) * Fx::HALF, Fx::ZERO);
    assert_eq!(I32F32::from(bits(-1)) * I32F32::from(Fx::HALF), I32F32::from_bits(-1));
    assert_eq!(bits(5) / fx!(3), bits(2));
}

#[test]
fn integers_round_as_named() {
    let cases = [("-2.5", -3, -2, -2), ("-1.5", -2, -1, -2), ("0.5", 0, 1, 0), ("1.5", 1, 2, 2), ("7", 7, 7, 7)];
    for (text, floor, ceil, round) in cases {
        let x: Fx = text.parse().unwrap();
        assert_eq!((x.floor(), x.ceil(), x.round()), (floor.into(), ceil.into(), round.into()), "{text}");
    }
    assert_eq!((Fx::MIN.floor(), Fx::MIN.ceil(), Fx::MIN.round()), (Fx::MIN, Fx::MIN, Fx::MIN));
    assert_eq!([fx!(-3.5), Fx::ZERO, Fx::DELTA].map(Fx::signum), [Fx::NEG_ONE, Fx::ZERO, Fx::ONE]);
}

#[test]
fn constants_are_the_nearest_values() {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    assert_eq!(Fx::PI, fx!(3.141592653589793238462643383279502884197));
    // By how many ulps they are rounded, as documented: a double has 19 bits to spare for that.
    let rounded = [(Fx::PI, PI), (Fx::TAU, TAU), (Fx::FRAC_PI_2, FRAC_PI_2)];
    let errors = rounded.map(|(value, exact)| format!("{:.2}", value.to_bits() as f64 - exact * 4_294_967_296.0));
    assert_eq!(errors, ["0.48", "-0.04", "-0.26"]);
    assert_eq!(Fx::TAU, fx!(6.283185307179586476925286766559005768394));
    assert_eq!(Fx::FRAC_PI_2, fx!(1.570796326794896619231321691639751442099));
    assert_eq!((Fx::MIN, Fx::MAX.to_bits()), (fx!(-2147483648), i64::MAX));
    assert_eq!(Fx::default(), Fx::ZERO);
    assert_eq!([Fx::from(-1i8), (-1i16).into(), (-1i32).into()], [Fx::NEG_ONE; 3]);
    assert_eq!([Fx::from(255u8), 255u16.into()], [fx!(255); 2]);
}

#[test]
fn functions_refuse_what_has_no_value() {
    assert_eq!(Fx::ZERO.log2(), Err(MathError::NotPositive));
    assert_eq!(fx!(-2).pow(fx!(2)), Err(MathError::NotPositive));
    assert_eq!(Fx::ZERO.pow(Fx::ONE), Err(MathError::NotPositive));
    assert_eq!(fx!(31).exp2(), Err(MathError::Overflow));
    assert_eq!(fx!(2).pow(fx!(31)), Err(MathError::Overflow));
    assert_eq!(Fx::DELTA.pow(Fx::MIN), Err(MathError::Overflow));
    assert_eq!(Fx::DELTA.checked_sqrt(), Some(Fx::from_bits(1 << 16)));
    assert_eq!(fx!(-0.001).checked_sqrt(), None);
    assert_eq!(Fx::MIN.checked_hypot(Fx::ZERO), None);
    assert_eq!(Fx::MAX.checked_hypot(Fx::ZERO), Some(Fx::MAX));
    assert_eq!(Fx::MIN.exp2(), Ok(Fx::ZERO));
}

#[test]
fn text_is_rounded_once_however_long() {
    let bits = |text: &str| text.parse::<Fx>().map(Fx::to_bits);
    // 2^-33, a tie: to even. A digit less or more decides it.
    assert_eq!(bits("0.000000000116415321826934814453125"), Ok(0));
    assert_eq!(bits("0.000000000116415321826934814453124"), Ok(0));
    assert_eq!(bits("0.0000000001164153218269348144531250000000000000000000000000000000000001"), Ok(1));
    assert_eq!(bits("-0.0000000001164153218269348144531251"), Ok(-1));
    assert_eq!(bits("1.16415321826934814453125e-10"), Ok(0));
    assert_eq!(bits("11641532182693481445312500001E-38"), Ok(1));
    // 3·2^-33 goes up to 2·2^-32.
    assert_eq!(bits("0.000000000349245965480804443359375"), Ok(2));
    let long = format!("0.5{}", "0".repeat(100_000));
    assert_eq!(bits(&long), Ok(1 << 31));
    assert_eq!(bits(&format!("{long}1e0")), Ok(1 << 31));
    assert_eq!(bits(&format!("{}1e-100000", "0".repeat(1000))), Ok(0));
    assert_eq!(bits(&format!("1{}e-5000", "0".repeat(5000))), Ok(1 << 32));
    assert_eq!(bits(&format!("0.{}1e5000", "0".repeat(4999))), Ok(1 << 32));
    assert_eq!(bits("0e999999999999999999999999"), Ok(0));
    assert_eq!(bits("1e-999999999999999999999999"), Ok(0));
    assert_eq!(bits("12.5e1"), Ok(125 << 32));
    assert_eq!([bits("+1"), bits("1."), bits(".5e1"), bits("-0")], [Ok(1 << 32), Ok(1 << 32), Ok(5 << 32), Ok(0)]);
}

#[test]
fn text_out_of_range_is_refused_only_past_the_rounding() {
    let parse = |text: &str| text.parse::<Fx>();
    assert_eq!(parse("-2147483648"), Ok(Fx::MIN));
    assert_eq!(parse("-2147483648.000000000116415321826934814453125"), Ok(Fx::MIN));
    assert_eq!(parse("-2147483648.0000000001164153218269348144531251"), Err(ParseFxError::OutOfRange));
    assert_eq!(parse("2147483647.999999999883584678173065185546874"), Ok(Fx::MAX));
    assert_eq!(parse("2147483647.999999999883584678173065185546875"), Err(ParseFxError::OutOfRange));
    for text in ["2147483648", "1e10", "1e999999999999999999999", "-99999999999999999999999999", "42949672960"] {
        assert_eq!(parse(text), Err(ParseFxError::OutOfRange), "{text}");
    }
}

#[test]
fn text_that_is_no_number_is_refused_where_it_stops_being_one() {
    assert_eq!("".parse::<Fx>(), Err(ParseFxError::Empty));
    let cases = [
        ("-", 1),
        (".", 1),
        ("-.", 2),
        ("e5", 0),
        (" 1", 0),
        ("1 ", 1),
        ("1e", 2),
        ("1e+", 3),
        ("1.5.2", 3),
        ("0x10", 1),
        ("1_000", 1),
        ("--1", 1),
        ("NaN", 0),
        ("inf", 0),
        ("1,5", 1),
        ("١", 0),
        ("1e5.0", 3),
    ];
    for (text, position) in cases {
        assert_eq!(text.parse::<Fx>(), Err(ParseFxError::InvalidDigit { position }), "{text}");
    }
}

#[test]
fn display_is_exact_and_rounds_to_the_precision_asked() {
    assert_eq!(Fx::DELTA.to_string(), "0.00000000023283064365386962890625");
    assert_eq!(Fx::MIN.to_string(), "-2147483648");
    assert_eq!(Fx::MAX.to_string(), "2147483647.99999999976716935634613037109375");
    assert_eq!(format!("{:?}", fx!(-1.5)), "-1.5");
    let cases = [(fx!(0.5), "0"), (fx!(1.5), "2"), (fx!(-2.5), "-2"), (fx!(2.75), "3"), (fx!(-0.25), "-0")];
    for (x, expected) in cases {
        assert_eq!(format!("{x:.0}"), expected);
    }
    assert_eq!(format!("{:.2}|{:.2}|{:.1}", fx!(0.125), fx!(0.375), fx!(9.96875)), "0.12|0.38|10.0");
    assert_eq!(format!("{:.3}|{:8.2}|{:<6}|{:+}", fx!(2), fx!(-1.5), fx!(0.5), fx!(1)), "2.000|   -1.50|0.5   |+1");
    assert_eq!(format!("{:08.3}", fx!(-1.5)), "-001.500");
    assert_eq!(format!("{:.40}", Fx::DELTA), format!("{}{}", Fx::DELTA, "0".repeat(8)));
    assert_eq!(format!("{:.31}", Fx::DELTA), "0.0000000002328306436538696289062");
    // Numbers of all types are written alike, and as those of the standard library.
    macro_rules! as_a_double {
        ($($form:literal $number:expr;)*) => {$(
            let (x, double): (Fx, f64) = (fx!($number), $number);
            let found = [format!($form, x), format!($form, FxWide::from(x)), format!($form, FxAccumulator::from_scalar(x))];
            assert_eq!(found, [(); 3].map(|()| format!($form, double)));
        )*};
    }
    as_a_double! {
        "{:.2}" -0.001;
        "{:.0}" -0.5;
        "{:+.1}" 0.25;
        "{:*>9.1}" -0.04;
        "{:<9}|" 2.5;
        "{:08.1}" -0.75;
        "{:.96}" -0.5;
        "{:.120}" -0.5;
        "{:+0130.120}" 1.5;
    }
    assert_eq!(format!("{:.99}", Turn::QUARTER), format!("0.25{}", "0".repeat(97)));
}

#[test]
fn literals_are_constants() {
    const GRAVITY: Fx = fx!(-9.81);
    const FINE: Fx = fx!(1_000.000_5e-3);
    assert_eq!(GRAVITY, "-9.81".parse().unwrap());
    assert_eq!(FINE, "1.0000005".parse().unwrap());
    const RATIOS: [(Fx, (i64, i64)); 8] = [
        (fx!(1 / 60), (1, 60)),
        (fx!(-1 / 60), (-1, 60)),
        (fx!(1 / -60), (1, -60)),
        (fx!(-2 / -3), (2, 3)),
        // Ties: 2^-33 goes to 0, and three times of it to 2 ulps.
        (fx!(1 / 8_589_934_592), (1, 1 << 33)),
        (fx!(-3 / 8_589_934_592), (-3, 1 << 33)),
        (fx!(9_223_372_036_854_775_807 / 4_294_967_296), (i64::MAX, 1 << 32)),
        (fx!(9_223_372_036_854_775_807 / -9_223_372_036_854_775_807), (-1, 1)),
    ];
    for (ratio, (num, den)) in RATIOS {
        assert_eq!(Some(ratio), Fx::checked_from_ratio(num, den), "{num}/{den}");
    }
    assert_eq!([RATIOS[4].0.to_bits(), RATIOS[5].0.to_bits()], [0, -2]);
    macro_rules! passed_on {
        ($number:literal) => {
            fx!($number)
        };
    }
    assert_eq!((passed_on!(-0.5), passed_on!(2)), (-Fx::HALF, Fx::from(2)));
}

fn any_fx() -> impl Strategy<Value = Fx> {
    (any::<i64>(), 0u32..63).prop_map(|(bits, shift)| Fx::from_bits(bits >> shift))
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn text_reads_back_to_the_same_bits(x in any_fx()) {
        prop_assert_eq!(x.to_string().parse::<Fx>(), Ok(x));
        // Ten digits tell neighbours apart, nine do not.
        if x.to_bits() > i64::MIN / 2 && x.to_bits() < i64::MAX / 2 {
            prop_assert_eq!(format!("{x:.10}").parse::<Fx>(), Ok(x));
        }
    }

    #[test]
    fn a_shortened_text_is_the_nearest_of_its_length(x in any_fx(), precision in 0usize..=18) {
        // In units of 10^-precision·2^-32: |text·2^32 - bits·10^precision|, at most half of 2^32. Up to 2^(63 + 64).
        let text = format!("{x:.precision$}");
        let scaled: i128 = text.replace('.', "").parse().unwrap();
        let miss = ((scaled << 32) - i128::from(x.to_bits()) * 10i128.pow(precision as u32)).abs();
        prop_assert!(miss < 1 << 31 || miss == 1 << 31 && scaled % 2 == 0, "{}", text);
    }

    #[test]
    fn any_decimal_is_the_nearest_value(digits in 0u64..1 << 58, places in 0u32..18) {
        // |bits·10^places - digits·2^32| is at most half of 10^places.
        let text = format!("{digits}e-{places}");
        let wide = i128::from(digits) << 32;
        let scale = 10i128.pow(places);
        match text.parse::<Fx>() {
            Ok(x) => {
                let miss = (i128::from(x.to_bits()) * scale - wide).abs() * 2;
                prop_assert!(miss < scale || miss == scale && x.to_bits() % 2 == 0, "{} is not {}", text, x);
            }
            Err(error) => {
                prop_assert_eq!(error, ParseFxError::OutOfRange);
                prop_assert!(wide * 2 >= ((1 << 64) - 1) * scale);
            }
        }
    }

    #[test]
    fn no_text_panics(text in "[-+0-9.eE_ ]{0,40}") {
        let _ = text.parse::<Fx>();
    }

    #[test]
    fn arithmetic_is_odd(a in any_fx(), b in any_fx()) {
        prop_assume!(a != Fx::MIN && b != Fx::MIN);
        prop_assert_eq!((-a).checked_mul(b), a.checked_mul(b).and_then(Fx::checked_neg));
        prop_assert_eq!((-a).checked_div(b), a.checked_div(b).and_then(Fx::checked_neg));
        prop_assert_eq!((-a).sin_cos(), (-a.sin(), a.cos()));
        prop_assert_eq!((-a).atan2(b), if a == Fx::ZERO { a.atan2(b) } else { -a.atan2(b) });
    }

    #[test]
    fn the_three_forms_agree_where_the_result_fits(a in any_fx(), b in any_fx()) {
        for (checked, saturating, wrapping) in [
            (a.checked_add(b), a.saturating_add(b), a.wrapping_add(b)),
            (a.checked_sub(b), a.saturating_sub(b), a.wrapping_sub(b)),
            (a.checked_mul(b), a.saturating_mul(b), a.wrapping_mul(b)),
            (a.checked_neg(), a.saturating_neg(), a.wrapping_neg()),
            (a.checked_abs(), a.saturating_abs(), a.wrapping_abs()),
        ] {
            match checked {
                Some(value) => prop_assert_eq!((saturating, wrapping), (value, value)),
                None => prop_assert!(saturating == Fx::MIN || saturating == Fx::MAX),
            }
        }
        prop_assert_eq!(Fx::from(I32F32::from(a).wrapping_add(b.into())), a.wrapping_add(b));
        prop_assert_eq!(Fx::from(I32F32::from(a)), a);
    }
}
