//! A step of contacts in doubles, written from the formulas in plain quantities: m, m/s, N·s.
//!
//! The twin is exact, or it rounds at random wherever the solver rounds, within the same limits. It has the solver's clamps by
//! design: element 12 of a matrix over a diagonal one is within ±4, as it is unless one point gives way sixteen times as easily as
//! the other, and couplings and compliances are at most a quarter of a unit of velocity for a unit of impulse, as all
//! factors of velocities are. Velocities and displacements do not saturate here: the unit has to leave room for them.

mod rows;

use alloc::vec::Vec;

use self::rows::{Rows, Units};
use super::scene::{Scene, signed};
use crate::fx::Fx;
use crate::math::{Random, Vec2};
use crate::scalar::FxFactor;
use crate::solve::unit::FINEST;
use crate::solve::{Flight, PHASES, Solver, Velocity};

/// Components x, y and angular.
pub(super) type Vector = [f64; 3];

pub(super) fn real(value: Fx) -> f64 {
    value.to_bits() as f64 / 2f64.powi(32)
}

fn of_factor(factor: FxFactor) -> f64 {
    let (mantissa, shift) = factor.parts();
    mantissa as f64 * 2f64.powi(-shift)
}

fn flat(v: Vec2) -> [f64; 2] {
    [real(v.x), real(v.y)]
}

/// Errors of rounding: none, or any within a limit.
struct Rounding(Option<Random>);

impl Rounding {
    fn within(&mut self, limit: f64) -> f64 {
        self.0.as_mut().map_or(0.0, |random| limit * signed(random))
    }

    /// The value rounded. Zero stays zero.
    fn of(&mut self, value: f64, limit: f64) -> f64 {
        if value == 0.0 { value } else { value + self.within(limit) }
    }
}

/// A body through the sub-steps.
#[derive(Clone)]
struct Body {
    inverse_mass: Vector,
    /// The length by which the solver divides arms, m.
    length: f64,
    /// The resolution of velocities in the solver.
    unit: Vector,
    /// The velocities of the free flight, rounded to units.
    start: Vector,
    end: Vector,
    /// The change of velocity by the free flight, and how much farther sub-steps of semi-implicit Euler lead.
    change: Vector,
    offset: Vector,
    /// The velocity by the exact impulses.
    velocity: Vector,
    /// The velocity as contacts see it.
    seen: Vector,
    displacement: Vector,
    flight: Vector,
    before: Vector,
    /// Impulses, and those weighted by the sub-steps that they moved the body in.
    applied: Vector,
    weighted: Vector,
}

impl Body {
    fn new(flight: &Flight, unit: f64, (h, n): (f64, f64), rounding: &mut Rounding) -> Self {
        let of = |v: &Velocity| [real(v.linear.x), real(v.linear.y), real(v.angular)];
        let length = 2f64.powi(flight.length());
        let (start, end, unit) = (of(&flight.start), of(&flight.end), [unit, unit, unit / length]);
        let change = [0, 1, 2].map(|i| end[i] - start[i]);
        let [x, y] = flat(flight.displacement);
        let flown = [x, y, real(flight.rotation)];
        let mut rounded = |of: Vector| [0, 1, 2].map(|i| of[i] + rounding.within(unit[i] / 2.0));
        let inverse = [flight.inverse_mass.x, flight.inverse_mass.y, flight.inverse_inertia];
        Self {
            inverse_mass: inverse.map(of_factor),
            length,
            unit,
            start: rounded(start),
            end: rounded(end),
            change,
            offset: [0, 1, 2].map(|i| h * (n * start[i] + change[i] * (n + 1.0) / 2.0) - flown[i]),
            velocity: start,
            seen: start,
            displacement: [0.0; 3],
            flight: start,
            before: [0.0; 3],
            applied: [0.0; 3],
            weighted: [0.0; 3],
        }
    }

    fn begin(&mut self, k: f64, n: f64, rounding: &mut Rounding) {
        for i in 0..3 {
            let w = self.start[i] + k / n * (self.end[i] - self.start[i]);
            let correction = if k > 1.0 { self.velocity[i] - self.flight[i] } else { 0.0 };
            self.velocity[i] = w + correction + (correction - self.before[i]);
            (self.before[i], self.flight[i]) = (correction, w);
        }
        // Up to half a unit is left of each of the three corrections, and is applied after the next phase.
        self.round(if k > 1.0 { 1.5 } else { 0.5 }, rounding);
    }

    fn round(&mut self, units: f64, rounding: &mut Rounding) {
        self.seen = [0, 1, 2].map(|i| self.velocity[i] + rounding.within(units * self.unit[i]));
    }

    fn advance(&mut self, h: f64) {
        for i in 0..3 {
            self.displacement[i] += h * self.seen[i];
        }
    }

    /// The change of velocity, and that of the displacement.
    fn correction(&self, h: f64) -> [Vector; 2] {
        let change = [0, 1, 2].map(|i| self.applied[i] * self.inverse_mass[i]);
        let mut moved = [0, 1, 2].map(|i| self.weighted[i] * self.inverse_mass[i] * h);
        for part in [0..2, 2..3] {
            let sum = |of: &Vector| part.clone().map(|i| of[i] * change[i]).sum::<f64>();
            let against = -sum(&self.change);
            if against > 0.0 {
                let share = sum(&self.offset) / sum(&change).max(against);
                part.for_each(|i| moved[i] += change[i] * share);
            }
        }
        [change, moved]
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Pass {
    WarmStart,
    Solve,
    Relax,
}

/// Bodies and contacts through a step.
pub(super) struct Twin {
    bodies: Vec<Body>,
    phases: [Vec<Rows>; PHASES],
    /// The length of a sub-step, s, and their number.
    h: f64,
    substeps: u32,
    rounding: Rounding,
}

impl Twin {
    /// The exact twin, or one that rounds at random.
    pub(super) fn new(scene: &Scene, seed: Option<u64>) -> Self {
        let mut solver = Solver::default();
        solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
        let ((num, den), substeps) = (scene.time_step.seconds(), scene.options.substeps);
        let h = f64::from(num) / f64::from(den) / f64::from(substeps);
        let mut rounding = Rounding(seed.map(Random::seeded));
        let body = |(flight, &unit): (&Flight, &i32)| {
            // Bodies that are fixed or touch nothing have no unit.
            let unit = 2f64.powi(if unit == 0 { FINEST } else { unit });
            Body::new(flight, unit, (h, substeps.into()), &mut rounding)
        };
        let bodies: Vec<Body> = scene.flights.iter().zip(&solver.unit_of).map(body).collect();
        let mut phases = [const { Vec::new() }; PHASES];
        for (index, contact) in scene.contacts.iter().enumerate() {
            let phase = solver.graph.phase(contact.bodies);
            let place = solver.places.iter().find(|of| of.contact as usize == index).expect("all have places");
            let mover = solver.graph.mover(contact.bodies).expect("one can be moved");
            let units = Units {
                velocity: bodies[mover as usize].unit[0],
                impulse: 2f64.powi(place.exponent),
                angular_shift: solver.groups[place.group as usize].angular_shift[place.lane as usize] as i32,
            };
            let beside = || scene.contacts.iter().filter(|of| solver.graph.phase(of.bodies) == phase);
            let shares = contact.bodies.map(|body| beside().filter(|of| of.bodies.contains(&body)).count() as f64);
            phases[phase].push(Rows::new(scene, contact, &bodies, (shares, units), &mut rounding));
        }
        Self { bodies, phases, h, substeps, rounding }
    }

    fn pass(&mut self, pass: Pass) {
        (0..PHASES).for_each(|phase| self.phase(phase, pass));
    }

    fn phase(&mut self, phase: usize, pass: Pass) {
        let Self { bodies, phases, h, rounding, .. } = self;
        let mut after: Vec<Vector> = bodies.iter().map(|body| body.velocity).collect();
        for of in &mut phases[phase] {
            let mut change = of.impulses;
            if pass != Pass::WarmStart {
                let impulses = of.solved(bodies, *h, pass == Pass::Solve, rounding);
                change = [0, 1, 2].map(|k| impulses[k] - of.impulses[k]);
                if pass == Pass::Relax {
                    of.weighted = [0, 1, 2].map(|k| of.weighted[k] + of.applied[k] + of.impulses[k]);
                    of.applied = [0, 1, 2].map(|k| of.applied[k] + impulses[k]);
                }
                of.impulses = impulses;
            }
            of.push(&of.gains, change, |body, gain| (0..3).for_each(|i| after[body][i] += gain[i]));
        }
        for (body, velocity) in bodies.iter_mut().zip(after) {
            body.velocity = velocity;
            body.round(0.5, rounding);
        }
        if pass != Pass::Solve {
            self.roll(phase, pass);
        }
    }

    /// The rows of rolling resistance of a phase, which see what its friction left.
    fn roll(&mut self, phase: usize, pass: Pass) {
        let Self { bodies, phases, rounding, .. } = self;
        let mut after: Vec<f64> = bodies.iter().map(|body| body.velocity[2]).collect();
        let count = |body: usize| phases[phase].iter().filter(|of| of.rolls() && of.bodies.contains(&body)).count();
        let shares: Vec<f64> = (0..bodies.len()).map(|body| count(body) as f64).collect();
        for of in phases[phase].iter_mut().filter(|of| of.rolls()) {
            let before = of.roll.impulse;
            let mut change = before;
            if pass == Pass::Relax {
                let [a, b] = of.bodies;
                let radius = of.roll.radius;
                let easy = |body: usize| shares[body] * radius * radius * bodies[body].inverse_mass[2];
                let velocity = radius * (bodies[b].seen[2] - bodies[a].seen[2]);
                let limit = of.roll.resistance * of.impulses[0];
                // The reciprocal has 30 bits, and its terms are rounded to 2^-30 of a unit.
                let wanted = velocity / (easy(a) + easy(b));
                let wanted =
                    before - wanted * (1.0 + rounding.within(2f64.powi(-26))) + rounding.within(of.units.impulse);
                of.roll.impulse = wanted.clamp(-limit, limit);
                of.roll.weighted += of.roll.applied + before;
                of.roll.applied += of.roll.impulse;
                change = of.roll.impulse - before;
            }
            for (body, turn) in of.bodies.into_iter().zip(of.turns(change)) {
                after[body] += turn * bodies[body].inverse_mass[2];
            }
        }
        for (body, velocity) in bodies.iter_mut().zip(after) {
            body.velocity[2] = velocity;
            body.round(0.5, rounding);
        }
    }

    /// Velocities and displacements by the step, of all bodies, in units of the solver.
    pub(super) fn run(mut self) -> Vec<[Vector; 2]> {
        for k in 1..=self.substeps {
            let rounding = &mut self.rounding;
            self.bodies.iter_mut().for_each(|body| body.begin(k.into(), self.substeps.into(), rounding));
            if k == 1 {
                self.pass(Pass::WarmStart);
            }
            self.pass(Pass::Solve);
            self.bodies.iter_mut().for_each(|body| body.advance(self.h));
            self.pass(Pass::Relax);
        }
        let bodies = &mut self.bodies;
        for of in self.phases.iter().flatten() {
            of.push(&of.rows, of.applied, |body, sum| (0..3).for_each(|i| bodies[body].applied[i] += sum[i]));
            of.push(&of.rows, of.weighted, |body, sum| (0..3).for_each(|i| bodies[body].weighted[i] += sum[i]));
            let (applied, weighted) = (of.turns(of.roll.applied), of.turns(of.roll.weighted));
            for (side, body) in of.bodies.into_iter().enumerate() {
                bodies[body].applied[2] += applied[side];
                bodies[body].weighted[2] += weighted[side];
            }
        }
        (0..self.bodies.len()).map(|body| self.in_units(body, self.bodies[body].correction(self.h))).collect()
    }

    /// A change of velocity and one of displacement, of a body.
    pub(super) fn in_units(&self, body: usize, [velocity, moved]: [Vector; 2]) -> [Vector; 2] {
        let (unit, step) = (self.bodies[body].unit, self.h * f64::from(self.substeps));
        [[0, 1, 2].map(|i| velocity[i] / unit[i]), [0, 1, 2].map(|i| moved[i] / (step * unit[i]))]
    }
}
