//! Climbing steps.

use super::obstacle::{Contacts, Plane, along, sum, times, unit};
use super::slide::Walker;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{FULL, Point, RayEnd, at as point_at, dot, from_to};

/// The point is lifted by this many ulps more than the height of a step, as it stands up to as many lower.
const LIFT: i64 = 8;

impl Walker<'_> {
    /// Climbs the step that a level way leads into: up, along the way and down again. Returns the ground on it.
    pub(super) fn climb(&mut self, level: Point, contacts: &Contacts) -> Option<Plane> {
        let terms = *self.obstacles.terms;
        let is_dynamic = |plane: &Plane| self.obstacles.neighbours[plane.index].is_dynamic;
        let is_step = |plane: &Plane| dot(level, plane.direction) < 0 && !self.is_ground(plane) && !is_dynamic(plane);
        if terms.step_height == 0 || !contacts.planes.iter().any(is_step) {
            return None;
        }
        let blocks = |contacts: &Contacts, way: Point| contacts.planes.iter().any(|p| dot(way, p.direction) < 0);
        let go = |from: Point, way: Point, contacts: &Contacts| {
            let fraction = self.obstacles.cast(from, way, contacts);
            (sum(from, point_at(way, fraction)), fraction)
        };
        // Up, as far as it goes.
        let rise = times(terms.up, terms.step_height + LIFT);
        if blocks(contacts, rise) {
            return None;
        }
        let (lifted, _) = go(self.at, rise, contacts);
        let lifted_contacts = self.obstacles.contacts(lifted, None);
        if blocks(&lifted_contacts, level) {
            return None;
        }
        let down = from_to(lifted, self.at);
        // The step is deep enough if the point gets that far, and finds ground there.
        let ahead = unit(level);
        let width = terms.step_width.max(along(level, ahead));
        let probe = if width > along(level, ahead) { times(ahead, width) } else { level };
        let (probed, _) = go(lifted, probe, &lifted_contacts);
        if along(from_to(lifted, probed), ahead) + LIFT < terms.step_width {
            return None;
        }
        let probed_contacts = self.obstacles.contacts(probed, None);
        let (ground, landed) = match self.ground_of(&probed_contacts) {
            Some(ground) => (ground, probed),
            None if blocks(&probed_contacts, down) => return None,
            None => {
                let (landed, fraction) = go(probed, down, &probed_contacts);
                let ground = self.ground_of(&self.obstacles.contacts(landed, None));
                (ground.filter(|_| fraction < FULL)?, landed)
            }
        };
        // A round shape gets onto the edge of a step that is higher than the way it was lifted.
        let rise = self.surface_height(&ground, landed) - (along(self.at, terms.up) + terms.sole - terms.skin);
        if is_dynamic(&ground) || rise > terms.step_height + 2 * LIFT {
            return None;
        }
        let (moved, _) = go(lifted, level, &lifted_contacts);
        let moved_contacts = self.obstacles.contacts(moved, None);
        let end = if blocks(&moved_contacts, down) { moved } else { go(moved, down, &moved_contacts).0 };
        // Not if it would stay where it is: the edge of the step is still ahead.
        if along(from_to(self.at, end), ahead) <= 0 {
            return None;
        }
        self.at = end;
        Some(ground)
    }
    /// The height of a surface where the shape with its centre at `at` stands on it, along up from the start, ulps. *Error* 4 ulps.
    fn surface_height(&self, plane: &Plane, at: Point) -> i64 {
        let terms = self.obstacles.terms;
        let neighbour = &self.obstacles.neighbours[plane.index];
        let [x, y] = plane.unit.map(Fx::from_bits);
        let end = RayEnd { fraction: FULL, feature: plane.feature };
        let touch = neighbour.sum.touch_point([&neighbour.cores[0], &neighbour.cores[1]], at, end, Vec2::new(x, y));
        // A corner of the shape is a skin away from the surface.
        let gap = if neighbour.sum.is_corner_of_first(plane.feature) { terms.skin } else { 0 };
        along(touch, terms.up) - along(times(plane.unit, gap), terms.up)
    }
}
