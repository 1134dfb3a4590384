//! The matrices of a tree, from the leaves to the centre: of all nodes, or of the nodes whose laws have other aims.
//!
//! Reads: blocks. Writes: the matrices of nodes.

use super::frame::FrameRows;
use super::node::Node;
use crate::slots::NONE;
use crate::solve::joint::Block;

/// Finds the matrices of nodes, of which the first one has the number `begin`.
#[inline(always)]
pub(super) fn factor(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize, blocks: &[Block]) {
    for node in nodes.iter_mut() {
        node.begin(blocks);
    }
    let mut index = 0;
    while index < nodes.len() {
        index += factor_next(nodes, frames, begin, index);
    }
}

/// Finds the matrices anew that change where the aims of laws have.
#[inline(never)]
pub(super) fn factor_changed(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize, blocks: &[Block]) {
    for index in 0..nodes.len() {
        if nodes[index].has_changed {
            nodes[index].begin(blocks);
            if nodes[index].parent != NONE {
                nodes[nodes[index].parent as usize - begin].has_changed = true;
            }
        }
    }
    for index in 0..nodes.len() {
        if nodes[index].has_changed {
            nodes[index].factor(frames);
        }
        if nodes[index].parent != NONE && nodes[nodes[index].parent as usize - begin].has_changed {
            join(nodes, frames, begin, index);
        }
    }
    nodes.iter_mut().for_each(|node| node.has_changed = false);
}

/// Finds the matrices of a node, or of two. Returns their number.
#[inline(always)]
fn factor_next(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize, index: usize) -> usize {
    // Nodes that are as far from the centre stand side by side.
    let waits = nodes[index].parent as usize == begin + index + 1;
    match &mut nodes[index..] {
        [first, second, ..] if first.holds_point && second.holds_point && !waits => {
            Node::factor_pins(first, second);
            first.factor_others(frames);
            second.factor_others(frames);
            join(nodes, frames, begin, index);
            join(nodes, frames, begin, index + 1);
            2
        }
        [node, ..] => {
            node.factor(frames);
            join(nodes, frames, begin, index);
            1
        }
        [] => 1,
    }
}

/// Adds the spring of a node to its parent.
#[inline(always)]
fn join(nodes: &mut [Node], frames: &[FrameRows], begin: usize, index: usize) {
    let (before, after) = nodes.split_at_mut(index + 1);
    let node = &before[index];
    if node.parent != NONE {
        node.join(frames, &mut after[node.parent as usize - begin - index - 1]);
    }
}
