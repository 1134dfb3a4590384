//! Boxes in ulps.

use crate::fx::Fx;
use crate::shape::Aabb;

/// A box in ulps, sides included. All of `i64` is its domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bounds {
    pub(super) min: [i64; 2],
    pub(super) max: [i64; 2],
}

impl Bounds {
    /// The box without points: the union with it is the other box.
    pub(super) const EMPTY: Self = Self { min: [i64::MAX; 2], max: [i64::MIN; 2] };

    pub(super) fn overlaps(&self, bounds: &Self) -> bool {
        // All four, without a branch between them: which one fails follows no pattern.
        (self.min[0] <= bounds.max[0])
            & (bounds.min[0] <= self.max[0])
            & (self.min[1] <= bounds.max[1])
            & (bounds.min[1] <= self.max[1])
    }

    pub(super) fn contains(&self, bounds: &Self) -> bool {
        (self.min[0] <= bounds.min[0])
            & (bounds.max[0] <= self.max[0])
            & (self.min[1] <= bounds.min[1])
            & (bounds.max[1] <= self.max[1])
    }

    pub(super) fn union(&self, bounds: &Self) -> Self {
        Self {
            min: [0, 1].map(|k| self.min[k].min(bounds.min[k])),
            max: [0, 1].map(|k| self.max[k].max(bounds.max[k])),
        }
    }

    /// The middle along an axis, within an ulp.
    pub(super) fn centre(&self, axis: usize) -> i64 {
        (self.min[axis] >> 1) + (self.max[axis] >> 1)
    }

    /// The lengths of the sides, each from 0 to 2^63 - 1.
    pub(super) fn sides(&self) -> [i64; 2] {
        [0, 1].map(|k| self.max[k].saturating_sub(self.min[k]).max(0))
    }

    /// Half the perimeter, in units of 8 ulp, so that it is at most 2^62. *Error* 2 units.
    pub(super) fn half_perimeter(&self) -> i64 {
        let side = |k: usize| (self.max[k] >> 3) - (self.min[k] >> 3);
        side(0) + side(1)
    }
}

impl From<Aabb<Fx>> for Bounds {
    fn from(bounds: Aabb<Fx>) -> Self {
        let bits = |x: Fx, y: Fx| [x.to_bits(), y.to_bits()];
        Self { min: bits(bounds.min.x, bounds.min.y), max: bits(bounds.max.x, bounds.max.y) }
    }
}
