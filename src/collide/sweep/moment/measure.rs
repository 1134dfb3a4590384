//! What the moments of a sweep know from each other: which directions cannot be the widest, so that nothing is measured along them.

use alloc::vec::Vec;

use super::super::form::{PlacedForm, square};
use super::{KEPT, Moment, Places, ROUNDING, Widest, between, length, product};

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
    /// The drift from the start of the tick to the moment of the squares, and to the last moment that was measured.
    square_drift: i64,
    drift: i64,
    /// The drift after which squares are found anew, ulps: of the order of the outlines.
    far: i64,
    /// By distinct normal: the larger distance along it and its opposite, less the drift up to the moment when it was measured last.
    distances: Vec<i64>,
    /// By pair of corners: the square of their distance at an earlier moment.
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
    /// The squares are found anew.
    is_anew: bool,
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
        let pairs = placed[0].corners().len() * placed[1].corners().len();
        self.is_filled = rate.is_some();
        [self.rate, self.rounding] = rate.unwrap_or_default();
        self.square_drift = self.drift_to(at);
        self.far = (placed[0].reach + placed[1].reach) >> 4;
        self.distances.clear();
        self.distances.resize(normals, 0);
        self.squares.clear();
        self.squares.resize(pairs, 0);
        Rest { drift: self.square_drift, least: i64::MIN, limit: u128::MAX, is_anew: true }
    }

    /// What has to be measured at a later moment, for the largest distance at the last one.
    ///
    /// # Ranges
    /// All terms are below 2^59.
    fn rest(&mut self, distance: i64, at: u64) -> Rest {
        let drift = self.drift_to(at);
        let passed = drift - self.drift;
        let is_anew = drift - self.square_drift > self.far;
        let limit = if is_anew {
            self.square_drift = drift;
            u128::MAX
        } else {
            let limit = self.shortest + passed + drift - self.square_drift + 2 * self.rounding;
            product(limit.unsigned_abs(), limit.unsigned_abs())
        };
        Rest { drift, least: distance - passed - drift - 2 * self.rounding, limit, is_anew }
    }
}

impl Moment {
    /// By how much distances along normals and between corners change in a tick at most, and what rounding adds, ulps; `None` where that is too
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
        let mut squares = self.squares.iter_mut();
        let mut nearest = u128::MAX;
        let (mut shortest, mut count) = ([[0; 2]; KEPT], 0);
        for &a in a {
            for (&b, known_square) in b.iter().zip(&mut squares) {
                if *known_square > rest.limit {
                    continue;
                }
                let d = between(offset, a, b);
                let square = square(d);
                if rest.is_anew {
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
        self.shortest = x.max(y).saturating_add(x.min(y) / 2);
        let mut add_along = |d: [i64; 2]| {
            if let Some(gap) = places.gap_along(d) {
                widest.add(&gap);
            }
        };
        match shortest.get(..count) {
            Some(shortest) => shortest.iter().for_each(|&d| add_along(d)),
            None => places.each_nearest(nearest, add_along),
        }
    }
}
