//! Joints as the page draws them: what the library draws, each point with the body that carries it.
//!
//! A joint is a list of `["s", end, end]` for its lines and `["m", point]` for its marks. Points are as those of force fields: `[[x, y]]` in
//! the world or `[[x, y], body]` in the axes of a body, m, with the number of the body in the page. The page has the places of bodies from their
//! tracks.
//!
//! The library draws at any poses of bodies. With all bodies at the origin it gives points in the axes of their bodies, and with each body moved
//! aside by a distance of its own, the way that a point has moved tells which body carries it.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use umbra_physics::{BodyId, BodyRef, DebugDraw, DrawOptions, Fx, JointId, Pose, Role, World};

/// The lines and marks of joints, at the poses of a drawing.
#[derive(Default)]
struct Marks(Vec<(JointId, Vec<[f64; 2]>)>);

impl Marks {
    fn of(world: &World<Fx>, pose: impl Fn(&BodyRef<'_>) -> Pose) -> Self {
        let options = DrawOptions { bodies: false, fields: false, ..DrawOptions::default() };
        let mut marks = Self::default();
        world.debug_draw(pose, &options, &mut marks);
        marks
    }

    fn push(&mut self, role: Role, points: &[[f64; 2]]) {
        if let Role::Joint(joint) = role {
            self.0.push((joint, points.to_vec()));
        }
    }
}

impl DebugDraw for Marks {
    /// A joint has no areas.
    fn polygon(&mut self, _corners: &[[f64; 2]], _role: Role) {}

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        self.push(role, &ends);
    }

    fn point(&mut self, at: [f64; 2], role: Role) {
        self.push(role, &[at]);
    }
}

/// The joints of a world that are drawn. `life` has the number under which the page knows a body.
pub(super) fn drawings(world: &World<Fx>, life: impl Fn(BodyId) -> Option<usize>) -> BTreeMap<JointId, Value> {
    let aside = |body: &BodyRef<'_>| {
        let number = life(body.id()).map_or(0, |life| life + 1);
        Pose { position: [number as f64, 0.0], ..Pose::ORIGIN }
    };
    let (local, moved) = (Marks::of(world, |_| Pose::ORIGIN), Marks::of(world, aside));
    let mut drawings: BTreeMap<JointId, Vec<Value>> = BTreeMap::new();
    for ((joint, points), (_, moved_points)) in local.0.into_iter().zip(moved.0) {
        let points = points.into_iter().zip(moved_points).map(|(point, moved_point)| {
            // Points are within 2^31 m: the error of the difference is far below 1.
            match (moved_point[0] - point[0]).round() as usize {
                0 => json!([point]),
                number => json!([point, number - 1]),
            }
        });
        let points: Vec<Value> = points.collect();
        drawings.entry(joint).or_default().push(match &points[..] {
            [point] => json!(["m", point]),
            points => json!(["s", points[0], points[1]]),
        });
    }
    drawings.into_iter().map(|(joint, marks)| (joint, Value::Array(marks))).collect()
}
