//! The pass of free bodies: a block at a time through all stages of the step, while it is in the nearest cache.
//!
//! Reads: the rows of factors, the applied accelerations. Writes: positions, angles, velocities, ticks at rest, faults.
//!
//! No field acts on a free body, so its way depends on itself alone. Where a block's bodies allow it, damp, kick, drift, kick
//! and damp are one loop.
//!
//! A *backup* is a block as it was before the step: the state that a quarantined body is restored to, and the reference for the
//! question of whether a body rests. A block whose bodies are all well inside the allowed range, as nearly every block is, needs no
//! backup and no check: its factors are bounded, no force was applied, no body is about to sleep and every value is within half of its
//! limit, so that no stage could take a body out.

use alloc::vec::Vec;

use super::applied::{accelerations, part_in};
use super::bounds::{SafeSteps, check_bounds_and_rest};
use super::{Constants, Findings, kick};
use crate::body::{BLOCK, Block, Bodies, Change, Motion};
use crate::error::Cause;
use crate::integrate::{
    BlockFactors, FreeStage, Stage, StageKind, cap, damp, drift, fused_kick_drift_kick, fused_kick_drift_kick_each,
    split_fused,
};
use crate::scalar::Scalar;

/// Memory that the pass uses again.
#[derive(Debug, Default)]
pub(super) struct Workspace<S: Scalar> {
    /// By the number of the block.
    safe_steps: Vec<SafeSteps>,
    /// A block as it was before the step.
    backup: Motion<S>,
    #[cfg(feature = "parallel")]
    share: Share,
}

/// The number of bodies that a thread takes at least.
#[cfg(feature = "parallel")]
#[derive(Clone, Copy, Debug)]
struct Share(usize);

#[cfg(feature = "parallel")]
impl Default for Share {
    fn default() -> Self {
        Self(super::SHARE)
    }
}

impl<S: Scalar> Workspace<S> {
    /// Shares the pass between threads from twice as many bodies on as a thread takes at least.
    #[cfg(all(feature = "parallel", feature = "selftest"))]
    pub(super) fn share(&mut self, min_bodies: usize) {
        self.share = Share(min_bodies.max(BLOCK));
    }

    /// Drops the caches of all blocks.
    pub(super) fn drop_cached(&mut self) {
        self.safe_steps.clear();
    }

    /// Drops the caches of the blocks with bodies that changed.
    ///
    /// `changed` has the changes since the last step; `None` if bodies may have come to a block without a change of their own, as where
    /// fields that act by groups changed.
    pub(super) fn drop_changed(&mut self, bodies: &Bodies<S>, changed: Option<&[(u32, Change)]>) {
        let Some(changed) = changed else { return self.drop_cached() };
        // Any change counts: a body that became free stands in a block that was checked without it.
        for i in changed.iter().filter_map(|&(slot, _)| bodies.index_in(slot)) {
            self.drop_block(i);
        }
    }

    /// Drops the cache of the block with the body at this index.
    pub(super) fn drop_block(&mut self, i: usize) {
        if let Some(safe_steps) = self.safe_steps.get_mut(i / BLOCK) {
            *safe_steps = SafeSteps::default();
        }
    }

    pub(super) fn clone_cached_from(&mut self, source: &Self) {
        self.safe_steps.clone_from(&source.safe_steps);
    }
}

/// The pass over the first `count` bodies.
pub(super) fn run<S: Scalar>(
    pass: &FreePass<'_, S>,
    bodies: &mut Bodies<S>,
    count: usize,
    workspace: &mut Workspace<S>,
    findings: &mut Findings,
) {
    workspace.safe_steps.resize(count.div_ceil(BLOCK), SafeSteps::default());
    let blocks = bodies.block(0..count);
    #[cfg(feature = "parallel")]
    if count / 2 >= workspace.share.0 {
        // Each piece allocates a backup of its own, if it needs one.
        return pass.run_in_parallel(blocks, workspace.share, &mut workspace.safe_steps, findings);
    }
    let Workspace { safe_steps, backup, .. } = workspace;
    // Now, not in the step in which a block first needs it.
    backup.make_room(BLOCK.min(count));
    pass.run(blocks, safe_steps, backup, findings);
}

/// The list of stages, and the constants that all blocks share in a step.
#[derive(Clone, Copy)]
pub(super) struct FreePass<'a, S: Scalar> {
    pub(super) constants: Constants<'a, S>,
    pub(super) stages: &'static [FreeStage],
}

impl<S: Scalar> FreePass<'_, S> {
    /// Takes blocks through the whole step. `safe_steps` has one entry a block.
    fn run(
        &self,
        mut blocks: Block<'_, S>,
        safe_steps: &mut [SafeSteps],
        backup: &mut Motion<S>,
        findings: &mut Findings,
    ) {
        for safe_steps in safe_steps {
            let count = BLOCK.min(blocks.len());
            let (mut block, rest) = blocks.split(count);
            blocks = rest;
            self.run_block(&mut block, safe_steps, backup, findings);
        }
    }

    /// Takes blocks through the whole step on all cores. The motion of a body depends on itself alone, and the findings are
    /// joined in order: no bit depends on the number of cores.
    #[cfg(feature = "parallel")]
    fn run_in_parallel(
        &self,
        blocks: Block<'_, S>,
        share: Share,
        safe_steps: &mut [SafeSteps],
        findings: &mut Findings,
    ) {
        if blocks.len() <= share.0 {
            return self.run(blocks, safe_steps, &mut Motion::default(), findings);
        }
        let half = (blocks.len() / 2).next_multiple_of(BLOCK);
        let (left_blocks, right_blocks) = blocks.split(half);
        let (left_safe_steps, right_safe_steps) = safe_steps.split_at_mut(half / BLOCK);
        let mut right_findings = Findings::default();
        rayon::join(
            || self.run_in_parallel(left_blocks, share, left_safe_steps, findings),
            || self.run_in_parallel(right_blocks, share, right_safe_steps, &mut right_findings),
        );
        findings.append(&mut right_findings);
    }

    fn run_block(
        &self,
        block: &mut Block<'_, S>,
        safe_steps: &mut SafeSteps,
        backup: &mut Motion<S>,
        findings: &mut Findings,
    ) {
        let Constants { rows, applied, sleep_after, restores, any_capped, plan, .. } = self.constants;
        let factors = BlockFactors::of(block, rows);
        let pushed = part_in(block, applied);
        let is_pushed = !pushed.is_empty();
        let may_rest = sleep_after.is_some() && (0..block.len()).any(|i| block.is_still(i));
        let is_guarded = is_pushed || !factors.are_bounded(block) || !safe_steps.pass(block) || may_rest;
        if is_guarded {
            *safe_steps = SafeSteps::default();
            if restores {
                backup.keep(block);
            }
        }
        let first_fault = findings.faults.len();
        if is_pushed {
            self.constants.report_overloaded(block, &mut findings.faults);
        }
        // Bodies that neither turn nor are turned keep their angular velocities of zero.
        let turns = block.any_turns() || accelerations(pushed).any(|(_, pushed)| pushed.angular != S::Wide::default());
        let fuses = !is_pushed && factors.decay(block);
        for stage in self.stages {
            match *stage {
                FreeStage::FusedKickDriftKick { half, whole } if fuses => {
                    let (timing, backwards) = (&plan.timing[whole], plan.backwards);
                    match factors {
                        BlockFactors::Alike(row) => fused_kick_drift_kick(block, row, half, timing, turns, backwards),
                        BlockFactors::Each(rows) => {
                            fused_kick_drift_kick_each(block, rows, half, timing, turns, backwards);
                        }
                    }
                }
                FreeStage::FusedKickDriftKick { half, whole } => {
                    for stage in split_fused(half, whole) {
                        self.run_stage(&stage, block, factors, turns, &mut findings.faults);
                    }
                }
                FreeStage::Single(stage) => {
                    self.run_stage(&stage, block, factors, turns, &mut findings.faults);
                }
            }
        }
        if any_capped {
            cap(block, factors);
        }
        if is_guarded {
            check_bounds_and_rest(block, backup, &self.constants, findings);
            if restores {
                for &(i, _) in &findings.faults[first_fault..] {
                    backup.restore(block, i - block.first);
                    block.ticks_at_rest[i - block.first] = 0;
                }
            }
        } else if sleep_after.is_some() {
            block.ticks_at_rest.fill(0);
        }
    }

    fn run_stage(
        &self,
        stage: &Stage,
        block: &mut Block<'_, S>,
        factors: BlockFactors<'_, S>,
        turns: bool,
        faults: &mut Vec<(usize, Cause)>,
    ) {
        match stage.kind {
            StageKind::Damp => damp(block, factors, stage.span, turns, faults),
            StageKind::Kick => kick::kick_block(block, factors, stage, &self.constants, faults),
            StageKind::Drift => drift(block, &self.constants.plan.timing[stage.span], turns),
            StageKind::Fields | StageKind::Clear | StageKind::Detect | StageKind::Solve | StageKind::Push => {}
        }
    }
}
