//! Shapes and force fields as the page draws them: lists with a letter first, lengths in m as floats.

use serde_json::{Value, json};
use umbra_physics::scalar::ToF64;
use umbra_physics::{Attachment, BodyId, End, Field, Fx, Geometry, Law, Region, Vec2};

fn pair(v: Vec2) -> [f64; 2] {
    [v.x.to_f64(), v.y.to_f64()]
}

pub(super) fn shape(geometry: &Geometry<Fx>) -> Value {
    match geometry {
        Geometry::Circle { radius } => json!(["c", radius.to_f64()]),
        Geometry::Rectangle { width, height } => json!(["r", width.to_f64(), height.to_f64()]),
        Geometry::Capsule { length, radius } => json!(["l", length.to_f64(), radius.to_f64()]),
        Geometry::Polygon { corners } => json!(["p", corners.iter().map(|&corner| pair(corner)).collect::<Vec<_>>()]),
        Geometry::Segment { ends } => json!(["s", ends.map(pair)]),
        Geometry::Compound { parts } => {
            let part = |part: &umbra_physics::Part| {
                json!([shape(part.shape.geometry()), pair(part.position), part.angle.to_f64()])
            };
            json!(["m", parts.iter().map(part).collect::<Vec<_>>()])
        }
        // Nothing that this version can draw.
        _ => Value::Null,
    }
}

/// A force field with a place; None for those that are everywhere or that only their law knows. `life` has the number
/// under which the page knows a body.
pub(super) fn field(field: &Field<Fx>, life: impl Fn(BodyId) -> Option<usize>) -> Option<Value> {
    // A point of the world, or a body and a point in its axes.
    let attached = |a: &Attachment<Fx>| Some(json!([pair(a.point), life(a.body)?]));
    let end = |end: &End<Fx>| match end {
        End::World(point) => Some(json!([pair(*point)])),
        End::Body(a) => attached(a),
    };
    match &field.law {
        Law::Attractor { centre, .. } => Some(json!(["a", end(centre)?])),
        Law::Spring { near, far, .. } => Some(json!(["s", attached(near)?, end(far)?])),
        Law::Thrust { at, force } => Some(json!(["t", attached(at)?, pair(*force)])),
        Law::Zone { region: Region::Disc { centre, radius }, acceleration } => {
            Some(json!(["d", pair(*centre), radius.to_f64(), pair(*acceleration)]))
        }
        Law::Zone { region: Region::Box { min, max }, acceleration } => {
            Some(json!(["b", pair(*min), pair(*max), pair(*acceleration)]))
        }
        _ => None,
    }
}
