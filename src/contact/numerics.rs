//! The computations of contacts that depend on the scalar.

use alloc::vec::Vec;
use core::fmt::Debug;

use super::{Correction, Placed, Scene, Start, TouchPoint};
use crate::collide::seam::Face;
use crate::collide::sweep::Leg;
use crate::collider::{BodyOutline, Material, MaterialPair};
use crate::fx::Fx;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Scalar, Turn};
use crate::shape::{Aabb, Outline};
use crate::solve::Impulses;

/// Shapes have a manifold if they are nearer than this plus the distance by which they approach in the step, m.
pub(super) const MARGIN: Fx = crate::fx!(0.02);

/// Smaller overlaps do not wake a sleeping body, 2^-20 m: the solver pushes from 2^-22 m/s on.
pub(super) const OVERLAP: Fx = Fx::from_bits(1 << 12);

/// A manifold of one scalar.
#[doc(hidden)]
pub trait Touching {
    /// The corners that meet in its points, and the number of points.
    fn features(&self) -> ([u32; 2], usize);
    /// Returns true if two outlines overlap by more than [`OVERLAP`].
    fn is_pressed(&self) -> bool;
}

/// Two surfaces that touch.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Surface<S> {
    pub(super) coefficients: MaterialPair<S>,
    /// The radius at which one rolls on the other, m; zero if neither is round there.
    pub(super) radius: S,
    /// The velocity of the second one against the first one along the tangent, m/s.
    pub(super) speed: S,
}

/// How the points of a contact approach each other at the start of the step.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Approach<S> {
    /// The unit vector from the first to the second body.
    pub(super) normal: Vec2<S>,
    /// The positions of both bodies, m.
    pub(super) positions: [Vec2<S>; 2],
    /// By point: the speed along the normal, m/s, positive where they close.
    pub(super) speeds: [S; 2],
    /// By body and point: from the body to where the surfaces meet, m.
    pub(super) arms: [[Vec2<S>; 2]; 2],
}

impl<S: Scalar> Approach<S> {
    /// Leaves out the points that had an impulse at the end of the step before. A body that arrives in the last sub-step is slowed down
    /// there in part, and that step has reported the hit.
    pub(super) fn leave_out_pressed(&mut self, start: &Impulses) {
        for (speed, impulse) in self.speeds.iter_mut().zip(start.values) {
            if impulse > 0 {
                *speed = S::ZERO;
            }
        }
    }

    /// The speed of the faster one of the points with an impulse, and the place where it meets the other surface, as seen from this body;
    /// the middle of two points that are equally fast. `None` if no point approached.
    pub(super) fn fastest<N: Numerics<S>>(&self, total: &Impulses, side: usize) -> Option<(S, Vec2<S>)> {
        let is_hit = |&k: &usize| total.values[k] > 0 && self.speeds[k] > S::ZERO;
        let mut points = (0..2).filter(is_hit);
        let first = points.next()?;
        let arms = &self.arms[side];
        let (speed, arm) = match points.next() {
            Some(second) if self.speeds[second] > self.speeds[first] => (self.speeds[second], arms[second]),
            Some(second) if self.speeds[second] == self.speeds[first] => {
                let ([a, b], speed) = ([arms[first], arms[second]], self.speeds[first]);
                (speed, Vec2::new(N::middle(a.x, b.x), N::middle(a.y, b.y)))
            }
            _ => (self.speeds[first], arms[first]),
        };
        Some((speed, self.positions[side] + arm))
    }
}

/// Flights, outlines in world axes, manifolds and the solver of one scalar.
#[doc(hidden)]
pub trait Numerics<S: Scalar>: Debug + Default + Send + Sync {
    /// The place of a body.
    type Pose: Copy + Debug + PartialEq + Send + Sync;
    /// A body and its free flight over the step.
    type Flight: Debug + Send + Sync;
    /// A contact of two outlines.
    type Manifold: Touching;

    /// The place of a body at a position and an angle.
    fn pose(position: Vec2<S::Accumulator>, angle: S::Angle) -> Self::Pose;
    /// The flight of a moving body from a pose.
    fn moving(scene: &Scene<'_, S>, start: &Start<S>, pose: &Self::Pose) -> Self::Flight;
    /// Adds to the flight of a moving body the values that only contacts need.
    fn complete(_scene: &Scene<'_, S>, _start: &Start<S>, _flight: &mut Self::Flight) {}
    /// The flight of a body that stands still.
    fn still(position: Vec2<S::Accumulator>) -> Self::Flight;
    /// The flight of a follower: a body that moves as this one does, and that no contact moves.
    fn follower(flight: &Self::Flight, leader: u32) -> Self::Flight;

    /// Forgets all outlines and contacts, and keeps the memory.
    fn clear(&mut self);
    /// Adds the outline of a body at a pose, and returns its number: 0, 1, 2 and so on.
    fn place(&mut self, outline: &Outline<S>, pose: &Self::Pose) -> usize;
    /// Names the edges of the outline that was placed last that are on the surface among other polygons.
    fn set_faces(&mut self, faces: &[Face]);
    /// The corners of an outline of a body at a pose, relative to the position of another one near it, ulps.
    fn corners(outline: &BodyOutline<S>, pose: &Self::Pose, from: &Self::Pose) -> impl Iterator<Item = [i64; 2]>;
    /// A box around an outline over the step, grown by half the margin: two outlines that may come within the margin of each other have
    /// boxes that overlap.
    fn swept(outline: &BodyOutline<S>, pose: &Self::Pose, flight: &Self::Flight) -> Aabb<Fx>;
    /// The box around an outline of a static body, grown by half the margin.
    fn resting(outline: &BodyOutline<S>, pose: &Self::Pose) -> Aabb<Fx>;
    /// The manifold of two outlines that come within the margin of each other in the step.
    fn collide(&self, cores: [usize; 2], flights: [&Self::Flight; 2], radii: [S; 2]) -> Option<Self::Manifold>;

    /// True if the flights bring a point of a manifold to the surface of the other body, as far as the directions of the manifold say.
    fn may_close(_manifold: &Self::Manifold, _flights: [&Self::Flight; 2]) -> bool {
        false
    }
    /// True if two flights approach by more than the least way.
    fn are_fast(_flights: [&Self::Flight; 2], _radii: [S; 2]) -> bool {
        false
    }
    /// The manifold at a moment of the flights, in units of 2^-62 of the step, with the separations that its points had at the start.
    fn at_start(manifold: Self::Manifold, _flights: [&Self::Flight; 2], _at: u64) -> Self::Manifold {
        manifold
    }
    /// The cosine of the angle between the normal and a unit vector in the axes of a body at this pose.
    fn along(manifold: &Self::Manifold, pose: &Self::Pose, direction: Vec2<S>) -> S;
    /// The least separation of a point, m.
    fn least_separation(manifold: &Self::Manifold) -> S;

    /// The coefficients of two materials together, by their rules.
    fn mixed(materials: [&Material<S>; 2]) -> MaterialPair<S>;
    /// Adds the contact of two flights, with the impulses that it starts from.
    fn push(&mut self, flights: [u32; 2], manifold: &Self::Manifold, surface: &Surface<S>, start: Impulses);
    /// Solves the contacts that were added, and writes the changes of the first flights, one for each of `scene.starts`.
    fn solve(&mut self, scene: &Scene<'_, S>, flights: &[Self::Flight], corrections: &mut Vec<Correction<S>>);
    /// The number of each contact that was solved, and its impulses along the normal over the step, by point.
    fn totals(&self) -> impl Iterator<Item = (usize, Impulses)> + '_;
    /// How two bodies approach each other in a manifold.
    fn approach(manifold: &Self::Manifold, flights: [&Self::Flight; 2], time_step: TimeStep) -> Approach<S>;
    /// The mean of two numbers, halves away from zero.
    fn middle(a: S, b: S) -> S;
    /// The flights of the contacts in their order, and their impulses.
    fn contacts(&self) -> impl Iterator<Item = ([u32; 2], Impulses)> + '_;

    /// Finds contacts ahead of time or not, for tests.
    #[cfg(feature = "selftest")]
    fn set_discrete(&mut self, _is_discrete: bool) {}
    /// A value in multiples of 2^-32, rounded.
    fn ulps(value: S) -> i64;
    /// The value of this multiple of 2^-32.
    fn from_ulps(ulps: i64) -> S::Accumulator;
    /// The angle of a turn.
    fn from_turn(turn: Turn) -> S::Angle;
    /// A bound of the distance, in ulps, by which a point within `reach` of a body's centre moved from one position to the other, with what
    /// impulses added to the rotation of the free flight.
    fn moved(positions: [Vec2<S::Accumulator>; 2], flight: (&Self::Flight, Option<S::Accumulator>), reach: i64) -> i64;
    /// The path of a body from the start to a pose, with what impulses added to the rotation of the free flight.
    fn leg(
        start: &Start<S>,
        end: (Vec2<S::Accumulator>, S::Angle),
        flight: &Self::Flight,
        rotation: Option<S::Accumulator>,
    ) -> Leg;
    /// The path of a body that stands still.
    fn still_leg(position: Vec2<S::Accumulator>, angle: S::Angle) -> Leg;
    /// The part of the way from one coordinate to another, in units of 2^-62 of it.
    fn between(from: S::Accumulator, to: S::Accumulator, part: u64) -> S::Accumulator;

    /// The manifold of two outlines that are near each other: the normal from the first to the second one, the points and their number.
    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)>;
}
