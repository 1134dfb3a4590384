//! Cores at the place of their body.

use alloc::vec::Vec;

use super::{Point, cross, edge, from_to};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Angle, Scalar, Turn, Wide};
use crate::shape::Outline;

/// Nothing is looked at from this distance on along an axis, 2^53 ulps: [`limits::QUERY`](crate::limits::QUERY), and twice 2^15 m for
/// shapes.
const FAR: i64 = 1 << 53;

/// The position and the direction of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<S: Scalar> {
    position: Point,
    /// `None` for a body that is not turned.
    direction: Option<<S::Angle as Angle<S>>::Direction>,
}

impl<S: Scalar> Placement<S> {
    pub(crate) fn new(position: Vec2<S>, angle: S::Angle) -> Self {
        let is_turned = angle != S::Angle::default();
        Self { position: ulps(position), direction: is_turned.then(|| angle.direction()) }
    }

    /// The position, ulps.
    pub(crate) fn position(&self) -> Point {
        self.position
    }
}

/// A hash of a collider, by its digest, at a place of its body: where two are alike, queries find the same.
pub(crate) fn place_digest(collider: u64, position: Vec2, angle: Turn) -> u64 {
    let [x, y] = ulps(position).map(|part| part as u64);
    // The golden ratio; both halves of the product depend on all bits.
    let fold = |hash: u64, word: u64| {
        let product = u128::from(hash ^ word) * 0x9E37_79B9_7F4A_7C15;
        product as u64 ^ (product >> 64) as u64
    };
    [x, y, angle.to_bits()].into_iter().fold(collider, |hash, word| fold(hash.rotate_left(23), word))
}

/// A vector in ulps: that of a float to nearest, and the nearest end of the range if it is beyond.
#[inline(always)]
pub(super) fn ulps<S: Scalar>(v: Vec2<S>) -> Point {
    [v.x.to_fx().to_bits(), v.y.to_fx().to_bits()]
}

/// A convex core in world axes: its corners relative to some point, counter-clockwise, no three of them on one line.
#[derive(Clone, Debug, Default)]
pub(crate) struct Core {
    few: [Point; 8],
    count: usize,
    /// All corners, where there are more than 8.
    many: Vec<Point>,
    /// ulps.
    pub(crate) radius: i64,
}

impl Core {
    /// The core of an outline of a body, seen from a point; `None` if it is out of reach.
    #[inline]
    pub(crate) fn new<S: Scalar>(outline: &Outline<S>, at: &Placement<S>, from: Point) -> Option<Self> {
        let part = |i: usize| at.position[i].checked_sub(from[i]).filter(|d| -FAR < *d && *d < FAR);
        let offset = [part(0)?, part(1)?];
        let mut core = Self { radius: outline.radius().to_fx().to_bits(), ..Self::default() };
        for &corner in outline.corners() {
            let corner = match at.direction {
                None => corner,
                // Corners are below 2^15 m, so that they fit wherever they are turned to.
                Some(direction) => {
                    let turned = S::Angle::turn(direction, corner);
                    turned.and_then(|turned| turned.try_map(Wide::to_scalar)).unwrap_or(corner)
                }
            };
            let [x, y] = ulps(corner);
            core.push([x + offset[0], y + offset[1]]);
        }
        core.make_convex();
        Some(core)
    }

    /// The core with these convex corners, in ulps, seen from a point; `None` if it is out of reach.
    #[inline]
    pub(crate) fn at(corners: &[Point], radius: i64, from: Point) -> Option<Self> {
        let first = *corners.first()?;
        // Other corners are within 2^17 m of the first one, so that their differences fit.
        let is_near = |k: usize| first[k].checked_sub(from[k]).is_some_and(|d| -FAR < d && d < FAR);
        if !is_near(0) || !is_near(1) {
            return None;
        }
        let mut core = Self { radius, ..Self::default() };
        corners.iter().for_each(|&corner| core.push(from_to(from, corner)));
        Some(core)
    }

    /// The core with these corners around an area, a line or a point, counter-clockwise, without a radius.
    pub(crate) fn around(corners: &[Point]) -> Self {
        let mut core = Self::default();
        corners.iter().for_each(|&corner| core.push(corner));
        core.make_convex();
        core
    }

    /// Takes all corners away, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.many.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, corner: Point) {
        match self.few.get_mut(self.count) {
            Some(place) => *place = corner,
            None => {
                if self.many.is_empty() {
                    self.many.extend_from_slice(&self.few);
                }
                self.many.push(corner);
            }
        }
        self.count += 1;
    }

    #[inline(always)]
    pub(crate) fn corners(&self) -> &[Point] {
        self.few.get(..self.count).unwrap_or(&self.many)
    }

    /// Leaves out corners that rounding has moved onto the line of their neighbours, or behind it.
    #[inline(always)]
    fn make_convex(&mut self) {
        let corners = self.corners();
        let count = corners.len();
        let is_left = |i: usize| cross(edge(corners, i), edge(corners, if i + 1 < count { i + 1 } else { 0 })) > 0;
        if count > 2 && !(0..count).all(is_left) || count == 2 && corners[0] == corners[1] {
            self.take_hull();
        }
    }

    /// Replaces the corners by those of their convex hull (Andrew's monotone chain).
    #[cold]
    pub(super) fn take_hull(&mut self) {
        let mut sorted = self.corners().to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        let half = |points: &mut dyn Iterator<Item = Point>| {
            let mut chain: Vec<Point> = Vec::new();
            for point in points {
                while let [.., a, b] = chain[..] {
                    if cross(from_to(a, b), from_to(b, point)) > 0 {
                        break;
                    }
                    chain.pop();
                }
                chain.push(point);
            }
            chain
        };
        let lower = half(&mut sorted.iter().copied());
        let upper = half(&mut sorted.iter().rev().copied());
        // The last corner of each half is the first of the other one.
        let hull =
            if sorted.len() == 1 { sorted } else { [&lower[..lower.len() - 1], &upper[..upper.len() - 1]].concat() };
        (self.count, self.many) = (0, Vec::new());
        hull.into_iter().for_each(|corner| self.push(corner));
    }

    /// The core as seen from another point, with another radius. *Domain* its corners stay below 2^54.
    pub(crate) fn seen_from(&self, [x, y]: Point, radius: i64) -> Self {
        let mut core = Self { radius, ..Self::default() };
        self.corners().iter().for_each(|corner| core.push([corner[0] - x, corner[1] - y]));
        core
    }

    /// The least box around the core and its radius, relative to the point from which it is seen: below 2^54.
    pub(crate) fn bounds(&self) -> [Point; 2] {
        let corners = self.corners();
        let ends = |(low, high): (Point, Point), &[x, y]: &Point| {
            ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)])
        };
        let (low, high) = corners.iter().fold((corners[0], corners[0]), ends);
        [low.map(|part| part - self.radius), high.map(|part| part + self.radius)]
    }
}

/// A vector of ulps.
pub(crate) fn in_fx([x, y]: Point) -> Vec2<Fx> {
    Vec2::new(Fx::from_bits(x), Fx::from_bits(y))
}
