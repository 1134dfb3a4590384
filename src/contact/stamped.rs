//! Numbers by slot.

use alloc::vec::Vec;

use crate::slots::NONE;

/// Numbers by slot, all of them [`NONE`] after a [`clear`](Self::clear), which takes no time.
#[derive(Debug, Default)]
pub(super) struct Stamped {
    stamp: u32,
    entries: Vec<(u32, u32)>,
}

impl Stamped {
    pub(super) fn clear(&mut self) {
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.entries.clear();
            self.stamp = 1;
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, slot: u32) -> u32 {
        match self.entries.get(slot as usize) {
            Some(&(stamp, number)) if stamp == self.stamp => number,
            _ => NONE,
        }
    }

    pub(super) fn set(&mut self, slot: u32, number: u32) {
        let at = slot as usize;
        if self.entries.len() <= at {
            self.entries.resize(at + 1, (0, NONE));
        }
        self.entries[at] = (self.stamp, number);
    }
}
