//! Serde of `Fx`: exact decimal text in readable formats, bits in binary ones.

use core::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde::ser::{Serialize, Serializer};

use super::Fx;

impl Serialize for Fx {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.collect_str(self)
        } else {
            serializer.serialize_i64(self.to_bits())
        }
    }
}

impl<'de> Deserialize<'de> for Fx {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(Text)
        } else {
            i64::deserialize(deserializer).map(Self::from_bits)
        }
    }
}

/// Takes text, or an integer. A number with a fraction has been through a float by the time it comes here: refused.
struct Text;

impl Visitor<'_> for Text {
    type Value = Fx;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a decimal number as a string, or an integer from -2147483648 to 2147483647")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Fx, E> {
        Fx::parse(text).map_err(E::custom)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Fx, E> {
        i32::try_from(value)
            .map(Fx::from_int)
            .map_err(|_| E::invalid_value(serde::de::Unexpected::Signed(value), &self))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Fx, E> {
        i32::try_from(value)
            .map(Fx::from_int)
            .map_err(|_| E::invalid_value(serde::de::Unexpected::Unsigned(value), &self))
    }
}
