//! The parameters of the step, and what a game keeps in its world.

use std::mem::MaybeUninit;

use umbra_physics::{Command, Damping, Fx, Random, TimeStep};

use crate::memory::{fill, given, slice};
use crate::number::{UmbraFx, vector};
use crate::status::{Refusal, UmbraStatus, guard};
use crate::world::{UmbraIntegrator, UmbraWorld, change, change_by, integrator, sleep_after};

/// Changes the length of a step to num/den seconds, from 1 to 10,000 steps a second; wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_time_step(world: Option<&mut UmbraWorld>, num: u32, den: u32) -> UmbraStatus {
    change(world, Command::SetTimeStep(TimeStep::ratio(num, den)))
}

/// Changes gravity, m/s², within ±2^16; wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_gravity(world: Option<&mut UmbraWorld>, x: UmbraFx, y: UmbraFx) -> UmbraStatus {
    change(world, Command::SetGravity(vector(x, y)))
}

/// Changes the integrator; wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_integrator(
    world: Option<&mut UmbraWorld>,
    integrator: UmbraIntegrator,
) -> UmbraStatus {
    change_by(world, || Ok(Command::SetIntegrator(self::integrator(integrator)?)))
}

/// Changes the damping of bodies without their own: the share of each velocity that is left after a second, 0 to 1, or what
/// `umbra_kept_at_rate` returns. Wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_kept_per_second(
    world: Option<&mut UmbraWorld>,
    linear: UmbraFx,
    angular: UmbraFx,
) -> UmbraStatus {
    let [linear, angular] = [linear, angular].map(|kept| Damping::from_number(Fx::from_bits(kept)));
    change(world, Command::SetDamping { linear, angular })
}

/// Returns the damping with a rate c, in 1/s, for the fields and calls named `kept_per_second`. Up to 4/s that is the share of a
/// velocity that is left after a second, e^-c, within 0.5001 · 2^-32. Above 4/s, where such a share has few digits left, it is -c. The
/// rate is what Box2D calls damping; 0 is none. A negative rate gives a share above 1, which is refused by what it is given to.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_kept_at_rate(rate: UmbraFx) -> UmbraFx {
    Damping::rate(Fx::from_bits(rate)).number().to_bits()
}

/// Changes after how many ticks at rest a body falls asleep, or `UMBRA_NEVER`; wakes all bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_sleep_after(world: Option<&mut UmbraWorld>, ticks: u32) -> UmbraStatus {
    change(world, Command::SetSleepAfter(sleep_after(ticks)))
}

/// Seeds the world's generator of random numbers, xoshiro256**.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_seed(world: Option<&mut UmbraWorld>, seed: u64) -> UmbraStatus {
    change(world, Command::SetRandom(Random::seeded(seed)))
}

/// Draws a number from 0 to below `end`, all alike, from the world's generator: a change of its state, which peers make in the
/// same tick and order.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_random_below(
    world: Option<&mut UmbraWorld>,
    end: u64,
    number: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(number)?);
        if end == 0 {
            return Err(Refusal::bad("no number is below 0"));
        }
        place.write(world.own()?.random_mut().below(end));
        Ok(())
    })
}

/// Draws 64 bits from the world's generator.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_random_bits(
    world: Option<&mut UmbraWorld>,
    bits: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(bits)?);
        place.write(world.own()?.random_mut().bits());
        Ok(())
    })
}

/// Puts other bytes in the place of the game's own data, at most 2^24: whatever else its next tick depends on. Snapshots, hashes
/// and replays take it along.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_set_blob(
    world: Option<&mut UmbraWorld>,
    bytes: *const u8,
    length: usize,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    change_by(world, || Ok(Command::SetBlob(unsafe { slice(bytes, length) }?.to_vec())))
}

/// The game's own data; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_blob(
    world: Option<&UmbraWorld>,
    bytes: *mut u8,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let blob = given(world)?.world().blob();
        // SAFETY: as the caller promises.
        unsafe { fill(blob.iter().copied(), bytes, capacity, length) }
    })
}
