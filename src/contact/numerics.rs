//! The computations of contacts that depend on the scalar.

use alloc::vec::Vec;
use core::fmt::Debug;

use super::{Correction, Placed, Scene, Start, TouchPoint};
use crate::collider::{BodyOutline, Material};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::{Aabb, Outline};
use crate::solve::Impulses;

/// Shapes have a manifold from this distance on, and from what they close in the step, m.
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
    /// Adds to the flight of a moving body what it needs with contacts alone.
    fn complete(_scene: &Scene<'_, S>, _start: &Start<S>, _flight: &mut Self::Flight) {}
    /// The flight of a body that stands still.
    fn still(position: Vec2<S::Accumulator>) -> Self::Flight;

    /// Forgets all outlines and contacts, and keeps the memory.
    fn clear(&mut self);
    /// Adds the outline of a body at a pose, and returns its number: 0, 1, 2 and so on.
    fn place(&mut self, outline: &Outline<S>, pose: &Self::Pose) -> usize;
    /// A box around an outline over the step, grown by half the margin: the boxes of all that may come within the margin of each
    /// other overlap.
    fn swept(outline: &BodyOutline<S>, pose: &Self::Pose, flight: &Self::Flight) -> Aabb<Fx>;
    /// The box around an outline of a static body, grown by half the margin.
    fn resting(outline: &BodyOutline<S>, pose: &Self::Pose) -> Aabb<Fx>;
    /// The manifold of two outlines that come within the margin of each other in the step.
    fn collide(&self, cores: [usize; 2], flights: [&Self::Flight; 2], radii: [S; 2]) -> Option<Self::Manifold>;

    /// Adds the contact of two flights, with the impulses that it starts from.
    fn push(&mut self, flights: [u32; 2], manifold: &Self::Manifold, materials: [&Material<S>; 2], start: Impulses);
    /// Solves the contacts that were added, and writes the changes of the first flights, one for each of `scene.starts`.
    fn solve(&mut self, scene: &Scene<'_, S>, flights: &[Self::Flight], corrections: &mut Vec<Correction<S>>);
    /// The flights of the contacts in their order, and their impulses.
    fn contacts(&self) -> impl Iterator<Item = ([u32; 2], Impulses)> + '_;

    /// The manifold of two outlines that are near each other: the normal from the first to the second one, the points and their number.
    fn touch(a: Placed<'_, S>, b: Placed<'_, S>) -> Option<(Vec2<S>, [TouchPoint<S>; 2], usize)>;
}
