//! Outlines of colliders in the axes of their bodies.

use core::ops::Deref;

use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::{Aabb, Outline};

/// An outline of a collider in the axes of its body, relative to the body's centre of mass.
#[derive(Clone, Debug)]
pub(crate) struct BodyOutline<S: Scalar = Fx> {
    pub(crate) outline: Outline<S>,
    /// The least box around the corners of the outline.
    pub(crate) corners: Aabb<S>,
    /// The largest distance of a point of the outline from the body's centre of mass, m, rounded up.
    pub(crate) radius: S,
    /// The least distance of two parallel lines that the outline is between, m.
    pub(crate) width: S,
    /// True for a rectangle around the centre of mass that is not turned: `corners` says all of it.
    pub(crate) is_upright: bool,
}

/// An outline of a collider, kept or made.
pub(crate) enum OutlineRef<'a, S: Scalar> {
    Kept(&'a BodyOutline<S>),
    Made(BodyOutline<S>),
}

impl<S: Scalar> Deref for OutlineRef<'_, S> {
    type Target = BodyOutline<S>;

    #[inline(always)]
    fn deref(&self) -> &BodyOutline<S> {
        match self {
            Self::Kept(outline) => outline,
            Self::Made(outline) => outline,
        }
    }
}

/// The first two normals of a rectangle that is not turned.
fn upright_normals<S: Scalar>() -> [Vec2<S>; 2] {
    [Vec2::new(S::ZERO, -S::ONE), Vec2::new(S::ONE, S::ZERO)]
}

impl<S: Scalar> BodyOutline<S> {
    pub(super) fn new(outline: Outline<S>) -> Self {
        let corners = Aabb::around(outline.corners(), S::ZERO);
        let radius = outline.reach();
        let width = outline.width();
        let Aabb { min, max } = corners;
        let is_upright = outline.corners() == [min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)]
            && outline.normals().first_chunk() == Some(&upright_normals())
            && (min.x, min.y) == (-max.x, -max.y);
        Self { outline, corners, radius, width, is_upright }
    }
}
