//! Functions of numbers against the exact value, each within the error that its documentation gives.
//!
//! An input is the number of a function, its arguments as words of 64 bits with a shift that makes small ones likely, and a
//! text.

use std::cmp::Ordering;
use std::ops::{Mul, Neg};
use std::sync::LazyLock;

use arbitrary::{Result, Unstructured};
use dashu_int::{IBig, UBig};
use umbra_physics::scalar::internals::{Arithmetic as _, Forces as _};
use umbra_physics::scalar::{Accumulator, FxSum};
use umbra_physics::{Fx, FxAccumulator, FxFactor, FxWide, MathError, ParseFxError, SpringConstants, Turn, Vec2};

use super::reference::{Real, Reference, error, real};

/// The target.
pub fn run(data: &[u8]) {
    let mut input = Unstructured::new(data);
    // What is too short to be an input says nothing.
    _ = look(&mut input);
}

static REFERENCE: LazyLock<Reference> = LazyLock::new(Reference::new);

/// Correctly rounded up to this: half an ulp, and what the last bits of a series are worth.
const NEAREST: f64 = 0.5001;

fn look(input: &mut Unstructured<'_>) -> Result<()> {
    match input.int_in_range(0..=17)? {
        0 => product(bits(input)?, bits(input)?),
        1 => quotient(bits(input)?, bits(input)?),
        2 => square_root(bits(input)?),
        3 => length(bits(input)?, bits(input)?),
        4 => sine_and_cosine(bits(input)?),
        5 => angle(bits(input)?, bits(input)?),
        6 => exponential(bits(input)?),
        7 => logarithm(bits(input)?),
        8 => power(bits(input)?, bits(input)?),
        9 => number_as_text(bits(input)?),
        10 => text_as_number(input.arbitrary()?),
        11 => text_as_factor(input.arbitrary()?),
        12 => factors(factor(input)?, factor(input)?),
        13 => ratio(bits(input)?, bits(input)?),
        14 => wide_numbers([wide(input)?, wide(input)?, wide(input)?], factor(input)?),
        15 => {
            accumulators(FxAccumulator::from_bits(wide(input)?), FxAccumulator::from_bits(wide(input)?), factor(input)?)
        }
        16 => angles(input.arbitrary()?, bits(input)?, bits(input)?, bits(input)?),
        _ => {
            let offset = (bits(input)?, bits(input)?);
            attraction(factor(input)?, offset, bits(input)?);
            let velocity = (bits(input)? >> 5, bits(input)? >> 5);
            tension(offset, velocity, [bits(input)?, bits(input)?, bits(input)?]);
        }
    }
    Ok(())
}

/// Any bits, and those of small numbers as likely as those of large ones.
fn bits(input: &mut Unstructured<'_>) -> Result<i64> {
    let bits: i64 = input.arbitrary()?;
    Ok(bits >> (input.arbitrary::<u8>()? % 64))
}

fn wide(input: &mut Unstructured<'_>) -> Result<i128> {
    let bits: i128 = input.arbitrary()?;
    Ok(bits >> (input.arbitrary::<u8>()? % 128))
}

/// A factor by way of what makes one: a magnitude, and a power of two far beyond what the engine needs.
fn factor(input: &mut Unstructured<'_>) -> Result<FxFactor> {
    let mantissa = FxFactor::from_ratio(input.arbitrary()?, 1);
    let step = FxFactor::from_ratio(1 << 50, 1);
    let exponent: i8 = input.arbitrary()?;
    // Squares of squares: 2^50, 2^100, … up to 2^6400, near the 2^16384 where factors end.
    let mut power = FxFactor::ONE;
    for bit in (0..7).rev() {
        power = power.times(power);
        if exponent.unsigned_abs() >> bit & 1 == 1 {
            power = power.times(step);
        }
    }
    Ok(if exponent < 0 { mantissa.over(power) } else { mantissa.times(power) })
}

/// num / den to nearest, ties to even. *Domain* den > 0.
fn nearest(num: &IBig, den: &UBig) -> IBig {
    let den = IBig::from(den.clone());
    let floor = floor(num, &den);
    let twice: IBig = (num - &floor * &den) * 2;
    let up = match twice.cmp(&den) {
        Ordering::Less => false,
        Ordering::Equal => &floor % 2 != 0,
        Ordering::Greater => true,
    };
    floor + u8::from(up)
}

/// num / den, rounded down. *Domain* den > 0.
fn floor(num: &IBig, den: &IBig) -> IBig {
    let quotient = num / den;
    if (num - &quotient * den) < IBig::ZERO { quotient - 1 } else { quotient }
}

fn fx(bits: i64) -> Fx {
    Fx::from_bits(bits)
}

/// Expected results of `checked_`, `saturating_` and `wrapping_` for an exact result in ulps.
fn assert_fits(exact: &IBig, checked: Option<Fx>, saturating: Fx, wrapping: Fx) {
    let fits = i64::try_from(exact).ok();
    assert_eq!(checked.map(Fx::to_bits), fits, "{exact}");
    let end = if *exact < IBig::ZERO { i64::MIN } else { i64::MAX };
    assert_eq!(saturating.to_bits(), fits.unwrap_or(end), "{exact}");
    let rest = floor(exact, &(IBig::ONE << 64));
    let low = u64::try_from(exact - (rest << 64)).expect("what is left of 2^64");
    assert_eq!(wrapping.to_bits() as u64, low, "{exact}");
}

fn product(a: i64, b: i64) {
    let (x, y) = (fx(a), fx(b));
    let exact = nearest(&(IBig::from(a) * b), &(UBig::ONE << 32));
    assert_fits(&exact, x.checked_mul(y), x.saturating_mul(y), x.wrapping_mul(y));
    let (sum, difference) = (IBig::from(a) + b, IBig::from(a) - b);
    assert_fits(&sum, x.checked_add(y), x.saturating_add(y), x.wrapping_add(y));
    assert_fits(&difference, x.checked_sub(y), x.saturating_sub(y), x.wrapping_sub(y));
    assert_eq!(x.wide_mul(y).to_bits(), i128::from(a) * i128::from(b));
    assert_eq!(x.offset(y).to_bits(), (i128::from(a) - i128::from(b)) << 32);
}

fn quotient(a: i64, b: i64) {
    let (x, y) = (fx(a), fx(b));
    assert_eq!(x.checked_div(y), Fx::checked_from_ratio(a, b));
    if b == 0 {
        return assert_eq!(x.checked_div(y), None);
    }
    let num = if b < 0 { -(IBig::from(a) << 32) } else { IBig::from(a) << 32 };
    let exact = nearest(&num, &UBig::from(b.unsigned_abs()));
    assert_fits(&exact, x.checked_div(y), x.saturating_div(y), x.wrapping_div(y));
}

fn square_root(a: i64) {
    let Some(root) = fx(a).checked_sqrt() else { return assert!(a < 0) };
    assert!(a >= 0, "{a} has a root");
    let (root, square) = (i128::from(root.to_bits()), i128::from(a) << 34);
    // (r − ½)² <= a·2^32 < (r + ½)², all times four.
    assert!((2 * root - 1).pow(2) <= square || root == 0, "{a}");
    assert!(square < (2 * root + 1).pow(2), "{a}");
}

fn length(a: i64, b: i64) {
    let square = |bits: i64| UBig::from(bits.unsigned_abs()).pow(2);
    let sum = (square(a) + square(b)) * 4u8;
    let Some(length) = fx(a).checked_hypot(fx(b)) else {
        // The nearest value is 2^63 or above.
        return assert!(sum > ((UBig::ONE << 64) - 1u8).pow(2), "{a}, {b}");
    };
    let twice = 2 * length.to_bits() as u64;
    assert!(length == Fx::ZERO || UBig::from(twice - 1).pow(2) <= sum, "{a}, {b}");
    assert!(sum < UBig::from(twice + 1).pow(2), "{a}, {b}");
    assert_eq!(fx(b).checked_hypot(fx(a)), Some(length));
}

fn sine_and_cosine(a: i64) {
    let (sin, cos) = fx(a).sin_cos();
    let exact = REFERENCE.sin_cos(a);
    let off = [error(sin.to_bits(), &exact.0), error(cos.to_bits(), &exact.1)];
    assert!(off.iter().all(|off| off.abs() <= NEAREST), "{a}: {off:?}");
    if let Some(mirrored) = fx(a).checked_neg() {
        assert_eq!(mirrored.sin_cos(), (-sin, cos));
    }
}

fn angle(y: i64, x: i64) {
    let angle = fx(y).atan2(fx(x));
    assert!(angle.abs() <= Fx::PI && (angle == Fx::ZERO || (angle < Fx::ZERO) == (y < 0)), "{y}, {x}");
    if (y, x) == (0, 0) {
        return assert_eq!(angle, Fx::ZERO);
    }
    let off = REFERENCE.angle_error(angle.to_bits(), y, x);
    assert!(off.abs() <= NEAREST, "{y}, {x}: {off}");
}

/// Looks at a power against 2^log.
fn assert_power(power: std::result::Result<Fx, MathError>, log: &Real, what: impl std::fmt::Debug) {
    let approximate = log.to_f64().value();
    if !(-80.0..=31.5).contains(&approximate) {
        let beyond = if approximate > 0.0 { Err(MathError::Overflow) } else { Ok(Fx::ZERO) };
        return assert_eq!(power, beyond, "{what:?}");
    }
    let exact = REFERENCE.exp2(log);
    match power {
        Ok(power) => {
            let off = error(power.to_bits(), &exact);
            assert!(off.abs() <= NEAREST, "{what:?}: {off}");
        }
        // From 2^31 − 2^-33 on it rounds up to 2^31; within the error of that, either is right.
        Err(error) => assert!(error == MathError::Overflow && exact >= real((1i128 << 64) - 2, -33), "{what:?}"),
    }
}

fn exponential(a: i64) {
    assert_power(fx(a).exp2(), &real(a, -32), a);
}

fn logarithm(a: i64) {
    match fx(a).log2() {
        Ok(log) => {
            let off = error(log.to_bits(), &REFERENCE.log2(a));
            assert!(off.abs() <= NEAREST, "{a}: {off}");
        }
        Err(error) => assert!(error == MathError::NotPositive && a <= 0, "{a}"),
    }
}

fn power(base: i64, exponent: i64) {
    let power = fx(base).pow(fx(exponent));
    if base <= 0 {
        return assert_eq!(power, Err(MathError::NotPositive));
    }
    assert_power(power, &(REFERENCE.log2(base) * real(exponent, -32)), (base, exponent));
}

fn number_as_text(a: i64) {
    let text = fx(a).to_string();
    assert_eq!(text.parse(), Ok(fx(a)));
    let Ok(decimal) = Decimal::read(&text) else { panic!("{text}") };
    // Every digit is there: nothing is rounded.
    assert_eq!(decimal.num * (IBig::ONE << 32), IBig::from(a) * IBig::from(decimal.den), "{text}");
}

/// num / den, read from a text by the grammar alone.
struct Decimal {
    num: IBig,
    den: UBig,
}

/// Reason why a text is not a number that fits: no number, or too many digits on either side of the point.
#[derive(Debug, PartialEq)]
enum Unread {
    Grammar,
    Large,
    Small,
}

impl Decimal {
    fn read(text: &str) -> std::result::Result<Self, Unread> {
        let (negative, rest) = match text.as_bytes().first() {
            Some(b'-') => (true, &text[1..]),
            Some(b'+') => (false, &text[1..]),
            _ => (false, text),
        };
        let (number, exponent) = match rest.split_once(['e', 'E']) {
            Some((number, exponent)) => (number, Some(exponent)),
            None => (rest, None),
        };
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if !are_digits(whole) || !are_digits(fraction) || whole.len() + fraction.len() == 0 {
            return Err(Unread::Grammar);
        }
        let digits = format!("{whole}{fraction}");
        let magnitude = UBig::from_str_radix(&digits, 10).expect("digits");
        let num = if negative { -IBig::from(magnitude) } else { IBig::from(magnitude) };
        let mut places = -(fraction.len() as i64);
        if let Some(exponent) = exponent {
            let size = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            if size.is_empty() || !are_digits(size) {
                return Err(Unread::Grammar);
            }
            // Beyond what a text can have in digits on the other side.
            let max = 1_000 + text.len() as i64;
            let size = size.trim_start_matches('0');
            let size = if size.is_empty() { 0 } else { size.parse::<i64>().unwrap_or(max).min(max) };
            places += if exponent.starts_with('-') { -size } else { size };
            if size == max && !num.is_zero() {
                return Err(if exponent.starts_with('-') { Unread::Small } else { Unread::Large });
            }
        }
        if num.is_zero() {
            return Ok(Self { num, den: UBig::ONE });
        }
        let power = UBig::from(10u8).pow(places.unsigned_abs() as usize);
        Ok(if places < 0 { Self { num, den: power } } else { Self { num: num * IBig::from(power), den: UBig::ONE } })
    }
}

fn text_as_number(text: &str) {
    let read = Fx::parse(text);
    match Decimal::read(text) {
        Ok(Decimal { num, den }) => {
            let exact = i64::try_from(nearest(&(num << 32), &den)).ok().map(fx);
            assert_eq!(read, exact.ok_or(ParseFxError::OutOfRange), "{text:?}");
        }
        Err(Unread::Small) => assert_eq!(read, Ok(Fx::ZERO), "{text:?}"),
        Err(Unread::Large) => assert_eq!(read, Err(ParseFxError::OutOfRange), "{text:?}"),
        Err(Unread::Grammar) => {
            let refused = matches!(read, Err(ParseFxError::Empty | ParseFxError::InvalidDigit { .. }));
            assert!(refused && (read == Err(ParseFxError::Empty)) == text.is_empty(), "{text:?}: {read:?}");
        }
    }
}

fn text_as_factor(text: &str) {
    let read = FxFactor::parse(text);
    match Decimal::read(text) {
        Ok(Decimal { num, den }) => {
            let Ok(num) = UBig::try_from(num) else {
                return assert_eq!(read, Err(ParseFxError::OutOfRange), "{text:?}");
            };
            let ten = |power: usize| UBig::from(10u8).pow(power);
            let within = &num * ten(60) >= den && num < &den * ten(60);
            match read {
                Ok(factor) => assert_nearest(factor, &num, &den, 0),
                Err(error) => assert_eq!(error, ParseFxError::OutOfRange, "{text:?}"),
            }
            assert_eq!(read.is_ok(), num == UBig::ZERO || within, "{text:?}: {read:?}");
        }
        Err(Unread::Grammar) => assert!(read.is_err() && read != Err(ParseFxError::OutOfRange), "{text:?}: {read:?}"),
        Err(_) => assert_eq!(read, Err(ParseFxError::OutOfRange), "{text:?}"),
    }
}

/// A factor in the range where its exponent does not end.
fn is_within(factor: FxFactor) -> bool {
    factor.parts().1.unsigned_abs() < 1 << 14
}

/// Asserts that a factor is the one nearest to num / den · 2^-shift, ties to even.
fn assert_nearest(factor: FxFactor, num: &UBig, den: &UBig, shift: i32) {
    let (mantissa, exponent) = factor.parts();
    if *num == UBig::ZERO || mantissa == 0 {
        return assert!(*num == UBig::ZERO && mantissa == 0, "{factor}");
    }
    assert_eq!(mantissa >> 63, 1, "{factor}");
    // num / den · 2^(own − shift) is to be nearest to the mantissa.
    let up = exponent - shift;
    let scaled = |value: &UBig, up: i32| value << up.max(0).unsigned_abs() as usize;
    let (num, den) = (scaled(num, up), scaled(den, -up));
    if mantissa == 1 << 63 {
        // Below a power of two factors are closer: half as far down as up.
        let low = IBig::from(num.clone()) * 4 - ((IBig::ONE << 65) - 1) * IBig::from(den.clone());
        assert!(low >= IBig::ZERO, "{factor}");
    }
    assert_eq!(nearest(&IBig::from(num.clone()), &den).max(IBig::ONE << 63), IBig::from(mantissa), "{factor}");
}

fn factors(a: FxFactor, b: FxFactor) {
    let ((m, p), (n, q)) = (a.parts(), b.parts());
    let (x, y) = (UBig::from(m), UBig::from(n));
    let unit = UBig::ONE;
    let product = a.times(b);
    if is_within(product) && (p + q).abs() < (1 << 14) - 200 {
        assert_nearest(product, &(&x * &y), &unit, p + q);
    }
    if !b.is_zero() {
        let quotient = a.over(b);
        if is_within(quotient) && (p - q).abs() < (1 << 14) - 200 {
            assert_nearest(quotient, &x, &y, p - q);
        }
    }
    if a.is_zero() || b.is_zero() {
        let addend = if a.is_zero() { b } else { a };
        assert_eq!((a.plus(b), a.minus(b).plus(b.minus(a))), (addend, addend));
    } else if p.abs_diff(q) < 400 {
        let larger = p.max(q);
        let (x, y) = (x << (larger - p) as usize, y << (larger - q) as usize);
        assert_nearest(a.plus(b), &(&x + &y), &unit, larger);
        assert_eq!(a.partial_cmp(&b), Some(x.cmp(&y)));
        let difference = if x > y { x - y } else { UBig::ZERO };
        assert_nearest(a.minus(b), &difference, &unit, larger);
    } else {
        let larger = if p < q { a } else { b };
        assert_eq!(a.plus(b), larger);
        assert_eq!(a.minus(b), if p < q { a } else { FxFactor::ZERO });
    }
    let down = |shift: i32| (shift.clamp(0, 1_000) as usize, (-shift).clamp(0, 1_000) as usize);
    let (left, right) = (down(32 - p).0, down(32 - p).1);
    let scalar = nearest(&(IBig::from(m) << left), &(UBig::ONE << right));
    assert_eq!(a.to_scalar().map(Fx::to_bits), i64::try_from(scalar).ok(), "{a}");
}

fn ratio(a: i64, b: i64) {
    let den = b.unsigned_abs().max(1);
    let factor = FxFactor::from_ratio(a.unsigned_abs(), den);
    assert_nearest(factor, &UBig::from(a.unsigned_abs()), &UBig::from(den), 0);
    let scalar = FxFactor::from_scalar(fx(a));
    assert_nearest(scalar, &UBig::from(a.unsigned_abs()), &UBig::ONE, 32);
}

/// `value` · mantissa / 2^shift to nearest, ties to even, for one whose shift is no matter of memory.
fn scaled(value: i128, factor: FxFactor, up: i32) -> Option<IBig> {
    let (mantissa, shift) = factor.parts();
    let shift = shift - up;
    if shift.unsigned_abs() > 2_000 {
        return (value == 0 || mantissa == 0 || shift > 0).then_some(IBig::ZERO);
    }
    let product = IBig::from(value) * mantissa;
    let (left, right) = (shift.min(0).unsigned_abs() as usize, shift.max(0) as usize);
    Some(nearest(&(product << left), &(UBig::ONE << right)))
}

fn wide_numbers(values: [i128; 3], factor: FxFactor) {
    let [a, b, c] = values;
    let wide = FxWide::from_bits;
    let fits = |exact: Option<IBig>| exact.and_then(|exact| i128::try_from(exact).ok());
    let product = wide(a).times(factor).map(FxWide::to_bits);
    // The ends of the range: the product is as odd as the factor is even, so that −2^63 itself is left out.
    assert_eq!(product, fits(scaled(a, factor, 0)).filter(|bits| *bits != i128::MIN), "{a} · {factor}");
    assert_eq!(wide(a).plus(wide(b)).map(FxWide::to_bits), a.checked_add(b));
    let scalar = nearest(&IBig::from(a), &(UBig::ONE << 32));
    assert_eq!(wide(a).to_scalar().map(Fx::to_bits), i64::try_from(scalar).ok());
    let mut sums = [FxSum::default(); 2];
    for (term, reordered) in [a, b, c].into_iter().zip([c, a, b]) {
        sums[0].add(wide(term));
        sums[1].add(wide(reordered));
    }
    assert_eq!(sums[0], sums[1], "the order of terms matters");
    let total = IBig::from(a) + b + c;
    assert_eq!(sums[0].total().map(FxWide::to_bits), i128::try_from(total).ok());
    let magnitude = scaled(1, factor, 64);
    let from = FxWide::from_factor(factor, a < 0).map(FxWide::to_bits);
    assert_eq!(from, fits(magnitude).map(|bits| if a < 0 { -bits } else { bits }), "{factor}");
}

fn accumulators(a: FxAccumulator, b: FxAccumulator, factor: FxFactor) {
    let (x, y) = (a.to_bits(), b.to_bits());
    // Where a body may be, and what a stage may add: 2^31 m less half an ulp.
    let fits = |bits: i128| bits.unsigned_abs() < (1 << 127) - (1 << 63);
    if fits(x) {
        let value = nearest(&IBig::from(x), &(UBig::ONE << 64));
        assert_eq!(a.value().to_bits(), i64::try_from(value).expect("it fits"));
        assert_eq!(a.is_still(), a.value() == Fx::ZERO);
        assert_eq!(a.negated().value(), -a.value());
    }
    if let Some(sum) = x.checked_add(y) {
        assert_eq!(a.plus(b).to_bits(), sum);
        assert_eq!(a.plus(b).plus(b.negated()), a, "what is added does not go away again");
    }
    let limit = Fx::from_bits((y >> 64) as i64 & i64::MAX);
    assert_eq!(a.is_within(limit), x.unsigned_abs() <= u128::from(limit.to_bits().unsigned_abs()) << 64);
    // From 2^24 on, and where the public value is zero.
    let product = scaled(x, factor, 0).and_then(|exact| i128::try_from(exact).ok());
    let product = product.filter(|bits| bits.unsigned_abs() < 1 << 120);
    let settled = product.map(|bits| if bits.unsigned_abs() <= 1 << 63 { 0 } else { bits });
    assert_eq!(a.scaled(factor).map(FxAccumulator::to_bits), settled, "{a} · {factor}");
    assert_eq!(Accumulator::<Fx>::to_bytes(a), (x.rotate_left(64)).to_le_bytes());
}

/// Radians, sine and cosine of an angle of so many 2^-64 turns.
fn exact_turn(turn: u64) -> (Real, Real, Real) {
    let radians = real(turn, -62) * &REFERENCE.half_pi;
    // The nearest multiple of 2^-32 has a sine and a cosine; the rest is below 2^-32, its fourth power below 2^-128.
    let radians_bits = (radians.clone() << 32).to_int().value();
    let radians_bits = i64::try_from(radians_bits).expect("at most 2π");
    let (sin, cos) = REFERENCE.sin_cos(radians_bits);
    let rest = &radians - real(radians_bits, -32);
    let square = &rest * &rest;
    let (s, c) = (&rest * (real(1, 0) - &square / real(6, 0)), real(1, 0) - square * real(1, -1));
    (radians, &sin * &c + &cos * &s, cos * c - sin * s)
}

/// An angle and back, its sine and cosine, and a vector turned by it; quarter turns and mirror images are exact.
fn angles(turn: u64, radians: i64, x: i64, y: i64) {
    let angle = Turn::from_bits(turn);
    let (exact, exact_sin, exact_cos) = exact_turn(turn);
    let (sin, cos) = angle.sin_cos();
    let off = [error(sin.to_bits(), &exact_sin), error(cos.to_bits(), &exact_cos)];
    assert!(off.iter().all(|off| off.abs() <= NEAREST), "{turn:#x}: {off:?}");
    assert_eq!(Turn::from_bits(turn.wrapping_add(1 << 62)).sin_cos(), (cos, -sin));
    assert_eq!(Turn::from_bits(turn.wrapping_neg()).sin_cos(), (-sin, cos));
    let back = angle.radians();
    let off = error(back.to_bits(), &exact);
    assert!(off.abs() <= NEAREST && real(back.to_bits(), -32) < real(4, 0) * &REFERENCE.half_pi, "{turn:#x}: {off}");
    assert!(back >= Fx::ZERO, "{back}");
    let turn_bits = |radians: i64| Turn::from_radians(fx(radians)).to_bits();
    // In units of 2^-64 turns, whole turns apart.
    let off = real(radians, 30) / &REFERENCE.half_pi - real(turn_bits(radians), 0);
    let turns = (off.clone() >> 64) + real(1, -1);
    let off = magnitude(&(off - (turns.floor() << 64)));
    assert!(off <= 0.501, "{radians}: {off}");
    if radians != i64::MIN {
        assert_eq!(turn_bits(-radians), turn_bits(radians).wrapping_neg());
    }
    // Sine and cosine are within 2^-61, and the sum is rounded to 2^-64 m.
    let arms = [real(x, -32), real(y, -32)];
    let allowed = 0.51 + 8.0 * (magnitude(&arms[0]) + magnitude(&arms[1]));
    let turned = [&arms[0] * &exact_cos - &arms[1] * &exact_sin, &arms[0] * &exact_sin + &arms[1] * &exact_cos];
    let (x, y) = (fx(x), fx(y));
    let rotated = angle.rotate(Vec2::new(x, y));
    match rotated {
        Some(rotated_vector) => {
            for (kept, exact) in [rotated_vector.x, rotated_vector.y].into_iter().zip(turned) {
                let off = magnitude(&((real(kept.to_bits(), -64) - exact) << 64));
                assert!(off <= allowed, "{off} of {allowed} for {x}, {y} by {turn:#x}");
            }
        }
        // A component of 2^31 m or more.
        None => {
            assert!(turned.iter().any(|part| magnitude(part) >= 2f64.powi(31) * 0.999_999), "{x}, {y} by {turn:#x}")
        }
    }
    if let (Some(minus_x), Some(minus_y)) = (x.checked_neg(), y.checked_neg()) {
        // An end of the range that turns beyond it is refused alike in all of them.
        let (left, mirrored) =
            (angle.rotate(Vec2::new(minus_y, x)), Turn::from_bits(turn.wrapping_neg()).rotate(Vec2::new(x, minus_y)));
        assert_eq!(left, rotated.map(|v| Vec2::new(v.y.negated(), v.x)));
        assert_eq!(mirrored, rotated.map(|v| Vec2::new(v.x, v.y.negated())));
        assert_eq!(angle.rotate(Vec2::new(minus_x, minus_y)), rotated.map(|v| v.map(FxWide::negated)));
    }
}

fn exact_factor(factor: FxFactor) -> Real {
    let (mantissa, shift) = factor.parts();
    real(mantissa, -(shift as isize))
}

fn magnitude(value: &Real) -> f64 {
    value.to_f64().value().abs()
}

fn attraction(mu: FxFactor, (x, y): (i64, i64), softening: i64) {
    // The world's: mu to 2^64 m³/s², softening from 0 to 2^12 m, positions within the envelope.
    let max = FxFactor::from_ratio(1 << 63, 1).times(FxFactor::from_ratio(2, 1));
    let (x, y, softening) = (x >> 1, y >> 1, softening.unsigned_abs() >> 19);
    let far = |bits: i64| FxWide::from_scalar(fx(bits));
    if mu > max || (mu.parts().1 > 200) {
        return;
    }
    let acceleration = Fx::attraction(mu, Vec2::new(far(x), far(y)), fx(softening as i64));
    if (x, y) == (0, 0) {
        return assert_eq!(acceleration, Some(Vec2::default()));
    }
    let component = |raw: i64| real(raw, -32);
    let softening = component(softening as i64);
    let square = component(x) * component(x) + component(y) * component(y) + &softening * &softening;
    let share = exact_factor(mu) / (&square * square.sqrt());
    let Some(acceleration) = acceleration else {
        // A component that does not fit 2^63 m/s².
        let parts = [x, y].map(|raw| magnitude(&component(raw).mul(&share)));
        return assert!(
            parts.iter().any(|part| *part >= 2f64.powi(63) * 0.999_999),
            "{parts:?} at {x}, {y} with mu {mu}"
        );
    };
    for (kept, raw) in [(acceleration.x, x), (acceleration.y, y)] {
        let exact = component(raw).mul(&share);
        let off = magnitude(&((real(kept.to_bits(), -64) - &exact) << 64));
        // Rounded to 2^-64 m/s², after an error of 2^-90 relative.
        assert!(off <= 0.51 + magnitude(&exact) * 2f64.powi(64 - 90), "{off} at {x}, {y} with mu {mu}");
    }
}

fn tension((x, y): (i64, i64), velocity: (i64, i64), [rest, stiffness, damping]: [i64; 3]) {
    let (x, y) = (x >> 1, y >> 1);
    let [rest, stiffness, damping] = [rest >> 1, stiffness, damping].map(|bits| bits & i64::MAX);
    let far = |bits: i64| FxWide::from_scalar(fx(bits));
    let law = SpringConstants { rest: fx(rest), stiffness: fx(stiffness), damping: fx(damping) };
    let force = Fx::tension(Vec2::new(far(x), far(y)), Vec2::new(far(velocity.0), far(velocity.1)), &law);
    if (x, y) == (0, 0) {
        return assert_eq!(force, Some(Vec2::default()));
    }
    let unit = |raw: i64| real(raw, -32);
    let length = (unit(x) * unit(x) + unit(y) * unit(y)).sqrt();
    let along = [unit(x) / &length, unit(y) / &length];
    let rate = unit(velocity.0) * &along[0] + unit(velocity.1) * &along[1];
    let pull = unit(stiffness) * (&length - unit(rest)) + unit(damping) * &rate;
    let Some(force) = force else {
        // A magnitude that does not fit 2^63 N, or one of the two that make it up.
        let parts = [unit(stiffness) * (&length - unit(rest)), unit(damping) * &rate, pull];
        return assert!(parts.iter().any(|part| magnitude(part) >= 2f64.powi(63) * 0.999_999));
    };
    // The documented error: of the length 0.501 · 2^-64 m, or 0.751 where it is large, and as much of the rate; of the tension one rounding
    // for each part; of the direction 2^-94 relative; one rounding more. In units of 2^-64 N.
    let speed = f64::hypot(magnitude(&unit(velocity.0)), magnitude(&unit(velocity.1)));
    let lost = (magnitude(&pull) + magnitude(&unit(damping)) * speed) * 2f64.powi(64 - 93);
    let stretched = if magnitude(&length) < 2f64.powi(23) { 0.501 } else { 0.751 };
    let allowed = stretched * magnitude(&unit(stiffness)) + 0.51 * magnitude(&unit(damping)) + 1.51 + lost;
    for (kept, along) in [force.x, force.y].into_iter().zip(along) {
        let off = magnitude(&((real(kept.to_bits(), -64) - &pull * along) << 64));
        assert!(off <= allowed, "{off} of {allowed} at {x}, {y} with {law:?} and {velocity:?}");
    }
    let mirrored = Fx::tension(Vec2::new(far(-x), far(y)), Vec2::new(far(-velocity.0), far(velocity.1)), &law);
    assert_eq!(mirrored, Some(Vec2::new(Neg::neg(Signed(force.x)).0, force.y)));
}

struct Signed(FxWide);

impl Neg for Signed {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.negated())
    }
}
