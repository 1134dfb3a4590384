//! The fields of a world and their handles.

use alloc::vec::Vec;

use super::Field;
use crate::error::Error;
use crate::handle::{FieldId, are_free};
use crate::limits;
use crate::scalar::Scalar;
use crate::wire::{self, Sink, Write as _};

/// The fields in the order of their slots, which is the order drags act in.
#[derive(Debug)]
pub(crate) struct FieldSet<S: Scalar> {
    slots: Vec<(u32, Option<Entry<S>>)>,
    free: Vec<u32>,
}

/// A field and its hash, so that a hash of the world need not look at what no step changes.
#[derive(Clone, Copy, Debug)]
struct Entry<S: Scalar> {
    field: Field<S>,
    digest: u64,
}

impl<S: Scalar> Entry<S> {
    fn new(field: Field<S>) -> Self {
        Self { digest: Sink::of(&field), field }
    }
}

clone_by_field!(FieldSet { slots, free });

impl<S: Scalar> Default for FieldSet<S> {
    fn default() -> Self {
        Self { slots: Vec::new(), free: Vec::new() }
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
            self.slots.push((0, None));
            (self.slots.len() - 1) as u32
        });
        let entry = &mut self.slots[slot as usize];
        entry.1 = Some(Entry::new(field));
        FieldId { slot, generation: entry.0 }
    }

    pub(crate) fn get(&self, id: FieldId) -> Result<&Field<S>, Error> {
        match self.slots.get(id.slot as usize) {
            Some((generation, Some(entry))) if *generation == id.generation => Ok(&entry.field),
            _ => Err(Error::NoSuchField { field: id }),
        }
    }

    pub(crate) fn replace(&mut self, id: FieldId, field: Field<S>) -> Result<(), Error> {
        self.get(id)?;
        self.slots[id.slot as usize].1 = Some(Entry::new(field));
        Ok(())
    }

    pub(crate) fn remove(&mut self, id: FieldId) -> Result<Field<S>, Error> {
        let field = *self.get(id)?;
        self.slots[id.slot as usize].1 = None;
        let generation = &mut self.slots[id.slot as usize].0;
        if let Some(next) = generation.checked_add(1) {
            *generation = next;
            self.free.push(id.slot);
        }
        Ok(field)
    }

    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = (FieldId, &Field<S>)> {
        self.slots.iter().enumerate().filter_map(|(slot, (generation, entry))| {
            Some((FieldId { slot: slot as u32, generation: *generation }, &entry.as_ref()?.field))
        })
    }

    /// The slots: how often each was taken before, and its field.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<&Field<S>>)> {
        self.slots.iter().map(|(generation, entry)| (*generation, entry.as_ref().map(|entry| &entry.field)))
    }

    /// How often a slot was taken before.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.get(slot as usize).map(|(generation, _)| *generation)
    }

    /// The slots to take next, the last one first.
    pub(crate) fn free(&self) -> &[u32] {
        &self.free
    }

    /// Fields and how their handles are given out, made from what a snapshot says. *Domain* the fields were checked.
    pub(crate) fn rebuilt(slots: Vec<(u32, Option<Field<S>>)>, free: Vec<u32>) -> Result<Self, Error> {
        if !are_free(slots.iter().map(|(_, field)| field.is_none()), &free) {
            return Err(Error::Inconsistent);
        }
        let entries = slots.into_iter().map(|(generation, field)| (generation, field.map(Entry::new)));
        Ok(Self { slots: entries.collect(), free })
    }

    /// Adds to a hash all fields and how their handles are given out.
    pub(crate) fn write(&self, sink: &mut Sink) {
        wire::count(sink, self.slots.len());
        for (generation, entry) in &self.slots {
            generation.write(sink);
            entry.as_ref().map(|entry| entry.digest).write(sink);
        }
        wire::count(sink, self.free.len());
        sink.all(&self.free, u32::to_le_bytes);
    }
}
