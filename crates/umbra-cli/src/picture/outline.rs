//! The drawing of the library, as polygons and lines.

use std::collections::BTreeSet;

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyClass, BodyId, DebugDraw, DrawOptions, End, FieldId, FieldKind, Pose, Role, Scalar, Vec2, World,
};

use super::Point;
use crate::surface::Surface;

/// A body as it is drawn: the closed lines around its colliders, and the strokes that show how far a round one is turned. A body
/// without colliders has neither.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    pub(super) body: BodyId,
    pub(super) class: BodyClass,
    pub(super) rings: Vec<Ring>,
    pub(super) strokes: Vec<Stroke>,
}

/// The closed line around a collider, or a part of it.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    pub(super) surface: Surface,
    pub(super) points: Vec<Point>,
}

/// A line of a collider.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) surface: Surface,
    pub(super) ends: [Point; 2],
}

impl Outline {
    /// The outlines of all bodies, in the order of their slots.
    pub(super) fn all<S: Scalar + ToF64>(world: &World<S>) -> Vec<Self> {
        let mut outlines = Outlines { world, all: Vec::new() };
        world.debug_draw(
            Pose::of,
            &DrawOptions { fields: false, joints: false, ..DrawOptions::default() },
            &mut outlines,
        );
        outlines.all
    }

    /// All points of it.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point> {
        let rings = self.rings.iter().flat_map(|ring| &ring.points);
        rings.chain(self.strokes.iter().flat_map(|stroke| &stroke.ends))
    }
}

struct Outlines<'a, S: Scalar> {
    world: &'a World<S>,
    all: Vec<Outline>,
}

impl<S: Scalar> Outlines<'_, S> {
    /// The outline of the body that is being drawn, and the surface of its collider: a body comes in one piece.
    fn of(&mut self, role: Role) -> Option<(&mut Outline, Surface)> {
        let (body, class, surface) = match role {
            Role::Body(body, class) => (body, class, Surface::Solid),
            Role::Collider(body, collider, class) => (body, class, Surface::of(self.world.collider(collider).ok()?)),
            _ => return None,
        };
        if self.all.last().is_none_or(|last| last.body != body) {
            self.all.push(Outline { body, class, rings: Vec::new(), strokes: Vec::new() });
        }
        self.all.last_mut().map(|outline| (outline, surface))
    }
}

/// Force fields that are somewhere, and joints.
#[derive(Clone, Debug, Default)]
pub(super) struct Scenery {
    pub(super) springs: Vec<[Point; 2]>,
    /// The centres of attractors that no body carries.
    pub(super) centres: Vec<Point>,
    pub(super) zones: Vec<Vec<Point>>,
    /// The lines of joints that steps keep: between their ends, and along their axes.
    pub(super) joints: Vec<[Point; 2]>,
    /// The ends of these joints: of a hinge or a weld twice the same point, nearly.
    pub(super) joint_ends: Vec<Point>,
    carried: BTreeSet<FieldId>,
}

impl Scenery {
    pub(super) fn of<S: Scalar + ToF64>(world: &World<S>) -> Self {
        let is_carried = |law: &FieldKind<S>| matches!(law, FieldKind::Attractor { centre: End::Body(_), .. });
        let carried = world.fields().filter(|(_, field)| is_carried(&field.kind)).map(|(id, _)| id).collect();
        let mut scenery = Self { carried, ..Self::default() };
        world.debug_draw(Pose::of, &DrawOptions { bodies: false, ..DrawOptions::default() }, &mut scenery);
        scenery
    }
}

/// A place of a world in a picture.
pub(super) fn place<S: ToF64>(at: Vec2<S>) -> Point {
    point(at.to_f64())
}

fn point([x, y]: [f64; 2]) -> Point {
    (x, y)
}

fn ring(corners: &[[f64; 2]]) -> Vec<Point> {
    corners.iter().copied().map(point).collect()
}

impl<S: Scalar> DebugDraw for Outlines<'_, S> {
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role) {
        if let Some((outline, surface)) = self.of(role) {
            outline.rings.push(Ring { surface, points: ring(corners) });
        }
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        if let Some((outline, surface)) = self.of(role) {
            outline.strokes.push(Stroke { surface, ends: ends.map(point) });
        }
    }

    /// A body without colliders.
    fn point(&mut self, _at: [f64; 2], role: Role) {
        self.of(role);
    }
}

impl DebugDraw for Scenery {
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role) {
        if let Role::Zone(_) | Role::Buoyancy(_) = role {
            self.zones.push(ring(corners));
        }
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        match role {
            Role::Spring(_) => self.springs.push(ends.map(point)),
            Role::Joint(_) => self.joints.push(ends.map(point)),
            _ => {}
        }
    }

    fn point(&mut self, at: [f64; 2], role: Role) {
        match role {
            Role::Attractor(field) if !self.carried.contains(&field) => self.centres.push(point(at)),
            Role::Joint(_) => self.joint_ends.push(point(at)),
            _ => {}
        }
    }

    /// Leaves out the direction of a zone, a fluid or a thrust: the trails show it.
    fn arrow(&mut self, _from: [f64; 2], _to: [f64; 2], _role: Role) {}
}
