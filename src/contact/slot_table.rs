//! A map from slots to numbers that is cleared in constant time.

use alloc::vec::Vec;

use crate::slots::NONE;

/// A map from slots to numbers. A slot without a number has [`NONE`]; [`clear`](Self::clear) takes constant time.
#[derive(Debug, Default)]
pub(super) struct SlotTable {
    stamp: u32,
    entries: Vec<(u32, u32)>,
}

impl SlotTable {
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
        let index = slot as usize;
        if self.entries.len() <= index {
            self.entries.resize(index + 1, (0, NONE));
        }
        self.entries[index] = (self.stamp, number);
    }
}
