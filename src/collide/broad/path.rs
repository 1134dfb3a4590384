//! The way of a box through a tree.

use super::bounds::Bounds;

/// The way of a box along a straight line, as a query casts it; of a ray the box is a point.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// The upper and the lower corner of the box at the start, ulps: what is subtracted from the lower and the upper corner of another box
    /// leaves the box of all differences.
    start: [[i64; 2]; 2],
    translation: [i64; 2],
    /// The box around the path from its start to its present end, relative to the start.
    low: [i64; 2],
    high: [i64; 2],
}

impl Path {
    /// The path of the box from `min` to `max`, in ulps, over a translation. *Domain* the translation is below 2^53 ulps in each component.
    #[must_use]
    pub fn new(min: [i64; 2], max: [i64; 2], translation: [i64; 2]) -> Self {
        let [low, high] = [translation.map(|part| part.min(0)), translation.map(|part| part.max(0))];
        Self { start: [max, min], translation, low, high }
    }

    /// Cuts the path off at a fraction of the whole, in units of 2^-62: it keeps what is in front of that, and up to an ulp more.
    pub fn shorten(&mut self, fraction: u64) {
        for k in 0..2 {
            // Below 2^53·2^62.
            let product = i128::from(self.translation[k]) * i128::from(fraction);
            let (down, up) = ((product >> 62) as i64, -((-product >> 62) as i64));
            (self.low[k], self.high[k]) = (down.min(0), up.max(0));
        }
    }

    /// Returns true if the box meets another one on its way. Exact but for the ulp of [`shorten`](Self::shorten).
    #[inline(always)]
    pub(super) fn meets(&self, bounds: &Bounds) -> bool {
        // The box of all differences, as far as the path goes: it is met by the line of the path if it is met by the path.
        let low = [0, 1].map(|k| bounds.min[k].saturating_sub(self.start[0][k]).max(self.low[k]));
        let high = [0, 1].map(|k| bounds.max[k].saturating_sub(self.start[1][k]).min(self.high[k]));
        if (low[0] > high[0]) | (low[1] > high[1]) {
            return false;
        }
        // The corners that are farthest to both sides of the line. Products are below 2^53·2^53.
        let [x, y] = self.translation;
        let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
        let (right, left) = if x >= 0 { (low[1], high[1]) } else { (high[1], low[1]) };
        let (least, most) = (product(x, right), product(x, left));
        let (right, left) = if y >= 0 { (high[0], low[0]) } else { (low[0], high[0]) };
        (least <= product(y, right)) & (most >= product(y, left))
    }

    /// Returns true if a box is nearer to the start than another one, along the path.
    #[inline(always)]
    pub(super) fn is_before(&self, bounds: &Bounds, other: &Bounds) -> bool {
        // Below 2^64 · 2^53, and 2^118 in sum.
        let along =
            |k: usize| (i128::from(bounds.centre(k)) - i128::from(other.centre(k))) * i128::from(self.translation[k]);
        along(0) + along(1) <= 0
    }
}
