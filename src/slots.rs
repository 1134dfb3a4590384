//! Handles, and the slots they name: how often each was taken, what is in it, and which one is taken next.

use alloc::vec::Vec;
use core::fmt;
use core::marker::PhantomData;

/// Marks the absence of an index.
pub(crate) const NONE: u32 = u32::MAX;

/// A typed name of a slot and of its occupant: the slot and how often it was taken before.
pub(crate) trait Handle: Copy {
    fn new(slot: u32, generation: u32) -> Self;
    fn slot(self) -> u32;
    fn generation(self) -> u32;
}

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident, $noun:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
        pub struct $name {
            pub(crate) slot: u32,
            pub(crate) generation: u32,
        }

        impl $name {
            /// The slot and its generation. A slot that becomes free is used again, each time with the next generation.
            #[must_use]
            pub const fn parts(self) -> (u32, u32) {
                (self.slot, self.generation)
            }

            /// The handle made of these parts, for one that was sent or saved.
            #[must_use]
            pub const fn from_parts(slot: u32, generation: u32) -> Self {
                Self { slot, generation }
            }
        }

        impl Handle for $name {
            fn new(slot: u32, generation: u32) -> Self {
                Self { slot, generation }
            }

            fn slot(self) -> u32 {
                self.slot
            }

            fn generation(self) -> u32 {
                self.generation
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($noun, " {}"), self.slot)?;
                if self.generation > 0 { write!(f, " (generation {})", self.generation) } else { Ok(()) }
            }
        }
    };
}

handle!(
    /// A handle to a body. It is valid until the body is removed, and never names another body afterwards.
    BodyId,
    "body"
);
handle!(
    /// A handle to a force field. It is valid until the field is removed, and never names another field afterwards.
    FieldId,
    "force field"
);

handle!(
    /// A handle to a collider. It is valid until the collider or its body is removed, and never names another collider afterwards.
    ColliderId,
    "collider"
);

handle!(
    /// A handle to a joint. It is valid until the joint or one of its bodies is removed, and never names another joint afterwards.
    JointId,
    "joint"
);

/// A slot. A slot without an occupant takes as little memory as in a file, however many there are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// Generation of the slot: the number of times it was taken before.
    pub(crate) generation: u32,
    /// The index of the occupant in the list of its owner, or [`NONE`].
    index: u32,
}

impl Slot {
    /// The index of the occupant, or [`NONE`].
    pub(crate) fn index_or_none(self) -> u32 {
        self.index
    }

    pub(crate) fn index(self) -> Option<usize> {
        if self.index == NONE { None } else { Some(self.index as usize) }
    }

    pub(crate) fn is_taken(self) -> bool {
        self.index != NONE
    }
}

/// The slots of one kind of handle. The choice of the next slot is part of the state of a world: handles are the same in every
/// copy of it.
#[derive(Debug)]
pub(crate) struct Slots<H> {
    slots: Vec<Slot>,
    /// Slots to take again; the last one freed is taken first.
    free: Vec<u32>,
    handle: PhantomData<H>,
}

clone_by_field!([H] Slots<H> { slots, free, handle });

impl<H> Default for Slots<H> {
    fn default() -> Self {
        Self { slots: Vec::new(), free: Vec::new(), handle: PhantomData }
    }
}

impl<H: Handle> Slots<H> {
    /// Number of slots, with an occupant or without.
    pub(crate) fn len(&self) -> usize {
        self.slots.len()
    }

    /// All slots, by number.
    pub(crate) fn all(&self) -> &[Slot] {
        &self.slots
    }

    /// Returns true if another occupant fits into at most `limit` slots.
    pub(crate) fn has_room(&self, limit: usize) -> bool {
        !self.free.is_empty() || self.slots.len() < limit
    }

    /// Returns true if `more` occupants fit into at most `limit` slots.
    pub(crate) fn has_room_for(&self, more: usize, limit: usize) -> bool {
        more <= self.free.len() || more - self.free.len() <= limit.saturating_sub(self.slots.len())
    }

    /// Takes a free slot, if there is one. It has no occupant until [`set_index`](Self::set_index) is called.
    pub(crate) fn reuse(&mut self) -> Option<u32> {
        self.free.pop()
    }

    /// Adds a slot without an occupant. It is not among the free ones.
    pub(crate) fn open(&mut self, generation: u32) -> u32 {
        push(&mut self.slots, Slot { generation, index: NONE });
        (self.slots.len() - 1) as u32
    }

    /// Records where the occupant of a slot is.
    pub(crate) fn set_index(&mut self, slot: u32, index: u32) {
        self.slots[slot as usize].index = index;
    }

    /// Frees a slot. One whose generations are used up is never taken again: no handle names two occupants.
    pub(crate) fn release(&mut self, slot: u32) {
        let released = &mut self.slots[slot as usize];
        released.index = NONE;
        if let Some(next) = released.generation.checked_add(1) {
            released.generation = next;
            self.free.push(slot);
        }
    }

    /// The index of the occupant that a handle names, if it is still there.
    #[inline]
    pub(crate) fn find(&self, handle: H) -> Option<usize> {
        match self.slots.get(handle.slot() as usize) {
            Some(slot) if slot.generation == handle.generation() && slot.index != NONE => Some(slot.index as usize),
            _ => None,
        }
    }

    /// The handle of the occupant of a slot.
    pub(crate) fn handle(&self, slot: u32) -> H {
        H::new(slot, self.slots[slot as usize].generation)
    }

    /// Generation of a slot; `None` beyond the last slot.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.get(slot as usize).map(|slot| slot.generation)
    }

    /// The slots to take again, the next one last.
    pub(crate) fn free(&self) -> &[u32] {
        &self.free
    }

    /// Sets which slots to take again. Refuses, with `false`, a list that names a slot with an occupant or names one twice.
    #[must_use]
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> bool {
        let mut is_free: Vec<bool> = self.slots.iter().map(|slot| !slot.is_taken()).collect();
        let fits = free.iter().all(|&slot| is_free.get_mut(slot as usize).is_some_and(core::mem::take));
        if fits {
            self.free = free;
        }
        fits
    }
}

/// Adds a value to a list. A list of more than a few values grows by an eighth instead of to twice its size, so that little
/// memory is reserved for values to come.
pub(crate) fn push<T>(list: &mut Vec<T>, value: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len().clamp(4, 16).max(list.len() / 8));
    }
    list.push(value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_slot_freed_is_taken_first_with_the_next_generation() {
        let mut slots = Slots::<BodyId>::default();
        let ids = [0, 1, 2].map(|index| {
            let slot = slots.open(0);
            slots.set_index(slot, index);
            slots.handle(slot)
        });
        slots.release(0);
        slots.release(2);
        assert_eq!(ids.map(|id| slots.find(id)), [None, Some(1), None]);
        assert_eq!([slots.reuse(), slots.reuse(), slots.reuse()], [Some(2), Some(0), None]);
        slots.set_index(2, 7);
        assert_eq!((slots.find(ids[2]), slots.find(BodyId::from_parts(2, 1))), (None, Some(7)));
    }

    #[test]
    fn a_slot_whose_generations_are_used_up_is_never_taken_again() {
        let mut slots = Slots::<FieldId>::default();
        for (generation, free) in [(u32::MAX - 1, &[0][..]), (u32::MAX, &[0][..])] {
            let slot = slots.open(generation);
            slots.set_index(slot, 0);
            slots.release(slot);
            assert_eq!((slots.free(), slots.find(FieldId::from_parts(slot, generation))), (free, None));
        }
    }

    #[test]
    fn only_free_slots_are_listed_as_free_and_each_of_them_once() {
        let mut slots = Slots::<BodyId>::default();
        (0..3).for_each(|_| _ = slots.open(0));
        slots.set_index(1, 0);
        for (free, fits) in [(&[1][..], false), (&[0, 0], false), (&[3], false), (&[2, 0], true), (&[2], true)] {
            assert_eq!(slots.set_free(free.to_vec()), fits, "{free:?}");
        }
        assert_eq!(slots.free(), [2]);
    }
}
