//! The moment of the step at which the manifold of a pair is found, and what its points close up to then.
//!
//! The solver holds the normal and the arms of a contact for a step, and moves its points along rows that do not turn. Rows of the start
//! give energy to a body that turns, rows of the middle take it away: sub-steps of semi-implicit Euler, n of them, keep it with the rows
//! of the mean of their beginnings, (n − 1)/2n of the step. So manifolds are those of the free flight at this moment.
//!
//! Bodies that approach fast and did not press each other in the step before have the manifold of the moment at which their free flights
//! meet, and no contact if they do not meet: a body touches nothing that its path does not touch, and a glancing hit has the normal of the
//! touch.
//!
//! A separation at a moment becomes that of the start by the way along the row that the flights close up to then.

use super::engine::Engine;
use super::flights::FlightOf;
use super::reach::approach_bound;
use super::sweep::{self, Paths};
use super::{ContactRecord, ContactSet, MARGIN, Scene};
use crate::collide::sweep::{END, Sweep};
use crate::collide::{Manifold, Pose};
use crate::collider::{Collider, OutlineId};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, Turn};
use crate::solve::{Flight, Point};

/// Bodies that approach by less than this in a step, 4 mm, are slow: as much as gravity does to a body at rest.
const SLOW: i64 = 1 << 24;

/// The mean of the beginnings of sub-steps, in 2^-62 of the step.
pub(super) fn mean_beginning(substeps: u32) -> u64 {
    END / (2 * u64::from(substeps)) * u64::from(substeps - 1)
}

/// A part of a value, for a moment in 2^-62 of the step; rounded to nearest, ties to even: oddly.
fn part(value: Fx, moment: u64) -> Fx {
    // Not larger than the value.
    Fx::from_bits(mul_shift(value.to_bits().into(), moment.into(), 62).unwrap_or(0) as i64)
}

/// The pose of a body on its free flight.
pub(super) fn pose_at(position: Vec2<FxAccumulator>, angle: Turn, flight: &Flight, moment: u64) -> Pose {
    let moved = |from: FxAccumulator, way: Fx| from.plus(FxAccumulator::from_scalar(part(way, moment))).value();
    let position = Vec2::new(moved(position.x, flight.displacement.x), moved(position.y, flight.displacement.y));
    let rotation = part(flight.rotation, moment);
    Pose::new(position, if rotation == Fx::ZERO { angle } else { angle.turned(FxAccumulator::from_scalar(rotation)) })
}

/// The position of a body on its free flight, m.
pub(super) fn position_at(flight: &Flight, moment: u64) -> Vec2 {
    let moved = |from: Fx, way: Fx| from.saturating_add(part(way, moment));
    Vec2::new(moved(flight.position.x, flight.displacement.x), moved(flight.position.y, flight.displacement.y))
}

/// The way along a row by which a point closes up to a moment, in ulps: rows and flights of a mirror image have the same.
///
/// # Ranges
/// Displacements are below 2^61 ulps, rotations below 2^54 and arms below 2^47: with normals of 2^30 sums of products are below 2^93, and
/// times 2^-16 those of arms below 2^116.
fn closed(normal: [i32; 2], arms: [Vec2; 2], flights: [&Flight; 2], moment: u64) -> i64 {
    let [nx, ny] = normal.map(i128::from);
    let along = |flight: &Flight, arm: Vec2| {
        let bits = |value: Fx| i128::from(part(value, moment).to_bits());
        // n · (φ × r), from 2^-94 to 2^-62.
        let lever = ny * i128::from(arm.x.to_bits()) - nx * i128::from(arm.y.to_bits());
        // Oddly, as a lever changes its sign where the bodies change places.
        let turned =
            if flight.rotation == Fx::ZERO { 0 } else { lever / (1 << 16) * bits(flight.rotation) / (1 << 16) };
        nx * bits(flight.displacement.x) + ny * bits(flight.displacement.y) + turned
    };
    ((along(flights[0], arms[0]) - along(flights[1], arms[1])) >> 30) as i64
}

/// Takes a point of a moment to the start of the step.
pub(super) fn take_back(point: &mut Point, normal: [i32; 2], flights: [&Flight; 2], moment: u64) {
    if moment != 0 {
        let way = closed(normal, point.arms, flights, moment);
        point.separation = Fx::from_bits(point.separation.to_bits().saturating_add(way));
    }
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
    /// The manifold of a pair and its moment; `None` if the outlines do not meet in the step. `pressed` is true if they pressed each other
    /// in the step before.
    #[inline(always)]
    pub(super) fn meet(
        &mut self,
        scene: &Scene<'_>,
        numbers: [u32; 2],
        parts: [u32; 2],
        colliders: [&Collider; 2],
        ends: [u32; 2],
        pressed: bool,
    ) -> Option<(Manifold, u64)> {
        let kinds = ends.map(|flight| self.flights.body(flight).kind);
        let flights = ends.map(|flight| self.flights.flight(flight));
        let radii = [colliders[0].outline(parts[0]).radius, colliders[1].outline(parts[1]).radius];
        let bound = approach_bound(flights, radii);
        let is_asked = !pressed && (bound > SLOW || bound > 0 && kinds.contains(&FlightOf::Asleep));
        #[cfg(feature = "selftest")]
        let is_asked = is_asked && !self.is_discrete;
        if is_asked {
            let paths = Paths { scene, corrections: &[], is_corrected: false };
            return self.meet_on_paths(scene, numbers, parts, colliders, ends, &paths);
        }
        let manifold = self.manifold(scene, numbers, parts, colliders, ends)?;
        Some((manifold, mean_beginning(scene.settings.substeps)))
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
    ) -> Option<(Manifold, u64)> {
        let path = |side: usize| paths.path(self.flights.body(ends[side]), self.flights.flight(ends[side]), ends[side]);
        let both = [path(0), path(1)];
        let forms = [sweep::form(colliders[0], parts[0]), sweep::form(colliders[1], parts[1])];
        let pair = Sweep { forms: [&forms[0], &forms[1]], paths: [&both[0], &both[1]], is_mutual: true };
        let moment = pair.first_touch()?;
        let mut cores = [0; 2];
        for side in 0..2 {
            let outline = colliders[side].outline(parts[side]);
            cores[side] = if both[side].moves() {
                let (centre, angle) = both[side].leg(moment).0.pose(moment);
                let pose = Pose::new(Vec2::new(Fx::from_bits(centre[0]), Fx::from_bits(centre[1])), angle);
                self.push_core(scene, numbers[side], colliders[side], &outline, ends[side], &pose)
            } else {
                self.core(scene, numbers[side], colliders[side], &outline, ends[side])
            };
        }
        let manifold = self.cores.collide(cores[0], cores[1], MARGIN.into())?;
        Some((manifold, moment))
    }
}
