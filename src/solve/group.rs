//! A group of contacts side by side in lanes, and the values with which each contact begins a step.

use core::ops::Range;

use super::Impulses;
use super::bodies::STILL;
use super::number::{bits_of, shifted_word};
use crate::kernel::simd::{GROUP, Pairs};

/// The largest separation, positive or negative, 2^29.5 units: more than bodies approach in a step.
pub(super) const SEPARATION: i64 = 759_250_124;
/// The largest impulse at the start of a step.
pub(super) const IMPULSE: i64 = 1 << 44;
/// The largest gain of a body by all contacts of a phase: 2^31 units. Velocities change by less than 2^28 of them.
pub(super) const GAIN: i64 = 1 << 61;
/// The largest velocity of a surface: as large as a velocity of a body.
pub(super) const SURFACE: i64 = 1 << 27;

/// Contacts side by side: through the sub-steps a lane is in place of a [`Contact`](super::Contact). Pairs are of two quantities of the same contact.
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
    /// Separations where the bodies are now, from the last relax pass; before the first one the separations at the start.
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
    /// Inverse of the matrix of the normal rows, elements 11 and 22, in 2^-shift: with no point soft, the first, the second, both. The inverses
    /// with one point soft are made when a pass first asks for them: up to then, in their places, elements 11 and 22 of the matrix, and what
    /// softness adds to both.
    pub(super) inverse: [Pairs; 4],
    /// Element 12: with no point soft and the first; with the second and both. Up to then element 12 of the matrix, and −1 with two points.
    pub(super) inverse_12: [Pairs; 2],
    /// log2 of the units of both rows of the matrix over the unit of the inverse.
    pub(super) inverse_units: Pairs,
    pub(super) inverse_shift: [i64; GROUP],
    /// Element 12 of the matrix over element 11, rigid and soft, in 2^-28. Ratios are made when a pass first asks for them.
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
    /// Velocity of the surfaces against each other along the tangent, and the speed of the slowest impact: at least the one that forces
    /// give in a step, so that bodies come to rest whatever bounces.
    pub(super) surface: Pairs,
    /// Impulses of the sub-step: both normal ones and friction.
    pub(super) impulses: [[i64; GROUP]; 3],
    /// Sums of the impulses of sub-steps.
    pub(super) applied: [[i64; GROUP]; 3],
    /// Sums over sub-steps of the impulses applied up to the move.
    pub(super) weighted: [[i64; GROUP]; 3],
    /// log2 of the unit of the products of impulses with normals and arms over 2^-64 N·s.
    pub(super) raise: [i64; GROUP],
    /// The number of lanes that hold a contact. It stands behind the vectors, so that all of them are aligned.
    pub(super) count: usize,
    /// True if the inverses with one point soft are made.
    pub(super) has_one_soft: bool,
    /// True if the ratios are made.
    pub(super) has_ratios: bool,
}

impl Group {
    /// A group without contacts. All lanes name the row `idle`.
    pub(super) fn empty(idle: u32) -> Self {
        let pairs = [[0; 2]; GROUP];
        Self {
            a: [idle; GROUP],
            b: [idle; GROUP],
            count: 0,
            has_one_soft: true,
            has_ratios: true,
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
            inverse_units: pairs,
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
            raise: [0; GROUP],
        }
    }
}

impl Group {
    /// Makes lanes empty.
    pub(super) fn clear(&mut self, lanes: Range<usize>) {
        for lane in lanes {
            (self.a[lane], self.b[lane]) = (STILL, STILL);
            for pairs in [&mut self.normal, &mut self.separation, &mut self.separation_now, &mut self.push_out] {
                pairs[lane] = [0; 2];
            }
            (self.friction[lane], self.surface[lane]) = ([0; 2], [0; 2]);
            (self.angular_shift[lane], self.inverse_shift[lane]) = (0, 30);
            self.impulses.iter_mut().for_each(|impulses| impulses[lane] = 0);
        }
    }
}

/// An impulse that the step begins with, in 2^exponent N·s, within ±[`IMPULSE`].
#[inline(always)]
pub(super) fn scaled_impulse(impulses: &Impulses, k: usize, exponent: i32) -> i64 {
    let impulse = impulses.values[k];
    let down = exponent.saturating_sub(impulses.exponent);
    let up = down.saturating_neg();
    let scaled = match up {
        ..=0 => shifted_word(impulse, down),
        // Beyond the limits, however far it is shifted.
        _ if up.saturating_add(bits_of(impulse)) > bits_of(IMPULSE) => impulse.signum() * IMPULSE,
        _ => impulse << up,
    };
    scaled.clamp(-IMPULSE, IMPULSE)
}
