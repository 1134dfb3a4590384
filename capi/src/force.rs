//! Forces and impulses of the caller's.

use std::mem::MaybeUninit;

use umbra_physics::{ApplyOptions, Command, Explosion, ForceOrImpulse, Frame, Fx};

use crate::memory::given;
use crate::number::{UmbraFx, UmbraVec2, vector};
use crate::shape::UmbraShape;
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, change, change_by};

/// Options of a force or impulse: 0, or any of the flags below.
pub type UmbraApplyFlags = u32;

/// Vector and point are in the axes of the body, the point from its centre of mass; not in those of the world.
pub const UMBRA_BODY_FRAME: UmbraApplyFlags = 1;
/// Does not wake a sleeping body, which then ignores the force.
pub const UMBRA_NO_WAKE: UmbraApplyFlags = 2;

fn options(flags: UmbraApplyFlags) -> Result<ApplyOptions> {
    if flags & !(UMBRA_BODY_FRAME | UMBRA_NO_WAKE) != 0 {
        return Err(Refusal::bad("a flag is none of ours"));
    }
    let frame = if flags & UMBRA_BODY_FRAME == 0 { Frame::World } else { Frame::Body };
    Ok(ApplyOptions { frame, wake: flags & UMBRA_NO_WAKE == 0 })
}

fn apply(world: Option<&mut UmbraWorld>, body: u64, action: ForceOrImpulse, flags: UmbraApplyFlags) -> UmbraStatus {
    change_by(world, || Ok(Command::Apply { body: body_id(body), action, options: options(flags)? }))
}

/// Applies a force, N, over the next step, at a point, or through the centre of mass for null.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_apply_force(
    world: Option<&mut UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    point: Option<&UmbraVec2>,
    options: UmbraApplyFlags,
) -> UmbraStatus {
    let action = ForceOrImpulse::Force { force: vector(x, y), point: point.map(|&point| point.into()) };
    apply(world, body, action, options)
}

/// Applies a torque, N·m, over the next step.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_apply_torque(
    world: Option<&mut UmbraWorld>,
    body: u64,
    torque: UmbraFx,
    options: UmbraApplyFlags,
) -> UmbraStatus {
    apply(world, body, ForceOrImpulse::Torque(Fx::from_bits(torque)), options)
}

/// Changes the velocity by an impulse, N·s, at once, at a point, or through the centre of mass for null.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_apply_impulse(
    world: Option<&mut UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    point: Option<&UmbraVec2>,
    options: UmbraApplyFlags,
) -> UmbraStatus {
    let action = ForceOrImpulse::Impulse { impulse: vector(x, y), point: point.map(|&point| point.into()) };
    apply(world, body, action, options)
}

/// Changes the angular velocity by an angular impulse, N·m·s, at once.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_apply_angular_impulse(
    world: Option<&mut UmbraWorld>,
    body: u64,
    impulse: UmbraFx,
    options: UmbraApplyFlags,
) -> UmbraStatus {
    apply(world, body, ForceOrImpulse::AngularImpulse(Fx::from_bits(impulse)), options)
}

/// Takes back the forces and torques applied since the last step.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_clear_forces(world: Option<&mut UmbraWorld>) -> UmbraStatus {
    change(world, Command::ClearForces)
}

/// An explosion: an impulse, away from a point, on each collider of a dynamic body around it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraExplosion {
    /// The centre, m.
    pub position: UmbraVec2,
    /// The distance up to which it has its whole strength, m, 0 to 2^12.
    pub radius: UmbraFx,
    /// The distance from there over which the strength falls to nothing, m, 0 to 2^12.
    pub falloff: UmbraFx,
    /// The impulse on each metre of width that a collider turns to the centre, N·s/m, within ±2^16; below 0 it pulls.
    pub impulse: UmbraFx,
    /// The categories of the colliders that it acts on.
    pub mask: u32,
    /// 0.
    pub reserved: u32,
}

impl From<&UmbraExplosion> for Explosion {
    fn from(explosion: &UmbraExplosion) -> Self {
        Self {
            position: explosion.position.into(),
            radius: Fx::from_bits(explosion.radius),
            falloff: Fx::from_bits(explosion.falloff),
            impulse: Fx::from_bits(explosion.impulse),
            mask: explosion.mask,
        }
    }
}

/// The impulse of an explosion on a shape at a position, m, and an angle, rad: N·s, by the law for bodies. A game divides it by the mass of
/// a character and adds it to its velocity. The mask does not matter.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_explosion_impulse_on(
    explosion: Option<&UmbraExplosion>,
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    angle: UmbraFx,
    impulse: Option<&mut MaybeUninit<UmbraVec2>>,
) -> UmbraStatus {
    guard(|| {
        let (explosion, shape, place) = (Explosion::from(given(explosion)?), &given(shape)?.shape, given(impulse)?);
        place.write(explosion.impulse_on(shape, vector(x, y), Fx::from_bits(angle))?.into());
        Ok(())
    })
}

/// Sets off an explosion, which wakes the bodies that it hits.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_explode(
    world: Option<&mut UmbraWorld>,
    explosion: Option<&UmbraExplosion>,
) -> UmbraStatus {
    change_by(world, || Ok(Command::Explode(given(explosion)?.into())))
}
