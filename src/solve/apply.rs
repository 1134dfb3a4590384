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
//! The impulse vector of a contact is rounded once to 2^-64 N·s, and both bodies get the same one with opposite signs: the
//! momentum of bodies that are not fixed changes by the rounding of velocities alone.

use alloc::vec::Vec;

use super::bodies::BodyRows;
use super::group::Group;
use super::groups::ContactGroups;
use super::impact::Strike;
use super::number::{shifted, shifted_word};
use super::rolling::Rolls;
use super::unit::Clock;
use super::{Contact, Correction, Flight, Impulses};
use crate::fx::Fx;
use crate::kernel::simd::{GROUP, Job, Lanes};
use crate::kernel::wide::mul_shift_64;
use crate::math::Vec2;
use crate::scalar::{Accumulator, FxAccumulator, FxFactor};

/// Impulses of a contact are within ±2^46 N·s, or N·m·s: 2^110 units. 2^16 of them fit in a sum.
const LARGEST: i128 = 1 << 110;

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
        self.impulse == [0; 3] && self.weighted == [0; 3]
    }
}

/// impulse · factor as a change of velocity, in 2^-96.
#[inline(always)]
fn changed(impulse: i128, factor: FxFactor) -> FxAccumulator {
    let (mantissa, shift) = factor.parts();
    match mul_shift_64(impulse, mantissa, shift - 32) {
        // Its top two bits are equal.
        Some(change) if ((change >> 64) as i64) << 1 >> 1 == (change >> 64) as i64 => FxAccumulator::from_bits(change),
        // A change beyond that is beyond all limits of a body, and the sum with its velocity still fits.
        _ => FxAccumulator::from_bits(impulse.signum() << 126),
    }
}

/// The impulses on both bodies of a contact, for impulses along its three rows in units of 2^exponent N·s.
#[inline(always)]
pub(super) fn on_bodies(
    group: &Group,
    lane: usize,
    exponent: i32,
    rows: [i64; 3],
    lengths: [i32; 2],
) -> [[i128; 3]; 2] {
    // From 2^(exponent − 30) to 2^-64 N·s.
    let bits = -64 + 30 - exponent;
    let ([p1, p2, t], [[ka1, kb1], [ka2, kb2], [kat, kbt]]) =
        (rows, [group.arms[0][lane], group.arms[1][lane], group.arms[2][lane]]);
    let [bits_a, bits_b] = [bits - lengths[0], bits - lengths[1]];
    let magnitude = p1.unsigned_abs() | p2.unsigned_abs() | t.unsigned_abs();
    // Sums of three products below 2^30 · 2^31, within 62.6 bits, that are raised by less than 2^47.
    if magnitude >> 31 == 0 && bits.min(bits_a).min(bits_b) > -47 {
        let (nx, ny) = (i64::from(group.normal[lane][0]), i64::from(group.normal[lane][1]));
        let (x, y) = (raised(nx * (p1 + p2) + ny * t, bits), raised(ny * (p1 + p2) - nx * t, bits));
        let turn_a = raised(i64::from(ka1) * p1 + i64::from(ka2) * p2 + i64::from(kat) * t, bits_a);
        let turn_b = raised(i64::from(kb1) * p1 + i64::from(kb2) * p2 + i64::from(kbt) * t, bits_b);
        return [[-x, -y, -turn_a], [x, y, turn_b]];
    }
    on_bodies_far(group, lane, bits, rows, lengths)
}

/// value · 2^-bits to nearest, ties away from zero. *Domain* bits > −47.
#[inline(always)]
fn raised(value: i64, bits: i32) -> i128 {
    if bits > 0 {
        return shifted_word(value, bits).into();
    }
    // By less than 64 bits: without the cases of a shift of 128 bits.
    let up = bits.unsigned_abs() & 63;
    let high = (value >> 1) >> (63 - up);
    i128::from(high) << 64 | i128::from((value as u64) << up)
}

/// [`on_bodies`] for impulses of any size.
#[cold]
#[inline(never)]
fn on_bodies_far(group: &Group, lane: usize, bits: i32, rows: [i64; 3], lengths: [i32; 2]) -> [[i128; 3]; 2] {
    let [nx, ny] = group.normal[lane].map(i128::from);
    let [p1, p2, t] = rows.map(i128::from);
    let turn = |side: usize| {
        let [k1, k2, kt] = [0, 1, 2].map(|row| i128::from(group.arms[row][lane][side]));
        shifted_within(k1 * p1 + k2 * p2 + kt * t, bits - lengths[side])
    };
    let x = shifted_within(nx * (p1 + p2) + ny * t, bits);
    let y = shifted_within(ny * (p1 + p2) - nx * t, bits);
    [[-x, -y, -turn(0)], [x, y, turn(1)]]
}

/// Exact impulses and corrections of all bodies, once the impulses of joints are in the totals. No lanes: but instructions for shifts and
/// products that the CPU has beside them.
pub(super) struct Apply<'a> {
    pub(super) clock: &'a Clock,
    pub(super) bodies: &'a BodyRows,
    pub(super) groups: &'a ContactGroups,
    pub(super) rolls: &'a Rolls,
    pub(super) strikes: &'a [Strike],
    /// Paths by body; empty without joints.
    pub(super) paths: &'a [Path],
    pub(super) totals: &'a mut [Total],
    pub(super) flights: &'a [Flight],
    pub(super) contacts: &'a mut [Contact],
    pub(super) corrections: &'a mut Vec<Correction>,
}

impl Job for Apply<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { clock, bodies, groups, rolls, strikes, paths, totals, flights, contacts, corrections } = self;
        let ContactGroups { groups, places, .. } = groups;
        let BodyRows { bodies, .. } = bodies;
        if places.len() < contacts.len() {
            contacts.iter_mut().for_each(|contact| contact.impulses = Impulses::default());
        }
        for place in places {
            let contact = &mut contacts[place.contact as usize];
            let (group, lane) = (&groups[place.group as usize], place.lane as usize);
            let lane_of = |values: &[[i64; GROUP]; 3]| [values[0][lane], values[1][lane], values[2][lane]];
            contact.impulses = Impulses { values: lane_of(&group.impulses), exponent: place.exponent };
            let [a, b] = [contact.bodies[0] as usize, contact.bodies[1] as usize];
            let lengths = [bodies[a].length, bodies[b].length];
            let [applied_a, applied_b] = on_bodies(group, lane, place.exponent, lane_of(&group.applied), lengths);
            totals[a].add(false, applied_a);
            totals[b].add(false, applied_b);
            let [weighted_a, weighted_b] = on_bodies(group, lane, place.exponent, lane_of(&group.weighted), lengths);
            totals[a].add(true, weighted_a);
            totals[b].add(true, weighted_b);
        }
        for strike in strikes {
            let place = &places[strike.place as usize];
            let (group, lane) = (&groups[place.group as usize], place.lane as usize);
            let ends = contacts[place.contact as usize].bodies.map(|body| body as usize);
            let lengths = ends.map(|body| bodies[body].length);
            let changes = on_bodies(group, lane, place.exponent, strike.impulses, lengths);
            for (body, change) in ends.into_iter().zip(changes) {
                totals[body].add_struck(change);
            }
        }
        rolls.apply(groups, contacts, totals);
        corrections.clear();
        corrections.reserve(flights.len());
        // A loop: a closure would not be compiled for the instructions of the job.
        for (body, (flight, total)) in flights.iter().zip(&*totals).enumerate() {
            let path = *paths.get(body).unwrap_or(&Path::Contacts);
            let mut correction = Correction::default();
            if !total.is_zero() {
                correction = flight.correction(total, path, clock);
                correction.is_pushed = correction != Correction::default();
            }
            corrections.push(correction);
        }
    }
}

impl Flight {
    /// The change of a body by its impulses.
    #[inline(always)]
    fn correction(&self, total: &Total, path: Path, clock: &Clock) -> Correction {
        let ([x, y, turn], [wx, wy, wt]) = (total.impulse, total.weighted);
        let mass = self.inverse_mass;
        let inertia = self.inverse_inertia;
        let moved = |factor: FxFactor| factor.times(clock.substep);
        let moved_x = moved(mass.x);
        let moved_y = if mass.y == mass.x { moved_x } else { moved(mass.y) };
        let velocity = Vec2::new(changed(x, mass.x), changed(y, mass.y));
        let angular_velocity = changed(turn, inertia);
        let [ox, oy, turned] = match path {
            Path::Flight => [FxAccumulator::default(); 3],
            Path::Substeps => self.offsets(clock).map(offset_in_full),
            Path::Contacts => {
                let [sx, sy, st] = total.struck;
                self.cancelled([changed(x - sx, mass.x), changed(y - sy, mass.y), changed(turn - st, inertia)], clock)
            }
        };
        Correction {
            is_pushed: false,
            velocity,
            angular_velocity,
            displacement: Vec2::new(changed(wx, moved_x).plus(ox), changed(wy, moved_y).plus(oy)),
            rotation: changed(wt, moved(inertia)).plus(turned),
        }
    }

    /// The offsets o of semi-implicit Euler from the free flight, in 2^-32 m and rad.
    #[inline(always)]
    pub(super) fn offsets(&self, clock: &Clock) -> [i128; 3] {
        let Self { start, end, displacement, .. } = self;
        let offset =
            |start: Fx, end: Fx, flown: Fx| clock.euler(start.to_bits(), end.to_bits()) - i128::from(flown.to_bits());
        [
            offset(start.linear.x, end.linear.x, displacement.x),
            offset(start.linear.y, end.linear.y, displacement.y),
            offset(start.angular, end.angular, self.rotation),
        ]
    }

    /// The part of the offsets that impulses cancel, for the changes of velocity by them.
    #[inline(always)]
    fn cancelled(&self, change: [FxAccumulator; 3], clock: &Clock) -> [FxAccumulator; 3] {
        let flown = |start: Fx, end: Fx| i128::from(end.to_bits()) - i128::from(start.to_bits());
        let Self { start, end, .. } = self;
        let [ox, oy, turn] = self.offsets(clock);
        let [vx, vy, spin] = change.map(FxAccumulator::value);
        let flown_linear = [flown(start.linear.x, end.linear.x), flown(start.linear.y, end.linear.y)];
        let [x, y] = cancelled([vx, vy], flown_linear, [ox, oy]);
        let [turn] = cancelled([spin], [flown(start.angular, end.angular)], [turn]);
        [x, y, turn]
    }
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

/// value · 2^-bits within the largest impulse.
pub(super) fn shifted_within(value: i128, bits: i32) -> i128 {
    if bits < 0 && 128 - value.unsigned_abs().leading_zeros() as i32 - bits > 111 {
        return if value < 0 { -LARGEST } else { LARGEST };
    }
    shifted(value, bits).clamp(-LARGEST, LARGEST)
}
