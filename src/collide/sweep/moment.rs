//! Two outlines at a moment of their paths: how far apart they are, and for how long they surely stay so.

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

/// Two outlines at a moment. Sweeps use its memory again.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(super) placed: [PlacedForm; 2],
    legs: [Leg; 2],
    /// From the centre of the first outline to the centre of the second one.
    pub(super) offset: [i128; 2],
    radius: i64,
    /// The moment at which a piece of either path ends.
    pub(super) until: u64,
    /// The outer side of a segment of a chain that meets a segment: it has no other side to be told by, and directions to its inner side do not
    /// count.
    front: Option<[i32; 2]>,
    /// A direction across the way that they go against each other, if they do not go together.
    across: Option<[i32; 2]>,
    /// Of another moment until [`measure`](Self::measure).
    widest: Widest,
    is_measured: bool,
}

impl Default for Moment {
    fn default() -> Self {
        let leg = Leg::new([0; 2], [0; 2], Turn::default(), 0);
        Self {
            placed: [PlacedForm::NONE; 2],
            legs: [leg; 2],
            offset: [0; 2],
            radius: 0,
            until: 0,
            front: None,
            across: None,
            widest: Widest::NONE,
            is_measured: false,
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
        self.placed[0].set(forms[0], a, at);
        self.placed[1].set(forms[1], b, at);
        self.legs = [*a, *b];
        self.radius = forms[0].radius + forms[1].radius;
        self.until = until_a.min(until_b);
        self.across = unit([0, 1].map(|k| b.way[k] - a.way[k])).map(|[x, y]| [-y, x]);
        self.complete(forms);
    }

    /// Brings the outlines that were [set](Self::set) to a later moment of their paths.
    pub(super) fn advance(&mut self, forms: [&Form<'_>; 2], paths: [&[Leg]; 2], at: u64) {
        if at >= self.until {
            self.set(forms, paths, at);
            return;
        }
        for ((placed, form), leg) in self.placed.iter_mut().zip(forms).zip(&self.legs) {
            placed.advance(form, leg, at);
        }
        self.complete(forms);
    }

    /// Completes what follows from the places of the outlines.
    fn complete(&mut self, forms: [&Form<'_>; 2]) {
        let [from, to] = [self.placed[0].centre, self.placed[1].centre];
        self.offset = [0, 1].map(|k| i128::from(to[k]) - i128::from(from[k]));
        self.front = match (forms[0].is_link, forms[1].is_link) {
            (true, _) if forms[1].width == 0 => Some(self.placed[0].normals()[0]),
            (_, true) if forms[0].width == 0 => Some(self.placed[1].normals()[0].map(|part| -part)),
            _ => None,
        };
        self.is_measured = false;
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

    /// The distances along the directions that may separate best: of all edges, and between the corners that are nearest to each other.
    #[inline(always)]
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
        // The offset is cut to words, which changes it only for outlines that are never near; corners are below 2^50.
        let offset = self.offset.map(|part| part.clamp(-(1 << 62), 1 << 62) as i64);
        let [a, b] = [0, 1].map(|side: usize| self.placed[side].corners());
        let between = |a: [i64; 2], b: [i64; 2]| [offset[0] + b[0] - a[0], offset[1] + b[1] - a[1]];
        let mut nearest = u128::MAX;
        let (mut shortest, mut count) = ([[0; 2]; KEPT], 0);
        for &a in a {
            for &b in b {
                let d = between(a, b);
                let square = square(d);
                if square < nearest {
                    (nearest, count) = (square, 0);
                }
                if square == nearest {
                    if let Some(place) = shortest.get_mut(count) {
                        *place = d;
                    }
                    count += 1;
                }
            }
        }
        let mut visit_along = |d: [i64; 2]| {
            if let Some(n) = unit(d.map(i128::from)) {
                visit(&self.gaps(n)[0]);
            }
        };
        if let Some(shortest) = shortest.get(..count) {
            shortest.iter().for_each(|&d| visit_along(d));
            return;
        }
        let all = a.iter().flat_map(|&a| b.iter().map(move |&b| between(a, b)));
        all.filter(|&d| square(d) == nearest).for_each(visit_along);
    }

    /// Finds the largest distance along a direction.
    pub(super) fn measure(&mut self) {
        if self.is_measured {
            return;
        }
        let mut widest = Widest::NONE;
        self.each_gap(|gap| {
            if self.is_allowed(gap.n) {
                widest.add(gap);
            }
        });
        self.widest = widest;
        self.is_measured = true;
    }

    /// Visits the directions of the largest distance, all that tie. *Domain* a moment that was [measured](Self::measure).
    pub(super) fn each_widest(&self, mut visit: impl FnMut(&Gap)) {
        let widest = &self.widest;
        if let Some(gaps) = widest.gaps.get(..widest.count) {
            gaps.iter().for_each(visit);
            return;
        }
        self.each_gap(|gap| {
            if self.is_allowed(gap.n) && Some(gap.distance) == widest.distance {
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

    /// The longest step that a direction across the way proves safe.
    pub(super) fn longest_across(&self, depth: i64, room: u64, guess: u64) -> u64 {
        let Some(across) = self.across else { return 0 };
        let gaps = self.gaps(across);
        let allowed = gaps.iter().filter(|gap| self.is_allowed(gap.n));
        allowed.map(|gap| self.time(gap, depth, room, guess)).max().unwrap_or(0)
    }

    /// A bound of the distance by which a body's rotation moves a corner in a tick, ulps.
    fn turn_speed(&self, side: usize) -> i128 {
        let turns = self.legs[side].spin.unsigned_abs();
        if turns == 0 {
            return 0;
        }
        // Below 2^50 in units of 2^-32 turns, 2^85 in 2^-64 rad; corners are below 2^49.
        let radians = ((((turns >> 32) + 1) * TAU) >> 32) + 1;
        (((radians * self.placed[side].reach.unsigned_abs() as u128) >> 32) + 2) as i128
    }

    /// The angle that a body turns in a part of the tick, in 2^-44 rad, rounded up by at most 8; `None` above half a turn.
    fn angle(&self, side: usize, time: u64) -> Option<i64> {
        let turns = self.legs[side].spin.unsigned_abs();
        let time = u128::from(time);
        // Whole turns below 2^18, and the rest.
        let turned = (((turns >> 64) * time) << 2) + (((turns & u128::from(u64::MAX)) * time) >> 62);
        // From 2^-64 turns to 2^-44 rad: below 2^43 · 2^35.
        (turned < 1 << 63).then(|| (((((turned >> 20) + 1) * TAU) >> 32) + 1) as i64)
    }

    /// The time for which the distance along a direction surely stays above −depth, at most `room`.
    pub(super) fn time(&self, gap: &Gap, depth: i64, room: u64, guess: u64) -> u64 {
        let free = gap.distance + i128::from(depth - ROUNDING - (self.radius >> 26));
        if free <= 0 {
            return 0;
        }
        let [a, b] = &self.legs;
        // Rounded up.
        let closing = -along(gap.n, [0, 1].map(|k| b.way[k] - a.way[k]));
        let bounds = [0, 1].map(|side| {
            // By how much the farthest corner may reach farther out; a unit vector is off by 2^-29.
            let reach = self.placed[side].reach;
            let reach = reach + (reach >> 28) + 2;
            let more = if side == 0 { reach - gap.support_a } else { reach + gap.support_b };
            (self.turn_speed(side), i128::from(more.max(0)))
        });
        let time = bounded(free, closing, bounds).min(room);
        if time == room || bounds.iter().all(|(speed, bound)| *speed == 0 || *bound == 0) {
            return time;
        }
        let stays = |time: u64| self.stays_apart(gap, free, closing, time);
        if stays(room) {
            return room;
        }
        let mut next = room.min(guess) >> 1;
        while next > time && next > SHORTEST {
            if stays(next) {
                let more = next + (next >> 1);
                return if more < room && stays(more) { more } else { next };
            }
            next >>= 1;
        }
        time
    }

    /// Returns true if a distance along a direction stays below `free` for some time, as far as the speeds of corners and the bound of
    /// their acceleration say. This bound is convex in the time and zero at first, so that it holds all the time if it holds at the end.
    fn stays_apart(&self, gap: &Gap, free: i128, closing: i128, time: u64) -> bool {
        let (Some(turn_a), Some(turn_b)) = (self.angle(0, time), self.angle(1, time)) else { return false };
        let farther = |side: usize, turn: i64| {
            let (placed, leg) = (&self.placed[side], &self.legs[side]);
            if leg.spin == 0 {
                return 0;
            }
            let n = if side == 0 { gap.n } else { gap.n.map(|part| -part) };
            let size = i128::from(turn);
            let highest = placed.highest_after(n, if leg.spin < 0 { -turn } else { turn });
            let support = if side == 0 { gap.support_a } else { -gap.support_b };
            // Rounded up: the product above, the angle, and half of its square.
            let rounding = i128::from(2 + (placed.reach >> 40));
            let square = ((size * size) >> 44) + 1;
            (highest >> 30) - i128::from(support) + rounding + ((square * i128::from(placed.reach + 2)) >> 45) + 1
        };
        // Below 2^66 · 2^58, rounded up.
        let part = i128::from(if closing > 0 { (time >> 4) + 1 } else { time >> 4 });
        let closed = ((closing * part) >> 58) + 1;
        farther(0, turn_a) + farther(1, turn_b) + closed < free
    }
}

/// The time for which `closing·t + Σ min(speed·t, bound)` stays below `free`, rounded down.
fn bounded(free: i128, closing: i128, bounds: [(i128, i128); 2]) -> u64 {
    // distance / speed. Both are cut to 64 bits, the speed rounded up.
    let time = |distance: i128, speed: i128| {
        if speed <= 0 || distance >= speed {
            return END;
        }
        if distance <= 0 {
            return 0;
        }
        let right = (128 - speed.leading_zeros()).saturating_sub(64);
        (((distance.unsigned_abs() >> right) << 62) / ((speed.unsigned_abs() >> right) + 1)) as u64
    };
    // A rotation is at its bound from some time on.
    let [first, second] = bounds.map(|(speed, bound)| {
        let bound = if speed == 0 { 0 } else { bound };
        (time(bound, speed.max(1)), speed, bound)
    });
    let (first, second) = if first.0 <= second.0 { (first, second) } else { (second, first) };
    // The sum is concave: where it stops growing below `free`, it stays there. Each line is an upper bound of it.
    let joint_time = time(free, closing + first.1 + second.1);
    if joint_time <= first.0 {
        return joint_time;
    }
    let second_time = time(free - first.2, closing + second.1);
    if second_time <= second.0 {
        return second_time.max(first.0);
    }
    time(free - first.2 - second.2, closing).max(second.0)
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;
    use core::slice::from_ref;

    use super::*;
    use crate::fx;
    use crate::math::vec2;
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
}
