//! Settling: the velocity that pushing out of overlaps leaves, taken back at the end of a step.
//!
//! The solve pass pushes overlapping bodies apart, and the relax pass takes that velocity back. Where a body is pushed along two normals
//! at a small angle, as in a wedge, a pass takes back next to nothing of it: each row sees only the sine of half of the angle.
//! So contacts of outlines that overlapped at the start of a step, and that open at its end, are iterated to convergence, as a compression
//! that starts from their impulses of the whole step: a contact that opens gives up its impulse, and pushing out moves bodies without giving
//! them speed. Contacts with an impact are left as they are.

use super::super::Solver;
use super::shock::Shock;
use super::{FRACTION, Impacts, SubStep};
use crate::kernel::simd::Lanes;

/// Bodies count that are faster than half of the slowest impact over this.
const SLOWEST: u32 = 8;
/// Contacts count that open faster than the slowest impact over this.
const OPENING: i64 = 512;
/// Outlines overlap that do so by more than this times the distance up to which points touch.
pub(super) const OVERLAP: i32 = 2;

impl Solver {
    /// Settles the contacts of a step, after its last sub-step.
    pub(in super::super) fn settle<L: Lanes>(&mut self, substep: SubStep<'_>, lanes: L) {
        let mut impacts = core::mem::take(&mut self.impacts);
        impacts.pending.clear();
        for row in 0..self.rows.len() {
            if self.rows.is_moving(row, SLOWEST) {
                self.index_contacts(&mut impacts);
                let places = impacts.places_of(row);
                impacts.pending.extend_from_slice(&impacts.places[places]);
            }
        }
        let mut pending = core::mem::take(&mut impacts.pending);
        pending.sort_unstable();
        pending.dedup();
        impacts.sum_strikes();
        pending.retain(|place| impacts.strikes.binary_search_by_key(place, |strike| strike.place).is_err());
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

    /// A contact that pushed bodies apart that overlap, and that opens.
    fn look_for_push(&self, place: u32, substep: SubStep<'_>) -> Option<Shock> {
        let velocities = self.rows_before(place, substep);
        let shock = self.shock(place, velocities, substep);
        let slowest = (shock.threshold / OPENING).max(2 << FRACTION);
        let pushes = |point: usize| shock.pushes[point] && velocities[point] > slowest;
        (pushes(0) || pushes(1)).then_some(shock)
    }

    /// Applies the changes of impulses of settled contacts.
    fn release<L: Lanes>(&mut self, impacts: &mut Impacts, lanes: L) {
        for shock in &impacts.shocks {
            impacts.is_joined[shock.place as usize] = false;
            let place = &self.places[shock.place as usize];
            let (group, lane) = (&mut self.groups[place.group as usize], place.lane as usize);
            for row in 0..3 {
                let change = shock.impulses[row] - group.applied[row][lane];
                group.applied[row][lane] += change;
                let impulse = group.impulses[row][lane] + change;
                group.impulses[row][lane] = if row < 2 { impulse.max(0) } else { impulse };
            }
            let [first, second, tangent] = [0, 1, 2].map(|row| group.impulses[row][lane]);
            let limit = ((i128::from(first) + i128::from(second)) * i128::from(shock.friction)) >> 26;
            group.impulses[2][lane] = i128::from(tangent).clamp(-limit, limit) as i64;
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
