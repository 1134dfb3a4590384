//! Factors from decimal text, with one rounding however many digits there are, and as text with all their digits.

use alloc::string::{String, ToString};
use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;
use core::str::FromStr;

use super::factor::FxFactor;
use crate::fx::{Decimal, ParseFxError};

/// Values from 10^-60 to below 10^60 are read; beyond there is no quantity of the engine's.
const REACH: i64 = 60;
/// More digits than any tie has. The value is at least 2^-200, its last bit and the half below it at least 2^-265, and a
/// multiple of 2^-265 has 265 digits after the point at most and 60 before it.
const DIGITS: usize = 330;

impl FxFactor {
    /// The factor nearest to a decimal number of at least zero, ties to even, rounded once to 64 significant bits.
    ///
    /// The grammar is that of [`Fx::parse`](crate::Fx::parse). *Domain* 0, or 10^-60 to below 10^60.
    ///
    /// # Errors
    /// [`ParseFxError`] says whether there is no text, where it stops being a number, or that the value is negative or
    /// beyond the domain.
    ///
    /// ```
    /// use umbra_physics::{FxFactor, ParseFxError};
    /// // The Earth's: 3.986004418·10^14 m³/s² is an integer, so it is read exactly.
    /// let earth = FxFactor::parse("3.986004418e14")?;
    /// assert_eq!(earth.parts(), (398_600_441_800_000 << 15, 15));
    /// # Ok::<(), ParseFxError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, ParseFxError> {
        let decimal = Decimal::scan(text.as_bytes(), false)?;
        let zeros = decimal.digits().take_while(|&digit| digit == 0).count();
        let mut digits = decimal.digits().skip(zeros).peekable();
        if digits.peek().is_none() {
            return Ok(Self::default());
        }
        // The value is 0.digits · 10^exponent, the first digit not zero.
        let exponent = decimal.whole_digits.saturating_sub_unsigned(zeros as u64);
        if decimal.negative || exponent <= -REACH || exponent > REACH {
            return Err(ParseFxError::OutOfRange);
        }
        let (mut numerator, mut count) = (Natural(vec![]), 0);
        for digit in digits.by_ref().take(DIGITS) {
            numerator.times_plus(10, digit);
            count += 1;
        }
        // Further digits can only tell a tie from a number above it.
        if digits.any(|digit| digit != 0) {
            numerator.times_plus(10, 1);
            count += 1;
        }
        let mut denominator = Natural(vec![1]);
        for _ in exponent..count {
            denominator.times_plus(10, 0);
        }
        for _ in count..exponent {
            numerator.times_plus(10, 0);
        }
        Ok(quotient(numerator, denominator))
    }

    /// The decimal digits of the value, the lowest first, and how many of them are after the point; one at least is before it.
    fn decimal(self) -> (Vec<u8>, usize) {
        let (mantissa, shift) = self.parts();
        let zeros = if mantissa == 0 { 0 } else { mantissa.trailing_zeros() };
        let (odd, shift) = (mantissa >> zeros, shift - zeros as i32);
        let mut digits: Vec<u8> = odd.to_string().bytes().rev().map(|digit| digit - b'0').collect();
        // odd · 2^-shift is odd · 5^shift · 10^-shift.
        for _ in 0..shift.unsigned_abs() {
            times(&mut digits, if shift > 0 { 5 } else { 2 });
        }
        let places = shift.max(0) as usize;
        digits.resize(digits.len().max(places + 1), 0);
        (digits, places)
    }
}

impl fmt::Display for FxFactor {
    /// The exact decimal value, at most 16,384 digits after the point; with a precision, that many digits, rounded to nearest,
    /// ties to even. Width, fill and zero flags as for `f64`. [`FxFactor::parse`] reads the exact value back within its domain.
    ///
    /// ```
    /// use umbra_physics::FxFactor;
    /// let factor = FxFactor::parse("12.625")?;
    /// assert_eq!((factor.to_string(), format!("{factor:.2}"), format!("{factor:08.1?}")), ("12.625".into(), "12.62".into(), "000012.6".into()));
    /// # Ok::<(), umbra_physics::ParseFxError>(())
    /// ```
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut digits, mut places) = self.decimal();
        if let Some(precision) = f.precision() {
            if precision < places {
                round_off(&mut digits, places - precision);
            } else {
                digits.splice(0..0, vec![0; precision - places]);
            }
            places = precision;
        }
        let digit = |&digit: &u8| char::from(b'0' + digit);
        let mut text: String = digits[places..].iter().rev().map(digit).collect();
        if places > 0 {
            text.push('.');
            text.extend(digits[..places].iter().rev().map(digit));
        }
        f.pad_integral(true, "", &text)
    }
}

impl fmt::Debug for FxFactor {
    /// Writes the number as [`Display`](fmt::Display) does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Takes the lowest `count` digits off, rounded to nearest, ties to even. *Domain* count > 0, and digits remain.
fn round_off(digits: &mut Vec<u8>, count: usize) {
    let rest: Vec<u8> = digits.drain(..count).collect();
    let beyond_half = match rest[count - 1].cmp(&5) {
        Ordering::Equal if rest[..count - 1].iter().all(|&digit| digit == 0) => digits[0] % 2 == 1,
        order => order.is_ge(),
    };
    if beyond_half {
        let nines = digits.iter().take_while(|&&digit| digit == 9).count();
        digits[..nines].fill(0);
        match digits.get_mut(nines) {
            Some(digit) => *digit += 1,
            None => digits.push(1),
        }
    }
}

/// Multiplies a number of decimal digits, the lowest first, by one of a digit.
fn times(digits: &mut Vec<u8>, factor: u8) {
    let mut carry = 0;
    for digit in digits.iter_mut() {
        carry += *digit * factor;
        (*digit, carry) = (carry % 10, carry / 10);
    }
    if carry > 0 {
        digits.push(carry);
    }
}

impl FromStr for FxFactor {
    type Err = ParseFxError;

    /// The nearest factor, ties to even: see [`FxFactor::parse`].
    fn from_str(text: &str) -> Result<Self, ParseFxError> {
        Self::parse(text)
    }
}

/// The factor nearest to numerator / denominator, both above zero.
fn quotient(mut numerator: Natural, mut denominator: Natural) -> FxFactor {
    // Scaled so that the quotient has 66 or 67 bits: 64, the half, and one to spare.
    const BITS: i64 = 67;
    let shift = BITS - 1 - (numerator.bits() - denominator.bits());
    numerator.shift_up(shift.max(0).unsigned_abs());
    denominator.shift_up(shift.min(0).unsigned_abs());
    let mut bits = 0u128;
    denominator.shift_up(BITS.unsigned_abs());
    for _ in 0..=BITS {
        bits <<= 1;
        if numerator.take(&denominator) {
            bits |= 1;
        }
        denominator.halve();
    }
    // All that is below the quotient is gathered in its last bit, and rounded once with it. |shift| < 2000.
    let below = u128::from(!numerator.is_zero());
    FxFactor::new((bits << 1) | below, shift as i32 + 1)
}

/// A natural number, the lowest digit first, without zeros at the top.
struct Natural(Vec<u32>);

impl Natural {
    fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    fn bits(&self) -> i64 {
        let top = self.0.last().map_or(0, |top| top.leading_zeros());
        self.0.len() as i64 * 32 - i64::from(top)
    }

    /// self · factor + digit.
    fn times_plus(&mut self, factor: u8, digit: u8) {
        let mut carry = u64::from(digit);
        for limb in &mut self.0 {
            // Below 2^32 · 2^8 + 2^8.
            carry += u64::from(*limb) * u64::from(factor);
            *limb = carry as u32;
            carry >>= 32;
        }
        if carry > 0 {
            self.0.push(carry as u32);
        }
    }

    /// self · 2^count.
    fn shift_up(&mut self, count: u64) {
        for _ in 0..count % 32 {
            self.times_plus(2, 0);
        }
        if !self.is_zero() {
            self.0.splice(0..0, vec![0; (count / 32) as usize]);
        }
    }

    /// self / 2; a last bit is lost.
    fn halve(&mut self) {
        let mut carry = 0;
        for limb in self.0.iter_mut().rev() {
            (*limb, carry) = ((*limb >> 1) | (carry << 31), *limb & 1);
        }
        self.trim();
    }

    /// Subtracts `rhs` if it is not larger; returns true if it did.
    fn take(&mut self, rhs: &Self) -> bool {
        let larger = self.0.len().cmp(&rhs.0.len()).then_with(|| self.0.iter().rev().cmp(rhs.0.iter().rev()));
        if larger.is_lt() {
            return false;
        }
        let mut borrow = false;
        for (i, limb) in self.0.iter_mut().enumerate() {
            let (rest, first) = limb.overflowing_sub(rhs.0.get(i).copied().unwrap_or(0));
            let (rest, second) = rest.overflowing_sub(u32::from(borrow));
            *limb = rest;
            borrow = first || second;
        }
        self.trim();
        true
    }

    fn trim(&mut self) {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::cases;
    use alloc::format;
    use dashu_float::{DBig, FBig, round::mode::HalfEven};
    use dashu_int::UBig;
    use proptest::prelude::*;

    fn check(text: &str) {
        let exact: DBig = text.parse().unwrap_or_default();
        let nearest: FBig<HalfEven, 2> = exact.with_rounding::<HalfEven>().with_base_and_precision(64).value();
        let (significand, exponent) = nearest.into_repr().into_parts();
        let (mantissa, shift) = FxFactor::parse(text).unwrap_or_default().parts();
        let zeros = mantissa.trailing_zeros();
        let ours = ((mantissa >> zeros).to_string(), zeros as isize - shift as isize);
        assert_eq!(ours, (significand.to_string(), exponent), "{text}");
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_decimal_is_rounded_once(digits in "[1-9][0-9]{0,80}", point in 0usize..40, exponent in -20i32..20) {
            let point = point.min(digits.len());
            check(&format!("{}.{}e{exponent}", &digits[..point], &digits[point..]));
        }

        #[test]
        fn ties_go_to_even(mantissa in (1u64 << 63).., places in 0u32..20) {
            // (mantissa + ½) · 2^-places, written out: an integer times 5^(places + 1).
            let even = FxFactor::new(u128::from(mantissa) + u128::from(mantissa & 1), places as i32);
            let whole: UBig = (0..=places).fold(
                UBig::from(2 * u128::from(mantissa) + 1), |value, _| value * UBig::from(5u8));
            let text = format!("{whole}e-{}", places + 1);
            prop_assert_eq!(FxFactor::parse(&text), Ok(even));
            let above = format!("{whole}.{}1e-{}", "0".repeat(400), places + 1);
            prop_assert_eq!(FxFactor::parse(&above), Ok(FxFactor::new(u128::from(mantissa) + 1, places as i32)));
        }

        #[test]
        fn all_digits_are_written(mantissa: u64, places in -60i32..190) {
            let factor = FxFactor::new(mantissa.into(), places);
            let text = factor.to_string();
            prop_assert_eq!(FxFactor::parse(&text), Ok(factor));
            let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
            prop_assert!(!fraction.ends_with('0') && (whole == "0" || !whole.starts_with('0')), "{}", text);
            let written: UBig = format!("{whole}{fraction}").parse().unwrap_or_default();
            // Exactly: written · 2^places = mantissa · 10^digits, either side without a fraction.
            let (up, down) = (places.max(0) as usize, (-places).max(0) as usize);
            let scaled = UBig::from(mantissa) * UBig::from(10u8).pow(fraction.len());
            prop_assert_eq!(written << up, scaled << down);
        }

        #[test]
        fn a_precision_rounds_once_ties_to_even(mantissa: u64, places in 0i32..100, precision in 0usize..120) {
            // A tie in one case of some: few bits after the point.
            for mantissa in [mantissa, mantissa | 1 << 63, mantissa >> 58] {
                let factor = FxFactor::new(mantissa.into(), places);
                let text = format!("{factor:.precision$}");
                let (num, den) = (UBig::from(mantissa) * UBig::from(10u8).pow(precision), UBig::ONE << places as usize);
                let (floor, rest) = (&num / &den, (&num % &den) << 1);
                let is_odd = &floor % UBig::from(2u8) == UBig::ONE;
                let nearest = if rest > den || (rest == den && is_odd) { floor + UBig::ONE } else { floor };
                let digits: UBig = text.replace('.', "").parse().unwrap_or_default();
                prop_assert_eq!(digits, nearest, "{} of {}", text, factor);
                let after = text.split_once('.').map_or(0, |(_, after)| after.len());
                prop_assert_eq!(after, precision);
            }
        }

        #[test]
        fn any_text_is_answered(text in ".*") {
            let _ = FxFactor::parse(&text);
        }
    }

    #[test]
    fn the_domain_has_edges() {
        for text in ["-1", "1e61", "1e-61", "1e999999999999999999999", "1e-999999999999999999999"] {
            assert_eq!(FxFactor::parse(text), Err(ParseFxError::OutOfRange), "{text}");
        }
        for text in ["0", "-0", "0e99999999999", "0.000"] {
            assert_eq!(FxFactor::parse(text), Ok(FxFactor::default()), "{text}");
        }
        assert_eq!(FxFactor::parse("1e"), Err(ParseFxError::InvalidDigit { position: 2 }));
        let long: String = "9".repeat(1_000);
        assert_eq!(FxFactor::parse(&long), Err(ParseFxError::OutOfRange));
        check("9.9e59");
        check("1e-60");
        check("9.999e-60");
    }
}
