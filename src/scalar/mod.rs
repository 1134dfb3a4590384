//! Number types: what the engine asks of a scalar.
//!
//! [`Fx`](crate::Fx) is the type that carries the promises; `f32` and `f64` (feature `float`) build the same engine to compare
//! with. A quantity that does not fit in the scalar itself has a type of its own beside it:
//!
//! | trait | type of `Fx` | range and resolution | quantities |
//! |---|---|---|---|
//! | [`Scalar`] | [`Fx`](crate::Fx) | multiples of 2^-32 up to 2^31 | all that goes in and out |
//! | [`Accumulator`] | [`FxAccumulator`] | multiples of 2^-96 up to 2^31 | positions and velocities |
//! | [`Factor`] | [`FxFactor`] | 64 significant bits and an exponent | time steps, damping factors, 1/m, inertia, G·M |
//! | [`Wide`] | [`FxWide`] | multiples of 2^-64 up to 2^63 | force, torque, acceleration, energy: the exact product of two `Fx` |
//! | | [`FxSum`] | [`FxWide`] in 192 bits | sums whose order must not matter |
//! | [`Angle`] | [`Turn`] | multiples of 2^-64 turns | angles |
//!
//! For a float all of them are the float. The types of `Fx` have methods of their own: the traits are needed only in code that
//! is generic over the scalar. They are sealed.
//!
//! ```
//! use umbra_physics::scalar::{Accumulator as _, Angle as _, Factor as _, Scalar, Wide as _};
//! use umbra_physics::{BodyRef, Fx, fx};
//!
//! /// Twice the kinetic energy of the motion along x, J, with any scalar: m·v².
//! fn energy<S: Scalar>(body: &BodyRef<'_, S>, mass: S) -> Option<S::Wide> {
//!     let speed = S::Factor::from_scalar(body.velocity_exact().x.value());
//!     S::Wide::from_factor(speed.times(speed).times(S::Factor::from_scalar(mass)), false)
//! }
//! // Positions are the scalar and a finer fraction; angles wrap by themselves.
//! assert_eq!(<Fx as Scalar>::Accumulator::from_scalar(fx!(1.5)).value(), fx!(1.5));
//! assert_eq!(<Fx as Scalar>::Angle::from_radians(Fx::FRAC_PI_2).sin_cos(), (fx!(1), fx!(0)));
//! ```

mod accumulator;
mod bulk;
#[cfg(test)]
mod checks;
mod factor;
mod factor_text;
#[cfg(feature = "float")]
mod float;
#[cfg(feature = "draw")]
mod float_angle;
mod forces;
mod fx_bulk;
mod fx_number;
#[doc(hidden)]
pub mod internals;
mod motion;
mod number;
mod polygon;
#[cfg(feature = "serde")]
mod serial;
mod simd;
#[cfg(feature = "draw")]
mod to_f64;
mod turn;
mod vectors;
mod wide;

pub use accumulator::FxAccumulator;
pub use factor::FxFactor;
#[cfg(feature = "draw")]
pub(crate) use float_angle::FloatAngle;
pub use forces::SpringConstants;
pub(crate) use forces::exponential;
pub use number::{Accumulator, Angle, Factor, Scalar, Wide};
#[cfg(feature = "draw")]
pub use to_f64::ToF64;
pub use turn::Turn;
pub use wide::{FxSum, FxWide};

pub(crate) use bulk::{DampedTurn, KickDriftKick};
pub(crate) use motion::{Decay, KICK_LOG2, Span, TRANSIENT_SPEED_LOG2, Weight};
pub(crate) use number::{Number, Sum};

/// A vector of wide components: the offset between two points in m, a force in N.
pub(crate) type Offset<S> = crate::math::Vec2<<S as Scalar>::Wide>;
