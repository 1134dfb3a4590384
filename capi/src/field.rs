//! Force fields.

use std::mem::MaybeUninit;

use umbra_physics::{Attachment, Command, End, FieldKind, ForceField, Fx, Region, SpringConstants};

use crate::UMBRA_NO_HANDLE;
use crate::memory::{fill, given};
use crate::number::{UmbraFactor, UmbraFx, UmbraVec2, factor};
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word, change, change_by, created, field_id, field_word, look};

/// A kind of force field: one of the seven below.
pub type UmbraFieldKind = u32;

/// Acceleration mu·d / (d² + softening²)^(3/2) towards a point, the same for every mass. Reads `other`, `other_point`, `mu`,
/// `softening`.
pub const UMBRA_ATTRACTOR: UmbraFieldKind = 0;
/// A spring with a damper along it. Reads `body`, `point`, `other`, `other_point`, `rest`, `stiffness`, `damping`.
pub const UMBRA_SPRING: UmbraFieldKind = 1;
/// Drag against a medium: F = −(linear + quadratic·|u|)·u with u the velocity relative to it. Reads `linear`, `quadratic`,
/// `wind`.
pub const UMBRA_DRAG: UmbraFieldKind = 2;
/// A force that turns with the body. Reads `body`, `point`, `force`.
pub const UMBRA_THRUST: UmbraFieldKind = 3;
/// A constant acceleration of the bodies whose centre of mass is in a region. Reads `region` and what that reads, and
/// `acceleration`.
pub const UMBRA_ZONE: UmbraFieldKind = 4;
/// A fluid in a box, which lifts colliders by the area that they have in it and slows them down. Reads `min`, `max`, `density`,
/// `linear_drag`, `angular_drag`, `flow`.
pub const UMBRA_BUOYANCY: UmbraFieldKind = 5;
/// Friction with a ground that is seen from above: speed and spin fall at constant rates to nothing. Reads `deceleration`,
/// `angular_deceleration`.
pub const UMBRA_FRICTION: UmbraFieldKind = 6;

/// The region of a zone: one of the two below. Its edge belongs to it.
pub type UmbraRegion = u32;

/// Reads `centre` and `radius`.
pub const UMBRA_DISC: UmbraRegion = 0;
/// Reads `min` and `max`.
pub const UMBRA_BOX: UmbraRegion = 1;

/// All groups.
pub const UMBRA_ALL_FORCE_GROUPS: u32 = 0xFFFF_FFFF;

/// A force field: its kind, and the bodies that it acts on. Only what its kind reads matters. `umbra_field_def_default` fills
/// it in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraFieldDef {
    /// The kind.
    pub kind: UmbraFieldKind,
    /// Groups of dynamic bodies that the field acts on, as bits; springs and thrusts act on their bodies alone. Default all.
    pub force_groups: u32,
    /// The region of a zone.
    pub region: UmbraRegion,
    /// 0.
    pub reserved: u32,
    /// The body that a thrust acts on, or a spring's near end is at.
    pub body: u64,
    /// Point of the body, in its own axes from its centre of mass, m.
    pub point: UmbraVec2,
    /// The body that an attractor's centre or a spring's far end is at, or `UMBRA_NO_HANDLE` for a point of the world.
    pub other: u64,
    /// Point of the body, or of the world, m.
    pub other_point: UmbraVec2,
    /// The gravitational parameter G·M of an attractor, 0 to 2^64 m³/s².
    pub mu: UmbraFactor,
    /// The distance below which an attractor softens, 0 to 2^12 m.
    pub softening: UmbraFx,
    /// The length of a spring at rest, 0 to 2^30 m.
    pub rest: UmbraFx,
    /// The stiffness of a spring, from 0, N/m.
    pub stiffness: UmbraFx,
    /// The damping along a spring, from 0, N·s/m.
    pub damping: UmbraFx,
    /// The linear part of a drag, from 0, N·s/m.
    pub linear: UmbraFx,
    /// The quadratic part of a drag, from 0, N·s²/m².
    pub quadratic: UmbraFx,
    /// The velocity of the medium of a drag, m/s.
    pub wind: UmbraVec2,
    /// The force of a thrust in the body's axes, N.
    pub force: UmbraVec2,
    /// The acceleration of a zone, m/s².
    pub acceleration: UmbraVec2,
    /// The centre of a disc, m.
    pub centre: UmbraVec2,
    /// The radius of a disc, m.
    pub radius: UmbraFx,
    /// The lower left corner of a box, m.
    pub min: UmbraVec2,
    /// The upper right corner of a box, m.
    pub max: UmbraVec2,
    /// The density of a fluid, from 0, kg/m².
    pub density: UmbraFx,
    /// The linear drag of a fluid, from 0, N·s/m for each m² in it.
    pub linear_drag: UmbraFx,
    /// The angular drag of a fluid, from 0, N·m·s for each m² in it.
    pub angular_drag: UmbraFx,
    /// The velocity of a fluid, m/s.
    pub flow: UmbraVec2,
    /// The deceleration by a friction, 0 to 2^16 m/s².
    pub deceleration: UmbraFx,
    /// The deceleration of the spin by a friction, 0 to 2^16 rad/s².
    pub angular_deceleration: UmbraFx,
}

const EMPTY: UmbraVec2 = UmbraVec2 { x: 0, y: 0 };

/// A field whose kind is not set yet.
const BLANK: UmbraFieldDef = UmbraFieldDef {
    kind: 0,
    force_groups: UMBRA_ALL_FORCE_GROUPS,
    region: UMBRA_DISC,
    reserved: 0,
    body: UMBRA_NO_HANDLE,
    point: EMPTY,
    other: UMBRA_NO_HANDLE,
    other_point: EMPTY,
    mu: UmbraFactor { mantissa: 0, shift: 0, reserved: 0 },
    softening: 0,
    rest: 0,
    stiffness: 0,
    damping: 0,
    linear: 0,
    quadratic: 0,
    wind: EMPTY,
    force: EMPTY,
    acceleration: EMPTY,
    centre: EMPTY,
    radius: 0,
    min: EMPTY,
    max: EMPTY,
    density: 0,
    linear_drag: 0,
    angular_drag: 0,
    flow: EMPTY,
    deceleration: 0,
    angular_deceleration: 0,
};

impl UmbraFieldDef {
    fn near(&self) -> Attachment {
        Attachment { body: body_id(self.body), point: self.point.into() }
    }

    fn end(&self) -> End {
        match self.other {
            UMBRA_NO_HANDLE => End::World(self.other_point.into()),
            handle => End::Body(Attachment { body: body_id(handle), point: self.other_point.into() }),
        }
    }

    fn set_near(&mut self, at: &Attachment) {
        (self.body, self.point) = (body_word(at.body), at.point.into());
    }

    fn set_end(&mut self, end: &End) {
        (self.other, self.other_point) = match end {
            End::World(point) => (UMBRA_NO_HANDLE, (*point).into()),
            End::Body(at) => (body_word(at.body), at.point.into()),
        };
    }

    fn field(&self) -> Result<ForceField> {
        let kind = match self.kind {
            UMBRA_ATTRACTOR => FieldKind::Attractor {
                centre: self.end(),
                mu: factor(self.mu)?,
                softening: Fx::from_bits(self.softening),
            },
            UMBRA_SPRING => {
                let (rest, stiffness) = (Fx::from_bits(self.rest), Fx::from_bits(self.stiffness));
                let spring = SpringConstants { rest, stiffness, damping: Fx::from_bits(self.damping) };
                FieldKind::Spring { near: self.near(), far: self.end(), spring }
            }
            UMBRA_DRAG => FieldKind::Drag {
                linear: Fx::from_bits(self.linear),
                quadratic: Fx::from_bits(self.quadratic),
                wind: self.wind.into(),
            },
            UMBRA_FRICTION => FieldKind::Friction {
                deceleration: Fx::from_bits(self.deceleration),
                angular_deceleration: Fx::from_bits(self.angular_deceleration),
            },
            UMBRA_THRUST => FieldKind::Thrust { at: self.near(), force: self.force.into() },
            UMBRA_ZONE => FieldKind::Zone { region: self.zone()?, acceleration: self.acceleration.into() },
            UMBRA_BUOYANCY => FieldKind::Buoyancy {
                min: self.min.into(),
                max: self.max.into(),
                density: Fx::from_bits(self.density),
                linear_drag: Fx::from_bits(self.linear_drag),
                angular_drag: Fx::from_bits(self.angular_drag),
                flow: self.flow.into(),
            },
            _ => return Err(Refusal::bad("no kind of force field has this number")),
        };
        Ok(ForceField { kind, force_groups: self.force_groups })
    }

    fn zone(&self) -> Result<Region> {
        match self.region {
            UMBRA_DISC => Ok(Region::Disc { centre: self.centre.into(), radius: Fx::from_bits(self.radius) }),
            UMBRA_BOX => Ok(Region::Box { min: self.min.into(), max: self.max.into() }),
            _ => Err(Refusal::bad("no region has this number")),
        }
    }

    fn of(field: &ForceField) -> Result<Self> {
        let mut def = Self { force_groups: field.force_groups, ..BLANK };
        match &field.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                def.kind = UMBRA_ATTRACTOR;
                def.set_end(centre);
                (def.mu, def.softening) = ((*mu).into(), softening.to_bits());
            }
            FieldKind::Spring { near, far, spring } => {
                def.kind = UMBRA_SPRING;
                def.set_near(near);
                def.set_end(far);
                (def.rest, def.stiffness) = (spring.rest.to_bits(), spring.stiffness.to_bits());
                def.damping = spring.damping.to_bits();
            }
            FieldKind::Drag { linear, quadratic, wind } => {
                def.kind = UMBRA_DRAG;
                (def.linear, def.quadratic, def.wind) = (linear.to_bits(), quadratic.to_bits(), (*wind).into());
            }
            FieldKind::Friction { deceleration, angular_deceleration } => {
                (def.kind, def.deceleration) = (UMBRA_FRICTION, deceleration.to_bits());
                def.angular_deceleration = angular_deceleration.to_bits();
            }
            FieldKind::Thrust { at, force } => {
                def.kind = UMBRA_THRUST;
                def.set_near(at);
                def.force = (*force).into();
            }
            FieldKind::Zone { region, acceleration } => {
                (def.kind, def.acceleration) = (UMBRA_ZONE, (*acceleration).into());
                match *region {
                    Region::Disc { centre, radius } => {
                        (def.region, def.centre, def.radius) = (UMBRA_DISC, centre.into(), radius.to_bits());
                    }
                    Region::Box { min, max } => {
                        (def.region, def.min, def.max) = (UMBRA_BOX, min.into(), max.into());
                    }
                }
            }
            FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow } => {
                (def.kind, def.min, def.max, def.flow) = (UMBRA_BUOYANCY, (*min).into(), (*max).into(), (*flow).into());
                (def.density, def.linear_drag) = (density.to_bits(), linear_drag.to_bits());
                def.angular_drag = angular_drag.to_bits();
            }
            _ => return Err(Refusal::bad("this interface does not have the kind of this force field")),
        }
        Ok(def)
    }
}

/// Fills in the definition of a field of a kind: all groups, no body, everything else 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_field_def_default(
    kind: UmbraFieldKind,
    def: Option<&mut MaybeUninit<UmbraFieldDef>>,
) -> UmbraStatus {
    guard(|| {
        let place = given(def)?;
        if kind > UMBRA_FRICTION {
            return Err(Refusal::bad("no kind of force has this number"));
        }
        place.write(UmbraFieldDef { kind, ..BLANK });
        Ok(())
    })
}

/// Adds a force field; wakes what it may act on.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_add_field(
    world: Option<&mut UmbraWorld>,
    def: Option<&UmbraFieldDef>,
    field: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, def, place) = (given(world)?, given(def)?, given(field)?);
        place.write(created(world.execute(&Command::AddField(def.field()?))?).1);
        Ok(())
    })
}

/// Puts another force field in the place of one; wakes what either may act on.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_field(
    world: Option<&mut UmbraWorld>,
    field: u64,
    def: Option<&UmbraFieldDef>,
) -> UmbraStatus {
    change_by(world, || Ok(Command::SetField { id: field_id(field), field: given(def)?.field()? }))
}

/// Removes a force field; wakes what it may have acted on.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_remove_field(world: Option<&mut UmbraWorld>, field: u64) -> UmbraStatus {
    change(world, Command::RemoveField(field_id(field)))
}

/// Reads a force field.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_field(
    world: Option<&UmbraWorld>,
    field: u64,
    def: Option<&mut MaybeUninit<UmbraFieldDef>>,
) -> UmbraStatus {
    look(world, def, |world| UmbraFieldDef::of(world.field(field_id(field))?))
}

/// The handles of all force fields, in the order in which they were added, in which drags act; a list as
/// `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_fields(
    world: Option<&UmbraWorld>,
    fields: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<u64> = given(world)?.world().fields().map(|(id, _)| field_word(id)).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), fields, capacity, count) }
    })
}
