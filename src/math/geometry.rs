//! Geometry of vectors of `Fx`: each result rounded once, from exact integers.

use super::Vec2;
use crate::fx::{Fx, fitting};
use crate::kernel::round::{shr_round, shr_round_u};
use crate::kernel::sqrt::over_root;

impl Vec2 {
    /// The length √(x² + y²).
    ///
    /// *Error* ½ ulp: the nearest value, and there are no ties. *Source* the exact root of the exact sum ([`Fx::checked_hypot`]).
    ///
    /// # Panics
    /// When it does not fit; [`checked_length`](Self::checked_length) gives `None`.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx, vec2};
    /// let (a, b) = (vec2(3, 4), vec2(Fx::MAX, Fx::MAX));
    /// assert_eq!((a.length(), a.distance(vec2(0, 8)), b.checked_length()), (fx!(5), fx!(5), None));
    /// assert_eq!((a.checked_distance(b), b.wide_length() > Fx::MAX.into()), (None, true));
    /// ```
    #[doc(alias = "magnitude")]
    #[must_use]
    #[track_caller]
    pub fn length(self) -> Fx {
        fitting(self.checked_length(), "Vec2: the length does not fit")
    }

    /// The length; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn checked_length(self) -> Option<Fx> {
        self.x.checked_hypot(self.y)
    }

    /// The distance between two points. *Error* ½ ulp: the nearest value, and there are no ties.
    ///
    /// # Panics
    /// When it does not fit; [`checked_distance`](Self::checked_distance) gives `None`.
    #[must_use]
    #[track_caller]
    pub fn distance(self, point: Self) -> Fx {
        fitting(self.checked_distance(point), "Vec2: the distance does not fit")
    }

    /// The distance between two points; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn checked_distance(self, point: Self) -> Option<Fx> {
        // A difference that does not fit is a distance that does not.
        point.checked_sub(self)?.checked_length()
    }

    /// The distance between two points, squared: (x' − x)² + (y' − y)². *Error* ½ ulp: the exact sum, rounded once, ties to even.
    ///
    /// # Panics
    /// When it does not fit, which is from 46.3 km on; [`checked_distance_squared`](Self::checked_distance_squared) gives `None`.
    ///
    /// ```
    /// # use umbra_physics::{fx, vec2};
    /// let (a, b) = (vec2(3, 4), vec2(0, 8));
    /// assert_eq!((a.length_squared(), a.distance_squared(b)), (fx!(25), fx!(25)));
    /// let far = vec2(50_000, 0);
    /// assert_eq!((far.checked_length_squared(), far.checked_distance_squared(a)), (None, None));
    /// assert!(far.distance(a) > fx!(49_996)); // a distance that is not squared fits
    /// ```
    #[must_use]
    #[track_caller]
    pub fn distance_squared(self, point: Self) -> Fx {
        fitting(self.checked_distance_squared(point), "Vec2: the square of the distance does not fit")
    }

    /// The distance between two points, squared; `None` if it does not fit. *Error* ½ ulp.
    #[must_use]
    pub fn checked_distance_squared(self, point: Self) -> Option<Fx> {
        // A difference that does not fit has a square that does not.
        point.checked_sub(self)?.checked_length_squared()
    }

    /// The length squared, x² + y². *Error* ½ ulp: the exact sum, rounded once, ties to even.
    ///
    /// # Panics
    /// When it does not fit; [`checked_length_squared`](Self::checked_length_squared) gives `None`.
    #[must_use]
    #[track_caller]
    pub fn length_squared(self) -> Fx {
        fitting(self.checked_length_squared(), "Vec2: the square of the length does not fit")
    }

    /// The length squared; `None` if it does not fit. *Error* ½ ulp. [`wide_dot`](Self::wide_dot) of the vector with itself is exact.
    #[must_use]
    pub fn checked_length_squared(self) -> Option<Fx> {
        // At most 2^127 in units of 2^-64, so at most 2^95 here.
        Fx::narrow(shr_round_u(self.squares(), 32) as i128)
    }

    /// The vector of length 1 in this direction; `None` for the zero vector.
    ///
    /// *Domain* all. *Error* ½ ulp in each component: the nearest value, and there are no ties. *Source* the component over
    /// the root of the exact sum of squares, settled against the exact square.
    ///
    /// ```
    /// # use umbra_physics::{Fx, Vec2, fx, vec2};
    /// let a = vec2(3, -4);
    /// assert_eq!((a.normalize(), Vec2::ZERO.normalize()), (Some(vec2(fx!(0.6), fx!(-0.8))), None::<Vec2>));
    /// assert_eq!((a.clamp_length(fx!(10)), a.clamp_length(fx!(1))), (a, vec2(fx!(0.6), fx!(-0.8))));
    /// ```
    #[must_use]
    pub fn normalize(self) -> Option<Self> {
        (self != Self::default()).then(|| self.of_length(Fx::ONE))
    }

    /// The vector itself, or shortened to the length `max` if it is longer.
    ///
    /// *Domain* max ≥ 0. *Error* ½ ulp in each component: the nearest value, and there are no ties. Rounding may leave a
    /// shortened vector up to √½ ulp longer than `max`.
    ///
    /// # Panics
    /// When `max` is negative.
    #[must_use]
    #[track_caller]
    pub fn clamp_length(self, max: Fx) -> Self {
        assert!(max >= Fx::ZERO, "Vec2::clamp_length: a length is not negative");
        let most_squared = u128::from(max.to_bits().unsigned_abs()).pow(2);
        if self.squares() <= most_squared { self } else { self.of_length(max) }
    }

    /// x² + y², at most 2^127, in units of 2^-64.
    fn squares(self) -> u128 {
        let square = |c: Fx| u128::from(c.to_bits().unsigned_abs()).pow(2);
        square(self.x) + square(self.y)
    }

    /// The vector of this length in this direction. *Domain* not the zero vector, length ≥ 0.
    fn of_length(self, length: Fx) -> Self {
        let squares = self.squares();
        self.map(|c| {
            let magnitude = over_root(c.to_bits().unsigned_abs(), length.to_bits().unsigned_abs(), squares) as i64;
            // At most the length, which fits.
            Fx::from_bits(if c < Fx::ZERO { -magnitude } else { magnitude })
        })
    }

    /// The point between two: this one at t = 0, `end` at t = 1, and on the line through both elsewhere.
    ///
    /// *Error* ½ ulp in each component: x + (x' − x)·t exactly, rounded once, ties to even.
    ///
    /// # Panics
    /// When a component does not fit, as it may for t outside [0, 1]; [`checked_lerp`](Self::checked_lerp) gives `None`.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx, vec2};
    /// let (a, b) = (vec2(1, Fx::MIN), vec2(2, Fx::MAX));
    /// assert_eq!((a.lerp(b, fx!(0)), a.lerp(b, fx!(1)), a.lerp(b, Fx::HALF).x), (a, b, fx!(1.5)));
    /// assert_eq!(a.checked_lerp(b, fx!(2)), None);
    /// ```
    #[must_use]
    #[track_caller]
    pub fn lerp(self, end: Self, t: Fx) -> Self {
        fitting(self.checked_lerp(end, t), "Vec2: the point does not fit")
    }

    /// The point between two; `None` if a component does not fit. *Error* ½ ulp. See [`lerp`](Self::lerp).
    #[must_use]
    pub fn checked_lerp(self, end: Self, t: Fx) -> Option<Self> {
        let component = |from: Fx, to: Fx| {
            let way = i128::from(to.to_bits()) - i128::from(from.to_bits());
            // Below 2^64 times at most 2^63. A sum beyond 2^127 is beyond 2^31 m as well.
            let passed = way * i128::from(t.to_bits());
            Fx::narrow(shr_round(passed.checked_add(i128::from(from.to_bits()) << 32)?, 32))
        };
        Some(Self { x: component(self.x, end.x)?, y: component(self.y, end.y)? })
    }

    /// The smaller of each component.
    ///
    /// ```
    /// # use umbra_physics::{Fx, vec2};
    /// let (a, b) = (vec2(1, -5), vec2(2, 4));
    /// assert_eq!((a.min(b), a.max(b), a.abs()), (vec2(1, -5), vec2(2, 4), vec2(1, 5)));
    /// assert_eq!(vec2(0, Fx::MIN).checked_abs(), None);
    /// ```
    #[must_use]
    pub fn min(self, rhs: Self) -> Self {
        Self { x: self.x.min(rhs.x), y: self.y.min(rhs.y) }
    }

    /// The larger of each component.
    #[must_use]
    pub fn max(self, rhs: Self) -> Self {
        Self { x: self.x.max(rhs.x), y: self.y.max(rhs.y) }
    }

    /// The magnitude of each component.
    ///
    /// # Panics
    /// When a component is [`Fx::MIN`]; [`checked_abs`](Self::checked_abs) gives `None`.
    #[must_use]
    #[track_caller]
    pub fn abs(self) -> Self {
        fitting(self.checked_abs(), "Vec2: the magnitude does not fit")
    }

    /// The magnitude of each component; `None` if one is [`Fx::MIN`].
    #[must_use]
    pub fn checked_abs(self) -> Option<Self> {
        self.try_map(Fx::checked_abs)
    }

    /// The sum; `None` if a component does not fit.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx, vec2};
    /// let (a, b) = (vec2(1, 2), vec2(Fx::MAX, 0));
    /// assert_eq!((a.checked_add(b), b.checked_sub(-a), a.checked_add(a)), (None, None, Some(vec2(2, 4))));
    /// assert_eq!((b.checked_scale(fx!(2)), a.checked_div(fx!(0)), a.checked_div(fx!(2))), (None, None, Some(vec2(fx!(0.5), 1))));
    /// ```
    #[must_use]
    pub fn checked_add(self, rhs: Self) -> Option<Self> {
        Some(Self { x: self.x.checked_add(rhs.x)?, y: self.y.checked_add(rhs.y)? })
    }

    /// The difference; `None` if a component does not fit.
    #[must_use]
    pub fn checked_sub(self, rhs: Self) -> Option<Self> {
        Some(Self { x: self.x.checked_sub(rhs.x)?, y: self.y.checked_sub(rhs.y)? })
    }

    /// Each component over `divisor`; `None` if one does not fit or `divisor` is zero. *Error* ½ ulp.
    #[must_use]
    pub fn checked_div(self, divisor: Fx) -> Option<Self> {
        self.try_map(|c| c.checked_div(divisor))
    }
}

impl core::iter::Sum for Vec2 {
    /// The sum, exactly, whatever the order of the terms.
    ///
    /// # Panics
    /// When the total does not fit.
    #[track_caller]
    fn sum<I: Iterator<Item = Self>>(vectors: I) -> Self {
        // 2^64 terms of at most 2^63 would leave i128.
        let add = |(x, y): (i128, i128), v: Self| (x + i128::from(v.x.to_bits()), y + i128::from(v.y.to_bits()));
        let (x, y) = vectors.fold((0, 0), add);
        let total = || Some(Self { x: Fx::narrow(x)?, y: Fx::narrow(y)? });
        fitting(total(), "Vec2: the sum does not fit")
    }
}
