//! The part of a collider in a box along the axes: its area, and the first moments of it about the centre of mass of the body.
//!
//! The boundary of an outline is walked counter-clockwise, cut where it crosses the lines of the box, and each of its points is moved to
//! the nearest point of the box. The area that the moved boundary encloses is that of the part in the box: on the way from a point to its
//! nearest one nothing inside the box is crossed, so that the boundary goes around each inner point as often as before. So neither the
//! order of the cuts nor that of the corners matters to the sums, which are exact, and no case is special: not a corner of the box in the
//! outline, not an edge along a side.
//!
//! Arcs are walked in chords between [`ARC`] fixed directions of the world, farther out by the factor that gives a whole disc its area.
//!
//! **Ranges.** Points are in units of 2^-32 m, or of a power of two of it where the collider reaches farther than 2^37 of them, 32 m. So a
//! component is below 1.02·2^37, a cross product of two points below 2^75.1, and its product with the sum of two components below 2^114.
//! An outline has at most 64 corners, each with two ends of an arc, and 32 points of arcs; each edge is cut at most 4 times. These are
//! fewer than 2^10 points, and sums stay below 2^124.

use crate::collider::Collider;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::query::{Point, cross, odd_shift};
use crate::scalar::{Angle, Factor, Scalar, Sum, Wide};
use crate::shape::{Aabb, Outline};

/// The directions from the centre of an arc to the ends of its chords.
const ARC: usize = 32;
/// √((2π/ARC) / sin(2π/ARC)), in units of 2^-32: so much farther out are the ends of chords than the arc.
const OUT: i128 = 4_308_806_026;
/// The directions, counter-clockwise, in units of 2^-62. Mirrored on an axis or a diagonal they are the same ones, exactly.
const DIRECTIONS: [Point; ARC] = {
    let mut directions = [[0; 2]; ARC];
    let mut k = 0;
    while k < ARC {
        let (sin, cos) = sin_cos_turn(k as u64 * (1 << 59));
        directions[k] = [cos, sin];
        k += 1;
    }
    directions
};
/// The largest component of a point, in units.
const REACH: u32 = 37;

/// The area of a part of a body's colliders, m², and its first moments about the centre of mass of the body, ∫x dA and ∫y dA, m³.
///
/// Sums over the outlines, which stand in no order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Submerged<S: Scalar> {
    pub(super) area: S::Sum,
    pub(super) moments: Vec2<S::Sum>,
}

/// The part of these colliders of a body in a box; `None` if there is none. Parts that lie on each other count twice, as they do for the
/// mass.
///
/// *Error* of the area 2^-32 m times the outline's length, from 32 m of reach on 2^-36 of its reach times that; where there are arcs of a
/// radius r besides 2^-10·r² an outline.
pub(super) fn submerged<'a, S: Scalar>(
    colliders: impl Iterator<Item = &'a Collider<S>>,
    position: Vec2<S>,
    angle: S::Angle,
    bounds: Aabb<S>,
) -> Option<Submerged<S>> {
    let bits = |value: S| i128::from(value.to_fx().to_bits());
    let position = [bits(position.x), bits(position.y)];
    let relative = |corner: Vec2<S>| [bits(corner.x) - position[0], bits(corner.y) - position[1]];
    let (low, high) = (relative(bounds.min), relative(bounds.max));
    let mut direction = None;
    let mut sum: Option<Submerged<S>> = None;
    for collider in colliders {
        let radius = bits(collider.radius);
        if (0..2).any(|k| low[k] >= radius || high[k] <= -radius) {
            continue;
        }
        let unit = (i128::BITS - radius.leading_zeros()).saturating_sub(REACH);
        // Sides out of reach are as good as beyond its end, where those of chords are.
        let end = radius + (radius >> 6) + 1;
        let in_units = |part: i128| if unit == 0 { part as i64 } else { odd_shift(part, unit) as i64 };
        let side = |side: [i128; 2]| side.map(|part| in_units(part.clamp(-end, end)));
        let direction = *direction.get_or_insert_with(|| (angle != S::Angle::default()).then(|| angle.direction()));
        let turned = |v: Vec2<S>| {
            // Corners are below 2^15 m, so that they fit wherever they are turned to.
            let turned = direction.and_then(|direction| S::Angle::turn(direction, v)?.try_map(Wide::to_scalar));
            let v = turned.unwrap_or(v);
            [v.x.to_fx().to_bits(), v.y.to_fx().to_bits()]
        };
        for part in 0..if collider.def.shape.is_chain() { 0 } else { collider.outline_count() } {
            let mut walk = Walk::new([side(low), side(high)]);
            let put = |point: [i128; 2]| walk.put(point.map(in_units));
            go_around(&collider.outline(part).outline, turned, put);
            let [area, x, y] = walk.finish();
            if area <= 0 {
                continue;
            }
            let sum = sum.get_or_insert_with(Default::default);
            let unit = unit as i32 - 32;
            // An outline is within 2^15 m: below 2^32 m² and 2^47 m³, which fit.
            sum.area.add(in_wide::<S>(area, 2, 2 * unit).unwrap_or_default());
            sum.moments.x.add(in_wide::<S>(x, 6, 3 * unit).unwrap_or_default());
            sum.moments.y.add(in_wide::<S>(y, 6, 3 * unit).unwrap_or_default());
        }
    }
    sum
}

/// value / divisor · 2^exponent. *Domain* of the exponent −96 to 0 in steps that two factors take.
fn in_wide<S: Scalar>(value: i128, divisor: u64, exponent: i32) -> Option<S::Wide> {
    let size = value.unsigned_abs();
    // The upper 63 bits, cut: 2^-62 relative.
    let cut = (u128::BITS - size.leading_zeros()).saturating_sub(63);
    let mut factor = S::Factor::from_ratio((size >> cut) as u64, divisor);
    let mut exponent = exponent + cut as i32;
    while exponent != 0 {
        let shift = exponent.clamp(-63, 63);
        let power = S::Factor::from_ratio(1 << shift.unsigned_abs(), 1);
        factor = if shift > 0 { factor.times(power) } else { factor.over(power) };
        exponent -= shift;
    }
    S::Wide::from_factor(factor, value < 0)
}

/// The boundary of an outline, counter-clockwise, in ulps; a point may come twice. A line has none.
fn go_around<S: Scalar>(outline: &Outline<S>, turned: impl Fn(Vec2<S>) -> Point, mut put: impl FnMut([i128; 2])) {
    let (corners, normals) = (outline.corners(), outline.normals());
    let radius = i128::from(outline.radius().to_fx().to_bits());
    let beside = |[x, y]: Point, [along, up]: Point, radius: i128, scale: u32| {
        // Below 2^45·2^62.
        let part = |start: i64, direction: i64| i128::from(start) + odd_shift(i128::from(direction) * radius, scale);
        [part(x, along), part(y, up)]
    };
    if radius == 0 {
        if corners.len() > 2 {
            corners.iter().for_each(|&corner| put(turned(corner).map(i128::from)));
        }
        return;
    }
    let farther = odd_shift(radius * OUT, 32);
    let Some(&last) = normals.last() else {
        let centre = turned(corners[0]);
        return DIRECTIONS.iter().for_each(|&direction| put(beside(centre, direction, farther, 62)));
    };
    let mut before = turned(last);
    // The first direction behind the last normal.
    let is_behind = |k: usize, normal: Point| cross(normal, DIRECTIONS[k % ARC]) > 0;
    let mut next = (1..=ARC).find(|&k| is_behind(k, before) && !is_behind(k - 1, before)).unwrap_or(0);
    for (&corner, &normal) in corners.iter().zip(normals) {
        let (corner, after) = (turned(corner), turned(normal));
        put(beside(corner, before, radius, 32));
        // An arc is half a turn long at most.
        while is_behind(next, before) && cross(DIRECTIONS[next % ARC], after) > 0 {
            put(beside(corner, DIRECTIONS[next % ARC], farther, 62));
            next += 1;
        }
        // One along the normal stands there already.
        if cross(DIRECTIONS[next % ARC], after) == 0 {
            next += 1;
        }
        put(beside(corner, after, radius, 32));
        before = after;
    }
}

/// A walk around a boundary, and the sums of the part in the box: twice the area, and six times the first moments.
struct Walk {
    low: Point,
    high: Point,
    /// The first point, and the last one so far.
    ends: Option<[Point; 2]>,
    /// The last point so far, moved into the box.
    inside: Point,
    sums: [i128; 3],
}

/// A line of the box that an edge crosses: the axis, where it is, and how far along the edge, as a fraction.
#[derive(Clone, Copy)]
struct Cut {
    axis: usize,
    line: i64,
    along: [u64; 2],
}

impl Cut {
    fn is_before(&self, other: &Self) -> bool {
        let product = |a: u64, b: u64| u128::from(a) * u128::from(b);
        product(self.along[0], other.along[1]) < product(other.along[0], self.along[1])
    }

    /// The point of the edge on the line, rounded to nearest, ties to even: that of the mirror image is its image, from either end.
    fn point(self, from: Point, to: Point) -> Point {
        let (along, across) = (self.axis, 1 - self.axis);
        let (run, rise) = (i128::from(to[along] - from[along]), i128::from(to[across] - from[across]));
        // Below 2^38·2^38 and 2^37·2^38.
        let value = i128::from(from[across]) * run + rise * i128::from(self.line - from[along]);
        let (value, run) = if run < 0 { (-value, -run) } else { (value, run) };
        let (floor, rest) = (value.div_euclid(run), value.rem_euclid(run));
        let is_up = 2 * rest > run || 2 * rest == run && floor & 1 == 1;
        let mut point = [self.line; 2];
        point[across] = (floor + i128::from(is_up)) as i64;
        point
    }
}

impl Walk {
    fn new([low, high]: [Point; 2]) -> Self {
        Self { low, high, ends: None, inside: [0; 2], sums: [0; 3] }
    }

    /// Goes on to a point.
    fn put(&mut self, to: Point) {
        let Some([first, from]) = self.ends else {
            (self.ends, self.inside) = (Some([to; 2]), self.in_box(to));
            return;
        };
        self.ends = Some([first, to]);
        let mut cuts: [Option<Cut>; 4] = [None; 4];
        let mut count = 0;
        for axis in 0..2 {
            let (a, b) = (from[axis], to[axis]);
            for line in [self.low[axis], self.high[axis]] {
                if (a < line && line < b) || (b < line && line < a) {
                    let cut = Cut { axis, line, along: [line.abs_diff(a), b.abs_diff(a)] };
                    // Two at the same place are the same point, a corner of the box.
                    let place = cuts[..count].iter().flatten().take_while(|earlier| earlier.is_before(&cut)).count();
                    cuts[place..=count].rotate_right(1);
                    cuts[place] = Some(cut);
                    count += 1;
                }
            }
        }
        cuts.into_iter().flatten().for_each(|cut| self.go_on(cut.point(from, to)));
        self.go_on(to);
    }

    fn in_box(&self, point: Point) -> Point {
        [0, 1].map(|k| point[k].max(self.low[k]).min(self.high[k]))
    }

    fn go_on(&mut self, to: Point) {
        let (from, to) = (self.inside, self.in_box(to));
        let cross = cross(from, to);
        self.sums[0] += cross;
        self.sums[1] += i128::from(from[0] + to[0]) * cross;
        self.sums[2] += i128::from(from[1] + to[1]) * cross;
        self.inside = to;
    }

    /// Goes back to the first point.
    fn finish(mut self) -> [i128; 3] {
        if let Some([first, _]) = self.ends {
            self.put(first);
        }
        self.sums
    }
}

#[cfg(test)]
mod tests;
