//! Cores at their places, in a tree for queries.
//!
//! A node holds the boxes of its two halves, so that a search reads one line of the cache for both; leaves stand in the order of the
//! tree, with their corners. Searches of large worlds wait for memory more than they compute. Boxes are in a coarse unit and too large by
//! up to two units: an outline that a search finds may not meet the path, but no outline that meets it is left out.
//!
//! A search tests boxes in 64 bits, sees by the sides of its line that most leaves are beside it, and computes in 128 bits and more only for
//! the outlines that it may hit. The tree of static colliders is made when the first query asks, kept beside the tree of the steps, and shared
//! by copies of a world; changes since then stand in a second tree. It is keyed by a digest of each collider and its pose, since two
//! shapes may have one box.

use alloc::vec::Vec;

use super::Path;
use super::path::Walk;
use super::tree::{NONE, Tree};
use crate::collider::Filter;
use crate::query::{Core, Point};

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;

/// Room for halves that wait in a search: one for each halving of 2^32 leaves.
const WAITING: usize = 40;

/// log2 of the least unit of boxes in ulps: with 2^22, a path of 2^52 ulps has 2^30 units.
const LEAST_UNIT: u32 = 22;

/// A node of two halves: their boxes, the filters in them, and where they are.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Node {
    /// In units from the tree's corner: from 0 to 2^30 + 1.
    low: [[i32; 2]; 2],
    high: [[i32; 2]; 2],
    category: [u32; 2],
    mask: [u32; 2],
    /// The number of a node, or of a leaf with [`LEAF`].
    child: [u32; 2],
}

impl Node {
    /// No half: boxes that nothing meets.
    const EMPTY: Self =
        Self { low: [[i32::MAX; 2]; 2], high: [[i32::MIN; 2]; 2], category: [0; 2], mask: [0; 2], child: [NONE; 2] };
}

/// Two lines of the cache, which are read at once.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
struct Leaf {
    /// The corners in ulps, if they are no more than [`FEW`].
    few: [Point; FEW],
    /// ulps
    radius: i64,
    number: u32,
    filter: Filter,
    /// The number of corners: 0 for an outline that has no place here. More than [`FEW`] stand among the corners of the tree, from
    /// `start` on.
    count: u32,
    start: u32,
    is_link: bool,
}

/// Most shapes are boxes.
const FEW: usize = 4;

/// An outline that a search found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedCore<'a> {
    /// The number of the outline.
    pub(crate) number: u32,
    /// True for a segment of a chain.
    pub(crate) is_link: bool,
    /// ulps
    pub(crate) radius: i64,
    /// The corners in ulps; none if the tree does not know them.
    pub(crate) corners: &'a [Point],
}

/// A core with its corners relative to a position in ulps.
#[derive(Debug)]
pub(crate) struct CoreAt {
    pub(crate) core: Core,
    pub(crate) position: Point,
    pub(crate) is_link: bool,
}

/// Outlines at their places, in a tree.
#[derive(Debug, Default)]
pub(crate) struct CoreTree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// The corners of leaves with many.
    corners: Vec<Point>,
    /// The lower left corner of all boxes, ulps.
    pub(super) base: Point,
    /// log2 of the unit in ulps.
    pub(super) unit: u32,
}

impl CoreTree {
    /// The tree of cores with the halves of another tree; `leaf` gives the number, the filter and the core of each item.
    pub(super) fn new(tree: &Tree, mut leaf: impl FnMut(u32) -> (u32, Filter, Option<CoreAt>)) -> Self {
        let Some((root, _)) = tree.node(0) else { return Self::default() };
        let sides = [0, 1].map(|k| root.bounds.max[k].wrapping_sub(root.bounds.min[k]) as u64);
        let bits = u64::BITS - sides[0].max(sides[1]).leading_zeros();
        let mut cores =
            Self { base: root.bounds.min, unit: bits.saturating_sub(30).max(LEAST_UNIT), ..Self::default() };
        cores.nodes.push(Node::EMPTY);
        // The nodes of the given tree, and where in the new one they go; left halves first, so that leaves follow in their order.
        let mut waiting = match tree.halves(0) {
            Some([left, right]) => Vec::from([(right, 0, 1), (left, 0, 0)]),
            None => Vec::from([(0, 0, 0)]),
        };
        while let Some((at, node, side)) = waiting.pop() {
            let Some((extent, item)) = tree.node(at) else { continue };
            let units = |corner: Point, k: usize| corner[k].wrapping_sub(cores.base[k]) as u64 >> cores.unit;
            let [low, high] =
                [extent.bounds.min, extent.bounds.max].map(|corner| [0, 1].map(|k| units(corner, k) as i32));
            let child = match tree.halves(at) {
                Some([left, right]) => {
                    let child = cores.nodes.len();
                    cores.nodes.push(Node::EMPTY);
                    waiting.extend([(right, child, 1), (left, child, 0)]);
                    child as u32
                }
                None => {
                    let (number, filter, place) = leaf(item);
                    cores.push(number, filter, place) | LEAF
                }
            };
            let node = &mut cores.nodes[node];
            (node.low[side], node.high[side], node.child[side]) = (low, high.map(|part| part + 1), child);
            [node.category[side], node.mask[side]] = extent.filter_bits();
        }
        cores
    }

    /// Adds a leaf. Returns its number.
    fn push(&mut self, number: u32, filter: Filter, place: Option<CoreAt>) -> u32 {
        let mut leaf = Leaf {
            few: [[0; 2]; FEW],
            radius: 0,
            number,
            filter,
            count: 0,
            start: self.corners.len() as u32,
            is_link: false,
        };
        if let Some(CoreAt { core, position: [x, y], is_link }) = place {
            (leaf.radius, leaf.is_link, leaf.count) = (core.radius, is_link, core.corners().len() as u32);
            let corners = core.corners().iter().map(|corner| [corner[0] + x, corner[1] + y]);
            match leaf.few.get_mut(..leaf.count as usize) {
                Some(few) => few.iter_mut().zip(corners).for_each(|(place, corner)| *place = corner),
                None => self.corners.extend(corners),
            }
        }
        self.leaves.push(leaf);
        self.leaves.len() as u32 - 1
    }

    /// Calls `visit` with each outline whose box may meet a path and whose filter agrees with a filter, if there is one: the outlines at
    /// the start of the path first, but for some. `visit` may shorten the path, and ends the search with false. Returns false if it did.
    #[inline]
    pub(crate) fn search<'a>(
        &'a self,
        path: &mut Path,
        filter: Option<Filter>,
        mut visit: impl FnMut(PlacedCore<'a>, &mut Path) -> bool,
    ) -> bool {
        if self.nodes.is_empty() {
            return true;
        }
        let bits = filter.map(super::tree::filter_bits);
        let mut walk = Walk::new(path, self.base, self.unit);
        let (mut waiting, mut count) = ([0_u32; WAITING], 0);
        let mut at = 0;
        loop {
            let node = &self.nodes[at as usize];
            let mut child = match [0, 1].map(|side| node.is_met(side, &walk, bits)) {
                [false, false] => NONE,
                [true, false] => node.child[0],
                [false, true] => node.child[1],
                [true, true] => {
                    let far_side = u32::from(walk.is_before([node.low[0], node.high[0]], [node.low[1], node.high[1]]));
                    waiting[count] = at << 1 | far_side;
                    count += 1;
                    node.child[(1 - far_side) as usize]
                }
            };
            loop {
                if child & LEAF == 0 {
                    at = child;
                    break;
                }
                if child != NONE {
                    let leaf = &self.leaves[(child & !LEAF) as usize];
                    if filter.is_none_or(|filter| filter.agrees(leaf.filter)) {
                        if !visit(self.placed(leaf), path) {
                            return false;
                        }
                        walk.follow(path);
                    }
                }
                if count == 0 {
                    return true;
                }
                count -= 1;
                let (node, side) = (&self.nodes[(waiting[count] >> 1) as usize], (waiting[count] & 1) as usize);
                // The path may be shorter by now.
                child = if node.is_met(side, &walk, bits) { node.child[side] } else { NONE };
            }
        }
    }

    #[inline(always)]
    fn placed<'a>(&'a self, leaf: &'a Leaf) -> PlacedCore<'a> {
        let (start, count) = (leaf.start as usize, leaf.count as usize);
        let corners = leaf.few.get(..count).unwrap_or_else(|| &self.corners[start..start + count]);
        PlacedCore { number: leaf.number, is_link: leaf.is_link, radius: leaf.radius, corners }
    }
}

impl Node {
    #[inline(always)]
    fn is_met(&self, side: usize, walk: &Walk, bits: Option<[u32; 2]>) -> bool {
        let may_agree =
            |[category, mask]: [u32; 2]| (self.category[side] & mask != 0) & (category & self.mask[side] != 0);
        bits.is_none_or(may_agree) && walk.meets(self.low[side], self.high[side])
    }
}
