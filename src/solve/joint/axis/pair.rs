//! The rows of a planar joint, whose forces are bounds of vectors.

use super::super::length_of;
use super::{AxisRow, Place};
use crate::solve::number::divided;

/// The largest impulse of a paired row alone.
const UNBOUNDED: i64 = 1 << 55;

/// A vector shortened to a length, to nearest; `None` if it is not longer. *Domain* components within ±2^61, length within 2^60.
fn shortened(vector: [i64; 2], length: i64) -> Option<[i64; 2]> {
    let [x, y] = vector.map(i128::from);
    let bound = i128::from(length);
    if x * x + y * y <= bound * bound {
        return None;
    }
    let longer = length_of(vector[0], vector[1]).max(1);
    // Below 2^121.
    Some([x, y].map(|part| divided(part * bound, longer) as i64))
}

impl AxisRow {
    /// The row as one of a pair: its bounds are bounds of the pair.
    pub(in super::super) fn paired(self) -> Self {
        let Self { motor, spring, .. } = self;
        let unbounded = |force: i64| if force > 0 { UNBOUNDED } else { 0 };
        Self { motor: unbounded(motor), spring: unbounded(spring), pair: Some([motor, spring]), ..self }
    }

    pub(in super::super) fn is_paired(&self) -> bool {
        self.pair.is_some()
    }

    /// Shortens the impulses of a pair at the end of a pass, where they are beyond their bounds: first the impulses of the springs, against which the
    /// motors act in the next round, then the impulses of the motors. Returns true if an impulse changes.
    pub(in super::super) fn revise_pair(pair: &mut [Self; 2], impulses: [i64; 2]) -> bool {
        let Some([motor_bound, spring_bound]) = pair[0].pair else { return false };
        let springs = [0, 1].map(|row| pair[row].spring_part(impulses[row]));
        let motors = [impulses[0] - springs[0], impulses[1] - springs[1]];
        let short_springs = shortened(springs, spring_bound).filter(|_| pair[0].is_biased && pair[0].strain.is_none());
        let short_motors = shortened(motors, motor_bound).filter(|_| pair[0].count > 0);
        for row in 0..2 {
            let law = &mut pair[row];
            if law.is_biased {
                law.spring_impulse = short_springs.unwrap_or(springs)[row];
            }
            match (short_springs, short_motors) {
                (Some(springs), _) => law.strain = Some(springs[row]),
                (None, Some(motors)) => (law.count, law.levels[0], law.place) = (0, motors[row], Place::Level(0)),
                (None, None) => {}
            }
        }
        short_springs.is_some() || short_motors.is_some()
    }

    /// Shortens the impulses of a pair after an iteration of a descent: the motors within their bound, the springs within theirs.
    pub(in super::super) fn shorten_pair(pair: &mut [Self; 2]) {
        let Some([motor_bound, spring_bound]) = pair[0].pair else { return };
        let springs = [0, 1].map(|row| pair[row].spring_impulse);
        let motors = [0, 1].map(|row| match pair[row].place {
            Place::Given(impulse) => impulse - springs[row],
            _ => 0,
        });
        let springs = shortened(springs, spring_bound).unwrap_or(springs);
        let motors = shortened(motors, motor_bound).unwrap_or(motors);
        for row in 0..2 {
            pair[row].place = Place::Given(motors[row] + springs[row]);
            if pair[row].is_biased {
                pair[row].spring_impulse = springs[row];
            }
        }
    }
}
