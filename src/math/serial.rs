//! Serde of times and generators. The integers of a time are text in readable formats: few readers take 128 bits from a number.

use alloc::string::String;

use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, SerializeStruct as _, Serializer};

use super::random::Random;
use super::time::{Elapsed, gcd};

#[derive(serde::Deserialize)]
#[serde(rename = "Elapsed", deny_unknown_fields)]
struct Ratio<T> {
    num: T,
    den: T,
}

impl Serialize for Elapsed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let readable = serializer.is_human_readable();
        let mut ratio = serializer.serialize_struct("Elapsed", 2)?;
        for (name, part) in [("num", self.num), ("den", self.den)] {
            if readable {
                ratio.serialize_field(name, &format_args!("{part}"))?;
            } else {
                ratio.serialize_field(name, &part)?;
            }
        }
        ratio.end()
    }
}

impl<'de> Deserialize<'de> for Elapsed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (num, den) = if deserializer.is_human_readable() {
            let Ratio { num, den } = Ratio::<String>::deserialize(deserializer)?;
            (num.parse().map_err(D::Error::custom)?, den.parse().map_err(D::Error::custom)?)
        } else {
            let Ratio { num, den } = Ratio::<u128>::deserialize(deserializer)?;
            (num, den)
        };
        if den == 0 || gcd(num, den) != 1 {
            return Err(D::Error::custom("a time is a ratio in lowest terms"));
        }
        Ok(Self { num, den })
    }
}

/// A generator as it is written.
#[derive(serde::Deserialize)]
#[serde(rename = "Random", deny_unknown_fields)]
pub(super) struct State {
    state: [u64; 4],
}

impl TryFrom<State> for Random {
    type Error = &'static str;

    fn try_from(State { state }: State) -> Result<Self, Self::Error> {
        Self::from_state(state).ok_or("a generator in the state 0 never moves")
    }
}
