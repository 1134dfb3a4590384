//! Units of the solver, and the constants of soft contacts.
//!
//! Velocities are multiples of 2^unit m/s, one unit for each island. A length is a multiple of the way of one unit of velocity in
//! a sub-step, so that velocities add to displacements without a product.

use super::SolverOptions;
use super::group::SEPARATION;
use super::number::{clamped, shifted};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift_64;
use crate::math::TimeStep;
use crate::scalar::FxFactor;

/// log2 of the finest unit of velocity: 2.4e-7 m/s.
pub(super) const FINEST: i32 = -22;

/// Fraction bits of the speeds that a unit is chosen for: the finest unit is for speeds of up to a few metres a second.
pub(super) const COARSE: i32 = 16;

/// The time of a step and its sub-steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// Sub-steps a second.
    rate: FxFactor,
    /// The length of a sub-step, s.
    pub(super) substep: FxFactor,
    /// The turns of an angular velocity of 1 rad/s in a sub-step.
    pub(super) substep_turns: FxFactor,
    pub(super) substeps: u32,
}

impl Clock {
    pub(crate) fn new(time_step: TimeStep, substeps: u32) -> Self {
        let (num, den) = time_step.seconds();
        let parts = u64::from(den) * u64::from(substeps);
        let substep = FxFactor::from_ratio(u64::from(num), parts);
        Self {
            rate: FxFactor::from_ratio(parts, u64::from(num)),
            substep,
            substep_turns: substep.over(FxFactor::PI.times(2.into())),
            substeps,
        }
    }

    /// The displacement of sub-steps of semi-implicit Euler from one velocity to another: h·(n·v0 + (v1 − v0)·(n + 1)/2), for
    /// velocities in 2^-32 m/s, in 2^-32 m.
    #[inline(always)]
    pub(super) fn euler(&self, start: i64, end: i64) -> i128 {
        let n = i128::from(self.substeps);
        let twice = (n - 1) * i128::from(start) + (n + 1) * i128::from(end);
        let (mantissa, shift) = self.substep.parts();
        match i64::try_from(twice) {
            Ok(twice) if (64..127).contains(&shift) => multiple(twice, mantissa, shift + 1).into(),
            _ => mul_shift_64(twice, mantissa, shift + 1).unwrap_or(0),
        }
    }

    /// Sub-steps a second: the upper 31 bits of the number, and a shift.
    pub(super) fn short_rate(&self) -> (i32, i32) {
        let (mantissa, shift) = self.rate.parts();
        ((mantissa >> 33) as i32, shift - 33)
    }

    /// A length in units of velocity times a sub-step. *Domain* the result is below 2^126.
    pub(super) fn length(&self, metres: Fx, unit: i32) -> i128 {
        self.length_of_bits(metres.to_bits().into(), unit)
    }

    /// [`length`](Self::length) within ±limit.
    #[inline(always)]
    pub(super) fn length_within(&self, metres: Fx, unit: i32, limit: i64) -> i32 {
        let (mantissa, shift) = self.rate.parts();
        match shift + 32 + unit {
            down @ 64..128 => multiple(metres.to_bits(), mantissa, down).clamp(-limit, limit) as i32,
            _ => clamped(self.length(metres, unit), limit.into()),
        }
    }

    /// [`length`](Self::length) of 2^-32 m.
    #[inline(always)]
    pub(super) fn length_of_bits(&self, bits: i128, unit: i32) -> i128 {
        let (mantissa, shift) = self.rate.parts();
        match (i64::try_from(bits), shift + 32 + unit) {
            (Ok(word), down @ 64..128) => multiple(word, mantissa, down).into(),
            (_, down) => far_multiple(bits, mantissa, down),
        }
    }
}

/// [`multiple`] of any number and shift, as far as it fits.
#[cold]
fn far_multiple(value: i128, mantissa: u64, shift: i32) -> i128 {
    mul_shift_64(value, mantissa, shift).unwrap_or(if value < 0 { -i128::MAX } else { i128::MAX })
}

/// value · mantissa · 2^-shift to nearest, ties to even: [`mul_shift_64`] of a word. *Domain* 64 ≤ shift < 128.
#[inline(always)]
pub(super) fn multiple(value: i64, mantissa: u64, shift: i32) -> i64 {
    // Below 2^127: the upper half, and the result, are below 2^63.
    let product = u128::from(value.unsigned_abs()) * u128::from(mantissa);
    let (high, low) = ((product >> 64) as u64, product as u64);
    let right = (shift - 64) as u32;
    let floor = high >> right;
    // The fraction in 2^-64, and whether there is more below it: up from one half on if there is or the floor is odd.
    let fraction = high << 1 << (63 - right) | low >> right;
    let is_more = low << 1 << (63 - right) != 0;
    let nearest = (floor + u64::from(fraction > (1 << 63) - (floor & 1 | u64::from(is_more)))) as i64;
    if value < 0 { -nearest } else { nearest }
}

/// The unit of velocity of an island, 2^unit m/s, and the values that depend on it alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) unit: i32,
    /// Contacts of two bodies that move, and contacts with a body that cannot be moved.
    pub(super) moving: SoftContact,
    pub(super) fixed: SoftContact,
    /// [`Softness::impact_speed`]
    pub(super) impact_speed: i32,
    /// A separation in 2^-32 m is shifted down by `before`, within `limit` then, multiplied by [`Clock::short_rate`] and shifted down by
    /// `after`.
    pub(super) before: i64,
    pub(super) limit: i64,
    pub(super) after: i64,
}

/// The softness of a contact in the unit of its island.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftContact {
    /// Velocity at which an overlap is pushed out, in 2^-30 of it, and the deepest overlap that counts, as a separation.
    pub(super) push_out: [i32; 2],
    /// [`SoftRow::compliance`]
    pub(super) compliance: i32,
}

impl Scale {
    pub(super) fn new(clock: &Clock, softness: &Softness, unit: i32) -> Self {
        let soft_contact = |row: &SoftRow| SoftContact {
            push_out: [row.rate, -clamped(softness.deepest(unit, row), SEPARATION.into())],
            compliance: row.compliance,
        };
        let impact_speed = softness.impact_speed(unit);
        let (moving, fixed) = (soft_contact(&softness.moving), soft_contact(&softness.fixed));
        let (rate, shift) = clock.short_rate();
        // Rates are below 2^32 and units at least 2^-22: it is positive.
        let down = i64::from(shift + 32 + unit).max(0);
        let after = down.min(31);
        let limit = (SEPARATION << after) / i64::from(rate) + 1;
        Self { unit, moving, fixed, impact_speed, before: (down - after).min(62), limit, after }
    }
}

/// log2 of the unit of velocity of an island whose fastest part moves at `speed`, in 2^-[`COARSE`] m/s.
///
/// The velocities of free flights are below 2^24 units and their displacements below 2^26: an eighth and a quarter of the
/// limits, as impulses lead farther. Where a heavy body at this speed v meets a light one at its rim, the light one's angular velocity
/// changes by up to 2·v/R. That is 4·v by the length, which is below 2·R, and a sub-step begins with twice the change of the one before.
pub(super) fn unit_for(speed: u64, substeps: u32) -> i32 {
    let bound = u128::from(speed) * u128::from(substeps.max(4));
    (128 - bound.leading_zeros() as i32 - COARSE - 26).max(FINEST)
}

/// The largest push-out velocity, in units.
const PUSH: i128 = 1 << 25;

/// The constants of one kind of contact or joint.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SoftRow {
    /// The velocity by which a unit of overlap is pushed out, in 2^-30: hω/(2ζ + hω).
    pub(super) rate: i32,
    /// Compliance over the effective inverse mass, in 2^-30: 1/(hω(2ζ + hω)).
    pub(super) compliance: i32,
}

/// The constants of soft contacts and joints.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softness {
    /// Contacts of two bodies that move.
    pub(super) moving: SoftRow,
    /// Contacts with a body that cannot be moved: twice as stiff.
    pub(super) fixed: SoftRow,
    /// m/s
    push_speed: Fx,
    restitution_speed: Fx,
    /// Joints in loops.
    pub(super) joint: SoftRow,
}

/// 2π in 2^-30.
const TAU: i128 = 6_746_518_852;

impl SoftRow {
    /// *Domain* frequency times sub-step up to 1, damping ratio up to 2^6; not negative. The compliance saturates at one half, so that
    /// its product with elements of the matrix, below 2^34, fits: at a damping ratio of 10, at frequencies below 1/64.
    fn new(frequency: Fx, damping_ratio: Fx) -> Self {
        const ONE: i128 = 1 << 30;
        // hω and 2ζ + hω in 2^-30.
        let omega = shifted(TAU * i128::from(frequency.to_bits()), 32);
        let sum = 2 * shifted(damping_ratio.to_bits().into(), 2) + omega;
        let quotient = |num: i128, den: i128, limit: i128| ((2 * num + den) / (2 * den)).min(limit) as i32;
        Self {
            rate: quotient(omega * ONE, sum.max(1), i32::MAX.into()),
            compliance: quotient(ONE * ONE * ONE, (omega * sum).max(1), (ONE >> 1) - 1),
        }
    }
}

impl Softness {
    pub(crate) fn new(options: &SolverOptions) -> Self {
        let double = options.frequency.saturating_add(options.frequency);
        Self {
            moving: SoftRow::new(options.frequency, options.damping_ratio),
            fixed: SoftRow::new(double, options.damping_ratio),
            push_speed: options.push_speed,
            restitution_speed: options.restitution_speed,
            joint: SoftRow::new(options.joint_frequency, options.joint_damping_ratio),
        }
    }

    /// The speed from which on points that meet have an impact, in units of velocity: at least one, at most 2^28.
    pub(super) fn impact_speed(&self, unit: i32) -> i32 {
        shifted(self.restitution_speed.to_bits().into(), 32 + unit).clamp(1, 1 << 28) as i32
    }

    /// The overlap from which on the bias is the push speed plus the part that softness takes of it.
    pub(super) fn deepest(&self, unit: i32, row: &SoftRow) -> i128 {
        let speed = shifted(self.push_speed.to_bits().into(), 32 + unit).min(PUSH);
        let push = speed + shifted(speed * i128::from(row.compliance), 30);
        (push << 30) / i128::from(row.rate.max(1))
    }
}
