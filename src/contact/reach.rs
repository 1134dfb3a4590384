//! The distance that two bodies close in a step, and the boxes of outlines over a step.

use super::MARGIN;
use crate::collide::sweep::passes_beyond;
use crate::collide::{Margin, Pose};
use crate::collider::BodyOutline;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::shape::Aabb;
use crate::solve::Flight;

/// The distance that a point of an outline moves by the rotation of its body, in ulps, rounded up: at most twice its radius.
fn turned(flight: &Flight, radius: Fx) -> i64 {
    let radius = u128::from(radius.to_bits().unsigned_abs());
    let product = u128::from(flight.rotation.to_bits().unsigned_abs()) * radius;
    // Radii are below 2^15 m.
    ((product >> 32) + u128::from(product != 0)).min(2 * radius) as i64
}

/// The largest distance, in ulps, of two outlines that touch without closing a distance: an ulp is for the rounding of ways.
pub(super) const CLOSE: i64 = MARGIN.to_bits() + 1;

/// The motion of an outline over a step, in ulps: the displacement of its body, and a bound of the way that the rotation adds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) displacement: [i64; 2],
    pub(super) turned: i64,
}

impl Reach {
    /// The motion of an outline of this radius.
    pub(super) fn new(flight: &Flight, radius: Fx) -> Self {
        let displacement = [flight.displacement.x.to_bits(), flight.displacement.y.to_bits()];
        Self { displacement, turned: turned(flight, radius) }
    }

    /// The way against each other by the displacements. Displacements are below 2^29 m.
    #[inline(always)]
    fn way_to(&self, reach: &Self) -> [i64; 2] {
        [reach.displacement[0] - self.displacement[0], reach.displacement[1] - self.displacement[1]]
    }

    /// Returns true if two outlines within these distances, in all, of the centres of their bodies stay apart on their free flights from
    /// these centres at the start: then [`Leg::stays_apart`](crate::collide::sweep::Leg::stays_apart) says so as well.
    ///
    /// # Ranges
    /// Centres are within 2^29 m, displacements below that: offsets and ways are below 2^62. Components are brought to 30 bits.
    ///
    /// # Precision
    /// Displacements are within 2 ulps of the ways of legs. Let a unit be 2^k ulps. Cutting the offset and the way off, each by less than √2
    /// units, changes distances on the path by less than 2.83 units, and the ulps add less than 6. So a distance beyond the radii by 32 units
    /// here is beyond them by 29 units of ulps, less 7 ulps, on the path, of which the leg asks for 6.83 of its own units. These are at most
    /// twice as large.
    #[inline(always)]
    pub(super) fn stays_apart(&self, reach: &Self, [a, b]: [[i64; 2]; 2], radii: i64) -> bool {
        const FAR: u64 = 1 << 61;
        if a.iter().chain(&b).any(|part| part.unsigned_abs() >= FAR) {
            return false;
        }
        let (offset, way) = ([b[0] - a[0], b[1] - a[1]], self.way_to(reach));
        let sizes = offset.iter().chain(&way).map(|part| part.unsigned_abs());
        let down = (64 - sizes.fold(0, |all, size| all | size).leading_zeros()).saturating_sub(30);
        let scaled = |part: i64| (part.unsigned_abs() >> down) as i64 * part.signum();
        passes_beyond(offset.map(scaled), way.map(scaled), (radii >> down) + 32)
    }

    /// The largest distance of two outlines that may touch in the step: the margin and the distance that they close.
    #[inline(always)]
    pub(super) fn closing(&self, reach: &Self) -> Margin {
        Margin::new(Fx::from_bits(CLOSE + self.turned + reach.turned), self.way_to(reach))
    }

    /// The box around an outline over the step, from the box around it at the moment of manifolds, grown by half the margin: two outlines that
    /// may come within the margin of each other have boxes that overlap.
    pub(super) fn swept(&self, bounds: Aabb) -> Aabb {
        let [x, y] = self.displacement.map(i64::abs);
        // The largest distance that a point moves: for two together at least the distance that they close. a + b/2 is at least the length of
        // (a, b) for a ≥ b, and at most an eighth more.
        grown(bounds, x.max(y) + x.min(y) / 2 + 1 + self.turned)
    }

    /// A bound of the distance by which two outlines approach in the step, in ulps.
    #[inline(always)]
    pub(super) fn approach_bound(&self, reach: &Self) -> i64 {
        let [x, y] = self.way_to(reach).map(i64::abs);
        x.max(y) + x.min(y) / 2 + self.turned + reach.turned
    }
}

/// The box around an outline of a body that does not move, grown by half the margin.
pub(super) fn resting(outline: &BodyOutline, pose: &Pose) -> Aabb {
    grown(pose.outline_bounds(outline), 0)
}

/// A box grown on all sides by a distance in ulps and by half the margin.
fn grown(Aabb { min, max }: Aabb, distance: i64) -> Aabb {
    let growth = distance + MARGIN.to_bits() / 2 + 1;
    let moved = |corner: Vec2, way: i64| corner.map(|part| Fx::from_bits(part.to_bits().saturating_add(way)));
    Aabb { min: moved(min, -growth), max: moved(max, growth) }
}

#[cfg(test)]
mod tests {
    use core::slice::from_ref;

    use super::*;
    use crate::cases::{run_seed, times};
    use crate::collide::sweep::{Form, Leg, Moment, Second, Sweep};
    use crate::contact::bodies;
    use crate::fx;
    use crate::math::{Random, vec2};
    use crate::scalar::Turn;
    use crate::shape::{Outline, Shape};

    /// A value of up to so many bits, of either sign.
    fn signed(random: &mut Random, bits: u32) -> i64 {
        random.bits() as i64 >> (63 - bits)
    }

    fn vector(random: &mut Random, bits: u32) -> [i64; 2] {
        [0, 1].map(|_| signed(random, bits))
    }

    /// Discs, boxes, bars and triangles on free flights of all sizes, which pass each other near and far, from rest up to whole turns in a step.
    #[test]
    fn outlines_that_are_told_to_stay_apart_do_not_touch_on_their_paths() {
        let mut random = Random::seeded(run_seed(41));
        let triangle = Shape::polygon(&[vec2(-1, -1), vec2(2, 0), vec2(0, 1)]);
        let shapes = [Shape::circle(fx!(0.5)), Shape::rectangle(1, 1), Shape::rectangle(40, 1), triangle];
        let shapes = shapes.map(|shape| shape.expect("a shape"));
        let outlines = shapes.each_ref().map(|shape| shape.outlines().first().expect("an outline"));
        let mut moment = Moment::default();
        let (mut apart, mut touches) = (0, 0);
        for case in 0..times(20_000) {
            // Offsets from below a metre to the ends of the world.
            let bits = 31 + random.bits() as u32 % if case % 2 == 0 { 6 } else { 30 };
            let pair: [&Outline; 2] = [0, 1].map(|_| outlines[random.bits() as usize % outlines.len()]);
            let centres = [0, 1].map(|_| vector(&mut random, bits));
            let ways = [0, 1].map(|_| vector(&mut random, bits.min(60)));
            let spins = [0, 1].map(|_| signed(&mut random, 34));
            let reaches = [0, 1].map(|side: usize| {
                let [x, y] = ways[side].map(Fx::from_bits);
                let (displacement, rotation) = (Vec2::new(x, y), Fx::from_bits(spins[side]));
                Reach::new(&Flight { displacement, rotation, ..bodies::resting(Vec2::ZERO) }, pair[side].reach())
            });
            let radii = pair[0].reach().to_bits() + pair[1].reach().to_bits();
            let is_apart = reaches[0].stays_apart(&reaches[1], centres, radii);
            // Rounding changes the way of a leg by up to two ulps.
            let legs = [0, 1].map(|side: usize| {
                let way = ways[side].map(|part| i128::from(part + signed(&mut random, 1)));
                let angle = Turn::from_bits(random.bits());
                Leg::new(centres[side], way, angle, i128::from(spins[side]) << 30)
            });
            let forms = pair.map(|outline| Form::new(outline, outline.width(), false));
            let paths = [from_ref(&legs[0]), from_ref(&legs[1])];
            let sweep = Sweep { forms: [&forms[0], &forms[1]], paths, second: Second::GivesWay };
            if is_apart {
                apart += 1;
                assert!(legs[0].stays_apart(&legs[1], radii), "{legs:?}");
                assert_eq!(sweep.first_touch(&mut moment), None, "{legs:?}");
            } else {
                touches += usize::from(sweep.first_touch(&mut moment).is_some());
            }
        }
        assert!(apart > 0 && touches > 0, "{apart} {touches}");
    }
}
