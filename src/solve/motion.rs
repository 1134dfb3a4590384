//! Motion of bodies through the sub-steps: the velocities of the free flight, which are given, and the corrections to them.
//!
//! Reads: the free flight of each body, gains. Writes: velocities, displacements.
//!
//! The free flight of a step enters by its velocities at both ends, v0 and v1. In sub-step k of n the velocity is
//! w = v0 + (k/n)(v1 − v0), rounded once, oddly, and a body moves at that velocity and the corrections so far. So contacts see
//! sub-steps of semi-implicit Euler: a body at rest has the same impulses in each of them, and none of its passes undoes
//! the change by another one. The free flight itself may be of any integrator; [`super::apply`] joins the two.
//!
//! Changes of velocity are summed in 2^-30 units. Velocities are rounded to units, and the rest stays in the sum: so a velocity differs by
//! half a unit from the velocity by the exact impulses, however many passes there are. (Without, structures creep.)
//!
//! Velocities saturate at ±[`VELOCITY`], displacements at ±[`DISPLACEMENT`]. Velocities cut off when gains are applied are counted; at the
//! beginning of a sub-step and for displacements the unit ([`super::unit::unit_for`]) leaves room.

use alloc::vec::Vec;

use super::number::{clamped, clamped_word, shifted_word};
use crate::kernel::simd::{GAIN_BITS, Gain, Job, Lanes, Portable, Quads, Row};

/// The largest component of a velocity.
pub(super) const VELOCITY: i32 = 1 << 27;
/// The largest component of a displacement.
pub(super) const DISPLACEMENT: i32 = 1 << 28;

/// Components x, y and angular; the fourth is zero.
pub(super) type Vector = [i32; 4];

/// The free flight of a body over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FlightRow {
    /// The velocity at the start.
    pub(super) start: Vector,
    /// The change of the velocity.
    pub(super) change: Vector,
}

/// A body between sub-steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Progress {
    /// The velocity of the free flight in this sub-step.
    flight: Vector,
    /// The correction of the velocity before the contacts of this sub-step.
    before: Vector,
    /// The part of that correction below the unit.
    rest: Gain,
    /// Half of the speed of the slowest impact, less all components of the change of velocity by the flight: of two bodies that meet so
    /// fast, one is as fast as this.
    fast: i32,
}

/// All bodies of the solver: through the sub-steps a row is in place of a [`Flight`](super::Flight), in the unit of its island.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    flights: Vec<FlightRow>,
    progress: Vec<Progress>,
}

impl Rows {
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.flights.clear();
        self.progress.clear();
    }

    /// Adds a body, for impacts from this speed on. Returns its row.
    #[inline(always)]
    pub(super) fn push(&mut self, flight: FlightRow, impact_speed: i32) -> u32 {
        // Changes are below 2^28.
        let fast = impact_speed / 2 - flight.change.iter().map(|part| part.abs()).sum::<i32>();
        let row = self.rows.len();
        self.rows.push(Row::default());
        // Written where they stay: copies would wait for their parts.
        self.flights.push(FlightRow::default());
        self.progress.push(Progress::default());
        let (place, progress) = (&mut self.flights[row], &mut self.progress[row]);
        (place.start, place.change) = (flight.start, flight.change);
        (progress.flight, progress.fast) = (flight.start, fast);
        row as u32
    }

    /// The free flight of a body.
    pub(super) fn flight(&self, row: u32) -> &FlightRow {
        &self.flights[row as usize]
    }

    /// The displacement of a body since the start.
    pub(super) fn displacement(&self, row: u32) -> Vector {
        self.rows[row as usize].displacement
    }

    /// The velocity of a body.
    pub(super) fn velocity(&self, row: u32) -> Vector {
        let [x, y, angular, _] = self.rows[row as usize].velocity;
        [x, y, angular, 0]
    }

    /// The correction of a body before the contacts of this sub-step, and its part below the unit.
    pub(super) fn before(&self, row: u32) -> (Vector, Gain) {
        let progress = &self.progress[row as usize];
        (progress.before, progress.rest)
    }

    /// The velocity of a body at the start of the step with its correction before the contacts of this sub-step.
    pub(super) fn before_contacts(&self, row: u32) -> Vector {
        let (start, before) = (self.flights[row as usize].start, self.progress[row as usize].before);
        [0, 1, 2, 3].map(|i| start[i] + before[i])
    }

    /// The change of velocity by joints and contacts with which a sub-step of `n` begins, where they hold a body against its free flight: it is
    /// at most twice as large as the change by the flight. Else it is zero.
    pub(super) fn support(&self, row: u32, n: u32) -> [i64; 3] {
        let (velocity, change) = (self.rows[row as usize].velocity, self.flights[row as usize].change);
        let progress = &self.progress[row as usize];
        let support = [0, 1, 2].map(|i| i64::from(velocity[i] - progress.flight[i] - progress.before[i]));
        // Below 2^30 · 2^4, and the sums of three squares below 2^70.
        let square = |[x, y, angular]: [i128; 3]| x * x + y * y + angular * angular;
        let in_step = support.map(|part| i128::from(part) * i128::from(n));
        let flown = [0, 1, 2].map(|i| 2 * i128::from(change[i]));
        if square(in_step) <= square(flown) { support } else { [0; 3] }
    }

    /// The number of rows.
    pub(super) fn len(&self) -> u32 {
        self.rows.len() as u32
    }

    /// Returns true if a body may have an impact in a sub-step: any bound of the speeds of its points will do.
    pub(super) fn is_fast(&self, row: u32) -> bool {
        let (flight, progress) = (&self.flights[row as usize], &self.progress[row as usize]);
        // Velocities are within 2^27 and corrections within 2^28.
        let speed = |i: usize| (flight.start[i] + progress.before[i]).abs();
        speed(0) + speed(1) + speed(2) > progress.fast
    }

    /// Changes the velocity of a body by impacts, in 2^-30, and moves the body back.
    pub(super) fn strike<L: Lanes>(&mut self, lanes: L, row: u32, change: [i64; 3], back: [i128; 3]) {
        let (velocity, gain) = (self.rows[row as usize].velocity, self.rows[row as usize].gain);
        (0..3).for_each(|i| self.rows[row as usize].gain[i] += change[i]);
        self.apply_gains(lanes, &[row]);
        let (struck, progress) = (&mut self.rows[row as usize], &mut self.progress[row as usize]);
        for i in 0..3 {
            progress.before[i] += struck.velocity[i] - velocity[i];
            progress.rest[i] += struck.gain[i] - gain[i];
            let displacement = i128::from(struck.displacement[i]) - back[i];
            struck.displacement[i] = clamped(displacement, DISPLACEMENT.into());
        }
        struck.velocity[3] = struck.displacement[2];
    }

    /// Gives a follower the correction and the displacement of its leader, in units 2^down times as large. Returns true if the correction
    /// has changed.
    pub(super) fn follow_impact(&mut self, row: u32, leader: u32, down: i32) -> bool {
        let (before, rest) = self.before(leader);
        let moved = self.displacement(leader).map(|part| shifted_word(part.into(), down) as i32);
        let (follower, progress) = (&mut self.rows[row as usize], &mut self.progress[row as usize]);
        let mut has_changed = false;
        for i in 0..3 {
            let fine = (i64::from(before[i]) << GAIN_BITS) + rest[i];
            let correction = shifted_word(fine, GAIN_BITS + down) as i32;
            has_changed |= correction != progress.before[i];
            follower.velocity[i] += correction - progress.before[i];
            progress.before[i] = correction;
        }
        follower.displacement = moved;
        follower.velocity[3] = moved[2];
        has_changed
    }

    /// Applies the gains of bodies. Returns the number of velocities that were cut off.
    #[inline(always)]
    pub(super) fn apply_gains<L: Lanes>(&mut self, lanes: L, bodies: &[u32]) -> u64 {
        let lanes = lanes.quads();
        let mut cut = 0;
        for &body in bodies {
            let row = &mut self.rows[body as usize];
            if !lanes.take_gain(row, VELOCITY) {
                cut += apply_large_gain(row);
            }
        }
        cut
    }
}

/// Applies a gain that leads to the limits or beyond. Returns the number of components that were cut off.
#[cold]
fn apply_large_gain(row: &mut Row) -> u64 {
    let mut cut = 0;
    for i in 0..3 {
        let gained = Portable.rounded_oddly::<GAIN_BITS>(row.gain[i]);
        let wanted = i64::from(row.velocity[i]) + gained;
        row.velocity[i] = clamped_word(wanted, VELOCITY.into());
        cut += u64::from(i64::from(row.velocity[i]) != wanted);
        row.gain[i] -= gained << GAIN_BITS;
    }
    cut
}

/// The beginning of sub-step `k` of `n`: the velocity of the free flight there, the corrections so far and, from the second
/// sub-step on, once more the change that the joints and contacts of the sub-step before made.
pub(super) struct Begin<'a> {
    pub(super) rows: &'a mut Rows,
    pub(super) k: u32,
    pub(super) n: u32,
}

impl Job for Begin<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let lanes = lanes.quads();
        let share = ((i64::from(self.k) << 30) / i64::from(self.n)) as i32;
        let Rows { rows, flights, progress } = self.rows;
        for ((row, flight), progress) in rows.iter_mut().zip(flights).zip(progress) {
            let (velocity, change) = (lanes.quad(&row.velocity), lanes.quad(&flight.change));
            let w = lanes.quad_plus(lanes.quad(&flight.start), lanes.quad_share(change, share));
            let mut wanted = w;
            if self.k > 1 {
                // Below 2^29.9: velocities are within 2^27, corrections within 2^28, of which three are added.
                let correction = lanes.quad_minus(velocity, lanes.quad(&progress.flight));
                let again = lanes.quad_minus(correction, lanes.quad(&progress.before));
                wanted = lanes.quad_plus(lanes.quad_plus(w, correction), again);
                lanes.put(&mut progress.before, correction);
                for (gain, before) in row.gain.iter_mut().zip(&mut progress.rest) {
                    (*gain, *before) = (2 * *gain - *before, *gain);
                }
            }
            // The fourth component is the angle.
            lanes.put(&mut row.velocity, lanes.quad_joined(lanes.quad_clamped(wanted, VELOCITY), velocity));
            lanes.put(&mut progress.flight, w);
        }
    }
}

/// The move of a sub-step, at the velocities after the solve pass.
pub(super) struct Advance<'a> {
    pub(super) rows: &'a mut Rows,
}

impl Job for Advance<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let lanes = lanes.quads();
        for row in &mut self.rows.rows {
            // Without the angle, which is kept beside the velocity.
            let velocity = lanes.quad_joined(lanes.quad(&row.velocity), lanes.quad(&[0; 4]));
            let moved = lanes.quad_plus(lanes.quad(&row.displacement), velocity);
            lanes.put(&mut row.displacement, lanes.quad_clamped(moved, DISPLACEMENT));
            row.velocity[3] = row.displacement[2];
        }
    }
}
