//! Nodes at pins that turn freely, which are most of them: what [`Node`] does, where all values are as small as they most often are.
//!
//! Each function gives up where a value is not, before it changes anything, and the general one has its place. There is no branch in between:
//! compilers know that a factor is a word within a block only, and multiply by two words elsewhere.
//!
//! # Ranges
//! [`tree`](super) has those of all values. Here c' is below 2^50. Quotients of b' and τ by it have 8 and 12 bits of the 63 of a word above those
//! of c': t is below 2^9, in 2^-[`RATIO`] below 2^49, and velocities by τ are below 2^37.

use super::node::Node;
use super::symmetric::{Reciprocal, Symmetric, dot, moved, product, unit_dot};
use super::{IMPULSE, PART, RATIO, SOFT, TO_IMPULSE};
use crate::solve::number::{lowered_low, upper};

/// The bits that b' and τ may have above those of c'.
const RATIO_ABOVE: i32 = 8;
const SPEED_ABOVE: i32 = 12;
/// log2 of the largest impulse, and of the largest velocity here.
const IMPULSE_BITS: i32 = IMPULSE.trailing_zeros() as i32;
const SPEED_BITS: i32 = 43;

/// Zero for a value of at most `bits` bits, and −2^bits.
#[inline(always)]
fn beyond(value: i64, bits: i32) -> i64 {
    (value ^ (value >> 63)) >> bits
}

/// [`beyond`] of a double word. *Domain* bits ≥ 64.
#[inline(always)]
fn wide_beyond(value: i128, bits: i32) -> i64 {
    beyond((value >> 64) as i64, bits - 64)
}

/// value/denominator · 2^up, and zero if the value has at most `above` bits more than the denominator. *Domain* the denominator has at most
/// 63 − `above` bits.
#[inline(always)]
fn quotient(reciprocal: Reciprocal, value: i64, up: i32, above: i32) -> (i64, i64) {
    let room = 124 - reciprocal.shift - above;
    let raised = value << room;
    // The quotient is in 2^-(124 − above − up): the half is in the upper word.
    let down = 60 - above - up;
    let product = product(raised, reciprocal.mantissa);
    let high = ((product + (product >> 127)) >> 64) as i64;
    ((high + (1 << (down - 1))) >> down, (raised >> room) ^ value)
}

/// [`softened`](Symmetric::softened), and zero if it is so: for values of other sizes.
#[inline(always)]
fn softened(e: &Symmetric, compliance: i64) -> (Symmetric, i64) {
    // E is below 2^61, the compliance at most 2^54: ten bits raise their products to the upper word.
    let part = |value: i64| upper(product(value << 2, compliance << (62 - SOFT + PART)));
    let g = Symmetric { xx: part(e.xx), xy: part(e.xy), yy: part(e.yy) };
    let sum = (1 << (2 * PART)) + ((i128::from(g.xx) + i128::from(g.yy)) << PART) + g.determinant();
    let more = ((product(g.xx, e.yy) + product(g.yy, e.xx)) >> 1) - product(g.xy, e.xy);
    let numerators = [(i128::from(e.xx) << PART) + more, i128::from(e.xy) << PART, (i128::from(e.yy) << PART) + more];
    let high = (sum >> 64) as i64;
    let reciprocal = Reciprocal::of_high(sum, high.max(1));
    let largest = (numerators[0].max(numerators[2]) >> 64) as i64;
    // From 5 to 65 bits are taken off the numerators, and from 65 to 126 bits off the products.
    let down = 66 - largest.clamp(1, 1 << 58).leading_zeros() as i32;
    let bits = reciprocal.shift - PART - down;
    let fitting = bits.clamp(65, 126);
    let element = |numerator: i128| {
        let product = product(lowered_low(numerator, down), reciprocal.mantissa);
        let upper = ((product + (product >> 127)) >> 64) as i64;
        (upper + (1 << (fitting - 65))) >> (fitting - 64)
    };
    let rest = i64::from(high <= 0) | i64::from(largest <= 0) | largest >> 58 | i64::from(bits != fitting);
    (Symmetric { xx: element(numerators[0]), xy: element(numerators[1]), yy: element(numerators[2]) }, rest)
}

impl Node {
    /// [`factor`](Self::factor). Returns false for values of other sizes.
    #[inline(always)]
    pub(super) fn factor_pin(&mut self) -> bool {
        let [x, y] = self.a.times_unit(self.point);
        let b = [self.b[0] - x, self.b[1] - y];
        let c = self.c - unit_dot(self.point, [self.b[0] + b[0], self.b[1] + b[1]]);
        let turn = Reciprocal::of_positive(c.max(1));
        let (tx, x_rest) = quotient(turn, b[0], RATIO, RATIO_ABOVE);
        let (ty, y_rest) = quotient(turn, b[1], RATIO, RATIO_ABOVE);
        // b is below 2^61.
        let e = Symmetric {
            xx: self.a.xx - lowered_low(product(b[0], tx), RATIO),
            xy: self.a.xy - lowered_low(product(b[0], ty) + product(b[1], tx), RATIO + 1),
            yy: self.a.yy - lowered_low(product(b[1], ty), RATIO),
        };
        let up = self.unit - self.joint_unit;
        let e = Symmetric { xx: e.xx << up, xy: e.xy << up, yy: e.yy << up };
        let (spring, spring_rest) = softened(&e, self.compliance);
        if x_rest | y_rest | spring_rest != 0 || !(1..1 << 50).contains(&c) {
            return false;
        }
        (self.t, self.turn, self.spring) = ([tx, ty], turn, spring);
        true
    }

    /// [`pass_down`](Self::pass_down) without a torque. `None` for values of other sizes.
    #[inline(always)]
    pub(super) fn pass_down_pin(&mut self) -> Option<[i64; 2]> {
        let f = [self.f[0] as i64, self.f[1] as i64];
        let torque = self.torque as i64;
        let words =
            (i128::from(f[0]) ^ self.f[0]) | (i128::from(f[1]) ^ self.f[1]) | (i128::from(torque) ^ self.torque);
        let mut rest = (words >> 64) as i64 | beyond(f[0], IMPULSE_BITS) | beyond(f[1], IMPULSE_BITS);
        rest |= beyond(torque, IMPULSE_BITS + 1);
        let tau = torque - unit_dot(self.point, f);
        let turning = [product(self.t[0], tau), product(self.t[1], tau)];
        rest |= beyond(tau, IMPULSE_BITS) | wide_beyond(turning[0], 62 + RATIO) | wide_beyond(turning[1], 62 + RATIO);
        // Both terms are below 2^62.
        let left = [f[0] - lowered_low(turning[0], RATIO), f[1] - lowered_low(turning[1], RATIO)];
        let up = self.unit - self.joint_unit;
        rest |= beyond(left[0], IMPULSE_BITS - up) | beyond(left[1], IMPULSE_BITS - up);
        let g = [left[0] << up, left[1] << up];
        let arg = [self.residual[0] - self.give(g[0]), self.residual[1] - self.give(g[1])];
        let [x, y] = self.spring.times(arg);
        rest |= wide_beyond(x, IMPULSE_BITS + TO_IMPULSE) | wide_beyond(y, IMPULSE_BITS + TO_IMPULSE);
        if rest != 0 {
            return None;
        }
        (self.f, self.torque, self.tau, self.g) = ([0; 2], 0, tau, g);
        Some([g[0] + lowered_low(x, TO_IMPULSE), g[1] + lowered_low(y, TO_IMPULSE)])
    }

    /// [`pass_up`](Self::pass_up). Returns false for values of other sizes.
    #[inline(always)]
    pub(super) fn pass_up_pin(&mut self, at: [i64; 2]) -> bool {
        let difference = [at[0] - self.residual[0], at[1] - self.residual[1]];
        let arg = [difference[0] + self.give(self.g[0]), difference[1] + self.give(self.g[1])];
        let [x, y] = self.spring.times(arg);
        let mut rest = wide_beyond(x, IMPULSE_BITS + TO_IMPULSE) | wide_beyond(y, IMPULSE_BITS + TO_IMPULSE);
        let push = [lowered_low(x, TO_IMPULSE) - self.g[0], lowered_low(y, TO_IMPULSE) - self.g[1]];
        let velocity = [difference[0] - self.give(push[0]), difference[1] - self.give(push[1])];
        rest |= beyond(velocity[0], SPEED_BITS) | beyond(velocity[1], SPEED_BITS);
        let (given, given_rest) = quotient(self.turn, self.tau, TO_IMPULSE, SPEED_ABOVE);
        let turning = dot(self.t, velocity);
        // The sum is below 2^93.
        let spin = given - lowered_low(turning, RATIO);
        rest |= given_rest | beyond(spin, SPEED_BITS);
        // Both terms are at most 2^43.
        let moved = moved(velocity, -spin, self.point);
        if rest != 0 {
            return false;
        }
        (self.push, self.spin, self.velocity) = (push, spin, moved);
        true
    }
}
