//! Energy and momentum: multiples of 2^-64 in 128 bits.

use std::mem::MaybeUninit;

use umbra_physics::{FxWide, Vec2, World};

use crate::memory::given;
use crate::number::UmbraInt128;
use crate::status::{Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, look};

/// Hands on the two components of what a look at a world gives.
fn both(
    world: Option<&UmbraWorld>,
    x: Option<&mut MaybeUninit<UmbraInt128>>,
    y: Option<&mut MaybeUninit<UmbraInt128>>,
    at: impl FnOnce(&World) -> Result<Vec2<FxWide>>,
) -> UmbraStatus {
    guard(|| {
        let (world, x, y) = (given(world)?, given(x)?, given(y)?);
        let vector = at(world.world())?;
        x.write(vector.x.into());
        y.write(vector.y.into());
        Ok(())
    })
}

/// The kinetic energy of the dynamic bodies, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_kinetic_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, energy, |world| Ok(world.kinetic_energy()?.into()))
}

/// The potential energy of the dynamic bodies in gravity, attractors, springs and springs of joints, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_potential_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, energy, |world| Ok(world.potential_energy()?.into()))
}

/// Kinetic and potential energy together, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, energy, |world| Ok(world.energy()?.into()))
}

/// The momentum of the dynamic bodies, multiples of 2^-64 kg·m/s; exact for the velocities that `umbra_world_body` gives.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_momentum(
    world: Option<&UmbraWorld>,
    x: Option<&mut MaybeUninit<UmbraInt128>>,
    y: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    both(world, x, y, |world| Ok(world.momentum()?))
}

/// The angular momentum of the dynamic bodies about the origin, multiples of 2^-64 kg·m²/s.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_angular_momentum(
    world: Option<&UmbraWorld>,
    momentum: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, momentum, |world| Ok(world.angular_momentum()?.into()))
}

/// A body's part of the kinetic energy, multiples of 2^-64 J: 0 unless it is dynamic and takes part.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_kinetic_energy(
    world: Option<&UmbraWorld>,
    body: u64,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, energy, |world| Ok(world.body(body_id(body))?.kinetic_energy()?.into()))
}

/// A body's part of the momentum, multiples of 2^-64 kg·m/s: 0 unless it is dynamic and takes part.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_momentum(
    world: Option<&UmbraWorld>,
    body: u64,
    x: Option<&mut MaybeUninit<UmbraInt128>>,
    y: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    both(world, x, y, |world| Ok(world.body(body_id(body))?.momentum()))
}

/// A body's part of the angular momentum about the origin, multiples of 2^-64 kg·m²/s: 0 unless it is dynamic and takes part.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_angular_momentum(
    world: Option<&UmbraWorld>,
    body: u64,
    momentum: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    look(world, momentum, |world| Ok(world.body(body_id(body))?.angular_momentum()?.into()))
}
