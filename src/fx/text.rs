//! `Fx` as decimal text, exactly: every digit out, one rounding in.

use core::fmt;
use core::str::FromStr;

use super::{Fx, decimal};
use crate::codes::codes;

/// The reason that a text is not a number in I32F32.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum ParseFxError {
    /// The text is empty.
    Empty,
    /// The byte there cannot continue a decimal number, or the text ends where a digit must follow.
    InvalidDigit {
        /// The index of that byte; the length of the text if it ends too soon.
        position: usize,
    },
    /// The number, once rounded, is not between −2^31 and 2^31 − 2^-32.
    OutOfRange,
}

impl fmt::Display for ParseFxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a number is expected, and there is no text"),
            Self::InvalidDigit { position } => write!(f, "not a decimal number: no digit at byte {position}"),
            Self::OutOfRange => f.write_str("the number is outside the range of I32F32, from -2^31 to below 2^31"),
        }
    }
}

codes!(ParseFxError { Empty = 711, InvalidDigit = 712, OutOfRange = 713 });

impl core::error::Error for ParseFxError {}

impl FromStr for Fx {
    type Err = ParseFxError;

    /// The nearest value, ties to even: see [`Fx::parse`].
    fn from_str(text: &str) -> Result<Self, ParseFxError> {
        Self::parse(text)
    }
}

impl Fx {
    /// The value nearest to a decimal number, ties to even, rounded once however many digits there are.
    ///
    /// The number is an optional sign, digits with an optional point among, before or after them, and an optional
    /// exponent (`e` or `E`, an optional sign, digits): all that JSON allows, and `+1`, `.5`, `5.` beside.
    ///
    /// # Errors
    /// [`ParseFxError`] says whether there is no text, where it stops being a number, or that the value does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, ParseFxError};
    /// assert_eq!(Fx::parse("-1.5e-1")?.to_string(), "-0.1499999999068677425384521484375");
    /// assert_eq!(Fx::parse("0.1e"), Err(ParseFxError::InvalidDigit { position: 4 }));
    /// // 2^-33 is a tie, and goes to 0; anything more is an ulp.
    /// assert_eq!(Fx::parse("0.000000000116415321826934814453125"), Ok(Fx::ZERO));
    /// assert_eq!(Fx::parse("0.0000000001164153218269348144531250001"), Ok(Fx::DELTA));
    /// # Ok::<(), ParseFxError>(())
    /// ```
    pub const fn parse(text: &str) -> Result<Self, ParseFxError> {
        match Decimal::scan(text.as_bytes(), false) {
            Ok(decimal) => decimal.round(),
            Err(error) => Err(error),
        }
    }

    /// The value of a literal of Rust, for [`fx!`](crate::fx): as `parse`, and digits may be parted by `_`.
    #[doc(hidden)]
    #[must_use]
    pub const fn from_literal(text: &str) -> Self {
        let value = match Decimal::scan(text.as_bytes(), true) {
            Ok(decimal) => decimal.round(),
            Err(error) => Err(error),
        };
        match value {
            Ok(value) => value,
            Err(ParseFxError::OutOfRange) => panic!("fx!: the number does not fit in I32F32, from -2^31 to below 2^31"),
            Err(_) => panic!("fx! takes a decimal number without a suffix, as in fx!(0.5)"),
        }
    }

    /// The ratio of two integer literals, for [`fx!`](crate::fx).
    #[doc(hidden)]
    #[must_use]
    pub const fn from_literals(num: &str, den: &str) -> Self {
        let (num, den) = (integer(num.as_bytes()), integer(den.as_bytes()));
        assert!(den != 0, "fx!: the denominator is zero");
        match Self::checked_from_ratio(num, den) {
            Some(ratio) => ratio,
            None => panic!("fx!: the ratio does not fit in I32F32, from -2^31 to below 2^31"),
        }
    }
}

/// The value of an integer literal.
const fn integer(text: &[u8]) -> i64 {
    let negative = text[0] == b'-';
    let mut at = negative as usize;
    let mut value = 0i64;
    while at < text.len() {
        let digit = text[at];
        assert!(digit.is_ascii_digit() || digit == b'_', "fx! takes ratios of two integers, as in fx!(1/60)");
        if digit != b'_' {
            value = match value.checked_mul(10) {
                // Ten times a number may end in 800, the greatest one in 807: the sum is checked as well.
                Some(tens) => match tens.checked_add((digit - b'0') as i64) {
                    Some(sum) => sum,
                    None => panic!("fx! takes ratios of integers below 2^63"),
                },
                None => panic!("fx! takes ratios of integers below 2^63"),
            };
        }
        at += 1;
    }
    if negative { -value } else { value }
}

/// The `Fx` nearest to a decimal literal or to a ratio of two integers, ties to even, made at compile time and never through a
/// float.
///
/// A number that does not fit is a compile error, and so is all that is no literal: [`Fx::from`] takes integers,
/// [`Fx::from_ratio`] ratios and [`Fx::parse`] text that is known at run time only.
///
/// ```
/// use umbra_physics::{Fx, fx};
///
/// assert_eq!(fx!(0.5), Fx::HALF);
/// assert_eq!(fx!(-9.81).to_bits(), -42_133_629_174);
/// assert_eq!(fx!(1_000.5e-3), fx!(1.0005));
/// const FRAME: Fx = fx!(1 / 60);
/// assert_eq!((FRAME, fx!(-2/3)), (Fx::from_ratio(1, 60), Fx::from_ratio(-2, 3)));
/// ```
/// ```compile_fail
/// # use umbra_physics::fx;
/// let too_large = fx!(2147483648);
/// ```
/// ```compile_fail
/// # use umbra_physics::fx;
/// let suffixed = fx!(1.5f64);
/// ```
#[macro_export]
macro_rules! fx {
    // A minus sign by itself: a fragment that begins with one and is no literal would end in an error of the parser.
    (-$number:literal) => {
        const { $crate::Fx::from_literal(::core::concat!("-", ::core::stringify!($number))) }
    };
    (-$num:literal / $den:literal) => {
        const { $crate::Fx::from_literals(::core::concat!("-", ::core::stringify!($num)), ::core::stringify!($den)) }
    };
    (-$($other:tt)*) => {
        $crate::fx!(@)
    };
    ($number:literal) => {
        const { $crate::Fx::from_literal(::core::stringify!($number)) }
    };
    ($num:literal / $den:literal) => {
        const { $crate::Fx::from_literals(::core::stringify!($num), ::core::stringify!($den)) }
    };
    ($($other:tt)*) => {
        ::core::compile_error!(
            "fx! takes a literal, as in fx!(0.5), fx!(-9.81) or fx!(1/60); values known at run time convert by \
             Fx::from(integer), Fx::from_ratio(a, b) or Fx::parse(text)"
        )
    };
}
#[cfg(any(test, feature = "selftest"))]
pub(crate) use fx;

/// A decimal number as written: where its digits are, and what they are worth.
pub(crate) struct Decimal<'t> {
    text: &'t [u8],
    pub(crate) negative: bool,
    /// The digits, with a point or `_` among them: text[start..end].
    start: usize,
    end: usize,
    /// Number of digits before the point once the exponent has moved it; may be negative or past the end.
    pub(crate) whole_digits: i64,
}

impl<'t> Decimal<'t> {
    /// Checks the grammar.
    pub(crate) const fn scan(text: &'t [u8], underscores: bool) -> Result<Self, ParseFxError> {
        if text.is_empty() {
            return Err(ParseFxError::Empty);
        }
        let negative = text[0] == b'-';
        let start = (negative || text[0] == b'+') as usize;
        let (mut at, mut digits, mut point) = (start, 0, None);
        while at < text.len() {
            match text[at] {
                b'0'..=b'9' => digits += 1,
                b'.' if point.is_none() => point = Some(digits),
                b'_' if underscores && digits > 0 => {}
                _ => break,
            }
            at += 1;
        }
        if digits == 0 {
            return Err(ParseFxError::InvalidDigit { position: at });
        }
        let end = at;
        let exponent = if at < text.len() && (text[at] == b'e' || text[at] == b'E') {
            match scan_exponent(text, at + 1) {
                Ok((exponent, after)) => {
                    at = after;
                    exponent
                }
                Err(error) => return Err(error),
            }
        } else {
            0
        };
        if at < text.len() {
            return Err(ParseFxError::InvalidDigit { position: at });
        }
        let written: i64 = match point {
            Some(before) => before,
            None => digits,
        };
        Ok(Self { text, negative, start, end, whole_digits: written.saturating_add(exponent) })
    }

    /// The digits in order, the zeros in front included.
    pub(crate) fn digits(&self) -> impl Iterator<Item = u8> {
        self.text[self.start..self.end].iter().filter(|byte| byte.is_ascii_digit()).map(|byte| byte - b'0')
    }

    /// Rounds to a multiple of 2^-32, to nearest, ties to even.
    const fn round(&self) -> Result<Fx, ParseFxError> {
        /// No tie needs more digits after the point: it is an odd multiple of 2^-33.
        const FRACTION_DIGITS: u32 = 33;
        /// More than any value that fits; times ten and a digit more, it still fits 64 bits.
        const TOO_LARGE: u64 = 1 << 32;

        let (mut whole, mut fraction, mut beyond) = (0u64, 0u128, false);
        // Zeros between the point and the first digit count as fraction digits that were read.
        let mut read = if self.whole_digits < 0 { self.whole_digits.unsigned_abs() } else { 0 };
        let mut digits_left = self.whole_digits;
        let mut at = self.start;
        while at < self.end {
            let byte = self.text[at];
            at += 1;
            if !byte.is_ascii_digit() {
                continue;
            }
            let digit = byte - b'0';
            if digits_left > 0 {
                digits_left -= 1;
                whole = if whole >= TOO_LARGE { TOO_LARGE } else { whole * 10 + digit as u64 };
            } else if read < FRACTION_DIGITS as u64 {
                read += 1;
                fraction = fraction * 10 + digit as u128;
            } else {
                beyond |= digit != 0;
            }
        }
        // The exponent's zeros: at most ten of them, from 1 to past the range.
        while digits_left > 0 && whole != 0 && whole < TOO_LARGE {
            digits_left -= 1;
            whole *= 10;
        }
        // The fraction is below 10^33, and less by the digits that were not written.
        while read < FRACTION_DIGITS as u64 {
            read += 1;
            fraction *= 10;
        }
        // fraction·10^-33·2^33 = fraction / 5^33: the bits of the result and the one below, exactly.
        const SCALE: u128 = 5u128.pow(FRACTION_DIGITS);
        let bits_and_half = (fraction / SCALE) as u64;
        let above_half = beyond || fraction % SCALE != 0;
        let floor = bits_and_half >> 1;
        let up = bits_and_half & 1 == 1 && (above_half || floor & 1 == 1);
        // whole < 11·2^32 here: less than 2^68.
        let magnitude = ((whole as i128) << 32) + floor as i128 + up as i128;
        match Fx::narrow(if self.negative { -magnitude } else { magnitude }) {
            Some(value) => Ok(value),
            None => Err(ParseFxError::OutOfRange),
        }
    }
}

/// The exponent from `at` on, and where it ends. An exponent beyond ±2^60 is cut off: no text has enough digits to make up for it.
const fn scan_exponent(text: &[u8], mut at: usize) -> Result<(i64, usize), ParseFxError> {
    const FAR: i64 = 1 << 60;

    let negative = at < text.len() && text[at] == b'-';
    if negative || (at < text.len() && text[at] == b'+') {
        at += 1;
    }
    let first = at;
    let mut exponent = 0;
    while at < text.len() && text[at].is_ascii_digit() {
        exponent = if exponent >= FAR / 10 { FAR } else { exponent * 10 + (text[at] - b'0') as i64 };
        at += 1;
    }
    if at == first {
        return Err(ParseFxError::InvalidDigit { position: at });
    }
    Ok((if negative { -exponent } else { exponent }, at))
}

impl fmt::Display for Fx {
    /// The exact decimal value, with as many digits as it takes (at most 32 after the point); with a precision, rounded
    /// to that many digits, ties to even. Width, fill, sign and zero flags as for `f64`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.to_bits().unsigned_abs();
        decimal::write(f, self.to_bits() < 0, magnitude >> 32, u128::from(magnitude) << 96)
    }
}

impl fmt::Debug for Fx {
    /// Writes the number as [`Display`](fmt::Display) does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
