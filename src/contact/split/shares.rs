//! The islands of a step, shared out between threads. No result depends on it: islands do not see each other.

use alloc::vec::Vec;
#[cfg(feature = "parallel")]
use core::cmp::Reverse;

#[cfg(feature = "parallel")]
use super::bodies_of;
#[cfg(feature = "parallel")]
use crate::solve::{Contact, Graph, Joint};

/// The work for a joint, in contacts.
#[cfg(feature = "parallel")]
const JOINT_WORK: u64 = 16;

/// The work that a thread takes at least, in contacts, so that handing it over is worth it: some tens of microseconds.
#[cfg(feature = "parallel")]
#[derive(Clone, Copy, Debug)]
struct LeastWork(u64);

#[cfg(feature = "parallel")]
impl Default for LeastWork {
    fn default() -> Self {
        Self(256)
    }
}

/// The share of each island, from 0.
#[derive(Debug, Default)]
pub(super) struct Shares {
    share_of: Vec<usize>,
    #[cfg(feature = "parallel")]
    least: LeastWork,
    /// The work by island, the islands in the order of their work, and the work by share.
    #[cfg(feature = "parallel")]
    works: Vec<u64>,
    #[cfg(feature = "parallel")]
    order: Vec<usize>,
    #[cfg(feature = "parallel")]
    sums: Vec<u64>,
}

impl Shares {
    /// The share of an island.
    pub(super) fn of(&self, island: usize) -> usize {
        self.share_of.get(island).copied().unwrap_or(0)
    }

    /// Leaves all islands in one share.
    pub(super) fn clear(&mut self) {
        self.share_of.clear();
    }

    /// Sets the least work of a thread, in contacts.
    #[cfg(all(feature = "parallel", feature = "selftest"))]
    pub(super) fn set_least(&mut self, contacts: usize) {
        self.least = LeastWork(contacts.max(1) as u64);
    }

    /// The number of shares for so many joints and contacts: one for each thread that has enough to do.
    #[cfg(feature = "parallel")]
    pub(super) fn count_for(&self, joints: &[Joint], contacts: &[Contact]) -> usize {
        let work = JOINT_WORK * joints.len() as u64 + contacts.len() as u64;
        // The number of threads is asked for last: it wakes the pool.
        match usize::try_from(work / self.least.0).unwrap_or(usize::MAX) {
            0 | 1 => 1,
            shares => shares.min(rayon::current_num_threads()),
        }
    }

    /// Shares the islands out: the largest first, each to the share with the least work so far. Returns the number of shares with islands.
    #[cfg(feature = "parallel")]
    pub(super) fn share_out(&mut self, count: usize, graph: &Graph, joints: &[Joint], contacts: &[Contact]) -> usize {
        let Self { share_of, works, order, sums, .. } = self;
        works.clear();
        works.resize(graph.islands(), 0);
        for (number, bodies) in bodies_of(joints, contacts).enumerate() {
            if let Some(island) = graph.island_of_link(bodies) {
                works[island as usize] += if number < joints.len() { JOINT_WORK } else { 1 };
            }
        }
        order.clear();
        order.extend(0..works.len());
        order.sort_unstable_by_key(|&island| (Reverse(works[island]), island));
        sums.clear();
        sums.resize(count, 0);
        share_of.resize(works.len(), 0);
        for &island in &*order {
            let share = (0..count).min_by_key(|&share| sums[share]).unwrap_or(0);
            sums[share] += works[island];
            share_of[island] = share;
        }
        sums.iter().filter(|&&sum| sum > 0).count()
    }
}
