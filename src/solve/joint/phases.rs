//! Joints in phases of their own, before the phases of contacts.

use alloc::vec::Vec;
use core::ops::Range;

use super::pass::JointPass;
use super::{Block, Common, Joint};
use crate::kernel::simd::Lanes;
use crate::solve::apply::Path;
use crate::solve::graph::PHASES;
use crate::solve::motion::{DISPLACEMENT, Rows};
use crate::solve::number::clamped;
use crate::solve::prepare::{clear_shares, count_share};
use crate::solve::unit::Clock;
use crate::solve::{Contact, Flight, Solver};

/// All joints of the solver.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Joints {
    pub(in crate::solve) blocks: Vec<Block>,
    /// The part of `blocks` of each phase.
    phases: [Range<usize>; PHASES],
    /// Rows with joints, by phase.
    touched: [Vec<u32>; PHASES],
    /// True for islands that a fixed body holds.
    held: Vec<bool>,
}

impl Joints {
    #[cfg(test)]
    pub(in crate::solve) fn capacity(&self) -> usize {
        self.blocks.capacity() + self.touched.iter().map(Vec::capacity).sum::<usize>() + self.held.capacity()
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
            cut += rows.apply_gains(lanes, &self.touched[phase]);
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
}

impl Solver {
    /// Prepares the joints, phase by phase.
    pub(in crate::solve) fn set_joints(&mut self, joints: &[Joint], common: &Common<'_>) {
        let flights = common.flights;
        self.joints.blocks.clear();
        if joints.is_empty() {
            return;
        }
        clear_shares(&mut self.shares, &mut self.joints.touched, flights.len());
        for bodies in joints.iter().map(|joint| joint.bodies) {
            let phase = self.graph.phase(bodies);
            count_share(&mut self.shares, &mut self.joints.touched, &self.row_of, phase, bodies);
        }
        for phase in 0..PHASES {
            let begin = self.joints.blocks.len();
            for (index, joint) in joints.iter().enumerate() {
                if self.graph.phase(joint.bodies) != phase {
                    continue;
                }
                let Some(mover) = self.graph.mover(joint.bodies) else { continue };
                let unit = self.unit_of[mover as usize];
                let rows = joint.bodies.map(|body| self.row(body, unit, flights, common.softness));
                let bodies = joint.bodies.map(|body| &self.bodies[body as usize]);
                let shares = joint.bodies.map(|body| self.shares[body as usize][phase].into());
                self.joints.blocks.extend(Block::new(index, joint, bodies, rows, shares, unit, common));
            }
            self.joints.phases[phase] = begin..self.joints.blocks.len();
        }
        let rows = &self.rows;
        // An error that is cut off now is so after the first move, and counted there.
        self.joints.blocks.iter_mut().for_each(|block| {
            block.turn(rows);
        });
    }

    /// Settles where bodies with joints end the step, and tells the joints, which hold the points of bodies where they really are.
    pub(in crate::solve) fn set_paths(&mut self, joints: &[Joint], contacts: &[Contact], common: &Common<'_>) {
        let Common { clock, flights, .. } = common;
        self.paths.clear();
        if joints.is_empty() {
            return;
        }
        let held = &mut self.joints.held;
        held.clear();
        held.resize(self.graph.islands(), false);
        let pressed = contacts.iter().filter(|contact| contact.impulses.values != [0; 3]);
        for bodies in joints.iter().map(|joint| joint.bodies).chain(pressed.map(|contact| contact.bodies)) {
            let mover = self.graph.mover(bodies).and_then(|body| self.graph.island_of(body));
            if let (Some(island), true) = (mover, bodies.iter().any(|&body| flights[body as usize].is_fixed())) {
                held[island as usize] = true;
            }
        }
        self.paths.resize(flights.len(), Path::Contacts);
        for body in joints.iter().flat_map(|joint| joint.bodies) {
            let island = self.graph.island_of(body);
            let is_held = island.is_some_and(|island| held[island as usize]);
            self.paths[body as usize] = if is_held { Path::Substeps } else { Path::Flight };
        }
        for block in &mut self.joints.blocks {
            let bodies = joints[block.joint as usize].bodies;
            let Some(mover) = self.graph.mover(bodies) else { continue };
            let unit = self.unit_of[mover as usize];
            for (side, body) in block.sides.iter_mut().zip(bodies) {
                let flight = &flights[body as usize];
                if self.paths[body as usize] == Path::Flight {
                    let [x, y, turn] = flight.offsets(clock);
                    let shift = |offset, unit| clamped(clock.length_of_bits(offset, unit), DISPLACEMENT.into());
                    side.shift = [shift(x, unit), shift(y, unit), shift(turn, unit - flight.length())];
                }
            }
        }
    }

    /// Joints count with the speed that takes their errors away.
    pub(in crate::solve) fn add_joint_speeds(&mut self, clock: &Clock, flights: &[Flight], joints: &[Joint]) {
        for joint in joints {
            let mover = self.graph.mover(joint.bodies);
            if let Some(island) = mover.and_then(|body| self.graph.island_of(body)) {
                let fastest = &mut self.fastest[island as usize];
                *fastest = (*fastest).max(joint.repair_speed(clock, flights));
            }
        }
    }
}
