//! Conversion of frames of real time, of any length, to ticks.

use crate::error::Error;
use crate::math::{TimeStep, gcd};

/// A part of a tick as an exact ratio in lowest terms.
///
/// ```
/// use umbra_physics::{StepClock, TickFraction, TimeStep};
///
/// let mut step_clock = StepClock::new(TimeStep::hz(50))?;
/// assert_eq!(step_clock.remainder(), TickFraction::ZERO);
/// step_clock.frame(5_000_000);
/// assert_eq!(step_clock.remainder(), TickFraction { num: 1, den: 4 });
/// assert_eq!(TickFraction::ONE, TickFraction { num: 1, den: 1 }); // the next tick, for an interpolation: the last one
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TickFraction {
    /// Numerator.
    pub num: u128,
    /// Denominator, not zero.
    pub den: u128,
}

impl TickFraction {
    /// The tick itself.
    pub const ZERO: Self = Self { num: 0, den: 1 };
    /// The tick after it.
    pub const ONE: Self = Self { num: 1, den: 1 };

    /// *Domain* `den` is not zero.
    const fn reduced(num: u128, den: u128) -> Self {
        let divisor = gcd(num, den);
        Self { num: num / divisor, den: den / divisor }
    }
}

/// Number of ticks that a frame asks for.
///
/// ```
/// use umbra_physics::{StepsDue, StepClock, TimeStep};
///
/// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
/// // The program stood still for a second.
/// assert_eq!(step_clock.frame(1_000_000_000), StepsDue { ticks: StepClock::LIMIT, dropped: 52 });
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepsDue {
    /// The number of ticks to step.
    pub ticks: u32,
    /// The number of further ticks that the limit dropped: the game stays behind real time by these.
    pub dropped: u128,
}

/// Computes how many ticks to step in each frame: a fixed time step under frames of any length, with an exact accumulator for
/// the remainder.
///
/// The clock belongs to the caller and is not part of the world: it is in no hash, and it may differ from peer to peer. Time goes
/// in as whole nanoseconds and comes out as whole ticks and an exact [remainder](Self::remainder). Nothing is rounded, so
/// nothing drifts: after any frames, the number of ticks, dropped ones included, is ⌊total time · speed / time step⌋.
///
/// A game whose ticks take longer to compute than they last would ask for more of them in every frame. The
/// [limit](Self::set_limit) ends that spiral: it drops whole ticks, so that the remainder continues evenly.
///
/// ```
/// use umbra_physics::{StepClock, TickFraction, TimeStep};
///
/// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
/// // A display of 144 Hz, as its clock has it.
/// let ticks: Vec<u32> = [6_944_444; 6].map(|nanoseconds| step_clock.frame(nanoseconds).ticks).to_vec();
/// assert_eq!(ticks, [0, 0, 1, 0, 1, 0]);
/// // 6 · 6,944,444 ns · 60 Hz = 2.49999984 ticks.
/// assert_eq!(step_clock.remainder(), TickFraction { num: 3_124_999, den: 6_250_000 });
///
/// step_clock.set_speed(1, 4)?; // slow motion
/// assert_eq!(step_clock.frame(1_000_000_000).ticks, 8); // 15 ticks and a half, but the limit is eight
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepClock {
    time_step: TimeStep,
    /// Numerator and denominator as given.
    speed: (u32, u32),
    is_paused: bool,
    limit: u32,
    /// Time not stepped yet (`rest`), and the time that a nanosecond adds to it (`gain`), both in units of 1/`den` tick.
    ///
    /// u64::MAX nanoseconds on top of the rest, or of a whole tick, fit: see [`paced`].
    rest: u128,
    gain: u128,
    den: u128,
}

const NANOSECONDS: u128 = 1_000_000_000;

/// Computes (rest, gain, den) of a clock at a speed of `num` / `den` with `rest` ticks not stepped yet; `None` if they do not fit.
///
/// They always fit without a rest: with steps of n/d s at a speed of p/q a nanosecond is p·d / (10⁹·q·n) ticks, in which
/// p·d <= (2^32 − 1)² and 10⁹·q·n < 2^94, and (2^64 − 1)·(2^32 − 1)² + 2^94 < 2^128.
fn paced(rest: TickFraction, time_step: TimeStep, num: u32, den: u32) -> Option<(u128, u128, u128)> {
    let (n, d) = time_step.seconds();
    let per_nanosecond =
        TickFraction::reduced(u128::from(num) * u128::from(d), NANOSECONDS * u128::from(den) * u128::from(n));
    let finer = per_nanosecond.den / gcd(rest.den, per_nanosecond.den);
    let den = rest.den.checked_mul(finer)?;
    let rest = rest.num.checked_mul(finer)?;
    let gain = per_nanosecond.num.checked_mul(den / per_nanosecond.den)?;
    u128::from(u64::MAX).checked_mul(gain)?.checked_add(rest.max(den))?;
    Some((rest, gain, den))
}

impl StepClock {
    /// The [limit](Self::set_limit) of a new clock. A display of 30 Hz at three times the speed of a world of 60 Hz asks for six
    /// ticks a frame; frames that are a third late are within the limit as well.
    pub const LIMIT: u32 = 8;

    /// A clock for a world with this time step, at normal speed, with no remainder.
    ///
    /// # Errors
    /// [`Error::TimeStep`], as for a world.
    pub fn new(time_step: TimeStep) -> Result<Self, Error> {
        let time_step = time_step.checked()?;
        let (rest, gain, den) = paced(TickFraction::ZERO, time_step, 1, 1).ok_or(Error::ElapsedTime)?;
        Ok(Self { time_step, speed: (1, 1), is_paused: false, limit: Self::LIMIT, rest, gain, den })
    }

    /// Adds the real time since the frame before, in nanoseconds, and returns how many ticks to step now.
    pub const fn frame(&mut self, nanoseconds: u64) -> StepsDue {
        if self.is_paused {
            return StepsDue { ticks: 0, dropped: 0 };
        }
        self.rest += nanoseconds as u128 * self.gain;
        let ticks = self.rest / self.den;
        self.rest %= self.den;
        // At most the limit, 32 bits.
        let due = if ticks < self.limit as u128 { ticks as u32 } else { self.limit };
        StepsDue { ticks: due, dropped: ticks - due as u128 }
    }

    /// Time since the last tick stepped, in ticks. It is below 1 after each [`frame`](Self::frame), except in a pause after a
    /// [shorter time step](Self::set_time_step) was set.
    #[must_use]
    pub const fn remainder(&self) -> TickFraction {
        TickFraction::reduced(self.rest, self.den)
    }

    /// The real time from the last frame until the next tick is due, ns: the shortest frame that asks for one. `None` while no
    /// time passes: in a pause or at a speed of zero. Use it to sleep until the next tick.
    ///
    /// ```
    /// use umbra_physics::{StepClock, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
    /// step_clock.frame(10_000_000);
    /// let wait = step_clock.until_tick(); // a sixtieth of a second is 16,666,666 ns and two thirds
    /// assert_eq!(wait, Some(6_666_667));
    /// assert_eq!(step_clock.frame(6_666_666).ticks, 0);
    /// assert_eq!(step_clock.frame(1).ticks, 1);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub const fn until_tick(&self) -> Option<u64> {
        if self.is_paused || self.gain == 0 {
            return None;
        }
        // A tick is at most a second at 1/(2^32 - 1) of the speed: 10⁹·(2^32 − 1) < 2^62 ns.
        Some(self.den.saturating_sub(self.rest).div_ceil(self.gain) as u64)
    }

    /// Changes the time step, together with that of the world, from this tick on. The remaining time stays the same; if it is
    /// more than a new tick, the next frame asks for that tick.
    ///
    /// # Errors
    /// [`Error::TimeStep`]; [`Error::ElapsedTime`] if the remainder could not stay exact. Nothing is changed then.
    ///
    /// ```
    /// use umbra_physics::{StepClock, TickFraction, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(10))?;
    /// step_clock.frame(60_000_000);
    /// assert_eq!(step_clock.remainder(), TickFraction { num: 3, den: 5 });
    /// step_clock.set_time_step(TimeStep::hz(5))?;
    /// assert_eq!((step_clock.time_step(), step_clock.remainder()), (TimeStep::hz(5), TickFraction { num: 3, den: 10 }));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_time_step(&mut self, time_step: TimeStep) -> Result<(), Error> {
        let time_step = time_step.checked()?;
        let ((n, d), (new_n, new_d)) = (self.time_step.seconds(), time_step.seconds());
        // The number of new ticks in an old one. Both products fit in 64 bits.
        let ratio = TickFraction::reduced(u128::from(n) * u128::from(new_d), u128::from(d) * u128::from(new_n));
        let TickFraction { num, den } = self.remainder();
        let (a, b) = (gcd(num, ratio.den), gcd(ratio.num, den));
        let times = |x: u128, y: u128| x.checked_mul(y).ok_or(Error::ElapsedTime);
        let rest = TickFraction { num: times(num / a, ratio.num / b)?, den: times(den / b, ratio.den / a)? };
        (self.rest, self.gain, self.den) =
            paced(rest, time_step, self.speed.0, self.speed.1).ok_or(Error::ElapsedTime)?;
        self.time_step = time_step;
        Ok(())
    }

    /// Sets the speed of time to num/den of real time from now on: 1/2 is slow motion, 2/1 fast motion, 0/1 stops time.
    ///
    /// # Errors
    /// [`Error::ElapsedTime`] for a denominator of zero, or if the remainder could not stay exact, which can happen after several
    /// speeds without a common denominator. Speeds over one denominator never fail. Nothing is changed then;
    /// [`settle`](Self::settle) drops the remainder and makes room.
    ///
    /// ```
    /// use umbra_physics::{StepClock, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
    /// step_clock.set_speed(1, 10)?;
    /// assert_eq!((step_clock.speed(), step_clock.frame(1_000_000_000).ticks), ((1, 10), 6));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_speed(&mut self, num: u32, den: u32) -> Result<(), Error> {
        if den == 0 {
            return Err(Error::ElapsedTime);
        }
        let paced = paced(self.remainder(), self.time_step, num, den).ok_or(Error::ElapsedTime)?;
        ((self.rest, self.gain, self.den), self.speed) = (paced, (num, den));
        Ok(())
    }

    /// Pauses or resumes the clock. While it is paused, frames ask for no ticks; the remainder stays, also if a new time step
    /// made it more than a tick.
    ///
    /// ```
    /// use umbra_physics::{StepClock, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
    /// step_clock.set_paused(true);
    /// assert!(step_clock.is_paused());
    /// assert_eq!(step_clock.frame(1_000_000_000).ticks, 0);
    /// step_clock.set_paused(false);
    /// assert_eq!(step_clock.frame(50_000_000).ticks, 3);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub const fn set_paused(&mut self, is_paused: bool) {
        self.is_paused = is_paused;
    }

    /// Sets the largest number of ticks a frame may ask for, at least one. Choose the number that the longest normal frame asks
    /// for at the highest speed.
    ///
    /// ```
    /// use umbra_physics::{StepsDue, StepClock, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
    /// assert_eq!(step_clock.limit(), StepClock::LIMIT);
    /// step_clock.set_limit(2);
    /// assert_eq!(step_clock.frame(50_000_000), StepsDue { ticks: 2, dropped: 1 });
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub const fn set_limit(&mut self, ticks: u32) {
        self.limit = if ticks == 0 { 1 } else { ticks };
    }

    /// Drops the remainder: the present is the last tick. Call it after loading a level, for example.
    ///
    /// ```
    /// use umbra_physics::{StepClock, TickFraction, TimeStep};
    ///
    /// let mut step_clock = StepClock::new(TimeStep::hz(60))?;
    /// step_clock.frame(10_000_000);
    /// step_clock.settle();
    /// assert_eq!(step_clock.remainder(), TickFraction::ZERO);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn settle(&mut self) {
        // Always fits without a remainder, as it did in `new`.
        if let Some(paced) = paced(TickFraction::ZERO, self.time_step, self.speed.0, self.speed.1) {
            (self.rest, self.gain, self.den) = paced;
        }
    }

    /// The time step of the clock.
    #[must_use]
    pub const fn time_step(&self) -> TimeStep {
        self.time_step
    }

    /// The speed of time as (num, den), as given.
    #[must_use]
    pub const fn speed(&self) -> (u32, u32) {
        self.speed
    }

    /// Returns true while the clock is paused.
    #[must_use]
    pub const fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// The largest number of ticks a frame may ask for.
    #[must_use]
    pub const fn limit(&self) -> u32 {
        self.limit
    }
}
