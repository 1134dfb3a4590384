//! Shapes for serde. A shape is written as the arguments that it was made from; reading calls the constructor again, with
//! all its checks.
//!
//! For `Fx` it is the same shape to the bit. A corner lies at its own coordinates less the shift, both within 2^13 m, so that
//! the difference is exact, and so is the sum that is written; from the same corners the same sums follow, and the same shift.

use alloc::sync::Arc;
use alloc::vec::Vec;

use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, Serializer};

use super::{Geometry, Part, Shape};
use crate::error::Error;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// The items of a shared list.
pub(super) fn all<T: Serialize, W: Serializer>(items: &Arc<[T]>, serializer: W) -> Result<W::Ok, W::Error> {
    items.as_ref().serialize(serializer)
}

/// The arguments that a shape is made from; `P` is the type of a compound's parts.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Shape", rename_all = "snake_case", deny_unknown_fields)]
enum Spec<S, P> {
    Circle { radius: S },
    Rectangle { width: S, height: S },
    Capsule { length: S, radius: S },
    Polygon { corners: Vec<Vec2<S>> },
    Segment { ends: [Vec2<S>; 2] },
    Compound { parts: Vec<P> },
    // Added later: formats that number the kinds read older data.
    RoundedPolygon { corners: Vec<Vec2<S>>, radius: S },
    Chain { points: Vec<Vec2<S>>, closed: bool },
}

/// A part of a compound. Its shape has no parts, so that what is read is not nested without end.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Part", deny_unknown_fields)]
struct PartSpec<S> {
    shape: Spec<S, NoPart>,
    position: Vec2<S>,
    angle: S,
    density: S,
}

/// The type of a part's parts: a part is no compound, so there are none.
enum NoPart {}

impl Serialize for NoPart {
    fn serialize<W: Serializer>(&self, _: W) -> Result<W::Ok, W::Error> {
        match *self {}
    }
}

impl<'de> Deserialize<'de> for NoPart {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom("a part of a compound is no compound"))
    }
}

/// The arguments that a shape was made from.
fn spec<S: Scalar, P>(shape: &Shape<S>, part: impl Fn(&Part<S>) -> Option<P>) -> Spec<S, P> {
    let unshifted = |point: Vec2<S>| point + shape.shift;
    match shape.geometry {
        Geometry::Circle { radius } => Spec::Circle { radius },
        Geometry::Rectangle { width, height } => Spec::Rectangle { width, height },
        Geometry::Capsule { length, radius } => Spec::Capsule { length, radius },
        Geometry::Polygon { ref corners } => Spec::Polygon { corners: corners.iter().map(|&c| unshifted(c)).collect() },
        Geometry::RoundedPolygon { ref corners, radius } => {
            Spec::RoundedPolygon { corners: corners.iter().map(|&c| unshifted(c)).collect(), radius }
        }
        Geometry::Segment { ends } => Spec::Segment { ends: ends.map(unshifted) },
        Geometry::Compound { ref parts } => {
            let placed = |p: &Part<S>| part(&Part { position: unshifted(p.position), ..p.clone() });
            Spec::Compound { parts: parts.iter().filter_map(placed).collect() }
        }
        Geometry::Chain { ref points, closed } => Spec::Chain { points: points.to_vec(), closed },
    }
}

fn shape<S: Scalar, P>(spec: Spec<S, P>, part: impl Fn(P) -> Result<Part<S>, Error>) -> Result<Shape<S>, Error> {
    match spec {
        Spec::Circle { radius } => Shape::new(Geometry::Circle { radius }),
        Spec::Rectangle { width, height } => Shape::new(Geometry::Rectangle { width, height }),
        Spec::Capsule { length, radius } => Shape::new(Geometry::Capsule { length, radius }),
        Spec::Polygon { corners } => Shape::polygon(&corners),
        Spec::RoundedPolygon { corners, radius } => Shape::rounded_polygon(&corners, radius),
        Spec::Segment { ends: [a, b] } => Shape::segment(a, b),
        Spec::Compound { parts } => {
            let parts: Vec<Part<S>> = parts.into_iter().map(part).collect::<Result<_, _>>()?;
            Shape::compound(&parts)
        }
        Spec::Chain { points, closed } => Shape::chain(&points, closed),
    }
}

impl<S: Scalar + Serialize> Serialize for Shape<S> {
    fn serialize<W: Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        let part = |part: &Part<S>| {
            let Part { position, angle, density, .. } = *part;
            Some(PartSpec { shape: spec(&part.shape, |_| None), position, angle, density })
        };
        spec(self, part).serialize(serializer)
    }
}

impl<'de, S: Scalar + Deserialize<'de>> Deserialize<'de> for Shape<S> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let part = |PartSpec { shape: spec, position, angle, density }| {
            Ok(Part { shape: shape(spec, |part: NoPart| match part {})?, position, angle, density })
        };
        shape(Spec::deserialize(deserializer)?, part).map_err(D::Error::custom)
    }
}
