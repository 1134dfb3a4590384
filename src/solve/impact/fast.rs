//! The contacts that may have an impact in a sub-step, in lanes.
//!
//! Reads: flights and velocities of bodies at the beginning of the sub-step, rows of contacts. Writes: the lanes of each group that may be
//! fast enough.
//!
//! # Ranges
//! Velocities and changes of flights are within 2^27: along a row below 2^29.28, and the difference of two below 2^30.28. Thresholds are
//! at most 2^28.

use alloc::vec::Vec;

use super::super::group::Group;
use super::super::motion::{Rows, VELOCITY};
use super::super::pass::along_row;
use super::SubStep;
use crate::kernel::simd::{GROUP, Gathered, Lanes, Row};

/// More than rounding changes a velocity along a row: by half a unit and by the part below the unit in each component of both bodies,
/// and once more along the row.
const ROUNDING: i32 = 32;

/// The lanes of contacts that may have an impact in a sub-step.
#[derive(Clone, Debug, Default)]
pub(super) struct FastLanes {
    /// By row: the velocity at the beginning of the sub-step, and the change by the flight in the step in place of a displacement.
    speeds: Vec<Row>,
    /// By group: a bit for each lane.
    lanes: Vec<u8>,
}

impl FastLanes {
    /// Finds the lanes.
    #[inline(always)]
    pub(super) fn find<L: Lanes>(&mut self, substep: SubStep<'_>, rows: &Rows, groups: &[Group], lanes: L) {
        self.lanes.clear();
        if !self.list_speeds(substep, rows) {
            self.lanes.resize(groups.len(), u8::MAX);
            return;
        }
        for group in groups {
            let mut bits = 0;
            for at in (0..group.count).step_by(L::WIDTH) {
                bits |= self.fast_lanes(lanes, group, at);
            }
            self.lanes.push(bits);
        }
    }

    /// Returns true if a lane may have an impact.
    pub(super) fn contains(&self, group: u32, lane: u32) -> bool {
        self.lanes[group as usize] >> lane & 1 != 0
    }

    /// Lists the velocities of all rows. Returns false if one is beyond the range.
    fn list_speeds(&mut self, substep: SubStep<'_>, rows: &Rows) -> bool {
        self.speeds.clear();
        let mut largest = 0;
        for row in 0..rows.len() {
            let change = rows.flight(row).change;
            let mut velocity = rows.before_contacts(row);
            for i in 0..3 {
                if change[i] != 0 {
                    let passed = i64::from(change[i]) * i64::from(substep.k - 1);
                    velocity[i] += (passed / i64::from(substep.n)) as i32;
                }
                largest = largest.max(velocity[i].unsigned_abs()).max(change[i].unsigned_abs());
            }
            let [x, y, angular, _] = velocity;
            let row = Row { velocity: [x, y, angular, change[2]], displacement: change, gain: [0; 4] };
            self.speeds.push(row);
        }
        largest <= VELOCITY.unsigned_abs()
    }

    /// The lanes of a group from `at` on in which a point may be faster than the threshold within the step.
    #[inline(always)]
    fn fast_lanes<L: Lanes>(&self, lanes: L, group: &Group, at: usize) -> u8 {
        let (a, b) = (lanes.gather(&self.speeds, &group.a, at), lanes.gather(&self.speeds, &group.b, at));
        let (nx, ny) = lanes.pair(&group.normal, at);
        let x = lanes.times(nx, lanes.minus(b.velocity[0], a.velocity[0]));
        let y = lanes.times(ny, lanes.minus(b.velocity[1], a.velocity[1]));
        let closing = lanes.add(x, y);
        let x = lanes.times(nx, lanes.minus(b.displacement[0], a.displacement[0]));
        let y = lanes.times(ny, lanes.minus(b.displacement[1], a.displacement[1]));
        let change = lanes.add(x, y);
        let (_, threshold) = lanes.pair(&group.surface, at);
        let limit = lanes.minus(lanes.splat(ROUNDING), threshold);
        let ends = [closing, change];
        let (first, second) =
            (excess(lanes, group, at, 0, ends, [&a, &b], limit), excess(lanes, group, at, 1, ends, [&a, &b], limit));
        if lanes.none_positive(first, second) {
            return 0;
        }
        let mut values = [[0; 2]; GROUP];
        lanes.put_pair(&mut values, at, (first, second));
        let mut bits = 0;
        for (lane, value) in values.iter().enumerate().take(group.count) {
            bits |= u8::from(value[0] > 0 || value[1] > 0) << lane;
        }
        bits
    }
}

/// By how much a point closes faster than a limit, for the parts of velocities and changes along the normal.
#[inline(always)]
fn excess<L: Lanes>(
    lanes: L,
    group: &Group,
    at: usize,
    point: usize,
    [closing, change]: [L::Wide; 2],
    [a, b]: [&Gathered<L::Narrow>; 2],
    limit: L::Narrow,
) -> L::Narrow {
    let arms = lanes.pair(&group.arms[point], at);
    let velocity = along_row(lanes, closing, arms, (a.velocity[2], b.velocity[2]));
    let change = along_row(lanes, change, arms, (a.displacement[2], b.displacement[2]));
    let change = lanes.at_least(change, lanes.minus(lanes.splat(0), change));
    lanes.minus(limit, lanes.minus(velocity, change))
}
