//! Loops in impacts: the impulses of joints that impulses of contacts bring about, as [trees](super::super::tree) have them, but by conjugate
//! gradients. Each answer leaves the error of the iterations and of the softness of loops, and the next one goes on from there.

use core::ops::Range;

use super::{FRACTION, Loop, LoopJoint, Loops, RESIDUAL, iterate};
use crate::kernel::simd::GAIN_BITS;
use crate::solve::joint::Block;
use crate::solve::joint::axis::AxisRow;
use crate::solve::joint::impact::{JointImpact, STOP_ROUNDS, StopSpeeds, add_gain};
use crate::solve::number::{lowered, within};
use crate::solve::unit::SoftRow;

/// Iterations of an answer.
const ITERATIONS: usize = 8;

impl LoopJoint {
    /// The changes of the velocities of both ends.
    fn ends(&self, first_body: usize, changes: &[[i64; 3]]) -> [[i64; 3]; 2] {
        self.bodies.map(|body| changes.get((body as usize).wrapping_sub(first_body)).copied().unwrap_or_default())
    }

    /// Sets the residual for changes of the velocities of both ends, with these velocities of rows before. Rows with laws are free, but for limits that stop them.
    fn begin_impact(
        &mut self,
        ends: [[i64; 3]; 2],
        velocities: [i64; 3],
        block: &Block,
        laws: &[AxisRow],
        soft: &SoftRow,
    ) {
        (self.residual, self.given, self.solution) = ([0; 3], [0; 3], [0; 3]);
        for row in 0..3 {
            let law = laws.get(block.laws[row] as usize);
            if law.is_some() {
                (self.mass[row], self.compliance[row]) = (0, 0);
            }
            let is_held = law.is_some_and(AxisRow::is_held);
            if is_held {
                let mass = block.element(0, row, row) + block.element(1, row, row);
                self.compliance[row] = lowered(mass * i128::from(soft.compliance), 30) as i64;
                self.mass[row] = mass as i64 + self.compliance[row];
            }
            if is_held || law.is_none() && row < 2 && block.held[row] {
                let residual = lowered(block.velocity_after(row, ends, velocities), 30 + GAIN_BITS - FRACTION);
                self.residual[row] = -within(residual, RESIDUAL);
            }
        }
        self.precondition::<3>(block);
        self.direction = self.preconditioned;
    }
}

impl Loops {
    /// The number of loops.
    pub(in crate::solve::joint) fn len(&self) -> usize {
        self.loops.len()
    }

    /// The rows of the bodies of a loop.
    pub(in crate::solve::joint) fn rows(&self, index: usize) -> impl Iterator<Item = u32> + '_ {
        self.rows[self.loops[index].bodies.clone()].iter().copied()
    }

    /// The number of joints of all loops.
    pub(in crate::solve::joint) fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// The joints of a loop among all joints of loops.
    pub(in crate::solve::joint) fn joints(&self, index: usize) -> Range<usize> {
        self.loops[index].joints.clone()
    }

    /// Finds the impulses by which the joints of a loop answer changes of the velocities of its bodies. `blocks` are the blocks of the loop.
    fn solve_impact(
        &mut self,
        index: usize,
        changes: &[[i64; 3]],
        blocks: &[Block],
        laws: &[AxisRow],
        soft: &SoftRow,
        impacts: Option<&[JointImpact]>,
    ) {
        let Self { joints, moved, loops, .. } = self;
        let Loop { joints: range, pins, bodies, .. } = &loops[index];
        let joints = &mut joints[range.clone()];
        for (number, (joint, block)) in joints.iter_mut().zip(blocks).enumerate() {
            if !pins.is_empty() {
                // Passes have groups in its place.
                joint.invert(block, soft.compliance);
            }
            let ends = joint.ends(bodies.start, changes);
            let velocities = impacts.map_or([0; 3], |impacts| impacts[number].bias);
            joint.begin_impact(ends, velocities, block, laws, soft);
        }
        let step = iterate::<3>(joints, blocks, moved, bodies.clone(), ITERATIONS);
        joints.iter_mut().for_each(|joint| joint.advance::<3>(step));
    }

    /// Stops rows of a loop as [`Joints::stop_rows`](crate::solve::joint::Joints::stop_rows) has it.
    pub(in crate::solve::joint) fn stop_rows(
        &mut self,
        index: usize,
        changes: &[[i64; 3]],
        speeds: &StopSpeeds,
        blocks: &[Block],
        laws: &mut [AxisRow],
        soft: &SoftRow,
        impacts: &[JointImpact],
    ) -> bool {
        for round in 0..STOP_ROUNDS {
            self.solve_impact(index, changes, blocks, laws, soft, None);
            let Loop { joints, bodies, .. } = &self.loops[index];
            let joints = &self.joints[joints.clone()];
            let moved = &mut self.moved[bodies.clone()];
            moved.copy_from_slice(changes);
            for (joint, block) in joints.iter().zip(blocks) {
                let gains = JointImpact::default().add(joint.changes().map(i128::from), block, 0);
                joint.add_gains(bodies.start, moved, gains);
            }
            let mut are_new = false;
            for ((joint, block), impact) in joints.iter().zip(blocks).zip(impacts) {
                let ends = joint.ends(bodies.start, moved);
                let velocities = impact.coarse_velocities(speeds.coarse);
                are_new |= block.revise_stops(ends, velocities, joint.changes(), speeds, laws);
            }
            if !are_new {
                return round > 0;
            }
        }
        true
    }

    /// Adds the impulses by which the joints of a loop answer changes of the velocities of its bodies, and the changes by them to these.
    pub(in crate::solve::joint) fn answer_impact(
        &mut self,
        index: usize,
        changes: &mut [[i64; 3]],
        coarse: i32,
        blocks: &[Block],
        laws: &[AxisRow],
        soft: &SoftRow,
        impacts: &mut [JointImpact],
    ) {
        self.solve_impact(index, changes, blocks, laws, soft, Some(&*impacts));
        let Loop { joints, bodies, .. } = &self.loops[index];
        for ((joint, block), impact) in self.joints[joints.clone()].iter().zip(blocks).zip(impacts) {
            let impulses = joint.changes().map(|impulse| i128::from(impulse) << coarse);
            let gains = impact.add(impulses, block, coarse);
            joint.add_gains(bodies.start, changes, gains);
        }
    }

    /// Adds the changes of the velocities of the bodies of a loop by the impacts of its joints.
    pub(in crate::solve::joint) fn add_impacts(&self, index: usize, changes: &mut [[i64; 3]], impacts: &[JointImpact]) {
        let Loop { joints, bodies, .. } = &self.loops[index];
        for (joint, impact) in self.joints[joints.clone()].iter().zip(impacts) {
            joint.add_gains(bodies.start, changes, impact.gains);
        }
    }

    /// Adds the answer of a loop to changes of the velocities of its bodies to these, without a trace.
    pub(in crate::solve::joint) fn add_answer(
        &mut self,
        index: usize,
        changes: &mut [[i64; 3]],
        blocks: &[Block],
        laws: &[AxisRow],
        soft: &SoftRow,
    ) {
        self.solve_impact(index, changes, blocks, laws, soft, None);
        let Loop { joints, bodies, .. } = &self.loops[index];
        for (joint, block) in self.joints[joints.clone()].iter().zip(blocks) {
            let gains = JointImpact::default().add(joint.changes().map(i128::from), block, 0);
            joint.add_gains(bodies.start, changes, gains);
        }
    }

    /// The largest velocity of a row that a joint holds by changes of the velocities of the bodies of a loop.
    pub(in crate::solve::joint) fn largest_residual(
        &self,
        index: usize,
        changes: &[[i64; 3]],
        blocks: &[Block],
        laws: &[AxisRow],
    ) -> i64 {
        let Loop { joints, bodies, .. } = &self.loops[index];
        let residuals = self.joints[joints.clone()].iter().zip(blocks).map(|(joint, block)| {
            let ends = joint.ends(bodies.start, changes);
            block.largest_residual(ends, laws)
        });
        residuals.max().unwrap_or_default()
    }
}

impl LoopJoint {
    /// Adds changes of velocity to both ends.
    fn add_gains(&self, first_body: usize, changes: &mut [[i64; 3]], gains: [[i64; 3]; 2]) {
        for (body, gain) in self.bodies.into_iter().zip(gains) {
            if let Some(change) = changes.get_mut((body as usize).wrapping_sub(first_body)) {
                add_gain(change, gain);
            }
        }
    }
}
