//! The narrow phase where bodies go over seams: from segment to segment of a chain, or from tile to tile of a surface.
//!
//! Reads: records of the step before, the surfaces of outlines. Writes: the impulses that contacts at a seam start from.

use super::super::flights::{Flights, PairSide};
use super::super::resting::Resting;
use super::super::seams::{self, Union, corners, take_over};
use super::super::tiles::{SLANTED, are_joined};
use super::super::{ContactRecord, Scene};
use super::Narrow;
use crate::collide::Manifold;
use crate::solve::Impulses;

/// Returns true if one outline of a pair is a segment of a chain, and the other one pressed a segment near it in the step before: a body that
/// rolls from segment to segment touches the next one as it touched the last one.
pub(super) fn presses_nearby(scene: &Scene<'_>, pair: [&PairSide<'_>; 2]) -> bool {
    /// Segments on both sides.
    const NEAR: u32 = 4;
    let Some(side) = (0..2).find(|&side| pair[side].collider.def.shape.is_chain()) else { return false };
    let records = &scene.contacts.records;
    let part = pair[side].id.part;
    (part.saturating_sub(NEAR)..=part.saturating_add(NEAR)).any(|part| {
        let mut neighbours = pair.map(|side| side.id);
        neighbours[side].part = part;
        let record = records.binary_search_by_key(&neighbours, ContactRecord::pair);
        record.is_ok_and(|index| !records[index].is_slack())
    })
}

impl Narrow {
    /// Returns true if an outline of a pair has a surface, which is known once the outline is placed.
    pub(super) fn have_faces(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
    ) -> bool {
        pair.into_iter().for_each(|side| _ = self.core(scene, flights, resting, side));
        pair.into_iter().any(|side| !self.faces(scene, side).is_empty())
    }

    /// Returns true if an outline of a pair pressed a tile beside the other one in the step before, and the surface goes on from tile to
    /// tile where they touch, at an angle of up to this cosine: a body that slides from tile to tile touches the next one as it touched the
    /// last one.
    pub(super) fn comes_over_seams(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
        manifold: &Manifold,
        cosine: i64,
    ) -> bool {
        let features = &manifold.features()[..manifold.count];
        for side in 0..2 {
            if self.faces(scene, pair[side]).is_empty() {
                continue;
            }
            let Some(union) = Union::of(scene, pair[side].collider) else { continue };
            let outline = pair[1 - side].id;
            for i in self.unions.find(scene, &self.actors, &resting.numbers, union, outline, 0..=u32::MAX) {
                let record = self.unions.record(scene, i, 1 - side, outline);
                let Some(tile_before) =
                    flights.side(scene, &resting.numbers, resting.numbers.number(record.pair()[side]))
                else {
                    continue;
                };
                let mut pair_before = pair;
                pair_before[side] = &tile_before;
                // The surface of a tile is known once the tile is placed.
                _ = self.mean_manifold(scene, flights, resting, pair_before);
                let faces = [self.faces(scene, pair[side]), self.faces(scene, &tile_before)];
                if are_joined(faces, side, features, &record, cosine) {
                    return true;
                }
            }
        }
        false
    }

    /// For a contact with a segment of a chain, or with a polygon among others: adds the impulses that its points had with other segments or
    /// polygons to the impulses that it starts from. The surface is at this side of the pair.
    #[cold]
    pub(in super::super) fn start_over_seams(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
        side: usize,
        manifold: &Manifold,
        start: &mut Impulses,
    ) {
        let features = &manifold.features()[..manifold.count];
        let body_side = 1 - side;
        let Some(union) = Union::of(scene, pair[side].collider) else { return };
        let mut terms = core::mem::take(&mut self.unions.terms);
        terms.clear();
        let mut first_corner = None;
        for corner in corners(features, body_side) {
            let outline = pair[body_side].id;
            for i in self.unions.find(scene, &self.actors, &resting.numbers, union, outline, corner..=corner) {
                let record = self.unions.record(scene, i, body_side, outline);
                let outline_before = record.pair()[side];
                let record_features = record.features();
                let mut record_corners = corners(&record_features[..record.count()], body_side);
                let is_repeated = first_corner.is_some_and(|first| record_corners.any(|corner| corner == first));
                if outline_before == pair[side].id || is_repeated {
                    continue;
                }
                let Some(side_before) = flights.side(scene, &resting.numbers, resting.numbers.number(outline_before))
                else {
                    continue;
                };
                let mut pair_before = pair;
                pair_before[side] = &side_before;
                let manifold_before = self.mean_manifold(scene, flights, resting, pair_before);
                let is_joined = matches!(union, Union::Chain(_)) || {
                    let faces = [self.faces(scene, pair[side]), self.faces(scene, &side_before)];
                    are_joined(faces, side, features, &record, SLANTED)
                };
                if is_joined {
                    let (kept, count) = manifold_before.map_or(([0; 2], 0), |before| (before.features(), before.count));
                    take_over(&mut terms, features, &record, &kept[..count], body_side);
                }
            }
            first_corner = Some(corner);
        }
        seams::add(start, &terms);
        self.unions.terms = terms;
    }
}
