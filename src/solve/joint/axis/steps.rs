//! The steps of a law in a pass.

use super::{AxisRow, ENDLESS, FASTEST, Place};

/// The velocity of a limit in the relax pass, from the velocity by which it is reached in the next sub-step: a limit that is neither reached nor
/// pressed against does not act yet, or it would stop an arm a sub-step before its time, and what it throws would lose the last push.
#[inline(always)]
fn relaxed(velocity: i64, is_pressed: bool) -> i64 {
    if is_pressed { velocity } else { velocity.signum() * FASTEST as i64 }
}

impl AxisRow {
    /// Lists the steps, from the highest velocity down.
    #[inline(always)]
    pub(super) fn set_steps(&mut self, rate: Option<i64>) {
        // Below 2^31: velocities are below 2^29.5.
        let [below, above] = [self.lower, self.upper].map(|bound| (bound - self.way).clamp(-(1 << 31), 1 << 31));
        let [mut slowest, mut fastest] = [below, above].map(|error| error << 30);
        match rate {
            Some(rate) => {
                slowest = if below > 0 || self.is_locked() { rate * below } else { slowest };
                fastest = if above < 0 || self.is_locked() { rate * above } else { fastest };
            }
            None => {
                let [presses_lower, presses_upper] = self.pressed_limits();
                slowest = if self.is_locked() { 0 } else { relaxed(slowest.min(0), presses_lower) };
                fastest = if self.is_locked() { 0 } else { relaxed(fastest.max(0), presses_upper) };
            }
        }
        let forces = self.motor + self.friction;
        self.count = 0;
        self.levels[0] = -forces;
        if self.upper < ENDLESS {
            self.levels[0] = -ENDLESS;
            self.add_step(fastest, -forces);
        }
        let (motor, friction) = (self.motor_speed.clamp(slowest, fastest), 0.clamp(slowest, fastest));
        if self.motor > 0 && self.motor_speed >= 0 {
            self.add_step(motor, self.levels[self.count] + 2 * self.motor);
        }
        if self.friction > 0 {
            self.add_step(friction, self.levels[self.count] + 2 * self.friction);
        }
        if self.motor > 0 && self.motor_speed < 0 {
            self.add_step(motor, self.levels[self.count] + 2 * self.motor);
        }
        if self.lower > -ENDLESS {
            self.add_step(slowest, ENDLESS);
        }
    }

    /// True for the lower and the upper limit if the row pressed against it at the end of the pass before.
    #[inline(always)]
    fn pressed_limits(&self) -> [bool; 2] {
        match self.last_place {
            Place::Step(step) => [step + 1 == self.last_count, step == 0],
            Place::Level(_) | Place::Strained(..) | Place::Given(_) => [false; 2],
        }
    }

    /// Adds a step to a level. Steps at one velocity are one.
    #[inline(always)]
    fn add_step(&mut self, velocity: i64, level: i64) {
        if self.count == 0 || self.velocities[self.count - 1] != velocity {
            self.velocities[self.count] = velocity;
            self.count += 1;
        }
        self.levels[self.count] = level;
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::fx;
    use crate::math::TimeStep;
    use crate::scalar::FxFactor;
    use crate::solve::joint::Axis;
    use crate::solve::unit::Clock;

    /// The velocities and levels of the steps of a row of 1 kg with limits at ±1 m, a brake and friction, in the second beginning of a relax pass.
    fn relaxed_steps(sign: i64) -> (Vec<i64>, Vec<i64>) {
        let limits = Some([fx!(-1), fx!(1)]);
        let axis = Axis { limits, motor_force: fx!(30), friction: fx!(1), ..Axis::default() };
        let mut row = AxisRow::new(&axis, FxFactor::ONE, 0, &Clock::new(TimeStep::hz(60), 5), -22, 0);
        let bound = if sign < 0 { row.lower } else { row.upper };
        // Beyond the limit and pressed against it, then pushed inside.
        row.set_way(bound + sign * 1_000);
        row.begin(0, 0, Some(1 << 27));
        row.place = Place::Step(if sign < 0 { row.count - 1 } else { 0 });
        row.finish(-sign << 20);
        row.set_way(bound - sign * 1_000);
        row.begin(sign << 40, -sign << 20, None);
        row.begin(sign << 40, -sign << 20, None);
        (row.velocities[..row.count].to_vec(), row.levels[..=row.count].to_vec())
    }

    /// A pass begins once more where a tree is solved by a descent: a limit that was pressed still acts, the lower one as the upper one.
    #[test]
    fn both_limits_act_alike_in_a_pass_that_begins_twice() {
        let (upper, lower) = (relaxed_steps(1), relaxed_steps(-1));
        let mirrored = |values: &[i64]| values.iter().rev().map(|value| -value).collect::<Vec<i64>>();
        assert_eq!((mirrored(&lower.0), mirrored(&lower.1)), upper);
        assert_eq!(upper.0, [1_000 << 30, 0, -FASTEST as i64]);
    }
}
