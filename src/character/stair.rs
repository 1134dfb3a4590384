//! Climbing steps.

use super::obstacle::{Contacts, Plane, along, sum, times, unit};
use super::slide::Walker;
use crate::query::{FULL, Point, at as point_at, dot, from_to};

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
        let ground = match self.ground_of(&probed_contacts) {
            Some(ground) => ground,
            None if blocks(&probed_contacts, down) => return None,
            None => {
                let (landed, fraction) = go(probed, down, &probed_contacts);
                let ground = self.ground_of(&self.obstacles.contacts(landed, None));
                ground.filter(|_| fraction < FULL)?
            }
        };
        if is_dynamic(&ground) {
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
}
