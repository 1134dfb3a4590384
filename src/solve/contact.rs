//! Preparation of contacts: rows, masses, the inverse matrices and their units.

use super::matrix::{Inverse, Matrix, factor, ratio};
use super::number::{bits_of, clamped, clamped_word, exponent, fixed, shifted, shifted_word, times};
use super::unit::{Clock, Softness};
use super::{Contact, Point};
use crate::kernel::simd::{GAIN_BITS, GROUP, Pairs};
use crate::math::Vec2;
use crate::scalar::FxFactor;

/// The largest separation, either way: more than bodies close in a step.
pub(super) const SEPARATION: i128 = 759_250_124;
/// The largest impulse at the start of a step.
pub(super) const IMPULSE: i64 = 1 << 44;
/// The largest gain of a body by all contacts of a phase: 2^31 units. Velocities change by less than 2^28 of them.
const GAIN: i64 = 1 << 61;
/// The largest velocity of a surface.
const SURFACE: i128 = 1 << 27;
/// Factors of masses have this many bits relative to the largest of a contact.
const MASS_BITS: i32 = 31;
/// Factors in 2^-30 have at most this many bits: they are at most a quarter.
const FACTOR_BITS: i32 = GAIN_BITS - 2;

/// Contacts side by side, one in each lane. Pairs are of two quantities of the same contact.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Group {
    /// The rows of the first and the second body.
    pub(super) a: [u32; GROUP],
    pub(super) b: [u32; GROUP],
    /// The normal (x, y), in 2^-30.
    pub(super) normal: Pairs,
    /// Arms of both bodies along the two normal rows and the friction row, in 2^-30 of the bodies' lengths.
    pub(super) arms: [Pairs; 3],
    /// Separations of both points at the start.
    pub(super) separation: Pairs,
    /// Separations where the bodies are: those that the last relax pass found, at the start those at the start.
    pub(super) separation_now: Pairs,
    /// Changes of velocity (x, y) by an impulse along the normal and along the tangent, in 2^-[`GAIN_BITS`]: the first body is
    /// pushed the other way.
    pub(super) linear_a: [Pairs; 2],
    pub(super) linear_b: [Pairs; 2],
    /// Changes of angular velocity of both bodies by impulses along the three rows, in 2^(shift − [`GAIN_BITS`]).
    pub(super) angular: [Pairs; 3],
    pub(super) angular_shift: [i64; GROUP],
    /// The largest gain of each body by one contact: [`GAIN`] over its share.
    pub(super) gain_limit: [[i64; GROUP]; 2],
    /// Inverse of the matrix of the normal rows, elements 11 and 22, in 2^-shift: with no point soft, the first, the second, both.
    pub(super) inverse: [Pairs; 4],
    /// Element 12: with no point soft and the first; with the second and both.
    pub(super) inverse_12: [Pairs; 2],
    pub(super) inverse_shift: [i64; GROUP],
    /// Element 12 of the matrix over element 11, rigid and soft, in 2^-28.
    pub(super) ratio_12: Pairs,
    /// Element 12 of the matrix over element 22, rigid and soft, in 2^-28.
    pub(super) ratio_21: Pairs,
    /// Velocity by which soft points give way to their impulses, in 2^-30.
    pub(super) compliance: Pairs,
    /// Velocity at which an overlap is pushed out, in 2^-30 of it, and the deepest overlap that counts, as a separation.
    pub(super) push_out: Pairs,
    /// Inverse of the friction row, in 2^-27, and the coefficient of friction, in 2^-26.
    pub(super) friction: Pairs,
    /// Change of the slip by both normal impulses, in 2^-30.
    pub(super) coupling: Pairs,
    /// Velocity of the surfaces against each other along the tangent; the second word is unused.
    pub(super) surface: Pairs,
    /// Impulses of the sub-step: both normal ones and friction.
    pub(super) impulses: [[i64; GROUP]; 3],
    /// Sums of the impulses of sub-steps.
    pub(super) applied: [[i64; GROUP]; 3],
    /// Sums over sub-steps of the impulses applied up to the move.
    pub(super) weighted: [[i64; GROUP]; 3],
    /// The number of lanes that hold a contact. It stands last, so that all vectors are aligned.
    pub(super) count: usize,
}

impl Group {
    /// A group without contacts. All lanes name the row `idle`.
    pub(super) fn empty(idle: u32) -> Self {
        let pairs = [[0; 2]; GROUP];
        Self {
            a: [idle; GROUP],
            b: [idle; GROUP],
            count: 0,
            normal: pairs,
            arms: [pairs; 3],
            separation: pairs,
            separation_now: pairs,
            linear_a: [pairs; 2],
            linear_b: [pairs; 2],
            angular: [pairs; 3],
            angular_shift: [0; GROUP],
            gain_limit: [[0; GROUP]; 2],
            inverse: [pairs; 4],
            inverse_12: [pairs; 2],
            inverse_shift: [30; GROUP],
            ratio_12: pairs,
            ratio_21: pairs,
            compliance: pairs,
            push_out: pairs,
            friction: pairs,
            coupling: pairs,
            surface: pairs,
            impulses: [[0; GROUP]; 3],
            applied: [[0; GROUP]; 3],
            weighted: [[0; GROUP]; 3],
        }
    }
}

/// A body as contacts see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyOf {
    pub(super) row: u32,
    /// 1/m along x and y, 1/kg.
    pub(super) inverse_mass: [FxFactor; 2],
    /// 1/I, 1/(kg·m²).
    pub(super) inverse_inertia: FxFactor,
    /// log2 of the length in metres by which arms are divided and angular velocities multiplied.
    pub(super) length: i32,
    /// The number of contacts of the phase: each moves its share of the body.
    pub(super) share: i64,
}

/// A contact with its bodies and its unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactOf<'a> {
    pub(super) contact: &'a Contact,
    pub(super) bodies: [BodyOf; 2],
    /// log2 of the unit of velocity of the island, m/s.
    pub(super) unit: i32,
}

impl ContactOf<'_> {
    /// The first and the last point: the same one if there is only one.
    fn ends(&self) -> [&Point; 2] {
        let points = &self.contact.points;
        [&points[0], &points[self.contact.count - 1]]
    }
}

/// Inverse masses and inertias of both bodies in a common unit, and their rows.
struct Masses {
    /// Along x and y.
    linear: [[i64; 2]; 2],
    angular: [i64; 2],
    /// Arms of both bodies by row: normals 1 and 2, tangent.
    arms: [[i32; 2]; 3],
    normal: [i32; 2],
    /// log2 of one over the unit, 1/kg.
    exponent: i32,
}

/// The exponent above all inverse masses, and inverse inertias times the square of the length; `None` if all are zero.
pub(super) fn largest_exponent(bodies: &[BodyOf; 2]) -> Option<i32> {
    let largest = bodies.iter().flat_map(|body| {
        let angular = exponent(body.inverse_inertia) + 2 * body.length;
        body.inverse_mass.map(exponent).into_iter().chain([angular])
    });
    largest.max().filter(|&exponent| exponent > i32::MIN / 4)
}

impl Masses {
    fn new(of: &ContactOf<'_>) -> Option<Self> {
        let unit = MASS_BITS - largest_exponent(&of.bodies)?;
        let [a, b] = &of.bodies;
        let linear = [a, b].map(|body| body.inverse_mass.map(|factor| fixed(factor, unit)));
        let angular = [a, b].map(|body| fixed(body.inverse_inertia, unit + 2 * body.length));
        let [nx, ny] = of.contact.normal;
        let [first, last] = of.ends();
        let mut arms = [[0; 2]; 3];
        for (side, body) in of.bodies.iter().enumerate() {
            // From 2^-32 m to 2^-30 of the length.
            let down = 2 + body.length;
            let arm = |point: &Point| {
                let Vec2 { x, y } = point.arms[side];
                [x, y].map(|c| i64::from(clamped_word(shifted_word(c.to_bits(), down), 1 << 30)))
            };
            let across = |[x, y]: [i64; 2], [ux, uy]: [i32; 2]| {
                let cross = shifted_word(x * i64::from(uy) - y * i64::from(ux), 30);
                clamped_word(cross, 1 << 30)
            };
            let ([x1, y1], [x2, y2]) = (arm(first), arm(last));
            arms[0][side] = across([x1, y1], [nx, ny]);
            arms[1][side] = across([x2, y2], [nx, ny]);
            // In the middle: friction acts along one line.
            arms[2][side] = across([shifted_word(x1 + x2, 1), shifted_word(y1 + y2, 1)], [ny, -nx]);
        }
        Some(Self { linear, angular, arms, normal: [nx, ny], exponent: unit })
    }

    /// Changes of velocity by an impulse along a direction.
    fn linear_by(&self, side: usize, [x, y]: [i32; 2]) -> [i64; 2] {
        [times(self.linear[side][0], x), times(self.linear[side][1], y)]
    }

    /// The velocities along the rows by impulses along the rows, for one body.
    fn elements(&self, side: usize) -> Elements {
        let [nx, ny] = self.normal;
        let ([px, py], [qx, qy]) = (self.linear_by(side, [nx, ny]), self.linear_by(side, [ny, -nx]));
        let along = times(px, nx) + times(py, ny);
        let [k1, k2, kt] = [0, 1, 2].map(|row| self.arms[row][side]);
        let [turn_1, turn_2, turn_t] = [k1, k2, kt].map(|k| times(self.angular[side], k));
        let across = times(qx, nx) + times(qy, ny);
        Elements {
            normal: Matrix {
                k11: along + times(turn_1, k1),
                // Both ways, so that the points may come in either order.
                k12: along + shifted_word(turn_1 * i64::from(k2) + turn_2 * i64::from(k1), 31),
                k22: along + times(turn_2, k2),
            },
            tangent: times(qx, ny) - times(qy, nx) + times(turn_t, kt),
            coupling: [across + times(turn_t, k1), across + times(turn_t, k2)],
        }
    }
}

/// Velocities along rows by impulses along rows.
#[derive(Clone, Copy)]
struct Elements {
    normal: Matrix,
    tangent: i64,
    /// Between the tangent and both normal rows.
    coupling: [i64; 2],
}

impl Elements {
    /// The sums over two bodies, with a share of each.
    fn of([a, b]: [Self; 2], [of_a, of_b]: [i64; 2]) -> Self {
        let sum = |a: i64, b: i64| of_a * a + of_b * b;
        Self {
            normal: Matrix {
                k11: sum(a.normal.k11, b.normal.k11),
                k12: sum(a.normal.k12, b.normal.k12),
                k22: sum(a.normal.k22, b.normal.k22),
            },
            tangent: sum(a.tangent, b.tangent),
            coupling: [0, 1].map(|k| sum(a.coupling[k], b.coupling[k])),
        }
    }
}

impl Group {
    /// Writes a contact into the next lane. Returns log2 of the unit of its impulses, N·s; `None`, and nothing done, if neither
    /// body can be moved along the normal.
    pub(super) fn push(&mut self, of: &ContactOf<'_>, clock: &Clock, softness: &Softness) -> Option<i32> {
        let masses = Masses::new(of)?;
        let (lane, contact) = (self.count, of.contact);
        let sides = [masses.elements(0), masses.elements(1)];
        let whole = Elements::of(sides, [1, 1]);
        let split = Elements::of(sides, of.bodies.map(|body| body.share));
        let Matrix { k11, k22, .. } = whole.normal;
        if k11 <= 0 || k22 <= 0 {
            return None;
        }
        let smallest = [k11, k22, whole.tangent].into_iter().filter(|&k| k > 0).min()?;
        let bits = self.set_factors(&masses, of.bodies.map(|body| body.share), bits_of(smallest));
        self.arms.iter_mut().zip(masses.arms).for_each(|(arms, row)| arms[lane] = row);
        self.normal[lane] = contact.normal;
        self.separation[lane] = of.ends().map(|point| {
            let length = clock.length(point.separation, of.unit);
            length.clamp(-SEPARATION, SEPARATION) as i32
        });
        self.separation_now[lane] = self.separation[lane];
        self.set_matrices(of, (whole.normal, split.normal), softness, bits);
        let friction = Inverse::of(Matrix { k11: split.tangent, k12: 0, k22: 1 << MASS_BITS });
        // In 2^-27 over the unit of impulses.
        let inverse = factor(friction.elements[0], friction.exponent - bits - 2 - 27);
        let mu = shifted(contact.friction.to_bits().into(), 6).clamp(0, i32::MAX.into()) as i32;
        self.friction[lane] = [inverse, mu];
        let quarter = 1 << FACTOR_BITS;
        self.coupling[lane] = whole.coupling.map(|value| factor(value, bits - FACTOR_BITS).clamp(-quarter, quarter));
        let surface = shifted(contact.surface_speed.to_bits().into(), 32 + of.unit);
        self.surface[lane] = [clamped(surface, SURFACE), 0];
        // The unit of masses · 2^-exponent is 2^-(bits + 2).
        let exponent = masses.exponent - bits - 2 + of.unit;
        self.set_impulses(contact, exponent);
        (self.a[lane], self.b[lane]) = (of.bodies[0].row, of.bodies[1].row);
        self.count += 1;
        Some(exponent)
    }

    /// Writes the changes of velocity by impulses, for the shares of both bodies. Returns the number of bits that the largest one has
    /// before it becomes a quarter; at least `least`.
    fn set_factors(&mut self, masses: &Masses, shares: [i64; 2], least: i32) -> i32 {
        let lane = self.count;
        let [nx, ny] = masses.normal;
        let linear = [[nx, ny], [ny, -nx]].map(|direction| [0, 1].map(|side| masses.linear_by(side, direction)));
        let angular = [0, 1, 2].map(|row| [0, 1].map(|side| times(masses.angular[side], masses.arms[row][side])));
        // A body's factors times its share: all contacts of a phase together change its velocity by no more than one of them alone may.
        let widest = linear.iter().flat_map(|sides| [0, 1].map(|side| sides[side].map(|f| bits_of(f * shares[side]))));
        let widest = widest.flatten().max().unwrap_or_default();
        let turning = angular.iter().flat_map(|sides| [0, 1].map(|side| bits_of(sides[side] * shares[side])));
        let turning = turning.max().unwrap_or_default();
        // Factors of velocities are at most a quarter, those of angular velocities at most 2^16.
        let bits = widest.max(least).max(turning - 18);
        let more = (turning - bits).max(0);
        self.angular_shift[lane] = i64::from(more);
        (0..2).for_each(|side| self.gain_limit[side][lane] = GAIN / shares[side]);
        for (row, angular) in angular.into_iter().enumerate() {
            let [of_a, of_b] = angular.map(|value| factor(value, bits - FACTOR_BITS + more));
            self.angular[row][lane] = [-of_a, of_b];
        }
        for (direction, [of_a, of_b]) in linear.into_iter().enumerate() {
            self.linear_a[direction][lane] = of_a.map(|value| -factor(value, bits - FACTOR_BITS));
            self.linear_b[direction][lane] = of_b.map(|value| factor(value, bits - FACTOR_BITS));
        }
        bits
    }

    /// Writes the impulses that the step begins with, in 2^exponent N·s.
    fn set_impulses(&mut self, contact: &Contact, exponent: i32) {
        let lane = self.count;
        for (k, impulse) in contact.impulses.values.into_iter().enumerate() {
            // Within 100 bits: all of these are cut off anyway.
            let bits = exponent.saturating_sub(contact.impulses.exponent).max(bits_of(impulse) - 100);
            let cap = i128::from(IMPULSE);
            // Friction has either sign, and a second point may be missing.
            let least = if k == 2 { -cap } else { 0 };
            let most = if k == 1 && contact.count == 1 { 0 } else { cap };
            self.impulses[k][lane] = shifted(impulse.into(), bits).clamp(least, most) as i64;
            (self.applied[k][lane], self.weighted[k][lane]) = (0, 0);
        }
    }
    /// Writes the inverse matrices of the next lane, and what belongs to them, for the matrix and that of the shares of bodies.
    fn set_matrices(&mut self, of: &ContactOf<'_>, (whole, split): (Matrix, Matrix), softness: &Softness, bits: i32) {
        let (lane, two) = (self.count, of.contact.count == 2);
        // Two points close together make the matrix nearly singular: it gets a larger diagonal.
        let [k11, k12, k22] = [split.k11, split.k12, split.k22].map(i128::from);
        let is_narrow = two && k11 * k22 - k12 * k12 < (k11 * k22) >> 6;
        let (k11, k22) = match is_narrow {
            true => (split.k11 + (split.k11 >> 13), split.k22 + (split.k22 >> 13)),
            false => (split.k11, split.k22),
        };
        let is_fixed = of.bodies.iter().any(|body| body.inverse_mass.iter().all(|factor| factor.parts().0 == 0));
        let row = if is_fixed { &softness.fixed } else { &softness.moving };
        let k12 = if two { whole.k12.max(0) } else { 0 };
        let soft = |k: i64| times(k + k12, row.compliance);
        let (soft_11, soft_22) = (k11 + soft(whole.k11), k22 + soft(whole.k22));
        self.compliance[lane] =
            [whole.k11, whole.k22].map(|k| factor(soft(k), bits - FACTOR_BITS).min(1 << FACTOR_BITS));
        self.push_out[lane] = [row.rate, -clamped(softness.deepest(of.unit, row), SEPARATION)];
        let matrices = [(k11, k22), (soft_11, k22), (k11, soft_22), (soft_11, soft_22)];
        let inverses = matrices.map(|(k11, k22)| {
            // Of one point the second row does nothing.
            let (k12, k22) = if two { (split.k12, k22) } else { (0, k11) };
            let mut inverse = Inverse::of(Matrix { k11, k12, k22 });
            if !two {
                inverse.elements[1] = 0;
            }
            inverse
        });
        // One over the unit of the impulses, in units of the inverse matrix, is 2^(bits + 2).
        let top = inverses.iter().map(Inverse::log2).max().unwrap_or_default() + bits + 2;
        let shift = (30 - top).clamp(0, 62);
        self.inverse_shift[lane] = i64::from(shift);
        let elements = inverses.map(|inverse| inverse.in_units(shift + bits + 2));
        for (set, [e11, e22, _]) in elements.iter().enumerate() {
            self.inverse[set][lane] = [*e11, *e22];
        }
        self.inverse_12[0][lane] = [elements[0][2], elements[1][2]];
        self.inverse_12[1][lane] = [elements[2][2], elements[3][2]];
        if two {
            self.ratio_12[lane] = [ratio(split.k12, k11), ratio(split.k12, soft_11)];
            self.ratio_21[lane] = [ratio(split.k12, k22), ratio(split.k12, soft_22)];
        } else {
            (self.ratio_12[lane], self.ratio_21[lane]) = ([0; 2], [0; 2]);
        }
    }
}
