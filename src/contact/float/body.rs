//! Bodies through the sub-steps, and what impulses change of their free flight.

use super::number::{Float, Pair, Vector, dot};
use crate::body::Bodies;
use crate::contact::{Correction, Scene, Start};
use crate::math::{TimeStep, Vec2};

/// A body and its free flight over the step.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Flight<F> {
    /// The centre of mass at the start, m.
    pub(super) position: Pair<F>,
    /// The velocities at the start and at the end.
    pub(super) start: Vector<F>,
    pub(super) end: Vector<F>,
    /// The displacement, m, and the angle turned, rad.
    pub(super) displacement: Vector<F>,
    /// kg and kg·m².
    pub(super) mass: Vector<F>,
    /// 1/kg and 1/(kg·m²).
    pub(super) inverse: Vector<F>,
    /// The flight that this one follows through the sub-steps.
    pub(super) leader: Option<u32>,
}

/// The angle turned in a step, rad: the way between two angles, and as many whole turns as the velocities say.
fn turned<F: Float>(from: F, to: F, velocities: Pair<F>, seconds: F) -> F {
    let way = from.way(to);
    let about = (velocities[0] + velocities[1]) * F::of(0.5) * seconds;
    let turns = libm::rint((about - way).to_f64() / core::f64::consts::TAU);
    way + F::of(turns * core::f64::consts::TAU)
}

/// The seconds of a step.
pub(super) fn seconds<F: Float>(time_step: TimeStep) -> F {
    let (num, den) = time_step.seconds();
    F::of(f64::from(num) / f64::from(den))
}

fn vector<F: Copy>(v: Vec2<F>, angular: F) -> Vector<F> {
    [v.x, v.y, angular]
}

impl<F: Float> Flight<F> {
    /// The flight of a moving body.
    pub(super) fn moving(scene: &Scene<'_, F>, start: &Start<F>) -> Self {
        let (bodies, dense): (&Bodies<F>, usize) = (scene.bodies, start.dense);
        let motion = &bodies.columns.motion;
        let (info, mass) = (bodies.info(dense), bodies.mass(dense));
        let (from, to) = (
            vector(start.velocity, start.angular_velocity),
            vector(motion.velocity.get(dense), motion.angular_velocity[dense]),
        );
        let way = motion.position.get(dense) - start.position;
        let rotation = turned(start.angle, motion.angle[dense], [from[2], to[2]], seconds(scene.time_step));
        let kilograms = info.kilograms();
        Self {
            position: [start.position.x, start.position.y],
            start: from,
            end: to,
            displacement: vector(way, rotation),
            mass: [kilograms, kilograms, info.inertia_for(kilograms)],
            inverse: vector(mass.axis_inverse_mass, mass.inverse_inertia),
            leader: None,
        }
    }

    /// A body that stands still.
    pub(super) fn still(position: Vec2<F>) -> Self {
        let zero = [F::of(0.0); 3];
        Self {
            position: [position.x, position.y],
            start: zero,
            end: zero,
            displacement: zero,
            mass: zero,
            inverse: zero,
            leader: None,
        }
    }

    pub(super) fn is_fixed(&self) -> bool {
        self.inverse == [F::of(0.0); 3]
    }

    /// The distance that a point of a collider moves by the rotation of its body: at most twice its radius.
    pub(super) fn turned(&self, radius: F) -> F {
        (self.displacement[2].size() * radius).or_less(radius + radius)
    }
}

/// A body through the sub-steps. The velocity is that which contacts see: semi-implicit Euler, whatever integrator makes the flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<F> {
    pub(super) inverse: Vector<F>,
    pub(super) start: Vector<F>,
    /// The change of velocity by the free flight.
    pub(super) change: Vector<F>,
    pub(super) velocity: Vector<F>,
    pub(super) displacement: Vector<F>,
    /// The velocity of the free flight in this sub-step, and the correction of it before the contacts of the sub-step.
    flight: Vector<F>,
    before: Vector<F>,
    /// The change of velocity by the contacts of a phase.
    gain: Vector<F>,
    /// The impulses of the step, and those weighted by the sub-steps that they moved the body in.
    pub(super) applied: Vector<F>,
    pub(super) weighted: Vector<F>,
}

impl<F: Float> Body<F> {
    pub(super) fn new(flight: &Flight<F>) -> Self {
        let zero = [F::of(0.0); 3];
        Self {
            inverse: flight.inverse,
            start: flight.start,
            change: [0, 1, 2].map(|i| flight.end[i] - flight.start[i]),
            velocity: flight.start,
            displacement: zero,
            flight: flight.start,
            before: zero,
            gain: zero,
            applied: zero,
            weighted: zero,
        }
    }

    /// The beginning of sub-step `k` of `n`: the velocity of the free flight there, the corrections so far and, from the second
    /// sub-step on, once more the change that the contacts of the sub-step before made.
    pub(super) fn begin(&mut self, k: u32, n: u32) {
        let share = F::of(f64::from(k) / f64::from(n));
        for i in 0..3 {
            let w = self.start[i] + self.change[i] * share;
            let correction = if k > 1 { self.velocity[i] - self.flight[i] } else { F::of(0.0) };
            self.velocity[i] = w + correction + (correction - self.before[i]);
            (self.before[i], self.flight[i]) = (correction, w);
        }
    }

    pub(super) fn advance(&mut self, substep: F) {
        for i in 0..3 {
            self.displacement[i] += self.velocity[i] * substep;
        }
    }

    pub(super) fn add_gain(&mut self, gain: Vector<F>) {
        (0..3).for_each(|i| self.gain[i] += gain[i]);
    }

    /// Applies the changes by all contacts of a phase.
    pub(super) fn take_gain(&mut self) {
        (0..3).for_each(|i| self.velocity[i] += self.gain[i]);
        self.gain = [F::of(0.0); 3];
    }

    /// The change by the impulses of the step, for `n` sub-steps.
    pub(super) fn correction(&self, flight: &Flight<F>, substep: F, n: u32) -> Correction<F> {
        let zero = [F::of(0.0); 3];
        if self.applied == zero && self.weighted == zero {
            return Correction::default();
        }
        let change = [0, 1, 2].map(|i| self.applied[i] * self.inverse[i]);
        let (count, half) = (F::of(n.into()), F::of(f64::from(n + 1) / 2.0));
        // How much farther sub-steps of semi-implicit Euler lead than the free flight.
        let offset =
            [0, 1, 2].map(|i| substep * (count * self.start[i] + self.change[i] * half) - flight.displacement[i]);
        let moved = [0, 1, 2].map(|i| self.weighted[i] * self.inverse[i] * substep);
        let [x, y] = cancelled([change[0], change[1]], [self.change[0], self.change[1]], [offset[0], offset[1]]);
        let [turn] = cancelled([change[2]], [self.change[2]], [offset[2]]);
        Correction {
            is_pushed: true,
            velocity: Vec2::new(change[0], change[1]),
            angular_velocity: change[2],
            displacement: Vec2::new(moved[0] + x, moved[1] + y),
            rotation: moved[2] + turn,
        }
    }
}

/// The part of an offset along a change of velocity by impulses, as far as they cancel the change `flown` of the free flight.
fn cancelled<F: Float, const N: usize>(change: [F; N], flown: [F; N], offset: [F; N]) -> [F; N] {
    let against = -dot(change, flown);
    if against <= F::of(0.0) {
        return [F::of(0.0); N];
    }
    let share = dot(change, offset) / dot(change, change).or_more(against);
    change.map(|v| v * share)
}
