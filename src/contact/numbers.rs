//! Numbers of outlines, by which the broad phase knows them.

use alloc::vec::Vec;

use crate::collider::{ColliderSet, OutlineId};
use crate::scalar::Scalar;

/// A number for each outline of a world: sorted by number they are sorted by collider and part.
///
/// Where each collider has one outline, its slot is its number, and there are no tables.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    /// The number of the first outline of the collider in each slot.
    first: Vec<u32>,
    outlines: Vec<OutlineId>,
    /// The revision of the colliders that the tables were made from.
    revision: u64,
}

impl Numbers {
    /// Numbers the outlines anew where colliders have changed.
    pub(super) fn update<S: Scalar>(&mut self, colliders: &ColliderSet<S>) {
        let is_simple = colliders.more_outlines() == 0;
        if is_simple && self.first.is_empty() || !is_simple && self.revision == colliders.revision() {
            return;
        }
        self.first.clear();
        self.outlines.clear();
        self.revision = colliders.revision();
        if is_simple {
            return;
        }
        for (_, collider) in colliders.slots() {
            // Below 2^24 slots and 2^24 outlines beyond the first ones.
            self.first.push(self.outlines.len() as u32);
            let Some(collider) = collider else { continue };
            self.outlines.extend((0..collider.outline_count()).map(|part| OutlineId { slot: collider.slot, part }));
        }
    }

    /// Returns true if slots are the numbers.
    #[inline(always)]
    pub(super) fn is_simple(&self) -> bool {
        self.outlines.is_empty()
    }

    /// The number of the first outline of a collider; those of its other parts follow.
    #[inline(always)]
    pub(super) fn first(&self, slot: u32) -> u32 {
        self.first.get(slot as usize).copied().unwrap_or(slot)
    }

    #[inline(always)]
    pub(super) fn outline(&self, number: u32) -> OutlineId {
        self.outlines.get(number as usize).copied().unwrap_or(OutlineId { slot: number, part: 0 })
    }
}
