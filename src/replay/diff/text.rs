//! Numbers in which two states differ, as text: as many digits as show the difference, and the difference itself.

use alloc::format;
use alloc::string::String;
use core::fmt;

use crate::fx::decimal;

/// Differences of fewer ulps than this are given in ulps as well.
const ULPS: u64 = 1_000_000;

/// The least number of digits after the point, if there are so many.
const FEWEST: usize = 3;

/// A number of this sign and magnitude `whole + fraction / 2^128`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Number {
    negative: bool,
    whole: u64,
    fraction: u128,
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        decimal::write(f, self.negative, self.whole, self.fraction)
    }
}

impl Number {
    /// The number that an exact decimal is; `None` for any other text, and for one beyond ±2^63.
    fn parse(text: &str) -> Option<Self> {
        let (negative, digits) = text.strip_prefix('-').map_or((false, text), |digits| (true, digits));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let is_decimal = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_digit());
        if whole.is_empty() || !is_decimal(whole) || !is_decimal(fraction) {
            return None;
        }
        let whole = whole.parse().ok().filter(|whole| *whole < 1 << 63)?;
        let mut digits: alloc::vec::Vec<u8> = fraction.bytes().map(|digit| digit - b'0').collect();
        let mut bits = 0u128;
        for _ in 0..128 {
            // Twice the decimal fraction: its whole part is the next bit.
            let mut carry = 0;
            for digit in digits.iter_mut().rev() {
                let doubled = 2 * *digit + carry;
                (*digit, carry) = (doubled % 10, doubled / 10);
            }
            bits = bits << 1 | u128::from(carry);
        }
        digits.iter().all(|digit| *digit == 0).then_some(Self { negative, whole, fraction: bits })
    }

    /// |self − other|, which fits: both are below 2^63.
    fn distance(self, rhs: Self) -> Self {
        let (large, small) =
            if (self.whole, self.fraction) < (rhs.whole, rhs.fraction) { (rhs, self) } else { (self, rhs) };
        let (whole, fraction) = if self.negative == rhs.negative {
            let (fraction, borrow) = large.fraction.overflowing_sub(small.fraction);
            (large.whole - small.whole - u64::from(borrow), fraction)
        } else {
            let (fraction, carry) = large.fraction.overflowing_add(small.fraction);
            (large.whole + small.whole + u64::from(carry), fraction)
        };
        Self { negative: false, whole, fraction }
    }

    /// The place after the point of the first digit that is not 0; 0 from 1 on.
    fn first_place(self) -> usize {
        let text = format!("{self}");
        let fraction = text.split_once('.').map_or("", |(_, fraction)| fraction);
        if self.whole > 0 { 0 } else { fraction.bytes().take_while(|digit| *digit == b'0').count() + 1 }
    }

    /// Two digits of it, or all before the point.
    fn short(self) -> String {
        let place = self.first_place();
        let text = match self.whole {
            100.. => return format!("{self:.0}"),
            _ => format!("{self:.0$}", place + 1),
        };
        let fraction = text.split_once('.').map_or("", |(_, fraction)| fraction);
        let zeros = fraction.bytes().take_while(|digit| *digit == b'0').count();
        match fraction.get(zeros..) {
            Some(digits) if self.whole == 0 && zeros > 2 && !digits.is_empty() => {
                let second = digits.get(1..2).filter(|digit| *digit != "0");
                let second = second.map_or_else(String::new, |digit| format!(".{digit}"));
                format!("{}{second}e-{}", &digits[..1], zeros + 1)
            }
            _ => text.trim_end_matches('0').trim_end_matches('.').into(),
        }
    }

    /// The number times 2^32, if it is below [`ULPS`].
    fn ulps(self) -> Option<Self> {
        let whole = self.whole.checked_mul(1 << 32)? + (self.fraction >> 96) as u64;
        (whole < ULPS).then_some(Self { whole, fraction: self.fraction << 32, ..self })
    }
}

/// Two values of a field as `left and right unit (differ by …)`, with all digits or as many as show the difference. Values that are no
/// numbers with a unit, such as a hash, are written as they are.
pub(super) fn write(f: &mut fmt::Formatter<'_>, field: &str, left: &str, right: &str, exact: bool) -> fmt::Result {
    if field.ends_with("_damping") && (left.starts_with('-') || right.starts_with('-')) {
        return write!(f, "{} and {}", damping(left), damping(right));
    }
    let numbers = unit(field).zip(Number::parse(left).zip(Number::parse(right)));
    let Some((unit, (a, b))) = numbers.filter(|(_, (a, b))| a != b) else {
        return write!(f, "{left} and {right}");
    };
    let distance = a.distance(b);
    let places = (distance.first_place() + 1).max(FEWEST);
    let shown = |text: &str, number: Number| {
        let digits = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
        if exact || digits <= places { text.into() } else { format!("{number:.places$}") }
    };
    write!(f, "{} and {}{unit} (differ by ", shown(left, a), shown(right, b))?;
    // An angle of a state is a fraction of a turn, in other steps.
    if let Some(ulps) = distance.ulps().filter(|_| unit != TURNS) {
        write!(f, "{} ulp, ", ulps.short())?;
    }
    let short = distance.short();
    let unit = if unit == TURNS && short == "1" { " turn" } else { unit };
    write!(f, "{short}{unit})")
}

/// A damping as text: below 0 its number is minus a rate.
fn damping(number: &str) -> String {
    number.strip_prefix('-').map_or_else(|| number.into(), |rate| format!("{rate}/s"))
}

const TURNS: &str = " turns";

/// The unit of a field, after a space; empty for a number without one. `None` for what is no quantity.
fn unit(field: &str) -> Option<&'static str> {
    let is_component = field.ends_with(".x") || field.ends_with(".y");
    let path = if is_component { &field[..field.len() - 2] } else { field };
    let name = path.rsplit('.').next().unwrap_or_default();
    let name = name.split('[').next().unwrap_or_default();
    Some(match name {
        "position" | "point" | "centre" | "min" | "max" | "corners" | "a" | "b" | "radius" | "width" | "height"
        | "length" | "rest" | "softening" => " m",
        "velocity" if is_component => " m/s",
        "wind" | "max_speed" => " m/s",
        "velocity" | "angular_velocity" | "max_angular_speed" => " rad/s",
        "gravity" | "acceleration" => " m/s²",
        "linear" if is_component => " m/s²",
        "angular" if path.ends_with("last_acceleration.angular") => " rad/s²",
        "angle" if field == "angle" || field.ends_with("goal.angle") => TURNS,
        "angle" => " rad",
        "force" => " N",
        "impulse" if is_component => " N·s",
        "torque" => " N·m",
        "impulse" => " N·m·s",
        "mass" => " kg",
        "inertia" => " kg·m²",
        "stiffness" => " N/m",
        "mu" => " m³/s²",
        "density" | "gravity_scale" | "scale" | "linear_damping" | "angular_damping" | "damping" | "linear"
        | "angular" | "quadratic" => "",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString as _;

    use super::*;

    fn said(field: &str, left: &str, right: &str, exact: bool) -> String {
        struct Said<'a>(&'a str, &'a str, &'a str, bool);
        impl fmt::Display for Said<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write(f, self.0, self.1, self.2, self.3)
            }
        }
        Said(field, left, right, exact).to_string()
    }

    #[test]
    fn values_are_shown_with_enough_digits_to_differ() {
        let first = "47.489193077948099626087907429704257946731928269652072728546077229339061887003481388092041015625";
        let second =
            "47.489193078157647202480210041208484806319913840503061015253793986090613543638028204441070556640625";
        let ulp = "0.00000000023283064365386962890625";
        for (field, left, right, expected) in [
            ("position.x", first, second, "47.48919307795 and 47.48919307816 m (differ by 0.9 ulp, 2.1e-10 m)"),
            ("velocity.y", "0", ulp, "0 and 0.00000000023 m/s (differ by 1 ulp, 2.3e-10 m/s)"),
            ("velocity.y", ulp, "-1", "0.000 and -1 m/s (differ by 1 m/s)"),
            ("angular_velocity", "-0.5", "0.5", "-0.5 and 0.5 rad/s (differ by 1 rad/s)"),
            ("mass", "3", "1000000", "3 and 1000000 kg (differ by 999997 kg)"),
            ("gravity_scale", "1", "1.0009765625", "1 and 1.00098 (differ by 9.8e-4)"),
            ("linear_damping", "0.5", "0.75", "0.5 and 0.75 (differ by 0.25)"),
            ("linear_damping", "0.5", "-30.5", "0.5 and 30.5/s"),
            ("angular_damping", "-30", "nothing", "30/s and nothing"),
            ("angle", "0.25", "0.2500000000000000000542101086242752217003726400434970855712890625", {
                "0.25 and 0.250000000000000000054 turns (differ by 5.4e-20 turns)"
            }),
            ("calls[0].action.goal.angle", "0.25", "1.25", "0.25 and 1.25 turns (differ by 1 turn)"),
            ("calls[0].action.impulse.x", "3", "3.125", "3 and 3.125 N·s (differ by 0.12 N·s)"),
            ("user_data", "7", "8", "7 and 8"),
            ("hash", "00ff", "0100", "00ff and 0100"),
            ("mass", "nothing", "1", "nothing and 1"),
        ] {
            assert_eq!(said(field, left, right, false), expected);
        }
        let exact = said("position.x", first, second, true);
        assert_eq!(exact, format!("{first} and {second} m (differ by 0.9 ulp, 2.1e-10 m)"));
    }

    #[test]
    fn numbers_are_read_exactly() {
        for text in ["0", "1", "-0.5", "12.000000000232830643653869628906250000", "9223372036854775807.25"] {
            let trimmed = if text.contains('.') { text.trim_end_matches('0') } else { text };
            assert_eq!(Number::parse(text).map(|number| number.to_string()).as_deref(), Some(trimmed));
        }
        for text in ["", "-", ".5", "0.1", "1e3", "9223372036854775808", "x", "1.2.3"] {
            assert_eq!(Number::parse(text), None, "{text}");
        }
    }

    #[test]
    fn short_numbers_have_two_digits() {
        let number = |whole, fraction| Number { negative: false, whole, fraction };
        for (number, expected) in [
            (number(0, 1 << 127), "0.5"),
            (number(0, 1 << 120), "0.0039"),
            (number(0, 1 << 114), "6.1e-5"),
            (number(0, u128::MAX / 10_000 * 10), "0.001"),
            (number(0, u128::MAX / 10_000), "1e-4"),
            (number(0, u128::MAX), "1"),
            (number(99, u128::MAX), "100"),
            (number(1_234, 0), "1234"),
            (number(12, 1 << 127), "12.5"),
        ] {
            assert_eq!(number.short(), expected);
        }
    }
}
