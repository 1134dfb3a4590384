//! The bodies in the order of their slots, which is the order of everything public: how hashes and files have them.

use alloc::vec::Vec;
use core::ops::Range;
use core::slice;

use super::columns::{Bodies, NONE};
use crate::codec::StateHasher;
use crate::error::Error;
use crate::scalar::Scalar;
use crate::slots::Slot;

/// The most ranges that bodies are looked up in; with more of them it is done body by body.
const MOST_RUNS: usize = 32;

/// Ranges of indices in the columns.
pub(super) struct Runs {
    ranges: [Range<u32>; MOST_RUNS],
    count: usize,
}

impl Runs {
    fn push(&mut self, run: Range<u32>) -> Option<()> {
        if run.is_empty() {
            return Some(());
        }
        *self.ranges.get_mut(self.count)? = run;
        self.count += 1;
        Some(())
    }

    fn iter(&self) -> impl Iterator<Item = Range<usize>> {
        self.ranges[..self.count].iter().map(|run| run.start as usize..run.end as usize)
    }
}

/// The indices of bodies in the columns, in the order of their slots.
#[derive(Clone, Debug)]
pub(crate) struct InOrder<'a>(slice::Iter<'a, Slot>);

impl Iterator for InOrder<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        self.0.find_map(|slot| slot.index())
    }

    fn fold<B, F: FnMut(B, usize) -> B>(self, init: B, f: F) -> B {
        self.0.filter_map(|slot| slot.index()).fold(init, f)
    }
}

impl<S: Scalar> Bodies<S> {
    /// Indices in the columns in the order of the slots, which is the order of everything public.
    pub(crate) fn in_order(&self) -> InOrder<'_> {
        InOrder(self.slots.all().iter())
    }

    /// The indices of [`in_order`](Self::in_order) as ranges of consecutive ones; `None` if there are more than a few.
    pub(super) fn runs(&self) -> Option<Runs> {
        let mut runs = Runs { ranges: [const { 0..0 }; MOST_RUNS], count: 0 };
        let mut run = 0..0;
        for slots in self.slots.all().chunks(64) {
            // Where no body was removed and none sleeps, this needs no branch for each slot.
            if slots.iter().zip(run.end..).fold(true, |follows, (slot, next)| follows & (slot.index_or_none() == next))
            {
                run.end += slots.len() as u32;
                continue;
            }
            for dense in slots.iter().map(|slot| slot.index_or_none()).filter(|&dense| dense != NONE) {
                if dense == run.end {
                    run.end += 1;
                } else {
                    runs.push(core::mem::replace(&mut run, dense..dense + 1))?;
                }
            }
        }
        runs.push(run)?;
        Some(runs)
    }

    /// Adds a column to a hash, in the order of the slots.
    pub(super) fn write_column<T: Copy, const BYTES: usize>(
        &self,
        sink: &mut StateHasher,
        runs: Option<&Runs>,
        column: &[T],
        bytes: impl Fn(T) -> [u8; BYTES] + Copy,
    ) {
        match runs {
            Some(runs) => runs.iter().for_each(|run| sink.all(&column[run], bytes)),
            None => sink.each(self.in_order().map(|dense| column[dense]), bytes),
        }
    }

    /// All slots: how often each was taken before, and the index of its body in the columns.
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

    /// Sets which slots to take again.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] if one has a body or is listed twice.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if self.slots.set_free(free) { Ok(()) } else { Err(Error::Inconsistent) }
    }
}
