//! Fixed point as decimal text, exactly.

use alloc::string::String;
use core::{fmt, iter, str};

/// The most digits after the point: a multiple of 2^-96 has no more.
const DIGITS: usize = 96;
/// The most digits before the point: 2^64 has 20.
const WHOLE: usize = 20;

/// Writes a number of this sign and magnitude `whole + fraction / 2^128`, all digits of it; with a precision, that many, rounded
/// to nearest, ties to even. Signs, widths and zeros behind the last digit are those of `f64`.
///
/// *Domain* the fraction is a multiple of 2^-96, whole < 2^64 − 1.
pub(crate) fn write(f: &mut fmt::Formatter<'_>, negative: bool, whole: u64, fraction: u128) -> fmt::Result {
    let mut text = [b'0'; WHOLE + 1 + DIGITS];
    let (mut whole, mut fraction) = (whole, fraction);
    let wanted = f.precision().unwrap_or(DIGITS).min(DIGITS);
    let mut count = 0;
    while count < wanted && (fraction != 0 || f.precision().is_some()) {
        // Ten times a fraction below 2^128: the digit is what is above.
        let low = (fraction as u64) as u128 * 10;
        let high = (fraction >> 64) * 10 + (low >> 64);
        text[WHOLE + 1 + count] = b'0' + (high >> 64) as u8;
        fraction = high << 64 | (low as u64) as u128;
        count += 1;
    }
    let last = if count == 0 { whole as u8 } else { text[WHOLE + count] };
    if fraction > 1 << 127 || (fraction == 1 << 127 && last % 2 == 1) {
        let digits = &mut text[WHOLE + 1..][..count];
        let nines = digits.iter().rev().take_while(|&&digit| digit == b'9').count();
        digits[count - nines..].fill(b'0');
        match digits[..count - nines].last_mut() {
            Some(digit) => *digit += 1,
            None => whole += 1,
        }
    }
    text[WHOLE] = b'.';
    let mut start = WHOLE;
    while whole != 0 || start == WHOLE {
        start -= 1;
        text[start] = b'0' + (whole % 10) as u8;
        whole /= 10;
    }
    let end = if count == 0 { WHOLE } else { WHOLE + 1 + count };
    let text = str::from_utf8(&text[start..end]).unwrap_or_default();
    match f.precision() {
        // More digits than any number has.
        Some(precision @ DIGITS..) => {
            let zeros = iter::repeat_n('0', precision - DIGITS);
            f.pad_integral(!negative, "", &text.chars().chain(zeros).collect::<String>())
        }
        _ => f.pad_integral(!negative, "", text),
    }
}
