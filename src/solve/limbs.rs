//! Exact impulses of contacts, as sums in two limbs.
//!
//! The impulse of a contact on its bodies is a sum of products of its impulses with normals and arms, in 2^(exponent − 30) N·s; along the
//! rotation times the length of the body, as arms are multiples of it. In 2^-64 N·s it is an integer after one rounding, if it is finer
//! than that, and is split into two limbs of radix 2^30. Sums of limbs are exact, so that neither the order of contacts nor the number of
//! lanes changes a bit, and both bodies of a contact get the same limbs with opposite signs.
//!
//! # Ranges
//! With impulses below 2^s the upper limb of a contact is below 2^(s + 1.6), the lower one below 2^30, and both are raised by r bits. As
//! many contacts as there are, 2^n, give sums below 2^62 if r ≤ 32 − n and s + r ≤ 60 − n. Impulses from 2^30 on are split into halves,
//! h·2^30 + l with l within ±2^29 and h within ±2^31: the sums of products of both are below 2^62.6. Other groups go one by one, in 128
//! bits.

use super::batch::Words;
use super::group::Group;
use super::number::shifted;
use crate::kernel::simd::{GROUP, Lanes, Sums};

/// The bits of a lower limb.
const LIMB: i32 = 30;

/// Impulses of a contact are within ±2^46 N·s: 2^110 units. 2^16 of them fit in a sum.
const LARGEST: i128 = 1 << 110;

/// How the impulses of a group are added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    /// In lanes: impulses below 2^30, in units of at least 2^-64 N·s after the products.
    Small,
    /// In lanes, in halves, and in finer units as well.
    Middle,
    /// One by one.
    Large,
}

impl Size {
    /// The size of a group, if there are fewer than 2^n contacts.
    #[inline(always)]
    pub(super) fn new(group: &Group, n: i32) -> Self {
        let (mut bits, mut largest, mut smallest) = (0, 0, 0);
        for sums in [&group.applied, &group.weighted] {
            for sum in sums.as_flattened() {
                bits |= sum ^ (sum >> 63);
            }
        }
        for &raise in &group.raise {
            (largest, smallest) = (raise.max(largest), raise.min(smallest));
        }
        let size = 64 - bits.leading_zeros() as i64;
        match () {
            () if largest > i64::from(32 - n) || size + largest > i64::from(60 - n) || smallest < -i64::from(LIMB) => {
                Self::Large
            }
            () if size > 30 || smallest < 0 => Self::Middle,
            () => Self::Small,
        }
    }
}

/// Adds the impulses of contacts to the sums of both bodies. `MIDDLE` for groups of that size.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn add_impulses<L: Lanes, const MIDDLE: bool>(lanes: L, group: &Group, at: usize, sums: &mut [Sums]) {
    let [x, y, a, b] = limbs::<L, MIDDLE>(lanes, group, at, &group.applied);
    let [wx, wy, wa, wb] = limbs::<L, MIDDLE>(lanes, group, at, &group.weighted);
    let linear = [[x[0], y[0], wx[0], wy[0]], [x[1], y[1], wx[1], wy[1]]];
    let turns = [[a[0], wa[0], a[1], wa[1]], [b[0], wb[0], b[1], wb[1]]];
    lanes.add_sums(sums, [&group.a, &group.b], at, linear, turns);
}

/// The limbs, lower and upper, of impulses along x and y, and of rotation of the first and of the second body.
#[inline(always)]
fn limbs<L: Lanes, const MIDDLE: bool>(lanes: L, group: &Group, at: usize, impulses: &[Words; 3]) -> [[L::Wide; 2]; 4] {
    let p = [lanes.wide(&impulses[0], at), lanes.wide(&impulses[1], at), lanes.wide(&impulses[2], at)];
    let zero = lanes.all(0);
    let (low, high) = if MIDDLE {
        let (mut lower, mut upper) = ([lanes.splat(0); 3], [lanes.splat(0); 3]);
        for k in 0..3 {
            let half = lanes.floored::<LIMB>(lanes.add(p[k], lanes.all(1 << (LIMB - 1))));
            lower[k] = lanes.low(lanes.sub(p[k], lanes.raised_by(half, lanes.all(LIMB.into()))));
            upper[k] = lanes.low(half);
        }
        (along(lanes, group, at, lower), along(lanes, group, at, upper))
    } else {
        (along(lanes, group, at, [lanes.low(p[0]), lanes.low(p[1]), lanes.low(p[2])]), [zero; 4])
    };
    let raise = lanes.wide(&group.raise, at);
    let mut limbs = [[zero; 2]; 4];
    for k in 0..4 {
        let carry = lanes.floored::<LIMB>(low[k]);
        let rest = lanes.sub(low[k], lanes.raised_by(carry, lanes.all(LIMB.into())));
        limbs[k] = if MIDDLE {
            shifted_limbs(lanes, [rest, lanes.add(high[k], carry)], raise)
        } else {
            [lanes.raised_by(rest, raise), lanes.raised_by(carry, raise)]
        };
    }
    limbs
}

/// Limbs times 2^raise, to nearest, ties away from zero. *Domain* raise ≥ −30.
#[inline(always)]
fn shifted_limbs<L: Lanes>(lanes: L, [low, high]: [L::Wide; 2], raise: L::Wide) -> [L::Wide; 2] {
    let (zero, limb) = (lanes.all(0), lanes.all(LIMB.into()));
    let down = lanes.positive(lanes.sub(zero, raise));
    let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), down));
    let less = lanes.positive(lanes.sub(half, lanes.all(1)));
    // The upper limb has the sign. Its bits that are shifted out go to the lower one.
    let low = lanes.add(low, lanes.if_negative(high, less, half));
    let upper = lanes.floored_by(high, down);
    let rest = lanes.sub(high, lanes.raised_by(upper, down));
    let low = lanes.floored_by(lanes.add(low, lanes.raised_by(rest, limb)), down);
    let up = lanes.positive(raise);
    [lanes.raised_by(low, up), lanes.raised_by(upper, up)]
}

/// Sums of products of impulses with normals and arms: along x and y, and of rotation of both bodies.
#[inline(always)]
fn along<L: Lanes>(lanes: L, group: &Group, at: usize, p: [L::Narrow; 3]) -> [L::Wide; 4] {
    let (nx, ny) = lanes.pair(&group.normal, at);
    let (first_a, first_b) = lanes.pair(&group.arms[0], at);
    let (second_a, second_b) = lanes.pair(&group.arms[1], at);
    let (tangent_a, tangent_b) = lanes.pair(&group.arms[2], at);
    let linear = [lanes.add(lanes.times(nx, p[0]), lanes.times(nx, p[1])), lanes.times(ny, p[2])];
    let across = [lanes.add(lanes.times(ny, p[0]), lanes.times(ny, p[1])), lanes.times(nx, p[2])];
    let turn_a = lanes.add(lanes.times(first_a, p[0]), lanes.times(second_a, p[1]));
    let turn_b = lanes.add(lanes.times(first_b, p[0]), lanes.times(second_b, p[1]));
    [
        lanes.add(linear[0], linear[1]),
        lanes.sub(across[0], across[1]),
        lanes.add(turn_a, lanes.times(tangent_a, p[2])),
        lanes.add(turn_b, lanes.times(tangent_b, p[2])),
    ]
}

/// The impulses along x and y and of rotation of a body, and the weighted ones, in 2^-64 N·s.
#[inline(always)]
pub(super) fn joined(Sums([low, high, turn]): &Sums) -> [[i128; 3]; 2] {
    let join = |low: i64, high: i64| i128::from(low) + (i128::from(high) << LIMB);
    [
        [join(low[0], high[0]), join(low[1], high[1]), join(turn[0], turn[2])],
        [join(low[2], high[2]), join(low[3], high[3]), join(turn[1], turn[3])],
    ]
}

/// The impulse on the second body of a contact, along x, y, and of rotation of the first and of the second body over their lengths, for
/// impulses along its three rows: in 2^-64 N·s.
pub(super) fn on_bodies(group: &Group, lane: usize, rows: [i64; 3]) -> [i128; 4] {
    let [nx, ny] = group.normal[lane].map(i128::from);
    let [p1, p2, t] = rows.map(i128::from);
    let turn = |side: usize| {
        let [k1, k2, kt] = [0, 1, 2].map(|row| i128::from(group.arms[row][lane][side]));
        k1 * p1 + k2 * p2 + kt * t
    };
    let bits = -group.raise[lane] as i32;
    [nx * (p1 + p2) + ny * t, ny * (p1 + p2) - nx * t, turn(0), turn(1)].map(|value| shifted_within(value, bits))
}

/// value · 2^-bits within the largest impulse.
#[inline]
pub(super) fn shifted_within(value: i128, bits: i32) -> i128 {
    if bits < 0 && 128 - value.unsigned_abs().leading_zeros() as i32 - bits > 111 {
        return if value < 0 { -LARGEST } else { LARGEST };
    }
    shifted(value, bits).clamp(-LARGEST, LARGEST)
}

/// The impulses of a lane along its three rows.
#[inline(always)]
pub(super) fn lane_of(values: &[[i64; GROUP]; 3], lane: usize) -> [i64; 3] {
    [values[0][lane], values[1][lane], values[2][lane]]
}
