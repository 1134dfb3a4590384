//! Distances that carry over between the moments of a sweep: directions that cannot be the widest are not measured.

use alloc::vec::Vec;

use super::super::form::{PlacedForm, square};
use super::{KEPT, Moment, Places, ROUNDING, Widest, between, length, product};

/// Distances at earlier moments of the same pieces of both paths, as bounds for a later moment: the distance along a normal, or between two corners, changes by the
/// drift from one moment to the other at most, and so does the largest distance of all.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// False before the first moment of a piece is measured, and where outlines drift so far that nothing is known.
    is_filled: bool,
    /// The drift in a tick, ulps.
    rate: i64,
    /// The most that rounding adds to a distance, ulps.
    rounding: i64,
    /// The drift from the start of the tick to the moment of the squares, and to the last moment that was measured.
    square_drift: i64,
    drift: i64,
    /// The drift up to which the list of near corners holds, ulps: of the order of the outlines.
    far: i64,
    /// By distinct normal: the larger distance along it and its opposite, less the drift up to the moment when it was measured last.
    distances: Vec<i64>,
    /// By pair of corners: the square of their distance at the moment of the squares.
    squares: Vec<u128>,
    /// A bound of the least distance of two corners then.
    shortest: i64,
    /// The pairs of corners that may be nearest as long as the list holds; empty before it is needed.
    near: Vec<[u8; 2]>,
}

/// The measurements that are left at a moment.
struct Rest {
    drift: i64,
    /// Normals are left out whose known distance is less.
    least: i64,
    /// All pairs of corners are looked at.
    has_all_corners: bool,
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

    /// Begins with two outlines that drift at this [rate](Moment::rate): all has to be measured.
    fn start(&mut self, rate: Option<[i64; 2]>, at: u64, placed: &[PlacedForm; 2]) -> Rest {
        let normals = placed[0].distinct_normals().len() + placed[1].distinct_normals().len();
        self.is_filled = rate.is_some();
        [self.rate, self.rounding] = rate.unwrap_or_default();
        self.square_drift = self.drift_to(at);
        self.far = (placed[0].reach + placed[1].reach) >> 4;
        self.distances.clear();
        self.distances.resize(normals, 0);
        Rest { drift: self.square_drift, least: i64::MIN, has_all_corners: true }
    }

    /// The measurements that are left at a later moment, for the largest distance at the last one.
    ///
    /// # Ranges
    /// All terms are below 2^59.
    fn rest(&mut self, distance: i64, at: u64) -> Rest {
        let drift = self.drift_to(at);
        let passed = drift - self.drift;
        let has_all_corners = drift - self.square_drift > self.far;
        if has_all_corners {
            self.square_drift = drift;
        }
        Rest { drift, least: distance - passed - drift - 2 * self.rounding, has_all_corners }
    }
}

impl Moment {
    /// By how much distances along normals and between corners change in a tick at most, and the part that rounding adds, ulps; `None` where this is too
    /// much to tell anything, and where not all directions count.
    ///
    /// # Ranges
    /// Sizes are below 2^56 and angles below 2^32: the sum is below 2^58.
    fn rate(&self) -> Option<[i64; 2]> {
        let Places { placed, offset, front, .. } = &self.places;
        let way = self.way();
        let size = length(*offset) + way + i128::from(placed[0].reach + placed[1].reach);
        let angles = [self.radians(0), self.radians(1)];
        if front.is_some() || size >= 1 << 56 || angles.iter().any(|&angle| angle >= 1 << 32) {
            return None;
        }
        // A normal that turns is as long a lever as the way from its body's centre to a corner of the other one.
        let turn = |side: usize| {
            let reach = placed[1 - side].reach;
            let lever = size as i64 - placed[side].reach;
            (product(angles[side], lever.unsigned_abs()) + product(angles[1 - side], reach.unsigned_abs())) >> 32
        };
        Some([way as i64 + turn(0).max(turn(1)) as i64 + 1, 4 * ROUNDING + (size >> 26) as i64])
    }

    /// Finds the largest distance along a direction.
    pub(in super::super) fn measure(&mut self) {
        if self.is_measured {
            return;
        }
        let rest = match self.widest.distance.filter(|_| self.known.is_filled) {
            Some(distance) => self.known.rest(distance as i64, self.at),
            None => self.known.start(self.rate(), self.at, &self.places.placed),
        };
        let Self { places, known, widest, .. } = self;
        (widest.distance, widest.count) = (None, 0);
        known.measure_normals(places, &rest, widest);
        known.measure_corners(places, &rest, widest);
        known.drift = rest.drift;
        self.is_measured = true;
    }
}

impl Known {
    /// Adds the distances along the normals.
    #[inline(always)]
    fn measure_normals(&mut self, places: &Places, rest: &Rest, widest: &mut Widest) {
        let mut distances = self.distances.iter_mut();
        for side in 0..2 {
            let placed = &places.placed[side];
            for (&n, distance) in placed.distinct_normals().iter().zip(&mut distances) {
                if *distance < rest.least {
                    continue;
                }
                let gaps = places.gaps(if side == 0 { n } else { n.map(|part| -part) });
                let mut largest = gaps[0].distance;
                if places.is_allowed(gaps[0].n) {
                    widest.add(&gaps[0]);
                }
                if placed.is_symmetric {
                    largest = largest.max(gaps[1].distance);
                    if places.is_allowed(gaps[1].n) {
                        widest.add(&gaps[1]);
                    }
                }
                *distance = (largest as i64).saturating_sub(rest.drift);
            }
        }
    }

    /// Adds the distances between the corners that are nearest to each other.
    #[inline(always)]
    fn measure_corners(&mut self, places: &Places, rest: &Rest, widest: &mut Widest) {
        let [a, b] = [0, 1].map(|side: usize| places.placed[side].corners());
        let offset = places.near_offset();
        let mut nearest = Nearest { square: u128::MAX, shortest: [[0; 2]; KEPT], count: 0 };
        if rest.has_all_corners {
            self.squares.clear();
            self.near.clear();
            for &a in a {
                for &b in b {
                    self.squares.push(nearest.add(between(offset, a, b)));
                }
            }
            self.shortest = length(nearest.shortest[0].map(i128::from)).min(1 << 60) as i64;
        } else {
            if self.near.is_empty() {
                self.list_near(b.len());
            }
            for &[i, j] in &self.near {
                nearest.add(between(offset, a[usize::from(i)], b[usize::from(j)]));
            }
        }
        let mut add_along = |d: [i64; 2]| {
            if let Some(gap) = places.gap_along(d) {
                widest.add(&gap);
            }
        };
        match nearest.shortest.get(..nearest.count) {
            Some(shortest) => shortest.iter().for_each(|&d| add_along(d)),
            None => places.each_nearest(nearest.square, add_along),
        }
    }

    /// Lists the pairs of corners that may be nearest as long as the drift is not [`far`](Self::far), from the squares: the least distance grows
    /// by that at most, and each other one shrinks by it.
    fn list_near(&mut self, count: usize) {
        let limit = (self.shortest + 2 * self.far + 2 * self.rounding).unsigned_abs();
        let limit = product(limit, limit);
        for (pair, &square) in self.squares.iter().enumerate() {
            if square <= limit {
                // There are at most 64 corners.
                self.near.push([pair / count, pair % count].map(|corner| corner as u8));
            }
        }
    }
}

/// The vectors between the corners that are nearest to each other.
struct Nearest {
    square: u128,
    /// The first ones of these.
    shortest: [[i64; 2]; KEPT],
    count: usize,
}

impl Nearest {
    /// Adds a vector between two corners, and returns its square.
    #[inline(always)]
    fn add(&mut self, d: [i64; 2]) -> u128 {
        let square = square(d);
        if square < self.square {
            (self.square, self.count) = (square, 0);
        }
        if square == self.square {
            if let Some(place) = self.shortest.get_mut(self.count) {
                *place = d;
            }
            self.count += 1;
        }
        square
    }
}
