//! Vectors of two components.

use core::fmt;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::fx::{Fx, IntoFx};

/// A vector of two components, or a pair of any `T`.
///
/// Operators work component by component, as the operator of the component does: those of `Fx` round to nearest, ties to
/// even, and panic when a result does not fit.
///
/// ```
/// use umbra_physics::{Fx, fx, vec2};
///
/// let (a, b) = (vec2(3, 4), vec2(1, fx!(0.5)));
/// assert_eq!((a + b, a - b, -a), (vec2(4, fx!(4.5)), vec2(2, fx!(3.5)), vec2(-3, -4)));
/// assert_eq!((a * fx!(0.5), fx!(0.5) * a, a / fx!(0.5)), (vec2(fx!(1.5), 2), vec2(fx!(1.5), 2), vec2(6, 8)));
/// assert_eq!((a * 2, 2 * a, a / 2), (vec2(6, 8), vec2(6, 8), vec2(fx!(1.5), 2)));
/// assert_eq!(a.perp(), vec2(-4, 3)); // a quarter turn to the left
/// assert_eq!((a.dot(b), a.cross(b), a.length()), (fx!(5), fx!(-2.5), fx!(5)));
/// assert_eq!(a.map(Fx::to_bits).x, 3 << 32);
/// assert_eq!(a.try_map(|c| c.checked_mul(Fx::MAX)), None); // does not fit
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Vec2<T = Fx> {
    /// Component along x, to the right.
    pub x: T,
    /// Component along y, upwards.
    pub y: T,
}

/// The vector (x, y), from `Fx` and integers. [`Vec2::new`] takes components of any type.
///
/// ```
/// use umbra_physics::{fx, vec2};
/// let gravity = vec2(0, fx!(-9.81));
/// assert_eq!((gravity.x, gravity.y), (fx!(0), fx!(-9.81)));
/// ```
#[inline]
pub fn vec2(x: impl IntoFx, y: impl IntoFx) -> Vec2 {
    Vec2 { x: x.into(), y: y.into() }
}

impl<T> Vec2<T> {
    /// The vector (x, y).
    #[inline]
    #[must_use]
    pub const fn new(x: T, y: T) -> Self {
        Self { x, y }
    }

    /// Applies `f` to each component.
    #[inline]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Vec2<U> {
        Vec2 { x: f(self.x), y: f(self.y) }
    }

    /// Applies `f` to each component; `None` if either result is.
    #[inline]
    pub fn try_map<U>(self, mut f: impl FnMut(T) -> Option<U>) -> Option<Vec2<U>> {
        Some(Vec2 { x: f(self.x)?, y: f(self.y)? })
    }
}

impl<T: Neg<Output = T>> Vec2<T> {
    /// The vector turned by a quarter turn counter-clockwise: (−y, x), exactly.
    ///
    /// # Panics
    /// When y is [`Fx::MIN`], whose negative does not fit.
    #[inline]
    #[must_use]
    #[track_caller]
    pub fn perp(self) -> Self {
        Self { x: -self.y, y: self.x }
    }
}

impl<T> From<(T, T)> for Vec2<T> {
    #[inline]
    fn from((x, y): (T, T)) -> Self {
        Self { x, y }
    }
}

impl<T> From<Vec2<T>> for (T, T) {
    #[inline]
    fn from(v: Vec2<T>) -> Self {
        (v.x, v.y)
    }
}

impl<T> From<[T; 2]> for Vec2<T> {
    #[inline]
    fn from([x, y]: [T; 2]) -> Self {
        Self { x, y }
    }
}

impl<T> From<Vec2<T>> for [T; 2] {
    #[inline]
    fn from(v: Vec2<T>) -> Self {
        [v.x, v.y]
    }
}

/// An operator between two vectors, and its assigning form.
macro_rules! between_vectors {
    ($operator:ident, $method:ident, $assign:ident, $assign_method:ident) => {
        impl<T: $operator<Output = T>> $operator for Vec2<T> {
            type Output = Self;

            #[inline]
            #[track_caller]
            fn $method(self, other: Self) -> Self {
                Self { x: self.x.$method(other.x), y: self.y.$method(other.y) }
            }
        }

        impl<T: $operator<Output = T> + Copy> $assign for Vec2<T> {
            #[inline]
            #[track_caller]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    };
}

between_vectors!(Add, add, AddAssign, add_assign);
between_vectors!(Sub, sub, SubAssign, sub_assign);

/// An operator between a vector and a number, and its assigning form. The generics of the impl stand first.
macro_rules! with_a_number {
    ([$($generics:tt)*] $vector:ty, $number:ty, $operator:ident, $method:ident, $assign:ident, $assign_method:ident) => {
        impl<$($generics)*> $operator<$number> for $vector {
            type Output = Self;

            #[inline]
            #[track_caller]
            fn $method(self, number: $number) -> Self {
                Self { x: self.x.$method(number), y: self.y.$method(number) }
            }
        }

        impl<$($generics)*> $assign<$number> for $vector {
            #[inline]
            #[track_caller]
            fn $assign_method(&mut self, number: $number) {
                *self = self.$method(number);
            }
        }
    };
}

with_a_number!([T: Mul<Output = T> + Copy] Vec2<T>, T, Mul, mul, MulAssign, mul_assign);
with_a_number!([T: Div<Output = T> + Copy] Vec2<T>, T, Div, div, DivAssign, div_assign);
with_a_number!([] Vec2, i32, Mul, mul, MulAssign, mul_assign);
with_a_number!([] Vec2, i32, Div, div, DivAssign, div_assign);

/// A number times a vector.
macro_rules! number_first {
    ($number:ty) => {
        impl Mul<Vec2> for $number {
            type Output = Vec2;

            #[inline]
            #[track_caller]
            fn mul(self, v: Vec2) -> Vec2 {
                v * self
            }
        }
    };
}

number_first!(Fx);
number_first!(i32);

impl<T: Neg<Output = T>> Neg for Vec2<T> {
    type Output = Self;

    #[inline]
    #[track_caller]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

impl<T: fmt::Display> fmt::Display for Vec2<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        self.x.fmt(f)?;
        f.write_str(", ")?;
        self.y.fmt(f)?;
        f.write_str(")")
    }
}
