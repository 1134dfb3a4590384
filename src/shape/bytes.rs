//! Shapes as bytes. A shape is written in the coordinates that it was made from, so that reading makes the same shape to
//! the bit.
//!
//! The given coordinates are the kept ones plus the shift, exactly: both are multiples of an ulp and small. A polygon is
//! kept and written counter-clockwise. A clockwise polygon would be a second encoding of the same shape, and is refused.

use alloc::vec::Vec;

use super::{Geometry, Part, Shape};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::error::Error;
use crate::fx::Fx;
use crate::limits::{self, CORNERS, PARTS};
use crate::math::Vec2;
use crate::scalar::Scalar;

const CIRCLE: u8 = 0;
const RECTANGLE: u8 = 1;
const CAPSULE: u8 = 2;
const POLYGON: u8 = 3;
const SEGMENT: u8 = 4;
const COMPOUND: u8 = 5;
const ROUNDED_POLYGON: u8 = 6;
const CHAIN: u8 = 7;

impl<S: Scalar> Write for Shape<S> {
    fn write(&self, out: &mut impl Encoder) {
        match &self.geometry {
            Geometry::Circle { radius } => {
                out.leaf(&[CIRCLE], &"circle");
                codec::field(out, "radius", radius);
            }
            Geometry::Rectangle { width, height } => {
                out.leaf(&[RECTANGLE], &"rectangle");
                codec::field(out, "width", width);
                codec::field(out, "height", height);
            }
            Geometry::Capsule { length, radius } => {
                out.leaf(&[CAPSULE], &"capsule");
                codec::field(out, "length", length);
                codec::field(out, "radius", radius);
            }
            Geometry::Polygon { corners } => {
                out.leaf(&[POLYGON], &"polygon");
                let corners: Vec<Vec2<S>> = corners.iter().map(|&corner| corner + self.shift).collect();
                codec::list(out, corners.iter());
            }
            Geometry::RoundedPolygon { corners, radius } => {
                out.leaf(&[ROUNDED_POLYGON], &"rounded polygon");
                codec::field(out, "radius", radius);
                let corners: Vec<Vec2<S>> = corners.iter().map(|&corner| corner + self.shift).collect();
                codec::list(out, corners.iter());
            }
            Geometry::Segment { ends: [a, b] } => {
                out.leaf(&[SEGMENT], &"segment");
                codec::field(out, "a", &(*a + self.shift));
                codec::field(out, "b", &(*b + self.shift));
            }
            Geometry::Compound { parts } => {
                out.leaf(&[COMPOUND], &"compound");
                let shifted = parts.iter().map(|part| Part { position: part.position + self.shift, ..part.clone() });
                let parts: Vec<Part<S>> = shifted.collect();
                codec::list(out, parts.iter());
            }
            Geometry::Chain { points, closed } => {
                out.leaf(&[CHAIN], &"chain");
                codec::field(out, "closed", closed);
                codec::list(out, points.iter());
            }
        }
    }
}

impl<S: Scalar> Write for Part<S> {
    fn write(&self, out: &mut impl Encoder) {
        let Self { shape, position, angle, density } = self;
        codec::field(out, "shape", shape);
        codec::field(out, "position", position);
        codec::field(out, "angle", angle);
        codec::field(out, "density", density);
    }
}

impl Read for Shape<Fx> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        read(reader, true)
    }
}

fn read(reader: &mut Reader<'_>, may_be_compound: bool) -> Result<Shape<Fx>, Malformed> {
    let malformed = reader.malformed("a shape");
    let shape = match u8::read(reader)? {
        CIRCLE => Shape::circle(Fx::read(reader)?),
        RECTANGLE => Shape::rectangle(Fx::read(reader)?, Fx::read(reader)?),
        CAPSULE => Shape::capsule(Fx::read(reader)?, Fx::read(reader)?),
        POLYGON => read_polygon(reader, None)?,
        ROUNDED_POLYGON => {
            let radius = Fx::read(reader)?;
            read_polygon(reader, Some(radius))?
        }
        SEGMENT => Shape::segment(Vec2::read(reader)?, Vec2::read(reader)?),
        // Parts are no compounds and no chains, so that reading goes no deeper.
        COMPOUND if may_be_compound => Shape::compound(&many(reader, PARTS, 41, |reader| {
            Ok(Part {
                shape: read(reader, false)?,
                position: Vec2::read(reader)?,
                angle: Fx::read(reader)?,
                density: Fx::read(reader)?,
            })
        })?),
        CHAIN if may_be_compound => {
            let closed = bool::read(reader)?;
            Shape::chain(&many(reader, limits::CHAIN, 16, Vec2::read)?, closed)
        }
        _ => return Err(malformed),
    };
    shape.map_err(|_: Error| malformed)
}

/// Reads a polygon, rounded with a radius. Refuses corners in clockwise order.
fn read_polygon(reader: &mut Reader<'_>, radius: Option<Fx>) -> Result<Result<Shape<Fx>, Error>, Malformed> {
    let malformed = reader.malformed("the corners of a polygon, counter-clockwise");
    let corners = many(reader, CORNERS, 16, Vec2::read)?;
    let polygon = match radius {
        Some(radius) => Shape::rounded_polygon(&corners, radius),
        None => Shape::polygon(&corners),
    };
    let is_reversed = |shape: &Shape<Fx>| match &shape.geometry {
        // No two corners are the same: reversed, the last one comes first.
        Geometry::Polygon { corners: kept } | Geometry::RoundedPolygon { corners: kept, .. } => {
            kept[0] + shape.shift != corners[0]
        }
        _ => false,
    };
    if polygon.as_ref().is_ok_and(is_reversed) { Err(malformed) } else { Ok(polygon) }
}

fn many<T>(
    reader: &mut Reader<'_>,
    max: usize,
    least_bytes: usize,
    read: impl Fn(&mut Reader<'_>) -> Result<T, Malformed>,
) -> Result<Vec<T>, Malformed> {
    let malformed = reader.malformed("a shape");
    let count = reader.count(least_bytes)?;
    if count > max {
        return Err(malformed);
    }
    (0..count).map(|_| read(reader)).collect()
}
