//! Settling: the velocity that pushing out of overlaps leaves, taken back at the end of a step.
//!
//! The solve pass pushes overlapping bodies apart, and the relax pass takes that velocity back. Where a body is pushed along two normals
//! at a small angle, as in a wedge, a pass takes back next to nothing of it: each row sees only the sine of half of the angle.
//! So contacts that still push at the end of the step while they open are iterated to convergence, as a compression that starts from
//! their impulses of the last sub-step: a contact that opens gives up its impulse, and pushing out moves bodies without giving them speed.

use super::super::Solver;
use super::shock::Shock;
use super::{FRACTION, Impacts, SubStep};
use crate::kernel::simd::Lanes;

/// Contacts count that open faster than the slowest impact over this.
const SLOWEST: i64 = 8;

impl Solver {
    /// Settles the contacts of a step, after its last sub-step.
    pub(in super::super) fn settle<L: Lanes>(&mut self, substep: SubStep<'_>, lanes: L) {
        let mut impacts = core::mem::take(&mut self.impacts);
        impacts.pending.clear();
        for row in 0..self.rows.len() {
            if self.rows.is_moving(row, SLOWEST as u32) {
                self.index_contacts(&mut impacts);
                let places = impacts.places_of(row);
                impacts.pending.extend_from_slice(&impacts.places[places]);
            }
        }
        let mut pending = core::mem::take(&mut impacts.pending);
        pending.sort_unstable();
        pending.dedup();
        impacts.candidates.clear();
        impacts.candidates.extend(pending.iter().filter_map(|&place| self.look_for_push(place, substep)));
        impacts.pending = pending;
        impacts.candidates.sort_unstable_by_key(|shock| (shock.island, shock.place));
        let candidates = core::mem::take(&mut impacts.candidates);
        for island in candidates.chunk_by(|a, b| a.island == b.island) {
            impacts.shocks.clear();
            impacts.set.clear();
            island.iter().for_each(|shock| self.join(&mut impacts, shock.clone(), substep));
            let fastest = island.iter().flat_map(|shock| shock.before).map(i64::abs).max().unwrap_or(0);
            impacts.tolerance = (fastest >> 12).max(2 << FRACTION);
            impacts.slowest = (fastest >> 8).max(2 << FRACTION);
            impacts.exponent = island.iter().map(|shock| shock.exponent).max().unwrap_or(0);
            self.compress(&mut impacts, substep);
            self.release(&mut impacts, lanes);
        }
        impacts.candidates = candidates;
        impacts.leave_bodies();
        self.impacts = impacts;
    }

    /// A contact that pushes bodies apart that overlap, and that open.
    fn look_for_push(&self, place: u32, substep: SubStep<'_>) -> Option<Shock> {
        let velocities = self.rows_before(place, substep);
        let shock = self.shock(place, velocities, substep);
        let slowest = shock.threshold / SLOWEST;
        let pushes = |point: usize| shock.impulses[point] > 0 && velocities[point] > slowest;
        (pushes(0) || pushes(1)).then_some(shock)
    }

    /// Applies the changes of impulses of settled contacts.
    fn release<L: Lanes>(&mut self, impacts: &mut Impacts, lanes: L) {
        for shock in &impacts.shocks {
            impacts.is_joined[shock.place as usize] = false;
            let place = &self.places[shock.place as usize];
            let (group, lane) = (&mut self.groups[place.group as usize], place.lane as usize);
            for row in 0..3 {
                group.applied[row][lane] += shock.impulses[row] - group.impulses[row][lane];
                group.impulses[row][lane] = shock.impulses[row];
            }
        }
        for &body in &impacts.set {
            let struck = &mut impacts.bodies[body as usize];
            struck.is_in_set = false;
            if struck.has_changed() {
                let change = [0, 1, 2].map(|axis| struck.velocity[axis] - struck.start[axis]);
                self.rows.strike(lanes, struck.row, change, [0; 3]);
            }
        }
    }
}
