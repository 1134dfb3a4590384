//! The contacts of a world.

use alloc::borrow::Cow;
use alloc::vec::Vec;

use super::asleep::AsleepContacts;
use super::{ContactBodies, ContactRecord, EndedPair, ExcludedPair, OneWayAnswer, Overlap};
use crate::codec::{self, StateHasher, Write as _};
use crate::collider::{ColliderSet, OutlineId};
use crate::solve::Impulses;

/// The state of the contacts of a world.
#[derive(Debug, Default)]
pub(crate) struct ContactSet {
    /// The contacts without a sleeping body that carried an impulse at the end of the last step, or, if they have
    /// events, touched in it; sorted by pair.
    pub(crate) records: Vec<ContactRecord>,
    /// The contacts with a body that is asleep.
    pub(super) asleep: AsleepContacts,
    /// The answers of one-way colliders for the bodies near them in the last step, sorted by outline and body.
    pub(crate) passes: Vec<OneWayAnswer>,
    /// The pairs of bodies that do not touch, sorted.
    pub(crate) excluded: Vec<ExcludedPair>,
    /// The colliders that overlapped sensors at the end of the last step, sorted.
    pub(crate) overlaps: Vec<Overlap>,
    /// The pairs that calls ended since the last step, in the order of the calls.
    pub(crate) ended: Vec<EndedPair>,
    /// The tick of the last step with an impulse, with a body near a one-way collider, in which a pair of bodies was allowed again, or in
    /// which a collider entered or left a sensor; 0 if there was none.
    pub(crate) pushed_at: u64,
}

clone_by_field!([] ContactSet { records, asleep, passes, excluded, overlaps, ended, pushed_at });

impl ContactSet {
    /// The contacts in a saved world, sorted by pair. `is_asleep` tells whether the body of a collider is asleep, by its slot.
    pub(crate) fn new(records: Vec<ContactRecord>, is_asleep: impl Fn(u32) -> bool) -> Self {
        let mut set = Self { records, ..Self::default() };
        set.fall_asleep(is_asleep);
        set
    }

    /// All contacts, sorted by pair.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &ContactRecord> {
        let mut awake = self.records.iter().peekable();
        let mut asleep = self.asleep.records().iter().peekable();
        core::iter::from_fn(move || match (awake.peek(), asleep.peek()) {
            (Some(a), Some(b)) if b.pair() < a.pair() => asleep.next(),
            (None, _) => asleep.next(),
            _ => awake.next(),
        })
    }

    /// All contacts in one list.
    pub(crate) fn all(&self) -> Cow<'_, [ContactRecord]> {
        if self.asleep.is_empty() { Cow::Borrowed(&self.records) } else { self.iter().copied().collect() }
    }

    /// Returns true if there is no contact.
    pub(crate) fn is_empty(&self) -> bool {
        self.records.is_empty() && self.asleep.is_empty()
    }

    /// Changes all contacts, then sorts them; leaves out the contacts for which `change` returns false. *Domain* whether a body is asleep stays.
    pub(crate) fn change_all(&mut self, mut change: impl FnMut(&mut ContactRecord) -> bool) {
        self.records.retain_mut(&mut change);
        self.records.sort_unstable_by_key(ContactRecord::pair);
        if !self.asleep.is_empty() {
            self.asleep.retain(change);
        }
    }

    /// Adds all contacts to a hash.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        self.pushed_at.write(sink);
        let all = self.all();
        codec::count(sink, all.len());
        sink.all(&all, |record| record.to_bytes());
        codec::list(sink, self.passes.iter());
        codec::list(sink, self.excluded.iter());
        codec::list(sink, self.overlaps.iter());
        codec::list(sink, self.ended.iter());
    }

    /// Drops the records of colliders of a body, their answers if they are one-way, and their overlaps; the contacts and overlaps that end are
    /// kept for the report of the next step. *Domain* the colliders still have them; their slots are sorted.
    pub(crate) fn forget(&mut self, bodies: &dyn ContactBodies, colliders: &ColliderSet, slots: &[u32]) {
        if slots.is_empty() {
            return;
        }
        self.keep_ends(bodies, colliders, slots);
        // Most calls name one collider.
        let stays = |slot: u32| match slots {
            [collider] => slot != *collider,
            _ => slots.binary_search(&slot).is_err(),
        };
        self.overlaps.retain(|overlap| overlap.slots().into_iter().all(stays));
        let is_kept = |record: &ContactRecord| record.pair().iter().all(|outline| stays(outline.slot));
        self.records.retain(is_kept);
        if self.any_asleep_with(slots) {
            self.asleep.retain(|record| is_kept(record));
        }
        self.passes.retain(|record| stays(record.collider));
    }

    /// Returns true if one of these colliders has a contact in which a body is asleep.
    pub(super) fn any_asleep_with(&self, slots: &[u32]) -> bool {
        !self.asleep.is_empty() && slots.iter().any(|&slot| self.asleep.touching(slot).next().is_some())
    }

    /// Moves the contacts of bodies that fell asleep to the list that steps do not look at. `is_asleep` tells whether the body of a
    /// collider is asleep, by its slot.
    pub(crate) fn fall_asleep(&mut self, is_asleep: impl Fn(u32) -> bool) {
        let sleeps = |record: &ContactRecord| record.pair().iter().any(|outline| is_asleep(outline.slot));
        if self.records.iter().any(sleeps) {
            self.asleep.extend(self.records.iter().filter(|record| sleeps(record)).copied());
            self.records.retain(|record| !sleeps(record));
        }
    }

    /// Moves the contacts of bodies that woke back to the list of awake contacts.
    pub(crate) fn wake(&mut self, is_asleep: impl Fn(u32) -> bool) {
        if self.asleep.is_empty() {
            return;
        }
        let sleeps = |record: &ContactRecord| record.pair().iter().any(|outline| is_asleep(outline.slot));
        let awake = self.records.len();
        self.records.extend(self.asleep.records().iter().filter(|record| !sleeps(record)));
        if self.records.len() > awake {
            self.records.sort_unstable_by_key(ContactRecord::pair);
            self.asleep.retain(|record| sleeps(record));
        }
    }

    /// Returns true if the bodies of a pair of outlines lay on each other when one of them fell asleep.
    pub(crate) fn are_asleep_on_each_other(&self, pair: [OutlineId; 2]) -> bool {
        self.asleep.contains(pair)
    }

    /// The slots of the colliders that have a contact with the one in a slot, where one of the two bodies is asleep, once for each contact;
    /// each with true if no impulse is left.
    pub(crate) fn asleep_with(&self, slot: u32) -> impl Iterator<Item = (u32, bool)> {
        self.asleep.touching(slot)
    }

    /// Scales all impulses by the ratio of the length of two sub-steps, num/den: the forces stay the same.
    pub(crate) fn rescale(&mut self, num: u64, den: u64) {
        self.change_all(|record| {
            let impulses = Impulses { values: record.impulses, exponent: record.exponent() };
            record.impulses = impulses.rescaled(num, den).values;
            true
        });
    }
}
