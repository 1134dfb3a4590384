//! The state of contacts: the impulses that the next step starts from.
//!
//! A record names two outlines and the corners that meet, with the impulses and their unit, in 40 bytes. Manifolds, islands, levels and
//! units of velocity follow from the poses. A change of the time step or of the number of sub-steps scales the impulses, so that forces stay the
//! same. A slot has 24 bits, so that 8 are left for the part of a compound; of the number of a segment above 255 the upper 8 bits stand
//! beside the corners of the first point, of which a segment has two.

use super::seams;
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, StateHasher, Write};
use crate::collide::{self, Manifold};
use crate::collider::OutlineId;
use crate::fx::Fx;
use crate::limits::{CHAIN, COLLIDERS, PARTS};
use crate::solve::Impulses;

/// A contact that carried an impulse at the end of a step; for colliders with events also one that touched in the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ContactRecord {
    /// The slots of the two colliders, the lower one first, in the lower 24 bits; above them the lower 8 bits of the outline's number.
    pair: [u32; 2],
    /// In the lower 24 bits of each the [feature](crate::collide::feature) of a point; above them log2 of the unit of the impulses, N·s,
    /// and the number of points with the [`LONG`] bits.
    packed: [u32; 2],
    /// Multiples of the unit: along the normal, by point; then along the tangent. With one point the second impulse is the one of
    /// rolling resistance.
    pub(crate) impulses: [i64; 3],
}

// The state is copied with every snapshot.
const _: () = assert!(size_of::<ContactRecord>() == 40);

const FEATURE: u32 = (1 << 24) - 1;

/// The part of a word that holds a slot below [`COLLIDERS`].
const SLOT: u32 = COLLIDERS as u32 - 1;
const _: () = assert!(COLLIDERS == 1 << 24 && PARTS <= 1 << 8 && CHAIN <= 1 << 16);

/// Beside the number of points, for each collider: its outline's number is above 255, so that it is a segment of a chain. Its corners
/// are 0 and 1, and take one bit of the six that they have in the feature of the first point. The other bits hold
/// the upper 8 bits of the number: five in the first corner's, three in the second one's.
const LONG: [u32; 2] = [4 << 24, 8 << 24];
/// These bits, of the first collider.
const HIGH: u32 = 0x380 | 0x3E;

impl ContactRecord {
    /// *Domain* features are below 2^24, the exponent is from −128 to 127, the count is 1 or 2.
    #[inline(always)]
    pub(crate) fn new(pair: [OutlineId; 2], features: [u32; 2], count: usize, impulses: Impulses) -> Self {
        let high = pair.map(|outline| outline.part >> 8);
        let pair = pair.map(|OutlineId { slot, part }| slot | part << 24);
        let packed = [features[0] & FEATURE | in_byte(impulses.exponent), features[1] & FEATURE | (count as u32) << 24];
        // By value: in memory, two words would be read as one before they are written.
        let packed = if high[0] | high[1] == 0 { packed } else { with_high(packed, high) };
        Self { pair, packed, impulses: impulses.values }
    }

    /// The impulses with their unit.
    #[inline(always)]
    pub(super) fn carried(&self) -> Impulses {
        Impulses { values: self.impulses, exponent: self.exponent() }
    }

    /// The record with other impulses. *Domain* as [`new`](Self::new).
    #[inline(always)]
    pub(super) fn carrying(&self, impulses: Impulses) -> Self {
        let [first, second] = self.packed;
        Self { packed: [first & FEATURE | in_byte(impulses.exponent), second], impulses: impulses.values, ..*self }
    }

    /// The upper bits of the number of an outline.
    #[cold]
    fn high(&self, side: usize) -> u32 {
        let bits = self.packed[0] >> (12 * side);
        (bits >> 1 & 31) | (bits >> 7 & 7) << 5
    }

    fn is_long(&self, side: usize) -> bool {
        self.packed[1] & LONG[side] != 0
    }

    /// The outlines of the two colliders: records are sorted by them.
    #[inline(always)]
    pub(crate) fn pair(&self) -> [OutlineId; 2] {
        let mut pair = self.pair.map(|word| OutlineId { slot: word & SLOT, part: word >> 24 });
        if self.packed[1] >= LONG[0] {
            for (side, outline) in pair.iter_mut().enumerate().filter(|(side, _)| self.is_long(*side)) {
                outline.part |= self.high(side) << 8;
            }
        }
        pair
    }

    /// The slots of the two colliders, where each has one outline.
    #[inline(always)]
    pub(crate) fn slots(&self) -> [u32; 2] {
        self.pair
    }

    pub(crate) fn features(&self) -> [u32; 2] {
        let mut features = self.packed.map(|word| word & FEATURE);
        for side in (0..2).filter(|&side| self.is_long(side)) {
            features[0] &= !(HIGH << (12 * side));
        }
        features
    }

    pub(crate) fn count(&self) -> usize {
        (self.packed[1] >> 24 & 3) as usize
    }

    /// log2 of the unit of the impulses, N·s.
    pub(crate) fn exponent(&self) -> i32 {
        i32::from((self.packed[0] >> 24) as u8 as i8)
    }

    /// Returns true if no impulse is left: the contact carried one earlier in the step, or overlapped.
    pub(crate) fn is_slack(&self) -> bool {
        self.impulses == [0; 3]
    }

    /// The impulses that a contact with these features starts from: zero for points that the record does not have. Friction is kept
    /// if a point is, rolling resistance if both have this one point. Single points with a [common corner](have_common_corner) are one point.
    #[inline]
    pub(super) fn start(&self, features: [u32; 2], count: usize) -> Impulses {
        let record_features = self.features();
        let is_one = (count, self.count()) == (1, 1);
        if self.has_points(features, count) || is_one && have_common_corner(features[0], record_features[0]) {
            return self.carried();
        }
        let mut start = Impulses { exponent: self.exponent(), ..Impulses::default() };
        for (k, feature) in features.iter().enumerate().take(count) {
            if let Some(i) = (0..self.count()).find(|&i| record_features[i] == *feature) {
                start.values[k] = self.impulses[i];
                start.values[2] = self.impulses[2];
            }
        }
        start
    }

    /// Returns true if the record is of points with these features.
    #[inline(always)]
    pub(crate) fn has_points(&self, features: [u32; 2], count: usize) -> bool {
        (features, count) == (self.features(), self.count())
    }

    /// [`start`](Self::start) for points that may not be in the record: the impulses along the normal of the points that are gone go to
    /// the deepest new one, half to each of two as deep. Where a body turns over a corner, the pair presses there as before.
    pub(super) fn start_at(&self, manifold: &Manifold) -> Impulses {
        let (features, count) = (manifold.features(), manifold.count);
        let mut start = self.start(features, count);
        let record_features = &self.features()[..self.count()];
        let pairs = record_features.iter().zip(self.impulses);
        let remainders = pairs.filter(|(feature, _)| !features[..count].contains(feature)).map(|(_, impulse)| impulse);
        // Impulses are at most 2^62.
        let remainder = remainders.fold(0, i64::saturating_add).min(1 << 62);
        let [is_first_new, is_second_new] = [0, 1].map(|k: usize| k < count && !record_features.contains(&features[k]));
        // A single point has its rule.
        if remainder == 0 || (count, self.count()) == (1, 1) || !(is_first_new || is_second_new) {
            return start;
        }
        let [depth, second_depth] = manifold.points.map(|point| -point.separation);
        match (is_first_new, is_second_new) {
            (true, true) if depth == second_depth => start.values = [remainder >> 1, remainder >> 1, 0],
            (true, false) => start.values[0] = remainder,
            (true, true) if depth > second_depth => start.values[0] = remainder,
            _ => start.values[1] = remainder,
        }
        start.values[2] = self.impulses[2];
        start
    }

    /// The manifold in place of this one where the points of the record still press, as `between_edges` gives it for the corners of either
    /// collider, by point. Both points stay until the edge beside their edge faces more *and* a point of the two has opened; beside corners, until
    /// a point with an impulse has. A body deep between others would turn to and fro over its corner for ever: the points of either edge push it to
    /// where the other edge faces more.
    pub(crate) fn manifold_before(
        &self,
        manifold: &Manifold,
        between_edges: impl FnOnce([[usize; 2]; 2]) -> Option<Manifold>,
    ) -> Option<Manifold> {
        if self.count() != 2 || self.is_slack() {
            return None;
        }
        let record_edges = edges(self.features())?;
        let features = manifold.features();
        let is_beside = |side: usize, new_edges: [[usize; 2]; 2]| {
            let ([start, end], [new_start, new_end]) = (record_edges[side], new_edges[side]);
            record_edges[1 - side] == new_edges[1 - side] && (start == new_end || end == new_start)
        };
        let is_single = manifold.count == 1;
        let may_stay = if is_single {
            (0..2).all(|side| corner(features[0], side).is_some_and(|corner| record_edges[side].contains(&corner)))
        } else {
            edges(features).is_some_and(|edges| is_beside(0, edges) || is_beside(1, edges))
        };
        let manifold = between_edges(may_stay.then_some(record_edges)?)?;
        let mut points = manifold.points.iter().zip(self.impulses);
        let is_pressed = points.all(|(point, impulse)| point.separation < Fx::ZERO || is_single && impulse == 0);
        (manifold.count == 2 && is_pressed).then_some(manifold)
    }

    /// The record with the two colliders swapped: points come in the opposite order along the tangent, whose impulse stays. The impulse of
    /// rolling resistance acts on the second body, and so changes its sign.
    pub(crate) fn swapped(&self) -> Self {
        let [first, second] = self.features().map(collide::swapped_feature);
        let [a, b, tangent] = self.impulses;
        let (features, values) =
            if self.count() == 2 { ([second, first], [b, a, tangent]) } else { ([first, 0], [a, -b, tangent]) };
        let impulses = Impulses { values, ..self.carried() };
        let [a, b] = self.pair();
        Self::new([b, a], features, self.count(), impulses)
    }

    /// The record in a mirror image, for these outlines: points come in the opposite order, and the impulses along the tangent and of
    /// rolling resistance have the opposite sign. `corner` gives the number that a corner of the first (0) or second (1) collider has in
    /// the image. The result is `None` if `corner` gives `None`.
    pub(crate) fn mirrored(
        &self,
        pair: [OutlineId; 2],
        corner: impl Fn(usize, usize) -> Option<usize>,
    ) -> Option<Self> {
        let part = |feature: u32, shift: u32| (feature >> shift) as usize & 0x3F;
        let image = |feature: u32| {
            let ends =
                |side, shift| Some([corner(side, part(feature, shift + 6))?, corner(side, part(feature, shift))?]);
            // The image of an edge goes from its end to its beginning: both are counter-clockwise.
            Some(collide::feature(ends(0, 0)?, ends(1, 12)?))
        };
        let [first, second] = self.features();
        let [a, b, tangent] = self.impulses;
        let (features, values) = match self.count() {
            2 => ([image(second)?, image(first)?], [b, a, -tangent]),
            _ => ([image(first)?, 0], [a, -b, -tangent]),
        };
        Some(Self::new(pair, features, self.count(), Impulses { values, ..self.carried() }))
    }

    /// Adds all but the handles to a hash.
    pub(crate) fn write_impulses(&self, sink: &mut StateHasher) {
        sink.bytes(&self.to_bytes()[8..]);
        let parts = self.pair().map(|outline| outline.part);
        if parts != [0; 2] {
            parts.iter().for_each(|part| part.write(sink));
        }
    }

    pub(super) fn to_bytes(self) -> [u8; 40] {
        let mut bytes = [0; 40];
        let words = self.pair.iter().chain(&self.packed).map(|word| word.to_le_bytes());
        words.zip(bytes.chunks_exact_mut(4)).for_each(|(word, place)| place.copy_from_slice(&word));
        let words = self.impulses.map(i64::to_le_bytes);
        bytes[16..].copy_from_slice(words.as_flattened());
        bytes
    }

    /// Returns true if no step leaves such a record.
    fn is_malformed(&self) -> bool {
        let [first, second, _] = self.impulses;
        let is_one = self.count() == 1;
        self.pair[0] & SLOT >= self.pair[1] & SLOT
            || !(1..=2).contains(&self.count())
            || self.packed[1] >> 28 != 0
            || (0..2).any(|side| self.is_long(side) && self.high(side) == 0)
            // Rolling resistance is at most the normal impulse.
            || is_one && (second.unsigned_abs() > first.unsigned_abs() || self.features()[1] != 0)
            || first < 0
            || !is_one && second < 0
            || self.impulses.iter().any(|impulse| impulse.unsigned_abs() > 1 << 62)
    }
}

/// An exponent in the upper byte of a word.
#[inline(always)]
fn in_byte(exponent: i32) -> u32 {
    u32::from(exponent.clamp(-128, 127) as i8 as u8) << 24
}

/// The words with the upper bits of the numbers of outlines.
#[cold]
fn with_high([mut first, mut second]: [u32; 2], high: [u32; 2]) -> [u32; 2] {
    for (side, high) in high.into_iter().enumerate().filter(|(_, high)| *high > 0) {
        first |= ((high & 31) << 1 | (high >> 5) << 7) << (12 * side);
        second |= LONG[side];
    }
    [first, second]
}

/// The number of the corner of one collider in a point; `None` for an edge.
fn corner(feature: u32, side: usize) -> Option<usize> {
    seams::corner(feature, side).map(|corner| corner as usize & 0x3F)
}

/// The corners of either collider in two points; `None` if an edge is in one.
fn edges([first, second]: [u32; 2]) -> Option<[[usize; 2]; 2]> {
    let edge = |side: usize| Some([corner(first, side)?, corner(second, side)?]);
    Some([edge(0)?, edge(1)?])
}

/// Returns true if two single points of a pair have a corner in common on either outline: they are one point, as it goes on from an edge to the
/// corner at its end, or as an edge that meets it gives way to the next one. Where a body rocks from corner to corner, both corners change.
fn have_common_corner(first: u32, second: u32) -> bool {
    [0, 12].into_iter().any(|side| {
        let corners = |feature: u32| [feature >> side & 0x3F, feature >> (side + 6) & 0x3F];
        corners(first).iter().any(|corner| corners(second).contains(corner))
    })
}

impl Write for ContactRecord {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "first_collider", &self.pair[0]);
        codec::field(out, "second_collider", &self.pair[1]);
        out.enter(Part::Name("points"));
        for (k, word) in self.packed.iter().enumerate() {
            out.enter(Part::Entry(k as u32));
            codec::field(out, "feature", word);
            codec::field(out, "normal_impulse", &self.impulses[k]);
            out.leave();
        }
        out.leave();
        codec::field(out, "tangent_impulse", &self.impulses[2]);
    }
}

impl Read for ContactRecord {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a contact with impulses");
        let pair = [u32::read(reader)?, u32::read(reader)?];
        let mut packed = [0; 2];
        let mut impulses = [0; 3];
        for k in 0..2 {
            packed[k] = u32::read(reader)?;
            impulses[k] = i64::read(reader)?;
        }
        impulses[2] = i64::read(reader)?;
        let record = Self { pair, packed, impulses };
        if record.is_malformed() { Err(malformed) } else { Ok(record) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::{ManifoldPoint, feature};

    /// The name of a point at a corner of each outline.
    fn at(a: usize, b: usize) -> u32 {
        feature([a; 2], [b; 2])
    }

    /// A record of points at edges 2 to 3 and 7 to 6, with the shares of its normal impulse.
    fn record(first: i64, second: i64) -> ContactRecord {
        let pair = [OutlineId { slot: 1, part: 0 }, OutlineId { slot: 2, part: 0 }];
        let tangent = if first > 0 { -5 } else { 0 };
        let impulses = Impulses { values: [first, second, tangent], exponent: -20 };
        ContactRecord::new(pair, [at(2, 7), at(3, 6)], 2, impulses)
    }

    /// Points with these names and separations, in ulps.
    fn manifold(points: &[(u32, i64)]) -> Manifold {
        let mut manifold =
            Manifold { normal: [0, 1 << 30], count: points.len(), points: [ManifoldPoint::default(); 2] };
        for (point, &(feature, separation)) in manifold.points.iter_mut().zip(points) {
            *point = ManifoldPoint { separation: Fx::from_bits(separation), feature, ..*point };
        }
        manifold
    }

    #[test]
    fn impulses_of_points_that_are_gone_go_to_the_deepest_new_one() {
        let start = |points: &[(u32, i64)]| record(30, 10).start_at(&manifold(points)).values;
        assert_eq!(start(&[(at(2, 7), -1), (at(3, 6), -9)]), [30, 10, -5], "the same points");
        assert_eq!(start(&[(at(3, 7), -9), (at(4, 6), -1)]), [40, 0, -5], "the next edge");
        assert_eq!(start(&[(at(1, 7), -1), (at(2, 6), -9)]), [0, 40, -5], "the edge before");
        assert_eq!(start(&[(at(3, 7), -9), (at(4, 6), -9)]), [20, 20, -5], "two as deep");
        assert_eq!(start(&[(at(2, 7), -1), (at(4, 6), -9)]), [30, 10, -5], "one of two");
        assert_eq!(start(&[(at(3, 7), -9)]), [40, 0, -5], "one for two");
        assert_eq!(start(&[(at(2, 7), -9)]), [30, 0, -5], "one of two, alone");
        assert_eq!(record(1 << 62, 1 << 62).start_at(&manifold(&[(at(3, 7), -9)])).values, [1 << 62, 0, -5]);
    }

    #[test]
    fn points_stay_until_one_of_them_opens() {
        let points_of_record = |first, second| Some(manifold(&[(at(2, 7), first), (at(3, 6), second)]));
        let stay = |record: ContactRecord, points: &[(u32, i64)], points_of_record: Option<Manifold>| {
            let manifold_before = record.manifold_before(&manifold(points), |corners| {
                assert_eq!(corners, [[2, 3], [7, 6]]);
                points_of_record
            });
            manifold_before.is_some()
        };
        let next_edge = [(at(3, 7), -9), (at(4, 6), -1)];
        assert!(stay(record(30, 10), &next_edge, points_of_record(-1, -9)));
        assert!(stay(record(0, 10), &next_edge, points_of_record(-1, -9)));
        assert!(!stay(record(0, 0), &next_edge, points_of_record(-1, -9)), "nothing presses");
        assert!(!stay(record(30, 10), &next_edge, points_of_record(0, -9)), "a point is open");
        assert!(!stay(record(30, 10), &next_edge, None), "the edges do not overlap");
        assert!(
            !stay(record(30, 10), &[(at(4, 7), -9), (at(5, 6), -1)], points_of_record(-1, -9)),
            "not the next edge"
        );
        assert!(
            !stay(record(30, 10), &[(at(3, 6), -9), (at(4, 5), -1)], points_of_record(-1, -9)),
            "both edges are others"
        );
        // Corners beside each other.
        let corners = [(at(3, 7), -20)];
        assert!(stay(record(0, 10), &corners, points_of_record(5, -9)));
        assert!(!stay(record(10, 0), &corners, points_of_record(5, -9)), "the point with the impulse is open");
        assert!(!stay(record(0, 10), &[(at(4, 7), -20)], points_of_record(5, -9)), "not a corner of the edge");
    }
}
