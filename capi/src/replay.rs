//! Recording runs, and running them again.

use std::mem::MaybeUninit;

use umbra_physics::{RecordOptions, Recorder, Replay, ReplayLimits, World};

use crate::memory::{UmbraBytes, given, slice};
use crate::run::ReplayPlay;
use crate::status::{Refusal, Result, UMBRA_ERROR_BUSY, UmbraStatus, guard};
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
        if world.replay().is_ok() {
            return Err(Refusal::own(UMBRA_ERROR_BUSY, "a replay runs this world, and is its recording"));
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
        let limits = ReplayLimits::from(given(limits)?);
        // SAFETY: as the caller promises.
        let replay = unsafe { read(bytes, length) }?;
        if let Some(ticks) = ticks {
            ticks.write(replay.ticks());
        }
        Ok(replay.verify_within(limits)?)
    })
}

impl From<&UmbraReplayLimits> for ReplayLimits {
    fn from(&UmbraReplayLimits { ticks, commands, bodies, fields, colliders, pairs }: &UmbraReplayLimits) -> Self {
        Self { ticks, bodies, fields, colliders, pairs, commands }
    }
}

/// Reads a replay.
///
/// # Safety
/// As [`slice`].
unsafe fn read(bytes: *const u8, length: usize) -> Result<Replay> {
    // SAFETY: as the caller promises.
    Ok(Replay::from_bytes(unsafe { slice(bytes, length) }?, &[])?)
}

/// Reads a replay and hands on a world that it gives.
///
/// # Safety
/// As [`slice`].
unsafe fn write_world(
    bytes: *const u8,
    length: usize,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
    find: impl FnOnce(Replay) -> Result<World>,
) -> UmbraStatus {
    guard(|| {
        let place = given(world)?;
        // SAFETY: as the caller promises.
        let replay = unsafe { read(bytes, length) }?;
        place.write(UmbraWorld::boxed(find(replay)?));
        Ok(())
    })
}

/// The world that a replay starts with: a server compares its `umbra_world_state_hash` with the hash of the level that was to be played,
/// as anybody can record a run of another level.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_replay_start(
    bytes: *const u8,
    length: usize,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { write_world(bytes, length, world, |replay| Ok(replay.start().clone())) }
}

/// Verifies a replay as `umbra_replay_verify` does, and gives the world at its end, with its blob: to read the score, and who won.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_replay_end(
    bytes: *const u8,
    length: usize,
    limits: Option<&UmbraReplayLimits>,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { write_world(bytes, length, world, |replay| Ok(replay.verified_end(given(limits)?.into())?)) }
}

/// A world that a replay runs, at its start. `umbra_world_step` plays a tick and compares its hash with the recorded one:
/// `UMBRA_ERROR_DIVERGENCE` if they differ, and the world is at its tick and can go on; `UMBRA_ERROR_END` at the end, and nothing is done.
/// `umbra_world_outcomes`, events, poses and names are those of the run; the replay alone changes the world, until
/// `umbra_world_leave_scene`. A replay of a stranger may ask for much work: verify it first (`umbra_replay_verify`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_from_replay(
    bytes: *const u8,
    length: usize,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    guard(|| {
        let place = given(world)?;
        // SAFETY: as the caller promises.
        let replay = unsafe { read(bytes, length) }?;
        place.write(Some(Box::new(UmbraWorld::replayed(ReplayPlay::new(replay)))));
        Ok(())
    })
}

/// Goes to a tick of the replay that runs a world, from the nearest snapshot before it, without comparing: to its end or its start if the
/// tick is beyond. There are no outcomes then.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_seek(world: Option<&mut UmbraWorld>, tick: u64) -> UmbraStatus {
    guard(|| {
        let world = given(world)?;
        world.replay_mut()?.playback.seek(tick);
        world.forget_outcomes();
        Ok(())
    })
}

/// The ticks at the start and at the end of the replay that runs a world.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_replay_ticks(
    world: Option<&UmbraWorld>,
    start: Option<&mut MaybeUninit<u64>>,
    end: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, start, end) = (given(world)?, given(start)?, given(end)?);
        let replay = world.replay()?.replay();
        start.write(replay.start().tick());
        end.write(replay.end());
        Ok(())
    })
}
