//! Recording runs, and running them again.

use std::mem::MaybeUninit;

use umbra_physics::{RecordOptions, Recorder, Replay, ReplayLimits};

use crate::memory::{UmbraBytes, given, slice};
use crate::status::{Refusal, UMBRA_ERROR_BUSY, UmbraStatus, guard};
use crate::world::UmbraWorld;

/// Begins to record a world as it is: all calls that change it from now on, the inputs of its ticks, a hash after every
/// `hash_every` ticks (0 is taken as 1), a snapshot after every `snapshot_every`, or 0 for none on the way. The recording is kept
/// in memory, which grows until it is taken (`umbra_world_take_record`).
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_record(
    world: Option<&mut UmbraWorld>,
    hash_every: u32,
    snapshot_every: u32,
) -> UmbraStatus {
    guard(|| {
        let world = given(world)?;
        if world.drafted().is_ok() {
            return Err(Refusal::own(UMBRA_ERROR_BUSY, "a draft has no run"));
        }
        if world.recorder().is_some() {
            return Err(Refusal::own(UMBRA_ERROR_BUSY, "this world is being recorded already"));
        }
        let recorder = Recorder::new(world.world(), RecordOptions { hash_every, snapshot_every });
        *world.recorder() = Some(recorder);
        Ok(())
    })
}

/// Takes the finished part of the recording, to be written away; each byte is handed out once. The bytes of
/// `umbra_world_end_record` go after it.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_take_record(
    world: Option<&mut UmbraWorld>,
    bytes: Option<&mut MaybeUninit<Option<Box<UmbraBytes>>>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(bytes)?);
        let recorder = world.recorder().as_mut().ok_or_else(not_recorded)?;
        place.write(UmbraBytes::boxed(recorder.take_bytes()));
        Ok(())
    })
}

/// Ends the recording with the last step, and gives the rest of the file: all of it if nothing was taken before. A scene's names are kept.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_end_record(
    world: Option<&mut UmbraWorld>,
    bytes: Option<&mut MaybeUninit<Option<Box<UmbraBytes>>>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(bytes)?);
        let mut recorder = world.recorder().take().ok_or_else(not_recorded)?;
        if let Some(labels) = world.labels() {
            *recorder.labels_mut() = labels;
        }
        place.write(UmbraBytes::boxed(recorder.finish(world.world())));
        Ok(())
    })
}

fn not_recorded() -> Refusal {
    Refusal::bad("the world is not recorded")
}

/// Limits on what a replay may ask for. They also hold for finding out where a run diverges.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraReplayLimits {
    /// The most ticks it may have: `UMBRA_ERROR_VERIFY_TICKS`.
    pub ticks: u64,
    /// The most commands it may have over all of its ticks: `UMBRA_ERROR_VERIFY_COMMANDS`.
    pub commands: u64,
    /// The most bodies there may be at any time: `UMBRA_ERROR_VERIFY_BODIES`.
    pub bodies: u32,
    /// The most force fields there may be at any time: `UMBRA_ERROR_VERIFY_FIELDS`.
    pub fields: u32,
    /// The most colliders there may be at any time: `UMBRA_ERROR_VERIFY_COLLIDERS`.
    pub colliders: u32,
    /// The most pairs of colliders that `max_pairs` of its `UmbraContactSettings` may allow at any time, 2^20 by default:
    /// `UMBRA_ERROR_VERIFY_PAIRS`.
    pub pairs: u32,
}

/// Runs a replay again and compares every hash: `UMBRA_OK`, `UMBRA_ERROR_DIVERGENCE`, or why the bytes, which may come from
/// anybody, are no replay that can be played, or ask for more than `limits` allow. `ticks`, which may be null, receives the
/// number of ticks, also if the run diverges or a limit is exceeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_replay_verify(
    bytes: *const u8,
    length: usize,
    limits: Option<&UmbraReplayLimits>,
    ticks: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let &UmbraReplayLimits { ticks: most_ticks, commands, bodies, fields, colliders, pairs } = given(limits)?;
        // SAFETY: as the caller promises.
        let replay = Replay::from_bytes(unsafe { slice(bytes, length) }?, &[])?;
        if let Some(ticks) = ticks {
            ticks.write(replay.ticks());
        }
        let limits = ReplayLimits { ticks: most_ticks, bodies, fields, colliders, pairs, commands };
        Ok(replay.verify_within(limits)?)
    })
}
