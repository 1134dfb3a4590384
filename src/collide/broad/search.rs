//! Searches for candidates, and the overlaps that they reject.

use alloc::vec::Vec;

use super::entry::Entry;
use super::tree::Extent;
use super::{BroadPhase, PairLimits, RestingTrees, Statics, key, pair};
use crate::collider::Filter;
use crate::fx::Fx;
use crate::shape::Aabb;

/// The most candidates and rejected overlaps that a search may come to.
#[derive(Clone, Copy)]
pub(super) struct Room {
    pub(super) candidates: usize,
    pub(super) rejected: usize,
}

impl BroadPhase {
    /// Visits the colliders that moved in the last step, whose boxes meet a box and whose filters agree with a filter, with the numbers of
    /// their bodies, until `visit` returns false.
    pub(crate) fn search_movers(&self, bounds: Aabb<Fx>, filter: Filter, mut visit: impl FnMut(u32, u32) -> bool) {
        let extent = Extent::new(bounds.into(), filter);
        self.tree.search(
            0,
            |node| node.meets(&extent),
            |collider| {
                let is_met = self.boxes[collider as usize].overlaps(&extent.bounds);
                let entry = &self.entries[collider as usize];
                !is_met || !filter.agrees(entry.filter) || visit(collider, entry.body)
            },
        );
    }

    /// Searches the candidates of all moving colliders.
    pub(super) fn search_all(&mut self, resting: &RestingTrees<'_>, room: Room) {
        self.settle();
        // With new fat boxes for all: most would leave theirs soon, and each of them then costs a search of its own.
        self.refit(true);
        self.join(resting, room);
    }

    /// Lists all candidates, from the boxes in the tree, or a part of them if there is no room for all that it comes to.
    fn join(&mut self, resting: &RestingTrees<'_>, room: Room) {
        let mut candidates = core::mem::take(&mut self.candidates);
        candidates.clear();
        self.rejected = 0;
        let Self { tree, entries, .. } = self;
        for (leaf, collider, extent) in tree.leaves() {
            let entry = &entries[collider as usize];
            let mut rejected = 0;
            // The leaves from there on alone: each two of them once.
            tree.search(
                leaf as usize + 1,
                |node| node.touches(extent),
                |other_collider| {
                    if entry.may_meet(&entries[other_collider as usize]) {
                        candidates.push(key(collider, other_collider));
                    } else {
                        rejected += 1;
                    }
                    candidates.len() <= room.candidates && rejected <= room.rejected
                },
            );
            entries[collider as usize].rejected = rejected as u32;
            self.rejected += rejected;
            if candidates.len() > room.candidates || self.rejected > room.rejected {
                break;
            }
        }
        for tree in resting.trees().filter(|tree| !tree.is_empty()) {
            for i in 0..self.movers.len() {
                if candidates.len() > room.candidates || self.rejected > room.rejected {
                    break;
                }
                self.search_resting(tree, self.movers[i], room, &mut candidates);
            }
        }
        self.is_complete = candidates.len() <= room.candidates && self.rejected <= room.rejected;
        if self.is_complete {
            candidates.sort_unstable();
        }
        self.candidates = candidates;
    }

    /// Adds the candidates of a moving collider with the colliders at rest.
    fn search_resting(&mut self, resting: &Statics, collider: u32, room: Room, candidates: &mut Vec<u64>) {
        let Entry { filter, .. } = self.entries[collider as usize];
        let extent = self.entries[collider as usize].extent();
        let mut rejected = 0;
        resting.search(
            |node| node.touches(&extent),
            |proxy| {
                if filter.agrees(proxy.filter) {
                    self.boxes[proxy.collider as usize] = proxy.bounds.into();
                    candidates.push(key(collider, proxy.collider));
                } else {
                    rejected += 1;
                }
                candidates.len() <= room.candidates && rejected <= room.rejected
            },
        );
        self.reject(collider, rejected);
    }

    /// Counts the overlaps that a search of a collider rejected.
    fn reject(&mut self, collider: u32, rejected: usize) {
        self.entries[collider as usize].rejected += rejected as u32;
        self.rejected += rejected;
    }

    /// Searches the candidates of the stale colliders.
    pub(super) fn search_stale(&mut self, resting: &RestingTrees<'_>, room: Room) {
        if self.stale.is_empty() && self.gone.is_empty() {
            return;
        }
        self.refit(false);
        let entries = &self.entries;
        let is_stale = |collider: u32| entries[collider as usize].is_stale;
        self.candidates.retain(|&key| !pair(key).map(is_stale).contains(&true));
        let mut new_candidates = core::mem::take(&mut self.new_candidates);
        new_candidates.clear();
        let room = Room { candidates: room.candidates.saturating_sub(self.candidates.len()), ..room };
        for i in 0..self.stale.len() {
            let collider = self.stale[i];
            let before = core::mem::take(&mut self.entries[collider as usize].rejected);
            self.rejected = self.rejected.saturating_sub(before as usize);
            let entry = &self.entries[collider as usize];
            let extent = entry.extent();
            let mut rejected = 0;
            self.tree.search(
                0,
                |node| node.touches(&extent),
                |other_collider| {
                    let other_entry = &self.entries[other_collider as usize];
                    if !entry.may_meet(other_entry) {
                        rejected += 1;
                    } else if !other_entry.is_stale || collider < other_collider {
                        // Of two stale colliders, the lower one finds the pair.
                        new_candidates.push(key(collider, other_collider));
                    }
                    new_candidates.len() <= room.candidates && rejected <= room.rejected
                },
            );
            self.reject(collider, rejected);
            for tree in resting.trees() {
                self.search_resting(tree, collider, room, &mut new_candidates);
            }
            if new_candidates.len() > room.candidates || self.rejected > room.rejected {
                break;
            }
        }
        self.is_complete = new_candidates.len() <= room.candidates && self.rejected <= room.rejected;
        new_candidates.sort_unstable();
        merge(&mut self.candidates, &new_candidates);
        self.new_candidates = new_candidates;
        self.settle();
    }

    /// Lists as candidates the pairs themselves. Returns false if there are more pairs or overlaps than there may be.
    #[cold]
    pub(super) fn search_exactly(&mut self, resting: &RestingTrees<'_>, limits: &PairLimits) -> bool {
        for &collider in &self.movers {
            let entry = &mut self.entries[collider as usize];
            entry.fit(self.boxes[collider as usize]);
            self.tree.set(entry.leaf, entry.extent());
        }
        self.build();
        self.join(resting, Room { candidates: limits.pairs, rejected: limits.overlaps });
        self.is_complete && self.is_within(limits)
    }

    /// Returns true if there are no more overlaps of fat boxes than of boxes there may be.
    pub(super) fn is_within(&self, limits: &PairLimits) -> bool {
        self.candidates.len().saturating_add(self.rejected) <= limits.overlaps
    }
}

/// Merges a sorted list into another one. No number is in both.
fn merge(list: &mut Vec<u64>, additions: &[u64]) {
    let (mut left, mut right) = (list.len(), additions.len());
    list.resize(left + right, 0);
    while right > 0 {
        let is_old_last = left > 0 && list[left - 1] > additions[right - 1];
        list[left + right - 1] = if is_old_last { list[left - 1] } else { additions[right - 1] };
        if is_old_last { left -= 1 } else { right -= 1 }
    }
}
