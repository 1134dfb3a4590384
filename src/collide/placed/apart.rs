//! Outlines that stay apart over a step, told by a few products: a bound in front of the sweep, which finds nothing for most pairs.
//!
//! Along a normal of one of the outlines, the one that faces the other best at the start, the gap between the placed outlines shrinks by the
//! way of the bodies against each other and by the turns from the placed poses to all other poses of the step. A gap that is left then is
//! there all the time.
//!
//! The [sweep](crate::collide::sweep) answers as well that such outlines do not meet. It measures at least the gap that is left, in each of
//! its steps, and passes the time in which corners might close it at their fastest: with a gap of 1/64 of the longest way of corners against
//! each other, it is at the end of the tick after 65 of its 96 steps at most, and it stops before only where the gap is gone.
//!
//! # Ranges
//! Lengths are cut off to units of 2^10 ulps. Offsets, ways, corners and radii are below 2^30 units, normals below 2^30 + 2: products with
//! an offset or a way are below 2^60.6, with a corner below 2^60.1, and the sum of two of each below 2^62.4. Turns are below a radian, so that
//! their products with distances from the centre are below 2^62.
//!
//! # Precision
//! Cutting off changes each of the vectors by less than √2 units, a rounded normal changes lengths up to 2^31 units by less than 4, poses
//! differ by less than a unit from the poses of the sweep, whose tolerances are below 2^15 ulps: [`SLACK`] is more than all of these.

use super::{Cores, IN_LINE};
use crate::kernel::simd::Line;

/// The unit of lengths here, 2^10 ulps.
const UNIT: u32 = 10;

/// The end of the range of lengths, units: 256 m.
const FAR: i64 = 1 << 30;

/// Gaps count as less by this, units: 60 µm.
const SLACK: i64 = 256;

/// A radian, 2^-32 rad.
const RADIAN: i64 = 1 << 32;

/// The motion of an outline over a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedMotion {
    /// The centre of mass at the start, ulps.
    pub(crate) centre: [i64; 2],
    /// The displacement in the step, ulps.
    pub(crate) way: [i64; 2],
    /// The rotations from the start to the end and to the pose at which the outline is placed, 2^-32 rad.
    pub(crate) rotation: i64,
    pub(crate) placed_rotation: i64,
    /// The largest distance of a point of the outline from the centre of mass, ulps.
    pub(crate) extent: i64,
}

impl PlacedMotion {
    /// Bounds of the ways of corners by turns, units: from the placed pose to any other, and in the step. None from a radian on.
    #[inline(always)]
    fn turns(&self, radius: i64) -> Option<[i64; 2]> {
        let rest = self.rotation.saturating_sub(self.placed_rotation);
        let farthest = self.placed_rotation.saturating_abs().max(rest.saturating_abs());
        let all = self.rotation.saturating_abs();
        let reach = ((self.extent - radius) >> UNIT) + 1;
        (farthest < RADIAN && all < RADIAN).then(|| [farthest, all].map(|angle| ((angle * reach) >> 32) + 1))
    }
}

#[inline(always)]
fn dot(n: [i64; 2], p: [i64; 2]) -> i64 {
    n[0] * p[0] + n[1] * p[1]
}

#[inline(always)]
fn units(vector: [i64; 2]) -> [i64; 2] {
    vector.map(|part| part >> UNIT)
}

/// A normal of an outline, 2^-30, and the component of the outline's corners along it, in 2^-30 units.
struct Side {
    normal: [i64; 2],
    height: i64,
}

impl Cores {
    /// Returns true if two outlines surely do not touch on these motions, from a bound that misses some: then the sweep says so as well.
    #[inline]
    pub(crate) fn stay_apart(&self, cores: [usize; 2], motions: &[PlacedMotion; 2]) -> bool {
        let [a, b] = motions;
        let difference =
            |to: [i64; 2], from: [i64; 2]| units([to[0].saturating_sub(from[0]), to[1].saturating_sub(from[1])]);
        let (offset, way) = (difference(b.centre, a.centre), difference(b.way, a.way));
        let extents = [a.extent >> UNIT, b.extent >> UNIT];
        if offset.iter().chain(&way).chain(&extents).any(|length| length.abs() >= FAR) {
            return false;
        }
        let radii = cores.map(|core| self.placed[core].0.radius);
        let (Some(turns_a), Some(turns_b)) = (a.turns(radii[0]), b.turns(radii[1])) else { return false };
        let (x, y) = (way[0].abs(), way[1].abs());
        // a + b/2 is at least the length of (a, b) for a ≥ b.
        let longest = x.max(y) + x.min(y) / 2 + turns_a[1] + turns_b[1];
        let needed = (((radii[0] + radii[1]) >> UNIT) + turns_a[0] + turns_b[0] + longest / 64 + SLACK) << 30;
        let (back, back_way) = (offset.map(|part| -part), way.map(|part| -part));
        self.gap(cores, offset, way) > needed || self.gap([cores[1], cores[0]], back, back_way) > needed
    }

    /// The least gap between the corners of two outlines along a normal of the first one, in 2^-30 units, for the offset at the start and the
    /// way of the second one against the first one; below zero if the first one has no normals.
    #[inline(always)]
    fn gap(&self, [core, other]: [usize; 2], offset: [i64; 2], way: [i64; 2]) -> i64 {
        let Some(Side { normal, height }) = self.facing(core, offset) else { return -1 };
        dot(normal, offset) + dot(normal, way).min(0) + self.lowest(other, normal) - height
    }

    /// The side of an outline that faces a point at an offset from its centre; none if it has no normals.
    #[inline(always)]
    fn facing(&self, core: usize, offset: [i64; 2]) -> Option<Side> {
        let (placed, start, _) = &self.placed[core];
        if *start != IN_LINE {
            let corners = &self.corners[*start..][..placed.count];
            let sides = self.normals[*start..].iter().zip(corners).map(|(normal, &corner)| {
                let normal = normal.map(i64::from);
                Side { normal, height: dot(normal, units(corner)) }
            });
            return sides.max_by_key(|side| dot(side.normal, offset) - side.height);
        }
        if placed.count == 1 {
            return None;
        }
        // The second corner is on the sides of both normals.
        let Line([_, _, x, y, nx, ny, ..]) = self.lines[core];
        let (corner, first, second) = (units([x, y]), [nx, ny], [-ny, nx]);
        let heights = [dot(first, corner), dot(second, corner)];
        let along = [dot(first, offset), dot(second, offset)];
        let is_first = along[0].abs() - heights[0] > along[1].abs() - heights[1];
        let (normal, height, along) =
            if is_first { (first, heights[0], along[0]) } else { (second, heights[1], along[1]) };
        Some(Side { normal: if along < 0 { normal.map(|part| -part) } else { normal }, height })
    }

    /// The least component of an outline's corners along a normal, in 2^-30 units.
    #[inline(always)]
    fn lowest(&self, core: usize, normal: [i64; 2]) -> i64 {
        let (placed, start, _) = &self.placed[core];
        if *start != IN_LINE {
            let corners = &self.corners[*start..][..placed.count];
            return corners.iter().map(|&corner| dot(normal, units(corner))).min().unwrap_or(0);
        }
        let Line([x1, y1, x2, y2, ..]) = self.lines[core];
        let first = dot(normal, units([x1, y1]));
        if placed.count == 1 { first } else { -first.abs().max(dot(normal, units([x2, y2])).abs()) }
    }
}

#[cfg(test)]
mod tests {
    use core::slice::from_ref;

    use super::*;
    use crate::cases::{run_seed, times};
    use crate::collide::Pose;
    use crate::collide::sweep::{Form, Leg, Moment, Second, Sweep};
    use crate::fx;
    use crate::fx::Fx;
    use crate::math::{Random, Vec2, vec2};
    use crate::scalar::{Angle as _, FxAccumulator, Turn};
    use crate::shape::Shape;

    fn vector(random: &mut Random, bits: u32) -> [i64; 2] {
        [0, 1].map(|_| random.bits() as i64 >> (63 - bits))
    }

    /// A pair on random flights, near each other, and placed at some part of its rotations.
    fn motions(random: &mut Random, extents: [i64; 2]) -> [PlacedMotion; 2] {
        // Ways from millimetres to metres, and turns from thousandths of a radian to more than a radian.
        let (way_bits, turn_bits) = (24 + random.bits() as u32 % 11, 22 + random.bits() as u32 % 12);
        let bits = 32 + random.bits() as u32 % 3;
        extents.map(|extent| {
            let rotation = vector(random, turn_bits)[0];
            let placed_rotation = rotation / 8 * (random.bits() as i64 & 7) + vector(random, turn_bits - 4)[0];
            PlacedMotion {
                centre: vector(random, bits),
                way: vector(random, way_bits),
                rotation,
                placed_rotation,
                extent,
            }
        })
    }

    /// Discs, boxes, bars and polygons that pass each other near and far, from slow ones to a radian and metres in a step.
    #[test]
    fn the_sweep_finds_nothing_where_placed_outlines_stay_apart() {
        let mut random = Random::seeded(run_seed(47));
        let triangle = Shape::polygon(&[vec2(-1, -1), vec2(2, 0), vec2(0, 1)]);
        let capsule = Shape::capsule(2, fx!(0.25));
        let shapes =
            [Shape::circle(fx!(0.5)), Shape::rectangle(1, 1), Shape::rectangle(20, fx!(0.5)), triangle, capsule];
        let shapes = shapes.map(|shape| shape.expect("a shape"));
        let outlines = shapes.each_ref().map(|shape| shape.outlines().first().expect("an outline"));
        let mut moment = Moment::default();
        let (mut apart, mut close, mut touches) = (0, 0, 0);
        for _ in 0..times(20_000) {
            let pair = [0, 1].map(|_| outlines[random.bits() as usize % outlines.len()]);
            let motions = motions(&mut random, pair.map(|outline| outline.reach().to_bits()));
            let angles = [0, 1].map(|_| Turn::from_bits(random.bits()));
            let turned =
                |side: usize, rotation: i64| angles[side].turned(FxAccumulator::from_scalar(Fx::from_bits(rotation)));
            let mut cores = Cores::default();
            for side in 0..2 {
                let [x, y] = motions[side].centre.map(Fx::from_bits);
                cores.push(pair[side], &Pose::new(Vec2::new(x, y), turned(side, motions[side].placed_rotation)));
            }
            // Rounding changes the way of a leg by up to two ulps.
            let legs = [0, 1].map(|side: usize| {
                let way = motions[side].way.map(|part| i128::from(part + vector(&mut random, 1)[0]));
                let spin = turned(side, motions[side].rotation).to_bits().wrapping_sub(angles[side].to_bits()) as i64;
                Leg::new(motions[side].centre, way, angles[side], spin.into())
            });
            let forms = pair.map(|outline| Form::new(outline, outline.width(), false));
            let paths = [from_ref(&legs[0]), from_ref(&legs[1])];
            let sweep = Sweep { forms: [&forms[0], &forms[1]], paths, second: Second::GivesWay };
            let touch = sweep.first_touch(&mut moment);
            if cores.stay_apart([0, 1], &motions) {
                apart += 1;
                let reach = motions[0].extent + motions[1].extent;
                close += usize::from(!legs[0].stays_apart(&legs[1], reach));
                assert_eq!(touch, None, "{motions:?}");
            } else {
                touches += usize::from(touch.is_some());
            }
        }
        assert!(close > 0 && touches > 0, "{apart} {close} {touches}");
    }
}
