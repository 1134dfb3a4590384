//! Contacts of sleeping bodies: kept apart from the contacts of awake bodies, so that steps skip them. A body that wakes starts from the
//! impulses that held it.

use alloc::vec::Vec;

use super::ContactRecord;
use crate::collider::OutlineId;

/// The contacts with a sleeping body. They keep the impulses that the bodies start from when they wake, and say who wakes with whom.
#[derive(Debug, Default)]
pub(crate) struct AsleepContacts {
    /// Sorted by pair.
    records: Vec<ContactRecord>,
    /// The pairs, the second outline of each first, sorted; each with true if no impulse is left.
    by_second: Vec<([OutlineId; 2], bool)>,
}

clone_by_field!([] AsleepContacts { records, by_second });

impl AsleepContacts {
    pub(super) fn records(&self) -> &[ContactRecord] {
        &self.records
    }

    pub(super) fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Adds records that are not in the list yet.
    pub(super) fn extend(&mut self, records: impl Iterator<Item = ContactRecord>) {
        self.records.extend(records);
        self.sort();
    }

    /// Keeps the records for which `keeps` returns true, with the changes that it makes.
    pub(super) fn retain(&mut self, keeps: impl FnMut(&mut ContactRecord) -> bool) {
        self.records.retain_mut(keeps);
        self.sort();
    }

    fn sort(&mut self) {
        self.records.sort_unstable_by_key(ContactRecord::pair);
        self.by_second.clear();
        self.by_second.extend(self.records.iter().map(|record| (swapped(record.pair()), record.is_slack())));
        self.by_second.sort_unstable();
    }

    /// Returns true if there is a record of a pair with impulses.
    pub(super) fn contains(&self, pair: [OutlineId; 2]) -> bool {
        let index = self.records.binary_search_by_key(&pair, ContactRecord::pair);
        index.is_ok_and(|index| !self.records[index].is_slack())
    }

    /// The slots of the colliders that have a contact with the one in a slot, once for each contact; each with true if no impulse is left.
    pub(super) fn touching(&self, slot: u32) -> impl Iterator<Item = (u32, bool)> {
        let start = self.records.partition_point(|record| record.pair()[0].slot < slot);
        let records = self.records[start..].iter().take_while(move |record| record.pair()[0].slot == slot);
        let as_first = records.map(|record| (record.pair(), record.is_slack()));
        let start = self.by_second.partition_point(|(pair, _)| pair[0].slot < slot);
        let as_second = self.by_second[start..].iter().copied().take_while(move |(pair, _)| pair[0].slot == slot);
        as_first.chain(as_second).map(|(pair, is_slack)| (pair[1].slot, is_slack))
    }
}

fn swapped([a, b]: [OutlineId; 2]) -> [OutlineId; 2] {
    [b, a]
}
