//! The number types of the engine: what it asks of a scalar, and no more.
//!
//! [`Fx`] is the type that carries the promises; `f32` and `f64` (feature `float`) build the same engine to compare
//! with. A quantity that does not fit in the scalar itself has a type of its own beside it: positions and velocities
//! are [`Accumulator`]s; the time step, 1/m and moments of inertia are [`Factor`]s; forces, torques, accelerations and
//! energies are [`Wide`]; angles are [`Angle`]s. For a float all of them are the float.
//!
//! The traits are open so that a study can put in another rounding; only `Fx` carries the promises.
//!
//! ```
//! use umbra_physics::scalar::{Accumulator as _, Angle as _, Factor as _, Number, Scalar, Sum as _, Wide as _};
//! use umbra_physics::{Fx, FxWide, fx};
//!
//! /// The kinetic energy of masses at these speeds, J, in whatever number: ½·Σ m·v².
//! fn energy<S: Scalar>(bodies: &[(S, S)]) -> Option<S::Wide> {
//!     let mut sum = S::Sum::default();
//!     for &(mass, speed) in bodies {
//!         sum.add(speed.product(speed).times(S::Factor::from_scalar(mass))?);
//!     }
//!     sum.total()?.times(S::Factor::from_ratio(1, 2))
//! }
//! let joules: Option<FxWide> = energy(&[(fx!(2), fx!(3)), (fx!(0.5), fx!(-4))]);
//! assert_eq!(joules.map(|joules| joules.to_string()), Some("13".into()));
//!
//! /// A number as it goes into a hash.
//! fn words<N: Number>(number: N) -> Vec<u64> {
//!     number.to_words()[..N::WORDS].to_vec()
//! }
//! assert_eq!(words(fx!(1)), [1 << 32]);
//! // Positions are the scalar and a finer fraction; angles wrap by themselves.
//! assert_eq!(<Fx as Scalar>::Accumulator::from_scalar(fx!(1.5)).value(), fx!(1.5));
//! assert_eq!(<Fx as Scalar>::Angle::from_radians(Fx::FRAC_PI_2).sin_cos(), (fx!(1), fx!(0)));
//! ```

use core::fmt::{Debug, Display};
use core::ops::{Add, Neg, Sub};

use fx::Fx;

mod accumulator;
#[cfg(test)]
mod checks;
mod decimal;
mod factor;
mod factor_text;
mod fixed_laws;
#[cfg(feature = "float")]
mod float;
pub mod fx;
mod lanes;
mod moments;
#[cfg(feature = "serde")]
mod serial;
mod sweep;
mod turn;
mod wide;

pub use accumulator::FxAccumulator;
pub use factor::FxFactor;
#[cfg(feature = "float")]
pub use float::ToF64;
pub use lanes::wide_vectors;
pub use turn::Turn;
pub use wide::{FxSum, FxWide};

/// The velocity that one kick may add stays below two to this, in m/s or rad/s.
pub(crate) const KICK_LOG2: i32 = 21;
/// Velocities between the stages of a step stay below two to this, and a few kicks.
pub(crate) const TRANSIENT_SPEED_LOG2: i32 = 24;

/// What every number of the engine is: plain, printed exactly, and the same words on every machine.
pub trait Number: Copy + Debug + Display + Default + PartialEq + Send + Sync + 'static {
    /// How many words of 64 bits it takes in hashes and files, at most three.
    const WORDS: usize;
    /// Its bits in the first [`WORDS`](Self::WORDS) words, the most significant first.
    fn to_words(self) -> [u64; 3];
}

/// A multiple of the time step that an integrator moves over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Weight {
    /// The whole step.
    Whole,
    /// 1 / (2 − ∛2) = 1.3512…, the first and third sub-step of the fourth-order composition (Yoshida 1990).
    YoshidaOuter,
    /// −∛2 / (2 − ∛2) = −1.7024…, its second.
    YoshidaInner,
}

/// A duration: a multiple of the time step, or half of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Span {
    /// The time step as a ratio in seconds, num / den.
    pub ratio: (u32, u32),
    /// The multiple of it.
    pub weight: Weight,
    /// Half of that, for the outer stages of a symmetric step.
    pub half: bool,
}

impl Span {
    /// Whether time runs backwards in it. Factors made from a span are made from its magnitude.
    #[must_use]
    pub const fn is_negative(self) -> bool {
        matches!(self.weight, Weight::YoshidaInner)
    }
}

/// A step of kick, drift, kick, in which nothing acts but damping and a constant acceleration.
#[derive(Clone, Copy, Debug)]
pub struct Glide<S: Scalar> {
    /// What is left of the velocity after half of the span, at most 1.
    pub kept: S::Factor,
    /// The velocity gained in half of it.
    pub fall: S::Accumulator,
    /// Its length.
    pub seconds: S::Factor,
    /// Whether time runs backwards in it.
    pub negative: bool,
}

/// The same of an angle, without acceleration.
#[derive(Clone, Copy, Debug)]
pub struct Spin<S: Scalar> {
    /// What is left of the angular velocity after half of the span, at most 1.
    pub kept: S::Factor,
    /// [`Angle::drift_factor`] of the span.
    pub turn: S::Factor,
    /// Whether time runs backwards in it.
    pub negative: bool,
}

/// [`Scalar::spin_all`] by its stages.
fn spin_in_stages<S: Scalar>(angles: &mut [S::Angle], velocities: &mut [S::Accumulator], angular_velocity: &Spin<S>) {
    let damped = angular_velocity.kept != S::Factor::ONE;
    if damped {
        S::damp_all(velocities, angular_velocity.kept);
    }
    S::turn_all(angles, velocities, angular_velocity.turn, angular_velocity.negative);
    if damped {
        S::damp_all(velocities, angular_velocity.kept);
    }
}

/// [`Scalar::glide_all`] by its stages.
fn glide_in_stages<S: Scalar>(positions: &mut [S::Accumulator], velocities: &mut [S::Accumulator], glide: &Glide<S>) {
    let damped = glide.kept != S::Factor::ONE;
    let falls = glide.fall != S::Accumulator::default();
    if damped {
        S::damp_all(velocities, glide.kept);
    }
    if falls {
        S::kick_all(velocities, glide.fall);
    }
    S::drift_all(positions, velocities, glide.seconds, glide.negative);
    if falls {
        S::kick_all(velocities, glide.fall);
    }
    if damped {
        S::damp_all(velocities, glide.kept);
    }
}

/// A component of a position or a velocity: the scalar and a finer fraction below it.
pub trait Accumulator<S: Scalar>: Number {
    /// The accumulator of this value, with nothing below it.
    fn from_scalar(value: S) -> Self;
    /// The scalar nearest to it, ties to even. *Domain* the value fits in the scalar; inside the envelope it does.
    fn value(self) -> S;
    /// Whether that is zero.
    fn is_still(self) -> bool {
        self.value() == S::ZERO
    }
    /// The sum. *Domain* it fits; inside the envelope it does.
    #[must_use]
    fn plus(self, other: Self) -> Self;
    /// The same on the other side of zero.
    #[must_use]
    fn negated(self) -> Self;
    /// The product, or zero if its public value is zero. `None` from a magnitude of 2^24 on.
    fn scaled(self, factor: S::Factor) -> Option<Self>;
    /// The product, or zero if its public value is zero. *Domain* kept <= 1, a magnitude below 2^26.
    #[must_use]
    fn damped(self, kept: S::Factor) -> Self {
        self.scaled(kept).unwrap_or(self)
    }
    /// Whether its magnitude is at most `limit`.
    fn is_within(self, limit: S) -> bool;
    /// Its bits.
    fn to_bits(self) -> i128;
    /// Its words as bytes for a hash: the high word first, as accumulators lie in memory.
    fn to_bytes(self) -> [u8; 16] {
        self.to_bits().rotate_left(64).to_le_bytes()
    }
}

/// A factor of at least zero with 64 significant bits, whatever its size: a duration, 1/m, a moment of inertia.
pub trait Factor<S: Scalar>: Number + PartialOrd {
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// π.
    const PI: Self;
    /// The magnitude of `value`, exactly.
    fn from_scalar(value: S) -> Self;
    /// The magnitude of `value`.
    fn from_wide(value: S::Wide) -> Self;
    /// num / den. *Domain* den > 0.
    fn from_ratio(num: u64, den: u64) -> Self;
    /// The scalar nearest to it; `None` if it does not fit.
    fn to_scalar(self) -> Option<S>;
    /// The product.
    #[must_use]
    fn times(self, other: Self) -> Self;
    /// The quotient. *Domain* `other` is not zero.
    #[must_use]
    fn over(self, other: Self) -> Self;
    /// The sum.
    #[must_use]
    fn plus(self, other: Self) -> Self;
    /// The difference, or zero if `other` is the larger.
    #[must_use]
    fn minus(self, other: Self) -> Self;
    /// The distance between the two, either way.
    #[must_use]
    fn abs_diff(self, other: Self) -> Self {
        // One of the two is zero.
        self.minus(other).plus(other.minus(self))
    }
    /// Whether it is zero.
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
}

/// A signed quantity that outgrows the scalar: a force, torque, acceleration, momentum or energy.
pub trait Wide<S: Scalar>: Number + PartialOrd + Display {
    /// The same value, exactly.
    fn from_scalar(value: S) -> Self;
    /// The value nearest to plus or minus `magnitude`; `None` if it does not fit.
    fn from_factor(magnitude: S::Factor, negative: bool) -> Option<Self>;
    /// The scalar nearest to it; `None` if it does not fit.
    fn to_scalar(self) -> Option<S>;
    /// The sum; `None` if it does not fit.
    fn plus(self, other: Self) -> Option<Self>;
    /// The same on the other side of zero.
    #[must_use]
    fn negated(self) -> Self;
    /// The product; `None` if it does not fit.
    fn times(self, factor: S::Factor) -> Option<Self>;
    /// Whether it is below zero.
    fn is_negative(self) -> bool;
}

/// A sum of wide values, as many as a step has time for, checked once at its end, so that the order of the terms never matters.
pub trait Sum<S: Scalar>: Number {
    /// Adds a term.
    fn add(&mut self, term: S::Wide);
    /// The total; `None` if it does not fit.
    fn total(self) -> Option<S::Wide>;
}

/// An angle, kept within one turn.
pub trait Angle<S: Scalar>: Number {
    /// The angle of so many radians, any number of turns.
    fn from_radians(radians: S) -> Self;
    /// Radians in [0, 2π).
    fn radians(self) -> S;
    /// Sine and cosine.
    fn sin_cos(self) -> (S, S);
    /// What turns an angular velocity into an angle passed in this span.
    fn drift_factor(span: Span) -> S::Factor;
    /// The angle after turning at `velocity` rad/s for `drift_factor`'s span, backwards if `negative`.
    #[must_use]
    fn drifted(self, velocity: S, drift_factor: S::Factor, negative: bool) -> Self;
    /// The angle turned by so many radians.
    #[must_use]
    fn turned(self, radians: S::Accumulator) -> Self;
    /// The short way from this angle to another, rad: between −π and π, and none for half a turn, which has no short way.
    fn way_to(self, goal: Self) -> S::Wide;
    /// Sine and cosine with all the bits they are computed with: what turns vectors.
    type Direction: Copy + Debug + Default + Send + Sync;
    /// That of this angle.
    fn direction(self) -> Self::Direction;
    /// A vector turned by the angle of a direction; `None` if a component does not fit in the scalar.
    fn turn(direction: Self::Direction, x: S, y: S) -> Option<(S::Wide, S::Wide)>;
    /// The vector turned by this angle; `None` if a component does not fit in the scalar.
    fn rotate(self, x: S, y: S) -> Option<(S::Wide, S::Wide)> {
        Self::turn(self.direction(), x, y)
    }
    /// Its bits.
    fn to_bits(self) -> u64;
}

/// Area, centroid and second moment of area of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaMoments<S: Scalar> {
    /// Area in m².
    pub area: S::Factor,
    /// Centroid in m.
    pub centroid: (S, S),
    /// Second moment about the centroid, in m⁴; it loses bits if that is far from the origin of the coordinates.
    pub second: S::Factor,
}

/// What stretches between two points, as a law of force sees it: the offset from one to the other in m.
pub type Offset<S> = (<S as Scalar>::Wide, <S as Scalar>::Wide);

/// A number type the engine can be built on.
///
/// Operators panic on overflow in every profile; the engine's own arithmetic goes through the associated types, whose
/// ranges are proved where the limits stand.
pub trait Scalar: Number + Display + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> {
    /// Components of positions and velocities.
    type Accumulator: Accumulator<Self>;
    /// Durations, inverse masses, moments of inertia.
    type Factor: Factor<Self>;
    /// Angles.
    type Angle: Angle<Self>;
    /// Forces, torques, accelerations, momenta, energies.
    type Wide: Wide<Self>;
    /// Sums of them.
    type Sum: Sum<Self>;
    /// How fast a velocity decays: see [`decay_rate`](Self::decay_rate).
    type DecayRate: Copy + Debug + Send + Sync;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The name in tables and on the command line.
    const NAME: &'static str;
    /// Whether a kick or a drift is taken back to the bit by the same one with the opposite sign: sums do not round, and
    /// the other roundings are odd.
    const IS_REVERSIBLE: bool = false;

    /// The same value; rounded to nearest in a float. How scenes and limits enter every build.
    fn from_fx(value: Fx) -> Self;
    /// The bits.
    fn to_bits(self) -> i64;
    /// Whether it is a number; a float may not be.
    fn is_finite(self) -> bool;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The product, exactly.
    fn product(self, other: Self) -> Self::Wide;
    /// The difference `self − other`, exactly.
    fn offset(self, other: Self) -> Self::Wide;
    /// The product of a difference in m and a force in N, in N·m; `None` if it does not fit.
    fn torque(arm: Self::Wide, force: Self::Wide) -> Option<Self::Wide>;
    /// The product, rounded to nearest, ties to even; `None` if it does not fit.
    fn times(self, other: Self) -> Option<Self>;

    /// A span in seconds, its magnitude.
    fn seconds(span: Span) -> Self::Factor;
    /// ½·dt² of the whole step, in s².
    fn half_square_seconds(ratio: (u32, u32)) -> Self::Factor;
    /// The rate at which a velocity decays of which `kept` is left after a second: from it what is left after a span follows
    /// sooner. *Domain* 0 ≤ kept ≤ 1.
    fn decay_rate(kept: Self) -> Self::DecayRate;
    /// What is left of 1 after a span at a rate, kept^span: the exact solution of dv/dt = v·ln kept. *Domain* kept > 0 where
    /// the span is negative.
    fn decay_over(rate: Self::DecayRate, span: Span) -> Self::Factor;
    /// The same at `kept` a second. *Domain* 0 ≤ kept ≤ 1, kept > 0 where the span is negative.
    fn decay(kept: Self, span: Span) -> Self::Factor {
        Self::decay_over(Self::decay_rate(kept), span)
    }
    /// The way covered at this velocity in `seconds`. *Domain* |v| < 2^26 m/s, seconds < 2.
    fn drift(self, seconds: Self::Factor) -> Self::Accumulator;
    /// The velocity gained at this acceleration in `seconds`; `None` from 2^21 on.
    fn kick(acceleration: Self::Wide, seconds: Self::Factor) -> Option<Self::Accumulator>;

    /// Each times `kept`, or zero if its public value is then zero. *Domain* kept <= 1, values below 2^26.
    fn damp_all(values: &mut [Self::Accumulator], kept: Self::Factor) {
        values.iter_mut().for_each(|v| *v = v.damped(kept));
    }
    /// Each plus `gained`. *Domain* the sums fit, as for [`Accumulator::plus`].
    fn kick_all(values: &mut [Self::Accumulator], gained: Self::Accumulator) {
        values.iter_mut().for_each(|v| *v = v.plus(gained));
    }
    /// Each position plus the way covered at the public velocity in `seconds`, backwards if `negative`. *Domain* that of
    /// [`drift`](Self::drift).
    fn drift_all(
        positions: &mut [Self::Accumulator],
        velocities: &[Self::Accumulator],
        seconds: Self::Factor,
        negative: bool,
    ) {
        for (x, v) in positions.iter_mut().zip(velocities) {
            let way = v.value().drift(seconds);
            *x = x.plus(if negative { way.negated() } else { way });
        }
    }
    /// Damps, kicks, drifts, kicks, damps.
    fn glide_all(positions: &mut [Self::Accumulator], velocities: &mut [Self::Accumulator], glide: &Glide<Self>) {
        glide_in_stages(positions, velocities, glide);
    }
    /// Damps, turns, damps.
    fn spin_all(angles: &mut [Self::Angle], velocities: &mut [Self::Accumulator], angular_velocity: &Spin<Self>) {
        spin_in_stages(angles, velocities, angular_velocity);
    }
    /// Each angle after turning at the public velocity for `drift_factor`'s span, as [`Angle::drifted`].
    fn turn_all(
        angles: &mut [Self::Angle],
        velocities: &[Self::Accumulator],
        drift_factor: Self::Factor,
        negative: bool,
    ) {
        for (angle, v) in angles.iter_mut().zip(velocities) {
            *angle = angle.drifted(v.value(), drift_factor, negative);
        }
    }
    /// Whether all are numbers of a magnitude of at most two to this; one that is may also be refused at the limit itself.
    /// *Domain* log2 < 31.
    fn are_within(values: &[Self::Accumulator], log2: u32) -> bool {
        let limit = Self::from_fx(Fx::from_bits(1 << (32 + log2)));
        values.iter().fold(true, |all, v| all & v.is_within(limit))
    }

    /// The acceleration towards an attractor: mu·d / (d² + softening²)^(3/2); zero at its centre.
    fn attraction(mu: Self::Factor, to_centre: Offset<Self>, softening: Self) -> Option<Offset<Self>>;
    /// The force of a spring on its near end, whose far end is at `offset` and moves at `velocity` relative to it:
    /// stiffness·(length − rest) + damping·(d length/dt) along the spring; zero where the ends coincide.
    fn tension(offset: Offset<Self>, velocity: Offset<Self>, spring: &SpringConstants<Self>) -> Option<Offset<Self>>;
    /// √(x² + y² + z²).
    fn length(offset: Offset<Self>, third: Self) -> Self::Factor;
    /// Whether an offset is no longer than this, exactly.
    fn reaches(self, offset: Offset<Self>) -> bool;
    /// What is left of a velocity relative to the medium: du/dt = −(α + β·|u|)·u solved exactly over `seconds`, with
    /// α = linear·inverse_mass and β = quadratic·inverse_mass. Backwards the quadratic
    /// part is cut off short of its pole, where a speed grows fourfold. `None` if the linear part grows beyond 2^255.
    fn drag(
        speed: Self::Factor,
        alpha: Self::Factor,
        beta: Self::Factor,
        seconds: Self::Factor,
        negative: bool,
    ) -> Option<Self::Factor>;
    /// Area, centroid and second moment of a polygon, from sums that do not depend on its first corner or winding.
    /// `None` if it has no area.
    fn polygon_moments(corners: &[(Self, Self)]) -> Option<AreaMoments<Self>>;
    /// Twice the signed area of the triangle, its sign alone: counter-clockwise, none, clockwise.
    fn orientation(a: (Self, Self), b: (Self, Self), c: (Self, Self)) -> core::cmp::Ordering;
    /// The mean of `values` by `weights`; `None` without weight.
    fn weighted_mean(weights: &[Self::Factor], values: &[Self]) -> Option<Self>;
}

/// The constants of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SpringConstants<S> {
    /// Length at which it pulls nothing, m.
    pub rest: S,
    /// N/m.
    pub stiffness: S,
    /// N·s/m, along the spring.
    pub damping: S,
}
