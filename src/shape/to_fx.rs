//! Shapes of floats in fixed point, where contacts are found.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Geometry, Part, Shape};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Factor as _, Scalar};

/// Each component rounded to nearest.
fn vector<S: Scalar>(v: &Vec2<S>) -> Vec2 {
    v.map(S::to_fx)
}

/// The corners of a polygon, rounded: corners that round to one place are one.
fn corners<S: Scalar>(corners: &[Vec2<S>]) -> Arc<[Vec2]> {
    let mut rounded: Vec<Vec2> = corners.iter().map(vector).collect();
    rounded.dedup();
    if rounded.len() > 1 && rounded.first() == rounded.last() {
        rounded.pop();
    }
    rounded.into()
}

impl<S: Scalar> Shape<S> {
    /// The shape with all lengths rounded to nearest.
    pub(crate) fn to_fx(&self) -> Shape {
        let geometry = match &self.geometry {
            Geometry::Circle { radius } => Geometry::Circle { radius: radius.to_fx() },
            Geometry::Rectangle { width, height } => {
                Geometry::Rectangle { width: width.to_fx(), height: height.to_fx() }
            }
            Geometry::Capsule { length, radius } => {
                Geometry::Capsule { length: length.to_fx(), radius: radius.to_fx() }
            }
            Geometry::Polygon { corners: sharp } => Geometry::Polygon { corners: corners(sharp) },
            Geometry::Segment { ends } => Geometry::Segment { ends: [vector(&ends[0]), vector(&ends[1])] },
            Geometry::Compound { parts } => Geometry::Compound { parts: parts.iter().map(part).collect() },
            Geometry::RoundedPolygon { corners: core, radius } => {
                Geometry::RoundedPolygon { corners: corners(core), radius: radius.to_fx() }
            }
            Geometry::Chain { points, closed } => {
                Geometry::Chain { points: points.iter().map(vector).collect(), closed: *closed }
            }
        };
        let (measure, gyration) = (self.measure.to_fx_factor(), self.gyration.to_fx_factor());
        Shape::of(geometry, vector(&self.shift), measure, gyration)
    }
}

fn part<S: Scalar>(part: &Part<S>) -> Part<Fx> {
    Part {
        shape: part.shape.to_fx(),
        position: vector(&part.position),
        angle: part.angle.to_fx(),
        density: part.density.to_fx(),
    }
}
