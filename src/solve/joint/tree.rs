//! Trees of joined bodies, solved directly: from the leaves to the centre and back.
//!
//! Velocities of points change by impulses, and impulses follow from velocities: a linear system, which is solved by elimination (block
//! LDLᵀ) along the tree. A body is seen from the point of the joint to its parent: there it has a mass matrix E, with all that hangs on it,
//! and the joint makes the spring S = (E⁻¹ + γ)⁻¹ of it with the compliance γ. With q for a point turned left by a quarter, from the
//! centre of mass; A, b and c for the mass of the body and its springs, their moments and their moment of inertia; f and τ for impulses and
//! their moment:
//!
//! ```text
//! b' = b − A q      c' = c − q·(b + b')      t = b'/c'      E = A − b' tᵀ          the rotation is eliminated
//! S = (E + γ det(E) 1)/(1 + γ tr(E) + γ² det(E))
//! parent:  A += S    b += S q    c += q·S q
//! down:    τ' = τ − q·f    g = f − t τ'    h = g + S(r − γ g)    parent:  f += h    τ += q·h
//! up:      Δλ = S(Δp − r + γ g) − g    Δp' = Δp − r − γ Δλ    Δω = τ'/c' − t·Δp'    Δv = Δp' − Δω q
//! ```
//!
//! Here r is the residual of the rows, of the node against its parent, Δp and Δp' are the changes of velocity at both points of the joint.
//! At the centre Δp' = E⁻¹ g. A *support* is a node that does not move: E⁻¹ = 0. A joint at the centre is two, with half of the residual and
//! of the compliance each, to a point between them without a mass. For a *rod* along n, E is turned to n and eliminated across it: the
//! rest is the same with numbers in place of matrices.
//!
//! The solve only steers: bodies move by the exact impulses of the blocks, and its error is in the next residual. So a body may count
//! as lighter than it is, never as heavier: a push that is too small is made up for in the next passes, one that is too large grows.
//!
//! # Ranges
//! Each body has a unit of mass of its own, a power of two, in which its mass is below 2^[`MASS`], less by the bits of the number of its
//! children. A body counts as at most 2^[`HEAVIER`] times as heavy as its parent; an axis that is locked as 2^[`LOCKED`] times as heavy. The
//! moment of inertia over the square of the length is within 2^10 and 2^46: radii of gyration count as 2^-13 of the length at least. A
//! joint is in the unit of the lighter one of its bodies.
//! - γ is in 2^-[`SOFT`], at most 2^54. It is at least 2^-11 of the inverse mass of either body, so that a spring is below 2^(11 + MASS), also
//!   with all others of its parent: A, b and c are below 2^49, E in the unit of the joint below 2^61.
//! - E − and so c', and E across a rod − is not smaller than the mass of the body alone. By that, |t| is below 2^20. Numbers that rounding
//!   leads beyond that are cut off.
//! - γE is in 2^-[`PART`], below 2^61, its determinant below 2^122; so is γ det(E) in 2^-PART.
//! - Velocities are in 2^-[`FRACTION`] units, residuals within 2^36, changes within 2^44. Impulses are in 2^16 of a unit of mass by a unit of
//!   velocity, within 2^61; their sums have 128 bits. Products are below 2^(61 + 62).
//!
//! Every shift of a value that changes its sign in a mirror rounds to nearest, halves away from zero; formulas are symmetric in x and y.

mod angle;
mod factor;
mod frame;
mod impact;
mod node;
mod pin;
mod setup;
mod stiffness;
mod symmetric;

use alloc::vec::Vec;
use core::ops::Range;

use self::factor::{factor, factor_changed};
use self::frame::FrameRows;
use self::node::Node;
use super::Block;
use super::axis::AxisRow;
use super::forest::Forest;
use super::gains::Gains;
use super::laws::RowChange;
use super::turn::Pose;
use crate::slots::NONE;
use crate::solve::StepInput;
use crate::solve::bodies::BodyRows;
use crate::solve::motion::Rows;
use crate::solve::number::{bits_of, lowered_word, shifted, within};

/// The bits of a mass in the unit of the body.
const MASS: i32 = 36;
/// A body counts as at most 2^HEAVIER times as heavy as its parent.
const HEAVIER: i32 = 12;
/// An axis that is locked counts as 2^LOCKED times as heavy.
const LOCKED: i32 = 10;
/// The range of moments of inertia.
const INERTIA: [i64; 2] = [1 << 10, 1 << 46];
/// Fraction bits of t.
const RATIO: i32 = 40;
/// Fraction bits of γ.
const SOFT: i32 = 90;
/// Fraction bits of γE.
const PART: i32 = 36;
/// Fraction bits of velocities.
pub(super) const FRACTION: i32 = 8;
/// Fraction bits of arms and axes.
const UNIT: i32 = 30;
/// log2 of the unit of impulses over units of mass and velocity.
const COARSER: i32 = 16;
/// From products of masses and velocities to impulses.
const TO_IMPULSE: i32 = COARSER + FRACTION;
/// The largest residual, change of a velocity, and impulse.
pub(super) const RESIDUAL: i128 = 1 << 36;
const SPEED: i128 = 1 << 44;
const IMPULSE: i128 = 1 << 60;
/// The velocity that takes errors away, over the error, in 2^-30: a tenth in a sub-step, as contacts give way more slowly, and ropes on a floor would
/// shake at three tenths. Trees that touch nothing take three tenths away: a chain stretches a third as much.
const RATE: i64 = 107_374_182;
const FREE_RATE: i64 = 322_122_547;

/// The largest number of times that a tree is solved in a pass until no row leaves its place.
const ROUNDS: usize = 8;

/// The iterations of a descent.
const DESCENT: usize = 8;

/// The compliance of a joint over its inverse mass, as minus log2; and in trees among other constraints, under heavy loads.
const COMPLIANCE: i32 = 11;
const LOADED_COMPLIANCE: i32 = 7;

/// All trees of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Trees {
    /// Beside the places of the forest.
    nodes: Vec<Node>,
    frames: Vec<FrameRows>,
    trees: Vec<Tree>,
}

/// A tree of a step.
#[derive(Clone, Debug)]
struct Tree {
    nodes: Range<usize>,
    blocks: Range<usize>,
    /// True if one of its bodies is in a contact.
    touches: bool,
    /// True if a row of one of its joints has a law.
    has_laws: bool,
}

impl Trees {
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.nodes.capacity() + self.frames.capacity() + self.trees.capacity()
    }

    /// Forgets the trees of the step before.
    pub(super) fn clear(&mut self) {
        self.nodes.clear();
        self.frames.clear();
        self.trees.clear();
    }

    /// Prepares the trees of a step. `is_loaded` tells the trees among other constraints under heavy loads, by one of their bodies.
    pub(super) fn set(
        &mut self,
        input: &StepInput<'_>,
        forest: &Forest,
        blocks: &[Block],
        laws: &[AxisRow],
        bodies: &BodyRows,
        is_loaded: impl Fn(u32) -> bool,
    ) {
        self.clear();
        let Self { nodes, frames, trees } = self;
        nodes.resize(forest.places.len(), Node::default());
        for (node, place) in nodes.iter_mut().zip(&forest.places) {
            node.set(place, input.flights, bodies);
        }
        for range in &forest.trees {
            let is_loaded =
                forest.places[range.clone()].iter().any(|place| place.body != NONE && is_loaded(place.body));
            set_units(nodes, range.start, range.end - 1);
            let bits = if is_loaded { LOADED_COMPLIANCE } else { COMPLIANCE };
            set_joints(nodes, frames, range.clone(), blocks, laws, bits);
            let has_laws = set_shares(&mut nodes[range.clone()], range.start, blocks);
            // A node has one joint; the middle of a joint is a node more.
            let centre = &nodes[range.end - 1];
            let joint_count = range.len() - 1 - usize::from(!centre.is_body);
            let begin = trees.last().map_or(0, |tree: &Tree| tree.blocks.end);
            trees.push(Tree { nodes: range.clone(), blocks: begin..begin + joint_count, touches: false, has_laws });
        }
        for tree in input.contacts.iter().flat_map(|contact| contact.bodies).filter_map(|body| forest.tree_of(body)) {
            trees[tree].touches = true;
        }
    }

    /// Finds the matrices where the bodies are, before the sub-step: of all trees before the first one, then of trees without a relax pass.
    #[inline(always)]
    pub(super) fn begin(&mut self, blocks: &[Block], is_first: bool) {
        self.factor(blocks, |tree| is_first || !tree.touches);
    }

    /// Finds the matrices where the bodies are, before the relax pass.
    #[inline(always)]
    pub(super) fn relax(&mut self, blocks: &[Block]) {
        self.factor(blocks, |tree| tree.touches);
    }

    #[inline(always)]
    fn factor(&mut self, blocks: &[Block], is_meant: impl Fn(&Tree) -> bool) {
        let Self { nodes, frames, trees } = self;
        for tree in trees.iter().filter(|tree| is_meant(tree)) {
            factor(&mut nodes[tree.nodes.clone()], frames, tree.nodes.start, blocks);
        }
    }

    /// Changes the impulses of the joints of trees by a pass. The relax pass is for trees that touch other bodies: an exact solution leaves
    /// it nothing to do, and with it a rod that spins on a pin would gain 5 % of its energy in 100 s. Returns the number of impulses that were cut off.
    #[inline(always)]
    pub(super) fn solve(
        &mut self,
        blocks: &mut [Block],
        poses: &[Pose],
        laws: &mut [AxisRow],
        rows: &Rows,
        gains: &mut Gains,
        is_biased: bool,
    ) -> u64 {
        let Self { nodes, frames, trees } = self;
        let mut cut = 0;
        for tree in trees.iter().filter(|tree| is_biased || tree.touches) {
            let begin = tree.nodes.start;
            let nodes = &mut nodes[tree.nodes.clone()];
            let rate = is_biased.then_some(if tree.touches { RATE } else { FREE_RATE });
            for node in nodes.iter_mut() {
                node.begin_pass(blocks, poses, rows, rate);
            }
            if tree.has_laws {
                begin_laws(nodes, blocks, laws, rows, is_biased);
                if !find_places(nodes, frames, begin, blocks, laws) {
                    begin_laws(nodes, blocks, laws, rows, is_biased);
                    descend(nodes, frames, begin, blocks, laws);
                }
            } else {
                eliminate(nodes, frames, begin);
            }
            cut += push(nodes, frames, blocks, laws, gains, is_biased);
        }
        cut
    }
}

/// Solves a tree: from the leaves to the centre and back.
#[inline(always)]
fn eliminate(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize) {
    for index in 0..nodes.len() - 1 {
        let (before, after) = nodes.split_at_mut(index + 1);
        let node = &mut before[index];
        let (impulse, torque) = node.pass_down(frames);
        let parent = &mut after[node.parent as usize - begin - index - 1];
        parent.take(impulse, node.joint_unit, node.parent_point);
        parent.take_torque(node, frames, torque);
    }
    let centre = nodes.len() - 1;
    nodes[centre].pass_down(frames);
    nodes[centre].turn_back();
    for index in (0..centre).rev() {
        let (before, after) = nodes.split_at_mut(index + 1);
        let parent = &after[before[index].parent as usize - begin - index - 1];
        before[index].pass_up(frames, parent.velocity, parent.spin);
    }
}

/// Begins a pass of all laws. Limits always push back by a tenth: where a row leaves its limit, the push stays as a velocity.
#[inline(always)]
fn begin_laws(nodes: &[Node], blocks: &[Block], laws: &mut [AxisRow], rows: &Rows, is_biased: bool) {
    for node in nodes.iter().filter(|node| node.parent != NONE) {
        blocks[node.block as usize].begin_laws(rows, laws, is_biased.then_some(RATE));
    }
}

/// Solves a tree until no row leaves its place. Returns false if rows still do.
#[inline(always)]
fn find_places(
    nodes: &mut [Node],
    frames: &mut [FrameRows],
    begin: usize,
    blocks: &[Block],
    laws: &mut [AxisRow],
) -> bool {
    for _ in 0..ROUNDS {
        solve_aims(nodes, frames, begin, blocks, laws);
        if !revise_laws(nodes, frames, blocks, laws) {
            return true;
        }
    }
    false
}

/// Solves a tree by a *descent* of its kinetic energy: in each iteration every row takes the impulse that its law alone has for the present velocity,
/// with the points solved exactly.
///
/// Rows of a body move each other, so that all at once would overshoot. With the masses of both bodies split among the k rows of each, no
/// iteration can raise the energy: for the matrix K of the rows and the part D of it in which each row is alone, K ≤ k·D. From the impulses of the
/// pass before it leads to the end as slowly as projected Jacobi iterations do, but the search for places may go round in circles, and its last
/// impulses, solved for limits that hold where they do not, would tear a chain between two supports apart in a step.
#[cold]
#[inline(never)]
fn descend(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize, blocks: &[Block], laws: &mut [AxisRow]) {
    for node in nodes.iter().filter(|node| node.parent != NONE) {
        blocks[node.block as usize].begin_descent(laws);
    }
    // With the last solution in the loop the code of a solution is there once.
    for iteration in 0..=DESCENT {
        solve_aims(nodes, frames, begin, blocks, laws);
        if iteration == DESCENT {
            return;
        }
        for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.parent != NONE) {
            let block = &blocks[node.block as usize];
            if let Some(changes) = row_changes(nodes, frames, index, block) {
                block.descend(laws, changes, node.share);
            }
        }
    }
}

/// Solves a tree for the present aims of its laws.
#[inline(always)]
fn solve_aims(nodes: &mut [Node], frames: &mut [FrameRows], begin: usize, blocks: &[Block], laws: &[AxisRow]) {
    if set_aims(nodes, frames, blocks, laws) {
        factor_changed(nodes, frames, begin, blocks);
    }
    eliminate(nodes, frames, begin);
}

/// Sets the aims of laws in a round. Returns true if the matrices change by it.
#[inline(always)]
fn set_aims(nodes: &mut [Node], frames: &mut [FrameRows], blocks: &[Block], laws: &[AxisRow]) -> bool {
    let mut have_changed = false;
    for node in nodes.iter_mut().filter(|node| node.parent != NONE) {
        node.has_changed = node.set_aims(frames, &blocks[node.block as usize], laws);
        have_changed |= node.has_changed;
    }
    have_changed
}

/// The changes of the rows with laws of the joint between a node and its parent, or in the middle of which the node is the first end; `None` for
/// the second end.
fn row_changes(nodes: &[Node], frames: &[FrameRows], index: usize, block: &Block) -> Option<[RowChange; 3]> {
    let mut changes = [RowChange::default(); 3];
    for (row, change) in changes.iter_mut().enumerate().filter(|&(row, _)| block.laws[row] != NONE) {
        *change = row_change(nodes, frames, index, row)?;
    }
    Some(changes)
}

#[inline(always)]
fn row_change(nodes: &[Node], frames: &[FrameRows], index: usize, row: usize) -> Option<RowChange> {
    let node = &nodes[index];
    let (mut velocity, mut impulse) = node.row_change(frames, row)?;
    let mut bits = node.push_shift;
    if node.is_half {
        // Halves move and push in opposite directions.
        let (second_velocity, second_impulse) =
            nodes.get(index + 1).filter(|second| second.is_half)?.row_change(frames, row)?;
        (velocity, impulse, bits) = (velocity - second_velocity, impulse - second_impulse, bits + 1);
    }
    let sign = if node.side == 0 { -1 } else { 1 };
    Some(RowChange { velocity: sign * velocity, impulse: sign * change_of(impulse, bits) })
}

/// Moves rows on that have left their places. Returns true if there is one.
#[inline(always)]
fn revise_laws(nodes: &[Node], frames: &[FrameRows], blocks: &[Block], laws: &mut [AxisRow]) -> bool {
    let mut have_left = false;
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.parent != NONE) {
        let block = &blocks[node.block as usize];
        if let [NONE, NONE, around] = block.laws {
            if let (Some(law), Some(change)) = (laws.get_mut(around as usize), row_change(nodes, frames, index, 2)) {
                have_left |= block.revise_law(law, 2, &change);
            }
        } else if let Some(changes) = row_changes(nodes, frames, index, block) {
            have_left |= block.revise_laws(laws, changes);
        }
    }
    have_left
}

/// Counts the rows with laws at the bodies of a tree, and sets the shares of masses that they meet in a descent. Returns true if there is one.
fn set_shares(nodes: &mut [Node], begin: usize, blocks: &[Block]) -> bool {
    let centre = nodes.len() - 1;
    for index in 0..centre {
        let laws = blocks[nodes[index].block as usize].laws;
        let count = laws.into_iter().filter(|&law| law != NONE).count() as i64;
        let parent = nodes[index].parent as usize - begin;
        nodes[index].law_count += count;
        nodes[parent].law_count += count;
    }
    for index in 0..centre {
        let opposite = opposite_end(nodes, begin, index);
        let count = nodes[index].law_count.max(nodes[opposite].law_count);
        nodes[index].share = bits_of(count - 1);
    }
    nodes.iter().any(|node| node.law_count > 0)
}

/// Units from the centre, the node `centre`, to the leaves.
fn set_units(nodes: &mut [Node], begin: usize, centre: usize) {
    if !nodes[centre].is_body {
        // The two nodes before it are its children.
        let unit = nodes[centre - 1].unit.min(nodes[centre - 2].unit);
        nodes[centre].unit = unit;
        for node in &mut nodes[centre - 2..centre] {
            node.is_half = true;
        }
    }
    for index in (begin..centre).rev() {
        let unit = nodes[nodes[index].parent as usize].unit;
        nodes[index].unit = nodes[index].unit.min(unit + HEAVIER);
    }
}

/// The node at the other end of the joint of a node to its parent: the parent, or the other child of the middle of the joint.
fn opposite_end(nodes: &[Node], begin: usize, index: usize) -> usize {
    if nodes[index].is_half { 2 * nodes.len() - 5 - index } else { nodes[index].parent as usize - begin }
}

/// Sets the values that follow from the masses at both ends of joints.
fn set_joints(
    nodes: &mut [Node],
    frames: &mut Vec<FrameRows>,
    range: Range<usize>,
    blocks: &[Block],
    laws: &[AxisRow],
    bits: i32,
) {
    let begin = range.start;
    for index in begin..range.end - 1 {
        let opposite = begin + opposite_end(&nodes[range.clone()], begin, index - begin);
        let (low, high) = nodes.split_at_mut(index.max(opposite));
        let (first, second) = (&mut low[index.min(opposite)], &mut high[0]);
        let (node, opposite_node) = if index < opposite { (first, second) } else { (second, first) };
        node.set_joint(opposite_node, &blocks[node.block as usize], laws, bits, frames);
    }
}

/// True for the second half of a joint, which has its impulses with the first one.
fn is_second_half(nodes: &[Node], index: usize) -> bool {
    nodes[index].is_half && !nodes[index + 1].is_half
}

/// The largest change of an impulse that is told from others.
const LARGEST: i128 = 1 << 61;

/// A change of an impulse, which is below 2^62, in the unit of the block.
#[inline(always)]
fn change_of(push: i64, bits: i32) -> i64 {
    if matches!(bits, 1..63) { lowered_word(push, bits) } else { within(shifted(push.into(), bits), LARGEST) }
}

/// The changes of the impulses of the joint between a node and its parent, or in the middle of which the node is the first end; `None` for the
/// second end.
#[inline(always)]
fn joint_impulses(nodes: &[Node], frames: &[FrameRows], index: usize) -> Option<[i64; 3]> {
    let node = &nodes[index];
    let [x, y, around] = node.impulses(frames);
    let sign = if node.side == 0 { -1 } else { 1 };
    if !node.is_half {
        // Most joints have no row around.
        let around = if around == 0 { 0 } else { change_of(around, node.push_shift) };
        return Some([sign * change_of(x, node.push_shift), sign * change_of(y, node.push_shift), sign * around]);
    }
    if is_second_half(nodes, index) {
        return None;
    }
    // The mean of both halves of the joint.
    let second_pushes = nodes[index + 1].impulses(frames);
    let mut changes = [0; 3];
    for (row, push) in [x, y, around].into_iter().enumerate() {
        let sum = i128::from(push) - i128::from(second_pushes[row]);
        changes[row] = sign * within(shifted(sum, node.push_shift + 1), LARGEST);
    }
    Some(changes)
}

/// Adds the changes of impulses to the joints.
#[inline(always)]
fn push(
    nodes: &[Node],
    frames: &[FrameRows],
    blocks: &mut [Block],
    laws: &mut [AxisRow],
    gains: &mut Gains,
    is_biased: bool,
) -> u64 {
    let mut cut = 0;
    for index in 0..nodes.len() - 1 {
        let Some(changes) = joint_impulses(nodes, frames, index) else { continue };
        let block = &mut blocks[nodes[index].block as usize];
        cut += block.change(changes, laws, is_biased);
        block.give_gains(gains);
    }
    cut
}
