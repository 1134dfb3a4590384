//! Drawing a world: outlines, force fields, joints, velocities and contacts, as corners in floats. The only floats of the interface, and
//! they only leave it.

use std::mem::MaybeUninit;

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyClass, ColliderId, DebugDraw, DrawOptions, Fx, Pose, Role, Vec2};

use crate::UMBRA_NO_HANDLE;
use crate::collider::collider_word;
use crate::joint::joint_word;
use crate::memory::{fill, given};
use crate::number::{UmbraFx, UmbraVec2};
use crate::status::{UmbraStatus, guard};
use crate::world::{UmbraWorld, body_word, field_word};

/// Form of a figure: one of the four values below.
pub type UmbraFigureForm = u32;

/// A convex area by its corners, counter-clockwise. Discs and round ends have corners too: 48 to a whole disc.
pub const UMBRA_FIGURE_POLYGON: UmbraFigureForm = 0;
/// A line, by its two ends.
pub const UMBRA_FIGURE_SEGMENT: UmbraFigureForm = 1;
/// An arrow, by its two ends: to the second one.
pub const UMBRA_FIGURE_ARROW: UmbraFigureForm = 2;
/// A point without a size: a mark.
pub const UMBRA_FIGURE_POINT: UmbraFigureForm = 3;

/// Meaning of a figure: one of the values below. Later versions may have more.
pub type UmbraFigureRole = u32;

/// A role that this version of the interface has no number for.
pub const UMBRA_ROLE_OTHER: UmbraFigureRole = 0;
/// The outline of a collider of a body, or a point at the position of a body without any: `handle` is the body, `other` the collider.
pub const UMBRA_ROLE_BODY: UmbraFigureRole = 1;
/// An arrow along the velocity of a body: `handle` is the body.
pub const UMBRA_ROLE_VELOCITY: UmbraFigureRole = 2;
/// A spring, from end to end: `handle` is the field.
pub const UMBRA_ROLE_SPRING: UmbraFigureRole = 3;
/// The centre of an attractor: `handle` is the field.
pub const UMBRA_ROLE_ATTRACTOR: UmbraFigureRole = 4;
/// An arrow to the point that a thrust acts at: `handle` is the field.
pub const UMBRA_ROLE_THRUST: UmbraFigureRole = 5;
/// The region of a zone, and an arrow along its acceleration: `handle` is the field.
pub const UMBRA_ROLE_ZONE: UmbraFigureRole = 6;
/// The box of a fluid, and an arrow along its flow: `handle` is the field.
pub const UMBRA_ROLE_BUOYANCY: UmbraFigureRole = 7;
/// The ends of a joint, the line between them, and its axis if it has one: `handle` is the joint.
pub const UMBRA_ROLE_JOINT: UmbraFigureRole = 8;
/// A point of a contact: `handle` and `other` are its colliders.
pub const UMBRA_ROLE_CONTACT: UmbraFigureRole = 9;
/// An arrow along the normal of a contact, from the first collider, `handle`, to the second one, `other`.
pub const UMBRA_ROLE_CONTACT_NORMAL: UmbraFigureRole = 10;
/// An arrow along the impulse on the second collider of a contact, `other`.
pub const UMBRA_ROLE_CONTACT_IMPULSE: UmbraFigureRole = 11;
/// An arrow along the impulse of friction on the second collider of a contact, `other`.
pub const UMBRA_ROLE_FRICTION_IMPULSE: UmbraFigureRole = 12;

/// Class of a body for drawing, to choose a colour by: one of the values below.
pub type UmbraBodyClass = u32;

/// Moved by everything, and awake.
pub const UMBRA_CLASS_DYNAMIC: UmbraBodyClass = 0;
/// Moved by the velocity it is given.
pub const UMBRA_CLASS_KINEMATIC: UmbraBodyClass = 1;
/// Moved by nothing.
pub const UMBRA_CLASS_STATIC: UmbraBodyClass = 2;
/// At rest and skipped.
pub const UMBRA_CLASS_ASLEEP: UmbraBodyClass = 3;
/// Taken out of the simulation by a step.
pub const UMBRA_CLASS_QUARANTINED: UmbraBodyClass = 4;
/// Taken out of the simulation by a call.
pub const UMBRA_CLASS_DISABLED: UmbraBodyClass = 5;

const CLASSES: [BodyClass; 6] = [
    BodyClass::Dynamic,
    BodyClass::Kinematic,
    BodyClass::Static,
    BodyClass::Asleep,
    BodyClass::Quarantined,
    BodyClass::Disabled,
];

/// The parts of a world that are drawn, and the place from which their points are measured; `umbra_draw_options_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraDrawOptions {
    /// Points are measured from here, m: from the camera in a large world, as a float has 24 bits, a millimetre at 10 km. Default 0, 0.
    pub origin: UmbraVec2,
    /// Velocities, as the way that a body takes in this many seconds; 0, the default, for none.
    pub velocity_seconds: UmbraFx,
    /// Normals of contacts, as arrows of this many m; 0, the default, for none.
    pub normal_length: UmbraFx,
    /// Impulses of contacts, as arrows of this many m for each N·s of the last sub-step; 0, the default, for none.
    pub impulse_scale: UmbraFx,
    /// 1, the default, for the outlines of bodies; or 0.
    pub bodies: u32,
    /// 1, the default, for force fields that are somewhere; or 0.
    pub fields: u32,
    /// 1, the default, for joints; or 0.
    pub joints: u32,
    /// 1 for the points of contacts; 0 is the default.
    pub contacts: u32,
}

/// A figure of a drawing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraFigure {
    /// The body, field, joint or collider that it shows, or `UMBRA_NO_HANDLE`.
    pub handle: u64,
    /// The collider of an outline, the second collider of a contact, or `UMBRA_NO_HANDLE`.
    pub other: u64,
    /// Its form.
    pub form: UmbraFigureForm,
    /// Its meaning.
    pub role: UmbraFigureRole,
    /// The class of a body that it outlines; of others 0.
    pub class: UmbraBodyClass,
    /// The number of points of the drawing before its own.
    pub first_point: u32,
    /// The number of its points: 1 of a point, 2 of a segment and an arrow, 3 and more of a polygon.
    pub point_count: u32,
    /// 0.
    pub reserved: u32,
}

/// A drawing of a world: figures, and the points that they have.
#[derive(Default)]
pub struct UmbraDrawing {
    figures: Vec<UmbraFigure>,
    /// x and y of each point, m.
    points: Vec<f32>,
}

/// The renderer that writes figures down.
struct Writer<'a> {
    drawing: &'a mut UmbraDrawing,
    origin: [f64; 2],
}

impl Writer<'_> {
    fn add(&mut self, form: UmbraFigureForm, points: &[[f64; 2]], drawn: Role) {
        let (role, handle, other) = number(drawn);
        let class = match drawn {
            Role::Body(_, class) | Role::Collider(_, _, class) => {
                CLASSES.iter().position(|&known| known == class).unwrap_or_default() as u32
            }
            _ => 0,
        };
        self.drawing.figures.push(UmbraFigure {
            handle,
            other,
            form,
            role,
            class,
            first_point: (self.drawing.points.len() / 2) as u32,
            point_count: points.len() as u32,
            reserved: 0,
        });
        let [x, y] = self.origin;
        self.drawing.points.extend(points.iter().flat_map(|point| [(point[0] - x) as f32, (point[1] - y) as f32]));
    }
}

impl DebugDraw for Writer<'_> {
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role) {
        self.add(UMBRA_FIGURE_POLYGON, corners, role);
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        self.add(UMBRA_FIGURE_SEGMENT, &ends, role);
    }

    fn point(&mut self, at: [f64; 2], role: Role) {
        self.add(UMBRA_FIGURE_POINT, &[at], role);
    }

    fn arrow(&mut self, from: [f64; 2], to: [f64; 2], role: Role) {
        self.add(UMBRA_FIGURE_ARROW, &[from, to], role);
    }
}

/// The number of a role, and the handles that it has.
fn number(role: Role) -> (UmbraFigureRole, u64, u64) {
    let pair = |number, [first, second]: [ColliderId; 2]| (number, collider_word(first), collider_word(second));
    let lone = |number, handle| (number, handle, UMBRA_NO_HANDLE);
    match role {
        Role::Body(body, _) => lone(UMBRA_ROLE_BODY, body_word(body)),
        Role::Collider(body, collider, _) => (UMBRA_ROLE_BODY, body_word(body), collider_word(collider)),
        Role::Velocity(body) => lone(UMBRA_ROLE_VELOCITY, body_word(body)),
        Role::Spring(field) => lone(UMBRA_ROLE_SPRING, field_word(field)),
        Role::Attractor(field) => lone(UMBRA_ROLE_ATTRACTOR, field_word(field)),
        Role::Thrust(field) => lone(UMBRA_ROLE_THRUST, field_word(field)),
        Role::Zone(field) => lone(UMBRA_ROLE_ZONE, field_word(field)),
        Role::Buoyancy(field) => lone(UMBRA_ROLE_BUOYANCY, field_word(field)),
        Role::Joint(joint) => lone(UMBRA_ROLE_JOINT, joint_word(joint)),
        Role::Contact(colliders) => pair(UMBRA_ROLE_CONTACT, colliders),
        Role::ContactNormal(colliders) => pair(UMBRA_ROLE_CONTACT_NORMAL, colliders),
        Role::ContactImpulse(colliders) => pair(UMBRA_ROLE_CONTACT_IMPULSE, colliders),
        Role::FrictionImpulse(colliders) => pair(UMBRA_ROLE_FRICTION_IMPULSE, colliders),
        _ => lone(UMBRA_ROLE_OTHER, UMBRA_NO_HANDLE),
    }
}

/// Fills in options: bodies, force fields and joints, measured from the origin of the world.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_draw_options_default(options: Option<&mut MaybeUninit<UmbraDrawOptions>>) -> UmbraStatus {
    guard(|| {
        given(options)?.write(UmbraDrawOptions { bodies: 1, fields: 1, joints: 1, ..UmbraDrawOptions::default() });
        Ok(())
    })
}

/// A drawing without figures, for `umbra_world_draw`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_drawing_new(drawing: Option<&mut MaybeUninit<Option<Box<UmbraDrawing>>>>) -> UmbraStatus {
    guard(|| {
        given(drawing)?.write(Some(Box::default()));
        Ok(())
    })
}

/// Draws a world at its tick, in place of what a drawing had, in its memory. Figures come in the order of the fields, the bodies, the joints,
/// the velocities and the contacts. Nothing of the world changes.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_draw(
    world: Option<&UmbraWorld>,
    options: Option<&UmbraDrawOptions>,
    drawing: Option<&mut UmbraDrawing>,
) -> UmbraStatus {
    guard(|| {
        let (world, def, drawing) = (given(world)?.world(), given(options)?, given(drawing)?);
        let scale = |bits: UmbraFx| (bits != 0).then(|| Fx::from_bits(bits).to_f64());
        let options = DrawOptions {
            bodies: def.bodies != 0,
            fields: def.fields != 0,
            joints: def.joints != 0,
            velocities: scale(def.velocity_seconds),
            contacts: def.contacts != 0,
            contact_normals: scale(def.normal_length),
            contact_impulses: scale(def.impulse_scale),
        };
        drawing.figures.clear();
        drawing.points.clear();
        world.debug_draw(Pose::of, &options, &mut Writer { drawing, origin: Vec2::from(def.origin).to_f64() });
        Ok(())
    })
}

/// The figures of a drawing; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_drawing_figures(
    drawing: Option<&UmbraDrawing>,
    figures: *mut UmbraFigure,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all = given(drawing)?.figures.iter().copied();
        // SAFETY: as the caller promises.
        unsafe { fill(all, figures, capacity, count) }
    })
}

/// The points of the figures of a drawing, m from the origin of its options: x and y of one after the other, in singles. A list as
/// `umbra_world_outcomes` gives it, with two entries to a point. For a renderer alone: a float that goes back into a world is a desync to come.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_drawing_points(
    drawing: Option<&UmbraDrawing>,
    coordinates: *mut f32,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all = given(drawing)?.points.iter().copied();
        // SAFETY: as the caller promises.
        unsafe { fill(all, coordinates, capacity, count) }
    })
}

/// Frees a drawing. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_drawing_free(drawing: Option<Box<UmbraDrawing>>) {
    drop(drawing);
}
