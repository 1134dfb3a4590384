//! What some bodies have for a tick and most have not: rows in no order, each found by the slot of its body.

use alloc::vec::Vec;
use core::mem;

use super::columns::NONE;
use crate::handle::BodyId;

/// What a body may have one of.
pub(crate) trait Row {
    /// Whose it is.
    fn body(&self) -> BodyId;
}

/// The rows of the bodies that have one. To add, find and remove one takes as long however many there are.
#[derive(Debug)]
pub(crate) struct BySlot<T> {
    rows: Vec<T>,
    /// Where the row of a slot is, or [`NONE`]; as long as it had to be.
    at: Vec<u32>,
}

impl<T: Clone> Clone for BySlot<T> {
    fn clone(&self) -> Self {
        Self { rows: self.rows.clone(), at: self.at.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.rows.clone_from(&source.rows);
        self.at.clone_from(&source.at);
    }
}

impl<T> Default for BySlot<T> {
    fn default() -> Self {
        Self { rows: Vec::new(), at: Vec::new() }
    }
}

impl<T: Row> BySlot<T> {
    pub(crate) fn rows(&self) -> &[T] {
        &self.rows
    }

    /// The rows, whose bodies are to stay theirs.
    pub(crate) fn rows_mut(&mut self) -> &mut [T] {
        &mut self.rows
    }

    /// In the order of the slots.
    pub(crate) fn in_order(&self) -> impl Iterator<Item = &T> {
        let taken = if self.rows.is_empty() { &[] } else { &self.at[..] };
        taken.iter().filter_map(|&index| self.rows.get(index as usize))
    }

    /// That of a body, if it has one.
    pub(crate) fn get(&self, body: BodyId) -> Option<&T> {
        let index = *self.at.get(body.slot as usize)?;
        self.rows.get(index as usize)
    }

    /// That of a body, which gets this one if it has none.
    pub(crate) fn get_or_insert(&mut self, row: T) -> &mut T {
        let slot = row.body().slot as usize;
        if self.at.len() <= slot {
            self.at.resize(slot + 1, NONE);
        }
        if self.at[slot] == NONE {
            self.at[slot] = self.rows.len() as u32;
            self.rows.push(row);
        }
        &mut self.rows[self.at[slot] as usize]
    }

    /// Takes that of a body away, if it has one.
    pub(crate) fn remove(&mut self, body: BodyId) {
        if let Some(&index) = self.at.get(body.slot as usize).filter(|&&index| index != NONE) {
            self.remove_at(index as usize);
        }
    }

    fn remove_at(&mut self, index: usize) {
        let row = self.rows.swap_remove(index);
        self.at[row.body().slot as usize] = NONE;
        if let Some(moved) = self.rows.get(index) {
            self.at[moved.body().slot as usize] = index as u32;
        }
    }

    /// Takes away those that are not to be kept.
    pub(crate) fn retain(&mut self, is_kept: impl Fn(&T) -> bool) {
        // From behind: what moves up in place of another was looked at.
        for index in (0..self.rows.len()).rev() {
            if !is_kept(&self.rows[index]) {
                self.remove_at(index);
            }
        }
    }

    /// Takes all away.
    pub(crate) fn clear(&mut self) {
        for row in self.rows.drain(..) {
            self.at[row.body().slot as usize] = NONE;
        }
    }

    /// Moves all to a list, in place of what it had.
    pub(crate) fn move_to(&mut self, list: &mut Vec<T>) {
        list.clear();
        for row in &self.rows {
            self.at[row.body().slot as usize] = NONE;
        }
        mem::swap(&mut self.rows, list);
    }
}

#[cfg(test)]
mod tests {
    use alloc::collections::BTreeMap;

    use super::*;

    impl Row for (BodyId, u32) {
        fn body(&self) -> BodyId {
            self.0
        }
    }

    /// Against a map, over some thousand changes.
    #[test]
    fn as_a_map() {
        let (mut rows, mut map) = (BySlot::default(), BTreeMap::new());
        let mut list = alloc::vec![(BodyId::from_parts(99, 0), 0)];
        let mut random = 1u32;
        for step in 0..5000u32 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let body = BodyId::from_parts(random >> 28, 0);
            match random >> 16 & 255 {
                0..90 => {
                    rows.remove(body);
                    map.remove(&body);
                }
                90 => {
                    rows.clear();
                    map.clear();
                }
                91 => {
                    rows.move_to(&mut list);
                    list.sort_unstable();
                    assert!(list.drain(..).eq(mem::take(&mut map)));
                }
                92..98 => {
                    let is_kept = |value: u32| value & 3 != step & 3;
                    rows.retain(|row| is_kept(row.1));
                    map.retain(|_, value| is_kept(*value));
                }
                _ => {
                    let kept = *map.entry(body).or_insert(step);
                    assert_eq!(*rows.get_or_insert((body, step)), (body, kept));
                }
            }
            assert_eq!(rows.get(body).map(|row| row.1), map.get(&body).copied());
            assert!(rows.in_order().copied().eq(map.iter().map(|(body, value)| (*body, *value))));
            assert_eq!(rows.rows().len(), map.len());
        }
    }
}
