//! Rolling resistance: a contact with one point holds against a torque that turns its bodies against each other.
//!
//! The row of a contact has the velocity w = R·(ω_b − ω_a), with the radius R of the outline that rolls, and its impulse p acts at the
//! lever R: it is a friction row without a linear part, with the limit c·λ for the coefficient c and the normal impulse λ.
//!
//! Rows are solved in the relax passes, the rows of a phase after its friction: they see the velocities that friction left, but not each
//! other. Where a disc rolls without slip each of the two rows undoes a part of the change by the other one, two thirds of it
//! for a disc of even density: an eighth is left after the five sub-steps of a step, and impulses are kept.
//!
//! Where two arcs touch, the smaller radius counts: with the larger one a ball could not roll on a planet.
//!
//! There are no lanes: each row is computed in 64 and 128 bits, so all vector sets have the same bits. A scene without rolling resistance
//! has neither rows nor memory for them.
//!
//! Reads: normal impulses, angular velocities. Writes: gains of bodies; in the end impulses of contacts and totals of bodies.
//!
//! # Ranges
//! Arms are at most 2^54 and angular velocities below 2^27: the sum of both products is below 2^82, and times the reciprocal below
//! 2^113. Factors of gains are at most 2^40, shares below 2^22: the sum for the reciprocal is below 2^117.

use alloc::vec::Vec;

use super::apply::Total;
use super::bodies::BodyRows;
use super::cut::CHANGE;
use super::graph::{Graph, PHASES};
use super::group::{GAIN, Group, scaled_impulse};
use super::groups::{ContactGroups, Place, Shares};
use super::limbs::shifted_within;
use super::motion::Rows;
use super::number::{shifted, shifted_word};
use super::pass::Pass;
use super::unit::FINEST;
use super::{Contact, Flight, StepInput};
use crate::fx::Fx;
use crate::kernel::simd::Lanes;

/// The largest arm.
const ARM: i64 = 1 << 54;
/// log2 of the largest factor of a gain.
const FACTOR_BITS: i32 = 40;

/// The row of a contact.
#[derive(Clone, Debug, PartialEq)]
struct Roll {
    place: Place,
    bodies: [u32; 2],
    /// The rows of both bodies.
    rows: [u32; 2],
    /// R, in 2^-32 m.
    radius: i64,
    /// R over the lengths of both bodies, in 2^-30.
    arms: [i64; 2],
    /// Changes of angular velocity of both bodies by an impulse, as gains.
    factors: [i64; 2],
    /// The largest gain of each body by one row.
    gain_limits: [i64; 2],
    /// The reciprocal of the change of the row's velocity by an impulse: a number of 31 bits, and a shift.
    inverse: (i64, i32),
    /// c, in 2^-30.
    coefficient: i64,
    /// The impulse of the sub-step, the sum over sub-steps, and the sum over sub-steps of the impulses applied up to the move.
    impulse: i64,
    applied: i64,
    weighted: i64,
}

/// The rows of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Rolls {
    phases: [Vec<Roll>; PHASES],
    shares: Shares,
}

/// Returns true for a contact that resists rolling.
pub(super) fn resists(contact: &Contact) -> bool {
    contact.count == 1 && contact.rolling_resistance > Fx::ZERO && contact.rolling_radius > Fx::ZERO
}

impl Roll {
    fn limit(&self, groups: &[Group]) -> i64 {
        let normal = groups[self.place.group as usize].impulses[0][self.place.lane as usize];
        // Below 2^45 · 2^30; at most the normal impulse.
        shifted(i128::from(self.coefficient) * i128::from(normal), 30) as i64
    }

    /// The impulse after a relax pass, and whether its change was cut off.
    fn solved(&self, groups: &[Group], rows: &Rows, pass: Pass) -> (i64, bool) {
        let mut limit = i128::from(self.limit(groups));
        if pass == Pass::RelaxAgain {
            limit = limit.min(i128::from(self.impulse).abs());
        }
        let turning = self.rows.map(|row| i128::from(rows.velocity(row)[2]));
        let velocity = i128::from(self.arms[1]) * turning[1] - i128::from(self.arms[0]) * turning[0];
        let (reciprocal, shift) = self.inverse;
        let change = shifted(velocity * i128::from(reciprocal), shift);
        let wanted = (i128::from(self.impulse) - change).clamp(-limit, limit) as i64 - self.impulse;
        let change = wanted.clamp(-CHANGE, CHANGE);
        (self.impulse + change, change != wanted)
    }

    /// Adds a change of the impulse to the gains of both bodies.
    fn push(&self, rows: &mut Rows, change: i64) {
        for (side, sign) in [-1, 1].into_iter().enumerate() {
            let limit = i128::from(self.gain_limits[side]);
            let gain = (i128::from(self.factors[side]) * i128::from(change)).clamp(-limit, limit) as i64;
            rows.rows[self.rows[side] as usize].gain[2] += sign * gain;
        }
    }
}

impl Rolls {
    /// Makes the rows of contacts that resist rolling.
    pub(super) fn set(&mut self, input: &StepInput<'_>, graph: &Graph, bodies: &BodyRows, groups: &ContactGroups) {
        let Self { phases, shares } = self;
        let StepInput { flights, contacts, .. } = *input;
        let ContactGroups { places, phase_of, .. } = groups;
        phases.iter_mut().for_each(Vec::clear);
        if !groups.has_rolls {
            return;
        }
        shares.clear(flights.len());
        let resisting = || places.iter().filter(|place| resists(&contacts[place.contact as usize]));
        for &Place { contact, .. } in resisting() {
            let phase = usize::from(phase_of[contact as usize]);
            shares.count(&bodies.row_of, phase, contacts[contact as usize].bodies);
        }
        for place in resisting() {
            let contact = &contacts[place.contact as usize];
            let phase = phase_of[place.contact as usize];
            let (group, lane) = (&groups.groups[place.group as usize], place.lane as usize);
            let unit = graph.mover(contact.bodies).map_or(FINEST, |mover| bodies.bodies[mover as usize].unit);
            let radius = contact.rolling_radius.to_bits().min(1 << 46);
            let ends = contact.bodies.map(|body| &flights[body as usize]);
            let arms = ends.map(|flight| match 2 + flight.length() {
                up @ ..=-8 if radius >> (54 + up).max(0) != 0 => ARM,
                down => shifted_word(radius, down).min(ARM),
            });
            let factors = ends.map(|flight| factor(flight, radius, place.exponent, unit));
            let shares = contact.bodies.map(|body| i64::from(shares.counts[body as usize][usize::from(phase)]));
            let element = |side: usize| i128::from(shares[side]) * i128::from(arms[side]) * i128::from(factors[side]);
            let sum = shifted(element(0) + element(1), 30);
            let bits = 128 - sum.leading_zeros() as i32;
            // A quotient of 2^(bits + 30): at most 2^31. Where no body can be turned there is a row as well: gains are rounded each time
            // that they are applied, so all bodies of such contacts get theirs as often, whoever else has a row.
            let reciprocal = match bits {
                0 => 0,
                ..97 => (1 << (bits + 30)) / sum,
                _ => (1 << 126) / (sum >> (bits - 96)),
            };
            phases[usize::from(phase)].push(Roll {
                place: *place,
                bodies: contact.bodies,
                rows: [group.a[lane], group.b[lane]],
                radius,
                arms,
                factors,
                gain_limits: shares.map(|share| GAIN / share),
                inverse: (reciprocal as i64, bits + 30),
                coefficient: shifted_word(contact.rolling_resistance.to_bits(), 2).min(1 << 30),
                impulse: scaled_impulse(&contact.impulses, 1, place.exponent),
                applied: 0,
                weighted: 0,
            });
        }
    }

    /// One pass over the rows of a phase. The result is the number of values that were cut off.
    #[inline(always)]
    pub(super) fn run<L: Lanes>(
        &mut self,
        phase: usize,
        pass: Pass,
        groups: &[Group],
        rows: &mut Rows,
        lanes: L,
    ) -> u64 {
        if self.phases[phase].is_empty() || pass == Pass::Solve {
            return 0;
        }
        self.change(phase, pass, groups, rows) + rows.apply_gains(lanes, &self.shares.touched[phase])
    }

    /// Changes the impulses, and adds to the gains of bodies. Returns the number of impulses that were cut off.
    #[inline(never)]
    fn change(&mut self, phase: usize, pass: Pass, groups: &[Group], rows: &mut Rows) -> u64 {
        let mut cut = 0;
        for roll in &mut self.phases[phase] {
            if pass == Pass::WarmStart {
                roll.push(rows, roll.impulse);
                continue;
            }
            let ((after, is_cut), before) = (roll.solved(groups, rows, pass), roll.impulse);
            if pass == Pass::Relax {
                roll.weighted += roll.applied + before;
                roll.applied += before;
            }
            roll.applied += after - before;
            roll.impulse = after;
            cut += u64::from(is_cut);
            roll.push(rows, after - before);
        }
        cut
    }

    pub(super) fn is_empty(&self) -> bool {
        self.phases.iter().all(Vec::is_empty)
    }

    /// Writes the impulses that the next step starts from, and adds the impulses of this step to the totals of bodies.
    pub(super) fn apply(&self, groups: &[Group], contacts: &mut [Contact], totals: &mut [Total]) {
        for roll in self.phases.iter().flatten() {
            // A contact that bounced starts with a smaller normal impulse.
            let limit = roll.limit(groups);
            contacts[roll.place.contact as usize].impulses.values[1] = roll.impulse.clamp(-limit, limit);
            for (is_weighted, sum) in [(false, roll.applied), (true, roll.weighted)] {
                // From 2^(exponent − 32) to 2^-64 N·m·s: below 2^54 · 2^46.
                let turn = shifted_within(i128::from(sum) * i128::from(roll.radius), -32 - roll.place.exponent);
                for (sign, body) in [-1, 1].into_iter().zip(roll.bodies) {
                    totals[body as usize].add(is_weighted, [0, 0, sign * turn]);
                }
            }
        }
    }
}

/// The change of the angular velocity of a body, in 2^`unit` over its length, by an impulse of 2^`exponent` N·s at a lever, as a gain.
fn factor(flight: &Flight, radius: i64, exponent: i32, unit: i32) -> i64 {
    let (mantissa, shift) = flight.inverse_inertia.parts();
    // Below 2^64 · 2^46.
    let product = i128::from(mantissa) * i128::from(radius);
    let down = shift + 32 - flight.length() - exponent + unit - 30;
    let bits = 128 - product.leading_zeros() as i32 - down;
    if bits > FACTOR_BITS { 1 << FACTOR_BITS } else { shifted(product, down) as i64 }
}
