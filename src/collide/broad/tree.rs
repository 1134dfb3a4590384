//! A tree of boxes, as a list: a node, its left half, its right half. Each node says where its part of the list ends, so that a search
//! walks the list from its start to its end, without a stack, and skips the parts whose box it misses.
//!
//! Leaves that were added since the tree was built stand behind it, each a tree of its own.

use alloc::vec::Vec;

use super::bounds::Bounds;
use crate::collider::Filter;

/// Marks the absence of an item, a leaf or a parent.
pub(super) const NONE: u32 = u32::MAX;

/// The number of parts that wait while a tree is built: one for each halving of 2^32 leaves, and one.
const MAX_PARTS: usize = 33;

/// The category and the mask by which trees know a filter: colliders of a positive group may meet whatever their masks say.
pub(super) fn filter_bits(filter: Filter) -> [u32; 2] {
    if filter.group > 0 { [!0; 2] } else { [filter.category, filter.mask] }
}

/// A box with the categories and masks of all that is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) bounds: Bounds,
    category: u32,
    mask: u32,
}

impl Extent {
    /// A box that meets nothing, and adds nothing to a union.
    const NOTHING: Self = Self { bounds: Bounds::EMPTY, category: 0, mask: 0 };

    pub(super) fn new(bounds: Bounds, filter: Filter) -> Self {
        let [category, mask] = filter_bits(filter);
        Self { bounds, category, mask }
    }

    /// The categories and masks.
    pub(super) fn filter_bits(&self) -> [u32; 2] {
        [self.category, self.mask]
    }

    /// Returns false if no collider in one can have a pair with one in the other.
    pub(super) fn meets(&self, extent: &Self) -> bool {
        self.bounds.overlaps(&extent.bounds) & (self.category & extent.mask != 0) & (extent.category & self.mask != 0)
    }

    /// Returns false if the boxes are apart, or no collider in one has a category in the mask of one in the other.
    ///
    /// Unlike [`meets`](Self::meets), where this is true for the filters of a part of a tree, it is true for one of the colliders in it.
    pub(super) fn touches(&self, extent: &Self) -> bool {
        self.bounds.overlaps(&extent.bounds) & (((self.category & extent.mask) | (extent.category & self.mask)) != 0)
    }

    fn contains(&self, extent: &Self) -> bool {
        self.bounds.contains(&extent.bounds) & (extent.category & !self.category == 0) & (extent.mask & !self.mask == 0)
    }

    fn union(&self, extent: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&extent.bounds),
            category: self.category | extent.category,
            mask: self.mask | extent.mask,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    extent: Extent,
    /// The node behind this one's part of the list.
    skip: u32,
    /// The item of a leaf; [`NONE`] for a node with two halves, and for a leaf that was removed.
    item: u32,
}

/// A leaf while the tree is built.
#[derive(Clone, Copy, Debug)]
struct Place {
    centre: [i64; 2],
    leaf: u32,
}

/// A part of the tree that is to be built: these places, from this node on.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    end: usize,
    node: usize,
}

#[derive(Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// The node above each node, [`NONE`] for the first and for leaves behind the tree.
    parents: Vec<u32>,
    /// Nodes of the tree as it was built.
    built: usize,
    /// Workspace: leaves that are put in order.
    leaves: Vec<Node>,
    places: Vec<Place>,
    parts: Vec<Part>,
}

impl Clone for Tree {
    fn clone(&self) -> Self {
        Self { nodes: self.nodes.clone(), parents: self.parents.clone(), built: self.built, ..Self::default() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.nodes.clone_from(&source.nodes);
        self.parents.clone_from(&source.parents);
        self.built = source.built;
    }
}

impl Tree {
    pub(super) fn clear(&mut self) {
        self.nodes.clear();
        self.parents.clear();
        self.built = 0;
    }

    /// Frees the lists that only [`Tree::build`] needs.
    pub(super) fn drop_workspace(&mut self) {
        (self.leaves, self.places, self.parts) = (Vec::new(), Vec::new(), Vec::new());
    }

    /// The room of all lists.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        let Self { nodes, parents, leaves, places, parts, .. } = self;
        nodes.capacity() + parents.capacity() + leaves.capacity() + places.capacity() + parts.capacity()
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Number of leaves behind the tree, removed ones among them.
    pub(super) fn loose(&self) -> usize {
        self.nodes.len() - self.built
    }

    /// Makes room for a tree of this many leaves with as many nodes, so that when it is built takes nothing from the heap.
    pub(super) fn reserve(&mut self, leaves: usize, nodes: usize) {
        if self.places.capacity() >= leaves {
            return;
        }
        self.nodes.reserve(nodes.saturating_sub(self.nodes.len()));
        self.parents.reserve(nodes.saturating_sub(self.parents.len()));
        // The workspace holds nothing between two builds that is needed.
        self.leaves.clear();
        self.places.clear();
        self.leaves.reserve(leaves);
        self.places.reserve(leaves);
        self.parts.reserve(MAX_PARTS);
    }

    /// Adds a leaf behind the tree. Returns where it is.
    pub(super) fn push(&mut self, item: u32, extent: Extent) -> u32 {
        let leaf = self.nodes.len() as u32;
        self.nodes.push(Node { extent, skip: leaf + 1, item });
        self.parents.push(NONE);
        leaf
    }

    /// Takes a leaf out; its room is free from the next [`Tree::build`] on.
    pub(super) fn remove(&mut self, leaf: u32) {
        let node = &mut self.nodes[leaf as usize];
        (node.extent, node.item) = (Extent::NOTHING, NONE);
    }

    /// Changes the box of a leaf, for which [`Tree::refit`] is due.
    pub(super) fn set(&mut self, leaf: u32, extent: Extent) {
        self.nodes[leaf as usize].extent = extent;
    }

    /// Changes the box of a leaf and enlarges the boxes above it.
    pub(super) fn enlarge(&mut self, leaf: u32, extent: Extent) {
        self.set(leaf, extent);
        let mut at = self.parents[leaf as usize];
        while let Some(node) = self.nodes.get_mut(at as usize).filter(|node| !node.extent.contains(&extent)) {
            node.extent = node.extent.union(&extent);
            at = self.parents[at as usize];
        }
    }

    /// Gives all nodes of the tree the least boxes around their leaves.
    pub(super) fn refit(&mut self) {
        for i in (0..self.built).rev() {
            // A part of more than one node has a left half.
            if self.nodes[i].skip as usize > i + 1 {
                let left = &self.nodes[i + 1];
                self.nodes[i].extent = left.extent.union(&self.nodes[left.skip as usize].extent);
            }
        }
    }

    /// Builds the tree of all leaves anew.
    pub(super) fn build(&mut self) {
        self.leaves.clear();
        self.leaves.extend(self.nodes.iter().filter(|node| node.item != NONE));
        let place = |(leaf, node): (usize, &Node)| Place {
            centre: [0, 1].map(|axis| node.extent.bounds.centre(axis)),
            leaf: leaf as u32,
        };
        self.places.clear();
        self.places.extend(self.leaves.iter().enumerate().map(place));
        self.clear();
        let count = self.leaves.len();
        if count == 0 {
            return;
        }
        self.built = 2 * count - 1;
        self.nodes.resize(self.built, Node { extent: Extent::NOTHING, skip: 0, item: NONE });
        self.parents.resize(self.built, NONE);
        self.parts.push(Part { start: 0, end: count, node: 0 });
        while let Some(part) = self.parts.pop() {
            self.build_part(part);
        }
        self.refit();
    }

    /// Builds the node of a part, and leaves its halves to be done. Halves are equal within one leaf: at most [`MAX_PARTS`] wait.
    fn build_part(&mut self, Part { start, end, node }: Part) {
        let places = &mut self.places[start..end];
        // A tree of m leaves has 2m - 1 nodes.
        let skip = (node + 2 * places.len() - 1) as u32;
        if let [place] = places {
            self.nodes[node] = Node { skip, ..self.leaves[place.leaf as usize] };
            return;
        }
        self.nodes[node].skip = skip;
        let middle = halve(places);
        let (left, right) = (node + 1, node + 2 * middle);
        for half in [left, right] {
            self.parents[half] = node as u32;
        }
        self.parts.push(Part { start: start + middle, end, node: right });
        self.parts.push(Part { start, end: start + middle, node: left });
    }

    /// Calls `visit` with the item of each leaf, from a node on, for which `is_met` is true, until it returns false. Parts of the tree for
    /// which `is_met` is false are skipped.
    #[inline(always)]
    pub(super) fn search(&self, from: usize, is_met: impl Fn(&Extent) -> bool, mut visit: impl FnMut(u32) -> bool) {
        let mut at = from;
        while let Some(node) = self.nodes.get(at) {
            if !is_met(&node.extent) {
                at = node.skip as usize;
                continue;
            }
            if node.item != NONE && !visit(node.item) {
                return;
            }
            at += 1;
        }
    }

    /// The box and the item of a node.
    pub(super) fn node(&self, at: usize) -> Option<(&Extent, u32)> {
        self.nodes.get(at).map(|node| (&node.extent, node.item))
    }

    /// The two halves below a node of the tree as it was built; `None` for a leaf.
    pub(super) fn halves(&self, at: usize) -> Option<[usize; 2]> {
        let is_inner = self.nodes[at].skip as usize > at + 1;
        is_inner.then(|| [at + 1, self.nodes[at + 1].skip as usize])
    }

    /// The leaves, each with its place, its item and its box.
    pub(super) fn leaves(&self) -> impl Iterator<Item = (u32, u32, &Extent)> {
        let leaves = self.nodes.iter().enumerate().filter(|(_, node)| node.item != NONE);
        leaves.map(|(at, node)| (at as u32, node.item, &node.extent))
    }
}

/// Parts two places or more by the middle one along the axis on which they spread more. Returns the number of places in the first half.
fn halve(places: &mut [Place]) -> usize {
    let middle = places.len() / 2;
    let spread = |axis: usize| {
        let range =
            |(low, high): (i64, i64), place: &Place| (low.min(place.centre[axis]), high.max(place.centre[axis]));
        let (low, high) = places.iter().fold((i64::MAX, i64::MIN), range);
        // Below 2^64, as there is a place.
        high.wrapping_sub(low) as u64
    };
    let axis = usize::from(spread(1) > spread(0));
    if places.len() > 2 {
        places.select_nth_unstable_by_key(middle, |place| place.centre[axis]);
    }
    middle
}
