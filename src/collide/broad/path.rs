//! The way of a box through a tree.

/// The way of a box along a straight line, as a query casts it; of a ray the box is a point.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// The upper and the lower corner of the box at the start, ulps: subtracted from the lower and the upper corner of another box
    /// they leave the box of all differences.
    start: [[i64; 2]; 2],
    translation: [i64; 2],
    /// The box around the path from its start to its present end, relative to the start.
    low: [i64; 2],
    high: [i64; 2],
}

impl Path {
    /// The path of the box from `min` to `max`, in ulps, over a translation. *Domain* the translation is at most 2^52 ulps in each
    /// component.
    #[must_use]
    pub fn new(min: [i64; 2], max: [i64; 2], translation: [i64; 2]) -> Self {
        let [low, high] = [translation.map(|part| part.min(0)), translation.map(|part| part.max(0))];
        Self { start: [max, min], translation, low, high }
    }

    /// Cuts the path off at a fraction of the whole, in units of 2^-62: it keeps the part up to there, and up to an ulp more.
    pub fn shorten(&mut self, fraction: u64) {
        for k in 0..2 {
            // Below 2^53·2^62.
            let product = i128::from(self.translation[k]) * i128::from(fraction);
            let (down, up) = ((product >> 62) as i64, -((-product >> 62) as i64));
            (self.low[k], self.high[k]) = (down.min(0), up.max(0));
        }
    }
}

/// A path in the coarse units of a tree.
///
/// All is rounded so that boxes which the path meets are met here. Sizes: boxes are from 0 to 2^30 + 1, the path is at most 2^30 + 1 long
/// in each component, and so is, relative to the start, the part of a box beside the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    /// The start of the [`Path`] seen from the corner of the tree: rounded up and down.
    start: [[i64; 2]; 2],
    low: [i64; 2],
    high: [i64; 2],
    /// The direction: its larger component is from 2^29 to 2^30; 0 if the path is a point. *Error* 1 in each component.
    direction: [i64; 2],
    /// The most by which a product with the direction may be wrong.
    slack: i64,
    unit: u32,
}

impl Walk {
    pub(super) fn new(path: &Path, base: [i64; 2], unit: u32) -> Self {
        let largest = path.translation[0].unsigned_abs().max(path.translation[1].unsigned_abs());
        let bits = u64::BITS as i32 - largest.leading_zeros() as i32;
        let direction = path.translation.map(|part| match 30 - bits {
            left @ 0.. => part << left.min(29),
            right => part >> -right,
        });
        // Far away is far away: nothing that is in a tree is beyond 2^42.
        const FAR: i128 = 1 << 44;
        let down = |part: i64, base: i64| ((i128::from(part) - i128::from(base)) >> unit).clamp(-FAR, FAR) as i64;
        let up = |part: i64, base: i64| (-((i128::from(base) - i128::from(part)) >> unit)).clamp(-FAR, FAR) as i64;
        let [max, min] = path.start;
        let start = [[0, 1].map(|k| up(max[k], base[k])), [0, 1].map(|k| down(min[k], base[k]))];
        let mut walk = Self { start, low: [0; 2], high: [0; 2], direction, slack: 0, unit };
        walk.follow(path);
        walk
    }

    /// Takes over the end of the path.
    #[inline(always)]
    pub(super) fn follow(&mut self, path: &Path) {
        self.low = path.low.map(|part| part >> self.unit);
        self.high = path.high.map(|part| -(-part >> self.unit));
        // Both components of the direction are wrong by up to 1, times the components of the point.
        self.slack = self.high[0] - self.low[0] + self.high[1] - self.low[1];
    }

    /// Returns true if the path meets a box, and perhaps if it passes it within 4 units.
    #[inline(always)]
    pub(super) fn meets(&self, min: [i32; 2], max: [i32; 2]) -> bool {
        // The box of all differences, as far as the path goes: it is met by the line of the path if it is met by the path.
        let low = [0, 1].map(|k| (i64::from(min[k]) - self.start[0][k]).max(self.low[k]));
        let high = [0, 1].map(|k| (i64::from(max[k]) - self.start[1][k]).min(self.high[k]));
        // The corners that are farthest to both sides of the line. Where there is such a box, products are below 2^61.
        let [x, y] = self.direction;
        let (right, left) = if x >= 0 { (low[1], high[1]) } else { (high[1], low[1]) };
        let (x_right, x_left) = (x.wrapping_mul(right), x.wrapping_mul(left));
        let (right, left) = if y >= 0 { (high[0], low[0]) } else { (low[0], high[0]) };
        let (y_right, y_left) = (y.wrapping_mul(right), y.wrapping_mul(left));
        (low[0] <= high[0])
            & (low[1] <= high[1])
            & (x_right.wrapping_sub(y_right) <= self.slack)
            & (y_left.wrapping_sub(x_left) <= self.slack)
    }

    /// Returns true if a box, by its corners, is nearer to the start than another one, along the path.
    #[inline(always)]
    pub(super) fn is_before(&self, [min, max]: [[i32; 2]; 2], [other_min, other_max]: [[i32; 2]; 2]) -> bool {
        let sum = |a: i32, b: i32| i64::from(a) + i64::from(b);
        // Below 2^32·2^30, and 2^63 in sum.
        let along = |k: usize| (sum(min[k], max[k]) - sum(other_min[k], other_max[k])) * self.direction[k];
        along(0) + along(1) <= 0
    }
}
