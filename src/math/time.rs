//! Time as ratios of integers.

/// The length of a step in seconds, an exact ratio: 1/60 is 1/60.
///
/// ```
/// use umbra_physics::{Elapsed, TimeStep, World, WorldDef};
///
/// let ntsc = TimeStep::ratio(1001, 60_000);
/// assert_eq!(TimeStep::ratio(2, 120).seconds(), TimeStep::hz(60).seconds());
/// let mut world = World::new(WorldDef { time_step: ntsc, ..WorldDef::default() })?;
/// assert_eq!(world.elapsed(), Elapsed::ZERO);
/// (0..60).for_each(|_| _ = world.step());
/// assert_eq!(world.elapsed(), Elapsed { num: 1001, den: 1000 }); // of a second, exactly
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "Ratio"))]
pub struct TimeStep {
    num: u32,
    den: u32,
}

/// A time step as it is written.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "TimeStep", deny_unknown_fields)]
struct Ratio {
    num: u32,
    den: u32,
}

#[cfg(feature = "serde")]
impl From<Ratio> for TimeStep {
    /// The ratio in lowest terms, so that equal steps are equal.
    fn from(Ratio { num, den }: Ratio) -> Self {
        Self::ratio(num, den)
    }
}

impl TimeStep {
    /// A step of 1/rate seconds.
    #[must_use]
    pub const fn hz(rate: u32) -> Self {
        Self::ratio(1, rate)
    }

    /// A step of num/den seconds; 1001/60000 is the rate of NTSC video.
    ///
    /// A ratio outside 1 to 10,000 steps a second is refused by the world it is given to.
    #[must_use]
    pub const fn ratio(num: u32, den: u32) -> Self {
        match gcd(num as u128, den as u128) as u32 {
            0 => Self { num: 0, den: 0 },
            divisor => Self { num: num / divisor, den: den / divisor },
        }
    }

    /// (num, den) in lowest terms, in seconds.
    #[must_use]
    pub const fn seconds(self) -> (u32, u32) {
        (self.num, self.den)
    }
}

/// A time in seconds as a ratio in lowest terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Elapsed {
    /// Numerator.
    pub num: u128,
    /// Denominator.
    pub den: u128,
}

impl Elapsed {
    /// No time.
    pub const ZERO: Self = Self { num: 0, den: 1 };

    /// The ratio in lowest terms. *Domain* the denominator is not zero.
    pub(crate) fn reduced(self) -> Self {
        let divisor = gcd(self.num, self.den);
        Self { num: self.num / divisor, den: self.den / divisor }
    }

    /// This time plus `ticks` steps; `None` if the ratio does not fit.
    pub(crate) fn plus(self, ticks: u64, step: TimeStep) -> Option<Self> {
        let (num, den) = step.seconds();
        let (n, d) = (u128::from(num) * u128::from(ticks), u128::from(den));
        let common = self.den / gcd(self.den, d);
        let den = common.checked_mul(d)?;
        let num = self.num.checked_mul(den / self.den)?.checked_add(n.checked_mul(den / d)?)?;
        Some(Self { num, den }.reduced())
    }
}

pub(crate) const fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elapsed_time_stays_exact_over_steps_of_different_length() {
        let time = Elapsed::ZERO.plus(59, TimeStep::hz(60)).and_then(|t| t.plus(1, TimeStep::ratio(1001, 60_000)));
        assert_eq!(time, Some(Elapsed { num: 60_001, den: 60_000 }));
    }
}
