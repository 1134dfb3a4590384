//! Repetitions: one object that stands for many, and the numbers and names that differ in them.

use alloc::format;
use alloc::string::{String, ToString};
use core::fmt;

use super::error::{Coded, Flaw, Refused};
use super::node::{Kind, Node, Result, in_a_line};
use super::object::Object;
use umbra_physics::{Fx, ParseFxError};

/// The indices of a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Round {
    i: i64,
    j: i64,
    /// Counted from 0 over both.
    n: u64,
    planar: bool,
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.planar { write!(f, "(i={}, j={})", self.i, self.j) } else { write!(f, "(i={})", self.i) }
    }
}

impl Round {
    /// A text with the indices put in.
    pub(super) fn fill(&self, text: &str) -> core::result::Result<String, String> {
        let mut filled = String::with_capacity(text.len() + 8);
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            let (inside, after) = after.split_once('}').ok_or_else(|| "there is a `{` without a `}`".to_string())?;
            filled.push_str(before);
            filled.push_str(&self.index(inside).ok_or_else(|| {
                format!("expected an index such as {{i}}, {{j}}, {{n}} or {{i+1}}, found {{{}}}", in_a_line(inside))
            })?);
            rest = after;
        }
        filled.push_str(rest);
        Ok(filled)
    }

    fn index(&self, text: &str) -> Option<String> {
        let mut letters = text.chars();
        let base = match letters.next()? {
            'i' => self.i,
            'j' => self.j,
            'n' => i64::try_from(self.n).ok()?,
            _ => return None,
        };
        let shift = letters.as_str();
        if shift.is_empty() {
            return Some(base.to_string());
        }
        if !shift.starts_with(['+', '-']) {
            return None;
        }
        Some(base.checked_add(shift.parse().ok()?)?.to_string())
    }
}

/// The number of bytes allowed for each thing a scene may have, if all repetitions were written out.
const BYTES_EACH: u64 = 512;

/// Reads a list of at most so many things, in which an object with the field `repeat` stands for many. Where one of these is refused,
/// the others are not read: they would be refused alike.
pub(super) fn each<'a>(list: &Node<'a>, limit: u64, mut read: impl FnMut(&Object<'a>) -> Result<()>) -> Result<()> {
    let (mut entries, mut bytes) = (0u64, 0u64);
    list.each(|node| {
        entries = entries.saturating_add(1);
        check_count(&node, entries, limit)?;
        let object = node.object()?;
        let Some(repeat) = object.get("repeat") else { return read(&object) };
        let counts = repeat.object()?;
        let (i, j, planar) = (counts.need("i", range), counts.or("j", (0, 0), range), counts.has("j"));
        counts.finish()?;
        let i = i?;
        // Each range has at most 2^32 in it.
        let count = |(first, last): (i64, i64)| last.abs_diff(first) + 1;
        let rounds = count(i).saturating_mul(count(j));
        entries = entries.saturating_add(rounds - 1);
        check_count(repeat, entries, limit)?;
        bytes = bytes.saturating_add(rounds.saturating_mul(node.raw().len() as u64));
        if bytes > limit.saturating_mul(BYTES_EACH) {
            let max_bytes = limit.saturating_mul(BYTES_EACH);
            return Err(repeat
                .fault(
                    Flaw::TooMany
                        .of(format_args!("out of range: written out, this would be more than {max_bytes} bytes")),
                )
                .ending_list());
        }
        let mut n = 0;
        for j in j.0..=j.1 {
            for i in i.0..=i.1 {
                let object = node.in_round(Round { i, j, n, planar }).object()?;
                object.get("repeat");
                read(&object)?;
                n += 1;
            }
        }
        Ok(())
    })
}

/// Refuses where there are more than may be.
pub(super) fn check_count(node: &Node<'_>, count: u64, limit: u64) -> Result<()> {
    if count <= limit {
        return Ok(());
    }
    let refused = node.fault(Flaw::TooMany.of(format_args!("out of range: at most {limit} can be made")));
    Err(refused.ending_list())
}

/// A count n for 0 to n − 1, or [first, last].
fn range(node: &Node<'_>) -> Result<(i64, i64)> {
    let (first, last) = if node.kind() == Kind::List {
        let [first, last] = node.tuple()?.map(|index: Node<'_>| index.whole::<i32>());
        (first?.into(), last?.into())
    } else {
        (0, i64::from(node.whole::<i32>()?) - 1)
    };
    if last < first {
        return Err(node.fault(
            Flaw::OutOfRange.of("out of range: expected a count from 1, or a list of the first and the last index"),
        ));
    }
    Ok((first, last))
}

/// mantissa · 10^exponent.
#[derive(Clone, Copy)]
struct Exact {
    mantissa: i128,
    exponent: i32,
}

impl Exact {
    /// The number a JSON text is, if it is short enough to be added up.
    fn parse(text: &str) -> Option<Self> {
        let (digits, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let power: i32 = power.parse().ok().filter(|p| (-30..=30).contains(p))?;
        let mantissa = format!("{whole}{fraction}").parse().ok()?;
        Some(Self { mantissa, exponent: power - i32::try_from(fraction.len()).ok()? })
    }

    fn times(self, factor: i64) -> Option<Self> {
        Some(Self { mantissa: self.mantissa.checked_mul(factor.into())?, ..self })
    }

    fn plus(self, rhs: Self) -> Option<Self> {
        let exponent = self.exponent.min(rhs.exponent);
        let aligned = |number: Self| {
            let up = number.exponent.abs_diff(exponent);
            number.mantissa.checked_mul(10i128.checked_pow(up)?)
        };
        Some(Self { mantissa: aligned(self)?.checked_add(aligned(rhs)?)?, exponent })
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): the n-th number from a seed, without a state.
const fn split_mix(seed: u64, n: u64) -> u64 {
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut z = seed.wrapping_add(STEP.wrapping_mul(n.wrapping_add(1)));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Node<'_> {
    /// A number: its text rounded once, or what its repetition makes of it.
    pub(super) fn number(&self) -> Result<Fx> {
        match (self.kind(), self.round) {
            (Kind::Number, _) => Fx::parse(self.raw()).map_err(|error| self.unread(error)),
            (Kind::Object, Some(round)) => self.made(round),
            _ => Err(self.wrong_kind("a number")),
        }
    }

    /// A whole number that fits in `T`.
    pub(super) fn whole<T: TryFrom<i128>>(&self) -> Result<T> {
        let exact = match (self.kind(), self.round) {
            (Kind::Number, _) => Exact::parse(self.raw()),
            (Kind::Object, Some(round)) => Some(self.progression(&self.object()?, round)?),
            _ => return Err(self.wrong_kind("a whole number")),
        };
        let whole = exact.and_then(|Exact { mantissa, exponent }| {
            let unit = 10i128.checked_pow(exponent.unsigned_abs())?;
            match exponent {
                0.. => mantissa.checked_mul(unit),
                _ => (mantissa % unit == 0).then_some(mantissa / unit),
            }
        });
        let fitting = whole.and_then(|whole| T::try_from(whole).ok());
        fitting.ok_or_else(|| {
            let bits = 8 * size_of::<T>();
            self.fault(
                Flaw::OutOfRange.of(format_args!("out of range: expected a whole number that fits in {bits} bits")),
            )
        })
    }

    pub(super) fn unread(&self, error: ParseFxError) -> Refused {
        match error {
            ParseFxError::OutOfRange => {
                self.fault(Coded(error.code(), "out of range: expected a number from -2^31 to below 2^31"))
            }
            _ => self.fault(error),
        }
    }

    /// start + i·a + j·b, added up exactly and rounded once; or a random number.
    fn made(&self, round: Round) -> Result<Fx> {
        let object = self.object()?;
        if let Some(bounds) = object.get("random") {
            let seed = object.need("seed", Node::whole::<u64>);
            object.finish()?;
            let (seed, [min, max]) = (seed?, bounds.tuple()?.map(|bound: Node<'_>| bound.number()));
            let (min, max) = (min?, max?);
            if min > max {
                return Err(bounds.fault(Flaw::OutOfRange.of("out of range: the first is larger than the second")));
            }
            // least + ⌊(most − least + 1 ulp)·random / 2^64⌋; at most 2^64 ulps times below 2^64 fits in 128 bits.
            let ulps = (i128::from(max.to_bits()) - i128::from(min.to_bits())) as u128 + 1;
            let random = u128::from(split_mix(seed, round.n));
            let above = (ulps * random) >> 64;
            return Ok(Fx::from_bits((i128::from(min.to_bits()) + above as i128) as i64));
        }
        let Exact { mantissa, exponent } = self.progression(&object, round)?;
        Fx::parse(&format!("{mantissa}e{exponent}")).map_err(|error| self.unread(error))
    }

    fn progression(&self, object: &Object<'_>, round: Round) -> Result<Exact> {
        const ZERO: Exact = Exact { mantissa: 0, exponent: 0 };
        let long =
            |node: &Node<'_>| node.fault(Flaw::OutOfRange.of("out of range: too many digits for an exact progression"));
        let term = |name| {
            object.or(name, ZERO, |node| {
                if node.kind() != Kind::Number {
                    return Err(node.wrong_kind("a number"));
                }
                Exact::parse(node.raw()).ok_or_else(|| long(node))
            })
        };
        let (start, by_i, by_j) = (term("start"), term("i"), term("j"));
        object.finish()?;
        let sum = || start.plus(by_i.times(round.i)?)?.plus(by_j.times(round.j)?);
        sum().ok_or_else(|| long(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::Source;

    #[test]
    fn the_generator_is_the_published_one() {
        // The first outputs of SplitMix64 for the seed 1234567, as published with its reference implementation.
        let first: [u64; 3] = core::array::from_fn(|n| split_mix(1_234_567, n as u64));
        assert_eq!(first, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn progressions_are_added_up_in_decimals() {
        let round = Round { i: 3, j: -2, n: 0, planar: true };
        let text = r#"{"start": 0.1, "i": 0.1, "j": 1e-1}"#;
        let source = Source::new(text);
        let node = Node::document(&source).map(|node| node.in_round(round));
        // 0.1 + 0.3 − 0.2; the sum of rounded tenths would be an ulp beside.
        assert_eq!(node.and_then(|node| node.number()), Ok(Fx::from_ratio(1, 5)));
    }

    #[test]
    fn names_take_their_indices() {
        let round = Round { i: 3, j: -2, n: 7, planar: true };
        assert_eq!(round.fill("a-{i}-{j+1}-{n}-{i-4}").as_deref(), Ok("a-3--1-7--1"));
        for text in ["{", "{}", "{k}", "{i+}", "{i9}", "{i+99999999999999999999}"] {
            assert!(round.fill(text).is_err(), "{text}");
        }
    }
}
