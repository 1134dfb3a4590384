//! Events of contacts and of sensors.

use std::mem::MaybeUninit;

use umbra_physics::{ColliderPair, ContactHit, StepReport};

use crate::collider::collider_word;
use crate::memory::{fill, given};
use crate::number::{UmbraFx, UmbraVec2};
use crate::status::{UmbraStatus, guard};
use crate::world::{UmbraWorld, body_word};

/// Two colliders that an event is about. Handles of what calls removed before the step are those that it had: calls refuse them.
///
/// Of a contact, the collider of the body with the lower key comes first, of equal keys that with the lower key of its own, then that
/// with the lower handle. Of a sensor, the sensor comes first.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraColliderPair {
    /// The colliders.
    pub colliders: [u64; 2],
    /// The bodies of the colliders.
    pub bodies: [u64; 2],
    /// The keys of the colliders.
    pub collider_keys: [u64; 2],
    /// The keys of the bodies.
    pub body_keys: [u64; 2],
}

/// A contact that closed fast when an impulse stopped it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraContactHit {
    /// The colliders.
    pub pair: UmbraColliderPair,
    /// Speed along the normal at which they met, m/s.
    pub approach_speed: UmbraFx,
    /// Unit vector from the first collider to the second one; each component within 2^-29.
    pub normal: UmbraVec2,
    /// Position at which the surfaces met, m.
    pub point: UmbraVec2,
    /// Impulse of the hit along the normal, N·s, restitution included, without what carries the bodies.
    pub normal_impulse: UmbraFx,
    /// The part of a compound, or the segment of a chain, of each collider; 0 of all others.
    pub parts: [u32; 2],
}

impl From<&ColliderPair> for UmbraColliderPair {
    fn from(pair: &ColliderPair) -> Self {
        Self {
            colliders: pair.colliders.map(collider_word),
            bodies: pair.bodies.map(body_word),
            collider_keys: pair.collider_keys,
            body_keys: pair.body_keys,
        }
    }
}

impl From<&ContactHit> for UmbraContactHit {
    fn from(hit: &ContactHit) -> Self {
        Self {
            pair: (&hit.pair).into(),
            approach_speed: hit.approach_speed.to_bits(),
            normal: hit.normal.into(),
            point: hit.point.into(),
            normal_impulse: hit.normal_impulse.to_bits(),
            parts: hit.parts,
        }
    }
}

/// Hands on pairs of the last step.
///
/// # Safety
/// As [`fill`].
unsafe fn reported(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
    select: impl for<'a> FnOnce(&StepReport<'a>) -> &'a [ColliderPair],
) -> UmbraStatus {
    guard(|| {
        let rows = select(&given(world)?.world().last_report()).iter().map(UmbraColliderPair::from);
        // SAFETY: as the caller promises.
        unsafe { fill(rows, pairs, capacity, count) }
    })
}

/// The contacts of colliders with `contact_events` that ended in the last step or by a call before it, sorted by the keys of bodies and
/// colliders; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_contacts_ended(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, pairs, capacity, count, |report| report.contacts_ended) }
}

/// The contacts of colliders with `contact_events` that began in the last step, sorted likewise; a list as `umbra_world_outcomes` gives
/// it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_contacts_began(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, pairs, capacity, count, |report| report.contacts_began) }
}

/// The colliders that left a sensor in the last step or by a call before it, each behind the sensor, sorted likewise; a list as
/// `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_sensors_left(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, pairs, capacity, count, |report| report.sensors_left) }
}

/// The colliders that entered a sensor in the last step, each behind the sensor, sorted likewise; a list as `umbra_world_outcomes`
/// gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_sensors_entered(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, pairs, capacity, count, |report| report.sensors_entered) }
}

/// The colliders that overlapped sensors at the end of the last step, each behind the sensor, by the slots of the sensors; a list as
/// `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_sensor_overlaps(
    world: Option<&UmbraWorld>,
    pairs: *mut UmbraColliderPair,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<UmbraColliderPair> = given(world)?.world().sensor_overlaps().map(|pair| (&pair).into()).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), pairs, capacity, count) }
    })
}

/// The hits of colliders with `hit_events` in the last step, sorted by the keys of bodies and colliders, then by parts; a list as
/// `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_contact_hits(
    world: Option<&UmbraWorld>,
    hits: *mut UmbraContactHit,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let rows = given(world)?.world().last_report().hits.iter().map(UmbraContactHit::from);
        // SAFETY: as the caller promises.
        unsafe { fill(rows, hits, capacity, count) }
    })
}
