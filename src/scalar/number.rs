//! The number types of the engine: the trait that users may name, and the types beside the scalar.
//!
//! All traits here are sealed by [`Number`], which no path outside this crate reaches (but for the feature `selftest`, with
//! which tests put in scalars that round wrongly and watch them fail). Items that are `#[doc(hidden)]` are public because
//! Rust wants a public trait to have public items; they are no part of the interface and change without notice.

use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt::{Debug, Display};
use core::ops::{Add, Neg, Sub};

use super::accumulator::FxAccumulator;
use super::bulk::Bulk;
use super::factor::FxFactor;
use super::forces::Forces;
use super::motion::{Motion, Span};
use super::polygon::Polygons;
use super::turn::Turn;
#[doc(hidden)]
pub use crate::compiled::Compiled;
use crate::fx::Fx;
use crate::math::Vec2;

/// Methods of a trait that the type itself has under the same names, so that its users need no trait.
macro_rules! inherent {
    ($(fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?;)*) => {$(
        #[inline]
        fn $name($($argument: $type),*) $(-> $result)? {
            Self::$name($($argument),*)
        }
    )*};
}
pub(super) use inherent;

/// A plain value: printed exactly, with the same words on every machine. It seals the traits of this module.
#[doc(hidden)]
pub trait Number: Copy + Debug + Display + Default + PartialEq + Send + Sync + 'static {
    /// Number of 64-bit words in hashes and files, at most three.
    const WORDS: usize;
    /// The bits, in the first [`WORDS`](Self::WORDS) words, the most significant first.
    fn to_words(self) -> [u64; 3];
}

/// A component of a position or a velocity: the scalar and a finer fraction below it.
pub trait Accumulator<S: Scalar>: Number {
    /// The accumulator of this value, exactly.
    fn from_scalar(value: S) -> Self;
    /// The nearest scalar, ties to even. *Domain* the value fits in the scalar, as it does within [`limits`](crate::limits).
    fn value(self) -> S;
    /// The sum. *Domain* it fits, as it does within [`limits`](crate::limits).
    #[must_use]
    fn plus(self, rhs: Self) -> Self;
    /// The negative.
    #[must_use]
    fn negated(self) -> Self;
    /// The bits.
    fn to_bits(self) -> i128;

    /// The value in fixed point, where contacts are found: exactly, or the multiple of 2^-96 nearest to a float.
    #[doc(hidden)]
    fn to_fixed(self) -> FxAccumulator;
    /// The value of an accumulator in fixed point: exactly, or the nearest float.
    #[doc(hidden)]
    fn from_fixed(value: FxAccumulator) -> Self;
    /// Returns true if the nearest scalar is zero.
    #[doc(hidden)]
    fn is_still(self) -> bool {
        self.value() == S::ZERO
    }
    /// The product, or zero if its nearest scalar is zero. `None` from a magnitude of 2^24 on.
    #[doc(hidden)]
    fn scaled(self, factor: S::Factor) -> Option<Self>;
    /// The product, or zero if its nearest scalar is zero. *Domain* kept <= 1, a magnitude below 2^26.
    #[doc(hidden)]
    #[must_use]
    fn damped(self, kept: S::Factor) -> Self {
        self.scaled(kept).unwrap_or(self)
    }
    /// Returns true if the magnitude is at most `limit`.
    #[doc(hidden)]
    fn is_within(self, limit: S) -> bool;
    /// The words as bytes for a hash: the high word first, as accumulators lie in memory.
    #[doc(hidden)]
    fn to_bytes(self) -> [u8; 16] {
        self.to_bits().rotate_left(64).to_le_bytes()
    }
}

/// A factor of at least zero with 64 significant bits at any size: a duration, 1/m, a moment of inertia.
pub trait Factor<S: Scalar>: PartialOrd + Number {
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// π.
    const PI: Self;
    /// The magnitude of `value`, exactly.
    fn from_scalar(value: S) -> Self;
    /// num / den. *Domain* den > 0.
    fn from_ratio(num: u64, den: u64) -> Self;
    /// The nearest scalar, ties to even; `None` if it does not fit.
    fn to_scalar(self) -> Option<S>;
    /// The product.
    #[must_use]
    fn times(self, rhs: Self) -> Self;
    /// The quotient. *Domain* `rhs` is not zero.
    #[must_use]
    fn over(self, rhs: Self) -> Self;
    /// The sum.
    #[must_use]
    fn plus(self, rhs: Self) -> Self;
    /// The difference, or zero if `rhs` is the larger.
    #[must_use]
    fn minus(self, rhs: Self) -> Self;

    /// The factor in fixed point: exactly, also that of a float.
    #[doc(hidden)]
    fn to_fx_factor(self) -> FxFactor;
    /// The magnitude of `value`.
    #[doc(hidden)]
    fn from_wide(value: S::Wide) -> Self;
    /// The magnitude of the difference.
    #[doc(hidden)]
    #[must_use]
    fn abs_diff(self, rhs: Self) -> Self {
        // One of the two is zero.
        self.minus(rhs).plus(rhs.minus(self))
    }
    /// Returns true for zero.
    #[doc(hidden)]
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
    /// A number below 2^64 and a shift, for which the factor is number · 2^-shift. *Domain* the factor is finite.
    #[doc(hidden)]
    fn to_binary(self) -> (u64, i32);
    /// The factor nearest to value · 2^-shift. *Domain* |shift| below 2^20.
    #[doc(hidden)]
    fn from_binary(value: u128, shift: i32) -> Self;
    /// The sum of terms, made in ascending order: it does not depend on theirs.
    #[doc(hidden)]
    fn sum(mut terms: Vec<Self>) -> Self {
        terms.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        terms.into_iter().fold(Self::ZERO, Self::plus)
    }
}

/// A signed quantity that outgrows the scalar: a force, torque, acceleration, momentum or energy.
pub trait Wide<S: Scalar>: PartialOrd + Number {
    /// Converts a scalar, exactly.
    fn from_scalar(value: S) -> Self;
    /// The value nearest to plus or minus `magnitude`; `None` if it does not fit.
    fn from_factor(magnitude: S::Factor, negative: bool) -> Option<Self>;
    /// The nearest scalar, ties to even; `None` if it does not fit.
    fn to_scalar(self) -> Option<S>;
    /// The sum; `None` if it does not fit.
    fn plus(self, rhs: Self) -> Option<Self>;
    /// The negative.
    #[must_use]
    fn negated(self) -> Self;
    /// The product; `None` if it does not fit.
    fn times(self, factor: S::Factor) -> Option<Self>;
    /// Returns true below zero.
    fn is_negative(self) -> bool;
}

/// A sum of any number of wide values, checked once at its end, so that the order of the terms never matters.
#[doc(hidden)]
pub trait Sum<S: Scalar>: Number {
    /// Adds a term.
    fn add(&mut self, term: S::Wide);
    /// The total; `None` if it does not fit.
    fn total(self) -> Option<S::Wide>;
}

/// An angle, kept within one turn.
pub trait Angle<S: Scalar>: Number {
    /// The angle of this number of radians, which may be any number of turns.
    fn from_radians(radians: S) -> Self;
    /// Radians in [0, 2π).
    fn radians(self) -> S;
    /// Sine and cosine.
    fn sin_cos(self) -> (S, S);
    /// The vector turned counter-clockwise by this angle; `None` if a component does not fit in the scalar.
    fn rotate(self, v: Vec2<S>) -> Option<Vec2<S::Wide>> {
        Self::turn(self.direction(), v)
    }
    /// The bits.
    fn to_bits(self) -> u64;

    /// The angle as a fraction of a turn: exactly, or the multiple of 2^-64 turns nearest to a float.
    #[doc(hidden)]
    fn to_turn(self) -> Turn;
    /// The angle of a fraction of a turn: exactly, or the nearest float.
    #[doc(hidden)]
    fn from_turn(turn: Turn) -> Self;
    /// The factor from an angular velocity in rad/s to the angle passed in this span.
    #[doc(hidden)]
    fn drift_factor(span: Span) -> S::Factor;
    /// The angle after turning at `velocity` rad/s for the span of `drift_factor`, backwards if `negative`.
    #[doc(hidden)]
    #[must_use]
    fn drifted(self, velocity: S, drift_factor: S::Factor, negative: bool) -> Self;
    /// The angle turned by this number of radians.
    #[doc(hidden)]
    #[must_use]
    fn turned(self, radians: S::Accumulator) -> Self;
    /// The shortest way from this angle to another, in rad between −π and π; zero for half a turn, where both ways are as long.
    #[doc(hidden)]
    fn way_to(self, goal: Self) -> S::Wide;
    /// Sine and cosine with all the bits they are computed with, to turn vectors by.
    #[doc(hidden)]
    type Direction: Copy + Debug + Default + Send + Sync;
    /// Sine and cosine of this angle with all their bits.
    #[doc(hidden)]
    fn direction(self) -> Self::Direction;
    /// A vector turned by the angle of a direction; `None` if a component does not fit in the scalar.
    #[doc(hidden)]
    fn turn(direction: Self::Direction, v: Vec2<S>) -> Option<Vec2<S::Wide>>;
}

/// A number type the engine runs on: [`Fx`], which carries the promises, or `f32` and `f64` (feature `float`) to compare with.
///
/// The trait is sealed: nothing else implements it. Operators of `Fx` panic on overflow in every profile; the engine's own
/// arithmetic goes through the associated types, whose ranges are proved in [`limits`](crate::limits).
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a number type of the engine",
    label = "write a constant as `fx!(1)` or `fx!(0.5)`",
    note = "a world computes in `Fx`; values known at run time convert by `Fx::from(integer)` or `Fx::from_ratio(a, b)`"
)]
pub trait Scalar:
    Copy
    + Debug
    + Default
    + Display
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Number
    + Arithmetic<Self>
    + Motion<Self>
    + Bulk<Self>
    + Forces<Self>
    + Polygons<Self>
    + Compiled<Self>
{
    /// Components of positions and velocities.
    type Accumulator: Accumulator<Self>;
    /// Durations, inverse masses, moments of inertia.
    type Factor: Factor<Self>;
    /// Angles.
    type Angle: Angle<Self>;
    /// Forces, torques, accelerations, momenta, energies.
    type Wide: Wide<Self>;
    /// Sums of [`Wide`](Self::Wide) values.
    #[doc(hidden)]
    type Sum: Sum<Self>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The name in tables and on the command line.
    const NAME: &'static str;

    /// Converts an `Fx`: exactly, or to the nearest float.
    fn from_fx(value: Fx) -> Self;
    /// The nearest `Fx`, or the nearest end of its range; 0 of a NaN. Odd within the range.
    #[doc(hidden)]
    fn to_fx(self) -> Fx;
    /// The bits.
    fn to_bits(self) -> i64;
    /// Returns false for the infinities and NaNs of a float; an `Fx` is always finite.
    fn is_finite(self) -> bool;
}

/// Products, differences and functions of scalars.
#[doc(hidden)]
pub trait Arithmetic<S: Scalar>: Sized {
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The product, exactly.
    fn product(self, rhs: Self) -> S::Wide;
    /// The difference `self − other`, exactly.
    fn offset(self, rhs: Self) -> S::Wide;
    /// The product of a difference in m and a force in N, in N·m; `None` if it does not fit.
    fn torque(arm: S::Wide, force: S::Wide) -> Option<S::Wide>;
    /// The product, rounded to nearest, ties to even; `None` if it does not fit.
    fn times(self, rhs: Self) -> Option<Self>;
}
