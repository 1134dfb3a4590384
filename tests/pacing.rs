//! A step clock gives real time out in ticks to the last nanosecond, whatever the frames are.

#[path = "support/cases.rs"]
mod cases;

use cases::cases;
use dashu_int::UBig;
use dashu_int::ops::Gcd as _;
use proptest::prelude::*;
use umbra_physics::{Error, StepClock, StepsDue, TickFraction, TimeStep, World, WorldDef};

/// Ratios of integers of any size, never reduced.
#[derive(Clone, Debug)]
struct Exact(UBig, UBig);

impl Exact {
    fn new(num: impl Into<UBig>, den: impl Into<UBig>) -> Self {
        Self(num.into(), den.into())
    }

    fn plus(&self, rhs: &Self) -> Self {
        Self(&self.0 * &rhs.1 + &rhs.0 * &self.1, &self.1 * &rhs.1)
    }

    fn times(&self, rhs: &Self) -> Self {
        Self(&self.0 * &rhs.0, &self.1 * &rhs.1)
    }

    fn over(&self, rhs: &Self) -> Self {
        Self(&self.0 * &rhs.1, &self.1 * &rhs.0)
    }

    fn floor(&self) -> UBig {
        &self.0 / &self.1
    }

    fn minus_whole(&self, whole: &UBig) -> Self {
        Self(&self.0 - whole * &self.1, self.1.clone())
    }

    fn minus(&self, rhs: &Self) -> Self {
        Self(&self.0 * &rhs.1 - &rhs.0 * &self.1, &self.1 * &rhs.1)
    }

    fn in_lowest_terms(&self) -> Self {
        let divisor = (&self.0).gcd(&self.1);
        Self(&self.0 / &divisor, &self.1 / &divisor)
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        &self.0 * &other.1 == &other.0 * &self.1
    }
}

fn seconds(step: TimeStep) -> Exact {
    let (num, den) = step.seconds();
    Exact::new(num, den)
}

fn of_ticks(part: TickFraction) -> Exact {
    Exact::new(part.num, part.den)
}

/// Model of a step clock by arithmetic without bounds: the time that went in, and the ticks that came out.
#[derive(Clone, Debug)]
struct Model {
    step: TimeStep,
    speed: (u32, u32),
    is_paused: bool,
    /// Simulated time, s: all of it, and that of the ticks.
    total: Exact,
    given: Exact,
}

impl Model {
    fn new(step: TimeStep) -> Self {
        let zero = Exact::new(0u8, 1u8);
        Self { step, speed: (1, 1), is_paused: false, total: zero.clone(), given: zero }
    }

    /// Ticks in a nanosecond, and ticks left over.
    fn gain(&self) -> Exact {
        Exact::new(self.speed.0, UBig::from(1_000_000_000u64) * self.speed.1).over(&seconds(self.step))
    }

    fn left(&self) -> Exact {
        self.total.minus(&self.given).over(&seconds(self.step))
    }

    fn frame(&mut self, nanoseconds: u64) -> UBig {
        if self.is_paused {
            return UBig::ZERO;
        }
        let passed = Exact::new(UBig::from(nanoseconds), 1u8).times(&self.gain()).times(&seconds(self.step));
        self.total = self.total.plus(&passed);
        let ticks = self.left().floor();
        self.given = self.given.plus(&Exact::new(ticks.clone(), 1u8).times(&seconds(self.step)));
        ticks
    }

    /// Returns true if all values a clock may have to hold fit in 128 bits: over the one denominator of the remainder and of a
    /// nanosecond, the longest frame there is on top of what is left over, or of a whole tick.
    fn fits(&self) -> bool {
        let (left, gain) = (self.left().in_lowest_terms(), self.gain().in_lowest_terms());
        let den = &left.1 / (&left.1).gcd(&gain.1) * &gain.1;
        let rest = left.0 * (&den / left.1);
        let longest = UBig::from(u64::MAX) * gain.0 * (&den / gain.1);
        longest + rest.max(den) <= UBig::from(u128::MAX)
    }

    /// Changes it, if what comes of that fits.
    fn change(&mut self, change: impl FnOnce(&mut Self)) -> Result<(), Error> {
        let mut changed = self.clone();
        change(&mut changed);
        if !changed.fits() {
            return Err(Error::ElapsedTime);
        }
        *self = changed;
        Ok(())
    }

    /// The shortest frame that asks for a tick, ns.
    fn until_tick(&self) -> Option<UBig> {
        let (left, gain) = (self.left(), self.gain());
        if self.is_paused || gain.0 == UBig::ZERO {
            return None;
        }
        if left.0 >= left.1 {
            return Some(UBig::ZERO);
        }
        let missing = Exact::new(1u8, 1u8).minus(&left).over(&gain);
        Some((missing.0 + &missing.1 - 1u8) / missing.1)
    }

    /// Asserts that the clock agrees with the model.
    fn agrees(&self, step_clock: &StepClock) -> bool {
        self.given.plus(&of_ticks(step_clock.remainder()).times(&seconds(self.step))) == self.total
            && step_clock.until_tick().map(UBig::from) == self.until_tick()
    }
}

fn all_of(due: StepsDue) -> UBig {
    UBig::from(due.ticks) + UBig::from(due.dropped)
}

/// Steps of 1 to 10,000 a second: usual ones, and any.
fn time_step() -> impl Strategy<Value = TimeStep> {
    let any = (1u32..=u32::MAX / 10_000, 1.0f64..10_000.0)
        .prop_map(|(num, rate)| TimeStep::ratio(num, ((f64::from(num) * rate) as u32).clamp(num, num * 10_000)));
    prop_oneof![Just(TimeStep::hz(60)), Just(TimeStep::hz(144)), Just(TimeStep::ratio(1001, 60_000)), any]
}

fn speed() -> impl Strategy<Value = (u32, u32)> {
    prop_oneof![(0u32..10, 1u32..10), (0u32..=100, Just(100)), (any::<u32>(), 1u32..=u32::MAX)]
}

fn frame() -> impl Strategy<Value = u64> {
    prop_oneof![4 => 0u64..40_000_000, 1 => 0u64..10, 1 => any::<u64>(), 1 => Just(16_666_667)]
}

#[derive(Clone, Debug)]
enum Act {
    Frame(u64),
    Step(TimeStep),
    Speed(u32, u32),
    Pause(bool),
    Limit(u32),
    Settle,
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        8 => frame().prop_map(Act::Frame),
        1 => time_step().prop_map(Act::Step),
        1 => speed().prop_map(|(num, den)| Act::Speed(num, den)),
        1 => any::<bool>().prop_map(Act::Pause),
        1 => prop_oneof![0u32..4, any::<u32>()].prop_map(Act::Limit),
        1 => Just(Act::Settle),
    ]
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn the_ticks_of_any_frames_are_the_floor_of_their_time(
        step in time_step(),
        (num, den) in speed(),
        limit in prop_oneof![Just(u32::MAX), 0u32..20],
        frames in prop::collection::vec(frame(), 1..60),
    ) {
        let mut step_clock = StepClock::new(step).expect("a fair step");
        step_clock.set_speed(num, den).expect("a fresh one takes any");
        step_clock.set_limit(limit);
        let (mut total, mut ticks) = (UBig::ZERO, UBig::ZERO);
        for nanoseconds in frames {
            let due = step_clock.frame(nanoseconds);
            total += nanoseconds;
            ticks += all_of(due);
            prop_assert!(due.ticks <= limit.max(1) && (due.dropped == 0 || due.ticks == limit.max(1)));
            let exact = Exact(&total * num, UBig::from(1_000_000_000u64) * den).over(&seconds(step));
            prop_assert_eq!(&ticks, &exact.floor());
            prop_assert_eq!(of_ticks(step_clock.remainder()), exact.minus_whole(&ticks));
        }
    }

    #[test]
    fn the_rest_of_a_frame_stays_exact_when_step_and_speed_change(
        step in time_step(),
        acts in prop::collection::vec(act(), 1..80),
    ) {
        let (mut step_clock, mut model) = (StepClock::new(step).expect("a fair step"), Model::new(step));
        for act in acts {
            let before = step_clock.clone();
            match act {
                Act::Frame(nanoseconds) => {
                    let (due, limit) = (step_clock.frame(nanoseconds), step_clock.limit());
                    prop_assert_eq!(all_of(due), model.frame(nanoseconds));
                    prop_assert!(due.ticks <= limit && (due.dropped == 0 || due.ticks == limit));
                    let TickFraction { num, den } = step_clock.remainder();
                    prop_assert!(num < den || model.is_paused);
                }
                Act::Step(step) => {
                    let expected = model.change(|model| model.step = step);
                    prop_assert_eq!(step_clock.set_time_step(step), expected);
                    prop_assert!(expected.is_ok() || step_clock == before);
                }
                Act::Speed(num, den) => {
                    let expected = model.change(|model| model.speed = (num, den));
                    prop_assert_eq!(step_clock.set_speed(num, den), expected);
                    prop_assert!(expected.is_ok() || step_clock == before);
                }
                Act::Pause(is_paused) => {
                    step_clock.set_paused(is_paused);
                    model.is_paused = is_paused;
                }
                Act::Limit(ticks) => {
                    step_clock.set_limit(ticks);
                    prop_assert_eq!(step_clock.limit(), ticks.max(1));
                }
                Act::Settle => {
                    step_clock.settle();
                    model.total = model.given.clone();
                }
            }
            prop_assert!(model.agrees(&step_clock));
            prop_assert_eq!((step_clock.time_step(), step_clock.speed(), step_clock.is_paused()), (model.step, model.speed, model.is_paused));
        }
    }
}

#[test]
fn the_ends_of_the_ranges_fit() {
    // The least and the most that a nanosecond can be, and the longest frame over and over. MOST has no factor in common with
    // a second of nanoseconds: nothing is reduced.
    const MOST: u32 = u32::MAX - 2;
    let longest = [TimeStep::ratio(u32::MAX - 1, u32::MAX), TimeStep::ratio(MOST - 1, MOST), TimeStep::hz(1)];
    let shortest = [TimeStep::ratio(429_497, u32::MAX), TimeStep::ratio(429_497, MOST), TimeStep::hz(10_000)];
    let speeds = [(u32::MAX, u32::MAX - 1), (u32::MAX, 1), (MOST, 1), (MOST, u32::MAX), (1, u32::MAX), (1, MOST)];
    let mut widest = UBig::ZERO;
    for step in longest.into_iter().chain(shortest) {
        for speed in speeds {
            let (mut step_clock, mut model) = (StepClock::new(step).expect("a fair step"), Model::new(step));
            step_clock.set_speed(speed.0, speed.1).expect("a fresh one takes any");
            model.speed = speed;
            widest = widest.max(model.gain().in_lowest_terms().0);
            for nanoseconds in [u64::MAX, u64::MAX, 1, u64::MAX, 0] {
                assert_eq!(all_of(step_clock.frame(nanoseconds)), model.frame(nanoseconds), "{step:?}, {speed:?}");
                assert!(model.agrees(&step_clock), "{step:?}, {speed:?}");
            }
        }
    }
    assert_eq!(widest, UBig::from(MOST) * MOST);
}

/// The accumulator as it is mostly written: of doubles.
#[test]
fn an_accumulator_of_doubles_drifts_where_the_pacer_does_not() {
    let mut step_clock = StepClock::new(TimeStep::hz(60)).expect("a fair step");
    let (mut ticks, mut naive, mut left) = (0u64, 0u64, 0.0f64);
    // Whole ticks of 50 ms, 20 a second: an hour.
    for _ in 0..72_000 {
        ticks += u64::from(step_clock.frame(50_000_000).ticks);
        left += 0.05;
        while left >= 1.0 / 60.0 {
            left -= 1.0 / 60.0;
            naive += 1;
        }
    }
    assert_eq!((ticks, step_clock.remainder()), (216_000, TickFraction::ZERO));
    assert_ne!((naive, left), (216_000, 0.0));
}

#[test]
fn a_frame_beyond_the_limit_drops_ticks_and_no_part_of_one() {
    let mut step_clock = StepClock::new(TimeStep::hz(10)).expect("a fair step");
    step_clock.set_limit(3);
    assert_eq!(step_clock.frame(550_000_000), StepsDue { ticks: 3, dropped: 2 });
    assert_eq!(step_clock.remainder(), TickFraction { num: 1, den: 2 });
    assert_eq!(step_clock.frame(50_000_000), StepsDue { ticks: 1, dropped: 0 });
    // At least one.
    step_clock.set_limit(0);
    assert_eq!(step_clock.frame(200_000_000), StepsDue { ticks: 1, dropped: 1 });
    assert_eq!(step_clock.limit(), 1);
}

#[test]
fn the_limit_of_a_new_one_holds_fast_motion_with_frames_that_are_late() {
    let mut step_clock = StepClock::new(TimeStep::hz(60)).expect("a fair step");
    step_clock.set_speed(3, 1).expect("a fresh one takes any");
    let mut largest = 0;
    for round in 0..10_000u64 {
        // On time, or by anything up to a third late.
        let due = step_clock.frame(33_333_334 + round * round * 7_919 % 11_111_111);
        assert_eq!(due.dropped, 0, "round {round}");
        largest = largest.max(due.ticks);
    }
    assert_eq!(largest, StepClock::LIMIT);
}

#[test]
fn a_pause_takes_in_nothing_and_keeps_what_is_left_over() {
    let mut step_clock = StepClock::new(TimeStep::hz(10)).expect("a fair step");
    step_clock.frame(70_000_000);
    step_clock.set_paused(true);
    assert_eq!(step_clock.frame(u64::MAX), StepsDue::default());
    // Three new ticks and a half are left over, which no frame asks for in a pause.
    step_clock.set_time_step(TimeStep::hz(50)).expect("a fair step");
    assert_eq!((step_clock.frame(1), step_clock.remainder()), (StepsDue::default(), TickFraction { num: 7, den: 2 }));
    assert_eq!(step_clock.until_tick(), None);
    step_clock.set_paused(false);
    assert_eq!(step_clock.until_tick(), Some(0));
    assert_eq!((step_clock.frame(0).ticks, step_clock.remainder()), (3, TickFraction { num: 1, den: 2 }));
    step_clock.settle();
    assert_eq!(
        (step_clock.remainder(), step_clock.time_step(), step_clock.speed()),
        (TickFraction::ZERO, TimeStep::hz(50), (1, 1))
    );
}

#[test]
fn inexact_clock_changes_are_refused_and_settling_makes_room() {
    assert_eq!(StepClock::new(TimeStep::hz(10_001)), Err(Error::TimeStep));
    let mut step_clock = StepClock::new(TimeStep::hz(60)).expect("a fair step");
    assert_eq!(step_clock.set_time_step(TimeStep::hz(0)), Err(Error::TimeStep));
    assert_eq!(step_clock.set_speed(1, 0), Err(Error::ElapsedTime));
    // Primes: what is left over has all of them in its denominator.
    let primes = [4_294_967_291, 4_294_967_279, 4_294_967_231, 4_294_967_197];
    let refused = primes.into_iter().position(|prime| {
        let before = step_clock.clone();
        let is_refused = step_clock.set_speed(1, prime) == Err(Error::ElapsedTime);
        assert!(!is_refused || step_clock == before);
        step_clock.frame(1);
        is_refused
    });
    assert_eq!(refused, Some(2));
    step_clock.settle();
    assert_eq!(step_clock.set_speed(1, primes[2]), Ok(()));
    // A ramp over one denominator never comes to that.
    let mut step_clock = StepClock::new(TimeStep::hz(60)).expect("a fair step");
    for round in 0..10_000u32 {
        step_clock.set_speed(round % 1_000, 1_000).expect("it has that denominator already");
        step_clock.frame(u64::from(round) * 7_919);
    }
}

#[test]
fn the_time_of_a_paced_world_and_what_is_left_over_are_all_the_time_there_was() {
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    let mut step_clock = StepClock::new(world.def().time_step).expect("that of a world");
    let steps = [TimeStep::hz(60), TimeStep::ratio(1001, 60_000), TimeStep::hz(50), TimeStep::hz(144)];
    let mut total = UBig::ZERO;
    for round in 0..2_000u64 {
        let nanoseconds = round * round * 97 % 60_000_000;
        total += nanoseconds;
        let due = step_clock.frame(nanoseconds);
        assert_eq!(due.dropped, 0);
        (0..due.ticks).for_each(|_| _ = world.step());
        let (elapsed, step) = (world.elapsed(), world.def().time_step);
        let now = Exact::new(elapsed.num, elapsed.den).plus(&of_ticks(step_clock.remainder()).times(&seconds(step)));
        assert!(now == Exact::new(total.clone(), 1_000_000_000u64), "round {round}");
        if round % 100 == 99 {
            let step = steps[(round / 100) as usize % steps.len()];
            world.set_time_step(step).expect("a fair step");
            step_clock.set_time_step(step).expect("a fair step");
        }
    }
    assert!(world.tick() > 3_000);
}
