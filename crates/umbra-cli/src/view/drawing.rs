//! Shapes and force fields as the page draws them: lists with a letter first, lengths in m as floats.
//!
//! Shapes are what the library draws them as; a collider that is a sensor, one-way or a belt is a list of its name, its drawing and, but
//! for a sensor, a point and a direction: out of the side that holds, or in which the top of the belt carries. Fields are kept by what they are attached to: where that is differs from tick
//! to tick, and the page has it from the tracks of the bodies.

use serde_json::{Value, json};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Attachment, BodyClass, BodyId, ColliderDef, DebugDraw, End, FieldKind, ForceField, Fx, Pose, Region, Role,
};

use crate::surface::Surface;

/// The drawing of a shape about its centre of mass, for the page to turn and move: discs with the point of their rim that is
/// marked, capsules by their ends, polygons, lines.
#[derive(Default)]
struct Primitives(Vec<Value>);

impl DebugDraw for Primitives {
    fn polygon(&mut self, corners: &[[f64; 2]], _role: Role) {
        self.0.push(json!(["p", corners]));
    }

    fn segment(&mut self, [a, b]: [[f64; 2]; 2], _role: Role) {
        self.0.push(json!(["s", a, b]));
    }

    /// The page marks bodies that are too small to see by itself.
    fn point(&mut self, _at: [f64; 2], _role: Role) {}

    fn circle(&mut self, centre: [f64; 2], radius: f64, rim: Option<[f64; 2]>, _role: Role) {
        self.0.push(json!(["c", centre, radius, rim]));
    }

    fn capsule(&mut self, [a, b]: [[f64; 2]; 2], radius: f64, _role: Role) {
        self.0.push(json!(["l", a, b, radius]));
    }
}

/// The shapes of a body's colliders; None for a body that has none.
pub(super) fn outline(body: BodyId, colliders: &[ColliderDef]) -> Option<Value> {
    let mut drawn = Vec::new();
    for collider in colliders {
        let pose = Pose { position: collider.position.to_f64(), angle: collider.angle.to_f64() };
        let mut primitives = Primitives::default();
        collider.shape.debug_draw(pose, Role::Body(body, BodyClass::Dynamic), &mut primitives);
        let (sin, cos) = pose.angle.sin_cos();
        let turned = |[x, y]: [f64; 2]| {
            let length = (x * x + y * y).sqrt().max(f64::MIN_POSITIVE);
            [(x * cos - y * sin) / length, (x * sin + y * cos) / length]
        };
        match Surface::of(collider) {
            Surface::Solid => drawn.extend(primitives.0),
            Surface::Sensor => drawn.push(json!(["sensor", primitives.0])),
            Surface::OneWay => {
                let direction = collider.one_way.map_or([0.0, 1.0], |one_way| one_way.direction.to_f64());
                drawn.push(json!(["one-way", primitives.0, pose.position, turned(direction)]));
            }
            Surface::Belt => {
                // A positive speed carries counter-clockwise around the shape.
                let along = -collider.material.surface_speed.to_f64().signum();
                drawn.push(json!(["belt", primitives.0, pose.position, turned([along, 0.0])]));
            }
        }
    }
    (!colliders.is_empty()).then_some(Value::Array(drawn))
}

/// A force field with a place; None for those that are everywhere or that are custom forces. `life` has the number
/// under which the page knows a body.
pub(super) fn field(field: &ForceField<Fx>, life: impl Fn(BodyId) -> Option<usize>) -> Option<Value> {
    // A point of the world, or a body and a point in its axes.
    let attached = |a: &Attachment<Fx>| Some(json!([a.point.to_f64(), life(a.body)?]));
    let end = |end: &End<Fx>| match end {
        End::World(point) => Some(json!([point.to_f64()])),
        End::Body(a) => attached(a),
    };
    match &field.kind {
        FieldKind::Attractor { centre, .. } => Some(json!(["a", end(centre)?])),
        FieldKind::Spring { near, far, .. } => Some(json!(["s", attached(near)?, end(far)?])),
        FieldKind::Thrust { at, force } => Some(json!(["t", attached(at)?, force.to_f64()])),
        FieldKind::Zone { region: Region::Disc { centre, radius }, acceleration } => {
            Some(json!(["d", centre.to_f64(), radius.to_f64(), acceleration.to_f64()]))
        }
        FieldKind::Zone { region: Region::Box { min, max }, acceleration } => {
            Some(json!(["b", min.to_f64(), max.to_f64(), acceleration.to_f64()]))
        }
        FieldKind::Buoyancy { min, max, flow, .. } => Some(json!(["b", min.to_f64(), max.to_f64(), flow.to_f64()])),
        _ => None,
    }
}
