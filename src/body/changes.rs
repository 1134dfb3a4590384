//! The record of which body changed in what since the last step. Caches of a step take from it what they have to drop.
//!
//! A step keeps for the next one: for each block of free bodies the number of steps in which none of them can leave the allowed range,
//! the accelerations by fields of position, and the sines and cosines of bodies with something attached. Each cache drops the entries of
//! bodies that changed, and of the bodies at the other ends of their springs. Only a change of a field that acts by groups, of a body that
//! carries an attractor, or of more than an eighth of all bodies drops everything.

use alloc::vec::Vec;

/// The quantities of a body that changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Change(u8);

impl Change {
    /// Linear or angular velocity.
    pub(crate) const VELOCITY: Self = Self(1);
    /// Position, angle, or its index in the columns.
    pub(crate) const POSE: Self = Self(1 << 1);
    /// Anything that decides which fields act on it and how: kind, groups, mass, locks, activity, the fields attached to it,
    /// or data that a custom force may read.
    pub(crate) const FORCES: Self = Self(1 << 2);
    /// The colliders of a static body: neither its pose nor what acts on it.
    pub(crate) const COLLIDERS: Self = Self(1 << 3);
    /// All changes.
    pub(crate) const ALL: Self = Self(0b1111);

    /// Returns true if any of these quantities changed.
    pub(crate) fn is_any_of(self, others: Self) -> bool {
        self.0 & others.0 != 0
    }

    /// Either change.
    pub(crate) const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// All changes since the last step. It is derived: dropping a cache changes no bit.
///
/// A list that grows longer than an eighth of the bodies is given up: then all bodies count as changed.
#[derive(Debug)]
pub(crate) struct Changes {
    /// Slots and changes, in the order of the calls; a slot may be there more than once, and its body may be gone.
    bodies: Vec<(u32, Change)>,
    /// True if any body may have changed in any quantity.
    all: bool,
    /// True if a field that acts on bodies by their groups was added, replaced or removed.
    group_fields: bool,
    /// Memory that parting the bodies uses again.
    pub(super) indices: Vec<usize>,
}

impl Clone for Changes {
    fn clone(&self) -> Self {
        Self { bodies: self.bodies.clone(), indices: Vec::new(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        self.bodies.clone_from(&source.bodies);
        (self.all, self.group_fields) = (source.all, source.group_fields);
    }
}

impl Default for Changes {
    /// Nothing is known of the bodies yet.
    fn default() -> Self {
        Self { bodies: Vec::new(), all: true, group_fields: true, indices: Vec::new() }
    }
}

impl Changes {
    /// Notes a change of the body in a slot, one of `slots`.
    pub(crate) fn note(&mut self, slot: u32, change: Change, slots: usize) {
        if self.all {
            return;
        }
        let count = self.bodies.len();
        match self.bodies.last_mut() {
            Some((last, noted)) if *last == slot => *noted = noted.or(change),
            _ if count < (slots / 8).max(64) => self.bodies.push((slot, change)),
            _ => {
                self.bodies.clear();
                self.all = true;
            }
        }
    }

    /// Notes that any body and any field may have changed in anything.
    pub(crate) fn note_all(&mut self) {
        *self = Self::default();
    }

    /// Notes that the fields changed that act on bodies by their groups.
    pub(crate) fn note_group_fields(&mut self) {
        self.group_fields = true;
    }

    /// The slots that changed and in what; `None` if any may have in anything.
    pub(crate) fn bodies(&self) -> Option<&[(u32, Change)]> {
        (!self.all).then_some(&self.bodies)
    }

    pub(crate) fn group_fields(&self) -> bool {
        self.group_fields
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.is_empty() && !self.all && !self.group_fields
    }

    /// Forgets all changes.
    pub(crate) fn clear(&mut self) {
        self.bodies.clear();
        (self.all, self.group_fields) = (false, false);
    }
}
