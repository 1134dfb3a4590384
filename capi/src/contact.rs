//! Contacts.

use std::mem::MaybeUninit;

use umbra_physics::{Contact, ContactPoint};

use crate::collider::collider_word;
use crate::memory::{fill, given};
use crate::number::{UmbraFx, UmbraVec2};
use crate::status::{UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word};

/// A point of a contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraContactPoint {
    /// Position, m, in the middle between the two surfaces.
    pub position: UmbraVec2,
    /// Distance between the surfaces along the normal, m; negative where they overlap.
    pub separation: UmbraFx,
    /// Impulse along the normal over the last sub-step, N·s, on the second body; 0 for a point that was not there in the step.
    pub normal_impulse: UmbraFx,
}

/// Two colliders that pushed each other at the end of the last step, at the present poses of their bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraContact {
    /// The colliders.
    pub colliders: [u64; 2],
    /// The bodies of the colliders.
    pub bodies: [u64; 2],
    /// Unit vector from the first collider to the second one; each component within 2^-29.
    pub normal: UmbraVec2,
    /// Impulse of friction over the last sub-step along (normal.y, -normal.x), N·s, on the second body.
    pub tangent_impulse: UmbraFx,
    /// Angular impulse of rolling resistance over the last sub-step, N·m·s, on the second body; 0 with two points.
    pub rolling_impulse: UmbraFx,
    /// The points; zeros for a second one that is not there.
    pub points: [UmbraContactPoint; 2],
    /// Number of points, 1 or 2.
    pub point_count: u32,
    /// 0.
    pub reserved: u32,
}

impl From<&ContactPoint> for UmbraContactPoint {
    fn from(point: &ContactPoint) -> Self {
        Self {
            position: point.position.into(),
            separation: point.separation.to_bits(),
            normal_impulse: point.normal_impulse.to_bits(),
        }
    }
}

impl From<&Contact> for UmbraContact {
    fn from(contact: &Contact) -> Self {
        let points = contact.points();
        Self {
            colliders: contact.colliders.map(collider_word),
            bodies: contact.bodies.map(body_word),
            normal: contact.normal.into(),
            tangent_impulse: contact.tangent_impulse.to_bits(),
            rolling_impulse: contact.rolling_impulse.to_bits(),
            points: [0, 1].map(|i| points.get(i).map(UmbraContactPoint::from).unwrap_or_default()),
            point_count: points.len() as u32,
            reserved: 0,
        }
    }
}

/// The contacts of one body among those of `umbra_world_contacts`; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_body_contacts(
    world: Option<&UmbraWorld>,
    body: u64,
    contacts: *mut UmbraContact,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let touching = given(world)?.world().contacts_of(body_id(body))?;
        let rows: Vec<UmbraContact> = touching.map(|contact| (&contact).into()).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(rows.into_iter(), contacts, capacity, count) }
    })
}

/// The contacts that carried an impulse at the end of the last step, by the slots of their colliders; a list as
/// `umbra_world_outcomes` gives it. Each call computes their points.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_contacts(
    world: Option<&UmbraWorld>,
    contacts: *mut UmbraContact,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<UmbraContact> = given(world)?.world().contacts().map(|contact| (&contact).into()).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), contacts, capacity, count) }
    })
}
