//! Two outlines at a moment of their paths: how far apart they are, and for how long they surely stay so.

mod measure;
mod time;

use self::measure::Known;
use super::form::{Form, PlacedForm, height, square};
use super::path::{self, END, Leg};
use crate::kernel::sqrt::direction;
use crate::scalar::Turn;

/// The most that rounding adds to a distance, ulps: of corners, of centres and their angles, and of the parts of a bound.
pub(super) const ROUNDING: i64 = 16;

/// 2π in 2^-32, rounded up.
pub(super) const TAU: u128 = 26_986_075_410;

/// The shortest step: 2^-40 of a tick.
pub(super) const SHORTEST: u64 = END >> 40;

/// Two outlines where they are at a moment.
#[derive(Clone, Debug)]
pub(super) struct Places {
    pub(super) placed: [PlacedForm; 2],
    /// From the centre of the first outline to the centre of the second one.
    pub(super) offset: [i128; 2],
    radius: i64,
    /// The outer side of a segment of a chain that meets a segment: it has no other side to be told by, and directions to its inner side do not
    /// count.
    front: Option<[i32; 2]>,
}

/// Two outlines at a moment. Sweeps use its memory again.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(super) places: Places,
    legs: [Leg; 2],
    at: u64,
    /// The moment at which a piece of either path ends.
    pub(super) until: u64,
    /// A direction across the way that they go against each other, if they do not go together.
    across: Option<[i32; 2]>,
    /// The distances of another moment until [`measure`](Self::measure).
    widest: Widest,
    is_measured: bool,
    known: Known,
}

impl Default for Moment {
    fn default() -> Self {
        let leg = Leg::new([0; 2], [0; 2], Turn::default(), 0);
        Self {
            places: Places { placed: [PlacedForm::NONE; 2], offset: [0; 2], radius: 0, front: None },
            legs: [leg; 2],
            at: 0,
            until: 0,
            across: None,
            widest: Widest::NONE,
            is_measured: false,
            known: Known::default(),
        }
    }
}

/// The most directions of the largest distance that are kept: faces that lie on each other have four.
const KEPT: usize = 8;

/// The largest distance along a direction that counts.
#[derive(Clone, Copy, Debug)]
struct Widest {
    /// `None` if no direction counts.
    distance: Option<i128>,
    /// The number of directions that have it, and the first ones of these.
    count: usize,
    gaps: [Gap; KEPT],
}

impl Widest {
    const NONE: Self =
        Self { distance: None, count: 0, gaps: [Gap { n: [0; 2], support_a: 0, support_b: 0, distance: 0 }; KEPT] };

    fn add(&mut self, gap: &Gap) {
        if Some(gap.distance) > self.distance {
            (self.distance, self.count) = (Some(gap.distance), 0);
        }
        if Some(gap.distance) == self.distance {
            if let Some(place) = self.gaps.get_mut(self.count) {
                *place = *gap;
            }
            self.count += 1;
        }
    }
}

/// The distance along a direction, ulps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) n: [i32; 2],
    /// The largest component of a corner of the first one, and the least of the second one, relative to their centres.
    support_a: i64,
    support_b: i64,
    /// The distance of the surfaces, rounded down.
    distance: i128,
}

/// The vector from a corner of the first outline to a corner of the second one.
#[inline(always)]
fn between(offset: [i64; 2], a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [offset[0] + b[0] - a[0], offset[1] + b[1] - a[1]]
}

/// A bound of the length of a vector: for its sides a ≥ b the square of a + b/2 is at least the square of the length. It is less than the
/// length by rounding alone.
fn length([x, y]: [i128; 2]) -> i128 {
    x.abs().max(y.abs()) + x.abs().min(y.abs()) / 2
}

/// The product of two words.
fn product(a: u64, b: u64) -> u128 {
    u128::from(a) * u128::from(b)
}

/// n·p in units of p, rounded down. *Domain* |p| < 2^72: products are below 2^103.
pub(super) fn along(n: [i32; 2], p: [i128; 2]) -> i128 {
    (i128::from(n[0]) * p[0] + i128::from(n[1]) * p[1]) >> 30
}

/// The unit vector along a vector of any size, 2^-30.
fn unit([x, y]: [i128; 2]) -> Option<[i32; 2]> {
    if (x, y) == (0, 0) {
        return None;
    }
    let bits = 128 - (x.unsigned_abs() | y.unsigned_abs()).leading_zeros();
    // The magnitudes are cut off, so that it is odd.
    let cut = |v: i128| {
        let size = (v.unsigned_abs() >> bits.saturating_sub(62)) as i64;
        if v < 0 { -size } else { size }
    };
    Some(direction(cut(x), cut(y)).0)
}

impl Moment {
    /// Brings two outlines on the pieces of their paths to a moment.
    pub(super) fn set(&mut self, forms: [&Form<'_>; 2], paths: [&[Leg]; 2], at: u64) {
        let [(a, until_a), (b, until_b)] = paths.map(|legs| path::leg(legs, at));
        self.places.placed[0].set(forms[0], a, at);
        self.places.placed[1].set(forms[1], b, at);
        self.legs = [*a, *b];
        self.places.radius = forms[0].radius + forms[1].radius;
        (self.at, self.until) = (at, until_a.min(until_b));
        self.across = unit([0, 1].map(|k| b.way[k] - a.way[k])).map(|[x, y]| [-y, x]);
        self.known.clear();
        self.complete(forms);
    }

    /// Brings the outlines that were [set](Self::set) to a later moment of their paths.
    pub(super) fn advance(&mut self, forms: [&Form<'_>; 2], paths: [&[Leg]; 2], at: u64) {
        if at >= self.until {
            self.set(forms, paths, at);
            return;
        }
        self.at = at;
        for ((placed, form), leg) in self.places.placed.iter_mut().zip(forms).zip(&self.legs) {
            placed.advance(form, leg, at);
        }
        self.complete(forms);
    }

    /// Completes the values that follow from the places of the outlines.
    fn complete(&mut self, forms: [&Form<'_>; 2]) {
        self.places.complete(forms);
        self.is_measured = false;
    }
}

impl Places {
    /// Completes the values that follow from the places of the outlines.
    fn complete(&mut self, forms: [&Form<'_>; 2]) {
        let [from, to] = [self.placed[0].centre, self.placed[1].centre];
        self.offset = [0, 1].map(|k| i128::from(to[k]) - i128::from(from[k]));
        self.front = match (forms[0].is_link, forms[1].is_link) {
            (true, _) if forms[1].width == 0 => Some(self.placed[0].normals()[0]),
            (_, true) if forms[0].width == 0 => Some(self.placed[1].normals()[0].map(|part| -part)),
            _ => None,
        };
    }

    /// Returns true if a direction counts.
    fn is_allowed(&self, n: [i32; 2]) -> bool {
        self.front.is_none_or(|front| height(n, front.map(i64::from)) >= 0)
    }

    /// The distances along a direction and along its opposite.
    #[inline(always)]
    fn gaps(&self, n: [i32; 2]) -> [Gap; 2] {
        let [lowest_a, highest_a] = self.placed[0].heights(n);
        let [lowest_b, highest_b] = self.placed[1].heights(n);
        // Below 2^72 · 2^30 · 2.
        let offset = i128::from(n[0]) * self.offset[0] + i128::from(n[1]) * self.offset[1];
        let gap = |n: [i32; 2], offset: i128, highest: i128, lowest: i128| {
            // Rounded outwards.
            let (support_a, support_b) = (-((-highest) >> 30) as i64, (lowest >> 30) as i64);
            let between = (offset >> 30) + i128::from(support_b) - i128::from(support_a);
            Gap { n, support_a, support_b, distance: between - i128::from(self.radius) }
        };
        [gap(n, offset, highest_a, lowest_b), gap(n.map(|part| -part), -offset, -lowest_a, -highest_b)]
    }

    /// Visits the distances along the directions that may separate best: of all edges, and between the corners that are nearest to each other.
    #[cold]
    fn each_gap(&self, mut visit: impl FnMut(&Gap)) {
        for side in 0..2 {
            let placed = &self.placed[side];
            for &n in placed.distinct_normals() {
                let gaps = self.gaps(if side == 0 { n } else { n.map(|part| -part) });
                visit(&gaps[0]);
                if placed.is_symmetric {
                    visit(&gaps[1]);
                }
            }
        }
        let offset = self.near_offset();
        let [a, b] = [0, 1].map(|side: usize| self.placed[side].corners());
        let squares = a.iter().flat_map(|&a| b.iter().map(move |&b| square(between(offset, a, b))));
        self.each_nearest(squares.min().unwrap_or(0), |d| {
            if let Some(gap) = self.gap_along(d) {
                visit(&gap);
            }
        });
    }

    /// The offset, cut to words, which changes it only for outlines that are never near; corners are below 2^50.
    #[inline(always)]
    fn near_offset(&self) -> [i64; 2] {
        self.offset.map(|part| part.clamp(-(1 << 62), 1 << 62) as i64)
    }

    /// Visits the vectors between two corners whose square is this one.
    fn each_nearest(&self, nearest: u128, visit: impl FnMut([i64; 2])) {
        let offset = self.near_offset();
        let [a, b] = [0, 1].map(|side: usize| self.placed[side].corners());
        let all = a.iter().flat_map(|&a| b.iter().map(move |&b| between(offset, a, b)));
        all.filter(|&d| square(d) == nearest).for_each(visit);
    }

    /// The distance along a vector, if it has a direction that counts.
    #[inline(always)]
    fn gap_along(&self, d: [i64; 2]) -> Option<Gap> {
        let [gap, _] = self.gaps(unit(d.map(i128::from))?);
        self.is_allowed(gap.n).then_some(gap)
    }
}

impl Moment {
    /// Visits the directions of the largest distance, all that tie. *Domain* a moment that was [measured](Self::measure).
    pub(super) fn each_widest(&self, mut visit: impl FnMut(&Gap)) {
        let widest = &self.widest;
        if let Some(gaps) = widest.gaps.get(..widest.count) {
            gaps.iter().for_each(visit);
            return;
        }
        self.places.each_gap(|gap| {
            if self.places.is_allowed(gap.n) && Some(gap.distance) == widest.distance {
                visit(gap);
            }
        });
    }

    /// The largest distance along a direction, if one counts. *Domain* a moment that was [measured](Self::measure).
    pub(super) fn widest_distance(&self) -> Option<i128> {
        self.widest.distance
    }

    /// The distance of the outlines, negative where they overlap. *Domain* a moment that was [measured](Self::measure).
    pub(super) fn distance(&self) -> i128 {
        self.widest_distance().unwrap_or(-(1 << 80))
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;
    use core::slice::from_ref;

    use super::*;
    use crate::cases::{run_seed, times};
    use crate::fx;
    use crate::math::{Random, vec2};
    use crate::shape::{Outline, Shape};

    /// Two polygons in one place, with eight edges that turns by a quarter and mirror images take to each other: along the normals of all sixteen
    /// they are equally far apart, which is more than are kept.
    #[test]
    fn all_directions_that_tie_are_visited_where_there_are_more_than_are_kept() {
        let corners: Vec<_> = (0..4)
            .flat_map(|turns| {
                [(10, 2), (7, 7), (2, 10)].map(|(x, y)| [vec2(x, y), vec2(-y, x), vec2(-x, -y), vec2(y, -x)][turns])
            })
            .collect();
        let shape = Shape::polygon(&corners).expect("a polygon");
        let outline: &Outline = shape.outlines().first().expect("an outline");
        let form = Form::new(outline, fx!(1), false);
        let leg = Leg::new([0; 2], [0; 2], Turn::default(), 0);
        let mut moment = Moment::default();
        moment.set([&form; 2], [from_ref(&leg); 2], 0);
        moment.measure();
        let mut directions = Vec::new();
        moment.each_widest(|gap| directions.push(gap.n));
        assert_eq!(directions.len(), 16, "{directions:?}");
        directions.sort_unstable();
        let mut turned: Vec<_> = directions.iter().map(|&[x, y]| [-y, x]).collect();
        turned.sort_unstable();
        assert_eq!(directions, turned);
    }

    /// Boxes, polygons and discs that fly past each other and turn, measured at moments that follow each other, and at each alone.
    #[test]
    fn a_moment_that_follows_another_has_the_widest_directions_of_the_moment_alone() {
        let mut random = Random::seeded(run_seed(53));
        let triangle = Shape::polygon(&[vec2(-1, -1), vec2(2, 0), vec2(0, 1)]);
        let shapes = [Shape::circle(fx!(0.5)), Shape::rectangle(1, 1), Shape::rectangle(8, fx!(0.5)), triangle];
        let shapes = shapes.map(|shape| shape.expect("a shape"));
        let outlines = shapes.each_ref().map(|shape| shape.outlines().first().expect("an outline"));
        let directions = |moment: &mut Moment| {
            moment.measure();
            let mut directions = Vec::new();
            moment.each_widest(|gap| directions.push((gap.n, gap.distance)));
            directions.sort_unstable();
            directions
        };
        let (mut moment, mut alone) = (Moment::default(), Moment::default());
        for _ in 0..times(4_000) {
            let pair = [0, 1].map(|_| outlines[random.bits() as usize % outlines.len()]);
            let forms = pair.map(|outline| Form::new(outline, outline.width(), false));
            let forms = [&forms[0], &forms[1]];
            // Upright at a quarter of the places, so that directions tie.
            let (bits, spin_bits) = (24 + random.bits() as u32 % 11, 40 + random.bits() as u32 % 24);
            let legs = [0, 1].map(|_| {
                let mut part = |bits: u32| random.bits() as i64 >> (63 - bits);
                let (centre, way) = ([part(33), part(33)], [part(bits), part(bits)].map(i128::from));
                let angle = if part(1) == 0 { 0 } else { part(63) as u64 };
                Leg::new(centre, way, Turn::from_bits(angle), part(spin_bits).into())
            });
            let paths = [from_ref(&legs[0]), from_ref(&legs[1])];
            let mut at = 0;
            moment.set(forms, paths, at);
            for _ in 0..6 {
                alone.set(forms, paths, at);
                assert_eq!(directions(&mut moment), directions(&mut alone), "{legs:?} {at}");
                at += (END - at) >> (1 + random.bits() % 8);
                moment.advance(forms, paths, at);
            }
        }
    }
}
