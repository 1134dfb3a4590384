//! The sets that the bodies are parted into in the columns: free, coupled, and all that no step moves.
//!
//! A moving body is *coupled* if a force field may act on it or is attached to it, and *free* otherwise. Which set a body is in,
//! and its index within a set, is not state: it decides how a step computes, not what. Hashes and files go by slot.
//!
//! The columns hold the free bodies first, then the coupled ones, then the static, sleeping, quarantined and disabled bodies. A step first
//! moves bodies between the sets, if their groups, kind, activity or attached fields changed. It looks at all bodies only if the groups of
//! the fields changed.

use core::ops::Range;

use super::changes::{Change, ChangeCursor, Changes};
use super::columns::Bodies;
use super::motion::Block;
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> Bodies<S> {
    /// The number of bodies that a step moves. They are the first of the columns.
    pub(crate) fn moving(&self) -> usize {
        self.moving
    }

    /// The number of free bodies, as of the last [`part`](Self::part). They are the first of the columns.
    pub(crate) fn free_count(&self) -> usize {
        self.first_coupled
    }

    /// The bodies that a step moves.
    pub(crate) fn all_moving(&mut self) -> Block<'_, S> {
        self.block(0..self.moving)
    }

    /// Some of the bodies that a step moves, by their indices.
    pub(crate) fn block(&mut self, indices: Range<usize>) -> Block<'_, S> {
        Block::new(&mut self.columns.motion, &self.columns.factors, indices.start, indices.end)
    }

    /// Notes a change of the body at this index in the columns.
    pub(crate) fn note(&mut self, dense: usize, change: Change) {
        let slots = self.slots().len();
        self.changes.note(self.columns.slot[dense], change, slots);
    }

    /// Notes a change of a body, if it is there.
    pub(crate) fn note_body(&mut self, body: BodyId, change: Change) {
        if let Ok(dense) = self.find(body) {
            self.note(dense, change);
        }
    }

    /// The log of what changed.
    pub(crate) fn changes(&self) -> &Changes {
        &self.changes
    }

    /// Forgets the changes that the parting and these caches have read.
    pub(crate) fn forget_changes(&mut self, read: &[ChangeCursor]) {
        let parted = self.parted;
        self.changes.forget_read(read.iter().copied().chain([parted]));
    }

    pub(crate) fn changes_mut(&mut self) -> &mut Changes {
        &mut self.changes
    }

    /// The index of the body in a slot, if there is one.
    pub(crate) fn index_in(&self, slot: u32) -> Option<usize> {
        self.slots.all().get(slot as usize)?.index()
    }

    /// Moves a body among those that a step moves, or out of them; returns its new index.
    pub(crate) fn set_moving(&mut self, dense: usize, moving: bool) -> usize {
        match (dense < self.moving, moving) {
            (false, true) => {
                self.any_come = true;
                // Among the coupled ones: the next step looks at the fields.
                self.swap(dense, self.moving);
                self.moving += 1;
                self.moving - 1
            }
            (true, false) => {
                let mut dense = dense;
                if dense < self.first_coupled {
                    self.first_coupled -= 1;
                    self.swap(dense, self.first_coupled);
                    dense = self.first_coupled;
                }
                self.moving -= 1;
                self.swap(dense, self.moving);
                self.moving
            }
            _ => dense,
        }
    }

    /// Parts the bodies that a step moves into free and coupled ones. It looks at the bodies that changed, or at all where
    /// the groups changed by which fields act.
    ///
    /// `force_groups` returns the groups of all fields that act on bodies by their groups, `is_attached` whether a field is attached to a
    /// body.
    pub(crate) fn part(&mut self, force_groups: impl Fn() -> u32, is_attached: impl Fn(BodyId) -> bool) {
        if self.changes.is_nothing_since(self.parted) {
            return;
        }
        let have_fields_changed = self.changes.have_group_fields_changed(self.parted);
        let force_groups = if have_fields_changed { force_groups() } else { self.coupling_groups };
        let is_coupled = |bodies: &Self, i: usize| bodies.info(i).feels(force_groups) || is_attached(bodies.id(i));
        let same_groups = core::mem::replace(&mut self.coupling_groups, force_groups) == force_groups;
        let changed = self.changes.since(self.parted).filter(|_| same_groups);
        match changed {
            Some(changed) => {
                let mut indices = core::mem::take(&mut self.parting);
                let changed = changed.iter().filter(|(_, change)| change.is_any_of(Change::FORCES));
                indices.extend(changed.filter_map(|&(slot, _)| self.index_in(slot)));
                indices.sort_unstable();
                indices.dedup();
                indices.retain(|&i| i < self.moving && is_coupled(self, i) != (i >= self.first_coupled));
                self.change_sets(&indices);
                indices.clear();
                self.parting = indices;
            }
            None => self.part_all(is_coupled),
        }
        self.parted = self.changes.read();
    }

    /// Makes all bodies that a step moves free: there are no fields.
    pub(crate) fn free_all(&mut self) {
        (self.coupling_groups, self.first_coupled) = (0, self.moving);
        self.parted = self.changes.read();
    }

    /// Moves these bodies, in ascending order, from the set they are in to the other one.
    fn change_sets(&mut self, indices: &[usize]) {
        let (free, coupled) = indices.split_at(indices.partition_point(|&i| i < self.first_coupled));
        // From the border on, so that bodies next to it change sets without changing places.
        for &i in coupled {
            self.swap(i, self.first_coupled);
            self.first_coupled += 1;
        }
        for &i in free.iter().rev() {
            self.first_coupled -= 1;
            self.swap(i, self.first_coupled);
        }
    }

    fn part_all(&mut self, is_coupled: impl Fn(&Self, usize) -> bool) {
        let (mut first, mut end) = (0, self.moving);
        loop {
            while first < end && !is_coupled(self, first) {
                first += 1;
            }
            while first < end && is_coupled(self, end - 1) {
                end -= 1;
            }
            if first == end {
                break;
            }
            self.swap(first, end - 1);
        }
        self.first_coupled = first;
    }
}
