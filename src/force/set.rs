//! The fields of a world and their handles.

use alloc::vec::Vec;

use super::Field;
use crate::body::{NONE, push};
use crate::error::Error;
use crate::handle::{FieldId, are_free};
use crate::limits;
use crate::scalar::Scalar;
use crate::wire::{self, Sink, Write as _};

/// The fields, in the order in which they came: by their slots, strangers' fields that came and went would decide which of
/// two drags acts first.
#[derive(Debug)]
pub(crate) struct FieldSet<S: Scalar> {
    slots: Vec<Slot>,
    free: Vec<u32>,
    entries: Vec<Entry<S>>,
    /// Entries of fields that are gone, to be used again.
    vacant: Vec<u32>,
    /// The other entries, the oldest field first.
    by_age: Vec<u32>,
}

/// One without a field takes as little as in a file, however many there are.
#[derive(Clone, Copy, Debug)]
struct Slot {
    generation: u32,
    /// Where its entry is, or [`NONE`].
    at: u32,
}

/// A field and its hash, so that a hash of the world need not look at what no step changes.
#[derive(Clone, Copy, Debug)]
struct Entry<S: Scalar> {
    slot: u32,
    field: Field<S>,
    digest: u64,
}

impl<S: Scalar> Entry<S> {
    fn new(slot: u32, field: Field<S>) -> Self {
        Self { slot, digest: Sink::of(&field), field }
    }
}

clone_by_field!(FieldSet { slots, free, entries, vacant, by_age });

impl<S: Scalar> Default for FieldSet<S> {
    fn default() -> Self {
        Self { slots: Vec::new(), free: Vec::new(), entries: Vec::new(), vacant: Vec::new(), by_age: Vec::new() }
    }
}

impl<S: Scalar> FieldSet<S> {
    /// Refuses where there is no room for another field.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.free.is_empty() && self.slots.len() >= limits::FIELDS { Err(Error::Full) } else { Ok(()) }
    }

    /// Adds a field. *Domain* it was checked, and there is room.
    pub(crate) fn insert(&mut self, field: Field<S>) -> FieldId {
        let slot = self.free.pop().unwrap_or_else(|| {
            push(&mut self.slots, Slot { generation: 0, at: NONE });
            (self.slots.len() - 1) as u32
        });
        let at = self.place(slot, field);
        push(&mut self.by_age, at);
        FieldId { slot, generation: self.slots[slot as usize].generation }
    }

    /// Puts a field into a slot without one, and says where its entry is.
    fn place(&mut self, slot: u32, field: Field<S>) -> u32 {
        let entry = Entry::new(slot, field);
        let at = if let Some(at) = self.vacant.pop() {
            self.entries[at as usize] = entry;
            at
        } else {
            push(&mut self.entries, entry);
            (self.entries.len() - 1) as u32
        };
        self.slots[slot as usize].at = at;
        at
    }

    /// Where the entry of a field is.
    fn find(&self, id: FieldId) -> Result<usize, Error> {
        match self.slots.get(id.slot as usize) {
            Some(slot) if slot.generation == id.generation && slot.at != NONE => Ok(slot.at as usize),
            _ => Err(Error::NoSuchField { field: id }),
        }
    }

    pub(crate) fn get(&self, id: FieldId) -> Result<&Field<S>, Error> {
        self.find(id).map(|at| &self.entries[at].field)
    }

    pub(crate) fn replace(&mut self, id: FieldId, field: Field<S>) -> Result<(), Error> {
        let at = self.find(id)?;
        self.entries[at] = Entry::new(id.slot, field);
        Ok(())
    }

    pub(crate) fn remove(&mut self, id: FieldId) -> Result<Field<S>, Error> {
        let at = self.find(id)?;
        self.vacant.push(at as u32);
        self.by_age.retain(|&other| other as usize != at);
        let slot = &mut self.slots[id.slot as usize];
        slot.at = NONE;
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.slot);
        }
        Ok(self.entries[at].field)
    }

    fn by_age(&self) -> impl DoubleEndedIterator<Item = &Entry<S>> {
        self.by_age.iter().map(|&at| &self.entries[at as usize])
    }

    pub(crate) fn len(&self) -> usize {
        self.by_age.len()
    }

    /// The oldest first.
    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = (FieldId, &Field<S>)> {
        self.by_age().map(|Entry { slot, field, .. }| {
            (FieldId { slot: *slot, generation: self.slots[*slot as usize].generation }, field)
        })
    }

    /// The slots with fields, that of the oldest first.
    pub(crate) fn ages(&self) -> Vec<u32> {
        self.by_age().map(|entry| entry.slot).collect()
    }

    /// The slots: how often each was taken before, and its field.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<&Field<S>>)> {
        self.slots.iter().map(|slot| (slot.generation, self.entries.get(slot.at as usize).map(|entry| &entry.field)))
    }

    /// How often a slot was taken before.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.get(slot as usize).map(|slot| slot.generation)
    }

    /// The slots to take next, the last one first.
    pub(crate) fn free(&self) -> &[u32] {
        &self.free
    }

    /// Adds a slot as a snapshot has it; [`set_ages`](Self::set_ages) is to follow. *Domain* the field was checked.
    pub(crate) fn rebuild(&mut self, generation: u32, field: Option<Field<S>>) -> Result<(), Error> {
        if self.slots.len() >= limits::FIELDS {
            return Err(Error::Full);
        }
        push(&mut self.slots, Slot { generation, at: NONE });
        if let Some(field) = field {
            self.place((self.slots.len() - 1) as u32, field);
        }
        Ok(())
    }

    /// Says which slots to take next: each one without a field, and once.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if !are_free(self.slots.iter().map(|slot| slot.at == NONE), &free) {
            return Err(Error::Inconsistent);
        }
        self.free = free;
        Ok(())
    }

    /// Says in which order the fields came: each of them, and once.
    pub(crate) fn set_ages(&mut self, slots: &[u32]) -> Result<(), Error> {
        let mut is_left: Vec<bool> = self.slots.iter().map(|slot| slot.at != NONE).collect();
        let mut take = |slot: u32| is_left.get_mut(slot as usize).is_some_and(core::mem::take);
        if slots.len() != self.entries.len() || !slots.iter().all(|&slot| take(slot)) {
            return Err(Error::Inconsistent);
        }
        self.by_age = slots.iter().map(|&slot| self.slots[slot as usize].at).collect();
        Ok(())
    }

    /// Adds to a hash all fields and how their handles are given out.
    pub(crate) fn write(&self, sink: &mut Sink) {
        wire::count(sink, self.slots.len());
        for slot in &self.slots {
            slot.generation.write(sink);
            self.entries.get(slot.at as usize).map(|entry| entry.digest).write(sink);
        }
        wire::count(sink, self.free.len());
        sink.all(&self.free, u32::to_le_bytes);
        wire::count(sink, self.by_age.len());
        self.by_age().for_each(|entry| entry.slot.write(sink));
    }
}
