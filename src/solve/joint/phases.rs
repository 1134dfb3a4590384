//! Joints in phases of their own, before the phases of contacts.
//!
//! Reads: joints, [`BodyRows`]. Writes: gains of bodies; in the end impulses of joints, totals and paths of bodies.

use alloc::vec::Vec;
use core::ops::Range;

use super::{Block, Joint, JointPass};
use crate::kernel::simd::Lanes;
use crate::solve::apply::{Path, Total};
use crate::solve::bodies::BodyRows;
use crate::solve::graph::{Graph, PHASES};
use crate::solve::groups::Shares;
use crate::solve::limbs::shifted_within;
use crate::solve::motion::{DISPLACEMENT, Rows};
use crate::solve::number::clamped;
use crate::solve::{Flight, Impulses, StepInput};

/// All joints of the solver.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Joints {
    pub(in crate::solve) blocks: Vec<Block>,
    /// The part of `blocks` of each phase.
    phases: [Range<usize>; PHASES],
    shares: Shares,
    /// True for islands that a fixed body holds.
    held: Vec<bool>,
}

impl Joints {
    #[cfg(test)]
    pub(in crate::solve) fn capacity(&self) -> usize {
        let Self { blocks, shares, held, .. } = self;
        let touched: usize = shares.touched.iter().map(Vec::capacity).sum();
        blocks.capacity() + shares.counts.capacity() + touched + held.capacity()
    }

    /// Prepares the joints, phase by phase.
    pub(in crate::solve) fn set(&mut self, input: &StepInput<'_>, graph: &Graph, bodies: &mut BodyRows) {
        let Self { blocks, phases, shares, .. } = self;
        let StepInput { flights, joints, .. } = *input;
        blocks.clear();
        if joints.is_empty() {
            return;
        }
        shares.clear(flights.len());
        for joint in joints {
            shares.count(&bodies.row_of, graph.phase(joint.bodies), joint.bodies);
        }
        for (phase, range) in phases.iter_mut().enumerate() {
            let begin = blocks.len();
            for (index, joint) in joints.iter().enumerate() {
                if graph.phase(joint.bodies) != phase {
                    continue;
                }
                let Some(mover) = graph.mover(joint.bodies) else { continue };
                let unit = bodies.bodies[mover as usize].unit;
                let rows = joint.bodies.map(|body| bodies.row(input, body, unit));
                let ends = joint.bodies.map(|body| &bodies.bodies[body as usize]);
                let shares = joint.bodies.map(|body| shares.counts[body as usize][phase].into());
                blocks.extend(Block::new(index, input, ends, rows, shares, unit));
            }
            *range = begin..blocks.len();
        }
        // An error that is cut off now is so after the first move, and counted there.
        blocks.iter_mut().for_each(|block| {
            block.turn(&bodies.rows);
        });
    }

    /// Settles where bodies with joints end the step, and tells the joints, which hold the points of bodies where they really are.
    pub(in crate::solve) fn set_paths(
        &mut self,
        input: &StepInput<'_>,
        graph: &Graph,
        bodies: &BodyRows,
        paths: &mut Vec<Path>,
    ) {
        let Self { blocks, held, .. } = self;
        let StepInput { clock, flights, joints, contacts, .. } = *input;
        paths.clear();
        if joints.is_empty() {
            return;
        }
        held.clear();
        held.resize(graph.islands(), false);
        let pressed = contacts.iter().filter(|contact| contact.impulses.values != [0; 3]);
        for ends in joints.iter().map(|joint| joint.bodies).chain(pressed.map(|contact| contact.bodies)) {
            let mover = graph.mover(ends).and_then(|body| graph.island_of(body));
            if let (Some(island), true) = (mover, ends.iter().any(|&body| flights[body as usize].is_fixed())) {
                held[island as usize] = true;
            }
        }
        paths.resize(flights.len(), Path::Contacts);
        for body in joints.iter().flat_map(|joint| joint.bodies) {
            let island = graph.island_of(body);
            let is_held = island.is_some_and(|island| held[island as usize]);
            paths[body as usize] = if is_held { Path::Substeps } else { Path::Flight };
        }
        for block in blocks {
            let ends = joints[block.joint as usize].bodies;
            let Some(mover) = graph.mover(ends) else { continue };
            let unit = bodies.bodies[mover as usize].unit;
            for (side, body) in block.sides.iter_mut().zip(ends) {
                let flight = &flights[body as usize];
                if paths[body as usize] == Path::Flight {
                    let [x, y, turn] = flight.offsets(clock);
                    let shift = |offset, unit| clamped(clock.length_of_bits(offset, unit), DISPLACEMENT.into());
                    side.shift = [shift(x, unit), shift(y, unit), shift(turn, unit - flight.length())];
                }
            }
        }
    }

    #[inline(always)]
    fn pass<L: Lanes>(&mut self, pass: JointPass, rows: &mut Rows, lanes: L) -> u64 {
        if self.blocks.is_empty() {
            return 0;
        }
        let mut cut = 0;
        for phase in 0..PHASES {
            let blocks = &mut self.blocks[self.phases[phase].clone()];
            if blocks.is_empty() {
                continue;
            }
            cut += blocks.iter_mut().map(|block| block.run(pass, rows)).sum::<u64>();
            cut += rows.apply_gains(lanes, &self.shares.touched[phase]);
        }
        cut
    }

    /// The passes of a sub-step before the contacts are solved.
    #[inline(always)]
    pub(in crate::solve) fn solve<L: Lanes>(&mut self, rows: &mut Rows, lanes: L) -> u64 {
        self.pass(JointPass::WarmStart, rows, lanes) + self.pass(JointPass::Solve, rows, lanes)
    }

    /// The pass after the move of a sub-step, before the contacts are relaxed.
    #[inline(always)]
    pub(in crate::solve) fn relax<L: Lanes>(&mut self, rows: &mut Rows, lanes: L) -> u64 {
        let cut = self.blocks.iter_mut().map(|block| block.advance(rows)).sum::<u64>();
        cut + self.pass(JointPass::Relax, rows, lanes)
    }

    /// Writes the impulses of joints, and adds the impulses of this step to the totals of bodies.
    pub(in crate::solve) fn apply(&self, flights: &[Flight], joints: &mut [Joint], totals: &mut [Total]) {
        for joint in joints.iter_mut() {
            joint.impulses = Impulses::default();
        }
        for block in &self.blocks {
            let joint = &mut joints[block.joint as usize];
            let [first, second] = block.impulses;
            joint.impulses = Impulses { values: [first, second, 0], exponent: block.exponent };
            // From 2^(exponent − 30) to 2^-64 N·s.
            let bits = -64 + 30 - block.exponent;
            for (is_weighted, [x, y, turn_a, turn_b]) in [(false, block.applied), (true, block.weighted)] {
                let [x, y] = [x, y].map(|value| shifted_within(value, bits));
                for (sign, (body, turn)) in [-1, 1].into_iter().zip(joint.bodies.into_iter().zip([turn_a, turn_b])) {
                    let turn = shifted_within(turn, bits - flights[body as usize].length());
                    totals[body as usize].add(is_weighted, [x, y, turn].map(|value| sign * value));
                }
            }
        }
    }
}
