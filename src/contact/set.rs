//! The contacts of a world.

use alloc::borrow::Cow;
use alloc::vec::Vec;

use super::asleep::AsleepContacts;
use super::{ContactRecord, ExcludedPair, PassRecord};
use crate::codec::{self, StateHasher, Write as _};
use crate::collider::OutlineId;
use crate::slots::ColliderId;

/// The state of the contacts of a world.
#[derive(Debug, Default)]
pub(crate) struct ContactSet {
    /// The contacts that carried an impulse at the end of the last step, sorted by pair, of which no body is asleep.
    pub(crate) records: Vec<ContactRecord>,
    /// The contacts with a body that is asleep.
    asleep: AsleepContacts,
    /// The answers of one-way colliders for the bodies near them in the last step, sorted by outline and body.
    pub(crate) passes: Vec<PassRecord>,
    /// The pairs of bodies that do not touch, sorted.
    pub(crate) excluded: Vec<ExcludedPair>,
    /// The tick of the last step with an impulse, with a body near a one-way collider, or in which a pair of bodies was allowed again;
    /// 0 if there was none.
    pub(crate) pushed_at: u64,
}

impl Clone for ContactSet {
    fn clone(&self) -> Self {
        let Self { records, asleep, passes, excluded, pushed_at } = self;
        Self {
            records: records.clone(),
            asleep: asleep.clone(),
            passes: passes.clone(),
            excluded: excluded.clone(),
            pushed_at: *pushed_at,
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.records.clone_from(&source.records);
        self.asleep.clone_from(&source.asleep);
        self.passes.clone_from(&source.passes);
        self.excluded.clone_from(&source.excluded);
        self.pushed_at = source.pushed_at;
    }
}

impl ContactSet {
    /// The contacts in a saved world, sorted by pair. `is_asleep` says of which colliders the bodies are asleep.
    pub(crate) fn new(records: Vec<ContactRecord>, is_asleep: impl Fn(u32) -> bool) -> Self {
        let mut set = Self { records, ..Self::default() };
        set.fall_asleep(is_asleep);
        set
    }

    /// All contacts, sorted by pair.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &ContactRecord> {
        let (mut awake, mut asleep) = (self.records.iter().peekable(), self.asleep.records().iter().peekable());
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

    /// Returns true if there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.records.is_empty() && self.asleep.is_empty()
    }

    /// Changes all contacts, then sorts them; leaves out those for which `change` returns false. *Domain* whether a body is asleep stays.
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
    }

    /// Drops the records of a collider, and its answers if it is one-way.
    pub(crate) fn forget(&mut self, collider: ColliderId) {
        let is_of_others = |record: &ContactRecord| record.pair().iter().all(|outline| outline.slot != collider.slot);
        self.records.retain(is_of_others);
        if self.asleep.touching(collider.slot).next().is_some() {
            self.asleep.retain(|record| is_of_others(record));
        }
        self.passes.retain(|record| record.collider != collider.slot);
    }

    /// Takes the contacts of bodies that fell asleep out of those that steps look at. `is_asleep` says of which colliders they are.
    pub(crate) fn fall_asleep(&mut self, is_asleep: impl Fn(u32) -> bool) {
        let sleeps = |record: &ContactRecord| record.pair().iter().any(|outline| is_asleep(outline.slot));
        if self.records.iter().any(sleeps) {
            self.asleep.extend(self.records.iter().filter(|record| sleeps(record)).copied());
            self.records.retain(|record| !sleeps(record));
        }
    }

    /// Takes the contacts of bodies that woke back.
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

    /// The slots of the colliders that the one in a slot touches, where one of the two bodies is asleep; once for each contact.
    pub(crate) fn asleep_on(&self, slot: u32) -> impl Iterator<Item = u32> {
        self.asleep.touching(slot)
    }

    /// Scales all impulses by the ratio of the length of two sub-steps, num/den: the forces stay the same. Rounded to nearest, halves away
    /// from zero; an impulse beyond 2^62 units becomes that.
    pub(crate) fn rescale(&mut self, num: u64, den: u64) {
        let scaled = |impulse: i64| {
            // Below 2^62 · 2^64: it fits.
            let product = i128::from(impulse) * i128::from(num);
            let half = i128::from(den / 2);
            let rounded = (product.abs() + half) / i128::from(den);
            let size = rounded.min(1 << 62) as i64;
            if impulse < 0 { -size } else { size }
        };
        self.change_all(|record| {
            record.impulses = record.impulses.map(scaled);
            record.impulses != [0; 3]
        });
    }
}
