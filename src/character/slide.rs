//! The way of a point along obstacles.

use alloc::vec::Vec;

use super::obstacle::{Contacts, Obstacles, Plane, along, sum, times};
use crate::kernel::wide::{div_256, mul_128};
use crate::query::{FULL, Feature, Point, at as point_at, dot, from_to};
use crate::slots::BodyId;

/// At most this many obstacles cut a way; the rest of the way is then dropped.
const ROUNDS: usize = 16;

/// The number of places below an edge that are searched for ground.
const EDGES: usize = 4;

/// The point is pushed out of skins this often, and by this many ulps in all at most, 1 m.
const PUSHES: usize = 4;
pub(super) const MAX_PUSH: i64 = 1 << 32;

/// A plane that the character moved against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) index: usize,
    pub(super) unit: Point,
    pub(super) feature: Feature,
    pub(super) at: Point,
}

/// A character on its way: its centre relative to the start, ulps.
pub(super) struct Walker<'a> {
    pub(super) obstacles: Obstacles<'a>,
    pub(super) at: Point,
    pub(super) touches: Vec<Touch>,
    /// The part of the way walked that obstacles held back.
    pub(super) held_back: Point,
}

/// The part of a way along a plane with this normal, rounded to nearest, halves away from zero, and never into the plane.
///
/// *Domain* the way is below 2^44 and the normal below 2^54: products with the way below 2^99, squares below 2^109.
pub(super) fn project(way: Point, normal: Point) -> Point {
    let tangent = [-normal[1], normal[0]];
    let (length, square) = (dot(way, tangent), dot(tangent, tangent) as u128);
    // |tangent|·|length| / square is at most |way|, so that the quotient fits.
    let mut moved = tangent.map(|part| {
        let (high, low) = mul_128(u128::from(part.unsigned_abs()), length.unsigned_abs());
        let (quotient, remainder) = div_256(high, low, square);
        let size = (quotient + u128::from(remainder >= square - remainder)) as i64;
        if (part < 0) == (length < 0) { size } else { -size }
    });
    // Rounding moved it by at most ½ ulp along each axis: one along the longer axis of the normal leads out again.
    if dot(moved, normal) < 0 {
        let [x, y] = normal.map(i64::unsigned_abs);
        for (k, is_longer) in [x >= y, y >= x].into_iter().enumerate() {
            moved[k] += if is_longer { normal[k].signum() } else { 0 };
        }
    }
    moved
}

/// Returns true if a way leads into a plane by more than the rounding of ways along other planes.
fn leads_into(way: Point, normal: Point) -> bool {
    let slack = 2 * (i128::from(normal[0].unsigned_abs()) + i128::from(normal[1].unsigned_abs()));
    dot(way, normal) < -slack
}

/// The longest part of a way that leads into none of some planes: itself, its part along one of them, or nothing.
fn clip(way: Point, planes: &[Plane]) -> Point {
    if planes.iter().all(|plane| dot(way, plane.direction) >= 0) {
        return way;
    }
    let ways = planes.iter().filter(|plane| dot(way, plane.direction) < 0).map(|plane| project(way, plane.direction));
    let is_free = |way: &Point| planes.iter().all(|plane| !leads_into(*way, plane.direction));
    ways.filter(is_free).max_by_key(|part| dot(*part, way)).unwrap_or_default()
}

impl<'a> Walker<'a> {
    pub(super) fn new(obstacles: Obstacles<'a>, at: Point) -> Self {
        Self { obstacles, at, touches: Vec::new(), held_back: [0; 2] }
    }

    pub(super) fn contacts(&self) -> Contacts {
        self.obstacles.contacts(self.at, None)
    }

    /// The part of a vector that is at right angles to up.
    pub(super) fn level(&self, way: Point) -> Point {
        let up = self.obstacles.terms.up;
        from_to(times(up, along(way, up)), way)
    }

    pub(super) fn is_ground(&self, plane: &Plane) -> bool {
        plane.cosine >= self.obstacles.terms.climbs
    }

    /// The plane that the point stands on: the most level one, or the first of several.
    pub(super) fn ground_of(&self, contacts: &Contacts) -> Option<Plane> {
        let grounds = contacts.planes.iter().filter(|plane| self.is_ground(plane));
        grounds.copied().min_by_key(|plane| (-plane.cosine, plane.index))
    }

    /// Goes a way and slides along everything except the body `excluded`. This is for riding: slopes and steps make no difference.
    pub(super) fn carry(&mut self, mut way: Point, excluded: Option<BodyId>) {
        for _ in 0..ROUNDS {
            let mut contacts = self.obstacles.contacts(self.at, excluded);
            contacts.planes.retain(|plane| !plane.is_deep());
            let free = clip(way, &contacts.planes);
            if free == [0; 2] {
                return;
            }
            let fraction = self.obstacles.cast(self.at, free, &contacts);
            self.at = sum(self.at, point_at(free, fraction));
            way = point_at(way, FULL - fraction);
        }
    }

    /// Moves out of the skins that the point is in, as far as other obstacles allow.
    pub(super) fn push_out(&mut self) {
        let mut remaining = MAX_PUSH;
        for _ in 0..PUSHES {
            let contacts = self.contacts();
            // The farthest push along each axis either way: the same for any order, and for several planes that are flush.
            let (mut low, mut high) = ([0; 2], [0; 2]);
            for plane in contacts.planes.iter().filter(|plane| plane.is_deep()) {
                let push = times(plane.unit, plane.depth.min(MAX_PUSH));
                for k in 0..2 {
                    low[k] = low[k].min(push[k]);
                    high[k] = high[k].max(push[k]);
                }
            }
            let push = sum(low, high);
            let length = push[0].abs() + push[1].abs();
            if push == [0; 2] || length > remaining {
                return;
            }
            remaining -= length;
            let shallow_planes: Vec<Plane> = contacts.planes.iter().filter(|plane| !plane.is_deep()).copied().collect();
            let free = clip(push, &shallow_planes);
            let fraction = self.obstacles.cast(self.at, free, &contacts);
            self.at = sum(self.at, point_at(free, fraction));
        }
    }

    /// The part of a way that the planes at the point let it go, by the rules of slopes.
    fn free_part(&self, way: Point, level: Point, planes: &[Plane]) -> Point {
        let up = self.obstacles.terms.up;
        let blocks = |plane: &&Plane, way: Point| dot(way, plane.direction) < 0;
        let mut free = way;
        // It rests: nothing moves it down.
        let rests = |plane: &&Plane| self.is_ground(plane) && plane.cosine >= self.obstacles.terms.rests;
        if along(way, up) < 0 && planes.iter().filter(rests).any(|plane| blocks(&plane, way)) {
            free = level;
        }
        // A slope that is too steep is a wall.
        let is_steep = |plane: &&Plane| plane.cosine > 0 && !self.is_ground(plane);
        if planes.iter().filter(is_steep).any(|plane| blocks(&plane, level)) {
            free = from_to(level, free);
        }
        clip(free, planes)
    }

    /// Goes a way, slides along obstacles and climbs steps. Returns the ground of the step that it climbed at last.
    pub(super) fn walk(&mut self, mut way: Point, stands: bool) -> Option<Plane> {
        let is_up = along(way, self.obstacles.terms.up) > 0;
        for _ in 0..ROUNDS {
            let contacts = self.contacts();
            let level = self.level(way);
            self.note(way, &contacts);
            if stands && !is_up && level != [0; 2] {
                if let Some(ground) = self.climb(level, &contacts) {
                    self.held_back = [0; 2];
                    return Some(ground);
                }
            }
            let free = self.free_part(way, level, &contacts.planes);
            self.held_back = from_to(free, way);
            if free == [0; 2] {
                return None;
            }
            let fraction = self.obstacles.cast(self.at, free, &contacts);
            self.at = sum(self.at, point_at(free, fraction));
            if fraction == FULL {
                return None;
            }
            way = point_at(way, FULL - fraction);
            self.held_back = way;
        }
        None
    }

    /// Keeps the planes that a way leads into, each obstacle once.
    fn note(&mut self, way: Point, contacts: &Contacts) {
        for &Plane { index, direction, unit, feature, .. } in &contacts.planes {
            if dot(way, direction) < 0 && self.touches.iter().all(|touch| touch.index != index) {
                self.touches.push(Touch { index, unit, feature, at: self.at });
            }
        }
    }

    /// Moves the point down as far as it goes, if there is ground below it within reach. Returns that ground.
    ///
    /// At the edge of a step the point stops before it gets there. It stays on the ground below the edge.
    pub(super) fn snap(&mut self) -> Option<Plane> {
        let mut at = self.at;
        let mut way = times(self.obstacles.terms.up, -self.obstacles.terms.snap);
        let mut stop = None;
        let mut contacts = self.contacts();
        for _ in 0..EDGES {
            let ground = self.ground_of(&contacts);
            if ground.is_some() {
                self.at = stop.unwrap_or(at);
                return ground;
            }
            // Edges that are below, from the first one on, are passed.
            if contacts.planes.iter().any(|plane| dot(way, plane.direction) < 0) {
                stop = stop.or(Some(at));
            }
            let fraction = self.obstacles.cast(at, way, &contacts);
            if fraction == FULL {
                return None;
            }
            at = sum(at, point_at(way, fraction));
            way = point_at(way, FULL - fraction);
            contacts = self.obstacles.contacts(at, None);
        }
        None
    }
}
