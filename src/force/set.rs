//! The fields of a world and their handles.

use alloc::vec::Vec;

use super::ForceField;
use crate::body::{NONE, push};
use crate::codec::{self, StateHasher, Write as _};
use crate::error::Error;
use crate::handle::{BodyId, FieldId, are_free};
use crate::limits;
use crate::scalar::Scalar;

/// The fields, in the order in which they were added: by their slots, fields of others that came and went would decide which
/// of two drags acts first.
///
/// To add, replace, find and remove a field, and to go through those attached to a body, takes as long however many others
/// there are.
#[derive(Debug)]
pub(crate) struct FieldSet<S: Scalar> {
    slots: Vec<Slot>,
    free: Vec<u32>,
    entries: Vec<Entry<S>>,
    /// Entries without a field, to be used again.
    vacant: Vec<u32>,
    /// The other entries, the oldest field first, and [`NONE`] where one was removed. At most half of it is [`NONE`].
    by_age: Vec<u32>,
    /// The first edge of each body, by its slot, or [`NONE`]; as long as it had to be.
    first_edges: Vec<u32>,
}

/// A slot without a field takes as little as in a file, however many there are.
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
    /// Where it is in `by_age`.
    age: u32,
    field: ForceField<S>,
    digest: u64,
    /// One for each end of the field. Edge 2·i + e is end e of entry i.
    edges: [Edge; 2],
}

/// The neighbours of an end of a field in the list of the edges of its body, or [`NONE`].
#[derive(Clone, Copy, Debug)]
struct Edge {
    previous: u32,
    next: u32,
}

const NO_EDGE: Edge = Edge { previous: NONE, next: NONE };

clone_by_field!(FieldSet { slots, free, entries, vacant, by_age, first_edges });

impl<S: Scalar> Default for FieldSet<S> {
    fn default() -> Self {
        let (slots, free, entries, vacant) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { slots, free, entries, vacant, by_age: Vec::new(), first_edges: Vec::new() }
    }
}

impl<S: Scalar> FieldSet<S> {
    /// Refuses where there is no room for another field.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.free.is_empty() && self.slots.len() >= limits::FIELDS { Err(Error::Full) } else { Ok(()) }
    }

    /// Adds a field. *Domain* it was checked, and there is room.
    pub(crate) fn insert(&mut self, field: ForceField<S>) -> FieldId {
        let slot = self.free.pop().unwrap_or_else(|| {
            push(&mut self.slots, Slot { generation: 0, at: NONE });
            (self.slots.len() - 1) as u32
        });
        let at = self.place(slot, field);
        self.entries[at as usize].age = self.by_age.len() as u32;
        push(&mut self.by_age, at);
        FieldId { slot, generation: self.slots[slot as usize].generation }
    }

    /// Puts a field into a slot without one, and says where its entry is. Its age is the caller's to set.
    fn place(&mut self, slot: u32, field: ForceField<S>) -> u32 {
        let entry = Entry { slot, age: NONE, digest: StateHasher::of(&field), field, edges: [NO_EDGE; 2] };
        let at = if let Some(at) = self.vacant.pop() {
            self.entries[at as usize] = entry;
            at
        } else {
            push(&mut self.entries, entry);
            (self.entries.len() - 1) as u32
        };
        self.slots[slot as usize].at = at;
        self.attach(at);
        at
    }

    /// Puts the edges of an entry before those that their bodies have.
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

    /// The fields attached to a body of the world, in no order; a spring whose ends are on one body does not exist.
    pub(crate) fn attached_to(&self, body: BodyId) -> impl Iterator<Item = (FieldId, &ForceField<S>)> {
        let first = self.first_edges.get(body.slot as usize).copied().unwrap_or(NONE);
        let mut edge = first;
        core::iter::from_fn(move || {
            let entry = self.entries.get(edge as usize / 2)?;
            edge = entry.edges[edge as usize % 2].next;
            Some((self.id(entry.slot), &entry.field))
        })
    }

    /// Whether a field is attached to a body of the world.
    pub(crate) fn is_attached(&self, body: BodyId) -> bool {
        self.first_edges.get(body.slot as usize).is_some_and(|&edge| edge != NONE)
    }

    /// The groups of all fields that act on bodies by their groups. It looks at all fields.
    pub(crate) fn coupling_groups(&self) -> u32 {
        let by_groups = self.by_age().filter(|entry| entry.field.kind.acts_by_groups());
        by_groups.fold(0, |groups, entry| groups | entry.field.groups)
    }

    /// The fields attached to a body of the world, the oldest first.
    pub(crate) fn attached_by_age(&self, body: BodyId) -> Vec<FieldId> {
        let mut ids: Vec<FieldId> = self.attached_to(body).map(|(id, _)| id).collect();
        ids.sort_unstable_by_key(|id| self.entries[self.slots[id.slot as usize].at as usize].age);
        ids
    }

    fn id(&self, slot: u32) -> FieldId {
        FieldId { slot, generation: self.slots[slot as usize].generation }
    }

    /// Where the entry of a field is.
    fn find(&self, id: FieldId) -> Result<usize, Error> {
        match self.slots.get(id.slot as usize) {
            Some(slot) if slot.generation == id.generation && slot.at != NONE => Ok(slot.at as usize),
            _ => Err(Error::NoSuchField { field: id }),
        }
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
        // As many have to be removed again before the next time.
        if self.by_age.len() > 2 * self.len() {
            self.by_age.retain(|&at| at != NONE);
            self.number_ages();
        }
        let slot = &mut self.slots[id.slot as usize];
        slot.at = NONE;
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.slot);
        }
        Ok(field)
    }

    /// Tells the entries where they are in `by_age`.
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

    /// The oldest first.
    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = (FieldId, &ForceField<S>)> {
        self.by_age().map(|entry| (self.id(entry.slot), &entry.field))
    }

    /// The slots with fields, that of the oldest first.
    pub(crate) fn ages(&self) -> Vec<u32> {
        self.by_age().map(|entry| entry.slot).collect()
    }

    /// The slots: how often each was taken before, and its field.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<&ForceField<S>>)> {
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
    pub(crate) fn rebuild(&mut self, generation: u32, field: Option<ForceField<S>>) -> Result<(), Error> {
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
        self.number_ages();
        Ok(())
    }

    /// Adds to a hash all fields and how their handles are given out.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.slots.len());
        for slot in &self.slots {
            slot.generation.write(sink);
            self.entries.get(slot.at as usize).map(|entry| entry.digest).write(sink);
        }
        codec::count(sink, self.free.len());
        sink.all(&self.free, u32::to_le_bytes);
        codec::count(sink, self.len());
        self.by_age().for_each(|entry| entry.slot.write(sink));
    }
}
