//! Energy and momentum: multiples of 2^-64 in 128 bits.

use std::mem::MaybeUninit;

use umbra_physics::{Error, FxWide, World};

use crate::memory::given;
use crate::number::UmbraInt128;
use crate::status::{UmbraStatus, guard};
use crate::world::UmbraWorld;

fn total(
    world: Option<&UmbraWorld>,
    place: Option<&mut MaybeUninit<UmbraInt128>>,
    sum: impl FnOnce(&World) -> Result<FxWide, Error>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(place)?);
        place.write(sum(world.world())?.into());
        Ok(())
    })
}

/// The kinetic energy of the dynamic bodies, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_kinetic_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    total(world, energy, World::kinetic_energy)
}

/// The potential energy of the dynamic bodies in gravity, attractors and springs, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_potential_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    total(world, energy, World::potential_energy)
}

/// Kinetic and potential energy together, multiples of 2^-64 J.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_energy(
    world: Option<&UmbraWorld>,
    energy: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    total(world, energy, World::energy)
}

/// The momentum of the dynamic bodies, multiples of 2^-64 kg·m/s; exact for the velocities that `umbra_world_body` gives.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_momentum(
    world: Option<&UmbraWorld>,
    x: Option<&mut MaybeUninit<UmbraInt128>>,
    y: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    guard(|| {
        let (world, x, y) = (given(world)?, given(x)?, given(y)?);
        let momentum = world.world().momentum()?;
        x.write(momentum.x.into());
        y.write(momentum.y.into());
        Ok(())
    })
}

/// The angular momentum of the dynamic bodies about the origin, multiples of 2^-64 kg·m²/s.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_angular_momentum(
    world: Option<&UmbraWorld>,
    momentum: Option<&mut MaybeUninit<UmbraInt128>>,
) -> UmbraStatus {
    total(world, momentum, World::angular_momentum)
}
