//! Taking a block of bodies through what the stages do to each body by itself.
//!
//! A body that no force field reaches needs nothing of the others. Its block goes through all stages of the step at
//! once, while it is in the nearest cache; and one whose bodies are all far inside the envelope, as nearly every block is,
//! needs no copy of what it was and no look at what it is, as no stage could take it out.

use alloc::vec::Vec;

use crate::body::{Acceleration, BLOCK, Block, GENTLE_STEPS, Motion, StepFactors};
use crate::error::Cause;
use crate::integrate::{BlockFactors, Plan, Stage, StageKind, cap, damp, drift, fall, glide, glide_each, kick_by};
use crate::limits;
use crate::scalar::{Accumulator, Scalar};

/// Data that all blocks share in a step.
#[derive(Clone, Copy)]
pub(super) struct March<'a, S: Scalar> {
    pub(super) stages: &'static [Stage],
    pub(super) plan: &'a Plan<S>,
    pub(super) rows: &'a [StepFactors<S>],
    /// What the forces applied this tick do, in the order of the columns; `None` where their sum does not fit.
    pub(super) pushed: &'a [Pushed<S>],
    pub(super) sleep_after: Option<u32>,
    /// True if a body with a fault is restored to its state before the step. When a step is undone, all bodies are, or none.
    pub(super) restores: bool,
    /// True if the speed of a body is limited.
    pub(super) caps: bool,
}

/// What was found on the way.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// In the order in which they happened to a body.
    pub(super) faults: Vec<(usize, Cause)>,
    /// Whether a body has been at rest for long enough to try to sleep.
    pub(super) ready: bool,
}

impl<'a, S: Scalar> March<'a, S> {
    /// Takes the blocks that are not `engaged`, by their number, through the whole step. `calm` has one entry a block.
    pub(super) fn run(
        &self,
        mut blocks: Block<'_, S>,
        calm: &mut [Calm],
        engaged: &[bool],
        frame: &mut Motion<S>,
        found: &mut Found,
    ) {
        for calm in calm {
            let count = BLOCK.min(blocks.len());
            let (mut block, others) = blocks.split(count);
            blocks = others;
            if engaged.get(block.first / BLOCK).is_some_and(|is| *is) {
                calm.0 = 0;
            } else {
                self.run_block(&mut block, calm, frame, found);
            }
        }
    }

    /// The same on all cores: a body's way depends on itself alone, and what was found is put together in order.
    #[cfg(feature = "parallel")]
    pub(super) fn run_side_by_side(
        &self,
        blocks: Block<'_, S>,
        calm: &mut [Calm],
        engaged: &[bool],
        found: &mut Found,
    ) {
        // Some tens of microseconds, so that handing it to another core is worth it.
        const FEW: usize = 32 * BLOCK;
        if blocks.len() <= FEW {
            return self.run(blocks, calm, engaged, &mut Motion::default(), found);
        }
        let half = (blocks.len() / 2).next_multiple_of(BLOCK);
        let (blocks, others) = blocks.split(half);
        let (calm, calm_there) = calm.split_at_mut(half / BLOCK);
        let mut found_there = Found::default();
        rayon::join(
            || self.run_side_by_side(blocks, calm, engaged, found),
            || self.run_side_by_side(others, calm_there, engaged, &mut found_there),
        );
        found.faults.append(&mut found_there.faults);
        found.ready |= found_there.ready;
    }

    fn run_block(&self, block: &mut Block<'_, S>, calm: &mut Calm, frame: &mut Motion<S>, found: &mut Found) {
        let tuned = BlockFactors::of(block, self.rows);
        let pushed = self.pushed_in(block);
        let may_rest = self.sleep_after.is_some() && (0..block.len()).any(|i| block.is_still(i));
        let guarded = !pushed.is_empty() || !tuned.are_gentle(block) || !calm.pass(block) || may_rest;
        if guarded {
            calm.0 = 0;
            if self.restores {
                frame.keep(block);
            }
        }
        let first_fault = found.faults.len();
        self.report_overloaded(block, found);
        let mut spins = block.any_spins();
        let mut stages = self.stages;
        let glides = pushed.is_empty() && tuned.decay(block);
        while let [stage, others @ ..] = stages {
            stages = match whole_beat(stages) {
                Some((half, whole, others)) if glides => {
                    let span = (half, &self.plan.timing[whole]);
                    match tuned {
                        BlockFactors::Alike(row) => glide(block, row, span, spins, self.plan.backwards),
                        BlockFactors::Each(rows) => glide_each(block, rows, span, spins, self.plan.backwards),
                    }
                    others
                }
                _ => {
                    self.local(stage, block, tuned, spins, &mut found.faults);
                    spins = spins || (!pushed.is_empty() && block.any_spins());
                    others
                }
            };
        }
        if self.caps {
            cap(block, tuned);
        }
        if guarded {
            self.judge(block, frame, found);
            if self.restores {
                for i in first_fault..found.faults.len() {
                    let (at, _) = found.faults[i];
                    frame.restore(block, at - block.first);
                }
            }
        } else if self.sleep_after.is_some() {
            block.rest.fill(0);
        }
    }

    /// What a stage does to each body of a block by itself.
    pub(super) fn local(
        &self,
        stage: &Stage,
        block: &mut Block<'_, S>,
        tuned: BlockFactors<'_, S>,
        spins: bool,
        faults: &mut Vec<(usize, Cause)>,
    ) {
        let timing = &self.plan.timing[stage.span];
        match stage.kind {
            StageKind::Damp => damp(block, tuned, stage.span, spins, faults),
            StageKind::Kick => {
                fall(block, tuned, stage.span, self.plan.backwards);
                for (i, acceleration) in accelerations(self.pushed_in(block)) {
                    if let Err(cause) = kick_by(block, *i, acceleration, timing.seconds, timing.negative) {
                        faults.push((*i, cause));
                    }
                }
            }
            StageKind::Drift => drift(block, timing, spins),
            StageKind::Fields | StageKind::Clear => {}
        }
    }

    /// The forces applied to the bodies of a block.
    fn pushed_in(&self, block: &Block<'_, S>) -> &'a [Pushed<S>] {
        part_in(block, self.pushed)
    }

    /// The bodies of a block that are taken out for what was applied to them, whatever else befalls them.
    pub(super) fn report_overloaded(&self, block: &Block<'_, S>, found: &mut Found) {
        let overloaded = self.pushed_in(block).iter().filter(|(_, acceleration)| acceleration.is_none());
        found.faults.extend(overloaded.map(|&(i, _)| (i, Cause::Force)));
    }

    /// Looks at a block at the end of a step: who left the envelope, and who is at rest.
    pub(super) fn judge(&self, block: &mut Block<'_, S>, frame: &Motion<S>, found: &mut Found) {
        find_strays(block, &mut found.faults);
        let Some(ticks) = self.sleep_after else { return };
        for i in 0..block.len() {
            // The next step would leave it as it is, to the bit: its public velocities are zero, and the step changed
            // nothing below them either.
            let at_rest = block.is_still(i) && frame.is_same(block, i);
            block.rest[i] = if at_rest { block.rest[i].saturating_add(1) } else { 0 };
        }
        for (i, _) in self.pushed_in(block) {
            block.rest[i - block.first] = 0;
        }
        found.ready |= block.rest.iter().any(|&rest| is_ready(rest, ticks));
    }
}

/// What the forces applied to a body do, by its index; `None` if their sum does not fit.
pub(super) type Pushed<S> = (usize, Option<Acceleration<S>>);

/// Those that fit.
pub(super) fn accelerations<S: Scalar>(pushed: &[Pushed<S>]) -> impl Iterator<Item = (&usize, &Acceleration<S>)> {
    pushed.iter().filter_map(|(i, acceleration)| Some((i, acceleration.as_ref()?)))
}

/// The entries of a list, in the order of the indices it goes by, that are about bodies of a block.
pub(super) fn part_in<'a, S: Scalar, T>(block: &Block<'_, S>, list: &'a [(usize, T)]) -> &'a [(usize, T)] {
    let before = |end: usize| list.partition_point(|(index, _)| *index < end);
    if list.is_empty() { list } else { &list[before(block.first)..before(block.first + block.len())] }
}

/// If the stages begin with damp, kick, drift, kick, damp: the spans of the first and of the drift, and the stages after.
fn whole_beat(stages: &'static [Stage]) -> Option<(usize, usize, &'static [Stage])> {
    use StageKind::{Damp, Drift, Fields, Kick};
    let [a, b, c, d, e, f, others @ ..] = stages else { return None };
    let is_one = [a, b, c, d, e, f].map(|stage| stage.kind) == [Damp, Kick, Drift, Fields, Kick, Damp]
        && [b, e, f].iter().all(|stage| stage.span == a.span);
    is_one.then_some((a.span, c.span, others))
}

/// Who is ready last has been at rest for `ticks`; one that others keep up tries again every so often.
pub(super) fn is_ready(rest: u32, ticks: u32) -> bool {
    rest >= ticks && rest % ticks == 0
}

/// For how many steps more no body of a block can leave the envelope, if they are gentle and nothing else acts. Cached:
/// dropped by whatever changes a body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Calm(u8);

impl Calm {
    /// Whether it is so for the step to come.
    fn pass<S: Scalar>(&mut self, block: &Block<'_, S>) -> bool {
        if self.0 == 0 && is_far_inside(block) {
            self.0 = GENTLE_STEPS;
        }
        let passes = self.0 > 0;
        self.0 = self.0.saturating_sub(1);
        passes
    }
}

/// Whether all are so far inside the envelope that [`GENTLE_STEPS`] steps of gentle factors cannot take them out: half of
/// each limit. Their falls add less than half the limit of speeds, and the way of 32 · 4.43 s at that limit is less than
/// 2^28 m.
fn is_far_inside<S: Scalar>(block: &Block<'_, S>) -> bool {
    are_inside(block, [limits::POSITION_LOG2 - 1, limits::SPEED_LOG2 - 1])
}

/// Returns true if positions are within two to the first, and velocities and angular velocities within two to the second. At a limit
/// itself the answer may be no.
fn are_inside<S: Scalar>(block: &Block<'_, S>, [position, speed]: [u32; 2]) -> bool {
    block.velocity.iter().all(|v| S::are_within(v, speed))
        && S::are_within(block.angular_velocity, speed)
        && block.position.iter().all(|x| S::are_within(x, position))
}

/// Bodies beyond the envelope.
pub(crate) fn find_strays<S: Scalar>(block: &Block<'_, S>, faults: &mut Vec<(usize, Cause)>) {
    // As a rule there are none, and columns are looked through sooner than bodies.
    if are_inside(block, [limits::POSITION_LOG2, limits::SPEED_LOG2]) {
        return;
    }
    let [position, speed, angular_velocity] = [limits::POSITION, limits::SPEED, limits::ANGULAR_SPEED].map(S::from_fx);
    for i in 0..block.len() {
        let cause = if !block.velocity.iter().all(|v| v[i].is_within(speed)) {
            Cause::Velocity
        } else if !block.position.iter().all(|x| x[i].is_within(position)) {
            Cause::Position
        } else if !block.angular_velocity[i].is_within(angular_velocity) {
            Cause::AngularVelocity
        } else {
            continue;
        };
        faults.push((block.first + i, cause));
    }
}
