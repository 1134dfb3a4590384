//! What the library draws, as polygons and lines.

use std::collections::BTreeSet;

use umbra_physics::scalar::ToF64;
use umbra_physics::{DebugDraw, DrawOptions, End, FieldId, Law, Pose, Role, Scalar, World};

use super::Point;

/// The closed lines around a shape, and the strokes that show how far a round one is turned.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    pub(super) rings: Vec<Vec<Point>>,
    pub(super) strokes: Vec<[Point; 2]>,
}

/// Force fields that are somewhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Scenery {
    pub(super) springs: Vec<[Point; 2]>,
    /// Of attractors that no body carries.
    pub(super) centres: Vec<Point>,
    pub(super) zones: Vec<Vec<Point>>,
    carried: BTreeSet<FieldId>,
}

impl Scenery {
    pub(super) fn of<S: Scalar + ToF64>(world: &World<S>) -> Self {
        let is_carried = |law: &Law<S>| matches!(law, Law::Attractor { centre: End::Body(_), .. });
        let carried = world.fields().filter(|(_, field)| is_carried(&field.law)).map(|(id, _)| id).collect();
        let mut scenery = Self { carried, ..Self::default() };
        world.debug_draw(Pose::of, &DrawOptions { bodies: false, ..DrawOptions::default() }, &mut scenery);
        scenery
    }
}

fn point([x, y]: [f64; 2]) -> Point {
    (x, y)
}

fn ring(corners: &[[f64; 2]]) -> Vec<Point> {
    corners.iter().copied().map(point).collect()
}

impl DebugDraw for Outline {
    fn polygon(&mut self, corners: &[[f64; 2]], _role: Role) {
        self.rings.push(ring(corners));
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], _role: Role) {
        self.strokes.push(ends.map(point));
    }

    /// A body without a shape has no outline.
    fn point(&mut self, _at: [f64; 2], _role: Role) {}
}

impl DebugDraw for Scenery {
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role) {
        if let Role::Zone(_) = role {
            self.zones.push(ring(corners));
        }
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        if let Role::Spring(_) = role {
            self.springs.push(ends.map(point));
        }
    }

    fn point(&mut self, at: [f64; 2], role: Role) {
        if matches!(role, Role::Attractor(field) if !self.carried.contains(&field)) {
            self.centres.push(point(at));
        }
    }

    /// Which way a zone or a thrust pushes is left out: the ways show it.
    fn arrow(&mut self, _from: [f64; 2], _to: [f64; 2], _role: Role) {}
}
