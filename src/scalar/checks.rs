//! The arithmetic of the engine against exact references.

use core::ops::Neg;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::{IBig, UBig};
use proptest::prelude::*;

use super::forces::{Forces, exponential, mean_exponential, sure_attraction};
use super::motion::Motion;
use super::*;
use crate::cases::cases;
use crate::fx::Fx;
use crate::kernel::sqrt::root_fine;
use crate::math::Vec2;

type Real = FBig<HalfEven, 2>;

const PRECISION: usize = 256;

fn real(mantissa: impl Into<IBig>, exponent: i32) -> Real {
    Real::from_parts(mantissa.into(), exponent as isize).with_precision(PRECISION).value()
}

fn exact(f: FxFactor) -> Real {
    let (mantissa, shift) = f.parts();
    real(mantissa, -shift)
}

/// log2 of the relative error of a factor; very small for none.
fn error_log2(f: FxFactor, reference: &Real) -> f64 {
    let ratio = exact(f) / reference - real(1, 0);
    let error = ratio.to_f64().value().abs();
    if error == 0.0 { -200.0 } else { error.log2() }
}

/// Returns true if the factor is within half an ulp of its 64-bit mantissa, at most 2^-64 of it.
fn is_nearest(f: FxFactor, reference: &Real) -> bool {
    let (mantissa, shift) = f.parts();
    assert!(mantissa >> 63 == 1, "not normalised");
    let away = exact(f) - reference;
    let away = if away < real(0, 0) { away.neg() } else { away };
    // The spacing below a power of two is half as wide, and a neighbour there is nearer.
    away <= real(1, -shift - 1)
}

fn factor() -> impl Strategy<Value = FxFactor> {
    (any::<u64>(), 0u32..64, -40i32..120)
        .prop_map(|(m, cut, shift)| FxFactor::new(u128::from((m >> cut).max(1)), shift))
}

/// A number of up to `bits` bits of either sign, small ones, zero and powers of two among them.
fn number(bits: u32) -> impl Strategy<Value = i128> {
    let cut = (any::<i128>(), 128 - bits..128).prop_map(|(value, cut)| value >> cut);
    let power = (0..bits - 1, any::<bool>(), -1i128..=1).prop_map(|(k, negative, off)| {
        let power = (1 << k) + off;
        if negative { -power } else { power }
    });
    prop_oneof![4 => cut, 1 => power]
}

/// Components in ulps of an offset: any two, and the sides of triangles whose third is a whole number.
fn components() -> impl Strategy<Value = Vec2<i128>> {
    let whole = (number(60), any::<bool>()).prop_map(|(k, swap)| if swap { (4 * k, 3 * k) } else { (3 * k, -4 * k) });
    prop_oneof![3 => (number(64), number(64)), 1 => whole].prop_map(Vec2::from)
}

/// ±num / den to nearest, ties to even; `None` if it leaves i128.
fn quotient(num: UBig, den: &UBig, negative: bool) -> Option<i128> {
    let (floor, twice) = (&num / den, (&num % den) * 2u8);
    let up = twice > *den || (twice == *den && &floor % 2u8 == 1);
    let rounded = i128::try_from(&(floor + u8::from(up))).ok()?;
    Some(if negative { -rounded } else { rounded })
}

fn size(value: i128) -> UBig {
    UBig::from(value.unsigned_abs())
}

/// The tension as it is defined: each quotient and product of integers rounded once.
fn tension(ulps: Vec2<i128>, velocity: Vec2<i128>, spring: &SpringConstants<Fx>) -> Option<Vec2<i128>> {
    let Vec2 { x, y } = ulps;
    let square = |c: i128| c.unsigned_abs().pow(2);
    let sum = square(x) + square(y);
    if sum == 0 {
        return Some(Vec2::default());
    }
    let up = sum.leading_zeros() as usize / 2;
    let fine = UBig::from(root_fine(sum << (2 * up)));
    let times = |a: i128, b: Fx| quotient(size(a) * b.to_bits().unsigned_abs(), &(UBig::ONE << 32), a < 0);
    let part = |whole: i128, c: i128, more: usize| {
        quotient((size(whole) * size(c)) << (32 + up + more), &fine, (whole < 0) != (c < 0))
    };
    let length = quotient(fine.clone(), &(UBig::ONE << up), false)?;
    let mut tension = times(length - (i128::from(spring.rest.to_bits()) << 32), spring.stiffness)?;
    if spring.damping != Fx::ZERO {
        let rate = part(velocity.x, x, 16)?.checked_add(part(velocity.y, y, 16)?)?;
        tension = tension.checked_add(times(quotient(size(rate), &(UBig::ONE << 16), rate < 0)?, spring.damping)?)?;
    }
    Some(Vec2::new(part(tension, x, 0)?, part(tension, y, 0)?))
}

/// The attraction as it is defined: mu / d³ rounded down to 95 bits or more, times each component rounded once.
fn attraction(mu: FxFactor, ulps: Vec2<i128>, softening: Fx) -> Option<Vec2<i128>> {
    let Vec2 { x, y } = ulps;
    let square = |c: i128| c.unsigned_abs().pow(2);
    let sum = square(x) + square(y) + square(softening.to_bits().into());
    let (mantissa, shift) = mu.parts();
    if (x, y) == (0, 0) || mantissa == 0 {
        return Some(Vec2::default());
    }
    let even = sum.leading_zeros() & !1;
    let root = root_fine(sum << even).min((1 << 96) - 1);
    let cube = (UBig::from(sum << even) * UBig::from(root)) >> 96;
    let share = (UBig::from(mantissa) << 160) / cube;
    let shift = 96 + shift - 3 * (even as i32) / 2;
    let part = |c: i128| {
        let (left, right) = (shift.min(0).unsigned_abs() as usize, shift.max(0) as usize);
        quotient((&share * size(c)) << left, &(UBig::ONE << right), c < 0)
    };
    Some(Vec2::new(part(x)?, part(y)?))
}

/// An offset of this number of ulps.
fn offset(ulps: Vec2<i128>) -> Offset<Fx> {
    ulps.map(|part| FxWide::from_bits(part << 32))
}

fn bits(vector: Option<Offset<Fx>>) -> Option<Vec2<i128>> {
    vector.map(|v| v.map(FxWide::to_bits))
}

proptest! {
    #![proptest_config(cases(3_000))]

    #[test]
    fn a_tension_has_the_bits_of_its_definition(
        ulps in components(), v in (number(128), number(128)).prop_map(Vec2::from), wide: bool,
        (rest, stiffness, damping) in (0i64.., 0i64.., 0i64..), cut in (0u32..63, 0u32..63, 0u32..64),
    ) {
        let spring = SpringConstants {
            rest: Fx::from_bits(rest >> cut.0),
            stiffness: Fx::from_bits(stiffness >> cut.1),
            damping: Fx::from_bits(damping >> cut.2),
        };
        // Velocities of bodies, or any that fit.
        let v = if wide { v } else { v.map(|part| part >> 30) };
        let velocity = v.map(FxWide::from_bits);
        prop_assert_eq!(bits(Fx::tension(offset(ulps), velocity, &spring)), tension(ulps, v, &spring));
    }

    #[test]
    fn an_attraction_has_the_bits_of_its_definition(
        ulps in components(), m in 1u64.., near in -40i32..40, softening in 0i64..1 << 62, cut in 1u32..64,
    ) {
        let softening = Fx::from_bits(softening >> cut);
        // From what is next to nothing at this distance to what does not fit.
        let size = 128 - (ulps.x.unsigned_abs() | ulps.y.unsigned_abs()).leading_zeros() as i32;
        let mu = FxFactor::new(m.into(), 64 - 2 * (size - 32) + near);
        prop_assert_eq!(bits(Fx::attraction(mu, offset(ulps), softening)), attraction(mu, ulps, softening));
    }
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn factors_multiply_divide_and_add_to_the_nearest(a in factor(), b in factor()) {
        prop_assert!(is_nearest(a.times(b), &(exact(a) * exact(b))));
        prop_assert!(is_nearest(a.over(b), &(exact(a) / exact(b))));
        prop_assert!(is_nearest(Factor::<Fx>::plus(a, b), &(exact(a) + exact(b))));
        let (large, small) = if a >= b { (a, b) } else { (b, a) };
        if large > small {
            let difference = Factor::<Fx>::minus(large, small);
            // A sticky bit in place of what is far below may turn a tie: one part in 2^62 of half an ulp.
            prop_assert!(error_log2(difference, &(exact(large) - exact(small))) < -63.9);
        }
        prop_assert!(Factor::<Fx>::minus(small, large).is_zero());
    }

    #[test]
    fn order_is_that_of_the_values(a in factor(), b in factor()) {
        prop_assert_eq!(a.cmp(&b), exact(a).cmp(&exact(b)));
    }

    #[test]
    fn exponentials_are_good_to_2_to_the_minus_61(m in 1u64.., size in 0i32..40) {
        // z from 2^-36 to 16.
        let z = FxFactor::new(u128::from(m), 60 + size);
        let reference = exact(z);
        let decayed = exponential(z, false).expect("never too large");
        prop_assert!(error_log2(decayed, &reference.clone().neg().exp()) < -59.0);
        let grown = exponential(z, true).expect("e^16 fits");
        prop_assert!(error_log2(grown, &reference.clone().exp()) < -59.0);
        let one = real(1, 0);
        let mean = (&one - reference.clone().neg().exp()) / &reference;
        prop_assert!(error_log2(mean_exponential(z, decayed, false), &mean) < -45.0);
        let mean = (reference.clone().exp() - &one) / &reference;
        prop_assert!(error_log2(mean_exponential(z, grown, true), &mean) < -45.0);
    }

    #[test]
    fn damping_factors_are_good_to_2_to_the_minus_64(kept in 1i64..1 << 32, num in 1u32..=60, den in 60u32..=600_000) {
        for weight in [Weight::Whole, Weight::YoshidaOuter, Weight::YoshidaInner] {
            for half in [false, true] {
                let span = Span { ratio: (num, den), weight, half };
                let f = Fx::decay_over(Fx::decay_rate(Decay::KeptPerSecond(Fx::from_bits(kept))), span);
                let log = real(kept, -32).ln() * seconds(span);
                let log = if span.is_negative() { log.neg() } else { log };
                prop_assert!(error_log2(f, &log.exp()) < -63.99, "{}", error_log2(f, &log.exp()));
            }
        }
    }

    #[test]
    fn factors_of_a_rate_are_good_to_2_to_the_minus_64(rate in 1i64.., size in 0u32..63, num in 1u32..=60, den in 60u32..=600_000) {
        let rate = rate >> size;
        let decay_rate = Fx::decay_rate(Decay::Rate(Fx::from_bits(rate)));
        for weight in [Weight::Whole, Weight::YoshidaOuter, Weight::YoshidaInner] {
            for half in [false, true] {
                let span = Span { ratio: (num, den), weight, half };
                let f = Fx::decay_over(decay_rate, span);
                let log = real(rate, -32) * seconds(span);
                let log = if span.is_negative() { log } else { log.neg() };
                // 2^±2^14 is the largest factor and the smallest.
                if log.clone() > real(11_000, 0) || log < real(-11_000, 0) {
                    prop_assert!(f.is_zero() || f > FxFactor::new(1, -15_000) || f < FxFactor::new(1, 15_000));
                    continue;
                }
                prop_assert!(error_log2(f, &log.exp()) < -63.99, "{}", error_log2(f, &log.exp()));
            }
        }
    }

    #[test]
    fn durations_are_good_to_2_to_the_minus_64(num in 1u32..=100_000, den in 100_000u32..) {
        let two_pi = real(1, 0).asin() * real(4, 0);
        for weight in [Weight::Whole, Weight::YoshidaOuter, Weight::YoshidaInner] {
            for half in [false, true] {
                let span = Span { ratio: (num, den), weight, half };
                prop_assert!(error_log2(Fx::seconds(span), &seconds(span)) <= -64.0);
                let turns = seconds(span) / &two_pi;
                prop_assert!(error_log2(<Turn as Angle<Fx>>::drift_factor(span), &turns) <= -64.0);
            }
        }
        let square = real(num, 0) * real(num, 0) / (real(den, 0) * real(den, 0)) / real(2, 0);
        prop_assert!(error_log2(Fx::half_square_seconds(num, den), &square) <= -64.0);
    }

    #[test]
    fn kicks_and_drifts_are_rounded_once(a: i64, v in -(1i64 << 56)..1 << 56, num in 1u32..=60, den in 60u32..=600_000) {
        let h = Fx::seconds(Span { ratio: (num, den), weight: Weight::Whole, half: true });
        let nearest = |bits: i128, exact: Real| {
            let away = real(bits, -96) - exact;
            away <= real(1, -97) && away >= real(-1, -97)
        };
        let way = Fx::from_bits(v).drift(h);
        prop_assert!(nearest(Accumulator::to_bits(way), real(v, -32) * exact(h)));
        prop_assert_eq!(Fx::from_bits(-v).drift(h), way.negated());
        let acceleration = FxWide::from_bits(i128::from(a) << 20);
        let gained = Fx::kick(acceleration, h).expect("below 2^19 m/s");
        prop_assert!(nearest(Accumulator::to_bits(gained), real(a, -44) * exact(h)));
        prop_assert_eq!(Fx::kick(acceleration.negated(), h), Some(gained.negated()));
    }

    #[test]
    fn scaling_an_accumulator_is_rounded_once(bits in -(1i128 << 119)..1 << 119, m in 1u64 << 63.., shift in 63i32..80) {
        let factor = FxFactor::new(u128::from(m), shift);
        let Some(scaled) = FxAccumulator::from_bits(bits).scaled(factor) else {
            prop_assert!(shift == 63);
            return Ok(());
        };
        let exact = real(bits, -96) * exact(factor);
        let away = real(Accumulator::to_bits(scaled), -96) - &exact;
        if scaled == FxAccumulator::default() {
            prop_assert!(exact <= real(1, -33) && exact >= real(-1, -33));
        } else {
            prop_assert!(away <= real(1, -97) && away >= real(-1, -97));
        }
        prop_assert_eq!(FxAccumulator::from_bits(-bits).scaled(factor), Some(scaled.negated()));
    }

    #[test]
    fn sums_do_not_depend_on_the_order(mut terms in prop::collection::vec(any::<i128>(), 0..40)) {
        let total = |terms: &[i128]| {
            let mut sum = FxSum::default();
            terms.iter().for_each(|&term| sum.add(FxWide::from_bits(term)));
            sum
        };
        let first = total(&terms);
        terms.reverse();
        prop_assert_eq!(first, total(&terms));
        let exact: IBig = terms.iter().map(|&term| IBig::from(term)).sum();
        prop_assert_eq!(first.total().map(|sum| IBig::from(sum.to_bits())), i128::try_from(&exact).ok().map(IBig::from));
    }

    #[test]
    fn springs_pull_with_the_exact_force(
        x in -(1i64 << 62)..1 << 62, y in -(1i64 << 62)..1 << 62, cut in 0u32..50,
        rest in 0i64..1 << 40, stiffness in 0i64..1 << 44,
    ) {
        let (x, y) = (x >> cut, y >> cut);
        prop_assume!((x, y) != (0, 0));
        let offset = offset(Vec2::new(x.into(), y.into()));
        let (rest, stiffness) = (Fx::from_bits(rest), Fx::from_bits(stiffness));
        let spring = SpringConstants { rest, stiffness, damping: Fx::ZERO };
        let none = Offset::<Fx>::default();
        let force = Fx::tension(offset, none, &spring).expect("below 2^43 N");
        let (x, y) = (real(x, -32), real(y, -32));
        let length = (x.clone() * &x + y.clone() * &y).sqrt();
        let pull = real(stiffness.to_bits(), -32) * (length.clone() - real(rest.to_bits(), -32)) / &length;
        for (component, exact) in [(force.x, pull.clone() * x), (force.y, pull * y)] {
            let away = (real(component.to_bits(), -64) - exact).to_f64().value();
            // An ulp of 2^-64 N for two roundings, and the stiffness times the length's 0.501 · 2^-64 m.
            let bound = 2f64.powi(-64) * (1.001 + 0.501 * stiffness.to_bits() as f64 * 2f64.powi(-32));
            prop_assert!(away.abs() <= bound, "{away:e} {bound:e}");
        }
        let mirrored = Vec2::new(offset.x.negated(), offset.y);
        prop_assert_eq!(Fx::tension(mirrored, none, &spring), Some(Vec2::new(force.x.negated(), force.y)));
    }

    #[test]
    fn drag_leaves_the_exact_share(
        speed in 1u64..1 << 52, alpha in 0u64..1 << 34, beta in 0u64..1 << 34, num in 1u32..60,
    ) {
        let [u, a, b] = [speed, alpha, beta].map(|bits| FxFactor::new(u128::from(bits), 32));
        let h = FxFactor::from_ratio(u64::from(num), 60);
        let left = Fx::drag(&mut None, u, a, b, h, false).expect("forwards it always is");
        let (u, a, b, h) = (exact(u), exact(a), exact(b), exact(h));
        let z = a.clone() * &h;
        let decayed = z.clone().neg().exp();
        let mean = if z == real(0, 0) { real(1, 0) } else { (real(1, 0) - decayed.clone()) / z };
        let reference = decayed / (real(1, 0) + b * u * h * mean);
        prop_assert!(error_log2(left, &reference) < -45.0, "{}", error_log2(left, &reference));
    }
}

/// Bodies of a few masses in turn, over either span, forwards and backwards: each as if it were alone.
#[test]
fn a_memo_of_drag_changes_no_result() {
    let alphas =
        [FxFactor::ZERO, FxFactor::from_ratio(1, 3), FxFactor::from_ratio(1, 3_000_000), FxFactor::new(1 << 9, 0)];
    let spans = [FxFactor::from_ratio(1, 60), FxFactor::ONE];
    let (mut memo, mut random) = (None, 1u32);
    for _ in 0..10_000 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (alpha, span) = (alphas[(random >> 30) as usize], spans[(random >> 29 & 1) as usize]);
        let (speed, beta, negative) =
            (FxFactor::new((random >> 8).into(), 16), FxFactor::from_ratio(1, 7), random >> 28 & 1 == 1);
        let alone = Fx::drag(&mut None, speed, alpha, beta, span, negative);
        assert_eq!(Fx::drag(&mut memo, speed, alpha, beta, span, negative), alone, "{alpha:?} {span:?} {negative}");
    }
}

/// A body of little mass in something very thick: what is left of its speed is below what a factor has.
#[test]
fn drag_without_measure_stops_and_has_no_way_back() {
    let [speed, second] = [FxFactor::new(1 << 20, 0), FxFactor::ONE];
    for beta in [FxFactor::ZERO, FxFactor::ONE] {
        for log2 in [8, 9, 31, 47] {
            let alpha = FxFactor::new(1 << log2, 0);
            assert_eq!(Fx::drag(&mut None, speed, alpha, beta, second, false), Some(FxFactor::ZERO));
            assert_eq!(Fx::drag(&mut None, speed, alpha, beta, second, true), None);
        }
    }
}

fn seconds(span: Span) -> Real {
    // ∛2 by Newton's method: each step doubles the digits, from 53 bits.
    let mut root = real(5_674_179_970_822_795i64, -52);
    for _ in 0..4 {
        root = (&root + &root + real(2, 0) / (&root * &root)) / real(3, 0);
    }
    let outer = real(1, 0) / (real(2, 0) - &root);
    let weight = match span.weight {
        Weight::Whole => real(1, 0),
        Weight::YoshidaOuter => outer,
        Weight::YoshidaInner => outer * root,
    };
    let whole = weight * real(span.ratio.0, 0) / real(span.ratio.1, 0);
    if span.half { whole / real(2, 0) } else { whole }
}

#[test]
fn factors_read_back_what_they_were_made_from() {
    for bits in [1, 2, 3, 1 << 32, i64::MAX, 0x0123_4567_89ab_cdef] {
        let value = Fx::from_bits(bits);
        assert_eq!(FxFactor::from_scalar(value).to_scalar(), Some(value));
        assert_eq!(FxWide::from_factor(FxFactor::from_scalar(value), true), Some(FxWide::from_scalar(value).negated()));
    }
    assert_eq!(FxFactor::new(1, -31).to_scalar(), None, "2^31 does not fit");
    assert_eq!(FxFactor::new(1, 33).to_scalar(), Some(Fx::ZERO), "half an ulp is a tie");
    assert_eq!(FxFactor::new(3, 34).to_scalar(), Some(Fx::DELTA));
    assert_eq!(FxFactor::new(u128::MAX, 0), FxFactor::new(1, -128), "a carry out of the mantissa");
    assert!(is_nearest(<FxFactor as Factor<Fx>>::PI, &(real(1, 0).asin() * real(2, 0))));
}

#[test]
fn exponents_end_in_zero_and_in_the_largest_factor() {
    let (mut small, mut large) = (FxFactor::from_ratio(1, 1 << 63), FxFactor::from_ratio(1 << 63, 1));
    for _ in 0..40 {
        (small, large) = (small.times(small), large.times(large));
    }
    assert!(small.is_zero());
    assert_eq!(large, large.times(large));
    assert!(large > FxFactor::new(1, -16_000));
}

/// From 2^-30 to 2^10 m/s², at every distance of 2^-20 to 2^30 m: all but one in a hundred, so that the definition costs nothing.
#[test]
fn nearly_all_attractions_are_sure() {
    let mut random = 1u64;
    let (mut sure, mut all) = (0, 0);
    for distance in 12..62 {
        for acceleration in -30..=10 {
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let ulps = Vec2::new(
                (1i128 << distance) + i128::from(random >> 55),
                -i128::from(random >> 40 >> (62 - distance).min(23)),
            );
            let mu = FxFactor::new(u128::from(random | 1 << 63), 63 - 2 * (distance - 32) - acceleration);
            sure += u32::from(sure_attraction(mu, offset(ulps), Fx::ZERO).is_some());
            all += 1;
            assert_eq!(bits(Fx::attraction(mu, offset(ulps), Fx::ZERO)), attraction(mu, ulps, Fx::ZERO));
        }
    }
    assert!(100 * (all - sure) <= all, "{sure} of {all}");
}

#[test]
fn attraction_is_defined_where_the_root_rounds_up_to_the_next_power_of_two() {
    // x² + y² is a few below a power of four.
    for (x, y) in [
        (1_125_567_983_927_385i64, 27_337_040_547_056i64),
        (15_317_334_545_335_951, 9_481_445_885_764_714),
        (228_477_151_555_757_253, 175_712_665_888_161_782),
        (1_064_345_167_551_132_376, 443_167_417_682_604_259),
        (2_274_117_029_588_772_901, 381_187_249_096_818_150),
    ] {
        let offset = offset(Vec2::new(x.into(), y.into()));
        let mu = FxFactor::new(1, -60);
        let acceleration = Fx::attraction(mu, offset, Fx::ZERO).expect("it fits");
        let (x, y) = (real(x, -32), real(y, -32));
        let square = x.clone() * &x + y.clone() * &y;
        let cube = square.clone() * square.sqrt();
        for (component, exact) in [(acceleration.x, x / &cube), (acceleration.y, y / &cube)] {
            let away = (real(component.to_bits(), -124) - exact).to_f64().value() * 2f64.powi(124);
            assert!(away.abs() <= 0.51, "{away}");
        }
    }
}
