//! A test that a chain does not cross or touch itself: exact, in a time in proportion to n·log n.
//!
//! A line sweeps over the points from left to right, and keeps the segments that it is on in their order from below. Two
//! segments that meet are neighbours in this order before the sweep is beyond their first common point, so that only
//! neighbours are compared. Points are ordered by x, then by y, as if the plane were sheared a little: no segment is vertical.
//!
//! *Source* Shamos and Hoey, Geometric intersection problems, 1976.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::ops::Bound;

use crate::math::Vec2;
use crate::scalar::Scalar;

/// A segment from its first to its last point in the order of the sweep.
#[derive(Clone, Copy)]
struct Span<S> {
    from: Vec2<S>,
    to: Vec2<S>,
    number: usize,
}

/// The order of the sweep.
pub(super) fn order<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> Ordering {
    let compare = |a: S, b: S| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    compare(a.x, b.x).then(compare(a.y, b.y))
}

/// From below, where the later one of the two begins. Two that lie on one line from there on are equal.
///
/// This is an order for segments that do not meet and that one position of the sweep is on.
impl<S: Scalar> Ord for Span<S> {
    fn cmp(&self, other: &Self) -> Ordering {
        if order(self.from, other.from) == Ordering::Greater {
            return other.cmp(self).reverse();
        }
        let side = |point| S::orientation(self.from, self.to, point);
        // A point to the left of a segment is above it.
        side(other.from).then_with(|| side(other.to)).reverse()
    }
}

impl<S: Scalar> PartialOrd for Span<S> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<S: Scalar> PartialEq for Span<S> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<S: Scalar> Eq for Span<S> {}

impl<S: Scalar> Span<S> {
    /// Returns true if two segments have a point in common; if an end of one is an end of the other, a second one.
    fn meets(&self, rhs: &Self) -> bool {
        for (end, back) in [(self.from, self.to), (self.to, self.from)] {
            for (rhs_end, rhs_back) in [(rhs.from, rhs.to), (rhs.to, rhs.from)] {
                if end == rhs_end {
                    let is_back = order(end, back) == order(end, rhs_back);
                    return is_back && S::orientation(end, back, rhs_back) == Ordering::Equal;
                }
            }
        }
        let sides =
            |span: &Self, ends: &Self| [ends.from, ends.to].map(|point| S::orientation(span.from, span.to, point));
        let (rhs_sides, self_sides) = (sides(self, rhs), sides(rhs, self));
        if rhs_sides == [Ordering::Equal; 2] {
            let begins_within = |a: &Self, b: &Self| order(a.from, b.to) != Ordering::Greater;
            return begins_within(self, rhs) && begins_within(rhs, self);
        }
        let is_across = |[a, b]: [Ordering; 2]| a == Ordering::Equal || b == Ordering::Equal || a != b;
        is_across(rhs_sides) && is_across(self_sides)
    }
}

/// Two segments of a chain that have a point in common, beside the one that joins neighbours; `None` if there are none. A
/// segment is counted by the point it begins at.
///
/// *Domain* points within 2^13 m; each differs from the next one.
pub(super) fn crossing<S: Scalar>(points: &[Vec2<S>], is_closed: bool) -> Option<[usize; 2]> {
    let count = points.len() - usize::from(!is_closed);
    let span = |number: usize| {
        let (a, b) = (points[number], points[(number + 1) % points.len()]);
        let (from, to) = if order(a, b) == Ordering::Less { (a, b) } else { (b, a) };
        Span { from, to, number }
    };
    let mut sweep: Vec<u32> = (0..points.len() as u32).collect();
    sweep.sort_unstable_by(|&i, &j| order(points[i as usize], points[j as usize]));
    let pair = |a: usize, b: usize| [a.min(b), a.max(b)];
    if let Some(two) = sweep.windows(2).find(|two| points[two[0] as usize] == points[two[1] as usize]) {
        // The last point of an open chain begins no segment.
        let [a, b] = [two[0], two[1]].map(|point| (point as usize).min(count - 1));
        return Some(pair(a, b));
    }
    let mut open: BTreeSet<Span<S>> = BTreeSet::new();
    for &point in &sweep {
        let at = points[point as usize];
        let point = point as usize;
        let before = if point > 0 { Some(point - 1) } else { is_closed.then(|| count - 1) };
        let numbers = [before, (point < count).then_some(point)];
        let spans = numbers.map(|number| number.map(span));
        // Segments that end here are removed, so that their neighbours become neighbours; then segments that begin are added.
        for ending in spans.iter().flatten().filter(|span| span.to == at) {
            open.remove(ending);
            let [below, above] = neighbours(&open, ending);
            if let (Some(below), Some(above)) = (below, above) {
                if below.meets(&above) {
                    return Some(pair(below.number, above.number));
                }
            }
        }
        for beginning in spans.iter().flatten().filter(|span| span.from == at) {
            let same = open.get(beginning).copied();
            let candidates = neighbours(&open, beginning).into_iter().chain([same]).flatten();
            if let Some(candidate) = candidates.into_iter().find(|candidate| candidate.meets(beginning)) {
                return Some(pair(candidate.number, beginning.number));
            }
            open.insert(*beginning);
        }
    }
    None
}

/// The segments next to one in the order from below.
fn neighbours<S: Scalar>(open: &BTreeSet<Span<S>>, span: &Span<S>) -> [Option<Span<S>>; 2] {
    let below = open.range((Bound::Unbounded, Bound::Excluded(*span))).next_back();
    let above = open.range((Bound::Excluded(*span), Bound::Unbounded)).next();
    [below.copied(), above.copied()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::run_seed;
    use crate::fx::Fx;
    use crate::math::{Random, vec2};

    /// By comparison of each two segments.
    fn crosses(points: &[Vec2], is_closed: bool) -> bool {
        let count = points.len() - usize::from(!is_closed);
        let span = |number: usize| {
            let (a, b) = (points[number], points[(number + 1) % points.len()]);
            let (from, to) = if order(a, b) == Ordering::Less { (a, b) } else { (b, a) };
            Span { from, to, number }
        };
        let are_joined = |i: usize, j: usize| j == i + 1 || is_closed && i == 0 && j + 1 == count;
        let meet = |i: usize, j: usize| {
            let (a, b) = (span(i), span(j));
            // Two that are not joined and have an end in common meet there.
            let have_end = [a.from, a.to].iter().any(|end| [b.from, b.to].contains(end));
            a.meets(&b) || have_end && !are_joined(i, j)
        };
        (0..count).any(|i| (i + 1..count).any(|j| meet(i, j)))
    }

    #[test]
    fn crossings_are_those_of_a_look_at_all_pairs() {
        let mut random = Random::seeded(run_seed(11));
        let mut counts = [0; 2];
        for run in 0..60_000 {
            let count = 3 + random.below(9) as usize;
            // A small grid: many points on lines, on segments, and at one place; a wide one: chains that cross rarely.
            let (width, height) = [(4, 4), (12, 3), (40, 6), (1_000, 1_000)][run % 4];
            let mut points: Vec<Vec2> = Vec::new();
            while points.len() < count {
                // Steps to the right mostly.
                let x =
                    if run % 3 == 0 { random.integer(0..=width) } else { points.len() as i64 + random.integer(0..=2) };
                let point = vec2(Fx::from_bits(x), Fx::from_bits(random.integer(0..=height)));
                if points.last() != Some(&point) && points.first() != Some(&point) {
                    points.push(point);
                }
            }
            for is_closed in [false, true] {
                let crossing = crossing(&points, is_closed);
                assert_eq!(crossing.is_some(), crosses(&points, is_closed), "{points:?} {is_closed} {crossing:?}");
                counts[usize::from(crossing.is_some())] += 1;
            }
        }
        assert!(counts[0] > 10_000 && counts[1] > 10_000, "{counts:?}");
    }

    #[test]
    fn many_long_segments_take_no_time_to_speak_of() {
        // A fan of 2^16 points, to and fro over its whole length: each two boxes overlap.
        let far = |i: i32| vec2(if i % 2 == 0 { -4000 } else { 4000 }, Fx::from_ratio(i.into(), 32));
        let mut points: Vec<Vec2> = (0..1 << 16).map(far).collect();
        assert_eq!(crossing(&points, false), None);
        points[40_000].y -= Fx::from_ratio(1, 10);
        assert!(crossing(&points, false).is_some());
    }
}
