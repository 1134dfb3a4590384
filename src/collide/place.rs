//! Outlines in world axes.

use crate::fx::Fx;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::scalar::Turn;
use crate::shape::Outline;

/// The place of a body: the position of its centre of mass and the direction it is turned to. Made once for all pairs of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pose {
    position: Vec2<Fx>,
    /// Sine and cosine in units of 2^-62.
    direction: (i64, i64),
}

impl Pose {
    /// The pose at this position in m and angle.
    #[must_use]
    pub fn new(position: Vec2<Fx>, angle: Turn) -> Self {
        Self { position, direction: sin_cos_turn(angle.to_bits()) }
    }

    /// From this position to another in ulps, exactly; `None` from 2^24 m on in a component, where nothing touches.
    pub(super) fn offset_to(&self, other: &Self) -> Option<[i64; 2]> {
        const FAR: i64 = 1 << (24 + 32);
        let part = |from: Fx, to: Fx| to.to_bits().checked_sub(from.to_bits()).filter(|d| -FAR < *d && *d < FAR);
        Some([part(self.position.x, other.position.x)?, part(self.position.y, other.position.y)?])
    }
}

/// An outline in world axes, relative to its body's centre of mass, with room for `N` corners, a power of two.
pub(super) struct Placed<const N: usize> {
    pub(super) count: usize,
    pub(super) faces: usize,
    /// In ulps, each rounded once. Places after the last corner repeat the first one.
    pub(super) corners: [[i64; 2]; N],
    /// In units of 2^-30.
    pub(super) normals: [[i32; 2]; N],
    low: [i64; 2],
    high: [i64; 2],
    pub(super) radius: i64,
}

/// The corners and the radius.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) corners: &'a [[i64; 2]],
    pub(super) radius: i64,
}

/// `a / 2^s` to nearest, ties away from zero: odd. *Domain* |a| <= 2^126, 0 < s < 127.
#[inline(always)]
pub(super) const fn odd_shift(a: i128, s: u32) -> i128 {
    (a + ((1 << (s - 1)) + (a >> 127))) >> s
}

/// (x, y) turned by the angle with this sine and cosine in units of 2^-62, divided by 2^(s − 62).
///
/// Coordinates are below 2^48 and the results for corners too (a corner is within 2^15 m of the centre); the products are below 2^110.
#[inline(always)]
fn turned(v: Vec2<Fx>, (sin, cos): (i64, i64), s: u32) -> [i64; 2] {
    let (x, y) = (i128::from(v.x.to_bits()), i128::from(v.y.to_bits()));
    let (sin, cos) = (i128::from(sin), i128::from(cos));
    [odd_shift(x * cos - y * sin, s) as i64, odd_shift(x * sin + y * cos, s) as i64]
}

impl<const N: usize> Placed<N> {
    #[inline(always)]
    pub(super) fn new(outline: &Outline, pose: &Pose) -> Self {
        let (corners, normals) = (outline.corners(), outline.normals());
        let first = turned(corners[0], pose.direction, 62);
        let mut placed = Self {
            count: corners.len(),
            faces: normals.len(),
            corners: [first; N],
            normals: [[0; 2]; N],
            low: first,
            high: first,
            radius: outline.radius().to_bits(),
        };
        for (place, &corner) in placed.corners.iter_mut().zip(corners).skip(1) {
            let [x, y] = turned(corner, pose.direction, 62);
            *place = [x, y];
            placed.low = [placed.low[0].min(x), placed.low[1].min(y)];
            placed.high = [placed.high[0].max(x), placed.high[1].max(y)];
        }
        // From units of 2^-32 times 2^-62 to units of 2^-30; at most 2^30 + 1.
        for (place, &normal) in placed.normals.iter_mut().zip(normals) {
            *place = turned(normal, pose.direction, 64).map(|part| part as i32);
        }
        placed
    }

    /// The largest coordinate of a corner, below 2^48.
    pub(super) fn extent(&self) -> i64 {
        self.high[0].max(self.high[1]).max(-self.low[0]).max(-self.low[1])
    }

    /// Returns true if the boxes around the cores are more than `limit` apart. All terms are below 2^57.
    pub(super) fn is_clear_of(&self, other: &Self, offset: [i64; 2], limit: i64) -> bool {
        let gap = |i: usize| (other.low[i] + offset[i] - self.high[i]).max(self.low[i] - other.high[i] - offset[i]);
        gap(0) > limit || gap(1) > limit
    }

    pub(super) fn view(&self) -> View<'_> {
        View { corners: &self.corners, radius: self.radius }
    }
}
