//! The fields of a world and their handles.

use alloc::vec::Vec;

use super::ForceField;
use crate::codec::{self, StateHasher, Write as _};
use crate::error::Error;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::{BodyId, FieldId, NONE, Slots, push};

/// The fields in the order in which they were added. The order of their slots will not do: there, unrelated fields that came
/// and went would decide which of two drags acts first.
///
/// The time to add, replace, find or remove a field, and to visit the fields attached to a body, does not depend on the number
/// of other fields.
#[derive(Debug, Default)]
pub(crate) struct FieldSet<S: Scalar> {
    /// The index of the entry of each field.
    slots: Slots<FieldId>,
    entries: Vec<Entry<S>>,
    /// The entries without a field, to be used again.
    vacant: Vec<u32>,
    /// The entries with a field, the oldest first, and [`NONE`] where one was removed. At most half of the list is [`NONE`].
    by_age: Vec<u32>,
    /// The first edge of each body by its slot, or [`NONE`]; long enough for the bodies that have had an edge.
    first_edges: Vec<u32>,
}

/// A field with its hash, so that a hash of the world does not hash the fields again, which no step changes.
#[derive(Clone, Copy, Debug)]
struct Entry<S: Scalar> {
    slot: u32,
    /// The index of the entry in `by_age`.
    age: u32,
    field: ForceField<S>,
    digest: u64,
    /// An edge for each end of the field. Edge 2·i + e is end e of entry i.
    edges: [Edge; 2],
}

/// The neighbours of an end of a field in the list of the edges of its body, or [`NONE`].
#[derive(Clone, Copy, Debug)]
struct Edge {
    previous: u32,
    next: u32,
}

const NO_EDGE: Edge = Edge { previous: NONE, next: NONE };

clone_by_field!(FieldSet { slots, entries, vacant, by_age, first_edges });

impl<S: Scalar> FieldSet<S> {
    /// Refuses another field where the limit is reached.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.slots.has_room(limits::FIELDS) { Ok(()) } else { Err(Error::Full) }
    }

    /// Adds a field. *Domain* it was checked, and there is room.
    pub(crate) fn insert(&mut self, field: ForceField<S>) -> FieldId {
        let slot = self.slots.reuse().unwrap_or_else(|| self.slots.open(0));
        let at = self.place(slot, field);
        self.entries[at as usize].age = self.by_age.len() as u32;
        push(&mut self.by_age, at);
        self.slots.handle(slot)
    }

    /// Puts a field into a slot without one and returns the index of its entry. The caller sets its age.
    fn place(&mut self, slot: u32, field: ForceField<S>) -> u32 {
        let entry = Entry { slot, age: NONE, digest: StateHasher::of(&field), field, edges: [NO_EDGE; 2] };
        let at = if let Some(at) = self.vacant.pop() {
            self.entries[at as usize] = entry;
            at
        } else {
            push(&mut self.entries, entry);
            (self.entries.len() - 1) as u32
        };
        self.slots.set_index(slot, at);
        self.attach(at);
        at
    }

    /// Puts the edges of an entry at the head of the lists of their bodies.
    fn attach(&mut self, at: u32) {
        for (end, body) in self.entries[at as usize].field.ends().into_iter().enumerate() {
            let Some(body) = body else { continue };
            let slot = body.slot as usize;
            if self.first_edges.len() <= slot {
                self.first_edges.resize(slot + 1, NONE);
            }
            let edge = 2 * at + end as u32;
            let next = core::mem::replace(&mut self.first_edges[slot], edge);
            *self.edge(edge) = Edge { previous: NONE, next };
            if next != NONE {
                self.edge(next).previous = edge;
            }
        }
    }

    /// Takes the edges of an entry out of the lists of their bodies.
    fn detach(&mut self, at: u32) {
        for (end, body) in self.entries[at as usize].field.ends().into_iter().enumerate() {
            let Some(body) = body else { continue };
            let Edge { previous, next } = *self.edge(2 * at + end as u32);
            match previous {
                NONE => self.first_edges[body.slot as usize] = next,
                previous => self.edge(previous).next = next,
            }
            if next != NONE {
                self.edge(next).previous = previous;
            }
        }
    }

    fn edge(&mut self, edge: u32) -> &mut Edge {
        &mut self.entries[edge as usize / 2].edges[edge as usize % 2]
    }

    /// The fields attached to a body of the world, in no order; each once, as no spring has both ends on one body.
    pub(crate) fn attached_to(&self, body: BodyId) -> impl Iterator<Item = (FieldId, &ForceField<S>)> {
        let mut edge = self.first_edges.get(body.slot as usize).copied().unwrap_or(NONE);
        core::iter::from_fn(move || {
            let entry = self.entries.get(edge as usize / 2)?;
            edge = entry.edges[edge as usize % 2].next;
            Some((self.slots.handle(entry.slot), &entry.field))
        })
    }

    /// Returns true if a field is attached to a body of the world.
    pub(crate) fn is_attached(&self, body: BodyId) -> bool {
        self.first_edges.get(body.slot as usize).is_some_and(|&edge| edge != NONE)
    }

    /// The groups of all fields that act on bodies by their groups. It looks at all fields.
    pub(crate) fn coupling_groups(&self) -> u32 {
        let by_groups = self.by_age().filter(|entry| entry.field.kind.acts_by_groups());
        by_groups.fold(0, |force_groups, entry| force_groups | entry.field.force_groups)
    }

    /// The fields attached to a body of the world, the oldest first.
    pub(crate) fn attached_by_age(&self, body: BodyId) -> Vec<FieldId> {
        let mut ids: Vec<FieldId> = self.attached_to(body).map(|(id, _)| id).collect();
        ids.sort_unstable_by_key(|&id| self.slots.find(id).map(|at| self.entries[at].age));
        ids
    }

    /// The index of the entry of a field.
    fn find(&self, id: FieldId) -> Result<usize, Error> {
        self.slots.find(id).ok_or(Error::NoSuchField { field: id })
    }

    pub(crate) fn get(&self, id: FieldId) -> Result<&ForceField<S>, Error> {
        self.find(id).map(|at| &self.entries[at].field)
    }

    pub(crate) fn replace(&mut self, id: FieldId, field: ForceField<S>) -> Result<(), Error> {
        let at = self.find(id)?;
        self.detach(at as u32);
        let entry = &mut self.entries[at];
        (entry.digest, entry.field) = (StateHasher::of(&field), field);
        self.attach(at as u32);
        Ok(())
    }

    pub(crate) fn remove(&mut self, id: FieldId) -> Result<ForceField<S>, Error> {
        let at = self.find(id)?;
        self.detach(at as u32);
        let Entry { field, age, .. } = self.entries[at];
        self.by_age[age as usize] = NONE;
        self.vacant.push(at as u32);
        // As many fields have to be removed again before this is done the next time.
        if self.by_age.len() > 2 * self.len() {
            self.by_age.retain(|&at| at != NONE);
            self.number_ages();
        }
        self.slots.release(id.slot);
        Ok(field)
    }

    /// Sets the ages of the entries from `by_age`.
    fn number_ages(&mut self) {
        for (age, &at) in self.by_age.iter().enumerate() {
            self.entries[at as usize].age = age as u32;
        }
    }

    fn by_age(&self) -> impl DoubleEndedIterator<Item = &Entry<S>> {
        self.by_age.iter().filter(|&&at| at != NONE).map(|&at| &self.entries[at as usize])
    }

    pub(crate) fn len(&self) -> usize {
        self.entries.len() - self.vacant.len()
    }

    /// The fields, the oldest first.
    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = (FieldId, &ForceField<S>)> {
        self.by_age().map(|entry| (self.slots.handle(entry.slot), &entry.field))
    }

    /// The slots with fields, in the order in which the fields were added.
    pub(crate) fn ages(&self) -> Vec<u32> {
        self.by_age().map(|entry| entry.slot).collect()
    }

    /// All slots: how often each was taken before, and its field.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<&ForceField<S>>)> {
        self.slots.all().iter().map(|slot| (slot.generation, slot.index().map(|at| &self.entries[at].field)))
    }

    /// Generation of a slot; `None` beyond the last slot.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.generation(slot)
    }

    /// The slots to take again, the next one last.
    pub(crate) fn free(&self) -> &[u32] {
        self.slots.free()
    }

    /// Adds a slot from a snapshot; a call of [`set_ages`](Self::set_ages) has to follow. *Domain* the field was checked.
    pub(crate) fn rebuild(&mut self, generation: u32, field: Option<ForceField<S>>) -> Result<(), Error> {
        if self.slots.len() >= limits::FIELDS {
            return Err(Error::Full);
        }
        let slot = self.slots.open(generation);
        if let Some(field) = field {
            self.place(slot, field);
        }
        Ok(())
    }

    /// Sets which slots to take again.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] if one has a field or is listed twice.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if self.slots.set_free(free) { Ok(()) } else { Err(Error::Inconsistent) }
    }

    /// Sets the order in which the fields were added, by their slots.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] unless each field is listed once.
    pub(crate) fn set_ages(&mut self, slots: &[u32]) -> Result<(), Error> {
        let mut is_left: Vec<bool> = self.slots.all().iter().map(|slot| slot.is_taken()).collect();
        let mut take = |slot: u32| is_left.get_mut(slot as usize).is_some_and(core::mem::take);
        if slots.len() != self.entries.len() || !slots.iter().all(|&slot| take(slot)) {
            return Err(Error::Inconsistent);
        }
        self.by_age = slots.iter().map(|&slot| self.slots.all()[slot as usize].index_or_none()).collect();
        self.number_ages();
        Ok(())
    }

    /// Adds all fields to a hash, and the state of their slots.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.slots.len());
        for slot in self.slots.all() {
            slot.generation.write(sink);
            slot.index().map(|at| self.entries[at].digest).write(sink);
        }
        codec::count(sink, self.slots.free().len());
        sink.all(self.slots.free(), u32::to_le_bytes);
        codec::count(sink, self.len());
        self.by_age().for_each(|entry| entry.slot.write(sink));
    }
}
