//! Numbers of outlines, by which the broad phase knows them: each part of a compound and each segment of a chain is a collider of its own
//! there.

use alloc::vec::Vec;
use core::ops::Range;

use crate::collider::{Collider, ColliderSet, OutlineId};

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

/// The count of numbers that a slot takes: an empty slot takes one, so that numbers stay when a collider of one outline is added or removed.
fn count(collider: Option<&Collider>) -> u32 {
    collider.map_or(1, Collider::outline_count)
}

impl Numbers {
    /// Numbers the outlines anew where colliders have changed. Returns true if outlines may have other numbers than before.
    pub(super) fn update(&mut self, colliders: &ColliderSet) -> bool {
        let is_simple = colliders.more_outlines() == 0;
        if is_simple && self.first.is_empty() || !is_simple && self.revision == colliders.revision() {
            return false;
        }
        let are_kept = !is_simple && !self.first.is_empty() && self.are_kept(colliders);
        self.revision = colliders.revision();
        if !are_kept {
            self.first.clear();
            self.outlines.clear();
        }
        if is_simple {
            return true;
        }
        for (slot, (_, collider)) in (0..).zip(colliders.slots()).skip(self.first.len()) {
            // Below 2^24 slots and 2^24 outlines beyond the first ones.
            self.first.push(self.outlines.len() as u32);
            self.outlines.extend((0..count(collider)).map(|part| OutlineId { slot, part }));
        }
        !are_kept
    }

    /// Returns true if no collider that changed has another number of outlines than the one before it in its slot.
    fn are_kept(&self, colliders: &ColliderSet) -> bool {
        let is_kept = |slot: u32| {
            let first = self.first.get(slot as usize);
            // New slots follow.
            first.is_none_or(|first| self.end(slot as usize) - first == count(colliders.at(slot)))
        };
        colliders.changed_since(self.revision).is_some_and(|mut changed| changed.all(is_kept))
    }

    /// Becomes a copy. Tables of one revision are the same: they follow from the colliders alone.
    pub(super) fn copy_from(&mut self, source: &Self) {
        if self.revision != source.revision || self.is_simple() != source.is_simple() {
            self.first.clone_from(&source.first);
            self.outlines.clone_from(&source.outlines);
            self.revision = source.revision;
        }
    }

    /// Returns true if these colliders are numbered: a copy of a world numbers them when it steps.
    pub(super) fn is_of(&self, colliders: &ColliderSet) -> bool {
        if colliders.more_outlines() == 0 { self.outlines.is_empty() } else { self.revision == colliders.revision() }
    }

    /// Returns true if slots are the numbers.
    #[inline(always)]
    pub(super) fn is_simple(&self) -> bool {
        self.outlines.is_empty()
    }

    /// The number of the first outline of a collider; the numbers of its other parts follow.
    #[inline(always)]
    pub(super) fn first(&self, slot: u32) -> u32 {
        self.first.get(slot as usize).copied().unwrap_or(slot)
    }

    /// The number of an outline.
    #[inline(always)]
    pub(super) fn number(&self, outline: OutlineId) -> u32 {
        self.first(outline.slot) + outline.part
    }

    /// The numbers of a slot.
    pub(super) fn of(&self, slot: u32) -> Range<u32> {
        let end = if self.is_simple() { slot + 1 } else { self.end(slot as usize) };
        self.first(slot)..end
    }

    /// The number after the last one of a slot.
    fn end(&self, slot: usize) -> u32 {
        self.first.get(slot + 1).copied().unwrap_or(self.outlines.len() as u32)
    }

    #[inline(always)]
    pub(super) fn outline(&self, number: u32) -> OutlineId {
        self.outlines.get(number as usize).copied().unwrap_or(OutlineId { slot: number, part: 0 })
    }
}
