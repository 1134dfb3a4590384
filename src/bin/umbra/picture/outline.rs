//! Outlines of shapes as polygons.

use std::f64::consts::{PI, TAU};

use umbra_physics::scalar::ToF64;
use umbra_physics::{Geometry, Scalar};

use super::Point;

/// The closed lines around a shape, and the strokes that show how far a round one is turned.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    pub(super) rings: Vec<Vec<Point>>,
    pub(super) strokes: Vec<[Point; 2]>,
}

/// A point of a body where the body is.
pub(super) fn placed((x, y): Point, centre: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    (centre.0 + x * cos - y * sin, centre.1 + x * sin + y * cos)
}

fn arc(centre: Point, radius: f64, from: f64, to: f64) -> impl Iterator<Item = Point> {
    const PARTS: u32 = 24;
    (0..=PARTS).map(move |i| {
        let angle = from + (to - from) * f64::from(i) / f64::from(PARTS);
        (centre.0 + radius * angle.cos(), centre.1 + radius * angle.sin())
    })
}

pub(super) fn circle(centre: Point, radius: f64) -> Vec<Point> {
    arc(centre, radius, 0.0, PI).chain(arc(centre, radius, PI, TAU)).collect()
}

/// The outline of a shape whose centre of mass is there.
pub(super) fn outline<S: Scalar + ToF64>(geometry: &Geometry<S>, centre: Point, angle: f64) -> Outline {
    let mut rings = Vec::new();
    let mut strokes = Vec::new();
    let place = |point: Point| placed(point, centre, angle);
    let pair = |x: S, y: S| (x.to_f64(), y.to_f64());
    match geometry {
        Geometry::Circle { radius } => {
            let radius = radius.to_f64();
            rings.push(circle(centre, radius));
            strokes.push([centre, place((radius, 0.0))]);
        }
        Geometry::Rectangle { width, height } => {
            let (w, h) = (width.to_f64() / 2.0, height.to_f64() / 2.0);
            rings.push([(-w, -h), (w, -h), (w, h), (-w, h)].map(place).to_vec());
        }
        Geometry::Capsule { length, radius } => {
            let (half, radius) = (length.to_f64() / 2.0, radius.to_f64());
            let right = arc((half, 0.0), radius, -PI / 2.0, PI / 2.0);
            let left = arc((-half, 0.0), radius, PI / 2.0, 1.5 * PI);
            rings.push(right.chain(left).map(place).collect());
        }
        Geometry::Polygon { corners } => rings.push(corners.iter().map(|c| place(pair(c.x, c.y))).collect()),
        Geometry::Segment { ends: [a, b] } => strokes.push([place(pair(a.x, a.y)), place(pair(b.x, b.y))]),
        Geometry::Compound { parts } => {
            for part in parts.iter() {
                let at = place(pair(part.position.x, part.position.y));
                let inner = outline(part.shape.geometry(), at, angle + part.angle.to_f64());
                rings.extend(inner.rings);
                strokes.extend(inner.strokes);
            }
        }
        _ => {}
    }
    Outline { rings, strokes }
}
