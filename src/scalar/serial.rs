//! Serde of the numbers beside `Fx`: exact decimal text in readable formats, bits in binary ones.

use alloc::borrow::Cow;
use core::fmt;

use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::number::Number;
use super::turn::Turn;
use super::wide::{FxSum, FxWide};

/// The multiple of 2^-fraction that a text is, if it is one to the last bit. *Domain* fraction <= 96.
fn parse(text: &str, fraction: u32) -> Option<i128> {
    let (negative, magnitude) = match text.strip_prefix('-') {
        Some(magnitude) => (true, magnitude),
        None => (false, text),
    };
    let (whole, digits) = magnitude.split_once('.').unwrap_or((magnitude, "0"));
    let is_number = |digits: &str| !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
    if !is_number(whole) || !is_number(digits) {
        return None;
    }
    let whole = whole.bytes().try_fold(0u128, |sum, digit| {
        sum.checked_mul(10)?.checked_add(u128::from(digit - b'0')).filter(|sum| sum >> (128 - fraction) == 0)
    })?;
    let digits = digits.trim_end_matches('0').as_bytes();
    // A multiple of 2^-fraction has as many digits at most.
    let mut decimals = [0; 96];
    let decimals = decimals.get_mut(..digits.len()).filter(|_| digits.len() <= fraction as usize)?;
    decimals.copy_from_slice(digits);
    decimals.iter_mut().for_each(|digit| *digit -= b'0');
    let mut bits = whole;
    for _ in 0..fraction {
        let mut carry = 0;
        for digit in decimals.iter_mut().rev() {
            let doubled = 2 * *digit + carry;
            (*digit, carry) = (doubled % 10, doubled / 10);
        }
        bits = bits << 1 | u128::from(carry);
    }
    if decimals.iter().any(|&digit| digit != 0) {
        return None;
    }
    if negative { 0i128.checked_sub_unsigned(bits) } else { i128::try_from(bits).ok() }
}

fn serialize<W: Serializer>(number: impl fmt::Display, bits: i128, serializer: W) -> Result<W::Ok, W::Error> {
    if serializer.is_human_readable() { serializer.collect_str(&number) } else { serializer.serialize_i128(bits) }
}

fn deserialize<'de, D: Deserializer<'de>>(deserializer: D, fraction: u32) -> Result<i128, D::Error> {
    if !deserializer.is_human_readable() {
        return i128::deserialize(deserializer);
    }
    let text = Text::deserialize(deserializer)?.0;
    let malformed =
        || D::Error::custom(format_args!("{text:?} is no decimal number that is a multiple of 2^-{fraction}"));
    parse(&text, fraction).ok_or_else(malformed)
}

/// Text, borrowed where the format can lend it.
#[derive(serde::Deserialize)]
struct Text<'t>(#[serde(borrow)] Cow<'t, str>);

impl Serialize for FxAccumulator {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        serialize(self, self.bits(), serializer)
    }
}

impl<'de> Deserialize<'de> for FxAccumulator {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserialize(deserializer, 96).map(Self::from_bits)
    }
}

impl Serialize for FxWide {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        serialize(self, self.to_bits(), serializer)
    }
}

impl<'de> Deserialize<'de> for FxWide {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserialize(deserializer, 64).map(Self::from_bits)
    }
}

/// The angle in turns, in readable formats.
impl Serialize for Turn {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        if serializer.is_human_readable() { serializer.collect_str(self) } else { serializer.serialize_u64(self.0) }
    }
}

impl<'de> Deserialize<'de> for Turn {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return u64::deserialize(deserializer).map(Self::from_bits);
        }
        let bits = deserialize(deserializer, 64)?;
        u64::try_from(bits).map(Self::from_bits).map_err(|_| D::Error::custom("an angle is from 0 to below 1 turn"))
    }
}

/// mantissa · 2^-shift: in decimals it may have thousands of digits.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "FxFactor", deny_unknown_fields)]
struct Parts {
    mantissa: u64,
    shift: i32,
}

impl Serialize for FxFactor {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        let (mantissa, shift) = self.parts();
        Parts { mantissa, shift }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FxFactor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Parts { mantissa, shift } = Parts::deserialize(deserializer)?;
        Self::from_words([i64::from(shift) as u64, mantissa]).ok_or_else(|| {
            D::Error::custom("a factor is 0 · 2^0, or has a mantissa of 64 bits and a shift from -16384 to 16384")
        })
    }
}

/// A sum in units of 2^-64, modulo 2^128, and how often it wrapped.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "FxSum", deny_unknown_fields)]
struct Carried {
    low: FxWide,
    carries: i64,
}

impl Serialize for FxSum {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        let [carries, high, low] = self.to_words();
        let low = FxWide::from_bits((i128::from(high) << 64) | i128::from(low));
        Carried { low, carries: carries as i64 }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FxSum {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Carried { low, carries } = Carried::deserialize(deserializer)?;
        let low = low.to_bits();
        Ok(Self::from_words([carries as u64, (low >> 64) as u64, low as u64]))
    }
}
