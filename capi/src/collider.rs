//! Colliders, and the settings of contacts.

use std::mem::MaybeUninit;

use umbra_physics::{
    ColliderDef, ColliderId, Command, ContactSettings, Exclusion, Filter, Fx, Material, MaterialPair, MixRule, OneWay,
};

use crate::memory::{fill, given};
use crate::number::{UMBRA_ONE, UmbraFx, UmbraVec2};
use crate::shape::UmbraShape;
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word, change, change_by, created, look, word};

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
    MIX_RULES.iter().position(|&listed| listed == rule).map_or(UMBRA_MIX_STANDARD, |number| number as u32)
}

/// For how long two bodies do not touch each other.
pub type UmbraExclusion = u32;

/// Until a call allows the pair again.
pub const UMBRA_EXCLUDE_ALWAYS: UmbraExclusion = 0;
/// Until the first step in which they are too far apart to touch.
pub const UMBRA_EXCLUDE_UNTIL_APART: UmbraExclusion = 1;

/// Two bodies that do not touch each other.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraExcludedPair {
    /// The bodies, that in the lower slot first.
    pub bodies: [u64; 2],
    /// For how long.
    pub exclusion: UmbraExclusion,
    /// 0.
    pub reserved: u32,
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
    /// Coefficient of rolling resistance, 0 to 1; default 0. Two colliders have the larger one.
    pub rolling_resistance: UmbraFx,
    /// Speed of the surface around the shape, counter-clockwise, m/s, within ±2^10: a conveyor belt; default 0.
    pub surface_speed: UmbraFx,
    /// The direction out of the surface that holds, in the collider's axes, if `one_way` is 1: not zero; default (0, 1).
    pub one_way_direction: UmbraVec2,
    /// The largest angle between that direction and the normal of a contact that holds, 0 to π/2 rad; default π/4.
    pub one_way_tolerance: UmbraFx,
    /// A name of the caller's, by which worlds built in another order are compared: 0.
    pub key: u64,
    /// Anything of the caller's: 0.
    pub user_data: u64,
    /// The categories it is in, as bits; default 1.
    pub category: u32,
    /// The categories that it meets, as bits; default all. With 0, and no positive group, it touches nothing, and gives its body mass
    /// and an outline alone.
    pub mask: u32,
    /// The group; 0 for none.
    pub group: i32,
    /// Rule that mixes the coefficients of friction of two colliders; default `UMBRA_MIX_STANDARD`.
    pub friction_rule: UmbraMixRule,
    /// Rule that mixes the coefficients of restitution; default `UMBRA_MIX_STANDARD`.
    pub restitution_rule: UmbraMixRule,
    /// 1 for a collider that holds others from one side alone and lets them pass from the others, 0 for one that holds them all; default 0.
    pub one_way: u32,
    /// Number of the material, for coefficients of two materials together; default 0, for none.
    pub material_id: u32,
    /// 1 for a sensor, which touches nothing and reports what overlaps it, else 0; default 0.
    pub sensor: u32,
    /// 1 to report where contacts of the collider begin and end, else 0; default 0. One of the two colliders is enough.
    pub contact_events: u32,
    /// 1 to report hits of the collider, else 0; default 0. One of the two colliders is enough.
    pub hit_events: u32,
    /// Shape. The last field, so that the offsets of the others do not depend on the size of pointers.
    pub shape: *const UmbraShape,
}

/// Coefficients of the contacts of two materials, in place of those that follow from both.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraMaterialPair {
    /// Coefficient of friction, 0 to 32.
    pub friction: UmbraFx,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: UmbraFx,
    /// Coefficient of rolling resistance, 0 to 1.
    pub rolling_resistance: UmbraFx,
}

/// Settings of contacts; `umbra_contact_settings_default` fills them in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraContactSettings {
    /// The largest speed with which overlapping bodies are pushed apart, m/s, 0 to 2^10; default 3.
    pub push_speed: UmbraFx,
    /// The approach speed from which on bodies bounce, m/s, 0 to 2^10; default 1.
    pub restitution_speed: UmbraFx,
    /// The speed below which a body that contacts push counts as at rest, m/s, 0 to 2^10; default 0.05.
    pub sleep_speed: UmbraFx,
    /// The approach speed from which on a contact is a hit, m/s, 0 to 2^10; default 1.
    pub hit_speed: UmbraFx,
    /// The number of sub-steps in which contacts are solved, 1 to 16; default 5. Bodies that touch where one bears another of more than 64
    /// times its mass take 16.
    pub substeps: u32,
    /// The number of pairs of outlines that may be close to each other in a step (a compound has one for each part), 1 to 2^28; default
    /// 2^20.
    pub max_pairs: u32,
    /// The number of pairs of one outline that may be close where there are more than `max_pairs` in all, 1 to 2^12; default 256.
    pub max_pairs_per_collider: u32,
    /// 0.
    pub reserved: u32,
}

/// A number that is 0 or 1.
pub(crate) fn flag(number: u32, otherwise: &'static str) -> Result<bool> {
    if number <= 1 { Ok(number == 1) } else { Err(Refusal::bad(otherwise)) }
}

pub(crate) const fn collider_word(collider: ColliderId) -> u64 {
    let (slot, generation) = collider.parts();
    word(slot, generation)
}

pub(crate) const fn collider_id(word: u64) -> ColliderId {
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
        rolling_resistance: def.material.rolling_resistance.to_bits(),
        surface_speed: def.material.surface_speed.to_bits(),
        one_way_direction: def.one_way.unwrap_or_default().direction.into(),
        one_way_tolerance: def.one_way.unwrap_or_default().tolerance.to_bits(),
        key: def.key,
        user_data: def.user_data,
        category: def.filter.category,
        mask: def.filter.mask,
        group: def.filter.group,
        friction_rule: number(def.material.friction_rule),
        restitution_rule: number(def.material.restitution_rule),
        one_way: def.one_way.is_some().into(),
        material_id: def.material.id,
        sensor: def.sensor.into(),
        contact_events: def.contact_events.into(),
        hit_events: def.hit_events.into(),
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
                rolling_resistance: Fx::from_bits(self.rolling_resistance),
                surface_speed: Fx::from_bits(self.surface_speed),
                friction_rule: rule(self.friction_rule)?,
                restitution_rule: rule(self.restitution_rule)?,
                id: self.material_id,
            },
            filter: Filter { category, mask, group },
            one_way: match self.one_way {
                0 => None,
                1 => Some(OneWay {
                    direction: self.one_way_direction.into(),
                    tolerance: Fx::from_bits(self.one_way_tolerance),
                }),
                _ => return Err(Refusal::bad("one_way is neither 0 nor 1")),
            },
            sensor: flag(self.sensor, "sensor is neither 0 nor 1")?,
            contact_events: flag(self.contact_events, "contact_events is neither 0 nor 1")?,
            hit_events: flag(self.hit_events, "hit_events is neither 0 nor 1")?,
            key: self.key,
            user_data: self.user_data,
        })
    }
}

impl From<&ContactSettings> for UmbraContactSettings {
    fn from(settings: &ContactSettings) -> Self {
        Self {
            push_speed: settings.push_speed.to_bits(),
            restitution_speed: settings.restitution_speed.to_bits(),
            sleep_speed: settings.sleep_speed.to_bits(),
            hit_speed: settings.hit_speed.to_bits(),
            substeps: settings.substeps,
            max_pairs: settings.max_pairs,
            max_pairs_per_collider: settings.max_pairs_per_collider,
            reserved: 0,
        }
    }
}

/// Fills in a definition: around the body's centre of mass, touching all others, without a shape.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_collider_def_default(def: Option<&mut MaybeUninit<UmbraColliderDef>>) -> UmbraStatus {
    guard(|| {
        let (material, filter, one_way): (Material, Filter, OneWay) = Default::default();
        given(def)?.write(UmbraColliderDef {
            position: UmbraVec2::default(),
            angle: 0,
            density: UMBRA_ONE,
            friction: Fx::to_bits(material.friction),
            restitution: Fx::to_bits(material.restitution),
            rolling_resistance: 0,
            surface_speed: 0,
            one_way_direction: one_way.direction.into(),
            one_way_tolerance: one_way.tolerance.to_bits(),
            key: 0,
            user_data: 0,
            category: filter.category,
            mask: filter.mask,
            group: filter.group,
            friction_rule: UMBRA_MIX_STANDARD,
            restitution_rule: UMBRA_MIX_STANDARD,
            one_way: 0,
            material_id: 0,
            sensor: 0,
            contact_events: 0,
            hit_events: 0,
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
        place.write(created(world.execute(&Command::AddCollider { body: body_id(body), def })?).1);
        Ok(())
    })
}

/// Puts another definition in the place of a collider's; wakes its body. Its contacts and overlaps end, and begin anew in the next step.
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
    look(world, body, |world| Ok(body_word(world.collider_body(collider_id(collider))?)))
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
        let collider_ids = given(world)?.world().colliders_of(body_id(body))?;
        let all: Vec<u64> = collider_ids.map(collider_word).collect();
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
            sleep_speed: Fx::from_bits(settings.sleep_speed),
            hit_speed: Fx::from_bits(settings.hit_speed),
            max_pairs: settings.max_pairs,
            max_pairs_per_collider: settings.max_pairs_per_collider,
        }))
    })
}

/// Gives coefficients to the contacts of two materials, by their `material_id`, in either order.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_material_pair(
    world: Option<&mut UmbraWorld>,
    first: u32,
    second: u32,
    pair: Option<&UmbraMaterialPair>,
) -> UmbraStatus {
    change_by(world, || {
        let pair = *given(pair)?;
        let pair = MaterialPair {
            friction: Fx::from_bits(pair.friction),
            restitution: Fx::from_bits(pair.restitution),
            rolling_resistance: Fx::from_bits(pair.rolling_resistance),
        };
        Ok(Command::SetMaterialPair { first, second, pair: Some(pair) })
    })
}

/// Takes back what `umbra_world_set_material_pair` gave to two materials, if anything.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_remove_material_pair(
    world: Option<&mut UmbraWorld>,
    first: u32,
    second: u32,
) -> UmbraStatus {
    change(world, Command::SetMaterialPair { first, second, pair: None })
}

/// The settings of contacts of a world.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_contact_settings(
    world: Option<&UmbraWorld>,
    settings: Option<&mut MaybeUninit<UmbraContactSettings>>,
) -> UmbraStatus {
    look(world, settings, |world| Ok((&world.def().contacts).into()))
}

/// Excludes two bodies from contacts with each other, or gives a pair that is excluded another exclusion; wakes both.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_exclude_pair(
    world: Option<&mut UmbraWorld>,
    a: u64,
    b: u64,
    exclusion: UmbraExclusion,
) -> UmbraStatus {
    change_by(world, || {
        let exclusion = match exclusion {
            UMBRA_EXCLUDE_ALWAYS => Exclusion::Always,
            UMBRA_EXCLUDE_UNTIL_APART => Exclusion::UntilApart,
            _ => return Err(Refusal::bad("no exclusion has this number")),
        };
        Ok(Command::ExcludePair { a: body_id(a), b: body_id(b), exclusion })
    })
}

/// Allows contacts between two bodies again; wakes both.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_allow_pair(world: Option<&mut UmbraWorld>, a: u64, b: u64) -> UmbraStatus {
    change(world, Command::AllowPair { a: body_id(a), b: body_id(b) })
}

/// The pairs of bodies that are excluded from contacts, by their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_excluded_pairs(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraExcludedPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all = given(world)?.world().excluded_pairs().map(|(bodies, exclusion)| UmbraExcludedPair {
            bodies: bodies.map(body_word),
            exclusion: if exclusion == Exclusion::Always { UMBRA_EXCLUDE_ALWAYS } else { UMBRA_EXCLUDE_UNTIL_APART },
            reserved: 0,
        });
        let all: Vec<UmbraExcludedPair> = all.collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), pairs, capacity, count) }
    })
}
