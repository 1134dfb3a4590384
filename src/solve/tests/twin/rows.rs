//! Contacts of the twin: rows, matrices, and impulses after a pass.

use core::f64::consts::TAU;

use super::{Body, Rounding, Vector, flat, real};
use crate::solve::Contact;
use crate::solve::tests::scene::Scene;

/// Vectors (x, y, angular) of both bodies.
type Sides = [Vector; 2];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The power of two above a positive number.
fn power_above(value: f64) -> f64 {
    2.0 * value.log2().floor().exp2()
}

/// The units of a contact in the solver.
#[derive(Clone, Copy)]
pub(super) struct Units {
    pub(super) velocity: f64,
    pub(super) impulse: f64,
    /// log2 of the resolution of factors of angular velocities over that of velocities.
    pub(super) angular_shift: i32,
}

impl Units {
    /// A unit of velocity for a unit of impulse, 1/kg.
    fn one(&self) -> f64 {
        self.velocity / self.impulse
    }

    /// Half the resolution of factors in 2^-30.
    fn half(&self) -> f64 {
        self.one() * 2f64.powi(-31)
    }
}

/// A contact.
pub(super) struct Rows {
    pub(super) bodies: [usize; 2],
    pub(super) units: Units,
    two: bool,
    /// Both normals and the tangent.
    pub(super) rows: [Sides; 3],
    /// Changes of velocity by impulses along them.
    pub(super) gains: [Sides; 3],
    separation: [f64; 2],
    pub(super) impulses: Vector,
    pub(super) applied: Vector,
    pub(super) weighted: Vector,
    normal: Normal,
    /// The inverse of the tangent row, and its coupling to the normal rows.
    slip_inverse: f64,
    coupling: [f64; 2],
    friction: f64,
    surface: f64,
    pub(super) roll: Roll,
}

/// Rolling resistance of a contact with one point.
pub(super) struct Roll {
    /// Zero for a contact without it.
    pub(super) resistance: f64,
    pub(super) radius: f64,
    pub(super) impulse: f64,
    pub(super) applied: f64,
    pub(super) weighted: f64,
}

/// The rows of a contact, with arms rounded.
fn rows(contact: &Contact, lengths: [f64; 2], rounding: &mut Rounding) -> [Sides; 3] {
    let [nx, ny] = contact.normal.map(|n| f64::from(n) / f64::from(1 << 30));
    let last = contact.count - 1;
    let arm = |point: usize, side: usize| flat(contact.points[point].arms[side]);
    let mut row = |side: usize, [x, y]: [f64; 2], [ux, uy]: [f64; 2]| {
        // Both components are rounded to 2^-30 of the length, and so is the result.
        [ux, uy, x * uy - y * ux + rounding.within(2f64.powi(-30) * lengths[side])]
    };
    let normals = [0, last].map(|point| [0, 1].map(|side| row(side, arm(point, side), [nx, ny])));
    let tangent = [0, 1].map(|side| {
        let ([x1, y1], [x2, y2]) = (arm(0, side), arm(last, side));
        row(side, [(x1 + x2) / 2.0, (y1 + y2) / 2.0], [ny, -nx])
    });
    [normals[0], if last == 0 { normals[0] } else { normals[1] }, tangent]
}

/// Elements of the matrix of both normal rows and the tangent row.
#[derive(Clone, Copy)]
struct Elements {
    normal: [f64; 2],
    /// Between the normal rows.
    across: f64,
    tangent: f64,
    /// Between the tangent and the normal rows.
    coupling: [f64; 2],
}

impl Elements {
    /// The elements of one body. `ulp` is the resolution of masses in the solver.
    fn new(rows: &[Sides; 3], side: usize, body: &Body, ulp: f64, rounding: &mut Rounding) -> Self {
        let mut of = |i: usize, j: usize| {
            let sum: f64 = (0..3).map(|c| rows[i][side][c] * body.inverse_mass[c] * rows[j][side][c]).sum();
            // The masses are rounded, and so are their products with both rows: errors of half an ulp.
            rounding.of(sum, 2.0 * ulp)
        };
        Self { normal: [of(0, 0), of(1, 1)], across: of(0, 1), tangent: of(2, 2), coupling: [of(2, 0), of(2, 1)] }
    }

    fn sum([a, b]: [Self; 2], [of_a, of_b]: [f64; 2]) -> Self {
        let sum = |a: f64, b: f64| of_a * a + of_b * b;
        Self {
            normal: [0, 1].map(|k| sum(a.normal[k], b.normal[k])),
            across: sum(a.across, b.across),
            tangent: sum(a.tangent, b.tangent),
            coupling: [0, 1].map(|k| sum(a.coupling[k], b.coupling[k])),
        }
    }
}

/// The solution of both normal rows.
struct Normal {
    /// Elements 11, 22 and 12 of the inverse: with no point soft, the first, the second, both.
    inverse: [Vector; 4],
    /// Element 12 over the diagonal one by point: rigid and soft.
    ratio: [[f64; 2]; 2],
    compliance: [f64; 2],
    rate: f64,
    push: f64,
}

/// Inverses with the diagonal of each point made softer, or not.
fn inverses(diagonal: [f64; 2], across: f64, soft: [f64; 2], two: bool, rounding: &mut Rounding) -> [Vector; 4] {
    let exact = [0, 1, 2, 3].map(|set| {
        let [k11, k22] = [0, 1].map(|k| diagonal[k] + if set >> k & 1 == 1 { soft[k] } else { 0.0 });
        let determinant = k11 * k22 - across * across;
        if two { [k22 / determinant, k11 / determinant, -across / determinant] } else { [1.0 / k11, 0.0, 0.0] }
    });
    // All four have one resolution: 30 bits for the largest element, and 2^-29 of their own largest one. Where points are close together
    // the rigid inverse is up to 2^12 times as large as the soft ones, and elements cancel. So a solve pass takes a common
    // velocity of both points away with an error of up to 2^-17 or so, most of which the relax pass after it takes away.
    let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    let resolution = 2f64.powi(-30) * power_above(largest(exact.as_flattened()));
    exact.map(|of| {
        let limit = resolution / 2.0 + 2f64.powi(-29) * largest(&of);
        of.map(|element| rounding.of(element, limit))
    })
}

impl Normal {
    /// The solution for the matrix of whole bodies and that of their shares. `ulp` is the resolution of masses.
    fn new(
        scene: &Scene,
        is_fixed: bool,
        (whole, split): (&Elements, &Elements),
        (two, ulp, units): (bool, f64, &Units),
        rounding: &mut Rounding,
    ) -> Self {
        let [across, coupled] = if two { [split.across, whole.across.max(0.0)] } else { [0.0; 2] };
        let product = split.normal[0] * split.normal[1];
        let is_narrow = product - across * across < product / 64.0;
        let diagonal = split.normal.map(|k| if is_narrow { k * (1.0 + 2f64.powi(-13)) } else { k });
        let omega = TAU * real(scene.options.frequency) * if is_fixed { 2.0 } else { 1.0 };
        let sum = 2.0 * real(scene.options.damping_ratio) + omega;
        let compliance = 1.0 / (omega * sum);
        let soft = whole.normal.map(|k| (k + coupled) * compliance + rounding.within(ulp));
        let mut ratio = |k: f64| (across / k).clamp(-4.0, 4.0) + rounding.within(2f64.powi(-28));
        Self {
            ratio: [0, 1].map(|k| [ratio(diagonal[k]), ratio(diagonal[k] + soft[k])]),
            inverse: inverses(diagonal, across, soft, two, rounding),
            compliance: soft.map(|soft| soft.min(units.one() / 4.0) + rounding.within(units.half())),
            rate: omega / sum,
            push: real(scene.options.push_speed) * (1.0 + compliance),
        }
    }
}

impl Rows {
    pub(super) fn new(
        scene: &Scene,
        contact: &Contact,
        bodies: &[Body],
        (shares, units): ([f64; 2], Units),
        rounding: &mut Rounding,
    ) -> Self {
        let pair = contact.bodies.map(|body| body as usize);
        let of = pair.map(|body| &bodies[body]);
        let rows = rows(contact, of.map(|body| body.length), rounding);
        let largest = of.map(|Body { inverse_mass: [x, y, turn], length, .. }| x.max(*y).max(turn * length * length));
        let ulp = 2f64.powi(-31) * power_above(largest[0].max(largest[1]));
        let sides = [0, 1].map(|side| Elements::new(&rows, side, of[side], ulp, rounding));
        let (whole, split) = (Elements::sum(sides, [1.0; 2]), Elements::sum(sides, shares));
        let (one, half, two) = (units.one(), units.half(), contact.count == 2);
        let mut gain = |k: usize, side: usize, c: usize| {
            let resolution = if c == 2 { half * 2f64.powi(units.angular_shift) } else { half };
            let length = if c == 2 { of[side].length } else { 1.0 };
            rounding.of(rows[k][side][c] * of[side].inverse_mass[c], (resolution + ulp) / length)
        };
        let gains = [0, 1, 2].map(|k| [0, 1].map(|side| [0, 1, 2].map(|c| gain(k, side, c))));
        let is_fixed = of.iter().any(|body| body.inverse_mass[..2] == [0.0; 2]);
        let (last, given) = (contact.count - 1, contact.impulses);
        let impulses = given.values.map(|value| value as f64 * 2f64.powi(given.exponent));
        Self {
            bodies: pair,
            units,
            two,
            rows,
            gains,
            separation: [0, last].map(|k| real(contact.points[k].separation)),
            impulses: if two { impulses } else { [impulses[0], 0.0, impulses[2]] },
            applied: [0.0; 3],
            weighted: [0.0; 3],
            normal: Normal::new(scene, is_fixed, (&whole, &split), (two, ulp, &units), rounding),
            // In 2^-27, and the reciprocal has 30 bits.
            slip_inverse: 1.0 / split.tangent + rounding.within(2f64.powi(-28) / one + 2f64.powi(-29) / split.tangent),
            coupling: whole.coupling.map(|k| k.clamp(-one / 4.0, one / 4.0) + rounding.within(half)),
            friction: rounding.of(real(contact.friction), 2f64.powi(-27)).max(0.0),
            surface: real(contact.surface_speed),
            roll: Roll {
                resistance: if two { 0.0 } else { real(contact.rolling_resistance) },
                radius: real(contact.rolling_radius),
                impulse: if two { 0.0 } else { impulses[1] },
                applied: 0.0,
                weighted: 0.0,
            },
        }
    }

    pub(super) fn rolls(&self) -> bool {
        self.roll.resistance > 0.0
    }

    /// The angular impulses on both bodies by one of rolling resistance.
    pub(super) fn turns(&self, impulse: f64) -> [f64; 2] {
        [-self.roll.radius * impulse, self.roll.radius * impulse]
    }

    fn along(&self, row: usize, of: [Vector; 2]) -> f64 {
        dot(self.rows[row][1], of[1]) - dot(self.rows[row][0], of[0])
    }

    /// Impulses after a pass.
    pub(super) fn solved(&self, bodies: &[Body], h: f64, is_solve: bool, rounding: &mut Rounding) -> Vector {
        let velocities = self.bodies.map(|body| bodies[body].seen);
        let moved = self.bodies.map(|body| bodies[body].displacement);
        let Units { velocity: unit, impulse, .. } = self.units;
        let (mut pressed, mut r, l, of) = ([0; 2], [0.0; 2], self.impulses, &self.normal);
        for k in 0..2 {
            let s = self.separation[k] + self.along(k, moved) + rounding.within(unit * h);
            let velocity = self.along(k, velocities) + rounding.within(unit);
            r[k] = velocity + if is_solve { s / h } else { (s / h).max(0.0) };
            if is_solve && s <= 0.0 {
                pressed[k] = 1;
                r[k] = velocity + (of.rate * s / h).max(-of.push) + of.compliance[k] * l[k];
            }
        }
        let [i11, i22, i12] = of.inverse[pressed[0] + 2 * pressed[1]];
        let x1 = l[0] - (i11 * r[0] + i12 * r[1]) + rounding.within(impulse);
        let x2 = if self.two { l[1] - (i12 * r[0] + i22 * r[1]) + rounding.within(impulse) } else { 0.0 };
        let alone = |k: usize, x: f64, other: f64| (x + of.ratio[k][pressed[k]] * other.min(0.0)).max(0.0);
        let [n1, n2] = [alone(0, x1, x2), alone(1, x2, x1)];
        if is_solve {
            return [n1, n2, l[2]];
        }
        let coupled = self.coupling[0] * (n1 - l[0]) + self.coupling[1] * (n2 - l[1]);
        let slip = self.along(2, velocities) + coupled - self.surface + rounding.within(unit);
        let limit = self.friction * (n1 + n2);
        let wanted = l[2] - slip * self.slip_inverse + rounding.within(impulse);
        [n1, n2, wanted.clamp(-limit, limit)]
    }

    /// Adds vectors of both bodies, by row and times an impulse each, to sums by body.
    pub(super) fn push(&self, vectors: &[Sides; 3], impulse: Vector, mut add: impl FnMut(usize, Vector)) {
        for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let sum = |c: usize| (0..3).map(|k| vectors[k][side][c] * impulse[k]).sum::<f64>();
            add(self.bodies[side], [0, 1, 2].map(|c| sign * sum(c)));
        }
    }
}
