//! Snapshots: in memory, and as bytes.

use std::mem::MaybeUninit;

use umbra_physics::Snapshot;

use crate::memory::{UmbraBytes, given, slice};
use crate::status::{UmbraStatus, guard};
use crate::world::UmbraWorld;

/// A world as it was, to go back to. In memory it costs a copy of what steps change; all else is shared.
pub struct UmbraSnapshot {
    snapshot: Snapshot,
}

/// The world as it is, to go back to.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_snapshot(
    world: Option<&UmbraWorld>,
    snapshot: Option<&mut MaybeUninit<Option<Box<UmbraSnapshot>>>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(snapshot)?);
        place.write(Some(Box::new(UmbraSnapshot { snapshot: world.world().snapshot() })));
        Ok(())
    })
}

/// Takes a snapshot in the memory of another one, as a ring of them for rollback does each tick.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_snapshot_into(
    world: Option<&UmbraWorld>,
    snapshot: Option<&mut UmbraSnapshot>,
) -> UmbraStatus {
    guard(|| {
        let (world, snapshot) = (given(world)?, given(snapshot)?);
        world.world().snapshot_into(&mut snapshot.snapshot);
        Ok(())
    })
}

/// Goes back to a snapshot, of this world or another. Handles made after it may come to name other bodies; what became of the
/// inputs of the last step is forgotten.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_restore(world: Option<&mut UmbraWorld>, snapshot: Option<&UmbraSnapshot>) -> UmbraStatus {
    guard(|| {
        let (world, snapshot) = (given(world)?, given(snapshot)?);
        world.unrecorded()?.restore(&snapshot.snapshot);
        world.forget_outcomes();
        Ok(())
    })
}

/// A world that goes on from a snapshot.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_snapshot_world(
    snapshot: Option<&UmbraSnapshot>,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    guard(|| {
        let (snapshot, place) = (given(snapshot)?, given(world)?);
        place.write(UmbraWorld::boxed(snapshot.snapshot.world().clone()));
        Ok(())
    })
}

/// A snapshot as bytes, the same on every machine (`docs/formats.md`).
#[unsafe(no_mangle)]
pub extern "C" fn umbra_snapshot_to_bytes(
    snapshot: Option<&UmbraSnapshot>,
    bytes: Option<&mut MaybeUninit<Option<Box<UmbraBytes>>>>,
) -> UmbraStatus {
    guard(|| {
        let (snapshot, place) = (given(snapshot)?, given(bytes)?);
        place.write(UmbraBytes::boxed(snapshot.snapshot.to_bytes()));
        Ok(())
    })
}

/// The snapshot that is these bytes, which may come from anybody: what no world can be is refused. Reading takes at most 16
/// times their memory, and 64 KiB.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_snapshot_from_bytes(
    bytes: *const u8,
    length: usize,
    snapshot: Option<&mut MaybeUninit<Option<Box<UmbraSnapshot>>>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let bytes = unsafe { slice(bytes, length) }?;
        let place = given(snapshot)?;
        place.write(Some(Box::new(UmbraSnapshot { snapshot: Snapshot::from_bytes(bytes, &[])? })));
        Ok(())
    })
}

/// Frees a snapshot. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_snapshot_free(snapshot: Option<Box<UmbraSnapshot>>) {
    drop(snapshot);
}
