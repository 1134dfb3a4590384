//! Impulses of points that go over a seam: from one segment of a chain, or one polygon among others, to the next.
//!
//! A corner of a body, or the middle of a ball, that was on a segment in the step before and is on the next one now is the same point: it
//! starts from the impulse that it had there. So a body rolls over a chain as over one long segment.

use alloc::vec::Vec;
use core::ops::{Range, RangeInclusive};

use super::actors::Actors;
use super::numbers::Numbers;
use super::{ContactRecord, Scene};
use crate::body::BodyKind;
use crate::collider::{Collider, OutlineId};
use crate::fx::Fx;
use crate::solve::Impulses;

/// Outlines with one surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Union {
    /// The chain in a slot.
    Chain(u32),
    /// All static polygons.
    Static,
    /// The polygons of a body, by its slot.
    Body(u32),
}

impl Union {
    /// The union that a collider belongs to; `None` for the only outline of a body that is not static.
    pub(super) fn of(scene: &Scene<'_>, collider: &Collider) -> Option<Self> {
        let body = collider.body;
        if collider.def.shape.is_chain() {
            return Some(Self::Chain(collider.slot));
        }
        let dense = scene.bodies.index_of(body)?;
        match scene.bodies.contact_info(dense).kind {
            BodyKind::Static => Some(Self::Static),
            _ => collider.has_others().then_some(Self::Body(body.slot)),
        }
    }
}

/// The records of contacts with unions in which a corner of the outline on the union has an impulse.
#[derive(Debug, Default)]
pub(super) struct Unions {
    /// The union, the outline on it, the corner of that outline, and the index of the record.
    records: Vec<(Union, OutlineId, u32, u32)>,
    /// True if the records of this step are listed.
    is_listed: bool,
    /// Impulses that the present contact takes over.
    pub(super) terms: Vec<Term>,
}

impl Unions {
    pub(super) fn clear(&mut self) {
        self.records.clear();
        self.is_listed = false;
    }

    /// The records of these corners of an outline on a union: many outlines of a body may lie on one outline, and few at a corner of it.
    pub(super) fn find(
        &mut self,
        scene: &Scene<'_>,
        actors: &Actors,
        numbers: &Numbers,
        union: Union,
        outline: OutlineId,
        corners: RangeInclusive<u32>,
    ) -> Range<usize> {
        self.list(scene, actors, numbers);
        let key = |&(union, outline, corner, _): &(Union, OutlineId, u32, u32)| (union, outline, corner);
        let first = (union, outline, *corners.start());
        let last = (union, outline, *corners.end());
        let start = self.records.partition_point(|record| key(record) < first);
        let count = self.records[start..].partition_point(|record| key(record) <= last);
        start..start + count
    }

    /// Lists the records when they are first asked for.
    fn list(&mut self, scene: &Scene<'_>, actors: &Actors, numbers: &Numbers) {
        if self.is_listed {
            return;
        }
        self.is_listed = true;
        for (i, record) in (0..).zip(&scene.contacts.records).filter(|(_, record)| !record.is_slack()) {
            let pair = record.pair();
            let features = record.features();
            for side in 0..2 {
                // Most outlines are known to stand alone.
                let actor = actors.find(numbers.number(pair[side])).map(|index| actors.get(index));
                if actor.is_some_and(|actor| actor.is_alone) {
                    continue;
                }
                let collider = scene.colliders.at(pair[side].slot);
                if let Some(union) = collider.and_then(|collider| Union::of(scene, collider)) {
                    let corners = corners(&features[..record.count()], 1 - side);
                    self.records.extend(corners.map(|corner| (union, pair[1 - side], corner, i)));
                }
            }
        }
        self.records.sort_unstable();
        self.records.dedup();
    }

    /// A record that was found, with this outline on this side: a body may be the first of its pair with one tile, and the second of its
    /// pair with the next tile.
    pub(super) fn record(&self, scene: &Scene<'_>, i: usize, side: usize, outline: OutlineId) -> ContactRecord {
        let record = scene.contacts.records[self.records[i].3 as usize];
        if record.pair()[side] == outline { record } else { record.swapped() }
    }
}

/// The corners in points with these features, of the collider on one side.
pub(super) fn corners(features: &[u32], side: usize) -> impl Iterator<Item = u32> {
    features.iter().filter_map(move |&feature| corner(feature, side))
}

/// The name of the corner in a point, of one of the two colliders, which has its number in the lower six bits; `None` for an edge.
pub(super) fn corner(feature: u32, side: usize) -> Option<u32> {
    let half = half(feature, side);
    (half & 63 == half >> 6).then_some(half)
}

/// The radius with which a point of two outlines rolls: the radius of the outline that touches with an arc, the smaller one if both do,
/// zero if neither does.
pub(super) fn rolling_radius(feature: u32, radii: [Fx; 2]) -> Fx {
    // An edge is flat, whatever the radius of its ends.
    let arc = |side: usize| Some(radii[side]).filter(|radius| corner(feature, side).is_some() && *radius > Fx::ZERO);
    match (arc(0), arc(1)) {
        (Some(a), Some(b)) => a.min(b),
        (a, b) => a.or(b).unwrap_or(Fx::ZERO),
    }
}

/// The name of the corner or edge that meets in a point, of one of the two colliders.
fn half(feature: u32, side: usize) -> u32 {
    feature >> (12 * side) & 0xFFF
}

/// An impulse along a row, in units of 2^exponent N·s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    row: usize,
    impulse: i64,
    exponent: i32,
}

/// Lists the impulses that a contact with a segment takes over from points that were on another segment.
///
/// `features` are of the points of the contact. `record` is the contact with the other segment in the last step, `kept` has the features of
/// its points now, `body_side` is the side of the body that is on the chain: its corners go from one segment to the next.
pub(super) fn take_over(
    terms: &mut Vec<Term>,
    features: &[u32],
    record: &ContactRecord,
    kept: &[u32],
    body_side: usize,
) {
    let before = record.features();
    let mut take =
        |row: usize, from: usize| terms.push(Term { row, impulse: record.impulses[from], exponent: record.exponent() });
    let mut has_moved = false;
    for (k, &feature) in before.iter().enumerate().take(record.count()) {
        let Some(corner) = corner(feature, body_side) else { continue };
        let is_corner = |&feature: &u32| half(feature, body_side) == corner;
        if kept.iter().any(is_corner) {
            continue;
        }
        if let Some(row) = features.iter().position(is_corner) {
            take(row, k);
            has_moved = true;
        }
    }
    // Friction goes along with the last of the points, and so does rolling resistance.
    if has_moved && !before[..record.count()].iter().any(|feature| kept.contains(feature)) {
        take(2, 2);
        if record.count() == 1 && features.len() == 1 {
            take(1, 1);
        }
    }
}

/// Adds terms to the impulses that a contact starts from, all in the largest of their units.
///
/// In a mirror image records have the opposite order. So each term is rounded by itself, and then integers are added, in any order.
pub(super) fn add(start: &mut Impulses, terms: &[Term]) {
    let start_terms = [0, 1, 2].map(|row| Term { row, impulse: start.values[row], exponent: start.exponent });
    let all = || start_terms.iter().chain(terms).filter(|term| term.impulse != 0);
    let Some(exponent) = all().map(|term| term.exponent).max() else { return };
    // Terms are at most 2^62, and there are fewer than 2^32 records.
    let mut sums = [0_i128; 3];
    all().for_each(|term| sums[term.row] += i128::from(divided(term.impulse, exponent - term.exponent)));
    const LIMIT: i128 = 1 << 62;
    *start = Impulses { values: sums.map(|sum| sum.clamp(-LIMIT, LIMIT) as i64), exponent };
}

/// `value / 2^shift` to nearest, halves away from zero. *Domain* `shift` is not negative.
fn divided(value: i64, shift: i32) -> i64 {
    if shift == 0 || shift > 63 {
        return if shift == 0 { value } else { 0 };
    }
    let size = (u128::from(value.unsigned_abs()) + (1 << (shift - 1))) >> shift;
    // At most 2^62 in size: as small as it was.
    if value < 0 { -(size as i64) } else { size as i64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::feature;
    use crate::collider::OutlineId;

    fn record(features: [u32; 2], count: usize, values: [i64; 3]) -> ContactRecord {
        let pair = [OutlineId { slot: 1, part: 70 }, OutlineId { slot: 2, part: 0 }];
        ContactRecord::new(pair, features, count, Impulses { values, exponent: -20 })
    }

    #[test]
    fn a_ball_takes_its_impulse_along_and_a_box_that_of_the_corner_that_goes_over() {
        let taken = |features: &[u32], record: &ContactRecord, kept: &[u32]| {
            let mut terms = Vec::new();
            let mut start = Impulses::default();
            take_over(&mut terms, features, record, kept, 1);
            add(&mut start, &terms);
            start
        };
        // A ball: the impulses on a segment go to the next one.
        let ball = feature([0, 1], [0, 0]);
        let start = taken(&[ball], &record([ball, 0], 1, [9, -2, -4]), &[]);
        assert_eq!(start, Impulses { values: [9, -2, -4], exponent: -20 });
        // A ball that still touches the first segment keeps its impulse there: the next one takes nothing over.
        let start = taken(&[ball], &record([ball, 0], 1, [9, 0, -4]), &[ball]);
        assert_eq!(start, Impulses::default());
        // A box: corner 1 goes over, and corner 0 stays.
        let [first, second] = [0, 1].map(|corner| feature([0, 1], [corner; 2]));
        let end = feature([1, 1], [0, 1]);
        let before = record([first, second], 2, [5, 7, 3]);
        let start = taken(&[end, second], &before, &[first, end]);
        assert_eq!(start, Impulses { values: [0, 7, 0], exponent: -20 });
    }

    #[test]
    fn outlines_that_touch_with_an_arc_roll() {
        let radius = |feature, radii: [i32; 2]| rolling_radius(feature, radii.map(crate::fx::Fx::from)).to_bits() >> 32;
        // A disc on an edge, on a corner, and two discs.
        assert_eq!(radius(feature([0, 1], [0, 0]), [0, 3]), 3);
        assert_eq!(radius(feature([2, 2], [0, 0]), [0, 3]), 3);
        assert_eq!(radius(feature([0, 0], [0, 0]), [2, 3]), 2);
        // An edge of a rounded box is flat; its corner on an edge rolls.
        assert_eq!(radius(feature([0, 1], [0, 0]), [1, 3]), 3);
        assert_eq!(radius(feature([1, 1], [2, 3]), [1, 9]), 1);
        assert_eq!(radius(feature([1, 1], [2, 3]), [0, 0]), 0);
    }

    #[test]
    fn sums_are_in_the_largest_unit_and_depend_on_no_order() {
        let term = |row, impulse, exponent| Term { row, impulse, exponent };
        let sum = |start: [i64; 3], terms: &[Term]| {
            let mut sum = Impulses { values: start, exponent: -3 };
            add(&mut sum, terms);
            sum
        };
        let coarser = term(2, -1, -2);
        assert_eq!(sum([5, 0, -5], &[coarser]), Impulses { values: [3, 0, -4], exponent: -2 });
        assert_eq!(sum([5, 0, -5], &[coarser, term(0, 1 << 62, -2)]).values, [1 << 62, 0, -4]);
        // Nothing has no unit.
        assert_eq!(sum([5, 0, 0], &[term(0, 0, 9)]), Impulses { values: [5, 0, 0], exponent: -3 });
        assert_eq!(sum([0; 3], &[term(1, 3, -8)]), Impulses { values: [0, 3, 0], exponent: -8 });
        // Through the unit between, 5 would be rounded to 3 and then to 2.
        let terms_of =
            |sign: i64| [term(0, 5 * sign, -4), term(0, 7 * sign, -2), term(1, 1 << 61, -3), term(1, sign << 62, -2)];
        for (sign, last) in [(1, 1 << 62), (-1, (1 << 60) - (1 << 62))] {
            let mut terms = terms_of(sign);
            for i in 0..24 {
                // All orders.
                terms.swap(i % 3, i % 3 + 1);
                let expected = Impulses { values: [8 * sign, last, 0], exponent: -2 };
                assert_eq!(sum([0; 3], &terms), expected, "{terms:?}");
            }
        }
        assert_eq!([divided(-7, 1), divided(7, 1), divided(i64::MAX, 63), divided(9, 99)], [-4, 4, 1, 0]);
    }
}
