//! Drawing a world: outlines, force fields and velocities, to whatever can draw.

use alloc::vec::Vec;
use core::f64::consts::PI;

use super::pose::{Placed, Pose};
use crate::body::{Activity, BodyKind};
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::math::Vec2;
use crate::scalar::{Scalar, ToF64};
use crate::shape::{Geometry, Shape};
use crate::slots::{BodyId, FieldId};
use crate::world::{BodyRef, World};

/// Class of a body for drawing: kind and activity in one, to choose a colour by.
///
/// ```
/// use umbra_physics::{Activity, BodyClass, BodyKind, Role};
///
/// let class = BodyClass::new(BodyKind::Dynamic, Activity::Asleep);
/// assert_eq!(class, BodyClass::Asleep);
/// let colour = |role| match role {
///     Role::Body(_, BodyClass::Asleep | BodyClass::Static) => "grey",
///     Role::Body(_, BodyClass::Quarantined) => "red",
///     Role::Body(..) => "blue",
///     _ => "green",
/// };
/// assert_eq!(colour(Role::Body(umbra_physics::BodyId::from_parts(0, 0), class)), "grey");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyClass {
    /// Moved by everything.
    Dynamic,
    /// Moved by the velocity it is given.
    Kinematic,
    /// Moved by nothing.
    Static,
    /// At rest and skipped.
    Asleep,
    /// Taken out of the simulation by a step.
    Quarantined,
    /// Taken out of it by a call.
    Disabled,
}

impl BodyClass {
    /// The class of a body of this kind and activity.
    #[must_use]
    pub const fn new(kind: BodyKind, activity: Activity) -> Self {
        match (activity, kind) {
            (Activity::Quarantined, _) => Self::Quarantined,
            (Activity::Disabled, _) => Self::Disabled,
            (Activity::Asleep, _) => Self::Asleep,
            (Activity::Awake, BodyKind::Dynamic) => Self::Dynamic,
            (Activity::Awake, BodyKind::Kinematic) => Self::Kinematic,
            (Activity::Awake, BodyKind::Static) => Self::Static,
        }
    }
}

/// Meaning of a drawn outline, segment or point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Role {
    /// The outline of a body: its shape and its colliders, or a point at its position if it has neither.
    Body(BodyId, BodyClass),
    /// An arrow from the position of a body, along its velocity.
    Velocity(BodyId),
    /// A spring, from end to end.
    Spring(FieldId),
    /// The centre of an attractor.
    Attractor(FieldId),
    /// An arrow to the point that a thrust acts at, along it; 1 m long.
    Thrust(FieldId),
    /// The region of a zone, and an arrow of 1 m from its middle along its acceleration.
    Zone(FieldId),
}

/// A renderer for [`World::debug_draw`]. Points and lengths are in m, in the world's axes. Each call says what is drawn by a
/// [`Role`]; colours, line widths and filling are up to the renderer.
///
/// ```
/// use umbra_physics::{BodyDef, DebugDraw, DrawOptions, Pose, Role, Shape, World, WorldDef, fx, vec2};
///
/// /// A renderer of lines only.
/// #[derive(Default)]
/// struct Lines(Vec<[[f64; 2]; 2]>);
///
/// impl DebugDraw for Lines {
///     fn polygon(&mut self, corners: &[[f64; 2]], _role: Role) {
///         let next = corners.iter().cycle().skip(1);
///         self.0.extend(corners.iter().zip(next).map(|(&a, &b)| [a, b]));
///     }
///
///     fn segment(&mut self, ends: [[f64; 2]; 2], _role: Role) {
///         self.0.push(ends);
///     }
///
///     fn point(&mut self, [x, y]: [f64; 2], _role: Role) {
///         self.0.extend([[[x - 0.1, y], [x + 0.1, y]], [[x, y - 0.1], [x, y + 0.1]]]);
///     }
/// }
///
/// let mut world = World::new(WorldDef::default())?;
/// let shape = Some(Shape::rectangle(fx!(2), fx!(1))?);
/// world.add_body(BodyDef { shape, position: vec2(5, 0), ..BodyDef::dynamic() })?;
/// let mut lines = Lines::default();
/// world.debug_draw(Pose::of, &DrawOptions::default(), &mut lines);
/// assert_eq!(lines.0.len(), 4);
/// assert_eq!(lines.0[0], [[4.0, -0.5], [6.0, -0.5]]);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
pub trait DebugDraw {
    /// A convex area by its corners, counter-clockwise.
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role);

    /// A line.
    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role);

    /// A point without a size: a mark.
    fn point(&mut self, at: [f64; 2], role: Role);

    /// A disc, with the point of its rim that shows how far it is turned, if it can turn. Unless said otherwise a
    /// [polygon](Self::polygon) of 48 corners and a [segment](Self::segment) to that point.
    fn circle(&mut self, centre: [f64; 2], radius: f64, rim: Option<[f64; 2]>, role: Role) {
        self.polygon(&round([centre; 2], radius), role);
        if let Some(rim) = rim {
            self.segment([centre, rim], role);
        }
    }

    /// All within a radius of the line between two points. Unless said otherwise a [polygon](Self::polygon) of 50 corners.
    fn capsule(&mut self, ends: [[f64; 2]; 2], radius: f64, role: Role) {
        self.polygon(&round(ends, radius), role);
    }

    /// An arrow. Unless said otherwise a [segment](Self::segment).
    fn arrow(&mut self, from: [f64; 2], to: [f64; 2], role: Role) {
        self.segment([from, to], role);
    }
}

/// The outline of a capsule; of a disc if its ends are one point.
fn round([a, b]: [[f64; 2]; 2], radius: f64) -> Vec<[f64; 2]> {
    /// Segments of a half disc.
    const PARTS: u32 = 24;
    let along = libm::atan2(b[1] - a[1], b[0] - a[0]);
    let arc = |centre: [f64; 2], from: f64, points: u32| {
        (0..points).map(move |i| {
            let angle = from + PI * f64::from(i) / f64::from(PARTS);
            [centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]
        })
    };
    // Where the half discs of one disc meet they have one corner, not two.
    let points = if a == b { PARTS } else { PARTS + 1 };
    arc(b, along - PI / 2.0, points).chain(arc(a, along + PI / 2.0, points)).collect()
}

/// Selection of the parts of a world to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawOptions {
    /// The outlines of bodies.
    pub bodies: bool,
    /// Force fields that are somewhere: springs, attractors, thrusts, zones.
    pub fields: bool,
    /// Velocities, as the distance that each body moves in this many seconds.
    pub velocities: Option<f64>,
}

impl Default for DrawOptions {
    /// Bodies and fields.
    fn default() -> Self {
        Self { bodies: true, fields: true, velocities: None }
    }
}

impl<S: Scalar + ToF64> World<S> {
    /// Draws the world with its bodies at these poses: those of the tick ([`Pose::of`]), or of an
    /// [`Interpolation`](super::Interpolation).
    ///
    /// First the fields in the order in which they were added, then the bodies in the order of their slots, then the
    /// velocities in that order. The state of the world is only read.
    pub fn debug_draw(
        &self,
        pose: impl Fn(&BodyRef<'_, S>) -> Pose,
        options: &DrawOptions,
        draw: &mut (impl DebugDraw + ?Sized),
    ) {
        if options.fields {
            for (id, field) in self.fields() {
                self.draw_field(id, field, &pose, draw);
            }
        }
        if options.bodies {
            for body in self.bodies() {
                self.draw_body(&body, pose(&body), draw);
            }
        }
        if let Some(seconds) = options.velocities {
            for body in self.bodies().filter(|body| body.velocity() != Vec2::ZERO) {
                let (from, velocity) = (pose(&body).position, body.velocity().to_f64());
                let to = [0, 1].map(|i| from[i] + velocity[i] * seconds);
                draw.arrow(from, to, Role::Velocity(body.id()));
            }
        }
    }

    fn draw_body(&self, body: &BodyRef<'_, S>, pose: Pose, draw: &mut (impl DebugDraw + ?Sized)) {
        let (at, role) = (Placed::at(pose), Role::Body(body.id(), BodyClass::new(body.kind(), body.activity())));
        let colliders = self.colliders_of(body.id()).into_iter().flatten().filter_map(|id| self.collider(id).ok());
        let mut is_point = true;
        if let Some(shape) = body.shape() {
            is_point = false;
            draw_geometry(shape.geometry(), &at, role, draw);
        }
        for collider in colliders {
            is_point = false;
            let collider_at = at.part(collider.position.to_f64(), collider.angle.to_f64());
            draw_geometry(collider.shape.geometry(), &collider_at, role, draw);
        }
        if is_point {
            draw.point(pose.position, role);
        }
    }

    fn draw_field(
        &self,
        id: FieldId,
        field: &ForceField<S>,
        pose: &impl Fn(&BodyRef<'_, S>) -> Pose,
        draw: &mut (impl DebugDraw + ?Sized),
    ) {
        let attached = |at: &Attachment<S>| {
            let placed = Placed::at(pose(&self.body(at.body).ok()?));
            Some((placed, placed.point(at.point.to_f64())))
        };
        let end = |end: &End<S>| match end {
            End::World(point) => Some(point.to_f64()),
            End::Body(at) => attached(at).map(|(_, point)| point),
        };
        match &field.kind {
            FieldKind::Spring { near, far, .. } => {
                if let (Some((_, near)), Some(far)) = (attached(near), end(far)) {
                    draw.segment([near, far], Role::Spring(id));
                }
            }
            FieldKind::Attractor { centre, .. } => {
                if let Some(centre) = end(centre) {
                    draw.point(centre, Role::Attractor(id));
                }
            }
            FieldKind::Thrust { at, force } => {
                let Some((placed, to)) = attached(at) else { return };
                if let Some(along) = unit(placed.turned(force.to_f64())) {
                    draw.arrow([to[0] - along[0], to[1] - along[1]], to, Role::Thrust(id));
                }
            }
            FieldKind::Zone { region, acceleration } => {
                let role = Role::Zone(id);
                let middle = match region {
                    Region::Disc { centre, radius } => {
                        let centre = centre.to_f64();
                        draw.circle(centre, radius.to_f64(), None, role);
                        centre
                    }
                    Region::Box { min, max } => {
                        let ([left, bottom], [right, top]) = (min.to_f64(), max.to_f64());
                        draw.polygon(&[[left, bottom], [right, bottom], [right, top], [left, top]], role);
                        [(left + right) / 2.0, (bottom + top) / 2.0]
                    }
                };
                if let Some(along) = unit(acceleration.to_f64()) {
                    draw.arrow(middle, [middle[0] + along[0], middle[1] + along[1]], role);
                }
            }
            FieldKind::Drag { .. } | FieldKind::Custom { .. } => {}
        }
    }
}

fn unit([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let length = libm::hypot(x, y);
    (length > 0.0).then(|| [x / length, y / length])
}

impl<S: Scalar + ToF64> Shape<S> {
    /// Draws the shape with its centre of mass at a pose: the parts of a compound one after the other.
    pub fn debug_draw(&self, pose: Pose, role: Role, draw: &mut (impl DebugDraw + ?Sized)) {
        draw_geometry(self.geometry(), &Placed::at(pose), role, draw);
    }
}

/// The points of the rim of a rounded polygon: five to each corner, in equal parts of its arc.
fn rounded(corners: &[[f64; 2]], radius: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = corners.len();
    let normal = move |i: usize| {
        let ([ax, ay], [bx, by]) = (corners[i % count], corners[(i + 1) % count]);
        libm::atan2(ax - bx, by - ay)
    };
    (0..count).flat_map(move |i| {
        let (from, [x, y]) = (normal(i + count - 1), corners[i]);
        let turn = normal(i) - from;
        let turn = if turn < 0.0 { turn + core::f64::consts::TAU } else { turn };
        (0..5).map(move |k| {
            let angle = from + turn * f64::from(k) / 4.0;
            [x + radius * libm::cos(angle), y + radius * libm::sin(angle)]
        })
    })
}

fn draw_geometry<S: Scalar + ToF64>(
    geometry: &Geometry<S>,
    at: &Placed,
    role: Role,
    draw: &mut (impl DebugDraw + ?Sized),
) {
    let place = |v: &Vec2<S>| at.point(v.to_f64());
    match geometry {
        Geometry::Circle { radius } => {
            let radius = radius.to_f64();
            draw.circle(at.pose.position, radius, Some(at.point([radius, 0.0])), role);
        }
        Geometry::Rectangle { width, height } => {
            let (w, h) = (width.to_f64() / 2.0, height.to_f64() / 2.0);
            draw.polygon(&[[-w, -h], [w, -h], [w, h], [-w, h]].map(|corner| at.point(corner)), role);
        }
        Geometry::Capsule { length, radius } => {
            let half = length.to_f64() / 2.0;
            draw.capsule([[-half, 0.0], [half, 0.0]].map(|end| at.point(end)), radius.to_f64(), role);
        }
        Geometry::Polygon { corners } => {
            let corners: Vec<[f64; 2]> = corners.iter().map(place).collect();
            draw.polygon(&corners, role);
        }
        Geometry::RoundedPolygon { corners, radius } => {
            let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.to_f64()).collect();
            let rim: Vec<[f64; 2]> = rounded(&corners, radius.to_f64()).map(|point| at.point(point)).collect();
            draw.polygon(&rim, role);
        }
        Geometry::Segment { ends } => draw.segment([place(&ends[0]), place(&ends[1])], role),
        Geometry::Compound { parts } => {
            for part in parts.iter() {
                let part_at = at.part(part.position.to_f64(), part.angle.to_f64());
                draw_geometry(part.shape.geometry(), &part_at, role, draw);
            }
        }
    }
}
