//! Boxes along the axes.

use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// An axis-aligned box: all points from `min` to `max`, both included.
///
/// ```
/// use umbra_physics::{Aabb, Shape, fx, vec2};
///
/// let capsule = Shape::capsule(fx!(2), fx!(0.5))?;
/// assert_eq!(capsule.bounds(), Aabb { min: vec2(fx!(-1.5), fx!(-0.5)), max: vec2(fx!(1.5), fx!(0.5)) });
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Aabb<S = Fx> {
    /// The least coordinates, m.
    pub min: Vec2<S>,
    /// The greatest coordinates, m.
    pub max: Vec2<S>,
}

impl<S: Scalar> Aabb<S> {
    /// The least box around points, grown by `radius` m on each side. *Domain* at least one point, all within 2^15 m.
    pub(crate) fn around(points: &[Vec2<S>], radius: S) -> Self {
        let first = Self { min: points[0], max: points[0] };
        let tight = points.iter().fold(first, |bounds, &point| bounds.union(Self { min: point, max: point }));
        let margin = Vec2::new(radius, radius);
        Self { min: tight.min - margin, max: tight.max + margin }
    }

    /// The least box that has both in it.
    #[must_use]
    pub fn union(self, rhs: Self) -> Self {
        let least = |a: S, b: S| if b < a { b } else { a };
        let greatest = |a: S, b: S| if b > a { b } else { a };
        Self {
            min: Vec2::new(least(self.min.x, rhs.min.x), least(self.min.y, rhs.min.y)),
            max: Vec2::new(greatest(self.max.x, rhs.max.x), greatest(self.max.y, rhs.max.y)),
        }
    }

    /// Returns true if the boxes have a point in common; boxes that touch do.
    ///
    /// ```
    /// use umbra_physics::{Aabb, vec2};
    ///
    /// let at = |x: i32| Aabb { min: vec2(x, 0), max: vec2(x + 1, 1) };
    /// let boxes: [Aabb; 3] = [at(0), at(1), at(3)];
    /// assert!(boxes[0].overlaps(boxes[1]) && !boxes[1].overlaps(boxes[2]));
    /// assert!(boxes[0].union(boxes[2]).contains(vec2(2, 1)));
    /// ```
    #[must_use]
    pub fn overlaps(self, rhs: Self) -> bool {
        let meet = |from: S, to: S, other_from: S, other_to: S| from <= other_to && other_from <= to;
        meet(self.min.x, self.max.x, rhs.min.x, rhs.max.x) && meet(self.min.y, self.max.y, rhs.min.y, rhs.max.y)
    }

    /// Returns true if a point is in the box or on its edges.
    #[must_use]
    pub fn contains(self, point: Vec2<S>) -> bool {
        self.overlaps(Self { min: point, max: point })
    }
}
