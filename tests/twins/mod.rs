//! Scalars that are `Fx` but for the rounding of what positions and velocities show, to see tests of symmetry fail.

use core::cell::Cell;
use core::cmp::Ordering;
use core::fmt;
use core::ops::{Add, Neg, Sub};

use umbra_physics::scalar::internals::{
    AreaMoments, Arithmetic, Bulk, Compiled, Decay, Forces, Motion, Number, Polygons, Span, Sum,
};
use umbra_physics::scalar::{Accumulator, Angle, Factor, FxSum, Scalar, Wide};
use umbra_physics::solve::Solver;
use umbra_physics::{Fx, FxAccumulator, FxFactor, FxWide, SpringConstants, Turn, Vec2};

type Offset = Vec2<FxWide>;

/// How twins round.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Rounding {
    /// To nearest, ties to even: what `Fx` does, as a control of the twin itself.
    Even,
    Down,
    /// To nearest, ties up.
    HalfUp,
    /// To nearest, ties away from zero.
    HalfAway,
}

thread_local! {
    /// The rounding of all twins of the thread. A type for each rounding would compile the engine as many times.
    static ROUNDING: Cell<Rounding> = const { Cell::new(Rounding::Even) };
}

impl Rounding {
    /// Makes this the rounding of all twins of the thread.
    pub(crate) fn set(self) {
        ROUNDING.set(self);
    }
}

/// An `Fx` whose accumulators round as [`Rounding::set`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct Twin(pub(crate) Fx);

/// The accumulator: a multiple of 2^-96, as the one of `Fx`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TwinAccumulator(i128);

/// value / 2^shift, shift from 1 to 126.
fn shifted(value: i128, shift: u32) -> i128 {
    let (floor, half) = (value >> shift, 1i128 << (shift - 1));
    let rest = value - (floor << shift);
    let up = match (rest.cmp(&half), ROUNDING.get()) {
        (Ordering::Less, _) | (_, Rounding::Down) => false,
        (Ordering::Greater, _) => true,
        (Ordering::Equal, Rounding::Even) => floor & 1 == 1,
        (Ordering::Equal, Rounding::HalfUp) => true,
        (Ordering::Equal, Rounding::HalfAway) => value >= 0,
    };
    floor + i128::from(up)
}

impl fmt::Display for Twin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Add for Twin {
    type Output = Self;
    fn add(self, rhs: Self) -> Self {
        Self(self.0 + rhs.0)
    }
}

impl Sub for Twin {
    type Output = Self;
    fn sub(self, rhs: Self) -> Self {
        Self(self.0 - rhs.0)
    }
}

impl Neg for Twin {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Number for Twin {
    const WORDS: usize = 1;

    fn to_words(self) -> [u64; 3] {
        self.0.to_words()
    }
}

impl Number for TwinAccumulator {
    const WORDS: usize = 2;

    fn to_words(self) -> [u64; 3] {
        FxAccumulator::from_bits(self.0).to_words()
    }
}

impl fmt::Display for TwinAccumulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        FxAccumulator::from_bits(self.0).fmt(f)
    }
}

impl Accumulator<Twin> for TwinAccumulator {
    fn from_scalar(value: Twin) -> Self {
        Self(i128::from(value.0.to_bits()) << 64)
    }
    fn value(self) -> Twin {
        Twin(Fx::from_bits(shifted(self.0, 64) as i64))
    }
    fn plus(self, rhs: Self) -> Self {
        Self(self.0 + rhs.0)
    }
    fn negated(self) -> Self {
        Self(-self.0)
    }
    fn scaled(self, factor: FxFactor) -> Option<Self> {
        Accumulator::<Fx>::scaled(FxAccumulator::from_bits(self.0), factor).map(|a| Self(Accumulator::<Fx>::to_bits(a)))
    }
    fn is_within(self, limit: Twin) -> bool {
        FxAccumulator::from_bits(self.0).is_within(limit.0)
    }
    fn to_fixed(self) -> FxAccumulator {
        FxAccumulator::from_bits(self.0)
    }
    fn from_fixed(value: FxAccumulator) -> Self {
        Self(Accumulator::<Fx>::to_bits(value))
    }
    fn to_bits(self) -> i128 {
        self.0
    }
}

impl Factor<Twin> for FxFactor {
    const ZERO: Self = <Self as Factor<Fx>>::ZERO;
    const ONE: Self = <Self as Factor<Fx>>::ONE;
    const PI: Self = <Self as Factor<Fx>>::PI;
    fn from_scalar(value: Twin) -> Self {
        Factor::<Fx>::from_scalar(value.0)
    }
    fn to_fx_factor(self) -> Self {
        self
    }
    fn from_wide(value: FxWide) -> Self {
        Factor::<Fx>::from_wide(value)
    }
    fn from_ratio(num: u64, den: u64) -> Self {
        Factor::<Fx>::from_ratio(num, den)
    }
    fn to_scalar(self) -> Option<Twin> {
        Factor::<Fx>::to_scalar(self).map(Twin)
    }
    fn times(self, rhs: Self) -> Self {
        Factor::<Fx>::times(self, rhs)
    }
    fn over(self, rhs: Self) -> Self {
        Factor::<Fx>::over(self, rhs)
    }
    fn plus(self, rhs: Self) -> Self {
        Factor::<Fx>::plus(self, rhs)
    }
    fn minus(self, rhs: Self) -> Self {
        Factor::<Fx>::minus(self, rhs)
    }
    fn to_binary(self) -> (u64, i32) {
        Factor::<Fx>::to_binary(self)
    }
    fn from_binary(value: u128, shift: i32) -> Self {
        Factor::<Fx>::from_binary(value, shift)
    }
}

impl Wide<Twin> for FxWide {
    fn from_scalar(value: Twin) -> Self {
        Wide::<Fx>::from_scalar(value.0)
    }
    fn from_factor(magnitude: FxFactor, negative: bool) -> Option<Self> {
        Wide::<Fx>::from_factor(magnitude, negative)
    }
    fn to_scalar(self) -> Option<Twin> {
        Wide::<Fx>::to_scalar(self).map(Twin)
    }
    fn plus(self, rhs: Self) -> Option<Self> {
        Wide::<Fx>::plus(self, rhs)
    }
    fn negated(self) -> Self {
        Wide::<Fx>::negated(self)
    }
    fn times(self, factor: FxFactor) -> Option<Self> {
        Wide::<Fx>::times(self, factor)
    }
    fn is_negative(self) -> bool {
        Wide::<Fx>::is_negative(self)
    }
}

impl Sum<Twin> for FxSum {
    fn add(&mut self, term: FxWide) {
        Sum::<Fx>::add(self, term);
    }
    fn total(self) -> Option<FxWide> {
        Sum::<Fx>::total(self)
    }
}

impl Angle<Twin> for Turn {
    fn from_radians(radians: Twin) -> Self {
        Angle::<Fx>::from_radians(radians.0)
    }
    fn radians(self) -> Twin {
        Twin(Angle::<Fx>::radians(self))
    }
    fn sin_cos(self) -> (Twin, Twin) {
        let (sin, cos) = Angle::<Fx>::sin_cos(self);
        (Twin(sin), Twin(cos))
    }
    fn drift_factor(span: Span) -> FxFactor {
        <Self as Angle<Fx>>::drift_factor(span)
    }
    fn drifted(self, velocity: Twin, drift_factor: FxFactor, negative: bool) -> Self {
        Angle::<Fx>::drifted(self, velocity.0, drift_factor, negative)
    }
    fn turned(self, radians: TwinAccumulator) -> Self {
        Angle::<Fx>::turned(self, FxAccumulator::from_bits(radians.0))
    }
    fn way_to(self, goal: Self) -> FxWide {
        Angle::<Fx>::way_to(self, goal)
    }
    type Direction = <Self as Angle<Fx>>::Direction;

    fn direction(self) -> Self::Direction {
        Angle::<Fx>::direction(self)
    }
    fn turn(direction: Self::Direction, v: Vec2<Twin>) -> Option<Offset> {
        <Self as Angle<Fx>>::turn(direction, v.map(|c| c.0))
    }
    fn to_bits(self) -> u64 {
        Angle::<Fx>::to_bits(self)
    }
    fn to_turn(self) -> Self {
        self
    }
    fn from_turn(turn: Self) -> Self {
        turn
    }
}

fn corners(corners: &[Vec2<Twin>]) -> Vec<Vec2> {
    corners.iter().map(|corner| corner.map(|c| c.0)).collect()
}

impl Scalar for Twin {
    type Accumulator = TwinAccumulator;
    type Factor = FxFactor;
    type Angle = Turn;
    type Wide = FxWide;
    type Sum = FxSum;

    const ZERO: Self = Self(Fx::ZERO);
    const ONE: Self = Self(Fx::ONE);
    const NAME: &'static str = "twin";

    fn from_fx(value: Fx) -> Self {
        Self(value)
    }
    fn to_fx(self) -> Fx {
        self.0
    }
    fn to_bits(self) -> i64 {
        self.0.to_bits()
    }
    fn is_finite(self) -> bool {
        true
    }
}

impl Arithmetic<Twin> for Twin {
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }
    fn product(self, rhs: Self) -> FxWide {
        self.0.product(rhs.0)
    }
    fn offset(self, rhs: Self) -> FxWide {
        self.0.offset(rhs.0)
    }
    fn torque(arm: FxWide, force: FxWide) -> Option<FxWide> {
        Fx::torque(arm, force)
    }
    fn times(self, rhs: Self) -> Option<Self> {
        Arithmetic::times(self.0, rhs.0).map(Self)
    }
}

impl Motion<Twin> for Twin {
    type DecayRate = <Fx as Motion<Fx>>::DecayRate;

    fn seconds(span: Span) -> FxFactor {
        Fx::seconds(span)
    }
    fn half_square_seconds(num: u32, den: u32) -> FxFactor {
        Fx::half_square_seconds(num, den)
    }
    fn decay_rate(decay: Decay<Self>) -> Self::DecayRate {
        Fx::decay_rate(match decay {
            Decay::KeptPerSecond(kept) => Decay::KeptPerSecond(kept.0),
            Decay::Rate(rate) => Decay::Rate(rate.0),
        })
    }
    fn kept_at(rate: Self) -> Self {
        Self(Fx::kept_at(rate.0))
    }
    fn decay_over(rate: Self::DecayRate, span: Span) -> FxFactor {
        Fx::decay_over(rate, span)
    }
    fn drift(self, seconds: FxFactor) -> TwinAccumulator {
        let (mantissa, shift) = seconds.parts();
        let way = i128::from(self.0.to_bits()) * i128::from(mantissa);
        // Steps of a second or more have a shift below 64; the scenes here have shorter ones.
        TwinAccumulator(if shift > 64 { shifted(way, (shift - 64) as u32) } else { way << (64 - shift) })
    }
    fn kick(acceleration: FxWide, seconds: FxFactor) -> Option<TwinAccumulator> {
        Fx::kick(acceleration, seconds).map(|a| TwinAccumulator(Accumulator::<Fx>::to_bits(a)))
    }
}

impl Bulk<Twin> for Twin {}

impl Compiled<Twin> for Twin {
    type Solver = Solver;
}

impl Forces<Twin> for Twin {
    type DragMemo = <Fx as Forces<Fx>>::DragMemo;

    fn attraction(mu: FxFactor, to_centre: Offset, softening: Self) -> Option<Offset> {
        Fx::attraction(mu, to_centre, softening.0)
    }
    fn tension(offset: Offset, velocity: Offset, spring: &SpringConstants<Self>) -> Option<Offset> {
        let SpringConstants { rest, stiffness, damping } = *spring;
        Fx::tension(offset, velocity, &SpringConstants { rest: rest.0, stiffness: stiffness.0, damping: damping.0 })
    }
    fn length(offset: Offset, third: Self) -> FxFactor {
        Fx::length(offset, third.0)
    }
    fn reaches(self, offset: Offset) -> bool {
        self.0.reaches(offset)
    }
    fn drag(
        memo: &mut Self::DragMemo,
        a: FxFactor,
        b: FxFactor,
        c: FxFactor,
        d: FxFactor,
        negative: bool,
    ) -> Option<FxFactor> {
        Fx::drag(memo, a, b, c, d, negative)
    }
}

impl Polygons<Twin> for Twin {
    fn polygon_moments(points: &[Vec2<Self>]) -> Option<AreaMoments<Self>> {
        let AreaMoments { area, centroid, second } = Fx::polygon_moments(&corners(points))?;
        Some(AreaMoments { area, centroid: centroid.map(Self), second })
    }
    fn orientation(a: Vec2<Self>, b: Vec2<Self>, c: Vec2<Self>) -> Ordering {
        let [a, b, c] = [a, b, c].map(|corner| corner.map(|c| c.0));
        Fx::orientation(a, b, c)
    }
    fn weighted_mean(weights: &[FxFactor], values: &[Self]) -> Option<Self> {
        let values: Vec<Fx> = values.iter().map(|v| v.0).collect();
        Fx::weighted_mean(weights, &values).map(Self)
    }
    fn turning(a: Vec2<Self>, b: Vec2<Self>, c: Vec2<Self>) -> FxFactor {
        let [a, b, c] = [a, b, c].map(|corner| corner.map(|c| c.0));
        Fx::turning(a, b, c)
    }
}
