//! Joints in impacts: they answer the impulses of contacts within the impact.
//!
//! Without an answer a light body that is joined to a heavy one would be stopped alone, with a small part of the impulse, and then be
//! pushed on by the joint and back by the contact in turn: it rebounds, and the joint opens.
//!
//! Changes of velocities are in 2^(coarse − [`GAIN_BITS`](crate::kernel::simd::GAIN_BITS)), as the impacts have them.
//!
//! Reads: trees, loops, blocks. Writes: the impulses of joints by impacts; in the end the sums of blocks.

use alloc::vec::Vec;
use core::ops::Range;

use super::axis::AxisRow;
use super::gains::Sums;
use super::passes::Joints;
use super::{Block, IMPULSE};
use crate::kernel::simd::GAIN_BITS;
use crate::solve::number::{lowered, lowered_word, product, shifted_word, within};

/// The change of the velocity of a body in an assembly by a change of one of its bodies alone, in 2^-30: by axis of the latter.
pub(in crate::solve) type Response = [[i64; 3]; 3];

/// log2 of the velocity by which responses are found, in units.
const TRIAL: i32 = 24;

/// A joint in the impacts of a round.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct JointImpact {
    /// Impulses by row, now and where the iterations began.
    impulses: [i64; 3],
    begun: [i64; 3],
    /// The velocities of rows before the round, in 2^-30.
    velocities: [i64; 3],
    /// The velocities that answers take away with changes: zero but where joints are settled.
    pub(super) bias: [i64; 3],
    /// The changes of velocity of both bodies by these impulses.
    pub(super) gains: [[i64; 3]; 2],
    /// True if impulses or changes were cut off.
    is_cut: bool,
}

impl JointImpact {
    /// Adds impulses. Returns the changes of velocity by them.
    pub(super) fn add(&mut self, impulses: [i128; 3], block: &Block, coarse: i32) -> [[i64; 3]; 2] {
        let sums = [0, 1, 2].map(|row| i128::from(self.impulses[row]) + impulses[row]);
        self.set(sums, block, coarse)
    }

    /// The velocities of rows before the round, in 2^(coarse − 30).
    pub(super) fn coarse_velocities(&self, coarse: i32) -> [i64; 3] {
        self.velocities.map(|velocity| shifted_word(velocity, coarse))
    }

    /// Sets the impulses. Returns the changes of velocity by the difference.
    fn set(&mut self, impulses: [i128; 3], block: &Block, coarse: i32) -> [[i64; 3]; 2] {
        let before = self.gains;
        self.impulses = impulses.map(|impulse| impulse.clamp(-LARGEST_IMPULSE, LARGEST_IMPULSE) as i64);
        let Sums { linear, turns } = block.sums(self.impulses);
        let [[xa, ya], [xb, yb]] = [linear, block.linear_of_second(linear, self.impulses)];
        let wanted = [block.gains(0, [xa, ya, turns[0]], coarse), block.gains(1, [xb, yb, turns[1]], coarse)];
        // Sums over the joints of a body are below 2^62.
        let [first, second] =
            [0, 1].map(|side| wanted[side].map(|gain| within(gain, block.sides[side].gain_limit.into())));
        self.gains = [first.map(|gain| -gain), second];
        self.is_cut = (0..3).any(|k| {
            let is_cut = |wanted: i128, value: i64| wanted != i128::from(value);
            is_cut(impulses[k], self.impulses[k]) || is_cut(wanted[0][k], first[k]) || is_cut(wanted[1][k], second[k])
        });
        [0, 1].map(|side| [0, 1, 2].map(|axis| self.gains[side][axis] - before[side][axis]))
    }
}

/// The speeds by which rows are stopped at limits.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct StopSpeeds {
    /// The largest velocity of a row that stands still, in 2^-30.
    pub(super) still: i64,
    /// The velocity beyond which a row goes for a limit, in 2^-60.
    pub(super) tolerance: i128,
    /// Bits of velocities that changes are without.
    pub(in crate::solve) coarse: i32,
}

impl StopSpeeds {
    /// For speeds in 2^(coarse − [`GAIN_BITS`]).
    pub(in crate::solve) fn new(still: i64, tolerance: i64, coarse: i32) -> Self {
        Self { still, tolerance: i128::from(tolerance) << 30, coarse }
    }
}

/// The most answers to velocities that joints have before an impact.
const SETTLING_ANSWERS: usize = 4;
/// The most answers to the ways of an impact, and the largest way by which joints may open then, in 2^-30 of a unit.
const WAY_ANSWERS: usize = 4;
const SMALL_WAY: i64 = 1 << 20;
/// The most answers to a change of which the responses are found, and minus log2 of the part of the node's own by which joints may give way then.
const RESPONSE_ANSWERS: usize = 4;
const SMALL_RESIDUAL: i32 = 6;
/// The most times that rows are stopped and let go before an impact.
pub(super) const STOP_ROUNDS: usize = 8;
/// The largest change of a velocity in such an answer.
const LARGEST_CHANGE: i64 = 1 << 60;
/// The largest velocity of a row.
const FASTEST_ROW: i128 = 1 << 61;
/// The largest impulse of a row.
const LARGEST_IMPULSE: i128 = IMPULSE as i128;

impl Block {
    /// The change of the velocity of a row by changes of the velocities of both bodies, 2^30 times as large.
    ///
    /// # Ranges
    /// Changes are below 2^61, axes and cross products at most 2^30.5: sums of six products are below 2^94.
    pub(super) fn change_along(&self, row: usize, [a, b]: [[i64; 3]; 2]) -> i128 {
        let ([[ax, ay], [bx, by]], [ka, kb]) = (self.side_axes(row), self.crosses[row]);
        let way = if self.is_pulley() {
            product(bx, b[0]) - product(ax, a[0]) + product(by, b[1]) - product(ay, a[1])
        } else {
            product(ax, b[0] - a[0]) + product(ay, b[1] - a[1])
        };
        way + product(kb, b[2]) - product(ka, a[2])
    }

    /// Returns true if limits may stop rows of the joint.
    fn may_stop(&self, laws: &[AxisRow]) -> bool {
        self.laws.iter().filter_map(|&law| laws.get(law as usize)).any(AxisRow::may_stop)
    }

    /// The velocity of a row with these velocities before, after changes of the velocities of both bodies, 2^30 times as large.
    pub(super) fn velocity_after(&self, row: usize, ends: [[i64; 3]; 2], velocities: [i64; 3]) -> i128 {
        self.change_along(row, ends) + (i128::from(velocities[row]) << 30)
    }

    /// Stops rows and lets rows go, for the changes of the velocities of both bodies and the impulses of rows, with these velocities before. Returns
    /// true if there is one.
    pub(super) fn revise_stops(
        &self,
        ends: [[i64; 3]; 2],
        velocities: [i64; 3],
        impulses: [i64; 3],
        speeds: &StopSpeeds,
        laws: &mut [AxisRow],
    ) -> bool {
        let mut are_new = false;
        for row in 0..3 {
            let may_stop =
                |law: &&mut AxisRow| law.may_stop() && velocities[row].abs() <= speeds.still >> speeds.coarse;
            if let Some(law) = laws.get_mut(self.laws[row] as usize).filter(may_stop) {
                are_new |= law.revise_stop(self.velocity_after(row, ends, velocities), impulses[row], speeds.tolerance);
            }
        }
        are_new
    }

    /// Returns true if a row is held in an impact: by the joint or by a limit.
    pub(super) fn holds(&self, row: usize, laws: &[AxisRow]) -> bool {
        laws.get(self.laws[row] as usize).map_or(row < 2 && self.held[row], AxisRow::is_held)
    }

    /// The largest velocity of the rows that are held, by changes of the velocities of both bodies.
    pub(super) fn largest_residual(&self, ends: [[i64; 3]; 2], laws: &[AxisRow]) -> i64 {
        let mut largest = 0;
        for row in (0..3).filter(|&row| self.holds(row, laws)) {
            largest = largest.max(self.change_along(row, ends).abs());
        }
        // Below 2^64: changes are below 2^62.
        lowered(largest, 30).min(i64::MAX.into()) as i64
    }
}

/// Adds a change of velocity to another one.
pub(super) fn add_gain(change: &mut [i64; 3], gain: [i64; 3]) {
    (0..3).for_each(|axis| change[axis] += gain[axis]);
}

/// Assemblies of joined bodies have numbers: trees first, then loops.
impl Joints {
    /// The number of assemblies.
    pub(in crate::solve) fn assembly_count(&self) -> usize {
        self.trees.len() + self.loops.len()
    }

    /// The loop of an assembly that is no tree.
    fn loop_of(&self, assembly: usize) -> Option<usize> {
        assembly.checked_sub(self.trees.len())
    }

    /// Lists the rows of the nodes of an assembly; [`STILL`](crate::solve::bodies::STILL) for nodes that are no bodies.
    pub(in crate::solve) fn list_rows(&self, assembly: usize, rows: &mut Vec<u32>) {
        match self.loop_of(assembly) {
            None => rows.extend(self.trees.rows(assembly)),
            Some(index) => rows.extend(self.loops.rows(index)),
        }
    }

    /// The blocks of an assembly.
    fn blocks_of(&self, assembly: usize) -> Range<usize> {
        match self.loop_of(assembly) {
            None => self.trees.blocks(assembly),
            Some(index) => {
                let first = self.tree_count();
                let joints = self.loops.joints(index);
                first + joints.start..first + joints.end
            }
        }
    }

    /// The work of an answer of an assembly with so many nodes, in shocks of an iteration. (A loop has its conjugate gradients.)
    pub(in crate::solve) fn answer_work(&self, assembly: usize, node_count: usize) -> usize {
        if self.loop_of(assembly).is_some() { 4 * node_count } else { node_count / 16 }
    }

    /// Begins an impact of an assembly.
    pub(in crate::solve) fn begin_impact(&mut self, assembly: usize) {
        self.impacts.resize(self.blocks.len(), JointImpact::default());
        let blocks = self.blocks_of(assembly);
        self.impacts[blocks].fill(JointImpact::default());
        self.release(assembly, true);
    }

    /// Begins an impact of an assembly once more, without the rows that are barred from being stopped.
    pub(in crate::solve) fn begin_impact_again(&mut self, assembly: usize) {
        let blocks = self.blocks_of(assembly);
        for impact in &mut self.impacts[blocks] {
            *impact = JointImpact { velocities: impact.velocities, ..JointImpact::default() };
        }
        self.release(assembly, false);
    }

    /// Takes note of the velocities of the rows of an assembly before an impact, for velocities by row of bodies in 2^-30. Returns the largest one of
    /// a row that is held.
    pub(in crate::solve) fn set_velocities(
        &mut self,
        assembly: usize,
        mut velocity: impl FnMut(u32) -> [i64; 3],
    ) -> i64 {
        let mut largest = 0;
        for index in self.blocks_of(assembly) {
            let block = &self.blocks[index];
            let ends = [0, 1].map(|side| velocity(block.sides[side].row));
            let along = |row: usize| lowered(block.change_along(row, ends), 30).clamp(-FASTEST_ROW, FASTEST_ROW) as i64;
            let velocities = [along(0), along(1), along(2)];
            let held = (0..3).filter(|&row| block.holds(row, &self.laws));
            largest = held.map(|row| velocities[row].abs()).fold(largest, i64::max);
            self.impacts[index].velocities = velocities;
        }
        largest
    }

    /// Takes the [velocities](Self::set_velocities) of the rows that the joints of an assembly hold away, by impulses at the beginning of the sub-step.
    /// Adds to `changes`, which are zero, the changes of the velocities of its nodes. Returns false, and changes nothing, where they are too large.
    pub(in crate::solve) fn settle(&mut self, assembly: usize, changes: &mut [[i64; 3]]) -> bool {
        let blocks = self.blocks_of(assembly);
        self.impacts[blocks].iter_mut().for_each(|impact| impact.bias = impact.velocities);
        for _ in 0..SETTLING_ANSWERS {
            self.answer_impact(assembly, changes, 0);
        }
        let is_settled = !self.is_impact_cut(assembly);
        for index in self.blocks_of(assembly) {
            if is_settled {
                self.blocks[index].strike(self.impacts[index].impulses, &mut self.gains);
            }
        }
        if !is_settled {
            changes.fill([0; 3]);
        }
        self.begin_impact(assembly);
        is_settled
    }

    /// Lets all rows of an assembly go that limits stop; `is_over` if the impact is.
    fn release(&mut self, assembly: usize, is_over: bool) {
        for block in self.blocks_of(assembly) {
            for law in self.blocks[block].laws {
                if let Some(law) = self.laws.get_mut(law as usize) {
                    law.release(is_over);
                }
            }
        }
    }

    /// Bars the rows of an assembly that limits pull; all that they stop if `is_last`. Returns true if there is one.
    pub(in crate::solve) fn bar_stops(&mut self, assembly: usize, is_last: bool) -> bool {
        let mut is_any_barred = false;
        for index in self.blocks_of(assembly) {
            let (block, impact) = (&self.blocks[index], &self.impacts[index]);
            for (law, impulse) in block.laws.into_iter().zip(impact.impulses) {
                if let Some(law) = self.laws.get_mut(law as usize) {
                    is_any_barred |= law.bar(impulse, is_last);
                }
            }
        }
        is_any_barred
    }

    /// Returns true if rows of an assembly have limits, and more than one position.
    pub(in crate::solve) fn has_limits(&self, assembly: usize) -> bool {
        let laws = self.blocks[self.blocks_of(assembly)].iter().flat_map(|block| block.laws);
        laws.filter_map(|law| self.laws.get(law as usize)).any(AxisRow::has_limits)
    }

    /// Returns true if limits may stop rows of an assembly.
    pub(in crate::solve) fn may_stop(&self, assembly: usize) -> bool {
        self.blocks[self.blocks_of(assembly)].iter().any(|block| block.may_stop(&self.laws))
    }

    /// Stops the rows of an assembly that changes of the velocities of its nodes by contacts press against their limits: none if rows that joints
    /// hold move. Returns true if other rows are stopped than before.
    pub(in crate::solve) fn stop_rows(&mut self, assembly: usize, changes: &[[i64; 3]], speeds: &StopSpeeds) -> bool {
        let (index, range) = (self.loop_of(assembly), self.blocks_of(assembly));
        let Self { trees, loops, blocks, laws, soft, impacts, .. } = self;
        let is_still = |(block, impact): (&Block, &JointImpact)| {
            (0..3).all(|row| !block.holds(row, laws) || impact.velocities[row].abs() <= speeds.still)
        };
        if !blocks[range.clone()].iter().zip(&impacts[range.clone()]).all(is_still) {
            return false;
        }
        match index {
            None => trees.stop_rows(assembly, changes, speeds, blocks, laws, impacts),
            Some(index) => loops.stop_rows(index, changes, speeds, &blocks[range.clone()], laws, soft, &impacts[range]),
        }
    }

    /// Lets the joints of an assembly answer changes of the velocities of its nodes since the beginning of the impact, and adds the answer to these.
    /// Returns the largest velocity by which a joint gives way.
    pub(in crate::solve) fn answer_impact(&mut self, assembly: usize, changes: &mut [[i64; 3]], coarse: i32) -> i64 {
        let (index, range) = (self.loop_of(assembly), self.blocks_of(assembly));
        let Self { trees, loops, blocks, laws, soft, impacts, .. } = self;
        match index {
            None => {
                trees.answer_impact(assembly, changes, coarse, blocks, laws, impacts);
                trees.largest_residual(assembly, changes, blocks, laws)
            }
            Some(index) => {
                let (blocks, impacts) = (&blocks[range.clone()], &mut impacts[range]);
                loops.answer_impact(index, changes, coarse, blocks, laws, soft, impacts);
                loops.largest_residual(index, changes, blocks, laws)
            }
        }
    }

    /// Finds the responses of all nodes of an assembly to one of them, so that joints give way by a small part of the node's own. `changes` is any memory
    /// for the nodes.
    pub(in crate::solve) fn find_responses(
        &mut self,
        assembly: usize,
        node: usize,
        changes: &mut [[i64; 3]],
        responses: &mut [Response],
    ) {
        let (index, range) = (self.loop_of(assembly), self.blocks_of(assembly));
        let Self { trees, loops, blocks, laws, soft, .. } = self;
        for axis in 0..3 {
            changes.fill([0; 3]);
            changes[node][axis] = 1 << (TRIAL + GAIN_BITS);
            for _ in 0..RESPONSE_ANSWERS {
                let residual = match index {
                    None => {
                        trees.add_answer(assembly, changes, blocks, laws);
                        trees.largest_residual(assembly, changes, blocks, laws)
                    }
                    Some(index) => {
                        let blocks = &blocks[range.clone()];
                        loops.add_answer(index, changes, blocks, laws, soft);
                        loops.largest_residual(index, changes, blocks, laws)
                    }
                };
                for part in changes.as_flattened_mut() {
                    *part = (*part).clamp(-LARGEST_CHANGE, LARGEST_CHANGE);
                }
                if residual <= changes[node][axis].abs() >> SMALL_RESIDUAL {
                    break;
                }
            }
            for (response, change) in responses.iter_mut().zip(&*changes) {
                response[axis] = change.map(|part| lowered_word(part, TRIAL + GAIN_BITS - 30));
            }
        }
    }

    /// Takes note of the impulses of an assembly, to go [back](Self::reset_impact) to.
    pub(in crate::solve) fn mark_impact(&mut self, assembly: usize) {
        for block in self.blocks_of(assembly) {
            let impact = &mut self.impacts[block];
            impact.begun = impact.impulses;
        }
    }

    /// Goes back to the impulses that were noted.
    pub(in crate::solve) fn reset_impact(&mut self, assembly: usize, coarse: i32) {
        for block in self.blocks_of(assembly) {
            let impact = &mut self.impacts[block];
            impact.set(impact.begun.map(i128::from), &self.blocks[block], coarse);
        }
    }

    /// Returns true if the joints of an assembly have impulses or changes that were cut off.
    pub(in crate::solve) fn is_impact_cut(&self, assembly: usize) -> bool {
        self.impacts[self.blocks_of(assembly)].iter().any(|impact| impact.is_cut)
    }

    /// Adds the changes of the velocities of the nodes of an assembly by the impulses of its joints.
    pub(in crate::solve) fn add_impacts(&self, assembly: usize, changes: &mut [[i64; 3]]) {
        match self.loop_of(assembly) {
            None => self.trees.add_impacts(assembly, changes, &self.impacts),
            Some(index) => self.loops.add_impacts(index, changes, &self.impacts[self.blocks_of(assembly)]),
        }
    }

    /// Adds the impulses of the impact to the sums of the joints of an assembly. `ways` are the ways of its nodes in the sub-step that the impulses of
    /// contacts take back, as changes of velocities, and then with the part by the joints.
    pub(in crate::solve) fn apply_impact(&mut self, assembly: usize, ways: &mut [[i64; 3]], coarse: i32) {
        for index in self.blocks_of(assembly) {
            let block = &mut self.blocks[index];
            block.strike(self.impacts[index].impulses, &mut self.gains);
        }
        let blocks = self.blocks_of(assembly);
        self.impacts[blocks].fill(JointImpact::default());
        for _ in 0..WAY_ANSWERS {
            if self.answer_impact(assembly, ways, coarse) <= SMALL_WAY {
                break;
            }
        }
        for index in self.blocks_of(assembly) {
            let block = &mut self.blocks[index];
            block.take_back(self.impacts[index].impulses, &mut self.gains);
        }
        self.release(assembly, true);
    }
}
