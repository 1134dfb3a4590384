//! Trees in impacts: the impulses of joints that impulses of contacts bring about.
//!
//! An impact takes no time: joints keep the velocities of the rows that they hold, and springs, motors and friction have none to act in. So a
//! tree is solved for the changes of velocities alone, without a bias. Rows with laws are free, but for limits that stop them.

use core::ops::Range;

use super::factor::factor_changed;
use super::node::Node;
use super::{FRACTION, RESIDUAL, Trees, eliminate, is_second_half, joint_impulses, opposite_end, set_aims};
use crate::kernel::simd::GAIN_BITS;
use crate::solve::joint::Block;
use crate::solve::joint::axis::AxisRow;
use crate::solve::joint::impact::{JointImpact, STOP_ROUNDS, StopSpeeds, add_gain};
use crate::solve::number::{lowered, within};

/// The largest velocity of a node in an answer to a trial: 2^59 as a change.
const FASTEST: i64 = 1 << 37;

impl Node {
    /// Sets the residual of the joint to the parent for changes of the velocities of its ends, with these velocities of rows before.
    fn begin_impact(&mut self, ends: [[i64; 3]; 2], velocities: [i64; 3], block: &Block, laws: &mut [AxisRow]) {
        let bits = 30 + GAIN_BITS - FRACTION + i32::from(self.is_half);
        for row in (0..3).filter(|&row| block.is_active[row]) {
            let change = block.velocity_after(row, ends, velocities);
            match laws.get_mut(block.laws[row] as usize) {
                Some(law) => law.begin_impact(change, block.impulses[row]),
                None => {
                    let residual = within(lowered(change, bits), RESIDUAL);
                    self.residual[row] = if self.side == 0 { -residual } else { residual };
                }
            }
        }
    }

    /// The change of its velocity in an answer to changes, as these are.
    fn answer(&self) -> [i64; 3] {
        let [x, y] = self.velocity;
        [x, y, self.spin].map(|part| part.clamp(-FASTEST, FASTEST) << (GAIN_BITS - FRACTION))
    }
}

/// The nodes at both ends of the joint of a node to its parent.
fn ends(nodes: &[Node], begin: usize, index: usize) -> [usize; 2] {
    let opposite = opposite_end(nodes, begin, index);
    if nodes[index].side == 0 { [index, opposite] } else { [opposite, index] }
}

fn add_gains(changes: &mut [[i64; 3]], ends: [usize; 2], gains: [[i64; 3]; 2]) {
    for (end, gain) in ends.into_iter().zip(gains) {
        add_gain(&mut changes[end], gain);
    }
}

impl Trees {
    /// The number of trees.
    pub(in crate::solve::joint) fn len(&self) -> usize {
        self.trees.len()
    }

    /// The rows of the nodes of a tree.
    pub(in crate::solve::joint) fn rows(&self, tree: usize) -> impl Iterator<Item = u32> + '_ {
        self.nodes[self.trees[tree].nodes.clone()].iter().map(|node| node.row)
    }

    /// The blocks of a tree.
    pub(in crate::solve::joint) fn blocks(&self, tree: usize) -> Range<usize> {
        self.trees[tree].blocks.clone()
    }

    /// Solves a tree for the changes of the velocities of its nodes, in coarse units throughout; with the biases of impacts, if there are any.
    fn solve_impact(
        &mut self,
        tree: usize,
        changes: &[[i64; 3]],
        blocks: &[Block],
        laws: &mut [AxisRow],
        impacts: Option<&[JointImpact]>,
    ) {
        let Self { nodes, frames, trees } = self;
        let tree = &trees[tree];
        let begin = tree.nodes.start;
        let nodes = &mut nodes[tree.nodes.clone()];
        for index in 0..nodes.len() - 1 {
            let changes = ends(nodes, begin, index).map(|end| changes[end]);
            let node = &mut nodes[index];
            let block = node.block as usize;
            let velocities = impacts.map_or([0; 3], |impacts| impacts[block].bias);
            node.begin_impact(changes, velocities, &blocks[block], laws);
        }
        if tree.has_laws && set_aims(nodes, frames, blocks, laws) {
            factor_changed(nodes, frames, begin, blocks);
        }
        eliminate(nodes, frames, begin);
    }

    /// Stops rows of a tree as [`Joints::stop_rows`](crate::solve::joint::Joints::stop_rows) has it.
    pub(in crate::solve::joint) fn stop_rows(
        &mut self,
        tree: usize,
        changes: &[[i64; 3]],
        speeds: &StopSpeeds,
        blocks: &[Block],
        laws: &mut [AxisRow],
        impacts: &[JointImpact],
    ) -> bool {
        for round in 0..STOP_ROUNDS {
            self.solve_impact(tree, changes, blocks, laws, None);
            let Self { nodes, frames, trees } = self;
            let tree = &trees[tree];
            let nodes = &nodes[tree.nodes.clone()];
            let mut are_new = false;
            for index in 0..nodes.len() - 1 {
                let Some(impulses) = joint_impulses(nodes, frames, index) else { continue };
                let ends = ends(nodes, tree.nodes.start, index).map(|end| {
                    let mut change = changes[end];
                    add_gain(&mut change, nodes[end].answer());
                    change
                });
                let block = nodes[index].block as usize;
                let velocities = impacts[block].coarse_velocities(speeds.coarse);
                are_new |= blocks[block].revise_stops(ends, velocities, impulses, speeds, laws);
            }
            if !are_new {
                return round > 0;
            }
        }
        true
    }

    /// Adds the impulses of joints by which a tree answers changes of the velocities of its nodes to the impacts of joints, and the changes by them
    /// to these.
    pub(in crate::solve::joint) fn answer_impact(
        &mut self,
        tree: usize,
        changes: &mut [[i64; 3]],
        coarse: i32,
        blocks: &[Block],
        laws: &mut [AxisRow],
        impacts: &mut [JointImpact],
    ) {
        self.solve_impact(tree, changes, blocks, laws, Some(&*impacts));
        let Self { nodes, frames, trees } = self;
        let tree = &trees[tree];
        let begin = tree.nodes.start;
        let nodes = &nodes[tree.nodes.clone()];
        for index in 0..nodes.len() - 1 {
            let Some(impulses) = joint_impulses(nodes, frames, index) else { continue };
            let block = nodes[index].block as usize;
            // Below 2^61 · 2^12.
            let impulses = impulses.map(|impulse| i128::from(impulse) << coarse);
            let gains = impacts[block].add(impulses, &blocks[block], coarse);
            add_gains(changes, ends(nodes, begin, index), gains);
        }
    }

    /// The largest velocity of a row that a joint holds by changes of the velocities of the nodes of a tree.
    pub(in crate::solve::joint) fn largest_residual(
        &self,
        tree: usize,
        changes: &[[i64; 3]],
        blocks: &[Block],
        laws: &[AxisRow],
    ) -> i64 {
        let tree = &self.trees[tree];
        let nodes = &self.nodes[tree.nodes.clone()];
        let mut largest = 0;
        for index in (0..nodes.len() - 1).filter(|&index| !is_second_half(nodes, index)) {
            let ends = ends(nodes, tree.nodes.start, index).map(|end| changes[end]);
            largest = largest.max(blocks[nodes[index].block as usize].largest_residual(ends, laws));
        }
        largest
    }

    /// Adds the changes of the velocities of the nodes of a tree by the impacts of its joints.
    pub(in crate::solve::joint) fn add_impacts(&self, tree: usize, changes: &mut [[i64; 3]], impacts: &[JointImpact]) {
        let tree = &self.trees[tree];
        let begin = tree.nodes.start;
        let nodes = &self.nodes[tree.nodes.clone()];
        for index in (0..nodes.len() - 1).filter(|&index| !is_second_half(nodes, index)) {
            add_gains(changes, ends(nodes, begin, index), impacts[nodes[index].block as usize].gains);
        }
    }

    /// Adds the answer of a tree to changes of the velocities of its nodes to these, without a trace.
    pub(in crate::solve::joint) fn add_answer(
        &mut self,
        tree: usize,
        changes: &mut [[i64; 3]],
        blocks: &[Block],
        laws: &mut [AxisRow],
    ) {
        self.solve_impact(tree, changes, blocks, laws, None);
        for (node, change) in self.nodes[self.trees[tree].nodes.clone()].iter().zip(changes) {
            add_gain(change, node.answer());
        }
    }
}
