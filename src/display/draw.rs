//! Drawing a world: outlines, force fields, joints, velocities and contacts, to whatever can draw.

use super::outline::{draw_geometry, round};
use super::pose::{Placed, Pose};
use crate::body::{Activity, BodyKind};
use crate::contact::Contact;
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::joint::{JointKind, Motor, Prismatic, Pulley, Wheel};
use crate::math::Vec2;
use crate::scalar::{Scalar, ToF64};
use crate::slots::{BodyId, ColliderId, FieldId, JointId};
use crate::world::{BodyRef, JointRef, World};

/// Class of a body for drawing: kind and activity in one, to choose a colour by.
///
/// ```
/// use umbra_physics::{Activity, BodyClass, BodyKind, Role};
///
/// let class = BodyClass::new(BodyKind::Dynamic, Activity::Asleep);
/// assert_eq!(class, BodyClass::Asleep);
/// let colour = |role| match role {
///     Role::Body(_, class) | Role::Collider(_, _, class) => match class {
///         BodyClass::Asleep | BodyClass::Static => "grey",
///         BodyClass::Quarantined => "red",
///         _ => "blue",
///     },
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
    /// A point at the position of a body that has no colliders.
    Body(BodyId, BodyClass),
    /// The outline of a collider of a body: [`World::collider`] tells whether it is a sensor, one-way, or a belt.
    Collider(BodyId, ColliderId, BodyClass),
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
    /// The box of a fluid, and an arrow of 1 m from its middle along its flow.
    Buoyancy(FieldId),
    /// The two ends of a joint, and the line between them, of a pulley over its points; of a prismatic or a wheel joint the axis too, from its
    /// lower limit to its upper one, or half a metre on both sides of the first end if it has none. Of a motor joint the point that its spring
    /// pulls to, in place of the first end; without a spring the second end alone.
    Joint(JointId),
    /// A point of the contact of these two colliders.
    Contact([ColliderId; 2]),
    /// An arrow from a point of their contact along its normal, from the first collider to the second one.
    ContactNormal([ColliderId; 2]),
    /// An arrow along the impulse that acts on the second collider at a point of their contact, along the normal.
    ContactImpulse([ColliderId; 2]),
    /// An arrow along the impulse of friction that acts on the second collider, from the middle of the points of their contact.
    FrictionImpulse([ColliderId; 2]),
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
/// let plank = Shape::rectangle(fx!(2), fx!(1))?;
/// world.add_body(BodyDef { position: vec2(5, 0), ..BodyDef::dynamic().with_collider(plank) })?;
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

/// Selection of the parts of a world to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawOptions {
    /// The outlines of bodies.
    pub bodies: bool,
    /// Force fields that are somewhere: springs, attractors, thrusts, zones.
    pub fields: bool,
    /// The ends of joints that steps keep, the lines between them, and their axes.
    pub joints: bool,
    /// Velocities, as the distance that each body moves in this many seconds.
    pub velocities: Option<f64>,
    /// The points of [contacts](World::contacts).
    pub contacts: bool,
    /// The normals of contacts, as arrows of this many m.
    pub contact_normals: Option<f64>,
    /// The impulses of contacts, as arrows of this many m for each N·s of the last sub-step: along the normal at each point, and
    /// friction. Impulses of zero are left out.
    ///
    /// A body of m kg at rest has impulses of m·g·h/n in all, with the time step h and n sub-steps: 1/30 N·s for 1 kg at 60
    /// steps a second with the default of 5.
    pub contact_impulses: Option<f64>,
}

impl Default for DrawOptions {
    /// Bodies, fields and joints.
    fn default() -> Self {
        Self {
            bodies: true,
            fields: true,
            joints: true,
            velocities: None,
            contacts: false,
            contact_normals: None,
            contact_impulses: None,
        }
    }
}

impl DrawOptions {
    fn has_contacts(&self) -> bool {
        self.contacts || self.contact_normals.is_some() || self.contact_impulses.is_some()
    }
}

impl<S: Scalar + ToF64> World<S> {
    /// Draws the world with its bodies at these poses: those of the tick ([`Pose::of`]), or of an
    /// [`Interpolation`](super::Interpolation).
    ///
    /// First the fields in the order in which they were added, then the bodies in the order of their slots, then the joints in the order of
    /// their keys, then the velocities in the order of the bodies, then the contacts by the slots of their colliders. The state of the world is only read.
    ///
    /// Contacts are computed here, and only if an option asks for them. Their points go with the poses: each is drawn in the
    /// middle of where its two bodies carry it. The directions of their arrows are those of the tick.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, DebugDraw, DrawOptions, Pose, Role, Shape, World, WorldDef, fx, vec2};
    ///
    /// /// The lengths of impulses, m.
    /// #[derive(Default)]
    /// struct Impulses(Vec<f64>);
    ///
    /// impl DebugDraw for Impulses {
    ///     fn polygon(&mut self, _corners: &[[f64; 2]], _role: Role) {}
    ///     fn point(&mut self, _at: [f64; 2], _role: Role) {}
    ///     fn segment(&mut self, _ends: [[f64; 2]; 2], _role: Role) {}
    ///     fn arrow(&mut self, from: [f64; 2], to: [f64; 2], role: Role) {
    ///         if let Role::ContactImpulse(_colliders) = role {
    ///             self.0.push((to[0] - from[0]).hypot(to[1] - from[1]));
    ///         }
    ///     }
    /// }
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(20, 2)?))?;
    /// let crate_ = BodyDef::dynamic().with_collider(Shape::rectangle(1, 1)?); // 1 kg
    /// world.add_body(BodyDef { position: vec2(0, fx!(1.5)), ..crate_ })?;
    /// (0..60).for_each(|_| _ = world.step());
    /// // 30 m for each N·s: the weight of a kilogram for 1/300 s is an arrow of a metre, here in two halves.
    /// let options = DrawOptions { contact_impulses: Some(30.0), ..DrawOptions::default() };
    /// let mut impulses = Impulses::default();
    /// world.debug_draw(Pose::of, &options, &mut impulses);
    /// assert!(impulses.0.len() == 2 && impulses.0.iter().all(|length| (length - 0.5).abs() < 0.01));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
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
        if options.joints {
            for joint in self.joints().filter(JointRef::is_active) {
                self.draw_joint(&joint, &pose, draw);
            }
        }
        if let Some(seconds) = options.velocities {
            for body in self.bodies().filter(|body| body.velocity() != Vec2::ZERO) {
                let (from, velocity) = (pose(&body).position, body.velocity().to_f64());
                let to = [0, 1].map(|i| from[i] + velocity[i] * seconds);
                draw.arrow(from, to, Role::Velocity(body.id()));
            }
        }
        if options.has_contacts() {
            for contact in self.contacts() {
                self.draw_contact(&contact, &pose, options, draw);
            }
        }
    }

    fn draw_contact(
        &self,
        contact: &Contact<S>,
        pose: &impl Fn(&BodyRef<'_, S>) -> Pose,
        options: &DrawOptions,
        draw: &mut (impl DebugDraw + ?Sized),
    ) {
        let [Ok(a), Ok(b)] = contact.bodies.map(|body| self.body(body)) else { return };
        let carried = [(a, Placed::at(pose(&a))), (b, Placed::at(pose(&b)))];
        let shown = |at: Vec2<S>| {
            let points = carried
                .each_ref()
                .map(|(body, placed)| body.local_point(at).map_or(at.to_f64(), |local| placed.point(local.to_f64())));
            middle(points[0], points[1])
        };
        let ([x, y], colliders) = (contact.normal.to_f64(), contact.colliders);
        let mut arrow = |from: [f64; 2], along: [f64; 2], length: f64, role| {
            if length != 0.0 {
                draw.arrow(from, [from[0] + along[0] * length, from[1] + along[1] * length], role);
            }
        };
        let (mut first, mut last) = (None, [0.0; 2]);
        for point in contact.points() {
            last = shown(point.position);
            first.get_or_insert(last);
            if let Some(length) = options.contact_normals {
                arrow(last, [x, y], length, Role::ContactNormal(colliders));
            }
            if let Some(scale) = options.contact_impulses {
                arrow(last, [x, y], point.normal_impulse.to_f64() * scale, Role::ContactImpulse(colliders));
            }
        }
        if let (Some(scale), Some(first)) = (options.contact_impulses, first) {
            let length = contact.tangent_impulse.to_f64() * scale;
            arrow(middle(first, last), [y, -x], length, Role::FrictionImpulse(colliders));
        }
        if options.contacts {
            contact.points().iter().for_each(|point| draw.point(shown(point.position), Role::Contact(colliders)));
        }
    }

    fn draw_body(&self, body: &BodyRef<'_, S>, pose: Pose, draw: &mut (impl DebugDraw + ?Sized)) {
        let at = Placed::at(pose);
        let class = BodyClass::new(body.kind(), body.activity());
        let mut is_point = true;
        for id in self.colliders_of(body.id()).into_iter().flatten() {
            let Ok(collider) = self.collider(id) else { continue };
            is_point = false;
            let collider_at = at.part(collider.position.to_f64(), collider.angle.to_f64());
            draw_geometry(collider.shape.geometry(), &collider_at, Role::Collider(body.id(), id, class), draw);
        }
        if is_point {
            draw.point(pose.position, Role::Body(body.id(), class));
        }
    }

    /// The place of the body of an attachment, and the point.
    fn attached(&self, at: &Attachment<S>, pose: &impl Fn(&BodyRef<'_, S>) -> Pose) -> Option<(Placed, [f64; 2])> {
        let placed = Placed::at(pose(&self.body(at.body).ok()?));
        Some((placed, placed.point(at.point.to_f64())))
    }

    /// The place of the body of an end, at the origin for the world, and the point.
    fn end(&self, end: &End<S>, pose: &impl Fn(&BodyRef<'_, S>) -> Pose) -> Option<(Placed, [f64; 2])> {
        match end {
            End::World(point) => Some((Placed::at(Pose::ORIGIN), point.to_f64())),
            End::Body(at) => self.attached(at, pose),
        }
    }

    fn draw_joint(
        &self,
        joint: &JointRef<'_, S>,
        pose: &impl Fn(&BodyRef<'_, S>) -> Pose,
        draw: &mut (impl DebugDraw + ?Sized),
    ) {
        let (role, def) = (Role::Joint(joint.id()), joint.def());
        let [first, second] = &def.ends;
        let (Some((placed, from)), Some((_, to))) = (self.end(first, pose), self.end(second, pose)) else { return };
        let frame = Placed::at(Pose { position: from, angle: placed.pose.angle + def.angles[0].to_f64() });
        let from = match &def.kind {
            JointKind::Motor(Motor { spring, .. }) => spring.map_or(to, |spring| frame.point(spring.rest.to_f64())),
            _ => from,
        };
        if let JointKind::Pulley(Pulley { grounds, .. }) = &def.kind {
            let [left, right] = grounds.map(|ground| ground.to_f64());
            [[from, left], [left, right], [right, to]].into_iter().for_each(|line| draw.segment(line, role));
        } else {
            draw.segment([from, to], role);
        }
        if let JointKind::Prismatic(Prismatic { limits, .. }) | JointKind::Wheel(Wheel { limits, .. }) = &def.kind {
            let ways = limits.map_or([-0.5, 0.5], |limits| [limits.lower, limits.upper].map(ToF64::to_f64));
            draw.segment(ways.map(|way| frame.point([way, 0.0])), role);
        }
        draw.point(from, role);
        draw.point(to, role);
    }

    fn draw_field(
        &self,
        id: FieldId,
        field: &ForceField<S>,
        pose: &impl Fn(&BodyRef<'_, S>) -> Pose,
        draw: &mut (impl DebugDraw + ?Sized),
    ) {
        let attached = |at: &Attachment<S>| self.attached(at, pose);
        let end = |end: &End<S>| self.end(end, pose).map(|(_, point)| point);
        match &field.kind {
            FieldKind::Spring { near, far, .. } => {
                if let (Some((_, start)), Some(end)) = (attached(near), end(far)) {
                    draw.segment([start, end], Role::Spring(id));
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
            FieldKind::Buoyancy { min, max, flow, .. } => {
                let role = Role::Buoyancy(id);
                let ([left, bottom], [right, top]) = (min.to_f64(), max.to_f64());
                draw.polygon(&[[left, bottom], [right, bottom], [right, top], [left, top]], role);
                if let Some(along) = unit(flow.to_f64()) {
                    let middle = [(left + right) / 2.0, (bottom + top) / 2.0];
                    draw.arrow(middle, [middle[0] + along[0], middle[1] + along[1]], role);
                }
            }
            FieldKind::Drag { .. } | FieldKind::Friction { .. } | FieldKind::Custom { .. } => {}
        }
    }
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| a[i] + (b[i] - a[i]) / 2.0)
}

fn unit([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let length = libm::hypot(x, y);
    (length > 0.0).then(|| [x / length, y / length])
}
