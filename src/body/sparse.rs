//! Rows for the few bodies that have something for a while: in no order, each found by its key.

use alloc::vec::Vec;
use core::mem;

use super::columns::NONE;

/// A row that a body may have.
pub(crate) trait Row {
    /// The body of the row: its slot, or its index in the columns.
    fn key(&self) -> usize;
}

/// A sparse set of rows. The time to add, find or remove a row does not depend on how many there are.
#[derive(Debug)]
pub(crate) struct Sparse<T> {
    rows: Vec<T>,
    /// The index of the row of each key, or [`NONE`]; long enough for the keys that have had a row.
    at: Vec<u32>,
}

clone_by_field!([T: Clone] Sparse<T> { rows, at });

impl<T> Default for Sparse<T> {
    fn default() -> Self {
        Self { rows: Vec::new(), at: Vec::new() }
    }
}

impl<T: Row> Sparse<T> {
    pub(crate) fn rows(&self) -> &[T] {
        &self.rows
    }

    /// The rows. *Domain* their keys are not changed.
    pub(crate) fn rows_mut(&mut self) -> &mut [T] {
        &mut self.rows
    }

    /// The rows in the order of the keys.
    pub(crate) fn in_order(&self) -> impl Iterator<Item = &T> {
        let taken = if self.rows.is_empty() { &[] } else { &self.at[..] };
        taken.iter().filter_map(|&index| self.rows.get(index as usize))
    }

    /// The row of a key, if it has one.
    pub(crate) fn get(&self, key: usize) -> Option<&T> {
        let index = *self.at.get(key)?;
        self.rows.get(index as usize)
    }

    /// The row of a key. If it has none, `make` makes it.
    #[inline]
    pub(crate) fn get_or_insert(&mut self, key: usize, make: impl FnOnce() -> T) -> &mut T {
        let index = match self.at.get(key) {
            Some(&index) if index != NONE => index as usize,
            _ => self.insert(key, make()),
        };
        &mut self.rows[index]
    }

    /// Adds the row of a key that has none, and returns its index.
    fn insert(&mut self, key: usize, row: T) -> usize {
        debug_assert_eq!(row.key(), key);
        if self.at.len() <= key {
            self.at.resize(key + 1, NONE);
        }
        let index = self.rows.len();
        self.at[key] = index as u32;
        self.rows.push(row);
        index
    }

    /// Removes the row of a key, if it has one.
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

    /// Removes the rows for which `is_kept` is false.
    pub(crate) fn retain(&mut self, is_kept: impl Fn(&T) -> bool) {
        // Backwards: the row that moves into a gap has been looked at already.
        for index in (0..self.rows.len()).rev() {
            if !is_kept(&self.rows[index]) {
                self.remove_at(index);
            }
        }
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        for row in self.rows.drain(..) {
            self.at[row.key()] = NONE;
        }
    }

    /// Moves all rows to a list, whose former contents are dropped.
    pub(crate) fn move_to(&mut self, list: &mut Vec<T>) {
        list.clear();
        for row in &self.rows {
            self.at[row.key()] = NONE;
        }
        mem::swap(&mut self.rows, list);
    }
}

/// A pair of a key and its value.
impl<T> Row for (usize, T) {
    fn key(&self) -> usize {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use alloc::collections::BTreeMap;

    use super::*;

    /// Compares the set with a map over some thousand changes.
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
