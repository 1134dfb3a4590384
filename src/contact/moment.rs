//! The moment of the step at which the manifold of a pair is found, and the distance that its points close up to then.
//!
//! The solver holds the normal and the arms of a contact for a step, and moves its points along rows that do not turn. Rows of the start
//! give energy to a body that turns, rows of the middle take it away: sub-steps of semi-implicit Euler, n of them, keep it with the rows
//! of the mean of their beginnings, (n − 1)/2n of the step. So manifolds are found at the poses to which the velocities of the start lead up
//! to then: a body that another one carries does not fall. Bodies that go from tile to tile, or from segment to segment, have these too.
//!
//! Bodies that approach fast and did not press each other in the step before have the manifold of the moment at which their free flights
//! meet, and no contact if they do not meet: a body touches nothing that its path does not touch, and a glancing hit has the normal of the
//! touch.
//!
//! A separation at a moment becomes the separation at the start by the way along the row that the bodies close up to then.

use core::slice::from_ref;

use super::engine::Engine;
use super::flights::FlightOf;
use super::reach::approach_bound;
use super::seams::Union;
use super::sweep::{self, Paths};
use super::tiles::{SLANTED, are_joined};
use super::{ContactRecord, ContactSet, MARGIN, Scene, Start};
use crate::collide::sweep::{Second, Sweep};
use crate::collide::{Manifold, Pose};
use crate::collider::{Collider, OutlineId};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, Turn};
use crate::solve::{Flight, Point};

/// Bodies that approach by less than this in a step, 4 mm, are slow: as much as gravity does to a body at rest.
const SLOW: i64 = 1 << 24;

/// Surfaces are level that turn by less than 2.5°: its cosine, in 2^-60.
const LEVEL: i64 = (1 << 60) - (1 << 50);

/// The length of a step, in 2^-48 s.
pub(super) fn length(time_step: TimeStep) -> u64 {
    let (num, den) = time_step.seconds();
    // Steps are shorter than 2^15 s.
    ((u128::from(num) << 48) / u128::from(den)) as u64
}

/// The moment of the manifolds of bodies that press each other, in 2^-48 s.
pub(super) fn mean_beginning(time_step: TimeStep, substeps: u32) -> u64 {
    length(time_step) / (2 * u64::from(substeps)) * u64::from(substeps - 1)
}

/// A part of a value, for a moment in 2^-62 of the step; rounded to nearest, ties to even: oddly.
fn part(value: Fx, moment: u64) -> Fx {
    // Not larger than the value.
    Fx::from_bits(mul_shift(value.to_bits().into(), moment.into(), 62).unwrap_or(0) as i64)
}

/// The way of a body from the start of a step to the moment of a manifold.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// m
    pub(super) displacement: Vec2,
    /// rad
    rotation: Fx,
}

impl Way {
    /// The way at the velocity of the start, up to a time in 2^-48 s: a body that something carries does not fall.
    pub(super) fn steady(start: &Start, time: u64) -> Self {
        // Velocities are below 2^21 m/s: ways are below 2^36 m. Rounded to nearest, ties to even: oddly.
        let way = |velocity: FxAccumulator| {
            let way = mul_shift(velocity.value().to_bits().into(), time.into(), 48).unwrap_or(0);
            Fx::from_bits(way.clamp(i64::MIN.into(), i64::MAX.into()) as i64)
        };
        Self { displacement: start.velocity.map(way), rotation: way(start.angular_velocity) }
    }

    /// The way on a flight up to a moment.
    pub(super) fn along(flight: &Flight, moment: u64) -> Self {
        Self { displacement: flight.displacement.map(|way| part(way, moment)), rotation: part(flight.rotation, moment) }
    }

    /// The same way without the rotation.
    pub(super) fn without_rotation(self) -> Self {
        Self { rotation: Fx::ZERO, ..self }
    }

    /// The pose at its end.
    pub(super) fn pose(&self, position: Vec2<FxAccumulator>, angle: Turn) -> Pose {
        let moved = |from: FxAccumulator, way: Fx| from.plus(FxAccumulator::from_scalar(way)).value();
        let position = Vec2::new(moved(position.x, self.displacement.x), moved(position.y, self.displacement.y));
        let turned = |angle: Turn| angle.turned(FxAccumulator::from_scalar(self.rotation));
        Pose::new(position, if self.rotation == Fx::ZERO { angle } else { turned(angle) })
    }

    /// The position at its end, m.
    pub(super) fn position(&self, start: Vec2) -> Vec2 {
        let moved = |from: Fx, way: Fx| from.saturating_add(way);
        Vec2::new(moved(start.x, self.displacement.x), moved(start.y, self.displacement.y))
    }

    /// n·(d + φ × r): the way of a point of the body along a normal, in 2^-62 m.
    ///
    /// # Ranges
    /// Displacements are below 2^61 ulps, rotations below 2^54 and arms below 2^47: with normals of 2^30 sums of products are below 2^93,
    /// and times 2^-16 the products with arms below 2^116.
    fn along_row(&self, normal: [i32; 2], arm: Vec2) -> i128 {
        let [nx, ny] = normal.map(i128::from);
        let bits = |value: Fx| i128::from(value.to_bits());
        let straight = nx * bits(self.displacement.x) + ny * bits(self.displacement.y);
        if self.rotation == Fx::ZERO {
            return straight;
        }
        // From 2^-94 to 2^-62; oddly, as a lever changes its sign where the bodies change places.
        let lever = ny * bits(arm.x) - nx * bits(arm.y);
        straight + lever / (1 << 16) * bits(self.rotation) / (1 << 16)
    }
}

/// Takes a point of the moment at the end of these ways to the start of the step, along its row: a mirror image has the same separation.
pub(super) fn take_back(point: &mut Point, normal: [i32; 2], ways: &[Way; 2]) {
    let [a, b] = [0, 1].map(|side: usize| ways[side].along_row(normal, point.arms[side]));
    point.separation = Fx::from_bits(point.separation.to_bits().saturating_add(((a - b) >> 30) as i64));
}

impl ContactSet {
    /// Returns true if one outline of a pair is a segment of a chain, and the other one pressed a segment near it in the step before: a body
    /// that rolls from segment to segment touches the next one as it touched the last one.
    pub(super) fn presses_nearby(&self, pair: [OutlineId; 2], colliders: [&Collider; 2]) -> bool {
        /// Segments on both sides.
        const NEAR: u32 = 4;
        let Some(side) = (0..2).find(|&side| colliders[side].def.shape.is_chain()) else { return false };
        let part = pair[side].part;
        (part.saturating_sub(NEAR)..=part.saturating_add(NEAR)).any(|part| {
            let mut neighbours = pair;
            neighbours[side].part = part;
            let record = self.records.binary_search_by_key(&neighbours, ContactRecord::pair);
            record.is_ok_and(|index| !self.records[index].is_slack())
        })
    }
}

impl Engine {
    /// The manifold of a pair and the ways up to its moment; `None` if the outlines do not meet in the step. `pressed` is true if they
    /// pressed each other in the step before.
    #[inline(always)]
    pub(super) fn meet(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
        colliders: [&Collider; 2],
        ends: [u32; 2],
        contacts: &ContactSet,
        pressed: bool,
    ) -> Option<(Manifold, [Way; 2])> {
        let kinds = ends.map(|flight| self.flights.body(flight).kind);
        let flights = ends.map(|flight| self.flights.flight(flight));
        let parts = pair.map(|outline| outline.part);
        let radii = [colliders[0].outline(parts[0]).radius, colliders[1].outline(parts[1]).radius];
        let bound = approach_bound(flights, radii);
        let is_asked = !pressed && (bound > SLOW || bound > 0 && kinds.contains(&FlightOf::Asleep));
        #[cfg(feature = "selftest")]
        let is_asked = is_asked && !self.is_discrete;
        let ways = ends.map(|flight| self.flights.body(flight).way);
        if !is_asked || contacts.presses_nearby(pair, colliders) {
            return Some((self.manifold(scene, numbers, parts, colliders, ends)?, ways));
        }
        let may_be_tile = |side: usize| kinds[side] == FlightOf::Static || colliders[side].has_others();
        if may_be_tile(0) || may_be_tile(1) {
            let mean = self.manifold(scene, numbers, parts, colliders, ends);
            if let Some(manifold) = mean {
                if self.comes_over_seams(scene, numbers, pair, colliders, contacts, &manifold, SLANTED) {
                    return Some((manifold, ways));
                }
            }
        }
        let paths = Paths { scene, corrections: &[], is_corrected: false };
        let (manifold, ways) = self.meet_on_paths(scene, numbers, parts, colliders, ends, &paths)?;
        // A body does not meet a tile of a level surface before it arrives there.
        let is_later = self.comes_over_seams(scene, numbers, pair, colliders, contacts, &manifold, LEVEL);
        (!is_later).then_some((manifold, ways))
    }

    /// Returns true if an outline of a pair pressed a tile beside the other one in the step before, and the surface goes on from tile to
    /// tile where they touch, at an angle of up to this cosine: a body that slides from tile to tile touches the next one as it touched the
    /// last one.
    fn comes_over_seams(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        pair: [OutlineId; 2],
        colliders: [&Collider; 2],
        contacts: &ContactSet,
        manifold: &Manifold,
        cosine: i64,
    ) -> bool {
        let features = (manifold.features(), manifold.count);
        for side in 0..2 {
            if self.faces(scene, numbers[side]).is_empty() {
                continue;
            }
            let Some(union) = Union::of(scene, colliders[side]) else { continue };
            for i in self.unions.find(scene, contacts, union, pair[1 - side], 0..=u32::MAX) {
                let record = contacts.records[self.unions.record(i)];
                // A body may be the first of its pair with one tile, and the second of its pair with the next tile.
                let record = if record.pair()[1 - side] == pair[1 - side] { record } else { record.swapped() };
                let before = record.pair();
                let mut numbers_before = numbers;
                numbers_before[side] = self.resting.numbers.first(before[side].slot) + before[side].part;
                // The surface of a tile is known once the tile is placed.
                _ = self.mean_manifold(scene, numbers_before, before);
                let faces = [numbers[side], numbers_before[side]].map(|number| self.faces(scene, number));
                if are_joined(faces, side, features, &record, cosine) {
                    return true;
                }
            }
        }
        false
    }

    /// [`meet`](Self::meet) for the moment at which these paths meet.
    pub(super) fn meet_on_paths(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        parts: [u32; 2],
        colliders: [&Collider; 2],
        ends: [u32; 2],
        paths: &Paths<'_>,
    ) -> Option<(Manifold, [Way; 2])> {
        let legs = ends.map(|flight| self.leg(paths, flight));
        let outlines = [colliders[0].outline(parts[0]), colliders[1].outline(parts[1])];
        let reach = outlines[0].radius.saturating_add(outlines[1].radius);
        if legs[0].stays_apart(&legs[1], reach.to_bits()) {
            return None;
        }
        let forms = [sweep::form(colliders[0], &outlines[0]), sweep::form(colliders[1], &outlines[1])];
        let paths = [from_ref(&legs[0]), from_ref(&legs[1])];
        let sweep = Sweep { forms: [&forms[0], &forms[1]], paths, second: Second::GivesWay };
        let moment = sweep.first_touch(&mut self.sweep.moments[0])?;
        let mut cores = [0; 2];
        for side in 0..2 {
            let outline = &outlines[side];
            cores[side] = if legs[side].moves() {
                let (centre, angle) = legs[side].pose(moment);
                let pose = Pose::new(Vec2::new(Fx::from_bits(centre[0]), Fx::from_bits(centre[1])), angle);
                self.push_core(scene, numbers[side], outline, ends[side], &pose)
            } else {
                self.core(scene, numbers[side], outline, ends[side])
            };
        }
        let ways = ends.map(|flight| Way::along(&self.flights.deflected(flight), moment));
        let manifold = self.cores.collide(cores[0], cores[1], MARGIN.into())?;
        Some((manifold, ways))
    }
}
