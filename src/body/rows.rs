//! Rows that bodies share: bodies that are alike have one row, and each body its number.

use alloc::vec::Vec;

use crate::slots::{NONE, push};

/// A row that is found by its key.
pub(super) trait Keyed {
    type Key: PartialEq;

    fn key(&self) -> Self::Key;

    /// A hash of a key; its upper bits are the best ones.
    fn hash(key: &Self::Key) -> u64;
}

/// Puts a word into a hash: by the golden ratio, 2^64/φ, as in Knuth's multiplicative hashing.
pub(super) fn mix(hash: u64, word: u64) -> u64 {
    (hash.rotate_left(29) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// The most places that a search looks at. An attacker who chooses keys with equal hashes gets a row for each body, but no long
/// search. At most half of the places are taken: the places of other keys are hardly ever that far apart.
const PROBES: usize = 64;

/// The rows in use, and how many bodies have each. The number of a row is no state: it changes no bit of a result.
#[derive(Debug)]
pub(super) struct SharedRows<R> {
    rows: Vec<R>,
    users: Vec<u32>,
    /// Rows without a body, to be used again.
    free: Vec<u32>,
    /// A hash table of the rows with linear probing: a row, or [`NONE`]. A row that was given back and used again is in it
    /// once for each time, and found at one of its places.
    places: Vec<u32>,
    /// Number of places that are not [`NONE`]: at most half.
    taken: usize,
}

impl<R> Default for SharedRows<R> {
    fn default() -> Self {
        Self { rows: Vec::new(), users: Vec::new(), free: Vec::new(), places: Vec::new(), taken: 0 }
    }
}

clone_by_field!([R: Clone] SharedRows<R> { rows, users, free, places, taken });

impl<R: Keyed> SharedRows<R> {
    /// All rows, those without a body as well.
    #[inline]
    pub(super) fn all(&self) -> &[R] {
        &self.rows
    }

    #[inline]
    pub(super) fn row_mut(&mut self, row: u32) -> &mut R {
        &mut self.rows[row as usize]
    }

    /// The rows that a body has.
    pub(super) fn used(&self) -> impl Iterator<Item = &R> {
        self.rows.iter().zip(&self.users).filter(|(_, users)| **users > 0).map(|(row, _)| row)
    }

    /// The number of a row with this key, for one more body; `make` makes a row that is not there.
    /// [`release`](Self::release) gives it back.
    pub(super) fn acquire(&mut self, key: R::Key, make: impl FnOnce(R::Key) -> R) -> u32 {
        if 2 * self.taken >= self.places.len() {
            self.rehash();
        }
        let place = self.find(&key);
        if let Some(row) = place.map(|place| self.places[place]).filter(|&row| row != NONE) {
            self.users[row as usize] += 1;
            return row;
        }
        let created = make(key);
        let row = if let Some(row) = self.free.pop() {
            (self.rows[row as usize], self.users[row as usize]) = (created, 1);
            row
        } else {
            push(&mut self.rows, created);
            push(&mut self.users, 1);
            (self.rows.len() - 1) as u32
        };
        self.occupy(place, row);
        row
    }

    /// Gives back a row that a body no longer has; says whether it was the last body with it.
    pub(super) fn release(&mut self, row: u32) -> bool {
        let users = &mut self.users[row as usize];
        *users -= 1;
        let is_last = *users == 0;
        if is_last {
            self.free.push(row);
        }
        is_last
    }

    /// The place of a row with this key, or the free place where it would be; `None` if neither is near.
    fn find(&self, key: &R::Key) -> Option<usize> {
        let last = self.places.len() - 1;
        let first = (R::hash(key) >> 32) as usize;
        (first..first + PROBES).map(|place| place & last).find(|&place| {
            let row = self.places[place];
            row == NONE || (self.users[row as usize] > 0 && self.rows[row as usize].key() == *key)
        })
    }

    /// Puts a row into its place. A row without one is not shared.
    fn occupy(&mut self, place: Option<usize>, row: u32) {
        if let Some(place) = place {
            self.places[place] = row;
            self.taken += 1;
        }
    }

    /// Makes the hash table anew, of the rows that a body has, with at least three quarters of its places free.
    fn rehash(&mut self) {
        let used = self.rows.len() - self.free.len();
        let count = (4 * used).max(4).next_power_of_two().max(self.places.len());
        self.places.clear();
        self.places.resize(count, NONE);
        self.taken = 0;
        for row in 0..self.rows.len() {
            if self.users[row] == 0 {
                continue;
            }
            // Rows with one key are there if one of them had no place before: the first one is shared from now on.
            let place = self.find(&self.rows[row].key()).filter(|&place| self.places[place] == NONE);
            self.occupy(place, row as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::collections::BTreeMap;

    use super::*;

    /// A row that is its key. All keys above 1,000 have one hash.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Number(u64);

    impl Keyed for Number {
        type Key = u64;

        fn key(&self) -> u64 {
            self.0
        }

        fn hash(key: &u64) -> u64 {
            mix(0, (*key).min(1_001))
        }
    }

    #[test]
    fn equal_keys_share_a_row_until_nobody_has_it() {
        let mut table = SharedRows::default();
        let rows = [2, 3, 4].map(|key| [table.acquire(key, Number), table.acquire(key, Number)]);
        assert_eq!(rows, [[0, 0], [1, 1], [2, 2]]);
        assert!(!table.release(1));
        assert_eq!(table.acquire(3, Number), 1);
        assert_eq!([(); 2].map(|()| table.release(1)), [false, true]);
        // The row is used again, and shared by the bodies with the key that is in it now.
        assert_eq!([5, 5, 3].map(|key| table.acquire(key, Number)), [1, 1, 3]);
        assert_eq!((table.all()[1], table.all()[3]), (Number(5), Number(3)));
        assert_eq!([(); 2].map(|()| table.release(1)), [false, true]);
        assert_eq!([5, 5].map(|key| table.acquire(key, Number)), [1, 1]);
    }

    /// Compares the rows with a count by key, while bodies with many keys come and go.
    #[test]
    fn there_is_one_row_for_each_key_in_use() {
        let (mut table, mut counts) = (SharedRows::default(), BTreeMap::<u64, (u32, u32)>::new());
        let mut random = 1u32;
        for step in 0..20_000u32 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Few keys and many, in turns.
            let key = u64::from(random >> 16) % if step & 4_096 == 0 { 500 } else { 5 };
            if random >> 8 & 1 == 0 {
                let row = table.acquire(key, Number);
                let (expected, users) = counts.entry(key).or_insert((row, 0));
                assert_eq!(*expected, row);
                *users += 1;
            } else if let Some((row, users)) = counts.get_mut(&key) {
                *users -= 1;
                let is_last = *users == 0;
                assert_eq!(table.release(*row), is_last);
                if is_last {
                    counts.remove(&key);
                }
            }
            assert_eq!(table.used().count(), counts.len());
        }
        for (key, (row, users)) in counts {
            assert_eq!((table.all()[row as usize], table.users[row as usize]), (Number(key), users));
        }
        assert!(table.rows.len() <= 500 && table.places.len() <= 2_048);
    }

    /// Adds keys with one hash: no search looks at more than [`PROBES`] places, and every body has the row of its key.
    #[test]
    fn keys_with_one_hash_have_rows_of_their_own() {
        let mut table = SharedRows::default();
        let keys = || (0..1_000).map(|i| 1_001 + i % 300);
        let rows: Vec<u32> = keys().map(|key| table.acquire(key, Number)).collect();
        assert!(keys().zip(&rows).all(|(key, &row)| table.all()[row as usize] == Number(key)));
        assert_eq!(table.acquire(1_001, Number), rows[0]);
        assert!(table.taken <= PROBES && table.rows.len() > 300);
        table.release(rows[0]);
        let used = table.used().count();
        assert_eq!(rows.iter().filter(|&&row| table.release(row)).count(), used);
        assert_eq!(table.used().count(), 0);
    }
}
