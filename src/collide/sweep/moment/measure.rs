//! What the moments of a sweep know from each other: which directions cannot be the widest, so that nothing is measured along them.

use alloc::vec::Vec;

use super::super::form::square;
use super::{KEPT, Moment, ROUNDING, Widest, between, product};

/// What earlier moments of the same pieces of both paths say about a moment: the distance along a normal, or between two corners, changes by the
/// drift from one moment to the other at most, and so does the largest distance of all.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// False before the first moment of a piece is measured, and where outlines drift so far that nothing is known.
    is_filled: bool,
    /// The drift in a tick, ulps.
    rate: i64,
    /// What rounding adds to a distance at most, ulps.
    rounding: i64,
    /// The drift from the start of the tick to the first and to the last moment that was measured.
    first_drift: i64,
    drift: i64,
    /// By distinct normal: the larger distance along it and its opposite, less the drift up to the moment when it was measured last.
    distances: Vec<i64>,
    /// By pair of corners: the square of their distance at the first moment.
    squares: Vec<u128>,
    /// A bound of the least distance of two corners at the last moment.
    shortest: i64,
}

/// What has to be measured at a moment.
struct Rest {
    drift: i64,
    /// Normals are left out whose known distance is less.
    least: i64,
    /// Pairs of corners are left out whose known square is more.
    limit: u128,
    is_first: bool,
}

impl Known {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.is_filled = false;
    }

    /// The drift from the start of the tick to a moment.
    fn drift_to(&self, at: u64) -> i64 {
        (product(self.rate.unsigned_abs(), at) >> 62) as i64 + 1
    }

    /// Begins with outlines of so many normals and pairs of corners, which drift at this [rate](Moment::rate): all have to be measured.
    fn start(&mut self, rate: Option<[i64; 2]>, at: u64, normals: usize, pairs: usize) -> Rest {
        self.is_filled = rate.is_some();
        [self.rate, self.rounding] = rate.unwrap_or_default();
        self.first_drift = self.drift_to(at);
        self.distances.clear();
        self.distances.resize(normals, 0);
        self.squares.clear();
        self.squares.resize(pairs, 0);
        Rest { drift: self.first_drift, least: i64::MIN, limit: u128::MAX, is_first: true }
    }

    /// What has to be measured at a later moment, for the largest distance at the last one.
    ///
    /// # Ranges
    /// All terms are below 2^59.
    fn rest(&self, distance: i64, at: u64) -> Rest {
        let drift = self.drift_to(at);
        let passed = drift - self.drift;
        let limit = self.shortest + passed + drift - self.first_drift + 2 * self.rounding;
        let limit = limit.unsigned_abs();
        Rest {
            drift,
            least: distance - passed - drift - 2 * self.rounding,
            limit: product(limit, limit),
            is_first: false,
        }
    }
}

impl Moment {
    /// By how much distances along normals and between corners change in a tick at most, and what rounding adds, ulps; `None` where that is too
    /// much to tell anything, and where not all directions count.
    ///
    /// # Ranges
    /// Sizes are below 2^56 and angles below 2^33: the sum is below 2^58.
    fn rate(&self) -> Option<[i64; 2]> {
        // A normal that turns is as long a lever as the way from one corner to another.
        let offset = self.offset[0].abs() + self.offset[1].abs();
        let size = offset + self.way() + i128::from(self.placed[0].reach + self.placed[1].reach);
        let angle = self.radians(0) + self.radians(1);
        if self.front.is_some() || size >= 1 << 56 || angle >= 1 << 33 {
            return None;
        }
        let turn = (product(angle, size as u64) >> 32) as i64;
        Some([self.way() as i64 + turn + 1, 4 * ROUNDING + (size >> 26) as i64])
    }

    /// Finds the largest distance along a direction.
    pub(in super::super) fn measure(&mut self) {
        if self.is_measured {
            return;
        }
        let mut known = core::mem::take(&mut self.known);
        let counts = [0, 1].map(|side: usize| self.placed[side].distinct_normals().len());
        let corners = [0, 1].map(|side: usize| self.placed[side].corners().len());
        let rest = match self.widest.distance.filter(|_| known.is_filled) {
            Some(distance) => known.rest(distance as i64, self.at),
            None => known.start(self.rate(), self.at, counts[0] + counts[1], corners[0] * corners[1]),
        };
        let mut widest = Widest::NONE;
        self.measure_normals(&rest, &mut known, &mut widest);
        self.measure_corners(&rest, &mut known, &mut widest);
        known.drift = rest.drift;
        (self.known, self.widest, self.is_measured) = (known, widest, true);
    }

    /// Adds the distances along the normals.
    #[inline(always)]
    fn measure_normals(&self, rest: &Rest, known: &mut Known, widest: &mut Widest) {
        let mut distances = known.distances.iter_mut();
        for side in 0..2 {
            let placed = &self.placed[side];
            for (&n, known_distance) in placed.distinct_normals().iter().zip(&mut distances) {
                if *known_distance < rest.least {
                    continue;
                }
                let gaps = self.gaps(if side == 0 { n } else { n.map(|part| -part) });
                let count = if placed.is_symmetric { 2 } else { 1 };
                let mut largest = gaps[0].distance;
                for gap in &gaps[..count] {
                    largest = largest.max(gap.distance);
                    if self.is_allowed(gap.n) {
                        widest.add(gap);
                    }
                }
                *known_distance = (largest as i64).saturating_sub(rest.drift);
            }
        }
    }

    /// Adds the distances between the corners that are nearest to each other.
    #[inline(always)]
    fn measure_corners(&self, rest: &Rest, known: &mut Known, widest: &mut Widest) {
        let [a, b] = [0, 1].map(|side: usize| self.placed[side].corners());
        let offset = self.near_offset();
        let mut squares = known.squares.iter_mut();
        let mut nearest = u128::MAX;
        let (mut shortest, mut count) = ([[0; 2]; KEPT], 0);
        for &a in a {
            for (&b, known_square) in b.iter().zip(&mut squares) {
                if *known_square > rest.limit {
                    continue;
                }
                let d = between(offset, a, b);
                let square = square(d);
                if rest.is_first {
                    *known_square = square;
                }
                if square < nearest {
                    (nearest, count) = (square, 0);
                }
                if square == nearest {
                    if let Some(place) = shortest.get_mut(count) {
                        *place = d;
                    }
                    count += 1;
                }
            }
        }
        let [x, y] = shortest[0].map(i64::abs);
        known.shortest = x.max(y).saturating_add(x.min(y) / 2);
        let mut add_along = |d: [i64; 2]| {
            if let Some(gap) = self.gap_along(d) {
                widest.add(&gap);
            }
        };
        match shortest.get(..count) {
            Some(shortest) => shortest.iter().for_each(|&d| add_along(d)),
            None => self.each_nearest(nearest, add_along),
        }
    }
}
