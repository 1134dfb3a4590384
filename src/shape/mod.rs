//! Shapes and the mass properties that follow from them.
//!
//! A shape is re-centred when it is made: its coordinates are relative to its centre of mass, and [`Shape::shift`] says
//! where that was in the coordinates given.

mod build;
mod bytes;
mod mass;
#[cfg(feature = "serde")]
mod serial;

use alloc::sync::Arc;

use crate::math::Vec2;
use crate::scalar::{Scalar, fx::Fx};

/// A shape with its centre of mass at the origin, its area, and its moment of inertia per mass.
///
/// Cloning one shares its corners or parts.
///
/// ```
/// use umbra_physics::{Fx, Geometry, Part, Shape, fx, vec2};
///
/// let rod: Shape = Shape::capsule(fx!(2), fx!(0.5))?; // 2 m between the centres of its ends
/// let weight = Shape::rectangle(fx!(1), fx!(1))?;
/// let part = |shape: &Shape, x: i32, density: Fx| Part {
///     shape: shape.clone(),
///     position: vec2(x, 0),
///     angle: fx!(0),
///     density,
/// };
/// // The head has seven times the density of the handle: the centre of mass is near it.
/// let hammer = Shape::compound(&[part(&rod, 0, fx!(1)), part(&weight, 2, fx!(7))])?;
/// assert_eq!(format!("{:.3}", hammer.shift()), "(1.431, 0.000)");
/// let Geometry::Compound { parts } = hammer.geometry() else { unreachable!() };
/// assert_eq!(format!("{:.3}", parts[1].position.x), "0.569"); // from there
///
/// // Area in m² (here times the density), and inertia to a kilogram, m².
/// assert_eq!(weight.measure().to_scalar(), Some(fx!(1)));
/// assert_eq!(weight.gyration().to_scalar(), Some(Fx::from_ratio(1, 6)));
/// // A thin rod: its measure is its length.
/// let rod: Shape = Shape::segment(vec2(0, 0), vec2(3, 4))?;
/// assert_eq!(rod.measure().to_scalar(), Some(fx!(5)));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Shape<S: Scalar = Fx> {
    geometry: Geometry<S>,
    shift: Vec2<S>,
    measure: S::Factor,
    gyration: S::Factor,
    /// A hash of its bytes, by which worlds keep shapes that are alike once.
    digest: u64,
}

/// What a shape looks like, in coordinates relative to its centre of mass.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Geometry<S: Scalar = Fx> {
    /// A disc.
    Circle {
        /// Its radius, m.
        radius: S,
    },
    /// A rectangle along the axes.
    Rectangle {
        /// Its extent along x, m.
        width: S,
        /// Its extent along y, m.
        height: S,
    },
    /// A rectangle along x with half discs at its ends.
    Capsule {
        /// Between the centres of the half discs, m.
        length: S,
        /// Of the half discs, m.
        radius: S,
    },
    /// A convex polygon.
    Polygon {
        /// Its corners, counter-clockwise.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        corners: Arc<[Vec2<S>]>,
    },
    /// A thin rod.
    Segment {
        /// Its ends.
        ends: [Vec2<S>; 2],
    },
    /// Several shapes in one.
    Compound {
        /// Its parts, placed relative to the centre of mass of the whole.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        parts: Arc<[Part<S>]>,
    },
}

/// A part of a compound.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Part<S: Scalar = Fx> {
    /// Its shape; parts are not compounds themselves.
    pub shape: Shape<S>,
    /// Where its centre of mass is, m.
    pub position: Vec2<S>,
    /// How far it is turned, rad.
    pub angle: S,
    /// Its density relative to the other parts.
    pub density: S,
}

impl<S: Scalar> Shape<S> {
    /// What it looks like.
    #[must_use]
    pub fn geometry(&self) -> &Geometry<S> {
        &self.geometry
    }

    /// Where its centre of mass was in the coordinates it was given in, m; each rounded to nearest.
    #[must_use]
    pub fn shift(&self) -> Vec2<S> {
        self.shift
    }

    /// Its area in m²; for a segment its length in m; for a compound the sum over its parts of density times that.
    /// *Error* 2^-61 relative.
    #[must_use]
    pub fn measure(&self) -> S::Factor {
        self.measure
    }

    pub(crate) fn digest(&self) -> u64 {
        self.digest
    }

    /// Its moment of inertia about the centre of mass per mass, m². *Error* 2^-58 relative.
    #[must_use]
    pub fn gyration(&self) -> S::Factor {
        self.gyration
    }
}
