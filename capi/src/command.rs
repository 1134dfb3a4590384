//! Commands as bytes: to send, to check, to carry out.

use std::mem::MaybeUninit;

use umbra_physics::Command;

use crate::memory::{fill, given, slice};
use crate::status::{UmbraStatus, guard};
use crate::world::{UmbraCreatedKind, UmbraWorld, created};

/// Body or force field that a command created.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraCreated {
    /// The handle of the created thing, or `UMBRA_NO_HANDLE`.
    pub handle: u64,
    /// Kind of the created thing.
    pub kind: UmbraCreatedKind,
    /// 0.
    pub reserved: u32,
}

/// Carries out a command that comes as bytes (`docs/formats.md`). `created` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_execute(
    world: Option<&mut UmbraWorld>,
    command: *const u8,
    length: usize,
    created: Option<&mut MaybeUninit<UmbraCreated>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let bytes = unsafe { slice(command, length) }?;
        let new = given(world)?.execute(&Command::from_bytes(bytes)?)?;
        if let Some(place) = created {
            let (kind, handle) = self::created(new);
            place.write(UmbraCreated { handle, kind, reserved: 0 });
        }
        Ok(())
    })
}

/// Checks whether `umbra_world_execute` would carry a command out now: gives the same answer and changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_check(
    world: Option<&UmbraWorld>,
    command: *const u8,
    length: usize,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let bytes = unsafe { slice(command, length) }?;
        given(world)?.check(&Command::from_bytes(bytes)?)
    })
}

/// A draft: all that would change it is written down as a command instead, so that each function that changes a world also
/// makes the bytes to send. It is empty, is not stepped, and what adds to it gives `UMBRA_NO_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_draft_new(draft: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>) -> UmbraStatus {
    guard(|| {
        given(draft)?.write(Some(Box::new(UmbraWorld::draft()?)));
        Ok(())
    })
}

/// The bytes of the last command that was written down in a draft; a list as `umbra_world_outcomes` gives it. None before the
/// first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_draft_command(
    draft: Option<&UmbraWorld>,
    command: *mut u8,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let bytes = given(draft)?.drafted()?;
        // SAFETY: as the caller promises.
        unsafe { fill(bytes.iter().copied(), command, capacity, length) }
    })
}
