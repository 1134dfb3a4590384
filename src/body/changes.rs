//! The log of which body changed in what. Each cache of a step has a cursor into it, and drops what changed since it last read the log.

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
    pub(crate) const fn or(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}

/// A position in the log: how far a cache has read it. A cache that has read nothing takes all bodies as changed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChangeCursor {
    entry: u64,
    group_fields: u64,
}

/// The changes that a cache may not have read yet. The log is derived: a cache that takes all bodies as changed has the same results.
///
/// A log that grows longer than [`FEW`] entries and an eighth of the bodies is given up: then all bodies count as changed.
#[derive(Debug)]
pub(crate) struct Changes {
    /// Slots and changes, in the order of the calls; a slot may be there more than once, and its body may be gone.
    entries: Vec<(u32, Change)>,
    /// The position of the first entry.
    first: u64,
    /// The position from which on no cache has read.
    unread: u64,
    /// The number of times that a field which acts on bodies by their groups was added, replaced or removed.
    group_fields: u64,
}

/// The number of entries that are kept in any world.
const FEW: usize = 4096;

clone_by_field!([] Changes { entries, first, unread, group_fields });

impl Default for Changes {
    /// Nothing is known of the bodies yet.
    fn default() -> Self {
        Self { entries: Vec::new(), first: 1, unread: 1, group_fields: 1 }
    }
}

impl Changes {
    /// The position after the last entry.
    fn end(&self) -> u64 {
        self.first + self.entries.len() as u64
    }

    /// Notes a change of the body in a slot, one of `slots`.
    pub(crate) fn note(&mut self, slot: u32, change: Change, slots: usize) {
        let is_unread = self.unread < self.end();
        let count = self.entries.len();
        match self.entries.last_mut() {
            Some((last, noted)) if *last == slot && is_unread => *noted = noted.or(change),
            _ if count < (slots / 8).max(FEW) => self.entries.push((slot, change)),
            _ => self.give_up(),
        }
    }

    /// Notes that any body and any field may have changed in anything.
    pub(crate) fn note_all(&mut self) {
        self.give_up();
        self.note_group_fields();
    }

    /// Notes that the fields changed that act on bodies by their groups.
    pub(crate) fn note_group_fields(&mut self) {
        self.group_fields += 1;
    }

    /// Leaves all cursors behind.
    fn give_up(&mut self) {
        self.first = self.end() + 1;
        self.unread = self.first;
        self.entries.clear();
    }

    /// The position after all changes so far, for a cache that has read them.
    pub(crate) fn read(&mut self) -> ChangeCursor {
        self.unread = self.end();
        ChangeCursor { entry: self.unread, group_fields: self.group_fields }
    }

    /// The slots that changed after a position, and in what; `None` if any body may have changed in anything.
    pub(crate) fn since(&self, cursor: ChangeCursor) -> Option<&[(u32, Change)]> {
        let index = cursor.entry.checked_sub(self.first)?;
        self.entries.get(index as usize..)
    }

    /// Returns true if a field that acts on bodies by their groups changed after a position.
    pub(crate) fn have_group_fields_changed(&self, cursor: ChangeCursor) -> bool {
        self.group_fields != cursor.group_fields
    }

    /// Returns true if nothing changed after a position.
    pub(crate) fn is_nothing_since(&self, cursor: ChangeCursor) -> bool {
        !self.have_group_fields_changed(cursor) && self.since(cursor).is_some_and(<[_]>::is_empty)
    }

    /// Forgets the entries before all of these positions. A cursor that the log has left behind keeps none.
    pub(crate) fn forget_read(&mut self, cursors: impl IntoIterator<Item = ChangeCursor>) {
        if self.entries.is_empty() {
            return;
        }
        let unread = cursors.into_iter().filter_map(|cursor| self.since(cursor));
        let kept = unread.map(<[_]>::len).max().unwrap_or(0);
        let forgotten = self.entries.len() - kept;
        self.entries.drain(..forgotten);
        self.first += forgotten as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cursor_reads_what_changed_since_it_was_taken() {
        let mut changes = Changes::default();
        assert!(changes.since(ChangeCursor::default()).is_none());
        let first = changes.read();
        assert!(changes.is_nothing_since(first));
        changes.note(7, Change::POSE, 10);
        changes.note(7, Change::VELOCITY, 10);
        assert_eq!(changes.since(first), Some(&[(7, Change::POSE.or(Change::VELOCITY))][..]));
        // A change of a slot that a cache has read is another entry.
        let second = changes.read();
        changes.note(7, Change::FORCES, 10);
        assert_eq!(changes.since(second), Some(&[(7, Change::FORCES)][..]));
        assert_eq!(changes.since(first).map(<[_]>::len), Some(2));
        changes.forget_read([second, first]);
        assert_eq!(changes.since(first).map(<[_]>::len), Some(2));
        changes.forget_read([second]);
        assert!(changes.since(first).is_none());
        assert_eq!(changes.since(second), Some(&[(7, Change::FORCES)][..]));
        // A cursor left behind keeps nothing.
        changes.forget_read([first]);
        assert!(changes.since(second).is_none());
        let third = changes.read();
        changes.note_group_fields();
        assert!(changes.since(third).is_some_and(<[_]>::is_empty) && !changes.is_nothing_since(third));
        let fourth = changes.read();
        (0..FEW as u32 + 1).for_each(|slot| changes.note(slot, Change::POSE, 10));
        assert!(changes.since(fourth).is_none());
        let fifth = changes.read();
        assert!(changes.is_nothing_since(fifth));
        changes.note_all();
        assert!(changes.since(fifth).is_none() && changes.have_group_fields_changed(fifth));
    }
}
