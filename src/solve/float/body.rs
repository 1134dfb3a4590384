//! Bodies through the sub-steps, and the corrections of their free flight by impulses.

use super::rounding::{BodyUnits, Rounding};
use super::{Clock, Vector, dot};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Accumulator, FxAccumulator, ToF64 as _};
use crate::solve::apply::Path;
use crate::solve::{Correction, Flight};

/// A body through the sub-steps.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) inverse_mass: Vector,
    pub(super) units: BodyUnits,
    /// The velocities of the free flight, rounded to units.
    pub(super) start: Vector,
    end: Vector,
    /// The change of velocity by the free flight, and how much farther sub-steps of semi-implicit Euler lead.
    pub(super) change: Vector,
    offset: Vector,
    /// The way of a body to which impulses add.
    path: Path,
    /// The excess of the displacement over the displacement of the body, at the end of the step: joints hold points where bodies really are.
    pub(super) shift: Vector,
    /// The velocity by the exact impulses.
    pub(super) velocity: Vector,
    /// The velocity rounded to units, as contacts see it.
    pub(super) rounded_velocity: Vector,
    pub(super) displacement: Vector,
    /// The velocity of the free flight in this sub-step, and the correction of it before the contacts of the sub-step.
    flight: Vector,
    before: Vector,
    /// The change of velocity by the contacts of a phase.
    gain: Vector,
    /// The impulses of the step, and the impulses weighted by the sub-steps that they moved the body in.
    pub(super) applied: Vector,
    pub(super) weighted: Vector,
}

fn vector(linear: Vec2, angular: Fx) -> Vector {
    [linear.x.to_f64(), linear.y.to_f64(), angular.to_f64()]
}

impl Body {
    pub(super) fn new(flight: &Flight, units: BodyUnits, clock: Clock, rounding: &mut Rounding) -> Self {
        let Flight { start, end, .. } = flight;
        let [start, end] = [start, end].map(|velocity| vector(velocity.linear, velocity.angular));
        let change = [0, 1, 2].map(|i| end[i] - start[i]);
        let flown = vector(flight.displacement, flight.rotation);
        let offset = [0, 1, 2].map(|i| {
            let euler = clock.length * (clock.count() * start[i] + change[i] * (clock.count() + 1.0) / 2.0);
            euler - flown[i]
        });
        let mut rounded = |velocity: Vector| [0, 1, 2].map(|i| velocity[i] + rounding.within(units.velocity[i] / 2.0));
        let inverse_mass = [flight.inverse_mass.x, flight.inverse_mass.y, flight.inverse_inertia];
        Self {
            inverse_mass: inverse_mass.map(|factor| factor.to_f64()),
            units,
            start: rounded(start),
            end: rounded(end),
            change,
            offset,
            path: Path::Contacts,
            shift: [0.0; 3],
            velocity: start,
            rounded_velocity: start,
            displacement: [0.0; 3],
            flight: start,
            before: [0.0; 3],
            gain: [0.0; 3],
            applied: [0.0; 3],
            weighted: [0.0; 3],
        }
    }

    /// The beginning of sub-step `k` of `n`: the velocity of the free flight there, the corrections so far and, from the second
    /// sub-step on, once more the change that the contacts of the sub-step before made.
    pub(super) fn begin(&mut self, k: u32, n: u32, rounding: &mut Rounding) {
        let share = f64::from(k) / f64::from(n);
        for i in 0..3 {
            let flight = self.start[i] + share * (self.end[i] - self.start[i]);
            let correction = if k > 1 { self.velocity[i] - self.flight[i] } else { 0.0 };
            self.velocity[i] = flight + correction + (correction - self.before[i]);
            self.before[i] = correction;
            self.flight[i] = flight;
        }
        // Up to half a unit is left of each of the three corrections, and is applied after the next phase.
        self.round(if k > 1 { 1.5 } else { 0.5 }, rounding);
    }

    fn round(&mut self, units: f64, rounding: &mut Rounding) {
        self.rounded_velocity = [0, 1, 2].map(|i| self.velocity[i] + rounding.within(units * self.units.velocity[i]));
    }

    pub(super) fn advance(&mut self, substep: f64) {
        (0..3).for_each(|i| self.displacement[i] += self.rounded_velocity[i] * substep);
    }

    /// Settles where a body with joints ends the step.
    pub(super) fn set_path(&mut self, path: Path) {
        self.path = path;
        self.shift = if path == Path::Flight { self.offset } else { [0.0; 3] };
    }

    /// The displacement of the body, after a share of the sub-steps.
    pub(super) fn moved(&self, share: f64) -> Vector {
        [0, 1, 2].map(|i| self.displacement[i] - share * self.shift[i])
    }

    /// Applies impulses along x and y and around, of joints.
    pub(super) fn push(&mut self, impulses: Vector) {
        (0..3).for_each(|i| self.velocity[i] += impulses[i] * self.inverse_mass[i]);
        // Worlds whose values are rounded have no joints.
        self.rounded_velocity = self.velocity;
    }

    pub(super) fn add_gain(&mut self, gain: Vector) {
        (0..3).for_each(|i| self.gain[i] += gain[i]);
    }

    /// Applies the changes by all contacts of a phase.
    pub(super) fn take_gain(&mut self, rounding: &mut Rounding) {
        (0..3).for_each(|i| self.velocity[i] += self.gain[i]);
        self.gain = [0.0; 3];
        self.round(0.5, rounding);
    }

    /// Takes over the motion of the body that this one follows.
    pub(super) fn follow(&mut self, leader: &Self) {
        self.velocity = leader.velocity;
        self.rounded_velocity = leader.rounded_velocity;
        self.displacement = leader.displacement;
    }

    /// Adds the part of the offset along the change by impulses, as far as they cancel the change of the free flight.
    fn add_cancelled(&self, moved: &mut Vector, change: &Vector) {
        for part in [0..2, 2..3] {
            let change = &change[part.clone()];
            let against = -dot(change, &self.change[part.clone()]);
            if against > 0.0 {
                let share = dot(change, &self.offset[part.clone()]) / dot(change, change).max(against);
                moved[part].iter_mut().zip(change).for_each(|(moved, change)| *moved += change * share);
            }
        }
    }

    /// The change by the impulses of the step.
    pub(super) fn correction(&self, substep: f64) -> Correction {
        let change = [0, 1, 2].map(|i| self.applied[i] * self.inverse_mass[i]);
        let mut moved = [0, 1, 2].map(|i| self.weighted[i] * self.inverse_mass[i] * substep);
        match self.path {
            Path::Contacts => self.add_cancelled(&mut moved, &change),
            Path::Substeps => (0..3).for_each(|i| moved[i] += self.offset[i]),
            Path::Flight => {}
        }
        let fixed = |value: f64| -> FxAccumulator { Accumulator::<f64>::to_fixed(value) };
        let mut correction = Correction {
            is_pushed: false,
            velocity: Vec2::new(fixed(change[0]), fixed(change[1])),
            angular_velocity: fixed(change[2]),
            displacement: Vec2::new(fixed(moved[0]), fixed(moved[1])),
            rotation: fixed(moved[2]),
        };
        correction.is_pushed = correction != Correction::default();
        correction
    }
}
