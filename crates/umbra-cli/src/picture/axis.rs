//! The marks of an axis.

/// Values of an axis to mark, with their labels: multiples of 1, 2 or 5 times a power of ten that are `apart` or more from each other.
///
/// *Domain* `from` below `to`, `apart` above 0.
pub fn ticks(from: f64, to: f64, apart: f64) -> Vec<(f64, String)> {
    // By the digits of the numbers, as a logarithm is not the same on every machine.
    let digits = format!("{apart:e}");
    let (leading, power) = digits.split_once('e').unwrap_or((&digits, "0"));
    let leading: f64 = leading.parse().unwrap_or(1.0);
    let each = [1, 2, 5].into_iter().find(|&each| f64::from(each) >= leading).unwrap_or(10);
    let value = |count: i64| format!("{}e{power}", count * i64::from(each)).parse().unwrap_or(f64::NAN);
    let step: f64 = value(1);
    let counts = (from / step).ceil() as i64..=(to / step).floor() as i64;
    counts.map(value).map(|value: f64| (value, label(value))).collect()
}

/// The digits of a number with a minus sign; large ones with a power of ten.
fn label(value: f64) -> String {
    let digits = if value.abs() < 1e6 { value.to_string() } else { format!("{value:e}") };
    digits.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(from: f64, to: f64, apart: f64) -> String {
        ticks(from, to, apart).into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(0.0, 40.0, 5.0), "0 5 10 15 20 25 30 35 40");
        assert_eq!(labels(-0.31, 0.31, 0.06), "−0.3 −0.2 −0.1 0 0.1 0.2 0.3");
        assert_eq!(labels(-1.0, 60.0, 11.0), "0 20 40 60");
        assert_eq!(labels(-30.0, 170.0, 51.0), "0 100");
        assert_eq!(labels(3.01, 3.04, 0.02), "3.02 3.04");
    }

    #[test]
    fn large_values_keep_the_digits_that_part_them() {
        assert_eq!(labels(-2.6e8, 2.6e8, 1.5e8), "−2e8 0 2e8");
        assert_eq!(labels(1_073_741_822.9, 1_073_741_824.1, 0.4), "1.073741823e9 1.0737418235e9 1.073741824e9");
    }
}
