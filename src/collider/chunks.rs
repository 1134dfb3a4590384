//! A list in chunks, which copies share until one of them changes.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::Index;

use crate::slots::push;

/// The number of values in a chunk.
const CHUNK: usize = 64;

/// A list of which a change after a copy copies a chunk, and not all of it.
#[derive(Clone, Debug)]
pub(super) struct Chunks<T> {
    /// All but the last one are full.
    chunks: Vec<Arc<Vec<T>>>,
    len: usize,
}

impl<T> Default for Chunks<T> {
    fn default() -> Self {
        Self { chunks: Vec::new(), len: 0 }
    }
}

impl<T: Clone> Chunks<T> {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn get(&self, i: usize) -> Option<&T> {
        self.chunks.get(i / CHUNK)?.get(i % CHUNK)
    }

    pub(super) fn get_mut(&mut self, i: usize) -> Option<&mut T> {
        Arc::make_mut(self.chunks.get_mut(i / CHUNK)?).get_mut(i % CHUNK)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.chunks.iter().flat_map(|chunk| chunk.iter())
    }

    pub(super) fn push(&mut self, value: T) {
        if self.len % CHUNK == 0 {
            self.chunks.push(Arc::default());
        }
        if let Some(last) = self.chunks.last_mut() {
            push(Arc::make_mut(last), value);
            self.len += 1;
        }
    }

    /// Takes a value out, and puts the last one into its place. *Domain* it is there.
    pub(super) fn swap_remove(&mut self, i: usize) -> Option<T> {
        let last = Arc::make_mut(self.chunks.last_mut()?).pop()?;
        self.len -= 1;
        if self.len % CHUNK == 0 {
            self.chunks.pop();
        }
        Some(match self.get_mut(i) {
            Some(place) => core::mem::replace(place, last),
            None => last,
        })
    }
}

impl<T> Index<usize> for Chunks<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, i: usize) -> &T {
        &self.chunks[i / CHUNK][i % CHUNK]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::run_seed;
    use crate::math::Random;

    /// A list in chunks behaves as one that is not, and shares what no copy changes.
    #[test]
    fn chunks_are_a_list_of_which_copies_share_what_they_do_not_change() {
        let mut random = Random::seeded(run_seed(3));
        let (mut list, mut chunks) = (Vec::new(), Chunks::default());
        for step in 0..20_000_u64 {
            let copy = chunks.clone();
            let at = random.below(list.len() as u64 + 1) as usize;
            if random.below(5) < if step % 4_000 < 2_000 { 3 } else { 1 } {
                list.push(step);
                chunks.push(step);
            } else if at < list.len() && step % 2 == 0 {
                assert_eq!(Some(list.swap_remove(at)), chunks.swap_remove(at));
            } else if let Some(place) = chunks.get_mut(at) {
                (*place, list[at]) = (step, step);
            }
            let copies =
                chunks.chunks.iter().zip(&copy.chunks).filter(|(chunk, copied)| !Arc::ptr_eq(chunk, copied)).count();
            assert!(copies <= 2, "{copies} chunks were copied");
            assert_eq!((chunks.len(), chunks.get(at)), (list.len(), list.get(at)));
            if step % 500 == 0 {
                assert!(chunks.iter().eq(&list));
            }
        }
        assert!(chunks.chunks.len() > 3);
    }
}
