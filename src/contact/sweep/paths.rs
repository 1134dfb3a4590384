//! The paths of bodies over a tick, as impulses left them.

use super::super::flights::{FlightKind, Flights};
use super::super::{Correction, Scene, Stop};
use super::{Course, legs};
use crate::body::{BodyKind, Locks};
use crate::collide::sweep::{END, Leg, ends};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator};
use crate::shape::Aabb;

/// The least motion that counts, ulps: 2^-12 m.
const MIN_MOTION: i64 = 1 << 20;

/// The growth of boxes, ulps: more than rounding errors may take away.
const GROWTH: i64 = 1 << 14;

/// The paths of bodies after impulses.
pub(crate) struct Paths<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) corrections: &'a [Correction],
    /// True if the bodies of the scene are where the corrections left them; else they are at the ends of their free flights.
    pub(crate) is_corrected: bool,
}

impl Paths<'_> {
    /// The path of a body that does not end early, in one piece.
    pub(in super::super) fn leg(&self, flights: &Flights, flight: u32) -> Leg {
        let bodies = self.scene.bodies;
        let Some(start) = self.scene.starts.get(flight as usize) else {
            let dense = bodies.index_in(flights.body(flight).slot).unwrap_or(0);
            return legs::resting(bodies.position(dense), bodies.angle(dense));
        };
        let correction = self.corrections.get(flight as usize);
        let mut position = bodies.position(start.dense);
        let mut angle = bodies.angle(start.dense);
        if let Some(correction) = correction.filter(|_| !self.is_corrected) {
            let shift = correction.displacement;
            position = Vec2::new(position.x.plus(shift.x), position.y.plus(shift.y));
            angle = angle.turned(correction.rotation);
        }
        let rotation = correction.map(|correction| correction.rotation);
        legs::leg(start, position, angle, flights.flight(flight), rotation)
    }

    /// Returns true for a dynamic body without impulses.
    pub(super) fn is_free(&self, flights: &Flights, flight: u32) -> bool {
        let is_pushed = self.corrections.get(flight as usize).is_some_and(|correction| correction.is_pushed);
        flights.body(flight).kind == FlightKind::Dynamic && !is_pushed
    }

    /// Returns true if a point within `reach` of the centre of a moving body moved more than a quarter of a width, both in ulps.
    pub(super) fn is_fast(&self, flights: &Flights, flight: u32, reach: i64, width: i64) -> bool {
        let start = &self.scene.starts[flight as usize];
        let rotation = self.corrections.get(flight as usize).map(|correction| correction.rotation);
        let ends = [start.position, self.scene.bodies.position(start.dense)];
        legs::moved(ends, flights.flight(flight), rotation, reach) > (width >> 2).max(MIN_MOTION)
    }

    /// The pose at the end of a path that ended early.
    pub(super) fn stop(&self, course: &Course) -> Stop {
        let start = &self.scene.starts[course.flight as usize];
        let (centre, angle) = course.path.last().pose(END);
        let position = match course.path.stopped_at() {
            Some(at) => {
                let end = self.scene.bodies.position(start.dense);
                Vec2::new(legs::between(start.position.x, end.x, at), legs::between(start.position.y, end.y, at))
            }
            None => {
                let [x, y] = centre.map(|part| FxAccumulator::from_scalar(Fx::from_bits(part)));
                Vec2::new(x, y)
            }
        };
        let at = course.path.stopped_at();
        let is_stuck = at == Some(0) && course.is_stuck;
        Stop { dense: start.dense, start: course.flight as usize, position, angle, at, is_stuck }
    }

    pub(super) fn is_kinematic(&self, slot: u32) -> bool {
        let bodies = self.scene.bodies;
        bodies.index_in(slot).is_some_and(|dense| bodies.contact_info(dense).kind == BodyKind::Kinematic)
    }

    pub(super) fn is_locked(&self, slot: u32) -> bool {
        let bodies = self.scene.bodies;
        bodies.index_in(slot).is_some_and(|dense| bodies.locks(dense) != Locks::NONE)
    }
}

/// The box around an outline of this reach on the pieces of a path.
pub(in super::super) fn around(legs: &[Leg], reach: i64) -> Aabb<Fx> {
    let (low, high) = ends(legs);
    let growth = reach.saturating_add(GROWTH);
    let shifted = |corner: [i64; 2], shift: i64| {
        let [x, y] = corner.map(|part| Fx::from_bits(part.saturating_add(shift)));
        Vec2::new(x, y)
    };
    Aabb { min: shifted(low, -growth), max: shifted(high, growth) }
}
