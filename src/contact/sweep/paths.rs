//! The paths of bodies over a tick, as impulses left them.

use super::super::flights::Place;
use super::super::numerics::Numerics;
use super::super::{Correction, Scene, Stop};
use super::Course;
use crate::body::{BodyKind, Locks};
use crate::collide::sweep::{END, Path};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::Aabb;

/// Boxes are grown by this, ulps: more than what rounding may take.
const GROWTH: i64 = 1 << 14;

/// The paths of bodies after impulses.
pub(in super::super) struct Paths<'a, S: Scalar> {
    pub(in super::super) scene: &'a Scene<'a, S>,
    pub(in super::super) corrections: &'a [Correction<S>],
}

impl<S: Scalar> Paths<'_, S> {
    pub(in super::super) fn path<N: Numerics<S>>(&self, place: &Place<N::Pose>, of: &N::Flight, flight: u32) -> Path {
        let motion = &self.scene.bodies.columns.motion;
        let Some(start) = self.scene.starts.get(flight as usize) else {
            let dense = self.scene.bodies.index_in(place.slot).unwrap_or(0);
            return Path::new(N::still_leg(motion.position.get(dense), motion.angle[dense]));
        };
        let rotation = self.corrections.get(flight as usize).map(|by| by.rotation);
        let end = (motion.position.get(start.dense), motion.angle[start.dense]);
        Path::new(N::leg(start, end, of, rotation))
    }

    /// The pose at the end of a path that ended early.
    pub(super) fn stop<N: Numerics<S>>(&self, course: &Course) -> Stop<S> {
        let start = &self.scene.starts[course.flight as usize];
        let (position, angle) = match course.path.stopped_at() {
            Some(at) => {
                let end = self.scene.bodies.columns.motion.position.get(start.dense);
                let (_, angle) = course.path.last().pose(END);
                (
                    [0, 1].map(|k| {
                        let [from, to] = [start.position, end].map(|v| if k == 0 { v.x } else { v.y });
                        N::between(from, to, at)
                    }),
                    angle,
                )
            }
            None => {
                let (at, angle) = course.path.last().pose(END);
                (at.map(N::from_ulps), angle)
            }
        };
        let is_held = course.path.stopped_at() == Some(0);
        Stop {
            dense: start.dense,
            position: Vec2::new(position[0], position[1]),
            angle: N::from_turn(angle),
            is_held,
            is_stuck: is_held && course.is_stuck,
        }
    }

    pub(super) fn is_bullet(&self, slot: u32) -> bool {
        let bodies = self.scene.bodies;
        bodies.index_in(slot).is_some_and(|dense| bodies.info(dense).is_bullet)
    }

    pub(super) fn is_kinematic(&self, slot: u32) -> bool {
        let bodies = self.scene.bodies;
        bodies.index_in(slot).is_some_and(|dense| bodies.info(dense).kind == BodyKind::Kinematic)
    }

    pub(super) fn is_locked(&self, slot: u32) -> bool {
        let bodies = self.scene.bodies;
        bodies.index_in(slot).is_some_and(|dense| bodies.mass(dense).locks != Locks::NONE)
    }
}

/// The box around an outline of this reach on a path.
pub(super) fn around(path: &Path, reach: i64) -> Aabb<Fx> {
    let (low, high) = path.ends();
    let by = reach.saturating_add(GROWTH);
    let at = |ends: [i64; 2], by: i64| {
        let [x, y] = ends.map(|end| Fx::from_bits(end.saturating_add(by)));
        Vec2::new(x, y)
    };
    Aabb { min: at(low, -by), max: at(high, by) }
}
