//! Colliders, and the settings of contacts.

use std::mem::MaybeUninit;

use umbra_physics::{ColliderDef, ColliderId, Command, ContactSettings, Filter, Fx, Material, MixRule};

use crate::memory::{fill, given};
use crate::number::{UMBRA_ONE, UmbraFx, UmbraVec2};
use crate::shape::UmbraShape;
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, change, change_by, look, made, word};

/// All categories of colliders.
pub const UMBRA_ALL_CATEGORIES: u32 = 0xFFFF_FFFF;

/// Rule by which the coefficients of two colliders that touch become one. Of two different ones the later one counts.
pub type UmbraMixRule = u32;

/// The geometric mean for friction, the larger one for restitution.
pub const UMBRA_MIX_STANDARD: UmbraMixRule = 0;
/// The geometric mean.
pub const UMBRA_MIX_GEOMETRIC_MEAN: UmbraMixRule = 1;
/// The mean.
pub const UMBRA_MIX_MEAN: UmbraMixRule = 2;
/// The smaller one.
pub const UMBRA_MIX_MINIMUM: UmbraMixRule = 3;
/// The product; of friction at most 32.
pub const UMBRA_MIX_PRODUCT: UmbraMixRule = 4;
/// The larger one.
pub const UMBRA_MIX_MAXIMUM: UmbraMixRule = 5;

const MIX_RULES: [MixRule; 6] =
    [MixRule::Standard, MixRule::GeometricMean, MixRule::Mean, MixRule::Minimum, MixRule::Product, MixRule::Maximum];

fn rule(number: UmbraMixRule) -> Result<MixRule> {
    MIX_RULES.get(number as usize).copied().ok_or_else(|| Refusal::bad("no mix rule has this number"))
}

fn number(rule: MixRule) -> UmbraMixRule {
    MIX_RULES.iter().position(|&own| own == rule).map_or(UMBRA_MIX_STANDARD, |number| number as u32)
}

/// Definition of a collider: a shape at a place of its body. `umbra_collider_def_default` fills it in, without a shape.
///
/// Two colliders touch if each has a category in the other's mask; two of one positive group always do, two of one negative group
/// never.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraColliderDef {
    /// Position of the shape's centre of mass relative to that of the body, in the body's axes, m, within ±2^12; default 0.
    pub position: UmbraVec2,
    /// The angle by which the shape is turned against the body, rad; default 0.
    pub angle: UmbraFx,
    /// Density, kg/m², kg/m for a segment, from 0, for bodies with `UMBRA_MASS_FROM_COLLIDERS`; default 1.
    pub density: UmbraFx,
    /// Coefficient of friction, 0 to 32; default 0.6.
    pub friction: UmbraFx,
    /// Coefficient of restitution, 0 to 1; default 0.
    pub restitution: UmbraFx,
    /// Speed of the surface around the shape, counter-clockwise, m/s, within ±2^10: a conveyor belt; default 0.
    pub surface_speed: UmbraFx,
    /// A name of the caller's, by which worlds built in another order are compared: 0.
    pub key: u64,
    /// Anything of the caller's: 0.
    pub user_data: u64,
    /// The categories it is in, as bits; default 1.
    pub category: u32,
    /// The categories that it meets, as bits; default all.
    pub mask: u32,
    /// The group; 0 for none.
    pub group: i32,
    /// Rule that mixes the coefficients of friction of two colliders; default `UMBRA_MIX_STANDARD`.
    pub friction_rule: UmbraMixRule,
    /// Rule that mixes the coefficients of restitution; default `UMBRA_MIX_STANDARD`.
    pub restitution_rule: UmbraMixRule,
    /// 0.
    pub reserved: u32,
    /// Shape. The last field, so that the offsets of the others do not depend on the size of pointers.
    pub shape: *const UmbraShape,
}

/// Settings of contacts; `umbra_contact_settings_default` fills them in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraContactSettings {
    /// The largest speed with which overlapping bodies are pushed apart, m/s, 0 to 2^10; default 3.
    pub push_speed: UmbraFx,
    /// The approach speed from which on bodies bounce, m/s, 0 to 2^10; default 1.
    pub restitution_speed: UmbraFx,
    /// The number of sub-steps in which contacts are solved, 1 to 8; default 5.
    pub substeps: u32,
    /// The number of pairs of outlines that may be close to each other in a step (a compound has one for each part), 1 to 2^28; default 2^20.
    pub max_pairs: u32,
    /// The number of pairs of one outline that may be close where there are more than `max_pairs` in all, 1 to 2^12; default 256.
    pub max_pairs_per_collider: u32,
    /// 0.
    pub reserved: u32,
}

const fn collider_id(word: u64) -> ColliderId {
    ColliderId::from_parts(word as u32, (word >> 32) as u32)
}

/// The definition without its shape.
fn values(def: &ColliderDef) -> UmbraColliderDef {
    UmbraColliderDef {
        position: def.position.into(),
        angle: def.angle.to_bits(),
        density: def.density.to_bits(),
        friction: def.material.friction.to_bits(),
        restitution: def.material.restitution.to_bits(),
        surface_speed: def.material.surface_speed.to_bits(),
        key: def.key,
        user_data: def.user_data,
        category: def.filter.category,
        mask: def.filter.mask,
        group: def.filter.group,
        friction_rule: number(def.material.friction_rule),
        restitution_rule: number(def.material.restitution_rule),
        reserved: 0,
        shape: std::ptr::null(),
    }
}

impl UmbraColliderDef {
    /// # Safety
    /// The shape is null or was not freed.
    unsafe fn def(&self) -> Result<ColliderDef> {
        // SAFETY: as the caller promises.
        let shape = given(unsafe { self.shape.as_ref() })?;
        let Self { category, mask, group, .. } = *self;
        Ok(ColliderDef {
            shape: shape.shape.clone(),
            position: self.position.into(),
            angle: Fx::from_bits(self.angle),
            density: Fx::from_bits(self.density),
            material: Material {
                friction: Fx::from_bits(self.friction),
                restitution: Fx::from_bits(self.restitution),
                surface_speed: Fx::from_bits(self.surface_speed),
                friction_rule: rule(self.friction_rule)?,
                restitution_rule: rule(self.restitution_rule)?,
            },
            filter: Filter { category, mask, group },
            key: self.key,
            user_data: self.user_data,
        })
    }
}

impl From<&ContactSettings> for UmbraContactSettings {
    fn from(settings: &ContactSettings) -> Self {
        let ContactSettings { substeps, push_speed, restitution_speed, max_pairs, max_pairs_per_collider } = *settings;
        let (push_speed, restitution_speed) = (push_speed.to_bits(), restitution_speed.to_bits());
        Self { push_speed, restitution_speed, substeps, max_pairs, max_pairs_per_collider, reserved: 0 }
    }
}

/// Fills in a definition: around the body's centre of mass, touching all others, without a shape.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_collider_def_default(def: Option<&mut MaybeUninit<UmbraColliderDef>>) -> UmbraStatus {
    guard(|| {
        let (material, filter) = (Material::default(), Filter::default());
        given(def)?.write(UmbraColliderDef {
            position: UmbraVec2::default(),
            angle: 0,
            density: UMBRA_ONE,
            friction: Fx::to_bits(material.friction),
            restitution: Fx::to_bits(material.restitution),
            surface_speed: 0,
            key: 0,
            user_data: 0,
            category: filter.category,
            mask: filter.mask,
            group: filter.group,
            friction_rule: UMBRA_MIX_STANDARD,
            restitution_rule: UMBRA_MIX_STANDARD,
            reserved: 0,
            shape: std::ptr::null(),
        });
        Ok(())
    })
}

/// Adds a collider to a body; wakes the body. A body with `UMBRA_MASS_FROM_COLLIDERS` gets their mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_add_collider(
    world: Option<&mut UmbraWorld>,
    body: u64,
    def: Option<&UmbraColliderDef>,
    collider: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, def, place) = (given(world)?, given(def)?, given(collider)?);
        // SAFETY: the caller promises that the shape is null or was not freed.
        let def = unsafe { def.def() }?;
        place.write(made(world.execute(&Command::AddCollider { body: body_id(body), def })?).1);
        Ok(())
    })
}

/// Puts another definition in the place of a collider's; wakes its body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_set_collider(
    world: Option<&mut UmbraWorld>,
    collider: u64,
    def: Option<&UmbraColliderDef>,
) -> UmbraStatus {
    change_by(world, || {
        let def = given(def)?;
        // SAFETY: the caller promises that the shape is null or was not freed.
        let def = unsafe { def.def() }?;
        Ok(Command::SetCollider { collider: collider_id(collider), def })
    })
}

/// Removes a collider; wakes its body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_remove_collider(world: Option<&mut UmbraWorld>, collider: u64) -> UmbraStatus {
    change(world, Command::RemoveCollider(collider_id(collider)))
}

/// Reads a collider, with null for its shape: `umbra_world_collider_shape`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_collider(
    world: Option<&UmbraWorld>,
    collider: u64,
    def: Option<&mut MaybeUninit<UmbraColliderDef>>,
) -> UmbraStatus {
    look(world, def, |world| Ok(values(world.collider(collider_id(collider))?)))
}

/// The shape of a collider, which is the caller's as one that was made.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_collider_shape(
    world: Option<&UmbraWorld>,
    collider: u64,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    look(world, shape, |world| Ok(UmbraShape::boxed(world.collider(collider_id(collider))?.shape.clone())))
}

/// The body that a collider belongs to.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_collider_body(
    world: Option<&UmbraWorld>,
    collider: u64,
    body: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    look(world, body, |world| Ok(word(world.collider_body(collider_id(collider))?.parts())))
}

/// The handles of the colliders of a body, in the order of their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_body_colliders(
    world: Option<&UmbraWorld>,
    body: u64,
    colliders: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let own = given(world)?.world().colliders_of(body_id(body))?;
        let all: Vec<u64> = own.map(|id| word(id.parts())).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), colliders, capacity, count) }
    })
}

/// Fills in the settings of contacts that suit bodies of 0.1 m to 10 m at 60 steps a second.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_contact_settings_default(
    settings: Option<&mut MaybeUninit<UmbraContactSettings>>,
) -> UmbraStatus {
    guard(|| {
        given(settings)?.write((&ContactSettings::default()).into());
        Ok(())
    })
}

/// Changes the settings of contacts; wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_contact_settings(
    world: Option<&mut UmbraWorld>,
    settings: Option<&UmbraContactSettings>,
) -> UmbraStatus {
    change_by(world, || {
        let settings = *given(settings)?;
        Ok(Command::SetContactSettings(ContactSettings {
            substeps: settings.substeps,
            push_speed: Fx::from_bits(settings.push_speed),
            restitution_speed: Fx::from_bits(settings.restitution_speed),
            max_pairs: settings.max_pairs,
            max_pairs_per_collider: settings.max_pairs_per_collider,
        }))
    })
}

/// The settings of contacts of a world.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_contact_settings(
    world: Option<&UmbraWorld>,
    settings: Option<&mut MaybeUninit<UmbraContactSettings>>,
) -> UmbraStatus {
    look(world, settings, |world| Ok((&world.def().contacts).into()))
}
