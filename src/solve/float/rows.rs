//! Contacts in the solver: rows, matrices, and impulses after a pass, by the formulas and within the limits of the solver in integers.

use core::f64::consts::TAU;

use super::body::Body;
use super::rounding::{ContactUnits, Rounding, power, power_above};
use super::{Pair, Pass, Vector, dot, newton_seconds, within};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::ToF64 as _;
use crate::solve::{Contact, Point, SolverOptions};

/// Vectors (x, y, angular) of both bodies.
type Sides = [Vector; 2];

/// The constants of soft contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softness {
    /// The velocity at which an overlap is pushed out, over the velocity that takes all of it away in a sub-step.
    rate: f64,
    /// The compliance over the effective inverse mass.
    compliance: f64,
    /// The largest velocity by which overlaps are pushed out, with the part that softness takes of it.
    push: f64,
}

impl Softness {
    /// Contacts with a body that cannot be moved are twice as stiff.
    pub(super) fn new(options: &SolverOptions, is_fixed: bool) -> Self {
        let omega = TAU * options.frequency.to_f64() * if is_fixed { 2.0 } else { 1.0 };
        let sum = 2.0 * options.damping_ratio.to_f64() + omega;
        let compliance = 1.0 / (omega * sum);
        Self { rate: omega / sum, compliance, push: options.push_speed.to_f64() * (1.0 + compliance) }
    }
}

/// Elements of the matrix of both normal rows and the tangent row.
#[derive(Clone, Copy)]
struct Elements {
    normal: Pair,
    /// Between the normal rows.
    across: f64,
    tangent: f64,
    /// Between the tangent and the normal rows.
    coupling: Pair,
}

impl Elements {
    /// The elements of one body. `ulp` is the resolution of masses in the solver in integers.
    fn new(rows: &[Sides; 3], side: usize, body: &Body, ulp: f64, rounding: &mut Rounding) -> Self {
        let mut element = |i: usize, j: usize| {
            let sum = (0..3).map(|c| rows[i][side][c] * body.inverse_mass[c] * rows[j][side][c]).sum();
            // The masses are rounded, and so are their products with both rows: errors of half an ulp.
            rounding.rounded(sum, 2.0 * ulp)
        };
        Self {
            normal: [element(0, 0), element(1, 1)],
            across: element(0, 1),
            tangent: element(2, 2),
            coupling: [element(2, 0), element(2, 1)],
        }
    }

    /// The sums over two bodies, with a share of each.
    fn sum([a, b]: &[Self; 2], shares: Pair) -> Self {
        let sum = |a: f64, b: f64| shares[0] * a + shares[1] * b;
        Self {
            normal: [0, 1].map(|k| sum(a.normal[k], b.normal[k])),
            across: sum(a.across, b.across),
            tangent: sum(a.tangent, b.tangent),
            coupling: [0, 1].map(|k| sum(a.coupling[k], b.coupling[k])),
        }
    }
}

/// A contact in the passes.
#[derive(Debug)]
pub(super) struct Rows {
    /// The index of the contact.
    pub(super) contact: u32,
    pub(super) bodies: [u32; 2],
    units: ContactUnits,
    pub(super) is_double: bool,
    /// Both normals and the tangent.
    rows: [Sides; 3],
    /// Changes of velocity by impulses along them.
    gains: [Sides; 3],
    /// The separation of both points at the start, m.
    pub(super) separation: Pair,
    /// Impulses of the sub-step, the sums over sub-steps, and the sums over sub-steps of the impulses applied up to the move.
    pub(super) impulses: Vector,
    pub(super) applied: Vector,
    pub(super) weighted: Vector,
    solution: Solution,
    /// The inverse of the tangent row, and its coupling to the normal rows.
    slip_inverse: f64,
    coupling: Pair,
    pub(super) friction: f64,
    surface_speed: f64,
    pub(super) restitution: f64,
    pub(super) roll: Roll,
}

/// Rolling resistance of a contact with one point: its impulse acts at the lever of the radius.
#[derive(Debug)]
pub(super) struct Roll {
    /// The coefficient; zero for a contact that does not resist rolling.
    resistance: f64,
    /// m
    radius: f64,
    /// The change of the velocity R·(ω_b − ω_a) by the impulse, 1/kg, with the shares of both bodies.
    ease: f64,
    pub(super) impulse: f64,
    pub(super) applied: f64,
    pub(super) weighted: f64,
}

/// The solution of both normal rows.
#[derive(Debug)]
struct Solution {
    /// Elements 11, 22 and 12 of the inverse: with no point soft, the first, the second, both.
    inverse: [Vector; 4],
    /// Element 12 over the diagonal one by point: rigid and soft.
    ratio: [Pair; 2],
    compliance: Pair,
    softness: Softness,
}

impl Solution {
    /// The solution for the matrices of whole bodies and of their shares. `ulp` is the resolution of masses.
    fn new(
        whole: &Elements,
        split: &Elements,
        is_double: bool,
        softness: Softness,
        ulp: f64,
        units: &ContactUnits,
        rounding: &mut Rounding,
    ) -> Self {
        let [across, coupled] = if is_double { [split.across, whole.across.max(0.0)] } else { [0.0; 2] };
        // Two points close together make the matrix nearly singular: it gets a larger diagonal. Both points of a body that can only turn, or
        // only move, are solved one by one, each as one of half of the body.
        let product = split.normal[0] * split.normal[1];
        let determinant = product - across * across;
        let is_single = is_double && determinant <= product * power(-28);
        let diagonal_factor = if is_single {
            2.0
        } else if determinant < product / 64.0 {
            1.0 + power(-13)
        } else {
            1.0
        };
        // No row moves the other one by more than four times as much as itself.
        let diagonal = split.normal.map(|k| (k * diagonal_factor).max(across.abs() / 4.0));
        let across = if is_single { 0.0 } else { across };
        let soft = whole.normal.map(|k| (k + coupled) * softness.compliance + rounding.within(ulp));
        let mut ratio = |k: f64| across / k + rounding.within(power(-28));
        Self {
            ratio: [0, 1].map(|k| [ratio(diagonal[k]), ratio(diagonal[k] + soft[k])]),
            inverse: inverses(diagonal, across, soft, is_double, rounding),
            compliance: soft.map(|soft| soft.min(units.factor() / 4.0) + rounding.within(units.half())),
            softness,
        }
    }
}

/// Inverses with the diagonal of each point made softer, or not.
fn inverses(diagonal: Pair, across: f64, soft: Pair, is_double: bool, rounding: &mut Rounding) -> [Vector; 4] {
    let exact = [0, 1, 2, 3].map(|set| {
        let [k11, k22] = [0, 1].map(|k| diagonal[k] + if set >> k & 1 == 1 { soft[k] } else { 0.0 });
        if !is_double {
            return [1.0 / k11, 0.0, 0.0];
        }
        let determinant = k11 * k22 - across * across;
        if determinant > 0.0 { [k22 / determinant, k11 / determinant, -across / determinant] } else { [0.0; 3] }
    });
    // All four have one resolution: 30 bits for the largest element, and 2^-29 of their own largest one. Where points are close together
    // the rigid inverse is up to 2^12 times as large as the soft ones, and elements cancel. So a solve pass takes a common
    // velocity of both points away with an error of up to 2^-17 or so, most of which the relax pass after it takes away.
    let largest = |elements: &[f64]| elements.iter().copied().fold(0.0, f64::max);
    let resolution = power(-30) * power_above(largest(exact.as_flattened()));
    exact.map(|inverse| {
        let limit = resolution / 2.0 + power(-29) * largest(&inverse);
        inverse.map(|element| rounding.rounded(element, limit))
    })
}

/// The rows of a contact: both normals, and the tangent in the middle of the points.
fn rows(contact: &Contact, lengths: Pair, rounding: &mut Rounding) -> [Sides; 3] {
    let [nx, ny] = contact.normal.map(|n| f64::from(n) / f64::from(1 << 30));
    let ends = [&contact.points[0], &contact.points[contact.count - 1]];
    let flat = |arm: Vec2| [arm.x.to_f64(), arm.y.to_f64()];
    let mut row = |side: usize, [x, y]: Pair, [ux, uy]: Pair| {
        // Both components are rounded to 2^-30 of the length, and so is the result.
        [ux, uy, x * uy - y * ux + rounding.within(power(-30) * lengths[side])]
    };
    let mut normal = |point: &Point| [0, 1].map(|side| row(side, flat(point.arms[side]), [nx, ny]));
    let first = normal(ends[0]);
    let second = if contact.count == 1 { first } else { normal(ends[1]) };
    let tangent = [0, 1].map(|side| {
        let ([x1, y1], [x2, y2]) = (flat(ends[0].arms[side]), flat(ends[1].arms[side]));
        row(side, [(x1 + x2) / 2.0, (y1 + y2) / 2.0], [ny, -nx])
    });
    [first, second, tangent]
}

impl Rows {
    /// The rows of a contact, for the number of contacts that each body has in the phase. `None` if neither body can be moved along the
    /// normal.
    pub(super) fn new(
        index: u32,
        contact: &Contact,
        bodies: [&Body; 2],
        shares: Pair,
        options: &SolverOptions,
        rounding: &mut Rounding,
    ) -> Option<Self> {
        let units = rounding.contact(index as usize);
        let rows = rows(contact, bodies.map(|body| body.units.length), rounding);
        let largest = |body: &Body| {
            let [x, y, turn] = body.inverse_mass;
            x.max(y).max(turn * body.units.length * body.units.length)
        };
        let ulp = power(-31) * power_above(largest(bodies[0]).max(largest(bodies[1])));
        let sides = [0, 1].map(|side| Elements::new(&rows, side, bodies[side], ulp, rounding));
        let (whole, split) = (Elements::sum(&sides, [1.0; 2]), Elements::sum(&sides, shares));
        if whole.normal.iter().any(|&k| k <= 0.0) {
            return None;
        }
        let is_double = contact.count == 2;
        let factor = units.factor();
        let half = units.half();
        let mut gain = |k: usize, side: usize, c: usize| {
            let resolution = if c == 2 { half * power(units.angular_shift) } else { half };
            let length = if c == 2 { bodies[side].units.length } else { 1.0 };
            rounding.rounded(rows[k][side][c] * bodies[side].inverse_mass[c], (resolution + ulp) / length)
        };
        let gains = [0, 1, 2].map(|k| [0, 1].map(|side| [0, 1, 2].map(|c| gain(k, side, c))));
        let is_fixed = bodies.iter().any(|body| body.inverse_mass[..2] == [0.0; 2]);
        let softness = Softness::new(options, is_fixed);
        let impulses = newton_seconds(contact.impulses);
        let slip_error = rounding.within(power(-28) / factor + power(-29) / split.tangent);
        let resists = !is_double && contact.rolling_resistance > Fx::ZERO && contact.rolling_radius > Fx::ZERO;
        Some(Self {
            contact: index,
            bodies: contact.bodies,
            units,
            is_double,
            rows,
            gains,
            separation: [0, contact.count - 1].map(|k| contact.points[k].separation.to_f64()),
            impulses: if is_double { impulses } else { [impulses[0], 0.0, impulses[2]] },
            applied: [0.0; 3],
            weighted: [0.0; 3],
            solution: Solution::new(&whole, &split, is_double, softness, ulp, &units, rounding),
            // In 2^-27, and the reciprocal has 30 bits.
            slip_inverse: if split.tangent > 0.0 { 1.0 / split.tangent + slip_error } else { 0.0 },
            coupling: whole.coupling.map(|k| within(k, factor / 4.0) + rounding.within(half)),
            friction: rounding.rounded(contact.friction.to_f64(), power(-27)).max(0.0),
            surface_speed: contact.surface_speed.to_f64(),
            restitution: contact.restitution.to_f64(),
            roll: Roll {
                resistance: if resists { contact.rolling_resistance.to_f64() } else { 0.0 },
                radius: contact.rolling_radius.to_f64(),
                ease: 0.0,
                impulse: if resists { impulses[1] } else { 0.0 },
                applied: 0.0,
                weighted: 0.0,
            },
        })
    }

    /// Sets how many contacts of the phase resist the rolling of each body. Where no torque turns either body, nothing resists.
    pub(super) fn share_roll(&mut self, bodies: [&Body; 2], shares: Pair) {
        let turn = shares[0] * bodies[0].inverse_mass[2] + shares[1] * bodies[1].inverse_mass[2];
        self.roll.ease = self.roll.radius * self.roll.radius * turn;
        if self.roll.ease == 0.0 {
            self.roll.resistance = 0.0;
        }
    }

    /// The limit of the impulse of rolling resistance.
    pub(super) fn roll_limit(&self) -> f64 {
        self.roll.resistance * self.impulses[0]
    }

    /// The component along a row of a velocity or a displacement of both bodies.
    pub(super) fn along(&self, row: usize, vectors: [Vector; 2]) -> f64 {
        dot(&self.rows[row][1], &vectors[1]) - dot(&self.rows[row][0], &vectors[0])
    }

    /// The impulses on both bodies for impulses along the rows.
    pub(super) fn on_bodies(&self, impulses: Vector) -> [Vector; 2] {
        products(&self.rows, impulses)
    }

    /// The impulses after a pass, for sub-steps of `h` seconds.
    fn solved(&self, bodies: &[Body], h: f64, pass: Pass, rounding: &mut Rounding) -> Vector {
        let velocities = self.bodies.map(|body| bodies[body as usize].rounded_velocity);
        let moved = self.bodies.map(|body| bodies[body as usize].displacement);
        let ContactUnits { velocity: velocity_unit, impulse: impulse_unit, push: fastest_push, .. } = self.units;
        let Solution { inverse, ratio, compliance, softness } = &self.solution;
        let before = self.impulses;
        let mut pressed = [0; 2];
        let mut wanted = [0.0; 2];
        for k in 0..2 {
            let separation = self.separation[k] + self.along(k, moved) + rounding.within(velocity_unit * h);
            let velocity = self.along(k, velocities) + rounding.within(velocity_unit);
            if pass == Pass::Solve && separation <= 0.0 {
                pressed[k] = 1;
                let push = (softness.rate * separation / h).max(-softness.push.min(fastest_push));
                wanted[k] = velocity + push + compliance[k] * before[k];
            } else {
                wanted[k] = velocity + (separation / h).max(0.0);
            }
        }
        let [i11, i22, i12] = inverse[pressed[0] + 2 * pressed[1]];
        let x1 = before[0] - (i11 * wanted[0] + i12 * wanted[1]) + rounding.within(impulse_unit);
        let x2 = match self.is_double {
            true => before[1] - (i12 * wanted[0] + i22 * wanted[1]) + rounding.within(impulse_unit),
            false => 0.0,
        };
        let alone = |k: usize, x: f64, opposite_x: f64| (x + ratio[k][pressed[k]] * opposite_x.min(0.0)).max(0.0);
        let [n1, n2] = [alone(0, x1, x2), alone(1, x2, x1)];
        if pass == Pass::Solve {
            return [n1, n2, before[2]];
        }
        let coupled = self.coupling[0] * (n1 - before[0]) + self.coupling[1] * (n2 - before[1]);
        let slip = self.along(2, velocities) + coupled - self.surface_speed + rounding.within(velocity_unit);
        let friction = before[2] - slip * self.slip_inverse + rounding.within(impulse_unit);
        let friction = within(friction, self.friction * (n1 + n2));
        [n1, n2, if pass == Pass::RelaxAgain { within(friction, before[2].abs()) } else { friction }]
    }

    /// Computes the impulses of a pass, and adds the changes of the bodies' velocities by them.
    pub(super) fn run(&mut self, bodies: &mut [Body], h: f64, pass: Pass, rounding: &mut Rounding) {
        let mut change = self.impulses;
        if pass != Pass::WarmStart {
            let impulses = self.solved(bodies, h, pass, rounding);
            change = [0, 1, 2].map(|k| impulses[k] - self.impulses[k]);
            if pass == Pass::Relax {
                self.weighted = [0, 1, 2].map(|k| self.weighted[k] + self.applied[k] + self.impulses[k]);
                self.applied = [0, 1, 2].map(|k| self.applied[k] + self.impulses[k]);
            }
            if pass != Pass::Solve {
                self.applied = [0, 1, 2].map(|k| self.applied[k] + change[k]);
            }
            self.impulses = impulses;
        }
        for (body, gain) in self.bodies.into_iter().zip(products(&self.gains, change)) {
            bodies[body as usize].add_gain(gain);
        }
    }

    /// A pass over rolling resistance, after the friction of the phase: its row sees the velocities that friction left.
    pub(super) fn run_roll(&mut self, bodies: &mut [Body], pass: Pass, rounding: &mut Rounding) {
        let roll = &mut self.roll;
        let before = roll.impulse;
        let mut change = before;
        if pass != Pass::WarmStart {
            let [a, b] = self.bodies.map(|body| bodies[body as usize].rounded_velocity[2]);
            // The reciprocal has 30 bits, and its terms are rounded to 2^-30 of a unit.
            let stopping = roll.radius * (b - a) / roll.ease * (1.0 + rounding.within(power(-26)));
            let wanted = before - stopping + rounding.within(self.units.impulse);
            roll.impulse = within(wanted, roll.resistance * self.impulses[0]);
            if pass == Pass::RelaxAgain {
                roll.impulse = within(roll.impulse, before.abs());
            }
            change = roll.impulse - before;
            if pass == Pass::Relax {
                roll.weighted += roll.applied + before;
                roll.applied += before;
            }
            roll.applied += change;
        }
        for (body, turn) in self.bodies.into_iter().zip(roll.turns(change)) {
            let body = &mut bodies[body as usize];
            body.add_gain([0.0, 0.0, turn * body.inverse_mass[2]]);
        }
    }
}

/// Sums of vectors of both bodies, by row and times an impulse each; the first body is pushed the other way.
fn products(vectors: &[Sides; 3], impulses: Vector) -> [Vector; 2] {
    [0, 1].map(|side| {
        let sign = if side == 0 { -1.0 } else { 1.0 };
        [0, 1, 2].map(|c| sign * (0..3).map(|k| vectors[k][side][c] * impulses[k]).sum::<f64>())
    })
}

impl Roll {
    pub(super) fn resists(&self) -> bool {
        self.resistance > 0.0
    }

    /// The angular impulses on both bodies by an impulse of rolling resistance.
    pub(super) fn turns(&self, impulse: f64) -> Pair {
        [-self.radius * impulse, self.radius * impulse]
    }
}
