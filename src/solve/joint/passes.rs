//! Joints through a step, before the contacts.
//!
//! Reads: joints, contacts, [`BodyRows`]. Writes: gains of bodies; in the end impulses of joints, totals and paths of bodies.

use alloc::vec::Vec;

use super::axis::AxisRow;
use super::forest::Forest;
use super::gains::{Gains, Sums};
use super::gradients::{Loops, PassStart};
use super::impact::JointImpact;
use super::loads::Loads;
use super::paths::find_paths;
use super::tree::Trees;
use super::turn::Pose;
use super::{Block, Joint};
use crate::kernel::simd::Lanes;
use crate::slots::NONE;
use crate::solve::apply::{Path, Total};
use crate::solve::bodies::{BodyRows, STILL};
use crate::solve::graph::Graph;
use crate::solve::limbs::shifted_within;
use crate::solve::motion::{DISPLACEMENT, Rows};
use crate::solve::number::clamped;
use crate::solve::unit::SoftRow;
use crate::solve::{Flight, Impulses, StepInput};

/// All joints of the solver.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Joints {
    forest: Forest,
    pub(in crate::solve) blocks: Vec<Block>,
    /// The rows of the bodies of blocks.
    poses: Vec<Pose>,
    /// The pose by row, [`NONE`] for rows without.
    pose_of: Vec<u32>,
    /// The number of sub-steps, and of moves of the bodies so far.
    substeps: i32,
    moves: i32,
    /// The laws of the rows of blocks, in their order; and true if one has a spring.
    pub(super) laws: Vec<AxisRow>,
    have_springs: bool,
    pub(super) trees: Trees,
    /// By block: its impulses in the impacts of a round; empty until a step needs them.
    pub(super) impacts: Vec<JointImpact>,
    pub(super) loops: Loops,
    /// The softness of loops.
    pub(super) soft: SoftRow,
    /// The number of joints by body.
    counts: Vec<u32>,
    /// The rows of bodies that joints can move.
    touched: Vec<u32>,
    pub(super) gains: Gains,
    /// True for islands that a fixed body holds.
    held: Vec<bool>,
    loads: Loads,
}

impl Joints {
    #[cfg(test)]
    pub(in crate::solve) fn capacity(&self) -> usize {
        let Self { forest, blocks, laws, trees, loops, counts, touched, gains, held, .. } = self;
        let parts = [forest.capacity(), blocks.capacity(), laws.capacity(), trees.capacity(), loops.capacity()];
        parts.iter().sum::<usize>() + counts.capacity() + touched.capacity() + gains.capacity() + held.capacity()
    }

    /// Prepares the joints.
    pub(in crate::solve) fn set(&mut self, input: &StepInput<'_>, graph: &Graph, bodies: &mut BodyRows) {
        let Self { forest, blocks, poses, pose_of, laws, trees, loops, soft, counts, touched, gains, loads, .. } = self;
        let StepInput { clock, softness, flights, joints, .. } = *input;
        (self.substeps, self.moves) = (clock.substeps as i32, 0);
        forest.update(flights, joints);
        blocks.clear();
        self.impacts.clear();
        poses.clear();
        pose_of.clear();
        laws.clear();
        touched.clear();
        if joints.is_empty() {
            trees.clear();
            loops.clear();
            return;
        }
        *soft = softness.joint;
        gains.clear();
        counts.clear();
        counts.resize(flights.len(), 0);
        for body in joints.iter().flat_map(|joint| joint.bodies) {
            let count = &mut counts[body as usize];
            let row = bodies.row_of[body as usize];
            *count += 1;
            if *count == 1 && row != STILL {
                touched.push(row);
            }
        }
        for &index in &forest.order {
            let joint = &joints[index as usize];
            let Some(mover) = graph.mover(joint.bodies) else { continue };
            let unit = bodies.bodies[mover as usize].unit;
            let rows = joint.bodies.map(|body| bodies.row(input, body, unit));
            let ends = joint.bodies.map(|body| &bodies.bodies[body as usize]);
            let numbers = [0, 1].map(|side| {
                let (row, body) = (rows[side], joint.bodies[side]);
                pose_of.resize(bodies.rows.len() as usize, NONE);
                let number = &mut pose_of[row as usize];
                // Bodies at rest share a row, and each has an angle of a unit of its own.
                if *number == NONE || row == STILL {
                    *number = poses.len() as u32;
                    poses.push(Pose::new(*number, row, body, &flights[body as usize], unit, clock));
                }
                *number as usize
            });
            let shares = joint.bodies.map(|body| counts[body as usize].into());
            let poses = numbers.map(|number| &poses[number]);
            let is_in_loop = forest.loops.first().is_some_and(|range| blocks.len() >= range.start);
            let mut block = Block::new(index as usize, input, ends, poses, shares, unit, is_in_loop, laws);
            if block.is_pulley() {
                block.rope = gains.add_rope();
            }
            blocks.push(block);
        }
        self.have_springs = laws.iter().any(AxisRow::has_spring);
        // An error that is cut off now is so after the first move, and counted there.
        for pose in poses.iter_mut() {
            pose.advance(&bodies.rows, 0, self.substeps);
        }
        blocks.iter_mut().for_each(|block| {
            block.turn(poses, laws);
        });
        gains.set_rows(bodies.rows.len());
        loads.find(flights, joints, input.contacts, forest, graph);
        trees.set(input, forest, blocks, laws, bodies, |body| loads.is_heavy(graph.island_of(body)));
        loops.set(forest, blocks, &bodies.rows);
    }

    /// Settles where bodies with joints end the step, and tells the joints, which hold the points of bodies where they really are.
    pub(in crate::solve) fn set_paths(&mut self, input: &StepInput<'_>, graph: &Graph, paths: &mut Vec<Path>) {
        let Self { blocks, poses, held, .. } = self;
        let StepInput { clock, flights, joints, contacts, .. } = *input;
        find_paths(flights, joints, contacts, graph, held, paths);
        for pose in poses.iter_mut().filter(|pose| paths[pose.body as usize] == Path::Flight) {
            let flight = &flights[pose.body as usize];
            let [x, y, turn] = flight.offsets(clock);
            let shift = |offset, unit| clamped(clock.length_of_bits(offset, unit), DISPLACEMENT.into());
            pose.shift = [shift(x, pose.unit), shift(y, pose.unit), shift(turn, pose.unit - flight.length())];
        }
        for block in blocks {
            for side in &mut block.sides {
                side.shift = poses[side.pose as usize].shift;
                block.is_shifted |= side.shift != [0; 3];
            }
        }
    }

    /// Begins a sub-step, before bodies take up the changes of their free flight: takes note of velocities, and finds matrices where they are
    /// not known.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(in crate::solve) fn begin(&mut self, rows: &Rows, is_first: bool) {
        if self.have_springs {
            for block in &self.blocks {
                block.set_start(rows, &mut self.laws, is_first);
            }
        }
        self.trees.begin(&self.blocks, is_first);
        if is_first {
            self.loops.factor(&self.blocks, &self.soft);
        }
    }

    /// Begins the solve pass of a sub-step with the impulses of the one before. Returns the number of values that were cut off.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(in crate::solve) fn warm_start<L: Lanes>(&mut self, rows: &mut Rows, lanes: L) -> u64 {
        if self.blocks.is_empty() {
            return 0;
        }
        self.gains.begin_ropes();
        let tree_count = self.tree_count();
        let (blocks_of_trees, blocks_of_loops) = self.blocks.split_at_mut(tree_count);
        for block in blocks_of_trees {
            block.warm_start(&mut self.gains);
        }
        self.loops.warm_start(lanes, blocks_of_loops, &mut self.gains);
        self.gains.apply(rows, &self.touched, lanes)
    }

    /// The pass before the contacts are solved. Returns the number of values that were cut off.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(in crate::solve) fn solve<L: Lanes>(&mut self, rows: &mut Rows, lanes: L) -> u64 {
        if self.blocks.is_empty() { 0 } else { self.pass(rows, lanes, true) }
    }

    /// The pass after the move of a sub-step, before the contacts are relaxed.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(in crate::solve) fn relax<L: Lanes>(&mut self, rows: &mut Rows, lanes: L) -> u64 {
        if self.blocks.is_empty() {
            return 0;
        }
        self.moves += 1;
        for pose in &mut self.poses {
            pose.advance(rows, self.moves, self.substeps);
        }
        let mut cut = 0;
        // Loops do it where they are solved, once their blocks are at hand.
        let tree_count = self.tree_count();
        for block in &mut self.blocks[..tree_count] {
            cut += block.advance(&self.poses, &mut self.laws);
        }
        self.gains.weigh_ropes();
        self.trees.relax(&self.blocks);
        cut + self.pass(rows, lanes, false)
    }

    /// Solves trees and loops.
    #[inline(always)]
    fn pass<L: Lanes>(&mut self, rows: &mut Rows, lanes: L, is_biased: bool) -> u64 {
        let Self { blocks, poses, laws, trees, loops, soft, touched, gains, .. } = self;
        if is_biased {
            for pose in poses.iter_mut() {
                pose.set_sweep(rows);
            }
        }
        let cut = trees.solve(blocks, poses, laws, rows, gains, is_biased);
        let start = PassStart { poses, rows, soft, is_biased };
        let cut = cut + loops.solve(lanes, blocks, laws, gains, &start);
        cut + gains.apply(rows, touched, lanes)
    }

    /// Ends the sub-steps: all impulses are with the blocks then.
    pub(in crate::solve) fn finish(&mut self) {
        let tree_count = self.tree_count();
        self.loops.store(&mut self.blocks[tree_count..]);
    }

    /// The number of blocks of trees: they come before the blocks of loops.
    pub(super) fn tree_count(&self) -> usize {
        self.blocks.len() - self.loops.joint_count()
    }

    /// The number of each joint and its impulses over the step on the second body: along x and y, in 2^-32 N·s, and around, in 2^-32 N·m·s.
    pub(in crate::solve) fn totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_ {
        self.blocks.iter().map(|block| {
            let [x, y] = self.gains.rope_totals(block).map_or_else(|| block.applied.linear, |[applied, _]| applied);
            // From 2^(exponent − 30), and from 2^exponent of the length of the row.
            let [x, y] = [x, y].map(|value| shifted_within(value, -32 + 30 - block.exponent));
            let around = shifted_within(block.around.into(), -32 - block.exponent - block.axis_length);
            (block.joint, [x, y, around])
        })
    }

    /// Writes the impulses of joints, and adds the impulses of this step to the totals of bodies.
    pub(in crate::solve) fn apply(&self, flights: &[Flight], joints: &mut [Joint], totals: &mut [Total]) {
        for joint in joints.iter_mut() {
            joint.impulses = Impulses::default();
        }
        for block in &self.blocks {
            let joint = &mut joints[block.joint as usize];
            joint.impulses = Impulses { values: block.values(), exponent: block.exponent };
            // From 2^(exponent − 30) to 2^-64 N·s.
            let bits = -64 + 30 - block.exponent;
            let ends = joint.bodies.map(|body| body as usize);
            let seconds = self.gains.rope_totals(block).map_or([None; 2], |totals| totals.map(Some));
            let sums = [&block.applied, &block.weighted];
            for (is_weighted, (Sums { linear, turns }, second)) in
                [false, true].into_iter().zip(sums.into_iter().zip(seconds))
            {
                let [x, y] = linear.map(|value| shifted_within(value, bits));
                let [second_x, second_y] =
                    second.map_or([x, y], |linear| linear.map(|value| shifted_within(value, bits)));
                let [turn_a, turn_b] =
                    [0, 1].map(|side| shifted_within(turns[side], bits - flights[ends[side]].length()));
                totals[ends[0]].add(is_weighted, [-x, -y, -turn_a]);
                totals[ends[1]].add(is_weighted, [second_x, second_y, turn_b]);
            }
        }
    }
}
