//! Broad phase: the pairs of colliders that may touch.
//!
//! **Pairs are defined, not found.** Two colliders of two bodies are a pair if their boxes, swept over the free flight and grown by the
//! margin, have a point in common, their filters agree and one of them moves. Each outline is a collider of its own here, as the parts of a
//! compound are. Boxes are exact, and the pairs come sorted: they are a function of boxes and filters alone. Everything else here is a
//! cache: no snapshot holds it, and its age changes no result.
//!
//! Each moving collider has a *fat* box, larger than its own by a margin, which it keeps until it leaves it. Pairs of fat boxes that
//! overlap are *candidates*; they change when a collider leaves its fat box, and only then a tree is searched. A step in which none does
//! costs one comparison for each moving collider and one for each candidate. Static colliders are in a tree of their own, colliders of
//! sleeping bodies in another one. Copies of a world share both, and a step does not look at colliders that stand far away.
//!
//! **Rejected overlaps are bounded.** A search looks at each collider whose box overlaps, unless neither of the two has a category in the
//! mask of the other: then it skips whole parts of a tree. Overlaps that it looks at and rejects are counted: colliders of one body or of
//! one negative group, and masks that hold one way alone. Like the pairs they follow from the boxes and filters alone. Beyond a limit
//! they count as pairs do. A part of a tree is skipped only where no collider in it has such a category, so that each part that a search
//! enters holds one that counts. Each collider keeps how many its last search rejected: the sum is never below the number of rejected
//! overlaps, depends on history, and only decides when these are counted exactly.

mod bounds;
mod cached;
mod cap;
mod core_tree;
mod entry;
mod path;
mod search;
mod statics;
#[cfg(test)]
mod tests;
mod tree;

use alloc::sync::Arc;
use alloc::vec::Vec;

pub use cap::PairLimits;
pub(crate) use core_tree::{CoreAt, CoreTree, PlacedCore};
pub use path::Path;
pub(crate) use statics::Boxes;
pub use statics::Statics;

use crate::collider::Filter;
use crate::fx::Fx;
use crate::shape::Aabb;

use bounds::Bounds;
use entry::Entry;
use search::Room;
use tree::{NONE, Tree};

/// A collider as the broad phase sees it: a box with a filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proxy {
    /// The number of the collider, below 2^32 - 1. Memory grows with the largest one.
    pub collider: u32,
    /// The number of its body: colliders of one body are no pair. All colliders of a static body are static.
    pub body: u32,
    /// The box that holds the collider during the step, and the margin around it. *Domain* `min` is not above `max`.
    pub bounds: Aabb<Fx>,
    /// The filter, which says which colliders it may meet.
    pub filter: Filter,
    /// A hash of its outline and its place: a static collider whose digest changes has changed. A moving collider needs none.
    pub digest: u64,
}

/// The colliders at rest in a step.
#[derive(Clone, Copy, Debug)]
pub struct RestingTrees<'a> {
    /// The colliders of static bodies.
    pub statics: &'a Arc<Statics>,
    /// The colliders of sleeping bodies, which are treated alike.
    pub sleepers: Option<&'a Statics>,
    /// A number that changes whenever the sleeping ones do.
    pub version: u64,
}

impl<'a> RestingTrees<'a> {
    /// The colliders of static bodies alone.
    #[must_use]
    pub fn of(statics: &'a Arc<Statics>) -> Self {
        Self { statics, sleepers: None, version: 0 }
    }

    fn trees(&self) -> impl Iterator<Item = &'a Statics> + use<'a> {
        [&**self.statics].into_iter().chain(self.sleepers)
    }
}

/// The broad phase of a world, with its memory between steps. A new one and one of any history give the same pairs.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    statics: Arc<Statics>,
    /// The version of the sleeping colliders.
    version: u64,
    /// The fat boxes.
    tree: Tree,
    /// The memory of each moving collider, by number.
    entries: Vec<Entry>,
    /// The boxes of moving colliders, and of others among the candidates, by number.
    boxes: Vec<Bounds>,
    /// The colliders that moved in the last step.
    movers: Vec<u32>,
    /// The colliders that left their fat boxes, or are new.
    stale: Vec<u32>,
    /// The colliders that moved before this step, and do so no more.
    gone: Vec<u32>,
    /// Pairs whose fat boxes overlap, and whose filters agree: the lower number in the upper half.
    candidates: Vec<u64>,
    /// Workspace: new candidates.
    new_candidates: Vec<u64>,
    /// The number of changes of boxes since the tree was built.
    changes: usize,
    step: u32,
    pairs: Vec<[u32; 2]>,
    above_cap: Vec<u32>,
    /// Workspace: the number of pairs of each collider.
    degrees: Vec<u32>,
    /// Workspace: the number of pairs that need a cap of 0, 1 and so on.
    needs: Vec<usize>,
    /// True if the candidates are all there are.
    is_complete: bool,
    /// The number of overlaps that the last searches of the moving colliders rejected: at least the number of overlaps of fat boxes that
    /// are no candidates.
    rejected: usize,
}

/// A pair as a number, sorted like the pair.
fn key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

fn pair(key: u64) -> [u32; 2] {
    [(key >> 32) as u32, key as u32]
}

impl BroadPhase {
    /// Finds the pairs of a step. `movers` are the colliders that move, in any order, each once and none of them among the colliders
    /// at rest.
    ///
    /// With more than `limits.pairs` pairs, or more than `limits.overlaps` overlaps, [`above_cap`](Self::above_cap) names the colliders
    /// that have too many.
    ///
    /// Time and memory are bounded by the numbers of colliders and of pairs and overlaps, or by the limits if they are lower.
    pub fn update(&mut self, resting: &RestingTrees<'_>, movers: &[Proxy], limits: &PairLimits) {
        let are_new = !Arc::ptr_eq(&self.statics, resting.statics) || self.version != resting.version;
        if are_new {
            self.statics = Arc::clone(resting.statics);
            self.version = resting.version;
        }
        self.stale.clear();
        self.gone.clear();
        self.reserve(resting, movers);
        self.place(movers);
        // With more candidates than this, the pairs are searched without margins.
        let candidates = limits.pairs.saturating_mul(2).saturating_add(movers.len());
        let room = Room { candidates, rejected: limits.overlaps };
        if are_new || !self.is_complete || self.stale.len() > movers.len() / 8 {
            self.search_all(resting, room);
        } else {
            self.search_stale(resting, room);
        }
        self.above_cap.clear();
        let is_small = self.is_complete && self.is_within(limits);
        if !is_small && !self.search_exactly(resting, limits) {
            return self.cap(resting, limits);
        }
        self.sift();
        if self.pairs.len() > limits.pairs {
            self.search_exactly(resting, limits);
            self.cap(resting, limits);
        }
    }

    /// The pairs of the last [`update`](Self::update), each by the lower and the higher number, sorted. No collider of
    /// [`above_cap`](Self::above_cap) is in one.
    #[must_use]
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The pairs, to be gone through while something else changes; [`return_pairs`](Self::return_pairs) gives the list back.
    pub(crate) fn take_pairs(&mut self) -> Vec<[u32; 2]> {
        core::mem::take(&mut self.pairs)
    }

    pub(crate) fn return_pairs(&mut self, pairs: Vec<[u32; 2]>) {
        self.pairs = pairs;
    }

    /// The moving colliders that had too many pairs, sorted; none if all pairs were within the limit.
    #[must_use]
    pub fn above_cap(&self) -> &[u32] {
        &self.above_cap
    }

    /// Makes room for the entries that the lists may come to hold. Fat boxes depend on the steps before, and the lists that follow from
    /// them too: with this room, a step of which a copy has been taken, and that is taken again, takes nothing from the heap.
    fn reserve(&mut self, resting: &RestingTrees<'_>, movers: &[Proxy]) {
        if movers.is_empty() {
            return;
        }
        let end = movers.iter().map(|proxy| proxy.collider as usize + 1).max().unwrap_or(0);
        let end = resting.trees().map(Statics::end).fold(end, usize::max);
        if end > self.entries.len() {
            self.grow(end);
        }
        self.stale.reserve(movers.len());
        self.gone.reserve(self.movers.len());
        // Twice as many candidates as there were.
        let room = (2 * self.candidates.len()).max(64);
        self.candidates.reserve(room - self.candidates.len());
        self.new_candidates.clear();
        self.new_candidates.reserve(self.candidates.capacity());
        self.pairs.clear();
        self.pairs.reserve(self.candidates.capacity());
    }

    /// Takes in the boxes of a step: finds the colliders that are gone, are new, or have left their fat boxes.
    fn place(&mut self, movers: &[Proxy]) {
        self.step = self.step.wrapping_add(1);
        let mut is_same = movers.len() == self.movers.len();
        for proxy in movers {
            let index = proxy.collider as usize;
            let bounds = Bounds::from(proxy.bounds);
            let entry = &mut self.entries[index];
            let current_bounds = &mut self.boxes[index];
            let is_new = entry.leaf == NONE;
            entry.previous_min = if is_new { bounds.min } else { current_bounds.min };
            *current_bounds = bounds;
            entry.last_step = self.step;
            is_same &= !is_new;
            if is_new || entry.differs_from(proxy) || !entry.fits(&bounds) {
                (entry.filter, entry.body) = (proxy.filter, proxy.body);
                entry.is_stale = true;
                self.stale.push(proxy.collider);
            }
        }
        if is_same {
            return;
        }
        for &collider in &self.movers {
            let entry = &mut self.entries[collider as usize];
            if entry.last_step != self.step {
                self.tree.remove(entry.leaf);
                (entry.leaf, entry.is_stale) = (NONE, true);
                self.rejected = self.rejected.saturating_sub(core::mem::take(&mut entry.rejected) as usize);
                self.gone.push(collider);
            }
        }
        self.movers.clear();
        self.movers.extend(movers.iter().map(|proxy| proxy.collider));
    }

    /// Lists the pairs among the candidates.
    fn sift(&mut self) {
        // Each is written, and then counted or not: which of them are pairs follows no pattern, so that a branch would often go wrong.
        self.pairs.resize(self.candidates.len(), [0; 2]);
        let mut count = 0;
        for &key in &self.candidates {
            let [a, b] = pair(key);
            self.pairs[count] = [a, b];
            count += usize::from(self.boxes[a as usize].overlaps(&self.boxes[b as usize]));
        }
        self.pairs.truncate(count);
    }

    /// Makes room for the colliders below a number.
    fn grow(&mut self, len: usize) {
        self.entries.resize(len, Entry::NONE);
        self.boxes.resize(len, Bounds::EMPTY);
    }

    /// Gives new fat boxes to the stale colliders, or to all, and puts them into the tree. Builds the tree again if it has changed much.
    fn refit(&mut self, all: bool) {
        let count = self.movers.len();
        // The tree stays below `sparse` nodes, and then each mover may add one.
        let sparse = 4 * count + 64;
        self.tree.reserve(count, sparse + count);
        let changed = if all { &self.movers } else { &self.stale };
        for &collider in changed {
            let entry = &mut self.entries[collider as usize];
            entry.fatten(&self.boxes[collider as usize]);
            let extent = entry.extent();
            match entry.leaf {
                NONE => entry.leaf = self.tree.push(collider, extent),
                leaf if all => self.tree.set(leaf, extent),
                leaf => self.tree.enlarge(leaf, extent),
            }
        }
        self.changes += changed.len();
        if self.tree.len() > sparse || self.tree.loose() > 16 + count / 32 || self.changes > 8 * count {
            self.build();
        } else if all {
            self.tree.refit();
        }
    }

    /// Builds the tree of fat boxes anew.
    fn build(&mut self) {
        self.changes = 0;
        self.tree.build();
        for (leaf, collider, _) in self.tree.leaves() {
            self.entries[collider as usize].leaf = leaf;
        }
    }

    /// Marks the stale colliders as searched.
    fn settle(&mut self) {
        for &collider in self.stale.iter().chain(&self.gone) {
            self.entries[collider as usize].is_stale = false;
        }
    }
}

#[cfg(test)]
impl BroadPhase {
    /// The room of each list.
    fn capacities(&self) -> [usize; 9] {
        let Self { tree, entries, boxes, movers, stale, gone, candidates, new_candidates, pairs, .. } = self;
        let colliders = [entries.capacity(), boxes.capacity(), movers.capacity(), stale.capacity(), gone.capacity()];
        let [a, b, c, d, e] = colliders;
        [tree.capacity(), a, b, c, d, e, candidates.capacity(), new_candidates.capacity(), pairs.capacity()]
    }
}
