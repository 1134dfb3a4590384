//! The bodies that force fields may reach: all of them stage by stage.

use super::march::{Found, March, accelerations, part_in};
use super::timers::timed;
use super::{Context, Has, Scratch};
use crate::body::{BLOCK, Block, Motion};
use crate::error::Cause;
use crate::force::{outer_drag, resist};
use crate::integrate::{BlockFactors, Integrator, Stage, StageKind, cap};
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Factor, Scalar};

impl<S: Scalar> Context<'_, S> {
    pub(super) fn run_engaged(&mut self, march: &March<'_, S>, has: Has) {
        timed!(self.scratch, finish, self.keep_frames(march));
        if has.position && !self.scratch.fields_hold && !self.integrator.opens_with_fields() {
            timed!(self.scratch, fields, self.evaluate_fields());
        }
        if has.drag && self.integrator == Integrator::Yoshida4 {
            timed!(self.scratch, damp, {
                self.find_stiff_drag(march, has);
                self.resist_outside(false);
            });
        }
        let mut stages = march.stages;
        while let [stage, others @ ..] = stages {
            match stage.kind {
                StageKind::Fields => timed!(self.scratch, fields, self.run(march, stage, has)),
                StageKind::Damp => timed!(self.scratch, damp, self.run(march, stage, has)),
                StageKind::Kick => timed!(self.scratch, kick, self.run(march, stage, has)),
                StageKind::Drift => timed!(self.scratch, drift, self.run(march, stage, has)),
                StageKind::Clear => {}
            }
            // Drag around the whole step ends with the last damp.
            if self.scratch.drag_outside > 0 && matches!(others, [Stage { kind: StageKind::Clear, .. }]) {
                timed!(self.scratch, damp, self.resist_outside(true));
            }
            if let Some(probe) = &mut self.probe {
                probe(stage, self.bodies);
            }
            stages = others;
        }
        if march.caps {
            self.each_block(|block, _, _| cap(block, BlockFactors::of(block, march.rows)));
        }
        timed!(self.scratch, finish, self.judge_engaged(march));
    }

    fn run(&mut self, march: &March<'_, S>, stage: &Stage, has: Has) {
        match stage.kind {
            StageKind::Damp if stage.mirrored => {
                self.resist_inside(march, stage, has);
                self.run_blocks(march, stage);
            }
            StageKind::Damp => {
                self.run_blocks(march, stage);
                self.resist_inside(march, stage, has);
            }
            StageKind::Kick if self.integrator == Integrator::PublishedVerlet => self.kick_by_mean(march, has),
            StageKind::Kick => {
                if has.velocity && !stage.mirrored && !self.integrator.opens_with_fields() {
                    self.evaluate_resisting();
                }
                self.run_blocks(march, stage);
                self.kick_by_fields(march, stage, has);
            }
            StageKind::Drift => {
                self.run_blocks(march, stage);
                if self.integrator == Integrator::PublishedVerlet {
                    self.drift_by_acceleration();
                }
                self.scratch.forget_places();
            }
            StageKind::Fields => {
                if has.position {
                    self.evaluate_fields();
                }
                if has.velocity {
                    self.evaluate_resisting();
                }
            }
            StageKind::Clear => {}
        }
    }

    /// The engaged blocks, one after the other, with how they were before the step.
    fn each_block(&mut self, mut act: impl FnMut(&mut Block<'_, S>, &mut Motion<S>, &mut Found)) {
        let Scratch { engaged, frames, found, .. } = &mut *self.scratch;
        let moving = self.bodies.moving();
        let numbers = engaged.iter().enumerate().filter(|(_, is)| **is).map(|(number, _)| number);
        for (number, frame) in numbers.zip(frames) {
            let first = number * BLOCK;
            act(&mut self.bodies.block(first, moving.min(first + BLOCK)), frame, found);
        }
    }

    fn keep_frames(&mut self, march: &March<'_, S>) {
        let count = self.scratch.engaged.iter().filter(|is| **is).count();
        if self.scratch.frames.len() < count {
            self.scratch.frames.resize_with(count, Motion::default);
        }
        self.each_block(|block, frame, found| {
            frame.keep(block);
            march.report_overloaded(block, found);
        });
    }

    /// What a stage does to each body by itself.
    fn run_blocks(&mut self, march: &March<'_, S>, stage: &Stage) {
        self.each_block(|block, _, found| {
            let tuned = BlockFactors::of(block, march.rows);
            let spins = block.any_spins();
            march.local(stage, block, tuned, spins, &mut found.faults);
        });
    }

    fn judge_engaged(&mut self, march: &March<'_, S>) {
        self.each_block(|block, frame, found| march.judge(block, frame, found));
        // Stable: the first fault of a body stays its first.
        self.scratch.found.faults.sort_by_key(|(i, _)| *i);
        if march.restores {
            self.each_block(|block, frame, found| {
                for (i, _) in part_in(block, &found.faults) {
                    frame.restore(block, *i - block.first);
                }
            });
        }
    }

    /// Takes all engaged bodies back to what they were.
    pub(super) fn restore_engaged(&mut self) {
        self.each_block(|block, frame, _| (0..block.len()).for_each(|i| frame.restore(block, i)));
    }

    fn resist_inside(&mut self, march: &March<'_, S>, stage: &Stage, has: Has) {
        if !has.drag {
            return;
        }
        let timing = march.plan.timing[stage.span];
        let Scratch { outside, drag_outside, found, .. } = &mut *self.scratch;
        let only = |i: usize| *drag_outside == 0 || !outside[i];
        let span = (timing.seconds, timing.negative);
        resist(self.fields, self.bodies, span, stage.mirrored, only, &mut found.faults);
    }

    fn resist_outside(&mut self, mirrored: bool) {
        let Scratch { outside, found, .. } = &mut *self.scratch;
        let span = (self.plan.half, false);
        resist(self.fields, self.bodies, span, mirrored, |i| outside[i], &mut found.faults);
    }

    /// Finds the bodies whose drag is to act around the whole step, judged by what gravity, the forces applied and the
    /// fields of position here may add to their speed in twice the time step.
    fn find_stiff_drag(&mut self, march: &March<'_, S>, has: Has) {
        let Scratch { fields, gain, outside, drag_outside, .. } = &mut *self.scratch;
        let size = |a: Vec2<S::Wide>| S::Factor::from_wide(a.x).plus(S::Factor::from_wide(a.y));
        gain.clear();
        let moving = &self.bodies.columns.factors[..self.bodies.moving()];
        gain.extend(moving.iter().map(|&row| size(march.rows[row as usize].gravity)));
        let fields = if has.position { &fields[..] } else { &[] };
        let fields = fields.iter().map(|(i, acceleration)| (i, acceleration));
        for (i, acceleration) in fields.chain(accelerations(march.pushed)) {
            gain[*i] = gain[*i].plus(size(acceleration.linear));
        }
        let twice = self.plan.whole.plus(self.plan.whole);
        *drag_outside = outer_drag(self.fields, self.bodies, self.plan.whole, |i| gain[i].times(twice), outside);
    }

    /// PublishedVerlet's x += ½·a·dt² beside x += v·dt.
    fn drift_by_acceleration(&mut self) {
        let half_square = self.plan.half_square;
        let block = self.bodies.all_moving();
        let [x, y] = block.position;
        for (i, acceleration) in block.last.iter().enumerate() {
            let way = |a: S::Wide| S::kick(a, half_square);
            match (acceleration.linear.try_map(way), way(acceleration.angular)) {
                (Some(linear), Some(angular)) => {
                    (x[i], y[i]) = (x[i].plus(linear.x), y[i].plus(linear.y));
                    block.angle[i] = block.angle[i].turned(angular);
                }
                _ => self.scratch.found.faults.push((i, Cause::Velocity)),
            }
        }
    }
}
