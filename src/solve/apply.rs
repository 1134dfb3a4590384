//! Exact impulses, applied once a step.
//!
//! Reads: the lanes of contacts, rolling rows, strikes, paths and totals by joints. Writes: the impulses of contacts, corrections.
//!
//! A body flies freely from x0 to x1, at velocities v0 to v1, and impulses add h·Q/m to the displacement, with Q the impulses weighted
//! by the sub-steps that they moved it in. The solver took the free flight for sub-steps of semi-implicit Euler, whose displacement
//! differs from x1 − x0 by o: for velocity Verlet, by (v1 − v0)·h/2. So a body at rest would rise by as much in each step. The
//! part of the free flight that impulses cancel therefore counts as in the solver: with the change Δv by impulses,
//! Δv·(o·Δv) / max(Δv², −(v1 − v0)·Δv) is added where the impulses work against the change v1 − v0. A body without impulses gets
//! nothing, a body at rest o, one that is hit hard the part of o along Δv.
//!
//! Joints turn with their bodies, so that no such part is right for them: a pendulum whose impulses cancel o along the rod alone
//! gains 1 % of its energy a second. Bodies with joints end where the sub-steps lead, with all of o, if a fixed body holds their island,
//! by a joint or by a contact that pressed in the step before, and else where their free flight does ([`Path`]).
//!
//! The impulse vector of a contact is rounded once to 2^-64 N·s, and both bodies get the same one with opposite signs (`limbs`): the
//! momentum of bodies that are not fixed changes by the rounding of velocities alone.

use alloc::vec::Vec;

use super::bodies::{BodyRows, STILL};
use super::group::Group;
use super::groups::ContactGroups;
use super::impact::Strike;
use super::limbs::{Size, add_impulses, joined, lane_of, on_bodies, shifted_within};
use super::number::bits_of;
use super::rolling::Rolls;
use super::unit::Clock;
use super::{Contact, Correction, Flight, Impulses};
use crate::fx::Fx;
use crate::kernel::simd::{Job, Lanes, Sums};
use crate::kernel::wide::mul_shift_64;
use crate::math::Vec2;
use crate::scalar::{Accumulator, FxAccumulator, FxFactor};

/// The way of a body in a step, to which the impulses add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// A body with contacts alone: its free flight, as far as impulses do not cancel it.
    Contacts,
    /// A body with joints in an island that no fixed body holds: its free flight.
    Flight,
    /// A body with joints in an island that a fixed body holds: the sub-steps of semi-implicit Euler.
    Substeps,
}

/// Impulses on a body, in 2^-64 N·s and N·m·s: their sum, and their sum weighted with the sub-steps that they moved it in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Total {
    impulse: [i128; 3],
    weighted: [i128; 3],
    /// The part of `impulse` by impacts.
    struck: [i128; 3],
}

impl Total {
    /// Adds an impulse along x and y and of rotation.
    #[inline(always)]
    pub(super) fn add(&mut self, is_weighted: bool, impulse: [i128; 3]) {
        let [x, y, turn] = if is_weighted { &mut self.weighted } else { &mut self.impulse };
        (*x, *y, *turn) = (*x + impulse[0], *y + impulse[1], *turn + impulse[2]);
    }

    /// Adds an impulse of impacts, which is part of `impulse`.
    fn add_struck(&mut self, impulse: [i128; 3]) {
        (0..3).for_each(|i| self.struck[i] += impulse[i]);
    }

    fn is_zero(&self) -> bool {
        are_zero(self.impulse) && are_zero(self.weighted)
    }
}

/// Returns true for no impulse. Arrays would be compared in memory, and the processor would wait for them to be written.
#[inline(always)]
fn are_zero([x, y, turn]: [i128; 3]) -> bool {
    x | y | turn == 0
}

/// impulse · factor as a change of velocity, in 2^-96, to nearest, ties away from zero.
#[inline(always)]
fn changed(impulse: i128, factor: FxFactor) -> FxAccumulator {
    let (mantissa, shift) = factor.parts();
    let down = shift - 32;
    let (high, low) = ((impulse >> 64) as i64, impulse as u64);
    // |impulse| below 2^(62 + down): the result is below 2^126.
    if matches!(down, 2..64) && (high ^ (high >> 63)) >> (down - 2) == 0 {
        let lower = u128::from(low) * u128::from(mantissa);
        let upper = i128::from(high) * i128::from(mantissa) + i128::from((lower >> 64) as u64);
        // Half of the unit, less by one for negative products: ties go away from zero.
        let half = (1_u64 << (down - 1)) - u64::from(high < 0);
        let (rest, carry) = (lower as u64).overflowing_add(half);
        let upper = upper + i128::from(carry);
        return FxAccumulator::from_bits(upper << (64 - down) | i128::from(rest >> down));
    }
    changed_far(impulse, factor)
}

/// [`changed`] of any size.
#[cold]
#[inline(never)]
fn changed_far(impulse: i128, factor: FxFactor) -> FxAccumulator {
    let (mantissa, shift) = factor.parts();
    match mul_shift_64(impulse, mantissa, shift - 32) {
        // Its top two bits are equal.
        Some(change) if ((change >> 64) as i64) << 1 >> 1 == (change >> 64) as i64 => FxAccumulator::from_bits(change),
        // A change beyond that is beyond all limits of a body, and the sum with its velocity still fits.
        _ => FxAccumulator::from_bits(impulse.signum() << 126),
    }
}

/// Exact impulses and corrections of all bodies, once the impulses of joints are in the totals.
pub(super) struct Apply<'a> {
    pub(super) clock: &'a Clock,
    pub(super) bodies: &'a BodyRows,
    pub(super) groups: &'a ContactGroups,
    pub(super) rolls: &'a Rolls,
    pub(super) strikes: &'a [Strike],
    /// Paths by body; empty without joints.
    pub(super) paths: &'a [Path],
    pub(super) impulses: &'a mut ImpulseSums,
    pub(super) flights: &'a [Flight],
    pub(super) contacts: &'a mut [Contact],
    pub(super) corrections: &'a mut Vec<Correction>,
}

/// The impulses of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct ImpulseSums {
    /// By body, of joints, rolling resistance and impacts; empty if there are none.
    pub(super) totals: Vec<Total>,
    /// Of contacts, by row; rotation is over the length of the body. Empty without contacts.
    sums: Vec<Sums>,
    /// Of contacts too large for [`Sums`], by row, likewise; empty if there are none.
    large: Vec<Total>,
}

impl Job for Apply<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        self.add_contacts(lanes);
        self.add_strikes();
        self.rolls.apply(&self.groups.groups, self.contacts, &mut self.impulses.totals);
        let Self { clock, bodies, paths, impulses, flights, corrections, .. } = self;
        corrections.clear();
        corrections.reserve(flights.len());
        let mut ways = Ways::default();
        // A loop: a closure would not be compiled for the instructions of the job.
        for (body, flight) in flights.iter().enumerate() {
            let (row, length) = (bodies.row_of[body], bodies.bodies[body].length);
            // A body without a row is in no island.
            let mut correction = Correction::default();
            if row != STILL {
                let total = impulses.total(body, row, length);
                if !total.is_zero() {
                    let path = *paths.get(body).unwrap_or(&Path::Contacts);
                    ways.set(flight, clock);
                    correction = flight.correction(&total, path, clock, &ways);
                    correction.is_pushed = correction != Correction::default();
                }
            }
            corrections.push(correction);
        }
    }
}

impl Apply<'_> {
    /// Writes the impulses of contacts, and adds them to the sums.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add_contacts<L: Lanes>(&mut self, lanes: L) {
        let Self { bodies, groups: ContactGroups { groups, places, .. }, impulses, contacts, .. } = self;
        let ImpulseSums { sums, large, .. } = &mut **impulses;
        if places.len() < contacts.len() {
            contacts.iter_mut().for_each(|contact| contact.impulses = Impulses::default());
        }
        for place in places {
            let values = lane_of(&groups[place.group as usize].impulses, place.lane as usize);
            contacts[place.contact as usize].impulses = Impulses { values, exponent: place.exponent };
        }
        let rows = if groups.is_empty() { 0 } else { bodies.rows.len() as usize };
        sums.clear();
        sums.resize(rows, Sums::default());
        large.clear();
        let n = bits_of(places.len() as i64);
        for group in groups {
            match Size::new(group, n) {
                Size::Small => {
                    for at in (0..group.count).step_by(L::WIDTH) {
                        add_impulses::<L, false>(lanes, group, at, sums);
                    }
                }
                Size::Middle => {
                    for at in (0..group.count).step_by(L::WIDTH) {
                        add_impulses::<L, true>(lanes, group, at, sums);
                    }
                }
                Size::Large => {
                    large.resize(rows, Total::default());
                    add_large(group, large);
                }
            }
        }
    }

    /// Adds the impulses of impacts, which are part of the impulses of contacts.
    fn add_strikes(&mut self) {
        let Self { bodies, groups, strikes, impulses, contacts, .. } = self;
        for strike in *strikes {
            let (place, group, lane) = groups.lane_of(strike.place);
            let ends = contacts[place.contact as usize].bodies.map(|body| body as usize);
            let [x, y, turn_a, turn_b] = on_bodies(group, lane, strike.impulses);
            for (body, [x, y, turn]) in ends.into_iter().zip([[-x, -y, -turn_a], [x, y, turn_b]]) {
                let turn = shifted_within(turn, -bodies.bodies[body].length);
                impulses.totals[body].add_struck([x, y, turn]);
            }
        }
    }
}

/// Adds the impulses of a group to the totals by row.
#[cold]
#[inline(never)]
fn add_large(group: &Group, totals: &mut [Total]) {
    for lane in 0..group.count {
        for (is_weighted, sums) in [(false, &group.applied), (true, &group.weighted)] {
            let [x, y, turn_a, turn_b] = on_bodies(group, lane, lane_of(sums, lane));
            totals[group.a[lane] as usize].add(is_weighted, [-x, -y, -turn_a]);
            totals[group.b[lane] as usize].add(is_weighted, [x, y, turn_b]);
        }
    }
}

impl ImpulseSums {
    /// Begins a step, with totals by body if there is anything but contacts.
    pub(super) fn begin(&mut self, bodies: usize, has_totals: bool) {
        self.totals.clear();
        self.totals.resize(if has_totals { bodies } else { 0 }, Total::default());
    }

    /// All impulses on a body.
    #[inline(always)]
    fn total(&self, body: usize, row: u32, length: i32) -> Total {
        let Some(sums) = self.sums.get(row as usize) else {
            return self.totals.get(body).copied().unwrap_or_default();
        };
        let [mut impulse, mut weighted] = joined(sums);
        if let Some(large) = self.large.get(row as usize) {
            (0..3).for_each(|i| {
                (impulse[i], weighted[i]) = (impulse[i] + large.impulse[i], weighted[i] + large.weighted[i])
            });
        }
        (impulse[2], weighted[2]) = (shifted_within(impulse[2], -length), shifted_within(weighted[2], -length));
        let mut total = Total { impulse, weighted, struck: [0; 3] };
        if let Some(others) = self.totals.get(body) {
            total.add(false, others.impulse);
            total.add(true, others.weighted);
            total.struck = others.struck;
        }
        total
    }
}

/// Inverse masses times a sub-step, of the body before: most bodies have the same.
#[derive(Clone, Copy, Default)]
struct Ways {
    mass: Vec2<FxFactor>,
    inertia: FxFactor,
    moved: Vec2<FxFactor>,
    turned: FxFactor,
}

impl Ways {
    #[inline(always)]
    fn set(&mut self, flight: &Flight, clock: &Clock) {
        let Flight { inverse_mass: mass, inverse_inertia: inertia, .. } = *flight;
        if (self.mass, self.inertia) != (mass, inertia) {
            let moved_x = mass.x.times(clock.substep);
            let moved_y = if mass.y == mass.x { moved_x } else { mass.y.times(clock.substep) };
            *self = Self { mass, inertia, moved: Vec2::new(moved_x, moved_y), turned: inertia.times(clock.substep) };
        }
    }
}

impl Flight {
    /// The change of a body by its impulses.
    #[inline(always)]
    fn correction(&self, total: &Total, path: Path, clock: &Clock, ways: &Ways) -> Correction {
        let ([x, y, turn], [wx, wy, wt]) = (total.impulse, total.weighted);
        let (mass, inertia) = (self.inverse_mass, self.inverse_inertia);
        let velocity = Vec2::new(changed(x, mass.x), changed(y, mass.y));
        let angular_velocity = changed(turn, inertia);
        let [ox, oy, turned] = match path {
            Path::Flight => [FxAccumulator::default(); 3],
            Path::Substeps => self.offsets(clock).map(offset_in_full),
            Path::Contacts if are_zero(total.struck) => {
                self.cancelled([velocity.x, velocity.y, angular_velocity], clock)
            }
            Path::Contacts => {
                let [sx, sy, st] = total.struck;
                self.cancelled([changed(x - sx, mass.x), changed(y - sy, mass.y), changed(turn - st, inertia)], clock)
            }
        };
        let (moved_x, moved_y) = (changed(wx, ways.moved.x), changed(wy, ways.moved.y));
        Correction {
            is_pushed: false,
            velocity,
            angular_velocity,
            displacement: Vec2::new(moved_x.plus(ox), moved_y.plus(oy)),
            rotation: changed(wt, ways.turned).plus(turned),
        }
    }

    /// The offsets o of semi-implicit Euler from the free flight, in 2^-32 m and rad.
    #[inline(always)]
    pub(super) fn offsets(&self, clock: &Clock) -> [i128; 3] {
        let Self { start, end, displacement, rotation, .. } = self;
        [
            offset(clock, start.linear.x, end.linear.x, displacement.x),
            offset(clock, start.linear.y, end.linear.y, displacement.y),
            offset(clock, start.angular, end.angular, *rotation),
        ]
    }

    /// The part of the offsets that impulses cancel, for the changes of velocity by them. Where the free flight does not change a velocity,
    /// there is none to cancel.
    #[inline(always)]
    fn cancelled(&self, change: [FxAccumulator; 3], clock: &Clock) -> [FxAccumulator; 3] {
        let Self { start, end, displacement, rotation, .. } = self;
        let [vx, vy, spin] = [change[0].value(), change[1].value(), change[2].value()];
        let mut offsets = [FxAccumulator::default(); 3];
        if start.linear != end.linear {
            let flown = [flown(start.linear.x, end.linear.x), flown(start.linear.y, end.linear.y)];
            let ox = offset(clock, start.linear.x, end.linear.x, displacement.x);
            let oy = offset(clock, start.linear.y, end.linear.y, displacement.y);
            [offsets[0], offsets[1]] = cancelled([vx, vy], flown, [ox, oy]);
        }
        if start.angular != end.angular {
            let turn = offset(clock, start.angular, end.angular, *rotation);
            [offsets[2]] = cancelled([spin], [flown(start.angular, end.angular)], [turn]);
        }
        offsets
    }
}

/// The change of a velocity by the free flight, in 2^-32.
#[inline(always)]
fn flown(start: Fx, end: Fx) -> i128 {
    i128::from(end.to_bits()) - i128::from(start.to_bits())
}

/// The offset of a coordinate.
#[inline(always)]
fn offset(clock: &Clock, start: Fx, end: Fx, flown: Fx) -> i128 {
    clock.euler(start.to_bits(), end.to_bits()) - i128::from(flown.to_bits())
}

/// An offset as a displacement; offsets of 2^29 m and more, of bodies beyond all limits, count as that: with an impulse the sum fits.
fn offset_in_full(offset: i128) -> FxAccumulator {
    FxAccumulator::from_bits(offset.clamp(-(1 << 61), 1 << 61) << 64)
}

/// The part of an offset along a change of velocity by impulses, as far as they cancel the change `flown` of the free flight.
#[inline(always)]
fn cancelled<const N: usize>(change: [Fx; N], flown: [i128; N], offset: [i128; N]) -> [FxAccumulator; N] {
    // In 2^-32 m/s. Changes of 2^20 m/s and more count as that: the quotient below is less then.
    let bits = change.map(|v| v.to_bits().clamp(-(1 << 52), 1 << 52));
    // |v|² below 2^106, v·w below 2^118: v1 − v0 is below 2^65.
    let square = dot(bits.map(i128::from), bits);
    let against = -dot(flown, bits);
    if against <= 0 {
        return [FxAccumulator::default(); N];
    }
    // The quotient |o|/|v| with 40 bits after the point, less where o·v is beyond 2^86.
    let product = dot(offset, bits);
    if product == 0 {
        return [FxAccumulator::default(); N];
    }
    let places = 126_u32.saturating_sub(128 - product.unsigned_abs().leading_zeros()).min(40);
    let share = (product << places) / square.max(against);
    // v·share is at most |o|, in 2^-(32 + places) m: below 2^96. From there to 2^-96.
    bits.map(|v| FxAccumulator::from_bits((i128::from(v) * share) << (64 - places)))
}

/// a·b. Most often both fit in a word.
#[inline(always)]
fn dot<const N: usize>(a: [i128; N], b: [i64; N]) -> i128 {
    let product = |(a, b): (i128, i64)| match i64::try_from(a) {
        Ok(a) => i128::from(a) * i128::from(b),
        Err(_) => a * i128::from(b),
    };
    a.into_iter().zip(b).map(product).sum()
}
