//! Shapes, their mass properties, and their outlines.
//!
//! A shape is re-centred when it is made: its coordinates are relative to its centre of mass. [`Shape::shift`] is the
//! position of the centre of mass in the coordinates that were given.

mod aabb;
mod build;
mod bytes;
mod convex_parts;
mod crossing;
mod hull;
mod mass;
mod outline;
#[cfg(feature = "serde")]
mod serial;
mod to_fx;
pub(crate) mod union;

pub use aabb::Aabb;
pub use outline::Outline;
pub(crate) use outline::{Neighbour, turned_unit};

use alloc::sync::Arc;

use outline::Outlines;

use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// A shape with its centre of mass at the origin, its area, and its moment of inertia per mass. A [`ColliderDef`](crate::ColliderDef) puts
/// it on a body.
///
/// Cloning one shares its corners or parts.
///
/// ```
/// use umbra_physics::{Fx, Geometry, Part, Shape, fx, vec2};
///
/// let rod = Shape::capsule(fx!(2), fx!(0.5))?; // 2 m between the centres of its ends
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
/// let rod = Shape::segment(vec2(0, 0), vec2(3, 4))?;
/// assert_eq!(rod.measure().to_scalar(), Some(fx!(5)));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Shape<S: Scalar = Fx> {
    geometry: Geometry<S>,
    shift: Vec2<S>,
    measure: S::Factor,
    gyration: S::Factor,
    outlines: Outlines<S>,
}

impl<S: Scalar> PartialEq for Shape<S> {
    /// The other fields follow from the geometry and the coordinates in which it was given.
    fn eq(&self, other: &Self) -> bool {
        self.shift == other.shift && self.geometry == other.geometry
    }
}

/// The geometry of a shape, in coordinates relative to its centre of mass.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Geometry<S: Scalar = Fx> {
    /// A disc.
    Circle {
        /// The radius, m.
        radius: S,
    },
    /// A rectangle along the axes.
    Rectangle {
        /// The extent along x, m.
        width: S,
        /// The extent along y, m.
        height: S,
    },
    /// A rectangle along x with half discs at its ends.
    Capsule {
        /// The distance between the centres of the half discs, m.
        length: S,
        /// The radius of the half discs, m.
        radius: S,
    },
    /// A convex polygon.
    Polygon {
        /// The corners, counter-clockwise, m.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        corners: Arc<[Vec2<S>]>,
    },
    /// A thin rod.
    Segment {
        /// The ends, m.
        ends: [Vec2<S>; 2],
    },
    /// Several shapes in one.
    Compound {
        /// The parts, placed relative to the centre of mass of the compound.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        parts: Arc<[Part<S>]>,
    },
    /// A convex polygon with a radius around it.
    RoundedPolygon {
        /// The corners of the polygon, counter-clockwise, m.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        corners: Arc<[Vec2<S>]>,
        /// The radius around the polygon, m.
        radius: S,
    },
    /// A chain of segments, each of which touches only bodies on its right: see [`Shape::chain`].
    Chain {
        /// The points, m.
        #[cfg_attr(feature = "serde", serde(serialize_with = "serial::all"))]
        points: Arc<[Vec2<S>]>,
        /// True if a segment joins the last point to the first one.
        closed: bool,
    },
}

/// A part of a compound.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Part<S: Scalar = Fx> {
    /// The shape of the part, which is no compound itself.
    pub shape: Shape<S>,
    /// The position of its centre of mass, m.
    pub position: Vec2<S>,
    /// The angle that it is turned by, rad.
    pub angle: S,
    /// The density, relative to the densities of the other parts.
    pub density: S,
}

impl<S: Scalar> Shape<S> {
    /// The geometry, relative to the centre of mass.
    #[must_use]
    pub fn geometry(&self) -> &Geometry<S> {
        &self.geometry
    }

    /// The convex outlines that it consists of: one for each part of a compound or segment of a chain in their order, else one.
    #[must_use]
    pub fn outlines(&self) -> &[Outline<S>] {
        self.outlines.as_slice()
    }

    /// The outlines turned by an angle in radians, and then moved. *Domain* the angle is finite, positions are within 2^13 m.
    pub(crate) fn outlines_at(&self, angle: S, position: Vec2<S>) -> impl ExactSizeIterator<Item = Outline<S>> + '_ {
        self.outlines.at(angle, position)
    }

    /// Returns true for a chain, which only static and kinematic bodies have.
    pub(crate) fn is_chain(&self) -> bool {
        matches!(self.geometry, Geometry::Chain { .. })
    }

    /// The least box around the shape, relative to its centre of mass, as long as the shape is not turned.
    #[must_use]
    pub fn bounds(&self) -> Aabb<S> {
        let first = self.outlines()[0].bounds();
        self.outlines().iter().fold(first, |bounds, outline| bounds.union(outline.bounds()))
    }

    /// The position of the centre of mass in the coordinates that were given, m; each component is rounded to nearest. *Error* ½ ulp; 1.1
    /// ulp for a rounded polygon.
    #[must_use]
    pub fn shift(&self) -> Vec2<S> {
        self.shift
    }

    /// The area in m²; for a segment the length in m; for a compound the sum of area times density over its parts.
    /// *Error* 2^-61 relative.
    #[must_use]
    pub fn measure(&self) -> S::Factor {
        self.measure
    }

    /// The moment of inertia about the centre of mass per mass, m². *Error* 2^-58 relative; 2 square ulps more for a rounded polygon.
    #[must_use]
    pub fn gyration(&self) -> S::Factor {
        self.gyration
    }
}
