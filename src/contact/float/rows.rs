//! Contacts in the solver: rows, matrices, and impulses after a pass. The formulas and limits are those of the solver in integers.

use core::f64::consts::TAU;

use super::body::Body;
use super::number::{Float, Pair, Vector, dot, plus, times};
use super::points::{Manifold, ManifoldPoint};
use crate::scalar::ToF64 as _;
use crate::solve::SolverOptions;

/// Vectors (x, y, angular) of both bodies.
type Sides<F> = [Vector<F>; 2];

/// A contact of two bodies at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<F> {
    /// Indices of flights.
    pub(super) bodies: [u32; 2],
    pub(super) manifold: Manifold<F>,
    pub(super) friction: F,
    pub(super) restitution: F,
    /// The coefficient, and the radius, m.
    pub(super) rolling_resistance: F,
    pub(super) rolling_radius: F,
    pub(super) surface_speed: F,
    /// The impulses of the last step, N·s: along the normal by point, and along the tangent; then those of this step. With one point the
    /// second one is that of rolling resistance.
    pub(super) impulses: Vector<F>,
}

/// The constants of soft contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softness<F> {
    /// Velocity at which an overlap is pushed out, over that in a sub-step.
    rate: F,
    /// Compliance over the effective inverse mass.
    compliance: F,
    /// The largest velocity by which overlaps are pushed out, with what softness takes of it.
    push: F,
}

impl<F: Float> Softness<F> {
    /// Contacts with a body that cannot be moved are twice as stiff.
    pub(super) fn new(is_fixed: bool, push_speed: F) -> Self {
        let options = SolverOptions::default();
        let omega = TAU * options.frequency.to_f64() * if is_fixed { 2.0 } else { 1.0 };
        let sum = 2.0 * options.damping_ratio.to_f64() + omega;
        let compliance = 1.0 / (omega * sum);
        Self { rate: F::of(omega / sum), compliance: F::of(compliance), push: push_speed * F::of(1.0 + compliance) }
    }
}

/// Elements of the matrix of both normal rows and the tangent row.
#[derive(Clone, Copy)]
struct Elements<F> {
    normal: Pair<F>,
    /// Between the normal rows.
    across: F,
    tangent: F,
    /// Between the tangent and the normal rows.
    coupling: Pair<F>,
}

impl<F: Float> Elements<F> {
    /// The sums over two bodies, with a share of each.
    fn of(rows: &[Sides<F>; 3], bodies: [&Body<F>; 2], shares: Pair<F>) -> Self {
        let of = |i: usize, j: usize| {
            let on = |side: usize| {
                let pushed = [0, 1, 2].map(|c| bodies[side].inverse[c] * rows[j][side][c]);
                shares[side] * dot(rows[i][side], pushed)
            };
            on(0) + on(1)
        };
        Self { normal: [of(0, 0), of(1, 1)], across: of(0, 1), tangent: of(2, 2), coupling: [of(2, 0), of(2, 1)] }
    }
}

/// A contact in the passes.
#[derive(Debug)]
pub(super) struct Rows<F> {
    /// Its number.
    pub(super) contact: u32,
    pub(super) bodies: [u32; 2],
    is_double: bool,
    /// Both normals and the tangent.
    rows: [Sides<F>; 3],
    pub(super) separation: Pair<F>,
    /// Impulses of the sub-step, their sums, and the sums over sub-steps of those applied up to the move.
    pub(super) impulses: Vector<F>,
    pub(super) applied: Vector<F>,
    pub(super) weighted: Vector<F>,
    /// Elements 11, 22 and 12 of the inverse: with no point soft, the first, the second, both.
    inverse: [Vector<F>; 4],
    /// Element 12 over the diagonal one by point: rigid and soft.
    ratio: [Pair<F>; 2],
    compliance: Pair<F>,
    softness: Softness<F>,
    slip_inverse: F,
    coupling: Pair<F>,
    pub(super) friction: F,
    surface_speed: F,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    WarmStart,
    Solve,
    Relax,
}

/// The rows of a contact: both normals, and the tangent in the middle of the points.
fn rows<F: Float>(manifold: &Manifold<F>, ends: [&ManifoldPoint<F>; 2]) -> [Sides<F>; 3] {
    let [nx, ny] = manifold.normal;
    let row = |[x, y]: Pair<F>, [ux, uy]: Pair<F>| [ux, uy, x * uy - y * ux];
    let normals = ends.map(|point| point.arms.map(|arm| row(arm, [nx, ny])));
    // On the surface of each body: an open gap closes within the step.
    let [one, two] = ends.map(|point| point.separation.or_more(F::of(0.0)));
    let gap = (one + two) * F::of(0.25);
    let middle = [0, 1].map(|side| {
        let middle = times(plus(ends[0].arms[side], ends[1].arms[side]), F::of(0.5));
        plus(middle, times([nx, ny], if side == 0 { -gap } else { gap }))
    });
    [normals[0], normals[1], middle.map(|arm| row(arm, [ny, -nx]))]
}

impl<F: Float> Rows<F> {
    /// The impulses along the normal over the step, by point.
    pub(super) fn totals(&self) -> Pair<F> {
        [self.applied[0], if self.is_double { self.applied[1] } else { F::of(0.0) }]
    }

    /// The rows of a contact, for the number of contacts that each body has in the phase. `None` if neither body can be moved along the
    /// normal.
    pub(super) fn new(
        (number, contact): (u32, &Contact<F>),
        bodies: [&Body<F>; 2],
        shares: Pair<F>,
        softness: &[Softness<F>; 2],
    ) -> Option<Self> {
        let zero = F::of(0.0);
        let Manifold { ref points, count, .. } = contact.manifold;
        let (is_double, ends) = (count == 2, [&points[0], &points[count - 1]]);
        let rows = rows(&contact.manifold, ends);
        let whole = Elements::of(&rows, bodies, [F::of(1.0); 2]);
        let split = Elements::of(&rows, bodies, shares);
        if whole.normal.iter().any(|&k| k <= zero) {
            return None;
        }
        let is_fixed = bodies.iter().any(|body| body.inverse[..2] == [zero; 2]);
        let softness = softness[usize::from(is_fixed)];
        let [across, coupled] = if is_double { [split.across, whole.across.or_more(zero)] } else { [zero; 2] };
        // Two points close together make the matrix nearly singular: it gets a larger diagonal.
        let product = split.normal[0] * split.normal[1];
        let is_narrow = product - across * across < product * F::of(1.0 / 64.0);
        let diagonal = split.normal.map(|k| if is_narrow { k * F::of(1.0 + 1.0 / 8192.0) } else { k });
        let soft = whole.normal.map(|k| (k + coupled) * softness.compliance);
        let inverse = [0, 1, 2, 3].map(|set| {
            let of = |k: usize| diagonal[k] + if set >> k & 1 == 1 { soft[k] } else { zero };
            let (k11, k22) = (of(0), of(1));
            if !is_double {
                return [F::of(1.0) / k11, zero, zero];
            }
            let determinant = k11 * k22 - across * across;
            if determinant > zero { [k22 / determinant, k11 / determinant, -across / determinant] } else { [zero; 3] }
        });
        let ratio = |k: F| (across / k).within(F::of(4.0));
        Some(Self {
            contact: number,
            bodies: contact.bodies,
            is_double,
            rows,
            separation: ends.map(|point| point.separation),
            impulses: if is_double { contact.impulses } else { [contact.impulses[0], zero, contact.impulses[2]] },
            applied: [zero; 3],
            weighted: [zero; 3],
            inverse,
            ratio: [0, 1].map(|k| [ratio(diagonal[k]), ratio(diagonal[k] + soft[k])]),
            compliance: soft,
            softness,
            slip_inverse: if split.tangent > zero { F::of(1.0) / split.tangent } else { zero },
            coupling: whole.coupling,
            friction: contact.friction,
            surface_speed: contact.surface_speed,
        })
    }

    /// The component along a row of a velocity or a displacement of both bodies.
    pub(super) fn along(&self, row: usize, of: [Vector<F>; 2]) -> F {
        dot(self.rows[row][1], of[1]) - dot(self.rows[row][0], of[0])
    }

    /// The impulses on both bodies for impulses along the rows.
    pub(super) fn on_bodies(&self, impulses: Vector<F>) -> [Vector<F>; 2] {
        [0, 1].map(|side| {
            let sign = F::of(if side == 0 { -1.0 } else { 1.0 });
            [0, 1, 2].map(|c| sign * dot([0, 1, 2].map(|k| self.rows[k][side][c]), impulses))
        })
    }

    /// The impulses after a pass, for sub-steps of `h` seconds.
    fn solved(&self, bodies: &[Body<F>], h: F, is_solve: bool) -> Vector<F> {
        let zero = F::of(0.0);
        let velocities = self.bodies.map(|body| bodies[body as usize].velocity);
        let moved = self.bodies.map(|body| bodies[body as usize].displacement);
        let (mut pressed, mut r, l) = ([0; 2], [zero; 2], self.impulses);
        for k in 0..2 {
            let s = self.separation[k] + self.along(k, moved);
            let velocity = self.along(k, velocities);
            if is_solve && s <= zero {
                pressed[k] = 1;
                let push = (self.softness.rate * s / h).or_more(-self.softness.push);
                r[k] = velocity + push + self.compliance[k] * l[k];
            } else {
                r[k] = velocity + (s / h).or_more(zero);
            }
        }
        let [i11, i22, i12] = self.inverse[pressed[0] + 2 * pressed[1]];
        let x1 = l[0] - (i11 * r[0] + i12 * r[1]);
        let x2 = if self.is_double { l[1] - (i12 * r[0] + i22 * r[1]) } else { zero };
        let alone = |k: usize, x: F, other: F| (x + self.ratio[k][pressed[k]] * other.or_less(zero)).or_more(zero);
        let [n1, n2] = [alone(0, x1, x2), alone(1, x2, x1)];
        if is_solve {
            return [n1, n2, l[2]];
        }
        let slip = self.along(2, velocities) + dot(self.coupling, [n1 - l[0], n2 - l[1]]) - self.surface_speed;
        let wanted = l[2] - slip * self.slip_inverse;
        [n1, n2, wanted.within(self.friction * (n1 + n2))]
    }

    /// Computes the impulses of a pass, and adds what they change of the bodies' velocities.
    pub(super) fn run(&mut self, bodies: &mut [Body<F>], h: F, pass: Pass) {
        let mut change = self.impulses;
        if pass != Pass::WarmStart {
            let impulses = self.solved(bodies, h, pass == Pass::Solve);
            change = [0, 1, 2].map(|k| impulses[k] - self.impulses[k]);
            if pass == Pass::Relax {
                self.weighted = [0, 1, 2].map(|k| self.weighted[k] + self.applied[k] + self.impulses[k]);
                self.applied = [0, 1, 2].map(|k| self.applied[k] + impulses[k]);
            }
            self.impulses = impulses;
        }
        for (body, on) in self.bodies.into_iter().zip(self.on_bodies(change)) {
            let body = &mut bodies[body as usize];
            body.add_gain([0, 1, 2].map(|c| on[c] * body.inverse[c]));
        }
    }
}
