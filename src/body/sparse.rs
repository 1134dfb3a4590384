//! What some bodies have for a while and most have not: rows in no order, each found by its key.

use alloc::vec::Vec;
use core::mem;

use super::columns::NONE;

/// What a body may have one of.
pub(crate) trait Row {
    /// Whose it is: a slot, or an index in the columns.
    fn key(&self) -> usize;
}

/// The rows of the bodies that have one. To add, find and remove one takes as long however many there are.
#[derive(Debug)]
pub(crate) struct Sparse<T> {
    rows: Vec<T>,
    /// Where the row of a key is, or [`NONE`]; as long as it had to be.
    at: Vec<u32>,
}

impl<T: Clone> Clone for Sparse<T> {
    fn clone(&self) -> Self {
        Self { rows: self.rows.clone(), at: self.at.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.rows.clone_from(&source.rows);
        self.at.clone_from(&source.at);
    }
}

impl<T> Default for Sparse<T> {
    fn default() -> Self {
        Self { rows: Vec::new(), at: Vec::new() }
    }
}

impl<T: Row> Sparse<T> {
    pub(crate) fn rows(&self) -> &[T] {
        &self.rows
    }

    /// The rows, whose keys are to stay theirs.
    pub(crate) fn rows_mut(&mut self) -> &mut [T] {
        &mut self.rows
    }

    /// In the order of the keys.
    pub(crate) fn in_order(&self) -> impl Iterator<Item = &T> {
        let taken = if self.rows.is_empty() { &[] } else { &self.at[..] };
        taken.iter().filter_map(|&index| self.rows.get(index as usize))
    }

    /// That of a key, if it has one.
    pub(crate) fn get(&self, key: usize) -> Option<&T> {
        let index = *self.at.get(key)?;
        self.rows.get(index as usize)
    }

    /// That of a key, which gets one that is made for it if it has none.
    pub(crate) fn get_or_insert(&mut self, key: usize, make: impl FnOnce() -> T) -> &mut T {
        if self.at.len() <= key {
            self.at.resize(key + 1, NONE);
        }
        if self.at[key] == NONE {
            self.at[key] = self.rows.len() as u32;
            let row = make();
            debug_assert_eq!(row.key(), key);
            self.rows.push(row);
        }
        &mut self.rows[self.at[key] as usize]
    }

    /// Takes that of a key away, if it has one.
    pub(crate) fn remove(&mut self, key: usize) {
        if let Some(&index) = self.at.get(key).filter(|&&index| index != NONE) {
            self.remove_at(index as usize);
        }
    }

    fn remove_at(&mut self, index: usize) {
        let row = self.rows.swap_remove(index);
        self.at[row.key()] = NONE;
        if let Some(moved) = self.rows.get(index) {
            self.at[moved.key()] = index as u32;
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
            self.at[row.key()] = NONE;
        }
    }

    /// Moves all to a list, in place of what it had.
    pub(crate) fn move_to(&mut self, list: &mut Vec<T>) {
        list.clear();
        for row in &self.rows {
            self.at[row.key()] = NONE;
        }
        mem::swap(&mut self.rows, list);
    }
}

/// With the key beside what is kept for it.
impl<T> Row for (usize, T) {
    fn key(&self) -> usize {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use alloc::collections::BTreeMap;

    use super::*;

    /// Against a map, over some thousand changes.
    #[test]
    fn as_a_map() {
        let (mut rows, mut map) = (Sparse::default(), BTreeMap::new());
        let mut list = alloc::vec![(99, 0)];
        let mut random = 1u32;
        for step in 0..5000u32 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let key = (random >> 28) as usize;
            match random >> 16 & 255 {
                0..90 => {
                    rows.remove(key);
                    map.remove(&key);
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
                    let kept = *map.entry(key).or_insert(step);
                    assert_eq!(*rows.get_or_insert(key, || (key, step)), (key, kept));
                }
            }
            assert_eq!(rows.get(key).map(|row| row.1), map.get(&key).copied());
            assert!(rows.in_order().copied().eq(map.iter().map(|(key, value)| (*key, *value))));
            assert_eq!(rows.rows().len(), map.len());
        }
    }
}
