//! Names of bodies, force fields, joints and colliders, in worlds that a scene or a replay runs.

use std::ffi::c_char;
use std::mem::MaybeUninit;

use umbra_physics::{Labels, World};

use crate::collider::{collider_id, collider_word};
use crate::joint::{joint_id, joint_word};
use crate::memory::{given, text, write_text};
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word, field_id, field_word};

/// Hands on the handle that has a name.
///
/// # Safety
/// As [`text`].
unsafe fn find(
    world: Option<&UmbraWorld>,
    name: *const c_char,
    length: usize,
    handle: Option<&mut MaybeUninit<u64>>,
    search: impl FnOnce(&World, &Labels, &str) -> Option<u64>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let name = unsafe { text(name, length) }?;
        let (world, place) = (given(world)?, given(handle)?);
        let named = search(world.world(), &world.named()?, name);
        place.write(named.ok_or_else(|| Refusal::bad("nothing of that kind has this name"))?);
        Ok(())
    })
}

/// Writes the name of a handle; none is empty.
///
/// # Safety
/// As [`write_text`].
unsafe fn write_name(
    world: Option<&UmbraWorld>,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
    read: impl FnOnce(&UmbraWorld) -> Result<Option<String>>,
) -> UmbraStatus {
    guard(|| {
        let name = read(given(world)?)?.unwrap_or_default();
        // SAFETY: as the caller promises.
        unsafe { write_text(&name, buffer, capacity, length) }
    })
}

/// The body of a name in a world that a scene or a replay runs: the first one, if several have it. Names end with
/// `umbra_world_leave_scene`, handles do not.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_find_body(
    world: Option<&UmbraWorld>,
    name: *const c_char,
    length: usize,
    body: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        find(world, name, length, body, |world, labels, name| {
            world.bodies().map(|body| body.id()).find(|&body| labels.body(body) == Some(name)).map(body_word)
        })
    }
}

/// The force field of a name, as `umbra_world_find_body` finds a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_find_field(
    world: Option<&UmbraWorld>,
    name: *const c_char,
    length: usize,
    field: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        find(world, name, length, field, |world, labels, name| {
            world.fields().map(|(field, _)| field).find(|&field| labels.field(field) == Some(name)).map(field_word)
        })
    }
}

/// The joint of a name, as `umbra_world_find_body` finds a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_find_joint(
    world: Option<&UmbraWorld>,
    name: *const c_char,
    length: usize,
    joint: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        find(world, name, length, joint, |world, labels, name| {
            world.joints().map(|joint| joint.id()).find(|&joint| labels.joint(joint) == Some(name)).map(joint_word)
        })
    }
}

/// The collider of a name, as `umbra_world_find_body` finds a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_find_collider(
    world: Option<&UmbraWorld>,
    name: *const c_char,
    length: usize,
    collider: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        find(world, name, length, collider, |world, labels, name| {
            let mut all = world.bodies().flat_map(|body| world.colliders_of(body.id()).into_iter().flatten());
            all.find(|&collider| labels.collider(collider) == Some(name)).map(collider_word)
        })
    }
}

/// The name of a body in a world that a scene or a replay runs, empty if it has none; text as `umbra_last_message` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_body_name(
    world: Option<&UmbraWorld>,
    body: u64,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        write_name(world, buffer, capacity, length, |world| {
            let body = world.world().body(body_id(body))?.id();
            world.body_name(body)
        })
    }
}

/// The name of a force field, as `umbra_world_body_name` gives that of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_field_name(
    world: Option<&UmbraWorld>,
    field: u64,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        write_name(world, buffer, capacity, length, |world| {
            world.world().field(field_id(field))?;
            Ok(world.named()?.field(field_id(field)).map(str::to_owned))
        })
    }
}

/// The name of a joint, as `umbra_world_body_name` gives that of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_joint_name(
    world: Option<&UmbraWorld>,
    joint: u64,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        write_name(world, buffer, capacity, length, |world| {
            world.world().joint(joint_id(joint))?;
            Ok(world.named()?.joint(joint_id(joint)).map(str::to_owned))
        })
    }
}

/// The name of a collider, as `umbra_world_body_name` gives that of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_collider_name(
    world: Option<&UmbraWorld>,
    collider: u64,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe {
        write_name(world, buffer, capacity, length, |world| {
            world.world().collider(collider_id(collider))?;
            Ok(world.named()?.collider(collider_id(collider)).map(str::to_owned))
        })
    }
}
