//! The joints of a world and their handles.

use alloc::vec::Vec;

use super::link::{Joined, Link};
use super::{JointDef, JointState, JointStates};
use crate::codec::{self, StateHasher, Write as _};
use crate::error::Error;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::{JointId, NONE, Slots, push};

/// The joints, in no order: nothing depends on the order in which they were added.
///
/// The time to add, find or remove a joint, and to visit the joints of a body, does not depend on the number of other joints.
#[derive(Debug, Default)]
pub(crate) struct JointSet<S: Scalar> {
    /// The index of each joint.
    slots: Slots<JointId>,
    /// By index, as are the links.
    entries: Vec<Entry<S>>,
    links: Vec<Link>,
    /// The indices without a joint, to be used again.
    vacant: Vec<u32>,
    /// The first end on each body by its slot, or [`NONE`]; long enough for the bodies that have had a joint, and empty before.
    first_ends: Vec<u32>,
    /// The numbers of joints that keep their bodies from touching each other, and of joints that may break.
    apart: usize,
    breakable: usize,
    /// The number of joints that were added or removed so far: caches of a step compare it.
    revision: u64,
}

/// A joint with its hash, so that a hash of the world does not hash the definitions again, which no step changes.
#[derive(Clone, Copy, Debug)]
struct Entry<S> {
    slot: u32,
    def: JointDef<S>,
    digest: u64,
}

clone_by_field!(JointSet { slots, entries, links, vacant, first_ends, apart, breakable, revision });

impl<S: Scalar> JointSet<S> {
    /// Refuses another joint where the limit is reached.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.slots.has_room(limits::JOINTS) { Ok(()) } else { Err(Error::Full) }
    }

    /// Adds a joint, with a state of its own. *Domain* it was checked, and there is room.
    pub(crate) fn insert(&mut self, def: JointDef<S>, states: &mut JointStates) -> JointId {
        let slot = self.slots.reuse().unwrap_or_else(|| self.slots.open(0));
        self.place(slot, def, JointState::default(), states);
        self.slots.handle(slot)
    }

    /// Puts a joint into a slot without one.
    fn place(&mut self, slot: u32, def: JointDef<S>, state: JointState, states: &mut JointStates) {
        let entry = Entry { slot, def, digest: StateHasher::of(&def) };
        let link = Link::new(&def);
        let index = match self.vacant.pop() {
            Some(index) => {
                (self.entries[index as usize], self.links[index as usize]) = (entry, link);
                states.list[index as usize] = state;
                index
            }
            None => {
                push(&mut self.entries, entry);
                push(&mut self.links, link);
                push(&mut states.list, state);
                (self.entries.len() - 1) as u32
            }
        };
        self.slots.set_index(slot, index);
        self.attach(index);
        self.count(index, |count, more| count + more);
    }

    /// Counts a joint, or with `change` takes it out again.
    fn count(&mut self, index: u32, change: fn(usize, usize) -> usize) {
        let link = &self.links[index as usize];
        self.apart = change(self.apart, usize::from(!link.collides));
        self.breakable = change(self.breakable, usize::from(link.is_breakable()));
        self.revision += 1;
    }

    /// Puts the ends of a joint at the head of the lists of their bodies.
    fn attach(&mut self, index: u32) {
        for side in 0..2 {
            let Some(slot) = self.links[index as usize].ends[side].slot() else { continue };
            let slot = slot as usize;
            if self.first_ends.len() <= slot {
                self.first_ends.resize(slot + 1, NONE);
            }
            let number = 2 * index + side as u32;
            let next = core::mem::replace(&mut self.first_ends[slot], number);
            let end = &mut self.links[index as usize].ends[side];
            (end.previous, end.next) = (NONE, next);
            if next != NONE {
                self.links[next as usize / 2].ends[next as usize % 2].previous = number;
            }
        }
    }

    /// Takes the ends of a joint out of the lists of their bodies.
    fn detach(&mut self, index: u32) {
        for side in 0..2 {
            let end = self.links[index as usize].ends[side];
            let Some(slot) = end.slot() else { continue };
            match end.previous {
                NONE => self.first_ends[slot as usize] = end.next,
                previous => self.links[previous as usize / 2].ends[previous as usize % 2].next = end.next,
            }
            if end.next != NONE {
                self.links[end.next as usize / 2].ends[end.next as usize % 2].previous = end.previous;
            }
        }
    }

    /// The index of a joint.
    pub(crate) fn find(&self, id: JointId) -> Result<usize, Error> {
        self.slots.find(id).ok_or(Error::NoSuchJoint { joint: id })
    }

    pub(crate) fn def(&self, index: usize) -> &JointDef<S> {
        &self.entries[index].def
    }

    pub(crate) fn link(&self, index: usize) -> &Link {
        &self.links[index]
    }

    /// The handle of the joint with an index.
    pub(crate) fn id(&self, index: usize) -> JointId {
        self.slots.handle(self.entries[index].slot)
    }

    /// Replaces the definition of a joint by one with the same ends.
    pub(crate) fn replace(&mut self, index: usize, def: JointDef<S>) {
        self.count(index as u32, |count, less| count - less);
        let entry = &mut self.entries[index];
        (entry.digest, entry.def) = (StateHasher::of(&def), def);
        let ends = self.links[index].ends;
        let mut link = Link::new(&def);
        for (new, old) in link.ends.iter_mut().zip(ends) {
            (new.previous, new.next) = (old.previous, old.next);
        }
        self.links[index] = link;
        self.count(index as u32, |count, more| count + more);
    }

    /// Removes a joint, and resets its state.
    pub(crate) fn remove(&mut self, id: JointId, states: &mut JointStates) -> Result<JointDef<S>, Error> {
        let index = self.find(id)?;
        self.detach(index as u32);
        self.count(index as u32, |count, less| count - less);
        states.list[index] = JointState::default();
        self.vacant.push(index as u32);
        self.slots.release(id.slot);
        Ok(self.entries[index].def)
    }

    /// The joints with their states, as steps see them.
    #[inline]
    pub(crate) fn joined<'a>(&'a self, states: &'a JointStates) -> Joined<'a> {
        Joined {
            links: &self.links,
            first_ends: &self.first_ends,
            states: &states.list,
            are_any_apart: self.apart > 0,
            may_any_break: self.breakable > 0,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.entries.len() - self.vacant.len()
    }

    /// A number that changes with each joint that comes, goes or changes.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The indices of all joints, in the order of their slots.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> {
        self.slots.all().iter().filter_map(|slot| slot.index())
    }

    /// The indices of the joints of the body in a slot, active or not, in no order.
    pub(crate) fn of(&self, slot: u32) -> impl Iterator<Item = usize> {
        let mut end = self.first_ends.get(slot as usize).copied().unwrap_or(NONE) as usize;
        core::iter::from_fn(move || {
            let (index, side) = (end / 2, end % 2);
            end = self.links.get(index)?.ends[side].next as usize;
            Some(index)
        })
    }

    /// The joints of the body in a slot, active or not, in the order of their handles.
    pub(crate) fn of_body(&self, slot: u32) -> Vec<JointId> {
        let mut ids: Vec<JointId> = self.of(slot).map(|index| self.id(index)).collect();
        ids.sort_unstable();
        ids
    }

    /// All slots: how often each was taken before, and the index of its joint.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<usize>)> {
        self.slots.all().iter().map(|slot| (slot.generation, slot.index()))
    }

    /// Generation of a slot; `None` beyond the last slot.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.generation(slot)
    }

    /// The slots to take again, the next one last.
    pub(crate) fn free(&self) -> &[u32] {
        self.slots.free()
    }

    /// Adds a slot from a snapshot. *Domain* the joint was checked.
    pub(crate) fn rebuild(
        &mut self,
        generation: u32,
        joint: Option<(JointDef<S>, JointState)>,
        states: &mut JointStates,
    ) -> Result<(), Error> {
        if self.slots.len() >= limits::JOINTS {
            return Err(Error::Full);
        }
        let slot = self.slots.open(generation);
        if let Some((def, state)) = joint {
            self.place(slot, def, state, states);
        }
        Ok(())
    }

    /// Sets which slots to take again.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] if one has a joint or is listed twice.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if self.slots.set_free(free) { Ok(()) } else { Err(Error::Inconsistent) }
    }

    /// Adds all joints with their states to a hash, and the state of their slots; nothing where there has been no joint.
    pub(crate) fn write(&self, states: &JointStates, sink: &mut StateHasher) {
        if self.slots.len() == 0 {
            return;
        }
        codec::count(sink, self.slots.len());
        for slot in self.slots.all() {
            slot.generation.write(sink);
            slot.index().map(|index| self.entries[index].digest).write(sink);
        }
        codec::count(sink, self.slots.free().len());
        sink.all(self.slots.free(), u32::to_le_bytes);
        self.indices().for_each(|index| states.write(index, sink));
        states.pulled_at.write(sink);
    }
}
