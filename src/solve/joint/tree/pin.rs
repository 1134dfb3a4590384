//! Nodes at pins, the usual joints: the kernels of [`Node`] for values of the usual sizes.
//!
//! Each function gives up where a value is not, before it changes anything, and the general one has its place. There is no branch in between:
//! compilers know that a factor is a word within a block only, and multiply by two words elsewhere.
//!
//! # Ranges
//! [`tree`](super) has the ranges of all values. Here c'', which is c' with the κ of a law, is below 2^50. Quotients of b' and τ by it have 8 and 12
//! bits of the 63 of a word above the bits of c'': t is below 2^9, in 2^-[`RATIO`] below 2^49, and velocities by τ are below 2^37.

use super::node::Node;
use super::symmetric::{Reciprocal, Symmetric, dot, moved, unit_dot};
use super::{IMPULSE, PART, RATIO, SOFT, TO_IMPULSE};
use crate::solve::number::{lowered_low, lowered_low_by, product, upper};

/// The bits that b' and τ may have above the bits of c''.
const RATIO_ABOVE: i32 = 8;
const SPEED_ABOVE: i32 = 12;
/// log2 of the largest impulse, and of the largest velocity here.
const IMPULSE_BITS: i32 = IMPULSE.trailing_zeros() as i32;
const SPEED_BITS: i32 = 43;

/// Zero for a value of at most `bits` bits, and −2^bits.
#[inline(always)]
pub(super) fn beyond(value: i64, bits: i32) -> i64 {
    (value ^ (value >> 63)) >> bits
}

/// [`beyond`] of a double word. *Domain* bits ≥ 64.
#[inline(always)]
pub(super) fn wide_beyond(value: i128, bits: i32) -> i64 {
    beyond((value >> 64) as i64, bits - 64)
}

/// value/denominator · 2^up, and zero if the value has at most `above` bits more than the denominator. *Domain* the denominator has at most
/// 63 − `above` bits.
#[inline(always)]
pub(super) fn quotient(reciprocal: Reciprocal, value: i64, up: i32, above: i32) -> (i64, i64) {
    let room = 124 - reciprocal.shift - above;
    let raised = value << room;
    // The quotient is in 2^-(124 − above − up): the half is in the upper word.
    let down = 60 - above - up;
    let product = product(raised, reciprocal.mantissa);
    let high = ((product + (product >> 127)) >> 64) as i64;
    ((high + (1 << (down - 1))) >> down, (raised >> room) ^ value)
}

/// A node whose rotation is being eliminated: b', c', and 1/c'' with c''.
struct Turning {
    b: [i64; 2],
    c: i64,
    stiff: i64,
    turn: Reciprocal,
}

/// A node whose rotation is eliminated: t and E in the unit of the joint, and zero if the quotients are right.
struct Turned {
    t: [i64; 2],
    e: Symmetric,
    rest: i64,
}

/// S as [`softened`](Symmetric::softened) has it, as fractions: both denominators are one, whose reciprocal this is.
struct Fractions {
    numerators: [i128; 3],
    reciprocal: Reciprocal,
    /// Zero if the denominator has more than a word.
    rest: i64,
}

impl Fractions {
    #[inline(always)]
    fn new(e: &Symmetric, compliance: i64) -> Self {
        // E is below 2^61, the compliance at most 2^54: ten bits raise their products to the upper word.
        let part = |value: i64| upper(product(value << 2, compliance << (62 - SOFT + PART)));
        let g = Symmetric { xx: part(e.xx), xy: part(e.xy), yy: part(e.yy) };
        let sum = (1 << (2 * PART)) + ((i128::from(g.xx) + i128::from(g.yy)) << PART) + g.determinant();
        let more = ((product(g.xx, e.yy) + product(g.yy, e.xx)) >> 1) - product(g.xy, e.xy);
        let numerators =
            [(i128::from(e.xx) << PART) + more, i128::from(e.xy) << PART, (i128::from(e.yy) << PART) + more];
        let high = (sum >> 64) as i64;
        Self { numerators, reciprocal: Reciprocal::of_high(sum, high.max(1)), rest: i64::from(high <= 0) }
    }

    /// The quotients, and zero if they are right.
    #[inline(always)]
    fn quotients(&self) -> (Symmetric, i64) {
        let [xx, xy, yy] = self.numerators;
        let largest = (xx.max(yy) >> 64) as i64;
        // From 3 to 61 bits are taken off the numerators, and from 65 to 126 bits off the products.
        let down = 66 - largest.clamp(1, 1 << 58).leading_zeros() as i32;
        let bits = self.reciprocal.shift - PART - down;
        let fitting = bits.clamp(65, 126);
        let element = |numerator: i128| {
            let product = product(lowered_low_by(numerator, down), self.reciprocal.mantissa);
            let upper = ((product + (product >> 127)) >> 64) as i64;
            (upper + (1 << (fitting - 65))) >> (fitting - 64)
        };
        let rest = self.rest | i64::from(largest <= 0) | largest >> 58 | i64::from(bits != fitting);
        (Symmetric { xx: element(xx), xy: element(xy), yy: element(yy) }, rest)
    }
}

impl Node {
    /// [`factor`](Self::factor).
    #[inline(always)]
    pub(super) fn factor_pin(&mut self) {
        let turning = self.turning();
        let turned = self.turned(&turning);
        let fractions = Fractions::new(&turned.e, self.compliance);
        let (spring, rest) = fractions.quotients();
        self.set_pin(&turning, &turned, spring, rest);
    }

    /// [`factor`](Self::factor) of two nodes of which neither waits for the other one: a processor works on both at once.
    #[inline(always)]
    pub(super) fn factor_pins(first: &mut Self, second: &mut Self) {
        let turning = [first.turning(), second.turning()];
        let turned = [first.turned(&turning[0]), second.turned(&turning[1])];
        let fractions =
            [Fractions::new(&turned[0].e, first.compliance), Fractions::new(&turned[1].e, second.compliance)];
        let (first_spring, first_rest) = fractions[0].quotients();
        let (second_spring, second_rest) = fractions[1].quotients();
        first.set_pin(&turning[0], &turned[0], first_spring, first_rest);
        second.set_pin(&turning[1], &turned[1], second_spring, second_rest);
    }

    #[inline(always)]
    fn turning(&self) -> Turning {
        let [x, y] = self.a.times_unit(self.point);
        let b = [self.b[0] - x, self.b[1] - y];
        let c = self.c - unit_dot(self.point, [self.b[0] + b[0], self.b[1] + b[1]]);
        let stiff = c + self.stiffness;
        Turning { b, c, stiff, turn: Reciprocal::of_positive(stiff.max(1)) }
    }

    #[inline(always)]
    fn turned(&self, turning: &Turning) -> Turned {
        let b = turning.b;
        let (tx, x_rest) = quotient(turning.turn, b[0], RATIO, RATIO_ABOVE);
        let (ty, y_rest) = quotient(turning.turn, b[1], RATIO, RATIO_ABOVE);
        // What wraps has a quotient that is not right.
        let xx = self.a.xx.wrapping_sub(lowered_low(product(b[0], tx), RATIO));
        let xy = self.a.xy.wrapping_sub(lowered_low(product(b[0], ty) + product(b[1], tx), RATIO + 1));
        let yy = self.a.yy.wrapping_sub(lowered_low(product(b[1], ty), RATIO));
        let up = self.unit - self.joint_unit;
        Turned { t: [tx, ty], e: Symmetric { xx: xx << up, xy: xy << up, yy: yy << up }, rest: x_rest | y_rest }
    }

    /// Takes the values of a pin, if all are right.
    #[inline(always)]
    fn set_pin(&mut self, turning: &Turning, turned: &Turned, spring: Symmetric, rest: i64) {
        self.is_pin = turned.rest | rest == 0 && (1..1 << 50).contains(&turning.stiff);
        if self.is_pin {
            (self.t, self.turn, self.spring) = (turned.t, turning.turn, spring);
            self.factor_angle(turning.c);
        }
    }

    /// [`pass_down`](Self::pass_down) but for the torque on the parent: the impulse that is left. `None` for values of other sizes.
    #[inline(always)]
    pub(super) fn pass_down_pin(&mut self) -> Option<[i64; 2]> {
        let f = [self.f[0] as i64, self.f[1] as i64];
        let sum = self.torque + i128::from(self.axis_torque);
        let torque = sum as i64;
        let words = (i128::from(f[0]) ^ self.f[0]) | (i128::from(f[1]) ^ self.f[1]) | (i128::from(torque) ^ sum);
        let mut rest = (words >> 64) as i64 | beyond(f[0], IMPULSE_BITS) | beyond(f[1], IMPULSE_BITS);
        rest |= beyond(torque, IMPULSE_BITS + 1);
        // What wraps is beyond.
        let tau = torque.wrapping_sub(unit_dot(self.point, f));
        let turning = [product(self.t[0], tau), product(self.t[1], tau)];
        rest |= beyond(tau, IMPULSE_BITS) | wide_beyond(turning[0], 62 + RATIO) | wide_beyond(turning[1], 62 + RATIO);
        let left = [0, 1].map(|i| f[i].wrapping_sub(lowered_low(turning[i], RATIO)));
        let up = self.unit - self.joint_unit;
        rest |= beyond(left[0], IMPULSE_BITS - up) | beyond(left[1], IMPULSE_BITS - up);
        let g = [left[0] << up, left[1] << up];
        let arg = [self.residual[0] - self.give(g[0]), self.residual[1] - self.give(g[1])];
        let [x, y] = self.spring.times(arg);
        rest |= wide_beyond(x, IMPULSE_BITS + TO_IMPULSE) | wide_beyond(y, IMPULSE_BITS + TO_IMPULSE);
        if rest != 0 {
            return None;
        }
        (self.f, self.torque, self.tau, self.g, self.soft_residual) = ([0; 2], 0, tau, g, arg);
        Some([g[0] + lowered_low(x, TO_IMPULSE), g[1] + lowered_low(y, TO_IMPULSE)])
    }

    /// [`pass_up`](Self::pass_up), with the impulses at the point and of rotation by the axis. Returns false for values of other sizes.
    #[inline(always)]
    pub(super) fn pass_up_pin(&mut self, at: [i64; 2], by_angle: [i64; 3]) -> bool {
        let difference = [at[0] - self.residual[0], at[1] - self.residual[1]];
        let [x, y] = self.spring.times([at[0] - self.soft_residual[0], at[1] - self.soft_residual[1]]);
        let mut rest = wide_beyond(x, IMPULSE_BITS + TO_IMPULSE) | wide_beyond(y, IMPULSE_BITS + TO_IMPULSE);
        // What wraps is beyond.
        let push = [
            lowered_low(x, TO_IMPULSE).wrapping_sub(self.g[0]).wrapping_add(by_angle[0]),
            lowered_low(y, TO_IMPULSE).wrapping_sub(self.g[1]).wrapping_add(by_angle[1]),
        ];
        // Both are at most 2^60.
        let tau = self.tau + by_angle[2];
        rest |= beyond(tau, IMPULSE_BITS);
        let velocity = [difference[0] - self.give(push[0]), difference[1] - self.give(push[1])];
        rest |= beyond(velocity[0], SPEED_BITS) | beyond(velocity[1], SPEED_BITS);
        let (spin_by_tau, spin_rest) = quotient(self.turn, tau, TO_IMPULSE, SPEED_ABOVE);
        let turning = dot(self.t, velocity);
        // The sum is below 2^93.
        let spin = spin_by_tau - lowered_low(turning, RATIO);
        rest |= spin_rest | beyond(spin, SPEED_BITS);
        // Both terms are at most 2^43.
        let moved = moved(velocity, -spin, self.point);
        if rest != 0 {
            return false;
        }
        (self.push, self.spin, self.velocity) = (push, spin, moved);
        true
    }
}
