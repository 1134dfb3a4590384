//! The operations of floats that contacts need.

use core::ops::{AddAssign, Div, Mul};

use crate::scalar::{Angle, Scalar, ToF64};

/// A vector in the plane.
pub(super) type Pair<F> = [F; 2];
/// Components x, y and angular.
pub(super) type Vector<F> = [F; 3];

/// A float as a scalar: all companion types are the float itself.
#[doc(hidden)]
pub trait Float:
    Scalar<Accumulator = Self, Factor = Self, Angle = Self, Wide = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + ToF64
{
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The nearest one to a double.
    fn of(value: f64) -> Self;
    /// The square root.
    #[must_use]
    fn root(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn direction(self) -> Pair<Self>;
    /// The shortest way from this angle to another, rad.
    #[must_use]
    fn way(self, goal: Self) -> Self;

    /// The magnitude.
    #[must_use]
    fn size(self) -> Self {
        if self < Self::of(0.0) { -self } else { self }
    }
    /// The larger one.
    #[must_use]
    fn or_more(self, other: Self) -> Self {
        if self < other { other } else { self }
    }
    /// The smaller one.
    #[must_use]
    fn or_less(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// Within ±limit.
    #[must_use]
    fn within(self, limit: Self) -> Self {
        self.or_less(limit).or_more(-limit)
    }
}

macro_rules! float {
    ($float:ident, $sqrt:ident, $sin:ident, $cos:ident) => {
        impl Float for $float {
            const EPSILON: Self = $float::EPSILON;

            fn of(value: f64) -> Self {
                value as Self
            }
            fn root(self) -> Self {
                libm::$sqrt(self)
            }
            fn direction(self) -> Pair<Self> {
                [libm::$sin(self), libm::$cos(self)]
            }
            fn way(self, goal: Self) -> Self {
                Angle::way_to(self, goal)
            }
        }
    };
}

float!(f32, sqrtf, sinf, cosf);
float!(f64, sqrt, sin, cos);

pub(super) fn dot<F: Float, const N: usize>(a: [F; N], b: [F; N]) -> F {
    a.into_iter().zip(b).fold(F::of(0.0), |sum, (a, b)| sum + a * b)
}

pub(super) fn cross<F: Float>(a: Pair<F>, b: Pair<F>) -> F {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn minus<F: Float>(a: Pair<F>, b: Pair<F>) -> Pair<F> {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn plus<F: Float>(a: Pair<F>, b: Pair<F>) -> Pair<F> {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn times<F: Float>(a: Pair<F>, by: F) -> Pair<F> {
    a.map(|part| part * by)
}

/// The length. *Domain* its square fits.
pub(super) fn length<F: Float>(a: Pair<F>) -> F {
    dot(a, a).root()
}
