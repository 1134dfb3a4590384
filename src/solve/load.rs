//! The contacts of a group and their bodies, as they are loaded: as rows of four words, one lane after the other, whose columns are vectors.

use super::batch::{Batch, Words};
use super::bodies::{DOWN_BITS, DOWN_ZERO, MASS_BITS};
use super::group::{Group, IMPULSE, SEPARATION, SURFACE};
use super::unit::Scale;
use super::vectors::Shift;
use super::{Contact, Point};
use crate::kernel::simd::{GROUP, Lanes};

/// The [`Scale`] of the unit of an island, by lane. It stays from group to group, as most contacts have the same unit.
#[derive(Clone, Debug, Default)]
pub(super) struct LaneScales {
    unit: Words,
    before: Words,
    limit: Words,
    after: Words,
    impact_speed: Words,
}

impl Batch {
    /// Begins a step: all lanes have this scale.
    pub(super) fn begin(&mut self, scale: &Scale) {
        (0..GROUP).for_each(|lane| self.set_scale(lane, scale));
    }

    /// Returns true if a lane has the scale of this unit.
    #[inline(always)]
    pub(super) fn has_scale(&self, lane: usize, unit: i32) -> bool {
        self.scales.unit[lane] == i64::from(unit)
    }

    /// Writes the scale of a lane.
    #[inline(always)]
    pub(super) fn set_scale(&mut self, lane: usize, scale: &Scale) {
        let LaneScales { unit, before, limit, after, impact_speed } = &mut self.scales;
        unit[lane] = scale.unit.into();
        (before[lane], limit[lane], after[lane]) = (scale.before, scale.limit, scale.after);
        impact_speed[lane] = scale.impact_speed.into();
    }

    /// Writes the values of a contact into a lane.
    #[inline(always)]
    pub(super) fn load(&mut self, lane: usize, contact: &Contact) {
        let is_single = contact.count == 1;
        let [first, second] = &contact.points;
        // The first and the last point: the same one if there is only one.
        let last = if is_single { first } else { second };
        self.points[0][lane] = arms_of(first);
        self.points[1][lane] = arms_of(last);
        self.separation[0][lane] = first.separation.to_bits();
        self.separation[1][lane] = last.separation.to_bits();
        self.friction[lane] = contact.friction.to_bits();
        self.surface[lane] = contact.surface_speed.to_bits();
        let [first, second, tangent] = contact.impulses.values;
        self.impulses[lane] = [first, second, tangent, contact.impulses.exponent.into()];
        self.two[lane] = i64::from(is_single) - 1;
    }

    /// Loads the masses, in the larger unit of both bodies.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn load_masses<L: Lanes>(&mut self, lanes: L, at: usize) {
        let (a, b) = (lanes.columns(&self.masses[0], at), lanes.columns(&self.masses[1], at));
        let (measures_a, measures_b) = (lanes.floored::<32>(a[3]), lanes.floored::<32>(b[3]));
        let (exponent_a, exponent_b) = (lanes.floored::<DOWN_BITS>(measures_a), lanes.floored::<DOWN_BITS>(measures_b));
        let exponent = lanes.larger(exponent_a, exponent_b);
        self.align(lanes, at, 0, a, measures_a, exponent);
        self.align(lanes, at, 1, b, measures_b, exponent);
        let mass_unit = lanes.sub(lanes.all(MASS_BITS.into()), exponent);
        lanes.store(&mut self.exponent, at, lanes.add(lanes.wide(&self.scales.unit, at), mass_unit));
    }

    /// Stores the masses of a body in the unit of the contact.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn align<L: Lanes>(
        &mut self,
        lanes: L,
        at: usize,
        side: usize,
        [x, y, inertia, measures]: [L::Wide; 4],
        upper: L::Wide,
        exponent: L::Wide,
    ) {
        let body_exponent = lanes.floored::<DOWN_BITS>(upper);
        let base = lanes.raised_by(body_exponent, lanes.all(DOWN_BITS.into()));
        lanes.store(&mut self.down[side], at, lanes.sub(lanes.sub(upper, base), lanes.all(DOWN_ZERO)));
        lanes.store(&mut self.rim[side], at, lanes.sub(measures, lanes.raised_by(upper, lanes.all(32))));
        let bits = lanes.smaller(lanes.sub(exponent, body_exponent), lanes.all(62));
        if lanes.is_zero(bits) {
            lanes.store(&mut self.mass[side][0], at, x);
            lanes.store(&mut self.mass[side][1], at, y);
            lanes.store(&mut self.inertia[side], at, inertia);
            return;
        }
        // To nearest, ties upwards: masses have no sign.
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), bits));
        lanes.store(&mut self.mass[side][0], at, lanes.floored_by(lanes.add(x, half), bits));
        lanes.store(&mut self.mass[side][1], at, lanes.floored_by(lanes.add(y, half), bits));
        lanes.store(&mut self.inertia[side], at, lanes.floored_by(lanes.add(inertia, half), bits));
    }

    /// Writes separations, friction, the velocity of surfaces and the speed of the slowest impact.
    ///
    /// # Ranges
    /// Separations are within (2^29.5 · 2^after)/rate + 1, so that products with the rate are within 2^60.6. Changes of velocities are within
    /// 2^29: a sum of two products with normals is below 2^60.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn load_values<L: Lanes>(&self, lanes: L, group: &mut Group, at: usize, rate: i32) {
        let Self { separation: [first, last], friction, surface, change, scales, .. } = self;
        let first = scales.separation(lanes, at, lanes.wide(first, at), rate);
        let last = scales.separation(lanes, at, lanes.wide(last, at), rate);
        lanes.put_pair(&mut group.separation, at, (first, last));
        lanes.put_pair(&mut group.separation_now, at, (first, last));
        // From 2^-32 to 2^-26.
        let mu = lanes.positive(lanes.clamped(lanes.wide(friction, at), lanes.all(1 << 37)));
        let mu = lanes.capped(lanes.floored::<6>(lanes.add(mu, lanes.all(32))));
        lanes.put_pair(&mut group.friction, at, (lanes.splat(0), mu));
        let (normal, change) = (lanes.pair(&group.normal, at), lanes.pair(change, at));
        let along = lanes.add(lanes.times(normal.0, change.0), lanes.times(normal.1, change.1));
        // As in the passes, the largest speed is 2^28.
        let forced = lanes.smaller(lanes.floored::<29>(lanes.magnitude(along)), lanes.all(1 << 28));
        let impact_speed = lanes.low(lanes.larger(forced, lanes.wide(&scales.impact_speed, at)));
        let surface = lanes.wide(surface, at);
        let mut speed = lanes.splat(0);
        if !lanes.is_zero(surface) {
            let bits = lanes.add(lanes.wide(&scales.unit, at), lanes.all(32));
            let shift = Shift::<L>::new::<false>(lanes, lanes.smaller(lanes.positive(bits), lanes.all(62)));
            let surface = lanes.clamped(surface, lanes.all(1 << 61));
            speed = lanes.low(lanes.clamped(shift.rounded::<false>(lanes, surface), lanes.all(SURFACE)));
        }
        lanes.put_pair(&mut group.surface, at, (speed, impact_speed));
    }

    /// Writes the impulses that the step begins with, and log2 of their unit.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn start<L: Lanes>(&mut self, lanes: L, group: &mut Group, at: usize) {
        // The unit of masses · 2^-exponent is 2^-(bits + 2).
        let bits = lanes.add(lanes.wide(&self.bits, at), lanes.all(2));
        let exponent = lanes.sub(lanes.wide(&self.exponent, at), bits);
        lanes.store(&mut self.exponent, at, exponent);
        // Normals and arms are in 2^-30. Empty lanes have no impulses, in any unit.
        let is_filled = lanes.sub(lanes.all(0), lanes.wide(&self.whole[0], at));
        let raise = lanes.if_negative(is_filled, lanes.add(exponent, lanes.all(64 - 30)), lanes.all(0));
        lanes.store(&mut group.raise, at, raise);
        let [first, second, tangent, unit] = lanes.columns(&self.impulses, at);
        // Impulses are within 2^62, and the limit has no more than 44 bits.
        let down = lanes.clamped(lanes.sub(exponent, unit), lanes.all(62));
        let up = lanes.smaller(lanes.positive(lanes.sub(lanes.all(0), down)), lanes.all(44));
        let shift = Shift::<L>::new::<true>(lanes, lanes.sub(lanes.positive(down), up));
        let limit = lanes.all(IMPULSE);
        let widest = lanes.if_negative(down, lanes.floored_by(limit, up), lanes.all(1 << 62));
        let mut scaled = [first, second, tangent];
        for impulse in &mut scaled {
            let cut = lanes.clamped(*impulse, widest);
            *impulse = lanes.clamped(shift.rounded::<true>(lanes, cut), limit);
        }
        lanes.store(&mut group.impulses[0], at, lanes.positive(scaled[0]));
        // A second point may be missing.
        let second = lanes.if_negative(lanes.wide(&self.two, at), lanes.positive(scaled[1]), lanes.all(0));
        lanes.store(&mut group.impulses[1], at, second);
        // Friction has either sign.
        lanes.store(&mut group.impulses[2], at, scaled[2]);
    }
}

impl LaneScales {
    /// A separation in 2^-32 m in units of velocity times a sub-step, within ±[`SEPARATION`]; to nearest, ties upwards.
    #[inline(always)]
    fn separation<L: Lanes>(&self, lanes: L, at: usize, metres: L::Wide, rate: i32) -> L::Narrow {
        let (before, after) = (lanes.wide(&self.before, at), lanes.wide(&self.after, at));
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), before));
        let short = lanes.floored_by(lanes.add(metres, half), before);
        let short = lanes.low(lanes.clamped(short, lanes.wide(&self.limit, at)));
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), after));
        let units = lanes.floored_by(lanes.add(lanes.times(short, lanes.splat(rate)), half), after);
        lanes.low(lanes.clamped(units, lanes.all(SEPARATION)))
    }
}

/// The arms (x, y) of the first and of the second body.
#[inline(always)]
fn arms_of(point: &Point) -> [i64; 4] {
    let [a, b] = &point.arms;
    [a.x.to_bits(), a.y.to_bits(), b.x.to_bits(), b.y.to_bits()]
}
