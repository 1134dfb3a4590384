//! The law of a row in an impact.
//!
//! Forces have no time to act in an impact, so that springs, motors and friction take no part. A limit that the row is at *stops* it, and pushes as
//! much as it takes: then the row is held as if it had one position. Which rows are stopped is settled for the impulses of all contacts together,
//! before the joints answer them ([`AxisRow::revise_stop`]); where the impact comes out otherwise, and a limit would pull, the row is
//! *barred* from it, and the impact is solved once more.
//!
//! A row is stopped only if it stood still at its limit, and the rows of all joints that are held stood still too, against the speed of the impact:
//! then the impulses of joints do no work. What still goes for its limit is left to the passes.

use super::{AxisRow, ENDLESS, FASTEST, Place};
use crate::solve::number::lowered;

/// A pull up to which a limit is taken to push, or to do nothing: by less than 2^4 units of velocity.
const PULL: i64 = 1 << 12;

/// A row between two bodies with a limit in an impact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Stop {
    /// Free to go.
    #[default]
    Open,
    /// Held by a limit.
    Stopped,
    /// Free to go whatever it meets.
    Barred,
}

impl AxisRow {
    /// Begins an impact with a change of the velocity, in 2^-60, at an impulse of the row: a row that is held takes it back, all others are free.
    pub(in crate::solve::joint) fn begin_impact(&mut self, change: i128, impulse: i64) {
        self.is_biased = false;
        self.place = Place::Given(impulse);
        if self.is_held() {
            self.velocity = lowered(change, 30).clamp(-FASTEST, FASTEST) as i64;
            (self.count, self.velocities[0], self.place) = (1, 0, Place::Step(0));
            (self.levels[0], self.levels[1]) = (-ENDLESS, ENDLESS);
        }
    }

    /// Returns true if the row has one position in an impact.
    pub(in crate::solve::joint) fn is_held(&self) -> bool {
        self.is_locked() || self.stop == Stop::Stopped
    }

    /// Returns true if the row has a limit, and more than one position.
    pub(in crate::solve::joint) fn has_limits(&self) -> bool {
        (self.lower > -ENDLESS || self.upper < ENDLESS) && !self.is_locked()
    }

    /// Returns true if a limit may stop the row in an impact: it is at the limit.
    pub(in crate::solve::joint) fn may_stop(&self) -> bool {
        let [at_lower, at_upper] = self.touched_limits();
        (at_lower || at_upper) && self.has_limits() && !self.is_paired() && self.stop != Stop::Barred
    }

    /// Lets the row go; after an impact for the next one, else a barred row stays barred.
    pub(in crate::solve::joint) fn release(&mut self, is_over: bool) {
        if is_over || self.stop != Stop::Barred {
            self.stop = Stop::Open;
        }
    }

    /// Stops a row that goes beyond a limit, faster than the tolerance, and lets a row go that its limit would pull: for the velocity of the row after
    /// the impact, in 2^-60, and its impulse. Returns true if the row was not so before.
    pub(in crate::solve::joint) fn revise_stop(&mut self, velocity: i128, impulse: i64, tolerance: i128) -> bool {
        let [at_lower, at_upper] = self.touched_limits();
        let was_stopped = self.stop == Stop::Stopped;
        let is_stopped = if was_stopped {
            at_lower && impulse > 0 || at_upper && impulse < 0
        } else {
            at_lower && velocity < -tolerance || at_upper && velocity > tolerance
        };
        self.stop = if is_stopped { Stop::Stopped } else { Stop::Open };
        was_stopped != is_stopped
    }

    /// Bars a stopped row with an impulse by which its limit pulls; any stopped row if `is_last`. Returns true if it is barred now.
    pub(in crate::solve::joint) fn bar(&mut self, impulse: i64, is_last: bool) -> bool {
        let [at_lower, at_upper] = self.touched_limits();
        let pushes = at_lower && impulse >= -PULL || at_upper && impulse <= PULL;
        if self.stop != Stop::Stopped || pushes && !is_last {
            return false;
        }
        self.stop = Stop::Barred;
        true
    }

    /// True for the lower and the upper limit if the row is at it.
    fn touched_limits(&self) -> [bool; 2] {
        [self.way - self.lower <= self.touch, self.upper - self.way <= self.touch]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::math::TimeStep;
    use crate::scalar::FxFactor;
    use crate::solve::joint::Axis;
    use crate::solve::unit::Clock;

    /// A row of 1 kg with limits at ±1 m, this far inside of the lower one or, in a mirror, of the upper one, in thousandths of the touch.
    fn row_at(inside: i64, sign: i64) -> AxisRow {
        let axis = Axis { limits: Some([fx!(-1), fx!(1)]), ..Axis::default() };
        let mut row = AxisRow::new(&axis, FxFactor::ONE, 0, &Clock::new(TimeStep::hz(60), 5), -22, 0);
        let bound = if sign > 0 { row.lower } else { row.upper };
        row.set_way(bound + sign * row.touch * inside / 1_000);
        row
    }

    /// The states of a row in an impact, with values that lead to the lower limit, and their mirror images at the upper one.
    #[test]
    fn a_limit_stops_what_goes_beyond_it_and_pulls_nothing() {
        for sign in [1, -1] {
            assert!([-500, 0, 999].map(|inside| row_at(inside, sign).may_stop()) == [true; 3]);
            assert!(!row_at(1_001, sign).may_stop());
            let mut row = row_at(0, sign);
            let stopped_by = |row: &mut AxisRow, velocity: i64, impulse: i64| {
                row.revise_stop(i128::from(sign * velocity), sign * impulse, 100)
            };
            assert!(!stopped_by(&mut row, 1_000, 0) && !stopped_by(&mut row, -100, 0) && !row.is_held());
            assert!(stopped_by(&mut row, -101, 0) && row.is_held());
            // The velocity of a stopped row says nothing.
            assert!(!stopped_by(&mut row, 0, 7) && row.is_held());
            assert!(stopped_by(&mut row, 0, -1) && !row.is_held() && row.may_stop());
            assert!(stopped_by(&mut row, -101, 0));
            assert!(!row.bar(-sign * PULL, false) && row.is_held());
            assert!(row.bar(-sign * (PULL + 1), false) && !row.is_held() && !row.may_stop());
            row.release(false);
            assert!(!row.may_stop());
            row.release(true);
            assert!(row.may_stop() && stopped_by(&mut row, -101, 0));
            assert!(row.bar(sign * 1_000_000, true) && !row.may_stop());
        }
    }
}
